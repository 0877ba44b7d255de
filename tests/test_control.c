/* The biped's statics and linearisation, and the control design, against tests/reference/
 * control.json (other equations, other libraries: see control.py), closed formulas and the figures
 * that were published for the default robot. */
#include "linear.h"

#define REFERENCE "tests/reference/control.json"

static const double PAPER_POLES[6] = {-3, -3.3, -3.6, -3.9, -4.2, -4.6};
static const double DEFAULT_ROBOT[STANCE_MAX_ROBOT] = {
    0.535, 0.535, 1.8, 1.8, 5.4, [STANCE_ROBOT_GRAVITY] = STANCE_GRAVITY};

/* Robust gains K[m][n] for these poles. */
static stance_robustness place(const stance_plant *plant, const stance_poles *poles, double *K)
{
    stance_robustness got;
    stance_message message = {""};
    if (stance_place(STANCE_ROBUST, plant, 0, poles, K, &got, &message) != STANCE_OK)
        fail_msg("%d states, %d inputs: %s", plant->states, plant->inputs, message.text);
    return got;
}

static int rank_of(const stance_plant *plant, double *sv)
{
    int rank;
    OK(stance_kalman(plant, sv, &rank));
    return rank;
}

static double critical(const stance_plant *plant, const double *K, double longest)
{
    double T;
    OK(stance_critical_sample_time(plant, SAMPLING(K, 0, 0), longest, &T));
    return T;
}

/* The default robot on foot 1 in the posture of the paper: its equilibrium and what is linear. */
static stance_equilibrium paper_plant(double A[36], double B[12])
{
    const stance_equilibrium e = equilibrium_of(DEFAULT_ROBOT, 0, -0.41, NAN, 0.82, false);
    OK(biped()->linearise(biped(), DEFAULT_ROBOT, &e, A, B));
    return e;
}

/* Eigenvalues that are multiple (right angle) move by the root of a rounding error. */
static double eigenvalue_tolerance(const char *name)
{
    return strcmp(name, "right angle") == 0 ? 1e-3 : 1e-9;
}

static void compare_design(const json_t *record, const char *name, const double *A, const double *B)
{
    double K[12], wanted[12], loop[36], re[6], im[6];

    poles_of(record, "poles", re, im);
    matrix_of(record, "gain", 2, 6, wanted);
    const stance_robustness got = place(PLANT(6, 2, A, B), POLES(re, im), K);
    closed_loop(6, 2, A, B, K, loop);
    assert_eigenvalues(6, loop, re, im, 1e-7, name);
    const double reference = number_in(record, "condition");
    assert_near(got.condition, reference, 1e-5 * reference, "condition number");
    if (!json_is_true(json_object_get(record, "compare_gain")))
        return;
    assert_matrix(12, K, wanted, 1e-5, name);
    const double T = number_in(record, "critical_sample_time");
    assert_near(critical(PLANT(6, 2, A, B), K, 5), T, 1e-6 * T, "critical sample time");
    assert_near(critical(PLANT(6, 2, A, B), wanted, 5), T, 1e-9 * T, "... of the reference's gain");
}

static void compare_case(const json_t *record)
{
    const char *name = json_string_value(json_object_get(record, "name"));
    const int support = (int)json_integer_value(json_object_get(record, "support"));
    double robot[STANCE_MAX_ROBOT] = {[STANCE_ROBOT_GRAVITY] = STANCE_GRAVITY}, given[3],
           position[5], torque[2], wanted_A[36], wanted_B[12], re[6], im[6], A[36], B[12], sv[6];

    matrix_of(record, "robot", 5, 1, robot);
    matrix_of(record, "given", 3, 1, given);
    matrix_of(record, "position", 5, 1, position);
    matrix_of(record, "torque", 2, 1, torque);
    matrix_of(record, "A", 6, 6, wanted_A);
    matrix_of(record, "B", 6, 2, wanted_B);
    poles_of(record, "eigenvalues", re, im);
    const stance_equilibrium e = equilibrium_of(robot, support, given[0], given[1], given[2],
                                                json_is_true(json_object_get(record, "lower")));
    assert_int_equal(e.supports, 1u << support);
    for (int i = 0; i < 5; i++)
        assert_near(e.position[i], position[i], 1e-12, name);
    assert_matrix(2, e.torque, torque, 1e-12, name);

    OK(biped()->linearise(biped(), robot, &e, A, B));
    assert_matrix(36, A, wanted_A, 1e-12, name);
    assert_matrix(12, B, wanted_B, 1e-12, name);
    assert_eigenvalues(6, A, re, im, eigenvalue_tolerance(name), name);
    assert_int_equal(rank_of(PLANT(6, 2, A, B), sv),
                     json_integer_value(json_object_get(record, "rank")));
    compare_design(record, name, A, B);
}

