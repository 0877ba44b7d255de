/* quick.h - the ordinary step: what touches goes on touching, nothing arrives, nothing bounces.
 *
 * The equation is step.h's; ordinary steps, all but a few in a thousand, reach its solution with
 * less work:
 *
 * - Newton begins at the velocity that the last two changes of velocity point to,
 *   w0 + 2 dw_n-1 - dw_n-2, which is off by the third derivative of motion.
 * - It ends as soon as the error left is certainly small. After a correction d that is at most
 *   K h |d|^2 with the scene's bound K on the equation's curvature (scene_curvature), so one
 *   iteration is enough where |d|^2 <= QUICK_ERROR / (K h), relative to the speed: about 1e-5.
 * - Sines and cosines at the end are those of the beginning turned by h w, an angle of
 *   QUICK_ANGLE at most, by series; every QUICK_TURNS steps they are computed anew, so that
 *   rounding does not add up.
 * - Contacts are those of the bundle: `touching` is known to the compiler.
 *
 * A lane in which anything is not ordinary - an impact, a touchdown, a contact problem that is not
 * certainly unique, a long way to converge, energy from nowhere - is left to step.h, whatever its
 * neighbours do: which lanes share a bundle changes no bit.
 */
#ifndef STANCE_CORE_QUICK_H
#define STANCE_CORE_QUICK_H

#include "step.h"

#define QUICK_ITERATIONS 4
#define QUICK_ERROR 1e-11  /* of the velocity, left by Newton */
#define QUICK_ANGLE 0.0625 /* rad: the series' rounding error is then below 1e-17 */
#define QUICK_TURNS 32     /* steps between sines computed anew */
#define QUICK_SMALL 1e-6   /* rad: a last correction that turns further is not ordinary */

/* What is remembered of the steps before. */
struct quick {
    lanes change[SCENE_COORDINATES]; /* of the velocity in the last step ... */
    lanes before[SCENE_COORDINATES]; /* ... and in the one before */
    lanes impulse[SCENE_CONTACTS][2];
    lanes known; /* 1: the step before was ordinary, too */
    lanes turns; /* steps since the sines were computed anew */
};

/* Forgets the lanes in m. */
static inline void quick_forget(struct quick *q, mask m)
{
    const lanes none = lanes_of(0);
    for (int i = 0; i < SCENE_COORDINATES; i++) {
        q->change[i] = choose(m, none, q->change[i]);
        q->before[i] = choose(m, none, q->before[i]);
    }
    for (int c = 0; c < SCENE_CONTACTS; c++)
        for (int a = 0; a < 2; a++)
            q->impulse[c][a] = choose(m, none, q->impulse[c][a]);
    q->known = choose(m, none, q->known);
    q->turns = choose(m, lanes_of(QUICK_TURNS), q->turns);
}

/* Sines and cosines after turning by d[], at most QUICK_ANGLE. */
static inline void quick_turn(const scene_trig *from, const lanes *d, scene_trig *to)
{
    for (int a = 0; a < SCENE_ANGLES; a++) {
        const lanes x = d[a], t = x * x, s = from->sine[a], c = from->cosine[a];
        lanes sine = lanes_fma(t, lanes_of(-1. / 5040), lanes_of(1. / 120));
        sine = lanes_fma(t, sine, lanes_of(-1. / 6));
        sine = lanes_fma(x * t, sine, x);
        lanes less = lanes_fma(t, lanes_of(1. / 40320), lanes_of(-1. / 720)); /* cosine - 1 */
        less = lanes_fma(t, less, lanes_of(1. / 24));
        less = t * lanes_fma(t, less, lanes_of(-0.5));
        to->sine[a] = s + lanes_fma(c, sine, s * less);
        to->cosine[a] = c + lanes_fnma(s, sine, c * less);
    }
}

/* Takes sines and cosines over where m holds. */
static inline void quick_take(mask m, const scene_trig *from, scene_trig *to)
{
    for (int a = 0; a < SCENE_ANGLES; a++) {
        to->sine[a] = choose(m, from->sine[a], to->sine[a]);
        to->cosine[a] = choose(m, from->cosine[a], to->cosine[a]);
    }
}

/* Places the iterate in the lanes of m: its end position and the sines there (and halfway). */
static inline void quick_place(const struct quick *q, const struct motion *from, lanes h, mask m,
                               struct iterate *it)
{
    lanes d[SLOTS(SCENE_ANGLES)], halfway[SCENE_COORDINATES], farthest = lanes_of(0);
    for (int i = 0; i < SCENE_COORDINATES; i++) {
        const lanes move = h * step_velocity(from->w[i], it->w[i]);
        it->s1[i] = choose(m, from->s[i] + move, it->s1[i]);
        halfway[i] = from->s[i] + METHOD_THETA * move;
        if (i >= FIRST_ANGLE) {
            d[i - FIRST_ANGLE] = METHOD_THETA * move;
            farthest = lanes_max(lanes_abs(move), farthest);
        }
    }
    if (SCENE_ANGLES == 0) {
        it->end = it->middle = from->trig;
        return;
    }
    scene_trig end, middle;
    quick_turn(&from->trig, d, &middle);
    if (METHOD_THETA != 1)
        quick_turn(&middle, d, &end);
    const mask anew = LANES_NOT(mask_less_equal(farthest, lanes_of(QUICK_ANGLE))) |
                      mask_less_equal(lanes_of(QUICK_TURNS), q->turns);
    if (mask_any(m & anew)) {
        scene_trig exact;
        scene_trigonometry(halfway, &exact);
        quick_take(anew, &exact, &middle);
        if (METHOD_THETA != 1) {
            scene_trigonometry(it->s1, &exact);
            quick_take(anew, &exact, &end);
        }
    }
    quick_take(m, METHOD_THETA == 1 ? &middle : &end, &it->end);
    if (METHOD_THETA != 1)
        quick_take(m, &middle, &it->middle);
}

