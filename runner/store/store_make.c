/* store_make.c - see store_make.h. */
#include "store_make.h"

#include <stdlib.h>
#include <string.h>

enum { PIECE = 1 << 16 };

/* ---- attributes --------------------------------------------------------------------------- */

static bool put_attribute(hid_t object, const char *name, hid_t type, hid_t space,
                          const void *value)
{
    hid_t attribute = H5Acreate2(object, name, type, space, H5P_DEFAULT, H5P_DEFAULT);
    bool good = attribute >= 0 && H5Awrite(attribute, type, value) >= 0;
    hdf_close(attribute, space);
    return good;
}

bool put_text(hid_t object, const char *name, const char *text)
{
    hid_t type = H5Tcopy(H5T_C_S1);
    size_t size = text[0] ? strlen(text) : 1;
    bool good = H5Tset_size(type, size) >= 0 && H5Tset_cset(type, H5T_CSET_UTF8) >= 0 &&
                H5Tset_strpad(type, H5T_STR_NULLPAD) >= 0 &&
                put_attribute(object, name, type, H5Screate(H5S_SCALAR), text);
    hdf_close(type);
    return good;
}

bool put_number(hid_t object, const char *name, enum store_kind kind, const void *value)
{
    hsize_t one = 1;
    return put_attribute(object, name, hdf_type(kind), H5Screate_simple(1, &one, NULL), value);
}

bool put_int(hid_t object, const char *name, int value)
{
    int32_t number = value;
    return put_number(object, name, KIND_int32_t, &number);
}

bool put_meaning(hid_t object, const char *unit, const char *text)
{
    return (!unit || put_text(object, "units", unit)) &&
           (!text || !text[0] || put_text(object, "long_name", text));
}

bool put_flags(hid_t object, const char *words)
{
    uint8_t values[32];
    hsize_t n = 1;
    for (const char *c = words; *c; c++)
        n += *c == ' ';
    for (hsize_t i = 0; i < n; i++)
        values[i] = (uint8_t)i;
    return put_attribute(object, "flag_values", hdf_type(KIND_uint8_t),
                         H5Screate_simple(1, &n, NULL), values) &&
           put_text(object, "flag_meanings", words);
}

static bool put_fill(hid_t object, enum store_kind kind, double fill)
{
    const int64_t count = kind == KIND_int64_t ? (int64_t)fill : 0;
    return put_number(object, "_FillValue", kind,
                      kind == KIND_int64_t ? (const void *)&count : (const void *)&fill);
}

/* ---- groups and datasets ------------------------------------------------------------------ */

/* What is in it has the order of its making, which is netCDF's, and attributes may be long. No
 * times are kept, so that equal runs give equal bytes. The header that this takes has a checksum of
 * HDF5's own: without it a flipped bit makes variables vanish. */
static bool keep_order(hid_t properties, bool links)
{
    const unsigned order = H5P_CRT_ORDER_TRACKED | H5P_CRT_ORDER_INDEXED;
    return H5Pset_obj_track_times(properties, false) >= 0 &&
           H5Pset_attr_creation_order(properties, order) >= 0 &&
           (!links || H5Pset_link_creation_order(properties, order) >= 0);
}

hid_t store_create_hdf(const char *file)
{
    hid_t access = store_serial_access(), properties = H5Pcreate(H5P_FILE_CREATE), id = -1;
    if (access >= 0 && keep_order(properties, true))
        id = H5Fcreate(file, H5F_ACC_EXCL, properties, access);
    hdf_close(access, properties);
    return id;
}

hid_t make_group(hid_t parent, const char *name)
{
    hid_t properties = H5Pcreate(H5P_GROUP_CREATE), group = -1;
    if (keep_order(properties, true))
        group = H5Gcreate2(parent, name, H5P_DEFAULT, properties, H5P_DEFAULT);
    hdf_close(properties);
    return group;
}

/* Contiguous, its place in the file given at once; nothing is written, so that large files start
 * fast. */
