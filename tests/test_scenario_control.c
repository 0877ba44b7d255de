/* Scenarios of linear controllers, from the text to the gains: which axes make designs of their
 * own, which gains a design leads to, and what is said where there is none. */
#include "reading.h"

#include "runner/plan/design.h"

/* A scenario of the default robot with these keys of the controller. */
static const char *designed(const char *keys)
{
    static char text[1024];
    snprintf(text, sizeof text,
             "stance: 1\nscene: biped\ninitial: {equilibrium: {theta: -0.41, q2: 0.82}}\n"
             "stop: {time: 1}\ncontroller: {kind: state-feedback, %s}\n",
             keys);
    return text;
}

/* Gains for the sampled model depend on the sample time, others do not. */
TEST(sample_time_may_be_design)
{
    static const char axis[] =
        "sweep.grid=[{path: controller.sample_time, from: 0.001, to: 0.01, count: 3}]";
    static const char times[] =
        "sweep.grid=[{path: controller.sample_time, from: 0.001, to: 0.01, count: 3}, "
        "{path: controller.design_time, values: [continuous, sampled]}]";
    SCENARIO s = {0};
    read_good(&s, designed("design: lqr, design_time: sampled, sample_time: 0.002"),
              (const char *[]){axis}, 1);
    assert_true(s.axis[0].design);
    read_good(&s, designed("design: lqr, design_time: sampled, sample_time: 0.002"),
              (const char *[]){axis, "controller.design_time=continuous"}, 2);
    assert_false(s.axis[0].design);
    read_good(&s, designed("poles: [-1, -2, -3, -4, -5, -6], sample_time: 0.002"),
              (const char *[]){times}, 1);
    assert_true(s.axis[0].design && s.axis[1].design);
    read_good(
        &s,
        designed(
            "design: gains, gains: [[1, 2, 3, 4, 5, 6], [6, 5, 4, 3, 2, 1]], sample_time: 0.002"),
        (const char *[]){axis}, 1);
    assert_false(s.axis[0].design);
}

/* ---- gains ----------------------------------------------------------------------------------- */

enum { N = 6, M = 2 };
static const double IM[N] = {0}, RE[N] = {-3, -3.3, -3.6, -3.9, -4.2, -4.6};

static void model(const struct scenario_values *v, double *A, double *B)
{
    const stance_scene *scene = stance_scene_find("biped");
    double robot[STANCE_MAX_ROBOT];
    stance_equilibrium e;
    stance_message message;
    assert_true(resolve_equilibrium(scene, v, robot, &e, &message));
    OK(scene->linearise(scene, robot, &e, A, B));
}

/* The gains of case `index` are K, and the case carries the delay. */
static void leads_to(const struct scenario *s, uint64_t index, const double *K, int delay)
{
    struct scenario_values v;
    struct resolved_design design;
    stance_message message;
    stance_case c;
    scenario_case_values(s, index, &v);
    if (!resolve_design(s->scene, &v, &design, &message) ||
        !resolve_case(s, &v, &design, index, &c, &message))
        fail_msg("%s", message.text);
    double gain[12];
    get_gain(&c, gain);
    assert_memory_equal(gain, K, sizeof gain);
    assert_int_equal(c.delay, delay);
}

TEST(every_design_reaches_the_case)
{
    static const char axes[] = "sweep.grid=[{path: controller.sample_time, values: [0.01, 0.02]}, "
                               "{path: controller.delay, values: [0, 1]}]";
    static const double Q[N] = {1, 2, 0, 4, 5, 6}, R[M] = {0.1, 0.2};
    const char *const sets[] = {axes};
    double A[N * N], B[N * M], K[M * N];
    SCENARIO s = {0};
    for (int k = 0; k < 6; k++) {
        char keys[256];
        snprintf(keys, sizeof keys, "design: %s, design_time: %s, %s",
                 k % 3 == 0   ? "place"
                 : k % 3 == 1 ? "place-schur"
                              : "lqr",
                 k < 3 ? "continuous" : "sampled",
                 k % 3 == 2 ? "weights: {states: [1, 2, 0, 4, 5, 6], torques: [0.1, 0.2]}"
                            : "poles: [-3, -3.3, -3.6, -3.9, -4.2, -4.6]");
        read_good(&s, designed(keys), sets, 1);
        model(&s.base, A, B);
        for (int i = 0; i < 4; i++) {
            const double T = i < 2 ? 0.01 : 0.02;
            stance_error error =
                k == 0 ? stance_place(STANCE_ROBUST, PLANT(N, M, A, B), 0, POLES(RE, IM), K, NULL,
                                      NULL)
                : k == 1
                    ? stance_place(STANCE_SCHUR, PLANT(N, M, A, B), 0, POLES(RE, IM), K, NULL, NULL)
                : k == 2 ? stance_lqr(PLANT(N, M, A, B), 0, Q, R, K, NULL)
                : k == 3 ? stance_place(STANCE_ROBUST, PLANT(N, M, A, B), T, POLES(RE, IM), K, NULL,
                                        NULL)
                : k == 4
                    ? stance_place(STANCE_SCHUR, PLANT(N, M, A, B), T, POLES(RE, IM), K, NULL, NULL)
                    : stance_lqr(PLANT(N, M, A, B), T, Q, R, K, NULL);
            OK(error);
            leads_to(&s, (uint64_t)i, K, i % 2);
        }
    }
}

