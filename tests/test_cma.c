/* Evolution strategy: evaluations needed against those of another program, one generation after the
 * other against the tutorial's equations written down a second time, asked points against their
 * distribution, ranges as images of all numbers. */
#include <float.h>
#include <lapacke.h>

#include "cases.h"
#include "tests.h"

#include "runner/optimise/cma.h"

enum { MOST = CMA_MAX_COORDINATES };

static double free_low[MOST], free_high[MOST];

static int without_bounds(void **state)
{
    (void)state;
    for (int j = 0; j < MOST; j++) {
        free_low[j] = -INFINITY;
        free_high[j] = INFINITY;
    }
    return 0;
}

static void cma_gone(struct cma *const *s)
{
    cma_free(*s);
}
#define CMA FREED(cma_gone) struct cma

static struct cma *made_within(const struct cma_start *start)
{
    struct cma *s = cma_make(start);
    assert_non_null(s);
    return s;
}

static struct cma *made(int n, int lambda, const double *mean, double step, uint64_t seed)
{
    return made_within(&(struct cma_start){n, lambda, mean, free_low, free_high, step, seed, 0});
}

/* ---- objectives ------------------------------------------------------------------------------ */

typedef double objective(int n, const double *x);

static double sphere(int n, const double *x)
{
    double sum = 0;
    for (int j = 0; j < n; j++)
        sum += x[j] * x[j];
    return sum;
}

static double ellipsoid(int n, const double *x)
{
    double sum = 0;
    for (int j = 0; j < n; j++)
        sum += pow(1e6, (double)j / fmax(1, n - 1)) * x[j] * x[j];
    return sum;
}

/* Rows orthonormal: eigenvectors of a random matrix. */
static void random_rotation(int n, uint64_t seed, double *q)
{
    double a[MOST * MOST], value[MOST];
    for (int i = 0; i < n; i++)
        for (int j = 0; j <= i; j++)
            a[i * n + j] = a[j * n + i] = uniform(&seed, -1, 1);
    symmetric_eigen(n, a, value, q);
}

static double rotated_ellipsoid(int n, const double *x)
{
    static double q[MOST * MOST];
    static int made_for;
    double y[MOST] = {0};
    if (made_for != n)
        random_rotation(made_for = n, 3, q);
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++)
            y[i] += q[i * n + j] * x[j];
    return ellipsoid(n, y);
}

static double rosenbrock(int n, const double *x)
{
    double sum = 0;
    for (int j = 0; j + 1 < n; j++)
        sum += 100 * pow(x[j] * x[j] - x[j + 1], 2) + pow(x[j] - 1, 2);
    return sum;
}

/* Of non-negative numbers the smaller, the better, exactly. */
static int64_t score_of(double f)
{
    int64_t bits;
    memcpy(&bits, &f, sizeof bits);
    return -bits;
}

/* One generation; the best value of it. */
static double generation(struct cma *s, objective *f)
{
    enum { MOST_CANDIDATES = 30000, MOST_NUMBERS = 150000 };
    static double x[MOST_NUMBERS];
    static int64_t score[MOST_CANDIDATES];
    double best = INFINITY;
    assert_true(s->lambda <= MOST_CANDIDATES && s->n * s->lambda <= MOST_NUMBERS);
    cma_ask(s, x);
    for (int i = 0; i < s->lambda; i++) {
        const double value = f(s->n, x + i * s->n);
        best = fmin(best, value);
        score[i] = score_of(value);
    }
    assert_true(cma_tell(s, x, score));
    return best;
}

/* Candidates until one is below 1e-9: means of some seeds beside those of pycma 4.4.0 (7 seeds,
 * CMA_active, same starts; the ellipsoid without active covariance takes it 6000 at n = 10). */
