/* basin_threshold.c - see basin_threshold.h. */
#include "basin_threshold.h"

#include "analysis/statistics/statistics.h"

#include <gsl/gsl_cdf.h>
#include <math.h>
#include <stdlib.h>

enum { PARTS = 64 }; /* of the stretch between two values, that are looked at */

/* Rows along the parameter: row first + i * stride has the value number i. */
struct walk {
    const struct basin *b;
    const struct results_axis *axis;
    size_t first, stride;
    double threshold;
};

/* A mean of D over the draws of a sample has that error. */
static double drawn_error(const struct walk *w, size_t i, double part)
{
    const struct basin *b = w->b;
    const double *zero = b->drawn + w->first * b->draws,
                 *here = b->drawn + (w->first + i * w->stride) * b->draws,
                 *next = here + w->stride * b->draws;
    double mean = 0, squares = 0, n = 0;
    for (size_t p = 0; p < b->draws; p++) {
        const double d =
            (1 - part) * here[p] + (part > 0 ? part * next[p] : 0) - w->threshold * zero[p];
        if (isfinite(d)) {
            const double step = d - mean;
            mean += step / ++n; /* Welford's recurrence */
            squares += step * step * (n - 1) / n;
        }
    }
    return n > 1 ? gsl_cdf_tdist_Pinv(0.5 + 0.5 * b->choice.level, n - 1) *
                       sqrt(squares / (n - 1) / n)
                 : INFINITY;
}

/* D and its error a part of the way from value i to the next. */
static double look(const struct walk *w, size_t i, double part, double *error)
{
    const struct basin_row *zero = &w->b->row[w->first],
                           *here = &w->b->row[w->first + i * w->stride],
                           *next = part > 0 ? here + w->stride : here;
    const double at_first = i == 0 ? 1 - part : 0; /* the first row is here, too */
    *error = hypot(hypot((i > 0) * (1 - part) * here->resolution, part * next->resolution),
                   (at_first - w->threshold) * zero->resolution);
    if (w->b->draws > 0)
        *error = hypot(*error, drawn_error(w, i, part));
    return (1 - part) * here->volume + part * next->volume - w->threshold * zero->volume;
}

/* Where D + side * error goes through zero first, from its sign at the beginning: value number and
 * part. False: nowhere. */
static bool find(const struct walk *w, double side, double sign, double *value)
{
    double before = NAN, last = NAN;
    for (size_t i = 0; i < w->axis->count; i++) {
        for (int k = 0; k < (i + 1 < w->axis->count ? PARTS : 1); k++) {
            double error;
            const double part = (double)k / PARTS, here = w->axis->value[i];
            const double x = here + (k > 0 ? part * (w->axis->value[i + 1] - here) : 0);
            const double d = sign * look(w, i, part, &error) + side * error;
            if (!isfinite(d))
                continue;
            if (d < 0) {
                *value = isfinite(before) ? last + (x - last) * before / (before - d) : x;
                return true;
            }
            before = d;
            last = x;
        }
    }
    return false;
}

struct basin_threshold basin_threshold(const struct basin *basin, size_t row, int along,
                                       double threshold)
{
    struct walk w = {basin, &basin->r->axis[basin->by[along]], row, 1, threshold};
    for (int k = along + 1; k < basin->by_axes; k++)
        w.stride *= basin->r->axis[basin->by[k]].count;
    const size_t last = w.axis->count - 1;
    const double sign = threshold < 1 ? 1 : -1;
    struct basin_threshold found = {.first = basin->row[row].volume,
                                    .last = basin->row[row + last * w.stride].volume,
                                    .before = last,
                                    .after = last,
                                    .at = NAN,
                                    .low = NAN,
                                    .high = NAN};
    if (!(found.first > 0))
        return found;
    found.crossed = find(&w, 0, sign, &found.at);
    find(&w, -1, sign, &found.low);
    find(&w, 1, sign, &found.high);
    for (size_t i = 0; found.crossed && i < last; i++) {
        const double a = w.axis->value[i], b = w.axis->value[i + 1];
        if ((found.at - a) * (found.at - b) <= 0) {
            found.before = i;
            found.after = i + 1;
            break;
        }
    }
    return found;
}

/* ---- the first start that is lost ---------------------------------------------------------- */

bool basin_more_at_last(const struct results *r, int axis, enum results_kind of)
{
    struct statistics_counts ends[2];
    statistics_count(r, axis, 0, &ends[0]);
    statistics_count(r, axis, r->axis[axis].count - 1, &ends[1]);
    return ends[1].kind[of] > ends[0].kind[of];
}

bool basin_lose(const struct results *r, int axis, bool down, enum results_kind of,
                struct basin_loss *loss)
{
    const size_t count = r->axis[axis].count;
    const uint64_t stride = statistics_stride(r, axis);
    *loss =
        (struct basin_loss){.down = down, .lost = calloc(count, sizeof *loss->lost), .at = count};
    for (uint64_t i = 0; loss->lost && i < r->cases; i++) {
        if (i / stride % count != 0)
            continue;
        for (size_t k = 0; k < count; k++) {
            const uint64_t index = i + (loss->down ? count - 1 - k : k) * stride;
            const uint8_t kind = r->kind[index];
            if (k == 0 && kind != of)
                break;
            loss->starts += k == 0;
            if (!basin_is_known(kind)) {
                loss->unknown++;
                break;
            }
            if (kind != of) {
                loss->lost[k]++;
                if (k < loss->at) {
                    loss->at = k;
                    loss->first = index;
                }
                break;
            }
        }
    }
    return loss->lost != NULL;
}
