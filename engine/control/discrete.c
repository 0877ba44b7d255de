/* discrete.c - sampled control: discretisation under a zero-order hold, critical sample time.
 *
 * x' = A x + B u with u held over T gives x+ = Ad x + Bd u, Ad = exp(A T) and
 * Bd = (integral of exp(A t) over 0 ... T) B. SLICOT's MB05ND computes both by Pade approximation
 * with scaling and squaring. A gain K designed for continuous time keeps the sampled loop stable
 * as long as the spectral radius of Ad(T) - Bd(T) K stays below 1. Where the torques computed from
 * a sample act d samples later, those under way belong to the state, the next one first: (x, u1,
 * ... ud) moves as [Ad Bd 0; 0 0 1; -K 0 0], and its spectral radius counts.
 *
 * White noise w on the commands, of covariance W, makes the state z of that loop, z+ = L z + G w,
 * wander with the covariance P = L P L' + G W G'; P is the sum of L^k G W G' L'^k, doubled:
 * P <- P + L P L', L <- L^2 (Smith, SIAM J. Appl. Math. 16(1), 1968). Noise n of what is measured
 * is -K n on the commands.
 *
 * The spectral radius has corners where eigenvalues meet, and may exceed 1 in windows of T as
 * narrow as one likes. The search therefore watches three smooth functions of T made of the
 * eigenvalues z,
 *
 *   prod (1 - z_i),   prod (1 + z_i),   prod over i < j of (1 - z_i z_j),
 *
 * positive while all |z| < 1; one of them vanishes where a real eigenvalue passes 1 or -1 or a pair
 * passes the circle. On a scan that resolves the fastest mode, their signs and minima find it.
 */
#include "control.h"

#include <complex.h>
#include <float.h>
#include <string.h>

/* SLICOT, Fortran: EX = exp(A delta), EXINT = its integral from 0 to delta. */
void mb05nd_(const int *n, const double *delta, const double *a, const int *lda, double *ex,
             const int *ldex, double *exint, const int *ldexint, const double *tol, int *iwork,
             double *dwork, const int *ldwork, int *info);

stance_error stance_exponential(int n, const double *A, double T, double *E, double *integral)
{
    enum { N = STANCE_LOOP_MOST };
    double unused[N * N], work[2 * N * N];
    const double tolerance = DBL_EPSILON;
    const int room = 2 * n * n;
    int integers[N], info = 0;
    /* The transposes that Fortran sees have transposed exponentials. */
    mb05nd_(&n, &T, A, &n, E, &n, integral ? integral : unused, &n, &tolerance, integers, work,
            &room, &info);
    return info == 0 && matrix_finite((size_t)n * (size_t)n, E) ? STANCE_OK : STANCE_NUMERICAL;
}

enum { N = STANCE_PLANT_MOST, LOOP = STANCE_LOOP_MOST };

/* A loop, and what it is at one T. */
typedef struct sampled {
    const stance_plant *plant;
    const double *K;
    int n, m, delay;
    int side; /* of the loop: n + delay m */
    double Ad[N * N], Bd[N * N], integral[N * N], loop[LOOP * LOOP], re[LOOP], im[LOOP];
} sampled;

static stance_error sampled_make(sampled *s, const stance_plant *plant, const double *K, int delay)
{
    const stance_error error = stance_check_plant(plant, NULL);
    const int n = plant->states, m = plant->inputs;
    if (error != STANCE_OK || delay < 0 || (delay && !K) || n + delay * m > LOOP ||
        (K && !matrix_finite((size_t)n * (size_t)m, K)))
        return STANCE_BAD_ARGUMENT;
    s->plant = plant, s->K = K;
    s->n = n, s->m = m, s->delay = delay;
    s->side = n + delay * m;
    return STANCE_OK;
}

