/* direct.h - contact problems solved where the solution is certainly the one that is wanted; what
 * is left is left to lane.h and, of more than four elements, to crowd.h.
 *
 * One point. With D_N+- = D_NN +- mu D_NT > 0, D_NN > 0 and det D > 0 - whatever else D is - the
 * problem of contact.h has exactly one solution: uf_N >= 0: open. Slip with r_N > 0 would need uf_N
 * < 0, and sticking 0 = u_N >= uf_N + D_N r_N, of D_N the smaller, the same; uf_N < 0: u_N = 0
 * makes u_T a function of r_T with slope det D / D_NN > 0 on the interval of |r_T| <= mu r_N: it
 * sticks where u_T = 0 is reached inside, else it slips at that end of the interval beyond which
 * the sticking impulse lies.
 *
 * All stick. What stood still in the step before, all of it, goes on standing as long as the
 * impulses that takes lie in the cones, whatever else would satisfy the laws: what stands has no
 * decision to take. It is also the solution with the least kinetic energy, whatever came before:
 * r.uf + r.D r / 2 has its minimum over all r at D r = -uf. (D of a Newton iteration is not quite
 * symmetric; the minimum is that of its symmetric part, to O(h).)
 *
 * A mode of all contacts that obeys the laws is the solution where there is but one
 * (direct_unique). The mode of the last iterate is tried, then that which each contact's impulse
 * and velocity point to.
 */
#ifndef STANCE_CORE_CONTACT_DIRECT_H
#define STANCE_CORE_CONTACT_DIRECT_H

#include "crowd.h"

#define DIRECT_ENUMERATED 4 /* elements: more are not enumerated */
#define DIRECT_ROUNDS 6     /* modes that are tried */
#define DIRECT_VERGE 1e3    /* tolerances: a mode is this near to a solution, or is none */
#define DIRECT_RIDGE 1e-7   /* of the tangential diagonal, so that redundant contacts are regular */

/* ---- one point ------------------------------------------------------------------------------- */

/* Sliding: NULL or as in contact_rule, of this contact. Returns the lanes where r is certainly the
 * one solution. */
