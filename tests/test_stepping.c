/* The stepping core: contact laws on random states, convergence on the second drop, the stages of
 * the first drop, determinism over lanes and order, failures. References: physics.md's figures and
 * an independent event-driven program (tests/reference). */
#include "long.h"
#include "support.h"

#define PENETRATION 1e-9
#define CONE 1e-9

struct extremes {
    double penetration, cone, impact_energy, energy_of_projection;
    int failed, ambiguous, subdivided, gained;
};

static struct extremes run_random(const char *method, double h, double restitution,
                                  stance_impacts law, int n)
{
    const stance_kernel *const kernel = kernel_of(method, NULL);
    OWN stance_case *cases = calloc((size_t)n, sizeof *cases);
    OWN stance_result *results = calloc((size_t)n, sizeof *results);
    assert_non_null(cases);
    assert_non_null(results);
    uint64_t seed = 7;
    for (int i = 0; i < n; i++) {
        random_case(&seed, i, h, &cases[i]);
        cases[i].restitution = restitution;
        cases[i].impacts = law, cases[i].tolerance = 1e-8;
    }
    run_cases(kernel, cases, results, (size_t)n);
    struct extremes e = {0};
    for (int i = 0; i < n; i++) {
        const stance_result *const r = &results[i];
        e.penetration = fmax(e.penetration, r->max_penetration);
        e.cone = fmax(e.cone, r->friction_used / cases[i].friction - 1);
        e.impact_energy = fmax(e.impact_energy, r->impact_energy);
        e.energy_of_projection = fmax(e.energy_of_projection, r->projection_energy);
        e.failed += r->status != STANCE_DONE;
        e.ambiguous += r->ambiguous_steps > 0;
        e.subdivided += r->subdivided_steps > 0;
        e.gained += r->impact_energy > 1e-9;
    }
    return e;
}

TEST(contact_laws)
{
    static const double steps[] = {1e-4, 5e-4, 1e-3, 2e-3, 5e-3, 1e-2, 2e-2};
    enum { STEPS = COUNT(steps) };
    for (int k = 0; k < 2 * STEPS; k++) {
        const char *const method = k < STEPS ? "implicit" : "midpoint";
        const double h = steps[k % STEPS];
        const struct extremes e = run_random(method, h, 0, STANCE_IMPACTS_LIMITED, 10000);
        print_message("# %s h=%g: penetration %.1e, cone %.1e, impact energy %.1e, projection "
                      "%.2g J, ambiguous %d, subdivided %d of 10000\n",
                      method, h, e.penetration, e.cone, e.impact_energy, e.energy_of_projection,
                      e.ambiguous, e.subdivided);
        assert_true(e.penetration <= PENETRATION);
        assert_true(e.cone <= CONE);
        assert_true(e.impact_energy <= 1e-9);
        assert_int_equal(e.failed, 0);
    }
}

/* Newton's restitution with Coulomb friction can create energy (Kane); limited, or by Moreau's law,
 * it does not, with any method. */
TEST(restitution_creates_energy_by_newton_alone)
{
    const double e[] = {0.2, 0.5, 0.8, 1};
    int gained[4];
    for (int k = 0; k < 4; k++) {
        const struct extremes x = run_random("implicit", 1e-3, e[k], STANCE_IMPACTS_NEWTON, 2000);
        print_message("# e=%g: energy gained in %d of 2000 cases, at most %.3g J in one step\n",
                      e[k], x.gained, x.impact_energy);
        assert_int_equal(x.failed, 0);
        assert_true(x.penetration <= PENETRATION);
        gained[k] = x.gained;
    }
    assert_true(gained[3] > gained[1]); /* it does happen, and more so at e = 1 */
    const char *const methods[] = {"implicit", "midpoint", "capturing"};
    for (int m = 0; m < 3; m++)
        for (int law = STANCE_IMPACTS_LIMITED; law <= STANCE_IMPACTS_MOREAU; law += 2) {
            const struct extremes x = run_random(methods[m], 1e-3, 1, (stance_impacts)law, 500);
            print_message("# %s, %s, e=1: at most %.1e J gained in one step, %d failed\n",
                          methods[m], law ? "moreau" : "limited", x.impact_energy, x.failed);
            assert_true(x.impact_energy < 1e-8); /* 1e-12 of kinetic energies of up to some kJ */
            assert_true(x.failed <= 2);
        }
}

