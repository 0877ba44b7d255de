/* direct.h - contact problems solved where the solution is certainly the one that is wanted; what
 * is left is left to pair.h, lane.h and, of more than four elements, crowd.h: see solve.h.
 *
 * One point. With D_N+- = D_NN +- mu D_NT > 0, D_NN > 0 and det D > 0 - whatever else D is - the
 * problem of contact.h has exactly one solution: uf_N >= 0: open. Slip with r_N > 0 would need uf_N
 * < 0, and sticking 0 = u_N >= uf_N + D_N r_N, of D_N the smaller, the same; uf_N < 0: u_N = 0
 * makes u_T a function of r_T with slope det D / D_NN > 0 on the interval of |r_T| <= mu r_N: it
 * sticks where u_T = 0 is reached inside, else it slips at that end of the interval beyond which
 * the sticking impulse lies.
 *
 * The same mode. Several contacts that stood, slid and were open in the step or iterate before go
 * on so as long as that obeys the laws, whatever else would: motion is smooth between impacts, and
 * what goes on has no decision to take. (One point alone is decided anew: it seldom has two
 * solutions.)
 *
 * All stick. Where that obeys the laws it is the solution with the least kinetic energy: r.uf +
 * r.D r / 2 has its minimum over all r at D r = -uf. (D of a Newton iteration is not quite
 * symmetric; the minimum is that of its symmetric part, to O(h).)
 *
 * Another mode of all contacts that obeys the laws is the solution where there is but one
 * (direct_unique); of more elements than are enumerated it is taken for one, and that is said
 * (unranked). From the same mode, or all sticking, those are tried which each contact's impulse and
 * velocity point to.
 */
#ifndef STANCE_CORE_CONTACT_DIRECT_H
#define STANCE_CORE_CONTACT_DIRECT_H

#include "crowd.h"

#define DIRECT_ROUNDS 6   /* modes that are tried */
#define DIRECT_RIDGE 1e-7 /* of the tangential diagonal, so that redundant contacts are regular */

/* ---- one point ------------------------------------------------------------------------------- */

/* Sliding: NULL or as in contact_problem, of this contact. Returns the lanes where r is certainly
 * the one solution. */
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
    EACH_CONTACT (c, 0)
        all[c] = LANES_ALL;
    contact_mode_rows(active, all, rows);
}

/* Lanes where all active contacts stood, as `last` tells. */
HOT mask direct_stood(const struct contact_problem *p)
{
    mask stood = p->last ? p->known : MASK_NONE;
    EACH_IN (c, p->touching) {
        if (!p->last)
            continue;
        mask stands = mask_less(lanes_of(0), p->last[c][0]);
        if (contact_is_point(c))
            stands = contact_stands(p->friction, p->last[c][0], p->last[c][1]);
        stood &= LANES_NOT(p->active[c]) | stands;
        if (contact_unknowns(c) == 2 && !contact_is_point(c))
            stood &= LANES_NOT(contact_part(c, p->active)) |
                     contact_stands(p->friction, contact_load(c, p->last), p->last[c][1]);
    }
    return stood;
}

/* Lanes where the least energy is wanted, and nothing is in the way of all sticking: then that is
 * the solution, if it obeys the laws. */
static inline mask direct_stick_is_least(const struct contact_problem *p)
{
    const lanes none = lanes_of(0);
    mask least = p->indefinite ? MASK_NONE : mask_less(none, p->prefer);
    EACH_IN (c, p->touching)
        for (int a = 0; a < contact_unknowns(c); a++) {
            const mask here = a == 0 ? p->active[c] : contact_part(c, p->active);
            if (p->shift)
                least &= LANES_NOT(here & mask_less(none, lanes_abs(p->shift[c][a])));
            if (p->sliding && a == 1)
                least &= LANES_NOT(here & mask_less(none, lanes_abs(p->sliding[c])));
        }
    return least;
}

/* Lanes where impulses r of active contacts are in the cones. */
HOT mask direct_obeys(lanes friction, contact_set touching, const lanes (*r)[2])
{
    mask inside = LANES_ALL;
    EACH_IN (c, touching) {
        inside &= mask_less_equal(lanes_of(0), r[c][0]);
        if (contact_unknowns(c) == 2)
            inside &= contact_inside(friction, contact_load(c, r), r[c][1]);
    }
    return inside;
}

