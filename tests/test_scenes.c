/* Every method on scenes whose motion is known: closed forms and an independent program
 * (tests/reference/known.py), and what only one scene shows: thresholds, Zeno, Painleve. */
#include "long.h"
#include "support.h"

/* What a method is asked for on motions with impacts and switches: the longest step, a tolerance
 * where it has one, and the largest error of a position (m, rad) and a velocity (m/s, rad/s). */
struct demand {
    const char *method;
    double step, tolerance, position, velocity;
    bool zeno; /* goes through accumulations of bounces */
};
static const struct demand demands[] = {
    {"implicit", 1e-4, 0, 1e-2, 1e-1, true},
    {"midpoint", 1e-4, 0, 3e-3, 3e-2, true},
    {"capturing", 1e-2, 1e-9, 1e-8, 1e-7, true},
    {"lagrange", 2e-4, 0, 1e-9, 1e-7, false},
    {"event-driven", 1e-2, 1e-12, 1e-10, 1e-10, false},
};
enum { DEMANDS = COUNT(demands) };

/* A case of an entry of known.json that ends at time t, exactly. */
static stance_case known_case(const stance_scene *scene, const json_t *entry,
                              const struct demand *demand, double t)
{
    stance_case c = case_of_scene(scene->name, 1, 1);
    const json_t *robot = json_object_get(entry, "robot");
    c.contacts = 0;
    for (int i = 0; i < scene->robot_count; i++) {
        const json_t *value = json_object_get(robot, scene->robot[i].name);
        if (value)
            c.robot[i] = json_number_value(value);
    }
    c.robot[STANCE_ROBOT_SLOPE] = number_in(robot, "slope");
    c.friction = number_in(entry, "friction");
    c.restitution = number_in(entry, "restitution");
    const json_t *contacts = json_object_get(entry, "contacts");
    for (int i = 0; i < scene->contacts; i++) {
        bool touches = !contacts;
        for (size_t k = 0; k < json_array_size(contacts); k++)
            touches |=
                strcmp(json_string_value(json_array_get(contacts, k)), scene->contact_name[i]) == 0;
        c.contacts |= touches ? 1u << i : 0;
    }
    numbers(json_object_get(entry, "position"), c.position, scene->coordinates);
    numbers(json_object_get(entry, "velocity"), c.velocity, scene->coordinates);
    c.step = t / ceil(t / demand->step - 1e-9);
    if (json_object_get(entry, "kp")) {
        double target[2];
        numbers(json_object_get(entry, "target"), target, 2);
        for (int i = 0; i < 2; i++) {
            c.near.gain[i][1 + i] = number_in(entry, "kp");
            c.near.gain[i][4 + i] = number_in(entry, "kd");
            c.near.target[1 + i] = target[i];
        }
        const double sample = number_in(entry, "sample_time");
        if (sample > 0) {
            c.step = sample / ceil(sample / demand->step - 1e-9);
            c.sample_every = (int64_t)lround(sample / c.step);
        }
    }
    c.steps = (int64_t)lround(t / c.step);
    c.tolerance = demand->tolerance;
    return c;
}

static bool is_zeno(const json_t *entry)
{
    size_t i;
    json_t *event;
    json_array_foreach(json_object_get(entry, "events"), i, event)
    {
        if (strcmp(json_string_value(json_object_get(event, "kind")), "zeno") == 0)
            return true;
    }
    return false;
}

/* Bounces without end: implicit steps of fixed length lose (theta = 1) or shift (theta = 1/2) a
 * little in every bounce, which test `endless_bounces` bounds. */
static bool is_endless(const stance_scene *scene, const json_t *entry)
{
    return strcmp(scene->name, "ball") == 0 && number_in(entry, "restitution") == 1;
}

