/* compiler.h - the C compiler of the machine: which it is, and running it, several at a time.
 *
 * It is started with a list of arguments, never by a shell, in a directory that holds all it reads
 * and writes (temporary files, too).
 */
#ifndef STANCE_OBJECTS_COMPILER_H
#define STANCE_OBJECTS_COMPILER_H

#include "image.h"
#include "watch.h"

#include "engine/stance.h"

enum { COMPILER_WORDS = 16 };

/* The environment variable CC if it is set, else the first of cc, gcc and clang in PATH. */
struct compiler {
    char *word[COMPILER_WORDS]; /* how it is called ... */
    size_t words;
    char text[512], path[4096];   /* ... kept here */
    char version[IMAGE_COMPILER]; /* first line of --version */
    char identity[IMAGE_HALF];    /* of all that it says of itself */
};

/* false: none runs; `why` says what was tried. */
bool compiler_find(struct compiler *compiler, stance_message *why);
/* The one of this name. */
bool compiler_named(struct compiler *compiler, const char *name);
/* The label of what it makes of these texts and of the embedded sources, its key by all of that: of
 * one without an identity "HASH-". false: no memory. */
bool compiler_label(const struct compiler *compiler, const char *const *text, size_t texts,
                    struct image_label *label);

/* The flags that an instruction set is compiled with, separated by blanks; NULL: there is none of
 * this name. And the name of each instruction set of this build, NULL past the last. */
const char *compiler_flags(const char *isa);
const char *compiler_isa(size_t index);

/* One object to be compiled, and what became of it: a kernel, of the method's source, or a law, of
 * its own sources and with more flags. */
enum { COMPILER_SOURCES = 2 };
struct compilation {
    const char *method, *isa;
    const char *source[COMPILER_SOURCES],
        *flags;             /* NULL: a kernel's; of an isa that there is not alone */
    struct image image;     /* none: it failed ... */
    stance_message message; /* ... and why */
};

/* The header of tables that kernels are compiled with, see objects.h. */
#define COMPILER_TABLES "tables.h"

/* What stands beside the engine's sources in the directory that is compiled in. */
struct compiler_file {
    const char *path, *text;
};

/* How many cores this process has. */
size_t compiler_cores(void);

/* Compiles in a directory of its own, below $TMPDIR or /tmp; as many at a time as there are
 * cores. Where it is to stop, all that were started are ended, with what they have started
 * themselves. */
void compiler_run(const struct compiler *compiler, const struct compiler_file *file, size_t files,
                  struct compilation *wanted, size_t count, struct watch *watch);

#endif