/* ---- designs that do not exist --------------------------------------------------------------- */

static void impossible(const char *keys, const char *const *sets, size_t count, const char *wanted)
{
    SCENARIO s = {0};
    struct resolved_design design;
    stance_message message;
    read_good(&s, designed(keys), sets, count);
    assert_false(resolve_design(s.scene, &s.base, &design, &message));
    assert_string_equal(message.text, wanted);
}

TEST(impossible_designs)
{
    /* Both legs level, the trunk long: see test_design.c. */
    static const char *const level[] = {
        "robot={leg_length: 0.5, trunk_length: 2, foot_mass: 2, trunk_mass: 4, hip_mass: 4}",
        "initial.equilibrium={q1: 2.0943951023931953, q2: 2.0943951023931953}"};
    impossible("poles: [-3, -3.3, -3.6, -3.9, -4.2, -4.6]", level, 2,
               "initial.equilibrium: the pair (A, B) is not controllable: no input reaches the "
               "mode with eigenvalue "
               "-2.20334");
    impossible("design: place-schur, poles: [-3, -3.3, -3.6, -3.9, -4.2, -4.6]", level, 2,
               "initial.equilibrium: the pair (A, B) is not controllable: no input reaches the "
               "mode with eigenvalue "
               "-2.20334");
    impossible("design: lqr", level, 2,
               "initial.equilibrium: the system is not stabilisable: no input reaches the mode "
               "with eigenvalue 2.20334");
    impossible("design: lqr, weights: {states: [0, 0, 0, 0, 0, 0]}", NULL, 0,
               "controller.weights: the weights of the states do not see the mode with eigenvalue "
               "-4.32043i, which "
               "does not decay by itself");
    impossible("poles: [-3+7i, -3-7i, -3.6, -3.9, -4.2, -4.6], design_time: sampled, "
               "sample_time: 0.5",
               NULL, 0,
               "controller.design_time: the pole -3+7i turns 0.557 times in a sample of 0.5 s: "
               "less than half a turn can "
               "be told from its mirror image");
}

/* ---- the report ------------------------------------------------------------------------------ */

static const struct design_report *report(struct scenario *s, const char *keys)
{
    static struct design_report r;
    stance_message message;
    read_good(s, designed(keys), NULL, 0);
    if (!design_compute(&r, s, &message))
        fail_msg("%s", message.text);
    return &r;
}

/* What part of the room that the equilibrium leaves the torques and the force on the foot use up at
 * X, the largest over all bounds. */
static double room_used(const struct design_report *r, const double *X)
{
    const struct scenario_values *v = &r->scenario->base;
    double force[2], by_state[2 * N], by_torque[2 * M], most = 0;
    OK(r->scenario->scene->contact_force(r->scenario->scene, r->model, &r->equilibrium, force,
                                         by_state, by_torque));
    const double weight = force[0];
    for (int i = 0; i < M; i++) {
        double torque = r->equilibrium.torque[i], change = 0;
        for (int j = 0; j < N; j++)
            change -= r->K[i * N + j] * X[j];
        most = fmax(
            most, fmax(change / (v->torque_limit - torque), -change / (v->torque_limit + torque)));
        force[0] += by_torque[i] * change;
        force[1] += by_torque[M + i] * change;
    }
    for (int j = 0; j < N; j++) {
        force[0] += by_state[j] * X[j];
        force[1] += by_state[N + j] * X[j];
    }
    most = fmax(most, (weight - force[0]) / weight);
    return fmax(most,
                (fabs(force[1]) + v->friction * (weight - force[0])) / (v->friction * weight));
}

