/* dynamics.h - what holds in a state whatever the contact mode: accelerations without contact
 * forces, and how the contacts respond to them.
 *
 *   A(s) w' = F(s, w, t) + B torque + H^T lambda,      gamma = H w' + H' w,
 *
 * With D = H A^-1 H^T and gamma_f the contact accelerations without contact forces the contact laws
 * see D lambda + gamma_f = gamma.
 */
#ifndef STANCE_CORE_MODE_DYNAMICS_H
#define STANCE_CORE_MODE_DYNAMICS_H

#include "engine/core/implicit/step.h"

/* What each contact does. */
struct contact_state {
    mask closed[CONTACTS];
    lanes slide[CONTACTS]; /* sign of the slip of each grip; 0: sticks, or no grip */
};

/* The equations at one state. */
struct dynamics {
    scene_trig trig;
    lanes gap[CONTACTS], u[CONTACTS][2];
    lanes torque[ACTUATORS];
    lanes acceleration[SCENE_COORDINATES]; /* without contact forces, until between_solve */
    lanes response[CONTACTS][2][SCENE_COORDINATES]; /* A^-1 H^T */
    lanes D[CONTACTS][CONTACTS][2][2], free[CONTACTS][2];
    lanes force[CONTACTS][2];                 /* N */
    lanes push[ACTUATORS][SCENE_COORDINATES]; /* A^-1 B, where a law acts that needs it */
    lanes command[ACTUATORS];                 /* N m, of that law, before the limit ... */
    lanes integral_rate[ACTUATORS];           /* ... and how fast it sums errors */
    lanes degraded, several; /* 1: not quite what it promises, not unique: see decoupling.h */
};

/* Contact terms of the contacts that are not in `touching` become zero. */
static inline void dynamics_clear(contact_set touching, struct dynamics *e)
{
    for (int c = 0; c < OWN_CONTACTS; c++)
        for (int a = 0; a < 2; a++) {
            for (int k = 0; k < OWN_CONTACTS; k++)
                for (int b = 0; b < 2; b++)
                    if (!(touching >> c & touching >> k & 1) || b >= contact_unknowns(k))
                        e->D[c][k][a][b] = lanes_of(0);
            if (touching >> c & 1)
                continue;
            e->free[c][a] = lanes_of(0);
            for (int i = 0; i < SCENE_COORDINATES; i++)
                e->response[c][a][i] = lanes_of(0);
        }
}

/* What follows from e->trig alone: the inertia, factored, and how the contacts in `touching` and,
 * `pushes`, the actuators act on it. */
HOT void dynamics_place(const struct setting *set, contact_set touching, bool pushes,
                        scene_matrix *A, struct dynamics *e)
{
    scene_inertia(&set->body, &e->trig, A);
#ifdef SCENE_SERVOS
    for (int i = 0; i < OWN_ACTUATORS && pushes; i++)
        scene_actuator_response(A, i, e->push[i]);
#else
    (void)pushes;
#endif
    EACH_IN (c, touching)
        scene_contact_response(&set->body, A, false, &e->trig, c, e->response[c]);
    motion_operator(&set->body, &e->trig, touching, e->response, e->D);
}

/* What follows from velocities and torques there; contact terms but u of the contacts in `touching`
 * only. */
HOT void dynamics_motion(const struct setting *set, const struct state *at, const lanes *torque,
                         contact_set touching, const scene_matrix *A, struct dynamics *e)
{
    lanes load[SCENE_COORDINATES];
    EACH (i, 0, SCENE_ACTUATORS)
        e->torque[i] = torque[i];
    const scene_guess here = {.t = at->t, .s = at->s, .trig = &e->trig, .w = at->w};
    scene_residual(&set->body, &here, e->torque, load);
    scene_solve(A, false, load, e->acceleration);
    EACH_CONTACT (c, 0) {
        lanes curvature[2], forced[2];
        scene_contact_velocity(&set->body, &e->trig, c, at->w, e->u[c]);
        if (!(touching >> c & 1))
            continue;
        scene_contact_curvature(&set->body, &e->trig, c, at->w, curvature);
        scene_contact_velocity(&set->body, &e->trig, c, e->acceleration, forced);
        EACH (a, 0, 2)
            e->free[c][a] = forced[a] + curvature[a];
    }
}

/* Evaluates what a state leads to, with e->trig at its place. Contact terms of the contacts in
 * `touching`, zero of the others, so that sums may run over all; `pushes`: responses to the
 * actuators too. */
static inline void dynamics_evaluate(const struct setting *set, const struct state *at,
                                     const lanes *torque, contact_set touching, bool pushes,
                                     struct dynamics *e)
{
    scene_matrix A;
    dynamics_place(set, touching, pushes, &A, e);
    dynamics_motion(set, at, torque, touching, &A, e);
    dynamics_clear(touching, e);
    for (int i = 0; i < SCENE_ACTUATORS; i++)
        e->integral_rate[i] = lanes_of(0);
    e->degraded = e->several = lanes_of(0);
    for (int c = 0; c < OWN_CONTACTS; c++) {
        e->gap[c] = scene_gap(&set->body, at->s, &e->trig, c);
        e->force[c][0] = e->force[c][1] = lanes_of(0);
    }
}

#endif