TEST(evaluations)
{
    static const struct {
        const char *name;
        objective *f;
        int n, seeds;
        double start, step, expected;
    } table[] = {
        {"sphere", sphere, 1, 9, 3, 2, 118},
        {"sphere", sphere, 2, 9, 3, 2, 264},
        {"sphere", sphere, 10, 5, 3, 2, 1697},
        {"sphere", sphere, 12, 5, 3, 2, 1932},
        {"sphere", sphere, 56, 1, 3, 2, 7744},
        {"ellipsoid", ellipsoid, 2, 9, 3, 2, 460},
        {"ellipsoid", ellipsoid, 10, 5, 3, 2, 4298},
        {"ellipsoid", ellipsoid, 12, 3, 3, 2, 5548},
        {"rotated ellipsoid", rotated_ellipsoid, 10, 5, 3, 2, 4298},
        {"Rosenbrock", rosenbrock, 2, 9, 0, 0.5, 423},
        {"Rosenbrock", rosenbrock, 10, 5, 0, 0.5, 4990},
    };
    for (size_t t = 0; t < COUNT(table); t++) {
        const int n = table[t].n;
        double mean[MOST], sum = 0;
        for (int j = 0; j < n; j++)
            mean[j] = table[t].start * (j % 2 ? 1 : -1);
        for (int seed = 1; seed <= table[t].seeds; seed++) {
            CMA *s = made(n, 0, mean, table[t].step, (uint64_t)seed);
            while (generation(s, table[t].f) > 1e-9)
                assert_true(s->generation < 10000);
            sum += (double)(s->generation * (uint64_t)s->lambda);
        }
        const double share = sum / table[t].seeds / table[t].expected;
        print_message("# %s of %d: %.0f candidates, %.2f of pycma's\n", table[t].name, n,
                      sum / table[t].seeds, share);
        assert_true(share > 0.75 && share < 1.3);
    }
}

/* ---- the equations, a second time ------------------------------------------------------------ */

enum { N = 5, LAMBDA = 9 };

struct plain {
    double m[N], c[N * N], p[N], ps[N], step;
    int generation;
};

/* y to C^power y. */
static void power_of(const double *c, double power, const double *y, double *result)
{
    double v[N * N], w[N];
    memcpy(v, c, sizeof v);
    assert_int_equal(LAPACKE_dsyev(LAPACK_ROW_MAJOR, 'V', 'U', N, v, N, w), 0);
    memset(result, 0, N * sizeof *result);
    for (int k = 0; k < N; k++) {
        double along = 0;
        for (int j = 0; j < N; j++)
            along += v[j * N + k] * y[j];
        for (int j = 0; j < N; j++)
            result[j] += v[j * N + k] * along * pow(w[k], power);
    }
}

