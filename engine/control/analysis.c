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

static int by_real_then_imaginary(const void *left, const void *right)
{
    const double *a = left, *b = right;
    if (a[0] != b[0])
        return a[0] < b[0] ? -1 : 1;
    return (a[1] > b[1]) - (a[1] < b[1]);
}

stance_error stance_eigenvalues(int n, const double *A, double *re, double *im)
{
    double copy[STANCE_LOOP_MOST * STANCE_LOOP_MOST], sorted[STANCE_LOOP_MOST][2];
    if (n < 1 || n > STANCE_LOOP_MOST || !matrix_finite((size_t)n * (size_t)n, A))
        return STANCE_BAD_ARGUMENT;
    memcpy(copy, A, (size_t)(n * n) * sizeof *A);
    if (LAPACKE_dgeev(LAPACK_COL_MAJOR, 'N', 'N', n, copy, n, re, im, NULL, 1, NULL, 1) != 0)
        return STANCE_NUMERICAL;
    for (int i = 0; i < n; i++)
        sorted[i][0] = re[i], sorted[i][1] = im[i];
    qsort(sorted, (size_t)n, sizeof *sorted, by_real_then_imaginary);
    for (int i = 0; i < n; i++)
        re[i] = sorted[i][0], im[i] = sorted[i][1];
    return STANCE_OK;
}

stance_error stance_is_stable(int n, const double *A, bool sampled, bool *stable,
                              double complex *lasts)
{
    double re[STANCE_LOOP_MOST], im[STANCE_LOOP_MOST];
    const stance_error error = stance_eigenvalues(n, A, re, im);
    *stable = true;
    for (int i = 0; error == STANCE_OK && *stable && i < n; i++) {
        *stable = sampled ? hypot(re[i], im[i]) < 1 : re[i] < 0;
        *lasts = CMPLX(re[i], im[i]);
    }
    return error;
}

stance_error stance_check_plant(const stance_plant *plant, stance_message *message)
{
    const int n = plant->states, m = plant->inputs;
    if (n < 1 || m < 1 || n > STANCE_PLANT_MOST || m > STANCE_PLANT_MOST)
        return stance_refuse(message, STANCE_BAD_ARGUMENT,
                             "a design needs 1 to %d states and inputs", STANCE_PLANT_MOST);
    if (!matrix_finite((size_t)n * (size_t)n, plant->A) ||
        !matrix_finite((size_t)n * (size_t)m, plant->B))
        return stance_refuse(message, STANCE_BAD_ARGUMENT, "A and B must be finite");
    return STANCE_OK;
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

stance_error stance_kalman(const stance_plant *plant, double *sv, int *rank)
{
    enum { N = STANCE_PLANT_MOST };
    const int n = plant->states, m = plant->inputs;
    double kalman[N * N * N], block[2][N * N], unused[N];
    const stance_error error = stance_check_plant(plant, NULL);
    if (error != STANCE_OK)
        return error;
    memcpy(block[0], plant->B, (size_t)(n * m) * sizeof **block);
    for (int k = 0; k < n; k++) {
        store_block(n, m, k, block[k % 2], kalman);
        next_block(n, m, plant->A, block[k % 2], block[(k + 1) % 2]);
    }
    /* Row-major [n][n m] is column-major [n m][n]: the same singular values. */
    if (LAPACKE_dgesvd(LAPACK_COL_MAJOR, 'N', 'N', n * m, n, kalman, n * m, sv, NULL, 1, NULL, 1,
                       unused) != 0)
        return STANCE_NUMERICAL;
    for (*rank = 0; *rank < n && sv[*rank] > KALMAN_TOLERANCE * sv[0];)
        ++*rank;
    return STANCE_OK;
}

/* ---- modes that the inputs do not reach ------------------------------------------------------ */

/* What rounding makes of a mode on the border counts as not decaying; `norm` is that of A. */
static bool passes(enum mode_filter filter, double norm, double re, double im)
{
    const double slack = 1e-10;
    return filter == EVERY_MODE ||
           (filter == GROWING_MODES ? re >= -slack * norm : hypot(re, im) >= 1 - slack);
}

stance_error stance_input_range(int n, int m, const double *B, double *U, double *pseudo, int *rank)
{
    enum { N = STANCE_PLANT_MOST };
    const int k = n < m ? n : m;
    double copy[N * N], vt[N * N], sv[N], unused[N];
    matrix_transpose(n, m, B, copy);
    if (LAPACKE_dgesvd(LAPACK_COL_MAJOR, 'A', pseudo ? 'S' : 'N', n, m, copy, n, sv, U, n, vt, k,
                       unused) != 0)
        return STANCE_NUMERICAL;
    for (*rank = 0; *rank < k && sv[*rank] > RANK_TOLERANCE * sv[0];)
        ++*rank;
    for (int i = 0; i < m && pseudo; i++)
        for (int j = 0; j < *rank; j++)
            pseudo[i * *rank + j] = vt[i * k + j] / sv[j];
    return STANCE_OK;
}

stance_error stance_check_modes(const stance_plant *plant, enum mode_filter filter,
                                stance_error code, const char *before, const char *after,
                                stance_message *message)
{
    enum { N = STANCE_PLANT_MOST };
    const int n = plant->states;
    double re[N], im[N], sv[N], unused[N], U[N * N];
    /* A column to spare: OpenBLAS 0.3.21 (zgemv for Haswell) reads a stride beyond the last one,
     * now and then in a page that is not there. */
    double complex matrix[N * (2 * N + 1)];
    const double norm = matrix_norm(n * n, plant->A);
    int rank = 0;
    char text[64];
    stance_error error = stance_eigenvalues(n, plant->A, re, im);
    if (error == STANCE_OK)
        error = stance_input_range(n, plant->inputs, plant->B, U, NULL, &rank);
    for (int k = 0; error == STANCE_OK && k < n; k++) {
        if (!passes(filter, norm, re[k], im[k]))
            continue;
        /* Has (A - s I, U) full rank? The range of B stands in for B, at the size of A: the unit of
         * the inputs does not matter. */
        const double complex mode = CMPLX(re[k], im[k]);
        for (int i = 0; i < n; i++) {
            for (int j = 0; j < n; j++)
                matrix[j * n + i] = plant->A[i * n + j] - (i == j ? mode : 0);
            for (int j = 0; j < rank; j++)
                matrix[(n + j) * n + i] = norm * U[j * n + i];
        }
        if (LAPACKE_zgesvd(LAPACK_COL_MAJOR, 'N', 'N', n, n + rank, matrix, n, sv, NULL, 1, NULL, 1,
                           unused) != 0)
            error = STANCE_NUMERICAL;
        else if (!(sv[n - 1] > HAUTUS_TOLERANCE * sv[0]))
            error = stance_refuse(message, code, "%s the mode with eigenvalue %s%s", before,
                                  stance_complex_text(mode, text), after);
    }
    return error;
}
