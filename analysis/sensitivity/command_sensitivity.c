/* command_sensitivity.c - `stance sensitivity FILE`: which factor of a sampled study decides. */
#include "sensitivity_study.h"

#include "analysis/draw/plot.h"
#include "analysis/table/report.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

extern const struct command command_sensitivity; /* below */

enum { MOST_BY = SCENARIO_MAX_AXES };

struct asked {
    bool draws;
    struct look look;
    struct sensitivity_request request;
};

static bool bad_use(const char *text, const char *word)
{
    fprintf(stderr, "stance sensitivity: %s '%.60s' (stance sensitivity -h explains)\n", text,
            word);
    return false;
}

/* ---- options ------------------------------------------------------------------------------ */

static bool read_answer(const char *name, struct sensitivity_request *request)
{
    struct plot_answer answer;
    if (!plot_answer_find(&command_sensitivity, name, &answer))
        return false;
    request->answer = answer.name;
    request->unit = answer.unit;
    return true;
}

static bool read_failed(const char *word, struct sensitivity_request *request)
{
    request->fallen = strcmp(word, "fallen") == 0;
    return request->fallen || strcmp(word, "drop") == 0 ||
           bad_use("--failed takes drop or fallen, not", word);
}

static bool read_seed(const char *text, struct sensitivity_request *request)
{
    char *end;
    errno = 0;
    const unsigned long long seed = strtoull(text, &end, 10);
    request->bootstrap.seed = seed;
    return (text[0] >= '0' && text[0] <= '9' && !*end && errno == 0 && seed <= INT64_MAX) ||
           bad_use("--seed takes a whole number, not", text);
}

/* ---- the work ----------------------------------------------------------------------------- */

static bool draw(struct look *look, const struct sensitivity_study *study, stance_message *message)
{
    const char *answer = study->request.answer;
    char stem[400], own[1024];
    snprintf(stem, sizeof stem, "%.300s%s%s-sensitivity", study->r->name, answer ? "-" : "",
             answer ? answer : "");
    return sensitivity_picture(study, look, look_directory(look, study->r->file, own, sizeof own),
                               stem, message);
}

static int work(struct report *report, const struct results *r, stance_message *message)
{
    struct asked *asked = report->request;
    struct sensitivity_study study;
    int code = sensitivity_study_make(&study, r, &asked->request, message);
    if (code == EXIT_DONE) {
        if (!sensitivity_print(&study, report->form) ||
            (asked->draws && !draw(&asked->look, &study, message)))
            code = EXIT_IO;
        else if (asked->draws && !look_end(&asked->look, &command_sensitivity, r->file))
            code = EXIT_USAGE;
        sensitivity_study_free(&study);
    }
    return code;
}

static int run(int argc, char **argv)
{
    const char *answer = NULL, *of = NULL, *resamples = NULL, *level = NULL, *seed = NULL;
    const char *failed = "drop", *by[MOST_BY];
    struct look_options options = {0};
    char directory[1024];
    size_t given[6] = {0};
    int code;
    struct asked asked = {
        .request = {
            .unit = "", .of = RESULTS_KIND_COUNT, .by = by, .bootstrap = SENSITIVITY_BOOTSTRAP}};
    struct sensitivity_request *request = &asked.request;
    double drawn = (double)request->bootstrap.resamples;
    struct report report = {.command = &command_sensitivity, .work = work, .request = &asked};
    const struct option_spec specs[] = {
        {"--answer", true, &answer, 1, &given[0]},
        {"--of", true, &of, 1, &given[1]},
        {"--by", true, by, MOST_BY, &request->by_count},
        {"--resamples", true, &resamples, 1, &given[2]},
        {"--level", true, &level, 1, &given[3]},
        {"--seed", true, &seed, 1, &given[4]},
        {"--failed", true, &failed, 1, &given[5]},
        LOOK_SPECS(options),
    };
    if (!report_options(&report, argc, argv, specs, sizeof specs / sizeof specs[0], &code))
        return code;
    asked.draws = look_given(&options);
    if (asked.draws && !look_read(&command_sensitivity, &options, &asked.look))
        return EXIT_USAGE;
    const char *wrong = asked.draws && report.form != TABLE_AS_TEXT
                            ? "pictures belong to the text: --json and --csv print nothing else"
                        : answer && strcmp(failed, "fallen") == 0
                            ? "--failed fallen has no meaning with --answer: a failed case has none"
                            : NULL;
    if (wrong) {
        fprintf(stderr, "stance sensitivity: %s (stance sensitivity -h explains)\n", wrong);
        return EXIT_USAGE;
    }
    if (!((!answer || read_answer(answer, request)) && report_outcome(&report, of, &request->of) &&
          read_failed(failed, request) &&
          report_number(&report, "--resamples", resamples, 100, 100000, true, &drawn) &&
          report_number(&report, "--level", level, 0.5, 0.999, false, &request->bootstrap.level) &&
          (!seed || read_seed(seed, request))))
        return EXIT_USAGE;
    request->bootstrap.resamples = (size_t)drawn;
    return asked.draws && !gnuplot_directory(
                              look_directory(&asked.look, report.file, directory, sizeof directory))
               ? EXIT_IO
               : report_run(&report);
}

