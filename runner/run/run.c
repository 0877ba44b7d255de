/* run.c - `stance run`: from the scenario to the results, on one rank or many.
 *
 * The run is a list of stages. Every rank goes through each, then all agree on how it went: an
 * error of any rank is printed once, and all leave together with its exit code.
 */
#include "run.h"

#include "runner/base/command.h"
#include "runner/base/message.h"
#include "runner/base/numbers.h"
#include "runner/base/units.h"
#include "runner/base/words.h"
#include "runner/plan/warnings.h"

#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* An error of the scenario, with its place in the text. */
static void fail_scenario(struct run *run, const struct plan_error *error)
{
    char place[40] = "";
    if (error->line > 0)
        snprintf(place, sizeof place, ":%d:%d", error->line, error->column);
    run_fail(run, EXIT_USAGE, "%.300s%s: %s", run->scenario->file, place, error->message.text);
}

/* ---- the scenario ------------------------------------------------------------------------- */

/* Rank 0 reads the file; the others read the text that it resolved to. --extend changes the count
 * of a sample that there is. */
static void stage_scenario(struct run *run)
{
    const struct options *o = &run->options;
    const size_t sets = o->asked.sets.count;
    if (run->parallel.rank == 0) {
        struct scenario *const own = o->extend_count > 0 ? run_read_scenario(run, sets - 1) : NULL;
        if (o->extend_count == 0 || (own && run_extend_check(run, own)))
            run->scenario = run_read_scenario(run, sets);
        scenario_drop(own);
    }
    if (!run_share_scenario(run))
        return;
    if (o->trace && !o->single && run->scenario->cases > 1)
        run_fail(run, EXIT_USAGE,
                 "stance run: --trace needs --only: the scenario's cases are 0 ... %" PRIu64,
                 run->scenario->cases - 1);
    else if (o->trace && !o->single)
        run->options.single = true, run->options.single_case = 0;
    if (o->single && o->single_case >= run->scenario->cases)
        run_fail(run, EXIT_USAGE,
                 "stance run: --only %" PRIu64 ": the scenario's cases are 0 ... %" PRIu64,
                 o->single_case, run->scenario->cases - 1);
}

/* ---- the file ----------------------------------------------------------------------------- */

void run_name_file(struct run *run)
{
    const struct options *o = &run->options;
    char ending[64] = "";
    if (o->single)
        snprintf(ending, sizeof ending, "-case%" PRIu64, o->single_case);
    else if (o->extend_count > 0)
        snprintf(ending, sizeof ending, "-%" PRIu64, o->extend_count);
    else if (o->shard.count > 0)
        snprintf(ending, sizeof ending, ".shard-%" PRIu64 "-of-%" PRIu64, o->shard.number,
                 o->shard.count);
    else if (o->ending)
        snprintf(ending, sizeof ending, "%s", o->ending);
    const int length = o->output ? snprintf(run->file, sizeof run->file, "%s", o->output)
                                 : snprintf(run->file, sizeof run->file, "results/%s%s.h5",
                                            run->scenario->name, ending);
    if (length >= (int)sizeof run->file - 8)
        run_fail(run, EXIT_IO, "stance %s: the name of the file is too long", run->argv[0]);
}

/* Rank 0: where the results go, whether they may, and nobody else writes there. */
static void take_file(struct run *run)
{
    const struct options *o = &run->options;
    bool exists;

    if (!run_claim_file(run, &exists))
        return;
    if (exists || o->extend_count > 0)
        adopt_clear(run->file);
    run->resume = exists && o->resume;
    run->replace = exists && o->force;
    run_old_open(run);
}

static void stage_claim(struct run *run)
{
    run_name_file(run);
    if (run->parallel.rank == 0 && !run->options.dry_run && run->failure.code == EXIT_DONE)
        take_file(run);
    parallel_broadcast(&run->parallel, &run->resume, sizeof run->resume);
    parallel_broadcast(&run->parallel, &run->succeed, sizeof run->succeed);
}

/* ---- the plan ----------------------------------------------------------------------------- */

/* While designs are computed: whether any rank is to stop. */
static bool out_of_time(void *context)
{
    struct run *run = context;
    const double now = clock_seconds();
    bool stop = work_stop_asked() || now - run->start > run->options.time_limit;

    if (run->parallel.rank == 0 && run->heartbeat.lock)
        stop = !heartbeat_beat(&run->heartbeat, now, 0, 0, &run->message) || stop;
    if (stop || run->parallel.rank == 0 || now >= run->look_at) {
        run->look_at = now + schedule_look_interval(run->parallel.size);
        stop = parallel_add(&run->parallel, COUNTER_STOP, stop) != 0 || stop;
        parallel_beat(&run->parallel, ++run->work.beats);
    }
    if (run->parallel.rank == 0 && progress_due(&run->progress, now))
        progress_say(&run->progress, "%s, %.0f s", run->heartbeat.doing,
                     floor(now - run->progress.from));
    if (run->message.text[0])
        run_fail_io(run);
    return stop;
}

