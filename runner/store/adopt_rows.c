/* adopt_rows.c - rows, trajectories and times of one results file into another, which is made. */
#include "adopt.h"
#include "store_private.h"

#include "runner/base/message.h"

#include <fcntl.h>
#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

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
    bool same = true;
    for (int c = 0; c < COLUMNS; c++)
        if (c != COLUMN_CHECKSUM && a->column[c] && b->column[c])
            same = same &&
                   memcmp(store_cell(a, c, slot), store_cell(b, c, slot), a->store->size[c]) == 0;
    return same;
}

/* A slot of one file's block into one of the other's. */
static void take_row(const struct store_block *from, size_t slot, struct store_block *to,
                     size_t to_slot)
{
    for (int c = 0; c < COLUMNS; c++) {
        const size_t size = to->store->size[c];
        void *const cell = to->column[c] ? store_cell(to, c, to_slot) : NULL;
        if (cell && from->column[c]) {
            memcpy(cell, store_cell(from, c, slot), size);
        } else if (cell) { /* scenario_number, or an answer that is not known there */
            memset(cell, 0, size);
            if (store_columns[c].kind == KIND_double)
                *(double *)cell = NAN;
            if (store_columns[c].kind == KIND_int64_t)
                *(int64_t *)cell = to->store->no_count;
        }
    }
    store_seal(to, to_slot);
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

/* Rows of one file on their way, and where they go in the other. */
struct moving {
    struct store *from, *to;
    uint64_t row[STORE_ROWS], aim[STORE_ROWS];
    struct adopted_rows *told;
    stance_message *message;
};

/* Whether the new file lacks nothing of a row that the old one has. */
static bool has_all(const struct moving *m, uint64_t row, uint64_t aim)
{
    const struct plan *const old = m->from->plan, *const new = m->to->plan;
    uint64_t place;
    return !plan_recorded(new, aim, &place) ||
           (plan_recorded(old, row, &place) && old->record_rows == new->record_rows);
}

/* Copies the first `count` rows, at least one, whose aims ascend. */
static bool copy_some(struct moving *m, size_t count)
{
    struct store_found found[STORE_ROWS], there[STORE_ROWS];
    struct adopted_rows *const told = m->told;
    uint64_t place, aim;
    size_t kept = 0;

    /* Both leave what they read in the files' own blocks. */
    if (!store_verify(m->from, &(struct rows){.row = m->row, .count = count}, found, m->message) ||
        !store_verify(m->to, &(struct rows){.row = m->aim, .count = count}, there, m->message))
        return false;
    translate(m->from->checked, m->to->no_count, count);
    for (size_t i = 0; i < count; i++) {
        if (!found[i].whole) {
            told->damaged++;
        } else if (!there[i].whole) {
            if (!has_all(m, m->row[i], m->aim[i]))
                continue;
            if (plan_recorded(m->from->plan, m->row[i], &place) &&
                plan_recorded(m->to->plan, m->aim[i], &aim) &&
                !copy_trajectory(m->from, place, m->to, aim, m->message))
                return false;
            m->aim[kept] = m->aim[i];
            take_row(m->from->checked, i, m->to->checked, kept++); /* kept <= i: not looked at */
        } else if (same_row(m->from->checked, m->to->checked, i)) {
            told->same++;
        } else if (told->conflicting++ == 0) {
            told->conflict = m->aim[i];
        }
    }
    told->copied += kept;
    return kept == 0 || store_write(m->to, m->to->checked, 0,
                                    &(struct rows){.row = m->aim, .count = kept}, m->message);
}

bool adopt_rows(const struct adopted *a, struct store *to, struct adopted_rows *told,
                stance_message *message)
{
    enum { PIECE = 1 << 14 };
    const struct plan *const plan = to->plan;
    const uint64_t all = a->plan.rows;
    struct moving m = {.from = a->store, .to = to, .told = told, .message = message};
    uint8_t status[PIECE]; /* of a shard few are not pending */
    size_t count = 0;
    bool good = true;
    for (uint64_t r = 0; good && r < all; r++) {
        if (r % PIECE == 0)
            good = hdf_move(m.from->column[COLUMN_STATUS], H5T_STD_U8LE, r,
                            all - r < PIECE ? all - r : PIECE, HDF_READ, status) ||
                   store_failed(message, m.from->file, "read the results");
        if (r % STORE_ROWS == 0 && plan->stop)
            told->stopped = plan->stop(plan->stop_context) && told->may_stop;
        if (told->stopped)
            return false;
        const uint64_t aim = adopt_row(a, r);
        if (!good || status[r % PIECE] == STANCE_PENDING)
            continue;
        /* Rows may come in another order than they go to. */
        if (count == STORE_ROWS || (count > 0 && aim <= m.aim[count - 1])) {
            good = copy_some(&m, count);
            count = 0;
        }
        m.aim[count] = aim;
        m.row[count++] = r;
    }
    return good && (count == 0 || copy_some(&m, count));
}

bool store_copy_timing(struct store *from, struct store *to, int *rank, stance_message *message)
{
    static const char *const names[] = {"timing/wall_time", "timing/cases"};
    bool good = true;
    size_t there = 0;
    for (int k = 0; good && k < 2; k++) {
        const hid_t source = H5Dopen2(from->id, names[k], H5P_DEFAULT);
        there = hdf_elements(source);
        double *const values = there > 0 ? malloc(there * sizeof *values) : NULL;
        good = values && hdf_read(source, KIND_double, values) &&
               store_add_times(to, names[k], (size_t)*rank, there, values);
        free(values);
        hdf_close(source);
    }
    *rank += (int)there;
    return good || store_failed(message, to->file, "copy the times");
}

bool store_annotate(struct store *store, const char *name, const char *text,
                    stance_message *message)
{
    return put_attribute(store->id, name, KIND_text, text) ||
           store_failed(message, store->file, "write an attribute");
}

/* ---- the file that takes them over ---------------------------------------------------------- */

/* What a file that is being made begins with, or nothing yet: whatever else has its name is
 * somebody's own. */
static bool is_ours(const char *file)
{
    static const char signature[8] = "\211HDF\r\n\032\n";
    char begin[sizeof signature] = {0};
    const int descriptor = open(file, O_RDONLY | O_NOFOLLOW | O_CLOEXEC);
    struct stat found;
    const bool regular =
        descriptor >= 0 && fstat(descriptor, &found) == 0 && S_ISREG(found.st_mode);
    const bool begun =
        regular && (found.st_size == 0 || (read(descriptor, begin, sizeof begin) == sizeof begin &&
                                           memcmp(begin, signature, sizeof begin) == 0));
    if (descriptor >= 0)
        close(descriptor);
    return begun;
}

enum { MADE = PATH_MAX + 8 };
static void name_next(char made[MADE], const char *file)
{
    snprintf(made, MADE, "%s.next", file);
}

void adopt_clear(const char *file)
{
    char real[PATH_MAX], made[MADE];
    name_next(made, realpath(file, real) ? real : file);
    if (is_ours(made))
        unlink(made);
}

bool adopt_make(const char *file, const struct plan *plan, const struct adopted_filling *filling,
                stance_message *message)
{
    char made[MADE];
    struct store *store = NULL;
    name_next(made, file);
    if (is_ours(made)) /* of an attempt that was killed */
        unlink(made);
    if (!store_create(made, plan, filling->before, filling->ranks, filling->hosts, message))
        return false;
    bool good = store_open(&store, made, plan, NULL, message) &&
                filling->fill(filling->context, store, message);
    if (good)
        good = store_close(store, message);
    else
        store_abandon(store);
    good = good && store_take_place(made, file, message);
    if (!good)
        unlink(made);
    return good;
}
