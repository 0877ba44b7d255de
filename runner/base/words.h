/* words.h - the nearest known word to a misspelt one; letters. */
#ifndef STANCE_BASE_WORDS_H
#define STANCE_BASE_WORDS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

/* Which of known[count] a word is; `count`: none. */
size_t word_place(const char *word, const char *const *known, size_t count);

/* The known word nearest to `word` (Damerau-Levenshtein, at most 2 edits or a third of its
 * length, one where it has three letters or less), or NULL. */
const char *nearest_word(const char *word, const char *const *known, size_t count);

/* Decodes one letter of UTF-8 of at most `left` bytes; returns its length, 0 when it is malformed.
 */
size_t utf8_letter(const char *text, size_t left, uint32_t *character);

/* What a letter that cannot be seen, or not told from a blank, is called; NULL: it is seen.
 * `blank`: it takes room as a blank does. */
const char *hidden_letter(uint32_t character, bool *blank);

/* Fills lines of at most `margin` letters with words, from a column on, others than the first from
 * `indent` on; returns where the last one ends. */
size_t words_fill(FILE *out, const char *text, size_t length, size_t column, size_t indent,
                  size_t margin);

/* Adds to a text that grows in a buffer of `size`, as far as there is room. */
__attribute__((format(printf, 3, 4))) void words_add(char *text, size_t size, const char *format,
                                                     ...);

#endif
