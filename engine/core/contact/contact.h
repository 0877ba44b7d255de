/* contact.h - the planar Signorini-Coulomb problem of one step, solved exactly by enumeration.
 *
 * Given the velocities without contact impulses uf (normal, tangential for each contact; the
 * normal one already shifted by the restitution term e U-) and the Delassus operator D, find
 * impulses r and velocities u = uf + D r such that for each active contact
 *
 *   0 <= u_N  _|_  r_N >= 0      (Signorini, at velocity level),
 *   |r_T| <= mu r_N,  r_T = -mu r_N sign(u_T) where u_T != 0      (Coulomb),
 *
 * the paper's laws of figures 5 and 6. Each contact is open, sticks, or slips forward or backward;
 * in a given mode the problem is linear. One contact has four modes, two contacts sixteen: contact
 * 0 is eliminated in each of its modes, which leaves a one-contact problem for contact 1.
 *
 * Choice among several solutions (frictional impacts have them): the one that leaves the least
 * kinetic energy, or, `most`, the most of it. The impulses add r.v + r.D r / 2 with v the true free
 * velocity, uf without the restitution term. Without such a term the minimum of that over all r is
 * at D r = -uf: all contacts sticking, whenever it lies in the cones, leaves the least. Ties go to
 * both contacts sticking, then to the earlier mode in the order open, stick, forward, backward.
 * Where the operator is indefinite it is the solution with the most contacts that carry, ties as
 * before.
 *
 * Where legs are parallel the operator is singular with both feet sticking (rank 3 of 4):
 * velocities stay unique, and of the impulses those in the middle of what the cones admit
 * are taken. D need not be symmetric (an exact Newton linearisation is not) nor positive (where a
 * law answers contact forces at once it is not).
 */
#ifndef STANCE_CORE_CONTACT_CONTACT_H
#define STANCE_CORE_CONTACT_CONTACT_H

#include "engine/core/lanes/lanes.h"

#define CONTACT_RANK_GUARD 1e-13
#define CONTACT_PARALLEL 1e-9 /* determinants this small are looked at, see contact_share */
#define CONTACT_ENDLESS 1e300
#define CONTACT_STICKS (1 - 1e-9) /* of the cone: an impulse inside it sticks */
#define CONTACT_ROUNDING 1e6      /* tolerances: what an elimination may lose by cancellation */
#define CONTACT_TOLERANCE 1e-11   /* of the largest free velocity (at least 1 m/s) */

/* The best solution found so far, in each lane. */
typedef struct contact_choice {
    lanes r[2][2]; /* [contact][normal, tangential] */
    lanes u[2][2];
    lanes violation; /* largest violation of a law, as a velocity */
    lanes energy;    /* kinetic energy added */
    mask ambiguous;  /* another solution with other velocities exists */
} contact_choice;

typedef struct contact_problem {
    const lanes (
        *D)[2][2][2]; /* D[i][j][a][b]: velocity a of contact i per impulse b of contact j */
    const lanes (*uf)[2];
    /* NULL, or for each contact 0 or the sign of a slip that goes on whatever the impulse: for
     * accelerations, where D and uf are those of the contacts and r are forces. */
    const lanes *sliding;
    const lanes *shift; /* NULL, or the restitution term in each contact's normal uf, m/s, <= 0 */
    lanes friction;
    lanes prefer;    /* of several solutions the one with the least kinetic energy: 1, most: -1 */
    lanes tolerance; /* admitted violation, m/s */
    int contacts;    /* 1 or 2 */
    bool indefinite; /* D is neither symmetric nor positive */
} contact_problem;

enum contact_mode { CONTACT_OPEN, CONTACT_STICK, CONTACT_FORWARD, CONTACT_BACKWARD, CONTACT_MODES };

/* Velocities with the impulses r. */
static inline void contact_velocities(const contact_problem *p, const lanes r[2][2], lanes u[2][2])
{
    for (int i = 0; i < p->contacts; i++)
        for (int a = 0; a < 2; a++) {
            u[i][a] = p->uf[i][a];
            for (int j = 0; j < p->contacts; j++)
                u[i][a] += p->D[i][j][a][0] * r[j][0] + p->D[i][j][a][1] * r[j][1];
        }
}

/* Takes a candidate r where it is better than the choice: its velocities u (out) and all laws are
 * checked here, so a candidate from a meaningless elimination is just a bad one. Not a number never
 * wins. Returns by how much it violates a law at most. */
