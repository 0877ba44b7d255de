/* matrix.h - small dense matrices in plain arithmetic, row-major: the same bits everywhere. */
#ifndef STANCE_MATRIX_H
#define STANCE_MATRIX_H

#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

/* C[n][p] = A[n][m] B[m][p]; C is neither of the others. */
static inline void matrix_multiply(int n, int m, int p, const double *A, const double *B, double *C)
{
    for (int i = 0; i < n; i++) {
        for (int j = 0; j < p; j++) {
            double sum = 0;
            for (int k = 0; k < m; k++)
                sum += A[i * m + k] * B[k * p + j];
            C[i * p + j] = sum;
        }
    }
}

/* B[m][n] = A[n][m] transposed: what Fortran reads as A. */
static inline void matrix_transpose(int n, int m, const double *A, double *B)
{
    for (int i = 0; i < n; i++)
        for (int j = 0; j < m; j++)
            B[j * n + i] = A[i * m + j];
}

/* loop[n][n] = A - B K. */
static inline void matrix_close(int n, int m, const double *A, const double *B, const double *K,
                                double *loop)
{
    matrix_multiply(n, m, n, B, K, loop);
    for (int i = 0; i < n * n; i++)
        loop[i] = A[i] - loop[i];
}

static inline double matrix_dot(int n, const double *a, const double *b)
{
    double sum = 0;
    for (int i = 0; i < n; i++)
        sum += a[i] * b[i];
    return sum;
}

/* Its Frobenius norm. */
static inline double matrix_norm(int count, const double *x)
{
    double norm = 0;
    for (int i = 0; i < count; i++)
        norm = hypot(norm, x[i]);
    return norm;
}

/* The largest of the sizes of its numbers, INFINITY where one is none. */
static inline double matrix_largest(int count, const double *x)
{
    double largest = 0;
    for (int i = 0; i < count; i++)
        largest = fmax(largest, x[i] == x[i] ? fabs(x[i]) : INFINITY);
    return largest;
}

static inline bool matrix_finite(size_t count, const double *x)
{
    for (size_t i = 0; i < count; i++)
        if (!isfinite(x[i]))
            return false;
    return true;
}

#endif
