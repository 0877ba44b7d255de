/* test_intervals.c - how often the intervals of shares over a sample hold the truth. */
#include "long.h"
#include "support.h"

#include "cases.h"

#include "analysis/basin/basin.h"
#include "analysis/compare/compare_labels.h"
#include "analysis/statistics/doe_bins.h"
#include "analysis/statistics/intervals.h"
#include "runner/scenario/doe.h"

#define DOE FREED(doe_end) struct doe

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
enum { RESPONSES = COUNT(responses) };

/* The interval from a design's blocks, at whose points so many of `cases` are inside as the
 * response says, rounded up or down at random where it is no whole number. */
static struct interval measure(enum doe_method method, const struct response *response,
                               uint64_t count, double cases, uint64_t seed)
{
    DOE s = {.method = method, .count = count, .factors = FACTORS, .levels = 4, .seed = seed};
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
    return interval_of(&draws, 0.95);
}

/* Independent points and blocks: 93 to 97 %. Latin hypercubes and Sobol' sequences: conservative.
 */
TEST(intervals_hold_as_often_as_they_say)
{
    const bool patient = long_tests();
    static const enum doe_method methods[] = {DOE_RANDOM, DOE_LHS, DOE_SOBOL, DOE_SALTELLI};
    for (size_t m = 0; m < COUNT(methods); m++) {
        const int seeds = patient ? 4000 : 100;
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
TEST(shares_of_parts_hold)
{
    const double wanted = (0.1 * 0.2 + 0.1 * 0.6 / 4 + 0.8 * 0.2 / 2 + 0.8 * 0.6 / 6) / 0.5;
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
TEST(shares_over_a_grid_are_no_coins)
{
    enum { PARTS = 4, EACH = 32, POINTS = PARTS * EACH, PLACES = 200 };
    static uint8_t kind[PLACES * POINTS];
    uint32_t part[POINTS];

    struct results r = {.axes = 2,
                        .axis = {{.count = PLACES}, {.count = POINTS}},
                        .cases = PLACES * POINTS,
                        .kind = kind,
                        .sample = 1,
                        .block = 1};
    struct interval interval[PARTS], rows[PLACES];
    for (int p = 0; p < POINTS; p++) {
        part[p] = (uint32_t)(p / EACH);
        for (int g = 0; g < PLACES; g++)
            kind[g * POINTS + p] = g < 34 + p / EACH + p % 3 ? RESULTS_STABILISED : RESULTS_FELL;
    }
    assert_true(intervals_find(&r, RESULTS_STABILISED, -1, part, PARTS, interval));
    for (int b = 0; b < PARTS; b++) {
        double share = 0;
        for (int p = b * EACH; p < (b + 1) * EACH; p++)
            share += (34.0 + b + p % 3) / PLACES / EACH;
        assert_true(interval[b].low < share && share < interval[b].high);
        assert_true(interval[b].high - interval[b].low < 0.005);
        assert_true(b == 0 || interval[b].low > interval[b - 1].low);
    }
    /* At one place of the grid points are in or out: Wilson's of 128. */
    assert_true(intervals_find(&r, RESULTS_STABILISED, 0, NULL, PLACES, rows));
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
    assert_true(intervals_find(&r, RESULTS_STABILISED, 0, NULL, PLACES, rows));
    assert_true(isnan(rows[36].low) && isnan(rows[36].high));
}

/* ---- basins over samples ------------------------------------------------------------------- */

static int seeds; /* of each kind */

static int choose_seeds(void **state __attribute__((unused)))
{
    seeds = long_tests() ? 1000 : 200;
    return 0;
}
static CMFixtureFunction before_tests = choose_seeds;

enum { GRID = 41, MOST_POINTS = 32 * (FACTORS + 2) };
static uint8_t kind_of[GRID * MOST_POINTS];
static double grid_place[GRID], point_place[MOST_POINTS];

static uint8_t in(bool inside)
{
    return inside ? RESULTS_STABILISED : RESULTS_FELL;
}

/* One row of a file with `axes` axes, the last one its sample. */
static struct basin_row measure_basin(const struct results *r, const struct basin_sample *sample,
                                      double level)
{
    const struct basin_choice choice = {.of = RESULTS_STABILISED, .side = 5, .level = level};
    struct basin_sample own = *sample;
    struct basin basin;
    stance_message message;
    bool usage;
    assert_true(basin_make(&basin, r, &choice, &own, &usage, &message));
    assert_int_equal(basin.rows, 1);
    const struct basin_row row = basin.row[0];
    basin_free(&basin);
    return row;
}

/* Starts on a grid of x from -1 to 1, of which those below an edge are inside. */
static double within_a_cell(const double *u)
{
    return 0.2 + 0.03 * u[0];
}
static double wide_edge(const double *u)
{
    return 0.9 * u[0] * u[0] - 0.1;
}
static double rarely(const double *u)
{
    return u[0] < 0.2 ? 0.9 * u[1] : -1.1;
}
static double all_or_nothing(const double *u)
{
    return u[0] < 0.1 ? 1.1 : -1.1;
}

/* Within a cell the place of the edge in it is the whole error, and the bound is certain; points of
 * designs are more even than independent ones; what few points have is told by a wide end. */
TEST(volumes_over_sampled_parameters)
{
    static const struct {
        const char *name;
        double (*edge)(const double *u);
        double volume;
        bool conservative;
    } kinds[] = {{"within a cell", within_a_cell, 1.215, true},
                 {"wide", wide_edge, 1.2, false},
                 {"rarely", rarely, 0.2 * 1.45, false},
                 {"all or nothing", all_or_nothing, 0.2, true}};
    static const enum doe_method methods[] = {DOE_RANDOM, DOE_LHS, DOE_SOBOL, DOE_SALTELLI};
    static const double levels[] = {0.95, 0.8, 0.99};
    for (int i = 0; i < GRID; i++)
        grid_place[i] = -1 + 2.0 * i / (GRID - 1);
    for (size_t k = 0; k < COUNT(kinds); k++) {
        for (size_t m = 0; m < 6; m++) {
            const double level = m < 4 ? 0.95 : levels[m - 3];
            const enum doe_method method = m < 4 ? methods[m] : DOE_RANDOM;
            int held = 0;
            for (int seed = 0; seed < seeds; seed++) {
                DOE s = {.method = method, .count = 32, .factors = FACTORS, .seed = (uint64_t)seed};
                assert_true(doe_begin(&s));
                const size_t points = (size_t)doe_points(&s);
                for (size_t p = 0; p < points; p++) {
                    double u[FACTORS];
                    doe_unit(&s, p, u);
                    for (size_t i = 0; i < GRID; i++)
                        kind_of[i * points + p] = in(grid_place[i] < kinds[k].edge(u));
                }
                const struct results r = {
                    .axes = 2,
                    .axis = {{.name = "initial.offset.x",
                              .unit = "m",
                              .count = GRID,
                              .value = grid_place,
                              .offset = true},
                             {.name = "sample", .count = points, .value = point_place}},
                    .sample = 1,
                    .block = (size_t)doe_block(&s),
                    .cases = GRID * points,
                    .kind = kind_of};
                const struct basin_row row = measure_basin(
                    &r, &(struct basin_sample){.axis = -1, .points = points, .block = r.block},
                    level);
                held += fabs(row.volume - kinds[k].volume) <= row.reach;
            }
            const double share = (double)held / seeds,
                         slack = 3.5 * sqrt(level * (1 - level) / seeds);
            print_message("# volumes over 32 blocks of %s, %s: %.1f %% at %.0f %%\n",
                          doe_words[method], kinds[k].name, 100 * share, 100 * level);
            assert_true(share > level - 0.02 - slack);
            if (method == DOE_RANDOM && !kinds[k].conservative)
                assert_true(share < level + 0.02 + slack);
        }
    }
}

/* Sampled starts of which any share is inside, from nearly none to nearly all: the interval, and
 * the likely error either way. */
TEST(volumes_over_sampled_starts)
{
    enum { POINTS = 64 };
    static const double shares[][2] = {{0.005, 0.05}, {0.05, 0.3}, {0.3, 0.7}, {0.95, 0.995}};
    static const double levels[] = {0.95, 0.8, 0.99};
    for (size_t k = 0; k < 4; k++) {
        for (size_t l = 0; l < 3; l++) {
            int held = 0, either = 0;
            for (int seed = 0; seed < seeds; seed++) {
                uint64_t random = (uint64_t)seed * 7919 + 1;
                const double edge = uniform(&random, shares[k][0], shares[k][1]);
                for (int p = 0; p < POINTS; p++) {
                    point_place[p] = uniform(&random, 0, 1);
                    kind_of[p] = in(point_place[p] < edge);
                }
                const struct results_axis x = {.name = "initial.offset.x",
                                               .count = POINTS,
                                               .value = point_place,
                                               .offset = true};
                const struct results r = {
                    .axes = 1,
                    .axis = {{.name = "sample", .count = POINTS, .value = point_place}},
                    .sample = 0,
                    .block = 1,
                    .cases = POINTS,
                    .kind = kind_of};
                struct basin_sample sample = {.axis = 0,
                                              .points = POINTS,
                                              .block = 1,
                                              .factors = 1,
                                              .factor = malloc(sizeof *sample.factor),
                                              .box = 1};
                assert_non_null(sample.factor);
                sample.factor[0] = (struct basin_factor){&x, 0, 1};
                const struct basin_row row = measure_basin(&r, &sample, levels[l]);
                held += row.low <= edge && edge <= row.high;
                either += fabs(row.volume - edge) <= row.reach;
            }
            const double level = levels[l], slack = 3.5 * sqrt(level * (1 - level) / seeds);
            print_message(
                "# %d sampled starts, %.1f to %.1f %% inside: interval %.1f %%, +- %.1f %% "
                "at %.0f %%\n",
                POINTS, 100 * shares[k][0], 100 * shares[k][1], 100.0 * held / seeds,
                100.0 * either / seeds, 100 * level);
            assert_true(fabs((double)held / seeds - level) < 0.02 + slack);
            assert_true(either >= held);
        }
    }
}

/* ---- shares along a path, and losses ------------------------------------------------------- */

/* Bins of 32 points along a factor, of which other factors decide. */
TEST(bins_of_a_sample)
{
    enum { BINS = 8, POINTS = 32 * BINS };
    static uint8_t kind[POINTS];
    static double value[POINTS];
    struct results_varied vary = {
        .of = {.name = "ground.friction", .count = POINTS, .value = value}};
    const struct results r = {.axes = 1,
                              .axis = {{.name = "sample", .count = POINTS, .value = value}},
                              .sample = 0,
                              .block = 1,
                              .varied = 1,
                              .vary = &vary,
                              .cases = POINTS,
                              .kind = kind};
    double held = 0;
    for (int seed = 0; seed < seeds; seed++) {
        struct doe_bins bins;
        stance_message message;
        uint64_t random = (uint64_t)seed * 7919 + 1;
        for (int p = 0; p < POINTS; p++) {
            value[p] = uniform(&random, 0, 1);
            kind[p] = in(uniform(&random, 0, 1) < 0.1 + 0.8 * value[p]);
        }
        assert_true(doe_bins_make(&bins, &r, 0, BINS, &message));
        assert_int_equal(bins.count, BINS);
        for (size_t b = 0; b < bins.count; b++) {
            const struct interval *found = &bins.bin[b].of_kind[RESULTS_STABILISED];
            const double share = 0.1 + 0.4 * (bins.bin[b].low + bins.bin[b].high);
            held += found->low <= share && share <= found->high;
        }
    }
    print_message("# bins of 32 points: %.1f %%\n", 100 * held / seeds / BINS);
    assert_true(held / seeds / BINS > 0.93 && held / seeds / BINS < 0.97);
}

/* What the domain of one file has lost in another one: little of much, and of single starts. */
TEST(losses_of_a_domain)
{
    enum { POINTS = 128 };
    static uint8_t kind[2][GRID * POINTS];
    static char none[] = "";
    for (int gridded = 0; gridded < 2; gridded++) {
        struct results r[2];
        const size_t places = gridded ? GRID : 1;
        for (int f = 0; f < 2; f++)
            r[f] = (struct results){
                .axes = 2,
                .axis = {{.name = "initial.offset.x", .count = places, .value = grid_place},
                         {.name = "sample", .count = POINTS, .value = point_place}},
                .sample = 1,
                .block = 1,
                .scenario = none,
                .cases = places * POINTS,
                .kind = kind[f]};
        int held = 0;
        for (int seed = 0; seed < 1000; seed++) {
            struct interval lost_share;
            uint64_t random = (uint64_t)seed * 7919 + 1;
            for (size_t p = 0; p < POINTS; p++) {
                const double u = uniform(&random, 0, 1), v = uniform(&random, 0, 1);
                /* Of m of the grid a part with the mean 0.05 is lost. */
                const size_t m = gridded ? 10 + (size_t)(20 * u) : 1;
                const double part = 0.1 * v * (double)m;
                size_t lost = (size_t)part;
                lost += uniform(&random, 0, 1) < part - (double)lost;
                for (size_t i = 0; i < places; i++) {
                    kind[0][i * POINTS + p] = in(i < m);
                    kind[1][i * POINTS + p] = in(i + lost < m);
                }
            }
            assert_true(compare_lost(&lost_share, r, RESULTS_STABILISED));
            held += lost_share.low <= 0.05 && 0.05 <= lost_share.high;
        }
        print_message("# losses of %s: %.1f %%\n", gridded ? "maps" : "single starts", held / 10.0);
        assert_true(held >= 930 && held <= 970 + 10);
    }
}
