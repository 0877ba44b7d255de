/* image.c - see image.h. */
#include "image.h"

#include "runner/base/checksum.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* Both parts of a label have the same length whatever they say. */
enum { LABEL_SIZE = 256 };
static int put_label(char text[LABEL_SIZE], const struct image_label *label)
{
    return snprintf(text, LABEL_SIZE, "\nstance object\ncompiler %-80.80s\nkey %-65.65s\n",
                    label->compiler, label->key);
}
static const char hash_format[] = "sha256 %-64.64s\n";

static size_t label_length(size_t *hash)
{
    char text[LABEL_SIZE];
    *hash = (size_t)snprintf(text, sizeof text, hash_format, "");
    return (size_t)put_label(text, &(const struct image_label){.key = ""}) + *hash;
}

bool image_read(struct image *image, int file)
{
    struct stat information;
    *image = (struct image){NULL, 0};
    if (fstat(file, &information) != 0 || !S_ISREG(information.st_mode) ||
        information.st_size <= 0 || information.st_size > IMAGE_LARGEST)
        return false;
    const size_t size = (size_t)information.st_size;
    image->bytes = malloc(size);
    while (image->bytes && image->size < size) {
        const ssize_t n =
            pread(file, image->bytes + image->size, size - image->size, (off_t)image->size);
        if (n <= 0)
            break;
        image->size += (size_t)n;
    }
    if (image->bytes && image->size == size)
        return true;
    image_free(image);
    return false;
}

bool image_seal(struct image *image, const struct image_label *label)
{
    char text[LABEL_SIZE], sha256[CHECKSUM_SHA256_TEXT];
    size_t hash;
    char *const more = realloc(image->bytes, image->size + label_length(&hash) + 1);
    if (!more)
        return false;
    image->bytes = more;
    const size_t length = (size_t)put_label(text, label);
    memcpy(image->bytes + image->size, text, length);
    image->size += length;
    checksum_sha256(image->bytes, image->size, sha256);
    snprintf(image->bytes + image->size, hash + 1, hash_format, sha256);
    image->size += hash;
    return true;
}

bool image_label(const struct image *image, struct image_label *label)
{
    char expected[LABEL_SIZE], sha256[CHECKSUM_SHA256_TEXT];
    size_t hash;
    const size_t length = label_length(&hash);
    if (image->size <= length)
        return false;
    const size_t hashed = image->size - hash;
    checksum_sha256(image->bytes, hashed, sha256);
    snprintf(expected, sizeof expected, hash_format, sha256);
    if (memcmp(image->bytes + hashed, expected, hash) != 0)
        return false;
    char text[LABEL_SIZE], compiler[IMAGE_COMPILER + 1]; /* the blank before it, and it */
    memcpy(text, image->bytes + image->size - length, length - hash);
    text[length - hash] = '\0';
    if (sscanf(text, "\nstance object\ncompiler%81c\nkey %65s", compiler, label->key) != 2)
        return false;
    compiler[IMAGE_COMPILER] = '\0';
    memcpy(label->compiler, compiler + 1, IMAGE_COMPILER);
    for (size_t n = strlen(label->compiler); n > 0 && label->compiler[n - 1] == ' '; n--)
        label->compiler[n - 1] = '\0';
    return true;
}

void image_free(struct image *image)
{
    free(image->bytes);
    *image = (struct image){NULL, 0};
}