/* Largest errors over the instants of an entry; false where the method gave up. */
static bool known_error(const stance_scene *scene, const json_t *entry, const struct demand *demand,
                        double *position, double *velocity)
{
    const json_t *times = json_object_get(entry, "times");
    const stance_kernel *kernel =
        stance_kernel_find(scene, stance_method_find(demand->method), NULL);
    enum { ROOM = 32 };
    stance_case cases[ROOM];
    stance_result results[ROOM];
    /* Of methods whose steps are short every fourth instant, the last one among them. */
    const size_t every = long_tests() || demand->step > 1e-3 ? 1 : 4;
    const size_t all = json_array_size(times), n = (all + every - 1) / every;
    assert_non_null(kernel);
    assert_in_range(n, 1, ROOM);
    for (size_t i = 0; i < n; i++)
        cases[i] = known_case(scene, entry, demand,
                              json_number_value(json_array_get(times, all - 1 - i * every)));
    run_cases(kernel, cases, results, n);
    *position = *velocity = 0;
    for (size_t i = 0; i < n; i++) {
        double q[STANCE_MAX_COORDINATES], v[STANCE_MAX_COORDINATES];
        const size_t at = all - 1 - i * every;
        if (results[i].status != STANCE_DONE)
            return false;
        numbers(json_array_get(json_object_get(entry, "positions"), at), q, scene->coordinates);
        numbers(json_array_get(json_object_get(entry, "velocities"), at), v, scene->coordinates);
        for (int k = 0; k < scene->coordinates; k++) {
            *position = fmax(*position, fabs(q[k] - results[i].position[k]));
            *velocity = fmax(*velocity, fabs(v[k] - results[i].velocity[k]));
        }
        assert_true(results[i].max_penetration < 1e-9);
        assert_true(results[i].signorini_residual < 1e-8);
        assert_true(results[i].coulomb_residual < 1e-8);
        assert_true(results[i].dissipation_residual < 1e-8);
    }
    return true;
}

TEST(known_motions)
{
    JSON *root = reference_load("tests/reference/known.json");
    int missed = 0;
    double worst[DEMANDS][2] = {{0}};
    for (const stance_scene *const *scene = stance_scenes(); *scene; scene++) {
        size_t i;
        json_t *entry;
        json_array_foreach(json_object_get(root, (*scene)->name), i, entry)
        {
            const char *name = json_string_value(json_object_get(entry, "name"));
            for (int d = 0; d < DEMANDS; d++) {
                double position, velocity;
                if (is_endless(*scene, entry) && demands[d].tolerance == 0 && demands[d].zeno)
                    continue;
                const bool done = known_error(*scene, entry, &demands[d], &position, &velocity);
                const bool good =
                    done ? position <= demands[d].position && velocity <= demands[d].velocity
                         : is_zeno(entry) && !demands[d].zeno;
                missed += !good;
                worst[d][0] = fmax(worst[d][0], done ? position : 0);
                worst[d][1] = fmax(worst[d][1], done ? velocity : 0);
                if (!good)
                    print_message("# %s, %s, %s: %s, position off %.2e, velocity off %.2e\n",
                                  (*scene)->name, name, demands[d].method,
                                  done ? "done" : "gave up", position, velocity);
            }
        }
    }
    for (int d = 0; d < DEMANDS; d++)
        print_message("# %s, steps up to %g s: position off %.1e, velocity off %.1e at the most\n",
                      demands[d].method, demands[d].step, worst[d][0], worst[d][1]);
    assert_int_equal(missed, 0);
}

/* ---- what only one scene shows -------------------------------------------------------------- */

/* At rest on a slope whose tangent is the friction, but for a relative 1e-9: a block stays
 * where it is, but for rounding, on one side of the threshold, and slides by t^2 g (sin - mu cos) /
 * 2 on the other. */
TEST(slope_threshold)
{
    for (int d = 0; d < DEMANDS; d++)
        for (double slope = 0.1; slope < 1.5; slope += 0.2)
            for (int side = -1; side <= 1; side += 2) {
                stance_case c = case_of_scene("block", 1e-3, 1);
                c.robot[STANCE_ROBOT_SLOPE] = slope;
                c.friction = tan(slope) * (1 + side * 1e-9);
                const stance_result r = run_done(demands[d].method, &c);
                const double slip = STANCE_GRAVITY * (sin(slope) - c.friction * cos(slope));
                if (side > 0) {
                    assert_true(fabs(r.position[0]) < 1e-15 && fabs(r.velocity[0]) < 1e-15);
                } else {
                    assert_true(fabs(r.velocity[0] - slip) < 1e-3 * slip);
                    assert_true(fabs(r.position[0] - 0.5 * slip) < 5e-3 * slip);
                }
            }
}

