/* store_look.c - looks into results files from outside: what they were made from, how far they are,
 * whether they are whole. */
#include "file_checksums.h"
#include "store_private.h"

#include "runner/base/checksum.h"

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
    if (id < 0)
        store_failed(message, file, "open");
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
    if (id < 0)
        return false;
    /* The last attribute written says that the creation came to its end. */
    char *hash = read_text(id, "scenario_sha256"), *scenario = read_text(id, "scenario");
    bool good = !resume || (hash && scenario) || not_resumable(file, message);
    good =
        good && file_checksums_verify(id, file, scenario, scenario ? hash : NULL, resume, message);
    free(hash);
    free(scenario);
    H5Fclose(id);
    return good;
}

/* Of the sample's points; NULL: the file has no sample, or does not say. */
static char *read_generator(hid_t file)
{
    hid_t sample =
        H5Lexists(file, "sample", H5P_DEFAULT) > 0 ? H5Dopen2(file, "sample", H5P_DEFAULT) : -1;
    char *text =
        sample >= 0 && H5Aexists(sample, "generator") > 0 ? read_text(sample, "generator") : NULL;
    H5Dclose(sample);
    return text;
}

bool store_read_origin(const char *file, struct store_origin *origin, stance_message *message)
{
    *origin = (struct store_origin){0};
    hid_t id = open_to_read(file, message);
    if (id < 0)
        return false;
    char *revision = read_text(id, "git_revision"), *date = read_text(id, "date");
    hid_t ranks = H5Aopen(id, "ranks", H5P_DEFAULT);
    origin->scenario = read_text(id, "scenario");
    origin->title = read_text(id, "title");
    origin->hosts = read_text(id, "hosts");
    origin->generator = read_generator(id);
    snprintf(origin->revision, sizeof origin->revision, "%s", revision ? revision : "unknown");
    snprintf(origin->date, sizeof origin->date, "%s", date ? date : "unknown");
    if (ranks < 0 || H5Aread(ranks, H5T_NATIVE_INT, &origin->ranks) < 0)
        origin->ranks = 0;
    H5Aclose(ranks);
    bool good = store_read_history(id, origin);
    H5Fclose(id);
    free(revision);
    free(date);
    if (!good || !origin->scenario) {
        store_origin_free(origin);
        return good ? not_resumable(file, message)
                    : store_failed(message, file, "read its history");
    }
    return true;
}

void store_origin_free(struct store_origin *origin)
{
    for (size_t k = 0; k < origin->ancestors; k++) {
        free(origin->ancestor[k].scenario);
        free(origin->ancestor[k].revision);
        free(origin->ancestor[k].date);
    }
    free(origin->ancestor);
    free(origin->scenario);
    free(origin->title);
    free(origin->hosts);
    free(origin->generator);
    *origin = (struct store_origin){0};
}

bool store_same_points(const char *file, const struct store_origin *origin,
                       const struct scenario *scenario, stance_message *message)
{
    const enum doe_method method = scenario->sample.design.method;
    const char *made_by = origin->generator ? origin->generator : "";
    if (!scenario->sample.given || strcmp(made_by, doe_generator(method)) == 0)
        return true;
    snprintf(message->text, sizeof message->text,
             "%.100s: the points of its sample are those of another version, whose generator for "
             "method %s was another: begin a new file",
             file, doe_words[method]);
    return false;
}

bool store_read_axis(const char *file, struct scenario_axis *axis, stance_message *message)
{
    if (!axis->log && !axis->sample)
        return true;
    hid_t id = open_to_read(file, message);
    const size_t paths = (size_t)axis->paths;
    const hsize_t length = axis->count;
    double *value = malloc(axis->count * sizeof *value);
    bool good = value != NULL && id >= 0, fits = true;
    for (size_t k = 0; good && k < paths; k++) {
        hid_t dataset = H5Dopen2(id, axis->path[k], H5P_DEFAULT);
        fits = dataset < 0 || store_has_shape(dataset, 1, &length);
        good = fits && H5Dread(dataset, store_memory_type(KIND_double), H5S_ALL, H5S_ALL,
                               H5P_DEFAULT, value) >= 0;
        for (size_t i = 0; good && i < axis->count; i++)
            axis->value[i * paths + k] = value[i];
        H5Dclose(dataset);
    }
    free(value);
    H5Fclose(id);
    if (!fits) {
        snprintf(message->text, sizeof message->text,
                 "%.100s: holds one case of a sweep (run --only), not the sweep", file);
        return false;
    }
    return good || store_failed(message, file, "read an axis");
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
    if (id < 0)
        return false;
    hid_t dataset = H5Dopen2(id, "status", H5P_DEFAULT);
    bool good = dataset >= 0 && count_status(dataset, counts);
    if (!good)
        snprintf(message->text, sizeof message->text, "%.120s: not a results file of stance", file);
    H5Dclose(dataset);
    H5Fclose(id);
    return good;
}

/* ---- rows that are not what their checksums say -------------------------------------------- */

