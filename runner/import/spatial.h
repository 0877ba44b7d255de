/* spatial.h - a robot as its file has it: a tree of rigid bodies in space.
 *
 * What readers fill (mjcf_read.c, urdf_read.c), the plane takes up (plane.c), and the comparison
 * with the original begins from (compare.c). SI, angles in radians. Frames are right-handed;
 * rotations R[row][column] take a vector of the inner frame to the outer one. Names and places are
 * those of the file, so that every refusal can say where.
 */
#ifndef RUNNER_IMPORT_SPATIAL_H
#define RUNNER_IMPORT_SPATIAL_H

#include "runner/base/message.h"

#include <stdbool.h>
#include <stddef.h>

enum { SPATIAL_NAME = 128 };

/* How a body moves against its parent: in the order of its joints, none: not at all. */
typedef enum spatial_joint_kind {
    SPATIAL_HINGE,
    SPATIAL_SLIDE,
    SPATIAL_FREE, /* six ways; from then on the plane's three */
    SPATIAL_BALL, /* never of the plane; so that it can be refused by name */
} spatial_joint_kind;

struct spatial_joint {
    char name[SPATIAL_NAME]; /* as in the file; "": none */
    int line;                /* in the file, 0: not known */
    int body;
    spatial_joint_kind kind;
    double axis[3], at[3];    /* in the body's frame: unit vector; m */
    double reference;         /* rad or m: the coordinate's value in the posture in which bodies are
                               * given (MuJoCo's ref, 0 in URDF) */
    bool limited;             /* `limits` count */
    double limits[2];         /* rad or m, of the coordinate as the file counts it */
    double damping, armature; /* N m s/rad, kg m^2; of a slide N s/m, kg */
    double stiffness, spring_reference; /* N m/rad at that coordinate; N/m, m */
    double friction;                    /* N m, N: dry friction in the joint: has no counterpart */
    bool soft;                          /* its stops are (MuJoCo's all; hard here) */
    double effort;                      /* N m, N: a limit of its own (URDF), 0: none */
    double start;                       /* the initial coordinate: keyframe 0, else `reference` */
    double start_place[3], start_rotation[3][3]; /* of a free one: initial place, m, and rotation */
};

struct spatial_body {
    char name[SPATIAL_NAME];
    int line;
    int parent;                   /* -1: the world. Parents stand before their children */
    double at[3], rotation[3][3]; /* in the parent's frame, with all joints at `reference` */
    double mass, centre[3];       /* kg; m, in the body's frame */
    double inertia[3][3];         /* kg m^2, about the centre of mass, in the body's axes */
};

typedef enum spatial_shape {
    SPATIAL_SPHERE,   /* size: radius */
    SPATIAL_CAPSULE,  /* radius, half length of the axis between the caps' centres, along z */
    SPATIAL_CYLINDER, /* radius, half length along z */
    SPATIAL_BOX,      /* half lengths */
    SPATIAL_PLANE,    /* through `at`, normal z */
    SPATIAL_OTHER,    /* meshes, height fields, ellipsoids: `of` is the word for it */
} spatial_shape;

/* What may touch; what is only drawn is not here. */
struct spatial_geom {
    char name[SPATIAL_NAME];
    int line;
    int body; /* -1: the world's */
    spatial_shape shape;
    const char *of; /* the file's word for the shape; static */
    double at[3], rotation[3][3], size[3];
    double friction;  /* NAN: not given */
    bool meets_floor; /* may touch the floor (contype, conaffinity); of the floor itself true */
    bool meets_robot; /* may touch another body of the robot: has no counterpart */
};

typedef enum spatial_drive {
    SPATIAL_MOTOR,
    SPATIAL_POSITION, /* servos: gains below */
    SPATIAL_VELOCITY,
    SPATIAL_GENERAL, /* anything else: refused by name */
} spatial_drive;

