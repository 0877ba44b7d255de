/* pair.h - one or two points of which no certain solution is known: every mode of both, as lane.h
 * tries them, in lanes. On parallel legs, whose feet are at one place, the laws often have several
 * solutions or redundant ones, and such robots are many in a map; a foot whose law answers its
 * reactions (decoupling.h) may have them at each sample.
 */
#ifndef STANCE_CORE_CONTACT_PAIR_H
#define STANCE_CORE_CONTACT_PAIR_H

#include "direct.h"

#define PAIR_VERGE 1e3 /* tolerances: a mode is this near to a solution, or is none */

/* The best solution so far, as in lane.h. */
struct pair_choice {
    lanes r[CONTACTS][2], u[CONTACTS][2], energy;
    mask have, exact, ambiguous;
};

/* Takes r with the velocities u, where it is `valid` and better than the choice. */
static inline void pair_offer(const struct contact_problem *p, lanes tolerance, const lanes (*r)[2],
                              const lanes (*u)[2], mask valid, mask exact, struct pair_choice *best)
{
    const lanes none = lanes_of(0);
    lanes energy = none, apart = none;
    for (int c = 0; c < OWN_CONTACTS; c++)
        for (int a = 0; a < 2 && p->touching >> c & 1; a++) {
            lanes own = 0.5 * (r[c][a] * (p->uf[c][a] + u[c][a]));
            if (p->shift)
                own -= r[c][a] * p->shift[c][a];
            if (p->indefinite)
                own = choose(mask_less(none, r[c][0]), lanes_of(-0.5), none);
            energy += choose(p->active[c], own, none);
            apart =
                lanes_max(choose(p->active[c], lanes_abs(u[c][a] - best->u[c][a]), none), apart);
        }
    if (!p->indefinite)
        energy = p->prefer * energy;
    const lanes tie = 1e-12 * (lanes_abs(energy) + lanes_abs(best->energy));
    const mask first = (valid & LANES_NOT(best->have)) | (exact & LANES_NOT(best->exact));
    const mask other =
        valid & best->have & LANES_NOT(exact ^ best->exact) & mask_less(16 * tolerance, apart);
    const mask take = first | (other & mask_less(energy, best->energy - tie));
    best->ambiguous = (best->ambiguous & LANES_NOT(first)) | other;
    best->have |= valid;
    best->exact |= exact;
    best->energy = choose(take, energy, best->energy);
    choose_all(take, r, best->r, sizeof best->r);
    choose_all(take, u, best->u, sizeof best->u);
}

/* As lane_enumerate, in lanes, where the contacts in `touching` are two points, first and second,
 * or one, which is both. Impulses r in the lanes that are returned, *ambiguous among them;
 * elsewhere a mode is on the verge of a solution, or there is none. */
