/* test_mechanism_reader.c - scenarios that describe a mechanism: what they make, and what each
 * wrong one is told.
 */
#include "reading.h"

#include "engine/mechanism.h"
#include "runner/plan/resolve.h"

/* RABBIT, with every name on a line of its own, and a cart on a rail; what is said where a piece of
 * one is another. */
enum { RABBIT, CART, MOST = 200 };
static char base[2][BASE_SIZE];
static struct mistake {
    int base;
    char from[400], to[2048], said[1100];
} mistake[MOST];
static int mistakes;

/* As the head of the file says; # is `number`. */
static char *spell(char *out, const char *from, const char *end, int number)
{
    for (; from < end; from++)
        if (*from == '@') {
            const char *const close = strchr(from + 1, '@');
            char *item;
            const long times = strtol(from + 1, &item, 10);
            for (int k = 0; k < times; k++)
                out = spell(out, item, close, k);
            from = close;
        } else if (*from == '\\') {
            *out++ = '\n', from++;
        } else if (*from == '#') {
            out += sprintf(out, "%d", number);
        } else {
            *out++ = *from;
        }
    *out = '\0';
    return out;
}

static int read_mistakes(void **state __attribute__((unused)))
{
    static const char file[] = "tests/mechanism_mistakes.txt";
    FILE *const in = fopen(file, "r");
    char line[1024];
    for (int of = -1; in && fgets(line, sizeof line, in);) {
        struct mistake *const m = &mistake[mistakes];
        if (strncmp(line, "base ", 5) == 0) {
            of++;
        } else if (*line == '|') {
            const char *const to = strchr(line + 1, '|') + 1;
            spell(m->from, line + 1, to - 1, 0);
            spell(m->to, to, strchr(to, '|'), 0);
            m->base = of;
        } else if (*line == '=' && ++mistakes < MOST) {
            snprintf(m->said, sizeof m->said, "bad.yaml:%s", line + 2);
        }
    }
    return in && fclose(in) == 0 ? read_bases(file, base) : -1;
}
static CMFixtureFunction before_tests = read_mistakes;

/* The text with `from` replaced by `to`; freed by the caller. */
static char *edited(const char *text, const char *from, const char *to)
{
    const char *const at = strstr(text, from);
    assert_non_null(at);
    char *const result = room(strlen(text) + strlen(to) + 1);
    sprintf(result, "%.*s%s%s", (int)(at - text), text, to, at + strlen(from));
    return result;
}

/* ---- what it makes --------------------------------------------------------------------------- */

static int body_called(const stance_mechanism *m, const char *name)
{
    for (int b = 0; b < m->bodies; b++)
        if (strcmp(m->body[b].name, name) == 0)
            return b;
    fail_msg("no body %s", name);
    return -1;
}

static double quantity(const struct scenario *s, const double *robot, const char *name)
{
    for (int i = 0; i < s->scene->robot_count; i++)
        if (strcmp(s->scene->robot[i].name, name) == 0)
            return robot[i];
    fail_msg("no number %s", name);
    return NAN;
}

TEST(description_becomes_a_scene)
{
    SCENARIO s = {0};
    read_good(&s, base[RABBIT], NULL, 0);
    const stance_mechanism *const m = s.scene->mechanism;
    assert_true(m && m->bodies == 6 && m->elements == 2 && m->points == 1 && m->actuators == 2);
    for (int b = 0; b < m->bodies; b++)
        assert_true(m->body[b].parent < b);
    static const char *const order[] = {"trunk", "thigh1", "shank1", "thigh2", "shank2", "rotor"};
    for (int b = 0; b < m->bodies; b++)
        assert_string_equal(m->body[b].name, order[b]);
    const int shank2 = body_called(m, "shank2");
    assert_near(m->value.body[shank2].at[1], -0.4, 0);
    assert_near(m->value.body[shank2].limits[0], -2.5, 0);
    assert_near(m->value.body[body_called(m, "thigh2")].at[1], 0, 0);
    assert_true(isinf(m->value.body[body_called(m, "thigh2")].limits[1]));
    assert_true(!m->element[0].sole && m->element[1].sole);
    assert_near(m->value.element[1].to[0], 0.1, 0);
    assert_true(m->value.limit[0] == 150 && isinf(m->value.limit[1]));
    assert_near(quantity(&s, s.base.robot, "bodies.shank2.mass"), 3.2, 0);
    assert_near(s.base.robot[STANCE_ROBOT_SLOPE], 0.1, 0);
    assert_near(s.base.robot[STANCE_ROBOT_GRAVITY], 1.62, 0);
    assert_int_equal(s.scene->coordinates, 7);
    /* foot1 and not: both ends of foot2's sole, and two stops of each of two knees. */
    assert_int_equal(s.scene->contacts, 7);
    assert_int_equal(s.base.contacts, 0x7e);
    assert_int_equal(s.base.support, 6);
    for (int i = 0; i < m->numbers; i++)
        assert_false(m->varies[i]);
}