/* Ad and Bd for T. */
static stance_error sampled_discretise(sampled *s, double T)
{
    const stance_error error = stance_exponential(s->n, s->plant->A, T, s->Ad, s->integral);
    if (error != STANCE_OK)
        return error;
    matrix_multiply(s->n, s->n, s->m, s->integral, s->plant->B, s->Bd);
    return matrix_finite((size_t)s->n * (size_t)s->m, s->Bd) ? STANCE_OK : STANCE_NUMERICAL;
}

stance_error stance_discretise(const stance_plant *plant, double T, double *Ad, double *Bd)
{
    sampled s;
    if (!isfinite(T) || T < 0)
        return STANCE_BAD_ARGUMENT;
    stance_error error = sampled_make(&s, plant, NULL, 0);
    if (error == STANCE_OK)
        error = sampled_discretise(&s, T);
    if (error == STANCE_OK) {
        memcpy(Ad, s.Ad, (size_t)(s.n * s.n) * sizeof *Ad);
        memcpy(Bd, s.Bd, (size_t)(s.n * s.m) * sizeof *Bd);
    }
    return error;
}

/* The loop at T, s->loop. */
static stance_error sampled_close(sampled *s, double T)
{
    const int n = s->n, m = s->m, side = s->side;
    const stance_error error = sampled_discretise(s, T);
    if (error != STANCE_OK)
        return error;
    if (side == n) {
        matrix_close(n, m, s->Ad, s->Bd, s->K, s->loop);
        return STANCE_OK;
    }
    memset(s->loop, 0, (size_t)(side * side) * sizeof *s->loop);
    for (int i = 0; i < n; i++) {
        memcpy(s->loop + i * side, s->Ad + i * n, (size_t)n * sizeof *s->Ad);
        memcpy(s->loop + i * side + n, s->Bd + i * m, (size_t)m * sizeof *s->Bd);
        for (int j = 0; j < m; j++)
            s->loop[(side - m + j) * side + i] = -s->K[j * n + i];
    }
    for (int i = n; i < side - m; i++)
        s->loop[i * side + i + m] = 1;
    return STANCE_OK;
}

/* Its eigenvalues, into s->re and s->im. */
static stance_error sampled_eigenvalues(sampled *s, double T)
{
    const stance_error error = sampled_close(s, T);
    return error == STANCE_OK ? stance_eigenvalues(s->side, s->loop, s->re, s->im) : error;
}

stance_error stance_sampled_loop(const stance_plant *plant, const stance_sampling *loop, double *re,
                                 double *im)
{
    sampled s;
    if (!isfinite(loop->T) || loop->T < 0)
        return STANCE_BAD_ARGUMENT;
    stance_error error = sampled_make(&s, plant, loop->K, loop->delay);
    if (error == STANCE_OK)
        error = sampled_eigenvalues(&s, loop->T);
    if (error == STANCE_OK) {
        memcpy(re, s.re, (size_t)s.side * sizeof *re);
        memcpy(im, s.im, (size_t)s.side * sizeof *im);
    }
    return error;
}

/* P[side][side]: what one sample's noise on the commands does to the state. */
static void disturb(const sampled *s, const double *measured, double commanded, double *P)
{
    const int n = s->n, m = s->m, side = s->side;
    for (int i = 0; i < side; i++)
        for (int j = 0; j < side; j++) {
            P[i * side + j] = 0;
            for (int a = 0; a < m; a++)
                for (int b = 0; b < m; b++) {
                    double W = a == b ? commanded : 0;
                    for (int k = 0; k < n; k++)
                        W += s->K[a * n + k] * measured[k] * s->K[b * n + k];
                    const double Gi = s->delay ? i == side - m + a : s->Bd[i * m + a];
                    const double Gj = s->delay ? j == side - m + b : s->Bd[j * m + b];
                    P[i * side + j] += Gi * W * Gj;
                }
        }
}