struct spatial_actuator {
    char name[SPATIAL_NAME];
    int line;
    int joint; /* index, -1: it drives what is no joint (a tendon, a site), or one that is fixed */
    char target[SPATIAL_NAME]; /* the name of what it drives */
    spatial_drive drive;
    double gear; /* joint force per unit of the actuator's: of either sign */
    bool limited;
    double least, most; /* joint force N m, N, gear and all ranges included; else -+INFINITY */
    double kp, kd;      /* of servos, N m/rad and N m s/rad of the joint, gear included */
};

/* `what` of a joint that follows another one: it may be held. */
#define SPATIAL_MIMIC "mimic joint"

/* What the file has and the plane cannot: each refused, or noted, by its name. */
struct spatial_alien {
    const char *what; /* "equality", "tendon", "plugin", "flexible body", "skin", ...; static */
    char name[SPATIAL_NAME];
    int line;
    bool harmless; /* left out with a note; else refused */
};

/* A line that may end in a list of names, each whole; of those without room it is said how many. */
struct spatial_note {
    char text[560];
    size_t length; /* of text that names may stand behind */
    int more;      /* names without room */
};

/* Why something failed, as stance_message, with room for a list of names. */
typedef struct spatial_message {
    char text[900];
} spatial_message;

struct spatial_model {
    char title[SPATIAL_NAME]; /* the robot's */
    char file[SPATIAL_NAME];  /* its file's name, without directories */
    const char *path;         /* ... as it was asked for; the caller's */
    const char *format;       /* "MJCF", "URDF"; static */
    double gravity[3];        /* m/s^2 */
    double step;              /* s, 0: not given */
    int bodies, joints, geoms, actuators, aliens, notes;
    struct spatial_body *body;
    struct spatial_joint *joint; /* of one body in order, bodies in order */
    struct spatial_geom *geom;
    struct spatial_actuator *actuator;
    struct spatial_alien *alien;
    struct spatial_note *note;
};

/* One more, cleared, at the end of a list of the model: spatial_add(model, body, bodies). Without
 * memory the process ends with a line: it is one of its own (runner/base/sandbox.h). */
#define spatial_add(model, one, many)                                                              \
    ((struct spatial_##one *)spatial_more(&(model)->one, &(model)->many, sizeof *(model)->one))
void *spatial_more(void *list, int *count, size_t size);
void spatial_add_alien(struct spatial_model *model, const char *what, const char *name, int line,
                       bool harmless);
/* Cleared room; to be freed. Without memory as above. */
void *spatial_room(size_t count, size_t size);
/* spatial_refuse(model, message, line, format, ...): "FILE:LINE: ...", line 0: not known. Is false.
 */
#define spatial_refuse(...) (spatial_say(__VA_ARGS__), as_false())
void spatial_say(const struct spatial_model *model, spatial_message *message, int line,
                 const char *format, ...) __attribute__((format(printf, 4, 5)));
/* NULL: "". */
void spatial_name(char name[SPATIAL_NAME], const char *text);
/* An empty model of a file. */
void spatial_begin(struct spatial_model *model, const char *path, const char *format);
/* A line of what was left out or changed, and why, once; they become comments of the scenario. */
void spatial_note(struct spatial_model *model, const char *format, ...)
    __attribute__((format(printf, 2, 3)));
/* The same of several, each once: "WHAT: a, b, c". */
void spatial_note_of(struct spatial_model *model, const char *what, const char *name);
/* One more name of a list, which begins cleared. */
void spatial_list(struct spatial_note *list, const char *name);
void spatial_free(struct spatial_model *model);

/* Readers: false: `message` says file, line and what to do. *model is to be freed either way.
 * MJCF: by libmujoco, loaded when it is there. URDF: by libxml2. */
bool mjcf_read(const char *path, struct spatial_model *model, spatial_message *message);
bool urdf_read(const char *path, struct spatial_model *model, spatial_message *message);

#endif
