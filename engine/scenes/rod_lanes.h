/* rod_lanes.h - the rod's algebra for the stepping core, one rod in each lane.
 *
 * s = q = (x, z, theta): see rod.c for the equations. The inertia matrix is diagonal and constant.
 * A step's matrix has one more term on its diagonal, from the impulses' lever arms about the
 * centre, which turn with the rod: H_e^T r = (r_T, r_N, sigma_e a (r_N cos theta - r_T sin theta)).
 */
#ifndef STANCE_SCENES_ROD_LANES_H
#define STANCE_SCENES_ROD_LANES_H

#include "engine/core/lanes/lanes.h"
#include "engine/core/lanes/sincos.h"
#include "engine/stance.h"

enum {
    SCENE_COORDINATES = 3,
    SCENE_CONTACTS = 2,
    SCENE_ACTUATORS = 0,
    SCENE_POSTURE = 0,
    SCENE_ANGLES = 1,
};

typedef struct scene_body {
    lanes mass, inertia;
    lanes half; /* of the length */
} scene_body;

typedef struct scene_trig {
    lanes sine[SCENE_ANGLES], cosine[SCENE_ANGLES];
} scene_trig;

/* The step's matrix J = d(residual)/d(velocity), inverted. */
typedef struct scene_matrix {
    lanes inverse_mass, inverse_inertia;
} scene_matrix;

static inline void scene_load_body(scene_body *b, int lane, const double *robot)
{
    const double length = robot[0], mass = robot[1], ratio = robot[2];
    lane_set(&b->mass, lane, mass);
    lane_set(&b->inertia, lane, ratio * (mass * (length * length)));
    lane_set(&b->half, lane, 0.5 * length);
}

/* From the centre to an end: sigma_e a. */
static inline lanes scene_arm(const scene_body *b, int c)
{
    return c == 0 ? -b->half : b->half;
}

static inline void scene_enter(const double *robot, const double *q, const double *v, double *s,
                               double *w)
{
    (void)robot;
    EACH (i, 0, SCENE_COORDINATES)
        s[i] = q[i], w[i] = v[i];
}
static inline void scene_leave(const double *robot, const double *s, const double *w, double *q,
                               double *v)
{
    (void)robot;
    EACH (i, 0, SCENE_COORDINATES)
        q[i] = s[i], v[i] = w[i];
}

static inline void scene_trigonometry(const lanes *s, scene_trig *trig)
{
    lanes_sincos(s[2], &trig->sine[0], &trig->cosine[0]);
}
static inline void scene_contact_trigonometry(const lanes *s, scene_trig *trig)
{
    scene_trigonometry(s, trig);
}
static inline void scene_choose_trig(mask m, const scene_trig *a, const scene_trig *b,
                                     scene_trig *trig)
{
    trig->sine[0] = choose(m, a->sine[0], b->sine[0]);
    trig->cosine[0] = choose(m, a->cosine[0], b->cosine[0]);
}
/* The angle within the range of lanes_sincos. */
static inline mask scene_angles_in_range(const lanes *s)
{
    return mask_less_equal(lanes_abs(s[2]), lanes_of(SINCOS_LARGEST_ANGLE));
}

static inline void scene_posture(const lanes *s, lanes *posture)
{
    (void)s, (void)posture;
}
static inline void scene_of_posture(const lanes *posture, lanes *s)
{
    (void)posture, (void)s;
}

/* residual = A change - h (forces without contact). */
static inline void scene_residual(const scene_body *b, lanes h, lanes t, const lanes *place,
                                  const scene_trig *trig, const lanes *w, const lanes *change,
                                  const lanes *torque, lanes *residual)
{
    (void)place;
    (void)t, (void)trig, (void)w, (void)torque;
    residual[0] = b->mass * change[0];
    residual[1] = b->mass * (change[1] + h * STANCE_GRAVITY);
    residual[2] = b->inertia * change[2];
}

