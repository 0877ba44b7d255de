/* distinct.c - no two points of an axis may be the same: whoever looks a case up by its values, as
 * xarray's sel does, would find several.
 */
#include "mend.h"
#include "reader.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A point as the file has it: "0.1", "[0.1, 4]". */
static void point_text(const struct axis_reader *a, const struct tree_node *node, char *text,
                       size_t size)
{
    const bool row = node->kind == TREE_LIST;
    size_t used = row ? (size_t)snprintf(text, size, "[") : 0;
    for (int k = 0; k < a->axis->paths && used < size; k++) {
        char word[SHOWN_SIZE];
        shown(word, row ? node->item[k]->text : node->text);
        used += (size_t)snprintf(text + used, size - used, "%s%s", k ? ", " : "", word);
    }
    if (row && used < size)
        snprintf(text + used, size - used, "]");
}

/* A point of a list: its values, and where it stands. */
struct listed {
    const double *value; /* [paths] */
    size_t paths, place;
};

static int compare_listed(const void *left, const void *right)
{
    const struct listed *a = left, *b = right;
    for (size_t k = 0; k < a->paths; k++)
        if (a->value[k] != b->value[k]) /* 0 and -0 are the same */
            return a->value[k] < b->value[k] ? -1 : 1;
    return a->place < b->place ? -1 : a->place > b->place;
}

static bool same_point(const double *a, const double *b, size_t paths)
{
    bool same = true;
    for (size_t k = 0; k < paths; k++)
        same = same && a[k] == b[k];
    return same;
}

bool axis_check_values(struct axis_reader *a, const struct tree_node *values)
{
    const size_t n = a->axis->count, paths = (size_t)a->axis->paths;
    struct listed *list = malloc(n * sizeof *list);
    char first[128], second[128];
    size_t at = 1;
    if (!list)
        return problem_no_memory(&a->r->problems);
    for (size_t i = 0; i < n; i++)
        list[i] = (struct listed){&a->axis->value[i * paths], paths, i};
    qsort(list, n, sizeof *list, compare_listed);
    while (at < n && !same_point(list[at - 1].value, list[at].value, paths))
        at++;
    const bool good = at >= n;
    if (!good) {
        const struct tree_node *const one = values->item[list[at - 1].place],
                                      *const other = values->item[list[at].place];
        point_text(a, one, first, sizeof first);
        point_text(a, other, second, sizeof second);
        problem_add(&a->r->problems, other->mark,
                    "%s: %s is the same point as %s in line %d, column %d: each may be there once",
                    a->name, second, first, one->mark.line, one->mark.column);
    }
    free(list);
    return good;
}

bool axis_check_points(struct axis_reader *a)
{
    const struct scenario_axis *axis = a->axis;
    const size_t paths = (size_t)axis->paths;
    const double largest = fmax(fabs(axis->from), fabs(axis->to)),
                 step = fabs(axis->to - axis->from) / (double)axis->count;
    double before[SCENARIO_MAX_PATHS] = {0}, here[SCENARIO_MAX_PATHS] = {0};
    if (!axis->value && step > 8 * DBL_EPSILON * largest)
        return true;
    for (size_t i = 0; i < axis->count; i++, memcpy(before, here, sizeof here)) {
        for (size_t k = 0; k < paths; k++)
            here[k] = scenario_axis_value(axis, i, (int)k);
        if (i > 0 && same_point(before, here, paths))
            return problem_add(&a->r->problems, tree_find(a->node, "count")->mark,
                               "%s: points %zu and %zu of this range are the same number, %.17g: "
                               "there are fewer than count between from and to",
                               a->name, i - 1, i, here[0]);
    }
    return true;
}
