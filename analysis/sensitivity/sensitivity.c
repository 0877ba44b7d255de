/* sensitivity.c - Sobol' indices, Morris's effects and first-order indices of given data. */
#include "sensitivity.h"

#include "analysis/statistics/statistics.h"
#include "runner/scenario/doe.h"

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

/* Number, mean and squared deviations of what has been added, as it comes (Welford). */
struct moments {
    double n, mean, squares;
};

static void add_number(struct moments *m, double value)
{
    const double step = value - m->mean;
    m->mean += step / ++m->n;
    m->squares += step * (value - m->mean);
}

/* Rows to estimate from: blocks, one after the other, and what an estimate needs beside them. */
struct block_rows {
    size_t factors, count, width;
    double *value;     /* [count][width] */
    bool second_order; /* sobol */
    uint32_t *group;   /* [count]: rows of a group may hang together */
    double *work;      /* sobol: of its sums */
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
    for (size_t i = 0; rows->second_order && i < k; i++)
        for (size_t j = 0; j < k; j++)
            sums->pair[i * k + j] += y[1 + i] * y[1 + k + j];
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

    memset(work, 0, (4 * width + (rows->second_order ? k * k : 0)) * sizeof *work);
    for (size_t i = 0; i < rows->count; i++)
        add_row(rows, row_at(rows, pick, i), &sums);
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
    for (size_t j = 0; j < k; j++) {
        struct moments m = {0, 0, 0};
        double magnitudes = 0;
        for (size_t i = 0; i < rows->count; i++) {
            const double effect = row_at(rows, pick, i)[j];
            if (!isnan(effect)) {
                add_number(&m, effect);
                magnitudes += fabs(effect);
            }
        }
        quantity[j] = m.n > 0 ? m.mean : NAN;
        quantity[k + j] = m.n > 0 ? magnitudes / m.n : NAN;
        quantity[2 * k + j] = m.n > 1 ? sqrt(m.squares / (m.n - 1)) : NAN;
    }
}

/* effect[k] of a trajectory y[k + 1] through the points u[k + 1][k]. */
static void find_effects(const double *y, const double *u, size_t k, double *effect)
{
    for (size_t j = 0; j < k; j++)
        effect[j] = NAN;
    for (size_t step = 0; step < k; step++) {
        const double *from = u + step * k, *to = from + k;
        size_t j = 0;
        while (j < k && to[j] == from[j])
            j++;
        if (j < k)
            effect[j] = (y[step + 1] - y[step]) / (to[j] - from[j]);
    }
}

/* ---- given data --------------------------------------------------------------------------- */

enum { IN_BIN = 4, PART = 4 /* subsamples are a quarter */ };

/* Points with the order of each factor's values. */
struct points {
    size_t count, factors;
    const double *y;       /* [count], of mean zero */
    const double *u;       /* [count][factors] */
    const uint32_t *order; /* [factors][count] */
    bool even;
};

/* What bins along factor j say of the points chosen (NULL: all), with their moments: the share
 * between bins, and what chance adds to it if points are independent. */
static void bin_factor(const struct points *p, const bool *chosen, const struct moments *m,
                       size_t j, double *share, double *chance)
{
    const uint32_t *order = p->order + j * p->count;
    const size_t n = (size_t)m->n;
    const size_t most = p->even ? (size_t)sqrt((double)n) : n / IN_BIN;
    const double least = (double)n / (double)(most < 2 ? 2 : most);
    double sum = 0, number = 0, between = 0, bins = 0, seen = 0, last = NAN;
    for (size_t i = 0; i < p->count; i++) {
        const uint32_t point = order[i];
        if (chosen && !chosen[point])
            continue;
        const double u = p->u[point * p->factors + j];
        if (number > 0 && u != last && seen >= least * (bins + 1)) {
            between += sum * sum / number;
            bins++;
            sum = number = 0;
        }
        sum += p->y[point] - m->mean;
        number++;
        seen++;
        last = u;
    }
    between += number > 0 ? sum * sum / number : 0;
    bins += number > 0;
    *share = m->squares > 0 && seen > bins ? between / m->squares : NAN;
    *chance = (1 - *share) * (bins - 1) / (seen - bins);
}

