/* sensitivity.c - Sobol' indices, Morris's effects and first-order indices of given data. */
#include "sensitivity.h"

#include "../runner/sampling.h"
#include "statistics.h"

#include <Random123/philox.h>
#include <gsl/gsl_cdf.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

const char *const sensitivity_words[SENSITIVITY_MEASURE_COUNT] = {
#define SENSITIVITY_MEASURE(NAME, text) text,
    SENSITIVITY_MEASURES(SENSITIVITY_MEASURE)
#undef SENSITIVITY_MEASURE
};

/* Share of resamples that must have an estimate for there to be an interval. */
static const double LEAST_RESAMPLED = 0.9;

/* Rows to estimate from: blocks, one after the other, and what an estimate needs beside them. */
struct block_rows {
    size_t factors, count, width;
    const double *value;   /* [count][width] */
    bool second_order;     /* sobol */
    const uint32_t *group; /* sobol: [count]: blocks of a group hang together */
    const uint32_t *bin;   /* given: [count][factors] */
    size_t bins;
    bool even;
    double *work;
};

/* Estimates from rows pick[count] (NULL: each of them once) into the flat list of quantities. */
typedef void (*estimator)(const struct block_rows *rows, const uint32_t *pick, double *quantity);

static const double *row_at(const struct block_rows *rows, const uint32_t *pick, size_t i)
{
    return rows->value + (pick ? pick[i] : i) * rows->width;
}

/* ---- Sobol' indices ----------------------------------------------------------------------- */

/* Sums over rows of columns of a block, and of products of pairs of them. */
struct sums {
    double *column; /* [width] */
    double *square; /* [width] */
    double *with_a; /* [width]: times A */
    double *with_b;
    double *pair; /* [factors][factors]: AB_i BA_j */
};

static size_t sums_size(size_t width, size_t factors, bool second_order)
{
    return 4 * width + (second_order ? factors * factors : 0);
}

static void add_row(const struct block_rows *rows, const double *y, struct sums *sums)
{
    const size_t width = rows->width, k = rows->factors;
    const double a = y[0], b = y[width - 1];
    for (size_t c = 0; c < width; c++) {
        sums->column[c] += y[c];
        sums->square[c] += y[c] * y[c];
        sums->with_a[c] += y[c] * a;
        sums->with_b[c] += y[c] * b;
    }
    for (size_t i = 0; rows->second_order && i < k; i++) {
        for (size_t j = 0; j < k; j++) {
            sums->pair[i * k + j] += y[1 + i] * y[1 + k + j];
        }
    }
}

/* Correlation of columns c and d from the sum of their products. */
static double correlation(const struct sums *sums, double n, size_t c, size_t d, double product)
{
    const double x = sums->column[c] / n, y = sums->column[d] / n;
    const double xx = sums->square[c] / n - x * x, yy = sums->square[d] / n - y * y;
    return xx > 0 && yy > 0 ? (product / n - x * y) / sqrt(xx * yy) : NAN;
}

/* Coefficients of the least squares column = a A + b B + rest, all standardised; chance: the
 * correlation of A and B. */
static void regress(const struct sums *sums, double n, size_t c, size_t width, double chance,
                    double *a, double *b)
{
    const double with_a = correlation(sums, n, c, 0, sums->with_a[c]);
    const double with_b = correlation(sums, n, c, width - 1, sums->with_b[c]);
    const double scale = 1 / (1 - chance * chance);
    *a = scale * (with_a - chance * with_b);
    *b = scale * (with_b - chance * with_a);
}

