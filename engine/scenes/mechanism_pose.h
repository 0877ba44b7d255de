/* mechanism_pose.h - where the bodies of a mechanism are, and how points of them move.
 *
 * Coordinates q: of a free root (x, z) of its reference point and its angle, else of each joint the
 * angle against the parent (beyond the body's own `angle`) or the displacement along it. O_i the
 * joint of body i, of a free root its reference point, T_i the direction in which it slides, E the
 * quarter turn (x, z) -> (-z, x): a point P of body b moves, for each joint between b and the
 * world, itself included, by
 *
 *   dP/dq_i = E (P - O_i) of a hinge,   T_i of a slide,
 *   d2P/dq_i dq_j = -(P - O_k) of two hinges, k the one of i, j that is further from the root,
 *                   E T_j where j slides and i is a hinge nearer to the root,
 *
 * and 0 for all others; a free root's angle is a hinge here. The ground passes through the origin
 * with slope s: tangent t = (cos s, -sin s), normal n = (sin s, cos s). A contact's gap and its
 * rates U = (normal, tangential) = row q':
 *
 *   point         gap = P.n,           U = (n.P', t.P')
 *   disc, centre C, radius r   C.n - r,  U = (n.C', t.C' + r a'),   a' the body's rate
 *   stop at a limit l, u        q - l or u - q,      U = (q', 0) or (-q', 0)
 *
 * Generalised forces: of a force f at P, Q = (dP/dq)' f, so that dQ_i/dq_j = f.(d2P/dq_i dq_j):
 * gravity and contact forces alike; of a spring, Q_i = -k (q_i - rest).
 */
#ifndef STANCE_SCENES_MECHANISM_POSE_H
#define STANCE_SCENES_MECHANISM_POSE_H

#include "engine/mechanism.h"

typedef struct stance_pose {
    const stance_mechanism *m;
    stance_mechanism_numbers number;
    double gravity, tangent[2], normal[2];
    int coordinates;
    /* Of each body: the coordinate of its joint (a free root's: its angle), or -1; what turns. */
    int own[STANCE_MAX_BODIES];
    bool turns[STANCE_MAX_BODIES];
    double angle[STANCE_MAX_BODIES], sine[STANCE_MAX_BODIES], cosine[STANCE_MAX_BODIES];
    double straight[STANCE_MAX_BODIES]; /* the angle where all coordinates are 0 */
    double origin[STANCE_MAX_BODIES][2], pivot[STANCE_MAX_BODIES][2]; /* of the frame; O */
    double axis[STANCE_MAX_BODIES][2];                                /* of what slides: T */
    double position[STANCE_MAX_COORDINATES];                          /* q */
} stance_pose;

typedef struct stance_touch {
    int body;
    bool stop;
    double gap, point[2];                  /* a stop's: its joint */
    double radius, rough;                  /* rough: friction_factor */
    double row[2][STANCE_MAX_COORDINATES]; /* normal, tangential; a stop's second: 0 */
} stance_touch;

void stance_pose_at(const stance_mechanism *m, const double *robot, const double *position,
                    stance_pose *pose);
/* A point of a body, given in its frame. */
void stance_pose_point(const stance_pose *pose, int body, const double local[2], double point[2]);
/* dP/dq of a point of a body, and da/dq of its angle. */
void stance_pose_jacobian(const stance_pose *pose, int body, const double point[2],
                          double J[2][STANCE_MAX_COORDINATES], double turn[STANCE_MAX_COORDINATES]);
/* Contact `index` of the scene; false: there is none. */
bool stance_pose_contact(const stance_pose *pose, int index, stance_touch *touch);
/* Inertia matrix in q, A[coordinates][coordinates]. */
void stance_pose_inertia(const stance_pose *pose, double *A);

/* What the contacts `supports` hold when they stick, row by row: row q' = 0. Of contacts that share
 * a grip only the first has a tangential row. */
enum { STANCE_MAX_STICKING = 2 * STANCE_MAX_CONTACTS };
typedef struct stance_sticking {
    int rows;
    int contact[STANCE_MAX_STICKING], direction[STANCE_MAX_STICKING]; /* 0 normal, 1 tangential */
    stance_touch touch[STANCE_MAX_STICKING];
} stance_sticking;
void stance_pose_sticking(const stance_scene *scene, const stance_pose *pose, uint32_t supports,
                          stance_sticking *sticking);
/* Forces at rest of gravity, springs, the actuators' torques and the forces of rows that stick,
 * Q[coordinates], and their exact derivatives dQ[coordinates][STANCE_MAX_COORDINATES] by q. */
void stance_pose_forces(const stance_pose *pose, const double *torque,
                        const stance_sticking *sticking, const double *force, double *Q,
                        double dQ[][STANCE_MAX_COORDINATES]);
/* Fills in freedoms, freedom and condition from the supports. */
void stance_pose_freedoms(const stance_scene *scene, const stance_pose *pose,
                          stance_equilibrium *equilibrium);

/* Two bodies of one parent whose subtrees have the same joints, contacts and actuators in the same
 * order are a pair; of what carries contacts there must be one pair, of other kinds (arms) may be
 * more. Or the root is a leg and the other one hangs from it. Numbers do not count: a leg may be
 * heavier. */
void stance_exchange_make(const stance_mechanism *m, const stance_scene *scene,
                          stance_exchange *exchange);

/* ---- the functions of the scene; see stance.h ------------------------------------------------ */

void stance_mechanism_gaps(const stance_scene *scene, const double *robot, const double *position,
                           double *gap);
void stance_mechanism_contact_point(const stance_scene *scene, const double *robot,
                                    const double *position, const double *velocity, int contact,
                                    double point[2], double speed[2]);
void stance_mechanism_stand(const stance_scene *scene, const double *robot, uint32_t supports,
                            double *position, double *velocity);
int stance_mechanism_figure(const stance_scene *scene, const double *robot, const double *position,
                            double points[][2]);
bool stance_mechanism_fallen(const stance_scene *scene, const double *robot,
                             const double *position);
double stance_mechanism_energy(const stance_scene *scene, const double *robot,
                               const double *position, const double *velocity);
void stance_mechanism_inertia(const stance_scene *scene, const double *robot,
                              const double *position, double *A);
stance_error stance_mechanism_equilibrium(const stance_scene *scene, const double *robot,
                                          const stance_equilibrium_choice *choice,
                                          stance_equilibrium *result, stance_message *message);
stance_error stance_mechanism_linearise(const stance_scene *scene, const double *robot,
                                        const stance_equilibrium *equilibrium, double *A,
                                        double *B);
stance_error stance_mechanism_contact_force(const stance_scene *scene, const double *robot,
                                            const stance_equilibrium *equilibrium, double *force,
                                            double *by_state, double *by_torque);

#endif
