/* mechanism.c - the tree of a mechanism as data: names, how bodies hang together, numbers.
 *
 * Which numbers become robot[]: those that are given, also by `like`, in the controller's model, or
 * by an axis. The others keep their defaults, and are not there for those who compile the
 * structure.
 */
#include "mechanism.h"
#include "description.h"

#include "runner/base/words.h"

#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

/* ---- names ----------------------------------------------------------------------------------- */

static bool listed(const char *const *words, const char *word)
{
    while (*words && strcasecmp(*words, word) != 0)
        words++;
    return *words != NULL;
}

/* Why a text is no name; NULL: it is one. */
static const char *name_fault(enum part part, const char *name)
{
    static const char *const truths[] = {"on", "off",  "yes",   "no",   "y",
                                         "n",  "true", "false", "null", NULL};
    static const char *const coordinates[] = {"x", "z", "vx", "vz", NULL};
    static const char *const keys[] = {"scale", "branch", NULL};
    bool word = isalpha((unsigned char)name[0]) != 0;
    for (const char *s = name; *s; s++)
        word = word && (isalnum((unsigned char)*s) || *s == '_');
    if (!word)
        return "a name is a letter, then letters, digits or _";
    if (strlen(name) >= STANCE_NAME)
        return "a name has at most 63 letters";
    if (listed(truths, name))
        return "some readers of YAML take it for true, false or nothing";
    if (part < PART_ACTUATOR && listed(coordinates, name))
        return "a coordinate of a free root, or its rate, is called so";
    if (part == PART_BODY && listed(keys, name))
        return "a key of initial.offset or initial.equilibrium is called so";
    return NULL;
}

/* Another part of this name, or the body whose rate it is; actuators have names of their own, and
 * plates. */
static const struct entry *namesake(const struct description *d, enum part part, int i)
{
    const char *const name = d->entry[part][i].key->name;
    for (int p = 0; p <= (int)part && part < PART_ACTUATOR; p++)
        for (int k = 0; k < d->count[p] && !(p == (int)part && k >= i); k++)
            if (strcmp(d->entry[p][k].key->name, name) == 0)
                return &d->entry[p][k];
    for (int k = 0; part == PART_BODY && name[0] == 'v' && k < d->count[part]; k++)
        if (strcmp(d->entry[part][k].key->name, name + 1) == 0)
            return &d->entry[part][k];
    return NULL;
}

static bool check_name(struct description *d, enum part part, int i)
{
    const struct entry *const entry = &d->entry[part][i];
    const struct tree_key *const key = entry->key;
    const char *const fault = name_fault(part, key->name);
    const struct entry *const other = fault ? NULL : namesake(d, part, i);
    char word[SHOWN_SIZE];
    if (fault)
        return problem_add(&d->r->problems, key->mark, "%s.%s: '%s' is no name: %s",
                           part_kinds[part].in, part_kinds[part].key, shown(word, key->name),
                           fault);
    if (other && other->key->mark.line == 0)
        return description_refuse(d, part, entry, "",
                                  ": a part of the scene is called so: choose another name");
    return !other ||
           description_refuse(
               d, part, entry, "", ": %s in line %d is called so, too: choose another name",
               strcmp(other->key->name, key->name) != 0 ? "the rate of the body" : "the part",
               other->key->mark.line);
}

/* The keys of a mapping, which are those of the table. */
static bool check_keys(struct description *d, const struct tree_node *map, const char *name,
                       const char *const *known, size_t count)
{
    bool good = true;
    for (size_t i = 0; i < map->count; i++)
        if (word_place(map->key[i].name, known, count) == count)
            good = field_unknown(&d->r->problems, name, "key", map->key[i].name, map->key[i].mark,
                                 known, count);
    return good;
}

static bool check_part(struct description *d, enum part part, const struct entry *entry)
{
    char path[DESCRIPTION_PATH];
    const char *known[24];
    size_t count = 0;
    description_path(path, part, entry, "");
    if (entry->map->kind != TREE_MAP)
        return field_mismatch(&d->r->problems, path, "a mapping", entry->map);
    for (size_t k = 0; k < part_key_count; k++)
        if (part_keys[k].part == part)
            known[count++] = part_keys[k].field.path;
    return check_keys(d, entry->map, path, known, count);
}

