/* cache.c - see cache.h. */
#include "cache.h"
#include "sources.h"

#include "runner/base/message.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>

static const off_t largest = 256 << 20; /* bytes, of all files */

void cache_say(const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    fputs("stance: ", stderr);
    vfprintf(stderr, format, arguments);
    putc('\n', stderr);
    va_end(arguments);
}

/* ---- the directory ------------------------------------------------------------------------- */

/* Its name; directories that it is to be made in are made, if anything is. false: there is none to
 * be had. */
static bool name_directory(char *path, size_t size, bool make)
{
    const char *const own = getenv("STANCE_CACHE"), *const caches = getenv("XDG_CACHE_HOME");
    const char *const home = getenv("HOME");
    int n = -1;
    if (own && own[0]) {
        n = snprintf(path, size, "%s", own);
    } else if (caches && caches[0] == '/') {
        if (make)
            mkdir(caches, 0700);
        n = snprintf(path, size, "%s/stance", caches);
    } else if (home && home[0]) {
        n = snprintf(path, size, "%s/.cache", home);
        if (make && n > 0 && (size_t)n < size)
            mkdir(path, 0700);
        n = snprintf(path, size, "%s/.cache/stance", home);
    }
    /* A link would be followed from "link/". */
    while (n > 1 && (size_t)n < size && path[n - 1] == '/')
        path[--n] = '\0';
    return n > 0 && (size_t)n < size;
}

/* Only this user's own hands may have touched it. */
static bool trusted(const struct stat *information)
{
    return information->st_uid == geteuid() && !(information->st_mode & (S_IWGRP | S_IWOTH));
}

