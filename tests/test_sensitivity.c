/* test_sensitivity.c - sensitivity indices against functions whose indices are known in closed
 * form, how often their intervals hold these, and tables of comma-separated values. */
#include "long.h"
#include "tests.h"

#include "analysis/sensitivity/sensitivity.h"
#include "runner/scenario/doe.h"

#include <Random123/philox.h>

/* ---- functions on the unit cube ----------------------------------------------------------- */

enum { MOST = 20 };
static const double pi = 3.14159265358979323846;

struct function {
    const char *name;
    size_t factors;
    double (*value)(const double *u);
    double first[8], total[8];
};

/* Ishigami and Homma (1990): sin x1 + 7 sin^2 x2 + 0.1 x3^4 sin x1, x uniform on -pi ... pi. The
 * means of sin^2, sin^4 and x^8 give the parts of the variance: V1 = (1 + b pi^4 / 5)^2 / 2,
 * V2 = a^2 / 8, V13 = 8 b^2 pi^8 / 225. */
static double ishigami(const double *u)
{
    const double x = pi * (2 * u[0] - 1), y = pi * (2 * u[1] - 1), z = pi * (2 * u[2] - 1);
    return sin(x) + 7 * sin(y) * sin(y) + 0.1 * z * z * z * z * sin(x);
}
#define PI4 (M_PI * M_PI * M_PI * M_PI)
#define V1 ((1 + 0.1 * PI4 / 5) * (1 + 0.1 * PI4 / 5) / 2)
#define V2 (49.0 / 8)
#define V13 (8 * 0.01 * PI4 * PI4 / 225)
#define ISHIGAMI                                                                                   \
    {V1 / (V1 + V2 + V13), V2 / (V1 + V2 + V13)},                                                  \
    {                                                                                              \
        (V1 + V13) / (V1 + V2 + V13), V2 / (V1 + V2 + V13), V13 / (V1 + V2 + V13)                  \
    }

/* Sobol's g-function: product of (|4 u - 2| + a) / (1 + a), each factor of mean 1 and variance
 * 1 / (3 (1 + a)^2). */
enum { G = 8 };
static const double weights[G] = {0, 1, 4.5, 9, 99, 99, 99, 99};
static double g_function(const double *u)
{
    double product = 1;
    for (size_t j = 0; j < G; j++)
        product *= (fabs(4 * u[j] - 2) + weights[j]) / (1 + weights[j]);
    return product;
}

/* Far from zero, with a product: x1 + x2 / 2 + 3 (x1 - 1/2) (x3 - 1/2) + 1000; variances in
 * 48ths: 4, 1 and 3. */
static double shifted(const double *u)
{
    return 1000 + u[0] + u[1] / 2 + 3 * (u[0] - 0.5) * (u[2] - 0.5);
}

/* Steps: one in each of two factors at once, 9 % inside; a slanted one; of one factor alone. A
 * third factor does nothing. */
static double corner(const double *u)
{
    return u[0] < 0.3 && u[1] < 0.3;
}
#define CORNER (0.3 * 0.3 * 0.3 * 0.7 / (0.09 * 0.91))
static double slanted(const double *u)
{
    return u[0] + u[1] < 1;
}
static double step(const double *u)
{
    return u[0] < 0.37;
}

/* Waves, alone and as a product: variances 1/2 and 1/4. */
static double waves(const double *u)
{
    return cos(18 * pi * u[0]) + cos(10 * pi * u[1]) * cos(14 * pi * u[2]);
}

/* Of a fourth factor that does nothing what it changes is how the coordinates of a design are
 * paired. */
static struct function functions[] = {
    {"Ishigami", 3, ishigami, ISHIGAMI},
    {"Sobol' g", G, g_function, {0}, {0}}, /* filled in */
    {"shifted", 3, shifted, {4 / 8.0, 1 / 8.0}, {7 / 8.0, 1 / 8.0, 3 / 8.0}},
    {"Ishigami and inert", 4, ishigami, ISHIGAMI},
    {"corner", 3, corner, {CORNER, CORNER}, {1 - CORNER, 1 - CORNER}},
    {"slanted", 3, slanted, {1 / 3.0, 1 / 3.0}, {2 / 3.0, 2 / 3.0}},
    {"step", 3, step, {1}, {1}},
    {"waves", 3, waves, {2 / 3.0}, {2 / 3.0, 1 / 3.0, 1 / 3.0}},
};
enum { FUNCTIONS = sizeof functions / sizeof functions[0], SMOOTH = 3 };

