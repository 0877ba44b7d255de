/* search_allowed.c - fresh starts against the null-controllable set of the chosen candidate's robot
 * (engine/control/null_controllable.c). */
#include "search_study.h"

#include "runner/plan/allowed.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Adds 1 to each start that is in the set; false: there is none. */
static bool add_circumstance(const struct scenario *s, size_t circumstance, double *count)
{
    const size_t starts = s->axis[s->axes - 1].count;
    struct allowed allowed;
    stance_message ignored;
    if (!allowed_make(&allowed, s, circumstance * starts, &ignored))
        return false;
    const bool exists = allowed.set != NULL;
    for (size_t i = 0; exists && i < starts; i++)
        count[i] += allowed_case(&allowed, s, circumstance * starts + i);
    allowed_free(&allowed);
    return exists;
}

/* Whether the scenario's last axis has what the file's starts are over. */
static bool has_starts(const struct scenario *s, const struct search_file *f)
{
    const struct scenario_axis *const axis = &s->axis[s->axes - 1];
    bool same = s->axes > 0 && s->sample.given && axis->value &&
                (size_t)axis->paths == f->length[SEARCH_VARIED];
    for (int k = 0; same && k < axis->paths; k++)
        same = strcmp(axis->path[k], f->varied[k]) == 0;
    return same;
}

bool search_allowed(const struct search_study *study, double *allowed)
{
    const struct search_file *const f = &study->f;
    const size_t starts = f->length[SEARCH_START];
    size_t from, to;
    if (!study->best || !scenario_law(&study->best->base)->designed || !has_starts(study->best, f))
        return false;
    search_circumstances(study, search_worst(study, (size_t)f->chosen), &from, &to);
    /* What it points to stays that of `best`; the points are the file's. */
    struct scenario *const fresh = malloc(sizeof *fresh);
    bool good = fresh != NULL;
    if (good) {
        *fresh = *study->best;
        fresh->axis[fresh->axes - 1].value = f->start_value;
        fresh->axis[fresh->axes - 1].count = starts;
    }
    memset(allowed, 0, starts * sizeof *allowed);
    for (size_t c = from; good && c < to; c++)
        good = add_circumstance(fresh, c, allowed);
    for (size_t i = 0; good && i < starts; i++)
        allowed[i] /= (double)(to - from);
    free(fresh);
    return good;
}