hid_t make_dataset(hid_t parent, const char *name, hid_t type, int rank, const hsize_t *length)
{
    hid_t properties = H5Pcreate(H5P_DATASET_CREATE), dataset = -1;
    hid_t space = rank > 0 ? H5Screate_simple(rank, length, NULL) : H5Screate(H5S_SCALAR);
    bool string = H5Tis_variable_str(type) > 0; /* pointers need their zeros */
    if (space >= 0 && H5Pset_layout(properties, H5D_CONTIGUOUS) >= 0 &&
        H5Pset_alloc_time(properties, H5D_ALLOC_TIME_EARLY) >= 0 &&
        H5Pset_fill_time(properties, string ? H5D_FILL_TIME_ALLOC : H5D_FILL_TIME_NEVER) >= 0 &&
        keep_order(properties, false))
        dataset = H5Dcreate2(parent, name, type, space, H5P_DEFAULT, properties, H5P_DEFAULT);
    hdf_close(space, properties);
    return dataset;
}

bool attach(hid_t dataset, const struct dimension *const *dimension, int rank)
{
    for (int d = 0; d < rank; d++)
        if (H5DSattach_scale(dataset, dimension[d]->id, (unsigned)d) < 0)
            return false;
    return true;
}

hid_t make_variable(hid_t parent, const struct variable *v,
                    const struct dimension *const *dimension, int rank)
{
    hsize_t length[SCENARIO_MAX_AXES + 2];
    for (int d = 0; d < rank; d++)
        length[d] = dimension[d]->length;
    hid_t dataset = make_dataset(parent, v->name, hdf_type(v->kind), rank, length);
    if (dataset >= 0 &&
        !(put_meaning(dataset, v->flags ? NULL : v->unit, v->text) &&
          attach(dataset, dimension, rank) && (!v->filled || put_fill(dataset, v->kind, v->fill)) &&
          (!v->flags || put_flags(dataset, v->flags)))) {
        hdf_close(dataset);
        return -1;
    }
    return dataset;
}

bool put_variable(hid_t parent, const struct variable *v, const struct dimension *const *dimension,
                  int rank, const void *values)
{
    const hid_t dataset = make_variable(parent, v, dimension, rank);
    const bool good = dataset >= 0 && (!values || hdf_write(dataset, v->kind, values));
    hdf_close(dataset);
    return good;
}

/* Turns a one-dimensional dataset into a dimension. `label` is what netCDF looks at. */
bool make_scale(int *dimensions, hid_t dataset, const char *label, hsize_t length,
                struct dimension *dimension)
{
    dimension->id = dataset;
    dimension->length = length;
    return dataset >= 0 && H5DSset_scale(dataset, label) >= 0 &&
           put_int(dataset, "_Netcdf4Dimid", (*dimensions)++);
}

hid_t put_words(hid_t parent, const char *name, const char *const *words, hsize_t n)
{
    const hid_t type = H5Tcopy(H5T_C_S1);
    hid_t dataset = -1;
    if (H5Tset_size(type, H5T_VARIABLE) >= 0 && H5Tset_cset(type, H5T_CSET_UTF8) >= 0)
        dataset = make_dataset(parent, name, type, 1, &n);
    if (dataset >= 0 && H5Dwrite(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, words) < 0) {
        hdf_close(dataset);
        dataset = -1;
    }
    hdf_close(type);
    return dataset;
}

/* A dimension whose points are words. */
bool make_words(int *dimensions, hid_t parent, const char *name, const char *const *words,
                hsize_t n, struct dimension *dimension)
{
    return make_scale(dimensions, put_words(parent, name, words, n), name, n, dimension);
}

bool write_values(hid_t dataset, hsize_t n, value_function value, const void *context)
{
    double *buffer = malloc((n < PIECE ? n : PIECE) * sizeof *buffer);
    bool good = buffer != NULL;
    for (hsize_t at = 0, count; good && at < n; at += count) {
        count = n - at < PIECE ? n - at : PIECE;
        for (hsize_t i = 0; i < count; i++)
            buffer[i] = value ? value(context, at + i) : (double)(at + i);
        good = hdf_move(dataset, H5T_NATIVE_DOUBLE, at, count, HDF_WRITE, buffer);
    }
    free(buffer);
    return good;
}

/* A dimension whose points are numbers. */
bool make_numbers(int *dimensions, hid_t parent, const struct variable *v, hsize_t n,
                  value_function value, const void *context, struct dimension *dimension)
{
    hid_t dataset = make_dataset(parent, v->name, hdf_type(v->kind), 1, &n);
    return dataset >= 0 && write_values(dataset, n, value, context) &&
           make_scale(dimensions, dataset, v->name, n, dimension) &&
           put_meaning(dataset, v->unit, v->text);
}
