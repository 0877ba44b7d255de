/* rest.h - what a kernel tells of the robot near a state of rest (engine/rest.h), and what becomes
 * of the verdict.
 */
#ifndef STANCE_CORE_LOOP_REST_H
#define STANCE_CORE_LOOP_REST_H

#include "engine/rest.h"
#include "program.h"

#define REST_EDGE 1e-6  /* of a cone: what it is wider here */
#define REST_CREEP 1e-6 /* m/s: a contact this slow stands */

/* The neighbourhood of a state of rest of the case in one lane. */
struct rest {
    stance_rest asked;  /* first: by it the rest is found */
    struct setting set; /* without pushes */
    const stance_case *of;
    double known[STANCE_SAMPLE_HEAD]; /* of a program */
    int lane;
    lanes t;
    double bounce; /* m/s: a bounce that is over within a step is none */
    struct contact_state mode;
};

static const struct rest *rest_of(const stance_rest *asked)
{
    return (const struct rest *)asked;
}

/* Numbers as lanes, and back. */
static void rest_lanes(const double *x, int own, int room, lanes *out)
{
    for (int i = 0; i < room; i++)
        out[i] = lanes_of(i < own ? x[i] : 0);
}
static void rest_numbers(const struct rest *r, const lanes *x, int own, double *out)
{
    for (int i = 0; i < own; i++)
        out[i] = lane_get(&x[i], r->lane);
}

/* What a program that remembers nothing commands; the feet are those of the mode. */
COLD void rest_program(const struct rest *r, const lanes *s, const lanes *w, lanes *torque)
{
    const stance_program *const program = r->of->program;
    scene_trig trig;
    struct program_measured is;
    scene_trigonometry(s, &trig);
    program_measure(&r->set, true, s, w, &trig, &is);
    double *const sample = mask_get(is.near, r->lane) ? NULL : program->begin(program, r->of);
    if (!sample)
        return;
    memcpy(sample, r->known, sizeof r->known);
    program_sample(&is, r->mode.closed, r->lane, sample);
    const double *const command = program->act(program, r->of, sample);
    for (int i = 0; i < OWN_ACTUATORS; i++)
        lane_set(&torque[i], r->lane, command ? command[i] : NAN);
    program->end(program, sample);
}

/* The functions of a stance_rest. */
COLD void rest_law(const stance_rest *asked, const double *s1, const double *w1,
                   const double *integral1, double *torque1, double *rate1)
{
    const struct rest *const r = rest_of(asked);
    lanes s[SCENE_COORDINATES], w[SCENE_COORDINATES], integral[ACTUATORS];
    lanes torque[ACTUATORS], rate[ACTUATORS];
    struct dynamics e;
    rest_lanes(s1, SCENE_COORDINATES, SCENE_COORDINATES, s);
    rest_lanes(w1, SCENE_COORDINATES, SCENE_COORDINATES, w);
    rest_lanes(integral1, OWN_ACTUATORS, ACTUATORS, integral);
    rest_lanes(NULL, 0, ACTUATORS, rate);
    law_sampled(&r->set.law, s, w, torque);
    if (SCENE_ACTUATORS > 0 &&
        mask_any(mask_less(lanes_of(0), r->set.law.decouples + r->set.law.switches))) {
        const struct state at = {r->t, s, w, integral};
        scene_trigonometry(s, &e.trig);
        const mask servos = law_command(&r->set, LANES_ALL, &at, &r->mode, &e, torque);
        for (int i = 0; i < SCENE_ACTUATORS; i++)
            rate[i] = choose(servos, e.integral_rate[i], rate[i]);
    }
    if (SCENE_ACTUATORS > 0 && r->of->program)
        rest_program(r, s, w, torque);
    law_clip(&r->set.law, torque);
    rest_numbers(r, torque, OWN_ACTUATORS, torque1);
    rest_numbers(r, rate, OWN_ACTUATORS, rate1);
}

/* Everything that holds at s, where nothing moves, with these torques, but what the mode tells. */
COLD void rest_evaluate(const struct rest *r, const double *s1, const double *torque1, lanes *s,
                        struct dynamics *e)
{
    lanes still[SCENE_COORDINATES], torque[ACTUATORS];
    rest_lanes(s1, SCENE_COORDINATES, SCENE_COORDINATES, s);
    rest_lanes(NULL, 0, SCENE_COORDINATES, still);
    rest_lanes(torque1, OWN_ACTUATORS, ACTUATORS, torque);
    const struct state at = {.t = r->t, .s = s, .w = still};
    scene_trigonometry(s, &e->trig);
    dynamics_evaluate(&r->set, &at, torque, CONTACT_ALL, false, e);
}

static void rest_accelerate(const stance_rest *asked, const double *s1, const double *torque,
                            double *a)
{
    const struct rest *const r = rest_of(asked);
    lanes s[SCENE_COORDINATES];
    struct dynamics e;
    rest_evaluate(r, s1, torque, s, &e);
    between_solve(&r->set, &r->mode, &e);
    rest_numbers(r, e.acceleration, SCENE_COORDINATES, a);
}

