/* event_driven.c - the reference: high order between events, every event located to rounding.
 *
 * Between events the switched Lagrange equations of core/mode/between_events.h are integrated by
 * SUNDIALS' ARKODE (Hindmarsh et al., ACM TOMS 31, 2005; Reynolds et al., ACM TOMS 49, 2023) with
 * Verner's explicit Runge-Kutta pair of order 6(5) under error control. A mode lasts while its
 * margins (core/mode/margins.h) are not negative. Time inside the step counts from the step's
 * beginning, so that it resolves more than the positions do.
 *
 * ARKODE's root finder sees a margin that changes its sign from one end of an internal step to the
 * other. What dips and comes back is searched for between the ends, on a polynomial through
 * position, velocity and acceleration; a minimum near zero becomes the end of an internal step
 * itself. The root finder works on an interpolant of order 3: its root is only a first guess. The
 * integration is repeated from the last good state to that time, until the margin there is zero to
 * rounding. Nothing is ever accepted from an interpolant.
 *
 * At an event the state is put back onto the constraints, closed contacts that approach get the
 * impulses of contact.h at once, and the next mode follows from the state (between_mode).
 *
 * Impulses, slip and work are integrated with the motion, under the same error control: a contact
 * that sticks while a force oscillates does not move, but its impulse does.
 *
 * Where there is no unique motion, or rebounds accumulate (Zeno), the case fails; there is no
 * regularisation.
 */
#define METHOD_THETA 0.5 /* read by core/implicit/step.h, whose implicit step is not taken here */
#define ADVANCE_PIECES   /* a step may be of any length */
#define ADVANCE_FREES

#include "engine/core/loop/kernel.h"
/* In this order. */
#include STANCE_SCENE_LANES
// clang-format off
#include "engine/core/mode/margins.h"
// clang-format on

#include <arkode/arkode_erkstep.h>
#include <nvector/nvector_serial.h>
#include <stdlib.h>

#if STANCE_LANES != 1
#error "one case at a time: STANCE_LANES is 1"
#endif
#ifndef SUNDIALS_DOUBLE_PRECISION
#error "SUNDIALS of double precision is needed"
#endif

#define EVENT_LIMIT 1000       /* in one step, then the case fails */
#define EVENT_ATTEMPTS 5000    /* internal steps in one step, beyond 4 times the needed ones */
#define EVENT_TINY 1e-13       /* s: where a shorter internal step fails there is none */
#define EVENT_RESOLUTION 1e-13 /* of the time: of the root finder, 100 roundings */
#define EVENT_LONGEST 1e-3     /* s: no internal step is longer */

/* What is remembered between steps, and what the functions that ARKODE calls see. */
struct advance {
    double tolerance;
    double next;            /* s, internal step to try */
    double stood[CONTACTS]; /* see between_mode */
    struct event_problem problem;
    double attempts, most; /* internal steps in this step; then it fails */
    struct step_report *report;
    /* A step stops after each impact where legs change their parts or footfalls end the case: */
    bool stops, within;      /* ... and is in hand */
    struct event_point here; /* where, */
    struct step_report sum;  /* what it has come to */
    int events;
    SUNContext context;
    void *arkode;
    N_Vector y;
};

enum event_result { EVENT_ON, EVENT_ARRIVED, EVENT_FOUND, EVENT_FAILED };

/* ---- ARKODE: what it calls, how it is made and driven -----------------------------------------*/

static int event_rates(realtype tau, N_Vector y, N_Vector rate, void *data)
{
    struct advance *const a = data;
    const double *const from = NV_DATA_S(y), *const w = from + SCENE_COORDINATES;
    double *const to = NV_DATA_S(rate), sum = 0;
    struct dynamics e;
    event_evaluate(&a->problem, tau, from, &e);
    for (int i = 0; i < SCENE_COORDINATES; i++) {
        to[i] = w[i];
        to[SCENE_COORDINATES + i] = e.acceleration[i];
        sum += e.acceleration[i] + w[i];
    }
    for (int c = 0; c < OWN_CONTACTS; c++) {
        to[EVENT_IMPULSE + 2 * c] = e.force[c][0];
        to[EVENT_IMPULSE + 2 * c + 1] = e.force[c][1];
        to[EVENT_SLIDE + c] =
            contact_unknowns(c) == 2 && contact_part(c, a->problem.mode.contact.closed)
                ? fabs(e.u[c][1])
                : 0;
    }
    for (int i = 0; i < SCENE_ACTUATORS; i++)
        to[EVENT_INTEGRAL + i] = e.integral_rate[i];
    to[EVENT_WORK] =
        motion_work(&a->problem.set->body, 1, a->problem.begin + tau, &e.trig, e.torque, w, w);
    return isfinite(sum) ? 0 : -1;
}

