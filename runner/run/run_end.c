/* run_end.c - what `stance run` says at its end: what came out, what was damaged, how to go on. */
#include "run.h"

#include "runner/base/command.h"
#include "runner/base/numbers.h"
#include "runner/base/units.h"
#include "runner/base/words.h"
#include "runner/plan/warnings.h"

#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void print_summary(const struct run *run, const struct work_sums *sums)
{
    double wall = clock_seconds() - run->start;
    const char *separator = ": ";

    printf("%s: %" PRIu64 " case%s", run->file, sums->finished, sums->finished == 1 ? "" : "s");
    for (int i = 0; i < STANCE_OUTCOME_COUNT; i++) {
        if (sums->outcome[i] > 0) {
            printf("%s%" PRIu64 " %s", separator, sums->outcome[i],
                   i == STANCE_NONE ? "without outcome" : stance_outcome_name[i]);
            separator = ", ";
        }
    }
    if (sums->failed > 0)
        printf("%s%" PRIu64 " failed", separator, sums->failed);
    if (sums->inferred > 0)
        printf("; %" PRIu64 " of them inferred", sums->inferred);
    if (sums->computed + sums->inferred < sums->finished)
        printf("; %" PRIu64 " of them computed now", sums->computed);
    printf("; %.1f s on %d rank%s\n", wall, run->parallel.size, run->parallel.size == 1 ? "" : "s");
    fflush(stdout);
}

/* Collective: how many cases did not verify, and the first of them. */
static void say_damaged(const struct run *run, uint64_t damaged)
{
    uint64_t mine[WORK_NAMED];
    const size_t ranks = (size_t)run->parallel.size;
    for (uint64_t k = 0; k < WORK_NAMED; k++)
        mine[k] = ~run->work.damaged_case[k];
    uint64_t *const all = parallel_gather(&run->parallel, mine, sizeof mine);
    if (all) {
        const uint64_t named = damaged < WORK_NAMED ? damaged : WORK_NAMED;
        char list[WORK_NAMED * 24] = "";
        numbers_unite(all, ranks * WORK_NAMED);
        for (uint64_t k = 0; k < named; k++)
            words_add(list, sizeof list, "%s%" PRIu64, k ? ", " : "", all[k]);
        fprintf(stderr,
                "stance run: warning: %.200s: %" PRIu64 " case%s marked done did not verify and "
                "%s computed again: %s%s\n",
                run->file, damaged, damaged == 1 ? "" : "s", damaged == 1 ? "is" : "are", list,
                named < damaged ? ", ..." : "");
    }
    free(all);
}

int run_conclude(struct run *run)
{
    char stopped[80];
    struct work_sums sums = run->work.sums;
    parallel_sum(&run->parallel, (uint64_t *)&sums, sizeof sums / sizeof(uint64_t));
    const uint64_t share = plan_share(&run->plan).count;
    const bool complete = sums.finished == share;

    if (sums.damaged > 0)
        say_damaged(run, sums.damaged);
    if (run->parallel.rank == 0) {
        if (!run->options.quiet)
            print_summary(run, &sums);
        if (!complete) {
            snprintf(stopped, sizeof stopped, "stopped at %" PRIu64 " of %" PRIu64 " cases",
                     sums.finished, share);
            run_say_stopped(run, stopped);
        } else if (sums.failed > 0) {
            fprintf(stderr,
                    "stance run: %" PRIu64
                    " case%s failed; the variable `failure` in %s says why\n",
                    sums.failed, sums.failed == 1 ? "" : "s", run->file);
        }
        if (complete && !run->warned && !run->plan.single)
            warnings_of_ends(run->scenario, sums.outcome, sums.finished, false, "stance run");
    }
    return !complete ? EXIT_INTERRUPTED : sums.failed > 0 ? EXIT_CASES_FAILED : EXIT_DONE;
}
