/* Balance on one foot: both tests of the paper's section 3.2 with noise, what the free foot does,
 * the domain against an independently integrated pinned robot, friction used, and the critical
 * sample time found by simulation. */
#include "long.h"
#include "support.h"

#include "analysis/statistics/statistics.h"

static void run(const char *method, const stance_case *cases, stance_result *results, size_t n)
{
    run_cases(kernel_of(method, NULL), cases, results, n);
    for (size_t i = 0; i < n; i++)
        assert_int_equal(results[i].status, STANCE_DONE);
}

/* ---- section 3.2, tests 1 and 2 ---- */

enum { SEEDS = 100 };

static void count(double theta, uint32_t contacts, int outcome[5])
{
    for (int m = 0; m < 2; m++) {
        stance_case c[SEEDS];
        stance_result r[SEEDS];
        c[0] = balance_case(theta, 0);
        c[0].contacts = contacts;
        c[0].noise = 0.1;
        for (int i = 0; i < SEEDS; i++) {
            c[i] = c[0];
            c[i].seed = (uint64_t)i + 1;
        }
        run(m ? "midpoint" : "implicit", c, r, SEEDS);
        for (int i = 0; i < SEEDS; i++)
            outcome[r[i].outcome]++;
        assert_true(r[0].end_time != r[1].end_time || r[0].velocity[2] != r[1].velocity[2]);
    }
}

TEST(section_3_2)
{
    static const struct {
        const char *what;
        double theta;
        uint32_t contacts;
        int outcome, seeds; /* so many of both methods end so */
    } tests[] = {{"test 1 recovers", -0.04, 1, STANCE_STABILISED, 2 * SEEDS},
                 {"test 2 falls", 0.029, 1, STANCE_FELL, 2 * SEEDS},
                 {"test 1 scuffs with both feet", -0.04, 3, STANCE_STABILISED, 0}};
    for (int k = 0; k < 3; k++) {
        int outcome[5] = {0};
        count(tests[k].theta, tests[k].contacts, outcome);
        print_message("# %s: %d stabilised, %d fell, %d rested\n", tests[k].what,
                      outcome[STANCE_STABILISED], outcome[STANCE_FELL], outcome[STANCE_RESTED]);
        assert_int_equal(outcome[tests[k].outcome], tests[k].seeds);
    }
}

/* ---- the domain ---- */

TEST(interval_at_rest)
{
    enum { N = 721 };
    OWN stance_case *c = calloc(N, sizeof *c);
    OWN stance_result *r = calloc(N, sizeof *r);
    assert_true(c && r);
    const double from = -0.12, step = 0.00025;
    for (int i = 0; i < N; i++)
        c[i] = balance_case(from + step * i, 0);
    run("implicit", c, r, N);
    int first = -1, last = -1, inside = 0;
    for (int i = 0; i < N; i++)
        if (r[i].outcome == STANCE_STABILISED) {
            first = first < 0 ? i : first;
            last = i;
            inside++;
        }
    print_message("# stabilised from %.5f to %.5f rad\n", from + step * first, from + step * last);
    assert_int_equal(inside, last - first + 1);
    assert_true(fabs(from + step * first + 0.094) < 0.001);
    assert_true(fabs(from + step * last - 0.0185) < 0.0015);
}

TEST(friction_used_in_the_domain)
{
    enum { MOST = 96 };
    const int N = long_tests() ? MOST : MOST / 2;
    OWN stance_case *c = calloc((size_t)(N * N), sizeof *c);
    OWN stance_result *r = calloc((size_t)(N * N), sizeof *r);
    OWN double *used = calloc((size_t)(N * N), sizeof *used);
    assert_true(c && r && used);
    for (int i = 0; i < N; i++)
        for (int j = 0; j < N; j++)
            c[i * N + j] = balance_case(-0.12 + 0.18 * i / (N - 1), -0.6 + 1.2 * j / (N - 1));
    run("implicit", c, r, (size_t)(N * N));
    size_t n = 0;
    for (int i = 0; i < N * N; i++)
        if (r[i].outcome == STANCE_STABILISED)
            used[n++] = r[i].friction_used;
    statistics_sort(used, n);
    const double median = used[n - 1 - n / 2], q90 = used[n - 1 - n / 10],
                 q99 = used[n - 1 - n / 100];
    print_message("# friction used: median %.3f, 90 %% %.3f, 99 %% %.3f over %zu cases\n", median,
                  q90, q99, n);
    assert_true(fabs(median - 0.17) < 0.015);
    assert_true(fabs(q90 - 0.34) < 0.015);
    assert_true(fabs(q99 - 0.40) < 0.015);
}