/* share[k], then chance[k]. */
static void bin_all(const struct points *p, const bool *chosen, double *quantity)
{
    struct moments m = {0, 0, 0};
    for (size_t i = 0; i < p->count; i++)
        if (!chosen || chosen[i])
            add_number(&m, p->y[i]);
    for (size_t j = 0; j < p->factors; j++)
        bin_factor(p, chosen, &m, j, &quantity[j], &quantity[p->factors + j]);
}

/* Chooses `size` of `count` points at random (Fisher, Yates); deck[count] is the order so far. */
static void choose(const struct sensitivity_bootstrap *bootstrap, size_t resample, size_t size,
                   size_t count, uint32_t *deck, bool *chosen)
{
    const philox4x64_key_t key = {{bootstrap->seed, 0x73756273616d}};
    memset(chosen, 0, count * sizeof *chosen);
    for (size_t i = 0; i < size; i++) {
        const philox4x64_ctr_t counter = {{resample, i, 0, 0}};
        const uint64_t random = philox4x64(counter, key).v[0];
        const size_t j = i + (size_t)(((unsigned __int128)random * (count - i)) >> 64);
        const uint32_t point = deck[j];
        deck[j] = deck[i];
        deck[i] = point;
        chosen[point] = true;
    }
}

/* What bins say: a row of shares and chances for each subsample, and behind these of the whole. */
struct binned {
    const struct points *points;
    size_t subsamples;
    double *table; /* [subsamples + 1][2 factors] */
    double *line;  /* [subsamples] */
};

/* The sum of the indices from `first` to before `last`. */
static struct sensitivity_value value_of(const struct binned *binned, size_t first, size_t last,
                                         double level)
{
    struct sensitivity_value value = {0, NAN, NAN};
    const struct points *const p = binned->points;
    const size_t size = p->count / PART, k = p->factors, n = binned->subsamples;
    const double *const whole = binned->table + n * 2 * k;
    double *const line = binned->line, taken = 0;
    struct moments m = {0, 0, 0};
    memset(line, 0, n * sizeof *line);
    for (size_t j = first; j < last; j++) {
        value.estimate += whole[j];
        taken += whole[k + j];
        for (size_t s = 0; s < n; s++)
            line[s] += binned->table[s * 2 * k + j] - binned->table[s * 2 * k + k + j];
    }
    const double corrected = value.estimate - taken;
    value.estimate = isfinite(corrected) ? p->even ? value.estimate : corrected : NAN;
    for (size_t s = 0; s < n; s++)
        if (isfinite(line[s]))
            add_number(&m, line[s]);
    if (isfinite(corrected) && size >= 2 * IN_BIN && m.n > 1 &&
        m.n >= LEAST_RESAMPLED * (double)n) {
        const double rest = (double)(p->count - size), times = (double)p->count / (double)size;
        const double half = gsl_cdf_ugaussian_Pinv((1 + level) / 2) * sqrt(m.squares / (m.n - 1)) *
                            sqrt((double)size / rest);
        value.low = corrected - half;
        value.high = value.estimate + half;
        if (p->even) { /* whose chance may be twice as large, and bins of parts twice as wide */
            value.low -= taken;
            value.high += fmax(0, (corrected - m.mean) / (sqrt(times) - 1));
        }
    }
    return value;
}

