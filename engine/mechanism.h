/* mechanism.h - a planar tree of rigid bodies as data: what a scenario describes, and what kernels
 * are compiled from.
 *
 * Frames: x forward, z up, angles counter-clockwise, R(a) = [cos a, -sin a; sin a, cos a]. A body's
 * frame has its origin at the joint to its parent, from where a slide takes it along its axis;
 * where the joint's coordinate is 0 it is turned against the parent's (a root's against the
 * world's) by `angle`. `body[0]` is the root; the parent of every other one stands before it.
 * Everything that is a number may be varied without another structure; which of them are varied a
 * scene knows by robot[] (see `number`).
 */
#ifndef STANCE_MECHANISM_H
#define STANCE_MECHANISM_H

#include "stance.h"

enum {
    STANCE_NAME = 64,         /* bytes of a name, with its end */
    STANCE_MAX_BODIES = 31,   /* fixed ones included */
    STANCE_MAX_ELEMENTS = 24, /* points, discs, soles, capsules */
    STANCE_MAX_BRANCHES = 64, /* equilibria */
};

/* Root: free, hinge (to the world), slide (along a rail; does not turn). Others: hinge, slide
 * (along an axis of the parent, whose angle it keeps), fixed. */
typedef enum stance_joint {
    STANCE_FREE,
    STANCE_HINGE,
    STANCE_SLIDE,
    STANCE_FIXED,
} stance_joint;

typedef struct stance_body_numbers {
    double mass;      /* kg, >= 0 */
    double inertia;   /* kg m^2, about the centre of mass, >= 0 */
    double centre[2]; /* m, of mass, in the body's frame */
    double at[2];     /* m, the joint in the parent's frame; a root's in the world's */
    double axis[2];   /* of a slide, likewise, of any length > 0 */
    double angle;     /* rad, against the parent where the joint's coordinate is 0 */
    double stiffness; /* N m/rad or N/m, of the joint, >= 0 */
    double damping;   /* N m s/rad or N s/m, >= 0 */
    double rest;      /* rad or m: where the spring pulls nothing */
    double armature;  /* kg m^2 or kg: of a geared rotor, as the joint feels it, >= 0 */
    double limits[2]; /* rad or m, of the joint's coordinate: stops; -INFINITY, INFINITY: none */
    double turn;      /* rad, angle from upright beyond which it has fallen; INFINITY: none */
} stance_body_numbers;

typedef struct stance_element_numbers {
    double at[2];  /* m, in the body's frame: the point, the centre of a disc, a sole's first end */
    double to[2];  /* m, a sole's second end */
    double radius; /* m, of a disc or, of a sole, a capsule; 0: a point, a flat sole */
    double friction_factor; /* its coefficient of friction by the ground's, > 0 */
} stance_element_numbers;

typedef struct stance_point_numbers {
    double at[2];  /* m, in its body's frame */
    double lowest; /* m above the ground: lower has fallen; -INFINITY: none */
    double
        force[2]; /* along the ground and normal to it: N, from `from` to `to`, or N s, at `from` */
    double from, to;  /* s */
    double frequency; /* Hz: a force that swings is sin(2 pi frequency (t - from)) of that */
} stance_point_numbers;

/* What the world does to a point. */
typedef enum stance_push { STANCE_NO_PUSH, STANCE_FORCE, STANCE_IMPULSE } stance_push;

typedef struct stance_mechanism_numbers {
    stance_body_numbers body[STANCE_MAX_BODIES];
    stance_element_numbers element[STANCE_MAX_ELEMENTS];
    stance_point_numbers point[STANCE_MAX_NAMED];
    stance_plate_numbers plate[STANCE_MAX_PLATES];
    double reference[2];                /* m, in the root's frame: what x and z are of */
    double limit[STANCE_MAX_ACTUATORS]; /* N m or N, > 0, may be INFINITY */
} stance_mechanism_numbers;

/* A mechanism that the program carries: its numbers follow from parameters of its own. */
typedef struct stance_carried {
    const char *name, *text;
    int parameters;
    const stance_quantity *parameter;  /* [parameters]: the first of the scene's robot[] */
    const stance_quantity *coordinate; /* of each, as in stance_scene */
    /* robot[STANCE_MAX_ROBOT] -> those of the numbers that follow from it. */
    void (*set)(const double *robot, stance_mechanism_numbers *number);
    const stance_workload *workload; /* as in stance_scene; or NULL */
    const double (*outline)[2]; /* m, of the last body, which has no size of its own; or NULL */
    int corners;
    bool numbered;    /* contacts are feet with numbers from 1, branches of equilibria words */
    bool along_slope; /* x and z are along the ground and normal to it */
} stance_carried;

