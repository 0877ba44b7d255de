/* store_look.c - looks into results files from outside: what they were made from, how far they are,
 * whether they are whole. */
#include "file_checksums.h"
#include "store_private.h"

#include "runner/base/checksum.h"
#include "runner/base/message.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

static bool not_resumable(const char *file, stance_message *message)
{
    return complain(message, "%.120s: not a results file that can be resumed; --force replaces it",
                    file);
}

bool store_check(const char *file, bool resume, stance_message *message)
{
    hid_t id = hdf_open_to_read(file, message);
    if (id < 0)
        return false;
    /* The last attribute written says that the creation came to its end. */
    char *hash = hdf_text(id, "scenario_sha256"), *scenario = hdf_text(id, "scenario");
    bool good = !resume || (hash && scenario) || not_resumable(file, message);
    good =
        good && file_checksums_verify(id, file, scenario, scenario ? hash : NULL, resume, message);
    free(hash);
    free(scenario);
    H5Fclose(id);
    return good;
}

bool store_read_origin(const char *file, struct store_origin *origin, stance_message *message)
{
    *origin = (struct store_origin){0};
    hid_t id = hdf_open_to_read(file, message);
    if (id < 0)
        return false;
    char *revision = hdf_text(id, "git_revision"), *date = hdf_text(id, "date");
    hid_t sample = hdf_exists(id, "sample") ? H5Dopen2(id, "sample", H5P_DEFAULT) : -1;
    origin->scenario = hdf_text(id, "scenario");
    origin->title = hdf_text(id, "title");
    origin->hosts = hdf_text(id, "hosts");
    origin->generator = sample >= 0 ? hdf_text(sample, "generator") : NULL;
    origin->ranks = hdf_whole(id, "ranks", 0);
    snprintf(origin->revision, sizeof origin->revision, "%s", revision ? revision : "unknown");
    snprintf(origin->date, sizeof origin->date, "%s", date ? date : "unknown");
    hdf_close(sample);
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
    return complain(
        message,
        "%.100s: the points of its sample are those of another version, whose generator for "
        "method %s was another: begin a new file",
        file, doe_words[method]);
}

bool store_read_axis(const char *file, struct scenario_axis *axis, stance_message *message)
{
    if (!axis->log && !axis->sample)
        return true;
    hid_t id = hdf_open_to_read(file, message);
    if (id < 0)
        return false;
    const size_t paths = (size_t)axis->paths;
    hsize_t length[H5S_MAX_RANK];
    double *value = malloc(axis->count * sizeof *value);
    bool good = value != NULL, fits = true;
    for (size_t k = 0; good && k < paths; k++) {
        hid_t dataset = H5Dopen2(id, axis->path[k], H5P_DEFAULT);
        fits = dataset < 0 || (hdf_shape(dataset, length) == 1 && length[0] == axis->count);
        good = fits && hdf_read(dataset, KIND_double, value);
        for (size_t i = 0; good && i < axis->count; i++)
            axis->value[i * paths + k] = value[i];
        hdf_close(dataset);
    }
    free(value);
    H5Fclose(id);
    if (!fits) {
        return complain(message, "%.100s: holds one case of a sweep (run --only), not the sweep",
                        file);
    }
    return good || store_failed(message, file, "read an axis");
}

/* Reads the status variable, whatever its shape, in pieces. */
static bool count_status(hid_t dataset, struct store_counts *counts)
{
    enum { PIECE = 1 << 20 };
    uint8_t *status = malloc(PIECE);
    hsize_t length[H5S_MAX_RANK], total = 1;
    const int rank = hdf_shape(dataset, length);
    for (int d = 0; d < rank; d++)
        total *= length[d];
    bool good = status && rank >= 1 && rank <= SCENARIO_MAX_AXES && total > 0;

    counts->cases = good ? total : 0;
    for (uint64_t at = 0, n; good && at < counts->cases; at += n) {
        n = counts->cases - at < PIECE ? counts->cases - at : PIECE;
        good = hdf_move(dataset, H5T_STD_U8LE, at, n, HDF_READ, status);
        for (uint64_t i = 0; good && i < n; i++) {
            counts->done += status[i] == STANCE_DONE;
            counts->failed += status[i] == STANCE_FAILED;
        }
    }
    free(status);
    return good;
}

bool store_count(const char *file, struct store_counts *counts, stance_message *message)
{
    *counts = (struct store_counts){0};
    hid_t id = hdf_open_to_read(file, message);
    if (id < 0)
        return false;
    hid_t dataset = H5Dopen2(id, "status", H5P_DEFAULT);
    bool good = dataset >= 0 && count_status(dataset, counts);
    if (!good)
        complain(message, "%.120s: not a results file of stance", file);
    hdf_close(dataset);
    H5Fclose(id);
    return good;
}

/* ---- rows that are not what their checksums say -------------------------------------------- */

enum { VERIFIED_ROWS = 1 << 16 }; /* at a time */

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
        hdf_close(space);
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
    hdf_close_all(columns->dataset, COLUMNS);
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
        if (!hdf_move(columns->dataset[c], hdf_type(store_columns[c].kind), at * width, n * width,
                      HDF_READ, values))
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
        good = hdf_move(checksum, H5T_STD_U32LE, at, n, HDF_READ, stored) &&
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
    bool good = dataset >= 0 && hdf_move(dataset, H5T_STD_U32LE, place, 1, HDF_READ, crc);
    hdf_close(dataset);
    return good;
}
