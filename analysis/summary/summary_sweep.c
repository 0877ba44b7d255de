/* summary_sweep.c - what came out of a sweep, along its axes and by what its sample varies. */
#include "summary.h"

#include "analysis/statistics/doe_bins.h"
#include "analysis/statistics/statistics.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { TABLE_ROWS = 20, CHANGES_SHOWN = 10, PAIR_COLUMNS = 6, BINS = 4 };

static const char *unit_of(const char *unit)
{
    return unit[0] ? unit : NULL;
}

/* ---- extents ------------------------------------------------------------------------------ */

static const char *end_note(bool open, bool unknown)
{
    return open ? " (end of the axis)" : unknown ? " (next case pending or failed)" : "";
}

static json_t *extent_facts(const struct results *r, int a, const struct statistics_extent *extent)
{
    const bool known = extent->any || !extent->low_unknown;
    bool others[SCENARIO_MAX_AXES], offsets[SCENARIO_MAX_AXES];
    char at[600];
    for (int b = 0; b < r->axes; b++) {
        others[b] = b != a;
        offsets[b] = b != a && r->axis[b].offset;
    }
    table_at_text(r, offsets, extent->point, at, sizeof at);
    json_t *const facts = TABLE_OBJECT(
        {"path", as_text(r->axis[a].name)}, {"unit", as_text(unit_of(r->axis[a].unit))},
        {"outcome", as_text(results_kind_names[extent->kind])},
        {"stabilised", known ? as_truth(extent->any) : as_nothing(NULL)},
        {"low", as_number(extent->low)}, {"high", as_number(extent->high)},
        {"low_at_end", as_truth(extent->low_open)}, {"high_at_end", as_truth(extent->high_open)},
        {"low_unknown", as_truth(extent->low_unknown)},
        {"high_unknown", as_truth(extent->high_unknown)},
        {"at", as_tree(table_at(r, others, extent->point))}, {".at", as_text(at)},
        {".low", as_text(end_note(extent->low_open, extent->low_unknown))},
        {".high", as_text(end_note(extent->high_open, extent->high_unknown))});
    results_value_text(&r->axis[a], extent->point[a], true, at, sizeof at);
    table_put(facts, ".nearest", as_text(at));
    return facts;
}

static json_t *extents(const struct summary *summary, bool any)
{
    const size_t origin[SCENARIO_MAX_AXES] = {0};
    const struct results *const r = summary->r;
    json_t *const list = json_array();
    struct statistics_extent extent;
    for (int a = 0; any && a < r->axes; a++)
        if (statistics_extent(r, a, origin, &extent))
            json_array_append_new(list, extent_facts(r, a, &extent));
    return list;
}

static const char *end_mark(bool open, bool unknown)
{
    return open ? "*" : unknown ? "?" : "";
}

/* The extents at one value of the only axis that is not an offset: both ends, [] where the set does
 * not hold the point nearest to zero, null where that is not known. For people along two axes at
 * most, as the text explains. */
static bool add_extents(struct table *t, const struct results *r, int axis, size_t i)
{
    json_t *const object = json_object();
    size_t point[SCENARIO_MAX_AXES] = {0};
    struct statistics_extent extent;
    char text[128];
    int shown = 0;
    point[axis] = i;
    for (int a = 0; a < r->axes; a++) {
        const bool found = statistics_extent(r, a, point, &extent);
        if (found) {
            json_t *const ends = extent.any || !extent.low_unknown ? json_array() : json_null();
            if (extent.any) {
                table_append(ends, as_number(extent.low));
                table_append(ends, as_number(extent.high));
            }
            json_object_set_new(object, r->axis[a].name, ends);
        }
        if (!r->axis[a].offset || r->axis[a].count < 2 || ++shown > 2)
            continue;
        if (found && extent.any)
            snprintf(text, sizeof text, "%.4g%s ... %.4g%s", extent.low,
                     end_mark(extent.low_open, extent.low_unknown), extent.high,
                     end_mark(extent.high_open, extent.high_unknown));
        else
            snprintf(text, sizeof text, found && extent.low_unknown ? "?" : "-");
        TABLE_FACTS(t, {{r->axis[a].name, r->axis[a].name, .hidden = TABLE_VIEW_ONLY,
                         .before = "  ", .width = 24, .left = true, .group = "extent"},
                        as_text(text)});
    }
    TABLE_FACTS(t, {{.name = "extents"}, as_tree(object)});
    return shown > 0;
}

/* ---- parameters --------------------------------------------------------------------------- */