/* Energy of a ball at e = 1: lagrange, event-driven and capturing keep it to rounding and tolerance
 * over 10,000 bounces (1000 in the short test, event-driven 100); midpoint, exact
 * in flight, meets the ground at some place inside a step but keeps the rebound's speed; theta = 1
 * loses m g^2 h / 2 in every second of flight. */
TEST(endless_bounces)
{
    const struct {
        const char *method;
        double step, time, loss_rate, tolerance; /* of the energy, relative */
    } bounds[] = {
        {"implicit", 1e-4, long_tests() ? 90 : 20, 0.5 * STANCE_GRAVITY * STANCE_GRAVITY * 1e-4,
         2e-3},
        {"midpoint", 1e-3, long_tests() ? 9031 : 903, 0, 1e-2},
        {"capturing", 1e-1, long_tests() ? 9031 : 903, 0, 1e-5},
        {"lagrange", 1e-1, long_tests() ? 9031 : 903, 0, 1e-7},
        {"event-driven", 1e-1, long_tests() ? 9031 : 90, 0, 1e-9},
    };
    for (size_t i = 0; i < COUNT(bounds); i++) {
        stance_case c = case_of_scene("ball", bounds[i].step, bounds[i].time);
        c.restitution = 1;
        c.position[1] = 1.1;
        const stance_scene *ball = stance_scene_find("ball");
        const stance_result r = run_one(bounds[i].method, &c);
        const double before =
            ball->energy(ball, c.robot, c.position, c.velocity) - 0.1 * STANCE_GRAVITY;
        const double after =
            ball->energy(ball, c.robot, r.position, r.velocity) - 0.1 * STANCE_GRAVITY;
        const double wanted = before - bounds[i].loss_rate * bounds[i].time;
        print_message("# %s: energy off %.1e of %.3g J after %.0f s\n", bounds[i].method,
                      after / wanted - 1, wanted, r.end_time);
        assert_int_equal(r.status, STANCE_DONE);
        assert_true(fabs(after / wanted - 1) < bounds[i].tolerance);
    }
}

/* A rod that slides on end 1 (slip of 1 m/s) where the accelerations are unique, do not exist or
 * are ambiguous: methods of forces say so, methods of impulses go through with finite velocities
 * and without more energy. */
TEST(painleve)
{
    JSON *root = reference_load("tests/reference/known.json");
    json_t *cases = json_object_get(json_object_get(root, "painleve"), "cases");
    int counts[2] = {0};
    double gain = 0, fastest = 0;
    size_t i;
    json_t *row;
    json_array_foreach(cases, i, row)
    {
        double x[5];
        numbers(row, x, 5);
        const char *kind = json_string_value(json_array_get(row, 7));
        const bool paradox = strcmp(kind, "none") == 0 || strcmp(kind, "two") == 0;
        stance_case c = case_of_scene("rod", 1e-4, 0.1);
        c.robot[2] = x[0];
        c.contacts = 1;
        c.position[0] = 0.5 * cos(x[1]), c.position[1] = 0.5 * sin(x[1]), c.position[2] = x[1];
        c.velocity[0] = x[4] - 0.5 * sin(x[1]) * x[3], c.velocity[1] = 0.5 * cos(x[1]) * x[3];
        c.velocity[2] = x[3];
        c.friction = x[2];
        double gap[2];
        const stance_scene *const rod = stance_scene_find("rod");
        rod->gaps(rod, c.robot, c.position, gap);
        c.position[1] -= gap[0] < 0 ? gap[0] : 0;
        for (int d = 0; d < DEMANDS; d++) {
            const stance_result r = run_one(demands[d].method, &c);
            if (demands[d].zeno) {
                assert_int_equal(r.status, STANCE_DONE);
                gain = fmax(gain, r.energy_gain);
                for (int k = 0; k < 3; k++)
                    fastest = fmax(fastest, fabs(r.velocity[k]));
            }
        }
        c.steps = 1;
        counts[paradox]++;
        for (int m = 0; m < 2; m++) {
            c.tolerance = m ? 1e-12 : 1e-9;
            const stance_result r = run_one(m ? "event-driven" : "lagrange", &c);
            assert_int_equal(r.status, paradox ? STANCE_FAILED : STANCE_DONE);
            assert_int_equal(r.failure, paradox ? STANCE_FAILURE_PAINLEVE : STANCE_FAILURE_NONE);
        }
    }
    print_message("# %d unique, %d paradoxical; energy gained at most %.1e J, fastest %.1f\n",
                  counts[0], counts[1], gain, fastest);
    assert_true(gain < 1e-3 && counts[1] > 20);
}

