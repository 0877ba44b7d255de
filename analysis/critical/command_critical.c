/* command_critical.c - `stance critical`: a run along one number more than the scenario has, of
 * which is simulated what brackets where the outcome is lost; and what a results file says of that.
 */
#include "critical.h"

#include "analysis/basin/basin_print.h"
#include "runner/plan/law.h"
#include "runner/run/run.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

extern const struct command command_critical; /* below */

enum { SETS = 3, SET = 400 };
enum { COUNT = 1025, START = 32 };
#define PROBES 0.002

/* What is asked for beside what a run is. */
struct request {
    struct report report;
    const char *of;
    uint64_t count, start;
    double probes;
    bool log;
    int outcome;
    struct option_texts within;
    struct critical_choice choice;
    char set[SETS][SET]; /* the scenario's, beside those that are given */
};

struct search {
    struct run run;
    struct request asked;
    bool reads; /* a results file, and runs nothing */
};

/* ---- what a results file says --------------------------------------------------------------- */

static int work(struct report *report, const struct results *r, stance_message *message)
{
    const struct request *const request = (const struct request *)report;
    const enum results_kind of = request->outcome < RESULTS_OUTCOMES
                                     ? (enum results_kind)request->outcome
                                     : statistics_judged(r);
    const struct basin_within within = {"critical", &request->within, of};
    struct results own;
    struct critical critical;
    bool usage;
    char said[256];
    int code = basin_within_make(&own, r, &within, said, sizeof said, message);
    if (code == EXIT_DONE &&
        !critical_make(&critical, &own, request->of, of, &request->choice, &usage, message)) {
        code = usage ? EXIT_USAGE : EXIT_IO;
    } else if (code == EXIT_DONE) {
        code = critical_print(&critical, said, report->form);
        critical_free(&critical);
    }
    free(own.kind);
    return code;
}

/* ---- the run -------------------------------------------------------------------------------- */

static bool is_results(const char *name)
{
    char head[8] = "";
    FILE *const file = fopen(name, "rb");
    const bool is = file && fread(head, 1, sizeof head, file) == sizeof head &&
                    memcmp(head, "\x89HDF\r\n\x1a\n", sizeof head) == 0;
    if (file)
        fclose(file);
    return is;
}

/* The --set that gives a scenario the axis, which alone is refined, after those that there are. */
static bool add_sets(struct search *search, const struct scenario *s, const char *path,
                     const double ends[2])
{
    struct request *const asked = &search->asked;
    struct option_texts *const sets = &search->run.options.asked.sets;
    const char **const all = calloc(sets->count + SETS, sizeof *all);
    if (!all)
        return run_fail(&search->run, EXIT_IO, "stance critical: not enough memory");
    /* Its place on the grid: that of the axis that the scenario has along the path, or behind all.
     */
    const int axes = s->axes - s->sample.given;
    int place = 0;
    while (place < axes && (s->axis[place].paths != 1 || strcmp(s->axis[place].path[0], path) != 0))
        place++;
    for (size_t k = 0; k < sets->count; k++)
        all[k] = sets->text[k];
    snprintf(asked->set[0], SET,
             "sweep.grid[%d]={path: '%s', from: %.17g, to: %.17g, count: %" PRIu64 ", spacing: %s}",
             place, path, ends[0], ends[1], asked->count, asked->log ? "log" : "linear");
    snprintf(asked->set[1], SET, "record={answers: [outcome, evidence, end_time]}");
    /* Of fewer values than the lattice has all are simulated, as probes. */
    const bool all_first = asked->count <= asked->start + 1;
    snprintf(asked->set[2], SET,
             "sweep.refine={along: '%s', start: %" PRIu64 ", margin: 0, probes: %.17g}", path,
             all_first ? 2 : asked->start + 1, all_first ? 1 : asked->probes);
    for (size_t k = 0; k < SETS; k++)
        all[sets->count + k] = asked->set[k];
    *sets = (struct option_texts){all, sets->count + SETS};
    return true;
}

