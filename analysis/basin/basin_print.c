/* basin_print.c - the table of `stance basin`, for people and for programs; -h lists the names. */
#include "basin_print.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>

/* ---- the table ---------------------------------------------------------------------------- */

static void add_shape(struct table *t, const struct basin *b, const struct basin_row *row)
{
    const struct basin_uncertainty *uncertainty = &row->uncertainty;
    const struct basin_exponent exponent = basin_exponent(uncertainty);
    const bool fractal = basin_is_fractal(&row->entropy, uncertainty);
    json_t *distances = json_array(), *shares = json_array();
    for (int k = 0; k < uncertainty->scales; k++) {
        table_append(distances, as_whole((uint64_t)1 << k));
        table_append(
            shares, as_number((double)uncertainty->uncertain[k] / (double)uncertainty->counted[k]));
    }
    TABLE_FACTS(
        t, {{"entropy", "S_b", "%.4f", .width = 9}, as_number(basin_entropy(&row->entropy))},
        {{"boundary_entropy", "S_bb", "%.4f", .width = 9},
         as_number(basin_boundary_entropy(&row->entropy))},
        {{"star", "", .width = 1, .hidden = TABLE_VIEW_ONLY, .before = "", .empty = ""},
         as_nothing(fractal ? "*" : NULL)},
        {{"boxes", "boxes", .width = 8, .left = true, .before = " of "},
         as_whole(row->entropy.boxes)},
        {{"mixed_boxes", "mixed", .width = 8}, as_whole(row->entropy.mixed)},
        {{"alpha", "alpha", "%.3f", .width = 8}, as_number(exponent.alpha)},
        {{"alpha_error", "+- 1 sd", "%.3f", .width = 8}, as_number(exponent.error)},
        {{.name = "alpha_distances"}, as_whole((uint64_t)exponent.scales)},
        {{.name = "alpha_missing", .hidden = TABLE_NO_CSV},
         as_text(exponent.refusal == BASIN_FITTED ? NULL : basin_refusal_words[exponent.refusal])},
        {{.name = "fractal", .hidden = TABLE_NO_CSV}, as_truth(fractal)},
        {{"dimension", "dimension", "%.3f", .width = 10},
         as_number(b->start_axes - exponent.alpha)},
        {{.name = "distances", .hidden = TABLE_NO_CSV}, as_tree(distances)},
        {{.name = "uncertain", .hidden = TABLE_NO_CSV}, as_tree(shares)});
}

/* Whether the part that hangs together with the equilibrium is known to end within the box. */
static const char *bounded_word(const struct basin_row *row)
{
    return row->part.faces ? "no" : row->part.unknown ? "unknown" : "yes";
}

static void add_part(struct table *t, const struct basin *b, const struct basin_row *row)
{
    const bool grid = b->around && b->starts == BASIN_GRID, any = grid && row->part.known > 0;
    const char *bounded = any && row->part.inside > 0 ? bounded_word(row) : NULL;
    TABLE_FACTS(
        t,
        {{"connected", "connected", "%.5g", .width = 11}, as_number(any ? row->part.volume : NAN)},
        {{"connected_reach", "+-", "%.2g", .width = 9}, as_number(any ? row->part.reach : NAN)},
        {{"connected_low", "bounds", "%.5g", .width = 25, .left = true, .before = "   "},
         as_number(grid ? row->part.low : NAN)},
        {{.name = "connected_high", .format = "%.5g", .joined = true, .before = " ... "},
         as_number(grid ? row->part.high : NAN)},
        {{"bounded", "bounded", .width = 7, .left = true, .hidden = TABLE_NO_JSON},
         as_text(bounded)},
        {{.name = "is_bounded", .key = "bounded", .hidden = TABLE_NO_CSV},
         bounded && bounded[0] != 'u' ? as_truth(bounded[0] == 'y') : as_nothing(NULL)},
        {{.name = "connected_cut", .hidden = TABLE_NO_CSV},
         as_tree(grid ? faces_json(&b->faces, row->part.faces) : NULL)});
}

