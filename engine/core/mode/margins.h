/* margins.h - what the event-driven method knows of a mode: the equations in it, the margins that
 * tell when it ends, and where between two states a margin may have dipped below zero.
 *
 * A mode lasts while its margins are not negative: the gap of an open contact; the normal force of
 * a closed one; both edges of the cone where it sticks, the slip in its direction where it slides;
 * the room to the torque limit, or beyond it, where the controller acts inside the step. Forces are
 * scaled to accelerations; where a contact slides they must be unique. Margins that a mode starts
 * from zero are shifted by their `depth`, a multiple of what counts as zero: no root is at the
 * beginning of an interval, and the state behind an event is clearly inside the next mode.
 */
#ifndef STANCE_CORE_MODE_MARGINS_H
#define STANCE_CORE_MODE_MARGINS_H

#include "inside.h"

#include <float.h>

#define EVENT_SHORTEST 1e-8 /* s: nothing dips unseen in a step that is shorter */
#define EVENT_FORCE 1e-9    /* of the accelerations: a force may pull, or leave the cone, by this */
#define EVENT_CLIP 1e-10    /* of the torque limit: a command beyond it by this is clipped */
#define EVENT_SLIP 1e-12    /* m/s: a slip this small has ended */
#define EVENT_JAM 1e-6      /* determinant of the forces at which a slide ends */

/* The state that ARKODE integrates: s, w, then what is summed over the step. */
#define EVENT_IMPULSE (2 * SCENE_COORDINATES) /* normal, tangential of each contact, N s */
#define EVENT_SLIDE (EVENT_IMPULSE + 2 * OWN_CONTACTS)
#define EVENT_WORK (EVENT_SLIDE + OWN_CONTACTS)
#define EVENT_INTEGRAL (EVENT_WORK + 1) /* what a law sums */
#define EVENT_SIZE (EVENT_INTEGRAL + SCENE_ACTUATORS)
/* Those of contacts, then those of torque limits. */
#define EVENT_CONTACTS (3 * OWN_CONTACTS)
#define EVENT_MARGINS (EVENT_CONTACTS + 2 * SCENE_ACTUATORS)
enum {
    EVENT_SIZE_ROOM = 2 * SCENE_COORDINATES + 3 * SCENE_CONTACTS + 1 + SCENE_ACTUATORS,
    EVENT_ROOM = SLOTS(3 * SCENE_CONTACTS + 2 * SCENE_ACTUATORS),
    EVENT_SAMPLES = 8, /* parts of an internal step that is searched for dips */
};

struct event_mode {
    struct contact_state contact;
    contact_set touches;                          /* the closed contacts */
    double clipped[ACTUATORS];                    /* -1, 0, 1: the torque is at a limit */
    double depth[EVENT_ROOM], window[EVENT_ROOM]; /* shift; what counts as zero then */
    bool rises[EVENT_ROOM];                       /* a gap or a slip that begins at zero */
    double mobility[CONTACTS];                    /* 1/kg, makes velocities of impulses */
    double energy;                                /* J, what work is measured in */
};

/* The step that is being made, and the mode it is in. */
struct event_problem {
    const struct setting *set;
    const double *torque;
    double begin; /* s, time at the beginning of the step */
    bool coupled;
    struct event_mode mode;
    double evaluations;
};

/* A state inside the step with its margins; the equations are solved in the present mode. */
struct event_point {
    double tau; /* s, of the step */
    double y[EVENT_SIZE_ROOM];
    struct dynamics e;
    double margin[EVENT_ROOM];
};

/* ---- equations and margins of a mode ----------------------------------------------------------*/

/* All closed contacts stick: their forces, which need not be unique (see lane.h), and accelerations
 * with them. */
static void event_hold(const struct setting *set, const struct contact_state *m, struct dynamics *e)
{
    const struct contact_problem problem = {.D = e->D, .uf = e->free, .friction = set->friction};
    struct lane_problem p;
    contact_set closed = 0;
    double r[LANE_ROWS] = {0};
    for (int c = 0; c < OWN_CONTACTS; c++)
        closed |= m->closed[c] ? 1u << c : 0;
    lane_gather(&problem, closed, 0, &p);
    lane_hold(&p, r);
    for (int i = 0; i < p.rows; i++)
        e->force[p.contact[i]][p.axis[i]] = r[i];
    between_push(m->closed, e->response, e->force, e->acceleration);
}

