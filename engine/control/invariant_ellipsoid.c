/* invariant_ellipsoid.c - the widest ellipsoid that a linear loop never leaves, inside linear
 * bounds.
 *
 * E = {x: x' X^-1 x <= 1} is a sublevel set of a Lyapunov function of x' = F x exactly when
 * S = -(F X + X F') is positive definite (of x+ = F x: S = X - F X F'), and lies within
 * |a_k' x| <= d_k exactly when a_k' X a_k <= d_k^2. All of this is linear in X, and the logarithm
 * of the volume, log det X / 2, is concave: a convex problem, with one maximum. It is found by
 * Newton's method on
 *
 *   log det X + mu (log det S + sum log(d_k^2 - a_k' X a_k)),
 *
 * mu falling to MU_END (Boyd and Vandenberghe, Convex Optimization, 2004, chapter 11): what is
 * left out is less than mu (n + count) of the logarithm. The coordinates are those in which the
 * start is the unit ball.
 */
#include "control.h"

#include <lapacke.h>
#include <string.h>

enum {
    STATES = 2 * STANCE_MAX_POSTURE,
    SQUARE = STATES * STATES,
    TERMS = STATES * (STATES + 1) / 2, /* of a symmetric matrix */
    BOUNDS = 16,
    NEWTON_STEPS = 60,
};
#define MU_BEGIN 1.0
#define MU_END 1e-3
#define MU_FALL 0.2
#define LINE_HALVINGS 33

struct problem {
    int n, terms, count;
    bool sampled;
    double F[SQUARE], a[BOUNDS * STATES], d2[BOUNDS]; /* a scaled so that d2 is 1 */
};

/* S of a symmetric X. */
static void decrease(const struct problem *p, const double *X, double *S)
{
    const int n = p->n;
    double FX[SQUARE] = {0}, Ft[SQUARE] = {0}, FXFt[SQUARE] = {0};
    matrix_multiply(n, n, n, p->F, X, FX);
    matrix_transpose(n, n, p->F, Ft);
    matrix_multiply(n, n, n, FX, Ft, FXFt);
    for (int i = 0; i < n; i++) {
        for (int j = 0; j < n; j++) {
            S[i * n + j] =
                p->sampled ? X[i * n + j] - FXFt[i * n + j] : -FX[i * n + j] - FX[j * n + i];
        }
    }
}

static double quadratic(int n, const double *X, const double *a)
{
    double sum = 0;
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++)
            sum += a[i] * X[i * n + j] * a[j];
    return sum;
}

/* Inverse and logarithm of the determinant; false: not positive definite. */
static bool invert(int n, const double *M, double *inverse, double *log_det)
{
    memcpy(inverse, M, (size_t)n * (size_t)n * sizeof *M);
    if (LAPACKE_dpotrf(LAPACK_COL_MAJOR, 'U', n, inverse, n) != 0)
        return false;
    *log_det = 0;
    for (int i = 0; i < n; i++)
        *log_det += 2 * log(inverse[i * n + i]);
    LAPACKE_dpotri(LAPACK_COL_MAJOR, 'U', n, inverse, n);
    for (int i = 0; i < n; i++)
        for (int j = 0; j < i; j++)
            inverse[j * n + i] = inverse[i * n + j];
    return true;
}

/* What is maximised; -INFINITY outside. */
static double merit(const struct problem *p, double mu, const double *X)
{
    double S[SQUARE] = {0}, scratch[SQUARE] = {0}, volume, margin;
    decrease(p, X, S);
    if (!invert(p->n, X, scratch, &volume) || !invert(p->n, S, scratch, &margin))
        return -INFINITY;
    for (int k = 0; k < p->count; k++) {
        const double slack = p->d2[k] - quadratic(p->n, X, &p->a[k * p->n]);
        if (slack <= 0)
            return -INFINITY;
        margin += log(slack);
    }
    return volume + mu * margin;
}

