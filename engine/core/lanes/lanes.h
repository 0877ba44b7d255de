/* lanes.h - a vector of STANCE_LANES doubles, one simulation in each lane, and masks over it.
 *
 * The stepping core is written once against these few operations and compiled for 1, 2, 4 and 8
 * lanes. Everything is plain IEEE arithmetic (+ - * / fma, square roots and comparisons), and the
 * compiler contracts nothing: products are fused with sums where the source says so. A lane
 * computes the same bits whatever the width. Control flow is by masks: `choose(m, a, b)`.
 *
 * What lanes share a bundle must not change a bit. Lanes know of each other through mask_any alone
 * (and through the counters of struct bundle, see bundle_some): it is a hint that some lane needs
 * what follows, which must then do nothing to the lanes that do not. Whoever asks it may be told
 * yes without need: compiled with STANCE_DOUBT it says so at random, and tests/test_lanes.c holds
 * that to the same bits.
 *
 * lanes_fma(a, b, c) is a * b + c rounded once, lanes_fms(a, b, c) a * b - c, and
 * lanes_fnma(a, b, c) c - a * b: an instruction each; emulated in fma.h in the two lanes of SSE2
 * and WebAssembly (not the relaxed one, whose results are the browser's choice), which have none;
 * by the C library, as exactly, in one lane compiled for processors without.
 */
#ifndef STANCE_CORE_LANES_LANES_H
#define STANCE_CORE_LANES_LANES_H

#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#ifndef STANCE_LANES
#error "STANCE_LANES is 1, 2, 4 or 8"
#endif

enum { LANES = STANCE_LANES };

#if STANCE_LANES == 2 && !defined(__aarch64__)
#define LANES_EMULATE_FMA
#endif

/* Functions of the inner loop, compiled anew for what each caller knows; and those that are not.
 * Where multiply-adds are emulated, or nothing is constant, nothing is gained by the first, and
 * compiling takes long. */
#if defined(LANES_EMULATE_FMA) || defined(TREE_RUNTIME)
#define HOT static inline
#else
#define HOT static inline __attribute__((always_inline))
#endif
#ifdef __clang__
#define COLD static __attribute__((noinline))
#else
#define COLD static __attribute__((noinline, noclone))
#endif
/* Functions of a set of contacts: compiled anew for each that is a constant. */
#ifdef TREE_RUNTIME
#define PER_SET COLD
#else
#define PER_SET HOT
#endif

/* for (int i = from; i < to; i++), unrolled so early that arrays of the bodies live in registers,
 * and that what is structure folds. Not where the structure is read at run time. */
#ifdef TREE_RUNTIME
#define EACH(i, from, to) for (int i = (from); i < (to); i++)
#else
#define EACH(i, from, to) _Pragma("GCC unroll 16") for (int i = (from); i < (to); i++)
#endif

/* Length of an array that may be empty: a scene without actuators, say. */
#define SLOTS(n) ((n) > 0 ? (n) : 1)

/* What each instruction set has: a vector and a mask over it, and the operations. */
#if STANCE_LANES == 1

typedef double lanes;
typedef bool mask;
#define LANES_ALL true
#define LANES_NOT(m) (!(m))
#define ISA_OF(x) (x)
#define ISA_LESS(a, b) ((a) < (b))
#define ISA_LESS_EQUAL(a, b) ((a) <= (b))
#define ISA_CHOOSE(m, a, b) ((m) ? (a) : (b))
#define ISA_ANY(m) ((m) || lanes_doubt())
#define ISA_ABS(a) fabs(a)
#define ISA_SQRT(a) __builtin_sqrt(a)
#define ISA_FMA(a, b, c) __builtin_fma(a, b, c)
#define ISA_FMS(a, b, c) __builtin_fma(a, b, -(c))
#define ISA_FNMA(a, b, c) __builtin_fma(-(a), b, c)

#elif STANCE_LANES == 8 && defined(__AVX512F__)

#include <immintrin.h>
typedef double lanes __attribute__((vector_size(64), may_alias));
typedef __mmask8 mask;
#define LANES_ALL ((mask)0xff)
#define LANES_NOT(m) ((mask) ~(m))
#define ISA_OF(x) _mm512_set1_pd(x)
#define ISA_LESS(a, b) _mm512_cmp_pd_mask(a, b, _CMP_LT_OQ)
#define ISA_LESS_EQUAL(a, b) _mm512_cmp_pd_mask(a, b, _CMP_LE_OQ)
#define ISA_CHOOSE(m, a, b) _mm512_mask_blend_pd(m, b, a)
#define ISA_ANY(m) ((m) != 0)
#define ISA_ABS(a) _mm512_abs_pd(a)
#define ISA_SQRT(a) _mm512_sqrt_pd(a)
#define ISA_FMA(a, b, c) _mm512_fmadd_pd(a, b, c)
#define ISA_FMS(a, b, c) _mm512_fmsub_pd(a, b, c)
#define ISA_FNMA(a, b, c) _mm512_fnmadd_pd(a, b, c)

