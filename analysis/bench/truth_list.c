/* truth_list.c - reads a list of truths. */
#include "truth.h"

#include "runner/scenario/reader.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

struct reading {
    struct truth_list *list;
    struct problems problems;
};

static bool take_text(struct reading *r, const struct tree_node *node, const char **out)
{
    if (node->kind != TREE_SCALAR)
        return problem_add(&r->problems, node->mark, "a text is needed");
    *out = node->text;
    return true;
}

static bool take_number(struct reading *r, const struct tree_node *node, double *out)
{
    char *end = NULL;
    *out = node->kind == TREE_SCALAR ? strtod(node->text, &end) : NAN;
    return (end && end != node->text && *end == '\0' && isfinite(*out)) ||
           problem_add(&r->problems, node->mark, "a number is needed");
}

static bool take_texts(struct reading *r, const struct tree_node *node, const char **out,
                       size_t most, size_t *count)
{
    if (node->kind != TREE_LIST || node->count > most)
        return problem_add(&r->problems, node->mark, "a list of at most %zu texts is needed", most);
    bool good = true;
    for (*count = 0; good && *count < node->count; ++*count)
        good = take_text(r, node->item[*count], &out[*count]);
    return good;
}

static bool take_pair(struct reading *r, const struct tree_node *node, double out[2])
{
    if (node->kind != TREE_LIST || node->count != 2)
        return problem_add(&r->problems, node->mark, "a list of two numbers is needed");
    return take_number(r, node->item[0], &out[0]) && take_number(r, node->item[1], &out[1]);
}

/* The file beside the list. */
static bool take_scenario(struct reading *r, const struct tree_node *node, char *path)
{
    const char *name, *file = r->list->file, *slash = strrchr(file, '/');
    if (!take_text(r, node, &name))
        return false;
    const int n =
        snprintf(path, TRUTH_PATH, "%.*s%s", slash ? (int)(slash + 1 - file) : 0, file, name);
    return n < TRUTH_PATH || problem_add(&r->problems, node->mark, "too long a path");
}

static bool take_key(struct reading *r, struct truth_row *row, const struct tree_key *key,
                     const struct tree_node *node)
{
    const char *const name = key->name;
    if (strcmp(name, "truth") == 0)
        return take_text(r, node, &row->name);
    if (strcmp(name, "scenario") == 0)
        return take_scenario(r, node, row->scenario);
    if (strcmp(name, "source") == 0)
        return take_text(r, node, &row->source);
    if (strcmp(name, "set") == 0)
        return take_texts(r, node, row->set, TRUTH_SETS, &row->sets);
    if (strcmp(name, "read") == 0)
        return take_text(r, node, &row->read);
    if (strcmp(name, "trace") == 0)
        return take_texts(r, node, row->trace, TRUTH_TRACE, &row->traces);
    if (strcmp(name, "border") == 0)
        return take_text(r, node, &row->border);
    if (strcmp(name, "between") == 0)
        return take_pair(r, node, row->between);
    if (strcmp(name, "level") == 0)
        return take_number(r, node, &row->level);
    if (strcmp(name, "value") == 0)
        return take_number(r, node, &row->value);
    if (strcmp(name, "bar") == 0)
        return take_number(r, node, &row->bar);
    return problem_add(&r->problems, key->mark,
                       "unknown key '%s'; there are truth, scenario, set, read, trace, border, "
                       "between, level, value, bar, source",
                       name);
}

static bool take_row(struct reading *r, struct truth_row *row, const struct tree_node *node)
{
    *row = (struct truth_row){.value = NAN, .bar = NAN, .level = 0.5, .mark = node->mark};
    if (node->kind != TREE_MAP)
        return problem_add(&r->problems, node->mark, "a mapping is needed: {truth: ...}");
    bool good = true;
    for (size_t k = 0; k < node->count; k++)
        good = take_key(r, row, &node->key[k], node->item[k]) && good;
    row->kind = row->traces > 0 ? TRUTH_AS_TRACE : row->border ? TRUTH_AS_BORDER : TRUTH_AS_READ;
    if (!good)
        return false;
    if (!row->name || !row->source || !row->scenario[0] || isnan(row->value) || isnan(row->bar))
        return problem_add(&r->problems, node->mark,
                           "truth, scenario, value, bar and source are needed");
    if ((row->traces > 0) == (row->read != NULL))
        return problem_add(&r->problems, node->mark, "either read or trace is needed");
    if (row->bar < 0)
        return problem_add(&r->problems, node->mark, "bar is 0 (exact) or more");
    return row->kind != TRUTH_AS_BORDER || row->between[0] != row->between[1] ||
           problem_add(&r->problems, node->mark, "border needs between: [from, to]");
}

static bool take_rows(struct reading *r)
{
    const struct tree_node *const root = r->list->tree.root;
    const struct tree_node *const all = root->kind == TREE_MAP ? tree_find(root, "truths") : NULL;
    if (!all || all->kind != TREE_LIST)
        return problem_add(&r->problems, root->mark, "a list `truths` is needed");
    if (all->count == 0)
        return problem_add(&r->problems, all->mark, "no truth is in the list");
    r->list->row = calloc(all->count + 1, sizeof *r->list->row);
    if (!r->list->row)
        return problem_no_memory(&r->problems);
    bool good = true;
    for (size_t i = 0; i < all->count; i++)
        good = take_row(r, &r->list->row[i], all->item[i]) && good;
    r->list->rows = all->count;
    return good;
}

bool truth_list_read(struct truth_list *list, const char *file)
{
    struct reading *const r = calloc(1, sizeof *r);
    size_t length = 0;
    *list = (struct truth_list){.rows = 0};
    if (!r) {
        fprintf(stderr, "%s: out of memory\n", file);
        return false;
    }
    r->list = list;
    snprintf(list->file, sizeof list->file, "%s", file);
    char *const text = scenario_text(file, &r->problems, &length);
    const bool good = text && tree_check_text(text, length, &r->problems) &&
                      tree_parse(&list->tree, text, length, &r->problems) && take_rows(r) &&
                      r->problems.count == 0;
    if (!good) {
        problems_print(&r->problems, file, NULL, stderr);
        truth_list_free(list);
    }
    free(text);
    free(r);
    return good;
}

void truth_list_free(struct truth_list *list)
{
    free(list->row);
    tree_free(&list->tree);
    *list = (struct truth_list){.rows = 0};
}
