/* command_build.c - `stance build`: compiles what a scenario computes with, so that it is there in
 * time, and where there is no compiler.
 */
#include "instruction_set.h"
#include "kernels.h"

#include "runner/base/command.h"
#include "runner/objects/objects.h"
#include "runner/scenario/scenario.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

extern const struct command command_build; /* below */

enum { MOST = 16, MAX_SETS = 64 };

/* What was asked for. */
struct choice {
    const char *word[MOST];
    size_t count;
};

/* Are all of these words known? */
static bool known(const char *option, const struct choice *choice, const char *const *words,
                  size_t count)
{
    for (size_t i = 0; i < choice->count; i++)
        if (command_word(&command_build, option, choice->word[i], words, count) == count)
            return false;
    return true;
}

static bool choices_known(const struct choice *methods, const struct choice *isas)
{
    const char *method[MOST], *isa[MOST];
    size_t m = 0, i = 0;
    for (; m < MOST && stance_methods()[m]; m++)
        method[m] = stance_methods()[m]->name;
    for (; i < MOST && objects_isa(i); i++)
        isa[i] = objects_isa(i);
    return known("--method", methods, method, m) && known("--isa", isas, isa, i);
}

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
    } else if ((code = kernels_take(kernels, plan, choice, &alone, false, &message)) != EXIT_DONE) {
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

static int build(const struct scenario *s, const struct kernels_choice *choice)
{
    struct plan plan;
    struct plan_error error;
    if (s->scene->mechanism) {
        if (!plan_make(&plan, s, false, 0, false, &error))
            return fail(error.message.text);
        const int code = take(&plan, choice);
        plan_free(&plan);
        return code;
    }
    printf("%s: the scene %s is built in: nothing is to be compiled\n", s->file, s->scene->name);
    return EXIT_DONE;
}

static int run(int argc, char **argv)
{
    struct choice methods = {.count = 0}, isas = {.count = 0};
    const char *sets[MAX_SETS], *file = NULL;
    size_t set_count = 0, operands = 0;
    const struct option_spec specs[] = {
        {"--method", true, methods.word, MOST, &methods.count},
        {"--isa", true, isas.word, MOST, &isas.count},
        {"--set", true, sets, MAX_SETS, &set_count},
    };
    int code =
        command_begin(&command_build, argc, argv, specs, 3, "a scenario", &file, 1, 1, &operands);
    if (code != COMMAND_GOES_ON)
        return code;
    if (!choices_known(&methods, &isas) || !instruction_set_usable("build"))
        return EXIT_USAGE;
    struct scenario *s = malloc(sizeof *s);
    if (!s) {
        fprintf(stderr, "stance build: %s\n", strerror(ENOMEM));
        return EXIT_IO;
    }
    code = EXIT_USAGE;
    if (scenario_read(s, file, NULL, sets, set_count, stderr)) {
        code = build(
            s, &(struct kernels_choice){methods.word, isas.word, methods.count, isas.count, true});
        scenario_free(s);
    } else if (access(file, R_OK) != 0) {
        code = EXIT_IO;
    }
    free(s);
    return code;
}

const struct command command_build = {
    "build",
    "build SCENARIO [--method NAME]... [--isa NAME]... [--set PATH=VALUE]...\n"
    "           [--time-limit TIME]",
    "compiles what a scenario computes with, for machines without a compiler",
    run,
    "Kernels for what a scenario describes are compiled when they are first needed, by CC, cc, "
    "gcc\n"
    "or clang, and kept in a cache: STANCE_CACHE, else XDG_CACHE_HOME/stance, else\n"
    "~/.cache/stance. This command does it ahead; a file of the cache may be copied to the cache "
    "of\n"
    "another machine. Scenes that the program has (biped, ball, block, rod) need nothing "
    "compiled.\n"
    "\n"
    "  --method NAME  that method; otherwise those of the scenario\n"
    "  --isa NAME     for that instruction set, also one that this machine does not run;\n"
    "                 otherwise the one in use (stance --version)\n"
    "  --set          replaces a value, as everywhere\n"
    "  --time-limit TIME  end after 90s, 55m, 1h30m ... of wall time, with exit code 4\n"
    "\n"
    "What is compiled is tried on cases of the scenario before it is kept: an object that "
    "computes\n"
    "something else than the kernel that is built in is refused. That is remembered for the\n"
    "compiler and the version, and the kernel that is built in computes, more slowly, until CC\n"
    "names another compiler or this command, which tries again, has an object that is right. Exit\n"
    "codes: 0 all there, 2 bad use or scenario, 3 something is not in the cache now, for the\n"
    "reason that is said.\n",
};
