/* results_private.h - how results files are read, shared by results.c (what is in all of them),
 * results_sample.c (values of a sample), results_trajectory.c and compare.c.
 */
#ifndef STANCE_STORE_RESULTS_PRIVATE_H
#define STANCE_STORE_RESULTS_PRIVATE_H

#include "hdf.h"
#include "results.h"

/* A variable, open: -1 when it does not exist or is none. */
struct results_variable {
    hid_t id;
    int rank;
    hsize_t length[H5S_MAX_RANK];
    size_t elements;   /* 0 where it claims more than its file can hold */
    H5T_class_t class; /* H5T_NO_CLASS: numbers that are too wide */
    bool number;
};
struct results_variable results_variable(const struct results *r, const char *path);
/* Product of lengths, 0 when it overflows. A damaged header must not make us ask for terabytes:
 * no array of ours has more elements than its file has bytes. */
size_t results_elements(const struct results *r, int rank, const hsize_t *length);
bool results_failed(const struct results *r, const char *what, stance_message *message);
bool results_damaged(const struct results *r, const char *what, stance_message *message);
bool results_no_memory(const struct results *r, stance_message *message);
/* Name, unit and text of what an axis or a sampled variable holds. */
void results_describe(hid_t dataset, const char *name, struct results_axis *axis);
void results_copy_attribute(hid_t object, const char *name, char *buffer, size_t size);
/* What the axis `sample` varies, once the axes have been read; nothing where there is none. */
bool results_read_sample(struct results *r, stance_message *message);
void results_free_sample(struct results *r);

#endif
