/* image.h - the bytes of a compiled object, and the label at their end that says what they are.
 *
 * An ELF file may be followed by anything; what follows here is text of a fixed length:
 *
 *     stance object
 *     compiler gcc (Debian 12.2.0-14+deb12u1) 12.2.0 ...
 *     key 0123...-4567...
 *     sha256 of all that stands before this word
 */
#ifndef STANCE_OBJECTS_IMAGE_H
#define STANCE_OBJECTS_IMAGE_H

#include <stdbool.h>
#include <stddef.h>

enum {
    IMAGE_HALF = 33, /* 32 digits of a SHA-256 and a zero */
    IMAGE_KEY = 66,  /* what is compiled, '-', by which compiler */
    IMAGE_COMPILER = 81,
    IMAGE_LARGEST = 1 << 26, /* bytes */
};

struct image {
    char *bytes; /* NULL: none */
    size_t size;
};

struct image_label {
    char key[IMAGE_KEY], compiler[IMAGE_COMPILER];
};

/* Reads an open regular file into memory. false: no memory, or it cannot be read; none then. */
bool image_read(struct image *image, int file);
/* Appends the label. false: no memory. */
bool image_seal(struct image *image, const struct image_label *label);
/* Reads the label. false: it has none, or is not what the label was made for. */
bool image_label(const struct image *image, struct image_label *label);
void image_free(struct image *image);

#endif
