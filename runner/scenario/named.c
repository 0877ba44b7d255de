/* named.c - weights, poles and gains by the names of states and actuators.
 *
 * A mapping of names becomes the list that it stands for before anything is read, so that there is
 * one form of it; what is not named has its default. Poles stay as they are given: of a robot whose
 * contacts hold some states there is none.
 */
#include "reader.h"
#include "tree_nodes.h"

#include "runner/base/words.h"

#include <string.h>

/* ---- names ----------------------------------------------------------------------------------- */

const char *scenario_state_name(const stance_scene *scene, int i, char name[SCENARIO_NAME])
{
    const int p = scene->postures;
    snprintf(name, SCENARIO_NAME, "%s%s", i < p ? "" : "v",
             scene->coordinate[scene->posture[i % p]].name);
    return name;
}

/* Which state or actuator is called so; -1: none. */
typedef int place_of(const stance_scene *scene, const char *name);

static int state_of(const stance_scene *scene, const char *name)
{
    char own[SCENARIO_NAME];
    for (int i = 0; i < 2 * scene->postures; i++)
        if (strcmp(scenario_state_name(scene, i, own), name) == 0)
            return i;
    return -1;
}

static int actuator_of(const stance_scene *scene, const char *name)
{
    for (int i = 0; i < scene->actuators; i++)
        if (strcmp(scene->actuator_name[i], name) == 0)
            return i;
    return -1;
}

/* ---- mappings -------------------------------------------------------------------------------- */

/* What a list is made of: of so many places, of which those that are not named are `other`. */
struct form {
    place_of *place;
    size_t count;
    const char *other;
};

static struct tree_node *new_list(struct reader *r, const struct form *form, struct mark mark)
{
    struct tree_node *const list = tree_new(&r->tree, TREE_LIST, mark);
    for (size_t i = 0; list && i < form->count; i++) {
        struct tree_node *const item = tree_new(&r->tree, TREE_SCALAR, mark);
        if (!item || !tree_append(&r->tree, list, NULL, item))
            return NULL;
        item->text = form->other;
    }
    return list;
}

/* The mapping at *node, if it is one, as a list. `path`: of its keys in the schema. */
static bool make_list(struct reader *r, struct tree_node **node, const struct form *form,
                      const char *path)
{
    const struct tree_node *const map = *node;
    if (map->kind != TREE_MAP)
        return true;
    struct tree_node *const list = new_list(r, form, map->mark);
    if (!list)
        return problem_no_memory(&r->problems);
    reader_check_keys(r, map, path, path);
    for (size_t i = 0; i < map->count; i++) {
        const int place = form->place(r->s->scene, map->key[i].name);
        if (place >= 0)
            list->item[place] = map->item[i];
    }
    *node = list;
    return true;
}

static bool make_gains(struct reader *r, struct tree_node **gains)
{
    const stance_scene *const scene = r->s->scene;
    const struct form rows = {actuator_of, (size_t)scene->actuators, NULL},
                      row = {state_of, 2 * (size_t)scene->postures, "0"};
    if (!make_list(r, gains, &rows, "controller.gains"))
        return false;
    const struct tree_node *const list = *gains;
    for (size_t i = 0; list->kind == TREE_LIST && i < list->count; i++) {
        char path[96];
        snprintf(path, sizeof path, "controller.gains.%s",
                 i < rows.count ? scene->actuator_name[i] : "");
        if (!list->item[i]->text && list->item[i]->kind == TREE_SCALAR)
            list->item[i] = new_list(r, &row, list->mark); /* that is not named */
        if (!list->item[i])
            return problem_no_memory(&r->problems);
        if (i < rows.count && !make_list(r, &list->item[i], &row, path))
            return false;
    }
    return true;
}

