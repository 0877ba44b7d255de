/* step.h - one time step of every lane: implicit in the velocity, contact exact, any theta.
 *
 * With w the velocity sought, w0 and s0 the state before, theta = METHOD_THETA, the equation is
 *
 *   P(w, r) = A(u) (w - w0) - h F(u, v) - H^T r = 0,   v = (1 - theta) w0 + theta w,
 *   u = s0 + h theta v,   end position s1 = s0 + h v,
 *
 * the paper's (8) for theta = 1. Contact impulses r obey Signorini's and Coulomb's laws with the
 * velocity H(s1) w at the end (contact.h); they are fully implicit whatever theta is, or a ball
 * would rebound at e = 0. The paper's steps (i)-(vi) run as one Newton iteration: each iterate
 * linearises P and H w exactly (H^T r and H w too, so convergence is quadratic), takes the free
 * velocity (11), builds the Delassus operator (14), solves the contact laws and updates (13).
 *
 * Which contacts take part: those closed before the step, and each whose gap at some iterate's s1
 * is not positive. The paper tests the free motion's gap instead; testing the iterate lets a foot
 * that already stands hold the robot up while the other foot is judged.
 *
 * Impulse directions are taken at u; in a step with an impact at s1 for theta < 1 too, so that an
 * impact at e = 0 cannot add energy: with the same H in P and in the laws the impulses add
 * r.U - r.G r / 2 <= 0, G = H A^-1 H^T.
 *
 * Velocity laws leave a position error of O(h |v|) at a touchdown and O(h^2) later. It is removed
 * after the step by moving s1 along A^-1 H_N^T (with the step's matrix for A) until the gaps of
 * loaded contacts are zero, or after a rebound what is left of the step at the rebound's speed, and
 * none is negative. At the place that has moved H is another one: the velocity then moves along
 * A^-1 H^T until loaded contacts have the normal velocity that the laws ask for, and those that
 * stick no other, once more exactly. (A is the step's matrix in an ordinary step, where that is
 * little; in a step with an impact it is the inertia at the end, so that no energy comes of it.)
 * The energy that both change is reported, and the residuals are those of the state at the end; of
 * a contact that has rebounded, which is off the ground then, those of the impact.
 */
#ifndef STANCE_CORE_IMPLICIT_STEP_H
#define STANCE_CORE_IMPLICIT_STEP_H

#include "project.h"

#define STEP_DECIDED 2 /* iterations in which an impact decides between several solutions */
#define STEP_NEAR 1e-3 /* m, rad: what is nearer may close in a step with an impact */
#define STEP_TOLERANCE                                                                             \
    1e-7 /* last Newton correction, m/s and rad/s; the error left is its square */
#define STEP_FROZEN_RESIDUAL                                                                       \
    1e-6 /* m/s: a step with frozen geometry that is further off is refused */
#define STEP_MOST_GAIN                                                                             \
    0.03 /* share of kinetic energies and work; a step that gains more is refused */
#define STEP_MOST_REBOUND 4   /* the same for a step with a rebound, of all kinetic energy ... */
#define STEP_MOST_MOREAU 1.25 /* ... and by Moreau's law, whose further roots are nearer */

/* Kinetic energy that the impulses of contacts in `touching` added: r.U - x^T A x / 2, x = A^-1 H^T
 * r. */
static inline lanes impact_energy(const struct setting *set, contact_set touching,
                                  const struct iterate *it)
{
    const scene_trig *const trig = METHOD_THETA == 1 ? &it->end : &it->middle;
    scene_matrix A;
    scene_inertia(&set->body, trig, &A);
    lanes x[SCENE_COORDINATES], work = lanes_of(0);
    EACH (i, 0, SCENE_COORDINATES)
        x[i] = lanes_of(0);
    EACH_IN (c, touching) {
        lanes response[2][SCENE_COORDINATES], u[2];
        const bool grips = contact_unknowns(c) == 2;
        scene_contact_response(&set->body, &A, false, &it->end, c, response);
        scene_contact_velocity(&set->body, &it->end, c, it->w, u);
        EACH (i, 0, SCENE_COORDINATES)
            x[i] += grips ? response[0][i] * it->r[c][0] + response[1][i] * it->r[c][1]
                          : response[0][i] * it->r[c][0];
        work += grips ? u[0] * it->r[c][0] + u[1] * it->r[c][1] : u[0] * it->r[c][0];
    }
    return work - scene_kinetic(&set->body, trig, x);
}

