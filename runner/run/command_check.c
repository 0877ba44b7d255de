/* command_check.c - `stance check`: is the scenario sound, and what would running it take? */
#include "run.h"

#include "runner/plan/warnings.h"

#include <stdio.h>

extern const struct command command_check; /* below */

struct request {
    struct asked asked;
    bool json;
};

static int check(const struct scenario *s, void *request)
{
    const bool json = ((const struct request *)request)->json;
    struct parallel alone = parallel_alone();
    struct plan plan;
    struct plan_error error = {0};
    char file[sizeof s->name + 16];
    int code = EXIT_DONE;

    if (!plan_make(&plan, s, false, 0, false, &error))
        return plan_error_print(s, &error);
    plan.patience = PLAN_PATIENCE_DESIGNS;
    bool good = plan_compute_designs(&plan, &alone, &error);
    if (good && !plan_check_cases(&plan, &error)) {
        good = s->search.given;
        if (good)
            fprintf(stderr, "stance check: warning: %s: to a search such starts are lost\n",
                    error.message.text);
    }
    if (good) {
        snprintf(file, sizeof file, "results/%s.h5", s->name);
        report_plan(&plan, 1, file, json, "stance check");
        if (!warnings_print(&plan, "stance check") && !s->search.given && plan_simulates(&plan))
            warnings_try(&plan, "stance check");
    } else {
        code = plan_error_print(s, &error);
    }
    plan_free(&plan);
    return code;
}

static int run_check(int argc, char **argv)
{
    struct request request = {.json = false};
    return asked_run(&command_check, argc, argv, check, &request);
}

static const struct option options[] = {
    {.rows = asked_options},
    {OPTION_JSON(struct request, json)},
    {0},
};

const struct command command_check = {
    "check",
    "validate a scenario; print cases, cost and file size; touch nothing",
    run_check,
    options,
    "Reads the scenario, computes the controller designs, tries the initial states of the corners "
    "of the sweep and of up to 4096 other cases, and runs a few cases for a moment to estimate "
    "the cost. It returns within seconds: of very many designs those of the corners and others, "
    "evenly spread, are computed for 1.5 s, and what is left unchecked is said (`run` computes "
    "all of them). Each error is one line, FILE:LINE:COLUMN: message.\n"
    "\n"
    "A file beyond 100 GB or what is free, and months of work, are warned of, too.",
    "    scenario, title, scene    strings\n"
    "    cases                     number of cases\n"
    "    dimensions                list of {name, count}\n"
    "    designs, designs_computed, designs_failed   distinct controller designs; those that\n"
    "                              were computed; those of these that do not exist\n"
    "    recorded_cases            cases whose trajectories would be recorded\n"
    "    file, file_bytes          where the results would go, and their size\n"
    "    ranks                     1\n"
    "    seconds_on_one_rank       estimate; null when no case could be tried, or for too short a "
    "time to tell\n"
    "    seconds_is_upper_bound    some cases took too long to try to their ends: it is a bound\n"
    "    compile_seconds           that run needs first, roughly, for kernels that it compiles; "
    "0: none, or they are in the cache, where nothing is touched. Without them "
    "seconds_on_one_rank is reckoned from those that are built in\n"
    "    refine                    null, or with sweep.refine {coarse_cases, probes (expected), "
    "most_cases}: seconds_on_one_rank is then for all of them\n"
    "    law                       null, or {file, sha256, trusted} of controller.file: what it "
    "says "
    "is C code that `run` runs in its own process\n",
};
