/* critical_print.c - critical values as text, JSON and CSV. */
#include "critical.h"

#include "analysis/basin/basin_print.h"
#include "runner/base/message.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Values kept again, for programs, and for people as "96 ... 110, 130 ...": from the first one to
 * the last, with digits that tell neighbours apart, as a number with its unit is too much in a
 * column. */
static json_t *islands_json(const struct critical *c, const struct critical_row *row, char *text,
                            size_t size)
{
    enum { SHOWN = 4 };
    const double gap = 0.5 * fabs(c->value[1] - c->value[0]);
    json_t *const list = json_array();
    text[0] = '\0';
    for (size_t k = 0; k < row->islands; k++) {
        const struct critical_island *const island = &c->island[row->island + k];
        char first[40], last[40] = "";
        TABLE_APPEND(list, {"from", as_tree(table_pair(island->from[0], island->from[1]))},
                     {"to", as_tree(table_pair(island->to[0], island->to[1]))});
        results_number_text(island->from[1], gap, first, sizeof first);
        if (!isnan(island->to[1]))
            results_number_text(island->to[0], gap, last, sizeof last);
        if (k < SHOWN)
            add_text(text, size, "%s%s ...%s%s", k ? ", " : "", first, last[0] ? " " : "", last);
    }
    if (row->islands > SHOWN)
        add_text(text, size, ", ... (%zu)", row->islands);
    return list;
}

/* What stands in place of a value that there is none of. */
static const char *remark(const struct critical_row *row)
{
    return row->value.end == CRITICAL_KEPT      ? "kept to the end"
           : row->value.end == CRITICAL_OUTSIDE ? "lost at the first"
           : row->value.end == CRITICAL_UNKNOWN ? "unknown beyond"
           : row->value.unknown > 0             ? "some unknown"
                                                : "";
}

/* What is said of a row; names that are no members are of add_row. */
#define ROW(X)                                                                                     \
    X("end", "lost; kept: up to the last value; outside: lost at the first; unknown",              \
      as_text(critical_end_words[v->end]))                                                         \
    X("kept", "", as_number(v->kept), "kept", "%.6g", .width = 11)                                 \
    X("lost", "", as_number(v->lost), "lost", "%.6g", .width = 11)                                 \
    X("outcome_then", "what most become at lost",                                                  \
      row->to == c->of ? as_nothing(NULL) : as_text(results_kind_names[row->to]), "then",          \
      .width = 10, .left = true, .before = "  ")                                                   \
    X("low", "", as_number(v->low), "interval", "%.6g", .width = 25, .left = true, .before = "  ") \
    X("high", "the interval; without a sample kept and lost", as_number(v->high),                  \
      .format = "%.6g", .joined = true, .before = " ... ", .empty = "-")                           \
    X("least_share", "", as_number(v->least_share), "least", "%.2f %%", .width = 9,                \
      .percent = true)                                                                             \
    X("exact", "", as_truth(exact))                                                                \
    X("unknown", "values at which failed or pending cases leave it open", as_whole(v->unknown))    \
    X("unseen", "widest gap between values simulated", as_number(row->unseen))                     \
    X("again", NULL, as_text(again[0] ? again : NULL), "again", .left = true, .before = "  ",      \
      .hidden = TABLE_NO_JSON)                                                                     \
    X("remark", NULL, as_text(remark(row)), "", .left = true, .before = "  ", .empty = "",         \
      .hidden = TABLE_VIEW_ONLY)                                                                   \
    X("islands", "[{from: [a, b], to: [a, b]}]", as_tree(islands))

static void add_row(struct table *t, const struct critical *c, const struct critical_row *row)
{
    const struct critical_value *const v = &row->value;
    const bool exact = !c->sampled && v->unknown == 0 && v->end == CRITICAL_LOST;
    char again[240];
    json_t *const islands = islands_json(c, row, again, sizeof again);
    table_axes(t, c->r, c->by, c->by_axes, row->point);
    TABLE_FACTS(t, ROW(TABLE_FACT));
    table_end_row(t);
}

