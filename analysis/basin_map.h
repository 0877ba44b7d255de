/* basin_map.h - a map of outcomes over starts, and what it says of the basins' boundary.
 *
 * The map is a lattice: one axis per varied coordinate of the start, its places rising, the cases
 * row-major over the axes. Nothing here knows of files. Cases that failed or are pending are
 * unknown: they never count as a colour of their own.
 *
 * Volume. The box between the first and the last places is cut into cells with a case at each
 * corner. If the boundary is resolved, i.e. no cell whose corners agree is crossed by it, then a
 * cell is inside, outside or crossed, and the basin's volume lies between that of the cells inside
 * and that of the cells not outside: a bound, not an interval of confidence. The estimate gives a
 * crossed cell the share of its corners that are inside, which is the trapezoidal rule.
 *
 * Its likely error is the larger of two, neither beyond the bound:
 *
 * Patches. A line of the lattice that crosses the boundary steeply meets it somewhere between two
 * places, evenly distributed, so the volume of its cell is off by an evenly distributed part of the
 * cell, variance 1/12. Cells next to each other along an axis along which their corners do not
 * differ have the same piece of boundary in them: they are a patch, and their errors add up. A row
 * of n cells of a patch has n^2 / 12, unless the boundary leaves it upwards at one end and
 * downwards at the other: then it has swept over the cells' whole height, and what is left are the
 * cells at the ends (in space, where the ends of neighbouring rows may all be alike, one cell's
 * error a row, rows adding up). Patches are independent. Exact for the two ends of an interval.
 *
 * Rhythm. A boundary of slope p / q in cells meets the lattice at the same q heights over and over,
 * and the errors do not cancel: h L / q evenly distributed over its length L. Of the s^d
 * sublattices of every s-th place along each of d axes that error scatters with the variance (s^2 -
 * 1) / 12 times (h L / q)^2: their scatter / (s^2 - 1) is the variance. For boundaries without a
 * rhythm, whose variance grows as h^(d + 1), that is (s^(d + 1) - 1) / (s^2 - 1) times too much.
 * The larger of s = 2 and 3.
 *
 * So the error is conservative: intervals of 95 % hold in 95 to 100 % of cases for boundaries along
 * an axis, at slopes of any kind, curved and in space (tests/test_basin.c measures it). What they
 * may miss are two parallel boundaries in a common rhythm whose sublattices' errors cancel (91 %).
 *
 * Entropy: A. Daza, A. Wagemakers, B. Georgeot, D. Guery-Odelin, M. A. F. Sanjuan, Basin entropy: a
 * new tool to analyze uncertainty in dynamical systems, Sci. Rep. 6, 31416 (2016).
 *
 * Uncertainty exponent: C. Grebogi, S. W. McDonald, E. Ott, J. A. Yorke, Final state sensitivity,
 * Phys. Lett. A 99 (1983); S. W. McDonald et al., Fractal basin boundaries, Physica D 17 (1985).
 */
#ifndef STANCE_ANALYSIS_BASIN_MAP_H
#define STANCE_ANALYSIS_BASIN_MAP_H

#include "results.h"

struct basin_map {
    int axes; /* 1 ... SCENARIO_MAX_AXES, each with two places at least */
    size_t count[SCENARIO_MAX_AXES];
    const double *place[SCENARIO_MAX_AXES]; /* [count], rising */
    uint64_t cases;                         /* product of the counts */
    const uint8_t *kind;                    /* [cases] enum results_kind */
};

/* Volumes are in the product of the axes' units. */
struct basin_volume {
    double box;
    double estimate;         /* NAN: no case is done */
    double low, high;        /* bound: unknown cases all outside, all inside */
    double variance;         /* of the estimate, as above; may exceed the bound */
    uint64_t cells, crossed; /* crossed: by the boundary, or with an unknown corner */
};
/* False: no memory. */
bool basin_map_volume(const struct basin_map *map, enum results_kind of,
                      struct basin_volume *volume);
/* So many standard deviations of the estimate, not beyond the bound. */
double basin_volume_reach(const struct basin_volume *volume, double deviations);

/* Sums over boxes of side^axes cases that tile the map from its first corner; what is left over at
 * the other end is left out, as are boxes of which nothing is known. */
struct basin_entropy {
    uint64_t boxes, mixed; /* mixed: of more than one outcome */
    double sum;            /* of the Gibbs entropies of the boxes, natural logarithms */
};
/* Adds to *entropy. side >= 2. */
void basin_map_entropy(const struct basin_map *map, size_t side, struct basin_entropy *entropy);
/* S_b and S_bb; NAN where there are no (mixed) boxes. */
double basin_entropy(const struct basin_entropy *entropy);
double basin_boundary_entropy(const struct basin_entropy *entropy);

/* How many cases are uncertain: at distances 1, 2, 4 ... of cells, some neighbour along an axis has
 * another outcome. Counted among cases so far inside that all these neighbours exist. */
enum { BASIN_SCALES = 20, BASIN_LEAST_SCALES = 3 }; /* 48 places for three */
struct basin_uncertainty {
    int scales; /* 0: the map is too small */
    uint64_t counted[BASIN_SCALES], uncertain[BASIN_SCALES];
};
/* Number of distances that a map allows: up to a twelfth of its shortest axis. */
int basin_map_scales(const struct basin_map *map);
/* Adds to *uncertainty, whose `scales` are set. */
void basin_map_uncertainty(const struct basin_map *map, struct basin_uncertainty *uncertainty);

/* f(distance) ~ distance^alpha by weighted least squares of logarithms, weights from binomial
 * variances; the standard error is widened where the points scatter more than these say. NAN with
 * fewer than BASIN_LEAST_SCALES distances at which some but not all cases are uncertain. */
struct basin_exponent {
    double alpha, error;
};
struct basin_exponent basin_exponent(const struct basin_uncertainty *uncertainty);

/* ---- the boundary ------------------------------------------------------------------------- */

/* Neighbours along `axis` with different outcomes: case `index`, at point[axes], and the next. */
struct basin_crossing {
    uint64_t index;
    size_t point[SCENARIO_MAX_AXES];
    int axis;
    double middle, half_width; /* along the axis */
    enum results_kind from, to;
};
/* Calls visit for each until it returns false, which is passed on. */
bool basin_map_boundary(const struct basin_map *map,
                        bool (*visit)(void *context, const struct basin_crossing *crossing),
                        void *context);

/* Distance of the boundary of one outcome from the case at `origin` (a point of the map). */
struct basin_distance {
    bool inside; /* the case at the origin has that outcome */
    /* On the line along each axis through the origin: where the outcome ends, downwards and upwards
     * in value; NAN: it reaches the end of the axis, or an unknown case. */
    double low[SCENARIO_MAX_AXES], high[SCENARIO_MAX_AXES];
    /* The nearest crossing out of the outcome, in units of the axes' ranges, from zero. */
    double nearest; /* NAN: none */
    double at[SCENARIO_MAX_AXES];
};
void basin_map_distance(const struct basin_map *map, enum results_kind of, const size_t *origin,
                        struct basin_distance *distance);

#endif
