/* refinement_run.c - ask what to simulate, compute it together, tell all ranks the labels, ask
 * again. */
#include "work.h"

#include "runner/base/message.h"
#include "runner/plan/refine.h"

#include <stdlib.h>
#include <string.h>

enum { ROUND_LARGEST = 1 << 20, INFER_ROWS = 1 << 12 };

_Static_assert((int)REFINE_FAILED == (int)WORK_FAILED, "labels of work.h are refine.h's");

struct refinement {
    struct work *work;
    struct refine *refine;
    uint64_t *row;
    uint8_t *label;            /* [ROUND_LARGEST] each */
    struct store_block *block; /* [INFER_ROWS] */
};

static bool refinement_make(struct refinement *refinement, struct work *work)
{
    const struct scenario *s = work->plan->scenario;
    const struct refine_map map = refine_map_of(s);
    *refinement = (struct refinement){.work = work, .refine = refine_make(&map)};
    refinement->row = malloc(ROUND_LARGEST * sizeof *refinement->row);
    refinement->label = malloc(ROUND_LARGEST);
    refinement->block = store_block_make(work->store, INFER_ROWS);
    for (uint64_t k = 0; refinement->refine && k < work->plan->record_cases; k++)
        refine_want(refinement->refine, plan_recorded_case(work->plan, k));
    return refinement->refine && refinement->row && refinement->label && refinement->block;
}

/* *complete: there was nothing left to simulate. *stopped: some of the round was not. */
static bool run_round(struct refinement *refinement, bool *complete, bool *stopped,
                      stance_message *message)
{
    struct work *work = refinement->work;
    const struct rows rows = {
        .row = refinement->row,
        .count = refine_next(refinement->refine, refinement->row, ROUND_LARGEST),
    };

    *complete = rows.count == 0;
    if (*complete)
        return true;
    memset(refinement->label, 0, rows.count);
    work->round++;
    parallel_restart(work->parallel);
    bool good = work_run(work, &rows, refinement->label, message);
    if (!parallel_agree(work->parallel, good, message->text, sizeof message->text))
        return false;
    parallel_largest(work->parallel, refinement->label, rows.count);
    for (size_t k = 0; k < rows.count; k++) {
        *stopped = *stopped || refinement->label[k] == REFINE_UNKNOWN;
        if (!*stopped)
            refine_set(refinement->refine, refinement->row[k], refinement->label[k]);
    }
    return true;
}

/* ---- what is inferred --------------------------------------------------------------------- */

/* Whether the file holds all of these rows already, as a resumed run may find; what is damaged is
 * counted. */
static bool are_stored(struct refinement *refinement, const struct rows *list, bool *stored,
                       stance_message *message)
{
    struct store_found found[STORE_ROWS];

    *stored = refinement->work->resume;
    for (uint64_t at = 0, n; refinement->work->resume && at < list->count; at += n) {
        n = list->count - at < STORE_ROWS ? list->count - at : STORE_ROWS;
        const struct rows rows = rows_part(list, at, n);
        if (!work_verify(refinement->work, &rows, found, message))
            return false;
        for (uint64_t i = 0; i < n; i++) {
            const int label = refine_label(refinement->refine, rows_at(&rows, i));
            *stored = *stored && found[i].whole && found[i].outcome == label - 1;
        }
    }
    return true;
}

/* Writes the inferred rows of this rank's part of the file, INFER_ROWS at a time. */
static bool write_inferred(struct refinement *refinement, stance_message *message)
{
    struct work *work = refinement->work;
    const uint64_t rows = work->plan->rows;
    const uint64_t ranks = (uint64_t)work->parallel->size, rank = (uint64_t)work->parallel->rank;
    const uint64_t end = rows / ranks * (rank + 1) + rows % ranks * (rank + 1) / ranks;
    struct rows list = {.row = refinement->row};

    for (uint64_t row = rows / ranks * rank + rows % ranks * rank / ranks; row < end; row++) {
        if (refine_inferred(refinement->refine, row)) {
            stance_result result;
            stance_result_clear(&result);
            result.status = STANCE_DONE;
            result.outcome = refine_label(refinement->refine, row) - 1;
            result.evidence = STANCE_INFERRED;
            store_put(refinement->block, (size_t)list.count, &result);
            refinement->row[list.count++] = row;
        }
        if (list.count == 0 || (list.count < INFER_ROWS && row + 1 < end))
            continue;
        if (work_told_to_stop(work))
            return true;
        bool stored;
        if (!are_stored(refinement, &list, &stored, message) ||
            (!stored && !store_write(work->store, refinement->block, 0, &list, message)))
            return false;
        for (size_t k = 0; k < list.count; k++) {
            const int label = refine_label(refinement->refine, list.row[k]);
            work_tally(work, STANCE_DONE, (stance_outcome)(label - 1));
        }
        work->sums.inferred += list.count;
        list.count = 0;
    }
    return true;
}

bool refinement_run(struct work *work, stance_message *message)
{
    struct refinement refinement;
    bool complete = false, stopped = false, made = refinement_make(&refinement, work);

    if (!made) {
        complain(message, "not enough memory to refine %llu cases",
                 (unsigned long long)work->plan->rows);
    }
    bool good = parallel_agree(work->parallel, made, message->text, sizeof message->text) && made;
    while (good && !complete && !stopped)
        good = run_round(&refinement, &complete, &stopped, message);
    if (good && complete) {
        refine_infer(refinement.refine);
        good = write_inferred(&refinement, message);
    }
    refine_free(refinement.refine);
    free(refinement.row);
    free(refinement.label);
    free(refinement.block);
    return good;
}
