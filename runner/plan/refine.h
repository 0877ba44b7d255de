/* refine.h - which cases of a map are simulated, and what the label of the others follows from.
 *
 * A map is looked at on a coarse lattice first, and then only where it is not all one. Lattice l of
 * an axis of n points are the multiples of its stride s(l), and the last point, n - 1; s(0) is the
 * smallest power of two with n / s(0) <= start, s(l + 1) is half of s(l), at least 1, and lattice
 * `levels` is the whole grid. The cells of level l are the closed boxes between neighbouring points
 * of lattice l. A set S of simulated points makes a cell
 *   mixed     when points of S in it have different labels, or failed;
 *   refined   when a mixed cell of its level is at most `margin` cells away (Chebyshev distance).
 * What is simulated is the smallest set S that holds lattice 0 and the probes, and, of each refined
 * cell of any level l, its points of lattice l + 1. More points never make fewer cells mixed: such
 * a set exists, is the only one, and is found whatever the order in which its points become known.
 * So nothing depends on ranks, interruptions, or how the work was cut.
 *
 * A cell that is not refined has one label, which all of its points take. Cells that meet agree,
 * since the smaller one's corners between them are simulated and in both. Nothing fails by
 * inference. The probes, each point with probability `probes`, by a pure function of (seed, place
 * on the grid, sample), find islands: one of k points that the lattice misses stays unseen with (1
 * - probes)^k.
 *
 * Axes that are not refined are taken in full: each combination of their points is a map of its
 * own.
 */
#ifndef STANCE_PLAN_REFINE_H
#define STANCE_PLAN_REFINE_H

#include "runner/scenario/scenario.h"

/* Labels: 0 is unknown, outcome + 1 of a case that is done, or failed. */
enum { REFINE_UNKNOWN = 0, REFINE_FAILED = STANCE_OUTCOME_COUNT + 1 };

/* A map, row-major over its axes. */
struct refine_map {
    int axes;
    size_t count[SCENARIO_MAX_AXES];
    bool refined[SCENARIO_MAX_AXES]; /* has more than `start` points */
    size_t start;                    /* at least 2 */
    size_t margin;                   /* cells */
    double probes;                   /* 0 ... 1 */
    uint64_t seed;
    size_t samples; /* points of the last axis where that is sweep.sample's, else 0 */
};

/* The map of a scenario that asks for refinement. */
struct refine_map refine_map_of(const struct scenario *scenario);
/* Points of lattice 0, which are simulated first, whatever they turn out to be. */
uint64_t refine_coarse(const struct refine_map *map);

struct refine;

/* NULL: not enough memory. At most SCENARIO_MOST_REFINED points. */
struct refine *refine_make(const struct refine_map *map);
void refine_free(struct refine *refine);

/* Has a row simulated in any case. */
void refine_want(struct refine *refine, uint64_t row);
/* Rows to simulate next, ascending, at most `room` of them; returns how many. Every row that was
 * returned must get its label before the next call. 0: the map is complete. */
size_t refine_next(struct refine *refine, uint64_t *rows, size_t room);
void refine_set(struct refine *refine, uint64_t row, int label);

/* After refine_next has returned 0: gives every other row its label. */
void refine_infer(struct refine *refine);
int refine_label(const struct refine *refine, uint64_t row);
bool refine_inferred(const struct refine *refine, uint64_t row);

#endif
