/* design.c - what control theory says about a scenario's base values: equilibrium, linearisation,
 * controllability, gains, the loop as the controller acts, the set in which the linear picture
 * meets no bound.
 */
#include "design.h"

#include "runner/base/problem.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static bool refuse(stance_message *message, const char *what, stance_error error)
{
    return complain(message, "%s: %s", what, stance_error_text(error));
}

/* ---- the model ------------------------------------------------------------------------------- */

const char *design_supports(const stance_scene *scene, const stance_equilibrium *equilibrium,
                            char *buffer, size_t size)
{
    const char *names[STANCE_MAX_CONTACTS];
    size_t count = 0;
    for (int c = 0; c < scene->contacts; c++)
        if (equilibrium->supports >> c & 1)
            names[count++] = scene->contact_name[c];
    return word_list(buffer, size, names, count);
}

static stance_plant plant_of(const struct design_report *r)
{
    return (stance_plant){r->states, r->inputs, r->A, r->B};
}

/* loop[n][n] = A - B K; with interval > 0 of the model sampled so, torques held in between. */
static stance_error close_loop(const stance_plant *plant, const double *K, double interval,
                               double *loop)
{
    const int n = plant->states, m = plant->inputs;
    const double *const A = plant->A, *const B = plant->B;
    double Ad[DESIGN_STATES * DESIGN_STATES];
    double Bd[DESIGN_STATES * DESIGN_INPUTS];
    if (interval > 0) {
        const stance_error error = stance_discretise(plant, interval, Ad, Bd);
        const stance_plant held = {n, m, Ad, Bd};
        return error == STANCE_OK ? close_loop(&held, K, 0, loop) : error;
    }
    for (int i = 0; i < n; i++) {
        for (int j = 0; j < n; j++) {
            loop[i * n + j] = A[i * n + j];
            for (int k = 0; k < m; k++)
                loop[i * n + j] -= B[i * m + k] * K[k * n + j];
        }
    }
    return STANCE_OK;
}

static bool open_loop(struct design_report *r, stance_message *message)
{
    const stance_scene *scene = r->scenario->scene;
    const struct scenario_values *values = &r->scenario->base;

    if (!resolve_equilibrium(scene, values, r->model, &r->equilibrium, message))
        return false;
    r->remark = *message;
    r->states = 2 * r->equilibrium.freedoms;
    r->normal = 0;
    for (int c = 0; c < scene->contacts; c++)
        r->normal += r->equilibrium.force[c][0];
    stance_error error = scene->linearise(scene, r->model, &r->equilibrium, r->A, r->B);
    if (error != STANCE_OK)
        return refuse(message, "linearisation", error);
    const stance_plant plant = plant_of(r);
    error = stance_eigenvalues(r->states, r->A, r->open_re, r->open_im);
    if (error == STANCE_OK)
        error = stance_kalman(&plant, r->singular, &r->rank);
    return error == STANCE_OK || refuse(message, "eigenvalues and Kalman rank", error);
}

/* ---- what any controller could do ------------------------------------------------------------ */

stance_null_set *design_null_set(const struct design_report *r, stance_message *message)
{
    const struct scenario_values *const values = &r->scenario->base;
    double limit[STANCE_MAX_ACTUATORS], low[STANCE_MAX_ACTUATORS], high[STANCE_MAX_ACTUATORS];
    stance_null_set *set = NULL;
    stance_torque_limits(r->scenario->scene, r->model, values->torque_limit, values->torque_limits,
                         limit);
    for (int i = 0; i < r->inputs; i++) {
        low[i] = -limit[i] - r->equilibrium.torque[i];
        high[i] = limit[i] - r->equilibrium.torque[i];
    }
    const stance_plant plant = plant_of(r);
    stance_null_set_make(&plant, low, high, &set, message);
    return set;
}

static void find_allowed(struct design_report *r)
{
    struct design_allowed *const allowed = &r->allowed;
    stance_null_set *const set = design_null_set(r, &allowed->absent);
    allowed->exists = set != NULL;
    if (!set)
        return;
    allowed->modes = stance_null_set_modes(set, allowed->re, allowed->im);
    allowed->unreached =
        stance_null_set_unreached(set, allowed->unreached_re, allowed->unreached_im);
    for (int i = 0; i < r->states; i++)
        for (int side = 0; side < 2; side++) {
            double x[DESIGN_STATES] = {0};
            x[i] = side ? 1 : -1;
            const double gauge = stance_null_set_gauge(set, x);
            allowed->reach[side][i] = gauge == 0     ? x[i] * INFINITY
                                      : isinf(gauge) ? 0
                                                     : x[i] / gauge;
        }
    stance_null_set_free(set);
}

