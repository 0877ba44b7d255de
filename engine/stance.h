/* stance.h - the engine's public header: scenes, cases, kernels. Control design has one of its own.
 *
 * The engine knows no files, no terminals, no MPI. Everything is SI (m, kg, s, N, rad), `double`
 * only, row-major, and free of global state; every function may be called from several threads.
 * Functions that can fail return a `stance_error`; results leave by pointer and are defined only
 * when STANCE_OK is returned.
 */
#ifndef STANCE_H
#define STANCE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum {
    STANCE_MAX_COORDINATES = 13,
    STANCE_MAX_CONTACTS = 30, /* points, discs, ends of soles and stops */
    STANCE_MAX_ACTUATORS = 8,
    STANCE_MAX_POSTURE = 12, /* coordinates that a posture law acts on */
    STANCE_MAX_ROBOT = 257,  /* parameters of a scene's body; the last three are others: */
    STANCE_MAX_ANGLES = 11,  /* joints of a mechanism; a rail is none, a free root one */
    STANCE_MAX_NAMED = 8,    /* points of a mechanism that have a name */
    STANCE_MAX_PUSHES = 4,
    STANCE_MAX_PLATES = 8,                           /* pieces of ground */
    STANCE_MAX_DELAY = 16,                           /* samples */
    STANCE_MAX_WORDS = 32,                           /* that an answer may be, if it is a code */
    STANCE_ROBOT_FALL_HEIGHT = STANCE_MAX_ROBOT - 3, /* of the biped that is carried: lower has its
                                                      * hip fallen, in leg lengths */
    STANCE_ROBOT_GRAVITY,                            /* m/s^2 */
    STANCE_ROBOT_SLOPE,      /* rad, of the ground; positive: +x is downhill */
    STANCE_MAX_POINTS = 640, /* points of a stick figure */
};

#define STANCE_GRAVITY 9.81    /* m/s^2 */
#define STANCE_FALL_HEIGHT 0.2 /* leg lengths */

/* ---- errors: one table gives the enumeration and the text --------------------------------- */

#define STANCE_ERRORS(X)                                                                           \
    X(OK, "no error")                                                                              \
    X(NO_EQUILIBRIUM, "no such equilibrium exists")                                                \
    X(BAD_ARGUMENT, "an argument is out of range")                                                 \
    X(UNCONTROLLABLE, "the linearised system is not controllable")                                 \
    X(BAD_POLES, "the poles cannot be placed")                                                     \
    X(NOT_CONVERGED, "an iteration did not converge")                                              \
    X(NUMERICAL, "a numerical library reported a failure")                                         \
    X(NO_MEMORY, "out of memory")                                                                  \
    X(STOPPED, "told to stop")

typedef enum stance_error {
#define STANCE_ERROR_ENUM(name, text) STANCE_##name,
    STANCE_ERRORS(STANCE_ERROR_ENUM)
#undef STANCE_ERROR_ENUM
} stance_error;

/* Text of an error; never NULL. */
const char *stance_error_text(stance_error error);

/* A sentence that says what exactly failed; written by functions that take it, may be NULL. */
typedef struct stance_message {
    char text[240];
} stance_message;

/* ---- scenes: what is simulated -------------------------------------------------------------- */

typedef struct stance_quantity {
    const char *name, *unit, *text;
    double fallback;  /* default */
    double low, high; /* admitted range, both ends included */
} stance_quantity;

/* A position of rest, with what holds it there. */
typedef struct stance_equilibrium {
    uint32_t supports; /* bit c: contact c carries, and sticks to the ground */
    double position[STANCE_MAX_COORDINATES];
    double torque[STANCE_MAX_ACTUATORS];  /* N m, N */
    double force[STANCE_MAX_CONTACTS][2]; /* N, normal and tangential; 0: not a support */
    double friction;                      /* the coefficient that it takes */
    int undetermined; /* coordinates that no condition fixed: chosen for the least torques */
    /* Coordinates that describe all motions with the supports sticking: those of a linearisation.
     * All of the posture where it can move freely. */
    int freedoms, freedom[STANCE_MAX_POSTURE];
    double condition; /* number of that description; 1: the best there is */
} stance_equilibrium;

/* Which equilibrium: the contacts that carry, and what is known of the posture. */
typedef struct stance_equilibrium_choice {
    uint32_t supports;                  /* 0: none, for what hangs on the world */
    double posture[STANCE_MAX_POSTURE]; /* NAN where not given */
    /* Of several equilibria, from 0: where coordinates are undetermined those with lower torques
     * come first, then those whose bodies are nearest to where they are with all angles 0 (largest
     * sum of cosines), then the highest. */
    int branch;
} stance_equilibrium_choice;

struct stance_case;

