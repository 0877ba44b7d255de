/* results_rows.c - see results_rows.h. */
#include "results_rows.h"
#include "results_private.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

bool results_column_open(const struct results *r, const char *name, struct results_column *column,
                         stance_message *message)
{
    *column = (struct results_column){.id = -1};
    snprintf(column->name, sizeof column->name, "%s", name);
    const struct results_variable v = results_variable(r, name);
    if (v.id < 0)
        return !hdf_exists((hid_t)r->id, name) || results_failed(r, name, message);
    bool good = (v.rank == r->axes || v.rank == r->axes + 1) && v.number;
    for (int a = 0; good && a < r->axes; a++)
        good = v.length[a] == r->axis[a].count;
    column->width = good && v.rank > r->axes ? (size_t)v.length[v.rank - 1] : 1;
    good = good && column->width <= SCENARIO_MAX_STATES;
    column->id = v.id;
    if (!good) {
        results_column_close(column);
        return results_failed(r, name, message);
    }
    column->words = hdf_text(v.id, "flag_meanings");
    if (column->words)
        results_clean(column->words);
    return true;
}

void results_column_close(struct results_column *column)
{
    if (column->id >= 0)
        hdf_close((hid_t)column->id);
    free(column->words);
    column->id = -1;
    column->words = NULL;
}

bool results_column_read(const struct results *r, const struct results_column *column,
                         uint64_t first, size_t rows, double *values, stance_message *message)
{
    const size_t n = rows * column->width;
    if (!hdf_move((hid_t)column->id, hdf_type(KIND_double), first * column->width, n, HDF_READ,
                  values))
        return results_failed(r, column->name, message);
    results_no_counts(values, n);
    return true;
}
