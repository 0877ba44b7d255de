/* mend.h - what was probably meant by text that cannot be read: what to write instead. */
#ifndef STANCE_SCENARIO_MEND_H
#define STANCE_SCENARIO_MEND_H

#include <stdbool.h>
#include <stddef.h>

enum { MEND_SIZE = 240 };

/* The known word that was meant: the nearest, or what other programs call it ("dt", "mu"), or its
 * parts in another order. NULL: none. */
const char *mend_word(const char *word, const char *const *known, size_t count);

/* The known path that ends in most of the names in which `path` ends; NULL: none, or several. */
const char *mend_path(const char *path, const char *const *known, size_t count);

/* "friction=0.8", "friction 0.8", "friction:0.8": as a key and its value, "friction: 0.8". The name
 * goes to name[size]. False: it is nothing of the kind. */
bool mend_pair(const char *text, char *name, size_t size, char out[MEND_SIZE]);

/* The number in `unit` that was meant by "0,8", "535 mm", "80%", "1/2" and the like. */
bool mend_number(const char *text, const char *unit, char out[MEND_SIZE]);

#endif
