/* capturing.c - high order while the contact mode lasts, the implicit law where an event falls.
 *
 * Between events the step is Dormand and Prince's explicit Runge-Kutta formula of order 5 with its
 * embedded formula of order 4 (J. Comp. Appl. Math. 6, 1980), on the switched Lagrange equations of
 * core/mode/between_events.h: it may be as long as the controller's sample interval. When a stage
 * or the end leaves the mode, somewhere in the interval there is an event. It is not located: the
 * interval is halved, the half without the event is a smooth step again, and once what is left is
 * so short that the accelerations change no velocity by more than the tolerance in it, the implicit
 * law (core/implicit/step.h, theta = 1/2) crosses it, whatever the event is: landing, lift-off,
 * begin, end or turn of a slip, an impact of both feet. An accumulation of bounces, or of impacts
 * that throw up each other's contacts, ends when they are too small to count. Where there is no
 * smooth motion to begin with - a closed contact approaches or hops, several sets of forces fit the
 * laws or none (Painleve), both feet stand redundantly on the edge of their cones - the implicit
 * law takes the interval as long as it can, but not so long that a contact that approaches has left
 * again without having been struck.
 *
 * Error of a smooth step: the embedded estimate, per coordinate and rate. Error of a crossing: one
 * step and two half ones must agree to the tolerance. That alone would not do: with the event in
 * the first half both make the same error in proportion to the time before it, in the second half
 * the one in proportion to the time after it, and a slip that turns looks like one that sticks to
 * both. The bound on the length does not depend on such chance. Jumps that follow each other at one
 * instant (an impact after which sliding feet have no accelerations, Painleve's paradox: then comes
 * another, without a collision) never let the two agree: where there is no smooth motion to begin
 * with, and in the interval nothing moves, the two half steps are taken as they are.
 *
 * What is less than both can tell may go on for ever. Of two feet at one place each may carry what
 * both do: by the implicit law the one that slides has left the ground, at a speed that counts as
 * zero, and goes on sliding; by the accelerations it carries, and stops at once; and time goes on
 * by one crossing after the other, each as short as a bound on the length makes it. After many
 * without a smooth step between there is no smooth motion to begin with either.
 *
 * Tolerances are absolute (m, rad, m/s, rad/s) where no rate is larger than 1, else they are of the
 * largest rate.
 *
 * Each lane has an interval of its own inside its step, so that what a case does depends on nothing
 * but the case.
 */
#define METHOD_THETA 0.5
#define METHOD_STAGES 6
#define METHOD_EMBEDDED

/* Cases may change lanes; a step may be of any length. */
#define ADVANCE_MOVES
#define ADVANCE_PIECES

#include "engine/core/loop/kernel.h"
/* In this order. */
#include STANCE_SCENE_LANES

static const double tableau_c[METHOD_STAGES] = {0, 1.0 / 5, 3.0 / 10, 4.0 / 5, 8.0 / 9, 1};
static const double tableau_a[METHOD_STAGES][METHOD_STAGES] = {
    {0},
    {1.0 / 5},
    {3.0 / 40, 9.0 / 40},
    {44.0 / 45, -56.0 / 15, 32.0 / 9},
    {19372.0 / 6561, -25360.0 / 2187, 64448.0 / 6561, -212.0 / 729},
    {9017.0 / 3168, -355.0 / 33, 46732.0 / 5247, 49.0 / 176, -5103.0 / 18656},
};
static const double tableau_b[METHOD_STAGES] = {35.0 / 384,     0,        500.0 / 1113, 125.0 / 192,
                                                -2187.0 / 6784, 11.0 / 84};
static const double tableau_e[METHOD_STAGES + 1] = {
    71.0 / 57600, 0, -71.0 / 16695, 71.0 / 1920, -17253.0 / 339200, 22.0 / 525, -1.0 / 40};
static const int tableau_dip[METHOD_STAGES] = {0, -1, 1, 2, -1, -1};

