/* basin_threshold.h - where along a parameter a basin has lost some share of what it was.
 *
 * Along the parameter, from its first value to its last, the volume V is taken as linear between
 * neighbouring values, and the threshold is crossed where D = V - T V_first changes its sign first.
 * The interval holds all values at which D is not known to differ from zero (Fieller's way: E. C.
 * Fieller, J. R. Stat. Soc. B 16, 1954). D is linear in the volumes of at most three rows, whose
 * errors count as independent on a grid of starts; of a sample, all of whose points are in every
 * row, its error is that of the mean of D over the points, by Student's distribution. Between two
 * values nothing is known of how V runs: the interval is one of the crossing of the straight line,
 * `before` and `after` are the values between which it is.
 */
#ifndef STANCE_BASIN_BASIN_THRESHOLD_H
#define STANCE_BASIN_BASIN_THRESHOLD_H

#include "basin.h"

struct basin_threshold {
    double first, last; /* volumes */
    bool crossed;
    size_t before, after; /* points of the axis; after = before where it is not crossed */
    double at;            /* of the parameter; NAN: not crossed */
    double low, high;     /* in the order in which the parameter runs; NAN: beyond its last value */
};

/* Of the row `row`, whose point of by[along] is the first one, and of those that follow it along
 * this axis, whose values rise or fall. threshold > 0, not 1; below 1 the volume falls below it,
 * above 1 it rises above it. */
struct basin_threshold basin_threshold(const struct basin *basin, size_t row, int along,
                                       double threshold);

/* How starts are lost along an axis of parameters: those that have the outcome at the one end of
 * the axis where more have it. */
struct basin_loss {
    bool down;        /* from the axis's last point to its first */
    uint64_t starts;  /* that have it there */
    uint64_t *lost;   /* [count], in the order of the walk: first seen without it there */
    size_t at;        /* place in the walk where the first ones are lost; count: none are */
    uint64_t first;   /* flat index of one of them, as it is there */
    uint64_t unknown; /* starts that come to a failed or pending case before */
};
/* From the last point of the axis (down) or its first; lost[] is freed by the caller. False: no
 * memory. */
bool basin_lose(const struct results *r, int axis, bool down, enum results_kind of,
                struct basin_loss *loss);
/* Whether more cases have the outcome at the last point of the axis than at its first. */
bool basin_more_at_last(const struct results *r, int axis, enum results_kind of);

#endif
