/* lock.h - one writer per results file.
 *
 * A file FILE.lock, locked by rank 0 as long as it lives: the kernel releases the lock when the
 * process dies, however it dies, and the file left behind does no harm. A file of its own, because
 * HDF5 and MPI-IO have their own use for locks on the results.
 */
#ifndef STANCE_STORE_LOCK_H
#define STANCE_STORE_LOCK_H

#include "engine/stance.h"

struct lock {
    int descriptor;  /* -1: not held */
    char file[1100]; /* FILE.lock */
};

/* false: another process writes FILE, or the lock file cannot be made; *message says which.
 * `through`: where FILE is a symbolic link, of the file that it names, which is written, lest two
 * jobs write one file under two names. */
bool lock_take(struct lock *lock, const char *file, bool through, stance_message *message);
void lock_release(struct lock *lock);

/* Sees to it that the file behind the lock still has its name; takes the lock anew when somebody
 * has removed it. false: another process has taken it meanwhile. */
bool lock_keep(struct lock *lock, stance_message *message);

/* What the writer tells others, a text of less than LOCK_NOTE bytes. It always takes the same place
 * on the disk: what could be written once can be written again. A note that cannot be written costs
 * others what it says, nothing else. */
enum { LOCK_NOTE = 1024 };
void lock_write_note(const struct lock *lock, const char *note);
/* Whether a process is writing FILE, or what it links to, now, as far as locks reach: over some
 * network file systems only those of this machine are seen. The last note, also of a writer that
 * died: "" when there is none.
 */
bool lock_is_held(const char *file, char note[LOCK_NOTE]);

#endif