/* Impulses with which all active contacts stick; returns the lanes where they are in the cones, and
 * the operator is regular. */
HOT mask direct_stick(const struct contact_problem *p, lanes (*r)[2])
{
    mask rows[CONTACTS][2];
    direct_rows(p->active, rows);
    const mask regular = contact_rest(p->touching, CONTACT_PLAIN, p->D, p->uf, rows, NULL, r);
    return regular & direct_obeys(p->friction, p->touching, r);
}

/* Velocities with the impulses r of contacts in `touching`, of others zero. */
HOT void direct_velocities(const lanes (*D)[CONTACTS][2][2], const lanes (*uf)[2],
                           contact_set touching, const lanes (*r)[2], lanes (*u)[2])
{
    EACH_CONTACT (c, 0)
        u[c][0] = u[c][1] = lanes_of(0);
    EACH_IN (c, touching)
        EACH (a, 0, 2) {
            if (a >= contact_unknowns(c))
                continue;
            u[c][a] = uf[c][a];
            EACH_IN (k, touching)
                EACH (b, 0, 2)
                    if (b < contact_unknowns(k))
                        u[c][a] = lanes_fma(D[c][k][a][b], r[k][b], u[c][a]);
        }
}

/* The operator of a problem in the rows that take part, eliminated. */
struct direct_operator {
    contact_set touching;
    const lanes (*D)[CONTACTS][2][2];
    mask rows[CONTACTS][2];
    lanes G[CONTACTS][CONTACTS][2][2]; /* the blocks that elimination has left */
    struct contact_factors factors;
};

/* contact_matrix, then contact_factor; not inlined, as it is rarely needed. ridge: share of their
 * own diagonal that is added to tangential rows. */
COLD void direct_factor(struct direct_operator *o, enum contact_care care, const lanes *edge,
                        double ridge)
{
    contact_matrix(o->touching, o->D, o->rows, edge, o->G);
    EACH_IN (c, o->touching)
        if (contact_unknowns(c) == 2)
            o->G[c][c][1][1] = (1 + ridge) * o->G[c][c][1][1];
    contact_factor(o->touching, care, o->G, &o->factors);
}

/* The unknowns x that bring the velocities u of contacts in `touching` to rest in the rows, zero in
 * others. */
HOT void direct_rest(contact_set touching, const struct direct_operator *o, const lanes (*u)[2],
                     lanes (*x)[2])
{
    lanes part[CONTACTS][2];
    EACH_IN (c, touching)
        EACH (a, 0, 2)
            part[c][a] = choose(o->rows[c][a], u[c][a], lanes_of(0));
    contact_back(touching, &o->factors, part, x);
}
/* The same, not inlined: for callers that are rare. */
COLD void direct_back(const struct direct_operator *o, const lanes (*u)[2], lanes (*x)[2])
{
    direct_rest(o->touching, o, u, x);
}

/* What can be exchanged between contacts without any change of velocity: n with D n = 0, with 1 for
 * a row of contact p that depends on those before; `second`: for the other one of its rows, where
 * both do. Returns the lanes where there is such a row. */
static inline mask direct_null(const struct direct_operator *o, int p, bool second, lanes (*n)[2])
{
    const lanes(*const g)[2] = o->G[p][p];
    lanes own[2], null[2] = {lanes_of(1), lanes_of(0)};
    for (int a = 0; a < 2; a++)
        own[a] = choose(o->rows[p][a], lanes_abs(o->D[p][p][a][a]), lanes_of(1));
    mask here = mask_less_equal(lanes_abs(g[0][0]), LANE_PARALLEL * own[0]);
    if (contact_unknowns(p) == 2) {
        const mask first = mask_less_equal(lanes_abs(g[1][1]), lanes_abs(g[0][0]));
        const lanes larger = choose(first, g[0][0], g[1][1]);
        const lanes left = lanes_fnma(g[0][1], g[1][0], g[0][0] * g[1][1]);
        const mask both =
            mask_less_equal(lanes_abs(larger), LANE_PARALLEL * choose(first, own[0], own[1]));
        here = mask_less_equal(lanes_abs(left), LANE_PARALLEL * (own[0] * own[1])) | both;
        null[0] = choose(both, lanes_of(!second), choose(first, -g[0][1], g[1][1]));
        null[1] = choose(both, lanes_of(second), choose(first, g[0][0], -g[1][0]));
        if (second)
            here = both;
    } else if (second) {
        return MASK_NONE;
    }
    if (!mask_any(here))
        return here;
    for (int q = OWN_CONTACTS - 1; q >= 0; q--)
        for (int a = 0; a < 2; a++) {
            n[q][a] = lanes_of(0);
            if (q == p)
                n[q][a] = choose(here, null[a], lanes_of(0));
            for (int k = q + 1; k <= p; k++)
                if (o->touching >> q & o->touching >> k & 1 && a < contact_unknowns(q))
                    n[q][a] =
                        contact_row(contact_unknowns(k), o->factors.push[q][k][a], n[k], n[q][a]);
        }
    return here;
}