static void event_evaluate(struct event_problem *problem, double tau, const double *y,
                           struct dynamics *e)
{
    const double *const s = y, *const w = y + SCENE_COORDINATES;
    const bool servos = problem->coupled && problem->set->law.decouples > 0;
    double torque[ACTUATORS];
    for (int i = 0; i < SCENE_ACTUATORS; i++)
        torque[i] = problem->torque[i];
    if (problem->coupled && !servos) {
        law_torque(&problem->set->law, s, w, torque);
        for (int i = 0; i < SCENE_ACTUATORS; i++)
            if (problem->mode.clipped[i] != 0)
                torque[i] = problem->mode.clipped[i] * problem->set->law.limit[i];
    }
    const struct drive drive = {torque, servos, &problem->mode.contact};
    const struct state at = {problem->begin + tau, s, w, y + EVENT_INTEGRAL};
    between_evaluate(problem->set, &at, &drive, problem->mode.touches, e);
    const struct contact_state *const m = &problem->mode.contact;
    bool holds = problem->mode.touches;
    for (int c = 0; c < OWN_CONTACTS; c++)
        holds &= m->slide[c] == 0 || !contact_part(c, m->closed);
    if (holds)
        event_hold(problem->set, m, e);
    else if (problem->mode.touches)
        between_solve(problem->set, m, e);
    problem->evaluations++;
}

/* Determinant of the equations for the contact forces, 1 without coupling of contacts and of
 * directions. Where friction at a sliding contact brings it to zero the forces are unbounded or not
 * unique (Painleve). */
static double event_determinant(const struct event_problem *problem, const struct dynamics *e)
{
    const struct contact_state *const state = &problem->mode.contact;
    double m[LANE_ROWS][LANE_ROWS], determinant = 1;
    int of[LANE_ROWS], axis[LANE_ROWS], n = 0;
    for (int c = 0; c < OWN_CONTACTS; c++) {
        const double normal = e->D[c][c][0][0], cross = e->D[c][c][0][1];
        const bool sticks =
            contact_unknowns(c) == 2 && contact_part(c, state->closed) && state->slide[c] == 0;
        if (state->closed[c])
            determinant /= sticks ? normal * e->D[c][c][1][1] - cross * cross : normal;
        else if (sticks)
            determinant /= e->D[c][c][1][1];
        if (state->closed[c])
            of[n] = c, axis[n++] = 0;
        if (sticks)
            of[n] = c, axis[n++] = 1;
    }
    for (int j = 0; j < n; j++) {
        const int g = contact_grip(of[j]);
        const double edge =
            axis[j] == 0 && g >= 0 ? -(problem->set->friction * state->slide[g]) : 0;
        for (int i = 0; i < n; i++) {
            m[i][j] = e->D[of[i]][of[j]][axis[i]][axis[j]];
            if (edge != 0)
                m[i][j] += edge * e->D[of[i]][g][axis[i]][1];
        }
    }
    for (int k = 0; k < n; k++) { /* with the largest pivot of each column */
        int p = k;
        for (int i = k + 1; i < n; i++)
            if (fabs(m[i][k]) > fabs(m[p][k]))
                p = i;
        determinant *= p == k ? m[p][k] : -m[p][k];
        if (m[p][k] == 0)
            return 0;
        for (int j = k; j < n; j++) {
            const double swap = m[k][j];
            m[k][j] = m[p][j], m[p][j] = swap;
        }
        for (int i = k + 1; i < n; i++)
            for (int j = n - 1; j >= k; j--)
                m[i][j] -= m[i][k] / m[k][k] * m[k][j];
    }
    return determinant;
}

/* Does contact c hold friction now? */
static bool event_grips(const struct contact_state *m, int c)
{
    return contact_unknowns(c) == 2 && contact_part(c, m->closed);
}

/* Margins of the contact laws and of the torque limits; 1 where there is none. */
static void event_margins(const struct event_problem *problem, const double *y,
                          const struct dynamics *e, double *margin)
{
    const struct contact_state *const m = &problem->mode.contact;
    for (int k = 0; k < EVENT_MARGINS; k++)
        margin[k] = 1;
    for (int c = 0; c < OWN_CONTACTS; c++) {
        double *const own = &margin[3 * c];
        if (m->closed[c])
            own[0] = e->force[c][0] * e->D[c][c][0][0];
        else
            own[0] = problem->set->may_touch[c] > 0 ? e->gap[c] : 1;
        if (!event_grips(m, c))
            continue;
        const double bound = problem->set->friction * contact_load(c, e->force);
        const double mobility = e->D[c][c][1][1];
        if (problem->set->friction > 0 && m->slide[c] != 0) {
            own[1] = m->slide[c] * e->u[c][1];
            own[2] = event_determinant(problem, e) - 2 * EVENT_JAM;
        } else if (problem->set->friction > 0) {
            own[1] = (bound - e->force[c][1]) * mobility;
            own[2] = (bound + e->force[c][1]) * mobility;
        }
    }
    if (problem->coupled) {
        double command[ACTUATORS];
        law_torque(&problem->set->law, y, y + SCENE_COORDINATES, command);
        for (int i = 0; i < SCENE_ACTUATORS; i++) {
            const double limit = problem->set->law.limit[i];
            double *const own = &margin[EVENT_CONTACTS + 2 * i];
            if (!isfinite(limit))
                continue;
            const double clipped = problem->mode.clipped[i];
            own[0] = clipped != 0 ? clipped * command[i] - limit : limit - command[i];
            own[1] = clipped != 0 ? 1 : limit + command[i];
        }
    }
    for (int k = 0; k < EVENT_MARGINS; k++)
        margin[k] += problem->mode.depth[k];
}

