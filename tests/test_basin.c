/* test_basin.c - basins against sets whose volume, entropy and dimension are known. */
#include "long.h"
#include "support.h"

#include "analysis/basin/basin_map.h"

static void assert_near(double found, double wanted, double tolerance)
{
    if (!(fabs(found - wanted) <= tolerance))
        fail_msg("%.17g is not %.17g +- %g", found, wanted, tolerance);
}

/* ---- maps --------------------------------------------------------------------------------- */

/* What stands at a point of the unit cube. */
typedef enum results_kind (*painter)(const double *at);

struct drawn {
    struct basin_map map;
    uint8_t *kind;
    double *place;
};

/* n places along each axis; centred: in the middles of n cells, else from 0 to 1. */
static struct drawn draw(int axes, size_t n, bool centred, painter colour)
{
    struct drawn d = {.map = {.axes = axes, .cases = 1}};
    d.place = malloc(n * sizeof *d.place);
    assert_non_null(d.place);
    for (size_t i = 0; i < n; i++)
        d.place[i] = centred ? ((double)i + 0.5) / (double)n : (double)i / (double)(n - 1);
    for (int a = 0; a < axes; a++) {
        d.map.count[a] = n;
        d.map.place[a] = d.place;
        d.map.cases *= n;
    }
    d.kind = malloc(d.map.cases);
    assert_non_null(d.kind);
    for (uint64_t i = 0; i < d.map.cases; i++) {
        double at[SCENARIO_MAX_AXES];
        uint64_t rest = i;
        for (int a = axes - 1; a >= 0; a--, rest /= n)
            at[a] = d.place[rest % n];
        d.kind[i] = (uint8_t)colour(at);
    }
    d.map.kind = d.kind;
    return d;
}

static void erase(struct drawn *d)
{
    free(d->kind);
    free(d->place);
}

#define DRAWN FREED(erase) struct drawn

static struct basin_exponent exponent_of(const struct basin_map *map)
{
    struct basin_uncertainty u = {.scales = basin_map_scales(map)};
    basin_map_uncertainty(map, &u);
    return basin_exponent(&u);
}

static enum results_kind in(bool inside)
{
    return inside ? RESULTS_STABILISED : RESULTS_FELL;
}

static enum results_kind interval(const double *at)
{
    return in(at[0] > 0.3 && at[0] < 0.73);
}

static enum results_kind line(const double *at)
{
    return in(0.4 * at[0] + 0.61 * at[1] < 0.503);
}

static enum results_kind disc(const double *at)
{
    return in(hypot(at[0] - 0.5, at[1] - 0.5) < 0.35);
}

static enum results_kind sphere(const double *at)
{
    return in(hypot(hypot(at[0] - 0.5, at[1] - 0.5), at[2] - 0.5) < 0.35);
}

static enum results_kind everything(const double *at)
{
    (void)at;
    return RESULTS_STABILISED;
}

/* Two colours that follow each other in the gaps of Cantor's set of middle thirds. */
static enum results_kind cantor(const double *at)
{
    double x = at[0];
    int stage = 0;
    for (; stage < 30 && (x <= 1 / 3.0 || x >= 2 / 3.0); stage++)
        x = x <= 1 / 3.0 ? 3 * x : 3 * x - 2;
    return in(stage % 2);
}

static enum results_kind koch(const double *at)
{
    return in(below_koch(at[0], at[1] - 0.6, 12));
}

static enum results_kind coin(const double *at)
{
    static uint64_t state = 88172645463325252u;
    (void)at;
    state ^= state << 13;
    state ^= state >> 7;
    state ^= state << 17;
    return in(state >> 40 & 1);
}

static double entropy_of(double p)
{
    return p > 0 && p < 1 ? -p * log(p) - (1 - p) * log(1 - p) : 0;
}

/* ---- volume ------------------------------------------------------------------------------- */

