/* truth.c - what a method makes of a truth: cases computed in memory, one for a number that is read
 * as it is, more for derivatives and borders. */
#include "truth.h"

#include "bench.h"

#include "runner/base/message.h"
#include "runner/plan/instruction_set.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Distance of the starts of a difference of four, whose error is its fourth power's. */
static const double apart = 3e-4;
enum { FEW_STEPS = 10 }; /* that tell no cost */
/* Part of the whole between two ends within which a border is found. */
static const double narrow = 1e-8;

/* One case with a method. */
struct trial {
    const struct truth_row *row;
    const stance_method *method;
    double step;
    struct scenario *scenario;
    struct plan plan;
    stance_case *input;
    stance_result result;
    bool planned;
    double budget; /* s, for measuring what the case costs */
    double cost;   /* s */
};

static void close_trial(struct trial *t)
{
    if (t->planned)
        plan_free(&t->plan);
    if (t->scenario)
        scenario_free(t->scenario);
    free(t->scenario);
    free(t->input);
    t->scenario = NULL;
    t->input = NULL;
    t->planned = false;
}

/* Reads the row's scenario with its settings and `more` (NULL: none); `step` 0: as it is there. */
static bool read_scenario(struct trial *t, const char *more, stance_message *message)
{
    const char *set[TRUTH_SETS + 4];
    char method[64], step[64];
    size_t sets = 0;
    for (; sets < t->row->sets; sets++)
        set[sets] = t->row->set[sets];
    snprintf(method, sizeof method, "method.name=%s", t->method->name);
    snprintf(step, sizeof step, "method.step=%.17g", t->step);
    set[sets++] = method;
    if (t->step > 0)
        set[sets++] = step;
    if (more)
        set[sets++] = more;
    t->scenario = calloc(1, sizeof *t->scenario);
    if (!t->scenario)
        return no_memory(message);
    return scenario_read(t->scenario, t->row->scenario, NULL, set, sets, stderr) &&
           (t->scenario->axes == 0 ||
            complain(message, "%.100s has a sweep; a truth is of one case", t->row->scenario));
}

/* Equal steps that fill the time, no longer than a `finer`-th of the scenario's. */
static bool choose_step(struct trial *t, const char *more, double finer, stance_message *message)
{
    t->step = 0;
    const bool good = read_scenario(t, more, message);
    if (good) {
        const double time = t->scenario->base.stop_time, longest = t->scenario->base.step / finer;
        t->step = time / fmax(1, ceil(time / longest - 1e-9));
    }
    close_trial(t);
    return good;
}

/* The quickest of the runs that the budget allows, one at least. */
static void simulate(struct trial *t, const stance_kernel *kernel)
{
    double spent = 0;
    t->cost = INFINITY;
    while (spent == 0 || spent < t->budget) {
        const double begin = bench_clock();
        kernel->run(t->input, &t->result, 1);
        const double time = fmax(bench_clock() - begin, 1e-9);
        t->cost = fmin(t->cost, time);
        spent += time;
    }
}

static bool run_trial(struct trial *t, const char *more, stance_message *message)
{
    const struct parallel alone = parallel_alone();
    struct plan_error error = {0};
    int method;
    if (!read_scenario(t, more, message))
        return false;
    t->input = calloc(1, sizeof *t->input);
    if (!t->input)
        return no_memory(message);
    t->planned = plan_make(&t->plan, t->scenario, true, 0, false, &error);
    if (!t->planned || !plan_compute_designs(&t->plan, &alone, &error))
        return complain(message, "%.200s", error.message.text);
    const stance_kernel *const kernel = instruction_set_kernel(t->scenario->scene, t->method);
    if (!plan_resolve(&t->plan, 0, t->input, &method) || !kernel)
        return complain(message, "the first case does not exist");
    simulate(t, kernel);
    return true;
}

/* ---- what is read -------------------------------------------------------------------------- */

/* A coordinate's place, or a rate's beyond all coordinates; -1: neither. */
static int state_place(const stance_scene *scene, const char *name)
{
    for (int k = 0; k < scene->coordinates; k++) {
        if (strcmp(name, scene->coordinate[k].name) == 0)
            return k;
        if (name[0] == 'v' && strcmp(name + 1, scene->coordinate[k].name) == 0)
            return scene->coordinates + k;
    }
    return -1;
}

static double state(const struct trial *t, int place)
{
    const int n = t->scenario->scene->coordinates;
    return place < n ? t->result.position[place] : t->result.velocity[place - n];
}

static double answer(const struct trial *t, const stance_answer *a)
{
    const char *const at = (const char *)&t->result + a->offset;
    double number;
    int64_t whole;
    switch (a->type) {
    case STANCE_UINT8:
        return *(const uint8_t *)at;
    case STANCE_INT64:
        memcpy(&whole, at, sizeof whole);
        return (double)whole;
    case STANCE_DOUBLE:
        memcpy(&number, at, sizeof number);
        return number;
    }
    return NAN;
}

