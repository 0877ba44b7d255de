/* summary_json.c - the summary for programs; the keys are listed in `stance summary -h`. */
#include "summary.h"

#include "analysis/table/json.h"

#include <math.h>
#include <stdio.h>

static json_t *text_or_null(const char *text)
{
    return text[0] ? json_string(text) : json_null();
}

/* Takes over `value`; a NULL (out of memory, bad UTF-8) becomes null. */
static void put(json_t *object, const char *key, json_t *value)
{
    json_object_set_new(object, key, value ? value : json_null());
}

static json_t *axes(const struct results *r)
{
    json_t *list = json_array();
    for (int a = 0; !r->single && a < r->axes; a++) {
        const struct results_axis *axis = &r->axis[a];
        json_t *entry = json_object();
        put(entry, "path", json_string(axis->name));
        put(entry, "unit", text_or_null(axis->unit));
        put(entry, "long_name", text_or_null(axis->text));
        put(entry, "count", results_json_whole(axis->count));
        put(entry, "first", results_json_value(axis, 0));
        put(entry, "last", results_json_value(axis, axis->count - 1));
        json_array_append_new(list, entry);
    }
    return list;
}

static json_t *fixed(const struct summary *summary)
{
    json_t *object = json_object();
    for (size_t i = 0; i < summary->fields; i++) {
        const struct summary_field *field = &summary->field[i];
        put(object, field->path,
            isnan(field->number) ? json_string(field->text) : results_json_number(field->number));
    }
    return object;
}

static json_t *cases(const struct summary *summary, const struct results *r)
{
    const struct statistics_counts *counts = &summary->counts;
    json_t *object = json_object();
    put(object, "total", results_json_whole(r->cases));
    put(object, "done", results_json_whole(counts->done));
    put(object, "failed", results_json_whole(counts->kind[RESULTS_FAILED]));
    put(object, "pending", results_json_whole(counts->kind[RESULTS_PENDING]));
    put(object, "inferred", results_json_whole(summary->inferred));
    put(object, "damaged", results_json_whole(r->damage.cases));
    return object;
}

static json_t *scenarios(const struct ancestry *ancestry)
{
    json_t *array = json_array();
    for (size_t k = 0; k < ancestry->scenarios; k++) {
        json_t *entry = json_object();
        put(entry, "date", json_string(ancestry->date[k]));
        put(entry, "done", results_json_whole(ancestry->done[k]));
        json_array_append_new(array, entry);
    }
    return array;
}

static json_t *failures(const struct summary *summary)
{
    json_t *object = json_object();
    for (int f = 0; f < SUMMARY_FAILURES; f++)
        if (summary->failures[f] > 0)
            put(object, summary_failure_name(f), results_json_whole(summary->failures[f]));
    return object;
}

static void put_share(json_t *object, uint64_t k, uint64_t n, const struct interval *interval)
{
    put(object, "share", n ? results_json_number((double)k / (double)n) : json_null());
    put(object, "low", results_json_number(interval->low));
    put(object, "high", results_json_number(interval->high));
}

static json_t *outcomes(const struct summary *summary)
{
    const struct statistics_counts *counts = &summary->counts;
    json_t *object = json_object();
    for (int k = 0; k < RESULTS_KIND_COUNT; k++) {
        if (k == RESULTS_PENDING || k == RESULTS_FAILED ||
            (k == RESULTS_DONE && counts->kind[k] == 0))
            continue;
        json_t *entry = json_object();
        put(entry, "count", results_json_whole(counts->kind[k]));
        put_share(entry, counts->kind[k], counts->done, &summary->of_kind[k]);
        put(object, results_kind_names[k], entry);
    }
    return object;
}

