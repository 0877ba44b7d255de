/* explicit.h - one explicit Runge-Kutta step of the smooth motion in a contact mode.
 *
 * The method's file gives its tableau before it includes this: METHOD_STAGES (the number of
 * stages), tableau_a[][], tableau_b[], tableau_c[] and, with METHOD_EMBEDDED, tableau_e[], the
 * difference between its weights and those of the embedded formula (one entry more: the last is
 * that of the derivative at the end) and tableau_dip[], for each stage which of the values of
 * inside.h it gives, or -1. Every stage solves the contact forces of the mode; at the end the state
 * is put back onto the mode's constraints (between_project). States of stages are off by h^2 and
 * more: the forces and torques that a step tells are those of its ends and, where it estimates its
 * error, of the peaks between them (inside.h).
 *
 * Where a torque that acts continuously reaches its limit or leaves it, accelerations have a
 * corner, and where its error is largest (0.022 h^2 times what their rates change by) the embedded
 * estimate sees a twentieth of it, which shrinks as it should. But a decoupling law that passes a
 * singular posture throws its torques from one limit to the other: as good as a jump J. Of that the
 * estimate at the fraction x of the step is h J times the sum of tableau_e over the stages after x,
 * 0.003 for x between 0.3 and 0.8 (Dormand and Prince), and the error h J times the sum of
 * tableau_b over them less 1 - x: up to 0.26 there, up to 0.39 at 8/9. Under such a law the error
 * of a step in which a limit begins or ends is taken for that bound, J for all that accelerations
 * differ by between its stages.
 */
#ifndef STANCE_CORE_MODE_EXPLICIT_H
#define STANCE_CORE_MODE_EXPLICIT_H

#include "missed_events.h"

#define EXPLICIT_JUMP 0.39 /* a jump J of accelerations: at most this times h J in the rates */

/* What a step came to; the state and the report are defined where neither `violated` nor `bad`. */
struct explicit_step {
    struct motion end;
    struct step_report report;
    lanes error;   /* estimate: largest over coordinates (m, rad) and rates (m/s, rad/s) */
    mask violated; /* the mode ended inside the step */
    mask dipped;   /* it may have ended and begun again between the stages */
    mask bad;      /* not finite, or an angle out of range ... */
    lanes failure; /* ... as a stance_failure */
    /* At the beginning: torques in force, and how fast the law sums. */
    lanes torque[ACTUATORS], integral_rate[ACTUATORS];
};

/* Adds k * x to sums of coordinates and rates. A weight of zero costs nothing: all are constants.
 */
static inline void explicit_add(lanes *s, lanes *w, lanes k, const lanes *ds, const lanes *dw)
{
    for (int i = 0; i < SCENE_COORDINATES; i++) {
        s[i] += k * ds[i];
        w[i] += k * dw[i];
    }
}

/* The same for what the law sums, where it does. */
static inline void explicit_sum(bool sums, lanes *z, lanes k, const lanes *dz)
{
    for (int i = 0; i < SCENE_ACTUATORS && sums; i++)
        z[i] += k * dz[i];
}

static inline void explicit_report(const struct setting *set, const struct contact_state *m,
                                   const struct dynamics *e, struct step_report *report)
{
    lanes load = lanes_of(0);
    report->signorini_residual = report->coulomb_residual = report->dissipation_residual =
        lanes_of(0);
    for (int c = 0; c < OWN_CONTACTS; c++)
        load += lanes_max(e->force[c][0], lanes_of(0));
    mask part[CONTACTS]; /* what carries but a rounding error has no direction */
    for (int c = 0; c < OWN_CONTACTS; c++)
        part[c] = m->closed[c] & mask_less(1e-9 * load, e->force[c][0]);
    for (int c = 0; c < OWN_CONTACTS; c++)
        report_residuals(report, c, part, set->friction, e->force, e->u[c]);
}

#ifdef METHOD_EMBEDDED
/* Where torques are: 1 at their upper limit, -1 at the lower, 0 inside. */
static inline void explicit_limits(const struct law *law, const lanes *torque, lanes *at)
{
    for (int i = 0; i < SCENE_ACTUATORS; i++)
        at[i] = lanes_where(mask_less_equal(law->limit[i], torque[i])) -
                lanes_where(mask_less_equal(torque[i], -law->limit[i]));
}

/* Lanes where some torque is elsewhere. */
static inline mask explicit_turned(const struct law *law, const lanes *begin, const lanes *torque)
{
    lanes now[ACTUATORS];
    mask turned = MASK_NONE;
    explicit_limits(law, torque, now);
    for (int i = 0; i < SCENE_ACTUATORS; i++)
        turned |= mask_less(lanes_of(0), lanes_abs(now[i] - begin[i]));
    return turned;
}

