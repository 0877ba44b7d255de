/* walk.h - which footfalls are steps, and when steps are a gait.
 *
 * Feet that clatter on one spot make many footfalls: a step is one that lands a length away from
 * the foot that stood, the same way as the last step, and not at once after it. The state just
 * after a step, legs exchanged where the second one stands and the place along the ground left out,
 * is a point of the return map; where points repeat, one to four steps after, as often as is
 * asked and in the second half of them no less well than in the first, the robot walks. That says
 * what it does, not for ever: a gait that wanders takes more steps to be sure of. What is no step,
 * or not alike, begins the count anew. Where no two steps are alike, as on rough ground, so many of
 * them may be enough.
 *
 * Footfalls are rare: a lane at a time. */
#ifndef STANCE_CORE_LOOP_WALK_H
#define STANCE_CORE_LOOP_WALK_H

#include "bundle.h"

/* Angles and rates of the posture as the user has them, by the leg that stands. */
static void walk_section(const struct bundle *b, int lane, double section[2 * POSTURES])
{
    const stance_case *const c = b->which[lane];
    double s[SCENE_COORDINATES], w[SCENE_COORDINATES], q[SCENE_COORDINATES], v[SCENE_COORDINATES];
    const bool second = lane_get(&b->leg, lane) > 0;
    for (int i = 0; i < SCENE_COORDINATES; i++)
        s[i] = lane_get(&b->now.s[i], lane), w[i] = lane_get(&b->now.w[i], lane);
    scene_leave(&c->body, s, w, q, v);
    for (int j = 0; j < OWN_POSTURE; j++) {
        const int own = c->scene->posture[j];
        const double *const row = c->scene->exchange.coordinate[own];
        section[j] = second ? 0 : q[own], section[OWN_POSTURE + j] = second ? 0 : v[own];
        for (int k = 0; k < OWN_COORDINATES && second; k++) {
            section[j] += row[k] * q[k];
            section[OWN_POSTURE + j] += row[k] * v[k];
        }
    }
}

/* By how much the section is off that of some steps before, in units of what is admitted. */
static double walk_off(const struct walking *w, const stance_case *c, const double *section,
                       int back)
{
    double off = 0;
    for (int j = 0; j < 2 * OWN_POSTURE; j++) {
        const double is = fabs(section[j] - w->section[back - 1][j]);
        off = fmax(off, is / (j < OWN_POSTURE ? c->walk_angle : c->walk_rate));
    }
    return off;
}

#define WALK_SHRINKS 0.99 /* of a difference: it will be less */
#define WALK_FLOOR 0.1    /* of what is admitted: so little may grow, as by a clock that goes on */

/* Whether steps as many back as divide `period` are coming to be alike, too: what alternates on its
 * way to a gait is alike in every second step before it is in each. */
static bool walk_shortens(const struct walking *w, int period, const double *off)
{
    bool shortens = false;
    for (int part = 1; part < period; part++)
        shortens |= period % part == 0 && off[part] < WALK_SHRINKS * w->off[part - 1][period - 1];
    return shortens;
}

/* How the steps so far are alike, with one more, at the time t, at this section. */
static void walk_compare(struct walking *w, const stance_case *c, double t, const double *section)
{
    const double wanted = (double)c->walk_steps;
    double off[WALK_PERIODS + 1];
    w->change = INFINITY;
    for (int period = 1; period <= WALK_PERIODS; period++) {
        off[period] = w->steps > period ? walk_off(w, c, section, period) : INFINITY;
        w->change = fmin(off[period], w->change);
    }
    for (int period = WALK_PERIODS; period > 0; period--) {
        const int k = period - 1;
        const double largest = fmax(w->later[k], off[period]);
        w->alike[k] = off[period] <= 1 ? w->alike[k] + 1 : 0;
        if (w->alike[k] >= wanted && largest > fmax(w->first[k], WALK_FLOOR))
            w->alike[k] = 1; /* it grows: again from here */
        if (w->alike[k] == 1) {
            w->since[k] = t;
            w->first[k] = w->later[k] = 0;
        }
        double *const half = 2 * w->alike[k] <= wanted ? &w->first[k] : &w->later[k];
        *half = fmax(*half, off[period]);
        if (w->alike[k] >= wanted && !walk_shortens(w, period, off)) {
            w->period = period; /* the shortest one last */
            w->settled = w->since[k];
        }
        memmove(&w->off[k][1], w->off[k], sizeof w->off[k] - sizeof w->off[k][0]);
        w->off[k][0] = off[period];
    }
}