/* Of all rows, among what critical_print has. */
#define HEAD(X)                                                                                    \
    X("outcome", "", as_text(results_kind_names[c->of]))                                           \
    X("within", "", as_text(within[0] ? within : NULL))                                            \
    X("of", "", as_text(axis->name))                                                               \
    X("unit", "", as_text(axis->unit))                                                             \
    X("from", "", as_number(c->value[0]))                                                          \
    X("to", "", as_number(c->value[c->count - 1]))                                                 \
    X("share", "null: no sample", c->sampled ? as_number(c->choice.share) : as_nothing(NULL))      \
    X("level", "", as_number(c->choice.level))                                                     \
    X("points", "", as_whole(c->points))

static const struct say_key row_keys[] = {TABLE_KEY_AT ROW(TABLE_KEY){0}};
const struct say_key critical_keys[] = {HEAD(TABLE_KEY){"rows", "null beyond the ends", row_keys},
                                        {0}};

static const char text[] = BASIN_TITLE
    "How far {of} may go from {..from} towards {..to}, up to which [share:at least {share*%.4g} % "
    "of the {points} points\nof the sample|cases] end as {outcome}[within: with "
    "{within}]\n\n{.rows}"
    "[.number:  (the number lies between kept and lost: [share:of these points|exact[.unsure:, "
    "wider "
    "where some are unknown]]"
    "[.interval:; interval: of all that could be drawn, at {level*%.4g} %]"
    "[.least:; least: of all that could\n  be drawn at least this share keeps it, at {level*%.4g} "
    "%]"
    "[.blocks:; no interval: points hang together in blocks]"
    "[.again:;\n  again: values beyond at which [share:so many keep it|it is kept], too, which do "
    "not count])\n"
    "  (before it, pockets in which it is lost may have been missed where they are narrower than "
    "{.unseen%.4g}[.unit: {.unit}])\n]"
    "[.pending:  ({.pending} cases are not done: go on with --resume)\n]";

int critical_print(const struct critical *c, const char *within, enum table_form form)
{
    const struct results_axis *const axis = &c->r->axis[c->along];
    struct table t = {0};
    double unseen = 0;
    bool again = false, remarks = false, unsure = false, number = false;
    uint64_t pending = 0;
    char view[120];
    for (size_t k = 0; k < c->rows; k++) {
        const struct critical_row *const row = &c->row[k];
        add_row(&t, c, row);
        number = number || row->value.end == CRITICAL_LOST;
        unseen = row->value.end == CRITICAL_OUTSIDE ? unseen : fmax(unseen, row->unseen);
        again = again || row->islands > 0;
        unsure = unsure || row->value.unknown > 0;
        remarks = remarks || remark(row)[0];
    }
    for (uint64_t i = 0; i < c->r->cases; i++)
        pending += c->r->kind[i] == RESULTS_PENDING;
    const bool whole = c->sampled && !(c->choice.share < 1);
    snprintf(view, sizeof view, "at/ kept lost outcome_then%s%s%s",
             !c->sampled || c->blocks ? ""
             : whole                  ? " least_share"
                                      : " low high",
             again ? " again" : "", remarks ? " remark" : "");
    json_t *const facts = TABLE_OBJECT(
        HEAD(TABLE_MEMBER){".from", as_place(axis, c->order[0])},
        {".to", as_place(axis, c->order[c->count - 1])},
        {".interval", as_truth(c->sampled && !c->blocks && !whole)},
        {".least", as_truth(whole && !c->blocks)}, {".blocks", as_truth(c->blocks)},
        {".again", as_truth(again)}, {".unsure", as_truth(unsure)}, {".unseen", as_number(unseen)},
        {".number", as_truth(number)}, {".pending", pending ? as_whole(pending) : as_nothing(NULL)},
        {".unit", as_text(strcmp(axis->unit, "1") == 0 ? "" : axis->unit)});
    return report_code(table_say(
        form, table_show(basin_titled(c->r, facts), "rows", &t, view, CRITICAL_SHOWN), text, &t));
}
