/* judge.h - what a bundle takes down after each step, and the outcome rules. */
#ifndef STANCE_CORE_LOOP_JUDGE_H
#define STANCE_CORE_LOOP_JUDGE_H

#include "rest.h"
#include "walk.h"

/* Largest values so far, and sums. */
HOT void account_largest(bool all, mask ok, lanes value, lanes *largest)
{
    *largest = choose_unless(all, ok, lanes_max(value, *largest), *largest);
}
HOT void account_sum(bool all, mask ok, lanes value, lanes *sum)
{
    *sum = choose_unless(all, ok, *sum + value, *sum);
}

#define ACCOUNT_SUM(value, sum) account_sum(all, ok, value, sum)
#define ACCOUNT_STEPS(value, sum) account_sum(all, ok, value, sum)
#define ACCOUNT_MAX(value, largest) account_largest(all, ok, value, largest)

/* Adds to the answers those that steps of the kind `by` tell. */
HOT void account_told(struct bundle *b, bool all, mask ok, enum told by,
                      const struct step_report *report)
{
#define ACCOUNT(name, type, how, told, unit, text)                                                 \
    WHERE_TOLD_##told(if (by == TOLD_##told) ACCOUNT_##how(report->name, &b->answer.name);)
    STANCE_ANSWERS(ACCOUNT)
}

/* What a step with contacts in `touching` reports of them. */
HOT void account_contacts(struct bundle *b, bool all, mask ok, contact_set touching,
                          const struct step_report *report)
{
    const lanes none = lanes_of(0);
    if (touching)
        account_told(b, all, ok, TOLD_touching, report);
    EACH_CONTACT (c, 0) {
        const mask support = ok & mask_less(none, b->mine[c]);
        const lanes least = touching >> c & 1 ? report->least[c] : none;
        b->answer.least_normal_force = choose(
            support, lanes_min(least, b->answer.least_normal_force), b->answer.least_normal_force);
    }
    EACH_IN (c, touching) {
        account_largest(false, ok & mask_less(none, b->set.may_touch[c]), -b->now.gap[c],
                        &b->answer.max_penetration);
        account_sum(all, ok, scene_slip(&b->set.body, c, report->slip[c]),
                    &b->answer.slip_distance);
        for (int a = 0; a < 2 && bundle_some(b->recorded); a++)
            account_sum(all, ok, report->impulse[c][a], &b->impulse[c][a]);
    }
}

/* Sums the drift of the energy, up or down, over steps in which no contact carries, as contacts
 * dissipate, and keeps its largest size. */
HOT void account_drift(struct bundle *b, bool all, mask ok, contact_set touching,
                       const struct step_report *report, lanes excess)
{
    mask free = ok;
    EACH_IN (c, touching)
        free &= mask_less_equal(report->impulse[c][0], lanes_of(0));
    if (!touching || mask_any(free)) {
        b->drift = choose_unless(all && !touching, free, b->drift + (excess - b->excess), b->drift);
        account_largest(all, ok, lanes_abs(b->drift), &b->answer.energy_drift);
    }
    b->excess = choose_unless(all, ok, excess, b->excess);
}

/* Takes down a step of the lanes in `ok` (or, `all`, of every lane that runs), contacts in
 * `touching`; `ordinary`: nothing happened in it that happens rarely. */
HOT void bundle_account(struct bundle *b, bool all, mask ok, bool ordinary, contact_set touching,
                        const struct step_report *report)
{
    account_sum(all, ok, lanes_of(1), &b->n);
    b->now.t = choose_unless(all, ok, b->n * b->h, b->now.t);
    account_told(b, all, ok, TOLD_each, report);
    account_sum(all, ok, report->work, &b->energy_bound);
#ifdef ADVANCE_TELLS_ENERGY
    const lanes energy = b->now.energy;
#else
    const lanes energy = scene_energy(&b->set.body, b->now.s, b->now.w, &b->now.trig);
#endif
    const lanes excess = energy - b->energy_bound;
    account_largest(all, ok, excess, &b->answer.energy_gain);
    account_drift(b, all, ok, touching, report, excess);
    b->fell = choose_unless(all, ok, report->fell, b->fell);
    b->fell_by = choose_unless(all, ok, report->fell_by, b->fell_by);
    account_contacts(b, all, ok, touching, report);
    if (ordinary)
        return;
    account_told(b, all, ok, TOLD_rare, report);
}

