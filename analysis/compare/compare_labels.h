/* compare_labels.h - whether two results files label their cases alike, and where they do not.
 *
 * A label is the outcome of a case, or that it failed. How a label came about does not matter: maps
 * of two methods, or a refined map and a full one, are compared by what they look like.
 */
#ifndef STANCE_COMPARE_COMPARE_LABELS_H
#define STANCE_COMPARE_COMPARE_LABELS_H

#include "runner/store/results.h"

enum { LABELS_SHOWN = 3 };

struct label_comparison {
    uint64_t compared, equal; /* cases that are pending in neither file */
    /* Chebyshev distance from an unequal case to the nearest one of another label than its own in
     * the first file, along the refined axes (without any: along all axes of numbers): 1 is beside
     * the boundary. 0: there is no unequal case, or no boundary. */
    uint64_t farthest;
    int shown;
    uint64_t place[LABELS_SHOWN]; /* the first unequal cases */
};

/* False: not over the same axes, or not enough memory. */
bool compare_labels(struct label_comparison *comparison, const struct results *first,
                    const struct results *second, stance_message *message);

#endif
