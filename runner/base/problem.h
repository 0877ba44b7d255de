/* problem.h - errors of a scenario, collected while it is read and printed in order of position. */
#ifndef STANCE_BASE_PROBLEM_H
#define STANCE_BASE_PROBLEM_H

#include "message.h"

#include <stddef.h>

/* Where something stands. `set` 0: in the file, at line and column (from 1, in characters);
 * k > 0: in the k-th --set, where the position means nothing. */
struct mark {
    int set, line, column;
};

/* Which is first in order: below 0, 0 (the same place), above 0. */
static inline int mark_compare(struct mark a, struct mark b)
{
    return a.set != b.set     ? a.set - b.set
           : a.line != b.line ? a.line - b.line
                              : a.column - b.column;
}

enum {
    PROBLEMS_SHOWN = 20, /* lines that are printed; the rest is counted */
    PROBLEMS_KEPT = 40,
    PROBLEM_TEXT = 700,
    SHOWN_SIZE = 64,
};

struct problem {
    struct mark mark;
    size_t order;
    char text[PROBLEM_TEXT];
};

struct problems {
    size_t count, lost; /* kept; not kept because there were too many */
    struct problem list[PROBLEMS_KEPT];
};

/* Adds one line (problems, mark, format, ...); what is said twice of the same place is kept once.
 * Returns false. */
#define problem_add(...) (problem_record(__VA_ARGS__), as_false())
void problem_record(struct problems *problems, struct mark mark, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
static inline bool problem_no_memory(struct problems *problems)
{
    return problem_add(problems, (struct mark){0}, "out of memory");
}

/* No more is kept: hints, which take time to find, need not be looked for. */
static inline bool problems_full(const struct problems *problems)
{
    return problems->count >= PROBLEMS_KEPT;
}

/* Sorts and prints: those of the file by position, then those of each --set (`sets`, PATH=VALUE).
 */
void problems_print(struct problems *problems, const char *file, const char *const *sets,
                    FILE *out);

/* Text from a file made fit for a one-line message: cut to some 40 characters, control characters
 * shown as '?', others that cannot be seen as <U+200B>. Returns `buffer`. */
const char *shown(char buffer[SHOWN_SIZE], const char *text);

/* `count` words with a separator between them; of those that do not fit, how many more there are.
 * Returns `buffer`. */
const char *words_join(char *buffer, size_t size, const char *separator, const char *const *words,
                       size_t count);
/* "a, b, c". */
static inline const char *word_list(char *buffer, size_t size, const char *const *words,
                                    size_t count)
{
    return words_join(buffer, size, ", ", words, count);
}

#endif
