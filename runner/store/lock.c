/* lock.c - see lock.h. Locks of the open file description: they neither get lost when another
 * descriptor of the same file is closed, nor hinder those that only ask. */
#include "lock.h"

#include "runner/base/message.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static bool failed(stance_message *message, const char *file, int error)
{
    return error == EAGAIN || error == EACCES
               ? complain(message, "%.180s: another process is writing it", file)
               : complain(message, "%.100s: cannot write there: %s", file, strerror(error));
}

/* The name still stands for the file that is open. */
static bool has_name(const struct lock *lock, int descriptor)
{
    struct stat held, named;
    return fstat(descriptor, &held) == 0 && stat(lock->file, &named) == 0 &&
           held.st_ino == named.st_ino && held.st_dev == named.st_dev;
}

/* The name of the file that is written through `file`. */
static const char *behind_links(const char *file, char real[PATH_MAX])
{
    struct stat information;
    const bool link = lstat(file, &information) == 0 && S_ISLNK(information.st_mode);
    return link && realpath(file, real) ? real : file;
}

bool lock_take(struct lock *lock, const char *file, bool through, stance_message *message)
{
    char real[PATH_MAX];
    const char *const name = through ? behind_links(file, real) : file;
    lock->descriptor = -1;
    if (strlen(name) + sizeof ".lock" > sizeof lock->file)
        return failed(message, file, ENAMETOOLONG);
    snprintf(lock->file, sizeof lock->file, "%s.lock", name);
    for (;;) {
        struct flock range = {.l_type = F_WRLCK, .l_whence = SEEK_SET};
        int descriptor = open(lock->file, O_RDWR | O_CREAT | O_CLOEXEC, 0666);
        if (descriptor < 0) {
            /* EACCES means something else here than below. */
            return failed(message, name, errno == EACCES ? EPERM : errno);
        }
        const int error = fcntl(descriptor, F_OFD_SETLK, &range) != 0 ? errno : 0;
        /* Its owner may have removed the file between our two calls: then the lock is worthless. */
        if (error == 0 && has_name(lock, descriptor)) {
            lock->descriptor = descriptor;
            return true;
        }
        close(descriptor);
        if (error != 0)
            return failed(message, name, error);
    }
}

bool lock_keep(struct lock *lock, stance_message *message)
{
    char file[sizeof lock->file];
    if (lock->descriptor < 0 || has_name(lock, lock->descriptor))
        return true;
    const int before = lock->descriptor;
    snprintf(file, sizeof file, "%.*s", (int)(strlen(lock->file) - strlen(".lock")), lock->file);
    const bool taken = lock_take(lock, file, false, message);
    close(before);
    return taken;
}

void lock_release(struct lock *lock)
{
    if (lock->descriptor >= 0) {
        unlink(lock->file);
        close(lock->descriptor);
        lock->descriptor = -1;
    }
}

void lock_write_note(const struct lock *lock, const char *note)
{
    char text[LOCK_NOTE];
    snprintf(text, sizeof text, "%-*s", LOCK_NOTE - 2, note);
    text[LOCK_NOTE - 2] = '\n';
    if (lock->descriptor >= 0 && pwrite(lock->descriptor, text, LOCK_NOTE - 1, 0) < 0)
        return;
}

bool lock_is_held(const char *file, char note[LOCK_NOTE])
{
    char path[PATH_MAX + 8], real[PATH_MAX];
    struct flock range = {.l_type = F_RDLCK, .l_whence = SEEK_SET};

    note[0] = '\0';
    snprintf(path, sizeof path, "%s.lock", behind_links(file, real));
    int descriptor = open(path, O_RDONLY | O_CLOEXEC);
    if (descriptor < 0)
        return false;
    const bool held = fcntl(descriptor, F_OFD_GETLK, &range) == 0 && range.l_type != F_UNLCK;
    const ssize_t length = read(descriptor, note, LOCK_NOTE - 1);
    note[length > 0 ? length : 0] = '\0';
    close(descriptor);
    return held;
}
