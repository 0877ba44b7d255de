/* plan.c - what a plan is: its rows, where things are, and one row resolved. */
#include "plan.h"
#include "instruction_set.h"

#include "runner/base/command.h"
#include "runner/base/message.h"
#include "runner/base/numbers.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
    MOST_DESIGNS = 1 << 22, /* 2.2 GB */
    TRACE_ROWS = 1000000,
};
static const double trace_interval = 0.01;
static const double most_instants = 1e8;    /* in one trajectory */
static const double most_recorded = 0x1p48; /* in all of them: the file's size is a 64-bit number */

/* ---- making ------------------------------------------------------------------------------- */

/* false: more instants than can be. */
static bool plan_trajectories(struct plan *plan, bool trace, struct plan_error *error)
{
    const struct scenario *s = plan->scenario;
    double shortest, stop;
    struct scenario_values values;

    scenario_extent(s, offsetof(struct scenario_values, stop_time), &shortest, &stop);

    if (plan->single) {
        scenario_case_values(s, plan->single_case, &values);
        stop = values.stop_time;
        if (!trace)
            return true;
        plan->record_interval = s->record_every;
        if (plan->record_interval <= 0)
            plan->record_interval = fmax(trace_interval, fmax(values.step, stop / TRACE_ROWS));
        plan->record_cases = 1;
    } else {
        if (s->record_cases == RECORD_NONE || s->record_every <= 0)
            return true;
        plan->record_interval = s->record_every;
        plan->record_cases = s->record_cases == RECORD_ALL ? s->cases : s->record_count;
    }
    /* A run counts whole steps and may end a hair before its last instant. */
    const double rows = floor(stop / plan->record_interval + 1e-6) + 1;
    const double cases = (double)plan->record_cases;
    if (rows > most_instants || rows * cases > most_recorded) {
        snprintf(
            error->message.text, sizeof error->message.text,
            "record.every: %.6g s makes %.6g instants in %.6g trajector%s; at most %.3g in one "
            "and %.3g in all are recorded",
            plan->record_interval, rows, cases, plan->record_cases == 1 ? "y" : "ies",
            most_instants, most_recorded);
        scenario_place(s, error->message.text, &error->line, &error->column);
        return false;
    }
    plan->record_rows = (int64_t)rows;
    return true;
}

static bool methods_run(struct plan *plan, struct plan_error *error)
{
    const struct scenario *s = plan->scenario;
    const size_t method = offsetof(struct scenario_values, method);
    int k;
    const struct scenario_axis *axis = scenario_axis_of(s, method, &k);
    plan->methods_swept = axis != NULL;
    for (int m = 0; stance_methods()[m]; m++) {
        if (!scenario_takes(s, method, m) || instruction_set_kernel(s->scene, stance_methods()[m]))
            continue;
        error->line = axis ? axis->line : 0;
        error->column = axis ? axis->column : 0;
        return complain(&error->message, "method '%s' cannot run scene '%s' in this build",
                        stance_methods()[m]->name, s->scene->name);
    }
    return true;
}

int plan_error_print(const struct scenario *s, const struct plan_error *error)
{
    if (error->line > 0)
        fprintf(stderr, "%s:%d:%d: %s\n", s->file, error->line, error->column, error->message.text);
    else
        fprintf(stderr, "%s: %s\n", s->file, error->message.text);
    return EXIT_USAGE;
}

bool plan_make(struct plan *plan, const struct scenario *scenario, bool single,
               uint64_t single_case, bool trace, struct plan_error *error)
{
    *plan = (struct plan){
        .scenario = scenario, .single = single, .single_case = single_case, .designs = 1};
    *error = (struct plan_error){0};
    plan->rows = single ? 1 : scenario->cases;
    if (!methods_run(plan, error))
        return false;
    for (int a = 0; !single && a < scenario->axes; a++) {
        const struct scenario_axis *axis = &scenario->axis[a];
        if (axis->design && axis->count > MOST_DESIGNS / plan->designs) {
            complain(&error->message,
                     "along its axes the scenario has more than the %d controller designs that are "
                     "kept in memory",
                     MOST_DESIGNS);
            error->line = axis->line;
            error->column = axis->column;
            return false;
        }
        plan->designs *= axis->design ? axis->count : 1;
    }
    if (!plan_trajectories(plan, trace, error))
        return false;
    plan->design_size = resolve_part(scenario->scene, RESOLVED_PARTS).place;
    plan->design = calloc(plan->designs, plan->design_size * sizeof *plan->design);
    plan->design_status = calloc(plan->designs, sizeof *plan->design_status);
    if (!plan->design || !plan->design_status) {
        complain(&error->message, "not enough memory for %zu controller designs", plan->designs);
        plan_free(plan);
        return false;
    }
    return true;
}

