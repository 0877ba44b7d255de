/* direct.h - contact problems solved without trying every mode, where that is certain to be right.
 *
 * One contact. With D_N+- = D_NN +- mu D_NT > 0, D_NN > 0 and det D > 0 the problem of contact.h
 * has exactly one solution: uf_N >= 0: open. Slip with r_N > 0 would need uf_N < 0, and sticking 0
 * = u_N >= uf_N + D_N r_N, of D_N the smaller, the same; uf_N < 0: u_N = 0 makes u_T a function of
 * r_T with slope det D / D_NN > 0 on the interval of |r_T| <= mu r_N: it sticks where u_T = 0 is
 * reached inside, else it slips at that end of the interval beyond which the sticking impulse lies.
 *
 * Two contacts. In each of contact 0's four modes what is left is a problem of contact 1 alone,
 * with an operator that is not symmetric; each of its four modes gives a candidate, or none, for
 * the law of contact 0 to judge. Where just one of all is admitted, it is the solution.
 *
 * Contacts that stood still in the step before, all of them, go on standing as long as the impulses
 * that takes lie in the cones, whatever else would satisfy the laws: what stands has no decision to
 * take. (It is also the solution with the least kinetic energy.)
 *
 * Lanes where none of this holds are left to contact.h.
 */
#ifndef STANCE_CORE_CONTACT_DIRECT_H
#define STANCE_CORE_CONTACT_DIRECT_H

#include "contact.h"
#include "engine/core/lanes/sizes.h"

/* Contacts that matter in any lane: bit c. What an open contact would do costs nothing. */
typedef unsigned contact_set;

#define DIRECT_REGULAR                                                                             \
    1e-9 /* of the largest it can be: a pivot this small is left to contact.h                      \
          */

/* What a contact problem is asked beside its operator: see contact_problem; of one contact where
 * one is meant. */
struct contact_rule {
    lanes friction, prefer;
    const lanes *sliding, *shift;
    bool indefinite;
    const lanes (*before)[2]; /* impulses of all contacts in the step before; NULL: not known */
};

/* Lanes where an impulse is inside the cone. */
HOT mask direct_inside(lanes friction, const lanes r[2])
{
    return mask_less_equal(lanes_abs(r[1]), friction * r[0]);
}

/* Lanes where a contact with the impulse r neither slides nor is about to leave. */
HOT mask direct_stands(lanes friction, const lanes r[2])
{
    return mask_less(lanes_of(0), r[0]) &
           mask_less(lanes_abs(r[1]), (CONTACT_STICKS * friction) * r[0]);
}

HOT void direct_stick_one(const lanes D[2][2], const lanes uf[2], lanes determinant, lanes r[2])
{
    const lanes reciprocal = 1 / determinant;
    r[0] = lanes_fms(D[0][1], uf[1], D[1][1] * uf[0]) * reciprocal;
    r[1] = lanes_fms(D[1][0], uf[0], D[0][0] * uf[1]) * reciprocal;
}

/* Sliding: NULL or as in contact_problem, of this contact; own: see contact_impulse. Returns the
 * lanes where r is certainly the one solution. */
HOT mask direct_one(const lanes own[2][2], const lanes D[2][2], const lanes uf[2], lanes friction,
                    const lanes *sliding, lanes r[2])
{
    const lanes none = lanes_of(0), across = friction * lanes_abs(D[0][1]);
    const lanes product = D[0][0] * D[1][1];
    const lanes determinant = lanes_fnma(D[0][1], D[1][0], product);
    const mask sure = mask_less(across, (1 - DIRECT_REGULAR) * D[0][0]) &
                      mask_less(DIRECT_REGULAR * lanes_abs(own[0][0] * own[1][1]), determinant);
    lanes stick[2];
    direct_stick_one(D, uf, determinant, stick);
    const mask open = mask_less_equal(none, uf[0]);
    mask slips = LANES_NOT(direct_inside(friction, stick));
    r[0] = choose(open, none, stick[0]);
    r[1] = choose(open, none, stick[1]);
    lanes edge = choose(mask_less(stick[1], none), -friction, friction);
    if (sliding) {
        const mask goes_on = mask_less(none, lanes_abs(*sliding));
        slips |= goes_on;
        edge = choose(goes_on, -(friction * *sliding), edge);
    }
    slips &= LANES_NOT(open);
    if (mask_any(slips)) {
        const lanes pressed = -uf[0] / lanes_fma(edge, D[0][1], D[0][0]);
        r[0] = choose(slips, pressed, r[0]);
        r[1] = choose(slips, edge * pressed, r[1]);
    }
    return sure;
}

