/* Jacobi's method against LAPACK, on matrices of every kind. */
#include <lapacke.h>

#include "cases.h"
#include "tests.h"

#include "runner/optimise/cma.h"

enum { MOST = 64 };

/* LAPACK's eigenvalues; residual, orthogonality and order of ours. */
static void check_eigen(int n, const double *a)
{
    static double copy[MOST * MOST], vector[MOST * MOST], lapack[MOST * MOST];
    double value[MOST], w[MOST], norm = 0;
    const size_t bytes = (size_t)(n * n) * sizeof *a;
    memcpy(copy, a, bytes);
    memcpy(lapack, a, bytes);
    symmetric_eigen(n, copy, value, vector);
    assert_int_equal(LAPACKE_dsyev(LAPACK_ROW_MAJOR, 'N', 'U', n, lapack, n, w), 0);
    for (int k = 0; k < n; k++)
        norm = fmax(norm, fabs(w[k]));
    const double most = 1e-15 * (10 + n);
    for (int k = 0; k < n; k++) {
        const double *const v = vector + k * n;
        assert_true(fabs(value[k] - w[k]) <= most * norm);
        assert_true(k == 0 || value[k - 1] <= value[k]);
        for (int i = 0; i < n; i++) {
            double residual = -value[k] * v[i], product = i == k ? -1 : 0;
            for (int j = 0; j < n; j++) {
                residual += a[i * n + j] * v[j];
                product += vector[i * n + j] * v[j];
            }
            assert_true(fabs(residual) <= most * norm && fabs(product) <= most);
        }
    }
}

enum kind { RANDOM, EQUAL, RANK, DIAGONAL, ONES, ZERO, GRADED, EXCHANGE, KINDS };

/* Eigenvectors of a random matrix. */
static void random_rotation(int n, uint64_t *seed, double *q)
{
    double w[MOST];
    for (int i = 0; i < n * n; i++)
        q[i] = uniform(seed, -1, 1);
    assert_int_equal(LAPACKE_dsyev(LAPACK_ROW_MAJOR, 'V', 'U', n, q, n, w), 0);
}

static void fill(enum kind kind, int n, uint64_t *seed, double *a)
{
    double q[MOST * MOST], w[MOST];
    random_rotation(n, seed, q);
    for (int k = 0; k < n; k++)
        w[k] = kind == EQUAL ? 1 + k % 2 : k % 3 == 0 ? 0 : uniform(seed, -1, 1);
    for (int i = 0; i < n; i++) {
        for (int j = 0; j <= i; j++) {
            double x = 0;
            for (int k = 0; k < n && (kind == EQUAL || kind == RANK); k++)
                x += q[k * n + i] * w[k] * q[k * n + j];
            x = kind == RANDOM     ? uniform(seed, -1, 1)
                : kind == DIAGONAL ? (i == j ? w[i] : 0)
                : kind == ONES     ? 1
                : kind == GRADED   ? pow(10, -(i + j) / 4.0) * (i == j ? 1 : 0.1)
                : kind == EXCHANGE ? i + j == n - 1
                                   : x;
            a[i * n + j] = a[j * n + i] = x;
        }
    }
}

TEST(eigenvalues)
{
    uint64_t seed = 9;
    static double a[MOST * MOST];
    for (int n = 1; n <= MOST; n += n < 16 ? 1 : 4) {
        for (enum kind kind = 0; kind < KINDS; kind++) {
            fill(kind, n, &seed, a);
            check_eigen(n, a);
            for (int k = 0; k < n * n; k++)
                a[k] *= kind % 2 ? 1e200 : 1e-200;
            check_eigen(n, a);
        }
    }
}

/* Badly scaled: the small eigenvalue by the determinant, to its own digits. */
TEST(graded_eigenvalues)
{
    for (double d = 1; d > 1e-150; d /= 1000) {
        double a[4] = {1, 0.5 * d, 0.5 * d, d * d}, value[2], vector[4];
        const double root = sqrt(pow(1 - d * d, 2) + d * d);
        const double large = (1 + d * d + root) / 2, small = 0.75 * d * d / large;
        symmetric_eigen(2, a, value, vector);
        assert_true(fabs(value[1] / large - 1) < 1e-15 && fabs(value[0] / small - 1) < 1e-14);
    }
}
