/* inside.h - what a step does between its ends: falls, and extremes that are answers.
 *
 * Each is watched as a cubic over the step, by its Bernstein coefficients: a cubic is nowhere above
 * the largest of them (missed_events.h), which excludes nearly all steps.
 *
 *   angles    through value and rate at both ends, Hermite's: off by h^4 s''''/384 at most.
 *   falls     the same of the margin to a fall, which tells where to look. There, and where it
 *             falls, the margin is that of Hermite's place, h^4 s''''/384 off the motion.
 *   forces    and torques, whose rates are not known, through what a step has of them on its way,
 *             at states that may be off by h^3, which tells where to look. There the equations are
 *             solved once more, at the place of the quintic through position, velocity and
 *             acceleration at both ends: off by h^6 s^(6)/46080, its rate by h^5 s^(6)/13400.
 *
 * Where one looks is off by the order h, of the step, so that a peak, told as the value there, is
 * off by h^4. Across an event (core/implicit/step.h), where velocities jump, forces are those of
 * its parts, and angles and falls those of its end, with which what follows begins.
 */
#ifndef STANCE_CORE_MODE_INSIDE_H
#define STANCE_CORE_MODE_INSIDE_H

#include "between_events.h"

#define INSIDE_HALVINGS 52 /* to the instant of a fall */
#define INSIDE_FASTER 3    /* than at the beginning of a step: see inside_near */

enum { CUBIC = 4 };

/* ---- cubics over [0, 1] by their Bernstein coefficients ---------------------------------------*/

/* Through values at both ends, with these rates there. */
HOT void cubic_hermite(lanes f0, lanes rate0, lanes f1, lanes rate1, lanes h, lanes b[CUBIC])
{
    b[0] = f0;
    b[1] = lanes_fma(h * (1.0 / 3), rate0, f0);
    b[2] = lanes_fnma(h * (1.0 / 3), rate1, f1);
    b[3] = f1;
}
/* Through values at 0, 0.3, 0.8, 1. */
static inline void cubic_through(const lanes *f, lanes b[CUBIC])
{
    const lanes r1 = f[1] - 0.343 * f[0] - 0.027 * f[3];
    const lanes r2 = f[2] - 0.008 * f[0] - 0.512 * f[3];
    b[0] = f[0];
    b[1] = (0.384 * r1 - 0.189 * r2) / 0.1512;
    b[2] = (0.441 * r2 - 0.096 * r1) / 0.1512;
    b[3] = f[3];
}
/* The parabola through values at 0, 1/2, 1. */
static inline void cubic_parabola(const lanes *f, lanes b[CUBIC])
{
    const lanes twice = lanes_fms(lanes_of(4), f[1], f[0] + f[2]);
    b[0] = f[0];
    b[1] = (f[0] + twice) * (1.0 / 3);
    b[2] = (f[2] + twice) * (1.0 / 3);
    b[3] = f[2];
}
static inline void cubic_negate(lanes b[CUBIC])
{
    for (int i = 0; i < CUBIC; i++)
        b[i] = -b[i];
}

static inline lanes cubic_at(const lanes b[CUBIC], lanes x)
{
    lanes p[CUBIC] = {b[0], b[1], b[2], b[3]};
    for (int n = CUBIC - 1; n > 0; n--)
        for (int i = 0; i < n; i++)
            p[i] = lanes_fma(x, p[i + 1] - p[i], p[i]);
    return p[0];
}

/* Lanes where it has a maximum between the ends that is above `most`: where, and how much. The
 * slope is 3 (A x^2 + 2 B x + C); of its roots that where it falls. */
static inline mask cubic_peak(const lanes b[CUBIC], lanes most, lanes *x, lanes *peak)
{
    const lanes none = lanes_of(0);
    const mask above = mask_less(most, lanes_max(b[1], b[2]));
    *x = *peak = none;
    if (!mask_any(above))
        return MASK_NONE;
    const lanes C = b[1] - b[0], d = b[2] - b[1], end = b[3] - b[2];
    const lanes B = d - C, A = (C - d) + (end - d);
    const lanes root = lanes_sqrt(d * d - C * end);
    const mask apart = mask_less(none, B); /* neither form subtracts what is nearly the same */
    *x = choose(apart, -(B + root), C) / choose(apart, A, root - B);
    *peak = cubic_at(b, *x);
    return above & mask_less(none, *x) & mask_less(*x, lanes_of(1)) & mask_less(most, *peak);
}

/* ---- falls and angles: known with their rates at both ends ------------------------------------*/

/* An interval of the motion. */
struct inside_way {
    const struct setting *set;
    const lanes *s[2], *w[2]; /* at either end */
    const scene_trig *trig[2];
    lanes t, h; /* s: when it begins, how long it is */
};

