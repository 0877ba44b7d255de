/* test_intervals.c - how often the intervals of shares over a sample hold the truth. */
#include "support.h"

#include "cases.h"

#include "analysis/basin/basin.h"
#include "analysis/statistics/intervals.h"
#include "runner/scenario/doe.h"

static const double pi = 3.14159265358979323846;

/* ---- shares of the cases at a point ------------------------------------------------------- */

enum { FACTORS = 3, CASES = 64 };

/* How much of the cases at a point are inside, and its mean over the cube. */
struct response {
    const char *name;
    double (*share)(const double *u);
    double mean;
};

static double corner(const double *u)
{
    return u[0] < 0.3 && u[1] < 0.3;
}
static double slanted(const double *u)
{
    return u[0] + u[1] < 1;
}
static double product(const double *u)
{
    return u[0] * u[1];
}
static double narrow(const double *u)
{
    return 0.175 + 0.008 * u[0];
}
static double waves(const double *u)
{
    return 0.5 + 0.5 * cos(18 * pi * u[0]) * cos(10 * pi * u[1]);
}
/* Nothing inside at eight points in ten. */
static double mostly_none(const double *u)
{
    return u[0] < 0.2 ? 0.5 + 0.5 * u[1] : 0;
}

static const struct response responses[] = {
    {"corner", corner, 0.09},  {"slanted", slanted, 0.5}, {"product", product, 0.25},
    {"narrow", narrow, 0.179}, {"waves", waves, 0.5},     {"mostly none", mostly_none, 0.15},
};
enum { RESPONSES = sizeof responses / sizeof responses[0] };

/* The interval from a design's blocks, at whose points so many of `cases` are inside as the
 * response says, rounded up or down at random where it is no whole number. */
static struct interval measure(enum doe_method method, const struct response *response,
                               uint64_t count, double cases, uint64_t seed)
{
    struct doe s = {
        .method = method, .count = count, .factors = FACTORS, .levels = 4, .seed = seed};
    struct interval_draws draws = {0};
    uint64_t random = seed + 1;
    assert_true(doe_begin(&s));
    const size_t block = (size_t)doe_block(&s);
    for (uint64_t b = 0; b < count; b++) {
        double inside = 0, u[FACTORS];
        for (size_t i = 0; i < block; i++) {
            doe_unit(&s, b * block + i, u);
            inside += floor(cases * response->share(u) + uniform(&random, 0, 1));
        }
        interval_add(&draws, inside, cases * (double)block);
    }
    doe_end(&s);
    return interval_of(&draws, 0.95);
}

/* Independent points and blocks: 93 to 97 %. Latin hypercubes and Sobol' sequences: conservative.
 */
static void intervals_hold_as_often_as_they_say(void **state)
{
    const bool patient = getenv("STANCE_TEST_LONG") != NULL;
    static const enum doe_method methods[] = {DOE_RANDOM, DOE_LHS, DOE_SOBOL, DOE_SALTELLI};
    (void)state;
    for (size_t m = 0; m < sizeof methods / sizeof methods[0]; m++) {
        const int seeds = patient ? 4000 : methods[m] == DOE_RANDOM ? 1000 : 250;
        const double slack = 3.5 * sqrt(0.95 * 0.05 / seeds);
        for (size_t k = 0; k < RESPONSES; k++) {
            for (uint64_t count = 32; count <= 128; count *= 4) {
                for (int single = 0; single < 2; single++) {
                    int held = 0;
                    double width = 0;
                    for (int seed = 0; seed < seeds; seed++) {
                        const struct interval found = measure(methods[m], &responses[k], count,
                                                              single ? 1 : CASES, (uint64_t)seed);
                        held += found.low <= responses[k].mean && responses[k].mean <= found.high;
                        width += (found.high - found.low) / seeds;
                    }
                    const double share = (double)held / seeds;
                    print_message("# %s, %d blocks of %s, %d case%s a point: %.1f %%, width %.4f\n",
                                  responses[k].name, (int)count, doe_words[methods[m]],
                                  single ? 1 : CASES, single ? "" : "s", 100 * share, width);
                    assert_true(share > 0.93 - slack);
                    if (methods[m] == DOE_RANDOM)
                        assert_true(share < 0.97 + slack);
                }
            }
        }
    }
}

/* Shares of what differs in size from point to point: what is lost of a domain, of those starts
 * that were in it. E(m) = 32, E(k) = 64 E((0.1 + 0.8 u) (0.2 + 0.6 u v)). */
static void shares_of_parts_hold(void **state)
{
    const double wanted = (0.1 * 0.2 + 0.1 * 0.6 / 4 + 0.8 * 0.2 / 2 + 0.8 * 0.6 / 6) / 0.5;
    (void)state;
    for (int count = 32; count <= 128; count *= 4) {
        int held = 0;
        for (int seed = 0; seed < 1000; seed++) {
            struct interval_draws draws = {0};
            uint64_t random = (uint64_t)seed * 7919 + 3;
            for (int i = 0; i < count; i++) {
                const double u = uniform(&random, 0, 1), v = uniform(&random, 0, 1);
                const double m = CASES * (0.1 + 0.8 * u);
                interval_add(&draws, m * (0.2 + 0.6 * u * v), m);
            }
            const struct interval found = interval_of(&draws, 0.95);
            held += found.low <= wanted && wanted <= found.high;
        }
        print_message("# shares of parts, %d points: %.1f %%\n", count, held / 10.0);
        assert_true(held >= 930 && held <= 970);
    }
}