/* A step seen from inside. */
struct explicit_way {
    struct inside_way way;
    const lanes *a[2];             /* accelerations at either end ... */
    const lanes *sum[2], *rate[2]; /* ... and what the law sums, how fast */
    const struct drive *drive;
    contact_set touches;
};

/* Solves the equations at the fraction x of a step, in the lanes of `where`. */
COLD void explicit_look(const struct explicit_way *e, mask where, lanes x,
                        struct step_report *report)
{
    const struct setting *const set = e->way.set;
    lanes s[SCENE_COORDINATES], w[SCENE_COORDINATES], z[ACTUATORS], b[CUBIC];
    struct dynamics at;
    inside_place(&e->way, e->a, x, s, w);
    for (int i = 0; i < SCENE_ACTUATORS; i++) {
        cubic_hermite(e->sum[0][i], e->rate[0][i], e->sum[1][i], e->rate[1][i], e->way.h, b);
        z[i] = cubic_at(b, x);
    }
    const struct state state = {e->way.t + x * e->way.h, s, w, z};
    between_evaluate(set, &state, e->drive, e->touches, &at);
    if (e->touches)
        between_solve(set, e->drive->mode, &at);
    inside_tell(e->drive->mode, &at, where, report);
    report->evaluations += lanes_where(where);
}

/* What accelerations differ by between the stages and the end. */
static inline lanes explicit_range(lanes (*kw)[SCENE_COORDINATES], const lanes *end)
{
    lanes range = lanes_of(0);
    for (int i = 0; i < SCENE_COORDINATES; i++) {
        lanes least = end[i], most = end[i];
        for (int k = 0; k < METHOD_STAGES; k++) {
            least = lanes_min(kw[k][i], least);
            most = lanes_max(kw[k][i], most);
        }
        range = lanes_max(most - least, range);
    }
    return range;
}
#endif

