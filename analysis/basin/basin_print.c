/* basin_print.c - the table of `stance basin`, for people and for programs; -h lists the names. */
#include "basin_print.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>

/* ---- the table ---------------------------------------------------------------------------- */

/* What is said of a row; names that are no members are of add_row. */
#define ROW(X)                                                                                     \
    X("cases", "", as_whole(row->cases), .before = " of ", .width = 10, .left = true)              \
    X("inside", "", as_whole(row->inside), "cases", .width = 10)                                   \
    X("failed", "", as_whole(row->failed))                                                         \
    X("pending", "", as_whole(row->pending))                                                       \
    X("remark", NULL, as_nothing(row->failed + row->pending > 0 ? remark : NULL),                  \
      .hidden = TABLE_VIEW_ONLY, .empty = "")                                                      \
    X("share", "", as_number(row->volume / b->box), "share", "%.3f %%", 9, .percent = true)        \
    X("volume", "", as_number(row->volume), "volume", "%.5g", 11)                                  \
    X("reach", "the likely error at the level", as_number(row->reach), level, "%.2g", 9)           \
    X("low", "", as_number(row->low), grid ? "bounds" : "interval", "%.5g", 25, .left = true,      \
      .before = "   ")                                                                             \
    X("high", "", as_number(row->high), .format = "%.5g", .joined = true, .before = " ... ")       \
    X("cut_at", NULL, as_text(cut), "cut at", .left = true, .hidden = TABLE_NO_JSON)               \
    X("cut", "[{path, end: lower or upper, at}]", as_tree(faces_json(&b->faces, row->cut)))        \
    X("cells", "", as_whole(row->cells), .hidden = TABLE_NO_CSV)                                   \
    X("crossed", "", as_whole(row->crossed), .hidden = TABLE_NO_CSV)                               \
    X("entropy", "", as_number(basin_entropy(&row->entropy)), "S_b", "%.4f", 9)                    \
    X("boundary_entropy", "", as_number(basin_boundary_entropy(&row->entropy)), "S_bb", "%.4f", 9) \
    X("star", NULL, as_nothing(fractal ? "*" : NULL), "", .width = 1, .hidden = TABLE_VIEW_ONLY,   \
      .before = "", .empty = "")                                                                   \
    X("boxes", "", as_whole(row->entropy.boxes), "boxes", .width = 8, .left = true,                \
      .before = " of ")                                                                            \
    X("mixed_boxes", "", as_whole(row->entropy.mixed), "mixed", .width = 8)                        \
    X("alpha", "", as_number(exponent.alpha), "alpha", "%.3f", 8)                                  \
    X("alpha_error", "", as_number(exponent.error), "+- 1 sd", "%.3f", 8)                          \
    X("alpha_distances", "number of those fitted", as_whole((uint64_t)exponent.scales))            \
    X("alpha_missing", "why there is none: small, none, wide, bent, few",                          \
      as_text(exponent.refusal ? basin_refusal_words[exponent.refusal] : NULL),                    \
      .hidden = TABLE_NO_CSV)                                                                      \
    X("fractal", "", as_truth(fractal))                                                            \
    X("dimension", "", as_number(b->start_axes - exponent.alpha), "dimension", "%.3f", 10)         \
    X("distances", "[cells]", as_tree(distances))                                                  \
    X("uncertain", "[share]", as_tree(shares))                                                     \
    X("connected", "", as_number(known ? row->part.volume : NAN), "connected", "%.5g", 11)         \
    X("connected_reach", "", as_number(known ? row->part.reach : NAN), "+-", "%.2g", 9)            \
    X("connected_low", "", as_number(about ? row->part.low : NAN), "bounds", "%.5g", 25,           \
      .left = true, .before = "   ")                                                               \
    X("connected_high", "", as_number(about ? row->part.high : NAN), .format = "%.5g",             \
      .joined = true, .before = " ... ")                                                           \
    X("bounded", "", as_text(bounded), "bounded", .width = 7, .left = true,                        \
      .hidden = TABLE_NO_JSON)                                                                     \
    X("is_bounded", NULL,                                                                          \
      as_tree(bounded &&bounded[0] != 'u' ? json_boolean(bounded[0] == 'y') : NULL),               \
      .key = "bounded")                                                                            \
    X("connected_cut", "[as cut]", as_tree(about ? faces_json(&b->faces, row->part.faces) : NULL)) \
    X("nearest", "", as_number(any ? distance->nearest : NAN), "nearest", "%.4g", 9)               \
    X("nearest_least", "", as_number(any ? fmin(distance->nearest, distance->clear) : NAN))        \
    X("median", "", as_number(any ? distance->median : NAN), "median", "%.4g", 9)                  \
    X("median_least", "", as_number(any ? distance->median_least : NAN))                           \
    X("leaving", "share",                                                                          \
      as_number(any &&grid ? (double)distance->leave / (double)distance->directions : NAN),        \
      "leaving", "%.1f %%", 8, .percent = true)                                                    \
    X("nearest_at", "{path: value}", as_tree(at))                                                  \
    X("extent", "{path: [low, high]}", as_tree(extent))

