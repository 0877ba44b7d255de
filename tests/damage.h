/* damage.h - damages HDF5 files: by accident, or so that HDF5's own checksums still hold. */
#ifndef STANCE_TESTS_DAMAGE_H
#define STANCE_TESTS_DAMAGE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* A part of the file's metadata, found by its signature. */
struct damage_block {
    size_t at, size; /* with its checksum, the last four bytes, where it has one */
    bool sealed;
};

struct damage_file {
    char name[64];
    uint8_t *data;
    size_t size;
    struct damage_block *block;
    size_t blocks;
};

/* Reads a file and finds its metadata; false: cannot. */
bool damage_load(struct damage_file *file, const char *path);

/* Damage number `number` of a file: data[room] gets its bytes, *size how many, text[200] what was
 * done. A pure function of file and number. Returns whether HDF5's checksums were made to fit. */
bool damage_make(const struct damage_file *file, uint64_t number, uint8_t *data, size_t room,
                 size_t *size, char text[200]);

#endif
