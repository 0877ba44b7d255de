/* bundle.h - runs many cases, one in each lane: the time loop, the controller's sampling, the
 * outcome rules, recording, and the refilling of finished lanes.
 *
 * Included by each method after the header that says how it gets from the end of one step to the
 * end of the next; gives `bundle_run`. That header defines
 *
 *   struct advance                        what it remembers of its lanes between steps,
 *   void advance_load(a, lane, case)      at the start of a case,
 *   mask advance(a, set, torque, h, live, coupled, now, report, failed)
 *                                         moves *now towards the end of the step of length h;
 * returns the lanes that are there, with *report about the whole step; the others go on at the next
 * call, but for *failed, void advance_free(a)                  at the end of all.
 */
#ifndef STANCE_CORE_BUNDLE_H
#define STANCE_CORE_BUNDLE_H

#include "capture.h"
#include "smooth.h"

#include <Random123/philox.h>

#define BUNDLE_STEPS 1000       /* between looks whether to leave */
#define BUNDLE_ERROR_FLOOR 1e-9 /* of settle.angle and settle.rate: smaller errors do not grow */

/* A condition that must hold for a while without its measure growing. */
struct window {
    lanes begin;   /* step at which it began; negative: it does not hold */
    lanes measure; /* then */
};

struct bundle {
    const stance_feed *feed;
    const stance_case *which[LANES]; /* NULL: idle */
    stance_result *result[LANES];
    mask live;  /* lanes that are not idle */
    int filled; /* how many */
    struct setting set;
    struct motion now;
    lanes torque[ACTUATORS];  /* in force */
    lanes pending[ACTUATORS]; /* computed at the last sample, in force from the next one on ... */
    lanes delayed;            /* ... where this is 1 */
    lanes h, n, steps;        /* step length, steps done, steps wanted */
    lanes sample_every, next_sample;
    lanes next_record; /* step of the next row of the trajectory; INFINITY: none */
    int64_t row[LANES];
    lanes recorded_at;                /* step of the row before */
    lanes impulse[SCENE_CONTACTS][2]; /* since then */

    lanes judge_on_way, has_target, support; /* support: contact index or -1 */
    lanes settle_angle, settle_rate, settle_steps, fall_height;
    struct window settled, resting;
    struct capture capture;

    lanes iterations, evaluations, events, ambiguous, subdivided, degraded;
    lanes least_normal; /* N, on the support contact */
    lanes penetration, slip, peak_torque, friction_used, impact_energy, projection_energy;
    lanes signorini, coulomb, dissipation;
    lanes energy_bound, energy_gain; /* initial energy and the work since; excess over it */
    lanes failure;
    struct advance advance;
};

/* Steps per sample; 0: the law acts inside the step. */
static int64_t case_samples(const stance_case *c)
{
#ifdef ADVANCE_SAMPLES_LAWS
    if (c->sample_every == 0 && c->decouples)
        return 1;
#endif
    return c->sample_every;
}

/* A law that acts inside the step couples the angles: such cases run in bundles of their own, so
 * that a case's arithmetic depends on nothing but the case. */
static bool case_is_coupled(const stance_case *c)
{
    if (case_samples(c) > 0)
        return false;
    for (int i = 0; i < SCENE_ACTUATORS; i++)
        for (int j = 0; j < 2 * SCENE_POSTURE; j++)
            if (c->gain[i][j] != 0)
                return true;
    return SCENE_ACTUATORS > 0 && c->decouples;
}

static inline void set_all(lanes *v, int n, int lane, const double *x)
{
    for (int i = 0; i < n; i++)
        lane_set(&v[i], lane, x[i]);
}

static void bundle_load_linear(struct linear_law *law, int lane, const stance_linear_law *c)
{
    for (int i = 0; i < SCENE_ACTUATORS; i++) {
        lane_set(&law->feedforward[i], lane, c->feedforward[i]);
        for (int j = 0; j < SCENE_POSTURE; j++) {
            lane_set(&law->gain[i][j], lane, c->gain[i][j]);
            lane_set(&law->gain[i][SCENE_POSTURE + j], lane, c->gain[i][SCENE_POSTURE + j]);
        }
    }
    set_all(law->target, SCENE_POSTURE, lane, c->target);
}