/* A number that is set, swept, sampled; one that is swept alone is there, too, and varies. */
TEST(numbers_vary)
{
    static const char *const sets[] = {
        "robot.bodies.thigh1.mass=7", "controller={kind: hold, kp: 1, kd: 1}",
        "sweep.grid=[{path: 'robot.bodies.trunk.centre[0]', from: -0.1, to: 0.1, count: 3}, "
        "{path: robot.bodies.shank1.damping, values: [0, 2]}, "
        "{paths: [robot.bodies.thigh1.mass, robot.bodies.thigh2.mass], values: [[5, 6]]}]"};
    SCENARIO s = {0};
    struct scenario_values v;
    read_good(&s, base[RABBIT], sets, 3);
    assert_near(quantity(&s, s.base.robot, "bodies.thigh2.mass"), 7, 0); /* like thigh1 */
    assert_int_equal(s.cases, 6);
    scenario_case_values(&s, 5, &v);
    assert_near(quantity(&s, v.robot, "bodies.trunk.centre[0]"), 0.1, 0);
    assert_near(quantity(&s, v.robot, "bodies.shank1.damping"), 2, 0);
    assert_near(quantity(&s, v.robot, "bodies.thigh1.mass"), 5, 0);
    assert_near(quantity(&s, v.robot, "bodies.thigh2.mass"), 6, 0);
    const stance_mechanism *const m = s.scene->mechanism;
    int varied = 0;
    for (int i = 0; i < m->numbers; i++) {
        const bool wanted = strcmp(s.scene->robot[i].name, "bodies.trunk.centre[0]") == 0 ||
                            strcmp(s.scene->robot[i].name, "bodies.shank1.damping") == 0 ||
                            strcmp(s.scene->robot[i].name, "bodies.thigh1.mass") == 0 ||
                            strcmp(s.scene->robot[i].name, "bodies.thigh2.mass") == 0;
        assert_int_equal(m->varies[i], wanted);
        varied += wanted;
    }
    assert_int_equal(varied, 4);
}

/* The text that files store makes the same scene, and the same text again. */
TEST(text_reads_back)
{
    for (int i = 0; i < 2; i++) {
        SCENARIO s = {0}, again = {0};
        read_good(&s, base[i], NULL, 0);
        read_good(&again, s.text, NULL, 0);
        assert_string_equal(s.text, again.text);
        assert_true(scenario_same_scene(&s, &again));
        assert_memory_equal(&s.base, &again.base, sizeof s.base);
        const char *const set = i ? "robot.bodies.pole.mass=2" : "robot.bodies.trunk.mass=2";
        read_good(&again, base[i], &set, 1);
        assert_true(scenario_same_scene(&s, &again)); /* but for a number */
        const char *const more =
            i ? "robot.bodies.pole.damping=2" : "robot.contacts.foot1.body=trunk";
        read_good(&again, base[i], &more, 1);
        assert_false(scenario_same_scene(&s, &again));
    }
}

/* ---- what is made of it ---------------------------------------------------------------------- */

