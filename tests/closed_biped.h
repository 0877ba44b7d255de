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
 * solve. Either way there are two branches, and branch 1 is
 * the one with the hip below the foot.
 *
 * Linearisation with foot s pinned at the origin: p = l (-sin phi_s, cos phi_s), so that in
 * a = (theta, phi_s, phi_f) the kinetic energy is a'^T N(a) a' / 2 with
 *
 *   N = [ mt lt^2                     mt lt l cos(theta - phi_s)     0                        ]
 *       [ .                           (M - m) l^2                    -m l^2 cos(phi_f - phi_s)]
 *       [ .                           .                              m l^2                    ]
 *
 * and the potential V = g (mt lt cos theta + (M - m) l cos phi_s - m l cos phi_f). At rest all
 * terms with velocities are of second order and N multiplies accelerations that vanish at the
 * equilibrium, so exactly: N da'' = -V'' da + S dGamma, V'' diagonal, S = (-1 -1; e_s; e_f).
 * Eliminating theta and phi_f leaves the pivot
 *
 *   (M - m) l^2 - mt l^2 cos^2(theta - phi_s) - m l^2 cos^2(phi_f - phi_s) >= mh l^2 > 0.
 *
 * The ground carries what moves the centre of mass, r = (sum of m_i r_i)'' + (0, M g), and with the
 * foot at the origin
 *
 *   sum of m_i r_i = (M - m) l (-sin phi_s, cos phi_s) + mt lt (-sin theta, cos theta)
 *                    - m l (-sin phi_f, cos phi_f).
 *
 * Its second derivative is that sum's Jacobian times a'' plus squares of rates: about rest, to
 * first order and exactly, the Jacobian at the equilibrium times the da'' above.
 */
#ifndef STANCE_TESTS_CLOSED_BIPED_H
#define STANCE_TESTS_CLOSED_BIPED_H

#include "engine/stance.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

enum { LEG_LENGTH, TRUNK_LENGTH, FOOT_MASS, TRUNK_MASS, HIP_MASS, ROBOT_COUNT };
enum { X, Z, THETA, Q1, Q2, COORDINATES };
enum { FEET = 2, TORQUES = 2, POSTURES = 3 };

/* ---- angles: the same bits whatever the C library -------------------------------------------- */

static double sine_of(double angle)
{
    double sine, cosine;
    stance_sincos(angle, &sine, &cosine);
    return sine;
}
static double cosine_of(double angle)
{
    double sine, cosine;
    stance_sincos(angle, &sine, &cosine);
    return cosine;
}

/* The angle in -pi ... pi whose sine and cosine are in the ratio y : x, not both 0. Halved until a
 * short series of the arctangent begins Newton's iteration on y cos - x sin = 0. */
static double angle_of(double y, double x)
{
    const double length = sqrt(x * x + y * y);
    double t = fabs(y) / (length + fabs(x)), sine, cosine; /* of half the angle to the x axis */
    t = t / (1 + sqrt(1 + t * t));
    t = t / (1 + sqrt(1 + t * t)); /* an eighth: at most 0.2 */
    double angle = 8 * t * (1 - t * t * (1. / 3 - t * t * (1. / 5 - t * t / 7)));
    angle = x < 0 ? M_PI - angle : angle;
    angle = y < 0 ? -angle : angle;
    for (int k = 0; k < 2; k++) {
        stance_sincos(angle, &sine, &cosine);
        angle += (y * cosine - x * sine) / (x * cosine + y * sine);
    }
    return angle;
}

/* ---- kinematics ------------------------------------------------------------------------------ */

struct place {
    double x, z;
};

static struct place hip(const double *robot, const double *q)
{
    double sine, cosine;
    stance_sincos(q[THETA], &sine, &cosine);
    return (struct place){q[X] + robot[TRUNK_LENGTH] * sine, q[Z] - robot[TRUNK_LENGTH] * cosine};
}