/* Points of the set's surface use up at most all of the room, and the worst of them nearly all. */
static void check_set(const struct design_report *r)
{
    uint64_t random = 11;
    double most = 0, direction[N] = {0};
    assert_true(r->set.exists && r->set.of.binding >= 0);
    for (int k = 0; k < 60000; k++) {
        /* Far around at first, then ever nearer to the worst point so far. */
        const double spread = exp(-k / 4000.0);
        double X[N], V = 0;
        for (int i = 0; i < N; i++)
            X[i] = direction[i] + r->set.of.extent[i] * spread * uniform(&random, -1, 1);
        for (int i = 0; i < N; i++)
            for (int j = 0; j < N; j++)
                V += X[i] * r->set.P[i * N + j] * X[j];
        for (int i = 0; i < N; i++)
            X[i] *= sqrt(r->set.of.level / V);
        const double used = room_used(r, X);
        assert_true(used <= 1 + 1e-9);
        if (used > most) {
            most = used;
            memcpy(direction, X, sizeof direction);
        }
    }
    assert_true(most > 0.99);
}

TEST(sets_keep_within_bounds)
{
    SCENARIO s = {0};
    char name[64];
    check_set(report(&s, "poles: [-3, -3.3, -3.6, -3.9, -4.2, -4.6], torque_limit: 10"));
    const struct design_report *r =
        report(&s, "design: lqr, design_time: sampled, sample_time: 0.02, torque_limit: 12");
    check_set(r);
    assert_string_equal(design_bound_name(r, 1, name), "torque limit of hip1, negative");
    r = report(&s, "design: lqr, torque_limit: 1000");
    check_set(r);
    assert_string_equal(design_bound_name(r, r->set.of.binding, name),
                        "friction cone, force backward");
    /* Where the limit is below what the equilibrium takes there is no room. */
    assert_true(report(&s, "design: lqr, torque_limit: 5")->set.of.level == 0);
}

/* One sample after the other, by hand: growth as the report's spectral radius says. */
TEST(sampled_loop_grows_as_reported)
{
    for (int delay = 0; delay < 4; delay++) {
        SCENARIO s = {0};
        char keys[128];
        double Ad[N * N], Bd[N * M], X[N] = {1, 0, 0, 0, 0, 0}, u[4][M] = {{0}}, size = 0;
        snprintf(keys, sizeof keys, "design: lqr, sample_time: 0.06, delay: %d", delay);
        const struct design_report *r = report(&s, keys);
        OK(stance_discretise(PLANT(N, M, r->A, r->B), 0.06, Ad, Bd));
        double logarithm = 0;
        for (int k = 0; k < 4000; k++) {
            double next[N], late[M];
            size = 0;
            for (int i = 0; i < M; i++) {
                late[i] = 0;
                for (int j = 0; j < N; j++)
                    late[i] -= r->K[i * N + j] * X[j];
            }
            for (int i = 0; i < N; i++) {
                next[i] = 0;
                for (int j = 0; j < N; j++)
                    next[i] += Ad[i * N + j] * X[j];
                for (int j = 0; j < M; j++)
                    next[i] += Bd[i * M + j] * (delay ? u[0][j] : late[j]);
                size = fmax(size, fabs(next[i]));
            }
            for (int i = 0; i < N; i++)
                X[i] = next[i] / size;
            for (int i = 0; i < M; i++) {
                for (int d = 0; d + 1 < delay; d++)
                    u[d][i] = u[d + 1][i] / size;
                u[delay ? delay - 1 : 0][i] = late[i] / size;
            }
            logarithm += k >= 2000 ? log(size) : 0;
        }
        assert_true(fabs(exp(logarithm / 2000) - r->radius) < 1e-3);
        assert_int_equal(r->sampled, N + delay * M);
        assert_true(r->stable == (r->radius < 1));
        assert_true(r->stable == (0.06 < r->critical[delay > 0]));
        assert_true(!r->stable || r->delay_margin >= delay);
        assert_true(r->set.exists == (r->stable && !delay));
    }
}