TEST(reference_cases)
{
    JSON *root = reference_load(REFERENCE);
    const json_t *cases = json_object_get(root, "cases");
    size_t i;
    json_t *record;
    assert_true(json_array_size(cases) >= 12);
    json_array_foreach(cases, i, record)
    {
        compare_case(record);
    }
}

/* What is known of the default robot on one foot, to the digits known. */
TEST(published_figures)
{
    const double open_re[6] = {-5.616145, 5.616145, -3.601149, 3.601149, 0, 0};
    const double open_im[6] = {0, 0, 0, 0, 4.320429, -4.320429};
    const double gain[12] = {318.97,  308.17,  -43.08, 83.55,  71.79,  -7.38,
                             -277.81, -257.34, 35.56,  -73.42, -61.87, 6.96};
    const double zero[6] = {0};
    double A[36], B[12], K[12], gaps[2];

    const stance_equilibrium e = paper_plant(A, B);
    assert_near(e.position[3], 0.570127, 5e-7, "q1");
    assert_near(e.torque[0], -7.53135, 5e-6, "torque 1");
    assert_near(e.torque[1], 3.76567, 5e-6, "torque 2");
    biped()->gaps(biped(), DEFAULT_ROBOT, e.position, gaps);
    assert_near(gaps[1], 0.0375, 5e-5, "gap of the free foot");
    assert_eigenvalues(6, A, open_re, open_im, 1e-6, "open loop");
    place(PLANT(6, 2, A, B), POLES(PAPER_POLES, zero), K);
    for (int i = 0; i < 12; i++)
        assert_near(K[i], gain[i], 0.0051, "gain");
    assert_near(critical(PLANT(6, 2, A, B), K, 5), 0.1363, 5e-5, "critical sample time");
    const stance_equilibrium right = equilibrium_of(DEFAULT_ROBOT, 0, M_PI / 2, NAN, 0, false);
    assert_near(right.position[3], -M_PI / 2, 1e-15, "q1 at right angles");
    assert_near(right.torque[1], 1.8 * 0.535 * STANCE_GRAVITY, 1e-12, "torque at right angles");
}

/* ---- the scene ------------------------------------------------------------------------------- */

/* Every branch of every unknown balances: no moment about the foot, by the stick figure's own
 * points; and the torques obey the paper's (20) ... (22). */
