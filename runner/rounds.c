/* rounds.c - ask what to simulate, compute it together, tell all ranks the labels, ask again. */
#include "rounds.h"

#include "refine.h"

#include <stdlib.h>
#include <string.h>

enum { ROUND_LARGEST = 1 << 20, INFER_ROWS = 1 << 12 };

_Static_assert((int)REFINE_FAILED == (int)WORK_FAILED, "labels of work.h are refine.h's");

struct rounds {
    struct work *work;
    struct refine *refine;
    uint64_t *row;
    uint8_t *label;            /* [ROUND_LARGEST] each */
    struct store_block *block; /* [INFER_ROWS] */
};

static bool rounds_make(struct rounds *rounds, struct work *work)
{
    const struct scenario *s = work->plan->scenario;
    const struct refine_map map = refine_map_of(s);
    *rounds = (struct rounds){.work = work, .refine = refine_make(&map)};
    rounds->row = malloc(ROUND_LARGEST * sizeof *rounds->row);
    rounds->label = malloc(ROUND_LARGEST);
    rounds->block = store_block_make(work->store, INFER_ROWS);
    for (uint64_t k = 0; rounds->refine && k < work->plan->record_cases; k++) {
        refine_want(rounds->refine, plan_recorded_case(work->plan, k));
    }
    return rounds->refine && rounds->row && rounds->label && rounds->block;
}

static void rounds_free(struct rounds *rounds)
{
    refine_free(rounds->refine);
    free(rounds->row);
    free(rounds->label);
    store_block_free(rounds->block);
}

/* *complete: there was nothing left to simulate. *stopped: some of the round was not. */
static bool run_round(struct rounds *rounds, bool *complete, bool *stopped, stance_message *message)
{
    struct work *work = rounds->work;
    const struct rows rows = {
        .row = rounds->row,
        .count = refine_next(rounds->refine, rounds->row, ROUND_LARGEST),
    };

    *complete = rows.count == 0;
    if (*complete) {
        return true;
    }
    memset(rounds->label, 0, rows.count);
    work->round++;
    parallel_restart(work->parallel);
    bool good = work_run(work, &rows, rounds->label, message);
    if (!parallel_agree(work->parallel, good, message->text, sizeof message->text)) {
        return false;
    }
    parallel_largest(work->parallel, rounds->label, rows.count);
    for (size_t k = 0; k < rows.count; k++) {
        *stopped = *stopped || rounds->label[k] == REFINE_UNKNOWN;
        if (!*stopped) {
            refine_set(rounds->refine, rounds->row[k], rounds->label[k]);
        }
    }
    return true;
}

/* ---- what is inferred --------------------------------------------------------------------- */

static void infer(struct store_block *block, size_t slot, int label)
{
    stance_result result;
    store_blank(&result);
    result.status = STANCE_DONE;
    result.outcome = label - 1;
    result.evidence = STANCE_INFERRED;
    store_put(block, slot, &result);
}

/* Whether the file holds all of these rows already, as a resumed run may find; what is damaged is
 * counted. */
static bool are_stored(struct rounds *rounds, const struct rows *list, bool *stored,
                       stance_message *message)
{
    stance_result results[STORE_ROWS];
    bool whole[STORE_ROWS];

    *stored = rounds->work->resume;
    for (uint64_t at = 0, n; rounds->work->resume && at < list->count; at += n) {
        n = list->count - at < STORE_ROWS ? list->count - at : STORE_ROWS;
        const struct rows rows = rows_part(list, at, n);
        if (!work_verify(rounds->work, &rows, results, whole, message)) {
            return false;
        }
        for (uint64_t i = 0; i < n; i++) {
            const int label = refine_label(rounds->refine, rows_at(&rows, i));
            *stored = *stored && whole[i] && (int)results[i].outcome == label - 1;
        }
    }
    return true;
}

/* Writes the inferred rows of this rank's part of the file, INFER_ROWS at a time. */
static bool write_inferred(struct rounds *rounds, stance_message *message)
{
    struct work *work = rounds->work;
    const uint64_t rows = work->plan->rows;
    const uint64_t ranks = (uint64_t)work->parallel->size, rank = (uint64_t)work->parallel->rank;
    const uint64_t end = rows / ranks * (rank + 1) + rows % ranks * (rank + 1) / ranks;
    struct rows list = {.row = rounds->row};

    for (uint64_t row = rows / ranks * rank + rows % ranks * rank / ranks; row < end; row++) {
        if (refine_inferred(rounds->refine, row)) {
            infer(rounds->block, (size_t)list.count, refine_label(rounds->refine, row));
            rounds->row[list.count++] = row;
        }
        if (list.count == 0 || (list.count < INFER_ROWS && row + 1 < end)) {
            continue;
        }
        if (work_told_to_stop(work)) {
            return true;
        }
        bool stored;
        if (!are_stored(rounds, &list, &stored, message) ||
            (!stored && !store_write(work->store, rounds->block, 0, &list, message))) {
            return false;
        }
        for (size_t k = 0; k < list.count; k++) {
            const int label = refine_label(rounds->refine, list.row[k]);
            work_tally(work, STANCE_DONE, (stance_outcome)(label - 1));
        }
        work->inferred += list.count;
        list.count = 0;
    }
    return true;
}

bool rounds_run(struct work *work, stance_message *message)
{
    struct rounds rounds;
    bool complete = false, stopped = false, made = rounds_make(&rounds, work);

    if (!made) {
        snprintf(message->text, sizeof message->text, "not enough memory to refine %llu cases",
                 (unsigned long long)work->plan->rows);
    }
    bool good = parallel_agree(work->parallel, made, message->text, sizeof message->text) && made;
    while (good && !complete && !stopped) {
        good = run_round(&rounds, &complete, &stopped, message);
    }
    if (good && complete) {
        refine_infer(rounds.refine);
        good = write_inferred(&rounds, message);
    }
    rounds_free(&rounds);
    return good;
}
