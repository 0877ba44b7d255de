/* test_refine.c - which points of a map are simulated and what the others get, against a second
 * implementation that goes through cells one by one with the definition of refine.h in hand.
 */
#include "support.h"

#include "runner/plan/refine.h"

enum { MOST = 40000, LABELS = REFINE_FAILED + 1 };

typedef int (*label_function)(const struct refine_map *map, const size_t *at);

static uint64_t points_of(const struct refine_map *map)
{
    uint64_t points = 1;
    for (int a = 0; a < map->axes; a++)
        points *= map->count[a];
    return points;
}

static void place_of(const struct refine_map *map, uint64_t row, size_t *at)
{
    for (int a = map->axes - 1; a >= 0; a--) {
        at[a] = row % map->count[a];
        row /= map->count[a];
    }
}

static int truth(const struct refine_map *map, label_function label, uint64_t row)
{
    size_t at[SCENARIO_MAX_AXES];
    place_of(map, row, at);
    return label(map, at);
}

/* ---- the second implementation -------------------------------------------------------------- */

static size_t stride_at(const struct refine_map *map, int a, int level)
{
    size_t stride = 1;
    while (map->refined[a] && (double)map->count[a] / (double)stride > (double)map->start)
        stride *= 2;
    for (; level > 0 && stride > 1; level--)
        stride /= 2;
    return stride;
}

static int levels_of(const struct refine_map *map)
{
    int levels = 0;
    for (int a = 0; a < map->axes; a++)
        while (stride_at(map, a, levels) > 1)
            levels++;
    return levels;
}

static bool on_lattice(const struct refine_map *map, const size_t *at, int level)
{
    for (int a = 0; a < map->axes; a++)
        if (at[a] % stride_at(map, a, level) != 0 && at[a] != map->count[a] - 1)
            return false;
    return true;
}

/* Whether a point lies in the closed cell that begins at `corner`. */
static bool in_cell(const struct refine_map *map, const size_t *corner, const size_t *at, int level)
{
    for (int a = 0; a < map->axes; a++) {
        size_t width = map->refined[a] ? stride_at(map, a, level) : 0;
        if (at[a] < corner[a] || at[a] > corner[a] + width)
            return false;
    }
    return true;
}

/* Whether a cell begins at a point. */
static bool begins_cell(const struct refine_map *map, const size_t *at, int level)
{
    for (int a = 0; a < map->axes; a++)
        if (map->refined[a] &&
            (at[a] % stride_at(map, a, level) != 0 || at[a] == map->count[a] - 1))
            return false;
    return true;
}

/* The labels of the known points in a cell, a bit each. */
static int labels_in(const struct refine_map *map, const int *known, const size_t *corner,
                     int level)
{
    int labels = 0;
    size_t at[SCENARIO_MAX_AXES];
    for (uint64_t i = 0; i < points_of(map); i++) {
        place_of(map, i, at);
        if (known[i] && in_cell(map, corner, at, level))
            labels |= 1 << known[i];
    }
    return labels;
}

static bool mixed(int labels)
{
    return (labels & (labels - 1)) != 0 || (labels >> REFINE_FAILED & 1);
}

static bool within(const struct refine_map *map, const size_t *p, const size_t *q, int level)
{
    for (int a = 0; a < map->axes; a++) {
        size_t apart = p[a] > q[a] ? p[a] - q[a] : q[a] - p[a];
        if (apart > (map->refined[a] ? map->margin * stride_at(map, a, level) : 0))
            return false;
    }
    return true;
}

/* What is simulated and what every point gets; probes and wanted points are `known` at first. */
static void brute(const struct refine_map *map, label_function label, int *known, int *result)
{
    static int cell[MOST];
    const uint64_t points = points_of(map);
    size_t p[SCENARIO_MAX_AXES], q[SCENARIO_MAX_AXES];
    bool changed = true;

    for (uint64_t i = 0; i < points; i++) {
        place_of(map, i, p);
        if (on_lattice(map, p, 0))
            known[i] = label(map, p);
    }
    while (changed) {
        changed = false;
        memcpy(result, known, points * sizeof *known);
        for (int l = 0; l < levels_of(map); l++) {
            for (uint64_t c = 0; c < points; c++) {
                place_of(map, c, p);
                cell[c] = begins_cell(map, p, l) ? labels_in(map, known, p, l) : 0;
            }
            for (uint64_t c = 0; c < points; c++) {
                bool refined = false;
                place_of(map, c, p);
                if (!begins_cell(map, p, l))
                    continue;
                for (uint64_t d = 0; d < points && !refined; d++) {
                    place_of(map, d, q);
                    refined = mixed(cell[d]) && within(map, p, q, l);
                }
                for (uint64_t i = 0; i < points; i++) {
                    place_of(map, i, q);
                    if (!in_cell(map, p, q, l))
                        continue;
                    if (refined && on_lattice(map, q, l + 1) && !known[i]) {
                        known[i] = label(map, q);
                        changed = true;
                    } else if (!refined && !result[i]) {
                        for (int k = 1; k < LABELS; k++)
                            result[i] = cell[c] == 1 << k ? k : result[i];
                    }
                }
            }
        }
    }
}