/* ---- the loop -------------------------------------------------------------------------------- */

/* A law of the user's own is asked by central differences about the equilibrium, standing there. */
static bool program_gains(struct design_report *r, stance_message *message)
{
    static const double width = 1e-5; /* rad, m, rad/s, m/s */
    const stance_scene *const scene = r->scenario->scene;
    const struct scenario_values *const values = &r->scenario->base;
    const stance_program *const program = values->program;
    const int n = scene->coordinates;
    stance_case *const c = calloc(1, sizeof *c);
    bool good = c || complain(message, "not enough memory");
    if (c) {
        *c = (stance_case){.scene = scene, .has_target = true, .program = program};
        memcpy(c->parameter, values->parameter, sizeof c->parameter);
        memcpy(c->near.feedforward, r->equilibrium.torque, sizeof c->near.feedforward);
        for (int k = 0; k < scene->postures; k++)
            c->near.target[k] = r->equilibrium.position[scene->posture[k]];
    }
    for (int j = 0; good && j < r->states; j++) {
        const int k = resolve_state(scene, &r->equilibrium, j), rate = k >= scene->postures;
        const int place = scene->posture[k % scene->postures];
        double torque[2][STANCE_MAX_ACTUATORS];
        for (int side = 0; good && side < 2; side++) {
            double *const sample = program->begin(program, c);
            double *const q = sample ? sample + STANCE_SAMPLE_HEAD : NULL;
            if (sample) {
                memset(sample, 0, STANCE_SAMPLE_HEAD * sizeof *sample);
                sample[STANCE_SAMPLE_PERIOD] = values->sample_time;
                memcpy(q, r->equilibrium.position, (size_t)n * sizeof *q);
                memset(q + n, 0, (size_t)n * sizeof *q);
                for (int g = 0; g < scene->contacts; g++)
                    q[2 * n + g] = r->equilibrium.supports >> g & 1;
                q[place + (rate ? n : 0)] += side ? width : -width;
            }
            const double *const got = sample ? program->act(program, c, sample) : NULL;
            good = got || complain(message, "the law of controller.file has no torques there");
            if (got)
                memcpy(torque[side], got, (size_t)r->inputs * sizeof *got);
            program->end(program, sample);
        }
        for (int i = 0; good && i < r->inputs; i++)
            r->K[i * r->states + j] = (torque[0][i] - torque[1][i]) / (2 * width);
    }
    free(c);
    return good;
}

/* K, of a law that is not designed too: what it is as a gain matrix; and where it bends. known: the
 * design, NULL: it is made. */
static bool gains(struct design_report *r, const struct resolved_design *known,
                  stance_message *message)
{
    const stance_scene *const scene = r->scenario->scene;
    const struct scenario_values *const values = &r->scenario->base;
    const double begin[STANCE_MAX_COORDINATES] = {0};
    stance_case c = {0};

    const stance_plant plant = plant_of(r);
    r->how = (stance_robustness){0, NAN};
    const stance_law *const law = scenario_law(values);
    if (law->designed && !known &&
        !resolve_gains(scene, values, &r->equilibrium, &plant, r->K, &r->how, message))
        return false;
    if (!law->designed && r->states < 2 * scene->postures)
        return complain(message, "a law that is not designed acts on what the contacts hold, too: "
                                 "it has no gains here");
    if (law->program)
        return program_gains(r, message);
    if (!resolve_law(scene, values, law, begin, &c.near, &c, message))
        return false;
    r->bends = c.bends;
    for (int j = 0; j < r->states; j++)
        r->plane[j] = c.bend.normal[resolve_state(scene, &r->equilibrium, j)];
    memcpy(r->push, c.bend.push, sizeof r->push);
    const double(*const gain)[2 * STANCE_MAX_POSTURE] =
        !law->designed ? (const double(*)[2 * STANCE_MAX_POSTURE]) c.near.gain
        : known        ? (const double(*)[2 * STANCE_MAX_POSTURE]) known->gain
                       : NULL;
    for (int i = 0; i < r->inputs && gain; i++)
        for (int j = 0; j < r->states; j++)
            r->K[i * r->states + j] = gain[i][resolve_state(scene, &r->equilibrium, j)];
    return true;
}

