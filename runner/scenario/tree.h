/* tree.h - YAML text as nodes with line and column, edited by --set, written back as YAML.
 *
 * A subset of YAML 1.2: one document of mappings, lists and scalars; aliases are copied in, within
 * limits; tags are refused. All memory of a tree is released together by tree_free.
 */
#ifndef STANCE_SCENARIO_TREE_H
#define STANCE_SCENARIO_TREE_H

#include "runner/base/problem.h"

enum tree_kind { TREE_SCALAR, TREE_LIST, TREE_MAP };

enum {
    TREE_MAX_BYTES = 1 << 20,
    TREE_MAX_DEPTH = 32,
    TREE_MAX_KEYS = 1000,     /* in one mapping */
    TREE_MAX_ANCHORS = 256,   /* in one text */
    TREE_MAX_COPIED = 100000, /* nodes made by aliases */
    TREE_MAX_NAME = 64,       /* of one step of a path */
};

struct tree_key {
    const char *name;
    struct mark mark;
};

struct tree_node {
    enum tree_kind kind;
    bool quoted;      /* a scalar in quotes or a block: text, never a number */
    bool fresh;       /* made by --set on the way to what it sets, of no kind yet */
    const char *text; /* of a scalar */
    size_t count, room;
    struct tree_node **item; /* of a list or mapping */
    struct tree_key *key;    /* of a mapping, one per item */
    struct mark mark;
};

struct tree_block;

struct tree {
    struct tree_block *blocks;
    struct tree_node *root;
    size_t copied;
};

/* Checks that `text` is UTF-8 without control characters; adds a problem and returns false. */
bool tree_check_text(const char *text, size_t length, struct problems *problems);

/* Adds of every line of such a text, in the file or in --set number `set`, the first letter that
 * cannot be seen where blanks, keys and values stand: not in quotes, in a comment or the title. */
void tree_find_hidden(const char *text, size_t length, int set, struct problems *hidden);

/* Parses `text`, already checked, into tree->root, initialised by {0}. False when there is no tree
 * to go on with; a duplicate key is a problem but leaves one. */
bool tree_parse(struct tree *tree, const char *text, size_t length, struct problems *problems);

/* Puts VALUE (YAML) at PATH; `set` (from 1) marks what came from there. Keys that are missing are
 * made; the index of a list may be one past its end. */
bool tree_set(struct tree *tree, const char *path_and_value, int set, struct problems *problems);

/* Letters, digits, '_' and '-': what names in paths consist of. */
bool tree_name_letter(char c);

/* One step of a path such as "a.b[0][1].c": *at moves past it; `name` is empty for an index.
 * False at a malformed step; a path ends where **at is zero. `first`: nothing came before. */
bool tree_path_step(const char **at, bool first, char name[TREE_MAX_NAME], size_t *index);

/* The value of a key of a mapping, or NULL, as of what is none, or NULL. */
struct tree_node *tree_find(const struct tree_node *map, const char *key);

/* The tree as YAML: the same bytes for the same nodes. Freed by the caller; NULL: no memory. */
char *tree_write(const struct tree_node *root);

void tree_free(struct tree *tree);

/* ---- how nodes are made: for whoever reads a tree from text ------------------------------------
 * What is returned lives as long as the tree; NULL or false: no memory. */

/* Zeros. */
void *tree_allocate(struct tree *tree, size_t size);
char *tree_copy(struct tree *tree, const char *text, size_t length);
struct tree_node *tree_new(struct tree *tree, enum tree_kind kind, struct mark mark);
/* Appends to a list, or, with a key, to a mapping. */
bool tree_append(struct tree *tree, struct tree_node *parent, const struct tree_key *key,
                 struct tree_node *item);
/* Where the value of a key of a mapping is, and its place there; NULL: there is none, as of NULL.
 */
struct tree_node **tree_place(const struct tree_node *map, const char *key, size_t *index);

/* Reads a text, of the scenario itself (set 0) or of the --set of that number, whose value may be
 * nothing. False: a problem. */
bool tree_read(struct tree *tree, const char *text, size_t length, int set,
               struct problems *problems, struct tree_node **root);

#endif
