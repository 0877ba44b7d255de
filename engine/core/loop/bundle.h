/* bundle.h - many cases side by side, one in each lane: what is kept of them, and how a case is put
 * into a lane.
 */
#ifndef STANCE_CORE_LOOP_BUNDLE_H
#define STANCE_CORE_LOOP_BUNDLE_H

#include "actuator.h"
#include "engine/core/mode/between_events.h"

/* A case that takes more evaluations than this is given up: so many at once, so many a step. */
#define BUNDLE_WORK 1e7
#define BUNDLE_WORK_STEP 1e3
#define BUNDLE_ERROR_FLOOR 1e-9 /* of settle.angle and settle.rate: smaller errors do not grow */

/* A condition that must hold for a while without its measure growing. */
struct window {
    lanes since;   /* step from which on it holds; negative: it does not */
    lanes begin;   /* step from which on it is watched; negative: it is not */
    lanes measure; /* then */
};

static inline void window_load(struct window *w, int lane)
{
    lane_set(&w->since, lane, -1);
    lane_set(&w->begin, lane, -1);
    lane_set(&w->measure, lane, 0);
}

/* The answers that are gathered over steps, see STANCE_ANSWERS. */
#define WHERE_GATHERED_END(...)
#define WHERE_GATHERED_SUM(...) __VA_ARGS__
#define WHERE_GATHERED_STEPS(...) __VA_ARGS__
#define WHERE_GATHERED_MAX(...) __VA_ARGS__
#define WHERE_GATHERED_MIN(...) __VA_ARGS__
struct gathered {
#define GATHERED(name, type, how, told, unit, text) WHERE_GATHERED_##how(lanes name;)
    STANCE_ANSWERS(GATHERED)
};
/* What they begin with. */
#define GATHERED_FROM_SUM 0
#define GATHERED_FROM_STEPS 0
#define GATHERED_FROM_MAX 0
#define GATHERED_FROM_MIN INFINITY

#if SCENE_PLATES
/* What is kept of the ground's plates, see plates.h. */
enum { PLATES_STANDS = 1, PLATES_NO_GROUND = 2 };
struct plates {
    lanes from[STANCE_MAX_PLATES]; /* where pieces begin; INFINITY: it is not laid yet */
    lanes along[SCENE_PLACES];     /* m, where a place is ... */
    lanes moved[SCENE_PLACES];     /* ... by how much it has come along in the last step ... */
    lanes low[SCENE_PLACES], high[SCENE_PLACES]; /* ... and from where to where its plate is */
    lanes roof[CONTACTS];                        /* height of that ... */
    lanes top[CONTACTS],
        bottom[CONTACTS];    /* ... and of the highest and lowest of it and those beside it */
    lanes inside[CONTACTS];  /* 0: above it; or it stands inside, or has no ground there */
    lanes dropped[CONTACTS]; /* height from which it drops off an edge; -INFINITY: it does not */
    lanes landing[CONTACTS]; /* height on which a step that is taken again is to land; NAN */
    lanes cut;               /* s, of the step: its next piece ends there, at the latest */
};
#endif

/* What is kept of a lane's last steps. Steps back that a gait may repeat after, and how far back.
 */
enum { WALK_PERIODS = 4, WALK_KEPT = WALK_PERIODS };
struct walking {
    double last;          /* s, of the last footfall, be it a step */
    double settled;       /* s, since when */
    double steps, period; /* so far; with which they are alike, 0: they are not */
    double length;        /* m, of the last one, from foot to foot */
    double change;        /* how unlike the last one is to one before; INFINITY: there is none */
    /* Of the last steps, the newest first: when, where, after which effort, with which angles and
     * rates, legs exchanged where the second one stands. */
    double when[WALK_KEPT + 1], where[WALK_KEPT + 1], after[WALK_KEPT + 1];
    double section[WALK_KEPT][2 * POSTURES];
    /* By period: how many in a row were alike, since when, s; the largest difference of the first
     * half of those that are wanted, and of the others. */
    double alike[WALK_PERIODS], since[WALK_PERIODS], first[WALK_PERIODS], later[WALK_PERIODS];
    double off[WALK_PERIODS][WALK_KEPT]; /* of the last steps, the newest first, by period */
};