static struct place foot(const double *robot, const double *q, int i)
{
    const struct place p = hip(robot, q);
    double sine, cosine;
    stance_sincos(q[THETA] + q[Q1 + i], &sine, &cosine);
    return (struct place){p.x + robot[LEG_LENGTH] * sine, p.z - robot[LEG_LENGTH] * cosine};
}

static void gaps(const stance_scene *scene, const double *robot, const double *position,
                 double *gap)
{
    (void)scene;
    for (int i = 0; i < FEET; i++)
        gap[i] = foot(robot, position, i).z;
}

static void contact_point(const stance_scene *scene, const double *robot, const double *position,
                          const double *velocity, int contact, double at[2], double speed[2])
{
    (void)scene;
    double trunk_sine, trunk_cosine, leg_sine, leg_cosine;
    const struct place f = foot(robot, position, contact);
    stance_sincos(position[THETA], &trunk_sine, &trunk_cosine);
    stance_sincos(position[THETA] + position[Q1 + contact], &leg_sine, &leg_cosine);
    const double trunk = robot[TRUNK_LENGTH] * velocity[THETA];
    const double leg = robot[LEG_LENGTH] * (velocity[THETA] + velocity[Q1 + contact]);
    at[0] = f.x;
    at[1] = f.z;
    speed[0] = velocity[X] + trunk * trunk_cosine + leg * leg_cosine;
    speed[1] = velocity[Z] + trunk * trunk_sine + leg * leg_sine;
}

static void stand(const stance_scene *scene, const double *robot, uint32_t supports,
                  double *position, double *velocity)
{
    const int support = supports & 1 ? 0 : 1;
    static const double zero[COORDINATES];
    double at[2], speed[2];

    position[X] = position[Z] = 0;
    contact_point(scene, robot, position, zero, support, at, speed);
    position[X] = 0 - at[0];
    position[Z] = 0 - at[1];
    /* Where the sum rounds downwards the foot would start inside the ground: the next heights. */
    const double least = DBL_EPSILON / 8 * (robot[LEG_LENGTH] + robot[TRUNK_LENGTH]);
    while (foot(robot, position, support).z < 0)
        position[Z] = fmax(nextafter(position[Z], INFINITY), position[Z] + least);
    velocity[X] = velocity[Z] = 0;
    contact_point(scene, robot, position, velocity, support, at, speed);
    velocity[X] = 0 - speed[0];
    velocity[Z] = 0 - speed[1];
}

static bool fallen(const stance_scene *scene, const double *robot, const double *position)
{
    (void)scene;
    return hip(robot, position).z < robot[STANCE_ROBOT_FALL_HEIGHT] * robot[LEG_LENGTH] ||
           position[Z] <= 0;
}

static double energy(const stance_scene *scene, const double *robot, const double *position,
                     const double *velocity)
{
    double sine, cosine, at[2], speed[2];
    stance_sincos(position[THETA], &sine, &cosine);
    const double turn = robot[TRUNK_LENGTH] * velocity[THETA];
    const double hip_vx = velocity[X] + turn * cosine, hip_vz = velocity[Z] + turn * sine;

    double sum =
        robot[TRUNK_MASS] * (0.5 * (velocity[X] * velocity[X] + velocity[Z] * velocity[Z]) +
                             STANCE_GRAVITY * position[Z]);
    sum += robot[HIP_MASS] *
           (0.5 * (hip_vx * hip_vx + hip_vz * hip_vz) + STANCE_GRAVITY * hip(robot, position).z);
    for (int i = 0; i < FEET; i++) {
        contact_point(scene, robot, position, velocity, i, at, speed);
        sum += robot[FOOT_MASS] *
               (0.5 * (speed[0] * speed[0] + speed[1] * speed[1]) + STANCE_GRAVITY * at[1]);
    }
    return sum;
}

