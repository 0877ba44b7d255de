/* work.h - the computing part of a run: every rank draws chunks of cases, has the engine run
 * them, and writes what came out, until nothing is left or the job is told to stop.
 *
 * Memory is bounded whatever the number of cases: a block of rows (2 MB at most, as a rule) for
 * each lane and one more, and the trajectories of the cases in the lanes.
 */
#ifndef STANCE_RUN_WORK_H
#define STANCE_RUN_WORK_H

#include "heartbeat.h"

#include "runner/base/progress.h"
#include "runner/base/units.h"
#include "runner/plan/kernels.h"
#include "runner/plan/plan.h"
#include "runner/plan/schedule.h"
#include "runner/store/store.h"

enum { WORK_FAILED = STANCE_OUTCOME_COUNT + 1, WORK_NAMED = 5 };

struct work {
    const struct plan *plan;
    struct store *store;
    const struct parallel *parallel; /* with shared counters */
    struct kernels *kernels;         /* of which some come later; may be NULL */
    bool resume;                     /* rows that the file holds whole are kept */
    bool quiet;                      /* no progress */
    double start;                    /* clock_seconds() when the program began */
    double time_limit;               /* s since then, INFINITY: none */
    struct heartbeat *heartbeat;     /* on rank 0, may be NULL: signs of life of the job */
    /* Where `store` is NULL: is told what came out. The others may be NULL: whether a row is
     * computed; what is called about every millisecond and may say to stop. */
    void (*ends)(void *context, uint64_t row, const stance_result *result);
    bool (*takes)(void *context, uint64_t row);
    bool (*attend)(void *context, double now);
    void *context;
    uint64_t cycle; /* rows that are so many apart meet the same random numbers; 0: none */
    int round;      /* of several, counted from 1, for the progress; 0: there is one only */
    struct progress progress; /* all 0: not begun */

    /* What came out, for this rank's cases. */
    struct work_sums {
        uint64_t outcome[STANCE_OUTCOME_COUNT], failed;
        uint64_t finished; /* cases with an answer in the file, kept ones included */
        uint64_t computed; /* of these, now */
        uint64_t inferred; /* of these, now and without simulation */
        uint64_t damaged;  /* marked as done, but they do not verify: they are computed again */
    } sums;
    uint64_t damaged_case[WORK_NAMED]; /* the lowest of these, each as ~index; 0: none */
    double seconds;
    int64_t beats;   /* this rank's sign of life */
    uint64_t before; /* cases that all ranks have computed in earlier rounds, on rank 0 */
};

/* From now on SIGINT, SIGTERM and SIGUSR1 ask for a stop: cases in hand are given up, what has
 * ended is written. A second SIGINT kills. */
void work_catch_signals(void);

/* Whether a signal has asked for a stop. */
bool work_stop_asked(void);

/* Whether to stop: for a signal, the time limit, or because another rank was told so. The others
 * learn of it. */
bool work_told_to_stop(const struct work *work);

/* Counts a case whose answer is in the file, or will be. */
void work_tally(struct work *work, stance_status status, stance_outcome outcome);

/* store_verify for a resumed run: counts what is damaged. */
bool work_verify(struct work *work, const struct rows *rows, struct store_found *found,
                 stance_message *message);

/* Collective: computes all rows of the plan, or `only` some, the same on every rank, with counters
 * that are new (parallel_share, parallel_restart); returns when every rank has done its part.
 * Leaves early when any rank fails, is told to stop, or the file is gone; false when this rank
 * failed. What came out adds to what *work holds. label[rows], unless NULL: of each row that this
 * rank has dealt with, outcome + 1, or WORK_FAILED. */
bool work_run(struct work *work, const struct rows *only, uint8_t *label, stance_message *message);

/* refinement_run.c: a map by refinement, rounds of cases, each chosen by the labels of those
 * before.
 *
 * Collective. For a plan whose scenario asks for refinement (refine.h), all of it: computes round
 * after round, then writes what the other cases are inferred to be. Every rank keeps the labels of
 * the whole map. A resumed run goes through the same rounds and keeps the rows that the file holds
 * whole. Leaves early as work_run does; false when any rank failed. */
bool refinement_run(struct work *work, stance_message *message);

#endif
