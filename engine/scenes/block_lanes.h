/* block_lanes.h - the block's algebra for the stepping core, one block in each lane.
 *
 * s = q = (x, z): see block.c for the equations, in the plane's frame. The inertia matrix is m I,
 * no angle moves, and contact directions do not turn, so everything that other scenes expand is
 * exact here. The pull is the one force that depends on time.
 */
#ifndef STANCE_SCENES_BLOCK_LANES_H
#define STANCE_SCENES_BLOCK_LANES_H

#include "engine/core/lanes/lanes.h"
#include "engine/core/lanes/sincos.h"
#include "engine/stance.h"

enum {
    SCENE_COORDINATES = 2,
    SCENE_CONTACTS = 1,
    SCENE_ACTUATORS = 0,
    SCENE_POSTURE = 0,
    SCENE_ANGLES = 0,
};

typedef struct scene_body {
    lanes mass;
    lanes along, across;   /* gravity along the plane and into it, m/s^2 */
    lanes pull, frequency; /* N, Hz */
} scene_body;

typedef struct scene_trig {
    lanes sine[SLOTS(SCENE_ANGLES)], cosine[SLOTS(SCENE_ANGLES)]; /* of no angle: 0 and 1 */
} scene_trig;

/* The step's matrix J = d(residual)/d(velocity), inverted. */
typedef struct scene_matrix {
    lanes inverse_mass;
} scene_matrix;

static inline void scene_load_body(scene_body *b, int lane, const double *robot)
{
    double sine, cosine;
    angle_sincos(robot[1], &sine, &cosine);
    lane_set(&b->mass, lane, robot[0]);
    lane_set(&b->along, lane, STANCE_GRAVITY * sine);
    lane_set(&b->across, lane, STANCE_GRAVITY * cosine);
    lane_set(&b->pull, lane, robot[2]);
    lane_set(&b->frequency, lane, robot[3]);
}

/* The pull at time t, N. */
static inline lanes scene_pull(const scene_body *b, lanes t)
{
    const double round_bits = 0x1.8p52; /* adding it rounds to a whole number of periods */
    const lanes periods = b->frequency * t;
    const lanes phase = periods - ((periods + round_bits) - round_bits);
    lanes sine, cosine;
    lanes_sincos(0x1.921fb54442d18p+2 * phase, &sine, &cosine); /* 2 pi */
    return b->pull * sine;
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
    (void)s;
    trig->sine[0] = lanes_of(0);
    trig->cosine[0] = lanes_of(1);
}
static inline void scene_contact_trigonometry(const lanes *s, scene_trig *trig)
{
    scene_trigonometry(s, trig);
}
static inline void scene_choose_trig(mask m, const scene_trig *a, const scene_trig *b,
                                     scene_trig *trig)
{
    (void)m, (void)b;
    *trig = *a;
}
static inline mask scene_angles_in_range(const lanes *s)
{
    (void)s;
    return LANES_ALL;
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
    (void)trig, (void)w, (void)torque;
    residual[0] = b->mass * (change[0] - h * b->along) - h * scene_pull(b, t);
    residual[1] = b->mass * (change[1] + h * b->across);
}

/* Factors J = d residual / d velocity: the mass. */
HOT void scene_factor(const scene_body *b, lanes h, double rate, lanes lever, lanes contact_lever,
                      const scene_trig *trig, const scene_trig *contact_trig, const lanes *w,
                      const lanes *change, const lanes r[SCENE_CONTACTS][2], bool coupled,
                      const lanes torque_rate[SLOTS(SCENE_ACTUATORS)][SLOTS(SCENE_POSTURE)],
                      scene_matrix *m)
{
    (void)h, (void)rate, (void)lever, (void)contact_lever, (void)trig, (void)contact_trig;
    (void)w, (void)change, (void)r, (void)coupled, (void)torque_rate;
    m->inverse_mass = 1 / b->mass;
}

/* J = A, the mass alone. */
static inline void scene_inertia(const scene_body *b, const scene_trig *trig, scene_matrix *m)
{
    (void)trig;
    m->inverse_mass = 1 / b->mass;
}

/* Generalised forces without contact. */
static inline void scene_forces(const scene_body *b, lanes t, const lanes *place,
                                const scene_trig *trig, const lanes *w, const lanes *torque,
                                lanes *force)
{
    (void)place;
    (void)trig, (void)w, (void)torque;
    force[0] = b->mass * b->along + scene_pull(b, t);
    force[1] = -(b->mass * b->across);
}

