/* The bimodal law: its torques against a program of their own, on both sides of the plane and with
 * a delay; without a push it is state feedback, to the bit; the same bits in all instruction sets,
 * whatever acts beside it. */
#include "support.h"

enum { STEPS = 300, STATES = 6 };

/* On both sides of a random plane, now and then at a limit. */
static stance_case bent_case(uint64_t *seed, int i)
{
    stance_case c = balance_case(uniform(seed, -0.1, 0.1), uniform(seed, -0.3, 0.3));
    c.bends = true;
    for (int k = 0; k < STATES; k++)
        c.bend.normal[k] = uniform(seed, -40, 40);
    for (int k = 0; k < 2; k++)
        c.bend.push[k] = uniform(seed, -3, 3);
    c.torque_limit = i % 3 ? 10 : INFINITY;
    c.sample_every = 1 + i % 3;
    c.contacts = i % 2 ? 1 : 3;
    c.steps = STEPS;
    c.settle = false;
    c.robot[STANCE_ROBOT_FALL_HEIGHT] = -1e9;
    return c;
}

/* How far beyond the plane a state is, and what is commanded there. */
static double command_at(const stance_case *c, const double *q, const double *v, double *torque)
{
    double beyond = -1;
    for (int k = 0; k < STATES; k++)
        beyond += c->bend.normal[k] * (k < 3 ? q[2 + k] - c->near.target[k] : v[k - 1]);
    for (int i = 0; i < 2; i++) {
        torque[i] = c->near.feedforward[i];
        for (int k = 0; k < STATES; k++)
            torque[i] -= c->near.gain[i][k] * (k < 3 ? q[2 + k] - c->near.target[k] : v[k - 1]);
        torque[i] -= c->bend.push[i] * fmax(0, beyond);
        torque[i] = fmax(-c->torque_limit, fmin(c->torque_limit, torque[i]));
    }
    return beyond;
}

TEST(torques_bend)
{
    static const char *const methods[] = {"midpoint", "capturing", "event-driven"};
    uint64_t seed = 5;
    int sides[2] = {0}, cut = 0;
    for (int i = 0; i < 24; i++) {
        stance_case c = bent_case(&seed, i);
        TRAJECTORY t = trajectory_new(STEPS + 1, c.step);
        stance_result r;
        c.trajectory = &t;
        c.delay = i % 4 == 3 ? 2 : 0;
        c.tolerance = 1e-6;
        run_cases(kernel_of(methods[i / 3 % 3], NULL), &c, &r, 1);
        assert_int_equal(r.status, STANCE_DONE);
        for (int64_t n = 0; n < r.steps; n++) { /* a row holds the torques of the step before */
            const int64_t sample = (n / c.sample_every - c.delay) * c.sample_every;
            if (sample < 0)
                continue;
            double wanted[2];
            sides[command_at(&c, t.position + 5 * sample, t.velocity + 5 * sample, wanted) > 0]++;
            for (int k = 0; k < 2; k++) {
                const double got = t.torque[2 * (n + 1) + k];
                if (!(fabs(got - wanted[k]) <= 1e-9 * (1 + fabs(wanted[k]))))
                    fail_msg("case %d, step %d: %.17g, not %.17g", i, (int)n, got, wanted[k]);
                cut += fabs(got) == c.torque_limit;
            }
        }
    }
    print_message("# %d torques on the target's side, %d beyond, %d cut\n", sides[0], sides[1],
                  cut);
    assert_true(sides[0] > 1000 && sides[1] > 1000 && cut > 100);
}

TEST(without_push_it_is_linear)
{
    enum { N = 64 };
    static stance_case bent[N], linear[N];
    static stance_result got[N], wanted[N];
    uint64_t seed = 6;
    for (int i = 0; i < N; i++) {
        bent[i] = bent_case(&seed, i);
        bent[i].noise = i % 5 ? 0 : 0.1;
        memset(bent[i].bend.push, 0, sizeof bent[i].bend.push);
        linear[i] = bent[i];
        linear[i].bends = false;
    }
    run_cases(kernel_of("midpoint", NULL), bent, got, N);
    run_cases(kernel_of("midpoint", NULL), linear, wanted, N);
    assert_memory_equal(got, wanted, sizeof got);
}

/* Noise, a delay or a law that switches beside it takes another way through the loop. */
TEST(lanes_agree)
{
    enum { N = 96 };
    static const char *const methods[] = {"midpoint", "implicit", "capturing", "lagrange"};
    static stance_case cases[N];
    static stance_result first[N], other[N];
    uint64_t seed = 7;
    for (int i = 0; i < N; i++) {
        cases[i] = bent_case(&seed, i);
        cases[i].bends = i % 7 > 0;
        cases[i].noise = i % 5 ? 0 : 0.1;
        cases[i].angle_noise = i % 11 ? 0 : 0.01;
        cases[i].delay = i % 13 ? 0 : 3;
        cases[i].switches = i % 17 == 0;
        for (int k = 0; k < STATES; k++)
            cases[i].switch_axis[k] = 0.1;
        cases[i].tolerance = 1e-6;
    }
    for (size_t m = 0; m < COUNT(methods); m++) {
        for (int i = 0; i < N; i++)
            run_cases(kernel_of(methods[m], "scalar"), &cases[i], &first[i], 1);
        for (int rank = 0; stance_isa(rank); rank++) {
            run_cases(kernel_of(methods[m], stance_isa(rank)), cases, other, N);
            for (int i = 0; i < N; i++)
                assert_memory_equal(&first[i], &other[i], sizeof first[i]);
        }
    }
}
