/* analysis.c - eigenvalues and controllability of a linear system x' = A x + B u. */
#include "control.h"

#include <lapacke.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

/* Singular values below this part of the largest do not count towards the Kalman rank: far above
 * what rounding leaves of a zero (1e-15), far below those of robots that can be balanced (1e-4). */
#define KALMAN_TOLERANCE 1e-10

stance_error stance_refuse(stance_message *message, stance_error error, const char *format, ...)
{
    if (message) {
        va_list arguments;
        va_start(arguments, format);
        vsnprintf(message->text, sizeof message->text, format, arguments);
        va_end(arguments);
    }
    return error;
}

typedef struct eigenvalue {
    double re, im;
} eigenvalue;

static int by_real_then_imaginary(const void *left, const void *right)
{
    const eigenvalue *a = left, *b = right;
    if (a->re != b->re) {
        return a->re < b->re ? -1 : 1;
    }
    return (a->im > b->im) - (a->im < b->im);
}

static void sort_eigenvalues(int n, double *re, double *im, eigenvalue *sorted)
{
    for (int i = 0; i < n; i++) {
        sorted[i] = (eigenvalue){re[i], im[i]};
    }
    qsort(sorted, (size_t)n, sizeof *sorted, by_real_then_imaginary);
    for (int i = 0; i < n; i++) {
        re[i] = sorted[i].re;
        im[i] = sorted[i].im;
    }
}

stance_error stance_eigenvalues(int n, const double *A, double *re, double *im)
{
    const size_t entries = (size_t)n * (size_t)n;
    if (n < 1 || !matrix_finite(entries, A)) {
        return STANCE_BAD_ARGUMENT;
    }
    double *copy = matrix_room(entries);
    eigenvalue *sorted = calloc((size_t)n, sizeof *sorted);
    stance_error error = STANCE_NO_MEMORY;
    if (copy && sorted) {
        memcpy(copy, A, entries * sizeof *A);
        const int info =
            LAPACKE_dgeev(LAPACK_COL_MAJOR, 'N', 'N', n, copy, n, re, im, NULL, 1, NULL, 1);
        error = info == 0 ? STANCE_OK : STANCE_NUMERICAL;
    }
    if (error == STANCE_OK) {
        sort_eigenvalues(n, re, im, sorted);
    }
    free(sorted);
    free(copy);
    return error;
}

/* Column block k of the Kalman matrix [n][n m], scaled to unit Frobenius norm. A change of the
 * unit of time multiplies each block, or its position and rate halves, by a power of the ratio:
 * scaled blocks, and so the rank, do not notice. */
static void store_block(int n, int m, int k, const double *block, double *kalman)
{
    double norm = 0;
    for (int i = 0; i < n * m; i++) {
        norm = hypot(norm, block[i]);
    }
    for (int i = 0; i < n; i++) {
        for (int j = 0; j < m; j++) {
            kalman[(i * n + k) * m + j] = norm > 0 ? block[i * m + j] / norm : 0;
        }
    }
}

stance_error stance_kalman(int n, int m, const double *A, const double *B, double *sv, int *rank)
{
    if (n < 1 || m < 1) {
        return STANCE_BAD_ARGUMENT;
    }
    const size_t size = (size_t)n * (size_t)m;
    if (!matrix_finite((size_t)n * (size_t)n, A) || !matrix_finite(size, B)) {
        return STANCE_BAD_ARGUMENT;
    }
    double *kalman = matrix_room(size * (size_t)n), *block = matrix_room(size),
           *next = matrix_room(size), *unused = matrix_room((size_t)n);
    stance_error error = STANCE_NO_MEMORY;
    if (kalman && block && next && unused) {
        memcpy(block, B, size * sizeof *B);
        for (int k = 0; k < n; k++) {
            store_block(n, m, k, block, kalman);
            matrix_multiply(n, n, m, A, block, next);
            double *swap = block;
            block = next;
            next = swap;
        }
        /* Row-major [n][n m] is column-major [n m][n]: the same singular values. */
        const int info = LAPACKE_dgesvd(LAPACK_COL_MAJOR, 'N', 'N', n * m, n, kalman, n * m, sv,
                                        NULL, 1, NULL, 1, unused);
        error = info == 0 ? STANCE_OK : STANCE_NUMERICAL;
    }
    if (error == STANCE_OK) {
        *rank = 0;
        while (*rank < n && sv[*rank] > KALMAN_TOLERANCE * sv[0]) {
            ++*rank;
        }
    }
    free(unused);
    free(next);
    free(block);
    free(kalman);
    return error;
}