#elif STANCE_LANES == 4 && defined(__AVX2__) && defined(__FMA__)

#include <immintrin.h>
typedef double lanes __attribute__((vector_size(32), may_alias));
typedef int64_t mask __attribute__((vector_size(32)));
#define LANES_ALL ((mask){-1, -1, -1, -1})
#define LANES_NOT(m) (~(m))
#define ISA_OF(x) _mm256_set1_pd(x)
#define ISA_LESS(a, b) ((mask)((a) < (b)))
#define ISA_LESS_EQUAL(a, b) ((mask)((a) <= (b)))
#define ISA_CHOOSE(m, a, b) _mm256_blendv_pd(b, a, (__m256d)(m))
#define ISA_ANY(m) (_mm256_movemask_pd((__m256d)(m)) != 0)
#define ISA_ABS(a) _mm256_andnot_pd(_mm256_set1_pd(-0.0), a)
#define ISA_SQRT(a) _mm256_sqrt_pd(a)
#define ISA_FMA(a, b, c) _mm256_fmadd_pd(a, b, c)
#define ISA_FMS(a, b, c) _mm256_fmsub_pd(a, b, c)
#define ISA_FNMA(a, b, c) _mm256_fnmadd_pd(a, b, c)

#elif STANCE_LANES == 2

typedef double lanes __attribute__((vector_size(16), may_alias));
typedef int64_t mask __attribute__((vector_size(16)));
#define LANES_ALL ((mask){-1, -1})
#define LANES_NOT(m) (~(m))
#define ISA_OF(x) ((lanes){x, x})
#if defined(__x86_64__)
/* Intrinsics, because of GCC's vectors gcc 12 makes selections that SSE2 lacks. */
#include <emmintrin.h>
#define ISA_LESS(a, b) ((mask)_mm_cmplt_pd(a, b))
#define ISA_LESS_EQUAL(a, b) ((mask)_mm_cmple_pd(a, b))
#define ISA_EQUAL(a, b) ((mask)_mm_cmpeq_pd(a, b))
#define ISA_CHOOSE(m, a, b) _mm_or_pd(_mm_and_pd((__m128d)(m), a), _mm_andnot_pd((__m128d)(m), b))
#define ISA_ANY(m) (_mm_movemask_pd((__m128d)(m)) != 0)
#define ISA_ABS(a) _mm_andnot_pd(_mm_set1_pd(-0.0), a)
#define ISA_SQRT(a) _mm_sqrt_pd(a)
#else
#define ISA_LESS(a, b) ((mask)((a) < (b)))
#define ISA_LESS_EQUAL(a, b) ((mask)((a) <= (b)))
#define ISA_EQUAL(a, b) ((mask)((a) == (b)))
#if defined(__wasm_simd128__)
#include <wasm_simd128.h>
#define ISA_CHOOSE(m, a, b) ((lanes)wasm_v128_bitselect((v128_t)(a), (v128_t)(b), (v128_t)(m)))
#define ISA_ANY(m) wasm_v128_any_true((v128_t)(m))
#define ISA_ABS(a) ((lanes)wasm_f64x2_abs((v128_t)(a)))
#define ISA_SQRT(a) ((lanes)wasm_f64x2_sqrt((v128_t)(a)))
#elif defined(__aarch64__)
#include <arm_neon.h>
#define ISA_CHOOSE(m, a, b) ((lanes)(((mask)(a) & (m)) | ((mask)(b) & ~(m))))
#define ISA_ANY(m) (((m)[0] | (m)[1]) != 0)
#define ISA_ABS(a) vabsq_f64(a)
#define ISA_SQRT(a) vsqrtq_f64(a)
#define ISA_FMA(a, b, c) vfmaq_f64(c, a, b)
#define ISA_FMS(a, b, c) vfmaq_f64(-(c), a, b)
#define ISA_FNMA(a, b, c) vfmsq_f64(c, a, b)
#else
#error "no lanes of this width for these compiler flags"
#endif
#endif

#else
#error "no lanes of this width for these compiler flags"
#endif