TEST(equilibria_balance)
{
    uint64_t seed = 7;
    int found = 0;
    for (int i = 0; i < 2000; i++) {
        const double robot[STANCE_MAX_ROBOT] = {
            uniform(&seed, 0.2, 1), uniform(&seed, 0.2, 1),
            uniform(&seed, 0.5, 3), uniform(&seed, 0.5, 3),
            uniform(&seed, 0.5, 6), [STANCE_ROBOT_GRAVITY] = STANCE_GRAVITY};
        stance_equilibrium_choice choice = {
            1u << i % 2,
            {uniform(&seed, -2, 2), uniform(&seed, -2, 2), uniform(&seed, -2, 2)},
            i / 2 % 2};
        choice.posture[i / 4 % 3] = NAN;
        stance_equilibrium e;
        double points[STANCE_MAX_POINTS][2];
        if (biped()->equilibrium(biped(), robot, &choice, &e, NULL) != STANCE_OK)
            continue;
        found++;
        assert_int_equal(biped()->figure(biped(), robot, e.position, points), 7);
        const double *feet[2] = {points[3], points[5]}, *trunk = points[1], *hip = points[0];
        const double moment =
            robot[2] * (feet[0][0] + feet[1][0]) + robot[3] * trunk[0] + robot[4] * hip[0];
        assert_near(moment, 0, 1e-13 * 12, "moment about the foot");
        const double *q = e.position;
        const int s = i % 2, f = 1 - s;
        assert_near(feet[s][0], 0, 1e-15, "foot");
        assert_near(e.torque[0] + e.torque[1], robot[1] * robot[3] * STANCE_GRAVITY * sin(q[2]),
                    1e-12 * 300, "(20)");
        assert_near(e.torque[s],
                    -robot[0] * (robot[2] + robot[3] + robot[4]) * STANCE_GRAVITY *
                        sin(q[2] + q[3 + s]),
                    1e-12 * 300, "(21)");
        assert_near(e.torque[f], robot[0] * robot[2] * STANCE_GRAVITY * sin(q[2] + q[3 + f]),
                    1e-12 * 300, "(22)");
        /* The branch: of the solved-for leg, or of all bodies where theta was sought. */
        const int unknown = i / 4 % 3;
        const double up = unknown == 0 ? cos(q[2]) + cos(q[2] + q[3]) + cos(q[2] + q[4])
                                       : cos(q[2] + q[2 + unknown]);
        assert_true(choice.branch ? up <= 1e-12 : up >= -1e-12);
    }
    assert_true(found > 800);
}

TEST(standing_is_exact)
{
    uint64_t seed = 3;
    for (int i = 0; i < 20000; i++) {
        const double robot[STANCE_MAX_ROBOT] = {exp(uniform(&seed, -3, 3)),
                                                exp(uniform(&seed, -3, 3)),
                                                1,
                                                1,
                                                1,
                                                [STANCE_ROBOT_GRAVITY] = STANCE_GRAVITY};
        double q[5] = {9, 9}, v[5] = {9, 9}, gap[2], at[2], speed[2];
        for (int k = 2; k < 5; k++) {
            q[k] = uniform(&seed, -4, 4);
            v[k] = uniform(&seed, -4, 4);
        }
        biped()->stand(biped(), robot, 1u << (i % 2), q, v);
        biped()->gaps(biped(), robot, q, gap);
        biped()->contact_point(biped(), robot, q, v, i % 2, at, speed);
        assert_true(gap[i % 2] >= 0 && gap[i % 2] <= 1e-15 * (robot[0] + robot[1]));
        assert_true(gap[i % 2] == at[1]);
        assert_near(at[0], 0, 1e-15 * (robot[0] + robot[1]), "x of the foot");
        assert_near(speed[0], 0, 1e-13 * (robot[0] + robot[1]), "vx of the foot");
        assert_near(speed[1], 0, 1e-13 * (robot[0] + robot[1]), "vz of the foot");
    }
    /* Feet level with the trunk: the height is zero but for rounding. */
    double q[5] = {0, 0, M_PI / 2, 0, 0}, v[5] = {0}, gap[2];
    biped()->stand(biped(), DEFAULT_ROBOT, 1, q, v);
    biped()->gaps(biped(), DEFAULT_ROBOT, q, gap);
    assert_true(gap[0] >= 0 && gap[0] < 1e-15);
}

