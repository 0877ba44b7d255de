/* Statistics of the analysis: intervals and quantiles against values computed by hand. */
#include "support.h"

#include "../analysis/statistics.h"

static void wilson(void **state)
{
    (void)state;
    /* Wilson's score interval with z = 1.959964: centre (p + z^2/2n)/(1 + z^2/n). */
    static const struct {
        uint64_t k, n;
        double low, high;
    } known[] = {{0, 10, 0, 0.277533}, {5, 10, 0.236593, 0.763407}, {10, 10, 0.722467, 1}};
    double low, high;
    for (size_t i = 0; i < sizeof known / sizeof known[0]; i++) {
        statistics_wilson(known[i].k, known[i].n, &low, &high);
        assert_true(fabs(low - known[i].low) < 1e-5);
        assert_true(fabs(high - known[i].high) < 1e-5);
    }
    statistics_wilson(0, 0, &low, &high);
    assert_true(low == 0 && high == 1);
}

static void quantiles(void **state)
{
    (void)state;
    double values[] = {5, NAN, 1, 3, 2, 4};
    struct statistics_numbers numbers;
    statistics_summarise(values, 6, &numbers);
    assert_int_equal(numbers.n, 5);
    assert_true(numbers.low == 1 && numbers.high == 5 && numbers.median == 3 && numbers.sum == 15);
    assert_true(fabs(numbers.q90 - 4.6) < 1e-12);
    statistics_summarise(values, 0, &numbers);
    assert_true(numbers.n == 0 && isnan(numbers.median));
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(wilson), cmocka_unit_test(quantiles)};
    return cmocka_run_group_tests_name("analysis", tests, NULL, NULL);
}
