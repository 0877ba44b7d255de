/* test_rest - `rested` and `stabilised` are said where an equilibrium holds, and nowhere else: what
 * they say is held to the same case simulated on without settling, for ten times as long. */
#include "long.h"
#include "support.h"

enum { SIDE = 48 };

/* Outcomes of a map of starts around the equilibrium; those that come to rest must not fall later.
 */
static void map(const char *method, stance_case base, double tilt, double rate, int outcome[5])
{
    static stance_case c[SIDE * SIDE];
    static stance_result r[SIDE * SIDE], later[SIDE * SIDE];
    for (int i = 0; i < SIDE * SIDE; i++) {
        c[i] = base;
        c[i].position[2] += tilt * (2.0 * (i % SIDE) / (SIDE - 1) - 1);
        c[i].velocity[2] += rate * (2.0 * (i / SIDE) / (SIDE - 1) - 1);
        biped()->stand(biped(), c[i].robot, 1, c[i].position, c[i].velocity);
    }
    run_cases(kernel_of(method, NULL), c, r, SIDE * SIDE);
    for (int i = 0; i < SIDE * SIDE; i++) {
        outcome[r[i].outcome]++;
        c[i].settle = false;
        c[i].steps *= 10;
    }
    run_cases(kernel_of(method, NULL), c, later, SIDE * SIDE);
    int wrong = 0;
    for (int i = 0; i < SIDE * SIDE; i++)
        if (r[i].outcome == STANCE_RESTED || r[i].outcome == STANCE_STABILISED)
            wrong += later[i].outcome == STANCE_FELL;
    print_message("# %s: %d stabilised, %d rested, %d fell, %d undecided; of the first two %d fall "
                  "later\n",
                  method, outcome[STANCE_STABILISED], outcome[STANCE_RESTED], outcome[STANCE_FELL],
                  outcome[STANCE_UNDECIDED], wrong);
    assert_int_equal(wrong, 0);
}

/* The controller of one foot on both: what it leaves standing on both feet topples, slowly. */
TEST(slow_is_not_at_rest)
{
    static const char *const methods[] = {"implicit", "midpoint", "capturing"};
    for (int m = 0; m < 3; m++) {
        stance_case c = balance_case(0, 0);
        int outcome[5] = {0};
        c.contacts = 3;
        c.tolerance = 1e-6;
        map(methods[m], c, 0.09, 0.6, outcome);
        assert_int_equal(outcome[STANCE_RESTED], 0);
        assert_true(outcome[STANCE_STABILISED] > 0 && outcome[STANCE_FELL] > 0);
    }
}

static double critical_time(const stance_case *c, int delay)
{
    const stance_scene *const scene = stance_scene_find("biped");
    const stance_equilibrium equilibrium = equilibrium_at(c);
    double A[36], B[12], K[12], T;
    get_gain(c, K);
    OK(scene->linearise(scene, c->robot, &equilibrium, A, B));
    OK(stance_critical_sample_time(PLANT(6, 2, A, B), SAMPLING(K, 0, delay), 1, &T));
    return T;
}

/* A loop that samples so seldom that it is unstable stabilises nothing, however near it starts. */
TEST(unstable_loops_stabilise_nothing)
{
    for (int late = 0; late < 2; late++)
        for (int k = 0; k < 2; k++) {
            stance_case c = balance_case(1e-7, 0);
            const double critical = critical_time(&c, late);
            c.sample_every = (int64_t)lround((k ? 1.2 : 0.8) * critical / c.step);
            c.delay = late;
            const stance_result r = run_done("implicit", &c);
            print_message("# T = %.0f ms, delay %d: outcome %d\n", (double)c.sample_every, late,
                          r.outcome);
            assert_true((r.outcome == STANCE_STABILISED) == (k == 0));
        }
}

