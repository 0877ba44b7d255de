/* results_rows.h - answers of some rows at a time, for tables of files of any length. */
#ifndef STANCE_STORE_RESULTS_ROWS_H
#define STANCE_STORE_RESULTS_ROWS_H

#include "results.h"

/* A variable over the cases, open. */
struct results_column {
    char name[96];
    int64_t id;   /* HDF5 identifier */
    size_t width; /* numbers per case: 1, or the length of a last dimension of its own */
    char *words;  /* flag_meanings, separated by blanks; NULL: none */
};

/* False with one line in *message; a variable that is not stored gives id < 0 and true. */
bool results_column_open(const struct results *r, const char *name, struct results_column *column,
                         stance_message *message);
void results_column_close(struct results_column *column);

/* Reads rows from `first` on, values[rows * width], whatever the status of the cases. */
bool results_column_read(const struct results *r, const struct results_column *column,
                         uint64_t first, size_t rows, double *values, stance_message *message);

#endif