/* Lanes where those of a step with a rebound did add some: more than rounding. */
static inline mask step_gains(const struct setting *set, const struct motion *from,
                              const struct motion *to, const struct step_report *report)
{
    mask rebounds = MASK_NONE;
    EACH_CONTACT (c, 0)
        rebounds |= mask_less(lanes_of(0), set->restitution[c]);
    return rebounds &
           mask_less(IMPACT_ROUNDING * (from->kinetic + to->kinetic), report->impact_energy);
}

/* What came of a share of the restitution: see impact.h. A step that did not converge (not `good`)
 * has no mode, and gains without end: what its last iterate was may depend on other lanes. */
static inline struct impact_tried step_tried(const struct setting *set, mask good,
                                             const struct step_report *report)
{
    const lanes mode = impact_mode(set->friction, report->impulse);
    return (struct impact_tried){choose(good, report->impact_energy, lanes_of(INFINITY)),
                                 choose(good, mode, lanes_of(-1))};
}

/* Lanes where an iterate with frozen geometry obeys the contact laws. */
static inline mask step_obeys(const struct step *step, const struct iterate *it)
{
    const struct setting *const set = step->set;
    struct step_report laws;
    report_clear(&laws);
    EACH_CONTACT (c, 0) {
        lanes u[2];
        scene_contact_velocity(&set->body, &it->end, c, it->w, u);
        u[0] =
            lanes_fma(set->restitution[c], lanes_min(step->from->approach[c], lanes_of(0)), u[0]);
        u[1] = iterate_slip(it, c, u);
        report_residuals(&laws, c, it->active, set->friction, it->r, u);
    }
    return mask_less_equal(lanes_max(laws.signorini_residual, laws.dissipation_residual),
                           lanes_of(STEP_FROZEN_RESIDUAL));
}

/* Lanes where the energy gained is what discretisation may gain. The equation of a long step has
 * further roots, at which the robot has turned around several times and is much too fast: such a
 * step is as good as not converged. */
HOT mask step_balances(const struct motion *from, const struct iterate *it, lanes work)
{
    /* At rest there is rounding: a share of the potential energy, of whatever size. */
    const lanes moving = from->kinetic + it->kinetic + lanes_abs(work);
    const lanes rounding = lanes_abs(from->energy) + lanes_abs(it->energy);
    const lanes admitted = lanes_fma(lanes_of(STEP_MOST_GAIN), moving,
                                     lanes_fma(lanes_of(1e-9), rounding, lanes_of(1e-12)));
    return mask_less_equal(it->energy - from->energy - work, admitted);
}
/* The same for a step with a rebound: the place of the impact inside the step decides on its
 * energy, and Newton's restitution may add some; what multiplies the motion is another root still.
 */
HOT mask step_rebounds(const struct setting *set, const struct motion *from,
                       const struct iterate *it, lanes work)
{
    const lanes most = choose(mask_less(lanes_of(0), set->moreau), lanes_of(STEP_MOST_MOREAU),
                              lanes_of(STEP_MOST_REBOUND));
    const lanes fallen = (it->energy - it->kinetic) - (from->energy - from->kinetic);
    const lanes source = from->kinetic + lanes_abs(work) + lanes_abs(fallen);
    const lanes rounding = lanes_abs(from->energy) + lanes_abs(it->energy);
    return mask_less_equal(
        it->kinetic, lanes_fma(most, source, lanes_fma(lanes_of(1e-9), rounding, lanes_of(1e-12))));
}

/* What one contact says in a step that has arrived: velocity u, impulses of all, where they are in
 * `part`. What hardly carries has no direction, see CONTACT_TOLERANCE. */