/* Stiff servos hold a robot that straddles on both feet; without any its trunk topples. */
static stance_case straddle(double kp, double tilt)
{
    stance_case c = plain_case();
    double gap[2];
    c.position[2] = tilt, c.position[3] = -0.3 - tilt, c.position[4] = 0.3 - tilt;
    biped()->gaps(biped(), c.robot, c.position, gap);
    c.position[1] -= gap[0];
    biped()->stand(biped(), c.robot, 1, c.position, c.velocity);
    hold_legs(&c, kp, kp / 10);
    c.settle = true;
    c.sample_every = 1;
    c.steps = 20000;
    return c;
}
TEST(stiff_legs_rest)
{
    static const char *const methods[] = {"implicit", "midpoint", "capturing", "lagrange",
                                          "event-driven"};
    for (int m = 0; m < 5; m++) {
        stance_case stiff = straddle(100, 0);
        stiff.tolerance = 1e-8;
        const stance_result held = run_done(methods[m], &stiff);
        assert_int_equal(held.outcome, STANCE_RESTED);
        assert_true(held.end_time < 1);
        if (m > 2) /* these chatter */
            continue;
        stance_case weak = straddle(0, 1e-3);
        weak.tolerance = 1e-6;
        const stance_result falls = run_done(methods[m], &weak);
        print_message("# %s: stiff %d after %.3f s, weak %d after %.3f s\n", methods[m],
                      held.outcome, held.end_time, falls.outcome, falls.end_time);
        assert_int_equal(falls.outcome, STANCE_FELL);
    }
}

/* A block that is pulled to and fro rests where the pull never reaches what friction holds. */
TEST(pulled_blocks_rest_if_held)
{
    static const double share[] = {0.9, 0.999, 1.001, 1.05, 1.2}; /* of what friction holds */
    for (int k = 0; k < 5; k++) {
        stance_case c = case_of_scene("block", 1e-3, 2);
        c.robot[1] = share[k] * 0.5 * 9.81 * c.robot[0]; /* the pull, and its frequency: */
        c.robot[2] = 0.05;                               /* 20 s, it is still for long */
        c.settle = true;
        assert_int_equal(run_one("capturing", &c).outcome,
                         share[k] > 1 ? STANCE_UNDECIDED : STANCE_RESTED);
    }
}

/* Robots of random proportions on one or both feet, their legs held by soft servos: slow for long,
 * sliding, creeping, toppling. */
static stance_case soft_case(uint64_t *seed)
{
    const stance_scene *const scene = stance_scene_find("biped");
    stance_case c = plain_case();
    for (int i = 0; i < 5; i++)
        c.robot[i] *= exp(uniform(seed, -0.7, 0.7));
    const double spread = uniform(seed, 0.05, 0.6), tilt = uniform(seed, -0.3, 0.3);
    c.position[2] = tilt;
    c.position[3] = uniform(seed, -0.1, 0.1) - tilt - spread;
    c.position[4] = uniform(seed, -0.1, 0.1) - tilt + spread;
    for (int i = 2; i < 5; i++)
        c.velocity[i] = uniform(seed, -0.2, 0.2);
    if (uniform(seed, 0, 1) < 0.2)
        c.contacts = 1;
    double gap[2];
    scene->gaps(scene, c.robot, c.position, gap);
    c.position[1] += 1e-13 - (c.contacts == 1 ? gap[0] : fmin(gap[0], gap[1]));
    const double kp = 3 * exp(uniform(seed, 0, 3));
    hold_legs(&c, kp, kp * 0.02 * exp(uniform(seed, 0, 4)));
    c.friction = 0.01 * exp(uniform(seed, 0, 5));
    c.torque_limit = uniform(seed, 0, 1) < 0.5 ? 1.5 * exp(uniform(seed, 0, 2.3)) : INFINITY;
    c.sample_every = (int64_t)uniform(seed, 0, 2) * (1 + (int64_t)uniform(seed, 0, 20));
    c.delay = c.sample_every > 0 && uniform(seed, 0, 1) < 0.2 ? (int64_t)uniform(seed, 1, 5) : 0;
    if (c.sample_every > 0 && uniform(seed, 0, 1) < 0.3)
        c.lag = 2e-3 * exp(uniform(seed, 0, 4));
    if (c.sample_every > 0 && uniform(seed, 0, 1) < 0.2)
        c.torque_rate = 10 * exp(uniform(seed, 0, 5));
    c.step = 2e-3;
    c.steps = 5000;
    c.tolerance = 1e-6;
    c.settle = true;
    return c;
}

