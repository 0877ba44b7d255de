/* place_schur.c - pole assignment by the Schur method.
 *
 * Varga, "A Schur method for pole assignment", IEEE Trans. Automatic Control 26 (1981) 517-519, as
 * SLICOT's SB01BD has it: A is brought to real Schur form, and one real pole or pair after the
 * other is assigned to the last block by the feedback of smallest norm that does so. Stable
 * numerically and quick; but with several inputs the gain is one of many, and which one decides how
 * far the nonlinear robot may be from its equilibrium. It depends on the order in which the form
 * has the eigenvalues of A, which the QR algorithm leaves to rounding where they lie in pairs of
 * opposite signs, as those of what swings and falls do: so they are brought into the order of their
 * real parts first, the fastest that falls in front.
 */
#include "control.h"

#include <lapacke.h>
#include <string.h>

/* SLICOT, Fortran: F with the wanted eigenvalues of A + B F; those of A with a real part below
 * alpha (`dico` C) stay as they are. */
void sb01bd_(const char *dico, const int *n, const int *m, const int *np, const double *alpha,
             double *a, const int *lda, double *b, const int *ldb, double *wr, double *wi, int *nfp,
             int *nap, int *nup, double *f, const int *ldf, double *z, const int *ldz,
             const double *tol, double *dwork, const int *ldwork, int *iwarn, int *info,
             size_t dico_length);

/* A block of a real Schur form: is it of two rows? */
static bool is_pair(int n, const double *T, int i)
{
    return i + 1 < n && T[i * n + i + 1] != 0;
}

/* a, column by column, becomes its real Schur form Z'aZ, eigenvalues by falling real parts. */
static bool sort_schur(int n, double *a, double *Z, double *re, double *im)
{
    int ignored;
    if (LAPACKE_dgees(LAPACK_COL_MAJOR, 'V', 'N', NULL, n, a, n, &ignored, re, im, Z, n) != 0)
        return false;
    for (int at = 0; at < n; at += is_pair(n, a, at) ? 2 : 1) {
        int first = at;
        for (int i = at; i < n; i += is_pair(n, a, i) ? 2 : 1)
            if (a[i * n + i] > a[first * n + first])
                first = i;
        int from = first + 1, to = at + 1;
        if (LAPACKE_dtrexc(LAPACK_COL_MAJOR, 'V', n, a, n, Z, n, &from, &to) != 0)
            return false;
    }
    return true;
}

/* K from paired poles. */
static stance_error assign(const stance_plant *plant, const double complex *pole, double *K,
                           stance_message *message)
{
    enum { N = STANCE_PLANT_MOST };
    const int n = plant->states, m = plant->inputs, work = 10 * (n > m ? n : m) + 16;
    double a[N * N], z[N * N], turn[N * N], b[N * N], f[N * N], re[N], im[N], dwork[10 * N + 16];
    const double none_stays = -1e300, tolerance = 0;
    int stay = 0, assigned = 0, unreached = 0, warnings = 0, info = 0;
    matrix_transpose(n, n, plant->A, a);
    if (!sort_schur(n, a, turn, re, im))
        return STANCE_NUMERICAL;
    matrix_multiply(n, n, m, turn, plant->B, f); /* of `turn` by columns the transpose */
    matrix_transpose(n, m, f, b);
    for (int i = 0; i < n; i++) {
        re[i] = creal(pole[i]);
        im[i] = cimag(pole[i]);
    }
    sb01bd_("C", &n, &m, &n, &none_stays, a, &n, b, &n, re, im, &stay, &assigned, &unreached, f, &m,
            z, &n, &tolerance, dwork, &work, &warnings, &info, 1);
    matrix_transpose(n, m, f, b);
    for (int i = 0; i < n * m; i++)
        b[i] = -b[i];
    matrix_multiply(m, n, n, b, turn, K);
    if (info != 0 || !matrix_finite((size_t)n * (size_t)m, K))
        return STANCE_NUMERICAL;
    return assigned == n
               ? STANCE_OK
               : stance_refuse(message, STANCE_BAD_POLES,
                               "the Schur method placed %d of the %d poles only", assigned, n);
}

stance_error stance_place_schur(const placement *wanted, double *K, stance_message *message)
{
    double complex pole[STANCE_PLANT_MOST];
    stance_error error = stance_check_plant(wanted->plant, message);
    if (error != STANCE_OK)
        return error;
    error = stance_pair_poles(wanted->plant->states, wanted->poles, pole, message);
    if (error == STANCE_OK)
        error = stance_check_controllable(wanted->plant, message);
    if (error == STANCE_OK)
        error = assign(wanted->plant, pole, K, message);
    if (error == STANCE_NUMERICAL)
        stance_refuse(message, error, "pole placement: %s", stance_error_text(error));
    return error;
}