/* Sum over the masses of m J^T J, J their Jacobians by (x, z, theta, q1, q2). */
static void inertia(const stance_scene *scene, const double *robot, const double *position,
                    double *A)
{
    (void)scene;
    const double mass[] = {robot[TRUNK_MASS], robot[HIP_MASS], robot[FOOT_MASS], robot[FOOT_MASS]};
    double J[4][2][COORDINATES] = {0}, sine, cosine;
    for (int k = 0; k < 4; k++) {
        J[k][0][X] = J[k][1][Z] = 1;
        if (k == 0)
            continue;
        stance_sincos(position[THETA], &sine, &cosine);
        J[k][0][THETA] = robot[TRUNK_LENGTH] * cosine;
        J[k][1][THETA] = robot[TRUNK_LENGTH] * sine;
        if (k == 1)
            continue;
        stance_sincos(position[THETA] + position[Q1 + k - 2], &sine, &cosine);
        const int turned[] = {THETA, Q1 + k - 2};
        for (int j = 0; j < 2; j++) {
            J[k][0][turned[j]] += robot[LEG_LENGTH] * cosine;
            J[k][1][turned[j]] += robot[LEG_LENGTH] * sine;
        }
    }
    for (int i = 0; i < COORDINATES; i++) {
        for (int j = 0; j < COORDINATES; j++) {
            A[i * COORDINATES + j] = 0;
            for (int k = 0; k < 4; k++) {
                A[i * COORDINATES + j] +=
                    mass[k] * (J[k][0][i] * J[k][0][j] + J[k][1][i] * J[k][1][j]);
            }
        }
    }
}

/* ---- equilibrium ----------------------------------------------------------------------------- */

/* On one foot alone, with one of the three angles unknown: what is asked of it here. */

/* The foot that these contacts are. */
static int foot_of(uint32_t supports)
{
    return supports == 2;
}

static double weight_of(const double *robot)
{
    return STANCE_GRAVITY * (2 * robot[FOOT_MASS] + robot[TRUNK_MASS] + robot[HIP_MASS]);
}

/* Weights of sin theta, sin phi_1, sin phi_2 in the relation that puts the centre of mass above
 * the foot `support`. */
static void balance(const double *robot, int support, double weight[POSTURES])
{
    const double carried = robot[TRUNK_MASS] + robot[HIP_MASS] + robot[FOOT_MASS];
    weight[0] = robot[TRUNK_MASS] * robot[TRUNK_LENGTH];
    weight[1 + support] = carried * robot[LEG_LENGTH];
    weight[2 - support] = -robot[FOOT_MASS] * robot[LEG_LENGTH];
}

/* phi of leg `unknown` from theta and the other leg. */
static stance_error solve_leg(const double *weight, const stance_equilibrium_choice *choice,
                              double posture[POSTURES], int unknown)
{
    const int known = 3 - unknown;
    const double sine =
        -(weight[0] * sine_of(posture[0]) + weight[known] * sine_of(posture[0] + posture[known])) /
        weight[unknown];
    /* A sine of 1 that rounding has made larger is one still. */
    if (!(fabs(sine) <= 1 + 1e-14))
        return STANCE_NO_EQUILIBRIUM;
    const double upper = angle_of(fmax(-1, fmin(1, sine)), sqrt(fmax(0, (1 - sine) * (1 + sine))));
    posture[unknown] = ((choice->branch == 1) ? M_PI - upper : upper) - posture[0];
    return STANCE_OK;
}

/* theta from both leg angles: a sin theta + b cos theta = 0 has the two opposite solutions. */
static stance_error solve_trunk(const double *weight, const stance_equilibrium_choice *choice,
                                double posture[POSTURES])
{
    const int s = 1 + foot_of(choice->supports);
    const double a =
        weight[0] + weight[1] * cosine_of(posture[1]) + weight[2] * cosine_of(posture[2]);
    const double b = weight[1] * sine_of(posture[1]) + weight[2] * sine_of(posture[2]);
    const double size = fabs(weight[0]) + fabs(weight[1]) + fabs(weight[2]);

    if (fmax(fabs(a), fabs(b)) <= 1e-14 * size)
        return STANCE_NO_EQUILIBRIUM;
    posture[0] = angle_of(-b, a);
    if ((cosine_of(posture[0] + posture[s]) < 0) != (choice->branch == 1))
        posture[0] += posture[0] > 0 ? -M_PI : M_PI;
    return STANCE_OK;
}

