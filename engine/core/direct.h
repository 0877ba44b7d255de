/* direct.h - contact problems that have one solution only, solved without trying every mode.
 *
 * One contact. With D_N+- = D_NN +- mu D_NT > 0, D_NN > 0 and det D > 0 the problem of contact.h
 * has exactly one solution: uf_N >= 0: open. Slip with r_N > 0 would need uf_N < 0, and sticking 0
 * = u_N >= uf_N + D_N r_N, of D_N the smaller, the same; uf_N < 0: u_N = 0 makes u_T a function of
 * r_T with slope det D / D_NN > 0 on the interval of |r_T| <= mu r_N: it sticks where u_T = 0 is
 * reached inside, else it slips at that end of the interval beyond which the sticking impulse lies.
 *
 * Two contacts. In each of contact 0's four modes what is left is a problem of contact 1 alone,
 * with an operator that is not symmetric; where that one is certainly unique, too, four candidates
 * remain for the law of contact 0 to judge. Where just one of them is admitted, it is the solution.
 *
 * Lanes where that is not so are left to contact.h.
 */
#ifndef STANCE_CORE_DIRECT_H
#define STANCE_CORE_DIRECT_H

#include "contact.h"
#include "sizes.h"

/* Contacts that matter in any lane: bit c. What an open contact would do costs nothing. */
typedef unsigned contact_set;

#define DIRECT_REGULAR                                                                             \
    1e-9 /* of the largest it can be: a pivot this small is left to contact.h                      \
          */

/* Sliding: NULL or as in contact_problem, of this contact. Returns the lanes where r is certainly
 * the one solution. */
