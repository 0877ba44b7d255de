/* The decoupling law: every pair of coordinates follows the error dynamics that it promises, in
 * flight and on a foot; singular postures, torque limits, delays, switching; lanes. */
#include "support.h"

enum { PAIRS = 10, HORIZON = 20 };

/* Postures (theta, q1, q2) from which a pair is tracked for HORIZON steps of 10 ms without coming
 * near a singular posture, in flight, and with foot 1 on the ground; NAN: none is known. */
static const double flight[PAIRS][3] = {
    {1.489, -1.580, 1.490},  {1.077, -1.261, 1.554},  {0.641, -1.460, 1.593},
    {-0.697, -1.556, 1.518}, {1.475, 1.580, 0.561},   {1.497, -1.508, 1.445},
    {-1.485, -1.376, 1.005}, {-0.702, -1.596, 0.774}, {0.894, -0.590, 1.596},
    {1.068, 1.100, -1.600},
};
static const double standing[PAIRS][3] = {
    {-0.689, 0.662, -1.486}, {-0.689, 0.662, -1.486}, {-0.729, 0.783, -1.225},
    {-0.354, -0.750, 1.482}, {NAN, NAN, NAN},         {-0.689, 0.662, -1.486},
    {-0.689, 0.662, -1.486}, {-0.468, 0.686, -1.502}, {-0.660, -0.190, -0.295},
    {-0.662, 0.376, 1.229},
};

/* Continuous, no torque limit; set-points 5 cm or 0.05 rad away that move. */
static stance_case pair_case(int pair, const double *posture, bool stands, double ki)
{
    static const double rates[5] = {0.1, 0.05, 0.1, -0.2, 0.15};
    stance_case c = plain_case();
    int controlled[2];
    c.decouples = true;
    c.contacts = stands;
    c.friction = 50;
    c.supports = stands;
    c.robot[STANCE_ROBOT_FALL_HEIGHT] = -1e9;
    c.step = 0.01;
    c.steps = HORIZON;
    c.position[1] = 3;
    memcpy(&c.position[2], posture, 3 * sizeof *posture);
    memcpy(c.velocity, rates, sizeof rates);
    if (stands)
        biped()->stand(biped(), c.robot, 1, c.position, c.velocity);
    assert_true(stance_selection(biped(), pair, controlled));
    for (int i = 0; i < 2; i++) {
        const double setpoint = c.position[controlled[i]] + (i ? -0.05 : 0.05);
        c.servo[i] = servo_of(controlled[i], setpoint, 0.1, 100, 12);
        c.servo[i].ki = ki;
    }
    return c;
}

/* Where the error dynamics e''' + kd e'' + kp e' + ki e = 0 (e the integral's rate; of order two
 * where ki is 0) bring a coordinate: exp of the companion matrix by scaling and squaring of its
 * Taylor series. */
static double promised(const stance_case *c, int i)
{
    const stance_servo *const s = &c->servo[i];
    const double T = c->step * (double)c->steps;
    double x[3] = {0, s->setpoint - c->position[s->coordinate],
                   s->ramp - c->velocity[s->coordinate]}; /* integral, error, its rate */
    const int parts = 1000;
    for (int k = 0; k < parts; k++) {
        const double h = T / parts;
        double term[3] = {x[0], x[1], x[2]};
        for (int n = 1; n < 12; n++) {
            const double next[3] = {term[1], term[2],
                                    -s->ki * term[0] - s->kp * term[1] - s->kd * term[2]};
            for (int j = 0; j < 3; j++) {
                term[j] = next[j] * h / n;
                x[j] += term[j];
            }
        }
    }
    return s->setpoint + s->ramp * T - x[1];
}

static double worst_error(const char *method, bool stands, double ki)
{
    double worst = 0;
    for (int pair = 0; pair < PAIRS; pair++) {
        const double *const posture = stands ? standing[pair] : flight[pair];
        if (isnan(posture[0]))
            continue;
        stance_case c = pair_case(pair, posture, stands, ki);
        c.tolerance = 1e-10;
        if (stands)
            c.steps /= 2;
        if (strcmp(method, "lagrange") == 0)
            c.step = 1e-3, c.steps *= 10;
        const stance_result r = run_done(method, &c);
        assert_int_equal(r.degraded_samples, 0);
        assert_int_equal(r.steps, c.steps);
        assert_true(!stands || r.least_normal_force > 0);
        for (int i = 0; i < 2; i++)
            worst = fmax(fabs(r.position[c.servo[i].coordinate] - promised(&c, i)), worst);
    }
    return worst;
}