struct bundle {
    const stance_feed *feed;
    mask live;                                                        /* lanes that are not idle */
    int filled;                                                       /* how many */
    int recorded, unusual, bending, choosy, walking, programs, noisy; /* see bundle_count */
    double target_key[sizeof(struct setting) / sizeof(lanes) + 8 + CONTACTS +
                      STANCE_PROGRAM_NUMBERS]; /* see rest_target */
    bool target_known, target_holds;
    const stance_case *which[LANES]; /* NULL: idle */
    stance_result *result[LANES];
    struct walking walk[LANES];
    /* From here on everything is an array over the lanes, of 8 bytes each: see regroup.h. */
    _Alignas(sizeof(lanes)) struct setting set;
    struct motion now;
    lanes torque[ACTUATORS]; /* in force */
    lanes delay;             /* samples until a command is in force */
    lanes lags;              /* 1: actuators come up to what is commanded, see actuator.h */
    lanes h, n, steps;       /* step length, steps done, steps wanted */
    lanes most_work;         /* evaluations, see BUNDLE_WORK */
    lanes sample_every, next_sample;
    lanes next_record; /* step of the next row of the trajectory; INFINITY: none */
    int64_t row[LANES];
    lanes struck;       /* step before which impulses were looked for */
    lanes pushed_until; /* s, after which nothing pushes */
#ifdef ADVANCE_PIECES
    lanes piece_from, piece_to; /* s, of the step: see stream_push */
    struct step_report pieces;  /* of the step, before that */
#endif
    lanes recorded_at;          /* step of the row before */
    lanes impulse[CONTACTS][2]; /* since then */

    lanes judge_on_way, has_target, mine[CONTACTS]; /* 1: a contact to stand on */
    lanes began[CONTACTS], place;                   /* m, along the ground: see bundle_in_place */
    lanes left_out[CONTACTS];      /* 1: meets the ground, which the case does not let it touch */
    lanes angle_scale, rate_scale; /* 1 / settle.angle and 1 / settle.rate */
    lanes settle_steps;
    struct window settled, resting;

    lanes ahead[CONTACTS];  /* 1: lands only there, see feet.h */
    lanes foot;             /* that landed last; -1: none has */
    lanes leg;              /* that stands, of stance_exchange: 0, 1 */
    lanes stands;           /* contact that stood up to now; -1: none */
    lanes ended;            /* s, at which the last footfall ended the case; -1: none has */
    lanes walks;            /* 1: in steps that are alike, or in enough of them */
    lanes effort;           /* J, sum of |work| of each actuator so far, where ... */
    lanes inside;           /* 1: within a step */
    lanes moved[ACTUATORS]; /* ... these are their places */
#if SCENE_PLATES
    struct plates plates;
#endif

    struct gathered answer;
    lanes fell, fell_by; /* in the last step, before its end: see struct step_report */
    lanes energy_bound;  /* J, initial energy and the work since */
    lanes excess;        /* J, by which the energy was above it at the end of the last step */
    lanes drift;         /* J, what that has changed by in steps in which no contact carried */
    lanes failure;
    struct advance advance;
    struct actuators actuators;
    lanes pending[STANCE_MAX_DELAY][ACTUATORS]; /* commands under way, the next one first */
    uint64_t program[LANES];                    /* addresses of what cases' programs keep */
};

/* Is there any case of a kind that is counted? A hint, as mask_any. */
static inline bool bundle_some(int count)
{
    return count > 0 || lanes_doubt();
}

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
        for (int j = 0; j < 2 * OWN_POSTURE; j++)
            if (c->near.gain[i][j] != 0)
                return true;
    return SCENE_ACTUATORS > 0 && c->decouples;
}

