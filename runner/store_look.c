/* store_look.c - looks into results files from outside: what they were made from, how far they are,
 * whether they are whole. */
#include "store_private.h"

#include "seal.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

/* Files only: to open a pipe would wait for its writer. What the system says of a file that is not
 * there, HDF5 passes on. */
static hid_t open_to_read(const char *file, stance_message *message)
{
    struct stat information;
    if (stat(file, &information) == 0 && !S_ISREG(information.st_mode)) {
        snprintf(message->text, sizeof message->text, "%.120s: %s", file,
                 S_ISDIR(information.st_mode) ? strerror(EISDIR) : "not a file");
        return -1;
    }
    hid_t access = store_serial_access();
    hid_t id = H5Fopen(file, H5F_ACC_RDONLY, access);
    if (id < 0) {
        store_failed(message, file, "open");
    }
    H5Pclose(access);
    return id;
}

/* A text attribute of fixed length, as this program writes them; NULL when there is none. */
static char *read_text(hid_t object, const char *name)
{
    hid_t attribute = H5Aopen(object, name, H5P_DEFAULT), type = H5Aget_type(attribute);
    size_t size = H5Tget_size(type);
    char *text = NULL;
    if (type >= 0 && H5Tget_class(type) == H5T_STRING && H5Tis_variable_str(type) == 0) {
        text = calloc(size + 1, 1);
        if (text && H5Aread(attribute, type, text) < 0) {
            free(text);
            text = NULL;
        }
    }
    H5Tclose(type);
    H5Aclose(attribute);
    return text;
}

static bool not_resumable(const char *file, stance_message *message)
{
    snprintf(message->text, sizeof message->text,
             "%.120s: not a results file that can be resumed; --force replaces it", file);
    return false;
}

bool store_check(const char *file, bool resume, stance_message *message)
{
    hid_t id = open_to_read(file, message);
    if (id < 0) {
        return false;
    }
    /* The last attribute written says that the creation came to its end. */
    char *hash = read_text(id, "scenario_sha256"), *scenario = read_text(id, "scenario");
    bool good = !resume || (hash && scenario) || not_resumable(file, message);
    good = good && seal_verify(id, file, scenario, scenario ? hash : NULL, resume, message);
    free(hash);
    free(scenario);
    H5Fclose(id);
    return good;
}

bool store_read_origin(const char *file, struct store_origin *origin, stance_message *message)
{
    *origin = (struct store_origin){0};
    hid_t id = open_to_read(file, message);
    if (id < 0) {
        return false;
    }
    char *revision = read_text(id, "git_revision");
    origin->scenario = read_text(id, "scenario");
    snprintf(origin->revision, sizeof origin->revision, "%s", revision ? revision : "unknown");
    H5Fclose(id);
    free(revision);
    return origin->scenario || not_resumable(file, message);
}

void store_origin_free(struct store_origin *origin)
{
    free(origin->scenario);
    origin->scenario = NULL;
}

bool store_read_axis(const char *file, struct scenario_axis *axis, stance_message *message)
{
    if (!axis->log) {
        return true;
    }
    hid_t id = open_to_read(file, message), dataset = H5Dopen2(id, axis->name, H5P_DEFAULT);
    hsize_t length = axis->count;
    double *value = malloc(axis->count * sizeof *value);
    bool good =
        value && store_has_shape(dataset, 1, &length) &&
        H5Dread(dataset, store_memory_type(KIND_double), H5S_ALL, H5S_ALL, H5P_DEFAULT, value) >= 0;
    H5Dclose(dataset);
    H5Fclose(id);
    if (!good) {
        free(value);
        return store_failed(message, file, "read an axis");
    }
    free(axis->value);
    axis->value = value;
    return true;
}

/* Reads the status variable, whatever its shape, in pieces. */
static bool count_status(hid_t dataset, struct store_counts *counts)
{
    enum { PIECE = 1 << 20 };
    uint8_t *status = malloc(PIECE);
    hid_t space = H5Dget_space(dataset);
    hsize_t length[H5S_MAX_RANK], start[H5S_MAX_RANK] = {0};
    int rank = H5Sget_simple_extent_dims(space, length, NULL);
    hssize_t total = H5Sget_simple_extent_npoints(space);
    bool good = status && rank >= 1 && rank <= SCENARIO_MAX_AXES && total > 0;

    counts->cases = good ? (uint64_t)total : 0;
    for (uint64_t at = 0; good && at < counts->cases; at += PIECE) {
        hsize_t n = counts->cases - at < PIECE ? counts->cases - at : PIECE;
        hid_t memory = H5Screate_simple(1, &n, NULL);
        good = H5Sselect_none(space) >= 0 &&
               store_select_range(space, rank, length, 0, start, at, at + n) &&
               H5Dread(dataset, store_memory_type(KIND_uint8_t), memory, space, H5P_DEFAULT,
                       status) >= 0;
        H5Sclose(memory);
        for (hsize_t i = 0; good && i < n; i++) {
            counts->done += status[i] == STANCE_DONE;
            counts->failed += status[i] == STANCE_FAILED;
        }
    }
    H5Sclose(space);
    free(status);
    return good;
}

bool store_count(const char *file, struct store_counts *counts, stance_message *message)
{
    *counts = (struct store_counts){0};
    hid_t id = open_to_read(file, message);
    if (id < 0) {
        return false;
    }
    hid_t dataset = H5Dopen2(id, "status", H5P_DEFAULT);
    bool good = dataset >= 0 && count_status(dataset, counts);
    if (!good) {
        snprintf(message->text, sizeof message->text, "%.120s: not a results file of stance", file);
    }
    H5Dclose(dataset);
    H5Fclose(id);
    return good;
}
