/* doe.h - experimental designs: points of the unit cube.
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
 *             BA_1 ... BA_k, B. Blocks are dealt to DOE_REPLICATES sequences, each scrambled
 *             independently of the others: block i is number i / DOE_REPLICATES of sequence
 *             i mod DOE_REPLICATES. How far these disagree is what is known of the error.
 *   morris    trajectories of Morris, Technometrics 33, 1991: from a random point of a lattice of
 *             `levels` levels each factor in turn, in random order and direction, changes by
 *             levels / (2 (levels - 1)).
 *   sphere    directions of a scrambled Sobol' sequence, uniform on the sphere inscribed in the
 *             cube: an angle for 2 factors, otherwise normal deviates over their norm.
 */
#ifndef STANCE_SCENARIO_DOE_H
#define STANCE_SCENARIO_DOE_H

#include "sobol.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum doe_method {
    DOE_RANDOM,
    DOE_LHS,
    DOE_SOBOL,
    DOE_SALTELLI,
    DOE_MORRIS,
    DOE_SPHERE,
    DOE_METHODS,
};

enum {
    DOE_MAX_FACTORS = SOBOL_DIMENSIONS,
    DOE_MAX_BITS = SOBOL_BITS, /* of the number of blocks */
    DOE_REPLICATES = 16,       /* scrambled sequences of saltelli */
};

/* `count`: points; saltelli: base points; morris: trajectories. 1 ... 2^DOE_MAX_BITS.
 * `factors`: 1 ... doe_most_factors. `levels` (morris): even, at least 2. */
struct doe {
    enum doe_method method;
    uint64_t count;
    size_t factors;
    int levels;
    bool second_order; /* saltelli */
    uint64_t seed;
    /* Made by doe_begin. */
    uint64_t *direction; /* Sobol' sequences: [sequences][DOE_MAX_BITS][dimensions] */
    uint64_t *shift;     /* ... [sequences][dimensions], of 53 bits */
    uint32_t *stratum;   /* lhs: [factors][count] */
};

/* The methods' names in the order of the enumeration. */
extern const char *const doe_words[DOE_METHODS];

/* 40; saltelli: 20. */
size_t doe_most_factors(enum doe_method method);
/* Name of what makes the points, where it has changed since there are results files: those without
 * a name have other points, and so have those of any other name. "": it has not. */
const char *doe_generator(enum doe_method method);
/* Points in a block: 1; saltelli: factors + 2, with second_order 2 factors + 2; morris:
 * factors + 1. Needs no tables, as the next. */
uint64_t doe_block(const struct doe *doe);
/* count * block. */
uint64_t doe_points(const struct doe *doe);

/* Makes the tables; to be freed by doe_end, whatever it returns. False: out of memory. */
bool doe_begin(struct doe *doe);
void doe_end(struct doe *doe);

/* Point `point` < doe_points as u[factors], in [0, 1); morris and sphere: in [0, 1]. */
void doe_unit(const struct doe *doe, uint64_t point, double *u);

#endif