stance_error stance_sampled_wander(const stance_plant *plant, const stance_sampling *loop,
                                   const double *measured, double commanded, double *rms)
{
    sampled s;
    double P[LOOP * LOOP] = {0}, half[LOOP * LOOP], next[LOOP * LOOP] = {0}, largest = 1;
    if (!isfinite(loop->T) || loop->T <= 0 || !loop->K)
        return STANCE_BAD_ARGUMENT;
    stance_error error = sampled_make(&s, plant, loop->K, loop->delay);
    if (error == STANCE_OK)
        error = sampled_close(&s, loop->T);
    if (error != STANCE_OK)
        return error;
    const int side = s.side, whole = side * side;
    disturb(&s, measured, commanded, P);
    for (int round = 0; round < 64 && largest > 0x1p-60; round++) {
        matrix_multiply(side, side, side, s.loop, P, half);
        for (int i = 0; i < side; i++)
            for (int j = 0; j < side; j++)
                next[i * side + j] = matrix_dot(side, half + i * side, s.loop + j * side);
        for (int i = 0; i < whole; i++)
            P[i] += next[i];
        matrix_multiply(side, side, side, s.loop, s.loop, half);
        memcpy(s.loop, half, (size_t)whole * sizeof *half);
        largest = matrix_largest(whole, s.loop);
        if (!matrix_finite((size_t)whole, P))
            return STANCE_NUMERICAL; /* not stable */
    }
    for (int i = 0; i < s.n; i++)
        rms[i] = sqrt(fmax(0, P[i * side + i]));
    return largest > 0x1p-60 ? STANCE_NUMERICAL : STANCE_OK;
}

void stance_lagged(const stance_plant *plant, const double *K, double lag, double *A1, double *B1,
                   double *K1)
{
    const int n = plant->states, m = plant->inputs, side = n + m;
    memset(A1, 0, (size_t)(side * side) * sizeof *A1);
    memset(B1, 0, (size_t)(side * m) * sizeof *B1);
    memset(K1, 0, (size_t)(m * side) * sizeof *K1);
    for (int i = 0; i < n; i++) {
        memcpy(A1 + i * side, plant->A + i * n, (size_t)n * sizeof *A1);
        memcpy(A1 + i * side + n, plant->B + i * m, (size_t)m * sizeof *A1);
    }
    for (int j = 0; j < m; j++) {
        A1[(n + j) * side + n + j] = -1 / lag;
        B1[(n + j) * m + j] = 1 / lag;
        memcpy(K1 + j * side, K + j * n, (size_t)n * sizeof *K);
    }
}

enum { GUARDS = 3 };

/* What the sampled loop is like at one T. */
typedef struct sample {
    double T, excess;     /* spectral radius minus 1 */
    double guard[GUARDS]; /* the three products */
} sample;

static stance_error sampled_look(sampled *s, double T, sample *look)
{
    const stance_error error = sampled_eigenvalues(s, T);
    if (error != STANCE_OK)
        return error;
    double radius = 0;
    double complex below = 1, above = 1, pairs = 1;
    for (int i = 0; i < s->side; i++) {
        const double complex z = CMPLX(s->re[i], s->im[i]);
        radius = fmax(radius, cabs(z));
        below *= 1 - z;
        above *= 1 + z;
        for (int j = 0; j < i; j++)
            pairs *= 1 - z * CMPLX(s->re[j], s->im[j]);
    }
    *look = (sample){T, radius - 1, {creal(below), creal(above), creal(pairs)}};
    return STANCE_OK;
}

/* Modes that only decay count up to this many times the slowest mode: they alone make no windows,
 * and may be those of actuators that are all but instant. */
#define DECAYS_COUNT 1e3

/* Sizes of a matrix's eigenvalues: the largest of those that decay without swinging, the largest of
 * the others, the smallest; and the largest real part. */
static stance_error spectrum(sampled *s, const double *matrix, double *decay, double *size,
                             double *slow, double *growth)
{
    const stance_error error = stance_eigenvalues(s->n, matrix, s->re, s->im);
    *growth = -INFINITY;
    for (int i = 0; error == STANCE_OK && i < s->n; i++) {
        const double own = hypot(s->re[i], s->im[i]);
        double *const of = s->im[i] == 0 && s->re[i] < 0 ? decay : size;
        *of = fmax(*of, own);
        *slow = own > 0 ? fmin(*slow, own) : *slow;
        *growth = fmax(*growth, s->re[i]);
    }
    return error;
}

