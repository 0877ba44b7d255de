/* test_threshold.c - where a basin crosses a share of its first volume: how often the interval
 * holds the truth, over 1,000 samples of each kind, and what is said where nothing is crossed; the
 * first start that is lost. */
#include "long.h"
#include "support.h"

#include "cases.h"

#include "analysis/basin/basin.h"

enum { VALUES = 11, POINTS = 200, GRID = 41, SEEDS = 1000 };

static double value[VALUES], place[POINTS], grid[GRID];
static uint8_t kind[VALUES * GRID * POINTS];

/* The parameter's axis comes first; the starts are a sample, a grid, or a grid beside a sample. */
static struct results make_results(bool gridded, bool sampled)
{
    struct results r = {.axes = 1,
                        .axis = {{.name = "ground.friction", .count = VALUES, .value = value}},
                        .sample = -1,
                        .block = 1,
                        .cases = VALUES,
                        .kind = kind};
    for (int i = 0; i < VALUES; i++)
        value[i] = 0.1 * i;
    for (int i = 0; i < GRID; i++)
        grid[i] = (double)i / (GRID - 1);
    if (gridded) {
        r.axis[r.axes++] = (struct results_axis){
            .name = "initial.offset.x", .count = GRID, .value = grid, .offset = true};
        r.cases *= GRID;
    }
    if (sampled) {
        r.sample = r.axes;
        r.axis[r.axes++] = (struct results_axis){.name = "sample", .count = POINTS, .value = place};
        r.cases *= POINTS;
    }
    return r;
}

static struct basin_threshold measure(const struct results *r, bool starts, double threshold)
{
    static struct results_axis x = {
        .name = "initial.offset.x", .count = POINTS, .value = place, .offset = true};
    const struct basin_choice choice = {.of = RESULTS_STABILISED, .side = 5, .level = 0.95};
    struct basin_sample sample = {.axis = starts ? r->sample : -1,
                                  .points = POINTS,
                                  .block = 1,
                                  .factors = starts,
                                  .factor = calloc(1, sizeof *sample.factor),
                                  .box = 1};
    struct basin basin;
    stance_message message = {""};
    bool usage;
    assert_non_null(sample.factor);
    sample.factor[0] = (struct basin_factor){&x, 0, 1};
    if (!basin_make(&basin, r, &choice, &sample, &usage, &message))
        fail_msg("%s", message.text);
    assert_int_equal(basin.rows, VALUES);
    const struct basin_threshold found = basin_threshold(&basin, 0, 0, threshold);
    basin_free(&basin);
    return found;
}

static uint8_t in(bool inside)
{
    return inside ? RESULTS_STABILISED : RESULTS_FELL;
}

/* Sampled starts, of which those below 0.9 - 0.5 x are inside, and of a tenth, which has nothing to
 * do with that, none. The share is linear and crosses 0.8 of its first value at 0.36. */
TEST(sampled_starts)
{
    struct results r = make_results(false, true);
    int held = 0, crossed = 0;
    double width = 0;
    for (int seed = 0; seed < SEEDS; seed++) {
        uint64_t random = (uint64_t)seed * 104729 + 1;
        for (int p = 0; p < POINTS; p++) {
            const double u = uniform(&random, 0, 1), out = uniform(&random, 0, 1);
            place[p] = u;
            for (int i = 0; i < VALUES; i++)
                kind[i * POINTS + p] = in(u < 0.9 - 0.5 * 0.1 * i && out > 0.1);
        }
        const struct basin_threshold found = measure(&r, true, 0.8);
        crossed += found.crossed && found.before < found.after;
        held += found.low <= 0.36 && !(found.high < 0.36);
        width += (found.high - found.low) / SEEDS;
        assert_true(found.low <= found.at && !(found.at > found.high));
    }
    print_message("# sampled starts: %.1f %% held, %d crossed, width %.3f\n", 100.0 * held / SEEDS,
                  crossed, width);
    assert_true(held >= 930 && held <= 970 + 10 && crossed == SEEDS);
}

