/* plane_tree.h - the tree of links that move against each other in the plane, while it is made.
 *
 * Places of the plane are complex numbers, x + i z, so that a factor e^(i angle) turns them. Poses
 * are in the plane's axes: x, z and across.
 */
#ifndef RUNNER_IMPORT_PLANE_TREE_H
#define RUNNER_IMPORT_PLANE_TREE_H

#include "plane.h"

#include <complex.h>
#include <math.h>

/* A link: what one joint moves. All bodies that are fixed to each other are one. */
struct plane_link {
    int parent; /* -1: the world */
    int joint;  /* of the file; of a free root made of three the hinge */
    int body;   /* of the file, whose frame it has; of a link between the joints of one body that
                 * body, too */
    bool between;
    stance_joint kind;
    double complex at, axis; /* m, of its frame's origin; of a slide */
    double turn, sign;       /* rad, of its frame; of a hinge */
    int children;
    double mass;
    bool touches; /* something of it may touch the ground */
};

struct plane_pose {
    double at[3], rotation[3][3];
};

struct plane_tree {
    struct spatial_model *model;
    const struct plane_wishes *wishes;
    struct plane_robot *robot;
    spatial_message *message;
    struct plane_pose base, /* of the file's world */
        *pose, *start;      /* [bodies] joints at `reference` (held ones at `start`); at `start` */
    double (*axis)[3], (*line)[3]; /* [joints] a joint's direction, a place on it; at `reference` */
    bool *held;                    /* [joints] of the map */
    int *link_of;                  /* [bodies] -1: fixed to the world */
    int links;
    struct plane_link *link; /* [joints] parents first */
    bool has_floor;          /* the file has one */
    bool along_floor;        /* ... which the plane is parallel to */
    double floor_friction;   /* NAN: not given */
};

#define plane_refuse(t, ...) spatial_refuse((t)->model, (t)->message, __VA_ARGS__)

/* What a joint is called; without a name as its body is. */
const char *plane_joint_name(const struct plane_tree *t, int j);

/* Poses, the plane, links, the root, floor and gravity. */
bool plane_tree_make(struct plane_tree *t);
void plane_tree_free(struct plane_tree *t);
/* Where bodies are: into t->pose (and lines), or into t->start. */
void plane_pose_all(struct plane_tree *t, struct plane_pose *pose);

/* A place of a body's frame (-1: the world's) in the plane, with all bodies at `pose`. */
double complex plane_place(const struct plane_tree *t, const struct plane_pose *pose, int body,
                           const double at[3]);
/* A place of a body's frame in the frame of that body's link. */
double complex plane_in_link(const struct plane_tree *t, int body, const double at[3]);
/* Without what rounding has left of a zero. */
static inline double plane_tidy(double value)
{
    return fabs(value) < 1e-14 ? 0 : value;
}
static inline void plane_put(double complex place, double out[2])
{
    out[0] = plane_tidy(creal(place));
    out[1] = plane_tidy(cimag(place));
}

/* plane_contacts.c: what may touch, into the mechanism, with ground.friction; what begins inside
 * the ground is raised. */
bool plane_contacts(struct plane_tree *t);
/* "sphere heel of foot", as far as there are names. */
enum { PLANE_TEXT = 2 * SPATIAL_NAME + 60 };
const char *plane_geom_text(const struct plane_tree *t, const struct spatial_geom *geom,
                            char text[PLANE_TEXT]);
/* plane_names.c: of links; of contacts and motors by what they are called in the file. */
void plane_name_bodies(struct plane_tree *t);
void plane_name_contact(struct plane_tree *t, int element, const char *geom);
void plane_name_actuator(struct plane_tree *t, int actuator, const char *joint, const char *own);

#endif