TEST(pairs_follow)
{
    static const char *const methods[] = {"event-driven", "capturing", "lagrange"};
    for (int m = 0; m < 3; m++)
        for (int stands = 0; stands < 2; stands++) {
            const double pd = worst_error(methods[m], stands, 0);
            const double pid = worst_error(methods[m], stands, 300);
            print_message("# %s, %s: off the promised motion by %.1e (PD), %.1e (PID)\n",
                          methods[m], stands ? "on one foot" : "in flight", pd, pid);
            assert_true(pd < 1e-6 && pid < 1e-6);
        }
}

/* Sampled, and once a step with implicit methods, the law converges to the continuous one. */
TEST(sampling_converges)
{
    static const char *const methods[] = {"capturing", "implicit", "midpoint"};
    for (int m = 0; m < 3; m++) {
        double error[2];
        for (int fine = 0; fine < 2; fine++) {
            error[fine] = 0;
            for (int pair = 0; pair < PAIRS; pair++) {
                stance_case c = pair_case(pair, flight[pair], false, 300);
                c.step = fine ? 1e-4 : 1e-3;
                c.steps = lround(0.05 / c.step);
                c.tolerance = 1e-10;
                c.sample_every = m == 0;
                const stance_result r = run_done(methods[m], &c);
                for (int i = 0; i < 2; i++)
                    error[fine] = fmax(fabs(r.position[c.servo[i].coordinate] - promised(&c, i)),
                                       error[fine]);
            }
        }
        print_message("# %s: off by %.1e at 1 ms, %.1e at 0.1 ms\n", methods[m], error[0],
                      error[1]);
        assert_true(error[0] < 5e-3 && error[1] < 0.15 * error[0]);
    }
}

/* The robot on foot 1 in the posture of the equilibrium, at these rates, with set-points at rest.
 */
static stance_case resting_case(int pair, double friction, const double *velocity)
{
    static const double posture[3] = {-0.41, 0.570127, 0.82};
    stance_case c = pair_case(pair, posture, true, 0);
    c.friction = friction;
    memcpy(c.velocity, velocity, 5 * sizeof *velocity);
    biped()->stand(biped(), c.robot, 1, c.position, c.velocity);
    for (int i = 0; i < 2; i++) {
        c.servo[i].setpoint = c.position[c.servo[i].coordinate];
        c.servo[i].ramp = 0;
        c.servo[i].kd = 20;
    }
    return c;
}

/* How far `capturing` at two tolerances is from `event-driven`, *truth: the largest into worst. */
static void compare_methods(stance_case c, const double tolerance[2], double worst[2],
                            stance_result *truth)
{
    c.tolerance = 1e-11;
    *truth = run_done("event-driven", &c);
    for (int t = 0; t < 2; t++) {
        c.tolerance = tolerance[t];
        const stance_result r = run_done("capturing", &c);
        for (int i = 0; i < 5; i++) {
            worst[t] = fmax(fabs(r.position[i] - truth->position[i]), worst[t]);
            worst[t] = fmax(fabs(r.velocity[i] - truth->velocity[i]), worst[t]);
        }
    }
}

/* Where a foot's slip comes to rest or turns, errors go on shrinking with the tolerance: law and
 * contact mode agree about which slip is none. */
TEST(slips_turn)
{
    static const double tolerance[2] = {1e-6, 1e-9}, bound[2] = {3e-5, 3e-8};
    double worst[2] = {0, 0};
    int turned = 0;
    for (int k = 0; k < 8; k++) {
        const double velocity[5] = {0, 0, 0, -0.25 + 0.25 * k, 0};
        stance_case c = resting_case(5, 0.15, velocity); /* z and q1 */
        stance_result truth;
        c.step = 1e-3;
        c.steps = 300;
        compare_methods(c, tolerance, worst, &truth);
        turned += truth.events > 0;
    }
    print_message("# %d slips that turn: off by %.1e, %.1e\n", turned, worst[0], worst[1]);
    assert_true(turned > 5 && worst[0] < bound[0] && worst[1] < bound[1]);
}

