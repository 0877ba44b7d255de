/* rest.h - is there an equilibrium close by that holds?
 *
 * Slow is not at rest: a robot that topples over may take its time. `rested` and `stabilised` ask
 * for an equilibrium: with w = 0, contacts that stand (gap closed, forces inside the cones, what
 * the law commands within its limits) and no acceleration,
 *
 *   A w' = F(s, 0, t) + B torque(s, 0, I) + H^T lambda = 0,
 *
 * no further from the state than settle.angle, found by Newton's iteration along the ways that the
 * standing contacts leave (the null space Z of their H, s = s* + Z x on the ground); and that it
 * holds. About it, with central differences,
 *
 *   x'' = K x + B u,    u = C x + C' x' + C" I,    I' = E x + E' x' + E" I,
 *
 * I the integrals of a law that has them. Where a torque is at its limit its row of C is zero: that
 * is what the limit makes of it. A law that samples every T seconds and holds gives the map
 *
 *   (x, x')+ = Phi (x, x') + Gamma u,   I+ = I + T I',   [Phi Gamma; 0 1] = exp([0 1 0; K 0 B; 0 0
 * 0] T)
 *
 * with the u of some samples before where there is a delay, and with the torques as states where
 * actuators lag; one that acts all the time the exponential of the closed loop. It holds where
 * nothing has fallen and no reference of a servo still moves, when a disturbance has not grown by
 * more than REST_GROWTH after REST_HOLDS times settle.hold, REST_WHOLE at least, by squaring the
 * map again and again: what swings without damping, as a free leg does, holds, too; what grows,
 * however slowly, does not. Forces that change with time are looked at eight times a period, at
 * their crests among these. Noise is left out.
 *
 * `rested` says that the motion has come there. Contacts that carry stand, to REST_CREEP, and the
 * map takes the present deviation (x, x', I) to nothing, or round and round, without leaving
 * settle.angle and settle.rate on the way, the forces inside the cones, no other contact closing,
 * nothing falling, the law as linear as it was taken for (REST_BENT: no limit, no other law, no
 * rate limit that counts): looked at eight times an octave of time. What slid to rest has its force
 * on the edge of the cone, up to rounding: cones are wider by REST_EDGE.
 */
#ifndef STANCE_CORE_LOOP_REST_H
#define STANCE_CORE_LOOP_REST_H

#include "rest_linear.h"

/* Do contacts that carry stand? A bounce that is over within a step of length h is none. */
COLD bool rest_stands(const struct rest *r, const lanes *s, const lanes *w, double h)
{
    const double bounce = fmax(STANCE_GRAVITY * h, REST_CREEP);
    scene_trig trig;
    bool stands = true;
    scene_trigonometry(s, &trig);
    for (int c = 0; c < OWN_CONTACTS; c++) {
        lanes u[2];
        if (!mask_get(r->mode.closed[c], r->lane))
            continue;
        scene_contact_velocity(&r->set->body, &trig, c, w, u);
        stands &= fabs(lane_get(&u[0], r->lane)) <= bounce;
        if (contact_grip(c) >= 0 && lane_get(&r->set->friction, r->lane) > 0)
            stands &= fabs(lane_get(&u[1], r->lane)) <= REST_CREEP;
    }
    return stands;
}

/* Are the torques of the law what they are to first order at the deviation x? */
static bool rest_straight(const struct rest *r, const double *x, const lanes *torque)
{
    for (int i = 0; i < REST_INPUTS; i++) {
        double change = 0, size = 0;
        for (int j = 0; j < 2 * r->ways + REST_INPUTS; j++) {
            const int kind = j < r->ways ? 0 : j < 2 * r->ways ? 1 : 2;
            const double part = r->C[kind][i][j - kind * r->ways] * x[j];
            change += part, size += fabs(part);
        }
        const double bent = lane_get(&torque[i], r->lane) - (r->torque[i] + change);
        if (!(fabs(bent) <= REST_BENT * size + REST_STILL))
            return false;
    }
    return true;
}

