/* wire.c - trees of nodes from the text that a page holds them in, in place of YAML.
 *
 *   s<bytes>:<text>   a scalar        l<count>:<items>              a list
 *   q<bytes>:<text>   one in quotes   m<count>:<<bytes>:<key> item> a mapping
 *
 * Whoever wrote it had read it from YAML; nothing here trusts it all the same.
 */
#include "runner/scenario/tree.h"

#include <string.h>

struct wire {
    struct tree *tree;
    const char *at, *end;
    struct mark mark;
    struct problems *problems;
};

static bool malformed(struct wire *w)
{
    return problem_add(w->problems, w->mark, "the page's text of the scenario is damaged");
}

/* A number and the colon after it. */
static bool read_number(struct wire *w, size_t *number)
{
    const char *const first = w->at;
    *number = 0;
    for (; w->at < w->end && *w->at >= '0' && *w->at <= '9' && *number < TREE_MAX_BYTES; w->at++)
        *number = *number * 10 + (size_t)(*w->at - '0');
    return (w->at > first && w->at < w->end && *w->at++ == ':') || malformed(w);
}

static bool read_text(struct wire *w, const char **text)
{
    size_t length;
    if (!read_number(w, &length))
        return false;
    if (length > (size_t)(w->end - w->at) || memchr(w->at, '\0', length))
        return malformed(w);
    *text = tree_copy(w->tree, w->at, length);
    w->at += length;
    return *text || problem_no_memory(w->problems);
}

static bool read_node(struct wire *w, int depth, struct tree_node **out)
{
    if (w->at == w->end || depth > TREE_MAX_DEPTH)
        return malformed(w);
    const char kind = *w->at++;
    const bool scalar = kind == 's' || kind == 'q', map = kind == 'm';
    if (!scalar && !map && kind != 'l')
        return malformed(w);
    struct tree_node *const node = tree_new(w->tree,
                                            scalar ? TREE_SCALAR
                                            : map  ? TREE_MAP
                                                   : TREE_LIST,
                                            w->mark);
    if (!node)
        return problem_no_memory(w->problems);
    *out = node;
    node->quoted = kind == 'q';
    if (scalar)
        return read_text(w, &node->text);
    size_t count;
    if (!read_number(w, &count))
        return false;
    for (size_t i = 0; i < count; i++) {
        struct tree_key key = {NULL, w->mark};
        struct tree_node *item;
        if ((map && !read_text(w, &key.name)) || !read_node(w, depth + 1, &item))
            return false;
        if (!tree_append(w->tree, node, map ? &key : NULL, item))
            return problem_no_memory(w->problems);
    }
    return true;
}

bool tree_read(struct tree *tree, const char *text, size_t length, int set,
               struct problems *problems, struct tree_node **root)
{
    struct wire w = {tree, text, text + length, {set, 1, 1}, problems};
    return read_node(&w, 1, root) && (w.at == w.end || malformed(&w));
}
