/* run_options.c - the options of `stance run`. */
#include "run.h"

#include "runner/base/command.h"
#include "runner/base/units.h"

#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static bool usage(const char *text, const char *word)
{
    fprintf(stderr, "stance run: %s%s%s (stance run -h explains)\n", text, word ? " " : "",
            word ? word : "");
    return false;
}

/* A number without sign. */
static bool parse_number(const char *text, uint64_t *number)
{
    char *end;
    errno = 0;
    *number = strtoull(text, &end, 10);
    return text[0] >= '0' && text[0] <= '9' && !*end && errno == 0;
}

static bool check_extend(struct options *o, const char *extend, const char *only)
{
    if (!extend)
        return !o->from || usage("--from names the file that --extend begins with", NULL);
    if (only)
        return usage("--extend and --only exclude each other", NULL);
    if (!parse_number(extend, &o->extend_count) || o->extend_count == 0)
        return usage("--extend takes the new sweep.sample.count, not", extend);
    snprintf(o->extend_set, sizeof o->extend_set, "sweep.sample.count=%" PRIu64, o->extend_count);
    o->sets[o->set_count++] = o->extend_set;
    return true;
}

/* What asks for other cases than a share of the sweep's. */
static bool check_shard(const struct options *o)
{
    if (o->single || o->extend_count > 0)
        return usage(o->single ? "--shard and --only exclude each other"
                               : "--shard and --extend exclude each other",
                     NULL);
    return !o->force_scenario ||
           usage("--shard and --force-scenario exclude each other: merge the shards first", NULL);
}

/* A whole number that Slurm tells; 0 where it does not. */
static uint64_t told_by_slurm(const char *name)
{
    uint64_t number;
    const char *text = getenv(name);
    return text && parse_number(text, &number) ? number : 0;
}

/* Of an array 1-N. Parts of one, as when some tasks are repeated, do not say how many there are. */
static bool shard_of_slurm(struct options *o)
{
    const uint64_t last = told_by_slurm("SLURM_ARRAY_TASK_MAX");
    if (!getenv("SLURM_ARRAY_TASK_ID"))
        return usage("--shard slurm is for the tasks of an array: sbatch --array=1-N", NULL);
    if (told_by_slurm("SLURM_ARRAY_TASK_MIN") != 1 ||
        told_by_slurm("SLURM_ARRAY_TASK_COUNT") != last)
        return usage("--shard slurm: this array is not the whole of 1-N: give --shard "
                     "$SLURM_ARRAY_TASK_ID/N",
                     NULL);
    snprintf(o->shard_name, sizeof o->shard_name, "%" PRIu64 "/%" PRIu64,
             told_by_slurm("SLURM_ARRAY_TASK_ID"), last);
    return shard_parse(&o->shard, o->shard_name) ||
           usage("--shard slurm: there is no shard", o->shard_name);
}

bool run_read_shard(struct options *o, int argc, char **argv)
{
    if (!o->shard_word)
        return true;
    if (strcmp(o->shard_word, "slurm") == 0) {
        if (!shard_of_slurm(o))
            return false;
        for (int i = 0; i < argc; i++) /* said when it stops: to be typed where there is no array */
            if (argv[i] == o->shard_word)
                argv[i] = o->shard_name;
        return true;
    }
    return shard_parse(&o->shard, o->shard_word) ||
           usage("--shard takes K/N, the shard K of N, 1 <= K <= N <= 1000000, or slurm; not",
                 o->shard_word);
}

/* Results are not drawn or tabled by `run`, though a file's ending says so. */
static bool check_output(const char *output)
{
    static const char *const other[] = {".pdf", ".svg", ".png", ".gif", ".eps",
                                        ".jpg", ".mp4", ".csv", ".json"};
    const char *const dot = output ? strrchr(output, '.') : NULL;
    for (size_t k = 0; dot && k < sizeof other / sizeof other[0]; k++)
        if (strcmp(dot, other[k]) == 0)
            return usage("-o names the results, FILE.h5, of which stance plot draws pictures and "
                         "stance table makes tables; not",
                         output);
    return true;
}

static bool check_options(struct options *o, const char *only, const char *limit)
{
    if (!check_output(o->output))
        return false;
    if (o->force && o->resume)
        return usage("--force and --resume exclude each other", NULL);
    if (o->force_scenario && !o->resume)
        return usage("--force-scenario needs --resume", NULL);
    if (o->trace && !only)
        return usage("--trace needs --only CASE; `record` in the scenario records a sweep", NULL);
    if (o->resume && only)
        return usage("--only computes one case: there is nothing to resume", NULL);
    if (limit && (o->time_limit = seconds_of_text(limit)) < 0)
        return usage("--time-limit takes a duration such as 90s, 55m or 1h30m, not", limit);
    if (only) {
        if (!parse_number(only, &o->single_case))
            return usage("--only takes the flat index of a case, not", only);
        o->single = true;
    }
    return true;
}

bool run_read_options(struct options *o, int argc, char **argv)
{
    const char *limit = NULL, *only = NULL, *extend = NULL;
    size_t shards, extends, froms, outputs, limits, onlys, force, force_scenario, resume, trace,
        dry_run;
    size_t quiet, operands;
    const struct option_spec specs[] = {
        {"-o", true, &o->output, 1, &outputs},
        {"--set", true, o->sets, (size_t)argc, &o->set_count},
        {"--force", false, NULL, 0, &force},
        {"--force-scenario", false, NULL, 0, &force_scenario},
        {"--resume", false, NULL, 0, &resume},
        {"--time-limit", true, &limit, 1, &limits},
        {"--only", true, &only, 1, &onlys},
        {"--trace", false, NULL, 0, &trace},
        {"--dry-run", false, NULL, 0, &dry_run},
        {"--quiet", false, NULL, 0, &quiet},
        {"--extend", true, &extend, 1, &extends},
        {"--from", true, &o->from, 1, &froms},
        {"--shard", true, &o->shard_word, 1, &shards},
    };
    o->time_limit = INFINITY;
    if (!command_options(&command_run, argc, argv, specs, sizeof specs / sizeof specs[0],
                         &o->scenario, 1, &operands, &o->help))
        return false;
    o->force = force > 0;
    o->force_scenario = force_scenario > 0;
    o->resume = resume > 0;
    o->trace = trace > 0;
    o->dry_run = dry_run > 0;
    o->quiet = quiet > 0;
    if (!o->help && operands != 1)
        return usage("a scenario file must be given", NULL);
    return o->help || (check_options(o, only, limit) && check_extend(o, extend, only) &&
                       (!o->shard_word || check_shard(o)));
}
