/* The fused operations of every instruction set against the C library's fma(), bit by bit: random
 * operands, and those that are hard to round. */
#include "support.h"

#include "lanes_fma.h"

enum { BATCH = 4096, BATCHES_PER_KIND = 400 };

static const struct {
    const char *isa;
    fused_function *function;
} fused[] = {
#define ISA(isa) {#isa, fused_##isa},
    STANCE_ISA_LIST
#undef ISA
};

static fused_function *function_of(const char *isa)
{
    for (size_t i = 0; i < COUNT(fused); i++)
        if (strcmp(isa, fused[i].isa) == 0)
            return fused[i].function;
    fail_msg("no test of %s", isa);
    return NULL;
}

static uint64_t random_bits(uint64_t *seed)
{
    uint64_t z = (*seed += 0x9e3779b97f4a7c15u);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}
static int random_int(uint64_t *seed, int low, int high)
{
    return low + (int)(random_bits(seed) % (uint64_t)(high - low + 1));
}
static double number(uint64_t bits)
{
    double x;
    memcpy(&x, &bits, sizeof x);
    return x;
}
static uint64_t bits_of(double x)
{
    uint64_t bits;
    memcpy(&bits, &x, sizeof bits);
    return bits;
}

/* Of either sign, with a whole significand, in [2^exponent, 2^(exponent + 1)), or subnormal. */
static double whole(uint64_t *seed, int exponent)
{
    const double x = ldexp(1 + (double)(random_bits(seed) >> 12) * 0x1p-52, exponent);
    return random_bits(seed) & 1 ? -x : x;
}

/* The same with few bits set, or nearly all: exact products, ties, carries. */
static double sparse(uint64_t *seed, int exponent)
{
    uint64_t bits = 0;
    for (int k = random_int(seed, 0, 4); k > 0; k--)
        bits ^= UINT64_C(1) << random_int(seed, 0, 51);
    if (random_bits(seed) & 1)
        bits = -bits & 0xfffffffffffff;
    const double x = ldexp(1 + (double)bits * 0x1p-52, exponent);
    return random_bits(seed) & 1 ? -x : x;
}
static double either(uint64_t *seed, int exponent)
{
    return random_bits(seed) & 1 ? whole(seed, exponent) : sparse(seed, exponent);
}

/* x moved by up to four units in the last place. */
static double near_to(uint64_t *seed, double x)
{
    return number(bits_of(x) + (uint64_t)random_int(seed, -4, 4));
}

/* ---- kinds of operands ---------------------------------------------------------------------- */

/* Whatever 64 bits mean: infinities, NANs, subnormal numbers among them. */
static void anything(uint64_t *seed, double *x)
{
    for (int k = 0; k < 3; k++)
        x[k] = number(random_bits(seed));
}
/* What simulations consist of. */
static void moderate(uint64_t *seed, double *x)
{
    for (int k = 0; k < 3; k++)
        x[k] = random_int(seed, 0, 15) ? either(seed, random_int(seed, -20, 20)) : 0;
}
/* c is minus the rounded product, or near to it. */
static void cancelling(uint64_t *seed, double *x)
{
    x[0] = either(seed, random_int(seed, -500, 500));
    x[1] = either(seed, random_int(seed, -500, 500));
    x[2] = near_to(seed, -(x[0] * x[1]));
}
/* The product is half a unit of c's last place, a hair more or less, or exactly. */
static void tying(uint64_t *seed, double *x)
{
    const int e = random_int(seed, -400, 400), f = random_int(seed, -400, 400);
    x[2] = either(seed, e);
    x[0] = near_to(seed, ldexp(1, f));
    x[1] = near_to(seed, ldexp(random_bits(seed) & 1 ? -1 : 1, e - f - random_int(seed, 51, 55)));
}
/* c is half a unit of the product's last place, so that what the product loses decides. */
static void halving(uint64_t *seed, double *x)
{
    x[0] = either(seed, random_int(seed, -300, 300));
    x[1] = either(seed, random_int(seed, -300, 300));
    int e;
    (void)frexp(x[0] * x[1], &e);
    x[2] = near_to(seed, ldexp(random_bits(seed) & 1 ? -1 : 1, e - random_int(seed, 51, 57)));
}
/* Product and c up to 120 binary places apart. */
static void apart(uint64_t *seed, double *x)
{
    const int e = random_int(seed, -300, 300), f = random_int(seed, -300, 300);
    x[0] = either(seed, e);
    x[1] = either(seed, f);
    x[2] = either(seed, e + f + random_int(seed, -120, 120));
}
/* Products about the smallest numbers and about the emulation's own threshold. */
static void tiny(uint64_t *seed, double *x)
{
    const int e = random_int(seed, -1080, -900), f = random_int(seed, -1074, 200);
    x[0] = either(seed, f);
    x[1] = either(seed, e - f < 1023 ? e - f : 1023);
    x[2] = random_int(seed, 0, 7) ? either(seed, random_int(seed, -1080, -890)) : 0;
    if (random_int(seed, 0, 3) == 0)
        x[2] = near_to(seed, -(x[0] * x[1]));
}
/* About the largest numbers: products that overflow, factors that hardly do not. */
static void huge(uint64_t *seed, double *x)
{
    const int f = random_int(seed, 0, 1023);
    x[0] = either(seed, f);
    x[1] = either(seed, random_int(seed, 1015, 1024) - f);
    x[2] = either(seed, random_int(seed, 960, 1023));
    if (random_int(seed, 0, 3) == 0)
        x[0] = near_to(seed, 0x1.ffffffcp1023), x[1] = either(seed, random_int(seed, -1074, 0));
    if (random_int(seed, 0, 3) == 0)
        x[2] = near_to(seed, -(x[0] * x[1]));
}
static void few_bits(uint64_t *seed, double *x)
{
    for (int k = 0; k < 3; k++)
        x[k] = sparse(seed, random_int(seed, -60, 60));
}

