/* matrix.h - small matrices in plain arithmetic: one lane's neighbourhood of a state of rest.
 *
 * Rare, and the same bits everywhere. All are n by n, n <= MATRIX_ROOM, in the corner of their
 * room.
 */
#ifndef STANCE_CORE_LOOP_MATRIX_H
#define STANCE_CORE_LOOP_MATRIX_H

#include "bundle.h"

#define MATRIX_RANK 1e-9 /* of the largest: what is smaller is nothing */

/* Places and rates, integrals, torques, commands under way. */
enum { MATRIX_ROOM = 2 * SCENE_COORDINATES + (2 + STANCE_MAX_DELAY) * SCENE_ACTUATORS };
typedef double small_matrix[MATRIX_ROOM][MATRIX_ROOM];

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

/* Solves M x = b by elimination with complete pivoting; unknowns that nothing determines are zero.
 */
COLD void matrix_solve(int n, small_matrix M, double *b, double *x)
{
    int column[MATRIX_ROOM], rank = 0;
    double largest = 0;
    for (int i = 0; i < n; i++) {
        column[i] = i, x[i] = 0;
        for (int j = 0; j < n; j++)
            largest = fmax(largest, fabs(M[i][j]));
    }
    for (; rank < n; rank++) {
        int row = rank, best = rank;
        for (int i = rank; i < n; i++)
            for (int j = rank; j < n; j++)
                if (fabs(M[i][column[j]]) > fabs(M[row][column[best]]))
                    row = i, best = j;
        if (!(fabs(M[row][column[best]]) > MATRIX_RANK * largest))
            break;
        const int taken = column[best];
        column[best] = column[rank], column[rank] = taken;
        for (int j = 0; j < n; j++) {
            const double swap = M[rank][j];
            M[rank][j] = M[row][j], M[row][j] = swap;
        }
        const double swap = b[rank];
        b[rank] = b[row], b[row] = swap;
        for (int i = rank + 1; i < n; i++) {
            const double factor = M[i][taken] / M[rank][taken];
            for (int j = 0; j < n; j++)
                M[i][j] -= factor * M[rank][j];
            b[i] -= factor * b[rank];
        }
    }
    for (int i = rank - 1; i >= 0; i--) {
        x[column[i]] = b[i];
        for (int j = i + 1; j < rank; j++)
            x[column[i]] -= M[i][column[j]] * x[column[j]];
        x[column[i]] /= M[i][column[i]];
    }
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