TEST(volumes_are_bounded)
{
    static const struct {
        int axes;
        size_t n;
        painter colour;
        double volume;
    } sets[] = {{1, 101, interval, 0.43},
                {2, 101, disc, M_PI * 0.35 * 0.35},
                {2, 100, line, 0},
                {3, 41, sphere, 4 * M_PI / 3 * 0.35 * 0.35 * 0.35},
                {2, 10, everything, 1}};
    for (size_t k = 0; k < COUNT(sets); k++) {
        DRAWN d = draw(sets[k].axes, sets[k].n, false, sets[k].colour);
        struct basin_volume v;
        /* Under the line: integral of (0.503 - 0.4 x) / 0.61, below 1 all the way. */
        const double wanted = sets[k].colour == line ? (0.503 - 0.2) / 0.61 : sets[k].volume;
        assert_true(basin_map_volume(&d.map, RESULTS_STABILISED, &v));
        assert_near(v.box, 1, 1e-12);
        assert_true(v.low <= wanted + 1e-12 && wanted <= v.high + 1e-12);
        assert_true(v.low <= v.estimate + 1e-12 && v.estimate <= v.high + 1e-12);
        assert_true(fabs(v.estimate - wanted) <= basin_volume_reach(&v, 3) + 1e-12);
        assert_int_equal(v.cells, pow((double)sets[k].n - 1, sets[k].axes) + 0.5);
    }
}

/* Two ends somewhere in their cells, evenly: the variance is that of the estimate's error. */
TEST(the_likely_error_of_an_interval_is_right)
{
    enum { TRIES = 400, N = 21 };
    double squares = 0, expected = 0, place[N];
    for (int i = 0; i < N; i++)
        place[i] = i / (N - 1.0);
    for (int t = 0; t < TRIES; t++) {
        const double low = 0.2 + 0.05 * fmod(t * 0.618034, 1),
                     high = 0.7 + 0.05 * fmod(t * 0.754878, 1);
        uint8_t kind[N];
        struct basin_volume v;
        for (int i = 0; i < N; i++)
            kind[i] = (uint8_t)in(place[i] > low && place[i] < high);
        const struct basin_map map = {1, {N}, {place}, N, kind};
        assert_true(basin_map_volume(&map, RESULTS_STABILISED, &v));
        squares += pow(v.estimate - (high - low), 2);
        expected += v.variance;
    }
    assert_near(squares / expected, 1, 0.1);
}

/* Shapes whose places, slopes and sizes are random, p[4] evenly in (0, 1); what of the square or
 * cube they fill. */
struct shape {
    const char *name;
    int axes;
    bool (*holds)(const double *p, const double *at);
    double (*volume)(const double *p);
    double slope, spread; /* of what is below a line: about it, evenly */
};
static const struct shape *drawn_shape;
static double drawn_at[5];

