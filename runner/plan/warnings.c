/* warnings.c - see warnings.h. Linear theory about the equilibrium, as `stance design` has it. */
#include "warnings.h"

#include "design.h"
#include "instruction_set.h"

#include "runner/base/problem.h"
#include "runner/base/units.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { TRIED = 64 }; /* cases, evenly spread */
#define MUCH 0.005   /* of the range: that far the equilibrium may be from the nearest start */
static const double moment = 0.5; /* s */

#define ELASTIC 0.99 /* restitution from which on little energy is meant to be lost */
#define INSIDE 1e-9  /* m: deeper in the ground is inside */

enum trouble { UNSTABLE, WEAK, SLIPPERY, UNSETTLED, NOISY, BURIED, LOSSY, TROUBLES };

/* Of each trouble: how many cases have it, and of the first one the case and what is wrong. */
struct troubles {
    size_t count[TROUBLES];
    uint64_t first[TROUBLES];
    char what[TROUBLES][240];
};

static bool first_of(struct troubles *t, enum trouble trouble, uint64_t index)
{
    if (t->count[trouble]++ > 0)
        return false;
    t->first[trouble] = index;
    return true;
}

static void look_at_torques(const struct design_report *r, uint64_t index, struct troubles *t)
{
    const stance_scene *const scene = r->scenario->scene;
    double limit[STANCE_MAX_ACTUATORS];
    stance_torque_limits(scene, r->scenario->base.robot, r->scenario->base.torque_limit,
                         r->scenario->base.torque_limits, limit);
    for (int i = 0; i < scene->actuators; i++) {
        const double needed = fabs(r->equilibrium.torque[i]);
        if (needed > limit[i] && first_of(t, WEAK, index))
            snprintf(t->what[WEAK], sizeof t->what[WEAK],
                     "the equilibrium takes %.3g of %.40s, which gives %.3g at most", needed,
                     scene->actuator_name[i], limit[i]);
        if (needed > limit[i])
            return;
    }
}

/* At the equilibrium, where contacts stick. */
static void look_at_friction(const struct design_report *r, uint64_t index, struct troubles *t)
{
    enum { STATES = 2 * STANCE_MAX_POSTURE };
    const stance_scene *const scene = r->scenario->scene;
    double force[STANCE_MAX_CONTACTS][2];
    double by_state[STANCE_MAX_CONTACTS * 2 * DESIGN_STATES];
    double by_torque[STANCE_MAX_CONTACTS * 2 * DESIGN_INPUTS];
    if (scene->contact_force(scene, r->model, &r->equilibrium, &force[0][0], by_state, by_torque) !=
        STANCE_OK)
        return;
    for (int c = 0, k = 0; c < scene->contacts; c++) {
        if (!(r->equilibrium.supports >> c & 1))
            continue;
        const double used = fabs(force[k][1]) / force[k][0];
        k++;
        if (!(used > r->scenario->base.friction * (1 + 1e-9)) || !(force[k - 1][0] > 0))
            continue;
        if (first_of(t, SLIPPERY, index))
            snprintf(t->what[SLIPPERY], sizeof t->what[SLIPPERY],
                     "standing on %.40s takes friction %.3g, there is %.3g", scene->contact_name[c],
                     used, r->scenario->base.friction);
        return;
    }
}

/* What the linear loop makes of noise, beside the window of settling and the torque limits. */
static void look_at_noise(const struct design_report *r, uint64_t index, struct troubles *t)
{
    const stance_scene *const scene = r->scenario->scene;
    const struct scenario_values *const values = &r->scenario->base;
    double limit[STANCE_MAX_ACTUATORS];
    bool unsettled = false, noisy = false;
    for (int i = 0; r->noisy && values->settle && i < r->states && !unsettled; i++) {
        const bool rate = i >= r->states / 2;
        char name[SCENARIO_NAME];
        unsettled = r->wander[i] > (rate ? values->settle_rate : values->settle_angle);
        if (unsettled && first_of(t, UNSETTLED, index))
            snprintf(t->what[UNSETTLED], sizeof t->what[UNSETTLED],
                     "noise makes %.40s wander by %.3g rms, more than settle.%s, %.3g",
                     design_state_name(r, i, name), r->wander[i], rate ? "rate" : "angle",
                     rate ? values->settle_rate : values->settle_angle);
    }
    stance_torque_limits(scene, values->robot, values->torque_limit, values->torque_limits, limit);
    for (int k = 0; r->noisy && k < r->inputs && !noisy; k++) {
        const double reserve = limit[k] - fabs(r->equilibrium.torque[k]);
        noisy = reserve > 0 && r->command_noise[k] > reserve;
        if (noisy && first_of(t, NOISY, index))
            snprintf(t->what[NOISY], sizeof t->what[NOISY],
                     "noise on the command of %.40s is %.3g rms, more than the %.3g that its limit "
                     "leaves beside the equilibrium's",
                     scene->actuator_name[k], r->command_noise[k], reserve);
    }
}