bool cache_open(struct cache *cache, bool looks, stance_message *message)
{
    struct stat information;
    cache->looks = looks;
    cache->directory = -1;
    cache->why.text[0] = cache->path[0] = '\0';
    if (!name_directory(cache->path, sizeof cache->path, !looks)) {
        complain(&cache->why, "no cache: neither STANCE_CACHE nor HOME names a directory");
        return true;
    }
    const int made = looks || mkdir(cache->path, 0700) == 0 ? 0 : errno;
    if (lstat(cache->path, &information) == 0 && S_ISLNK(information.st_mode))
        return complain(message,
                        "%.100s: a symbolic link: not used as cache; name the directory "
                        "itself with STANCE_CACHE",
                        cache->path);
    cache->directory = open(cache->path, O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
    if (cache->directory < 0) {
        complain(&cache->why, "%.100s: no cache: %s", cache->path,
                 strerror(made && made != EEXIST ? made : errno));
        return true;
    }
    const bool known = fstat(cache->directory, &information) == 0;
    if (known && trusted(&information))
        return true;
    cache_close(cache);
    if (!known || information.st_uid != geteuid())
        return complain(message,
                        "%.100s: belongs to another user: not used as cache; name a "
                        "directory of yours with STANCE_CACHE",
                        cache->path);
    return complain(message, "%.80s: others can write to it: not used as cache; chmod go-w %.80s",
                    cache->path, cache->path);
}

void cache_close(struct cache *cache)
{
    if (cache->directory >= 0)
        close(cache->directory);
    cache->directory = -1;
}

/* ---- objects ------------------------------------------------------------------------------- */

static const char of_object[] = ".so", of_refusal[] = ".refused", of_part[] = ".part";

static bool ends(const char *name, const char *end)
{
    const size_t n = strlen(name), m = strlen(end);
    return n > m && n < CACHE_NAME && strcmp(name + n - m, end) == 0;
}

/* Reads one file; what is there and no good goes, and that is said. */
static bool take_file(const struct cache *cache, const char *name, struct image *image)
{
    struct image_label label;
    struct stat information;
    const char *bad = NULL;
    const int file = openat(cache->directory, name, O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
    *image = (struct image){NULL, 0};
    if (file < 0 && errno == ENOENT)
        return false;
    if (file < 0)
        bad = "cannot be read";
    else if (fstat(file, &information) != 0 || !S_ISREG(information.st_mode) ||
             !trusted(&information))
        bad = "not a file of this user alone";
    else if (!image_read(image, file) || !image_label(image, &label))
        bad = "truncated or damaged";
    else if (!strstr(name, label.key))
        bad = "something else under this name";
    else if (!cache->looks)
        (void)futimens(file, NULL); /* used now: see limit_size */
    if (file >= 0)
        close(file);
    if (!bad)
        return true;
    image_free(image);
    if (!cache->looks) {
        (void)unlinkat(cache->directory, name, 0);
        cache_say("%.100s/%s: %s: thrown away", cache->path, name, bad);
    }
    return false;
}

/* Its names, to be read anew; NULL: they cannot be had. */
static DIR *list(const struct cache *cache)
{
    const int again = openat(cache->directory, ".", O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    DIR *const stream = again < 0 ? NULL : fdopendir(again);
    if (!stream && again >= 0)
        close(again);
    return stream;
}

bool cache_find(const struct cache *cache, const char *name, struct image *image)
{
    const size_t stem = strlen(name) - strlen(of_object);
    bool found = false;
    *image = (struct image){NULL, 0};
    if (cache->directory < 0)
        return false;
    if (name[stem - 1] != '-')
        return take_file(cache, name, image);
    DIR *const names = list(cache);
    for (struct dirent *e; names && !found && (e = readdir(names));)
        found = ends(e->d_name, of_object) && strncmp(e->d_name, name, stem) == 0 &&
                take_file(cache, e->d_name, image);
    if (names)
        closedir(names);
    return found;
}

/* ---- keeping, and what was refused -------------------------------------------------------- */

/* Beyond the largest size what nobody used for longest goes, one after the other. */
static void limit_size(const struct cache *cache)
{
    off_t sum;
    char oldest[CACHE_NAME];
    do {
        struct timespec used = {0};
        struct stat information;
        DIR *const names = list(cache);
        sum = 0;
        oldest[0] = '\0';
        for (struct dirent *e; names && (e = readdir(names));) {
            if ((!ends(e->d_name, of_object) && !ends(e->d_name, of_refusal) &&
                 !ends(e->d_name, of_part)) ||
                fstatat(cache->directory, e->d_name, &information, AT_SYMLINK_NOFOLLOW) != 0)
                continue;
            const struct timespec at = information.st_mtim;
            sum += information.st_size;
            if (!oldest[0] || at.tv_sec < used.tv_sec ||
                (at.tv_sec == used.tv_sec && at.tv_nsec < used.tv_nsec)) {
                snprintf(oldest, sizeof oldest, "%.*s", CACHE_NAME - 1, e->d_name);
                used = at;
            }
        }
        if (names)
            closedir(names);
    } while (sum > largest && unlinkat(cache->directory, oldest, 0) == 0);
}

/* Written under another name, and renamed: nobody reads half of it, and of two the last stays. */
static bool keep_file(const struct cache *cache, const char *name, const struct image *image)
{
    char part[32];
    uint64_t number;
    if (getrandom(&number, sizeof number, 0) != (ssize_t)sizeof number)
        return false;
    snprintf(part, sizeof part, "%016" PRIx64 "%s", number, of_part);
    if (sources_write_file(cache->directory, part, image->bytes, image->size) &&
        renameat(cache->directory, part, cache->directory, name) == 0) {
        limit_size(cache);
        return true;
    }
    const int error = errno;
    (void)unlinkat(cache->directory, part, 0);
    errno = error;
    return false;
}

static void refusal_name(const char *object, char name[CACHE_NAME])
{
    snprintf(name, CACHE_NAME, "%.*s%s", (int)(strlen(object) - strlen(of_object)), object,
             of_refusal);
}

bool cache_keep(const struct cache *cache, const char *name, const struct image *image,
                stance_message *why)
{
    char refusal[CACHE_NAME];
    if (cache->directory < 0)
        return complain(why, "%s", cache->why.text);
    if (!keep_file(cache, name, image))
        return complain(why, "%.100s: cannot be written: %s", cache->path, strerror(errno));
    refusal_name(name, refusal);
    (void)unlinkat(cache->directory, refusal, 0); /* of another try */
    return true;
}

void cache_refuse(const struct cache *cache, const char *object, const struct image_label *label,
                  const char *why)
{
    struct image image = {strdup(why), strlen(why) + 1};
    char name[CACHE_NAME];
    refusal_name(object, name);
    if (cache->directory >= 0)
        (void)unlinkat(cache->directory, object, 0);
    if (cache->directory >= 0 && image.bytes && image_seal(&image, label))
        (void)keep_file(cache, name, &image);
    image_free(&image);
}

bool cache_refused(const struct cache *cache, const char *object, stance_message *why)
{
    struct image image = {NULL, 0};
    char name[CACHE_NAME];
    refusal_name(object, name);
    if (cache->directory < 0 || !take_file(cache, name, &image))
        return false;
    complain(why, "%.180s (known from before; stance build tries again)", image.bytes);
    image_free(&image);
    return true;
}
