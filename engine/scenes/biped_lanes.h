/* biped_lanes.h - the biped's algebra for the stepping core, one robot in each lane.
 *
 * Inside, the coordinates are s = (p_x, p_z, theta, phi1, phi2): the hip and the absolute angles
 * of trunk and legs, phi_i = theta + q_i. With n(a) = (cos a, sin a), t(a) = dn/da = (-sin a,
 * cos a) and the couplings k_theta = -mt lt, k_phi = m l the kinetic energy is
 *
 *   T = M |p'|^2 / 2 + sum_a ( I_a a'^2 / 2 + k_a a' n(a).p' ),
 *   M = mt + mh + 2 m,  I_theta = mt lt^2,  I_phi = m l^2,
 *
 * and the potential V = M g p_z + g (mt lt cos theta - m l (cos phi1 + cos phi2)), so dV/da =
 * k_a g sin a for each of the three angles. Lagrange's equations with the impulses r_c on the feet
 * (velocity of foot c: U_c = p' + l phi_c' n(phi_c)):
 *
 *   M p'' + sum_a k_a ( n(a) a'' + t(a) a'^2 ) + M g e_z = sum_c r_c
 *   I_a a'' + k_a n(a).p'' + k_a g sin a = tau_a + l n(phi_c).r_c,
 *   tau = (-(Gamma1 + Gamma2), Gamma1, Gamma2).
 *
 * The inertia matrix is an arrow: the angles couple to the hip alone. A step's equation keeps that
 * shape, so it is solved by eliminating the angles (a diagonal, or a full 3 x 3 block where the
 * controller acts inside the step) and a 2 x 2 Schur complement for the hip.
 */
#ifndef STANCE_SCENES_BIPED_LANES_H
#define STANCE_SCENES_BIPED_LANES_H

#include "engine/core/lanes/lanes.h"
#include "engine/core/lanes/sincos.h"
#include "engine/stance.h"

enum {
    SCENE_COORDINATES = 5,
    SCENE_CONTACTS = 2,
    SCENE_ACTUATORS = 2,
    SCENE_POSTURE = 3,
    SCENE_ANGLES = 3,
};
/* The two torques can drive two coordinates: see core/mode/decoupling.h. */
#define SCENE_SERVOS

/* Constants of a robot. Arrays over (theta, phi1, phi2) where indexed by an angle. */
typedef struct scene_body {
    lanes mass;                         /* M */
    lanes coupling_trunk, coupling_leg; /* k_theta, k_phi */
    lanes inertia_trunk, inertia_leg;
    lanes inverse_trunk, inverse_leg; /* of the inertias */
    lanes leg, trunk;                 /* lengths */
    lanes curvature;                  /* see scene_curvature */
} scene_body;

typedef struct scene_trig {
    lanes sine[SCENE_ANGLES], cosine[SCENE_ANGLES];
} scene_trig;

/* The step's matrix J = d(residual)/d(velocity), factored. */
typedef struct scene_matrix {
    lanes row[SCENE_ANGLES][2];                /* d residual_a / d p' = k_a n(a) */
    lanes column[SCENE_ANGLES][2];             /* d residual_p / d a' */
    lanes inverse[SCENE_ANGLES][SCENE_ANGLES]; /* of the angles' block; diagonal unless coupled */
    lanes schur[2][2];                         /* inverse of the Schur complement */
} scene_matrix;

static inline void scene_load_body(scene_body *b, int lane, const double *robot)
{
    const double l = robot[0], lt = robot[1], m = robot[2], mt = robot[3], mh = robot[4];
    lane_set(&b->mass, lane, mt + mh + 2 * m);
    lane_set(&b->coupling_trunk, lane, -(mt * lt));
    lane_set(&b->coupling_leg, lane, m * l);
    lane_set(&b->inertia_trunk, lane, mt * lt * lt);
    lane_set(&b->inertia_leg, lane, m * l * l);
    lane_set(&b->inverse_trunk, lane, 1 / (mt * lt * lt));
    lane_set(&b->inverse_leg, lane, 1 / (m * l * l));
    lane_set(&b->leg, lane, l);
    lane_set(&b->trunk, lane, lt);
    const double hip = 1 + 2 * (mt * lt + 2 * m * l) / mh;
    lane_set(&b->curvature, lane, 2 * hip * (1 + 1 / l + 1 / lt));
}

