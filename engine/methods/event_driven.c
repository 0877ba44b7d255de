/* event_driven.c - the reference: high order between events, every event located to rounding.
 *
 * Between events the switched Lagrange equations of core/smooth.h are integrated by SUNDIALS'
 * ARKODE (Hindmarsh et al., ACM TOMS 31, 2005; Reynolds et al., ACM TOMS 49, 2023) with Verner's
 * explicit Runge-Kutta pair of order 6(5) under error control. A mode lasts while its margins are
 * not negative: the gap of an open contact; the normal force of a closed one; both edges of the
 * cone where it sticks, the slip in its direction where it slides; the room to the torque limit,
 * or beyond it, where the controller acts inside the step. Time inside the step counts from the
 * step's beginning, so that it resolves more than the positions do.
 *
 * ARKODE's root finder sees a margin that changes its sign from one end of an internal step to the
 * other. What dips and comes back is searched for between the ends, on a polynomial through
 * position, velocity and acceleration; a minimum near zero becomes the end of an internal step
 * itself. The root finder works on an interpolant of order 3: its root is only a first guess. The
 * integration is repeated from the last good state to that time, until the margin there is zero to
 * rounding. Nothing is ever accepted from an interpolant.
 *
 * At an event the state is put back onto the constraints, closed contacts that approach get the
 * impulses of contact.h at once, and the next mode follows from the state (smooth_mode). Margins
 * that this starts from zero are shifted by their `depth`, a multiple of what counts as zero, so
 * that no root is at the beginning of an interval and the state behind an event is clearly inside
 * the next mode.
 *
 * Impulses, slip and work are integrated with the motion, under the same error control: a contact
 * that sticks while a force oscillates does not move, but its impulse does.
 *
 * Where there is no unique motion, or rebounds accumulate (Zeno), the case fails; there is no
 * regularisation.
 */
#define METHOD_THETA 0.5 /* read by core/step.h, whose implicit step is not taken here */

#include "../core/kernel.h"
/* In this order. */
#include STANCE_SCENE_LANES
// clang-format off
#include "../core/smooth.h"
// clang-format on

#include <arkode/arkode_erkstep.h>
#include <float.h>
#include <nvector/nvector_serial.h>
#include <stdlib.h>

#if STANCE_LANES != 1
#error "one case at a time: STANCE_LANES is 1"
#endif
#ifndef SUNDIALS_DOUBLE_PRECISION
#error "SUNDIALS of double precision is needed"
#endif

#define EVENT_LIMIT 1000    /* in one step, then the case fails */
#define EVENT_ATTEMPTS 5000 /* internal steps in one step, then the case fails */
#define EVENT_LONGEST 1e-3  /* s: no internal step is longer */
#define EVENT_SHORTEST 1e-7 /* s: nothing dips unseen in a step that is shorter */
#define EVENT_FORCE 1e-9    /* of the accelerations: a force may pull, or leave the cone, by this */
#define EVENT_CLIP 1e-10    /* of the torque limit: a command beyond it by this is clipped */
#define EVENT_SLIP 1e-12    /* m/s: a slip this small has ended */
#define EVENT_SINGULAR 1e-11 /* of the operator's largest element: a pivot that counts as zero */
#define EVENT_LOWEST 1e-11   /* m: rebounds lower than this accumulate */

/* The state that ARKODE integrates: s, w, then what is summed over the step. */
enum {
    EVENT_IMPULSE = 2 * SCENE_COORDINATES, /* normal, tangential of each contact, N s */
    EVENT_SLIDE = EVENT_IMPULSE + 2 * SCENE_CONTACTS,
    EVENT_WORK = EVENT_SLIDE + SCENE_CONTACTS,
    EVENT_SIZE,
    EVENT_MARGINS = 3 * SCENE_CONTACTS + 2 * SCENE_ACTUATORS,
    EVENT_SAMPLES = 8, /* parts of an internal step that is searched for dips */
};

