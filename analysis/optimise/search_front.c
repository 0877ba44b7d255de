/* search_front.c - several searches: what differs in their scenarios. */
#include "search_study.h"

#include "runner/base/message.h"
#include "runner/base/words.h"
#include "runner/scenario/field.h"
#include "runner/scenario/tree.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- scenarios as lists of numbers and words ---------------------------------------------- */

static void add_leaves(json_t *leaves, const struct tree_node *node, const char *path)
{
    char below[96];
    if (node->kind == TREE_SCALAR) {
        json_object_set_new(leaves, path, json_string(node->text));
        return;
    }
    for (size_t i = 0; i < node->count; i++) {
        const int length = node->kind == TREE_LIST
                               ? snprintf(below, sizeof below, "%s[%zu]", path, i)
                               : snprintf(below, sizeof below, "%s%s%s", path, path[0] ? "." : "",
                                          node->key[i].name);
        if (length > 0 && (size_t)length < sizeof below)
            add_leaves(leaves, node->item[i], below);
    }
}

/* {path: text} of a scenario as it was read; empty of one that is none. NULL: no memory. */
static json_t *read_leaves(const char *text)
{
    const size_t length = strlen(text);
    struct tree tree = {0};
    struct problems *const problems = calloc(1, sizeof *problems);
    json_t *const leaves = problems ? json_object() : NULL;
    if (leaves && tree_check_text(text, length, problems) &&
        tree_parse(&tree, text, length, problems))
        add_leaves(leaves, tree.root, "");
    tree_free(&tree);
    free(problems);
    return leaves;
}

/* In one of the scenarios, a list of leaves; NULL: it is not given. */
static const char *text_at(const json_t *scenarios, size_t i, const char *path)
{
    return json_string_value(json_object_get(json_array_get(scenarios, i), path));
}

/* NAN: none. */
static double number_at(const json_t *scenarios, size_t i, const char *path)
{
    const char *const text = text_at(scenarios, i, path);
    double number;
    bool finite;
    return text && number_parse(text, &number, &finite) ? number : NAN;
}

/* ---- what differs ------------------------------------------------------------------------- */

/* Different numbers; 0: some scenario has none. */
static size_t values_of(const json_t *scenarios, const char *path)
{
    size_t values = 0;
    for (size_t i = 0; i < json_array_size(scenarios); i++) {
        const double number = number_at(scenarios, i, path);
        size_t same = 0;
        if (isnan(number))
            return 0;
        while (same < i && number_at(scenarios, same, path) != number)
            same++;
        values += same == i;
    }
    return values;
}

/* What a search may cost, and what only scatters. */
static bool is_effort(const char *path)
{
    static const char *const effort[] = {"seed",
                                         "optimise.candidates",
                                         "optimise.confirm",
                                         "optimise.grow",
                                         "optimise.restarts",
                                         "optimise.first_step",
                                         "sweep.sample.count"};
    bool is = false;
    for (size_t i = 0; i < sizeof effort / sizeof *effort; i++)
        is = is || strncmp(path, effort[i], strlen(effort[i])) == 0;
    return is;
}

/* The path, into against.name; false: there is none. */
static bool find_against(struct search_front *front, json_t *scenarios)
{
    size_t most = 1;
    const char *path;
    json_t *leaf;
    json_object_foreach(json_array_get(scenarios, 0), path, leaf)
    {
        const size_t values = is_effort(path) ? 0 : values_of(scenarios, path);
        if (values > most) {
            most = values;
            snprintf(front->against.name, sizeof front->against.name, "%s", path);
        }
    }
    return most > 1;
}

/* Paths in the order in which the scenarios have them. */
static void find_also(struct search_front *front, json_t *scenarios)
{
    json_t *const all = json_object();
    const char *path;
    json_t *leaf;
    for (size_t i = 0; i < front->count; i++)
        json_object_update_missing(all, json_array_get(scenarios, i));
    json_object_foreach(all, path, leaf)
    {
        bool differs = false;
        for (size_t i = 0; i < front->count; i++) {
            const char *const text = text_at(scenarios, i, path);
            differs = differs || !text || strcmp(text, json_string_value(leaf)) != 0;
        }
        if (differs && strcmp(path, "title") != 0 && strcmp(path, front->against.name) != 0 &&
            strlen(front->also) + 100 < sizeof front->also)
            words_add(front->also, sizeof front->also, "%s%s", front->also[0] ? ", " : "", path);
    }
    json_decref(all);
    results_clean(front->also);
}

static bool compare_scenarios(struct search_front *front, stance_message *message)
{
    json_t *const scenarios = json_array();
    bool good = true;
    for (size_t i = 0; good && i < front->count; i++)
        good = json_array_append_new(scenarios, read_leaves(front->study[i].f.scenario)) == 0 ||
               no_memory(message);
    good = good &&
           (find_against(front, scenarios) ||
            complain(message,
                     "%.70s, %.70s%s: no number of their scenarios differs, but "
                     "for seed and effort",
                     front->study[0].file, front->study[1].file, front->count > 2 ? " ..." : ""));
    for (size_t i = 0; good && i < front->count; i++)
        front->at[i] = number_at(scenarios, i, front->against.name);
    if (good)
        find_also(front, scenarios);
    json_decref(scenarios);
    return good;
}

/* ---- opening ------------------------------------------------------------------------------ */

/* Rising, in the order in which they were given where they are the same. */
static void sort(struct search_front *front)
{
    for (size_t i = 1; i < front->count; i++) {
        for (size_t j = i; j > 0 && front->at[j - 1] > front->at[j]; j--) {
            const double at = front->at[j];
            const struct search_study study = front->study[j];
            front->at[j] = front->at[j - 1];
            front->study[j] = front->study[j - 1];
            front->at[j - 1] = at;
            front->study[j - 1] = study;
        }
    }
}

bool search_front_open(struct search_front *front, const char *const *file, size_t count,
                       stance_message *message)
{
    *front = (struct search_front){.study = calloc(count, sizeof *front->study),
                                   .at = calloc(count, sizeof *front->at)};
    bool good = (front->study && front->at) || no_memory(message);
    while (good && front->count < count) {
        struct search_study *const study = &front->study[front->count];
        good = search_study_open(study, file[front->count], message);
        front->count += good;
        front->glued = front->glued || (good && study->glued);
        if (good && !study->done)
            good = complain(message, "%.150s: not finished: stance optimise --resume goes on",
                            study->file);
    }
    if (!good || !compare_scenarios(front, message)) {
        search_front_close(front);
        return false;
    }
    sort(front);
    front->against.count = count;
    front->against.value = front->at;
    search_describe(&front->study[0], &front->against);
    results_clean(front->against.name);
    return true;
}

void search_front_close(struct search_front *front)
{
    for (size_t i = 0; i < front->count; i++)
        search_study_close(&front->study[i]);
    free(front->study);
    free(front->at);
    *front = (struct search_front){0};
}