/* What benchmarks of speed simulate: cases of a second that stay in one regime. */
typedef struct stance_workload {
    const char *name; /* NULL ends a list */
    /* The equilibrium that a state feedback balances about; NULL: none does. */
    const stance_equilibrium_choice *balance;
    /* Makes *c, at that equilibrium or at 0, with the default robot, one of them. even[2]: in [0,
     * 1), spread evenly over the cases. */
    void (*begin)(const double even[2], struct stance_case *c);
} stance_workload;

struct stance_mechanism;
struct stance_tree;
struct stance_rest;

/* Two legs that are alike in structure: how the robot reads while the other one stands, q' = M q of
 * coordinates and rates, torque'[i] = sign[i] torque[actuator[i]]. */
typedef struct stance_exchange {
    bool any;        /* else there are no two, or more: M is 1 */
    uint32_t leg[2]; /* contacts of each */
    double coordinate[STANCE_MAX_COORDINATES][STANCE_MAX_COORDINATES]; /* M */
    int actuator[STANCE_MAX_ACTUATORS];
    double sign[STANCE_MAX_ACTUATORS];
} stance_exchange;

typedef struct stance_scene stance_scene;
struct stance_scene {
    const char *name, *text;
    const struct stance_mechanism *mechanism; /* what it is made of, see mechanism.h ... */
    const struct stance_tree *tree;           /* ... and its structure, see tree.h */
    int coordinates, contacts, actuators, postures, robot_count;
    const stance_quantity *robot; /* [robot_count] */
    const stance_quantity
        *coordinate;                 /* [coordinates] name, unit, text; ranges of initial values */
    const char *const *contact_name; /* [contacts] */
    /* [contacts] The contact whose tangential impulse holds it, too: its own index, the first end
     * of a sole for both ends, -1 for a stop, which has none. */
    const int *grip;
    const char *const *actuator_name; /* [actuators] */
    const int *posture;               /* [postures] indices into the coordinates */
    const int *actuated;              /* [actuators] the coordinate that each drives */
    stance_exchange exchange;
    /* Gap of each contact above the ground, normal to it, m; a joint's stop: rad or m.
     * position[coordinates], gap[contacts]. */
    void (*gaps)(const stance_scene *scene, const double *robot, const double *position,
                 double *gap);
    /* Position (x, z) of a contact point, and its velocity along the ground and normal to it. */
    void (*contact_point)(const stance_scene *scene, const double *robot, const double *position,
                          const double *velocity, int contact, double point[2], double speed[2]);
    /* Replaces the translation so that the contacts `supports`, a bit each, stand on the ground,
     * the first of them at rest, at the origin where all touch. Nothing, where nothing moves the
     * robot as a whole. */
    void (*stand)(const stance_scene *scene, const double *robot, uint32_t supports,
                  double *position, double *velocity);
    /* Stick figure: a polyline of `n` points (x, z); returns n <= STANCE_MAX_POINTS. */
    int (*figure)(const stance_scene *scene, const double *robot, const double *position,
                  double points[][2]);
    int causes; /* of a fall, by what touches the ground, is too low or has turned too far */
    const char *const *cause; /* [causes] its names, in the order of the lanes' scene_fall_margin */
    /* Has it fallen, by its own points and angles. */
    bool (*fallen)(const stance_scene *scene, const double *robot, const double *position);
    /* Kinetic and potential energy, J. */
    double (*energy)(const stance_scene *scene, const double *robot, const double *position,
                     const double *velocity);
    /* Inertia matrix A[n][n] in these coordinates, n = coordinates. */
    void (*inertia)(const stance_scene *scene, const double *robot, const double *position,
                    double *A);
    /* NO_EQUILIBRIUM, BAD_ARGUMENT: `message` says why. With OK it holds a remark, or nothing. */
    stance_error (*equilibrium)(const stance_scene *scene, const double *robot,
                                const stance_equilibrium_choice *choice, stance_equilibrium *result,
                                stance_message *message);
    /* With the supports sticking: d/dt x = A x + B dtorque, x = (dp, dp'), p the equilibrium's
     * freedoms; A[2p][2p], B[2p][actuators], exact derivatives. `equilibrium`: as the function
     * above gives it. Errors: BAD_ARGUMENT. */
    stance_error (*linearise)(const stance_scene *scene, const double *robot,
                              const stance_equilibrium *equilibrium, double *A, double *B);
    /* Forces of the ground on the supports, in the order of their bits, sticking there:
     * force[supports][2] = (normal, tangential) at rest, N; exact first derivatives
     * by_state[supports][2][2p] by x, N/rad and N s/rad, and by_torque[supports][2][actuators],
     * N/(N m); where they are not determined, those of least norm. A sole's tangential force is its
     * first end's. Errors as `linearise`. */
    stance_error (*contact_force)(const stance_scene *scene, const double *robot,
                                  const stance_equilibrium *equilibrium, double *force,
                                  double *by_state, double *by_torque);
    /* Is there an equilibrium close by that holds? See rest.h: it is what kernels ask. */
    bool (*rest)(struct stance_rest *rest);
    const stance_workload *workload; /* a list */
};

