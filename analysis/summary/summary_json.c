/* summary_json.c - the summary for programs; the keys are listed in `stance summary -h`. */
#include "summary.h"

#include <math.h>

static struct table_value word(const char *text)
{
    return as_text(text && text[0] ? text : NULL);
}

static json_t *axes(const struct results *r)
{
    json_t *list = json_array();
    for (int a = 0; !r->single && a < r->axes; a++) {
        const struct results_axis *axis = &r->axis[a];
        json_array_append_new(
            list,
            TABLE_OBJECT({"path", as_text(axis->name)}, {"unit", word(axis->unit)},
                         {"long_name", word(axis->text)}, {"count", as_whole(axis->count)},
                         {"first", as_place(axis, 0)}, {"last", as_place(axis, axis->count - 1)}));
    }
    return list;
}

static json_t *fixed(const struct summary *summary)
{
    json_t *object = json_object();
    for (size_t i = 0; i < summary->fields; i++) {
        const struct summary_field *field = &summary->field[i];
        table_put(object, field->path,
                  isnan(field->number) ? as_text(field->text) : as_number(field->number));
    }
    return object;
}

static json_t *extents(const struct summary *summary, const struct results *r)
{
    json_t *list = json_array();
    for (int a = 0; a < r->axes; a++) {
        const struct statistics_extent *extent = &summary->extent[a];
        const bool known = extent->any || !extent->low_unknown;
        if (!summary->has_extent[a])
            continue;
        bool others[SCENARIO_MAX_AXES];
        for (int b = 0; b < r->axes; b++)
            others[b] = b != a;
        json_array_append_new(
            list, TABLE_OBJECT({"path", as_text(r->axis[a].name)}, {"unit", word(r->axis[a].unit)},
                               {"outcome", as_text(results_kind_names[extent->kind])},
                               {"stabilised", known ? as_truth(extent->any) : as_nothing(NULL)},
                               {"low", as_number(extent->low)}, {"high", as_number(extent->high)},
                               {"low_at_end", as_truth(extent->low_open)},
                               {"high_at_end", as_truth(extent->high_open)},
                               {"low_unknown", as_truth(extent->low_unknown)},
                               {"high_unknown", as_truth(extent->high_unknown)},
                               {"at", as_tree(table_at(r, others, extent->point))}));
    }
    return list;
}

static json_t *parameters(const struct summary *summary, const struct results *r)
{
    json_t *list = json_array();
    for (int a = 0; a < r->axes; a++) {
        const struct results_axis *axis = &r->axis[a];
        struct table t = {0};
        if (!summary->by_value[a])
            continue;
        summary_values(&t, summary, r, a, TABLE_AS_JSON);
        json_t *object = TABLE_OBJECT({"path", as_text(axis->name)}, {"unit", word(axis->unit)},
                                      {"share_of", as_text(results_kind_names[summary->judged])},
                                      {"values", as_tree(table_tree(&t, false))});
        if (axis->count > 1) {
            json_object_set_new(object, "steepest",
                                TABLE_OBJECT({"from", as_place(axis, summary->steepest[a])},
                                             {"to", as_place(axis, summary->steepest[a] + 1)}));
        }
        json_array_append_new(list, object);
    }
    return list;
}

static json_t *pairs(const struct summary *summary, const struct results *r)
{
    const struct results_axis *first = &r->axis[summary->pair[0]],
                              *second = &r->axis[summary->pair[1]];
    json_t *shares = json_array();
    for (size_t i = 0; i < first->count; i++) {
        json_t *row = json_array();
        for (size_t j = 0; j < second->count; j++) {
            const struct statistics_counts *counts = &summary->pair_counts[i * second->count + j];
            table_append(row, as_number(summary_share(summary, counts)));
        }
        json_array_append_new(shares, row);
    }
    return TABLE_OBJECT({"paths", as_tree(table_texts(first->name, second->name))},
                        {"share", as_tree(shares)});
}

