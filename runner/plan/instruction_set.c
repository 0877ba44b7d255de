/* instruction_set.c - the fastest instruction set, or the one that STANCE_ISA names. */
#include "instruction_set.h"

#include "runner/base/message.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const char *instruction_set_asked(void)
{
    const char *name = getenv("STANCE_ISA");
    return name && name[0] ? name : NULL;
}

const char *instruction_set(void)
{
    const char *name = instruction_set_asked();
    return name ? name : stance_isa(0);
}

void instruction_set_names(char text[INSTRUCTION_SETS_SIZE])
{
    text[0] = '\0';
    for (int rank = 0; stance_isa(rank); rank++)
        add_text(text, INSTRUCTION_SETS_SIZE, "%s%s", rank ? ", " : "", stance_isa(rank));
}

bool instruction_set_runs(const char *isa)
{
    int rank = 0;
    while (stance_isa(rank) && strcmp(isa, stance_isa(rank)) != 0)
        rank++;
    return stance_isa(rank) != NULL;
}

bool instruction_set_check(stance_message *message)
{
    char names[INSTRUCTION_SETS_SIZE];
    if (instruction_set_runs(instruction_set()))
        return true;
    instruction_set_names(names);
    return complain(message, "STANCE_ISA is '%.40s'; instruction sets of this machine: %s",
                    instruction_set_asked(), names);
}

bool instruction_set_usable(const char *command)
{
    stance_message message;
    if (instruction_set_check(&message))
        return true;
    fprintf(stderr, "stance %s: %s\n", command, message.text);
    return false;
}

static const stance_scene *preferred_scene;
static const stance_kernel *const *preferred;
static size_t preferred_count;

void instruction_set_prefer(const stance_scene *scene, const stance_kernel *const *kernels,
                            size_t count)
{
    preferred_scene = scene;
    preferred = kernels;
    preferred_count = kernels ? count : 0;
}

const stance_kernel *instruction_set_kernel(const stance_scene *scene, const stance_method *method)
{
    for (size_t i = 0; i < preferred_count && scene == preferred_scene; i++)
        if (preferred[i]->method == method)
            return preferred[i];
    return stance_kernel_find(scene, method, instruction_set());
}
