/* field.h - one value of a scenario: read from a node, checked against its row of the schema.
 *
 * Every function adds one problem, which begins with the path `name`, and returns false when the
 * value is not good.
 */
#ifndef STANCE_SCENARIO_FIELD_H
#define STANCE_SCENARIO_FIELD_H

#include "schema.h"
#include "tree.h"

#include "runner/base/problem.h"

/* Numbers are YAML 1.2's decimal ones: no quotes, no octal or hexadecimal, no digit groups, no
 * leading zeros, no .inf or .nan. False: `text` is none (*finite false: it is too large). */
bool number_parse(const char *text, double *value, bool *finite);

/* A number within the range of the field; a whole one is exact below 2^53. The word `none` stands
 * for INFINITY where allowed. */
bool field_number(struct problems *problems, const struct scenario_field *field, const char *name,
                  const struct tree_node *node, double *value);

/* 0 ... 2^63 - 1. */
bool field_seed(struct problems *problems, const char *name, const struct tree_node *node,
                uint64_t *value);

/* Place of a word among those of the field. */
bool field_word(struct problems *problems, const struct scenario_field *field, const char *name,
                const struct tree_node *node, int *place);

/* Whichever of a number and a word the field is. */
bool field_value(struct problems *problems, const struct scenario_field *field, const char *name,
                 const struct tree_node *node, double *value);

/* A list of different words as a bit mask. */
bool field_words(struct problems *problems, const struct scenario_field *field, const char *name,
                 const struct tree_node *node, uint64_t *mask);

/* One line of text of less than `size` bytes. */
bool field_text(struct problems *problems, const char *name, const struct tree_node *node,
                char *text, size_t size);

/* RE, or RE+IMi, RE-IMi; re within the range of the field. */
bool field_pole(struct problems *problems, const struct scenario_field *field, const char *name,
                const struct tree_node *node, double *re, double *im);

/* Whether a number that was read elsewhere is one that the field admits; `what` is its text. */
bool field_admits(struct problems *problems, const struct scenario_field *field, const char *name,
                  const char *what, struct mark mark, double value);

/* "NAME: expected WANTED, found ...". Returns false. */
bool field_mismatch(struct problems *problems, const char *name, const char *wanted,
                    const struct tree_node *node);

/* A list of that many items; `what` they are. */
bool field_items(struct problems *problems, const char *name, const struct tree_node *node,
                 size_t items, const char *what);

/* A non-empty list of at most so many `what`, 0: of any number. */
bool field_list(struct problems *problems, const char *name, const char *wanted,
                const struct tree_node *node, size_t most, const char *what);

/* "NAME: unknown WHAT 'WORD'; did you mean 'NEAR'? (known: ...)"; `name` may be empty. Returns
 * false. */
bool field_unknown(struct problems *problems, const char *name, const char *what, const char *word,
                   struct mark mark, const char *const *known, size_t count);

#endif
