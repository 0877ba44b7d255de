/* compare_values.c - elements read from a file in the widest type of their kind. */
#include "compare_values.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum value_kind value_kind_of(hid_t type)
{
    switch (H5Tget_class(type)) {
    case H5T_FLOAT:
        return H5Tget_size(type) <= sizeof(double) ? VALUE_REAL : VALUE_OTHER;
    case H5T_INTEGER:
        return H5Tget_size(type) > sizeof(int64_t) ? VALUE_OTHER
               : H5Tget_sign(type) == H5T_SGN_NONE ? VALUE_NATURAL
                                                   : VALUE_INTEGER;
    case H5T_STRING:
        return VALUE_TEXT;
    default:
        return VALUE_OTHER;
    }
}

static uint64_t bits_of(double number)
{
    uint64_t bits;
    memcpy(&bits, &number, sizeof bits);
    return bits;
}

void values_free(struct values *values)
{
    if (values->kind == VALUE_TEXT)
        hdf_free_words(values->data.text, values->count);
    else
        free(values->data.any);
    values->data.any = NULL;
}

bool values_read(hid_t object, hsize_t at, hid_t type, size_t count, struct values *values)
{
    *values = (struct values){.kind = value_kind_of(type), .count = count};
    if (values->kind == VALUE_OTHER)
        return true;
    if (values->kind == VALUE_TEXT) {
        values->data.text = hdf_words(object, at, count);
        return values->data.text != NULL;
    }
    const hid_t native = values->kind == VALUE_REAL      ? H5T_NATIVE_DOUBLE
                         : values->kind == VALUE_INTEGER ? H5T_NATIVE_INT64
                                                         : H5T_NATIVE_UINT64;
    values->data.any = malloc(count * sizeof(double) + 1);
    const bool good =
        values->data.any && hdf_move(object, native, at, count, HDF_READ, values->data.any);
    if (!good)
        values_free(values);
    return good;
}

bool values_same(const struct values *a, const struct values *b, size_t i)
{
    switch (a->kind) {
    case VALUE_REAL: /* of NANs alone the bits do not matter; 0 and -0 differ */
        return bits_of(a->data.real[i]) == bits_of(b->data.real[i]) ||
               (isnan(a->data.real[i]) && isnan(b->data.real[i]));
    case VALUE_TEXT:
        return strcmp(a->data.text[i], b->data.text[i]) == 0;
    case VALUE_INTEGER:
    case VALUE_NATURAL:
        return a->data.natural[i] == b->data.natural[i];
    default:
        return true;
    }
}

/* The beginning of a text in quotation marks, in whole letters; damaged bytes are no letters. */
void values_quote(const char *before, const char *letters, char text[COMPARE_TEXT])
{
    enum { SHOWN = 60 };
    int shown = 0;
    while (letters[shown]) {
        int length = results_letter(letters + shown);
        length = length > 0 ? length : 1;
        if (shown + length > SHOWN)
            break;
        shown += length;
    }
    snprintf(text, COMPARE_TEXT, "%s'%.*s'", before, shown, letters);
    results_clean(text);
}

void values_text(const struct values *values, size_t i, char text[COMPARE_TEXT])
{
    switch (values->kind) {
    case VALUE_REAL:
        snprintf(text, COMPARE_TEXT, "%.17g", values->data.real[i]);
        break;
    case VALUE_INTEGER:
        snprintf(text, COMPARE_TEXT, "%lld", (long long)values->data.integer[i]);
        break;
    case VALUE_NATURAL:
        snprintf(text, COMPARE_TEXT, "%llu", (unsigned long long)values->data.natural[i]);
        break;
    default:
        values_quote("", values->data.text[i], text);
    }
}
