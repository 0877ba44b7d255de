/* adopt.c - what a file is whose rows are taken over, and how its scenario differs from another. */
#include "adopt.h"

#include "runner/base/message.h"

#include <math.h>
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

/* ---- places ------------------------------------------------------------------------------- */

uint64_t adopt_row(const struct adopted *a, uint64_t row)
{
    if (a->points == 0)
        return row;
    const uint64_t outer = row / a->inner / a->points;
    const size_t point = (size_t)(row / a->inner % a->points);
    return (outer * a->all + (a->position ? a->position[point] : point)) * a->inner +
           row % a->inner;
}

double adopt_distance(const double *x, const double *y, size_t count, size_t stride)
{
    double scale = 0, distance = 0;
    for (size_t i = 0; i < count * stride; i += stride) {
        if (isfinite(x[i]) != isfinite(y[i]))
            return INFINITY;
        if (isfinite(x[i])) {
            scale = fmax(scale, fabs(x[i]));
            distance = fmax(distance, fabs(x[i] - y[i]));
        }
    }
    return distance > 0 ? distance / scale : 0;
}

double adopt_designs(const struct adopted *a, struct plan *plan, bool *taken)
{
    const struct plan *const own = &a->plan;
    double most = 0;
    for (size_t d = 0; d < own->designs; d++) {
        const size_t at = plan_design(plan, adopt_row(a, plan_design_case(own, d)));
        if (taken && taken[at]) {
            most = plan->design_status[at] != own->design_status[d]
                       ? INFINITY
                       : fmax(most, adopt_distance(&plan->design[at * plan->design_size],
                                                   &own->design[d * plan->design_size],
                                                   plan->design_size, 1));
            continue;
        }
        plan_take_design(plan, at, own, d);
        if (taken)
            taken[at] = true;
    }
    return most;
}

/* ---- differences -------------------------------------------------------------------------- */

bool adopt_tree(struct tree *tree, const char *file, const char *text, stance_message *message)
{
    struct problems *problems = calloc(1, sizeof *problems);
    *tree = (struct tree){0};
    const bool good = problems && text && tree_parse(tree, text, strlen(text), problems);
    free(problems);
    if (!good) {
        tree_free(tree);
        complain(message, "%.100s: its scenario cannot be read", file);
    }
    return good;
}

void adopt_differ(const struct tree_node *a, const struct tree_node *b, const char *path,
                  const struct adopted_differences *differences)
{
    char below[128];
    if (!a || !b || a->kind != b->kind || (a->kind == TREE_LIST && a->count != b->count) ||
        (a->kind == TREE_SCALAR && strcmp(a->text, b->text) != 0)) {
        differences->tell(differences->context, path, a, b);
        return;
    }
    for (size_t i = 0; i < a->count; i++) {
        if (a->kind == TREE_LIST)
            snprintf(below, sizeof below, "%.100s[%zu]", path, i);
        else
            snprintf(below, sizeof below, "%.60s%s%.64s", path, path[0] ? "." : "", a->key[i].name);
        adopt_differ(a->item[i], a->kind == TREE_LIST ? b->item[i] : tree_find(b, a->key[i].name),
                     below, differences);
    }
    for (size_t i = 0; b->kind == TREE_MAP && i < b->count; i++) {
        if (!tree_find(a, b->key[i].name)) {
            snprintf(below, sizeof below, "%.60s%s%.64s", path, path[0] ? "." : "", b->key[i].name);
            differences->tell(differences->context, below, NULL, b->item[i]);
        }
    }
}
