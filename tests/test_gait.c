/* test_gait - gaits that another program knows: `stance gait`'s return map on shipped walkers.
 *
 * The numbers are an event-driven program's of its own (order 8, footfalls located to 1e-15 m, one
 * foot pinned), those of the compass tests/compass_oracle.py's, too. That the largest multiplier of
 * exact zero dynamics is delta^2, a number from posture and slopes at the footfall alone, is
 * Westervelt, Grizzle and Koditschek's (IEEE Trans. Autom. Control 48 (2003) 42): 0.649552458326 of
 * the gait `exactly`.
 */
#include <jansson.h>

#include "linear.h"

#include "analysis/gait/gait.h"
#include "runner/plan/instruction_set.h"
#include "runner/plan/plan.h"

struct walker {
    struct scenario scenario;
    struct plan plan;
    struct return_map map;
    struct gait gait;
    stance_message message;
    bool found;
};

/* Freed by leave(). */
static struct walker *walk(const char *file, int steps, int settle, const char *const *set,
                           size_t sets)
{
    struct walker *const w = calloc(1, sizeof *w);
    const struct parallel alone = parallel_alone();
    struct plan_error error;
    OWN stance_case *c = malloc(sizeof *c);
    struct return_point from = {.time = 0};
    int method;
    assert_true(w && c);
    assert_true(scenario_read(&w->scenario, file, NULL, set, sets, stderr));
    assert_true(plan_make(&w->plan, &w->scenario, false, 0, false, &error));
    assert_true(plan_compute_designs(&w->plan, &alone, &error));
    assert_true(plan_resolve(&w->plan, 0, c, &method));
    const stance_kernel *const kernel =
        instruction_set_kernel(w->scenario.scene, stance_methods()[method]);
    w->message.text[0] = '\0';
    w->found = return_map_begin(&w->map, c, kernel, steps, settle, &from, &w->message) &&
               gait_find(&w->map, &from, &w->gait, &w->message);
    return w;
}
static void leave(struct walker *w)
{
    plan_free(&w->plan);
    scenario_free(&w->scenario);
    free(w);
}

static void walker_gone(struct walker *const *w)
{
    leave(*w);
}
#define WALKER FREED(walker_gone) struct walker

struct truth {
    const char *file;
    const char *const *set;
    size_t sets;
    double period, length, re, im, second, tolerance; /* re, im: of the largest multiplier */
};
#define COMMON "method.step=0.005", "controller.sample_time=0", "sweep={}"
#define EXACT "method.name=event-driven", "sweep={}"
#define EVENTS "method.name=event-driven", COMMON
static const char *const compass[] = {EXACT};
static const char *const compass_capturing[] = {"method.tolerance=1e-10", "sweep={}"};
static const char *const events[] = {EVENTS};
static const char *const exactly[] = {
    EVENTS, "controller.phase={of: {theta: -1, q1: -1}, from: -0.2889, to: 0.2889}",
    "controller.outputs.y1={of: {theta: 1}, along: [-0.2229, -0.21072, -0.4708, -0.0725, -0.3009, "
    "-0.26866, -0.2229], proportional: 64, derivative: 16}",
    "controller.outputs.y2={of: {theta: 2, q1: 1, q2: 1}, along: [0, -0.17697, -0.2267, 0.325, "
    "0.2529, 0.14436, 0], proportional: 64, derivative: 16}",
    "initial.state={theta: -0.222900162, q1: 0.511800238, q2: -0.065999915, vtheta: 0.173933826, "
    "vq1: -1.549628606, vq2: -1.326306837}"};
static const char *const capturing[] = {"method.tolerance=1e-10", COMMON};
static const char *const sampled[] = {"method.tolerance=1e-10", "method.step=0.005",
                                      "controller.sample_time=0.01", "sweep={}"};
#define SET(list) list, sizeof(list) / sizeof *(list)
static const struct truth truths[] = {
    {"scenarios/mechanisms/compass_gait.yaml", SET(compass), 0.744928149724, NAN, 0.125283118,
     0.508967315, 0.176813641, 2e-9},
    {"scenarios/mechanisms/compass_gait.yaml", SET(compass_capturing), 0.744928149724, NAN,
     0.125283118, 0.508967315, 0.176813641, 1e-6},
    {"scenarios/gaits/walks.yaml", SET(events), 0.668882682, 0.278096898, 0.318361883, 0,
     -0.0906436, 5e-8},
    {"scenarios/gaits/walks.yaml", SET(capturing), 0.668882682, 0.278096898, 0.318361883, 0,
     -0.0906436, 2e-6},
    {"scenarios/gaits/walks.yaml", SET(exactly), 0.681557012, 0.304840921, 0.6495514, 0, 0.0091,
     1e-5},
    {"scenarios/gaits/walks_without_model.yaml", SET(events), 0.531542655, 0.313803018, 0.1910338,
     0.4428668, 0.0528738, 6e-8},
    {"scenarios/gaits/walks.yaml", SET(sampled), 0.662081, NAN, 0.340, 0, NAN, 1e-3},
    {"scenarios/gaits/rabbit_walks.yaml", SET(events), 0.619220333, 0.431579080, 0.637257321, 0,
     NAN, 2e-9},
};

