/* description.c - the numbers of a mechanism that is being read.
 *
 * Those become robot[] that are given, also by `like`, in the controller's model, or by an axis.
 * The others keep their defaults, and are not there for those who compile the structure.
 */
#include "description.h"

#include <math.h>
#include <stdarg.h>
#include <string.h>

const char *description_path(char path[DESCRIPTION_PATH], enum part part, const struct entry *entry,
                             const char *key)
{
    snprintf(path, DESCRIPTION_PATH, "%s.%s.%.64s%s%.64s", part_kinds[part].in,
             part_kinds[part].key, entry->key->name, key[0] ? "." : "", key);
    return path;
}

void description_report(struct description *d, enum part part, const struct entry *entry,
                        const char *key, const char *format, ...)
{
    const struct tree_node *const node = tree_find(entry->map, key);
    char path[DESCRIPTION_PATH], text[PROBLEM_TEXT];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    problem_record(&d->r->problems, node ? node->mark : entry->key->mark, "%s%s",
                   description_path(path, part, entry, key), text);
}

/* ---- numbers --------------------------------------------------------------------------------- */

static double *places(stance_mechanism *m)
{
    return (double *)(void *)&m->value;
}

/* Why a key that there is may not stand in part i. */
static const char *misplaced(const struct description *d, const struct part_key *key, int i)
{
    static const char *const joint[] = {
        [STANCE_FREE] = "a free root has no joint",
        [STANCE_HINGE] = "a hinge has no axis",
        [STANCE_SLIDE] = "what slides has no such number",
        [STANCE_FIXED] = "what is fixed has no joint",
    };
    switch (key->part) {
    case PART_BODY:
        return joint[d->m->body[i].joint];
    case PART_POINT:
        return "a push has force, from and to, a stroke impulse and from";
    case PART_PLATE:
        return key->grounds == 1 << STANCE_ROUGH
                   ? "only rough ground has one: see kind"
                   : "one plate has none, stairs and rough ground have: see kind";
    default:
        return key->of_point ? "a sole, or a capsule, has from and to"
                             : "a contact has at, or from and to: not both";
    }
}

static bool read_key(struct description *d, const struct part_key *key, int i,
                     const struct entry *entry)
{
    const struct tree_node *const node = tree_find(entry->map, key->field.path);
    const int count = part_numbers(key), place = part_place(d->m, key, i);
    struct problems *const problems = &d->r->problems;
    struct scenario_field row = key->field;
    char path[DESCRIPTION_PATH], name[DESCRIPTION_PATH + 8];
    description_path(path, key->part, entry, row.path);
    snprintf(row.unit, sizeof row.unit, "%s", part_unit(d->m, key, i));
    if (place < 0)
        return problem_add(problems, node->mark, "%s: %s", path, misplaced(d, key, i));
    double *const value = &places(d->m)[place];
    d->given[place] = true;
    if (key->part == PART_POINT && d->m->point[i].swings && !tree_find(entry->map, "to"))
        d->m->value.point[i].to = INFINITY;
    if (count == 1)
        return field_number(problems, &row, path, node, value);
    bool good = field_items(problems, path, node, 2, "numbers");
    for (int k = 0; k < 2 && node->kind == TREE_LIST && node->count == 2; k++) {
        snprintf(name, sizeof name, "%s[%d]", path, k);
        d->given[place + k] = true;
        good = field_number(problems, &row, name, node->item[k], &value[k]) && good;
    }
    if (isinf(value[0])) /* no lower stop */
        value[0] = -INFINITY;
    return good;
}

/* What body i has from the one that it is like: `at` only from one that hangs from another, too. */
static void copy_numbers(struct description *d, int i, int from)
{
    for (size_t k = 0; k < part_key_count && part_keys[k].part == PART_BODY; k++) {
        const struct part_key *const key = &part_keys[k];
        const int to_place = part_place(d->m, key, i), place = part_place(d->m, key, from);
        const bool at = key->field.offset == offsetof(stance_body_numbers, at);
        if (to_place < 0 || place < 0 ||
            (at && (d->m->body[from].parent < 0) != (d->m->body[i].parent < 0)))
            continue;
        for (int n = 0; n < part_numbers(key); n++) {
            places(d->m)[to_place + n] = places(d->m)[place + n];
            d->given[to_place + n] = d->given[place + n];
        }
    }
}

static bool read_numbers(struct description *d, enum part part, int i)
{
    struct entry *const entry = &d->entry[part][part == PART_BODY ? d->back[i] : i];
    bool good = true;
    if (entry->read)
        return true;
    entry->read = true;
    if (entry->like >= 0) {
        good = read_numbers(d, PART_BODY, d->place[entry->like]);
        copy_numbers(d, i, d->place[entry->like]);
    }
    for (size_t k = 0; k < part_key_count; k++)
        if (part_keys[k].part == part && part_numbers(&part_keys[k]) > 0 &&
            tree_find(entry->map, part_keys[k].field.path))
            good = read_key(d, &part_keys[k], i, entry) && good;
    return good;
}

