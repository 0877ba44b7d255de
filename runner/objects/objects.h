/* objects.h - kernels that are compiled when they are needed, for what no kernel is built in.
 *
 * What is simulated is described by a header of tables; with it the engine's own sources, which the
 * program carries, are compiled into an object for each method and instruction set, and kept in a
 * cache: a directory of the user, one file for each key (tables, sources, flags, compiler). Rank 0
 * alone reads, compiles and checks; every rank loads the bytes from memory.
 *
 * Trust: the tables are made by the engine and hold nothing but integers; a cache that others can
 * change is refused; a file in it is taken if it is whole (SHA-256) and the user's own. Whatever
 * the compiler, an object computes what the reference computes, to the bit, or is refused; that it
 * is is remembered.
 *
 * What does not go as planned is said in one line each on standard error, by rank 0.
 */
#ifndef STANCE_OBJECTS_OBJECTS_H
#define STANCE_OBJECTS_OBJECTS_H

#include "image.h"

#include "engine/stance.h"

#include "runner/base/command.h"
#include "runner/ranks/parallel.h"

enum { OBJECTS_MOST = 64 }; /* in one request, over all ranks */

struct objects_wanted {
    const stance_method *method;
    const char *isa;
    /* A kernel that this machine runs and that computes the same to the bit: what an object is
     * compared with, and what does instead where none can be had. NULL: there is none. */
    const stance_kernel *reference;
};

struct objects_request {
    const char *tables; /* a C header that ends with the lanes' (engine/scenes/..._lanes.h) */
    const stance_scene *scene;
    const struct objects_wanted *wanted; /* [count] */
    size_t count;
    const stance_case *check; /* [checks]; no trajectories */
    size_t checks;
    double patience; /* s of processor time that the checks of an object from the cache may take */
    bool quiet;      /* say nothing where all goes well */
    /* On rank 0: so little is to be computed that compiling would take longer. What is not kept is
     * then computed by the references. */
    bool brief;
    bool again; /* on rank 0: what was refused before is compiled again */
    bool looks; /* on rank 0: nothing is compiled, and the cache stays as it is, too */
    /* Told several times a second while rank 0 compiles, on every rank: true, to stop. NULL:
     * signals alone end it, and with it the process. */
    bool (*stop)(void *context);
    void *context;
};

/* Where a kernel comes from: the cache; a compiler, and is in the cache now, or could not be kept
 * there; or it is the reference, as there is none of this method, or it is being compiled, or there
 * is none now, or none that computes the same. */
enum object_origin {
    OBJECT_KEPT,
    OBJECT_COMPILED,
    OBJECT_UNKEPT,
    OBJECT_REFERENCE,
    OBJECT_COMING,
    OBJECT_MISSING,
    OBJECT_REFUSED
};

struct object {
    stance_kernel kernel;
    enum object_origin origin;
    /* Of a reference "". */
    char key[IMAGE_KEY], compiler[IMAGE_COMPILER];
    void *library; /* the rest is private */
    int memory;
};

/* What comes later. It has what it needs of the request, but for its scene. */
struct objects_later;

/* Collective: the kernels of a request, object[count]. All ranks give the same tables; what they
 * want of them may differ. A method that is not compiled on demand is its reference. later, not
 * NULL: where there is a reference for each nobody waits for the compiler, but rank 0 goes on to
 * compile what is COMING, of which the object is the reference until objects_later_take; *later is
 * NULL where nothing is. NULL on every rank, or on none.
 * EXIT_DONE: all there. EXIT_USAGE: there is no reference either, and no compiler or one that
 * fails. EXIT_IO: the cache is refused, no memory. EXIT_INTERRUPTED: told to stop. Then `message`
 * is the same on every rank, and there is nothing to be released. */
enum exit_code objects_take(const struct parallel *ranks, const struct objects_request *request,
                            struct object *object, struct objects_later **later,
                            stance_message *message);

/* Whether a rank does better to wait: the compilers need its core. */
bool objects_later_wait(const struct objects_later *later, const struct parallel *ranks);
/* On rank 0: whether the compilers have ended. */
bool objects_later_ended(const struct objects_later *later);
/* Each rank for itself, after that: object[] as objects_take would have left it. What is missing is
 * said. */
void objects_later_take(struct objects_later *later, struct object *object);
/* Ends the compilers that are still at work. */
void objects_later_free(struct objects_later *later);

/* Their kernels are gone. */
void objects_release(struct object *object, size_t count);

#endif
