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

#if STANCE_LANES == 1

typedef double lanes;
typedef bool mask;

#define LANES_ALL true
#define LANES_NOT(m) (!(m))
static inline lanes lanes_of(double x)
{
    return x;
}
static inline mask mask_less(lanes a, lanes b)
{
    return a < b;
}
static inline mask mask_less_equal(lanes a, lanes b)
{
    return a <= b;
}
static inline lanes choose(mask m, lanes a, lanes b)
{
    return m ? a : b;
}
#ifdef STANCE_DOUBT
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
static inline bool mask_any(mask m)
{
    return m || lanes_doubt();
}
static inline lanes lanes_abs(lanes a)
{
    return fabs(a);
}
static inline lanes lanes_sqrt(lanes a)
{
    return __builtin_sqrt(a);
}
static inline lanes lanes_fma(lanes a, lanes b, lanes c)
{
    return __builtin_fma(a, b, c);
}
static inline lanes lanes_fms(lanes a, lanes b, lanes c)
{
    return __builtin_fma(a, b, -c);
}
static inline lanes lanes_fnma(lanes a, lanes b, lanes c)
{
    return __builtin_fma(-a, b, c);
}

#elif STANCE_LANES == 8 && defined(__AVX512F__)

#include <immintrin.h>
typedef double lanes __attribute__((vector_size(64), may_alias));
typedef __mmask8 mask;

#define LANES_ALL ((mask)0xff)
#define LANES_NOT(m) ((mask) ~(m))
static inline lanes lanes_of(double x)
{
    return _mm512_set1_pd(x);
}
static inline mask mask_less(lanes a, lanes b)
{
    return _mm512_cmp_pd_mask(a, b, _CMP_LT_OQ);
}
static inline mask mask_less_equal(lanes a, lanes b)
{
    return _mm512_cmp_pd_mask(a, b, _CMP_LE_OQ);
}
static inline lanes choose(mask m, lanes a, lanes b)
{
    return _mm512_mask_blend_pd(m, b, a);
}
static inline bool mask_any(mask m)
{
    return m != 0;
}
static inline lanes lanes_abs(lanes a)
{
    return _mm512_abs_pd(a);
}
static inline lanes lanes_sqrt(lanes a)
{
    return _mm512_sqrt_pd(a);
}
static inline lanes lanes_fma(lanes a, lanes b, lanes c)
{
    return _mm512_fmadd_pd(a, b, c);
}
static inline lanes lanes_fms(lanes a, lanes b, lanes c)
{
    return _mm512_fmsub_pd(a, b, c);
}
static inline lanes lanes_fnma(lanes a, lanes b, lanes c)
{
    return _mm512_fnmadd_pd(a, b, c);
}

#elif STANCE_LANES == 4 && defined(__AVX2__) && defined(__FMA__)

#include <immintrin.h>
typedef double lanes __attribute__((vector_size(32), may_alias));
typedef int64_t mask __attribute__((vector_size(32)));

#define LANES_ALL ((mask){-1, -1, -1, -1})
#define LANES_NOT(m) (~(m))
static inline lanes lanes_of(double x)
{
    return _mm256_set1_pd(x);
}
static inline mask mask_less(lanes a, lanes b)
{
    return (mask)(a < b);
}
static inline mask mask_less_equal(lanes a, lanes b)
{
    return (mask)(a <= b);
}
static inline lanes choose(mask m, lanes a, lanes b)
{
    return _mm256_blendv_pd(b, a, (__m256d)m);
}
static inline bool mask_any(mask m)
{
    return _mm256_movemask_pd((__m256d)m) != 0;
}
static inline lanes lanes_abs(lanes a)
{
    return _mm256_andnot_pd(_mm256_set1_pd(-0.0), a);
}
static inline lanes lanes_sqrt(lanes a)
{
    return _mm256_sqrt_pd(a);
}
static inline lanes lanes_fma(lanes a, lanes b, lanes c)
{
    return _mm256_fmadd_pd(a, b, c);
}
static inline lanes lanes_fms(lanes a, lanes b, lanes c)
{
    return _mm256_fmsub_pd(a, b, c);
}
static inline lanes lanes_fnma(lanes a, lanes b, lanes c)
{
    return _mm256_fnmadd_pd(a, b, c);
}

#elif STANCE_LANES == 2 && defined(__x86_64__)

#include <emmintrin.h>
typedef double lanes __attribute__((vector_size(16), may_alias));
typedef int64_t mask __attribute__((vector_size(16)));

