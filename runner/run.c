/* run.c - `stance run`: from the scenario to the results, on one rank or many.
 *
 * The run is a list of stages. Every rank goes through each, then all agree on how it went: an
 * error of any rank is printed once, and all leave together with its exit code.
 */
#include "build_info.h"
#include "checksum.h"
#include "command.h"
#include "deadline.h"
#include "instruction_set.h"
#include "lock.h"
#include "report.h"
#include "rounds.h"
#include "supervise.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

struct options {
    const char *scenario, *output; /* output NULL: the default */
    const char **sets;
    size_t set_count;
    bool force, resume, single, trace, dry_run, quiet, help;
    uint64_t single_case;
    double time_limit; /* s, INFINITY: none */
};

struct failure {
    int code;       /* EXIT_DONE: none */
    char text[600]; /* one line; empty when it has been printed already */
};

struct run {
    int argc;
    char **argv;
    struct parallel parallel;
    struct options options;
    struct scenario *scenario;
    char file[1024];
    bool resume, replace; /* the file exists and is gone on with, or replaced */
    struct lock lock;
    struct plan plan;
    struct store *store;
    struct work work;
    struct failure failure; /* of this rank */
    double start;
};

static void fail(struct run *run, int code, const char *text)
{
    run->failure.code = code;
    snprintf(run->failure.text, sizeof run->failure.text, "%s", text);
}

static void fail_io(struct run *run, const stance_message *message)
{
    snprintf(run->failure.text, sizeof run->failure.text, "stance run: %s", message->text);
    run->failure.code = EXIT_IO;
}

/* An error of the scenario, with its place in the text. */
static void fail_scenario(struct run *run, const struct plan_error *error)
{
    char place[40] = "";
    if (error->line > 0) {
        snprintf(place, sizeof place, ":%d:%d", error->line, error->column);
    }
    snprintf(run->failure.text, sizeof run->failure.text, "%.300s%s: %s", run->scenario->file,
             place, error->message.text);
    run->failure.code = EXIT_USAGE;
}

/* ---- options ------------------------------------------------------------------------------ */

/* Seconds from "90", "90s", "55m", "1h30m", "2d"; negative when it is none of these. */
static double parse_duration(const char *text)
{
    double total = 0;
    while (*text) {
        char *end;
        double value = strtod(text, &end), unit = 1;
        if (end == text || !(value >= 0) || !isfinite(value)) {
            return -1;
        }
        switch (*end) {
        case 'd':
            unit = 86400;
            break;
        case 'h':
            unit = 3600;
            break;
        case 'm':
            unit = 60;
            break;
        case 's':
        case '\0':
            break;
        default:
            return -1;
        }
        total += value * unit;
        text = *end ? end + 1 : end;
    }
    return total;
}

static bool usage(const char *text, const char *word)
{
    fprintf(stderr, "stance run: %s%s%s (stance run -h explains)\n", text, word ? " " : "",
            word ? word : "");
    return false;
}

static bool check_options(struct options *o, const char *only, const char *limit)
{
    if (o->force && o->resume) {
        return usage("--force and --resume exclude each other", NULL);
    }
    if (o->trace && !only) {
        return usage("--trace needs --only CASE; `record` in the scenario records a sweep", NULL);
    }
    if (o->resume && only) {
        return usage("--only computes one case: there is nothing to resume", NULL);
    }
    if (limit && (o->time_limit = parse_duration(limit)) < 0) {
        return usage("--time-limit takes a duration such as 90s, 55m or 1h30m, not", limit);
    }
    if (only) {
        char *end;
        errno = 0;
        o->single_case = strtoull(only, &end, 10);
        if (only[0] < '0' || only[0] > '9' || *end || errno) {
            return usage("--only takes the flat index of a case, not", only);
        }
        o->single = true;
    }
    return true;
}

