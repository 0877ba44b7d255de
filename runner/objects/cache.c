/* cache.c - see cache.h. */
#include "cache.h"
#include "sources.h"

#include "runner/base/message.h"
#include "runner/base/units.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <limits.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

static const time_t unused = 90 * 86400, abandoned = 3600; /* s */
static const off_t largest = 256 << 20;                    /* bytes, of all objects */
static const double patience = 120;                        /* s, with another job */

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
    cache->directory = cache->lock = -1;
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
    cache_unlock(cache);
    if (cache->directory >= 0)
        close(cache->directory);
    cache->directory = -1;
}

/* ---- objects ------------------------------------------------------------------------------- */

/* Reads one file. false: it is not there, or it is not to be used: then `bad` says why. */
static bool read_object(const struct cache *cache, const char *name, struct image *image,
                        const char **bad)
{
    struct image_label label;
    struct stat information;
    const int file = openat(cache->directory, name, O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
    *bad = file < 0 && errno != ENOENT ? "cannot be read" : NULL;
    if (file < 0)
        return false;
    if (fstat(file, &information) != 0 || !S_ISREG(information.st_mode) || !trusted(&information))
        *bad = "not a file of this user alone";
    else if (!image_read(image, file) || !image_label(image, &label))
        *bad = "truncated or damaged";
    else if (!strstr(name, label.key))
        *bad = "something else under this name";
    if (*bad)
        image_free(image);
    else if (!cache->looks)
        (void)futimens(file, NULL); /* used now: see sweep_object */
    close(file);
    return !*bad;
}

/* The same; what is bad goes. */
static bool take_object(const struct cache *cache, const char *name, struct image *image)
{
    const char *bad;
    *image = (struct image){NULL, 0};
    if (read_object(cache, name, image, &bad))
        return true;
    if (bad && !cache->looks) {
        (void)unlinkat(cache->directory, name, 0);
        cache_say("%.100s/%s: %s: thrown away", cache->path, name, bad);
    }
    return false;
}

/* Calls visit for each name in a directory until it returns true; whether one did. */
static bool each_name(int directory, bool (*visit)(int directory, const char *name, void *context),
                      void *context)
{
    const int again = openat(directory, ".", O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    DIR *const stream = again < 0 ? NULL : fdopendir(again);
    bool found = false;
    if (!stream && again >= 0)
        close(again);
    for (struct dirent *entry; stream && !found && (entry = readdir(stream));)
        if (strcmp(entry->d_name, ".") != 0 && strcmp(entry->d_name, "..") != 0)
            found = visit(directory, entry->d_name, context);
    if (stream)
        closedir(stream);
    return found;
}

static const char of_object[] = ".so", of_refusal[] = ".refused";

static bool ends(const char *name, const char *end)
{
    const size_t n = strlen(name), m = strlen(end);
    return n > m && n < CACHE_NAME && strcmp(name + n - m, end) == 0;
}

struct search {
    const struct cache *cache;
    const char *stem;
    struct image *image;
};
static bool try_object(int directory, const char *name, void *context)
{
    const struct search *const s = context;
    (void)directory;
    return ends(name, of_object) && strncmp(name, s->stem, strlen(s->stem)) == 0 &&
           take_object(s->cache, name, s->image);
}

bool cache_find(const struct cache *cache, const char *name, bool stem, struct image *image)
{
    struct search search = {cache, name, image};
    *image = (struct image){NULL, 0};
    if (cache->directory < 0)
        return false;
    return stem ? each_name(cache->directory, try_object, &search)
                : take_object(cache, name, image);
}

/* Written under another name in a directory of the cache, and renamed. */
static bool keep_file(const struct cache *cache, int directory, const char *name,
                      const struct image *image)
{
    char sealed[32];
    uint64_t number;
    if (getrandom(&number, sizeof number, 0) != (ssize_t)sizeof number)
        return false;
    snprintf(sealed, sizeof sealed, "compile-%016" PRIx64, number);
    if (sources_write_file(directory, sealed, image->bytes, image->size) &&
        renameat(directory, sealed, cache->directory, name) == 0)
        return true;
    const int error = errno;
    (void)unlinkat(directory, sealed, 0);
    errno = error;
    return false;
}

/* ---- keeping, and what was refused -------------------------------------------------------- */

static void refusal_name(const char *object, char name[CACHE_NAME])
{
    snprintf(name, CACHE_NAME, "%.*s%s", (int)(strlen(object) - strlen(of_object)), object,
             of_refusal);
}

bool cache_keep(const struct cache *cache, const struct place *place, const char *name,
                const struct image *image)
{
    const bool good = place->kept && keep_file(cache, place->directory, name, image);
    char refusal[CACHE_NAME];
    refusal_name(name, refusal);
    if (good)
        (void)unlinkat(cache->directory, refusal, 0); /* of another try */
    else if (place->kept)
        cache_say("%.100s: a compiled kernel cannot be kept there: %s", cache->path,
                  strerror(errno));
    return good;
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
        (void)keep_file(cache, cache->directory, name, &image);
    image_free(&image);
}

bool cache_refused(const struct cache *cache, const char *object, stance_message *why)
{
    struct image image = {NULL, 0};
    char name[CACHE_NAME];
    refusal_name(object, name);
    if (cache->directory < 0 || !take_object(cache, name, &image))
        return false;
    complain(why, "%.180s (known from before; stance build tries again)", image.bytes);
    image_free(&image);
    return true;
}

/* ---- places to compile in ------------------------------------------------------------------ */

/* Removes what has a name, with all that is in it. */
static bool remove_all(int directory, const char *name, void *context)
{
    const int inside = openat(directory, name, O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
    if (inside >= 0) {
        each_name(inside, remove_all, context);
        close(inside);
    }
    (void)unlinkat(directory, name, inside >= 0 ? AT_REMOVEDIR : 0);
    return false;
}

void cache_leave(struct place *place)
{
    if (place->directory < 0)
        return;
    close(place->directory);
    remove_all(place->parent, place->name, NULL);
    if (!place->kept)
        close(place->parent);
    place->directory = -1;
}

/* Room on the disk, tried: reservations are the only answer that quotas give. */
static bool has_room(int directory, size_t room)
{
    static const char name[] = "room";
    const int file = openat(directory, name, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
    if (file < 0)
        return false;
    const int error = posix_fallocate(file, 0, (off_t)room);
    close(file);
    (void)unlinkat(directory, name, 0);
    errno = error;
    return error == 0;
}

/* Makes a place in an open directory. false, with errno. */
static bool make_place(struct place *place, int parent, const char *begin, size_t room)
{
    uint64_t number;
    if (getrandom(&number, sizeof number, 0) != (ssize_t)sizeof number)
        return false;
    place->parent = parent;
    place->directory = -1;
    snprintf(place->name, sizeof place->name, "%s-%016" PRIx64, begin, number);
    if (mkdirat(parent, place->name, 0700) != 0)
        return false;
    place->directory = openat(parent, place->name, O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
    if (place->directory >= 0 && has_room(place->directory, room) &&
        sources_write(place->directory))
        return true;
    const int error = errno;
    if (place->directory >= 0)
        close(place->directory);
    place->directory = -1;
    remove_all(parent, place->name, NULL);
    errno = error;
    return false;
}

bool cache_place(const struct cache *cache, uint64_t mechanism, size_t room, struct place *place,
                 stance_message *message)
{
    char name[32];
    const char *const named = getenv("TMPDIR");
    const char *const bases[] = {named && named[0] ? named : "/tmp", "/tmp"};
    stance_message why = cache->why;
    snprintf(name, sizeof name, "compile-%016" PRIx64, mechanism);
    place->kept = cache->directory >= 0;
    if (place->kept && make_place(place, cache->directory, name, room))
        return true;
    if (place->kept)
        complain(&why, "%.100s: cannot be written: %s", cache->path, strerror(errno));
    place->kept = false;
    for (size_t i = 0; i < sizeof bases / sizeof bases[0]; i++) {
        const int parent = open(bases[i], O_RDONLY | O_DIRECTORY | O_CLOEXEC);
        if (parent >= 0 && make_place(place, parent, "stance", room)) {
            cache_say("%s; compiled in %.60s, for this run alone", why.text, bases[i]);
            return true;
        }
        const int error = errno;
        if (parent >= 0)
            close(parent);
        errno = error;
    }
    return complain(message, "%.150s; nor can %.30s: %s", why.text, bases[0], strerror(errno));
}

/* ---- the lock, and sweeping ---------------------------------------------------------------- */

/* A byte of the lock's file stands for a mechanism. */
static struct flock range_of(uint64_t mechanism)
{
    return (struct flock){.l_type = F_WRLCK,
                          .l_whence = SEEK_SET,
                          .l_start = (off_t)(mechanism & INT32_MAX),
                          .l_len = 1};
}

static bool is_old(int directory, const char *name, time_t age)
{
    struct stat information;
    return fstatat(directory, name, &information, AT_SYMLINK_NOFOLLOW) == 0 &&
           information.st_mtime < time(NULL) - age;
}

/* Places of compilers that were killed; where there are no locks, old ones. */
static bool sweep_place(int directory, const char *name, void *context)
{
    const struct cache *const cache = context;
    uint64_t mechanism;
    if (sscanf(name, "compile-%16" SCNx64, &mechanism) != 1)
        return false;
    struct flock range = range_of(mechanism);
    const bool asked = cache->lock >= 0 && fcntl(cache->lock, F_OFD_GETLK, &range) == 0;
    if (asked ? range.l_type == F_UNLCK : is_old(directory, name, abandoned))
        remove_all(directory, name, NULL);
    return false;
}

struct sweep {
    time_t age;
    off_t left; /* bytes */
};
static bool sweep_object(int directory, const char *name, void *context)
{
    struct sweep *const sweep = context;
    struct stat information;
    if (!ends(name, of_object) && !ends(name, of_refusal))
        return false;
    if (is_old(directory, name, sweep->age))
        (void)unlinkat(directory, name, 0);
    else if (fstatat(directory, name, &information, AT_SYMLINK_NOFOLLOW) == 0)
        sweep->left += information.st_size;
    return false;
}

bool cache_lock(struct cache *cache, uint64_t mechanism, struct watch *watch)
{
    const double begin = clock_seconds();
    bool said = false;
    if (cache->directory < 0)
        return true;
    cache->lock = openat(cache->directory, "lock", O_RDWR | O_CREAT | O_NOFOLLOW | O_CLOEXEC, 0600);
    struct flock range = range_of(mechanism);
    while (cache->lock >= 0 && fcntl(cache->lock, F_OFD_SETLK, &range) != 0) {
        const bool held = errno == EAGAIN || errno == EACCES;
        if (!said && held)
            cache_say("another job compiles the same; waiting for it");
        said = true;
        if (!held || clock_seconds() - begin > patience) {
            cache_say("%.100s: goes on without a lock: %s", cache->path, strerror(errno));
            break;
        }
        if (watch_wait(watch))
            return false;
    }
    each_name(cache->directory, sweep_place, cache);
    struct sweep sweep = {unused, 0};
    do {
        sweep.left = 0;
        each_name(cache->directory, sweep_object, &sweep);
        sweep.age /= 2;
    } while (sweep.left > largest && sweep.age > 0);
    return true;
}

void cache_unlock(struct cache *cache)
{
    if (cache->lock >= 0)
        close(cache->lock);
    cache->lock = -1;
}
