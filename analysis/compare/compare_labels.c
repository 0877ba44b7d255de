/* compare_labels.c - counts, and distances by the two passes of A. Rosenfeld and J. Pfaltz (1968),
 * Distance functions on digital pictures, exact for this metric.
 */
#include "compare_labels.h"

#include "runner/base/message.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- neighbours --------------------------------------------------------------------------- */

/* The axes along which cases are neighbours. */
struct lattice {
    const struct results *r;
    bool along[SCENARIO_MAX_AXES];
};

static bool find_refined(const struct results *r, bool *along)
{
    bool any = false;
    for (int a = 0; r->read && a < r->read->axes && a < r->axes; a++) {
        along[a] = along[a] || r->read->axis[a].refined;
        any = any || along[a];
    }
    return any;
}

/* Goes to the next neighbour of the case at `point`: step[] counts through -1, 0, 1 along each
 * axis. False: that was the last. *index is the neighbour's, UINT64_MAX where it is beyond the
 * grid. */
static bool next_neighbour(const struct lattice *lattice, const size_t *point, int *step,
                           uint64_t *index)
{
    int a = lattice->r->axes - 1;
    for (; a >= 0 && (!lattice->along[a] || step[a] == 1); a--)
        step[a] = lattice->along[a] ? -1 : 0;
    if (a < 0)
        return false;
    step[a]++;
    *index = 0;
    for (a = 0; a < lattice->r->axes; a++) {
        const size_t count = lattice->r->axis[a].count;
        if ((step[a] < 0 && point[a] == 0) || (step[a] > 0 && point[a] + 1 == count)) {
            *index = UINT64_MAX;
            return true;
        }
        *index = *index * count + point[a] + (size_t)step[a];
    }
    return true;
}

/* Least distance of a case that its neighbours before (way < 0) or after it tell. */
static uint32_t told(const struct lattice *lattice, const uint32_t *distance, uint64_t i, int way)
{
    size_t point[SCENARIO_MAX_AXES];
    int step[SCENARIO_MAX_AXES];
    uint32_t least = distance[i];
    uint64_t index;

    results_point(lattice->r, i, point);
    int last = -1;
    for (int a = 0; a < lattice->r->axes; a++) {
        step[a] = lattice->along[a] ? -1 : 0;
        last = lattice->along[a] ? a : last;
    }
    if (last >= 0)
        step[last]--; /* before the first neighbour */
    while (next_neighbour(lattice, point, step, &index)) {
        if (index == UINT64_MAX || (way < 0 ? index >= i : index <= i))
            continue;
        const uint32_t by = lattice->r->kind[index] != lattice->r->kind[i] ? 1
                            : distance[index] < UINT32_MAX                 ? distance[index] + 1
                                                                           : UINT32_MAX;
        least = by < least ? by : least;
    }
    return least;
}

/* ---- comparing ---------------------------------------------------------------------------- */

/* Starts at other places are other cases. */
static bool same_values(const struct results_axis *first, const struct results_axis *second)
{
    bool same = first->count == second->count;
    for (size_t i = 0; same && i < first->count && scenario_is_start(first->name); i++)
        same = fabs(first->value[i] - second->value[i]) <=
               1e-9 * fmax(fabs(first->value[i]), fabs(second->value[i]));
    return same;
}

/* The share of what was in the domain of the first file at a point of the sample that is not in
 * that of the second, over the points. */
static bool find_interval(struct label_comparison *c, const struct results *first,
                          const struct results *second)
{
    enum { LOST, HAD };
    const size_t points = first->sample < 0 ? 0 : first->axis[first->sample].count;
    const size_t block = first->block > 0 ? first->block : 1, blocks = (points + block - 1) / block;
    double *count = calloc(blocks + 1, 2 * sizeof *count);
    struct interval_draws draws = {0};
    for (uint64_t i = 0; count && points > 0 && i < first->cases; i++) {
        if (first->kind[i] == c->of && second->kind[i] != RESULTS_PENDING) {
            double *own = count + 2 * (i % points / block); /* the sample is the last axis */
            own[LOST] += second->kind[i] != c->of;
            own[HAD]++;
        }
    }
    for (size_t b = 0; count && b < blocks; b++)
        interval_add(&draws, count[2 * b + LOST], count[2 * b + HAD]);
    c->lost_interval = interval_of(&draws, 0.95);
    free(count);
    return count != NULL;
}

bool compare_labels(struct label_comparison *comparison, const struct results *first,
                    const struct results *second, enum results_kind of, stance_message *message)
{
    *comparison = (struct label_comparison){.of = of};
    bool axes = first->axes == second->axes && first->cases == second->cases &&
                first->single == second->single;
    bool starts = first->varied == second->varied;
    for (int a = 0; axes && a < first->axes; a++)
        axes = first->axis[a].count == second->axis[a].count &&
               strcmp(first->axis[a].name, second->axis[a].name) == 0;
    for (int a = 0; axes && starts && !first->single && a < first->axes; a++)
        starts = first->axis[a].word || same_values(&first->axis[a], &second->axis[a]);
    for (int k = 0; starts && k < first->varied; k++)
        starts = first->vary[k].word || same_values(&first->vary[k].of, &second->vary[k].of);
    if (!axes)
        return complain(message, "stance compare: %.90s and %.90s are not over the same axes",
                        first->file, second->file);
    if (!starts)
        return complain(message, "stance compare: the starts of %.80s and %.80s are not the same",
                        first->file, second->file);
    uint32_t *distance = malloc(first->cases * sizeof *distance);
    if (!distance || !find_interval(comparison, first, second)) {
        free(distance);
        return complain(message, "stance compare: not enough memory");
    }
    struct lattice lattice = {.r = first};
    const bool one = find_refined(first, lattice.along), two = find_refined(second, lattice.along);
    for (int a = 0; !one && !two && a < first->axes; a++)
        lattice.along[a] = first->axis[a].word == NULL && a != first->sample;
    memset(distance, 0xff, first->cases * sizeof *distance); /* no other label can be reached */
    for (uint64_t i = 0; i < first->cases; i++)
        distance[i] = told(&lattice, distance, i, -1);
    for (uint64_t i = first->cases; i-- > 0;)
        distance[i] = told(&lattice, distance, i, 1);
    for (uint64_t i = 0; i < first->cases; i++) {
        if (first->kind[i] == RESULTS_PENDING || second->kind[i] == RESULTS_PENDING)
            continue;
        comparison->compared++;
        comparison->cases[first->kind[i]][second->kind[i]]++;
        comparison->kept += first->kind[i] == of && second->kind[i] == of;
        comparison->lost += first->kind[i] == of && second->kind[i] != of;
        comparison->won += first->kind[i] != of && second->kind[i] == of;
        if (first->kind[i] == second->kind[i]) {
            comparison->equal++;
            continue;
        }
        if (distance[i] < UINT32_MAX && distance[i] > comparison->farthest)
            comparison->farthest = distance[i];
        if (comparison->shown < LABELS_SHOWN)
            comparison->place[comparison->shown++] = i;
    }
    free(distance);
    return true;
}