static json_t *rays(const struct summary *summary, const struct results *r)
{
    const struct summary_rays *rays = summary->rays;
    const struct statistics_numbers *n = &rays->numbers;
    json_t *at = json_object();
    for (int k = 0; n->n > 0 && k < r->varied; k++)
        table_put(at, r->vary[k].of.name, as_varied(&r->vary[k], summary_nearest(rays, r, k)));
    return TABLE_OBJECT({"path", as_text(r->axis[summary->ray_axis].name)},
                        {"points", as_whole(n->n)}, {"smallest", as_number(n->low)},
                        {"median", as_number(n->median)}, {"largest", as_number(n->high)},
                        {"nearest", n->n > 0 ? as_whole(rays->nearest) : as_nothing(NULL)},
                        {"at", as_tree(at)}, {"reach_end", as_whole(rays->open)},
                        {"none", as_whole(rays->none)}, {"unknown", as_whole(rays->unknown)});
}

static json_t *sample(const struct summary *summary, const struct results *r)
{
    json_t *list = json_array();
    for (int k = 0; k < r->varied; k++) {
        const struct results_varied *v = &r->vary[k];
        struct table t = {0};
        summary_parts(&t, summary, r, k);
        json_array_append_new(list, TABLE_OBJECT({"path", as_text(v->of.name)},
                                                 {"unit", word(v->of.unit)},
                                                 {"factor", as_whole((uint64_t)v->factor)},
                                                 {"parts", as_tree(table_tree(&t, false))}));
    }
    return TABLE_OBJECT(
        {"method", as_text(r->method)}, {"points", as_whole(r->axis[r->sample].count)},
        {"share_of", as_text(results_kind_names[summary->judged])}, {"varied", as_tree(list)},
        {"rays", as_tree(summary->rays ? rays(summary, r) : NULL)});
}

static json_t *changes(const struct results *r)
{
    json_t *list = json_array();
    for (size_t i = 0; r->axes == 1 && r->sample < 0 && i + 1 < r->cases; i++) {
        if (r->kind[i] != r->kind[i + 1]) {
            json_array_append_new(
                list, TABLE_OBJECT({"from", as_place(&r->axis[0], i)},
                                   {"to", as_place(&r->axis[0], i + 1)},
                                   {"before", as_text(results_kind_names[r->kind[i]])},
                                   {"after", as_text(results_kind_names[r->kind[i + 1]])}));
        }
    }
    return list;
}

static json_t *cost(const struct summary *summary)
{
    const struct summary_count *steps = &summary->count[SUMMARY_steps],
                               *iterations = &summary->count[SUMMARY_iterations];
    json_t *object = json_object();
    for (int k = 0; k < SUMMARY_COUNT_COUNT; k++) {
        const struct summary_count *count = &summary->count[k];
        if (count->stored)
            json_object_set_new(object, count->name, json_integer((json_int_t)count->sum));
        if (count->stored && count->cases_name)
            json_object_set_new(object, count->cases_name, json_integer((json_int_t)count->cases));
    }
    if (steps->stored && iterations->stored)
        table_put(object, "iterations_per_step", as_number(iterations->sum / steps->sum));
    const bool timed = summary->timed;
    json_object_update_new(
        object, TABLE_OBJECT({"wall_time", as_number(timed ? summary->longest : NAN)},
                             {"total_time", as_number(timed ? summary->total : NAN)},
                             {"cases_per_second",
                              as_number(timed ? summary->timed_cases / summary->longest : NAN)}));
    return object;
}

static json_t *single_case(const struct results *r)
{
    static const char *const times[] = {"end_time", "settle_time", "fall_time"};
    char name[SCENARIO_MAX_STATES][SCENARIO_NAME];
    double state[SCENARIO_MAX_STATES], time;
    const bool failed = r->kind[0] == RESULTS_FAILED;
    json_t *final = json_object();
    json_t *object = TABLE_OBJECT(
        {"index", as_whole(r->index)}, {"outcome", as_text(results_kind_names[r->kind[0]])},
        {"failure", as_text(failed && r->failure ? summary_failure_name(r->failure[0]) : NULL)});
    for (size_t k = 0; k < sizeof times / sizeof times[0]; k++) {
        const bool stored =
            !failed && r->kind[0] != RESULTS_PENDING && results_numbers(r, times[k], &time, 1) == 1;
        table_put(object, times[k], as_number(stored ? time : NAN));
    }
    const size_t n = summary_final_state(r, name, state);
    for (size_t i = 0; i < n; i++)
        table_put(final, name[i], as_number(state[i]));
    json_object_set_new(object, "final_state", final);
    return object;
}

