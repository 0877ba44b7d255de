/* summary_tables.c - the tables of a summary, for people and for programs. */
#include "summary.h"

#include <math.h>

void summary_outcomes(struct table *t, const struct summary *summary)
{
    const struct statistics_counts *counts = &summary->counts;
    for (int k = 0; k < RESULTS_KIND_COUNT; k++) {
        if (k == RESULTS_PENDING || k == RESULTS_FAILED ||
            (k == RESULTS_DONE && counts->kind[k] == 0))
            continue;
        const struct interval *interval = &summary->of_kind[k];
        TABLE_FACTS(
            t,
            {{"outcome", .hidden = TABLE_NO_JSON, .width = 11, .left = true},
             as_text(results_kind_names[k])},
            {{"count", .before = "", .width = 12}, as_whole(counts->kind[k])},
            {{"share", .format = "%.3f %%", .before = "  ", .width = 9, .percent = true},
             as_number(counts->done ? (double)counts->kind[k] / (double)counts->done : NAN)},
            {{"low", .format = "(%.3f", .before = "   ", .left = true, .empty = "",
              .percent = true},
             as_number(interval->low)},
            {{"high", .format = "%.3f %%)", .joined = true, .before = " ... ", .percent = true},
             as_number(interval->high)});
        table_end_row(t);
    }
}

/* ---- parameters --------------------------------------------------------------------------- */

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
            json_t *ends = extent.any || !extent.low_unknown ? json_array() : json_null();
            if (extent.any) {
                table_append(ends, as_number(extent.low));
                table_append(ends, as_number(extent.high));
            }
            json_object_set_new(object, r->axis[a].name, ends);
        }
    }
    return object;
}

static const char *end_mark(bool open, bool unknown)
{
    return open ? "*" : unknown ? "?" : "";
}

/* For people: along two axes of offsets at most. "-0.09 ... 0.02*", with the marks that
 * summary_print_text explains; "-" for none, "?" for unknown. */
static void add_extents(struct table *t, const struct results *r, int axis, size_t i)
{
    char text[128];
    for (int a = 0, shown = 0; a < r->axes && shown < 2; a++) {
        size_t point[SCENARIO_MAX_AXES] = {0};
        struct statistics_extent extent;
        if (!r->axis[a].offset || r->axis[a].count < 2)
            continue;
        point[axis] = i;
        if (statistics_extent(r, a, point, &extent) && extent.any)
            snprintf(text, sizeof text, "%.4g%s ... %.4g%s", extent.low,
                     end_mark(extent.low_open, extent.low_unknown), extent.high,
                     end_mark(extent.high_open, extent.high_unknown));
        else
            snprintf(text, sizeof text, extent.low_unknown ? "?" : "-");
        TABLE_FACTS(t, {{r->axis[a].name, r->axis[a].name, .hidden = TABLE_VIEW_ONLY,
                         .before = "  ", .width = 24, .left = true, .group = "extent"},
                        as_text(text)});
        shown++;
    }
}

static void add_counts(struct table *t, const struct summary *summary, const struct results *r,
                       const struct statistics_counts *counts, const struct interval *interval)
{
    const bool known = counts->done > 0 && summary_has_outcomes(summary);
    TABLE_FACTS(t, {{"done", "done", .width = 10}, as_whole(counts->done)},
                {{.name = "failed"}, as_whole(counts->kind[RESULTS_FAILED])},
                {{.name = "pending"}, as_whole(counts->kind[RESULTS_PENDING])});
    for (int k = 0; k < RESULTS_OUTCOMES; k++)
        TABLE_FACTS(t, {{.name = results_kind_names[k]}, as_whole(counts->kind[k])});
    TABLE_FACTS(
        t,
        {{"share", "share", "%.3f %%", .width = 10, .percent = true},
         as_number(known ? summary_share(summary, counts) : NAN)},
        {{"low", r->sample < 0 ? "" : "95 % interval", "%.3f", .before = "   ", .left = true,
          .empty = "", .percent = true},
         known ? as_number(interval->low) : as_nothing(counts->done == 0 ? "none done" : NULL)},
        {{"high", .format = "%.3f %%", .joined = true, .before = " ... ", .percent = true},
         as_number(known ? interval->high : NAN)});
}

void summary_values(struct table *t, const struct summary *summary, const struct results *r,
                    int axis, enum table_form form)
{
    const struct results_axis *along = &r->axis[axis];
    const bool only = summary->parameters == 1 && r->sample < 0;
    for (size_t i = 0; i < along->count; i++) {
        TABLE_FACTS(t, {{"parameter", .hidden = TABLE_NO_JSON}, as_text(along->name)},
                    {{"value", "value", .width = 14}, as_place(along, i)});
        add_counts(t, summary, r, &summary->by_value[axis][i], &summary->interval[axis][i]);
        if (only && form == TABLE_AS_JSON)
            TABLE_FACTS(t, {{.name = "extents"}, as_tree(extents_at(r, axis, i))});
        else if (only && form == TABLE_AS_TEXT)
            add_extents(t, r, axis, i);
        table_end_row(t);
    }
}

