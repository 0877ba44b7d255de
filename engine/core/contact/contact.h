/* contact.h - the planar Signorini-Coulomb problem of a step: what contacts there are, what is
 * asked, and the linear equations that are left once each contact's mode is known.
 *
 * Given the velocities without contact impulses uf (normal, tangential for each contact, already
 * shifted by what restitution asks for: impact.h) and the Delassus operator D, find
 * impulses r and velocities u = uf + D r such that for each active contact
 *
 *   0 <= u_N  _|_  r_N >= 0      (Signorini, at velocity level),
 *   |r_T| <= mu r_N,  r_T = -mu r_N sign(u_T) where u_T != 0      (Coulomb),
 *
 * the paper's laws of figures 5 and 6. A contact is one normal; friction is held by grips. A point
 * or a disc is a grip of its own. Heel and toe of a flat sole are two normals with one tangential
 * impulse, the first end's, and the sum of both normal ones in Coulomb's law: with both on the
 * plane their tangential velocities are the same. A joint stop has a normal alone.
 *
 * In a mode - each contact open or closed, each grip sticking or slipping forward or backward - the
 * laws are linear: u = 0 in the rows that take part, with r_T = x_T + edge (sum of r_N), edge = 0
 * where a grip sticks, and x_T = 0, edge = -+mu where it slips. They are solved contact after
 * contact, by blocks of two rows or one.
 *
 * Who solves them, how: solve.h tries direct.h (certain), pair.h (two points), lane.h (every mode
 * of one lane) and crowd.h (one of many contacts), in this order.
 *
 * D need not be symmetric (an exact Newton linearisation is not) nor positive (where a law answers
 * contact forces at once it is not).
 */
#ifndef STANCE_CORE_CONTACT_CONTACT_H
#define STANCE_CORE_CONTACT_CONTACT_H

#include "engine/core/lanes/lanes.h"
#include "engine/core/lanes/sizes.h"

#define CONTACT_RANK_GUARD 1e-12  /* of what it was: a pivot this small is a rounding of zero */
#define CONTACT_REGULAR 1e-9      /* of the largest it can be: a pivot this small needs care */
#define CONTACT_STICKS (1 - 1e-9) /* of the cone: an impulse inside it sticks */
#define CONTACT_TOLERANCE 1e-11   /* of the largest free velocity (at least 1 m/s) */
#define CONTACT_STILL 1e-4        /* m/s: free velocities are known to CONTACT_TOLERANCE of it */

/* Contacts that matter in any lane: bit c. With an end of a sole its first one is in, too, which
 * holds the tangential impulse. What an open contact would do costs nothing. */
typedef unsigned contact_set;
#define CONTACT_ALL ((1u << OWN_CONTACTS) - 1)

/* The first contact of a set from one on; SCENE_CONTACTS: none. */
HOT int contact_next(contact_set set, int from)
{
    const contact_set left = set >> from;
    return left ? from + __builtin_ctz(left) : SCENE_CONTACTS;
}
/* Loops over all contacts from one on, and over those in a set. Where there are few they are
 * unrolled, and compiled anew for each set that is a constant; else a set is gone through as a
 * list, so that neither time nor code is that of contacts which are open. */
#if TREE_CONTACTS > 4
#define CONTACT_LISTS
#define EACH_CONTACT(c, from) for (int c = (from); c < OWN_CONTACTS; c++)
#define EACH_IN_FROM(c, from, set)                                                                 \
    for (int c = contact_next(set, from); c < OWN_CONTACTS; c = contact_next(set, c + 1))
#else
#define EACH_CONTACT(c, from) EACH (c, from, OWN_CONTACTS)
#define EACH_IN_FROM(c, from, set)                                                                 \
    EACH (c, from, OWN_CONTACTS)                                                                   \
        if (!((set) >> c & 1)) {                                                                   \
        } else
#endif
#define EACH_IN(c, set) EACH_IN_FROM (c, 0, set)

