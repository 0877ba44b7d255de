/* cma.h - evolution strategy with covariance matrix adaptation.
 *
 * Maximises a score of which nothing but the order of candidates is used. N. Hansen, The CMA
 * Evolution Strategy: A Tutorial, arXiv:1604.00772, with the parameters of its Table 1, negative
 * weights included. In generation g
 *
 *   x_i = m + step C^(1/2) z_i,  z_i normal deviates, i = 0 ... lambda - 1            (ask)
 *   m += step y,  y = sum of w_i y_i over the better half,  y_i = (x_i - m) / step    (tell)
 *   p_step = (1 - c_step) p_step + sqrt(c_step (2 - c_step) mu) C^(-1/2) y
 *   p      = (1 - c_p) p + h sqrt(c_p (2 - c_p) mu) y
 *   C      = (1 - c_1 - c_mu sum w_i) C + c_1 (p p' + (1 - h) c_p (2 - c_p) C)
 *            + c_mu sum of w_i y_i y_i'
 *   step  *= exp(c_step / d (|p_step| / E|z| - 1))
 *
 * with weights w_i by rank, those of the worse half negative and there with y_i of length sqrt(n)
 * in the metric of C, so that C stays positive definite; mu the effective number of the better
 * half; h 0 while p_step is long, else 1. C^(1/2) is the symmetric root: no sign or order of
 * eigenvectors matters. C is decomposed in every generation: for n up to 64 the tutorial's interval
 * is one.
 *
 * Coordinates are in units of their own: that a step below 1e-3 is small is all that is said of
 * their size. Those with bounds are searched as struct bounds says, and no standard deviation gets
 * above a third of its range; m and C are those of the search, x and cma_mean within bounds.
 *
 * The state is a function of what cma_make got and of the generations told, in their order: told
 * again, it is the same to the bit.
 */
#ifndef STANCE_OPTIMISE_CMA_H
#define STANCE_OPTIMISE_CMA_H

#include <stdbool.h>
#include <stdint.h>

enum {
    CMA_MAX_COORDINATES = 64,
    CMA_MAX_CANDIDATES = 65536, /* in a generation */
};

/* Why there is no use in going on. */
enum cma_stop {
    CMA_GOES_ON,
    CMA_SMALL,     /* in no coordinate is the step as large as 1e-3 */
    CMA_CONDITION, /* the condition number of C is above 1e14 */
    CMA_DIVERGED,  /* the longest axis is above 1e4 first steps */
    CMA_STOPS,
};

/* What is searched from where. */
struct cma_start {
    int n, lambda;                   /* coordinates, 1 ... CMA_MAX_COORDINATES; candidates in a
                                      * generation, 2 ... CMA_MAX_CANDIDATES, 0: the default */
    const double *mean, *low, *high; /* [n]: mean within bounds, low < high; -INFINITY, INFINITY:
                                      * none */
    double step;                     /* > 0: the first one, C being 1 where a third of the range is
                                      * not less */
    uint64_t seed, restart; /* from which, and generation, candidate, coordinate, random numbers
                             * follow */
};

struct cma {
    int n, lambda, better; /* better: candidates with a positive weight */
    uint64_t seed, restart;
    uint64_t generation; /* how many were told */
    double first_step, step;
    /* Table 1 of the tutorial. */
    double mu, c_step, damping, c_path, c_one, c_mu, weights, chi; /* weights: sum; chi: E|z| */
    struct ranked *rank;
    double *weight;           /* [lambda] */
    struct bounds *bounds;    /* [n] */
    double *centre;           /* [n]: of the normal distribution, without bounds */
    double *mean;             /* [n]: its image, of the next generation */
    double *path, *path_step; /* [n] */
    double *axis;             /* [n]: square roots of C's eigenvalues, ascending: times step,
                               * standard deviations along the axes */
    double *covariance, *root, *back; /* [n][n]: C, C^(1/2), C^(-1/2) */
    double *vector, *work;            /* [n][n] */
    double *y;                        /* [lambda][n] */
    double memory[];
};

/* 4 + floor(3 ln n). */
int cma_default_lambda(int n);

/* NULL: out of memory, or something of the start is not as it says or beyond 1e100. */
struct cma *cma_make(const struct cma_start *start);
void cma_free(struct cma *cma);

/* The candidates of this generation, x[lambda][n], within bounds. */
void cma_ask(const struct cma *cma, double *x);

/* Ends the generation. x[lambda][n]: the candidates that were judged, as asked or others in their
 * place (a given design); score[lambda]: the larger the better, of equal ones the first. False, and
 * nothing has changed: one of x is not finite, out of bounds, or farther than 1e100 steps away. */
bool cma_tell(struct cma *cma, const double *x, const int64_t *score);

enum cma_stop cma_stop(const struct cma *cma);
/* Of each reason a few words; of CMA_GOES_ON "". */
extern const char *const cma_stop_words[CMA_STOPS];

/* ---- what it is made of ---------------------------------------------------------------------- */

/* A range as the image of all real numbers.
 *
 * Where the best lies on a bound, a normal distribution that is cut or clipped there is repelled
 * from it and loses its width before the other coordinates have arrived. So the search goes on in u
 * without bounds, and x(u) is within them (as pycma does, N. Hansen). More than a margin from the
 * bounds x is u; nearer it is a parabola with its vertex on the bound
 *
 *   x = low + (u - low + margin)^2 / (4 margin),    low - margin <= u <= low + margin
 *
 * and beyond the vertex, where u is low - margin or high + margin, the same mirrored, and so on.
 * The slope of x(u) is continuous: what grows towards a bound has a smooth optimum in u.
 *
 * low < high; -INFINITY, INFINITY: none. margin: above 0, at most half of high - low. Finite ones
 * up to 1e100. */
struct bounds {
    double low, high, margin;
};

/* x(u), low ... high. u finite. */
double bounds_image(const struct bounds *b, double u);
/* A number whose image is x, low ... high: `beside` if it is one, otherwise on the same side of all
 * vertices. */
double bounds_preimage(const struct bounds *b, double x, double beside);

/* Eigenvalues and eigenvectors of a small symmetric matrix.
 *
 * Jacobi's method, cyclic by rows (Golub, Van Loan, Matrix Computations, 8.5): rotations in a fixed
 * order, each makes one element off the diagonal zero, until all of them are negligible beside
 * their diagonal elements. So small eigenvalues of a positive definite matrix that is badly scaled
 * are accurate, too (Demmel, Veselic, SIAM J. Matrix Anal. Appl. 13, 1992). No library, no sum
 * whose order a compiler chooses: the same bits everywhere.
 *
 * a[n][n], symmetric and finite, is overwritten. Row k of vector[n][n] is the eigenvector of length
 * 1 that belongs to value[k]; ascending. Signs follow no rule. n >= 1; n = 64 takes some
 * ms. */
void symmetric_eigen(int n, double *a, double *value, double *vector);

#endif
