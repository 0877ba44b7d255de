/* store_copy.c - rows, trajectories and times of one results file into another. */
#include "store_private.h"

#include "runner/base/message.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* What earlier versions wrote where there was no count is one, too: such a row tells by its end,
 * which a case that was inferred from its neighbours does not have. */
static bool has_counts(const struct store_block *block, size_t slot)
{
    const double *const end = block->column[STANCE_ANSWER_end_time];
    const uint8_t *const evidence = block->column[STANCE_ANSWER_evidence];
    return end ? isfinite(end[slot]) : !evidence || evidence[slot] != STANCE_INFERRED;
}

/* Rows of one file as the other says that there is no count. */
static void translate(struct store_block *block, int64_t no_count, size_t rows)
{
    const int64_t old = block->store->no_count;
    for (int c = 0; c < COLUMNS && old != no_count; c++) {
        int64_t *const count = block->column[c];
        for (size_t i = 0; count && store_columns[c].kind == KIND_int64_t && i < rows; i++)
            if (count[i] == old && (old == STANCE_NO_COUNT || !has_counts(block, i)))
                count[i] = no_count;
    }
}

/* Checksums, which verify, say no more: what they are over may be said differently. */
static bool same_row(const struct store_block *a, const struct store_block *b, size_t slot)
{
    for (int c = 0; c < COLUMNS; c++) {
        const size_t size = a->store->size[c];
        if (c == COLUMN_CHECKSUM)
            continue;
        if (a->column[c] && b->column[c] &&
            memcmp((const char *)a->column[c] + slot * size,
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
        const size_t size = to->store->size[c];
        if (to->column[c] && from->column[c]) {
            memcpy((char *)to->column[c] + to_slot * size,
                   (const char *)from->column[c] + slot * size, size);
        } else if (to->column[c]) { /* scenario_number, or an answer that is not known there */
            memset((char *)to->column[c] + to_slot * size, 0, size);
            if (store_columns[c].kind == KIND_double)
                ((double *)to->column[c])[to_slot] = NAN;
            if (store_columns[c].kind == KIND_int64_t)
                ((int64_t *)to->column[c])[to_slot] = to->store->no_count;
        }
    }
    ((uint32_t *)to->column[COLUMN_CHECKSUM])[to_slot] = store_row_checksum(to, to_slot);
}

/* The trajectory at one place of a file, which verifies, to a place of another. */
static bool copy_trajectory(struct store *from, uint64_t place, struct store *to, uint64_t to_place,
                            stance_message *message)
{
    stance_trajectory data = {0};
    uint32_t crc, stored = 0;
    if (!store_blank_trajectory(from, &data))
        return no_memory(message);
    const bool good = (store_move_trajectory(from, place, HDF_READ, &data, &crc, &stored) ||
                       store_failed(message, from->file, "read a trajectory")) &&
                      (store_move_trajectory(to, to_place, HDF_WRITE, &data, &crc, &stored) ||
                       store_failed(message, to->file, "write a trajectory"));
    free(data.position);
    return good;
}

/* Which of the rows read into both files' blocks are to be written. */
static void choose_rows(struct store *from, struct store *to, const uint64_t *target, size_t count,
                        const bool *whole, const bool *there, bool *wanted,
                        struct store_copied *copied)
{
    const uint8_t *const status = from->checked->column[COLUMN_STATUS];
    for (size_t i = 0; i < count; i++) {
        wanted[i] = whole[i] && !there[i];
        if (!whole[i]) {
            copied->damaged += status[i] == STANCE_DONE || status[i] == STANCE_FAILED;
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

/* Copies 1 to STORE_ROWS rows to the rows target[rows->count] (ascending). */
static bool copy_some(struct store *from, const struct rows *rows, struct store *to,
                      const uint64_t *target, struct store_copied *copied, stance_message *message)
{
    bool whole[STORE_ROWS], there[STORE_ROWS], wanted[STORE_ROWS];
    uint64_t kept[STORE_ROWS], place, to_place;
    const struct rows aims = {.row = target, .count = rows->count};
    stance_result *results = malloc(STORE_ROWS * sizeof *results);
    size_t count = 0;

    bool good = results || no_memory(message);
    /* Both leave what they read in the files' own blocks. */
    good = good && store_verify(from, rows, results, whole, message) &&
           store_verify(to, &aims, results, there, message);
    free(results);
    if (!good)
        return false;
    translate(from->checked, to->no_count, (size_t)rows->count);
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
    const struct rows written = {.row = kept, .count = count};
    return count == 0 || store_write(to, to->checked, 0, &written, message);
}

bool store_copy(struct store *from, struct store *to,
                uint64_t (*target)(void *context, uint64_t row), void *context,
                struct store_copied *copied, stance_message *message)
{
    enum { PIECE = 1 << 16 };
    const uint64_t all = from->plan->rows;
    uint64_t row[STORE_ROWS], aim[STORE_ROWS];
    struct rows rows = {.row = row};
    uint8_t *const status = malloc(PIECE); /* of a shard few are not pending */
    bool good = status || no_memory(message);
    for (uint64_t r = 0; good && r < all; r++) {
        if (r % PIECE == 0)
            good = hdf_move(from->column[COLUMN_STATUS], H5T_STD_U8LE, r,
                            all - r < PIECE ? all - r : PIECE, HDF_READ, status) ||
                   store_failed(message, from->file, "read the results");
        const uint64_t to_row = target(context, r);
        if (!good || to_row == STORE_NOWHERE || status[r % PIECE] == STANCE_PENDING)
            continue;
        /* Targets ascend within a call: rows may come in another order than they go to. */
        if (rows.count == STORE_ROWS || (rows.count > 0 && to_row <= aim[rows.count - 1])) {
            good = copy_some(from, &rows, to, aim, copied, message);
            rows.count = 0;
        }
        aim[rows.count] = to_row;
        row[rows.count++] = r;
    }
    free(status);
    return good && (rows.count == 0 || copy_some(from, &rows, to, aim, copied, message));
}

/* The times of one file to as many places of the other, which has none yet, from `rank` on, as it
 * has for them. */
static bool copy_times(struct store *from, struct store *to, const char *name, int rank,
                       size_t *count)
{
    const hid_t source = H5Dopen2(from->id, name, H5P_DEFAULT),
                target = H5Dopen2(to->id, name, H5P_DEFAULT);
    const size_t there = hdf_elements(source), room = hdf_elements(target);
    const size_t left = room > (size_t)rank ? room - (size_t)rank : 0;
    double *values = there > 0 ? calloc(there, sizeof *values) : NULL;
    *count = there < left ? there : left;
    const bool good = values && hdf_read(source, KIND_double, values) &&
                      store_add_times(to, name, (size_t)rank, *count, values);
    free(values);
    hdf_close(source, target);
    return good;
}

bool store_copy_timing(struct store *from, struct store *to, int *rank, stance_message *message)
{
    size_t count;
    if (!copy_times(from, to, "timing/wall_time", *rank, &count) ||
        !copy_times(from, to, "timing/cases", *rank, &count))
        return store_failed(message, to->file, "copy the times");
    *rank += (int)count;
    return true;
}

bool store_annotate(struct store *store, const char *name, const char *text,
                    stance_message *message)
{
    return put_attribute(store->id, name, KIND_text, text) ||
           store_failed(message, store->file, "write an attribute");
}