/* The contact that holds the friction of contact c: itself, the first end of its sole; -1: none. */
HOT int contact_grip(int c)
{
    return scene_grip[c];
}
/* Unknowns of contact c: its normal impulse and, if it holds one, the tangential. */
HOT int contact_unknowns(int c)
{
    return contact_grip(c) == c ? 2 : 1;
}
/* The second end of the sole whose friction contact c holds; -1: it holds none's. */
HOT int contact_second(int c)
{
    return scene_other[c] > c && contact_grip(scene_other[c]) == c ? scene_other[c] : -1;
}
/* A point or a disc: nothing else has part in its friction. */
HOT bool contact_is_point(int c)
{
    return contact_grip(c) == c && contact_second(c) < 0;
}
/* Contact c and those whose friction it holds. */
HOT contact_set contact_ends(int c)
{
    return 1u << c | (contact_second(c) >= 0 ? 1u << contact_second(c) : 0);
}
/* Contact c and what holds its friction. */
HOT contact_set contact_with(int c)
{
    return 1u << c | (contact_grip(c) >= 0 ? 1u << contact_grip(c) : 0);
}
/* Contacts that are in `part` in any of the lanes m, with what holds their friction. */
HOT contact_set contact_any(const mask *part, mask m)
{
    contact_set any = 0;
    EACH_CONTACT (c, 0)
        any |= mask_any(part[c] & m) ? contact_with(c) : 0;
    return any;
}
/* The sets of contacts that steps are compiled for, X(name, whether there is such a one, set): none
 * and, where they are no lists, all on the ground and each grip's alone. */
#define CONTACT_ON_GROUND                                                                          \
    (CONTACT_OF_GROUND(0) | CONTACT_OF_GROUND(1) | CONTACT_OF_GROUND(2) | CONTACT_OF_GROUND(3))
#define CONTACT_OF_GROUND(c)                                                                       \
    ((c) < SCENE_CONTACTS && contact_grip((c) % CONTACTS) >= 0 ? 1u << (c) : 0u)
#define CONTACT_SET_OF(X, c)                                                                       \
    X(grip##c, (c) < SCENE_CONTACTS && contact_grip((c) % CONTACTS) == (c),                        \
      contact_ends((c) % CONTACTS))
#ifdef CONTACT_LISTS
#define CONTACT_SETS(X) X(apart, true, 0)
#else
#define CONTACT_SETS(X)                                                                            \
    X(apart, true, 0)                                                                              \
    X(all, SCENE_CONTACTS > 1, CONTACT_ON_GROUND)                                                  \
    CONTACT_SET_OF(X, 0)                                                                           \
    CONTACT_SET_OF(X, 1)                                                                           \
    CONTACT_SET_OF(X, 2)                                                                           \
    CONTACT_SET_OF(X, 3)
#endif
/* Impulse normal to the ground that grip g may lean on, of impulses r[c][normal, tangential]. */
HOT lanes contact_load(int g, const lanes (*r)[2])
{
    lanes load = r[g][0];
    if (contact_second(g) >= 0)
        load += r[contact_second(g)][0];
    return load;
}
/* Lanes where an end of grip g is in `part`. */
HOT mask contact_part(int g, const mask *part)
{
    return contact_second(g) >= 0 ? part[g] | part[contact_second(g)] : part[g];
}

/* Lanes where an impulse is inside the cone, and where it is well inside: the grip neither slides
 * nor is about to leave. */
HOT mask contact_inside(lanes friction, lanes load, lanes tangential)
{
    return mask_less_equal(lanes_abs(tangential), friction * load);
}
HOT mask contact_stands(lanes friction, lanes load, lanes tangential)
{
    return mask_less(lanes_of(0), load) &
           mask_less(lanes_abs(tangential), (CONTACT_STICKS * friction) * load);
}

/* An operator in the rows that take part, factored contact after contact. */
struct contact_factors {
    lanes inverse[CONTACTS][2][2];        /* of each block less what earlier ones take, negated */
    lanes push[CONTACTS][CONTACTS][2][2]; /* c < k: impulse at c by that at k ... */
    lanes through[CONTACTS][CONTACTS][2][2]; /* ... and velocity at k by the impulse at c */
    mask regular;                            /* no pivot is small, nor negative */
};

