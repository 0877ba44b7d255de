/* command_build.c - `stance build`: compiles what a scenario computes with, so that it is there in
 * time, and where there is no compiler.
 */
#include "asked.h"
#include "kernels.h"

#include "runner/objects/compiler.h"
#include "runner/objects/objects.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

extern const struct command command_build; /* below */

struct request {
    struct asked asked;
    struct option_texts methods, isas;
};

static int fail(const char *text)
{
    fprintf(stderr, "stance build: %s\n", text);
    return EXIT_USAGE;
}

/* Designs are computed for the cases that the kernels are tried on. */
static int take(struct plan *plan, const struct kernels_choice *choice)
{
    const struct parallel alone = parallel_alone();
    struct plan_error error;
    struct kernels *const kernels = calloc(1, sizeof *kernels);
    stance_message message;
    if (!kernels)
        return fail(strerror(ENOMEM));
    plan->patience = PLAN_PATIENCE_DESIGNS;
    int code = EXIT_USAGE;
    if (!plan_compute_designs(plan, &alone, &error)) {
        fail(error.message.text);
    } else if ((code = kernels_take(kernels, plan, choice, &alone, &message)) != EXIT_DONE) {
        fail(message.text);
    } else {
        static const char *const said[] = {[OBJECT_KEPT] = "in the cache",
                                           [OBJECT_COMPILED] = "compiled",
                                           [OBJECT_UNKEPT] = "compiled, but not kept",
                                           [OBJECT_REFERENCE] = "built in",
                                           [OBJECT_MISSING] = "none: the one built in computes",
                                           [OBJECT_REFUSED] = "none: the one built in computes"};
        for (size_t i = 0; i < kernels->count; i++) {
            const struct object *const o = &kernels->object[i];
            printf("%-12s %-8s %s%s%s\n", o->kernel.method->name, o->kernel.isa, said[o->origin],
                   o->key[0] ? "  " : "", o->key);
            if (o->origin == OBJECT_UNKEPT || o->origin >= OBJECT_MISSING)
                code = EXIT_IO; /* it has been said why */
        }
        kernels_give_back(kernels);
    }
    free(kernels);
    return code;
}

static int build(const struct scenario *s, void *asked)
{
    const struct request *const request = asked;
    const struct kernels_choice choice = {request->methods.text,  request->isas.text,
                                          request->methods.count, request->isas.count,
                                          .always = true,         .again = true};
    struct plan plan;
    struct plan_error error;
    if (!plan_make(&plan, s, false, 0, false, &error))
        return fail(error.message.text);
    const int code = take(&plan, &choice);
    plan_free(&plan);
    return code;
}

static int run(int argc, char **argv)
{
    struct request request = {.methods = {0}};
    return asked_run(&command_build, argc, argv, build, &request);
}

static const struct option options[] = {
    {.rows = asked_options},
    {"--method", "NAME", OPTION_TO(struct request, methods), .word = asked_method,
     .text = "that method; otherwise those of the scenario"},
    {"--isa", "NAME", OPTION_TO(struct request, isas), .word = compiler_isa,
     .text = "for that instruction set, also one that this machine does not run; otherwise the "
             "one in use (stance --version)"},
    {OPTION_TIME_LIMIT},
    {0},
};

const struct command command_build = {
    "build",
    "compiles what a scenario computes with, for machines without a compiler",
    run,
    options,
    "Kernels for what a scenario describes are compiled when they are first needed, while those "
    "that are built in begin, by CC, cc, gcc or clang, and kept in a cache: STANCE_CACHE, else "
    "XDG_CACHE_HOME/stance, else ~/.cache/stance. This command does it ahead; a file of the cache "
    "may be copied to the cache of another machine.",
    "What is compiled is tried on cases of the scenario before it is kept: an object that "
    "computes something else than the kernel that is built in is refused. That is remembered for "
    "the compiler and the version, and the kernel that is built in computes, more slowly, until "
    "CC names another compiler or this command, which tries again, has an object that is right. "
    "Exit codes: 0 all there, 2 bad use or scenario, 3 something is not in the cache now, for the "
    "reason that is said.",
};