static void look_at(const struct plan *plan, uint64_t index, struct troubles *t)
{
    const struct scenario *const s = plan->scenario;
    const struct resolved_design design = plan_design_at(plan, plan_design(plan, index));
    struct scenario *const at = malloc(sizeof *at);
    struct design_report *const r = malloc(sizeof *r);
    stance_message message = {""};
    char late[64], radius[32];
    if (at && r) {
        *at = *s;
        scenario_case_values(s, index, &at->base);
        if (scenario_law(&at->base)->designed && design_loop(r, at, &design, &message)) {
            if (!r->stable && first_of(t, UNSTABLE, index) && r->sampled > 0)
                snprintf(t->what[UNSTABLE], sizeof t->what[UNSTABLE],
                         "the loop is unstable: spectral radius %s at a sample time of %.3g s%s%s",
                         design_radius(r, 3, radius), at->base.sample_time,
                         design_late(r->delay, "", late),
                         r->lag > 0 ? ", with the lag of its actuators" : "");
            else if (!r->stable && !t->what[UNSTABLE][0])
                snprintf(t->what[UNSTABLE], sizeof t->what[UNSTABLE],
                         "the loop is unstable: an eigenvalue is not on the left");
            look_at_torques(r, index, t);
            look_at_friction(r, index, t);
            look_at_noise(r, index, t);
        }
    }
    free(at);
    free(r);
}

/* Contacts that the scenario leaves out, and that begin in the ground. */
static void look_at_ground(const stance_scene *scene, const stance_case *c, uint64_t index,
                           struct troubles *t)
{
    double gap[STANCE_MAX_CONTACTS];
    scene->gaps(scene, c->robot, c->position, gap);
    for (int k = 0; k < scene->contacts; k++) {
        if (c->contacts >> k & 1 || scene->grip[k] < 0 || !(gap[k] < -INSIDE))
            continue;
        if (first_of(t, BURIED, index))
            snprintf(t->what[BURIED], sizeof t->what[BURIED],
                     "%.40s, which ground.contacts leaves out, begins %.3g m below the ground",
                     scene->contact_name[k], -gap[k]);
        return;
    }
}

/* Impacts that keep the energy, by a method that does not. */
static void look_at_impacts(const stance_case *c, const stance_method *method, uint64_t index,
                            struct troubles *t)
{
    const bool loses =
        strcmp(method->name, "implicit") == 0 || strcmp(method->name, "midpoint") == 0;
    if (c->restitution >= ELASTIC && loses && first_of(t, LOSSY, index))
        snprintf(
            t->what[LOSSY], sizeof t->what[LOSSY],
            "restitution %.4g with %s: what it changes the energy by, of the step's length, adds "
            "up where impacts take hardly any (see energy_drift and energy_gain); capturing "
            "keeps it",
            c->restitution, method->name);
}

static void look_at_start(const struct plan *plan, uint64_t row, struct troubles *t)
{
    stance_case *const c = malloc(sizeof *c);
    int method;
    if (c && plan_resolve(plan, row, c, &method)) {
        look_at_ground(plan->scenario->scene, c, plan_case(plan, row), t);
        look_at_impacts(c, stance_methods()[method], plan_case(plan, row), t);
    }
    free(c);
}

