/* command_ranges.c - `stance ranges SCENARIO`: which ranges of starts show the domain, before
 * anything is run, with the lines to paste. */
#include "basin_ranges.h"

#include "analysis/table/report.h"
#include "runner/base/sandbox.h"
#include "runner/plan/asked.h"
#include "runner/plan/instruction_set.h"
#include "runner/plan/kernels.h"

#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>

extern const struct command command_ranges; /* below */

#define THIN 0.1 /* share of the ranges below which closer ones are told, too */

struct request {
    struct asked asked;
    bool json;
    int of; /* its place among the outcomes */
};

/* Of a field at x of its axis, in the digits that ranges have. */
static double value_at(const struct starts_field *field, double x)
{
    char text[32];
    snprintf(text, sizeof text, "%.9g", field->centre + field->along * x);
    return strtod(text, NULL);
}

/* ---- facts -------------------------------------------------------------------------------- */

/* What stands at x. */
static json_t *row_json(const struct ranges *r, const struct ranges_axis *axis, double x)
{
    json_t *row = json_array();
    for (int k = 0; k < axis->fields; k++)
        table_append(row, as_number(value_at(&r->field[axis->first + k], x)));
    return row;
}

static json_t *range_json(const struct ranges *r, const struct ranges_axis *axis,
                          const struct ranges_range *range)
{
    return TABLE_OBJECT({"from", as_tree(row_json(r, axis, range->from))},
                        {"to", as_tree(row_json(r, axis, range->to))},
                        {"count", range->points ? as_whole(range->points) : as_nothing(NULL)});
}

/* Of an axis; names that are no members are of add_axis. */
#define AXIS_FACTS(X)                                                                              \
    X("axis", NULL, as_text(name), "", .left = true, .hidden = TABLE_NO_JSON, .before = "#   ")    \
    X("low", NULL, as_number(low), "along it alone", "%.3g", .hidden = TABLE_NO_JSON)              \
    X("high", NULL, as_number(high), .format = "%.3g", .joined = true, .before = " ... ",          \
      .hidden = TABLE_NO_JSON)                                                                     \
    X("ends", NULL, as_text(beyond), "beyond", .left = true, .hidden = TABLE_NO_JSON)              \
    X("least", NULL, as_number(least), "with the others", "%.3g", .hidden = TABLE_NO_JSON)         \
    X("most", NULL, as_number(most), .format = "%.3g", .joined = true, .before = " ... ",          \
      .hidden = TABLE_NO_JSON)                                                                     \
    X("unit", "", as_text(axis->unit), "", .left = true)                                           \
    X("paths", "", as_tree(paths))                                                                 \
    X(".many", NULL, as_truth(axis->fields > 1))                                                   \
    X(".sampled", NULL, as_truth(axis->sampled))                                                   \
    X("whole", "{from, to: [a value a path], count (null: of a sample)}",                          \
      as_tree(range_json(r, axis, &axis->whole)))                                                  \
    X("close", "the same about the equilibrium", as_tree(range_json(r, axis, &axis->close)))       \
    X("alone", "of the first path: [low, high] along this axis",                                   \
      as_tree(json_pack("[f,f]", low, high)))                                                      \
    X("beyond", "what becomes of starts at these ends",                                            \
      as_tree(table_texts(ranges_end(axis->beyond[0]), ranges_end(axis->beyond[1]))))              \
    X("reach", "[least, most] along all rays", as_tree(json_pack("[f,f]", least, most)))           \
    X("cut", "[below, above] whether the whole range cuts the domain",                             \
      as_tree(chosen ? json_pack("[b,b]", ranges_cut(axis, 0) != RANGES_HELD,                      \
                                 ranges_cut(axis, 1) != RANGES_HELD)                               \
                     : NULL))                                                                      \
    X("lost", "[below, above]", as_tree(json_pack("[b,b]", !axis->open[0], !axis->open[1])))
