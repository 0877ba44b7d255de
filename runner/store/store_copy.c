/* store_copy.c - rows, trajectories and times of one results file into another. */
#include "store_make.h"

#include <stdlib.h>
#include <string.h>

static bool no_memory(stance_message *message)
{
    snprintf(message->text, sizeof message->text, "not enough memory");
    return false;
}

static bool is_finished(const struct store_block *block, size_t slot)
{
    const uint8_t status = ((const uint8_t *)block->column[COLUMN_STATUS])[slot];
    return status == STANCE_DONE || status == STANCE_FAILED;
}

static bool same_row(const struct store_block *a, const struct store_block *b, size_t slot)
{
    for (int c = 0; c < COLUMNS; c++) {
        const size_t size = a->store->width[c] * store_columns[c].size;
        if (a->column[c] && memcmp((const char *)a->column[c] + slot * size,
                                   (const char *)b->column[c] + slot * size, size) != 0)
            return false;
    }
    return true;
}

/* A slot of one file's block into one of the other's. */
static void take_row(const struct store_block *from, size_t slot, struct store_block *to,
                     size_t to_slot)
{
    for (int c = 0; c < COLUMNS; c++) {
        const size_t size = to->store->width[c] * store_columns[c].size;
        if (to->column[c] && from->column[c]) {
            memcpy((char *)to->column[c] + to_slot * size,
                   (const char *)from->column[c] + slot * size, size);
        } else if (to->column[c]) { /* scenario_number */
            memset((char *)to->column[c] + to_slot * size, 0, size);
        }
    }
    ((uint32_t *)to->column[COLUMN_CHECKSUM])[to_slot] = store_row_checksum(to, to_slot);
}

/* The trajectory at one place of a file to a place of another, as it is, checksum included. */
static bool copy_trajectory(struct store *from, uint64_t place, struct store *to, uint64_t to_place,
                            stance_message *message)
{
    const struct plan *plan = from->plan;
    uint32_t checksum = 0;
    bool good = true;
    for (int v = 0; good && v < TRAJECTORIES; v++) {
        const size_t elements =
            (size_t)plan->record_rows * store_trajectory_width(plan->scenario->scene, v);
        double *data = from->trajectory[v] < 0 ? NULL : malloc(elements * sizeof *data);
        if (from->trajectory[v] < 0)
            continue;
        if (!data)
            return no_memory(message);
        good = (store_move_place(from->trajectory[v], KIND_double, place, elements, STORE_READ,
                                 data) ||
                store_failed(message, from->file, "read a trajectory")) &&
               (store_move_place(to->trajectory[v], KIND_double, to_place, elements, STORE_WRITE,
                                 data) ||
                store_failed(message, to->file, "write a trajectory"));
        free(data);
    }
    return good &&
           (store_move_place(from->trajectory_checksum, KIND_uint32_t, place, 1, STORE_READ,
                             &checksum) ||
            store_failed(message, from->file, "read a trajectory")) &&
           (store_move_place(to->trajectory_checksum, KIND_uint32_t, to_place, 1, STORE_WRITE,
                             &checksum) ||
            store_failed(message, to->file, "write a trajectory"));
}

/* Which of the rows read into both files' blocks are to be written. */
static void choose_rows(struct store *from, struct store *to, const uint64_t *target, size_t count,
                        const bool *whole, const bool *there, bool *wanted,
                        struct store_copied *copied)
{
    for (size_t i = 0; i < count; i++) {
        wanted[i] = whole[i] && !there[i];
        if (!whole[i]) {
            copied->damaged += is_finished(from->checked, i);
            copied->pending += !is_finished(from->checked, i) && !there[i];
        } else if (!there[i]) {
            copied->copied++;
        } else if (same_row(from->checked, to->checked, i)) {
            copied->same++;
        } else {
            copied->conflict = copied->conflicting == 0 ? target[i] : copied->conflict;
            copied->conflicting++;
        }
    }
}

bool store_copy(struct store *from, const struct rows *rows, struct store *to,
                const uint64_t *target, struct store_copied *copied, stance_message *message)
{
    bool whole[STORE_ROWS], there[STORE_ROWS], wanted[STORE_ROWS];
    uint64_t kept[STORE_ROWS], place, to_place;
    const struct rows aims = {target, rows->count, 0};
    stance_result *results = malloc(STORE_ROWS * sizeof *results);
    size_t count = 0;

    bool good = results || no_memory(message);
    /* Both leave what they read in the files' own blocks. */
    good = good && store_verify(from, rows, results, whole, message) &&
           store_verify(to, &aims, results, there, message);
    free(results);
    if (!good)
        return false;
    choose_rows(from, to, target, (size_t)rows->count, whole, there, wanted, copied);
    for (size_t i = 0; i < rows->count; i++) {
        if (!wanted[i])
            continue;
        if (plan_recorded(from->plan, rows_at(rows, i), &place) &&
            plan_recorded(to->plan, target[i], &to_place) &&
            !copy_trajectory(from, place, to, to_place, message))
            return false;
        kept[count] = target[i];
        take_row(from->checked, i, to->checked, count++); /* count <= i: a slot already looked at */
    }
    const struct rows written = {kept, count, 0};
    return count == 0 || store_write(to, to->checked, 0, &written, message);
}

bool store_copy_timing(struct store *from, struct store *to, int *rank, stance_message *message)
{
    static const char *const names[] = {"timing/wall_time", "timing/cases"};
    hsize_t count = 0, start = (hsize_t)*rank;
    bool good = true;
    for (int k = 0; good && k < 2; k++) {
        hid_t source = H5Dopen2(from->id, names[k], H5P_DEFAULT),
              target = H5Dopen2(to->id, names[k], H5P_DEFAULT);
        hid_t all = H5Dget_space(source), part = H5Dget_space(target);
        const hssize_t there = H5Sget_simple_extent_npoints(all),
                       room = H5Sget_simple_extent_npoints(part) - *rank;
        /* Numbers of both kinds are eight bytes long. */
        const hid_t type = store_memory_type(k == 0 ? KIND_double : KIND_int64_t);
        double *values = there > 0 ? calloc((size_t)there, sizeof *values) : NULL;
        count = there < room ? (hsize_t)there : room > 0 ? (hsize_t)room : 0;
        hid_t memory = H5Screate_simple(1, &count, NULL);
        good = values && H5Dread(source, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) >= 0 &&
               (count == 0 ||
                (H5Sselect_hyperslab(part, H5S_SELECT_SET, &start, NULL, &count, NULL) >= 0 &&
                 H5Dwrite(target, type, memory, part, H5P_DEFAULT, values) >= 0));
        free(values);
        H5Sclose(memory);
        H5Sclose(all);
        H5Sclose(part);
        H5Dclose(source);
        H5Dclose(target);
    }
    *rank += (int)count;
    return good || store_failed(message, to->file, "copy the times");
}

bool store_annotate(struct store *store, const char *name, const char *text,
                    stance_message *message)
{
    return put_text(store->id, name, text) ||
           store_failed(message, store->file, "write an attribute");
}
