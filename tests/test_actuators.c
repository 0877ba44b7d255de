/* Actuators and sensors: torques that lag, come up at a limited rate and samples late against an
 * integration in small steps; the loop with all of it against the eigenvalues of its linear theory;
 * how noise makes it wander; limits by joint; convergence; what is said to rest. */
#include "support.h"

enum { STEPS = 400, EVERY = 4 };

/* Flies, with torques that are noise alone, so that they do not depend on the motion. */
static stance_case shaken_case(void)
{
    stance_case c = plain_case();
    c.position[1] = 100;
    c.near.feedforward[0] = 1, c.near.feedforward[1] = -2;
    c.noise = 3;
    c.torque_limit = 3;
    c.sample_every = EVERY;
    c.steps = STEPS;
    c.robot[STANCE_ROBOT_FALL_HEIGHT] = -1e9;
    c.tolerance = 1e-8;
    return c;
}

/* Torques of all steps: [step][actuator]. */
static void torques_of(const char *method, stance_case c, double (*torque)[2])
{
    TRAJECTORY t = trajectory_new(STEPS + 1, c.step);
    c.trajectory = &t;
    run_done(method, &c);
    for (int k = 0; k < STEPS; k++) /* a row holds those of the step that ends there */
        memcpy(torque[k], t.torque + 2 * (k + 1), sizeof *torque);
}

/* The mean over a step of what follows `command` at time constant and rate, in many small steps. */
static double follow(double command, double lag, double rate, double h, double *torque)
{
    enum { PARTS = 20000 };
    double sum = 0;
    if (lag == 0 && isinf(rate))
        return *torque = command;
    for (int k = 0; k < PARTS; k++) {
        const double dt = h / PARTS, off = command - *torque;
        const double most = rate * dt, exact = lag > 0 ? -off * expm1(-dt / lag) : off;
        const double change = fabs(exact) > most ? copysign(most, off) : exact;
        sum += *torque + 0.5 * change;
        *torque += change;
    }
    return sum / PARTS;
}

TEST(torques_follow)
{
    static const struct {
        int delay;
        double lag, rate;
    } of[] = {{0, 0.003, 0},   {3, 0, 0},       {0, 0, 700},      {1, 0.002, 900},
              {16, 0.02, 300}, {2, 1e-6, 1500}, {0, 0.0005, 1e9}, {5, 1e3, 2}};
    static double commanded[STEPS][2], got[STEPS][2];
    torques_of("midpoint", shaken_case(), commanded);
    assert_true(commanded[0][0] != commanded[EVERY][0] &&
                commanded[0][0] == commanded[EVERY - 1][0]);
    for (size_t k = 0; k < COUNT(of); k++)
        for (int m = 0; m < 3; m++) {
            static const char *const methods[] = {"midpoint", "capturing", "event-driven"};
            stance_case c = shaken_case();
            double torque[2] = {c.near.feedforward[0], c.near.feedforward[1]}, worst = 0;
            c.delay = of[k].delay, c.lag = of[k].lag, c.torque_rate = of[k].rate;
            torques_of(methods[m], c, got);
            for (int n = 0; n < STEPS; n++)
                for (int i = 0; i < 2; i++) {
                    const int from = n - of[k].delay * EVERY;
                    const double wanted =
                        follow(from < 0 ? c.near.feedforward[i] : commanded[from][i], of[k].lag,
                               of[k].rate > 0 ? of[k].rate : INFINITY, c.step, &torque[i]);
                    worst = fmax(worst, fabs(got[n][i] - wanted));
                }
            print_message("# delay %d, lag %g s, rate %g N m/s: off by %.1e N m\n", of[k].delay,
                          of[k].lag, of[k].rate, worst);
            assert_true(worst < 1e-8);
        }
}

TEST(limits_by_joint)
{
    static double torque[STEPS][2];
    stance_case c = shaken_case();
    double most[2] = {0};
    c.torque_limits[0] = 0.5;
    c.torque_limits[1] = 5;
    torques_of("midpoint", c, torque);
    for (int n = 0; n < STEPS; n++)
        for (int i = 0; i < 2; i++)
            most[i] = fmax(most[i], fabs(torque[n][i]));
    assert_true(most[0] == 0.5 && most[1] == 3);
}

/* ---- the linear loop ---- */

struct plant {
    double A[64], B[16], K[16];
    int n;
};
static struct plant plant_of(const stance_case *c)
{
    const stance_equilibrium equilibrium = equilibrium_at(c);
    struct plant p = {.n = 6};
    double A[36], B[12], K[12];
    get_gain(c, K);
    OK(biped()->linearise(biped(), c->robot, &equilibrium, A, B));
    if (c->lag > 0) {
        p.n = 8;
        stance_lagged(PLANT(6, 2, A, B), K, c->lag, p.A, p.B, p.K);
    } else {
        memcpy(p.A, A, sizeof A), memcpy(p.B, B, sizeof B), memcpy(p.K, K, sizeof K);
    }
    return p;
}

