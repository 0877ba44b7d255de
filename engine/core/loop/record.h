/* record.h - rows of trajectories, results, and the end of a lane's case. */
#ifndef STANCE_CORE_LOOP_RECORD_H
#define STANCE_CORE_LOOP_RECORD_H

#include "judge.h"

/* Writes the rows that are due at the present step into the trajectory of a lane. */
static void bundle_record(struct bundle *b, int lane)
{
    const stance_case *const c = b->which[lane];
    stance_trajectory *const t = c->trajectory;
    const double n = lane_get(&b->n, lane);
    double s[SCENE_COORDINATES], w[SCENE_COORDINATES];
    double q[SCENE_COORDINATES] = {0}, v[SCENE_COORDINATES] = {0};
    for (int i = 0; i < SCENE_COORDINATES; i++)
        s[i] = lane_get(&b->now.s[i], lane), w[i] = lane_get(&b->now.w[i], lane);
    const double elapsed = (n - lane_get(&b->recorded_at, lane)) * c->step;
    int64_t row = b->row[lane];
    for (; row < t->rows && nearbyint((double)row * t->interval / c->step) <= n; row++) {
        scene_leave(&c->body, s, w, q, v);
        memcpy(t->position + row * OWN_COORDINATES, q, sizeof *q * OWN_COORDINATES);
        memcpy(t->velocity + row * OWN_COORDINATES, v, sizeof *v * OWN_COORDINATES);
        for (int i = 0; i < OWN_ACTUATORS; i++)
            t->torque[row * OWN_ACTUATORS + i] = lane_get(&b->torque[i], lane);
        for (int k = 0; k < OWN_CONTACTS; k++) {
            const double rough = lane_get(&b->set.body.rough[k], lane);
            t->gap[row * OWN_CONTACTS + k] = lane_get(&b->now.gap[k], lane);
            for (int a = 0; a < 2; a++)
                t->force[(row * OWN_CONTACTS + k) * 2 + a] =
                    elapsed > 0 ? (a == 1 ? rough : 1) * lane_get(&b->impulse[k][a], lane) / elapsed
                                : NAN;
        }
    }
    for (int k = 0; k < OWN_CONTACTS; k++)
        lane_set(&b->impulse[k][0], lane, 0), lane_set(&b->impulse[k][1], lane, 0);
    b->row[lane] = row;
    lane_set(&b->recorded_at, lane, n);
    lane_set(&b->next_record, lane,
             row < t->rows ? nearbyint((double)row * t->interval / c->step) : INFINITY);
}

/* There is one NAN only: which one arithmetic gives is the processor's choice. */
static double record_plain(double x)
{
    return x == x ? x : NAN;
}
static double record_number(const lanes *v, int lane)
{
    return record_plain(lane_get(v, lane));
}

/* Of an answer that is gathered; NAN where nothing was. */
static double record_finite(const lanes *v, int lane)
{
    const double x = lane_get(v, lane);
    return isfinite(x) ? x : NAN;
}

/* When a lane has fallen, and by what, counted from 1; of several causes at once the first. */
static void bundle_fall(const struct bundle *b, int lane, stance_result *r)
{
    r->fall_time = lane_get(&b->fell, lane);
    r->fall_cause = (uint8_t)lane_get(&b->fell_by, lane);
    if (r->fall_cause > 0)
        return;
    r->fall_time = r->end_time;
    for (int k = SCENE_CAUSES; k-- > 0;)
        if (mask_get(motion_falls(&b->set, b->now.s, &b->now.trig, k), lane))
            r->fall_cause = (uint8_t)(k + 1);
}

