/* sample.h - what a bundle's controllers command at their sampling instants: the law, its noise,
 * the torque limit, the delay; and what comes of it.
 */
#ifndef STANCE_CORE_LOOP_SAMPLE_H
#define STANCE_CORE_LOOP_SAMPLE_H

#include "program.h"

#include <Random123/philox.h>

#define SAMPLE_REST 1e-6 /* m/s: contact velocities below it are zero to a sampled law */

/* Uniform in [-1, 1), keyed as stance.h says: of sampling instant k the `count` numbers of a
 * stream; the noise of torques is stream 0, that of measurements 1. */
static void bundle_noise(const stance_case *c, double instant, uint64_t stream, int count,
                         double *noise)
{
    const philox4x64_key_t key = {{c->seed, stream}};
    philox4x64_ctr_t random = {{0}};
    for (int i = 0; i < count; i++) {
        const philox4x64_ctr_t counter = {
            {c->grid_index, c->sample_index, (uint64_t)instant, (uint64_t)i / 4}};
        if (i % 4 == 0)
            random = philox4x64(counter, key);
        noise[i] = (double)(int64_t)(random.v[i % 4] >> 11) * 0x1p-52 - 1;
    }
}

/* Adds the noise of torques in the lanes of `due`. */
COLD void bundle_shake(const struct bundle *b, mask due, lanes *torque)
{
    double noise[ACTUATORS];
    for (int lane = 0; lane < LANES; lane++) {
        const stance_case *const c = b->which[lane];
        if (!c || c->noise == 0 || !mask_get(due, lane))
            continue;
        bundle_noise(c, lane_get(&b->n, lane) / (double)c->sample_every, 0, SCENE_ACTUATORS, noise);
        SCENE_BEGIN(c);
        for (int i = 0; i < OWN_ACTUATORS; i++)
            lane_set(&torque[i], lane, lane_get(&torque[i], lane) + c->noise * noise[i]);
    }
}

/* What is measured of the present state; noise is on the user's posture and its rates. */
COLD void bundle_measure(const struct bundle *b, mask due, lanes *s, lanes *w, scene_trig *trig)
{
    lanes error[2][POSTURES], shift[2][SCENE_COORDINATES];
    double noise[2 * POSTURES];
    mask noisy = MASK_NONE;
    scene_trig seen;
    memcpy(s, b->now.s, sizeof b->now.s);
    memcpy(w, b->now.w, sizeof b->now.w);
    *trig = b->now.trig;
    memset(error, 0, sizeof error);
    for (int lane = 0; lane < LANES; lane++) {
        const stance_case *const c = b->which[lane];
        if (!c || (c->angle_noise == 0 && c->rate_noise == 0) || !mask_get(due, lane))
            continue;
        SCENE_BEGIN(c);
        noisy |= mask_of_lane(lane);
        bundle_noise(c, lane_get(&b->n, lane) / (double)c->sample_every, 1, 2 * OWN_POSTURE, noise);
        for (int j = 0; j < OWN_POSTURE; j++) {
            lane_set(&error[0][j], lane, c->angle_noise * noise[j]);
            lane_set(&error[1][j], lane, c->rate_noise * noise[OWN_POSTURE + j]);
        }
    }
    if (!mask_any(noisy))
        return;
    for (int kind = 0; kind < 2; kind++)
        scene_of_posture(error[kind], shift[kind]);
    for (int i = 0; i < SCENE_COORDINATES; i++) {
        s[i] = choose(noisy, s[i] + shift[0][i], s[i]);
        w[i] = choose(noisy, w[i] + shift[1][i], w[i]);
    }
    scene_trigonometry(s, &seen);
    choose_all(noisy, &seen, trig, sizeof seen);
}

/* What a law that is not linear commands for what was measured, in the lanes of `due`; the errors
 * that it sums count for the interval that begins. Feet feel what they do. */
static void bundle_decouple(struct bundle *b, mask due, const lanes *s, const lanes *w,
                            const scene_trig *trig, lanes *command)
{
    struct dynamics e;
    struct contact_state contact;
    for (int c = 0; c < OWN_CONTACTS; c++) {
        scene_contact_velocity(&b->set.body, &b->now.trig, c, b->now.w, e.u[c]);
        e.gap[c] = scene_gap(&b->set.body, b->now.s, &b->now.trig, c);
    }
    decoupling_contacts(&b->set, &e, lanes_of(SAMPLE_REST), &contact);
    e.trig = *trig;
    const struct state at = {b->now.t, s, w, b->now.integral};
    const mask servos = law_command(&b->set, due, &at, &contact, &e, command);
    law_integrate(&b->set.law, servos, b->sample_every * b->h, e.integral_rate, b->now.integral);
    b->answer.degraded_samples += choose(servos, e.degraded, lanes_of(0));
    b->answer.ambiguous_steps += choose(servos, e.several, lanes_of(0));
}

