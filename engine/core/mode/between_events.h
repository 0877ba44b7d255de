/* between_events.h - motion while the contact mode lasts: accelerations, contact forces, what ends
 * it.
 *
 * In a mode each contact is open, sticks, or slides forward or backward. The switched Lagrange
 * equations (the paper's (4) and (5)) are
 *
 *   A(s) w' = F(s, w, t) + H^T lambda,      gamma = H w' + H' w,
 *
 * with gamma_N = gamma_T = 0 where a contact sticks, gamma_N = 0 and lambda_T = -mu lambda_N
 * sign(u_T) where it slides, lambda = 0 where it is open. With D = H A^-1 H^T and gamma_f the
 * contact accelerations without contact forces this is D lambda + gamma_f = gamma, at most four
 * linear equations.
 *
 * Which mode follows from a state (between_mode): a contact takes part when its gap is closed and
 * its normal velocity zero; then 0 <= gamma_N _|_ lambda_N >= 0 and Coulomb's law for the
 * tangential acceleration where the slip is zero, for the slip's own sign where it is not: the
 * problem of contact.h, on accelerations. For sliding contacts it may have no solution or several
 * (Painleve).
 *
 * With enough friction a foot at rest may have three answers: it stays and is pressed into the
 * ground, it leaves, it slides. Contacts that stood go on standing as long as they can (direct.h);
 * where a mode begins anew the choice is contact.h's, the same as that of an implicit step, however
 * short, and it is reported.
 *
 * A mode ends (between_violated) when an open contact's gap, a normal force, the room inside the
 * friction cone or a slip changes its sign.
 */
#ifndef STANCE_CORE_MODE_BETWEEN_EVENTS_H
#define STANCE_CORE_MODE_BETWEEN_EVENTS_H

#include "decoupling.h"

#define BETWEEN_REST 1e-10 /* m/s: contact velocities below it are zero */
#define BETWEEN_START                                                                              \
    1e-12                 /* of the accelerations: a slip that accelerates by less does not begin */
#define BETWEEN_GAP 1e-12 /* m: penetration that does not count */
#define BETWEEN_TURN 1e-4 /* rad: sines are turned by less, by series */

/* What drives the robot in a step: torques that are held or, `coupled`, a law that acts all the
 * time, and in which mode; NULL: as it follows from the state. */
struct drive {
    const lanes *torque;
    bool coupled;
    const struct contact_state *mode;
};

/* Everything that does not depend on the mode but for what a law makes of it; contact terms of the
 * contacts in `touching`. */
static inline void between_evaluate(const struct setting *set, lanes t, const lanes *s,
                                    const lanes *w, const lanes *integral,
                                    const struct drive *drive, contact_set touching,
                                    struct dynamics *e)
{
    const mask decouples = mask_less(lanes_of(0), set->law.decouples);
    const bool servos = SCENE_ACTUATORS > 0 && drive->coupled && mask_any(decouples);
    lanes torque[ACTUATORS];
    for (int i = 0; i < SCENE_ACTUATORS; i++)
        torque[i] = drive->torque[i];
    if (drive->coupled) {
        law_torque(&set->law, s, w, torque);
        law_clip(&set->law, torque);
        for (int i = 0; i < SCENE_ACTUATORS; i++)
            torque[i] = choose(decouples, lanes_of(0), torque[i]);
    }
    scene_trigonometry(s, &e->trig);
    dynamics_evaluate(set, t, s, w, torque, touching, servos, e);
    if (!servos)
        return;
    struct contact_state now;
    if (!drive->mode)
        decoupling_contacts(set, e, &now);
    decouple(set, decouples, t, s, w, integral, touching, drive->mode ? drive->mode : &now, e);
    decoupling_apply(set, decouples, touching, e);
}

/* Force of one contact in its state that brings free[] to rest; friction 0: slides freely. `own`:
 * see contact_impulse. */
static inline void between_one(mask closed, lanes slide, const lanes own[2][2], const lanes D[2][2],
                               const lanes free[2], lanes friction, lanes r[2])
{
    lanes stick[2];
    contact_impulse(CONTACT_STICK, own, D, free, friction, stick);
    const mask slides = mask_less(lanes_of(0), lanes_abs(slide));
    const lanes edge = -(friction * slide);
    const lanes normal = -free[0] / (D[0][0] + edge * D[0][1]);
    r[0] = choose(closed, choose(slides, normal, stick[0]), lanes_of(0));
    r[1] = choose(closed, choose(slides, edge * normal, stick[1]), lanes_of(0));
}