/* Standing on both feet, with what a linear look at a law does not see. */
enum { TWO_LAWS, RAMPS, LIMITS, UNDERGROUND, KINDS };
static stance_case odd_case(uint64_t *seed, int kind)
{
    const stance_scene *const scene = stance_scene_find("biped");
    stance_case c = plain_case();
    double kp = 20 * exp(uniform(seed, 0, 3.2)), kd = kp * 0.02 * exp(uniform(seed, 0, 2.7)),
           gap[2];
    double tilt;
    do { /* underground: the trunk's end little above the ground */
        const bool low = kind == UNDERGROUND;
        const double spread = uniform(seed, low ? 0.3 : 0.1, low ? 1 : 0.6);
        tilt = low ? uniform(seed, 1.6, 3) : uniform(seed, -0.2, 0.2);
        stance_robot_fallback(scene, c.robot);
        c.scene = scene;
        for (int i = 0; i < 5 && !low; i++)
            c.robot[i] *= exp(uniform(seed, -0.5, 0.5));
        if (low)
            c.robot[1] *= uniform(seed, 1, 1.5), kd = kp * 0.3 * exp(uniform(seed, 0, 2.8));
        c.position[1] = 0;
        c.position[2] = tilt;
        c.position[3] = -tilt - spread;
        c.position[4] = -tilt + spread;
        scene->gaps(scene, c.robot, c.position, gap);
        c.position[1] += 1e-13 - fmin(gap[0], gap[1]);
    } while (kind == UNDERGROUND && (c.position[1] < 0.001 || c.position[1] > 0.04));
    if (kind == LIMITS)
        kp *= 5, kd *= 3;
    hold_legs(&c, kp, kd);
    const double off = kind == UNDERGROUND ? 0.05 : kind == TWO_LAWS ? 0 : 0.02;
    for (int i = 0; i < 2; i++)
        c.near.target[1 + i] += uniform(seed, -off, off);
    c.friction = kind == UNDERGROUND ? uniform(seed, 1, 4) : uniform(seed, 0.2, 1.5);
    c.sample_every = kind == UNDERGROUND ? 0 : 1 + (int64_t)uniform(seed, 0, 20);
    for (int i = 2; i < 5 && kind == TWO_LAWS; i++)
        c.velocity[i] = uniform(seed, -0.2, 0.2);
    if (kind == TWO_LAWS) {
        c.switches = true;
        c.far.gain[0][1] = c.far.gain[1][2] = kp * uniform(seed, 0, 1);
        c.far.gain[0][4] = c.far.gain[1][5] = kd * uniform(seed, 0, 1);
        for (int i = 0; i < 3; i++)
            c.far.target[i] = c.near.target[i] + uniform(seed, -0.1, 0.1);
        for (int i = 0; i < 6; i++)
            c.switch_axis[i] = 0.003 * exp(uniform(seed, 0, 6));
        c.near.target[0] = tilt;
    } else if (kind == RAMPS) {
        c.decouples = true;
        for (int i = 0; i < 2; i++)
            c.servo[i] =
                servo_of(2 + i, c.position[2 + i], 1e-3 * exp(uniform(seed, 0, 4)), 100, 20);
        c.servo[1].duration = 20;
    } else if (kind == LIMITS) {
        const double rate = uniform(seed, -0.5, 0.5);
        c.velocity[2] = rate, c.velocity[3] = c.velocity[4] = -rate;
        c.torque_limit = 0.1 * exp(uniform(seed, 0, 4));
    }
    c.step = 2e-3;
    c.steps = 4000;
    c.settle = true;
    return c;
}