static bool along_axis(const double *p, const double *at)
{
    return at[0] < 0.3 + 0.4 * p[0];
}
static double along_axis_volume(const double *p)
{
    return 0.3 + 0.4 * p[0];
}
static bool in_box(const double *p, const double *at)
{
    return fabs(at[0] - 0.3 - 0.4 * p[0]) < 0.05 + 0.2 * p[1] &&
           fabs(at[1] - 0.3 - 0.4 * p[2]) < 0.05 + 0.2 * p[3];
}
static double in_box_volume(const double *p)
{
    return 4 * (0.05 + 0.2 * p[1]) * (0.05 + 0.2 * p[3]);
}
/* Below a line through (0.5, 0.3 ... 0.7): its mean height; in space a prism over it. */
static bool below(const double *p, const double *at)
{
    const double slope = drawn_shape->slope + drawn_shape->spread * (p[1] - 0.5);
    return at[1] < 0.3 + 0.4 * p[0] + slope * (at[0] - 0.5);
}
static bool under_diagonal(const double *p, const double *at)
{
    return at[0] + at[1] < 0.5 + 0.4 * p[0];
}
static double under_diagonal_volume(const double *p)
{
    const double side = 0.5 + 0.4 * p[0];
    return side * side / 2;
}
static bool in_disc(const double *p, const double *at)
{
    return hypot(at[0] - 0.45 - 0.1 * p[0], at[1] - 0.45 - 0.1 * p[1]) < 0.2 + 0.2 * p[2];
}
static double in_disc_volume(const double *p)
{
    return M_PI * pow(0.2 + 0.2 * p[2], 2);
}
static bool in_ball(const double *p, const double *at)
{
    return hypot(hypot(at[0] - 0.45 - 0.1 * p[0], at[1] - 0.45 - 0.1 * p[1]),
                 at[2] - 0.45 - 0.1 * p[3]) < 0.2 + 0.2 * p[2];
}
static double in_ball_volume(const double *p)
{
    return 4 * M_PI / 3 * pow(0.2 + 0.2 * p[2], 3);
}
static const struct shape shapes[] = {
    {"along an axis", 1, along_axis, along_axis_volume, 0, 0},
    {"along an axis", 2, along_axis, along_axis_volume, 0, 0},
    {"along an axis", 3, along_axis, along_axis_volume, 0, 0},
    {"a box", 2, in_box, in_box_volume, 0, 0},
    {"any slope", 2, below, along_axis_volume, 0, 1.1},
    {"nearly along", 2, below, along_axis_volume, 0, 0.02},
    {"slope 1/2", 2, below, along_axis_volume, 1 / 2.0, 0},
    {"slope 1/3", 2, below, along_axis_volume, 1 / 3.0, 0},
    {"slope 1", 2, under_diagonal, under_diagonal_volume, 0, 0},
    {"a disc", 2, in_disc, in_disc_volume, 0, 0},
    {"a ball", 3, in_ball, in_ball_volume, 0, 0},
    {"a prism", 3, below, along_axis_volume, 0, 1.1},
};

static enum results_kind drawn(const double *at)
{
    return in(drawn_shape->holds(drawn_at, at));
}

/* Conservative: in no kind of boundary the likely error at 95 % holds less often than that, and it
 * does not exceed what is certain. */
TEST(likely_errors_hold)
{
    const bool patient = long_tests();
    for (size_t k = 0; k < COUNT(shapes); k++) {
        const int tries = (patient ? 2000 : 300) / (shapes[k].axes == 3 ? 3 : 1);
        for (size_t n = 17; n <= (shapes[k].axes == 3 ? 17 : 65); n = 2 * n - 1) {
            uint64_t random = 7;
            static const double levels[] = {0.5, 0.68, 0.8, 0.9, 0.99};
            double held = 0, reach = 0, at_level[5] = {0};
            for (int t = 0; t < tries; t++) {
                struct basin_volume v;
                drawn_shape = &shapes[k];
                for (int i = 0; i < 4; i++)
                    drawn_at[i] = uniform(&random, 0, 1);
                DRAWN d = draw(shapes[k].axes, n, false, drawn);
                const double wanted = shapes[k].volume(drawn_at);
                assert_true(basin_map_volume(&d.map, RESULTS_STABILISED, &v));
                const double own = basin_volume_reach(&v, 1.959964);
                held += fabs(v.estimate - wanted) <= own + 1e-9;
                for (int l = 0; l < 5; l++)
                    at_level[l] += fabs(v.estimate - wanted) <=
                                   basin_volume_reach(&v, basin_map_deviations(levels[l])) + 1e-9;
                reach += own * (double)(n - 1) / tries;
                assert_true(own <= fmax(v.high - v.estimate, v.estimate - v.low) + 1e-12);
            }
            print_message("# %s, %zu places along %d: %.1f %% held, +- %.3f cells\n",
                          shapes[k].name, n, shapes[k].axes, 100 * held / tries, reach);
            assert_true(held / tries > 0.95 - 3 * sqrt(0.95 * 0.05 / tries));
            for (int l = 0; l < 5; l++) {
                const double level = levels[l];
                print_message("#   at %.0f %%: %.1f %%\n", 100 * level, 100 * at_level[l] / tries);
                assert_true(at_level[l] / tries > level - 3 * sqrt(level * (1 - level) / tries));
            }
        }
    }
}

