/* store_space.c - room on the disk: whether there is enough, and that it stays there. */
#include "store_private.h"

#include "runner/base/message.h"
#include "runner/base/units.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdio.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

bool store_system_failed(stance_message *message, const char *file, const char *what, int error)
{
    return complain(message, "%.100s: cannot %s: %s", file, what, strerror(error));
}

void store_directory(const char *file, char *directory, size_t size)
{
    snprintf(directory, size, "%s", file);
    char *slash = strrchr(directory, '/');
    if (!slash)
        snprintf(directory, size, ".");
    else
        slash[slash == directory] = '\0';
}

bool store_fits(const char *file, uint64_t size, uint64_t length, stance_message *message)
{
    struct statvfs system;
    struct rlimit limit;
    char directory[1024], needed[32], there[32];

    store_directory(file, directory, sizeof directory);
    text_of_bytes(needed, sizeof needed, (double)size);
    if (statvfs(directory, &system) == 0 && (uint64_t)system.f_bavail * system.f_frsize < size) {
        text_of_bytes(there, sizeof there, (double)system.f_bavail * (double)system.f_frsize);
        return complain(message, "%.100s: needs about %s but only %s are free: %s", file, needed,
                        there, strerror(ENOSPC));
    }
    text_of_bytes(needed, sizeof needed, (double)length);
    if (getrlimit(RLIMIT_FSIZE, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY &&
        limit.rlim_cur < length) {
        text_of_bytes(there, sizeof there, (double)limit.rlim_cur);
        return complain(message, "%.100s: needs about %s but the limit on file sizes is %s: %s",
                        file, needed, there, strerror(EFBIG));
    }
    return true;
}

bool store_bring(const char *file, bool whole, stance_message *message)
{
    struct stat information;
    const int descriptor = open(file, O_RDWR | O_CLOEXEC);
    int error = descriptor < 0 || fstat(descriptor, &information) != 0 ? errno : 0;
    /* Where the file system cannot reserve, a full disk shows when rows are written. */
    if (error == 0 && whole && fallocate(descriptor, 0, 0, information.st_size) != 0 &&
        errno != EOPNOTSUPP)
        error = errno;
    if (error == 0 && fsync(descriptor) != 0)
        error = errno;
    if (descriptor >= 0 && close(descriptor) != 0 && error == 0)
        error = errno;
    return error == 0 ||
           store_system_failed(message, file, whole ? "reserve its space" : "bring it to the disk",
                               error);
}

bool store_take_place(const char *made, const char *file, stance_message *message)
{
    char directory[PATH_MAX];
    struct stat before;
    if (!store_bring(made, false, message))
        return false;
    /* Whoever may write the old file may write this one, as far as the system lets us see to it. */
    if (stat(file, &before) == 0 && chown(made, before.st_uid, before.st_gid) == 0)
        (void)chmod(made, before.st_mode & 0777);
    if (rename(made, file) != 0)
        return store_system_failed(message, file, "put the new file there", errno);
    store_directory(file, directory, sizeof directory);
    const int descriptor = open(directory, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (descriptor >= 0) {
        (void)fsync(descriptor); /* some file systems cannot; then the rename takes its time */
        close(descriptor);
    }
    return true;
}
