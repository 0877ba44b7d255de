/* command_optimise.c - `stance optimise`: from a scenario with a section optimise to the file of a
 * search and the scenario of its best candidate, on one rank or many.
 */
#include "search.h"

#include "runner/base/message.h"
#include "runner/base/units.h"
#include "runner/plan/allowed.h"
#include "runner/plan/asked.h"
#include "runner/run/run.h"

#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

extern const struct command command_optimise; /* below */

static const double most_undecided = 1e-3;

struct optimise {
    struct run run;         /* whose scenario is the first candidate */
    struct scenario *asked; /* as it was read, on rank 0 */
    char best[1100];
    struct search_file origin; /* of a search that is gone on with, on rank 0; else all 0 */
    struct search search;
};

static struct optimise *of(struct run *run)
{
    return (struct optimise *)run;
}

/* ---- options -------------------------------------------------------------------------------- */

static void stage_options(struct run *run)
{
    run->options.time_limit = INFINITY;
    run->options.ending = "-search";
    run_take_options(run, &command_optimise);
}

/* ---- the scenario --------------------------------------------------------------------------- */

static bool say_place(struct optimise *o, const char *key, const char *text)
{
    int line = 1, column = 1;
    scenario_place(o->asked, key, &line, &column);
    fprintf(stderr, "%s:%d:%d: %s\n", o->asked->file, line, column, text);
    o->run.failure.code = EXIT_USAGE;
    return false;
}

/* Rank 0: the scenario, and of it the first candidate, from a text of our own: places in it are
 * none of the user's. */
static bool read_scenario(struct optimise *o)
{
    const struct asked *const asked = &o->run.options.asked;
    const size_t place = strlen(asked->file);
    o->asked = run_read_scenario(&o->run, asked->sets.count);
    if (!o->asked)
        return false;
    if (!o->asked->search.given)
        return say_place(o, "stance:",
                         "no section optimise, which says what to vary (stance describe optimise)");
    char *const text = best_first(o->asked, &o->run.message);
    if (!text)
        return say_place(o, "controller:", o->run.message.text);
    o->run.scenario = adopt_text(asked->file, text, &o->run.message);
    free(text);
    const char *const said = o->run.message.text;
    if (!o->run.scenario && strlen(said) > place)
        return say_place(o, "optimise.vary:", said + place + strspn(said + place, ":0123456789 "));
    return o->run.scenario || run_fail(&o->run, EXIT_USAGE, "stance optimise: %s", said);
}

static void stage_scenario(struct run *run)
{
    static const char none[] = "optimise.vary: all of these stay 0 while the contacts hold";
    struct optimise *const o = of(run);
    if (run->parallel.rank == 0)
        read_scenario(o);
    if (run_share_scenario(run)) {
        search_numbers_keep(run->scenario);
        if (run->scenario->search.axis.paths == 0 && run->parallel.rank == 0)
            say_place(o, none, none);
    }
}

/* ---- the file ------------------------------------------------------------------------------- */

static bool name_files(struct optimise *o)
{
    struct run *const run = &o->run;
    run_name_file(run);
    size_t stem = strlen(run->file);
    if (stem > 3 && strcmp(run->file + stem - 3, ".h5") == 0)
        stem -= 3;
    if (stem > 7 && strncmp(run->file + stem - 7, "-search", 7) == 0)
        stem -= 7;
    snprintf(o->best, sizeof o->best, "%.*s-best.yaml", (int)stem, run->file);
    return run->failure.code == EXIT_DONE;
}

/* Of a damaged file. */
static bool check_file(const char *file, stance_message *message)
{
    struct search_file f;
    const bool good = search_file_read(&f, file, message);
    if (good)
        search_file_free(&f);
    return good;
}

static bool look_into_file(struct optimise *o)
{
    struct run *const run = &o->run;
    run->failure.code = run_check_file(run, check_file, run->file);
    if (run->failure.code != EXIT_DONE)
        return false; /* it has been said why */
    if (!search_file_read(&o->origin, run->file, &run->message))
        return run_fail_io(run);
    if (strcmp(o->origin.scenario, o->asked->text) != 0)
        return run_fail(run, EXIT_USAGE,
                        "stance optimise: %.150s is a search of another scenario: --force replaces "
                        "it, -o names another file",
                        run->file);
    run_warn_of_revision(run, run->file, o->origin.revision);
    return true;
}

/* Neither file of the search is the scenario itself, and a scenario of the best that lies there is
 * not taken for one of an earlier search. */
static bool spares_files(struct optimise *o)
{
    const char *const names[] = {o->run.file, o->best};
    const struct options *const options = &o->run.options;
    if (access(options->asked.file, F_OK) != 0)
        return true; /* read all the same: from a pipe */
    for (int i = 0; i < 2; i++)
        if (same_file(names[i], options->asked.file))
            return run_fail(
                &o->run, EXIT_IO,
                "stance optimise: %.150s is the scenario and would be written over: give another "
                "-o",
                names[i]);
    return options->force || options->resume || access(o->best, F_OK) != 0 ||
           run_fail(&o->run, EXIT_IO,
                    "stance optimise: %.150s exists; --force replaces it, -o names other files",
                    o->best);
}

