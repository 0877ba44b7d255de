/* tree.c - YAML text as nodes with line and column, edited by --set, written back as YAML.
 *
 * libyaml delivers events; everything that lives as long as the tree comes from one chain of
 * blocks, so that no error path has anything to release.
 */
#include "tree.h"
#include "mend.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <yaml.h>

/* ---- memory ---------------------------------------------------------------------------------- */

enum { BLOCK_BYTES = 1 << 16 };

struct tree_block {
    struct tree_block *next;
    size_t used, size;
    max_align_t data[];
};

static void *allocate(struct tree *tree, size_t size)
{
    size = (size + sizeof(max_align_t) - 1) / sizeof(max_align_t) * sizeof(max_align_t);
    struct tree_block *block = tree->blocks;
    if (!block || block->size - block->used < size) {
        size_t room = size > BLOCK_BYTES ? size : BLOCK_BYTES;
        block = malloc(sizeof *block + room);
        if (!block)
            return NULL;
        *block = (struct tree_block){.next = tree->blocks, .size = room};
        tree->blocks = block;
    }
    void *memory = (char *)block->data + block->used;
    block->used += size;
    memset(memory, 0, size);
    return memory;
}

static char *copy_text(struct tree *tree, const char *text, size_t length)
{
    char *copy = allocate(tree, length + 1);
    if (copy)
        memcpy(copy, text, length);
    return copy;
}

void tree_free(struct tree *tree)
{
    while (tree->blocks) {
        struct tree_block *next = tree->blocks->next;
        free(tree->blocks);
        tree->blocks = next;
    }
    tree->root = NULL;
}

static struct tree_node *new_node(struct tree *tree, enum tree_kind kind, struct mark mark)
{
    struct tree_node *node = allocate(tree, sizeof *node);
    if (node) {
        node->kind = kind;
        node->mark = mark;
    }
    return node;
}

/* Appends to a list, or, with a key, to a mapping. */
static bool append(struct tree *tree, struct tree_node *parent, const struct tree_key *key,
                   struct tree_node *item)
{
    if (parent->count == parent->room) {
        size_t room = parent->room ? 2 * parent->room : 8;
        struct tree_node **items = allocate(tree, room * sizeof(void *));
        struct tree_key *keys = key ? allocate(tree, room * sizeof *keys) : NULL;
        if (!items || (key && !keys))
            return false;
        if (parent->item)
            memcpy(items, parent->item, parent->count * sizeof(void *));
        if (key && parent->key)
            memcpy(keys, parent->key, parent->count * sizeof *keys);
        parent->item = items;
        parent->key = keys;
        parent->room = room;
    }
    if (key)
        parent->key[parent->count] = *key;
    parent->item[parent->count++] = item;
    return true;
}

static struct tree_node **find_place(const struct tree_node *map, const char *key, size_t *index)
{
    for (size_t i = 0; map->kind == TREE_MAP && map->item && i < map->count; i++) {
        if (strcmp(map->key[i].name, key) == 0) {
            *index = i;
            return &map->item[i];
        }
    }
    return NULL;
}

struct tree_node *tree_find(const struct tree_node *map, const char *key)
{
    size_t index;
    struct tree_node **place = find_place(map, key, &index);
    return place ? *place : NULL;
}

/* ---- parsing --------------------------------------------------------------------------------- */

struct parse {
    struct tree *tree;
    struct problems *problems;
    yaml_parser_t parser;
    yaml_event_t event; /* the one being looked at; deleted by `next` */
    const char *text;
    size_t length;
    int set;
    size_t anchors;
    struct {
        char *name;
        struct tree_node *node; /* NULL until it is complete */
    } anchor[TREE_MAX_ANCHORS];
};

static struct mark event_mark(const struct parse *parse)
{
    const yaml_mark_t at = parse->event.start_mark;
    return (struct mark){parse->set, (int)at.line + 1, (int)at.column + 1};
}

static bool next(struct parse *parse)
{
    yaml_event_delete(&parse->event);
    if (yaml_parser_parse(&parse->parser, &parse->event))
        return true;
    memset(&parse->event, 0, sizeof parse->event);
    if (parse->parser.error == YAML_MEMORY_ERROR)
        return problem_no_memory(parse->problems);
    const yaml_parser_t *parser = &parse->parser;
    const bool has_mark = parser->problem_mark.index || parser->problem_mark.line;
    const yaml_mark_t at = has_mark ? parser->problem_mark : parser->context_mark;
    struct misread misread = {
        .text = parse->text,
        .length = parse->length,
        .problem = parser->problem ? parser->problem : "malformed",
        .line = at.line,
        .column = at.column,
        .context_line = parser->context_mark.line,
        .context_column = parser->context_mark.column,
    };
    char mend[MEND_SIZE];
    const bool mended = mend_yaml(&misread, mend);
    const struct mark mark = {parse->set, (int)misread.line + 1, (int)misread.column + 1};
    return problem_add(parse->problems, mark, "not YAML: %s", mended ? mend : misread.problem);
}

