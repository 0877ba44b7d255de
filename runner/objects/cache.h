/* cache.h - the user's directory of compiled objects, and places to compile in.
 *
 * $STANCE_CACHE, else $XDG_CACHE_HOME/stance, else ~/.cache/stance; made with mode 0700. In it
 *
 *     implicit-avx2-0123...-4567....so   an object with its label (image.h), one for each key
 *     ....refused                        why that object is none: it computes something else
 *     compile-0123...-89ab...            where a compiler is at work
 *     lock                               bytes of it are locked by those who compile
 *
 * Everything is reached from the open directory, and nothing through symbolic links. Files are
 * written elsewhere and renamed. A lock keeps two jobs from compiling the same; where there are no
 * locks both do, and the second file replaces the first. Whoever compiles sweeps: places of
 * compilers that are gone, objects that nobody used for 90 days, and, beyond 256 MiB, those that
 * nobody used for longest.
 */
#ifndef STANCE_OBJECTS_CACHE_H
#define STANCE_OBJECTS_CACHE_H

#include "image.h"
#include "watch.h"

#include "engine/stance.h"

#include <stdint.h>

struct cache {
    char path[3000];
    int directory; /* negative: there is none, for the reason in `why` */
    int lock;      /* negative: none */
    bool looks;    /* nothing is made, touched or thrown away */
    stance_message why;
};

/* Opens it, or (unless it only `looks`) makes it. false: what is there cannot be trusted; the
 * message names the mend. */
bool cache_open(struct cache *cache, bool looks, stance_message *message);
void cache_close(struct cache *cache);

/* The file of an object: NAME-KEY.so, key as in its label. */
enum { CACHE_NAME = 160 };

/* Finds an object by the name of its file or (`stem`) by its beginning: of any compiler. What is
 * there and no such object is thrown away, and said. */
bool cache_find(const struct cache *cache, const char *name, bool stem, struct image *image);

/* Waits, two minutes at most, until no other job compiles for this mechanism (a number that stands
 * for it); then nobody else does until cache_unlock. Sweeps. false: told to stop meanwhile. */
bool cache_lock(struct cache *cache, uint64_t mechanism, struct watch *watch);
void cache_unlock(struct cache *cache);

/* A directory of this process alone. */
struct place {
    int parent, directory;
    char name[64];
    bool kept; /* it is in the cache: objects can be moved from here */
};

/* Makes one in the cache, or, where nothing can be written there, below $TMPDIR or /tmp, and says
 * so. It has room for `room` bytes. false: nowhere. */
bool cache_place(const struct cache *cache, uint64_t mechanism, size_t room, struct place *place,
                 stance_message *message);
void cache_leave(struct place *place);

/* Keeps a sealed image under this name. false, said: it cannot. */
bool cache_keep(const struct cache *cache, const struct place *place, const char *name,
                const struct image *image);

/* Remembers that the object of this name is refused, and why; and whether it is. Both hold for the
 * compiler and the sources that are in the name. */
void cache_refuse(const struct cache *cache, const char *object, const struct image_label *label,
                  const char *why);
bool cache_refused(const struct cache *cache, const char *object, stance_message *why);

/* One line for the user on standard error. */
void cache_say(const char *format, ...) __attribute__((format(printf, 1, 2)));

#endif