enum { VERIFIED_ROWS = 1 << 16 }; /* at a time */

/* Elements [at, at + n) of a variable of any shape, in row-major order. */
static bool read_range(hid_t dataset, hid_t type, hsize_t at, hsize_t n, void *values)
{
    hsize_t length[H5S_MAX_RANK], start[H5S_MAX_RANK] = {0};
    hid_t space = H5Dget_space(dataset), memory = H5Screate_simple(1, &n, NULL);
    const int rank = H5Sget_simple_extent_dims(space, length, NULL);
    bool good = memory >= 0 && rank >= 1 && H5Sselect_none(space) >= 0 &&
                store_select_range(space, rank, length, 0, start, at, at + n) &&
                H5Dread(dataset, type, memory, space, H5P_DEFAULT, values) >= 0;
    H5Sclose(memory);
    H5Sclose(space);
    return good;
}

/* The columns of a file that is only looked at. */
struct columns {
    hid_t dataset[COLUMNS]; /* -1: not stored */
    size_t width[COLUMNS];  /* elements per case */
    size_t largest;         /* bytes per case of the widest */
};

static bool columns_open(struct columns *columns, hid_t file, uint64_t cases)
{
    bool good = true;
    *columns = (struct columns){.largest = 1};
    for (int c = 0; c < COLUMNS; c++) {
        const char *name = store_columns[c].name;
        const bool stored = H5Lexists(file, name, H5P_DEFAULT) > 0;
        hid_t dataset = stored ? H5Dopen2(file, name, H5P_DEFAULT) : -1, space = -1;
        hssize_t elements = 0;
        columns->dataset[c] = dataset;
        if (!stored)
            continue;
        space = H5Dget_space(dataset);
        elements = H5Sget_simple_extent_npoints(space);
        H5Sclose(space);
        good = good && elements > 0 && (uint64_t)elements % cases == 0 &&
               (uint64_t)elements / cases <= SCENARIO_MAX_STATES;
        columns->width[c] = good ? (size_t)((uint64_t)elements / cases) : 1;
        const size_t size = columns->width[c] * store_columns[c].size;
        columns->largest = size > columns->largest ? size : columns->largest;
    }
    return good;
}

static void columns_close(struct columns *columns)
{
    for (int c = 0; c < COLUMNS; c++)
        H5Dclose(columns->dataset[c]);
}

/* Checksums of rows [at, at + n) as they follow from the answers, crc[n]. */
static bool work_out(const struct columns *columns, hsize_t at, hsize_t n, char *values,
                     uint32_t *crc)
{
    memset(crc, 0, n * sizeof *crc);
    for (int c = 0; c < COLUMNS; c++) {
        const size_t width = columns->width[c], size = width * store_columns[c].size;
        if (columns->dataset[c] < 0 || c == COLUMN_CHECKSUM)
            continue;
        if (!read_range(columns->dataset[c], store_memory_type(store_columns[c].kind), at * width,
                        n * width, values))
            return false;
        for (hsize_t i = 0; i < n; i++)
            crc[i] = checksum_crc32c(crc[i], values + i * size, size);
    }
    return true;
}

bool store_distrust(int64_t file, uint8_t *status, uint64_t cases, struct store_damage *damage)
{
    struct columns columns;
    bool good = columns_open(&columns, (hid_t)file, cases);
    char *values = malloc(VERIFIED_ROWS * columns.largest);
    uint32_t *crc = malloc(VERIFIED_ROWS * sizeof *crc);
    uint32_t *stored = malloc(VERIFIED_ROWS * sizeof *stored);
    const hid_t checksum = columns.dataset[COLUMN_CHECKSUM];

    *damage = (struct store_damage){0};
    good = good && values && crc && stored;
    for (uint64_t at = 0, n; good && checksum >= 0 && at < cases; at += n) {
        n = cases - at < VERIFIED_ROWS ? cases - at : VERIFIED_ROWS;
        bool marked = false;
        for (uint64_t i = at; i < at + n && !marked; i++)
            marked = status[i] != STANCE_PENDING;
        if (!marked)
            continue;
        good = read_range(checksum, store_memory_type(KIND_uint32_t), at, n, stored) &&
               work_out(&columns, at, n, values, crc);
        for (uint64_t i = 0; good && i < n; i++) {
            if (status[at + i] != STANCE_PENDING &&
                (crc[i] != stored[i] || status[at + i] > STANCE_FAILED)) {
                damage->first = damage->cases++ == 0 ? at + i : damage->first;
                status[at + i] = STANCE_PENDING;
            }
        }
    }
    columns_close(&columns);
    free(values);
    free(crc);
    free(stored);
    return good;
}

bool store_trajectory_checksum(int64_t file, size_t place, uint32_t *crc)
{
    hid_t dataset = H5Dopen2((hid_t)file, "trajectory/checksum", H5P_DEFAULT);
    bool good =
        dataset >= 0 && read_range(dataset, store_memory_type(KIND_uint32_t), place, 1, crc);
    H5Dclose(dataset);
    return good;
}