static double g_variance(void) /* and 1 */
{
    double all = 1;
    for (size_t j = 0; j < G; j++)
        all *= 1 + 1 / (3 * (1 + weights[j]) * (1 + weights[j]));
    return all;
}

static int fill_in(void **state __attribute__((unused)))
{
    const double all = g_variance();
    for (size_t j = 0; j < G; j++) {
        const double v = 1 / (3 * (1 + weights[j]) * (1 + weights[j]));
        functions[1].first[j] = v / (all - 1);
        functions[1].total[j] = v * all / (1 + v) / (all - 1);
    }
    return 0;
}
static CMFixtureFunction before_tests = fill_in;

/* ---- designs ------------------------------------------------------------------------------ */

struct data {
    struct doe doe;
    size_t points, factors;
    double *u, *y;
};

/* A design's responses; `independent`: blocks of Saltelli's order from random points. */
static struct data make(enum doe_method method, const struct function *f, uint64_t count,
                        uint64_t seed, bool second_order, bool independent)
{
    struct data d = {.doe = {.method = method,
                             .count = count,
                             .factors = f->factors,
                             .levels = 4,
                             .second_order = second_order,
                             .seed = seed}};
    const size_t k = f->factors;
    assert_true(doe_begin(&d.doe));
    d.points = (size_t)doe_points(&d.doe);
    d.factors = k;
    d.u = malloc(d.points * k * sizeof *d.u);
    d.y = malloc(d.points * sizeof *d.y);
    const size_t block = (size_t)doe_block(&d.doe);
    for (size_t i = 0; i < d.points; i++) {
        double *u = d.u + i * k;
        doe_unit(&d.doe, i, u);
        if (independent) {
            for (size_t j = 0; j < k; j++) {
                const bool from_b = i % block == block - 1 || i % block == j + 1;
                const philox4x64_key_t key = {{seed, 7}};
                const philox4x64_ctr_t counter = {{i / block, j, from_b, 0}};
                u[j] = (double)(philox4x64(counter, key).v[0] >> 11) * 0x1p-53;
            }
        }
        d.y[i] = f->value(u);
    }
    doe_end(&d.doe);
    return d;
}

static void release(struct data *d)
{
    free(d->u);
    free(d->y);
}

static void analyse(struct sensitivity *s, const struct data *d,
                    const struct sensitivity_bootstrap *bootstrap)
{
    const struct doe *p = &d->doe;
    const bool good =
        p->method == DOE_SALTELLI
            ? sensitivity_sobol(s, d->y, p->count, d->factors, p->second_order, bootstrap->level)
        : p->method == DOE_MORRIS
            ? sensitivity_morris(s, d->y, d->u, p->count, d->factors, bootstrap->level)
            : sensitivity_given(s, d->y, d->u, d->points, d->factors, p->method == DOE_SOBOL,
                                bootstrap);
    assert_true(good);
}

#define DATA FREED(release) struct data
#define SENSITIVITY FREED(sensitivity_free) struct sensitivity

static const struct sensitivity_bootstrap usual = {500, 0.95, 1}, wide = {500, 0.999, 1};

/* ---- coverage ----------------------------------------------------------------------------- */

static bool holds(const struct sensitivity_value *v, double truth)
{
    const double rounding = 1e-12;
    return v->low <= truth + rounding && truth - rounding <= v->high;
}

/* The estimators of Saltelli et al. (2010), table 2 (b) and (f), less the mean: what ours are to be
 * at least as good as. */