bool summary_print_csv(const struct summary *summary, const struct results *r)
{
    struct table t = {0};
    TABLE_FACTS(&t, {{.name = "parameter"}, as_nothing(NULL)},
                {{.name = "value"}, as_nothing(NULL)});
    add_counts(&t, summary, r, &summary->counts, &summary->of_kind[summary->judged]);
    table_end_row(&t);
    for (int a = 0; a < r->axes; a++)
        if (summary->by_value[a])
            summary_values(&t, summary, r, a, TABLE_AS_CSV);
    return table_print(&t, TABLE_AS_CSV, NULL, 0);
}

/* ---- samples ------------------------------------------------------------------------------ */

void summary_parts(struct table *t, const struct summary *summary, const struct results *r, int k)
{
    const struct results_varied *v = &r->vary[k];
    for (size_t b = 0; b < summary->bins[k].count; b++) {
        const struct doe_bin *bin = &summary->bins[k].bin[b];
        const struct interval *interval = &bin->of_kind[summary->judged];
        double value = bin->low;
        struct results_varied one = *v;
        char text[160]; /* "0.1 ... 0.3", a value or a word */
        one.of.value = &value;
        if (summary->bins[k].listed)
            results_varied_text(&one, 0, false, text, sizeof text);
        else
            snprintf(text, sizeof text, "%.4g ... %.4g", bin->low, bin->high);
        TABLE_FACTS(
            t,
            {{"path", "", .hidden = TABLE_VIEW_ONLY, .width = 32, .left = true},
             as_text(b ? "" : v->of.name)},
            {{"values", "values", .hidden = TABLE_VIEW_ONLY, .width = 24}, as_text(text)},
            {{.name = "from"}, as_varied(v, bin->low)}, {{.name = "to"}, as_varied(v, bin->high)},
            {{"done", "done", .width = 9}, as_whole(bin->counts.done)},
            {{"share", "share", "%.3f %%", .width = 10, .percent = true},
             as_number(summary_share(summary, &bin->counts))},
            {{"low", "95 % interval", "%.3f", .before = "   ", .left = true, .empty = "none done",
              .percent = true},
             as_number(interval->low)},
            {{"high", .format = "%.3f %%", .joined = true, .before = " ... ", .percent = true},
             as_number(interval->high)});
        table_end_row(t);
    }
}

/* ---- numbers ------------------------------------------------------------------------------ */

void summary_answers(struct table *t, const struct summary *summary, enum table_form form)
{
    const bool text = form == TABLE_AS_TEXT;
    for (int k = 0; k < (text ? SUMMARY_FIRST_RESIDUAL : SUMMARY_NUMBER_COUNT); k++) {
        const struct summary_numbers *row = &summary->numbers[k];
        const struct statistics_numbers *n = &row->numbers;
        char label[64];
        /* Nothing is actuated, there is no target, no contact is left out or none went there. */
        const bool idle =
            k == SUMMARY_through_ground
                ? summary->through == 0
                : (k == SUMMARY_peak_torque || k == SUMMARY_excursion) && n->high == 0;
        if (!row->stored || (text && (n->n == 0 || idle)))
            continue;
        snprintf(label, sizeof label, "  %s%s%s%s", row->name, row->unit[0] ? " (" : "", row->unit,
                 row->unit[0] ? ")" : "");
        TABLE_FACTS(t, {{"answer", .hidden = TABLE_NO_JSON}, as_text(row->name)},
                    {{"label", "Numbers", .hidden = TABLE_VIEW_ONLY, .before = "", .width = 26,
                      .left = true},
                     as_text(label)},
                    {{"of", .joined = true, .before = " "},
                     as_text(row->of == RESULTS_KIND_COUNT ? "done" : results_kind_names[row->of])},
                    {{.name = "unit"}, as_text(row->unit[0] ? row->unit : NULL)},
                    {{"count", "cases", .before = "  ", .left = true}, as_whole(n->n)},
                    {{"smallest", "smallest", "%.4g", .width = 10}, as_number(n->low)},
                    {{"median", "median", "%.4g", .width = 10}, as_number(n->median)},
                    {{"q90", "90 %", "%.4g", .width = 10}, as_number(n->q90)},
                    {{"q99", "99 %", "%.4g", .width = 10}, as_number(n->q99)},
                    {{"largest", "largest", "%.4g", .width = 10}, as_number(n->high)});
        table_end_row(t);
    }
}