/* The tutorial's figure 6 with its table 1; x sorted, the best first. */
static void plain_tell(struct plain *s, double x[LAMBDA][N])
{
    const double n = N, lambda = LAMBDA;
    const int mu = LAMBDA / 2;
    double w[LAMBDA], plus = 0, plus2 = 0, minus = 0, minus2 = 0, all = 0;
    for (int i = 0; i < LAMBDA; i++) {
        w[i] = log((lambda + 1) / 2) - log(i + 1.0);
        plus += i < mu ? w[i] : 0;
        plus2 += i < mu ? w[i] * w[i] : 0;
        minus -= i < mu ? 0 : w[i];
        minus2 += i < mu ? 0 : w[i] * w[i];
    }
    const double mueff = plus * plus / plus2, mueffm = minus * minus / minus2;
    const double cs = (mueff + 2) / (n + mueff + 5);
    const double ds = 1 + 2 * fmax(0, sqrt((mueff - 1) / (n + 1)) - 1) + cs;
    const double cc = (4 + mueff / n) / (n + 4 + 2 * mueff / n);
    const double c1 = 2 / (pow(n + 1.3, 2) + mueff);
    const double cmu =
        fmin(1 - c1, 2 * (0.25 + mueff + 1 / mueff - 2) / (pow(n + 2, 2) + 2 * mueff / 2));
    const double most =
        fmin(fmin(1 + c1 / cmu, 1 + 2 * mueffm / (mueff + 2)), (1 - c1 - cmu) / (n * cmu));
    const double chi = sqrt(2) * tgamma((n + 1) / 2) / tgamma(n / 2);
    double y[LAMBDA][N], yw[N] = {0}, z[N], c[N * N];
    for (int i = 0; i < LAMBDA; i++) {
        w[i] = i < mu ? w[i] / plus : w[i] * most / minus;
        all += w[i];
        for (int j = 0; j < N; j++) {
            y[i][j] = (x[i][j] - s->m[j]) / s->step;
            yw[j] += i < mu ? w[i] * y[i][j] : 0;
        }
    }
    power_of(s->c, -0.5, yw, z);
    double length = 0;
    for (int j = 0; j < N; j++) {
        s->m[j] += s->step * yw[j];
        s->ps[j] = (1 - cs) * s->ps[j] + sqrt(cs * (2 - cs) * mueff) * z[j];
        length += s->ps[j] * s->ps[j];
    }
    length = sqrt(length);
    s->generation++;
    const int h = length / sqrt(1 - pow(1 - cs, 2 * s->generation)) < (1.4 + 2 / (n + 1)) * chi;
    for (int j = 0; j < N; j++)
        s->p[j] = (1 - cc) * s->p[j] + h * sqrt(cc * (2 - cc) * mueff) * yw[j];
    for (int k = 0; k < N * N; k++)
        c[k] = (1 + c1 * (1 - h) * cc * (2 - cc) - c1 - cmu * all) * s->c[k] +
               c1 * s->p[k / N] * s->p[k % N];
    for (int i = 0; i < LAMBDA; i++) {
        power_of(s->c, -0.5, y[i], z);
        const double weight = w[i] < 0 ? w[i] * n / sphere(N, z) : w[i];
        for (int k = 0; k < N * N; k++)
            c[k] += cmu * weight * y[i][k / N] * y[i][k % N];
    }
    memcpy(s->c, c, sizeof c);
    s->step *= exp(fmin(1, cs / ds * (length / chi - 1)));
}

/* Points of any kind, near and far, so that h is 0 and 1. */
TEST(the_equations)
{
    uint64_t random = 5;
    struct plain s = {.step = 0.3};
    CMA *cma = made(N, LAMBDA, s.m, s.step, 1);
    for (int j = 0; j < N; j++)
        s.c[j * N + j] = 1;
    for (int g = 0; g < 60; g++) {
        double x[LAMBDA][N], told[LAMBDA][N];
        int64_t score[LAMBDA];
        const double spread = g % 20 == 7 ? 8 : 1.5;
        for (int i = 0; i < LAMBDA; i++) {
            for (int j = 0; j < N; j++)
                x[i][j] = s.m[j] + s.step * uniform(&random, -spread, spread) * (j + 1);
            memcpy(told[(i * 4 + g) % LAMBDA], x[i], sizeof x[i]);
            score[(i * 4 + g) % LAMBDA] = i < LAMBDA - 1 ? -i : INT64_MIN;
        }
        assert_true(cma_tell(cma, told[0], score));
        plain_tell(&s, x);
        /* Of E|z| the program has the tutorial's approximation. */
        assert_true(fabs(cma->step / s.step - 1) < 2e-3);
        s.step = cma->step;
        for (int j = 0; j < N; j++)
            assert_true(fabs(cma->mean[j] - s.m[j]) < 1e-10 * (1 + fabs(s.m[j])));
        for (int k = 0; k < N * N; k++)
            assert_true(fabs(cma->covariance[k] - s.c[k]) <
                        1e-10 * sqrt(s.c[k / N * N + k / N] * s.c[k % N * N + k % N]));
    }
}

/* ---- what is asked --------------------------------------------------------------------------- */

/* Of a distribution that has adapted: mean, covariance, shares within one and two deviations, all
 * within five standard errors. */