/* The paper's q = (x, z, theta, q1, q2) and its rate to s, s', and back. */
static inline void scene_enter(const double *robot, const double *q, const double *v, double *s,
                               double *w)
{
    double sine, cosine;
    angle_sincos(q[2], &sine, &cosine);
    s[0] = q[0] + robot[1] * sine;
    s[1] = q[1] - robot[1] * cosine;
    w[0] = v[0] + robot[1] * (cosine * v[2]);
    w[1] = v[1] + robot[1] * (sine * v[2]);
    s[2] = q[2], w[2] = v[2];
    EACH (i, 3, 5)
        s[i] = q[2] + q[i], w[i] = v[2] + v[i];
}
static inline void scene_leave(const double *robot, const double *s, const double *w, double *q,
                               double *v)
{
    double sine, cosine;
    angle_sincos(s[2], &sine, &cosine);
    q[0] = s[0] - robot[1] * sine;
    q[1] = s[1] + robot[1] * cosine;
    v[0] = w[0] - robot[1] * (cosine * w[2]);
    v[1] = w[1] - robot[1] * (sine * w[2]);
    q[2] = s[2], v[2] = w[2];
    EACH (i, 3, 5)
        q[i] = s[i] - s[2], v[i] = w[i] - w[2];
}

static inline void scene_trigonometry(const lanes *s, scene_trig *trig)
{
    EACH (a, 0, SCENE_ANGLES)
        lanes_sincos(s[2 + a], &trig->sine[a], &trig->cosine[a]);
}
/* The part that contacts need: the legs. */
static inline void scene_contact_trigonometry(const lanes *s, scene_trig *trig)
{
    EACH (a, 1, SCENE_ANGLES)
        lanes_sincos(s[2 + a], &trig->sine[a], &trig->cosine[a]);
}
static inline void scene_choose_trig(mask m, const scene_trig *a, const scene_trig *b,
                                     scene_trig *trig)
{
    EACH (i, 1, SCENE_ANGLES) {
        trig->sine[i] = choose(m, a->sine[i], b->sine[i]);
        trig->cosine[i] = choose(m, a->cosine[i], b->cosine[i]);
    }
}
/* Angles within the range of lanes_sincos. */
static inline mask scene_angles_in_range(const lanes *s)
{
    const lanes limit = lanes_of(SINCOS_LARGEST_ANGLE);
    return mask_less_equal(lanes_abs(s[2]), limit) & mask_less_equal(lanes_abs(s[3]), limit) &
           mask_less_equal(lanes_abs(s[4]), limit);
}

/* Posture (theta, q1, q2) or its rate. */
static inline void scene_posture(const lanes *s, lanes *posture)
{
    posture[0] = s[2];
    posture[1] = s[3] - s[2];
    posture[2] = s[4] - s[2];
}

/* Coordinates that have this posture, all else zero. */
static inline void scene_of_posture(const lanes *posture, lanes *s)
{
    s[0] = s[1] = lanes_of(0);
    s[2] = posture[0];
    s[3] = posture[0] + posture[1];
    s[4] = posture[0] + posture[2];
}

/* The paper's q and its rates: what scene_leave gives, without sines of its own. */
static inline void scene_coordinates(const scene_body *b, const scene_trig *trig, const lanes *s,
                                     const lanes *w, lanes *q, lanes *v)
{
    q[0] = s[0] - b->trunk * trig->sine[0];
    q[1] = s[1] + b->trunk * trig->cosine[0];
    q[2] = s[2], q[3] = s[3] - s[2], q[4] = s[4] - s[2];
    v[0] = w[0] - b->trunk * (trig->cosine[0] * w[2]);
    v[1] = w[1] - b->trunk * (trig->sine[0] * w[2]);
    v[2] = w[2], v[3] = w[3] - w[2], v[4] = w[4] - w[2];
}
/* How q moves with s: dq/ds x. */
static inline void scene_coordinate_rates(const scene_body *b, const scene_trig *trig,
                                          const lanes *x, lanes *rate)
{
    const lanes turn = b->trunk * x[2];
    rate[0] = x[0] - turn * trig->cosine[0];
    rate[1] = x[1] - turn * trig->sine[0];
    rate[2] = x[2], rate[3] = x[3] - x[2], rate[4] = x[4] - x[2];
}
/* q'' where s'' = 0. */
static inline void scene_coordinate_curvature(const scene_body *b, const scene_trig *trig,
                                              const lanes *w, lanes *curvature)
{
    const lanes turn = b->trunk * (w[2] * w[2]);
    curvature[0] = turn * trig->sine[0];
    curvature[1] = -(turn * trig->cosine[0]);
    curvature[2] = curvature[3] = curvature[4] = lanes_of(0);
}

