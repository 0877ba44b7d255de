/* page_wire.c - a scenario as text that a page reads without a YAML library: its tree, node by node
 * (analysis/view/wasm/wire.c says how). */
#include "page_data.h"

#include "runner/scenario/tree.h"

#include <stdlib.h>
#include <string.h>

static void put_node(FILE *out, const struct tree_node *node)
{
    static const char kind[] = {[TREE_SCALAR] = 's', [TREE_LIST] = 'l', [TREE_MAP] = 'm'};
    if (node->kind == TREE_SCALAR) {
        fprintf(out, "%c%zu:%s", node->quoted ? 'q' : 's', strlen(node->text), node->text);
        return;
    }
    fprintf(out, "%c%zu:", kind[node->kind], node->count);
    for (size_t i = 0; i < node->count; i++) {
        if (node->kind == TREE_MAP)
            fprintf(out, "%zu:%s", strlen(node->key[i].name), node->key[i].name);
        put_node(out, node->item[i]);
    }
}

char *page_wire(const char *scenario)
{
    struct tree tree = {0};
    struct problems *const problems = calloc(1, sizeof *problems);
    char *text = NULL;
    size_t size;
    const bool good = problems && tree_parse(&tree, scenario, strlen(scenario), problems);
    FILE *const out = good ? open_memstream(&text, &size) : NULL;
    if (out) {
        put_node(out, tree.root);
        if (fclose(out) != 0) {
            free(text);
            text = NULL;
        }
    }
    tree_free(&tree);
    free(problems);
    return text;
}
