/* warnings.c - see warnings.h. Linear theory about the equilibrium, as `stance design` has it. */
#include "warnings.h"

#include "design.h"
#include "ground_line.h"
#include "instruction_set.h"

#include "runner/base/problem.h"
#include "runner/base/units.h"

#include <inttypes.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { TRIED = 64 }; /* cases, evenly spread */
#define MUCH 0.005   /* of the range: that far the equilibrium may be from the nearest start */
static const double moment = 0.5; /* s */

#define ELASTIC 0.99 /* restitution from which on little energy is meant to be lost */
#define INSIDE 1e-9  /* m: deeper in the ground is inside */

enum trouble { UNSTABLE, WEAK, SLIPPERY, UNSETTLED, NOISY, ALOFT, BURIED, LOSSY, TROUBLES };

/* Of each trouble: how many cases have it, and of the first one the case and what is wrong. */
struct troubles {
    uint64_t index; /* of the case that is looked at */
    size_t count[TROUBLES];
    uint64_t first[TROUBLES];
    char what[TROUBLES][240];
};

__attribute__((format(printf, 3, 4))) static void note(struct troubles *t, enum trouble trouble,
                                                       const char *format, ...)
{
    va_list list;
    if (t->count[trouble]++ > 0)
        return;
    t->first[trouble] = t->index;
    va_start(list, format);
    vsnprintf(t->what[trouble], sizeof t->what[trouble], format, list);
    va_end(list);
}

__attribute__((format(printf, 2, 3))) static void warn(const char *who, const char *format, ...)
{
    char text[1000]; /* in one piece: a launcher mixes what is written in pieces */
    va_list list;
    va_start(list, format);
    vsnprintf(text, sizeof text, format, list);
    va_end(list);
    fprintf(stderr, "%s: warning: %s\n", who, text);
}

static void look_at_torques(const struct design_report *r, const double *limit, struct troubles *t)
{
    const stance_scene *const scene = r->scenario->scene;
    for (int i = 0; i < scene->actuators; i++) {
        const double needed = fabs(r->equilibrium.torque[i]);
        if (needed > limit[i]) {
            note(t, WEAK, "the equilibrium takes %.3g of %.40s, which gives %.3g at most", needed,
                 scene->actuator_name[i], limit[i]);
            return;
        }
    }
}

/* At the equilibrium, where contacts stick. */
static void look_at_friction(const struct design_report *r, struct troubles *t)
{
    const stance_scene *const scene = r->scenario->scene;
    const double friction = r->scenario->base.friction;
    double force[STANCE_MAX_CONTACTS][2];
    double by_state[STANCE_MAX_CONTACTS * 2 * DESIGN_STATES];
    double by_torque[STANCE_MAX_CONTACTS * 2 * DESIGN_INPUTS];
    if (scene->contact_force(scene, r->model, &r->equilibrium, &force[0][0], by_state, by_torque) !=
        STANCE_OK)
        return;
    for (int c = 0, k = 0; c < scene->contacts; c++) {
        if (!(r->equilibrium.supports >> c & 1))
            continue;
        const double normal = force[k][0], used = fabs(force[k][1]) / normal;
        k++;
        if (used > friction * (1 + 1e-9) && normal > 0) {
            note(t, SLIPPERY, "standing on %.40s takes friction %.3g, there is %.3g",
                 scene->contact_name[c], used, friction);
            return;
        }
    }
}

/* What the linear loop makes of noise, beside the window of settling and the torque limits. */
static void look_at_noise(const struct design_report *r, const double *limit, struct troubles *t)
{
    const struct scenario_values *const values = &r->scenario->base;
    for (int i = 0; values->settle && i < r->states; i++) {
        const bool rate = i >= r->states / 2;
        const double window = rate ? values->settle_rate : values->settle_angle;
        char name[SCENARIO_NAME];
        if (r->wander[i] > window) {
            note(t, UNSETTLED, "noise makes %.40s wander by %.3g rms, more than settle.%s, %.3g",
                 design_state_name(r, i, name), r->wander[i], rate ? "rate" : "angle", window);
            break;
        }
    }
    for (int k = 0; k < r->inputs; k++) {
        const double reserve = limit[k] - fabs(r->equilibrium.torque[k]);
        if (reserve > 0 && r->command_noise[k] > reserve) {
            note(t, NOISY,
                 "noise on the command of %.40s is %.3g rms, more than the %.3g that its limit "
                 "leaves beside the equilibrium's",
                 r->scenario->scene->actuator_name[k], r->command_noise[k], reserve);
            return;
        }
    }
}

