/* The kernels' sine and cosine against libm's long double ones. */
#include "support.h"

TEST(accuracy)
{
    uint64_t seed = 1;
    double worst = 0;
    for (int i = 0; i < 3000000; i++) {
        double x = uniform(&seed, -1e4, 1e4), s, c;
        if (i % 3 == 1)
            x /= 1e3;
        if (i % 3 == 2) /* around the multiples of pi/4, where reduction cancels */
            x = nearbyint(x / M_PI_4) * M_PI_4 * (1 + 1e-15 * (i % 7 - 3));
        if (fabs(x) > 1e4)
            continue;
        stance_sincos(x, &s, &c);
        worst = fmax(worst, (double)fabsl(s - sinl(x)));
        worst = fmax(worst, (double)fabsl(c - cosl(x)));
    }
    print_message("# largest absolute error %.3g\n", worst);
    assert_true(worst < 2.5e-16);
}

TEST(exact_points)
{
    double s, c;
    stance_sincos(0, &s, &c);
    assert_true(s == 0 && c == 1);
    stance_sincos(-0.0, &s, &c);
    assert_true(s == 0 && c == 1);
    stance_sincos(1e-300, &s, &c);
    assert_true(s == 1e-300 && c == 1);
}

TEST(beyond_the_range)
{
    const double beyond[] = {1e4 + 1e-8, -1e4 - 1e-8, 1e300, INFINITY, -INFINITY, NAN};
    double s, c;
    for (size_t i = 0; i < COUNT(beyond); i++) {
        stance_sincos(beyond[i], &s, &c);
        assert_true(isnan(s) && isnan(c));
    }
    stance_sincos(1e4, &s, &c);
    assert_true(fabs(s - sin(1e4)) < 2.5e-16 && fabs(c - cos(1e4)) < 2.5e-16);
}