static void find_rivals(const struct data *d, double *index)
{
    const size_t k = d->factors, n = (size_t)d->doe.count;
    double mean = 0, variance = 0;
    memset(index, 0, 2 * k * sizeof *index);
    for (size_t i = 0; i < n; i++)
        mean += (d->y[i * (k + 2)] + d->y[i * (k + 2) + k + 1]) / (2 * (double)n);
    for (size_t i = 0; i < n; i++) {
        const double *y = d->y + i * (k + 2), a = y[0] - mean, b = y[k + 1] - mean;
        variance += (a * a + b * b) / (2 * (double)n);
        for (size_t j = 0; j < k; j++) {
            const double ab = y[1 + j] - mean;
            index[j] += b * (ab - a) / (double)n;
            index[k + j] += (a - ab) * (a - ab) / (2 * (double)n);
        }
    }
    for (size_t q = 0; q < 2 * k; q++)
        index[q] /= variance;
}

/* How often intervals hold the truth, on the mean over the indices and for the worst; root mean
 * square error of the estimates; mean width of the intervals. */
struct tally {
    double held[2 * MOST], error, rival, width, mean, least;
    size_t quantities;
};

static struct tally cover(enum doe_method method, const struct function *f, uint64_t count,
                          int seeds, bool independent)
{
    struct tally t = {.quantities = method == DOE_SALTELLI ? 2 * f->factors : f->factors};
    double truth[2 * MOST];
    const struct sensitivity_bootstrap bootstrap = {300, 0.95, 1};
    memcpy(truth, f->first, f->factors * sizeof *truth);
    memcpy(truth + f->factors, f->total, f->factors * sizeof *truth);
    for (int seed = 0; seed < seeds; seed++) {
        SENSITIVITY s;
        DATA d = make(method, f, count, (uint64_t)seed, false, independent);
        double rivals[2 * MOST] = {0};
        analyse(&s, &d, &bootstrap);
        if (method == DOE_SALTELLI)
            find_rivals(&d, rivals);
        for (size_t q = 0; q < t.quantities; q++) {
            const double share = 1 / (double)t.quantities / seeds;
            t.held[q] += holds(&s.all[q], truth[q]);
            t.error += share * pow(s.all[q].estimate - truth[q], 2);
            t.rival += share * pow(rivals[q] - truth[q], 2);
            t.width += share * (s.all[q].high - s.all[q].low);
        }
    }
    t.least = 1;
    t.error = sqrt(t.error);
    t.rival = method == DOE_SALTELLI ? sqrt(t.rival) : NAN;
    for (size_t q = 0; q < t.quantities; q++) {
        t.mean += t.held[q] / seeds / (double)t.quantities;
        t.least = fmin(t.least, t.held[q] / seeds);
    }
    printf("# %s, %s %llu%s: intervals hold the truth in %.1f %% (worst index %.1f %%), error %.4f "
           "(rivals' %.4f), "
           "width %.4f\n",
           f->name, doe_words[method], (unsigned long long)count, independent ? " independent" : "",
           100 * t.mean, 100 * t.least, t.error, t.rival, t.width);
    return t;
}

/* Intervals of independent and of a design's own blocks hold the truth as often as they say, index
 * by index, whatever the response is; indices of factors that do nothing are exact. */
TEST(test_coverage)
{
    const bool patient = long_tests();
    const int seeds = patient ? 2000 : 1000;
    const double slack = 3.5 * sqrt(0.95 * 0.05 / seeds);
    for (size_t f = 0; f < (patient ? FUNCTIONS : 1); f++) {
        const struct function *own = &functions[f];
        for (int independent = 0; independent < 2; independent++) {
            const struct tally t = cover(DOE_SALTELLI, own, 256, seeds, independent);
            assert_true(t.least > 0.93 - slack);
            assert_true(t.mean > 0.935);
            for (size_t q = 0; q < t.quantities; q++)
                assert_true(t.held[q] / seeds < 0.97 + slack || t.width < 0.05 ||
                            t.held[q] == seeds);
            assert_true(t.error < t.rival);
        }
        for (uint64_t n = 32; patient && n <= 1024; n *= 2) {
            cover(DOE_SALTELLI, own, n, seeds, true);
            cover(DOE_SALTELLI, own, n, seeds, false);
        }
    }
}