#define STANCE_ILL_CONDITIONED 1e4 /* condition number from which on a decoupling law is damped */

/* The choices of as many coordinates as there are actuators, which can control them, in order: with
 * two (0, 1), (0, 2), ... coordinate[actuators]. False: there is no such selection. */
bool stance_selection(const stance_scene *scene, int index, int *coordinate);
enum { STANCE_MAX_SELECTIONS = 1716 }; /* of 13 coordinates 6 or 7 */
_Static_assert(STANCE_MAX_COORDINATES <= 13, "room for all selections");

/* The robot that a scene has by default, with the numbers that are not the body's.
 * robot[STANCE_MAX_ROBOT]. */
void stance_robot_fallback(const stance_scene *scene, double *robot);
/* What each actuator gives at most, in its unit: the robot's limit, `most` or its own of
 * `limits`[actuators], whichever is smallest. */
void stance_torque_limits(const stance_scene *scene, const double *robot, double most,
                          const double *limits, double limit[STANCE_MAX_ACTUATORS]);

/* The scenes there are, NULL-terminated; and one by name, or NULL. */
const stance_scene *const *stance_scenes(void);
const stance_scene *stance_scene_find(const char *name);

/* ---- cases: one simulation ------------------------------------------------------------------ */

typedef enum stance_status { STANCE_PENDING, STANCE_DONE, STANCE_FAILED } stance_status;

/* How a case ended, in the order of legends: one table gives the enumeration, the names, the
 * numbers in files (0: none) and the texts. Of several that are true at once the last one holds. */
#define STANCE_OUTCOMES(X)                                                                         \
    X(STABILISED, stabilised, 1, "stands at its target, and the loop holds it there")              \
    X(WALKS, walks, 5, "walks: its last steps are alike")                                          \
    X(RESTED, rested, 3, "is at rest elsewhere, for good")                                         \
    X(FELL, fell, 2, "fell")                                                                       \
    X(UNDECIDED, undecided, 4, "none of these when time was up")

typedef enum stance_outcome {
    STANCE_NONE,
#define STANCE_OUTCOME_ENUM(NAME, name, number, text) STANCE_##NAME = (number),
    STANCE_OUTCOMES(STANCE_OUTCOME_ENUM)
#undef STANCE_OUTCOME_ENUM
} stance_outcome;
#define STANCE_OUTCOME_ONE(NAME, name, number, text) +1
enum { STANCE_OUTCOME_COUNT = 1 STANCE_OUTCOMES(STANCE_OUTCOME_ONE) };

/* What an outcome rests on: simulated, or inferred from what others came to. */
#define STANCE_EVIDENCES(X)                                                                        \
    X(EVIDENCE_NONE, none)                                                                         \
    X(SIMULATED, simulated)                                                                        \
    X(INFERRED, inferred)

typedef enum stance_evidence {
#define STANCE_EVIDENCE_ENUM(NAME, name) STANCE_##NAME,
    STANCE_EVIDENCES(STANCE_EVIDENCE_ENUM)
#undef STANCE_EVIDENCE_ENUM
        STANCE_EVIDENCE_COUNT,
} stance_evidence;

/* Why a case has status FAILED: one table gives the enumeration, the name and the text. */
#define STANCE_FAILURES(X)                                                                         \
    X(NONE, none, "the case did not fail")                                                         \
    X(NEWTON, newton,                                                                              \
      "the implicit step did not converge, nor did any subdivision of it; try method capturing, "  \
      "or a shorter step")                                                                         \
    X(NOT_FINITE, not_finite, "the state left the finite numbers; try a shorter step")             \
    X(ANGLE, angle, "an angle left the range in which sine and cosine are defined (1e4 rad)")      \
    X(CONTACT, contact,                                                                            \
      "the contact problem of a step has no solution to tolerance; joints that are held may jam: " \
      "try less friction, or another step")                                                        \
    X(PAINLEVE, painleve,                                                                          \
      "no contact force, or several, fit the accelerations (Painleve); method capturing goes on")  \
    X(EVENTS, events,                                                                              \
      "too many events in one step: they accumulate (Zeno), or chatter; method capturing goes on") \
    X(TOLERANCE, tolerance,                                                                        \
      "the error estimate stayed above the tolerance at the smallest step; try another step, "     \
      "or method midpoint")                                                                        \
    X(INITIAL, initial, "the initial state or the controller does not exist for this case")        \
    X(WORK, work,                                                                                  \
      "it takes more work than is allowed: too stiff, or events without end; try a shorter step, " \
      "or method midpoint")                                                                        \
    X(PROGRAM, program, "the law of controller.file gave torques that are not finite")