static void rest_project(const stance_rest *asked, const double *torque, double *s1)
{
    const struct rest *const r = rest_of(asked);
    lanes s[SCENE_COORDINATES];
    struct dynamics e;
    rest_evaluate(r, s1, torque, s, &e);
    between_project_position(&r->set, r->mode.closed, s, &e);
    rest_numbers(r, s, SCENE_COORDINATES, s1);
}

/* Does contact c hold what slides along the ground, too? */
static bool rest_sticks(const struct rest *r, int c)
{
    return contact_grip(c) >= 0 && lane_get(&r->set.friction, r->lane) > 0;
}

static int rest_rows(const stance_rest *asked, const double *s1,
                     double row[][STANCE_MAX_COORDINATES], double *creeps)
{
    const struct rest *const r = rest_of(asked);
    lanes s[SCENE_COORDINATES], unit[SCENE_COORDINATES], u[2];
    scene_trig trig;
    int n = 0;
    rest_lanes(s1, SCENE_COORDINATES, SCENE_COORDINATES, s);
    scene_trigonometry(s, &trig);
    for (int c = 0; c < OWN_CONTACTS; c++) {
        if (!mask_get(r->mode.closed[c], r->lane))
            continue;
        const int held = rest_sticks(r, c) ? 2 : 1;
        for (int i = 0; i < SCENE_COORDINATES; i++) {
            for (int k = 0; k < SCENE_COORDINATES; k++)
                unit[k] = lanes_of(k == i);
            scene_contact_velocity(&r->set.body, &trig, c, unit, u);
            for (int a = 0; a < held; a++)
                row[n + a][i] = lane_get(&u[a], r->lane);
        }
        for (int a = 0; a < held; a++)
            creeps[n++] = a == 0 ? r->bounce : REST_CREEP;
    }
    return n;
}

/* What the contacts do at s; false: some slide, no forces hold them, or it has fallen. */
COLD bool rest_mode(const struct rest *r, const double *s1, const double *torque,
                    struct contact_state *mode, struct dynamics *e)
{
    struct between_trouble trouble;
    lanes s[SCENE_COORDINATES], stood[CONTACTS];
    for (int c = 0; c < OWN_CONTACTS; c++)
        stood[c] = lanes_of(1);
    rest_evaluate(r, s1, torque, s, e);
    between_mode(&r->set, e, CONTACT_ALL, stood, mode, &trouble);
    bool stands =
        !mask_get(trouble.none | trouble.impact | motion_fallen(&r->set, s, &e->trig), r->lane);
    for (int c = 0; c < OWN_CONTACTS; c++)
        if (mask_get(mode->closed[c], r->lane) && rest_sticks(r, c))
            stands &= lane_get(&mode->slide[c], r->lane) == 0;
    return stands;
}

static bool rest_stands(stance_rest *asked, const double *s, const double *torque, bool always)
{
    struct rest *const r = (struct rest *)asked;
    const lanes part = scene_longest_step(&r->set.body);
    const int parts = always && isfinite(lane_get(&part, r->lane)) ? 8 : 1;
    struct dynamics e;
    bool stands = true;
    for (int k = 0; k < parts && stands; k++) { /* of forces that change, from their phase 0 on */
        if (parts > 1)
            r->t = scene_swings_from(&r->set.body) + k * part;
        stands = rest_mode(r, s, torque, &r->mode, &e);
    }
    return stands;
}