static int event_roots(realtype tau, N_Vector y, realtype *margin, void *data)
{
    struct advance *const a = data;
    struct dynamics e;
    event_evaluate(&a->problem, tau, NV_DATA_S(y), &e);
    event_margins(&a->problem, NV_DATA_S(y), &e, margin);
    return 0;
}

/* Every component alone is held to the tolerance: the norm of ARKODE is a mean square. */
static int event_weights(N_Vector y, N_Vector weight, void *data)
{
    const struct advance *const a = data;
    const double *const v = NV_DATA_S(y), one = sqrt((double)EVENT_SIZE) / a->tolerance;
    double *const out = NV_DATA_S(weight);
    for (int i = 0; i < EVENT_SIZE; i++)
        out[i] = one / (1 + fabs(v[i]));
    for (int i = EVENT_IMPULSE; i < EVENT_SLIDE; i++) {
        const double mobility = a->problem.mode.mobility[(i - EVENT_IMPULSE) / 2];
        out[i] = one * mobility / (1 + mobility * fabs(v[i]));
    }
    out[EVENT_WORK] = one / (a->problem.mode.energy + fabs(v[EVENT_WORK]));
    return 0;
}

static void event_silent(int code, const char *module, const char *function, char *message,
                         void *data)
{
    (void)code, (void)module, (void)function, (void)message, (void)data;
}

/* Verner's 8 stages and a ninth, the derivative at the end, which is the first of the next step.
 * SUNDIALS before 6.7 takes the eighth for it, because it is evaluated at the end's time
 * (LLNL/sundials issue 311): then the order is lost. */
static ARKodeButcherTable event_table(void)
{
    ARKodeButcherTable pair = ARKodeButcherTable_LoadERK(ARKODE_VERNER_8_5_6), table = NULL;
    if (pair)
        table = ARKodeButcherTable_Alloc(pair->stages + 1, SUNTRUE);
    if (table) {
        const int last = pair->stages;
        table->q = pair->q;
        table->p = pair->p;
        for (int i = 0; i < last; i++) {
            for (int j = 0; j < i; j++)
                table->A[i][j] = pair->A[i][j];
            table->A[last][i] = table->b[i] = pair->b[i];
            table->d[i] = pair->d[i];
            table->c[i] = pair->c[i];
        }
        table->c[last] = 1;
    }
    ARKodeButcherTable_Free(pair);
    return table;
}

static void advance_free(struct advance *a)
{
    if (a->arkode)
        ERKStepFree(&a->arkode);
    if (a->y)
        N_VDestroy(a->y);
    if (a->context)
        SUNContext_Free(&a->context);
    a->y = NULL;
    a->context = NULL;
}

/* longest: s, the longest internal step. */
static bool event_create(struct advance *a, double longest)
{
    if (a->arkode)
        return true;
    int falling[EVENT_ROOM];
    for (int k = 0; k < EVENT_MARGINS; k++)
        falling[k] = -1;
    ARKodeButcherTable table = event_table();
    bool good = table && SUNContext_Create(NULL, &a->context) == 0;
    if (good)
        a->y = N_VNew_Serial(EVENT_SIZE, a->context);
    good = good && a->y;
    if (good) {
        N_VConst(0, a->y);
        a->arkode = ERKStepCreate(event_rates, 0, a->y, a->context);
    }
    good = good && a->arkode && ERKStepSetErrHandlerFn(a->arkode, event_silent, NULL) == 0 &&
           ERKStepSetUserData(a->arkode, a) == 0 && ERKStepSetTable(a->arkode, table) == 0 &&
           ERKStepWFtolerances(a->arkode, event_weights) == 0 &&
           ERKStepRootInit(a->arkode, EVENT_MARGINS, event_roots) == 0 &&
           ERKStepSetRootDirection(a->arkode, falling) == 0 &&
           ERKStepSetInterpolantDegree(a->arkode, 3) == 0 &&
           ERKStepSetMaxStep(a->arkode, longest) == 0 &&
           ERKStepSetMaxFirstGrowth(a->arkode, 20) == 0; /* restarts are frequent */
    ARKodeButcherTable_Free(table);
    if (!good)
        advance_free(a);
    return good;
}