typedef enum stance_failure {
#define STANCE_FAILURE_ENUM(NAME, name, text) STANCE_FAILURE_##NAME,
    STANCE_FAILURES(STANCE_FAILURE_ENUM)
#undef STANCE_FAILURE_ENUM
        STANCE_FAILURE_COUNT,
} stance_failure;

/* Trajectory buffers of one case, owned by the caller; rows beyond `rows` are left untouched.
 * Row k belongs to the step that ends nearest to k * interval. */
typedef struct stance_trajectory {
    double interval;             /* s, > 0 */
    int64_t rows;                /* number of rows that fit */
    double *position, *velocity; /* [rows][coordinates] */
    double *torque;              /* [rows][actuators] as applied in the step that ends there */
    double *force; /* [rows][contacts][2] N: normal, tangential; mean since the row before */
    double *gap;   /* [rows][contacts] m */
} stance_trajectory;

/* torque = feedforward - gain * (posture - target, rates). */
typedef struct stance_linear_law {
    double feedforward[STANCE_MAX_ACTUATORS];
    double gain[STANCE_MAX_ACTUATORS][2 * STANCE_MAX_POSTURE];
    double target[STANCE_MAX_POSTURE];
} stance_linear_law;

/* What a bimodal law takes off a linear law's torques: push max(0, normal (posture - target, rate)
 * - 1). */
typedef struct stance_bend {
    double normal[2 * STANCE_MAX_POSTURE];
    double push[STANCE_MAX_ACTUATORS]; /* N m */
} stance_bend;

/* One coordinate that a decoupling law controls: acceleration kp (r - q) + kd (r' - q') + ki times
 * the integral of r - q, r = setpoint + ramp min(t, duration). */
typedef struct stance_servo {
    int coordinate;
    double setpoint, ramp, duration; /* its unit; per s; s, may be INFINITY */
    double kp, ki, kd;               /* 1/s^2, 1/s^3, 1/s */
    double integral_limit;           /* of the integral, its unit times s; may be INFINITY */
} stance_servo;

/* Outputs that a law holds at zero, as many as there are actuators: y = row (q - the robot's angles
 * where they are measured from 0) less a polynomial of the phase; which rows, says the leg that
 * stands (stance_exchange; without one always the first). s = (phase q - from) / (to - from);
 * beyond 0 ... 1 the polynomial goes on with its second derivative at the end. Accelerations -kp y
 * - kd y' of the outputs are decoupled as servos are or, `constant`, weighted: torque = sum of
 * torques times these. */
enum { STANCE_MAX_COEFFICIENTS = 9 };
typedef struct stance_output {
    double row[STANCE_MAX_COORDINATES];
    double along[STANCE_MAX_COEFFICIENTS]; /* of the powers of s */
    double kp, kd;                         /* 1/s^2, 1/s */
    double torques[STANCE_MAX_ACTUATORS];  /* kg m^2, kg m, kg */
} stance_output;
typedef struct stance_outputs {
    bool constant;
    double from, to;
    double phase[2][STANCE_MAX_COORDINATES]; /* by the leg that stands */
    double clock[STANCE_MAX_COEFFICIENTS]; /* to be added: of the powers of the time since the last
                                            * footfall, s */
    stance_output output[2][STANCE_MAX_ACTUATORS];
} stance_outputs;

/* ---- control laws: what they are told, and what that makes of a case ------------------------ */

/* How many numbers a parameter of a law is. */
typedef enum stance_per {
    STANCE_PER_LAW,        /* one */
    STANCE_PER_ACTUATOR,   /* one for each, named by the coordinate that it drives */
    STANCE_PER_POSTURE,    /* one for each coordinate of the posture */
    STANCE_PER_COORDINATE, /* one for each coordinate of the scene */
    STANCE_PER_SELECTION,  /* which coordinates, see stance_selection: an int */
    STANCE_PER_TERM,       /* a list of up to STANCE_MAX_COEFFICIENTS; NAN: the rest */
} stance_per;

typedef struct stance_parameter {
    stance_quantity of; /* in `unit` and `text` %s stands for what the coordinate has there; unit ""
                         * of an actuator's: its coordinate's. fallback NAN: none */
    stance_per per;
    bool required;  /* must be given */
    bool positive;  /* `low` itself is out of range */
    bool unlimited; /* the word `none`, INFINITY, may stand for it */
    bool told;      /* a summary tells it even where it is the default */
    int output;     /* that it is of, from 1: there are as many as actuators; 0: none */
    const char *fallback_text, *all, *more; /* of NAN; of the numbers together; may be NULL */
} stance_parameter;

