/* Limits: the step at which explicit steps of a stiff servo become unstable, the sample time at
 * which a sampled controller does, and implicit steps under everything that a scenario admits,
 * which must never run away. */
#include "closed_biped.h"
#include "long.h"
#include "support.h"

#include "analysis/statistics/statistics.h"

#include <complex.h>

/* ---- explicit steps: |R(h lambda)| = 1 ---- */

/* Joint accelerations of the legs in free flight are -S (kp q + kd q'). */
static void servo_matrix(const stance_case *c, double S[2][2])
{
    double inertia[COORDINATES * COORDINATES];
    closed_inertia(c->robot, c->position, inertia);
    for (int k = 0; k < 2; k++) {
        /* A unit torque between trunk and leg k. */
        double a[DENSE_ROWS][DENSE_ROWS + 1], x[DENSE_ROWS];
        for (int i = 0; i < COORDINATES; i++) {
            memcpy(a[i], inertia + i * COORDINATES, COORDINATES * sizeof *inertia);
            a[i][COORDINATES] = i == Q1 + k;
        }
        assert_true(dense_solve(COORDINATES, a, x));
        for (int i = 0; i < 2; i++)
            S[i][k] = x[Q1 + i];
    }
}

/* The larger eigenvalue and its vector. */
static double stiffest(const double S[2][2], double vector[2])
{
    const double mean = (S[0][0] + S[1][1]) / 2;
    const double value = mean + sqrt(mean * mean - (S[0][0] * S[1][1] - S[0][1] * S[1][0]));
    const double length = hypot(S[0][1], value - S[0][0]);
    vector[0] = S[0][1] / length;
    vector[1] = (value - S[0][0]) / length;
    return value;
}

static double growth(double s, double kp, double kd, double h)
{
    const double complex root = csqrt(kd * s * kd * s - 4 * kp * s);
    double largest = 0;
    for (int sign = -1; sign <= 1; sign += 2) {
        const double complex z = h * (sign * root - kd * s) / 2;
        largest = fmax(largest, cabs(1 + z + z * z / 2 + z * z * z / 6 + z * z * z * z / 24));
    }
    return largest;
}

static double limit_in_theory(double s, double kp, double kd)
{
    double low = 0.1 / (kd * s + sqrt(kp * s)), high = low;
    while (growth(s, kp, kd, high) <= 1)
        low = high, high *= 1.001;
    for (int i = 0; i < 60; i++) {
        const double middle = (low + high) / 2;
        *(growth(s, kp, kd, middle) <= 1 ? &low : &high) = middle;
    }
    return low;
}

enum { STEPS = 2000 };

/* Case in free flight without contacts, from so high that it stays above the ground; legs off their
 * targets by 1e-6 along `vector`. */
static stance_case flying_case(double h, double kp, double kd, const double vector[2])
{
    stance_case c = plain_case();
    c.contacts = 0;
    c.robot[STANCE_ROBOT_FALL_HEIGHT] = -1;
    c.position[1] = 10 + STANCE_GRAVITY * pow(STEPS * h, 2), c.position[2] = -0.5,
    c.position[3] = 0.9, c.position[4] = -1;
    hold_legs(&c, kp, kd);
    for (int i = 0; i < 2; i++)
        c.position[3 + i] += 1e-6 * vector[i];
    c.step = h;
    return c;
}

/* Do the legs swing further in the last 500 of 2000 steps than in the first 100, or ever a
 * thousand times as far as they began? */
static bool swings_up(const char *method, double h, double kp, double kd, const double vector[2])
{
    enum { ROWS = STEPS + 1 };
    stance_case c = flying_case(h, kp, kd, vector);
    TRAJECTORY t = trajectory_new(ROWS, h);
    c.steps = STEPS;
    c.trajectory = &t;
    const stance_result r = run_one(method, &c);
    double size[3] = {0, 0, 0}; /* first, between, last */
    for (int k = 0; k < ROWS; k++)
        for (int i = 0; i < 2; i++) {
            double *const mine = &size[k < 100 ? 0 : k < 1500 ? 1 : 2];
            *mine = fmax(*mine, fabs(t.position[5 * k + 3 + i] - c.near.target[i + 1]));
        }
    return r.status != STANCE_DONE || size[2] > 1.01 * size[0] || size[1] > 1e-3;
}

