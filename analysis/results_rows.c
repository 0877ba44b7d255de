/* results_rows.c - reads hyperslabs that are consecutive rows. */
#include "results_rows.h"

#include <hdf5.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static bool failed(const struct results *r, const char *what, stance_message *message)
{
    H5Eclear2(H5E_DEFAULT);
    snprintf(message->text, sizeof message->text, "%.100s: damaged: cannot read %.80s", r->file,
             what);
    return false;
}

/* The attribute flag_meanings of fixed length, as this program writes it; NULL: none. */
static char *read_words(hid_t dataset)
{
    enum { MOST = 4096 };
    if (H5Aexists(dataset, "flag_meanings") <= 0) {
        return NULL;
    }
    hid_t attribute = H5Aopen(dataset, "flag_meanings", H5P_DEFAULT);
    hid_t type = H5Aget_type(attribute);
    char *text = NULL;
    if (H5Tget_class(type) == H5T_STRING && H5Tis_variable_str(type) == 0 &&
        H5Tget_size(type) <= MOST) {
        text = calloc(H5Tget_size(type) + 1, 1);
        if (text && H5Aread(attribute, type, text) < 0) {
            free(text);
            text = NULL;
        }
    }
    H5Tclose(type);
    H5Aclose(attribute);
    if (text) {
        results_clean(text);
    }
    return text;
}

bool results_column_open(const struct results *r, const char *name, struct results_column *column,
                         stance_message *message)
{
    hsize_t length[H5S_MAX_RANK] = {0};
    *column = (struct results_column){.id = -1};
    snprintf(column->name, sizeof column->name, "%s", name);
    if (H5Lexists((hid_t)r->id, name, H5P_DEFAULT) <= 0) {
        return true;
    }
    hid_t dataset = H5Dopen2((hid_t)r->id, name, H5P_DEFAULT), space = H5Dget_space(dataset),
          type = H5Dget_type(dataset);
    const int rank = space < 0 ? -1 : H5Sget_simple_extent_dims(space, length, NULL);
    const H5T_class_t class = type < 0 ? H5T_NO_CLASS : H5Tget_class(type);
    bool good =
        (rank == r->axes || rank == r->axes + 1) && (class == H5T_INTEGER || class == H5T_FLOAT);
    for (int a = 0; good && a < r->axes; a++) {
        good = length[a] == r->axis[a].count;
    }
    column->width = good && rank > r->axes ? (size_t)length[rank - 1] : 1;
    good = good && column->width <= SCENARIO_MAX_STATES;
    H5Sclose(space);
    H5Tclose(type);
    column->id = dataset;
    if (!good) {
        results_column_close(column);
        return failed(r, name, message);
    }
    column->words = read_words(dataset);
    return true;
}

void results_column_close(struct results_column *column)
{
    if (column->id >= 0) {
        H5Dclose((hid_t)column->id);
    }
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
    while (a > 0 && first % (*inner * r->axis[a].count) == 0 && *inner * r->axis[a].count <= most) {
        *inner *= r->axis[a--].count;
    }
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
    return good || failed(r, column->name, message);
}
