/* missed_events.h - may a contact have come or gone between the two ends of an explicit step,
 * unseen?
 *
 * A mode that holds at both ends and at every stage may still have been left between them: a
 * grazing foot touches the ground and is gone, a slip stops and goes on, a force pulls for a
 * moment. Each margin g of the mode is bounded from below over the whole step by the least
 * Bernstein coefficient of a polynomial that interpolates it (G. Farin, Curves and Surfaces for
 * CAGD, section 6: a Bezier curve lies in the convex hull of its control points):
 *
 *   gap       degree 5 through value, rate and acceleration at both ends,
 *             g0, g0 + h g0'/5, g0 + 2h g0'/5 + h^2 g0''/20 and the same from the other end;
 *   slip      degree 3 through value and rate at both ends, g0, g0 + h g0'/3, ...;
 *   forces    degree 3 through the values at four stages, at the fractions 0, 3/10, 4/5, 1
 *             (inside.h).
 *
 * The bound errs to the safe side, by about 0.03 h^2 |g''| for a parabola: a quarter of it on half
 * the step. The interpolation itself errs by h^6 g^(6)/46080 for a gap, much less than that as long
 * as no angle turns by more than DIP_TURN.
 */
#ifndef STANCE_CORE_MODE_MISSED_EVENTS_H
#define STANCE_CORE_MODE_MISSED_EVENTS_H

#include "inside.h"

#define DIP_TURN 0.5   /* rad: no step is so long that an angle turns further */
#define DIP_FORCE 1e-9 /* of the largest force of its kind in the step: what counts as none */

/* The longest step, s, that no margin is lost in: see DIP_TURN and scene_longest_step. */
static inline lanes missed_longest(const struct setting *set, const lanes *w)
{
    lanes longest = scene_longest_step(&set->body);
    for (int a = 0; a < SCENE_ANGLES; a++)
        longest = lanes_min(lanes_of(DIP_TURN) / lanes_abs(w[FIRST_ANGLE + a]), longest);
    return longest;
}

/* Least of what follows from value, rate and acceleration at one end of a quintic. */
static inline lanes missed_quintic(lanes g, lanes rate, lanes acceleration, lanes h)
{
    const lanes first = g + h * (0.2 * rate);
    return lanes_min(lanes_min(first, first + h * (0.2 * rate + h * (0.05 * acceleration))), g);
}

/* Least Bernstein coefficient of the cubic through f at 0, 0.3, 0.8, 1. */
static inline lanes missed_cubic(const lanes *f)
{
    lanes b[CUBIC];
    cubic_through(f, b);
    return lanes_min(lanes_min(b[0], b[3]), lanes_min(b[1], b[2]));
}

/* Lanes where a force of contact c may have pulled where it is closed, or have left the cone where
 * it sticks. */
static inline mask missed_of_forces(lanes friction, mask closed, mask sticks,
                                    const struct inside_values *forces, int c)
{
    lanes normal[CUBIC], low[CUBIC], high[CUBIC], largest = lanes_of(0);
    for (int k = 0; k < CUBIC; k++) {
        normal[k] = forces->normal[k][c];
        low[k] = friction * forces->load[k][c] + forces->tangential[k][c];
        high[k] = friction * forces->load[k][c] - forces->tangential[k][c];
        largest = lanes_max(lanes_abs(normal[k]), largest);
    }
    const lanes none = -DIP_FORCE * largest;
    const lanes room = lanes_min(missed_cubic(low), missed_cubic(high));
    return (closed & mask_less(missed_cubic(normal), none)) |
           (sticks & mask_less(room, friction * none));
}

/* Lanes where the mode may have been left on a way from `begin` to `end`, both solved in it. */
static inline mask missed_between(const struct inside_way *way, const struct contact_state *m,
                                  const struct dynamics *begin, const struct dynamics *end,
                                  const struct inside_values *forces)
{
    const struct setting *const set = way->set;
    const lanes h = way->h;
    const lanes none = lanes_of(0);
    mask dips = MASK_NONE;
    for (int c = 0; c < OWN_CONTACTS; c++) {
        const mask closed = m->closed[c], grips = contact_part(c, m->closed);
        const mask open = LANES_NOT(closed) & mask_less(none, set->may_touch[c]);
        mask sticks = MASK_NONE, slides = MASK_NONE;
        if (contact_unknowns(c) == 2) {
            sticks = mask_less_equal(lanes_abs(m->slide[c]), none);
            slides = grips & LANES_NOT(sticks) & mask_less(none, set->friction);
        }
        const mask near = open & (mask_less(begin->gap[c], h * lanes_abs(begin->u[c][0])) |
                                  mask_less(end->gap[c], h * lanes_abs(end->u[c][0])));
        if (mask_any(grips))
            dips |= missed_of_forces(set->friction, closed, grips & sticks, forces, c);
        if (!mask_any(near | slides))
            continue;
        lanes a0[2], a1[2];
        between_acceleration(set, begin, way->w[0], c, a0);
        between_acceleration(set, end, way->w[1], c, a1);
        const lanes gap = lanes_min(missed_quintic(begin->gap[c], begin->u[c][0], a0[0], h),
                                    missed_quintic(end->gap[c], -end->u[c][0], a1[0], h));
        const lanes slip = lanes_min(m->slide[c] * (begin->u[c][1] + h * (a0[1] / 3)),
                                     m->slide[c] * (end->u[c][1] - h * (a1[1] / 3)));
        dips |= near & mask_less(gap, lanes_of(-2 * BETWEEN_GAP));
        dips |= slides & mask_less(slip, lanes_of(-BETWEEN_REST));
    }
    return dips;
}

#endif
