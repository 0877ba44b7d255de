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
 *
 * None begins where a contact hops (between_hops): it leaves the ground at a speed u, accelerated
 * towards it by a, and rises by u^2 / 2a < BETWEEN_LOWEST only. Gaps are known to BETWEEN_GAP: what
 * falls back is found when it is that much too low, at a speed of sqrt(2 a BETWEEN_GAP), however
 * little it rose. An impact, without restitution too, may throw off the ground what stood there,
 * the foot beside it or the stop of a joint; that falls back, strikes and throws up the first,
 * which would end, being less each time, but for that speed. The implicit law takes both at once.
 */
#ifndef STANCE_CORE_MODE_BETWEEN_EVENTS_H
#define STANCE_CORE_MODE_BETWEEN_EVENTS_H

#include "decoupling.h"

#define BETWEEN_REST 1e-10 /* m/s: contact velocities below it are zero */
#define BETWEEN_START                                                                              \
    1e-12                 /* of the accelerations: a slip that accelerates by less does not begin */
#define BETWEEN_GAP 1e-12 /* m: penetration that does not count */
#define BETWEEN_TURN 1e-4 /* rad: sines are turned by less, by series */
#define BETWEEN_LOWEST 1e-11 /* m: what falls from less does not rebound, nor is it followed */

/* What drives the robot in a step: torques that are held or, `coupled`, a law that acts all the
 * time, and in which mode; NULL: as it follows from the state. */
struct drive {
    const lanes *torque;
    bool coupled;
    const struct contact_state *mode;
};

/* Everything that does not depend on the mode but for what a law makes of it; contact terms of the
 * contacts in `touching`. */
static inline void between_evaluate(const struct setting *set, const struct state *at,
                                    const struct drive *drive, contact_set touching,
                                    struct dynamics *e)
{
    const mask decouples = mask_less(lanes_of(0), set->law.decouples);
    const bool servos = SCENE_ACTUATORS > 0 && drive->coupled && mask_any(decouples);
    lanes torque[ACTUATORS];
    law_drive(&set->law, drive->torque, drive->coupled, at->s, at->w, torque);
    scene_trigonometry(at->s, &e->trig);
    dynamics_evaluate(set, at, torque, touching, servos, e);
    if (!servos)
        return;
    struct contact_state now;
    if (!drive->mode) /* of a slip that turns, law and mode must think the same */
        decoupling_contacts(set, e, lanes_of(BETWEEN_REST), &now);
    decouple(set, decouples, at, touching, drive->mode ? drive->mode : &now, e);
    decoupling_apply(set, decouples, touching, e);
}

/* Contacts that are in `part` in any lane, and what they need of others; few are all. */
static inline contact_set between_set(const mask *part)
{
#ifdef CONTACT_LISTS
    return contact_any(part, LANES_ALL);
#else
    (void)part;
    return CONTACT_ALL;
#endif
}

/* Lanes where accelerations in `rows` are more than rounding leaves of the free ones. */
static inline mask between_moves(contact_set set, const mask (*rows)[2], const lanes (*free)[2],
                                 const lanes (*left)[2])
{
    lanes scale = lanes_of(1), most = lanes_of(0);
    EACH_IN (c, set)
        EACH (a, 0, 2) {
            scale = choose(rows[c][a], lanes_max(lanes_abs(free[c][a]), scale), scale);
            most = choose(rows[c][a], lanes_max(lanes_abs(left[c][a]), most), most);
        }
    return mask_less(BETWEEN_START * scale, most);
}

/* Forces r of all contacts in their states that bring free[][] to rest; friction 0: what slides
 * does so freely.
 *
 * Blocks are inverted by their determinants. Where these are small - two feet at one place below
 * legs that are all but stretched - rounding leaves accelerations that are as much larger: the feet
 * drift, and what the legs then press against each other is soon more than the feet carry. There
 * what is left is brought to rest once more. */