TEST(asked_points)
{
    enum { n = 5, count = 30000 };
    const double zero[n] = {0};
    double *x = malloc(sizeof(double[n]) * count), mean[n] = {0}, c[n * n] = {0};
    int within[n][2] = {0};
    CMA *s = made(n, count, zero, 0.5, 11);
    assert_non_null(x);
    for (int g = 0; g < 3; g++)
        generation(s, rotated_ellipsoid);
    assert_true(s->axis[n - 1] > 3 * s->axis[0]);
    cma_ask(s, x);
    for (int i = 0; i < count * n; i++)
        x[i] = (x[i] - s->mean[i % n]) / s->step;
    for (int i = 0; i < count; i++) {
        for (int j = 0; j < n; j++) {
            const double deviation = sqrt(s->covariance[j * n + j]);
            mean[j] += x[i * n + j] / count;
            within[j][0] += fabs(x[i * n + j]) < deviation;
            within[j][1] += fabs(x[i * n + j]) < 2 * deviation;
        }
        for (int k = 0; k < n * n; k++)
            c[k] += x[i * n + k / n] * x[i * n + k % n] / count;
    }
    for (int j = 0; j < n; j++) {
        assert_true(fabs(mean[j]) < 5 * sqrt(s->covariance[j * n + j] / count));
        for (int two = 0; two < 2; two++) {
            const double share = erf((1 + two) / sqrt(2));
            assert_true(fabs((double)within[j][two] / count - share) <
                        5 * sqrt(share * (1 - share) / count));
        }
    }
    for (int k = 0; k < n * n; k++) {
        const double *const own = s->covariance;
        const double product = own[k / n * (n + 1)] * own[k % n * (n + 1)];
        assert_true(fabs(c[k] - own[k]) < 5 * sqrt((product + own[k] * own[k]) / count));
    }
    free(x);
}

/* No number twice, and none that goes with another: candidates, coordinates, generations, restarts
 * and seeds. */
TEST(independent)
{
    enum { n = 7, lambda = 200, runs = 12 };
    static double z[runs][lambda * n];
    const double zero[n] = {0};
    int64_t score[lambda] = {0};
    for (int r = 0; r < runs; r++) {
        const uint64_t seed = (uint64_t)r / 4, restart = (uint64_t)r / 2 % 2;
        CMA *s = made_within(
            &(struct cma_start){n, lambda, zero, free_low, free_high, 1, seed, restart});
        cma_ask(s, z[r]);
        if (r % 2) { /* the second generation of what is still round */
            for (int i = 0; i < lambda * n; i++)
                z[r][i] = 0;
            assert_true(cma_tell(s, z[r], score));
            cma_ask(s, z[r]);
            for (int i = 0; i < lambda * n; i++)
                z[r][i] /= s->step * s->axis[0];
        }
    }
    const double *const all = z[0];
    const int count = runs * lambda * n,
              steps[] = {1, 2, 4, n, 2 * n, lambda * n, 2 * lambda * n, 4 * lambda * n};
    for (size_t k = 0; k < COUNT(steps); k++) {
        double product = 0;
        for (int i = 0; i + steps[k] < count; i++) {
            product += all[i] * all[i + steps[k]];
            assert_true(all[i] != all[i + steps[k]]);
        }
        assert_true(fabs(product) < 5 * sqrt(count));
    }
}

static void hash_state(const struct cma *s, uint64_t *h)
{
    const int n = s->n;
    *h = hash(&s->step, sizeof s->step, *h);
    *h = hash(s->mean, (size_t)n * sizeof(double), *h);
    *h = hash(s->axis, (size_t)n * sizeof(double), *h);
    *h = hash(s->covariance, (size_t)(n * n) * sizeof(double), *h);
}