TEST(gaits_are_those_of_another_program)
{
    for (size_t i = 0; i < COUNT(truths); i++) {
        const struct truth *const t = &truths[i];
        WALKER *w = walk(t->file, 1, 40, t->set, t->sets);
        if (!w->found)
            fail_msg("%s: %s", t->file, w->message.text);
        const struct gait *const g = &w->gait;
        print_message(
            "# %s, %s: period %.9f s, largest multiplier %.9f +- %.9fi, error %.1e, residual "
            "%.1e\n",
            t->file, w->map.kernel->method->name, g->at.time, g->re[0], g->im[0], g->error[0],
            g->residual);
        assert_true(g->stable);
        assert_near(g->at.time, t->period, fmax(1e-3 * t->tolerance, 2e-9), t->file);
        if (!isnan(t->length))
            assert_near(g->at.length, t->length, 2e-9, t->file);
        assert_near(g->re[0], t->re, t->tolerance, t->file);
        assert_near(fabs(g->im[0]), t->im, t->tolerance, t->file);
        const int next = t->im > 0 ? 2 : 1;
        if (!isnan(t->second))
            assert_near(g->re[next], t->second, fmax(t->tolerance, 5e-7), t->file);
    }
}

/* Following the clock in place of the stance leg's angle is all that differs. */
TEST(by_the_clock_it_does_not_hold)
{
    WALKER *w = walk("scenarios/gaits/walks_by_the_clock.yaml", 1, 1, SET(events));
    assert_true(w->found && !w->gait.stable);
    assert_near(w->gait.re[0], -5.1, 0.05, "multiplier");
}

TEST(what_has_no_gait_says_why)
{
    static const struct {
        const char *file, *set[4], *says;
    } wrong[] = {
        {"scenarios/gaits/walks.yaml",
         {"sweep={}", "method.name=midpoint"},
         "midpoint puts footfalls"},
        {"scenarios/gaits/walks.yaml", {"sweep={}", "controller.noise=0.1"}, "noise"},
        {"scenarios/gaits/walks.yaml", {"sweep={}", "controller.delay=1"}, "controller.delay"},
        {"scenarios/gaits/walks.yaml",
         {"sweep={}", "initial.state.vq1=0"},
         "it falls after 0 footfalls"},
        {"scenarios/gaits/walks_by_the_clock.yaml",
         {"sweep={}"},
         "it falls after 4 footfalls, by hip"},
        {"scenarios/mechanisms/hopper.yaml", {"sweep={}", "initial.state.z=1"}, "no two legs"},
        {"scenarios/mechanisms/compass_gait.yaml",
         {"sweep={}", "robot.bodies.leg2.mass=5.5"},
         "differ: a gait repeats"},
    };
    for (size_t i = 0; i < COUNT(wrong); i++) {
        size_t sets = 0;
        while (sets < 4 && wrong[i].set[sets])
            sets++;
        WALKER *w = walk(wrong[i].file, 1, 40, wrong[i].set, sets);
        assert_false(w->found);
        if (!strstr(w->message.text, wrong[i].says))
            fail_msg("'%s' does not say '%s'", w->message.text, wrong[i].says);
    }
}

/* Costs, frictions and clearances of an independent program: of the paper's biped, P1 and P3, and
 * RABBIT, to the digits that it has. */
