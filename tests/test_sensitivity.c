/* test_sensitivity.c - sensitivity indices against functions whose indices are known in closed
 * form, how often their intervals hold these, and tables of comma-separated values. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../analysis/csv.h"
#include "../analysis/sensitivity.h"
#include "../runner/sampling.h"

#include <Random123/philox.h>

/* ---- functions on the unit cube ----------------------------------------------------------- */

enum { MOST = 20 };
static const double pi = 3.14159265358979323846;

struct function {
    const char *name;
    size_t factors;
    double (*value)(const double *u);
    void (*indices)(double *first, double *total);
};

/* Ishigami and Homma (1990): sin x1 + 7 sin^2 x2 + 0.1 x3^4 sin x1, x uniform on -pi ... pi. The
 * means of sin^2, sin^4 and x^8 give the parts of the variance: V1 = (1 + b pi^4 / 5)^2 / 2,
 * V2 = a^2 / 8, V13 = 8 b^2 pi^8 / 225. */
static double ishigami(const double *u)
{
    const double x = pi * (2 * u[0] - 1), y = pi * (2 * u[1] - 1), z = pi * (2 * u[2] - 1);
    return sin(x) + 7 * sin(y) * sin(y) + 0.1 * z * z * z * z * sin(x);
}
static void ishigami_indices(double *first, double *total)
{
    const double one = 1 + 0.1 * pow(pi, 4) / 5, v1 = one * one / 2, v2 = 49.0 / 8;
    const double v13 = 8 * 0.01 * pow(pi, 8) / 225, v = v1 + v2 + v13;
    const double f[3] = {v1 / v, v2 / v, 0}, t[3] = {(v1 + v13) / v, v2 / v, v13 / v};
    memcpy(first, f, sizeof f);
    memcpy(total, t, sizeof t);
}

/* Sobol's g-function: product of (|4 u - 2| + a) / (1 + a), each factor of mean 1 and variance
 * 1 / (3 (1 + a)^2). */
enum { G = 8 };
static const double weights[G] = {0, 1, 4.5, 9, 99, 99, 99, 99};
static double g_function(const double *u)
{
    double product = 1;
    for (size_t j = 0; j < G; j++)
        product *= (fabs(4 * u[j] - 2) + weights[j]) / (1 + weights[j]);
    return product;
}
static void g_indices(double *first, double *total)
{
    double all = 1;
    for (size_t j = 0; j < G; j++)
        all *= 1 + 1 / (3 * (1 + weights[j]) * (1 + weights[j]));
    for (size_t j = 0; j < G; j++) {
        const double v = 1 / (3 * (1 + weights[j]) * (1 + weights[j]));
        first[j] = v / (all - 1);
        total[j] = v * all / (1 + v) / (all - 1);
    }
}

/* Far from zero, with a product: x1 + x2 / 2 + 3 (x1 - 1/2) (x3 - 1/2) + 1000; variances 1/12,
 * 1/48 and 9/144. */
static double shifted(const double *u)
{
    return 1000 + u[0] + u[1] / 2 + 3 * (u[0] - 0.5) * (u[2] - 0.5);
}
static void shifted_indices(double *first, double *total)
{
    const double v1 = 1.0 / 12, v2 = 1.0 / 48, v13 = 9.0 / 144, v = v1 + v2 + v13;
    const double f[3] = {v1 / v, v2 / v, 0}, t[3] = {(v1 + v13) / v, v2 / v, v13 / v};
    memcpy(first, f, sizeof f);
    memcpy(total, t, sizeof t);
}

static const struct function functions[] = {
    {"Ishigami", 3, ishigami, ishigami_indices},
    {"Sobol' g", G, g_function, g_indices},
    {"shifted", 3, shifted, shifted_indices},
};
enum { FUNCTIONS = sizeof functions / sizeof functions[0] };

/* Morris (1991), section 5, with the coefficients that he drew at random replaced by those of the
 * test function of SALib (Iwanaga, Usher, Herman 2022): (-1)^i and (-1)^(i + j), i from 1. */
static double morris(const double *u)
{
    double w[20], y = 0;
    for (int i = 0; i < 20; i++)
        w[i] =
            i == 2 || i == 4 || i == 6 ? 2 * (1.1 * u[i] / (u[i] + 0.1) - 0.5) : 2 * (u[i] - 0.5);
    for (int i = 0; i < 20; i++) {
        y += (i < 10 ? 20 : i % 2 ? 1 : -1) * w[i];
        for (int j = i + 1; j < 20; j++) {
            y += (j < 6 ? -15 : (i + j) % 2 ? -1 : 1) * w[i] * w[j];
            for (int l = j + 1; l < 5; l++) {
                y -= 10 * w[i] * w[j] * w[l];
                for (int s = l + 1; s < 4; s++)
                    y += 5 * w[i] * w[j] * w[l] * w[s];
            }
        }
    }
    return y;
}

/* ---- designs ------------------------------------------------------------------------------ */

