/* run_options.c - the options of `stance run`. */
#include "run.h"

#include "runner/base/command.h"

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
    if (limit && (o->time_limit = claim_duration(limit)) < 0)
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
    size_t extends, froms, outputs, limits, onlys, force, force_scenario, resume, trace, dry_run;
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
    return o->help || (check_options(o, only, limit) && check_extend(o, extend, only));
}