/* The contact forces of a trajectory obey the laws, checked from outside: gaps from the scene's
 * own kinematics, the cone and complementarity from the recorded forces. */
TEST(trajectories_obey_the_laws)
{
    const stance_kernel *const kernel = kernel_of("implicit", NULL);
    uint64_t seed = 3;
    enum { ROWS = 251 };
    for (int i = 0; i < 300; i++) {
        stance_case c;
        random_case(&seed, i, 1e-3, &c);
        TRAJECTORY t = trajectory_new(ROWS, 1e-3);
        stance_result r;
        c.trajectory = &t;
        run_cases(kernel, &c, &r, 1);
        const int last = (int)lround(r.end_time / 1e-3);
        for (int row = 1; row <= last; row++) {
            double gap[2];
            biped()->gaps(biped(), c.robot, t.position + row * 5, gap);
            for (int k = 0; k < 2; k++) {
                const double n = t.force[(row * 2 + k) * 2], s = t.force[(row * 2 + k) * 2 + 1];
                assert_true(gap[k] >= -PENETRATION);
                assert_true(n >= 0);
                assert_true(fabs(s) <= c.friction * n * (1 + CONE) + 1e-9);
                assert_true(n == 0 || gap[k] <= PENETRATION); /* what pushes touches */
            }
        }
    }
}

/* Impacts at a vanishing step against the independent exact solutions: least kinetic energy. */
TEST(impacts_against_reference)
{
    json_t *root = reference_load("tests/reference/impacts.json"), *item;
    json_t *problems = json_object_get(root, "problems");
    assert_non_null(problems);
    size_t index, checked = 0, several = 0;
    double worst = 0;
    json_array_foreach(problems, index, item)
    {
        stance_case c = plain_case();
        c.friction = number_in(item, "mu");
        c.restitution = number_in(item, "e");
        c.impacts = STANCE_IMPACTS_NEWTON;
        numbers(json_object_get(item, "q"), c.position, 5);
        numbers(json_object_get(item, "v"), c.velocity, 5);
        double gap[2], best[5];
        biped()->gaps(biped(), c.robot, c.position, gap);
        assert_true(fmin(gap[0], gap[1]) > -1e-12);
        c.step = 1e-9;
        c.steps = 1;
        c.robot[STANCE_ROBOT_FALL_HEIGHT] = -1e9;
        const stance_result r = run_done("implicit", &c);
        numbers(json_object_get(item, "v_plus"), best, 5);
        double error = 0, scale = 1;
        for (int i = 0; i < 5; i++) {
            error = fmax(error, fabs(r.velocity[i] - best[i]));
            scale = fmax(scale, fabs(best[i]));
        }
        if (error > 1e-6 * scale)
            print_message("# problem %zu: off by %g\n", index, error);
        worst = fmax(worst, error / scale);
        const bool ambiguous = json_integer_value(json_object_get(item, "distinct")) > 1;
        several += ambiguous;
        assert_int_equal(r.ambiguous_steps, ambiguous);
        checked++;
    }
    print_message("# %zu impacts (%zu with several solutions), largest relative difference %.2g\n",
                  checked, several, worst);
    assert_true(checked >= 300);
    assert_true(worst < 1e-6);
    json_decref(root);
}

/* ---- the second drop of physics.md section 5 ------------------------------------------------ */

enum { DROP_ROWS = 1201 };

struct drop_error {
    double at04, at12, velocity_l1, touch1, touch2;
};

static struct drop_error drop_error(const char *method, double h)
{
    JSON *root = reference_load("tests/reference/drop.json");
    json_t *drop = json_object_get(root, "second");
    json_t *path = json_object_get(drop, "velocity_1ms");
    stance_case c = second_drop(h);
    TRAJECTORY t = trajectory_new(DROP_ROWS, 1e-3);
    c.trajectory = &t;
    run_done(method, &c);
    struct drop_error e = {0, 0, 0, 0, 0};
    json_t *states = json_object_get(drop, "states");
    double q4[5], q12[5], v[5];
    numbers(json_object_get(json_object_get(states, "0.4"), "q"), q4, 5);
    numbers(json_object_get(json_object_get(states, "1.2"), "q"), q12, 5);
    for (int i = 0; i < 5; i++) {
        e.at04 = fmax(e.at04, fabs(t.position[400 * 5 + i] - q4[i]));
        e.at12 = fmax(e.at12, fabs(t.position[1200 * 5 + i] - q12[i]));
    }
    for (int row = 0; row < DROP_ROWS && h <= 1e-3; row++) {
        numbers(json_array_get(path, (size_t)row), v, 5);
        for (int i = 0; i < 5; i++)
            e.velocity_l1 += 1e-3 * fabs(t.velocity[row * 5 + i] - v[i]);
    }
    trajectory_free(&t);

