/* The event-driven reference: independent figures, conserved quantities, closed forms, agreement
 * with the method that never locates an event, and events that are easy to miss. */
#include "closed_biped.h"
#include "support.h"

#include <unistd.h>

/* The drop of tests/reference/drop.json: position to 1e-11 wherever it is given in full digits,
 * velocity too, events as many as there. */
TEST(drop_against_reference)
{
    json_t *root = reference_load("tests/reference/drop.json"), *row;
    json_t *second = json_object_get(root, "second");
    const char *at;
    for (double step = 1e-2; step > 5e-4; step /= 10) {
        stance_case c = second_drop(step);
        double position = 0, velocity = 0;
        c.tolerance = 1e-12;
        TRAJECTORY t = trajectory_new(13, 0.1);
        c.trajectory = &t;
        const stance_result r = run_done("event-driven", &c);
        json_object_foreach(json_object_get(second, "states"), at, row)
        {
            const long k = lround(atof(at) / 0.1);
            double q[5], v[5];
            numbers(json_object_get(row, "q"), q, 5);
            numbers(json_object_get(row, "v"), v, 5);
            for (int i = 0; i < 5; i++) {
                position = fmax(position, fabs(t.position[k * 5 + i] - q[i]));
                velocity = fmax(velocity, fabs(t.velocity[k * 5 + i] - v[i]));
            }
        }
        print_message("# h = %g: position off %.1e, velocity off %.1e, energy gained %.1e J\n",
                      step, position, velocity, r.energy_gain);
        assert_true(position < 1e-11 && velocity < 1e-10);
        assert_true(r.max_penetration < 1e-12 && r.energy_gain < 1e-11);
        assert_true(r.signorini_residual < 1e-12 && r.coulomb_residual < 1e-12 &&
                    r.dissipation_residual < 1e-10);
        size_t contact_events = json_array_size(json_object_get(second, "events"));
        assert_int_equal(r.events, contact_events);
    }
    json_decref(root);
}

/* Did both feet stand on one spot? Then their forces are not unique, nor may the motion be. */
static bool feet_meet(const stance_trajectory *t, double end)
{
    for (int64_t row = 0; row < t->rows && (double)row * t->interval <= end; row++) {
        const double *const q = t->position + row * 5, *const gap = t->gap + row * 2;
        if (fmax(gap[0], gap[1]) < 1e-6 && fabs(sin(0.5 * (q[3] - q[4]))) < 1e-4)
            return true;
    }
    return false;
}

/* Two methods that have the equations of motion in common but neither how they integrate them nor
 * how they find and cross events: where both come to the end they agree. */
TEST(agrees_with_capturing)
{
    enum { N = 300 };
    uint64_t seed = 2024;
    int both = 0, gave_up[2] = {0}, meet = 0;
    double worst = 0;
    for (int i = 0; i < N; i++) {
        stance_case c;
        random_case(&seed, i, 1e-3, &c);
        c.restitution = i % 7 == 0 ? 0.5 : 0;
        c.tolerance = 1e-12;
        TRAJECTORY t = trajectory_new(c.steps + 1, c.step);
        c.trajectory = &t;
        const stance_result a = run_one("event-driven", &c);
        c.trajectory = NULL;
        c.tolerance = 1e-10;
        const stance_result b = run_one("capturing", &c);
        const bool compare = !feet_meet(&t, a.end_time);
        gave_up[0] += a.status != STANCE_DONE;
        gave_up[1] += b.status != STANCE_DONE;
        /* Rebounds and rocking that accumulate, and states without a motion, end a case. */
        if (a.status == STANCE_FAILED)
            assert_true(a.failure == STANCE_FAILURE_EVENTS || a.failure == STANCE_FAILURE_PAINLEVE);
        assert_true(a.max_penetration < 1e-11);
        assert_true(c.restitution > 0 || a.impact_energy < 1e-12);
        if (a.status != STANCE_DONE || b.status != STANCE_DONE)
            continue;
        meet += !compare;
        both += compare;
        for (int k = 0; k < 5 && compare; k++)
            worst = fmax(worst, fabs(a.position[k] - b.position[k]));
        if (compare)
            assert_int_equal(a.outcome, b.outcome);
    }
    print_message("# %d of %d cases by both, positions off %.1e; feet on one spot in %d; given up: "
                  "event-driven %d, capturing %d\n",
                  both, N, worst, meet, gave_up[0], gave_up[1]);
    assert_true(both > 0.85 * N);
    assert_true(worst < 1e-7);
}

