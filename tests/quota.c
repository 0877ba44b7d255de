/* quota.c - preloaded, gives the answers of a disk on which a quota is used up: to reservations, or
 * to writes into results files (FILE.h5, not FILE.h5.part) after QUOTA bytes.
 *
 *   QUOTA=reserve LD_PRELOAD=./quota.so stance run ...      QUOTA=100000 LD_PRELOAD=...
 */
#include <dlfcn.h>
#include <errno.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/types.h>
#include <unistd.h>

int fallocate(int file, int mode, off_t begin, off_t length);
ssize_t pwrite(int file, const void *data, size_t size, off_t place);

static bool used_up(int file, size_t size)
{
    static long left = -1;
    const char *const quota = getenv("QUOTA");
    char link[64], name[1024];
    snprintf(link, sizeof link, "/proc/self/fd/%d", file);
    const ssize_t n = readlink(link, name, sizeof name);
    if (!quota || n < 3 || memcmp(name + n - 3, ".h5", 3) != 0)
        return false;
    left = left < 0 ? atol(quota) : left;
    if ((long)size > left)
        return true;
    left -= (long)size;
    return false;
}

int fallocate(int file, int mode, off_t begin, off_t length)
{
    const char *const quota = getenv("QUOTA");
    if (quota && strcmp(quota, "reserve") == 0) {
        errno = EDQUOT;
        return -1;
    }
    int (*const real)(int, int, off_t, off_t) =
        (int (*)(int, int, off_t, off_t))dlsym(RTLD_NEXT, "fallocate");
    return real(file, mode, begin, length);
}

ssize_t pwrite(int file, const void *data, size_t size, off_t place)
{
    ssize_t (*const real)(int, const void *, size_t, off_t) =
        (ssize_t(*)(int, const void *, size_t, off_t))dlsym(RTLD_NEXT, "pwrite");
    if (!used_up(file, size))
        return real(file, data, size, place);
    errno = EDQUOT;
    return -1;
}
