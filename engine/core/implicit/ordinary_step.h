/* ordinary_step.h - the ordinary step: what touches goes on touching, nothing arrives, nothing
 * bounces.
 *
 * The equation is step.h's; ordinary steps, all but a few in a thousand, reach its solution with
 * less work:
 *
 * - Newton begins at the velocity that the last two changes of velocity point to,
 *   w0 + 2 dw_n-1 - dw_n-2, which is off by the third derivative of motion.
 * - It ends as soon as the error left is certainly small. After a correction d that is at most
 *   K h |d|^2 with the scene's bound K on the equation's curvature (scene_curvature), so one
 *   iteration is enough where |d|^2 <= ORDINARY_ERROR / (K h), relative to the speed: about 1e-5.
 * - Sines and cosines at the end are those of the beginning turned by h w, an angle of
 *   TRIG_TURNED at most, by series; every TRIG_TURNS steps they are computed anew, so that
 *   rounding does not add up.
 * - A linear law that acts inside the step is part of the equation, and bends it at the torque
 *   limits alone: an iteration counts where each torque stays at its limit, or at none.
 * - Contacts are those of the bundle: `touching` is known to the compiler.
 * - Position errors are mended along the directions of the last iteration: they may be off by
 *   1e-4 of what is mended, a billionth of the speed at 5 ms.
 *
 * A lane in which anything is not ordinary - an impact, a touchdown, a contact problem with several
 * solutions, a long way to converge, energy from nowhere - is left to step.h, whatever its
 * neighbours do: which lanes share a bundle changes no bit.
 */
#ifndef STANCE_CORE_IMPLICIT_ORDINARY_STEP_H
#define STANCE_CORE_IMPLICIT_ORDINARY_STEP_H

#include "step.h"

#define ORDINARY_ITERATIONS 4
#define ORDINARY_ERROR 1e-11 /* of the velocity, left by Newton */
#define ORDINARY_SMALL 1e-6  /* rad: a last correction that turns further is not ordinary */

/* What is remembered of the steps before. */
struct ordinary {
    lanes change[SCENE_COORDINATES]; /* of the velocity in the last step ... */
    lanes before[SCENE_COORDINATES]; /* ... and in the one before */
    lanes known;                     /* 1: the step before was ordinary, too */
    lanes turns;                     /* steps since the sines were computed anew */
};

/* Forgets the lanes in m. */
static inline void ordinary_forget(struct ordinary *q, mask m)
{
    const lanes none = lanes_of(0);
    EACH (i, 0, SCENE_COORDINATES) {
        q->change[i] = choose(m, none, q->change[i]);
        q->before[i] = choose(m, none, q->before[i]);
    }
    q->known = choose(m, none, q->known);
    q->turns = choose(m, lanes_of(TRIG_TURNS), q->turns);
}

/* Takes sines and cosines over where m holds, or everywhere. */
HOT void ordinary_take(bool all, mask m, const scene_trig *from, scene_trig *to)
{
    EACH (a, 0, SCENE_ANGLES) {
        to->sine[a] = choose_unless(all, m, from->sine[a], to->sine[a]);
        to->cosine[a] = choose_unless(all, m, from->cosine[a], to->cosine[a]);
    }
}

/* Places the iterate in the lanes of m - `all`: whatever becomes of the others -, its end position
 * and the sines there (and halfway). */
HOT void ordinary_place(const struct ordinary *q, const struct step *step, bool all, mask m,
                        struct iterate *it)
{
    const struct motion *const from = step->from;
    const lanes h = step->h;
    lanes d[SLOTS(SCENE_ANGLES)], halfway[SCENE_COORDINATES], farthest = lanes_of(0);
    EACH (i, 0, SCENE_COORDINATES) {
        const lanes move = h * step_velocity(from->w[i], it->w[i]);
        it->s1[i] = choose_unless(all, m, from->s[i] + move, it->s1[i]);
        halfway[i] = from->s[i] + METHOD_THETA * move;
        if (i >= FIRST_ANGLE) {
            d[i - FIRST_ANGLE] = METHOD_THETA * move;
            if (!SCENE_SLIDES(i - FIRST_ANGLE))
                farthest = lanes_max(lanes_abs(move), farthest);
        }
    }
    if (SCENE_ANGLES == 0) {
        it->end = it->middle = from->trig;
        return;
    }
    scene_trig end, middle;
    trig_turned(&from->trig, d, &middle);
    if (METHOD_THETA != 1)
        trig_turned(&middle, d, &end);
    const mask anew = LANES_NOT(mask_less_equal(farthest, lanes_of(TRIG_TURNED))) |
                      mask_less_equal(lanes_of(TRIG_TURNS), q->turns);
    if (mask_any(m & anew)) {
        scene_trig exact;
        scene_trigonometry(halfway, &exact);
        ordinary_take(false, anew, &exact, &middle);
        if (METHOD_THETA != 1) {
            scene_trigonometry(it->s1, &exact);
            ordinary_take(false, anew, &exact, &end);
        }
    }
    ordinary_take(all, m, METHOD_THETA == 1 ? &middle : &end, &it->end);
    if (METHOD_THETA != 1)
        ordinary_take(all, m, &middle, &it->middle);
}