static json_t *extents(const struct summary *summary, const struct results *r)
{
    json_t *list = json_array();
    for (int a = 0; a < r->axes; a++) {
        const struct statistics_extent *extent = &summary->extent[a];
        if (!summary->has_extent[a])
            continue;
        json_t *entry = json_object(), *at = json_object();
        for (int b = 0; b < r->axes; b++)
            if (b != a)
                put(at, r->axis[b].name, results_json_value(&r->axis[b], extent->point[b]));
        put(entry, "path", json_string(r->axis[a].name));
        put(entry, "unit", text_or_null(r->axis[a].unit));
        bool known = extent->any || !extent->low_unknown;
        put(entry, "outcome", json_string(results_kind_names[extent->kind]));
        put(entry, "stabilised", known ? json_boolean(extent->any) : json_null());
        put(entry, "low", results_json_number(extent->low));
        put(entry, "high", results_json_number(extent->high));
        put(entry, "low_at_end", json_boolean(extent->low_open));
        put(entry, "high_at_end", json_boolean(extent->high_open));
        put(entry, "low_unknown", json_boolean(extent->low_unknown));
        put(entry, "high_unknown", json_boolean(extent->high_unknown));
        put(entry, "at", at);
        json_array_append_new(list, entry);
    }
    return list;
}

/* The extents at one value of the only axis that is not an offset: both ends, [] where the set does
 * not hold the point nearest to zero, null where that is not known. */
static json_t *extents_at(const struct results *r, int axis, size_t i)
{
    json_t *object = json_object();
    size_t point[SCENARIO_MAX_AXES] = {0};
    struct statistics_extent extent;
    point[axis] = i;
    for (int a = 0; a < r->axes; a++) {
        if (statistics_extent(r, a, point, &extent)) {
            bool known = extent.any || !extent.low_unknown;
            json_t *ends = known ? json_array() : json_null();
            if (extent.any) {
                json_array_append_new(ends, results_json_number(extent.low));
                json_array_append_new(ends, results_json_number(extent.high));
            }
            put(object, r->axis[a].name, ends);
        }
    }
    return object;
}

static json_t *parameter(const struct summary *summary, const struct results *r, int a)
{
    const struct results_axis *axis = &r->axis[a];
    json_t *object = json_object(), *list = json_array();
    for (size_t i = 0; i < axis->count; i++) {
        const struct statistics_counts *counts = &summary->by_value[a][i];
        json_t *entry = json_object();
        put(entry, "value", results_json_value(axis, i));
        put(entry, "done", results_json_whole(counts->done));
        put(entry, "failed", results_json_whole(counts->kind[RESULTS_FAILED]));
        put(entry, "pending", results_json_whole(counts->kind[RESULTS_PENDING]));
        put(entry, "stabilised", results_json_whole(counts->kind[RESULTS_STABILISED]));
        put(entry, "rested", results_json_whole(counts->kind[RESULTS_RESTED]));
        put_share(entry, counts->kind[summary->judged], counts->done, &summary->interval[a][i]);
        if (summary->parameters == 1 && r->sample < 0)
            put(entry, "extents", extents_at(r, a, i));
        json_array_append_new(list, entry);
    }
    put(object, "path", json_string(axis->name));
    put(object, "unit", text_or_null(axis->unit));
    put(object, "share_of", json_string(results_kind_names[summary->judged]));
    put(object, "values", list);
    if (axis->count > 1) {
        json_t *steepest = json_object();
        put(steepest, "from", results_json_value(axis, summary->steepest[a]));
        put(steepest, "to", results_json_value(axis, summary->steepest[a] + 1));
        put(object, "steepest", steepest);
    }
    return object;
}

static json_t *parameters(const struct summary *summary, const struct results *r)
{
    json_t *list = json_array();
    for (int a = 0; a < r->axes; a++)
        if (summary->by_value[a])
            json_array_append_new(list, parameter(summary, r, a));
    return list;
}

static json_t *pairs(const struct summary *summary, const struct results *r)
{
    const struct results_axis *first = &r->axis[summary->pair[0]],
                              *second = &r->axis[summary->pair[1]];
    json_t *object = json_object(), *paths = json_array(), *table = json_array();
    json_array_append_new(paths, json_string(first->name));
    json_array_append_new(paths, json_string(second->name));
    for (size_t i = 0; i < first->count; i++) {
        json_t *row = json_array();
        for (size_t j = 0; j < second->count; j++) {
            const struct statistics_counts *counts = &summary->pair_counts[i * second->count + j];
            json_array_append_new(row, results_json_number(summary_share(summary, counts)));
        }
        json_array_append_new(table, row);
    }
    put(object, "paths", paths);
    put(object, "share", table);
    return object;
}