/* Depths and windows of the margins for the mode that begins at *p, with e solved there. */
static void event_set_depths(struct event_problem *problem, const struct event_point *p)
{
    struct event_mode *const m = &problem->mode;
    double raw[EVENT_ROOM], size = 1, scale = 1;
    for (int i = 0; i < SCENE_COORDINATES; i++)
        size = fmax(fabs(p->y[i]), size);
    for (int c = 0; c < OWN_CONTACTS && m->touches; c++)
        for (int i = 0; i < 2; i++)
            scale = fmax(fabs(p->e.free[c][i]), scale);
    for (int k = 0; k < EVENT_MARGINS; k++)
        m->depth[k] = 0;
    event_margins(problem, p->y, &p->e, raw);
    for (int c = 0; c < OWN_CONTACTS; c++) {
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
        }
        if (event_grips(&m->contact, c) && m->contact.slide[c] != 0) {
            rises[1] = raw[3 * c + 1] <= 2 * BETWEEN_REST;
            depth[1] = rises[1] ? BETWEEN_REST : 0;
            window[1] = EVENT_SLIP;
            depth[2] = EVENT_JAM; /* where this ends a mode, none begins */
            window[2] = 0.25 * EVENT_JAM;
        }
        m->mobility[c] = m->contact.closed[c] ? p->e.D[c][c][0][0] : 1;
    }
    for (int k = EVENT_CONTACTS; k < EVENT_MARGINS; k++) {
        const double limit = problem->set->law.limit[(k - EVENT_CONTACTS) / 2];
        m->depth[k] = isfinite(limit) ? EVENT_CLIP * limit : 0;
        m->window[k] = 0.25 * m->depth[k];
        m->rises[k] = false;
    }
    m->energy =
        1 + fabs(scene_energy(&problem->set->body, p->y, p->y + SCENE_COORDINATES, &p->e.trig));
}

/* Is a margin zero at *p that is negative at *beyond? */
static bool event_reached(const struct event_problem *problem, const struct event_point *p,
                          const struct event_point *beyond)
{
    for (int k = 0; k < EVENT_MARGINS; k++)
        if (beyond->margin[k] < 0 && p->margin[k] <= problem->mode.window[k])
            return true;
    return false;
}

/* No margin is negative by more than its window. */
static bool event_inside(const struct event_problem *problem, const struct event_point *p)
{
    for (int k = 0; k < EVENT_MARGINS; k++)
        if (p->margin[k] < -problem->mode.window[k])
            return false;
    return true;
}

/* A mode can begin at *p: what between_mode tolerates is much less than the depths. */
static bool event_consistent(const struct event_problem *problem, const struct event_point *p)
{
    for (int k = 0; k < EVENT_MARGINS; k++)
        if (!problem->mode.rises[k] && p->margin[k] < 0.5 * problem->mode.depth[k])
            return false;
    return event_inside(problem, p);
}

/* Is a margin negative at *p that began at zero and has not been seen to leave it? */
static bool event_shallow(const struct event_problem *problem, const struct event_point *p)
{
    for (int k = 0; k < EVENT_CONTACTS; k++)
        if (p->margin[k] < 0 && problem->mode.rises[k])
            return true;
    return false;
}

/* Margins that began at zero and are well above it at *p: from now on zero is their end. */
static bool event_rise(struct event_problem *problem, struct event_point *p)
{
    bool risen = false;
    for (int k = 0; k < EVENT_CONTACTS; k++) {
        if (!problem->mode.rises[k] || p->margin[k] < 100 * problem->mode.depth[k])
            continue;
        p->margin[k] -= problem->mode.depth[k];
        problem->mode.depth[k] = 0;
        problem->mode.rises[k] = false;
        risen = true;
    }
    return risen;
}

/* Was it a contact, not a torque limit, that ended the mode at *p? */
static bool event_of_contact(const struct event_problem *problem, const struct event_point *p)
{
    for (int k = 0; k < EVENT_CONTACTS; k++)
        if (p->margin[k] <= problem->mode.window[k])
            return true;
    return false;
}

/* ---- between the ends of an internal step -----------------------------------------------------*/