TEST(unknown_cases_widen_the_bound)
{
    static const double place[] = {0, 1, 2, 4};
    const uint8_t kind[] = {RESULTS_STABILISED, RESULTS_STABILISED, RESULTS_FAILED, RESULTS_FELL};
    const struct basin_map map = {1, {4}, {place}, 4, kind};
    struct basin_volume v;
    assert_true(basin_map_volume(&map, RESULTS_STABILISED, &v));
    assert_near(v.box, 4, 0);
    assert_near(v.low, 1, 0);
    assert_near(v.high, 4, 0);
    /* Of the known length 0.5 + 1 + 1 the first 1.5 are inside. */
    assert_near(v.estimate, 4 * 1.5 / 2.5, 1e-12);
    assert_int_equal(v.crossed, 2);
}

/* ---- entropy ------------------------------------------------------------------------------ */

/* A straight edge parallel to an axis leaves m of the 5 columns of its boxes on one side. */
TEST(entropy_of_a_half_plane)
{
    for (int m = 0; m < 5; m++) {
        double place[30];
        uint8_t kind[900];
        for (int i = 0; i < 30; i++)
            place[i] = i;
        for (int i = 0; i < 900; i++)
            kind[i] = (uint8_t)in(i % 30 < 15 + m);
        const struct basin_map map = {2, {30, 30}, {place, place}, 900, kind};
        struct basin_entropy e = {0};
        basin_map_entropy(&map, 5, &e);
        assert_int_equal(e.boxes, 36);
        assert_int_equal(e.mixed, m > 0 ? 6 : 0);
        assert_near(basin_entropy(&e), entropy_of(m / 5.0) / 6, 1e-12);
        if (m > 0)
            assert_near(basin_boundary_entropy(&e), entropy_of(m / 5.0), 1e-12);
        else
            assert_true(isnan(basin_boundary_entropy(&e)));
    }
}

TEST(entropy_of_coins_is_log_2)
{
    DRAWN d = draw(2, 500, true, coin);
    struct basin_entropy e = {0};
    double expected = 0;
    /* Of 25 coins, exactly: a little below log 2. */
    for (int k = 0; k <= 25; k++)
        expected +=
            exp(lgamma(26) - lgamma(k + 1) - lgamma(26 - k) - 25 * log(2)) * entropy_of(k / 25.0);
    assert_near(expected, log(2) - 0.02, 0.001);
    basin_map_entropy(&d.map, 5, &e);
    assert_near(basin_boundary_entropy(&e), expected, 0.001);
    assert_int_equal(exponent_of(&d.map).refusal, BASIN_WIDE);
    erase(&d);
    /* Larger boxes see the coins' own entropy. */
    d = draw(2, 500, true, coin);
    e = (struct basin_entropy){0};
    basin_map_entropy(&d.map, 50, &e);
    assert_near(basin_boundary_entropy(&e), log(2), 0.001);
}

/* Three colours in every box, and failed cases that belong to none. */
TEST(entropy_counts_all_outcomes)
{
    static const uint8_t kind[] = {RESULTS_FELL,       RESULTS_RESTED, RESULTS_FAILED,
                                   RESULTS_STABILISED, RESULTS_FAILED, RESULTS_FAILED,
                                   RESULTS_PENDING,    RESULTS_FELL};
    static const double place[] = {0, 1, 2, 3, 4, 5, 6, 7};
    const struct basin_map map = {1, {8}, {place}, 8, kind};
    struct basin_entropy e = {0};
    basin_map_entropy(&map, 4, &e);
    assert_int_equal(e.boxes, 2);
    assert_int_equal(e.mixed, 1);
    assert_near(basin_boundary_entropy(&e), log(3), 1e-12);
    basin_map_entropy(&map, 9, &e);
    assert_int_equal(e.boxes, 2);
}

/* ---- uncertainty exponent ----------------------------------------------------------------- */

TEST(smooth_boundaries_have_exponent_1)
{
    static const struct {
        int axes;
        size_t n;
        painter colour;
    } sets[] = {{1, 400, interval}, {2, 256, line}, {2, 256, disc}, {3, 96, sphere}};
    for (size_t k = 0; k < COUNT(sets); k++) {
        DRAWN d = draw(sets[k].axes, sets[k].n, true, sets[k].colour);
        assert_near(exponent_of(&d.map).alpha, 1, 0.05);
    }
}