TEST(equilibrium_messages)
{
    const double heavy_trunk[STANCE_MAX_ROBOT] = {
        0.4, 0.6, 1, 9, 1, [STANCE_ROBOT_GRAVITY] = STANCE_GRAVITY};
    const struct {
        const double *robot;
        stance_equilibrium_choice choice;
        stance_error error;
        const char *text;
    } wrong[] = {
        {heavy_trunk,
         {1, {1.2, NAN, -2.7}, 0},
         STANCE_NO_EQUILIBRIUM,
         "there is no such posture: the weight cannot be carried"},
        {DEFAULT_ROBOT,
         {1, {-0.41, 0.82, NAN}, 0},
         STANCE_NO_EQUILIBRIUM,
         "there is no such posture: theta cannot be balanced: 4.09 N m are left on it"},
        {DEFAULT_ROBOT,
         {1, {-0.41, NAN, NAN}, 0},
         STANCE_OK,
         "the equilibrium is free by 1 coordinate: the least torques are taken"},
        {DEFAULT_ROBOT,
         {1, {-0.41, 0.57, 0.82}, 0},
         STANCE_NO_EQUILIBRIUM,
         "the conditions on the equilibrium contradict each other: theta cannot be balanced: "
         "-0.00421 N m are left on it"},
        {DEFAULT_ROBOT,
         {4, {-0.41, NAN, 0.82}, 0},
         STANCE_BAD_ARGUMENT,
         "an equilibrium stands on some of 2 contacts"},
        {DEFAULT_ROBOT,
         {1, {-0.41, NAN, 0.82}, 2},
         STANCE_NO_EQUILIBRIUM,
         "there is no branch 2 of the equilibrium: 2 found, counted from 0"},
        {DEFAULT_ROBOT,
         {1, {-0.41, NAN, INFINITY}, 0},
         STANCE_BAD_ARGUMENT,
         "an equilibrium's q2 must lie within +-1000"},
    };
    for (size_t i = 0; i < COUNT(wrong); i++) {
        stance_equilibrium e;
        stance_message message = {""};
        assert_int_equal(
            biped()->equilibrium(biped(), wrong[i].robot, &wrong[i].choice, &e, &message),
            wrong[i].error);
        assert_text(message.text, wrong[i].text);
        assert_int_equal(biped()->equilibrium(biped(), wrong[i].robot, &wrong[i].choice, &e, NULL),
                         wrong[i].error);
    }
    /* Support leg turned round, free leg in line with the trunk: where mt lt = (M - m) l + m l any
     * pitch balances, elsewhere there is one. */
    const double even[STANCE_MAX_ROBOT] = {0.5, 1.5, 1, 1, 1, [STANCE_ROBOT_GRAVITY] = 9.81};
    const stance_equilibrium_choice any = {1, {NAN, M_PI, 0}, 0};
    stance_equilibrium e;
    stance_message message = {""};
    OK(biped()->equilibrium(biped(), even, &any, &e, &message));
    assert_int_equal(e.undetermined, 0);
    const double neutral[STANCE_MAX_ROBOT] = {0.5, 2, 1, 1, 1, [STANCE_ROBOT_GRAVITY] = 9.81};
    OK(biped()->equilibrium(biped(), neutral, &any, &e, &message));
    assert_int_equal(e.undetermined, 1);
}

/* ---- placement in general -------------------------------------------------------------------- */

/* Random systems of every shape, with repeated inputs, real poles and pairs. */
TEST(places_any_system)
{
    uint64_t seed = 11;
    for (int round = 0; round < 300; round++) {
        const int n = 1 + round % 8, m = 1 + round / 8 % (n + 1);
        double A[64], B[72], K[72], loop[64], re[8], im[8] = {0};
        for (int i = 0; i < n * n; i++)
            A[i] = uniform(&seed, -2, 2);
        for (int i = 0; i < n * m; i++)
            B[i] = uniform(&seed, -2, 2);
        for (int i = 0; i < n; i++) { /* the last input repeats the first: rank below m */
            if (m > 1 && round % 3 == 0)
                B[i * m + m - 1] = -3 * B[i * m];
            re[i] = -1 - 0.7 * i + uniform(&seed, -0.2, 0.2);
        }
        if (n >= 4 && round % 2) { /* pairs need not stand side by side */
            re[3] = re[0];
            im[0] = uniform(&seed, 0.3, 3);
            im[3] = -im[0];
        }
        if (n >= 3 && round % 5 == 0) {
            re[2] = re[1];
            im[1] = -1.5;
            im[2] = 1.5;
        }
        const stance_robustness got = place(PLANT(n, m, A, B), POLES(re, im), K);
        closed_loop(n, m, A, B, K, loop);
        assert_true(got.condition >= 1 - 1e-12);
        assert_eigenvalues(n, loop, re, im, 1e-11 * got.condition * (1 + n), "random system");
    }
}