/* Do actuators that lag give, at the deviation x, what the map takes them to give? `torque`, that
 * is commanded, becomes theirs. */
static bool rest_keeps_up(const struct rest *r, const double *x, lanes *torque)
{
    const double *const own = x + 2 * r->ways + REST_INPUTS, *const queue = own + REST_INPUTS;
    const double most = fmax(r->rate * r->lag, REST_RAMP * r->rate * r->T);
    bool keeps = true;
    for (int i = 0; i < REST_INPUTS && r->lags; i++) {
        const double command = r->delay ? queue[i] : lane_get(&torque[i], r->lane) - r->torque[i];
        keeps &= fabs(command - own[i]) <= most;
        torque[i] = lanes_of(r->torque[i] + own[i]);
    }
    return keeps;
}

/* Are torques and commands under way, at x, too small to matter within settle.hold? */
static bool rest_is_calm(const struct rest *r, const double *x)
{
    const int first = 2 * r->ways + REST_INPUTS,
              more = ((r->lags ? 1 : 0) + r->delay) * REST_INPUTS;
    double most = 0;
    for (int k = 0; k < r->ways; k++)
        for (int i = 0; i < more; i++)
            most = fmax(most, fabs(r->B[k][i % ACTUATORS] * x[first + i]) * r->hold);
    return most <= r->speed;
}

/* Is all well at the deviation x (ways' places, rates, integrals, torques that lag, commands under
 * way) from the equilibrium? *gone: it is as good as none. */
COLD bool rest_allows(const struct rest *r, const double *x, bool *gone)
{
    const int d = r->ways;
    double farthest = 0, fastest = 0;
    lanes s[SCENE_COORDINATES], w[SCENE_COORDINATES], integral[ACTUATORS];
    lanes torque[ACTUATORS], rates[ACTUATORS];
    for (int i = 0; i < SCENE_COORDINATES; i++) {
        double place = 0, speed = 0;
        for (int k = 0; k < d; k++)
            place += r->Z[k][i] * x[k], speed += r->Z[k][i] * x[d + k];
        s[i] = r->s[i] + place, w[i] = lanes_of(speed);
        farthest = fmax(farthest, fabs(place)), fastest = fmax(fastest, fabs(speed));
    }
    *gone =
        farthest <= REST_GONE * r->angle && fastest <= REST_GONE * r->speed && rest_is_calm(r, x);
    if (!(farthest <= r->angle && fastest <= r->speed))
        return false;
    for (int i = 0; i < ACTUATORS; i++)
        integral[i] = r->integral[i] + (i < REST_INPUTS ? x[2 * d + i] : 0);
    struct dynamics e;
    struct contact_state mode;
    rest_law(r, s, w, integral, torque, rates);
    if (!rest_straight(r, x, torque) || !rest_keeps_up(r, x, torque))
        return false;
    rest_evaluate(r, s, torque, &e);
    between_project_position(r->set, r->mode.closed, s, &e);
    if (rest_fallen(r, s) || !rest_mode(r, s, torque, &mode))
        return false;
    for (int c = 0; c < OWN_CONTACTS; c++) {
        if (mask_get(r->mode.closed[c] & LANES_NOT(mode.closed[c]), r->lane))
            return false;
        if (!mask_get(r->mode.closed[c], r->lane) && lane_get(&r->set->may_touch[c], r->lane) > 0 &&
            !(lane_get(&e.gap[c], r->lane) >= -STEP_CLOSED))
            return false;
    }
    return true;
}

/* Does the motion from (s, w) come to the equilibrium, or stay about it, for a time `whole`? M, of
 * a sample, is spoiled. */