/* Near a singular posture torques are thrown from one limit to the other inside a step: errors go
 * on shrinking with the tolerance. */
TEST(limits_turn)
{
    static const double tolerance[2] = {1e-6, 1e-8}, bound[2] = {1e-5, 1e-7};
    double worst[2] = {0, 0};
    for (int k = 0; k < 8; k++) {
        const double velocity[5] = {0, 0, -1 - 0.05 * k, 1, -2};
        stance_case c = resting_case(2, 0.5, velocity); /* x and q1 */
        stance_result truth;
        c.steps = 24;
        c.torque_limit = 10;
        c.servo[0].setpoint = 0.127954;
        compare_methods(c, tolerance, worst, &truth);
        assert_true(truth.peak_torque >= c.torque_limit);
    }
    print_message("# limits that turn: off by %.1e, %.1e\n", worst[0], worst[1]);
    assert_true(worst[0] < bound[0] && worst[1] < bound[1]);
}

/* Driven into a singular posture the law goes on with finite torques and says so; with a limit it
 * stays within it. */
TEST(singular_is_survived)
{
    for (int limited = 0; limited < 2; limited++) {
        static const double upright[3] = {0, 0, 0}; /* no torque lifts the trunk here */
        stance_case c = pair_case(0, upright, false, 0);
        c.steps = 100;
        c.sample_every = 1;
        c.tolerance = 1e-8;
        if (limited)
            c.torque_limit = 20;
        const stance_result r = run_one("capturing", &c);
        print_message("# x-z from upright, %s: %d of %d samples degraded, torque up to %.3g N m\n",
                      limited ? "20 N m" : "no limit", (int)r.degraded_samples, (int)r.steps,
                      r.peak_torque);
        assert_true(isfinite(r.peak_torque) && r.peak_torque > 0);
        assert_true(r.status == STANCE_DONE || !limited);
        assert_true(!limited || r.peak_torque <= 20);
        assert_true(r.degraded_samples > 0);
    }
}

/* Errors that cannot be driven away do not pile up: not while a torque is at its limit, and not
 * beyond the integral's own. */
TEST(integrals_are_bounded)
{
    stance_case c = pair_case(9, flight[9], false, 50);
    TRAJECTORY t = trajectory_new(601, 0.01);
    c.trajectory = &t;
    c.steps = 600;
    c.sample_every = 1;
    c.position[1] = 1000; /* long enough a fall */
    c.tolerance = 1e-8;
    c.torque_limit = 4; /* at its limit for most of the way */
    for (int i = 0; i < 2; i++) {
        c.servo[i].kp = 16, c.servo[i].kd = 8, c.servo[i].ki = 8;
        c.servo[i].ramp = 0;
        c.servo[i].setpoint = c.position[3 + i] + (i ? -1 : 1);
    }
    const stance_result r = run_one("capturing", &c);
    double beyond = 0;
    for (int k = 0; k < 601; k++)
        beyond = fmax(t.position[5 * k + 3] - c.servo[0].setpoint, beyond);
    const double settled = fabs(r.position[3] - c.servo[0].setpoint);
    print_message("# weak robot: overshoots 1 rad by %.3f, %.1e off at the end\n", beyond, settled);
    assert_true(settled < 0.02 && beyond < 0.5);
}

/* A one-sample delay: the linear loop with it loses its stability where the spectral radius of
 * [[Ad, Bd], [-K, 0]] reaches 1. */