/* How far r lies from the middle of what the laws admit along n: see lane_share. */
static inline lanes direct_middle(lanes friction, contact_set touching, const lanes (*n)[2],
                                  const lanes (*r)[2])
{
    const lanes none = lanes_of(0);
    lanes low = lanes_of(-INFINITY), high = lanes_of(INFINITY);
    EACH_IN (c, touching)
        for (int side = -1; side <= 1; side++) {
            lanes room = r[c][0], rate = n[c][0];
            if (side == 0 ? contact_is_point(c) : contact_unknowns(c) == 1)
                continue;
            if (side != 0) {
                room = lanes_fma(friction, contact_load(c, r), side * r[c][1]);
                rate = lanes_fma(friction, contact_load(c, n), side * n[c][1]);
            }
            if (!mask_any(mask_less(none, lanes_abs(rate)))) /* nor does it change anything below */
                continue;
            const lanes edge = -room / rate;
            low = choose(mask_less(none, rate), lanes_max(edge, low), low);
            high = choose(mask_less(rate, none), lanes_min(edge, high), high);
        }
    const lanes middle = 0.5 * (low + high);
    return choose(mask_less_equal(low, high) & mask_finite(middle), middle, none);
}

/* Redundancies of a problem, in lanes: directions in which impulses change no velocity. */
struct direct_freedom {
    int count;
    lanes along[2 * CONTACTS][CONTACTS][2]; /* zero where a lane has it not ... */
    lanes moves[2 * CONTACTS];              /* what of velocities it changes, by rounding */
    mask here[2 * CONTACTS];
    mask several; /* lanes that have more than one: then an orthonormal family, see lane.h */
};

/* sum over the rows of a . b, each row in units of its own diagonal of D. */
static inline lanes direct_dot(const struct direct_operator *o, const lanes (*a)[2],
                               const lanes (*b)[2])
{
    lanes sum = lanes_of(0);
    EACH_IN (c, o->touching)
        for (int k = 0; k < contact_unknowns(c); k++)
            sum = lanes_fma(a[c][k] * lanes_abs(o->D[c][c][k][k]), b[c][k], sum);
    return sum;
}

/* x + by n where m holds. */
static inline void direct_add(contact_set touching, mask m, lanes by, const lanes (*n)[2],
                              lanes (*x)[2])
{
    EACH_IN (c, touching)
        for (int a = 0; a < 2; a++)
            x[c][a] = choose(m, lanes_fma(by, n[c][a], x[c][a]), x[c][a]);
}

/* The largest velocity that a unit of n leaves in the rows. */
static inline lanes direct_moves(const struct direct_operator *o, const lanes (*n)[2])
{
    const lanes none[CONTACTS][2] = {0};
    lanes u[CONTACTS][2], most = lanes_of(0);
    direct_velocities(o->D, none, o->touching, n, u);
    EACH_IN (c, o->touching)
        for (int a = 0; a < 2; a++) {
            const lanes size = choose(mask_finite(u[c][a]), lanes_abs(u[c][a]), lanes_of(INFINITY));
            most = lanes_max(choose(o->rows[c][a], size, lanes_of(0)), most);
        }
    return most;
}

