/* sensitivity.h - which factors of a sampled study its response depends on, with intervals.
 *
 * Everything here is a function of plain arrays: a response y for each point of a design whose
 * points come in blocks (runner/scenario/doe.h). Factors are independent and uniform on the unit
 * cube.
 *
 * Saltelli blocks A, AB_1 ... AB_k, [BA_1 ... BA_k,] B: Sobol' indices. f(AB_j) shares all factors
 * but j with f(A), and j alone with f(B). With every column standardised, the least squares
 *     f(AB_j) = a f(A) + b f(B) + rest
 * give the first-order index S_j = b and the total index T_j = 1 - a; with BA_j, where A and B
 * change places, the mean of both. Without the term that they share by chance these are the
 * correlations of J.-M. Martinez (2011); to take it out is Glen's and Isaacs' idea (Environ. Model.
 * Softw. 37, 2012). On Ishigami's, Sobol's g- and another function (tests/test_sensitivity.c) their
 * errors are 13 to 32 % smaller than those of Saltelli's first-order and Jansen's total estimators
 * with the mean taken off (Comput. Phys. Commun. 181, 2010) where blocks are independent, and about
 * the same for blocks of a Sobol' sequence. The second-order index of i and j is what the
 * correlation of f(AB_i) and f(BA_j), which share just i and j, has beyond S_i and S_j, with the
 * same correction by chance.
 *
 * Morris trajectories: the elementary effect of a factor is the change of the response over the
 * change of the factor in the step that changes it alone, in units of the response per length of
 * the cube. mu is their mean, mu_star that of their magnitudes (Campolongo, Cariboni, Saltelli,
 * Environ. Model. Softw. 22, 2007), sigma their standard deviation.
 *
 * Any other points: first-order indices from given data (Plischke, Borgonovo, Smith, Eur. J. Oper.
 * Res. 226, 2013). Points are put into bins of four along a factor, points with equal values always
 * into the same; the index is the share of the variance between the bins, less what chance alone
 * would give: 1 - (within / (n - bins)) / (all / (n - 1)) of sums of squares (Kelley's epsilon
 * squared). Bins must be small: what the response changes within one counts as noise, at a step or
 * over a wave, and the index would be too low by more than its interval. Points of a Sobol'
 * sequence fill small bins in a pattern, so that chance adds anything from nothing to twice as
 * much. There bins are of sqrt(n) points, nothing is taken off, and the interval reaches down by
 * twice of what chance would add: conservative, but blind to waves of less than three bins. Points
 * of random and lhs say more of steps and waves.
 *
 * Intervals. Of Sobol' indices they rest on what the independently scrambled sequences of the
 * design say (runner/scenario/doe.h): each is left out in turn (Tukey's jackknife of groups), and
 * the scatter of the estimates from the others gives Student's interval about the estimate from
 * all. Blocks of one sequence depend on each other, for good or ill, so a bootstrap that draws them
 * as if they did not is too wide for one response and too narrow for another; sequences do not.
 * Trajectories, which are independent, are dealt to as many groups. Of given data quarters of the
 * points are drawn without replacement and put into bins of their own (Politis, Romano, Ann. Stat.
 * 22, 1994), so that where the ends of bins lie is drawn, too; with n of N points the variance is
 * theirs times n / (N - n). Of Sobol' points the upper end takes in what bins of four times as many
 * points would add. The draws are a function of the seed. How often all these hold:
 * tests/test_sensitivity.c.
 */
#ifndef STANCE_SENSITIVITY_SENSITIVITY_H
#define STANCE_SENSITIVITY_SENSITIVITY_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* An estimate and its interval; NAN where it cannot be had. */
struct sensitivity_value {
    double estimate, low, high;
};

/* What is known of each factor. */
#define SENSITIVITY_MEASURES(X)                                                                    \
    X(FIRST, "first") /* share of the variance that the factor alone accounts for */               \
    X(TOTAL, "total") /* ... that vanishes when all others are known */                            \
    X(MU, "mu")                                                                                    \
    X(MU_STAR, "mu_star")                                                                          \
    X(SIGMA, "sigma")

enum sensitivity_measure {
#define SENSITIVITY_MEASURE(NAME, text) SENSITIVITY_##NAME,
    SENSITIVITY_MEASURES(SENSITIVITY_MEASURE)
#undef SENSITIVITY_MEASURE
        SENSITIVITY_MEASURE_COUNT,
};

extern const char *const sensitivity_words[SENSITIVITY_MEASURE_COUNT];

struct sensitivity_bootstrap {
    size_t resamples; /* of given data, at least 2 */
    double level;     /* of the intervals, in (0, 1) */
    uint64_t seed;
};
/* Unless told otherwise. */
#define SENSITIVITY_BOOTSTRAP                                                                      \
    (struct sensitivity_bootstrap)                                                                 \
    {                                                                                              \
        1000, 0.95, 0                                                                              \
    }

struct sensitivity {
    size_t factors;
    size_t blocks;          /* that the estimates rest on; Morris: with any effect */
    double mean, deviation; /* of the responses of these */
    struct sensitivity_value *measure[SENSITIVITY_MEASURE_COUNT]; /* [factors], or NULL */
    struct sensitivity_value *second;   /* [factors][factors], upper triangle, or NULL */
    struct sensitivity_value first_sum; /* of first-order indices; NAN for Morris */
    struct sensitivity_value *all;      /* memory of the above */
};

/* Each takes y with NAN where a response is missing. False: no memory; nothing is left then. To be
 * released with sensitivity_free. With fewer than two blocks left all is NAN. */

/* y[blocks][factors + 2], second_order: [blocks][2 factors + 2], as runner/scenario/doe.h deals
 * them to sequences; a missing response takes its block out. `level` of the intervals. */
bool sensitivity_sobol(struct sensitivity *s, const double *y, size_t blocks, size_t factors,
                       bool second_order, double level);
/* y[blocks][factors + 1], u[blocks][factors + 1][factors]: the points; a missing response takes the
 * effects out that need it. */
bool sensitivity_morris(struct sensitivity *s, const double *y, const double *u, size_t blocks,
                        size_t factors, double level);
/* y[points], u[points][factors]: any numbers in the order of the factor's values, equal ones for
 * equal values; even: the points are a Sobol' sequence. */
bool sensitivity_given(struct sensitivity *s, const double *y, const double *u, size_t points,
                       size_t factors, bool even, const struct sensitivity_bootstrap *bootstrap);
void sensitivity_free(struct sensitivity *s);

/* How much a factor matters: its total index, mu_star or first-order index; NAN without. */
double sensitivity_weight(const struct sensitivity *s, size_t factor);

#endif
