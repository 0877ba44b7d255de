/* law.h - the control laws as the stepping core knows them: what is commanded in which state.
 *
 * The linear law (none, hold, state-feedback) is
 *
 *   torque = clip(feedforward - gain (posture - target, rate)).
 *
 * A bimodal law (bimodal-feedback) takes push max(0, normal (posture - target, rate) - 1) off that
 * before it is clipped.
 *
 * The decoupling law (the paper's section 3.3) drives as many coordinates as there are actuators to
 * accelerations of its own choice, given by a PID on each:
 *
 *   e = kp (r - q) + kd (r' - q') + ki I,     I' = r - q,     r = setpoint + ramp min(t, duration).
 *
 * What torques that takes depends on the reactions of the ground; decoupling.h solves both
 * together. I is kept within +-integral_limit and does not grow while a torque is at its limit
 * (anti-windup).
 *
 * A law of outputs drives y_i = row_i q - h_i(s) to zero, h_i a polynomial of the phase
 * s = (phase q - from) / (to - from):
 *
 *   y' = E q',  E = row - h' ds/dq,     y'' = E q'' + row q''|_(no accelerations) - h'' s'^2,
 *
 * so that E is the row of a servo that asks for e = -kp y - kd y', and h'' s'^2 more. A phase may
 * be a polynomial of the time since the last footfall, as well: then y' = E q' - h' s_t, and h'
 * s_tt is asked for, too. Rows and phase are those of the leg that stands. Or torques are constants
 * times e, without a model.
 *
 * A switching law is linear inside an ellipsoid about its target and something else outside: a
 * decoupling law, or a second linear one (`far`).
 */
#ifndef STANCE_CORE_LAW_LAW_H
#define STANCE_CORE_LAW_LAW_H

#include "engine/core/lanes/lanes.h"
#include "engine/core/lanes/sizes.h"

/* A state that a law, or the equations of motion, are asked about. */
struct state {
    lanes t;               /* s */
    const lanes *s, *w;    /* coordinates of the core, and rates */
    const lanes *integral; /* what the law has summed */
};

struct linear_law {
    lanes feedforward[ACTUATORS];
    lanes gain[ACTUATORS][2 * POSTURES];
    lanes target[POSTURES];
};

/* One controlled coordinate, `pick` 1 at it, 0 elsewhere; or an output and its row. */
struct servo {
    lanes pick[SCENE_COORDINATES];
    lanes setpoint, ramp, duration; /* unit of the coordinate; /s; s */
    lanes kp, ki, kd;               /* 1/s^2, 1/s^3, 1/s */
    lanes integral_limit;           /* of the coordinate, times s */
};

#ifdef SCENE_SERVOS
#define LAW_OUTPUTS ACTUATORS
#else
#define LAW_OUTPUTS 1
#endif
struct law {
    struct linear_law near, far;
    struct servo servo[ACTUATORS];
    lanes follows;  /* 1: servos are outputs, of the phase: */
    lanes constant; /* 1: ... whose accelerations are weighted by `torques` */
    lanes phase[SCENE_COORDINATES], phase_from;     /* s = phase q - phase_from ... */
    lanes clock[STANCE_MAX_COEFFICIENTS], footfall; /* ... + a polynomial of the time since, s */
    lanes along[LAW_OUTPUTS][STANCE_MAX_COEFFICIENTS], torques[LAW_OUTPUTS][LAW_OUTPUTS];
    lanes decouples; /* 1: torques are those of the servos, where the law does not switch */
    lanes switches;  /* 1: `linear` inside the ellipsoid only */
    lanes inverse_axis[2 * POSTURES]; /* of the ellipsoid, 1/rad and s/rad */
    lanes limit[ACTUATORS];           /* N m */
    lanes normal[2 * POSTURES];       /* of the plane beyond which `near` bends ... */
    lanes push[ACTUATORS];            /* ... and how, N m; 0: not at all */
};