/* residual = A(u) change - h (forces without contact), evaluated at angles `trig` and velocity w;
 * change = velocity at the end minus velocity before the step. */
static inline void scene_residual(const scene_body *b, lanes h, lanes t, const lanes *place,
                                  const scene_trig *trig, const lanes *w, const lanes *change,
                                  const lanes *torque, lanes *residual)
{
    (void)place;
    (void)t; /* no force depends on time */
    const lanes k[SCENE_ANGLES] = {b->coupling_trunk, b->coupling_leg, b->coupling_leg};
    const lanes inertia[SCENE_ANGLES] = {b->inertia_trunk, b->inertia_leg, b->inertia_leg};
    const lanes tau[SCENE_ANGLES] = {-(torque[0] + torque[1]), torque[0], torque[1]};
    const lanes hg = h * STANCE_GRAVITY;
    lanes x = b->mass * change[0], z = b->mass * (change[1] + hg);
    EACH (a, 0, SCENE_ANGLES) {
        const lanes s = trig->sine[a], c = trig->cosine[a];
        const lanes centrifugal = h * (w[2 + a] * w[2 + a]);
        const lanes along = k[a] * change[2 + a], across = k[a] * centrifugal;
        x = lanes_fma(c, along, lanes_fnma(s, across, x));
        z = lanes_fma(s, along, lanes_fma(c, across, z));
        const lanes drawn = lanes_fma(c, change[0], s * (change[1] + hg));
        residual[2 + a] = lanes_fma(inertia[a], change[2 + a], lanes_fms(k[a], drawn, h * tau[a]));
    }
    residual[0] = x;
    residual[1] = z;
}

/* Inverse of the angles' block when the controller couples it: 3 x 3 by cofactors. */
static inline void scene_invert_angles(lanes m[SCENE_ANGLES][SCENE_ANGLES],
                                       lanes inverse[SCENE_ANGLES][SCENE_ANGLES])
{
    lanes cofactor[3][3];
    EACH (i, 0, 3)
        EACH (j, 0, 3) {
            const int i1 = (i + 1) % 3, i2 = (i + 2) % 3, j1 = (j + 1) % 3, j2 = (j + 2) % 3;
            cofactor[i][j] = lanes_fms(m[i1][j1], m[i2][j2], m[i1][j2] * m[i2][j1]);
        }
    const lanes reciprocal =
        1 / lanes_fma(m[0][0], cofactor[0][0],
                      lanes_fma(m[0][1], cofactor[0][1], m[0][2] * cofactor[0][2]));
    EACH (i, 0, 3)
        EACH (j, 0, 3)
            inverse[i][j] = cofactor[j][i] * reciprocal;
}

/* y = D^-1 x over the angles. */
static inline void scene_solve_angles(const scene_matrix *m, bool coupled, const lanes *x, lanes *y)
{
    EACH (i, 0, SCENE_ANGLES) {
        if (!coupled) {
            y[i] = m->inverse[i][i] * x[i];
            continue;
        }
        y[i] = lanes_fma(m->inverse[i][0], x[0],
                         lanes_fma(m->inverse[i][1], x[1], m->inverse[i][2] * x[2]));
    }
}

/* Factors J = d residual / d velocity. `rate`: d(evaluation velocity)/d(velocity) = the method's
 * theta; `lever`: d(evaluation angle)/d(velocity), s; `contact_lever` the same for the angles that
 * the contact directions are taken at, with `contact_trig` there and the impulses r[contact][2] of
 * the last iterate. torque_rate[i][j] = d Gamma_i / d(rate of posture j) in all, read when
 * `coupled` only. */
