/* distinct.c - no two points of an axis may be the same: whoever looks a case up by its values, as
 * xarray's sel does, would find several.
 */
#include "mend.h"
#include "reader.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>

/* A point as the file has it: "0.1", "[0.1, 4]". */
static void point_text(const struct axis_reader *a, const struct tree_node *node, char *text,
                       size_t size)
{
    const bool row = node->kind == TREE_LIST;
    snprintf(text, size, "%s", row ? "[" : "");
    for (int k = 0; k < a->axis->paths; k++) {
        char word[SHOWN_SIZE];
        add_text(text, size, "%s%s", k ? ", " : "",
                 shown(word, row ? node->item[k]->text : node->text));
    }
    add_text(text, size, "%s", row ? "]" : "");
}

/* A point of a list. (Pages have no qsort_r.) */
struct listed {
    const struct scenario_axis *axis;
    size_t place;
};

/* By their values: below 0, 0 (the same point), above 0. */
static int compare(const struct scenario_axis *axis, size_t a, size_t b)
{
    for (int k = 0; k < axis->paths; k++) {
        const double x = scenario_axis_value(axis, a, k), y = scenario_axis_value(axis, b, k);
        if (x != y) /* 0 and -0 are the same */
            return x < y ? -1 : 1;
    }
    return 0;
}

/* ... then by their place in the list. */
static int compare_points(const void *left, const void *right)
{
    const struct listed *const a = left, *const b = right;
    const int order = compare(a->axis, a->place, b->place);
    return order ? order : a->place < b->place ? -1 : a->place > b->place;
}

bool axis_check_values(struct axis_reader *a, const struct tree_node *values)
{
    const size_t n = a->axis->count;
    struct listed *const order = malloc(n * sizeof *order);
    size_t at = 1;
    if (!order)
        return problem_no_memory(&a->r->problems);
    for (size_t i = 0; i < n; i++)
        order[i] = (struct listed){a->axis, i};
    qsort(order, n, sizeof *order, compare_points);
    while (at < n && compare(a->axis, order[at - 1].place, order[at].place) != 0)
        at++;
    const bool good = at >= n;
    if (!good) {
        const struct tree_node *const one = values->item[order[at - 1].place];
        const struct tree_node *const other = values->item[order[at].place];
        char first[128], second[128];
        point_text(a, one, first, sizeof first);
        point_text(a, other, second, sizeof second);
        problem_add(&a->r->problems, other->mark,
                    "%s: %s is the same point as %s in line %d, column %d: each may be there once",
                    a->name, second, first, one->mark.line, one->mark.column);
    }
    free(order);
    return good;
}

bool axis_check_points(struct axis_reader *a)
{
    const struct scenario_axis *axis = a->axis;
    const double largest = fmax(fabs(axis->from), fabs(axis->to)),
                 step = fabs(axis->to - axis->from) / (double)axis->count;
    if (!axis->value && step > 8 * DBL_EPSILON * largest)
        return true;
    for (size_t i = 1; i < axis->count; i++)
        if (compare(axis, i - 1, i) == 0)
            return problem_add(&a->r->problems, tree_find(a->node, "count")->mark,
                               "%s: points %zu and %zu of this range are the same number, %.17g: "
                               "there are fewer than count between from and to",
                               a->name, i - 1, i, scenario_axis_value(axis, i, 0));
    return true;
}
