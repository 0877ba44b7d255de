/* solve.h - contact problems of all lanes: directly where that is certain to be right, two points
 * by every mode in lanes; of more than four elements what the mode before, or those that its
 * impulses and velocities point to, solve; the rest lane by lane.
 */
#ifndef STANCE_CORE_CONTACT_SOLVE_H
#define STANCE_CORE_CONTACT_SOLVE_H

#include "pair.h"

#define SOLVE_ENUMERATED 4 /* elements: more are not enumerated */

/* What is not decided in the hot loop, in the lanes of `unsure`; `many`: those with more than a
 * point. */
COLD void solve_rest(const struct contact_problem *p, mask unsure, mask many, lanes (*r)[2],
                     struct contact_verdict *v)
{
    const lanes none = lanes_of(0);
    lanes stick[CONTACTS][2], largest = none, elements = none;
    mask known = MASK_NONE, done = MASK_NONE; /* something carried; is solved */
    EACH_IN (c, p->touching) {
        for (int a = 0; a < contact_unknowns(c); a++)
            largest = lanes_max(choose(p->active[c], lanes_abs(p->uf[c][a]), none), largest);
        if (p->last)
            known |= unsure & many & p->known & p->active[c] & mask_less(none, p->last[c][0]);
        if (contact_grip(c) == c || contact_grip(c) < 0)
            elements += lanes_where(contact_part(c, p->active));
    }
    const struct contact_tolerance tolerance = contact_tolerance(largest);
    struct direct_mode mode;
    const mask stood = known & direct_stood(p);
    direct_mode_of(p, known, &mode);
    if (mask_any(known))
        done = direct_try(p, tolerance.exact, known, known, &mode, r);
    const mask crowded = unsure & mask_less(lanes_of(SOLVE_ENUMERATED), elements);
    const mask holds = LANES_NOT(done) & (stood | ((known | crowded) & direct_stick_is_least(p)));
    if (mask_any(holds)) {
        const mask held = holds & direct_hold(p, tolerance.most, stick);
        choose_all(held, stick, r, sizeof stick);
        done |= held;
    }
    if (!p->indefinite && mask_any(unsure & LANES_NOT(done))) {
        const mask unique = direct_unique(p);
        mask todo = unsure & LANES_NOT(done) & (unique | crowded);
        for (int round = 0; round < DIRECT_ROUNDS && mask_any(todo); round++) {
            const mask found = direct_try(p, tolerance.exact, todo, MASK_NONE, &mode, r);
            v->unranked |= found & LANES_NOT(unique);
            todo &= LANES_NOT(found);
            done |= found;
        }
    }
    mask left = unsure & LANES_NOT(done);
    left &= LANES_NOT(pair_every(p, &tolerance, left, r, &v->ambiguous));
    for (int lane = 0; lane < LANES && mask_any(left); lane++) {
        if (!mask_get(left, lane))
            continue;
        struct lane_problem own;
        struct lane_choice best;
        contact_set here = 0;
        EACH_IN (c, p->touching)
            here |= mask_get(p->active[c], lane) ? 1u << c : 0;
        lane_gather(p, here, lane, &own);
        if (own.elements <= SOLVE_ENUMERATED) {
            lane_enumerate(&own, &best);
        } else {
            crowd_solve(&own, &best);
            v->unranked |= mask_of_lane(lane);
        }
        lane_clip(&own, best.u, best.r);
        for (int i = 0; i < own.rows; i++)
            lane_set(&r[own.contact[i]][own.axis[i]], lane, best.r[i]);
        if (best.ambiguous)
            v->ambiguous |= mask_of_lane(lane);
        if (!(best.violation <= 1e3 * own.tolerance))
            v->unsolved |= mask_of_lane(lane);
    }
}

/* Impulses of the active contacts for the linearised step, in the lanes of `where`; zero of other
 * contacts. */