static void add_share(struct table *t, const struct summary *summary,
                      const struct statistics_counts *counts, const struct interval *interval)
{
    const bool known = counts->done > 0 && summary->known;
    TABLE_FACTS(
        t,
        {{"share", "share", "%.3f %%", .width = 10, .percent = true},
         as_number(known ? summary_share(summary, counts) : NAN)},
        {{"low", summary->r->sample < 0 ? "" : "95 % interval", "%.3f", .before = "   ",
          .left = true, .empty = "", .percent = true},
         known ? as_number(interval->low) : as_nothing(counts->done == 0 ? "none done" : NULL)},
        {{"high", .format = "%.3f %%", .joined = true, .before = " ... ", .percent = true},
         as_number(known ? interval->high : NAN)});
}

void summary_add_counts(struct table *t, const struct summary *summary,
                        const struct statistics_counts *counts, const struct interval *interval)
{
    TABLE_FACTS(t, {{"done", "done", .width = 10}, as_whole(counts->done)},
                {{.name = "failed"}, as_whole(counts->kind[RESULTS_FAILED])},
                {{.name = "pending"}, as_whole(counts->kind[RESULTS_PENDING])});
    for (int k = 0; k < RESULTS_OUTCOMES; k++)
        TABLE_FACTS(t, {{.name = results_kind_names[k]}, as_whole(counts->kind[k])});
    add_share(t, summary, counts, interval);
}

/* A row for every value of an axis; `only`: no other axis is none of offsets. */
static bool parameter_facts(const struct summary *summary, int a, bool only, json_t *list,
                            struct table *csv)
{
    const struct results_axis *const axis = &summary->r->axis[a];
    struct statistics_counts *const counts = malloc(axis->count * sizeof *counts);
    struct interval *const interval = malloc(axis->count * sizeof *interval);
    struct table t = {0};
    bool good = counts && interval, extent = false, same = axis->count > 1;
    if (good)
        statistics_count_axis(summary->r, a, counts);
    good = good && intervals_find(summary->r, summary->judged, a, NULL, axis->count, interval);
    for (size_t i = 0; good && i < axis->count; i++) {
        struct table *const both[] = {&t, csv};
        for (int k = 0; k < 2; k++) {
            TABLE_FACTS(both[k], {{"parameter", .hidden = TABLE_NO_JSON}, as_text(axis->name)},
                        {{"value", "value", .width = 14}, as_place(axis, i)});
            summary_add_counts(both[k], summary, &counts[i], &interval[i]);
            extent = only && k == 0 ? add_extents(both[k], summary->r, a, i) : extent;
            table_end_row(both[k]);
        }
        same = same && summary_share(summary, &counts[i]) == summary_share(summary, &counts[0]);
    }
    if (good) {
        double change = 0; /* the largest from one value to the next, behind i */
        size_t i = 0;
        for (size_t k = 0; k + 1 < axis->count; k++) {
            const double own =
                fabs(summary_share(summary, &counts[k + 1]) - summary_share(summary, &counts[k]));
            if (own > change)
                change = own, i = k;
        }
        json_t *const facts = TABLE_OBJECT(
            {"path", as_text(axis->name)}, {"unit", as_text(unit_of(axis->unit))},
            {"share_of", as_text(results_kind_names[summary->judged])},
            {".text", as_text(axis->text)}, {".same", as_truth(same && !extent)},
            {".count", as_whole(axis->count)}, {".extents", as_truth(extent)},
            {".share", as_number(summary_share(summary, &counts[i]))},
            {".next", as_number(change > 0 ? summary_share(summary, &counts[i + 1]) : NAN)},
            {".changes", as_truth(change > 0)});
        good = table_give(facts, "values", &t, "value done share low high extent/", TABLE_ROWS);
        if (axis->count > 1)
            table_put(
                facts, "steepest",
                as_tree(TABLE_OBJECT({"from", as_place(axis, i)}, {"to", as_place(axis, i + 1)})));
        json_array_append_new(list, facts);
    }
    table_free(&t);
    free(counts);
    free(interval);
    return good || statistics_no_memory(summary->r, summary->message);
}

/* The shares of two parameters at once; for people with a column for each value of the one with
 * fewer. */