struct event_mode {
    struct contact_state contact;
    bool touches;                                       /* some contact is closed */
    double clipped[ACTUATORS];                          /* -1, 0, 1: the torque is at a limit */
    double depth[EVENT_MARGINS], window[EVENT_MARGINS]; /* shift; what counts as zero then */
    bool rises[EVENT_MARGINS];                          /* a gap or a slip that begins at zero */
    double mobility[SCENE_CONTACTS];                    /* 1/kg, makes velocities of impulses */
    double energy;                                      /* J, what work is measured in */
};

/* What is remembered between steps, and what the functions that ARKODE calls see. */
struct advance {
    double tolerance;
    double next; /* s, internal step to try */
    const struct setting *set;
    const double *torque;
    double begin; /* s, time at the beginning of the step */
    bool coupled;
    struct event_mode mode;
    double evaluations, attempts;
    SUNContext context;
    void *arkode;
    N_Vector y;
};

/* A state inside the step with its margins; the equations are solved in the present mode. */
struct event_point {
    double tau; /* s, of the step */
    double y[EVENT_SIZE];
    struct smooth e;
    double margin[EVENT_MARGINS];
};

enum event_result { EVENT_ON, EVENT_ARRIVED, EVENT_FOUND, EVENT_FAILED };

/* ---- equations and margins of a mode ----------------------------------------------------------*/

/* The null vector of the operator D of both contacts where its rank is 3: forces that only strain
 * the robot, as where both feet stand on one point or both ends of a rod stick. */
static bool event_null(const double D[2][2][2][2], double *n)
{
    double m[4][4], largest = 0;
    int column[4] = {0, 1, 2, 3};
    for (int i = 0; i < 4; i++)
        for (int j = 0; j < 4; j++)
            m[i][j] = D[i / 2][j / 2][i % 2][j % 2];
    for (int k = 0; k < 4; k++) {
        int row = k, pivot = k;
        for (int i = k; i < 4; i++)
            for (int j = k; j < 4; j++)
                if (fabs(m[i][j]) > fabs(m[row][pivot]))
                    row = i, pivot = j;
        if (k == 0)
            largest = fabs(m[row][pivot]);
        if (fabs(m[row][pivot]) <= EVENT_SINGULAR * largest) {
            if (k < 3)
                return false;
            break;
        }
        if (k == 3)
            return false;
        for (int j = 0; j < 4; j++) {
            const double x = m[k][j];
            m[k][j] = m[row][j], m[row][j] = x;
        }
        for (int i = 0; i < 4; i++) {
            const double x = m[i][k];
            m[i][k] = m[i][pivot], m[i][pivot] = x;
        }
        const int c = column[k];
        column[k] = column[pivot], column[pivot] = c;
        for (int i = k + 1; i < 4; i++)
            for (int j = 3; j >= k; j--)
                m[i][j] -= m[i][k] / m[k][k] * m[k][j];
    }
    n[column[3]] = 1;
    for (int i = 2; i >= 0; i--) {
        double sum = -m[i][3];
        for (int j = i + 1; j < 3; j++)
            sum -= m[i][j] * n[column[j]];
        n[column[i]] = sum / m[i][i];
    }
    return true;
}

/* Both contacts stick and their forces are not unique, but the motion is: of all such forces those
 * that keep farthest away from pulling and from the edges of the cones. */
static void event_share(double friction, struct smooth *e)
{
    double n[4], value[6], slope[6], best = -INFINITY, shift = 0;
    if (!event_null((const double(*)[2][2][2])e->D, n))
        return;
    for (int c = 0; c < 2; c++) {
        const double normal = e->D[c][c][0][0], tangential = e->D[c][c][1][1];
        value[3 * c] = normal * e->force[c][0];
        slope[3 * c] = normal * n[2 * c];
        for (int side = 1; side <= 2; side++) {
            const double sign = side == 1 ? -1 : 1;
            value[3 * c + side] = tangential * (friction * e->force[c][0] + sign * e->force[c][1]);
            slope[3 * c + side] = tangential * (friction * n[2 * c] + sign * n[2 * c + 1]);
        }
    }
    for (int j = 0; j < 6; j++)
        for (int k = 0; k < 6; k++) {
            if (slope[j] <= 0 || slope[k] >= 0)
                continue;
            const double x = (value[k] - value[j]) / (slope[j] - slope[k]);
            double low = INFINITY;
            for (int i = 0; i < 6; i++)
                low = fmin(value[i] + slope[i] * x, low);
            if (low > best)
                best = low, shift = x;
        }
    for (int c = 0; c < 2; c++)
        for (int i = 0; i < 2; i++)
            e->force[c][i] += shift * n[2 * c + i];
}

