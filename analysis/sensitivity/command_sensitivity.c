/* command_sensitivity.c - `stance sensitivity FILE`: which factor of a sampled study decides. */
#include "sensitivity_study.h"

#include "analysis/draw/plot.h"

#include <stdio.h>

extern const struct command command_sensitivity; /* below */

struct request {
    struct report report;
    struct look look;
    struct sensitivity_request asked;
    int failed; /* what they count as: its word */
};

static int work(struct report *report, const struct results *r, stance_message *message)
{
    struct request *request = (struct request *)report;
    struct look *const look = &request->look;
    const bool draws = look_given(look);
    struct sensitivity_study study;
    char own[1024];
    const struct plot plot = {r, .directory = look_directory(look, r->file, own, sizeof own),
                              .stem = r->name, .look = look, .message = message};
    int code = sensitivity_study_make(&study, r, &request->asked, message);
    if (code != EXIT_DONE)
        return code;
    if (!sensitivity_print(&study, report->form) || (draws && !sensitivity_picture(&study, &plot)))
        code = EXIT_IO;
    else if (draws && !look_end(look, &command_sensitivity, r->file))
        code = EXIT_USAGE;
    sensitivity_study_free(&study);
    return code;
}

static int run(int argc, char **argv)
{
    struct request request = {
        .report = {.command = &command_sensitivity, .work = work},
        .asked = {.unit = "", .of = RESULTS_KIND_COUNT, .bootstrap = SENSITIVITY_BOOTSTRAP}};
    struct sensitivity_request *const asked = &request.asked;
    struct plot_answer answer;
    char directory[1024];
    look_begin(&request.look);
    const int code = command_begin(&command_sensitivity, argc, argv, &request);
    if (code != COMMAND_GOES_ON)
        return code;
    const bool draws = look_given(&request.look);
    asked->fallen = request.failed > 0;
    if (draws && request.report.form != TABLE_AS_TEXT)
        return command_usage(&command_sensitivity, "pictures belong to the text: --json and --csv "
                                                   "print nothing else");
    if (asked->answer && asked->fallen)
        return command_usage(&command_sensitivity, "--failed fallen has no meaning with --answer: "
                                                   "a failed case has none");
    if (asked->answer && plot_answer_find(asked->answer, &answer))
        asked->unit = answer.unit;
    return draws && !gnuplot_directory(look_directory(&request.look, request.report.files.text[0],
                                                      directory, sizeof directory))
               ? EXIT_IO
               : report_run(&request.report);
}

static const char *failed_word(size_t k)
{
    return k == 0 ? "drop" : k == 1 ? "fallen" : NULL;
}

#define TO(member) OPTION_TO(struct request, member)
static const struct option options[] = {
    {REPORT_FILE},
    {"--answer", "A", TO(asked.answer), .word = plot_answer_word,
     .text = "the response is the mean of the answer A (friction_used, settle_time ...)"},
    {"--of", "OUTCOME", TO(asked.of), .word = results_outcome_word,
     .text = "the share of, or the mean over, the cases with this outcome"},
    {"--by", "PATH", TO(asked.by), .most = SCENARIO_MAX_AXES,
     .text = "a table for each value of this grid axis, the mean over all others; repeatable; "
             "none: a single table"},
    {"--failed", TO(failed), .word = failed_word,
     .text = "drop: as said (default); fallen: failed cases count as fallen"},
    {"--resamples", "N", TO(asked.bootstrap.resamples), .low = 100, .high = 100000,
     .text = "quarters that are drawn, default 1000 (without effect on saltelli and morris)"},
    {"--level", "L", TO(asked.bootstrap.level), .low = 0.5, .high = 0.999,
     .text = "of the intervals, default 0.95"},
    {"--seed", "N", TO(asked.bootstrap.seed), .high = (double)INT64_MAX, .takes = "a whole number",
     .text = "other quarters, default 0"},
    {.text = "With an option of pictures NAME-sensitivity, too, with --answer NAME-A-sensitivity "
             "(stance plot FILE draws these as well):"},
    {.at = offsetof(struct request, look), .rows = look_options},
    {OPTION_TIME_LIMIT},
    {REPORT_CSV,
     .text = "a row for each table and factor: values of the axes kept apart, factor (its first "
             "path), estimate, _low and _high of each measure, response, failed_cases (the "
             "policy), blocks, mean, deviation (of the response)"},
    {REPORT_JSON, .keys = sensitivity_keys, .text = "the same as JSON, with the keys"},
    {0},
};

const struct command command_sensitivity = {
    "sensitivity",
    "which factor of a sampled study decides its result",
    run,
    options,
    "For files of a scenario with sweep.sample. The response of a sample point is the share of "
    "cases that were stabilised (rested, where no controller has a target) among those on the "
    "grid axes over initial.*; for each value of other grid axes there is a table of its own.\n"
    "\n"
    "  method saltelli        Sobol' indices: first (share of the response's variance that the "
    "factor alone accounts for) and total (what would be left of it were all others known), with "
    "second_order those of pairs\n"
    "  method morris          mean mu, mean magnitude mu_star and standard deviation sigma of the "
    "elementary effects: change of the response over the change of the factor, whose range counts "
    "as 1\n"
    "  random, lhs, sobol     first-order indices from bins along each factor\n"
    "\n"
    "Intervals of Sobol' indices are Student's, from the 16 independently scrambled sequences "
    "that method saltelli consists of, those of effects from groups of trajectories. Of other "
    "points quarters are drawn; for those of method sobol the interval is conservative. "
    "analysis/sensitivity/sensitivity.h states all estimators and their sources.\n"
    "\n"
    "Failed cases are left out of the response of their point. A point all of whose cases failed "
    "(with --answer: that has no case with the answer) is missing and takes its block (saltelli) "
    "or the two effects that need it (morris) out with it. Where failed cases counted as fallen "
    "would take an estimate out of its interval a warning says so. Blocks with a case that is "
    "still pending wait; how many are complete is printed.\n",
    NULL,
};