const struct command command_sensitivity = {
    "sensitivity",
    "sensitivity FILE [--answer A] [--of OUTCOME] [--by PATH]... [--failed drop|fallen]\n"
    "           [--resamples N] [--level L] [--seed N] [--time-limit TIME]\n"
    "           [--json | --csv | -o PLACE] [--format F,...] [--for column|page]\n"
    "           [--labels NAME=TEXT]... ...",
    "which factor of a sampled study decides its result",
    run,
    "For files of a scenario with sweep.sample. The response of a sample point is the share of\n"
    "cases that were stabilised (rested, where no controller has a target) among those on the "
    "grid\n"
    "axes over initial.*; for each value of other grid axes there is a table of its own.\n"
    "\n"
    "  method saltelli        Sobol' indices: first (share of the response's variance that the\n"
    "                         factor alone accounts for) and total (what would be left of it were\n"
    "                         all others known), with second_order those of pairs\n"
    "  method morris          mean mu, mean magnitude mu_star and standard deviation sigma of the\n"
    "                         elementary effects: change of the response over the change of the\n"
    "                         factor, whose range counts as 1\n"
    "  random, lhs, sobol     first-order indices from bins along each factor\n"
    "\n"
    "Intervals of Sobol' indices are Student's, from the 16 independently scrambled sequences\n"
    "that method saltelli consists of, those of effects from groups of trajectories. Of other\n"
    "points quarters are drawn; for those of method sobol the interval is conservative.\n"
    "analysis/sensitivity/sensitivity.h states all estimators and their sources.\n"
    "\n"
    "Failed cases are left out of the response of their point. A point all of whose cases failed\n"
    "(with --answer: that has no case with the answer) is missing and takes its block (saltelli)\n"
    "or the two effects that need it (morris) out with it. Where failed cases counted as fallen\n"
    "would take an estimate out of its interval a warning says so. Blocks with a case that is\n"
    "still pending wait; how many are complete is printed.\n"
    "\n"
    "  --answer A      the response is the mean of the answer A (friction_used, settle_time ...)\n"
    "  --of OUTCOME    the share of, or the mean over, the cases with this outcome\n"
    "  --by PATH       a table for each value of this grid axis, the mean over all others;\n"
    "                  repeatable; none: a single table\n"
    "  --failed P      drop: as said (default); fallen: failed cases count as fallen\n"
    "  --resamples N   quarters that are drawn, default 1000; --seed N: other ones, default 0\n"
    "                  (both without effect on saltelli and morris)\n"
    "  --level L       of the intervals, default 0.95\n"
    "With an option of pictures NAME-sensitivity, too, with --answer NAME-A-sensitivity (stance "
    "plot\n"
    "FILE draws these as well):\n"
    "\n" LOOK_HELP "\n"
    "  --time-limit TIME  end after 90s, 55m, 1h30m ... of wall time, with exit code 4\n"
    "  --csv           a row for each table and factor: values of the axes kept apart, factor "
    "(its\n"
    "                  first path), estimate, _low and _high of each measure, response,\n"
    "                  failed_cases (the policy), blocks, mean, deviation (of the response)\n"
    "  --json          keys\n"
    "    file, title, method, count, block (points in one), response, answer, of, unit,\n"
    "    over         grid axes that the response is a mean over\n"
    "    failed_cases drop or fallen; level; resamples, seed: null for saltelli, morris\n"
    "    tables       [{at: {path: value}, cases, failed, pending, blocks, used, incomplete, lost\n"
    "                 (morris: lost_effects), mean, deviation, policies_differ,\n"
    "                 factors: [{path, paths, first, total | mu, mu_star, sigma}], most important\n"
    "                 first, first_sum, pairs: [{paths, estimate, low, high}]}];\n"
    "                 a measure is {estimate, low, high}, null where it cannot be had\n",
};