static void add_row(struct table *t, const struct basin *b, const struct basin_row *row)
{
    const bool grid = !b->sampled, about = grid && b->around, known = about && row->part.known > 0;
    const struct basin_uncertainty *const uncertainty = &row->uncertainty;
    const struct basin_exponent exponent = basin_exponent(uncertainty);
    const bool fractal = basin_is_fractal(&row->entropy, uncertainty);
    const struct basin_distance *const distance = &row->distance;
    const bool any = row->has_distance && distance->inside;
    /* Whether the part that hangs together with the equilibrium is known to end within the box. */
    const char *const bounded = !known || row->part.inside == 0 ? NULL
                                : row->part.faces               ? "no"
                                : row->part.unknown             ? "unknown"
                                                                : "yes";
    json_t *const distances = json_array(), *const shares = json_array();
    json_t *const extent = any && grid ? json_object() : NULL;
    json_t *const at = any && isfinite(distance->nearest) ? json_object() : NULL;
    char level[32], remark[64], cut[512];
    snprintf(level, sizeof level, "+- %.4g %%", 100 * b->choice.level);
    snprintf(remark, sizeof remark, "%" PRIu64 " failed, %" PRIu64 " pending", row->failed,
             row->pending);
    faces_marks(&b->faces, row->cut, cut, sizeof cut);
    for (int k = 0; k < uncertainty->scales; k++) {
        table_append(distances, as_whole((uint64_t)1 << k));
        table_append(
            shares, as_number((double)uncertainty->uncertain[k] / (double)uncertainty->counted[k]));
    }
    for (size_t d = 0; any && d < basin_starts(b); d++) {
        const char *const name = basin_start(b, d)->name;
        if (extent)
            table_put(extent, name, as_tree(table_pair(distance->low[d], distance->high[d])));
        if (at)
            table_put(at, name, as_number(distance->at[d]));
    }
    table_axes(t, b->r, b->by, b->by_axes, row->point);
    for (int v = 0; b->choice.rank > 0 && v < b->r->varied; v++) {
        const struct results_varied *const varied = &b->r->vary[v];
        TABLE_FACTS(t, {{varied->of.name, varied->of.name, .width = 12, .group = "at"},
                        as_varied(varied, varied->of.value[row->point[b->r->sample]])});
    }
    TABLE_FACTS(t, ROW(TABLE_FACT));
    table_end_row(t);
}

/* ---- what its text is made of ------------------------------------------------------------- */

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

/* What cuts what and what the marks mean: of several rows, of any. */
static void add_notes(const struct basin *b, json_t *facts)
{
    char cut_text[2048], part_text[2048];
    face_set cut = 0;
    uint64_t failed = 0, pending = 0;
    bool starred = false;
    size_t refused[BASIN_REFUSALS] = {0};
    for (size_t k = 0; k < b->rows; k++) {
        const struct basin_row *const row = &b->row[k];
        cut |= row->cut;
        failed += row->failed;
        pending += row->pending;
        starred = starred || basin_is_fractal(&row->entropy, &row->uncertainty);
        refused[basin_exponent(&row->uncertainty).refusal]++;
    }
    for (int k = BASIN_FITTED + 1; k < BASIN_REFUSALS; k++)
        if (refused[k] > 0)
            say_add(facts, ".refused", "  (no alpha%s: %s)\n", b->rows > 1 ? " in some rows" : "",
                    basin_refusal_text((enum basin_refusal)k));
    faces_text(&b->faces, cut, cut_text, sizeof cut_text);
    faces_text(&b->faces, b->row->part.faces, part_text, sizeof part_text);
    TABLE_PUT(facts, {".cut", as_text(cut ? cut_text : NULL)},
              {".uncut", as_truth(!cut && b->faces.starts > 0)}, {".failed", as_whole(failed)},
              {".pending", as_whole(pending)}, {".unknown", as_whole(failed + pending)},
              {".starred", as_truth(starred)}, {".reaches", as_text(part_text)});
}

