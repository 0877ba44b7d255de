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
#ifndef STANCE_BASIN_BASIN_MAP_H
#define STANCE_BASIN_BASIN_MAP_H

#include "runner/store/results.h"

struct basin_map {
    int axes; /* 1 ... SCENARIO_MAX_AXES, each with two places at least */
    size_t count[SCENARIO_MAX_AXES];
    const double *place[SCENARIO_MAX_AXES]; /* [count], rising */
    uint64_t cases;                         /* product of the counts */
    const uint8_t *kind;                    /* [cases] enum results_kind */
};

static inline bool basin_is_known(uint8_t kind)
{
    return kind != RESULTS_PENDING && kind != RESULTS_FAILED && kind != RESULTS_DONE;
}
/* Moves to the next point of a lattice of these counts; false after the last. */
bool basin_next_point(int axes, const size_t *count, size_t *point);
/* Numbers below a count, each taken once and put behind a queue: {0} but for `seen`, zero, with a
 * bit for each. */
struct basin_flood {
    uint8_t *seen;
    uint64_t *queue, queued, room;
};
static inline bool basin_has_taken(const struct basin_flood *flood, uint64_t number)
{
    return flood->seen[number / 8] >> number % 8 & 1;
}
/* False: no memory. */
bool basin_take(struct basin_flood *flood, uint64_t number);
void basin_flood_free(struct basin_flood *flood);
void basin_strides(const struct basin_map *map, uint64_t stride[SCENARIO_MAX_AXES]);
uint64_t basin_index(const struct basin_map *map, const uint64_t *stride, const size_t *point);

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
/* How many standard deviations hold that share of errors: of normal ones, which are sums of many
 * patches' errors, or of evenly distributed ones, which a single patch has (below 88 % these take
 * more). */
double basin_map_deviations(double level);
/* So many standard deviations of the estimate, not beyond the bound. */
double basin_volume_reach(const struct basin_volume *volume, double deviations);

/* Parts of a map, to see how much they differ. */
enum { BASIN_TILES = 16 };

/* Sums over boxes of side^axes cases that tile the map from its first corner; what is left over at
 * the other end is left out, as are boxes of which nothing is known. */
struct basin_entropy {
    uint64_t boxes, mixed; /* mixed: of more than one outcome */
    double sum;            /* of the Gibbs entropies of the boxes, natural logarithms */
    uint64_t tile_mixed[BASIN_TILES];
    double tile_sum[BASIN_TILES];
};
/* Adds to *entropy. side >= 2. */
void basin_map_entropy(const struct basin_map *map, size_t side, struct basin_entropy *entropy);
/* S_b and S_bb; NAN where there are no (mixed) boxes. */
double basin_entropy(const struct basin_entropy *entropy);
double basin_boundary_entropy(const struct basin_entropy *entropy);

/* How many cases are uncertain: at distances 1, 2, 4 ... of cells, some neighbour along an axis has
 * another outcome. Counted among cases so far inside that all these neighbours exist. */
enum { BASIN_SCALES = 20, BASIN_LEAST_SCALES = 4 }; /* 96 places for four */
struct basin_uncertainty {
    int scales; /* 0: the map is too small */
    uint64_t counted[BASIN_SCALES], uncertain[BASIN_SCALES];
    uint64_t tile[BASIN_SCALES][BASIN_TILES]; /* of the uncertain ones */
};
/* Number of distances that a map allows: up to a twelfth of its shortest axis. */
int basin_map_scales(const struct basin_map *map);
/* Adds to *uncertainty, whose `scales` are set. */
void basin_map_uncertainty(const struct basin_map *map, struct basin_uncertainty *uncertainty);

/* The share f of uncertain cases grows with the distance e as e^alpha where e is well below what
 * the domains are wide: there log f is straight over log e, and its slope by least squares is
 * alpha. At longer distances it bends: the longest ones are left out until no two neighbouring
 * distances have slopes that differ by more than BASIN_BEND and fewer than half of the cases are
 * uncertain, and with fewer than BASIN_LEAST_SCALES left there is no alpha.
 *
 * A fractal's slope drifts, as it comes near its limit slowly and in waves, and cases count at
 * every distance anew: binomial errors say nothing of either. The standard error is put together
 * from
 *   - the jackknife over the map's tiles, which depend on each other at their borders alone;
 *   - the scatter of the points about the line;
 *   - twice the difference of the slopes of the shorter and the longer half of the distances: what
 *     the slope may still change by on the way to zero;
 *   - a part of 1 - alpha, for what a wave longer than the distances hides.
 * tests/test_exponent.c: within two standard errors in 99.8 % of 1,820 maps of eighteen
 * fractals of known dimension and in all smooth ones. What it cannot see is roughness that the map
 * has not: Takagi's graph of dimension 1.26 looks like 1.06 on 512 x 512 cases. */