/* A case that failed has no number but its failure. */
static bool read_off(const struct trial *t, const char *name, double *value,
                     stance_message *message)
{
    const stance_scene *const scene = t->scenario->scene;
    const int place = state_place(scene, name);
    const bool failed = t->result.status != STANCE_DONE;
    *value = NAN;
    for (size_t k = 0; k < STANCE_ANSWER_COUNT; k++) {
        if (strcmp(name, stance_answers[k].name) == 0) {
            if (!failed || k == STANCE_ANSWER_failure)
                *value = answer(t, &stance_answers[k]);
            return true;
        }
    }
    if (place >= 0)
        *value = failed ? NAN : state(t, place);
    else if (strcmp(name, "energy") == 0)
        *value =
            failed ? NAN
                   : scene->energy(scene, t->input->robot, t->result.position, t->result.velocity);
    else
        return complain(message, "nothing is called %.60s there", name);
    return true;
}

/* ---- the three kinds ------------------------------------------------------------------------ */

/* What is read of one case with `more` set; closes it. */
static bool number_of(struct trial *t, const char *more, const char *name, double *value,
                      stance_message *message)
{
    const bool good = run_trial(t, more, message) && read_off(t, name, value, message);
    close_trial(t);
    return good;
}

/* Where a coordinate or rate begins; false: there is no such. */
static bool find_begin(struct trial *t, const char *name, const char **key, double *begin,
                       stance_message *message)
{
    bool good = read_scenario(t, NULL, message);
    if (good) {
        const struct scenario_values *const base = &t->scenario->base;
        const int place = state_place(t->scenario->scene, name);
        *key = base->state_given ? "state" : "offset";
        *begin = place < 0 ? NAN : (base->state_given ? base->state : base->offset)[place];
        good = place >= 0 || complain(message, "no coordinate or rate is called %.60s", name);
    }
    close_trial(t);
    return good;
}

static bool trace(struct trial *t, double *value, stance_message *message)
{
    static const double weight[5] = {1. / 12, -8. / 12, 0, 8. / 12, -1. / 12};
    *value = 0;
    for (size_t k = 0; k < t->row->traces; k++) {
        const char *const name = t->row->trace[k], *key;
        double begin, end;
        if (!find_begin(t, name, &key, &begin, message))
            return false;
        for (int i = 0; i < 5; i++) {
            char more[160];
            if (i == 2)
                continue;
            snprintf(more, sizeof more, "initial.%s.%s=%.17g", key, name, begin + (i - 2) * apart);
            if (!number_of(t, more, name, &end, message))
                return false;
            *value += weight[i] * end / apart;
        }
    }
    return true;
}

/* Whether what is read is above the level at a place of the border's path. Borders along stop.time
 * need equal steps that fill it. */
static bool above(struct trial *t, double place, double finer, bool *is, stance_message *message)
{
    char more[160];
    double read = NAN;
    snprintf(more, sizeof more, "%.100s=%.17g", t->row->border, place);
    const bool good =
        choose_step(t, more, finer, message) && number_of(t, more, t->row->read, &read, message);
    *is = read > t->row->level;
    return good;
}

/* Bisects; NAN where both ends are on one side. */
static bool border(struct trial *t, double finer, double *value, stance_message *message)
{
    double at[2] = {t->row->between[0], t->row->between[1]};
    const double width = narrow * fabs(at[1] - at[0]);
    bool end[2], is;
    if (!above(t, at[0], finer, &end[0], message) || !above(t, at[1], finer, &end[1], message))
        return false;
    while (end[0] != end[1] && fabs(at[1] - at[0]) > width) {
        const double middle = 0.5 * (at[0] + at[1]);
        if (!above(t, middle, finer, &is, message))
            return false;
        at[is == end[1]] = middle;
    }
    *value = end[0] != end[1] ? 0.5 * (at[0] + at[1]) : NAN;
    return true;
}

bool truth_reach(struct truth_reached *reached, const struct truth_row *row,
                 const stance_method *method, double finer, double budget, stance_message *message)
{
    struct trial t = {.row = row, .method = method, .budget = budget};
    const char *const name = row->read ? row->read : row->trace[0];
    double once = NAN;
    *reached = (struct truth_reached){.method = method, .value = NAN};
    bool good = choose_step(&t, NULL, finer, message) && run_trial(&t, NULL, message) &&
                read_off(&t, name, &once, message);
    reached->step = t.step;
    reached->evaluations = (double)t.result.evaluations / t.result.end_time;
    reached->cost = t.result.steps < FEW_STEPS ? NAN : 1e6 * t.cost / t.result.end_time;
    close_trial(&t);
    t.budget = 0;
    if (good && row->kind == TRUTH_AS_READ)
        reached->value = once;
    else if (good && row->kind == TRUTH_AS_TRACE)
        good = trace(&t, &reached->value, message);
    else if (good)
        good = border(&t, finer, &reached->value, message);
    close_trial(&t);
    if (good && isnan(reached->value))
        reached->why =
            t.result.status == STANCE_FAILED ? stance_failure_name[t.result.failure] : "none";
    return good;
}
