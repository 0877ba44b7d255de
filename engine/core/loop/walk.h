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
static double walk_off(const struct bundle *b, int lane, const double *section, int back)
{
    const stance_case *const c = b->which[lane];
    double off = 0;
    for (int j = 0; j < 2 * OWN_POSTURE; j++) {
        const double is = fabs(section[j] - lane_get(&b->walk.section[back - 1][j], lane));
        off = fmax(off, is / (j < OWN_POSTURE ? c->walk_angle : c->walk_rate));
    }
    return off;
}

#define WALK_SHRINKS 0.99 /* of a difference: it will be less */
#define WALK_FLOOR 0.1    /* of what is admitted: so little may grow, as by a clock that goes on */

/* Whether steps as many back as divide `period` are coming to be alike, too: what alternates on its
 * way to a gait is alike in every second step before it is in each. */
static bool walk_shortens(const struct walking *w, int lane, int period, const double *off)
{
    bool shortens = false;
    for (int part = 1; part < period; part++)
        shortens =
            shortens || (period % part == 0 &&
                         off[part] < WALK_SHRINKS * lane_get(&w->off[part - 1][period - 1], lane));
    return shortens;
}

/* How the steps so far are alike, with one more at this section. */
static void walk_compare(struct walking *w, struct bundle *b, int lane, const double *section)
{
    const double steps = lane_get(&w->steps, lane), wanted = lane_get(&w->wanted, lane);
    double off[WALK_PERIODS + 1], change = INFINITY;
    for (int period = 1; period <= WALK_PERIODS; period++) {
        off[period] = steps > period ? walk_off(b, lane, section, period) : INFINITY;
        change = fmin(off[period], change);
    }
    lane_set(&w->change, lane, change);
    for (int period = WALK_PERIODS; period > 0; period--) {
        const int k = period - 1;
        double alike = lane_get(&w->alike[k], lane);
        double first = lane_get(&w->first[k], lane), later = lane_get(&w->later[k], lane);
        alike = off[period] <= 1 ? alike + 1 : 0;
        if (alike >= wanted && fmax(later, off[period]) > fmax(first, WALK_FLOOR))
            alike = 1; /* it grows: again from here */
        if (alike == 1) {
            lane_set(&w->since[k], lane, lane_get(&b->now.t, lane));
            first = later = 0;
        }
        first = 2 * alike <= wanted ? fmax(first, off[period]) : first;
        later = 2 * alike <= wanted ? later : fmax(later, off[period]);
        if (alike >= wanted && !walk_shortens(w, lane, period, off)) {
            lane_set(&w->period, lane, period); /* the shortest one last */
            lane_set(&w->settled, lane, lane_get(&w->since[k], lane));
        }
        lane_set(&w->alike[k], lane, alike);
        lane_set(&w->first[k], lane, first);
        lane_set(&w->later[k], lane, later);
        for (int i = WALK_KEPT; i-- > 0;)
            lane_set(&w->off[k][i], lane, i > 0 ? lane_get(&w->off[k][i - 1], lane) : off[period]);
    }
}

static void walk_step(struct walking *w, struct bundle *b, int lane, double t, double place)
{
    double section[2 * POSTURES];
    lane_set(&w->steps, lane, lane_get(&w->steps, lane) + 1);
    for (int k = WALK_KEPT; k > 0; k--) {
        lane_set(&w->when[k], lane, lane_get(&w->when[k - 1], lane));
        lane_set(&w->where[k], lane, lane_get(&w->where[k - 1], lane));
        lane_set(&w->after[k], lane, lane_get(&w->after[k - 1], lane));
    }
    lane_set(&w->after[0], lane, lane_get(&w->effort, lane));
    lane_set(&w->when[0], lane, t);
    lane_set(&w->where[0], lane, place);
    walk_section(b, lane, section);
    walk_compare(w, b, lane, section);
    for (int k = WALK_KEPT; k-- > 0;)
        for (int j = 0; j < 2 * OWN_POSTURE; j++)
            lane_set(&w->section[k][j], lane,
                     k > 0 ? lane_get(&w->section[k - 1][j], lane) : section[j]);
}

