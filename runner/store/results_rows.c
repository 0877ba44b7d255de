/* results_rows.c - reads hyperslabs that are consecutive rows. */
#include "results_rows.h"
#include "results_private.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

bool results_column_open(const struct results *r, const char *name, struct results_column *column,
                         stance_message *message)
{
    hsize_t length[H5S_MAX_RANK] = {0};
    *column = (struct results_column){.id = -1};
    snprintf(column->name, sizeof column->name, "%s", name);
    int rank;
    const hid_t dataset = results_dataset(r, name, &rank, length);
    if (dataset < 0)
        return !results_exists((hid_t)r->id, name) || results_failed(r, name, message);
    bool good = (rank == r->axes || rank == r->axes + 1) && results_is_number(dataset);
    for (int a = 0; good && a < r->axes; a++)
        good = length[a] == r->axis[a].count;
    column->width = good && rank > r->axes ? (size_t)length[rank - 1] : 1;
    good = good && column->width <= SCENARIO_MAX_STATES;
    column->id = dataset;
    if (!good) {
        results_column_close(column);
        return results_failed(r, name, message);
    }
    column->words = results_attribute(dataset, "flag_meanings");
    if (column->words)
        results_clean(column->words);
    return true;
}

void results_column_close(struct results_column *column)
{
    if (column->id >= 0)
        H5Dclose((hid_t)column->id);
    free(column->words);
    column->id = -1;
    column->words = NULL;
}

/* The first axis that a block extends along: those after it are covered whole. Sets the cases in
 * one step along it. */
static int block_axis(const struct results *r, uint64_t first, size_t most, uint64_t *inner)
{
    int a = r->axes - 1;
    *inner = 1;
    while (a > 0 && first % (*inner * r->axis[a].count) == 0 && *inner * r->axis[a].count <= most)
        *inner *= r->axis[a--].count;
    return a;
}

size_t results_block(const struct results *r, uint64_t first, size_t most)
{
    uint64_t inner;
    const int a = block_axis(r, first, most, &inner);
    const uint64_t left = r->axis[a].count - first / inner % r->axis[a].count;
    return (size_t)(inner * (left < most / inner ? left : most / inner));
}

bool results_column_read(const struct results *r, const struct results_column *column,
                         uint64_t first, size_t rows, double *values, stance_message *message)
{
    hsize_t start[SCENARIO_MAX_AXES + 1], count[SCENARIO_MAX_AXES + 1], n = rows * column->width;
    size_t point[SCENARIO_MAX_AXES];
    uint64_t inner;
    const int along = block_axis(r, first, rows, &inner);

    results_point(r, first, point);
    for (int a = 0; a < r->axes; a++) {
        start[a] = point[a];
        count[a] = a < along ? 1 : a == along ? rows / inner : r->axis[a].count;
    }
    start[r->axes] = 0;
    count[r->axes] = column->width;
    hid_t space = H5Dget_space((hid_t)column->id), memory = H5Screate_simple(1, &n, NULL);
    const bool good =
        H5Sselect_hyperslab(space, H5S_SELECT_SET, start, NULL, count, NULL) >= 0 &&
        H5Dread((hid_t)column->id, H5T_NATIVE_DOUBLE, memory, space, H5P_DEFAULT, values) >= 0;
    H5Sclose(space);
    H5Sclose(memory);
    return good || results_failed(r, column->name, message);
}