HOT void report_contact(const struct step *step, const struct iterate *it, const mask *part,
                        lanes load, int c, const lanes u[2], struct step_report *report)
{
    const struct setting *const set = step->set;
    const lanes h = step->h, (*const r)[2] = it->r;
    const lanes none = lanes_of(0);
    const mask loaded = part[c] & mask_less(none, r[c][0]);
    const lanes relative[2] = {
        lanes_fma(set->restitution[c], lanes_min(step->from->approach[c], none), it->u[c][0]),
        iterate_slip(it, c, it->u[c])};
    lanes carried[CONTACTS][2];
    EACH_IN (k, contact_with(c) | contact_ends(c)) {
        carried[k][0] = choose(mask_less(1e-6 * load, r[k][0]), r[k][0], none);
        carried[k][1] = choose(mask_less(1e-6 * load, contact_load(k, r)), r[k][1], none);
    }
    if (!contact_is_point(c)) { /* an end of it may be left out, and with it its share */
        const lanes whole = contact_load(c, r), left = contact_load(c, carried);
        const mask less = mask_less(none, left) & mask_less(left, whole);
        carried[c][1] = choose(less, carried[c][1] * (left / whole), carried[c][1]);
    }
    report_residuals(report, c, part, set->friction, carried, relative);
    report->impulse[c][0] = choose(loaded, r[c][0], none);
    report->least[c] = choose(loaded, r[c][0] / h, none);
    report->impulse[c][1] = report->slip[c] = none;
    if (contact_unknowns(c) == 1)
        return;
    const mask grips = contact_part(c, part) & mask_less(none, contact_load(c, r));
    report->impulse[c][1] = choose(grips, r[c][1], none);
    report->slip[c] = choose(grips, h * lanes_abs(u[1]), none);
    report_friction(&report->friction_used, c, part, r);
}

/* Lanes where a contact carries that did not stand on the ground before. */
HOT mask step_lands(const struct motion *from, contact_set touching, const struct iterate *it)
{
    mask lands = MASK_NONE;
    EACH_IN (c, touching)
        lands |= it->active[c] & mask_less(lanes_of(0), it->r[c][0]) &
                 (mask_less(lanes_of(STEP_CLOSED), from->gap[c]) |
                  mask_less(from->approach[c], lanes_of(-STEP_APPROACH)));
    return lands;
}

/* What an iterate that has arrived leaves: position errors removed, the balance of energy, the
 * report. `touching`: contacts that are active anywhere; `kind`: with STEP_ANY not all were closed
 * before, those in it->impact are. Returns the lanes of `converged` whose step is admitted. */
