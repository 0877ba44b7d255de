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

/* A long variable is read in pieces. */
static bool add_numbers(hid_t dataset, enum store_kind kind, size_t n, uint32_t *crc)
{
    enum { PIECE = 1 << 16 };
    void *values = malloc((n < PIECE ? n : PIECE) * sizeof(double));
    bool good = values != NULL;
    for (size_t at = 0; good && at < n; at += PIECE) {
        const size_t count = n - at < PIECE ? n - at : PIECE;
        good = hdf_move(dataset, hdf_type(kind), at, count, HDF_READ, values);
        if (good)
            *crc = checksum_crc32c(*crc, values, count * sizeof(double));
    }
    free(values);
    return good;
}

static bool add_words(hid_t dataset, size_t n, uint32_t *crc)
{
    char **words = hdf_words(dataset, 0, n);
    for (size_t i = 0; words && i < n; i++)
        *crc = checksum_crc32c(*crc, words[i], strlen(words[i]) + 1);
    hdf_free_words(words, n);
    return words != NULL;
}

static bool checksum_of(hid_t dataset, const char *name, uint32_t *crc)
{
    hid_t type = H5Dget_type(dataset);
    size_t n = hdf_elements(dataset);
    bool good = false;

    *crc = checksum_crc32c(0, name, strlen(name) + 1);
    switch (n > 0 && type >= 0 ? H5Tget_class(type) : H5T_NO_CLASS) {
    case H5T_FLOAT:
        good = add_numbers(dataset, KIND_double, n, crc);
        break;
    case H5T_INTEGER:
        good = add_numbers(dataset, KIND_int64_t, n, crc);
        break;
    case H5T_STRING:
        good = add_words(dataset, n, crc);
        break;
    default:
        break;
    }
    hdf_close(type);
    return good;
}

/* ---- walking through the variables -------------------------------------------------------- */

struct walk {
    bool put, strict;
    const char *group; /* "", "design", "trajectory", "history" */
    const char *name;  /* of the file */
    stance_message *message;
};

static bool put_checksum(hid_t dataset, const char *name)
{
    uint32_t crc = 0;
    return checksum_of(dataset, name, &crc) &&
           put_attribute(dataset, CHECKSUM_ATTRIBUTE, KIND_uint32_t, &crc);
}

static bool say_damaged(const struct walk *walk, const char *variable, const char *what)
{
    char word[SHOWN_SIZE]; /* a damaged name may hold anything */
    return complain(walk->message, "%.100s: damaged: %s%s%s %s", walk->name, walk->group,
                    walk->group[0] ? "/" : "", shown(word, variable), what);
}

static bool verify_checksum(const struct walk *walk, hid_t dataset, const char *variable)
{
    uint32_t crc = 0, expected = 0;
    if (H5Aexists(dataset, CHECKSUM_ATTRIBUTE) <= 0)
        return !walk->strict || say_damaged(walk, variable, "has no checksum");
    if (!hdf_number(dataset, CHECKSUM_ATTRIBUTE, hdf_type(KIND_uint32_t), &expected) ||
        !checksum_of(dataset, variable, &crc))
        return say_damaged(walk, variable, "cannot be read");
    return crc == expected || say_damaged(walk, variable, "is not as its checksum says");
}

/* Looks at one link of a group; a negative value ends the walk. */
static herr_t visit(hid_t group, const char *name, const H5L_info_t *info, void *context)
{
    const struct walk *walk = context;
    (void)info;
    char path[128];
    snprintf(path, sizeof path, "%s%s%s", walk->group, walk->group[0] ? "/" : "", name);
    if (store_is_column(path) || store_is_track(path))
        return 0;
    hid_t object = H5Oopen(group, name, H5P_DEFAULT);
    bool good = object >= 0;
    if (!good && !walk->put)
        say_damaged(walk, name, "cannot be opened");
    if (good && H5Iget_type(object) == H5I_DATASET)
        good = walk->put ? put_checksum(object, name) : verify_checksum(walk, object, name);
    hdf_close(object);
    return good ? 0 : -1;
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
                (H5Iget_type(object) != H5I_DATASET || hdf_elements(object) > 0) &&
                H5Aiterate2(object, H5_INDEX_NAME, H5_ITER_INC, NULL, touch_attribute, NULL) >= 0;
    if (good && H5Iget_type(object) == H5I_DATASET) { /* netCDF's order */
        good =
            H5Aiterate2(object, H5_INDEX_CRT_ORDER, H5_ITER_INC, NULL, touch_attribute, NULL) >= 0;
    }
    hdf_close(object);
    return good || say_damaged(context, name, "cannot be opened") ? 0 : -1;
}

/* Everything in a group can be opened, in the order of its making, too: what other readers go by.
 */
static bool touch_group(hid_t id, struct walk *walk)
{
    H5O_info_t all;
    return H5Oget_info2(id, &all, H5O_INFO_ALL) >= 0 &&
           H5Literate(id, H5_INDEX_NAME, H5_ITER_INC, NULL, touch, walk) >= 0 &&
           (walk->group[0] ||
            H5Aiterate2(id, H5_INDEX_CRT_ORDER, H5_ITER_INC, NULL, touch_attribute, NULL) >= 0) &&
           H5Literate(id, H5_INDEX_CRT_ORDER, H5_ITER_INC, NULL, touch, walk) >= 0;
}

static bool visit_group(hid_t id, struct walk *walk)
{
    return H5Literate(id, H5_INDEX_NAME, H5_ITER_INC, NULL, visit, walk) >= 0;
}

/* ---- the groups --------------------------------------------------------------------------- */

static bool walk_group(hid_t file, struct walk *walk, const char *group,
                       bool (*look)(hid_t id, struct walk *walk))
{
    walk->group = group;
    if (group[0] && H5Lexists(file, group, H5P_DEFAULT) <= 0)
        return true;
    hid_t id = H5Gopen2(file, group[0] ? group : "/", H5P_DEFAULT);
    bool good = id >= 0 && look(id, walk);
    if (!good && !walk->put && walk->message->text[0] == '\0')
        say_damaged(walk, group[0] ? "*" : "its variables", "cannot be listed");
    hdf_close(id);
    return good;
}

static bool walk_file(hid_t file, struct walk *walk, bool (*look)(hid_t id, struct walk *walk))
{
    return walk_group(file, walk, "", look) && walk_group(file, walk, "design", look) &&
           walk_group(file, walk, "trajectory", look) && walk_group(file, walk, "history", look);
}

/* ---- both uses ---------------------------------------------------------------------------- */

bool file_checksums_put(int64_t file)
{
    struct walk walk = {.put = true};
    return walk_file((hid_t)file, &walk, visit_group);
}

bool file_checksums_verify(int64_t file, const char *name, const char *scenario, const char *hash,
                           bool strict, stance_message *message)
{
    struct walk walk = {.strict = strict, .group = "", .name = name, .message = message};
    char found[CHECKSUM_SHA256_TEXT];

    message->text[0] = '\0';
    if (H5Aiterate2((hid_t)file, H5_INDEX_NAME, H5_ITER_INC, NULL, touch_attribute, NULL) < 0)
        return say_damaged(&walk, "its attributes", "cannot be read");
    if (hash && hash[0]) {
        checksum_sha256(scenario, strlen(scenario), found);
        if (strcmp(found, hash) != 0)
            return say_damaged(&walk, "the scenario's text", "is not as its checksum says");
    }
    return walk_file((hid_t)file, &walk, visit_group) &&
           (!strict || (walk_file((hid_t)file, &walk, touch_group) &&
                        walk_group((hid_t)file, &walk, "timing", touch_group)));
}