/* Starts on a grid for each of some sampled parameters, which move the edge. */
TEST(sampled_parameters)
{
    struct results r = make_results(true, true);
    const int seeds = long_tests() ? SEEDS : SEEDS / 5;
    int held = 0;
    for (int seed = 0; seed < seeds; seed++) {
        uint64_t random = (uint64_t)seed * 104729 + 1;
        for (int p = 0; p < POINTS; p++) {
            const double u = uniform(&random, 0, 1);
            for (int i = 0; i < VALUES; i++)
                for (int g = 0; g < GRID; g++)
                    kind[(i * GRID + g) * POINTS + p] =
                        in(grid[g] < 0.3 + 0.5 * u - 0.2 * 0.1 * i * (0.5 + u));
        }
        const struct basin_threshold found = measure(&r, false, 0.8);
        held += found.low <= 0.55 && !(found.high < 0.55); /* 0.55 (1 - 0.2) = 0.55 - 0.2 x */
    }
    print_message("# sampled parameters: %.1f %% held\n", 100.0 * held / seeds);
    assert_true(held >= 0.93 * seeds); /* the grid's own error is conservative */
}

/* Starts on a grid alone: conservative, as the likely errors are. */
TEST(starts_on_a_grid)
{
    struct results r = make_results(true, false);
    int held = 0;
    double width = 0;
    for (int seed = 0; seed < SEEDS; seed++) {
        uint64_t random = (uint64_t)seed * 104729 + 1;
        const double first = uniform(&random, 0.6, 0.9), slope = uniform(&random, 0.3, 0.5);
        for (int i = 0; i < VALUES; i++)
            for (int g = 0; g < GRID; g++)
                kind[i * GRID + g] = in(grid[g] < first - slope * 0.1 * i);
        const struct basin_threshold found = measure(&r, false, 0.8);
        const double truth = 0.2 * first / slope;
        held += found.low <= truth && !(found.high < truth);
        width += (found.high - found.low) / SEEDS;
    }
    print_message("# a grid: %.1f %% held, width %.3f\n", 100.0 * held / SEEDS, width);
    assert_true(held >= 950 && width < 0.3);
}

TEST(what_is_not_crossed)
{
    struct results r = make_results(true, false);
    for (int i = 0; i < VALUES; i++)
        for (int g = 0; g < GRID; g++)
            kind[i * GRID + g] = in(grid[g] < 0.5 + 0.03 * i);
    struct basin_threshold found = measure(&r, false, 0.8);
    assert_false(found.crossed);
    assert_true(isnan(found.at) && isnan(found.low) && isnan(found.high));
    found = measure(&r, false, 1.3); /* upwards: 0.5 + 0.03 i = 0.65 at i = 5 */
    assert_true(found.crossed && fabs(found.at - 0.5) < 0.06 && found.low < 0.5 &&
                found.high > 0.5);
    for (uint64_t i = 0; i < r.cases; i++)
        kind[i] = RESULTS_FELL;
    assert_false(measure(&r, false, 0.8).crossed);
    for (uint64_t i = 0; i < r.cases; i++)
        kind[i] = i < GRID ? RESULTS_STABILISED : RESULTS_PENDING;
    found = measure(&r, false, 0.8);
    assert_false(found.crossed);
    for (uint64_t i = 0; i < r.cases; i++)
        kind[i] = RESULTS_PENDING;
    assert_false(measure(&r, false, 0.8).crossed);
}

TEST(starts_are_lost_in_order)
{
    struct results r = make_results(true, false);
    struct basin_loss loss;
    for (int i = 0; i < VALUES; i++)
        for (int g = 0; g < GRID; g++)
            kind[i * GRID + g] = in(g < 20 - (i > 3 ? 2 * (i - 3) : 0) || (g == 30 && i < 9));
    kind[7 * GRID + 2] = RESULTS_FAILED;
    kind[5 * GRID + 0] = RESULTS_FELL; /* lost once and for all, though it has it again later */
    assert_false(basin_more_at_last(&r, 0, RESULTS_STABILISED));
    assert_true(basin_lose(&r, 0, false, RESULTS_STABILISED, &loss));
    assert_int_equal(loss.starts, 21);
    assert_int_equal(loss.unknown, 1);
    assert_int_equal(loss.at, 4);
    assert_int_equal(loss.first, 4 * GRID + 18);
    static const uint64_t lost[VALUES] = {0, 0, 0, 0, 2, 3, 2, 2, 2, 3, 2};
    assert_memory_equal(loss.lost, lost, sizeof lost);
    free(loss.lost);
    /* From the other end none but those at the failed and the fallen case. */
    assert_true(basin_lose(&r, 0, true, RESULTS_STABILISED, &loss));
    assert_int_equal(loss.starts, 6);
    assert_int_equal(loss.at, VALUES - 1 - 5);
    assert_int_equal(loss.lost[loss.at], 1);
    assert_int_equal(loss.unknown, 1);
    free(loss.lost);
}