static inline void set_all(lanes *v, int n, int lane, const double *x)
{
    for (int i = 0; i < n; i++)
        lane_set(&v[i], lane, x[i]);
}

static void bundle_load_linear(struct linear_law *law, int lane, const stance_case *of,
                               const stance_linear_law *c)
{
    for (int i = 0; i < SCENE_ACTUATORS; i++) {
        lane_set(&law->feedforward[i], lane, c->feedforward[i]);
        for (int j = 0; j < OWN_POSTURE; j++) {
            lane_set(&law->gain[i][j], lane, c->gain[i][j]);
            lane_set(&law->gain[i][SCENE_POSTURE + j], lane, c->gain[i][OWN_POSTURE + j]);
        }
    }
    for (int j = 0; j < OWN_POSTURE; j++)
        lane_set(&law->target[j], lane, c->target[j] + scene_posture_origin(&of->body, j));
}

#ifdef SCENE_SERVOS
/* Outputs as they are while a leg stands. */
static void bundle_load_outputs(struct law *law, int lane, const stance_case *c, int leg)
{
    const stance_outputs *const of = &c->outputs;
    const double scale = c->follows ? 1 / (of->to - of->from) : 0;
    lane_set(&law->phase_from, lane, scale * of->from);
    for (int k = 0; k < SCENE_COORDINATES; k++)
        lane_set(&law->phase[k], lane, scale * of->phase[leg][k]);
    for (int k = 0; k < STANCE_MAX_COEFFICIENTS; k++)
        lane_set(&law->clock[k], lane, scale * of->clock[k]);
    for (int i = 0; i < SCENE_ACTUATORS; i++) {
        const stance_output *const output = &of->output[leg][i];
        for (int k = 0; k < SCENE_COORDINATES && c->follows; k++)
            lane_set(&law->servo[i].pick[k], lane, output->row[k]);
        set_all(law->along[i], STANCE_MAX_COEFFICIENTS, lane, output->along);
        for (int j = 0; j < SCENE_ACTUATORS; j++)
            lane_set(&law->torques[j][i], lane, output->torques[j]);
    }
}
#endif

static void bundle_load_law(struct law *law, int lane, const stance_case *c)
{
    bundle_load_linear(&law->near, lane, c, &c->near);
    bundle_load_linear(&law->far, lane, c, &c->far);
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
        const double own = c->torque_limits[i] > 0 ? c->torque_limits[i] : INFINITY;
        lane_set(&law->limit[i], lane, fmin(fmin(c->body.limit[i], c->torque_limit), own));
    }
    lane_set(&law->decouples, lane, c->decouples);
    lane_set(&law->follows, lane, c->follows);
    lane_set(&law->constant, lane, c->follows && c->outputs.constant);
    lane_set(&law->footfall, lane, 0);
#ifdef SCENE_SERVOS
    bundle_load_outputs(law, lane, c, 0);
#endif
    lane_set(&law->switches, lane, c->switches);
    for (int i = 0; i < SCENE_ACTUATORS; i++)
        lane_set(&law->push[i], lane, c->bends ? c->bend.push[i] : 0);
    for (int j = 0; j < OWN_POSTURE; j++) {
        lane_set(&law->normal[j], lane, c->bends ? c->bend.normal[j] : 0);
        lane_set(&law->normal[SCENE_POSTURE + j], lane,
                 c->bends ? c->bend.normal[OWN_POSTURE + j] : 0);
        lane_set(&law->inverse_axis[j], lane, c->switches ? 1 / c->switch_axis[j] : 0);
        lane_set(&law->inverse_axis[SCENE_POSTURE + j], lane,
                 c->switches ? 1 / c->switch_axis[OWN_POSTURE + j] : 0);
    }
}