/* Moves the end by the last correction, from `old` to it->w: the sines follow to third order.
 * Returns the lanes where that is enough. */
static inline mask quick_arrive(const struct motion *from, lanes h, const lanes *old,
                                struct iterate *it)
{
    lanes d[SCENE_COORDINATES], farthest = lanes_of(0);
    for (int i = 0; i < SCENE_COORDINATES; i++) {
        d[i] = (h * METHOD_THETA) * (it->w[i] - old[i]);
        it->s1[i] = lanes_fma(h, step_velocity(from->w[i], it->w[i]), from->s[i]);
        if (i >= FIRST_ANGLE)
            farthest = lanes_max(lanes_abs(d[i]), farthest);
    }
    trig_turn(&it->end, LANES_ALL, d);
    return mask_less_equal(farthest, lanes_of(QUICK_SMALL));
}

/* Newton's iteration to its end, from the extrapolated velocity. Returns the lanes where it got
 * there. */
static inline mask quick_newton(const struct quick *q, const struct setting *set,
                                const struct motion *from, lanes h, mask run, contact_set touching,
                                struct iterate *it, lanes *iterations)
{
    lanes old[SCENE_COORDINATES];
    const lanes bound = h * scene_curvature(&set->body);
    mask running = run;
    *iterations = lanes_of(0);
    for (int i = 0; i < SCENE_COORDINATES; i++)
        it->w[i] = from->w[i] + lanes_fms(lanes_of(2), q->change[i], q->before[i]);
    for (int k = 0; k < QUICK_ITERATIONS && mask_any(running); k++) {
        const mask moving = k == 0 ? LANES_ALL : running;
        quick_place(q, from, h, moving, it);
        for (int i = 0; i < SCENE_COORDINATES; i++)
            old[i] = choose(moving, it->w[i], old[i]);
        iterate_newton(set, from, h, moving, false, MASK_NONE, false, false, touching, it);
        *iterations += choose(moving, lanes_of(1), lanes_of(0));
        running &= LANES_NOT(
            mask_less_equal((bound * it->size) * (it->size + it->shift), QUICK_ERROR * it->speed));
    }
    return run & LANES_NOT(running) & quick_arrive(from, h, old, it);
}

/* Lanes where a contact that did not touch is not above the ground. */
static inline mask quick_arrivals(const struct setting *set, const struct iterate *it)
{
    mask there = MASK_NONE;
    for (int c = 0; c < SCENE_CONTACTS; c++)
        there |= mask_less(lanes_of(0), set->may_touch[c]) & LANES_NOT(it->active[c]) &
                 LANES_NOT(mask_less(lanes_of(0), it->gap[c]));
    return there;
}

/* One ordinary step of the lanes in `run`, contacts in `touching` being closed in some of them.
 * Returns the lanes where it was one; in the others *to is left as it is. */
static inline mask quick_step(struct quick *q, const struct setting *set, const struct motion *from,
                              const lanes *torque, lanes h, mask run, contact_set touching,
                              struct motion *to, struct step_report *report)
{
    struct iterate it;
    lanes iterations;
    mask good = run;
    memset(&it.end, 0, sizeof it.end);
    it.corner = NULL;
    it.ambiguous = it.unsolved = MASK_NONE;
    for (int i = 0; i < SCENE_ACTUATORS; i++)
        it.torque[i] = torque[i];
    for (int c = 0; c < SCENE_CONTACTS; c++) {
        const bool here = touching >> c & 1;
        it.active[c] = MASK_NONE;
        if (here)
            it.active[c] = mask_less(lanes_of(0), set->may_touch[c]) &
                           mask_less_equal(from->gap[c], lanes_of(STEP_CLOSED));
        good &= LANES_NOT(it.active[c] & mask_less(from->approach[c], lanes_of(-STEP_APPROACH)));
        for (int a = 0; a < 2; a++)
            it.r[c][a] = here ? choose(it.active[c], q->impulse[c][a], lanes_of(0)) : lanes_of(0);
    }
    good &= quick_newton(q, set, from, h, good, touching, &it, &iterations);
    good &= LANES_NOT(it.unsolved);
    for (int c = 0; c < SCENE_CONTACTS; c++)
        it.gap[c] = scene_gap(&set->body, it.s1, &it.end, c);
    good &= LANES_NOT(quick_arrivals(set, &it));
    good = step_finish(set, from, h, touching, false, MASK_NONE, good, false, &it, report);
    good &= LANES_NOT(quick_arrivals(set, &it)); /* removing position errors may bring some */
    report->iterations = report->evaluations = iterations;
    const lanes none = lanes_of(0), known = q->known;
    const mask second = mask_less(none, known);
    for (int i = 0; i < SCENE_COORDINATES; i++) {
        const lanes change = it.w[i] - from->w[i];
        q->before[i] = choose(second, q->change[i], change);
        q->change[i] = change;
    }
    for (int c = 0; c < SCENE_CONTACTS; c++)
        for (int a = 0; a < 2; a++)
            q->impulse[c][a] = it.r[c][a];
    q->known = lanes_of(1);
    q->turns = choose(mask_less_equal(lanes_of(QUICK_TURNS), q->turns), lanes_of(1), q->turns + 1);
    step_commit(from, h, &it, good, to);
    return good;
}

#endif