TEST(explicit_steps)
{
    static const double stiffness[] = {20, 500, 2e4, 1e6}, damping[] = {0, 0.3, 1, 3};
    double worst = 0;
    for (size_t i = 0; i < 4; i++)
        for (size_t j = 0; j < 4; j++) {
            double S[2][2], vector[2];
            const stance_case c = flying_case(1, 0, 0, (double[2]){0, 0});
            servo_matrix(&c, S);
            const double s = stiffest((const double(*)[2])S, vector), kp = stiffness[i];
            const double kd = 2 * damping[j] * sqrt(kp / s);
            const double theory = limit_in_theory(s, kp, kd);
            double low = 0.9 * theory, high = 1.1 * theory;
            assert_false(swings_up("lagrange", low, kp, kd, vector));
            assert_true(swings_up("lagrange", high, kp, kd, vector));
            while (high - low > 1e-4 * theory) {
                const double middle = (low + high) / 2;
                *(swings_up("lagrange", middle, kp, kd, vector) ? &high : &low) = middle;
            }
            worst = fmax(worst, fabs(low / theory - 1));
            /* What is implicit stays where no explicit step can go. */
            assert_false(swings_up("implicit", 20 * theory, kp, kd, vector));
            assert_false(swings_up("midpoint", 20 * theory, kp, kd, vector));
        }
    print_message("# 16 limits of Runge-Kutta 4, off by at most %.3f %%\n", 100 * worst);
    assert_true(worst < 0.02);
}

/* ---- the sampled controller: T* ---- */

struct balance {
    double robot[5], theta, q2, speed; /* of the poles */
};
static const struct balance balances[] = {
    {{0.535, 0.535, 1.8, 1.8, 5.4}, -0.41, 0.82, 1}, {{0.5, 0.5, 1, 1, 3}, -0.3, 0.6, 1.5},
    {{0.9, 0.6, 4, 30, 20}, 0.15, -0.4, 0.7},        {{0.25, 0.3, 0.2, 0.5, 0.8}, -0.2, 0.9, 2},
    {{1.2, 0.4, 1, 2, 10}, 0.3, -0.7, 0.5},          {{0.4, 0.8, 3, 1, 2}, -0.5, 1, 1.2},
};

/* A robot on foot 1, 1e-6 rad off its equilibrium; and the theory's T*. */
static stance_case sampled_case(const struct balance *b, double *critical)
{
    double A[36], B[12], K[12];
    stance_case c = plain_case();
    memcpy(c.robot, b->robot, sizeof b->robot);
    put_in_balance(&c, b->theta, b->q2, b->speed, 1e-6);
    const stance_equilibrium equilibrium = equilibrium_at(&c);
    get_gain(&c, K);
    OK(biped()->linearise(biped(), c.robot, &equilibrium, A, B));
    OK(stance_critical_sample_time(PLANT(6, 2, A, B), SAMPLING(K, 0, 0), 2, critical));
    c.tolerance = 1e-13;
    return c;
}

enum { SAMPLES = 600, TRIES = 12 };

/* Largest deviation among samples [from, to). */
static double deviation(const stance_case *c, const stance_trajectory *t, int from, int to)
{
    double largest = 0;
    for (int k = from; k < to; k++)
        for (int i = 0; i < 3; i++)
            largest = fmax(largest, fmax(fabs(t->position[5 * k + 2 + i] - c->near.target[i]),
                                         fabs(t->velocity[5 * k + 2 + i]) * c->step *
                                             (double)c->sample_every));
    return largest;
}

/* Shortest of the sample times low + k * gap, k = 0 ... TRIES - 1, at which the deviation grows,
 * less a gap: the longest at which it does not. */