/* A case begins with a fresh integrator: what it does depends on nothing but the case. */
static void advance_load(struct advance *a, int lane, const stance_case *c)
{
    (void)lane;
    advance_free(a);
    a->tolerance = c->tolerance;
    a->next = EVENT_LONGEST;
    a->stops = c->follows || c->footfalls > 0 || c->walk_steps > 0 || c->body.plates > 0;
    a->within = false;
    for (int i = 0; i < OWN_CONTACTS; i++)
        a->stood[i] = 0;
}

static void advance_forget(struct advance *a, mask m)
{
    (void)m;
    memset(a->stood, 0, sizeof a->stood);
}

#if SCENE_PLATES
static double advance_done(const struct advance *a, int lane)
{
    (void)lane;
    return a->within ? a->here.tau : 0;
}
/* The integrator is begun anew from wherever it is. */
static void advance_back(struct advance *a, const struct advance *before, mask m)
{
    const struct advance now = *a;
    if (!m)
        return;
    *a = *before;
    a->arkode = now.arkode, a->y = now.y, a->context = now.context;
}
#endif

/* Makes ARKODE start at *from with the internal step `length`, not beyond `target`. */
static bool event_restart(struct advance *a, const struct event_point *from, double target,
                          double length)
{
    memcpy(NV_DATA_S(a->y), from->y, EVENT_SIZE * sizeof(double));
    return ERKStepReset(a->arkode, from->tau, a->y) == 0 &&
           ERKStepSetInitStep(a->arkode, fmin(length, target - from->tau)) == 0 &&
           ERKStepSetStopTime(a->arkode, target) == 0;
}

/* One internal step to *to. EVENT_FOUND: a margin is negative there, *root is about where it
 * vanishes; EVENT_ON: none is, as far as the end can tell. */
static enum event_result event_step(struct advance *a, double target, struct event_point *to,
                                    double *root)
{
    double tau, length;
    if (a->attempts++ > a->most)
        return EVENT_FAILED;
    const int flag = ERKStepEvolve(a->arkode, target, a->y, &tau, ARK_ONE_STEP);
    if (flag < 0)
        return EVENT_FAILED;
    to->tau = *root = tau;
    if (flag == ARK_ROOT_RETURN && (ERKStepGetCurrentTime(a->arkode, &to->tau) != 0 ||
                                    ERKStepGetDky(a->arkode, to->tau, 0, a->y) != 0))
        return EVENT_FAILED;
    memcpy(to->y, NV_DATA_S(a->y), EVENT_SIZE * sizeof(double));
    event_evaluate(&a->problem, to->tau, to->y, &to->e);
    event_margins(&a->problem, to->y, &to->e, to->margin);
    if (flag == ARK_ROOT_RETURN)
        return EVENT_FOUND;
    /* A step that the target cut short says nothing about the next one. */
    if (ERKStepGetCurrentStep(a->arkode, &length) == 0)
        a->next = to->tau + length < (1 - 1e-9) * target ? length : fmax(length, a->next);
    return EVENT_ON;
}

/* ---- from event to event ----------------------------------------------------------------------*/

/* Takes forces and torques of *e down. A command may be beyond its limit by EVENT_CLIP until the
 * mode ends. */
static void event_tell(struct advance *a, const struct dynamics *e)
{
    struct dynamics seen = *e;
    law_clip(&a->problem.set->law, seen.torque);
    inside_tell(&a->problem.mode.contact, &seen, true, a->report);
}