static void bundle_load_law(struct law *law, int lane, const stance_case *c)
{
    stance_linear_law linear;
    memcpy(linear.feedforward, c->feedforward, sizeof linear.feedforward);
    memcpy(linear.gain, c->gain, sizeof linear.gain);
    memcpy(linear.target, c->target, sizeof linear.target);
    bundle_load_linear(&law->linear, lane, &linear);
    bundle_load_linear(&law->far, lane, &c->far);
    for (int i = 0; i < SCENE_ACTUATORS; i++) {
        struct servo *const servo = &law->servo[i];
        const stance_servo *const from = &c->servo[i];
        for (int k = 0; k < SCENE_COORDINATES; k++)
            lane_set(&servo->pick[k], lane, k == from->coordinate);
        lane_set(&servo->setpoint, lane, from->setpoint);
        lane_set(&servo->ramp, lane, from->ramp);
        lane_set(&servo->duration, lane, from->duration);
        lane_set(&servo->kp, lane, from->kp);
        lane_set(&servo->ki, lane, from->ki);
        lane_set(&servo->kd, lane, from->kd);
        lane_set(&servo->integral_limit, lane, from->integral_limit);
    }
    lane_set(&law->decouples, lane, c->decouples);
    lane_set(&law->switches, lane, c->switches);
    for (int j = 0; j < SCENE_POSTURE; j++) {
        lane_set(&law->inverse_axis[j], lane, c->switches ? 1 / c->switch_axis[j] : 0);
        lane_set(&law->inverse_axis[SCENE_POSTURE + j], lane,
                 c->switches ? 1 / c->switch_axis[SCENE_POSTURE + j] : 0);
    }
    lane_set(&law->limit, lane, c->torque_limit);
}

static void bundle_load_setting(struct setting *set, int lane, const stance_case *c)
{
    scene_load_body(&set->body, lane, c->robot);
    lane_set(&set->friction, lane, c->friction);
    lane_set(&set->restitution, lane, c->restitution);
    for (int i = 0; i < SCENE_CONTACTS; i++)
        lane_set(&set->may_touch[i], lane, (double)(c->contacts >> i & 1));
    bundle_load_law(&set->law, lane, c);
}

static void bundle_clear_answers(struct bundle *b, int lane)
{
    lanes *const zero[] = {
        &b->iterations,    &b->evaluations,       &b->events,    &b->ambiguous,   &b->subdivided,
        &b->degraded,      &b->penetration,       &b->slip,      &b->peak_torque, &b->friction_used,
        &b->impact_energy, &b->projection_energy, &b->signorini, &b->coulomb,     &b->dissipation,
        &b->energy_gain,   &b->failure,           &b->n,         &b->recorded_at, &b->next_sample,
        &b->now.t};
    for (size_t i = 0; i < sizeof zero / sizeof *zero; i++)
        lane_set(zero[i], lane, 0);
    lane_set(&b->least_normal, lane, INFINITY);
    for (int i = 0; i < SCENE_CONTACTS; i++)
        lane_set(&b->impulse[i][0], lane, 0), lane_set(&b->impulse[i][1], lane, 0);
    lane_set(&b->settled.begin, lane, -1);
    lane_set(&b->settled.measure, lane, 0);
    lane_set(&b->resting.begin, lane, -1);
    lane_set(&b->resting.measure, lane, 0);
}

