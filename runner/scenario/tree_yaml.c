/* tree_yaml.c - YAML text as nodes with line and column, from the events that libyaml delivers. */
#include "tree.h"

#include "runner/base/words.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <yaml.h>

/* ---- parsing --------------------------------------------------------------------------------- */

/* {a:} and {a:{b: 1}} are YAML 1.2, but not 1.1, which libyaml reads: there a blank is put after
 * the colon, so that what follows in the line is further right than in the file. */
enum { MOST_BARE = 64 };
struct bare {
    char *text; /* with blanks; NULL: as it was given */
    size_t count, line[MOST_BARE], column[MOST_BARE];
};

struct parse {
    struct tree *tree;
    struct problems *problems;
    yaml_parser_t parser;
    yaml_event_t event; /* the one being looked at; deleted by `next` */
    const char *text;
    size_t length;
    int set;
    struct bare *bare;
    size_t anchors;
    struct {
        char *name;
        struct tree_node *node; /* NULL until it is complete */
    } anchor[TREE_MAX_ANCHORS];
};

/* Where a line and a column from 0 are in the file. */
static struct mark mark_at(const struct parse *parse, size_t line, size_t column)
{
    int blanks = 0;
    for (size_t i = 0; i < parse->bare->count; i++)
        blanks += parse->bare->line[i] == line && parse->bare->column[i] < column;
    return (struct mark){parse->set, (int)line + 1, (int)column + 1 - blanks};
}

static struct mark event_mark(const struct parse *parse)
{
    return mark_at(parse, parse->event.start_mark.line, parse->event.start_mark.column);
}

/* Whether the parser gave up at a bare colon, which has a blank after it now. */
static bool mend_bare(struct parse *parse)
{
    const yaml_mark_t at = parse->parser.problem_mark;
    struct bare *const bare = parse->bare;
    size_t place = 0, n = 1;
    uint32_t c = 0;
    if (bare->count == MOST_BARE)
        return false;
    for (size_t i = 0; i <= at.index && place < parse->length && n > 0; i++)
        place += n = utf8_letter(parse->text + place, parse->length - place, &c);
    if (c != ':' || place == parse->length || !strchr(",[]{}", parse->text[place]))
        return false;
    char *const text = malloc(parse->length + 2);
    if (!text)
        return false;
    memcpy(text, parse->text, place);
    text[place] = ' ';
    memcpy(text + place + 1, parse->text + place, parse->length - place);
    text[parse->length + 1] = '\0';
    free(bare->text);
    bare->text = text;
    bare->line[bare->count] = at.line;
    bare->column[bare->count++] = at.column + 1;
    return true;
}

static bool tab_indents(const struct parse *parse, size_t line)
{
    const char *at = parse->text, *const end = parse->text + parse->length;
    for (; line > 0 && (at = memchr(at, '\n', (size_t)(end - at))); line--)
        at++;
    while (at && at < end && *at == ' ')
        at++;
    return at && at < end && *at == '\t';
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
    if (parser->problem && mend_bare(parse))
        return false;
    const bool has_mark = parser->problem_mark.index || parser->problem_mark.line;
    const yaml_mark_t at = has_mark ? parser->problem_mark : parser->context_mark;
    if (tab_indents(parse, at.line))
        return problem_add(parse->problems, mark_at(parse, at.line, 0),
                           "not YAML: a tab indents this line; write blanks instead");
    char context[128] = "";
    if (parser->context)
        snprintf(context, sizeof context, ", %s (line %zu)", parser->context,
                 parser->context_mark.line + 1);
    return problem_add(parse->problems, mark_at(parse, at.line, at.column), "not YAML: %s%s",
                       parser->problem ? parser->problem : "malformed", context);
}

static bool too_deep(struct problems *problems, struct mark mark)
{
    return problem_add(problems, mark, "nested deeper than %d levels", TREE_MAX_DEPTH);
}

static bool too_many_keys(struct parse *parse, struct mark mark)
{
    return problem_add(parse->problems, mark, "more than %d keys in one mapping", TREE_MAX_KEYS);
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
    struct tree_node *node = tree_new(tree, from->kind, from->mark);
    if (!node)
        return problem_no_memory(parse->problems);
    node->quoted = from->quoted;
    node->text = from->text;
    for (size_t i = 0; i < from->count; i++) {
        struct tree_node *item;
        if (!copy_node(parse, from->item[i], depth + 1, alias, &item))
            return false;
        if (!tree_append(tree, node, from->kind == TREE_MAP ? &from->key[i] : NULL, item))
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
        tree_copy(parse->tree, (const char *)anchor, strlen((const char *)anchor));
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
    *text = tree_copy(parse->tree, value, length);
    if (!*text)
        return problem_no_memory(parse->problems);
    return true;
}

static bool read_node(struct parse *parse, int depth, struct tree_node **out);

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
        if (!tree_append(parse->tree, node, NULL, item))
            return problem_no_memory(parse->problems);
    }
}

