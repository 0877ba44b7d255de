/* riccati.c - linear quadratic regulators, continuous and sampled.
 *
 * Continuous: X of  Q + A' X + X A - X B R^-1 B' X = 0, then K = R^-1 B' X.
 *
 * Sampled: x' = A x + B u with u held over T. With F = [A B; 0 0], (x, u) moves as exp(F t), and
 * the cost of one interval is (x, u)' W (x, u),
 *
 *   W = integral over 0 ... T of exp(F' t) diag(Q, R) exp(F t) dt = [Qd Sd; Sd' Rd],
 *
 * exactly. Van Loan (IEEE Trans. Automatic Control 23 (1978) 395-404) reads it off one exponential:
 *
 *   exp([-F' diag(Q, R); 0 F] T) = [. G; 0 E],   W = E' G,   E = [Ad Bd; 0 I].
 *
 * Then X = Ad' X Ad - (Sd + Ad' X Bd) (Rd + Bd' X Bd)^-1 (Sd + Ad' X Bd)' + Qd and
 * K = (Rd + Bd' X Bd)^-1 (Sd + Ad' X Bd)'. SLICOT's SB02OD solves both equations by deflating
 * subspaces of the extended pencil, which inverts neither R nor Ad. What rounding leaves there (the
 * pencil mixes weights of very different size) Newton's method on X takes away: with F = A - B K, X
 * solves the Lyapunov equation of the loop under that K, F' X + X F + Q + K' R K = 0 or
 * F' X F - X + Qd + K' Rd K - Sd K - K' Sd' = 0, and gives a better K (Kleinman, IEEE Trans.
 * Automatic Control 13 (1968) 114-115).
 */
#include "control.h"

#include <lapacke.h>
#include <string.h>

#define NEWTON_STEPS 2

/* SLICOT, Fortran. */
void sb02od_(const char *dico, const char *jobb, const char *fact, const char *uplo,
             const char *jobl, const char *sort, const int *n, const int *m, const int *p,
             const double *a, const int *lda, const double *b, const int *ldb, double *q,
             const int *ldq, double *r, const int *ldr, double *l, const int *ldl, double *rcond,
             double *x, const int *ldx, double *alfar, double *alfai, double *beta, double *s,
             const int *lds, double *t, const int *ldt, double *u, const int *ldu,
             const double *tol, int *iwork, double *dwork, const int *ldwork, int *bwork, int *info,
             size_t dico_length, size_t jobb_length, size_t fact_length, size_t uplo_length,
             size_t jobl_length, size_t sort_length);

enum { N = STANCE_PLANT_MOST, SIDE = 3 * N };

/* The regulator of one model: continuous (S all zero), or discrete. */
typedef struct regulator {
    int n, m;
    bool discrete;
    double A[N * N], B[N * N];           /* [n][n], [n][m] */
    double Q[N * N], R[N * N], S[N * N]; /* [n][n], [m][m], [n][m] */
    double X[N * N];                     /* [n][n] */
} regulator;

/* X; a failure of the library means that the pencil has eigenvalues on the border of stability, or
 * so near that rounding cannot tell. */
static stance_error solve_riccati(regulator *g)
{
    const int n = g->n, m = g->m, side = 2 * n + m, two = 2 * n, none = 0;
    const int work = 16 * (side + 1) + 32;
    double s[SIDE * SIDE], t[SIDE * SIDE], u[4 * N * N], alpha[3][2 * N],
        dwork[16 * (SIDE + 1) + 32];
    double a[N * N], b[N * N], l[N * N], rcond = 0;
    const double tolerance = 0;
    int integers[SIDE], unused[2 * N], info = 0;

    matrix_transpose(n, n, g->A, a);
    matrix_transpose(n, m, g->B, b);
    matrix_transpose(n, m, g->S, l);
    sb02od_(g->discrete ? "D" : "C", "B", "N", "U", g->discrete ? "N" : "Z", "S", &n, &m, &none, a,
            &n, b, &n, g->Q, &n, g->R, &m, l, &n, &rcond, g->X, &n, alpha[0], alpha[1], alpha[2], s,
            &side, t, &side, u, &two, &tolerance, integers, dwork, &work, unused, &info, 1, 1, 1, 1,
            1, 1);
    const bool good = info == 0 && matrix_finite((size_t)n * (size_t)n, g->X);
    return good ? STANCE_OK : STANCE_NUMERICAL;
}

