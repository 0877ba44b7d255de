/* From the numbers of a scenario to a case: start, law, doe, and what is refused. */
#include "support.h"

#include "runner/plan/resolve.h"

static int law_index(const char *name)
{
    int i = 0;
    while (stance_laws()[i] != stance_law_find(name))
        i++;
    return i;
}
static double *law_value(struct scenario_values *v, const char *law, const char *parameter)
{
    return (double *)scenario_law_value(v, law, parameter);
}

static const double PAPER_POLES[6] = {-3, -3.3, -3.6, -3.9, -4.2, -4.6};

/* What the scenario of section 3.2 says, in numbers. */
static struct scenario_values balance_values(void)
{
    const stance_scene *scene = stance_scene_find("biped");
    struct scenario_values v = {
        .friction = 0.8,
        .contacts = 1,
        .equilibrium = {true, {-0.41, NAN, 0.82}, 0},
        .support_foot = 1,
        .design = DESIGN_PLACE,
        .design_point = {false, {NAN, NAN, NAN}, 0},
        .offset_scale = 1,
        .sample_time = 0.001,
        .torque_limit = 10,
        .torque_limits = {INFINITY, INFINITY},
        .torque_rate = INFINITY,
        .step = 0.001,
        .stop_time = 8,
        .settle = 1,
        .settle_angle = 0.05,
        .settle_rate = 0.5,
        .settle_hold = 0.5,
        .settle_place = 0.5,
        .tolerance = NAN,
    };
    v.law = law_index("state-feedback");
    for (int i = 0; i < 2; i++)
        law_value(&v, "hold", "target")[i] = NAN;
    stance_robot_fallback(scene, v.robot);
    for (int i = 0; i < STANCE_MAX_ROBOT; i++)
        v.model[i] = NAN;
    memcpy(v.pole_re, PAPER_POLES, sizeof PAPER_POLES);
    return v;
}

/* Case 17 of a scenario whose seed is 42. */
static bool case_of(const stance_scene *scene, const struct scenario_values *v,
                    const struct resolved_design *design, stance_case *c, stance_message *message)
{
    static struct scenario s;
    s.scene = scene;
    s.seed = 42;
    return resolve_case(&s, v, design, 17, c, message);
}

static stance_case resolved(const struct scenario_values *v)
{
    const stance_scene *scene = stance_scene_find("biped");
    struct resolved_design design;
    stance_message message;
    stance_case c;
    if (!resolve_design(scene, v, &design, &message) || !case_of(scene, v, &design, &c, &message))
        fail_msg("%s", message.text);
    return c;
}

static void assert_refused(const struct scenario_values *v, const char *text)
{
    const stance_scene *scene = stance_scene_find("biped");
    struct resolved_design design;
    stance_message message;
    stance_case c;
    if (resolve_design(scene, v, &design, &message) && case_of(scene, v, &design, &c, &message))
        fail_msg("accepted; expected '%s'", text);
    if (strcmp(message.text, text) != 0)
        fail_msg("message '%s' instead of '%s'", message.text, text);
}

TEST(balance)
{
    struct scenario_values v = balance_values();
    v.offset[2] = -0.02;
    v.offset[5 + 2] = 0.15;
    v.offset_scale = 2;
    const stance_case c = resolved(&v), wanted = balance_case(-0.04, 0.3);
    assert_memory_equal(c.position, wanted.position, sizeof(double[5]));
    assert_memory_equal(c.velocity, wanted.velocity, sizeof(double[5]));
    assert_memory_equal(c.near.gain, wanted.near.gain, sizeof c.near.gain);
    assert_memory_equal(c.near.feedforward, wanted.near.feedforward, sizeof c.near.feedforward);
    assert_memory_equal(c.near.target, wanted.near.target, sizeof c.near.target);
    assert_true(c.settle && c.has_target && c.supports == 1 && !c.trajectory);
    assert_true(c.seed == 42 && c.grid_index == 17 && c.sample_index == 0);
    assert_true(c.sample_every == 1 && c.step == 0.001 && c.steps == 8000);
    assert_true(c.torque_limit == 10 && c.contacts == 1 &&
                c.robot[STANCE_ROBOT_FALL_HEIGHT] == 0.2);
}