/* Factors J = d residual / d velocity, less what the impulses r turn with the angle, which moves
 * `contact_lever` per unit of velocity: - contact_lever d(H^T r)/d theta. */
HOT void scene_factor(const scene_body *b, lanes h, double rate, lanes lever, lanes contact_lever,
                      const scene_trig *trig, const scene_trig *contact_trig, const lanes *w,
                      const lanes *change, const lanes r[SCENE_CONTACTS][2], bool coupled,
                      const lanes torque_rate[SLOTS(SCENE_ACTUATORS)][SLOTS(SCENE_POSTURE)],
                      scene_matrix *m)
{
    (void)h, (void)rate, (void)lever, (void)trig, (void)w, (void)change;
    (void)coupled, (void)torque_rate;
    lanes turned = b->inertia;
    EACH (c, 0, SCENE_CONTACTS)
        turned += contact_lever * (scene_arm(b, c) * (contact_trig->sine[0] * r[c][0] +
                                                      contact_trig->cosine[0] * r[c][1]));
    m->inverse_mass = 1 / b->mass;
    m->inverse_inertia = 1 / turned;
}

/* J = A, the inertia alone. */
static inline void scene_inertia(const scene_body *b, const scene_trig *trig, scene_matrix *m)
{
    (void)trig;
    m->inverse_mass = 1 / b->mass;
    m->inverse_inertia = 1 / b->inertia;
}

/* Generalised forces without contact. */
static inline void scene_forces(const scene_body *b, lanes t, const lanes *place,
                                const scene_trig *trig, const lanes *w, const lanes *torque,
                                lanes *force)
{
    (void)place;
    (void)t, (void)trig, (void)w, (void)torque;
    force[0] = force[2] = lanes_of(0);
    force[1] = -(b->mass * STANCE_GRAVITY);
}

/* x = J^-1 b. */
static inline void scene_solve(const scene_matrix *m, bool coupled, const lanes *b, lanes *x)
{
    (void)coupled;
    x[0] = m->inverse_mass * b[0];
    x[1] = m->inverse_mass * b[1];
    x[2] = m->inverse_inertia * b[2];
}

/* x[direction] = J^-1 H_c^T e_direction for normal (0) and tangential (1) impulses at end c. */
static inline void scene_contact_response(const scene_body *b, const scene_matrix *m, bool coupled,
                                          const scene_trig *trig, int c,
                                          lanes x[2][SCENE_COORDINATES])
{
    const lanes turn = m->inverse_inertia * scene_arm(b, c);
    (void)coupled;
    x[0][0] = x[1][1] = lanes_of(0);
    x[0][1] = x[1][0] = m->inverse_mass;
    x[0][2] = turn * trig->cosine[0];
    x[1][2] = -(turn * trig->sine[0]);
}

/* Velocity of end c: normal, tangential. */
static inline void scene_contact_velocity(const scene_body *b, const scene_trig *trig, int c,
                                          const lanes *w, lanes u[2])
{
    const lanes turn = scene_arm(b, c) * w[2];
    u[0] = w[1] + turn * trig->cosine[0];
    u[1] = w[0] - turn * trig->sine[0];
}
/* Its derivative along `change` of the velocity, when the angle moves by `lever` times the change:
 * (H + lever dH/ds w) change. */
static inline void scene_contact_velocity_change(const scene_body *b, const scene_trig *trig, int c,
                                                 const lanes *w, lanes lever, const lanes *change,
                                                 lanes u[2])
{
    const lanes sine = trig->sine[0], cosine = trig->cosine[0];
    const lanes turn = lever * w[2], speed = scene_arm(b, c) * change[2];
    u[0] = change[1] + speed * (cosine - turn * sine);
    u[1] = change[0] - speed * (sine + turn * cosine);
}
/* Acceleration of end c (normal, tangential) when the coordinates do not accelerate. */
static inline void scene_contact_curvature(const scene_body *b, const scene_trig *trig, int c,
                                           const lanes *w, lanes a[2])
{
    const lanes turn = scene_arm(b, c) * (w[2] * w[2]);
    a[0] = -(turn * trig->sine[0]);
    a[1] = -(turn * trig->cosine[0]);
}

