/* numbers.c - see numbers.h. */
#include "numbers.h"

#include <stdlib.h>

static int ascending(const void *left, const void *right)
{
    const uint64_t a = *(const uint64_t *)left, b = *(const uint64_t *)right;
    return (a > b) - (a < b);
}

size_t numbers_unite(uint64_t *number, size_t count)
{
    size_t unique = 0;
    if (count > 0)
        qsort(number, count, sizeof *number, ascending);
    for (size_t i = 0; i < count; i++)
        if (i == 0 || number[i] != number[unique - 1])
            number[unique++] = number[i];
    return unique;
}

size_t numbers_find(const uint64_t *number, size_t count, uint64_t wanted)
{
    size_t low = 0, high = count;
    while (low < high) {
        const size_t middle = low + (high - low) / 2;
        if (number[middle] < wanted)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}