HOT void solve_contacts(const struct contact_problem *p, mask where, lanes (*r)[2],
                        struct contact_verdict *v)
{
    const lanes none = lanes_of(0);
    mask any = MASK_NONE, many = MASK_NONE, unsure = MASK_NONE;
    v->ambiguous = v->unsolved = v->unranked = MASK_NONE;
    EACH_CONTACT (c, 0)
        r[c][0] = r[c][1] = none;
    EACH_IN (c, p->touching) {
        many |= p->active[c] & any;
        if (!contact_is_point(c))
            many |= p->active[c];
        any |= p->active[c];
    }
    const mask one = any & LANES_NOT(many); /* one point */
    const contact_set points = p->touching;
    if (points && (points & (points - 1)) == 0 && !mask_any(many)) { /* no stop */
        EACH_IN (c, p->touching) {
            if (!contact_is_point(c))
                continue;
            lanes alone[2];
            unsure = one & LANES_NOT(direct_one(p->D[c][c], p->uf[c], p->friction,
                                                p->sliding ? &p->sliding[c] : NULL, alone));
            EACH (a, 0, 2)
                r[c][a] = choose(one, alone[a], none);
        }
    } else {
        if (mask_any(one)) {
            lanes D1[2][2], uf1[2], sliding1 = none, alone[2];
            EACH (a, 0, 2)
                uf1[a] = D1[a][0] = D1[a][1] = none;
            EACH_IN (c, p->touching) {
                if (!contact_is_point(c))
                    continue;
                if (p->sliding)
                    sliding1 = choose(p->active[c], p->sliding[c], sliding1);
                EACH (a, 0, 2) {
                    uf1[a] = choose(p->active[c], p->uf[c][a], uf1[a]);
                    EACH (b, 0, 2)
                        D1[a][b] = choose(p->active[c], p->D[c][c][a][b], D1[a][b]);
                }
            }
            unsure |= one & LANES_NOT(direct_one(D1, uf1, p->friction,
                                                 p->sliding ? &sliding1 : NULL, alone));
            EACH_IN (c, p->touching)
                EACH (a, 0, 2)
                    if (contact_is_point(c))
                        r[c][a] = choose(one & p->active[c], alone[a], r[c][a]);
        }
#ifdef CONTACT_LISTS
        unsure |= many; /* solve_rest holds them the same way */
#else
        if (mask_any(many)) {
            lanes all[CONTACTS][2];
            const mask stays = many & direct_stick(p, all) & direct_stood(p);
            unsure |= many & LANES_NOT(stays);
            EACH_IN (c, p->touching)
                EACH (a, 0, 2)
                    if (a < contact_unknowns(c))
                        r[c][a] = choose(stays, all[c][a], r[c][a]);
        }
#endif
    }
    unsure &= where;
    if (!mask_any(unsure))
        return;
#ifdef CONTACT_LISTS
    solve_rest(p, unsure, many, r, v);
#else
    /* Copies, because what is passed by address has to stay in memory. */
    lanes D[CONTACTS][CONTACTS][2][2], uf[CONTACTS][2], r1[CONTACTS][2];
    lanes sliding[CONTACTS], shift[CONTACTS][2], last[CONTACTS][2];
    mask part[CONTACTS];
    struct contact_verdict verdict = *v;
    EACH_CONTACT (c, 0) {
        part[c] = MASK_NONE;
        sliding[c] = p->sliding ? p->sliding[c] : none;
        EACH (a, 0, 2) {
            r1[c][a] = r[c][a];
            shift[c][a] = p->shift ? p->shift[c][a] : none;
            last[c][a] = p->last ? p->last[c][a] : none;
        }
    }
    EACH_IN (c, p->touching) {
        part[c] = p->active[c];
        EACH (a, 0, 2)
            uf[c][a] = p->uf[c][a];
        EACH_IN (k, p->touching)
            memcpy(D[c][k], p->D[c][k], sizeof D[c][k]);
    }
    const struct contact_problem own = {.D = D,
                                        .uf = uf,
                                        .touching = p->touching,
                                        .active = part,
                                        .friction = p->friction,
                                        .prefer = p->prefer,
                                        .sliding = p->sliding ? sliding : NULL,
                                        .shift = p->shift ? shift : NULL,
                                        .indefinite = p->indefinite,
                                        .last = p->last ? last : NULL,
                                        .known = p->known};
    solve_rest(&own, unsure, many, r1, &verdict);
    EACH_CONTACT (c, 0)
        EACH (a, 0, 2)
            r[c][a] = r1[c][a];
    *v = verdict;
#endif
}

#endif