static bool read_names(struct description *d, enum part part)
{
    const struct part_kind *const kind = &part_kinds[part];
    const struct tree_node *const in = tree_find(d->r->tree.root, kind->in);
    const struct tree_node *const map = tree_find(in, kind->key);
    char path[DESCRIPTION_PATH];
    snprintf(path, sizeof path, "%s.%s", kind->in, kind->key);
    if (!map)
        return part != PART_BODY ||
               problem_add(&d->r->problems, in->mark,
                           "robot.bodies is missing: a mechanism is made of them");
    if (map->kind != TREE_MAP)
        return field_mismatch(&d->r->problems, path, "a mapping of names, without dashes", map);
    if (map->count == 0 && part == PART_BODY)
        return problem_add(&d->r->problems, map->mark, "%s: there is no body", path);
    if (map->count > (size_t)kind->most)
        return problem_add(&d->r->problems, map->mark, "%s: %zu of them; at most %d", path,
                           map->count, kind->most);
    bool good = true;
    d->count[part] = (int)map->count;
    for (size_t i = 0; i < map->count; i++) {
        d->entry[part][i] = (struct entry){
            .key = &map->key[i], .map = map->item[i], .parent = -1, .like = -1, .body = -1};
        good = check_part(d, part, &d->entry[part][i]) && good;
        if (part == PART_BODY)
            d->body_name[i] = map->key[i].name;
    }
    for (int i = 0; i < d->count[part]; i++)
        good = check_name(d, part, i) && good;
    return good;
}

/* ---- how they hang together ------------------------------------------------------------------ */

/* The place in the file of the body that a key names: `body` must name one. False: a problem. */
static bool read_body(struct description *d, enum part part, const struct entry *entry,
                      const char *key, int *body)
{
    const struct tree_node *const node = tree_find(entry->map, key);
    char path[DESCRIPTION_PATH];
    description_path(path, part, entry, key);
    const size_t count = (size_t)d->count[PART_BODY];
    *body = -1;
    if (!node)
        return strcmp(key, "body") != 0 ||
               description_refuse(d, part, entry, key, " is missing: the body that it %s",
                                  part == PART_ACTUATOR ? "drives" : "belongs to");
    if (node->kind != TREE_SCALAR)
        return field_mismatch(&d->r->problems, path, "the name of a body", node);
    const size_t place = word_place(node->text, d->body_name, count);
    *body = place < count ? (int)place : -1;
    return place < count || field_unknown(&d->r->problems, path, "body", node->text, node->mark,
                                          d->body_name, count);
}

/* The word of a key of a part, if it is given, by its place. False: a problem. */
static bool read_word(struct description *d, enum part part, const struct entry *entry,
                      const char *key, int *word)
{
    const struct tree_node *const node = tree_find(entry->map, key);
    char path[DESCRIPTION_PATH];
    return !node || field_word(&d->r->problems, &part_key(part, key)->field,
                               description_path(path, part, entry, key), node, word);
}

static bool read_joint(struct description *d, struct entry *entry)
{
    const struct scenario_field *const row = &part_keys[0].field;
    const bool root = !tree_find(entry->map, "parent");
    char list[80];
    int word = 0;
    if (!tree_find(entry->map, "joint"))
        return description_refuse(d, PART_BODY, entry, "joint", " is missing (%s)",
                                  word_list(list, sizeof list, row->words, row->word_count));
    if (!read_word(d, PART_BODY, entry, "joint", &word))
        return false;
    entry->joint = (stance_joint)word;
    if (entry->joint == STANCE_FIXED && root)
        return description_refuse(d, PART_BODY, entry, "joint",
                                  ": a root is free, or a hinge, or slides");
    return entry->joint != STANCE_FREE || root ||
           description_refuse(d, PART_BODY, entry, "joint",
                              ": only the root is free; what has a parent is a hinge, slides, or "
                              "is fixed");
}

/* What a body is like must not be like it in turn. */
static bool check_like(struct description *d, int b)
{
    const struct entry *const entries = d->entry[PART_BODY];
    int other = entries[b].like;
    for (int steps = 0; other >= 0 && other != b && steps < d->count[PART_BODY]; steps++)
        other = entries[other].like;
    return other != b ||
           description_refuse(d, PART_BODY, &entries[b], "like", ": it would be like itself");
}