static bool too_deep(struct problems *problems, struct mark mark)
{
    return problem_add(problems, mark, "nested deeper than %d levels", TREE_MAX_DEPTH);
}

/* What an alias stands for, as a copy of its own. */
static bool copy_node(struct parse *parse, const struct tree_node *from, int depth,
                      struct mark alias, struct tree_node **out)
{
    struct tree *tree = parse->tree;
    if (depth > TREE_MAX_DEPTH)
        return too_deep(parse->problems, alias);
    if (++tree->copied > TREE_MAX_COPIED) {
        return problem_add(parse->problems, alias, "aliases expand to more than %d nodes",
                           TREE_MAX_COPIED);
    }
    struct tree_node *node = new_node(tree, from->kind, from->mark);
    if (!node)
        return problem_no_memory(parse->problems);
    node->quoted = from->quoted;
    node->text = from->text;
    for (size_t i = 0; i < from->count; i++) {
        struct tree_node *item;
        if (!copy_node(parse, from->item[i], depth + 1, alias, &item))
            return false;
        if (!append(tree, node, from->kind == TREE_MAP ? &from->key[i] : NULL, item))
            return problem_no_memory(parse->problems);
    }
    *out = node;
    return true;
}

static bool read_alias(struct parse *parse, int depth, struct tree_node **out)
{
    const char *name = (const char *)parse->event.data.alias.anchor;
    struct mark mark = event_mark(parse);
    char word[SHOWN_SIZE];
    for (size_t i = parse->anchors; i-- > 0;) {
        if (strcmp(parse->anchor[i].name, name) != 0)
            continue;
        if (!parse->anchor[i].node) {
            return problem_add(parse->problems, mark, "the alias *%s stands inside what it names",
                               shown(word, name));
        }
        return copy_node(parse, parse->anchor[i].node, depth, mark, out);
    }
    return problem_add(
        parse->problems, mark,
        "no anchor &%s stands before this alias; text that begins with * stands in quotes",
        shown(word, name));
}

/* Notes the anchor of the event, if it has one; *index is then where. Tags are refused. */
static bool read_properties(struct parse *parse, const yaml_char_t *anchor, const yaml_char_t *tag,
                            size_t *index)
{
    char word[SHOWN_SIZE];
    *index = SIZE_MAX;
    if (tag) {
        return problem_add(parse->problems, event_mark(parse),
                           "the tag %s is not accepted: types follow from the keys",
                           shown(word, (const char *)tag));
    }
    if (!anchor)
        return true;
    if (parse->anchors == TREE_MAX_ANCHORS) {
        return problem_add(parse->problems, event_mark(parse), "more than %d anchors",
                           TREE_MAX_ANCHORS);
    }
    *index = parse->anchors++;
    parse->anchor[*index].node = NULL;
    parse->anchor[*index].name =
        copy_text(parse->tree, (const char *)anchor, strlen((const char *)anchor));
    if (!parse->anchor[*index].name)
        return problem_no_memory(parse->problems);
    return true;
}

static bool read_text(struct parse *parse, const char **text)
{
    const char *value = (const char *)parse->event.data.scalar.value;
    size_t length = parse->event.data.scalar.length;
    if (strlen(value) != length)
        return problem_add(parse->problems, event_mark(parse), "a zero byte stands in this text");
    *text = copy_text(parse->tree, value, length);
    if (!*text)
        return problem_no_memory(parse->problems);
    return true;
}

static bool read_node(struct parse *parse, int depth, struct tree_node **out);

static bool read_scalar(struct parse *parse, struct tree_node *node)
{
    node->quoted = parse->event.data.scalar.style != YAML_PLAIN_SCALAR_STYLE;
    return read_text(parse, &node->text);
}

static bool read_list(struct parse *parse, int depth, struct tree_node *node)
{
    for (;;) {
        struct tree_node *item;
        if (!next(parse))
            return false;
        if (parse->event.type == YAML_SEQUENCE_END_EVENT)
            return true;
        if (!read_node(parse, depth + 1, &item))
            return false;
        if (!append(parse->tree, node, NULL, item))
            return problem_no_memory(parse->problems);
    }
}

