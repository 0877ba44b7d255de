/* compare.h - whether the robot of the plane moves as that of the file does, by MuJoCo.
 *
 * In random states (angles within their limits or +-1 rad, rates within +-2 rad/s, torques within
 * their limits or +-10 N m) the accelerations of the scene are compared with those of the file's
 * bodies, which nothing but the plane holds: S' M S a = S' forces, S being the file's
 * coordinates that move in it. Without contacts, stops and dry friction.
 */
#ifndef RUNNER_IMPORT_COMPARE_H
#define RUNNER_IMPORT_COMPARE_H

#include "plane.h"

#define COMPARE_ADMITTED 1e-9

struct compare_report {
    int states;
    bool itself;           /* with the file itself, not with what was read of it */
    double worst;          /* largest difference, by the largest acceleration of its state */
    int state, coordinate; /* where: from 1; of the scene */
};

/* `model` and `map` are of the file at `path`, `scene` and `c` of the scenario made of it, with its
 * first case. Of MJCF the file itself is loaded again, of others `model` is what is compared with.
 * False: `message` says why there is nothing to compare with (as without libmujoco, whose errors
 * end the process: for runner/base/sandbox.h). */
bool import_compare(const struct spatial_model *model, const char *path,
                    const struct plane_map *map, const stance_scene *scene, const stance_case *c,
                    struct compare_report *report, spatial_message *message);

/* "100 random states: accelerations agree with the file's to 3.1e-13 (...)" (or "those of what was
 * read of it"), or, beyond what is admitted, that they do not. Returns `text`. */
const char *compare_sentence(const struct compare_report *report, const stance_scene *scene,
                             char *text, size_t size);

#endif