#if STANCE_LANES == 1 && defined(STANCE_DOUBT)
static inline bool lanes_doubt(void)
{
    static uint64_t state = 88172645463325252u;
    state ^= state << 13, state ^= state >> 7, state ^= state << 17; /* Marsaglia 2003 */
    return state % 3 == 0;
}
#else
static inline bool lanes_doubt(void)
{
    return false;
}
#endif
static inline lanes lanes_of(double x)
{
    return ISA_OF(x);
}
static inline mask mask_less(lanes a, lanes b)
{
    return ISA_LESS(a, b);
}
static inline mask mask_less_equal(lanes a, lanes b)
{
    return ISA_LESS_EQUAL(a, b);
}
static inline lanes choose(mask m, lanes a, lanes b)
{
    return ISA_CHOOSE(m, a, b);
}
static inline bool mask_any(mask m)
{
    return ISA_ANY(m);
}
static inline lanes lanes_abs(lanes a)
{
    return ISA_ABS(a);
}
static inline lanes lanes_sqrt(lanes a)
{
    return ISA_SQRT(a);
}
/* NAN is not finite, neither is an infinity. */
static inline mask mask_finite(lanes a)
{
    return mask_less_equal(lanes_abs(a), lanes_of(1.7976931348623157e308));
}
#ifdef LANES_EMULATE_FMA
static inline mask mask_equal(lanes a, lanes b)
{
    return ISA_EQUAL(a, b);
}
#include "fma.h"
#define ISA_FMA(a, b, c) fma_emulated(a, b, c)
#define ISA_FMS(a, b, c) fma_emulated(a, b, -(c))
#define ISA_FNMA(a, b, c) fma_emulated(-(a), b, c)
#endif
static inline lanes lanes_fma(lanes a, lanes b, lanes c)
{
    return ISA_FMA(a, b, c);
}
static inline lanes lanes_fms(lanes a, lanes b, lanes c)
{
    return ISA_FMS(a, b, c);
}
static inline lanes lanes_fnma(lanes a, lanes b, lanes c)
{
    return ISA_FNMA(a, b, c);
}

#define MASK_NONE LANES_NOT(LANES_ALL)

/* `choose` where the compiler may know that m holds in all lanes that matter. */
HOT lanes choose_unless(bool all, mask m, lanes a, lanes b)
{
    return all ? a : choose(m, a, b);
}

/* min and max as comparisons spell them: the second operand where the first is NAN. */
static inline lanes lanes_max(lanes a, lanes b)
{
    return choose(mask_less(b, a), a, b);
}
static inline lanes lanes_min(lanes a, lanes b)
{
    return choose(mask_less(a, b), a, b);
}
/* The sign of x; 0 where it is no larger than `none`. */
static inline lanes lanes_sign(lanes x, lanes none)
{
    const lanes sign = choose(mask_less(x, lanes_of(0)), lanes_of(-1), lanes_of(1));
    return choose(mask_less(none, lanes_abs(x)), sign, lanes_of(0));
}
/* 1 where m holds, else 0. */
static inline lanes lanes_where(mask m)
{
    return choose(m, lanes_of(1), lanes_of(0));
}
/* The largest size of n values, or `least`. */
HOT lanes lanes_largest(const lanes *v, int n, lanes least)
{
    EACH (i, 0, n)
        least = lanes_max(lanes_abs(v[i]), least);
    return least;
}

/* Takes a struct that consists of lanes over, where m holds. */
static inline void choose_all(mask m, const void *from, void *to, size_t size)
{
    const lanes *const a = from;
    lanes *const b = to;
    for (size_t i = 0; i < size / sizeof(lanes); i++)
        b[i] = choose(m, a[i], b[i]);
}

/* One lane read and written: at loading, finishing and recording only. */
static inline double lane_get(const lanes *v, int lane)
{
    double x;
    memcpy(&x, (const char *)v + (size_t)lane * sizeof x, sizeof x);
    return x;
}
static inline void lane_set(lanes *v, int lane, double x)
{
    memcpy((char *)v + (size_t)lane * sizeof x, &x, sizeof x);
}
/* One lane of a struct that consists of lanes becomes zero. */
static inline void lane_clear(void *all, size_t size, int lane)
{
    for (size_t i = 0; i < size / sizeof(lanes); i++)
        lane_set((lanes *)all + i, lane, 0);
}
static inline bool mask_get(mask m, int lane)
{
    const lanes v = lanes_where(m);
    return lane_get(&v, lane) != 0;
}
static inline mask mask_of_lane(int lane)
{
    lanes v = lanes_of(0);
    lane_set(&v, lane, 1);
    return mask_less(lanes_of(0), v);
}

#endif