TEST(gaits_have_margins)
{
    static const struct {
        const char *file;
        double cost, impact_friction, lift, clearance, under, least_force;
    } truth[] = {
        {"scenarios/gaits/walks.yaml", 0.0615, 0.565, 0.28, 0.0107, 0.0004, NAN},
        {"scenarios/gaits/walks_without_model.yaml", 0.257, 0.354, 0.39, 0.031, 0.0073, NAN},
        {"scenarios/gaits/rabbit_walks.yaml", 0.176, 0.550, 0.50, 0.045, 0, 207},
    };
    static const char *const fine[] = {"method.tolerance=1e-10", "method.step=0.0002",
                                       "controller.sample_time=0", "sweep={}"};
    for (size_t i = 0; i < COUNT(truth); i++) {
        WALKER *w = walk(truth[i].file, 1, 40, SET(fine));
        struct gait_margins m;
        assert_true(w->found);
        assert_true(gait_margins_find(&w->map, &w->gait, &m, &w->message));
        assert_true(fabs(m.cost - truth[i].cost) < 6e-4);
        assert_true(fabs(m.impact_friction - truth[i].impact_friction) < 6e-4);
        assert_true(fabs(m.lift - truth[i].lift) < 6e-3);
        assert_true(fabs(m.clearance - truth[i].clearance) < 6e-4);
        assert_true(fabs(m.under - truth[i].under) < 6e-5);
        if (isfinite(truth[i].least_force))
            assert_true(fabs(m.least_normal_force - truth[i].least_force) < 2);
    }
}

/* Of a slope that is one of two at random in each step, by the return map itself: the standard
 * deviations over 4000 steps are as the norm says, to what so many steps tell. */
TEST(slopes_at_random_vary_a_gait_as_the_norm_says)
{
    static const char *const slope[2][4] = {
        {"method.tolerance=1e-10", "method.step=0.005", "sweep={}", "ground.slope=-0.0005"},
        {"method.tolerance=1e-10", "method.step=0.005", "sweep={}", "ground.slope=0.0005"}};
    const char *const level[] = {"method.tolerance=1e-10", "method.step=0.005", "sweep={}"};
    enum { STEPS = 4000 };
    struct walker *const w[] = {walk("scenarios/gaits/walks.yaml", 1, 40, slope[0], 4),
                                walk("scenarios/gaits/walks.yaml", 1, 40, slope[1], 4),
                                walk("scenarios/gaits/walks.yaml", 1, 40, SET(level))};
    const struct along along = {.path = "ground.slope", .from = -0.0005, .to = 0.0005};
    struct gait_sensitivity is;
    double sum[2] = {0}, square[2] = {0};
    uint64_t random = 12345;
    assert_true(w[2]->found);
    assert_true(gait_sensitivity_find(&w[2]->scenario, &w[2]->map, &w[2]->gait, &along, &is,
                                      &w[2]->message));
    struct return_point p = w[2]->gait.from;
    for (int k = 0; k < STEPS; k++) {
        random = random * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
        p.behind = 0;
        assert_true(return_map_take(&w[random >> 63]->map, 1, &p, &p, &w[2]->message));
        const double g[2] = {p.time, p.length};
        for (int m = 0; m < 2; m++)
            sum[m] += g[m], square[m] += g[m] * g[m];
    }
    const double two = sqrt(3); /* of one of two values, by that of evenly between */
    for (int m = 0; m < 2; m++) {
        const double mean = sum[m] / STEPS, variance = square[m] / STEPS - mean * mean;
        const double says = two * (m == 0 ? is.time : is.length);
        if (!(fabs(sqrt(variance) / says - 1) < 0.04))
            fail_msg("measure %d varies by %g, not %g", m, sqrt(variance), says);
    }
    for (int k = 0; k < 3; k++)
        leave(w[k]);
}

#define STEP(name, n) #name ": {footfall: " #n ", from: 0.1, height: 0}"
#define GROUND(more) "ground.plates={" STEP(a, 1) more "}"
#define RANDOM                                                                                     \
    GROUND(", " STEP(b, 2) ", " STEP(c, 3) ", " STEP(d, 4) ", " STEP(e, 5) ", " STEP(f, 6))
static const struct along step_of_ground = {
    .path = "ground.plates.a.height", .from = -2e-4, .to = 2e-4};

/* Of w's gait, over steps of the ground so high, cases[2]: one step less than `steps`, and all. */
static void step_over(const struct walker *w, const double *height, int steps, stance_case *cases)
{
    cases[0] = w->map.base;
    assert_true(return_map_state(&w->map, &w->gait.from, cases[0].position, cases[0].velocity));
    for (int n = 0; n < w->map.base.body.plates; n++)
        cases[0].body.plate[n].height = height[n];
    cases[1] = cases[0];
    cases[0].footfalls = steps - 1;
    cases[1].footfalls = steps;
}