/* Prints what is wrong with them on standard error. */
static bool read_options(struct options *o, int argc, char **argv)
{
    const char *limit = NULL, *only = NULL;
    size_t outputs, limits, onlys, force, resume, trace, dry_run, quiet, operands;
    const struct option_spec specs[] = {
        {"-o", true, &o->output, 1, &outputs},
        {"--set", true, o->sets, (size_t)argc, &o->set_count},
        {"--force", false, NULL, 0, &force},
        {"--resume", false, NULL, 0, &resume},
        {"--time-limit", true, &limit, 1, &limits},
        {"--only", true, &only, 1, &onlys},
        {"--trace", false, NULL, 0, &trace},
        {"--dry-run", false, NULL, 0, &dry_run},
        {"--quiet", false, NULL, 0, &quiet},
    };
    o->time_limit = INFINITY;
    if (!command_options(&command_run, argc, argv, specs, sizeof specs / sizeof specs[0],
                         &o->scenario, 1, &operands, &o->help)) {
        return false;
    }
    o->force = force > 0;
    o->resume = resume > 0;
    o->trace = trace > 0;
    o->dry_run = dry_run > 0;
    o->quiet = quiet > 0;
    if (!o->help && operands != 1) {
        return usage("a scenario file must be given", NULL);
    }
    return o->help || check_options(o, only, limit);
}

static void stage_options(struct run *run)
{
    struct options *o = &run->options;
    stance_message message;
    bool good = false;

    o->sets = malloc((size_t)run->argc * sizeof *o->sets);
    if (!o->sets) {
        fail(run, EXIT_IO, "stance run: not enough memory");
    }
    /* Rank 0 first: it says what is wrong, and the others need not. */
    if (run->parallel.rank == 0 && o->sets) {
        good = read_options(o, run->argc, run->argv);
    }
    parallel_broadcast(&run->parallel, &good, sizeof good);
    if (!good) {
        run->failure.code = run->failure.code ? run->failure.code : EXIT_USAGE;
        return;
    }
    bool help = o->help;
    parallel_broadcast(&run->parallel, &help, sizeof help);
    if (run->parallel.rank != 0 && !help && o->sets) {
        read_options(o, run->argc, run->argv);
    }
    o->help = help;
    deadline_limit(o->time_limit - (plan_clock() - run->start));
    if (!help && !instruction_set_check(&message)) {
        snprintf(run->failure.text, sizeof run->failure.text, "stance run: %s", message.text);
        run->failure.code = EXIT_USAGE;
    }
}

/* ---- the scenario ------------------------------------------------------------------------- */

/* Rank 0 reads the file; the others read the text that it resolved to. */
static void stage_scenario(struct run *run)
{
    struct options *o = &run->options;
    uint64_t length = 0;
    FILE *nowhere = fopen("/dev/null", "w");

    run->scenario = calloc(1, sizeof *run->scenario);
    if (run->parallel.rank == 0 && run->scenario) {
        if (scenario_read(run->scenario, o->scenario, NULL, o->sets, o->set_count, stderr)) {
            length = strlen(run->scenario->text) + 1;
        } else {
            /* The reader has printed why. */
            run->failure.code = access(o->scenario, R_OK) == 0 ? EXIT_USAGE : EXIT_IO;
        }
    }
    parallel_broadcast(&run->parallel, &length, sizeof length);
    if (run->parallel.rank != 0 && length > 0) {
        char *text = malloc(length);
        if (!text) {
            abort(); /* the others wait in the broadcast: MPI ends the job */
        }
        parallel_broadcast(&run->parallel, text, length);
        if (!run->scenario || !nowhere ||
            !scenario_read(run->scenario, o->scenario, text, NULL, 0, nowhere)) {
            free(run->scenario);
            run->scenario = NULL;
            fail(run, EXIT_IO, "stance run: a rank cannot read the scenario that rank 0 reads");
        }
        free(text);
    } else if (length > 0) {
        parallel_broadcast(&run->parallel, run->scenario->text, length);
    } else {
        free(run->scenario);
        run->scenario = NULL;
    }
    if (nowhere) {
        fclose(nowhere);
    }
    if (run->scenario && o->single && o->single_case >= run->scenario->cases) {
        snprintf(run->failure.text, sizeof run->failure.text,
                 "stance run: --only %" PRIu64 ": the scenario's cases are 0 ... %" PRIu64,
                 o->single_case, run->scenario->cases - 1);
        run->failure.code = EXIT_USAGE;
    }
}