static void stage_claim(struct run *run)
{
    struct optimise *const o = of(run);
    bool exists;
    if (!name_files(o) || run->parallel.rank != 0 || !run_claim_file(run, &exists))
        return;
    if (spares_files(o) && exists && run->options.resume)
        look_into_file(o);
}

/* ---- the search ----------------------------------------------------------------------------- */

static void stage_make(struct run *run)
{
    struct optimise *const o = of(run);
    const char *const text = run->parallel.rank == 0 ? o->asked->text : "";
    parallel_share(&run->parallel);
    if (!search_make(&o->search, run, text, o->origin.scenario ? &o->origin : NULL)) {
        run_fail_io(run);
        return;
    }
    const int lambda = o->search.stage[o->search.stages - 1].lambda;
    if (run->parallel.rank == 0 && run->scenario->search.candidates < (uint64_t)lambda) {
        char line[120];
        snprintf(line, sizeof line,
                 "optimise.candidates: %" PRIu64 " are less than one generation%s, %d",
                 run->scenario->search.candidates,
                 run->scenario->search.restarts > 0 ? " after the restarts" : "", lambda);
        say_place(o, line, line);
    }
}

static void stage_search(struct run *run)
{
    struct optimise *const o = of(run);
    const enum trials_end end = search_run(&o->search);
    progress_end(&run->progress);
    if (run->failure.code != EXIT_DONE) /* the file is not ours any more */
        return;
    if (end == TRIALS_BROKEN || (end == TRIALS_DONE && run->parallel.rank == 0 &&
                                 !best_write(&o->search.record, o->best, &run->message))) {
        run_fail_io(run);
    } else if (end == TRIALS_STOPPED) {
        char what[80];
        snprintf(what, sizeof what, "stopped after %zu of at most %zu generations",
                 o->search.record.length[SEARCH_GENERATION], o->search.generations);
        run->failure.code = EXIT_INTERRUPTED;
        run_say_stopped(run, what);
    }
}

/* ---- what came out -------------------------------------------------------------------------- */

#define WARN(text, ...) fprintf(stderr, "stance optimise: warning: " text "\n", ##__VA_ARGS__)

/* Share of fresh starts of the best one that end so, in the circumstance where most do. */
static double most_ending(const struct search_file *f, stance_outcome outcome)
{
    const size_t circumstances = f->length[SEARCH_CIRCUMSTANCE];
    int64_t most = 0;
    for (size_t c = 0; c < circumstances; c++) {
        const size_t pair = (size_t)f->chosen * circumstances + c;
        const int64_t count = f->confirmed_count[pair * TRIAL_LABELS + outcome + 1];
        most = count > most ? count : most;
    }
    return (double)most / (double)f->length[SEARCH_START];
}

/* Share of the candidates that were not tried in any circumstance. */
static double refused(const struct search_file *f)
{
    const size_t circumstances = f->length[SEARCH_CIRCUMSTANCE], all = f->length[SEARCH_CANDIDATE];
    size_t count = 0;
    for (size_t i = 0; i < all; i++) {
        size_t c = 0;
        while (c < circumstances &&
               f->count[(i * circumstances + c) * TRIAL_LABELS + TRIAL_REFUSED] > 0)
            c++;
        count += c == circumstances;
    }
    return (double)count / (double)all;
}

static void warn_of_bound(const struct scenario_varied *v, const char *path, double value)
{
    const bool even = v->scale == SCALE_EVEN;
    const double edge = 0.01 * (even ? v->high - v->low : log(v->high / v->low));
    const bool low = value <= (even ? v->low + edge : v->low * exp(edge)),
               high = value >= (even ? v->high - edge : v->high * exp(-edge));
    if (v->bounded && (low || high))
        WARN("%s of the best is at its %s bound, %g: better ones may lie beyond", path,
             low ? "lower" : "upper", value);
}

/* What linear theory and the counts say against the best. */
static void warn(const struct search *search)
{
    const struct search_file *const f = &search->record;
    const struct scenario_search *const sought = &search->run->scenario->search;
    const size_t n = f->length[SEARCH_PARAMETER];
    const double untried = refused(f), undecided = most_ending(f, STANCE_UNDECIDED),
                 recovered = most_ending(f, STANCE_STABILISED) + most_ending(f, STANCE_WALKS);
    for (size_t k = 0; k < n; k++)
        warn_of_bound(&sought->varied[k], f->parameter[k],
                      f->confirmed_value[(size_t)f->chosen * n + k]);
    for (size_t e = 0; e < f->length[SEARCH_ELSEWHERE]; e++)
        if (f->elsewhere_chosen[e] < f->elsewhere_first[e] ||
            f->elsewhere_chosen[e] < 0.5 * recovered)
            WARN("%s the best recovers %.1f %% of the starts, the first %.1f %%", f->elsewhere[e],
                 100 * f->elsewhere_chosen[e], 100 * f->elsewhere_first[e]);
    if (undecided > most_undecided)
        WARN("%.2f %% of the best one's starts are undecided when stop.time is up and do not "
             "count: a longer one would tell",
             100 * undecided);
    if (f->objective[f->best[0]] < 0.01 && scenario_search_plain(search->run->scenario))
        WARN("hardly a start recovers in the first generation: begin with another controller, or "
             "with restarts");
    if (untried > 0.5)
        WARN("%.0f %% of the candidates were not tried, as their loops are unstable or do not have "
             "what optimise.require asks for: a smaller optimise.first_step may find more",
             100 * untried);
    if (sought->grow[0] < 128)
        WARN("%" PRIu64 " starts tell little of a candidate: optimise.grow, from 128 on",
             sought->grow[0]);
}