static void add_distance(struct table *t, const struct basin *b, const struct basin_row *row)
{
    const struct basin_distance *distance = &row->distance;
    const bool any = row->has_distance && distance->inside;
    const bool grid = b->starts == BASIN_GRID;
    json_t *extent = any && grid ? json_object() : NULL;
    json_t *at = any && isfinite(distance->nearest) ? json_object() : NULL;
    for (size_t d = 0; any && d < basin_starts(b); d++) {
        const char *name = basin_start(b, d)->name;
        if (extent) {
            json_t *ends = json_array();
            table_append(ends, as_number(distance->low[d]));
            table_append(ends, as_number(distance->high[d]));
            json_object_set_new(extent, name, ends);
        }
        if (at)
            table_put(at, name, as_number(distance->at[d]));
    }
    TABLE_FACTS(
        t, {{"nearest", "nearest", "%.4g", .width = 9}, as_number(any ? distance->nearest : NAN)},
        {{.name = "nearest_least"},
         as_number(any ? fmin(distance->nearest, distance->clear) : NAN)},
        {{"median", "median", "%.4g", .width = 9}, as_number(any ? distance->median : NAN)},
        {{.name = "median_least"}, as_number(any ? distance->median_least : NAN)},
        {{"leaving", "leaving", "%.1f %%", .width = 8, .percent = true},
         as_number(any && grid ? (double)distance->leave / (double)distance->directions : NAN)},
        {{.name = "nearest_at", .hidden = TABLE_NO_CSV}, as_tree(at)},
        {{.name = "extent", .hidden = TABLE_NO_CSV}, as_tree(extent)});
}

static void make_table(struct table *t, const struct basin *b)
{
    char level[32], remark[64], cut[512];
    snprintf(level, sizeof level, "+- %.4g %%", 100 * b->choice.level);
    for (size_t k = 0; k < b->rows; k++) {
        const struct basin_row *row = &b->row[k];
        snprintf(remark, sizeof remark, "%" PRIu64 " failed, %" PRIu64 " pending", row->failed,
                 row->pending);
        faces_marks(&b->faces, row->cut, cut, sizeof cut);
        table_axes(t, b->r, b->by, b->by_axes, row->point);
        for (int v = 0; b->choice.rank > 0 && v < b->r->varied; v++) {
            const struct results_varied *varied = &b->r->vary[v];
            const double value = varied->of.value[row->point[b->r->sample]];
            TABLE_FACTS(t, {{varied->of.name, varied->of.name, .width = 12, .group = "at"},
                            as_varied(varied, value)});
        }
        TABLE_FACTS(
            t,
            {{.name = "cases", .before = " of ", .width = 10, .left = true}, as_whole(row->cases)},
            {{"inside", "cases", .width = 10}, as_whole(row->inside)},
            {{.name = "failed"}, as_whole(row->failed)},
            {{.name = "pending"}, as_whole(row->pending)},
            {{.name = "remark", .hidden = TABLE_VIEW_ONLY, .empty = ""},
             as_nothing(row->failed + row->pending > 0 ? remark : NULL)},
            {{"share", "share", "%.3f %%", .width = 9, .percent = true},
             as_number(row->volume / b->box)},
            {{"volume", "volume", "%.5g", .width = 11}, as_number(row->volume)},
            {{"reach", level, "%.2g", .width = 9}, as_number(row->reach)},
            {{"low", b->starts == BASIN_GRID ? "bounds" : "interval", "%.5g", .width = 25,
              .left = true, .before = "   "},
             as_number(row->low)},
            {{.name = "high", .format = "%.5g", .joined = true, .before = " ... "},
             as_number(row->high)},
            {{"cut_at", "cut at", .left = true, .hidden = TABLE_NO_JSON}, as_text(cut)},
            {{.name = "cut", .hidden = TABLE_NO_CSV}, as_tree(faces_json(&b->faces, row->cut))},
            {{.name = "cells", .hidden = TABLE_NO_CSV}, as_whole(row->cells)},
            {{.name = "crossed", .hidden = TABLE_NO_CSV}, as_whole(row->crossed)});
        add_shape(t, b, row);
        add_part(t, b, row);
        add_distance(t, b, row);
        table_end_row(t);
    }
}

/* ---- what its text is made of ------------------------------------------------------------- */

/* What the points of a design make of the interval. */
static const char *interval_reason(enum doe_method method)
{
    switch (method) {
    case DOE_LHS:
        return "of independent points; conservative, as Latin hypercubes scatter less";
    case DOE_SOBOL:
        return "of independent points; conservative, mostly by far: Sobol' points scatter less";
    case DOE_SALTELLI:
        return "of the first and the last point of each block, as if independent; the others "
               "repeat them";
    default:
        return "of independent points";
    }
}

const char *basin_asked(const struct basin *basin)
{
    static char text[400];
    const char *within = basin->choice.within;
    snprintf(text, sizeof text, "%s%s%s", results_kind_names[basin->choice.of],
             within ? " with " : "", within ? within : "");
    return text;
}

void basin_add_axis(json_t *facts, const char *key, const struct results_axis *axis)
{
    char first[64], last[64];
    const char *const order = results_ends_text(axis, first, last, sizeof first);
    say_add(facts, key, "  %-24s %s ... %s, %zu places%s", axis->name, first, last, axis->count,
            order);
}

