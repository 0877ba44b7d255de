/* test_descend.c - the nearest point of boundaries whose nearest point is known: ellipsoids of any
 * orientation in two to six dimensions, a polytope, a set with several dips. */
#include "support.h"

#include "analysis/basin/basin_descend.h"

enum { MOST = 6, STARTS = 8, RAYS = 512 };

struct shape {
    int n;
    double half[MOST], axis[MOST][MOST]; /* orthonormal */
    bool (*holds)(const struct shape *shape, const double *y);
    size_t asked;
};

static bool in_ellipsoid(const struct shape *s, const double *y)
{
    double sum = 0;
    for (int k = 0; k < s->n; k++)
        sum += pow(y[k] / s->half[k], 2);
    return sum < 1;
}
static bool in_box(const struct shape *s, const double *y)
{
    bool in = true;
    for (int k = 0; k < s->n; k++)
        in = in && fabs(y[k]) < s->half[k];
    return in;
}
/* A ball with two dents: to 0.8 where y0 = 1, to 0.6 where the last one is. */
static bool in_dented(const struct shape *s, const double *y)
{
    double square = 0;
    for (int k = 0; k < s->n; k++)
        square += y[k] * y[k];
    const double r = sqrt(square);
    const double first = 1 - y[0] / r, last = 1 - y[s->n - 1] / r;
    return r < 1 - 0.2 * exp(-first / 0.15) - 0.4 * exp(-last / 0.15);
}

static bool ask(void *context, size_t count, const double *z, uint8_t *inside)
{
    struct shape *s = context;
    for (size_t i = 0; i < count; i++) {
        double y[MOST] = {0};
        for (int k = 0; k < s->n; k++)
            for (int j = 0; j < s->n; j++)
                y[k] += s->axis[k][j] * z[i * (size_t)s->n + (size_t)j];
        inside[i] = s->holds(s, y);
    }
    s->asked += count;
    return true;
}

static double normal(uint64_t *random)
{
    return sqrt(-2 * log(uniform(random, 1e-12, 1))) * cos(uniform(random, 0, 2 * M_PI));
}

/* Random directions, by Gram and Schmidt. */
static void orient(struct shape *s, uint64_t *random)
{
    for (int k = 0; k < s->n; k++) {
        double square = 0;
        for (int j = 0; j < s->n; j++)
            s->axis[k][j] = normal(random);
        for (int i = 0; i < k; i++) {
            double along = 0;
            for (int j = 0; j < s->n; j++)
                along += s->axis[k][j] * s->axis[i][j];
            for (int j = 0; j < s->n; j++)
                s->axis[k][j] -= along * s->axis[i][j];
        }
        for (int j = 0; j < s->n; j++)
            square += s->axis[k][j] * s->axis[k][j];
        for (int j = 0; j < s->n; j++)
            s->axis[k][j] /= sqrt(square);
    }
}

/* The smallest distance over random rays, of which the shortest comes first among the starts. */
static double shoot(struct shape *s, uint64_t *random, double start[][MOST], double *r)
{
    double least = INFINITY;
    for (int k = 0; k < RAYS; k++) {
        double u[MOST], square = 0, low = 0, high = 50;
        for (int j = 0; j < s->n; j++) {
            u[j] = normal(random);
            square += u[j] * u[j];
        }
        for (int j = 0; j < s->n; j++)
            u[j] /= sqrt(square);
        while (high - low > 1e-6 * high) {
            double z[MOST];
            uint8_t in;
            for (int j = 0; j < s->n; j++)
                z[j] = 0.5 * (low + high) * u[j];
            ask(s, 1, z, &in);
            *(in ? &low : &high) = 0.5 * (low + high);
        }
        if (k < STARTS || low < least) {
            const int place = k < STARTS ? k : 0;
            memcpy(start[place], u, sizeof u);
            r[place] = low;
        }
        least = fmin(least, low);
    }
    return least;
}

static struct descend_end run(struct shape *s, uint64_t *random, double *rays)
{
    double start[STARTS][MOST], packed[STARTS * MOST], r[STARTS];
    struct descend_end end;
    const struct descend_set set = {s->n, 1 << true, ask, s};
    orient(s, random);
    *rays = shoot(s, random, start, r);
    for (int k = 0; k < STARTS; k++)
        memcpy(packed + k * s->n, start[k], (size_t)s->n * sizeof(double));
    s->asked = 0;
    assert_true(basin_descend(&set, 50, packed, r, STARTS, &end));
    assert_int_equal(end.asked, s->asked);
    assert_true(end.high - end.low <= 1.001e-4 * end.high && end.starts == STARTS);
    return end;
}

static double along(const struct shape *s, const struct descend_end *end, int k)
{
    double sum = 0;
    for (int j = 0; j < s->n; j++)
        sum += s->axis[k][j] * end->u[j];
    return fabs(sum);
}