static double longest_calm(const char *method, const stance_case *base, int parts, double low,
                           double gap)
{
    stance_case c[TRIES];
    stance_result r[TRIES];
    stance_trajectory t[TRIES];
    for (int k = 0; k < TRIES; k++) {
        const double T = low + k * gap;
        c[k] = *base;
        c[k].step = T / parts;
        c[k].sample_every = parts;
        c[k].steps = (int64_t)parts * SAMPLES;
        t[k] = trajectory_new(SAMPLES + 1, T);
        c[k].trajectory = &t[k];
    }
    run_cases(kernel_of(method, NULL), c, r, TRIES);
    int calm = -1;
    for (int k = TRIES - 1; k >= 0; k--) {
        const bool grows = r[k].status != STANCE_DONE || r[k].outcome == STANCE_FELL ||
                           deviation(&c[k], &t[k], 3 * SAMPLES / 4, SAMPLES) >
                               deviation(&c[k], &t[k], SAMPLES / 4, SAMPLES / 2);
        if (!grows && calm < 0)
            calm = k;
        trajectory_free(&t[k]);
    }
    assert_in_range(calm, 0, TRIES - 1);
    return low + calm * gap;
}

/* Between 0.9 and 1.1 of the theory's; known to 0.01 %. */
static double simulated_limit(const char *method, const stance_case *base, int parts, double T)
{
    double low = 0.9 * T, gap = 0.2 * T / (TRIES - 1);
    for (int round = 0; round < 3; round++, gap /= TRIES - 1)
        low = longest_calm(method, base, parts, low, gap);
    assert_true(low < 1.09 * T);
    return low + gap * (TRIES - 1) / 2;
}

TEST(sampled_controllers)
{
    double worst[3] = {0};
    const size_t n = COUNT(balances);
    for (size_t i = 0; i < n; i++) {
        double T;
        const stance_case c = sampled_case(&balances[i], &T);
        const double capturing = simulated_limit("capturing", &c, 1, T);
        const double implicit =
            2 * simulated_limit("implicit", &c, 64, T) - simulated_limit("implicit", &c, 32, T);
        const double midpoint =
            (4 * simulated_limit("midpoint", &c, 16, T) - simulated_limit("midpoint", &c, 8, T)) /
            3;
        const double off[3] = {capturing / T - 1, implicit / T - 1, midpoint / T - 1};
        print_message("# T* = %.5f s: capturing %+.2f %%, implicit %+.2f %%, midpoint %+.2f %%\n",
                      T, 100 * off[0], 100 * off[1], 100 * off[2]);
        for (int k = 0; k < 3; k++)
            worst[k] = fmax(worst[k], fabs(off[k]));
    }
    for (int k = 0; k < 3; k++)
        assert_true(worst[k] < 0.01);
}

/* ---- implicit steps under everything ---- */

/* core/implicit/step.h takes no step (with e = 0) that creates more energy than the share a =
 * STEP_SHARE of the kinetic energies at both ends and the work. For a servo without a limit this
 * bounds a run of n steps: with H the energy above the lowest that there is, the servo's kp dq^2 /
 * 2 included, its damper takes D >= 0 and |work| <= |change of kp dq^2 / 2| + D, so that
 *
 *   H1 - H0 <= -D + a (H0 + H1 + D) <= a (H0 + H1),   H_n <= ((1 + a) / (1 - a))^n H_0.
 *
 * For 40 steps the energy created is at most 10.04 H_0. Steps that were subdivided count as their
 * parts; theirs, and those of servos with a limit, are measured: at most 3 H_0 in 1e6 cases of each
 * method. */
#define STEP_SHARE 0.03
enum { LONG_RUN = 40 };
#define MOST_CREATED 10.04

/* Share of the cases of a group that may fail, and whose stored states may break a contact law by
 * more than 1e-6: measured, with room; see the figures that the test prints. */