/* first[k], total[k], sum of first, second[k][k]. */
static void estimate_sobol(const struct block_rows *rows, const uint32_t *pick, double *quantity)
{
    const size_t width = rows->width, k = rows->factors;
    const double n = (double)rows->count;
    double *first = quantity, *total = quantity + k, *sum = quantity + 2 * k;
    double *work = rows->work;
    struct sums sums = {work, work + width, work + 2 * width, work + 3 * width, work + 4 * width};

    memset(work, 0, sums_size(width, k, rows->second_order) * sizeof *work);
    for (size_t i = 0; i < rows->count; i++) {
        add_row(rows, row_at(rows, pick, i), &sums);
    }
    const double chance = correlation(&sums, n, 0, width - 1, sums.with_a[width - 1]);
    *sum = 0;
    for (size_t j = 0; j < k; j++) {
        double a, b;
        regress(&sums, n, 1 + j, width, chance, &a, &b);
        if (rows->second_order) {
            double other_a, other_b;
            regress(&sums, n, 1 + k + j, width, chance, &other_a, &other_b);
            a = (a + other_b) / 2;
            b = (b + other_a) / 2;
        }
        first[j] = b;
        total[j] = 1 - a;
        *sum += b;
    }
    for (size_t i = 0; rows->second_order && i < k; i++) {
        for (size_t j = i + 1; j < k; j++) {
            const double one = correlation(&sums, n, 1 + i, 1 + k + j, sums.pair[i * k + j]);
            const double other = correlation(&sums, n, 1 + j, 1 + k + i, sums.pair[j * k + i]);
            const double shared = (1 - total[i]) * (1 - total[j]) + first[i] * first[j];
            sum[1 + i * k + j] = (one + other) / 2 - shared * chance - first[i] - first[j];
        }
    }
}

/* ---- Morris ------------------------------------------------------------------------------- */

/* mu[k], mu_star[k], sigma[k]; rows are effects[k], NAN where there is none. */
static void estimate_morris(const struct block_rows *rows, const uint32_t *pick, double *quantity)
{
    const size_t k = rows->factors;
    double *mu = quantity, *mu_star = quantity + k, *sigma = quantity + 2 * k, *n = rows->work;

    memset(quantity, 0, 3 * k * sizeof *quantity);
    memset(n, 0, k * sizeof *n);
    for (size_t i = 0; i < rows->count; i++) {
        const double *effect = row_at(rows, pick, i);
        for (size_t j = 0; j < k; j++) {
            if (!isnan(effect[j])) {
                n[j]++;
                mu_star[j] += fabs(effect[j]);
                const double step = effect[j] - mu[j]; /* Welford's recurrence */
                mu[j] += step / n[j];
                sigma[j] += step * (effect[j] - mu[j]);
            }
        }
    }
    for (size_t j = 0; j < k; j++) {
        mu[j] = n[j] > 0 ? mu[j] : NAN;
        mu_star[j] = n[j] > 0 ? mu_star[j] / n[j] : NAN;
        sigma[j] = n[j] > 1 ? sqrt(sigma[j] / (n[j] - 1)) : NAN;
    }
}

/* effect[k] of a trajectory y[k + 1] through the points u[k + 1][k]. */
static void find_effects(const double *y, const double *u, size_t k, double *effect)
{
    for (size_t j = 0; j < k; j++) {
        effect[j] = NAN;
    }
    for (size_t step = 0; step < k; step++) {
        const double *from = u + step * k, *to = from + k;
        size_t j = 0;
        while (j < k && to[j] == from[j]) {
            j++;
        }
        if (j < k) {
            effect[j] = (y[step + 1] - y[step]) / (to[j] - from[j]);
        }
    }
}

/* ---- given data --------------------------------------------------------------------------- */

/* first[k], sum of first, what chance adds to each first[k] at the most; rows are single
 * responses. */
static void estimate_given(const struct block_rows *rows, const uint32_t *pick, double *quantity)
{
    const size_t k = rows->factors;
    double *sum = rows->work, *number = rows->work + rows->bins, n = (double)rows->count;
    double all = 0, mean = 0;

    for (size_t i = 0; i < rows->count; i++) {
        const double step = *row_at(rows, pick, i) - mean;
        mean += step / (double)(i + 1);
        all += step * (*row_at(rows, pick, i) - mean);
    }
    quantity[k] = 0;
    for (size_t j = 0; j < k; j++) {
        double between = 0, bins = 0;
        memset(sum, 0, 2 * rows->bins * sizeof *sum);
        for (size_t i = 0; i < rows->count; i++) {
            const size_t bin = rows->bin[(pick ? pick[i] : i) * k + j];
            sum[bin] += *row_at(rows, pick, i) - mean;
            number[bin]++;
        }
        for (size_t bin = 0; bin < rows->bins; bin++) {
            bins += number[bin] > 0;
            between += number[bin] > 0 ? sum[bin] * sum[bin] / number[bin] : 0;
        }
        const double share = all > 0 && n > bins ? between / all : NAN;
        const double chance = (1 - share) * (bins - 1) / (n - bins);
        quantity[j] = rows->even ? share : share - chance;
        quantity[k] += quantity[j];
        quantity[k + 1 + j] = chance;
    }
}