TEST(koch_curve_has_its_exponent)
{
    DRAWN d = draw(2, 729, true, koch);
    const struct basin_exponent e = exponent_of(&d.map);
    print_message("Koch: alpha %.4f +- %.4f, wanted %.4f\n", e.alpha, e.error, 2 - log(4) / log(3));
    assert_near(e.alpha, 2 - log(4) / log(3), 0.03);
    assert_true(e.error > 0 && e.error < 0.05);
}

TEST(cantor_stripes_have_their_exponent)
{
    const double wanted = 1 - log(2) / log(3);
    DRAWN d = draw(1, 59049, true, cantor);
    struct basin_exponent e = exponent_of(&d.map);
    print_message("Cantor: alpha %.4f +- %.4f, wanted %.4f\n", e.alpha, e.error, wanted);
    assert_near(e.alpha, wanted, 0.03);
    erase(&d);
    d = draw(2, 729, true, cantor);
    e = exponent_of(&d.map);
    print_message("Cantor stripes: alpha %.4f +- %.4f\n", e.alpha, e.error);
    assert_near(e.alpha, wanted, 0.05);
}

TEST(too_small_or_empty_maps_have_none)
{
    struct drawn small = draw(2, 95, true, line), whole = draw(2, 96, true, everything);
    assert_int_equal(basin_map_scales(&small.map), 3);
    assert_int_equal(exponent_of(&small.map).refusal, BASIN_SMALL);
    assert_int_equal(exponent_of(&whole.map).refusal, BASIN_NONE);
    assert_true(isnan(exponent_of(&small.map).alpha));
    assert_true(isnan(exponent_of(&whole.map).alpha));
    erase(&small);
    erase(&whole);
}

/* ---- boundary and distance ---------------------------------------------------------------- */

TEST(boundary_points_lie_on_the_boundary)
{
    DRAWN d = draw(2, 101, false, disc);
    struct basin_crossing crossing = {.axis = -1};
    int count = 0;
    double farthest = 0; /* from the circle */
    while (basin_next_crossing(&d.map, &crossing)) {
        double at[2];
        for (int a = 0; a < 2; a++)
            at[a] = a == crossing.axis ? crossing.middle : 0.01 * (double)crossing.point[a];
        count++;
        farthest = fmax(farthest, fabs(hypot(at[0] - 0.5, at[1] - 0.5) - 0.35));
        assert_near(crossing.half_width, 0.005, 1e-12);
        assert_true(crossing.from != crossing.to);
    }
    /* A line of each row and each column between -0.35 and 0.35 crosses twice. */
    assert_in_range(count, 4 * 69, 4 * 71);
    assert_true(farthest <= 0.005 + 1e-9);
}

