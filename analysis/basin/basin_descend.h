/* basin_descend.h - from rays to the nearest point of a boundary.
 *
 * The smallest distance over random directions is an upper bound of the distance to the boundary,
 * in many dimensions a poor one. From where a ray ends it goes on downhill: of the surface r(u) at
 * direction u the normal is along u - grad r / r, and the point of a plane that is nearest to the
 * equilibrium lies on its normal, so that direction is tried next, halfway between where that is no
 * shorter (A. M. Hasofer, N. C. Lind, J. Eng. Mech. Div. 100, 1974; R. Rackwitz, B. Fiessler,
 * Comput. Struct. 9, 1978: the design point of reliability theory). Of an ellipsoid that is the
 * power iteration, which ends at the smallest half-axis. Where nothing is shorter any more, shorter
 * points are sought in random directions at all angles; if one is found it goes on from there.
 *
 * Only whether a point is inside is ever asked, of many points at once. Directions and distances
 * are in a space in which both are measured alike, the equilibrium at its origin and inside.
 */
#ifndef STANCE_BASIN_BASIN_DESCEND_H
#define STANCE_BASIN_BASIN_DESCEND_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { DESCEND_DIMENSIONS = 18, DESCEND_STARTS = 64 }; /* most */

/* What is asked: end[count], a number below 64 for what becomes of each of the points z[count][n];
 * those in the mask `inside` are. False: it cannot go on. */
struct descend_set {
    int n; /* 1 ... DESCEND_DIMENSIONS */
    uint64_t inside;
    bool (*ask)(void *context, size_t count, const double *z, uint8_t *end);
    void *context;
};

/* From the origin along v: inside at `low` v, out of the set at `high` v, where a point becomes
 * `beyond`. High is infinite where it is not found up to `most` v. */
struct descend_ray {
    double v[DESCEND_DIMENSIONS], most, low, high;
    uint8_t beyond;
};
/* Where an end is looked for: first there, then farther out by this part of the distance, which is
 * doubled each time, beyond `most`, too, where it `hastens`, and from a lost first place back in by
 * it; then by halves, to a bracket of a relative width, or where it is nearer than `least`. */
struct descend_way {
    double first, step;
    bool hastens;
    double width, least;
};
/* Finds the ends of rays, all of them in step, whose v and `most` are given. False: no memory, or
 * the set cannot go on. */
bool descend_rays(const struct descend_set *set, const struct descend_way *way,
                  struct descend_ray *ray, size_t count);

struct descend_end {
    double low, high;             /* between these the set ends, along */
    double u[DESCEND_DIMENSIONS]; /* a unit vector */
    size_t starts, agree;         /* descents, of which so many end within 1 % of the shortest */
    uint64_t asked;               /* points */
};

/* The shortest end, not beyond `most`, of descents from start[starts][n], unit vectors, at which
 * the set ends at about the distances r[starts]. False: no memory, or the set cannot go on. */
bool basin_descend(const struct descend_set *set, double most, const double *start, const double *r,
                   size_t starts, struct descend_end *end);

/* Descents from directions drawn evenly miss a dip into which at least this share of all directions
 * leads with a probability of 5 %. */
double basin_descend_unseen(size_t starts);

#endif