// clang-format off
#include "engine/core/mode/explicit.h"
#include "engine/core/mode/standing_step.h"
// clang-format on

#define CAPTURE_SMALLEST 0x1p-40 /* of a step: shorter intervals are not tried */
#define CAPTURE_ATTEMPTS 20000   /* in one step, then the case fails */
#define CAPTURE_INSTANT 0x1p-10  /* of the tolerance: what moves less does not move */
#define CAPTURE_GROWTH 64        /* an error this much smaller than the tolerance: twice as long */
#define CAPTURE_CHATTER 256      /* crossings without a smooth step between: no events */
#define CAPTURE_WAIT 16          /* attempts until a standing step is tried a third time */

/* Where each lane is inside its step. */
struct advance {
    lanes tolerance;
    lanes done; /* s, of the step */
    lanes part; /* s, next smooth step or, in a hunt, the interval that holds the event; 0: all */
    lanes hunting;         /* 1: an event is known to lie within `part` ... */
    lanes attempts;        /* in this step */
    lanes crossings;       /* in this step since the last smooth one */
    lanes stood[CONTACTS]; /* see between_mode */
    lanes near;            /* 1: a standing step has to be watched, see inside_near */
    lanes ordinary;        /* 1: the last step was a standing one */
    lanes wait;            /* attempts in which none is tried ... */
    lanes turns;           /* ... and such steps since the sines were computed anew */
    struct step_report sum;
};

static void advance_load(struct advance *a, int lane, const stance_case *c)
{
    lane_clear(a, sizeof *a, lane);
    lane_set(&a->tolerance, lane, c->tolerance);
    lane_set(&a->part, lane, INFINITY);
    lane_set(&a->near, lane, 1);
    report_clear_lane(&a->sum, lane);
}
static void advance_forget(struct advance *a, mask m)
{
    for (int i = 0; i < OWN_CONTACTS; i++)
        a->stood[i] = choose(m, lanes_of(0), a->stood[i]);
    a->near = choose(m, lanes_of(1), a->near);
}
#define ADVANCE_WATCHES
HOT void advance_watch(struct advance *a, mask m, mask near)
{
    a->near = choose(m, lanes_where(near), a->near);
}

/* What happens in a step that ends in *to, between its ends. */
COLD void capture_inside(const struct step *step, const struct motion *to, mask where,
                         struct step_report *report)
{
    const struct motion *const from = step->from;
    const struct inside_way way = {
        step->set, {from->s, to->s}, {from->w, to->w}, {&from->trig, &to->trig}, from->t, step->h};
    inside_watch(&way, where, report);
}

/* Lanes where a contact that may meet the ground within h is fast enough to rebound: faster than
 * after a fall from BETWEEN_LOWEST. */
static inline mask capture_rebounds(const struct setting *set, const struct motion *now, lanes h,
                                    lanes acceleration)
{
    const lanes slow = 2 * lanes_max(acceleration, lanes_of(STANCE_GRAVITY)) * BETWEEN_LOWEST;
    mask fast = MASK_NONE;
    for (int c = 0; c < OWN_CONTACTS; c++) {
        const mask near =
            mask_less_equal(now->gap[c], lanes_of(1e-9) + 2 * h * lanes_abs(now->approach[c]));
        fast |= near & mask_less(lanes_of(0), set->may_touch[c]) &
                mask_less(now->approach[c], lanes_of(0)) &
                mask_less(slow, now->approach[c] * now->approach[c]);
    }
    return fast;
}

/* Lanes where every closed contact that approaches got an impulse. */
static inline mask capture_strikes(const struct setting *set, const struct motion *now,
                                   const struct step_report *report)
{
    mask lost = MASK_NONE;
    for (int c = 0; c < OWN_CONTACTS; c++)
        lost |= motion_closed(set, now->gap, c) &
                mask_less(now->approach[c], lanes_of(-BETWEEN_REST)) &
                mask_less_equal(report->impulse[c][0], lanes_of(0));
    return LANES_NOT(lost);
}

