/* sweep.sample: where factors lead, what a case of a sample is, and by what its noise is keyed. */
#include "reading.h"

#include "runner/plan/plan.h"
#include "runner/ranks/parallel.h"
#include "runner/scenario/doe.h"

static const char head[] =
    "stance: 1\nscene: biped\ninitial: {equilibrium: {theta: -0.41, q2: 0.82}}\n"
    "controller: {kind: state-feedback, poles: [-3, -3.3, -3.6, -3.9, -4.2, -4.6],\n"
    "             sample_time: 0.01, noise: 0.1}\n"
    "stop: {time: 1}\nseed: 9\n";

static void read_sweep(struct scenario *s, const char *sweep)
{
    char text[4096];
    snprintf(text, sizeof text, "%s%s", head, sweep);
    read_good(s, text, NULL, 0);
}

static const char every_kind[] =
    "sweep:\n"
    "  grid: [{path: initial.offset.theta, values: [-0.02, 0, 0.02]}]\n"
    "  sample:\n"
    "    method: sobol\n"
    "    count: 256\n"
    "    vary:\n"
    "      - {path: ground.friction, from: 0.1, to: 1}\n"
    "      - {path: ground.restitution, from: 0.01, to: 1, spacing: log}\n"
    "      - {path: controller.delay, from: 0, to: 1}\n"
    "      - {path: method.name, values: [midpoint, implicit, capturing, midpoint]}\n"
    "      - {path: controller.torque_limit, values: [10, none]}\n"
    "      - {paths: [robot.hip_mass, robot.trunk_mass, initial.support_foot], from: [4, 3, 1], "
    "to: [6, 2, 2]}\n";

/* The same points by way of the unit cube. */
TEST(test_factors)
{
    static const char *const names[] = {"midpoint", "implicit", "capturing", "midpoint"};
    SCENARIO s = {0};
    read_sweep(&s, every_kind);
    DOE design = s.sample.design;
    const struct scenario_axis *axis = &s.axis[1];
    assert_true(s.sample.given && s.axes == 2 && axis->sample && !axis->words && axis->design);
    assert_string_equal(axis->name, "sample");
    assert_true(design.method == DOE_SOBOL && design.count == 256 && design.factors == 6);
    assert_true(design.seed == 9 && axis->count == 256 && axis->paths == 8 && s.cases == 768);
    assert_true(doe_begin(&design));
    for (uint64_t i = 0; i < s.cases; i++) {
        struct scenario_values v;
        uint64_t grid, sample;
        double u[6];
        scenario_case_keys(&s, i, &grid, &sample);
        assert_true(grid == i / 256 && sample == i % 256);
        scenario_case_values(&s, i, &v);
        doe_unit(&design, sample, u);
        assert_true(v.offset[2] == -0.02 + 0.02 * (double)grid || grid == 2);
        assert_float_equal(v.friction, 0.1 + 0.9 * u[0], 1e-15);
        assert_float_equal(log10(v.restitution), 2 * u[1] - 2, 1e-14);
        assert_int_equal(v.delay, u[2] < 0.5 ? 0 : 1);
        assert_string_equal(stance_methods()[v.method]->name, names[(int)(4 * u[3])]);
        assert_true(v.torque_limit == (u[4] < 0.5 ? 10 : INFINITY));
        assert_float_equal(v.robot[4], 4 + 2 * u[5], 1e-14);
        assert_float_equal(v.robot[3], 3 - u[5], 1e-14);
        assert_int_equal(v.support_foot, u[5] < 0.5 ? 1 : 2);
    }
    char word[32];
    scenario_axis_text(axis, 0, 3, word, sizeof word);
    struct scenario_values first;
    scenario_case_values(&s, 0, &first);
    assert_string_equal(word, stance_methods()[first.method]->name);
}

/* Bounds are reached by the designs that have points there, and never left. */
TEST(test_bounds)
{
    SCENARIO s = {0};
    bool low = false, high = false;
    read_sweep(&s, "sweep: {sample: {method: morris, count: 50, levels: 6, vary: [\n"
                   "  {path: ground.friction, from: 0.1, to: 0.7, spacing: log},\n"
                   "  {path: controller.delay, from: 0, to: 1}, {path: ground.restitution, from: "
                   "0, to: 1}]}}");
    assert_true(s.cases == 50 * 4 && s.sample.design.levels == 6);
    for (size_t i = 0; i < s.cases; i++) {
        const double value = scenario_axis_value(&s.axis[0], i, 0);
        assert_true(value >= 0.1 && value <= 0.7);
        low = low || value == 0.1;
        high = high || value == 0.7;
    }
    assert_true(low && high);
}

/* Whole numbers between bounds are equally likely, both bounds included: as many of each as there
 * can be among 2^m Sobol' points and four numbers. */
TEST(test_whole_numbers)
{
    SCENARIO s = {0};
    int seen[2] = {0};
    read_sweep(&s, "sweep: {sample: {method: sobol, count: 64, vary: [\n"
                   "  {path: initial.support_foot, from: 1, to: 2}]}}");
    for (size_t i = 0; i < 64; i++)
        seen[(int)scenario_axis_value(&s.axis[0], i, 0) - 1]++;
    assert_true(seen[0] == 32 && seen[1] == 32);
}

/* Cases of a larger design are those of the smaller one, noise included; each point that moves the
 * design is a design of its own. */
TEST(test_keys)
{
    static const char sweep[] =
        "sweep:\n"
        "  grid: [{path: initial.offset.vtheta, values: [0, 0.1]}]\n"
        "  sample: {method: random, count: %d, vary: [{path: ground.friction, from: 0.1, to: 1},\n"
        "    {path: controller.model.hip_mass, from: 5, to: 6}]}\n";
    static struct scenario s[2];
    struct plan plan[2];
    struct plan_error error;
    const struct parallel alone = {.size = 1};
    char text[512];

    for (int k = 0; k < 2; k++) {
        snprintf(text, sizeof text, sweep, k == 0 ? 5 : 8);
        read_sweep(&s[k], text);
        assert_true(plan_make(&plan[k], &s[k], false, 0, false, &error));
        assert_int_equal(plan[k].designs, k == 0 ? 5 : 8);
        assert_true(plan_compute_designs(&plan[k], &alone, &error));
    }
    for (uint64_t grid = 0; grid < 2; grid++) {
        for (uint64_t point = 0; point < 5; point++) {
            stance_case a, b;
            int method;
            assert_true(plan_resolve(&plan[0], grid * 5 + point, &a, &method));
            assert_true(plan_resolve(&plan[1], grid * 8 + point, &b, &method));
            assert_true(a.grid_index == grid && a.sample_index == point && a.seed == 9);
            assert_memory_equal(&a, &b, sizeof a);
        }
    }
    for (int k = 0; k < 2; k++) {
        plan_free(&plan[k]);
        scenario_free(&s[k]);
    }
}

/* More designs than are kept in memory: an error, not an attempt. */
TEST(test_designs_have_a_limit)
{
    SCENARIO s = {0};
    struct plan plan;
    struct plan_error error;
    read_sweep(
        &s,
        "sweep: {grid: [{path: robot.trunk_mass, from: 1, to: 2, count: 100000}],\n"
        "  sample: {method: random, count: 1000, vary: [{path: robot.hip_mass, from: 5, to: 6}]}}");
    assert_false(plan_make(&plan, &s, false, 0, false, &error));
    assert_non_null(strstr(error.message.text, "controller designs"));
    assert_true(error.line == 9 && error.column > 0);
}
