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

struct request {
    struct report report;
};

static int run(int argc, char **argv)
{
    struct request request = {
        {.command = &command_summary, .work = summarise, .search = search_summarise}};
    const int code = command_begin(&command_summary, argc, argv, &request);
    return code == COMMAND_GOES_ON ? report_run(&request.report) : code;
}

static const struct option options[] = {
    {"FILE...", OPTION_TO(struct request, report.files), .low = 1, .high = REPORT_FILES,
     .text = "a results file"},
    {REPORT_CSV,
     .text = "the counts of all cases, then a row for every value of every parameter: parameter, "
             "value, done, failed, pending, stabilised, rested, fell, undecided, and the share of "
             "stabilised cases (without a controller that has a target: rested ones) with its "
             "interval low ... high (of a grid empty); `stance table` has the cases themselves"},
    {REPORT_JSON, .text = "the same as JSON; what does not apply is left out or null. Keys"},
    {0},
};

const struct command command_summary = {
    "summary",
    "what came out: outcomes, extent of the stabilised set, extremes, cost",
    run,
    options,
    "Works on files that are not finished, too. Shares are of the cases that are done. Those of a "
    "grid have no intervals: its cases are no draws, and how much of the space between them has "
    "an outcome `stance basin` says. With sweep.sample shares have 95 % intervals of the sample: "
    "what scatters are its points (of saltelli and morris blocks), not the cases that each has on "
    "grid axes. An extent is the unbroken stretch of stabilised cases through the equilibrium "
    "along one axis of offsets, on the line where the other offsets are nearest to zero; it ends "
    "midway between the last stabilised case and the next one.\n",
    "    file, title, version, revision, date, ranks\n"
    "    scenarios    [{date, done}] of a file that went on with another scenario, the first one "
    "first: since when, cases done with it\n"
    "    axes         [{path, unit, long_name, count, first, last}]\n"
    "    fixed        {path: value} of the fields that do not vary\n"
    "    cases        total, done, failed, pending; inferred: done, but not simulated (refined "
    "map); damaged: pending, because their checksums do not fit\n"
    "    failures     {reason: count}\n"
    "    outcomes     {name: {count, share, low, high}} of the cases done\n"
    "    cut          [{path, end: lower or upper, at}]: faces of the box of starts on which "
    "cases of the kind judged by lie, so that their share is the box's\n"
    "    fall_causes  {point or body: count} of those that fell\n"
    "    extents      [{path, unit, outcome, stabilised, low, high, low_at_end, high_at_end, "
    "low_unknown, high_unknown, at: {path: value}}]; outcome of the case nearest to the "
    "equilibrium; where that is pending or failed stabilised is null\n"
    "    parameters   [{path, unit, share_of, values: [{value, done, failed, pending, stabilised, "
    "rested, fell, undecided, share, low, high, extents: {path: [low, high]}}], steepest: {from, "
    "to}}]; share_of: stabilised, or without a controller that has a target rested; an extent is "
    "[] for none, null for unknown\n"
    "    pairs        of two parameters, no more: {paths: [2], share: [[...]]}, a row for each "
    "value of the first, a column for each of the second; null where none done\n"
    "    changes      [{from, to, before, after}] along the axis of a sweep with one axis\n"
    "    sample       null, or of sweep.sample {method, points, share_of, varied, rays}: varied "
    "[{path, unit, factor, parts: [{from, to, done, share, low, high}]}], parts of equally many "
    "points or one for each value; rays, beside one axis of offsets, null or {path, points, "
    "smallest, median, largest, nearest, at, reach_end, none, unknown}: where the stabilised set "
    "ends along it; `at` the values at the point of the smallest, offsets times the scale\n"
    "    numbers      {answer: {of, unit, count, smallest, median, q90, q99, largest}}\n"
    "    through_ground  {cases, judged}: in which a contact that ground.contacts leaves out\n"
    "                 went through the ground; of these those of the kind judged by\n"
    "    cost         steps, iterations, iterations_per_step, evaluations, events, events_cases, "
    "limited_impacts, limited_cases, subdivided_steps, subdivided_cases, degraded_samples, "
    "degraded_cases, ambiguous_steps, ambiguous_cases, wall_time (s, of the slowest rank), "
    "total_time (s, all ranks), cases_per_second\n"
    "    case         of a file of one case: index, outcome, failure, end_time, settle_time, "
    "fall_time, final_state {name: value}\n" SEARCH_SUMMARY_HELP,
};