/* Takes down what happens from *p to *to, a state of the same mode, and goes there. */
static void event_pass(struct advance *a, const struct event_point *to, struct event_point *p)
{
    struct event_problem *const problem = &a->problem;
    const struct contact_state *const m = &problem->mode.contact;
    const struct inside_way way = {problem->set,
                                   {p->y, to->y},
                                   {p->y + SCENE_COORDINATES, to->y + SCENE_COORDINATES},
                                   {&p->e.trig, &to->e.trig},
                                   problem->begin + p->tau,
                                   to->tau - p->tau};
    struct inside_values values = {.parabola = true};
    struct inside_peaks peaks;
    struct dynamics e;
    double y[EVENT_SIZE_ROOM] = {0};
    inside_watch(&way, true, a->report);
    event_tell(a, &to->e);
    peaks.count = 0;
    if (way.h >= EVENT_SHORTEST && (problem->coupled || problem->mode.touches)) {
        event_inside_step(problem, p, to, 0.5, y, &e);
        inside_note(&p->e, 0, &values);
        inside_note(&e, 1, &values);
        inside_note(&to->e, 2, &values);
        inside_note(&to->e, 3, &values);
        inside_find(m, problem->mode.touches, problem->coupled, &values, a->report, &peaks);
    }
    for (int k = 0; k < peaks.count; k++)
        if (peaks.high[k]) {
            event_inside_step(problem, p, to, peaks.x[k], y, &e);
            event_tell(a, &e);
        }
    *p = *to;
}

/* Earliest time at which a margin vanishes on a straight line from *low to *high. */
static double event_secant(const struct event_point *low, const struct event_point *high)
{
    double first = high->tau;
    for (int k = 0; k < EVENT_MARGINS; k++)
        if (high->margin[k] < 0)
            first = fmin(high->tau + (high->tau - low->tau) * high->margin[k] /
                                         (low->margin[k] - high->margin[k]),
                         first);
    return first;
}

/* Moves *low, where all margins are kept, to the zero that lies before *high, where one is not;
 * `guess`: about there. EVENT_ON: there was none, *low has moved on. */
static enum event_result event_locate(struct advance *a, struct event_point *low,
                                      struct event_point *high, double guess)
{
    for (int round = 1; round < 100; round++) {
        const double width = high->tau - low->tau;
        /* Or there is no time between. */
        if (event_inside(&a->problem, high) || width <= 4 * DBL_EPSILON * high->tau) {
            event_pass(a, high, low);
            return EVENT_FOUND;
        }
        if (round > 1 && guess > (1 - EVENT_RESOLUTION) * high->tau)
            guess = fmin(guess, event_secant(low, high));
        if (round % 8 == 0 || !(guess > low->tau && guess <= high->tau))
            guess = low->tau + 0.5 * width;
        const double target = guess;
        enum event_result result = EVENT_ON;
        bool fresh = true;
        while (result == EVENT_ON && low->tau < target) {
            struct event_point to;
            if (fresh && !event_restart(a, low, target, target - low->tau))
                return EVENT_FAILED;
            fresh = false;
            result = event_step(a, target, &to, &guess);
            if (result == EVENT_FOUND)
                *high = to;
            else if (result == EVENT_ON)
                event_pass(a, &to, low);
        }
        if (result == EVENT_FAILED)
            return EVENT_FAILED;
        if (event_reached(&a->problem, low, high))
            return EVENT_FOUND;
        if (low->tau >= high->tau)
            return EVENT_ON;
        if (result == EVENT_ON)
            guess = high->tau; /* then the root finder has the shorter interval */
    }
    return EVENT_FAILED;
}

/* Moves *here through the mode to its end or to the end of the step. */
static enum event_result event_march(struct advance *a, struct event_point *here, double end)
{
    double target = end, root;
    bool fresh = true, split = false;
    struct event_point to = *here;
    while (here->tau < end) {
        if (fresh && !event_restart(a, here, target, a->next))
            return EVENT_FAILED;
        fresh = false;
        const enum event_result result = event_step(a, target, &to, &root);
        if (result == EVENT_FAILED) { /* a stage may have been where there is no motion */
            a->next = 0.1 * fmin(a->next, target - here->tau);
            fresh = true;
            if (a->next < EVENT_TINY)
                return EVENT_FAILED;
            continue;
        }
        const double dip = event_dip(&a->problem, here, &to);
        if (dip < (result == EVENT_FOUND ? root : to.tau)) {
            target = dip;
            fresh = true;
            continue;
        }
        if (result == EVENT_FOUND && !split && event_shallow(&a->problem, &to) &&
            root - here->tau > EVENT_SHORTEST) {
            target = here->tau + 0.5 * (root - here->tau);
            fresh = split = true;
            continue;
        }
        if (result == EVENT_FOUND) {
            const double next = a->next;
            const enum event_result located = event_locate(a, here, &to, root);
            a->next = next;
            if (located != EVENT_ON)
                return located;
            fresh = true;
            target = end;
            continue;
        }
        event_pass(a, &to, here);
        a->report->degraded_samples = fmax(here->e.degraded, a->report->degraded_samples);
        a->report->ambiguous_steps = fmax(here->e.several, a->report->ambiguous_steps);
        split &= !event_rise(&a->problem, here);
        if (here->tau >= target)
            target = end, fresh = true;
    }
    return EVENT_ARRIVED;
}

