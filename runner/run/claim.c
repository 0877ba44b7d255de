/* claim.c - what commands that write a file on many ranks have in common (run.h): ranks, options,
 * the scenario on every rank, the file for this job alone, stages, and how to go on. */
#include "run.h"

#include "runner/base/sandbox.h"
#include "runner/plan/instruction_set.h"
#include "runner/plan/law.h"
#include "runner/ranks/crash.h"
#include "runner/store/build_info.h"

#include <errno.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

bool run_fail_io(struct run *run)
{
    return run_fail(run, EXIT_IO, "stance %s: %s", run->argv[0], run->message.text);
}

bool run_take_options(struct run *run, const struct command *command)
{
    const struct parallel *parallel = &run->parallel;
    struct options *o = &run->options;
    /* Rank 0 first, which says what is wrong; the others need not. */
    int code =
        parallel->rank == 0 ? command_begin(command, run->argc, run->argv, o) : COMMAND_GOES_ON;
    parallel_broadcast(parallel, &code, sizeof code);
    if (code == COMMAND_GOES_ON && parallel->rank != 0)
        code = command_begin(command, run->argc, run->argv, o);
    run->over = code == EXIT_DONE; /* help */
    if (code > 0)
        run->failure.code = code; /* it has been said why */
    deadline_limit(o->time_limit - (clock_seconds() - run->start));
    if (code == COMMAND_GOES_ON && !instruction_set_check(&run->message))
        run_fail(run, EXIT_USAGE, "stance %s: %s", run->argv[0], run->message.text);
    return code == COMMAND_GOES_ON;
}

struct scenario *run_read_scenario(struct run *run, size_t sets)
{
    const struct asked *const asked = &run->options.asked;
    struct scenario *const s = scenario_new(asked->file, NULL, asked->sets.text, sets, stderr);
    if (!s) /* the reader has printed why */
        run->failure.code = access(asked->file, R_OK) == 0 ? EXIT_USAGE : EXIT_IO;
    return s;
}

/* A law of the user's own: rank 0 asks whether it is trusted and compiles it, the others take it
 * from the cache, or compile it where that is another machine's. */
static bool take_law(struct run *run)
{
    stance_message message;
    enum law_state state = LAW_NONE;
    if (run->parallel.rank == 0)
        state = law_take(run->scenario, run->options.asked.trust ? LAW_TRUST : LAW_ASK, &message);
    parallel_broadcast(&run->parallel, &state, sizeof state);
    if (run->parallel.rank > 0 && run->scenario && state == LAW_READY)
        state = law_take(run->scenario, LAW_ASKED, &message);
    if (state == LAW_BROKEN && run->failure.code == EXIT_DONE)
        run_fail(run, EXIT_USAGE, "%s", message.text);
    if (state == LAW_UNTRUSTED && !run->options.dry_run && run->parallel.rank == 0)
        run_fail(run, EXIT_USAGE, "%.300s: %s", run->scenario->file, message.text);
    return state != LAW_BROKEN && (state != LAW_UNTRUSTED || run->options.dry_run);
}

bool run_share_scenario(struct run *run)
{
    const struct parallel *parallel = &run->parallel;
    uint64_t length = run->scenario ? strlen(run->scenario->text) + 1 : 0;
    parallel_broadcast(parallel, &length, sizeof length);
    if (length == 0)
        return false;
    char *const text = parallel->rank == 0 ? run->scenario->text : malloc(length);
    if (!text)
        abort(); /* the others wait in the broadcast: MPI ends the job */
    parallel_broadcast(parallel, text, length);
    if (parallel->rank > 0) {
        run->scenario = scenario_new(run->options.asked.file, text, NULL, 0, NULL);
        free(text);
    }
    if (!run->scenario)
        run_fail(run, EXIT_IO, "stance %s: a rank cannot read the scenario that rank 0 reads",
                 run->argv[0]);
    return take_law(run) && run->scenario;
}

struct check {
    const struct run *run;
    bool (*check)(const char *file, stance_message *message);
    const char *file;
};

static int check_alone(void *context)
{
    const struct check *check = context;
    stance_message message = {""};
    sandbox_limit(true);
    bool good = check->check(check->file, &message);
    sandbox_limit(false);
    if (!good)
        fprintf(stderr, "stance %s: %s\n", check->run->argv[0], message.text);
    return good ? EXIT_DONE : EXIT_IO;
}

int run_check_file(const struct run *run, bool (*check)(const char *, stance_message *),
                   const char *file)
{
    struct check context = {run, check, file};
    return sandbox(check_alone, &context, file);
}

bool run_check_results(const char *file, stance_message *message)
{
    return store_check(file, true, message);
}

void run_warn_of_revision(const struct run *run, const char *file, const char *revision)
{
    if (strcmp(revision, build_revision) != 0) {
        fprintf(stderr,
                "stance %s: warning: %s was begun by revision %s, this is %s: results may "
                "differ\n",
                run->argv[0], file, revision, build_revision);
    }
}