/* Where no forces exist the end stops dead: the one impact that resolves the state. */
TEST(jams)
{
    JSON *root = reference_load("tests/reference/known.json");
    size_t i;
    json_t *jam;
    json_array_foreach(json_object_get(json_object_get(root, "painleve"), "jams"), i, jam)
    {
        for (int d = 0; d < DEMANDS; d++) {
            if (!demands[d].zeno)
                continue;
            double after[3];
            stance_case c = case_of_scene("rod", 1e-8, 1e-8);
            c.robot[2] = number_in(jam, "inertia_ratio");
            c.friction = number_in(jam, "friction");
            c.contacts = 1;
            numbers(json_object_get(jam, "position"), c.position, 3);
            numbers(json_object_get(jam, "velocity"), c.velocity, 3);
            numbers(json_object_get(jam, "velocity_after"), after, 3);
            const stance_result r = run_done(demands[d].method, &c);
            for (int k = 0; k < 3; k++)
                assert_true(fabs(r.velocity[k] - after[k]) < 1e-5);
        }
    }
}

/* A rod that lies on both ends, pressed and pulled by nothing else, stays: the tangential forces
 * are redundant, the motion is not. */
TEST(redundant_rest)
{
    for (int d = 0; d < DEMANDS; d++) {
        stance_case c = case_of_scene("rod", 1e-2, 10);
        c.friction = 0.3;
        c.settle = true;
        const stance_result r = run_done(demands[d].method, &c);
        assert_int_equal(r.outcome, STANCE_RESTED);
        for (int k = 0; k < 3; k++)
            assert_true(fabs(r.position[k]) < 1e-12 && fabs(r.velocity[k]) < 1e-12);
    }
}

/* The kernels' rule and the description's. */
TEST(fallen_is_said_alike)
{
    uint64_t seed = 17;
    int fallen = 0, by_trunk = 0, by_hip = 0;
    for (int i = 0; i < 3000; i++) {
        stance_case c = plain_case();
        stance_result r;
        c.contacts = 0;
        for (int k = 2; k < 5; k++)
            c.position[k] = uniform(&seed, -3, 3);
        c.position[1] = uniform(&seed, -0.3, 1.2);
        c.robot[STANCE_ROBOT_FALL_HEIGHT] = uniform(&seed, 0, 0.5);
        c.step = 1e-6;
        c.steps = 1;
        run_cases(kernel_of("implicit", NULL), &c, &r, 1);
        const bool says = biped()->fallen(biped(), c.robot, r.position);
        assert_int_equal(r.outcome == STANCE_FELL, says);
        const double leg = c.robot[0], trunk = c.robot[1];
        const bool hip = r.position[1] - trunk * cos(r.position[2]) <
                         c.robot[STANCE_ROBOT_FALL_HEIGHT] * leg; /* is too low */
        assert_int_equal(r.fall_cause, hip ? 1 : says ? 2 : 0);
        by_hip += hip;
        fallen += says;
        by_trunk += says && !biped()->fallen(biped(), c.robot, (double[]){0, 5, 0, 0, 0}) &&
                    r.position[1] <= 0;
    }
    assert_true(fallen > 500 && fallen < 2500 && by_trunk > 100 && by_hip > 100 && by_hip < fallen);
}