/* Offsets of the translation come after the foot has been put down. */
TEST(offsets_of_translation)
{
    struct scenario_values v = balance_values();
    const stance_case before = resolved(&v);
    v.offset[0] = 0.5;
    v.offset[1] = 0.25;
    v.offset[5] = -1;
    v.offset[6] = 2;
    const stance_case after = resolved(&v);
    assert_true(after.position[0] == before.position[0] + 0.5);
    assert_true(after.position[1] == before.position[1] + 0.25);
    assert_true(after.velocity[0] == -1 && after.velocity[1] == 2);
    v.offset_scale = 0.5;
    const stance_case halved = resolved(&v);
    assert_true(halved.position[0] == before.position[0] + 0.25);
    assert_true(halved.velocity[0] == -0.5 && halved.velocity[1] == 1);
    v.offset_scale = 1;
    assert_memory_equal(after.position + 2, before.position + 2, 3 * sizeof(double));
    v.offset[1] = -1e-10; /* rounding, as far as a start goes */
    resolved(&v);
    v.offset[1] = -0.004;
    assert_refused(&v, "foot1 would start 0.004 m inside the ground");
    v.contacts = 2; /* only the other foot may touch, and it hangs */
    resolved(&v);
}

TEST(other_foot)
{
    struct scenario_values v = balance_values();
    v.support_foot = 2;
    v.contacts = 2;
    v.equilibrium.posture[1] = 0.82;
    v.equilibrium.posture[2] = NAN;
    const stance_case c = resolved(&v);
    double gap[2];
    biped()->gaps(biped(), c.robot, c.position, gap);
    assert_int_equal(c.supports, 2);
    assert_true(gap[1] >= 0 && gap[1] < 1e-15 && gap[0] > 0.03);
    v.support_foot = 0; /* foot 1 where nothing is said: no equilibrium with this q1 */
    assert_refused(&v,
                   "there is no such posture: theta cannot be balanced: 4.09 N m are left on it");
}

/* Steps divide the sample interval and are never longer than asked for. */
TEST(sampling)
{
    const struct {
        double sample_time, step, stop;
        int64_t every, steps;
    } rows[] = {
        {0, 0.001, 8, 0, 8000},       {0.001, 0.001, 8, 1, 8000}, {0.003, 0.001, 0.9, 3, 900},
        {0.0035, 0.001, 0.7, 4, 800}, {0.1, 0.1 / 3, 1, 3, 30},   {0.0005, 0.001, 1, 1, 2000},
        {0.3, 0.1, 0.3, 3, 3},        {0, 0.002, 0.0029, 0, 1},   {0.7, 0.0007, 1.4, 1000, 2000},
        {0, 0.001, 0.0016, 0, 2},
    };
    for (size_t i = 0; i < COUNT(rows); i++) {
        struct scenario_values v = balance_values();
        v.sample_time = rows[i].sample_time;
        v.step = rows[i].step;
        v.stop_time = rows[i].stop;
        const stance_case c = resolved(&v);
        assert_int_equal(c.sample_every, rows[i].every);
        assert_int_equal(c.steps, rows[i].steps);
        assert_true(c.step <= v.step * (1 + 1e-9));
        if (v.sample_time > 0) {
            assert_true(fabs((double)c.sample_every * c.step - v.sample_time) <
                        1e-15 * v.sample_time + 1e-18);
        }
    }
}

TEST(no_law)
{
    struct scenario_values v = balance_values();
    v.law = law_index("none");
    const stance_case c = resolved(&v);
    for (int i = 0; i < 2; i++) {
        assert_true(c.near.feedforward[i] == 0);
        for (int j = 0; j < 6; j++)
            assert_true(c.near.gain[i][j] == 0);
    }
    assert_true(!c.has_target && c.supports == 0 && c.settle);
}