/* One input leaves no choice: the gain of a companion form can be read off the polynomial. */
TEST(single_input)
{
    const double A[9] = {0, 1, 0, 0, 0, 1, 2, -3, 4}, B[3] = {0, 0, 2};
    const double re[3] = {-1, -2, -2}, im[3] = {0, 3, -3}; /* (s + 1)(s^2 + 4 s + 13) */
    const double wanted[3] = {(2 + 13) / 2.0, (-3 + 17) / 2.0, (4 + 5) / 2.0};
    double K[3];
    OK(stance_place(STANCE_ROBUST, PLANT(3, 1, A, B), 0, POLES(re, im), K, NULL, NULL));
    assert_matrix(3, K, wanted, 1e-12, "companion form");
}

/* As many inputs as states: the best eigenvectors are orthonormal, also for a repeated pole. */
TEST(full_inputs)
{
    const double A[9] = {1, 2, 3, 4, 5, 6, 7, 8, 10}, B[9] = {1, 0, 1, 0, 2, 0, 0, 1, 1};
    const double re[3] = {-1, -1, -1}, pair_re[3] = {-1, -2, -1}, none[3] = {0},
                 pair_im[3] = {2, 0, -2};
    const struct {
        const char *what;
        const double *re, *im;
    } poles[] = {{"triple pole", re, none}, {"pair", pair_re, pair_im}};
    for (int k = 0; k < 2; k++) {
        double K[9], loop[9];
        const stance_poles wanted = {poles[k].re, poles[k].im};
        assert_near(place(PLANT(3, 3, A, B), &wanted, K).condition, 1, 1e-9, poles[k].what);
        closed_loop(3, 3, A, B, K, loop);
        assert_eigenvalues(3, loop, wanted.re, wanted.im, 1e-12, poles[k].what);
    }
}

/* A double pole on two inputs, and the mirror rule: the stiffer of two equally robust gains, which
 * does not depend on the order of the poles. */
TEST(repeated_and_reordered)
{
    const double twice[6] = {-3, -3.3, -3, -3.9, -4.2, -4.2}, none[6] = {0};
    const double reversed[6] = {-3.9, -4.6, -3, -4.2, -3.3, -3.6};
    double A[36], B[12], K[12], other[12], loop[36];
    paper_plant(A, B);
    place(PLANT(6, 2, A, B), POLES(twice, none), K);
    closed_loop(6, 2, A, B, K, loop);
    assert_eigenvalues(6, loop, twice, none, 1e-4, "double poles");
    place(PLANT(6, 2, A, B), POLES(PAPER_POLES, none), K);
    place(PLANT(6, 2, A, B), POLES(reversed, none), other);
    assert_matrix(12, other, K, 1e-7, "poles in another order");
}

#define NO_CONJUGATE "the pole -2+1i has no conjugate -2-1i among the poles"
#define TOO_OFTEN(inputs)                                                                          \
    ", but the number of independent inputs, " inputs ", is the most that one pole can be "        \
    "repeated"
#define UNREACHED "the pair (A, B) is not controllable: no input reaches the mode with eigenvalue 2"
TEST(placement_messages)
{
    /* Two chains of integrators, lengths 2 and 1, an input each; and a mode out of reach. */
    const double A[9] = {0, 1, 0, 0, 0, 0, 0, 0, 0}, B[6] = {0, 0, 1, 0, 0, 1};
    const double endless[9] = {INFINITY}, stuck[4] = {1, 0, 0, 2}, push[2] = {1, 0},
                 nothing[2] = {0, 0};
    const stance_plant chains = {3, 2, A, B}, reached = {2, 1, stuck, push},
                       idle = {2, 1, stuck, nothing}, empty = {0, 1, A, B},
                       not_finite = {3, 2, endless, B};
    const struct {
        const stance_plant *plant;
        stance_error error;
        double re[3], im[3];
        const char *text;
    } wrong[] = {
        {&chains, STANCE_BAD_POLES, {-1, -2, -3}, {0, 1, 0}, NO_CONJUGATE},
        {&chains, STANCE_BAD_POLES, {-1, -2, -2}, {0, 1, 1}, NO_CONJUGATE},
        {&chains,
         STANCE_BAD_POLES,
         {-1, -1, -1},
         {0},
         "the pole -1 is wanted 3 times" TOO_OFTEN("2")},
        {&chains, STANCE_BAD_POLES, {-1, -2, NAN}, {0}, "3 poles are needed, all of them finite"},
        {&reached, STANCE_BAD_POLES, {-1, -1}, {0}, "the pole -1 is wanted 2 times" TOO_OFTEN("1")},
        {&reached, STANCE_UNCONTROLLABLE, {-1, -2}, {0}, UNREACHED},
        {&idle,
         STANCE_UNCONTROLLABLE,
         {-1, -2},
         {0},
         "the inputs have no effect: the matrix B is zero"},
        {&empty, STANCE_BAD_ARGUMENT, {0}, {0}, "a design needs 1 to 32 states and inputs"},
        {&not_finite, STANCE_BAD_ARGUMENT, {-1, -2, -3}, {0}, "A and B must be finite"},
    };
    for (size_t i = 0; i < COUNT(wrong); i++) {
        double K[6];
        stance_message message = {""};
        assert_int_equal(stance_place(STANCE_ROBUST, wrong[i].plant, 0,
                                      POLES(wrong[i].re, wrong[i].im), K, NULL, &message),
                         wrong[i].error);
        assert_text(message.text, wrong[i].text);
    }
}