/* Impulse of one contact in a mode, of which another has left D and uf; determinant: that of D.
 * Returns the lanes where its laws are obeyed. Sliding: as for direct_one. */
HOT mask direct_mode(enum contact_mode mode, const lanes D[2][2], const lanes uf[2], lanes friction,
                     const lanes *sliding, lanes determinant, lanes r[2])
{
    const lanes none = lanes_of(0);
    const mask goes_on = sliding ? mask_less(none, lanes_abs(*sliding)) : MASK_NONE;
    r[0] = r[1] = none;
    if (mode == CONTACT_OPEN)
        return mask_less_equal(none, uf[0]);
    if (mode == CONTACT_STICK) {
        direct_stick_one(D, uf, determinant, r);
        return LANES_NOT(goes_on) & mask_less(none, r[0]) & direct_inside(friction, r);
    }
    const double way = mode == CONTACT_FORWARD ? 1 : -1;
    const lanes edge = -(way * friction);
    r[0] = -uf[0] / lanes_fma(edge, D[0][1], D[0][0]);
    r[1] = edge * r[0];
    lanes slip = lanes_fma(D[1][0], r[0], lanes_fma(D[1][1], r[1], uf[1]));
    if (sliding)
        slip = choose(goes_on, *sliding, slip);
    return mask_less(none, r[0]) & mask_less(none, way * slip);
}

/* Contact 0 in a mode other than open: its impulse is alone + push r1, with r1 that of contact 1.
 */
struct direct_part {
    lanes alone[2], push[2][2];
};

HOT void direct_part(enum contact_mode mode, const lanes D[2][2][2][2], const lanes uf[2],
                     lanes friction, lanes determinant, struct direct_part *part)
{
    const lanes(*const own)[2] = D[0][0];
    const lanes edge = mode == CONTACT_FORWARD ? -friction : friction;
    const lanes reciprocal =
        1 / (mode == CONTACT_STICK ? determinant : lanes_fma(edge, own[0][1], own[0][0]));
    for (int k = 0; k < 3; k++) { /* the columns of `push`, then `alone` */
        const lanes u0 = k < 2 ? D[0][1][0][k] : uf[0], u1 = k < 2 ? D[0][1][1][k] : uf[1];
        lanes answer[2];
        if (mode == CONTACT_STICK) {
            answer[0] = lanes_fms(own[0][1], u1, own[1][1] * u0) * reciprocal;
            answer[1] = lanes_fms(own[1][0], u0, own[0][0] * u1) * reciprocal;
        } else {
            answer[0] = -(u0 * reciprocal);
            answer[1] = edge * answer[0];
        }
        for (int a = 0; a < 2; a++)
            *(k < 2 ? &part->push[a][k] : &part->alone[a]) = answer[a];
    }
}

HOT void direct_eliminate(const lanes D[2][2][2][2], const lanes uf[2][2],
                          const struct direct_part *part, lanes D1[2][2], lanes uf1[2])
{
    for (int a = 0; a < 2; a++) {
        const lanes *const through = D[1][0][a];
        uf1[a] =
            lanes_fma(through[0], part->alone[0], lanes_fma(through[1], part->alone[1], uf[1][a]));
        for (int b = 0; b < 2; b++)
            D1[a][b] = lanes_fma(through[0], part->push[0][b],
                                 lanes_fma(through[1], part->push[1][b], D[1][1][a][b]));
    }
}

