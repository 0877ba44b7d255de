/* gait.h - the cycles of a walking robot: the map from one footfall to the next, its fixed points,
 * which are gaits, what they cost, how they vary, and how they go on along a number.
 *
 * The section is the state just after a footfall, read with the leg that landed as the first one,
 * without its place along the ground: both feet are on the ground, so that one angle follows from
 * the others, and the foot that stands rests, so that x, z and their rates follow. Its coordinates
 * are the posture's angles but that one, and all their rates. A gait of k steps is a fixed point of
 * the map of k footfalls. Each point that is mapped is a case, so that a derivative is a batch.
 */
#ifndef STANCE_GAIT_GAIT_H
#define STANCE_GAIT_GAIT_H

#include "analysis/draw/look.h"
#include "analysis/table/table.h"
#include "engine/mechanism.h"

enum { RETURN_MAP_MOST = 2 * STANCE_MAX_POSTURE };

struct return_map {
    const stance_scene *scene;
    const stance_kernel *kernel;
    int steps;   /* footfalls of a return */
    long made;   /* footfalls before, of which messages tell, too */
    int foot[2]; /* the contact that each leg stands on */
    int follows; /* place in the posture of the angle that follows from the others */
    int n;       /* coordinates of the section */
    stance_case base;
    double posture[STANCE_MAX_COORDINATES]; /* where the angle that follows is looked for */
};

/* A point of the section, and how a return came to it. */
struct return_point {
    double z[RETURN_MAP_MOST];
    double behind; /* m: height of the foot behind over the ground under the other one; 0 in a gait,
                    * not 0 on ground that is not even */
    double time, length; /* s, m: of the return, along the ground */
    stance_result result;
};

/* The section of a robot as a case begins it, after `settle` footfalls from there, to *from. False,
 * with a message: it has none, or does not come so far. */
bool return_map_begin(struct return_map *map, const stance_case *c, const stance_kernel *kernel,
                      int steps, int settle, struct return_point *from, stance_message *message);
/* The same robot, numbers and law changed: the map of that case, its section as it was. False, with
 * a message, as above. */
bool return_map_change(struct return_map *map, const stance_case *c, stance_message *message);
/* Position and velocity at a point of the section, standing on the first leg's foot. */
bool return_map_state(const struct return_map *map, const struct return_point *at, double *position,
                      double *velocity);
/* Place (m) and speed (m/s) of foot 0 or 1 in a state, each along the ground and off it. */
void return_map_foot(const struct return_map *map, const double *position, const double *velocity,
                     int foot, double place[2], double speed[2]);
/* Maps points from[count], of which z and behind matter; the others may be the same ones. False,
 * with a message: one of them falls, or makes no such step. */
bool return_map_take(const struct return_map *map, size_t count, const struct return_point *from,
                     struct return_point *to, stance_message *message);
/* From a point on: after `first` footfalls, of legs that are alike one by one, the times between
 * the next `count`, in s; of others the mean of each return. False: it does not come so far. */
bool return_map_settle(const struct return_map *map, const struct return_point *from, size_t first,
                       size_t count, double *time);
/* Name of coordinate i of the section, "q1" or "vq1". */
const char *return_map_name(const struct return_map *map, int i, char name[STANCE_NAME + 2]);
/* What begins a scenario at a point, its second foot about so high (m) over the ground:
 * "initial={state: ...}", to be freed by the caller; NULL: no memory. */
char *return_map_initial(const struct return_map *map, const struct return_point *at,
                         double height);

/* A fixed point. */
struct gait {
    struct return_point from, at; /* where it is, and what returns there */
    double residual; /* largest difference of a coordinate after a return, rad or rad/s */
    int iterations;
    /* Multipliers, the largest first, of conjugate ones that with im > 0; and how far those of two
     * difference steps are apart. */
    double re[RETURN_MAP_MOST], im[RETURN_MAP_MOST], error[RETURN_MAP_MOST];
    bool stable; /* all within the unit circle, by more than their errors */
    double J[RETURN_MAP_MOST * RETURN_MAP_MOST]; /* [n][n], columns: the map's derivative */
    double by[RETURN_MAP_MOST][2]; /* the return's time and length by each coordinate */
};

