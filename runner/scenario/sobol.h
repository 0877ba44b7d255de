/* sobol.h - Sobol's sequence by its direction numbers.
 *
 * The direction numbers are the first 40 of the list new-joe-kuo-6 (S. Joe, F. Y. Kuo, Constructing
 * Sobol sequences with better two-dimensional projections, SIAM J. Sci. Comput. 30, 2635-2654,
 * 2008): among those that a primitive polynomial allows, chosen so that pairs of coordinates fill
 * the square evenly. With the older ones of Bratley and Fox some pairs of coordinates stay on
 * stripes for hundreds of points, which an index that is a mean over such a pair shows as an error
 * beyond that of independent points.
 */
#ifndef STANCE_SCENARIO_SOBOL_H
#define STANCE_SCENARIO_SOBOL_H

#include <stddef.h>
#include <stdint.h>

enum { SOBOL_DIMENSIONS = 40, SOBOL_BITS = 25 /* of a point's number */ };

/* Direction numbers of a coordinate, 0 ... SOBOL_DIMENSIONS - 1, as fractions of 2^`width`, at
 * least SOBOL_BITS and at most 64. Coordinate of point i: XOR of direction[b] over the bits b of
 * Gray's code of i (Antonov, Saleev 1979), or over those of i for the points in the order of
 * Sobol'. */
void sobol_directions(size_t dimension, int width, uint64_t direction[SOBOL_BITS]);

#endif