/* Initial angles of the first and the last case that are more than a turn. */
static bool look_at_angles(const struct plan *plan, const char *who, FILE *out)
{
    const stance_scene *const scene = plan->scenario->scene;
    stance_case *const c = malloc(sizeof *c);
    bool said = c == NULL;
    for (int end = 0; end < 2 && !said; end++) {
        int method;
        if (!plan_resolve(plan, end ? plan->rows - 1 : 0, c, &method))
            continue;
        for (int i = 0; i < scene->coordinates && !said; i++) {
            said = strcmp(scene->coordinate[i].unit, "rad") == 0 && fabs(c->position[i]) > 2 * M_PI;
            if (said)
                fprintf(out,
                        "%s: warning: %s begins at %g rad, more than a turn: is that %g "
                        "degrees? angles are in radians\n",
                        who, scene->coordinate[i].name, c->position[i], c->position[i]);
        }
    }
    free(c);
    return said;
}

/* Of a sample of parameters shares are wanted, to which the equilibrium is a start as any other. */
static bool is_map(const struct scenario *s)
{
    for (int a = 0; a < s->axes; a++)
        for (int k = 0; k < s->axis[a].paths && s->axis[a].sample; k++)
            if (!scenario_is_start(s->axis[a].path[k]))
                return false;
    return true;
}

/* How far, in cells, 0 lies from the nearest of so many points of an axis. */
static double missed(const struct scenario_axis *axis, size_t count)
{
    const double place = -axis->from / (axis->to - axis->from) * (double)(count - 1);
    return fabs(place - round(place));
}

/* Axes of offsets from below 0 to above it none of whose points is there. */
static void look_at_counts(const struct scenario *s, const char *who, FILE *out)
{
    for (int a = 0; a < s->axes && is_map(s); a++) {
        const struct scenario_axis *axis = &s->axis[a];
        size_t better = axis->count;
        if (axis->count < 2 || axis->from * axis->to >= 0 ||
            strncmp(axis->path[0], "initial.offset.", 15) != 0 ||
            !scenario_is_start(axis->path[0]) ||
            missed(axis, axis->count) <= MUCH * (double)(axis->count - 1))
            continue;
        while (missed(axis, better) > 1e-6 && better < 2 * axis->count)
            better++;
        fprintf(out, "%s: warning: the %zu points of %s leave out the equilibrium, at 0; write ",
                who, axis->count, axis->path[0]);
        if (better < 2 * axis->count)
            fprintf(out, "count: %zu\n", better);
        else
            fprintf(out, "whole multiples of a step as from and to\n");
    }
}

/* Axes along whose line several paths move, which is beside the equilibrium. */
static void look_at_lines(const struct scenario *s, const char *who, FILE *out)
{
    for (int a = 0; a < s->axes; a++) {
        const struct scenario_axis *axis = &s->axis[a];
        const size_t last = axis->count - 1;
        if (axis->sample || axis->from * axis->to >= 0 ||
            strncmp(axis->path[0], "initial.offset.", 15) != 0)
            continue;
        for (int k = 1; k < axis->paths; k++) {
            const double from = scenario_axis_value(axis, 0, k),
                         to = scenario_axis_value(axis, last, k),
                         at = from - axis->from / (axis->to - axis->from) * (to - from);
            if (!scenario_is_start(axis->path[k]) || fabs(at) <= 1e-6 * fabs(to - from))
                continue;
            fprintf(out,
                    "%s: warning: the line of %s misses the equilibrium: it has %s = %.3g where "
                    "that is 0, and distances begin there\n",
                    who, axis->path[0], axis->path[k], at);
            break;
        }
    }
}

/* Whether a body turns: it, or one that it hangs from, does. */
static bool turns(const stance_mechanism *m, int b)
{
    while (b >= 0 && m->body[b].joint != STANCE_HINGE && m->body[b].joint != STANCE_FREE)
        b = m->body[b].parent;
    return b >= 0;
}

/* Bodies of a mass whose inertia was not given: that of a point. */
static void look_at_inertia(const struct scenario *s, const char *who, FILE *out)
{
    const stance_mechanism *const m = s->scene->mechanism;
    const char *point[STANCE_MAX_BODIES];
    char list[300];
    size_t count = 0;
    for (int b = 0; !m->carried && b < m->bodies; b++) {
        const double *const numbers = (const double *)(const void *)&m->value;
        const int place = (int)(&m->value.body[b].inertia - numbers);
        bool given = false;
        for (int i = 0; i < m->numbers; i++)
            given = given || m->number[i] == place;
        if (!given && m->value.body[b].mass > 0 && turns(m, b))
            point[count++] = m->body[b].name;
    }
    if (count > 0)
        fprintf(
            out,
            "%s: warning: %s: no inertia is given, which makes %s; if meant so, write inertia: 0\n",
            who, word_list(list, sizeof list, point, count),
            count > 1 ? "point masses of them" : "a point mass of it");
}

