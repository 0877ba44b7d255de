/* search_numbers.c - see search_numbers.h. */
#include "search_numbers.h"
#include "resolve.h"

#include <stddef.h>
#include <string.h>

/* Of the columns of gains those that may be other than 0: all where there is no equilibrium. */
static int find_free(const struct scenario *s, bool *column)
{
    const int columns = 2 * s->scene->postures;
    double model[STANCE_MAX_ROBOT];
    stance_equilibrium equilibrium;
    stance_message ignored;
    int count = 0;
    if (resolve_equilibrium(s->scene, &s->base, model, &equilibrium, &ignored))
        resolve_free(s->scene, &equilibrium, column);
    else
        memset(column, true, (size_t)columns * sizeof *column);
    for (int k = 0; k < columns; k++)
        count += column[k];
    return count;
}

/* Whether number k may differ. */
static bool is_free(const struct scenario *s, int k, const bool *column)
{
    const size_t gains = offsetof(struct scenario_values, gains), at = s->search.axis.offset[k];
    return at < gains || at >= gains + sizeof s->base.gains ||
           column[(at - gains) / sizeof(double) % (2 * (size_t)s->scene->postures)];
}

int search_numbers(const struct scenario *s)
{
    bool column[2 * STANCE_MAX_POSTURE];
    const int columns = find_free(s, column);
    int count = s->search.designed_gains ? s->scene->actuators * columns : 0;
    for (int k = 0; k < s->search.axis.paths; k++)
        count += is_free(s, k, column);
    return count;
}

void search_numbers_keep(struct scenario *s)
{
    struct scenario_axis *const axis = &s->search.axis;
    bool column[2 * STANCE_MAX_POSTURE];
    int kept = 0;
    find_free(s, column);
    for (int k = 0; k < axis->paths; k++) {
        if (!is_free(s, k, column))
            continue;
        memmove(axis->path[kept], axis->path[k], sizeof axis->path[k]);
        axis->offset[kept] = axis->offset[k];
        axis->integer[kept] = axis->integer[k];
        axis->enumeration[kept] = axis->enumeration[k];
        s->search.varied[kept++] = s->search.varied[k];
    }
    axis->paths = kept;
}