/* Forces r of all contacts in their states that bring free[][] to rest. */
static inline void between_forces(const struct contact_state *m, const lanes D[2][2][2][2],
                                  const lanes free[2][2], lanes friction, lanes r[2][2])
{
    const mask first = m->closed[0];
    const mask both = SCENE_CONTACTS > 1 ? first & m->closed[SECOND] : MASK_NONE;
    lanes D1[2][2], free1[2], r1[2];
    for (int a = 0; a < 2; a++) {
        free1[a] = choose(first, free[0][a], free[SECOND][a]);
        for (int b = 0; b < 2; b++)
            D1[a][b] = choose(first, D[0][0][a][b], D[SECOND][SECOND][a][b]);
    }
    between_one(first | m->closed[SECOND], choose(first, m->slide[0], m->slide[SECOND]),
                (const lanes(*)[2])D1, (const lanes(*)[2])D1, free1, friction, r1);
    for (int c = 0; c < SCENE_CONTACTS; c++)
        for (int a = 0; a < 2; a++)
            r[c][a] = choose(m->closed[c], r1[a], lanes_of(0));
    if (SCENE_CONTACTS == 1 || !mask_any(both))
        return;
    /* Contact 0 is eliminated: r[0] = alone + push r[1]. */
    lanes alone[2], push[2][2], r2[2];
    between_one(both, m->slide[0], D[0][0], D[0][0], free[0], friction, alone);
    for (int b = 0; b < 2; b++) {
        const lanes coupling[2] = {D[0][1][0][b], D[0][1][1][b]};
        lanes column[2];
        between_one(both, m->slide[0], D[0][0], D[0][0], coupling, friction, column);
        push[0][b] = column[0], push[1][b] = column[1];
    }
    for (int a = 0; a < 2; a++) {
        free1[a] = free[1][a] + D[1][0][a][0] * alone[0] + D[1][0][a][1] * alone[1];
        for (int b = 0; b < 2; b++)
            D1[a][b] = D[1][1][a][b] + D[1][0][a][0] * push[0][b] + D[1][0][a][1] * push[1][b];
    }
    between_one(both, m->slide[SECOND], D[1][1], (const lanes(*)[2])D1, free1, friction, r2);
    for (int a = 0; a < 2; a++) {
        r[0][a] = choose(both, alone[a] + push[a][0] * r2[0] + push[a][1] * r2[1], r[0][a]);
        r[SECOND][a] = choose(both, r2[a], r[SECOND][a]);
    }
    /* On the edge of the cone exactly, whatever the elimination has lost by cancellation. */
    const mask slides = both & mask_less(lanes_of(0), lanes_abs(m->slide[0]));
    r[0][1] = choose(slides, -(friction * m->slide[0]) * r[0][0], r[0][1]);
}

/* Contact forces in the mode, and the accelerations with them. */
static inline void between_solve(const struct setting *set, const struct contact_state *m,
                                 struct dynamics *e)
{
    between_forces(m, (const lanes(*)[2][2][2])e->D, (const lanes(*)[2])e->free, set->friction,
                   e->force);
    for (int c = 0; c < SCENE_CONTACTS; c++)
        for (int i = 0; i < SCENE_COORDINATES; i++)
            e->acceleration[i] =
                choose(m->closed[c],
                       e->acceleration[i] + (e->response[c][0][i] * e->force[c][0] +
                                             e->response[c][1][i] * e->force[c][1]),
                       e->acceleration[i]);
}

/* Why a state has no smooth motion ahead of it. */
struct between_trouble {
    mask impact;  /* a closed contact approaches */
    mask none;    /* no forces fit the laws (Painleve) */
    mask several; /* more than one set of forces does, at a contact that slides */
    mask chosen;  /* more than one does, none slides: which is said in contact.h */
};

/* Contacts that stand, as between_mode wants to know of the step before: 1 or 0. */
static inline void between_stands(const struct contact_state *m, lanes *stands)
{
    for (int c = 0; c < SCENE_CONTACTS; c++) {
        const mask sticks = m->closed[c] & mask_less_equal(lanes_abs(m->slide[c]), lanes_of(0));
        stands[c] = choose(sticks, lanes_of(1), lanes_of(0));
    }
}

/* Lanes where a contact that should begin to slip would be pulled the other way: sticking is
 * impossible and sliding too. */