/* Rates of the margins that are gaps and slips; NAN for the others. */
static void event_slopes(const struct event_problem *problem, const double *y,
                         const struct dynamics *e, double *slope)
{
    const struct contact_state *const m = &problem->mode.contact;
    for (int k = 0; k < EVENT_MARGINS; k++)
        slope[k] = NAN;
    for (int c = 0; c < OWN_CONTACTS; c++) {
        double a[2];
        if (!m->closed[c])
            slope[3 * c] = problem->set->may_touch[c] > 0 ? e->u[c][0] : 0;
        if (!event_grips(m, c) || m->slide[c] == 0 || problem->set->friction <= 0)
            continue;
        between_acceleration(problem->set, e, y + SCENE_COORDINATES, c, a);
        slope[3 * c + 1] = m->slide[c] * a[1];
    }
}

/* The state at the fraction x of the internal step, through both ends' positions, velocities and
 * accelerations, and what it leads to. */
static void event_inside_step(struct event_problem *problem, const struct event_point *from,
                              const struct event_point *to, double x, double *y, struct dynamics *e)
{
    const double h = to->tau - from->tau;
    const struct inside_way way = {.s = {from->y, to->y},
                                   .w = {from->y + SCENE_COORDINATES, to->y + SCENE_COORDINATES},
                                   .h = h};
    inside_place(&way, (const double *const[2]){from->e.acceleration, to->e.acceleration}, x, y,
                 y + SCENE_COORDINATES);
    for (int i = EVENT_INTEGRAL; i < EVENT_SIZE; i++)
        y[i] = from->y[i] + x * (to->y[i] - from->y[i]);
    event_evaluate(problem, from->tau + x * h, y, e);
}

/* Margins and their rates there. */
static void event_between(struct event_problem *problem, const struct event_point *from,
                          const struct event_point *to, double x, double *margin, double *slope)
{
    double y[EVENT_SIZE_ROOM] = {0};
    struct dynamics e;
    event_inside_step(problem, from, to, x, y, &e);
    event_margins(problem, y, &e, margin);
    event_slopes(problem, y, &e, slope);
}

/* Where one margin, known at equal distances, dips so low that it may be negative: a fraction of
 * the internal step; INFINITY: nowhere. A sign change that lasts is left to the root finder.
 * slope: differences per distance, NAN where not known. */
static double event_dip_of(const double *g, double *slope)
{
    const int n = EVENT_SAMPLES;
    double low = g[0], high = g[0];
    for (int j = 0; j <= n; j++) {
        low = fmin(g[j], low), high = fmax(g[j], high);
        if (!isnan(slope[j]))
            continue;
        if (j == 0)
            slope[j] = -1.5 * g[0] + 2 * g[1] - 0.5 * g[2];
        else if (j == n)
            slope[j] = 1.5 * g[n] - 2 * g[n - 1] + 0.5 * g[n - 2];
        else
            slope[j] = 0.5 * (g[j + 1] - g[j - 1]);
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
static double event_dip(struct event_problem *problem, const struct event_point *from,
                        const struct event_point *to)
{
    const double h = to->tau - from->tau;
    double g[EVENT_ROOM][EVENT_SAMPLES + 1], rate[EVENT_ROOM][EVENT_SAMPLES + 1];
    double margin[EVENT_ROOM], slope[EVENT_ROOM], first = INFINITY;
    bool near = false;
    if (h < EVENT_SHORTEST)
        return INFINITY;
    event_between(problem, from, to, 0.5, margin, slope);
    for (int k = 0; k < EVENT_MARGINS; k++) {
        const double low = fmin(fmin(from->margin[k], to->margin[k]), margin[k]);
        const double high = fmax(fmax(from->margin[k], to->margin[k]), margin[k]);
        near |= low < high - low;
    }
    if (!near)
        return INFINITY;
    for (int j = 0; j <= EVENT_SAMPLES; j++) {
        const struct event_point *const end = j == 0 ? from : to;
        if (j == 0 || j == EVENT_SAMPLES)
            event_slopes(problem, end->y, &end->e, slope);
        else
            event_between(problem, from, to, (double)j / EVENT_SAMPLES, margin, slope);
        for (int k = 0; k < EVENT_MARGINS; k++) {
            g[k][j] = j == 0 || j == EVENT_SAMPLES ? end->margin[k] : margin[k];
            rate[k][j] = slope[k] * (h / EVENT_SAMPLES);
        }
    }
    for (int k = 0; k < EVENT_MARGINS; k++) {
        const double x = event_dip_of(g[k], rate[k]);
        if (x > 1e-6 && x < 1 - 1e-6)
            first = fmin(from->tau + x * h, first);
    }
    return first;
}

#endif