static const struct {
    const char *name;
    double failed, broken, created;
} groups[] = {{"servo", 0.03, 0.008, MOST_CREATED},
              {"servo with a torque limit", 0.01, 0.015, MOST_CREATED},
              {"matrix of gains", 0.22, 0.02, INFINITY}}; /* these do work without bounds */
enum { SERVO, LIMITED, MATRIX, GROUPS };

static double logarithmic(uint64_t *random, double low, double high)
{
    return exp(uniform(random, log(low), log(high)));
}
static bool chance(uint64_t *random, double share)
{
    return uniform(random, 0, 1) < share;
}

/* A robot of any shape and posture whose trunk is above the ground, its lower foot on it or up to
 * a metre above it. */
static void wild_start(uint64_t *random, stance_case *c)
{
    double gap[2];
    do {
        for (int i = 0; i < 2; i++)
            c->robot[i] = uniform(random, 0.2, 1.5);
        for (int i = 2; i < 5; i++)
            c->robot[i] = logarithmic(random, 0.1, 30);
        c->contacts = chance(random, 0.7) ? 3 : chance(random, 0.5) ? 1 : 2;
        memset(c->position, 0, sizeof c->position);
        for (int i = 2; i < 5; i++)
            c->position[i] = uniform(random, -3, 3);
        biped()->gaps(biped(), c->robot, c->position, gap);
        const double lowest =
            fmin(c->contacts & 1 ? gap[0] : INFINITY, c->contacts & 2 ? gap[1] : INFINITY);
        c->position[1] = (chance(random, 0.5) ? 0 : uniform(random, 0, 1)) - lowest;
    } while (c->position[1] <= 0);
    for (int i = 0; i < 5; i++)
        c->velocity[i] = uniform(random, -4, 4);
}

/* Friction 0 ... 5, steps up to 0.1 s, gains up to 1e6 that act inside the steps: a servo, or full
 * matrices of either sign, which need not be stable. One case in four is a single step. *stored is
 * what a servo holds at the start, J. */
static stance_case wild_case(uint64_t *random, int *group, double *stored)
{
    stance_case c = plain_case();
    wild_start(random, &c);
    c.friction = chance(random, 0.1) ? 0 : uniform(random, 0, 5);
    const double kp = logarithmic(random, 1e-2, 1e6), kd = logarithmic(random, 1e-3, 1e6);
    const bool servo = chance(random, 0.67), limited = chance(random, 0.5);
    *group = !servo ? MATRIX : limited ? LIMITED : SERVO;
    c.torque_limit = limited ? logarithmic(random, 1, 1e3) : INFINITY;
    *stored = 0;
    for (int i = 0; i < 2; i++) {
        const double off = uniform(random, -0.5, 0.5);
        c.near.target[1 + i] = c.position[3 + i] + off;
        *stored += 0.5 * kp * off * off;
        for (int j = 0; j < 6 && !servo; j++)
            c.near.gain[i][j] = logarithmic(random, 1e-2, 1e6) * (chance(random, 0.5) ? -1 : 1);
        if (servo)
            c.near.gain[i][1 + i] = kp, c.near.gain[i][4 + i] = kd;
    }
    c.robot[STANCE_ROBOT_FALL_HEIGHT] = -1e15;
    c.step = logarithmic(random, 1e-4, 0.1);
    c.steps = chance(random, 0.25) ? 1 : LONG_RUN;
    return c;
}

static double kinetic(const stance_case *c, const double *position, const double *velocity)
{
    static const double rest[STANCE_MAX_COORDINATES];
    return biped()->energy(biped(), c->robot, position, velocity) -
           biped()->energy(biped(), c->robot, position, rest);
}

/* Energy at the start above the lowest that there is: a foot on the ground, all else below it. */
static double start_energy(const stance_case *c, double stored)
{
    const double leg = c->robot[0], trunk = c->robot[1];
    const double lowest = STANCE_GRAVITY * (c->robot[2] * (c->contacts == 3 ? 0 : 2 * leg) +
                                            c->robot[3] * (leg + trunk) + c->robot[4] * leg);
    return biped()->energy(biped(), c->robot, c->position, c->velocity) + lowest + stored;
}