TEST(distances_from_the_equilibrium)
{
    /* An ellipse (x / 2)^2 + y^2 < 1 around zero in a box of 8 x 4, one failed case beyond it. */
    enum { NX = 81, NY = 81 };
    static double x[NX], y[NY];
    static uint8_t kind[NX * NY];
    const size_t origin[] = {40, 40}, beyond[] = {75, 40};
    const double ranges[] = {8, 4}, equal[] = {1, 1}, long_x[] = {4, 1};
    struct basin_distance distance;
    for (int i = 0; i < NX; i++)
        x[i] = -4 + 0.1 * i;
    for (int i = 0; i < NY; i++)
        y[i] = -2 + 0.05 * i;
    for (int i = 0; i < NX * NY; i++)
        kind[i] = (uint8_t)in(pow(x[i / NY] / 2.01, 2) + pow(y[i % NY] / 1.001, 2) < 1);
    kind[61 * NY + 40] = RESULTS_FAILED;
    const struct basin_map map = {2, {NX, NY}, {x, y}, NX * NY, kind};
    assert_true(basin_map_distance(&map, RESULTS_STABILISED, origin, ranges, &distance));
    assert_true(distance.inside);
    assert_near(distance.low[0], -2.05, 1e-9);
    assert_true(isnan(distance.high[0])); /* the next case failed */
    assert_near(distance.low[1], -1.025, 1e-9);
    assert_near(distance.high[1], 1.025, 1e-9);
    /* In units of the ranges it is a circle of radius a quarter. */
    assert_near(distance.nearest, 0.25, 0.01);
    assert_near(distance.median, 0.25, 0.01);
    assert_near(distance.clear, 0.2625, 1e-9); /* the failed case at (2.1, 0) */
    /* Of an ellipse with half-axes 2 and 1 half of all directions end below 2 / sqrt(2.5). */
    assert_true(basin_map_distance(&map, RESULTS_STABILISED, origin, equal, &distance));
    assert_near(distance.nearest, 1.001, 0.025);
    assert_near(distance.median, 2 / sqrt(2.5), 0.03);
    assert_near(distance.median_least, distance.median, 0);
    assert_true(distance.leave < 30 && distance.directions == BASIN_DIRECTIONS);
    assert_near(distance.clear, 2, 1e-9); /* the faces at y = +-2 */
    /* One of half-axes 1/2 and 1: the other way round. */
    assert_true(basin_map_distance(&map, RESULTS_STABILISED, origin, long_x, &distance));
    assert_near(distance.nearest, 0.5125, 0.02);
    assert_near(distance.at[1], 0, 0.2);
    assert_near(distance.median, 1 / sqrt(2.5), 0.02);
    assert_true(basin_map_distance(&map, RESULTS_STABILISED, beyond, equal, &distance));
    assert_false(distance.inside);
    assert_true(isnan(distance.nearest) && isnan(distance.median));
    /* A box that ends at y = +-0.5: what the boundary is like beyond it is not known. */
    static uint8_t middle[NX * 21];
    for (int i = 0; i < NX * 21; i++)
        middle[i] = kind[i / 21 * NY + 30 + i % 21];
    const struct basin_map cut = {2, {NX, 21}, {x, y + 30}, NX * 21, middle};
    const size_t centre[] = {40, 10};
    assert_true(basin_map_distance(&cut, RESULTS_STABILISED, centre, equal, &distance));
    assert_near(distance.clear, 0.5, 1e-9);
    assert_true(distance.nearest > 1.6);
    /* All but those within atan(0.5 / 1.73) of the axis leave. */
    assert_near((double)distance.leave / (double)distance.directions, 1 - 0.179, 0.02);
    assert_true(isnan(distance.median));
    assert_near(distance.median_least, 0.5 * sqrt(2), 0.01);
}

/* ---- the domain of the equilibrium -------------------------------------------------------- */

/* A disc about the middle, and what it must not be taken for: an island in a corner. */
static enum results_kind disc_and_island(const double *at)
{
    return in(hypot(at[0] - 0.5, at[1] - 0.5) < 0.21 || hypot(at[0], at[1]) < 0.2);
}
static enum results_kind two_balls(const double *at)
{
    return in(hypot(hypot(at[0] - 0.5, at[1] - 0.5), at[2] - 0.5) < 0.21 || at[2] > 0.9);
}
static enum results_kind two_intervals(const double *at)
{
    return in(fabs(at[0] - 0.5) < 0.21 || at[0] < 0.2);
}

