/* lock.h - one writer per results file.
 *
 * A file FILE.lock, locked by rank 0 as long as it lives: the kernel releases the lock when the
 * process dies, however it dies, and the file left behind does no harm. A file of its own, because
 * HDF5 and MPI-IO have their own use for locks on the results.
 */
#ifndef STANCE_RUNNER_LOCK_H
#define STANCE_RUNNER_LOCK_H

#include "../engine/stance.h"

struct lock {
    int descriptor; /* -1: not held */
    char file[1100];
};

/* false: another process writes FILE, or the lock file cannot be made; *message says which. */
bool lock_take(struct lock *lock, const char *file, stance_message *message);
void lock_release(struct lock *lock);

/* What the writer tells others: when it began (seconds since 1970) and how many cases were
 * finished then. */
struct lock_note {
    double start;
    uint64_t finished;
};
void lock_write_note(const struct lock *lock, const struct lock_note *note);
/* Whether somebody is writing FILE now; *note is zero when it left none. */
bool lock_is_held(const char *file, struct lock_note *note);

#endif
