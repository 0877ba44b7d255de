/* lock.c - see lock.h. Locks of the open file description: they neither get lost when another
 * descriptor of the same file is closed, nor hinder those that only ask. */
#include "lock.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static bool failed(stance_message *message, const char *file, int error)
{
    if (error == EAGAIN || error == EACCES) {
        snprintf(message->text, sizeof message->text, "%.180s: another process is writing it",
                 file);
    } else {
        snprintf(message->text, sizeof message->text, "%.100s: cannot write there: %s", file,
                 strerror(error));
    }
    return false;
}

bool lock_take(struct lock *lock, const char *file, stance_message *message)
{
    lock->descriptor = -1;
    snprintf(lock->file, sizeof lock->file, "%s.lock", file);
    for (;;) {
        struct flock range = {.l_type = F_WRLCK, .l_whence = SEEK_SET};
        struct stat held, named;
        int descriptor = open(lock->file, O_RDWR | O_CREAT | O_CLOEXEC, 0666);
        if (descriptor < 0) {
            /* EACCES means something else here than below. */
            return failed(message, file, errno == EACCES ? EPERM : errno);
        }
        if (fcntl(descriptor, F_OFD_SETLK, &range) != 0) {
            int error = errno;
            close(descriptor);
            return failed(message, file, error);
        }
        /* Its owner may have removed the file between our two calls: then the lock is worthless. */
        if (fstat(descriptor, &held) == 0 && stat(lock->file, &named) == 0 &&
            held.st_ino == named.st_ino && held.st_dev == named.st_dev) {
            lock->descriptor = descriptor;
            return true;
        }
        close(descriptor);
    }
}

void lock_release(struct lock *lock)
{
    if (lock->descriptor >= 0) {
        unlink(lock->file);
        close(lock->descriptor);
        lock->descriptor = -1;
    }
}

/* A note that cannot be written costs others the rate, nothing else. */
void lock_write_note(const struct lock *lock, const struct lock_note *note)
{
    if (lock->descriptor >= 0 && ftruncate(lock->descriptor, 0) == 0) {
        dprintf(lock->descriptor, "%.3f %" PRIu64 "\n", note->start, note->finished);
    }
}

bool lock_is_held(const char *file, struct lock_note *note)
{
    char path[1100], text[80];
    struct flock range = {.l_type = F_RDLCK, .l_whence = SEEK_SET};

    *note = (struct lock_note){0};
    snprintf(path, sizeof path, "%s.lock", file);
    int descriptor = open(path, O_RDONLY | O_CLOEXEC);
    if (descriptor < 0) {
        return false;
    }
    bool held = fcntl(descriptor, F_OFD_GETLK, &range) == 0 && range.l_type != F_UNLCK;
    ssize_t length = held ? read(descriptor, text, sizeof text - 1) : 0;
    if (length > 0) {
        text[length] = '\0';
        if (sscanf(text, "%lf %" SCNu64, &note->start, &note->finished) != 2) {
            *note = (struct lock_note){0};
        }
    }
    close(descriptor);
    return held;
}
