/* crash.h - last words of a rank that crashes: which rank, where, and what it was at.
 *
 * The handler calls nothing but write(2) and sigaction(2), on a stack of its own; what it says is
 * kept ready here as the work goes on. Afterwards the signal goes to whoever had it before (Open
 * MPI prints where the program stood), so that the process still dies of it and the launcher ends
 * the job. A process that is killed (SIGKILL, also for want of memory) says nothing: its launcher
 * does.
 */
#ifndef STANCE_RANKS_CRASH_H
#define STANCE_RANKS_CRASH_H

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

#endif
