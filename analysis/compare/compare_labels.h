/* compare_labels.h - whether two results files label their cases alike, and where they do not.
 *
 * A label is the outcome of a case, or that it failed. How a label came about does not matter: maps
 * of two methods, or a refined map and a full one, are compared by what they look like.
 */
#ifndef STANCE_COMPARE_COMPARE_LABELS_H
#define STANCE_COMPARE_COMPARE_LABELS_H

#include "analysis/statistics/intervals.h"

enum { LABELS_SHOWN = 3 };

struct label_comparison {
    uint64_t compared, equal; /* cases that are pending in neither file */
    /* Chebyshev distance from an unequal case to the nearest one of another label than its own in
     * the first file, along the refined axes (without any: along all axes of numbers): 1 is beside
     * the boundary. 0: there is no unequal case, or no boundary. */
    uint64_t farthest;
    /* Of those compared, by the label in the first file and that in the second. */
    uint64_t cases[RESULTS_KIND_COUNT][RESULTS_KIND_COUNT];
    enum results_kind of; /* the domain that is looked at */
    uint64_t kept, won,
        lost; /* cases in the domain of both, of the second and of the first alone */
    /* Of the share of the first domain that the second has lost, at 95 %, of a sample; else NAN. */
    struct interval lost_interval;
    int shown;
    uint64_t place[LABELS_SHOWN]; /* the first unequal cases */
};

/* With the domain of an outcome. False: not over the same axes and starts, or not enough memory. */
bool compare_labels(struct label_comparison *comparison, const struct results *first,
                    const struct results *second, enum results_kind of, stance_message *message);

#endif
