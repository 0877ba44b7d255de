/* run.h - what the parts of `stance run` share: run.c (the stages) and run_end.c (what is said at
 * the end). */
#ifndef STANCE_RUNNER_RUN_H
#define STANCE_RUNNER_RUN_H

#include "lock.h"
#include "work.h"

struct options {
    const char *scenario, *output; /* output NULL: the default */
    const char **sets;
    size_t set_count;
    bool force, force_scenario, resume, single, trace, dry_run, quiet, help;
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
    bool resume, replace;       /* the file exists and is gone on with, or replaced */
    bool succeed;               /* ... gone on with by this scenario, which is not its own */
    struct store_origin origin; /* of a file that is gone on with; on rank 0 */
    struct lock lock;
    struct pulse pulse; /* on rank 0, once the lock is taken */
    struct plan plan;
    struct store *store;
    struct work work;
    struct failure failure; /* of this rank */
    double start, look_at;  /* of plan_clock(): the beginning, the next look at the counters */
};

/* On rank 0: that the run stopped, and the command that goes on with it. */
void run_say_stopped(const struct run *run, const char *what);
/* Collective: adds up over the ranks, says what came out, and returns the exit code. */
int run_conclude(struct run *run);

#endif