/* What programs command for what was measured, in the lanes of `due` where they act; those in which
 * it is of no use. */
COLD mask bundle_program(struct bundle *b, mask due, const lanes *s, const lanes *w,
                         const scene_trig *trig, lanes *torque)
{
    struct program_measured is;
    mask closed[CONTACTS], useless = MASK_NONE;
    program_measure(&b->set, mask_any(due & mask_less(lanes_of(0), b->set.law.switches)), s, w,
                    trig, &is);
    for (int c = 0; c < OWN_CONTACTS; c++) /* feet feel what they do */
        closed[c] = motion_closed(&b->set, b->now.gap, c) &
                    mask_less_equal(lanes_abs(b->now.approach[c]), lanes_of(SAMPLE_REST));
    for (int lane = 0; lane < LANES; lane++) {
        const stance_case *const c = b->which[lane];
        double *const sample = (double *)(uintptr_t)b->program[lane];
        const double *command = NULL;
        if (!c || !c->program || !mask_get(due & LANES_NOT(is.near), lane))
            continue;
        SCENE_BEGIN(c);
        if (sample) {
            program_known(b, lane, sample);
            program_sample(&is, closed, lane, sample);
            command = c->program->act(c->program, c, sample);
        }
        if (!command) {
            useless |= mask_of_lane(lane);
            lane_set(&b->failure, lane, STANCE_FAILURE_PROGRAM);
        }
        for (int i = 0; i < OWN_ACTUATORS; i++)
            lane_set(&torque[i], lane, command ? command[i] : 0);
    }
    return useless;
}

/* Commands of cases that ask for more than a linear law of the present state; those in which a
 * program fails. */
COLD mask bundle_sample_unusual(struct bundle *b, mask due, lanes *torque)
{
    mask useless = MASK_NONE;
    lanes measured[2][SCENE_COORDINATES];
    scene_trig seen;
    const mask delayed = due & mask_less(lanes_of(0), b->delay);
    const bool noisy = bundle_some(b->noisy);
    if (noisy)
        bundle_measure(b, due, measured[0], measured[1], &seen);
    const lanes *const s = noisy ? measured[0] : b->now.s, *const w =
                                                               noisy ? measured[1] : b->now.w;
    const scene_trig *const trig = noisy ? &seen : &b->now.trig;
    law_sampled(&b->set.law, s, w, torque);
    if (mask_any(due & mask_less(lanes_of(0), b->set.law.decouples + b->set.law.switches)))
        bundle_decouple(b, due, s, w, trig, torque);
    if (bundle_some(b->programs))
        useless = bundle_program(b, due, s, w, trig, torque);
    if (noisy)
        bundle_shake(b, due, torque);
    law_clip(&b->set.law, torque);
    for (int i = 0; i < SCENE_ACTUATORS && mask_any(delayed); i++) {
        const lanes now = torque[i];
        torque[i] = choose(delayed, b->pending[0][i], now);
        for (int k = 0; k < STANCE_MAX_DELAY; k++) {
            const mask last = mask_less_equal(lanes_abs(b->delay - (k + 1)), lanes_of(0));
            const lanes next = k + 1 < STANCE_MAX_DELAY ? b->pending[k + 1][i] : now;
            b->pending[k][i] = choose(delayed, choose(last, now, next), b->pending[k][i]);
        }
    }
    for (int i = 0; i < SCENE_ACTUATORS; i++)
        b->actuators.command[i] = choose(due, torque[i], b->actuators.command[i]);
    return useless;
}

/* New torques in the lanes whose sampling instant it is, or whose actuators lag; those in which a
 * program fails. */
HOT mask bundle_sample(struct bundle *b, mask live)
{
    mask useless = MASK_NONE;
    const bool unusual = SCENE_ACTUATORS > 0 && bundle_some(b->unusual);
    const mask due = live & mask_less_equal(b->next_sample, b->n);
    if (mask_any(due)) {
        lanes torque[ACTUATORS];
        if (unusual) {
            useless = bundle_sample_unusual(b, due, torque);
        } else {
            if (bundle_some(b->bending))
                law_sampled(&b->set.law, b->now.s, b->now.w, torque);
            else
                law_torque(&b->set.law, b->now.s, b->now.w, torque);
            law_clip(&b->set.law, torque);
        }
        for (int i = 0; i < SCENE_ACTUATORS; i++)
            b->torque[i] = choose(due, torque[i], b->torque[i]);
        b->next_sample = choose(due, b->next_sample + b->sample_every, b->next_sample);
    }
    const mask lag = live & mask_less(lanes_of(0), b->lags);
    if (unusual && mask_any(lag))
        actuators_follow(&b->actuators, lag, b->n, b->h, b->torque);
    return useless;
}

#endif
