/* work.h - the computing part of a run: every rank draws chunks of cases, has the engine run
 * them, and writes what came out, until nothing is left or the job is told to stop.
 */
#ifndef STANCE_RUNNER_WORK_H
#define STANCE_RUNNER_WORK_H

#include "plan.h"
#include "store.h"

enum { WORK_OUTCOMES = STANCE_UNDECIDED + 1 };

/* Rows in ascending order. */
struct work_rows {
    const uint64_t *row;
    size_t count;
};

struct work {
    const struct plan *plan;
    struct store *store;
    const struct parallel *parallel; /* with shared counters */
    bool resume;                     /* rows that the file holds whole are kept */
    bool quiet;                      /* no progress */
    double start;                    /* plan_clock() when the program began */
    double time_limit;               /* s since then, INFINITY: none */
    const struct work_rows *only;    /* what is to be computed; NULL: every row of the plan */
    uint8_t *label; /* [only->count], or NULL: filled in for the rows that this rank has dealt with,
                     * outcome + 1, or WORK_OUTCOMES + 1 for failed */
    int round;      /* of several, counted from 1, for the progress; 0: there is one only */
    double progress_due; /* when to show it next; 0: not shown yet */

    /* What came out, for this rank's cases. */
    uint64_t finished; /* cases with an answer in the file, kept ones included */
    uint64_t computed; /* of these, now */
    uint64_t inferred; /* of these, without simulation */
    uint64_t outcome[WORK_OUTCOMES], failed;
    double seconds;
};

/* From now on SIGINT, SIGTERM and SIGUSR1 ask for a stop after the slice in hand. A second SIGINT
 * kills. */
void work_catch_signals(void);

/* Whether a signal has asked for a stop. */
bool work_stop_asked(void);

/* Counts a case whose answer is in the file. */
void work_tally(struct work *work, const stance_result *result);

/* Whether to stop before something that will take about `expected` seconds: for a signal, the time
 * limit, or because another rank was told so. The others learn of it. */
bool work_told_to_stop(const struct work *work, double expected);

/* Not collective, but every rank calls it. Leaves early when any rank fails, or is told to stop;
 * false when this rank failed. */
bool work_run(struct work *work, stance_message *message);

#endif