static void look_at_loop(const struct design_report *r, struct troubles *t)
{
    const struct scenario_values *const values = &r->scenario->base;
    double limit[STANCE_MAX_ACTUATORS];
    char late[64], radius[32];
    stance_torque_limits(r->scenario->scene, values->robot, values->torque_limit,
                         values->torque_limits, limit);
    if (!r->stable && r->sampled > 0)
        note(t, UNSTABLE, "the loop is unstable: spectral radius %s at a sample time of %.3g s%s%s",
             design_radius(r, 3, radius), values->sample_time, design_late(r->delay, "", late),
             r->lag > 0 ? ", with the lag of its actuators" : "");
    else if (!r->stable)
        note(t, UNSTABLE, "the loop is unstable: an eigenvalue is not on the left");
    look_at_torques(r, limit, t);
    look_at_friction(r, t);
    if (r->noisy)
        look_at_noise(r, limit, t);
}

/* Contacts that the scenario leaves out, and that begin in the ground; those that stand where there
 * is none. */
static void look_at_ground(const stance_scene *scene, const stance_case *c, struct troubles *t)
{
    double gap[STANCE_MAX_CONTACTS], plane[STANCE_MAX_CONTACTS];
    ground_gaps(c, c->position, gap);
    scene->gaps(scene, c->robot, c->position, plane);
    for (int k = 0; k < scene->contacts; k++) {
        if (c->contacts >> k & 1 && gap[k] > INSIDE && fabs(plane[k]) < INSIDE) {
            note(t, ALOFT,
                 "%.40s begins at height 0, %.3g m above the plate that is there: starts that "
                 "stand do so on the plane",
                 scene->contact_name[k], gap[k]);
            return;
        }
        if (c->contacts >> k & 1 || scene->grip[k] < 0 || !(gap[k] < -INSIDE))
            continue;
        note(t, BURIED, "%.40s, which ground.contacts leaves out, begins %.3g m below the ground",
             scene->contact_name[k], -gap[k]);
        return;
    }
}

/* Impacts that keep the energy, by a method that does not. */
static void look_at_impacts(const stance_case *c, const stance_method *method, struct troubles *t)
{
    const bool loses =
        strcmp(method->name, "implicit") == 0 || strcmp(method->name, "midpoint") == 0;
    if (c->restitution >= ELASTIC && loses)
        note(t, LOSSY,
             "restitution %.4g with %s: what it changes the energy by, of the step's length, adds "
             "up where impacts take hardly any (see energy_drift and energy_gain); capturing "
             "keeps it",
             c->restitution, method->name);
}

/* `c`: for a case, as in all that follow. */
static void look_at(const struct plan *plan, uint64_t row, stance_case *c, struct troubles *t)
{
    const stance_scene *const scene = plan->scenario->scene;
    const struct resolved_design design = plan_design_at(plan, plan_design(plan, t->index));
    struct scenario *const at = malloc(sizeof *at);
    struct design_report *const r = malloc(sizeof *r);
    stance_message ignored;
    int method;
    if (at && r) {
        *at = *plan->scenario;
        scenario_case_values(plan->scenario, t->index, &at->base);
        if (scenario_law(&at->base)->designed && design_loop(r, at, &design, &ignored))
            look_at_loop(r, t);
    }
    if (plan_resolve(plan, row, c, &method)) {
        look_at_ground(scene, c, t);
        look_at_impacts(c, stance_methods()[method], t);
    }
    free(at);
    free(r);
}