/* ---- cases of a file ---------------------------------------------------------------------- */

/* Four parts of a sample whose shares differ by less than a case in 32 have intervals of their own,
 * and narrow ones: what scatters are the points, not their cases. */
static void shares_over_a_grid_are_no_coins(void **state)
{
    enum { PARTS = 4, EACH = 32, POINTS = PARTS * EACH, GRID = 200 };
    static uint8_t kind[GRID * POINTS];
    uint32_t part[POINTS];

    struct results r = {.axes = 2,
                        .axis = {{.count = GRID}, {.count = POINTS}},
                        .cases = GRID * POINTS,
                        .kind = kind,
                        .sample = 1,
                        .block = 1};
    struct interval interval[PARTS], rows[GRID];
    (void)state;
    for (int p = 0; p < POINTS; p++) {
        part[p] = (uint32_t)(p / EACH);
        for (int g = 0; g < GRID; g++)
            kind[g * POINTS + p] = g < 34 + p / EACH + p % 3 ? RESULTS_STABILISED : RESULTS_FELL;
    }
    assert_true(intervals_find(&r, RESULTS_STABILISED, -1, part, PARTS, interval));
    for (int b = 0; b < PARTS; b++) {
        double share = 0;
        for (int p = b * EACH; p < (b + 1) * EACH; p++)
            share += (34.0 + b + p % 3) / GRID / EACH;
        assert_true(interval[b].low < share && share < interval[b].high);
        assert_true(interval[b].high - interval[b].low < 0.005);
        assert_true(b == 0 || interval[b].low > interval[b - 1].low);
    }
    /* At one place of the grid points are in or out: Wilson's of 128. */
    assert_true(intervals_find(&r, RESULTS_STABILISED, 0, NULL, GRID, rows));
    uint64_t inside = 0;
    double low, high;
    for (int p = 0; p < POINTS; p++)
        inside += kind[36 * POINTS + p] == RESULTS_STABILISED;
    statistics_wilson_of(statistics_deviations(0.95), (double)inside / POINTS, POINTS, &low, &high);
    assert_true(inside > 0 && inside < POINTS);
    assert_true(fabs(rows[36].low - low) < 1e-12 && fabs(rows[36].high - high) < 1e-12);
    assert_true(rows[0].high == 1 && rows[0].low > 0.95);
    /* A grid alone has none. */
    r.sample = -1;
    assert_true(intervals_find(&r, RESULTS_STABILISED, 0, NULL, GRID, rows));
    assert_true(isnan(rows[36].low) && isnan(rows[36].high));
}

/* ---- volumes over a sample of parameters --------------------------------------------------- */

/* Starts on a grid of x, of which those below an edge that a sampled parameter moves are inside. */
static void volumes_over_sampled_parameters(void **state)
{
    enum { GRID = 41, POINTS = 32, SEEDS = 1000 };
    static uint8_t kind[GRID * POINTS];
    static double x[GRID], point[POINTS];
    struct results r = {
        .axes = 2,
        .axis =
            {{.name = "initial.offset.x", .unit = "m", .count = GRID, .value = x, .offset = true},
             {.name = "sample", .count = POINTS, .value = point}},
        .sample = 1,
        .block = 1,
        .cases = GRID * POINTS,
        .kind = kind};
    const struct basin_choice choice = {.of = RESULTS_STABILISED, .side = 5, .level = 0.95};
    (void)state;
    for (int i = 0; i < GRID; i++)
        x[i] = -1 + 2.0 * i / (GRID - 1);
    for (int narrow = 0; narrow < 2; narrow++) {
        int held = 0;
        for (int seed = 0; seed < SEEDS; seed++) {
            struct basin_sample sample = {.axis = -1, .points = POINTS, .block = 1};
            struct basin basin;
            stance_message message;
            uint64_t random = (uint64_t)seed * 7919 + 1;
            bool usage;
            for (int p = 0; p < POINTS; p++) {
                const double u = uniform(&random, 0, 1),
                             edge = narrow ? 0.2 + 0.03 * u : 0.9 * u * u - 0.1;
                for (int i = 0; i < GRID; i++)
                    kind[i * POINTS + p] = x[i] < edge ? RESULTS_STABILISED : RESULTS_FELL;
            }
            assert_true(basin_make(&basin, &r, &choice, &sample, &usage, &message));
            assert_int_equal(basin.rows, 1);
            const double wanted = narrow ? 1.215 : 1.2;
            held += fabs(basin.row[0].volume - wanted) <= basin.row[0].reach;
            basin_free(&basin);
        }
        print_message("# volumes over %d sampled points, %s: %.1f %%\n", POINTS,
                      narrow ? "within a cell" : "wide", 100.0 * held / SEEDS);
        /* Within a cell the place of the edge in it is the whole error, and the bound is certain.
         */
        assert_true(held >= 930 && (narrow || held <= 970 + 10));
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(intervals_hold_as_often_as_they_say),
        cmocka_unit_test(shares_of_parts_hold),
        cmocka_unit_test(shares_over_a_grid_are_no_coins),
        cmocka_unit_test(volumes_over_sampled_parameters),
    };
    return cmocka_run_group_tests_name("intervals", tests, NULL, NULL);
}
