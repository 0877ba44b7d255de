/* named.c - weights, poles and gains by the names of states and actuators.
 *
 * A mapping of names becomes the list that it stands for before anything is read, so that there is
 * one form of it; what is not named has its default. Poles stay as they are given: of a robot whose
 * contacts hold some states there is none.
 */
#include "reader.h"

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

static size_t places(const struct reader *r, place_of *place)
{
    return (size_t)(place == state_of ? 2 * r->s->scene->postures : r->s->scene->actuators);
}

/* A list of all places, which are `other` until they are named; NULL: mappings of nothing. */
static struct tree_node *new_list(struct reader *r, place_of *place, const char *other,
                                  struct mark mark)
{
    struct tree_node *const list = tree_new(&r->tree, TREE_LIST, mark);
    for (size_t i = 0; list && i < places(r, place); i++) {
        struct tree_node *const item = tree_new(&r->tree, other ? TREE_SCALAR : TREE_MAP, mark);
        if (!item || !tree_append(&r->tree, list, NULL, item))
            return NULL;
        item->text = other;
    }
    return list;
}

/* The mapping at *node, if it is one, as a list. `path`: of its keys in the schema. */
static bool make_list(struct reader *r, struct tree_node **node, place_of *place, const char *other,
                      const char *path)
{
    const struct tree_node *const map = *node;
    if (map->kind != TREE_MAP)
        return true;
    struct tree_node *const list = new_list(r, place, other, map->mark);
    if (!list)
        return problem_no_memory(&r->problems);
    reader_check_keys(r, map, path, path);
    for (size_t i = 0; i < map->count; i++) {
        const int at = place(r->s->scene, map->key[i].name);
        if (at >= 0)
            list->item[at] = map->item[i];
    }
    *node = list;
    return true;
}

static bool make_gains(struct reader *r, struct tree_node **gains)
{
    bool good = make_list(r, gains, actuator_of, NULL, "controller.gains");
    const struct tree_node *const list = *gains;
    for (size_t i = 0;
         good && list->kind == TREE_LIST && i < list->count && i < places(r, actuator_of); i++) {
        char path[96];
        snprintf(path, sizeof path, "controller.gains.%s", r->s->scene->actuator_name[i]);
        good = make_list(r, &list->item[i], state_of, "0", path);
    }
    return good;
}

/* Names beside `states` and `torques`: they stand for a list of states. */
static bool make_weights(struct reader *r, struct tree_node *weights)
{
    struct tree_node *list = NULL;
    size_t kept = 0, index;
    for (size_t i = 0; i < weights->count; i++) {
        const struct tree_key key = weights->key[i];
        struct tree_node *const item = weights->item[i];
        const bool own = strcmp(key.name, "states") == 0 || strcmp(key.name, "torques") == 0;
        const int place = own ? -1 : state_of(r->s->scene, key.name);
        if (place < 0) {
            weights->key[kept] = key;
            weights->item[kept++] = item;
            continue;
        }
        list = list ? list : new_list(r, state_of, "1", key.mark);
        if (!list)
            return problem_no_memory(&r->problems);
        list->item[place] = item;
    }
    weights->count = kept;
    if (list && tree_find(weights, "states"))
        return problem_add(&r->problems, list->mark,
                           "controller.weights: weights of states stand in a list and by name; "
                           "give one of them");
    if (list && !tree_append(&r->tree, weights, &(struct tree_key){"states", list->mark}, list))
        return problem_no_memory(&r->problems);
    struct tree_node **const torques = tree_place(weights, "torques", &index),
                             **const states = tree_place(weights, "states", &index);
    return (!torques || make_list(r, torques, actuator_of, "1", "controller.weights.torques")) &&
           (!states || make_list(r, states, state_of, "1", "controller.weights"));
}

static bool make_lists(struct reader *r)
{
    size_t index;
    struct tree_node *const controller = tree_find(r->tree.root, "controller");
    struct tree_node *const weights = tree_find(controller, "weights");
    struct tree_node **const gains = tree_place(controller, "gains", &index);
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

/* The path of a --set with indices in the place of names where a list is there; else mappings come
 * of them, that become lists. What it is no name of stays, and is refused where it is read. */
static void put_indices(const struct reader *r, const char *given, char *out, size_t size)
{
    const stance_scene *const scene = r->s->scene;
    const struct tree_node *node = tree_find(r->tree.root, "controller");
    const char *at = given + strlen("controller");
    char name[TREE_MAX_NAME], list[TREE_MAX_NAME] = "";
    size_t index;
    snprintf(out, size, "controller");
    while (*at && *at != '=' && tree_path_step(&at, false, name, &index)) {
        const bool named = name[0], states = strcmp(list, "weights") == 0 && named &&
                                             state_of(scene, name) >= 0 &&
                                             tree_find(node, "states");
        if (states)
            node = tree_find(node, "states");
        if (states)
            add_text(out, size, ".states");
        const bool items = node && node->kind == TREE_LIST,
                   inputs = strcmp(list, "gains") == 0 || strcmp(list, "torques") == 0;
        const int place =
            !named ? (int)index
            : !items || (strcmp(list, "poles") == 0 && node->count != places(r, state_of))
                ? -1
                : (inputs ? actuator_of : state_of)(scene, name);
        if (place >= 0) {
            add_text(out, size, "[%d]", place);
            node = items && (size_t)place < node->count ? node->item[place] : NULL;
            list[0] = '\0';
        } else {
            add_text(out, size, ".%s", name);
            node = tree_find(node, name);
            memcpy(list, name, sizeof list);
        }
    }
    add_text(out, size, "%s", at);
}

bool named_read(struct reader *r, const char *const *sets, size_t set_count)
{
    bool good = make_lists(r);
    for (size_t i = 0; i < set_count && good; i++) {
        const size_t size = strlen(sets[i]) + 128;
        char *const text = named_waits(sets[i]) ? tree_allocate(&r->tree, size) : NULL;
        if (!named_waits(sets[i]))
            continue;
        if (!text)
            return problem_no_memory(&r->problems);
        if (r->s->scene)
            put_indices(r, sets[i], text, size);
        tree_set(&r->tree, r->s->scene ? text : sets[i], (int)i + 1, &r->problems);
        good = make_lists(r); /* which the next one may change */
    }
    return good;
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
