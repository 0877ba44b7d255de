/* store_look.c - looks into results files from outside: what they were made from, how far they are,
 * whether they are whole. */
#include "file_checksums.h"
#include "store_private.h"

#include "runner/base/message.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static bool not_resumable(hid_t id, const char *file, stance_message *message)
{
    return hdf_is_no(
        id, file, "a results file that can be resumed or merged; run --force replaces it", message);
}

/* Leaves *shard as it is where there is none. */
static bool read_shard(hid_t id, const char *file, struct shard *shard, stance_message *message)
{
    char *text = H5Aexists(id, "shard") != 0 ? hdf_text(id, "shard") : NULL;
    const bool good = text ? shard_parse(shard, text) : H5Aexists(id, "shard") == 0;
    free(text);
    return good || complain(message, "%.100s: its attribute `shard` is damaged", file);
}

bool store_check(const char *file, bool resume, stance_message *message)
{
    hid_t id = hdf_open_to_read(file, message);
    if (id < 0)
        return false;
    struct shard shard;
    /* The last attribute written says that the creation came to its end. */
    const bool ended = H5Aexists(id, "scenario_sha256") > 0 && H5Aexists(id, "scenario") > 0;
    const bool good = (!resume || ended || not_resumable(id, file, message)) &&
                      read_shard(id, file, &shard, message) &&
                      file_checksums_verify(id, file, resume, message);
    H5Fclose(id);
    return good;
}

const char *const store_text_names[STORE_TEXTS] = {"scenario", "git_revision", "date"};

/* The scenarios of a file before its own, whose texts must be as many of each kind; none without a
 * group `history`. */
static bool read_history(hid_t file, struct store_origin *origin)
{
    const bool there = H5Lexists(file, "history", H5P_DEFAULT) > 0;
    hid_t group = there ? H5Gopen2(file, "history", H5P_DEFAULT) : -1;
    bool good = true;
    for (int k = 0; there && good && k < STORE_TEXTS; k++) {
        const hid_t dataset = H5Dopen2(group, store_text_names[k], H5P_DEFAULT);
        const size_t n = hdf_elements(dataset);
        if (k == 0 && n <= STORE_MOST_ANCESTORS) {
            origin->ancestor = calloc(n + 1, sizeof *origin->ancestor);
            origin->ancestors = origin->ancestor ? n : 0;
        }
        char **words = n > 0 && n == origin->ancestors ? hdf_words(dataset, 0, n) : NULL;
        for (size_t i = 0; words && i < n; i++)
            origin->ancestor[i].text[k] = words[i];
        good = words != NULL;
        free(words);
        hdf_close(dataset);
    }
    hdf_close(group);
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
    const bool good =
        read_shard(id, file, &origin->shard, message) &&
        (read_history(id, origin) || store_failed(message, file, "read its history")) &&
        (origin->scenario || not_resumable(id, file, message));
    H5Fclose(id);
    free(revision);
    free(date);
    if (!good)
        store_origin_free(origin);
    return good;
}

