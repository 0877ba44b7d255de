/* run.h - what the parts of `stance run` share: run.c (the stages, what is said at the end),
 * run_options.c, old.c (the file there was), and claim.c, whose functions `stance optimise` shares,
 * too. */
#ifndef STANCE_RUN_RUN_H
#define STANCE_RUN_RUN_H

#include "work.h"

#include "runner/base/command.h"
#include "runner/base/message.h"
#include "runner/base/units.h"
#include "runner/plan/asked.h"
#include "runner/plan/kernels.h"
#include "runner/store/adopt.h"
#include "runner/store/lock.h"

struct options {
    struct asked asked;
    const char *output; /* NULL: the default */
    const char *ending; /* ... of which the name ends so, before .h5; NULL: in nothing more */
    bool force, force_scenario, resume, trace, dry_run, quiet;
    bool single; /* --only, of this case */
    uint64_t single_case;
    struct shard shard;     /* count 0: none */
    const char *shard_word; /* of --shard, as given */
    char shard_name[SHARD_TEXT];
    double time_limit;     /* s, INFINITY: none */
    uint64_t extend_count; /* --extend; 0: not given */
    char extend_set[64];   /* the same as the --set that it stands for */
    const char *from;      /* NULL: the default */
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
    bool over;            /* all is done: help, --dry-run */
    bool resume, replace; /* the file exists and is gone on with, or replaced */
    bool warned;          /* something was wrong with the designs; on rank 0 */
    bool succeed;         /* ... gone on with by this scenario, which is not its own */
    struct adopted old;   /* on rank 0: the file that is gone on with, or --extend's */
    char old_file[1024];  /* ... its name */
    struct lock lock, old_lock;
    struct heartbeat heartbeat; /* on rank 0, once the lock is taken */
    struct plan plan;
    struct kernels kernels;
    struct store *store;
    struct progress progress; /* of stages before cases are computed */
    struct work work;
    stance_message message; /* what others say of a failure */
    struct failure failure; /* of this rank */
    double start, look_at;  /* of clock_seconds(): the beginning, the next look at the counters */
};

/* run_options.c: a stage. */
void run_stage_options(struct run *run);

/* What ends the run, in a line (run, code, format, ...). Returns false. */
#define run_fail(run, exit_code, ...)                                                              \
    (snprintf((run)->failure.text, sizeof(run)->failure.text, __VA_ARGS__),                        \
     (run)->failure.code = (exit_code), as_false())
/* With run->message. */
bool run_fail_io(struct run *run);
/* Exit code of a look into a file, in a process of its own; says what is wrong. */
int run_check_file(const struct run *run, bool (*check)(const char *, stance_message *),
                   const char *file);
bool run_check_results(const char *file, stance_message *message);
void run_warn_of_revision(const struct run *run, const char *file, const char *revision);

/* ---- what `stance optimise`, which is such a command, too, shares --------------------------- */

/* A command goes through its stages, one without `go` is the last, and ends with what is said at
 * the end, unless one failed or it is over. Before that begins, *run is all 0. Returns the exit
 * code. `run` NULL: no memory. */
struct stage {
    void (*go)(struct run *);
    const char *doing;
};
int run_through(struct run *run, int argc, char **argv, const struct stage *stages,
                int (*conclude)(struct run *));
void run_end(struct run *run);
/* Collective: command_begin(). Whether the command goes on. */
bool run_take_options(struct run *run, const struct command *command);
/* The scenario that is asked for, with the first of its --set; NULL: fails. */
struct scenario *run_read_scenario(struct run *run, size_t sets);
/* Collective: rank 0's scenario is read from its text by the others. false: it has none, or this
 * rank cannot, and fails; then there is none. */
bool run_share_scenario(struct run *run);
/* The name of the file, of the scenario's unless -o gives it; fails where it is too long. */
void run_name_file(struct run *run);
/* Rank 0: the file may be written, --force replaces one that exists, --resume goes on with it, and
 * nobody else writes it: the lock is taken, signs of life are given. Without -o its directory is
 * `results`, which is made. */
bool run_claim_file(struct run *run, bool *exists);

/* old.c, on rank 0, each fails where that cannot be. What --resume goes on with, or --extend from
 * (which is locked): whether it is of the scenario, which takes over its axes. */
bool run_old_open(struct run *run);
/* Whether a scenario can be extended. */
bool run_extend_check(struct run *run, const struct scenario *s);
/* The old file's designs into the plan, where it takes rows over; makes the file of its rows. */
bool run_old_designs(struct run *run);
void run_old_rows(struct run *run, const char *hosts);
/* A stop before there is a file. */
void run_stop_early(struct run *run, const char *what);

/* On rank 0: that the run stopped, and the command that goes on with it. */
void run_say_stopped(const struct run *run, const char *what);

/* Ends one, which can be released. */
void run_drop(struct run *run);
/* The whole of `stance run`, with options that a first stage reads; *run is all 0 before, and is
 * for run_drop after. */
int run_all(struct run *run, int argc, char **argv, void (*stage_options)(struct run *));

/* report.c: what `check` and `run --dry-run` print about a plan that has its designs. `file`: where
 * the results would go. What is very much is said on standard error, by `who`. */
void report_plan(const struct plan *plan, int ranks, const char *file, bool json, const char *who);

extern const struct command command_run; /* run_options.c */
int run_run(int argc, char **argv);

#endif
