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
 * is gained, and it is taken. Moreau's law is limited, too: joint stops have an e of their own,
 * which is 0.
 *
 * e' is sought from e downwards. In one contact mode r and u' are linear in e', so dT(e') is a
 * quadratic; and what makes the mode a solution are linear inequalities, so that a mode of both
 * ends of an interval is one between them, too. Parts of 1 / IMPACT_SCAN are halved until both ends
 * are of one mode, or IMPACT_LEAST is reached; the quadratic through ends and middle then tells
 * whether dT dips to zero between them. What is found is halved to the root. Only a mode of less
 * than IMPACT_LEAST of e may be missed.
 */
#ifndef STANCE_CORE_CONTACT_IMPACT_H
#define STANCE_CORE_CONTACT_IMPACT_H

#include "solve.h"

#define IMPACT_SCAN 16
#define IMPACT_LEAST 0x1p-10
#define IMPACT_FINE 0x1p-40
#define IMPACT_COUNTS 1e-6
#define IMPACT_ROUNDING 1e-12 /* of the energies that are compared: what is no gain */
#define IMPACT_DIPS 1e-6      /* of the gains at the ends: a dip this near to none is looked at */

/* What came of a share that was tried: the energy gained, and a number that tells contact modes
 * apart; consists of lanes. */
struct impact_tried {
    lanes gain, mode;
};

/* What is tried next in a part of the search: its lower end, its middle, its dip. */
enum { IMPACT_END, IMPACT_MIDDLE, IMPACT_DIP };

/* The search of each lane: shares of e. Nothing is gained at `low`, where it is `found`, some at
 * `high`. What is looked into is the part below `high`, of that width; `dip` is from its lower end.
 */
struct impact_share {
    lanes low, high, width, dip, stage;
    struct impact_tried top, end; /* at `high`, and at the part's lower end */
    mask found;
};
static inline struct impact_share impact_share_begin(struct impact_tried first)
{
    return (struct impact_share){.low = lanes_of(0),
                                 .high = lanes_of(1),
                                 .width = lanes_of(1.0 / IMPACT_SCAN),
                                 .dip = lanes_of(0),
                                 .stage = lanes_of(IMPACT_END),
                                 .top = first,
                                 .end = first,
                                 .found = MASK_NONE};
}
/* The lanes of m whose search has not ended. */
static inline mask impact_share_open(const struct impact_share *s, mask m)
{
    return m & mask_less(lanes_of(IMPACT_FINE), s->high - s->low) & mask_less(lanes_of(0), s->high);
}
static inline mask impact_share_in(const struct impact_share *s, int stage)
{
    return mask_less(lanes_of(stage - 0.5), s->stage) & mask_less(s->stage, lanes_of(stage + 0.5));
}
static inline lanes impact_share_next(const struct impact_share *s)
{
    const lanes inside =
        choose(impact_share_in(s, IMPACT_MIDDLE), 0.5 * s->width, s->width - s->dip);
    return choose(s->found, 0.5 * (s->low + s->high),
                  s->high - choose(impact_share_in(s, IMPACT_END), s->width, inside));
}
/* Lanes where what is found is less than all by more than the instants at which velocities are
 * compared differ. */
static inline mask impact_share_counts(const struct impact_share *s)
{
    return mask_less(s->low, lanes_of(1 - IMPACT_COUNTS));
}
/* Lanes of m where the quadratic through the gains at the part's lower end, its middle and its
 * upper end comes down to nothing between them: at `dip`. */
static inline mask impact_share_dips(struct impact_share *s, mask m, lanes middle)
{
    const lanes low = s->end.gain, high = s->top.gain;
    const lanes bend = 2 * (low - 2 * middle + high), slope = 4 * middle - 3 * low - high;
    const lanes at = -slope / (2 * bend);
    s->dip = choose(m, at * s->width, s->dip);
    return m & mask_less(lanes_of(0), bend) & mask_less(lanes_of(0), at) &
           mask_less(at, lanes_of(1)) &
           mask_less_equal(low - slope * slope / (4 * bend), IMPACT_DIPS * (low + high));
}
/* Tells, for the lanes m, whether the share that was just tried gains energy. Returns the lanes
 * where it does not. */
static inline mask impact_share_tell(struct impact_share *s, mask m, mask gains,
                                     const struct impact_tried *tried)
{
    const lanes share = impact_share_next(s), none = lanes_of(0);
    const mask fits = m & LANES_NOT(gains);
    const mask seeks = m & LANES_NOT(s->found), ends = seeks & impact_share_in(s, IMPACT_END);
    const mask other = mask_less(none, lanes_abs(tried->mode - s->top.mode));
    const mask halves = ends & other & mask_less(lanes_of(IMPACT_LEAST), s->width);
    const mask takes = fits & LANES_NOT(halves), on = seeks & LANES_NOT(halves | takes);
    const mask dips = impact_share_dips(s, on & impact_share_in(s, IMPACT_MIDDLE), tried->gain);
    const mask over = on & LANES_NOT(ends | dips);
    s->low = choose(takes, share, s->low);
    s->high = choose(m & s->found & LANES_NOT(fits), share, s->high);
    s->found |= takes;
    s->width = choose(halves, 0.5 * s->width, s->width);
    choose_all(on & ends, tried, &s->end, sizeof *tried);
    s->stage = choose(on & ends, lanes_of(IMPACT_MIDDLE), s->stage);
    s->stage = choose(dips, lanes_of(IMPACT_DIP), s->stage);
    s->high = choose(over, s->high - s->width, s->high);
    choose_all(over, &s->end, &s->top, sizeof s->top);
    s->stage = choose(over, lanes_of(IMPACT_END), s->stage);
    /* Twice as wide where that ends at a multiple of it: shares stay on the halves' grid. */
    const lanes wider = 2 * s->width, count = s->high / wider;
    const mask whole = mask_less_equal(lanes_abs(((count + 0x1p52) - 0x1p52) - count), none);
    s->width =
        choose(over & whole & mask_less_equal(wider, lanes_of(1.0 / IMPACT_SCAN)), wider, s->width);
    return fits;
}

