/* judge.h - what a bundle takes down after each step, and the outcome rules. */
#ifndef STANCE_CORE_JUDGE_H
#define STANCE_CORE_JUDGE_H

#include "rest.h"

/* Largest values so far, and sums. */
HOT void account_largest(bool all, mask ok, lanes value, lanes *largest)
{
    *largest = choose_unless(all, ok, lanes_max(value, *largest), *largest);
}
HOT void account_sum(bool all, mask ok, lanes value, lanes *sum)
{
    *sum = choose_unless(all, ok, *sum + value, *sum);
}

/* What a step with contacts in `touching` reports of them. */
HOT void account_contacts(struct bundle *b, bool all, mask ok, contact_set touching,
                          const struct step_report *report)
{
    const lanes none = lanes_of(0);
    if (touching) {
        account_largest(all, ok, report->friction, &b->friction_used);
        account_largest(all, ok, report->signorini, &b->signorini);
        account_largest(all, ok, report->coulomb, &b->coulomb);
        account_largest(all, ok, report->dissipation, &b->dissipation);
        account_sum(all, ok, report->projection_energy, &b->projection_energy);
    }
    for (int c = 0; c < SCENE_CONTACTS; c++) {
        const bool here = touching >> c & 1;
        const mask support = ok & mask_less(none, b->mine[c]);
        b->least_normal = choose(
            support, lanes_min(here ? report->least[c] : none, b->least_normal), b->least_normal);
        if (!here)
            continue;
        account_largest(false, ok & mask_less(none, b->set.may_touch[c]), -b->now.gap[c],
                        &b->penetration);
        account_sum(all, ok, report->slip[c], &b->slip);
        for (int a = 0; a < 2 && bundle_some(b->recorded); a++)
            account_sum(all, ok, report->impulse[c][a], &b->impulse[c][a]);
    }
}

/* Takes down a step of the lanes in `ok` (or, `all`, of every lane that runs), contacts in
 * `touching`; `ordinary`: nothing happened in it that happens rarely. */
HOT void bundle_account(struct bundle *b, bool all, mask ok, bool ordinary, contact_set touching,
                        const struct step_report *report)
{
    account_sum(all, ok, lanes_of(1), &b->n);
    b->now.t = choose_unless(all, ok, b->n * b->h, b->now.t);
    account_sum(all, ok, report->iterations, &b->iterations);
    account_sum(all, ok, report->evaluations, &b->evaluations);
    account_sum(all, ok, report->work, &b->energy_bound);
#ifdef ADVANCE_TELLS_ENERGY
    const lanes energy = b->now.energy;
#else
    const lanes energy = scene_energy(&b->set.body, b->now.s, b->now.w, &b->now.trig);
#endif
    account_largest(all, ok, energy - b->energy_bound, &b->energy_gain);
    for (int i = 0; i < SCENE_ACTUATORS; i++)
        account_largest(all, ok, lanes_abs(report->torque[i]), &b->peak_torque);
    account_contacts(b, all, ok, touching, report);
    if (ordinary)
        return;
    account_sum(all, ok, report->events, &b->events);
    account_sum(all, ok, report->ambiguous, &b->ambiguous);
    account_sum(all, ok, report->subdivided, &b->subdivided);
    account_sum(all, ok, report->degraded, &b->degraded);
    account_largest(all, ok, report->impact_energy, &b->impact_energy);
}

/* Advances a window in the lanes of `live`; returns those where it has lasted long enough. */
HOT mask window_advance(struct window *w, mask live, mask holds, lanes measure, lanes n,
                        lanes length)
{
    const mask open = mask_less_equal(lanes_of(0), w->begin);
    if (!mask_any(live & (holds | open)))
        return MASK_NONE;
    const mask full = holds & open & mask_less_equal(length, n - w->begin);
    const mask calm = mask_less_equal(measure, lanes_max(w->measure, lanes_of(BUNDLE_ERROR_FLOOR)));
    const mask restart = live & holds & (LANES_NOT(open) | (full & LANES_NOT(calm)));
    w->begin = choose(restart, n, choose(live & LANES_NOT(holds), lanes_of(-1), w->begin));
    w->measure = choose(restart, measure, w->measure);
    return live & full & calm;
}

struct verdict {
    mask stabilised, rested, fell;
    mask captured; /* will be stabilised */
};

