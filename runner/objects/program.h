/* program.h - a control law of the user's own: from the text of a C file to what kernels call.
 *
 * Compiled as kernels are, for one lane, with stance_law.h, and kept in the same cache. It may call
 * nothing but what stands there, and has no variables that outlive a call, so that what it commands
 * depends on what it is told alone. It runs in this process: whoever runs a stranger's scenario
 * trusts its law, see trust.h. What it does wrong is told as its own: beyond the bounds of its
 * arrays, or into nowhere, it ends the process with one line that names it and the case (crash.h),
 * and so does a call that does not return.
 */
#ifndef STANCE_OBJECTS_PROGRAM_H
#define STANCE_OBJECTS_PROGRAM_H

#include "image.h"

#include "engine/stance.h"

#include "runner/base/checksum.h"

#include <math.h>

struct program_text {
    const char *file;       /* its name, for messages */
    const char *source;     /* C */
    const char *parameters; /* names that its scenario knows: "a;b[2];" */
    const double *data;     /* [count] */
    size_t count;
    uint64_t samples; /* points of sweep.sample, 1 without: names cases */
};

/* The end of what a law is told in each sample of a case: the equilibrium's coordinates, then
 * torques; NAN where the scenario names none. */
static inline void program_put_rest(const stance_case *c, double *target)
{
    const stance_scene *const scene = c->scene;
    double *const rest = target + scene->coordinates;
    for (int i = 0; i < scene->coordinates; i++)
        target[i] = NAN;
    for (int k = 0; k < scene->postures && c->has_target; k++)
        target[scene->posture[k]] = c->near.target[k];
    for (int i = 0; i < scene->actuators; i++)
        rest[i] = c->has_target ? c->near.feedforward[i] : NAN;
}

/* SHA-256 of a source: what is trusted. */
void program_hash(const char *source, char hash[CHECKSUM_SHA256_TEXT]);

/* Compiles it, or takes it from the cache, for the names and sizes of a scene; `numbers` its
 * scenario has of parameters, as many as it must ask for. NULL: the message says why in a line,
 * with file and line where the compiler does. */
stance_program *program_load(const struct program_text *text, const stance_scene *scene,
                             size_t numbers, stance_message *message);
/* The same as a module of WebAssembly, for a page, by clang whatever CC is; `image` is to be freed.
 * It is not called here, so it need not be trusted. */
bool program_for_page(const struct program_text *text, const stance_scene *scene,
                      struct image *image, stance_message *message);
/* Takes NULL, too. No case runs by it any more. */
void program_free(stance_program *program);

#endif