static void stage_plan(struct run *run)
{
    struct plan_error error = {0};
    const struct options *o = &run->options;

    /* Points of logarithmic axes and of samples come from libraries and may differ between
     * machines: every rank takes those of rank 0, which has them from the file when the run is
     * resumed. */
    for (int a = 0; a < run->scenario->axes; a++) {
        struct scenario_axis *axis = &run->scenario->axis[a];
        if (axis->log || axis->sample)
            parallel_broadcast(&run->parallel, axis->value,
                               axis->count * (size_t)axis->paths * sizeof *axis->value);
    }
    parallel_share(&run->parallel);
    if (!plan_make(&run->plan, run->scenario, o->single, o->single_case, o->trace, &error) ||
        (o->shard.count > 0 && !plan_cut(&run->plan, &o->shard, &error)))
        fail_scenario(run, &error);
    run->plan.ancestors = run->old.origin.ancestors + run->succeed;
    parallel_broadcast(&run->parallel, &run->plan.ancestors, sizeof run->plan.ancestors);
    run->plan.stop = out_of_time;
    run->plan.stop_context = run;
}

void run_stop_early(struct run *run, const char *what)
{
    if (run->failure.code == EXIT_DONE) {
        run->failure.code = EXIT_INTERRUPTED;
        run_say_stopped(run, what);
    }
}

/* Whether the file is made of rows of the old one. */
static bool takes_rows(const struct run *run)
{
    return run->succeed || (run->options.extend_count > 0 && !run->resume);
}

/* Those of the old file; every rank is told which and what they are. */
static bool take_designs(struct run *run)
{
    struct plan *plan = &run->plan;
    bool good = true;

    if (!takes_rows(run) || run->options.dry_run)
        return true;
    if (run->parallel.rank == 0)
        good = run_old_designs(run);
    parallel_broadcast(&run->parallel, &good, sizeof good);
    parallel_broadcast(&run->parallel, plan->design,
                       plan->designs * plan->design_size * sizeof *plan->design);
    parallel_broadcast(&run->parallel, plan->design_status, plan->designs);
    return good;
}

static void stage_designs(struct run *run)
{
    struct plan_error error = {0};
    bool good = true;

    if (run->resume && !run->succeed)
        return; /* they are in the file */
    if (!take_designs(run))
        return;
    run->plan.patience = run->options.dry_run ? PLAN_PATIENCE_DESIGNS : 0;
    good = plan_compute_designs(&run->plan, &run->parallel, &error);
    if (!good && !error.message.text[0]) {
        run_stop_early(run, "stopped while designs were computed: nothing is stored");
        return;
    }
    if (good && run->parallel.rank == 0)
        good = plan_check_cases(&run->plan, &error);
    if (!good)
        fail_scenario(run, &error);
    else if (run->options.dry_run && run->parallel.rank == 0)
        report_plan(&run->plan, run->parallel.size, run->file, false, "stance run");
    if (good && run->parallel.rank == 0 && !run->resume)
        run->warned = warnings_print(&run->plan, "stance run");
    run->over = run->options.dry_run;
}

/* Of a scene that is described, compiled for it. */
static void stage_kernels(struct run *run)
{
    stance_message message;
    run->progress.quiet = true; /* a compiler has a word of its own */
    if (run->options.dry_run || run->kernels.count > 0)
        return;
    if (run->resume && !run->store) /* later: they are tried on cases, whose designs are there */
        return;
    const struct kernels_choice choice = {.quiet = run->options.quiet, .later = true};
    const enum exit_code code =
        kernels_take(&run->kernels, &run->plan, &choice, &run->parallel, &message);
    if (code == EXIT_INTERRUPTED)
        run_stop_early(run, run->resume ? "stopped while kernels were compiled"
                                        : "stopped while kernels were compiled: nothing is stored");
    else if (code != EXIT_DONE)
        run_fail(run, code, "stance run: %s", message.text);
}

/* ---- computing ---------------------------------------------------------------------------- */