static bool read_map(struct parse *parse, int depth, struct tree_node *node)
{
    for (;;) {
        struct tree_key key;
        struct tree_node *item;
        size_t first;
        char word[SHOWN_SIZE];
        if (!next(parse))
            return false;
        if (parse->event.type == YAML_MAPPING_END_EVENT)
            return true;
        key.mark = event_mark(parse);
        if (parse->event.type != YAML_SCALAR_EVENT || parse->event.data.scalar.tag)
            return problem_add(parse->problems, key.mark, "a key must be a plain word");
        if (node->count == TREE_MAX_KEYS) {
            return problem_add(parse->problems, key.mark, "more than %d keys in one mapping",
                               TREE_MAX_KEYS);
        }
        if (!read_text(parse, &key.name) || !next(parse) || !read_node(parse, depth + 1, &item))
            return false;
        if (find_place(node, key.name, &first)) {
            problem_add(parse->problems, key.mark, "duplicate key '%s' (first in line %d)",
                        shown(word, key.name), node->key[first].mark.line);
        } else if (!append(parse->tree, node, &key, item)) {
            return problem_no_memory(parse->problems);
        }
    }
}

/* The node that begins with the present event; leaves its last event in place. */
static bool read_node(struct parse *parse, int depth, struct tree_node **out)
{
    const yaml_event_t *event = &parse->event;
    struct mark mark = event_mark(parse);
    size_t anchor;
    bool good;

    if (depth > TREE_MAX_DEPTH)
        return too_deep(parse->problems, mark);
    if (event->type == YAML_ALIAS_EVENT)
        return read_alias(parse, depth, out);
    enum tree_kind kind = event->type == YAML_SCALAR_EVENT           ? TREE_SCALAR
                          : event->type == YAML_SEQUENCE_START_EVENT ? TREE_LIST
                                                                     : TREE_MAP;
    struct tree_node *node = new_node(parse->tree, kind, mark);
    if (!node)
        return problem_no_memory(parse->problems);
    if (kind == TREE_SCALAR) {
        good = read_properties(parse, event->data.scalar.anchor, event->data.scalar.tag, &anchor) &&
               read_scalar(parse, node);
    } else if (kind == TREE_LIST) {
        good = read_properties(parse, event->data.sequence_start.anchor,
                               event->data.sequence_start.tag, &anchor) &&
               read_list(parse, depth, node);
    } else {
        good = read_properties(parse, event->data.mapping_start.anchor,
                               event->data.mapping_start.tag, &anchor) &&
               read_map(parse, depth, node);
    }
    if (good && anchor != SIZE_MAX)
        parse->anchor[anchor].node = node;
    *out = node;
    return good;
}

static bool read_document(struct parse *parse, struct tree_node **root)
{
    if (!next(parse) || !next(parse)) /* start of the stream, then of the document */
        return false;
    if (parse->event.type == YAML_STREAM_END_EVENT) {
        if (parse->set > 0) { /* --set a= : nothing, as in "a:" */
            *root = new_node(parse->tree, TREE_SCALAR, (struct mark){parse->set, 1, 1});
            if (*root) {
                (*root)->text = "";
                return true;
            }
            return problem_no_memory(parse->problems);
        }
        return problem_add(parse->problems, (struct mark){parse->set, 0, 0},
                           "nothing stands in this file");
    }
    if (!next(parse) || !read_node(parse, 1, root) || !next(parse) || !next(parse))
        return false;
    if (parse->event.type != YAML_STREAM_END_EVENT) {
        return problem_add(parse->problems, event_mark(parse),
                           "a second document begins here; a scenario is one");
    }
    return true;
}

static bool parse_text(struct tree *tree, const char *text, size_t length, int set,
                       struct problems *problems, struct tree_node **root)
{
    struct parse *parse = calloc(1, sizeof *parse);
    if (!parse || !yaml_parser_initialize(&parse->parser)) {
        free(parse);
        return problem_no_memory(problems);
    }
    parse->tree = tree;
    parse->problems = problems;
    parse->set = set;
    parse->text = text;
    parse->length = length;
    yaml_parser_set_encoding(&parse->parser, YAML_UTF8_ENCODING);
    yaml_parser_set_input_string(&parse->parser, (const unsigned char *)text, length);
    bool good = read_document(parse, root);
    yaml_event_delete(&parse->event);
    yaml_parser_delete(&parse->parser);
    free(parse);
    return good;
}

bool tree_parse(struct tree *tree, const char *text, size_t length, struct problems *problems)
{
    static const char byte_order_mark[] = "\xef\xbb\xbf";
    if (length >= 3 && memcmp(text, byte_order_mark, 3) == 0) {
        text += 3;
        length -= 3;
    }
    return parse_text(tree, text, length, 0, problems, &tree->root);
}

/* ---- paths and edits ------------------------------------------------------------------------- */

