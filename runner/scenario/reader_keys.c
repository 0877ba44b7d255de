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

/* The key whose value commas cut before key i of a mapping; i: it is none of the pieces. */
static size_t cut_key(const struct tree_node *map, size_t i)
{
    size_t first = i;
    while (first > 0 && is_empty(map->item[first]))
        first--;
    return map->item[first]->kind == TREE_SCALAR ? first : i;
}

/* The row of a key below a path. */
static const struct scenario_field *row_below(const struct reader *r, const char *path,
                                              const char *key)
{
    char below[PATH_SIZE + 32];
    snprintf(below, sizeof below, "%s%s%.64s", path, path[0] ? "." : "", key);
    return schema_find(r->schema, below);
}

/* The key below a path of which a text is a word; NULL: of none. */
static const char *key_of_word(const struct reader *r, const char *path, const char *text)
{
    const size_t length = strlen(path);
    for (size_t k = 0; k < r->schema->count; k++) {
        const struct scenario_field *const child = &r->schema->field[k];
        const char *const key = child->path + length + 1;
        if (strncmp(child->path, path, length) != 0 || child->path[length] != '.' ||
            strchr(key, '.') || child->type != FIELD_WORD)
            continue;
        if (word_place(text, child->words, child->word_count) < child->word_count)
            return key;
    }
    return NULL;
}

static bool is_list(enum field_type type)
{
    return type == FIELD_WORDS || type == FIELD_POLES || type == FIELD_NUMBERS ||
           type == FIELD_PATHS || type == FIELD_VALUES;
}

/* What is no key at all, but what comes of one with a comma in its number, an equals sign, or a
 * path: says what to write and returns true. */
static bool mended_key(struct reader *r, const struct tree_node *map, size_t i, const char *path,
                       const char *name)
{
    const struct tree_key *key = &map->key[i];
    char word[TREE_MAX_NAME], mend[MEND_SIZE] = "", value[SHOWN_SIZE], next[SHOWN_SIZE];
    const bool empty = is_empty(map->item[i]);
    const size_t first = cut_key(map, i);
    const char *const cut = map->key[first].name, *const dot =
                                                      path[0] ? NULL : strchr(key->name, '.');
    const struct scenario_field *const field = first < i ? row_below(r, path, cut) : NULL;
    const char *why = "a comma begins another key";
    if (field)
        shown(value, map->item[first]->text);
    if (field && is_list(field->type)) {
        if (i > first + 1)
            return true; /* said of the first piece */
        snprintf(mend, sizeof mend, "%.64s: [%s, %s%s]", cut, value, shown(next, key->name),
                 i + 1 < map->count && is_empty(map->item[i + 1]) ? ", ..." : "");
    } else if (field && key->name[0] && !key->name[strspn(key->name, "0123456789")]) {
        snprintf(mend, sizeof mend, "%.64s: %s.%s", cut, value, shown(next, key->name));
    } else if (empty && key_of_word(r, path, key->name)) {
        why = "this is a value, not a key";
        snprintf(mend, sizeof mend, "%s: %s", key_of_word(r, path, key->name), key->name);
    } else if (empty && mend_pair(key->name, word, sizeof word, mend) && row_below(r, path, word)) {
        why = "a colon and a blank stand after a key";
    } else if (strcmp(path, "sweep") == 0 && row_below(r, "sweep.grid[]", key->name)) {
        why = "this belongs to an axis";
        snprintf(mend, sizeof mend, "grid: and below it - {%s: ...}", key->name);
    } else if (dot && schema_find(r->schema, key->name) && !strchr(dot + 1, '.') &&
               strlen(key->name) < 64) {
        why = "a path is for sweeps and --set; here keys stand in each other";
        snprintf(mend, sizeof mend, "%.*s: {%s: ...}", (int)(dot - key->name), key->name, dot + 1);
    } else {
        return false;
    }
    return !problem_add(&r->problems, key->mark, "%s%s%s; write %.200s", name, name[0] ? ": " : "",
                        why, mend);
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

static void unknown_key(struct reader *r, const struct tree_key *key, const char *path,
                        const char *name, const char *const *known, size_t count)
{
    char near_path[PATH_SIZE], word[SHOWN_SIZE], list[500];
    const char *const colon = name[0] ? ": " : "";
    const bool full = problems_full(&r->problems);
    const char *const near = full ? NULL : mend_word(key->name, known, count);
    const struct scenario_field *const other = full || near ? NULL : elsewhere(r, key->name),
                                       *const meant = near ? row_below(r, path, near) : NULL;

    snprintf(near_path, sizeof near_path, "%s%s%.64s", path, path[0] ? "." : "", key->name);
    shown(word, key->name);
    if (strcmp(near_path, "stop.capture") == 0) { /* of former versions */
        problem_add(&r->problems, key->mark,
                    "%s is no longer there: leave it out; where a map takes long sweep.refine "
                    "simulates fewer cases",
                    near_path);
    } else if (!near && !full && r->s->scene && schema_scene_with(near_path)) {
        problem_add(&r->problems, key->mark, "%s%sthe scene %s has no key '%s' (known: %s)", name,
                    colon, r->s->scene->name, word, word_list(list, sizeof list, known, count));
        if (strcmp(path, "initial") == 0)
            reader_seen(r, path)->excused = true; /* that there is no start is said already */
    } else if (other) {
        problem_add(&r->problems, key->mark, "%s%sunknown key '%s'; did you mean '%s'?", name,
                    colon, word, other->path);
    } else {
        field_unknown(&r->problems, name, "key", key->name, key->mark, known, count);
    }
    if (meant)
        r->seen[meant - r->schema->field].excused = true;
}

void reader_check_keys(struct reader *r, const struct tree_node *map, const char *path,
                       const char *name)
{
    const char *known[SCHEMA_MAX_FIELDS];
    size_t count = schema_children(r->schema, path, known, SCHEMA_MAX_FIELDS);

    for (size_t i = 0; i < map->count; i++) {
        const bool found = word_place(map->key[i].name, known, count) < count;
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
    char name[TREE_MAX_NAME], mend[MEND_SIZE], word[SHOWN_SIZE];
    double number;
    bool finite;
    const bool pair = node->kind == TREE_SCALAR && mend_pair(node->text, name, sizeof name, mend);

    for (size_t k = 0; k < count && node->kind == TREE_SCALAR; k++) {
        const struct scenario_field *child = row_below(r, field->path, known[k]);
        bool meant = pair ? strcmp(name, known[k]) == 0
                          : child->type == FIELD_NUMBER && child->required &&
                                child->use == USE_ALWAYS &&
                                number_parse(node->text, &number, &finite);
        meant = meant || (!pair && word_place(node->text, child->words, child->word_count) <
                                       child->word_count);
        if (!meant)
            continue;
        if (!pair)
            snprintf(mend, sizeof mend, "{%s%s: %s}",
                     child->use == USE_FEEDBACK ? "kind: state-feedback, " : "", known[k],
                     node->text);
        problem_add(&r->problems, node->mark, "%s: expected %s, found '%s'; write %s", field->path,
                    wanted, shown(word, node->text), mend);
        return;
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
