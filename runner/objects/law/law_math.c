/* law_math.c - the functions of stance_law.h: the same bits on every machine.
 *
 * Sine and cosine are the engine's (sincos.h). exp(x) = 2^n exp(r), n the whole number nearest to
 * x / ln 2, |r| <= ln 2 / 2, by exp(r) - 1 = r + r^2/2 + ... + r^14/14!, whose rest is below 1e-18
 * (Cody and Waite 1980); tanh x = e / (e + 2), e = exp(2 x) - 1, for which 2^n and 2^n - 1 are
 * exact. An arc tangent is halved three times, atan x = 2 atan(x / (1 + sqrt(1 + x^2))), down to
 * 0.1, where its series up to x^15 is good to 1e-17. */
#include "law_math.h"

#include "engine/core/lanes/sincos.h"

double law_fma(double a, double b, double c);

double law_sin(double x)
{
    double sine, cosine;
    angle_sincos(x, &sine, &cosine);
    return sine;
}

double law_cos(double x)
{
    double sine, cosine;
    angle_sincos(x, &sine, &cosine);
    return cosine;
}

double law_fma(double a, double b, double c)
{
    const lanes sum = lanes_fma(lanes_of(a), lanes_of(b), lanes_of(c));
    return lane_get(&sum, 0);
}

double law_floor(double x)
{
    if (!(__builtin_fabs(x) < 0x1p52))
        return x;
    const double whole = (double)(int64_t)x;
    return __builtin_copysign(whole > x ? whole - 1 : whole, x);
}

/* 2^n, -1022 <= n <= 1023. */
static double power(int n)
{
    const uint64_t bits = (uint64_t)(n + 1023) << 52;
    double x;
    __builtin_memcpy(&x, &bits, sizeof x);
    return x;
}

/* *n and exp(r) - 1, for |x| < 800. */
static double reduced(double x, int *n)
{
    const double round_bits = 0x1.8p52;
    const double parts = law_fma(x, 1.4426950408889634, round_bits) - round_bits;
    double r = x - parts * 0x1.62e42feep-1,
           sum = 1.0 / 14; /* ln 2 in two parts, the first of 32 bits */
    r -= parts * 0x1.a39ef35793c76p-33;
    for (int k = 13; k > 0; k--) /* 1/k + r/k (1/(k+1) + ...) without 1/1 at the end */
        sum = k > 1 ? (1 + r * sum) / k : 1 + r * sum;
    *n = (int)parts;
    return r * sum;
}

double law_exp(double x)
{
    int n;
    if (!(x < 800))
        return x + INFINITY; /* NAN stays */
    if (x < -800)
        return 0;
    const double e = 1 + reduced(x, &n);
    return e * power(n / 2) * power(n - n / 2);
}

double law_tanh(double x)
{
    int n;
    const double size = __builtin_fabs(x);
    if (!(size < 20))
        return size == size ? __builtin_copysign(1, x) : x;
    const double less = reduced(2 * size, &n), e = less * power(n) + (power(n) - 1);
    return __builtin_copysign(e / (e + 2), x);
}

double law_tan(double x)
{
    double sine, cosine;
    angle_sincos(x, &sine, &cosine);
    return sine / cosine;
}

double law_atan(double x)
{
    const double size = __builtin_fabs(x), right = 0x1.921fb54442d18p+0;
    double t = size > 1 ? 1 / size : size, sum = 0;
    if (!(size <= 0x1p1023)) /* infinite, or NAN */
        return size == size ? __builtin_copysign(right, x) : x;
    for (int k = 0; k < 3; k++)
        t = t / (1 + __builtin_sqrt(1 + t * t));
    for (int k = 15; k > 1; k -= 2)
        sum = t * t * (sum + (k % 4 == 1 ? 1.0 : -1.0) / k);
    t = 8 * (t + t * sum);
    return __builtin_copysign(size > 1 ? right - t : t, x);
}

double law_atan2(double y, double x)
{
    const double right = 0x1.921fb54442d18p+0, up = __builtin_fabs(y), along = __builtin_fabs(x);
    if (x != x || y != y)
        return x + y;
    const bool same = up == along; /* both 0 or infinite, or half a right angle */
    const double angle = same         ? (up == 0 ? 0 : right / 2)
                         : up > along ? right - law_atan(along / up)
                                      : law_atan(up / along);
    return __builtin_copysign(__builtin_copysign(1, x) > 0 ? angle : 2 * right - angle, y);
}

double law_asin(double x)
{
    return law_atan2(x, __builtin_sqrt((1 - x) * (1 + x)));
}

double law_acos(double x)
{
    return law_atan2(__builtin_sqrt((1 - x) * (1 + x)), x);
}