#define HEAD(X)                                                                                    \
    X("scenario", "", as_text(r->s->name))                                                         \
    X("outcome", "", as_text(ranges_end(r->of)))                                                   \
    X("chosen", "whether the axes are not the scenario's", as_truth(r->chosen))                    \
    X("parameters", "points of the other axes", as_whole(r->parameters))                           \
    X("held", "of these, at which the equilibrium has the outcome", as_whole(r->held))             \
    X("resolved", "whether the whole ranges have points enough to show the domain",                \
      as_truth(resolved))                                                                          \
    X("rays", "", as_whole(r->rays))                                                               \
    X("not_lost", "of these, along which it was not lost", as_whole(r->open))                      \
    X("simulations", "", as_whole(r->simulated))                                                   \
    X("failed", "", as_whole(r->failed))                                                           \
    X("share", "[least, most] over the points, of 256 starts each",                                \
      as_tree(table_pair(r->share[0], r->share[1])))
static const struct say_key axis_keys[] = {AXIS_FACTS(TABLE_KEY){0}};
static const struct say_key keys[] = {HEAD(TABLE_KEY){"axes", "", axis_keys}, {0}};

static void add_axis(struct table *t, const struct ranges *r, const struct ranges_axis *axis)
{
    const struct starts_field *field = &r->field[axis->first];
    char name[128], beyond[64];
    json_t *const paths = json_array();
    for (int k = 0; k < axis->fields; k++)
        table_append(paths, as_text(field[k].path));
    snprintf(name, sizeof name, axis->fields == 1 ? "%s" : "%s and %d more", field->path,
             axis->fields - 1);
    snprintf(beyond, sizeof beyond, "%s, %s", ranges_end(axis->beyond[0]),
             ranges_end(axis->beyond[1]));
    const bool chosen = axis - r->axis < r->axes;
    const double low = value_at(field, axis->alone[0]), high = value_at(field, axis->alone[1]),
                 least = chosen ? value_at(field, axis->reach[0]) : NAN,
                 most = chosen ? value_at(field, axis->reach[1]) : NAN;
    TABLE_FACTS(t, AXIS_FACTS(TABLE_FACT));
    table_end_row(t);
}

/* In which directions the outcome was not lost, and at which ends the ranges cut the domain. */
static void add_ends(const struct ranges *r, json_t *facts)
{
    static const char *const why[] = {[RANGES_NO_START] = "where starts cease to exist",
                                      [RANGES_NOT_FOLLOWED] = "rays were followed no further"};
    for (int k = 0; k < 2 * r->axes; k++) {
        const struct ranges_axis *axis = &r->axis[k / 2];
        const struct starts_field *field = &r->field[axis->first];
        const enum ranges_cut cut = ranges_cut(axis, k % 2);
        if (axis->open[k % 2])
            say_add(facts, ".open", "%s %s = %.3g %s", json_object_get(facts, ".open") ? "," : "",
                    field->path, value_at(field, (k % 2 ? 1 : -1) * axis->limit), axis->unit);
        if (cut)
            say_add(facts, ".cuts", "#   cut at %s = %.9g %s: %s\n", field->path,
                    value_at(field, k % 2 ? axis->whole.to : axis->whole.from), axis->unit,
                    why[cut]);
    }
}

/* The axis along which the scenario goes out on rays, and the head of its sample, whose factors the
 * axes are. */
static void add_sweep(const struct ranges *r, json_t *facts)
{
    const struct doe *const design = &r->s->sample.design;
    int sampled = 0;
    json_t *const scales = json_array();
    for (int a = 0; a < r->s->axes; a++) {
        const struct scenario_axis *const axis = &r->s->axis[a];
        if (axis->offset[0] == offsetof(struct scenario_values, offset_scale))
            TABLE_APPEND(scales, {"path", as_text(axis->path[0])},
                         {"from", as_number(scenario_axis_value(axis, 0, 0))},
                         {"to", as_number(scenario_axis_value(axis, axis->count - 1, 0))},
                         {"count", as_whole(axis->count)});
    }
    for (int a = 0; a < r->axes; a++)
        sampled += r->axis[a].sampled;
    TABLE_PUT(facts, {".grid", as_truth(json_array_size(scales) > 0 || sampled < r->axes)},
              {".scales", as_tree(scales)}, {".sample", as_truth(sampled > 0)},
              {".method", as_text(doe_words[design->method])}, {".count", as_whole(design->count)},
              {".levels", as_whole(design->method == DOE_MORRIS ? (uint64_t)design->levels : 0)},
              {".second", as_truth(design->second_order)});
}