static bool is_finite(const stance_result *r)
{
    double sum = r->energy_gain + r->max_penetration + r->slip_distance + r->peak_torque +
                 r->signorini_residual + r->coulomb_residual + r->dissipation_residual;
    for (int i = 0; i < 5; i++)
        sum += r->position[i] + r->velocity[i];
    return isfinite(sum);
}

/* What a single step created is what core/implicit/step.h admits. Where there is a gain the work
 * done is what the energies tell. */
static void check_single_step(const stance_case *c, const stance_result *r)
{
    const double before = biped()->energy(biped(), c->robot, c->position, c->velocity);
    const double after = biped()->energy(biped(), c->robot, r->position, r->velocity);
    if (r->energy_gain <= 0 || r->steps != 1 || r->subdivided_steps > 0)
        return;
    const double work = after - before - r->energy_gain;
    const double admitted = STEP_SHARE * (kinetic(c, c->position, c->velocity) +
                                          kinetic(c, r->position, r->velocity) + fabs(work)) +
                            1e-8 * (fabs(before) + fabs(after)) + 1e-9;
    if (r->energy_gain > admitted)
        fail_msg("a step created %g J, admitted are %g J", r->energy_gain, admitted);
}

struct tally {
    int64_t cases, failed, reason[16], subdivided, broken, n;
    double *created; /* [n] of the cases that are done */
    double penetration, residual;
};

static void tally_add(struct tally *t, const stance_case *c, const stance_result *r, double stored)
{
    t->cases++;
    if (r->status == STANCE_FAILED) {
        assert_in_range(r->failure, STANCE_FAILURE_NONE + 1, STANCE_FAILURE_WORK);
        t->failed++;
        t->reason[r->failure]++;
        return;
    }
    assert_int_equal(r->status, STANCE_DONE);
    assert_true(is_finite(r));
    check_single_step(c, r);
    const double residual =
        fmax(r->signorini_residual, fmax(r->coulomb_residual, r->dissipation_residual));
    t->subdivided += r->subdivided_steps > 0;
    t->broken += residual > 1e-6;
    t->residual = fmax(t->residual, residual);
    t->penetration = fmax(t->penetration, r->max_penetration);
    t->created[t->n++] = r->energy_gain / start_energy(c, stored);
}

static void report(struct tally *t, const char *method, const char *name)
{
    static const char *const reasons[] = {
#define REASON(NAME, name, text) #name,
        STANCE_FAILURES(REASON)
#undef REASON
    };
    print_message("# %s, %s: %lld cases, %lld subdivided, %lld broke a law (largest %.1e), "
                  "%lld failed:",
                  method, name, (long long)t->cases, (long long)t->subdivided, (long long)t->broken,
                  t->residual, (long long)t->failed);
    for (size_t k = 0; k < COUNT(reasons); k++)
        if (t->reason[k] > 0)
            print_message(" %s %lld", reasons[k], (long long)t->reason[k]);
    statistics_sort(t->created, (size_t)t->n);
    print_message("\n#   energy created, of what there was: median %.2g, 90 %% %.2g, 99 %% %.2g, "
                  "99.9 %% %.2g, largest %.2g; penetration %.1e m\n",
                  t->created[t->n / 2], t->created[t->n * 9 / 10], t->created[t->n * 99 / 100],
                  t->created[t->n * 999 / 1000], t->created[t->n - 1], t->penetration);
}