/* The margin to a fall at the fraction x: every coordinate is Hermite's. */
static inline lanes inside_margin(const struct inside_way *way, int cause, lanes x)
{
    lanes s[SCENE_COORDINATES], b[CUBIC], rate;
    scene_trig trig;
    for (int i = 0; i < SCENE_COORDINATES; i++) {
        cubic_hermite(way->s[0][i], way->w[0][i], way->s[1][i], way->w[1][i], way->h, b);
        s[i] = cubic_at(b, x);
    }
    scene_trigonometry(s, &trig);
    return scene_fall_margin(&way->set->body, s, &trig, s, cause, &rate);
}

/* When it falls by `cause`, in the lanes of `low` where it does; the margin is about b, which says
 * where it is least. */
COLD void inside_fell(const struct inside_way *way, mask low, const lanes *b, int cause,
                      struct step_report *report)
{
    const lanes none = lanes_of(0);
    lanes depth[CUBIC], before = none, after, least;
    memcpy(depth, b, sizeof depth);
    cubic_negate(depth);
    const mask dips = low & cubic_peak(depth, lanes_of(-INFINITY), &after, &least);
    const mask deep = dips & motion_beyond(cause, inside_margin(way, cause, after));
    const mask begins = low & motion_beyond(cause, b[0]); /* an event ended there */
    const mask falls = begins | deep | (low & motion_beyond(cause, b[CUBIC - 1]));
    if (!mask_any(falls))
        return;
    after = choose(begins, none, choose(deep, after, lanes_of(1)));
    for (int k = 0; k < INSIDE_HALVINGS; k++) {
        const lanes middle = 0.5 * (before + after);
        const mask down = motion_beyond(cause, inside_margin(way, cause, middle));
        before = choose(down, before, middle);
        after = choose(down, middle, after);
    }
    const lanes when = lanes_fma(after, way->h, way->t);
    const mask earlier = mask_less_equal(report->fell_by, none) | mask_less(when, report->fell);
    report->fell = choose(falls & earlier, when, report->fell);
    report->fell_by = choose(falls & earlier, lanes_of(cause + 1), report->fell_by);
}

HOT void inside_falls(const struct inside_way *way, mask where, struct step_report *report)
{
    EACH (k, 0, SCENE_CAUSES) {
        lanes margin[2], rate[2], b[CUBIC];
        for (int end = 0; end < 2; end++)
            margin[end] = scene_fall_margin(&way->set->body, way->s[end], way->trig[end],
                                            way->w[end], k, &rate[end]);
        cubic_hermite(margin[0], rate[0], margin[1], rate[1], way->h, b);
        const mask low =
            where &
            mask_less_equal(lanes_min(lanes_min(b[0], b[1]), lanes_min(b[2], b[3])), lanes_of(0));
        if (mask_any(low))
            inside_fell(way, low, b, k, report);
    }
}

/* Angles off their targets in the lanes of `where`; `most`: at the ends. */
COLD void inside_swing(const struct inside_way *way, mask where, lanes most,
                       struct step_report *report)
{
    lanes posture[2][POSTURES], rate[2][POSTURES];
    for (int end = 0; end < 2; end++) {
        scene_posture(way->s[end], posture[end]);
        scene_posture(way->w[end], rate[end]);
    }
    for (int i = 0; i < SCENE_POSTURE; i++) {
        const lanes target = way->set->law.near.target[i];
        lanes b[CUBIC], x, peak;
        cubic_hermite(posture[0][i] - target, rate[0][i], posture[1][i] - target, rate[1][i],
                      way->h, b);
        for (int sign = 0; sign < 2; sign++) {
            const mask far = where & cubic_peak(b, most, &x, &peak);
            report->excursion = choose(far, lanes_max(peak, report->excursion), report->excursion);
            cubic_negate(b);
        }
    }
}

HOT void inside_angles(const struct inside_way *way, mask where, struct step_report *report)
{
    lanes ends = lanes_of(0), last = lanes_of(0), between = lanes_of(0);
    for (int end = 0; end < 2; end++) {
        const lanes ahead = way->h * (end ? -1.0 / 3 : 1.0 / 3);
        lanes posture[POSTURES], rate[POSTURES];
        scene_posture(way->s[end], posture);
        scene_posture(way->w[end], rate);
        EACH (i, 0, SCENE_POSTURE) {
            const lanes off = posture[i] - way->set->law.near.target[i];
            ends = lanes_max(lanes_abs(off), ends);
            last = end ? lanes_max(lanes_abs(off), last) : last;
            between = lanes_max(lanes_abs(lanes_fma(ahead, rate[i], off)), between);
        }
    }
    /* An event inside the step may be the furthest place. */
    report->excursion = choose(where, lanes_max(last, report->excursion), report->excursion);
    const mask far = where & mask_less(ends, between);
    if (mask_any(far))
        inside_swing(way, far, ends, report);
}

/* Lanes from whose state a smooth step of length h may come to a fall before its end: by what a
 * height or an angle moves at INSIDE_FASTER times its rate, and 1 m/s or rad/s. */
HOT mask inside_near(const struct setting *set, const lanes *s, const lanes *w,
                     const scene_trig *trig, lanes h)
{
    mask near = MASK_NONE;
    EACH (k, 0, SCENE_CAUSES) {
        lanes rate;
        const lanes margin = scene_fall_margin(&set->body, s, trig, w, k, &rate);
        near |= mask_less_equal(margin, lanes_fma(INSIDE_FASTER * h, lanes_abs(rate), h));
    }
    return near;
}