/* The operator of the unknowns x in the rows that take part; of the others in `touching` rows of
 * the identity, so that to the bit nothing changes with contacts that do not. edge: NULL, or of
 * each grip r_T - x_T by r_N. */
HOT void contact_matrix(contact_set touching, const lanes (*D)[CONTACTS][2][2],
                        const mask (*rows)[2], const lanes *edge, lanes (*M)[CONTACTS][2][2])
{
    EACH_IN (c, touching) {
        EACH_IN (k, touching) {
            EACH (a, 0, 2)
                EACH (b, 0, 2) {
                    const int g = contact_grip(k);
                    M[c][k][a][b] = lanes_of(c == k && a == b);
                    if (a >= contact_unknowns(c) || b >= contact_unknowns(k))
                        continue;
                    lanes d = D[c][k][a][b];
                    if (edge && b == 0 && g >= 0)
                        d = lanes_fma(edge[g], D[c][g][a][1], d);
                    M[c][k][a][b] = choose(rows[c][a] & rows[k][b], d, M[c][k][a][b]);
                }
        }
    }
}

/* How pivots that are roundings of zero are treated: not at all; dependent contacts do nothing; one
 * of their rows does what is left to be done. */
enum contact_care { CONTACT_PLAIN, CONTACT_GUARDED, CONTACT_CAREFUL };

/* Inverts singular 2 by 2 blocks by their larger diagonal alone; by nothing, if that is zero, too.
 */
COLD void contact_invert_singular(mask singular, const lanes own[2], const lanes G[2][2],
                                  lanes inverse[2][2])
{
    const mask first = mask_less_equal(lanes_abs(G[1][1]), lanes_abs(G[0][0]));
    const lanes larger = choose(first, G[0][0], G[1][1]);
    const mask any =
        mask_less(CONTACT_RANK_GUARD * lanes_abs(choose(first, own[0], own[1])), lanes_abs(larger));
    const lanes reciprocal = -1 / choose(any, larger, lanes_of(INFINITY));
    inverse[0][0] = choose(singular, choose(first, reciprocal, lanes_of(0)), inverse[0][0]);
    inverse[1][1] = choose(singular, choose(first, lanes_of(0), reciprocal), inverse[1][1]);
    inverse[0][1] = choose(singular, lanes_of(0), inverse[0][1]);
    inverse[1][0] = choose(singular, lanes_of(0), inverse[1][0]);
}

/* Inverse of a contact's block G with the sign turned; own: its diagonal before others were
 * eliminated. Returns the lanes where it is regular. */
HOT mask contact_invert(int unknowns, enum contact_care care, const lanes own[2],
                        const lanes G[2][2], lanes inverse[2][2])
{
    lanes determinant = G[0][0], product = own[0];
    if (unknowns == 2) {
        determinant = lanes_fnma(G[0][1], G[1][0], G[0][0] * G[1][1]);
        product = own[0] * own[1];
    }
    lanes divisor = determinant;
    mask singular = MASK_NONE;
    if (care != CONTACT_PLAIN) {
        singular =
            LANES_NOT(mask_less(CONTACT_RANK_GUARD * lanes_abs(product), lanes_abs(determinant)));
        divisor = choose(singular, lanes_of(INFINITY), determinant);
    }
    const lanes reciprocal = 1 / divisor;
    if (unknowns == 1) {
        inverse[0][0] = -reciprocal;
    } else {
        inverse[0][0] = -(G[1][1] * reciprocal), inverse[0][1] = G[0][1] * reciprocal;
        inverse[1][0] = G[1][0] * reciprocal, inverse[1][1] = -(G[0][0] * reciprocal);
        if (care == CONTACT_CAREFUL && mask_any(singular)) { /* with copies: see project_along */
            lanes copy[2][2], same[2][2];
            const lanes before[2] = {own[0], own[1]};
            memcpy(copy, inverse, sizeof copy);
            memcpy(same, G, sizeof same);
            contact_invert_singular(singular, before, same, copy);
            memcpy(inverse, copy, sizeof copy);
        }
    }
    return mask_less(CONTACT_REGULAR * lanes_abs(product), determinant);
}