static void bundle_load_setting(struct setting *set, int lane, const stance_case *c)
{
    scene_load_body(&set->body, lane, &c->body);
    lane_set(&set->friction, lane, c->friction);
    lane_set(&set->prefer, lane, c->most_energy ? -1 : 1);
    lane_set(&set->moreau, lane, c->impacts == STANCE_IMPACTS_MOREAU);
    lane_set(&set->limited, lane, c->impacts != STANCE_IMPACTS_NEWTON);
    for (int i = 0; i < OWN_CONTACTS; i++) {
        lane_set(&set->may_touch[i], lane, (double)(c->contacts >> i & 1));
        lane_set(&set->restitution[i], lane, contact_grip(i) >= 0 ? c->restitution : 0);
    }
    bundle_load_law(&set->law, lane, c);
}

static void bundle_clear_answers(struct bundle *b, int lane)
{
    lanes *const zero[] = {&b->failure, &b->n,     &b->recorded_at, &b->next_sample, &b->now.t,
                           &b->excess,  &b->drift, &b->fell,        &b->fell_by};
    for (size_t i = 0; i < sizeof zero / sizeof *zero; i++)
        lane_set(zero[i], lane, 0);
#define CLEAR(name, type, how, told, unit, text)                                                   \
    WHERE_GATHERED_##how(lane_set(&b->answer.name, lane, GATHERED_FROM_##how);)
    STANCE_ANSWERS(CLEAR)
    for (int i = 0; i < OWN_CONTACTS; i++)
        for (int a = 0; a < 2; a++) {
            lane_set(&b->impulse[i][a], lane, 0);
            lane_set(&b->now.impulse[i][a], lane, 0);
        }
    lane_set(&b->struck, lane, -1);
    window_load(&b->settled, lane);
    window_load(&b->resting, lane);
}

static bool case_is_noisy(const stance_case *c)
{
    return c->noise != 0 || c->angle_noise != 0 || c->rate_noise != 0;
}

/* Counts a case among those that cost more, or (-1) no longer. */
static void bundle_count(struct bundle *b, const stance_case *c, int by)
{
    /* Is there more to its torques than a linear law of the present state? */
    const bool unusual = case_is_noisy(c) || c->delay > 0 || actuators_lag(c) || c->decouples ||
                         c->switches || c->program;
    b->recorded += c->trajectory && c->trajectory->rows > 0 ? by : 0;
    b->unusual += unusual ? by : 0;
    b->bending += c->bends ? by : 0;
    b->choosy += c->lands_ahead ? by : 0;
    b->walking += c->walk_steps > 0 ? by : 0;
    b->programs += c->program ? by : 0;
    b->noisy += case_is_noisy(c) ? by : 0;
}

