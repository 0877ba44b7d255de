/* discrete.c - sampled control: discretisation under a zero-order hold, critical sample time.
 *
 * x' = A x + B u with u held over T gives x+ = Ad x + Bd u, Ad = exp(A T) and
 * Bd = (integral of exp(A t) over 0 ... T) B. SLICOT's MB05ND computes both by Pade approximation
 * with scaling and squaring. A gain K designed for continuous time keeps the sampled loop stable
 * as long as the spectral radius of Ad(T) - Bd(T) K stays below 1.
 */
#include "control.h"

#include <float.h>
#include <string.h>

/* SLICOT, Fortran: EX = exp(A delta), EXINT = its integral from 0 to delta. */
void mb05nd_(const int *n, const double *delta, const double *a, const int *lda, double *ex,
             const int *ldex, double *exint, const int *ldexint, const double *tol, int *iwork,
             double *dwork, const int *ldwork, int *info);

/* Room for one pair (n, m), so that a scan over T allocates once. */
typedef struct sampled {
    int n, m;
    const double *A, *B, *K;
    double *Ad, *Bd, *integral, *loop, *re, *im, *work;
    int *integers;
} sampled;

static void sampled_free(sampled *s)
{
    free(s->Ad);
    free(s->integers);
}

static stance_error sampled_make(sampled *s, int n, int m, const double *A, const double *B,
                                 const double *K)
{
    if (n < 1 || m < 1) {
        return STANCE_BAD_ARGUMENT;
    }
    const size_t nn = (size_t)n * (size_t)n, nm = (size_t)n * (size_t)m;
    if (!matrix_finite(nn, A) || !matrix_finite(nm, B) || (K && !matrix_finite(nm, K))) {
        return STANCE_BAD_ARGUMENT;
    }
    *s = (sampled){.n = n, .m = m, .A = A, .B = B, .K = K};
    double *room = matrix_room(5 * nn + nm + 2 * (size_t)n);
    s->Ad = room;
    s->integers = calloc((size_t)n, sizeof *s->integers);
    if (!room || !s->integers) {
        sampled_free(s);
        return STANCE_NO_MEMORY;
    }
    s->integral = room + nn;
    s->loop = room + 2 * nn;
    s->work = room + 3 * nn; /* two matrices */
    s->Bd = room + 5 * nn;
    s->re = s->Bd + nm;
    s->im = s->re + n;
    return STANCE_OK;
}

/* Ad and Bd for T. The transposes that Fortran sees have transposed exponentials. */
static stance_error sampled_discretise(sampled *s, double T)
{
    const int n = s->n, room = 2 * n * n;
    const double tolerance = DBL_EPSILON;
    int info = 0;
    mb05nd_(&n, &T, s->A, &n, s->Ad, &n, s->integral, &n, &tolerance, s->integers, s->work, &room,
            &info);
    if (info != 0) {
        return STANCE_NUMERICAL;
    }
    matrix_multiply(n, n, s->m, s->integral, s->B, s->Bd);
    const size_t nn = (size_t)n * (size_t)n, nm = (size_t)n * (size_t)s->m;
    return matrix_finite(nn, s->Ad) && matrix_finite(nm, s->Bd) ? STANCE_OK : STANCE_NUMERICAL;
}

stance_error stance_discretise(int n, int m, const double *A, const double *B, double T, double *Ad,
                               double *Bd)
{
    sampled s;
    if (!isfinite(T) || T < 0) {
        return STANCE_BAD_ARGUMENT;
    }
    stance_error error = sampled_make(&s, n, m, A, B, NULL);
    if (error != STANCE_OK) {
        return error;
    }
    error = sampled_discretise(&s, T);
    if (error == STANCE_OK) {
        memcpy(Ad, s.Ad, (size_t)n * (size_t)n * sizeof *Ad);
        memcpy(Bd, s.Bd, (size_t)n * (size_t)m * sizeof *Bd);
    }
    sampled_free(&s);
    return error;
}

/* *excess = spectral radius of the sampled loop minus 1. */
static stance_error sampled_excess(sampled *s, double T, double *excess)
{
    stance_error error = sampled_discretise(s, T);
    if (error != STANCE_OK) {
        return error;
    }
    matrix_multiply(s->n, s->m, s->n, s->Bd, s->K, s->loop);
    for (int i = 0; i < s->n * s->n; i++) {
        s->loop[i] = s->Ad[i] - s->loop[i];
    }
    error = stance_eigenvalues(s->n, s->loop, s->re, s->im);
    double radius = 0;
    for (int i = 0; error == STANCE_OK && i < s->n; i++) {
        radius = fmax(radius, hypot(s->re[i], s->im[i]));
    }
    *excess = radius - 1;
    return error;
}