/* A number that tells the modes of impulses r apart. */
static inline lanes impact_mode(lanes friction, const lanes (*r)[2])
{
    const lanes none = lanes_of(0);
    lanes mode = none;
    for (int c = 0; c < OWN_CONTACTS; c++) {
        lanes own = lanes_where(mask_less(none, r[c][0]));
        if (contact_unknowns(c) == 2) {
            const lanes side = choose(mask_less(none, r[c][1]), lanes_of(2), lanes_of(4));
            const mask slips = mask_less(none, contact_load(c, r)) &
                               LANES_NOT(contact_stands(friction, contact_load(c, r), r[c][1]));
            own += choose(slips, side, none);
        }
        mode = 6 * mode + own;
    }
    return mode;
}

/* What is asked of an impact: contacts in `part` arrive with the velocities u. */
struct impact_rule {
    const lanes (*D)[CONTACTS][2][2];
    const lanes (*u)[2];
    const mask *part;
    lanes friction, prefer; /* see contact_problem */
    const lanes *restitution;
    mask moreau, limited; /* else Newton's; never limited */
};

/* Impulses r of an impact, and what the law added to the velocities u; consists of lanes. */
struct impact_answer {
    lanes shift[CONTACTS][2], r[CONTACTS][2];
};

/* The impulses by the restitution e; what came of it. Returns the lanes where more energy is gained
 * than rounding is. */
static inline mask impact_try(const struct impact_rule *rule, const lanes *e,
                              struct impact_answer *to, struct contact_verdict *verdict,
                              struct impact_tried *tried)
{
    const lanes none = lanes_of(0), (*const u)[2] = rule->u;
    lanes uf[CONTACTS][2], after[CONTACTS][2], gain = none, size = none;
    for (int c = 0; c < OWN_CONTACTS; c++) {
        to->shift[c][0] = e[c] * lanes_min(u[c][0], none);
        to->shift[c][1] = none;
        if (contact_unknowns(c) == 2)
            to->shift[c][1] = choose(rule->moreau, e[c] * u[c][1], none);
        uf[c][0] = u[c][0] + to->shift[c][0];
        uf[c][1] = choose(rule->moreau, u[c][1] + to->shift[c][1], u[c][1]);
    }
    const struct contact_problem asked = {
        rule->D, uf, CONTACT_ALL, rule->part, rule->friction, rule->prefer, .shift = to->shift};
    solve_contacts(&asked, LANES_ALL, to->r, verdict);
    direct_velocities(rule->D, u, CONTACT_ALL, to->r, after);
    for (int c = 0; c < OWN_CONTACTS; c++)
        for (int a = 0; a < contact_unknowns(c); a++) {
            const lanes r = to->r[c][a];
            const mask here = contact_part(c, rule->part);
            gain += choose(here, 0.5 * (r * (u[c][a] + after[c][a])), none);
            size += choose(here, lanes_abs(r * u[c][a]) + lanes_abs(r * after[c][a]), none);
        }
    *tried = (struct impact_tried){gain, impact_mode(rule->friction, to->r)};
    return mask_less(IMPACT_ROUNDING * size, gain);
}

/* The impulses in the lanes of `where`. Returns the lanes that were limited. */
static inline mask impact_solve(const struct impact_rule *rule, mask where,
                                struct impact_answer *to, struct contact_verdict *verdict)
{
    struct impact_tried said;
    const mask gains =
        where & rule->limited & impact_try(rule, rule->restitution, to, verdict, &said);
    struct impact_share share = impact_share_begin(said);
    for (mask open; mask_any(open = impact_share_open(&share, gains));) {
        const lanes tried = impact_share_next(&share);
        lanes e[CONTACTS];
        struct impact_answer next;
        struct contact_verdict also;
        for (int c = 0; c < OWN_CONTACTS; c++)
            e[c] = tried * rule->restitution[c];
        const mask more = impact_try(rule, e, &next, &also, &said) & mask_less(lanes_of(0), tried);
        const mask fits = impact_share_tell(&share, open, more, &said), not = LANES_NOT(fits);
        choose_all(fits, &next, to, sizeof next);
        *verdict = (struct contact_verdict){(also.ambiguous & fits) | (verdict->ambiguous & not ),
                                            (also.unsolved & fits) | (verdict->unsolved & not ),
                                            (also.unranked & fits) | (verdict->unranked & not )};
    }
    return gains & impact_share_counts(&share);
}

#endif
