/* lagrange.c - the explicit method that the paper compares with: its sections 2.1 and 2.3,
 * figure 7.
 *
 * The switched Lagrange equations (core/mode/between_events.h) are integrated by fixed steps of the
 * classical Runge-Kutta formula of order 4, in the contact mode that holds at the beginning of the
 * step. When the mode does not last to the end - a foot would be below the ground, a force pull,
 * friction leave its cone, a slip turn around - the step is halved, and halved again, until the
 * time of the switch is bracketed to LAGRANGE_BRACKET; then the state is initialised anew: feet are
 * put onto the ground, the impact law of core/contact gives the velocities, the next mode follows
 * from the state. The rest of the step is one step, unless another switch is found in it.
 *
 * Nothing else shortens a step: stiff servo gains need h |lambda| < 2.785, as for every explicit
 * formula of this kind. Switches that accumulate (Zeno) end the case with a message, as does a
 * state whose accelerations do not exist (Painleve). `events` and `evaluations` say what hunting
 * for switches cost.
 */
#define METHOD_THETA 0.5 /* read by core/implicit/step.h, whose implicit step is not taken here */
#define METHOD_STAGES 4

/* Cases may change lanes; a step may be of any length. */
#define ADVANCE_MOVES
#define ADVANCE_PIECES

#include "engine/core/loop/kernel.h"
/* In this order. */
#include STANCE_SCENE_LANES

static const double tableau_c[METHOD_STAGES] = {0, 0.5, 0.5, 1};
static const double tableau_a[METHOD_STAGES][METHOD_STAGES] = {{0}, {0.5}, {0, 0.5}, {0, 0, 1}};
static const double tableau_b[METHOD_STAGES] = {1.0 / 6, 1.0 / 3, 1.0 / 3, 1.0 / 6};

// clang-format off
#include "engine/core/mode/explicit.h"
// clang-format on

#define LAGRANGE_BRACKET 1e-12    /* s: a switch is known this well */
#define LAGRANGE_SMALLEST 0x1p-40 /* of a step: what is left of it by rounding */
#define LAGRANGE_EVENTS 200       /* in one step, then the case fails */
#define LAGRANGE_DEEPEST 1e-8     /* m: a foot that is further below the ground has gone astray */

/* Where each lane is inside its step. */
struct advance {
    lanes done;            /* s, of the step */
    lanes part;            /* s, interval that holds a switch; INFINITY: none is known */
    lanes events;          /* in this step */
    lanes stood[CONTACTS]; /* see between_mode */
    struct step_report sum;
};

static void advance_load(struct advance *a, int lane, const stance_case *c)
{
    (void)c;
    lane_clear(a, sizeof *a, lane);
    lane_set(&a->part, lane, INFINITY);
    report_clear_lane(&a->sum, lane);
}
static void advance_forget(struct advance *a, mask m)
{
    for (int i = 0; i < OWN_CONTACTS; i++)
        a->stood[i] = choose(m, lanes_of(0), a->stood[i]);
}

/* One attempt in every lane. */
static inline mask advance(struct advance *a, const struct step *asked, mask live,
                           struct motion *now, struct step_report *report, mask *failed)
{
    const struct setting *const set = asked->set;
    const lanes none = lanes_of(0), one = lanes_of(1), h = asked->h;
    const lanes left = h - a->done;
    /* Halves add up to the step but for rounding: what is left of it then is no interval. */
    const lanes interval = choose(mask_less(a->part, left - LAGRANGE_SMALLEST * h), a->part, left);
    const mask hunt = live & mask_less(a->part, lanes_of(INFINITY));
    const mask found = hunt & mask_less_equal(interval, lanes_of(LAGRANGE_BRACKET));
    const lanes length = choose(hunt & LANES_NOT(found), 0.5 * interval, interval);
    struct dynamics begin;
    struct contact_state mode;
    struct between_trouble trouble;
    struct explicit_step step;
    struct step part = *asked;
    part.h = length;
    const contact_set touching = between_begin(asked, a->stood, &begin, &mode, &trouble);
    if (touching)
        between_solve(set, &mode, &begin);
    explicit_take(&part, live, &mode, &begin, &step);

    const mask painleve = live & (trouble.none | trouble.several) & LANES_NOT(trouble.impact);
    const mask able = live & LANES_NOT(painleve | trouble.impact | step.bad);
    const mask take = able & (LANES_NOT(step.violated) | found);
    const mask switched = (take & found) | (live & trouble.impact);
    /* At a bracket's end the forces are those of the mode that has just ended. */
    step.report.signorini_residual = choose(found, none, step.report.signorini_residual);
    step.report.coulomb_residual = choose(found, none, step.report.coulomb_residual);
    step.report.dissipation_residual = choose(found, none, step.report.dissipation_residual);
    lanes stands[CONTACTS];
    between_stands(&mode, stands);
    for (int c = 0; c < OWN_CONTACTS; c++)
        a->stood[c] = choose(switched, none, choose(take, stands[c], a->stood[c]));
    step.report.ambiguous_steps = choose(trouble.chosen, one, step.report.ambiguous_steps);
    step.report.unranked_steps = lanes_where(trouble.unranked);
    report_add_where(take, &a->sum, &step.report);
    choose_all(take, &step.end, now, sizeof step.end);
    a->sum.evaluations += choose(live & LANES_NOT(take), step.report.evaluations, none);
    mask unsolved = MASK_NONE;
    if (mask_any(switched)) {
        unsolved = switched & LANES_NOT(between_impact(set, switched, now, &a->sum));
        a->sum.events += lanes_where(switched);
        a->events += lanes_where(switched);
    }

    /* A step may be so long that no projection brings a foot back onto the ground. */
    mask deep = MASK_NONE;
    for (int c = 0; c < OWN_CONTACTS; c++)
        deep |= (take | switched) & mask_less(none, set->may_touch[c]) &
                mask_less(now->gap[c], lanes_of(-LAGRANGE_DEEPEST));

    const mask hunts = able & LANES_NOT(found) & (step.violated | hunt);
    a->done = choose(take, a->done + length, a->done);
    a->part = choose(live, choose(hunts, length, lanes_of(INFINITY)), a->part);
    const mask arrived = take & mask_less_equal(left, length) & LANES_NOT(deep);
    const mask zeno = mask_less(lanes_of(LAGRANGE_EVENTS), a->events);
    *failed = live & (painleve | unsolved | deep | step.bad | zeno) & LANES_NOT(arrived);

    *report = a->sum;
    report->failure = choose(painleve, lanes_of(STANCE_FAILURE_PAINLEVE), none);
    report->failure = choose(unsolved | deep, lanes_of(STANCE_FAILURE_CONTACT), report->failure);
    report->failure = choose(zeno, lanes_of(STANCE_FAILURE_EVENTS), report->failure);
    report->failure = choose(step.bad, step.failure, report->failure);
    report_clear_where(arrived, &a->sum);
    a->done = choose(arrived, none, a->done);
    a->events = choose(arrived, none, a->events);
    return arrived;
}

// clang-format off
#include "engine/core/loop/stream.h"
// clang-format on

STANCE_METHOD(lagrange) = {
    .name = "lagrange",
    .text = "switched Lagrange equations, Runge-Kutta of order 4, switches bracketed by halving",
    .order_smooth = 4,
};

STANCE_KERNEL(lagrange);