bool summary_print_json(const struct summary *summary, const struct results *r)
{
    const bool known = summary_has_outcomes(summary);
    const struct statistics_counts *counts = &summary->counts;
    struct table outcomes = {0}, numbers = {0};
    if (known)
        summary_outcomes(&outcomes, summary);
    summary_answers(&numbers, summary, TABLE_AS_JSON);
    json_t *const cases = TABLE_OBJECT(
        {"total", as_whole(r->cases)}, {"done", as_whole(counts->done)},
        {"failed", as_whole(counts->kind[RESULTS_FAILED])},
        {"pending", as_whole(counts->kind[RESULTS_PENDING])},
        {"inferred", as_whole(summary->inferred)}, {"damaged", as_whole(r->damage.cases)});
    json_t *root =
        TABLE_OBJECT({"file", as_text(r->file)}, {"title", as_text(r->title)},
                     {"version", as_text(r->version)}, {"revision", as_text(r->revision)},
                     {"date", as_text(r->date)}, {"ranks", as_whole((uint64_t)r->ranks)});
    const struct ancestry *const ancestry = &summary->ancestry;
    json_t *scenarios = json_array(), *failures = json_object(), *causes = json_object();
    for (size_t k = 0; k < ancestry->scenarios; k++)
        json_array_append_new(scenarios, TABLE_OBJECT({"date", as_text(ancestry->date[k])},
                                                      {"done", as_whole(ancestry->done[k])}));
    for (int f = 0; f < SUMMARY_FAILURES; f++)
        if (summary->failures[f] > 0)
            table_put(failures, summary_failure_name(f), as_whole(summary->failures[f]));
    for (int k = 1; k < STANCE_MAX_WORDS; k++)
        if (summary->fallen_by[k] > 0)
            table_put(causes, summary->cause[k], as_whole(summary->fallen_by[k]));
    if (ancestry->scenarios > 1)
        json_object_set(root, "scenarios", scenarios);
    json_decref(scenarios);
    json_object_update_new(
        root, TABLE_OBJECT({"axes", as_tree(axes(r))}, {"fixed", as_tree(fixed(summary))},
                           {"cases", as_tree(cases)}, {"failures", as_tree(failures)},
                           {"outcomes", as_tree(known ? table_tree(&outcomes, true) : NULL)},
                           {"cut", as_tree(faces_json(&summary->faces, summary->cut))},
                           {"fall_causes", as_tree(causes)}));
    if (r->single) {
        json_object_set_new(root, "case", single_case(r));
    } else {
        json_object_update_new(
            root, TABLE_OBJECT({"extents", as_tree(known ? extents(summary, r) : NULL)},
                               {"parameters", as_tree(known ? parameters(summary, r) : NULL)}));
        if (summary->pair_counts && known)
            json_object_set_new(root, "pairs", pairs(summary, r));
        json_object_update_new(
            root,
            TABLE_OBJECT({"sample", as_tree(r->sample >= 0 && known ? sample(summary, r) : NULL)},
                         {"changes", as_tree(known ? changes(r) : NULL)}));
    }
    json_t *const through = TABLE_OBJECT({"cases", as_whole(summary->through)},
                                         {"judged", as_whole(summary->through_judged)});
    json_object_update_new(root, TABLE_OBJECT({"numbers", as_tree(table_tree(&numbers, true))},
                                              {"through_ground", as_tree(through)},
                                              {"cost", as_tree(cost(summary))}));
    return table_write_json(root, stdout);
}