/* What the law of contact 0 in its mode is violated by, as a velocity, with the impulses r. */
HOT lanes direct_violation(enum contact_mode mode, const lanes D[2][2][2][2], const lanes uf[2][2],
                           lanes friction, const lanes *sliding, const lanes r[2][2])
{
    const int a = mode == CONTACT_OPEN ? 0 : 1;
    const mask goes_on = sliding ? mask_less(lanes_of(0), lanes_abs(sliding[0])) : MASK_NONE;
    lanes u = uf[0][a];
    for (int j = 0; j < 2; j++)
        u = lanes_fma(D[0][j][a][0], r[j][0], lanes_fma(D[0][j][a][1], r[j][1], u));
    if (mode == CONTACT_OPEN)
        return -u;
    const lanes pulls = -(r[0][0] * D[0][0][0][0]);
    if (mode == CONTACT_STICK) {
        const lanes beyond = lanes_fnma(friction, r[0][0], lanes_abs(r[0][1])) * D[0][0][1][1];
        return choose(goes_on, lanes_of(INFINITY), lanes_max(beyond, pulls));
    }
    if (sliding)
        u = choose(goes_on, CONTACT_ENDLESS * sliding[0], u);
    return lanes_max(mode == CONTACT_FORWARD ? -u : u, pulls);
}

/* Both contacts stick: returns the lanes where the operator is regular and both are inside. */
HOT mask direct_stick_two(const lanes D[2][2][2][2], const lanes uf[2][2], lanes friction,
                          lanes determinant, mask regular, lanes r[2][2])
{
    struct direct_part part;
    lanes D1[2][2], uf1[2];
    direct_part(CONTACT_STICK, D, uf[0], friction, determinant, &part);
    direct_eliminate(D, uf, &part, D1, uf1);
    const lanes left = lanes_fnma(D1[0][1], D1[1][0], D1[0][0] * D1[1][1]);
    const lanes own = lanes_abs(D[1][1][0][0] * D[1][1][1][1]);
    direct_stick_one((const lanes(*)[2])D1, uf1, left, r[1]);
    for (int a = 0; a < 2; a++)
        r[0][a] =
            lanes_fma(part.push[a][0], r[1][0], lanes_fma(part.push[a][1], r[1][1], part.alone[a]));
    return regular & mask_less(DIRECT_REGULAR * own, left) & direct_inside(friction, r[0]) &
           direct_inside(friction, r[1]);
}

/* The same as direct_one for two contacts, in the lanes of `wanted`; `tolerance` as in
 * contact_problem. */
HOT mask direct_two(const lanes D[2][2][2][2], const lanes uf[2][2],
                    const struct contact_rule *rule, lanes tolerance, mask wanted, lanes r[2][2])
{
    const lanes friction = rule->friction;
    const lanes product = D[0][0][0][0] * D[0][0][1][1];
    const lanes determinant = lanes_fnma(D[0][0][0][1], D[0][0][1][0], product);
    const mask regular = mask_less(DIRECT_REGULAR * lanes_abs(product), determinant);
    mask stays = MASK_NONE;
    for (int c = 0; c < 2; c++)
        r[c][0] = r[c][1] = lanes_of(0);
    if (rule->before) {
        const mask stood = wanted & direct_stands(friction, rule->before[0]) &
                           direct_stands(friction, rule->before[1]);
        if (mask_any(stood))
            stays = stood & direct_stick_two(D, uf, friction, determinant, regular, r);
        const mask left = stood & LANES_NOT(stays);
        if (mask_any(left)) { /* legs that are parallel, or nearly so */
            const contact_problem problem = {D,         uf, NULL, NULL, friction, rule->prefer,
                                             tolerance, 2,  false};
            lanes all[2][2];
            const mask again = left & contact_stick_both(&problem, all);
            for (int c = 0; c < 2; c++)
                for (int a = 0; a < 2; a++)
                    r[c][a] = choose(again, all[c][a], r[c][a]);
            stays |= again;
        }
        if (!mask_any(wanted & LANES_NOT(stays)))
            return stays;
    }
    mask found = MASK_NONE;
    const lanes own1 = lanes_abs(D[1][1][0][0] * D[1][1][1][1]);
    mask sure = regular;
    for (enum contact_mode mode = CONTACT_OPEN; mode < CONTACT_MODES; mode++) {
        struct direct_part part = {0};
        lanes D1[2][2], uf1[2];
        memcpy(D1, D[1][1], sizeof D1);
        memcpy(uf1, uf[1], sizeof uf1);
        if (mode != CONTACT_OPEN) {
            direct_part(mode, D, uf[0], friction, determinant, &part);
            direct_eliminate(D, uf, &part, D1, uf1);
        }
        const lanes left = lanes_fnma(D1[0][1], D1[1][0], D1[0][0] * D1[1][1]);
        sure &= mask_less(DIRECT_REGULAR * own1, lanes_abs(left));
        for (enum contact_mode other = CONTACT_OPEN; other < CONTACT_MODES; other++) {
            lanes candidate[2][2];
            const mask fits =
                wanted & direct_mode(other, (const lanes(*)[2])D1, uf1, friction,
                                     rule->sliding ? &rule->sliding[1] : NULL, left, candidate[1]);
            if (!mask_any(fits))
                continue;
            for (int a = 0; a < 2; a++)
                candidate[0][a] =
                    mode == CONTACT_OPEN
                        ? lanes_of(0)
                        : lanes_fma(part.push[a][0], candidate[1][0],
                                    lanes_fma(part.push[a][1], candidate[1][1], part.alone[a]));
            const lanes violation = direct_violation(mode, D, uf, friction, rule->sliding,
                                                     (const lanes(*)[2])candidate);
            const mask valid = fits & mask_less_equal(violation, tolerance);
            sure &= LANES_NOT(valid & found);
            found |= valid;
            const mask take = valid & LANES_NOT(stays);
            for (int c = 0; c < 2; c++)
                for (int a = 0; a < 2; a++)
                    r[c][a] = choose(take, candidate[c][a], r[c][a]);
        }
    }
    return stays | (sure & found);
}

