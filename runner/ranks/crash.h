/* crash.h - last words of a rank that ends before its work does: which one, where, and why.
 *
 * It crashes: the handler calls nothing but write(2) and sigaction(2), on a stack of its own; what
 * it says is kept ready here as the work goes on. Afterwards the signal goes to whoever had it
 * before (Open MPI prints where the program stood), so that the process still dies of it and the
 * launcher ends the job. A process that is killed (SIGKILL, also for want of memory) says nothing:
 * its launcher does.
 *
 * Or, one of several, its time has come: it has been told to stop, or waits for a machine that is
 * gone. A rank that stops writes what has ended and then meets the others, who may never come:
 * their machine is cut off or frozen. One that asks a counter on rank 0's machine may wait as long.
 * MPI has no way out of such waits, so a timer looks each second, and ends the process. What it has
 * in hand is written first.
 */
#ifndef STANCE_RANKS_CRASH_H
#define STANCE_RANKS_CRASH_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* From now on SIGSEGV, SIGBUS, SIGFPE, SIGILL and SIGABRT are announced. After MPI has started. */
void crash_watch(int rank);

/* What this rank is doing ("computing designs"), while it has no case in hand; a constant. */
void crash_stage(const char *doing);

/* A case comes into hand; returns its place, for crash_leave. More than there is room for are not
 * named. */
int crash_take(uint64_t index);
void crash_leave(int place);

/* A law of the user's own that is at work, in this process: its crash is told as its own, and so is
 * a call that does not return within CRASH_PATIENCE seconds of this process's time. */
enum { CRASH_PATIENCE = 10 };
struct crash_law {
    const char *volatile file; /* NULL: none is */
    volatile uint64_t index;   /* of the case */
    volatile uint64_t calls;
};
/* From now on; crash_watch need not have been called. */
struct crash_law *crash_law_watch(void);
static inline void crash_law_begins(struct crash_law *law, const char *file, uint64_t index)
{
    law->calls++;
    law->index = index;
    law->file = file;
}
/* It did what nobody can go on after: ends the process with one line, "the law FILE WHAT in case
 * N".
 */
__attribute__((noreturn)) void crash_law_fault(const char *file, const char *what, uint64_t index);
static inline void crash_law_ends(struct crash_law *law)
{
    law->file = NULL;
}

/* ---- the latest end of one rank of several -------------------------------------------------- */

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

/* For this process, one of several ranks, after crash_watch: when its time has come, one line on
 * standard error and exit code EXIT_INTERRUPTED. Without this call, as for a single rank, it never
 * comes. */
void deadline_prepare(void);

/* Told to stop: the time comes DEADLINE_PATIENCE from now, whatever was set before. May be called
 * from a signal handler. */
void deadline_begin(void);

/* The time comes DEADLINE_PATIENCE after the time limit, `seconds` from now (INFINITY: never). */
void deadline_limit(double seconds);

/* From `begin` on this rank waits within MPI for rank 0's machine, DEADLINE_LOST at most
 * (parallel_add). */
void deadline_waits(bool begin);

/* Should this rank have to leave while it waits so, rescue(context) is called first, from a signal
 * handler that interrupted MPI alone: it may do what takes neither MPI nor more than a few seconds.
 * NULL: nothing any more. */
void deadline_rescue(void (*rescue)(void *context), void *context);

#endif