TEST(delay_shortens)
{
    stance_case c = balance_case(1e-6, 0);
    const stance_equilibrium equilibrium = equilibrium_at(&c);
    double A[36], B[12], Ad[36], Bd[12], loop[64], re[8], im[8], low = 1e-3, high = 0.3;
    OK(biped()->linearise(biped(), c.robot, &equilibrium, A, B));
    for (int round = 0; round < 50; round++) {
        const double T = 0.5 * (low + high);
        double radius = 0;
        memset(loop, 0, sizeof loop);
        OK(stance_discretise(PLANT(6, 2, A, B), T, Ad, Bd));
        for (int i = 0; i < 6; i++) {
            for (int j = 0; j < 6; j++)
                loop[8 * i + j] = Ad[6 * i + j];
            for (int j = 0; j < 2; j++) {
                loop[8 * i + 6 + j] = Bd[2 * i + j];
                loop[8 * (6 + j) + i] = -c.near.gain[j][i];
            }
        }
        OK(stance_eigenvalues(8, loop, re, im));
        for (int i = 0; i < 8; i++)
            radius = fmax(hypot(re[i], im[i]), radius);
        *(radius < 1 ? &low : &high) = T;
    }
    c.settle = false;
    c.delay = 1;
    c.torque_limit = INFINITY;
    c.tolerance = 1e-10;
    double size[2];
    for (int side = 0; side < 2; side++) {
        c.step = low * (side ? 1.01 : 0.99);
        c.sample_every = 1;
        c.steps = 500;
        const stance_result r = run_done("capturing", &c);
        size[side] = fabs(r.position[2] - c.near.target[0]);
    }
    print_message("# with a delay T* = %.6f s; 1e-6 rad became %.1e just below, %.1e just above\n",
                  low, size[0], size[1]);
    assert_true(low < 0.13 && size[0] < 3e-6 && size[1] > 3e-6);
}

/* Inside the ellipsoid a switching law is the linear one, outside it is the other: one sample from
 * either side equals the run with that law alone. */
TEST(switching_is_either)
{
    for (int far = 0; far < 2; far++) {
        stance_case alone = balance_case(-0.02, 0), c;
        stance_result a, b;
        alone.step = 0.01, alone.steps = 1, alone.sample_every = 1, alone.tolerance = 1e-10;
        alone.settle = false;
        c = alone;
        c.switches = true;
        for (int j = 0; j < 6; j++)
            c.switch_axis[j] = far ? 0.019 : 0.021;
        memcpy(c.far.target, c.near.target, sizeof c.far.target);
        for (int i = 0; i < 2; i++)
            c.far.gain[i][1 + i] = 100, c.far.gain[i][4 + i] = 10;
        if (far) {
            memcpy(alone.near.gain, c.far.gain, sizeof alone.near.gain);
            memset(alone.near.feedforward, 0, sizeof alone.near.feedforward);
        }
        run_cases(kernel_of("capturing", NULL), &alone, &a, 1);
        run_cases(kernel_of("capturing", NULL), &c, &b, 1);
        assert_memory_equal(a.position, b.position, sizeof a.position);
        assert_memory_equal(a.velocity, b.velocity, sizeof a.velocity);
    }
}

/* A law without gains that acts all the time: a constant torque, here on legs in free fall, where
 * both turn against the trunk with the accelerations of the inertia matrix. */
TEST(constant_torque_acts)
{
    static const char *const methods[] = {"implicit", "midpoint", "capturing", "lagrange",
                                          "event-driven"};
    for (int m = 0; m < 5; m++) {
        stance_case c = plain_case();
        c.contacts = 0;
        c.position[1] = 3;
        c.step = 1e-5;
        c.steps = 10;
        c.tolerance = 1e-10;
        c.near.feedforward[0] = 1, c.near.feedforward[1] = -1;
        const stance_result r = run_done(methods[m], &c);
        /* Opposite torques on legs that hang straight: phi_i'' = +-1 / (m l^2). */
        const double l = c.robot[0], turn = 1 / (c.robot[2] * l * l);
        assert_true(r.peak_torque == 1);
        assert_true(fabs(r.velocity[3] / (turn * 1e-4) - 1) < 1e-3);
        assert_true(fabs(r.velocity[4] / (turn * 1e-4) + 1) < 1e-3);
    }
}

/* A state in which no reactions fit the torques that the law wants (found by a program of others):
 * it takes the reactions without torques, and counts it. */