/* Momentum in x and z, angular momentum about the origin, and mass times place in x. */
static void momenta(const double *robot, const double *q, const double *v, double p[4])
{
    memset(p, 0, sizeof(double[4]));
    for (int k = 0; k < POINTS; k++) {
        const struct closed_point point = closed_point(robot, q, k);
        double u[2];
        closed_speed(&point, v, u);
        p[0] += point.mass * u[0];
        p[1] += point.mass * u[1];
        p[2] += point.mass * (point.at[0] * u[1] - point.at[1] * u[0]);
        p[3] += point.mass * point.at[0];
    }
}

/* In flight without torques: energy and the momenta, less what gravity adds, stay. With a servo
 * the momenta stay, and the energy changes by the work. */
TEST(flight_conserves)
{
    uint64_t seed = 5;
    double worst = 0;
    for (int i = 0; i < 40; i++) {
        stance_case c;
        random_case(&seed, i, 1e-3, &c);
        const bool passive = i % 2 == 0;
        if (passive)
            memset(c.near.gain, 0, sizeof c.near.gain);
        c.sample_every = passive ? 1 : 0;
        c.contacts = 0;
        c.step = i % 3 ? 1e-3 : 1e-2;
        c.steps = (int64_t)lround(1 / c.step);
        c.tolerance = 1e-13;
        const stance_result r = run_done("event-driven", &c);
        double before[4], after[4];
        assert_int_equal(r.events == 0 || !passive, 1);
        momenta(c.robot, c.position, c.velocity, before);
        momenta(c.robot, r.position, r.velocity, after);
        const double weight = closed_mass(c.robot) * STANCE_GRAVITY;
        /* The weight's moment about the origin grows with the way of the centre of mass. */
        before[1] -= weight * r.end_time;
        before[2] -= STANCE_GRAVITY * r.end_time * (before[3] + 0.5 * r.end_time * before[0]);
        for (int k = 0; k < 3; k++)
            worst = fmax(worst, fabs(after[k] - before[k]) / (weight + fabs(before[k])));
        if (passive) {
            const double e0 = biped()->energy(biped(), c.robot, c.position, c.velocity);
            const double e1 = biped()->energy(biped(), c.robot, r.position, r.velocity);
            worst = fmax(worst, fabs(e1 - e0) / (1 + fabs(e0)));
        } else {
            worst = fmax(worst, r.energy_gain / (weight + fabs(before[2])));
        }
    }
    print_message("# energy and momenta off %.1e, relative\n", worst);
    assert_true(worst < 1e-11);
}

/* A ball at e < 1 comes to the instant at which its bounces accumulate and not beyond; every bounce
 * before that is where it belongs. */
TEST(zeno_fails)
{
    for (double e = 0.1; e < 0.95; e += 0.2)
        for (double step = 1e-4; step < 0.05; step *= 10) {
            stance_case c = case_of_scene("ball", step, 30);
            c.restitution = e;
            c.position[1] = 1.1;
            const double zeno = sqrt(2 / STANCE_GRAVITY) * (1 + e) / (1 - e);
            const stance_result r = run_one("event-driven", &c);
            assert_int_equal(r.status, STANCE_FAILED);
            assert_int_equal(r.failure, STANCE_FAILURE_EVENTS);
            assert_true(fabs(r.end_time - zeno) < 1.01 * step + 1e-3);
        }
}

/* Height of the rod's end 1 at time t of free flight; the rod is 1 m long. */
static double end_height(const stance_case *c, double t)
{
    return c->position[1] + (c->velocity[1] - 0.5 * STANCE_GRAVITY * t) * t -
           0.5 * sin(c->position[2] + c->velocity[2] * t);
}

