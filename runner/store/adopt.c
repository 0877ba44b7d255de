/* adopt.c - see adopt.h. */
#include "adopt.h"

#include "runner/base/message.h"

#include <stdlib.h>

bool adopt_text(struct scenario *scenario, const char *file, const char *text,
                stance_message *message)
{
    char *said = NULL;
    size_t size = 0;
    FILE *errors = open_memstream(&said, &size);
    if (!errors)
        return no_memory(message);
    const bool good = scenario_read(scenario, file, text, NULL, 0, errors);
    fclose(errors);
    if (!good)
        complain(message, "%.*s", (int)strcspn(said, "\n"), said);
    free(said);
    return good;
}

bool adopt_scenario(struct adopted *a, stance_message *message)
{
    struct scenario *const s = a->scenario = calloc(1, sizeof *s);
    const bool good = s ? adopt_text(s, a->file, a->origin.scenario, message) &&
                              store_read_axes(a->file, s->axis, s->axes, message)
                        : no_memory(message);
    if (!good)
        adopt_close(a);
    return good;
}

bool adopt_open(struct adopted *a, stance_message *message)
{
    struct plan_error error;
    if (!plan_make(&a->plan, a->scenario, false, 0, false, &error))
        return complain(message, "%.60s: %.160s", a->file, error.message.text);
    a->plan.ancestors = a->origin.ancestors;
    return store_open_to_read(&a->store, a->file, &a->plan, message) &&
           store_read_designs(a->store, &a->plan, message);
}

void adopt_close(struct adopted *a)
{
    stance_message ignored;
    if (a->store)
        store_close(a->store, &ignored);
    plan_free(&a->plan);
    if (a->scenario)
        scenario_free(a->scenario);
    free(a->scenario);
    a->scenario = NULL;
    a->store = NULL;
}