static bool add_pairs(const struct summary *summary, const int *pair)
{
    const struct results *const r = summary->r;
    const struct results_axis *const axis[] = {&r->axis[pair[0]], &r->axis[pair[1]]};
    const int across = axis[0]->count < axis[1]->count ? 0 : 1;
    const size_t count = axis[1]->count;
    struct statistics_counts *const counts = malloc(axis[0]->count * count * sizeof *counts);
    json_t *const shares = json_array();
    struct table t = {0};
    char text[128];
    if (!counts)
        return statistics_no_memory(r, summary->message);
    statistics_count_pair(r, pair[0], pair[1], counts);
    for (size_t i = 0; i < axis[0]->count; i++) {
        json_t *const row = json_array();
        for (size_t j = 0; j < count; j++)
            table_append(row, as_number(summary_share(summary, &counts[i * count + j])));
        json_array_append_new(shares, row);
    }
    json_t *const facts = TABLE_OBJECT(
        {"paths", as_tree(table_texts(axis[0]->name, axis[1]->name))}, {"share", as_tree(shares)},
        {".down", as_text(axis[1 - across]->name)}, {".across", as_text(axis[across]->name)});
    const size_t columns = axis[across]->count, rows = axis[1 - across]->count;
    for (size_t i = 0; i < rows && columns <= PAIR_COLUMNS && columns > 1 && rows > 1; i++) {
        TABLE_FACTS(&t,
                    {{"value", "", .width = 14, .group = "seen"}, as_place(axis[1 - across], i)});
        for (size_t j = 0; j < columns; j++) {
            results_value_text(axis[across], j, false, text, sizeof text);
            TABLE_FACTS(&t, {{"share", text, "%.3f", .width = 11, .percent = true, .group = "seen"},
                             as_number(summary_share(
                                 summary, &counts[across ? i * count + j : j * count + i]))});
        }
        table_end_row(&t);
    }
    free(counts);
    table_put(summary->facts, "pairs", as_tree(facts));
    return table_give(facts, ".table", &t, "seen/", TABLE_ROWS);
}

/* ---- samples ------------------------------------------------------------------------------ */

static void add_parts(struct table *t, const struct summary *summary, int k,
                      const struct doe_bins *bins)
{
    const struct results_varied *const v = &summary->r->vary[k];
    for (size_t b = 0; b < bins->count; b++) {
        const struct doe_bin *const bin = &bins->bin[b];
        double value = bin->low;
        struct results_varied one = *v;
        char text[160]; /* "0.1 ... 0.3", a value or a word */
        one.of.value = &value;
        if (bins->listed)
            results_varied_text(&one, 0, false, text, sizeof text);
        else
            snprintf(text, sizeof text, "%.4g ... %.4g", bin->low, bin->high);
        TABLE_FACTS(t,
                    {{"path", "", .hidden = TABLE_VIEW_ONLY, .width = 32, .left = true},
                     as_text(b ? "" : v->of.name)},
                    {{"values", "values", .hidden = TABLE_VIEW_ONLY, .width = 24}, as_text(text)},
                    {{.name = "from"}, as_varied(v, bin->low)},
                    {{.name = "to"}, as_varied(v, bin->high)},
                    {{"done", "done", .width = 9}, as_whole(bin->counts.done)});
        add_share(t, summary, &bin->counts, &bin->of_kind[summary->judged]);
        table_end_row(t);
    }
}

/* What the sample varies at a point: offsets times the scale. */
static void add_point(const struct results *r, size_t point, double scale, json_t *facts)
{
    static const char offset[] = "initial.offset.";
    json_t *const at = json_object_get(facts, "at");
    for (int k = 0; k < r->varied; k++) {
        const struct results_varied *const v = &r->vary[k];
        const bool scaled = strncmp(v->of.name, offset, strlen(offset)) == 0;
        double value = v->of.value[point] * (scaled ? scale : 1);
        struct results_varied one = *v;
        char is[128];
        one.of.value = &value;
        results_varied_text(&one, 0, true, is, sizeof is);
        say_add(facts, ".at", "%s %s = %s", k ? "," : "", v->of.name, is);
        table_put(at, v->of.name, as_varied(v, value));
    }
}

/* Beside one axis of offsets: where along it the stabilised set through the equilibrium ends, at
 * every point. */
static bool rays_facts(const struct summary *summary, int axis, json_t **facts)
{
    const struct results *const r = summary->r;
    const struct results_axis *const along = &r->axis[axis];
    const size_t points = r->axis[r->sample].count;
    double *const end = malloc(points * sizeof *end), smallest = INFINITY;
    size_t nearest = 0, open = 0, none = 0, unknown = 0;
    struct statistics_numbers n;
    if (!end)
        return statistics_no_memory(r, summary->message);
    for (size_t i = 0; i < points; i++) {
        size_t point[SCENARIO_MAX_AXES] = {0};
        struct statistics_extent extent;
        point[r->sample] = i;
        end[i] = NAN;
        const bool found = statistics_extent(r, axis, point, &extent);
        if (found && !extent.any && !extent.low_unknown) {
            none++;
        } else if (!found || !extent.any || extent.high_unknown) {
            unknown++;
        } else {
            end[i] = extent.high;
            open += extent.high_open;
            nearest = extent.high < smallest ? i : nearest;
            smallest = fmin(smallest, extent.high);
        }
    }
    statistics_summarise(end, points, &n);
    free(end);
    const bool scaled = strcmp(along->name, "initial.offset.scale") == 0;
    *facts = TABLE_OBJECT(
        {"path", as_text(along->name)}, {"points", as_whole(n.n)}, {"smallest", as_number(n.low)},
        {"median", as_number(n.median)}, {"largest", as_number(n.high)},
        {"nearest", n.n > 0 ? as_whole(nearest) : as_nothing(NULL)}, {"at", as_tree(json_object())},
        {"reach_end", as_whole(open)}, {"none", as_whole(none)}, {"unknown", as_whole(unknown)},
        {".unit", as_text(along->unit)});
    if (n.n > 0)
        add_point(r, nearest, scaled ? smallest : 1, *facts);
    return true;
}

