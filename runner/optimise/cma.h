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
 * their size. Those with bounds are searched as bounds.h says, and no standard deviation gets above
 * a third of its range; m and C are those of the search, x and cma_mean within bounds.
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

struct cma;

/* 4 + floor(3 ln n). */
int cma_default_lambda(int n);

/* n: 1 ... CMA_MAX_COORDINATES. lambda: candidates in a generation, 2 ... CMA_MAX_CANDIDATES; 0:
 * the default. mean[n], within bounds. step > 0: the first one, C being 1 where a third of the
 * range is not less. low[n] < high[n]: bounds, -INFINITY and INFINITY: none. The random numbers
 * follow from seed and restart (and from generation, candidate, coordinate). NULL: out of memory,
 * or something of that is not so or beyond 1e100. */
struct cma *cma_make(int n, int lambda, const double *mean, double step, const double *low,
                     const double *high, uint64_t seed, uint64_t restart);
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

int cma_lambda(const struct cma *cma);
/* Generations told. */
uint64_t cma_generation(const struct cma *cma);
/* The distribution of the next generation: mean[n], step, C[n][n], and the square roots of C's
 * eigenvalues, [n], ascending: times step, standard deviations along the axes. */
const double *cma_mean(const struct cma *cma);
double cma_step(const struct cma *cma);
const double *cma_covariance(const struct cma *cma);
const double *cma_axes(const struct cma *cma);

#endif