COLD bool rest_arrives(const struct rest *r, const lanes *s, const lanes *w, const lanes *integral,
                       int n, small_matrix M, double whole)
{
    const int d = r->ways;
    double x[REST_STATES] = {0}, time = r->T;
    bool gone;
    for (int k = 0; k < d; k++)
        for (int i = 0; i < SCENE_COORDINATES; i++) {
            x[k] += r->Z[k][i] * (lane_get(&s[i], r->lane) - lane_get(&r->s[i], r->lane));
            x[d + k] += r->Z[k][i] * lane_get(&w[i], r->lane);
        }
    for (int i = 0; i < REST_INPUTS; i++)
        x[2 * d + i] = lane_get(&integral[i], r->lane) - lane_get(&r->integral[i], r->lane);
    for (int i = 2 * d + REST_INPUTS; i < n; i++) /* torques, commands under way */
        x[i] = r->under_way[i - 2 * d - REST_INPUTS] -
               r->torque[(i - 2 * d - REST_INPUTS) % ACTUATORS];
    for (int i = 0; i < n; i++)
        x[i] *= REST_MARGIN;
    if (!rest_allows(r, x, &gone))
        return false;
    for (; time * REST_FINE < r->hold; time *= 2)
        matrix_times(n, M, M, M);
    for (double t = 0; t < whole && !gone; time *= 2) {
        for (int k = 0; k < 8 && !gone; k++, t += time) {
            double next[REST_STATES] = {0};
            for (int i = 0; i < n; i++)
                for (int j = 0; j < n; j++)
                    next[i] += M[i][j] * x[j];
            memcpy(x, next, sizeof x);
            if (!rest_allows(r, x, &gone))
                return false;
        }
        matrix_times(n, M, M, M);
    }
    return true;
}

/* Does a reference of the servos still move? */
static bool rest_moves(const struct bundle *b, int lane)
{
    const struct law *const law = &b->set.law;
    const double t = lane_get(&b->n, lane) * lane_get(&b->h, lane);
    bool moves = false;
    for (int i = 0; i < SCENE_ACTUATORS; i++)
        moves |=
            lane_get(&law->servo[i].ramp, lane) != 0 && t < lane_get(&law->servo[i].duration, lane);
    return moves && lane_get(&law->decouples, lane) > 0; /* else servos have no part */
}

/* What stands between commands and torques. */
static void rest_load_actuators(struct rest *r, const struct bundle *b)
{
    int n = 0;
    r->lags = lane_get(&b->lags, r->lane) > 0;
    r->lag = lane_get(&b->actuators.lag, r->lane);
    r->rate = lane_get(&b->actuators.rate, r->lane);
    r->delay = (int)lane_get(&b->delay, r->lane);
    for (int i = 0; i < REST_INPUTS && r->lags; i++)
        r->under_way[n++] = lane_get(&b->actuators.torque[i], r->lane);
    for (int k = 0; k < r->delay; k++)
        for (int i = 0; i < REST_INPUTS; i++)
            r->under_way[n++] = lane_get(&b->pending[k][i], r->lane);
}

/* Is there an equilibrium near s that holds, for the case in a lane; and, w not NULL, does the
 * motion come there? */
