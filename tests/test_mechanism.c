/* test_mechanism.c - described mechanisms: the biped among them against its own scene, and what is
 * known in closed form. */
#include "closed_biped.h"
#include "linear.h"
#include "mechanism_text.h"

#include "engine/tree.h"

/* Its coordinates are of the trunk's mass, its root is the hip. */
#define BIPED                                                                                      \
    "body trunk free - 1.8 0 0 0.535 0 0\n"                                                        \
    "reference 0 0.535\n"                                                                          \
    "body hip fixed trunk 5.4 0 0 0 0 0\n"                                                         \
    "body leg1 hinge hip 1.8 0 0 -0.535 0 0\n"                                                     \
    "body leg2 hinge hip 1.8 0 0 -0.535 0 0\n"                                                     \
    "point foot1 leg1 0 -0.535\n"                                                                  \
    "point foot2 leg2 0 -0.535\n"                                                                  \
    "actuator hip1 leg1 10\n"                                                                      \
    "actuator hip2 leg2 10\n"

static void same(const double *got, const double *wanted, int count, double scale, const char *what)
{
    for (int i = 0; i < count; i++)
        assert_near(got[i], wanted[i], 1e-12 * scale, what);
}

TEST(names)
{
    SCENE *s = mechanism_scene("body base free - 1 0.1 0 0 0 0\n"
                               "body foot hinge base 1 0.1 0 -0.1 0 -0.5 limits -1 1\n"
                               "sole flat foot -0.1 -0.2 0.2 -0.2\n"
                               "disc wheel base 0 0.3 0.1\n"
                               "named head base 0 0.4 0.3\n"
                               "reference 0.05 0\n"
                               "actuator ankle foot 40\n");
    static const char *const contacts[] = {"flat_heel", "flat_toe", "wheel", "foot_low",
                                           "foot_high"};
    static const char *const coordinates[] = {"x", "z", "base", "foot"};
    static const int grip[] = {0, 0, 2, -1, -1};
    assert_int_equal(s->contacts, 5);
    assert_int_equal(s->coordinates, 4);
    for (int c = 0; c < 5; c++) {
        assert_text(s->contact_name[c], contacts[c]);
        assert_int_equal(s->grip[c], grip[c]);
    }
    for (int i = 0; i < 4; i++)
        assert_text(s->coordinate[i].name, coordinates[i]);
    assert_true(s->postures == 2 && s->posture[0] == 2 && s->actuated[0] == 3);
    const struct {
        const char *name;
        double fallback;
    } number[] = {{"bodies.foot.centre[1]", -0.1}, {"bodies.foot.at[1]", -0.5},
                  {"bodies.foot.limits[1]", 1},    {"bodies.foot.turn", INFINITY},
                  {"contacts.flat.from[0]", -0.1}, {"contacts.flat.to[1]", -0.2},
                  {"contacts.wheel.radius", 0.1},  {"points.head.at[1]", 0.4},
                  {"points.head.lowest", 0.3},     {"bodies.base.reference[0]", 0.05},
                  {"actuators.ankle.limit", 40}};
    for (size_t k = 0; k < COUNT(number); k++) {
        int i = 0;
        while (i < s->robot_count && strcmp(s->robot[i].name, number[k].name) != 0)
            i++;
        if (i == s->robot_count || s->robot[i].fallback != number[k].fallback)
            fail_msg("%s", number[k].name);
    }
}