/* Against the pinned robot with three coordinates, integrated by another program: equal labels
 * everywhere but within one cell of the boundary. */
TEST(domain_against_pinned_robot)
{
    enum { N = 64 };
    JSON *root = reference_load("tests/reference/pinned_basin.json");
    json_t *rows = json_object_get(root, "labels");
    json_t *gains = json_object_get(root, "gains"), *torques = json_object_get(root, "torques");
    assert_int_equal(json_array_size(rows), N);
    OWN stance_case *c = calloc(N * N, sizeof *c);
    OWN stance_result *r = calloc(N * N, sizeof *r);
    char(*label)[N + 1] = calloc(N, sizeof *label);
    assert_true(c && r && label);
    for (int i = 0; i < N; i++) {
        snprintf(label[i], N + 1, "%s", json_string_value(json_array_get(rows, (size_t)i)));
        for (int j = 0; j < N; j++) {
            stance_case *const k = &c[i * N + j];
            *k = balance_case(-0.12 + 0.18 * i / (N - 1), -0.6 + 1.2 * j / (N - 1));
            k->friction = 1e6; /* never slips */
            for (int a = 0; a < 2; a++) {
                json_t *row = json_array_get(gains, (size_t)a);
                k->near.feedforward[a] = json_number_value(json_array_get(torques, (size_t)a));
                for (int b = 0; b < 6; b++)
                    k->near.gain[a][b] = json_number_value(json_array_get(row, (size_t)b));
            }
        }
    }
    static const char *const methods[] = {"implicit", "midpoint"};
    for (int m = 0; m < (long_tests() ? 2 : 1); m++) {
        run(methods[m], c, r, N * N);
        int differ = 0, inside = 0;
        for (int i = 0; i < N; i++)
            for (int j = 0; j < N; j++) {
                const char mine = r[i * N + j].outcome == STANCE_STABILISED ? 's' : '-';
                if (mine == (label[i][j] == 's' ? 's' : '-'))
                    continue;
                differ++;
                bool boundary = false; /* a neighbour has another label in the reference */
                for (int a = i - 1; a <= i + 1; a++)
                    for (int b = j - 1; b <= j + 1; b++)
                        boundary |= a >= 0 && a < N && b >= 0 && b < N &&
                                    (label[a][b] == 's') != (label[i][j] == 's');
                inside += !boundary;
            }
        print_message("# %s: %d of %d cells differ, %d of them not at the boundary\n", methods[m],
                      differ, N * N, inside);
        assert_int_equal(inside, 0);
        assert_true(differ < N);
    }
    free(label);
}

/* ---- the critical sample time ---- */

/* Does an offset of 1e-7 rad grow between 10 s and 40 s with the torques held for T? */
static bool grows(const char *method, double T, double step)
{
    stance_case c = balance_case(1e-7, 0);
    const double per_sample = ceil(T / step - 1e-9);
    c.settle = false;
    c.sample_every = (int64_t)per_sample;
    c.step = T / per_sample;
    double size[2];
    for (int k = 0; k < 2; k++) {
        c.steps = (int64_t)(per_sample * nearbyint((k ? 40 : 10) / T));
        const stance_result r = run_done(method, &c);
        size[k] = 0;
        for (int i = 0; i < 3; i++)
            size[k] += pow(r.position[2 + i] - c.near.target[i], 2) + pow(r.velocity[2 + i] / 4, 2);
    }
    return size[1] > size[0];
}

static double simulated_limit(const char *method, double step)
{
    double low = 0.12, high = 0.15;
    while (high - low > 1e-5) {
        const double middle = (low + high) / 2;
        *(grows(method, middle, step) ? &high : &low) = middle;
    }
    return low;
}

TEST(critical_sample_time_by_simulation)
{
    const double theory = 0.1363;
    static const struct {
        const char *method;
        double step, shift, tolerance;
    } expected[] = {{"implicit", 1e-3, -0.003, 0.001},
                    {"implicit", 5e-3, -0.015, 0.002},
                    {"implicit", 1e-2, -0.029, 0.004},
                    {"midpoint", 5e-3, 0, 0.001}};
    for (size_t i = 0; i < COUNT(expected); i++) {
        const double T = simulated_limit(expected[i].method, expected[i].step);
        print_message("# %s, h = %g ms: %.5f s (%+.2f %%)\n", expected[i].method,
                      1e3 * expected[i].step, T, 100 * (T / theory - 1));
        assert_true(fabs(T / theory - 1 - expected[i].shift) < expected[i].tolerance);
    }
}