static stance_error equilibrium(const stance_scene *scene, const double *robot,
                                const stance_equilibrium_choice *choice, stance_equilibrium *result,
                                stance_message *message)
{
    (void)message;
    int unknown = 0;
    double posture[POSTURES], weight[POSTURES], velocity[COORDINATES] = {0};

    const int support = foot_of(choice->supports);
    memcpy(posture, choice->posture, sizeof posture);
    while (!isnan(posture[unknown]))
        unknown++;
    balance(robot, support, weight);
    const stance_error error = unknown == 0 ? solve_trunk(weight, choice, posture)
                                            : solve_leg(weight, choice, posture, unknown);
    if (error != STANCE_OK)
        return error;
    *result = (stance_equilibrium){.supports = choice->supports,
                                   .freedoms = POSTURES,
                                   .freedom = {THETA, Q1, Q2},
                                   .condition = 1};
    result->force[support][0] = weight_of(robot);
    memcpy(&result->position[THETA], posture, sizeof posture);
    stand(scene, robot, choice->supports, result->position, velocity);
    for (int i = 0; i < TORQUES; i++) {
        result->torque[i] =
            0 - STANCE_GRAVITY * weight[1 + i] * sine_of(posture[0] + posture[1 + i]);
    }
    return STANCE_OK;
}

/* ---- linearisation --------------------------------------------------------------------------- */

/* The pinned robot about an equilibrium, in a = (theta, phi_s, phi_f): N a'' = force. */
typedef struct pinned {
    double trunk, support, free;        /* diagonal of N */
    double trunk_support, free_support; /* off it */
    double stiffness[POSTURES];         /* diagonal of V'' */
} pinned;

static pinned pin(const double *robot, const stance_equilibrium *equilibrium)
{
    const double l = robot[LEG_LENGTH], lt = robot[TRUNK_LENGTH], m = robot[FOOT_MASS],
                 mt = robot[TRUNK_MASS], carried = mt + robot[HIP_MASS] + m;
    const double *q = equilibrium->position;
    const int support = foot_of(equilibrium->supports);
    const int s = Q1 + support, f = Q2 - support;
    const double phi_s = q[THETA] + q[s], phi_f = q[THETA] + q[f];
    return (pinned){
        .trunk = mt * lt * lt,
        .support = carried * l * l,
        .free = m * l * l,
        .trunk_support = mt * lt * l * cosine_of(q[s]),
        .free_support = -m * l * l * cosine_of(q[f] - q[s]),
        .stiffness = {-STANCE_GRAVITY * mt * lt * cosine_of(q[THETA]),
                      -STANCE_GRAVITY * carried * l * cosine_of(phi_s),
                      STANCE_GRAVITY * m * l * cosine_of(phi_f)},
    };
}

/* Accelerations of (theta, q1, q2) under generalised forces on (theta, phi_s, phi_f). */
static void accelerate(const pinned *p, int support, const double force[POSTURES],
                       double posture[POSTURES])
{
    const double pivot = p->support - p->trunk_support * p->trunk_support / p->trunk -
                         p->free_support * p->free_support / p->free;
    const double phi_s =
        (force[1] - p->trunk_support / p->trunk * force[0] - p->free_support / p->free * force[2]) /
        pivot;
    const double theta = (force[0] - p->trunk_support * phi_s) / p->trunk;
    const double phi_f = (force[2] - p->free_support * phi_s) / p->free;
    posture[0] = theta;
    posture[1 + support] = phi_s - theta;
    posture[2 - support] = phi_f - theta;
}