/* Whether what touches the ground at the start carries the robot there on a slope that is steeper
 * by `more`, its joints as they are. */
static bool carried(const struct plan *plan, const stance_case *c, double more)
{
    const stance_scene *const scene = plan->scenario->scene;
    double robot[STANCE_MAX_ROBOT], gap[STANCE_MAX_CONTACTS];
    stance_equilibrium_choice choice = {.supports = 0};
    stance_equilibrium e;
    stance_message ignored;
    memcpy(robot, c->robot, sizeof robot);
    robot[STANCE_ROBOT_SLOPE] += more;
    scene->gaps(scene, robot, c->position, gap);
    for (int i = 0; i < scene->contacts; i++)
        if (scene->grip[i] >= 0 && (c->contacts >> i & 1) && fabs(gap[i]) < 1e-4)
            choice.supports |= UINT32_C(1) << i;
    for (int k = 0; k < scene->postures; k++) /* a free root turns with the ground */
        choice.posture[k] = k == 0 ? NAN : c->position[scene->posture[k]];
    return choice.supports && scene->equilibrium(scene, robot, &choice, &e, &ignored) == STANCE_OK;
}

/* A first start at rest whose centre of mass is exactly above the edge of what it stands on. */
static void look_at_edge(const struct plan *plan, const char *who, FILE *out)
{
    const stance_scene *const scene = plan->scenario->scene;
    const double trifle = 1e-6; /* rad */
    stance_case *const c = malloc(sizeof *c);
    int method;
    bool rests =
        c && scene->mechanism->body[0].joint == STANCE_FREE && plan_resolve(plan, 0, c, &method);
    for (int i = 0; rests && i < scene->coordinates; i++)
        rests = c->velocity[i] == 0;
    if (rests && carried(plan, c, trifle) != carried(plan, c, -trifle))
        fprintf(out,
                "%s: warning: the robot begins with its centre of mass above the very edge of what "
                "it stands on: what becomes of it is decided by rounding\n",
                who);
    free(c);
}

bool warnings_print(const struct plan *plan, const char *who, FILE *out)
{
    const uint64_t tried = plan->rows < TRIED ? plan->rows : TRIED;
    struct troubles t = {{0}, {0}, {""}};
    for (uint64_t k = 0; k < tried; k++) {
        const uint64_t row =
            tried < 2 ? 0 : (uint64_t)((double)(plan->rows - 1) * (double)k / (double)(tried - 1));
        const uint64_t index = plan_case(plan, row);
        if (plan->design_status[plan_design(plan, index)] != STANCE_DONE)
            continue;
        look_at(plan, index, &t);
        look_at_start(plan, row, &t);
    }
    bool any = false;
    for (int k = 0; k < TROUBLES; k++) {
        if (t.count[k] == 0)
            continue;
        any = true;
        fprintf(out, "%s: warning: %s", who, t.what[k]);
        if (tried > 1 && t.count[k] < tried)
            fprintf(out, " (case %" PRIu64 "; so it is in %zu of %" PRIu64 " cases%s)", t.first[k],
                    t.count[k], tried, tried < plan->rows ? ", evenly spread" : "");
        fputc('\n', out);
    }
    look_at_inertia(plan->scenario, who, out);
    look_at_edge(plan, who, out);
    if (!plan->single) {
        look_at_counts(plan->scenario, who, out);
        look_at_lines(plan->scenario, who, out);
    }
    return look_at_angles(plan, who, out) || any;
}

/* ---- ranges ------------------------------------------------------------------------------- */

static bool moves_starts(const struct scenario *s)
{
    for (int a = 0; a < s->axes; a++)
        for (int k = 0; k < s->axis[a].paths; k++)
            if (scenario_is_start(s->axis[a].path[k]))
                return true;
    return false;
}