static inline mask between_jammed(const struct setting *set, const struct dynamics *e,
                                  const struct contact_state *m, const mask *starting)
{
    lanes r[2][2];
    mask jammed = MASK_NONE;
    between_forces(m, (const lanes(*)[2][2][2])e->D, (const lanes(*)[2])e->free, set->friction, r);
    for (int c = 0; c < SCENE_CONTACTS; c++) {
        lanes along = e->free[c][1];
        for (int k = 0; k < SCENE_CONTACTS; k++)
            along += e->D[c][k][1][0] * r[k][0] + e->D[c][k][1][1] * r[k][1];
        jammed |= starting[c] &
                  (mask_less(along * m->slide[c], lanes_of(0)) | mask_less(r[c][0], lanes_of(0)));
    }
    return jammed;
}

/* The mode that follows from the state that *e was evaluated at; stood[]: contacts that stood until
 * then, 1 or 0. */
static inline void between_mode(const struct setting *set, const struct dynamics *e,
                                contact_set touching, const lanes *stood, struct contact_state *m,
                                struct between_trouble *trouble)
{
    const lanes none = lanes_of(0), one = lanes_of(1);
    mask part[SCENE_CONTACTS], any = MASK_NONE, slides = MASK_NONE;
    lanes sliding[SCENE_CONTACTS];
    *trouble = (struct between_trouble){MASK_NONE, MASK_NONE, MASK_NONE, MASK_NONE};
    for (int c = 0; c < SCENE_CONTACTS; c++) {
        const mask closed =
            mask_less(none, set->may_touch[c]) & mask_less_equal(e->gap[c], lanes_of(STEP_CLOSED));
        trouble->impact |= closed & mask_less(e->u[c][0], lanes_of(-BETWEEN_REST));
        part[c] = closed & mask_less_equal(lanes_abs(e->u[c][0]), lanes_of(BETWEEN_REST));
        sliding[c] = choose(mask_less(lanes_of(BETWEEN_REST), lanes_abs(e->u[c][1])),
                            choose(mask_less(e->u[c][1], none), -one, one), none);
        any |= part[c];
        slides |= part[c] & mask_less(none, lanes_abs(sliding[c])) & mask_less(none, set->friction);
        m->closed[c] = MASK_NONE;
        m->slide[c] = sliding[c];
    }
    if (!touching)
        return;
    lanes r[2][2];
    mask starting[SCENE_CONTACTS], ambiguous, unsolved, begins = MASK_NONE;
    lanes before[SCENE_CONTACTS][2]; /* any impulse inside the cone, or none */
    for (int c = 0; c < SCENE_CONTACTS; c++) {
        const mask rests = mask_less_equal(lanes_abs(sliding[c]), none);
        before[c][0] = choose(rests, stood[c], none), before[c][1] = none;
    }
    const struct contact_rule rule = {set->friction, set->prefer, sliding,
                                      NULL,          false,       (const lanes(*)[2])before};
    solve_contacts(&rule, (const lanes(*)[2][2][2])e->D, (const lanes(*)[2])e->free, touching, part,
                   r, &ambiguous, &unsolved);
    trouble->none = any & unsolved;
    trouble->several = any & ambiguous & slides;
    trouble->chosen = any & ambiguous & LANES_NOT(slides);
    for (int c = 0; c < SCENE_CONTACTS; c++) {
        lanes along = e->free[c][1];
        for (int k = 0; k < SCENE_CONTACTS; k++)
            along += choose(part[k], e->D[c][k][1][0] * r[k][0] + e->D[c][k][1][1] * r[k][1], none);
        lanes scale = lanes_max(lanes_abs(e->free[c][0]), one);
        scale = lanes_max(lanes_abs(e->free[c][1]), scale);
        m->closed[c] = part[c] & mask_less(none, r[c][0]);
        /* contact_solve clips to the cone: on its edge the slip begins, against the force, unless
         * another contact prevents it. */
        const mask edge =
            mask_less_equal((1 - 1e-10) * (set->friction * r[c][0]), lanes_abs(r[c][1]));
        const mask starts = (edge & mask_less(BETWEEN_START * scale, lanes_abs(along))) |
                            mask_less_equal(set->friction, none);
        const lanes direction = choose(mask_less(none, r[c][1]), -one, one);
        starting[c] = m->closed[c] & starts & mask_less_equal(lanes_abs(sliding[c]), none) &
                      mask_less(none, set->friction);
        begins |= starting[c];
        m->slide[c] = choose(mask_less(none, lanes_abs(sliding[c])), sliding[c],
                             choose(starts, direction, none));
    }
    if (mask_any(begins))
        trouble->none |= between_jammed(set, e, m, starting);
}