HOT mask direct_one(const lanes D[2][2], const lanes uf[2], lanes friction, const lanes *sliding,
                    lanes r[2])
{
    const lanes none = lanes_of(0), across = friction * lanes_abs(D[0][1]);
    const lanes product = D[0][0] * D[1][1];
    const lanes determinant = lanes_fnma(D[0][1], D[1][0], product);
    const mask sure = mask_less(across, (1 - DIRECT_REGULAR) * D[0][0]) &
                      mask_less(DIRECT_REGULAR * lanes_abs(product), determinant);
    const lanes reciprocal = 1 / determinant;
    const lanes normal = lanes_fms(D[0][1], uf[1], D[1][1] * uf[0]) * reciprocal;
    const lanes tangential = lanes_fms(D[1][0], uf[0], D[0][0] * uf[1]) * reciprocal;
    const mask open = mask_less_equal(none, uf[0]);
    mask slips = LANES_NOT(mask_less_equal(lanes_abs(tangential), friction * normal));
    r[0] = choose(open, none, normal);
    r[1] = choose(open, none, tangential);
    lanes edge = choose(mask_less(tangential, none), -friction, friction);
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

/* The same for two contacts; `tolerance` as in contact_problem, `sliding` of both. */
HOT mask direct_two(const lanes D[2][2][2][2], const lanes uf[2][2], lanes friction,
                    const lanes *sliding, lanes tolerance, lanes r[2][2])
{
    const lanes product = D[0][0][0][0] * D[0][0][1][1];
    const lanes determinant = lanes_fnma(D[0][0][0][1], D[0][0][1][0], product);
    mask sure =
        mask_less(DIRECT_REGULAR * lanes_abs(product), determinant) &
        mask_less(friction * lanes_abs(D[0][0][0][1]), (1 - DIRECT_REGULAR) * D[0][0][0][0]);
    mask found = MASK_NONE;
    for (int c = 0; c < 2; c++)
        r[c][0] = r[c][1] = lanes_of(0);
    for (enum contact_mode mode = CONTACT_OPEN; mode < CONTACT_MODES; mode++) {
        struct direct_part part;
        lanes D1[2][2], uf1[2], candidate[2][2];
        if (mode != CONTACT_OPEN) {
            direct_part(mode, D, uf[0], friction, determinant, &part);
            direct_eliminate(D, uf, &part, D1, uf1);
        }
        sure &= direct_one(mode == CONTACT_OPEN ? D[1][1] : (const lanes(*)[2])D1,
                           mode == CONTACT_OPEN ? uf[1] : uf1, friction,
                           sliding ? &sliding[1] : NULL, candidate[1]);
        for (int a = 0; a < 2; a++)
            candidate[0][a] =
                mode == CONTACT_OPEN
                    ? lanes_of(0)
                    : lanes_fma(part.push[a][0], candidate[1][0],
                                lanes_fma(part.push[a][1], candidate[1][1], part.alone[a]));
        const lanes violation =
            direct_violation(mode, D, uf, friction, sliding, (const lanes(*)[2])candidate);
        const mask valid = mask_less_equal(violation, tolerance);
        sure &= LANES_NOT(valid & found);
        found |= valid;
        if (!mask_any(valid))
            continue;
        for (int c = 0; c < 2; c++)
            for (int a = 0; a < 2; a++)
                r[c][a] = choose(valid, candidate[c][a], r[c][a]);
    }
    return sure & found;
}

/* Impulses of one active contact: directly where that is certain. */
HOT void solve_one(lanes friction, const lanes D[2][2], const lanes uf[2], const lanes *sliding,
                   bool indefinite, mask active, lanes r[2], mask *ambiguous, mask *unsolved)
{
    mask unsure = active;
    if (!indefinite)
        unsure &= LANES_NOT(direct_one(D, uf, friction, sliding, r));
    if (!mask_any(unsure))
        return;
    contact_choice best;
    lanes problem[2][2][2][2], free[2][2]; /* their first blocks alone */
    memcpy(problem[0][0], D, sizeof problem[0][0]);
    memcpy(free[0], uf, sizeof free[0]);
    const lanes tolerance =
        CONTACT_TOLERANCE * lanes_max(lanes_max(lanes_abs(uf[0]), lanes_abs(uf[1])), lanes_of(1));
    contact_solve(&(contact_problem){(const lanes(*)[2][2][2])problem, (const lanes(*)[2])free,
                                     sliding, friction, tolerance, 1, indefinite},
                  &best);
    for (int a = 0; a < 2; a++)
        r[a] = choose(unsure, best.r[0][a], r[a]);
    *ambiguous |= unsure & best.ambiguous;
    *unsolved |= unsure & LANES_NOT(mask_less_equal(best.violation, 1e3 * tolerance));
}

/* The same for two. */
HOT void solve_two(lanes friction, const lanes D[2][2][2][2], const lanes uf[2][2],
                   const lanes *sliding, bool indefinite, mask active, lanes r[2][2],
                   mask *ambiguous, mask *unsolved)
{
    lanes scale = lanes_of(1);
    for (int c = 0; c < 2; c++)
        for (int a = 0; a < 2; a++)
            scale = lanes_max(lanes_abs(uf[c][a]), scale);
    const lanes tolerance = CONTACT_TOLERANCE * scale;
    mask unsure = active;
    if (!indefinite)
        unsure &= LANES_NOT(direct_two(D, uf, friction, sliding, tolerance, r));
    if (!mask_any(unsure))
        return;
    contact_choice best;
    contact_solve(&(contact_problem){D, uf, sliding, friction, tolerance, 2, indefinite}, &best);
    for (int c = 0; c < 2; c++)
        for (int a = 0; a < 2; a++)
            r[c][a] = choose(unsure, best.r[c][a], r[c][a]);
    *ambiguous |= unsure & best.ambiguous;
    *unsolved |= unsure & LANES_NOT(mask_less_equal(best.violation, 1e3 * tolerance));
}

/* Impulses of the active contacts for the linearised step; zero elsewhere. `sliding`: see
 * contact_problem. D and uf of the contacts in `touching`. */
HOT void solve_contacts(lanes friction, const lanes D[2][2][2][2], const lanes uf[2][2],
                        const lanes *sliding, bool indefinite, contact_set touching,
                        const mask *active, lanes r[2][2], mask *ambiguous, mask *unsolved)
{
    const lanes none = lanes_of(0);
    *ambiguous = *unsolved = MASK_NONE;
    for (int c = 0; c < SCENE_CONTACTS; c++)
        r[c][0] = r[c][1] = none;
    if (SCENE_CONTACTS == 1 || (touching & (touching - 1)) == 0) { /* one at most */
        const int c = touching == 1 ? 0 : SECOND;
        lanes alone[2] = {none, none};
        solve_one(friction, D[c][c], uf[c], sliding ? &sliding[c] : NULL, indefinite, active[c],
                  alone, ambiguous, unsolved);
        for (int a = 0; a < 2; a++)
            r[c][a] = choose(active[c], alone[a], none);
        return;
    }
    const mask both = active[0] & active[SECOND];
    const mask one = (active[0] | active[SECOND]) & LANES_NOT(both);
    if (mask_any(one)) {
        lanes D1[2][2], uf1[2], sliding1 = none, alone[2] = {none, none};
        if (sliding)
            sliding1 = choose(active[0], sliding[0], sliding[SECOND]);
        for (int a = 0; a < 2; a++) {
            uf1[a] = choose(active[0], uf[0][a], uf[SECOND][a]);
            for (int b = 0; b < 2; b++)
                D1[a][b] = choose(active[0], D[0][0][a][b], D[SECOND][SECOND][a][b]);
        }
        solve_one(friction, (const lanes(*)[2])D1, uf1, sliding ? &sliding1 : NULL, indefinite, one,
                  alone, ambiguous, unsolved);
        for (int a = 0; a < 2; a++)
            for (int c = 0; c < SCENE_CONTACTS; c++)
                r[c][a] = choose(one & active[c], alone[a], r[c][a]);
    }
    if (SCENE_CONTACTS > 1 && mask_any(both)) {
        lanes pair[2][2];
        for (int c = 0; c < 2; c++)
            pair[c][0] = pair[c][1] = none;
        solve_two(friction, D, uf, sliding, indefinite, both, pair, ambiguous, unsolved);
        for (int c = 0; c < SCENE_CONTACTS; c++)
            for (int a = 0; a < 2; a++)
                r[c][a] = choose(both, pair[c][a], r[c][a]);
    }
}

#endif