static void run_wild(const char *method, int batches, struct tally tally[GROUPS])
{
    enum { BATCH = 1000 };
    static stance_case c[BATCH];
    static stance_result r[BATCH];
    double stored[BATCH];
    int group[BATCH];
    uint64_t random = 2026;
    for (int g = 0; g < GROUPS; g++) {
        tally[g] = (struct tally){.created = calloc((size_t)batches * BATCH, sizeof(double))};
        assert_non_null(tally[g].created);
    }
    for (int b = 0; b < batches; b++) {
        for (int i = 0; i < BATCH; i++)
            c[i] = wild_case(&random, &group[i], &stored[i]);
        run_cases(kernel_of(method, NULL), c, r, BATCH);
        for (int i = 0; i < BATCH; i++)
            tally_add(&tally[group[i]], &c[i], &r[i], stored[i]);
    }
}

TEST(implicit_steps)
{
    static const char *const methods[] = {"implicit", "midpoint"};
    const int batches = long_tests() ? 1000 : 5;
    for (int m = 0; m < 2; m++) {
        struct tally tally[GROUPS];
        run_wild(methods[m], batches, tally);
        for (int g = 0; g < GROUPS; g++) {
            struct tally *t = &tally[g];
            report(t, methods[m], groups[g].name);
            assert_true((double)t->failed < groups[g].failed * (double)t->cases);
            assert_true((double)t->broken < groups[g].broken * (double)t->cases);
            assert_true(t->created[t->n - 1] < groups[g].created);
            assert_true(t->penetration < 1e-12);
            free(t->created);
        }
    }
}

/* Feet of grams on legs of millimetres under a damper that its limit of 8 N m cuts off: motions of
 * microseconds and less, on and on. */
static stance_case endless_case(double damping)
{
    static const double robot[] = {0.003, 62.5, 0.0044, 0.0023, 2};
    stance_case c = plain_case();
    memcpy(c.robot, robot, sizeof robot);
    c.position[1] = 62.51, c.position[2] = 0.02, c.position[3] = 0.011, c.position[4] = -0.106;
    c.velocity[3] = 0.028, c.velocity[4] = 0.295;
    hold_legs(&c, 65, damping);
    c.near.target[1] += 0.017, c.near.target[2] += 0.0055;
    c.torque_limit = 8;
    c.friction = 0, c.robot[STANCE_ROBOT_FALL_HEIGHT] = 0;
    c.tolerance = 1e-4;
    c.steps = 300;
    return c;
}

/* However hard a case is, it ends, and says why: by the attempts of one step, or by the sum of its
 * evaluations, 1e7 and 1e3 a step. Without these bounds this test would not end. */
TEST(work_is_bounded)
{
    static const char *const methods[] = {"event-driven", "lagrange", "implicit", "midpoint"};
    stance_case c = endless_case(4.7e6);
    stance_result r = run_one("capturing", &c);
    assert_true(r.status == STANCE_FAILED && r.failure == STANCE_FAILURE_WORK && r.steps == 0);
    for (int m = 0; m < 4; m++) /* they pass it, or say one of their reasons */
        run_one(methods[m], &c);
    c = endless_case(1.12);
    r = run_one("capturing", &c);
    assert_true(r.status == STANCE_FAILED && r.failure == STANCE_FAILURE_WORK);
    assert_true(r.steps > 100 && (double)r.evaluations > 9e6 && (double)r.evaluations < 1.1e7);
}

/* Landings in steps of 10 ms: what is left of a velocity that the law forbids, of the stored state.
 */
TEST(little_is_left_after_landings)
{
    static const char *const methods[] = {"implicit", "midpoint"};
    const int count = long_tests() ? 100000 : 20000;
    for (int m = 0; m < 2; m++) {
        uint64_t seed = 21;
        int above = 0;
        double largest = 0;
        for (int i = 0; i < count; i++) {
            stance_case c;
            random_case(&seed, i, 1e-2, &c);
            c.restitution = 0;
            const stance_result r = run_one(methods[m], &c);
            if (r.status == STANCE_DONE) {
                above += r.signorini_residual > 1e-3;
                largest = fmax(largest, r.signorini_residual);
            }
        }
        print_message("## %s, 10 ms: above 1 mm/s in %d of %d, at most %.2g m/s\n", methods[m],
                      above, count, largest);
        assert_true(above < count / 1000);
    }
}
