/* basin_ranges.h - which ranges of starts show a domain, found before there is a map of it.
 *
 * Rays leave the equilibrium along the axes and in directions drawn evenly (the sample's sphere).
 * Along each the distance grows until the outcome is lost, then the bracket is halved; islands
 * beyond do not count. A domain is often a thin slanted band, whose tips hardly any direction
 * meets: so directions are even in the space in which the ends of the last round are a sphere, x =
 * L u with L L' the covariance of these ends, times the dimension; and from the ellipsoid of that
 * covariance the 2 n points that reach furthest along the axes are aimed at, too.
 *
 * Where the scenario sweeps no starts, the coordinate along whose angle or rate the outcome is lost
 * first, in units of the window of settling, gives the axes.
 */
#ifndef STANCE_BASIN_BASIN_RANGES_H
#define STANCE_BASIN_BASIN_RANGES_H

#include "basin_descend.h"
#include "basin_starts.h"

#include "runner/base/progress.h"

/* How far from the equilibrium is looked: angles rad, places m, rates rad/s or m/s. */
#define RANGES_ANGLE 3.141592653589793
#define RANGES_PLACE 10.0
#define RANGES_RATE 100.0

enum {
    RANGES_PARAMETERS = 3, /* most points of the other axes, evenly spread */
    RANGES_STARTS = 256,   /* of the ranges, to tell the share */
};

enum { RANGES_OPEN = STARTS_IMPOSSIBLE + 1 }; /* an end beyond how far is looked */

/* Of x, with so many points; 0: of a sample. */
struct ranges_range {
    double from, to;
    size_t points;
};

/* An axis; x is measured from the equilibrium, in the unit of its first field. */
struct ranges_axis {
    int first, fields;
    char unit[24];
    double window, limit; /* of settling; how far is looked */
    double possible[2];   /* how far there are starts along this axis alone, down and up */
    size_t count;         /* of its points in the scenario; 0: it has none */
    bool sampled;
    double alone[2];   /* where the outcome is lost along this axis alone, down and up ... */
    uint8_t beyond[2]; /* ... and what becomes of starts beyond, or RANGES_OPEN */
    double reach[2];   /* ... and along any ray, least and greatest x */
    bool open[2];      /* it is not lost there before the limit */
    struct ranges_range whole; /* holds all that rays have reached */
    struct ranges_range close; /* twice as far as along this axis alone: of a thin slanted domain
                                * this shows the width */
};

struct ranges {
    const struct scenario *s;
    uint8_t of; /* outcome */
    int axes, fields;
    int looked; /* axes that were looked along alone: those that were not chosen come behind */
    struct ranges_axis axis[STARTS_MOST];
    struct starts_field field[STARTS_MOST];
    bool chosen;             /* the scenario has no axes of starts */
    bool symmetric;          /* ranges of directions: the equilibrium is their middle */
    size_t parameters, held; /* points of the other axes, and at how many the equilibrium holds */
    size_t rays, open;       /* and those that are not lost */
    uint64_t simulated, failed, impossible; /* the last of the starts that tell the share */
    double share[2]; /* of the proposed ranges that has the outcome, least and most */
    struct progress progress;
};

/* False: there is no equilibrium, it has another outcome itself, nothing beside it has the outcome,
 * or there is no memory; `message` says which. */
bool ranges_make(struct ranges *ranges, const struct scenario *s, uint8_t of,
                 stance_message *message);

/* Whether the domain, along each axis alone, spans at least RANGES_CELLS cells of the whole range.
 */
enum { RANGES_CELLS = 5 };
bool ranges_resolve(const struct ranges *ranges);

/* "fell", "no start", "not lost", ...: what becomes of starts beyond an end. */
const char *ranges_end(uint8_t end);

/* Whether the whole range of an axis, down or up, ends where the domain may go on: starts cease to
 * exist there, or rays were followed no further. */
enum ranges_cut { RANGES_HELD, RANGES_NO_START, RANGES_NOT_FOLLOWED };
enum ranges_cut ranges_cut(const struct ranges_axis *axis, int up);

#endif
