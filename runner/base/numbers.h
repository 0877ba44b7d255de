/* numbers.h - lists of whole numbers. */
#ifndef STANCE_BASE_NUMBERS_H
#define STANCE_BASE_NUMBERS_H

#include <stddef.h>
#include <stdint.h>

/* Sorts, and drops what is there twice; returns how many are left. */
size_t numbers_unite(uint64_t *number, size_t count);
/* Place of the first that is not less, in a sorted list; count: there is none. */
size_t numbers_find(const uint64_t *number, size_t count, uint64_t wanted);

#endif