/* The starts, with what the only row, if there is one, says along each. */
static json_t *starts_facts(const struct basin *b)
{
    const struct basin_distance *const distance = &b->row->distance;
    json_t *const list = json_array();
    for (size_t d = 0; d < basin_starts(b); d++) {
        const struct results_axis *const axis = basin_start(b, d);
        const char *const with = strstr(axis->text, "; with "); /* paths that move along */
        TABLE_APPEND(list, {"name", as_text(axis->name)}, {"unit", as_text(axis->unit)},
                     {"weight", as_number(b->weight[d])}, {"with", as_text(with ? with + 1 : "")},
                     {"at", as_number(distance->at[d])}, {"low", as_number(distance->low[d])},
                     {"high", as_number(distance->high[d])});
    }
    return list;
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

/* Of all rows; names that are no members are of head_facts. */
#define HEAD(X)                                                                                    \
    X("outcome", "", as_text(results_kind_names[b->choice.of]))                                    \
    X("within", "", as_text(b->choice.within))                                                     \
    X("level", "", as_number(b->choice.level))                                                     \
    X("box_side", "", as_whole(b->choice.side))                                                    \
    X("design", "grid, or the sample's method",                                                    \
      as_text(grid ? "grid" : doe_words[b->sample.method]))                                        \
    X("starts", "[paths]",                                                                         \
      as_tree(grid ? names(b, b->start, b->start_axes) : basin_factor_names(&b->sample)))          \
    X("parameters", "[paths]", as_tree(names(b, b->by, b->by_axes)))                               \
    X("averaged", "[paths]", as_tree(table_list(path, count)))                                     \
    X("box", "", as_number(b->box))                                                                \
    X("unit", "", as_text(b->unit))                                                                \
    X("weights", "{path: size}", as_tree(weights))

static json_t *head_facts(const struct basin *b)
{
    const bool grid = !b->sampled;
    const char *path[256];
    const size_t count = basin_averaged(b, path, sizeof path / sizeof path[0]);
    json_t *const weights = b->around ? json_object() : NULL;
    for (size_t d = 0; b->around && d < basin_starts(b); d++)
        table_put(weights, basin_start(b, d)->name, as_number(b->weight[d]));
    json_t *const facts = TABLE_OBJECT(
        HEAD(TABLE_MEMBER){".asked", as_text(basin_asked(b))}, {".sampled", as_truth(!grid)},
        {".boxed", as_truth(isfinite(grid ? b->box : b->sample.box))},
        {".points", as_whole(b->sample.points)}, {".others", as_truth(!grid && b->sample.others)},
        {".drawn", as_text(b->averaged >= 0 ? doe_words[b->sample.method] : NULL)},
        {".rows_all", as_whole(b->rows)}, {".one", as_truth(b->rows == 1)},
        {".of_all",
         b->choice.rank > 0 ? as_whole(b->r->axis[b->r->sample].count) : as_nothing(NULL)});
    for (int d = 0; grid && d < b->start_axes; d++) {
        basin_add_axis(facts, ".over", &b->r->axis[b->start[d]]);
        say_add(facts, ".over", "\n");
    }
    if (!grid)
        basin_add_factors(facts, ".over", &b->sample,
                          " not evenly over a range: no volume, shares alone");
    return basin_titled(b->r, facts);
}

static const struct say_key row_keys[] = {TABLE_KEY_AT ROW(TABLE_KEY){0}};
const struct say_key basin_keys[] = {HEAD(TABLE_KEY){"rows", "null where there is none", row_keys},
                                     {0}};

#define WEIGHTS "  (distances in units of [.starts*, :{weight%.6g} {unit} of {name}{with}])\n"
#define NEAREST "{rows/0/nearest%.4g}, at [.starts*, :{name} = {at%.4g} {unit}]\n"
static const char text[] =
    "{.name}\n{.file}: {.cases} cases[.unknown:, {.failed} failed, {.pending} pending]\n\n"
    "Starts that end as {.asked}, [.sampled:of {.points} points ({design})|on a grid] over\n{.over}"
    "[.boxed:  a box of {box%.6g}[unit: {unit}]\n]"
    "[.others:  averaged over what else is sampled\n]"
    "[averaged:  averaged over [averaged*, :{value}]\n]"
    "[.drawn:  ({.points} sampled points, {.drawn}[.drawn=morris:, on levels of the ranges]: +- "
    "has their scatter in it, bounds have not)\n]"
    "[.sampled:  interval: of [design=saltelli:the first and the last point of each block, as if "
    "independent; the others repeat them|independent points]"
    "[design=lhs:; conservative, as Latin hypercubes scatter less]"
    "[design=sobol:; conservative, mostly by far: Sobol' points scatter less]\n]"
    "\nVolume\n{.rows}"
    "[.cut:  cut by the box at {.cut}[.sampled:, i.e. within 5 % of it]:\n  "
    "[.rows_all>1:in such rows ]the share is the box's, and the set goes on beyond it\n]"
    "[.uncut:  [.unknown:not known to be cut|not cut] by the box: no start on its faces is "
    "{outcome}\n]"
    "[.of_all:  (the {.rows_all} largest of {.of_all} sampled points)\n]"
    "[.sampled:[.near:\nNearest start to the equilibrium that is not {outcome}: " NEAREST WEIGHTS
    "  (an upper bound of the distance, of these points; rays and --descend find the nearest)\n]]"
    "[.boundary:\nBoundary\n{.boundary}"
    "[.starred:  (* above log 2 by more than its interval, alpha below 1 by more than its own: "
    "fractal)\n]{.refused}"
    "[.domain:\nDomain of the equilibrium: what hangs together with it, and how far its boundary "
    "is\n" WEIGHTS "{.domain}"
    "[.one:[rows/0:  [.bounded=none:none: the start nearest to the equilibrium is "
    "not {outcome}]"
    "[.bounded=unseen:none: the start nearest to the equilibrium is not known]"
    "[.bounded=no:not known to be bounded: it reaches {.reaches}]"
    "[.bounded=unknown:not known to be bounded: it ends at cases that failed or are pending]"
    "[.bounded=yes:bounded: it ends within the box, so none of this changes with the box]\n"
    "[.directions:[.near:  nearest: " NEAREST "]"
    "[.near_is_least:|  at least {nearest_least%.4g}, where the box ends or a case is not known\n]"
    "  median of {.directions} directions: {median%.4g}"
    "[.median_is_least:|[median:, ]at least {median_least%.4g}]"
    "[leaving:; {leaving*%.3g} % of them leave the box, or come to a case that is not known, "
    "before]\n\n"
    "From the equilibrium to the end of the outcome\n"
    "[.starts*:  along {name%-24s} [low<1e300:{low%12.6g}|           -] ... "
    "[high<1e300:{high%12.6g}|           -] {unit}\n]"
    "  (- where the outcome reaches the end of the axis, or a case that is not known)\n]]]]]";

bool basin_print(const struct basin *b, enum table_form form)
{
    const bool one = b->rows == 1, grid = !b->sampled, bounded = grid && b->choice.rank == 0;
    const struct basin_row *const row = &b->row[0];
    const struct basin_distance *const distance = &row->distance;
    const bool far = one && row->has_distance && distance->inside;
    struct table t = {0};
    for (size_t k = 0; k < b->rows; k++)
        add_row(&t, b, &b->row[k]);
    json_t *facts = table_show(head_facts(b), "rows", &t,
                               one ? "share volume reach low high inside cases remark"
                                   : "at/ share volume reach low high inside cases cut_at remark",
                               BASIN_SHOWN);
    add_notes(b, facts);
    TABLE_PUT(facts, {".starts", as_tree(starts_facts(b))},
              {".near", as_truth((far || (one && !grid)) && isfinite(distance->nearest))},
              {".bounded", as_text(row->part.known == 0    ? "unseen"
                                   : row->part.inside == 0 ? "none"
                                   : row->part.faces       ? "no"
                                   : row->part.unknown     ? "unknown"
                                                           : "yes")},
              {".near_is_least", as_truth(distance->nearest <= distance->clear)},
              {".median_is_least", as_truth(distance->median_least >= distance->median)},
              {".directions", far ? as_whole(distance->directions) : as_nothing(NULL)});
    if (bounded)
        facts = table_show(facts, ".boundary", &t,
                           "at/ entropy boundary_entropy star mixed_boxes boxes alpha "
                           "alpha_error dimension",
                           BASIN_SHOWN);
    if (bounded && b->around)
        facts = table_show(facts, ".domain", &t,
                           "at/ connected connected_reach connected_low connected_high bounded "
                           "nearest median leaving",
                           BASIN_SHOWN);
    return table_say(form, facts, text, &t);
}
