/* sampling.h - experimental designs: points of the unit cube.
 *
 * What each point is follows from (seed, point) alone, so that every process, every resumed run and
 * every later analysis has the same points without keeping them. It does not depend on `count`
 * either, so that a design can be extended; but for lhs, whose strata are made for their number.
 *
 *   random    independent, uniform: Philox keyed by the seed.
 *   lhs       Latin hypercube: each of `count` equal strata of each factor holds one point, at a
 *             random place (McKay, Beckman, Conover, Technometrics 21, 1979).
 *   sobol     Sobol's sequence (sobol.h), scrambled: each coordinate's bits, the leading one first,
 *             are multiplied by a random lower triangular matrix of its own with ones on the
 *             diagonal and XORed with a random number (Matousek, J. Complexity 14, 1998). Every
 *             point is then uniform, so that a mean over the points has no bias and its error can
 *             be had from independent scrambles; of every 2^m points from a multiple of 2^m on the
 *             net that they form stays one. The all-zero point is kept: without it there is none.
 *   saltelli  blocks for Sobol' indices (Saltelli et al., Comput. Phys. Commun. 181, 2010): A and B
 *             are the halves of a Sobol' point of twice the factors; in AB_j factor j comes from
 *             the other one. Order in a block: A, AB_1 ... AB_k, with second_order
 *             BA_1 ... BA_k, B. Blocks are dealt to SAMPLING_REPLICATES sequences, each scrambled
 *             independently of the others: block i is number i / SAMPLING_REPLICATES of sequence
 *             i mod SAMPLING_REPLICATES. How far these disagree is what is known of the error.
 *   morris    trajectories of Morris, Technometrics 33, 1991: from a random point of a lattice of
 *             `levels` levels each factor in turn, in random order and direction, changes by
 *             levels / (2 (levels - 1)).
 *   sphere    directions of a scrambled Sobol' sequence, uniform on the sphere inscribed in the
 *             cube: an angle for 2 factors, otherwise normal deviates over their norm.
 */
#ifndef STANCE_RUNNER_SAMPLING_H
#define STANCE_RUNNER_SAMPLING_H

#include "sobol.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum sampling_method {
    SAMPLING_RANDOM,
    SAMPLING_LHS,
    SAMPLING_SOBOL,
    SAMPLING_SALTELLI,
    SAMPLING_MORRIS,
    SAMPLING_SPHERE,
    SAMPLING_METHODS,
};

enum {
    SAMPLING_MAX_FACTORS = SOBOL_DIMENSIONS,
    SAMPLING_MAX_BITS = SOBOL_BITS, /* of the number of blocks */
    SAMPLING_REPLICATES = 16,       /* scrambled sequences of saltelli */
};

/* `count`: points; saltelli: base points; morris: trajectories. 1 ... 2^SAMPLING_MAX_BITS.
 * `factors`: 1 ... sampling_most_factors. `levels` (morris): even, at least 2. */
struct sampling {
    enum sampling_method method;
    uint64_t count;
    size_t factors;
    int levels;
    bool second_order; /* saltelli */
    uint64_t seed;
    /* Made by sampling_begin. */
    uint64_t *direction; /* Sobol' sequences: [sequences][SAMPLING_MAX_BITS][dimensions] */
    uint64_t *shift;     /* ... [sequences][dimensions], of 53 bits */
    uint32_t *stratum;   /* lhs: [factors][count] */
};

/* The methods' names in the order of the enumeration. */
extern const char *const sampling_words[SAMPLING_METHODS];

/* 40; saltelli: 20. */
size_t sampling_most_factors(enum sampling_method method);
/* Name of what makes the points, where it has changed since there are results files: those without
 * a name have other points, and so have those of any other name. "": it has not. */
const char *sampling_generator(enum sampling_method method);
/* Points in a block: 1; saltelli: factors + 2, with second_order 2 factors + 2; morris:
 * factors + 1. Needs no tables, as the next. */
uint64_t sampling_block(const struct sampling *sampling);
/* count * block. */
uint64_t sampling_points(const struct sampling *sampling);

/* Makes the tables; to be freed by sampling_end, whatever it returns. False: out of memory. */
bool sampling_begin(struct sampling *sampling);
void sampling_end(struct sampling *sampling);

/* Point `point` < sampling_points as u[factors], in [0, 1); morris and sphere: in [0, 1]. */
void sampling_unit(const struct sampling *sampling, uint64_t point, double *u);

#endif