bool tree_path_step(const char **at, bool first, char name[TREE_MAX_NAME], size_t *index)
{
    const char *s = *at;
    size_t n = 0;

    name[0] = '\0';
    *index = 0;
    if (!first && *s == '[') {
        for (s++; *s >= '0' && *s <= '9' && n < 9; s++, n++)
            *index = *index * 10 + (size_t)(*s - '0');
        /* One way only to write an index, so that equal paths are equal strings. */
        if (n == 0 || *s != ']' || (n > 1 && s[-(ptrdiff_t)n] == '0'))
            return false;
        *at = s + 1;
        return true;
    }
    if (!first && *s++ != '.')
        return false;
    while (tree_name_letter(s[n]))
        n++;
    if (n == 0 || n >= TREE_MAX_NAME)
        return false;
    memcpy(name, s, n);
    name[n] = '\0';
    *at = s + n;
    return true;
}

/* Where the next step of the path leads from *place, making what is missing. */
static struct tree_node **descend(struct tree *tree, struct tree_node **place, const char *name,
                                  size_t index, const char *so_far, struct mark mark,
                                  struct problems *problems)
{
    struct tree_node *node = *place;
    enum tree_kind kind = name[0] ? TREE_MAP : TREE_LIST;
    struct tree_key key = {name, mark};
    size_t found;

    if (node->fresh) {
        node->kind = kind;
        node->fresh = false;
    }
    if (node->kind != kind) {
        problem_add(problems, mark, "%s is not a %s; set it as a whole", so_far,
                    kind == TREE_MAP ? "mapping" : "list");
        return NULL;
    }
    struct tree_node *item = new_node(tree, TREE_SCALAR, mark);
    if (!item) {
        problem_no_memory(problems);
        return NULL;
    }
    item->text = "";
    item->fresh = true;
    if (kind == TREE_LIST) {
        if (index < node->count)
            return &node->item[index];
        if (index > node->count) {
            problem_add(problems, mark, "%s has %zu item%s, so [%zu] is beyond its end", so_far,
                        node->count, node->count == 1 ? "" : "s", index);
            return NULL;
        }
        node->mark = mark; /* its length is now that of --set */
        if (append(tree, node, NULL, item))
            return &node->item[index];
    } else {
        struct tree_node **at = find_place(node, name, &found);
        if (at)
            return at;
        key.name = copy_text(tree, name, strlen(name));
        if (key.name && append(tree, node, &key, item))
            return &node->item[node->count - 1];
    }
    problem_no_memory(problems);
    return NULL;
}

static bool path_is_good(const char *path)
{
    char name[TREE_MAX_NAME];
    size_t index, steps = 0;
    for (const char *at = path; steps == 0 || *at; steps++)
        if (steps == TREE_MAX_DEPTH || !tree_path_step(&at, steps == 0, name, &index))
            return false;
    return true;
}

bool tree_set(struct tree *tree, const char *path_and_value, int set, struct problems *problems)
{
    struct mark mark = {set, 1, 1};
    const char *equals = strchr(path_and_value, '=');
    if (!equals) {
        const size_t path = strcspn(path_and_value, ": ");
        const char *value = path_and_value + path + strspn(path_and_value + path, ": ");
        char name[SHOWN_SIZE], word[SHOWN_SIZE], start[SHOWN_SIZE];
        snprintf(start, sizeof start, "%.*s", (int)(path < 44 ? path : 44), path_and_value);
        return problem_add(problems, mark, "a value must follow; write %s=%s", shown(name, start),
                           *value ? shown(word, value) : "VALUE");
    }
    size_t length = strlen(equals + 1);
    struct tree_node *value = NULL;
    if (strlen(path_and_value) > TREE_MAX_BYTES)
        return problem_add(problems, mark, "longer than %d bytes", TREE_MAX_BYTES);
    char *path = copy_text(tree, path_and_value, (size_t)(equals - path_and_value));
    if (!path)
        return problem_no_memory(problems);
    size_t before = problems->count;
    bool good = tree_check_text(equals + 1, length, problems);
    for (size_t i = before; i < problems->count; i++)
        problems->list[i].mark = mark;
    if (!good)
        return false;
    if (!path_is_good(path)) {
        char word[SHOWN_SIZE];
        return problem_add(problems, mark, "'%s' is not a path such as sweep.grid[0].count",
                           shown(word, path));
    }
    if (!parse_text(tree, equals + 1, length, set, problems, &value))
        return false;
    struct tree_node **place = &tree->root;
    char name[TREE_MAX_NAME], so_far[SHOWN_SIZE], *from = path;
    const char *at = path;
    size_t index;
    for (bool first = true; *at; first = false) {
        char *prefix = copy_text(tree, from, (size_t)(at - from));
        if (!prefix || !tree_path_step(&at, first, name, &index))
            return problem_no_memory(problems);
        shown(so_far, first ? "the scenario" : prefix);
        place = descend(tree, place, name, index, so_far, mark, problems);
        if (!place)
            return false;
    }
    *place = value;
    return true;
}
