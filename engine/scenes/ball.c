/* ball.c - a ball that does not spin, above level ground.
 *
 * q = (x, z), the centre. With mass m and radius R:
 *
 *   m x'' = lambda_T,   m z'' = -m g + lambda_N,   gap = z - R,   U = (z', x'),
 *
 * lambda acting at the lowest point (x, z - R). Dropped from rest with gap H it lands after
 * sqrt(2 H / g) with the speed sqrt(2 g H); with restitution e its k-th rebound reaches e^(2k) H
 * and lasts 2 e^k sqrt(2 H / g), so that for e < 1 infinitely many rebounds are over at the time
 *
 *   sqrt(2 H / g) (1 + e) / (1 - e).
 *
 * Friction acts at the centre of a ball that does not spin: at an impact it takes at most
 * mu (1 + e) |z'| of the horizontal speed, while sliding mu g of it per second.
 */
#include "engine/stance.h"

enum { MASS, RADIUS, ROBOT_COUNT };
enum { X, Z, COORDINATES };
enum { SIDES = 20 }; /* of the polygon that is drawn for the circle */

_Static_assert(SIDES + 1 <= STANCE_MAX_POINTS, "the figure fits");

extern const stance_scene stance_scene_ball;

static const stance_quantity robot_quantities[ROBOT_COUNT] = {
    [MASS] = {"mass", "kg", "mass of the ball", 1, 1e-6, 1e6},
    [RADIUS] = {"radius", "m", "radius of the ball; 0: a point", 0.1, 0, 1e3},
};

static const stance_quantity coordinate_quantities[COORDINATES] = {
    [X] = {"x", "m", "horizontal position of the centre", 0, -1e6, 1e6},
    [Z] = {"z", "m", "height of the centre above the ground", 1, -1e6, 1e6},
};

static const char *const contact_names[] = {"bottom"};

static void gaps(const stance_scene *scene, const double *robot, const double *position,
                 double *gap)
{
    (void)scene;
    gap[0] = position[Z] - robot[RADIUS];
}

static void contact_point(const stance_scene *scene, const double *robot, const double *position,
                          const double *velocity, int contact, double point[2], double speed[2])
{
    (void)scene, (void)contact; /* there is one */
    point[0] = position[X];
    point[1] = position[Z] - robot[RADIUS];
    speed[0] = velocity[X];
    speed[1] = velocity[Z];
}

static int figure(const stance_scene *scene, const double *robot, const double *position,
                  double points[][2])
{
    (void)scene;
    const int n = robot[RADIUS] > 0 ? SIDES + 1 : 1;
    for (int i = 0; i < n; i++) { /* from the lowest point round to it */
        double sine, cosine;
        stance_sincos(2 * 3.14159265358979323846 / SIDES * (i % SIDES), &sine, &cosine);
        points[i][0] = position[X] + robot[RADIUS] * sine;
        points[i][1] = position[Z] - robot[RADIUS] * cosine;
    }
    return n;
}

static double energy(const stance_scene *scene, const double *robot, const double *position,
                     const double *velocity)
{
    (void)scene;
    return robot[MASS] * (0.5 * (velocity[X] * velocity[X] + velocity[Z] * velocity[Z]) +
                          STANCE_GRAVITY * position[Z]);
}

static void inertia(const stance_scene *scene, const double *robot, const double *position,
                    double *A)
{
    (void)scene, (void)position;
    A[0] = A[3] = robot[MASS];
    A[1] = A[2] = 0;
}

static void flight(const double even[2], stance_case *c)
{
    c->position[Z] = 1000;
    c->velocity[X] = 4 * even[0] - 2;
}

/* Friction 0.05 takes 0.5 m/s in a second. */
static void sliding(const double even[2], stance_case *c)
{
    c->friction = 0.05;
    c->position[Z] = c->robot[RADIUS];
    c->velocity[X] = 1 + even[0];
}

static const stance_workload workloads[] = {
    {"flight", NULL, flight}, {"sliding", NULL, sliding}, {0}};

const stance_scene stance_scene_ball = {
    .name = "ball",
    .text = "ball that does not spin, on level ground",
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