/* A law of the user's own, compiled from C: what kernels call at each sample of a case. sample[] is
 * what is known then: STANCE_SAMPLE_HEAD numbers, the scene's coordinates, their rates, and for
 * each contact 1 where it stands on the ground, else 0. */
enum { STANCE_PROGRAM_NUMBERS = 64 }; /* of its parameters, at most */
enum {
    STANCE_SAMPLE_TIME,   /* s */
    STANCE_SAMPLE_PERIOD, /* s, to the next sample */
    STANCE_SAMPLE_SINCE,  /* s, since the last footfall, or since the beginning */
    STANCE_SAMPLE_FOOTFALLS,
    STANCE_SAMPLE_FOOT, /* contact that landed last, at first one that stands; -1: none */
    STANCE_SAMPLE_HEAD,
    STANCE_SAMPLE_ROOM = STANCE_SAMPLE_HEAD + 2 * STANCE_MAX_COORDINATES + STANCE_MAX_CONTACTS,
};
typedef struct stance_program stance_program;
struct stance_program {
    bool remembers; /* what it commands depends on more than sample[] */
    /* A case begins: where sample[] is to be written; what else it keeps is beside it. NULL: there
     * is no memory. */
    double *(*begin)(const stance_program *program, const struct stance_case *c);
    /* Torques [actuators], not yet limited, for what stands in sample[]; NULL: they are of no use.
     */
    const double *(*act)(const stance_program *program, const struct stance_case *c,
                         double *sample);
    void (*end)(const stance_program *program, double *sample);
};

/* STANCE_LAW_PARAMETERS: of all laws together. */
enum { STANCE_LAW_PARAMETERS = 64, STANCE_LAW_ROOM = STANCE_MAX_COORDINATES, STANCE_MAX_LAWS = 8 };

/* A file of engine/laws each. What is not linear acts in core/law and core/mode, too. */
typedef struct stance_law {
    const char *name, *text;
    bool designed; /* brings the robot to an equilibrium by gains that are designed or given */
    bool acts_far; /* may act outside the ellipsoid inside which a designed law does */
    bool servos;   /* controls the coordinates of a selection, each by a servo */
    bool samples;  /* needs a sample time above 0 */
    bool program;  /* is compiled from a file of the user's, which says what it is told */
    int parameters;
    const stance_parameter *parameter; /* [parameters] */
    /* What mappings that hold parameters are ("phase" of "phase.from"), name and text; NULL ends;
     * "*" of one of the outputs. */
    const char *const (*group)[2];
    /* Makes *c act by it. value[parameters * STANCE_LAW_ROOM]: of each parameter one number, or by
     * actuators or coordinates; NAN: as the scene is at `begin`[coordinates]. `linear`: c's near or
     * far. Errors: BAD_ARGUMENT. NULL: nothing acts, or a designed law
     * that is all in its gains. */
    stance_error (*set)(const stance_scene *scene, const double *value, const double *begin,
                        stance_linear_law *linear, struct stance_case *c, stance_message *message);
} stance_law;

/* The laws there are, NULL-terminated; the first one is `none`. */
#define STANCE_LAWS(X)                                                                             \
    X(none) X(hold) X(state_feedback) X(bimodal_feedback) X(decoupling) X(outputs) X(program)
const stance_law *const *stance_laws(void);
/* One by name, or NULL. */
const stance_law *stance_law_find(const char *name);
/* Where a law's parameters begin among those of all laws. */
int stance_law_first(const stance_law *law);

#include "tree_numbers.h"

/* What restitution e asks of contacts that meet the ground: normal velocities -e times those
 * before, by the largest e' <= e by which impulses add no energy; that whatever they add; or, as
 * the first, with e for tangential velocities, too (core/contact/impact.h). */
typedef enum stance_impacts {
    STANCE_IMPACTS_LIMITED,
    STANCE_IMPACTS_NEWTON,
    STANCE_IMPACTS_MOREAU
} stance_impacts;

