/* deadline.h - the latest end of one rank of several: when it has been told to stop, or waits for a
 * machine that is gone.
 *
 * A rank that stops writes what has ended and then meets the others, who may never come: their
 * machine is cut off or frozen. One that asks a counter on rank 0's machine may wait as long. MPI
 * has no way out of such waits, so a timer looks each second, and ends the process. What it has in
 * hand is written first.
 */
#ifndef STANCE_RANKS_DEADLINE_H
#define STANCE_RANKS_DEADLINE_H

#include <stdbool.h>

enum {
    DEADLINE_PATIENCE = 30, /* s, with ranks that were told to stop as this one was */
    DEADLINE_LOST = 300,    /* s, until a machine that says nothing is taken for lost */
    DEADLINE_START = 600,   /* s, until MPI, which has not started on all ranks, never will */
};

/* From `begin` on until MPI has started, and looks after that itself: the process leaves when its
 * launcher dies, or MPI takes too long. (A rank whose launcher dies waits in MPI_Init for ever, in
 * PMIx, Open MPI 4, and now and then all do when some are killed while the launcher starts them.)
 */
void deadline_launch(bool begin);

/* For this process, one of several ranks: when its time has come, one line on standard error and
 * exit code EXIT_INTERRUPTED. Without this call, as for a single rank, it never comes. */
void deadline_prepare(int rank);

/* Told to stop: the time comes DEADLINE_PATIENCE from now, whatever was set before. May be called
 * from a signal handler. */
void deadline_begin(void);

/* The time comes DEADLINE_PATIENCE after the time limit, `seconds` from now (INFINITY: never). */
void deadline_limit(double seconds);

/* From now to deadline_comes this rank waits within MPI for rank 0's machine, DEADLINE_LOST at
 * most (parallel_add). */
void deadline_waits(void);
void deadline_comes(void);

/* Should this rank have to leave while it waits so, rescue(context) is called first, from a signal
 * handler that interrupted MPI alone: it may do what takes neither MPI nor more than a few seconds.
 * NULL: nothing any more. */
void deadline_rescue(void (*rescue)(void *context), void *context);

#endif
