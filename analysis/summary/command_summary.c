/* command_summary.c - `stance summary FILE`: what came out, as text, JSON or CSV. */
#include "summary.h"

#include "analysis/optimise/search_study.h"
#include "analysis/statistics/statistics.h"
#include "analysis/table/report.h"

#include <stdlib.h>

extern const struct command command_summary; /* below */

static const char text[] =
    "{.name}\n{file}: [case:case {index}|{cases/total} case{cases/total#s}]"
    "[.shard:, of which shard {number}/{count} has {rows}], stance {version} ({revision}), {date}, "
    "{ranks} rank{ranks#s}\n"
    "[scenarios:\nMade from {.scenarios} scenarios; what is said below of their keys is of the "
    "last one\n[scenarios*:  since {date%-22s}{done%12d} cases done\n]]"
    "[axes:\nVaried\n[axes*:  {path%-*s}  {.range}\n[.varied*:  {path%-*s}  {range}\n]]]"
    "[.fixed:\nFixed{.fixed}\n]"
    /* of a single case, or of many */
    "[case:\nOutcome: [outcome=pending:not computed yet|{outcome}]\n"
    "[.failures*:  {reason}: {text}\n][.step:  in the step from {.step} s\n]"
    "[.touching:  touching     {.touching}\n]"
    "[.done:[.times*:  {what%-12s} {time} s\n][.fallen*:  fell by      {cause}\n]"
    "[.final_state:  final state  {.final_state}\n]"
    "\nNumbers\n[.single*:  {answer%-18s} {is}[unit: {unit}]\n]]|"
    "\nOutcomes of the {cases/done} case{cases/done#s} done[.sampled:, with 95 % intervals]\n"
    "[.outcomes:{.outcomes}"
    "[.shared:  (intervals, here and below: of the sample alone, whose points count however many "
    "cases\n  each has)\n]"
    "[.one:  (of the grid; one case is {.one%.2g} %)\n]"
    "[cut:  {.judged} set cut by the box at {.cut}:\n  its share is the box's (stance basin has "
    "what does not depend on it)\n"
    "|[.uncut:  {.judged} set {.uncut} by the box: no start on its faces is in it\n]]"
    "|  not stored in this file\n]"
    "[.whole=domain:  the ranges end within the domain: stance ranges SCENARIO finds how far it "
    "goes\n]"
    "[.whole=none:  the ranges do not meet a domain: stance ranges SCENARIO finds where one is\n]"
    "[.fallen*:  fell by {count%16d}  {share*%7.3f} %   {cause}\n]"
    "[cases/inferred:  of these {cases/inferred%14d}  {.inferred*%7.3f} %   not simulated: "
    "inferred from neighbours that agree\n]"
    "[cases/pending:  pending    {cases/pending%12d}  not computed yet[.shards>1:, or of other "
    "shards]\n]"
    "[.failures*:  failed     {count%12d}  {reason}: {text}\n]"
    "[cases/failed:  the first is case {.first_failed}: `stance run SCENARIO --only "
    "{.first_failed} --trace`, and `stance summary` of that says\n  when it failed and what "
    "touched\n]"
    "[extents:\nExtent of the stabilised set through the equilibrium\n"
    "[extents*:  {path}  [stabilised:{low}{.low} ... {high}{.high} {unit}"
    "|[low_unknown:unknown|none]: the case nearest to the equilibrium ({.nearest}) "
    "[outcome=pending:is not computed yet|[outcome=failed:failed|is not stabilised]]]"
    "[.at:, at {.at}]\n]]"
    "[parameters*:\n{.Judged} against {path}"
    "[.same:: {.share*%.3f} % at each of its {.count} values\n"
    "|[unit: ({unit})][.text:: {.text}]\n{.values}"
    "[.extents:  (the last columns: extent of the stabilised set through the equilibrium; * where "
    "it reaches\n  the end of the axis, ? where the next case is pending or failed)\n]"
    "[.changes:  changes most between {steepest/.from} ({.share*%.3f} %) and {steepest/.to} "
    "({.next*%.3f} %)\n]]]"
    "[pairs:[.table:\n{.Judged} (%) against {.down} and, across, {.across}\n{.table}]]"
    "[sample:[rays:\nWhere the stabilised set through the equilibrium ends along {path}\n"
    "[points:  smallest {smallest}, median {median}, largest {largest} {.unit}[.unit: ]of {points} "
    "points[reach_end:, of which {reach_end} reach[reach_end=1:es] the end of the axis]\n"
    "  the smallest at point {nearest}:{.at}\n]"
    "[none:  none at {none} points, where the case nearest to the equilibrium is not stabilised\n]"
    "[unknown:  unknown at {unknown} points, where cases are pending or failed\n]]"
    "\n{.Judged} against what the sample varies, in parts of equally many points\n{.parts}"
    "[.dependent:  (intervals: cases of a point are not independent; what scatters are points)\n]]"
    "[.changes:\nThe outcome changes\n"
    "[.changes*:  between {.from} ({before}) and {.to} ({after})\n]"
    "[.more:  and at {.more} more places\n]]"
    "[.numbers:\n{.numbers}]"
    "]"
    "[through_ground:[cases:\nThrough the ground, with a contact that ground.contacts leaves out: "
    "{cases} case{cases#s}, of which {judged} {.judged}\n]]"
    "[.residuals:\nLargest residuals: [.residuals*, :{law} {largest%.3g}[unit: {unit}]]\n]"
    "\nCost\n[cost:[.steps:  {steps%.6g} time steps"
    "[iterations_per_step:, {iterations_per_step%.4g} Newton iterations per step]"
    "[.evaluations:, {.evaluations%.4g} evaluations per step]\n]"
    "[.counts*:  {text}: {sum%.6g}, in {cases} of the cases\n]"
    "[.timed:  {wall_time%.4g} s of computing on {.ranks} rank{.ranks#s} ({total_time%.4g} s "
    "together): {cases_per_second%.4g} cases/s\n|  no times are recorded\n]]";

