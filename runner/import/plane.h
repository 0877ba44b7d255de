/* plane.h - a robot of the plane: what plane.c makes of a spatial model.
 *
 * The plane: `ahead` (x) and `up` (z, against gravity) are unit vectors of the file's world,
 * `normal` = ahead x up is what angles turn about (-y for the world's x and z), `origin` is where x
 * = z = 0, on the ground: place p of the file's world is at x = (p - origin) . ahead, z = (p -
 * origin) . up.
 */
#ifndef RUNNER_IMPORT_PLANE_H
#define RUNNER_IMPORT_PLANE_H

#include "spatial.h"

#include "engine/mechanism.h"

/* What is what in file and scene. Joints that move no coordinate are held at `start`. */
struct plane_map {
    double ahead[3], up[3], normal[3], origin[3];
    int coordinates; /* of the scene, in its order */
    struct {
        int joint;   /* index of the spatial model's; -1: x, z, angle of a free root, see below */
        double sign; /* the file's = sign * the scene's */
    } coordinate[STANCE_MAX_COORDINATES];
    bool free_root;
    int root_joints, root_joint[3]; /* a free one; or two slides and a hinge, in the file's order */
    int root_body;                  /* of the file: that carries the root's frame */
    double root_at[3];              /* m, of that frame's origin, in that body's frame */
    double root_angle; /* the scene's angle = it + how that body is turned in the plane (x ahead,
                        * y up) by space_turned */
    bool *held;        /* [joints] moves no coordinate: welded, or of a link without mass */
    int actuators;     /* of the scene, in its order */
    struct {
        int actuator; /* index of the spatial model's */
        double sign;  /* the scene's torque = sign * the force of that joint in the file */
    } actuator[STANCE_MAX_ACTUATORS];
};

/* What the command asks for. */
struct plane_wishes {
    const char *plane; /* "xz", "yz", "xy"; NULL: as the joints and gravity say */
    const char *const *weld, *const *sole; /* JOINT; LINK=X,Z,X,Z */
    size_t welds, soles;
};

/* The robot that plane.c makes: all of the scenario but its title. */
struct plane_robot {
    stance_mechanism mechanism; /* bodies parents first, without `number` */
    struct plane_map map;
    double gravity, slope, friction, step;
    double start[STANCE_MAX_COORDINATES]; /* coordinates, in the scene's order */
    bool hold;                            /* servos, all with these gains */
    double kp, kd;
};

/* False: `message` says file, line and what to do. Notes are added to the model's, and its joints
 * begin where they do in the scene. `robot` is to be freed either way. */
bool plane_make(struct spatial_model *model, const struct plane_wishes *wishes,
                struct plane_robot *robot, spatial_message *message);
void plane_free(struct plane_robot *robot);

#endif