/* Moves the end by the last correction, from it->before to it->w: the sines follow to third order.
 * Returns the lanes where that is enough. */
HOT mask ordinary_arrive(const struct motion *from, lanes h, struct iterate *it)
{
    lanes d[SCENE_COORDINATES], farthest = lanes_of(0);
    EACH (i, 0, SCENE_COORDINATES) {
        d[i] = (h * METHOD_THETA) * (it->w[i] - it->before[i]);
        it->s1[i] = lanes_fma(h, step_velocity(from->w[i], it->w[i]), from->s[i]);
        if (i >= FIRST_ANGLE && !SCENE_SLIDES(i - FIRST_ANGLE))
            farthest = lanes_max(lanes_abs(d[i]), farthest);
    }
    trig_turn(&it->end, LANES_ALL, d);
    return mask_less_equal(farthest, lanes_of(ORDINARY_SMALL));
}

/* A law that acts inside the step: its torques at the iterate, in the lanes of m. Returns the lanes
 * where those that the last iteration was taken with are at the same limits, or at none: elsewhere
 * it says nothing of the error left. */
COLD mask ordinary_law(const struct step *step, mask m, struct iterate *it)
{
    const struct law *const law = &step->set->law;
    lanes u[SCENE_COORDINATES], v[SCENE_COORDINATES], torque[ACTUATORS];
    mask same = LANES_ALL;
    iterate_middle(step, it, u, v);
    law_torque(law, u, v, torque);
    law_clip(law, torque);
    EACH (i, 0, SCENE_ACTUATORS) {
        const lanes limit = law->limit[i], before = it->torque[i], now = torque[i];
        const mask high = mask_less_equal(limit, before), low = mask_less_equal(before, -limit);
        const mask free = LANES_NOT(high | low);
        same &= (high & mask_less_equal(limit, now)) | (low & mask_less_equal(now, -limit)) |
                (free & mask_less(lanes_abs(now), limit));
        it->torque[i] = choose(m, now, before);
    }
    return same;
}

/* One iteration in the lanes of m; `all`: whatever becomes of the others. Returns the lanes where
 * the error left is certainly small. */
HOT mask ordinary_iterate(const struct ordinary *q, const struct step *step, bool all, mask m,
                          contact_set touching, struct iterate *it)
{
    const struct iteration of = {.all = all, .running = m, .touching = touching, .near = touching};
    ordinary_place(q, step, all, m, it);
    EACH (i, 0, SCENE_COORDINATES)
        it->before[i] = choose_unless(all, m, it->w[i], it->before[i]);
    iterate_newton(step, &of, it);
    const lanes curved = step->h * scene_curvature(&step->set->body);
    const lanes left = (curved * it->size) * (it->size + it->shift);
    mask small = mask_less_equal(left, lanes_of(ORDINARY_ERROR));
    if (mask_any(m & LANES_NOT(small)))
        small |= mask_less_equal(left, ORDINARY_ERROR * iterate_speed(it));
    if (step->coupled)
        small &= ordinary_law(step, m, it);
    return small;
}

/* Further iterations, where one was not enough; returns the lanes where they got there. */
COLD mask ordinary_more(const struct ordinary *q, const struct step *step, int first, mask running,
                        contact_set touching, struct iterate *it)
{
    mask there = MASK_NONE;
    for (int k = first; k < ORDINARY_ITERATIONS && mask_any(running); k++) {
        if (k > 0)
            it->iterations += lanes_where(running);
        const mask small = ordinary_iterate(q, step, false, running, touching, it);
        there |= running & small;
        running &= LANES_NOT(small);
    }
    return there;
}

/* Newton's iteration to its end, from the extrapolated velocity. Returns the lanes where it got
 * there. */