static inline lanes contact_offer(const contact_problem *p, const lanes r[2][2], lanes u[2][2],
                                  contact_choice *best)
{
    lanes violation = lanes_of(0), energy = lanes_of(0), apart = lanes_of(0);
    contact_velocities(p, r, u);
    for (int i = 0; i < p->contacts; i++) {
        for (int a = 0; a < 2; a++) {
            energy += 0.5 * (r[i][a] * (p->uf[i][a] + u[i][a]));
            apart = lanes_max(lanes_abs(u[i][a] - best->u[i][a]), apart);
        }
        if (p->shift)
            energy -= r[i][0] * p->shift[i];
        const lanes normal = lanes_abs(p->D[i][i][0][0]);
        const lanes tangential = lanes_abs(p->D[i][i][1][1]);
        const lanes bound = p->friction * r[i][0];
        violation = lanes_max(-u[i][0], violation);
        violation = lanes_max(-(r[i][0] * normal), violation);
        /* Complementarity: what is apart must not push. */
        violation =
            lanes_max(lanes_min(lanes_abs(u[i][0]), lanes_abs(r[i][0] * normal)), violation);
        violation = lanes_max((lanes_abs(r[i][1]) - bound) * tangential, violation);
        /* Maximum dissipation: slip means an impulse at the edge of the cone, against it. */
        lanes slip = u[i][1];
        if (p->sliding) /* no acceleration turns a slip around at once */
            slip = choose(mask_less(lanes_of(0), lanes_abs(p->sliding[i])),
                          CONTACT_ENDLESS * p->sliding[i], slip);
        const lanes room = choose(mask_less(slip, lanes_of(0)), bound - r[i][1], bound + r[i][1]);
        violation = lanes_max(lanes_min(lanes_abs(slip), room * tangential), violation);
    }
    if (p->indefinite) { /* no energy to compare: stay on the ground where that is possible */
        const lanes size = lanes_abs(energy);
        energy = 0 * size;
        for (int i = 0; i < p->contacts; i++)
            energy -= choose(mask_less(lanes_of(0), r[i][0]), lanes_of(1), lanes_of(0));
    } else {
        energy = p->prefer * energy;
    }
    const mask number = mask_finite(energy) & mask_finite(violation);
    const mask valid = number & mask_less_equal(violation, p->tolerance);
    const mask have = mask_less_equal(best->violation, p->tolerance);
    const lanes tie = 1e-12 * (lanes_abs(energy) + lanes_abs(best->energy));
    /* With the same velocities it is the same solution, whatever rounding makes of its energy. */
    const mask other = valid & have & mask_less(16 * p->tolerance, apart);
    const mask better =
        (valid & LANES_NOT(have)) | (other & mask_less(energy, best->energy - tie)) |
        (number & LANES_NOT(valid) & LANES_NOT(have) & mask_less(violation, best->violation));
    best->ambiguous |= other;
    for (int i = 0; i < p->contacts; i++)
        for (int a = 0; a < 2; a++) {
            best->r[i][a] = choose(better, r[i][a], best->r[i][a]);
            best->u[i][a] = choose(better, u[i][a], best->u[i][a]);
        }
    best->violation = choose(better, violation, best->violation);
    best->energy = choose(better, energy, best->energy);
    return violation;
}

/* Impulse that one contact with operator D and free velocity uf needs in a mode. D may be what the
 * elimination of another contact has left of its operator `own`: what is left of the order of
 * rounding is nothing. */
static inline void contact_impulse(enum contact_mode mode, const lanes own[2][2],
                                   const lanes D[2][2], const lanes uf[2], lanes friction,
                                   lanes r[2])
{
    if (mode == CONTACT_OPEN) {
        r[0] = r[1] = lanes_of(0);
    } else if (mode == CONTACT_STICK) {
        const lanes determinant = D[0][0] * D[1][1] - D[0][1] * D[1][0];
        const mask regular = mask_less(CONTACT_RANK_GUARD * lanes_abs(own[0][0] * own[1][1]),
                                       lanes_abs(determinant));
        const lanes reciprocal = 1 / choose(regular, determinant, lanes_of(1));
        /* Singular: the larger diagonal alone does the work, the other row follows. */
        const mask normal = mask_less_equal(lanes_abs(D[1][1]), lanes_abs(D[0][0]));
        const lanes larger = choose(normal, D[0][0], D[1][1]);
        const lanes before = choose(normal, own[0][0], own[1][1]);
        const mask any = mask_less(CONTACT_RANK_GUARD * lanes_abs(before), lanes_abs(larger));
        const lanes single = choose(
            any, -choose(normal, uf[0], uf[1]) / choose(any, larger, lanes_of(1)), lanes_of(0));
        r[0] = choose(regular, (D[0][1] * uf[1] - D[1][1] * uf[0]) * reciprocal,
                      choose(normal, single, lanes_of(0)));
        r[1] = choose(regular, (D[1][0] * uf[0] - D[0][0] * uf[1]) * reciprocal,
                      choose(normal, lanes_of(0), single));
    } else {
        const lanes edge = mode == CONTACT_FORWARD ? -friction : friction;
        r[0] = -uf[0] / (D[0][0] + edge * D[0][1]);
        r[1] = edge * r[0];
    }
}

