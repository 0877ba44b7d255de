/* damage.c - damages HDF5 files: by accident, or so that HDF5's own checksums still hold.
 *
 * Metadata are found by their signatures (HDF5 File Format Specification, version 3): object
 * headers, their continuations, heaps and B-trees, each of which ends with a checksum; where, is
 * found by trying. Without those made to fit, nearly all damage to metadata ends there.
 */
#include "damage.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Bob Jenkins' lookup3, as the HDF5 library has it. */
uint32_t H5_checksum_metadata(const void *data, size_t size, uint32_t start);

enum { MOST_BLOCKS = 512, LONGEST_BLOCK = 1 << 16, SUPERBLOCK = 48 };

static uint32_t load32(const uint8_t *data)
{
    uint32_t value;
    memcpy(&value, data, sizeof value);
    return value;
}

/* ---- finding metadata --------------------------------------------------------------------- */

static bool is_signature(const uint8_t *data)
{
    static const char *const words[] = {"OHDR", "OCHK", "FRHP", "FHDB", "FHIB", "FSHD",
                                        "FSSE", "BTHD", "BTIN", "BTLF", "SMTB", "SMLI",
                                        "GCOL", "SNOD", "TREE", "HEAP"};
    for (size_t i = 0; i < sizeof words / sizeof words[0]; i++)
        if (memcmp(data, words[i], 4) == 0)
            return true;
    return false;
}

static struct damage_block find_block(const uint8_t *data, size_t size, size_t at)
{
    size_t left = size - at < LONGEST_BLOCK ? size - at : LONGEST_BLOCK;
    for (size_t n = 8; n + 4 <= left; n++) {
        if (H5_checksum_metadata(data + at, n, 0) == load32(data + at + n))
            return (struct damage_block){at, n + 4, true};
        if (n > 16 && n + 8 <= left && is_signature(data + at + n))
            break; /* ran into the next one */
    }
    return (struct damage_block){at, left < 256 ? left : 256, false};
}

bool damage_load(struct damage_file *file, const char *path)
{
    FILE *in = fopen(path, "rb");
    const char *slash = strrchr(path, '/');
    *file = (struct damage_file){0};
    snprintf(file->name, sizeof file->name, "%s", slash ? slash + 1 : path);
    if (!in || fseek(in, 0, SEEK_END) != 0)
        return false;
    file->size = (size_t)ftell(in);
    rewind(in);
    file->data = malloc(file->size + 1);
    file->block = calloc(MOST_BLOCKS, sizeof *file->block);
    bool good = file->data && file->block && file->size > SUPERBLOCK &&
                fread(file->data, 1, file->size, in) == file->size;
    fclose(in);
    if (good) {
        bool sealed = H5_checksum_metadata(file->data, SUPERBLOCK - 4, 0) ==
                      load32(file->data + SUPERBLOCK - 4); /* version 2 or 3 */
        file->block[file->blocks++] = (struct damage_block){0, SUPERBLOCK, sealed};
    }
    for (size_t at = SUPERBLOCK; good && at + 8 < file->size && file->blocks < MOST_BLOCKS; at++)
        if (is_signature(file->data + at))
            file->block[file->blocks++] = find_block(file->data, file->size, at);
    return good;
}

/* ---- damage ------------------------------------------------------------------------------- */

struct damage {
    const struct damage_file *file;
    uint8_t *data;
    size_t size;
    uint64_t chance;
    char *text;
};

static size_t below(struct damage *d, size_t n)
{
    d->chance ^= d->chance << 13; /* Marsaglia's xorshift */
    d->chance ^= d->chance >> 7;
    d->chance ^= d->chance << 17;
    return n ? (size_t)(d->chance >> 11) % n : 0;
}

static void say(struct damage *d, const char *what, size_t at, size_t size)
{
    size_t used = strlen(d->text);
    snprintf(d->text + used, 200 - used, "%s%s %zu+%zu", used ? ", " : "", what, at, size);
}

/* A place in the metadata; within an object header nearly always in the body of a message. */
static size_t metadata_place(struct damage *d)
{
    const struct damage_block *block = &d->file->block[below(d, d->file->blocks)];
    size_t at = block->at + below(d, block->size);
    return at < d->size ? at : d->size - 1;
}

static void flip(struct damage *d, bool metadata)
{
    size_t at = metadata ? metadata_place(d) : below(d, d->size);
    d->data[at] ^= (uint8_t)(1u << below(d, 8));
    say(d, "flip", at, 1);
}