static json_t *sampled_value(const struct results_varied *v, double value)
{
    return v->word        ? json_string(v->word[(int)value])
           : isinf(value) ? json_string("none")
                          : results_json_number(value);
}

static json_t *sampled(const struct summary *summary, const struct results *r, int k)
{
    const struct results_varied *v = &r->vary[k];
    json_t *entry = json_object(), *list = json_array();
    for (size_t b = 0; b < summary->bins[k].count; b++) {
        const struct doe_bin *bin = &summary->bins[k].bin[b];
        json_t *part = json_object();
        put(part, "from", sampled_value(v, bin->low));
        put(part, "to", sampled_value(v, bin->high));
        put(part, "done", results_json_whole(bin->counts.done));
        const struct interval *interval = &bin->of_kind[summary->judged];
        put(part, "share", results_json_number(summary_share(summary, &bin->counts)));
        put(part, "low", results_json_number(interval->low));
        put(part, "high", results_json_number(interval->high));
        json_array_append_new(list, part);
    }
    put(entry, "path", json_string(v->of.name));
    put(entry, "unit", text_or_null(v->of.unit));
    put(entry, "factor", results_json_whole((uint64_t)v->factor));
    put(entry, "parts", list);
    return entry;
}

static json_t *rays(const struct summary *summary, const struct results *r)
{
    const struct summary_rays *rays = summary->rays;
    json_t *object = json_object(), *at = json_object();
    for (int k = 0; rays->numbers.n > 0 && k < r->varied; k++)
        put(at, r->vary[k].of.name, sampled_value(&r->vary[k], summary_nearest(rays, r, k)));
    put(object, "path", json_string(r->axis[summary->ray_axis].name));
    put(object, "points", results_json_whole(rays->numbers.n));
    put(object, "smallest", results_json_number(rays->numbers.low));
    put(object, "median", results_json_number(rays->numbers.median));
    put(object, "largest", results_json_number(rays->numbers.high));
    put(object, "nearest", rays->numbers.n > 0 ? results_json_whole(rays->nearest) : json_null());
    put(object, "at", at);
    put(object, "reach_end", results_json_whole(rays->open));
    put(object, "none", results_json_whole(rays->none));
    put(object, "unknown", results_json_whole(rays->unknown));
    return object;
}

static json_t *sample(const struct summary *summary, const struct results *r)
{
    json_t *object = json_object(), *list = json_array();
    for (int k = 0; k < r->varied; k++)
        json_array_append_new(list, sampled(summary, r, k));
    put(object, "method", json_string(r->method));
    put(object, "points", results_json_whole(r->axis[r->sample].count));
    put(object, "share_of", json_string(results_kind_names[summary->judged]));
    put(object, "varied", list);
    put(object, "rays", summary->rays ? rays(summary, r) : json_null());
    return object;
}

static json_t *changes(const struct results *r)
{
    json_t *list = json_array();
    for (size_t i = 0; r->axes == 1 && r->sample < 0 && i + 1 < r->cases; i++) {
        if (r->kind[i] != r->kind[i + 1]) {
            json_t *entry = json_object();
            put(entry, "from", results_json_value(&r->axis[0], i));
            put(entry, "to", results_json_value(&r->axis[0], i + 1));
            put(entry, "before", json_string(results_kind_names[r->kind[i]]));
            put(entry, "after", json_string(results_kind_names[r->kind[i + 1]]));
            json_array_append_new(list, entry);
        }
    }
    return list;
}

static json_t *numbers(const struct summary *summary)
{
    json_t *object = json_object();
    for (int k = 0; k < SUMMARY_NUMBER_COUNT; k++) {
        const struct summary_numbers *row = &summary->numbers[k];
        if (!row->stored)
            continue;
        json_t *entry = json_object();
        put(entry, "of",
            json_string(row->of == RESULTS_KIND_COUNT ? "done" : results_kind_names[row->of]));
        put(entry, "unit", text_or_null(row->unit));
        put(entry, "count", results_json_whole(row->numbers.n));
        put(entry, "smallest", results_json_number(row->numbers.low));
        put(entry, "median", results_json_number(row->numbers.median));
        put(entry, "q90", results_json_number(row->numbers.q90));
        put(entry, "q99", results_json_number(row->numbers.q99));
        put(entry, "largest", results_json_number(row->numbers.high));
        put(object, row->name, entry);
    }
    return object;
}

