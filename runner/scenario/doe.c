/* doe.c - experimental designs, see doe.h. */
#include "doe.h"

#include "engine/stance.h"

#include <Random123/philox.h>
#include <gsl/gsl_cdf.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

const char *const doe_words[DOE_METHODS] = {"random",   "lhs",    "sobol",
                                            "saltelli", "morris", "sphere"};

enum { UNIT_BITS = 53 }; /* of a coordinate */

/* What random numbers of one method are for: different ones for each. */
enum purpose { PURPOSE_POINT, PURPOSE_ORDER, PURPOSE_SHIFT, PURPOSE_MATRIX };

/* ---- random numbers -------------------------------------------------------------------------- */

static uint64_t random_bits(const struct doe *s, enum purpose purpose, uint64_t a, uint64_t b)
{
    const philox4x64_key_t key = {
        {s->seed, 0x73616d706c650000 | (uint64_t)s->method << 8 | (uint64_t)purpose}};
    const philox4x64_ctr_t counter = {{a, b, 0, 0}};
    return philox4x64(counter, key).v[0];
}

/* Uniform on 0 ... n - 1, n < 2^32; its bias is below n / 2^64. */
static uint32_t below(uint64_t bits, uint64_t n)
{
    return (uint32_t)(((unsigned __int128)bits * n) >> 64);
}

/* The multiples of 2^-53 in [0, 1). */
static double unit_number(uint64_t bits)
{
    return ldexp((double)bits, -UNIT_BITS);
}

static double random_unit(const struct doe *s, uint64_t point, size_t factor)
{
    return unit_number(random_bits(s, PURPOSE_POINT, point, factor) >> (64 - UNIT_BITS));
}

/* A random order of 0 ... n - 1 (Fisher, Yates), the same for the same `which`. */
static void random_order(const struct doe *s, uint64_t which, uint32_t *order, uint64_t n)
{
    for (uint64_t i = 0; i < n; i++) {
        const uint32_t j = below(random_bits(s, PURPOSE_ORDER, which, i), i + 1);
        order[i] = (uint32_t)i;
        const uint32_t swapped = order[j];
        order[j] = order[i];
        order[i] = swapped;
    }
}

/* ---- Sobol' sequences ------------------------------------------------------------------------ */

/* Coordinates of the Sobol' sequence that the method rests on; 0: on none. */
static size_t dimensions(const struct doe *s)
{
    switch (s->method) {
    case DOE_SOBOL:
        return s->factors;
    case DOE_SALTELLI:
        return 2 * s->factors;
    case DOE_SPHERE:
        return s->factors == 2 ? 1 : s->factors;
    default:
        return 0;
    }
}

/* Sequences with scrambles of their own. */
static uint64_t sequences(const struct doe *s)
{
    return s->method == DOE_SALTELLI ? DOE_REPLICATES : 1;
}

/* The directions of a coordinate after its random matrix: bit i of the result, counted from the
 * leading one, is bit i of the direction plus some of the bits before it, modulo 2. */
static void scramble(const struct doe *s, uint64_t sequence, size_t dimension,
                     uint64_t direction[SOBOL_BITS])
{
    uint64_t scrambled[SOBOL_BITS] = {0};
    for (int i = 0; i < UNIT_BITS; i++) {
        const uint64_t before = i > 0 ? ~UINT64_C(0) << (64 - i) >> (64 - UNIT_BITS) : 0;
        const uint64_t own = UINT64_C(1) << (UNIT_BITS - 1 - i);
        const uint64_t row =
            (random_bits(s, PURPOSE_MATRIX, sequence << 32 | dimension, (uint64_t)i) & before) |
            own;
        for (int bit = 0; bit < SOBOL_BITS; bit++)
            scrambled[bit] |= __builtin_parityll(direction[bit] & row) ? own : 0;
    }
    memcpy(direction, scrambled, sizeof scrambled);
}

static bool make_directions(struct doe *s, size_t n)
{
    uint64_t direction[SOBOL_BITS];
    s->direction = calloc(sequences(s) * DOE_MAX_BITS * n, sizeof *s->direction);
    s->shift = calloc(sequences(s) * n, sizeof *s->shift);
    const bool good = s->direction && s->shift;
    for (uint64_t r = 0; good && r < sequences(s); r++) {
        for (size_t d = 0; d < n; d++) {
            sobol_directions(d, UNIT_BITS, direction);
            scramble(s, r, d, direction);
            for (size_t bit = 0; bit < DOE_MAX_BITS; bit++)
                s->direction[(r * DOE_MAX_BITS + bit) * n + d] = direction[bit];
            s->shift[r * n + d] = random_bits(s, PURPOSE_SHIFT, r, d) >> (64 - UNIT_BITS);
        }
    }
    return good;
}

/* Scrambled point as integers of 53 bits. */
static void sobol_point(const struct doe *s, size_t n, uint64_t point, uint64_t *x)
{
    const uint64_t sequence = point % sequences(s), number = point / sequences(s);
    const uint64_t gray = number ^ number >> 1;
    const uint64_t *direction = s->direction + sequence * DOE_MAX_BITS * n;
    for (size_t d = 0; d < n; d++) {
        x[d] = s->shift[sequence * n + d];
        for (size_t bit = 0; gray >> bit; bit++)
            x[d] ^= gray >> bit & 1 ? direction[bit * n + d] : 0;
    }
}

/* ---- methods --------------------------------------------------------------------------------- */