/* Both contacts stick, and what contact 0 leaves of the operator of contact 1 is singular, or as
 * good as that: among the impulses that do the same, those in the middle of what the cones admit.
 * Moves r there, in these lanes, where the cones admit any. */
static inline void contact_share(const contact_problem *p, const lanes push[2][2],
                                 const lanes D[2][2], lanes r[2][2])
{
    const lanes determinant = D[0][0] * D[1][1] - D[0][1] * D[1][0];
    const lanes own = p->D[1][1][0][0] * p->D[1][1][1][1];
    const mask singular =
        mask_less_equal(lanes_abs(determinant), CONTACT_PARALLEL * lanes_abs(own));
    if (!mask_any(singular))
        return;
    lanes n[2][2], low = lanes_of(-INFINITY), high = lanes_of(INFINITY);
    const mask first = mask_less_equal(lanes_abs(D[1][1]), lanes_abs(D[0][0]));
    n[1][0] = choose(first, -D[0][1], D[1][1]);
    n[1][1] = choose(first, D[0][0], -D[1][0]);
    for (int a = 0; a < 2; a++)
        n[0][a] = push[a][0] * n[1][0] + push[a][1] * n[1][1];
    for (int i = 0; i < 2; i++)
        for (int side = -1; side <= 1; side += 2) { /* mu r_N + side r_T >= 0 along r + x n */
            const lanes room = p->friction * r[i][0] + side * r[i][1];
            const lanes rate = p->friction * n[i][0] + side * n[i][1];
            const lanes edge = -room / rate;
            low = choose(mask_less(lanes_of(0), rate), lanes_max(edge, low), low);
            high = choose(mask_less(rate, lanes_of(0)), lanes_min(edge, high), high);
        }
    const lanes middle = 0.5 * (low + high);
    mask moves = singular & mask_less_equal(low, high) & mask_finite(middle);
    for (int a = 0; a < 2; a++)
        moves &= mask_less_equal(lanes_abs(middle * (D[a][0] * n[1][0] + D[a][1] * n[1][1])),
                                 0.25 * p->tolerance);
    for (int i = 0; i < 2; i++)
        for (int a = 0; a < 2; a++)
            r[i][a] = choose(moves, r[i][a] + middle * n[i][a], r[i][a]);
}

/* Contact 0 in `mode` with its answer `push` to an impulse of contact 1, which sees the operator D
 * then and is in mode `other`: adds the impulses that velocities uf need to r. */
static inline void contact_candidate(const contact_problem *p, enum contact_mode mode,
                                     const lanes push[2][2], enum contact_mode other,
                                     const lanes D[2][2], const lanes uf[2][2], lanes r[2][2])
{
    lanes alone[2], uf1[2], second[2];
    contact_impulse(mode, p->D[0][0], p->D[0][0], uf[0], p->friction, alone);
    for (int a = 0; a < 2; a++)
        uf1[a] = uf[1][a] + p->D[1][0][a][0] * alone[0] + p->D[1][0][a][1] * alone[1];
    contact_impulse(other, p->D[1][1], D, uf1, p->friction, second);
    for (int a = 0; a < 2; a++) {
        r[0][a] += alone[a] + push[a][0] * second[0] + push[a][1] * second[1];
        r[1][a] += second[a];
    }
}

/* Contact 0 in `mode`: how it answers impulses of contact 1, and the operator that this one sees.
 */
static inline void contact_reduce(const contact_problem *p, enum contact_mode mode,
                                  lanes push[2][2], lanes D[2][2])
{
    for (int b = 0; b < 2; b++) {
        const lanes coupling[2] = {p->D[0][1][0][b], p->D[0][1][1][b]};
        lanes column[2];
        contact_impulse(mode, p->D[0][0], p->D[0][0], coupling, p->friction, column);
        push[0][b] = column[0], push[1][b] = column[1];
    }
    for (int a = 0; a < 2; a++)
        for (int b = 0; b < 2; b++)
            D[a][b] =
                p->D[1][1][a][b] + p->D[1][0][a][0] * push[0][b] + p->D[1][0][a][1] * push[1][b];
}