/* Does a law that acts all the time sum errors in any lane? */
static inline bool law_sums(const struct law *law, bool coupled)
{
    mask any = MASK_NONE;
    for (int i = 0; i < SCENE_ACTUATORS; i++)
        any |= mask_less(lanes_of(0), lanes_abs(law->servo[i].ki));
    return SCENE_ACTUATORS > 0 && coupled && mask_any(any & mask_less(lanes_of(0), law->decouples));
}

static inline void linear_torque(const struct linear_law *law, const lanes *posture,
                                 const lanes *rate, lanes *torque)
{
    for (int i = 0; i < SCENE_ACTUATORS; i++) {
        torque[i] = law->feedforward[i];
        for (int j = 0; j < SCENE_POSTURE; j++)
            torque[i] = lanes_fnma(law->gain[i][j], posture[j] - law->target[j],
                                   lanes_fnma(law->gain[i][SCENE_POSTURE + j], rate[j], torque[i]));
    }
}

/* Torques by the linear law `near`. */
static inline void law_torque(const struct law *law, const lanes *s, const lanes *w, lanes *torque)
{
    lanes posture[POSTURES], rate[POSTURES];
    scene_posture(s, posture);
    scene_posture(w, rate);
    linear_torque(&law->near, posture, rate, torque);
}
/* The same at a sample, with the law's bend. */
static inline void law_sampled(const struct law *law, const lanes *s, const lanes *w, lanes *torque)
{
    lanes posture[POSTURES], rate[POSTURES], beyond = lanes_of(-1);
    scene_posture(s, posture);
    scene_posture(w, rate);
    linear_torque(&law->near, posture, rate, torque);
    for (int j = 0; j < SCENE_POSTURE; j++)
        beyond = lanes_fma(law->normal[j], posture[j] - law->near.target[j],
                           lanes_fma(law->normal[SCENE_POSTURE + j], rate[j], beyond));
    beyond = lanes_max(beyond, lanes_of(0));
    for (int i = 0; i < SCENE_ACTUATORS; i++)
        torque[i] = lanes_fnma(law->push[i], beyond, torque[i]);
}
static inline void law_clip(const struct law *law, lanes *torque)
{
    for (int i = 0; i < SCENE_ACTUATORS; i++)
        torque[i] = lanes_max(lanes_min(torque[i], law->limit[i]), -law->limit[i]);
}

/* Torques at a state: those that are held or, `coupled`, of a linear law that acts all the time;
 * none where a decoupling law is to add its own. */
HOT void law_drive(const struct law *law, const lanes *held, bool coupled, const lanes *s,
                   const lanes *w, lanes *torque)
{
    EACH (i, 0, SCENE_ACTUATORS)
        torque[i] = held[i];
    if (coupled) {
        law_torque(law, s, w, torque);
        law_clip(law, torque);
        EACH (i, 0, SCENE_ACTUATORS)
            torque[i] = choose(mask_less(lanes_of(0), law->decouples), lanes_of(0), torque[i]);
    }
}

/* The linear law acting inside the step: torque and its derivative by the velocity at the end, of
 * which the positions move by `lever` and the velocities by `rate_lever` per unit. A decoupling law
 * holds the torque. `corner`: NULL, or for each torque 0 where it is taken for free, -1 or 1 where
 * it is taken for being at its limit, whatever is commanded. */
static inline void law_inside(const struct law *law, const struct state *at, lanes lever,
                              double rate_lever, const int *corner, lanes *torque,
                              lanes rate[ACTUATORS][POSTURES])
{
    lanes command[ACTUATORS];
    const mask decouples = mask_less(lanes_of(0), law->decouples);
    lanes clipped[ACTUATORS];
    law_torque(law, at->s, at->w, command);
    for (int i = 0; i < SCENE_ACTUATORS; i++)
        clipped[i] = command[i];
    law_clip(law, clipped);
    for (int i = 0; i < SCENE_ACTUATORS; i++) {
        mask free = mask_less(lanes_abs(command[i]), law->limit[i]);
        if (corner) {
            clipped[i] = corner[i] == 0  ? command[i]
                         : corner[i] > 0 ? law->limit[i]
                                         : -law->limit[i];
            free = corner[i] == 0 ? LANES_ALL : MASK_NONE;
        }
        torque[i] = choose(decouples, torque[i], clipped[i]);
        for (int j = 0; j < SCENE_POSTURE; j++) {
            const lanes slope =
                law->near.gain[i][j] * lever + law->near.gain[i][SCENE_POSTURE + j] * rate_lever;
            rate[i][j] = choose(free, -slope, lanes_of(0));
        }
    }
}