static bool read_links(struct description *d)
{
    bool good = true;
    for (int b = 0; b < d->count[PART_BODY]; b++) {
        struct entry *const entry = &d->entry[PART_BODY][b];
        good = read_joint(d, entry) && good;
        good = read_body(d, PART_BODY, entry, "parent", &entry->parent) && good;
        good = read_body(d, PART_BODY, entry, "like", &entry->like) && good;
    }
    for (int b = 0; good && b < d->count[PART_BODY]; b++)
        good = check_like(d, b);
    for (enum part part = PART_CONTACT; part < ROBOT_PARTS; part++)
        for (int i = 0; i < d->count[part]; i++) {
            struct entry *const entry = &d->entry[part][i];
            good = read_body(d, part, entry, "body", &entry->body) && good;
        }
    return good;
}

/* Those that are `left`, -1 in place[], or roots: "trunk, thigh1". */
static const char *name_some(const struct description *d, bool left, char *text, size_t size)
{
    const char *words[STANCE_MAX_BODIES];
    size_t count = 0;
    for (int b = 0; b < d->count[PART_BODY]; b++)
        if (left ? d->place[b] < 0 : d->entry[PART_BODY][b].parent < 0)
            words[count++] = d->body_name[b];
    return word_list(text, size, words, count);
}

/* Places for the bodies, parents first, else in the file's order. */
static bool sort_bodies(struct description *d)
{
    const int n = d->count[PART_BODY];
    int roots = 0, placed = 0, last = 0;
    char text[600];
    for (int b = 0; b < n; b++) {
        d->place[b] = -1;
        if (d->entry[PART_BODY][b].parent < 0) {
            roots++;
            last = b;
        }
    }
    if (roots > 1)
        return problem_add(&d->r->problems, d->entry[PART_BODY][last].key->mark,
                           "robot.bodies: %d bodies hang from nothing (%s): give all but one a "
                           "parent",
                           roots, name_some(d, false, text, sizeof text));
    for (int b = 0; b < n; b++) {
        const int parent = d->entry[PART_BODY][b].parent;
        if (d->place[b] < 0 && (parent < 0 || d->place[parent] >= 0)) {
            d->back[placed] = b;
            d->place[b] = placed++;
            b = -1; /* again from the first */
        }
    }
    for (int b = 0; b < n; b++)
        if (d->place[b] < 0)
            return problem_add(&d->r->problems, d->entry[PART_BODY][b].key->mark,
                               "robot.bodies: %s hang%s and not from a root: a tree has no loops",
                               name_some(d, true, text, sizeof text),
                               n - placed == 1 ? "s from itself" : " from each other");
    return true;
}

static void fill_point(struct description *d, int i)
{
    const struct entry *const entry = &d->entry[PART_POINT][i];
    part_put(d->m, PART_POINT, i, entry->key->name, d->place[entry->body]);
    d->m->point[i].swings |= tree_find(entry->map, "frequency") != NULL;
    if (tree_find(entry->map, "impulse") || tree_find(entry->map, "force"))
        d->m->point[i].pushed = tree_find(entry->map, "impulse") ? STANCE_IMPULSE : STANCE_FORCE;
}

static void fill_plates(struct description *d)
{
    d->m->plates = d->count[PART_PLATE];
    for (int i = 0; i < d->m->plates; i++) {
        part_put(d->m, PART_PLATE, i, d->entry[PART_PLATE][i].key->name, -1);
        d->m->plate[i].kind = d->entry[PART_PLATE][i].ground;
    }
}

/* Names and links, with bodies in their places. */
static void fill_structure(struct description *d)
{
    stance_mechanism *const m = d->m;
    m->bodies = d->count[PART_BODY];
    m->elements = d->count[PART_CONTACT];
    m->points = d->count[PART_POINT];
    m->actuators = d->count[PART_ACTUATOR];
    for (int b = 0; b < m->bodies; b++) {
        const struct entry *const entry = &d->entry[PART_BODY][d->back[b]];
        part_put(m, PART_BODY, b, entry->key->name,
                 entry->parent < 0 ? -1 : d->place[entry->parent]);
        m->body[b].joint = entry->joint;
        const struct tree_node *const own = tree_find(entry->map, "coordinate");
        if (own && own->kind == TREE_SCALAR)
            snprintf(m->body[b].coordinate, STANCE_NAME, "%s", own->text);
    }
    for (int i = 0; i < m->elements; i++) {
        const struct entry *const entry = &d->entry[PART_CONTACT][i];
        part_put(m, PART_CONTACT, i, entry->key->name, d->place[entry->body]);
        m->element[i].sole = tree_find(entry->map, "from") || tree_find(entry->map, "to");
    }
    for (int i = 0; i < m->points; i++)
        fill_point(d, i);
    fill_plates(d);
    for (int i = 0; i < m->actuators; i++)
        part_put(m, PART_ACTUATOR, i, d->entry[PART_ACTUATOR][i].key->name,
                 d->place[d->entry[PART_ACTUATOR][i].body]);
}