COLD void between_forces(const struct contact_state *m, const lanes (*D)[CONTACTS][2][2],
                         const lanes (*free)[2], lanes friction, lanes (*r)[2])
{
    mask sticks[CONTACTS], rows[CONTACTS][2];
    lanes edge[CONTACTS], left[CONTACTS][2], more[CONTACTS][2];
    for (int c = 0; c < OWN_CONTACTS; c++) {
        sticks[c] = mask_less_equal(lanes_abs(m->slide[c]), lanes_of(0));
        edge[c] = -(friction * m->slide[c]);
    }
    contact_mode_rows(m->closed, sticks, rows);
    const contact_set set = between_set(m->closed);
    const mask regular = contact_rest(set, CONTACT_CAREFUL, D, free, rows, edge, r);
    if (!mask_any(LANES_NOT(regular)))
        return;
    direct_velocities(D, free, set, r, left);
    const mask again = LANES_NOT(regular) & between_moves(set, rows, free, left);
    if (!mask_any(again))
        return;
    contact_rest(set, CONTACT_CAREFUL, D, left, rows, edge, more);
    direct_add(set, again, lanes_of(1), more, r);
}

/* Adds what forces or impulses r of contacts in `part` do, by their responses, to x. */
static inline void between_push(const mask *part, const lanes (*response)[2][SCENE_COORDINATES],
                                const lanes (*r)[2], lanes *x)
{
    EACH_IN (c, between_set(part))
        for (int i = 0; i < SCENE_COORDINATES; i++) {
            lanes push = response[c][0][i] * r[c][0];
            if (contact_unknowns(c) == 2)
                push += response[c][1][i] * r[c][1];
            x[i] = choose(contact_part(c, part), x[i] + push, x[i]);
        }
}

/* Contact forces in the mode, and the accelerations with them. */
static inline void between_solve(const struct setting *set, const struct contact_state *m,
                                 struct dynamics *e)
{
    between_forces(m, e->D, e->free, set->friction, e->force);
    between_push(m->closed, e->response, e->force, e->acceleration);
}

/* Why a state has no smooth motion ahead of it. */
struct between_trouble {
    mask impact;   /* a closed contact approaches */
    mask none;     /* no forces fit the laws (Painleve) */
    mask several;  /* more than one set of forces does, at a contact that slides */
    mask chosen;   /* more than one does, none slides: which is said in lane.h */
    mask unranked; /* too many contacts to tell */
};

/* Acceleration of a contact in a state that was evaluated and solved. */
static inline void between_acceleration(const struct setting *set, const struct dynamics *e,
                                        const lanes *w, int c, lanes *a)
{
    lanes curvature[2];
    scene_contact_curvature(&set->body, &e->trig, c, w, curvature);
    scene_contact_velocity(&set->body, &e->trig, c, e->acceleration, a);
    a[0] += curvature[0], a[1] += curvature[1];
}

/* Lanes where a contact leaves the ground to fall back from less than BETWEEN_LOWEST, in a state
 * with the velocity w that was evaluated and solved in the mode m. */
static inline mask between_hops(const struct setting *set, const struct contact_state *m,
                                const struct dynamics *e, const lanes *w)
{
    mask hops = MASK_NONE;
    for (int c = 0; c < OWN_CONTACTS; c++) {
        const lanes u = e->u[c][0], room = BETWEEN_LOWEST - e->gap[c];
        const mask leaves = LANES_NOT(m->closed[c]) & mask_less(lanes_of(0), set->may_touch[c]) &
                            mask_less(lanes_of(0), room) & mask_less(lanes_of(BETWEEN_REST), u);
        if (!mask_any(leaves))
            continue;
        lanes a[2];
        between_acceleration(set, e, w, c, a);
        hops |= leaves & mask_less(u * u, -2 * a[0] * room);
    }
    return hops;
}

/* Contacts that stand, as between_mode wants to know of the step before: 1 or 0. */
static inline void between_stands(const struct contact_state *m, lanes *stands)
{
    for (int c = 0; c < OWN_CONTACTS; c++) {
        mask sticks = m->closed[c];
        if (contact_grip(c) >= 0)
            sticks &= mask_less_equal(lanes_abs(m->slide[contact_grip(c)]), lanes_of(0));
        stands[c] = lanes_where(sticks);
    }
}