/* Puts a case into a lane. The motion's derived parts follow in bundle_begin. */
static void bundle_load(struct bundle *b, int lane, const stance_case *c, stance_result *result)
{
    double s[SCENE_COORDINATES], w[SCENE_COORDINATES];
    SCENE_BEGIN(c);
    b->which[lane] = c;
    b->result[lane] = result;
    b->live |= mask_of_lane(lane);
    b->filled++;
    bundle_count(b, c, 1);
    bundle_load_setting(&b->set, lane, c);
    scene_enter(&c->body, c->position, c->velocity, s, w);
    set_all(b->now.s, SCENE_COORDINATES, lane, s);
    set_all(b->now.w, SCENE_COORDINATES, lane, w);
    for (int i = 0; i < SCENE_ACTUATORS; i++) {
        lane_set(&b->torque[i], lane, 0);
        const double limit = lane_get(&b->set.law.limit[i], lane);
        const double rest = fmax(fmin(c->near.feedforward[i], limit), -limit);
        for (int k = 0; k < STANCE_MAX_DELAY; k++)
            lane_set(&b->pending[k][i], lane, rest);
        lane_set(&b->actuators.torque[i], lane, rest);
        lane_set(&b->now.integral[i], lane, 0);
    }
    b->program[lane] = c->program ? (uintptr_t)c->program->begin(c->program, c) : 0;
    lane_set(&b->delay, lane, (double)c->delay);
    lane_set(&b->lags, lane, actuators_lag(c));
    lane_set(&b->actuators.at, lane, -1);
    lane_set(&b->actuators.lag, lane, c->lag);
    lane_set(&b->actuators.rate, lane, c->torque_rate > 0 ? c->torque_rate : INFINITY);
    lane_set(&b->actuators.left, lane, c->lag > 0 ? actuator_exp(-c->step / c->lag) : 0);
    bundle_clear_answers(b, lane);
    advance_load(&b->advance, lane, c);
    lane_set(&b->h, lane, c->step);
    lane_set(&b->steps, lane, (double)c->steps);
    lane_set(&b->most_work, lane, BUNDLE_WORK + BUNDLE_WORK_STEP * (double)c->steps);
    lane_set(&b->sample_every, lane, (double)case_samples(c));
    if (case_samples(c) == 0)
        lane_set(&b->next_sample, lane, INFINITY);
    lane_set(&b->next_record, lane, c->trajectory && c->trajectory->rows > 0 ? 0 : INFINITY);
    b->row[lane] = 0;
    const lanes until = scene_pushed_until(&b->set.body);
    lane_set(&b->pushed_until, lane, lane_get(&until, lane));
#ifdef ADVANCE_PIECES
    lane_set(&b->piece_from, lane, 0);
    lane_set(&b->piece_to, lane, c->step);
    report_clear_lane(&b->pieces, lane);
#endif
    /* What a program remembers no equilibrium tells: such a case has to stay there. */
    lane_set(&b->judge_on_way, lane, c->settle && !(c->program && c->program->remembers));
    lane_set(&b->has_target, lane, c->has_target);
    for (int i = 0; i < OWN_CONTACTS; i++) {
        lane_set(&b->mine[i], lane, c->supports >> i & 1);
        lane_set(&b->left_out[i], lane, contact_grip(i) >= 0 && !(c->contacts >> i & 1));
        lane_set(&b->ahead[i], lane,
                 c->lands_ahead && contact_grip(i) >= 0 && (c->contacts >> i & 1));
    }
    lane_set(&b->foot, lane, -1);
    lane_set(&b->leg, lane, 0);
    b->walk[lane] = (struct walking){.last = -INFINITY, .change = INFINITY};
    lane_set(&b->stands, lane, -1);
    lane_set(&b->ended, lane, -1);
    lane_set(&b->walks, lane, 0);
    lane_set(&b->effort, lane, 0);
    lane_set(&b->inside, lane, 0);
    lane_set(&b->angle_scale, lane, 1 / c->settle_angle);
    lane_set(&b->rate_scale, lane, 1 / c->settle_rate);
    lane_set(&b->settle_steps, lane, nearbyint(c->settle_hold / c->step));
    lane_set(&b->place, lane, c->settle_place > 0 ? c->settle_place : INFINITY);
}

/* Gaps, approach and trigonometry of freshly loaded lanes. A standing foot is exactly closed. */
static void bundle_begin(struct bundle *b, mask fresh)
{
    scene_trig trig;
    scene_trigonometry(b->now.s, &trig);
    choose_all(fresh, &trig, &b->now.trig, sizeof trig);
    for (int c = 0; c < OWN_CONTACTS; c++) {
        lanes u[2];
        scene_contact_velocity(&b->set.body, &trig, c, b->now.w, u);
        b->now.gap[c] = choose(fresh, scene_gap(&b->set.body, b->now.s, &trig, c), b->now.gap[c]);
        b->now.approach[c] = choose(fresh, u[0], b->now.approach[c]);
        if (contact_grip(c) >= 0)
            b->began[c] = choose(fresh, scene_along(&b->set.body, b->now.s, &trig, c), b->began[c]);
    }
    struct motion begin = b->now;
    motion_energy(&b->set, &begin);
    b->now.kinetic = choose(fresh, begin.kinetic, b->now.kinetic);
    b->now.energy = choose(fresh, begin.energy, b->now.energy);
    b->energy_bound = choose(fresh, begin.energy, b->energy_bound);
}

#endif
