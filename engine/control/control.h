/* control.h - what the files of the control design share: messages and small matrices.
 *
 * Matrices are row-major here as everywhere. LAPACK and SLICOT read the same memory as the
 * transpose, which costs nothing where a function commutes with transposition (eigenvalues,
 * singular values, the exponential).
 */
#ifndef STANCE_CONTROL_CONTROL_H
#define STANCE_CONTROL_CONTROL_H

#include "design.h"

#include "engine/refuse.h"

#include <complex.h>
#include <math.h>
#include <stdlib.h>

/* A complex number as people write it: no part that is nothing but rounding. */
const char *stance_complex_text(double _Complex number, char text[64]);

/* Equal but for rounding. */
bool stance_same_pole(double _Complex a, double _Complex b);

/* What every pole assignment asks of A[n][n] and B[n][m]: that they are and are finite; and that
 * inputs reach every mode, UNCONTROLLABLE where one has none. */
stance_error stance_check_plant(int n, int m, const double *A, const double *B,
                                stance_message *message);
stance_error stance_check_controllable(int n, int m, const double *A, const double *B,
                                       stance_message *message);

/* Puts the poles re + i im in an order in which a pair stands in two places in a row, the one with
 * im > 0 first. BAD_POLES when one is not finite or lacks its conjugate. */
stance_error stance_pair_poles(int n, const double *re, const double *im, double _Complex *pole,
                               stance_message *message);

/* A[n][n], B[n][m] and the n poles wanted of it. */
typedef struct linear_model {
    const double *A, *B, *re, *im;
} linear_model;

/* stance_place for `wanted`, a neighbour of `near` with its poles in the same order: of the maxima
 * of the conditioning the one that continues the solution of `near`; where that leads nowhere, as
 * stance_place. Arguments already checked. */
stance_error stance_place_following(int n, int m, const linear_model *near,
                                    const linear_model *wanted, double *K, int *sweeps,
                                    double *condition, stance_message *message);

/* The eigenvalues of A that a Hautus test looks at: all, those with real part >= 0, those of
 * modulus
 * >= 1. */
enum mode_filter { EVERY_MODE, GROWING_MODES, EXPANDING_MODES };

/* Hautus: (A - s I, B) has full rank for every eigenvalue s of A that passes the filter. *reached
 * is false where one has not, and *mode that eigenvalue. */
stance_error stance_hautus(int n, int m, const double *A, const double *B, enum mode_filter filter,
                           double _Complex *mode, bool *reached);

/* Orthonormal basis of the range of B[n][m] in the first *rank columns of U[n][n], by columns. */
stance_error stance_input_range(int n, int m, const double *B, double *U, int *rank);

/* X of F' X + X F = C, or (discrete) F' X F - X = C; C symmetric, X may be C. */
stance_error stance_solve_lyapunov(int n, const double *F, bool discrete, const double *C,
                                   double *X);

/* E = exp(A T) and, unless NULL, integral = that of exp(A t) over 0 ... T; all [n][n]. */
stance_error stance_exponential(int n, const double *A, double T, double *E, double *integral);

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

/* Room for `count` numbers, zero; count may be 0. */
static inline double *matrix_room(size_t count)
{
    return calloc(count ? count : 1, sizeof(double));
}

/* Its Frobenius norm. */
static inline double matrix_norm(int count, const double *x)
{
    double norm = 0;
    for (int i = 0; i < count; i++)
        norm = hypot(norm, x[i]);
    return norm;
}

static inline bool matrix_finite(size_t count, const double *x)
{
    for (size_t i = 0; i < count; i++)
        if (!isfinite(x[i]))
            return false;
    return true;
}

#endif