/* E of term t: ones at (i, j) and (j, i). */
static void basis(int n, int t, double *E)
{
    int i = 0;
    while (t > i)
        t -= ++i;
    memset(E, 0, (size_t)n * (size_t)n * sizeof *E);
    E[i * n + t] = E[t * n + i] = 1;
}

/* Adds weight times gradient and minus Hessian of log det M(X) at M^-1 = `inverse`. */
static void add_log_det(const struct problem *p, double weight, const double *inverse, bool of_S,
                        double *gradient, double *hessian)
{
    const int n = p->n;
    double product[TERMS][SQUARE];
    for (int t = 0; t < p->terms; t++) {
        double E[SQUARE], S[SQUARE];
        basis(n, t, E);
        decrease(p, E, S);
        matrix_multiply(n, n, n, inverse, of_S ? S : E, product[t]);
        for (int i = 0; i < n; i++)
            gradient[t] += weight * product[t][i * n + i];
    }
    for (int t = 0; t < p->terms; t++) {
        for (int u = 0; u <= t; u++) {
            double trace = 0;
            for (int i = 0; i < n; i++)
                for (int j = 0; j < n; j++)
                    trace += product[t][i * n + j] * product[u][j * n + i];
            hessian[t * p->terms + u] += weight * trace;
        }
    }
}

/* Newton's direction; returns half the squared decrement, negative when there is none. */
static double direction(const struct problem *p, double mu, const double *X, double *step)
{
    const int n = p->n, terms = p->terms;
    double S[SQUARE] = {0}, inverse[SQUARE] = {0}, ignored, gradient[TERMS] = {0};
    double hessian[TERMS * TERMS] = {0};

    invert(n, X, inverse, &ignored);
    add_log_det(p, 1, inverse, false, gradient, hessian);
    decrease(p, X, S);
    invert(n, S, inverse, &ignored);
    add_log_det(p, mu, inverse, true, gradient, hessian);
    for (int k = 0; k < p->count; k++) {
        double slope[TERMS];
        const double slack = p->d2[k] - quadratic(n, X, &p->a[k * n]);
        for (int t = 0; t < terms; t++) {
            double E[SQUARE];
            basis(n, t, E);
            slope[t] = -quadratic(n, E, &p->a[k * n]) / slack;
            gradient[t] += mu * slope[t];
            for (int u = 0; u <= t; u++)
                hessian[t * terms + u] += mu * slope[t] * slope[u];
        }
    }
    double solution[TERMS], decrement = 0;
    memcpy(solution, gradient, sizeof solution);
    if (LAPACKE_dposv(LAPACK_COL_MAJOR, 'U', terms, 1, hessian, terms, solution, terms) != 0)
        return -1;
    memset(step, 0, (size_t)n * (size_t)n * sizeof *step);
    for (int t = 0; t < terms; t++) {
        double E[SQUARE];
        basis(n, t, E);
        for (int i = 0; i < n * n; i++)
            step[i] += solution[t] * E[i];
        decrement += solution[t] * gradient[t];
    }
    return decrement / 2;
}

/* The merit at a point on the way; that point in trial[]. */
static double along(const struct problem *p, double mu, const double *X, double length,
                    const double *step, double *trial)
{
    for (int i = 0; i < p->n * p->n; i++)
        trial[i] = X[i] + length * step[i];
    return merit(p, mu, trial);
}

static void maximise_at(const struct problem *p, double mu, double *X)
{
    double step[SQUARE] = {0}, trial[SQUARE] = {0};
    for (int k = 0; k < NEWTON_STEPS; k++) {
        const double now = merit(p, mu, X), decrement = direction(p, mu, X, step);
        if (!(decrement > 1e-8))
            return;
        double length = 1, next = along(p, mu, X, length, step, trial);
        for (int j = 0; j < LINE_HALVINGS && !(next >= now + 0.1 * length * decrement); j++) {
            length /= 2;
            next = along(p, mu, X, length, step, trial);
        }
        if (!(next > now))
            return;
        memcpy(X, trial, (size_t)p->n * (size_t)p->n * sizeof *X);
    }
}