/* Numbers that sizes and addresses are tried with. */
static void extreme(struct damage *d)
{
    const uint64_t size = d->file->size;
    const uint64_t values[] = {0,
                               1,
                               2,
                               0x7f,
                               0xff,
                               0xffff,
                               0x7fffffff,
                               0xffffffff,
                               INT64_MAX,
                               UINT64_MAX,
                               UINT64_MAX - 1,
                               size,
                               size - 1,
                               size + 1,
                               size - 8,
                               size / 8,
                               (uint64_t)1 << below(d, 64),
                               ((uint64_t)1 << below(d, 64)) - 1,
                               below(d, d->file->size),
                               d->file->block[below(d, d->file->blocks)].at};
    uint64_t value = values[below(d, sizeof values / sizeof values[0])];
    const size_t width = (size_t)1 << below(d, 4), at = metadata_place(d);
    if (at + width <= d->size) {
        uint64_t old = 0;
        memcpy(&old, d->data + at, width);
        value = below(d, 4) ? value : old + below(d, 5) - 2;
        memcpy(d->data + at, &value, width);
        say(d, "number", at, width);
    }
}

static void fill(struct damage *d)
{
    static const uint8_t with[] = {0, 0, 0xff, 0x55, 'O'};
    size_t at = below(d, 2) ? metadata_place(d) : below(d, d->size);
    size_t n = 1 + below(d, below(d, 4) ? 64 : 8192);
    n = n < d->size - at ? n : d->size - at;
    memset(d->data + at, with[below(d, sizeof with)], n);
    say(d, "fill", at, n);
}

static void copy(struct damage *d)
{
    size_t from = below(d, 2) ? metadata_place(d) : below(d, d->size);
    size_t to = below(d, 2) ? metadata_place(d) : below(d, d->size);
    size_t far = from > to ? from : to, n = 1 + below(d, below(d, 3) ? 32 : 4096);
    n = n < d->size - far ? n : d->size - far;
    memmove(d->data + to, d->data + from, n);
    say(d, "copy", to, n);
}

static void swap_blocks(struct damage *d)
{
    enum { PIECE = 512 };
    size_t pieces = d->size / PIECE, a = below(d, pieces) * PIECE, b = below(d, pieces) * PIECE;
    uint8_t hold[PIECE];
    if (pieces > 0) {
        memcpy(hold, d->data + a, PIECE);
        memmove(d->data + a, d->data + b, PIECE);
        memcpy(d->data + b, hold, PIECE);
        say(d, "swap", a, PIECE);
    }
}

/* A whole header where another one was. */
static void copy_block(struct damage *d)
{
    const struct damage_block *from = &d->file->block[below(d, d->file->blocks)];
    const struct damage_block *to = &d->file->block[below(d, d->file->blocks)];
    if (from->at + from->size <= d->size && to->at + from->size <= d->size) {
        memmove(d->data + to->at, d->data + from->at, from->size);
        say(d, "block", to->at, from->size);
    }
}

static void truncate_file(struct damage *d)
{
    size_t to = below(d, 3) ? below(d, d->size) : d->size - 1 - below(d, d->size < 64 ? 1 : 64);
    if (to > 0) {
        d->size = to;
        say(d, "cut", to, 0);
    }
}

static void seal(struct damage *d)
{
    for (size_t i = 0; i < d->file->blocks; i++) {
        const struct damage_block *block = &d->file->block[i];
        if (block->sealed && block->at + block->size <= d->size) {
            uint32_t sum = H5_checksum_metadata(d->data + block->at, block->size - 4, 0);
            memcpy(d->data + block->at + block->size - 4, &sum, sizeof sum);
        }
    }
}

bool damage_make(const struct damage_file *file, uint64_t number, uint8_t *data, size_t room,
                 size_t *size, char text[200])
{
    struct damage d = {file, data, file->size < room ? file->size : room,
                       (number + 1) * 0x9e3779b97f4a7c15u, text};
    text[0] = '\0';
    memcpy(data, file->data, d.size);
    for (int i = 0; i < 8; i++)
        below(&d, 1); /* numbers beside each other begin alike */
    const bool forge = below(&d, 2);
    for (size_t n = below(&d, 3) ? 1 : 1 + below(&d, 6); n > 0; n--) {
        switch (below(&d, 12)) {
        case 0:
        case 1:
            flip(&d, false);
            break;
        case 2:
        case 3:
            flip(&d, true);
            break;
        case 4:
        case 5:
        case 6:
            extreme(&d);
            break;
        case 7:
            fill(&d);
            break;
        case 8:
            copy(&d);
            break;
        case 9:
            swap_blocks(&d);
            break;
        case 10:
            forge ? copy_block(&d) : truncate_file(&d);
            break;
        default:
            forge ? extreme(&d) : flip(&d, true);
        }
    }
    if (forge)
        seal(&d);
    *size = d.size;
    return forge;
}
