/* tree.c - nodes, found and edited by paths.
 *
 * Everything that lives as long as the tree comes from one chain of blocks, so that no error path
 * has anything to release.
 */
#include "tree.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

/* ---- memory ---------------------------------------------------------------------------------- */

enum { BLOCK_BYTES = 1 << 16 };

struct tree_block {
    struct tree_block *next;
    size_t used, size;
    max_align_t data[];
};

void *tree_allocate(struct tree *tree, size_t size)
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

char *tree_copy(struct tree *tree, const char *text, size_t length)
{
    char *copy = tree_allocate(tree, length + 1);
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

struct tree_node *tree_new(struct tree *tree, enum tree_kind kind, struct mark mark)
{
    struct tree_node *node = tree_allocate(tree, sizeof *node);
    if (node) {
        node->kind = kind;
        node->mark = mark;
    }
    return node;
}

/* Appends to a list, or, with a key, to a mapping. */
bool tree_append(struct tree *tree, struct tree_node *parent, const struct tree_key *key,
                 struct tree_node *item)
{
    if (parent->count == parent->room) {
        size_t room = parent->room ? 2 * parent->room : 8;
        struct tree_node **items = tree_allocate(tree, room * sizeof(void *));
        struct tree_key *keys = key ? tree_allocate(tree, room * sizeof *keys) : NULL;
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

struct tree_node **tree_place(const struct tree_node *map, const char *key, size_t *index)
{
    for (size_t i = 0; map && map->kind == TREE_MAP && map->item && i < map->count; i++) {
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
    struct tree_node **place = tree_place(map, key, &index);
    return place ? *place : NULL;
}

bool tree_parse(struct tree *tree, const char *text, size_t length, struct problems *problems)
{
    static const char byte_order_mark[] = "\xef\xbb\xbf";
    if (length >= 3 && memcmp(text, byte_order_mark, 3) == 0) {
        text += 3;
        length -= 3;
    }
    if (!tree_read(tree, text, length, 0, problems, &tree->root))
        return false;
    struct tree_node *const root = tree->root;
    size_t kept = 0;
    for (size_t i = 0; root->kind == TREE_MAP && i < root->count; i++) {
        if (strncmp(root->key[i].name, "x-", 2) == 0)
            continue; /* it holds what aliases stand for */
        root->key[kept] = root->key[i];
        root->item[kept++] = root->item[i];
    }
    if (root->kind == TREE_MAP)
        root->count = kept;
    return true;
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
    struct tree_node *item = tree_new(tree, TREE_SCALAR, mark);
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
        if (tree_append(tree, node, NULL, item))
            return &node->item[index];
    } else {
        struct tree_node **at = tree_place(node, name, &found);
        if (at)
            return at;
        key.name = tree_copy(tree, name, strlen(name));
        if (key.name && tree_append(tree, node, &key, item))
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
    char *path = tree_copy(tree, path_and_value, (size_t)(equals - path_and_value));
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
    if (!tree_read(tree, equals + 1, length, set, problems, &value))
        return false;
    struct tree_node **place = &tree->root;
    char name[TREE_MAX_NAME], so_far[SHOWN_SIZE], *from = path;
    const char *at = path;
    size_t index;
    for (bool first = true; *at; first = false) {
        char *prefix = tree_copy(tree, from, (size_t)(at - from));
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