static void random_units(const struct doe *s, uint64_t point, double *u)
{
    for (size_t j = 0; j < s->factors; j++)
        u[j] = random_unit(s, point, j);
}

static void lhs_unit(const struct doe *s, uint64_t point, double *u)
{
    for (size_t j = 0; j < s->factors; j++) {
        const double place = s->stratum[j * s->count + point] + random_unit(s, point, j);
        /* The last number below the stratum's end where rounding would leave it. */
        const double end = (s->stratum[j * s->count + point] + 1.0) / (double)s->count;
        u[j] = fmin(place / (double)s->count, nextafter(end, 0));
    }
}

static void sobol_unit(const struct doe *s, uint64_t point, double *u)
{
    uint64_t x[DOE_MAX_FACTORS];
    sobol_point(s, s->factors, point, x);
    for (size_t j = 0; j < s->factors; j++)
        u[j] = unit_number(x[j]);
}

static void saltelli_unit(const struct doe *s, uint64_t point, double *u)
{
    const size_t k = s->factors;
    const uint64_t block = doe_block(s), place = point % block;
    uint64_t x[DOE_MAX_FACTORS] = {0};

    sobol_point(s, 2 * k, point / block, x);
    /* B and BA_j take after the second half but for factor j, A and AB_j after the first. */
    const bool second = place > k;
    const size_t other = place == 0 || place + 1 == block ? k : (size_t)(place - 1) % k;
    for (size_t j = 0; j < k; j++)
        u[j] = unit_number(x[second != (j == other) ? k + j : j]);
}

static void morris_unit(const struct doe *s, uint64_t point, double *u)
{
    const uint64_t block = doe_block(s), trajectory = point / block, place = point % block;
    const uint32_t half = (uint32_t)s->levels / 2;
    uint32_t order[DOE_MAX_FACTORS];

    random_order(s, trajectory, order, s->factors);
    for (uint64_t i = 0; i < s->factors; i++) {
        /* A lower level, its partner half the levels above it, and which of the two is first. */
        const uint32_t draw =
            below(random_bits(s, PURPOSE_POINT, trajectory, order[i]), (uint64_t)half * 2);
        const bool upper = (draw >= half) != (i < place);
        u[order[i]] = (double)(draw % half + (upper ? half : 0)) / (double)(s->levels - 1);
    }
}

static void sphere_unit(const struct doe *s, uint64_t point, double *u)
{
    const size_t k = s->factors;
    uint64_t x[DOE_MAX_FACTORS] = {0};
    double direction[DOE_MAX_FACTORS], square = 0;

    sobol_point(s, dimensions(s), point, x);
    if (k == 2) {
        const double angle = 2 * M_PI * unit_number(x[0]);
        double sine, cosine;
        stance_sincos(angle, &sine, &cosine);
        u[0] = 0.5 + 0.5 * cosine;
        u[1] = 0.5 + 0.5 * sine;
        return;
    }
    for (size_t j = 0; j < k; j++) {
        /* of odd multiples of 2^-53: inside (0, 1), and never a half */
        direction[j] = gsl_cdf_ugaussian_Pinv(unit_number(x[j] | 1));
        square += direction[j] * direction[j];
    }
    for (size_t j = 0; j < k; j++)
        u[j] = 0.5 + 0.5 * direction[j] / sqrt(square);
}

/* ---- the interface --------------------------------------------------------------------------- */

/* Before it had a name, GSL's direction numbers and a shift. */
const char *doe_generator(enum doe_method method)
{
    const bool sequence = method == DOE_SOBOL || method == DOE_SALTELLI || method == DOE_SPHERE;
    return sequence ? "joe-kuo-scrambled" : "";
}

size_t doe_most_factors(enum doe_method method)
{
    return method == DOE_SALTELLI ? DOE_MAX_FACTORS / 2 : DOE_MAX_FACTORS;
}

uint64_t doe_block(const struct doe *s)
{
    switch (s->method) {
    case DOE_SALTELLI:
        return (s->second_order ? 2 : 1) * s->factors + 2;
    case DOE_MORRIS:
        return s->factors + 1;
    default:
        return 1;
    }
}

uint64_t doe_points(const struct doe *s)
{
    return s->count * doe_block(s);
}

bool doe_begin(struct doe *s)
{
    const size_t n = dimensions(s);

    s->direction = NULL;
    s->shift = NULL;
    s->stratum = NULL;
    if (s->method == DOE_LHS) {
        s->stratum = calloc(s->factors * s->count, sizeof *s->stratum);
        for (size_t j = 0; s->stratum && j < s->factors; j++)
            random_order(s, j, s->stratum + j * s->count, s->count);
        return s->stratum != NULL;
    }
    return n == 0 || make_directions(s, n);
}

void doe_end(struct doe *s)
{
    free(s->direction);
    free(s->shift);
    free(s->stratum);
    s->direction = NULL;
    s->shift = NULL;
    s->stratum = NULL;
}

void doe_unit(const struct doe *s, uint64_t point, double *u)
{
    static void (*const unit[])(const struct doe *, uint64_t, double *) = {
        [DOE_RANDOM] = random_units,    [DOE_LHS] = lhs_unit,       [DOE_SOBOL] = sobol_unit,
        [DOE_SALTELLI] = saltelli_unit, [DOE_MORRIS] = morris_unit, [DOE_SPHERE] = sphere_unit,
    };
    unit[s->method](s, point, u);
}