/* x = J^-1 b. */
static inline void scene_solve(const scene_matrix *m, bool coupled, const lanes *b, lanes *x)
{
    (void)coupled;
    EACH (i, 0, SCENE_COORDINATES)
        x[i] = m->inverse_mass * b[i];
}

/* x[direction] = J^-1 H_c^T e_direction for normal (0) and tangential (1) impulses. */
static inline void scene_contact_response(const scene_body *b, const scene_matrix *m, bool coupled,
                                          const scene_trig *trig, int c,
                                          lanes x[2][SCENE_COORDINATES])
{
    (void)b, (void)coupled, (void)trig, (void)c;
    x[0][0] = x[1][1] = lanes_of(0);
    x[0][1] = x[1][0] = m->inverse_mass;
}

/* Velocity of the contact: normal, tangential. */
static inline void scene_contact_velocity(const scene_body *b, const scene_trig *trig, int c,
                                          const lanes *w, lanes u[2])
{
    (void)b, (void)trig, (void)c;
    u[0] = w[1];
    u[1] = w[0];
}
/* (H + lever dH/ds w) change, with H constant. */
static inline void scene_contact_velocity_change(const scene_body *b, const scene_trig *trig, int c,
                                                 const lanes *w, lanes lever, const lanes *change,
                                                 lanes u[2])
{
    (void)w, (void)lever;
    scene_contact_velocity(b, trig, c, change, u);
}
/* Acceleration of the contact when the coordinates do not accelerate. */
static inline void scene_contact_curvature(const scene_body *b, const scene_trig *trig, int c,
                                           const lanes *w, lanes a[2])
{
    (void)b, (void)trig, (void)c, (void)w;
    a[0] = a[1] = lanes_of(0);
}

static inline lanes scene_gap(const scene_body *b, const lanes *s, const scene_trig *trig, int c)
{
    (void)b, (void)trig, (void)c;
    return s[1];
}
/* Where a contact is along the ground, m. */
static inline lanes scene_along(const scene_body *b, const lanes *s, const scene_trig *trig, int c)
{
    (void)b, (void)trig, (void)c;
    return s[0];
}
/* What a displacement d adds to the gap; exact. */
static inline lanes scene_gap_change(const scene_body *b, const scene_trig *trig, int c,
                                     const lanes *d)
{
    (void)b, (void)trig, (void)c;
    return d[1];
}
static inline lanes scene_gap_change_error(const scene_body *b, const scene_trig *trig, int c,
                                           const lanes *d)
{
    (void)b, (void)trig, (void)c, (void)d;
    return lanes_of(0);
}

/* Mechanical energy that a displacement d adds. */
static inline lanes scene_energy_change(const scene_body *b, const lanes *place,
                                        const scene_trig *trig, const lanes *w, const lanes *d)
{
    (void)place;
    (void)trig, (void)w;
    return b->mass * (b->across * d[1] - b->along * d[0]);
}
/* Kinetic energy of a velocity change x. */
static inline lanes scene_kinetic(const scene_body *b, const scene_trig *trig, const lanes *x)
{
    (void)trig;
    return 0.5 * (b->mass * (x[0] * x[0] + x[1] * x[1]));
}
/* Potential energy at s. */
static inline lanes scene_potential(const scene_body *b, const lanes *s, const scene_trig *trig)
{
    (void)trig;
    return b->mass * (b->across * s[1] - b->along * s[0]);
}
/* Kinetic and potential energy at s with velocity w. */
static inline lanes scene_energy(const scene_body *b, const lanes *s, const lanes *w,
                                 const scene_trig *trig)
{
    return scene_kinetic(b, trig, w) + scene_potential(b, s, trig);
}
/* Work of the pull at time t over a displacement d. */
static inline lanes scene_work(const scene_body *b, lanes h, lanes t, const scene_trig *trig,
                               const lanes *torque, const lanes *d)
{
    (void)trig;
    (void)h, (void)torque;
    return scene_pull(b, t) * d[0];
}

/* A block that does not turn has nothing to fall from. */
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
    return lanes_max(lanes_abs(w[0]), lanes_abs(w[1]));
}

/* K of which a correction d of the velocities leaves an error of at most K h |d|^2 in a step's
 * equation, which is linear. */
static inline lanes scene_curvature(const scene_body *b)
{
    (void)b;
    return lanes_of(0);
}

/* The longest step, s, that resolves how forces change with time: an eighth of a period. */
static inline lanes scene_longest_step(const scene_body *b)
{
    const lanes forever = lanes_of(INFINITY);
    return choose(mask_less(lanes_of(0), lanes_abs(b->pull)), 0.125 / b->frequency, forever);
}

#endif
