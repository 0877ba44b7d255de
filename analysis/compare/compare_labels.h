/* compare_labels.h - whether two results files label their cases alike, and where they do not.
 *
 * A label is the outcome of a case, or that it failed. How a label came about does not matter: maps
 * of two methods, or a refined map and a full one, are compared by what they look like.
 */
#ifndef STANCE_COMPARE_COMPARE_LABELS_H
#define STANCE_COMPARE_COMPARE_LABELS_H

#include "analysis/statistics/intervals.h"
#include "analysis/table/table.h"

/* Prints it, with the domain of an outcome (RESULTS_KIND_COUNT: what is judged by). Returns the
 * command's exit code, with a line in *message unless the output fails. */
int compare_labels(const struct results r[2], enum results_kind of, enum table_form form,
                   stance_message *message);

/* The share of the domain of the first file that the second one has lost, at 95 %, of a sample;
 * else NAN. False: no memory. */
bool compare_lost(struct interval *share, const struct results r[2], enum results_kind of);

/* Coordinates of a case as {path: value}. */
json_t *compare_point(const struct results *r, uint64_t index);
/* Both texts of a place. */
#define COMPARE_VALUES "{values/0} \\| {values/1}\n"

#endif