/* Its least value between two times, of which there is one. */
static double lowest(const stance_case *c, double from, double to)
{
    for (int round = 0; round < 100; round++) {
        const double a = from + (to - from) / 3, b = to - (to - from) / 3;
        if (end_height(c, a) < end_height(c, b))
            to = b;
        else
            from = a;
    }
    return end_height(c, 0.5 * (from + to));
}

/* An end of a spinning rod comes down to within a hair of the ground, or a hair below it, and goes
 * up again, all inside one step. */
static void graze(const char *method, double tolerance, double least)
{
    static const double depths[] = {1e-3, 1e-5, 1e-7, 1e-9, 1e-11, 3e-12};
    uint64_t seed = 11;
    for (int i = 0; i < 100; i++) {
        const double spin = uniform(&seed, 30, 300), when = uniform(&seed, 0.5, 2.5) / spin;
        stance_case c = case_of_scene("rod", i % 2 ? 1e-2 : 1e-3, 1);
        c.contacts = 1;
        c.tolerance = tolerance;
        c.velocity[0] = 1, c.velocity[1] = uniform(&seed, -1, 1), c.velocity[2] = spin;
        c.position[2] = M_PI / 2 - spin * when;
        c.steps = (int64_t)ceil((when + 0.4 / spin) / c.step);
        c.position[1] = 0;
        const double low = lowest(&c, when - 0.3 / spin, when + 0.3 / spin);
        for (size_t d = 0; d < COUNT(depths) && depths[d] >= least; d++)
            for (int side = -1; side <= 1; side += 2) {
                c.position[1] = side * depths[d] - low;
                const stance_result r = run_done(method, &c);
                assert_int_equal(r.events > 0, side < 0);
            }
    }
}
TEST(grazing_is_seen)
{
    graze("event-driven", 1e-12, 0);
    graze("capturing", 1e-10, 1e-7);
    graze("capturing", 1e-8, 1e-5);
}

/* A block on level ground under a pull that exceeds friction for an instant, by a little: it slips
 * as far as the closed form says. Where the pull falls short of friction by as little it stays. */
static void short_slips(const char *method, double tolerance, double least)
{
    static const double excesses[] = {1e-1, 1e-2, 1e-3, 1e-5, 1e-7};
    for (double frequency = 0.7; frequency < 2000; frequency *= 3)
        for (size_t k = 0; k < COUNT(excesses) && excesses[k] >= least; k++)
            for (int side = -1; side <= 1; side += 2) {
                const double mu = 0.3, drag = mu * STANCE_GRAVITY;
                const double pull = drag * (1 + side * excesses[k]), w = 2 * M_PI * frequency;
                stance_case c = case_of_scene("block", 0.6 / frequency, 0.6 / frequency);
                c.friction = mu;
                c.tolerance = tolerance;
                c.robot[1] = pull, c.robot[2] = frequency;
                const stance_result r = run_done(method, &c);
                if (side < 0) {
                    assert_true(r.position[0] == 0 && r.velocity[0] == 0 && r.events == 0);
                    continue;
                }
                /* v(t) = (pull / w) (cos w t1 - cos w t) - drag (t - t1), zero at t1 and t2. */
                const long double t1 = asinl((long double)drag / pull) / w;
                long double a = 0.25L / frequency, b = 0.5L / frequency;
                for (int round = 0; round < 100; round++) {
                    const long double t = 0.5L * (a + b);
                    const long double v = pull / w * (cosl(w * t1) - cosl(w * t)) - drag * (t - t1);
                    *(v > 0 ? &a : &b) = t;
                }
                const long double wanted = pull / w * cosl(w * t1) * (a - t1) -
                                           pull / (w * w) * (sinl(w * a) - sinl(w * t1)) -
                                           0.5L * drag * (a - t1) * (a - t1);
                assert_true(r.events >= 2 &&
                            (r.events == 2 || excesses[k] < 1e-4 || tolerance > 1e-11));
                assert_true(fabs(r.velocity[0]) <= (tolerance > 1e-11 ? tolerance : 0));
                assert_true(fabs(r.position[0] - (double)wanted) <
                            (tolerance > 1e-11 ? tolerance : 1e-6 * (double)wanted + 1e-14));
            }
}
TEST(short_slip_is_seen)
{
    short_slips("event-driven", 1e-12, 0);
    short_slips("capturing", 1e-10, 1e-2);
    short_slips("capturing", 1e-8, 1e-1);
}