/* Rosenbrock: chains of lengths 3 and 1 cannot have two double poles with full eigenvectors. */
TEST(spread_too_thin)
{
    const double A[16] = {0, 1, 0, 0, 0, 0, 1, 0}, B[8] = {0, 0, 0, 0, 1, 0, 0, 1};
    const double re[4] = {-1, -1, -2, -2}, im[4] = {0};
    double K[8];
    stance_message message = {""};
    assert_int_equal(
        stance_place(STANCE_ROBUST, PLANT(4, 2, A, B), 0, POLES(re, im), K, NULL, &message),
        STANCE_BAD_POLES);
    assert_true(strstr(message.text, "no independent eigenvectors") != NULL);
}

/* ---- eigenvalues, rank, sampling ------------------------------------------------------------- */

TEST(eigenvalues_are_sorted)
{
    const double A[25] = {[0] = 3, [6] = -1, [7] = 2, [11] = -2, [12] = -1, [18] = -7, [24] = -1};
    const double wanted_re[5] = {-7, -1, -1, -1, 3}, wanted_im[5] = {0, -2, 0, 2, 0};
    double re[5], im[5];
    OK(stance_eigenvalues(5, A, re, im));
    for (int i = 0; i < 5; i++) {
        assert_near(re[i], wanted_re[i], 1e-14, "real part");
        assert_near(im[i], wanted_im[i], 1e-14, "imaginary part");
    }
    const double bad[1] = {NAN};
    assert_int_equal(stance_eigenvalues(1, bad, re, im), STANCE_BAD_ARGUMENT);
    assert_int_equal(stance_eigenvalues(0, A, re, im), STANCE_BAD_ARGUMENT);
}

/* The rank, and here even the singular values, do not depend on the unit of time. */
TEST(kalman_rank)
{
    const double chain[9] = {0, 1, 0, 0, 0, 1, 0, 0, 0}, last[3] = {0, 0, 1}, first[3] = {1, 0, 0};
    double A[36], B[12], sv[6], slow[6];
    paper_plant(A, B);
    assert_int_equal(rank_of(PLANT(6, 2, A, B), sv), 6);
    for (int i = 0; i < 36; i++) /* milliseconds */
        A[i] *= i / 6 >= 3 ? 1e-6 : 1;
    for (int i = 0; i < 12; i++)
        B[i] *= 1e-6;
    assert_int_equal(rank_of(PLANT(6, 2, A, B), slow), 6);
    assert_matrix(6, slow, sv, 1e-12, "singular values");
    assert_int_equal(rank_of(PLANT(3, 1, chain, last), sv), 3);
    assert_int_equal(rank_of(PLANT(3, 1, chain, first), sv), 1);
}

