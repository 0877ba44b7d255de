/* store_select.c - which elements of a variable are those of some rows. */
#include "store_private.h"

#include <stdlib.h>
#include <string.h>

bool store_select_range(hid_t space, int rank, const hsize_t *length, int level, hsize_t *start,
                        hsize_t first, hsize_t last)
{
    hsize_t inner = 1, count[H5S_MAX_RANK];
    for (int d = level + 1; d < rank; d++)
        inner *= length[d];
    hsize_t whole = (first + inner - 1) / inner, end = last / inner;
    if (whole > end) { /* within one row */
        start[level] = end;
        return store_select_range(space, rank, length, level + 1, start, first - end * inner,
                                  last - end * inner);
    }
    if (first < whole * inner) {
        start[level] = whole - 1;
        if (!store_select_range(space, rank, length, level + 1, start, first - (whole - 1) * inner,
                                inner))
            return false;
    }
    if (whole < end) {
        start[level] = whole;
        for (int d = 0; d < rank; d++) {
            count[d] = d < level ? 1 : d == level ? end - whole : length[d];
            start[d] = d <= level ? start[d] : 0;
        }
        if (H5Sselect_hyperslab(space, H5S_SELECT_OR, start, NULL, count, NULL) < 0)
            return false;
    }
    if (end * inner < last) {
        start[level] = end;
        return store_select_range(space, rank, length, level + 1, start, 0, last - end * inner);
    }
    return true;
}

/* Selects `width` elements of each row of a list, one by one. */
static bool select_list(hid_t space, int rank, const hsize_t *length, size_t width,
                        const struct rows *rows)
{
    const size_t elements = (size_t)rows->count * width;
    hsize_t *place = malloc(elements * (size_t)rank * sizeof *place), *at = place;
    for (size_t i = 0; place && i < elements; i++, at += rank) {
        uint64_t rest = rows_at(rows, i / width) * width + i % width;
        for (int d = rank - 1; d >= 0; d--) {
            at[d] = rest % length[d];
            rest /= length[d];
        }
    }
    bool good = place && H5Sselect_elements(space, H5S_SELECT_SET, elements, place) >= 0;
    free(place);
    return good;
}

hid_t store_select_rows(int dimensions, const hsize_t *lengths, size_t width,
                        const struct rows *rows)
{
    hsize_t length[SCENARIO_MAX_AXES + 1], start[SCENARIO_MAX_AXES + 1] = {0};
    const int rank = dimensions + (width > 1);
    const uint64_t first = rows_at(rows, 0), last = rows_at(rows, rows->count - 1);
    memcpy(length, lengths, (size_t)dimensions * sizeof *length);
    length[dimensions] = width;
    hid_t space = H5Screate_simple(rank, length, NULL);
    bool good = space >= 0;
    if (good && last - first + 1 == rows->count) {
        good = H5Sselect_none(space) >= 0 &&
               store_select_range(space, rank, length, 0, start, first * width, (last + 1) * width);
    } else if (good) {
        good = select_list(space, rank, length, width, rows);
    }
    if (!good) {
        H5Sclose(space);
        return -1;
    }
    return space;
}
