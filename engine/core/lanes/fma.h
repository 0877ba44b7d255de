/* fma.h - a * b + c rounded once, in two lanes, on processors that cannot: SSE2 alone, and
 * WebAssembly.
 *
 * Bit for bit what the instruction gives (which NAN it is excepted), from error-free
 * transformations. The product is p - q exactly (Dekker 1971, factors split into 26 bits and
 * 26 bits), p + c is high - low exactly (Knuth's TwoSum), so that the sum sought is
 * high - (low + q). Where low + q is not exact, rounding it to odd keeps on which side of every
 * rounding boundary of high - (low + q) it lies, and the last subtraction rounds as if it were the
 * only one (Boldo and Melquiond, IEEE Trans. Computers 57(4), 2008).
 *
 * A boundary, as a value of low + q, has four significant bits at most: if low is not zero then
 * |low + q| <= 1.5 ulp(high), while boundaries are multiples of ulp(high) / 4. So plain rounding
 * does as well unless it ends on a number of few bits. This is tested for, together with the range,
 * and what fails the test is done with care, in a function of its own. The transformations are
 * exact where no factor's head overflows and the error of the product does not underflow; sums
 * cannot underflow, and what overflows in between leaves an infinity or NAN that the test sees.
 */
#ifndef STANCE_CORE_LANES_FMA_H
#define STANCE_CORE_LANES_FMA_H

#include "lanes.h"

typedef uint64_t fma_bits __attribute__((vector_size(16)));

/* Products smaller than this may have an error below the smallest number there is. */
#define FMA_SMALLEST_PRODUCT 0x1p-960
/* Shifted to the left by this, a number of at most nine significant bits is zero. */
#define FMA_FEW_BITS 20

/* a rounded to 26 bits, by its representation: the rest has 26 too. Halfway cases are rounded down,
 * lest a subnormal number have a head of twice its size, too far off for an exact difference. */
static inline lanes fma_head(lanes a)
{
    return (lanes)(((fma_bits)a + ((UINT64_C(1) << 26) - 1)) & ~((UINT64_C(1) << 27) - 1));
}

/* What p = a * b gained in rounding; no difference here is -0. */
static inline lanes fma_product_gain(lanes a, lanes b, lanes p)
{
    const lanes a_head = fma_head(a), a_tail = a - a_head;
    const lanes b_head = fma_head(b), b_tail = b - b_head;
    return ((p - a_head * b_head) - a_head * b_tail - a_tail * b_head) - a_tail * b_tail;
}

/* What sum = a + b gained in rounding; nor here. */
static inline lanes fma_sum_gain(lanes a, lanes b, lanes sum)
{
    const lanes b_seen = sum - a;
    return ((sum - b_seen) - a) + (b_seen - b);
}

/* a + b where exact, else the neighbour of it with an odd last bit: sum towards zero, made odd. */
static inline lanes fma_add_to_odd(lanes a, lanes b)
{
    const lanes sum = a + b, gain = fma_sum_gain(a, b, sum);
    const fma_bits inexact = (fma_bits)~mask_equal(gain, lanes_of(0));
    const fma_bits beyond = ~((fma_bits)sum ^ (fma_bits)gain) >> 63; /* 1: rounded away from zero */
    return (lanes)(((fma_bits)sum - (beyond & inexact)) | (inexact & 1));
}

static inline mask fma_zero(lanes a)
{
    return mask_equal(a, lanes_of(0));
}

/* Every operand there is. */
static __attribute__((noinline, unused)) lanes fma_careful(lanes a, lanes b, lanes c)
{
    const lanes p = a * b, q = fma_product_gain(a, b, p);
    const lanes high = p + c, low = fma_sum_gain(p, c, high);
    /* A product that is exact because it is zero, infinite or NAN; c that is one of the latter. */
    const mask plain = fma_zero(a) | fma_zero(b) | ~(mask_finite(a) & mask_finite(b)) |
                       (mask_finite(p) & ~mask_finite(c));
    const mask sound =
        mask_less_equal(lanes_of(FMA_SMALLEST_PRODUCT), lanes_abs(p)) & mask_finite(low + q);
    lanes sum = choose(plain, high, high - fma_add_to_odd(low, q));
    for (int lane = 0; lane < LANES; lane++)
        if (!(plain | sound)[lane])
            sum[lane] = fma(a[lane], b[lane], c[lane]);
    return sum;
}

static inline lanes fma_emulated(lanes a, lanes b, lanes c)
{
    const lanes p = a * b, q = fma_product_gain(a, b, p);
    const lanes high = p + c, low = fma_sum_gain(p, c, high);
    /* Where there is no gain rest is +0, and the sum has the sign of `high`, be that zero. */
    const lanes rest = low + q, sum = high - rest;
    const mask few = fma_zero((lanes)((fma_bits)rest << FMA_FEW_BITS));
    const mask small = mask_less(lanes_abs(p), lanes_of(FMA_SMALLEST_PRODUCT));
    if (__builtin_expect(mask_any(few | small), 0)) {
        /* Mostly because a factor is zero or a product exact. rest - rest: zero, or NAN where
         * something has overflowed or was not finite. */
        const mask doubtful =
            (few & ~mask_equal(rest - rest, q)) | (small & ~(fma_zero(a) | fma_zero(b)));
        if (mask_any(doubtful))
            return fma_careful(a, b, c);
    }
    return sum;
}

#endif