/* The same bits twice; from what was told alone; from scores in the same order. */
TEST(same_bits)
{
    const int sizes[] = {1, 2, 12, 40};
    for (int t = 0; t < 4; t++) {
        const int n = sizes[t];
        double mean[MOST];
        for (int j = 0; j < n; j++)
            mean[j] = 1 + j;
        struct cma *a = made(n, 0, mean, 0.5, 3), *b = made(n, 0, mean, 0.5, 3),
                   *other = made(n, 0, mean, 0.5, 4);
        CMA *retold = made(n, 0, mean, 0.5, 99);
        uint64_t h[4] = {0};
        for (int g = 0; g < 30; g++) {
            double x[MOST * 16], y[MOST * 16];
            int64_t score[16];
            cma_ask(a, x);
            cma_ask(a, y);
            assert_memory_equal(x, y, sizeof(double) * (size_t)(n * a->lambda));
            cma_ask(b, y);
            assert_memory_equal(x, y, sizeof(double) * (size_t)(n * a->lambda));
            for (int i = 0; i < a->lambda; i++)
                score[i] = -(int64_t)ellipsoid(n, x + i * n) / 100000;
            assert_true(cma_tell(a, x, score));
            for (int i = 0; i < a->lambda; i++)
                score[i] = 3 * score[i] - 7;
            assert_true(cma_tell(b, x, score));
            assert_true(cma_tell(retold, x, score));
            generation(other, ellipsoid);
            hash_state(a, &h[0]);
            hash_state(b, &h[1]);
            hash_state(retold, &h[2]);
            hash_state(other, &h[3]);
        }
        assert_true(h[0] == h[1] && h[0] == h[2] && h[0] != h[3]);
        cma_free(a);
        cma_free(b);
        cma_free(other);
    }
}

/* Of equal ones the first: as if it were better. */
TEST(ties)
{
    enum { n = 3, lambda = 7 };
    const double zero[n] = {0};
    const int64_t tied[lambda] = {5, -1, 5, 0, 0, -1, 5}, strict[lambda] = {9, 4, 8, 6, 5, 3, 7};
    struct cma *a = made(n, lambda, zero, 1, 1), *b = made(n, lambda, zero, 1, 1);
    double x[n * lambda];
    uint64_t h[2] = {0};
    cma_ask(a, x);
    assert_true(cma_tell(a, x, tied) && cma_tell(b, x, strict));
    hash_state(a, &h[0]);
    hash_state(b, &h[1]);
    assert_true(h[0] == h[1]);
    cma_free(a);
    cma_free(b);
}

/* ---- bounds ---------------------------------------------------------------------------------- */

/* Within which candidates must be, and how near to the optimum that leaves. */
static double within_low[MOST], within_high[MOST], nearest;

static double shifted_sphere(int n, const double *x)
{
    double sum = -nearest;
    for (int j = 0; j < n; j++) {
        assert_true(within_low[j] <= x[j] && x[j] <= within_high[j]);
        sum += (x[j] - 1) * (x[j] - 1);
    }
    return fmax(0, sum);
}

/* The first half of the coordinates may not be above 0.5, where the best is: found as fast as
 * without bounds. */
TEST(optimum_on_bounds)
{
    const int sizes[] = {1, 2, 12, 20};
    for (int t = 0; t < 4; t++) {
        const int n = sizes[t], bound = (n + 1) / 2;
        double mean[MOST];
        int candidates[2] = {0};
        for (int with = 0; with < 2; with++) {
            nearest = with ? 0.25 * bound : 0;
            for (int j = 0; j < n; j++) {
                mean[j] = j % 3 ? -1 : 0.5;
                within_low[j] = with && j % 4 ? -1 : -INFINITY;
                within_high[j] = with && j < bound ? 0.5 : INFINITY;
            }
            CMA *s =
                made_within(&(struct cma_start){n, 0, mean, within_low, within_high, 0.5, 1, 0});
            for (double best = INFINITY; best > 1e-6; candidates[with] += s->lambda) {
                best = generation(s, shifted_sphere);
                shifted_sphere(n, s->mean); /* is within bounds, too */
                assert_true(candidates[with] < 400 * n);
            }
        }
        print_message("# %d of %d coordinates at a bound: %d candidates, without bounds %d\n",
                      bound, n, candidates[1], candidates[0]);
        assert_true(candidates[1] < 1.2 * candidates[0] + 50);
    }
}