/* Golden section for the minimum of one guard; *best is the lowest point met. */
static stance_error sampled_minimum(sampled *s, int guard, double low, double high, sample *best)
{
    const double part = 0.3819660112501051;
    sample a, b;
    stance_error error = sampled_look(s, low + part * (high - low), &a);
    if (error == STANCE_OK)
        error = sampled_look(s, high - part * (high - low), &b);
    for (int i = 0; i < 60 && error == STANCE_OK; i++) {
        if (a.guard[guard] < b.guard[guard]) {
            high = b.T;
            b = a;
            error = sampled_look(s, low + part * (high - low), &a);
        } else {
            low = a.T;
            a = b;
            error = sampled_look(s, high - part * (high - low), &b);
        }
    }
    if (error == STANCE_OK)
        *best = a.guard[guard] < b.guard[guard] ? a : b;
    return error;
}

/* Bisection between a stable and an unstable sample time until they are neighbours. */
static stance_error sampled_bisect(sampled *s, double stable, double unstable, double *T)
{
    for (;;) {
        const double middle = stable + (unstable - stable) / 2;
        sample look;
        if (!(middle > stable && middle < unstable)) {
            *T = unstable;
            return STANCE_OK;
        }
        const stance_error error = sampled_look(s, middle, &look);
        if (error != STANCE_OK)
            return error;
        if (look.excess < 0)
            stable = middle;
        else
            unstable = middle;
    }
}

/* The first unstable window between three stable points in a row, if their guards show that one
 * may be there. *T stays as it is when there is none. */
static stance_error sampled_between(sampled *s, const sample *look, double *T)
{
    for (int g = 0; g < GUARDS; g++) {
        if (look[1].guard[g] > look[0].guard[g] || look[1].guard[g] > look[2].guard[g])
            continue;
        sample lowest;
        double found;
        stance_error error = sampled_minimum(s, g, look[0].T, look[2].T, &lowest);
        if (error == STANCE_OK && lowest.excess >= 0) {
            error = sampled_bisect(s, look[0].T, lowest.T, &found);
            *T = error == STANCE_OK ? fmin(*T, found) : *T;
        }
        if (error != STANCE_OK)
            return error;
    }
    return STANCE_OK;
}

/* Walks up in T until the loop is unstable, looking between the points too. */
static stance_error sampled_scan(sampled *s, double interval, double longest, double *T)
{
    sample look[3] = {{0}};
    const int64_t count = (int64_t)fmin(1e15, fmax(1, ceil(longest / interval)));

    *T = INFINITY;
    for (int64_t i = 1; i <= count; i++) {
        look[0] = look[1];
        look[1] = look[2];
        stance_error error = sampled_look(s, fmin((double)i * interval, longest), &look[2]);
        if (error == STANCE_OK && i > 2)
            error = sampled_between(s, look, T);
        if (error == STANCE_OK && !isfinite(*T) && look[2].excess >= 0)
            error = sampled_bisect(s, look[1].T, look[2].T, T);
        if (error != STANCE_OK || isfinite(*T))
            return error;
    }
    return STANCE_OK;
}

stance_error stance_critical_sample_time(const stance_plant *plant, const stance_sampling *loop,
                                         double longest, double *T)
{
    sampled s;
    double decay = 0, size = 0, slow = INFINITY, growth;
    if (!isfinite(longest) || longest <= 0)
        return STANCE_BAD_ARGUMENT;
    stance_error error = sampled_make(&s, plant, loop->K, loop->delay);
    if (error != STANCE_OK)
        return error;
    error = spectrum(&s, plant->A, &decay, &size, &slow, &growth);
    if (error == STANCE_OK) {
        matrix_close(s.n, s.m, plant->A, plant->B, s.K, s.loop);
        error = spectrum(&s, s.loop, &decay, &size, &slow, &growth);
    }
    *T = 0;
    if (error != STANCE_OK || growth >= 0)
        return error;
    /* Sixty points to a turn of the fastest mode, open or closed. */
    const double fastest = fmax(size, fmin(decay, DECAYS_COUNT * slow));
    return sampled_scan(&s, fmin(longest, 2 * M_PI / (60 * fastest)), longest, T);
}