TEST(hold_law)
{
    struct scenario_values v = balance_values();
    const double dropped[10] = {0, 1.5, -0.5, 0.9, -1, 2};
    v.law = law_index("hold");
    *law_value(&v, "hold", "kp") = 500;
    *law_value(&v, "hold", "kd") = 50;
    v.state_given = 1;
    v.support_foot = 0;
    v.equilibrium.given = false;
    memcpy(v.state, dropped, sizeof dropped);
    stance_case c = resolved(&v);
    assert_memory_equal(c.position, dropped, sizeof(double[5]));
    assert_memory_equal(c.velocity, dropped + 5, sizeof(double[5]));
    const double wanted[12] = {0, 500, 0, 0, 50, 0, 0, 0, 500, 0, 0, 50};
    double gain[12];
    get_gain(&c, gain);
    assert_memory_equal(gain, wanted, sizeof gain);
    assert_true(c.near.target[1] == 0.9 && c.near.target[2] == -1);
    assert_true(c.near.feedforward[0] == 0 && !c.has_target && c.supports == 0);
    law_value(&v, "hold", "target")[1] = -0.7; /* of the second joint */
    c = resolved(&v);
    assert_true(c.near.target[1] == 0.9 && c.near.target[2] == -0.7);

    struct scenario_values tilted = balance_values();
    tilted.law = law_index("hold");
    tilted.offset[3] = 0.1;
    const stance_case start = resolved(&tilted);
    assert_true(start.near.target[1] == start.position[3]); /* the offset is held, not undone */
}

/* Target, torque and gains come from the model, the start from the robot. */
TEST(wrong_model)
{
    struct scenario_values v = balance_values();
    const stance_case honest = resolved(&v);
    v.model[3] = 2.0; /* trunk_mass */
    const stance_case deceived = resolved(&v);
    assert_memory_equal(deceived.position, honest.position, sizeof honest.position);
    const double sine = (2.0 * sin(0.41) + 1.8 * sin(0.41)) / (2.0 + 1.8 + 5.4);
    assert_true(fabs(deceived.near.target[1] - (asin(sine) + 0.41)) < 1e-14);
    assert_true(fabs(deceived.near.feedforward[1] - honest.near.feedforward[1]) < 1e-14);
    assert_true(fabs(deceived.near.gain[0][0] - honest.near.gain[0][0]) > 1);
    v.robot[3] = 2.0;
    const stance_case consistent = resolved(&v);
    assert_memory_equal(deceived.near.gain, consistent.near.gain, sizeof consistent.near.gain);
    assert_memory_equal(deceived.near.target, consistent.near.target,
                        sizeof consistent.near.target);
}

TEST(own_equilibrium_and_gains)
{
    struct scenario_values v = balance_values();
    v.design_point = (struct scenario_equilibrium){true, {0, 0, NAN}, 0};
    v.design = DESIGN_GAINS;
    for (int i = 0; i < 12; i++)
        v.gains[i] = i + 0.5;
    const stance_case c = resolved(&v);
    assert_true(c.near.target[0] == 0 && c.near.target[1] == 0 && c.near.target[2] == 0);
    assert_true(c.near.gain[0][0] == 0.5 && c.near.gain[0][5] == 5.5 && c.near.gain[1][0] == 6.5);
    assert_true(c.position[2] == -0.41);
    v.gains[11] = NAN;
    assert_refused(&v, "12 finite gains are needed");
}