/* The candidates of contact 0 in `mode`, contact 1 in each of its modes; but not of both sticking.
 */
static inline void contact_eliminate(const contact_problem *p, enum contact_mode mode,
                                     contact_choice *best)
{
    lanes D[2][2], push[2][2];
    contact_reduce(p, mode, push, D);
    for (enum contact_mode other = CONTACT_OPEN; other < CONTACT_MODES; other++) {
        lanes r[2][2], u[2][2];
        if (mode == CONTACT_STICK && other == CONTACT_STICK)
            continue;
        for (int i = 0; i < 2; i++)
            r[i][0] = r[i][1] = lanes_of(0);
        contact_candidate(p, mode, (const lanes(*)[2])push, other, (const lanes(*)[2])D, p->uf, r);
        const lanes violation = contact_offer(p, (const lanes(*)[2])r, u, best);
        /* Once more with what is left where that may be rounding: contact 0 may slide on the verge
         * of having no answer. (To offer the same twice changes nothing.) */
        const mask near = mask_less(p->tolerance, violation) &
                          mask_less(violation, CONTACT_ROUNDING * p->tolerance);
        if (!mask_any(near))
            continue;
        lanes more[2][2];
        memcpy(more, r, sizeof more);
        contact_candidate(p, mode, (const lanes(*)[2])push, other, (const lanes(*)[2])D,
                          (const lanes(*)[2])u, more);
        for (int i = 0; i < 2; i++)
            for (int a = 0; a < 2; a++)
                r[i][a] = choose(near, more[i][a], r[i][a]);
        contact_offer(p, (const lanes(*)[2])r, u, best);
    }
}

/* Both contacts stick, whatever the operator: r, once more with what is left. Returns the lanes
 * where that obeys the laws. */
COLD mask contact_stick_both(const contact_problem *p, lanes r[2][2])
{
    lanes D[2][2], push[2][2], u[2][2];
    mask good = LANES_ALL;
    memcpy(u, p->uf, sizeof u);
    contact_reduce(p, CONTACT_STICK, push, D);
    for (int i = 0; i < 2; i++)
        r[i][0] = r[i][1] = lanes_of(0);
    for (int round = 0; round < 2; round++) {
        contact_candidate(p, CONTACT_STICK, (const lanes(*)[2])push, CONTACT_STICK,
                          (const lanes(*)[2])D, (const lanes(*)[2])u, r);
        contact_velocities(p, (const lanes(*)[2])r, u);
    }
    contact_share(p, (const lanes(*)[2])push, (const lanes(*)[2])D, r);
    contact_velocities(p, (const lanes(*)[2])r, u);
    for (int i = 0; i < 2; i++) {
        for (int a = 0; a < 2; a++)
            good &= mask_less_equal(lanes_abs(u[i][a]), p->tolerance);
        good &= mask_less_equal(lanes_abs(r[i][1]), p->friction * r[i][0]);
    }
    return good;
}

/* Solves the problem of the active contacts (p->contacts of them). r is put exactly inside the
 * cone. The solution violates no law by more than p->tolerance where violation says so. */
COLD void contact_solve(const contact_problem *p, contact_choice *best)
{
    for (int i = 0; i < 2; i++)
        for (int a = 0; a < 2; a++)
            best->r[i][a] = lanes_of(0), best->u[i][a] = lanes_of(0);
    best->violation = lanes_of(INFINITY);
    best->energy = lanes_of(INFINITY);
    best->ambiguous = MASK_NONE;
    if (p->contacts == 2) {
        lanes r[2][2], u[2][2];
        contact_stick_both(p, r);
        contact_offer(p, (const lanes(*)[2])r, u, best);
    }
    for (enum contact_mode mode = CONTACT_OPEN; mode < CONTACT_MODES; mode++) {
        if (p->contacts == 2) {
            contact_eliminate(p, mode, best);
        } else {
            lanes r[2][2] = {{lanes_of(0), lanes_of(0)}, {lanes_of(0), lanes_of(0)}}, u[2][2];
            contact_impulse(mode, p->D[0][0], p->D[0][0], p->uf[0], p->friction, r[0]);
            contact_offer(p, (const lanes(*)[2])r, u, best);
        }
    }
    for (int i = 0; i < p->contacts; i++) {
        best->r[i][0] = lanes_max(best->r[i][0], lanes_of(0));
        const lanes bound = p->friction * best->r[i][0];
        best->r[i][1] = lanes_max(lanes_min(best->r[i][1], bound), -bound);
    }
}

#endif