struct place {
    double u;
    uint32_t point;
};

static int by_place(const void *a, const void *b)
{
    const struct place *x = a, *y = b;
    return x->u != y->u ? (x->u > y->u) - (x->u < y->u)
                        : (x->point > y->point) - (x->point < y->point);
}

/* Puts points into bins of at least `least` points along factor j: bin[count][factors]. */
static void make_bins(struct place *places, size_t count, size_t j, size_t factors, double least,
                      uint32_t *bin)
{
    uint32_t current = 0;
    size_t begun = 0;
    qsort(places, count, sizeof *places, by_place);
    for (size_t i = 0; i < count; i++) {
        if (i > 0 && places[i].u != places[i - 1].u && (double)i >= least * (double)(current + 1) &&
            i > begun) {
            current++;
            begun = i;
        }
        bin[places[i].point * factors + j] = current;
    }
}

/* ---- the bootstrap ------------------------------------------------------------------------ */

static void draw(const struct sensitivity_bootstrap *bootstrap, size_t resample, size_t count,
                 uint32_t *pick)
{
    const philox4x64_key_t key = {{bootstrap->seed, 0x626f6f747374}};
    for (size_t i = 0; i < count; i += 4) {
        const philox4x64_ctr_t counter = {{resample, i, 0, 0}};
        const philox4x64_ctr_t random = philox4x64(counter, key);
        for (size_t c = 0; c < 4 && i + c < count; c++) {
            pick[i + c] = (uint32_t)(((unsigned __int128)random.v[c] * count) >> 64);
        }
    }
}

/* Interval of an estimate from its resamples, which are sorted and lose what is no number: one that
 * drew a few blocks many times may have no index. */
static struct sensitivity_value interval_of(double estimate, double *resampled, size_t n,
                                            double level)
{
    struct sensitivity_value value = {estimate, NAN, NAN};
    struct statistics_numbers numbers;
    for (size_t b = 0; b < n; b++) {
        resampled[b] = isfinite(resampled[b]) ? resampled[b] : NAN;
    }
    statistics_summarise(resampled, n, &numbers);
    if (!isfinite(estimate) || (double)numbers.n < LEAST_RESAMPLED * (double)n) {
        value.estimate = isfinite(estimate) ? estimate : NAN;
        return value;
    }
    const double moved = estimate - numbers.sum / (double)numbers.n;
    value.low = moved + statistics_quantile(resampled, numbers.n, (1 - level) / 2);
    value.high = moved + statistics_quantile(resampled, numbers.n, (1 + level) / 2);
    return value;
}

static bool estimate_all(const struct block_rows *rows, estimator estimate, size_t quantities,
                         const struct sensitivity_bootstrap *bootstrap,
                         struct sensitivity_value *value)
{
    const size_t resamples = bootstrap->resamples;
    double *now = malloc(quantities * sizeof *now);
    double *table = malloc(quantities * resamples * sizeof *table);
    uint32_t *pick = malloc((rows->count + 1) * sizeof *pick);
    double *line = malloc(resamples * sizeof *line);
    const bool good = now && table && pick && line;

    for (size_t b = 0; good && b < resamples; b++) {
        draw(bootstrap, b, rows->count, pick);
        estimate(rows, pick, table + b * quantities);
    }
    if (good) {
        estimate(rows, NULL, now);
    }
    for (size_t q = 0; good && q < quantities; q++) {
        for (size_t b = 0; b < resamples; b++) {
            line[b] = table[b * quantities + q];
        }
        value[q] = interval_of(now[q], line, resamples, bootstrap->level);
    }
    free(now);
    free(table);
    free(pick);
    free(line);
    return good;
}

/* ---- the jackknife ------------------------------------------------------------------------ */

enum { GROUPS = SAMPLING_REPLICATES };

/* The rows that are not in the group; how many. */
static size_t leave_out(const struct block_rows *rows, uint32_t group, uint32_t *pick)
{
    size_t count = 0;
    for (size_t i = 0; i < rows->count; i++) {
        if (rows->group[i] != group) {
            pick[count++] = (uint32_t)i;
        }
    }
    return count;
}