/* Time and length of the last step, by which the two cases differ, less the gait's own. */
static void last_step(const struct walker *w, int steps, const stance_result *r, double g[2])
{
    double place[2][2], speed[2];
    for (int n = 0; n < 2; n++) {
        assert_true(r[n].status == STANCE_DONE && r[n].footfalls == steps - 1 + n);
        return_map_foot(&w->map, r[n].position, r[n].velocity, (steps - 1 + n) % 2, place[n],
                        speed);
    }
    g[0] = r[1].end_time - r[0].end_time - w->gait.at.time;
    g[1] = place[1][0] - place[0][0] - w->gait.at.length;
}

/* Of steps of the ground at random, each up or down from the one before by one of two heights, laid
 * as the robot comes to them: the last ones vary over cases as the norm says, to what so many tell.
 */
TEST(steps_of_the_ground_vary_a_gait_as_the_norm_says)
{
    enum { LAID = 6, CASES = 600 };
    static const char *const set[] = {"method.step=0.005", "sweep={}", RANDOM};
    WALKER *w = walk("scenarios/gaits/walk_pushes.yaml", 1, 40, SET(set));
    OWN stance_case *c = calloc(2 * CASES, sizeof *c);
    OWN stance_result *r = calloc(2 * CASES, sizeof *r);
    struct gait_sensitivity is;
    double sum[2] = {0}, square[2] = {0};
    uint64_t random = 12345;
    assert_true(c && r);
    assert_true(w->found);
    assert_true(
        gait_sensitivity_find(&w->scenario, &w->map, &w->gait, &step_of_ground, &is, &w->message));
    for (size_t k = 0; k < CASES; k++) {
        double height[LAID], before = 0;
        for (int n = 0; n < LAID; n++) {
            random = random * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
            height[n] = before += random >> 63 ? step_of_ground.to : step_of_ground.from;
        }
        step_over(w, height, LAID, &c[2 * k]);
    }
    w->map.kernel->run(c, r, 2 * CASES);
    for (size_t k = 0; k < CASES; k++) {
        double g[2];
        last_step(w, LAID, &r[2 * k], g);
        for (int m = 0; m < 2; m++)
            sum[m] += g[m], square[m] += g[m] * g[m];
    }
    for (int m = 0; m < 2; m++) {
        const double mean = sum[m] / CASES, variance = square[m] / CASES - mean * mean;
        const double says = sqrt(3) * (m == 0 ? is.time : is.length);
        print_message("# measure %d: %g, the norm %g\n", m, sqrt(variance), says);
        assert_true(fabs(sqrt(variance) / says - 1) < 0.09);
    }
}

/* A step of the ground under RABBIT, whose feet touch wherever they are: what comes of one, in each
 * step from there on, squared and added up is the norm, too. */
TEST(what_a_step_of_the_ground_does_adds_up_to_the_norm)
{
    enum { STEPS = 12 };
    static const char *const set[] = {"method.tolerance=1e-10", "method.step=0.005", "sweep={}",
                                      "controller.sample_time=0", GROUND("")};
    WALKER *w = walk("scenarios/gaits/rabbit_walks.yaml", 1, 40, SET(set));
    OWN stance_case *c = calloc(4 * STEPS, sizeof *c);
    OWN stance_result *r = calloc(4 * STEPS, sizeof *r);
    struct gait_sensitivity is;
    double square[2] = {0};
    assert_true(c && r);
    assert_true(w->found);
    assert_true(
        gait_sensitivity_find(&w->scenario, &w->map, &w->gait, &step_of_ground, &is, &w->message));
    for (size_t k = 0; k < 2 * STEPS; k++)
        step_over(w, k % 2 ? &step_of_ground.to : &step_of_ground.from, (int)k / 2 + 1, &c[2 * k]);
    for (size_t k = 0; k < 2; k++) /* what has not stepped is where it began: not simulated */
        c[2 * k].footfalls = 1;
    w->map.kernel->run(c, r, 4 * STEPS);
    for (size_t k = 0; k < 2; k++) {
        memcpy(r[2 * k].position, c[2 * k].position, sizeof r[2 * k].position);
        memcpy(r[2 * k].velocity, c[2 * k].velocity, sizeof r[2 * k].velocity);
        r[2 * k].end_time = r[2 * k].footfalls = 0;
    }
    for (size_t k = 0; k < STEPS; k++) {
        double g[2][2];
        for (size_t side = 0; side < 2; side++)
            last_step(w, (int)k + 1, &r[4 * k + 2 * side], g[side]);
        for (int m = 0; m < 2; m++)
            square[m] += (g[1][m] - g[0][m]) * (g[1][m] - g[0][m]);
    }
    assert_near(sqrt(square[0] / 12) / is.time, 1, 2e-3, "time");
    assert_near(sqrt(square[1] / 12) / is.length, 1, 2e-3, "length");
}
