/* lyapunov.c - Lyapunov functions of linear loops and the largest ellipsoid inside linear bounds.
 *
 * Continuous: F' P + P F = -Q; sampled: F' P F - P = -Q; Q diagonal and positive. P is positive
 * definite exactly when the loop is stable (SLICOT's SB03MD, after Bartels and Stewart).
 *
 * On x' P x <= c the linear form a' x reaches sqrt(c a' P^-1 a). So a' x <= d holds on all of the
 * set exactly when c <= d^2 / (a' P^-1 a), and the largest c is the least of these.
 */
#include "control.h"

#include <lapacke.h>
#include <string.h>

/* SLICOT, Fortran: op(A)' X + X op(A) = scale C, or op(A)' X op(A) - X = scale C; X replaces C. */
void sb03md_(const char *dico, const char *job, const char *fact, const char *trana, const int *n,
             double *a, const int *lda, double *u, const int *ldu, double *c, const int *ldc,
             double *scale, double *sep, double *ferr, double *wr, double *wi, int *iwork,
             double *dwork, const int *ldwork, int *info, size_t dico_length, size_t job_length,
             size_t fact_length, size_t trana_length);

stance_error stance_solve_lyapunov(int n, const double *F, bool discrete, const double *C,
                                   double *X)
{
    enum { N = STANCE_PLANT_MOST };
    const int work = n * n + 4 * n;
    const size_t nn = (size_t)n * (size_t)n;
    double a[N * N], u[N * N], re[N], im[N], dwork[N * N + 4 * N];
    double scale = 1, separation = 0, bound = 0;
    int integers = 0, info = 0;
    memcpy(a, F, nn * sizeof *a); /* Fortran sees the transpose, hence "T" */
    memmove(X, C, nn * sizeof *X);
    sb03md_(discrete ? "D" : "C", "X", "N", "T", &n, a, &n, u, &n, X, &n, &scale, &separation,
            &bound, re, im, &integers, dwork, &work, &info, 1, 1, 1, 1);
    for (size_t i = 0; i < nn; i++)
        X[i] /= scale;
    return info == 0 && matrix_finite(nn, X) ? STANCE_OK : STANCE_NUMERICAL;
}

stance_error stance_lyapunov(int n, const double *loop, bool sampled, const double *weight,
                             double *P, stance_message *message)
{
    const size_t nn = (size_t)n * (size_t)n;
    double factor[STANCE_PLANT_MOST * STANCE_PLANT_MOST];
    if (n < 1 || n > STANCE_PLANT_MOST || !matrix_finite(nn, loop))
        return stance_refuse(message, STANCE_BAD_ARGUMENT,
                             "a Lyapunov function needs a finite loop");
    for (int i = 0; i < n; i++)
        if (!isfinite(weight[i]) || weight[i] <= 0)
            return stance_refuse(message, STANCE_BAD_ARGUMENT,
                                 "weight %d of a Lyapunov function must be finite and positive", i);
    bool stable;
    double complex lasts;
    char text[64];
    stance_error error = stance_is_stable(n, loop, sampled, &stable, &lasts);
    if (error != STANCE_OK)
        return error;
    if (!stable)
        return stance_refuse(message, STANCE_BAD_ARGUMENT,
                             "there is no Lyapunov function: the loop has the eigenvalue %s and is "
                             "not stable",
                             stance_complex_text(lasts, text));
    memset(P, 0, nn * sizeof *P);
    for (int i = 0; i < n; i++)
        P[i * n + i] = -weight[i];
    error = stance_solve_lyapunov(n, loop, sampled, P, P);
    memcpy(factor, P, nn * sizeof *P);
    if (error == STANCE_OK && LAPACKE_dpotrf(LAPACK_COL_MAJOR, 'U', n, factor, n) == 0)
        return STANCE_OK;
    return stance_refuse(message, STANCE_NUMERICAL,
                         "there is no Lyapunov function to working accuracy: the loop is on the "
                         "border of stability");
}

stance_error stance_sublevel(int n, const double *P, const stance_bounds *bounds,
                             stance_sublevel_set *set)
{
    enum { N = STANCE_PLANT_MOST };
    const int count = bounds->count;
    double factor[N * N];
    if (n < 1 || n > N || count < 0 || !matrix_finite((size_t)n * (size_t)n, P))
        return STANCE_BAD_ARGUMENT;
    double *const solved = calloc((size_t)n * (size_t)(count + n), sizeof *solved);
    if (!solved)
        return STANCE_NO_MEMORY;
    /* Columns P^-1 a_k, then P^-1 e_i; row-major [count][n] is column-major [n][count]. */
    memcpy(factor, P, (size_t)(n * n) * sizeof *P);
    memcpy(solved, bounds->a, (size_t)(n * count) * sizeof *solved);
    for (int i = 0; i < n; i++)
        solved[(count + i) * n + i] = 1;
    const int info = LAPACKE_dposv(LAPACK_COL_MAJOR, 'U', n, count + n, factor, n, solved, n);
    set->level = INFINITY;
    set->binding = -1;
    for (int k = 0; k < count && info == 0; k++) {
        const double reach = matrix_dot(n, bounds->a + k * n, solved + k * n), d = bounds->d[k];
        const double level = d <= 0 ? 0 : reach > 0 ? d * d / reach : INFINITY;
        if (level < set->level)
            set->level = level, set->binding = k;
    }
    for (int i = 0; i < n && info == 0; i++) {
        set->alone[i] = sqrt(set->level / P[i * n + i]);
        set->extent[i] = sqrt(set->level * solved[(count + i) * n + i]);
    }
    free(solved);
    return info > 0 ? STANCE_BAD_ARGUMENT : info < 0 ? STANCE_NUMERICAL : STANCE_OK;
}
