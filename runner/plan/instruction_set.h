/* instruction_set.h - which of the engine's instruction sets this process computes with: the
 * fastest that this machine runs, or the one that the environment variable STANCE_ISA names.
 * Results are the same to the bit. */
#ifndef STANCE_PLAN_INSTRUCTION_SET_H
#define STANCE_PLAN_INSTRUCTION_SET_H

#include "engine/stance.h"

enum { INSTRUCTION_SETS_SIZE = 64 };

/* What STANCE_ISA says, unchecked; NULL where nothing. */
const char *instruction_set_asked(void);
/* The name of the one in use, as stance_kernel.isa. */
const char *instruction_set(void);

/* Whether this machine runs one. */
bool instruction_set_runs(const char *isa);

/* Whether STANCE_ISA, where set, names one that this machine runs; else `message` says so. */
bool instruction_set_check(stance_message *message);
/* The same for a command that computes: prints "stance COMMAND: " and the message. */
bool instruction_set_usable(const char *command);

/* Names of all that this build has and this machine runs, fastest first: "avx2, scalar, sse2". */
void instruction_set_names(char text[INSTRUCTION_SETS_SIZE]);

/* Kernels that are compiled on demand for a scene come before others. They stay where they are;
 * NULL: none any more. */
void instruction_set_prefer(const stance_scene *scene, const stance_kernel *const *kernels,
                            size_t count);

/* The kernel for a scene and a method, or NULL. */
const stance_kernel *instruction_set_kernel(const stance_scene *scene, const stance_method *method);

#endif