/* ---- the file ----------------------------------------------------------------------------- */

static void name_file(struct run *run)
{
    const struct options *o = &run->options;
    if (o->output) {
        if (snprintf(run->file, sizeof run->file, "%s", o->output) >= (int)sizeof run->file - 8) {
            fail(run, EXIT_IO, "stance run: the name of the results file is too long");
        }
    } else if (o->single) {
        snprintf(run->file, sizeof run->file, "results/%s-case%" PRIu64 ".h5", run->scenario->name,
                 o->single_case);
    } else {
        snprintf(run->file, sizeof run->file, "results/%s.h5", run->scenario->name);
    }
}

/* Refuses a file that was made from another scenario; says where they begin to differ. */
static bool same_scenario(struct run *run, const struct store_origin *origin)
{
    const char *old = origin->scenario, *new = run->scenario->text;
    int line = 1;

    if (strcmp(old, new) == 0) {
        return true;
    }
    for (;;) {
        size_t a = strcspn(old, "\n"), b = strcspn(new, "\n");
        if (a != b || strncmp(old, new, a) != 0 || !old[a] || !new[b]) {
            snprintf(run->failure.text, sizeof run->failure.text,
                     "stance run: %.200s was made from another scenario: line %d of its resolved "
                     "text is '%.*s', now it is '%.*s'",
                     run->file, line, a < 90 ? (int)a : 90, old, b < 90 ? (int)b : 90, new);
            run->failure.code = EXIT_USAGE;
            return false;
        }
        old += a + 1;
        new += b + 1;
        line++;
    }
}

/* In a process of its own: see store_check. */
static int check_file(void *file)
{
    stance_message message = {""};
    supervise_limit(true);
    bool good = store_check(file, true, &message);
    supervise_limit(false);
    if (!good) {
        fprintf(stderr, "stance run: %s\n", message.text);
    }
    return good ? EXIT_DONE : EXIT_IO;
}

/* An existing file that is to be gone on with. */
static void look_into_file(struct run *run)
{
    struct store_origin origin;
    struct store_counts counts = {0};
    stance_message message = {""};

    run->failure.code = supervise(check_file, run->file, run->file);
    if (run->failure.code != EXIT_DONE) {
        return; /* it has been said why */
    }
    if (!store_read_origin(run->file, &origin, &message)) {
        fail_io(run, &message);
        return;
    }
    if (same_scenario(run, &origin)) {
        if (strcmp(origin.revision, build_revision()) != 0) {
            fprintf(stderr,
                    "stance run: warning: %s was begun by revision %s, this is %s: results may "
                    "differ\n",
                    run->file, origin.revision, build_revision());
        }
        for (int a = 0; a < run->scenario->axes; a++) {
            if (!store_read_axis(run->file, &run->scenario->axis[a], &message)) {
                fail_io(run, &message);
            }
        }
        if (!store_count(run->file, &counts, &message)) {
            fail_io(run, &message);
        }
    }
    store_origin_free(&origin);
    struct lock_note note = {(double)time(NULL), counts.done + counts.failed};
    lock_write_note(&run->lock, &note);
}