HOT void scene_factor(const scene_body *b, lanes h, double rate, lanes lever, lanes contact_lever,
                      const scene_trig *trig, const scene_trig *contact_trig, const lanes *w,
                      const lanes *change, const lanes r[SCENE_CONTACTS][2], bool coupled,
                      const lanes torque_rate[SCENE_ACTUATORS][SCENE_POSTURE], scene_matrix *m)
{
    const lanes k[SCENE_ANGLES] = {b->coupling_trunk, b->coupling_leg, b->coupling_leg};
    const lanes inertia[SCENE_ANGLES] = {b->inertia_trunk, b->inertia_leg, b->inertia_leg};
    const lanes hg = h * STANCE_GRAVITY, twice = 2 * rate * h;
    lanes diagonal[SCENE_ANGLES];
    EACH (a, 0, SCENE_ANGLES) {
        const lanes s = trig->sine[a], c = trig->cosine[a], rotation = w[2 + a];
        const lanes along = lanes_fnma(lever * h, rotation * rotation, lanes_of(1));
        const lanes across = lanes_fma(lever, change[2 + a], twice * rotation);
        const lanes x = k[a] * c, z = k[a] * s;
        m->row[a][0] = x;
        m->row[a][1] = z;
        m->column[a][0] = lanes_fms(x, along, z * across);
        m->column[a][1] = lanes_fma(z, along, x * across);
        diagonal[a] = lanes_fma(lever, lanes_fms(x, change[1] + hg, z * change[0]), inertia[a]);
    }
    EACH (c, 0, SCENE_CONTACTS) {
        const int a = 1 + c;
        const lanes turning =
            lanes_fms(contact_trig->cosine[a], r[c][0], contact_trig->sine[a] * r[c][1]);
        diagonal[a] = lanes_fnma(contact_lever * b->leg, turning, diagonal[a]);
    }
    if (!coupled) {
        EACH (a, 0, SCENE_ANGLES) {
            EACH (j, 0, SCENE_ANGLES)
                m->inverse[a][j] = lanes_of(0);
            m->inverse[a][a] = 1 / diagonal[a];
        }
    } else {
        lanes block[3][3];
        EACH (j, 0, 3)
            EACH (i, 0, 3)
                block[i][j] = i == j ? diagonal[i] : lanes_of(0);
        EACH (j, 0, 3) {
            /* By the absolute angles: d/dtheta' = d/dtheta' - d/dq1' - d/dq2', d/dphi_i' = d/dq_i'.
             */
            lanes g[2];
            EACH (i, 0, 2) {
                g[i] = h * torque_rate[i][j];
                if (j == 0)
                    g[i] -= h * (torque_rate[i][1] + torque_rate[i][2]);
            }
            block[0][j] += g[0] + g[1];
            block[1][j] -= g[0];
            block[2][j] -= g[1];
        }
        scene_invert_angles(block, m->inverse);
    }
    /* Schur complement: M I - column^T D^-1 row. */
    lanes xx = b->mass, xz = lanes_of(0), zx = lanes_of(0), zz = b->mass;
    EACH (j, 0, 2) {
        const lanes x[3] = {m->row[0][j], m->row[1][j], m->row[2][j]};
        lanes y[3];
        scene_solve_angles(m, coupled, x, y);
        lanes *const first = j == 0 ? &xx : &xz, *const second = j == 0 ? &zx : &zz;
        EACH (a, 0, SCENE_ANGLES) {
            *first = lanes_fnma(m->column[a][0], y[a], *first);
            *second = lanes_fnma(m->column[a][1], y[a], *second);
        }
    }
    const lanes reciprocal = 1 / lanes_fms(xx, zz, xz * zx);
    m->schur[0][0] = zz * reciprocal;
    m->schur[0][1] = -xz * reciprocal;
    m->schur[1][0] = -zx * reciprocal;
    m->schur[1][1] = xx * reciprocal;
}