static double nothing(int n, const double *x)
{
    (void)n;
    (void)x;
    return 0;
}

static double shell(int n, const double *x)
{
    return fabs(sphere(n, x) - 0.3);
}

/* A first step far beyond the range, and scores that say nothing for a while. */
TEST(narrow_ranges)
{
    enum { n = 5 };
    const double mean[n] = {0, 1, 1, 0, 0.5}, low[n] = {0, 0, 0, 0, 0}, high[n] = {1, 1, 1, 1, 1};
    CMA *s = made_within(&(struct cma_start){n, 10, mean, low, high, 30, 5, 0});
    for (int g = 0; cma_stop(s) != CMA_SMALL; g++) {
        assert_true(g < 500);
        for (int j = 0; j < n; j++)
            assert_true(s->step * sqrt(s->covariance[j * n + j]) < 0.334);
        generation(s, g < 150 ? nothing : shell);
    }
    assert_true(shell(n, s->mean) < 1e-3);
}

/* Every kind of range: within it, without jumps, slopes of at most 1, mirrored at each
 * bound; what goes back and forth is the same, on the side it came from. */
TEST(image_of_a_range)
{
    const struct bounds table[] = {
        {-1, 2, 0.1},          {-1, 2, 1.5},       {0, INFINITY, 0.5},
        {-INFINITY, 2, 0.25},  {5, 5.001, 0.0002}, {-INFINITY, INFINITY, 1},
        {-1e100, 1e100, 1e-3}, {-7, -6, 1e-9},     {0, 1e-100, 1e-101}};
    for (size_t t = 0; t < COUNT(table); t++) {
        const struct bounds *const b = &table[t];
        const double unit = t == 8 ? 1e-100 : 1;
        double before = bounds_image(b, -10 * unit), most_x = -INFINITY, least_x = INFINITY;
        uint64_t seed = t;
        for (int i = -9999; i <= 10000; i++) {
            const double u = i * 1e-3 * unit, x = bounds_image(b, u);
            assert_true(b->low <= x && x <= b->high);
            assert_true(fabs(x - before) < 1.0001e-3 * unit);
            assert_true(bounds_preimage(b, x, u) == u);
            before = x;
            most_x = fmax(most_x, x);
            least_x = fmin(least_x, x);
            const double other =
                uniform(&seed, b->low < -20 ? -3 : b->low, b->high > 20 ? 3 : b->high);
            const double v = bounds_preimage(b, other, u);
            assert_true(fabs(bounds_image(b, v) - other) < 1e-13 * fmax(unit, fabs(u)));
            assert_true(fabs(v - u) <= 2 * (b->high - b->low + 2 * b->margin));
        }
        assert_true(most_x > fmin(b->high, 9) - 1e-6 && least_x < fmax(b->low, -9) + 1e-6);
        assert_true(isinf(b->low) || bounds_image(b, b->low - b->margin) == b->low);
        assert_true(fabs(bounds_image(b, 1e300)) <= 1e300);
    }
    const struct bounds *const b = &table[0];
    for (double d = 0; d < 3.2; d += 0.01) { /* vertices at -1.1 and 2.1 */
        assert_true(fabs(bounds_image(b, -1.1 + d) - bounds_image(b, -1.1 - d)) < 1e-14);
        assert_true(fabs(bounds_image(b, 2.1 + d) - bounds_image(b, 2.1 - d)) < 1e-14);
        assert_true(fabs(bounds_image(b, 2.1 + d) - bounds_image(b, 2.1 + d + 6.4)) < 1e-14);
    }
    assert_true(bounds_image(b, 0.7) == 0.7 && bounds_preimage(b, 0.7, -0.2) == 0.7);
    assert_true(fabs(bounds_image(b, -1.1 + 0.1) - (-1 + 0.01 / 0.4)) < 1e-15);
    assert_true(fabs(bounds_preimage(b, 0, -1.2) + 2.2) < 1e-14);
    assert_true(fabs(bounds_preimage(b, 0, -3) + 2.2) < 1e-14);
    assert_true(fabs(bounds_preimage(b, 0, 2.2) - 4.2) < 1e-14);
}

