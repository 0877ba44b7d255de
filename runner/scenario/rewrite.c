/* rewrite.c - a scenario's text with some of its keys set or dropped. */
#include "reader.h"

#include <stdlib.h>
#include <string.h>

/* Drops the key at a path of mappings' keys. */
static void drop_key(struct tree_node *node, const char *path)
{
    for (;;) {
        const size_t length = strcspn(path, ".");
        size_t i = 0;
        if (!node || node->kind != TREE_MAP)
            return;
        while (i < node->count && (strlen(node->key[i].name) != length ||
                                   strncmp(node->key[i].name, path, length) != 0))
            i++;
        if (i == node->count)
            return;
        if (path[length] == '\0') {
            node->count--;
            memmove(&node->key[i], &node->key[i + 1], (node->count - i) * sizeof *node->key);
            memmove(&node->item[i], &node->item[i + 1], (node->count - i) * sizeof(void *));
            return;
        }
        node = node->item[i];
        path += length + 1;
    }
}

char *scenario_rewrite(const char *text, const char *const *drop, size_t drops,
                       const char *const *set, size_t sets)
{
    struct tree tree = {0};
    struct problems *problems = calloc(1, sizeof *problems);
    char *result = NULL;
    bool good = problems && tree_parse(&tree, text, strlen(text), problems);
    for (size_t i = 0; good && i < drops; i++)
        drop_key(tree.root, drop[i]);
    for (size_t i = 0; good && i < sets; i++)
        good = tree_set(&tree, set[i], (int)i + 1, problems);
    if (good)
        result = tree_write(tree.root);
    tree_free(&tree);
    free(problems);
    return result;
}
