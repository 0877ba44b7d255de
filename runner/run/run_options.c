/* run_options.c - the options of `stance run`. */
#include "run.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static bool usage(const char *text)
{
    return command_usage(&command_run, text) == EXIT_DONE;
}

/* ---- shards --------------------------------------------------------------------------------- */

static bool read_shard(const char *text, void *word)
{
    struct shard ignored;
    *(const char **)word = text;
    return strcmp(text, "slurm") == 0 || shard_parse(&ignored, text);
}

/* A whole number that Slurm tells; 0 where it does not. */
static uint64_t told_by_slurm(const char *name)
{
    const char *text = getenv(name);
    char *end;
    const uint64_t number = text && text[0] >= '0' && text[0] <= '9' ? strtoull(text, &end, 10) : 0;
    return number > 0 && !*end ? number : 0;
}

/* Of an array 1-N. Parts of one, as when some tasks are repeated, do not say how many there are. */
static bool shard_of_slurm(struct options *o)
{
    const uint64_t last = told_by_slurm("SLURM_ARRAY_TASK_MAX");
    if (!getenv("SLURM_ARRAY_TASK_ID"))
        return usage("--shard slurm is for the tasks of an array: sbatch --array=1-N");
    if (told_by_slurm("SLURM_ARRAY_TASK_MIN") != 1 ||
        told_by_slurm("SLURM_ARRAY_TASK_COUNT") != last)
        return usage("--shard slurm: this array is not the whole of 1-N: give --shard "
                     "$SLURM_ARRAY_TASK_ID/N");
    snprintf(o->shard_name, sizeof o->shard_name, "%" PRIu64 "/%" PRIu64,
             told_by_slurm("SLURM_ARRAY_TASK_ID"), last);
    return shard_parse(&o->shard, o->shard_name) || usage("--shard slurm: there is no such shard");
}

/* On rank 0, whose environment may tell: --shard, in whose place argv then has its number. */
static bool read_shard_option(struct options *o, int argc, char **argv)
{
    if (!o->shard_word || shard_parse(&o->shard, o->shard_word))
        return true;
    if (!shard_of_slurm(o))
        return false;
    for (int i = 0; i < argc; i++) /* said when it stops: to be typed where there is no array */
        if (argv[i] == o->shard_word)
            argv[i] = o->shard_name;
    return true;
}

/* ---- all of them ---------------------------------------------------------------------------- */

/* Results are not drawn or tabled by `run`, though a file's ending says so. */
static bool read_output(const char *text, void *output)
{
    static const char *const other[] = {".pdf", ".svg", ".png", ".gif", ".eps",
                                        ".jpg", ".mp4", ".csv", ".json"};
    const char *const dot = strrchr(text, '.');
    *(const char **)output = text;
    for (size_t k = 0; dot && k < sizeof other / sizeof other[0]; k++)
        if (strcmp(dot, other[k]) == 0)
            return false;
    return true;
}

void run_stage_options(struct run *run)
{
    struct options *o = &run->options;
    *o = (struct options){.single_case = OPTION_NONE, .time_limit = INFINITY};
    if (run_take_options(run, &command_run)) {
        o->single = o->single_case != OPTION_NONE;
        if (o->extend_count > 0) {
            snprintf(o->extend_set, sizeof o->extend_set, "sweep.sample.count=%" PRIu64,
                     o->extend_count);
            o->asked.sets.text[o->asked.sets.count++] = o->extend_set;
        }
        if (run->parallel.rank == 0 && !read_shard_option(o, run->argc, run->argv))
            run->failure.code = EXIT_USAGE; /* it has been said why */
    }
    parallel_broadcast(&run->parallel, &o->shard, sizeof o->shard);
}

#define TO(member) OPTION_TO(struct options, member)
static const struct option options[] = {
    {"-o", "FILE", TO(output), .read = read_output,
     .takes = "the results, FILE.h5, of which stance plot draws pictures and stance table makes "
              "tables",
     .text = "results file; default results/<scenario name>.h5 (one case: with -case<N>). An "
             "existing file is left alone and the exit code is 3"},
    {.rows = asked_simulates},
    {"--force", TO(force),
     .text = "replace the file of that name, whatever it holds; of a symbolic link the link, not "
             "the file that it names"},
    {"--resume", TO(resume), .without = "--force --only",
     .text = "go on with an existing file of the same scenario: cases that it holds whole, as "
             "their checksums say, are kept. Begins when there is no file"},
    {"--force-scenario", TO(force_scenario), .needs = "--resume",
     .text = "... of another scenario: what is done stays, what is pending is computed as this "
             "one says. The file keeps both texts and which case is whose (group history, "
             "variable scenario_number). The sweep, the answers, the records and the designs must "
             "be the same"},
    {"--time-limit", "TIME", TO(time_limit), .read = option_seconds, .takes = OPTION_DURATION,
     .text = "stop after 90s, 55m, 1h30m ... of wall time; resumable"},
    {"--only", "CASE", TO(single_case), .takes = "the flat index of a case",
     .text = "compute one case of the sweep, by its flat index, to a file of its own"},
    {"--trace", TO(trace), .without = "--resume --extend --shard",
     .text = "... and record its trajectory, each 0.01 s unless record.every says (`record` in "
             "the scenario records a sweep); of a scenario of one case without --only, too"},
    {"--extend", "COUNT", TO(extend_count), .low = 1, .takes = "the new sweep.sample.count",
     .without = "--only",
     .text = "a new file with sweep.sample.count COUNT, by default results/<scenario "
             "name>-COUNT.h5, which takes over what a file of the same scenario with fewer points "
             "holds, and computes the rest. That file need not be complete and stays as it is. "
             "Not for method lhs"},
    {"--from", "FILE", TO(from), .needs = "--extend",
     .text = "... that file; default results/<scenario name>.h5"},
    {"--shard", "K/N", TO(shard_word), .read = read_shard,
     .takes = "K/N, the shard K of N, 1 <= K <= N <= 1000000, or slurm",
     .without = "--only --extend --force-scenario",
     .text = "compute the Kth of N equal shares of the cases, by default into results/<scenario "
             "name>.shard-K-of-N.h5, which takes the disk of its share alone; `merge` makes the "
             "file of one run of these. slurm instead of K/N: in the tasks of an array 1-N, as "
             "Slurm tells. Not of refined maps"},
    {"--dry-run", TO(dry_run),
     .text = "plan and estimate as `check` does, within seconds; write nothing"},
    {"--quiet", TO(quiet), .text = "neither progress nor summary"},
    {0},
};

const struct command command_run = {
    "run",
    "compute every case of a scenario; alone or under mpirun -n N",
    run_run,
    options,
    NULL,
    "SIGINT, SIGTERM and SIGUSR1 to any rank stop the job at once: cases in hand are given up, "
    "what has ended is written, and the command that goes on is printed; mpirun forwards SIGUSR1 "
    "but kills its ranks a second after SIGINT or SIGTERM, and returns 1 then. Cases that do not "
    "verify when a run is resumed are computed again and named. Exit codes: 0 done, 1 some cases "
    "failed, 2 bad use or scenario, 3 input or output, 4 stopped and resumable.\n",
};