/* K = (R + B' X B)^-1 (S + A' X B)', or R^-1 (X B)' where time is continuous. */
static stance_error feedback(const regulator *g, double *K)
{
    const int n = g->n, m = g->m;
    double XB[N * N], left[N * N] = {0}, right[N * N] = {0}, turned[N * N];
    matrix_multiply(n, n, m, g->X, g->B, XB);
    if (g->discrete) {
        matrix_transpose(n, m, g->B, turned);
        matrix_multiply(m, n, m, turned, XB, left);
        for (int i = 0; i < m * m; i++)
            left[i] += g->R[i];
        matrix_transpose(n, n, g->A, turned);
        matrix_multiply(n, n, m, turned, XB, right);
        for (int i = 0; i < n * m; i++)
            right[i] += g->S[i];
    } else {
        memcpy(left, g->R, (size_t)(m * m) * sizeof *left);
        memcpy(right, XB, (size_t)(n * m) * sizeof *right);
    }
    /* Row-major [n][m] is the right-hand side, column-major [m][n], that Fortran wants; and so is
     * the answer K', row-major [n][m]. */
    if (LAPACKE_dposv(LAPACK_COL_MAJOR, 'U', m, n, left, m, right, m) != 0)
        return STANCE_NUMERICAL;
    matrix_transpose(n, m, right, K);
    return matrix_finite((size_t)n * (size_t)m, K) ? STANCE_OK : STANCE_NUMERICAL;
}

static stance_error is_stable(const regulator *g, const double *K, bool *stable)
{
    double loop[N * N] = {0};
    double complex ignored;
    matrix_close(g->n, g->m, g->A, g->B, K, loop);
    return stance_is_stable(g->n, loop, g->discrete, stable, &ignored);
}

/* One step of Newton's method: X of the loop under K. */
static stance_error refine(regulator *g, const double *K)
{
    const int n = g->n, m = g->m;
    double F[N * N], C[N * N], RK[N * N];
    matrix_close(n, m, g->A, g->B, K, F);
    matrix_multiply(m, m, n, g->R, K, RK);
    for (int i = 0; i < n; i++) {
        for (int j = 0; j <= i; j++) {
            double sum = -g->Q[i * n + j];
            for (int k = 0; k < m; k++) {
                sum -= K[k * n + i] * RK[k * n + j] - g->S[i * m + k] * K[k * n + j] -
                       g->S[j * m + k] * K[k * n + i];
            }
            C[i * n + j] = C[j * n + i] = sum;
        }
    }
    return stance_solve_lyapunov(n, F, g->discrete, C, g->X);
}

/* The whole, for the model and weights in g. */
static stance_error regulate(regulator *g, double *K, stance_message *message)
{
    bool stable = false;
    stance_error error =
        stance_check_modes(&(stance_plant){g->n, g->m, g->A, g->B},
                           g->discrete ? EXPANDING_MODES : GROWING_MODES, STANCE_UNCONTROLLABLE,
                           g->discrete ? "the sampled system is not stabilisable: no input reaches"
                                       : "the system is not stabilisable: no input reaches",
                           "", message);
    if (error != STANCE_OK)
        return error;
    error = solve_riccati(g);
    if (error == STANCE_OK)
        error = feedback(g, K);
    if (error == STANCE_OK)
        error = is_stable(g, K, &stable);
    for (int i = 0; i < NEWTON_STEPS && error == STANCE_OK && stable; i++) {
        error = refine(g, K);
        if (error == STANCE_OK)
            error = feedback(g, K);
    }
    if (error == STANCE_OK && stable)
        return error;
    return stance_refuse(message, STANCE_NUMERICAL,
                         "the Riccati equation of the regulator has no stabilising solution to "
                         "working accuracy: the weights differ too much in size");
}