/* What two factors share, Ishigami's 1 and 3 and pairs of the g-function's; f: 0 or 1. */
static double pair(size_t f, size_t i, size_t j)
{
    const struct function *const own = &functions[f];
    return f == 1             ? own->first[i] * own->first[j] * (g_variance() - 1)
           : i == 0 && j == 2 ? own->total[2]
                              : 0;
}

/* The sum of the first-order indices, and indices of second order. */
TEST(test_coverage_of_sums_and_pairs)
{
    enum { SEEDS = 1000, BLOCKS = 256 };
    const double slack = 3.5 * sqrt(0.95 * 0.05 / SEEDS);
    for (size_t f = 0; f < (long_tests() ? FUNCTIONS : 1); f++) {
        const struct function *own = &functions[f];
        const size_t k = own->factors;
        double sum = 0, held = 0, pairs[MOST * MOST] = {0}, least = 1;
        for (size_t j = 0; j < k; j++)
            sum += own->first[j];
        for (int seed = 0; seed < SEEDS; seed++) {
            SENSITIVITY s;
            DATA d = make(DOE_SALTELLI, own, BLOCKS, (uint64_t)seed, f < 2, false);
            analyse(&s, &d, &usual);
            held += holds(&s.first_sum, sum) / (double)SEEDS;
            for (size_t i = 0; f < 2 && i < k; i++)
                for (size_t j = i + 1; j < k; j++)
                    pairs[i * k + j] += holds(&s.second[i * k + j], pair(f, i, j)) / (double)SEEDS;
        }
        for (size_t i = 0; f < 2 && i < k; i++)
            for (size_t j = i + 1; j < k; j++)
                least = fmin(least, pairs[i * k + j]);
        printf("# %s: sum %.1f %%, worst pair %.1f %%\n", own->name, 100 * held, 100 * least);
        assert_true(held > 0.93 - slack && least > 0.93 - slack);
    }
}

/* First-order indices from bins, of independent points and Latin hypercubes from 93 % on; those of
 * a Sobol' sequence are conservative. */
TEST(test_coverage_of_bins)
{
    const bool patient = long_tests();
    const int seeds = patient ? 1000 : 200;
    const double slack = 3.5 * sqrt(0.95 * 0.05 / seeds);
    for (size_t f = 0; f < (patient ? FUNCTIONS : 1); f++) {
        for (int m = 0; m < 3; m++) {
            const enum doe_method method = (enum doe_method)m; /* random, lhs, sobol */
            const struct tally t = cover(method, &functions[f], 512, seeds, false);
            assert_true(t.least > 0.93 - slack);
            assert_true(t.mean > 0.93 && t.width < 0.45);
            for (uint64_t n = 128; patient && n <= 2048; n *= 4)
                cover(method, &functions[f], n, seeds, false);
        }
    }
}

/* Means of effects of 20 and of 10 trajectories; what they are of a few thousand is the truth. */
TEST(test_coverage_of_effects)
{
    enum { TRUTHS = 20000 };
    const int seeds = long_tests() ? 4000 : 200;
    const double slack = 3.5 * sqrt(0.95 * 0.05 / seeds);
    const struct function *own = &functions[0];
    SENSITIVITY truth;
    DATA all = make(DOE_MORRIS, own, TRUTHS, 99, false, false);
    analyse(&truth, &all, &usual);
    for (uint64_t n = 10; n <= (long_tests() ? 40 : 10); n *= 2) {
        double held[3] = {0};
        for (int seed = 0; seed < seeds; seed++) {
            SENSITIVITY s;
            DATA d = make(DOE_MORRIS, own, n, (uint64_t)seed, false, false);
            analyse(&s, &d, &usual);
            for (int m = 0; m < 3; m++)
                for (size_t j = 0; j < own->factors; j++)
                    held[m] += holds(&s.measure[SENSITIVITY_MU + m][j],
                                     truth.measure[SENSITIVITY_MU + m][j].estimate) /
                               (double)own->factors / seeds;
        }
        printf("# %d trajectories: mu %.1f %%, mu_star %.1f %%, sigma %.1f %%\n", (int)n,
               100 * held[0], 100 * held[1], 100 * held[2]);
        assert_true(held[0] > 0.93 - slack && held[1] > 0.93 - slack);
    }
}