/* sum + row . x, of n unknowns. */
HOT lanes contact_row(int n, const lanes row[2], const lanes x[2], lanes sum)
{
    if (n == 2)
        sum = lanes_fma(row[1], x[1], sum);
    return lanes_fma(row[0], x[0], sum);
}
/* sum + A B, of blocks with n rows, m columns and `inner` between. */
HOT void contact_block(int n, int inner, int m, const lanes A[2][2], const lanes B[2][2],
                       lanes sum[2][2])
{
    EACH (a, 0, 2)
        EACH (b, 0, 2) {
            const lanes column[2] = {B[0][b], B[1][b]};
            if (a < n && b < m)
                sum[a][b] = contact_row(inner, A[a], column, sum[a][b]);
        }
}
/* The same; without a question in between where all are points, as most are. */
HOT void contact_product(int n, int inner, int m, const lanes A[2][2], const lanes B[2][2],
                         lanes sum[2][2])
{
    if (n + inner + m == 6)
        contact_block(2, 2, 2, A, B, sum);
    else
        contact_block(n, inner, m, A, B, sum);
}

/* Factors M, from contact_matrix, which is spoiled. */
HOT void contact_factor(contact_set touching, enum contact_care care, lanes (*M)[CONTACTS][2][2],
                        struct contact_factors *f)
{
    lanes own[CONTACTS][2];
    f->regular = LANES_ALL;
    EACH_IN (c, touching)
        own[c][0] = M[c][c][0][0], own[c][1] = M[c][c][1][1];
    EACH_IN (p, touching) {
        EACH (a, 0, 2)
            f->inverse[p][a][0] = f->inverse[p][a][1] = lanes_of(0);
        f->regular &= contact_invert(contact_unknowns(p), care, own[p], M[p][p], f->inverse[p]);
        const int n = contact_unknowns(p);
        EACH_IN_FROM (k, p + 1, touching) {
            EACH (b, 0, 2)
                EACH (a, 0, 2) {
                    f->through[p][k][b][a] = M[k][p][b][a];
                    f->push[p][k][a][b] = lanes_of(0);
                }
            contact_product(n, n, contact_unknowns(k), f->inverse[p], M[p][k], f->push[p][k]);
        }
        EACH_IN_FROM (i, p + 1, touching)
            EACH_IN_FROM (k, p + 1, touching)
                contact_product(contact_unknowns(i), n, contact_unknowns(k), f->through[p][i],
                                f->push[p][k], M[i][k]);
    }
}

/* Unknowns x that change the velocities by -u, which is zero in rows that take no part; x is zero,
 * + 0, there. */
HOT void contact_back(contact_set touching, const struct contact_factors *f, const lanes (*u)[2],
                      lanes (*x)[2])
{
    lanes left[CONTACTS][2];
    EACH_CONTACT (c, 0)
        x[c][0] = x[c][1] = lanes_of(0);
    EACH_IN (c, touching)
        left[c][0] = u[c][0], left[c][1] = u[c][1];
    EACH_IN (p, touching) {
        EACH (a, 0, 2)
            if (a < contact_unknowns(p))
                x[p][a] = contact_row(contact_unknowns(p), f->inverse[p][a], left[p], lanes_of(0));
        EACH_IN_FROM (k, p + 1, touching)
            EACH (b, 0, 2)
                if (b < contact_unknowns(k))
                    left[k][b] =
                        contact_row(contact_unknowns(p), f->through[p][k][b], x[p], left[k][b]);
    }
    for (int p = OWN_CONTACTS - 1; p >= 0; p--) {
        EACH (a, 0, 2) {
            if (!(touching >> p & 1) || a >= contact_unknowns(p))
                continue;
            EACH_IN_FROM (k, p + 1, touching)
                x[p][a] = contact_row(contact_unknowns(k), f->push[p][k][a], x[k], x[p][a]);
            x[p][a] = x[p][a] + 0.0;
        }
    }
}

