/* command_ranges.c - `stance ranges SCENARIO`: which ranges of starts show the domain, before
 * anything is run, with the lines to paste. */
#include "basin_ranges.h"

#include "analysis/table/report.h"
#include "runner/base/sandbox.h"
#include "runner/plan/asked.h"
#include "runner/plan/instruction_set.h"
#include "runner/plan/kernels.h"

#include <inttypes.h>
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
static double value_at(const struct ranges_field *field, double x)
{
    char text[32];
    snprintf(text, sizeof text, "%.9g", field->centre + field->along * x);
    return strtod(text, NULL);
}

/* "initial.offset.theta", "initial.offset.theta and 2 more" */
static const char *axis_name(const struct ranges *r, const struct ranges_axis *axis, char name[128])
{
    const char *path = r->field[axis->first].path;
    if (axis->fields == 1)
        snprintf(name, 128, "%s", path);
    else
        snprintf(name, 128, "%s and %d more", path, axis->fields - 1);
    return name;
}

/* ---- text --------------------------------------------------------------------------------- */

/* "x" of a path, "[x, y]" of several. */
static void print_row(const struct ranges *r, const struct ranges_axis *axis, double x)
{
    for (int k = 0; k < axis->fields; k++)
        printf("%s%.9g",
               k                  ? ", "
               : axis->fields > 1 ? "["
                                  : "",
               value_at(&r->field[axis->first + k], x));
    printf("%s", axis->fields > 1 ? "]" : "");
}

static void print_axis(const struct ranges *r, const struct ranges_axis *axis,
                       const struct ranges_range *range)
{
    printf("    - {%s: ", axis->fields > 1 ? "paths" : "path");
    for (int k = 0; k < axis->fields; k++)
        printf("%s%s", k ? ", " : axis->fields > 1 ? "[" : "", r->field[axis->first + k].path);
    printf("%s, from: ", axis->fields > 1 ? "]" : "");
    print_row(r, axis, range->from);
    printf(", to: ");
    print_row(r, axis, range->to);
    if (range->points > 0)
        printf(", count: %zu", range->points);
    printf("} # %s\n", axis->unit);
}

/* The head of the scenario's sample: the axes are its factors. */
static void print_sample(const struct doe *design, const char *before)
{
    printf("%s  sample:\n%s    method: %s\n%s    count: %" PRIu64 "\n", before, before,
           doe_words[design->method], before, design->count);
    if (design->method == DOE_MORRIS)
        printf("%s    levels: %d\n", before, design->levels);
    if (design->second_order)
        printf("%s    second_order: true\n", before);
    printf("%s    vary:\n", before);
}

/* The sweep, of the grid before those of the sample; where it does not count as a comment. */
static void print_axes(const struct ranges *r, bool counts, bool close)
{
    const char *before = counts ? "" : "#";
    printf("%ssweep:\n", before);
    for (int sampled = 0; sampled < 2; sampled++) {
        bool any = false;
        for (int a = 0; !sampled && a < r->s->axes; a++) {
            /* The axis along which the scenario goes out on rays. */
            const struct scenario_axis *const axis = &r->s->axis[a];
            if (axis->offset[0] != offsetof(struct scenario_values, offset_scale))
                continue;
            printf("%s  grid:\n%s    - {path: %s, from: %.9g, to: %.9g, count: %zu}\n", before,
                   before, axis->path[0], scenario_axis_value(axis, 0, 0),
                   scenario_axis_value(axis, axis->count - 1, 0), axis->count);
            any = true;
        }
        for (int a = 0; a < r->axes; a++) {
            if (r->axis[a].sampled != sampled)
                continue;
            if (!any && sampled)
                print_sample(&r->s->sample.design, before);
            else if (!any)
                printf("%s  grid:\n", before);
            any = true;
            printf("%s%s", before, sampled ? "  " : "");
            print_axis(r, &r->axis[a], close ? &r->axis[a].close : &r->axis[a].whole);
        }
    }
}

/* The row that stands at x, of JSON. */
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