/* Lanes where the torques at s, w are what `corner` took them for. */
static inline mask law_agrees(const struct law *law, const lanes *s, const lanes *w,
                              const int *corner)
{
    lanes command[ACTUATORS];
    mask agrees = LANES_ALL;
    law_torque(law, s, w, command);
    for (int i = 0; i < SCENE_ACTUATORS; i++)
        agrees &= corner[i] == 0
                      ? mask_less_equal(lanes_abs(command[i]), (1 + 1e-12) * law->limit[i])
                      : mask_less_equal((1 - 1e-12) * law->limit[i],
                                        corner[i] > 0 ? command[i] : -command[i]);
    return agrees;
}

/* Lanes inside the ellipsoid. */
static inline mask law_near(const struct law *law, const lanes *posture, const lanes *rate)
{
    lanes sum = lanes_of(0);
    for (int j = 0; j < SCENE_POSTURE; j++) {
        const lanes angle = law->inverse_axis[j] * (posture[j] - law->near.target[j]);
        const lanes turn = law->inverse_axis[SCENE_POSTURE + j] * rate[j];
        sum += angle * angle + turn * turn;
    }
    return mask_less_equal(sum, lanes_of(1));
}

#ifdef SCENE_SERVOS
/* Where the phase is, held to 0 ... 1, and how far beyond; its rate, and of that what is the
 * clock's; its acceleration by the clock. */
struct law_phase {
    lanes place, beyond, rate, drift, pull;
};
static inline struct law_phase law_phase_at(const struct law *law, lanes t, const lanes *q,
                                            const lanes *v)
{
    const lanes since = t - law->footfall;
    lanes s = lanes_of(0), drift = lanes_of(0), half = lanes_of(0);
    for (int k = STANCE_MAX_COEFFICIENTS; k-- > 0;) {
        half = lanes_fma(half, since, drift);
        drift = lanes_fma(drift, since, s);
        s = lanes_fma(s, since, law->clock[k]);
    }
    lanes rate = drift;
    s -= law->phase_from;
    for (int k = 0; k < SCENE_COORDINATES; k++) {
        s += law->phase[k] * q[k];
        rate += law->phase[k] * v[k];
    }
    const lanes place = lanes_max(lanes_min(s, lanes_of(1)), lanes_of(0));
    return (struct law_phase){place, s - place, rate, drift, 2 * half};
}

/* Output i: h(s) in place of the set-point and, of its rate, what is the clock's; row E, and the
 * acceleration that the phase makes by itself. */
static inline lanes law_output(const struct law *law, int i, const struct law_phase *at, lanes *row,
                               lanes *drift, lanes *bend)
{
    lanes h = law->along[i][STANCE_MAX_COEFFICIENTS - 1], slope = lanes_of(0), half = lanes_of(0);
    for (int k = STANCE_MAX_COEFFICIENTS - 1; k-- > 0;) {
        half = lanes_fma(half, at->place, slope);
        slope = lanes_fma(slope, at->place, h);
        h = lanes_fma(h, at->place, law->along[i][k]);
    }
    h = lanes_fma(lanes_fma(half, at->beyond, slope), at->beyond, h);
    slope = lanes_fma(2 * half, at->beyond, slope);
    for (int k = 0; k < SCENE_COORDINATES; k++)
        row[k] = lanes_fnma(slope, law->phase[k], row[k]);
    *drift = slope * at->drift;
    *bend = lanes_fma(2 * half, at->rate * at->rate, slope * at->pull);
    return h;
}

