/* store_make.c - see store_make.h. */
#include "store_make.h"

#include "store_private.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { PIECE = 1 << 16 };

/* ---- attributes --------------------------------------------------------------------------- */

static bool put_numbers(hid_t object, const char *name, hid_t type, hid_t space, const void *value)
{
    hid_t attribute = H5Acreate2(object, name, type, space, H5P_DEFAULT, H5P_DEFAULT);
    bool good = attribute >= 0 && H5Awrite(attribute, type, value) >= 0;
    hdf_close(attribute, space);
    return good;
}

/* Of such a size, or H5T_VARIABLE. */
static hid_t text_type(size_t size)
{
    const hid_t type = H5Tcopy(H5T_C_S1);
    if (H5Tset_size(type, size) >= 0 && H5Tset_cset(type, H5T_CSET_UTF8) >= 0)
        return type;
    hdf_close(type);
    return -1;
}

bool put_attribute(hid_t object, const char *name, enum store_kind kind, const void *value)
{
    const hsize_t one = 1;
    if (!value)
        return true;
    if (kind != KIND_text)
        return put_numbers(object, name, hdf_type(kind), H5Screate_simple(1, &one, NULL), value);
    const char *const text = value;
    const hid_t type = text_type(text[0] ? strlen(text) : 1);
    const bool good = type >= 0 && H5Tset_strpad(type, H5T_STR_NULLPAD) >= 0 &&
                      put_numbers(object, name, type, H5Screate(H5S_SCALAR), text);
    hdf_close(type);
    return good;
}

void put_attributes(struct maker *m, hid_t object, const struct attribute *list, size_t count)
{
    for (size_t i = 0; i < count && !m->failed; i++)
        m->failed = !put_attribute(object, list[i].name, list[i].kind, list[i].value);
}

static bool put_flags(hid_t object, const char *words)
{
    uint8_t values[32];
    hsize_t n = 1;
    for (const char *c = words; *c; c++)
        n += *c == ' ';
    for (hsize_t i = 0; i < n; i++)
        values[i] = (uint8_t)i;
    return put_numbers(object, "flag_values", hdf_type(KIND_uint8_t), H5Screate_simple(1, &n, NULL),
                       values) &&
           put_attribute(object, "flag_meanings", KIND_text, words);
}

/* ---- files, groups, datasets -------------------------------------------------------------- */

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

void make_file(struct maker *m, const char *file)
{
    hid_t access = store_serial_access(), properties = H5Pcreate(H5P_FILE_CREATE), id = -1;
    if (access >= 0 && keep_order(properties, true))
        id = H5Fcreate(file, H5F_ACC_EXCL, properties, access);
    hdf_close(access, properties);
    *m = (struct maker){.file = id, .group = id, .failed = id < 0};
}

void make_group(struct maker *m, const char *name)
{
    if (m->failed)
        return;
    hid_t properties = H5Pcreate(H5P_GROUP_CREATE), group = -1;
    if (keep_order(properties, true))
        group = H5Gcreate2(m->file, name, H5P_DEFAULT, properties, H5P_DEFAULT);
    hdf_close(properties, m->group == m->file ? -1 : m->group);
    m->group = group;
    m->failed = group < 0;
}

/* Contiguous, its place in the file given at once; nothing is written, so that large files start
 * fast. */
static hid_t create(hid_t parent, const char *name, hid_t type, int rank, const hsize_t *length)
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

double make_place(const void *unused, uint64_t i)
{
    (void)unused;
    return (double)i;
}

static bool write_values(hid_t id, hid_t type, const struct dataset *d, hsize_t n)
{
    if (d->values)
        return H5Dwrite(id, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, d->values) >= 0;
    double *buffer = d->value ? malloc((n < PIECE ? n : PIECE) * sizeof *buffer) : NULL;
    bool good = buffer || !d->value;
    for (hsize_t at = 0, count; good && buffer && at < n; at += count) {
        count = n - at < PIECE ? n - at : PIECE;
        for (hsize_t i = 0; i < count; i++)
            buffer[i] = d->value(d->context, at + i);
        good = hdf_move(id, H5T_NATIVE_DOUBLE, at, count, HDF_WRITE, buffer);
    }
    free(buffer);
    return good;
}

static bool describe(hid_t id, const struct dataset *d)
{
    static const int64_t no_count = STANCE_NO_COUNT;
    static const double no_number = NAN;
    const void *const fill = d->kind == KIND_int64_t ? (const void *)&no_count : &no_number;
    bool good = put_attribute(id, "units", KIND_text, d->flags ? NULL : d->unit) &&
                put_attribute(id, "long_name", KIND_text, d->text && d->text[0] ? d->text : NULL);
    for (unsigned k = 0; good && d->over[k]; k++)
        good = H5DSattach_scale(id, d->over[k]->id, k) >= 0;
    return good && put_attribute(id, "_FillValue", d->kind, d->filled ? fill : NULL) &&
           (!d->flags || put_flags(id, d->flags)) &&
           put_attribute(id, "coordinates", KIND_text, d->coordinates);
}

void make(struct maker *m, const struct dataset *d, struct dimension *dimension)
{
    hsize_t length[H5S_MAX_RANK] = {d->length}, n = 1;
    int rank = 0;
    if (m->failed)
        return;
    for (; d->over[rank]; rank++)
        length[rank] = d->over[rank]->length;
    rank += rank == 0 && d->length > 0;
    for (int k = 0; k < rank; k++)
        n *= length[k];
    const hid_t type = d->kind == KIND_text
                           ? text_type(H5T_VARIABLE)
                           : H5Tcopy(d->label ? H5T_IEEE_F32BE : hdf_type(d->kind));
    const hid_t id = create(m->group, d->name, type, rank, length);
    bool good = id >= 0 && write_values(id, type, d, n);
    if (good && dimension) { /* by the label netCDF knows it */
        const int32_t number = m->dimensions++;
        good = H5DSset_scale(id, d->label ? d->label : d->name) >= 0 &&
               put_attribute(id, "_Netcdf4Dimid", KIND_int32_t, &number);
    }
    m->failed = !good || !describe(id, d);
    hdf_close(type, dimension ? -1 : id);
    if (dimension)
        *dimension = (struct dimension){id, length[0]};
}