/* On rank 0, whose scenario the others get. */
static bool ask_for_axis(struct search *search)
{
    struct run *const run = &search->run;
    const char *const of = search->asked.of;
    char path[96];
    double ends[2];
    bool good = !of || option_range(of, path, ends) ||
                run_fail(run, EXIT_USAGE,
                         "stance critical: of a scenario --of takes PATH=FROM..TO, from where the "
                         "outcome is kept, not '%.60s'",
                         of);
    struct scenario *const s = good ? run_read_scenario(run, run->options.asked.sets.count) : NULL;
    int refined = 0;
    if (s && of)
        good = add_sets(search, s, path, ends);
    for (int a = 0; s && a < s->axes; a++)
        refined += s->axis[a].refined;
    if (s && !of && refined != 1)
        good =
            run_fail(run, EXIT_USAGE,
                     "stance critical: %.150s does not say along which number (sweep.refine.along"
                     "): --of PATH=FROM..TO, from where the outcome is kept",
                     s->file);
    scenario_drop(s);
    return good;
}

static void stage_options(struct run *run)
{
    struct search *const search = (struct search *)run;
    run->options = (struct options){.single_case = OPTION_NONE, .time_limit = INFINITY};
    if (!run_take_options(run, &command_critical))
        return;
    run->options.ending = search->asked.of ? "-critical" : "";
    search->reads = run->parallel.rank == 0 && is_results(run->options.asked.file);
    parallel_broadcast(&run->parallel, &search->reads, sizeof search->reads);
    run->over = search->reads;
    run->options.quiet |= search->asked.report.form != TABLE_AS_TEXT;
    if (run->parallel.rank != 0)
        return;
    const struct options *const o = &run->options;
    const struct request *const asked = &search->asked;
    const bool values = asked->log || asked->count != COUNT || asked->start != START ||
                        asked->probes != PROBES,
               runs = o->asked.sets.count > 0 || o->output || o->force || o->resume || o->dry_run ||
                      isfinite(o->time_limit);
    if (search->reads && (runs || values))
        run_fail(run, EXIT_USAGE,
                 "stance critical: %.150s holds results, which is read: only --of, --outcome, "
                 "--within, --share, --level and the form count",
                 run->options.asked.file);
    else if (!search->reads && !asked->of && values)
        run_fail(run, EXIT_USAGE,
                 "stance critical: --count, --log, --start and --probes are of the axis that --of "
                 "asks for");
    else if (!search->reads)
        ask_for_axis(search);
}

static int run_critical(int argc, char **argv)
{
    struct search *const search = calloc(1, sizeof *search);
    if (!search) {
        fputs("stance critical: not enough memory\n", stderr);
        return EXIT_IO;
    }
    search->asked = (struct request){.report = {.command = &command_critical, .work = work},
                                     .count = COUNT,
                                     .start = START,
                                     .probes = PROBES,
                                     .outcome = RESULTS_OUTCOMES,
                                     .choice = {.share = 0.9, .level = 0.95}};
    struct run *const run = &search->run;
    int code = run_all(run, argc, argv, stage_options);
    const bool reports = run->parallel.rank == 0 && (search->reads || !run->over) &&
                         (code == EXIT_DONE || code == EXIT_CASES_FAILED);
    run_drop(run);
    if (reports) {
        const char *file = search->reads ? run->options.asked.file : run->file;
        search->asked.report.files = (struct option_texts){&file, 1};
        const int read = report_run(&search->asked.report);
        code = read == EXIT_DONE ? code : read;
    }
    free(search);
    return code;
}

/* ---- the command ---------------------------------------------------------------------------- */