static bool rest_stays(const stance_rest *asked, const double *s, const double *torque)
{
    const struct rest *const r = rest_of(asked);
    struct dynamics e;
    struct contact_state mode;
    bool stays = rest_mode(r, s, torque, &mode, &e);
    for (int c = 0; c < OWN_CONTACTS; c++)
        if (mask_get(r->mode.closed[c], r->lane))
            stays &= mask_get(mode.closed[c], r->lane);
        else if (lane_get(&r->set.may_touch[c], r->lane) > 0)
            stays &= lane_get(&e.gap[c], r->lane) >= -STEP_CLOSED;
    return stays;
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
static void rest_load_actuators(const struct bundle *b, int lane, stance_rest *asked)
{
    double *at = asked->under_way;
    asked->lags = lane_get(&b->lags, lane) > 0;
    asked->lag = lane_get(&b->actuators.lag, lane);
    asked->rate = lane_get(&b->actuators.rate, lane);
    asked->delay = (int)lane_get(&b->delay, lane);
    for (int i = 0; i < OWN_ACTUATORS && asked->lags; i++)
        *at++ = lane_get(&b->actuators.torque[i], lane);
    for (int k = 0; k < asked->delay; k++)
        for (int i = 0; i < OWN_ACTUATORS; i++)
            *at++ = lane_get(&b->pending[k][i], lane);
}

/* What a program is told: one that reads the clock is asked what it is in the end, the target by
 * what all cases know. */
static void rest_load_known(const struct bundle *b, int lane, bool comes, double *known)
{
    const double end = lane_get(&b->steps, lane) * lane_get(&b->h, lane);
    program_known(b, lane, known);
    known[STANCE_SAMPLE_SINCE] += end - known[STANCE_SAMPLE_TIME];
    known[STANCE_SAMPLE_TIME] = end;
    if (comes)
        return;
    known[STANCE_SAMPLE_SINCE] = end;
    known[STANCE_SAMPLE_FOOTFALLS] = 0;
    known[STANCE_SAMPLE_FOOT] = program_first_foot(b, lane);
}

/* Contacts that are closed, for laws that ask what they do. */
static void rest_load_mode(struct rest *r, const stance_case *c)
{
    const lanes low = lanes_of(fmax(STANCE_GRAVITY * c->step * c->step, STEP_CLOSED));
    lanes s[SCENE_COORDINATES];
    scene_trig trig;
    rest_lanes(r->asked.s, SCENE_COORDINATES, SCENE_COORDINATES, s);
    scene_trigonometry(s, &trig);
    for (int i = 0; i < OWN_CONTACTS; i++) {
        const lanes near =
            choose(mask_less(lanes_of(0), r->set.restitution[i]), low, lanes_of(STEP_CLOSED));
        r->mode.closed[i] = mask_less(lanes_of(0), r->set.may_touch[i]) &
                            mask_less_equal(scene_gap(&r->set.body, s, &trig, i), near);
        r->mode.slide[i] = lanes_of(0);
    }
}

/* Is there an equilibrium that holds, for the case in a lane, near target[coordinates]; NULL: near
 * the present state, and does the motion come there? */
COLD bool rest_holds(const struct bundle *b, int lane, const double *target)
{
    const stance_case *const c = b->which[lane];
    const double h = lane_get(&b->h, lane), every = lane_get(&b->sample_every, lane);
    struct rest r;
    stance_rest *const asked = &r.asked;
    if (!target && rest_moves(b, lane))
        return false;
    memset(&r, 0, sizeof r);
    r.asked = (stance_rest){
        .coordinates = SCENE_COORDINATES,
        .actuators = OWN_ACTUATORS,
        .angle = 1 / lane_get(&b->angle_scale, lane),
        .speed = 1 / lane_get(&b->rate_scale, lane),
        .samples = every > 0,
        .T = every > 0 ? every * h : h,
        .comes = !target,
        .law = rest_law,
        .accelerate = rest_accelerate,
        .rows = rest_rows,
        .project = rest_project,
        .stands = rest_stands,
        .stays = rest_stays,
    };
    asked->hold = fmax(lane_get(&b->settle_steps, lane) * h, asked->T);
    r.set = b->set;
    r.of = c;
    r.lane = lane;
    r.t = b->steps * b->h;
    r.bounce = fmax(STANCE_GRAVITY * h, REST_CREEP);
    scene_push(&r.set.body, lanes_of(INFINITY), b->h); /* nothing pushes any more */
    r.set.friction = r.set.friction * (1 + REST_EDGE);
    if (target) {
        memcpy(asked->s, target, SCENE_COORDINATES * sizeof *target);
    } else {
        rest_numbers(&r, b->now.s, SCENE_COORDINATES, asked->s);
        rest_numbers(&r, b->now.w, SCENE_COORDINATES, asked->w);
        rest_numbers(&r, b->now.integral, OWN_ACTUATORS, asked->integral);
    }
    rest_load_actuators(b, lane, asked);
    rest_load_known(b, lane, !target, r.known);
    rest_load_mode(&r, c);
    return c->scene->rest(asked);
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
    double s[SCENE_COORDINATES], w[SCENE_COORDINATES];
    rest_key(b, lane, key);
    if (b->target_known && memcmp(key, b->target_key, sizeof key) == 0)
        return b->target_holds;
    for (int i = 0; i < scene->postures; i++)
        q[scene->posture[i]] = c->near.target[i];
    if (c->supports)
        scene->stand(scene, c->robot, c->supports, q, v);
    scene_enter(&c->body, q, v, s, w);
    memcpy(b->target_key, key, sizeof key);
    b->target_known = true;
    return b->target_holds = rest_holds(b, lane, s);
}

/* At the end of a case whose program remembers: has what a window watches held for settle.hold? */
static mask rest_stayed(const struct bundle *b, const struct window *w, int lane)
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
            *rested &= LANES_NOT(mask_of_lane(lane)) | rest_stayed(b, &b->resting, lane);
            *stabilised &= LANES_NOT(mask_of_lane(lane)) | rest_stayed(b, &b->settled, lane);
            continue;
        }
        if (mask_get(*rested, lane) && !rest_holds(b, lane, NULL)) {
            *rested &= LANES_NOT(mask_of_lane(lane));
            lane_set(&b->resting.begin, lane, -1);
        }
        /* What a limited rate makes of a motion no map about the target tells. */
        const bool ramps = lane_get(&b->actuators.rate, lane) < INFINITY;
        if (mask_get(*stabilised, lane) &&
            !(rest_target(b, lane) && (!ramps || rest_holds(b, lane, NULL)))) {
            *stabilised &= LANES_NOT(mask_of_lane(lane));
            lane_set(&b->settled.begin, lane, -1);
        }
    }
}

#endif