static void event_evaluate(struct advance *a, double tau, const double *y, struct smooth *e)
{
    const double *const s = y, *const w = y + SCENE_COORDINATES;
    double torque[ACTUATORS];
    for (int i = 0; i < SCENE_ACTUATORS; i++)
        torque[i] = a->torque[i];
    if (a->coupled) {
        law_torque(&a->set->law, s, w, torque);
        for (int i = 0; i < SCENE_ACTUATORS; i++)
            if (a->mode.clipped[i] != 0)
                torque[i] = a->mode.clipped[i] * a->set->law.limit;
    }
    smooth_evaluate(a->set, a->begin + tau, s, w, torque, false, a->mode.touches, e);
    const struct contact_state *const m = &a->mode.contact;
    if (a->mode.touches)
        smooth_solve(a->set, m, e);
    if (SCENE_CONTACTS > 1 && m->closed[0] && m->closed[SECOND] && m->slide[0] == 0 &&
        m->slide[SECOND] == 0)
        event_share(a->set->friction, e);
    a->evaluations++;
}

/* Margins of the contact laws and of the torque limits; 1 where there is none. */
static void event_margins(const struct advance *a, const double *y, const struct smooth *e,
                          double *margin)
{
    const struct contact_state *const m = &a->mode.contact;
    for (int k = 0; k < EVENT_MARGINS; k++)
        margin[k] = 1;
    for (int c = 0; c < SCENE_CONTACTS; c++) {
        double *const own = &margin[3 * c];
        if (!m->closed[c]) {
            own[0] = a->set->may_touch[c] > 0 ? e->gap[c] : 1;
            continue;
        }
        const double bound = a->set->friction * e->force[c][0], mobility = e->D[c][c][1][1];
        own[0] = e->force[c][0] * e->D[c][c][0][0];
        if (a->set->friction > 0 && m->slide[c] != 0) {
            own[1] = m->slide[c] * e->u[c][1];
        } else if (a->set->friction > 0) {
            own[1] = (bound - e->force[c][1]) * mobility;
            own[2] = (bound + e->force[c][1]) * mobility;
        }
    }
    if (a->coupled && isfinite(a->set->law.limit)) {
        double command[ACTUATORS];
        const double limit = a->set->law.limit;
        law_torque(&a->set->law, y, y + SCENE_COORDINATES, command);
        for (int i = 0; i < SCENE_ACTUATORS; i++) {
            double *const own = &margin[3 * SCENE_CONTACTS + 2 * i];
            const double clipped = a->mode.clipped[i];
            own[0] = clipped != 0 ? clipped * command[i] - limit : limit - command[i];
            own[1] = clipped != 0 ? 1 : limit + command[i];
        }
    }
    for (int k = 0; k < EVENT_MARGINS; k++)
        margin[k] += a->mode.depth[k];
}

static void event_look(struct advance *a, struct event_point *p)
{
    event_evaluate(a, p->tau, p->y, &p->e);
    event_margins(a, p->y, &p->e, p->margin);
}