/* ---- single designs ----------------------------------------------------------------------- */

TEST(test_indices)
{
    for (size_t f = 0; f < SMOOTH; f++) {
        SENSITIVITY s;
        DATA d = make(DOE_SALTELLI, &functions[f], 4096, 3, false, false);
        analyse(&s, &d, &wide);
        assert_int_equal(s.blocks, 4096);
        for (size_t j = 0; j < d.factors; j++) {
            assert_true(holds(&s.measure[SENSITIVITY_FIRST][j], functions[f].first[j]));
            assert_true(holds(&s.measure[SENSITIVITY_TOTAL][j], functions[f].total[j]));
            assert_float_equal(s.measure[SENSITIVITY_FIRST][j].estimate, functions[f].first[j],
                               0.02);
            assert_float_equal(s.measure[SENSITIVITY_TOTAL][j].estimate, functions[f].total[j],
                               0.02);
        }
        assert_null(s.second);
        assert_null(s.measure[SENSITIVITY_MU]);
    }
}

/* What factors share two at a time: of Ishigami's function 1 and 3 alone, of the g-function
 * V1 V2 / V and so on. */
TEST(test_pairs)
{
    for (size_t f = 0; f < SMOOTH; f++) {
        SENSITIVITY s;
        DATA d = make(DOE_SALTELLI, &functions[f], 2048, 5, true, false);
        const size_t k = d.factors;
        analyse(&s, &d, &wide);
        for (size_t i = 0; i < k; i++) {
            for (size_t j = i + 1; j < k; j++) {
                const double truth = pair(f, i, j);
                assert_float_equal(s.second[i * k + j].estimate, truth, 0.02);
                assert_true(holds(&s.second[i * k + j], truth));
            }
        }
    }
}

/* Indices do not depend on the response's zero and unit; nor does anything on the order of calls.
 */
TEST(test_units)
{
    struct sensitivity s, other;
    DATA d = make(DOE_SALTELLI, &functions[0], 128, 2, true, false);
    analyse(&s, &d, &usual);
    for (size_t i = 0; i < d.points; i++)
        d.y[i] = 1e6 - 1e-3 * d.y[i];
    analyse(&other, &d, &usual);
    for (size_t q = 0; q < 2 * d.factors + 1; q++) {
        assert_float_equal(other.all[q].estimate, s.all[q].estimate, 1e-6);
        assert_float_equal(other.all[q].low, s.all[q].low, 1e-6);
        assert_float_equal(other.all[q].high, s.all[q].high, 1e-6);
    }
    sensitivity_free(&s);
    analyse(&s, &d, &usual);
    assert_memory_equal(s.all, other.all, (2 * d.factors + 1) * sizeof *s.all);
    sensitivity_free(&s);
    sensitivity_free(&other);
}

static double linear(const double *u)
{
    return 3 + 2 * u[0] - 5 * u[1] + 0 * u[2] + u[3] / 2;
}
static const struct function straight = {"linear", 4, linear, {0}, {0}};

TEST(test_morris)
{
    static const double slopes[4] = {2, -5, 0, 0.5};
    SENSITIVITY s;
    DATA d = make(DOE_MORRIS, &straight, 10, 1, false, false);
    analyse(&s, &d, &usual);
    for (size_t j = 0; j < 4; j++) {
        assert_float_equal(sensitivity_weight(&s, j), fabs(slopes[j]), 1e-12);
        assert_float_equal(s.measure[SENSITIVITY_MU][j].estimate, slopes[j], 1e-12);
        assert_float_equal(s.measure[SENSITIVITY_MU_STAR][j].estimate, fabs(slopes[j]), 1e-12);
        assert_float_equal(s.measure[SENSITIVITY_SIGMA][j].estimate, 0, 1e-12);
        assert_float_equal(s.measure[SENSITIVITY_MU][j].low, slopes[j], 1e-12);
        assert_float_equal(s.measure[SENSITIVITY_MU][j].high, slopes[j], 1e-12);
    }
    sensitivity_free(&s);
    /* Without one response the effects of the two steps to and from it are gone, no more. */
    d.y[2] = NAN;
    analyse(&s, &d, &usual);
    assert_int_equal(s.blocks, 10);
    assert_float_equal(s.measure[SENSITIVITY_MU][1].estimate, -5, 1e-12);
    sensitivity_free(&s);
    for (size_t i = 5; i < d.points; i++)
        d.y[i] = NAN;
    analyse(&s, &d, &usual);
    assert_int_equal(s.blocks, 1);
}