/* A part of a scenario: what is not that is a comment, as is a sweep behind a hash. */
#define AXIS(range)                                                                                \
    "    - \\{[.many:paths: \\[|path: ][paths*, :{value}][.many:\\]], "                            \
    "from: [.many:\\[][" range "/from*, :{value%.9g}][.many:\\]], "                                \
    "to: [.many:\\[][" range "/to*, :{value%.9g}][.many:\\]]"                                      \
    "[" range "/count:, count: {" range "/count}]} # {unit}\n"
#define SWEEP(hash, range)                                                                         \
    hash "sweep:\n[.grid:" hash "  grid:\n"                                                        \
         "[.scales*:" hash "    - \\{path: {path}, from: {from%.9g}, to: {to%.9g}, "               \
         "count: {count}}\n][axes*:[!.sampled:" hash                                               \
         AXIS(range) "]]]"                                                                         \
                     "[.sample:" hash "  sample:\n" hash "    method: {.method}\n" hash            \
                     "    count: {.count}\n"                                                       \
                     "[.levels:" hash "    levels: {.levels}\n][.second:" hash                     \
                     "    second_order: true\n]" hash "    vary:\n[axes*:[.sampled:" hash          \
                     "  " AXIS(range) "]]]"
static const char text[] =
    "# Where starts about {.start} cease to be {outcome} ({rays} rays, {simulations} "
    "simulations):\n"
    "{.looked}"
    "[.short:# At {.short} of {parameters} points of the other axes {.start} itself is not "
    "{outcome}.\n"
    "|[parameters>1:# Alone: at the first point of the other axes; with the others: at "
    "{parameters} of them.\n]]"
    "[failed:# {failed} simulations failed and count as lost.\n]"
    "[not_lost:# Not lost along {not_lost} of the rays, as far as is looked:{.open}.\n]"
    "# These ranges [.cuts:cut|hold] the domain[!resolved:, with too few points to show it]: about "
    "{.share} of the starts in them are {outcome}.\n{.cuts}"
    "[.impossible:# Some of these starts cannot be, and a run says so: narrow the ranges there.\n]"
    "[!chosen:# (In place of the axes of starts that the scenario has.)\n]" SWEEP(
        "[!resolved:#]", "whole") "[.thin:# Closer, where they show how wide a thin domain is at "
                                  "the equilibrium, and cut it:\n" SWEEP("[resolved:#]",
                                                                         "close") "]";

static bool print(const struct ranges *r, bool json)
{
    struct table axes = {0}, looked = {0};
    const bool resolved = ranges_resolve(r);
    for (int a = 0; a < r->axes; a++)
        add_axis(&axes, r, &r->axis[a]);
    for (int a = 0; !json && a < r->looked; a++)
        add_axis(&looked, r, &r->axis[a]);
    json_t *const facts = TABLE_OBJECT(
        HEAD(TABLE_MEMBER){".start",
                           as_text(r->s->base.state_given ? "initial.state" : "the equilibrium")},
        {".short", as_whole(r->parameters - r->held)}, {".impossible", as_whole(r->impossible)},
        {".thin", as_truth(r->share[1] < THIN || !resolved)});
    say_add(facts, ".share", "%.*f %%", r->share[0] < 0.1, 100 * r->share[0]);
    if (r->share[1] - r->share[0] >= 0.01)
        say_add(facts, ".share", " to %.0f %%", 100 * r->share[1]);
    add_ends(r, facts);
    add_sweep(r, facts);
    const bool good =
        table_give(facts, "axes", &axes, NULL, 0) &&
        table_give(facts, ".looked", &looked, "axis low high ends least most unit", 0);
    return say_facts(facts, json, text, stdout) && good;
}

