/* words.h - the nearest known word to a misspelt one. */
#ifndef STANCE_BASE_WORDS_H
#define STANCE_BASE_WORDS_H

#include <stddef.h>

/* The known word nearest to `word` (Damerau-Levenshtein, at most 2 edits or a third of its
 * length), or NULL. */
const char *nearest_word(const char *word, const char *const *known, size_t count);

#endif