/* Does a body move along the root's rail alone? */
static bool on_rail(const stance_mechanism *m, int b)
{
    while (m->body[b].joint == STANCE_FIXED)
        b = m->body[b].parent;
    return b == 0 && m->body[b].joint == STANCE_SLIDE;
}

static bool check_joints(struct description *d)
{
    int moving = 0;
    for (int b = 0; b < d->m->bodies; b++)
        moving += d->m->body[b].joint != STANCE_FIXED && !(b == 0 && on_rail(d->m, b));
    return moving <= STANCE_MAX_ANGLES ||
           problem_add(&d->r->problems,
                       tree_find(tree_find(d->r->tree.root, "robot"), "bodies")->mark,
                       "robot.bodies: %d of them turn or slide against their parents; at most %d",
                       moving, STANCE_MAX_ANGLES);
}

/* A contact needs a body that can leave the ground, and a point or two ends. */
static bool check_contact(struct description *d, int i)
{
    const struct entry *const entry = &d->entry[PART_CONTACT][i];
    const int b = d->m->element[i].body;
    const bool at = tree_find(entry->map, "at"), from = tree_find(entry->map, "from"),
               to = tree_find(entry->map, "to");
    bool good = !on_rail(d->m, b) ||
                description_refuse(d, PART_CONTACT, entry, "body", ": %s cannot move off its rail",
                                   d->m->body[b].name);
    if (!at && from != to)
        good = description_refuse(d, PART_CONTACT, entry, from ? "to" : "from",
                                  " is missing: a sole has two ends");
    else if (!at && !from)
        good = description_refuse(d, PART_CONTACT, entry, "at",
                                  " is missing (from and to make it a sole)");
    return good;
}

static bool check_actuator(struct description *d, int i)
{
    const struct entry *const entry = &d->entry[PART_ACTUATOR][i];
    const int b = d->m->actuator[i].body;
    const stance_joint joint = d->m->body[b].joint;
    if (joint == STANCE_FREE || joint == STANCE_FIXED)
        return description_refuse(d, PART_ACTUATOR, entry, "body",
                                  ": %s has no joint to drive: it is %s", d->m->body[b].name,
                                  joint == STANCE_FREE ? "free" : "fixed");
    for (int k = 0; k < i; k++)
        if (d->m->actuator[k].body == b)
            return description_refuse(d, PART_ACTUATOR, entry, "body",
                                      ": %s drives this joint already", d->m->actuator[k].name);
    return true;
}

/* A push ends, unless it swings. */
static bool check_push(struct description *d, int i)
{
    const struct entry *const entry = &d->entry[PART_POINT][i];
    return d->m->point[i].pushed != STANCE_FORCE || d->m->point[i].swings ||
           tree_find(entry->map, "to") ||
           description_refuse(d, PART_POINT, entry, "to", " is missing: when the push ends");
}

/* A coordinate's own name is a name, and no other's, nor that of another's rate. */
static bool check_coordinate(struct description *d, int b)
{
    const struct entry *const entry = &d->entry[PART_BODY][d->back[b]];
    const struct tree_node *const node = tree_find(entry->map, "coordinate");
    char path[DESCRIPTION_PATH], text[STANCE_NAME + 8], word[SHOWN_SIZE];
    description_path(path, PART_BODY, entry, "coordinate");
    if (!node)
        return true;
    if (!field_text(&d->r->problems, path, node, text, sizeof text))
        return false;
    const char *const fault = d->m->body[b].joint == STANCE_FIXED ? "what is fixed has none"
                                                                  : name_fault(PART_BODY, text);
    if (fault)
        return problem_add(&d->r->problems, node->mark, "%s: '%s' is no name: %s", path,
                           shown(word, text), fault);
    for (int other = 0; other < d->m->bodies; other++) {
        const char *const own = d->m->body[other].coordinate;
        const char *const its = own[0] ? own : d->m->body[other].name;
        if (other == b || d->m->body[other].joint == STANCE_FIXED)
            continue;
        if (strcmp(its, text) == 0 || (text[0] == 'v' && strcmp(its, text + 1) == 0) ||
            (its[0] == 'v' && strcmp(its + 1, text) == 0))
            return problem_add(&d->r->problems, node->mark,
                               "%s: the coordinate of %s, or its rate, is called so, too: choose "
                               "another name",
                               path, d->m->body[other].name);
    }
    return true;
}