/* All triples of these, in the order of the calls. */
static void special(uint64_t *seed, double *x)
{
    static const double values[] = {0,
                                    1,
                                    1.5,
                                    3,
                                    1 + 0x1p-52,
                                    1 - 0x1p-53,
                                    0x1p-53,
                                    0x1p-1074,
                                    0x1p-1022,
                                    0x1.fffffffffffffp-1023,
                                    0x1p-960,
                                    0x1.fffffffffffffp-961,
                                    0x1p-537,
                                    0x1p512,
                                    0x1p970,
                                    0x1.fffffffffffffp1023,
                                    0x1.ffffffcp1023,
                                    INFINITY,
                                    NAN};
    enum { N = COUNT(values) };
    uint64_t i = (*seed)++;
    for (int k = 0; k < 3; k++, i /= 2 * N)
        x[k] = i % 2 ? -values[i / 2 % N] : values[i / 2 % N];
}

/* ---- the comparison ------------------------------------------------------------------------- */

static bool same(double x, double y)
{
    return bits_of(x) == bits_of(y) || (isnan(x) && isnan(y));
}

static void expect(const double (*operands)[3], double (*expected)[3])
{
    for (int i = 0; i < BATCH; i++) {
        const double a = operands[i][0], b = operands[i][1], c = operands[i][2];
        expected[i][0] = fma(a, b, c);
        expected[i][1] = fma(a, b, -c);
        expected[i][2] = fma(-a, b, c);
    }
}

static void compare(const char *isa, const double (*operands)[3], const double (*results)[3],
                    const double (*expected)[3])
{
    for (int i = 0; i < BATCH; i++)
        for (int k = 0; k < 3; k++)
            if (!same(results[i][k], expected[i][k]))
                fail_msg("%s: operation %d on %a, %a, %a gives %a, not %a", isa, k, operands[i][0],
                         operands[i][1], operands[i][2], results[i][k], expected[i][k]);
}

static void check(void (*kind)(uint64_t *, double *))
{
    static double operands[BATCH][3], results[BATCH][3], expected[BATCH][3];
    uint64_t seed = 2008;
    for (int batch = 0; batch < BATCHES_PER_KIND; batch++) {
        for (int i = 0; i < BATCH; i++)
            kind(&seed, operands[i]);
        expect((const double(*)[3])operands, expected);
        for (int rank = 0; stance_isa(rank); rank++) {
            const char *const isa = stance_isa(rank);
            function_of(isa)((const double(*)[3])operands, results, BATCH);
            compare(isa, (const double(*)[3])operands, (const double(*)[3])results,
                    (const double(*)[3])expected);
        }
    }
}

#define KIND(kind)                                                                                 \
    TEST(kind##_operands)                                                                          \
    {                                                                                              \
        check(kind);                                                                               \
    }
KIND(anything)
KIND(moderate)
KIND(cancelling)
KIND(tying)
KIND(halving)
KIND(apart)
KIND(tiny)
KIND(huge)
KIND(few_bits)
KIND(special)