/* Gaps, contact points, energy, inertia, standing of the biped at random states. */
static void biped_moves(const stance_scene *s)
{
    double robot[STANCE_MAX_ROBOT], own[STANCE_MAX_ROBOT];
    uint64_t seed = 1;
    stance_robot_fallback(s, robot);
    stance_robot_fallback(biped(), own);
    for (int i = 0; i < 1000; i++) {
        double q[5], v[5], q2[5], v2[5], gap[2], at[2], speed[2], wanted[2], A[2][25];
        const int foot = i % 2;
        for (int k = 0; k < ROBOT_COUNT && s == biped(); k++) /* the closed form's own numbers */
            robot[k] = own[k] = biped()->robot[k].fallback * uniform(&seed, 0.5, 1.2);
        for (int k = 0; k < 5; k++) {
            q[k] = q2[k] = uniform(&seed, -3, 3);
            v[k] = v2[k] = uniform(&seed, -10, 10);
        }
        s->gaps(s, robot, q, gap);
        for (int c = 0; c < 2; c++) {
            const struct closed_point p = closed_point(own, q, FOOT + c);
            closed_speed(&p, v, wanted);
            s->contact_point(s, robot, q, v, c, at, speed);
            assert_near(gap[c], p.at[1], 1e-12, "gap");
            same(at, p.at, 2, 1, "contact point");
            same(speed, wanted, 2, 10, "contact speed");
        }
        s->inertia(s, robot, q, A[0]);
        closed_inertia(own, q, A[1]);
        same(A[0], A[1], 25, 10, "inertia");
        assert_near(s->energy(s, robot, q, v), closed_energy(own, q, v), 1e-10, "energy");
        s->stand(s, robot, 1u << foot, q, v);
        const struct closed_point stands = closed_point(own, q, FOOT + foot);
        closed_speed(&stands, v, speed);
        same(stands.at, (double[]){0, 0}, 2, 1, "stands");
        same(speed, (double[]){0, 0}, 2, 10, "stands still");
        same(q + 2, q2 + 2, 3, 0, "posture");
        same(v + 2, v2 + 2, 3, 0, "its rates");
        s->gaps(s, robot, q, gap);
        assert_true(gap[foot] >= 0 && gap[foot] <= 1e-15);
    }
}

/* The biped's equilibrium, its linearisation and its contact force, on either foot. */
static void biped_rests(const stance_scene *s)
{
    double robot[STANCE_MAX_ROBOT], own[STANCE_MAX_ROBOT];
    uint64_t seed = 3;
    int found = 0;
    stance_robot_fallback(s, robot);
    stance_robot_fallback(biped(), own);
    for (int i = 0; i < 200; i++) {
        stance_equilibrium_choice choice = {1, {-0.41, NAN, 0.82}, 0};
        if (i > 0) {
            choice.supports = 1u << i % 2;
            for (int k = 0; k < 3; k++)
                choice.posture[k] = uniform(&seed, -1.5, 1.5);
            choice.posture[i / 2 % 3] = NAN;
        }
        stance_equilibrium e;
        stance_message message;
        const int foot = i % 2;
        double posture[3], torque[2], weight[4] = {0};
        double A[2][36], B[2][12], force[2], by[2][12], by_torque[2][4];
        if (!closed_equilibrium(own, &choice, posture, torque))
            continue;
        if (s->equilibrium(s, robot, &choice, &e, &message) != STANCE_OK) {
            assert_true(fabs(torque[0]) > 10 || fabs(torque[1]) > 10);
            continue;
        }
        found++;
        assert_int_equal(message.text[0], 0);
        for (int k = 0; k < 3; k++)
            assert_near(remainder(e.position[2 + k] - posture[k], 2 * M_PI), 0, 1e-12, "posture");
        same(closed_point(own, e.position, FOOT + foot).at, (double[]){0, 0}, 2, 1, "position");
        same(e.torque, torque, 2, 10, "torque");
        weight[2 * foot] = closed_mass(own) * STANCE_GRAVITY;
        same(e.force[0], weight, 4, 100, "force");
        assert_true(e.freedoms == 3 && e.freedom[2] == 4 && e.condition < 1 + 1e-12);
        assert_near(e.friction, 0, 1e-12, "friction");
        OK(s->linearise(s, robot, &e, A[1], B[1]));
        OK(s->contact_force(s, robot, &e, force, by[1], by_torque[1]));
        closed_linearise(own, e.position, foot, A[0], B[0], by[0], by_torque[0]);
        same(A[1], A[0], 36, 100, "A");
        same(B[1], B[0], 12, 10, "B");
        same(force, weight + 2 * foot, 2, 100, "contact force");
        same(by[1], by[0], 12, 1000, "contact force by state");
        same(by_torque[1], by_torque[0], 4, 10, "contact force by torque");
    }
    print_message("# equilibria compared: %d\n", found);
    assert_true(found > 50);
}