TEST(ellipsoids)
{
    static const double kinds[][MOST] = {
        {1, 1.2, 1.5, 2, 2.5, 3}, {0.5, 1, 2, 4, 6, 8}, {1, 1.05, 5, 5, 5, 5}, {2, 2, 2, 2, 2, 2}};
    uint64_t random = 5;
    for (size_t kind = 0; kind < COUNT(kinds); kind++) {
        for (int n = 2; n <= MOST; n++) {
            double worst = 0, rays_off = 0, asked = 0;
            size_t agree = 0;
            for (int t = 0; t < 10; t++) {
                struct shape s = {.n = n, .holds = in_ellipsoid};
                double rays;
                memcpy(s.half, kinds[kind], sizeof s.half);
                const struct descend_end end = run(&s, &random, &rays);
                const double found = 0.5 * (end.low + end.high);
                assert_true(end.high > s.half[0]);
                worst = fmax(worst, found / s.half[0] - 1);
                rays_off += (rays / s.half[0] - 1) / 10;
                asked += (double)end.asked / STARTS / 10;
                agree += end.agree;
                assert_true(kind == 2 || kind == 3 || along(&s, &end, 0) > 0.99);
            }
            print_message("# ellipsoid %zu, %d dimensions: at most %.4f %% off, %d rays alone %.1f "
                          "%%; %.0f points a descent, %zu of %d agree\n",
                          kind, n, 100 * worst, RAYS, 100 * rays_off, asked, agree, 10 * STARTS);
            assert_true(worst < 2e-3);
            assert_true(agree >= 9 * STARTS);
        }
    }
}

TEST(faces_of_a_box)
{
    uint64_t random = 6;
    for (int n = 2; n <= MOST; n++) {
        struct shape s = {.n = n, .half = {1, 1.3, 1.6, 2, 2.5, 3}, .holds = in_box};
        double rays;
        const struct descend_end end = run(&s, &random, &rays);
        print_message("# box, %d dimensions: %.5f, %zu of %d agree, rays %.3f\n", n, end.high,
                      end.agree, STARTS, rays);
        assert_true(end.low < 1.002 && end.high > 1 && along(&s, &end, 0) > 0.995);
    }
}

/* Not all descents end in the deepest dent; the shortest of them does. */
TEST(dents)
{
    uint64_t random = 7;
    for (int n = 2; n <= 4; n++) {
        struct shape s = {.n = n, .holds = in_dented};
        double rays;
        const struct descend_end end = run(&s, &random, &rays);
        print_message("# dents, %d dimensions: %.5f, %zu of %d agree, rays %.3f\n", n, end.high,
                      end.agree, STARTS, rays);
        assert_true(fabs(end.high - 0.6) < 2e-3 && end.agree < STARTS);
        assert_true(along(&s, &end, n - 1) > 0.99);
    }
    assert_true(fabs(basin_descend_unseen(1) - 0.95) < 1e-12);
    assert_true(fabs(basin_descend_unseen(8) - 0.3123) < 1e-3);
}

/* How often a dip is missed by descents from even directions, and how often that was to be expected
 * of one that so many directions lead into. */
TEST(dips_that_are_missed)
{
    enum { SEEDS = 1000 };
    uint64_t random = 8;
    for (int n = 2; n <= 4; n++) {
        struct shape s = {.n = n, .holds = in_dented};
        bool found[SEEDS];
        int leading = 0, missed = 0;
        orient(&s, &random);
        for (int k = 0; k < SEEDS; k++) {
            double start[MOST], square = 0, r;
            struct descend_end end;
            for (int j = 0; j < n; j++) {
                start[j] = normal(&random);
                square += start[j] * start[j];
            }
            for (int j = 0; j < n; j++)
                start[j] /= sqrt(square);
            for (r = 1; r > 0.01; r -= 0.01) {
                double z[MOST];
                uint8_t in;
                for (int j = 0; j < n; j++)
                    z[j] = r * start[j];
                ask(&s, 1, z, &in);
                if (in)
                    break;
            }
            assert_true(basin_descend(&(struct descend_set){n, 1 << true, ask, &s}, 50, start, &r,
                                      1, &end));
            found[k] = end.high < 0.62;
            leading += found[k];
        }
        /* So many starts that what is said to be missed with 5 % is just that dip. */
        const double share = (double)leading / SEEDS;
        size_t starts = 1;
        while (starts < SEEDS / 2 && basin_descend_unseen(starts) > share)
            starts++;
        for (int t = 0; t < SEEDS; t++) {
            bool any = false;
            for (size_t k = 0; k < starts; k++)
                any = any || found[(int)uniform(&random, 0, SEEDS)];
            missed += !any;
        }
        print_message("# dips of %.1f %% of the directions, %d dimensions: missed by %d starts in "
                      "%.1f %%\n",
                      100 * share, n, (int)starts, 100.0 * missed / SEEDS);
        assert_true(missed < (0.05 + 0.02) * SEEDS);
    }
}

/* On a line, and where the set cannot be asked any more, or does not end. */
static bool refuse(void *context, size_t count, const double *z, uint8_t *inside)
{
    (void)context, (void)count, (void)z, (void)inside;
    return false;
}
static bool everywhere(void *context, size_t count, const double *z, uint8_t *inside)
{
    (void)context, (void)z;
    memset(inside, 1, count);
    return true;
}

TEST(edges)
{
    struct shape s = {.n = 1, .half = {0.7}, .axis = {{1}}, .holds = in_ellipsoid};
    const double line[2] = {-1, 1}, r[2] = {0.1, 3}, plane[2] = {0.6, 0.8};
    struct descend_end end;
    assert_true(basin_descend(&(struct descend_set){1, 1 << true, ask, &s}, 50, line, r, 2, &end));
    assert_true(fabs(end.high - 0.7) < 1e-4 && end.agree == 2);
    assert_false(
        basin_descend(&(struct descend_set){2, 1 << true, refuse, NULL}, 1, plane, r, 1, &end));
    assert_true(
        basin_descend(&(struct descend_set){2, 1 << true, everywhere, NULL}, 1, plane, r, 1, &end));
    assert_false(isfinite(end.high));
}