/* `<<`: the keys of a mapping, or of several, the first one's first, that are not in the file. */
static bool merge(struct parse *parse, struct tree_node *node, const struct tree_node *from)
{
    const bool several = from->kind == TREE_LIST;
    for (size_t k = 0; k < (several ? from->count : 1); k++) {
        const struct tree_node *const map = several ? from->item[k] : from;
        size_t at;
        if (map->kind != TREE_MAP)
            return problem_add(parse->problems, from->mark,
                               "<< takes a mapping, or a list of mappings, such as *NAME");
        for (size_t i = 0; i < map->count; i++) {
            if (tree_place(node, map->key[i].name, &at))
                continue;
            if (node->count == TREE_MAX_KEYS)
                return too_many_keys(parse, map->key[i].mark);
            if (!tree_append(parse->tree, node, &map->key[i], map->item[i]))
                return problem_no_memory(parse->problems);
        }
    }
    return true;
}

static bool read_map(struct parse *parse, int depth, struct tree_node *node)
{
    struct tree_node *merged = NULL;
    for (;;) {
        struct tree_key key;
        struct tree_node *item;
        size_t first;
        char word[SHOWN_SIZE];
        if (!next(parse))
            return false;
        if (parse->event.type == YAML_MAPPING_END_EVENT)
            return !merged || merge(parse, node, merged);
        key.mark = event_mark(parse);
        if (parse->event.type != YAML_SCALAR_EVENT || parse->event.data.scalar.tag)
            return problem_add(parse->problems, key.mark, "a key must be a plain word");
        if (node->count == TREE_MAX_KEYS)
            return too_many_keys(parse, key.mark);
        const bool merges = parse->event.data.scalar.style == YAML_PLAIN_SCALAR_STYLE &&
                            strcmp((const char *)parse->event.data.scalar.value, "<<") == 0;
        if (!read_text(parse, &key.name))
            return false;
        if (!next(parse) || !read_node(parse, depth + 1, &item))
            return false;
        if (merges && !merged)
            merged = item;
        else if (merges)
            problem_add(parse->problems, key.mark, "duplicate key '<<'; write <<: [*A, *B]");
        else if (tree_place(node, key.name, &first)) {
            problem_add(parse->problems, key.mark, "duplicate key '%s' (first in line %d)",
                        shown(word, key.name), node->key[first].mark.line);
        } else if (!tree_append(parse->tree, node, &key, item)) {
            return problem_no_memory(parse->problems);
        }
    }
}

/* The node that begins with the present event; leaves its last event in place. */
static bool read_node(struct parse *parse, int depth, struct tree_node **out)
{
    const yaml_event_t *const event = &parse->event;
    const bool scalar = event->type == YAML_SCALAR_EVENT,
               list = event->type == YAML_SEQUENCE_START_EVENT;
    const struct mark mark = event_mark(parse);
    size_t index;

    if (depth > TREE_MAX_DEPTH)
        return too_deep(parse->problems, mark);
    if (event->type == YAML_ALIAS_EVENT)
        return read_alias(parse, depth, out);
    const yaml_char_t *const anchor = scalar ? event->data.scalar.anchor
                                      : list ? event->data.sequence_start.anchor
                                             : event->data.mapping_start.anchor;
    const yaml_char_t *const tag = scalar ? event->data.scalar.tag
                                   : list ? event->data.sequence_start.tag
                                          : event->data.mapping_start.tag;
    struct tree_node *const node = tree_new(parse->tree,
                                            scalar ? TREE_SCALAR
                                            : list ? TREE_LIST
                                                   : TREE_MAP,
                                            mark);
    *out = node;
    if (!node)
        return problem_no_memory(parse->problems);
    node->quoted = scalar && event->data.scalar.style != YAML_PLAIN_SCALAR_STYLE;
    if (!read_properties(parse, anchor, tag, &index) || !(scalar ? read_text(parse, &node->text)
                                                          : list ? read_list(parse, depth, node)
                                                                 : read_map(parse, depth, node)))
        return false;
    if (index != SIZE_MAX)
        parse->anchor[index].node = node;
    return true;
}

static bool read_document(struct parse *parse, struct tree_node **root)
{
    if (!next(parse) || !next(parse)) /* start of the stream, then of the document */
        return false;
    if (parse->event.type == YAML_STREAM_END_EVENT) {
        if (parse->set > 0) { /* --set a= : nothing, as in "a:" */
            *root = tree_new(parse->tree, TREE_SCALAR, (struct mark){parse->set, 1, 1});
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

/* One attempt; false, without a problem: another is to follow, with one more blank. */
static bool attempt(struct tree *tree, const char *text, size_t length, int set, struct bare *bare,
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
    parse->bare = bare;
    yaml_parser_set_encoding(&parse->parser, YAML_UTF8_ENCODING);
    yaml_parser_set_input_string(&parse->parser, (const unsigned char *)text, length);
    bool good = read_document(parse, root);
    yaml_event_delete(&parse->event);
    yaml_parser_delete(&parse->parser);
    free(parse);
    return good;
}

bool tree_read(struct tree *tree, const char *text, size_t length, int set,
               struct problems *problems, struct tree_node **root)
{
    struct bare bare = {0};
    const size_t before = problems->count, copied = tree->copied;
    bool good = false;
    for (size_t tried = 0; tried <= bare.count && !good && problems->count == before; tried++) {
        const char *const given = bare.text ? bare.text : text;
        tree->copied = copied;
        good = attempt(tree, given, length + bare.count, set, &bare, problems, root);
    }
    free(bare.text);
    return good;
}