/* As described, and as the program carries it. */
TEST(the_biped)
{
    SCENE *s = mechanism_scene(BIPED);
    biped_moves(s);
    biped_rests(s);
    biped_moves(biped());
    biped_rests(biped());
}

/* A rod of length l = 1 and its ends at x -+ l/2 cos, z -+ l/2 sin. */
TEST(the_rod)
{
    const stance_scene *const s = stance_scene_find("rod");
    double robot[STANCE_MAX_ROBOT];
    uint64_t seed = 5;
    stance_robot_fallback(s, robot);
    for (int i = 0; i < 100; i++) {
        double q[3], v[3], gap[2], A[9], at[2], speed[2];
        for (int k = 0; k < 3; k++) {
            q[k] = uniform(&seed, -3, 3);
            v[k] = uniform(&seed, -3, 3);
        }
        const double arm = i % 2 ? 0.5 : -0.5, sine = sin(q[2]), cosine = cos(q[2]);
        s->gaps(s, robot, q, gap);
        s->inertia(s, robot, q, A);
        s->contact_point(s, robot, q, v, i % 2, at, speed);
        same(gap, (double[]){q[1] - 0.5 * sine, q[1] + 0.5 * sine}, 2, 1, "gaps");
        same(A, (double[]){1, 0, 0, 0, 1, 0, 0, 0, 1. / 12}, 9, 1, "inertia");
        same(at, (double[]){q[0] + arm * cosine, q[1] + arm * sine}, 2, 1, "an end");
        same(speed, (double[]){v[0] - arm * v[2] * sine, v[1] + arm * v[2] * cosine}, 2, 1,
             "its speed");
        assert_near(s->energy(s, robot, q, v),
                    0.5 * (v[0] * v[0] + v[1] * v[1] + v[2] * v[2] / 12) + 9.81 * q[1], 1e-12,
                    "energy");
    }
}

/* A body turned against its parent at coordinate 0 is the same as one whose own places, and those
 * of what hangs from it, are turned by hand. */