static void resolve(const char *text, const char *const *sets, size_t set_count,
                    struct resolved_design *design, stance_case *c, const char *wanted)
{
    SCENARIO s = {0};
    stance_message message = {""};
    read_good(&s, text, sets, set_count);
    if (!resolve_design(s.scene, &s.base, design, &message) ||
        !resolve_case(&s, &s.base, design, 0, c, &message))
        assert_string_equal(message.text, wanted ? wanted : "");
    else
        assert_null(wanted);
}

/* The regulator of a cart and pole, by SciPy from the linear model in closed form. */
TEST(designs_act_on_names)
{
    static const char *const sets[] = {
        "initial={equilibrium: {}}",
        "controller={kind: state-feedback, design: lqr, weights: {states: [1, 10, 1, 1], torques: "
        "[0.1]}}",
        "robot.bodies.pole.inertia=0.00833"};
    static const double gain[4] = {-3.16227766, 49.53696991, -5.91436222, 12.84512014};
    struct resolved_design design;
    stance_case c;
    resolve(base[CART], sets, 3, &design, &c, NULL);
    for (int i = 0; i < 4; i++)
        assert_near(design.gain[0][i], gain[i], 1e-3);
    assert_true(isinf(c.torque_limit));
    assert_near(c.body.limit[0], 20, 0);
    assert_int_equal(c.supports, 0);
}

/* On a flat foot the posture has a coordinate more than the linear model: no gain acts on it. */
TEST(held_coordinates_have_no_gains)
{
    static const char *const sets[] = {
        "robot.actuators={hip1: {body: thigh1}, knee1: {body: shank1}, hip2: {body: thigh2}, "
        "knee2: {body: shank2}}",
        "initial={equilibrium: {thigh2: 0.3, shank2: -0.4, shank1: -0.5}, support: [foot2]}",
        "controller={kind: state-feedback, design: lqr}", "ground.contacts=[foot1, foot2]",
        "controller={kind: state-feedback, design: place, poles: [-1, -2, -3, -4]}"};
    struct resolved_design design;
    stance_case c;
    int held = 0;
    resolve(base[RABBIT], sets, 4, &design, &c, NULL);
    for (int k = 0; k < 5; k++) {
        bool any = false;
        for (int i = 0; i < 4; i++)
            any = any || design.gain[i][k] != 0 || design.gain[i][5 + k] != 0;
        held += !any;
    }
    assert_int_equal(held, 1);
    resolve(base[RABBIT], sets, 5, &design, &c,
            "controller.poles: 4 of them; where the contacts hold there are 8 states; idle there, "
            "with their rates: shank2");
}

/* A target on both feet is reached on both. */
TEST(targets_stand_on_both_feet)
{
    static const char *const sets[] = {
        "robot.actuators={hip1: {body: thigh1}, knee1: {body: shank1}, hip2: {body: thigh2}, "
        "knee2: {body: shank2}}",
        "robot.contacts={foot1: {body: shank1, at: [0, -0.4]}, foot2: {body: shank2, at: [0, "
        "-0.4]}}",
        "initial={equilibrium: {trunk: -0.05, thigh1: 0.5, shank1: -0.4}, support: [foot1, foot2], "
        "offset: {trunk: 0.02}}",
        "controller={kind: state-feedback, design: lqr, sample_time: 0.001}",
        "ground={friction: 0.8}",
        "robot.bodies.shank1.limits=[-2.5, 2.5]"};
    SCENARIO s = {0};
    struct resolved_design design;
    stance_message message;
    stance_case c;
    stance_result end;
    read_good(&s, base[RABBIT], sets, 6);
    assert_true(resolve_design(s.scene, &s.base, &design, &message));
    assert_true(resolve_case(&s, &s.base, &design, 0, &c, &message));
    assert_int_equal(c.supports, 3);
    c.step = 1e-3, c.sample_every = 1;
    stance_kernel_find(c.scene, stance_method_find("midpoint"), NULL)->run(&c, &end, 1);
    assert_int_equal(end.outcome, STANCE_STABILISED);
    assert_true(end.end_time < 2);
    c.supports = 1; /* it stands on more than that */
    stance_kernel_find(c.scene, stance_method_find("midpoint"), NULL)->run(&c, &end, 1);
    assert_int_not_equal(end.outcome, STANCE_STABILISED);
}