static bool check_links(struct description *d)
{
    bool good = check_joints(d);
    for (int b = 0; b < d->m->bodies; b++)
        good = check_coordinate(d, b) && good;
    for (int i = 0; i < d->m->points; i++)
        good = check_push(d, i) && good;
    for (int i = 0; i < d->m->elements; i++)
        good = check_contact(d, i) && good;
    for (int i = 0; i < d->m->actuators; i++)
        good = check_actuator(d, i) && good;
    return good;
}

/* The pieces of the ground, each of its kind. */
static bool read_plates(struct description *d)
{
    bool good = read_names(d, PART_PLATE);
    for (int i = 0; good && i < d->count[PART_PLATE]; i++) {
        struct entry *const entry = &d->entry[PART_PLATE][i];
        int word = STANCE_PLATE;
        good = read_word(d, PART_PLATE, entry, "kind", &word);
        entry->ground = (stance_ground_kind)word;
    }
    return good;
}

static bool describe(struct description *d)
{
    const struct tree_node *const robot = tree_find(d->r->tree.root, "robot");
    const char *known[ROBOT_PARTS];
    bool good;
    if (!robot)
        return problem_add(&d->r->problems, d->r->tree.root->mark,
                           "robot is missing: it describes the mechanism");
    if (robot->kind != TREE_MAP)
        return field_mismatch(&d->r->problems, "robot", "a mapping", robot);
    for (int part = 0; part < ROBOT_PARTS; part++)
        known[part] = part_kinds[part].key;
    good = check_keys(d, robot, "robot", known, ROBOT_PARTS);
    for (int part = 0; part < ROBOT_PARTS; part++)
        good = read_names(d, (enum part)part) && good;
    good = read_plates(d) && good;
    if (!good || !read_links(d) || !sort_bodies(d))
        return false;
    fill_structure(d);
    stance_mechanism_defaults(&d->m->value);
    good = check_links(d);
    return description_numbers(d) && good;
}

/* ---- more points of a scene that is carried, and its ground ---------------------------------- */

/* Its parts as if the file wrote them, without a key. */
static void enter_carried(struct description *d, const stance_mechanism *carried)
{
    static const struct tree_node nothing = {.kind = TREE_MAP};
    *d->m = *carried;
    for (int part = 0; part < PARTS; part++) {
        d->count[part] = part_count(carried, (enum part)part);
        for (int i = 0; i < d->count[part]; i++) {
            struct tree_key *const key = &d->carried[part][i];
            key->name = part_name(carried, (enum part)part, i);
            d->entry[part][i] = (struct entry){.key = key,
                                               .map = &nothing,
                                               .parent = -1,
                                               .like = -1,
                                               .body = part_body(carried, (enum part)part, i)};
        }
    }
    for (int b = 0; b < carried->bodies; b++) {
        d->body_name[b] = part_name(carried, PART_BODY, b);
        d->place[b] = d->back[b] = b;
    }
}

/* One of robot.points: of a point that there is, or a new one. */
static bool read_point(struct description *d, const struct tree_key *key,
                       const struct tree_node *map)
{
    int i = 0;
    while (i < d->m->points && strcmp(d->m->point[i].name, key->name) != 0)
        i++;
    if (i == STANCE_MAX_NAMED)
        return problem_add(&d->r->problems, key->mark, "robot.points: at most %d fit",
                           STANCE_MAX_NAMED);
    struct entry *const entry = &d->entry[PART_POINT][i];
    const bool more = i == d->m->points;
    if (more)
        *entry = (struct entry){.parent = -1, .like = -1};
    entry->key = key;
    entry->map = map;
    d->count[PART_POINT] = d->m->points + more;
    if ((more && !check_name(d, PART_POINT, i)) || !check_part(d, PART_POINT, entry) ||
        ((more || tree_find(map, "body")) &&
         !read_body(d, PART_POINT, entry, "body", &entry->body)))
        return false;
    d->m->points += more;
    fill_point(d, i);
    return check_push(d, i);
}