/* Initial angles of the first and the last case that are more than a turn. */
static bool look_at_angles(const struct plan *plan, stance_case *c, const char *who)
{
    const stance_scene *const scene = plan->scenario->scene;
    for (int end = 0; end < 2; end++) {
        if (!plan_resolve(plan, end ? plan->rows - 1 : 0, c, NULL))
            continue;
        for (int i = 0; i < scene->coordinates; i++) {
            if (strcmp(scene->coordinate[i].unit, "rad") != 0 || fabs(c->position[i]) <= 2 * M_PI)
                continue;
            warn(who,
                 "%s begins at %g rad, more than a turn: is that %g degrees? angles are in radians",
                 scene->coordinate[i].name, c->position[i], c->position[i]);
            return true;
        }
    }
    return false;
}

/* Whether axes, or (`sample`) that of the sample alone, move starts; or (`other`) something else.
 */
static bool moves(const struct scenario *s, bool sample, bool other)
{
    for (int a = 0; a < s->axes; a++)
        for (int k = 0; k < s->axis[a].paths && (s->axis[a].sample || !sample); k++)
            if (scenario_is_start(s->axis[a].path[k]) != other)
                return true;
    return false;
}

/* Whether an axis goes from offsets below 0 to above it. */
static bool passes_equilibrium(const struct scenario_axis *axis)
{
    return axis->from * axis->to < 0 && strncmp(axis->path[0], "initial.offset.", 15) == 0;
}

/* How far, in cells, 0 lies from the nearest of so many points of an axis. */
static double missed(const struct scenario_axis *axis, size_t count)
{
    const double place = -axis->from / (axis->to - axis->from) * (double)(count - 1);
    return fabs(place - round(place));
}

/* Axes of offsets from below 0 to above it none of whose points is there; of a sample of parameters
 * shares are wanted, to which the equilibrium is a start as any other. */
static void look_at_counts(const struct scenario *s, const char *who)
{
    for (int a = 0; a < s->axes && !moves(s, true, true); a++) {
        const struct scenario_axis *axis = &s->axis[a];
        size_t better = axis->count;
        if (axis->count < 2 || !passes_equilibrium(axis) || !scenario_is_start(axis->path[0]) ||
            missed(axis, axis->count) <= MUCH * (double)(axis->count - 1))
            continue;
        while (missed(axis, better) > 1e-6 && better < 2 * axis->count)
            better++;
        char text[80] = "whole multiples of a step as from and to";
        if (better < 2 * axis->count)
            snprintf(text, sizeof text, "count: %zu", better);
        warn(who, "the %zu points of %s leave out the equilibrium, at 0; write %s", axis->count,
             axis->path[0], text);
    }
}