/* ---- scores that are counts ------------------------------------------------------------------ */

/* Lost of 512: all of them far away, none on a plateau around the optimum. */
static double lost_of_512(int n, const double *x)
{
    const double wide = exp(-0.5 * (sqrt(sphere(n, x)) - 1));
    return 512 - floor(512 * fmin(1, wide * (0.75 + 0.25 * exp(-x[0] * x[0]))));
}

TEST(plateaus)
{
    const int sizes[] = {1, 2, 12, 56};
    for (int t = 0; t < 4; t++) {
        const int n = sizes[t];
        double mean[MOST];
        for (int j = 0; j < n; j++)
            mean[j] = 8 / sqrt(n);
        CMA *s = made(n, 0, mean, 0.3, 2);
        int candidates = s->lambda;
        assert_true(lost_of_512(n, mean) > 512 - 25);
        for (; generation(s, lost_of_512) > 0; candidates += s->lambda)
            assert_true(candidates < 200 + 100 * n);
        print_message("# counts, %d coordinates: %d candidates\n", n, candidates);
    }
}

/* Where all scores are equal nothing drives the step: its logarithm goes at random about 0. */
TEST(flat)
{
    enum { n = 6, lambda = 9, seeds = 40 };
    const double zero[n] = {0};
    double sum = 0, squares = 0;
    for (uint64_t seed = 0; seed < seeds; seed++) {
        CMA *s = made(n, lambda, zero, 1, seed);
        for (int g = 0; g < 200; g++)
            generation(s, nothing);
        const double far = log(s->step);
        sum += far;
        squares += far * far;
    }
    print_message("# flat, 200 generations: ln step %.2f +- %.2f\n", sum / seeds,
                  sqrt(squares) / seeds);
    assert_true(fabs(sum) < 4 * sqrt(squares));
}

/* ---- hostile --------------------------------------------------------------------------------- */

TEST(refused)
{
    const double mean[2] = {0, 1}, low[2] = {-1, -1}, high[2] = {1, 1}, nan[2] = {0, NAN};
    const double infinite[2] = {INFINITY, 0}, outside[2] = {0, 1.5}, wrong[2] = {-1, 1};
    const struct cma_start good = {2, 2, mean, low, high, 1, UINT64_MAX, UINT64_MAX};
    const struct {
        int n, lambda;
    } sizes[] = {{0, 0}, {-1, 0}, {MOST + 1, 0}, {2, 1}, {2, -4}, {2, CMA_MAX_CANDIDATES + 1}};
    const double steps[] = {0, -1, NAN, INFINITY};
    const double *const ranges[][3] = {{nan, low, high},     {infinite, free_low, free_high},
                                       {outside, low, high}, {mean, nan, high},
                                       {mean, low, nan},     {mean, high, low},
                                       {mean, wrong, high}};
    cma_free(made_within(&good));
    cma_free(NULL);
    for (int i = 0; i < 6; i++)
        assert_null(
            cma_make(&(struct cma_start){sizes[i].n, sizes[i].lambda, mean, low, high, 1, 1, 0}));
    for (int i = 0; i < 4; i++)
        assert_null(cma_make(&(struct cma_start){2, 0, mean, low, high, steps[i], 1, 0}));
    for (int i = 0; i < 7; i++)
        assert_null(
            cma_make(&(struct cma_start){2, 0, ranges[i][0], ranges[i][1], ranges[i][2], 1, 1, 0}));
}

