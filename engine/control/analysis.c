/* analysis.c - eigenvalues and controllability of a linear system x' = A x + B u. */
#include "control.h"

#include <lapacke.h>
#include <stdio.h>
#include <string.h>

/* Singular values below this part of the largest do not count towards the Kalman rank: far above
 * what rounding leaves of a zero (1e-15), far below those of robots that can be balanced (1e-4). */
#define KALMAN_TOLERANCE 1e-10
/* The same for the matrix of one mode, relative to its largest singular value. */
#define HAUTUS_TOLERANCE 1e-10
#define RANK_TOLERANCE 1e-12
/* A product A^k B this small, against what its factors could make, is rounding. */
#define BLOCK_ROUNDING 1e-14

const char *stance_complex_text(double _Complex number, char text[64])
{
    const double dust = 1e-12 * cabs(number), re = creal(number), im = cimag(number);
    if (fabs(im) <= dust)
        snprintf(text, 64, "%.6g", re);
    else if (fabs(re) <= dust)
        snprintf(text, 64, "%.6gi", im);
    else
        snprintf(text, 64, "%.6g%+.6gi", re, im);
    return text;
}

typedef struct eigenvalue {
    double re, im;
} eigenvalue;

static int by_real_then_imaginary(const void *left, const void *right)
{
    const eigenvalue *a = left, *b = right;
    if (a->re != b->re)
        return a->re < b->re ? -1 : 1;
    return (a->im > b->im) - (a->im < b->im);
}

stance_error stance_eigenvalues(int n, const double *A, double *re, double *im)
{
    const size_t entries = (size_t)n * (size_t)n;
    if (n < 1 || !matrix_finite(entries, A))
        return STANCE_BAD_ARGUMENT;
    double *copy = matrix_room(entries);
    eigenvalue *sorted = calloc((size_t)n, sizeof *sorted);
    stance_error error = STANCE_NO_MEMORY;
    if (copy && sorted) {
        memcpy(copy, A, entries * sizeof *A);
        const int info =
            LAPACKE_dgeev(LAPACK_COL_MAJOR, 'N', 'N', n, copy, n, re, im, NULL, 1, NULL, 1);
        error = info == 0 ? STANCE_OK : STANCE_NUMERICAL;
    }
    for (int i = 0; i < n && error == STANCE_OK; i++)
        sorted[i] = (eigenvalue){re[i], im[i]};
    if (error == STANCE_OK)
        qsort(sorted, (size_t)n, sizeof *sorted, by_real_then_imaginary);
    for (int i = 0; i < n && error == STANCE_OK; i++)
        re[i] = sorted[i].re, im[i] = sorted[i].im;
    free(sorted);
    free(copy);
    return error;
}

/* Column block k of the Kalman matrix [n][n m], scaled to unit Frobenius norm. A change of the
 * unit of time multiplies each block, or its position and rate halves, by a power of the ratio:
 * scaled blocks, and so the rank, do not notice. */
static void store_block(int n, int m, int k, const double *block, double *kalman)
{
    const double norm = matrix_norm(n * m, block);
    for (int i = 0; i < n; i++)
        for (int j = 0; j < m; j++)
            kalman[(i * n + k) * m + j] = norm > 0 ? block[i * m + j] / norm : 0;
}

/* next = A block; exactly zero where it is nothing but the rounding of a product that vanishes,
 * which scaling would blow up to directions of its own. */
static void next_block(int n, int m, const double *A, const double *block, double *next)
{
    matrix_multiply(n, n, m, A, block, next);
    const double size = matrix_norm(n * n, A) * matrix_norm(n * m, block);
    if (matrix_norm(n * m, next) <= BLOCK_ROUNDING * size)
        memset(next, 0, (size_t)(n * m) * sizeof *next);
}