/* Lanes where the state that *e was solved at is outside the mode. A slip may be backward by what
 * counts as zero. */
static inline mask between_violated(const struct setting *set, const struct contact_state *m,
                                    const struct dynamics *e)
{
    const lanes none = lanes_of(0);
    mask out = MASK_NONE;
    for (int c = 0; c < SCENE_CONTACTS; c++) {
        const mask closed = m->closed[c], open = LANES_NOT(closed);
        const mask sticks = mask_less_equal(lanes_abs(m->slide[c]), none);
        const lanes bound = (1 + 1e-12) * (set->friction * e->force[c][0]);
        out |= open & mask_less(none, set->may_touch[c]) &
               mask_less(e->gap[c], lanes_of(-BETWEEN_GAP));
        out |= closed & mask_less(e->force[c][0], none);
        out |= closed & sticks & mask_less(bound, lanes_abs(e->force[c][1]));
        out |= closed & mask_less(none, set->friction) &
               mask_less(e->u[c][1] * m->slide[c], lanes_of(-BETWEEN_REST));
    }
    return out;
}

/* Moves s along A^-1 H_N^T until the gaps of the contacts in `held` are zero; *e, evaluated near s,
 * follows. */
static inline void between_project_position(const struct setting *set, const mask *held, lanes *s,
                                            struct dynamics *e)
{
    const lanes none = lanes_of(0);
    lanes error[SCENE_CONTACTS], multiplier[SCENE_CONTACTS];
    lanes lift[SCENE_CONTACTS][SCENE_COORDINATES];
    const lanes *along[SCENE_CONTACTS];
    for (int c = 0; c < SCENE_CONTACTS; c++) {
        for (int i = 0; i < SCENE_COORDINATES; i++)
            lift[c][i] = choose(held[c], e->response[c][0][i], none);
        along[c] = lift[c];
    }
    for (int round = 0; round < 4; round++) {
        mask todo = MASK_NONE;
        for (int c = 0; c < SCENE_CONTACTS; c++) {
            error[c] = choose(held[c], -e->gap[c], none);
            todo |= mask_less(lanes_of(STEP_PROJECTION), lanes_abs(error[c]));
        }
        if (!mask_any(todo))
            return;
        lanes d[SCENE_COORDINATES];
        project_multipliers(set, &e->trig, (1u << SCENE_CONTACTS) - 1, along, held, error,
                            multiplier);
        for (int i = 0; i < SCENE_COORDINATES; i++) {
            lanes sum = lift[0][i] * multiplier[0];
            if (SCENE_CONTACTS > 1)
                sum += lift[SECOND][i] * multiplier[SECOND];
            d[i] = choose(todo, sum, none);
            s[i] = choose(todo, s[i] + d[i], s[i]);
        }
        trig_turn(&e->trig, todo, d);
        lanes farthest = none;
        for (int a = 0; a < SCENE_ANGLES; a++)
            farthest = lanes_max(lanes_abs(d[FIRST_ANGLE + a]), farthest);
        const mask far = todo & mask_less(lanes_of(BETWEEN_TURN), farthest);
        if (mask_any(far)) {
            scene_trig exact = e->trig;
            scene_trigonometry(s, &exact);
            choose_all(far, &exact, &e->trig, sizeof exact);
        }
        for (int c = 0; c < SCENE_CONTACTS; c++)
            e->gap[c] = choose(todo, scene_gap(&set->body, s, &e->trig, c), e->gap[c]);
    }
}

/* Puts s, w back onto what the mode holds, in the lanes of `where`: gaps of closed contacts, normal
 * velocities, slip of sticking ones; *e, evaluated near s, follows. Both move along A^-1 H^T. */