    /* Touchdown to a step's accuracy: the first step with a force, recorded at every step. */
    const int64_t rows = c.steps + 1;
    t = trajectory_new(rows, h);
    run_one(method, &c);
    for (int64_t row = rows - 1; row > 0; row--) {
        if (t.force[row * 4] > 0)
            e.touch1 = (double)row * h;
        if (t.force[row * 4 + 2] > 0)
            e.touch2 = (double)row * h;
    }
    return e;
}

/* Least-squares slope of log error over log h. */
static double slope(const double *h, const double *error, int n)
{
    double sx = 0, sy = 0, sxx = 0, sxy = 0;
    for (int i = 0; i < n; i++) {
        const double x = log(h[i]), y = log(error[i]);
        sx += x, sy += y, sxx += x * x, sxy += x * y;
    }
    return (n * sxy - sx * sy) / (n * sxx - sx * sx);
}

TEST(second_drop_converges)
{
    static const double h[] = {1e-2, 5e-3, 2e-3, 1e-3, 5e-4, 2e-4, 1e-4, 5e-5, 2e-5, 1e-5};
    enum { N = COUNT(h) };
    static const char *const methods[] = {"implicit", "midpoint"};
    for (int m = 0; m < 2; m++) {
        double e04[N], e12[N];
        for (int i = 0; i < N; i++) {
            const struct drop_error e = drop_error(methods[m], h[i]);
            e04[i] = e.at04, e12[i] = e.at12;
            print_message("# %s h=%g: |q(0.4)| off %.2e, |q(1.2)| off %.2e, velocity L1 %.2e, "
                          "touchdowns %.6f %.6f\n",
                          methods[m], h[i], e.at04, e.at12, e.velocity_l1, e.touch1, e.touch2);
            /* First order: the error constant stays below 10 per second; single steps are noisy, as
             * the impact falls differently in each. */
            assert_true(e.at04 < 10 * h[i] + 1e-6);
            assert_true(e.at12 < 10 * h[i] + 1e-6);
            assert_true(fabs(e.touch1 - 0.349946) <= 1.5 * h[i] + 1e-6);
            assert_true(fabs(e.touch2 - 0.572427) <= 4 * h[i] + 1e-6);
        }
        const double p04 = slope(h, e04, N), p12 = slope(h, e12, N);
        print_message("# %s: observed order %.2f at 0.4 s, %.2f at 1.2 s\n", methods[m], p04, p12);
        assert_true(p04 > 0.8 && p12 > 0.8);
    }
}

/* Order in smooth motion: the flight phase and the balance on a sticking foot, against the same
 * method at a step 64 times smaller. */
static double smooth_error(const char *method, bool stance, double h)
{
    double reference[5] = {0}, error = 0;
    for (int fine = 1; fine >= 0; fine--) {
        stance_case c = plain_case();
        c.position[2] = -0.45, c.position[3] = 0.57, c.position[4] = 0.82;
        c.velocity[2] = 1, c.velocity[4] = 2;
        c.friction = 1e3;
        c.contacts = stance ? 1 : 0;
        c.settle = false;
        biped()->stand(biped(), c.robot, 1, c.position, c.velocity);
        hold_legs(&c, 20, 1);
        c.step = fine ? h / 64 : h;
        c.steps = (int64_t)lround(0.256 / c.step);
        const stance_result r = run_done(method, &c);
        for (int i = 0; i < 5; i++)
            error = fine ? 0 : fmax(error, fabs(r.position[i] - reference[i]));
        memcpy(reference, r.position, sizeof reference);
    }
    return error;
}

TEST(smooth_order)
{
    static const double h[] = {8e-3, 4e-3, 2e-3, 1e-3};
    static const struct {
        const char *method;
        double order;
    } expected[] = {{"implicit", 1}, {"midpoint", 2}};
    for (int m = 0; m < 2; m++)
        for (int stance = 0; stance < 2; stance++) {
            double error[4];
            for (int i = 0; i < 4; i++)
                error[i] = smooth_error(expected[m].method, stance, h[i]);
            const double p = slope(h, error, 4);
            print_message("# %s, %s: order %.3f (error %.2e at 1 ms)\n", expected[m].method,
                          stance ? "one foot" : "flight", p, error[3]);
            assert_true(fabs(p - expected[m].order) < 0.15);
        }
}