HOT mask step_finish(const struct step *step, contact_set touching, enum step_kind kind,
                     mask converged, struct iterate *it, struct step_report *report)
{
    const struct setting *const set = step->set;
    const struct motion *const from = step->from;
    const lanes none = lanes_of(0), h = step->h;
    const bool impacts = kind == STEP_ANY;
    const mask impact = it->impact;
    mask somewhere = MASK_NONE;
    lanes moved[SCENE_COORDINATES], rate[SCENE_COORDINATES], load = none;
    EACH (i, 0, SCENE_COORDINATES) {
        moved[i] = (SCENE_PUSHES > 0 ? 0.5 : 1) * (it->s1[i] - from->s[i]);
        rate[i] = lanes_fma(lanes_of(METHOD_THETA), it->w[i] - from->w[i], from->w[i]);
    }
    const lanes middle = from->t + METHOD_THETA * h;
    report->work = scene_work(&set->body, h, middle, &it->end, it->torque, moved);
    if (SCENE_PUSHES > 0) /* whose ways bend: half of it at either end */
        report->work += scene_work(&set->body, h, middle, &from->trig, it->torque, moved);
    const lanes damped = (SCENE_PUSHES > 0 ? 2 : 1) * scene_damped(&set->body, rate, moved);
    report_clear_answers(report);
    report->failure = none;
    EACH (i, 0, SCENE_ACTUATORS)
        report->torque[i] = it->torque[i];
    report_torques(report, it->torque);
    EACH_IN (c, touching)
        load += lanes_max(it->r[c][0], none);
    EACH_IN (c, touching)
        somewhere |= it->active[c] & converged;
    if (impacts && mask_any(somewhere & impact)) {
        report->impact_energy = choose(somewhere & impact, impact_energy(set, touching, it), none);
        mask struck[CONTACTS];
        EACH_CONTACT (c, 0)
            struck[c] = it->active[c] & converged & impact;
        EACH_IN (c, touching)
            report_friction(&report->impact_friction, c, struck, it->r);
    }
    if (impacts && step->freeze_after < STEP_MAX_ITERATIONS)
        converged &= step_obeys(step, it);
    lanes u[CONTACTS][2];
    mask part[CONTACTS], lands = MASK_NONE, rebounds = MASK_NONE;
    if (impacts)
        lands = step_lands(from, touching, it);
    EACH_IN (c, touching)
        if (impacts)
            scene_contact_velocity(&set->body, &it->end, c, it->w, it->u[c]);
    if (touching) {
        lanes *const energy = &report->projection_energy;
        const mask right =
            impacts ? project_far(step, touching, lands, somewhere, it, u, energy)
                    : project_near(step, touching, kind == STEP_FULL, somewhere, it, u, energy);
        converged &= right | LANES_NOT(somewhere);
        /* The velocities that the laws are held to: those of contacts that have left the ground in
         * a rebound are of the impact, before positions were mended. */
        EACH_IN (c, touching) {
            const mask off = mask_less(lanes_of(STEP_CLOSED), it->gap[c]);
            EACH (a, 0, 2)
                it->u[c][a] = impacts ? choose(off, it->u[c][a], u[c][a]) : u[c][a];
        }
    }
    EACH_CONTACT (c, 0) {
        /* One that has left the ground may move back towards it. */
        part[c] =
            it->active[c] & converged &
            (mask_less(none, it->r[c][0]) | mask_less_equal(it->gap[c], lanes_of(STEP_CLOSED)));
        rebounds |= mask_less(none, set->restitution[c]);
    }
    EACH_CONTACT (c, 0) {
        report->slip[c] = report->impulse[c][0] = report->impulse[c][1] = none;
        report->least[c] = none;
        if (!(touching >> c & 1))
            scene_contact_velocity(&set->body, &it->end, c, it->w, u[c]);
        it->approach[c] = u[c][0];
    }
    EACH_IN (c, touching)
        report_contact(step, it, part, load, c, u[c], report);
    it->kinetic = scene_kinetic(&set->body, &it->end, it->w);
    it->energy = it->kinetic + scene_potential(&set->body, it->s1, &it->end);
    rebounds &= somewhere;
    converged &= (rebounds & step_rebounds(set, from, it, report->work)) |
                 (LANES_NOT(rebounds) & step_balances(from, it, report->work));
    report->work -= damped; /* not above: a step is not admitted the less for it */
    report->ambiguous_steps = lanes_where(it->verdict.ambiguous & converged);
    report->unranked_steps = lanes_where(it->verdict.unranked & converged);
    report->landed = lanes_where(lands);
    return converged;
}

/* Hands the iterate's end over, in the lanes of `done`, or in all. */
HOT void step_commit(lanes t, const struct iterate *it, bool all, mask done, mask landed,
                     struct motion *to)
{
    EACH (i, 0, SCENE_COORDINATES) {
        to->s[i] = choose_unless(all, done, it->s1[i], to->s[i]);
        to->w[i] = choose_unless(all, done, it->w[i], to->w[i]);
    }
    EACH_CONTACT (c, 0) {
        to->gap[c] = choose_unless(all, done, it->gap[c], to->gap[c]);
        to->approach[c] = choose_unless(all, done, it->approach[c], to->approach[c]);
        EACH (a, 0, 2)
            to->impulse[c][a] = choose_unless(all, done, choose(landed, lanes_of(0), it->r[c][a]),
                                              to->impulse[c][a]);
    }
    EACH (a, 0, SCENE_ANGLES) {
        to->trig.sine[a] = choose_unless(all, done, it->end.sine[a], to->trig.sine[a]);
        to->trig.cosine[a] = choose_unless(all, done, it->end.cosine[a], to->trig.cosine[a]);
    }
    to->t = choose_unless(all, done, t, to->t);
    to->energy = choose_unless(all, done, it->energy, to->energy);
    to->kinetic = choose_unless(all, done, it->kinetic, to->kinetic);
}

/* What Moreau's restitution adds to the tangential velocities of an impact (zero elsewhere); false:
 * it is nobody's in the lanes m. */