static bool add_sample(const struct summary *summary)
{
    const struct results *const r = summary->r;
    struct doe_bins *const bins = malloc(sizeof *bins);
    json_t *const list = json_array(), *rays = NULL;
    struct table all = {0};
    bool good = bins || statistics_no_memory(r, summary->message);
    for (int k = 0; good && k < r->varied; k++) {
        const struct results_varied *const v = &r->vary[k];
        struct table t = {0};
        good = doe_bins_make(bins, r, k, BINS, summary->message);
        if (!good)
            break;
        json_t *const facts =
            TABLE_OBJECT({"path", as_text(v->of.name)}, {"unit", as_text(unit_of(v->of.unit))},
                         {"factor", as_whole((uint64_t)v->factor)});
        add_parts(&t, summary, k, bins);
        add_parts(&all, summary, k, bins);
        good = table_give(facts, "parts", &t, NULL, 0);
        json_array_append_new(list, facts);
    }
    free(bins);
    int axis = -1, others = 0;
    for (int a = 0; a < r->axes; a++) {
        others += a != r->sample;
        axis = a != r->sample && r->axis[a].offset ? a : axis;
    }
    good = good && (axis < 0 || others > 1 || rays_facts(summary, axis, &rays));
    json_t *const facts = TABLE_OBJECT(
        {"method", as_text(r->method)}, {"points", as_whole(r->axis[r->sample].count)},
        {"share_of", as_text(results_kind_names[summary->judged])}, {"varied", as_tree(list)},
        {"rays", as_tree(rays)}, {".dependent", as_truth(r->axes > 1)});
    table_put(summary->facts, "sample", as_tree(facts));
    return table_give(facts, ".parts", &all, "path values done share low high", 0) && good;
}

/* ---- all of it ---------------------------------------------------------------------------- */

/* Where the outcome changes along the only axis. */
static void add_changes(const struct summary *summary)
{
    const struct results *const r = summary->r;
    json_t *const list = json_array(), *const shown = json_array();
    size_t changes = 0;
    for (size_t i = 0; r->axes == 1 && r->sample < 0 && i + 1 < r->cases; i++) {
        if (r->kind[i] == r->kind[i + 1])
            continue;
        json_t *const facts =
            TABLE_OBJECT({"from", as_place(&r->axis[0], i)}, {"to", as_place(&r->axis[0], i + 1)},
                         {"before", as_text(results_kind_names[r->kind[i]])},
                         {"after", as_text(results_kind_names[r->kind[i + 1]])});
        if (changes++ < CHANGES_SHOWN)
            json_array_append(shown, facts);
        json_array_append_new(list, facts);
    }
    table_put(summary->facts, "changes", as_tree(summary->known ? json_incref(list) : NULL));
    table_put(summary->facts, ".changes", as_tree(shown));
    table_put(summary->facts, ".more",
              as_whole(changes > CHANGES_SHOWN ? changes - CHANGES_SHOWN : 0));
    json_decref(list);
}

bool summary_sweep(const struct summary *summary, struct table *csv)
{
    const struct results *const r = summary->r;
    int parameters = 0, pair[2] = {0};
    bool good = true;
    json_t *const list = json_array();
    for (int a = 0; a < r->axes; a++)
        if (!r->axis[a].offset && a != r->sample)
            pair[parameters++ ? 1 : 0] = a;
    table_put(summary->facts, "extents",
              as_tree(summary->known ? extents(summary, parameters == 0 && r->sample < 0) : NULL));
    for (int a = 0; good && a < r->axes; a++)
        if (!r->axis[a].offset && a != r->sample)
            good = parameter_facts(summary, a, parameters == 1 && r->sample < 0, list, csv);
    table_put(summary->facts, "parameters", as_tree(summary->known ? json_incref(list) : NULL));
    json_decref(list);
    if (good && parameters == 2 && summary->known)
        good = add_pairs(summary, pair);
    table_put(summary->facts, "sample", as_nothing(NULL));
    if (good && r->sample >= 0 && summary->known)
        good = add_sample(summary);
    add_changes(summary);
    return good;
}