/* Hands a lane's result in and leaves the lane idle. */
COLD void bundle_finish(struct bundle *b, int lane, stance_status status, stance_outcome outcome,
                        stance_failure failure)
{
    stance_result *const r = b->result[lane];
    const stance_case *const c = b->which[lane];
    const double n = record_number(&b->n, lane), h = c->step;
    double s[SCENE_COORDINATES], w[SCENE_COORDINATES];
    const double since = outcome == STANCE_RESTED ? record_number(&b->resting.since, lane)
                                                  : record_number(&b->settled.since, lane);
    const bool calm = outcome == STANCE_RESTED || outcome == STANCE_STABILISED;
    *r = (stance_result){
        .status = status,
        .outcome = outcome,
        .failure = failure,
        .end_time = lane_get(&b->ended, lane) >= 0 ? lane_get(&b->ended, lane) : n * h,
        .settle_time = calm ? (since >= 0 ? since : n) * h : NAN,
        .fall_time = NAN,
        .steps = (int64_t)n,
    };
    if (outcome == STANCE_FELL)
        bundle_fall(b, lane, r);
#define FINISH(name, type, how, told, unit, text)                                                  \
    WHERE_GATHERED_##how(r->name = (type)record_finite(&b->answer.name, lane);)
    STANCE_ANSWERS(FINISH)
    r->excursion = c->has_target ? r->excursion : NAN;
    walk_answer(b, lane, r);
    for (int i = 0; i < SCENE_COORDINATES; i++)
        s[i] = lane_get(&b->now.s[i], lane), w[i] = lane_get(&b->now.w[i], lane);
    scene_leave(&c->body, s, w, r->position, r->velocity);
    for (int i = 0; i < OWN_COORDINATES; i++) {
        r->position[i] = record_plain(r->position[i]);
        r->velocity[i] = record_plain(r->velocity[i]);
    }
    if (c->program)
        c->program->end(c->program, (double *)(uintptr_t)b->program[lane]);
    b->which[lane] = NULL;
    b->live &= LANES_NOT(mask_of_lane(lane));
    b->filled--;
    bundle_count(b, c, -1);
    b->feed->done(b->feed->context, c, r);
}

/* Why a lane could not go on. */
static stance_failure bundle_failure(const struct bundle *b, int lane)
{
    const double reason = lane_get(&b->failure, lane);
    if (reason > 0)
        return (stance_failure)reason;
    double sum = 0;
    for (int i = 0; i < SCENE_COORDINATES; i++)
        sum += lane_get(&b->now.s[i], lane) + lane_get(&b->now.w[i], lane);
    if (!isfinite(sum))
        return STANCE_FAILURE_NOT_FINITE;
    return mask_get(motion_in_range(&b->now, b->h), lane) ? STANCE_FAILURE_NEWTON
                                                          : STANCE_FAILURE_ANGLE;
}

/* Ends the lanes in `over`. */
COLD void bundle_end_lanes(struct bundle *b, mask over, mask failed, const struct verdict *v)
{
    for (int lane = 0; lane < LANES; lane++) {
        if (!b->which[lane] || !mask_get(over, lane))
            continue;
        if (mask_get(failed, lane)) {
            bundle_finish(b, lane, STANCE_FAILED, STANCE_NONE, bundle_failure(b, lane));
            continue;
        }
        stance_outcome outcome = STANCE_UNDECIDED;
        /* Of several that are true the last one of the table holds. */
#define OUTCOME_HOLDS(NAME, name, number, text)                                                    \
    outcome = mask_get(v->name, lane) ? STANCE_##NAME : outcome;
        STANCE_OUTCOMES(OUTCOME_HOLDS)
        bundle_finish(b, lane, STANCE_DONE, outcome, STANCE_FAILURE_NONE);
    }
}

/* Ends the lanes that a verdict or the clock ends. */
HOT void bundle_end(struct bundle *b, mask live, mask failed, const struct verdict *v, mask last)
{
#define OUTCOME_ENDS(NAME, name, number, text) | v->name
    const mask over = failed | last STANCE_OUTCOMES(OUTCOME_ENDS);
    if (mask_any(live & over)) { /* a copy, as in bundle_judge */
        const struct verdict copy = *v;
        bundle_end_lanes(b, live & over, failed, &copy);
    }
}

/* Rows due now in any live lane. */
HOT void bundle_record_due(struct bundle *b, mask live)
{
    const mask due = live & mask_less_equal(b->next_record, b->n);
    if (!bundle_some(b->recorded) || !mask_any(due))
        return;
    for (int lane = 0; lane < LANES; lane++)
        if (b->which[lane] && mask_get(due, lane))
            bundle_record(b, lane);
}

#endif