static void maximise(const struct problem *p, double *X)
{
    const int falls = (int)ceil(log(MU_END / MU_BEGIN) / log(MU_FALL));
    double mu = MU_BEGIN;
    for (int k = 0; k <= falls; k++, mu = fmax(MU_END, mu * MU_FALL))
        maximise_at(p, mu, X);
}

/* The problem in coordinates y, x = L y, in which the start is half the unit ball. L: lower
 * triangle, row-major. */
static stance_error scale(struct problem *p, const double *loop, const double *a, const double *d,
                          double *L)
{
    const int n = p->n;
    double ones[STATES], P[SQUARE] = {0}, alone[STATES], extent[STATES], level = 0;
    double upper[SQUARE] = {0}, scaled[SQUARE] = {0}, log_det;
    int binding = -1;

    for (int i = 0; i < n; i++)
        ones[i] = 1;
    stance_error error = stance_lyapunov(n, loop, p->sampled, ones, P, NULL);
    if (error == STANCE_OK)
        error = stance_sublevel(n, P, p->count, a, d, &level, &binding, alone, extent);
    if (error != STANCE_OK)
        return error;
    if (!(level > 0) || !isfinite(level) || !invert(n, P, L, &log_det))
        return STANCE_BAD_ARGUMENT;
    for (int i = 0; i < n * n; i++)
        L[i] *= level;
    /* Column-major upper U' U is row-major lower L L'. */
    if (LAPACKE_dpotrf(LAPACK_COL_MAJOR, 'U', n, L, n) != 0)
        return STANCE_NUMERICAL;
    for (int i = 0; i < n; i++)
        for (int j = i + 1; j < n; j++)
            L[i * n + j] = 0;
    matrix_multiply(n, n, n, loop, L, scaled);
    matrix_transpose(n, n, L, upper);
    LAPACKE_dtrtrs(LAPACK_ROW_MAJOR, 'L', 'N', 'N', n, n, L, n, scaled, n);
    memcpy(p->F, scaled, (size_t)n * (size_t)n * sizeof *scaled);
    for (int k = 0; k < p->count; k++) {
        for (int i = 0; i < n; i++) {
            double sum = 0;
            for (int j = 0; j < n; j++)
                sum += upper[i * n + j] * a[k * n + j];
            p->a[k * n + i] = sum / d[k];
        }
        p->d2[k] = 1;
    }
    return STANCE_OK;
}

stance_error stance_invariant_ellipsoid(int n, const double *loop, bool sampled, int count,
                                        const double *a, const double *d, double *P,
                                        stance_message *message)
{
    struct problem p = {.n = n, .terms = n * (n + 1) / 2, .count = count, .sampled = sampled};
    double L[SQUARE] = {0}, X[SQUARE] = {0}, product[SQUARE], upper[SQUARE] = {0}, log_det;

    if (n < 1 || n > STATES || count < 1 || count > BOUNDS ||
        !matrix_finite((size_t)n * (size_t)n, loop)) {
        return stance_refuse(message, STANCE_BAD_ARGUMENT,
                             "no set: a finite loop of 1 to %d states "
                             "and 1 to %d bounds are needed",
                             STATES, BOUNDS);
    }
    for (int k = 0; k < count; k++) {
        if (!(d[k] > 0)) {
            return stance_refuse(message, STANCE_BAD_ARGUMENT,
                                 "bound %d leaves no set about the equilibrium", k);
        }
    }
    const stance_error error = scale(&p, loop, a, d, L);
    if (error != STANCE_OK)
        return stance_refuse(message, error, "there is no set: the loop is not stable");
    for (int i = 0; i < n; i++)
        X[i * n + i] = 0.5;
    maximise(&p, X);
    /* P = (L X L')^-1 */
    matrix_multiply(n, n, n, L, X, product);
    matrix_transpose(n, n, L, upper);
    matrix_multiply(n, n, n, product, upper, X);
    return invert(n, X, P, &log_det)
               ? STANCE_OK
               : stance_refuse(message, STANCE_NUMERICAL, "the widest set is too thin for double");
}
