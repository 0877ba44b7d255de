/* actuator.h - what actuators make of what is commanded.
 *
 * An actuator with a time constant and a rate limit follows its command u as
 *
 *   torque' = (u - torque) / lag, but not faster than +-rate.
 *
 * u is constant over a step, so that this is solved exactly: with d = u - torque, first a ramp for
 * (|d| - rate lag) / rate, if that is positive, then d dies out as exp(-t / lag) (at once, without
 * a lag). The mean over the step acts in it: the impulse is exact, places are off by O(h^3) a step.
 * Until the first command, an actuator gives what state feedback commands at its target.
 */
#ifndef STANCE_CORE_LOOP_ACTUATOR_H
#define STANCE_CORE_LOOP_ACTUATOR_H

#include "engine/core/law/law.h"

struct actuators {
    lanes command[ACTUATORS]; /* in force */
    lanes torque[ACTUATORS];  /* N m, at the beginning of step `at` */
    lanes at;
    lanes lag, rate; /* s, N m/s; 0, INFINITY: none */
    lanes left;      /* of a deviation after a whole step */
};

/* exp(x), x <= 0: the same bits on every processor, which libm does not promise. */
static double actuator_exp(double x)
{
    const double parts = nearbyint(x * 1.4426950408889634);
    double r = x - parts * 0x1.62e42feep-1, sum = 1; /* ln 2 in two parts */
    r -= parts * 0x1.a39ef35793c76p-33;
    for (int k = 14; k > 0; k--)
        sum = 1 + r / k * sum;
    return x < -700 ? 0 : ldexp(sum, (int)parts);
}

static bool actuators_lag(const stance_case *c)
{
    return c->lag > 0 || (c->torque_rate > 0 && isfinite(c->torque_rate));
}

/* Torques of the steps of length h that begin at n in the lanes of `live`; those that have begun
 * before keep theirs. */
COLD void actuators_follow(struct actuators *a, mask live, lanes n, lanes h, lanes *torque)
{
    const lanes none = lanes_of(0);
    const mask begins = live & mask_less(a->at, n), instant = mask_less_equal(a->lag, none);
    a->at = choose(begins, n, a->at);
    for (int i = 0; i < SCENE_ACTUATORS; i++) {
        const lanes off = a->command[i] - a->torque[i];
        const lanes beyond = lanes_abs(off) - choose(instant, none, a->rate * a->lag);
        const mask ramps = mask_less(none, beyond);
        const lanes slope = choose(ramps, choose(mask_less(off, none), -a->rate, a->rate), none);
        const lanes t = choose(ramps, lanes_min(h, beyond / a->rate), none), rest = h - t;
        lanes left = a->left;
        for (int lane = 0; lane < LANES; lane++)
            if (mask_get(begins & ramps, lane)) {
                const double time = lane_get(&rest, lane), lag = lane_get(&a->lag, lane);
                lane_set(&left, lane, time > 0 ? (lag > 0 ? actuator_exp(-time / lag) : 0) : 1);
            }
        const lanes d = off - slope * t;
        const lanes impulse = a->torque[i] * t + 0.5 * slope * (t * t) +
                              (a->command[i] * rest - d * a->lag * (1 - left));
        torque[i] = choose(begins, impulse / h, torque[i]);
        a->torque[i] = choose(begins, a->command[i] - d * left, a->torque[i]);
    }
}

#endif
