/* store_make.h - pieces that results files are made of: attributes, variables, dimensions, as
 * netCDF-4 has them. -1 or false: HDF5 remembers why.
 */
#ifndef STANCE_STORE_STORE_MAKE_H
#define STANCE_STORE_STORE_MAKE_H

#include "store_private.h"

struct dimension {
    hid_t id;
    hsize_t length;
};

/* ---- attributes --------------------------------------------------------------------------- */

bool put_text(hid_t object, const char *name, const char *text);
bool put_number(hid_t object, const char *name, enum store_kind kind, const void *value);
bool put_int(hid_t object, const char *name, int value);
/* `units` and `long_name`, where not NULL. */
bool put_meaning(hid_t object, const char *unit, const char *text);
/* CF's flags: the values 0 ... n - 1 and a word for each, separated by blanks; n <= 32. */
bool put_flags(hid_t object, const char *words);

/* ---- groups, variables, dimensions --------------------------------------------------------- */

hid_t make_group(hid_t parent, const char *name);
/* A variable of `rank` lengths; 0: a number. */
hid_t make_dataset(hid_t parent, const char *name, hid_t type, int rank, const hsize_t *length);
bool attach(hid_t dataset, const struct dimension *const *dimension, int rank);
/* A variable over dimensions. */
hid_t make_variable(hid_t parent, const struct variable *variable,
                    const struct dimension *const *dimension, int rank);
/* The same with its values, unless NULL, in its own type. */
bool put_variable(hid_t parent, const struct variable *variable,
                  const struct dimension *const *dimension, int rank, const void *values);
/* Turns a one-dimensional dataset into a dimension. `label` is what netCDF looks at; `dimensions`
 * counts those of the file. */
bool make_scale(int *dimensions, hid_t dataset, const char *label, hsize_t length,
                struct dimension *dimension);
/* A variable of one dimension, of words of any length; open, or -1. */
hid_t put_words(hid_t parent, const char *name, const char *const *words, hsize_t n);
/* A dimension whose points are words. */
bool make_words(int *dimensions, hid_t parent, const char *name, const char *const *words,
                hsize_t n, struct dimension *dimension);

/* Value i of a coordinate; NULL: i. */
typedef double (*value_function)(const void *context, uint64_t i);
bool write_values(hid_t dataset, hsize_t n, value_function value, const void *context);
/* A dimension whose points are numbers. */
bool make_numbers(int *dimensions, hid_t parent, const struct variable *variable, hsize_t n,
                  value_function value, const void *context, struct dimension *dimension);

#endif