/* What a way tells of itself by its ends. */
HOT void inside_watch(const struct inside_way *way, mask where, struct step_report *report)
{
    inside_falls(way, where, report);
    inside_angles(way, where, report);
}

/* ---- forces and torques: where to look --------------------------------------------------------*/

/* The quintic through both ends with accelerations a there, at the fraction x, and its rate. */
static inline void inside_place(const struct inside_way *way, const lanes *const a[2], lanes x,
                                lanes *s, lanes *w)
{
    const lanes h = way->h;
    for (int i = 0; i < SCENE_COORDINATES; i++) {
        const lanes s0 = way->s[0][i], v0 = way->w[0][i], a0 = a[0][i];
        const lanes d0 = way->s[1][i] - s0 - h * (v0 + 0.5 * h * a0);
        const lanes d1 = h * (way->w[1][i] - v0 - h * a0), d2 = h * h * (a[1][i] - a0);
        const lanes c3 = 10 * d0 - 4 * d1 + 0.5 * d2, c4 = -15 * d0 + 7 * d1 - d2;
        const lanes c5 = 6 * d0 - 3 * d1 + 0.5 * d2;
        s[i] = s0 + h * x * (v0 + 0.5 * h * x * a0) + x * x * x * (c3 + x * (c4 + x * c5));
        w[i] = v0 + h * x * a0 + x * x * (3 * c3 + x * (4 * c4 + 5 * x * c5)) / h;
    }
}

/* Forces and torques on a way, at 0, 0.3, 0.8, 1 or, `parabola`, at 0, 1/2, 1. */
struct inside_values {
    bool parabola;
    lanes normal[CUBIC][CONTACTS], load[CUBIC][CONTACTS], tangential[CUBIC][CONTACTS];
    lanes torque[CUBIC][ACTUATORS];
};
static inline void inside_note(const struct dynamics *e, int k, struct inside_values *values)
{
    for (int c = 0; c < OWN_CONTACTS; c++) {
        values->normal[k][c] = e->force[c][0];
        values->load[k][c] = contact_load(c, e->force);
        values->tangential[k][c] = e->force[c][1];
    }
    for (int i = 0; i < SCENE_ACTUATORS; i++)
        values->torque[k][i] = e->torque[i];
}

/* Where a force or a torque peaks above what is known of both ends: lanes, and about where. */
struct inside_peaks {
    int count;
    mask high[3 * CONTACTS + 2 * ACTUATORS];
    lanes x[3 * CONTACTS + 2 * ACTUATORS];
};

/* Finds the peaks of a course with values f at places, in the lanes of `where`. */
static inline void inside_peak(bool parabola, const lanes *f, lanes most, mask where, bool either,
                               struct inside_peaks *peaks)
{
    lanes b[CUBIC], peak;
    if (parabola)
        cubic_parabola(f, b);
    else
        cubic_through(f, b);
    for (int sign = 0; sign < (either ? 2 : 1); sign++) {
        const int k = peaks->count++;
        peaks->high[k] = where & cubic_peak(b, most, &peaks->x[k], &peak);
        cubic_negate(b);
    }
}

/* Normal forces that are less, friction and torques that are more, of the contacts in `touches` and
 * the actuators that `act`. *report: of both ends. */
static inline void inside_find(const struct contact_state *m, contact_set touches, bool act,
                               const struct inside_values *values, const struct step_report *report,
                               struct inside_peaks *peaks)
{
    const lanes none = lanes_of(0);
    lanes f[CUBIC];
    peaks->count = 0;
    for (int c = 0; c < OWN_CONTACTS; c++) {
        if (!(touches >> c & 1))
            continue;
        for (int k = 0; k < CUBIC; k++)
            f[k] = -values->normal[k][c];
        inside_peak(values->parabola, f, -report->least[c], m->closed[c], false, peaks);
        if (contact_unknowns(c) == 1)
            continue;
        mask loaded = contact_part(c, m->closed);
        for (int k = 0; k < CUBIC; k++) {
            loaded &= mask_less(none, values->load[k][c]);
            f[k] = values->tangential[k][c] / values->load[k][c];
        }
        inside_peak(values->parabola, f, report->friction_used, loaded, true, peaks);
    }
    for (int i = 0; i < SCENE_ACTUATORS && act; i++) {
        for (int k = 0; k < CUBIC; k++)
            f[k] = values->torque[k][i];
        inside_peak(values->parabola, f, report->peak_torque, LANES_ALL, true, peaks);
    }
}

/* Takes down what *e, solved inside a way, has in the lanes of `where`. */
static inline void inside_tell(const struct contact_state *m, const struct dynamics *e, mask where,
                               struct step_report *report)
{
    struct step_report seen = *report;
    report_forces(&seen, m->closed, e->force);
    report_torques(&seen, e->torque);
    choose_all(where, &seen, report, sizeof seen);
}

#endif