/* One step in the mode `m` with `begin` evaluated and solved at its beginning. */
static inline void explicit_take(const struct step *step, mask run, const struct contact_state *m,
                                 const struct dynamics *begin, struct explicit_step *out)
{
    const struct setting *const set = step->set;
    const struct motion *const from = step->from;
    const bool coupled = step->coupled;
    const lanes h = step->h;
    lanes ks[METHOD_STAGES][SCENE_COORDINATES], kw[METHOD_STAGES][SCENE_COORDINATES];
    lanes kz[METHOD_STAGES][ACTUATORS];
    const bool sums = law_sums(&set->law, coupled);
    const struct drive drive = {step->torque, coupled, m};
    const contact_set touches = contact_any(m->closed, run);
    struct dynamics e = *begin;
    report_clear(&out->report);
    for (int i = 0; i < SCENE_ACTUATORS; i++) {
        out->torque[i] = begin->torque[i];
        out->integral_rate[i] = begin->integral_rate[i];
    }
    out->violated = out->dipped = MASK_NONE;
    out->end = *from;
#ifdef METHOD_EMBEDDED
    struct inside_values values = {.parabola = false};
    lanes limits[ACTUATORS];
    mask turned = MASK_NONE;
    const mask decouples = mask_less(lanes_of(0), set->law.decouples);
    const bool jumps = SCENE_ACTUATORS > 0 && coupled && mask_any(decouples);
    if (jumps)
        explicit_limits(&set->law, begin->torque, limits);
#endif
#pragma GCC unroll 16
    for (int k = 0; k < METHOD_STAGES; k++) {
        lanes s[SCENE_COORDINATES], w[SCENE_COORDINATES], z[ACTUATORS];
        for (int i = 0; i < SCENE_COORDINATES; i++)
            s[i] = from->s[i], w[i] = from->w[i];
        for (int i = 0; i < SCENE_ACTUATORS; i++)
            z[i] = from->integral[i];
        const struct state at = {from->t + h * tableau_c[k], s, w, z};
        if (k > 0) {
#pragma GCC unroll 16
            for (int j = 0; j < k; j++)
                if (tableau_a[k][j] != 0) {
                    explicit_add(s, w, h * tableau_a[k][j], ks[j], kw[j]);
                    explicit_sum(sums, z, h * tableau_a[k][j], kz[j]);
                }
            between_evaluate(set, &at, &drive, touches, &e);
            if (touches)
                between_solve(set, m, &e);
            out->violated |= between_violated(set, m, &e);
        }
        for (int i = 0; i < SCENE_COORDINATES; i++)
            ks[k][i] = w[i], kw[k][i] = e.acceleration[i];
        for (int i = 0; i < SCENE_ACTUATORS; i++)
            kz[k][i] = e.integral_rate[i];
#ifdef METHOD_EMBEDDED
        if (tableau_dip[k] >= 0)
            inside_note(&e, tableau_dip[k], &values);
        if (jumps && k > 0)
            turned |= explicit_turned(&set->law, limits, e.torque);
#endif
        if (tableau_b[k] != 0) {
            lanes moved[SCENE_COORDINATES];
            const lanes part = h * tableau_b[k];
            for (int i = 0; i < SCENE_COORDINATES; i++)
                moved[i] = part * w[i];
            out->report.work += motion_work(&set->body, part, at.t, &e.trig, e.torque, w, moved);
            explicit_add(out->end.s, out->end.w, part, ks[k], kw[k]);
            explicit_sum(sums, out->end.integral, part, kz[k]);
            for (int c = 0; c < OWN_CONTACTS; c++) {
                if (contact_unknowns(c) == 2)
                    out->report.slip[c] += choose(contact_part(c, m->closed),
                                                  part * lanes_abs(e.u[c][1]), lanes_of(0));
                for (int a = 0; a < 2; a++)
                    out->report.impulse[c][a] += part * e.force[c][a];
            }
        }
    }
    struct motion *const end = &out->end;
    out->bad = run & LANES_NOT(scene_angles_in_range(end->s));
    end->t = from->t + h;
    const struct state last = state_of(end);
    between_evaluate(set, &last, &drive, touches, &e);
    out->report.degraded_samples = e.degraded;
    out->report.ambiguous_steps = e.several;
    if (touches)
        between_solve(set, m, &e);
    out->violated |= between_violated(set, m, &e);
    out->error = lanes_of(0);
#ifdef METHOD_EMBEDDED
    lanes es[SCENE_COORDINATES] = {0}, ew[SCENE_COORDINATES] = {0};
#pragma GCC unroll 16
    for (int k = 0; k < METHOD_STAGES; k++)
        if (tableau_e[k] != 0)
            explicit_add(es, ew, h * tableau_e[k], ks[k], kw[k]);
    explicit_add(es, ew, h * tableau_e[METHOD_STAGES], end->w, e.acceleration);
    for (int i = 0; i < SCENE_ACTUATORS && sums; i++) {
        lanes ez = h * (tableau_e[METHOD_STAGES] * e.integral_rate[i]);
        for (int k = 0; k < METHOD_STAGES; k++)
            ez += h * (tableau_e[k] * kz[k][i]);
        out->error = lanes_max(lanes_abs(ez), out->error);
    }
    for (int i = 0; i < SCENE_COORDINATES; i++)
        out->error = lanes_max(lanes_max(lanes_abs(es[i]), lanes_abs(ew[i])), out->error);
    if (jumps)
        turned |= explicit_turned(&set->law, limits, e.torque);
    turned &= decouples;
    if (mask_any(turned)) {
        const lanes most = h * (EXPLICIT_JUMP * explicit_range(kw, e.acceleration));
        out->error = choose(turned, lanes_max(most, out->error), out->error);
    }
    inside_note(&e, CUBIC - 1, &values);
    const struct explicit_way way = {
        {set, {from->s, end->s}, {from->w, end->w}, {&from->trig, &e.trig}, from->t, h},
        {kw[0], e.acceleration},
        {from->integral, end->integral},
        {kz[0], e.integral_rate},
        &drive,
        touches};
    out->dipped = missed_between(&way.way, m, begin, &e, &values);
#endif
    report_forces(&out->report, m->closed, begin->force);
    report_forces(&out->report, m->closed, e.force);
    report_torques(&out->report, begin->torque);
    report_torques(&out->report, e.torque);
    out->report.evaluations = lanes_of(METHOD_STAGES);
#ifdef METHOD_EMBEDDED
    const mask whole = run & LANES_NOT(out->violated | out->bad | out->dipped);
    struct inside_peaks peaks;
    inside_find(m, touches, coupled, &values, &out->report, &peaks);
    for (int k = 0; k < peaks.count; k++)
        if (mask_any(whole & peaks.high[k]))
            explicit_look(&way, whole & peaks.high[k], peaks.x[k], &out->report);
#endif
    if (touches)
        between_project(set, m, run, end->s, end->w, &e);
    lanes sum = lanes_of(0);
    for (int i = 0; i < SCENE_COORDINATES; i++)
        sum += end->s[i] + end->w[i];
    out->failure = choose(mask_finite(sum), lanes_of(STANCE_FAILURE_ANGLE),
                          lanes_of(STANCE_FAILURE_NOT_FINITE));
    out->bad |= run & LANES_NOT(mask_finite(sum));
    for (int c = 0; c < OWN_CONTACTS; c++) {
        end->gap[c] = e.gap[c];
        end->approach[c] = e.u[c][0];
    }
    end->trig = e.trig;
    explicit_report(set, m, &e, &out->report);
    for (int i = 0; i < SCENE_ACTUATORS; i++)
        out->report.torque[i] = e.torque[i];
}

#endif
