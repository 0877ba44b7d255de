/* tree_nodes.h - how nodes are made: for whoever reads a tree from text.
 *
 * What is returned lives as long as the tree; NULL or false: no memory.
 */
#ifndef STANCE_SCENARIO_TREE_NODES_H
#define STANCE_SCENARIO_TREE_NODES_H

#include "tree.h"

/* Zeros. */
void *tree_allocate(struct tree *tree, size_t size);
char *tree_copy(struct tree *tree, const char *text, size_t length);
struct tree_node *tree_new(struct tree *tree, enum tree_kind kind, struct mark mark);
/* Appends to a list, or, with a key, to a mapping. */
bool tree_append(struct tree *tree, struct tree_node *parent, const struct tree_key *key,
                 struct tree_node *item);
/* Where the value of a key of a mapping is, and its place there; NULL: there is none. */
struct tree_node **tree_place(const struct tree_node *map, const char *key, size_t *index);

/* Reads a text, of the scenario itself (set 0) or of the --set of that number, whose value may be
 * nothing. False: a problem. */
bool tree_read(struct tree *tree, const char *text, size_t length, int set,
               struct problems *problems, struct tree_node **root);

#endif