/* Rows that take part in a mode in which the contacts in `closed` carry and grips in `sticks`
 * stick. */
HOT void contact_mode_rows(const mask *closed, const mask *sticks, mask (*rows)[2])
{
    EACH_CONTACT (c, 0) {
        rows[c][0] = closed[c];
        rows[c][1] = contact_unknowns(c) == 2 ? contact_part(c, closed) & sticks[c] : MASK_NONE;
    }
}

/* Impulses r that bring the velocities uf of contacts in `closed` to rest, those of grips that slip
 * along their normals alone; edge as in contact_matrix (NULL: all stick). Zero elsewhere. Returns
 * the lanes where the operator is regular. */
HOT mask contact_rest(contact_set touching, enum contact_care care,
                      const lanes (*D)[CONTACTS][2][2], const lanes (*uf)[2], const mask (*rows)[2],
                      const lanes *edge, lanes (*r)[2])
{
    struct contact_factors f;
    lanes M[CONTACTS][CONTACTS][2][2], u[CONTACTS][2];
    contact_matrix(touching, D, rows, edge, M);
    contact_factor(touching, care, M, &f);
    EACH_IN (c, touching)
        EACH (a, 0, 2)
            u[c][a] = choose(rows[c][a], uf[c][a], lanes_of(0));
    contact_back(touching, &f, u, r);
    EACH_IN (c, touching)
        if (edge && contact_unknowns(c) == 2)
            r[c][1] = lanes_fma(edge[c], contact_load(c, r), r[c][1]);
    return f.regular;
}

/* A contact problem, and what is asked of its solution. */
struct contact_problem {
    const lanes (*D)[CONTACTS][2][2]; /* of contacts in `touching` ... */
    const lanes (*uf)[2];             /* ... with their free velocities */
    contact_set touching;
    const mask *active; /* of all contacts */
    lanes friction;
    lanes prefer; /* of several solutions that with the least kinetic energy: 1; the most: -1 */
    /* NULL, or for each grip 0 or the sign of a slip that goes on whatever the impulse: for
     * accelerations, where D and uf are those of the contacts and r are forces. */
    const lanes *sliding;
    const lanes (*shift)[2]; /* NULL, or what restitution adds to each contact's uf, m/s */
    bool indefinite;         /* D is neither symmetric nor positive */
    /* NULL, or impulses of the iterate or step before, in the lanes of `known`: of several
     * solutions that in their mode is taken, preferred or not. What goes on takes no decision. */
    const lanes (*last)[2];
    mask known;
};

/* A problem of which nothing else is known, nor asked. */
HOT struct contact_problem contact_pose(const lanes (*D)[CONTACTS][2][2], const lanes (*uf)[2],
                                        contact_set touching, const mask *active, lanes friction,
                                        lanes prefer)
{
    return (struct contact_problem){.D = D,
                                    .uf = uf,
                                    .touching = touching,
                                    .active = active,
                                    .friction = friction,
                                    .prefer = prefer};
}

/* Largest violations of the laws, m/s, of what is a solution, `most`, and of what is one to
 * rounding, `exact`. Over a very short time velocities change by no more than the first, which
 * admits every mode, also one that pulls a foot into the ground: such are taken only where none is
 * exact. What they leave behind is beside every mode: of two feet of which one slides each would
 * stop and slide in turn, without end. */
struct contact_tolerance {
    lanes exact, most;
};
HOT struct contact_tolerance contact_tolerance(lanes largest)
{
    return (struct contact_tolerance){CONTACT_TOLERANCE *
                                          lanes_max(largest, lanes_of(CONTACT_STILL)),
                                      CONTACT_TOLERANCE * lanes_max(largest, lanes_of(1))};
}

/* What is said of a solution, in lanes. */
struct contact_verdict {
    mask ambiguous; /* there are others, with other velocities */
    mask unsolved;  /* there is none */
    mask unranked;  /* too many contacts to know whether it is the one that is preferred */
};

#endif
