/* file_checksums.c - checksums over what a results file holds besides its rows, made and verified.
 *
 * Variables are found by walking through the file's groups, so that none is forgotten: whatever is
 * neither an answer nor a trajectory nor a time has a checksum.
 */
#include "file_checksums.h"
#include "store_private.h"

#include "runner/base/checksum.h"
#include "runner/base/problem.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- the checksum of a variable ----------------------------------------------------------- */

/* Number of elements; 0 when a damaged header claims more than the file can hold. (Variables of
 * ours are contiguous.) */
static size_t count_elements(hid_t dataset)
{
    hid_t space = H5Dget_space(dataset), type = H5Dget_type(dataset);
    hid_t file = H5Iget_file_id(dataset);
    hsize_t size = 0;
    hssize_t points = space < 0 ? -1 : H5Sget_simple_extent_npoints(space);
    const size_t width = type < 0 ? 0 : H5Tget_size(type);
    bool good = file >= 0 && H5Fget_filesize(file, &size) >= 0 && points > 0 && width > 0 &&
                (hsize_t)points <= size / width;
    H5Sclose(space);
    H5Tclose(type);
    H5Fclose(file);
    return good ? (size_t)points : 0;
}

/* A long variable is read in pieces. */
static bool add_numbers(hid_t dataset, hid_t type, size_t n, uint32_t *crc)
{
    enum { PIECE = 1 << 16 };
    hsize_t length[H5S_MAX_RANK], start[H5S_MAX_RANK] = {0};
    hid_t space = H5Dget_space(dataset);
    const int rank = H5Sget_simple_extent_dims(space, length, NULL);
    void *values = malloc((n < PIECE ? n : PIECE) * sizeof(double));
    bool good = values && rank >= 0;

    for (size_t at = 0; good && at < n; at += PIECE) {
        const hsize_t count = n - at < PIECE ? n - at : PIECE;
        hid_t memory = H5Screate_simple(1, &count, NULL);
        good = memory >= 0 &&
               (rank == 0 || (H5Sselect_none(space) >= 0 &&
                              store_select_range(space, rank, length, 0, start, at, at + count))) &&
               H5Dread(dataset, type, memory, space, H5P_DEFAULT, values) >= 0;
        if (good)
            *crc = checksum_crc32c(*crc, values, count * sizeof(double));
        H5Sclose(memory);
    }
    free(values);
    H5Sclose(space);
    return good;
}

static bool add_words(hid_t dataset, hid_t type, size_t n, uint32_t *crc)
{
    char **words = calloc(n, sizeof *words);
    bool good = words && H5Tis_variable_str(type) > 0 &&
                H5Dread(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, words) >= 0;
    for (size_t i = 0; words && i < n; i++) {
        const char *word = words[i] ? words[i] : "";
        *crc = checksum_crc32c(*crc, word, strlen(word) + 1);
        H5free_memory(words[i]);
    }
    free(words);
    return good;
}

static bool checksum_of(hid_t dataset, const char *name, uint32_t *crc)
{
    hid_t type = H5Dget_type(dataset);
    size_t n = count_elements(dataset);
    bool good = false;

    *crc = checksum_crc32c(0, name, strlen(name) + 1);
    switch (n > 0 && type >= 0 ? H5Tget_class(type) : H5T_NO_CLASS) {
    case H5T_FLOAT:
        good = add_numbers(dataset, store_memory_type(KIND_double), n, crc);
        break;
    case H5T_INTEGER:
        good = add_numbers(dataset, store_memory_type(KIND_int64_t), n, crc);
        break;
    case H5T_STRING:
        good = add_words(dataset, type, n, crc);
        break;
    default:
        break;
    }
    H5Tclose(type);
    return good;
}

/* ---- walking through the variables -------------------------------------------------------- */

struct walk {
    bool put, strict;
    const char *group; /* "", "design", "trajectory", "history" */
    const char *name;  /* of the file */
    stance_message *message;
};

