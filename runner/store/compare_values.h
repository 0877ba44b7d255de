/* compare_values.h - elements of variables and attributes in memory, for comparing; shared by the
 * modules of `stance compare`. */
#ifndef STANCE_STORE_COMPARE_VALUES_H
#define STANCE_STORE_COMPARE_VALUES_H

#include "compare.h"
#include "hdf.h"

/* Elements of a variable or an attribute in memory. */
enum value_kind { VALUE_REAL, VALUE_INTEGER, VALUE_NATURAL, VALUE_TEXT, VALUE_OTHER };

struct values {
    enum value_kind kind;
    size_t count;
    union {
        double *real;
        int64_t *integer;
        uint64_t *natural;
        char **text;
        void *any;
    } data;
};

enum value_kind value_kind_of(hid_t type);
/* Reads elements [at, at + count) of a dataset, or the `count` ones of an attribute. Those of
 * VALUE_OTHER are left. False: nothing is left allocated. */
bool values_read(hid_t object, hsize_t at, hid_t type, size_t count, struct values *values);
void values_free(struct values *values);

/* To the bit, but for NANs. Both are of the same kind. */
bool values_same(const struct values *a, const struct values *b, size_t i);
/* An element for people. */
void values_text(const struct values *values, size_t i, char text[COMPARE_TEXT]);
/* The beginning of a text in quotation marks after `before`, in whole letters; damaged bytes are
 * no letters. */
void values_quote(const char *before, const char *letters, char text[COMPARE_TEXT]);

#endif
