/* solve.h - contact problems of all lanes: directly where that is certain to be right, two points
 * by every mode in lanes; of more than four elements what the mode before, or those that its
 * impulses and velocities point to, solve; the rest lane by lane.
 */
#ifndef STANCE_CORE_CONTACT_SOLVE_H
#define STANCE_CORE_CONTACT_SOLVE_H

#include "pair.h"

#define SOLVE_ENUMERATED 4 /* elements: more are not enumerated */

/* Lanes with more elements than are enumerated. */
static inline mask solve_crowded(contact_set touching, const mask *active)
{
    lanes elements = lanes_of(0);
    EACH_IN (c, touching)
        if (contact_grip(c) == c || contact_grip(c) < 0)
            elements += choose(contact_part(c, active), lanes_of(1), lanes_of(0));
    return mask_less(lanes_of(SOLVE_ENUMERATED), elements);
}

/* What is not decided in the hot loop, in the lanes of `unsure`; `many`: those with more than a
 * point. */
COLD void solve_rest(const struct contact_rule *rule, const lanes (*D)[CONTACTS][2][2],
                     const lanes (*uf)[2], contact_set touching, const mask *active, mask unsure,
                     mask many, lanes (*r)[2], struct contact_verdict *v)
{
    const lanes none = lanes_of(0);
    lanes stick[CONTACTS][2], largest = none;
    EACH_IN (c, touching)
        for (int a = 0; a < contact_unknowns(c); a++)
            largest = lanes_max(choose(active[c], lanes_abs(uf[c][a]), none), largest);
    const struct contact_tolerance tolerance = contact_tolerance(largest);
    struct direct_mode mode;
    mask known = MASK_NONE; /* something carried */
    EACH_IN (c, touching)
        if (rule->last)
            known |= unsure & many & rule->known & active[c] & mask_less(none, rule->last[c][0]);
    const mask stood = known & direct_stood(rule, touching, active);
    direct_mode_of(rule, active, known, rule->last, &mode);
    mask done = MASK_NONE;
    if (mask_any(known))
        done = direct_try(rule, D, uf, touching, active, tolerance.exact, known, known, &mode, r);
    const mask crowded = unsure & solve_crowded(touching, active);
    const mask holds =
        LANES_NOT(done) &
        (stood | ((known | crowded) & direct_stick_is_least(rule, touching, active)));
    if (mask_any(holds)) {
        const mask held =
            holds & direct_hold(rule->friction, tolerance.most, D, uf, touching, active, stick);
        for (int c = 0; c < OWN_CONTACTS; c++)
            for (int a = 0; a < 2; a++)
                r[c][a] = choose(held, stick[c][a], r[c][a]);
        done |= held;
    }
    if (!rule->indefinite && mask_any(unsure & LANES_NOT(done))) {
        const mask unique = direct_unique(rule->friction, D, touching, active);
        const mask todo = unsure & LANES_NOT(done) & (unique | crowded);
        const mask found =
            direct_modes(rule, D, uf, touching, active, tolerance.exact, todo, &mode, r);
        v->unranked |= found & LANES_NOT(unique);
        done |= found;
    }
    mask left = unsure & LANES_NOT(done);
    left &=
        LANES_NOT(pair_every(rule, D, uf, touching, active, &tolerance, left, r, &v->ambiguous));
    for (int lane = 0; lane < LANES && mask_any(left); lane++) {
        if (!mask_get(left, lane))
            continue;
        struct lane_problem p;
        struct lane_choice best;
        contact_set here = 0;
        EACH_IN (c, touching)
            here |= mask_get(active[c], lane) ? 1u << c : 0;
        lane_gather(rule, D, uf, here, lane, &p);
        lane_choose_none(&best);
        if (p.elements <= SOLVE_ENUMERATED) {
            lane_enumerate(&p, &best);
        } else {
            crowd_solve(&p, &best);
            v->unranked |= mask_of_lane(lane);
        }
        lane_clip(&p, best.u, best.r);
        for (int i = 0; i < p.rows; i++)
            lane_set(&r[p.contact[i]][p.axis[i]], lane, best.r[i]);
        if (best.ambiguous)
            v->ambiguous |= mask_of_lane(lane);
        if (!(best.violation <= 1e3 * p.tolerance))
            v->unsolved |= mask_of_lane(lane);
    }
}

/* Impulses of the active contacts for the linearised step, in the lanes of `where`; zero of other
 * contacts. `rule` is about all contacts, D and uf are of those in `touching`. */