/* Depths and windows of the margins for the mode that begins at *p, with e solved there. */
static void event_set_depths(struct advance *a, const struct event_point *p)
{
    struct event_mode *const m = &a->mode;
    double raw[EVENT_MARGINS], size = 1, scale = 1;
    for (int i = 0; i < SCENE_COORDINATES; i++)
        size = fmax(fabs(p->y[i]), size);
    for (int c = 0; c < SCENE_CONTACTS && m->touches; c++)
        for (int i = 0; i < 2; i++)
            scale = fmax(fabs(p->e.free[c][i]), scale);
    for (int k = 0; k < EVENT_MARGINS; k++)
        m->depth[k] = 0;
    event_margins(a, p->y, &p->e, raw);
    for (int c = 0; c < SCENE_CONTACTS; c++) {
        double *const depth = &m->depth[3 * c], *const window = &m->window[3 * c];
        bool *const rises = &m->rises[3 * c];
        for (int i = 0; i < 3; i++) {
            depth[i] = EVENT_FORCE * scale, window[i] = 0.25 * EVENT_FORCE * scale;
            rises[i] = false;
        }
        if (!m->contact.closed[c]) {
            rises[0] = raw[3 * c] <= 2 * STEP_CLOSED;
            depth[0] = rises[0] ? STEP_CLOSED : 0;
            window[0] = fmin(8 * DBL_EPSILON * size, 0.2 * STEP_CLOSED);
        } else if (m->contact.slide[c] != 0) {
            rises[1] = raw[3 * c + 1] <= 2 * SMOOTH_REST;
            depth[1] = rises[1] ? SMOOTH_REST : 0;
            window[1] = EVENT_SLIP;
        }
        m->mobility[c] = m->contact.closed[c] ? p->e.D[c][c][0][0] : 1;
    }
    for (int k = 3 * SCENE_CONTACTS; k < EVENT_MARGINS; k++) {
        m->depth[k] = isfinite(a->set->law.limit) ? EVENT_CLIP * a->set->law.limit : 0;
        m->window[k] = 0.25 * m->depth[k];
    }
    m->energy = 1 + fabs(scene_energy(&a->set->body, p->y, p->y + SCENE_COORDINATES, &p->e.trig));
}

/* ---- ARKODE: what it calls, how it is made and driven -----------------------------------------*/

static int event_rates(realtype tau, N_Vector y, N_Vector rate, void *data)
{
    struct advance *const a = data;
    const double *const from = NV_DATA_S(y), *const w = from + SCENE_COORDINATES;
    double *const to = NV_DATA_S(rate), sum = 0;
    struct smooth e;
    event_evaluate(a, tau, from, &e);
    for (int i = 0; i < SCENE_COORDINATES; i++) {
        to[i] = w[i];
        to[SCENE_COORDINATES + i] = e.acceleration[i];
        sum += e.acceleration[i] + w[i];
    }
    for (int c = 0; c < SCENE_CONTACTS; c++) {
        to[EVENT_IMPULSE + 2 * c] = e.force[c][0];
        to[EVENT_IMPULSE + 2 * c + 1] = e.force[c][1];
        to[EVENT_SLIDE + c] = a->mode.contact.closed[c] ? fabs(e.u[c][1]) : 0;
    }
    to[EVENT_WORK] = scene_work(&a->set->body, 1, a->begin + tau, e.torque, w);
    return isfinite(sum) ? 0 : -1;
}

static int event_roots(realtype tau, N_Vector y, realtype *margin, void *data)
{
    struct advance *const a = data;
    struct smooth e;
    event_evaluate(a, tau, NV_DATA_S(y), &e);
    event_margins(a, NV_DATA_S(y), &e, margin);
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
        const double mobility = a->mode.mobility[(i - EVENT_IMPULSE) / 2];
        out[i] = one * mobility / (1 + mobility * fabs(v[i]));
    }
    out[EVENT_WORK] = one / (a->mode.energy + fabs(v[EVENT_WORK]));
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

static bool event_create(struct advance *a)
{
    if (a->arkode)
        return true;
    int falling[EVENT_MARGINS];
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
           ERKStepSetMaxStep(a->arkode, EVENT_LONGEST) == 0 &&
           /* As fast as ever: what a case does must not depend on the cases before it. */
           ERKStepSetMaxFirstGrowth(a->arkode, 20) == 0;
    ARKodeButcherTable_Free(table);
    if (!good)
        advance_free(a);
    return good;
}

static void advance_load(struct advance *a, int lane, const stance_case *c)
{
    (void)lane;
    a->tolerance = c->tolerance;
    a->next = EVENT_LONGEST;
}