TEST(the_part_about_the_equilibrium)
{
    static const struct {
        int axes;
        size_t n;
        painter colour;
        double volume, tolerance;
    } sets[] = {{1, 201, two_intervals, 0.42, 0.005},
                {2, 201, disc_and_island, M_PI * 0.21 * 0.21, 0.001},
                {3, 41, two_balls, 4 * M_PI / 3 * 0.21 * 0.21 * 0.21, 0.001}};
    for (size_t k = 0; k < COUNT(sets); k++) {
        DRAWN d = draw(sets[k].axes, sets[k].n, false, sets[k].colour);
        const size_t half = sets[k].n / 2, origin[] = {half, half, half}, corner[] = {0, 0, 0};
        const size_t last[] = {sets[k].n - 1, sets[k].n - 1, sets[k].n - 1};
        struct basin_part part;
        struct basin_volume all;
        assert_true(basin_map_part(&d.map, RESULTS_STABILISED, origin, &part));
        assert_true(basin_map_volume(&d.map, RESULTS_STABILISED, &all));
        assert_true(part.inside && !part.unknown);
        assert_int_equal(part.faces, 0);
        assert_near(part.volume.estimate, sets[k].volume, sets[k].tolerance);
        assert_true(part.volume.low <= sets[k].volume && sets[k].volume <= part.volume.high);
        assert_true(all.estimate > part.volume.estimate + 0.02);
        /* The other part is cut by the box: at its lower ends in the line and in the plane. */
        const bool space = sets[k].axes == 3;
        assert_true(basin_map_part(&d.map, RESULTS_STABILISED, space ? last : corner, &part));
        assert_int_equal(part.faces, space ? 1 + 2 + 4 + 8 + 32 : sets[k].axes == 1 ? 1 : 1 + 4);
        /* Unknown cases: one far away does not matter, one beside the part does, one at the
         * equilibrium leaves all open. */
        uint64_t stride[SCENARIO_MAX_AXES];
        basin_strides(&d.map, stride);
        const uint64_t middle = basin_index(&d.map, stride, origin);
        d.kind[d.map.cases - 1] = RESULTS_FAILED;
        assert_true(basin_map_part(&d.map, RESULTS_STABILISED, origin, &part) && !part.unknown);
        d.kind[middle + (size_t)ceil(0.21 * (double)(sets[k].n - 1))] = RESULTS_PENDING;
        assert_true(basin_map_part(&d.map, RESULTS_STABILISED, origin, &part) && part.unknown);
        d.kind[middle] = RESULTS_FAILED;
        assert_true(basin_map_part(&d.map, RESULTS_STABILISED, origin, &part));
        assert_true(!part.inside && part.unknown);
        d.kind[middle] = RESULTS_FELL;
        assert_true(basin_map_part(&d.map, RESULTS_STABILISED, origin, &part));
        assert_true(!part.inside && !part.unknown);
    }
}

/* A ball at any place about the middle, and an island in a corner; how often its likely error holds
 * and its bounds. */
static enum results_kind ball_and_island(const double *at)
{
    double near = 0, far = 0;
    for (int a = 0; a < (int)drawn_at[0]; a++) {
        near += pow(at[a] - 0.45 - 0.1 * drawn_at[1 + a], 2);
        far += pow(at[a], 2);
    }
    return in(sqrt(near) < drawn_at[4] || sqrt(far) < 0.05);
}

TEST(likely_errors_of_the_part_hold)
{
    static const double unit_ball[] = {2, M_PI, 4 * M_PI / 3};
    for (int axes = 1; axes <= 3; axes++) {
        const int tries = axes == 3 ? 100 : 1000;
        const size_t n = axes == 3 ? 25 : 49, origin[] = {n / 2, n / 2, n / 2};
        uint64_t random = 11;
        int held = 0, bounded = 0;
        drawn_at[0] = axes;
        for (int t = 0; t < tries; t++) {
            struct basin_part part;
            for (int i = 1; i < 4; i++)
                drawn_at[i] = uniform(&random, 0, 1);
            drawn_at[4] = uniform(&random, 0.2, 0.3);
            DRAWN d = draw(axes, n, false, ball_and_island);
            const double wanted = unit_ball[axes - 1] * pow(drawn_at[4], axes);
            assert_true(basin_map_part(&d.map, RESULTS_STABILISED, origin, &part));
            const double own = basin_volume_reach(&part.volume, basin_map_deviations(0.95));
            held += fabs(part.volume.estimate - wanted) <= own + 1e-9;
            bounded += part.volume.low <= wanted && wanted <= part.volume.high;
        }
        print_message("# part about the equilibrium, %d axes: %.1f %%, bounds %.1f %%\n", axes,
                      100.0 * held / tries, 100.0 * bounded / tries);
        assert_true(held >= 0.93 * tries && bounded == tries);
    }
}
