/* test_ground_line.c - the ground as it is drawn: lines of plates, what footfalls lay, gaps over
 * it.
 */
#include "reading.h"

#include "runner/plan/ground_line.h"

static const char text[] =
    "stance: 1\n"
    "scene: rod\n"
    "ground:\n"
    "  slope: 0.1\n"
    "  plates:\n"
    "    down: {from: 1, height: -0.5}\n"
    "    stairs: {kind: stairs, from: 2, width: 0.5, height: 0.2, count: 2}\n"
    "    rough: {kind: rough, from: 5, width: 0.25, height: 0.1, count: 4}\n"
    "    late: {footfall: 3, from: 0.3, height: 0.7}\n"
    "initial: {state: {z: 1}}\n"
    "stop: {time: 1}\n";

static struct scenario scenario;

static stance_case *a_case(uint64_t index)
{
    static stance_case c;
    struct scenario_values values;
    scenario_case_values(&scenario, index, &values);
    ground_case(&scenario, &values, index, &c);
    return &c;
}

static int begin(void **state __attribute__((unused)))
{
    read_good(&scenario, text, NULL, 0);
    return 0;
}

static int end(void **state __attribute__((unused)))
{
    scenario_free(&scenario);
    return 0;
}
static CMFixtureFunction before_each = begin, after_each = end;

/* Along the ground and off its plane. */
static void lay(const double point[2], double out[2])
{
    out[0] = point[0] * cos(0.1) - point[1] * sin(0.1);
    out[1] = point[0] * sin(0.1) + point[1] * cos(0.1);
}

TEST(lines_have_corners)
{
    static const double corner[][2] = {{-1, 0},     {1, 0},      {1, -0.5}, {2, -0.5}, {2, -0.3},
                                       {2.5, -0.3}, {2.5, -0.1}, {3, -0.1}, {3, -0.1}, {4, -0.1}};
    const stance_case *const c = a_case(0);
    struct ground_pieces pieces;
    double point[64][2], at[2], low = INFINITY, high = -INFINITY;
    ground_pieces_find(c, NULL, &pieces);
    assert_true(isinf(pieces.laid[3]) && pieces.laid[3] > 0);
    assert_int_equal(ground_line(c, &pieces, 0, -1, 4, point, 64), 10);
    for (size_t k = 0; k < 10; k++) {
        lay(point[k], at);
        assert_near(at[0], corner[k][0], 1e-12);
        assert_near(at[1], corner[k][1], 1e-12);
    }
    /* Without room the rest is straight. */
    assert_int_equal(ground_line(c, &pieces, 0, -1, 4, point, 6), 6);
    lay(point[5], at);
    assert_near(at[0], 4, 1e-12);
    assert_near(ground_mean(c, &pieces, 0, 0, 2), -0.25, 1e-12);
    /* Rough ground: about what was before it, another in each plate, and that again behind it. */
    const size_t points = ground_line(c, &pieces, 0, 5, 6.5, point, 64);
    assert_int_equal(points, 10);
    for (size_t k = 0; k < points; k++) {
        lay(point[k], at);
        low = fmin(low, at[1]), high = fmax(high, at[1]);
        assert_true(k + 2 < points ? fabs(at[1] + 0.1) <= 0.1 : fabs(at[1] + 0.1) < 1e-12);
    }
    assert_true(high - low > 0.02);
}

/* The same rough ground for the same place in the study and the same seed; another for others. */
TEST(rough_ground_is_its_own)
{
    const char *const sets[] = {"sweep.grid=[{path: initial.state.z, values: [1, 2]}, "
                                "{path: ground.plates.rough.seed, values: [4, 5]}]"};
    double own[3], height, unused;
    struct ground_pieces pieces;
    scenario_free(&scenario);
    for (int k = 0; k < 3; k++) { /* by `seed`, then twice by its place */
        read_good(&scenario, text, sets, k == 0);
        const stance_case *c = a_case(0);
        ground_pieces_find(c, NULL, &pieces);
        stance_ground_at(c, pieces.from, 5.1, &own[k], &unused);
        if (k == 0) { /* not by the case's place, but by the number */
            stance_ground_at(a_case(2), pieces.from, 5.1, &height, &unused);
            assert_near(height, own[0], 0);
            stance_ground_at(a_case(1), pieces.from, 5.1, &height, &unused);
            assert_true(height != own[0]);
        }
        if (k < 2)
            scenario_free(&scenario);
    }
    assert_near(own[1], own[2], 0);
    assert_true(own[0] != own[1]);
}

/* Two ends of a rod that come down in turn; the third footfall lays a piece ahead of the second. */
TEST(footfalls_lay_pieces)
{
    enum { ROWS = 7 };
    const stance_case *const c = a_case(0);
    double time[ROWS], position[ROWS][3], velocity[ROWS][3], force[ROWS][2][2], gap[ROWS][2];
    /* Which end pushes: first, it again, second, first, none, first, second. */
    static const int pushes[ROWS] = {-1, 0, 1, 0, -1, 0, 1};
    struct ground_pieces pieces;
    double point[64][2], at[2];
    memset(velocity, 0, sizeof velocity);
    memset(force, 0, sizeof force);
    for (int k = 0; k < ROWS; k++) {
        time[k] = k;
        position[k][0] = k, position[k][1] = 1, position[k][2] = 0;
        for (int i = 0; i < 2; i++) {
            gap[k][i] = 1;
            force[k][i][0] = pushes[k] == i;
        }
    }
    const struct ground_motion motion = {
        ROWS, time, &position[0][0], &velocity[0][0], &force[0][0][0], &gap[0][0]};
    ground_pieces_find(c, &motion, &pieces);
    /* Footfalls: of end 1 at 1 s, of 2 at 2 s: there the piece is laid, before that of 3 s. */
    assert_near(pieces.laid[3], 2, 0);
    const double end2[2] = {2.5, 1}; /* the rod is 1 m long, its centre at 2 m */
    lay(end2, at);
    assert_near(pieces.from[3], at[0] + 0.3, 1e-12);
    for (int late = 0; late < 2; late++) {
        ground_line(c, &pieces, late ? 2 : 1.9, pieces.from[3] + 0.1, pieces.from[3] + 0.2, point,
                    64);
        lay(point[0], at);
        assert_near(at[1], late ? 0.7 : -0.1, 1e-12);
    }
    /* An end that lies on the ground at first has landed before. */
    gap[0][0] = 0;
    ground_pieces_find(c, &motion, &pieces);
    assert_near(pieces.laid[3], 3, 0);
}

TEST(gaps_are_over_plates)
{
    const stance_case *const c = a_case(0);
    double position[3] = {1 * cos(0.1), -1 * sin(0.1), -0.1}, gap[STANCE_MAX_CONTACTS],
           plane[STANCE_MAX_CONTACTS];
    c->scene->gaps(c->scene, c->robot, position, plane);
    ground_gaps(c, position, gap); /* one end at 0.5 m, the other at 1.5 m along the ground */
    assert_near(plane[0], 0, 1e-12);
    assert_near(gap[0], plane[0], 1e-12);
    assert_near(gap[1], plane[1] + 0.5, 1e-12);
}