/* Names beside `states` and `torques`: they stand for a list of states. */
static bool make_weights(struct reader *r, struct tree_node *weights)
{
    const stance_scene *const scene = r->s->scene;
    const struct form states = {state_of, 2 * (size_t)scene->postures, "1"},
                      torques = {actuator_of, (size_t)scene->actuators, "1"};
    struct tree_node *list = NULL;
    size_t kept = 0, index;
    for (size_t i = 0; i < weights->count; i++) {
        const struct tree_key key = weights->key[i];
        struct tree_node *const item = weights->item[i];
        const int place = strcmp(key.name, "states") == 0 || strcmp(key.name, "torques") == 0
                              ? -1
                              : state_of(scene, key.name);
        if (place < 0) {
            weights->key[kept] = key;
            weights->item[kept++] = item;
            continue;
        }
        list = list ? list : new_list(r, &states, key.mark);
        if (!list)
            return problem_no_memory(&r->problems);
        list->item[place] = item;
    }
    weights->count = kept;
    const struct tree_key key = {"states", list ? list->mark : weights->mark};
    if (list && tree_place(weights, key.name, &index))
        return problem_add(&r->problems, list->mark,
                           "controller.weights: weights of states stand in a list and by name; "
                           "give one of them");
    if (list && !tree_append(&r->tree, weights, &key, list))
        return problem_no_memory(&r->problems);
    struct tree_node **const given = tree_place(weights, "torques", &index),
                             **const all = tree_place(weights, "states", &index);
    return (!given || make_list(r, given, &torques, "controller.weights.torques")) &&
           (!all || make_list(r, all, &states, "controller.weights"));
}

static bool make_lists(struct reader *r)
{
    size_t index;
    struct tree_node *const controller = tree_find(r->tree.root, "controller");
    struct tree_node *const weights = controller ? tree_find(controller, "weights") : NULL;
    struct tree_node **const gains = controller ? tree_place(controller, "gains", &index) : NULL;
    return !r->s->scene || ((!weights || weights->kind != TREE_MAP || make_weights(r, weights)) &&
                            (!gains || make_gains(r, gains)));
}

/* ---- --set ----------------------------------------------------------------------------------- */

bool named_waits(const char *set)
{
    static const char *const of[] = {"controller.poles", "controller.gains", "controller.weights"};
    for (size_t i = 0; i < sizeof of / sizeof of[0]; i++) {
        const size_t length = strlen(of[i]);
        if (strncmp(set, of[i], length) == 0 && strchr(".[", set[length]) && set[length])
            return true;
    }
    return false;
}

/* Moves past the next name of a path, which goes to `name`; false: there is none. */
static bool next_name(const char **at, char name[TREE_MAX_NAME])
{
    size_t index;
    return **at == '.' && tree_path_step(at, false, name, &index) && name[0];
}

/* Where `count` items of `text` stand in the place of a list that is not given. */
static void put_list(struct reader *r, const char *path, size_t count, const char *text, int set)
{
    char value[1024];
    size_t used = (size_t)snprintf(value, sizeof value, "%s=[", path);
    for (size_t i = 0; i < count && used < sizeof value; i++)
        used += (size_t)snprintf(value + used, sizeof value - used, "%s%s", i ? ", " : "", text);
    if (used + 1 < sizeof value) {
        memcpy(value + used, "]", 2);
        tree_set(&r->tree, value, set, &r->problems);
    }
}

/* The path of a --set with indices in the place of names, of lists that are there then. What it is
 * no name of stays, and is refused where it is read. */