HOT mask ordinary_newton(const struct ordinary *q, const struct step *step, mask run,
                         contact_set touching, bool full, struct iterate *it)
{
    EACH (i, 0, SCENE_COORDINATES)
        it->w[i] = step->from->w[i] + lanes_fms(lanes_of(2), q->change[i], q->before[i]);
    it->iterations = lanes_of(1);
    mask there = MASK_NONE;
    if (full)
        there = run & ordinary_iterate(q, step, true, run, touching, it);
    const mask running = run & LANES_NOT(there);
    if (mask_any(running)) {
#ifdef CONTACT_LISTS
        there |= ordinary_more(q, step, full, running, touching, it);
#else /* with copies: what is passed on by address stays in memory */
        const struct step same = {step->set, step->from,         step->torque, step->coupled,
                                  step->h,   step->freeze_after, step->corner};
        struct iterate copy = *it;
        there |= ordinary_more(q, &same, full, running, touching, &copy);
        *it = copy;
#endif
    }
    return there & ordinary_arrive(step->from, step->h, it);
}

/* Lanes where a contact that did not touch is not above the ground. */
HOT mask ordinary_arrivals(const struct setting *set, const struct iterate *it)
{
    mask there = MASK_NONE;
    EACH_CONTACT (c, 0)
        there |= mask_less(lanes_of(0), set->may_touch[c]) & LANES_NOT(it->active[c]) &
                 LANES_NOT(mask_less(lanes_of(STEP_CLOSED), it->gap[c]));
    return there;
}

/* The solution of an ordinary step's equation in the lanes of `run`, where contacts in `touching`
 * are closed in some of them or, `full`, in all. Returns the lanes where it was found. */
HOT mask ordinary_reach(const struct ordinary *q, const struct step *step, mask run,
                        contact_set touching, bool full, struct iterate *it)
{
    const struct motion *const from = step->from;
    mask good = run;
    it->along = NULL;
    it->missed = 0;
    it->impact = it->decides = MASK_NONE;
    it->verdict = (struct contact_verdict){MASK_NONE, MASK_NONE, MASK_NONE};
    EACH (i, 0, SCENE_ACTUATORS)
        it->torque[i] = step->torque[i];
    EACH_CONTACT (c, 0) {
        it->active[c] = MASK_NONE;
        it->r[c][0] = it->r[c][1] = lanes_of(0);
    }
    EACH_IN (c, touching) {
        it->active[c] = full ? LANES_ALL : motion_closed(step->set, from->gap, c);
        good &= LANES_NOT(it->active[c] & mask_less(from->approach[c], lanes_of(-STEP_APPROACH)));
        EACH (a, 0, 2)
            it->r[c][a] = choose(it->active[c], from->impulse[c][a], lanes_of(0));
    }
    good &= ordinary_newton(q, step, good, touching, full, it);
    return good & LANES_NOT(it->verdict.unsolved | it->verdict.ambiguous);
}

/* Tries one ordinary step, arguments as above. Returns the lanes where it was one. */
HOT mask ordinary_try(const struct ordinary *q, const struct step *step, mask run,
                      contact_set touching, bool full, struct iterate *it,
                      struct step_report *report)
{
    mask good = ordinary_reach(q, step, run, touching, full, it);
    EACH_CONTACT (c, 0)
        it->gap[c] = scene_gap(&step->set->body, it->s1, &it->end, c);
    good &= LANES_NOT(ordinary_arrivals(step->set, it));
    good = step_finish(step, touching, full ? STEP_FULL : STEP_ORDINARY, good, it, report);
    /* Removing position errors may bring some. */
    good &= LANES_NOT(ordinary_arrivals(step->set, it));
    report->iterations = report->evaluations = it->iterations;
    return good;
}

/* Keeps what ordinary_try found, in the lanes of `good`, or in all: the motion moves on. */
HOT void ordinary_keep(struct ordinary *q, const struct iterate *it, lanes h, bool all, mask good,
                       struct motion *now)
{
    const mask second = mask_less(lanes_of(0), q->known);
    EACH (i, 0, SCENE_COORDINATES) {
        const lanes change = it->w[i] - now->w[i];
        q->before[i] = choose(second, q->change[i], change);
        q->change[i] = change;
    }
    q->known = lanes_of(1);
    q->turns = choose(mask_less_equal(lanes_of(TRIG_TURNS), q->turns), lanes_of(1), q->turns + 1);
    step_commit(now->t + h, it, all, good, MASK_NONE, now);
}

#endif
