/* test_critical.c - intervals of critical values of a sample hold as often as they say: 200 random
 * problems whose truth is a quantile that is known, each drawn many times; brackets, islands, and
 * what cannot be known, against what is plain to see.
 */
#include "runner/base/command.h"
#include "support.h"

#include "analysis/critical/critical.h"

#include <gsl/gsl_cdf.h>

enum { VALUES = 4097, MOST_POINTS = 400 };

static double value[VALUES];
static uint32_t gone[VALUES + 1], maybe[VALUES + 1], out[VALUES + 1];
static uint64_t seed = 1;

/* Evenly on 0 ... 1: splitmix64. */
static double drawn(void)
{
    uint64_t z = seed += 0x9e3779b97f4a7c15;
    z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9;
    z = (z ^ z >> 27) * 0x94d049bb133111eb;
    return ((double)((z ^ z >> 31) >> 11) + 0.5) * 0x1p-53;
}

/* How the numbers of a population are distributed, by their quantile p: within 0 ... 1, most of
 * them; beyond 1 they are never lost. */
static double quantile(int shape, double place, double width, double p)
{
    switch (shape) {
    case 0:
        return place + width * gsl_cdf_ugaussian_Pinv(p) / 4;
    case 1:
        return place + width * (p - 0.5);
    case 2: /* skew */
        return place - width * log1p(-p) / 4;
    case 3: /* skew to the other side */
        return place + width * log(p) / 4;
    case 4: /* two heaps */
        return p < 0.3 ? place - width * (0.3 - p) : place + width * p;
    default: /* heavy tails */
        return place + width * tan(M_PI * (p - 0.5)) / 40;
    }
}

/* The counts of points that lose it at these numbers. */
static struct critical_line line_of(const double *number, uint32_t points)
{
    memset(gone, 0, sizeof gone);
    for (size_t i = 0; i < VALUES; i++)
        value[i] = (double)i / (VALUES - 1);
    for (uint32_t p = 0; p < points; p++) {
        const double first = fmax(0, floor(number[p] * (VALUES - 1)) + 1);
        gone[(size_t)fmin(first, VALUES)]++; /* one place more than values */
    }
    for (size_t i = 1; i < VALUES; i++)
        gone[i] += gone[i - 1];
    memcpy(maybe, gone, sizeof maybe);
    memcpy(out, gone, sizeof out);
    return (struct critical_line){VALUES, value, points, gone, maybe, out};
}

TEST(intervals_hold)
{
    enum { PROBLEMS = 200, DRAWS = 100 };
    static const double shares[] = {0.5, 0.6, 0.75, 0.8, 0.9};
    unsigned held = 0, below = 0, above = 0;
    for (int problem = 0; problem < PROBLEMS; problem++) {
        const uint32_t points = 36 + (uint32_t)(drawn() * (MOST_POINTS - 36));
        const struct critical_choice choice = {shares[(int)(drawn() * 5)], 0.95};
        const int shape = (int)(drawn() * 6);
        const double place = 0.35 + 0.3 * drawn(), width = 0.1 + 0.4 * drawn(),
                     truth = quantile(shape, place, width, 1 - choice.share);
        unsigned own = 0;
        for (int draw = 0; draw < DRAWS; draw++) {
            double number[MOST_POINTS];
            for (uint32_t p = 0; p < points; p++)
                number[p] = quantile(shape, place, width, drawn());
            const struct critical_line line = line_of(number, points);
            const struct critical_value found = critical_find(&line, &choice);
            /* Beyond the line's ends it goes on as far as may be. */
            const double low = isnan(found.low) ? -INFINITY : found.low,
                         high = isnan(found.high) ? INFINITY : found.high;
            below += high < truth;
            above += low > truth;
            own += low <= truth && truth <= high;
        }
        assert_true(own >= 84); /* of 100: binomial, five deviations below */
        held += own;
    }
    print_message("%.2f %% held, %.2f %% were below and %.2f %% above\n",
                  100.0 * held / (PROBLEMS * DRAWS), 100.0 * below / (PROBLEMS * DRAWS),
                  100.0 * above / (PROBLEMS * DRAWS));
    assert_in_range(held, 0.94 * PROBLEMS * DRAWS, 0.965 * PROBLEMS * DRAWS);
    assert_in_range(below, 0.01 * PROBLEMS * DRAWS, 0.035 * PROBLEMS * DRAWS);
    assert_in_range(above, 0.01 * PROBLEMS * DRAWS, 0.035 * PROBLEMS * DRAWS);
}

/* With share 1 what is told of the population, by few points as by many. */
TEST(the_least_share_holds)
{
    const struct critical_choice choice = {1, 0.95};
    unsigned held = 0;
    for (int draw = 0; draw < 4000; draw++) {
        const uint32_t points = 3 + (uint32_t)(drawn() * 100);
        double number[MOST_POINTS];
        for (uint32_t p = 0; p < points; p++)
            number[p] = drawn();
        const struct critical_line line = line_of(number, points);
        const struct critical_value found = critical_find(&line, &choice);
        assert_true(isnan(found.low) && isnan(found.high));
        held += 1 - found.kept >= found.least_share; /* of evenly distributed numbers */
    }
    print_message("%.2f %% held\n", held / 40.0);
    assert_in_range(held, 3760, 3880); /* 94 to 97 %: a little more than 95, by the spacing */
}

