/* closed_biped.h - closed forms of the planar biped, which descriptions are held to: five point
 * masses on massless links, hinged at the hip, of S. Caux and R. Zapata, Modeling and control of
 * biped robot dynamics, Robotica 17 (1999): "the paper".
 *
 * q = (x, z, theta, q1, q2): position (x, z) of the trunk's mass, pitch theta of the trunk, angles
 * q1, q2 of the legs against the trunk, counter-clockwise. With phi_i = theta + q_i, the hip p and
 * the feet f_i are at
 *
 *   p = (x + lt sin theta, z - lt cos theta),   f_i = p + l (sin phi_i, -cos phi_i).
 *
 * Masses: mt at (x, z), mh at p, m at each foot; M = mt + mh + 2 m. Torque Gamma_i acts on leg i
 * and its opposite on the trunk.
 *
 * Equilibrium on foot s, the other leg f hanging free. Contact carries (0, M g). Moments about the
 * hip, of the trunk, of the free leg, and of the leg that the ground pushes up:
 *
 *   mt lt g sin theta     =  Gamma_1 + Gamma_2                     the paper's (20)
 *   (M - m) l g sin phi_s = -Gamma_s                               (21)
 *   m l g sin phi_f       =  Gamma_f                               (22)
 *
 * Added up, the torques vanish and one relation between the three sines is left,
 *
 *   mt lt sin theta + (M - m) l sin phi_s - m l sin phi_f = 0,
 *
 * which says that the centre of mass is above foot s. Given theta and one leg it yields the sine of
 * the other; given both legs it reads a sin theta + b cos theta = 0, which two opposite pitches
 * solve. Either way there are two branches, and branch 1 is the one with the hip below the foot.
 *
 * Linearisation with foot s pinned: with A the inertia, H the foot's Jacobian, r the change of what
 * the ground carries and W the second derivatives of g (M z_s - sum of m_k z_k), at rest
 *
 *   A a - H^T r = W dq + (0, 0, 0, dGamma_1, dGamma_2),   H a = 0:
 *
 * all that rates add is of second order.
 */
#ifndef STANCE_TESTS_CLOSED_BIPED_H
#define STANCE_TESTS_CLOSED_BIPED_H

#include "engine/stance.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define DENSE_ROWS 7
#include "dense.h"

enum { LEG_LENGTH, TRUNK_LENGTH, FOOT_MASS, TRUNK_MASS, HIP_MASS, ROBOT_COUNT };
enum { THETA = 2, Q1, Q2, COORDINATES };

/* The masses: trunk, hip, feet; each one's place, and its Jacobian. */
struct closed_point {
    double mass, at[2], by[2][COORDINATES];
};
enum { TRUNK, HIP, FOOT, POINTS = FOOT + 2 };

static inline struct closed_point closed_point(const double *robot, const double *q, int k)
{
    const double lt = robot[TRUNK_LENGTH], l = robot[LEG_LENGTH];
    struct closed_point p = {k == TRUNK ? robot[TRUNK_MASS]
                             : k == HIP ? robot[HIP_MASS]
                                        : robot[FOOT_MASS],
                             {q[0], q[1]},
                             {{1, 0}, {0, 1}}};
    if (k >= HIP) {
        p.at[0] += lt * sin(q[THETA]), p.at[1] -= lt * cos(q[THETA]);
        p.by[0][THETA] = lt * cos(q[THETA]), p.by[1][THETA] = lt * sin(q[THETA]);
    }
    if (k >= FOOT) {
        const int leg = Q1 + k - FOOT;
        const double sine = l * sin(q[THETA] + q[leg]), cosine = l * cos(q[THETA] + q[leg]);
        p.at[0] += sine, p.at[1] -= cosine;
        p.by[0][THETA] += cosine, p.by[1][THETA] += sine;
        p.by[0][leg] = cosine, p.by[1][leg] = sine;
    }
    return p;
}

static inline void closed_speed(const struct closed_point *p, const double *v, double speed[2])
{
    for (int axis = 0; axis < 2; axis++) {
        speed[axis] = 0;
        for (int i = 0; i < COORDINATES; i++)
            speed[axis] += p->by[axis][i] * v[i];
    }
}

static inline double closed_energy(const double *robot, const double *q, const double *v)
{
    double sum = 0;
    for (int k = 0; k < POINTS; k++) {
        const struct closed_point p = closed_point(robot, q, k);
        double u[2];
        closed_speed(&p, v, u);
        sum += p.mass * (0.5 * (u[0] * u[0] + u[1] * u[1]) + STANCE_GRAVITY * p.at[1]);
    }
    return sum;
}