/* ---- both ----------------------------------------------------------------------------------- */

static void refine_gone(struct refine *const *refine)
{
    refine_free(*refine);
}
#define REFINE FREED(refine_gone) struct refine

/* Runs a map, `room` points a round, each round's labels given in reverse; how many simulated. */
static uint64_t run(struct refine *refine, const struct refine_map *map, label_function label,
                    size_t room)
{
    uint64_t *rows = malloc(room * sizeof *rows), simulated = 0;
    size_t n;
    assert_non_null(rows);
    while ((n = refine_next(refine, rows, room)) > 0) {
        for (size_t k = n; k-- > 0;) {
            assert_true(k == 0 || rows[k - 1] < rows[k]);
            assert_int_equal(refine_label(refine, rows[k]), REFINE_UNKNOWN);
            refine_set(refine, rows[k], truth(map, label, rows[k]));
        }
        simulated += n;
    }
    free(rows);
    refine_infer(refine);
    return simulated;
}

/* Both implementations do the same, whatever the size of the rounds. */
static void agree(const struct refine_map *map, label_function label)
{
    static int known[MOST], result[MOST];
    const uint64_t points = points_of(map);
    const size_t rooms[] = {1, 7, MOST};

    assert_true(points <= MOST);
    memset(known, 0, sizeof known);
    for (int r = 0; r < 3; r++) {
        REFINE *refine = refine_make(map);
        uint64_t rows[MOST], n;
        assert_non_null(refine);
        refine_want(refine, points / 3);
        if (r == 0) {
            n = refine_next(refine, rows, MOST);
            for (uint64_t k = 0; k < n; k++)
                known[rows[k]] = truth(map, label, rows[k]);
            brute(map, label, known, result);
        }
        uint64_t simulated = run(refine, map, label, rooms[r]), expected = 0;
        for (uint64_t i = 0; i < points; i++) {
            expected += known[i] != 0;
            assert_int_equal(refine_inferred(refine, i), known[i] == 0);
            assert_int_equal(refine_label(refine, i), result[i]);
            assert_true(result[i] > 0);
        }
        assert_int_equal(simulated, expected);
    }
}

static int half_plane(const struct refine_map *map, const size_t *at)
{
    (void)map;
    return 3 * at[0] + (2 * at[1] + 1) < 47 ? 2 : 3;
}

static int failures(const struct refine_map *map, const size_t *at)
{
    return at[0] + at[1] < 9                            ? REFINE_FAILED
           : at[0] == 20 && at[1] == 13                 ? REFINE_FAILED
           : at[1] > map->count[1] - 5 && at[0] % 7 < 3 ? 1
                                                        : 2;
}

static int ball(const struct refine_map *map, const size_t *at)
{
    double sum = 0;
    for (int a = 0; a < map->axes; a++)
        sum += map->refined[a] ? pow((double)at[a] - 0.45 * (double)map->count[a], 2) : 0;
    return sum < 40 + 30.0 * (double)at[map->axes - 1] / (double)map->count[map->axes - 1] ? 2 : 3;
}

/* Islands and teeth from a generator of its own. */
static int ragged(const struct refine_map *map, const size_t *at)
{
    uint64_t state = 1;
    for (int a = 0; a < map->axes; a++)
        state = state * 1000003 + at[a];
    return uniform(&state, 0, 1) < 0.01 ? 4 : at[0] > at[map->axes - 1] ? 2 : 3;
}

TEST(test_second_implementation)
{
    const label_function labels[] = {half_plane, failures, ball, ragged};
    const size_t counts[][2] = {{33, 31}, {24, 37}, {17, 5}};
    for (size_t l = 0; l < 4; l++)
        for (size_t c = 0; c < 3; c++)
            for (size_t margin = 0; margin < 3; margin++) {
                struct refine_map map = {.axes = 2,
                                         .count = {counts[c][0], counts[c][1]},
                                         .refined = {true, counts[c][1] > 5},
                                         .start = 5 - margin,
                                         .margin = margin,
                                         .probes = margin == 1 ? 0 : 0.05,
                                         .seed = l};
                agree(&map, labels[l]);
            }
}