/* Makes ARKODE start at *from with the internal step `length`, not beyond `target`. */
static bool event_restart(struct advance *a, const struct event_point *from, double target,
                          double length)
{
    memcpy(NV_DATA_S(a->y), from->y, sizeof from->y);
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
    if (a->attempts++ > EVENT_ATTEMPTS)
        return EVENT_FAILED;
    const int flag = ERKStepEvolve(a->arkode, target, a->y, &tau, ARK_ONE_STEP);
    if (flag < 0)
        return EVENT_FAILED; // F
    to->tau = *root = tau;
    if (flag == ARK_ROOT_RETURN && (ERKStepGetCurrentTime(a->arkode, &to->tau) != 0 ||
                                    ERKStepGetDky(a->arkode, to->tau, 0, a->y) != 0))
        return EVENT_FAILED;
    memcpy(to->y, NV_DATA_S(a->y), sizeof to->y);
    event_look(a, to);
    if (flag == ARK_ROOT_RETURN)
        return EVENT_FOUND;
    /* A step that the target cut short says nothing about the next one. */
    if (ERKStepGetCurrentStep(a->arkode, &length) == 0)
        a->next = to->tau + length < (1 - 1e-9) * target ? length : fmax(length, a->next);
    return EVENT_ON;
}

/* ---- between the ends of an internal step -----------------------------------------------------*/

/* Margins at the fraction x of the internal step: position through both ends' positions,
 * velocities and accelerations, velocity through both ends' velocities and accelerations. */
static void event_between(struct advance *a, const struct event_point *from,
                          const struct event_point *to, double x, double *margin)
{
    const double h = to->tau - from->tau, x2 = x * x, x3 = x2 * x;
    double y[EVENT_SIZE] = {0};
    struct smooth e;
    for (int i = 0; i < SCENE_COORDINATES; i++) {
        const double v0 = from->y[SCENE_COORDINATES + i], v1 = to->y[SCENE_COORDINATES + i];
        const double a0 = from->e.acceleration[i], a1 = to->e.acceleration[i];
        const double d0 = to->y[i] - from->y[i] - h * (v0 + 0.5 * h * a0);
        const double d1 = h * (v1 - v0 - h * a0), d2 = h * h * (a1 - a0);
        const double c3 = 10 * d0 - 4 * d1 + 0.5 * d2, c4 = -15 * d0 + 7 * d1 - d2;
        const double c5 = 6 * d0 - 3 * d1 + 0.5 * d2;
        y[i] = from->y[i] + h * x * (v0 + 0.5 * h * x * a0) + x3 * (c3 + x * (c4 + x * c5));
        y[SCENE_COORDINATES + i] =
            v0 + (v1 - v0) * (3 * x2 - 2 * x3) + h * (a0 * (x - 2 * x2 + x3) + a1 * (x3 - x2));
    }
    event_evaluate(a, from->tau + x * h, y, &e);
    event_margins(a, y, &e, margin);
}

/* Where one margin, known at equal distances, dips so low that it may be negative: a fraction of
 * the internal step; INFINITY: nowhere. A sign change that lasts is left to the root finder. */
static double event_dip_of(const double *g)
{
    const int n = EVENT_SAMPLES;
    double slope[EVENT_SAMPLES + 1], low = g[0], high = g[0];
    slope[0] = -1.5 * g[0] + 2 * g[1] - 0.5 * g[2];
    slope[n] = 1.5 * g[n] - 2 * g[n - 1] + 0.5 * g[n - 2];
    for (int j = 0; j <= n; j++) {
        if (j > 0 && j < n)
            slope[j] = 0.5 * (g[j + 1] - g[j - 1]);
        low = fmin(g[j], low), high = fmax(g[j], high);
    }
    for (int j = 0; j < n; j++) {
        if (g[j + 1] < 0)
            return j + 1 < n && g[n] >= 0 ? (double)(j + 1) / n : INFINITY;
        if (slope[j] >= 0 || slope[j + 1] <= 0)
            continue;
        const double x = slope[j] / (slope[j] - slope[j + 1]), x2 = x * x, x3 = x2 * x;
        const double least = g[j] + (g[j + 1] - g[j]) * (3 * x2 - 2 * x3) +
                             slope[j] * (x - 2 * x2 + x3) + slope[j + 1] * (x3 - x2);
        /* Near a real end the value is sure, elsewhere it is interpolated. */
        const bool sure = (j == 0 && x < 0.5) || (j == n - 1 && x > 0.5);
        const double doubt =
            0.5 * (fmin(g[j], g[j + 1]) - least) + (sure ? 0 : 1e-3 * (high - low));
        if (least < doubt)
            return (j + x) / n;
    }
    return INFINITY;
}