/* What a crossing is judged by. */
struct capture_bounds {
    lanes tolerance, acceleration;
    mask brief;   /* no velocity changes by more than the tolerance ... */
    mask instant; /* ... and nothing moves */
};

/* An interval by the implicit law, in one step and in two. *next and *report are those of the two;
 * returns the lanes where both agree to the tolerance, or nothing moves. */
static inline mask capture_implicit(const struct step *interval, const lanes *stood, mask run,
                                    const struct capture_bounds *bounds, struct motion *next,
                                    struct step_report *report)
{
    const struct setting *const set = interval->set;
    const struct motion *const now = interval->from;
    struct motion here = *now;
    motion_energy(set, &here);
    for (int c = 0; c < OWN_CONTACTS; c++) { /* any impulse of a contact that stands, or none */
        here.impulse[c][0] = stood[c];
        here.impulse[c][1] = lanes_of(0);
    }
    struct motion coarse = here, middle = here;
    struct step_report whole, half;
    struct setting law = *set;
    const mask rebounds = capture_rebounds(set, now, interval->h, bounds->acceleration);
    for (int c = 0; c < OWN_CONTACTS; c++)
        law.restitution[c] = choose(rebounds, set->restitution[c], lanes_of(0));
    report_clear(report);
    *next = *now;
    struct step step = *interval;
    step.set = &law, step.from = &here;
    mask good = take_step(&step, run, &coarse, &whole);
    step.h = 0.5 * interval->h;
    good &= take_step(&step, good, &middle, &half);
    good &= bounds->brief | (capture_strikes(set, now, &whole) & capture_strikes(set, now, &half));
    report_add(report, &half);
    *next = middle;
    step.from = &middle;
    good &= take_step(&step, good, next, &half);
    report_add(report, &half);
    report->evaluations += whole.evaluations;
    lanes position = lanes_of(0), rate = lanes_of(0);
    for (int i = 0; i < SCENE_COORDINATES; i++) {
        position = lanes_max(lanes_abs(next->s[i] - coarse.s[i]), position);
        rate = lanes_max(lanes_abs(next->w[i] - coarse.w[i]), rate);
    }
    return good & (bounds->instant | mask_less_equal(lanes_max(rate, position), bounds->tolerance));
}

/* Adds an attempt to the step's report: all of it where it was taken, its cost where it was not. */
static inline void capture_add(struct advance *a, mask taken, mask tried,
                               const struct step_report *part)
{
    report_add_where(taken, &a->sum, part);
    const mask wasted = tried & LANES_NOT(taken);
    a->sum.evaluations += choose(wasted, part->evaluations, lanes_of(0));
    a->sum.iterations += choose(wasted, part->iterations, lanes_of(0));
}

/* Smooth motion over an interval in the lanes of `try`; *stuck: there is none. Returns the lanes
 * where *step is defined and inside the mode; its error estimate is still to be judged. */
static inline mask capture_smooth(const struct step *asked, mask try, lanes *stood,
                                  struct explicit_step *step, mask *stuck, lanes *acceleration)
{
    const struct setting *const set = asked->set;
    const struct motion *const now = asked->from;
    struct dynamics begin;
    struct contact_state mode;
    struct between_trouble trouble;
    const contact_set touching = between_begin(asked, stood, &begin, &mode, &trouble);
    between_stands(&mode, stood);
    *acceleration = lanes_largest(begin.acceleration, SCENE_COORDINATES, lanes_of(0));
    if (touching)
        between_solve(set, &mode, &begin);
    *acceleration = lanes_largest(begin.acceleration, SCENE_COORDINATES, *acceleration);
    explicit_take(asked, try, &mode, &begin, step);
    step->report.ambiguous_steps =
        choose(trouble.chosen, lanes_of(1), step->report.ambiguous_steps);
    step->report.unranked_steps = lanes_where(trouble.unranked);
    *stuck =
        try & (trouble.impact | trouble.none | trouble.several |
               between_violated(set, &mode, &begin) | between_hops(set, &mode, &begin, now->w));
    return try & LANES_NOT(*stuck | step->violated | step->bad);
}