/* Rank 0: where the results go, whether they may, and nobody else writes there. */
static void claim_file(struct run *run)
{
    const struct options *o = &run->options;
    stance_message message = {""};
    struct stat information;
    bool exists = lstat(run->file, &information) == 0;

    if (exists && !o->force && !o->resume) {
        snprintf(run->failure.text, sizeof run->failure.text,
                 "stance run: %.400s exists; --force replaces it, --resume goes on with it",
                 run->file);
        run->failure.code = EXIT_IO;
        return;
    }
    if (exists && !S_ISREG(information.st_mode) && !S_ISLNK(information.st_mode)) {
        snprintf(message.text, sizeof message.text, "%.200s: not a regular file", run->file);
        fail_io(run, &message);
        return;
    }
    if (!o->output && mkdir("results", 0777) != 0 && errno != EEXIST) {
        snprintf(message.text, sizeof message.text, "cannot make the directory results: %s",
                 strerror(errno));
        fail_io(run, &message);
        return;
    }
    if (!lock_take(&run->lock, run->file, &message)) {
        fail_io(run, &message);
        return;
    }
    run->resume = exists && o->resume;
    run->replace = exists && o->force;
    if (run->resume) {
        look_into_file(run);
    }
}

static void stage_claim(struct run *run)
{
    name_file(run);
    if (run->parallel.rank == 0 && !run->options.dry_run && run->failure.code == EXIT_DONE) {
        claim_file(run);
    }
    parallel_broadcast(&run->parallel, &run->resume, sizeof run->resume);
}

/* ---- the plan ----------------------------------------------------------------------------- */

/* Points of logarithmic axes come from the C library and may differ between machines: every rank
 * takes those of rank 0, which has them from the file when the run is resumed. */
static void share_axes(struct run *run)
{
    for (int a = 0; a < run->scenario->axes; a++) {
        struct scenario_axis *axis = &run->scenario->axis[a];
        if (axis->log) {
            parallel_broadcast(&run->parallel, axis->value, axis->count * sizeof *axis->value);
        }
    }
}

static void stage_plan(struct run *run)
{
    struct plan_error error = {0};
    const struct options *o = &run->options;

    share_axes(run);
    if (!plan_make(&run->plan, run->scenario, o->single, o->single_case, o->trace, &error)) {
        fail_scenario(run, &error);
    }
}

static void stage_designs(struct run *run)
{
    struct plan_error error = {0};
    bool good = true;

    if (run->resume) {
        return; /* they are in the file */
    }
    good = plan_compute_designs(&run->plan, &run->parallel, &error);
    if (good && run->parallel.rank == 0) {
        good = plan_check_cases(&run->plan, &error);
    }
    if (!good) {
        fail_scenario(run, &error);
    } else if (run->options.dry_run && run->parallel.rank == 0) {
        report_plan(&run->plan, run->parallel.size, run->file, false, stdout);
    }
}

static bool out_of_time(void *context)
{
    const struct run *run = context;
    return work_stop_asked() || plan_clock() - run->start > run->options.time_limit;
}

/* Sets in which cases are captured, where the scenario asks for them. A stop meanwhile leaves no
 * file. */
static void stage_captures(struct run *run)
{
    stance_message message = {""};

    if (run->resume ||
        plan_estimate_captures(&run->plan, &run->parallel, out_of_time, run, &message)) {
        return;
    }
    if (message.text[0]) {
        fail_io(run, &message);
    } else {
        snprintf(run->failure.text, sizeof run->failure.text,
                 "stance run: stopped while captured sets were estimated: nothing is stored");
        run->failure.code = EXIT_INTERRUPTED;
    }
}

/* ---- computing ---------------------------------------------------------------------------- */