/* J = A, the inertia alone: symmetric, its angles' block constant. */
static inline void scene_inertia(const scene_body *b, const scene_trig *trig, scene_matrix *m)
{
    const lanes k[SCENE_ANGLES] = {b->coupling_trunk, b->coupling_leg, b->coupling_leg};
    const lanes inverse[SCENE_ANGLES] = {b->inverse_trunk, b->inverse_leg, b->inverse_leg};
    lanes xx = b->mass, xz = lanes_of(0), zz = b->mass;
    EACH (a, 0, SCENE_ANGLES) {
        const lanes x = k[a] * trig->cosine[a], z = k[a] * trig->sine[a];
        const lanes scaled = inverse[a] * x;
        m->row[a][0] = m->column[a][0] = x;
        m->row[a][1] = m->column[a][1] = z;
        m->inverse[a][a] = inverse[a];
        xx = lanes_fnma(scaled, x, xx);
        xz = lanes_fnma(scaled, z, xz);
        zz = lanes_fnma(inverse[a], z * z, zz);
    }
    const lanes reciprocal = 1 / lanes_fms(xx, zz, xz * xz);
    m->schur[0][0] = zz * reciprocal;
    m->schur[0][1] = m->schur[1][0] = -xz * reciprocal;
    m->schur[1][1] = xx * reciprocal;
}

/* Generalised forces without contact: centrifugal, gravity, torques. */
static inline void scene_forces(const scene_body *b, lanes t, const lanes *place,
                                const scene_trig *trig, const lanes *w, const lanes *torque,
                                lanes *force)
{
    (void)place;
    (void)t; /* no force depends on time */
    const lanes k[SCENE_ANGLES] = {b->coupling_trunk, b->coupling_leg, b->coupling_leg};
    const lanes tau[SCENE_ANGLES] = {-(torque[0] + torque[1]), torque[0], torque[1]};
    lanes x = lanes_of(0), z = -(b->mass * STANCE_GRAVITY);
    EACH (a, 0, SCENE_ANGLES) {
        const lanes centrifugal = k[a] * (w[2 + a] * w[2 + a]);
        x = lanes_fma(centrifugal, trig->sine[a], x);
        z = lanes_fnma(centrifugal, trig->cosine[a], z);
        force[2 + a] = lanes_fnma(STANCE_GRAVITY * k[a], trig->sine[a], tau[a]);
    }
    force[0] = x;
    force[1] = z;
}

/* x = J^-1 b. */
static inline void scene_solve(const scene_matrix *m, bool coupled, const lanes *b, lanes *x)
{
    lanes y[SCENE_ANGLES];
    scene_solve_angles(m, coupled, b + 2, y);
    lanes p[2];
    EACH (j, 0, 2)
        p[j] =
            lanes_fnma(m->column[0][j], y[0],
                       lanes_fnma(m->column[1][j], y[1], lanes_fnma(m->column[2][j], y[2], b[j])));
    x[0] = lanes_fma(m->schur[0][0], p[0], m->schur[0][1] * p[1]);
    x[1] = lanes_fma(m->schur[1][0], p[0], m->schur[1][1] * p[1]);
    lanes rest[SCENE_ANGLES];
    EACH (a, 0, SCENE_ANGLES)
        rest[a] = lanes_fnma(m->row[a][0], x[0], lanes_fnma(m->row[a][1], x[1], b[2 + a]));
    scene_solve_angles(m, coupled, rest, x + 2);
}

/* x = A^-1 B e_i for a unit of torque i, of m from scene_inertia. */
static inline void scene_actuator_response(const scene_body *b, const scene_matrix *m, int i,
                                           lanes *x)
{
    (void)b;
    const lanes zero = lanes_of(0), one = lanes_of(1);
    lanes load[SCENE_COORDINATES] = {zero, zero, -one, zero, zero};
    load[3 + i] = one;
    scene_solve(m, false, load, x);
}