typedef struct stance_case {
    double robot[STANCE_MAX_ROBOT];
    /* By stance_case_robot: */
    stance_tree_numbers body;
    const struct stance_tree *tree; /* the same in all cases of a stream, as ... */
    const stance_scene *scene;
    double friction;    /* Coulomb coefficient, >= 0 */
    double restitution; /* 0 ... 1 */
    stance_impacts impacts;
    /* Where several motions obey the contact laws: false, the one that leaves the least kinetic
     * energy; true, the most. */
    bool most_energy;
    uint32_t contacts; /* bit c: contact c may touch the ground */
    bool lands_ahead;  /* of these a foot in the air only where it is ahead: core/loop/feet.h */
    double position[STANCE_MAX_COORDINATES], velocity[STANCE_MAX_COORDINATES];

    /* The law `near` acts, with noise, clipped to +-torque_limit. `decouples`: the servos instead
     * (where sample_every is 0: continuously with methods that integrate between events, else once
     * a step). `switches`: `near` inside the ellipsoid sum(((posture - near.target), rates) /
     * switch_axis)^2 <= 1, and outside it the servos or, where the case does not decouple, `far`;
     * needs sample_every > 0. */
    stance_linear_law near, far;
    bool decouples, switches, bends;
    stance_bend bend; /* of `near`, where it bends; needs sample_every > 0 */
    stance_servo servo[STANCE_MAX_ACTUATORS];
    bool follows; /* `decouples`, and `outputs` are held instead of what servos do */
    stance_outputs outputs;
    double switch_axis[2 * STANCE_MAX_POSTURE]; /* rad, rad/s, > 0 */
    /* It acts instead, where the case does not switch or is outside the ellipsoid; NULL: none. */
    const stance_program *program;
    double parameter[STANCE_PROGRAM_NUMBERS]; /* of it */
    double torque_limit; /* N m, > 0, may be INFINITY; of an actuator, `body.limit` where smaller */
    double torque_limits[STANCE_MAX_ACTUATORS]; /* ... or this one; 0: none */
    int64_t sample_every; /* steps per sample, held between; 0: acts continuously inside the step */
    /* Only of laws that sample, 0: none. Measured posture and rates are off by uniform noise of
     * these half-widths (rad, rad/s; of a slide m, m/s), the torques that follow by `noise` (N m).
     * Limited, they are commanded `delay` samples later, and actuators come up to what is commanded
     * as core/loop/actuator.h says. */
    double angle_noise, rate_noise, noise;
    int64_t delay;      /* whole samples between measuring and acting, <= STANCE_MAX_DELAY */
    double lag;         /* s, time constant of the actuators */
    double torque_rate; /* N m/s, how fast a torque changes at most */

    double step;   /* s */
    int64_t steps; /* length of the run */
    /* Admitted error of a step (m, rad, m/s, rad/s; of the largest rate where that is above 1), >
     * 0; read where the method controls it. */
    double tolerance;

    /* Judge `stabilised` and `rested` on the way and stop there. Both ask for an equilibrium that
     * holds, too, no further than settle_angle away: see rest.h. */
    bool settle;
    int64_t footfalls; /* ends at so many of them, where they fall; 0: does not */
    /* `walks` ends the case, too, where walk_steps > 0: so many in a row are like the one 1 to 4
     * steps before, within walk_angle and walk_rate (rad, rad/s) just after the footfall, the
     * second half of them no less than the first. A step is a footfall that is walk_length (m) or
     * more away from the foot that stood, the way the last one went, and comes walk_time (s) or
     * more after the last: core/loop/walk.h. Whatever they are like, walk_enough of them do; 0: no
     * number does.
     */
    int64_t walk_steps, walk_enough;
    double walk_length, walk_time, walk_angle, walk_rate;
    bool has_target;     /* without one nothing is ever `stabilised` */
    uint32_t supports;   /* bit c: a stabilised robot stands on contact c, and on no other */
    double settle_angle; /* rad */
    double settle_rate;  /* rad/s, and m/s for the translation */
    double settle_hold;  /* s */
    double settle_place; /* m along the ground that a support may be from where it began, with what
                          * counts as stabilised; 0: anywhere */

    uint64_t seed, grid_index, sample_index; /* key of the random numbers */
    stance_trajectory *trajectory;           /* NULL: not recorded */
} stance_case;

/* Makes what kernels take of c->robot, and the scene, that of a case. To be called again where
 * robot has changed. */
void stance_case_robot(const stance_scene *scene, stance_case *c);

/* Height (m, normal to its plane) of the ground at x, m along it, and where to the right of x it
 * next may change, INFINITY: nowhere. from[plates of c->body]: where its pieces begin; of one by
 * footfall the case does not tell. |x| < 1e9. */
void stance_ground_at(const stance_case *c, const double *from, double x, double *height,
                      double *high);

/* The answers of a case, in the order in which files hold them: name, type, how a case gets it,
 * which steps tell it, unit, text. Where there is none floating-point answers are NAN, counts
 * STANCE_NO_COUNT, codes 0, which is the word `none`.
 *   END             known when the case ends
 *   SUM, MAX, MIN   gathered over the parts of steps and over steps
 *   STEPS           at most 1 in each step, summed over the steps
 * Told by each step, by those with contacts (`touching`), by those in which something happens that
 * happens rarely (`rare`), or gathered from what else is known (`own`, in core/loop/judge.h). To
 * add one: a row here, and what sets it; steps that tell it find its place in struct step_report.
 */