/* first[k], sum of first. */
static bool estimate_given(const struct points *p, const struct sensitivity_bootstrap *bootstrap,
                           struct sensitivity_value *value)
{
    const size_t k = p->factors, n = bootstrap->resamples;
    double *const table = malloc((n + 1) * 2 * k * sizeof *table), *const line =
                                                                       malloc(n * sizeof *line);
    uint32_t *const deck = malloc((p->count + 1) * sizeof *deck);
    bool *const chosen = malloc(p->count + 1);
    const struct binned binned = {p, n, table, line};
    const bool good = table && line && deck && chosen;
    for (size_t i = 0; good && i < p->count; i++)
        deck[i] = (uint32_t)i;
    for (size_t s = 0; good && s < n; s++) {
        choose(bootstrap, s, p->count / PART, p->count, deck, chosen);
        bin_all(p, chosen, table + s * 2 * k);
    }
    if (good)
        bin_all(p, NULL, table + n * 2 * k);
    for (size_t q = 0; good && q <= k; q++)
        value[q] = value_of(&binned, q < k ? q : 0, q < k ? q + 1 : k, bootstrap->level);
    free(table);
    free(line);
    free(deck);
    free(chosen);
    return good;
}

/* ---- the jackknife ------------------------------------------------------------------------ */

enum { GROUPS = DOE_REPLICATES };

/* Student's interval about an estimate from those without one of the groups each (Tukey). */
static struct sensitivity_value interval_without(double estimate, const double *without, size_t n,
                                                 double level)
{
    struct sensitivity_value value = {isfinite(estimate) ? estimate : NAN, NAN, NAN};
    double mean = 0, squares = 0;
    for (size_t g = 0; g < n; g++)
        mean += without[g] / (double)n;
    for (size_t g = 0; g < n; g++)
        squares += (without[g] - mean) * (without[g] - mean);
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
        others.count = 0;
        for (size_t i = 0; i < rows->count; i++)
            if (rows->group[i] != g)
                pick[others.count++] = (uint32_t)i;
        if (others.count < rows->count)
            estimate(&others, pick, table + groups++ * quantities);
    }
    if (good)
        estimate(rows, NULL, now);
    for (size_t q = 0; good && q < quantities; q++) {
        double line[GROUPS];
        for (size_t g = 0; g < groups; g++)
            line[g] = table[g * quantities + q];
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
    for (size_t q = 0; s->all && q < quantities; q++)
        s->all[q] = nothing;
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
    struct moments m = {0, 0, 0};
    for (size_t i = 0; i < n; i++)
        if (!isnan(y[i]))
            add_number(&m, y[i]);
    s->mean = m.n > 0 ? m.mean : NAN;
    s->deviation = m.n > 1 ? sqrt(m.squares / (m.n - 1)) : NAN;
}

/* Room for the rows of so many blocks; makes `s`, too. */
static bool begin_rows(struct sensitivity *s, struct block_rows *rows, size_t blocks,
                       size_t quantities, size_t work)
{
    rows->value = malloc((blocks + 1) * rows->width * sizeof *rows->value);
    rows->group = malloc((blocks + 1) * sizeof *rows->group);
    rows->work = malloc((work + 1) * sizeof *rows->work);
    return begin(s, rows->factors, quantities) && rows->value && rows->group && rows->work;
}

/* `good`, without which nothing is left. */
static bool end_rows(struct sensitivity *s, struct block_rows *rows, bool good)
{
    free(rows->value);
    free(rows->group);
    free(rows->work);
    if (!good)
        sensitivity_free(s);
    return good;
}

bool sensitivity_sobol(struct sensitivity *s, const double *y, size_t blocks, size_t factors,
                       bool second_order, double level)
{
    const size_t width = (second_order ? 2 * factors : factors) + 2;
    const size_t pairs = second_order ? factors * factors : 0, quantities = 2 * factors + 1 + pairs;
    struct block_rows rows = {.factors = factors, .width = width, .second_order = second_order};

    bool good = begin_rows(s, &rows, blocks, quantities, 4 * width + pairs);
    for (size_t i = 0; good && i < blocks; i++) {
        const double *const own = y + i * width;
        bool whole = true;
        for (size_t c = 0; c < width; c++)
            whole = whole && !isnan(own[c]);
        if (whole) {
            rows.group[rows.count] = (uint32_t)(i % GROUPS);
            memcpy(rows.value + rows.count++ * width, own, width * sizeof *own);
        }
    }
    if (good) {
        s->blocks = rows.count;
        s->measure[SENSITIVITY_FIRST] = s->all;
        s->measure[SENSITIVITY_TOTAL] = s->all + factors;
        s->second = second_order ? s->all + 2 * factors + 1 : NULL;
        describe(s, rows.value, rows.count * width);
        for (size_t i = 0; i < rows.count * width; i++)
            rows.value[i] -= s->mean; /* sums of squares lose nothing to a large mean */
        good = rows.count < 2 || estimate_grouped(&rows, estimate_sobol, quantities, level, s->all);
        s->first_sum = s->all[2 * factors];
    }
    return end_rows(s, &rows, good);
}