/* x[direction] = J^-1 H_c^T e_direction for normal (0) and tangential (1) impulses at contact c. */
static inline void scene_contact_response(const scene_body *b, const scene_matrix *m, bool coupled,
                                          const scene_trig *trig, int c,
                                          lanes x[2][SCENE_COORDINATES])
{
    EACH (direction, 0, 2) {
        const bool normal = direction == 0;
        const lanes lever = b->leg * (normal ? trig->sine[1 + c] : trig->cosine[1 + c]);
        /* As scene_solve, of a load on the hip in one direction and on one angle. */
        lanes y[SCENE_ANGLES], p[2] = {lanes_of(normal ? 0 : 1), lanes_of(normal ? 1 : 0)};
        EACH (a, 0, SCENE_ANGLES) {
            if (!coupled && a != 1 + c)
                continue;
            y[a] = m->inverse[a][1 + c] * lever;
            EACH (j, 0, 2)
                p[j] = lanes_fnma(m->column[a][j], y[a], p[j]);
        }
        x[direction][0] = lanes_fma(m->schur[0][0], p[0], m->schur[0][1] * p[1]);
        x[direction][1] = lanes_fma(m->schur[1][0], p[0], m->schur[1][1] * p[1]);
        lanes rest[SCENE_ANGLES];
        EACH (a, 0, SCENE_ANGLES) {
            const lanes drawn =
                lanes_fma(m->row[a][0], x[direction][0], m->row[a][1] * x[direction][1]);
            rest[a] = -drawn;
            if (a == 1 + c)
                rest[a] = lever - drawn;
        }
        scene_solve_angles(m, coupled, rest, x[direction] + 2);
    }
}

/* Velocity of contact c: normal, tangential. */
static inline void scene_contact_velocity(const scene_body *b, const scene_trig *trig, int c,
                                          const lanes *w, lanes u[2])
{
    const lanes speed = b->leg * w[3 + c];
    u[0] = lanes_fma(speed, trig->sine[1 + c], w[1]);
    u[1] = lanes_fma(speed, trig->cosine[1 + c], w[0]);
}
/* Its derivative along `change` of the velocity, when the angle moves by `lever` times the change:
 * (H + lever dH/ds w) change. */
static inline void scene_contact_velocity_change(const scene_body *b, const scene_trig *trig, int c,
                                                 const lanes *w, lanes lever, const lanes *change,
                                                 lanes u[2])
{
    const lanes s = trig->sine[1 + c], k = trig->cosine[1 + c];
    const lanes turn = lever * w[3 + c];
    const lanes speed = b->leg * change[3 + c];
    u[0] = lanes_fma(speed, lanes_fma(turn, k, s), change[1]);
    u[1] = lanes_fma(speed, lanes_fnma(turn, s, k), change[0]);
}

/* Acceleration of contact c (normal, tangential) when the coordinates do not accelerate. */
static inline void scene_contact_curvature(const scene_body *b, const scene_trig *trig, int c,
                                           const lanes *w, lanes a[2])
{
    const lanes turn = b->leg * (w[3 + c] * w[3 + c]);
    a[0] = turn * trig->cosine[1 + c];
    a[1] = -(turn * trig->sine[1 + c]);
}

static inline lanes scene_gap(const scene_body *b, const lanes *s, const scene_trig *trig, int c)
{
    return lanes_fnma(b->leg, trig->cosine[1 + c], s[1]);
}
/* Where a contact is along the ground, m. */
static inline lanes scene_along(const scene_body *b, const lanes *s, const scene_trig *trig, int c)
{
    return lanes_fma(b->leg, trig->sine[1 + c], s[0]);
}
/* Gap after a small displacement d of s, to second order in the leg's angle. */
static inline lanes scene_gap_change(const scene_body *b, const scene_trig *trig, int c,
                                     const lanes *d)
{
    const lanes a = d[3 + c];
    return lanes_fma(b->leg * a, lanes_fma(0.5 * a, trig->cosine[1 + c], trig->sine[1 + c]), d[1]);
}
/* Bound on what scene_gap_change leaves out. */
static inline lanes scene_gap_change_error(const scene_body *b, const scene_trig *trig, int c,
                                           const lanes *d)
{
    const lanes a = lanes_abs(d[3 + c]);
    (void)trig;
    return b->leg * (a * a * a);
}