/* ---- the drop of section 2.4 ---------------------------------------------------------------- */

TEST(first_drop_stages)
{
    enum { ROWS = 1501 };
    stance_case c = plain_case();
    c.position[1] = 1.5, c.position[2] = -0.5, c.position[3] = 0.9, c.position[4] = -1;
    c.velocity[0] = 2;
    c.friction = 0.5;
    hold_legs(&c, 500, 50);
    c.steps = 1500;
    TRAJECTORY t = trajectory_new(ROWS, 1e-3);
    c.trajectory = &t;
    run_done("implicit", &c);

    int land = 0, stop = 0, turn = 0, second = 0;
    double foot[2], speed[2];
    for (int row = 1; row < ROWS; row++) {
        const double *const q = t.position + row * 5, *const v = t.velocity + row * 5;
        const double normal = t.force[row * 4];
        if (!land && normal > 0)
            land = row;
        biped()->contact_point(biped(), c.robot, q, v, 0, foot, speed);
        if (land && !stop && row > land + 5 && normal > 0 && fabs(speed[0]) < 1e-6)
            stop = row;
        if (land && !turn && v[0] < 0)
            turn = row;
        if (!second && t.force[row * 4 + 2] > 0)
            second = row;
    }
    print_message("# lands at %d ms, slip stops at %d ms, x turns back at %d ms, foot 2 at %d ms\n",
                  land, stop, turn, second);
    /* Flight with a constant pitch until 0.33 s. */
    assert_in_range(land, 326, 336);
    assert_true(fabs(t.position[(land - 2) * 5 + 2] + 0.5) < 0.02);
    /* An impulse, then slip forward: x grows, friction at the edge of the cone, pointing back. */
    assert_true(t.force[land * 4] > 10 * 12.6 * STANCE_GRAVITY);
    assert_in_range(stop, 440, 500);
    for (int row = land + 10; row < stop - 1; row++) {
        const double n = t.force[row * 4], s = t.force[row * 4 + 1];
        assert_true(row > 440 || t.position[row * 5] > t.position[(row - 1) * 5]);
        assert_true(n > 0 && fabs(s + 0.5 * n) < 1e-6 * n);
    }
    /* It sticks inside the cone, x turns back, the normal force sags until foot 2 lands. */
    assert_in_range(turn, 440, 500);
    assert_true(fabs(t.force[(stop + 50) * 4 + 1]) < 0.5 * t.force[(stop + 50) * 4]);
    assert_in_range(second, 840, 900);
    assert_true(t.force[(second - 5) * 4] < 0.8 * t.force[(stop + 50) * 4]);
}

/* The equation of a long step has further roots, far away and fast. A robot without torques gains
 * no energy but what discretisation makes of it; the first case went from 193 J to 302,772 J in one
 * step that had converged. */
TEST(far_roots_are_refused)
{
    stance_case c = plain_case();
    c.friction = 0.5;
    c.position[1] = 1.3749378810949437, c.position[2] = 0.5359201713349733;
    c.position[3] = 1.3297504275738916, c.position[4] = -1.4272298851754148;
    c.velocity[0] = -4.258139835922556, c.velocity[1] = -0.3969750743423486;
    c.velocity[2] = 7.30844240972327, c.velocity[3] = 7.262569281620582;
    c.step = 0.05, c.steps = 40;
    c.robot[STANCE_ROBOT_FALL_HEIGHT] = 0;
    const stance_result r = run_done("implicit", &c);
    assert_true(r.energy_gain < 10);
    static const char *const methods[] = {"implicit", "midpoint"};
    for (int m = 0; m < 2; m++) {
        enum { N = 2000 };
        OWN stance_case *cases = calloc(N, sizeof *cases);
        OWN stance_result *results = calloc(N, sizeof *results);
        assert_true(cases && results);
        uint64_t seed = 3;
        double worst = 0;
        for (int i = 0; i < N; i++) {
            random_case(&seed, i, i % 2 ? 0.02 : 0.05, &cases[i]);
            memset(cases[i].near.gain, 0, sizeof cases[i].near.gain);
            cases[i].steps = i % 2 ? 50 : 20;
        }
        run_cases(kernel_of(methods[m], NULL), cases, results, N);
        for (int i = 0; i < N; i++) {
            const double start =
                biped()->energy(biped(), cases[i].robot, cases[i].position, cases[i].velocity);
            worst = fmax(worst, results[i].energy_gain / start);
        }
        print_message("# %s: energy gained at most %.2f of the initial\n", methods[m], worst);
        assert_true(worst < 1);
    }
}