/* What errors are measured by: the largest rate, at least 1 m/s or rad/s. */
static inline lanes capture_size(const struct motion *now)
{
    return lanes_largest(now->w, SCENE_COORDINATES, lanes_of(1));
}

/* ---- the standing step -----------------------------------------------------------------------*/

/* Lanes of `run` that are at the beginning of a step which may be taken as a whole, with exactly
 * the contacts in `touching` closed, which all stood. */
HOT mask capture_stands(contact_set touching, const struct advance *a, const struct step *step,
                        mask run)
{
    const struct setting *const set = step->set;
    const lanes h = step->h;
    const lanes none = lanes_of(0);
    mask fit = run & mask_less_equal(a->wait, none) & mask_less_equal(a->hunting, none) &
               mask_less_equal(a->done, none) & mask_less_equal(h, a->part) &
               mask_less_equal(h, scene_longest_step(&set->body));
    EACH_CONTACT (c, 0) {
        const mask closed = motion_closed(set, step->from->gap, c);
        fit &= touching >> c & 1 ? closed & mask_less(none, a->stood[c]) : LANES_NOT(closed);
    }
    return fit;
}

/* Tries a standing step in the lanes of `run`; returns those where *next and *report are its. */
PER_SET mask capture_stand(contact_set touching, const struct advance *a, const struct step *step,
                           mask run, struct motion *next, struct step_report *report)
{
    lanes error;
    const mask anew = run & mask_less_equal(lanes_of(TRIG_TURNS), a->turns);
    const mask good = standing_take(touching, step, run, anew, next, report, &error);
    return good & mask_less_equal(error, a->tolerance * capture_size(step->from));
}
/* Such a step was taken in the lanes of m. */
HOT void capture_stood(struct advance *a, mask m)
{
    const mask anew = mask_less_equal(lanes_of(TRIG_TURNS), a->turns);
    a->turns = choose(m, choose(anew, lanes_of(0), a->turns + 1), a->turns);
    a->ordinary = choose(m, lanes_of(1), a->ordinary);
}

/* What it did between its ends, where that may count. */
HOT void capture_watch(const struct advance *a, const struct step *step, const struct motion *next,
                       mask good, struct step_report *report)
{
    const mask watched = good & mask_less(lanes_of(0), a->near);
    if (mask_any(watched))
        capture_inside(step, next, watched, report);
}

/* Compiled for sets of contacts, and for any. */
#define CAPTURE_STAND(name, there, touching)                                                       \
    COLD mask capture_##name(const struct advance *a, const struct step *step, mask run,           \
                             struct motion *next, struct step_report *report)                      \
    {                                                                                              \
        return (there) ? capture_stand(touching, a, step, run, next, report) : MASK_NONE;          \
    }
CONTACT_SETS(CAPTURE_STAND)
COLD mask capture_any(contact_set touching, const struct advance *a, const struct step *step,
                      mask run, struct motion *next, struct step_report *report)
{
    return capture_stand(touching, a, step, run, next, report);
}
HOT mask capture_take(contact_set touching, const struct advance *a, const struct step *step,
                      mask run, struct motion *next, struct step_report *report)
{
    const struct step same = *step; /* a copy: what is passed by address has to stay in memory */
#define TRY(name, there, contacts)                                                                 \
    if ((there) && touching == (contacts))                                                         \
        return capture_##name(a, &same, run, next, report);
    CONTACT_SETS(TRY)
#undef TRY
    return capture_any(touching, a, &same, run, next, report);
}