/* ---- modes ------------------------------------------------------------------------------------*/

/* Takes position and velocity of *p into *now with all that follows from them. */
static void event_enter(const struct advance *a, const struct event_point *p, struct motion *now)
{
    for (int i = 0; i < SCENE_COORDINATES; i++) {
        now->s[i] = p->y[i];
        now->w[i] = p->y[SCENE_COORDINATES + i];
    }
    for (int c = 0; c < OWN_CONTACTS; c++) {
        now->gap[c] = p->e.gap[c];
        now->approach[c] = p->e.u[c][0];
    }
    for (int i = 0; i < SCENE_ACTUATORS; i++)
        now->integral[i] = p->y[EVENT_INTEGRAL + i];
    now->trig = p->e.trig;
    now->t = a->problem.begin + p->tau;
}

/* The mode that follows from *p, after the impacts that are due. Returns why there is none. */
static stance_failure event_begin(struct advance *a, struct event_point *p, struct motion *now,
                                  struct step_report *report, bool *impact)
{
    struct event_mode *const m = &a->problem.mode;
    const struct law *const law = &a->problem.set->law;
    *impact = false;
    for (int round = 0; round < 4; round++) {
        const double *const s = p->y, *const w = p->y + SCENE_COORDINATES;
        struct between_trouble trouble;
        bool below = false;
        const contact_set touching = step_touching(a->problem.set, now->gap, LANES_ALL);
        const struct drive drive = {a->problem.torque, a->problem.coupled, NULL};
        const struct state at = {a->problem.begin + p->tau, s, w, p->y + EVENT_INTEGRAL};
        between_evaluate(a->problem.set, &at, &drive, touching, &p->e);
        between_mode(a->problem.set, &p->e, touching, a->stood, &m->contact, &trouble);
        a->problem.evaluations++;
        for (int c = 0; c < OWN_CONTACTS; c++)
            below |= a->problem.set->may_touch[c] > 0 && p->e.gap[c] < -STEP_CLOSED;
        if (trouble.impact || below) {
            if (!between_impact(a->problem.set, true, now, report))
                return STANCE_FAILURE_CONTACT;
            memcpy(p->y, now->s, sizeof now->s);
            memcpy(p->y + SCENE_COORDINATES, now->w, sizeof now->w);
            *impact = true;
            memset(a->stood, 0, sizeof a->stood);
            if (a->stops) /* another leg may stand from now on */
                return STANCE_FAILURE_NONE;
            continue;
        }
        if (trouble.none || trouble.several)
            return STANCE_FAILURE_PAINLEVE;
        report->ambiguous_steps = fmax(trouble.chosen, report->ambiguous_steps);
        report->unranked_steps = fmax(trouble.unranked, report->unranked_steps);
        between_stands(&m->contact, a->stood);
        double command[ACTUATORS];
        law_torque(law, s, w, command);
        for (int i = 0; i < SCENE_ACTUATORS; i++)
            m->clipped[i] = command[i] > law->limit[i] ? 1 : command[i] < -law->limit[i] ? -1 : 0;
        m->touches = contact_any(m->contact.closed, true);
        if (m->touches) /* a slip that has ended leaves what counts as zero */
            between_project(a->problem.set, &m->contact, true, p->y, p->y + SCENE_COORDINATES,
                            &p->e);
        event_evaluate(&a->problem, p->tau, p->y, &p->e);
        event_set_depths(&a->problem, p);
        event_margins(&a->problem, p->y, &p->e, p->margin);
        event_tell(a, &p->e);
        if (*impact && between_hops(a->problem.set, &m->contact, &p->e, p->y + SCENE_COORDINATES))
            return STANCE_FAILURE_EVENTS;
        return event_consistent(&a->problem, p) ? STANCE_FAILURE_NONE : STANCE_FAILURE_PAINLEVE;
    }
    return STANCE_FAILURE_CONTACT;
}