/* ---- determinism ---------------------------------------------------------------------------- */

/* One value for every width, order and slicing, and for every processor and compiler. It changes
 * only when the mathematics of a step changes: then say so in the CHANGELOG. */
TEST(golden)
{
    static const struct {
        const char *scene, *method;
        uint64_t hash;
    } expected[] = {
        {"biped", "implicit", 0x99c94af5d4baf0b2u},  {"biped", "midpoint", 0xbc34b041bca269bau},
        {"biped", "capturing", 0x6afc63ee3ecf7ff4u}, {"biped", "lagrange", 0x5116f849eff32906u},
        {"ball", "implicit", 0x1521101baf2108a7u},   {"ball", "midpoint", 0x1b16c319372e82e8u},
        {"ball", "capturing", 0x6533237f9aadbfb8u},  {"ball", "lagrange", 0x4dbf371229389926u},
        {"block", "implicit", 0x4c74485ed28a1f20u},  {"block", "midpoint", 0x3f821611a0384120u},
        {"block", "capturing", 0x9a6b7c8c37348e54u}, {"block", "lagrange", 0xcf23d0a43be2505fu},
        {"rod", "implicit", 0xd3113a49adf3e105u},    {"rod", "midpoint", 0x83a9bd1632ca3340u},
        {"rod", "capturing", 0xf4fb66ae1660ce95u},   {"rod", "lagrange", 0xff1bb676f1277fdau},
    };
    for (size_t m = 0; m < COUNT(expected); m++) {
        const stance_scene *const scene = stance_scene_find(expected[m].scene);
        for (int rank = 0; stance_isa(rank); rank++) {
            const stance_kernel *const kernel =
                stance_kernel_find(scene, stance_method_find(expected[m].method), stance_isa(rank));
            const uint64_t h = golden_hash(kernel, scene, 400, false, 400);
            print_message("# %s %s %s: %016llx\n", expected[m].scene, expected[m].method,
                          stance_isa(rank), (unsigned long long)h);
            assert_true(h == expected[m].hash);
            if (!stance_kernel_ahead(kernel)) /* one lane, for whatever set */
                break;
            assert_true(golden_hash(kernel, scene, 400, true, 400) == h);
            assert_true(golden_hash(kernel, scene, 400, false, 37) == h);
        }
    }
}

/* So many cases that some have several contact solutions beside neighbours of every kind. */
TEST(neighbours_change_nothing)
{
    static const char *const methods[] = {"implicit", "midpoint"};
    for (size_t m = 0; m < COUNT(methods); m++) {
        const stance_kernel *const wide = kernel_of(methods[m], stance_isa(0));
        const stance_kernel *const narrow =
            kernel_of(methods[m], stance_isa(stance_isa(1) ? 1 : 0)); /* the next narrower */
        const size_t n = long_tests() ? 4000 : 1000;
        assert_true(golden_hash(wide, biped(), n, false, n) ==
                    golden_hash(narrow, biped(), n, false, n));
    }
}

/* ---- bad days ------------------------------------------------------------------------------- */

TEST(failures_are_reported)
{
    stance_case c[3];
    stance_result r[3];
    for (int i = 0; i < 3; i++) {
        c[i] = plain_case();
        c[i].position[1] = 5;
    }
    c[0].velocity[2] = NAN;
    c[1].velocity[3] = 2e4; /* leaves the range of sine and cosine */
    c[1].step = 1e-3;
    run_cases(kernel_of("implicit", NULL), c, r, 3);
    assert_int_equal(r[0].status, STANCE_FAILED);
    assert_int_equal(r[0].failure, STANCE_FAILURE_NOT_FINITE);
    assert_int_equal(r[1].status, STANCE_FAILED);
    assert_int_equal(r[1].failure, STANCE_FAILURE_ANGLE);
    assert_int_equal(r[2].status, STANCE_DONE); /* a bad neighbour does no harm */
}
