/* command_summary.c - `stance summary FILE`: what came out, as text, JSON or CSV. */
#include "summary.h"

#include "analysis/optimise/search_summary.h"
#include "analysis/table/report.h"

#include <stdlib.h>

extern const struct command command_summary; /* below */

static int summarise(struct report *report, const struct results *r, stance_message *message)
{
    struct summary *summary = calloc(1, sizeof *summary);
    bool good = summary && summary_make(summary, r, message);
    if (good) {
        good = (report->form == TABLE_AS_JSON  ? summary_print_json
                : report->form == TABLE_AS_CSV ? summary_print_csv
                                               : summary_print_text)(summary, r);
        summary_free(summary);
    }
    free(summary);
    return good ? EXIT_DONE : EXIT_IO;
}

static int run(int argc, char **argv)
{
    struct report report = {
        .command = &command_summary, .work = summarise, .search = search_summarise};
    int code;
    return report_options(&report, argc, argv, NULL, 0, &code) ? report_run(&report) : code;
}

const struct command command_summary = {
    "summary",
    "summary FILE [--json | --csv]\n"
    "       stance summary SEARCH... [--json | --csv]",
    "what came out: outcomes, extent of the stabilised set, extremes, cost",
    run,
    "Works on files that are not finished, too. Shares are of the cases that are done. Those of a\n"
    "grid have no intervals: its cases are no draws, and how much of the space between them has "
    "an\n"
    "outcome `stance basin` says. With sweep.sample shares have 95 % intervals of the sample: "
    "what\n"
    "scatters are its points (of saltelli and morris blocks), not the cases that each has on grid\n"
    "axes. An extent is the unbroken stretch of stabilised cases through the equilibrium along one "
    "axis of offsets, on the line where the other offsets are nearest to\n"
    "zero; it ends midway between the last stabilised case and the next one.\n"
    "\n"
    "  --csv    the counts of all cases, then a row for every value of every parameter: "
    "parameter,\n"
    "           value, done, failed, pending, stabilised, rested, fell, undecided, and the share\n"
    "           of stabilised cases (without a controller that has a target: rested ones) with\n"
    "           its interval low ... high (of a grid empty); `stance table` has the cases "
    "themselves\n"
    "  --json   the same as JSON; what does not apply is left out or null. Keys\n"
    "    file, title, version, revision, date, ranks\n"
    "    scenarios    [{date, done}] of a file that went on with another scenario, the first one\n"
    "                 first: since when, cases done with it\n"
    "    axes         [{path, unit, long_name, count, first, last}]\n"
    "    fixed        {path: value} of the fields that do not vary\n"
    "    cases        total, done, failed, pending; inferred: done, but not simulated (refined "
    "map);\n"
    "                 damaged: pending, because their checksums do not fit\n"
    "    failures     {reason: count}\n"
    "    outcomes     {name: {count, share, low, high}} of the cases done\n"
    "    cut          [{path, end: lower or upper, at}]: faces of the box of starts on which "
    "cases\n"
    "                 of the kind judged by lie, so that their share is the box's\n"
    "    fall_causes  {point or body: count} of those that fell\n"
    "    extents      [{path, unit, outcome, stabilised, low, high, low_at_end, high_at_end,\n"
    "                 low_unknown, high_unknown, at: {path: value}}]; outcome of the case nearest\n"
    "                 to the equilibrium; where that is pending or failed stabilised is null\n"
    "    parameters   [{path, unit, share_of, values: [{value, done, failed, pending,\n"
    "                 stabilised, rested, fell, undecided, share, low, high,\n"
    "                 extents: {path: [low, high]}}],\n"
    "                 steepest: {from, to}}]; share_of: stabilised, or without a controller\n"
    "                 that has a target rested; an extent is [] for none, null for unknown\n"
    "    pairs        of two parameters, no more: {paths: [2], share: [[...]]}, a row for each\n"
    "                 value of the first, a column for each of the second; null where none done\n"
    "    changes      [{from, to, before, after}] along the axis of a sweep with one axis\n"
    "    sample       null, or of sweep.sample {method, points, share_of, varied, rays}: varied\n"
    "                 [{path, unit, factor, parts: [{from, to, done, share, low, high}]}], parts\n"
    "                 of equally many points or one for each value; rays, beside one axis of\n"
    "                 offsets, null or {path, points, smallest, median, largest, nearest, at,\n"
    "                 reach_end, none, unknown}: where the stabilised set ends along it; `at`\n"
    "                 the values at the point of the smallest, offsets times the scale\n"
    "    numbers      {answer: {of, unit, count, smallest, median, q90, q99, largest}}\n"
    "    through_ground  {cases, judged}: in which a contact that ground.contacts leaves out\n"
    "                 went through the ground; of these those of the kind judged by\n"
    "    cost         steps, iterations, iterations_per_step, evaluations, events, events_cases,\n"
    "                 limited_impacts, limited_cases, subdivided_steps, subdivided_cases,\n"
    "                 degraded_samples, degraded_cases, ambiguous_steps, ambiguous_cases,\n"
    "                 wall_time (s, of the slowest rank), total_time (s, all ranks),\n"
    "                 cases_per_second\n"
    "    case         of a file of one case: index, outcome, failure, end_time, settle_time,\n"
    "                 fall_time, final_state {name: value}\n" SEARCH_SUMMARY_HELP,
};