TEST(missing_reactions_are_counted)
{
    static const double q[5] = {0, 1.0318272571437432, -0.23655252531852627, -0.059493821218375875,
                                -0.28928725863443333};
    static const double v[5] = {-0.5399258832462454, 0.16260795914402282, 0.062380140162429085,
                                0.9293259499276398, -0.6768644678810902};
    stance_case c = plain_case();
    memcpy(c.position, q, sizeof q);
    memcpy(c.velocity, v, sizeof v);
    c.friction = 0.6840210470230645;
    c.decouples = true;
    c.steps = c.sample_every = 1;
    c.tolerance = 1e-8;
    static const double servo[2][4] = {
        {-0.027900303337982404, -0.6985898307250517, 17.396477629613372, 0.19566017114806267},
        {-0.16441600848265628, 0.5516669716449893, 1.9723770124414375, 4.168654800320388}};
    for (int i = 0; i < 2; i++)
        c.servo[i] = servo_of(2 * i, servo[i][0], servo[i][1], servo[i][2], servo[i][3]);
    const stance_result r = run_done("capturing", &c);
    assert_true(fabs(r.peak_torque - 131.63153345) < 1e-7);
    assert_int_equal(r.degraded_samples, 1);
}

/* An integral that has brought a torque to its limit lets it go again. */
TEST(integrals_unwind)
{
    static const double posture[3] = {0, 0.3, -0.3};
    stance_case c = pair_case(9, posture, false, 1000);
    c.position[1] = 100;
    memset(c.velocity, 0, sizeof c.velocity);
    for (int i = 0; i < 2; i++) {
        c.servo[i].kp = c.servo[i].kd = c.servo[i].ramp = 0;
        c.servo[i].setpoint = i ? -0.3 : 0.5;
    }
    c.sample_every = 1;
    c.torque_limit = 2;
    c.tolerance = 1e-8;
    c.steps = 100;
    const stance_result r = run_done("capturing", &c);
    assert_true(r.velocity[3] < 0); /* it turns back; a latched torque drives it on */
}

/* The same bits alone and in every lane of every width, sampled and continuous, falling and
 * standing. */
TEST(lanes_agree)
{
    enum { WALKS = 4, N = 124 };
    static const char *const methods[] = {"implicit", "capturing", "lagrange"};
    static const double walk[3] = {0, -0.1, 1.4}, ki[WALKS] = {0, 1, 5, 7};
    stance_case cases[N];
    stance_result first[N], other[N];
    uint64_t seed = 21;
    for (int i = WALKS; i < N; i++) {
        const double posture[3] = {uniform(&seed, -1, 1), uniform(&seed, -1, 1),
                                   uniform(&seed, -1, 1)};
        cases[i] = pair_case(i % PAIRS, posture, i % 3 > 0, i % 4 ? 0 : 100);
        cases[i].sample_every = i % 5 > 0;
        cases[i].torque_limit = i % 7 ? 10 : INFINITY;
        cases[i].friction = 0.5;
        cases[i].step = 1e-3;
        cases[i].steps = 60;
        cases[i].tolerance = 1e-6;
        cases[i].delay = i % 5 > 0 && i % 2;
    }
    for (int i = 0; i < WALKS; i++) { /* some sum errors beside one that does not */
        stance_case *const c = &cases[i];
        *c = pair_case(1, walk, false, 0);
        c->contacts = 3, c->friction = 0.5;
        c->position[1] = 1.08;
        memset(c->velocity, 0, sizeof c->velocity);
        c->servo[0].ki = ki[i];
        c->torque_limit = 10;
        c->step = 1e-3, c->steps = 300, c->tolerance = 1e-8;
    }
    for (int m = 0; m < 3; m++) {
        for (int i = 0; i < N; i++)
            run_cases(kernel_of(methods[m], "scalar"), &cases[i], &first[i], 1);
        for (int rank = 0; stance_isa(rank); rank++) {
            const stance_kernel *const kernel = kernel_of(methods[m], stance_isa(rank));
            run_cases(kernel, cases, other, N);
            for (int i = 0; i < N; i++)
                assert_memory_equal(&first[i], &other[i], sizeof first[i]);
        }
    }
}
