/* numbers.h - whole numbers, and lists of them. */
#ifndef STANCE_BASE_NUMBERS_H
#define STANCE_BASE_NUMBERS_H

#include <stddef.h>
#include <stdint.h>

static inline size_t smaller(size_t a, size_t b)
{
    return a < b ? a : b;
}

/* Sorts, and drops what is there twice; returns how many are left. */
size_t numbers_unite(uint64_t *number, size_t count);
/* Place of the first that is not less, in a sorted list; count: there is none. */
size_t numbers_find(const uint64_t *number, size_t count, uint64_t wanted);

#endif