/* Names of the ranks' machines, each once, separated by commas; on rank 0. */
static char *collect_hosts(const struct parallel *parallel)
{
    enum { NAME = 64 };
    char name[NAME];
    size_t ranks = (size_t)parallel->size, used = 0;
    char *all = parallel->rank == 0 ? calloc(ranks, NAME) : NULL;
    char *list = parallel->rank == 0 ? calloc(ranks, NAME + 1) : NULL;

    if (parallel->rank == 0 && (!all || !list)) {
        abort(); /* the others wait in the gather: MPI ends the job */
    }
    parallel_host(name, sizeof name);
    parallel_gather(parallel, name, NAME, all);
    for (size_t r = 0; all && r < ranks; r++) {
        bool known = false;
        for (size_t q = 0; q < r && !known; q++) {
            known = strcmp(all + q * NAME, all + r * NAME) == 0;
        }
        if (!known) {
            used += (size_t)sprintf(list + used, "%s%s", used ? "," : "", all + r * NAME);
        }
    }
    free(all);
    return list;
}

static void stage_create(struct run *run)
{
    stance_message message = {""};
    if (run->resume) {
        return;
    }
    char *hosts = collect_hosts(&run->parallel);
    if (run->parallel.rank == 0) {
        if (run->replace && unlink(run->file) != 0) {
            snprintf(message.text, sizeof message.text, "cannot replace %.150s: %s", run->file,
                     strerror(errno));
            fail_io(run, &message);
        } else if (!store_create(run->file, &run->plan, run->parallel.size, hosts, &message)) {
            fail_io(run, &message);
        } else {
            struct lock_note note = {(double)time(NULL), 0};
            lock_write_note(&run->lock, &note);
        }
    }
    free(hosts);
}

static void stage_open(struct run *run)
{
    stance_message message = {""};
    if (!store_open(&run->store, run->file, &run->plan, run->parallel.size, &message) ||
        !store_read_designs(run->store, &run->plan, &message)) {
        fail_io(run, &message);
    }
}

static void stage_compute(struct run *run)
{
    stance_message message = {""};
    run->work = (struct work){
        .plan = &run->plan,
        .store = run->store,
        .resume = run->resume,
        .quiet = run->options.quiet,
        .start = run->start,
        .time_limit = run->options.time_limit,
    };
    if (!parallel_share(&run->parallel)) {
        fail(run, EXIT_IO, "stance run: not enough memory");
        return;
    }
    run->work.parallel = &run->parallel;
    const bool refined = run->scenario->refine.given && !run->plan.single;
    if (refined ? !rounds_run(&run->work, &message) : !work_run(&run->work, NULL, NULL, &message)) {
        fail_io(run, &message);
    }
}

/* Rank 0 stores how long each rank computed. */
static void stage_timing(struct run *run)
{
    stance_message message = {""};
    size_t ranks = (size_t)run->parallel.size;
    int64_t computed = (int64_t)run->work.computed;
    double *seconds = run->parallel.rank == 0 ? malloc(ranks * sizeof *seconds) : NULL;
    int64_t *cases = run->parallel.rank == 0 ? malloc(ranks * sizeof *cases) : NULL;

    if (run->parallel.rank == 0 && (!seconds || !cases)) {
        abort(); /* the others wait in the gather: MPI ends the job */
    }
    parallel_gather(&run->parallel, &run->work.seconds, sizeof *seconds, seconds);
    parallel_gather(&run->parallel, &computed, sizeof computed, cases);
    if (run->parallel.rank == 0 &&
        !store_add_timing(run->store, run->parallel.size, seconds, cases, &message)) {
        fail_io(run, &message);
    }
    free(seconds);
    free(cases);
}

static void stage_close(struct run *run)
{
    stance_message message = {""};
    struct store *store = run->store;

    run->store = NULL;
    if (!store_close(store, &message)) {
        fail_io(run, &message);
    } else if (run->parallel.rank == 0) {
        int descriptor = open(run->file, O_RDWR | O_CLOEXEC);
        if (descriptor < 0 || fsync(descriptor) != 0 || close(descriptor) != 0) {
            snprintf(message.text, sizeof message.text, "%.150s: cannot bring it to the disk: %s",
                     run->file, strerror(errno));
            fail_io(run, &message);
        }
    }
}

