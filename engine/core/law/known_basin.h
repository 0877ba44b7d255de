/* known_basin.h - the set of states from which a linear law is known to bring the robot to rest: a
 * case that comes into it has its outcome and need not be simulated further.
 *
 * x = (posture - target, rates) lies in the set when x' M x <= 1. That x is the whole state takes a
 * law without memory and a support foot that stands: then the place and the velocity of everything
 * else follow from x, up to a shift along the ground. What the set rests on is the business of
 * whoever gives M (engine/control/known_basin.c estimates it by simulation).
 */
#ifndef STANCE_CORE_LAW_KNOWN_BASIN_H
#define STANCE_CORE_LAW_KNOWN_BASIN_H

#include "law.h"

#define KNOWN_BASIN_REST 1e-6 /* m, m/s: a foot this close to the ground and this slow stands */

enum { KNOWN_BASIN_STATES = 2 * POSTURES };

struct known_basin {
    lanes on;   /* 1: the case may end in the set */
    lanes last; /* step after which it may not: too little time would be left to settle */
    lanes form[KNOWN_BASIN_STATES][KNOWN_BASIN_STATES]; /* M, lower triangle; twice the entries
                                                         * below the diagonal */
};

/* Only laws whose torques at an instant follow from the state at it alone. */
static bool known_basin_applies(const stance_case *c)
{
    return c->basin_known && c->settle && c->has_target && c->supports && c->delay == 0 &&
           c->lag == 0 && c->torque_rate == 0 && !c->decouples && !c->switches && SCENE_POSTURE > 0;
}

/* Where a state of the kernel stands among the case's; -1: it is none of them. */
static int known_basin_index(int i)
{
    const int of = i % POSTURES;
    return of < OWN_POSTURE ? of + (i < POSTURES ? 0 : OWN_POSTURE) : -1;
}

static void known_basin_load(struct known_basin *basin, int lane, const stance_case *c)
{
    const bool on = known_basin_applies(c);
    lane_set(&basin->on, lane, on);
    lane_set(&basin->last, lane, (double)c->steps - ceil(c->known_basin_time / c->step));
    for (int i = 0; i < 2 * SCENE_POSTURE; i++)
        for (int j = 0; j <= i; j++) {
            const int row = known_basin_index(i), column = known_basin_index(j);
            const bool own = row >= 0 && column >= 0;
            lane_set(&basin->form[i][j], lane,
                     !on   ? INFINITY
                     : own ? (i == j ? 1 : 2) * c->known_basin[row][column]
                           : 0);
        }
}

/* Lanes in the set. */
static inline mask known_basin_contains(const struct known_basin *basin, const lanes *deviation,
                                        const lanes *rate)
{
    lanes x[KNOWN_BASIN_STATES], sum = lanes_of(0);
    for (int i = 0; i < SCENE_POSTURE; i++)
        x[i] = deviation[i], x[SCENE_POSTURE + i] = rate[i];
    for (int i = 0; i < 2 * SCENE_POSTURE; i++) {
        lanes row = basin->form[i][i] * x[i];
        for (int j = 0; j < i; j++)
            row += basin->form[i][j] * x[j];
        sum += row * x[i];
    }
    return mask_less_equal(sum, lanes_of(1));
}

#endif
