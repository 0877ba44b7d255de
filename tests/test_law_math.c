/* test_law_math.c - the functions that laws of the user's own may call, against the C library's. */
#define STANCE_LANES 1
#include "tests.h"

#include "runner/objects/law/law_math.c"

/* In units of 2^-52 of the result; sine and cosine, which are absolute, apart. */
static double off(double got, double wanted)
{
    return wanted == 0 ? fabs(got) : fabs(got / wanted - 1) * 0x1p52;
}

static double wide(void)
{
    return (drand48() - 0.5) * pow(10, 12 * drand48() - 6);
}

TEST(close_to_the_library)
{
    double exps = 0, tanhs = 0, atans = 0, asins = 0, floors = 0;
    srand48(1);
    for (int i = 0; i < 300000; i++) {
        const double x = wide(), y = wide(), z = 1400 * (drand48() - 0.5), s = 2 * drand48() - 1;
        exps = fmax(exps, off(law_exp(z), exp(z)));
        tanhs = fmax(tanhs, off(law_tanh(x), tanh(x)));
        atans = fmax(atans, off(law_atan(x), atan(x)));
        atans = fmax(atans, off(law_atan2(y, x), atan2(y, x)));
        asins = fmax(asins, fmax(off(law_asin(s), asin(s)), off(law_acos(s), acos(s))));
        floors = fmax(floors, fabs(law_floor(x) - floor(x)));
        assert_true(fabs(law_sin(y) - sin(y)) < (fabs(y) > 1e4 ? INFINITY : 2.5e-16) ||
                    fabs(y) > 1e4);
    }
    assert_true(exps <= 2 && tanhs <= 4 && atans <= 5 && asins <= 5 && floors == 0);
}

TEST(same_at_the_edges)
{
    static const double edge[] = {0, -0.0, 1, -1, INFINITY, -INFINITY, NAN};
    for (size_t i = 0; i < 7; i++) {
        const double x = edge[i], got[] = {law_exp(x), law_tanh(x), law_atan(x), law_floor(x)},
                     wanted[] = {exp(x), tanh(x), atan(x), floor(x)};
        for (size_t k = 0; k < 4 && fabs(x) != 1; k++)
            assert_true((got[k] != got[k] && wanted[k] != wanted[k]) ||
                        (got[k] == wanted[k] && signbit(got[k]) == signbit(wanted[k])));
        for (size_t k = 0; k < 7; k++) {
            const double a = law_atan2(x, edge[k]), b = atan2(x, edge[k]);
            assert_true((a != a && b != b) || (a == b && signbit(a) == signbit(b)));
        }
    }
    assert_true(law_exp(-1000) == 0 && law_exp(1000) == INFINITY && law_exp(-740) == exp(-740));
}