#define LANES_ALL ((mask){-1, -1})
#define LANES_NOT(m) (~(m))
static inline lanes lanes_of(double x)
{
    return (lanes){x, x};
}
/* Intrinsics, because of GCC's vectors gcc 12 makes selections that SSE2 lacks. */
static inline mask mask_less(lanes a, lanes b)
{
    return (mask)_mm_cmplt_pd(a, b);
}
static inline mask mask_less_equal(lanes a, lanes b)
{
    return (mask)_mm_cmple_pd(a, b);
}
static inline lanes choose(mask m, lanes a, lanes b)
{
    return _mm_or_pd(_mm_and_pd((__m128d)m, a), _mm_andnot_pd((__m128d)m, b));
}
static inline bool mask_any(mask m)
{
    return _mm_movemask_pd((__m128d)m) != 0;
}
static inline mask mask_equal(lanes a, lanes b)
{
    return (mask)_mm_cmpeq_pd(a, b);
}
static inline lanes lanes_abs(lanes a)
{
    return _mm_andnot_pd(_mm_set1_pd(-0.0), a);
}
static inline lanes lanes_sqrt(lanes a)
{
    return _mm_sqrt_pd(a);
}

#elif STANCE_LANES == 2 && defined(__wasm_simd128__)

#include <wasm_simd128.h>
typedef double lanes __attribute__((vector_size(16), may_alias));
typedef int64_t mask __attribute__((vector_size(16)));

#define LANES_ALL ((mask){-1, -1})
#define LANES_NOT(m) (~(m))
static inline lanes lanes_of(double x)
{
    return (lanes){x, x};
}
static inline mask mask_less(lanes a, lanes b)
{
    return (mask)(a < b);
}
static inline mask mask_less_equal(lanes a, lanes b)
{
    return (mask)(a <= b);
}
static inline lanes choose(mask m, lanes a, lanes b)
{
    return (lanes)wasm_v128_bitselect((v128_t)a, (v128_t)b, (v128_t)m);
}
static inline bool mask_any(mask m)
{
    return wasm_v128_any_true((v128_t)m);
}
static inline mask mask_equal(lanes a, lanes b)
{
    return (mask)(a == b);
}
static inline lanes lanes_abs(lanes a)
{
    return (lanes)wasm_f64x2_abs((v128_t)a);
}
static inline lanes lanes_sqrt(lanes a)
{
    return (lanes)wasm_f64x2_sqrt((v128_t)a);
}

#elif STANCE_LANES == 2 && defined(__aarch64__)

#include <arm_neon.h>
typedef double lanes __attribute__((vector_size(16), may_alias));
typedef int64_t mask __attribute__((vector_size(16)));

#define LANES_ALL ((mask){-1, -1})
#define LANES_NOT(m) (~(m))
static inline lanes lanes_of(double x)
{
    return (lanes){x, x};
}
static inline mask mask_less(lanes a, lanes b)
{
    return (mask)(a < b);
}
static inline mask mask_less_equal(lanes a, lanes b)
{
    return (mask)(a <= b);
}
static inline lanes choose(mask m, lanes a, lanes b)
{
    return (lanes)(((mask)a & m) | ((mask)b & ~m));
}
static inline bool mask_any(mask m)
{
    return (m[0] | m[1]) != 0;
}
static inline lanes lanes_abs(lanes a)
{
    return vabsq_f64(a);
}
static inline lanes lanes_sqrt(lanes a)
{
    return vsqrtq_f64(a);
}
static inline lanes lanes_fma(lanes a, lanes b, lanes c)
{
    return vfmaq_f64(c, a, b);
}
static inline lanes lanes_fms(lanes a, lanes b, lanes c)
{
    return vfmaq_f64(-c, a, b);
}
static inline lanes lanes_fnma(lanes a, lanes b, lanes c)
{
    return vfmsq_f64(c, a, b);
}

#else
#error "no lanes of this width for these compiler flags"
#endif

#ifdef LANES_EMULATE_FMA
#include "fma.h"
static inline lanes lanes_fma(lanes a, lanes b, lanes c)
{
    return fma_emulated(a, b, c);
}
static inline lanes lanes_fms(lanes a, lanes b, lanes c)
{
    return fma_emulated(a, b, -c);
}
static inline lanes lanes_fnma(lanes a, lanes b, lanes c)
{
    return fma_emulated(-a, b, c);
}
#endif

#if STANCE_LANES > 1
static inline bool lanes_doubt(void)
{
    return false;
}
#endif

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
/* NAN is not finite, neither is an infinity. */
static inline mask mask_finite(lanes a)
{
    return mask_less_equal(lanes_abs(a), lanes_of(1.7976931348623157e308));
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
static inline bool mask_get(mask m, int lane)
{
    lanes v = choose(m, lanes_of(1), lanes_of(0));
    return lane_get(&v, lane) != 0;
}
static inline mask mask_of_lane(int lane)
{
    lanes v = lanes_of(0);
    lane_set(&v, lane, 1);
    return mask_less(lanes_of(0), v);
}

#endif