/* Tries every mode in the lanes of `unsure`, of the contacts of D and uf. */
COLD void solve_by_trial(const contact_problem *p, mask unsure, lanes r[2][2], mask *ambiguous,
                         mask *unsolved)
{
    contact_choice best;
    contact_solve(p, &best);
    for (int c = 0; c < p->contacts; c++)
        for (int a = 0; a < 2; a++)
            r[c][a] = choose(unsure, best.r[c][a], r[c][a]);
    *ambiguous |= unsure & best.ambiguous;
    *unsolved |= unsure & LANES_NOT(mask_less_equal(best.violation, 1e3 * p->tolerance));
}

/* One contact that stood: goes on standing in the lanes that are returned. */
COLD mask direct_stays(const lanes D[2][2], const lanes uf[2], lanes friction,
                       const lanes before[2], mask unsure, lanes r[2])
{
    lanes stick[2];
    const lanes product = D[0][0] * D[1][1];
    const lanes determinant = lanes_fnma(D[0][1], D[1][0], product);
    direct_stick_one(D, uf, determinant, stick);
    const mask stays = unsure & direct_stands(friction, before) &
                       mask_less(DIRECT_REGULAR * lanes_abs(product), determinant) &
                       direct_inside(friction, stick);
    for (int a = 0; a < 2; a++)
        r[a] = choose(stays, stick[a], r[a]);
    return stays;
}

/* Impulses of one active contact: directly where that is certain. */
HOT void solve_one(const struct contact_rule *rule, const lanes D[2][2], const lanes uf[2],
                   mask active, lanes r[2], mask *ambiguous, mask *unsolved)
{
    mask unsure = active;
    if (!rule->indefinite)
        unsure &= LANES_NOT(direct_one(D, D, uf, rule->friction, rule->sliding, r));
    if (!mask_any(unsure))
        return;
    lanes problem[2][2][2][2], free[2][2], all[2][2]; /* their first blocks alone */
    lanes sliding = lanes_of(0), shift = lanes_of(0), before[2];
    memcpy(problem[0][0], D, sizeof problem[0][0]);
    memcpy(free[0], uf, sizeof free[0]);
    memcpy(all[0], r, sizeof all[0]);
    if (rule->before) {
        memcpy(before, rule->before[0], sizeof before);
        unsure &= LANES_NOT(direct_stays((const lanes(*)[2])problem[0][0], free[0], rule->friction,
                                         before, unsure, all[0]));
    }
    if (rule->sliding)
        sliding = *rule->sliding;
    if (rule->shift)
        shift = *rule->shift;
    const lanes tolerance =
        CONTACT_TOLERANCE * lanes_max(lanes_max(lanes_abs(uf[0]), lanes_abs(uf[1])), lanes_of(1));
    if (mask_any(unsure))
        solve_by_trial(&(contact_problem){(const lanes(*)[2][2][2])problem, (const lanes(*)[2])free,
                                          rule->sliding ? &sliding : NULL,
                                          rule->shift ? &shift : NULL, rule->friction, rule->prefer,
                                          tolerance, 1, rule->indefinite},
                       unsure, all, ambiguous, unsolved);
    memcpy(r, all[0], sizeof all[0]);
}