static bool collect(struct summary *summary, struct table *csv)
{
    const bool single = summary->r->single;
    if (!summary_head(summary) || !summary_fields(summary) || !summary_outcomes(summary))
        return false;
    TABLE_FACTS(csv, {{.name = "parameter"}, as_nothing(NULL)},
                {{.name = "value"}, as_nothing(NULL)});
    summary_add_counts(csv, summary, &summary->counts, &summary->share);
    table_end_row(csv);
    return (single ? summary_case(summary) : summary_sweep(summary, csv)) &&
           summary_numbers(summary) && summary_cost(summary);
}

static int summarise(struct report *report, const struct results *r, stance_message *message)
{
    struct table csv = {0};
    struct summary summary = {
        .r = r, .judged = summary_judged(r), .facts = json_object(), .message = message};
    statistics_count(r, -1, 0, &summary.counts);
    summary.known =
        summary.counts.done == 0 || summary.counts.kind[RESULTS_DONE] < summary.counts.done;
    bool good = collect(&summary, &csv);
    if (good)
        good = table_say(report->form, json_incref(summary.facts), text, &csv);
    table_free(&csv);
    json_decref(summary.facts);
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
     .text =
         "the counts of all cases, then a row for every value of every parameter: parameter, "
         "value, done, failed, pending, stabilised, walks, rested, fell, undecided, and the share "
         "of "
         "stabilised cases (with stop.walks those that walk, else without a controller that has a "
         "target rested ones) with its interval low ... high (of a grid empty); `stance table` has "
         "the cases themselves"},
    {REPORT_JSON, .keys = search_keys,
     .text = "the same as JSON; what does not apply is left out or null. Keys"},
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
    "walks, rested, fell, undecided, share, low, high, extents: {path: [low, high]}}], steepest: "
    "{from, to}}]; share_of: stabilised, with stop.walks walks, else without a controller that has "
    "a target rested; an extent is [] for none, null for unknown\n"
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
    "fall_time, final_state {name: value}\n"
    "\n"
    "Of the file of a search (stance optimise): what was varied and maximised, its stages; the "
    "first, the best and the means from fresh starts, with 95 % intervals and the gap to the "
    "starts by which they were chosen; circumstances, and what the chosen one costs elsewhere; "
    "its gains, as a scenario takes them, poles and critical sample time. A search that is not "
    "finished tells how far it is. Of several searches of a scenario, up to 12, the front: a row "
    "for each against the number that differs, of several the one with most values (stance plot "
    "draws it). --csv has a row for each candidate that was tried from fresh starts, or search; "
    "--json\n",
};
