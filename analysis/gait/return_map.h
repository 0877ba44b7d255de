/* return_map.h - from one footfall to the next: the map whose fixed points are gaits.
 *
 * The section is the state just after a footfall, read with the leg that landed as the first one,
 * without its place along the ground: both feet are on the ground, so that one angle follows from
 * the others, and the foot that stands rests, so that x, z and their rates follow. Its coordinates
 * are the posture's angles but that one, and all their rates. A gait of k steps is a fixed point of
 * the map of k footfalls. Each point that is mapped is a case, so that a derivative is a batch.
 */
#ifndef STANCE_GAIT_RETURN_MAP_H
#define STANCE_GAIT_RETURN_MAP_H

#include "engine/mechanism.h"

enum { RETURN_MAP_MOST = 2 * STANCE_MAX_POSTURE };

struct return_map {
    const stance_scene *scene;
    const stance_kernel *kernel;
    int steps;   /* footfalls of a return */
    int foot[2]; /* the contact that each leg stands on */
    int follows; /* place in the posture of the angle that follows from the others */
    int n;       /* coordinates of the section */
    stance_case base;
    double posture[STANCE_MAX_COORDINATES]; /* where the angle that follows is looked for */
    double behind; /* m: height of the foot behind over the ground under the other one, where a
                    * return begins; 0 in a gait */
};

/* What became of a point: where it returned to, after how long and how far along the ground. */
struct return_point {
    double z[RETURN_MAP_MOST];
    double time, length; /* s, m */
    double behind;       /* m, as above, where it ends: not 0 on ground that is not even */
    stance_result result;
};

/* The section of a robot as a case begins it, after `settle` footfalls from there, to z[]. False,
 * with a message: it has none, or does not come so far. */
bool return_map_begin(struct return_map *map, const stance_case *c, const stance_kernel *kernel,
                      int steps, int settle, double *z, stance_message *message);
/* The same robot, numbers and law changed: the map of that case, its section as it was. False, with
 * a message, as above. */
bool return_map_change(struct return_map *map, const stance_case *c, stance_message *message);
/* Position and velocity at a point of the section, standing on the first leg's foot. */
bool return_map_state(const struct return_map *map, const double *z, double *position,
                      double *velocity);
/* Place (m) and speed (m/s) of foot 0 or 1 in a state, each along the ground and off it. */
void return_map_foot(const struct return_map *map, const double *position, const double *velocity,
                     int foot, double place[2], double speed[2]);
/* Turns the angle that follows so that the second foot is about so high over the ground, m. */
void return_map_lift(const struct return_map *map, double height, double *position);
/* Maps points[count]; false, with a message: one of them falls, or makes no such step. */
bool return_map_take(const struct return_map *map, size_t count, const double (*z)[RETURN_MAP_MOST],
                     struct return_point *point, stance_message *message);
/* From a point on: after `first` footfalls, of legs that are alike one by one, the times between
 * the next `count`, in s; of others the mean of each return. False: it does not come so far. */
bool return_map_settle(const struct return_map *map, const double *z, size_t first, size_t count,
                       double *time);
/* Name of coordinate i of the section, "q1" or "vq1". */
const char *return_map_name(const struct return_map *map, int i, char name[STANCE_NAME + 2]);

/* A fixed point. */
struct gait {
    double z[RETURN_MAP_MOST];
    double residual; /* largest difference of a coordinate after a return, rad or rad/s */
    int iterations;
    struct return_point at; /* the return from there */
    /* Multipliers, the largest first, of conjugate ones that with im > 0; and how far those of two
     * difference steps are apart. */
    double re[RETURN_MAP_MOST], im[RETURN_MAP_MOST], error[RETURN_MAP_MOST];
    bool stable; /* all within the unit circle, by more than their errors */
    double J[RETURN_MAP_MOST * RETURN_MAP_MOST]; /* [n][n], columns: the map's derivative */
    double by[RETURN_MAP_MOST][2]; /* the return's time and length by each coordinate */
};

/* Footfalls after which it repeats already: the map's steps, or a divisor of them. */
int gait_repeats(const struct return_map *map, const struct gait *gait);

/* Newton's method from z[]. False, with a message: it does not converge. */
bool gait_find(const struct return_map *map, const double *z, struct gait *gait,
               stance_message *message);

#endif