TEST(test_more_axes)
{
    const struct refine_map solid = {.axes = 3,
                                     .count = {11, 10, 12},
                                     .refined = {true, true, true},
                                     .start = 3,
                                     .margin = 0,
                                     .probes = 0.01,
                                     .seed = 3};
    /* Two maps beside each other, about an axis that is taken in full. */
    const struct refine_map pair = {.axes = 3,
                                    .count = {19, 2, 21},
                                    .refined = {true, false, true},
                                    .start = 4,
                                    .margin = 1,
                                    .probes = 0.01,
                                    .seed = 4};
    const struct refine_map line = {.axes = 1,
                                    .count = {700},
                                    .refined = {true},
                                    .start = 7,
                                    .margin = 1,
                                    .probes = 0.002,
                                    .seed = 5};
    agree(&solid, ball);
    agree(&solid, ragged);
    agree(&pair, ball);
    agree(&pair, ragged);
    agree(&line, ball);
}

/* ---- what it is good for -------------------------------------------------------------------- */

static int disc(const struct refine_map *map, const size_t *at)
{
    double x = ((double)at[0] + 0.5) / (double)map->count[0] - 0.5,
           y = ((double)at[1] + 0.5) / (double)map->count[1] - 0.5;
    return x * x + y * y < 0.09 ? 2 : 3;
}

/* A smooth boundary is found to the last point, with work that grows like its length. */
TEST(test_smooth)
{
    uint64_t before = 0;
    for (size_t n = 128; n <= 1024; n *= 2) {
        const struct refine_map map = {
            .axes = 2, .count = {n, n}, .refined = {true, true}, .start = 16, .margin = 1};
        REFINE *refine = refine_make(&map);
        assert_non_null(refine);
        uint64_t simulated = run(refine, &map, disc, 1 << 20);
        for (uint64_t i = 0; i < n * n; i++)
            assert_int_equal(refine_label(refine, i), truth(&map, disc, i));
        assert_int_equal(refine_coarse(&map), 17 * 17);
        /* 2 pi 0.3 n crossings, a band of 2 (1 + 2 margin) + 1 points at the last level, as much as
         * that in all levels before it, and some more where the boundary is oblique. */
        assert_in_range(simulated, (uint64_t)(2 * 1.885 * (double)n), 289 + 28 * 1.885 * n);
        assert_true(simulated < 2 * before + 300 || before == 0);
        before = simulated;
    }
}

/* An island between the points of the lattice. */
static int island(const struct refine_map *map, const size_t *at)
{
    (void)map;
    return at[0] >= 100 && at[0] < 110 && at[1] >= 34 && at[1] < 46 ? 4 : 2;
}

/* Seen by a probe, an island is mapped whole; how often that is follows from its size. */
TEST(test_probes)
{
    enum { SEEDS = 400, N = 128, INNER = 120 };
    const double share = 0.01;
    int seen = 0;
    double probes = 0;
    for (uint64_t seed = 0; seed < SEEDS; seed++) {
        const struct refine_map map = {.axes = 2,
                                       .count = {N, N},
                                       .refined = {true, true},
                                       .start = 8,
                                       .probes = share,
                                       .seed = seed};
        REFINE *refine = refine_make(&map);
        uint64_t rows[N * N], right = 0;
        assert_non_null(refine);
        probes += (double)refine_next(refine, rows, N * N) - (double)refine_coarse(&map);
        run(refine, &map, island, N * N);
        for (uint64_t i = 0; i < N * N; i++)
            right += refine_label(refine, i) == truth(&map, island, i);
        assert_true(right == N * N || right == N * N - INNER);
        seen += right == N * N;
    }
    /* Binomial: within four standard deviations. The lattice has 9 x 9 points of its own. */
    const double p = 1 - pow(1 - share, INNER), n = (double)SEEDS * (N * N - 81);
    assert_true(fabs(seen - SEEDS * p) < 4 * sqrt(SEEDS * p * (1 - p)));
    assert_true(fabs(probes - n * share) < 4 * sqrt(n * share * (1 - share)));
}

TEST(test_extremes)
{
    struct refine_map map = {
        .axes = 2, .count = {40, 40}, .refined = {true, true}, .start = 8, .probes = 1};
    REFINE *refine = refine_make(&map);
    assert_non_null(refine);
    assert_int_equal(run(refine, &map, half_plane, 64), 1600);
    refine_free(refine);
    map.probes = 0;
    map.margin = 1000000000;
    refine = refine_make(&map);
    assert_non_null(refine);
    assert_int_equal(run(refine, &map, half_plane, 64), 1600);
}