TEST(turned_frames)
{
    const double a = 0.7;
    SCENE *s =
        mechanism_scene("body trunk free - 2 0.1 0.05 0.2 0 0 angle 0.7\n"
                        "reference 0.1 0.3\n"
                        "body arm hinge trunk 1 0.02 0.1 -0.3 0.2 0.1 angle -1.1 limits -1 1\n"
                        "body hand fixed arm 0.5 0.01 0.1 0 0.3 -0.4 angle 0.4\n"
                        "body rod slide hand 0.3 0.01 0.1 0.2 0 0.1 axis 0.6 0.8 angle 0.2\n"
                        "point foot rod 0.2 -0.3\n"
                        "sole flat trunk -0.1 -0.2 0.2 -0.2\n"
                        "actuator elbow arm 10\n");
    char text[1200];
    double at[12][2];
    /* Frames by their turns: trunk a, arm a - 1.1, hand a - 0.7 = 0, rod 0.2. */
    const double turn[12] = {a, a, a - 1.1, a, 0, a - 1.1, 0.2, 0, 0, 0.2, a, a};
    const double own[12][2] = {{0.05, 0.2}, {0.1, 0.3},  {0.1, -0.3},  {0.2, 0.1},
                               {0.1, 0},    {0.3, -0.4}, {0.1, 0.2},   {0, 0.1},
                               {0.6, 0.8},  {0.2, -0.3}, {-0.1, -0.2}, {0.2, -0.2}};
    for (int k = 0; k < 12; k++) {
        at[k][0] = cos(turn[k]) * own[k][0] - sin(turn[k]) * own[k][1];
        at[k][1] = sin(turn[k]) * own[k][0] + cos(turn[k]) * own[k][1];
    }
    snprintf(text, sizeof text,
             "body trunk free - 2 0.1 %.17g %.17g 0 0\nreference %.17g %.17g\n"
             "body arm hinge trunk 1 0.02 %.17g %.17g %.17g %.17g limits -1 1\n"
             "body hand fixed arm 0.5 0.01 %.17g %.17g %.17g %.17g\n"
             "body rod slide hand 0.3 0.01 %.17g %.17g %.17g %.17g axis %.17g %.17g\n"
             "point foot rod %.17g %.17g\nsole flat trunk %.17g %.17g %.17g %.17g\n"
             "actuator elbow arm 10\n",
             at[0][0], at[0][1], at[1][0], at[1][1], at[2][0], at[2][1], at[3][0], at[3][1],
             at[4][0], at[4][1], at[5][0], at[5][1], at[6][0], at[6][1], at[7][0], at[7][1],
             at[8][0], at[8][1], at[9][0], at[9][1], at[10][0], at[10][1], at[11][0], at[11][1]);
    SCENE *hand = mechanism_scene(text);
    double robot[2][STANCE_MAX_ROBOT];
    uint64_t seed = 8;
    stance_robot_fallback(s, robot[0]);
    stance_robot_fallback(hand, robot[1]);
    robot[0][STANCE_ROBOT_SLOPE] = robot[1][STANCE_ROBOT_SLOPE] = 0.2;
    for (int i = 0; i < 100; i++) {
        double q[2][5], v[2][5], gap[2][5], A[2][25], energy[2];
        stance_tree_numbers number[2];
        for (int k = 0; k < 5; k++) {
            q[0][k] = q[1][k] = uniform(&seed, -1, 1);
            v[0][k] = v[1][k] = uniform(&seed, -3, 3);
        }
        for (int k = 0; k < 2; k++) {
            const stance_scene *const scene = k ? hand : s;
            scene->gaps(scene, robot[k], q[k], gap[k]);
            scene->inertia(scene, robot[k], q[k], A[k]);
            energy[k] = scene->energy(scene, robot[k], q[k], v[k]);
            stance_tree_numbers_make(scene->tree, scene->mechanism, robot[k], &number[k]);
        }
        same(gap[0], gap[1], 5, 10, "gaps");
        same(A[0], A[1], 25, 10, "inertia");
        assert_near(energy[0], energy[1], 1e-11, "energy");
        same(number[0].moment[0], number[1].moment[0], 6, 10, "moments");
        same(number[0].inertia, number[1].inertia, 3, 10, "second moments");
        same(number[0].joint[0], number[1].joint[0], 6, 10, "joints");
        same(number[0].end[0], number[1].end[0], 15, 10, "ends");
        same(number[0].reference, number[1].reference, 2, 10, "reference");
        same(number[0].curvature, number[1].curvature, 3, 1000, "curvature");
    }
    assert_int_equal(memcmp(s->tree->kind, hand->tree->kind, sizeof hand->tree->kind), 0);
}

static stance_equilibrium at_rest(const stance_scene *s, const double *robot,
                                  const stance_equilibrium_choice *choice)
{
    stance_equilibrium e;
    stance_message message;
    if (s->equilibrium(s, robot, choice, &e, &message) != STANCE_OK)
        fail_msg("%s", message.text);
    return e;
}

