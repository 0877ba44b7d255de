/* kernels.h - the kernels of a plan whose scene is described: compiled for its structure, taken
 * from the cache or, where neither can be, those that read it at run time. */
#ifndef STANCE_PLAN_KERNELS_H
#define STANCE_PLAN_KERNELS_H

#include "instruction_set.h"
#include "plan.h"

#include "runner/objects/objects.h"

struct kernels {
    struct object object[OBJECTS_MOST];
    const stance_kernel *kernel[OBJECTS_MOST];
    size_t count;
    bool brief;                  /* so little is to be computed that nothing is compiled for it */
    struct objects_later *later; /* NULL: all are there */
};

/* All 0: the plan's methods for the instruction set in use, compiled where the plan's cases take
 * longer than that. */
struct kernels_choice {
    const char *const *method, *const *isa; /* others: names, or 0 of them */
    size_t methods, isas;
    bool always; /* compiles however little there is to compute */
    bool again;  /* compiles what was refused before, and what is built in */
    bool quiet;  /* says nothing where all goes well */
    bool looks;  /* compiles nothing, and leaves the cache as it is */
    bool later;  /* those that are built in compute while others are compiled */
};

/* Collective: takes what is chosen; from then on instruction_set_kernel gives them. Built-in scenes
 * need nothing. Needs the designs. Exit codes and message as objects_take; *kernels is to be given
 * back where it is EXIT_DONE. */
enum exit_code kernels_take(struct kernels *kernels, const struct plan *plan,
                            const struct kernels_choice *choice, const struct parallel *parallel,
                            stance_message *message);
/* What `run` would have before it computes: `kernels` are those that there are now, from the cache
 * or built in; nothing is compiled, touched or said. Of those that are not there but can be
 * compiled, about how many seconds that takes (0: there are none) and what they take of the time of
 * those that compute here; brief: so little is to be computed that run compiles none. */
struct kernels_outlook {
    double compiling, share;
    bool brief;
};
struct kernels_outlook kernels_look(struct kernels *kernels, const struct plan *plan);
/* Each rank for itself and between two streams, when objects_later_ended on rank 0: takes what has
 * come later. */
void kernels_change(struct kernels *kernels);
/* "avx2", "avx512, scalar": what the plan's methods compute with. */
void kernels_instruction_sets(const struct plan *plan, char text[INSTRUCTION_SETS_SIZE]);
void kernels_give_back(struct kernels *kernels);

#endif