HOT void solve_contacts(const struct contact_rule *rule, const lanes (*D)[CONTACTS][2][2],
                        const lanes (*uf)[2], contact_set touching, mask where, const mask *active,
                        lanes (*r)[2], struct contact_verdict *v)
{
    const lanes none = lanes_of(0);
    mask any = MASK_NONE, many = MASK_NONE, unsure = MASK_NONE;
    v->ambiguous = v->unsolved = v->unranked = MASK_NONE;
    EACH_CONTACT (c, 0)
        r[c][0] = r[c][1] = none;
    EACH_IN (c, touching) {
        many |= active[c] & any;
        if (!contact_is_point(c))
            many |= active[c];
        any |= active[c];
    }
    const mask one = any & LANES_NOT(many); /* one point */
    const contact_set points = touching;
    if (points && (points & (points - 1)) == 0 && !mask_any(many)) { /* no stop */
        EACH_IN (c, touching) {
            if (!contact_is_point(c))
                continue;
            lanes alone[2];
            unsure = one & LANES_NOT(direct_one(D[c][c], uf[c], rule->friction,
                                                rule->sliding ? &rule->sliding[c] : NULL, alone));
            EACH (a, 0, 2)
                r[c][a] = choose(one, alone[a], none);
        }
    } else {
        if (mask_any(one)) {
            lanes D1[2][2], uf1[2], sliding1 = none, alone[2];
            EACH (a, 0, 2)
                uf1[a] = D1[a][0] = D1[a][1] = none;
            EACH_IN (c, touching) {
                if (!contact_is_point(c))
                    continue;
                if (rule->sliding)
                    sliding1 = choose(active[c], rule->sliding[c], sliding1);
                EACH (a, 0, 2) {
                    uf1[a] = choose(active[c], uf[c][a], uf1[a]);
                    EACH (b, 0, 2)
                        D1[a][b] = choose(active[c], D[c][c][a][b], D1[a][b]);
                }
            }
            unsure |= one & LANES_NOT(direct_one((const lanes(*)[2])D1, uf1, rule->friction,
                                                 rule->sliding ? &sliding1 : NULL, alone));
            EACH_IN (c, touching)
                EACH (a, 0, 2)
                    if (contact_is_point(c))
                        r[c][a] = choose(one & active[c], alone[a], r[c][a]);
        }
#ifdef CONTACT_LISTS
        unsure |= many; /* solve_rest holds them the same way */
#else
        if (mask_any(many)) {
            lanes all[CONTACTS][2];
            const mask stays = many & direct_stick(rule, D, uf, touching, active, all) &
                               direct_stood(rule, touching, active);
            unsure |= many & LANES_NOT(stays);
            EACH_IN (c, touching)
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
    solve_rest(rule, D, uf, touching, active, unsure, many, r, v);
#else
    /* Copies, because what is passed by address has to stay in memory. */
    struct contact_rule own = *rule;
    lanes D1[CONTACTS][CONTACTS][2][2], uf1[CONTACTS][2], r1[CONTACTS][2];
    lanes sliding[CONTACTS], shift[CONTACTS][2], last[CONTACTS][2];
    mask part[CONTACTS];
    struct contact_verdict verdict = *v;
    EACH_CONTACT (c, 0)
        part[c] = MASK_NONE;
    EACH_IN (c, touching)
        part[c] = active[c];
    EACH_CONTACT (c, 0) {
        sliding[c] = rule->sliding ? rule->sliding[c] : none;
        EACH (a, 0, 2) {
            r1[c][a] = r[c][a];
            shift[c][a] = rule->shift ? rule->shift[c][a] : none;
            last[c][a] = rule->last ? rule->last[c][a] : none;
        }
    }
    EACH_IN (c, touching) {
        EACH (a, 0, 2)
            uf1[c][a] = uf[c][a];
        EACH_IN (k, touching)
            memcpy(D1[c][k], D[c][k], sizeof D1[c][k]);
    }
    own.sliding = rule->sliding ? sliding : NULL;
    own.shift = rule->shift ? (const lanes(*)[2])shift : NULL;
    own.last = rule->last ? (const lanes(*)[2])last : NULL;
    solve_rest(&own, (const lanes(*)[CONTACTS][2][2])D1, (const lanes(*)[2])uf1, touching, part,
               unsure, many, r1, &verdict);
    EACH_CONTACT (c, 0)
        EACH (a, 0, 2)
            r[c][a] = r1[c][a];
    *v = verdict;
#endif
}

#endif
