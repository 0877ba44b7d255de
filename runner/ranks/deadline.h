/* deadline.h - the latest end of one rank of several that has been told to stop.
 *
 * A rank that stops writes what has ended and then meets the others, who may never come: their
 * machine is cut off or frozen. MPI has no way out of such a wait, so an alarm ends the process.
 * One that waits for a counter of a rank 0 that is gone leaves so, too; it loses what has ended
 * since its last write, a second or so.
 */
#ifndef STANCE_RANKS_DEADLINE_H
#define STANCE_RANKS_DEADLINE_H

/* For this process, one of several ranks: when an alarm rings, one line on standard error and exit
 * code EXIT_INTERRUPTED. Without this call, as for a single rank, no alarm is ever set. */
void deadline_prepare(int rank);

/* Told to stop: the alarm rings DEADLINE_PATIENCE seconds from now, whatever was set before. May be
 * called from a signal handler. */
void deadline_begin(void);

/* The alarm rings DEADLINE_PATIENCE after the time limit, `seconds` from now (INFINITY: never). */
void deadline_limit(double seconds);

enum { DEADLINE_PATIENCE = 30 };

#endif
