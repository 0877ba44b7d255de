/* cache.h - the user's directory of compiled objects.
 *
 * $STANCE_CACHE, else $XDG_CACHE_HOME/stance, else ~/.cache/stance; made with mode 0700. In it
 *
 *     implicit-avx2-0123...-4567....so   an object with its label (image.h), one for each key
 *     ....refused                        why that object is none: it computes something else
 *     0123....part                       what is being written, to be renamed
 *
 * A name tells all that the content is made of, so there are no locks: of two jobs that compile the
 * same the last one's file stays, and is the same. Everything is reached from the open directory,
 * and nothing through symbolic links. A file that is taken is touched; beyond 256 MiB those go that
 * nobody took for longest.
 */
#ifndef STANCE_OBJECTS_CACHE_H
#define STANCE_OBJECTS_CACHE_H

#include "image.h"

#include "engine/stance.h"

struct cache {
    char path[3000];
    int directory; /* negative: there is none, for the reason in `why` */
    bool looks;    /* nothing is made, touched or thrown away */
    stance_message why;
};

/* Opens it, or (unless it only `looks`) makes it. false: what is there cannot be trusted; the
 * message names the mend. */
bool cache_open(struct cache *cache, bool looks, stance_message *message);
void cache_close(struct cache *cache);

/* The file of an object: NAME-KEY.so, key as in its label, HASH-COMPILER. */
enum { CACHE_NAME = 160 };

/* Finds an object by the name of its file; NAME-HASH-.so: of any compiler. What is there and no
 * such object is thrown away, and said. */
bool cache_find(const struct cache *cache, const char *name, struct image *image);

/* Keeps a sealed image under this name. false: it cannot, for the reason in `why`. */
bool cache_keep(const struct cache *cache, const char *name, const struct image *image,
                stance_message *why);

/* Remembers that the object of this name is refused, and why; and whether it is. Both hold for the
 * compiler and the sources that are in the name. */
void cache_refuse(const struct cache *cache, const char *object, const struct image_label *label,
                  const char *why);
bool cache_refused(const struct cache *cache, const char *object, stance_message *why);

/* One line for the user on standard error. */
void cache_say(const char *format, ...) __attribute__((format(printf, 1, 2)));

#endif
