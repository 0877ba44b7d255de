/* doe_bins.h - what became of the cases of a sample, by the values of one path that it varies.
 *
 * Few different values have a bin each. Many are put in order and cut into bins of equally many
 * points, so that every share rests on as many cases as the others, whatever the spacing.
 */
#ifndef STANCE_STATISTICS_DOE_BINS_H
#define STANCE_STATISTICS_DOE_BINS_H

#include "intervals.h"

enum { SAMPLE_BINS = 32 }; /* most */

struct doe_bin {
    double low, high, centre; /* least, largest and median value; one value: all equal */
    struct statistics_counts counts;
    struct interval of_kind[RESULTS_KIND_COUNT]; /* of the share of each outcome, at 95 % */
};

struct doe_bins {
    bool listed; /* a bin for each value */
    size_t count;
    struct doe_bin bin[SAMPLE_BINS];
};

/* Path k of those that the sample varies, in at most `most` bins (2 ... SAMPLE_BINS); of as many
 * values or fewer, and of words, each is a bin. */
bool doe_bins_make(struct doe_bins *bins, const struct results *r, int k, size_t most,
                   stance_message *message);

#endif