/* ---- the end ------------------------------------------------------------------------------ */

static void print_word(FILE *to, const char *word)
{
    if (word[strspn(word, "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789"
                          "_-+./,:=@%")] == '\0' &&
        word[0]) {
        fprintf(to, " %s", word);
        return;
    }
    fputs(" '", to);
    for (; *word; word++) {
        fputs(*word == '\'' ? "'\\''" : (const char[]){*word, '\0'}, to);
    }
    fputc('\'', to);
}

/* The command that goes on: the same one with --resume. */
static void print_interrupted(const struct run *run, uint64_t finished)
{
    char *line = NULL; /* in one piece: a launcher mixes what ranks write in pieces */
    size_t size = 0;
    FILE *to = open_memstream(&line, &size);
    if (!to) {
        return;
    }
    fprintf(to, "stance run: stopped at %" PRIu64 " of %" PRIu64 " cases; go on with:", finished,
            run->plan.rows);
    if (run->parallel.size > 1) {
        fprintf(to, " mpirun -n %d", run->parallel.size);
    }
    fprintf(to, " stance run");
    for (int i = 1; i < run->argc; i++) {
        if (strcmp(run->argv[i], "--force") != 0 && strcmp(run->argv[i], "--resume") != 0) {
            print_word(to, run->argv[i]);
        }
    }
    fputs(run->options.single ? " --force\n" : " --resume\n", to);
    if (fclose(to) == 0) {
        fputs(line, stderr);
    }
    free(line);
}

/* What came out, over all ranks. */
struct sums {
    uint64_t outcome[WORK_OUTCOMES], failed, finished, computed, inferred;
};

static void print_summary(const struct run *run, const struct sums *sums)
{
    static const char *const name[WORK_OUTCOMES] = {"without outcome", "stabilised", "fell",
                                                    "rested", "undecided"};
    double wall = plan_clock() - run->start;
    const char *separator = ": ";

    printf("%s: %" PRIu64 " case%s", run->file, sums->finished, sums->finished == 1 ? "" : "s");
    for (int i = 0; i < WORK_OUTCOMES; i++) {
        if (sums->outcome[i] > 0) {
            printf("%s%" PRIu64 " %s", separator, sums->outcome[i], name[i]);
            separator = ", ";
        }
    }
    if (sums->failed > 0) {
        printf("%s%" PRIu64 " failed", separator, sums->failed);
    }
    if (sums->inferred > 0) {
        printf("; %" PRIu64 " of them inferred", sums->inferred);
    }
    if (sums->computed + sums->inferred < sums->finished) {
        printf("; %" PRIu64 " of them computed now", sums->computed);
    }
    printf("; %.1f s on %d rank%s\n", wall, run->parallel.size, run->parallel.size == 1 ? "" : "s");
    fflush(stdout);
}

/* Adds up over the ranks and says what came out. */
static int conclude(struct run *run)
{
    const struct work *work = &run->work;
    struct sums sums = {.failed = work->failed,
                        .finished = work->finished,
                        .computed = work->computed,
                        .inferred = work->inferred};
    memcpy(sums.outcome, work->outcome, sizeof sums.outcome);
    parallel_sum(&run->parallel, (uint64_t *)&sums, sizeof sums / sizeof(uint64_t));
    bool complete = sums.finished == run->plan.rows;

    if (run->parallel.rank == 0) {
        if (!run->options.quiet) {
            print_summary(run, &sums);
        }
        if (!complete) {
            print_interrupted(run, sums.finished);
        } else if (sums.failed > 0) {
            fprintf(stderr,
                    "stance run: %" PRIu64
                    " case%s failed; the variable `failure` in %s says why\n",
                    sums.failed, sums.failed == 1 ? "" : "s", run->file);
        }
    }
    return !complete ? EXIT_INTERRUPTED : sums.failed > 0 ? EXIT_CASES_FAILED : EXIT_DONE;
}