/* One standing step of all lanes; false: it is none in some, and nothing has happened. */
#define ADVANCE_ORDINARY
static bool advance_was_ordinary(const struct advance *a, int lane)
{
    return lane_get(&a->ordinary, lane) > 0;
}
HOT bool advance_ordinary(struct advance *a, const struct step *step, mask live,
                          contact_set touching, struct motion *now, struct step_report *report)
{
    struct motion next;
    if (mask_any(live & LANES_NOT(capture_stands(touching, a, step, live))))
        return false;
    const mask good = capture_take(touching, a, step, live, &next, report);
    if (mask_any(live & LANES_NOT(good)))
        return false;
    capture_watch(a, step, &next, live, report);
    *now = next;
    capture_stood(a, live);
    return true;
}

/* Standing steps in the lanes of `run` where there are such; returns them. */
COLD mask capture_standing(struct advance *a, const struct step *asked, mask run,
                           struct motion *now, struct step_report *report)
{
    mask done = MASK_NONE, tried = MASK_NONE, left = run;
    struct motion from = *now, next;
    struct step step = *asked;
    step.from = &from;
    struct step_report part;
    for (int lane = 0; lane < LANES && mask_any(left); lane++) {
        if (!mask_get(left, lane))
            continue;
        contact_set touching = 0; /* of the lane alone, see mask_any */
        EACH_CONTACT (c, 0)
            if (lane_get(&step.set->may_touch[c], lane) > 0 &&
                lane_get(&from.gap[c], lane) <= STEP_CLOSED)
                touching |= contact_with(c);
        const mask fit = capture_stands(touching, a, &step, left);
        left &= LANES_NOT(fit | mask_of_lane(lane));
        if (!mask_any(fit))
            continue;
        const mask good = capture_take(touching, a, &step, fit, &next, &part);
        capture_watch(a, &step, &next, good, &part);
        choose_all(good, &next, now, sizeof next);
        choose_all(good, &part, report, sizeof part);
        tried |= fit;
        done |= good;
    }
    const mask others = run & LANES_NOT(done);
    const lanes longer =
        choose(mask_less(lanes_of(0), a->ordinary), lanes_of(0), lanes_of(CAPTURE_WAIT));
    const lanes less = lanes_max(a->wait - 1, lanes_of(0));
    a->wait = choose(others, choose(tried, longer, less), a->wait);
    a->ordinary = choose(others, lanes_of(0), a->ordinary);
    capture_stood(a, done);
    return done;
}

/* One attempt in every lane: at a smooth step and, over an interval known to hold an event, at the
 * implicit law. */
static inline mask capture_attempt(struct advance *a, const struct step *whole, mask live,
                                   struct motion *now, struct step_report *report, mask *failed)
{
    const struct setting *const set = whole->set;
    const lanes none = lanes_of(0), h = whole->h;
    const lanes tolerance = a->tolerance * capture_size(now);
    const lanes left = h - a->done;
    const mask hunt = live & mask_less(none, a->hunting);
    const lanes part = choose(hunt, a->part, lanes_min(missed_longest(set, now->w), a->part));
    /* Halves add up to the step but for rounding: what is left of it then is no interval. */
    const lanes interval = choose(mask_less(part, left - CAPTURE_SMALLEST * h), part, left);
    const lanes length = choose(hunt, 0.5 * interval, interval);
    struct explicit_step step;
    mask stuck, crossed = MASK_NONE, arrived = MASK_NONE;
    a->attempts += lanes_where(live);
    lanes acceleration, stood[CONTACTS];
    memcpy(stood, a->stood, sizeof stood);
    struct step part_of = *whole;
    part_of.h = length;
    const mask inside = capture_smooth(&part_of, live, stood, &step, &stuck, &acceleration);
    const mask event = live & LANES_NOT(inside);
    const mask brief = mask_less_equal(acceleration * interval, tolerance);
    const mask chatters = mask_less_equal(lanes_of(CAPTURE_CHATTER), a->crossings);
    const mask cross = hunt & (stuck | brief | chatters);
    if (mask_any(cross)) {
        struct motion next;
        struct step_report over;
        const lanes fastest = lanes_max(acceleration, capture_size(now));
        const struct capture_bounds bounds = {
            tolerance, acceleration, brief,
            stuck & mask_less_equal(fastest * interval, CAPTURE_INSTANT * tolerance)};
        if (whole->coupled) /* a decoupling law is held over the crossing */
            part_of.torque = step.torque;
        part_of.h = interval;
        crossed = capture_implicit(&part_of, a->stood, cross, &bounds, &next, &over);
        over.events = lanes_where(crossed);
        law_integrate(&set->law, crossed, interval, step.integral_rate, next.integral);
        choose_all(crossed, &next, now, sizeof next);
        capture_add(a, crossed, cross, &over);
        arrived = crossed & mask_less_equal(left, interval);
    }
    const mask smooth = live & LANES_NOT(crossed);
    /* What a dip hides in so short a step changes no velocity by more than the tolerance. */
    const mask seen = LANES_NOT(step.dipped) | mask_less_equal(acceleration * length, tolerance);
    const mask good = inside & smooth & seen & mask_less_equal(step.error, tolerance);
    part_of.h = length;
    capture_inside(&part_of, &step.end, good, &step.report);
    choose_all(good, &step.end, now, sizeof step.end);
    capture_add(a, good, live, &step.report);
    for (int c = 0; c < OWN_CONTACTS; c++)
        a->stood[c] = choose(crossed, none, choose(good, stood[c], a->stood[c]));
    a->crossings = choose(crossed, a->crossings + 1, choose(good, none, a->crossings));
    a->done = choose(crossed, a->done + interval, choose(good, a->done + length, a->done));

