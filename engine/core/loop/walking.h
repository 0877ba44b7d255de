/* walking.h - what is kept of a lane's last steps. */
#ifndef STANCE_CORE_LOOP_WALKING_H
#define STANCE_CORE_LOOP_WALKING_H

#include "engine/core/mode/between_events.h"

/* Steps back that a gait may repeat after, and how far back is kept. */
enum { WALK_PERIODS = 4, WALK_KEPT = WALK_PERIODS };

struct walking {
    lanes wanted;           /* steps that are to be alike; 0: nobody asks */
    lanes enough;           /* steps that do, whatever they are like; INFINITY: none */
    lanes foot;             /* contact that stood up to now; -1: none */
    lanes last;             /* s, of the last footfall, be it a step */
    lanes settled;          /* s, since when */
    lanes steps, period;    /* so far; with which they are alike, 0: they are not */
    lanes length;           /* m, of the last one, from foot to foot */
    lanes change;           /* how unlike the last one is to one before; INFINITY: there is none */
    lanes effort;           /* J, sum of |work| of each actuator so far, where ... */
    lanes inside;           /* 1: within a step */
    lanes moved[ACTUATORS]; /* ... these are their places */
    /* Of the last steps, the newest first: when, where, after which effort, with which angles and
     * rates, legs exchanged where the second one stands. */
    lanes when[WALK_KEPT + 1], where[WALK_KEPT + 1], after[WALK_KEPT + 1];
    lanes section[WALK_KEPT][2 * POSTURES];
    /* By period: how many in a row were alike, since when, s; the largest difference of the first
     * half of those that are wanted, and of the others. */
    lanes alike[WALK_PERIODS], since[WALK_PERIODS], first[WALK_PERIODS], later[WALK_PERIODS];
    lanes off[WALK_PERIODS][WALK_KEPT]; /* of the last steps, the newest first, by period */
    lanes ended; /* s, at which the last footfall ended the case; -1: none has */
};

static inline void walking_load(struct walking *w, int lane, const stance_case *c)
{
    lane_clear(w, sizeof *w, lane);
    lane_set(&w->wanted, lane, (double)c->walk_steps);
    lane_set(&w->enough, lane, c->walk_enough > 0 ? (double)c->walk_enough : INFINITY);
    lane_set(&w->foot, lane, -1);
    lane_set(&w->last, lane, -INFINITY);
    lane_set(&w->ended, lane, -1);
    lane_set(&w->change, lane, INFINITY);
}

#endif