struct data {
    struct sampling sampling;
    size_t points, factors;
    double *u, *y;
};

/* A design's responses; `independent`: blocks of Saltelli's order from random points. */
static struct data make(enum sampling_method method, const struct function *f, uint64_t count,
                        uint64_t seed, bool second_order, bool independent)
{
    struct data d = {.sampling = {.method = method,
                                  .count = count,
                                  .factors = f->factors,
                                  .levels = 4,
                                  .second_order = second_order,
                                  .seed = seed}};
    const size_t k = f->factors;
    assert_true(sampling_begin(&d.sampling));
    d.points = (size_t)sampling_points(&d.sampling);
    d.factors = k;
    d.u = malloc(d.points * k * sizeof *d.u);
    d.y = malloc(d.points * sizeof *d.y);
    const size_t block = (size_t)sampling_block(&d.sampling);
    for (size_t i = 0; i < d.points; i++) {
        double *u = d.u + i * k;
        sampling_unit(&d.sampling, i, u);
        if (independent) {
            for (size_t j = 0; j < k; j++) {
                const bool from_b = i % block == block - 1 || i % block == j + 1;
                const philox4x64_key_t key = {{seed, 7}};
                const philox4x64_ctr_t counter = {{i / block, j, from_b, 0}};
                u[j] = (double)(philox4x64(counter, key).v[0] >> 11) * 0x1p-53;
            }
        }
        d.y[i] = f->value(u);
    }
    sampling_end(&d.sampling);
    return d;
}

static void release(struct data *d)
{
    free(d->u);
    free(d->y);
}

static void analyse(struct sensitivity *s, const struct data *d,
                    const struct sensitivity_bootstrap *bootstrap)
{
    const struct sampling *p = &d->sampling;
    const bool good =
        p->method == SAMPLING_SALTELLI
            ? sensitivity_sobol(s, d->y, p->count, d->factors, p->second_order, bootstrap)
        : p->method == SAMPLING_MORRIS
            ? sensitivity_morris(s, d->y, d->u, p->count, d->factors, bootstrap)
            : sensitivity_given(s, d->y, d->u, d->points, d->factors, p->method == SAMPLING_SOBOL,
                                bootstrap);
    assert_true(good);
}

/* ---- coverage ----------------------------------------------------------------------------- */

static bool holds(const struct sensitivity_value *v, double truth)
{
    return v->low <= truth && truth <= v->high;
}

struct tally {
    double held[2 * MOST], error[2 * MOST], width, mean, least;
    size_t quantities;
};

/* Over many seeds: how often the intervals hold the truth, root mean square errors of the estimates
 * over the mean half width of the intervals. */
static struct tally cover(enum sampling_method method, const struct function *f, uint64_t count,
                          int seeds, bool independent)
{
    struct tally t = {.quantities = method == SAMPLING_SALTELLI ? 2 * f->factors : f->factors};
    double truth[2 * MOST];
    const struct sensitivity_bootstrap bootstrap = {500, 0.95, 1};
    f->indices(truth, truth + f->factors);
    for (int seed = 0; seed < seeds; seed++) {
        struct sensitivity s;
        struct data d = make(method, f, count, (uint64_t)seed, false, independent);
        analyse(&s, &d, &bootstrap);
        for (size_t q = 0; q < t.quantities; q++) {
            t.held[q] += holds(&s.all[q], truth[q]);
            t.error[q] += pow(s.all[q].estimate - truth[q], 2);
            t.width += (s.all[q].high - s.all[q].low) / (double)t.quantities / seeds;
        }
        sensitivity_free(&s);
        release(&d);
    }
    t.least = 1;
    double error = 0;
    for (size_t q = 0; q < t.quantities; q++) {
        t.mean += t.held[q] / seeds / (double)t.quantities;
        t.least = fmin(t.least, t.held[q] / seeds);
        error += t.error[q] / seeds / (double)t.quantities;
    }
    printf(
        "# %s, %s %llu%s: intervals hold the truth in %.1f %% (worst index %.1f %%), error %.4f, "
        "width %.4f\n",
        f->name, sampling_words[method], (unsigned long long)count,
        independent ? " independent" : "", 100 * t.mean, 100 * t.least, sqrt(error), t.width);
    return t;
}

int main(void)
{
    const int seeds = 200;
    for (size_t f = 0; f < FUNCTIONS; f++) {
        for (int n = 64; n <= 512; n *= 2) {
            cover(SAMPLING_SALTELLI, &functions[f], (uint64_t)n, seeds, true);
            cover(SAMPLING_SALTELLI, &functions[f], (uint64_t)n, seeds, false);
        }
        for (int n = 256; n <= 1024; n *= 4) {
            cover(SAMPLING_RANDOM, &functions[f], (uint64_t)n, seeds, false);
            cover(SAMPLING_LHS, &functions[f], (uint64_t)n, seeds, false);
            cover(SAMPLING_SOBOL, &functions[f], (uint64_t)n, seeds, false);
        }
    }
    (void)morris;
}