/* Few points say nothing of a share near 1, and that is told. */
TEST(few_points_have_open_ends)
{
    double number[MOST_POINTS];
    for (uint32_t points = 2; points <= 80; points++) {
        for (uint32_t p = 0; p < points; p++)
            number[p] = (p + 0.5) / points;
        const struct critical_line line = line_of(number, points);
        const struct critical_value half =
            critical_find(&line, &(struct critical_choice){0.5, 0.95});
        const struct critical_value most =
            critical_find(&line, &(struct critical_choice){0.9, 0.95});
        assert_int_equal(isnan(half.low), points < 6);
        assert_int_equal(isnan(half.high), points < 6);
        assert_int_equal(isnan(most.low), points < 36);
        assert_true(points < 6 || (half.low <= half.kept && half.lost <= half.high));
    }
}

/* A word's letters are values: k kept, l lost, u unknown, of one case. */
static struct critical_line word_line(const char *word)
{
    const size_t n = strlen(word);
    bool lost = false, open = false;
    for (size_t i = 0; i < n; i++) {
        value[i] = 10.0 * (double)i;
        gone[i] = lost = lost || word[i] == 'l';
        maybe[i] = open = open || word[i] != 'k';
        out[i] = word[i] != 'k';
    }
    return (struct critical_line){n, value, 1, gone, maybe, out};
}

TEST(brackets_are_exact)
{
    static const struct {
        const char *word;
        enum critical_end end;
        double kept, lost;
        size_t unknown, islands;
    } rows[] = {
        {"kkkkk", CRITICAL_KEPT, 40, NAN, 0, 0},     {"kkkll", CRITICAL_LOST, 20, 30, 0, 0},
        {"lllll", CRITICAL_OUTSIDE, NAN, 0, 0, 0},   {"lkkkl", CRITICAL_OUTSIDE, NAN, 0, 0, 1},
        {"kklkk", CRITICAL_LOST, 10, 20, 0, 1},      {"klklk", CRITICAL_LOST, 0, 10, 0, 2},
        {"kkull", CRITICAL_LOST, 10, 30, 1, 0},      {"kukll", CRITICAL_LOST, 0, 30, 2, 0},
        {"ukkkk", CRITICAL_UNKNOWN, NAN, NAN, 5, 0}, {"kkkku", CRITICAL_UNKNOWN, 30, NAN, 1, 0},
        {"ullll", CRITICAL_LOST, NAN, 10, 1, 0},     {"klukl", CRITICAL_LOST, 0, 10, 0, 1},
    };
    const struct critical_choice choice = {0.9, 0.95};
    for (size_t k = 0; k < COUNT(rows); k++) {
        const struct critical_line line = word_line(rows[k].word);
        const struct critical_value found = critical_find(&line, &choice);
        struct critical_island island;
        size_t islands = 0;
        for (size_t at = found.after; critical_next_island(&line, &choice, &at, &island);)
            islands++;
        assert_int_equal(found.end, rows[k].end);
        assert_true(isnan(rows[k].kept) ? isnan(found.kept) : found.kept == rows[k].kept);
        assert_true(isnan(rows[k].lost) ? isnan(found.lost) : found.lost == rows[k].lost);
        assert_int_equal(found.unknown, rows[k].unknown);
        assert_int_equal(islands, rows[k].islands);
    }
}

TEST(islands_lie_between_neighbours)
{
    const struct critical_choice choice = {1, 0.95};
    const struct critical_line line = word_line("kkllkkklkk");
    struct critical_island island;
    size_t at = 2;
    assert_true(critical_next_island(&line, &choice, &at, &island));
    assert_true(island.from[0] == 30 && island.from[1] == 40);
    assert_true(island.to[0] == 60 && island.to[1] == 70);
    assert_true(critical_next_island(&line, &choice, &at, &island));
    assert_true(island.from[0] == 70 && island.from[1] == 80);
    assert_true(island.to[0] == 90 && isnan(island.to[1]));
    assert_false(critical_next_island(&line, &choice, &at, &island));
}

TEST(ranges_are_read)
{
    static const char *const bad[] = {"a",     "a=1",     "a=1..1", "a=..2",    "a=1..",
                                      "=1..2", "a=1..2x", "a=x..2", "a=nan..1", "a=0..inf"};
    char path[96];
    double ends[2];
    assert_true(option_range("robot.points.p.force[0]=-1e1..2.5", path, ends));
    assert_string_equal(path, "robot.points.p.force[0]");
    assert_true(ends[0] == -10 && ends[1] == 2.5);
    for (size_t k = 0; k < COUNT(bad); k++)
        assert_false(option_range(bad[k], path, ends));
}