/* Members of a run's options, and of what is asked for beside them. */
#define RUN(member) OPTION_TO(struct options, member)
#define TO(member) OPTION_TO(struct request, member)
static const struct option asks[] = {
    {"--of", "PATH=FROM..TO", TO(of),
     .text = "the number, and between which values: from FROM, where the outcome is kept, to TO, "
             "above or below it. Of a scenario that has sweep.refine.along, of which the results "
             "keep what it records, it is not needed; of a results file PATH of an axis of its "
             "grid will do (default: the only one, or the refined one)"},
    {"--count", "N", TO(count), .low = 3, .high = 1e7,
     .text = "values along it, default 1025: what is found is as sharp as their spacing"},
    {"--log", TO(log), .text = "in equal ratios, not differences"},
    {"--start", "N", TO(start), .low = 1, .high = 1e6,
     .text = "of these the first that are simulated, evenly spread, default 32: a pocket in which "
             "the outcome is lost is found for certain where it is as wide as their spacing"},
    {"--probes", "SHARE", TO(probes), .low = 0, .high = 1,
     .text = "of all values that are simulated in search of narrower ones, default 0.002"},
    {"--outcome", TO(outcome), .word = results_outcome_word,
     .text = "that is to be kept: stabilised (default; or walks, where any does, or rested, where "
             "nothing else was)"},
    {"--within", "ANSWER=BOUND", TO(within), .most = 8,
     .text = "counts as the outcome only where the number is at most BOUND, or with BOUND LEAST.. "
             "at least that, as stance basin has it: of a results file in which all cases were "
             "simulated (stance run without sweep.refine)"},
    {"--share", "S", TO(choice.share), .low = 1e-6, .high = 1,
     .text = "of a sample's points that are to keep it so far, default 0.9"},
    {"--level", "L", TO(choice.level), .low = 0.5, .high = 0.999999,
     .text = "of intervals, default 0.95"},
    {REPORT_CSV, .text = "a row for each point of the other axes"},
    {REPORT_JSON, .keys = critical_keys, .text = "the same as JSON, with the keys"},
    {0},
};
static const struct option options[] = {
    {"SCENARIO|FILE", RUN(asked.file), .low = 1, .text = "a scenario or a results file"},
    {.rows = asks, .at = offsetof(struct search, asked) - offsetof(struct search, run.options)},
    {.text = "Of a scenario, which is run:"},
    {"-o", "FILE", RUN(output),
     .text = "results file; default results/<scenario name>-critical.h5, without --of "
             "results/<scenario name>.h5"},
    {OPTION_SET(struct options, asked.sets)},
    {OPTION_TRUST(struct options, asked.trust)},
    {"--force", RUN(force), .text = "replace the file of that name"},
    {"--resume", RUN(resume), .without = "--force",
     .text = "go on with the file of the same search. Begins when there is none"},
    {"--time-limit", "TIME", RUN(time_limit), .read = option_seconds, .takes = OPTION_DURATION,
     .text = "stop after 90s, 55m, 1h30m ... of wall time; resumable"},
    {"--dry-run", RUN(dry_run), .text = "plan and estimate as `check` does; write nothing"},
    {"--quiet", RUN(quiet), .text = "no progress"},
    {0},
};

const struct command command_critical = {
    "critical",
    "the largest push, the least friction ... at which the outcome is kept; alone or under mpirun",
    run_critical,
    options,
    "For each point of the scenario's grid: the largest value of a number such that the outcome is "
    "kept there and at all values before, from FROM on. A search is a run: the scenario gets one "
    "axis more (or its axis along PATH is replaced), of which a coarse lattice is simulated first "
    "and then what lies about changes, by halves (sweep.refine), each line by itself. It is "
    "stopped, "
    "resumed, drawn and summarised as all are, and keeps the answers outcome, evidence and "
    "end_time. A results file of any run that has PATH as an axis will do, too.\n"
    "\n"
    "  kept, lost  the number lies between these neighbouring values, for certain, but for pockets "
    "before it in which the outcome is lost, narrower than the gaps between values simulated\n"
    "  again       values beyond, at which it is kept again: they do not count\n"
    "  interval    of a sample (of starts, of phases of a push) each point has a number of its "
    "own; "
    "that of a share of them, --share 0.9, is the largest value up to which at least so many keep "
    "the outcome. kept and lost are of these points, the interval at the level L of all that could "
    "have been drawn, from order statistics: it needs 36 points at 0.9, 72 at 0.95. With --share 1 "
    "there is none: least is the share of all that keeps `kept`, at that level. With noise each "
    "value is a draw of its own, and the more values the sooner one is lost\n",
    NULL,
};