/* ---- pole assignment for the sampled model --------------------------------------------------- */

/* (exp(s T) - 1) / T, exact for small T too. */
static double complex delta_pole(double complex pole, double T)
{
    const double re = creal(pole) * T, im = cimag(pole) * T, half = sin(im / 2);
    const double grown = expm1(re);
    return CMPLX(grown * cos(im) - 2 * half * half, (1 + grown) * sin(im)) / T;
}

static stance_error check_pairs(int n, const stance_poles *poles, double T, stance_message *message)
{
    const double *const re = poles->re, *const im = poles->im;
    for (int i = 0; i < n; i++) {
        if (fabs(im[i]) * T >= M_PI) {
            char text[64];
            return stance_refuse(message, STANCE_BAD_POLES,
                                 "the pole %s turns %.3g times in a sample of %.6g s: less than "
                                 "half a turn can be told from its mirror image",
                                 stance_complex_text(CMPLX(re[i], im[i]), text),
                                 fabs(im[i]) * T / (2 * M_PI), T);
        }
    }
    return STANCE_OK;
}

/* Ad - Bd K = I + T (D - E K) with D = (Ad - I)/T = phi A, E = Bd/T = phi B and phi the integral
 * over T: the same gain places (exp(s T) - 1)/T for (D, E), which tend to s, A and B as T goes to
 * 0, where Ad alone would lose its digits to the identity. So does the robust gain to that of
 * continuous time. */
static stance_error place_sampled(stance_placement how, const placement *near, double T, double *K,
                                  stance_robustness *robustness, stance_message *message)
{
    sampled s;
    const int n = near->plant->states, m = near->plant->inputs;
    stance_error error = sampled_make(&s, near->plant, NULL, 0);
    if (error != STANCE_OK)
        return stance_refuse(message, error, "pole placement: %s", stance_error_text(error));
    error = sampled_discretise(&s, T);
    if (error != STANCE_OK)
        return stance_refuse(message, error, "discretisation over %.6g s: %s", T,
                             stance_error_text(error));
    error = check_pairs(n, near->poles, T, message);
    if (error != STANCE_OK)
        return error;
    matrix_multiply(n, n, n, s.integral, near->plant->A, s.loop);
    for (int i = 0; i < n * n; i++)
        s.loop[i] /= T;
    for (int i = 0; i < n * m; i++)
        s.Bd[i] /= T;
    for (int i = 0; i < n; i++) {
        const double complex pole = delta_pole(CMPLX(near->poles->re[i], near->poles->im[i]), T);
        s.re[i] = creal(pole);
        s.im[i] = cimag(pole);
    }
    const placement wanted = {&(stance_plant){n, m, s.loop, s.Bd}, &(stance_poles){s.re, s.im}};
    return how == STANCE_SCHUR ? stance_place_schur(&wanted, K, message)
                               : stance_place_robust(&wanted, near, K, robustness, message);
}

stance_error stance_place(stance_placement how, const stance_plant *plant, double T,
                          const stance_poles *poles, double *K, stance_robustness *robustness,
                          stance_message *message)
{
    const placement wanted = {plant, poles};
    stance_robustness ignored = {0};
    robustness = robustness ? robustness : &ignored;
    *robustness = (stance_robustness){0, NAN};
    if (!isfinite(T) || T < 0)
        return stance_refuse(message, STANCE_BAD_ARGUMENT, "a design cannot sample every %.6g s",
                             T);
    if (T > 0)
        return place_sampled(how, &wanted, T, K, robustness, message);
    return how == STANCE_SCHUR ? stance_place_schur(&wanted, K, message)
                               : stance_place_robust(&wanted, NULL, K, robustness, message);
}