stance_error stance_kalman(int n, int m, const double *A, const double *B, double *sv, int *rank)
{
    if (n < 1 || m < 1)
        return STANCE_BAD_ARGUMENT;
    const size_t size = (size_t)n * (size_t)m;
    if (!matrix_finite((size_t)n * (size_t)n, A) || !matrix_finite(size, B))
        return STANCE_BAD_ARGUMENT;
    double *kalman = matrix_room(size * (size_t)n), *block = matrix_room(size),
           *next = matrix_room(size), *unused = matrix_room((size_t)n);
    stance_error error = STANCE_NO_MEMORY;
    if (kalman && block && next && unused) {
        memcpy(block, B, size * sizeof *B);
        for (int k = 0; k < n; k++) {
            store_block(n, m, k, block, kalman);
            next_block(n, m, A, block, next);
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
        while (*rank < n && sv[*rank] > KALMAN_TOLERANCE * sv[0])
            ++*rank;
    }
    free(unused);
    free(next);
    free(block);
    free(kalman);
    return error;
}

/* ---- modes that the inputs do not reach ------------------------------------------------------ */

/* What rounding makes of a mode on the border counts as not decaying; `norm` is that of A. */
static bool passes(enum mode_filter filter, double norm, double re, double im)
{
    const double slack = 1e-10;
    return filter == EVERY_MODE ||
           (filter == GROWING_MODES ? re >= -slack * norm : hypot(re, im) >= 1 - slack);
}

stance_error stance_input_range(int n, int m, const double *B, double *U, int *rank)
{
    const int k = n < m ? n : m;
    double *copy = matrix_room((size_t)n * (size_t)m + 2 * (size_t)k);
    if (!copy)
        return STANCE_NO_MEMORY;
    double *sv = copy + n * m;
    matrix_transpose(n, m, B, copy);
    const int info =
        LAPACKE_dgesvd(LAPACK_COL_MAJOR, 'A', 'N', n, m, copy, n, sv, U, n, NULL, 1, sv + k);
    for (*rank = 0; info == 0 && *rank < k && sv[*rank] > RANK_TOLERANCE * sv[0];)
        ++*rank;
    free(copy);
    return info == 0 ? STANCE_OK : STANCE_NUMERICAL;
}

/* Whether (A - s I, U) has full rank. matrix [n][n + r] and sv [2 n] are scratch. The range of B
 * stands in for B, at the size of A: the unit of the inputs does not matter. */
static stance_error mode_reached(int n, int r, const double *A, const double *U, double norm,
                                 double _Complex mode, double _Complex *matrix, double *sv,
                                 bool *reached)
{
    for (int i = 0; i < n; i++) {
        for (int j = 0; j < n; j++)
            matrix[j * n + i] = A[i * n + j] - (i == j ? mode : 0);
        for (int j = 0; j < r; j++)
            matrix[(n + j) * n + i] = norm * U[j * n + i];
    }
    const int info = LAPACKE_zgesvd(LAPACK_COL_MAJOR, 'N', 'N', n, n + r, matrix, n, sv, NULL, 1,
                                    NULL, 1, sv + n);
    *reached = sv[n - 1] > HAUTUS_TOLERANCE * sv[0];
    return info == 0 ? STANCE_OK : STANCE_NUMERICAL;
}

stance_error stance_hautus(int n, int m, const double *A, const double *B, enum mode_filter filter,
                           double _Complex *mode, bool *reached)
{
    const size_t side = (size_t)n, nn = side * side;
    double *re = matrix_room(4 * side + nn);
    /* A column to spare: OpenBLAS 0.3.21 (zgemv for Haswell) reads a stride beyond the last one,
     * now and then in a page that is not there. */
    double _Complex *matrix = calloc(side * (side + (size_t)m + 1), sizeof *matrix);
    const double norm = matrix_norm(n * n, A);
    int rank = 0;

    *reached = true;
    if (!re || !matrix) {
        free(matrix);
        free(re);
        return STANCE_NO_MEMORY;
    }
    double *im = re + n, *sv = im + n, *U = sv + 2 * n;
    stance_error error = stance_eigenvalues(n, A, re, im);
    if (error == STANCE_OK)
        error = stance_input_range(n, m, B, U, &rank);
    for (int i = 0; error == STANCE_OK && *reached && i < n; i++) {
        if (passes(filter, norm, re[i], im[i])) {
            *mode = CMPLX(re[i], im[i]);
            error = mode_reached(n, rank, A, U, norm, *mode, matrix, sv, reached);
        }
    }
    free(matrix);
    free(re);
    return error;
}