/* What a file adds to a scene that is carried. */
static bool read_carried(struct description *d, const stance_mechanism *carried)
{
    const struct tree_node *const map = tree_find(tree_find(d->r->tree.root, "robot"), "points");
    bool good = true;
    enter_carried(d, carried);
    if (map && map->kind != TREE_MAP)
        good = field_mismatch(&d->r->problems, "robot.points", "a mapping of names, without dashes",
                              map);
    for (size_t k = 0; map && map->kind == TREE_MAP && k < map->count; k++)
        good = read_point(d, &map->key[k], map->item[k]) && good;
    good = read_plates(d) && good;
    fill_plates(d);
    return good && description_numbers(d);
}

/* ---- the scene ------------------------------------------------------------------------------- */

/* Names that the scene makes of those that are given must be its own, too. */
static bool check_contact_names(struct description *d, const stance_scene *scene)
{
    for (int c = 0; c < scene->contacts; c++)
        for (int k = 0; k < c; k++)
            if (strcmp(scene->contact_name[c], scene->contact_name[k]) == 0)
                return problem_add(&d->r->problems, description_mark(d),
                                   "robot: %s would stand for two contacts (an end of a sole, or "
                                   "the stop of a joint, is called so): choose other names",
                                   scene->contact_name[c]);
    return true;
}

static stance_scene *make_scene(struct description *d)
{
    stance_scene *scene = NULL;
    stance_message message;
    const stance_error error = stance_mechanism_scene(d->m, &scene, &message);
    if (error == STANCE_NO_MEMORY) {
        problem_no_memory(&d->r->problems);
    } else if (error != STANCE_OK) {
        problem_add(&d->r->problems, description_mark(d), "robot: %s", message.text);
    } else if (!check_contact_names(d, scene)) {
        stance_scene_free(scene);
        scene = NULL;
    }
    return scene;
}

stance_scene *mechanism_read(struct reader *r, const stance_scene *carried)
{
    struct description *const d = calloc(1, sizeof *d);
    stance_mechanism *const m = calloc(1, sizeof *m);
    stance_scene *scene = NULL;
    if (d && m) {
        d->r = r;
        d->m = m;
        if (carried ? read_carried(d, carried->mechanism) : describe(d))
            scene = make_scene(d);
    } else {
        problem_no_memory(&r->problems);
    }
    free(d);
    free(m);
    return scene;
}

bool mechanism_same(const stance_mechanism *a, const stance_mechanism *b)
{
    const size_t before = offsetof(stance_mechanism, value),
                 behind = offsetof(stance_mechanism, numbers);
    /* What stands between the members is 0 in both: mechanism_read's memory. */
    return memcmp(a, b, before) == 0 &&
           memcmp((const char *)a + behind, (const char *)b + behind, sizeof *a - behind) == 0;
}

uint32_t mechanism_contacts(const stance_scene *scene, uint32_t elements)
{
    const stance_mechanism *const m = scene->mechanism;
    uint32_t contacts = 0;
    stance_contact_place at;
    for (int c = 0; stance_mechanism_contact(m, c, &at) && at.element >= 0; c++)
        contacts |= (elements >> at.element & 1) << c;
    return contacts;
}

stance_scene *mechanism_pattern(void)
{
    stance_mechanism *const m = calloc(1, sizeof *m);
    stance_scene *scene = NULL;
    stance_message message;
    if (!m)
        return NULL;
    m->bodies = m->elements = m->points = m->actuators = 1;
    m->body[0].joint = STANCE_FREE;
    part_put(m, PART_BODY, 0, "BODY", -1);
    part_put(m, PART_CONTACT, 0, "CONTACT", 0);
    part_put(m, PART_POINT, 0, "POINT", 0);
    part_put(m, PART_ACTUATOR, 0, "ACTUATOR", 0);
    stance_mechanism_defaults(&m->value);
    if (stance_mechanism_scene(m, &scene, &message) != STANCE_OK)
        scene = NULL;
    free(m);
    return scene;
}