TEST(refusals)
{
    struct scenario_values v = balance_values();
    v.equilibrium.given = false;
    assert_refused(&v, "an initial state is needed: initial.equilibrium or initial.state");
    v.state_given = 1;
    v.support_foot = 0;
    v.state[1] = 2;
    assert_refused(&v, "the controller needs an equilibrium to work at: give "
                       "controller.equilibrium or initial.equilibrium");
    v.law = law_index("none");
    v.state[1] = NAN;
    assert_refused(&v, "the initial z is not a finite number");
    v.state[1] = 2;
    v.state[9] = INFINITY;
    assert_refused(&v, "the initial vq2 is not a finite number");
    v.state[9] = 0;
    v.state[3] = 2e4;
    assert_refused(&v, "the initial position of foot1 is not defined: an angle is beyond 1e4 rad");

    v = balance_values();
    v.pole_im[2] = 1;
    assert_refused(&v,
                   "controller.poles: the pole -3.6+1i has no conjugate -3.6-1i among the poles");
    v = balance_values();
    v.sample_time = 0;
    v.noise = 0.1;
    assert_refused(&v,
                   "controller.noise needs controller.sample_time > 0: it is new at each sample");
    v.noise = 0, v.lag = 0.1;
    assert_refused(&v,
                   "controller.lag needs controller.sample_time > 0: it acts on what is sampled");
    v.lag = 0, v.torque_rate = 10;
    assert_refused(&v, "controller.torque_rate needs controller.sample_time > 0: it acts on what "
                       "is sampled");
    v.torque_rate = INFINITY, v.sample_time = 0.001, v.delay = STANCE_MAX_DELAY + 1;
    assert_refused(&v, "controller.delay: 17 is out of range (0 ... 16)");
    v.delay = 0, v.lag = -1;
    assert_refused(&v, "controller.lag: -1 is out of range (0 ... 1e+09)");
    v.lag = 0, v.torque_rate = 0;
    assert_refused(&v, "controller.torque_rate: 0 is out of range (more than 0, at most 1e+09)");
    v = balance_values();
    v.step = 0;
    assert_refused(&v, "method.step: 0 is out of range (more than 0, at most 0.1)");
    v = balance_values();
    v.stop_time = 1e8, v.step = 1e-9;
    assert_refused(&v, "stop.time has more than 1e+15 steps");
    v = balance_values();
    v.friction = NAN;
    assert_refused(&v, "ground.friction: nan is out of range (0 ... 10)");
    v.friction = 0.8, v.restitution = 1.5;
    assert_refused(&v, "ground.restitution: 1.5 is out of range (0 ... 1)");
}

/* The method's own tolerance unless one is given; what reads none is content without. */
TEST(tolerance)
{
    struct scenario_values v = balance_values();
    for (v.method = 0; stance_methods()[v.method]; v.method++) {
        const double own = stance_methods()[v.method]->tolerance;
        v.tolerance = NAN;
        assert_true(resolved(&v).tolerance == own);
        v.tolerance = 1e-5;
        assert_true(resolved(&v).tolerance == 1e-5);
        v.tolerance = 0;
        assert_refused(&v, "method.tolerance: 0 is out of range (more than 0, at most 1)");
    }
}

/* Scenes that nothing holds begin at a state. */
TEST(scenes_that_move)
{
    static const char *const names[] = {"ball", "block", "rod"};
    for (int k = 0; k < 3; k++) {
        const stance_scene *scene = stance_scene_find(names[k]);
        struct scenario_values v = balance_values();
        struct resolved_design design;
        stance_message message;
        stance_case c;
        v.law = law_index("none");
        v.tolerance = NAN;
        stance_robot_fallback(scene, v.robot);
        v.state_given = 1;
        v.support_foot = 0;
        v.equilibrium.given = false;
        v.support_foot = 0;
        v.state[1] = 2;
        v.state[scene->coordinates] = -3; /* vx */
        assert_true(resolve_design(scene, &v, &design, &message));
        assert_true(case_of(scene, &v, &design, &c, &message));
        assert_true(c.position[1] == 2 && c.velocity[0] == -3);
        assert_true(!c.has_target && c.supports == 0 && c.sample_every == 1);
        v.state[1] = -1;
        assert_false(case_of(scene, &v, &design, &c, &message));
        assert_non_null(strstr(message.text, "inside the ground"));
    }
}

/* A case that failed leaves the same bits everywhere: nothing half done. */
TEST(failed_design_is_clear)
{
    struct scenario_values v = balance_values();
    struct resolved_design design, clear;
    stance_message message;
    memset(&design, 0xff, sizeof design);
    memset(&clear, 0, sizeof clear);
    for (int i = 0; i < STANCE_MAX_COORDINATES; i++)
        clear.start[i] = clear.equilibrium[i] = NAN;
    v.pole_re[0] = -4.6;
    v.pole_re[1] = -4.6; /* three times */
    assert_false(resolve_design(stance_scene_find("biped"), &v, &design, &message));
    assert_memory_equal(&design, &clear, sizeof clear);
}