/* With initial.support a state stands on the ground; beyond a stop it does not begin. */
TEST(states_stand)
{
    static const char *const sets[] = {"initial.support=[foot1]", "ground.contacts=[foot1]",
                                       "initial.state.shank1=0.1"};
    struct resolved_design design;
    SCENARIO s = {0};
    stance_case c;
    read_good(&s, base[RABBIT], sets, 2);
    stance_message message;
    double gap[STANCE_MAX_CONTACTS];
    assert_true(resolve_design(s.scene, &s.base, &design, &message) &&
                resolve_case(&s, &s.base, &design, 0, &c, &message));
    s.scene->gaps(s.scene, c.robot, c.position, gap);
    assert_near(gap[0], 0, 1e-15);
    resolve(base[RABBIT], sets, 3, &design, &c,
            "initial.state.shank1: shank1 would start at 0.1 rad, above its upper limit of 0 rad");
}

/* ---- wrong ones ------------------------------------------------------------------------------ */

TEST(wrong_ones_are_told)
{
    int failed = 0;
    for (const struct mistake *m = mistake; m < mistake + mistakes; m++) {
        OWN char *text = edited(base[m->base], m->from, m->to);
        SCENARIO s = {0};
        const bool accepted = read_as(&s, "bad.yaml", text, NULL, 0);
        if (accepted || strcmp(errors, m->said) != 0) {
            print_error("%s -> %s: %snot %s", m->from, m->to, accepted ? "accepted, " : errors,
                        m->said);
            failed++;
        }
    }
    assert_int_equal(failed, 0);
    assert_in_range(mistakes, 120, MOST - 1);
}

/* Pieces of the ground, of a described robot and of one that is carried: their numbers, which of
 * them an axis gives, and what the file keeps. */
TEST(ground_becomes_plates)
{
    static const char *const scene[] = {base[RABBIT],
                                        "stance: 1\nscene: rod\ninitial: {state: {}}\n"
                                        "stop: {time: 5}\n"};
    const char *const sets[] = {
        "ground.plates={step: {from: 0.5, height: -0.05}, up: {from: 1, friction_factor: 0.5}, "
        "stairs: {kind: stairs, from: 2, width: 0.3, height: 0.05}, "
        "field: {kind: rough, from: 6, width: 0.2, count: 9}, late: {from: 0.1}}",
        "sweep.grid=[{path: ground.plates.late.footfall, values: [3, 5]}, "
        "{path: ground.plates.field.seed, from: 1, to: 3, count: 3}, "
        "{path: ground.plates.field.height, from: 0, to: 0.02, count: 2}]"};
    for (int k = 0; k < 2; k++) {
        SCENARIO s = {0}, again = {0};
        struct scenario_values v;
        read_good(&s, scene[k], sets, 2);
        const stance_mechanism *const m = s.scene->mechanism;
        assert_int_equal(m->plates, 5);
        assert_string_equal(m->plate[2].name, "stairs");
        assert_true(m->plate[0].kind == STANCE_PLATE && m->plate[2].kind == STANCE_STAIRS &&
                    m->plate[3].kind == STANCE_ROUGH);
        assert_true(m->plate[1].rough && !m->plate[0].rough && m->plate[4].by_footfall &&
                    !m->plate[0].by_footfall);
        assert_near(quantity(&s, s.base.robot, "plates.step.height"), -0.05, 0);
        assert_near(quantity(&s, s.base.robot, "plates.field.count"), 9, 0);
        assert_true(isinf(m->value.plate[2].count) && m->value.plate[0].seed < 0);
        scenario_case_values(&s, 1 + 2 * 2 + 6, &v);
        assert_near(quantity(&s, v.robot, "plates.late.footfall"), 5, 0);
        assert_near(quantity(&s, v.robot, "plates.field.seed"), 3, 0);
        assert_near(quantity(&s, v.robot, "plates.field.height"), 0.02, 0);
        assert_false(s.axis[0].design);
        read_good(&again, s.text, NULL, 0);
        assert_string_equal(s.text, again.text);
        assert_true(scenario_same_scene(&s, &again));
    }
}