static inline void closed_inertia(const double *robot, const double *q, double *A)
{
    memset(A, 0, COORDINATES * COORDINATES * sizeof *A);
    for (int k = 0; k < POINTS; k++) {
        const struct closed_point p = closed_point(robot, q, k);
        for (int i = 0; i < COORDINATES; i++)
            for (int j = 0; j < COORDINATES; j++)
                A[i * COORDINATES + j] +=
                    p.mass * (p.by[0][i] * p.by[0][j] + p.by[1][i] * p.by[1][j]);
    }
}

static inline double closed_mass(const double *robot)
{
    return robot[TRUNK_MASS] + robot[HIP_MASS] + 2 * robot[FOOT_MASS];
}

/* On one foot, with one of the three angles unknown; false: there is none. */
static inline bool closed_equilibrium(const double *robot, const stance_equilibrium_choice *choice,
                                      double posture[3], double torque[2])
{
    const int s = choice->supports == 2;
    double weight[3] = {robot[TRUNK_MASS] * robot[TRUNK_LENGTH]};
    int unknown = 0;
    weight[1 + s] = (closed_mass(robot) - robot[FOOT_MASS]) * robot[LEG_LENGTH];
    weight[2 - s] = -robot[FOOT_MASS] * robot[LEG_LENGTH];
    memcpy(posture, choice->posture, sizeof(double[3]));
    while (!isnan(posture[unknown]))
        unknown++;
    if (unknown == 0) {
        const double a = weight[0] + weight[1] * cos(posture[1]) + weight[2] * cos(posture[2]);
        const double b = weight[1] * sin(posture[1]) + weight[2] * sin(posture[2]);
        posture[0] = atan2(-b, a);
        if ((cos(posture[0] + posture[1 + s]) < 0) != (choice->branch == 1))
            posture[0] += posture[0] > 0 ? -M_PI : M_PI;
    } else {
        const int known = 3 - unknown;
        const double sine =
            -(weight[0] * sin(posture[0]) + weight[known] * sin(posture[0] + posture[known])) /
            weight[unknown];
        if (!(fabs(sine) <= 1))
            return false;
        posture[unknown] = (choice->branch == 1 ? M_PI - asin(sine) : asin(sine)) - posture[0];
    }
    for (int i = 0; i < 2; i++)
        torque[i] = -STANCE_GRAVITY * weight[1 + i] * sin(posture[0] + posture[1 + i]);
    return true;
}

/* W of above by the angles. */
static inline void closed_stiffness(const double *robot, const double *q, int s, double W[3][3])
{
    memset(W, 0, sizeof(double[3][3]));
    W[0][0] = robot[TRUNK_MASS] * robot[TRUNK_LENGTH] * cos(q[THETA]);
    for (int i = 0; i < 2; i++) {
        const double held = (i == s ? closed_mass(robot) : 0) - robot[FOOT_MASS];
        const double bend = held * robot[LEG_LENGTH] * cos(q[THETA] + q[Q1 + i]);
        W[0][0] += bend, W[0][1 + i] += bend, W[1 + i][0] += bend, W[1 + i][1 + i] += bend;
    }
    for (int k = 0; k < 9; k++)
        W[k / 3][k % 3] *= STANCE_GRAVITY;
}

/* A[6][6], B[6][2], and of the force on the foot, (normal, tangential), by_state[2][6],
 * by_torque[2][2]. */
static inline void closed_linearise(const double *robot, const double *q, int s, double *A,
                                    double *B, double *by_state, double *by_torque)
{
    double inertia[COORDINATES * COORDINATES], W[3][3];
    const struct closed_point foot = closed_point(robot, q, FOOT + s);
    closed_inertia(robot, q, inertia);
    closed_stiffness(robot, q, s, W);
    memset(A, 0, sizeof(double[36]));
    memset(B, 0, sizeof(double[12]));
    memset(by_state, 0, sizeof(double[12]));
    for (int j = 0; j < 5; j++) { /* angles, then torques */
        double a[DENSE_ROWS][DENSE_ROWS + 1] = {{0}}, x[DENSE_ROWS];
        for (int i = 0; i < COORDINATES; i++) {
            for (int k = 0; k < COORDINATES; k++)
                a[i][k] = inertia[i * COORDINATES + k];
            for (int axis = 0; axis < 2; axis++) {
                a[5 + axis][i] = foot.by[1 - axis][i];
                a[i][5 + axis] = -foot.by[1 - axis][i];
            }
            if (i >= THETA)
                a[i][7] = j < 3 ? W[i - THETA][j] : i == j;
        }
        if (!dense_solve(7, a, x))
            abort();
        for (int i = 0; i < 3; i++)
            *(j < 3 ? &A[(3 + i) * 6 + j] : &B[(3 + i) * 2 + j - 3]) = x[THETA + i];
        for (int axis = 0; axis < 2; axis++)
            *(j < 3 ? &by_state[axis * 6 + j] : &by_torque[axis * 2 + j - 3]) = x[5 + axis];
        if (j < 3)
            A[j * 6 + 3 + j] = 1;
    }
}

#endif
