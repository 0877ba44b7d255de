/* sincos.h - sine and cosine of a vector of angles, the same bits on every processor.
 *
 * Reduction: n = round(2 x / pi), r = x - n pi/2 with pi/2 split into two parts of 33 bits and a
 * rest (Cody and Waite 1980), exact products for |n| < 2^20. On |r| <= pi/4 polynomials fitted at
 * Chebyshev nodes in 50 digits (degree 13 and 14, error below 1.5e-17). Absolute error below
 * 2.5e-16 for |x| <= 1e4 (tests/test_sincos.c measures it against libm); NAN beyond and for NAN.
 */
#ifndef STANCE_CORE_LANES_SINCOS_H
#define STANCE_CORE_LANES_SINCOS_H

#include "lanes.h"

#define SINCOS_LARGEST_ANGLE 1e4

static inline void lanes_sincos(lanes x, lanes *sine, lanes *cosine)
{
    const double round_bits =
        0x1.8p52; /* adding it leaves the nearest whole number in the low bits */
    const lanes shifted = lanes_fma(x, lanes_of(0x1.45f306dc9c883p-1), lanes_of(round_bits));
    const lanes n = shifted - round_bits;
    const lanes near =
        lanes_fnma(n, lanes_of(0x1.0b4611a6p-34), lanes_fnma(n, lanes_of(0x1.921fb544p+0), x));
    const lanes r = lanes_fnma(n, lanes_of(0x1.3198a2e037073p-69), near);
    const lanes t = r * r;

    lanes s = lanes_fma(lanes_of(0x1.5e0a4fb47ace3p-33), t, lanes_of(-0x1.ae6008d0f0520p-26));
    s = lanes_fma(s, t, lanes_of(0x1.71de37946eb45p-19));
    s = lanes_fma(s, t, lanes_of(-0x1.a01a019e820acp-13));
    s = lanes_fma(s, t, lanes_of(0x1.1111111110babp-7));
    s = lanes_fma(s, t, lanes_of(-0x1.5555555555555p-3));
    s = lanes_fma(r, t * s, r);

    lanes c = lanes_fma(lanes_of(-0x1.907cd8f26aa3fp-37), t, lanes_of(0x1.1eeb67d014ecep-29));
    c = lanes_fma(c, t, lanes_of(-0x1.27e4fa16cc1bcp-22));
    c = lanes_fma(c, t, lanes_of(0x1.a01a019f4ddfdp-16));
    c = lanes_fma(c, t, lanes_of(-0x1.6c16c16c16963p-10));
    c = lanes_fma(c, t, lanes_of(0x1.5555555555555p-5));
    c = 1 - lanes_fnma(t * t, c, 0.5 * t);

    /* The quadrant, n mod 4 in {-2 ... 2}, from arithmetic alone. */
    const lanes m =
        lanes_fnma(lanes_of(4), lanes_fma(n, lanes_of(0.25), lanes_of(round_bits)) - round_bits, n);
    const lanes quadrant = lanes_abs(m);
    const mask odd = mask_less(lanes_abs(quadrant - 1), lanes_of(0.5));
    const mask in_range = mask_less_equal(lanes_abs(x), lanes_of(SINCOS_LARGEST_ANGLE));
    const lanes first = choose(odd, c, s), second = choose(odd, s, c);
    /* m = 0: (s, c); 1: (c, -s); -1: (-c, s); +-2: (-s, -c). */
    const mask flip_sine = mask_less(lanes_of(1.5), quadrant) | mask_less(m, lanes_of(-0.5));
    const mask flip_cosine = mask_less(lanes_of(0.5), m) | mask_less(m, lanes_of(-1.5));
    *sine = choose(in_range, choose(flip_sine, -first, first), lanes_of(NAN));
    *cosine = choose(in_range, choose(flip_cosine, -second, second), lanes_of(NAN));
}

/* The same of one angle. */
static inline void angle_sincos(double angle, double *sine, double *cosine)
{
    lanes s, c;
    lanes_sincos(lanes_of(angle), &s, &c);
    *sine = lane_get(&s, 0);
    *cosine = lane_get(&c, 0);
}

#endif