/* ---- the command -------------------------------------------------------------------------- */

static int show(const struct request *request, const struct scenario *s)
{
    const int wanted = s->base.walk_steps > 0 ? RESULTS_WALKS : RESULTS_STABILISED;
    const int of = request->of < RESULTS_OUTCOMES ? request->of : wanted;
    struct ranges *r = malloc(sizeof *r);
    stance_message message = {""};
    const bool found = (r || no_memory(&message)) &&
                       ranges_make(r, s, starts_outcome((enum results_kind)of), &message);
    if (!found)
        fprintf(stderr, "%s: %s\n", s->file, message.text);
    const int code = found ? report_code(print(r, request->json)) : r ? EXIT_USAGE : EXIT_IO;
    free(r);
    return code;
}

/* With kernels that are compiled, where `run` will want them, too: for the sweep that there is, or
 * for the one that is proposed. */
static int prepare(const struct scenario *s, void *request)
{
    const struct parallel alone = parallel_alone();
    struct plan plan;
    struct kernels kernels;
    struct plan_error error = {0};
    stance_message message = {""};
    const struct kernels_choice choice = {.always = s->axes == 0};
    if (!asked_law(s))
        return EXIT_USAGE;
    if (!plan_make(&plan, s, false, 0, false, &error))
        return plan_error_print(s, &error);
    plan.patience = PLAN_PATIENCE_DESIGNS;
    int code = EXIT_DONE;
    if (!plan_compute_designs(&plan, &alone, &error))
        code = plan_error_print(s, &error);
    else if ((code = kernels_take(&kernels, &plan, &choice, &alone, &message)) != EXIT_DONE)
        fprintf(stderr, "stance ranges: %s\n", message.text);
    plan_free(&plan);
    if (code != EXIT_DONE)
        return code;
    code = show(request, s);
    kernels_give_back(&kernels);
    return code;
}

static int work(void *request)
{
    return asked_work(request, prepare, request);
}

static int run(int argc, char **argv)
{
    struct request request = {.of = RESULTS_OUTCOMES};
    const int code = command_begin(&command_ranges, argc, argv, &request);
    if (code != COMMAND_GOES_ON)
        return code;
    return instruction_set_usable("ranges") ? sandbox(work, &request, request.asked.file)
                                            : EXIT_USAGE;
}

static const struct option options[] = {
    {.rows = asked_simulates},
    {"--of", "OUTCOME", OPTION_TO(struct request, of), .word = results_outcome_word,
     .text = "look for another outcome than stabilised, or than walks with stop.walks"},
    {OPTION_TIME_LIMIT},
    {OPTION_JSON(struct request, json), .keys = keys},
    {0},
};

const struct command command_ranges = {
    "ranges",
    "find ranges of starts that show the domain, with the lines to paste",
    run,
    options,
    "Simulates a few hundred rays from the equilibrium (with initial.state: from that start) "
    "until the outcome is lost along each, and prints how far it reaches, ranges that hold all of "
    "it with a margin, and what share of them it fills: as lines of a scenario, which one without "
    "a sweep takes as they are (stance ranges own.yaml >> own.yaml), what is for people as "
    "comments. Of a domain that fills less than a tenth, ranges about the equilibrium are told, "
    "too. The axes are those of sweep.grid and sweep.sample over initial.offset and initial.state; "
    "without any the angle and the rate of the coordinate along which the outcome is lost first, "
    "in "
    "units of the window of settling. Of the sweep's other axes up to 3 points are looked at. "
    "Islands beyond the end of a ray do not count. Angles are followed up to 3.14 rad, places to "
    "10 m, rates to 100 rad/s or m/s; ends at which ranges cut the domain are said.\n",
    NULL,
};