/* The plant behind its actuators, as torques are commanded, and how that samples. */
struct acting {
    stance_plant plant;
    stance_sampling loop;
    double A[DESIGN_PLANT * DESIGN_PLANT], B[DESIGN_PLANT * DESIGN_INPUTS];
    double K[DESIGN_INPUTS * DESIGN_PLANT];
};

static void act(const struct design_report *r, double lag, int delay, struct acting *p)
{
    p->plant = plant_of(r);
    p->loop = (stance_sampling){r->K, r->scenario->base.sample_time, delay};
    if (lag <= 0)
        return;
    stance_lagged(&p->plant, r->K, lag, p->A, p->B, p->K);
    p->plant = (stance_plant){r->states + r->inputs, r->inputs, p->A, p->B};
    p->loop.K = p->K;
}

/* Its spectral radius, with the eigenvalues in re and im. */
static stance_error radius_of(const struct design_report *r, double lag, int delay, double *radius,
                              double *re, double *im)
{
    struct acting p;
    act(r, lag, delay, &p);
    *radius = 0;
    const stance_error error = stance_sampled_loop(&p.plant, &p.loop, re, im);
    for (int i = 0; error == STANCE_OK && i < p.plant.states + delay * r->inputs; i++)
        *radius = fmax(*radius, hypot(re[i], im[i]));
    return error;
}

/* The loop as the controller acts. */
static stance_error sampled_loop(struct design_report *r)
{
    stance_error error = STANCE_OK;
    r->stable = true;
    for (int i = 0; i < r->states; i++)
        r->stable &= r->closed_re[i] < 0;
    r->sampled = 0;
    if (r->scenario->base.sample_time > 0) {
        r->sampled = r->states + (r->delay + (r->lag > 0 ? 1 : 0)) * r->inputs;
        error = radius_of(r, r->lag, r->delay, &r->radius, r->sampled_re, r->sampled_im);
        r->stable = r->radius < 1;
    }
    return error;
}

/* ---- how late and how slowly it may act, and what noise does --------------------------------- */

#define MARGIN_LEAST 1e-3 /* of the sample time: the shortest lag that is looked at */
#define MARGIN_RATIO 1.1  /* of neighbouring lags */

static stance_error find_lag_margin(struct design_report *r)
{
    const double least = MARGIN_LEAST * r->scenario->base.sample_time;
    double re[DESIGN_LOOP], im[DESIGN_LOOP], radius = 0, below = 0, above = least;
    stance_error error = STANCE_OK;
    for (; above < DESIGN_LONGEST && error == STANCE_OK; above *= MARGIN_RATIO) {
        error = radius_of(r, above, r->delay, &radius, re, im);
        if (radius >= 1)
            break;
        below = above;
    }
    r->lag_margin = radius >= 1 ? above : INFINITY;
    for (double lag = 0.5 * (below + above);
         radius >= 1 && error == STANCE_OK && lag > below && lag < r->lag_margin;
         lag = 0.5 * (below + r->lag_margin)) {
        double of;
        error = radius_of(r, lag, r->delay, &of, re, im);
        if (of < 1)
            below = lag;
        else
            r->lag_margin = lag;
    }
    return error;
}

/* Uniform noise of half-width a has the variance a^2 / 3. A command has at least that of what is
 * measured, K x, beside that of the states, which wander. */
static stance_error find_wander(struct design_report *r)
{
    const struct scenario_values *const values = &r->scenario->base;
    double measured[DESIGN_PLANT] = {0}, rms[DESIGN_PLANT];
    struct acting p;
    r->noisy = r->sampled && r->stable &&
               (values->noise > 0 || values->angle_noise > 0 || values->rate_noise > 0);
    if (!r->noisy)
        return STANCE_OK;
    for (int i = 0; i < r->states; i++) {
        const double half = i < r->states / 2 ? values->angle_noise : values->rate_noise;
        measured[i] = half * half / 3;
    }
    act(r, r->lag, r->delay, &p);
    const stance_error error =
        stance_sampled_wander(&p.plant, &p.loop, measured, values->noise * values->noise / 3, rms);
    memcpy(r->wander, rms, sizeof r->wander);
    for (int k = 0; k < r->inputs; k++) {
        double variance = values->noise * values->noise / 3;
        for (int i = 0; i < r->states; i++)
            variance += r->K[k * r->states + i] * r->K[k * r->states + i] * measured[i];
        r->command_noise[k] = sqrt(variance);
    }
    return error;
}