/* What became of cases that were said to rest, and of those that had stopped and were not. */
struct stay {
    int rested, left, fallen, still, missed;
};
static void stay_add(struct stay *sum, const stance_result *r, const stance_result *end,
                     const stance_result *later, double bound)
{
    if (r->status != STANCE_DONE || later->status != STANCE_DONE)
        return;
    double moved = 0, rate = 0, since = 0;
    for (int k = 2; k < 5; k++) {
        moved = fmax(moved, fabs(later->position[k] - r->position[k]));
        since = fmax(since, fabs(later->position[k] - end->position[k]));
        rate = fmax(rate, fabs(end->velocity[k]));
    }
    const bool stopped = later->outcome != STANCE_FELL && rate < 1e-7 && since < 1e-6;
    const bool says = r->outcome == STANCE_RESTED;
    sum->rested += says;
    sum->left += says && moved > bound;
    sum->fallen += says && later->outcome == STANCE_FELL;
    sum->still += stopped;
    sum->missed += stopped && !says;
}
static struct stay stay_of(const stance_kernel *kernel, stance_case *c, int count)
{
    stance_result *const r = calloc(3 * (size_t)count, sizeof *r), *const end = r + count,
                         *const later = end + count;
    struct stay sum = {0};
    assert_non_null(r);
    run_cases(kernel, c, r, (size_t)count);
    for (int i = 0; i < count; i++)
        c[i].settle = false;
    run_cases(kernel, c, end, (size_t)count);
    for (int i = 0; i < count; i++)
        c[i].steps *= 3;
    run_cases(kernel, c, later, (size_t)count);
    for (int i = 0; i < count; i++)
        stay_add(&sum, &r[i], &end[i], &later[i], c[i].settle_angle);
    free(r);
    return sum;
}

/* What rests does not move afterwards, and nearly all of what has stopped was said to rest. */
TEST(soft_legs_rest_where_they_stay)
{
    static const char *const methods[] = {"implicit", "midpoint"};
    const int count = long_tests() ? 20000 : 500;
    OWN stance_case *c = room((size_t)count * sizeof *c);
    for (int m = 0; m < 2; m++) {
        uint64_t seed = 11;
        for (int i = 0; i < count; i++)
            c[i] = soft_case(&seed);
        const struct stay sum = stay_of(kernel_of(methods[m], NULL), c, count);
        print_message("## %s: %d of %d rested, of which %d fell and %d moved later; of %d that had "
                      "stopped %d were not said to rest\n",
                      methods[m], sum.rested, count, sum.fallen, sum.left, sum.still, sum.missed);
        assert_true(sum.rested > count / 5 && sum.fallen == 0 && sum.left == 0);
        assert_true(sum.missed * 20 < sum.still);
    }
}

/* The same with laws that are not linear about where it stands, and where the trunk sinks. */
TEST(odd_laws_rest_where_they_stay)
{
    static const char *const names[] = {"two laws", "ramps", "limits", "underground"};
    const int count = long_tests() ? 10000 : 200;
    OWN stance_case *c = room((size_t)count * sizeof *c);
    for (int kind = 0; kind < KINDS; kind++) {
        uint64_t seed = 5;
        for (int i = 0; i < count; i++)
            c[i] = odd_case(&seed, kind);
        const struct stay sum = stay_of(kernel_of("midpoint", NULL), c, count);
        print_message("## %s: %d of %d rested, of which %d fell and %d moved later\n", names[kind],
                      sum.rested, count, sum.fallen, sum.left);
        assert_true(sum.fallen == 0 && sum.left == 0);
        assert_true(kind == RAMPS || sum.rested > count / 5);
    }
}

/* At e = 0.55 and 0.75 the steps of 1 ms end in bounces of micrometres, for ever: it lies still. */
TEST(bounces_within_a_step_rest)
{
    for (int k = 0; k < 19; k++) {
        stance_case c = case_of_scene("ball", 1e-3, 8);
        double gap[STANCE_MAX_CONTACTS];
        c.scene->gaps(c.scene, c.robot, c.position, gap);
        c.position[1] += 0.5 - gap[0];
        c.restitution = 0.05 * k;
        c.friction = 0.8;
        c.settle = true;
        c.settle_rate = 0.02, c.settle_hold = 0.25;
        assert_int_equal(run_one("midpoint", &c).outcome, STANCE_RESTED);
    }
}
