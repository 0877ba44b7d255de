/* page_law.c - a law of the user's own in a page: a module of its own beside the engine's, which
 * the page calls (law.ts) with copies of what it is told and of its memory. */
#include "page.h"

#include "runner/base/message.h"
#include "runner/objects/program.h"

#include <stdlib.h>
#include <string.h>

/* Calls the law: `at` begins with what it is told, then parameters, memory, torques; so many
 * numbers of each. 0: it trapped. */
__attribute__((import_module("page"), import_name("law"))) int page_law(double *at, int numbers);

static struct {
    stance_program base;
    size_t memory; /* numbers that it keeps */
} law;

static size_t told(const stance_case *c)
{
    return STANCE_SAMPLE_HEAD + 3 * (size_t)c->scene->coordinates + (size_t)c->scene->contacts +
           (size_t)c->scene->actuators;
}

static double *begin(const stance_program *program, const stance_case *c)
{
    const size_t actuators = (size_t)c->scene->actuators;
    const size_t numbers = page.view.law.numbers;
    double *const sample = calloc(told(c) + numbers + law.memory + actuators, sizeof *sample);
    (void)program;
    if (!sample)
        return NULL;
    program_put_rest(c, sample + told(c) - actuators - c->scene->coordinates);
    memcpy(sample + told(c), c->parameter, numbers * sizeof *sample);
    return sample;
}

static const double *act(const stance_program *program, const stance_case *c, double *sample)
{
    const size_t before = told(c) + page.view.law.numbers + law.memory,
                 actuators = (size_t)c->scene->actuators;
    double *const out = sample + before, sum = 0;
    (void)program;
    memset(out, 0, actuators * sizeof *out);
    if (!page_law(sample, (int)(before + actuators)))
        return NULL;
    for (size_t i = 0; i < actuators; i++)
        sum += out[i] - out[i];
    return sum == 0 ? out : NULL;
}

static void end(const stance_program *program, double *sample)
{
    (void)program;
    free(sample);
}

EXPORTED(void, file_law, int memory)
{
    law.base = (stance_program){memory > 0, begin, act, end};
    law.memory = (size_t)memory;
}

bool page_take_law(struct scenario *s)
{
    if (!s->law.source)
        return true;
    s->base.program = &law.base;
    return law.base.begin ||
           complain(&page.message, "this page was made without the law of controller.file");
}