/* Student's interval about an estimate from those without one of the groups each (Tukey). */
static struct sensitivity_value interval_without(double estimate, const double *without, size_t n,
                                                 double level)
{
    struct sensitivity_value value = {isfinite(estimate) ? estimate : NAN, NAN, NAN};
    double mean = 0, squares = 0;
    for (size_t g = 0; g < n; g++) {
        mean += without[g] / (double)n;
    }
    for (size_t g = 0; g < n; g++) {
        squares += (without[g] - mean) * (without[g] - mean);
    }
    if (n > 1 && isfinite(squares)) {
        const double half = gsl_cdf_tdist_Pinv((1 + level) / 2, (double)(n - 1)) *
                            sqrt(squares * (double)(n - 1) / (double)n);
        value.low = value.estimate - half;
        value.high = value.estimate + half;
    }
    return value;
}

static bool estimate_grouped(const struct block_rows *rows, estimator estimate, size_t quantities,
                             double level, struct sensitivity_value *value)
{
    double *now = malloc(quantities * sizeof *now);
    double *table = malloc(quantities * GROUPS * sizeof *table);
    uint32_t *pick = malloc((rows->count + 1) * sizeof *pick);
    const bool good = now && table && pick;
    size_t groups = 0;

    for (uint32_t g = 0; good && g < GROUPS; g++) {
        struct block_rows others = *rows;
        others.count = leave_out(rows, g, pick);
        if (others.count < rows->count) {
            estimate(&others, pick, table + groups++ * quantities);
        }
    }
    if (good) {
        estimate(rows, NULL, now);
    }
    for (size_t q = 0; good && q < quantities; q++) {
        double line[GROUPS];
        for (size_t g = 0; g < groups; g++) {
            line[g] = table[g * quantities + q];
        }
        value[q] = interval_without(now[q], line, groups, level);
    }
    free(now);
    free(table);
    free(pick);
    return good;
}

/* ---- what all share ----------------------------------------------------------------------- */

static const struct sensitivity_value nothing = {NAN, NAN, NAN};

/* Memory for so many quantities, all NAN. */
static bool begin(struct sensitivity *s, size_t factors, size_t quantities)
{
    *s = (struct sensitivity){.factors = factors, .mean = NAN, .deviation = NAN};
    s->first_sum = nothing;
    s->all = malloc(quantities * sizeof *s->all);
    for (size_t q = 0; s->all && q < quantities; q++) {
        s->all[q] = nothing;
    }
    return s->all != NULL;
}

void sensitivity_free(struct sensitivity *s)
{
    free(s->all);
    *s = (struct sensitivity){0};
}

/* Mean and standard deviation of what is a number among y[n]. */
static void describe(struct sensitivity *s, const double *y, size_t n)
{
    double mean = 0, squares = 0;
    size_t found = 0;
    for (size_t i = 0; i < n; i++) {
        if (!isnan(y[i])) {
            const double step = y[i] - mean;
            mean += step / (double)++found;
            squares += step * (y[i] - mean);
        }
    }
    s->mean = found > 0 ? mean : NAN;
    s->deviation = found > 1 ? sqrt(squares / (double)(found - 1)) : NAN;
}

static bool is_whole(const double *y, size_t n)
{
    for (size_t i = 0; i < n; i++) {
        if (isnan(y[i])) {
            return false;
        }
    }
    return true;
}

bool sensitivity_sobol(struct sensitivity *s, const double *y, size_t blocks, size_t factors,
                       bool second_order, double level)
{
    const size_t width = (second_order ? 2 * factors : factors) + 2;
    const size_t quantities = 2 * factors + 1 + (second_order ? factors * factors : 0);
    double *value = malloc((blocks + 1) * width * sizeof *value);
    uint32_t *group = malloc((blocks + 1) * sizeof *group);
    struct block_rows rows = {.factors = factors, .width = width, .value = value, .group = group};

    rows.second_order = second_order;
    rows.work = malloc(sums_size(width, factors, second_order) * sizeof *rows.work);
    bool good = begin(s, factors, quantities) && value && group && rows.work;
    for (size_t i = 0; good && i < blocks; i++) {
        if (is_whole(y + i * width, width)) {
            group[rows.count] = (uint32_t)(i % GROUPS);
            memcpy(value + rows.count++ * width, y + i * width, width * sizeof *value);
        }
    }
    if (good) {
        s->blocks = rows.count;
        s->measure[SENSITIVITY_FIRST] = s->all;
        s->measure[SENSITIVITY_TOTAL] = s->all + factors;
        s->second = second_order ? s->all + 2 * factors + 1 : NULL;
        describe(s, value, rows.count * width);
        for (size_t i = 0; i < rows.count * width; i++) {
            value[i] -= s->mean; /* sums of squares lose nothing to a large mean */
        }
        good = rows.count < 2 || estimate_grouped(&rows, estimate_sobol, quantities, level, s->all);
        s->first_sum = s->all[2 * factors];
    }
    free(value);
    free(group);
    free(rows.work);
    if (!good) {
        sensitivity_free(s);
    }
    return good;
}