/* Just below the critical sample time of the loop, late and lagging, a small deviation dies out;
 * just above it grows; and only the former is said to be stabilised. */
TEST(late_loops_are_lost_where_theory_says)
{
    static const struct {
        int delay;
        double lag;
    } of[] = {{0, 0.02}, {2, 0}, {2, 0.01}, {5, 0.005}, {16, 0.001}};
    for (size_t k = 0; k < COUNT(of); k++) {
        double size[2], T;
        int outcome[2];
        stance_case c = balance_case(1e-6, 0);
        c.delay = of[k].delay, c.lag = of[k].lag;
        const struct plant p = plant_of(&c);
        OK(stance_critical_sample_time(PLANT(p.n, 2, p.A, p.B), SAMPLING(p.K, 0, c.delay), 1, &T));
        for (int side = 0; side < 2; side++) {
            c.sample_every = 16;
            c.step = T * (side ? 1.03 : 0.97) / (double)c.sample_every;
            c.steps = 16000;
            c.settle = false;
            c.torque_limit = INFINITY;
            size[side] = fabs(run_one("midpoint", &c).position[2] - c.near.target[0]);
            c.settle = true;
            outcome[side] = run_one("midpoint", &c).outcome;
        }
        print_message("# delay %d, lag %g s: T* = %.5f s; 1e-6 rad became %.1e below, %.1e above\n",
                      of[k].delay, of[k].lag, T, size[0], size[1]);
        assert_true(size[0] < 3e-7 && size[1] > 3e-6);
        assert_true(outcome[0] == STANCE_STABILISED && outcome[1] != STANCE_STABILISED);
    }
}

/* Root mean squares of the states, at the samples of a long run, against the covariance. */
TEST(noise_wanders_as_theory_says)
{
    enum { ROWS = 200000 };
    static const struct {
        int delay;
        double lag, angle, rate, torque;
    } of[] = {
        {0, 0, 1e-5, 0, 0}, {0, 0, 0, 1e-4, 0}, {0, 0, 0, 0, 1e-3}, {2, 0.01, 1e-5, 1e-4, 1e-3}};
    for (size_t k = 0; k < COUNT(of); k++) {
        stance_case c = balance_case(0, 0);
        c.delay = of[k].delay, c.lag = of[k].lag;
        c.angle_noise = of[k].angle, c.rate_noise = of[k].rate, c.noise = of[k].torque;
        c.sample_every = 4, c.step = 2.5e-3, c.steps = (int64_t)ROWS * c.sample_every;
        c.settle = false;
        const double T = c.step * (double)c.sample_every;
        double measured[8] = {0}, rms[8], sum[6] = {0};
        const struct plant p = plant_of(&c);
        for (int i = 0; i < 6; i++)
            measured[i] = (i < 3 ? c.angle_noise * c.angle_noise : c.rate_noise * c.rate_noise) / 3;
        OK(stance_sampled_wander(PLANT(p.n, 2, p.A, p.B), SAMPLING(p.K, T, (int)c.delay), measured,
                                 c.noise * c.noise / 3, rms));
        TRAJECTORY t = trajectory_new(ROWS, T);
        c.trajectory = &t;
        run_done("midpoint", &c);
        for (int64_t row = 1000; row < ROWS; row++)
            for (int i = 0; i < 3; i++) {
                const double x = t.position[5 * row + 2 + i] - c.near.target[i];
                const double v = t.velocity[5 * row + 2 + i];
                sum[i] += x * x, sum[3 + i] += v * v;
            }
        print_message("# noise %zu: simulated/predicted", k);
        for (int i = 0; i < 6; i++) {
            const double ratio = sqrt(sum[i] / (ROWS - 1000)) / rms[i];
            print_message(" %.3f", ratio);
            assert_true(ratio > 0.93 && ratio < 1.07);
        }
        print_message("\n");
    }
}

/* The plant with a lag is that of a time-varying torque: steps half as long, a quarter the error.
 */
TEST(lags_converge)
{
    double end[4][3];
    for (int k = 0; k < 4; k++) {
        stance_case c = balance_case(-0.04, 0);
        c.settle = false;
        c.lag = 0.02, c.torque_rate = 60, c.delay = 1;
        c.step = 4e-3 / (1 << k), c.sample_every = 5 << k, c.steps = 50 << k;
        const stance_result r = run_done("midpoint", &c);
        memcpy(end[k], &r.position[2], sizeof end[k]);
    }
    for (int i = 0; i < 3; i++) {
        const double first = (end[0][i] - end[1][i]) / (end[1][i] - end[2][i]);
        const double second = (end[1][i] - end[2][i]) / (end[2][i] - end[3][i]);
        print_message("# angle %d: ratios of differences %.2f, %.2f\n", i, first, second);
        assert_true(first > 3 && first < 5 && second > 3.5 && second < 4.5);
    }
}
