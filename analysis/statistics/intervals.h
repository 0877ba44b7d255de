/* intervals.h - how far the shares of a sampled study may be off.
 *
 * A grid has none: its cases are no draws of anything, they are all there is at these places, and
 * what they say of the places between is a matter of where the boundary runs (basin_map.h).
 *
 * What is drawn in a sample are its blocks (runner/scenario/doe.h: single points but for saltelli
 * and morris, whose points repeat each other's coordinates). All cases of a block hang together,
 * those at one point over a grid beside the sample, too. With k_i of the m_i cases of block i in
 * the share p = sum k_i / sum m_i, its variance is that of a ratio, n / (n - 1) sum (k_i - p m_i)^2
 * / (sum m_i)^2 (Cochran, Sampling Techniques, 1977, section 6.3 and 9A), that of p (1 - p) / v
 * independent cases: Wilson's interval for so many, with Student's deviations for n - 1, as Korn
 * and Graubard (Surv. Methodol. 24, 1998) do for Clopper's and Pearson's. Where every block is
 * wholly in or out it is Wilson's own (J. Am. Stat. Assoc. 22, 1927). Blocks of lhs and Sobol'
 * sequences are more even than independent ones: there it is rather too wide, conservative.
 */
#ifndef STANCE_STATISTICS_INTERVALS_H
#define STANCE_STATISTICS_INTERVALS_H

#include "statistics.h"

/* NAN where there is none. */
struct interval {
    double low, high;
};

/* Sums over blocks of k, m and their products. */
struct interval_draws {
    double blocks, k, m, kk, km, mm;
    bool mixed; /* some block is neither wholly in nor out, or they differ in size */
};
/* Adds a block with k of m cases in the share; one without cases is none. */
void interval_add(struct interval_draws *draws, double k, double m);
struct interval interval_of(const struct interval_draws *draws, double level);

/* At 95 %, of the share of a kind among the cases done, in `rows` groups of cases: by the value of
 * an axis, or (axis < 0) by the group part[point] of their sample point, or (part NULL) all in one.
 * False: no memory. */
bool intervals_find(const struct results *r, enum results_kind kind, int axis, const uint32_t *part,
                    size_t rows, struct interval *interval);

#endif