/* Advances a window in the lanes of `live`; returns those where it has lasted long enough. */
HOT mask window_advance(struct window *w, mask live, mask holds, lanes measure, lanes n,
                        lanes length)
{
    const mask open = mask_less_equal(lanes_of(0), w->begin);
    if (!mask_any(live & (holds | LANES_NOT(mask_less(w->since, lanes_of(0))))))
        return MASK_NONE;
    const mask full = holds & open & mask_less_equal(length, n - w->begin);
    const mask calm = mask_less_equal(measure, lanes_max(w->measure, lanes_of(BUNDLE_ERROR_FLOOR)));
    const mask restart = live & holds & (LANES_NOT(open) | (full & LANES_NOT(calm)));
    const mask lost = live & LANES_NOT(holds);
    w->since =
        choose(lost, lanes_of(-1), choose(live & mask_less(w->since, lanes_of(0)), n, w->since));
    w->begin = choose(restart, n, choose(lost, lanes_of(-1), w->begin));
    w->measure = choose(restart, measure, w->measure);
    return live & full & calm;
}

/* What is said of each lane, by outcome: v.fell and so on. */
struct verdict {
#define VERDICT(NAME, name, number, text) mask name;
    STANCE_OUTCOMES(VERDICT)
};

/* Lanes whose supports are no further along the ground from where they began than `place`. */
HOT mask bundle_in_place(const struct bundle *b)
{
    mask in = LANES_ALL;
    EACH_CONTACT (c, 0) {
        if (contact_grip(c) < 0)
            continue;
        const lanes moved = scene_along(&b->set.body, b->now.s, &b->now.trig, c) - b->began[c];
        in &= LANES_NOT(mask_less(lanes_of(0), b->mine[c])) |
              mask_less_equal(lanes_abs(moved), b->place);
    }
    return in;
}

/* The outcome rules at the present state; `loaded`: contacts that carry, of those in `touching`.
 * `last`: time is up. */
HOT struct verdict bundle_judge(struct bundle *b, mask live, contact_set touching,
                                const mask *loaded, mask last)
{
    const lanes none = lanes_of(0), one = lanes_of(1);
    lanes posture[POSTURES], rate[POSTURES], angle = none, speed = none;
    EACH_CONTACT (c, 0)
        account_largest(false, live & mask_less(none, b->left_out[c]), -b->now.gap[c],
                        &b->answer.through_ground);
    scene_posture(b->now.s, posture);
    scene_posture(b->now.w, rate);
    EACH (i, 0, SCENE_POSTURE) {
        angle = lanes_max(lanes_abs(posture[i] - b->set.law.near.target[i]), angle);
        speed = lanes_max(lanes_abs(rate[i]), speed);
    }
    const mask aims = live & mask_less(none, b->has_target);
    account_largest(false, aims, angle, &b->answer.excursion);
#ifdef ADVANCE_WATCHES
    const mask near = inside_near(&b->set, b->now.s, b->now.w, &b->now.trig, b->h);
    const mask far = aims & mask_less(b->answer.excursion, lanes_fma(b->h, speed, angle));
    advance_watch(&b->advance, live, near | far);
#endif
    angle = angle * b->angle_scale;
    speed = speed * b->rate_scale;
    mask alone = mask_less(none, b->has_target);
    EACH_CONTACT (c, 0) {
        const mask mine = mask_less(none, b->mine[c]);
        if (contact_grip(c) < 0) /* no ground */
            continue;
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
    const mask slow = mask_less_equal(speed, one);
    if (mask_any(alone & slow & live)) /* who has hopped or slid away is elsewhere */
        alone &= bundle_in_place(b);
    const mask at_target = alone & mask_less_equal(error, one);
    /* On the way to the target is not `elsewhere`, however slow. No rate is less than `speed`. */
    mask still = LANES_NOT(alone) & slow;
    lanes all = none;
    if (mask_any(still & live)) {
        all = scene_largest_rate(&b->set.body, b->now.w, &b->now.trig) * b->rate_scale;
        still &= mask_less_equal(all, one);
    }
    const mask on_way =
        mask_less(none, b->judge_on_way) & mask_less_equal(b->pushed_until, b->n * b->h);
    struct verdict v;
#define VERDICT_NONE(NAME, name, number, text) v.name = MASK_NONE;
    STANCE_OUTCOMES(VERDICT_NONE)
    v.fell = live & (mask_less(none, b->fell_by) | motion_fallen(&b->set, b->now.s, &b->now.trig));
    v.stabilised =
        on_way & window_advance(&b->settled, live, at_target, error, b->n, b->settle_steps);
    v.rested = on_way & window_advance(&b->resting, live, still, all, b->n, b->settle_steps);
    const mask at_end = live & last & LANES_NOT(on_way);
    v.walks = live & mask_less(none, b->walks);
    v.stabilised |= at_end & at_target;
    v.rested |= at_end & still;
    if (mask_any(v.rested | v.stabilised)) {
        /* Copies, because what is passed by address has to stay in memory. */
        mask rested = v.rested, stabilised = v.stabilised;
        rest_confirm(b, &rested, &stabilised);
        v.rested = rested, v.stabilised = stabilised;
    }
    return v;
}

#endif