/* Goes through the stages; stops where one failed on any rank. */
static int go_through(struct run *run)
{
    static void (*const stage[])(struct run *) = {
        stage_options, stage_scenario, stage_claim,   stage_plan,   stage_designs, stage_captures,
        stage_create,  stage_open,     stage_compute, stage_timing, stage_close,
    };
    for (size_t i = 0; i < sizeof stage / sizeof stage[0]; i++) {
        stage[i](run);
        if (!parallel_agree(&run->parallel, run->failure.code == EXIT_DONE, (char *)&run->failure,
                            sizeof run->failure)) {
            if (run->parallel.rank == 0 && run->failure.text[0]) {
                fprintf(stderr, "%s\n", run->failure.text);
            }
            return run->failure.code;
        }
        if (stage[i] == stage_options && run->options.help) {
            return EXIT_DONE;
        }
        if (stage[i] == stage_designs && run->options.dry_run) {
            return EXIT_DONE;
        }
    }
    return conclude(run);
}

static int run_run(int argc, char **argv)
{
    struct run *run = calloc(1, sizeof *run);
    if (!run) {
        fprintf(stderr, "stance run: not enough memory\n");
        return EXIT_IO;
    }
    bool first;
    if (parallel_misses_launcher(&first)) {
        if (first) {
            fprintf(stderr, "stance run: srun started several of these without an MPI that joins "
                            "them: use mpirun, or srun --mpi=pmix\n");
        }
        free(run);
        return EXIT_USAGE;
    }
    store_prepare();
    run->argc = argc;
    run->argv = argv;
    run->start = plan_clock();
    run->lock.descriptor = -1;
    run->parallel = parallel_start();
    run->parallel.leave = out_of_time;
    run->parallel.context = run;
    if (run->parallel.size > 1) {
        deadline_prepare(run->parallel.rank);
    }
    work_catch_signals();
    int code = go_through(run);
    store_abandon(run->store);
    plan_free(&run->plan);
    if (run->scenario) {
        scenario_free(run->scenario);
    }
    lock_release(&run->lock);
    parallel_finish(&run->parallel);
    free(run->options.sets);
    free(run->scenario);
    free(run);
    return code;
}

const struct command command_run = {
    "run",
    "run SCENARIO [-o FILE] [--set PATH=VALUE]... [--force | --resume]\n"
    "           [--time-limit TIME] [--only CASE [--trace]] [--dry-run] [--quiet]",
    "compute every case of a scenario; alone or under mpirun -n N",
    run_run,
    "  -o FILE            results file; default results/<scenario name>.h5 (one case: with\n"
    "                     -case<N>). An existing file is left alone and the exit code is 3\n"
    "  --set PATH=VALUE   replace a value of the scenario; may be repeated\n"
    "  --force            replace the file of that name, whatever it holds; of a symbolic link\n"
    "                     the link, not the file that it names\n"
    "  --resume           go on with an existing file of the same scenario: cases that it holds\n"
    "                     whole, as their checksums say, are kept. Begins when there is no file\n"
    "  --time-limit TIME  stop after 90s, 55m, 1h30m ... of wall time; resumable\n"
    "  --only CASE        compute one case of the sweep, by its flat index, to a file of its own\n"
    "  --trace            ... and record its trajectory, each 0.01 s unless record.every says\n"
    "  --dry-run          plan and estimate, write nothing\n"
    "  --quiet            neither progress nor summary\n"
    "\n"
    "SIGINT, SIGTERM and SIGUSR1 stop at once: cases in hand are given up, what has ended is\n"
    "written; mpirun forwards SIGUSR1 but kills its ranks soon after SIGINT or SIGTERM. Exit\n"
    "codes: 0 done, 1 some cases failed, 2 bad use or scenario, 3 input or output, 4 stopped and\n"
    "resumable.\n",
};