/* Errors r - q of the servos, the accelerations e that they ask for, the rows of what they control,
 * and how these accelerate besides. q, v: the scene's own coordinates and their rates. */
struct law_wish {
    lanes error[ACTUATORS], wanted[ACTUATORS], bend[ACTUATORS];
    lanes row[ACTUATORS][SCENE_COORDINATES];
};
static inline void law_servo(const struct law *law, lanes t, const lanes *q, const lanes *v,
                             const lanes *integral, struct law_wish *wish)
{
    const mask follows = mask_less(lanes_of(0), law->follows);
    struct law_phase phase;
    if (mask_any(follows))
        phase = law_phase_at(law, t, q, v);
    for (int i = 0; i < SCENE_ACTUATORS; i++) {
        const struct servo *const servo = &law->servo[i];
        lanes position = lanes_of(0), rate = lanes_of(0), row[SCENE_COORDINATES];
        lanes aim = lanes_of(0), drift = lanes_of(0), bend = lanes_of(0);
        for (int k = 0; k < SCENE_COORDINATES; k++) {
            row[k] = servo->pick[k];
            position += row[k] * q[k];
        }
        const mask moves = mask_less(t, servo->duration);
        if (mask_any(follows))
            aim = law_output(law, i, &phase, row, &drift, &bend);
        const lanes set = servo->setpoint + servo->ramp * lanes_min(t, servo->duration);
        for (int k = 0; k < SCENE_COORDINATES; k++) {
            wish->row[i][k] = row[k];
            rate += row[k] * v[k];
        }
        wish->bend[i] = bend;
        wish->error[i] = choose(follows, aim, set) - position;
        const lanes moved = choose(follows, drift, choose(moves, servo->ramp, lanes_of(0)));
        wish->wanted[i] =
            servo->kp * wish->error[i] + servo->kd * (moved - rate) + servo->ki * integral[i];
    }
}

/* Torques of outputs whose accelerations are weighted. */
static inline void law_constant(const struct law *law, const lanes *wanted, lanes *torque)
{
    for (int i = 0; i < LAW_OUTPUTS && i < SCENE_ACTUATORS; i++) {
        torque[i] = lanes_of(0);
        for (int j = 0; j < LAW_OUTPUTS; j++)
            torque[i] = lanes_fma(law->torques[i][j], wanted[j], torque[i]);
    }
}

#endif

/* Rates of the integrals: the errors; zero where nothing reads them, and where the integral would
 * leave its range or grow while a torque is at its limit. */
static inline void law_integral_rate(const struct law *law, const lanes *error,
                                     const lanes *integral, const lanes *command, lanes *rate)
{
    mask clipped = MASK_NONE;
    for (int i = 0; i < SCENE_ACTUATORS; i++)
        clipped |= mask_less(law->limit[i], lanes_abs(command[i]));
    for (int i = 0; i < SCENE_ACTUATORS; i++) {
        const mask grows = mask_less_equal(lanes_of(0), error[i] * integral[i]);
        const mask full = mask_less_equal(law->servo[i].integral_limit, lanes_abs(integral[i]));
        const mask unread = mask_less_equal(lanes_abs(law->servo[i].ki), lanes_of(0));
        rate[i] = choose(unread | (grows & (clipped | full)), lanes_of(0), error[i]);
    }
}
/* Integrals after an interval h at these rates. */
static inline void law_integrate(const struct law *law, mask where, lanes h, const lanes *rate,
                                 lanes *integral)
{
    for (int i = 0; i < SCENE_ACTUATORS; i++) {
        const lanes limit = law->servo[i].integral_limit;
        const lanes next = lanes_max(lanes_min(integral[i] + h * rate[i], limit), -limit);
        integral[i] = choose(where, next, integral[i]);
    }
}

#endif