/* Newton's method from a point. False, with a message: it does not converge. */
bool gait_find(const struct return_map *map, const struct return_point *from, struct gait *gait,
               stance_message *message);
/* Footfalls after which it repeats already: the map's steps, or a divisor of them. */
int gait_repeats(const struct return_map *map, const struct gait *gait);

/* What a gait costs, and how far it is from what would end it. */
struct gait_margins {
    double cost; /* the answer cost_of_transport; NAN: nothing is actuated, or it has more than 4
                    steps */
    double impact_friction; /* the answer */
    double lift; /* m/s, at which the foot that stood leaves the ground after the footfall; 0: it
                  * stays there */
    /* m, of the other foot in the first step, at the ends of time steps: its height where it is
     * ahead, at most; its depth before that, at most, 0: it is above the ground. */
    double clearance, under;
    /* Of outputs that follow the robot: their phase in the first step as a polynomial of the time,
     * and how far it is off, at most; else NAN. */
    double clock[STANCE_MAX_COEFFICIENTS], clock_off;
    double least_normal_force; /* N, of the foot that stands, the least mean over a time step */
};
/* Lets the gait walk once more. False, with a message: out of memory, or it falls. */
bool gait_margins_find(const struct return_map *map, const struct gait *gait,
                       struct gait_margins *margins, stance_message *message);

/* ---- along a number of the scenario --------------------------------------------------------- */

/* The gait at `count` values of a path, evenly from the first to the last, and between them where a
 * multiplier passes -1 (flip: steps begin to alternate) or 1 (fold: the gait ends). */
struct along {
    char path[96];
    double from, to;
    size_t count;
    int steps, settle; /* as of return_map_begin */
    bool settled;      /* it is asked what each gait comes to, slightly off it */
    struct look *look; /* a picture is asked for; NULL: a table */
};

/* Times of so many steps, after so many footfalls. */
enum { ALONG_TIMES = 16, ALONG_WALKED = 200 };

/* A gait on the way. */
struct along_gait {
    double value, period, length;
    int n;
    double re[RETURN_MAP_MOST], im[RETURN_MAP_MOST], error;
    bool stable;
    const char *place;        /* "flip", "fold", "jump"; NULL: one of the values asked for */
    int settled;              /* how many step times follow; 0: it falls, or it is not asked */
    double time[ALONG_TIMES]; /* s */
};

extern const struct say_key along_keys[]; /* of the rows' JSON */
/* Follows it, from the values of `s` but for the path's, and says so, or draws it. Each returns an
 * exit code, and says on standard error why it failed. */
int along_say(const struct scenario *s, const struct along *along, enum table_form form);
int along_draw(const struct scenario *s, const struct along *along, const struct along_gait *gait,
               size_t count);

/* The scenario's text without what makes cases of it, to be freed by the caller; NULL: no memory.
 */
char *along_plain(const struct scenario *s);
/* The scenario of a plain text with a number changed, of which a map is to be made: with a map of
 * before it begins near its point, the second foot off the ground, as that may be another one now.
 * NULL: it has been said why. */
struct scenario *along_at(const char *file, const char *plain, const char *path, double value,
                          const struct return_map *map, const struct return_point *at);
/* Says in a message, if there is one, of which value it is. */
void along_blame(const char *path, double value, stance_message *message);

/* Standard deviations where a number of the scenario is drawn anew in each return, evenly between
 * two values: of the return's time and length, and of length by time. */
struct gait_sensitivity {
    double time, length, speed; /* s, m, m/s */
    double error; /* relative: largest difference between two widths, and the residual's part */
};
/* Of the number along->path between along->from and along->to, of a gait that holds, of a scenario
 * without a sweep. False, with a message, or said (empty): the scenario does not
 * admit a value, or nothing changes beyond the residual. */
bool gait_sensitivity_find(const struct scenario *s, const struct return_map *map,
                           const struct gait *gait, const struct along *along,
                           struct gait_sensitivity *sensitivity, stance_message *message);

#endif
