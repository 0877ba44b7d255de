/* impact.h - restitution that creates no energy.
 *
 * With u the velocities of contacts before an impact and u' = u + D r after it the impulses r add
 * the kinetic energy dT = r.(u + u') / 2. Two laws say what is asked of u', both by a shift of the
 * free velocity u in the problem of contact.h:
 *
 *   Newton's   u'_N + e min(u_N, 0) in Signorini's law, u'_T in Coulomb's;
 *   Moreau's   the same, and u'_T + e u_T in Coulomb's.
 *
 * By Moreau's r.(u' + e u) <= 0 where all contacts have one e and none of those that get an impulse
 * was leaving; with u' = u + D r then r.u <= -r.D r / (1 + e) and
 *
 *   dT = r.u + r.D r / 2 <= (1/2 - 1 / (1 + e)) r.D r <= 0     (Moreau 1988; Glocker 2001, ch. 7).
 *
 * Newton's says nothing of r_T u_T, and with friction dT may be positive (Kane's paradox). At e = 0
 * both are r.u' <= 0 and dT = r.u' - r.D r / 2 <= 0. So there is a largest e' <= e at which nothing
 * is gained, and it is taken: e' is sought from e downwards by IMPACT_SCAN steps, then halved, for
 * as dT(e') is continuous but where the solution jumps, and a quadratic in each contact mode, only
 * two roots within one of those steps could be missed. Moreau's law is limited, too: joint stops
 * have an e of their own, which is 0.
 */
#ifndef STANCE_CORE_CONTACT_IMPACT_H
#define STANCE_CORE_CONTACT_IMPACT_H

#include "solve.h"

#define IMPACT_SCAN 16
#define IMPACT_FINE 0x1p-40
#define IMPACT_COUNTS 1e-6
#define IMPACT_ROUNDING 1e-12 /* of the energies that are compared: what is no gain */

/* The search of each lane: shares of e. Nothing is gained at `low`, where it is `found`. */
struct impact_share {
    lanes low, high;
    mask found;
};
static inline struct impact_share impact_share_begin(void)
{
    return (struct impact_share){lanes_of(0), lanes_of(1), MASK_NONE};
}
/* Those of the lanes m that are not at the end of their search. */
static inline mask impact_share_open(const struct impact_share *s, mask m)
{
    return m & mask_less(lanes_of(IMPACT_FINE), s->high - s->low) & mask_less(lanes_of(0), s->high);
}
static inline lanes impact_share_next(const struct impact_share *s)
{
    return choose(s->found, 0.5 * (s->low + s->high), s->high - 1.0 / IMPACT_SCAN);
}
/* Lanes where what is found is less than all by more than the instants at which velocities are
 * compared differ. */
static inline mask impact_share_counts(const struct impact_share *s)
{
    return mask_less(s->low, lanes_of(1 - IMPACT_COUNTS));
}
/* In the lanes m the share that was next has been tried; `fits`: where nothing was gained. */
static inline void impact_share_tell(struct impact_share *s, mask m, mask fits)
{
    const lanes tried = impact_share_next(s);
    s->low = choose(m & fits, tried, s->low);
    s->high = choose(m & LANES_NOT(fits), tried, s->high);
    s->found |= m & fits;
}

/* What is asked of an impact. */
struct impact_rule {
    lanes friction, prefer; /* see contact_rule */
    const lanes *restitution;
    mask moreau, limited; /* else Newton's; never limited */
};

/* Impulses r, and the velocities after them, of contacts in `part` that arrive with u, by the
 * restitution e. Returns the lanes where more energy is gained than rounding is. */
static inline mask impact_try(const struct impact_rule *rule, const lanes *e,
                              const lanes (*D)[CONTACTS][2][2], const lanes (*u)[2],
                              const mask *part, lanes (*shift)[2], lanes (*r)[2],
                              struct contact_verdict *verdict)
{
    const lanes none = lanes_of(0);
    lanes uf[CONTACTS][2], after[CONTACTS][2], gain = none, size = none;
    for (int c = 0; c < SCENE_CONTACTS; c++) {
        shift[c][0] = e[c] * lanes_min(u[c][0], none);
        shift[c][1] = none;
        if (contact_unknowns(c) == 2)
            shift[c][1] = choose(rule->moreau, e[c] * u[c][1], none);
        uf[c][0] = u[c][0] + shift[c][0];
        uf[c][1] = choose(rule->moreau, u[c][1] + shift[c][1], u[c][1]);
    }
    const struct contact_rule asked = {
        .friction = rule->friction, .prefer = rule->prefer, .shift = (const lanes(*)[2])shift};
    solve_contacts(&asked, D, (const lanes(*)[2])uf, CONTACT_ALL, LANES_ALL, part, r, verdict);
    direct_velocities(D, u, CONTACT_ALL, (const lanes(*)[2])r, after);
    for (int c = 0; c < SCENE_CONTACTS; c++)
        for (int a = 0; a < contact_unknowns(c); a++) {
            const lanes added = 0.5 * (r[c][a] * (u[c][a] + after[c][a]));
            const mask here = contact_part(c, part);
            gain += choose(here, added, none);
            size +=
                choose(here, lanes_abs(r[c][a] * u[c][a]) + lanes_abs(r[c][a] * after[c][a]), none);
        }
    return mask_less(IMPACT_ROUNDING * size, gain);
}

/* Impulses of an impact in the lanes of `where`. shift: what the law added to the velocities u.
 * Returns the lanes that were limited. */
static inline mask impact_solve(const struct impact_rule *rule, mask where,
                                const lanes (*D)[CONTACTS][2][2], const lanes (*u)[2],
                                const mask *part, lanes (*shift)[2], lanes (*r)[2],
                                struct contact_verdict *verdict)
{
    struct impact_share share = impact_share_begin();
    const mask gains =
        where & rule->limited & impact_try(rule, rule->restitution, D, u, part, shift, r, verdict);
    for (mask open; mask_any(open = impact_share_open(&share, gains));) {
        const lanes tried = impact_share_next(&share);
        lanes e[CONTACTS], shift1[CONTACTS][2], r1[CONTACTS][2];
        struct contact_verdict said;
        for (int c = 0; c < SCENE_CONTACTS; c++)
            e[c] = tried * rule->restitution[c];
        const mask fits = LANES_NOT(impact_try(rule, e, D, u, part, shift1, r1, &said)) |
                          mask_less_equal(tried, lanes_of(0));
        for (int c = 0; c < SCENE_CONTACTS; c++)
            for (int a = 0; a < 2; a++) {
                shift[c][a] = choose(open & fits, shift1[c][a], shift[c][a]);
                r[c][a] = choose(open & fits, r1[c][a], r[c][a]);
            }
        *verdict = contact_verdicts(open & fits, &said, verdict);
        impact_share_tell(&share, open, fits);
    }
    return gains & impact_share_counts(&share);
}

#endif