/* Puts a case into a lane. The motion's derived parts follow in bundle_begin. */
static void bundle_load(struct bundle *b, int lane, const stance_case *c, stance_result *result)
{
    double s[SCENE_COORDINATES], w[SCENE_COORDINATES];
    b->which[lane] = c;
    b->result[lane] = result;
    b->live |= mask_of_lane(lane);
    b->filled++;
    bundle_load_setting(&b->set, lane, c);
    scene_enter(c->robot, c->position, c->velocity, s, w);
    set_all(b->now.s, SCENE_COORDINATES, lane, s);
    set_all(b->now.w, SCENE_COORDINATES, lane, w);
    for (int i = 0; i < SCENE_ACTUATORS; i++) {
        lane_set(&b->torque[i], lane, 0);
        lane_set(&b->pending[i], lane,
                 fmax(fmin(c->feedforward[i], c->torque_limit), -c->torque_limit));
        lane_set(&b->now.integral[i], lane, 0);
    }
    lane_set(&b->delayed, lane, c->delay > 0);
    bundle_clear_answers(b, lane);
    advance_load(&b->advance, lane, c);
    lane_set(&b->h, lane, c->step);
    lane_set(&b->steps, lane, (double)c->steps);
    lane_set(&b->sample_every, lane, (double)case_samples(c));
    if (case_samples(c) == 0)
        lane_set(&b->next_sample, lane, INFINITY);
    lane_set(&b->next_record, lane, c->trajectory && c->trajectory->rows > 0 ? 0 : INFINITY);
    b->row[lane] = 0;
    lane_set(&b->judge_on_way, lane, c->settle);
    lane_set(&b->has_target, lane, c->has_target);
    lane_set(&b->support, lane, c->support);
    lane_set(&b->settle_angle, lane, c->settle_angle);
    lane_set(&b->settle_rate, lane, c->settle_rate);
    lane_set(&b->settle_steps, lane, nearbyint(c->settle_hold / c->step));
    lane_set(&b->fall_height, lane, c->fall_height);
    capture_load(&b->capture, lane, c);
}

/* Gaps, approach and trigonometry of freshly loaded lanes. A standing foot is exactly closed. */
static void bundle_begin(struct bundle *b, mask fresh)
{
    scene_trig trig;
    scene_trigonometry(b->now.s, &trig);
    for (int a = 0; a < SCENE_ANGLES; a++) {
        b->now.trig.sine[a] = choose(fresh, trig.sine[a], b->now.trig.sine[a]);
        b->now.trig.cosine[a] = choose(fresh, trig.cosine[a], b->now.trig.cosine[a]);
    }
    for (int c = 0; c < SCENE_CONTACTS; c++) {
        lanes u[2];
        scene_contact_velocity(&b->set.body, &trig, c, b->now.w, u);
        b->now.gap[c] = choose(fresh, scene_gap(&b->set.body, b->now.s, &trig, c), b->now.gap[c]);
        b->now.approach[c] = choose(fresh, u[0], b->now.approach[c]);
    }
    struct motion begin = b->now;
    motion_energy(&b->set, &begin);
    b->now.kinetic = choose(fresh, begin.kinetic, b->now.kinetic);
    b->now.energy = choose(fresh, begin.energy, b->now.energy);
    b->energy_bound = choose(fresh, begin.energy, b->energy_bound);
}

/* Uniform in [-1, 1): actuator i of sampling instant k, keyed as stance.h says. */
static inline double noise_value(uint64_t bits)
{
    return (double)(int64_t)(bits >> 11) * 0x1p-52 - 1;
}
static void bundle_noise(const stance_case *c, double instant, double noise[ACTUATORS])
{
    const philox4x64_key_t key = {{c->seed, 0}};
    const philox4x64_ctr_t counter = {{c->grid_index, c->sample_index, (uint64_t)instant, 0}};
    const philox4x64_ctr_t random = philox4x64(counter, key);
    for (int i = 0; i < SCENE_ACTUATORS; i++)
        noise[i] = c->noise * noise_value(random.v[i]);
}

/* What a law that is not linear commands at a sampling instant, in the lanes of `due`; the errors
 * that it sums count for the interval that begins. */