COLD bool rest_holds(const struct bundle *b, int lane, const lanes *s, const lanes *w,
                     const lanes *integral)
{
    struct rest r;
    struct setting wider = b->set;
    double off = INFINITY;
    const lanes still[SCENE_COORDINATES] = {0};
    lanes torque[ACTUATORS], rate[ACTUATORS];
    double known[STANCE_SAMPLE_HEAD];
    const double h = lane_get(&b->h, lane), every = lane_get(&b->sample_every, lane);
    memset(&r, 0, sizeof r);
    r.angle = 1 / lane_get(&b->angle_scale, lane), r.speed = 1 / lane_get(&b->rate_scale, lane);
    r.T = every > 0 ? every * h : h;
    r.hold = fmax(lane_get(&b->settle_steps, lane) * h, r.T);
    scene_push(&wider.body, lanes_of(INFINITY), b->h); /* nothing pushes any more */
    wider.friction = wider.friction * (1 + REST_EDGE);
    r.set = &wider;
    r.of = b->which[lane];
    program_known(b, lane, known);
    /* A law that reads the clock is asked what it is in the end; the target by what all cases know.
     */
    known[STANCE_SAMPLE_SINCE] += lane_get(&b->steps, lane) * h - known[STANCE_SAMPLE_TIME];
    known[STANCE_SAMPLE_TIME] = lane_get(&b->steps, lane) * h;
    if (!w) {
        known[STANCE_SAMPLE_SINCE] = known[STANCE_SAMPLE_TIME];
        known[STANCE_SAMPLE_FOOTFALLS] = 0;
        known[STANCE_SAMPLE_FOOT] = program_first_foot(b, lane);
    }
    r.known = known;
    r.lane = lane;
    r.t = b->steps * b->h;
    for (int i = 0; i < SCENE_COORDINATES; i++)
        r.s[i] = s[i];
    for (int i = 0; i < ACTUATORS; i++)
        r.integral[i] = integral[i];
    scene_trig trig;
    scene_trigonometry(r.s, &trig);
    const lanes low = lanes_of(fmax(STANCE_GRAVITY * h * h, STEP_CLOSED));
    for (int c = 0; c < OWN_CONTACTS; c++) { /* for laws that ask what the contacts do */
        const lanes near =
            choose(mask_less(lanes_of(0), b->set.restitution[c]), low, lanes_of(STEP_CLOSED));
        r.mode.closed[c] = mask_less(lanes_of(0), b->set.may_touch[c]) &
                           mask_less_equal(scene_gap(&b->set.body, r.s, &trig, c), near);
        r.mode.slide[c] = lanes_of(0);
    }
    rest_law(&r, r.s, still, r.integral, torque, rate);
    struct dynamics e;
    rest_evaluate(&r, r.s, torque, &e); /* what bounces within a step lies on the ground */
    between_project_position(r.set, r.mode.closed, r.s, &e);
    rest_law(&r, r.s, still, r.integral, torque, rate);
    if (!rest_mode(&r, r.s, torque, &r.mode) || (w && !rest_stands(&r, s, w, h)))
        return false;
    for (int round = 0; round < REST_ROUNDS && off > REST_STILL; round++) {
        rest_ways(&r);
        rest_approach(&r, &off);
        for (int i = 0; i < SCENE_COORDINATES; i++)
            if (!(fabs(lane_get(&r.s[i], lane) - lane_get(&s[i], lane)) <= r.angle))
                return false;
    }
    if (!(off <= REST_STILL))
        return false;
    rest_ways(&r);
    rest_law(&r, r.s, still, r.integral, torque, rate);
    rest_linearise(&r, torque);
    for (int i = 0; i < REST_INPUTS; i++)
        r.torque[i] = lane_get(&torque[i], lane);
    if (rest_fallen(&r, r.s) || (w && rest_moves(b, lane)))
        return false;
    /* Forces that hold it, at all times: of those that change, from their phase 0 on. */
    const lanes part = scene_longest_step(&b->set.body);
    const int parts = isfinite(lane_get(&part, lane)) ? 8 : 1;
    for (int k = 0; k < parts; k++) {
        if (parts > 1)
            r.t = scene_swings_from(&b->set.body) + k * part;
        if (!rest_mode(&r, r.s, torque, &r.mode))
            return false;
    }
    if (r.ways == 0)
        return true;
    small_matrix M, power;
    const double whole = fmax(REST_HOLDS * r.hold, REST_WHOLE);
    rest_load_actuators(&r, b);
    const int n = rest_map(&r, every > 0, M);
    matrix_copy(n, M, power);
    return rest_bounded(n, power, r.T, whole) &&
           (!w || rest_arrives(&r, s, w, integral, n, M, whole));
}

/* ---- what becomes of a verdict ------------------------------------------------------------- */

/* What is known of the target: circumstances of a case, and whether its equilibrium holds. */
enum {
    REST_SETTING = sizeof(struct setting) / sizeof(lanes),
    REST_KEY = REST_SETTING + 8 + CONTACTS + STANCE_PROGRAM_NUMBERS
};

