/* matrix.h - small matrices in plain arithmetic: one lane's neighbourhood of a state of rest.
 *
 * Rare, and the same bits everywhere. All are n by n, n <= GAUSS_STATES, in the corner of their
 * room.
 */
#ifndef STANCE_CORE_LOOP_MATRIX_H
#define STANCE_CORE_LOOP_MATRIX_H

#include "bundle.h"

typedef double small_matrix[GAUSS_STATES][GAUSS_STATES];

static void matrix_clear(int n, small_matrix A)
{
    for (int i = 0; i < n; i++)
        memset(A[i], 0, sizeof(double) * (size_t)n);
}
static void matrix_copy(int n, small_matrix from, small_matrix to)
{
    for (int i = 0; i < n; i++)
        memcpy(to[i], from[i], sizeof(double) * (size_t)n);
}

COLD void matrix_times(int n, small_matrix A, small_matrix B, small_matrix out)
{
    small_matrix product;
    matrix_clear(n, product);
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++)
            for (int k = 0; k < n; k++)
                product[i][j] += A[i][k] * B[k][j];
    matrix_copy(n, product, out);
}

static double matrix_largest(int n, small_matrix A)
{
    double largest = 0;
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++)
            largest = fmax(largest, A[i][j] == A[i][j] ? fabs(A[i][j]) : INFINITY);
    return largest;
}

/* A becomes exp(A T): Taylor's series of a part of it, squared. */
COLD void matrix_exponential(int n, small_matrix A, double T)
{
    small_matrix term, sum;
    int squarings = 0;
    double size = n * matrix_largest(n, A) * T;
    for (; size > 0.5 && squarings < 60; squarings++)
        size *= 0.5, T *= 0.5;
    matrix_clear(n, sum);
    matrix_clear(n, term);
    for (int i = 0; i < n; i++)
        sum[i][i] = term[i][i] = 1;
    for (int order = 1; order <= 14; order++) { /* 0.5^15 / 15! = 2e-17 */
        matrix_times(n, term, A, term);
        for (int i = 0; i < n; i++)
            for (int j = 0; j < n; j++) {
                term[i][j] *= T / order;
                sum[i][j] += term[i][j];
            }
    }
    for (int k = 0; k < squarings; k++)
        matrix_times(n, sum, sum, sum);
    matrix_copy(n, sum, A);
}

#endif
