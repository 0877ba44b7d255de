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
 * kinetic energy, r.(uf + u)/2 added by the impulses; ties go to the earlier mode in the order
 * open, stick, forward, backward. Where the operator is indefinite the solution with the most
 * contacts that carry, ties as before. Where legs are parallel the operator is singular with both
 * feet sticking (rank 3 of 4): the redundant impulse is set to zero, velocities stay unique, guard
 * 1e-13. D need not be symmetric (an exact Newton linearisation is not) nor positive (where a law
 * answers contact forces at once it is not).
 */
#ifndef STANCE_CORE_CONTACT_H
#define STANCE_CORE_CONTACT_H

#include "lanes.h"

#define CONTACT_RANK_GUARD 1e-13
#define CONTACT_ENDLESS 1e300
#define CONTACT_TOLERANCE 1e-11 /* of the largest free velocity (at least 1 m/s) */

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
    lanes friction;
    lanes tolerance; /* admitted violation, m/s */
    int contacts;    /* 1 or 2 */
    bool indefinite; /* D is neither symmetric nor positive */
} contact_problem;

enum contact_mode { CONTACT_OPEN, CONTACT_STICK, CONTACT_FORWARD, CONTACT_BACKWARD, CONTACT_MODES };

/* Takes a candidate r where it is better than the choice: u and all laws are checked here, so a
 * candidate from a meaningless elimination is just a bad one. Not a number never wins. */
static inline void contact_offer(const contact_problem *p, lanes r[2][2], contact_choice *best)
{
    lanes u[2][2], violation = lanes_of(0), energy = lanes_of(0), apart = lanes_of(0);
    for (int i = 0; i < p->contacts; i++) {
        for (int a = 0; a < 2; a++) {
            u[i][a] = p->uf[i][a];
            for (int j = 0; j < p->contacts; j++)
                u[i][a] += p->D[i][j][a][0] * r[j][0] + p->D[i][j][a][1] * r[j][1];
            energy += 0.5 * (r[i][a] * (p->uf[i][a] + u[i][a]));
            apart = lanes_max(lanes_abs(u[i][a] - best->u[i][a]), apart);
        }
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
    }
    const mask number = mask_finite(energy) & mask_finite(violation);
    const mask valid = number & mask_less_equal(violation, p->tolerance);
    const mask have = mask_less_equal(best->violation, p->tolerance);
    const lanes tie = 1e-12 * (lanes_abs(energy) + lanes_abs(best->energy));
    const mask better =
        (valid & LANES_NOT(have)) | (valid & have & mask_less(energy, best->energy - tie)) |
        (number & LANES_NOT(valid) & LANES_NOT(have) & mask_less(violation, best->violation));
    best->ambiguous |= valid & have & mask_less(16 * p->tolerance, apart);
    for (int i = 0; i < p->contacts; i++)
        for (int a = 0; a < 2; a++) {
            best->r[i][a] = choose(better, r[i][a], best->r[i][a]);
            best->u[i][a] = choose(better, u[i][a], best->u[i][a]);
        }
    best->violation = choose(better, violation, best->violation);
    best->energy = choose(better, energy, best->energy);
}

/* Impulse that one contact with operator D and free velocity uf needs in a mode. */
static inline void contact_impulse(enum contact_mode mode, bool indefinite, const lanes D[2][2],
                                   const lanes uf[2], lanes friction, lanes r[2])
{
    if (mode == CONTACT_OPEN) {
        r[0] = r[1] = lanes_of(0);
    } else if (mode == CONTACT_STICK) {
        const lanes product = D[0][0] * D[1][1];
        const lanes determinant = product - D[0][1] * D[1][0];
        /* Of a positive operator a negative determinant is a rounding of zero. */
        const mask regular = mask_less(CONTACT_RANK_GUARD * lanes_abs(product),
                                       indefinite ? lanes_abs(determinant) : determinant);
        const lanes reciprocal = 1 / choose(regular, determinant, lanes_of(1));
        /* Singular: the larger diagonal alone does the work, the other row follows. */
        const mask normal = mask_less_equal(lanes_abs(D[1][1]), lanes_abs(D[0][0]));
        const lanes larger = choose(normal, D[0][0], D[1][1]);
        const lanes single = -choose(normal, uf[0], uf[1]) /
                             choose(mask_less(lanes_of(0), lanes_abs(larger)), larger, lanes_of(1));
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

/* Contact 0 in `mode`, contact 1 in each of its modes. */
static inline void contact_eliminate(const contact_problem *p, enum contact_mode mode,
                                     contact_choice *best)
{
    lanes D[2][2], uf[2], push[2][2], alone[2];
    /* Impulse of contact 0 in its mode, affine in that of contact 1: alone + push r1. */
    contact_impulse(mode, p->indefinite, p->D[0][0], p->uf[0], p->friction, alone);
    for (int b = 0; b < 2; b++) {
        const lanes coupling[2] = {p->D[0][1][0][b], p->D[0][1][1][b]};
        lanes column[2];
        contact_impulse(mode, p->indefinite, p->D[0][0], coupling, p->friction, column);
        push[0][b] = column[0], push[1][b] = column[1];
    }
    for (int a = 0; a < 2; a++) {
        uf[a] = p->uf[1][a] + p->D[1][0][a][0] * alone[0] + p->D[1][0][a][1] * alone[1];
        for (int b = 0; b < 2; b++)
            D[a][b] =
                p->D[1][1][a][b] + p->D[1][0][a][0] * push[0][b] + p->D[1][0][a][1] * push[1][b];
    }
    for (enum contact_mode other = CONTACT_OPEN; other < CONTACT_MODES; other++) {
        lanes r[2][2];
        contact_impulse(other, p->indefinite, D, uf, p->friction, r[1]);
        for (int a = 0; a < 2; a++)
            r[0][a] = alone[a] + push[a][0] * r[1][0] + push[a][1] * r[1][1];
        contact_offer(p, r, best);
    }
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
    for (enum contact_mode mode = CONTACT_OPEN; mode < CONTACT_MODES; mode++) {
        if (p->contacts == 2) {
            contact_eliminate(p, mode, best);
        } else {
            lanes r[2][2] = {{lanes_of(0), lanes_of(0)}, {lanes_of(0), lanes_of(0)}};
            contact_impulse(mode, p->indefinite, p->D[0][0], p->uf[0], p->friction, r[0]);
            contact_offer(p, r, best);
        }
    }
    for (int i = 0; i < p->contacts; i++) {
        best->r[i][0] = lanes_max(best->r[i][0], lanes_of(0));
        const lanes bound = p->friction * best->r[i][0];
        best->r[i][1] = lanes_max(lanes_min(best->r[i][1], bound), -bound);
    }
}

#endif