/* The case in a lane, whatever its start: what rest_target depends on. */
static void rest_key(const struct bundle *b, int lane, double *key)
{
    const lanes *const set = (const lanes *)&b->set;
    const lanes rest[] = {b->h,           b->steps,        b->sample_every,  b->delay,
                          b->angle_scale, b->settle_steps, b->actuators.lag, b->actuators.rate};
    enum { REST_MINE = REST_SETTING + sizeof rest / sizeof *rest };
    _Static_assert(REST_MINE + CONTACTS + STANCE_PROGRAM_NUMBERS == REST_KEY, "room for all");
    for (int i = 0; i < REST_SETTING; i++)
        key[i] = lane_get(&set[i], lane);
    for (int i = REST_SETTING; i < REST_MINE; i++)
        key[i] = lane_get(&rest[i - REST_SETTING], lane);
    for (int i = 0; i < CONTACTS; i++)
        key[REST_MINE + i] = lane_get(&b->mine[i], lane);
    memcpy(&key[REST_MINE + CONTACTS], b->which[lane]->parameter,
           STANCE_PROGRAM_NUMBERS * sizeof *key);
}

/* Is there an equilibrium at the target, on the supports, that holds? Of cases that differ in
 * their starts alone it is asked once. */
COLD bool rest_target(struct bundle *b, int lane)
{
    const stance_case *const c = b->which[lane];
    const stance_scene *const scene = c->scene;
    double key[REST_KEY], q[SCENE_COORDINATES] = {0}, v[SCENE_COORDINATES] = {0};
    double s1[SCENE_COORDINATES], w1[SCENE_COORDINATES];
    rest_key(b, lane, key);
    if (b->target_known && memcmp(key, b->target_key, sizeof key) == 0)
        return b->target_holds;
    lanes s[SCENE_COORDINATES], integral[ACTUATORS] = {0};
    for (int i = 0; i < scene->postures; i++)
        q[scene->posture[i]] = c->near.target[i];
    if (c->supports)
        scene->stand(scene, c->robot, c->supports, q, v);
    scene_enter(&c->body, q, v, s1, w1);
    for (int i = 0; i < SCENE_COORDINATES; i++)
        s[i] = lanes_of(s1[i]);
    memcpy(b->target_key, key, sizeof key);
    b->target_known = true;
    return b->target_holds = rest_holds(b, lane, s, NULL, integral);
}

/* At the end of a case whose program remembers: has what a window watches held for settle.hold? */
static mask rest_stays(const struct bundle *b, const struct window *w, int lane)
{
    const double since = lane_get(&w->since, lane);
    return since >= 0 && lane_get(&b->n, lane) - since >= lane_get(&b->settle_steps, lane)
               ? LANES_ALL
               : MASK_NONE;
}

/* Lanes of a verdict without those where nothing holds: their window opens anew. */
COLD void rest_confirm(struct bundle *b, mask *rested, mask *stabilised)
{
    for (int lane = 0; lane < LANES; lane++) {
        if (!b->which[lane])
            continue;
        if (b->which[lane]->program && b->which[lane]->program->remembers) {
            *rested &= LANES_NOT(mask_of_lane(lane)) | rest_stays(b, &b->resting, lane);
            *stabilised &= LANES_NOT(mask_of_lane(lane)) | rest_stays(b, &b->settled, lane);
            continue;
        }
        if (mask_get(*rested, lane) && !rest_holds(b, lane, b->now.s, b->now.w, b->now.integral)) {
            *rested &= LANES_NOT(mask_of_lane(lane));
            lane_set(&b->resting.begin, lane, -1);
        }
        /* What a limited rate makes of a motion no map about the target tells. */
        const bool ramps = lane_get(&b->actuators.rate, lane) < INFINITY;
        if (mask_get(*stabilised, lane) &&
            !(rest_target(b, lane) &&
              (!ramps || rest_holds(b, lane, b->now.s, b->now.w, b->now.integral)))) {
            *stabilised &= LANES_NOT(mask_of_lane(lane));
            lane_set(&b->settled.begin, lane, -1);
        }
    }
}

#endif
