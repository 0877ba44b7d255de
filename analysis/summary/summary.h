/* summary.h - what `stance summary` says of a results file: facts (runner/base/say.h). */
#ifndef STANCE_SUMMARY_SUMMARY_H
#define STANCE_SUMMARY_SUMMARY_H

#include "analysis/statistics/intervals.h"
#include "analysis/table/table.h"

/* What the cases of a file are judged by, as its scenario says: WALKS with stop.walks, RESTED where
 * no controller has a target, else STABILISED. */
enum results_kind summary_judged(const struct results *r);

/* The file, read once. */
struct summary {
    const struct results *r;
    enum results_kind judged;
    bool known; /* outcomes are stored, or no case is done */
    struct statistics_counts counts;
    struct interval share; /* of those judged by */
    json_t *facts;
    stance_message *message;
};

/* Each adds facts; false: one line in the message. */
bool summary_head(const struct summary *summary);
bool summary_fields(const struct summary *summary);
bool summary_outcomes(struct summary *summary);
bool summary_case(const struct summary *summary);
/* What varies; as CSV, too. */
bool summary_sweep(const struct summary *summary, struct table *csv);
bool summary_numbers(const struct summary *summary);
bool summary_cost(const struct summary *summary);

/* The counts of a row, and their share with its interval. */
void summary_add_counts(struct table *t, const struct summary *summary,
                        const struct statistics_counts *counts, const struct interval *interval);
/* Share of the cases of the kind judged by among those done; NAN when there are none. */
double summary_share(const struct summary *summary, const struct statistics_counts *counts);

#endif