/* Contact c, of another foot than the one that stood, is on the ground in the lanes of `where`. */
COLD void walk_footfall(struct bundle *b, mask where, int c)
{
    struct walking *const w = &b->walk;
    for (int lane = 0; lane < LANES; lane++) {
        const stance_case *const of = b->which[lane];
        if (!of || !mask_get(where, lane))
            continue;
        SCENE_BEGIN(of);
        const double t = lane_get(&b->now.t, lane), foot = lane_get(&w->foot, lane);
        double length = 0;
        const lanes here = scene_along(&b->set.body, b->now.s, &b->now.trig, c);
        if (foot >= 0) {
            const lanes there = scene_along(&b->set.body, b->now.s, &b->now.trig, (int)foot);
            length = lane_get(&here, lane) - lane_get(&there, lane);
        }
        const bool on = lane_get(&w->steps, lane) == 0 || length * lane_get(&w->length, lane) > 0;
        lane_set(&w->foot, lane, c);
        if (of->walk_steps > 0 && on && fabs(length) >= of->walk_length &&
            t - lane_get(&w->last, lane) >= of->walk_time) {
            walk_step(w, b, lane, t, lane_get(&here, lane));
            lane_set(&w->length, lane, length);
        } else {
            for (int k = 0; k < WALK_PERIODS; k++)
                lane_set(&w->alike[k], lane, 0);
        }
        lane_set(&w->last, lane, t);
        if (of->footfalls > 0 && lane_get(&b->answer.footfalls, lane) >= (double)of->footfalls)
            lane_set(&w->ended, lane, t);
    }
}

/* What the actuators have done since the last time, with the torques before and now; within a step
 * (`inside`) with those before, and after that with those at its end alone: there may have been a
 * footfall between. */
HOT void walk_effort(struct bundle *b, mask where, const lanes *torque, bool inside)
{
    struct walking *const w = &b->walk;
    if (SCENE_ACTUATORS == 0 || !bundle_some(b->walking))
        return;
    for (int i = 0; i < SCENE_ACTUATORS; i++) {
        const lanes now = scene_actuated(b->now.s, i), moved = now - w->moved[i];
        const lanes before =
            inside ? b->torque[i]
                   : choose(mask_less(lanes_of(0), w->inside), torque[i], b->torque[i]);
        const lanes work = lanes_abs(0.5 * (before + torque[i]) * moved);
        w->effort = choose(where, w->effort + work, w->effort);
        w->moved[i] = choose(where, now, w->moved[i]);
    }
    w->inside = choose(where, lanes_of(inside), w->inside);
}

/* The answers, at the end of a case. */
static void walk_answer(const struct bundle *b, int lane, stance_result *r)
{
    const struct walking *const w = &b->walk;
    const int steps = (int)fmin(lane_get(&w->steps, lane), WALK_KEPT + 1);
    const int period = (int)lane_get(&w->period, lane), whole = period > 0 ? period : 1;
    const int last = (steps - 1) / whole * whole; /* whole periods */
    r->walked_steps = r->gait_period = STANCE_NO_COUNT;
    r->step_time = r->step_length = r->walking_speed = r->cost_of_transport = r->gait_change = NAN;
    if (lane_get(&w->wanted, lane) <= 0)
        return;
    r->walked_steps = (int64_t)lane_get(&w->steps, lane);
    if (last > 0) {
        r->step_time = (lane_get(&w->when[0], lane) - lane_get(&w->when[last], lane)) / last;
        r->step_length = (lane_get(&w->where[0], lane) - lane_get(&w->where[last], lane)) / last;
        r->walking_speed = r->step_length / r->step_time;
        const double effort = lane_get(&w->after[0], lane) - lane_get(&w->after[last], lane);
        const stance_tree_numbers *const body = &b->which[lane]->body;
        const double weight = body->mass * hypot(body->gravity[0], body->gravity[1]);
        if (b->which[lane]->scene->actuators > 0 && weight > 0)
            r->cost_of_transport = effort / (weight * fabs(r->step_length) * last);
    }
    if (isfinite(lane_get(&w->change, lane)))
        r->gait_change = lane_get(&w->change, lane);
    if (period > 0 && r->outcome == STANCE_WALKS)
        r->settle_time = lane_get(&w->settled, lane);
    if (period > 0)
        r->gait_period = period;
}

#endif