bool plan_cut(struct plan *plan, const struct shard *shard, struct plan_error *error)
{
    const struct scenario *s = plan->scenario;
    if (s->refine.given) {
        complain(
            &error->message,
            "sweep.refine: cells need the outcomes of neighbours, which other shards have: run "
            "it under mpirun, or an array along an axis (scenarios/cluster/array.sh)");
        scenario_place(s, error->message.text, &error->line, &error->column);
        return false;
    }
    if (shard->count > plan->rows) {
        return complain(&error->message, "--shard: there are %llu shards but only %llu case%s",
                        (unsigned long long)shard->count, (unsigned long long)plan->rows,
                        plan->rows == 1 ? "" : "s");
    }
    plan->shard = shard_of(shard, plan->rows);
    return true;
}

struct rows plan_share(const struct plan *plan)
{
    const bool cut = plan->shard.count > 0;
    return (struct rows){.count = cut ? shard_rows(&plan->shard) : plan->rows,
                         .shard = cut ? &plan->shard : NULL};
}

void plan_free(struct plan *plan)
{
    free(plan->design);
    free(plan->design_status);
    *plan = (struct plan){0};
}

struct resolved_design plan_design_at(const struct plan *plan, size_t d)
{
    struct resolved_design design;
    resolve_move(plan->scenario->scene, false, &design, &plan->design[d * plan->design_size]);
    return design;
}

void plan_design_put(struct plan *plan, size_t d, const struct resolved_design *design)
{
    struct resolved_design own = *design;
    resolve_move(plan->scenario->scene, true, &own, &plan->design[d * plan->design_size]);
}

void plan_take_design(struct plan *plan, size_t place, const struct plan *from, size_t d)
{
    memcpy(&plan->design[place * plan->design_size], &from->design[d * from->design_size],
           plan->design_size * sizeof *plan->design);
    plan->design_status[place] = from->design_status[d];
}

/* ---- where things are --------------------------------------------------------------------- */

uint64_t plan_case(const struct plan *plan, uint64_t row)
{
    return plan->single ? plan->single_case : row;
}

size_t plan_design(const struct plan *plan, uint64_t index)
{
    const struct scenario *s = plan->scenario;
    size_t design = 0, stride = 1;

    for (int a = s->axes - 1; !plan->single && a >= 0; a--) {
        size_t point = (size_t)(index % s->axis[a].count);
        index /= s->axis[a].count;
        if (s->axis[a].design) {
            design += point * stride;
            stride *= s->axis[a].count;
        }
    }
    return design;
}

uint64_t plan_design_case(const struct plan *plan, size_t design)
{
    const struct scenario *s = plan->scenario;
    uint64_t index = 0, stride = 1;

    if (plan->single)
        return plan->single_case;
    for (int a = s->axes - 1; a >= 0; a--) {
        if (s->axis[a].design) {
            index += stride * (design % s->axis[a].count);
            design /= s->axis[a].count;
        }
        stride *= s->axis[a].count;
    }
    return index;
}

bool plan_recorded(const struct plan *plan, uint64_t row, uint64_t *place)
{
    const struct scenario *s = plan->scenario;
    if (plan->record_rows == 0)
        return false;
    if (plan->single || s->record_cases == RECORD_ALL) {
        *place = row;
        return true;
    }
    *place = numbers_find(s->record_list, s->record_count, row);
    return *place < s->record_count && s->record_list[*place] == row;
}

uint64_t plan_recorded_case(const struct plan *plan, uint64_t place)
{
    if (plan->single)
        return plan->single_case;
    const struct scenario *s = plan->scenario;
    return s->record_cases == RECORD_ALL ? place : s->record_list[place];
}

/* ---- a row ------------------------------------------------------------------------------- */

int plan_method(const struct plan *plan, uint64_t row)
{
    struct scenario_values values;
    if (!plan->methods_swept)
        return plan->scenario->base.method;
    scenario_case_values(plan->scenario, plan_case(plan, row), &values);
    return values.method;
}

bool plan_resolve(const struct plan *plan, uint64_t row, stance_case *out, int *method)
{
    const struct scenario *s = plan->scenario;
    struct scenario_values values;
    stance_message ignored;
    uint64_t index = plan_case(plan, row);
    size_t design = plan_design(plan, index);

    scenario_case_values(s, index, &values);
    if (method)
        *method = values.method;
    if (plan->design_status[design] != STANCE_DONE)
        return false;
    const struct resolved_design own = plan_design_at(plan, design);
    return resolve_case(s, &values, &own, index, out, &ignored);
}