bool run_claim_file(struct run *run, bool *exists)
{
    const struct options *o = &run->options;
    const char *const file = run->file;
    stance_message *const message = &run->message;
    struct stat information;

    *exists = lstat(file, &information) == 0;
    bool good =
        !*exists || o->force || o->resume ||
        complain(message, "%.150s exists; --force replaces it, --resume goes on with it", file);
    if (good && *exists && !S_ISREG(information.st_mode) && !S_ISLNK(information.st_mode))
        good = complain(message, "%.200s: not a regular file", file);
    if (good && !o->output && mkdir("results", 0777) != 0 && errno != EEXIST)
        good = complain(message, "cannot make the directory results: %s", strerror(errno));
    /* A link that is replaced is a file of its own; through others the file they name is written.
     */
    if (!good || !lock_take(&run->lock, file, !o->force, message))
        return run_fail_io(run);
    return heartbeat_begin(&run->heartbeat, &run->lock, &run->parallel, "starting") ||
           run_fail(run, EXIT_IO, "stance %s: not enough memory", run->argv[0]);
}

/* ---- how to go on --------------------------------------------------------------------------- */

static void print_word(FILE *to, const char *word)
{
    if (word[strspn(word, "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789"
                          "_-+./,:=@%")] == '\0' &&
        word[0]) {
        fprintf(to, " %s", word);
        return;
    }
    fputs(" '", to);
    for (; *word; word++)
        fputs(*word == '\'' ? "'\\''" : (const char[]){*word, '\0'}, to);
    fputc('\'', to);
}

void run_say_stopped(const struct run *run, const char *what)
{
    char *line = NULL; /* in one piece: a launcher mixes what ranks write in pieces */
    size_t size = 0;
    FILE *to = run->parallel.rank == 0 ? open_memstream(&line, &size) : NULL;
    if (!to)
        return;
    fprintf(to, "stance %s: %s; go on with:", run->argv[0], what);
    if (run->parallel.size > 1)
        fprintf(to, " mpirun -n %d", run->parallel.size);
    print_word(to, program_invocation_name);
    for (int i = 0; i < run->argc; i++)
        if (strcmp(run->argv[i], "--force") != 0 && strcmp(run->argv[i], "--resume") != 0)
            print_word(to, run->argv[i]);
    fprintf(to, " %s\n", run->options.single ? "--force" : "--resume");
    if (fclose(to) == 0)
        fputs(line, stderr);
    free(line);
}

/* ---- signals that ask for a stop, see work.h ------------------------------------------------ */

static volatile sig_atomic_t stop_asked;

static void ask_stop(int number)
{
    (void)number;
    stop_asked = 1;
    deadline_begin();
}

void work_catch_signals(void)
{
    struct sigaction action = {.sa_handler = ask_stop, .sa_flags = SA_RESTART};
    sigemptyset(&action.sa_mask);
    sigaction(SIGTERM, &action, NULL);
    sigaction(SIGUSR1, &action, NULL);
    action.sa_flags |= SA_RESETHAND;
    sigaction(SIGINT, &action, NULL);
}

bool work_stop_asked(void)
{
    return stop_asked != 0;
}

/* ---- the whole ------------------------------------------------------------------------------ */

/* The ranks of the job, which from now on attend to signals and say where they crash. false: a
 * launcher started several processes that are no ranks of each other; the first one says so. */
static bool take_ranks(struct run *run)
{
    bool first;
    if (parallel_misses_launcher(&first)) {
        if (first)
            fprintf(stderr,
                    "stance %s: srun started several of these without an MPI that joins them: use "
                    "mpirun, or srun --mpi=pmix\n",
                    run->argv[0]);
        return false;
    }
    store_prepare();
    run->parallel = parallel_start();
    crash_watch(run->parallel.rank);
    if (run->parallel.size > 1)
        deadline_prepare();
    work_catch_signals();
    return true;
}

/* Goes through the stages; stops where one failed on any rank. */
static int go_through(struct run *run, const struct stage *stage, int (*conclude)(struct run *))
{
    for (; stage->go; stage++) {
        crash_stage(stage->doing);
        run->heartbeat.doing = stage->doing;
        run->heartbeat.due = 0;
        run->progress = progress_begin(run->options.quiet);
        stage->go(run);
        progress_end(&run->progress);
        if (!parallel_agree(&run->parallel, run->failure.code == EXIT_DONE, (char *)&run->failure,
                            sizeof run->failure)) {
            if (run->parallel.rank == 0 && run->failure.text[0])
                fprintf(stderr, "%s\n", run->failure.text);
            return run->failure.code;
        }
        if (run->over)
            return EXIT_DONE;
    }
    return conclude(run);
}

int run_through(struct run *run, int argc, char **argv, const struct stage *stages,
                int (*conclude)(struct run *))
{
    if (!run) {
        fprintf(stderr, "stance %s: not enough memory\n", argv[0]);
        return EXIT_IO;
    }
    run->argc = argc;
    run->argv = argv;
    run->start = clock_seconds();
    run->lock.descriptor = run->old_lock.descriptor = -1;
    run->parallel = parallel_alone();
    return take_ranks(run) ? go_through(run, stages, conclude) : EXIT_USAGE;
}

void run_end(struct run *run)
{
    scenario_drop(run->scenario);
    lock_release(&run->lock);
    lock_release(&run->old_lock);
    heartbeat_end(&run->heartbeat);
    parallel_finish(&run->parallel);
}