static inline bool step_moreau(const struct setting *set, const struct motion *from, mask m,
                               lanes *tangential)
{
    const mask moreau = m & mask_less(lanes_of(0), set->moreau);
    if (!mask_any(moreau))
        return false;
    for (int c = 0; c < OWN_CONTACTS; c++) {
        lanes u[2];
        scene_contact_velocity(&set->body, &from->trig, c, from->w, u);
        tangential[c] = lanes_of(0);
        if (contact_unknowns(c) == 2)
            tangential[c] = choose(moreau, set->restitution[c] * u[1], lanes_of(0));
    }
    return true;
}

/* Takes one step in the lanes of `run`; *to and *report are written there only where it converged.
 * `near`: contacts that may take part; *missed: others that did come to the ground, and nothing is
 * written. brought: contacts that take part from the first iterate on though they were open; those
 * that turn out to be such are added. Returns the lanes that converged. */
COLD mask step_within(const struct step *step, contact_set near, contact_set *missed, mask run,
                      mask *brought, struct motion *to, struct step_report *report)
{
    const struct setting *const set = step->set;
    const struct motion *const from = step->from;
    struct iterate it;
    mask running = run;
    mask closed[CONTACTS];
    lanes tangential[CONTACTS], along[CONTACTS];
    const bool moreau = step_moreau(set, from, run, tangential);
    it.along = moreau ? along : NULL;
    EACH (i, 0, SCENE_COORDINATES)
        it.w[i] = from->w[i];
    EACH (i, 0, SCENE_ACTUATORS)
        it.torque[i] = step->torque[i];
    it.impact = MASK_NONE;
    it.missed = 0;
    EACH_CONTACT (c, 0) {
        closed[c] = motion_closed(set, from->gap, c);
        it.active[c] = closed[c] | brought[c];
        it.brought[c] = MASK_NONE;
        it.impact |= closed[c] & mask_less(from->approach[c], lanes_of(-STEP_APPROACH));
        it.impact |= brought[c];
        EACH (a, 0, 2)
            EACH (i, 0, SCENE_COORDINATES)
                it.response[c][a][i] = lanes_of(0);
    }
    EACH_CONTACT (c, 0)
        EACH (a, 0, 2)
            it.r[c][a] =
                choose(it.active[c] & LANES_NOT(it.impact), from->impulse[c][a], lanes_of(0));
    it.verdict = (struct contact_verdict){MASK_NONE, MASK_NONE, MASK_NONE};
    iterate_place(step, false, &it);
    it.iterations = lanes_of(0);
    for (int k = 0; k < STEP_MAX_ITERATIONS && mask_any(running); k++) {
        it.decides = k < STEP_DECIDED ? it.impact : MASK_NONE;
        const contact_set touching = contact_any(it.active, running);
        /* Responses of all that are near or none: position errors may have to be removed. */
        for (int c = 0; c < OWN_CONTACTS && moreau; c++)
            along[c] = choose(it.impact, tangential[c], lanes_of(0));
        const struct iteration of = {.running = running,
                                     .impacts = true,
                                     .frozen = k > step->freeze_after,
                                     .touching = touching,
                                     .near = touching ? near : 0};
        iterate_newton(step, &of, &it);
        it.iterations += lanes_where(running);
        iterate_place(step, k >= step->freeze_after, &it);
        mask news = MASK_NONE;
        *missed = project_missed(set, near, running, &it);
        if (*missed)
            return MASK_NONE;
        EACH_CONTACT (c, 0) {
            const mask hit = running & LANES_NOT(it.active[c]) & motion_closed(set, it.gap, c);
            it.active[c] |= hit;
            news |= hit;
        }
        it.impact |= news;
        const mask done = mask_less_equal(it.size, STEP_TOLERANCE * iterate_speed(&it)) &
                          LANES_NOT(news) & LANES_NOT(it.verdict.unsolved);
        running &= LANES_NOT(done);
    }
    mask converged = run & LANES_NOT(running);
    if (step->corner) {
        lanes u[SCENE_COORDINATES], v[SCENE_COORDINATES];
        iterate_middle(step, &it, u, v);
        converged &= law_agrees(&set->law, u, v, step->corner);
    }
    if (step->freeze_after < STEP_MAX_ITERATIONS)
        iterate_place(step, false, &it);
    if (METHOD_THETA != 1)
        scene_trigonometry(it.s1, &it.end);
    converged = step_finish(step, near, STEP_ANY, converged, &it, report);
    *missed = it.missed;
    if (*missed)
        return MASK_NONE;
    report->iterations = report->evaluations = it.iterations;
    step_commit(from->t + step->h, &it, false, converged, mask_less(lanes_of(0), report->landed),
                to);
    EACH_CONTACT (c, 0)
        brought[c] |= converged & it.brought[c];
    return converged;
}