/* Detectability of the cost: every mode that does not decay must cost something. */
static stance_error check_seen(const stance_plant *plant, const double *states,
                               stance_message *message)
{
    const int n = plant->states;
    double transposed[N * N], root[N * N] = {0};
    matrix_transpose(n, n, plant->A, transposed);
    for (int i = 0; i < n; i++)
        root[i * n + i] = sqrt(states[i]);
    return stance_check_modes(&(stance_plant){n, n, transposed, root}, GROWING_MODES,
                              STANCE_BAD_ARGUMENT, "the weights of the states do not see",
                              ", which does not decay by itself", message);
}

static stance_error check_weights(const stance_plant *plant, const double *states,
                                  const double *torques, stance_message *message)
{
    for (int i = 0; i < plant->states; i++)
        if (!isfinite(states[i]) || states[i] < 0)
            return stance_refuse(message, STANCE_BAD_ARGUMENT,
                                 "weight %d of the states is %.6g: it must be finite and not "
                                 "negative",
                                 i, states[i]);
    for (int j = 0; j < plant->inputs; j++)
        if (!isfinite(torques[j]) || torques[j] <= 0)
            return stance_refuse(message, STANCE_BAD_ARGUMENT,
                                 "weight %d of the torques is %.6g: it must be finite and "
                                 "positive",
                                 j, torques[j]);
    return check_seen(plant, states, message);
}

/* Fills g with Ad, Bd, Qd, Sd, Rd. */
static stance_error sample_cost(regulator *g, const stance_plant *plant, double T,
                                const double *states, const double *torques)
{
    const int n = g->n, m = g->m, side = n + m, twice = 2 * side;
    double pencil[16 * N * N] = {0}, E[16 * N * N], transposed[4 * N * N], W[4 * N * N];
    for (int i = 0; i < n; i++) {
        for (int j = 0; j < side; j++) {
            const double f = j < n ? plant->A[i * n + j] : plant->B[i * m + j - n];
            pencil[j * twice + i] = -f;
            pencil[(side + i) * twice + side + j] = f;
        }
    }
    for (int i = 0; i < side; i++)
        pencil[i * twice + side + i] = i < n ? states[i] : torques[i - n];
    const stance_error error = stance_exponential(twice, pencil, T, E, NULL);
    if (error != STANCE_OK)
        return error;
    double *G = pencil; /* not needed any more */
    for (int i = 0; i < side; i++) {
        for (int j = 0; j < side; j++) {
            G[i * side + j] = E[i * twice + side + j];
            transposed[j * side + i] = E[(side + i) * twice + side + j];
        }
    }
    matrix_multiply(side, side, side, transposed, G, W);
    for (int i = 0; i < side; i++) {
        for (int j = 0; j < side; j++) {
            const double w = 0.5 * (W[i * side + j] + W[j * side + i]);
            if (i < n && j < n) {
                g->Q[i * n + j] = w;
                g->A[i * n + j] = transposed[j * side + i];
            } else if (i < n) {
                g->S[i * m + j - n] = w;
                g->B[i * m + j - n] = transposed[j * side + i];
            } else if (j >= n) {
                g->R[(i - n) * m + j - n] = w;
            }
        }
    }
    return STANCE_OK;
}

stance_error stance_lqr(const stance_plant *plant, double T, const double *states,
                        const double *torques, double *K, stance_message *message)
{
    stance_error error = stance_check_plant(plant, message);
    if (error == STANCE_OK)
        error = check_weights(plant, states, torques, message);
    if (error != STANCE_OK)
        return error;
    if (!isfinite(T) || T < 0)
        return stance_refuse(message, STANCE_BAD_ARGUMENT, "a design cannot sample every %.6g s",
                             T);
    const int n = plant->states, m = plant->inputs;
    regulator g = {.n = n, .m = m, .discrete = T > 0};
    if (T > 0) {
        error = sample_cost(&g, plant, T, states, torques);
        if (error != STANCE_OK)
            return stance_refuse(message, error, "discretisation over %.6g s: %s", T,
                                 stance_error_text(error));
    } else {
        memcpy(g.A, plant->A, (size_t)(n * n) * sizeof *g.A);
        memcpy(g.B, plant->B, (size_t)(n * m) * sizeof *g.B);
        for (int i = 0; i < n; i++)
            g.Q[i * n + i] = states[i];
        for (int j = 0; j < m; j++)
            g.R[j * m + j] = torques[j];
    }
    return regulate(&g, K, message);
}