static bool is_row_variable(const char *group, const char *name)
{
    if (group[0] == '\0') {
        for (int c = 0; c < COLUMNS; c++)
            if (strcmp(name, store_columns[c].name) == 0)
                return true;
    }
    if (strcmp(group, "trajectory") == 0) {
        for (int v = 0; v < TRAJECTORIES; v++)
            if (strcmp(name, store_trajectories[v]) == 0)
                return true;
        return strcmp(name, store_columns[COLUMN_CHECKSUM].name) == 0;
    }
    return false;
}

static bool put_checksum(hid_t dataset, const char *name)
{
    uint32_t crc = 0;
    hsize_t one = 1;
    hid_t space = H5Screate_simple(1, &one, NULL);
    hid_t attribute = H5Acreate2(dataset, SEAL_ATTRIBUTE, store_file_type(KIND_uint32_t), space,
                                 H5P_DEFAULT, H5P_DEFAULT);
    bool good = checksum_of(dataset, name, &crc) && attribute >= 0 &&
                H5Awrite(attribute, store_memory_type(KIND_uint32_t), &crc) >= 0;
    H5Aclose(attribute);
    H5Sclose(space);
    return good;
}

static bool complain(const struct walk *walk, const char *variable, const char *what)
{
    char word[SHOWN_SIZE]; /* a damaged name may hold anything */
    snprintf(walk->message->text, sizeof walk->message->text, "%.100s: damaged: %s%s%s %s",
             walk->name, walk->group, walk->group[0] ? "/" : "", shown(word, variable), what);
    return false;
}

static bool verify_checksum(const struct walk *walk, hid_t dataset, const char *variable)
{
    uint32_t crc = 0, expected = 0;
    if (H5Aexists(dataset, SEAL_ATTRIBUTE) <= 0)
        return !walk->strict || complain(walk, variable, "has no checksum");
    hid_t attribute = H5Aopen(dataset, SEAL_ATTRIBUTE, H5P_DEFAULT);
    hid_t space = H5Aget_space(attribute);
    bool good = H5Sget_simple_extent_npoints(space) == 1 &&
                H5Aread(attribute, store_memory_type(KIND_uint32_t), &expected) >= 0;
    H5Sclose(space);
    H5Aclose(attribute);
    if (!good || !checksum_of(dataset, variable, &crc))
        return complain(walk, variable, "cannot be read");
    return crc == expected || complain(walk, variable, "is not as its checksum says");
}

/* Looks at one link of a group; a negative value ends the walk. */
static herr_t visit(hid_t group, const char *name, const H5L_info_t *info, void *context)
{
    const struct walk *walk = context;
    (void)info;
    if (is_row_variable(walk->group, name))
        return 0;
    hid_t object = H5Oopen(group, name, H5P_DEFAULT);
    bool good = object >= 0;
    if (!good && !walk->put)
        complain(walk, name, "cannot be opened");
    if (good && H5Iget_type(object) == H5I_DATASET)
        good = walk->put ? put_checksum(object, name) : verify_checksum(walk, object, name);
    if (object >= 0)
        H5Oclose(object);
    return good ? 0 : -1;
}

static bool walk_group(hid_t file, struct walk *walk, const char *group)
{
    walk->group = group;
    if (group[0] && H5Lexists(file, group, H5P_DEFAULT) <= 0)
        return true;
    hid_t id = H5Gopen2(file, group[0] ? group : "/", H5P_DEFAULT);
    bool good = id >= 0 && H5Literate(id, H5_INDEX_NAME, H5_ITER_INC, NULL, visit, walk) >= 0;
    if (!good && !walk->put && walk->message->text[0] == '\0')
        complain(walk, walk->group[0] ? "*" : "its variables", "cannot be listed");
    H5Gclose(id);
    return good;
}

static bool walk_file(hid_t file, struct walk *walk)
{
    return walk_group(file, walk, "") && walk_group(file, walk, "design") &&
           walk_group(file, walk, "trajectory") && walk_group(file, walk, "history");
}