/* step_within the contacts that are or may come near, and those that it turns out to miss: what it
 * finds in a lane does not depend on others. Repeated where mending the position brings contacts to
 * the ground that no iterate saw there: to stop them is an impact, not mending, so the step is
 * taken again with them. */
COLD mask step_solve(const struct step *step, mask run, struct motion *to,
                     struct step_report *report)
{
    const struct motion *const from = step->from;
    mask todo = run, good = MASK_NONE, brought[CONTACTS], known[CONTACTS];
    lanes cost = lanes_of(0);
    report_clear(report); /* in lanes that do not run nothing was done */
    EACH_CONTACT (c, 0)
        brought[c] = MASK_NONE;
    for (int round = 0; round <= OWN_CONTACTS && mask_any(todo); round++) {
        struct step_report part;
        contact_set near = 0, missed = 0;
        mask there;
        memcpy(known, brought, sizeof known);
        EACH_CONTACT (c, 0) {
            const lanes way = (2 * step->h) * lanes_min(from->approach[c], lanes_of(0));
            if (mask_any(todo & mask_less(lanes_of(0), step->set->may_touch[c]) &
                         (brought[c] | mask_less(from->gap[c] + way, lanes_of(STEP_NEAR)))))
                near |= contact_with(c);
        }
        do {
            near |= missed;
            there = step_within(step, near, &missed, todo, brought, to, &part);
        } while (missed);
        cost += choose(todo, part.iterations, lanes_of(0));
        choose_all(round == 0 ? todo : there, &part, report, sizeof part);
        good |= there;
        todo = MASK_NONE;
        EACH_CONTACT (c, 0)
            todo |= there & brought[c] & LANES_NOT(known[c]);
    }
    report->iterations = report->evaluations = choose(run, cost, report->iterations);
    return good;
}

/* The same in the lanes of `gains`, whose impact would add energy, with the largest share of the
 * restitution by which it does not. */
COLD mask step_limit(const struct step *step, mask gains, struct motion *to,
                     struct step_report *report)
{
    const struct setting *const set = step->set;
    struct impact_tried said = step_tried(set, gains, report);
    struct impact_share share = impact_share_begin(said);
    struct setting law = *set;
    struct step limited = *step;
    lanes cost = report->iterations;
    limited.set = &law;
    for (mask open; mask_any(open = impact_share_open(&share, gains));) {
        const lanes tried = impact_share_next(&share);
        struct motion next = *step->from;
        struct step_report part;
        EACH_CONTACT (c, 0)
            law.restitution[c] = tried * set->restitution[c];
        const mask good = step_solve(&limited, open, &next, &part);
        const mask more = LANES_NOT(good) | (step_gains(set, step->from, &next, &part) &
                                             mask_less(lanes_of(0), tried));
        said = step_tried(set, good, &part);
        const mask fits = impact_share_tell(&share, open, more, &said);
        cost += choose(open, part.iterations, lanes_of(0));
        choose_all(fits, &next, to, sizeof next);
        choose_all(fits, &part, report, sizeof part);
    }
    report->iterations = choose(gains, cost, report->iterations);
    report->evaluations = choose(gains, cost, report->evaluations);
    report->limited_impacts =
        choose(gains & impact_share_counts(&share), lanes_of(1), report->limited_impacts);
    return gains & share.found;
}

/* One step: step_solve, with restitution that creates no energy. */
static inline mask take_step(const struct step *step, mask run, struct motion *to,
                             struct step_report *report)
{
    struct motion next = *to;
    const mask good = step_solve(step, run, &next, report);
    const mask gains = good & mask_less(lanes_of(0), step->set->limited) &
                       step_gains(step->set, step->from, &next, report);
    choose_all(good & LANES_NOT(gains), &next, to, sizeof next);
    if (!mask_any(gains))
        return good;
    return (good & LANES_NOT(gains)) | step_limit(step, gains, to, report);
}

#endif
