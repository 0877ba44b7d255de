/* statistics.h - numbers about the cases of a results file: counts, intervals, quantiles, extents.
 *
 * Counts that say nothing of cases that are pending or failed leave them out of the total.
 */
#ifndef STANCE_STATISTICS_STATISTICS_H
#define STANCE_STATISTICS_STATISTICS_H

#include "runner/base/message.h"
#include "runner/store/results.h"

/* Says of the file that there is not enough memory. Returns false. */
static inline bool statistics_no_memory(const struct results *r, stance_message *message)
{
    return complain(message, "%.100s: not enough memory", r->file);
}

/* What a file's cases are looked for where nobody says: stabilised, or rested where nothing was
 * stabilised but something rested. */
enum results_kind statistics_judged(const struct results *r);

/* Wilson's score interval for a share p of n > 0 independent draws, at z standard deviations; p n
 * need not be whole. Cases of a grid are no draws.
 * E. B. Wilson (1927), Probable inference, the law of succession, and statistical inference. */
void statistics_wilson_of(double z, double p, double n, double *low, double *high);
/* How many standard deviations either way hold that share of a normal distribution. */
double statistics_deviations(double level);

struct statistics_counts {
    uint64_t kind[RESULTS_KIND_COUNT];
    uint64_t done; /* neither pending nor failed */
};

/* Cases of one value of an axis, or (axis < 0) all cases. */
void statistics_count(const struct results *r, int axis, size_t point,
                      struct statistics_counts *counts);
/* The same for every pair of values of two axes: counts[axis a's count][axis b's count]; b < 0: for
 * every value of the first. */
void statistics_count_pair(const struct results *r, int a, int b, struct statistics_counts *counts);
static inline void statistics_count_axis(const struct results *r, int axis,
                                         struct statistics_counts *counts)
{
    statistics_count_pair(r, axis, -1, counts);
}

/* Cases of a refined map that were not simulated: their outcome is that of their neighbours.
 * *which, where asked for, flags them; freed by the caller, NULL when there are none. */
bool statistics_inferred(const struct results *r, uint64_t *count, bool **which,
                         stance_message *message);

/* What the numbers of an answer look like; NANs are left out. */
struct statistics_numbers {
    size_t n;
    double low, median, q90, q99, high, sum; /* NAN when n is 0, sum 0 */
};
/* Rising; in place. */
void statistics_sort(double *values, size_t n);
/* Sorts values[n] in place. */
void statistics_summarise(double *values, size_t n, struct statistics_numbers *numbers);
/* Puts numbers in order, equal ones by their index. */
struct statistics_place {
    double value;
    size_t index;
};
void statistics_order(struct statistics_place *place, size_t n);
/* Those of value[n], to be freed by the caller; NULL: no memory. */
struct statistics_place *statistics_ordered(const double *value, size_t n);
/* Quantile p (0 ... 1) of sorted values[n], n > 0, linear between them. */
double statistics_quantile(const double *sorted, size_t n, double p);

/* How far the stabilised set reaches along one axis of offsets, on the line through the points
 * nearest to zero of the other axes of offsets. */
struct statistics_extent {
    bool any;                        /* the point nearest to zero is stabilised */
    enum results_kind kind;          /* of that point; pending, failed: both ends are unknown */
    double low, high;                /* unit of the axis, low <= high */
    bool low_open, high_open;        /* reaches the end of the axis there: the set may go on */
    bool low_unknown, high_unknown;  /* ends at a pending or failed case */
    size_t point[SCENARIO_MAX_AXES]; /* of the line; along the axis itself the nearest to zero */
};

/* The line passes through `point` in all axes but those of offsets. False when the axis is not one
 * of offsets, lists words, has a single value, or goes up and down. The ends lie midway between the
 * last stabilised case and the next. */
bool statistics_extent(const struct results *r, int axis, const size_t *point,
                       struct statistics_extent *extent);

/* Whether it has numbers, several, that rise or fall from the first to the last. */
bool statistics_is_monotone(const struct results_axis *axis);

/* How many cases lie between neighbours along an axis. */
uint64_t statistics_stride(const struct results *r, int axis);
/* Point number `row` of some of the axes, row-major over these; point[axes of the file], 0 along
 * all others. Returns the case there. */
uint64_t statistics_row(const struct results *r, const int *axis, int axes, size_t row,
                        size_t *point);

/* The point of an axis nearest to zero; the first of two equally near. */
size_t statistics_nearest_zero(const struct results_axis *axis);

#endif