static stance_error margins(struct design_report *r)
{
    double re[DESIGN_LOOP], im[DESIGN_LOOP], radius = 0;
    stance_error error = STANCE_OK;
    struct acting p;
    for (int late = 0; late < 2 && error == STANCE_OK; late++) {
        act(r, r->lag, late ? (r->delay > 1 ? r->delay : 1) : 0, &p);
        error = stance_critical_sample_time(&p.plant, &p.loop, DESIGN_LONGEST, &r->critical[late]);
    }
    if (error != STANCE_OK || !r->sampled || !r->stable)
        return error;
    for (int d = 0; d <= STANCE_MAX_DELAY && error == STANCE_OK && radius < 1; d++) {
        error = radius_of(r, r->lag, d, &radius, re, im);
        r->delay_margin = radius < 1 ? d : r->delay_margin;
    }
    return error == STANCE_OK ? find_lag_margin(r) : error;
}

/* ---- the sublevel set ------------------------------------------------------------------------ */

static const char *why_no_set(const struct design_report *r)
{
    if (!scenario_law(&r->scenario->base)->designed)
        return "only for state feedback on one foot";
    if (r->equilibrium.supports == 0 ||
        (r->equilibrium.supports & (r->equilibrium.supports - 1)) != 0)
        return "only for a robot that stands on one contact";
    if (r->delay)
        return "not for a loop with a delay";
    if (r->lag > 0 || isfinite(r->scenario->base.torque_rate))
        return "not for actuators with a lag or a limited rate";
    return r->stable ? NULL : "the loop is not stable";
}

/* Half spaces a X <= d in which the linear picture meets no bound, X the departure from the
 * equilibrium, in the order of design_bound_name: all but the plane. */
static stance_error linear_bounds(const struct design_report *r, double *a, double *d)
{
    const int n = r->states, m = r->inputs;
    const struct scenario_values *const values = &r->scenario->base;
    double force[2], by_state[2 * DESIGN_STATES], by_torque[2 * DESIGN_INPUTS],
        limit[STANCE_MAX_ACTUATORS];
    const stance_error error = r->scenario->scene->contact_force(
        r->scenario->scene, r->model, &r->equilibrium, force, by_state, by_torque);

    for (int j = 0; error == STANCE_OK && j < n; j++) {
        double loop[2];
        for (int c = 0; c < 2; c++) {
            loop[c] = by_state[c * n + j];
            for (int i = 0; i < m; i++)
                loop[c] -= by_torque[c * m + i] * r->K[i * n + j];
        }
        for (int i = 0; i < m; i++) {
            a[2 * i * n + j] = -r->K[i * n + j];
            a[(2 * i + 1) * n + j] = r->K[i * n + j];
        }
        a[2 * m * n + j] = loop[1] - values->friction * loop[0];
        a[(2 * m + 1) * n + j] = -loop[1] - values->friction * loop[0];
        a[(2 * m + 2) * n + j] = -loop[0];
    }
    stance_torque_limits(r->scenario->scene, values->robot, values->torque_limit,
                         values->torque_limits, limit);
    for (int i = 0; i < m; i++) {
        d[2 * i] = limit[i] - r->equilibrium.torque[i];
        d[2 * i + 1] = limit[i] + r->equilibrium.torque[i];
    }
    d[2 * m] = values->friction * force[0] - force[1];
    d[2 * m + 1] = values->friction * force[0] + force[1];
    d[2 * m + 2] = force[0];
    return error;
}

static bool sublevel(struct design_report *r, stance_message *message)
{
    const int n = r->states, m = r->inputs;
    const struct scenario_values *values = &r->scenario->base;
    double loop[DESIGN_STATES * DESIGN_STATES], weight[DESIGN_STATES];
    double a[DESIGN_BOUNDS * DESIGN_STATES], d[DESIGN_BOUNDS];
    struct design_set *set = &r->set;

    set->absent = why_no_set(r);
    set->exists = !set->absent;
    if (!set->exists)
        return true;
    for (int i = 0; i < n; i++) {
        const double tolerance = i < n / 2 ? values->settle_angle : values->settle_rate;
        weight[i] = 1 / (tolerance * tolerance);
    }
    const stance_plant plant = plant_of(r);
    stance_error error = close_loop(&plant, r->K, r->sampled ? values->sample_time : 0, loop);
    if (error == STANCE_OK &&
        stance_lyapunov(n, loop, r->sampled > 0, weight, set->P, message) != STANCE_OK) {
        set->exists = false; /* on the border of stability */
        set->absent = "the loop is on the border of stability";
        return true;
    }
    if (error == STANCE_OK)
        error = linear_bounds(r, a, d);
    if (error == STANCE_OK) {
        memcpy(&a[(2 * m + 3) * n], r->plane, (size_t)n * sizeof *a);
        d[2 * m + 3] = 1;
        error = stance_sublevel(n, set->P, &(stance_bounds){2 * m + 3 + r->bends, a, d}, &set->of);
    }
    return error == STANCE_OK || refuse(message, "Lyapunov function", error);
}