/* Names of the ranks' machines, each once, separated by commas; on rank 0. */
static char *collect_hosts(const struct parallel *parallel)
{
    enum { NAME = 64 };
    char name[NAME];
    size_t ranks = (size_t)parallel->size, used = 0;
    char *list = parallel->rank == 0 ? calloc(ranks, NAME + 1) : NULL;

    parallel_host(name, sizeof name);
    char *all = parallel_gather(parallel, name, NAME);
    if (all && !list)
        abort(); /* the others wait: MPI ends the job */
    for (size_t r = 0; all && r < ranks; r++) {
        bool known = false;
        for (size_t q = 0; q < r && !known; q++)
            known = strcmp(all + q * NAME, all + r * NAME) == 0;
        if (!known)
            used += (size_t)sprintf(list + used, "%s%s", used ? "," : "", all + r * NAME);
    }
    free(all);
    return list;
}

static void stage_create(struct run *run)
{
    if (run->resume && !run->succeed)
        return;
    char *hosts = collect_hosts(&run->parallel);
    if (run->parallel.rank == 0) {
        if (run->replace && !takes_rows(run) && unlink(run->file) != 0)
            run_fail(run, EXIT_IO, "stance run: cannot replace %.150s: %s", run->file,
                     strerror(errno));
        else if (takes_rows(run))
            run_old_rows(run, hosts);
        else if (!store_create(run->file, &run->plan, NULL, run->parallel.size, hosts,
                               &run->message))
            run_fail_io(run);
    }
    free(hosts);
}

static void stage_open(struct run *run)
{
    if (run->parallel.rank == 0)
        heartbeat_guard(&run->heartbeat, run->file);
    if (!store_open(&run->store, run->file, &run->plan, &run->parallel, &run->message) ||
        !store_read_designs(run->store, &run->plan, &run->message))
        run_fail_io(run);
}

static void stage_compute(struct run *run)
{
    run->work = (struct work){
        .plan = &run->plan,
        .parallel = &run->parallel,
        .kernels = &run->kernels,
        .heartbeat = run->parallel.rank == 0 ? &run->heartbeat : NULL,
        .beats = run->work.beats,
        .store = run->store,
        .resume = run->resume || run->options.extend_count > 0,
        .quiet = run->options.quiet,
        .start = run->start,
        .time_limit = run->options.time_limit,
    };
    const bool refined = run->scenario->refine.given && !run->plan.single;
    const struct rows share = plan_share(&run->plan);
    if (refined ? !refinement_run(&run->work, &run->message)
                : !work_run(&run->work, &share, NULL, &run->message))
        run_fail_io(run);
}

/* Rank 0 stores how long each rank computed. */
static void stage_timing(struct run *run)
{
    const double computed = (double)run->work.sums.computed;
    double *seconds = parallel_gather(&run->parallel, &run->work.seconds, sizeof *seconds);
    double *cases = parallel_gather(&run->parallel, &computed, sizeof computed);
    if (run->parallel.rank == 0 &&
        !store_add_timing(run->store, run->parallel.size, seconds, cases, &run->message))
        run_fail_io(run);
    free(seconds);
    free(cases);
}

static void stage_close(struct run *run)
{
    struct store *store = run->store;

    run->store = NULL;
    if (!store_close(store, &run->message) ||
        (run->parallel.rank == 0 && !store_bring(run->file, false, &run->message)))
        run_fail_io(run);
}

/* ---- the end ------------------------------------------------------------------------------- */

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

static int conclude(struct run *run)
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

/* ---- the whole ----------------------------------------------------------------------------- */

int run_all(struct run *run, int argc, char **argv, void (*stage_options)(struct run *))
{
    const struct stage stages[] = {
        {stage_options, "reading its options"},
        {stage_scenario, "reading the scenario"},
        {stage_claim, "looking into the results file"},
        {stage_plan, "making the plan"},
        {stage_designs, "computing designs"},
        {stage_kernels, "compiling kernels"},
        {stage_create, "creating the results file"},
        {stage_open, "opening the results file"},
        {stage_kernels, "compiling kernels"}, /* where they were to wait for the designs */
        {stage_compute, "computing"},
        {stage_timing, "storing times"},
        {stage_close, "closing the results file"},
        {NULL, NULL},
    };
    return run_through(run, argc, argv, stages, conclude);
}

void run_drop(struct run *run)
{
    store_abandon(run->store);
    kernels_give_back(&run->kernels);
    plan_free(&run->plan);
    adopt_close(&run->old);
    store_origin_free(&run->old.origin);
    run_end(run);
}

int run_run(int argc, char **argv)
{
    struct run *run = calloc(1, sizeof *run);
    const int code = run_all(run, argc, argv, run_stage_options);
    if (run)
        run_drop(run);
    free(run);
    return code;
}