static inline void between_project(const struct setting *set, const struct contact_state *m,
                                   mask where, lanes *s, lanes *w, struct dynamics *e)
{
    mask held[SCENE_CONTACTS];
    lanes velocity[2][2], r[2][2];
    for (int c = 0; c < SCENE_CONTACTS; c++)
        held[c] = where & m->closed[c];
    between_project_position(set, held, s, e);
    for (int c = 0; c < SCENE_CONTACTS; c++) {
        scene_contact_velocity(&set->body, &e->trig, c, w, e->u[c]);
        for (int a = 0; a < 2; a++)
            velocity[c][a] = e->u[c][a];
    }
    between_forces(m, (const lanes(*)[2][2][2])e->D, (const lanes(*)[2])velocity, lanes_of(0), r);
    for (int c = 0; c < SCENE_CONTACTS; c++)
        for (int i = 0; i < SCENE_COORDINATES; i++)
            w[i] = choose(held[c],
                          w[i] + (e->response[c][0][i] * r[c][0] + e->response[c][1][i] * r[c][1]),
                          w[i]);
    for (int c = 0; c < SCENE_CONTACTS; c++)
        scene_contact_velocity(&set->body, &e->trig, c, w, e->u[c]);
}

/* The impact law at the state *now, in the lanes of `where`: closed contacts are put onto the
 * ground, and impulses by contact.h change the velocity at once. Adds what that does to *report.
 * Returns the lanes where the law has a solution. */
static inline mask between_impact(const struct setting *set, mask where, struct motion *now,
                                  struct step_report *report)
{
    const lanes none = lanes_of(0);
    struct dynamics e;
    mask part[SCENE_CONTACTS], ambiguous, unsolved;
    lanes torque[ACTUATORS], uf[2][2], r[2][2], energy = none;
    for (int i = 0; i < ACTUATORS; i++)
        torque[i] = none;
    scene_trigonometry(now->s, &e.trig);
    dynamics_evaluate(set, now->t, now->s, now->w, torque, (1u << SCENE_CONTACTS) - 1, false, &e);
    for (int c = 0; c < SCENE_CONTACTS; c++)
        part[c] = where & mask_less(none, set->may_touch[c]) &
                  mask_less_equal(e.gap[c], lanes_of(STEP_CLOSED));
    between_project_position(set, part, now->s, &e);
    mask impact = MASK_NONE; /* else only rounding is left to remove */
    lanes rebound[SCENE_CONTACTS];
    for (int c = 0; c < SCENE_CONTACTS; c++) {
        scene_contact_velocity(&set->body, &e.trig, c, now->w, e.u[c]);
        impact |= part[c] & mask_less(e.u[c][0], lanes_of(-BETWEEN_REST));
        rebound[c] = set->restitution * lanes_min(e.u[c][0], none);
        uf[c][0] = e.u[c][0] + rebound[c];
        uf[c][1] = e.u[c][1];
    }
    const struct contact_rule rule = {set->friction, set->prefer, NULL, rebound, false, NULL};
    solve_contacts(&rule, (const lanes(*)[2][2][2])e.D, (const lanes(*)[2])uf,
                   (1u << SCENE_CONTACTS) - 1, part, r, &ambiguous, &unsolved);
    for (int c = 0; c < SCENE_CONTACTS; c++)
        for (int i = 0; i < SCENE_COORDINATES; i++)
            now->w[i] =
                choose(part[c],
                       now->w[i] + (e.response[c][0][i] * r[c][0] + e.response[c][1][i] * r[c][1]),
                       now->w[i]);
    for (int c = 0; c < SCENE_CONTACTS; c++) {
        lanes after[2];
        scene_contact_velocity(&set->body, &e.trig, c, now->w, after);
        now->gap[c] = choose(where, e.gap[c], now->gap[c]);
        now->approach[c] = choose(where, after[0], now->approach[c]);
        for (int a = 0; a < 2; a++) {
            energy += choose(part[c], 0.5 * (r[c][a] * (e.u[c][a] + after[a])), none);
            report->impulse[c][a] += choose(part[c], r[c][a], none);
        }
        after[0] += rebound[c];
        struct step_report laws = *report;
        report_residuals(&laws, part[c], set->friction, r[c], after);
        choose_all(impact, &laws, report, sizeof laws);
    }
    for (int a = 0; a < SCENE_ANGLES; a++) {
        now->trig.sine[a] = choose(where, e.trig.sine[a], now->trig.sine[a]);
        now->trig.cosine[a] = choose(where, e.trig.cosine[a], now->trig.cosine[a]);
    }
    report->impact_energy =
        choose(where, lanes_max(energy, report->impact_energy), report->impact_energy);
    report->ambiguous_steps = choose(where & ambiguous, lanes_of(1), report->ambiguous_steps);
    return where & LANES_NOT(unsolved);
}

#endif
