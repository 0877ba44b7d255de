/* test_branches - a landing with three answers (one foot, friction 1, a heavy trunk): it sticks, it
 * slides, it leaves again, and each obeys every law. All methods take the same one, whatever the
 * step and the tolerance, count it, and follow the other on demand. */
#include "support.h"

static const struct {
    const char *method;
    double step, tolerance;
} ways[] = {{"event-driven", 1e-2, 1e-12}, {"lagrange", 1e-3, 1},     {"capturing", 1e-3, 1e-6},
            {"capturing", 1e-3, 1e-7},     {"capturing", 1e-3, 1e-8}, {"capturing", 1e-3, 1e-9},
            {"capturing", 1e-2, 1e-8},     {"capturing", 1e-2, 1e-7}, {"implicit", 1e-4, 1},
            {"midpoint", 1e-4, 1}};
enum { WAYS = COUNT(ways) };

static stance_case landing(int way, bool most)
{
    static const double robot[] = {0.37567569354728214, 0.40591425323918007, 0.5740877160649077,
                                   4.9969412275695895, 5.7222096999874665};
    static const double start[] = {0, 0.9184329561095907, -0.12673920254624088, 0.42556634274981153,
                                   -0.04771403847996547};
    static const double speed[] = {-0.5277421863312584, 0.39653245033422646, -1.8733410431118434,
                                   -0.8917523223021524, -1.1342815034393992};
    stance_case c = plain_case();
    memcpy(c.robot, robot, sizeof robot);
    memcpy(c.position, start, sizeof start);
    memcpy(c.velocity, speed, sizeof speed);
    hold_legs(&c, 20.046616241044042, 2.995354445344256);
    c.friction = 1;
    c.step = ways[way].step;
    c.tolerance = ways[way].tolerance;
    c.steps = (int64_t)lround(0.3 / c.step);
    c.robot[STANCE_ROBOT_FALL_HEIGHT] = 0;
    c.most_energy = most;
    return c;
}

TEST(one_rule_for_all)
{
    double end[2] = {0, 0};
    for (int most = 0; most < 2; most++)
        for (int k = 0; k < WAYS; k++) {
            const stance_case c = landing(k, most);
            stance_result r;
            run_cases(kernel_of(ways[k].method, NULL), &c, &r, 1);
            print_message("# %s, %s at %g s: theta %.6f, q1 %.6f, ambiguous %lld\n",
                          most ? "most" : "least", ways[k].method, c.step, r.position[2],
                          r.position[3], (long long)r.ambiguous_steps);
            assert_int_equal(r.status, STANCE_DONE);
            assert_true(r.ambiguous_steps > 0);
            if (k == 0)
                end[most] = r.position[3];
            assert_true(fabs(r.position[3] - end[most]) < (ways[k].step < 1e-3 ? 0.02 : 1e-5));
        }
    assert_true(fabs(end[1] - end[0]) > 0.05);
}