void basin_add_factors(json_t *facts, const char *key, const struct basin_sample *sample,
                       const char *otherwise)
{
    for (size_t k = 0; k < sample->factors; k++) {
        const struct basin_factor *const factor = &sample->factor[k];
        say_add(facts, key, "  %-24s", factor->of->name);
        if (isnan(factor->from))
            say_add(facts, key, "%s\n", otherwise);
        else
            say_add(facts, key, " %.6g ... %.6g %s\n", factor->from, factor->to, factor->of->unit);
    }
}

/* What rows are averaged over, where they are, wrapped. */
static void add_averaged(const struct basin *b, const char *const *path, size_t count,
                         json_t *facts)
{
    enum { MOST = 64, WIDTH = 96 };
    size_t column = 0;
    for (size_t k = 0; k < count && k < MOST; k++) {
        const bool wraps = k > 0 && column + strlen(path[k]) + 2 > WIDTH;
        const char *const before = k == 0 ? "  averaged over " : wraps ? ",\n    " : ", ";
        column = (wraps || k == 0 ? 0 : column) + strlen(before) + strlen(path[k]);
        say_add(facts, ".averaged", "%s%s", before, path[k]);
    }
    say_add(facts, ".averaged", "%s", count > 0 ? "\n" : "");
    if (b->averaged >= 0)
        say_add(facts, ".averaged",
                "  (%zu sampled points, %s%s: +- has their scatter in it, bounds have not)\n",
                b->sample.points, doe_words[b->sample.method],
                b->sample.method == DOE_MORRIS ? ", on levels of the ranges" : "");
}

/* What the marks in the table of boundaries mean. */
static void add_notes(const struct basin *b, json_t *facts)
{
    bool starred = false;
    size_t refused[BASIN_REFUSALS] = {0};
    for (size_t k = 0; k < b->rows; k++) {
        const struct basin_row *row = &b->row[k];
        starred = starred || basin_is_fractal(&row->entropy, &row->uncertainty);
        refused[basin_exponent(&row->uncertainty).refusal]++;
    }
    table_put(facts, ".starred", as_truth(starred));
    for (int k = BASIN_FITTED + 1; k < BASIN_REFUSALS; k++)
        if (refused[k] > 0)
            say_add(facts, ".refused", "  (no alpha%s: %s)\n", b->rows > 1 ? " in some rows" : "",
                    basin_refusal_text((enum basin_refusal)k));
}

/* What cuts what: of several rows, of any. */
static void add_cut(const struct basin *b, json_t *facts)
{
    char text[2048];
    face_set cut = 0;
    uint64_t failed = 0, pending = 0;
    for (size_t k = 0; k < b->rows; k++) {
        cut |= b->row[k].cut;
        failed += b->row[k].failed;
        pending += b->row[k].pending;
    }
    faces_text(&b->faces, cut, text, sizeof text);
    TABLE_PUT(facts, {".cut", as_text(cut ? text : NULL)},
              {".uncut", as_truth(!cut && b->faces.starts > 0)}, {".failed", as_whole(failed)},
              {".pending", as_whole(pending)}, {".unknown", as_whole(failed + pending)});
}

/* In units of what distances are, and where the nearest end is. */
static void add_nearest(const struct basin *b, const struct basin_distance *distance, json_t *facts)
{
    for (size_t d = 0; d < basin_starts(b); d++) {
        const struct results_axis *axis = basin_start(b, d);
        const char *with = strstr(axis->text, "; with "); /* paths that move along */
        say_add(facts, ".weights", "%s %.6g %s of %s%s", d ? "," : "", b->weight[d], axis->unit,
                axis->name, with ? with + 1 : "");
    }
    if (!distance || !isfinite(distance->nearest))
        return;
    say_add(facts, ".nearest", "%.4g, at", distance->nearest);
    for (size_t d = 0; d < basin_starts(b); d++) {
        const struct results_axis *axis = basin_start(b, d);
        say_add(facts, ".nearest", "%s %s = %.4g %s", d ? "," : "", axis->name, distance->at[d],
                axis->unit);
    }
}

static void add_part_text(const struct basin *b, const struct basin_row *row, json_t *facts)
{
    char text[2048];
    faces_text(&b->faces, row->part.faces, text, sizeof text);
    if (row->part.inside == 0)
        say_add(facts, ".part", "none: the start nearest to the equilibrium is not %s",
                row->part.known > 0 ? results_kind_names[b->choice.of] : "known");
    else if (row->part.faces)
        say_add(facts, ".part", "not known to be bounded: it reaches %s", text);
    else
        say_add(facts, ".part",
                row->part.unknown
                    ? "not known to be bounded: it ends at cases that failed or are pending"
                    : "bounded: it ends within the box, so none of this changes with the box");
}

