/* store.c - rows of results into the file and out of it.
 *
 * After creation the file's structure never changes: every dataset is contiguous and allocated,
 * and the ranks write disjoint parts of them independently, `status` last. A killed job therefore
 * leaves a readable file, and a row that is marked done was whole when it was marked. Collective
 * writes are never used: they hang when the disk is full.
 */
#include "store_private.h"

#include "runner/base/checksum.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- tables ------------------------------------------------------------------------------- */

const struct store_column store_columns[COLUMNS] = {
#define NONE_uint8_t 0
#define NONE_int64_t 0
#define NONE_double NAN
#define STORE_COLUMN(name, type, how, told, unit, text)                                            \
    [STANCE_ANSWER_##name] = {#name, KIND_##type, sizeof(type), NONE_##type, true, unit, text},
    STANCE_ANSWERS(STORE_COLUMN)[COLUMN_FINAL_STATE] =
        {"final_state", KIND_double, sizeof(double), NAN, true, NULL,
         "coordinates and their rates when the simulation stopped"},
    [COLUMN_SCENARIO_NUMBER] = {"scenario_number", KIND_uint8_t, sizeof(uint8_t), 0, false, "1",
                                "scenario that the case was computed with: places of the group "
                                "history, then the file's own"},
    [COLUMN_CHECKSUM] = {"checksum", KIND_uint32_t, sizeof(uint32_t), 0, false, "1",
                         "CRC-32C over the answers of the case"},
    [COLUMN_STATUS] = {"status", KIND_uint8_t, sizeof(uint8_t), 0, true, "1",
                       "whether the case was computed"},
};

const char *const store_trajectories[TRAJECTORIES] = {"position", "velocity", "torque", "force",
                                                      "gap"};

bool store_has_column(const struct scenario *scenario, int column)
{
    return column > COLUMN_SCENARIO_NUMBER ||
           (column < COLUMN_SCENARIO_NUMBER && (scenario->answers >> column & 1));
}

size_t store_column_width(const struct scenario *scenario, int column)
{
    return column == COLUMN_FINAL_STATE ? 2 * (size_t)scenario->scene->coordinates : 1;
}

size_t store_trajectory_width(const stance_scene *scene, int variable)
{
    switch (variable) {
    case TRAJECTORY_TORQUE:
        return (size_t)scene->actuators;
    case TRAJECTORY_FORCE:
        return 2 * (size_t)scene->contacts;
    case TRAJECTORY_GAP:
        return (size_t)scene->contacts;
    default:
        return (size_t)scene->coordinates;
    }
}

int store_dimensions(const struct plan *plan, hsize_t lengths[SCENARIO_MAX_AXES])
{
    const struct scenario *s = plan->scenario;
    if (plan->single || s->axes == 0) {
        lengths[0] = 1;
        return 1;
    }
    for (int a = 0; a < s->axes; a++)
        lengths[a] = s->axis[a].count;
    return s->axes;
}

void store_design_columns(const struct scenario *scenario,
                          struct store_design_column columns[DESIGN_COLUMNS])
{
    enum { POSTURES = 2 * STANCE_MAX_POSTURE };
    const stance_scene *scene = scenario->scene;
    const int n = scene->coordinates, m = scene->actuators, p = 2 * scene->postures;
    const int set = scenario->base.capture ? p : 0, number = set > 0;
    const struct store_design_column all[DESIGN_COLUMNS] = {
        {"gain",
         NULL,
         "gains of the linear law: torque = feedforward - gain * error",
         offsetof(struct resolved_design, gain),
         m,
         p,
         POSTURES,
         2,
         {DESIGN_ACTUATOR, DESIGN_POSTURE}},
        {"equilibrium_position",
         NULL,
         "coordinates of the controller's equilibrium",
         offsetof(struct resolved_design, equilibrium),
         1,
         n,
         n,
         1,
         {DESIGN_COORDINATE}},
        {"equilibrium_torque",
         "N m",
         "torques that hold the controller's equilibrium",
         offsetof(struct resolved_design, torque),
         1,
         m,
         m,
         1,
         {DESIGN_ACTUATOR}},
        {"start_position",
         NULL,
         "coordinates of the initial equilibrium, foot at the origin",
         offsetof(struct resolved_design, start),
         1,
         n,
         n,
         1,
         {DESIGN_COORDINATE}},
        {"captured",
         NULL,
         "confirmed set x' M x <= 1 of deviations from the target; cases stop in 0.8 of it",
         offsetof(struct resolved_design, captured),
         set,
         p,
         POSTURES,
         2,
         {DESIGN_POSTURE, DESIGN_POSTURE_OTHER}},
        {"capture_time",
         "s",
         "time that a case must have left to be captured",
         offsetof(struct resolved_design, capture_time),
         number,
         1,
         1,
         0,
         {0}},
        {"capture_boundary",
         "1",
         "simulations from the set's boundary, all stabilised",
         offsetof(struct resolved_design, capture_boundary),
         number,
         1,
         1,
         0,
         {0}},
        {"capture_batches",
         "1",
         "sets that were tried so, the last with success",
         offsetof(struct resolved_design, capture_batches),
         number,
         1,
         1,
         0,
         {0}},
        {"capture_share",
         "1",
         "less than this share of the boundary fails to stabilise, with 95 % confidence",
         offsetof(struct resolved_design, capture_share),
         number,
         1,
         1,
         0,
         {0}},
    };
    memcpy(columns, all, sizeof all);
}

hid_t store_file_type(enum store_kind kind)
{
    const hid_t types[] = {
        [KIND_uint8_t] = H5T_STD_U8LE,   [KIND_uint32_t] = H5T_STD_U32LE,
        [KIND_int32_t] = H5T_STD_I32LE,  [KIND_int64_t] = H5T_STD_I64LE,
        [KIND_uint64_t] = H5T_STD_U64LE, [KIND_double] = H5T_IEEE_F64LE,
    };
    return types[kind];
}

hid_t store_memory_type(enum store_kind kind)
{
    return store_file_type(kind); /* see the assertion on byte order */
}

/* ---- errors ------------------------------------------------------------------------------- */

/* What HDF5 said when a call failed: the next call, be it a close, wipes HDF5's own memory. The
 * system's words ("No space left on device") are worth more than HDF5's, the first more than the
 * later ones. */
static struct {
    char text[120];
    bool system;
} reason;

static herr_t find_reason(unsigned n, const H5E_error2_t *error, void *unused)
{
    (void)n, (void)unused;
    const char *system = error->desc ? strstr(error->desc, "error message = '") : NULL;
    if (system && !reason.system) {
        system += strlen("error message = '");
        snprintf(reason.text, sizeof reason.text, "%.*s", (int)strcspn(system, "'"), system);
        reason.system = true;
    } else if (reason.text[0] == '\0' && error->desc) {
        snprintf(reason.text, sizeof reason.text, "%.*s", (int)strcspn(error->desc, "\n"),
                 error->desc);
    }
    return 0;
}

/* HDF5 calls this whenever one of its functions fails. */
static herr_t remember_reason(hid_t stack, void *unused)
{
    return H5Ewalk2(stack, H5E_WALK_UPWARD, find_reason, unused);
}

bool store_failed(stance_message *message, const char *file, const char *what)
{
    snprintf(message->text, sizeof message->text, "%.80s: cannot %s: %s", file, what,
             reason.text[0] ? reason.text : "unknown reason");
    reason.text[0] = '\0';
    reason.system = false;
    return false;
}

void store_prepare(void)
{
    /* Libraries that were opened before MPI started are not closed by MPI's end, and this call
     * keeps them from being closed at exit: after a failed write both would write again. */
    H5dont_atexit();
    H5open();
    H5Eset_auto2(H5E_DEFAULT, remember_reason, NULL);
}

void store_library(char *text, size_t size)
{
    unsigned major = 0, minor = 0, release = 0;
    H5get_libversion(&major, &minor, &release);
    snprintf(text, size, "HDF5 %u.%u.%u", major, minor, release);
}

hid_t store_serial_access(void)
{
    hid_t access = H5Pcreate(H5P_FILE_ACCESS);
    if (access < 0)
        return access;
    if (H5Pset_sieve_buf_size(access, 0) < 0 ||
        H5Pset_fclose_degree(access, H5F_CLOSE_STRONG) < 0 ||
        H5Pset_file_locking(access, false, true) < 0) {
        H5Pclose(access);
        return -1;
    }
    return access;
}

/* ---- opening and closing ------------------------------------------------------------------ */

static hid_t open_for_ranks(const char *file, int ranks)
{
    hid_t access = store_serial_access();
    if (access < 0)
        return -1;
    hid_t id = -1;
#if defined(STANCE_MPI) && defined(H5_HAVE_PARALLEL)
    if (ranks > 1 && H5Pset_fapl_mpio(access, MPI_COMM_WORLD, MPI_INFO_NULL) < 0) {
        H5Pclose(access);
        return -1;
    }
#else
    (void)ranks;
#endif
    id = H5Fopen(file, H5F_ACC_RDWR, access);
    H5Pclose(access);
    return id;
}

/* Collective: rank 0 reads where the dataset is and tells the others, lest thousands of ranks read
 * the same few bytes of the file. */
static hid_t open_dataset(const struct store *store, const char *name)
{
    hid_t access = H5Pcreate(H5P_DATASET_ACCESS), dataset;
#if defined(STANCE_MPI) && defined(H5_HAVE_PARALLEL)
    if (store->ranks > 1)
        H5Pset_all_coll_metadata_ops(access, true);
#endif
    dataset = H5Dopen2(store->id, name, access);
    H5Pclose(access);
    return dataset;
}

bool store_has_shape(hid_t dataset, int rank, const hsize_t *length)
{
    hsize_t found[H5S_MAX_RANK];
    hid_t space = H5Dget_space(dataset);
    bool same = space >= 0 && H5Sget_simple_extent_ndims(space) == rank &&
                H5Sget_simple_extent_dims(space, found, NULL) == rank &&
                memcmp(found, length, (size_t)rank * sizeof *length) == 0;
    H5Sclose(space);
    return same;
}

static bool open_columns(struct store *store, stance_message *message)
{
    const struct scenario *s = store->plan->scenario;
    hsize_t length[SCENARIO_MAX_AXES + 1];
    memcpy(length, store->length, sizeof store->length);

    for (int c = 0; c < COLUMNS; c++) {
        const bool history = c == COLUMN_SCENARIO_NUMBER && store->plan->ancestors > 0;
        if (!store_has_column(s, c) && !history)
            continue;
        size_t width = store->width[c] = store_column_width(s, c);
        store->column[c] = open_dataset(store, store_columns[c].name);
        length[store->rank] = width;
        if (store->column[c] < 0 ||
            !store_has_shape(store->column[c], store->rank + (width > 1), length)) {
            snprintf(message->text, sizeof message->text,
                     "%.100s: variable '%s' is not as this scenario needs it", store->file,
                     store_columns[c].name);
            return false;
        }
    }
    return true;
}

static bool open_trajectories(struct store *store, stance_message *message)
{
    const struct plan *plan = store->plan;
    if (plan->record_rows == 0)
        return true;
    for (int v = 0; v < TRAJECTORIES; v++) {
        if (store_trajectory_width(plan->scenario->scene, v) == 0)
            continue;
        char name[64];
        snprintf(name, sizeof name, "trajectory/%s", store_trajectories[v]);
        store->trajectory[v] = open_dataset(store, name);
        if (store->trajectory[v] < 0)
            return store_failed(message, store->file, "open the trajectories");
    }
    store->trajectory_checksum = open_dataset(store, "trajectory/checksum");
    return store->trajectory_checksum >= 0 ||
           store_failed(message, store->file, "open the trajectories");
}

/* `id`: the file, open; below 0: it could not be. */
static bool open_store(struct store **result, hid_t id, const char *file, const struct plan *plan,
                       int ranks, stance_message *message)
{
    struct store *store = calloc(1, sizeof *store);

    *result = NULL;
    if (!store) {
        snprintf(message->text, sizeof message->text, "not enough memory");
        return false;
    }
    snprintf(store->file, sizeof store->file, "%s", file);
    store->plan = plan;
    store->id = id;
    store->ranks = ranks;
    store->rank = store_dimensions(plan, store->length);
    store->trajectory_checksum = -1;
    for (int c = 0; c < COLUMNS; c++)
        store->column[c] = -1;
    for (int v = 0; v < TRAJECTORIES; v++)
        store->trajectory[v] = -1;
    *result = store;
    if (id < 0)
        return store_failed(message, file, "open");
    return open_columns(store, message) && open_trajectories(store, message);
}

bool store_open(struct store **result, const char *file, const struct plan *plan, int ranks,
                stance_message *message)
{
    /* Collective: before anything that can fail alone. */
    const hid_t id = open_for_ranks(file, ranks);
    return open_store(result, id, file, plan, ranks, message);
}

bool store_open_to_read(struct store **result, const char *file, const struct plan *plan,
                        stance_message *message)
{
    const hid_t access = store_serial_access(), id = H5Fopen(file, H5F_ACC_RDONLY, access);
    H5Pclose(access);
    return open_store(result, id, file, plan, 1, message);
}

void store_abandon(struct store *store)
{
    if (store) {
        store_block_free(store->checked);
        free(store);
    }
}

bool store_close(struct store *store, stance_message *message)
{
    bool good = true;
    for (int c = 0; c < COLUMNS; c++)
        good &= store->column[c] < 0 || H5Dclose(store->column[c]) >= 0;
    for (int v = 0; v < TRAJECTORIES; v++)
        good &= store->trajectory[v] < 0 || H5Dclose(store->trajectory[v]) >= 0;
    good &= store->trajectory_checksum < 0 || H5Dclose(store->trajectory_checksum) >= 0;
    good &= H5Fclose(store->id) >= 0;
    if (!good)
        store_failed(message, store->file, "close");
    store_abandon(store);
    return good;
}

/* ---- rows --------------------------------------------------------------------------------- */

/* Moves n rows of one column, from `slot` of the block on, between the block and the file. */
static bool move_column(struct store *store, int c, struct store_block *block, size_t slot,
                        hid_t space, size_t n, enum store_direction way, stance_message *message)
{
    hid_t type = store_memory_type(store_columns[c].kind);
    hsize_t elements = n * store->width[c];
    char *data = (char *)block->column[c] + slot * store->width[c] * store_columns[c].size;
    hid_t memory = H5Screate_simple(1, &elements, NULL);
    herr_t status = memory < 0 ? -1
                    : way == STORE_WRITE
                        ? H5Dwrite(store->column[c], type, memory, space, H5P_DEFAULT, data)
                        : H5Dread(store->column[c], type, memory, space, H5P_DEFAULT, data);
    bool good =
        status >= 0 || store_failed(message, store->file,
                                    way == STORE_WRITE ? "write the results" : "read the results");
    H5Sclose(memory);
    return good;
}

/* All columns, in order: the checksum and then the status are the last ones. */
bool store_move_rows(struct store *store, struct store_block *block, size_t slot,
                     const struct rows *rows, enum store_direction way, stance_message *message)
{
    const size_t state = 2 * (size_t)store->plan->scenario->scene->coordinates;
    hid_t narrow = store_select_rows(store->rank, store->length, 1, rows);
    hid_t wide = store_select_rows(store->rank, store->length, state, rows);
    bool good = (narrow >= 0 && wide >= 0) ||
                store_failed(message, store->file, "select rows of the results");
    for (int c = 0; good && c < COLUMNS; c++) {
        if (store->column[c] >= 0) {
            good = move_column(store, c, block, slot, store->width[c] > 1 ? wide : narrow,
                               (size_t)rows->count, way, message);
        }
    }
    H5Sclose(narrow);
    H5Sclose(wide);
    return good;
}

/* ---- rows in memory ----------------------------------------------------------------------- */

size_t store_row_size(const struct store *store)
{
    size_t size = 0;
    for (int c = 0; c < COLUMNS; c++)
        size += store->column[c] >= 0 ? store->width[c] * store_columns[c].size : 0;
    return size;
}

struct store_block *store_block_make(const struct store *store, size_t rows)
{
    struct store_block *block = calloc(1, sizeof *block);
    bool good = block != NULL;
    for (int c = 0; good && c < COLUMNS; c++) {
        if (store->column[c] >= 0) {
            block->column[c] = malloc(rows * store->width[c] * store_columns[c].size);
            good = block->column[c] != NULL;
        }
    }
    if (!good) {
        store_block_free(block);
        return NULL;
    }
    block->store = store;
    block->rows = rows;
    return block;
}

void store_block_free(struct store_block *block)
{
    for (int c = 0; block && c < COLUMNS; c++)
        free(block->column[c]);
    free(block);
}

uint32_t store_row_checksum(const struct store_block *block, size_t slot)
{
    uint32_t crc = 0;
    for (int c = 0; c < COLUMNS; c++) {
        if (block->column[c] && c != COLUMN_CHECKSUM) {
            size_t size = block->store->width[c] * store_columns[c].size;
            crc = checksum_crc32c(crc, (const char *)block->column[c] + slot * size, size);
        }
    }
    return crc;
}

void store_put(struct store_block *block, size_t slot, const stance_result *result)
{
    size_t n = (size_t)block->store->plan->scenario->scene->coordinates;
    for (int c = 0; c < STANCE_ANSWER_COUNT; c++) {
        const size_t size = stance_answers[c].size;
        if (block->column[c]) {
            memcpy((char *)block->column[c] + slot * size,
                   (const char *)result + stance_answers[c].offset, size);
        }
    }
    if (block->column[COLUMN_FINAL_STATE]) {
        double *state = (double *)block->column[COLUMN_FINAL_STATE] + 2 * n * slot;
        memcpy(state, result->position, n * sizeof *state);
        memcpy(state + n, result->velocity, n * sizeof *state);
    }
    if (block->column[COLUMN_SCENARIO_NUMBER]) {
        ((uint8_t *)block->column[COLUMN_SCENARIO_NUMBER])[slot] =
            (uint8_t)block->store->plan->ancestors;
    }
    ((uint8_t *)block->column[COLUMN_STATUS])[slot] = (uint8_t)result->status;
    ((uint32_t *)block->column[COLUMN_CHECKSUM])[slot] = store_row_checksum(block, slot);
}

bool store_write(struct store *store, struct store_block *block, size_t slot,
                 const struct rows *rows, stance_message *message)
{
    return store_move_rows(store, block, slot, rows, STORE_WRITE, message);
}

/* ---- trajectories ------------------------------------------------------------------------- */

static double *trajectory_data(const stance_trajectory *trajectory, int variable)
{
    double *const data[TRAJECTORIES] = {
        [TRAJECTORY_POSITION] = trajectory->position, [TRAJECTORY_VELOCITY] = trajectory->velocity,
        [TRAJECTORY_TORQUE] = trajectory->torque,     [TRAJECTORY_FORCE] = trajectory->force,
        [TRAJECTORY_GAP] = trajectory->gap,
    };
    return data[variable];
}

/* Moves one case's part, `elements` long, of a variable whose first dimension is the case. */
bool store_move_place(hid_t dataset, enum store_kind kind, uint64_t place, hsize_t elements,
                      enum store_direction way, void *data)
{
    hsize_t length[H5S_MAX_RANK], start[H5S_MAX_RANK] = {0};
    hid_t space = H5Dget_space(dataset), memory = H5Screate_simple(1, &elements, NULL);
    bool good = space >= 0 && memory >= 0 && H5Sget_simple_extent_dims(space, length, NULL) >= 1;

    start[0] = place;
    length[0] = 1;
    good = good && H5Sselect_hyperslab(space, H5S_SELECT_SET, start, NULL, length, NULL) >= 0;
    if (good && way == STORE_WRITE)
        good = H5Dwrite(dataset, store_memory_type(kind), memory, space, H5P_DEFAULT, data) >= 0;
    else if (good)
        good = H5Dread(dataset, store_memory_type(kind), memory, space, H5P_DEFAULT, data) >= 0;
    H5Sclose(space);
    H5Sclose(memory);
    return good;
}

bool store_write_trajectory(struct store *store, uint64_t place,
                            const stance_trajectory *trajectory, stance_message *message)
{
    uint32_t crc = 0;
    bool good = true;
    for (int v = 0; good && v < TRAJECTORIES; v++) {
        if (store->trajectory[v] < 0)
            continue;
        size_t elements = (size_t)store->plan->record_rows *
                          store_trajectory_width(store->plan->scenario->scene, v);
        double *data = trajectory_data(trajectory, v);
        crc = checksum_crc32c(crc, data, elements * sizeof *data);
        good =
            store_move_place(store->trajectory[v], KIND_double, place, elements, STORE_WRITE, data);
    }
    good = good &&
           store_move_place(store->trajectory_checksum, KIND_uint32_t, place, 1, STORE_WRITE, &crc);
    return good || store_failed(message, store->file, "write a trajectory");
}

static bool verify_trajectory(struct store *store, uint64_t place, bool *whole,
                              stance_message *message)
{
    const struct plan *plan = store->plan;
    uint32_t crc = 0, expected = 0;
    size_t widest = 1;
    for (int v = 0; v < TRAJECTORIES; v++) {
        size_t width = store_trajectory_width(plan->scenario->scene, v);
        widest = width > widest ? width : widest;
    }
    double *data = malloc((size_t)plan->record_rows * widest * sizeof *data);
    if (!data) {
        snprintf(message->text, sizeof message->text, "not enough memory");
        return false;
    }
    bool good = true;
    for (int v = 0; good && v < TRAJECTORIES; v++) {
        if (store->trajectory[v] >= 0) {
            size_t elements =
                (size_t)plan->record_rows * store_trajectory_width(plan->scenario->scene, v);
            good = store_move_place(store->trajectory[v], KIND_double, place, elements, STORE_READ,
                                    data);
            crc = checksum_crc32c(crc, data, elements * sizeof *data);
        }
    }
    free(data);
    good = good && store_move_place(store->trajectory_checksum, KIND_uint32_t, place, 1, STORE_READ,
                                    &expected);
    *whole = crc == expected;
    return good || store_failed(message, store->file, "read a trajectory");
}

bool store_verify(struct store *store, const struct rows *rows, stance_result *results, bool *whole,
                  stance_message *message)
{
    if (!store->checked && !(store->checked = store_block_make(store, STORE_ROWS))) {
        snprintf(message->text, sizeof message->text, "not enough memory");
        return false;
    }
    if (!store_move_rows(store, store->checked, 0, rows, STORE_READ, message))
        return false;
    const uint8_t *status = store->checked->column[COLUMN_STATUS];
    const uint8_t *outcome = store->checked->column[STANCE_ANSWER_outcome];
    const uint32_t *checksum = store->checked->column[COLUMN_CHECKSUM];
    for (size_t row = 0; row < rows->count; row++) {
        uint64_t place;
        whole[row] = (status[row] == STANCE_DONE || status[row] == STANCE_FAILED) &&
                     checksum[row] == store_row_checksum(store->checked, row);
        if (whole[row] && plan_recorded(store->plan, rows_at(rows, row), &place) &&
            !verify_trajectory(store, place, &whole[row], message))
            return false;
        results[row].status = status[row];
        results[row].outcome = outcome ? outcome[row] : STANCE_NONE;
    }
    return true;
}

/* ---- designs and timing ------------------------------------------------------------------- */

bool store_read_designs(struct store *store, struct plan *plan, stance_message *message)
{
    struct store_design_column columns[DESIGN_COLUMNS];
    bool good = true;
    store_design_columns(plan->scenario, columns);
    for (int k = 0; k < DESIGN_COLUMNS; k++) { /* all of them, even when this rank has failed */
        size_t rows = (size_t)columns[k].rows, length = (size_t)columns[k].columns;
        if (rows * length == 0)
            continue;
        char name[64];
        snprintf(name, sizeof name, "design/%s", columns[k].name);
        double *data = malloc(plan->designs * rows * length * sizeof *data);
        hid_t dataset = open_dataset(store, name);
        good = data && dataset >= 0 &&
               H5Dread(dataset, store_memory_type(KIND_double), H5S_ALL, H5S_ALL, H5P_DEFAULT,
                       data) >= 0 &&
               good;
        for (size_t d = 0; good && d < plan->designs; d++) {
            char *design = (char *)&plan->design[d] + columns[k].offset;
            for (size_t r = 0; r < rows; r++) {
                memcpy((double *)(void *)design + r * (size_t)columns[k].stride,
                       data + (d * rows + r) * length, length * sizeof *data);
            }
        }
        H5Dclose(dataset);
        free(data);
    }
    hid_t dataset = open_dataset(store, "design/status");
    good = good && H5Dread(dataset, store_memory_type(KIND_uint8_t), H5S_ALL, H5S_ALL, H5P_DEFAULT,
                           plan->design_status) >= 0;
    H5Dclose(dataset);
    return good || store_failed(message, store->file, "read the designs");
}

bool store_add_timing(struct store *store, int ranks, const double *wall_time, const int64_t *cases,
                      stance_message *message)
{
    hid_t wall = H5Dopen2(store->id, "timing/wall_time", H5P_DEFAULT);
    hid_t drawn = H5Dopen2(store->id, "timing/cases", H5P_DEFAULT), space = H5Dget_space(wall);
    hssize_t length = H5Sget_simple_extent_npoints(space);
    double *total = length > 0 ? calloc((size_t)length, sizeof *total) : NULL;
    int64_t *sum = length > 0 ? calloc((size_t)length, sizeof *sum) : NULL;
    bool good =
        total && sum &&
        H5Dread(wall, store_memory_type(KIND_double), H5S_ALL, H5S_ALL, H5P_DEFAULT, total) >= 0 &&
        H5Dread(drawn, store_memory_type(KIND_int64_t), H5S_ALL, H5S_ALL, H5P_DEFAULT, sum) >= 0;
    for (int rank = 0; good && rank < ranks; rank++) {
        total[rank % length] += wall_time[rank];
        sum[rank % length] += cases[rank];
    }
    good =
        good &&
        H5Dwrite(wall, store_memory_type(KIND_double), H5S_ALL, H5S_ALL, H5P_DEFAULT, total) >= 0 &&
        H5Dwrite(drawn, store_memory_type(KIND_int64_t), H5S_ALL, H5S_ALL, H5P_DEFAULT, sum) >= 0;
    free(total);
    free(sum);
    H5Sclose(space);
    H5Dclose(wall);
    H5Dclose(drawn);
    return good || store_failed(message, store->file, "write the timing");
}
