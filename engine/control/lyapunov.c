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

/* Eigenvalues into scratch[2 n]. */
static stance_error check_stable(int n, const double *loop, bool sampled, double *scratch,
                                 stance_message *message)
{
    double *re = scratch, *im = scratch + n;
    const stance_error error = stance_eigenvalues(n, loop, re, im);
    for (int i = 0; error == STANCE_OK && i < n; i++) {
        if (sampled ? hypot(re[i], im[i]) >= 1 : re[i] >= 0) {
            char text[64];
            return stance_refuse(message, STANCE_BAD_ARGUMENT,
                                 "there is no Lyapunov function: the loop has the eigenvalue %s "
                                 "and is not stable",
                                 stance_complex_text(CMPLX(re[i], im[i]), text));
        }
    }
    return error;
}

stance_error stance_solve_lyapunov(int n, const double *F, bool discrete, const double *C,
                                   double *X)
{
    const size_t nn = (size_t)n * (size_t)n;
    const int work = n * n + 4 * n;
    double *a = matrix_room(3 * nn + 6 * (size_t)n);
    double scale = 1, separation = 0, bound = 0;
    int integers = 0, info = 0;

    if (!a)
        return STANCE_NO_MEMORY;
    double *u = a + nn, *re = u + nn, *dwork = re + 2 * n;
    memcpy(a, F, nn * sizeof *a); /* Fortran sees the transpose, hence "T" */
    memmove(X, C, nn * sizeof *X);
    sb03md_(discrete ? "D" : "C", "X", "N", "T", &n, a, &n, u, &n, X, &n, &scale, &separation,
            &bound, re, re + n, &integers, dwork, &work, &info, 1, 1, 1, 1);
    for (size_t i = 0; i < nn; i++)
        X[i] /= scale;
    free(a);
    return info == 0 && matrix_finite(nn, X) ? STANCE_OK : STANCE_NUMERICAL;
}

stance_error stance_lyapunov(int n, const double *loop, bool sampled, const double *weight,
                             double *P, stance_message *message)
{
    if (n < 1 || !matrix_finite((size_t)n * (size_t)n, loop)) {
        return stance_refuse(message, STANCE_BAD_ARGUMENT,
                             "a Lyapunov function needs a finite loop");
    }
    for (int i = 0; i < n; i++) {
        if (!isfinite(weight[i]) || weight[i] <= 0) {
            return stance_refuse(message, STANCE_BAD_ARGUMENT,
                                 "weight %d of a Lyapunov function must be finite and positive", i);
        }
    }
    const size_t nn = (size_t)n * (size_t)n;
    double *scratch = matrix_room(nn + 2 * (size_t)n);
    stance_error error =
        scratch ? check_stable(n, loop, sampled, scratch, message) : STANCE_NO_MEMORY;
    if (error == STANCE_OK) {
        memset(P, 0, nn * sizeof *P);
        for (int i = 0; i < n; i++)
            P[i * n + i] = -weight[i];
        error = stance_solve_lyapunov(n, loop, sampled, P, P);
        memcpy(scratch, P, nn * sizeof *P);
        if (error == STANCE_OK && LAPACKE_dpotrf(LAPACK_COL_MAJOR, 'U', n, scratch, n) != 0)
            error = STANCE_NUMERICAL;
        if (error == STANCE_NUMERICAL) {
            stance_refuse(message, error,
                          "there is no Lyapunov function to working accuracy: the loop is on the "
                          "border of stability");
        }
    }
    free(scratch);
    return error;
}

stance_error stance_sublevel(int n, const double *P, int count, const double *a, const double *d,
                             double *level, int *binding, double *alone, double *extent)
{
    if (n < 1 || count < 0 || !matrix_finite((size_t)n * (size_t)n, P))
        return STANCE_BAD_ARGUMENT;
    const int columns = count + n;
    double *factor = matrix_room((size_t)n * (size_t)(n + columns));
    if (!factor)
        return STANCE_NO_MEMORY;
    double *solved = factor + n * n;
    /* Columns P^-1 a_k, then P^-1 e_i; row-major [count][n] is column-major [n][count]. */
    memcpy(factor, P, (size_t)(n * n) * sizeof *P);
    memcpy(solved, a, (size_t)(n * count) * sizeof *a);
    for (int i = 0; i < n; i++)
        solved[(count + i) * n + i] = 1;
    const int info = LAPACKE_dposv(LAPACK_COL_MAJOR, 'U', n, columns, factor, n, solved, n);
    if (info != 0) {
        free(factor);
        return info > 0 ? STANCE_BAD_ARGUMENT : STANCE_NUMERICAL;
    }
    *level = INFINITY;
    *binding = -1;
    for (int k = 0; k < count; k++) {
        double reach = 0;
        for (int i = 0; i < n; i++)
            reach += a[k * n + i] * solved[k * n + i];
        const double c = d[k] <= 0 ? 0 : reach > 0 ? d[k] * d[k] / reach : INFINITY;
        if (c < *level) {
            *level = c;
            *binding = k;
        }
    }
    for (int i = 0; i < n; i++) {
        alone[i] = sqrt(*level / P[i * n + i]);
        extent[i] = sqrt(*level * solved[(count + i) * n + i]);
    }
    free(factor);
    return STANCE_OK;
}