/* A pendulum with spring, damper and rotor hangs, and stands: I a'' = -m g l sin a - k a - d a'. */
TEST(a_pendulum)
{
    const double m = 2, inertia = 0.1, l = 0.5, g = 9.81, k = 3, d = 0.4, rotor = 0.05;
    const double I = inertia + m * l * l + rotor;
    SCENE *s = mechanism_scene("body rod hinge - 2 0.1 0 -0.5 0.3 1 stiffness 3 "
                               "damping 0.4 armature 0.05\n"
                               "actuator motor rod 20\n");
    double robot[STANCE_MAX_ROBOT], A[4], B[2];
    stance_robot_fallback(s, robot);
    const stance_equilibrium e = at_rest(s, robot, &(stance_equilibrium_choice){0, {0}, 0});
    OK(s->linearise(s, robot, &e, A, B));
    same(A, (double[]){0, 1, -(m * g * l + k) / I, -d / I}, 4, 100, "A");
    same(B, (double[]){0, 1 / I}, 2, 10, "B");
    const stance_equilibrium tilted = at_rest(s, robot, &(stance_equilibrium_choice){0, {1}, 0});
    assert_near(tilted.torque[0], m * g * l * sin(1) + k, 1e-13, "torque");
}

/* (M + m) x'' - m l a'' = F,  -m l x'' + (I + m l^2) a'' = m g l a. */
TEST(a_cart_pole)
{
    const double M = 1, m = 0.1, l = 0.5, I = 0.00833, g = 1.62;
    SCENE *s = mechanism_scene("body cart slide - 1 0 0 0 0 0\n"
                               "body pole hinge cart 0.1 0.00833 0 0.5 0 0\n"
                               "actuator push cart 20\n");
    double robot[STANCE_MAX_ROBOT], A[16], B[4];
    stance_robot_fallback(s, robot);
    robot[STANCE_ROBOT_GRAVITY] = g;
    const double J = I + m * l * l, det = (M + m) * J - m * l * m * l;
    const double wanted[16] = {
        0, 0, 1, 0, 0, 0, 0, 1, 0, m * l * m * g * l / det, 0, 0, 0, (M + m) * m * g * l / det,
        0, 0};
    for (int branch = 0; branch < 2; branch++) {
        const stance_equilibrium e =
            at_rest(s, robot, &(stance_equilibrium_choice){0, {0.3, NAN}, branch});
        assert_true(e.position[0] == 0.3 && e.undetermined == 0);
        assert_near(e.position[1], branch ? M_PI : 0, 1e-14, branch ? "hangs" : "stands");
        assert_near(e.torque[0], 0, 1e-14, "force");
        if (branch == 0) {
            OK(s->linearise(s, robot, &e, A, B));
            same(A, wanted, 16, 10, "A");
            same(B, (double[]){0, 0, J / det, m * l / det}, 4, 10, "B");
        }
    }
    const stance_equilibrium anywhere =
        at_rest(s, robot, &(stance_equilibrium_choice){0, {NAN, NAN}, 0});
    assert_true(anywhere.undetermined == 1 && anywhere.position[0] == 0);
}

/* A wheel whose mass is off its axis rests on a slope with that mass above where it touches; with
 * V = m g (r a sin s + c sin a) and I + m d^2 about that point, it swings, or rolls away. */
TEST(a_heavy_side)
{
    const double m = 2, I = 0.1, r = 0.3, c = 0.1, slope = 0.2;
    SCENE *s = mechanism_scene("body hub free - 2 0.1 0.1 0 0 0\n"
                               "disc rim hub 0 0 0.3\n");
    double robot[STANCE_MAX_ROBOT], A[4], none[1];
    stance_robot_fallback(s, robot);
    robot[STANCE_ROBOT_SLOPE] = slope;
    const double up = acos(-r * sin(slope) / c);
    for (int branch = 0; branch < 2; branch++) {
        const double a = branch ? -up : up;
        const stance_equilibrium e =
            at_rest(s, robot, &(stance_equilibrium_choice){1, {NAN}, branch});
        assert_near(e.position[2], a, 1e-13, "angle");
        assert_near(e.friction, tan(slope), 1e-13, "friction");
        assert_near(e.force[0][0], m * STANCE_GRAVITY * cos(slope), 1e-12, "normal");
        const double high = r * cos(slope) + c * sin(a);
        OK(s->linearise(s, robot, &e, A, none));
        same(A, (double[]){0, 1, m * STANCE_GRAVITY * c * sin(a) / (I + m * high * high), 0}, 4,
             100, "A");
    }
    stance_equilibrium list[STANCE_MAX_BRANCHES];
    int count;
    OK(stance_mechanism_equilibria(s, robot, &(stance_equilibrium_choice){1, {NAN}, 0}, list,
                                   &count, NULL));
    assert_int_equal(count, 2);
}

