/* statistics.c - counts, Wilson intervals, quantiles and extents. */
#include "statistics.h"

#include "runner/base/message.h"

#include <gsl/gsl_cdf.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum results_kind statistics_judged(const struct results *r)
{
    struct statistics_counts counts;
    statistics_count(r, -1, 0, &counts);
    if (counts.kind[RESULTS_WALKS] > 0)
        return RESULTS_WALKS;
    return counts.kind[RESULTS_STABILISED] == 0 && counts.kind[RESULTS_RESTED] > 0
               ? RESULTS_RESTED
               : RESULTS_STABILISED;
}

double statistics_deviations(double level)
{
    return gsl_cdf_ugaussian_Pinv(0.5 + 0.5 * level);
}

void statistics_wilson_of(double z, double p, double n, double *low, double *high)
{
    const double scale = 1 / (1 + z * z / n);
    const double centre = scale * (p + z * z / (2 * n));
    const double half = scale * z * sqrt(p * (1 - p) / n + z * z / (4 * n * n));
    /* Rounding must not leave the ends a hair beyond 0 and 1, where they lie exactly. */
    *low = p <= 0 ? 0 : fmax(0, centre - half);
    *high = p >= 1 ? 1 : fmin(1, centre + half);
}

/* ---- counts ------------------------------------------------------------------------------- */

/* Number of cases per step along an axis. */
uint64_t statistics_stride(const struct results *r, int axis)
{
    uint64_t stride = 1;
    for (int a = r->axes - 1; a > axis; a--)
        stride *= r->axis[a].count;
    return stride;
}

uint64_t statistics_row(const struct results *r, const int *axis, int axes, size_t row,
                        size_t *point)
{
    uint64_t index = 0;
    memset(point, 0, SCENARIO_MAX_AXES * sizeof *point);
    for (int k = axes - 1; k >= 0; k--) {
        point[axis[k]] = row % r->axis[axis[k]].count;
        row /= r->axis[axis[k]].count;
        index += point[axis[k]] * statistics_stride(r, axis[k]);
    }
    return index;
}

static void finish_counts(struct statistics_counts *counts)
{
    counts->done = 0;
    for (int k = 0; k < RESULTS_KIND_COUNT; k++)
        counts->done += k == RESULTS_PENDING || k == RESULTS_FAILED ? 0 : counts->kind[k];
}

void statistics_count(const struct results *r, int axis, size_t point,
                      struct statistics_counts *counts)
{
    const uint64_t stride = statistics_stride(r, axis);
    memset(counts, 0, sizeof *counts);
    for (uint64_t i = 0; i < r->cases; i++)
        counts->kind[r->kind[i]] += axis < 0 || i / stride % r->axis[axis].count == point;
    finish_counts(counts);
}

void statistics_count_pair(const struct results *r, int a, int b, struct statistics_counts *counts)
{
    const uint64_t stride_a = statistics_stride(r, a), stride_b = statistics_stride(r, b);
    const size_t rows = r->axis[a].count, columns = b < 0 ? 1 : r->axis[b].count;

    memset(counts, 0, rows * columns * sizeof *counts);
    for (uint64_t i = 0; i < r->cases; i++)
        counts[i / stride_a % rows * columns + i / stride_b % columns].kind[r->kind[i]]++;
    for (size_t p = 0; p < rows * columns; p++)
        finish_counts(&counts[p]);
}

/* ---- numbers ------------------------------------------------------------------------------ */