static void add_directions(const struct basin *b, const struct basin_distance *distance,
                           json_t *facts)
{
    static const char key[] = ".directions";
    struct table ends = {0};
    if (!(distance->nearest <= distance->clear))
        say_add(facts, key, "  at least %.4g, where the box ends or a case is not known\n",
                distance->clear);
    say_add(facts, key, "  median of %zu directions: ", distance->directions);
    if (isfinite(distance->median))
        say_add(facts, key, "%.4g", distance->median);
    if (!(distance->median_least >= distance->median))
        say_add(facts, key, "%sat least %.4g", isfinite(distance->median) ? ", " : "",
                distance->median_least);
    if (distance->leave > 0)
        say_add(facts, key,
                "; %.3g %% of them leave the box, or come to a case that is not known, before",
                100 * (double)distance->leave / (double)distance->directions);
    for (int d = 0; d < b->start_axes; d++) {
        const struct results_axis *axis = &b->r->axis[b->start[d]];
        TABLE_FACTS(
            &ends,
            {{.name = "axis", .before = "  along ", .width = 24, .left = true},
             as_text(axis->name)},
            {{.name = "low", .width = 12}, as_number(distance->low[d])},
            {{.name = "high", .width = 12, .before = " ... "}, as_number(distance->high[d])},
            {{.name = "unit", .left = true}, as_text(axis->unit)});
        table_end_row(&ends);
    }
    table_give(facts, ".ends", &ends, "axis low high unit", 0);
}

/* ---- facts -------------------------------------------------------------------------------- */

static json_t *names(const struct basin *b, const int *axis, int count)
{
    json_t *list = json_array();
    for (int k = 0; k < count; k++)
        table_append(list, as_text(b->r->axis[axis[k]].name));
    return list;
}

json_t *basin_factor_names(const struct basin_sample *sample)
{
    json_t *list = json_array();
    for (size_t k = 0; k < sample->factors; k++)
        table_append(list, as_text(sample->factor[k].of->name));
    return list;
}

static json_t *weights(const struct basin *b)
{
    json_t *object = b->around ? json_object() : NULL;
    for (size_t d = 0; b->around && d < basin_starts(b); d++)
        table_put(object, basin_start(b, d)->name, as_number(b->weight[d]));
    return object;
}

/* Of all rows. */
static json_t *head_facts(const struct basin *b)
{
    const bool grid = b->starts == BASIN_GRID;
    const char *path[256];
    const size_t count = basin_averaged(b, path, sizeof path / sizeof path[0]);
    json_t *const facts = TABLE_OBJECT(
        {"outcome", as_text(results_kind_names[b->choice.of])},
        {"within", as_text(b->choice.within)}, {"level", as_number(b->choice.level)},
        {"box_side", as_whole(b->choice.side)},
        {"design", as_text(grid ? "grid" : doe_words[b->sample.method])},
        {"starts",
         as_tree(grid ? names(b, b->start, b->start_axes) : basin_factor_names(&b->sample))},
        {"parameters", as_tree(names(b, b->by, b->by_axes))},
        {"averaged", as_tree(table_list(path, count))}, {"box", as_number(b->box)},
        {"unit", as_text(b->unit)}, {"weights", as_tree(weights(b))},
        {".asked", as_text(basin_asked(b))}, {".sampled", as_truth(!grid)},
        {".boxed", as_truth(isfinite(grid ? b->box : b->sample.box))},
        {".points", as_whole(b->sample.points)}, {".others", as_truth(!grid && b->sample.others)},
        {".reason", as_text(interval_reason(b->sample.method))}, {".rows_all", as_whole(b->rows)},
        {".of_all",
         b->choice.rank > 0 ? as_whole(b->r->axis[b->r->sample].count) : as_nothing(NULL)});
    for (int d = 0; grid && d < b->start_axes; d++) {
        basin_add_axis(facts, ".over", &b->r->axis[b->start[d]]);
        say_add(facts, ".over", "\n");
    }
    if (!grid)
        basin_add_factors(facts, ".over", &b->sample,
                          " not evenly over a range: no volume, shares alone");
    add_averaged(b, path, count, facts);
    return basin_titled(b->r, facts);
}

