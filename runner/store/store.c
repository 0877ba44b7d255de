/* store.c - rows of results into the file and out of it.
 *
 * After creation the file's structure never changes: every dataset is contiguous and allocated,
 * and the ranks write disjoint parts of them independently, `status` last. A killed job therefore
 * leaves a readable file, and a row that is marked done was whole when it was marked. Collective
 * writes are never used: they hang when the disk is full.
 */
#include "store_private.h"

#include "runner/base/checksum.h"
#include "runner/base/message.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- the layout --------------------------------------------------------------------------- */

#define NUMBER(name, kind, unit, text)                                                             \
    {                                                                                              \
        name, kind, (kind) == KIND_double || (kind) == KIND_int64_t, unit, text, {OVER_NONE}, 0    \
    }
#define NUMBERS(name, unit, place, over, beside, text)                                             \
    {                                                                                              \
        name, KIND_double, true, unit, text, {OVER_##over, OVER_##beside}, place                   \
    }

const struct store_variable store_columns[COLUMNS] = {
#define STORE_COLUMN(name, type, how, told, unit, text)                                            \
    [STANCE_ANSWER_##name] = NUMBER(#name, KIND_##type, unit, text),
    /* every number of a code is one of its words */
    STANCE_ANSWERS(STORE_COLUMN)[COLUMN_FINAL_STATE] =
        NUMBERS("final_state", NULL, 0, STATE, NONE,
                "coordinates and their rates when the simulation stopped"),
    [COLUMN_SCENARIO_NUMBER] =
        NUMBER("scenario_number", KIND_uint8_t, NULL,
               "scenario that the case was computed with: places of the group "
               "history, then the file's own"),
    [COLUMN_CHECKSUM] =
        NUMBER("checksum", KIND_uint32_t, "1", "CRC-32C over the answers of the case"),
    [COLUMN_STATUS] = NUMBER("status", KIND_uint8_t, "1", "whether the case was computed"),
};

#define AT(member) offsetof(stance_trajectory, member)
const struct store_variable store_tracks[TRACKS + 1] = {
    NUMBERS("trajectory/position", NULL, AT(position), COORDINATE, NONE,
            "coordinates, in m and rad"),
    NUMBERS("trajectory/velocity", NULL, AT(velocity), COORDINATE, NONE,
            "rates of the coordinates, in m/s and rad/s"),
    NUMBERS("trajectory/torque", "N m", AT(torque), ACTUATOR, NONE,
            "torque applied in the step that ends there"),
    NUMBERS("trajectory/force", "N", AT(force), CONTACT, COMPONENT,
            "contact force, mean since the instant before"),
    NUMBERS("trajectory/gap", "m", AT(gap), CONTACT, NONE,
            "height of the contact point above the ground"),
    [TRACK_CHECKSUM] = NUMBER("trajectory/checksum", KIND_uint32_t, "1",
                              "CRC-32C over the trajectory of the case"),
};
const struct store_variable store_designs[RESOLVED_PARTS] = {
    NUMBERS("design/gain", NULL, RESOLVED_GAIN, ACTUATOR, POSTURE,
            "gains of the linear law: torque = feedforward - gain * error"),
    NUMBERS("design/equilibrium_position", NULL, RESOLVED_EQUILIBRIUM, COORDINATE, NONE,
            "coordinates of the controller's equilibrium"),
    NUMBERS("design/equilibrium_torque", "N m", RESOLVED_TORQUE, ACTUATOR, NONE,
            "torques that hold the controller's equilibrium"),
    NUMBERS("design/start_position", NULL, RESOLVED_START, COORDINATE, NONE,
            "coordinates of the initial equilibrium, foot at the origin"),
};
const struct store_variable store_design_status =
    NUMBER("design/status", KIND_uint8_t, NULL, "whether the design exists");

size_t store_width(const stance_scene *scene, const struct store_variable *v)
{
    const int lengths[] = {[OVER_NONE] = 1,
                           [OVER_STATE] = 2 * scene->coordinates,
                           [OVER_POSTURE] = 2 * scene->postures,
                           [OVER_COORDINATE] = scene->coordinates,
                           [OVER_ACTUATOR] = scene->actuators,
                           [OVER_CONTACT] = scene->contacts,
                           [OVER_COMPONENT] = 2};
    return (size_t)lengths[v->over[0]] * (size_t)lengths[v->over[1]];
}

static bool is_in(const struct store_variable *table, int count, const char *path)
{
    int k = 0;
    while (k < count && strcmp(path, table[k].name) != 0)
        k++;
    return k < count;
}

bool store_is_column(const char *path)
{
    return is_in(store_columns, COLUMNS, path);
}

bool store_is_track(const char *path)
{
    return is_in(store_tracks, TRACKS + 1, path);
}

bool store_has_column(const struct scenario *scenario, int column)
{
    return column > COLUMN_SCENARIO_NUMBER ||
           (column < COLUMN_SCENARIO_NUMBER && (scenario->answers >> column & 1));
}

/* ---- the library -------------------------------------------------------------------------- */

void store_prepare(void)
{
    /* Libraries that were opened before MPI started are not closed by MPI's end, and this call
     * keeps them from being closed at exit: after a failed write both would write again. */
    H5dont_atexit();
    H5open();
    hdf_remember();
}

hid_t store_serial_access(void)
{
    hid_t access = H5Pcreate(H5P_FILE_ACCESS);
    if (access < 0)
        return access;
    if (H5Pset_sieve_buf_size(access, 0) < 0 ||
        H5Pset_fclose_degree(access, H5F_CLOSE_STRONG) < 0 ||
        H5Pset_file_locking(access, false, true) < 0) {
        hdf_close(access);
        return -1;
    }
    return access;
}

/* ---- opening and closing ------------------------------------------------------------------ */

/* Collective: rank 0 reads where the dataset is and tells the others, lest thousands of ranks read
 * the same few bytes of the file. *there, where not NULL: whether there is one. */
static hid_t find_dataset(const struct store *store, const char *name, bool *there)
{
    hid_t access = H5Pcreate(H5P_DATASET_ACCESS), dataset = -1;
#if defined(STANCE_MPI) && defined(H5_HAVE_PARALLEL)
    if (store->ranks > 1)
        H5Pset_all_coll_metadata_ops(access, true);
#endif
    if (there)
        *there = H5Lexists(store->id, name, access) > 0;
    if (!there || *there)
        dataset = H5Dopen2(store->id, name, access);
    hdf_close(access);
    return dataset;
}

static bool open_columns(struct store *store, stance_message *message)
{
    const struct scenario *s = store->plan->scenario;
    hsize_t length[SCENARIO_MAX_AXES + 1], found[H5S_MAX_RANK];
    const int axes = store->plan->single ? 0 : s->axes, dimensions = axes > 0 ? axes : 1;
    length[0] = 1;
    for (int a = 0; a < axes; a++)
        length[a] = s->axis[a].count;

    for (int c = 0; c < COLUMNS; c++) {
        const bool history = c == COLUMN_SCENARIO_NUMBER && store->plan->ancestors > 0;
        if (!store_has_column(s, c) && !history)
            continue;
        const size_t width = store_width(s->scene, &store_columns[c]);
        store->width[c] = width;
        store->size[c] = width * hdf_size(store_columns[c].kind);
        const int rank = dimensions + (width > 1);
        const bool all = s->answers == UINT64_MAX && c < STANCE_ANSWER_COUNT;
        bool there = true;
        store->column[c] = find_dataset(store, store_columns[c].name, all ? &there : NULL);
        if (!there) /* all answers that the version knew which made the file */
            continue;
        length[dimensions] = width;
        const int is = store->column[c] < 0 ? -1 : hdf_shape(store->column[c], found);
        if (!store->plan->single && s->cases > 1 && is == 1 && found[0] == 1)
            return complain(message, STORE_ONE_CASE, store->file);
        if (is != rank || memcmp(found, length, (size_t)rank * sizeof *length) != 0)
            return complain(message, "%.100s: variable '%s' is not as this scenario needs it",
                            store->file, store_columns[c].name);
        if (store_columns[c].kind == KIND_int64_t)
            hdf_number(store->column[c], "_FillValue", H5T_NATIVE_INT64, &store->no_count);
    }
    return true;
}

static bool open_trajectories(struct store *store, stance_message *message)
{
    const struct plan *plan = store->plan;
    if (plan->record_rows == 0)
        return true;
    for (int v = 0; v <= TRACK_CHECKSUM; v++) {
        const size_t width = store_width(plan->scenario->scene, &store_tracks[v]);
        store->trajectory_size[v] = (size_t)plan->record_rows * width;
        if (width > 0)
            store->trajectory[v] = find_dataset(store, store_tracks[v].name, NULL);
        if (width > 0 && store->trajectory[v] < 0)
            return store_failed(message, store->file, "open the trajectories");
    }
    return true;
}

/* `id`: the file, open; below 0: it could not be. */
static bool open_store(struct store **result, hid_t id, const char *file, const struct plan *plan,
                       int ranks, stance_message *message)
{
    struct store *store = calloc(1, sizeof *store);

    *result = NULL;
    if (!store)
        return no_memory(message);
    snprintf(store->file, sizeof store->file, "%s", file);
    store->plan = plan;
    store->id = id;
    store->ranks = ranks;
    store->no_count = STANCE_NO_COUNT;
    for (int c = 0; c < COLUMNS; c++)
        store->column[c] = -1;
    for (int v = 0; v <= TRACK_CHECKSUM; v++)
        store->trajectory[v] = -1;
    *result = store;
    if (id < 0)
        return store_failed(message, file, "open");
    return open_columns(store, message) && open_trajectories(store, message);
}

bool store_open(struct store **result, const char *file, const struct plan *plan,
                const struct parallel *parallel, stance_message *message)
{
    /* Collective: before anything that can fail alone. */
    const bool spans = parallel && parallel_on_one_host(parallel);
    const int ranks = parallel ? parallel->size : 1;
    hid_t access = store_serial_access(), id = -1;
    bool good = access >= 0;
#if defined(STANCE_MPI) && defined(H5_HAVE_PARALLEL)
    good = good && (ranks == 1 || H5Pset_fapl_mpio(access, MPI_COMM_WORLD, MPI_INFO_NULL) >= 0);
#endif
    if (good)
        id = H5Fopen(file, H5F_ACC_RDWR, access);
    hdf_close(access);
    good = open_store(result, id, file, plan, ranks, message);
    if (good)
        (*result)->spans = spans;
    return good;
}

bool store_open_to_read(struct store **result, const char *file, const struct plan *plan,
                        stance_message *message)
{
    const hid_t id = hdf_open_to_read(file, message);
    return id >= 0 && open_store(result, id, file, plan, 1, message);
}

void store_abandon(struct store *store)
{
    if (store) {
        free(store->checked);
        free(store);
    }
}

bool store_close(struct store *store, stance_message *message)
{
    hdf_close_all(store->column, COLUMNS);
    hdf_close_all(store->trajectory, TRACKS + 1);
    const bool good = H5Fclose(store->id) >= 0;
    if (!good)
        store_failed(message, store->file, "close");
    store_abandon(store);
    return good;
}

/* ---- rows --------------------------------------------------------------------------------- */

/* All columns, in order: the checksum and then the status are the last ones. */
bool store_move_rows(const struct store *store, const struct store_block *block, size_t slot,
                     const struct rows *rows, enum hdf_direction way, stance_message *message)
{
    bool good = true;
    for (int c = 0; good && c < COLUMNS; c++)
        good = store->column[c] < 0 ||
               hdf_move_rows(store->column[c], hdf_type(store_columns[c].kind), store->width[c],
                             rows, way, store_cell(block, c, slot));
    return good || store_failed(message, store->file,
                                way == HDF_WRITE ? "write the results" : "read the results");
}

/* ---- rows in memory ----------------------------------------------------------------------- */

size_t store_row_size(const struct store *store)
{
    size_t size = 0;
    for (int c = 0; c < COLUMNS; c++)
        size += store->column[c] >= 0 ? store->size[c] : 0;
    return size;
}

struct store_block *store_block_make(const struct store *store, size_t rows)
{
    enum { ALIGNED = 16 };
    size_t offset[COLUMNS], size = (sizeof(struct store_block) + ALIGNED - 1) / ALIGNED * ALIGNED;
    for (int c = 0; c < COLUMNS; c++) {
        offset[c] = size;
        const size_t bytes = store->column[c] >= 0 ? rows * store->size[c] : 0;
        size += (bytes + ALIGNED - 1) / ALIGNED * ALIGNED;
    }
    struct store_block *const block = malloc(size);
    if (block) {
        *block = (struct store_block){.store = store};
        for (int c = 0; c < COLUMNS; c++)
            block->column[c] = store->column[c] >= 0 ? (char *)block + offset[c] : NULL;
    }
    return block;
}

uint32_t store_row_checksum(const struct store_block *block, size_t slot)
{
    uint32_t crc = 0;
    for (int c = 0; c < COLUMNS; c++)
        if (block->column[c] && c != COLUMN_CHECKSUM)
            crc = checksum_crc32c(crc, store_cell(block, c, slot), block->store->size[c]);
    return crc;
}

void store_put(struct store_block *block, size_t slot, const stance_result *result)
{
    size_t n = (size_t)block->store->plan->scenario->scene->coordinates;
    for (int c = 0; c < STANCE_ANSWER_COUNT; c++) {
        if (block->column[c])
            memcpy(store_cell(block, c, slot), (const char *)result + stance_answers[c].offset,
                   stance_answers[c].size);
        if (block->column[c] && store_columns[c].kind == KIND_int64_t) {
            int64_t *const count = store_cell(block, c, slot);
            *count = *count == STANCE_NO_COUNT ? block->store->no_count : *count;
        }
    }
    if (block->column[COLUMN_FINAL_STATE]) {
        double *state = store_cell(block, COLUMN_FINAL_STATE, slot);
        memcpy(state, result->position, n * sizeof *state);
        memcpy(state + n, result->velocity, n * sizeof *state);
    }
    uint8_t *const number = block->column[COLUMN_SCENARIO_NUMBER], *const status =
                                                                       block->column[COLUMN_STATUS];
    if (number)
        number[slot] = (uint8_t)block->store->plan->ancestors;
    status[slot] = (uint8_t)result->status;
    store_seal(block, slot);
}

/* Rows that are scattered are written with what lies between them, read before and written back: a
 * call of the system for each element of each row takes longer. Up to so many rows at once, of
 * which at least one in SPAN_SPARSEST is new. */
enum { SPAN_ROWS = 1 << 16, SPAN_SPARSEST = 1 << 12 };

/* How many rows from a place of the list on, which ascend, are written in one span. */
static uint64_t span_of(const struct rows *rows, uint64_t place)
{
    const uint64_t first = rows_at(rows, place);
    uint64_t n = 1;
    while (place + n < rows->count && rows_at(rows, place + n) > rows_at(rows, place + n - 1) &&
           rows_at(rows, place + n) - first < SPAN_ROWS &&
           rows_at(rows, place + n) - rows_at(rows, place + n - 1) <= SPAN_SPARSEST)
        n++;
    return n;
}

/* Writes rows of the block, from `slot` on, and what lies between them as it is. */
static bool write_span(struct store *store, const struct store_block *block, size_t slot,
                       const struct rows *rows, struct store_block *between,
                       stance_message *message)
{
    const uint64_t first = rows_at(rows, 0);
    const struct rows span = {.first = first, .count = rows_at(rows, rows->count - 1) - first + 1};
    if (!store_move_rows(store, between, 0, &span, HDF_READ, message))
        return false;
    for (int c = 0; c < COLUMNS; c++)
        for (uint64_t k = 0; store->column[c] >= 0 && k < rows->count; k++)
            memcpy(store_cell(between, c, rows_at(rows, k) - first), store_cell(block, c, slot + k),
                   store->size[c]);
    return store_move_rows(store, between, 0, &span, HDF_WRITE, message);
}

bool store_write(struct store *store, struct store_block *block, size_t slot,
                 const struct rows *rows, stance_message *message)
{
    if (!store->spans || !rows->row || rows->count < 2)
        return store_move_rows(store, block, slot, rows, HDF_WRITE, message);
    struct store_block *const between = store_block_make(store, SPAN_ROWS);
    bool good = between != NULL || no_memory(message);
    for (uint64_t at = 0, n; good && at < rows->count; at += n) {
        n = span_of(rows, at);
        const struct rows part = rows_part(rows, at, n);
        good = n < 2 || rows_at(&part, n - 1) - rows_at(&part, 0) + 1 == n
                   ? store_move_rows(store, block, slot + at, &part, HDF_WRITE, message)
                   : write_span(store, block, slot + at, &part, between, message);
    }
    free(between);
    return good;
}

/* ---- trajectories ------------------------------------------------------------------------- */

static double **track_of(const stance_trajectory *trajectory, int v)
{
    return (double **)(void *)((char *)(uintptr_t)trajectory + store_tracks[v].place);
}

bool store_blank_trajectory(const struct store *store, stance_trajectory *trajectory)
{
    size_t size = 0;
    for (int v = 0; v < TRACKS; v++)
        size += store->trajectory_size[v];
    double *at = trajectory->position ? trajectory->position : malloc(size * sizeof *at);
    for (size_t i = 0; at && i < size; i++)
        at[i] = NAN;
    for (int v = 0; at && v < TRACKS; at += store->trajectory_size[v++])
        *track_of(trajectory, v) = at;
    trajectory->interval = store->plan->record_interval;
    trajectory->rows = store->plan->record_rows;
    return trajectory->position != NULL;
}

bool store_move_trajectory(struct store *store, uint64_t place, enum hdf_direction way,
                           const stance_trajectory *trajectory, uint32_t *crc, uint32_t *stored)
{
    bool good = true;
    *crc = 0;
    for (int v = 0; good && v < TRACKS; v++) {
        const hsize_t n = store->trajectory_size[v];
        double *const data = *track_of(trajectory, v);
        if (n > 0) {
            good = hdf_move(store->trajectory[v], H5T_IEEE_F64LE, place * n, n, way, data);
            *crc = checksum_crc32c(*crc, data, n * sizeof *data);
        }
    }
    if (way == HDF_WRITE)
        *stored = *crc;
    return good &&
           hdf_move(store->trajectory[TRACK_CHECKSUM], H5T_STD_U32LE, place, 1, way, stored);
}

bool store_write_trajectory(struct store *store, uint64_t place,
                            const stance_trajectory *trajectory, stance_message *message)
{
    uint32_t crc, stored;
    return store_move_trajectory(store, place, HDF_WRITE, trajectory, &crc, &stored) ||
           store_failed(message, store->file, "write a trajectory");
}

static bool verify_trajectory(struct store *store, uint64_t place, bool *whole,
                              stance_message *message)
{
    uint32_t crc, stored = 0;
    stance_trajectory trajectory = {0};
    if (!store_blank_trajectory(store, &trajectory))
        return no_memory(message);
    const bool good = store_move_trajectory(store, place, HDF_READ, &trajectory, &crc, &stored);
    free(trajectory.position);
    *whole = crc == stored;
    return good || store_failed(message, store->file, "read a trajectory");
}

bool store_verify(struct store *store, const struct rows *rows, struct store_found *found,
                  stance_message *message)
{
    if (!store->checked && !(store->checked = store_block_make(store, STORE_ROWS)))
        return no_memory(message);
    if (!store_move_rows(store, store->checked, 0, rows, HDF_READ, message))
        return false;
    const uint8_t *status = store->checked->column[COLUMN_STATUS];
    const uint8_t *outcome = store->checked->column[STANCE_ANSWER_outcome];
    const uint32_t *checksum = store->checked->column[COLUMN_CHECKSUM];
    for (size_t row = 0; row < rows->count; row++) {
        uint64_t place;
        const bool whole = (status[row] == STANCE_DONE || status[row] == STANCE_FAILED) &&
                           checksum[row] == store_row_checksum(store->checked, row);
        found[row] = (struct store_found){whole, status[row], outcome ? outcome[row] : STANCE_NONE};
        if (whole && plan_recorded(store->plan, rows_at(rows, row), &place) &&
            !verify_trajectory(store, place, &found[row].whole, message))
            return false;
    }
    return true;
}

/* ---- designs and timing ------------------------------------------------------------------- */

/* Moves them from the plan, NAN where there is none, or into it. */
static void move_designs(const struct plan *plan, bool into, int column, double *data)
{
    const struct store_variable *const v = &store_designs[column];
    const size_t width = store_width(plan->scenario->scene, v),
                 place = resolve_part(plan->scenario->scene, (enum resolved_parts)v->place).place;
    for (size_t d = 0; d < plan->designs; d++) {
        double *const own = &plan->design[d * plan->design_size + place];
        for (size_t i = 0; i < width; i++, data++)
            if (into)
                own[i] = *data;
            else
                *data = plan->design_status[d] == STANCE_DONE ? own[i] : NAN;
    }
}

double *store_design_values(const struct plan *plan, int column)
{
    const size_t width = store_width(plan->scenario->scene, &store_designs[column]);
    double *const data = malloc(plan->designs * width * sizeof *data);
    if (data)
        move_designs(plan, false, column, data);
    return data;
}

bool store_read_designs(struct store *store, struct plan *plan, stance_message *message)
{
    bool good = true;
    for (int k = 0; k < RESOLVED_PARTS; k++) { /* all of them, even when this rank has failed */
        if (store_width(plan->scenario->scene, &store_designs[k]) == 0)
            continue;
        const hid_t dataset = find_dataset(store, store_designs[k].name, NULL);
        double *const data = store_design_values(plan, k);
        good = data && hdf_read(dataset, KIND_double, data) && good;
        if (good)
            move_designs(plan, true, k, data);
        free(data);
        hdf_close(dataset);
    }
    const hid_t dataset = find_dataset(store, store_design_status.name, NULL);
    good = good && hdf_read(dataset, KIND_uint8_t, plan->design_status);
    hdf_close(dataset);
    return good || store_failed(message, store->file, "read the designs");
}

bool store_add_times(const struct store *store, const char *name, size_t first, size_t count,
                     const double *more)
{
    const hid_t dataset = H5Dopen2(store->id, name, H5P_DEFAULT);
    hsize_t length[H5S_MAX_RANK] = {0};
    double *total = hdf_shape(dataset, length) == 1 ? calloc(length[0] + 1, sizeof *total) : NULL;
    bool good = total && length[0] > 0 && hdf_read(dataset, KIND_double, total);
    for (size_t i = 0; good && i < count; i++)
        total[(first + i) % length[0]] += more[i];
    good = good && hdf_move(dataset, hdf_type(KIND_double), 0, length[0], HDF_WRITE, total);
    free(total);
    hdf_close(dataset);
    return good;
}

bool store_add_timing(struct store *store, int ranks, const double *wall_time, const double *cases,
                      stance_message *message)
{
    const size_t count = (size_t)ranks;
    return (store_add_times(store, "timing/wall_time", 0, count, wall_time) &&
            store_add_times(store, "timing/cases", 0, count, cases)) ||
           store_failed(message, store->file, "write the timing");
}
