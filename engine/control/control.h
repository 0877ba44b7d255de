/* control.h - what the files of the control design share: messages and small matrices.
 *
 * Matrices are row-major here as everywhere. LAPACK and SLICOT read the same memory as the
 * transpose, which costs nothing where a function commutes with transposition (eigenvalues,
 * singular values, the exponential).
 */
#ifndef STANCE_CONTROL_H
#define STANCE_CONTROL_H

#include "../stance.h"

#include <math.h>
#include <stdlib.h>

/* Writes a sentence to `message`, which may be NULL, and returns `error`. */
stance_error stance_refuse(stance_message *message, stance_error error, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* C[n][p] = A[n][m] B[m][p]; C is neither of the others. */
static inline void matrix_multiply(int n, int m, int p, const double *A, const double *B, double *C)
{
    for (int i = 0; i < n; i++) {
        for (int j = 0; j < p; j++) {
            double sum = 0;
            for (int k = 0; k < m; k++) {
                sum += A[i * m + k] * B[k * p + j];
            }
            C[i * p + j] = sum;
        }
    }
}

/* Room for `count` numbers, zero; count may be 0. */
static inline double *matrix_room(size_t count)
{
    return calloc(count ? count : 1, sizeof(double));
}

static inline bool matrix_finite(size_t count, const double *x)
{
    for (size_t i = 0; i < count; i++) {
        if (!isfinite(x[i])) {
            return false;
        }
    }
    return true;
}

#endif
