/* sample.h - what a bundle's controllers command at their sampling instants: the law, its noise,
 * the torque limit, the delay.
 */
#ifndef STANCE_CORE_LOOP_SAMPLE_H
#define STANCE_CORE_LOOP_SAMPLE_H

#include "bundle.h"

#include <Random123/philox.h>

/* Uniform in [-1, 1): actuator i of sampling instant k, keyed as stance.h says. */
static inline double noise_value(uint64_t bits)
{
    return (double)(int64_t)(bits >> 11) * 0x1p-52 - 1;
}
static void bundle_noise(const stance_case *c, double instant, double noise[ACTUATORS])
{
    const philox4x64_key_t key = {{c->seed, 0}};
    philox4x64_ctr_t random = {{0}};
    for (int i = 0; i < SCENE_ACTUATORS; i++) {
        const philox4x64_ctr_t counter = {
            {c->grid_index, c->sample_index, (uint64_t)instant, (uint64_t)i / 4}};
        if (i % 4 == 0)
            random = philox4x64(counter, key);
        noise[i] = c->noise * noise_value(random.v[i % 4]);
    }
}

/* What a law that is not linear commands at a sampling instant, in the lanes of `due`; the errors
 * that it sums count for the interval that begins. */
static void bundle_decouple(struct bundle *b, mask due, lanes *command)
{
    struct dynamics e;
    e.trig = b->now.trig;
    const mask servos =
        law_command(&b->set, due, b->now.t, b->now.s, b->now.w, b->now.integral, NULL, &e, command);
    law_integrate(&b->set.law, servos, b->sample_every * b->h, e.integral_rate, b->now.integral);
    b->answer.degraded_samples += choose(servos, e.degraded, lanes_of(0));
    b->answer.ambiguous_steps += choose(servos, e.several, lanes_of(0));
}

/* New torques in the lanes whose sampling instant it is. */
HOT void bundle_sample(struct bundle *b, mask live)
{
    const mask due = live & mask_less_equal(b->next_sample, b->n);
    if (!mask_any(due))
        return;
    lanes torque[ACTUATORS];
    law_torque(&b->set.law, b->now.s, b->now.w, torque);
    if (SCENE_ACTUATORS > 0 && bundle_some(b->unusual) &&
        mask_any(due & mask_less(lanes_of(0), b->set.law.decouples + b->set.law.switches)))
        bundle_decouple(b, due, torque);
    for (int lane = 0; lane < LANES && bundle_some(b->unusual); lane++) {
        const stance_case *const c = b->which[lane];
        if (!c || c->noise == 0 || !mask_get(due, lane))
            continue;
        double noise[ACTUATORS];
        bundle_noise(c, lane_get(&b->n, lane) / (double)c->sample_every, noise);
        for (int i = 0; i < SCENE_ACTUATORS; i++)
            lane_set(&torque[i], lane, lane_get(&torque[i], lane) + noise[i]);
    }
    law_clip(&b->set.law, torque);
    /* With a delay the command of the sample before comes into force, at the start that of rest. */
    const mask late = due & mask_less(lanes_of(0), b->delayed);
    for (int i = 0; i < SCENE_ACTUATORS; i++) {
        b->torque[i] = choose(due, choose(late, b->pending[i], torque[i]), b->torque[i]);
        b->pending[i] = choose(due, torque[i], b->pending[i]);
    }
    b->next_sample = choose(due, b->next_sample + b->sample_every, b->next_sample);
}

#endif