/* ---- which of them are robot[] --------------------------------------------------------------- */

/* Whether a node is a path, or a list in which it stands. */
static bool names_path(const struct tree_node *node, const char *path)
{
    if (!node || node->kind == TREE_SCALAR)
        return node && strcmp(node->text, path) == 0;
    bool found = false;
    for (size_t i = 0; node->kind == TREE_LIST && i < node->count && i < SCENARIO_MAX_PATHS; i++)
        found = found || (node->item[i]->kind == TREE_SCALAR && names_path(node->item[i], path));
    return found;
}

/* Whether the sweep varies the number at a path below robot, ground or the model. */
static bool is_varied(const struct description *d, const char *of, const char *path)
{
    const struct tree_node *const sweep = tree_find(d->r->tree.root, "sweep"),
                                  *const lists[] = {tree_find(sweep, "grid"),
                                                    tree_find(tree_find(sweep, "sample"), "vary")};
    char whole[DESCRIPTION_PATH + 24];
    bool found = false;
    snprintf(whole, sizeof whole, "%s.%s", of, path);
    for (size_t k = 0; k < sizeof lists / sizeof lists[0]; k++) {
        const struct tree_node *const list = lists[k];
        for (size_t i = 0;
             list && list->kind == TREE_LIST && i < list->count && i < SCENARIO_MAX_AXES; i++)
            found = found || names_path(tree_find(list->item[i], "path"), whole) ||
                    names_path(tree_find(list->item[i], "paths"), whole);
    }
    return found;
}

static void choose_key(struct description *d, const struct part_key *key, int i)
{
    stance_mechanism *const m = d->m;
    const int count = part_numbers(key), place = part_place(m, key, i);
    const char *const name = part_name(m, key->part, i);
    bool wanted = place >= 0 && d->given[place], varies[2] = {false};
    if (place < 0)
        return;
    for (int n = 0; n < count; n++) {
        char path[DESCRIPTION_PATH], item[8] = "";
        if (count == 2)
            snprintf(item, sizeof item, "[%d]", n);
        snprintf(path, sizeof path, "%s.%s.%s%s", part_kinds[key->part].key, name, key->field.path,
                 item);
        varies[n] = is_varied(d, part_kinds[key->part].in, path);
        wanted = wanted || varies[n] || is_varied(d, "controller.model", path);
    }
    const struct tree_node *const model =
        tree_find(tree_find(d->r->tree.root, "controller"), "model");
    wanted = wanted || tree_find(tree_find(tree_find(model, part_kinds[key->part].key), name),
                                 key->field.path);
    for (int n = 0; wanted && n < count; n++) {
        if (m->numbers < STANCE_ROBOT_FALL_HEIGHT) {
            m->number[m->numbers] = place + n;
            m->varies[m->numbers] = varies[n];
        }
        m->numbers++;
    }
}

/* Whether a number of part i is one of robot[]. */
static bool is_number(const stance_mechanism *m, enum part part, const char *name, int i)
{
    return part_robot(m, part_place(m, part_key(part, name), i)) >= 0;
}

/* What counts only where it is given, or varied. */
static void note_given(stance_mechanism *m)
{
    for (int b = 0; b < m->bodies; b++)
        m->body[b].bounded |= is_number(m, PART_BODY, "turn", b);
    for (int e = 0; e < m->elements; e++)
        m->element[e].rough |= is_number(m, PART_CONTACT, "friction_factor", e);
    for (int p = 0; p < m->points; p++)
        m->point[p].falls |= is_number(m, PART_POINT, "lowest", p);
    for (int i = 0; i < m->plates; i++) {
        m->plate[i].by_footfall = is_number(m, PART_PLATE, "footfall", i);
        m->plate[i].rough = is_number(m, PART_PLATE, "friction_factor", i);
    }
}

bool description_numbers(struct description *d)
{
    bool good = true;
    for (int part = 0; part < PARTS; part++)
        for (int i = 0; i < part_count(d->m, (enum part)part); i++)
            good = read_numbers(d, (enum part)part, i) && good;
    for (int part = 0; part < PARTS; part++)
        for (int i = 0; i < part_count(d->m, (enum part)part); i++)
            for (size_t k = 0; k < part_key_count; k++)
                if (part_keys[k].part == (enum part)part)
                    choose_key(d, &part_keys[k], i);
    note_given(d->m);
    return (d->m->numbers <= STANCE_ROBOT_FALL_HEIGHT ||
            problem_add(&d->r->problems, description_mark(d),
                        "robot: %d numbers are given; at most %d", d->m->numbers,
                        STANCE_ROBOT_FALL_HEIGHT)) &&
           good;
}