static void bundle_decouple(struct bundle *b, mask due, lanes *command)
{
    const struct law *const law = &b->set.law;
    const mask switches = mask_less(lanes_of(0), law->switches);
    const mask decouples = mask_less(lanes_of(0), law->decouples);
    lanes posture[POSTURES], rate[POSTURES], far[ACTUATORS], none[ACTUATORS];
    scene_posture(b->now.s, posture);
    scene_posture(b->now.w, rate);
    const mask inside = switches & law_near(law, posture, rate);
    linear_torque(&law->far, posture, rate, far);
    const mask servos = due & decouples & LANES_NOT(inside);
    const mask other = due & switches & LANES_NOT(inside | decouples);
    for (int i = 0; i < SCENE_ACTUATORS; i++) {
        command[i] = choose(other, far[i], command[i]);
        none[i] = lanes_of(0);
    }
    if (!mask_any(servos))
        return;
    struct dynamics e;
    struct contact_state contact;
    const contact_set touching = smooth_touching(&b->set, b->now.gap);
    e.trig = b->now.trig;
    dynamics_evaluate(&b->set, b->now.t, b->now.s, b->now.w, none, touching, true, &e);
    decoupling_contacts(&b->set, &e, &contact);
    decouple(&b->set, servos, b->now.t, b->now.s, b->now.w, b->now.integral, touching, &contact,
             &e);
    for (int i = 0; i < SCENE_ACTUATORS; i++)
        command[i] = choose(servos, e.command[i], command[i]);
    law_integrate(law, servos, b->sample_every * b->h, e.integral_rate, b->now.integral);
    b->degraded += choose(servos, e.degraded, lanes_of(0));
    b->ambiguous += choose(servos, e.several, lanes_of(0));
}