#define STANCE_ANSWERS(X)                                                                          \
    X(outcome, uint8_t, END, own, "1", "how the case ended")                                       \
    X(evidence, uint8_t, END, own, "1", "what the outcome rests on")                               \
    X(failure, uint8_t, END, own, "1", "why a case has status failed")                             \
    X(end_time, double, END, own, "s", "time at which the simulation stopped")                     \
    X(settle_time, double, END, own, "s", "time from which the case stayed settled")               \
    X(fall_time, double, END, own, "s", "time at which the robot had fallen")                      \
    X(fall_cause, uint8_t, END, own, "1", "point or body by which the robot fell")                 \
    X(steps, int64_t, END, own, "1", "time steps taken")                                           \
    X(iterations, int64_t, SUM, each, "1", "Newton iterations over all steps")                     \
    X(ambiguous_steps, int64_t, STEPS, rare, "1",                                                  \
      "steps whose contact problem had several solutions")                                         \
    X(unranked_steps, int64_t, STEPS, rare, "1",                                                   \
      "steps with too many contacts to tell whether other solutions are preferred")                \
    X(subdivided_steps, int64_t, STEPS, rare, "1",                                                 \
      "steps that converged only after being subdivided")                                          \
    X(degraded_samples, int64_t, STEPS, rare, "1",                                                 \
      "samples at which a decoupling law could not do what it promises")                           \
    X(max_penetration, double, MAX, own, "m", "deepest penetration at the end of a step")          \
    X(through_ground, double, MAX, own, "m",                                                       \
      "deepest below the ground that a contact came which the scenario leaves out")                \
    X(slip_distance, double, SUM, own, "m", "distance slipped, summed over contacts")              \
    X(footfalls, int64_t, SUM, own, "1", "landings of another foot than the one that landed last") \
    X(walked_steps, int64_t, END, own, "1", "footfalls that are steps, see stop.walks")            \
    X(step_time, double, END, own, "s",                                                            \
      "mean time of the last four of them (of 3 where the gait repeats after 3)")                  \
    X(step_length, double, END, own, "m",                                                          \
      "mean length of the last four of them, along the ground")                                    \
    X(walking_speed, double, END, own, "m/s", "mean speed of the last four of them")               \
    X(cost_of_transport, double, END, own, "1",                                                    \
      "of the last four of them: sum of |work| of each actuator, over weight and way")             \
    X(gait_period, int64_t, END, own, "1", "steps after which the gait repeats: 1 to 4")           \
    X(gait_change, double, END, own, "1",                                                          \
      "how unlike the last step is to one 1 to 4 before, in what stop.walks admits")               \
    X(excursion, double, MAX, each, "rad", "largest angle off its target on the way")              \
    X(peak_torque, double, MAX, each, "N m", "largest torque applied")                             \
    X(friction_used, double, MAX, touching, "1", "largest ratio |rT|/rN of a contact")             \
    X(impact_friction, double, MAX, rare, "1", "largest ratio |PT|/PN of impulses at an impact")   \
    X(least_normal_force, double, MIN, own, "N", "smallest normal force on the support foot")      \
    X(impact_energy, double, MAX, rare, "J",                                                       \
      "largest kinetic energy added by contact impulses in one step")                              \
    X(limited_impacts, int64_t, SUM, rare, "1",                                                    \
      "impacts with less restitution than asked for, which would have added energy")               \
    X(projection_energy, double, SUM, touching, "J",                                               \
      "sum of |energy| added by position projection")                                              \
    X(events, int64_t, SUM, rare, "1", "changes of contact mode that the method handled")          \
    X(evaluations, int64_t, SUM, each, "1",                                                        \
      "evaluations of the accelerations or of the implicit equation")                              \
    X(energy_gain, double, MAX, own, "J",                                                          \
      "largest rise of the energy above its start and the work done")                              \
    X(energy_drift, double, MAX, own, "J",                                                         \
      "largest |change of energy less work done|, summed over steps in which no contact carries")  \
    X(signorini_residual, double, MAX, touching, "m/s",                                            \
      "largest normal velocity of a contact that carries, or into the ground")                     \
    X(coulomb_residual, double, MAX, touching, "1",                                                \
      "largest excess of |rT|/rN over the coefficient of friction")                                \
    X(dissipation_residual, double, MAX, touching, "m/s",                                          \
      "largest slip that full friction against it does not accompany")

/* What stands in place of a count where there is none. */
#define STANCE_NO_COUNT INT64_MIN

typedef struct stance_result {
    int32_t status; /* stance_status */
#define STANCE_ANSWER_FIELD(name, type, how, told, unit, text) type name;
    STANCE_ANSWERS(STANCE_ANSWER_FIELD)
#undef STANCE_ANSWER_FIELD
    double position[STANCE_MAX_COORDINATES], velocity[STANCE_MAX_COORDINATES];
} stance_result;