static inline lanes scene_gap(const scene_body *b, const lanes *s, const scene_trig *trig, int c)
{
    return s[1] + scene_arm(b, c) * trig->sine[0];
}
/* Where a contact is along the ground, m. */
static inline lanes scene_along(const scene_body *b, const lanes *s, const scene_trig *trig, int c)
{
    return s[0] + scene_arm(b, c) * trig->cosine[0];
}
/* What a small displacement d adds to a gap, to second order in the angle. */
static inline lanes scene_gap_change(const scene_body *b, const scene_trig *trig, int c,
                                     const lanes *d)
{
    const lanes turn = d[2];
    return d[1] + scene_arm(b, c) * (turn * (trig->cosine[0] - 0.5 * (turn * trig->sine[0])));
}
/* Bound on what scene_gap_change leaves out. */
static inline lanes scene_gap_change_error(const scene_body *b, const scene_trig *trig, int c,
                                           const lanes *d)
{
    const lanes turn = lanes_abs(d[2]);
    (void)trig, (void)c;
    return b->half * (turn * turn * turn);
}

/* Mechanical energy that a displacement d adds. */
static inline lanes scene_energy_change(const scene_body *b, const lanes *place,
                                        const scene_trig *trig, const lanes *w, const lanes *d)
{
    (void)place;
    (void)trig, (void)w;
    return b->mass * (STANCE_GRAVITY * d[1]);
}
/* Kinetic energy of a velocity change x. */
static inline lanes scene_kinetic(const scene_body *b, const scene_trig *trig, const lanes *x)
{
    (void)trig;
    return 0.5 * (b->mass * (x[0] * x[0] + x[1] * x[1]) + b->inertia * (x[2] * x[2]));
}
/* Potential energy at s. */
static inline lanes scene_potential(const scene_body *b, const lanes *s, const scene_trig *trig)
{
    (void)trig;
    return b->mass * (STANCE_GRAVITY * s[1]);
}
/* Kinetic and potential energy at s with velocity w. */
static inline lanes scene_energy(const scene_body *b, const lanes *s, const lanes *w,
                                 const scene_trig *trig)
{
    return scene_kinetic(b, trig, w) + scene_potential(b, s, trig);
}
/* Nothing but gravity and contact acts. */
static inline lanes scene_work(const scene_body *b, lanes h, lanes t, const scene_trig *trig,
                               const lanes *torque, const lanes *d)
{
    (void)trig;
    (void)b, (void)h, (void)t, (void)torque, (void)d;
    return lanes_of(0);
}

/* A rod has no height that it ought to keep. */
#define SCENE_CAUSES 0
#define SCENE_FALLS_BEYOND(cause) false
static inline lanes scene_fall_margin(const scene_body *b, const lanes *s, const scene_trig *trig,
                                      const lanes *w, lanes fall_height, int cause, lanes *rate)
{
    (void)b, (void)s, (void)trig, (void)w, (void)fall_height, (void)cause, (void)rate;
    return lanes_of(INFINITY);
}
/* Largest of the rates. */
static inline lanes scene_largest_rate(const scene_body *b, const lanes *w, const scene_trig *trig)
{
    (void)b, (void)trig;
    return lanes_max(lanes_abs(w[2]), lanes_max(lanes_abs(w[0]), lanes_abs(w[1])));
}

/* K of which a correction d of the velocities leaves an error of at most K h |d|^2 in a step's
 * equation: the ends' velocities leave out h a theta'^2, which impulses through the centre and
 * about it take up. */
static inline lanes scene_curvature(const scene_body *b)
{
    return 2 * b->half * (1 + b->mass * b->half / b->inertia) * (1 + 1 / b->half);
}

/* The longest step, s, that resolves how forces change with time: they do not. */
static inline lanes scene_longest_step(const scene_body *b)
{
    (void)b;
    return lanes_of(INFINITY);
}

#endif