/* The outcome rules at the present state; `loaded`: contacts that carry, of those in `touching`.
 * `last`: time is up. */
HOT struct verdict bundle_judge(struct bundle *b, mask live, contact_set touching,
                                const mask *loaded, mask last)
{
    const lanes none = lanes_of(0), one = lanes_of(1);
    lanes posture[POSTURES], rate[POSTURES], angle = none, speed = none;
    scene_posture(b->now.s, posture);
    scene_posture(b->now.w, rate);
    for (int i = 0; i < SCENE_POSTURE; i++) {
        angle = lanes_max(lanes_abs(posture[i] - b->set.law.linear.target[i]), angle);
        speed = lanes_max(lanes_abs(rate[i]), speed);
    }
    angle = angle * b->angle_scale;
    speed = speed * b->rate_scale;
    mask alone = mask_less(none, b->has_target);
    for (int c = 0; c < SCENE_CONTACTS; c++) {
        const mask mine = mask_less(none, b->mine[c]);
        if (!(touching >> c & 1)) {
            alone &= LANES_NOT(mine);
            continue;
        }
        lanes u[2];
        scene_contact_velocity(&b->set.body, &b->now.trig, c, b->now.w, u);
        const mask stands = loaded[c] & mask_less_equal(lanes_abs(u[1]) * b->rate_scale, one);
        alone &= (mine & stands) | (LANES_NOT(mine) & LANES_NOT(loaded[c]));
    }
    const lanes error = lanes_max(angle, speed);
    const mask at_target = alone & mask_less_equal(error, one);
    /* On the way to the target is not `elsewhere`, however slow. No rate is less than `speed`. */
    mask still = LANES_NOT(alone) & mask_less_equal(speed, one);
    lanes all = none;
    if (mask_any(still & live)) {
        all = scene_largest_rate(&b->set.body, b->now.w, &b->now.trig) * b->rate_scale;
        still &= mask_less_equal(all, one);
    }
    const mask on_way = mask_less(none, b->judge_on_way);
    struct verdict v;
    v.fell = live & scene_fallen(&b->set.body, b->now.s, &b->now.trig, b->fall_height);
    v.stabilised =
        on_way & window_advance(&b->settled, live, at_target, error, b->n, b->settle_steps);
    v.rested = on_way & window_advance(&b->resting, live, still, all, b->n, b->settle_steps);
    const mask at_end = live & last & LANES_NOT(on_way);
    v.stabilised |= at_end & at_target;
    v.rested |= at_end & still;
    if (mask_any(v.rested | v.stabilised))
        rest_confirm(b, &v.rested, &v.stabilised);
    v.captured = MASK_NONE;
    return v;
}

/* Lanes whose state has come into the captured set: see capture.h. */
static mask bundle_captured(const struct bundle *b, mask live, const mask *loaded)
{
    if (!bundle_some(b->capturing))
        return MASK_NONE;
    const mask instant =
        mask_less_equal(b->sample_every, lanes_of(0)) | mask_less_equal(b->next_sample, b->n);
    mask in = live & mask_less(lanes_of(0), b->capture.on) & instant &
              mask_less_equal(b->n, b->capture.last);
    if (!mask_any(in))
        return in;
    const lanes rest = lanes_of(CAPTURE_REST);
    lanes posture[POSTURES], rate[POSTURES];
    scene_posture(b->now.s, posture);
    scene_posture(b->now.w, rate);
    for (int i = 0; i < SCENE_POSTURE; i++)
        posture[i] = posture[i] - b->set.law.linear.target[i];
    in &= capture_contains(&b->capture, posture, rate);
    if (!mask_any(in))
        return in;
    for (int c = 0; c < SCENE_CONTACTS; c++) {
        const mask mine = mask_less(lanes_of(0), b->mine[c]);
        lanes u[2];
        scene_contact_velocity(&b->set.body, &b->now.trig, c, b->now.w, u);
        const mask stands = loaded[c] & mask_less_equal(lanes_abs(b->now.gap[c]), rest) &
                            mask_less_equal(lanes_abs(u[0]), rest) &
                            mask_less_equal(lanes_abs(u[1]), rest);
        in &= (mine & stands) | (LANES_NOT(mine) & LANES_NOT(loaded[c]));
    }
    return in;
}

#endif