TEST(discretisation)
{
    const double w = 3, T = 0.7, A[9] = {0, 1, 0, -w * w, 0, 0, 0, 0, -0.5}, B[3] = {0, 1, 2};
    const double wanted_A[9] = {cos(w * T), sin(w * T) / w, 0, -w * sin(w * T), cos(w * T), 0, 0,
                                0,          exp(-0.5 * T)};
    const double wanted_B[3] = {(1 - cos(w * T)) / (w * w), sin(w * T) / w,
                                4 * (1 - exp(-0.5 * T))};
    double Ad[9], Bd[3], stiff_A[1] = {-2000}, stiff_B[1] = {3};
    OK(stance_discretise(PLANT(3, 1, A, B), T, Ad, Bd));
    assert_matrix(9, Ad, wanted_A, 2e-15, "Ad");
    assert_matrix(3, Bd, wanted_B, 2e-15, "Bd");
    OK(stance_discretise(PLANT(3, 1, A, B), 0, Ad, Bd));
    assert_true(Ad[0] == 1 && Ad[1] == 0 && Bd[1] == 0);
    OK(stance_discretise(PLANT(1, 1, stiff_A, stiff_B), 0.5, Ad, Bd));
    assert_near(Ad[0], 0, 1e-15, "stiff Ad");
    assert_near(Bd[0], 0.0015, 1e-15, "stiff Bd");
    assert_int_equal(stance_discretise(PLANT(3, 1, A, B), -1, Ad, Bd), STANCE_BAD_ARGUMENT);
    assert_int_equal(stance_discretise(PLANT(3, 1, A, B), NAN, Ad, Bd), STANCE_BAD_ARGUMENT);
}

TEST(critical_sample_times)
{
    double T;
    /* x' = a x + u, u = -k x: the sampled pole exp(a T) (1 - k / a) + k / a passes -1. */
    for (int i = 0; i < 20; i++) {
        const double a = 0.3 + 0.2 * i, k = a * (1.05 + 0.3 * i), b = 1;
        const double wanted = log((k / a + 1) / (k / a - 1)) / a;
        assert_near(critical(PLANT(1, 1, &a, &b), &k, 100), wanted, 1e-12 * wanted, "scalar");
    }
    /* Double integrator: Jury's conditions give the smaller of 2 d / k and 2 / d. */
    const double A[4] = {0, 1, 0, 0}, B[2] = {0, 1};
    for (int i = 0; i < 20; i++) {
        const double K[2] = {0.5 + 0.7 * i, 4.0 - 0.15 * i},
                     wanted = fmin(2 * K[1] / K[0], 2 / K[1]);
        assert_near(critical(PLANT(2, 1, A, B), K, 100), wanted, 1e-10 * wanted, "two integrators");
    }
    const double bad[2] = {-1, 1}, none[2] = {0}, stable[4] = {-1, 0, 0, -2};
    assert_true(critical(PLANT(2, 1, A, B), bad, 10) == 0);
    assert_true(critical(PLANT(2, 1, stable, B), none, 10) == INFINITY);
    assert_int_equal(stance_critical_sample_time(PLANT(2, 1, A, B), SAMPLING(bad, 0, 0), 0, &T),
                     STANCE_BAD_ARGUMENT);
}

/* A sampled oscillator under rate feedback becomes unstable and stable again as T passes half
 * turns; it is the first loss that counts. Looked for by brute force. */
TEST(first_crossing)
{
    uint64_t seed = 17;
    int lost = 0;
    for (int i = 0; i < 40; i++) {
        const double w = uniform(&seed, 1, 10), damping = uniform(&seed, 0, 0.4);
        const double A[4] = {0, 1, -w * w, -damping}, B[2] = {0, 1};
        const double K[2] = {0, uniform(&seed, 0.05, 1.5)};
        double first = INFINITY, Ad[4], Bd[2], loop[4], re[2], im[2];
        const double T = critical(PLANT(2, 1, A, B), K, 4);
        for (int k = 1; k <= 40000 && isinf(first); k++) {
            OK(stance_discretise(PLANT(2, 1, A, B), 1e-4 * k, Ad, Bd));
            closed_loop(2, 1, Ad, Bd, K, loop);
            OK(stance_eigenvalues(2, loop, re, im));
            if (hypot(re[0], im[0]) > 1 + 1e-12 || hypot(re[1], im[1]) > 1 + 1e-12)
                first = 1e-4 * k;
        }
        if (isinf(first)) {
            assert_true(isinf(T) || T > 4 - 1e-4);
        } else {
            lost++;
            assert_true(T <= first && T >= first - 1e-4 - 1e-9);
        }
    }
    assert_true(lost > 10);
}