/* The same for two. */
HOT void solve_two(const struct contact_rule *rule, const lanes D[2][2][2][2], const lanes uf[2][2],
                   mask active, lanes r[2][2], mask *ambiguous, mask *unsolved)
{
    lanes scale = lanes_of(1);
    for (int c = 0; c < 2; c++)
        for (int a = 0; a < 2; a++)
            scale = lanes_max(lanes_abs(uf[c][a]), scale);
    const lanes tolerance = CONTACT_TOLERANCE * scale;
    mask unsure = active;
    if (!rule->indefinite)
        unsure &= LANES_NOT(direct_two(D, uf, rule, tolerance, active, r));
    if (!mask_any(unsure))
        return;
    solve_by_trial(&(contact_problem){D, uf, rule->sliding, rule->shift, rule->friction,
                                      rule->prefer, tolerance, 2, rule->indefinite},
                   unsure, r, ambiguous, unsolved);
}

/* Impulses of the active contacts for the linearised step; zero elsewhere. `rule` is about all
 * contacts, D and uf are of those in `touching`. */
HOT void solve_contacts(const struct contact_rule *rule, const lanes D[2][2][2][2],
                        const lanes uf[2][2], contact_set touching, const mask *active,
                        lanes r[2][2], mask *ambiguous, mask *unsolved)
{
    const lanes none = lanes_of(0);
    *ambiguous = *unsolved = MASK_NONE;
    for (int c = 0; c < SCENE_CONTACTS; c++)
        r[c][0] = r[c][1] = none;
    if (SCENE_CONTACTS == 1 || (touching & (touching - 1)) == 0) { /* one at most */
        const int c = touching == 1 ? 0 : SECOND;
        lanes alone[2] = {none, none};
        struct contact_rule own = *rule;
        own.sliding = rule->sliding ? &rule->sliding[c] : NULL;
        own.shift = rule->shift ? &rule->shift[c] : NULL;
        own.before = rule->before ? &rule->before[c] : NULL;
        solve_one(&own, D[c][c], uf[c], active[c], alone, ambiguous, unsolved);
        for (int a = 0; a < 2; a++)
            r[c][a] = choose(active[c], alone[a], none);
        return;
    }
    const mask both = active[0] & active[SECOND];
    const mask one = (active[0] | active[SECOND]) & LANES_NOT(both);
    if (mask_any(one)) {
        lanes D1[2][2], uf1[2], sliding1 = none, shift1 = none, before1[1][2];
        lanes alone[2] = {none, none};
        struct contact_rule own = *rule;
        if (rule->sliding) {
            sliding1 = choose(active[0], rule->sliding[0], rule->sliding[SECOND]);
            own.sliding = &sliding1;
        }
        if (rule->shift) {
            shift1 = choose(active[0], rule->shift[0], rule->shift[SECOND]);
            own.shift = &shift1;
        }
        if (rule->before) {
            for (int a = 0; a < 2; a++)
                before1[0][a] = choose(active[0], rule->before[0][a], rule->before[SECOND][a]);
            own.before = (const lanes(*)[2])before1;
        }
        for (int a = 0; a < 2; a++) {
            uf1[a] = choose(active[0], uf[0][a], uf[SECOND][a]);
            for (int b = 0; b < 2; b++)
                D1[a][b] = choose(active[0], D[0][0][a][b], D[SECOND][SECOND][a][b]);
        }
        solve_one(&own, (const lanes(*)[2])D1, uf1, one, alone, ambiguous, unsolved);
        for (int a = 0; a < 2; a++)
            for (int c = 0; c < SCENE_CONTACTS; c++)
                r[c][a] = choose(one & active[c], alone[a], r[c][a]);
    }
    if (SCENE_CONTACTS > 1 && mask_any(both)) {
        lanes pair[2][2];
        for (int c = 0; c < 2; c++)
            pair[c][0] = pair[c][1] = none;
        solve_two(rule, D, uf, both, pair, ambiguous, unsolved);
        for (int c = 0; c < SCENE_CONTACTS; c++)
            for (int a = 0; a < 2; a++)
                r[c][a] = choose(both, pair[c][a], r[c][a]);
    }
}

#endif