/* Mechanical energy that a small displacement d adds at velocity w, first order. */
static inline lanes scene_energy_change(const scene_body *b, const lanes *place,
                                        const scene_trig *trig, const lanes *w, const lanes *d)
{
    (void)place;
    const lanes k[SCENE_ANGLES] = {b->coupling_trunk, b->coupling_leg, b->coupling_leg};
    lanes sum = b->mass * (STANCE_GRAVITY * d[1]);
    EACH (a, 0, SCENE_ANGLES) {
        const lanes s = trig->sine[a], c = trig->cosine[a];
        const lanes drawn = lanes_fms(c, w[1], s * w[0]);
        sum = lanes_fma(k[a] * d[2 + a], lanes_fma(w[2 + a], drawn, STANCE_GRAVITY * s), sum);
    }
    return sum;
}
/* Kinetic energy of a velocity change x: x^T A x / 2. */
static inline lanes scene_kinetic(const scene_body *b, const scene_trig *trig, const lanes *x)
{
    const lanes k[SCENE_ANGLES] = {b->coupling_trunk, b->coupling_leg, b->coupling_leg};
    const lanes inertia[SCENE_ANGLES] = {b->inertia_trunk, b->inertia_leg, b->inertia_leg};
    lanes sum = (0.5 * b->mass) * lanes_fma(x[0], x[0], x[1] * x[1]);
    EACH (a, 0, SCENE_ANGLES) {
        const lanes along = lanes_fma(trig->cosine[a], x[0], trig->sine[a] * x[1]);
        sum = lanes_fma(x[2 + a], lanes_fma(k[a], along, (0.5 * inertia[a]) * x[2 + a]), sum);
    }
    return sum;
}

/* Potential energy at s. */
static inline lanes scene_potential(const scene_body *b, const lanes *s, const scene_trig *trig)
{
    const lanes trunk = lanes_fnma(b->coupling_trunk, trig->cosine[0], b->mass * s[1]);
    return STANCE_GRAVITY * lanes_fnma(b->coupling_leg, trig->cosine[1] + trig->cosine[2], trunk);
}
/* Kinetic and potential energy at s with velocity w. */
static inline lanes scene_energy(const scene_body *b, const lanes *s, const lanes *w,
                                 const scene_trig *trig)
{
    return scene_kinetic(b, trig, w) + scene_potential(b, s, trig);
}
/* Work of the torques over a displacement d. */
static inline lanes scene_work(const scene_body *b, lanes h, lanes t, const scene_trig *trig,
                               const lanes *torque, const lanes *d)
{
    (void)trig;
    (void)b, (void)h, (void)t;
    return lanes_fma(torque[0], d[3] - d[2], torque[1] * (d[4] - d[2]));
}

/* Down by cause 0, the hip below `fall_height` leg lengths, or 1, the trunk on the ground: how far
 * it is from that, and how fast that changes. */
#define SCENE_CAUSES 2
#define SCENE_FALLS_BEYOND(cause) ((cause) == 0) /* exactly there it has not fallen */
static inline lanes scene_fall_margin(const scene_body *b, const lanes *s, const scene_trig *trig,
                                      const lanes *w, lanes fall_height, int cause, lanes *rate)
{
    *rate = w[1];
    if (cause == 0)
        return s[1] - fall_height * b->leg;
    *rate = lanes_fnma(b->trunk * w[2], trig->sine[0], w[1]);
    return lanes_fma(b->trunk, trig->cosine[0], s[1]);
}
/* Largest of the rates: the trunk's x and z, its pitch, the joints. */
static inline lanes scene_largest_rate(const scene_body *b, const lanes *w, const scene_trig *trig)
{
    const lanes turn = b->trunk * w[2];
    lanes largest = lanes_max(lanes_abs(lanes_fnma(turn, trig->cosine[0], w[0])),
                              lanes_abs(lanes_fnma(turn, trig->sine[0], w[1])));
    largest = lanes_max(lanes_abs(w[2]), largest);
    EACH (i, 3, SCENE_COORDINATES)
        largest = lanes_max(lanes_abs(w[i] - w[2]), largest);
    return largest;
}

/* K of which a correction d of the velocities leaves an error of at most K h |d|^2 in a step's
 * equation. What the linearisation leaves out are 2 h k_a a'^2 on the hip, whose Schur complement
 * is mh at least, h k_a a' |p'| on an angle, of inertia k_a l_a, and as much for the contacts. */
static inline lanes scene_curvature(const scene_body *b)
{
    return b->curvature;
}

/* The longest step, s, that resolves how forces change with time: they do not. */
static inline lanes scene_longest_step(const scene_body *b)
{
    (void)b;
    return lanes_of(INFINITY);
}

#endif