/* Axes along whose line several paths move, which is beside the equilibrium. */
static void look_at_lines(const struct scenario *s, const char *who)
{
    for (int a = 0; a < s->axes; a++) {
        const struct scenario_axis *axis = &s->axis[a];
        const size_t last = axis->count - 1;
        if (axis->sample || !passes_equilibrium(axis))
            continue;
        for (int k = 1; k < axis->paths; k++) {
            const double from = scenario_axis_value(axis, 0, k),
                         to = scenario_axis_value(axis, last, k),
                         at = from - axis->from / (axis->to - axis->from) * (to - from);
            if (!scenario_is_start(axis->path[k]) || fabs(at) <= 1e-6 * fabs(to - from))
                continue;
            warn(who,
                 "the line of %s misses the equilibrium: it has %s = %.3g where that is 0, and "
                 "distances begin there",
                 axis->path[0], axis->path[k], at);
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
static void look_at_inertia(const struct scenario *s, const char *who)
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
        warn(who, "%s: no inertia is given, which makes %s; if meant so, write inertia: 0",
             word_list(list, sizeof list, point, count),
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
static void look_at_edge(const struct plan *plan, stance_case *c, const char *who)
{
    const stance_scene *const scene = plan->scenario->scene;
    const double trifle = 1e-6; /* rad */
    bool rests = scene->mechanism->body[0].joint == STANCE_FREE && plan_resolve(plan, 0, c, NULL);
    for (int i = 0; rests && i < scene->coordinates; i++)
        rests = c->velocity[i] == 0;
    if (rests && carried(plan, c, trifle) != carried(plan, c, -trifle))
        warn(who, "the robot begins with its centre of mass above the very edge of what it stands "
                  "on: what becomes of it is decided by rounding");
}

bool warnings_print(const struct plan *plan, const char *who)
{
    const uint64_t tried = plan->rows < TRIED ? plan->rows : TRIED;
    stance_case *const c = malloc(sizeof *c);
    struct troubles t = {.index = 0};
    bool any = false;
    for (uint64_t k = 0; c && k < tried; k++) {
        const uint64_t row =
            tried < 2 ? 0 : (uint64_t)((double)(plan->rows - 1) * (double)k / (double)(tried - 1));
        t.index = plan_case(plan, row);
        if (plan->design_status[plan_design(plan, t.index)] == STANCE_DONE)
            look_at(plan, row, c, &t);
    }
    for (int k = 0; k < TROUBLES; k++) {
        char some[120] = "";
        if (t.count[k] == 0)
            continue;
        any = true;
        if (tried > 1 && t.count[k] < tried)
            snprintf(some, sizeof some,
                     " (case %" PRIu64 "; so it is in %zu of %" PRIu64 " cases%s)", t.first[k],
                     t.count[k], tried, tried < plan->rows ? ", evenly spread" : "");
        warn(who, "%s%s", t.what[k], some);
    }
    look_at_inertia(plan->scenario, who);
    if (c)
        look_at_edge(plan, c, who);
    if (!plan->single) {
        look_at_counts(plan->scenario, who);
        look_at_lines(plan->scenario, who);
    }
    any |= c && look_at_angles(plan, c, who);
    free(c);
    return any;
}

/* ---- ranges ------------------------------------------------------------------------------- */

void warnings_of_ends(const struct scenario *s, const uint64_t *outcome, uint64_t cases, bool tried,
                      const char *who)
{
    const bool held = cases > 0 && outcome[STANCE_STABILISED] == cases && moves(s, false, false),
               lost = cases > 1 && outcome[STANCE_FELL] == cases && s->base.settle &&
                      scenario_law(&s->base)->designed;
    char all[80];
    snprintf(all, sizeof all, tried ? "%" PRIu64 " of %" PRIu64 " cases tried: all" : "all cases",
             cases, s->cases);
    if (held)
        warn(who,
             "%s are stabilised: the ranges end within the domain; stance ranges %.300s finds how "
             "far it goes",
             all, s->file);
    else if (lost)
        warn(who,
             "%s fell: the ranges do not meet a domain; stance ranges %.300s finds where one is",
             all, s->file);
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
static void look_at_beginning(const struct plan *plan, stance_case *c, const char *who)
{
    const stance_scene *const scene = plan->scenario->scene;
    const char *word[STANCE_MAX_WORDS];
    stance_result result;
    int method;
    if (!plan_resolve(plan, 0, c, &method))
        return;
    const stance_kernel *const kernel = instruction_set_kernel(scene, stance_methods()[method]);
    const int words = stance_answer_words(scene, STANCE_ANSWER_fall_cause, word);
    c->steps = c->steps < 1 ? c->steps : 1;
    if (kernel)
        kernel->run(c, &result, 1);
    if (kernel && result.status == STANCE_DONE && result.outcome == STANCE_FELL &&
        result.steps == 0)
        warn(who, "the robot has fallen where it begins, by its %s",
             result.fall_cause < words ? word[result.fall_cause] : "posture");
}

void warnings_try(const struct plan *plan, const char *who)
{
    const struct scenario *s = plan->scenario;
    const double begin = clock_seconds();
    stance_case *c = calloc(1, sizeof *c);
    stance_result result;
    uint64_t outcome[STANCE_OUTCOME_COUNT] = {0}, count, ended = 0;
    lattice_case(s, 0, &count);
    bool whole = c && s->axes > 0;
    if (c && s->axes == 0)
        look_at_beginning(plan, c, who);
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
        warnings_of_ends(s, outcome, ended, ended < s->cases, who);
    free(c);
}