void store_origin_free(struct store_origin *origin)
{
    for (size_t k = 0; k < origin->ancestors; k++)
        for (int t = 0; t < STORE_TEXTS; t++)
            free(origin->ancestor[k].text[t]);
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

/* *fits: it has as many points there. */
static bool read_axis(hid_t file, struct scenario_axis *axis, double *value, bool *fits)
{
    const size_t paths = (size_t)axis->paths;
    bool good = value != NULL;
    for (size_t k = 0; good && k < paths; k++) {
        hsize_t length[H5S_MAX_RANK];
        hid_t dataset = H5Dopen2(file, axis->path[k], H5P_DEFAULT);
        *fits = dataset < 0 || (hdf_shape(dataset, length) == 1 && length[0] == axis->count);
        good = *fits && hdf_read(dataset, KIND_double, value);
        for (size_t i = 0; good && i < axis->count; i++)
            axis->value[i * paths + k] = value[i];
        hdf_close(dataset);
    }
    return good;
}

bool store_read_axes(const char *file, struct scenario_axis *axis, int axes,
                     stance_message *message)
{
    hid_t id = -1;
    bool good = true, fits = true;
    for (int a = 0; good && a < axes; a++) {
        if (!axis[a].log && !axis[a].sample)
            continue;
        if (id < 0 && (id = hdf_open_to_read(file, message)) < 0)
            return false;
        double *value = malloc(axis[a].count * sizeof *value);
        good = read_axis(id, &axis[a], value, &fits);
        free(value);
    }
    if (!good)
        fits ? store_failed(message, file, "read an axis")
             : complain(message, STORE_ONE_CASE, file);
    if (id >= 0)
        H5Fclose(id);
    return good;
}

/* Reads the status variable, whatever its shape, in pieces. */
static bool count_status(hid_t dataset, struct store_counts *counts)
{
    enum { PIECE = 1 << 20 };
    uint8_t *status = malloc(PIECE);
    counts->cases = hdf_elements(dataset);
    bool good = status && counts->cases > 0;

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
        hdf_is_no(id, file, "a results file of stance", message);
    hdf_close(dataset);
    H5Fclose(id);
    return good;
}

/* ---- rows that are not what their checksums say -------------------------------------------- */

enum { VERIFIED_ROWS = 1 << 12 }; /* at a time */

/* Opens the columns of a file that is only looked at, whatever its scenario. One that is there but
 * does not open, as a damaged header leaves it, is none that was left out: rows could not be
 * verified. */
static bool open_columns(struct store *store, hid_t file, uint64_t cases)
{
    bool good = true;
    for (int c = 0; c < COLUMNS; c++) {
        const bool there = hdf_exists(file, store_columns[c].name);
        store->column[c] = there ? H5Dopen2(file, store_columns[c].name, H5P_DEFAULT) : -1;
        good = good && (!there || store->column[c] >= 0);
        if (store->column[c] < 0)
            continue;
        const hid_t space = H5Dget_space(store->column[c]);
        const hssize_t elements = H5Sget_simple_extent_npoints(space);
        hdf_close(space);
        good = good && elements > 0 && (uint64_t)elements % cases == 0 &&
               (uint64_t)elements / cases <= SCENARIO_MAX_STATES;
        store->width[c] = good ? (size_t)((uint64_t)elements / cases) : 1;
        store->size[c] = store->width[c] * hdf_size(store_columns[c].kind);
    }
    return good;
}

bool store_distrust(int64_t file, uint8_t *status, uint64_t cases, struct store_damage *damage)
{
    struct store store = {.id = (hid_t)file};
    stance_message ignored;
    bool good = open_columns(&store, store.id, cases);
    struct store_block *block =
        good ? store_block_make(&store, cases < VERIFIED_ROWS ? (size_t)cases : VERIFIED_ROWS)
             : NULL;

    *damage = (struct store_damage){0};
    good = block != NULL;
    for (uint64_t at = 0, n; good && store.column[COLUMN_CHECKSUM] >= 0 && at < cases; at += n) {
        n = cases - at < VERIFIED_ROWS ? cases - at : VERIFIED_ROWS;
        bool marked = false;
        for (uint64_t i = at; i < at + n && !marked; i++)
            marked = status[i] != STANCE_PENDING;
        if (!marked)
            continue;
        good = store_move_rows(&store, block, 0, &(struct rows){.first = at, .count = n}, HDF_READ,
                               &ignored);
        const uint32_t *stored = good ? block->column[COLUMN_CHECKSUM] : NULL;
        for (uint64_t i = 0; stored && i < n; i++) {
            if (status[at + i] != STANCE_PENDING &&
                (store_row_checksum(block, i) != stored[i] || status[at + i] > STANCE_FAILED)) {
                damage->first = damage->cases++ == 0 ? at + i : damage->first;
                status[at + i] = STANCE_PENDING;
            }
        }
    }
    free(block);
    hdf_close_all(store.column, COLUMNS);
    return good;
}
