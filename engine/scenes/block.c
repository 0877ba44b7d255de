/* block.c - a block that does not turn, on an inclined plane, pulled along it by a sinusoid.
 *
 * q = (x, z) in the plane's own frame: x along it, downhill positive for a positive slope, z
 * normal to it, the height of the block's underside. With mass m, slope alpha, pull P sin(2 pi f
 * t):
 *
 *   m x'' = m g sin alpha + P sin(2 pi f t) + lambda_T,   m z'' = -m g cos alpha + lambda_N,
 *
 * gap = z, U = (z', x'). Without a pull the block stays where it was put for tan |alpha| <= mu and
 * otherwise slides with g (sin alpha - mu cos alpha sign alpha); thrown downhill at v it stops
 * after the distance v^2 / (2 g (mu cos alpha - sin alpha)) where mu > tan alpha. On level ground
 * with a pull it never slips for P <= mu m g and alternates between stick and slip beyond.
 *
 * Energy: kinetic and m g (z cos alpha - x sin alpha); the pull does work on it.
 */
#include "engine/stance.h"

enum { MASS, SLOPE, PULL, PULL_FREQUENCY, ROBOT_COUNT };
enum { X, Z, COORDINATES };

/* The block has no size; it is drawn with this one, m. */
static const double drawn_width = 0.2, drawn_height = 0.1;

extern const stance_scene stance_scene_block;

static const stance_quantity robot_quantities[ROBOT_COUNT] = {
    [MASS] = {"mass", "kg", "mass of the block", 1, 1e-6, 1e6},
    [SLOPE] = {"slope", "rad", "angle of the plane; positive: the block's +x is downhill", 0, -1.5,
               1.5},
    [PULL] = {"pull", "N",
              "amplitude of the force along the plane, pull sin(2 pi pull_frequency t)", 0, -1e9,
              1e9},
    [PULL_FREQUENCY] = {"pull_frequency", "Hz", "frequency of the pull", 1, 0, 1e6},
};

static const stance_quantity coordinate_quantities[COORDINATES] = {
    [X] = {"x", "m", "position along the plane, downhill", 0, -1e6, 1e6},
    [Z] = {"z", "m", "height of the underside above the plane, normal to it", 0, -1e6, 1e6},
};

static const char *const contact_names[] = {"base"};

static void gaps(const stance_scene *scene, const double *robot, const double *position,
                 double *gap)
{
    (void)scene, (void)robot;
    gap[0] = position[Z];
}

static void contact_point(const stance_scene *scene, const double *robot, const double *position,
                          const double *velocity, int contact, double point[2], double speed[2])
{
    (void)scene, (void)robot, (void)contact; /* there is one */
    point[0] = position[X];
    point[1] = position[Z];
    speed[0] = velocity[X];
    speed[1] = velocity[Z];
}

/* In the plane's frame, as everything; from the middle of the base round to it. */
static int figure(const stance_scene *scene, const double *robot, const double *position,
                  double points[][2])
{
    (void)scene;
    static const double corner[][2] = {{0, 0}, {0.5, 0}, {0.5, 1}, {-0.5, 1}, {-0.5, 0}, {0, 0}};
    const int n = sizeof corner / sizeof corner[0];
    (void)robot;
    for (int i = 0; i < n; i++) {
        points[i][0] = position[X] + drawn_width * corner[i][0];
        points[i][1] = position[Z] + drawn_height * corner[i][1];
    }
    return n;
}

static double energy(const stance_scene *scene, const double *robot, const double *position,
                     const double *velocity)
{
    (void)scene;
    double sine, cosine;
    stance_sincos(robot[SLOPE], &sine, &cosine);
    return robot[MASS] * (0.5 * (velocity[X] * velocity[X] + velocity[Z] * velocity[Z]) +
                          STANCE_GRAVITY * (cosine * position[Z] - sine * position[X]));
}

static void inertia(const stance_scene *scene, const double *robot, const double *position,
                    double *A)
{
    (void)scene, (void)position;
    A[0] = A[3] = robot[MASS];
    A[1] = A[2] = 0;
}

static void at_rest(const double even[2], stance_case *c)
{
    c->robot[SLOPE] = 0.6 * even[0]; /* arctan 0.8 = 0.67 */
}

static void sliding(const double even[2], stance_case *c)
{
    c->friction = 0.3;
    c->robot[SLOPE] = 0.5 + 0.5 * even[0];
}

static const stance_workload workloads[] = {
    {"at rest", NULL, at_rest}, {"sliding", NULL, sliding}, {0}};

const stance_scene stance_scene_block = {
    .name = "block",
    .text = "block that does not turn, on an inclined plane, pulled along it",
    .coordinates = COORDINATES,
    .contacts = 1,
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