    /* Next: all of the rest after an event; longer where the error was small; what is left of the
     * interval with the event, or its first half; half as long where the error was too large or
     * something may have passed unseen. */
    const mask on = good & LANES_NOT(hunt);
    const mask easy = mask_less_equal(CAPTURE_GROWTH * step.error, tolerance);
    const lanes longer = lanes_max(choose(easy, 2 * length, length), a->part);
    lanes next = choose(on, longer, choose(good | event, length, 0.5 * length));
    next = choose(crossed, lanes_of(INFINITY), next);
    arrived |= on & mask_less_equal(left, length);
    const mask hunts = smooth & (event | (good & hunt));
    a->part = choose(live, next, a->part);
    a->hunting = choose(live, lanes_where(hunts), a->hunting);
    const mask tired =
        live & LANES_NOT(arrived) & mask_less(lanes_of(CAPTURE_ATTEMPTS), a->attempts);
    *failed = tired | (smooth & LANES_NOT(good) & mask_less(next, CAPTURE_SMALLEST * h));
    *report = a->sum;
    report->failure =
        choose(tired, lanes_of(STANCE_FAILURE_WORK), lanes_of(STANCE_FAILURE_TOLERANCE));
    report->failure = choose(motion_in_range(now, h), report->failure, none);
    report_clear_where(arrived, &a->sum);
    a->done = choose(arrived, none, a->done);
    a->attempts = choose(arrived, none, a->attempts);
    a->crossings = choose(arrived, none, a->crossings);
    return arrived;
}

/* One attempt in every lane, at what is ordinary first. */
static inline mask advance(struct advance *a, const struct step *step, mask live,
                           struct motion *now, struct step_report *report, mask *failed)
{
    struct step_report told;
    report_clear(&told);
    *failed = MASK_NONE;
    const mask stood = capture_standing(a, step, live, now, &told);
    const mask rest = live & LANES_NOT(stood);
    mask arrived = MASK_NONE;
    if (mask_any(rest))
        arrived = capture_attempt(a, step, rest, now, report, failed);
    choose_all(stood, &told, report, sizeof told);
    return arrived | stood;
}

// clang-format off
#include "engine/core/loop/stream.h"
// clang-format on

STANCE_METHOD(capturing) = {
    .name = "capturing",
    .text = "order 4 or 5 between events; the implicit law, refined to tolerance, across them",
    .order_smooth = 5,
    .tolerance = 1e-8,
};

STANCE_KERNEL(capturing);