HOT mask direct_one(const lanes D[2][2], const lanes uf[2], lanes friction, const lanes *sliding,
                    lanes r[2])
{
    const lanes none = lanes_of(0), across = friction * lanes_abs(D[0][1]);
    const lanes product = D[0][0] * D[1][1];
    const lanes determinant = lanes_fnma(D[0][1], D[1][0], product);
    const mask sure = mask_less(across, (1 - CONTACT_REGULAR) * D[0][0]) &
                      mask_less(CONTACT_REGULAR * lanes_abs(product), determinant);
    const lanes reciprocal = 1 / determinant;
    const lanes stick[2] = {lanes_fms(D[0][1], uf[1], D[1][1] * uf[0]) * reciprocal,
                            lanes_fms(D[1][0], uf[0], D[0][0] * uf[1]) * reciprocal};
    const mask open = mask_less_equal(none, uf[0]);
    mask slips = LANES_NOT(contact_inside(friction, stick[0], stick[1]));
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

/* ---- all stick ------------------------------------------------------------------------------- */

/* Rows of all contacts that are active. */
HOT void direct_rows(const mask *active, mask (*rows)[2])
{
    mask all[CONTACTS];
    EACH (c, 0, SCENE_CONTACTS)
        all[c] = LANES_ALL;
    contact_mode_rows(active, all, rows);
}

/* Lanes where all active contacts stood, as `before` tells. */
HOT mask direct_stood(const struct contact_rule *rule, contact_set touching, const mask *active)
{
    mask stood = rule->before ? LANES_ALL : MASK_NONE;
    for (int c = 0; c < SCENE_CONTACTS && rule->before; c++) {
        if (!(touching >> c & 1))
            continue;
        mask stands = mask_less(lanes_of(0), rule->before[c][0]);
        if (contact_is_point(c))
            stands = contact_stands(rule->friction, rule->before[c][0], rule->before[c][1]);
        stood &= LANES_NOT(active[c]) | stands;
        if (contact_unknowns(c) == 2 && !contact_is_point(c))
            stood &=
                LANES_NOT(contact_part(c, active)) |
                contact_stands(rule->friction, contact_load(c, rule->before), rule->before[c][1]);
    }
    return stood;
}

/* Lanes where impulses r of active contacts are in the cones. */
HOT mask direct_obeys(lanes friction, contact_set touching, const lanes (*r)[2])
{
    mask inside = LANES_ALL;
    EACH (c, 0, SCENE_CONTACTS) {
        if (!(touching >> c & 1))
            continue;
        inside &= mask_less_equal(lanes_of(0), r[c][0]);
        if (contact_unknowns(c) == 2)
            inside &= contact_inside(friction, contact_load(c, r), r[c][1]);
    }
    return inside;
}

/* Impulses with which all active contacts stick; returns the lanes where they are in the cones, and
 * the operator is regular. */
HOT mask direct_stick(const struct contact_rule *rule, const lanes (*D)[CONTACTS][2][2],
                      const lanes (*uf)[2], contact_set touching, const mask *active, lanes (*r)[2])
{
    mask rows[CONTACTS][2];
    direct_rows(active, rows);
    const mask regular =
        contact_rest(touching, CONTACT_PLAIN, D, uf, (const mask(*)[2])rows, NULL, r);
    return regular & direct_obeys(rule->friction, touching, (const lanes(*)[2])r);
}

/* Velocities with the impulses r of contacts in `touching`, of others zero. */
HOT void direct_velocities(const lanes (*D)[CONTACTS][2][2], const lanes (*uf)[2],
                           contact_set touching, const lanes (*r)[2], lanes (*u)[2])
{
    EACH (c, 0, SCENE_CONTACTS)
        EACH (a, 0, 2) {
            u[c][a] = lanes_of(0);
            if (!(touching >> c & 1) || a >= contact_unknowns(c))
                continue;
            u[c][a] = uf[c][a];
            EACH (k, 0, SCENE_CONTACTS)
                EACH (b, 0, 2)
                    if (b < contact_unknowns(k) && (touching >> k & 1))
                        u[c][a] = lanes_fma(D[c][k][a][b], r[k][b], u[c][a]);
        }
}

/* Of what is rare: compiled once. As contact_matrix and contact_factor, whose arguments they take;
 * ridge: share of their diagonal that is added to tangential rows. */
COLD void direct_factor(contact_set touching, enum contact_care care,
                        const lanes (*D)[CONTACTS][2][2], const mask (*rows)[2], const lanes *edge,
                        double ridge, lanes (*M)[CONTACTS][2][2], struct contact_factors *f)
{
    contact_matrix(touching, D, rows, edge, M);
    for (int c = 0; c < SCENE_CONTACTS; c++)
        if (contact_unknowns(c) == 2 && touching >> c & 1)
            M[c][c][1][1] = (1 + ridge) * M[c][c][1][1];
    contact_factor(touching, care, M, f);
}

/* The unknowns x that bring the velocities u to rest in `rows`, zero in others. */
COLD void direct_back(contact_set touching, const mask (*rows)[2], const struct contact_factors *f,
                      const lanes (*u)[2], lanes (*x)[2])
{
    lanes part[CONTACTS][2];
    for (int c = 0; c < SCENE_CONTACTS; c++)
        for (int a = 0; a < 2; a++)
            part[c][a] = choose(rows[c][a], u[c][a], lanes_of(0));
    contact_back(touching, f, (const lanes(*)[2])part, x);
}

/* What can be exchanged between contacts in `rows` without any change of velocity: n with D n = 0,
 * from the blocks G that elimination has left. Returns the lanes where there is one such direction;
 * several: *many. */
static inline mask direct_redundant(contact_set touching, const lanes (*D)[CONTACTS][2][2],
                                    const mask (*rows)[2], const lanes (*G)[CONTACTS][2][2],
                                    const struct contact_factors *f, lanes (*n)[2], mask *many)
{
    mask any = MASK_NONE;
    *many = MASK_NONE;
    for (int p = SCENE_CONTACTS - 1; p >= 0; p--) {
        const lanes(*const g)[2] = G[p][p];
        lanes own[2], null[2] = {lanes_of(1), lanes_of(0)};
        n[p][0] = n[p][1] = lanes_of(0);
        if (!(touching >> p & 1))
            continue;
        for (int a = 0; a < 2; a++)
            own[a] = choose(rows[p][a], lanes_abs(D[p][p][a][a]), lanes_of(1));
        lanes left = g[0][0], whole = own[0];
        if (contact_unknowns(p) == 2) {
            const mask first = mask_less_equal(lanes_abs(g[1][1]), lanes_abs(g[0][0]));
            const lanes larger = choose(first, g[0][0], g[1][1]);
            left = lanes_fnma(g[0][1], g[1][0], g[0][0] * g[1][1]);
            whole = own[0] * own[1];
            null[0] = choose(first, -g[0][1], g[1][1]);
            null[1] = choose(first, g[0][0], -g[1][0]);
            *many |=
                mask_less_equal(lanes_abs(larger), LANE_PARALLEL * choose(first, own[0], own[1]));
        }
        const mask here = mask_less_equal(lanes_abs(left), LANE_PARALLEL * whole);
        *many |= any & here;
        any |= here;
        for (int a = 0; a < contact_unknowns(p); a++) {
            n[p][a] = choose(here, null[a], lanes_of(0));
            for (int k = p + 1; k < SCENE_CONTACTS; k++)
                if (touching >> k & 1)
                    n[p][a] = contact_row(k, f->push[p][k][a], n[k], n[p][a]);
        }
    }
    return any & LANES_NOT(*many);
}

/* How far r lies from the middle of what the laws admit along n: see lane_share. */
static inline lanes direct_middle(lanes friction, contact_set touching, const lanes (*n)[2],
                                  const lanes (*r)[2])
{
    const lanes none = lanes_of(0);
    lanes low = lanes_of(-INFINITY), high = lanes_of(INFINITY);
    for (int c = 0; c < SCENE_CONTACTS; c++)
        for (int side = -1; side <= 1 && touching >> c & 1; side++) {
            lanes room = r[c][0], rate = n[c][0];
            if (side == 0 ? contact_is_point(c) : contact_unknowns(c) == 1)
                continue;
            if (side != 0) {
                room = lanes_fma(friction, contact_load(c, r), side * r[c][1]);
                rate = lanes_fma(friction, contact_load(c, n), side * n[c][1]);
            }
            const lanes edge = -room / rate;
            low = choose(mask_less(none, rate), lanes_max(edge, low), low);
            high = choose(mask_less(rate, none), lanes_min(edge, high), high);
        }
    const lanes middle = 0.5 * (low + high);
    return choose(mask_less_equal(low, high) & mask_finite(middle), middle, none);
}

/* As lane_hold, in lanes, but where there are several redundancies: impulses with which all active
 * contacts stick, whatever the operator, and the lanes where they obey the laws. */
COLD mask direct_hold(lanes friction, lanes tolerance, const lanes (*D)[CONTACTS][2][2],
                      const lanes (*uf)[2], contact_set touching, const mask *active, lanes (*r)[2])
{
    const lanes none = lanes_of(0);
    struct contact_factors f;
    mask rows[CONTACTS][2], many, good = LANES_ALL;
    lanes M[CONTACTS][CONTACTS][2][2], n[CONTACTS][2], u[CONTACTS][2], x[CONTACTS][2];
    direct_rows(active, rows);
    direct_factor(touching, CONTACT_CAREFUL, D, (const mask(*)[2])rows, NULL, 0, M, &f);
    const mask shared = direct_redundant(touching, D, (const mask(*)[2])rows,
                                         (const lanes(*)[CONTACTS][2][2])M, &f, n, &many);
    for (int c = 0; c < SCENE_CONTACTS; c++)
        for (int a = 0; a < 2; a++)
            r[c][a] = none;
    for (int round = 0; round < 2; round++) { /* once more with what is left */
        direct_velocities(D, uf, touching, (const lanes(*)[2])r, u);
        direct_back(touching, (const mask(*)[2])rows, &f, (const lanes(*)[2])u, x);
        for (int c = 0; c < SCENE_CONTACTS; c++)
            for (int a = 0; a < 2; a++)
                r[c][a] = r[c][a] + x[c][a];
    }
    if (mask_any(shared)) {
        const lanes by =
            direct_middle(friction, touching, (const lanes(*)[2])n, (const lanes(*)[2])r);
        mask moves = shared;
        for (int c = 0; c < SCENE_CONTACTS; c++)
            x[c][0] = x[c][1] = none;
        direct_velocities(D, (const lanes(*)[2])x, touching, (const lanes(*)[2])n, u);
        for (int c = 0; c < SCENE_CONTACTS; c++)
            for (int a = 0; a < 2; a++)
                moves &= LANES_NOT(rows[c][a]) |
                         mask_less_equal(lanes_abs(by * u[c][a]), 0.25 * tolerance);
        for (int c = 0; c < SCENE_CONTACTS; c++)
            for (int a = 0; a < 2; a++)
                r[c][a] = choose(moves, lanes_fma(by, n[c][a], r[c][a]), r[c][a]);
    }
    direct_velocities(D, uf, touching, (const lanes(*)[2])r, u);
    for (int c = 0; c < SCENE_CONTACTS; c++)
        for (int a = 0; a < 2; a++)
            good &= LANES_NOT(rows[c][a]) | mask_less_equal(lanes_abs(u[c][a]), tolerance);
    return good & LANES_NOT(many) & direct_obeys(friction, touching, (const lanes(*)[2])r);
}

/* ---- one mode of all ------------------------------------------------------------------------- */

/* Lanes where there is certainly one solution at most, whatever the velocities, the signs of slips
 * that go on and the restitution.
 *
 * Two solutions differ by d, dr . du = d . D d <= mu sum over grips |d_N| |du_T|, d_N the sum over
 * a grip's normal impulses. With Q the Schur complement D_NN - D_NT D_TT^-1 D_TN the left side is
 * d_N . Q d_N + du_T . D_TT^-1 du_T, so that du = 0 where mu^2 l(Q^-1 / t) l(t D_TT) < 4, l the
 * largest eigenvalue and t any positive scale of the grips. By row sums, with the best t: mu^2 max
 * over grips of (row sum of |Q^-1|) (row sum of |D_TT|) < 4. The rows of D_TT need not be
 * independent. */
COLD mask direct_unique(lanes friction, const lanes (*D)[CONTACTS][2][2], contact_set touching,
                        const mask *active)
{
    struct contact_factors f;
    mask rows[CONTACTS][2];
    lanes M[CONTACTS][CONTACTS][2][2], u[CONTACTS][2], x[CONTACTS][2], sum[CONTACTS];
    direct_rows(active, rows);
    direct_factor(touching, CONTACT_GUARDED, D, (const mask(*)[2])rows, NULL, DIRECT_RIDGE, M, &f);
    for (int c = 0; c < SCENE_CONTACTS; c++)
        sum[c] = lanes_of(0);
    lanes largest = lanes_of(0);
    for (int h = 0; h < SCENE_CONTACTS; h++) {
        if (!(touching >> h & 1) || contact_unknowns(h) != 2)
            continue;
        for (int c = 0; c < SCENE_CONTACTS; c++) {
            u[c][0] = lanes_of(contact_grip(c) == h ? -1 : 0);
            u[c][1] = lanes_of(0);
        }
        direct_back(touching, (const mask(*)[2])rows, &f, (const lanes(*)[2])u, x);
        for (int g = 0; g < SCENE_CONTACTS; g++)
            if (touching >> g & 1 && contact_unknowns(g) == 2)
                sum[g] += lanes_abs(contact_load(g, (const lanes(*)[2])x));
    }
    for (int g = 0; g < SCENE_CONTACTS; g++) {
        lanes row = lanes_of(0);
        if (!(touching >> g & 1) || contact_unknowns(g) != 2)
            continue;
        for (int h = 0; h < SCENE_CONTACTS; h++)
            if (touching >> h & 1 && contact_unknowns(h) == 2)
                row += choose(rows[g][1] & rows[h][1], lanes_abs(D[g][h][1][1]), lanes_of(0));
        largest = lanes_max(sum[g] * row, largest);
    }
    return f.regular & mask_less(friction * (friction * largest), lanes_of(4));
}

/* Largest violation of a law by the impulses r with the velocities u of active contacts. */
HOT lanes direct_violation(const struct contact_rule *rule, const lanes (*D)[CONTACTS][2][2],
                           contact_set touching, const mask *active, const lanes (*r)[2],
                           const lanes (*u)[2])
{
    const lanes none = lanes_of(0);
    lanes worst = none;
    for (int c = 0; c < SCENE_CONTACTS; c++) {
        if (!(touching >> c & 1))
            continue;
        const lanes pushes = r[c][0] * lanes_abs(D[c][c][0][0]);
        lanes off = lanes_max(-u[c][0], -pushes);
        off = lanes_max(lanes_min(lanes_abs(u[c][0]), lanes_abs(pushes)), off);
        worst = lanes_max(choose(active[c], off, none), worst);
        if (contact_unknowns(c) == 1)
            continue;
        const lanes scale = lanes_abs(D[c][c][1][1]);
        const lanes bound = rule->friction * contact_load(c, r);
        lanes slip = u[c][1];
        if (rule->sliding)
            slip = choose(mask_less(none, lanes_abs(rule->sliding[c])),
                          LANE_ENDLESS * rule->sliding[c], slip);
        const lanes room = choose(mask_less(slip, none), bound - r[c][1], bound + r[c][1]);
        off = lanes_max(lanes_min(lanes_abs(slip), room * scale),
                        (lanes_abs(r[c][1]) - bound) * scale);
        worst = lanes_max(choose(contact_part(c, active), off, none), worst);
    }
    return worst;
}

/* A solution in the lanes of m, exactly inside the cones, as lane_clip does it: over a very short
 * time all impulses are as small as the tolerance. */
static inline void direct_take(lanes friction, contact_set touching, const lanes (*solution)[2],
                               mask m, lanes (*r)[2])
{
    for (int c = 0; c < SCENE_CONTACTS; c++)
        if (touching >> c & 1)
            r[c][0] = choose(m, lanes_max(solution[c][0], lanes_of(0)), r[c][0]);
    for (int c = 0; c < SCENE_CONTACTS; c++) {
        if (!(touching >> c & 1) || contact_unknowns(c) == 1)
            continue;
        const lanes bound = friction * contact_load(c, (const lanes(*)[2])r);
        r[c][1] = choose(m, lanes_max(lanes_min(solution[c][1], bound), -bound), r[c][1]);
    }
}

/* Tries modes in the lanes of `todo`, where a solution is the only one: r. Returns the lanes where
 * one was found. */
COLD mask direct_modes(const struct contact_rule *rule, const lanes (*D)[CONTACTS][2][2],
                       const lanes (*uf)[2], contact_set touching, const mask *active,
                       lanes tolerance, mask todo, lanes (*r)[2])
{
    const lanes none = lanes_of(0), friction = rule->friction;
    mask closed[CONTACTS], sticks[CONTACTS], rows[CONTACTS][2], found = MASK_NONE;
    lanes edge[CONTACTS];
    for (int c = 0; c < SCENE_CONTACTS; c++) {
        closed[c] = active[c];
        sticks[c] = LANES_ALL;
        edge[c] = none;
        if (rule->last) {
            const lanes load = contact_load(c, rule->last);
            closed[c] &= mask_less(none, rule->last[c][0]);
            sticks[c] = contact_stands(friction, load, rule->last[c][1]);
            edge[c] = choose(mask_less(rule->last[c][1], none), -friction, friction);
        }
        if (rule->sliding) {
            const mask slides = mask_less(none, lanes_abs(rule->sliding[c]));
            sticks[c] &= LANES_NOT(slides);
            edge[c] = choose(slides, -(friction * rule->sliding[c]), edge[c]);
        }
        edge[c] = choose(sticks[c], none, edge[c]);
    }
    for (int round = 0; round < DIRECT_ROUNDS && mask_any(todo); round++) {
        struct contact_factors f;
        lanes M[CONTACTS][CONTACTS][2][2], candidate[CONTACTS][2], u[CONTACTS][2];
        contact_mode_rows(closed, sticks, rows);
        direct_factor(touching, CONTACT_CAREFUL, D, (const mask(*)[2])rows, edge, 0, M, &f);
        direct_back(touching, (const mask(*)[2])rows, &f, uf, candidate);
        for (int c = 0; c < SCENE_CONTACTS; c++)
            if (touching >> c & 1 && contact_unknowns(c) == 2)
                candidate[c][1] = lanes_fma(edge[c], contact_load(c, (const lanes(*)[2])candidate),
                                            candidate[c][1]);
        direct_velocities(D, uf, touching, (const lanes(*)[2])candidate, u);
        const lanes violation = direct_violation(
            rule, D, touching, active, (const lanes(*)[2])candidate, (const lanes(*)[2])u);
        const mask good = todo & mask_less_equal(violation, tolerance);
        found |= good;
        todo &= LANES_NOT(good);
        direct_take(friction, touching, (const lanes(*)[2])candidate, good, r);
        for (int c = 0; c < SCENE_CONTACTS; c++) {
            if (!(touching >> c & 1))
                continue;
            const mask carries = closed[c] & mask_less(none, candidate[c][0]);
            closed[c] = carries | (active[c] & LANES_NOT(closed[c]) & mask_less(u[c][0], none));
            if (contact_unknowns(c) == 1)
                continue;
            /* A grip that slips sticks when its slip is with its friction; one that sticks slips
             * when it leaves the cone. */
            const lanes tangential = candidate[c][1];
            const lanes load = contact_load(c, (const lanes(*)[2])candidate);
            const mask turns = mask_less(none, edge[c] * u[c][1]);
            const mask leaves = sticks[c] & LANES_NOT(contact_inside(friction, load, tangential)) &
                                mask_less(none, load);
            mask slips = leaves | (LANES_NOT(sticks[c]) & LANES_NOT(turns));
            const lanes side = choose(mask_less(tangential, none), -friction, friction);
            edge[c] = choose(slips, choose(leaves, side, edge[c]), none);
            if (rule->sliding) {
                const mask slides = mask_less(none, lanes_abs(rule->sliding[c]));
                slips |= slides;
                edge[c] = choose(slides, -(friction * rule->sliding[c]), edge[c]);
            }
            sticks[c] = LANES_NOT(slips);
        }
    }
    return found;
}

/* ---- every mode of two points ---------------------------------------------------------------- */

/* The best solution so far, as in lane.h. */
struct direct_choice {
    lanes r[CONTACTS][2], u[CONTACTS][2], energy;
    mask have, ambiguous;
};

/* Takes r with the velocities u, where it is `valid` and better than the choice. */
static inline void direct_offer(const struct contact_rule *rule, const lanes (*uf)[2],
                                lanes tolerance, contact_set touching, const mask *active,
                                const lanes (*r)[2], const lanes (*u)[2], mask valid,
                                struct direct_choice *best)
{
    const lanes none = lanes_of(0);
    lanes energy = none, apart = none;
    for (int c = 0; c < SCENE_CONTACTS; c++)
        for (int a = 0; a < 2 && touching >> c & 1; a++) {
            lanes own = 0.5 * (r[c][a] * (uf[c][a] + u[c][a]));
            if (rule->shift)
                own -= r[c][a] * rule->shift[c][a];
            if (rule->indefinite)
                own = choose(mask_less(none, r[c][0]), lanes_of(-0.5), none);
            energy += choose(active[c], own, none);
            apart = lanes_max(choose(active[c], lanes_abs(u[c][a] - best->u[c][a]), none), apart);
        }
    if (!rule->indefinite)
        energy = rule->prefer * energy;
    const lanes tie = 1e-12 * (lanes_abs(energy) + lanes_abs(best->energy));
    const mask other = valid & best->have & mask_less(16 * tolerance, apart);
    const mask take =
        (valid & LANES_NOT(best->have)) | (other & mask_less(energy, best->energy - tie));
    best->ambiguous |= other;
    best->have |= valid;
    best->energy = choose(take, energy, best->energy);
    for (int c = 0; c < SCENE_CONTACTS; c++)
        for (int a = 0; a < 2; a++) {
            best->r[c][a] = choose(take, r[c][a], best->r[c][a]);
            best->u[c][a] = choose(take, u[c][a], best->u[c][a]);
        }
}

/* As lane_enumerate, in lanes, where the contacts in `touching` are two points, first and second.
 * Impulses r in the lanes that are returned, *ambiguous among them; elsewhere a mode is on the
 * verge of a solution, or there is none. */
COLD mask direct_pair(const struct contact_rule *rule, const lanes (*D)[CONTACTS][2][2],
                      const lanes (*uf)[2], contact_set touching, int first, int second,
                      const mask *active, lanes tolerance, mask todo, lanes (*r)[2],
                      mask *ambiguous)
{
    enum { OPEN, STICK, FORWARD, BACKWARD, MODES };
    const lanes none = lanes_of(0);
    struct direct_choice best = {.have = MASK_NONE, .ambiguous = MASK_NONE, .energy = none};
    lanes candidate[CONTACTS][2], u[CONTACTS][2], edge[CONTACTS];
    mask verge = MASK_NONE, never[CONTACTS][MODES], closed[CONTACTS], sticks[CONTACTS];
    for (int c = 0; c < SCENE_CONTACTS; c++) {
        closed[c] = sticks[c] = MASK_NONE;
        edge[c] = none;
        for (int a = 0; a < 2; a++)
            best.r[c][a] = best.u[c][a] = candidate[c][a] = none;
        never[c][OPEN] = MASK_NONE;
        never[c][STICK] = never[c][FORWARD] = never[c][BACKWARD] = LANES_NOT(active[c]);
        if (rule->sliding) {
            const lanes slide = rule->sliding[c];
            never[c][STICK] |= mask_less(none, lanes_abs(slide));
            never[c][FORWARD] |= mask_less(slide, none);
            never[c][BACKWARD] |= mask_less(none, slide);
        }
    }
    const mask holds = direct_hold(rule->friction, tolerance, D, uf, touching, active, candidate) &
                       LANES_NOT(never[first][STICK] | never[second][STICK]);
    direct_velocities(D, uf, touching, (const lanes(*)[2])candidate, u);
    direct_offer(rule, uf, tolerance, touching, active, (const lanes(*)[2])candidate,
                 (const lanes(*)[2])u, todo & holds, &best);
    for (int mode = 0; mode < MODES * MODES; mode++) {
        const int of[2] = {mode / MODES, mode % MODES}, point[2] = {first, second};
        const mask may = todo & LANES_NOT(never[first][of[0]] | never[second][of[1]]);
        if ((of[0] == STICK && of[1] == STICK) || !mask_any(may))
            continue;
        for (int k = 0; k < 2; k++) {
            closed[point[k]] = of[k] == OPEN ? MASK_NONE : active[point[k]];
            sticks[point[k]] = of[k] == STICK ? LANES_ALL : MASK_NONE;
            edge[point[k]] = rule->friction * (of[k] == FORWARD ? -1 : of[k] == BACKWARD ? 1 : 0);
        }
        struct contact_factors f;
        mask rows[CONTACTS][2];
        lanes M[CONTACTS][CONTACTS][2][2];
        contact_mode_rows(closed, sticks, rows);
        direct_factor(touching, CONTACT_PLAIN, D, (const mask(*)[2])rows, edge, 0, M, &f);
        for (int c = 0; c < SCENE_CONTACTS; c++)
            for (int a = 0; a < 2; a++)
                candidate[c][a] = none, u[c][a] = uf[c][a];
        for (int round = 0; round < 2; round++) { /* once more with what is left */
            lanes x[CONTACTS][2];
            direct_back(touching, (const mask(*)[2])rows, &f, (const lanes(*)[2])u, x);
            for (int k = 0; k < 2; k++) {
                const int c = point[k];
                candidate[c][0] = candidate[c][0] + x[c][0];
                candidate[c][1] = candidate[c][1] + lanes_fma(edge[c], x[c][0], x[c][1]);
            }
            direct_velocities(D, uf, touching, (const lanes(*)[2])candidate, u);
        }
        const lanes violation = direct_violation(
            rule, D, touching, active, (const lanes(*)[2])candidate, (const lanes(*)[2])u);
        lanes sum =
            none; /* not finite where the mode is singular, of which violation says nothing */
        for (int k = 0; k < 2; k++)
            for (int a = 0; a < 2; a++)
                sum += candidate[point[k]][a] + u[point[k]][a];
        const mask regular = may & mask_finite(sum);
        const mask valid = regular & mask_less_equal(violation, tolerance);
        verge |= regular & LANES_NOT(valid) & mask_less_equal(violation, DIRECT_VERGE * tolerance);
        direct_offer(rule, uf, tolerance, touching, active, (const lanes(*)[2])candidate,
                     (const lanes(*)[2])u, valid, &best);
    }
    const mask done = todo & best.have & LANES_NOT(verge);
    *ambiguous = done & best.ambiguous;
    direct_take(rule->friction, touching, (const lanes(*)[2])best.r, done, r);
    return done;
}

/* The same in the lanes where two points are active and no other contact is: whatever else is in
 * `touching`, for other lanes. */
static inline mask direct_pairs(const struct contact_rule *rule, const lanes (*D)[CONTACTS][2][2],
                                const lanes (*uf)[2], contact_set touching, const mask *active,
                                lanes tolerance, mask todo, lanes (*r)[2], mask *ambiguous)
{
    mask done = MASK_NONE;
    for (int a = 0; a < SCENE_CONTACTS; a++)
        for (int b = a + 1; b < SCENE_CONTACTS; b++) {
            if (!(touching >> a & touching >> b & 1) || !contact_is_point(a) ||
                !contact_is_point(b))
                continue;
            mask both = todo & active[a] & active[b], several;
            for (int c = 0; c < SCENE_CONTACTS; c++)
                if (c != a && c != b && touching >> c & 1)
                    both &= LANES_NOT(active[c]);
            if (!mask_any(both))
                continue;
            done |= direct_pair(rule, D, uf, 1u << a | 1u << b, a, b, active, tolerance, both, r,
                                &several);
            *ambiguous |= several;
        }
    return done;
}

/* ---- all of it ------------------------------------------------------------------------------- */

/* What is not decided in the hot loop, in the lanes of `unsure`. */
COLD void solve_rest(const struct contact_rule *rule, const lanes (*D)[CONTACTS][2][2],
                     const lanes (*uf)[2], contact_set touching, const mask *active, mask unsure,
                     lanes (*r)[2], struct contact_verdict *v)
{
    const lanes none = lanes_of(0);
    lanes stick[CONTACTS][2], scale = lanes_of(1);
    for (int c = 0; c < SCENE_CONTACTS; c++)
        for (int a = 0; a < contact_unknowns(c) && touching >> c & 1; a++)
            scale = lanes_max(choose(active[c], lanes_abs(uf[c][a]), none), scale);
    const lanes tolerance = CONTACT_TOLERANCE * scale;
    const mask stood = unsure & direct_stood(rule, touching, active);
    mask done = MASK_NONE;
    if (mask_any(stood)) {
        done = stood & direct_hold(rule->friction, tolerance, D, uf, touching, active, stick);
        for (int c = 0; c < SCENE_CONTACTS; c++)
            for (int a = 0; a < 2; a++)
                r[c][a] = choose(done, stick[c][a], r[c][a]);
    }
    if (!rule->indefinite && mask_any(unsure & LANES_NOT(done))) {
        const mask todo =
            unsure & LANES_NOT(done) & direct_unique(rule->friction, D, touching, active);
        if (mask_any(todo))
            done |= direct_modes(rule, D, uf, touching, active, tolerance, todo, r);
    }
    mask left = unsure & LANES_NOT(done);
    left &= LANES_NOT(direct_pairs(rule, D, uf, touching, active, tolerance,
                                   left & LANES_NOT(stood), r, &v->ambiguous));
    for (int lane = 0; lane < LANES && mask_any(left); lane++) {
        if (!mask_get(left, lane))
            continue;
        struct lane_problem p;
        struct lane_choice best;
        contact_set here = 0;
        for (int c = 0; c < SCENE_CONTACTS; c++)
            here |= touching >> c & 1 && mask_get(active[c], lane) ? 1u << c : 0;
        lane_gather(rule, D, uf, here, lane, &p);
        lane_choose_none(&best);
        if ((mask_get(stood, lane) ||
             (p.elements > DIRECT_ENUMERATED && lane_stick_is_least(&p))) &&
            lane_hold(&p, best.r)) {
            best.violation = 0;
        } else if (p.elements <= DIRECT_ENUMERATED) {
            lane_enumerate(&p, &best);
        } else {
            crowd_solve(&p, &best);
            v->unranked |= mask_of_lane(lane);
        }
        lane_clip(&p, best.r);
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
    EACH (c, 0, SCENE_CONTACTS) {
        r[c][0] = r[c][1] = none;
        if (!(touching >> c & 1))
            continue;
        many |= active[c] & any;
        if (!contact_is_point(c))
            many |= active[c];
        any |= active[c];
    }
    const mask one = any & LANES_NOT(many); /* one point */
    const contact_set points = touching;
    if (points && (points & (points - 1)) == 0 && !mask_any(many)) { /* no stop */
        EACH (c, 0, SCENE_CONTACTS) {
            if (!(touching >> c & 1) || !contact_is_point(c))
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
            EACH (c, 0, SCENE_CONTACTS) {
                if (!(touching >> c & 1) || !contact_is_point(c))
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
            EACH (c, 0, SCENE_CONTACTS)
                EACH (a, 0, 2)
                    if (a < 2 && (contact_is_point(c) && touching >> c & 1))
                        r[c][a] = choose(one & active[c], alone[a], r[c][a]);
        }
        if (mask_any(many)) {
            lanes all[CONTACTS][2];
            const mask stays = many & direct_stick(rule, D, uf, touching, active, all) &
                               direct_stood(rule, touching, active);
            unsure |= many & LANES_NOT(stays);
            EACH (c, 0, SCENE_CONTACTS)
                EACH (a, 0, 2)
                    if (a < contact_unknowns(c) && (touching >> c & 1))
                        r[c][a] = choose(stays, all[c][a], r[c][a]);
        }
    }
    unsure &= where;
    if (!mask_any(unsure))
        return;
    /* With copies: what is passed on by address stays in memory. */
    struct contact_rule own = *rule;
    lanes D1[CONTACTS][CONTACTS][2][2], uf1[CONTACTS][2], r1[CONTACTS][2];
    lanes sliding[CONTACTS], shift[CONTACTS][2], before[CONTACTS][2], last[CONTACTS][2];
    mask part[CONTACTS];
    struct contact_verdict verdict = *v;
    EACH (c, 0, SCENE_CONTACTS) {
        part[c] = touching >> c & 1 ? active[c] : MASK_NONE;
        sliding[c] = rule->sliding ? rule->sliding[c] : none;
        EACH (a, 0, 2) {
            r1[c][a] = r[c][a];
            shift[c][a] = rule->shift ? rule->shift[c][a] : none;
            before[c][a] = rule->before ? rule->before[c][a] : none;
            last[c][a] = rule->last ? rule->last[c][a] : none;
        }
        if (!(touching >> c & 1))
            continue;
        EACH (a, 0, 2)
            uf1[c][a] = uf[c][a];
        EACH (k, 0, SCENE_CONTACTS)
            if (touching >> k & 1)
                memcpy(D1[c][k], D[c][k], sizeof D1[c][k]);
    }
    own.sliding = rule->sliding ? sliding : NULL;
    own.shift = rule->shift ? (const lanes(*)[2])shift : NULL;
    own.before = rule->before ? (const lanes(*)[2])before : NULL;
    own.last = rule->last ? (const lanes(*)[2])last : NULL;
    solve_rest(&own, (const lanes(*)[CONTACTS][2][2])D1, (const lanes(*)[2])uf1, touching, part,
               unsure, r1, &verdict);
    EACH (c, 0, SCENE_CONTACTS)
        EACH (a, 0, 2)
            r[c][a] = r1[c][a];
    *v = verdict;
}

#endif
