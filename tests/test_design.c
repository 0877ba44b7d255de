/* The linear designs - regulators, pole assignment, sampled models, Lyapunov functions - and the
 * force on the foot, against tests/reference/design.json (other equations, other libraries: see
 * design.py), closed formulas and a simulation. */
#include "linear.h"

#define REFERENCE "tests/reference/design.json"

enum { N = 6, M = 2 };

/* One record: its model and what stands in it. */
struct sample {
    const json_t *record;
    const char *name;
    double robot[STANCE_MAX_ROBOT], A[N * N], B[N * M], states[N], torques[M], T;
    stance_equilibrium equilibrium;
};

#define PLANT_OF(s) PLANT(N, M, (s)->A, (s)->B)

static double number_of(const struct sample *s, const char *key)
{
    return json_number_value(json_object_get(s->record, key));
}

static void for_each_record(void (*check)(const struct sample *s))
{
    JSON *root = reference_load(REFERENCE);
    const json_t *cases = json_object_get(root, "cases");
    assert_int_equal(json_array_size(cases), 15);
    for (size_t i = 0; i < json_array_size(cases); i++) {
        struct sample s = {.record = json_array_get(cases, i),
                           .robot = {[STANCE_ROBOT_GRAVITY] = STANCE_GRAVITY}};
        double given[3];
        s.name = json_string_value(json_object_get(s.record, "name"));
        matrix_of(s.record, "robot", 5, 1, s.robot);
        matrix_of(s.record, "given", 3, 1, given);
        matrix_of(s.record, "state_weights", N, 1, s.states);
        matrix_of(s.record, "torque_weights", M, 1, s.torques);
        s.T = number_of(&s, "sample_time");
        s.equilibrium = equilibrium_of(s.robot, (int)number_of(&s, "support"), given[0], given[1],
                                       given[2], false);
        OK(biped()->linearise(biped(), s.robot, &s.equilibrium, s.A, s.B));
        check(&s);
    }
}