void warnings_of_ends(const struct scenario *s, const uint64_t *outcome, uint64_t cases, bool tried,
                      const char *who, FILE *out)
{
    const bool held = cases > 0 && outcome[STANCE_STABILISED] == cases && moves_starts(s),
               lost = cases > 1 && outcome[STANCE_FELL] == cases && s->base.settle &&
                      scenario_law(&s->base)->designed;
    char all[80];
    snprintf(all, sizeof all, tried ? "%" PRIu64 " of %" PRIu64 " cases tried: all" : "all cases",
             cases, s->cases);
    if (held)
        fprintf(out,
                "%s: warning: %s are stabilised: the ranges end within the domain; stance ranges "
                "%.300s finds how far it goes\n",
                who, all, s->file);
    else if (lost)
        fprintf(out,
                "%s: warning: %s fell: the ranges do not meet a domain; stance ranges %.300s finds "
                "where one is\n",
                who, all, s->file);
}

/* The point of an axis nearest to the equilibrium; of others than ranges of offsets the middle. */
static size_t middle_point(const struct scenario_axis *axis)
{
    const double last = (double)(axis->count - 1);
    if (axis->value || strncmp(axis->path[0], "initial.offset.", 15) != 0)
        return axis->count / 2;
    return (size_t)fmin(last, fmax(0, round(-axis->from / (axis->to - axis->from) * last)));
}

/* Case k of the lattice {middle, first, last} of all axes, and how many cases it has. */
static uint64_t lattice_case(const struct scenario *s, uint64_t k, uint64_t *cases)
{
    uint64_t index = 0, stride = 1;
    *cases = 1;
    for (int a = s->axes - 1; a >= 0; a--) {
        const uint64_t count = s->axis[a].count, here = count < 3 ? count : 3;
        const uint64_t place[] = {here < 3 ? 0 : middle_point(&s->axis[a]), count - 1, 0};
        index += stride * place[k % here];
        k /= here;
        stride *= count;
        *cases *= *cases < WARNINGS_TRIED ? here : 1;
    }
    return index;
}

/* A lone case that is over where it begins: taken one step, not more. */
static void look_at_beginning(const struct plan *plan, const char *who, FILE *out)
{
    const stance_scene *const scene = plan->scenario->scene;
    const char *word[STANCE_MAX_WORDS];
    stance_case *const c = malloc(sizeof *c);
    stance_result result;
    int method;
    if (c && plan_resolve(plan, 0, c, &method)) {
        const stance_kernel *kernel = instruction_set_kernel(scene, stance_methods()[method]);
        const int words = stance_answer_words(scene, STANCE_ANSWER_fall_cause, word);
        c->steps = c->steps < 1 ? c->steps : 1;
        if (kernel)
            kernel->run(c, &result, 1);
        if (kernel && result.status == STANCE_DONE && result.outcome == STANCE_FELL &&
            result.steps == 0)
            fprintf(out, "%s: warning: the robot has fallen where it begins, by its %s\n", who,
                    result.fall_cause < words ? word[result.fall_cause] : "posture");
    }
    free(c);
}

void warnings_try(const struct plan *plan, const char *who, FILE *out)
{
    const struct scenario *s = plan->scenario;
    const double begin = clock_seconds();
    stance_case *c = calloc(1, sizeof *c);
    stance_result result;
    uint64_t outcome[STANCE_OUTCOME_COUNT] = {0}, count, ended = 0;
    lattice_case(s, 0, &count);
    bool whole = c && s->axes > 0;
    if (s->axes == 0)
        look_at_beginning(plan, who, out);
    for (uint64_t k = 0; k < count && whole; k++) {
        int method;
        uint64_t all;
        if (!plan_resolve(plan, lattice_case(s, k, &all), c, &method))
            continue;
        const stance_kernel *kernel = instruction_set_kernel(s->scene, stance_methods()[method]);
        whole = kernel && clock_seconds() - begin < moment;
        if (!whole)
            break;
        kernel->run(c, &result, 1);
        ended++;
        if (result.status == STANCE_DONE)
            outcome[result.outcome]++;
    }
    if (whole)
        warnings_of_ends(s, outcome, ended, ended < s->cases, who, out);
    free(c);
}
