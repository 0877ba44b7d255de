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
static bool checksum_of(hid_t dataset, const char *name, uint32_t *crc)
{
    enum { PIECE = 1 << 16 };
    const size_t n = hdf_elements(dataset);
    hid_t type = H5Dget_type(dataset);
    const H5T_class_t class = type < 0 ? H5T_NO_CLASS : H5Tget_class(type);
    hdf_close(type);
    bool good = n > 0 && (class == H5T_FLOAT || class == H5T_INTEGER || class == H5T_STRING);
    double *const values =
        good && class != H5T_STRING ? malloc((n < PIECE ? n : PIECE) * sizeof *values) : NULL;
    char **const words = good && class == H5T_STRING ? hdf_words(dataset, 0, n) : NULL;
    good = values || words;
    *crc = checksum_crc32c(0, name, strlen(name) + 1);
    for (size_t i = 0; words && i < n; i++)
        *crc = checksum_crc32c(*crc, words[i], strlen(words[i]) + 1);
    for (size_t at = 0, count; good && values && at < n; at += count) {
        count = n - at < PIECE ? n - at : PIECE;
        good = hdf_move(dataset, hdf_type(class == H5T_FLOAT ? KIND_double : KIND_int64_t), at,
                        count, HDF_READ, values);
        if (good)
            *crc = checksum_crc32c(*crc, values, count * sizeof *values);
    }
    hdf_free_words(words, n);
    free(values);
    return good;
}

/* ---- walking through the file ------------------------------------------------------------- */

struct walk {
    bool put, strict;
    H5_index_t order;
    const char *group; /* that is walked through: "", "design", ... */
    const char *name;  /* of the file */
    stance_message *message;
};

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

static herr_t touch_attribute(hid_t object, const char *name, const H5A_info_t *info, void *unused)
{
    (void)info, (void)unused;
    hid_t attribute = H5Aopen(object, name, H5P_DEFAULT);
    return attribute < 0 ? -1 : H5Aclose(attribute);
}

/* HDF5 verifies its own checksums of what it touches. */
static bool touch(hid_t object, H5_index_t order)
{
    H5O_info_t all;
    const H5I_type_t type = H5Iget_type(object);
    if (type == H5I_GROUP) /* which has attributes of nobody */
        order = H5_INDEX_NAME;
    return H5Oget_info2(object, &all, H5O_INFO_ALL) >= 0 &&
           H5Aiterate2(object, order, H5_ITER_INC, NULL, touch_attribute, NULL) >= 0 &&
           (type != H5I_DATASET || hdf_elements(object) > 0);
}

/* Looks at one link of a group; a negative value ends the walk. */
static herr_t visit(hid_t group, const char *name, const H5L_info_t *info, void *context)
{
    const struct walk *walk = context;
    uint32_t crc;
    char path[128];
    (void)info;
    snprintf(path, sizeof path, "%s%s%s", walk->group, walk->group[0] ? "/" : "", name);
    const bool rows = store_is_column(path) || store_is_track(path);
    if (rows && !walk->strict)
        return 0;
    hid_t object = H5Oopen(group, name, H5P_DEFAULT);
    bool good = object >= 0 && (!walk->strict || touch(object, walk->order));
    if (!good && !walk->put)
        say_damaged(walk, name, "cannot be opened");
    if (good && !rows && walk->order == H5_INDEX_NAME && H5Iget_type(object) == H5I_DATASET)
        good = walk->put ? checksum_of(object, name, &crc) &&
                               put_attribute(object, CHECKSUM_ATTRIBUTE, KIND_uint32_t, &crc)
                         : verify_checksum(walk, object, name);
    hdf_close(object);
    return good ? 0 : -1;
}

/* Group by group, each opened by itself: H5Lvisit gives up at what cannot be opened, though it may
 * not matter. */
static bool walk_through(hid_t file, struct walk *walk, H5_index_t order)
{
    static const char *const groups[] = {"", "design", "trajectory", "history"};
    bool good = true;
    walk->order = order;
    for (size_t i = 0; good && i < sizeof groups / sizeof groups[0]; i++) {
        walk->group = groups[i];
        if (groups[i][0] && H5Lexists(file, groups[i], H5P_DEFAULT) <= 0)
            continue;
        const hid_t id = H5Gopen2(file, groups[i][0] ? groups[i] : "/", H5P_DEFAULT);
        good = id >= 0 && H5Literate(id, order, H5_ITER_INC, NULL, visit, walk) >= 0;
        if (!good && !walk->put && walk->message->text[0] == '\0')
            say_damaged(walk, groups[i][0] ? "*" : "its variables", "cannot be listed");
        hdf_close(id);
    }
    return good;
}

/* ---- both uses ---------------------------------------------------------------------------- */

bool file_checksums_put(int64_t file)
{
    struct walk walk = {.put = true};
    return walk_through((hid_t)file, &walk, H5_INDEX_NAME);
}

static bool verify_scenario(hid_t file)
{
    char *const hash = hdf_text(file, "scenario_sha256"), *const text = hdf_text(file, "scenario");
    char found[CHECKSUM_SHA256_TEXT] = "";
    if (hash && text)
        checksum_sha256(text, strlen(text), found);
    const bool same = hash ? strcmp(found, hash) == 0 : H5Aexists(file, "scenario_sha256") <= 0;
    free(hash);
    free(text);
    return same;
}

bool file_checksums_verify(int64_t file, const char *name, bool strict, stance_message *message)
{
    struct walk walk = {.strict = strict, .group = "", .name = name, .message = message};
    const hid_t id = (hid_t)file;

    message->text[0] = '\0';
    if (!touch(id, H5_INDEX_NAME))
        return say_damaged(&walk, "its attributes", "cannot be read");
    if (!verify_scenario(id))
        return say_damaged(&walk, "the scenario's text", "is not as its checksum says");
    /* Strictly everything can be opened, in the order of its making, too: what other readers go by.
     */
    return walk_through(id, &walk, H5_INDEX_NAME) &&
           (!strict || ((touch(id, H5_INDEX_CRT_ORDER) ||
                         say_damaged(&walk, "its variables", "cannot be listed")) &&
                        walk_through(id, &walk, H5_INDEX_CRT_ORDER)));
}