/* Lanes where a contact that should begin to slip would be pulled the other way: sticking is
 * impossible and sliding too. */
static inline mask between_jammed(const struct setting *set, const struct dynamics *e,
                                  const struct contact_state *m, const mask *starting)
{
    lanes r[CONTACTS][2], u[CONTACTS][2];
    mask jammed = MASK_NONE;
    between_forces(m, e->D, e->free, set->friction, r);
    direct_velocities(e->D, e->free, CONTACT_ALL, r, u);
    for (int c = 0; c < OWN_CONTACTS; c++)
        if (contact_unknowns(c) == 2)
            jammed |= starting[c] & (mask_less(u[c][1] * m->slide[c], lanes_of(0)) |
                                     mask_less(contact_load(c, r), lanes_of(0)));
    return jammed;
}

/* The mode that follows from the state that *e was evaluated at; stood[]: contacts that stood until
 * then, 1 or 0. */
static inline void between_mode(const struct setting *set, const struct dynamics *e,
                                contact_set touching, const lanes *stood, struct contact_state *m,
                                struct between_trouble *trouble)
{
    const lanes none = lanes_of(0), one = lanes_of(1);
    mask part[CONTACTS], any = MASK_NONE, slides = MASK_NONE;
    lanes sliding[CONTACTS]; /* of each grip */
    *trouble = (struct between_trouble){MASK_NONE, MASK_NONE, MASK_NONE, MASK_NONE, MASK_NONE};
    for (int c = 0; c < OWN_CONTACTS; c++) {
        const mask closed = motion_closed(set, e->gap, c);
        trouble->impact |= closed & mask_less(e->u[c][0], lanes_of(-BETWEEN_REST));
        part[c] = closed & mask_less_equal(lanes_abs(e->u[c][0]), lanes_of(BETWEEN_REST));
        sliding[c] = none;
        if (contact_unknowns(c) == 2)
            sliding[c] = lanes_sign(e->u[c][1], lanes_of(BETWEEN_REST));
        any |= part[c];
        m->closed[c] = MASK_NONE;
        m->slide[c] = sliding[c];
    }
    if (!touching)
        return;
    lanes r[CONTACTS][2], u[CONTACTS][2];
    struct contact_verdict verdict;
    mask starting[CONTACTS], begins = MASK_NONE;
    lanes last[CONTACTS][2]; /* any impulse inside the cone, where all stood */
    mask moves = MASK_NONE;
    for (int c = 0; c < OWN_CONTACTS; c++) {
        const int g = contact_grip(c);
        mask slips = MASK_NONE;
        if (g >= 0)
            slips = part[c] & mask_less(none, lanes_abs(sliding[g]));
        slides |= slips & mask_less(none, set->friction);
        moves |= slips | (part[c] & LANES_NOT(mask_less(none, stood[c])));
    }
    for (int c = 0; c < OWN_CONTACTS; c++)
        last[c][0] = stood[c], last[c][1] = none;
    struct contact_problem problem =
        contact_pose(e->D, e->free, touching, part, set->friction, set->prefer);
    problem.sliding = sliding;
    problem.last = last, problem.known = LANES_NOT(moves);
    solve_contacts(&problem, LANES_ALL, r, &verdict);
    direct_velocities(e->D, e->free, CONTACT_ALL, r, u);
    trouble->none = any & verdict.unsolved;
    trouble->several = any & verdict.ambiguous & slides;
    trouble->chosen = any & verdict.ambiguous & LANES_NOT(slides);
    trouble->unranked = any & verdict.unranked;
    for (int c = 0; c < OWN_CONTACTS; c++)
        m->closed[c] = part[c] & mask_less(none, r[c][0]);
    for (int c = 0; c < OWN_CONTACTS; c++) {
        starting[c] = MASK_NONE;
        if (contact_unknowns(c) == 1)
            continue;
        lanes scale = lanes_max(lanes_abs(e->free[c][0]), one);
        scale = lanes_max(lanes_abs(e->free[c][1]), scale);
        const lanes load = contact_load(c, r);
        /* solve_contacts clips to the cone: on its edge the slip begins, against the force, unless
         * another contact prevents it. */
        const mask edge = mask_less_equal((1 - 1e-10) * (set->friction * load), lanes_abs(r[c][1]));
        const mask starts = (edge & mask_less(BETWEEN_START * scale, lanes_abs(u[c][1]))) |
                            mask_less_equal(set->friction, none);
        const lanes direction = choose(mask_less(none, r[c][1]), -one, one);
        starting[c] = contact_part(c, m->closed) & starts &
                      mask_less_equal(lanes_abs(sliding[c]), none) & mask_less(none, set->friction);
        begins |= starting[c];
        m->slide[c] = choose(mask_less(none, lanes_abs(sliding[c])), sliding[c],
                             choose(starts, direction, none));
    }
    if (mask_any(begins))
        trouble->none |= between_jammed(set, e, m, starting);
}