static void add_axis(struct table *t, const struct ranges *r, const struct ranges_axis *axis)
{
    const struct ranges_field *field = &r->field[axis->first];
    char name[128], beyond[64];
    json_t *const paths = json_array();
    for (int k = 0; k < axis->fields; k++)
        table_append(paths, as_text(field[k].path));
    snprintf(beyond, sizeof beyond, "%s, %s", ranges_end(axis->beyond[0]),
             ranges_end(axis->beyond[1]));
    const bool chosen = axis - r->axis < r->axes;
    const double low = value_at(field, axis->alone[0]), high = value_at(field, axis->alone[1]),
                 least = chosen ? value_at(field, axis->reach[0]) : NAN,
                 most = chosen ? value_at(field, axis->reach[1]) : NAN;
    TABLE_FACTS(
        t,
        {{"axis", "", .left = true, .hidden = TABLE_NO_JSON, .before = "#   "},
         as_text(axis_name(r, axis, name))},
        {{.name = "low", .heading = "along it alone", .format = "%.3g", .hidden = TABLE_NO_JSON},
         as_number(low)},
        {{.name = "high",
          .format = "%.3g",
          .joined = true,
          .before = " ... ",
          .hidden = TABLE_NO_JSON},
         as_number(high)},
        {{"ends", "beyond", .left = true, .hidden = TABLE_NO_JSON}, as_text(beyond)},
        {{.name = "least", .heading = "with the others", .format = "%.3g", .hidden = TABLE_NO_JSON},
         as_number(least)},
        {{.name = "most",
          .format = "%.3g",
          .joined = true,
          .before = " ... ",
          .hidden = TABLE_NO_JSON},
         as_number(most)},
        {{"unit", "", .left = true}, as_text(axis->unit)}, {{.name = "paths"}, as_tree(paths)},
        {{.name = "whole"}, as_tree(range_json(r, axis, &axis->whole))},
        {{.name = "close"}, as_tree(range_json(r, axis, &axis->close))},
        {{.name = "alone"}, as_tree(json_pack("[f,f]", low, high))},
        {{.name = "beyond"},
         as_tree(table_texts(ranges_end(axis->beyond[0]), ranges_end(axis->beyond[1])))},
        {{.name = "reach"}, as_tree(json_pack("[f,f]", least, most))},
        {{.name = "cut"},
         as_tree(chosen ? json_pack("[b,b]", ranges_cut(axis, 0) != RANGES_HELD,
                                    ranges_cut(axis, 1) != RANGES_HELD)
                        : NULL)},
        {{.name = "lost"}, as_tree(json_pack("[b,b]", !axis->open[0], !axis->open[1]))});
    table_end_row(t);
}

/* In which directions the outcome was not lost. */
static void print_open(const struct ranges *r)
{
    bool any = false;
    if (r->open == 0)
        return;
    printf("# Not lost along %zu of the rays, as far as is looked:", r->open);
    for (int a = 0; a < r->axes; a++) {
        const struct ranges_axis *axis = &r->axis[a];
        for (int up = 0; up < 2; up++) {
            if (!axis->open[up])
                continue;
            printf("%s %s = %.3g %s", any ? "," : "", r->field[axis->first].path,
                   value_at(&r->field[axis->first], (up ? 1 : -1) * axis->limit), axis->unit);
            any = true;
        }
    }
    puts(".");
}

/* At which ends the ranges cut the domain, and why they go no further. False: at none. */
static bool print_cuts(const struct ranges *r, bool print)
{
    static const char *const why[] = {[RANGES_NO_START] = "where starts cease to exist",
                                      [RANGES_NOT_FOLLOWED] = "rays were followed no further"};
    bool any = false;
    for (int k = 0; k < 2 * r->axes; k++) {
        const struct ranges_axis *axis = &r->axis[k / 2];
        const enum ranges_cut cut = ranges_cut(axis, k % 2);
        any = any || cut;
        if (cut && print)
            printf("#   cut at %s = %.9g %s: %s\n", r->field[axis->first].path,
                   value_at(&r->field[axis->first], k % 2 ? axis->whole.to : axis->whole.from),
                   axis->unit, why[cut]);
    }
    return any;
}

/* A part of a scenario: what is not that is a comment. */
static bool print_text(const struct ranges *r, const struct table *t)
{
    const bool seen = ranges_resolve(r);
    const char *of = ranges_end(r->of),
               *start = r->s->base.state_given ? "initial.state" : "the equilibrium";
    printf("# Where starts about %s cease to be %s (%zu rays, %" PRIu64 " simulations):\n", start,
           of, r->rays, r->simulated);
    const bool good = table_write_text(t, stdout, "axis low high ends least most unit", 0);
    if (r->held < r->parameters)
        printf("# At %zu of %zu points of the other axes %s itself is not %s.\n",
               r->parameters - r->held, r->parameters, start, of);
    else if (r->parameters > 1)
        printf("# Alone: at the first point of the other axes; with the others: at %zu of them.\n",
               r->parameters);
    if (r->failed > 0)
        printf("# %" PRIu64 " simulations failed and count as lost.\n", r->failed);
    print_open(r);
    printf("# These ranges %s the domain%s: about %.*f %%", print_cuts(r, false) ? "cut" : "hold",
           seen ? "" : ", with too few points to show it", r->share[0] < 0.1, 100 * r->share[0]);
    if (r->share[1] - r->share[0] >= 0.01)
        printf(" to %.0f %%", 100 * r->share[1]);
    printf(" of the starts in them are %s.\n", of);
    print_cuts(r, true);
    if (r->impossible > 0)
        puts("# Some of these starts cannot be, and a run says so: narrow the ranges there.");
    if (!r->chosen)
        puts("# (In place of the axes of starts that the scenario has.)");
    print_axes(r, seen, false);
    if (r->share[1] < THIN || !seen) {
        puts("# Closer, where they show how wide a thin domain is at the equilibrium, and cut it:");
        print_axes(r, !seen, true);
    }
    return good;
}

