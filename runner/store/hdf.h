/* hdf.h - what this room asks of HDF5, every handle closed: types, files to read, texts, words,
 * numbers, ranges of elements. -1, NULL, 0 or false: HDF5 remembers why, see store_failed.
 */
#ifndef STANCE_STORE_HDF_H
#define STANCE_STORE_HDF_H

#include "engine/stance.h"
#include "runner/plan/shard.h"

#include <hdf5.h>
#include <stdbool.h>

/* Bytes in memory are bytes of the file, checksums included. */
_Static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "the file is little-endian");

enum store_kind {
    KIND_uint8_t,
    KIND_uint32_t,
    KIND_int32_t,
    KIND_int64_t,
    KIND_uint64_t,
    KIND_double,
    KIND_text /* which has no type of its own */
};
/* The type of a kind, in the file and in memory, and its bytes. */
hid_t hdf_type(enum store_kind kind);
size_t hdf_size(enum store_kind kind);

/* Closes whatever is open of these spaces, types, attributes, datasets, groups, property lists. */
#define hdf_close(...)                                                                             \
    hdf_close_all((const hid_t[]){__VA_ARGS__}, sizeof((hid_t[]){__VA_ARGS__}) / sizeof(hid_t))
void hdf_close_all(const hid_t *id, size_t count);

/* From now on HDF5 prints nothing, but remembers why a call failed. */
void hdf_remember(void);
/* "FILE: cannot WHAT: reason", with the reason that HDF5 remembers. Returns false. */
bool store_failed(stance_message *message, const char *file, const char *what);

/* Files only: to open a pipe would wait for its writer. */
hid_t hdf_open_to_read(const char *file, stance_message *message);
/* What an open file is that is not `what`: "FILE: not WHAT", or the file of a search, and what
 * reads it. Returns false. */
bool hdf_is_no(hid_t id, const char *file, const char *what, stance_message *message);
/* Every link of a path such as "trajectory/time" exists. */
bool hdf_exists(hid_t file, const char *path);

/* A text attribute of fixed or variable length, freed by the caller; NULL when there is none. */
char *hdf_text(hid_t object, const char *name);
/* An attribute that is one number. */
bool hdf_number(hid_t object, const char *name, hid_t type, void *value);
/* A positive whole number, or where there is none the fallback. */
int hdf_whole(hid_t object, const char *name, int fallback);

/* Lengths of the dimensions of a dataset or an attribute; returns how many. */
int hdf_shape(hid_t object, hsize_t length[H5S_MAX_RANK]);
/* Type of its elements, to be closed. */
hid_t hdf_type_of(hid_t object);
/* Number of elements; 0 when a damaged header claims more than the file can hold. (Variables of
 * ours are contiguous.) */
size_t hdf_elements(hid_t dataset);

/* All elements of a dataset, numbers. */
bool hdf_read(hid_t dataset, enum store_kind kind, void *data);
/* Elements [at, at + n) of a dataset in row-major order; of an attribute all its n. */
enum hdf_direction { HDF_READ, HDF_WRITE };
bool hdf_move(hid_t object, hid_t type, hsize_t at, hsize_t n, enum hdf_direction way, void *data);
/* The same of texts of fixed or variable length, each freed by the caller as is the array (by
 * hdf_free_words). */
char **hdf_words(hid_t object, hsize_t at, size_t n);
void hdf_free_words(char **words, size_t n);

/* The same of `width` elements in each of some rows, one at least, of a dataset. */
bool hdf_move_rows(hid_t dataset, hid_t type, size_t width, const struct rows *rows,
                   enum hdf_direction way, void *data);

#endif
