/* intervals.c - see intervals.h. */
#include "intervals.h"

#include <gsl/gsl_cdf.h>
#include <math.h>
#include <stdlib.h>

void interval_add(struct interval_draws *draws, double k, double m)
{
    if (m > 0) {
        draws->mixed = draws->mixed || (k > 0 && k < m) ||
                       (draws->blocks > 0 && m * draws->blocks != draws->m);
        draws->blocks++;
        draws->k += k;
        draws->m += m;
        draws->kk += k * k;
        draws->km += k * m;
        draws->mm += m * m;
    }
}

struct interval interval_of(const struct interval_draws *draws, double level)
{
    struct interval interval = {NAN, NAN};
    const double n = draws->blocks, p = draws->k / draws->m;
    if (n == 0)
        return interval;
    /* All in or all out says no more of blocks of several cases than of single ones. */
    if (!draws->mixed || p == 0 || p == 1) {
        statistics_wilson_of(statistics_deviations(level), p, n, &interval.low, &interval.high);
        return interval;
    }
    if (n > 1) {
        const double squares = fmax(0, draws->kk - 2 * p * draws->km + p * p * draws->mm);
        const double variance = n / (n - 1) * squares / (draws->m * draws->m);
        const double student = gsl_cdf_tdist_Pinv(0.5 + 0.5 * level, n - 1);
        interval = (struct interval){p, p};
        if (variance > 0)
            statistics_wilson_of(student, p, p * (1 - p) / variance, &interval.low, &interval.high);
    }
    return interval;
}

bool intervals_find(const struct results *r, enum results_kind kind, int axis, const uint32_t *part,
                    size_t rows, struct interval *interval)
{
    enum { OF, DONE };
    const size_t points = r->sample < 0 ? 1 : r->axis[r->sample].count;
    const size_t block = r->block > 0 ? r->block : 1, blocks = (points + block - 1) / block;
    const uint64_t stride = statistics_stride(r, axis);
    uint32_t *count = calloc(rows * blocks, 2 * sizeof *count);

    for (uint64_t i = 0; count && r->sample >= 0 && !r->single && i < r->cases; i++) {
        const size_t point = i % points; /* the sample is the last axis */
        const size_t row = axis >= 0 ? i / stride % rows : part ? part[point] : 0;
        uint32_t *own = count + 2 * (row * blocks + point / block);
        own[OF] += r->kind[i] == kind;
        own[DONE] += r->kind[i] != RESULTS_PENDING && r->kind[i] != RESULTS_FAILED;
    }
    for (size_t row = 0; count && row < rows; row++) {
        struct interval_draws draws = {0};
        for (size_t b = 0; b < blocks; b++) {
            const uint32_t *own = count + 2 * (row * blocks + b);
            interval_add(&draws, own[OF], own[DONE]);
        }
        interval[row] = interval_of(&draws, 0.95);
    }
    free(count);
    return count != NULL;
}