static bool print_json(const struct ranges *r, const struct table *t)
{
    return table_write_json(
        TABLE_OBJECT({"scenario", as_text(r->s->name)}, {"outcome", as_text(ranges_end(r->of))},
                     {"chosen", as_truth(r->chosen)}, {"parameters", as_whole(r->parameters)},
                     {"held", as_whole(r->held)}, {"resolved", as_truth(ranges_resolve(r))},
                     {"rays", as_whole(r->rays)}, {"not_lost", as_whole(r->open)},
                     {"simulations", as_whole(r->simulated)}, {"failed", as_whole(r->failed)},
                     {"share", as_tree(json_pack("[f,f]", r->share[0], r->share[1]))},
                     {"axes", as_tree(table_json(t, false))}),
        stdout);
}

/* ---- the command -------------------------------------------------------------------------- */

static int show(const struct request *request, const struct scenario *s)
{
    static const uint8_t number_of[] = {
#define RANGES_NUMBER(NAME, name, number, text) number,
        STANCE_OUTCOMES(RANGES_NUMBER)
#undef RANGES_NUMBER
    };
    struct ranges *r = malloc(sizeof *r);
    struct table t = {0};
    stance_message message = {""};
    int code = EXIT_IO;
    if (!r || !ranges_make(r, s, number_of[request->of], &message)) {
        fprintf(stderr, "%s: %s\n", s->file, r ? message.text : "not enough memory");
        code = r ? EXIT_USAGE : EXIT_IO;
    } else {
        for (int a = 0; a < (request->json ? r->axes : r->looked); a++)
            add_axis(&t, r, &r->axis[a]);
        code = (request->json ? print_json : print_text)(r, &t) ? EXIT_DONE : EXIT_IO;
    }
    table_free(&t);
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
    struct request request = {.of = RESULTS_STABILISED};
    const int code = command_begin(&command_ranges, argc, argv, &request);
    if (code != COMMAND_GOES_ON)
        return code;
    return instruction_set_usable("ranges") ? sandbox(work, &request, request.asked.file)
                                            : EXIT_USAGE;
}

static const struct option options[] = {
    {.rows = asked_options},
    {"--of", "OUTCOME", OPTION_TO(struct request, of), .word = results_outcome_word,
     .text = "look for another outcome than stabilised"},
    {OPTION_TIME_LIMIT},
    {OPTION_JSON(struct request, json)},
    {0},
};

const struct command command_ranges = {
    "ranges",
    "find ranges of starts that show the domain, with the lines to paste",
    run,
    options,
    "Simulates a few hundred rays from the equilibrium (with initial.state: from that start) "
    "until the outcome is lost along each, and prints how far it reaches, ranges that hold all of "
    "it with a margin and that the equilibrium is a point of, and what share of them it fills: as "
    "lines of the scenario, what is for people as comments. One that has no sweep takes them as "
    "they are: stance ranges own.yaml >> own.yaml. Of a domain that fills less than a tenth, "
    "ranges about the equilibrium are told, too, which come first where the others have too few "
    "points for it. The axes are those of sweep.grid and sweep.sample over initial.offset and "
    "initial.state, along which several paths may move together; where there are none, the angle "
    "and the rate of the coordinate along which the outcome is lost first, in units of the window "
    "of settling. Of the sweep's other axes up to 3 points are looked at, evenly spread: the "
    "ranges hold the domains of all. A ray ends where the outcome is lost first: islands beyond "
    "do not count. Angles are followed up to 3.14 rad, places to 10 m, rates to 100 rad/s or m/s, "
    "and ranges end where starts cease to exist: at which ends they cut the domain is said.\n",
    "    scenario, outcome         strings\n"
    "    chosen                    whether the axes are not the scenario's\n"
    "    parameters, held          points of the other axes; of these, at which the equilibrium "
    "has the outcome\n"
    "    resolved                  whether the whole ranges have points enough to show the "
    "domain\n"
    "    rays, not_lost            rays; of these, along which it was not lost\n"
    "    simulations, failed       numbers\n"
    "    share                     [least, most] over the points, of 256 starts each\n"
    "    axes                      [{paths, unit, whole: {from, to: [a value a path], count "
    "(null: of a sample)}, close: the same about the equilibrium; of the first path alone: [low, "
    "high] along this axis, beyond: [what becomes of starts there], reach: [least, most] along "
    "all rays, cut: [below, above] whether the whole range cuts the domain, lost: [below, "
    "above]}]\n",
};