/* Time at which a margin may have dipped below zero between two ends; INFINITY: none has. */
static double event_dip(struct advance *a, const struct event_point *from,
                        const struct event_point *to)
{
    const double h = to->tau - from->tau;
    double g[EVENT_MARGINS][EVENT_SAMPLES + 1], middle[EVENT_MARGINS], first = INFINITY;
    bool near = false;
    if (h < EVENT_SHORTEST)
        return INFINITY;
    event_between(a, from, to, 0.5, middle);
    for (int k = 0; k < EVENT_MARGINS; k++) {
        const double low = fmin(fmin(from->margin[k], to->margin[k]), middle[k]);
        const double high = fmax(fmax(from->margin[k], to->margin[k]), middle[k]);
        near |= low < high - low;
    }
    if (!near)
        return INFINITY;
    for (int j = 1; j < EVENT_SAMPLES; j++) {
        event_between(a, from, to, (double)j / EVENT_SAMPLES, middle);
        for (int k = 0; k < EVENT_MARGINS; k++)
            g[k][j] = middle[k];
    }
    for (int k = 0; k < EVENT_MARGINS; k++) {
        g[k][0] = from->margin[k], g[k][EVENT_SAMPLES] = to->margin[k];
        const double x = event_dip_of(g[k]);
        if (x > 1e-6 && x < 1 - 1e-6)
            first = fmin(from->tau + x * h, first);
    }
    return first;
}

/* ---- from event to event ----------------------------------------------------------------------*/

/* Is a margin zero at *p that is negative at *beyond? */
static bool event_reached(const struct advance *a, const struct event_point *p,
                          const struct event_point *beyond)
{
    for (int k = 0; k < EVENT_MARGINS; k++)
        if (beyond->margin[k] < 0 && p->margin[k] <= a->mode.window[k])
            return true;
    return false;
}

/* No margin is negative by more than its window. */
static bool event_inside(const struct advance *a, const struct event_point *p)
{
    for (int k = 0; k < EVENT_MARGINS; k++)
        if (p->margin[k] < -a->mode.window[k])
            return false;
    return true;
}

/* Moves *low, where all margins are kept, to the zero that lies before *high, where one is not;
 * `guess`: about there. EVENT_ON: there was none, *low has moved on. */
static enum event_result event_locate(struct advance *a, struct event_point *low,
                                      struct event_point *high, double guess)
{
    for (int round = 1; round < 100; round++) {
        if (event_inside(a, high)) {
            *low = *high;
            return EVENT_FOUND;
        }
        const double width = high->tau - low->tau;
        if (width <= 4 * DBL_EPSILON * high->tau)
            return EVENT_FAILED;
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
            else
                *low = to;
        }
        if (result == EVENT_FAILED)
            return EVENT_FAILED;
        if (event_reached(a, low, high))
            return EVENT_FOUND;
        if (low->tau >= high->tau)
            return EVENT_ON;
        if (result == EVENT_ON)
            guess = high->tau; /* then the root finder has the shorter interval */
    }
    return EVENT_FAILED;
}

/* Is a margin negative at *p that began at zero and has not been seen to leave it? */
static bool event_shallow(const struct advance *a, const struct event_point *p)
{
    for (int k = 0; k < 3 * SCENE_CONTACTS; k++)
        if (p->margin[k] < 0 && a->mode.rises[k])
            return true;
    return false;
}

/* Margins that began at zero and are well above it at *p: from now on zero is their end. */
static bool event_rise(struct advance *a, struct event_point *p)
{
    bool risen = false;
    for (int k = 0; k < 3 * SCENE_CONTACTS; k++) {
        if (!a->mode.rises[k] || p->margin[k] < 100 * a->mode.depth[k])
            continue;
        p->margin[k] -= a->mode.depth[k];
        a->mode.depth[k] = 0;
        a->mode.rises[k] = false;
        risen = true;
    }
    return risen;
}