/* Beside the share of the worst circumstance what is allowed in that which allows least. */
static void print_limit(const struct search *search)
{
    const struct search_file *const f = &search->record;
    const char *where;
    const double limit =
        search_limit_of(f, search->run->scenario->search.worst, (size_t)f->chosen, &where);
    if (!isfinite(limit))
        return;
    printf(", linear theory allows any %.2f %%", 100 * limit);
    if (where)
        printf(" in its worst circumstance (%s)", where);
    if (allowed_glued_in(search->run->scenario))
        fputs(" (" ALLOWED_GLUED ")", stdout);
}

static int conclude(struct run *run)
{
    const struct optimise *const o = of(run);
    const struct search_file *const f = &o->search.record;
    if (run->parallel.rank != 0)
        return EXIT_DONE;
    warn(&o->search);
    if (run->options.quiet)
        return EXIT_DONE;
    const size_t generations = f->length[SEARCH_GENERATION], starts = f->length[SEARCH_START];
    const double chosen = f->confirmed_objective[f->chosen], first = f->confirmed_objective[0];
    printf("%s: %zu candidates in %zu generation%s, %s; ", run->file, f->length[SEARCH_CANDIDATE],
           generations, generations == 1 ? "" : "s", f->note);
    if (scenario_search_plain(run->scenario)) {
        printf("%.2f %% of %zu fresh starts, the first %.2f %%", 100 * chosen, starts, 100 * first);
        print_limit(&o->search);
    } else {
        printf("objective %.6g of %zu fresh starts, the first %.6g", chosen, starts, first);
    }
    printf("; %.1f s on %d rank%s\n%s: the scenario of the best\n", clock_seconds() - run->start,
           run->parallel.size, run->parallel.size == 1 ? "" : "s", o->best);
    return EXIT_DONE;
}

/* ---- the whole ------------------------------------------------------------------------------ */

static int run_optimise(int argc, char **argv)
{
    static const struct stage stages[] = {
        {stage_options, "reading its options"}, {stage_scenario, "reading the scenario"},
        {stage_claim, "looking into the file"}, {stage_make, "preparing the search"},
        {stage_search, "trying candidates"},    {NULL, NULL},
    };
    struct optimise *const o = calloc(1, sizeof *o);
    const int code = run_through(o ? &o->run : NULL, argc, argv, stages, conclude);
    if (o) {
        search_free(&o->search);
        search_file_free(&o->origin);
        scenario_drop(o->asked);
        run_end(&o->run);
    }
    free(o);
    return code;
}

#define TO(member) OPTION_TO(struct options, member)
static const struct option options[] = {
    {"-o", "FILE", TO(output),
     .text = "file of the search; default results/<scenario name>-search.h5. stance summary and "
             "stance plot read it. Beside it <scenario name>-best.yaml, the scenario with the "
             "best candidate"},
    {.rows = asked_simulates},
    {"--force", TO(force), .text = "replace files of these names"},
    {"--resume", TO(resume), .without = "--force",
     .text = "go on with a search of the same scenario after its last whole generation. Begins "
             "when there is no file"},
    {"--time-limit", "TIME", TO(time_limit), .read = option_seconds, .takes = OPTION_DURATION,
     .text = "stop after 90s, 55m, 1h30m ... of wall time; resumable"},
    {"--quiet", TO(quiet), .text = "neither progress nor summary"},
    {0},
};

const struct command command_optimise = {
    "optimise",
    "search for the controller that recovers from more starts; alone or under mpirun -n N",
    run_optimise,
    options,
    "The scenario's section optimise says what differs between candidates and what counts as "
    "better (stance describe optimise); sweep.sample are the starts that all candidates get, "
    "sweep.grid the circumstances. The scenario as it is, with the gains of its design, is the "
    "first candidate. An evolution strategy (CMA-ES) proposes the others, a generation at a time; "
    "at the end the first, and of each stage the best and the mean, are compared from as many "
    "starts that the search has not seen, and what they recover is told of others: fresh starts, "
    "by which nothing was chosen.\n",
    "The result does not depend on ranks, nor on stops and resumes. Exit codes: 0 done, 2 bad use "
    "or scenario, 3 input or output, 4 stopped and resumable.\n",
};