bool sensitivity_morris(struct sensitivity *s, const double *y, const double *u, size_t blocks,
                        size_t factors, const struct sensitivity_bootstrap *bootstrap)
{
    double *effect = malloc((blocks + 1) * factors * sizeof *effect);
    struct block_rows rows = {.factors = factors, .width = factors, .value = effect};

    rows.work = malloc(factors * sizeof *rows.work);
    bool good = begin(s, factors, 3 * factors) && effect && rows.work;
    for (size_t i = 0; good && i < blocks; i++) {
        double *own = effect + rows.count * factors;
        bool any = false;
        find_effects(y + i * (factors + 1), u + i * (factors + 1) * factors, factors, own);
        for (size_t j = 0; j < factors; j++) {
            any = any || !isnan(own[j]);
        }
        rows.count += any;
    }
    if (good) {
        s->blocks = rows.count;
        for (int m = 0; m < 3; m++) {
            s->measure[SENSITIVITY_MU + m] = s->all + (size_t)m * factors;
        }
        describe(s, y, blocks * (factors + 1));
        good =
            rows.count < 2 || estimate_all(&rows, estimate_morris, 3 * factors, bootstrap, s->all);
        for (size_t q = factors; q < 3 * factors; q++) { /* not below what can be */
            s->all[q].low = s->all[q].low < 0 ? 0 : s->all[q].low;
        }
    }
    free(effect);
    free(rows.work);
    if (!good) {
        sensitivity_free(s);
    }
    return good;
}

bool sensitivity_given(struct sensitivity *s, const double *y, const double *u, size_t points,
                       size_t factors, bool even, const struct sensitivity_bootstrap *bootstrap)
{
    const size_t quantities = 2 * factors + 1;
    double *value = malloc((points + 1) * sizeof *value);
    uint32_t *bin = malloc((points + 1) * factors * sizeof *bin);
    struct place *places = malloc((points + 1) * sizeof *places);
    size_t *kept = malloc((points + 1) * sizeof *kept);
    struct block_rows rows = {
        .factors = factors, .width = 1, .value = value, .bin = bin, .even = even};
    bool good = begin(s, factors, quantities) && value && bin && places && kept;

    for (size_t i = 0; good && i < points; i++) {
        if (!isnan(y[i])) {
            kept[rows.count] = i;
            value[rows.count++] = y[i];
        }
    }
    rows.bins = (size_t)fmax(2, floor(sqrt((double)rows.count)));
    rows.work = malloc(2 * rows.bins * sizeof *rows.work);
    good = good && rows.work;
    for (size_t j = 0; good && j < factors; j++) {
        for (size_t i = 0; i < rows.count; i++) {
            places[i] = (struct place){u[kept[i] * factors + j], (uint32_t)i};
        }
        make_bins(places, rows.count, j, factors, (double)rows.count / (double)rows.bins, bin);
    }
    if (good) {
        s->blocks = rows.count;
        s->measure[SENSITIVITY_FIRST] = s->all;
        describe(s, value, rows.count);
        good = rows.count < 2 || estimate_all(&rows, estimate_given, quantities, bootstrap, s->all);
        for (size_t f = 0; even && f < factors; f++) {
            s->all[f].low -= s->all[factors + 1 + f].estimate;
            s->all[factors].low -= s->all[factors + 1 + f].estimate;
        }
        s->first_sum = s->all[factors];
    }
    free(value);
    free(bin);
    free(places);
    free(kept);
    free(rows.work);
    if (!good) {
        sensitivity_free(s);
    }
    return good;
}

double sensitivity_weight(const struct sensitivity *s, size_t factor)
{
    const struct sensitivity_value *by = s->measure[SENSITIVITY_TOTAL];
    by = by ? by : s->measure[SENSITIVITY_MU_STAR];
    by = by ? by : s->measure[SENSITIVITY_FIRST];
    return by[factor].estimate;
}