/* Moves *here through the mode to its end or to the end of the step. */
static enum event_result event_march(struct advance *a, struct event_point *here, double end)
{
    double target = end, root;
    bool fresh = true, split = false;
    while (here->tau < end) {
        struct event_point to;
        if (fresh && !event_restart(a, here, target, a->next))
            return EVENT_FAILED;
        fresh = false;
        const enum event_result result = event_step(a, target, &to, &root);
        if (result == EVENT_FAILED)
            return EVENT_FAILED;
        const double dip = event_dip(a, here, &to);
        if (dip < (result == EVENT_FOUND ? root : to.tau)) {
            target = dip;
            fresh = true;
            continue;
        }
        if (result == EVENT_FOUND && !split && event_shallow(a, &to) &&
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
        *here = to;
        split &= !event_rise(a, here);
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
    for (int c = 0; c < SCENE_CONTACTS; c++) {
        now->gap[c] = p->e.gap[c];
        now->approach[c] = p->e.u[c][0];
    }
    now->trig = p->e.trig;
    now->t = a->begin + p->tau;
}

/* A contact that leaves the ground and falls back from less than EVENT_LOWEST. */
static bool event_accumulates(const struct advance *a, const struct event_point *p)
{
    for (int c = 0; c < SCENE_CONTACTS; c++) {
        double fall[2], curvature[2];
        if (a->set->may_touch[c] <= 0 || a->mode.contact.closed[c] || p->e.gap[c] > STEP_CLOSED ||
            p->e.u[c][0] <= SMOOTH_REST)
            continue;
        scene_contact_velocity(&a->set->body, &p->e.trig, c, p->e.acceleration, fall);
        scene_contact_curvature(&a->set->body, &p->e.trig, c, p->y + SCENE_COORDINATES, curvature);
        if (p->e.u[c][0] * p->e.u[c][0] < -2 * EVENT_LOWEST * (fall[0] + curvature[0]))
            return true;
    }
    return false;
}

/* The mode that follows from *p, after the impacts that are due. Returns why there is none. */
static stance_failure event_begin(struct advance *a, struct event_point *p, struct motion *now,
                                  struct step_report *report, bool *impact)
{
    struct event_mode *const m = &a->mode;
    const struct law *const law = &a->set->law;
    *impact = false;
    for (int round = 0; round < 4; round++) {
        const double *const s = p->y, *const w = p->y + SCENE_COORDINATES;
        struct smooth_trouble trouble;
        bool below = false;
        const bool touching = smooth_touching(a->set, now->gap);
        smooth_evaluate(a->set, a->begin + p->tau, s, w, a->torque, a->coupled, touching, &p->e);
        smooth_mode(a->set, &p->e, touching, &m->contact, &trouble);
        a->evaluations++;
        for (int c = 0; c < SCENE_CONTACTS; c++)
            below |= a->set->may_touch[c] > 0 && p->e.gap[c] < -STEP_CLOSED;
        if (trouble.impact || below) {
            if (!smooth_impact(a->set, true, now, report))
                return STANCE_FAILURE_CONTACT;
            memcpy(p->y, now->s, sizeof now->s);
            memcpy(p->y + SCENE_COORDINATES, now->w, sizeof now->w);
            *impact = true;
            continue;
        }
        if (trouble.none || trouble.several)
            return STANCE_FAILURE_PAINLEVE;
        double command[ACTUATORS];
        law_torque(law, s, w, command);
        for (int i = 0; i < SCENE_ACTUATORS; i++)
            m->clipped[i] = command[i] > law->limit ? 1 : command[i] < -law->limit ? -1 : 0;
        m->touches = false;
        for (int c = 0; c < SCENE_CONTACTS; c++)
            m->touches |= m->contact.closed[c];
        event_evaluate(a, p->tau, p->y, &p->e);
        event_set_depths(a, p);
        event_margins(a, p->y, &p->e, p->margin);
        if (*impact && event_accumulates(a, p))
            return STANCE_FAILURE_EVENTS;
        return event_inside(a, p) ? STANCE_FAILURE_NONE : STANCE_FAILURE_PAINLEVE;
    }
    return STANCE_FAILURE_CONTACT;
}

/* The last state of a mode is put back onto its constraints. */
static void event_finish(struct advance *a, struct event_point *p, struct motion *now)
{
    if (a->mode.touches)
        smooth_project(a->set, &a->mode.contact, true, p->y, p->y + SCENE_COORDINATES, &p->e);
    event_enter(a, p, now);
}

static void event_report(const struct advance *a, const struct event_point *p,
                         struct step_report *report)
{
    for (int c = 0; c < SCENE_CONTACTS; c++) {
        report->impulse[c][0] += p->y[EVENT_IMPULSE + 2 * c];
        report->impulse[c][1] += p->y[EVENT_IMPULSE + 2 * c + 1];
        report->slip[c] = p->y[EVENT_SLIDE + c];
        report_residuals(report, a->mode.contact.closed[c], a->set->friction, p->e.force[c],
                         p->e.u[c]);
    }
    for (int i = 0; i < SCENE_ACTUATORS; i++)
        report->torque[i] = p->e.torque[i];
    report->work = p->y[EVENT_WORK];
}

/* Was it a contact, not a torque limit, that ended the mode at *p? */
static bool event_of_contact(const struct advance *a, const struct event_point *p)
{
    for (int k = 0; k < 3 * SCENE_CONTACTS; k++)
        if (p->margin[k] <= a->mode.window[k])
            return true;
    return false;
}

/* The whole step. */
static inline mask advance(struct advance *a, const struct setting *set, const lanes *torque,
                           lanes h, mask live, bool coupled, struct motion *now,
                           struct step_report *report, mask *failed)
{
    memset(report, 0, sizeof *report);
    *failed = false;
    if (!live)
        return false;
    stance_failure failure = event_create(a) ? STANCE_FAILURE_NONE : STANCE_FAILURE_TOLERANCE;
    struct event_point here;
    memset(&here, 0, sizeof here);
    memcpy(here.y, now->s, sizeof now->s);
    memcpy(here.y + SCENE_COORDINATES, now->w, sizeof now->w);
    a->set = set;
    a->torque = torque;
    a->begin = now->t;
    a->coupled = coupled;
    a->evaluations = a->attempts = 0;
    enum event_result result = EVENT_ON;
    for (int events = 0; failure == STANCE_FAILURE_NONE && result != EVENT_ARRIVED; events++) {
        bool impact;
        failure = event_begin(a, &here, now, report, &impact);
        report->events += impact && result == EVENT_ON;
        if (failure != STANCE_FAILURE_NONE)
            break;
        result = event_march(a, &here, h);
        event_finish(a, &here, now);
        report->events += result == EVENT_FOUND && event_of_contact(a, &here);
        if (result == EVENT_FAILED)
            failure = STANCE_FAILURE_TOLERANCE;
        else if (events >= EVENT_LIMIT)
            failure = STANCE_FAILURE_EVENTS;
    }
    report->evaluations = a->evaluations;
    *failed = failure != STANCE_FAILURE_NONE;
    if (*failed) {
        double ahead[SCENE_COORDINATES], sum = 0;
        for (int i = 0; i < SCENE_COORDINATES; i++) {
            ahead[i] = now->s[i] + 2 * h * now->w[i];
            sum += now->s[i] + now->w[i];
        }
        /* Otherwise the state tells, see bundle_failure. */
        report->failure = isfinite(sum) && scene_angles_in_range(ahead) ? failure : 0;
        return false;
    }
    event_report(a, &here, report);
    return true;
}

// clang-format off
#include "../core/bundle.h"
// clang-format on

#ifdef STANCE_DESCRIBE_METHOD
const stance_method stance_method_event_driven = {
    .name = "event-driven",
    .text = "the reference: order 6 between events, every event located to rounding (SUNDIALS)",
    .order_smooth = 6,
    .tolerance = 1e-12,
};
#endif

STANCE_KERNEL(event_driven);