static inline void direct_freedoms(const struct direct_operator *o, struct direct_freedom *free)
{
    mask any = MASK_NONE;
    free->count = 0;
    free->several = MASK_NONE;
    EACH_IN (p, o->touching)
        for (int second = 0; second < 2; second++) {
            const int m = free->count;
            free->here[m] = direct_null(o, p, second, free->along[m]);
            if (!mask_any(free->here[m]))
                continue;
            free->several |= any & free->here[m];
            any |= free->here[m];
            free->count++;
        }
    for (int m = 0; m < free->count && mask_any(free->several); m++) {
        lanes(*const own)[2] = free->along[m];
        for (int l = 0; l < m; l++) {
            const lanes by = direct_dot(o, own, free->along[l]);
            direct_add(o->touching, free->several & free->here[l], -by, free->along[l], own);
        }
        const lanes size = lanes_sqrt(direct_dot(o, own, own));
        const lanes by = 1 / choose(free->several & free->here[m], size, lanes_of(1));
        EACH_IN (c, o->touching)
            for (int a = 0; a < 2; a++)
                own[c][a] = by * own[c][a];
    }
    for (int m = 0; m < free->count; m++)
        free->moves[m] = direct_moves(o, free->along[m]);
}

/* Moves r by a multiple of the redundancy k in the lanes of m where that changes no velocity. */
static inline void direct_exchange(const struct direct_freedom *free, int k, contact_set touching,
                                   lanes tolerance, mask m, lanes by, lanes (*r)[2])
{
    m &= mask_less_equal(lanes_abs(by) * free->moves[k], 0.25 * tolerance);
    direct_add(touching, m, by, free->along[k], r);
}

/* As lane_hold, in lanes: impulses with which all active contacts stick, whatever the operator, and
 * the lanes where they obey the laws. */
