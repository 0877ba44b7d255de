/* adopt.c - see adopt.h. */
#include "adopt.h"

#include "runner/base/message.h"

#include <stdlib.h>

struct scenario *adopt_text(const char *file, const char *text, stance_message *message)
{
    char *said = NULL;
    size_t size = 0;
    FILE *errors = open_memstream(&said, &size);
    struct scenario *const s = errors ? scenario_new(file, text, NULL, 0, errors) : NULL;
    if (errors)
        fclose(errors);
    if (!s && said)
        complain(message, "%.*s", (int)strcspn(said, "\n"), said);
    else if (!s)
        no_memory(message);
    free(said);
    return s;
}

bool adopt_scenario(struct adopted *a, stance_message *message)
{
    struct scenario *const s = a->scenario = adopt_text(a->file, a->origin.scenario, message);
    const bool good = s && store_read_axes(a->file, s->axis, s->axes, message);
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
    scenario_drop(a->scenario);
    a->scenario = NULL;
    a->store = NULL;
}