static const char text[] =
    "{.name}\n{.file}: {.cases} cases[.unknown:, {.failed} failed, {.pending} pending]\n\n"
    "Starts that end as {.asked}, [.sampled:of {.points} points ({design})|on a grid] over\n{.over}"
    "[.boxed:  a box of {box%.6g}[unit: {unit}]\n]"
    "[.others:  averaged over what else is sampled\n]{.averaged}"
    "[.sampled:  interval: {.reason}\n]"
    "\nVolume\n{.rows}"
    "[.cut:  cut by the box at {.cut}[.sampled:, i.e. within 5 % of it]:\n  "
    "[.rows_all>1:in such rows ]the share is the box's, and the set goes on beyond it\n]"
    "[.uncut:  [.unknown:not known to be cut|not cut] by the box: no start on its faces is "
    "{outcome}\n]"
    "[.of_all:  (the {.rows_all} largest of {.of_all} sampled points)\n]"
    "[.sampled:[.nearest:\nNearest start to the equilibrium that is not {outcome}: {.nearest}\n"
    "  (distances in units of{.weights})\n"
    "  (an upper bound of the distance, of these points; rays and --descend find the nearest)\n]]"
    "[.boundary:\nBoundary\n{.boundary}"
    "[.starred:  (* above log 2 by more than its interval, alpha below 1 by more than its own: "
    "fractal)\n]{.refused}"
    "[.domain:\nDomain of the equilibrium: what hangs together with it, and how far its boundary "
    "is\n  (distances in units of{.weights})\n{.domain}"
    "[.part:  {.part}\n]"
    "[.directions:[.nearest:  nearest: {.nearest}\n]{.directions}\n\n"
    "From the equilibrium to the end of the outcome\n{.ends}"
    "  (- where the outcome reaches the end of the axis, or a case that is not known)\n]]]";

bool basin_print(const struct basin *b, enum table_form form)
{
    const bool one = b->rows == 1, grid = b->starts == BASIN_GRID,
               bounded = grid && b->choice.rank == 0;
    const struct basin_row *const row = &b->row[0];
    struct table t = {0};
    make_table(&t, b);
    json_t *facts = table_show(head_facts(b), "rows", &t,
                               one ? "share volume reach low high inside cases remark"
                                   : "at/ share volume reach low high inside cases cut_at remark",
                               BASIN_SHOWN);
    add_cut(b, facts);
    add_nearest(
        b, one && (!grid || (row->has_distance && row->distance.inside)) ? &row->distance : NULL,
        facts);
    if (bounded) {
        add_notes(b, facts);
        facts = table_show(facts, ".boundary", &t,
                           "at/ entropy boundary_entropy star mixed_boxes boxes alpha "
                           "alpha_error dimension",
                           BASIN_SHOWN);
    }
    if (bounded && b->around)
        facts = table_show(facts, ".domain", &t,
                           "at/ connected connected_reach connected_low connected_high bounded "
                           "nearest median leaving",
                           BASIN_SHOWN);
    if (bounded && b->around && one)
        add_part_text(b, row, facts);
    if (bounded && b->around && one && row->has_distance && row->distance.inside)
        add_directions(b, &row->distance, facts);
    return table_say(form, facts, text, &t);
}

/* ---- the boundary ------------------------------------------------------------------------- */

static bool put_crossing(void *context, const struct basin_slice *slice,
                         const struct basin_crossing *crossing)
{
    struct table *t = context;
    const struct basin *b = slice->basin;
    for (int a = 0, d = 0; a < b->r->axes; a++) {
        if (d == b->start_axes || b->start[d] != a) {
            TABLE_VALUES(t, as_place(&b->r->axis[a], slice->point[a]));
            continue;
        }
        TABLE_VALUES(t, as_number(d == crossing->axis ? crossing->middle
                                                      : slice->map.place[d][crossing->point[d]]));
        d++;
    }
    TABLE_VALUES(t, as_text(b->r->axis[b->start[crossing->axis]].name),
                 as_number(crossing->half_width), as_text(results_kind_names[crossing->from]),
                 as_text(results_kind_names[crossing->to]));
    const bool good = table_write_csv(t, stdout);
    table_clear(t);
    return good;
}

bool basin_print_boundary(const struct basin *b)
{
    struct table t = {0};
    for (int a = 0; a < b->r->axes; a++)
        TABLE_COLUMNS(&t, {.name = b->r->axis[a].name});
    TABLE_COLUMNS(&t, {.name = "along"}, {.name = "half_width"}, {.name = "from"}, {.name = "to"});
    bool good = table_write_csv(&t, stdout); /* the head */
    table_clear(&t);
    good = good && basin_boundary(b, put_crossing, &t);
    table_free(&t);
    return good;
}