COLD mask pair_enumerate(const struct contact_problem *p, const int point[2],
                         const struct contact_tolerance *tolerance, mask todo, lanes (*r)[2],
                         mask *ambiguous)
{
    enum { OPEN, STICK, FORWARD, BACKWARD, MODES };
    const lanes none = lanes_of(0);
    const int first = point[0], second = point[1], points = first == second ? 1 : 2;
    struct pair_choice best = {
        .have = MASK_NONE, .exact = MASK_NONE, .ambiguous = MASK_NONE, .energy = none};
    struct direct_operator o;
    lanes candidate[CONTACTS][2], u[CONTACTS][2], edge[CONTACTS];
    mask verge = MASK_NONE, never[CONTACTS][MODES], closed[CONTACTS], sticks[CONTACTS];
    o.D = p->D;
    for (int c = 0; c < OWN_CONTACTS; c++) {
        closed[c] = sticks[c] = MASK_NONE;
        edge[c] = none;
        for (int a = 0; a < 2; a++)
            best.r[c][a] = best.u[c][a] = candidate[c][a] = none;
        never[c][OPEN] = MASK_NONE;
        never[c][STICK] = never[c][FORWARD] = never[c][BACKWARD] = LANES_NOT(p->active[c]);
        if (p->sliding) {
            const lanes slide = p->sliding[c];
            never[c][STICK] |= mask_less(none, lanes_abs(slide));
            never[c][FORWARD] |= mask_less(slide, none);
            never[c][BACKWARD] |= mask_less(none, slide);
        }
    }
    const mask holds = todo & direct_hold(p, tolerance->most, candidate) &
                       LANES_NOT(never[first][STICK] | never[second][STICK]);
    direct_velocities(p->D, p->uf, p->touching, candidate, u);
    pair_offer(p, tolerance->most, candidate, u, holds, holds, &best);
    for (int mode = 0; mode < MODES * MODES; mode++) {
        const int of[2] = {mode / MODES, mode % MODES};
        const mask may = todo & LANES_NOT(never[first][of[0]] | never[second][of[1]]);
        if ((of[0] == STICK && of[1] == STICK) || (first == second && of[0] != of[1]) ||
            !mask_any(may))
            continue;
        o.touching = 0; /* what is open has no part in the equations */
        for (int k = 0; k < points; k++) {
            o.touching |= of[k] == OPEN ? 0 : contact_with(point[k]);
            closed[point[k]] = of[k] == OPEN ? MASK_NONE : p->active[point[k]];
            sticks[point[k]] = of[k] == STICK ? LANES_ALL : MASK_NONE;
            edge[point[k]] = p->friction * (of[k] == FORWARD ? -1 : of[k] == BACKWARD ? 1 : 0);
        }
        contact_mode_rows(closed, sticks, o.rows);
        /* A constant: unrolled. */
        const bool all = SCENE_CONTACTS == 2 && o.touching == CONTACT_ALL;
        if (all) {
            contact_matrix(CONTACT_ALL, o.D, o.rows, edge, o.G);
            contact_factor(CONTACT_ALL, CONTACT_PLAIN, o.G, &o.factors);
        } else {
            direct_factor(&o, CONTACT_PLAIN, edge, 0);
        }
        for (int c = 0; c < OWN_CONTACTS; c++)
            for (int a = 0; a < 2; a++)
                candidate[c][a] = none, u[c][a] = p->uf[c][a];
        for (int round = 0; round < 2 && o.touching; round++) { /* once more with what is left */
            lanes x[CONTACTS][2];
            if (all)
                direct_rest(CONTACT_ALL, &o, u, x);
            else
                direct_back(&o, u, x);
            for (int k = 0; k < points; k++) {
                const int c = point[k];
                candidate[c][0] = candidate[c][0] + x[c][0];
                candidate[c][1] = candidate[c][1] + lanes_fma(edge[c], x[c][0], x[c][1]);
            }
            direct_velocities(p->D, p->uf, p->touching, candidate, u);
        }
        const lanes violation = direct_violation(p, candidate, u);
        lanes sum = none; /* not finite where the mode is singular: violation says nothing of it */
        for (int k = 0; k < points; k++)
            for (int a = 0; a < 2; a++)
                sum += candidate[point[k]][a] + u[point[k]][a];
        const mask regular = may & mask_finite(sum);
        const mask valid = regular & mask_less_equal(violation, tolerance->most);
        verge |=
            regular & LANES_NOT(valid) & mask_less_equal(violation, PAIR_VERGE * tolerance->most);
        if (mask_any(valid))
            pair_offer(p, tolerance->most, candidate, u, valid,
                       regular & mask_less_equal(violation, tolerance->exact), &best);
    }
    const mask done = todo & best.have & LANES_NOT(verge);
    *ambiguous = done & best.ambiguous;
    direct_take(p, best.r, done, r);
    return done;
}

/* The same in the lanes where one or two points are active and no other contact is: whatever else
 * is in `touching`, for other lanes. */
static inline mask pair_every(const struct contact_problem *p,
                              const struct contact_tolerance *tolerance, mask todo, lanes (*r)[2],
                              mask *ambiguous)
{
    mask done = MASK_NONE;
    for (int a = 0; a < OWN_CONTACTS && mask_any(todo); a++)
        for (int b = a; b < OWN_CONTACTS; b++) {
            if (!(p->touching >> a & p->touching >> b & 1) || !contact_is_point(a) ||
                !contact_is_point(b))
                continue;
            mask both = todo & p->active[a] & p->active[b], several;
            EACH_IN (c, p->touching)
                if (c != a && c != b)
                    both &= LANES_NOT(p->active[c]);
            if (!mask_any(both))
                continue;
            struct contact_problem pair = *p;
            pair.touching = 1u << a | 1u << b;
            done |= pair_enumerate(&pair, (const int[2]){a, b}, tolerance, both, r, &several);
            *ambiguous |= several;
        }
    return done;
}

#endif