static void put_indices(struct reader *r, const char *given, int set, char *out, size_t size)
{
    const stance_scene *const scene = r->s->scene;
    const struct tree_node *const controller = tree_find(r->tree.root, "controller"),
                                  *const weights =
                                      controller ? tree_find(controller, "weights") : NULL,
                                  *const poles = controller ? tree_find(controller, "poles") : NULL;
    const size_t states = 2 * (size_t)scene->postures, inputs = (size_t)scene->actuators;
    const char *at = given + strlen("controller.");
    const char kind = *at;
    char name[TREE_MAX_NAME], row[64] = "";
    at += strcspn(at, ".[");
    snprintf(out, size, "%s", given);
    if (!next_name(&at, name))
        return;
    int i = kind == 'g' ? actuator_of(scene, name) : state_of(scene, name);
    if (kind == 'p' && i >= 0 && poles && poles->kind == TREE_LIST && poles->count == states)
        snprintf(out, size, "controller.poles[%d]%s", i, at);
    if (kind == 'w') {
        const bool torque = strcmp(name, "torques") == 0;
        if (torque || strcmp(name, "states") == 0) {
            if (!next_name(&at, name))
                return;
            i = torque ? actuator_of(scene, name) : state_of(scene, name);
        }
        const char *const list = torque ? "torques" : "states";
        snprintf(row, sizeof row, "controller.weights.%s", list);
        if (i >= 0 && (!weights || !tree_find(weights, list)))
            put_list(r, row, torque ? inputs : states, "1", set);
        if (i >= 0)
            snprintf(out, size, "%s[%d]%s", row, i, at);
    }
    if (kind == 'g' && i >= 0) {
        const bool whole = !next_name(&at, name);
        const int j = whole ? 0 : state_of(scene, name);
        char zeros[3 * STANCE_MAX_POSTURE * 2 + 4];
        size_t used = 0;
        for (size_t k = 0; k < states; k++)
            used += (size_t)snprintf(zeros + used, sizeof zeros - used, "%s0", k ? "," : "[");
        snprintf(zeros + used, sizeof zeros - used, "]");
        if (!controller || !tree_find(controller, "gains"))
            put_list(r, "controller.gains", inputs, zeros, set);
        snprintf(name, sizeof name, "[%d]", j);
        if (j >= 0)
            snprintf(out, size, "controller.gains[%d]%s%s", i, whole ? "" : name, at);
    }
}

bool named_read(struct reader *r, const char *const *sets, size_t set_count)
{
    bool good = make_lists(r);
    for (size_t i = 0; i < set_count && good; i++) {
        char *const text =
            named_waits(sets[i]) ? tree_allocate(&r->tree, strlen(sets[i]) + 128) : NULL;
        if (!named_waits(sets[i]))
            continue;
        if (!text)
            return problem_no_memory(&r->problems);
        if (r->s->scene)
            put_indices(r, sets[i], (int)i + 1, text, strlen(sets[i]) + 128);
        tree_set(&r->tree, r->s->scene ? text : sets[i], (int)i + 1, &r->problems);
    }
    return good && make_lists(r);
}

/* ---- lists that do not fit ------------------------------------------------------------------- */

const char *scenario_idle(const stance_scene *scene, const stance_equilibrium *e, char *text,
                          size_t size)
{
    const char *idle[STANCE_MAX_POSTURE] = {NULL};
    size_t count = 0;
    char list[200];
    for (int i = 0; i < scene->postures; i++) {
        bool moves = false;
        for (int k = 0; k < e->freedoms; k++)
            moves = moves || e->freedom[k] == scene->posture[i];
        if (!moves)
            idle[count++] = scene->coordinate[scene->posture[i]].name;
    }
    word_list(list, sizeof list, idle, count);
    snprintf(text, size, "%s%s", count > 0 ? "; idle there, with their rates: " : "", list);
    return text;
}

/* Of the equilibrium that the design is made at; nothing where there is none. */
static void name_idle(const struct reader *r, char *text, size_t size)
{
    const struct scenario_values *const base = &r->s->base;
    const stance_scene *const scene = r->s->scene;
    const struct scenario_equilibrium *const at =
        base->design_point.given ? &base->design_point : &base->equilibrium;
    stance_equilibrium_choice choice = {.supports = scenario_supports(scene, base),
                                        .branch = at->branch};
    stance_equilibrium e;
    stance_message ignored;
    text[0] = '\0';
    memcpy(choice.posture, at->posture, sizeof choice.posture);
    if (at->given && scene->equilibrium(scene, base->robot, &choice, &e, &ignored) == STANCE_OK)
        scenario_idle(scene, &e, text, size);
}

void named_misfit(struct reader *r, const struct misfit *misfit)
{
    char name[SCENARIO_NAME], idle[260];
    const char *const path = misfit->path;
    name_idle(r, idle, sizeof idle);
    scenario_state_name(r->s->scene, 0, name);
    problem_add(&r->problems, misfit->node->mark,
                "%s: expected %zu %s, found %zu%s; by name: %s{%s: ..., v%s: ...}", path,
                misfit->items, misfit->what, misfit->node->count, idle,
                strncmp(path, "controller.weights", 18) == 0 ? "weights: " : "", name, name);
}