static int compare_doubles(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

void statistics_sort(double *values, size_t n)
{
    qsort(values, n, sizeof *values, compare_doubles);
}

static int compare_places(const void *a, const void *b)
{
    const struct statistics_place *x = a, *y = b;
    const int order = compare_doubles(&x->value, &y->value);
    return order ? order : (x->index > y->index) - (x->index < y->index);
}

void statistics_order(struct statistics_place *place, size_t n)
{
    qsort(place, n, sizeof *place, compare_places);
}

struct statistics_place *statistics_ordered(const double *value, size_t n)
{
    struct statistics_place *const place = malloc((n + 1) * sizeof *place);
    for (size_t i = 0; place && i < n; i++)
        place[i] = (struct statistics_place){value[i], i};
    if (place)
        statistics_order(place, n);
    return place;
}

double statistics_quantile(const double *sorted, size_t n, double p)
{
    double place = p * (double)(n - 1);
    size_t below = (size_t)place;
    if (below + 1 >= n)
        return sorted[n - 1];
    double part = place - (double)below;
    /* An infinite neighbour of weight zero must not make a NAN. */
    return part == 0 ? sorted[below] : (1 - part) * sorted[below] + part * sorted[below + 1];
}

void statistics_summarise(double *values, size_t n, struct statistics_numbers *numbers)
{
    size_t kept = 0;
    double sum = 0;
    for (size_t i = 0; i < n; i++) {
        if (!isnan(values[i])) {
            sum += values[i];
            values[kept++] = values[i];
        }
    }
    *numbers = (struct statistics_numbers){kept, NAN, NAN, NAN, NAN, NAN, sum};
    if (kept == 0)
        return;
    statistics_sort(values, kept);
    numbers->low = values[0];
    numbers->median = statistics_quantile(values, kept, 0.5);
    numbers->q90 = statistics_quantile(values, kept, 0.9);
    numbers->q99 = statistics_quantile(values, kept, 0.99);
    numbers->high = values[kept - 1];
}

/* ---- extents ------------------------------------------------------------------------------ */

size_t statistics_nearest_zero(const struct results_axis *axis)
{
    size_t nearest = 0;
    double tolerance = 0;
    for (size_t i = 0; i < axis->count; i++)
        tolerance = fmax(tolerance, 1e-12 * fabs(axis->value[i]));
    for (size_t i = 1; i < axis->count; i++) {
        /* -0.1 + 51 * 0.2 / 101 and its mirror image are equally near, whatever their last bits */
        if (fabs(axis->value[i]) < fabs(axis->value[nearest]) - tolerance)
            nearest = i;
    }
    return nearest;
}

bool statistics_is_monotone(const struct results_axis *axis)
{
    for (size_t i = 1; i < axis->count && !axis->word; i++)
        if (axis->value[i] == axis->value[i - 1] ||
            (axis->value[i] > axis->value[i - 1]) != (axis->value[1] > axis->value[0]))
            return false;
    return !axis->word && axis->count > 1;
}

/* An end of an extent. */
struct end {
    double value;
    bool open, unknown;
};

/* Walks from `at` upwards or downwards while the cases are stabilised. */
static struct end walk(const struct results *r, const struct results_axis *axis, uint64_t base,
                       uint64_t stride, size_t at, bool upwards)
{
    const size_t last = upwards ? axis->count - 1 : 0;
    while (at != last) {
        const size_t next = upwards ? at + 1 : at - 1;
        const uint8_t kind = r->kind[base + next * stride];
        if (kind != RESULTS_STABILISED)
            return (struct end){0.5 * (axis->value[at] + axis->value[next]), false,
                                kind == RESULTS_PENDING || kind == RESULTS_FAILED};
        at = next;
    }
    return (struct end){axis->value[at], true, false};
}

bool statistics_extent(const struct results *r, int axis, const size_t *point,
                       struct statistics_extent *extent)
{
    const struct results_axis *along = &r->axis[axis];
    const uint64_t stride = statistics_stride(r, axis);
    uint64_t base = 0;

    *extent = (struct statistics_extent){.low = NAN, .high = NAN};
    if (!along->offset || !statistics_is_monotone(along))
        return false;
    for (int a = 0; a < r->axes; a++) {
        extent->point[a] = r->axis[a].offset ? statistics_nearest_zero(&r->axis[a]) : point[a];
        base += a == axis ? 0 : extent->point[a] * statistics_stride(r, a);
    }
    const size_t start = extent->point[axis];
    extent->kind = (enum results_kind)r->kind[base + start * stride];
    extent->any = extent->kind == RESULTS_STABILISED;
    if (!extent->any) {
        extent->low_unknown = extent->high_unknown =
            extent->kind == RESULTS_PENDING || extent->kind == RESULTS_FAILED;
        return true;
    }
    const struct end down = walk(r, along, base, stride, start, false),
                     up = walk(r, along, base, stride, start, true);
    const bool rising = down.value <= up.value;
    const struct end low = rising ? down : up, high = rising ? up : down;
    extent->low = low.value, extent->low_open = low.open, extent->low_unknown = low.unknown;
    extent->high = high.value, extent->high_open = high.open, extent->high_unknown = high.unknown;
    return true;
}

bool statistics_inferred(const struct results *r, uint64_t *count, bool **which,
                         stance_message *message)
{
    double *evidence = NULL;
    *count = 0;
    if (which)
        *which = NULL;
    if (r->single)
        return true;
    if (!results_answer(r, "evidence", &evidence, message))
        return false;
    for (uint64_t i = 0; evidence && i < r->cases; i++)
        *count += evidence[i] == STANCE_INFERRED;
    bool *const flag = which && *count > 0 ? malloc(r->cases * sizeof *flag) : NULL;
    for (uint64_t i = 0; flag && i < r->cases; i++)
        flag[i] = evidence[i] == STANCE_INFERRED;
    free(evidence);
    if (which)
        *which = flag;
    return !which || *count == 0 || flag || statistics_no_memory(r, message);
}