/* New torques in the lanes whose sampling instant it is. */
static inline void bundle_sample(struct bundle *b, mask live)
{
    const mask due = live & mask_less_equal(b->next_sample, b->n);
    if (!mask_any(due))
        return;
    lanes torque[ACTUATORS];
    law_torque(&b->set.law, b->now.s, b->now.w, torque);
    if (SCENE_ACTUATORS > 0 &&
        mask_any(due & mask_less(lanes_of(0), b->set.law.decouples + b->set.law.switches)))
        bundle_decouple(b, due, torque);
    for (int lane = 0; lane < LANES; lane++) {
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

static inline void bundle_account(struct bundle *b, mask ok, const struct step_report *report)
{
    const lanes none = lanes_of(0);
    b->n = choose(ok, b->n + 1, b->n);
    b->now.t = choose(ok, b->n * b->h, b->now.t);
    b->iterations += choose(ok, report->iterations, none);
    b->evaluations += choose(ok, report->evaluations, none);
    b->events += choose(ok, report->events, none);
    b->ambiguous += choose(ok, report->ambiguous, none);
    b->subdivided += choose(ok, report->subdivided, none);
    b->degraded += choose(ok, report->degraded, none);
    b->energy_bound += choose(ok, report->work, none);
#ifdef ADVANCE_TELLS_ENERGY
    const lanes energy = b->now.energy;
#else
    const lanes energy = scene_energy(&b->set.body, b->now.s, b->now.w, &b->now.trig);
#endif
    b->energy_gain =
        choose(ok, lanes_max(energy - b->energy_bound, b->energy_gain), b->energy_gain);
    b->friction_used = choose(ok, lanes_max(report->friction, b->friction_used), b->friction_used);
    b->signorini = choose(ok, lanes_max(report->signorini, b->signorini), b->signorini);
    b->coulomb = choose(ok, lanes_max(report->coulomb, b->coulomb), b->coulomb);
    b->dissipation = choose(ok, lanes_max(report->dissipation, b->dissipation), b->dissipation);
    b->impact_energy =
        choose(ok, lanes_max(report->impact_energy, b->impact_energy), b->impact_energy);
    b->projection_energy += choose(ok, report->projection_energy, none);
    for (int i = 0; i < SCENE_ACTUATORS; i++)
        b->peak_torque =
            choose(ok, lanes_max(lanes_abs(report->torque[i]), b->peak_torque), b->peak_torque);
    for (int c = 0; c < SCENE_CONTACTS; c++) {
        const mask may = ok & mask_less(none, b->set.may_touch[c]);
        b->penetration = choose(may, lanes_max(-b->now.gap[c], b->penetration), b->penetration);
        b->slip += choose(ok, report->slip[c], none);
        const mask support = ok & mask_less(lanes_abs(b->support - (double)c), lanes_of(0.5));
        b->least_normal =
            choose(support, lanes_min(report->least[c], b->least_normal), b->least_normal);
        for (int a = 0; a < 2; a++)
            b->impulse[c][a] += choose(ok, report->impulse[c][a], none);
    }
}

/* Advances a window in the lanes of `live`; returns those where it has lasted long enough. */
static inline mask window_advance(struct window *w, mask live, mask holds, lanes measure, lanes n,
                                  lanes length)
{
    const mask open = mask_less_equal(lanes_of(0), w->begin);
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

/* The outcome rules at the present state; `loaded`: contacts that carry. `last`: time is up. */
static inline struct verdict bundle_judge(struct bundle *b, mask live, const mask *loaded,
                                          mask last)
{
    lanes posture[POSTURES], rate[POSTURES];
    scene_posture(b->now.s, posture);
    scene_posture(b->now.w, rate);
    lanes angle = lanes_of(0), speed = lanes_of(0);
    for (int i = 0; i < SCENE_POSTURE; i++) {
        angle = lanes_max(lanes_abs(posture[i] - b->set.law.linear.target[i]), angle);
        speed = lanes_max(lanes_abs(rate[i]), speed);
    }
    angle = angle / b->settle_angle;
    const lanes all = scene_largest_rate(&b->set.body, b->now.w, &b->now.trig) / b->settle_rate;
    speed = speed / b->settle_rate;
    mask alone = LANES_ALL;
    for (int c = 0; c < SCENE_CONTACTS; c++) {
        const mask mine = mask_less(lanes_abs(b->support - (double)c), lanes_of(0.5));
        lanes u[2];
        scene_contact_velocity(&b->set.body, &b->now.trig, c, b->now.w, u);
        const mask stands = loaded[c] & mask_less_equal(lanes_abs(u[1]), b->settle_rate);
        alone &= (mine & stands) | (LANES_NOT(mine) & LANES_NOT(loaded[c]));
    }
    const lanes error = lanes_max(angle, speed), one = lanes_of(1);
    const mask at_target =
        alone & mask_less(lanes_of(0), b->has_target) & mask_less_equal(error, one);
    /* On the way to the target is not `elsewhere`, however slow. */
    const mask elsewhere = LANES_NOT(alone & mask_less(lanes_of(0), b->has_target));
    const mask still = elsewhere & mask_less_equal(all, one);
    const mask on_way = mask_less(lanes_of(0), b->judge_on_way);

    struct verdict v;
    v.fell = live & scene_fallen(&b->set.body, b->now.s, &b->now.trig, b->fall_height);
    v.stabilised =
        on_way & window_advance(&b->settled, live, at_target, error, b->n, b->settle_steps);
    v.rested = on_way & window_advance(&b->resting, live, still, all, b->n, b->settle_steps);
    const mask at_end = live & last & LANES_NOT(on_way);
    v.stabilised |= at_end & at_target;
    v.rested |= at_end & still;
    v.captured = MASK_NONE;
    return v;
}

/* Lanes whose state has come into the captured set: see capture.h. */
static inline mask bundle_captured(const struct bundle *b, mask live, const mask *loaded)
{
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
        const mask mine = mask_less(lanes_abs(b->support - (double)c), lanes_of(0.5));
        lanes u[2];
        scene_contact_velocity(&b->set.body, &b->now.trig, c, b->now.w, u);
        const mask stands = loaded[c] & mask_less_equal(lanes_abs(b->now.gap[c]), rest) &
                            mask_less_equal(lanes_abs(u[0]), rest) &
                            mask_less_equal(lanes_abs(u[1]), rest);
        in &= (mine & stands) | (LANES_NOT(mine) & LANES_NOT(loaded[c]));
    }
    return in;
}

/* Writes the rows that are due at the present step into the trajectory of a lane. */
static void bundle_record(struct bundle *b, int lane)
{
    const stance_case *const c = b->which[lane];
    stance_trajectory *const t = c->trajectory;
    const double n = lane_get(&b->n, lane);
    double s[SCENE_COORDINATES], w[SCENE_COORDINATES];
    for (int i = 0; i < SCENE_COORDINATES; i++)
        s[i] = lane_get(&b->now.s[i], lane), w[i] = lane_get(&b->now.w[i], lane);
    const double elapsed = (n - lane_get(&b->recorded_at, lane)) * c->step;
    int64_t row = b->row[lane];
    for (; row < t->rows && nearbyint((double)row * t->interval / c->step) <= n; row++) {
        scene_leave(c->robot, s, w, t->position + row * SCENE_COORDINATES,
                    t->velocity + row * SCENE_COORDINATES);
        for (int i = 0; i < SCENE_ACTUATORS; i++)
            t->torque[row * SCENE_ACTUATORS + i] = lane_get(&b->torque[i], lane);
        for (int k = 0; k < SCENE_CONTACTS; k++) {
            t->gap[row * SCENE_CONTACTS + k] = lane_get(&b->now.gap[k], lane);
            for (int a = 0; a < 2; a++)
                t->force[(row * SCENE_CONTACTS + k) * 2 + a] =
                    elapsed > 0 ? lane_get(&b->impulse[k][a], lane) / elapsed : NAN;
        }
    }
    for (int k = 0; k < SCENE_CONTACTS; k++)
        lane_set(&b->impulse[k][0], lane, 0), lane_set(&b->impulse[k][1], lane, 0);
    b->row[lane] = row;
    lane_set(&b->recorded_at, lane, n);
    lane_set(&b->next_record, lane,
             row < t->rows ? nearbyint((double)row * t->interval / c->step) : INFINITY);
}

/* Hands a lane's result in and leaves the lane idle. */
static void bundle_finish(struct bundle *b, int lane, stance_status status, stance_outcome outcome,
                          stance_failure failure, bool inferred)
{
    stance_result *const r = b->result[lane];
    const stance_case *const c = b->which[lane];
    const double n = lane_get(&b->n, lane), h = c->step;
    double s[SCENE_COORDINATES], w[SCENE_COORDINATES];
    const double least = lane_get(&b->least_normal, lane);
    const double begin = outcome == STANCE_RESTED ? lane_get(&b->resting.begin, lane)
                                                  : lane_get(&b->settled.begin, lane);
    const bool calm = outcome == STANCE_RESTED || outcome == STANCE_STABILISED;
    *r = (stance_result){
        .status = status,
        .outcome = outcome,
        .evidence = inferred ? STANCE_INFERRED : STANCE_EVIDENCE_NONE,
        .failure = failure,
        .end_time = n * h,
        .settle_time = calm && !inferred ? (begin >= 0 ? begin : n) * h : NAN,
        .fall_time = outcome == STANCE_FELL ? n * h : NAN,
        .steps = (int64_t)n,
        .iterations = (int64_t)lane_get(&b->iterations, lane),
        .ambiguous_steps = (int64_t)lane_get(&b->ambiguous, lane),
        .subdivided_steps = (int64_t)lane_get(&b->subdivided, lane),
        .least_normal_force = isfinite(least) ? least : NAN,
        .degraded_samples = (int64_t)lane_get(&b->degraded, lane),
        .max_penetration = lane_get(&b->penetration, lane),
        .slip_distance = lane_get(&b->slip, lane),
        .peak_torque = lane_get(&b->peak_torque, lane),
        .friction_used = lane_get(&b->friction_used, lane),
        .impact_energy = lane_get(&b->impact_energy, lane),
        .projection_energy = lane_get(&b->projection_energy, lane),
        .energy_gain = lane_get(&b->energy_gain, lane),
        .signorini_residual = lane_get(&b->signorini, lane),
        .coulomb_residual = lane_get(&b->coulomb, lane),
        .dissipation_residual = lane_get(&b->dissipation, lane),
        .events = (int64_t)lane_get(&b->events, lane),
        .evaluations = (int64_t)lane_get(&b->evaluations, lane),
    };
    for (int i = 0; i < SCENE_COORDINATES; i++)
        s[i] = lane_get(&b->now.s[i], lane), w[i] = lane_get(&b->now.w[i], lane);
    scene_leave(c->robot, s, w, r->position, r->velocity);
    b->which[lane] = NULL;
    b->live &= LANES_NOT(mask_of_lane(lane));
    b->filled--;
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
    lanes ahead[SCENE_COORDINATES];
    for (int i = 0; i < SCENE_COORDINATES; i++)
        ahead[i] = b->now.s[i] + 2 * b->h * b->now.w[i];
    if (!isfinite(sum))
        return STANCE_FAILURE_NOT_FINITE;
    return mask_get(scene_angles_in_range(ahead), lane) ? STANCE_FAILURE_NEWTON
                                                        : STANCE_FAILURE_ANGLE;
}

/* Ends the lanes that a verdict or the clock ends. */
static void bundle_end(struct bundle *b, mask live, mask failed, const struct verdict *v, mask last)
{
    const mask over = failed | v->fell | v->stabilised | v->rested | v->captured | last;
    if (!mask_any(live & over))
        return;
    for (int lane = 0; lane < LANES; lane++) {
        if (!b->which[lane] || !mask_get(live & over, lane))
            continue;
        if (mask_get(failed, lane)) {
            bundle_finish(b, lane, STANCE_FAILED, STANCE_NONE, bundle_failure(b, lane), false);
            continue;
        }
        const bool simulated = mask_get(v->stabilised | v->rested | v->fell, lane);
        const bool inferred = !simulated && mask_get(v->captured, lane);
        const stance_outcome outcome = mask_get(v->fell, lane) ? STANCE_FELL
                                       : inferred || mask_get(v->stabilised, lane)
                                           ? STANCE_STABILISED
                                       : mask_get(v->rested, lane) ? STANCE_RESTED
                                                                   : STANCE_UNDECIDED;
        bundle_finish(b, lane, STANCE_DONE, outcome, STANCE_FAILURE_NONE, inferred);
    }
}

/* Rows due now in any live lane. */
static inline void bundle_record_due(struct bundle *b, mask live)
{
    const mask due = live & mask_less_equal(b->next_record, b->n);
    if (!mask_any(due))
        return;
    for (int lane = 0; lane < LANES; lane++)
        if (b->which[lane] && mask_get(due, lane))
            bundle_record(b, lane);
}

/* Judges and records the initial state of fresh lanes. */
static void bundle_start(struct bundle *b, mask fresh, bool coupled)
{
    bundle_begin(b, fresh);
    mask loaded[SCENE_CONTACTS];
    for (int c = 0; c < SCENE_CONTACTS; c++)
        loaded[c] = mask_less(lanes_of(0), b->set.may_touch[c]) &
                    mask_less_equal(b->now.gap[c], lanes_of(STEP_CLOSED));
    const struct verdict v = bundle_judge(b, fresh, loaded, MASK_NONE);
    bundle_sample(b, fresh);
    if (!coupled) { /* a law that acts all the time, without gains: its torque is constant */
        lanes torque[ACTUATORS];
        const mask constant = fresh & mask_less_equal(lanes_of(INFINITY), b->next_sample);
        law_torque(&b->set.law, b->now.s, b->now.w, torque);
        law_clip(&b->set.law, torque);
        for (int i = 0; i < SCENE_ACTUATORS; i++)
            b->torque[i] = choose(constant, torque[i], b->torque[i]);
    } else {
        struct dynamics e;
        const struct drive drive = {b->torque, true, NULL};
        smooth_evaluate(&b->set, b->now.t, b->now.s, b->now.w, b->now.integral, &drive,
                        smooth_touching(&b->set, b->now.gap), &e);
        for (int i = 0; i < SCENE_ACTUATORS; i++)
            b->torque[i] = choose(fresh, e.torque[i], b->torque[i]);
    }
    bundle_record_due(b, fresh);
    bundle_end(b, fresh, MASK_NONE, &v, mask_less_equal(b->steps, lanes_of(0)));
}

/* One step of all live lanes, with everything that follows from it. */
static inline void bundle_step(struct bundle *b, mask live, bool coupled)
{
    struct step_report report;
    mask failed;
    bundle_sample(b, live);
    const mask ok =
        advance(&b->advance, &b->set, b->torque, b->h, live, coupled, &b->now, &report, &failed);
    b->failure = choose(failed, report.failure, b->failure);
    if (!mask_any(ok | failed))
        return;
    if (coupled)
        for (int i = 0; i < SCENE_ACTUATORS; i++)
            b->torque[i] = choose(ok, report.torque[i], b->torque[i]);
    bundle_account(b, ok, &report);
    mask loaded[SCENE_CONTACTS];
    for (int c = 0; c < SCENE_CONTACTS; c++)
        loaded[c] = mask_less(lanes_of(0), report.impulse[c][0]);
    const mask last = ok & mask_less_equal(b->steps, b->n);
    struct verdict v = bundle_judge(b, ok, loaded, last);
    v.captured = bundle_captured(b, ok, loaded);
    bundle_record_due(b, ok);
    bundle_end(b, live, failed, &v, last);
}

/* A stream's bundles: one for the cases whose law acts inside the step, one for the others. */
struct stream {
    struct bundle bundle[2]; /* [coupled] */
    const stance_feed *feed;
    const stance_case *ahead; /* drawn, but no lane of its bundle is free */
    stance_result *result;
    bool drained; /* the feed has no more */
};

/* Fills the free lanes of a bundle; those that were filled. */
static mask stream_fill(struct stream *stream, bool coupled)
{
    struct bundle *const b = &stream->bundle[coupled];
    const stance_feed *const feed = stream->feed;
    mask fresh = MASK_NONE;
    for (int lane = 0; lane < LANES; lane++) {
        if (b->which[lane])
            continue;
        if (!stream->ahead && !stream->drained)
            stream->drained = !feed->next(feed->context, &stream->ahead, &stream->result);
        if (!stream->ahead || case_is_coupled(stream->ahead) != coupled)
            break;
        bundle_load(b, lane, stream->ahead, stream->result);
        stream->ahead = NULL;
        fresh |= mask_of_lane(lane);
    }
    return fresh;
}

/* Steps a bundle for a while and refills lanes as they end. */
static inline __attribute__((always_inline)) void stream_advance(struct stream *stream,
                                                                 bool coupled)
{
    struct bundle *const b = &stream->bundle[coupled];
    for (int k = 0; k < BUNDLE_STEPS; k++) {
        while (b->filled < LANES) { /* a case may end at its start */
            const mask fresh = stream_fill(stream, coupled);
            if (!mask_any(fresh))
                break;
            bundle_start(b, fresh, coupled);
        }
        if (b->filled == 0)
            return;
        bundle_step(b, b->live, coupled);
    }
}

static bool bundle_stream(const stance_feed *feed)
{
    struct stream stream;
    memset(&stream, 0, sizeof stream);
    stream.feed = stream.bundle[0].feed = stream.bundle[1].feed = feed;
    bool leave = false;
    do {
        stream_advance(&stream, false);
        if (SCENE_ACTUATORS > 0)
            stream_advance(&stream, true);
        leave = feed->leave && feed->leave(feed->context);
    } while (!leave && (!stream.drained || stream.ahead || stream.bundle[0].filled > 0 ||
                        stream.bundle[1].filled > 0));
    advance_free(&stream.bundle[0].advance);
    advance_free(&stream.bundle[1].advance);
    return !leave;
}

/* An array as a feed. */
struct array {
    const stance_case *cases;
    stance_result *results;
    size_t next, n;
};
static bool array_next(void *context, const stance_case **c, stance_result **result)
{
    struct array *const a = context;
    if (a->next == a->n)
        return false;
    *c = &a->cases[a->next];
    *result = &a->results[a->next++];
    return true;
}
static void array_done(void *context, const stance_case *c, stance_result *result)
{
    (void)context, (void)c, (void)result;
}
static void bundle_run(const stance_case *cases, stance_result *results, size_t n)
{
    struct array array = {cases, results, 0, n};
    const stance_feed feed = {&array, array_next, array_done, NULL};
    bundle_stream(&feed);
}

#endif
