/* reader_keys.c - keys that are unknown, mappings that are none: what to write instead. */
#include "mend.h"
#include "reader.h"

#include "runner/base/words.h"

#include <string.h>

enum { PATH_SIZE = 160 };

static bool is_below(const char *path, const char *map)
{
    const size_t length = strlen(map);
    return strncmp(path, map, length) == 0 && (!path[length] || path[length] == '.');
}

bool reader_described(const struct reader *r, const char *path)
{
    if (!r->s->own_scene || !path[0])
        return false;
    return is_below(path, "ground.plates") ||
           is_below(path, r->s->own_scene->mechanism->carried ? "robot.points" : "robot");
}

static bool is_empty(const struct tree_node *node)
{
    return node->kind == TREE_SCALAR && !node->quoted && !node->text[0];
}

/* What is no key at all, but what comes of one with a comma in its number, an equals sign, or a
 * path: says what to write and returns true. */
static bool mended_key(struct reader *r, const struct tree_node *map, size_t i, const char *path,
                       const char *name)
{
    const struct tree_key *key = &map->key[i];
    char word[TREE_MAX_NAME], mend[MEND_SIZE], below[PATH_SIZE], value[SHOWN_SIZE],
        next[SHOWN_SIZE];
    const bool empty = is_empty(map->item[i]);
    const char *separator = name[0] ? ": " : "";

    size_t first = i; /* the key whose value the commas cut */
    while (first > 0 && is_empty(map->item[first]))
        first--;
    if (first < i && map->item[first]->kind == TREE_SCALAR) {
        snprintf(below, sizeof below, "%s%s%.64s", path, path[0] ? "." : "", map->key[first].name);
        const struct scenario_field *field = schema_find(r->schema, below);
        const enum field_type type = field ? field->type : FIELD_MAP;
        if (type == FIELD_WORDS || type == FIELD_POLES || type == FIELD_NUMBERS ||
            type == FIELD_PATHS || type == FIELD_VALUES) {
            if (i == first + 1)
                problem_add(&r->problems, key->mark,
                            "%s%sa comma begins another key; write %.64s: [%s, %s%s]", name,
                            separator, map->key[first].name, shown(value, map->item[first]->text),
                            shown(next, key->name),
                            i + 1 < map->count && is_empty(map->item[i + 1]) ? ", ..." : "");
            return true;
        }
        if (field && key->name[0] && !key->name[strspn(key->name, "0123456789")]) {
            problem_add(&r->problems, key->mark,
                        "%s%sa comma begins another key; write %.64s: %s.%s", name, separator,
                        map->key[first].name, shown(value, map->item[first]->text),
                        shown(next, key->name));
            return true;
        }
    }
    for (size_t k = 0; empty && k < r->schema->count; k++) {
        const struct scenario_field *child = &r->schema->field[k];
        const size_t length = strlen(path);
        if (strncmp(child->path, path, length) != 0 || child->path[length] != '.' ||
            strchr(child->path + length + 1, '.') || child->type != FIELD_WORD)
            continue;
        for (size_t w = 0; w < child->word_count; w++) {
            if (strcmp(child->words[w], key->name) == 0) {
                problem_add(&r->problems, key->mark, "%s%s'%s' is a value; write %s: %s", name,
                            separator, key->name, child->path + length + 1, key->name);
                return true;
            }
        }
    }
    if (empty && mend_pair(key->name, word, sizeof word, mend)) {
        snprintf(below, sizeof below, "%s%s%s", path, path[0] ? "." : "", word);
        if (schema_find(r->schema, below)) {
            problem_add(&r->problems, key->mark,
                        "%s%sa colon and a blank stand after a key; write %.160s", name, separator,
                        mend);
            return true;
        }
    }
    snprintf(below, sizeof below, "sweep.grid[].%.64s", key->name);
    if (strcmp(path, "sweep") == 0 && schema_find(r->schema, below)) {
        problem_add(&r->problems, key->mark,
                    "sweep: %s belongs to an axis; write grid: and below it - {%s: ...}", key->name,
                    key->name);
        return true;
    }
    const char *dot = path[0] ? NULL : strchr(key->name, '.');
    if (dot && schema_find(r->schema, key->name) && !strchr(dot + 1, '.') &&
        strlen(key->name) < 64) {
        problem_add(&r->problems, key->mark,
                    "a path is for sweeps and --set; here keys stand in each other; write %.*s: "
                    "{%s: ...}",
                    (int)(dot - key->name), key->name, dot + 1);
        return true;
    }
    return false;
}

/* A key that is unknown here but stands elsewhere in the format, or NULL. */
static const struct scenario_field *elsewhere(const struct reader *r, const char *key)
{
    const struct schema *const schema = r->schema;
    for (size_t i = 0; i < schema->count; i++)
        if (!strchr(schema->field[i].path, '[') && !reader_described(r, schema->field[i].path) &&
            strncmp(schema->field[i].path, "robot.points.", 13) != 0 &&
            !(r->s->own_scene && strncmp(schema->field[i].path, "controller.model.", 17) == 0) &&
            strcmp(schema_last_name(schema->field[i].path), key) == 0)
            return &schema->field[i];
    return NULL;
}