static stance_error linearise(const stance_scene *scene, const double *robot,
                              const stance_equilibrium *equilibrium, double *A, double *B)
{
    (void)scene;
    enum { STATES = 2 * POSTURES };
    const int support = foot_of(equilibrium->supports);
    const pinned p = pin(robot, equilibrium);
    double column[POSTURES];

    memset(A, 0, sizeof(double[STATES * STATES]));
    memset(B, 0, sizeof(double[STATES * TORQUES]));
    for (int j = 0; j < POSTURES; j++) {
        /* A change of theta turns both legs, a change of q_i leg i alone. */
        const double turned[POSTURES] = {j == 0, j == 0 || j == 1 + support,
                                         j == 0 || j == 2 - support};
        double force[POSTURES];
        for (int i = 0; i < POSTURES; i++)
            force[i] = -p.stiffness[i] * turned[i];
        accelerate(&p, support, force, column);
        for (int i = 0; i < POSTURES; i++)
            A[(POSTURES + i) * STATES + j] = column[i];
        A[j * STATES + POSTURES + j] = 1;
    }
    for (int j = 0; j < TORQUES; j++) {
        const double force[POSTURES] = {-1, j == support, j != support};
        accelerate(&p, support, force, column);
        for (int i = 0; i < POSTURES; i++)
            B[(POSTURES + i) * TORQUES + j] = column[i];
    }
    return STANCE_OK;
}

/* Rows of the Jacobian of sum m_i r_i by (theta, phi_s, phi_f): heights, then horizontals. */
static void momentum(const double *robot, const stance_equilibrium *equilibrium,
                     double jacobian[2][POSTURES])
{
    double weight[POSTURES];
    const double *q = equilibrium->position;
    const int s = foot_of(equilibrium->supports), legs[POSTURES - 1] = {Q1 + s, Q2 - s};

    balance(robot, s, weight);
    jacobian[0][0] = -weight[0] * sine_of(q[THETA]);
    jacobian[1][0] = -weight[0] * cosine_of(q[THETA]);
    for (int i = 1; i < POSTURES; i++) {
        const int leg = legs[i - 1];
        jacobian[0][i] = -weight[1 + leg - Q1] * sine_of(q[THETA] + q[leg]);
        jacobian[1][i] = -weight[1 + leg - Q1] * cosine_of(q[THETA] + q[leg]);
    }
}

static stance_error contact_force(const stance_scene *scene, const double *robot,
                                  const stance_equilibrium *equilibrium, double *force,
                                  double *by_state, double *by_torque)
{
    enum { STATES = 2 * POSTURES };
    double A[STATES * STATES], B[STATES * TORQUES], jacobian[2][POSTURES];
    linearise(scene, robot, equilibrium, A, B);
    const int support = foot_of(equilibrium->supports), s = 1 + support, f = 2 - support;
    momentum(robot, equilibrium, jacobian);
    force[0] = weight_of(robot);
    force[1] = 0;
    for (int c = 0; c < 2; c++) {
        /* The accelerations are those of (theta, q1, q2): phi_i'' = theta'' + q_i''. */
        double by[POSTURES] = {jacobian[c][0] + jacobian[c][1] + jacobian[c][2]};
        by[s] = jacobian[c][1];
        by[f] = jacobian[c][2];
        for (int j = 0; j < STATES; j++) {
            by_state[c * STATES + j] = 0;
            for (int i = 0; i < POSTURES; i++)
                by_state[c * STATES + j] += by[i] * A[(POSTURES + i) * STATES + j];
        }
        for (int j = 0; j < TORQUES; j++) {
            by_torque[c * TORQUES + j] = 0;
            for (int i = 0; i < POSTURES; i++)
                by_torque[c * TORQUES + j] += by[i] * B[(POSTURES + i) * TORQUES + j];
        }
    }
    return STANCE_OK;
}

static const stance_scene closed_biped = {
    .name = "biped",
    .coordinates = COORDINATES,
    .contacts = FEET,
    .actuators = TORQUES,
    .postures = POSTURES,
    .gaps = gaps,
    .contact_point = contact_point,
    .stand = stand,
    .fallen = fallen,
    .energy = energy,
    .inertia = inertia,
    .equilibrium = equilibrium,
    .linearise = linearise,
    .contact_force = contact_force,
};

#endif