/* A missing response is as if its block had never been: here one in each of the sequences, so that
 * the others keep theirs. */
TEST(test_missing)
{
    enum { BLOCK = 5, GONE = DOE_REPLICATES };
    struct sensitivity s, other;
    DATA d = make(DOE_SALTELLI, &functions[0], 5 * GONE, 4, false, false);
    for (size_t i = 0; i < GONE; i++)
        d.y[(GONE + i) * BLOCK + i % BLOCK] = NAN;
    analyse(&s, &d, &usual);
    memmove(d.y + GONE * BLOCK, d.y + 2 * GONE * BLOCK, 3 * GONE * BLOCK * sizeof *d.y);
    d.doe.count = 4 * GONE;
    analyse(&other, &d, &usual);
    assert_int_equal(s.blocks, 4 * GONE);
    assert_memory_equal(s.all, other.all, 7 * sizeof *s.all);
    sensitivity_free(&s);
    sensitivity_free(&other);
}

/* Factors of few values: their bins are the values, in whatever numbers of points. */
TEST(test_listed)
{
    enum { N = 400 };
    double y[N], u[2 * N], first = 0;
    SENSITIVITY s;
    for (size_t i = 0; i < N; i++) {
        u[2 * i] = i % 3 == 2;
        u[2 * i + 1] = (double)(i * 7 % N);
        y[i] = i % 3 == 2 ? 1 : i % 2 ? 0.25 : -0.25;
    }
    for (size_t i = 0; i < N; i++) /* two groups: exact */
        first += i % 3 == 2;
    const double share = first / N, between = share * (1 - share), within = (1 - share) / 16;
    assert_true(sensitivity_given(&s, y, u, N, 2, false, &usual));
    const double truth = between / (between + within);
    assert_float_equal(s.measure[SENSITIVITY_FIRST][0].estimate, truth, 2.0 / N);
    assert_true(holds(&s.measure[SENSITIVITY_FIRST][0], truth));
}

/* Nothing to say: no number rather than a wrong one, and no crash. */
TEST(test_nothing)
{
    double y[24], u[24 * 2] = {0};
    SENSITIVITY s;
    for (size_t i = 0; i < 24; i++)
        y[i] = 0.5;
    assert_true(sensitivity_sobol(&s, y, 6, 2, false, 0.95));
    assert_true(isnan(s.all[0].estimate) && isnan(s.first_sum.estimate) && s.deviation == 0);
    sensitivity_free(&s);
    assert_true(sensitivity_given(&s, y, u, 24, 2, false, &usual));
    assert_true(isnan(s.all[0].estimate));
    sensitivity_free(&s);
    assert_true(sensitivity_morris(&s, y, u, 8, 2, 0.95)); /* points that never move */
    assert_true(s.blocks == 0 && isnan(s.all[0].estimate));
    sensitivity_free(&s);
    for (size_t i = 0; i < 24; i++)
        y[i] = NAN;
    assert_true(sensitivity_sobol(&s, y, 6, 2, false, 0.95));
    assert_true(s.blocks == 0 && isnan(s.mean) && isnan(s.all[3].low));
    sensitivity_free(&s);
    assert_true(sensitivity_given(&s, y, u, 24, 2, true, &usual));
    assert_true(s.blocks == 0 && isnan(s.all[0].estimate));
}