/* Largest |eigenvalue| and largest real part of a matrix. */
static stance_error spectrum(sampled *s, const double *matrix, double *size, double *growth)
{
    const stance_error error = stance_eigenvalues(s->n, matrix, s->re, s->im);
    *growth = -INFINITY;
    for (int i = 0; error == STANCE_OK && i < s->n; i++) {
        *size = fmax(*size, hypot(s->re[i], s->im[i]));
        *growth = fmax(*growth, s->re[i]);
    }
    return error;
}

/* Highest excess between two sample times; golden section. *T is where. */
static stance_error sampled_peak(sampled *s, double low, double high, double *T, double *excess)
{
    const double part = 0.3819660112501051;
    double a = low + part * (high - low), b = high - part * (high - low), at_a, at_b;
    stance_error error = sampled_excess(s, a, &at_a);
    if (error == STANCE_OK) {
        error = sampled_excess(s, b, &at_b);
    }
    for (int i = 0; i < 60 && error == STANCE_OK; i++) {
        if (at_a > at_b) {
            high = b, b = a, at_b = at_a;
            a = low + part * (high - low);
            error = sampled_excess(s, a, &at_a);
        } else {
            low = a, a = b, at_a = at_b;
            b = high - part * (high - low);
            error = sampled_excess(s, b, &at_b);
        }
    }
    if (error == STANCE_OK) {
        *T = at_a > at_b ? a : b;
        *excess = fmax(at_a, at_b);
    }
    return error;
}

/* Bisection between a stable and an unstable sample time until they are neighbours. */
static stance_error sampled_bisect(sampled *s, double stable, double unstable, double *T)
{
    for (;;) {
        const double middle = stable + (unstable - stable) / 2;
        double excess;
        if (!(middle > stable && middle < unstable)) {
            *T = unstable;
            return STANCE_OK;
        }
        const stance_error error = sampled_excess(s, middle, &excess);
        if (error != STANCE_OK) {
            return error;
        }
        if (excess < 0) {
            stable = middle;
        } else {
            unstable = middle;
        }
    }
}

/* Walks up in T. Between two stable points the excess may still have risen above zero: wherever
 * three points in a row show a maximum, its height is looked at. */
static stance_error sampled_scan(sampled *s, double interval, double longest, double *T)
{
    double before = -INFINITY, excess = -INFINITY;
    const double count = fmax(1, ceil(longest / interval));
    *T = INFINITY;
    for (double i = 1; i <= count; i++) {
        const double time = fmin(i * interval, longest);
        double next;
        stance_error error = sampled_excess(s, time, &next);
        if (error != STANCE_OK) {
            return error;
        }
        if (i > 2 && excess > before && excess >= next && next < 0) {
            double where, height;
            error = sampled_peak(s, time - 2 * interval, time, &where, &height);
            if (error != STANCE_OK) {
                return error;
            }
            if (height >= 0) {
                return sampled_bisect(s, time - 2 * interval, where, T);
            }
        }
        if (next >= 0) {
            return sampled_bisect(s, fmax(0, time - interval), time, T);
        }
        before = excess;
        excess = next;
    }
    return STANCE_OK;
}

stance_error stance_critical_sample_time(int n, int m, const double *A, const double *B,
                                         const double *K, double longest, double *T)
{
    sampled s;
    if (!isfinite(longest) || longest <= 0) {
        return STANCE_BAD_ARGUMENT;
    }
    stance_error error = sampled_make(&s, n, m, A, B, K);
    if (error != STANCE_OK) {
        return error;
    }
    double fastest = 0, growth;
    error = spectrum(&s, A, &fastest, &growth);
    if (error == STANCE_OK) {
        matrix_multiply(n, m, n, B, K, s.loop);
        for (int i = 0; i < n * n; i++) {
            s.loop[i] = A[i] - s.loop[i];
        }
        error = spectrum(&s, s.loop, &fastest, &growth);
    }
    if (error == STANCE_OK && growth >= 0) {
        *T = 0;
    } else if (error == STANCE_OK) {
        /* Sixty points to a turn of the fastest mode, open or closed. */
        error = sampled_scan(&s, fmin(longest, 2 * M_PI / (60 * fastest)), longest, T);
    }
    sampled_free(&s);
    return error;
}