TEST(told_nonsense)
{
    enum { n = 3, lambda = 7 };
    const double zero[n] = {0}, low[n] = {-1, -INFINITY, -INFINITY},
                 high[n] = {1, INFINITY, INFINITY};
    const double nonsense[] = {NAN, INFINITY, -INFINITY, 1.5, 1e101};
    CMA *s = made_within(&(struct cma_start){n, lambda, zero, low, high, 0.1, 1, 0});
    double x[n * lambda];
    int64_t score[lambda] = {INT64_MIN, INT64_MAX, 0, -1, 1, INT64_MIN, INT64_MAX};
    uint64_t before = 0, after = 0;
    cma_ask(s, x);
    assert_true(cma_tell(s, x, score));
    cma_ask(s, x);
    hash_state(s, &before);
    for (int i = 0; i < 5; i++) {
        const int place = i == 3 ? n * (lambda - 1) : n * lambda - 1;
        const double kept = x[place];
        x[place] = nonsense[i];
        assert_false(cma_tell(s, x, score));
        x[place] = kept;
    }
    hash_state(s, &after);
    assert_true(before == after && s->generation == 1);
    assert_true(cma_tell(s, x, score) && s->generation == 2);
}

static void check_finite(const struct cma *s)
{
    const int n = s->n;
    assert_true(isfinite(s->step) && s->step > 0);
    for (int j = 0; j < n; j++)
        assert_true(isfinite(s->mean[j]) && isfinite(s->axis[j]) && s->axis[j] > 0);
    for (int k = 0; k < n * n; k++)
        assert_true(isfinite(s->covariance[k]));
}

/* Long after every reason to stop: no candidate differs from the mean, all are far away in turn,
 * one direction alone counts, the score grows for ever. */
TEST(numbers_stay_finite)
{
    enum { n = 3, lambda = 7, generations = 4000 };
    const double zero[n] = {0};
    double x[n * lambda];
    int64_t score[lambda];
    for (int kind = 0; kind < 4; kind++) {
        CMA *s = made(n, lambda, zero, 1, 1);
        for (int g = 0; g < generations; g++) {
            cma_ask(s, x);
            for (int i = 0; i < lambda; i++) {
                for (int j = 0; j < n && kind < 2; j++)
                    x[i * n + j] = kind == 0 ? s->mean[j] : (i + j + g) % 3 * 1e99;
                score[i] = kind == 2 ? -score_of(fabs(x[i * n])) : i;
            }
            if (!cma_tell(s, x, score))
                break;
        }
        check_finite(s);
        assert_true(cma_stop(s) != CMA_GOES_ON);
    }
}

/* ---- stops ----------------------------------------------------------------------------------- */

static double two_scales(int n, const double *x)
{
    return sphere(n - 1, x) * 1e-18 + fabs(x[n - 1]);
}

static double away(int n, const double *x)
{
    return exp(-sqrt(sphere(n, x)) / 1e4);
}

/* The largest standard deviation of a coordinate. */
static double widest(const struct cma *s)
{
    double most = 0;
    for (int j = 0; j < s->n; j++)
        most = fmax(most, s->step * sqrt(s->covariance[j * s->n + j]));
    return most;
}

TEST(stops)
{
    enum { n = 4 };
    const double ones[n] = {1, 1, 1, 1};
    const struct {
        objective *f;
        enum cma_stop expected;
    } table[] = {{sphere, CMA_SMALL}, {two_scales, CMA_CONDITION}, {away, CMA_DIVERGED}};
    assert_string_equal(cma_stop_words[CMA_GOES_ON], "");
    for (int t = 0; t < 3; t++) {
        CMA *s = made(n, 0, ones, 0.1, 1);
        assert_int_equal(cma_stop(s), CMA_GOES_ON);
        double wide = INFINITY; /* before the last generation */
        while (cma_stop(s) == CMA_GOES_ON) {
            wide = widest(s);
            generation(s, table[t].f);
            assert_true(s->generation < 5000);
        }
        print_message("# %s after %d generations\n", cma_stop_words[cma_stop(s)],
                      (int)s->generation);
        assert_int_equal(cma_stop(s), table[t].expected);
        assert_true(wide >= 1e-3 && (widest(s) < 1e-3) == (cma_stop(s) == CMA_SMALL));
    }
}

static CMFixtureFunction before_tests = without_bounds;