/* Rebounds die out on a robot whose servo presses the foot onto the ground a hundred times harder
 * than its weight: the impacts that count no longer depend on that. */
TEST(pressed_rebounds_end)
{
    stance_case c = case_of_scene("biped", 0.01, 0.8);
    static const double start[] = {-0.6190420068784885, 0.6001175971973135, -0.8832618334430357};
    c.position[1] = 1.3;
    c.velocity[0] = 0.765348141110965, c.velocity[1] = -0.6428562436512562;
    for (int i = 0; i < 3; i++)
        c.position[2 + i] = start[i];
    hold_legs(&c, 333.921, 84.2744);
    c.friction = 0.5943842433254797, c.restitution = 0.0035, c.torque_limit = 366;
    c.robot[0] = 0.535;
    for (int i = 0; i < 12; i++) {
        c.restitution = 0.04 * i;
        for (c.tolerance = 1e-8; c.tolerance > 1e-10; c.tolerance *= 0.1)
            run_done("capturing", &c);
    }
}

/* What a case gives depends on nothing but the case, and SUNDIALS says nothing. */
TEST(cases_are_independent)
{
    enum { N = 60 };
    stance_case cases[N], reversed[N];
    stance_result results[N], back[N];
    uint64_t seed = 3;
    for (int i = 0; i < N; i++) {
        random_case(&seed, i, 1e-3, &cases[i]);
        cases[i].tolerance = i % 2 ? 1e-12 : 1e-9;
        if (i % 10 == 9)
            cases[i].tolerance = 1e-18; /* cannot be met */
        reversed[N - 1 - i] = cases[i];
    }
    const stance_kernel *const kernel = kernel_of("event-driven", NULL);
    stance_case rods[12], rods_reversed[12];
    stance_result rods_there[12], rods_back[12];
    const stance_kernel *const rod =
        stance_kernel_find(stance_scene_find("rod"), stance_method_find("event-driven"), NULL);
    for (int i = 0; i < 12; i++) { /* of two contacts one, the other or both take part */
        rods[i] = case_of_scene("rod", 0.01, 0.5);
        rods[i].position[1] = 0.75, rods[i].position[2] = 0.1 + 1.4 * i / 11;
        rods_reversed[11 - i] = rods[i];
    }
    FILE *const heard = tmpfile();
    assert_non_null(heard);
    fflush(stderr);
    const int saved = dup(STDERR_FILENO);
    dup2(fileno(heard), STDERR_FILENO);
    run_cases(kernel, cases, results, N);
    run_cases(kernel, reversed, back, N);
    run_cases(rod, rods, rods_there, 12);
    run_cases(rod, rods_reversed, rods_back, 12);
    fflush(stderr);
    dup2(saved, STDERR_FILENO);
    close(saved);
    fseek(heard, 0, SEEK_END);
    assert_int_equal(ftell(heard), 0);
    fclose(heard);
    for (int i = 0; i < N; i++) {
        assert_memory_equal(&results[i], &back[N - 1 - i], sizeof results[i]);
        if (i % 10 == 9 && results[i].end_time > 0) /* else it has fallen at once */
            assert_int_equal(results[i].failure, STANCE_FAILURE_TOLERANCE);
    }
    for (int i = 0; i < 12; i++)
        assert_memory_equal(&rods_there[i], &rods_back[11 - i], sizeof rods_there[i]);
    assert_ptr_equal(kernel_of("event-driven", "avx2"), kernel);
}
