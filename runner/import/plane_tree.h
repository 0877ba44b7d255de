/* plane_tree.h - the tree of links that move against each other in the plane, while it is made.
 *
 * All of it is measured in one posture: joints at `reference`, welded ones at `start`.
 */
#ifndef RUNNER_IMPORT_PLANE_TREE_H
#define RUNNER_IMPORT_PLANE_TREE_H

#include "plane.h"

#include "runner/base/message.h"

/* A link: what one joint moves. All bodies that are fixed to each other are one. */
struct plane_link {
    int parent; /* -1: the world */
    int joint;  /* of the file; of a free root made of three the hinge */
    int body;   /* of the file, whose frame it has; of a link between the joints of one body that
                 * body, too */
    bool between;
    stance_joint kind;
    double at[2];   /* m, of its frame's origin, in the plane */
    double turn;    /* rad, of its frame */
    double axis[2]; /* of a slide */
    double sign;    /* of a hinge */
    int children;
    double mass;
    bool touches; /* something of it may touch the ground */
};

struct plane_tree {
    struct spatial_model *model;
    const struct plane_wishes *wishes;
    struct plane_robot *robot;
    stance_message *message;
    struct plane_pose {
        double at[3], rotation[3][3];
    } * pose; /* [bodies] in the world */
    struct plane_line {
        double at[3], axis[3];
    } * line;     /* [joints] in the world */
    int *link_of; /* [bodies] -1: fixed to the world */
    bool *welded; /* [joints] asked for */
    int links;
    struct plane_link *link; /* [joints] parents first */
    bool has_floor;          /* the file has one */
    bool along_floor;        /* ... which the plane is parallel to */
    double floor_friction;   /* NAN: not given */
};

/* Fills message with "FILE:LINE: ..."; line 0: not known. plane_refuse(t, line, format, ...) is
 * false. */
void plane_say(const struct plane_tree *t, int line, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
#define plane_refuse(...) (plane_say(__VA_ARGS__), as_false())

/* What a joint is called; without a name as its body is. */
const char *plane_joint_name(const struct plane_tree *t, int j);

/* Poses, the plane, links, the root, floor and gravity. */
bool plane_tree_make(struct plane_tree *t);
void plane_tree_free(struct plane_tree *t);

/* A place of the file's world in the plane; a direction. */
void plane_place(const struct plane_tree *t, const double at[3], double out[2]);
void plane_direction(const struct plane_tree *t, const double of[3], double out[2]);
/* A place of a body's frame in the frame of that body's link. */
void plane_in_link(const struct plane_tree *t, int body, const double at[3], double out[2]);
/* R(angle) v; out may be v. */
void plane_turn(double angle, const double v[2], double out[2]);

/* plane_contacts.c: what may touch, into the mechanism, with ground.friction. */
bool plane_contacts(struct plane_tree *t);
/* plane_drives.c: motors and servos. */
bool plane_drives(struct plane_tree *t);
/* plane_names.c: of links; of contacts and motors by what they are called in the file. */
void plane_name_bodies(struct plane_tree *t);
void plane_name_contact(struct plane_tree *t, int element, const char *geom);
void plane_name_actuator(struct plane_tree *t, int actuator, const char *joint, const char *own);

#endif