/* The same for the beginning of a step, *e evaluated there. Returns what touches anywhere. */
static inline contact_set between_begin(const struct step *step, const lanes *stood,
                                        struct dynamics *e, struct contact_state *m,
                                        struct between_trouble *trouble)
{
    const contact_set touching = step_touching(step->set, step->from->gap, LANES_ALL);
    const struct drive drive = {step->torque, step->coupled, NULL};
    const struct state at = state_of(step->from);
    between_evaluate(step->set, &at, &drive, touching, e);
    between_mode(step->set, e, touching, stood, m, trouble);
    return touching;
}

/* Lanes where the state that *e was solved at is outside the mode. A slip may be backward by what
 * counts as zero. */
static inline mask between_violated(const struct setting *set, const struct contact_state *m,
                                    const struct dynamics *e)
{
    const lanes none = lanes_of(0);
    mask out = MASK_NONE;
    for (int c = 0; c < OWN_CONTACTS; c++) {
        const mask closed = m->closed[c], open = LANES_NOT(closed);
        out |= open & mask_less(none, set->may_touch[c]) &
               mask_less(e->gap[c], lanes_of(-BETWEEN_GAP));
        out |= closed & mask_less(e->force[c][0], none);
        if (contact_unknowns(c) == 1)
            continue;
        const mask part = contact_part(c, m->closed);
        const mask sticks = mask_less_equal(lanes_abs(m->slide[c]), none);
        const lanes load = contact_load(c, e->force);
        const lanes bound = (1 + 1e-12) * (set->friction * load);
        out |= part & sticks & mask_less(bound, lanes_abs(e->force[c][1]));
        out |= part & mask_less(none, set->friction) &
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
    lanes error[CONTACTS], multiplier[CONTACTS];
    lanes lift[CONTACTS][SCENE_COORDINATES];
    const contact_set all = between_set(held);
    struct lifts along;
    for (int c = 0; c < OWN_CONTACTS; c++) {
        for (int i = 0; i < SCENE_COORDINATES; i++)
            lift[c][i] = choose(held[c], e->response[c][0][i], none);
        along.lift[c] = lift[c];
    }
    for (int round = 0; round < 4; round++) {
        mask todo = MASK_NONE;
        for (int c = 0; c < OWN_CONTACTS; c++) {
            error[c] = choose(held[c], -e->gap[c], none);
            todo |= mask_less(lanes_of(STEP_PROJECTION), lanes_abs(error[c]));
        }
        if (!mask_any(todo))
            return;
        lanes d[SCENE_COORDINATES];
        project_factor(set, &e->trig, all, held, &along);
        project_multipliers(all, &along, error, multiplier);
        for (int i = 0; i < SCENE_COORDINATES; i++) {
            lanes sum = none;
            EACH_IN (c, all)
                sum += lift[c][i] * multiplier[c];
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
        for (int c = 0; c < OWN_CONTACTS; c++)
            e->gap[c] = choose(todo, scene_gap(&set->body, s, &e->trig, c), e->gap[c]);
    }
}

/* Puts s, w back onto what the mode holds, in the lanes of `where`: gaps of closed contacts, normal
 * velocities, slip of sticking ones; *e, evaluated near s, follows. Both move along A^-1 H^T. */
static inline void between_project(const struct setting *set, const struct contact_state *m,
                                   mask where, lanes *s, lanes *w, struct dynamics *e)
{
    mask held[CONTACTS];
    lanes velocity[CONTACTS][2], r[CONTACTS][2];
    for (int c = 0; c < OWN_CONTACTS; c++)
        held[c] = where & m->closed[c];
    between_project_position(set, held, s, e);
    for (int c = 0; c < OWN_CONTACTS; c++) {
        scene_contact_velocity(&set->body, &e->trig, c, w, e->u[c]);
        for (int a = 0; a < 2; a++)
            velocity[c][a] = e->u[c][a];
    }
    between_forces(m, e->D, velocity, lanes_of(0), r);
    between_push(held, e->response, r, w);
    for (int c = 0; c < OWN_CONTACTS; c++)
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
    mask part[CONTACTS];
    struct contact_verdict verdict;
    const struct state at = state_of(now);
    struct impact_answer found;
    lanes torque[ACTUATORS] = {0}, energy = none;
    scene_trigonometry(now->s, &e.trig);
    dynamics_evaluate(set, &at, torque, CONTACT_ALL, false, &e);
    for (int c = 0; c < OWN_CONTACTS; c++)
        part[c] = where & motion_closed(set, e.gap, c);
    between_project_position(set, part, now->s, &e);
    mask impact = MASK_NONE; /* else only rounding is left to remove */
    for (int c = 0; c < OWN_CONTACTS; c++) {
        scene_contact_velocity(&set->body, &e.trig, c, now->w, e.u[c]);
        impact |= part[c] & mask_less(e.u[c][0], lanes_of(-BETWEEN_REST));
    }
    const struct impact_rule rule = {.D = e.D,
                                     .u = e.u,
                                     .part = part,
                                     .friction = set->friction,
                                     .prefer = set->prefer,
                                     .restitution = set->restitution,
                                     .moreau = impact & mask_less(none, set->moreau),
                                     .limited = impact & mask_less(none, set->limited)};
    const mask limited = impact_solve(&rule, where, &found, &verdict);
    between_push(part, e.response, found.r, now->w);
    for (int c = 0; c < OWN_CONTACTS; c++) {
        lanes after[2];
        scene_contact_velocity(&set->body, &e.trig, c, now->w, after);
        now->gap[c] = choose(where, e.gap[c], now->gap[c]);
        now->approach[c] = choose(where, after[0], now->approach[c]);
        for (int a = 0; a < contact_unknowns(c); a++) {
            energy +=
                choose(contact_part(c, part), 0.5 * (found.r[c][a] * (e.u[c][a] + after[a])), none);
            report->impulse[c][a] += choose(contact_part(c, part), found.r[c][a], none);
        }
        after[0] += found.shift[c][0];
        after[1] = choose(rule.moreau, after[1] + found.shift[c][1], after[1]);
        struct step_report laws = *report;
        report_residuals(&laws, c, part, set->friction, found.r, after);
        report_friction(&laws.impact_friction, c, part, found.r);
        choose_all(impact, &laws, report, sizeof laws);
    }
    choose_all(where, &e.trig, &now->trig, sizeof e.trig);
    report->impact_energy =
        choose(where, lanes_max(energy, report->impact_energy), report->impact_energy);
    report->limited_impacts += lanes_where(limited);
    report->ambiguous_steps =
        choose(where & verdict.ambiguous, lanes_of(1), report->ambiguous_steps);
    report->unranked_steps = choose(where & verdict.unranked, lanes_of(1), report->unranked_steps);
    return where & LANES_NOT(verdict.unsolved);
}

#endif