/* A sentence for each reason why there is no equilibrium. */
TEST(no_equilibrium)
{
#define LAMP                                                                                       \
    "body foot free - 1 0.01 0.05 0.02 0 0\n"                                                      \
    "body arm hinge foot 3 0.1 0 0.5 0 0.1 limits -0.3 1\n"                                        \
    "sole plate foot -0.1 0 0.2 0\n"                                                               \
    "actuator ankle arm 10\n"
    static const struct {
        const char *mechanism;
        stance_equilibrium_choice choice;
        const char *text;
    } wrong[] = {
        {BIPED, {1, {-0.41, 0.82, NAN}, 0}, "there is no such posture: trunk cannot be balanced"},
        {BIPED,
         {1, {-0.41, 0.5, 0.82}, 0},
         "the conditions on the equilibrium contradict each other: trunk cannot be balanced"},
        {BIPED, {0, {NAN, NAN, NAN}, 0}, "nothing carries the weight where no contact does"},
        {BIPED, {4, {NAN, NAN, NAN}, 0}, "an equilibrium stands on some of 2 contacts"},
        {BIPED, {1, {INFINITY, NAN, NAN}, 0}, "an equilibrium's trunk must lie within +-1000"},
        {BIPED,
         {1, {-0.41, NAN, 0.82}, 2},
         "there is no branch 2 of the equilibrium: 2 found, counted from 0"},
        {BIPED, {1, {-0.9, NAN, 0.9 + M_PI / 2}, 0}, "it takes"},
        {LAMP, {3, {NAN, 0.5}, 0}, "plate_toe would have to pull, with"},
        {LAMP, {3, {NAN, -0.6}, 0}, "plate_heel would have to pull, with"},
        {LAMP, {3, {NAN, -0.35}, 0}, "beyond its limits -0.3 ... 1"},
        {LAMP, {3, {0.1, 0}, 0}, "cannot touch"},
    };
    for (size_t i = 0; i < COUNT(wrong); i++) {
        SCENE *s = mechanism_scene(wrong[i].mechanism);
        stance_equilibrium e;
        stance_message message = {""};
        double robot[STANCE_MAX_ROBOT];
        stance_robot_fallback(s, robot);
        assert_int_not_equal(s->equilibrium(s, robot, &wrong[i].choice, &e, &message), STANCE_OK);
        if (!strstr(message.text, wrong[i].text))
            fail_msg("'%s' instead of '%s'", message.text, wrong[i].text);
        assert_int_not_equal(s->equilibrium(s, robot, &wrong[i].choice, &e, NULL), STANCE_OK);
    }
#undef LAMP
}

/* Numbers of robot[] take the place of described ones. */
TEST(numbers_vary)
{
    SCENE *s = mechanism_scene("body rod hinge - 2 0.1 0 -0.5 0 0\n");
    double robot[STANCE_MAX_ROBOT], A;
    stance_robot_fallback(s, robot);
    for (int i = 0; i < s->robot_count; i++)
        if (strcmp(s->robot[i].name, "bodies.rod.mass") == 0)
            robot[i] = 5;
    s->inertia(s, robot, (double[]){0.3}, &A);
    assert_near(A, 0.1 + 5 * 0.25, 1e-15, "inertia");
}

