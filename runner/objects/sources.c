/* sources.c - embedded by the assembler; the Makefile says which. */
#include "sources.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#ifndef STANCE_SOURCES /* SOURCE("engine/stance.h") ... */
#define STANCE_SOURCES
#endif

#define SOURCE(path) ".asciz \"" path "\"\n.incbin \"" path "\"\n.byte 0\n"
__asm__(".pushsection .rodata\n"
        "all_sources:\n" STANCE_SOURCES ".byte 0\n"
        ".popsection\n");
extern const char all_sources[] __attribute__((visibility("hidden")));

/* The text that belongs to a path, and the path after it. */
static const char *text_of(const char *path)
{
    return path + strlen(path) + 1;
}
static const char *next_path(const char *path)
{
    const char *const text = text_of(path);
    return text + strlen(text) + 1;
}

const char *sources(size_t *size)
{
    const char *path = all_sources;
    while (*path)
        path = next_path(path);
    *size = (size_t)(path - all_sources) + 1;
    return all_sources;
}

bool sources_have(const char *path)
{
    const char *at = all_sources;
    while (*at && strcmp(at, path) != 0)
        at = next_path(at);
    return *at != '\0';
}

bool sources_write_file(int directory, const char *path, const void *bytes, size_t size)
{
    const char *from = bytes;
    const int file =
        openat(directory, path, O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0600);
    if (file < 0)
        return false;
    while (size > 0) {
        const ssize_t n = write(file, from, size);
        if (n < 0 && errno == EINTR)
            continue;
        if (n <= 0) {
            const int error = n < 0 ? errno : ENOSPC;
            close(file);
            errno = error;
            return false;
        }
        from += n;
        size -= (size_t)n;
    }
    return close(file) == 0;
}

/* The directories that a path goes through. */
static bool make_directories(int directory, const char *path)
{
    char part[PATH_MAX];
    for (const char *slash = strchr(path, '/'); slash; slash = strchr(slash + 1, '/')) {
        snprintf(part, sizeof part, "%.*s", (int)(slash - path), path);
        if (mkdirat(directory, part, 0700) != 0 && errno != EEXIST)
            return false;
    }
    return true;
}

bool sources_write(int directory)
{
    for (const char *path = all_sources; *path; path = next_path(path))
        if (!make_directories(directory, path) ||
            !sources_write_file(directory, path, text_of(path), strlen(text_of(path))))
            return false;
    return true;
}
