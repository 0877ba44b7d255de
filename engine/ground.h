/* ground.h - ground in plates: what it is like at a place.
 *
 * Along the ground, from left to right, it is the plane, of height 0, and from where a piece begins
 * what that says: of those that begin at x or before it the last in the list holds. Heights are
 * normal to the plane, which a slope tilts with all that is on it. Rough ground is a function of
 * its seed, or of the study's and of the number of the sample's point (not of the place in the
 * grid: along an axis nothing differs but what it says), and of the number of the plate alone:
 * Philox (Salmon et al., SC11), so that it is the same whoever asks, in whatever order.
 */
#ifndef STANCE_GROUND_H
#define STANCE_GROUND_H

#include "stance.h"

#include <Random123/philox.h>
#include <math.h>

#define GROUND_KEY 0x706c6174 /* that no noise has */

/* A plate: its height (m, of the plane), its coefficient of friction by the ground's, and where it
 * begins and ends. */
struct ground {
    double height, factor, low, high;
};

/* -1 ... 1, of plate `number` of a piece. */
static inline double ground_random(const stance_case *c, int piece, double number)
{
    const double seed = c->body.plate[piece].seed;
    const bool own = seed < 0;
    const philox4x64_ctr_t counter = {
        {own ? c->sample_index : (uint64_t)seed, own, (uint64_t)(int64_t)number, (uint64_t)piece}};
    const philox4x64_key_t key = {{c->seed, GROUND_KEY}};
    return ldexp((double)(philox4x64(counter, key).v[0] >> 11), -52) - 1;
}

/* What there is at x, of the first `pieces` that begin at from[]. */
static inline void ground_at(const stance_case *c, const double *from, int pieces, double x,
                             struct ground *at)
{
    const stance_tree_numbers *const body = &c->body;
    *at = (struct ground){0, 1, -INFINITY, INFINITY};
    for (int k = 0; k < pieces; k++) {
        const stance_plate_numbers *const of = &body->plate[k];
        if (!(from[k] <= x)) {
            at->high = fmin(at->high, from[k]);
            continue;
        }
        struct ground before = *at; /* of the plane, what there is at its beginning */
        if (body->plate_kind[k] != STANCE_PLATE)
            ground_at(c, from, k, from[k], &before);
        *at = (struct ground){of->height, of->friction_factor, from[k], INFINITY};
        if (body->plate_kind[k] == STANCE_PLATE)
            continue;
        double number = floor((x - from[k]) / of->width);
        /* Ends as they are told to others decide, not a quotient. */
        while (x < from[k] + number * of->width)
            number--;
        while (x >= from[k] + (number + 1) * of->width)
            number++;
        const bool past = number >= of->count;
        if (body->plate_kind[k] == STANCE_STAIRS)
            at->height = before.height + (past ? of->count : number + 1) * of->height;
        else
            at->height = before.height + (past ? 0 : of->height * ground_random(c, k, number));
        at->low = from[k] + (past ? of->count : number) * of->width;
        at->high = past ? INFINITY : from[k] + (number + 1) * of->width;
    }
}

#endif