typedef struct stance_mechanism {
    const stance_carried *carried; /* or NULL: all numbers are as described */
    int bodies, elements, points, plates, actuators;
    struct {
        char name[STANCE_NAME];
        char coordinate[STANCE_NAME]; /* of its joint, a free root's angle; "": as the body */
        stance_joint joint;
        int parent;   /* -1: the root */
        bool bounded; /* its `turn` counts */
    } body[STANCE_MAX_BODIES];
    struct {
        char name[STANCE_NAME];
        int body;
        bool sole;  /* from `at` to `to`; else a disc or a point */
        bool rough; /* its `friction_factor` counts */
    } element[STANCE_MAX_ELEMENTS];
    struct {
        char name[STANCE_NAME];
        int body;
        bool falls;         /* its `lowest` counts */
        stance_push pushed; /* at most STANCE_MAX_PUSHES are */
        bool swings;        /* its `frequency` counts: of a force */
    } point[STANCE_MAX_NAMED];
    struct {
        char name[STANCE_NAME];
        stance_ground_kind kind;
        bool by_footfall; /* its `from` is ahead of the foot that stands before that footfall */
        bool rough;       /* its `friction_factor` counts */
    } plate[STANCE_MAX_PLATES];
    struct {
        char name[STANCE_NAME];
        int body; /* whose joint it drives: on the body, and the opposite on its parent */
    } actuator[STANCE_MAX_ACTUATORS];
    stance_mechanism_numbers value; /* as described */
    /* After the parameters of what is carried, which have number[i] = -1, robot[i] of a scene is
     * the number at index number[i] of `value`, taken as an array of doubles; those with varies[i]
     * may differ from it from case to case. */
    int numbers, number[STANCE_MAX_ROBOT];
    bool varies[STANCE_MAX_ROBOT];
} stance_mechanism;

/* A contact of a scene: the first or second end (0, 1) of an element, or (element -1) the stop at
 * the lower or upper limit of a body's joint. */
typedef struct stance_contact_place {
    int element, body, end;
} stance_contact_place;
/* Contact c, in their order; false: there are fewer. */
bool stance_mechanism_contact(const stance_mechanism *m, int c, stance_contact_place *place);

/* Has the joint of body b, a hinge or a slide, a stop at its lower (side 0) or upper (1) limit? */
bool stance_mechanism_stops(const stance_mechanism *m, int b, int side);

/* The coordinate of the joint of body b, or a free root's angle; b is not fixed. */
int stance_mechanism_coordinate(const stance_mechanism *m, int b);

/* What the numbers are that nobody gives, where that is not 0. */
void stance_mechanism_defaults(stance_mechanism_numbers *numbers);

/* The numbers with robot[numbers] in place of those of `value`. */
void stance_mechanism_expand(const stance_mechanism *m, const double *robot,
                             stance_mechanism_numbers *numbers);

/* A scene that owns a copy of m, to be given back by stance_scene_free; `m` must be a tree as
 * above.
 *
 * Coordinates: of a free root x, z (of its reference point) and its angle, of one that slides its
 * displacement; then the angles of hinges and displacements of slides, named as their bodies unless
 * told otherwise, in the bodies' order.
 * Postures: all of them but x and z. Contacts: the elements, a sole as NAME_heel (`at`) and
 * NAME_toe (`to`), then NAME_low and NAME_high for the stops of each body's joint, in the bodies'
 * order. Robot quantities: m->number[], named by where they
 * stand ("bodies.shank1.at[1]", "contacts.foot1.radius", "points.head.at[0]",
 * "actuators.hip1.limit"; a sole's ends are "from" and "to").
 * Errors: BAD_ARGUMENT (more contacts, points of a figure or numbers than fit), NO_MEMORY. */
stance_error stance_mechanism_scene(const stance_mechanism *m, stance_scene **scene,
                                    stance_message *message);
void stance_scene_free(stance_scene *scene);

/* All equilibria that are found for a choice (but its branch) from many beginnings, in the order of
 * branches: list[STANCE_MAX_BRANCHES], *count. Errors, each with a sentence: BAD_ARGUMENT;
 * NO_EQUILIBRIUM where there is no such posture, where the conditions contradict each other, or
 * where none of those found can be: the ground would have to pull, a joint be beyond its limits, an
 * actuator give more than it has. Whether friction suffices is left to the caller, see
 * stance_equilibrium.friction. */
stance_error stance_mechanism_equilibria(const stance_scene *scene, const double *robot,
                                         const stance_equilibrium_choice *choice,
                                         stance_equilibrium *list, int *count,
                                         stance_message *message);

#endif