/* Gains, eigenvalues, and whether it is stable as the controller acts. */
static bool loop(struct design_report *r, const struct resolved_design *known,
                 stance_message *message)
{
    const int n = r->states;
    const stance_plant plant = plant_of(r);
    double matrix[DESIGN_STATES * DESIGN_STATES];

    const stance_program *const program = r->scenario->base.program;
    const bool known_law =
        !scenario_law(&r->scenario->base)->program || (program && !program->remembers);
    r->closed = r->scenario->base.law != 0 && known_law;
    r->delay = r->scenario->base.delay;
    r->lag = r->scenario->base.lag;
    if (!r->closed)
        return true;
    if (!gains(r, known, message))
        return false;
    stance_error error = close_loop(&plant, r->K, 0, matrix);
    if (error == STANCE_OK)
        error = stance_eigenvalues(n, matrix, r->closed_re, r->closed_im);
    if (error == STANCE_OK && r->bends) {
        double beyond[DESIGN_INPUTS * DESIGN_STATES];
        design_beyond(r, beyond);
        error = close_loop(&plant, beyond, 0, matrix);
        if (error == STANCE_OK)
            error = stance_eigenvalues(n, matrix, r->beyond_re, r->beyond_im);
    }
    if (error == STANCE_OK)
        error = sampled_loop(r);
    if (error == STANCE_OK)
        error = find_wander(r);
    return error == STANCE_OK || refuse(message, "closed loop", error);
}

bool design_plant(struct design_report *r, const struct scenario *s, stance_message *message)
{
    *r = (struct design_report){.scenario = s, .inputs = s->scene->actuators};
    return open_loop(r, message);
}

bool design_loop(struct design_report *r, const struct scenario *s,
                 const struct resolved_design *known, stance_message *message)
{
    return design_plant(r, s, message) && loop(r, known, message);
}

bool design_compute(struct design_report *r, const struct scenario *s, stance_message *message)
{
    if (!design_loop(r, s, NULL, message))
        return false;
    find_allowed(r);
    const stance_error error = r->closed ? margins(r) : STANCE_OK;
    if (error != STANCE_OK)
        return refuse(message, "closed loop", error);
    return !r->closed || sublevel(r, message);
}

void design_beyond(const struct design_report *r, double *K)
{
    for (int i = 0; i < r->inputs; i++)
        for (int j = 0; j < r->states; j++)
            K[i * r->states + j] = r->K[i * r->states + j] + r->push[i] * r->plane[j];
}

/* ---- names ----------------------------------------------------------------------------------- */

const char *design_state_name(const struct design_report *r, int i, char name[SCENARIO_NAME])
{
    const int p = r->equilibrium.freedoms;
    const char *coordinate = r->scenario->scene->coordinate[r->equilibrium.freedom[i % p]].name;
    snprintf(name, SCENARIO_NAME, "%s%s", i < p ? "" : "v", coordinate);
    return name;
}

const char *design_radius(const struct design_report *r, int digits, char text[32])
{
    do {
        snprintf(text, 32, "%.*g", digits, r->radius);
    } while (r->radius != 1 && strtod(text, NULL) == 1 && digits++ < 17);
    return text;
}

/* ", acting 2 samples late", or nothing. Returns buffer. */
const char *design_late(int delay, const char *verb, char buffer[64])
{
    if (delay == 0)
        buffer[0] = '\0';
    else if (delay == 1)
        snprintf(buffer, 64, ", %sa sample late", verb);
    else
        snprintf(buffer, 64, ", %s%d samples late", verb, delay);
    return buffer;
}

const char *design_bound_name(const struct design_report *r, int bound, char name[64])
{
    const int torques = 2 * r->inputs;
    if (bound < 0) {
        snprintf(name, 64, "none");
    } else if (bound < torques) {
        snprintf(name, 64, "torque limit of %.20s, %s",
                 r->scenario->scene->actuator_name[bound / 2], bound % 2 ? "negative" : "positive");
    } else if (bound < torques + 2) {
        snprintf(name, 64, "friction cone, force %s", bound == torques ? "forward" : "backward");
    } else {
        snprintf(name, 64, bound == torques + 2 ? "lift-off" : "plane beyond which torques bend");
    }
    return name;
}