/* A step that ends at the time t and a place along the ground. */
static void walk_step(struct bundle *b, int lane, double t, double place)
{
    struct walking *const w = &b->walk[lane];
    const stance_case *const c = b->which[lane];
    double section[2 * POSTURES] = {0};
    w->steps++;
    for (int k = WALK_KEPT; k > 0; k--) {
        w->when[k] = w->when[k - 1];
        w->where[k] = w->where[k - 1];
        w->after[k] = w->after[k - 1];
    }
    w->when[0] = t;
    w->where[0] = place;
    w->after[0] = lane_get(&b->effort, lane);
    walk_section(b, lane, section);
    walk_compare(w, c, t, section);
    memmove(w->section[1], w->section[0], sizeof w->section - sizeof w->section[0]);
    memcpy(w->section[0], section, sizeof section);
    const bool enough = c->walk_enough > 0 && w->steps >= (double)c->walk_enough;
    lane_set(&b->walks, lane, w->period > 0 || enough);
}

/* Contact c, of another foot than the one that stood, is on the ground in the lanes of `where`. */
COLD void walk_footfall(struct bundle *b, mask where, int c)
{
    for (int lane = 0; lane < LANES; lane++) {
        const stance_case *const of = b->which[lane];
        struct walking *const w = &b->walk[lane];
        if (!of || !mask_get(where, lane))
            continue;
        SCENE_BEGIN(of);
        const double t = lane_get(&b->now.t, lane), foot = lane_get(&b->stands, lane);
        double length = 0;
        const lanes here = scene_along(&b->set.body, b->now.s, &b->now.trig, c);
        if (foot >= 0) {
            const lanes there = scene_along(&b->set.body, b->now.s, &b->now.trig, (int)foot);
            length = lane_get(&here, lane) - lane_get(&there, lane);
        }
        const bool on = w->steps == 0 || length * w->length > 0;
        lane_set(&b->stands, lane, c);
        if (of->walk_steps > 0 && on && fabs(length) >= of->walk_length &&
            t - w->last >= of->walk_time) {
            walk_step(b, lane, t, lane_get(&here, lane));
            w->length = length;
        } else {
            memset(w->alike, 0, sizeof w->alike);
        }
        w->last = t;
        if (of->footfalls > 0 && lane_get(&b->answer.footfalls, lane) >= (double)of->footfalls)
            lane_set(&b->ended, lane, t);
    }
}

/* What the actuators have done since the last time, with the torques before and now; within a step
 * (`inside`) with those before, and after that with those at its end alone: there may have been a
 * footfall between. */
HOT void walk_effort(struct bundle *b, mask where, const lanes *torque, bool inside)
{
    if (SCENE_ACTUATORS == 0 || !bundle_some(b->walking))
        return;
    for (int i = 0; i < SCENE_ACTUATORS; i++) {
        const lanes now = scene_actuated(b->now.s, i), moved = now - b->moved[i];
        const lanes before =
            inside ? b->torque[i]
                   : choose(mask_less(lanes_of(0), b->inside), torque[i], b->torque[i]);
        const lanes work = lanes_abs(0.5 * (before + torque[i]) * moved);
        b->effort = choose(where, b->effort + work, b->effort);
        b->moved[i] = choose(where, now, b->moved[i]);
    }
    b->inside = choose(where, lanes_of(inside), b->inside);
}

/* The answers, at the end of a case. */
static void walk_answer(const struct bundle *b, int lane, stance_result *r)
{
    const struct walking *const w = &b->walk[lane];
    const int steps = (int)fmin(w->steps, WALK_KEPT + 1);
    const int period = (int)w->period, whole = period > 0 ? period : 1;
    const int last = (steps - 1) / whole * whole; /* whole periods */
    r->walked_steps = r->gait_period = STANCE_NO_COUNT;
    r->step_time = r->step_length = r->walking_speed = r->cost_of_transport = r->gait_change = NAN;
    if (b->which[lane]->walk_steps <= 0)
        return;
    r->walked_steps = (int64_t)w->steps;
    if (last > 0) {
        r->step_time = (w->when[0] - w->when[last]) / last;
        r->step_length = (w->where[0] - w->where[last]) / last;
        r->walking_speed = r->step_length / r->step_time;
        const double effort = w->after[0] - w->after[last];
        const stance_tree_numbers *const body = &b->which[lane]->body;
        const double weight = body->mass * hypot(body->gravity[0], body->gravity[1]);
        if (b->which[lane]->scene->actuators > 0 && weight > 0)
            r->cost_of_transport = effort / (weight * fabs(r->step_length) * last);
    }
    if (isfinite(w->change))
        r->gait_change = w->change;
    if (period > 0 && r->outcome == STANCE_WALKS)
        r->settle_time = w->settled;
    if (period > 0)
        r->gait_period = period;
}

#endif
