/* rod.c - a rigid rod whose two ends may touch level ground.
 *
 * q = (x, z, theta): the centre of mass, in the middle, and the angle against the horizontal,
 * counter-clockwise. With mass m, length L = 2 a, inertia I = k m L^2 (uniform rod: k = 1/12) the
 * ends e = 1, 2 are at (x, z) + sigma_e a (cos theta, sin theta), sigma = (-1, +1), and
 *
 *   m x'' = sum lambda_T,   m z'' = -m g + sum lambda_N,
 *   I theta'' = sum sigma_e a (lambda_N cos theta - lambda_T sin theta),
 *   gap_e = z + sigma_e a sin theta,
 *   U_e = (z' + sigma_e a theta' cos theta,  x' - sigma_e a theta' sin theta).
 *
 * Painleve: an end that slides with sign s = sign(U_T) under full friction feels the normal
 * acceleration D lambda_N + free, with
 *
 *   D = (1 + (m a^2 / I) (cos^2 theta + mu s sin theta cos theta)) / m,
 *   free = -g - sigma_e a theta'^2 sin theta.
 *
 * Where D < 0 there are two sets of contact forces (free > 0) or none (free < 0). That takes
 * friction of more than (2 / p) sqrt(1 + p), p = m a^2 / I: 4/3 for a uniform rod, where the angle
 * against the ground is arctan 2, with the sliding end ahead of the centre. There the rod jams, and
 * only an impact without collision frees it.
 */
#include "engine/stance.h"

enum { LENGTH, MASS, INERTIA_RATIO, ROBOT_COUNT };
enum { X, Z, THETA, COORDINATES };
enum { ENDS = 2 };

extern const stance_scene stance_scene_rod;

static const stance_quantity robot_quantities[ROBOT_COUNT] = {
    [LENGTH] = {"length", "m", "length of the rod", 1, 1e-3, 1e3},
    [MASS] = {"mass", "kg", "mass of the rod", 1, 1e-6, 1e6},
    [INERTIA_RATIO] = {"inertia_ratio", "1",
                       "moment of inertia about the centre, in masses times squared lengths; 1/12: "
                       "uniform, 1/4: all mass at the ends",
                       1. / 12, 1e-3, 0.25},
};

static const stance_quantity coordinate_quantities[COORDINATES] = {
    [X] = {"x", "m", "horizontal position of the centre", 0, -1e6, 1e6},
    [Z] = {"z", "m", "height of the centre above the ground", 1, -1e6, 1e6},
    [THETA] = {"theta", "rad", "angle against the horizontal, counter-clockwise", 0, -1e3, 1e3},
};

static const char *const contact_names[ENDS] = {"end1", "end2"};

/* From the centre to an end: sigma_e a. */
static double arm(const double *robot, int end)
{
    return (end == 0 ? -0.5 : 0.5) * robot[LENGTH];
}

static void contact_point(const stance_scene *scene, const double *robot, const double *position,
                          const double *velocity, int contact, double point[2], double speed[2])
{
    (void)scene;
    const double to_end = arm(robot, contact), turn = to_end * velocity[THETA];
    double sine, cosine;
    stance_sincos(position[THETA], &sine, &cosine);
    point[0] = position[X] + to_end * cosine;
    point[1] = position[Z] + to_end * sine;
    speed[0] = velocity[X] - turn * sine;
    speed[1] = velocity[Z] + turn * cosine;
}

static void gaps(const stance_scene *scene, const double *robot, const double *position,
                 double *gap)
{
    static const double rest[COORDINATES];
    double point[2], speed[2];
    for (int i = 0; i < ENDS; i++) {
        contact_point(scene, robot, position, rest, i, point, speed);
        gap[i] = point[1];
    }
}

static int figure(const stance_scene *scene, const double *robot, const double *position,
                  double points[][2])
{
    static const double rest[COORDINATES];
    double speed[2];
    for (int i = 0; i < ENDS; i++)
        contact_point(scene, robot, position, rest, i, points[i], speed);
    return ENDS;
}

static double energy(const stance_scene *scene, const double *robot, const double *position,
                     const double *velocity)
{
    (void)scene;
    const double turn = robot[LENGTH] * velocity[THETA];
    return robot[MASS] * (0.5 * (velocity[X] * velocity[X] + velocity[Z] * velocity[Z] +
                                 robot[INERTIA_RATIO] * (turn * turn)) +
                          STANCE_GRAVITY * position[Z]);
}

static void inertia(const stance_scene *scene, const double *robot, const double *position,
                    double *A)
{
    (void)scene, (void)position;
    for (int i = 0; i < COORDINATES * COORDINATES; i++)
        A[i] = 0;
    A[0] = A[4] = robot[MASS];
    A[8] = robot[INERTIA_RATIO] * robot[MASS] * (robot[LENGTH] * robot[LENGTH]);
}

static void flight(const double even[2], stance_case *c)
{
    c->position[Z] = 1000;
    c->velocity[THETA] = 8 * even[0] - 4;
}

/* Upright on an end but for a hundredth: it tilts about that end for more than a second. */
static void one_end(const double even[2], stance_case *c)
{
    double gap[ENDS];
    c->position[THETA] = 1.5707963267948966 + 0.02 * even[0] - 0.01;
    gaps(&stance_scene_rod, c->robot, c->position, gap);
    c->position[Z] -= gap[0];
}

static void two_ends(const double even[2], stance_case *c)
{
    c->friction = 0.05;
    c->velocity[X] = 1 + even[0];
}

static const stance_workload workloads[] = {
    {"flight", NULL, flight}, {"one end", NULL, one_end}, {"two ends", NULL, two_ends}, {0}};

const stance_scene stance_scene_rod = {
    .name = "rod",
    .text = "rigid rod, both ends of which may touch level ground",
    .coordinates = COORDINATES,
    .contacts = ENDS,
    .robot_count = ROBOT_COUNT,
    .robot = robot_quantities,
    .coordinate = coordinate_quantities,
    .contact_name = contact_names,
    .gaps = gaps,
    .contact_point = contact_point,
    .figure = figure,
    .energy = energy,
    .inertia = inertia,
    .workload = workloads,
};
