/* dense.h - a small dense system by the book, for tests; DENSE_ROWS: the most rows it has. */
#ifndef STANCE_TESTS_DENSE_H
#define STANCE_TESTS_DENSE_H

#include <math.h>
#include <stdbool.h>

/* Solves a[n][n] x = b, full pivoting; false: singular to 1e-11 of the first pivot. */
static inline bool dense_solve(int n, double a[DENSE_ROWS][DENSE_ROWS + 1], double *x)
{
    int column[DENSE_ROWS];
    double first = 0;
    for (int k = 0; k < n; k++)
        column[k] = k;
    for (int k = 0; k < n; k++) {
        int p = k, q = k;
        for (int i = k; i < n; i++)
            for (int j = k; j < n; j++)
                if (fabs(a[i][j]) > fabs(a[p][q]))
                    p = i, q = j;
        first = fmax(first, fabs(a[p][q]));
        if (!(fabs(a[p][q]) > 1e-11 * first))
            return false;
        for (int j = 0; j <= n; j++) {
            const double t = a[k][j];
            a[k][j] = a[p][j], a[p][j] = t;
        }
        for (int i = 0; i < n; i++) {
            const double t = a[i][k];
            a[i][k] = a[i][q], a[i][q] = t;
        }
        const int t = column[k];
        column[k] = column[q], column[q] = t;
        for (int i = k + 1; i < n; i++) {
            const double f = a[i][k] / a[k][k];
            for (int j = k; j <= n; j++)
                a[i][j] -= f * a[k][j];
        }
    }
    for (int k = n - 1; k >= 0; k--) {
        double sum = a[k][n];
        for (int j = k + 1; j < n; j++)
            sum -= a[k][j] * x[column[j]];
        x[column[k]] = sum / a[k][k];
    }
    return true;
}

/* Of a[n][n], whose rows are `stride` apart; so are those of the inverse. */
static inline bool dense_inverse(int n, int stride, const double *a, double *inverse)
{
    for (int column = 0; column < n; column++) {
        double system[DENSE_ROWS][DENSE_ROWS + 1], x[DENSE_ROWS];
        for (int i = 0; i < n; i++) {
            for (int j = 0; j < n; j++)
                system[i][j] = a[i * stride + j];
            system[i][n] = i == column;
        }
        if (!dense_solve(n, system, x))
            return false;
        for (int i = 0; i < n; i++)
            inverse[i * stride + column] = x[i];
    }
    return true;
}

#endif