static void event_report(const struct advance *a, const struct event_point *p,
                         struct step_report *report)
{
    for (int c = 0; c < OWN_CONTACTS; c++) {
        report->impulse[c][0] += p->y[EVENT_IMPULSE + 2 * c];
        report->impulse[c][1] += p->y[EVENT_IMPULSE + 2 * c + 1];
        report->slip[c] = p->y[EVENT_SLIDE + c];
        report_residuals(report, c, a->problem.mode.contact.closed, a->problem.set->friction,
                         p->e.force, p->e.u[c]);
    }
    for (int i = 0; i < SCENE_ACTUATORS; i++)
        report->torque[i] = p->e.torque[i];
    report->work = p->y[EVENT_WORK];
}

/* The whole step, or what of it there is up to an impact. */
static inline mask advance(struct advance *a, const struct step *step, mask live,
                           struct motion *now, struct step_report *report, mask *failed)
{
    const double h = step->h;
    report_clear(report);
    a->report = report;
    *failed = false;
    if (!live)
        return false;
    const double longest = fmin(EVENT_LONGEST, scene_longest_step(&step->set->body));
    stance_failure failure =
        event_create(a, longest) ? STANCE_FAILURE_NONE : STANCE_FAILURE_TOLERANCE;
    struct event_point *const here = &a->here;
    if (a->within) {
        *report = a->sum;
    } else {
        memset(here, 0, sizeof *here);
        memcpy(here->y, now->s, sizeof now->s);
        memcpy(here->y + SCENE_COORDINATES, now->w, sizeof now->w);
        for (int i = 0; i < SCENE_ACTUATORS; i++)
            here->y[EVENT_INTEGRAL + i] = now->integral[i];
        a->problem.begin = now->t;
        a->problem.evaluations = a->attempts = a->events = 0;
    }
    a->within = false;
    a->problem.set = step->set;
    a->problem.torque = step->torque;
    a->problem.coupled = step->coupled;
    a->most = EVENT_ATTEMPTS + 4 * h / longest;
    enum event_result result = EVENT_ON;
    for (; failure == STANCE_FAILURE_NONE && result != EVENT_ARRIVED; a->events++) {
        bool impact;
        failure = event_begin(a, here, now, report, &impact);
        report->events += impact && result == EVENT_ON;
        if (failure != STANCE_FAILURE_NONE)
            break;
        if (impact && a->stops) {
            now->t = a->problem.begin + here->tau;
            a->sum = *report;
            a->within = true;
            return false;
        }
        result = event_march(a, here, h);
        if (a->problem.mode.touches) /* put back onto the mode's constraints */
            between_project(step->set, &a->problem.mode.contact, true, here->y,
                            here->y + SCENE_COORDINATES, &here->e);
        event_enter(a, here, now);
        if (result == EVENT_FOUND && event_of_contact(&a->problem, here)) {
            report->events++;
            memset(a->stood, 0, sizeof a->stood);
        }
        if (result == EVENT_FAILED)
            failure = a->attempts > a->most ? STANCE_FAILURE_WORK : STANCE_FAILURE_TOLERANCE;
        else if (a->events >= EVENT_LIMIT)
            failure = STANCE_FAILURE_EVENTS;
    }
    report->evaluations = a->problem.evaluations;
    *failed = failure != STANCE_FAILURE_NONE;
    if (*failed) {
        double sum = 0;
        for (int i = 0; i < SCENE_COORDINATES; i++)
            sum += now->s[i] + now->w[i];
        /* Otherwise the state tells, see bundle_failure. */
        report->failure = isfinite(sum) && motion_in_range(now, h) ? failure : 0;
        return false;
    }
    event_report(a, here, report);
    return true;
}

// clang-format off
#include "engine/core/loop/stream.h"
// clang-format on

STANCE_METHOD(event_driven) = {
    .name = "event-driven",
    .text = "the reference: order 6 between events, every event located to rounding (SUNDIALS)",
    .order_smooth = 6,
    .tolerance = 1e-12,
};

STANCE_KERNEL(event_driven);