/* A wheel on a slope stands on its lowest point, and rolls. */
TEST(a_wheel)
{
    SCENE *s = mechanism_scene("body hub free - 2 0.1 0 0 0 0\n"
                               "disc rim hub 0.01 0 0.3\n");
    double robot[STANCE_MAX_ROBOT], q[3] = {5, 5, 0.4}, v[3] = {1, 2, -3}, gap, point[2], speed[2];
    stance_robot_fallback(s, robot);
    robot[STANCE_ROBOT_SLOPE] = 0.2;
    s->stand(s, robot, 1, q, v);
    s->gaps(s, robot, q, &gap);
    assert_true(gap >= 0 && gap < 1e-16);
    s->contact_point(s, robot, q, v, 0, point, speed);
    same(point, (double[]){0, 0}, 2, 1, "at the origin");
    same(speed, (double[]){0, 0}, 2, 1, "at rest");
    assert_near(q[0], 0.3 * sin(0.2) - 0.01 * cos(0.4), 1e-15, "x of the hub");
    assert_near(q[1], 0.3 * cos(0.2) - 0.01 * sin(0.4), 1e-15, "z of the hub");
}

/* By a point too near the ground, normal to it, or a body turned too far. */
TEST(falls)
{
    SCENE *s = mechanism_scene("body base free - 1 0.1 0 0 0 0 turn 1.5\n"
                               "body arm hinge base 1 0.1 0 0.5 0 1\n"
                               "named head arm 0 0.5 0.3\n"
                               "point foot base 0 0\n");
    double robot[STANCE_MAX_ROBOT];
    stance_robot_fallback(s, robot);
    assert_false(s->fallen(s, robot, (double[]){0, 0, 0, 0}));
    assert_false(s->fallen(s, robot, (double[]){0, 0, 0, 2.5}));
    assert_false(s->fallen(s, robot, (double[]){0, -0.1, 0, M_PI}));
    assert_true(s->fallen(s, robot, (double[]){0, -0.3, 0, M_PI}));
    assert_true(s->fallen(s, robot, (double[]){0, 2, -1.6, 0}));
    robot[STANCE_ROBOT_SLOPE] = -0.5;
    assert_true(s->fallen(s, robot, (double[]){3, 0, 0, 0}));
}

/* Every joint, contact and massless tip is on the line, which ends where it began. */
TEST(figures)
{
    SCENE *s = mechanism_scene("body trunk free - 20 2.22 0 0.2 0 0\n"
                               "body thigh1 hinge trunk 6.8 1.08 0 -0.163 0 0\n"
                               "body thigh2 hinge trunk 6.8 1.08 0 -0.163 0 0\n"
                               "body shank1 hinge thigh1 3.2 0.93 0 -0.128 0 -0.4\n"
                               "body shank2 hinge thigh2 3.2 0.93 0 -0.128 0 -0.4\n"
                               "disc foot1 shank1 0 -0.4 0.05\n"
                               "sole foot2 shank2 -0.1 -0.4 0.2 -0.4\n"
                               "named head trunk 0 0.625\n");
    double robot[STANCE_MAX_ROBOT], points[STANCE_MAX_POINTS][2];
    const double q[7] = {0};
    static const double on[][2] = {{0, 0},       {0, 0.625},  {0, -0.4},
                                   {-0.1, -0.8}, {0.2, -0.8}, {0, -0.85}};
    stance_robot_fallback(s, robot);
    const int n = s->figure(s, robot, q, points);
    for (size_t k = 0; k < COUNT(on); k++) {
        double least = 1;
        for (int i = 0; i < n; i++)
            least = fmin(least, hypot(points[i][0] - on[k][0], points[i][1] - on[k][1]));
        assert_near(least, 0, 1e-15, "a point of the figure");
    }
    assert_memory_equal(points[0], points[n - 1], sizeof points[0]);
}