/* Keys of former versions, and what to write instead. */
static const char *const removed_keys[][2] = {
    {"stop.capture", "leave it out; where a map takes long sweep.refine simulates fewer cases"},
};

static void unknown_key(struct reader *r, const struct tree_key *key, const char *path,
                        const char *name, const char *const *known, size_t count)
{
    char near_path[PATH_SIZE], word[SHOWN_SIZE], list[500];
    if (problems_full(&r->problems)) {
        field_unknown(&r->problems, name, "key", key->name, key->mark, known, count);
        return;
    }
    const char *near = mend_word(key->name, known, count);
    const struct scenario_field *other = elsewhere(r, key->name);

    snprintf(near_path, sizeof near_path, "%s%s%.64s", path, path[0] ? "." : "", key->name);
    for (size_t k = 0; k < sizeof removed_keys / sizeof *removed_keys; k++) {
        if (strcmp(near_path, removed_keys[k][0]) == 0) {
            problem_add(&r->problems, key->mark, "%s is no longer there: %s", near_path,
                        removed_keys[k][1]);
            return;
        }
    }
    if (!near && r->s->scene && schema_scene_with(near_path)) {
        problem_add(&r->problems, key->mark, "%s%sthe scene %s has no key '%s' (known: %s)", name,
                    name[0] ? ": " : "", r->s->scene->name, shown(word, key->name),
                    word_list(list, sizeof list, known, count));
        if (strcmp(path, "initial") == 0)
            reader_seen(r, path)->excused = true; /* that there is no start is said already */
        return;
    }
    if (!near && other) {
        problem_add(&r->problems, key->mark, "%s%sunknown key '%s'; did you mean '%s'?", name,
                    name[0] ? ": " : "", shown(word, key->name), other->path);
        return;
    }
    field_unknown(&r->problems, name, "key", key->name, key->mark, known, count);
    if (near) {
        snprintf(near_path, sizeof near_path, "%s%s%s", path, path[0] ? "." : "", near);
        const struct scenario_field *field = schema_find(r->schema, near_path);
        if (field)
            r->seen[field - r->schema->field].excused = true;
    }
}

void reader_check_keys(struct reader *r, const struct tree_node *map, const char *path,
                       const char *name)
{
    const char *known[SCHEMA_MAX_FIELDS];
    size_t count = schema_children(r->schema, path, known, SCHEMA_MAX_FIELDS);

    for (size_t i = 0; i < map->count; i++) {
        bool found = false;
        for (size_t k = 0; k < count && !found; k++)
            found = strcmp(map->key[i].name, known[k]) == 0;
        if (!found && (problems_full(&r->problems) || !mended_key(r, map, i, path, name)))
            unknown_key(r, &map->key[i], path, name, known, count);
    }
}

/* A word or a list where a mapping is wanted; what was meant is one of its keys, perhaps. */
void reader_no_mapping(struct reader *r, const struct scenario_field *field,
                       const struct tree_node *node)
{
    const char *wanted =
        field->type == FIELD_MAP ? "a mapping" : "\"off\", or a mapping with angle, rate, hold";
    const char *known[SCHEMA_MAX_FIELDS];
    const size_t count = schema_children(r->schema, field->path, known, SCHEMA_MAX_FIELDS);
    char name[TREE_MAX_NAME], mend[MEND_SIZE], path[PATH_SIZE], word[SHOWN_SIZE];
    double number;
    bool finite;
    const bool pair = node->kind == TREE_SCALAR && mend_pair(node->text, name, sizeof name, mend);

    for (size_t k = 0; k < count && node->kind == TREE_SCALAR; k++) {
        snprintf(path, sizeof path, "%s.%s", field->path, known[k]);
        const struct scenario_field *child = schema_find(r->schema, path);
        bool meant = pair && strcmp(name, known[k]) == 0;
        for (size_t w = 0; !pair && child && w < child->word_count && !meant; w++) {
            meant = strcmp(child->words[w], node->text) == 0;
            snprintf(mend, sizeof mend, "{%s%s: %s}",
                     child->use == USE_FEEDBACK ? "kind: state-feedback, " : "", known[k],
                     node->text);
        }
        if (!pair && !meant && child && child->type == FIELD_NUMBER && child->required &&
            child->use == USE_ALWAYS && number_parse(node->text, &number, &finite)) {
            meant = true;
            snprintf(mend, sizeof mend, "{%s: %s}", known[k], node->text);
        }
        if (meant) {
            problem_add(&r->problems, node->mark, "%s: expected %s, found '%s'; write %s",
                        field->path, wanted, shown(word, node->text), mend);
            return;
        }
    }
    if (field->type == FIELD_MAP_OR_WORD && node->kind == TREE_SCALAR &&
        (strcmp(node->text, "false") == 0 || strcmp(node->text, "no") == 0))
        wanted = "\"off\" (in quotes: to others a bare off is false)";
    if (node->kind == TREE_LIST && node->count > 0) {
        problem_add(&r->problems, node->mark, "%s: expected %s, found a list; %s", field->path,
                    wanted,
                    strcmp(field->path, "sweep") == 0
                        ? "write grid: before it"
                        : "its keys stand in braces, or in lines without a dash");
        return;
    }
    field_mismatch(&r->problems, field->path, wanted, node);
}
