/* store_make.h - what HDF5 files of ours are made of: datasets and attributes as rows that say what
 * they are, put into a file as netCDF-4 has them. After one that failed, the others are left out;
 * HDF5 remembers why.
 */
#ifndef STANCE_STORE_STORE_MAKE_H
#define STANCE_STORE_STORE_MAKE_H

#include "hdf.h"

#include "runner/scenario/scenario.h"

/* A file that is being made. */
struct maker {
    hid_t file, group; /* where datasets go: the file, or a group of it */
    int dimensions;    /* so far: the next `_Netcdf4Dimid` */
    bool failed;
};

struct dimension {
    hid_t id;
    hsize_t length;
};

/* A dataset, and what it says of itself. */
struct dataset {
    const char *name;
    enum store_kind kind;
    bool filled;             /* has `_FillValue`: NAN, of counts STANCE_NO_COUNT */
    const char *unit, *text; /* may be NULL */
    const char *flags;       /* of a code, which has no unit: CF's words for 0, 1, ..., with blanks
                              * between them, at most 32; NULL: it is none */
    const char *coordinates; /* CF's; NULL: none */
    const char *label;       /* what netCDF knows a dimension without points by */
    const void *values;      /* in its own type; NULL: those of `value`, or none yet */
    double (*value)(const void *context, uint64_t i);
    const void *context;
    hsize_t length; /* of one that is over no other; 0: it is one number */
    const struct dimension *over[SCENARIO_MAX_AXES + 3]; /* NULL after the last */
};

/* The numbers 0, 1, ... of a dimension. */
double make_place(const void *unused, uint64_t i);

/* A new file; `failed`: there is none. */
void make_file(struct maker *maker, const char *file);
/* From now on datasets go into a new group. */
void make_group(struct maker *maker, const char *name);
/* A dataset with its values; `dimension` not NULL: it becomes one. */
void make(struct maker *maker, const struct dataset *dataset, struct dimension *dimension);

struct attribute {
    const char *name;
    enum store_kind kind; /* KIND_text: value is a char * */
    const void *value;    /* NULL: it is left out */
};
bool put_attribute(hid_t object, const char *name, enum store_kind kind, const void *value);
void put_attributes(struct maker *maker, hid_t object, const struct attribute *list, size_t count);

#endif