bool sensitivity_morris(struct sensitivity *s, const double *y, const double *u, size_t blocks,
                        size_t factors, double level)
{
    struct block_rows rows = {.factors = factors, .width = factors};
    bool good = begin_rows(s, &rows, blocks, 3 * factors, 0);
    for (size_t i = 0; good && i < blocks; i++) {
        double *own = rows.value + rows.count * factors;
        bool any = false;
        find_effects(y + i * (factors + 1), u + i * (factors + 1) * factors, factors, own);
        for (size_t j = 0; j < factors; j++)
            any = any || !isnan(own[j]);
        rows.group[rows.count] = (uint32_t)(i % GROUPS);
        rows.count += any;
    }
    if (good) {
        s->blocks = rows.count;
        for (int m = 0; m < 3; m++)
            s->measure[SENSITIVITY_MU + m] = s->all + (size_t)m * factors;
        describe(s, y, blocks * (factors + 1));
        good =
            rows.count < 2 || estimate_grouped(&rows, estimate_morris, 3 * factors, level, s->all);
        for (size_t q = factors; q < 3 * factors; q++) /* not below what can be */
            s->all[q].low = s->all[q].low < 0 ? 0 : s->all[q].low;
    }
    return end_rows(s, &rows, good);
}

bool sensitivity_given(struct sensitivity *s, const double *y, const double *u, size_t points,
                       size_t factors, bool even, const struct sensitivity_bootstrap *bootstrap)
{
    double *value = malloc((points + 1) * sizeof *value);
    double *place = malloc((points + 1) * factors * sizeof *place);
    uint32_t *order = malloc((points + 1) * factors * sizeof *order);
    struct statistics_place *places = malloc((points + 1) * sizeof *places);
    struct points p = {.factors = factors, .y = value, .u = place, .order = order, .even = even};
    bool good = begin(s, factors, factors + 1) && value && place && order && places;

    for (size_t i = 0; good && i < points; i++) {
        if (!isnan(y[i])) {
            memcpy(place + p.count * factors, u + i * factors, factors * sizeof *place);
            value[p.count++] = y[i];
        }
    }
    for (size_t j = 0; good && j < factors; j++) {
        for (size_t i = 0; i < p.count; i++)
            places[i] = (struct statistics_place){place[i * factors + j], i};
        statistics_order(places, p.count);
        for (size_t i = 0; i < p.count; i++)
            order[j * p.count + i] = (uint32_t)places[i].index;
    }
    if (good) {
        s->blocks = p.count;
        s->measure[SENSITIVITY_FIRST] = s->all;
        describe(s, value, p.count);
        for (size_t i = 0; i < p.count; i++)
            value[i] -= s->mean;
        good = p.count < 2 || estimate_given(&p, bootstrap, s->all);
        s->first_sum = s->all[factors];
    }
    free(value);
    free(place);
    free(order);
    free(places);
    if (!good)
        sensitivity_free(s);
    return good;
}

double sensitivity_weight(const struct sensitivity *s, size_t factor)
{
    const struct sensitivity_value *by = s->measure[SENSITIVITY_TOTAL];
    by = by ? by : s->measure[SENSITIVITY_MU_STAR];
    by = by ? by : s->measure[SENSITIVITY_FIRST];
    return by[factor].estimate;
}
