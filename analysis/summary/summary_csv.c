/* summary_csv.c - the counts of a summary as a table for other programs. */
#include "summary.h"

#include "analysis/table/csv.h"

#include <math.h>

static void put_counts(struct csv *csv, const struct summary *summary,
                       const struct statistics_counts *counts, const struct interval *interval)
{
    const bool known = counts->done > 0 && summary_has_outcomes(summary);
    csv_number(csv, (double)counts->done);
    csv_number(csv, (double)counts->kind[RESULTS_FAILED]);
    csv_number(csv, (double)counts->kind[RESULTS_PENDING]);
    for (int k = 0; k < RESULTS_OUTCOMES; k++)
        csv_number(csv, (double)counts->kind[k]);
    csv_number(csv, known ? summary_share(summary, counts) : NAN);
    csv_number(csv, known ? interval->low : NAN);
    csv_number(csv, known ? interval->high : NAN);
    csv_end_row(csv);
}

void summary_print_csv(const struct summary *summary, const struct results *r)
{
#define OUTCOME_NAME(NAME, name, number, text) #name,
    static const char *const head[] = {
        "parameter", "value", "done", "failed", "pending", STANCE_OUTCOMES(OUTCOME_NAME) "share",
        "low",       "high"};
    struct csv csv = {.file = stdout};
    csv_row(&csv, head, sizeof head / sizeof head[0]);
    csv_text(&csv, "");
    csv_text(&csv, "");
    put_counts(&csv, summary, &summary->counts, &summary->of_kind[summary->judged]);
    for (int a = 0; a < r->axes; a++) {
        const struct results_axis *axis = &r->axis[a];
        for (size_t i = 0; summary->by_value[a] && i < axis->count; i++) {
            csv_text(&csv, axis->name);
            if (axis->word)
                csv_text(&csv, axis->word[i]);
            else
                csv_number(&csv, axis->value[i]);
            put_counts(&csv, summary, &summary->by_value[a][i], &summary->interval[a][i]);
        }
    }
}