/* A test of each record, s. */
#define RECORDS(name)                                                                              \
    static void check_##name(const struct sample *s);                                              \
    TEST(name)                                                                                     \
    {                                                                                              \
        for_each_record(check_##name);                                                             \
    }                                                                                              \
    static void check_##name(const struct sample *s)

static void sampled_closed_loop(const struct sample *s, const double *K, double *loop)
{
    double Ad[N * N], Bd[N * M];
    OK(stance_discretise(PLANT_OF(s), s->T, Ad, Bd));
    closed_loop(N, M, Ad, Bd, K, loop);
}

#define TRY(call, message)                                                                         \
    do {                                                                                           \
        if ((call) != STANCE_OK)                                                                   \
            fail_msg("%s: %s", s->name, (message).text);                                           \
    } while (0)

/* ---- regulators ------------------------------------------------------------------------------ */

RECORDS(regulators)
{
    double K[M * N], wanted[M * N], loop[N * N], re[N], im[N];
    stance_message message = {""};

    TRY(stance_lqr(PLANT_OF(s), 0, s->states, s->torques, K, &message), message);
    matrix_of(s->record, "gain", M, N, wanted);
    assert_matrix(M * N, K, wanted, 2e-10, s->name);
    closed_loop(N, M, s->A, s->B, K, loop);
    poles_of(s->record, "eigenvalues", re, im);
    assert_eigenvalues(N, loop, re, im, 1e-7, s->name);

    TRY(stance_lqr(PLANT_OF(s), s->T, s->states, s->torques, K, &message), message);
    matrix_of(s->record, "sampled_gain", M, N, wanted);
    assert_matrix(M * N, K, wanted, 2e-10, s->name);
    sampled_closed_loop(s, K, loop);
    poles_of(s->record, "sampled_eigenvalues", re, im);
    assert_eigenvalues(N, loop, re, im, 1e-9, s->name);
}

/* As T goes to 0 the sampled regulator tends to the continuous one, linearly. */
RECORDS(regulator_limits)
{
    double K[M * N], sampled[M * N], distance[2];
    const double T[2] = {2e-4, 1e-4};
    stance_message message = {""};
    TRY(stance_lqr(PLANT_OF(s), 0, s->states, s->torques, K, &message), message);
    for (int k = 0; k < 2; k++) {
        TRY(stance_lqr(PLANT_OF(s), T[k], s->states, s->torques, sampled, &message), message);
        distance[k] = 0;
        for (int i = 0; i < M * N; i++)
            distance[k] = fmax(distance[k], fabs(sampled[i] - K[i]));
    }
    assert_near(distance[0] / distance[1], 2, 0.1, s->name);
}

/* x' = a x + u: k = a + sqrt(a^2 + q/r); sampled, the scalar equation is a quadratic. */
TEST(scalar_regulator)
{
    const double a = 1.5, b = 1, q = 3, r = 0.5, T = 0.4, e = exp(a * T), bd = (e - 1) / a;
    double k;
    OK(stance_lqr(PLANT(1, 1, &a, &b), 0, &q, &r, &k, NULL));
    assert_near(k, a + sqrt(a * a + q / r), 1e-13, "continuous");
    /* x = e^(at) x0 + (e^(at) - 1)/a u */
    const double qd = q * (e * e - 1) / (2 * a), sd = q * ((e * e - 1) / (2 * a) - (e - 1) / a) / a,
                 rd = r * T + q * ((e * e - 1) / (2 * a) - 2 * (e - 1) / a + T) / (a * a);
    double x = 1; /* by iterating the equation, which converges */
    for (int i = 0; i < 10000; i++) {
        const double cross = sd + e * x * bd;
        x = e * e * x - cross * cross / (rd + bd * bd * x) + qd;
    }
    OK(stance_lqr(PLANT(1, 1, &a, &b), T, &q, &r, &k, NULL));
    assert_near(k, (sd + e * x * bd) / (rd + bd * bd * x), 1e-12, "sampled");
}

TEST(regulator_messages)
{
    const double A[4] = {0, 1, 0, 0}, B[2] = {0, 1}, Q[2] = {1, 1}, R = 1;
    const double escaping[4] = {2, 0, 0, -1};
    double K[2];
    stance_message message;
    assert_int_equal(stance_lqr(PLANT(2, 1, A, B), 0, (double[]){1, -1}, &R, K, &message),
                     STANCE_BAD_ARGUMENT);
    assert_text(message.text, "weight 1 of the states is -1: it must be finite and not negative");
    assert_int_equal(stance_lqr(PLANT(2, 1, A, B), 0, Q, (double[]){0}, K, &message),
                     STANCE_BAD_ARGUMENT);
    assert_text(message.text, "weight 0 of the torques is 0: it must be finite and positive");
    assert_int_equal(stance_lqr(PLANT(2, 1, A, B), -1, Q, &R, K, &message), STANCE_BAD_ARGUMENT);
    assert_text(message.text, "a design cannot sample every -1 s");
    assert_int_equal(stance_lqr(PLANT(2, 1, escaping, B), 0, Q, &R, K, &message),
                     STANCE_UNCONTROLLABLE);
    assert_text(message.text, "the system is not stabilisable: no input reaches the mode with "
                              "eigenvalue 2");
    assert_int_equal(stance_lqr(PLANT(2, 1, escaping, B), 0.5, Q, &R, K, &message),
                     STANCE_UNCONTROLLABLE);
    assert_text(message.text, "the sampled system is not stabilisable: no input reaches the mode "
                              "with eigenvalue 2.71828");
    /* Half a turn between samples: the oscillator's rate and angle look alike. */
    const double oscillator[4] = {0, 1, -4 * M_PI * M_PI, 0};
    assert_int_equal(stance_lqr(PLANT(2, 1, oscillator, B), 1, Q, &R, K, &message),
                     STANCE_UNCONTROLLABLE);
    /* Nobody sees the position drift. */
    assert_int_equal(stance_lqr(PLANT(2, 1, A, B), 0, (double[]){0, 1}, &R, K, &message),
                     STANCE_BAD_ARGUMENT);
    assert_text(message.text, "the weights of the states do not see the mode with eigenvalue 0, "
                              "which does not decay by itself");
    assert_int_equal(stance_lqr(PLANT(2, 1, A, (double[]){0, NAN}), 0, Q, &R, K, &message),
                     STANCE_BAD_ARGUMENT);
}

/* ---- poles ----------------------------------------------------------------------------------- */

RECORDS(placements)
{
    double K[M * N], loop[N * N], re[N], im[N], zre[N], zim[N];
    stance_robustness got;
    stance_message message = {""};

    poles_of(s->record, "poles", re, im);
    poles_of(s->record, "sampled_poles", zre, zim);
    TRY(stance_place(STANCE_SCHUR, PLANT_OF(s), 0, POLES(re, im), K, NULL, &message), message);
    closed_loop(N, M, s->A, s->B, K, loop);
    assert_eigenvalues(N, loop, re, im, 1e-6, s->name);
    TRY(stance_place(STANCE_SCHUR, PLANT_OF(s), s->T, POLES(re, im), K, &got, &message), message);
    sampled_closed_loop(s, K, loop);
    assert_eigenvalues(N, loop, zre, zim, 1e-8, s->name);
    assert_true(got.sweeps == 0 && isnan(got.condition));
    TRY(stance_place(STANCE_ROBUST, PLANT_OF(s), s->T, POLES(re, im), K, &got, &message), message);
    sampled_closed_loop(s, K, loop);
    assert_eigenvalues(N, loop, zre, zim, 1e-8, s->name);
    assert_true(got.sweeps > 0 && got.condition >= 1);
}

/* As T goes to 0 the gains of the sampled model tend to those of continuous time, linearly: the
 * robust ones too, which come as twins. At the right angle they are not even isolated. */
RECORDS(placement_limits)
{
    double K[M * N], sampled[M * N], re[N], im[N], distance[2];
    const double T[2] = {1e-4, 5e-5};
    stance_message message = {""};
    poles_of(s->record, "poles", re, im);
    for (int real = 0; real < 2; real++) {
        if (strstr(s->name, "right angle"))
            continue;
        TRY(stance_place(STANCE_ROBUST, PLANT_OF(s), 0, POLES(re, im), K, NULL, &message), message);
        for (int k = 0; k < 2; k++) {
            TRY(stance_place(STANCE_ROBUST, PLANT_OF(s), T[k], POLES(re, im), sampled, NULL,
                             &message),
                message);
            distance[k] = 0;
            for (int i = 0; i < M * N; i++)
                distance[k] = fmax(distance[k], fabs(sampled[i] - K[i]));
        }
        assert_near(distance[0] / distance[1], 2, 0.1, s->name);
        for (int i = 0; i < N; i++) {
            re[i] = -3 - 0.3 * i;
            im[i] = 0;
        }
    }
}

/* With one input the gain is unique: Ackermann's formula for a double integrator held over T. */
TEST(sampled_double_integrator)
{
    const double A[4] = {0, 1, 0, 0}, B[2] = {0, 1}, re[2] = {-1, -2}, im[2] = {0, 0};
    const double T[4] = {1e-6, 1e-3, 0.1, 2};
    for (int k = 0; k < 4; k++) {
        const double a = -expm1(-T[k]), b = -expm1(-2 * T[k]); /* 1 - z */
        double K[2];
        for (int how = STANCE_ROBUST; how <= STANCE_SCHUR; how++) {
            OK(stance_place(how, PLANT(2, 1, A, B), T[k], POLES(re, im), K, NULL, NULL));
            assert_near(K[0], a * b / (T[k] * T[k]), 1e-11 * fabs(K[0]), "position");
            assert_near(K[1], (a + b - a * b / 2) / T[k], 1e-11 * fabs(K[1]), "rate");
        }
    }
}

TEST(placement_messages)
{
    const double A[4] = {0, 1, 0, 0}, B[2] = {0, 1}, escaping[4] = {2, 0, 0, -1};
    const double re[2] = {-1, -2}, im[2] = {0, 0}, turn[2] = {7, -7}, odd[2] = {1, 1};
    double K[2];
    stance_message message;
    assert_int_equal(
        stance_place(STANCE_ROBUST, PLANT(2, 1, A, B), -1, POLES(re, im), K, NULL, &message),
        STANCE_BAD_ARGUMENT);
    assert_text(message.text, "a design cannot sample every -1 s");
    assert_int_equal(stance_place(STANCE_SCHUR, PLANT(2, 1, A, B), 0.5,
                                  POLES((double[]){-1, -1}, turn), K, NULL, &message),
                     STANCE_BAD_POLES);
    assert_text(message.text, "the pole -1+7i turns 0.557 times in a sample of 0.5 s: less than "
                              "half a turn can be told from its mirror image");
    assert_int_equal(
        stance_place(STANCE_SCHUR, PLANT(2, 1, A, B), 0, POLES(re, odd), K, NULL, &message),
        STANCE_BAD_POLES);
    assert_text(message.text, "the pole -1+1i has no conjugate -1-1i among the poles");
    assert_int_equal(
        stance_place(STANCE_SCHUR, PLANT(2, 1, escaping, B), 0, POLES(re, im), K, NULL, &message),
        STANCE_UNCONTROLLABLE);
    assert_text(message.text, "the pair (A, B) is not controllable: no input reaches the mode with "
                              "eigenvalue 2");
    /* More often than inputs: the Schur method does not mind. */
    OK(stance_place(STANCE_SCHUR, PLANT(2, 1, A, B), 0, POLES((double[]){-2, -2}, im), K, NULL,
                    &message));
    assert_near(K[0], 4, 1e-12, "double pole");
    assert_near(K[1], 4, 1e-12, "double pole");
}

/* What A is rounded to changes gains by no more: its eigenvalues come in pairs of opposite signs,
 * whose order is rounding's. */
TEST(schur_is_steady)
{
    const double re[N] = {-3, -3.3, -3.6, -3.9, -4.2, -4.6}, im[N] = {0};
    double robot[STANCE_MAX_ROBOT], A[N * N], B[N * M], rounded[N * N], K[2][N * M];
    uint64_t seed = 4;
    stance_message message;
    stance_robot_fallback(biped(), robot);
    const stance_equilibrium e = equilibrium_of(robot, 0, -0.41, NAN, 0.82, false);
    OK(biped()->linearise(biped(), robot, &e, A, B));
    OK(stance_place(STANCE_SCHUR, PLANT(N, M, A, B), 0, POLES(re, im), K[0], NULL, &message));
    for (int round = 0; round < 50; round++) {
        for (int i = 0; i < N * N; i++)
            rounded[i] = A[i] * (1 + uniform(&seed, -1e-15, 1e-15));
        OK(stance_place(STANCE_SCHUR, PLANT(N, M, rounded, B), 0, POLES(re, im), K[1], NULL,
                        &message));
        for (int i = 0; i < N * M; i++)
            assert_near(K[1][i], K[0][i], 1e-9, "gain");
    }
}

/* An equilibrium that no torque can hold: both legs level, the hip at the height of the foot, the
 * trunk longer than the rest is heavy. The angular momentum about the foot is then a mode of its
 * own, and torques at the hip do not reach it. */
TEST(uncontrollable_equilibrium)
{
    const double robot[STANCE_MAX_ROBOT] = {0.5, 2, 2,
                                            4,   4, [STANCE_ROBOT_GRAVITY] = STANCE_GRAVITY},
                 level = 2 * M_PI / 3;
    const double re[N] = {-3, -3.3, -3.6, -3.9, -4.2, -4.6}, im[N] = {0};
    const double ones[N] = {1, 1, 1, 1, 1, 1};
    double A[N * N], B[N * M], K[M * N], sv[N];
    int rank;
    stance_message message;
    const stance_equilibrium e = equilibrium_of(robot, 0, NAN, level, level, false);
    OK(biped()->linearise(biped(), robot, &e, A, B));
    OK(stance_kalman(PLANT(N, M, A, B), sv, &rank));
    assert_int_equal(rank, 4);
    const double rate = sqrt(9.81 * cos(M_PI / 6) / 1.75);
    char wanted[64];
    snprintf(wanted, sizeof wanted, "eigenvalue %.6g", -rate);
    assert_int_equal(
        stance_place(STANCE_ROBUST, PLANT(N, M, A, B), 0, POLES(re, im), K, NULL, &message),
        STANCE_UNCONTROLLABLE);
    assert_non_null(strstr(message.text, wanted));
    assert_int_equal(
        stance_place(STANCE_SCHUR, PLANT(N, M, A, B), 0, POLES(re, im), K, NULL, &message),
        STANCE_UNCONTROLLABLE);
    assert_non_null(strstr(message.text, wanted));
    assert_int_equal(
        stance_place(STANCE_ROBUST, PLANT(N, M, A, B), 1e-3, POLES(re, im), K, NULL, &message),
        STANCE_UNCONTROLLABLE);
    assert_int_equal(stance_lqr(PLANT(N, M, A, B), 0, ones, ones, K, &message),
                     STANCE_UNCONTROLLABLE);
    snprintf(wanted, sizeof wanted, "eigenvalue %.6g", rate);
    assert_non_null(strstr(message.text, wanted));
    assert_int_equal(stance_lqr(PLANT(N, M, A, B), 1e-3, ones, ones, K, &message),
                     STANCE_UNCONTROLLABLE);
}

/* ---- sampled loops --------------------------------------------------------------------------- */

RECORDS(critical_sample_times)
{
    static const char *const gains[2] = {"gain", "sampled_gain"};
    static const char *const keys[2] = {"critical", "sampled_critical"};
    double K[M * N], T, re[N + M], im[N + M], radius = 0;
    for (int g = 0; g < 2; g++) {
        matrix_of(s->record, gains[g], M, N, K);
        for (int delay = 0; delay < 2; delay++) {
            const double wanted = number_at(json_object_get(s->record, keys[g]), (size_t)delay);
            OK(stance_critical_sample_time(PLANT_OF(s), SAMPLING(K, 0, delay), 10, &T));
            if (isnan(wanted))
                assert_true(T == 0 || isinf(T));
            else
                assert_near(T, wanted, 1e-8 * wanted, s->name);
        }
    }
    OK(stance_sampled_loop(PLANT_OF(s), SAMPLING(K, s->T, 1), re, im));
    for (int i = 0; i < N + M; i++)
        radius = fmax(radius, hypot(re[i], im[i]));
    assert_near(radius, number_of(s, "delayed_radius"), 1e-9, s->name);
}

/* x' = u = -k x: z = 1 - kT, lost at kT = 2; a sample late, z^2 - z + kT = 0, lost at kT = 1; d
 * samples late, z^(d + 1) - z^d + kT = 0, where z = exp(i a) asks for kT = 2 sin(a / 2) at a = pi /
 * (2d + 1). */
TEST(delayed_integrator)
{
    const double a = 0, b = 1, k = 4;
    double T, re[2], im[2];
    OK(stance_critical_sample_time(PLANT(1, 1, &a, &b), SAMPLING(&k, 0, 0), 10, &T));
    assert_near(T, 0.5, 1e-14, "at once");
    OK(stance_critical_sample_time(PLANT(1, 1, &a, &b), SAMPLING(&k, 0, 1), 10, &T));
    assert_near(T, 0.25, 1e-14, "a sample late");
    OK(stance_sampled_loop(PLANT(1, 1, &a, &b), SAMPLING(&k, 0.125, 1), re, im));
    assert_near(re[0], 0.5, 1e-14, "real part");
    assert_near(im[0], -0.5, 1e-14, "imaginary part");
    assert_int_equal(stance_sampled_loop(PLANT(1, 1, &a, &b), SAMPLING(&k, 0.125, -1), re, im),
                     STANCE_BAD_ARGUMENT);
    for (int d = 0; d <= STANCE_MAX_DELAY; d++) {
        OK(stance_critical_sample_time(PLANT(1, 1, &a, &b), SAMPLING(&k, 0, d), 10, &T));
        assert_near(T, 2 * sin(M_PI / (4 * d + 2)) / k, 1e-10, "samples late");
    }
}

/* The integrator behind an actuator, lag s^2 + s + k = 0 in continuous time; and what noise of
 * variance v does to it, sampled: x+ = (1 - kT) x - kT n has the variance v kT / (2 - kT), one of a
 * command T v / (k (2 - kT)); a sample late, of x+ = x + T u, u+ = -k (x + n), by hand:
 * with g = kT the variance v g (1 + g) / ((1 - g) (2 + g)). */
TEST(integrator_with_actuator_and_noise)
{
    const double a = 0, b = 1, k = 4, T = 0.1, none = 0, v = 0.3, g = k * T;
    double A[4], B[2], K[2], loop[4], re[2], im[2], rms;
    for (double lag = 1e-3; lag < 1; lag *= 3) {
        stance_lagged(PLANT(1, 1, &a, &b), &k, lag, A, B, K);
        closed_loop(2, 1, A, B, K, loop);
        OK(stance_eigenvalues(2, loop, re, im));
        for (int i = 0; i < 2; i++) {
            assert_near(lag * (re[i] * re[i] - im[i] * im[i]) + re[i] + k, 0, 1e-9, "real");
            assert_near(im[i] * (2 * lag * re[i] + 1), 0, 1e-9, "imaginary");
        }
    }
    OK(stance_sampled_wander(PLANT(1, 1, &a, &b), SAMPLING(&k, T, 0), &v, 0, &rms));
    assert_near(rms * rms, v * g / (2 - g), 1e-14, "measured");
    OK(stance_sampled_wander(PLANT(1, 1, &a, &b), SAMPLING(&k, T, 0), &none, v, &rms));
    assert_near(rms * rms, T * v / (k * (2 - g)), 1e-14, "commanded");
    OK(stance_sampled_wander(PLANT(1, 1, &a, &b), SAMPLING(&k, T, 1), &v, 0, &rms));
    assert_near(rms * rms, v * g * (1 + g) / ((1 - g) * (2 + g)), 1e-14, "a sample late");
    assert_int_equal(stance_sampled_wander(PLANT(1, 1, &a, &b), SAMPLING(&k, 0.6, 0), &v, 0, &rms),
                     STANCE_NUMERICAL);
    assert_int_equal(stance_sampled_wander(PLANT(1, 1, &a, &b), SAMPLING(&k, 0.5, 0), &v, 0, &rms),
                     STANCE_NUMERICAL);
}

/* ---- Lyapunov functions and sublevel sets ---------------------------------------------------- */

RECORDS(lyapunov_functions)
{
    double K[M * N], loop[N * N], P[N * N], wanted[N * N], tolerance[N], weight[N];
    stance_message message = {""};
    matrix_of(s->record, "tolerances", N, 1, tolerance);
    for (int i = 0; i < N; i++)
        weight[i] = 1 / (tolerance[i] * tolerance[i]);
    matrix_of(s->record, "gain", M, N, K);
    closed_loop(N, M, s->A, s->B, K, loop);
    TRY(stance_lyapunov(N, loop, false, weight, P, &message), message);
    matrix_of(s->record, "lyapunov", N, N, wanted);
    assert_matrix(N * N, P, wanted, 2e-10, s->name);
    matrix_of(s->record, "sampled_gain", M, N, K);
    sampled_closed_loop(s, K, loop);
    TRY(stance_lyapunov(N, loop, true, weight, P, &message), message);
    matrix_of(s->record, "sampled_lyapunov", N, N, wanted);
    assert_matrix(N * N, P, wanted, 2e-10, s->name);
}

TEST(lyapunov_messages)
{
    const double weight[2] = {1, 1}, border[4] = {0, 1, -1, 0};
    double P[4];
    stance_message message;
    assert_int_equal(stance_lyapunov(2, border, false, weight, P, &message), STANCE_BAD_ARGUMENT);
    assert_text(message.text, "there is no Lyapunov function: the loop has the eigenvalue -1i "
                              "and is not stable");
    assert_int_equal(stance_lyapunov(2, border, true, weight, P, &message), STANCE_BAD_ARGUMENT);
    assert_int_equal(stance_lyapunov(2, border, false, (double[]){1, 0}, P, &message),
                     STANCE_BAD_ARGUMENT);
}

/* P = diag(1, 4), the half plane x + y <= 1: tangent where the gradients are parallel. */
TEST(sublevel_sets)
{
    const double P[4] = {1, 0, 0, 4}, a[4] = {1, 1, -1, 0}, d[2] = {1, 3};
    stance_sublevel_set set;
    OK(stance_sublevel(2, P, &(stance_bounds){2, a, d}, &set));
    assert_int_equal(set.binding, 0);
    assert_near(set.level, 0.8, 1e-15, "level");
    assert_near(set.alone[0], sqrt(0.8), 1e-15, "x");
    assert_near(set.extent[1], sqrt(0.2), 1e-15, "y");
    OK(stance_sublevel(2, P, &(stance_bounds){2, a, (double[]){1, -3}}, &set));
    assert_true(set.level == 0 && set.binding == 1 && set.extent[0] == 0);
    OK(stance_sublevel(2, P, &(stance_bounds){0, a, d}, &set));
    assert_true(isinf(set.level) && set.binding == -1);
    assert_int_equal(stance_sublevel(2, (double[]){1, 2, 2, 1}, &(stance_bounds){1, a, d}, &set),
                     STANCE_BAD_ARGUMENT);
}

/* ---- the force on the foot ------------------------------------------------------------------- */

RECORDS(forces_on_the_foot)
{
    double force[2], by_state[2 * N], by_torque[2 * M], wanted[2 * N];
    OK(biped()->contact_force(biped(), s->robot, &s->equilibrium, force, by_state, by_torque));
    matrix_of(s->record, "force", 2, 1, wanted);
    assert_near(force[0], wanted[0], 1e-12 * wanted[0], s->name);
    assert_near(wanted[1], 0, 1e-9, s->name);
    matrix_of(s->record, "by_state", 2, N, wanted);
    assert_matrix(2 * N, by_state, wanted, 1e-11, s->name);
    matrix_of(s->record, "by_torque", 2, M, wanted);
    assert_matrix(2 * M, by_torque, wanted, 1e-11, s->name);
}

/* The level of each bound, in the order of the reference. */
RECORDS(levels)
{
    double K[M * N], P[N * N], force[2], by[2 * N], by_torque[2 * M], a[7 * N], d[7];
    stance_sublevel_set set;
    const double limit = number_of(s, "torque_limit"), friction = number_of(s, "friction");
    matrix_of(s->record, "gain", M, N, K);
    matrix_of(s->record, "lyapunov", N, N, P);
    biped()->contact_force(biped(), s->robot, &s->equilibrium, force, by, by_torque);
    for (int j = 0; j < N; j++) {
        double loop[2];
        for (int c = 0; c < 2; c++)
            loop[c] = by[c * N + j] - by_torque[c * M] * K[j] - by_torque[c * M + 1] * K[N + j];
        for (int i = 0; i < M; i++) {
            a[2 * i * N + j] = -K[i * N + j];
            a[(2 * i + 1) * N + j] = K[i * N + j];
        }
        a[4 * N + j] = loop[1] - friction * loop[0];
        a[5 * N + j] = -loop[1] - friction * loop[0];
        a[6 * N + j] = -loop[0];
    }
    for (int i = 0; i < M; i++) {
        d[2 * i] = limit - s->equilibrium.torque[i];
        d[2 * i + 1] = limit + s->equilibrium.torque[i];
    }
    d[4] = d[5] = friction * force[0];
    d[6] = force[0];
    const json_t *levels = json_object_get(s->record, "levels");
    for (int k = 0; k < 7; k++) {
        const double wanted = number_at(levels, (size_t)k);
        OK(stance_sublevel(N, P, &(stance_bounds){1, a + k * N, d + k}, &set));
        if (isnan(wanted))
            assert_true(set.level > 1e6);
        else
            assert_near(set.level, wanted, 1e-8 * wanted, s->name);
    }
}

/* One short step of the simulator with both the posture and the torques off the equilibrium: the
 * force that it finds is the linear one, but for squares. */
TEST(force_in_simulation)
{
    const stance_scene *scene = stance_scene_find("biped");
    const stance_kernel *kernel = kernel_of("implicit", "scalar");
    uint64_t seed = 5;
    for (int k = 0; k < 20; k++) {
        stance_case c = plain_case();
        const stance_equilibrium e = equilibrium_of(c.robot, 0, -0.41, NAN, 0.82, false);
        double force[2], by_state[2 * N], by_torque[2 * M];
        double position[2][5], velocity[2][5], torque[2][2], gap[2][2], found[2][2][2];
        OK(scene->contact_force(scene, c.robot, &e, force, by_state, by_torque));
        memcpy(c.position, e.position, sizeof c.position);
        for (int i = 0; i < 3; i++) {
            const double off = uniform(&seed, -1e-3, 1e-3);
            c.position[2 + i] += off;
            for (int j = 0; j < 2; j++)
                force[j] += by_state[j * N + i] * off;
        }
        for (int i = 0; i < M; i++) {
            const double off = uniform(&seed, -0.05, 0.05);
            c.near.feedforward[i] = e.torque[i] + off;
            for (int j = 0; j < 2; j++)
                force[j] += by_torque[j * M + i] * off;
        }
        scene->stand(scene, c.robot, 1, c.position, c.velocity);
        c.contacts = 1;
        c.step = 1e-6;
        c.sample_every = 1;
        c.steps = 1;
        stance_trajectory trajectory = {
            1e-6, 2, &position[0][0], &velocity[0][0], &torque[0][0], &found[0][0][0], &gap[0][0]};
        c.trajectory = &trajectory;
        stance_result result;
        run_cases(kernel, &c, &result, 1);
        assert_int_equal(result.status, STANCE_DONE);
        assert_near(found[1][0][0], force[0], 5e-4, "normal force");
        assert_near(found[1][0][1], force[1], 5e-4, "tangential force");
    }
}