static void put_count(json_t *object, const char *steps_key, const char *cases_key,
                      const struct summary_count *count)
{
    if (count->stored) {
        put(object, steps_key, json_integer((json_int_t)count->sum));
        if (cases_key)
            put(object, cases_key, results_json_whole(count->cases));
    }
}

static json_t *cost(const struct summary *summary)
{
    json_t *object = json_object();
    put_count(object, "steps", NULL, &summary->steps);
    put_count(object, "iterations", NULL, &summary->iterations);
    if (summary->steps.stored && summary->iterations.stored) {
        put(object, "iterations_per_step",
            results_json_number(summary->iterations.sum / summary->steps.sum));
    }
    put_count(object, "evaluations", NULL, &summary->evaluations);
    put_count(object, "events", "events_cases", &summary->events);
    put_count(object, "subdivided_steps", "subdivided_cases", &summary->subdivided);
    put_count(object, "degraded_samples", "degraded_cases", &summary->degraded);
    put_count(object, "ambiguous_steps", "ambiguous_cases", &summary->ambiguous);
    put(object, "wall_time", summary->timed ? results_json_number(summary->longest) : json_null());
    put(object, "total_time", summary->timed ? results_json_number(summary->total) : json_null());
    put(object, "cases_per_second",
        summary->timed ? results_json_number(summary->timed_cases / summary->longest)
                       : json_null());
    return object;
}

static json_t *single_case(const struct results *r)
{
    static const char *const times[] = {"end_time", "settle_time", "fall_time"};
    char name[SCENARIO_MAX_STATES][32];
    double state[SCENARIO_MAX_STATES], time;
    json_t *object = json_object(), *final = json_object();
    bool done = r->kind[0] != RESULTS_PENDING && r->kind[0] != RESULTS_FAILED;

    put(object, "index", results_json_whole(r->index));
    put(object, "outcome", json_string(results_kind_names[r->kind[0]]));
    put(object, "failure",
        r->kind[0] == RESULTS_FAILED && r->failure
            ? json_string(summary_failure_name(r->failure[0]))
            : json_null());
    for (size_t k = 0; k < sizeof times / sizeof times[0]; k++) {
        bool stored = done && results_numbers(r, times[k], &time, 1) == 1;
        put(object, times[k], stored ? results_json_number(time) : json_null());
    }
    size_t n = results_words(r, "state", name, SCENARIO_MAX_STATES);
    if (!done || results_numbers(r, "final_state", state, SCENARIO_MAX_STATES) != n)
        n = 0;
    for (size_t i = 0; i < n; i++)
        put(final, name[i], results_json_number(state[i]));
    put(object, "final_state", final);
    return object;
}

bool summary_print_json(const struct summary *summary, const struct results *r)
{
    json_t *root = json_object();
    put(root, "file", json_string(r->file));
    put(root, "title", json_string(r->title));
    put(root, "version", json_string(r->version));
    put(root, "revision", json_string(r->revision));
    put(root, "date", json_string(r->date));
    put(root, "ranks", json_integer(r->ranks));
    if (summary->ancestry.scenarios > 1)
        put(root, "scenarios", scenarios(&summary->ancestry));
    put(root, "axes", axes(r));
    put(root, "fixed", fixed(summary));
    put(root, "cases", cases(summary, r));
    put(root, "failures", failures(summary));
    bool known = summary_has_outcomes(summary);
    put(root, "outcomes", known ? outcomes(summary) : json_null());
    if (r->single) {
        put(root, "case", single_case(r));
    } else {
        put(root, "extents", known ? extents(summary, r) : json_null());
        put(root, "parameters", known ? parameters(summary, r) : json_null());
        if (summary->pair_counts && known)
            put(root, "pairs", pairs(summary, r));
        put(root, "sample", r->sample >= 0 && known ? sample(summary, r) : json_null());
        put(root, "changes", known ? changes(r) : json_null());
    }
    put(root, "numbers", numbers(summary));
    put(root, "cost", cost(summary));
    bool good = root && json_dumpf(root, stdout, JSON_INDENT(2) | JSON_REAL_PRECISION(17)) == 0;
    json_decref(root);
    putchar('\n');
    return good;
}