enum {
#define STANCE_ANSWER_ENUM(name, type, how, told, unit, text) STANCE_ANSWER_##name,
    STANCE_ANSWERS(STANCE_ANSWER_ENUM)
#undef STANCE_ANSWER_ENUM
        STANCE_ANSWER_COUNT,
};

/* A row of the table, for those who treat all answers alike. */
typedef enum stance_type { STANCE_UINT8, STANCE_INT64, STANCE_DOUBLE } stance_type;
typedef struct stance_answer {
    const char *name, *unit, *text;
    stance_type type;
    size_t size, offset; /* bytes; in stance_result */
    /* Of an answer that is a code: the words that its numbers stand for; else NULL, 0. (Of
     * fall_cause they are the scene's: see stance_answer_words.) */
    const char *const *word;
    int words;
} stance_answer;
extern const stance_answer stance_answers[STANCE_ANSWER_COUNT];

/* The words of an answer that is a code, word[STANCE_MAX_WORDS], and how many; 0: it is none. */
int stance_answer_words(const stance_scene *scene, int answer, const char **word);

/* The result of a case that has none: no answer, the state NAN, status pending. */
void stance_result_clear(stance_result *result);

/* An answer of a result as a number; NAN: there is none. */
double stance_answer_of(const stance_result *result, int answer);

/* Names and texts of outcomes and failures. */
extern const char *const stance_outcome_name[STANCE_OUTCOME_COUNT];
extern const char *const stance_evidence_name[STANCE_EVIDENCE_COUNT];
extern const char *const stance_failure_name[STANCE_FAILURE_COUNT];
extern const char *const stance_failure_text[STANCE_FAILURE_COUNT];

/* ---- kernels: how it is stepped ------------------------------------------------------------- */

typedef struct stance_method {
    const char *name, *text;
    int order_smooth; /* order of convergence while the contact mode lasts */
    double
        tolerance; /* default of stance_case.tolerance; 0: the method does not control its error */
} stance_method;

/* Where a kernel gets its cases from, one whenever a lane is free, and where the results go. */
typedef struct stance_feed {
    void *context;
    /* The next case and where its result goes; both stay in place until `done`. false: there are
     * no more, and it is not asked again. */
    bool (*next)(void *context, const stance_case **c, stance_result **result);
    /* *result is written; in whatever order cases end. */
    void (*done)(void *context, const stance_case *c, stance_result *result);
    /* NULL, or asked about every millisecond: true, the cases in hand are given up at once. */
    bool (*leave)(void *context);
} stance_feed;

/* One compiled stepping core: a structure, a method, a number of lanes. */
typedef struct stance_kernel {
    const char *structure; /* the scene whose tables it is compiled for; "runtime": reads any */
    const stance_method *method;
    const char *isa; /* "scalar", "sse2", "avx2", "avx512", "neon", "wasm128" */
    int lanes;
    /* Runs cases until there are no more or it is told to leave; false: told to leave. A case's
     * result does not depend on lanes, on the order, or on the cases that run beside it. */
    bool (*stream)(const stance_feed *feed);
    /* The same for n cases at hand: cases[i] -> results[i]. */
    void (*run)(const stance_case *cases, stance_result *results, size_t n);
} stance_kernel;

/* What a kernel that is compiled on demand exports, under the name stance_kernel_object. */
typedef struct stance_object {
    size_t case_size, result_size; /* of the structs that it was compiled with */
    int lanes;
    bool (*stream)(const stance_feed *feed); /* as of stance_kernel */
    void (*run)(const stance_case *cases, stance_result *results, size_t n);
} stance_object;

/* The methods there are, NULL-terminated; and one by name, or NULL. */
const stance_method *const *stance_methods(void);
const stance_method *stance_method_find(const char *name);
/* The kernel for a scene and a method; isa NULL: the fastest that this processor runs. A method
 * that takes one case at a time has a scalar kernel only, which runs on every processor, and gives
 * it for every isa. For what is not compiled ahead it is one that reads structures at run time, of
 * another isa where there is none of this one. NULL when there is none, as for an isa that this
 * processor does not run. */
const stance_kernel *stance_kernel_find(const stance_scene *scene, const stance_method *method,
                                        const char *isa);
/* Whether a kernel computes cases of a scene. */
bool stance_kernel_fits(const stance_kernel *kernel, const stance_scene *scene);
/* Whether it is compiled for a structure; else it reads the structure at run time, more slowly. */
bool stance_kernel_ahead(const stance_kernel *kernel);
/* Name of the instruction set that comes at `rank` (0: fastest) among those that this build has and
 * this processor runs; NULL past the last. */
const char *stance_isa(int rank);

/* Sine and cosine as the kernels compute them (same bits on every processor): absolute error
 * below 2.5e-16 for |angle| <= 1e4, NAN beyond. */
void stance_sincos(double angle, double *sine, double *cosine);

#endif