/* ---- the structure ------------------------------------------------------------------------ */

static herr_t touch_attribute(hid_t object, const char *name, const H5A_info_t *info, void *unused)
{
    (void)info, (void)unused;
    hid_t attribute = H5Aopen(object, name, H5P_DEFAULT);
    return attribute < 0 ? -1 : H5Aclose(attribute);
}

/* Opens one link and its attributes; HDF5 verifies the checksums of what it touches. */
static herr_t touch(hid_t group, const char *name, const H5L_info_t *info, void *context)
{
    (void)info;
    H5O_info_t all;
    hid_t object = H5Oopen(group, name, H5P_DEFAULT);
    bool good = object >= 0 && H5Oget_info2(object, &all, H5O_INFO_ALL) >= 0 &&
                (H5Iget_type(object) != H5I_DATASET || count_elements(object) > 0) &&
                H5Aiterate2(object, H5_INDEX_NAME, H5_ITER_INC, NULL, touch_attribute, NULL) >= 0;
    if (good && H5Iget_type(object) == H5I_DATASET) { /* netCDF's order */
        good =
            H5Aiterate2(object, H5_INDEX_CRT_ORDER, H5_ITER_INC, NULL, touch_attribute, NULL) >= 0;
    }
    if (object >= 0)
        H5Oclose(object);
    return good || complain(context, name, "cannot be opened") ? 0 : -1;
}

/* Everything can be opened, in the order of its making, too: what other readers go by. */
static bool verify_structure(hid_t file, struct walk *walk)
{
    static const char *const groups[] = {"", "design", "trajectory", "history", "timing"};
    H5O_info_t all;
    bool good = true;
    for (size_t k = 0; good && k < sizeof groups / sizeof groups[0]; k++) {
        walk->group = groups[k];
        if (groups[k][0] && H5Lexists(file, groups[k], H5P_DEFAULT) <= 0)
            continue;
        hid_t id = H5Gopen2(file, groups[k][0] ? groups[k] : "/", H5P_DEFAULT);
        good = id >= 0 && H5Oget_info2(id, &all, H5O_INFO_ALL) >= 0 &&
               H5Literate(id, H5_INDEX_NAME, H5_ITER_INC, NULL, touch, walk) >= 0 &&
               (k > 0 || H5Aiterate2(id, H5_INDEX_CRT_ORDER, H5_ITER_INC, NULL, touch_attribute,
                                     NULL) >= 0) &&
               H5Literate(id, H5_INDEX_CRT_ORDER, H5_ITER_INC, NULL, touch, walk) >= 0;
        H5Gclose(id);
    }
    if (!good && walk->message->text[0] == '\0')
        complain(walk, walk->group[0] ? "*" : "its variables", "cannot be listed");
    return good;
}

/* ---- both uses ---------------------------------------------------------------------------- */

bool file_checksums_put(int64_t file)
{
    struct walk walk = {.put = true};
    return walk_file((hid_t)file, &walk);
}

bool file_checksums_put_group(int64_t file, const char *group)
{
    struct walk walk = {.put = true};
    return walk_group((hid_t)file, &walk, group);
}

bool file_checksums_verify(int64_t file, const char *name, const char *scenario, const char *hash,
                           bool strict, stance_message *message)
{
    struct walk walk = {.strict = strict, .group = "", .name = name, .message = message};
    char found[CHECKSUM_SHA256_TEXT];

    message->text[0] = '\0';
    if (H5Aiterate2((hid_t)file, H5_INDEX_NAME, H5_ITER_INC, NULL, touch_attribute, NULL) < 0)
        return complain(&walk, "its attributes", "cannot be read");
    if (hash && hash[0]) {
        checksum_sha256(scenario, strlen(scenario), found);
        if (strcmp(found, hash) != 0)
            return complain(&walk, "the scenario's text", "is not as its checksum says");
    }
    return walk_file((hid_t)file, &walk) && (!strict || verify_structure((hid_t)file, &walk));
}