#define BASIN_BEND 0.1
#define BASIN_DRIFT 0.12
#define BASIN_WAVE 0.1
enum basin_refusal {
    BASIN_FITTED,
    BASIN_SMALL, /* too few places along an axis */
    BASIN_NONE,  /* no boundary where all neighbours exist */
    BASIN_WIDE,  /* half of the cases and more are uncertain */
    BASIN_BENT,
    BASIN_FEW, /* all of the boundary is in one tile */
    BASIN_REFUSALS,
};
extern const char *const basin_refusal_words[BASIN_REFUSALS];
struct basin_exponent {
    double alpha, error; /* NAN but with BASIN_FITTED */
    int scales;          /* that it rests on */
    enum basin_refusal refusal;
};
struct basin_exponent basin_exponent(const struct basin_uncertainty *uncertainty);
/* In a line, for people. */
const char *basin_refusal_text(enum basin_refusal refusal);

/* S_bb above log 2 implies a fractal boundary where boxes are small beside the domains; stripes
 * thinner than a box exceed it, smooth as they are. Fractal: S_bb is above log 2 by more than its
 * interval, and alpha below 1 by more than its own, both at 95 %. */
bool basin_is_fractal(const struct basin_entropy *entropy,
                      const struct basin_uncertainty *uncertainty);

/* ---- the boundary ------------------------------------------------------------------------- */

/* Neighbours along `axis` with different outcomes: case `index`, at point[axes], and the next. */
struct basin_crossing {
    uint64_t index;
    size_t point[SCENARIO_MAX_AXES];
    int axis;                  /* -1: the search begins */
    double middle, half_width; /* along the axis */
    enum results_kind from, to;
};
/* Goes on to the next one; false: there is none. */
bool basin_next_crossing(const struct basin_map *map, struct basin_crossing *crossing);

/* ---- the domain of the equilibrium -------------------------------------------------------- */

/* Faces of the map: bit 2 a of the lower end of axis a, bit 2 a + 1 of its upper end (faces.h). */

/* The part of an outcome that hangs together with the case at `origin` (a point of the map), from
 * neighbour to neighbour along the axes. Unlike the outcome's share of the box it does not change
 * with the box, once it lies within it: neither on a face nor beside an unknown case. */
struct basin_part {
    bool inside; /* the case at the origin has the outcome; else the part is empty */
    struct basin_volume volume;
    uint64_t faces;
    bool unknown; /* a neighbour is not known */
};
/* False: no memory. */
bool basin_map_part(const struct basin_map *map, enum results_kind of, const size_t *origin,
                    struct basin_part *part);

/* Distance of the boundary of one outcome from the equilibrium, which is at zero, nearest to the
 * case at `origin` and within the box. Each offset is measured in units of weight[axis] > 0, the
 * disturbance that weighs as much as one weight of another axis, so that distances do not depend on
 * the box either. What is beyond a face of the box, or beyond an unknown case, is not known. */
enum { BASIN_DIRECTIONS = 1024 };
struct basin_distance {
    bool inside; /* the case at the origin has that outcome */
    /* On the line along each axis through the origin, in units of the axis: where the outcome ends,
     * downwards and upwards in value; NAN: it reaches the end of the axis, or an unknown case. */
    double low[SCENARIO_MAX_AXES], high[SCENARIO_MAX_AXES];
    double nearest; /* crossing out of the outcome in the map; NAN: none */
    double at[SCENARIO_MAX_AXES];
    double clear; /* the nearest face or unknown case: the true distance is at least the smaller */
    /* Where rays that set out evenly in all directions first lose the outcome, midway between two
     * cases. `leave` of them reach a face or an unknown case before: in the median they are longer
     * than all others (NAN: it is one of them), in the least one as long as they could be
     * followed. */
    size_t directions, leave;
    double median, median_least;
};
/* False: no memory. */
bool basin_map_distance(const struct basin_map *map, enum results_kind of, const size_t *origin,
                        const double *weight, struct basin_distance *distance);

#endif