COLD mask direct_hold(const struct contact_problem *p, lanes tolerance, lanes (*r)[2])
{
    const contact_set touching = p->touching;
    struct direct_operator o;
    struct direct_freedom free;
    mask good = LANES_ALL;
    lanes u[CONTACTS][2], x[CONTACTS][2], first[CONTACTS][2];
    o.touching = touching, o.D = p->D;
    direct_rows(p->active, o.rows);
    direct_factor(&o, CONTACT_CAREFUL, NULL, 0);
    direct_back(&o, p->uf, first);
    direct_freedoms(&o, &free);
    /* Once more with what is left. */
    direct_velocities(p->D, p->uf, touching, first, u);
    direct_back(&o, u, x);
    for (int c = 0; c < OWN_CONTACTS; c++)
        for (int a = 0; a < 2; a++)
            r[c][a] = first[c][a] + x[c][a];
    const bool several = mask_any(free.several);
    for (int m = 0; m < free.count && several; m++) /* least norm */
        direct_exchange(&free, m, touching, tolerance, free.several & free.here[m],
                        -direct_dot(&o, free.along[m], r), r);
    for (int sweep = 0; sweep < (several ? LANE_SWEEPS : 1); sweep++)
        for (int m = 0; m < free.count; m++)
            direct_exchange(&free, m, touching, tolerance,
                            sweep > 0 ? free.several & free.here[m] : free.here[m],
                            direct_middle(p->friction, touching, free.along[m], r), r);
    direct_velocities(p->D, p->uf, touching, r, u);
    EACH_IN (c, touching)
        for (int a = 0; a < 2; a++)
            good &= LANES_NOT(o.rows[c][a]) | mask_less_equal(lanes_abs(u[c][a]), tolerance);
    return good & direct_obeys(p->friction, touching, r);
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
COLD mask direct_unique(const struct contact_problem *p)
{
    const contact_set touching = p->touching;
    struct direct_operator o;
    lanes u[CONTACTS][2], x[CONTACTS][2], sum[CONTACTS] = {0};
    o.touching = touching, o.D = p->D;
    direct_rows(p->active, o.rows);
    direct_factor(&o, CONTACT_GUARDED, NULL, DIRECT_RIDGE);
    lanes largest = lanes_of(0);
    EACH_IN (h, touching) {
        if (contact_unknowns(h) != 2)
            continue;
        for (int c = 0; c < OWN_CONTACTS; c++) {
            u[c][0] = lanes_of(contact_grip(c) == h ? -1 : 0);
            u[c][1] = lanes_of(0);
        }
        direct_back(&o, u, x);
        EACH_IN (g, touching)
            if (contact_unknowns(g) == 2)
                sum[g] += lanes_abs(contact_load(g, x));
    }
    for (int g = 0; g < OWN_CONTACTS; g++) {
        lanes row = lanes_of(0);
        if (!(touching >> g & 1) || contact_unknowns(g) != 2)
            continue;
        EACH_IN (h, touching)
            if (contact_unknowns(h) == 2)
                row +=
                    choose(o.rows[g][1] & o.rows[h][1], lanes_abs(p->D[g][h][1][1]), lanes_of(0));
        largest = lanes_max(sum[g] * row, largest);
    }
    return o.factors.regular & mask_less(p->friction * (p->friction * largest), lanes_of(4));
}

/* Largest violation of a law by the impulses r with the velocities u of active contacts. */
HOT lanes direct_violation(const struct contact_problem *p, const lanes (*r)[2],
                           const lanes (*u)[2])
{
    const lanes none = lanes_of(0);
    lanes worst = none;
    EACH_IN (c, p->touching) {
        const lanes pushes = r[c][0] * lanes_abs(p->D[c][c][0][0]);
        lanes off = lanes_max(-u[c][0], -pushes);
        off = lanes_max(lanes_min(lanes_abs(u[c][0]), lanes_abs(pushes)), off);
        worst = lanes_max(choose(p->active[c], off, none), worst);
        if (contact_unknowns(c) == 1)
            continue;
        const lanes scale = lanes_abs(p->D[c][c][1][1]);
        const lanes bound = p->friction * contact_load(c, r);
        lanes slip = u[c][1];
        if (p->sliding)
            slip = choose(mask_less(none, lanes_abs(p->sliding[c])), LANE_ENDLESS * p->sliding[c],
                          slip);
        const lanes room = choose(mask_less(slip, none), bound - r[c][1], bound + r[c][1]);
        off = lanes_max(lanes_min(lanes_abs(slip), room * scale),
                        (lanes_abs(r[c][1]) - bound) * scale);
        worst = lanes_max(choose(contact_part(c, p->active), off, none), worst);
    }
    return worst;
}

/* A solution in the lanes of m, exactly inside the cones, and on their edges where it was before
 * its normal impulses were clipped, as lane_clip does it: over a very short time all impulses are
 * as small as the tolerance. */
static inline void direct_take(const struct contact_problem *p, const lanes (*solution)[2], mask m,
                               lanes (*r)[2])
{
    const lanes friction = p->friction;
    EACH_IN (c, p->touching)
        r[c][0] = choose(m, lanes_max(solution[c][0], lanes_of(0)), r[c][0]);
    EACH_IN (c, p->touching) {
        if (contact_unknowns(c) == 1)
            continue;
        const lanes bound = friction * contact_load(c, r);
        const lanes asked = solution[c][1], size = lanes_abs(asked);
        const mask edge =
            mask_less_equal(CONTACT_STICKS * (friction * contact_load(c, solution)), size) &
            mask_less(size, CONTACT_STICKS * bound);
        lanes along = lanes_max(lanes_min(asked, bound), -bound);
        along = choose(edge, choose(mask_less(asked, lanes_of(0)), -bound, bound), along);
        r[c][1] = choose(m, along, r[c][1]);
    }
}

/* A mode of all contacts, in lanes. */
struct direct_mode {
    mask closed[CONTACTS], sticks[CONTACTS]; /* which carry; which grips stick */
    lanes edge[CONTACTS];                    /* of each grip r_T by r_N: 0 where it sticks */
};

/* The mode of the impulses before in the lanes of `known`; elsewhere all active contacts carry and
 * stick. A slip that goes on does so. */
static inline void direct_mode_of(const struct contact_problem *p, mask known,
                                  struct direct_mode *mode)
{
    const lanes none = lanes_of(0), friction = p->friction, (*const r)[2] = p->last;
    for (int c = 0; c < OWN_CONTACTS; c++) {
        mode->closed[c] = p->active[c];
        mode->sticks[c] = LANES_ALL;
        mode->edge[c] = none;
        if (r) {
            mode->closed[c] &= LANES_NOT(known) | mask_less(none, r[c][0]);
            mode->sticks[c] =
                LANES_NOT(known) | contact_stands(friction, contact_load(c, r), r[c][1]);
            mode->edge[c] = choose(mask_less(r[c][1], none), -friction, friction);
        }
        mode->edge[c] = choose(mode->sticks[c], none, mode->edge[c]);
        if (p->sliding) {
            const mask slides = mask_less(none, lanes_abs(p->sliding[c]));
            mode->sticks[c] &= LANES_NOT(slides);
            mode->edge[c] = choose(slides, -(friction * p->sliding[c]), mode->edge[c]);
        }
    }
}

/* In the lanes of m that which impulses r and velocities u, the mode's, point to. */
static inline void direct_mode_next(const struct contact_problem *p, mask m, const lanes (*r)[2],
                                    const lanes (*u)[2], struct direct_mode *mode)
{
    const lanes none = lanes_of(0), friction = p->friction;
    EACH_IN (c, p->touching) {
        const mask was = mode->closed[c], grips = mode->sticks[c];
        const mask closed = (was & mask_less(none, r[c][0])) |
                            (p->active[c] & LANES_NOT(was) & mask_less(u[c][0], none));
        mode->closed[c] = (m & closed) | (was & LANES_NOT(m));
        if (contact_unknowns(c) == 1)
            continue;
        /* A grip that slips sticks when its slip is with its friction; one that sticks slips when
         * it leaves the cone; where the slip is given it does that. */
        const lanes load = contact_load(c, r);
        const mask turns = mask_less(none, mode->edge[c] * u[c][1]);
        const mask leaves =
            grips & LANES_NOT(contact_inside(friction, load, r[c][1])) & mask_less(none, load);
        mask moves = m & (leaves | (LANES_NOT(grips) & turns));
        if (p->sliding)
            moves &= LANES_NOT(mask_less(none, lanes_abs(p->sliding[c])));
        const lanes side = choose(mask_less(r[c][1], none), -friction, friction);
        mode->edge[c] = choose(moves, choose(leaves, side, none), mode->edge[c]);
        mode->sticks[c] = (moves & LANES_NOT(leaves)) | (grips & LANES_NOT(moves));
    }
}

/* Lanes where a mode speaks for itself: not all contacts are at rest, or all stick and their
 * operator is regular. Else impulses may be shared in other ways, and one on its cone's edge for no
 * reason: see direct_hold. */
static inline mask direct_is_plain(const struct contact_problem *p, const struct direct_mode *mode,
                                   mask regular, lanes tolerance, const lanes (*u)[2])
{
    mask rest = LANES_ALL, stick = regular;
    EACH_IN (c, p->touching) {
        rest &= LANES_NOT(p->active[c]) | mode->closed[c];
        if (contact_unknowns(c) == 1)
            continue;
        const mask slips = contact_part(c, mode->closed) & LANES_NOT(mode->sticks[c]) &
                           mask_less(lanes_of(0), p->friction);
        rest &= LANES_NOT(slips & mask_less(tolerance, lanes_abs(u[c][1])));
        stick &= LANES_NOT(slips);
    }
    return stick | LANES_NOT(rest);
}

/* Tries a mode in the lanes of `todo`: r where it is a solution's, and, in those of `plain`, speaks
 * for itself; these are returned. In the others of `todo` the mode becomes the next one to try. */
COLD mask direct_try(const struct contact_problem *p, lanes tolerance, mask todo, mask plain,
                     struct direct_mode *mode, lanes (*r)[2])
{
    struct direct_operator o;
    lanes candidate[CONTACTS][2], u[CONTACTS][2];
    o.touching = p->touching, o.D = p->D;
    contact_mode_rows(mode->closed, mode->sticks, o.rows);
    direct_factor(&o, CONTACT_CAREFUL, mode->edge, 0);
    direct_back(&o, p->uf, candidate);
    EACH_IN (c, p->touching)
        if (contact_unknowns(c) == 2)
            candidate[c][1] = lanes_fma(mode->edge[c], contact_load(c, candidate), candidate[c][1]);
    direct_velocities(p->D, p->uf, p->touching, candidate, u);
    mask good = todo & mask_less_equal(direct_violation(p, candidate, u), tolerance);
    if (mask_any(plain))
        good &= LANES_NOT(plain) | direct_is_plain(p, mode, o.factors.regular, tolerance, u);
    direct_take(p, candidate, good, r);
    direct_mode_next(p, todo & LANES_NOT(good), candidate, u, mode);
    return good;
}

#endif
