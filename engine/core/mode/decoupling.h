/* decoupling.h - torques that make chosen coordinates accelerate as wanted, whatever the ground
 * does: the paper's dynamical decoupling, its equations (26) to (30), solved with the reactions.
 *
 * With a0 the accelerations without torques and reactions, Y = A^-1 B the responses to the torques,
 * R = A^-1 H^T those to the reactions, and S the rows that take an acceleration to the controlled
 * coordinates,
 *
 *   G torque = e - S (a0 + R lambda) - S' w,     G = S Y.
 *
 * G is the inverse of the paper's A_rs: with c the controlled coordinates and f the others, A_rs is
 * the Schur complement of A_ff in A, so det A_rs = +-det A / det A_ff, and A being positive
 * definite A_rs is never singular. What can happen is that A_ff is: then G is singular, and no
 * torques give these accelerations.
 *
 * The torques answer the reactions at once, so the contacts see another operator,
 *
 *   gamma = (D + H Y K) lambda + (gamma_f + H Y torque_0),    K = -G^-1 S R,
 *
 * which is neither symmetric nor positive, and contact/ solves the laws with it: reactions and
 * torques together. Taking the reactions of the moment before instead is an iteration that diverges
 * wherever H Y K outweighs D. The limit of the torques is applied afterwards.
 *
 * On feet that stand the robot's own G may be near singular where that of the robot that they hold
 * is not: a straight knee carries it. Where the condition number of G (SI units) is above
 * DECOUPLING_CONDITION and no contact slides the torques are those with which all contacts stick,
 * if the reactions are inside their cones: then they obey the laws, too.
 *
 * The law degrades, and says so, in two cases. Where that does not help the inverse of G is damped
 * (Nakamura and Hanafusa, J. Dyn. Sys. Meas. Control 108, 1986): G^T (G G^T + d I)^-1, with d
 * growing from zero at that bound, so that torques stay continuous and finite. And where no
 * reactions fit the laws together with the torques - the accelerations that are wanted would take a
 * ground that pulls - the reactions are those without torques.
 */
#ifndef STANCE_CORE_MODE_DECOUPLING_H
#define STANCE_CORE_MODE_DECOUPLING_H

#include "dynamics.h"

#define DECOUPLING_CONDITION STANCE_ILL_CONDITIONED /* of G: then its inverse is damped */

/* What each contact does in the state that *e belongs to; contact velocities up to `rest` are
 * zero. */
static inline void decoupling_contacts(const struct setting *set, const struct dynamics *e,
                                       lanes rest, struct contact_state *contact)
{
    for (int c = 0; c < OWN_CONTACTS; c++) {
        contact->closed[c] =
            motion_closed(set, e->gap, c) & mask_less_equal(lanes_abs(e->u[c][0]), rest);
        contact->slide[c] = contact_unknowns(c) == 1 ? lanes_of(0) : lanes_sign(e->u[c][1], rest);
    }
}

#ifdef SCENE_SERVOS

/* The controlled rates, by their rows, of what moves the coordinates of the core by x. */
static inline void decoupling_rates(const struct setting *set, const scene_trig *trig,
                                    const lanes (*row)[SCENE_COORDINATES], const lanes *x,
                                    lanes *out)
{
    lanes rate[SCENE_COORDINATES];
    scene_coordinate_rates(&set->body, trig, x, rate);
    for (int j = 0; j < OWN_ACTUATORS; j++) {
        out[j] = lanes_of(0);
        for (int k = 0; k < SCENE_COORDINATES; k++)
            out[j] += row[j][k] * rate[k];
    }
}

/* Inverse of G by Gauss and Jordan with the largest pivot of each column; not finite where it is
 * singular. */
static inline void decoupling_invert(lanes G[ACTUATORS][ACTUATORS],
                                     lanes inverse[ACTUATORS][ACTUATORS])
{
    const int m = OWN_ACTUATORS;
    for (int i = 0; i < m; i++)
        for (int j = 0; j < m; j++)
            inverse[i][j] = lanes_of(i == j);
    for (int k = 0; k < m; k++) {
        for (int i = k + 1; i < m; i++) {
            const mask larger = mask_less(lanes_abs(G[k][k]), lanes_abs(G[i][k]));
            for (int j = 0; j < m; j++) {
                const lanes a = G[k][j], b = inverse[k][j];
                G[k][j] = choose(larger, G[i][j], a), G[i][j] = choose(larger, a, G[i][j]);
                inverse[k][j] = choose(larger, inverse[i][j], b);
                inverse[i][j] = choose(larger, b, inverse[i][j]);
            }
        }
        const lanes reciprocal = 1 / G[k][k];
        for (int j = 0; j < m; j++)
            G[k][j] = G[k][j] * reciprocal, inverse[k][j] = inverse[k][j] * reciprocal;
        for (int i = 0; i < m; i++) {
            const lanes factor = G[i][k];
            for (int j = 0; j < m && i != k; j++) {
                G[i][j] -= factor * G[k][j];
                inverse[i][j] -= factor * inverse[k][j];
            }
        }
    }
}

/* Sum of the squares of all elements. */
static inline lanes decoupling_size(lanes G[ACTUATORS][ACTUATORS])
{
    lanes sum = lanes_of(0);
    for (int i = 0; i < OWN_ACTUATORS; i++)
        for (int j = 0; j < OWN_ACTUATORS; j++)
            sum += G[i][j] * G[i][j];
    return sum;
}

/* Inverse of G, damped in the lanes that are returned. */
static inline mask decoupling_inverse(lanes G[ACTUATORS][ACTUATORS],
                                      lanes inverse[ACTUATORS][ACTUATORS])
{
    const int m = OWN_ACTUATORS;
    lanes left[ACTUATORS][ACTUATORS];
    const lanes size = decoupling_size(G);
    memcpy(left, G, sizeof left);
    decoupling_invert(left, inverse);
    /* The condition number is |G| |G^-1|, of Frobenius' norms; 1 / |G^-1| is about the least
     * singular value. */
    const lanes bound = lanes_of(DECOUPLING_CONDITION * DECOUPLING_CONDITION);
    const lanes back = decoupling_size(inverse);
    const mask damped = LANES_NOT(mask_less_equal(size * back, bound));
    if (mask_any(damped)) {
        const lanes known = choose(mask_finite(back), back, lanes_of(INFINITY));
        const lanes d = size / bound - 1 / known;
        lanes K[ACTUATORS][ACTUATORS], other[ACTUATORS][ACTUATORS];
        for (int i = 0; i < m; i++)
            for (int j = 0; j < m; j++) {
                K[i][j] = i == j ? d : lanes_of(0);
                for (int k = 0; k < m; k++)
                    K[i][j] += G[i][k] * G[j][k];
            }
        decoupling_invert(K, other);
        for (int i = 0; i < m; i++)
            for (int j = 0; j < m; j++) {
                lanes sum = lanes_of(0);
                for (int k = 0; k < m; k++)
                    sum += G[k][i] * other[k][j];
                inverse[i][j] = choose(damped, sum, inverse[i][j]);
            }
    }
    return damped;
}

/* Contact accelerations (normal, tangential) by a unit of each torque. */
static inline void decoupling_reach(const struct setting *set, const struct dynamics *e,
                                    contact_set touching, lanes (*reach)[ACTUATORS][2])
{
    for (int c = 0; c < OWN_CONTACTS; c++)
        for (int i = 0; i < OWN_ACTUATORS; i++) {
            reach[c][i][0] = reach[c][i][1] = lanes_of(0);
            if (touching >> c & 1)
                scene_contact_velocity(&set->body, &e->trig, c, e->push[i], reach[c][i]);
        }
}

/* What the torques are to answer: contacts in `touching`, what each does, the rows of what is
 * controlled, and the equations. */
struct decoupling {
    const struct setting *set;
    contact_set touching;
    const struct contact_state *contact;
    const lanes (*row)[SCENE_COORDINATES];
    struct dynamics *e;
};

/* Adds to torque[] what the reactions change, e->several where more than one set of them fits;
 * returns the lanes where none does. */
static inline mask decoupling_react(const struct decoupling *of, mask where,
                                    lanes inverse[ACTUATORS][ACTUATORS], lanes *torque)
{
    const struct setting *const set = of->set;
    const contact_set touching = of->touching;
    struct dynamics *const e = of->e;
    struct {
        lanes D[CONTACTS][CONTACTS][2][2], free[CONTACTS][2], r[CONTACTS][2];
    } problem;
    lanes reach[CONTACTS][ACTUATORS][2], answer[CONTACTS][2][ACTUATORS];
    struct contact_verdict verdict;
    mask part[CONTACTS], none = MASK_NONE, several = MASK_NONE;
    decoupling_reach(set, e, touching, reach);
    for (int c = 0; c < OWN_CONTACTS; c++) {
        part[c] = where & of->contact->closed[c];
        for (int a = 0; a < 2; a++) {
            lanes rate[ACTUATORS];
            problem.free[c][a] = lanes_of(0);
            for (int i = 0; i < OWN_ACTUATORS; i++)
                answer[c][a][i] = lanes_of(0);
            if (!(touching >> c & 1))
                continue;
            decoupling_rates(set, &e->trig, of->row, e->response[c][a], rate);
            problem.free[c][a] = e->free[c][a];
            for (int i = 0; i < OWN_ACTUATORS; i++) {
                problem.free[c][a] += reach[c][i][a] * torque[i];
                for (int j = 0; j < OWN_ACTUATORS; j++)
                    answer[c][a][i] -= inverse[i][j] * rate[j];
            }
        }
    }
    for (int c = 0; c < OWN_CONTACTS; c++)
        for (int k = 0; k < OWN_CONTACTS; k++)
            for (int a = 0; a < 2; a++)
                for (int b = 0; b < 2; b++) {
                    problem.D[c][k][a][b] = e->D[c][k][a][b];
                    for (int i = 0; i < OWN_ACTUATORS; i++)
                        problem.D[c][k][a][b] += reach[c][i][a] * answer[k][b][i];
                }
    struct contact_problem reactions =
        contact_pose(problem.D, problem.free, touching, part, set->friction, set->prefer);
    reactions.sliding = of->contact->slide, reactions.indefinite = true;
    for (int round = 0; round < 2; round++) {
        solve_contacts(&reactions, LANES_ALL, problem.r, &verdict);
        several |= where & verdict.ambiguous;
        if (round > 0 || !mask_any(verdict.unsolved))
            break;
        none = verdict.unsolved & where; /* then the reactions without torques */
        for (int c = 0; c < OWN_CONTACTS; c++)
            for (int a = 0; a < 2; a++) {
                problem.free[c][a] = choose(none, e->free[c][a], problem.free[c][a]);
                for (int k = 0; k < OWN_CONTACTS; k++)
                    for (int b = 0; b < 2; b++)
                        problem.D[c][k][a][b] =
                            choose(none, e->D[c][k][a][b], problem.D[c][k][a][b]);
            }
    }
    for (int c = 0; c < OWN_CONTACTS; c++)
        for (int a = 0; a < contact_unknowns(c); a++)
            for (int i = 0; i < OWN_ACTUATORS; i++)
                torque[i] = choose(contact_part(c, part),
                                   torque[i] + answer[c][a][i] * problem.r[c][a], torque[i]);
    e->several = lanes_where(several);
    return none;
}

/* Torques with which the accelerations are as `wanted` while all closed contacts stick; returns the
 * lanes of `where` where none slides, that is regular, and reactions are in their cones. */
static inline mask decoupling_hold(const struct decoupling *of, mask where, const lanes *wanted,
                                   lanes *torque)
{
    const struct contact_state *const contact = of->contact;
    const struct dynamics *const e = of->e;
    const contact_set touching = of->touching;
    const int m = OWN_ACTUATORS;
    lanes reach[CONTACTS][ACTUATORS][2], r[CONTACTS][2], by[ACTUATORS][CONTACTS][2];
    lanes G[ACTUATORS][ACTUATORS], inverse[ACTUATORS][ACTUATORS], rate[ACTUATORS], x[ACTUATORS];
    mask rows[CONTACTS][2], sticks[CONTACTS];
    for (int c = 0; c < OWN_CONTACTS; c++) {
        sticks[c] = LANES_ALL;
        where &=
            LANES_NOT(contact->closed[c] & mask_less(lanes_of(0), lanes_abs(contact->slide[c])));
    }
    contact_mode_rows(contact->closed, sticks, rows);
    decoupling_reach(of->set, e, touching, reach);
    for (int i = -1; i < m; i++) { /* without torques, then by each of them */
        lanes pull[CONTACTS][2], push[SCENE_COORDINATES], (*const force)[2] = i < 0 ? r : by[i];
        for (int c = 0; c < OWN_CONTACTS; c++)
            for (int a = 0; a < 2; a++)
                pull[c][a] = i < 0 ? e->free[c][a] : reach[c][i][a];
        contact_rest(touching, CONTACT_CAREFUL, e->D, pull, rows, NULL, force);
        for (int k = 0; k < SCENE_COORDINATES; k++) {
            push[k] = i < 0 ? lanes_of(0) : e->push[i][k];
            EACH_IN (c, touching)
                for (int a = 0; a < contact_unknowns(c); a++)
                    push[k] += choose(rows[c][a], e->response[c][a][k] * force[c][a], lanes_of(0));
        }
        decoupling_rates(of->set, &e->trig, of->row, push, rate);
        for (int j = 0; j < m; j++)
            if (i < 0)
                x[j] = wanted[j] - rate[j];
            else
                G[j][i] = rate[j];
    }
    mask good = where & LANES_NOT(decoupling_inverse(G, inverse));
    lanes with[ACTUATORS];
    for (int i = 0; i < m; i++) {
        with[i] = lanes_of(0);
        for (int j = 0; j < m; j++)
            with[i] += inverse[i][j] * x[j];
        EACH_IN (c, touching)
            for (int a = 0; a < contact_unknowns(c); a++)
                r[c][a] = choose(rows[c][a], r[c][a] + with[i] * by[i][c][a], lanes_of(0));
    }
    good &= direct_obeys(of->set->friction, touching, r);
    for (int i = 0; i < m; i++)
        torque[i] = choose(good, with[i], torque[i]);
    return good;
}

/* The law in the lanes of `where`: e->command, e->integral_rate and e->degraded. *e was evaluated
 * with pushes and without torques in these lanes; `contact`: what each contact does. */
static inline void decouple(const struct setting *set, mask where, const struct state *at,
                            contact_set touching, const struct contact_state *contact,
                            struct dynamics *e)
{
    lanes q[SCENE_COORDINATES], v[SCENE_COORDINATES], curvature[SCENE_COORDINATES];
    lanes wanted[ACTUATORS], rate[ACTUATORS], torque[ACTUATORS], weighted[ACTUATORS];
    lanes G[ACTUATORS][ACTUATORS], inverse[ACTUATORS][ACTUATORS];
    scene_coordinates(&set->body, &e->trig, at->s, at->w, q, v);
    struct law_wish wish;
    const lanes(*const row)[SCENE_COORDINATES] = wish.row;
    const mask constant = mask_less(lanes_of(0), set->law.constant);
    law_servo(&set->law, at->t, q, v, at->integral, &wish);
    law_constant(&set->law, wish.wanted, weighted);
    if (!mask_any(where & LANES_NOT(constant))) { /* no model is asked */
        for (int i = 0; i < SCENE_ACTUATORS; i++)
            e->command[i] = weighted[i];
        law_integral_rate(&set->law, wish.error, at->integral, weighted, e->integral_rate);
        e->degraded = e->several = lanes_of(0);
        return;
    }
    scene_coordinate_curvature(&set->body, &e->trig, at->w, curvature);
    decoupling_rates(set, &e->trig, row, e->acceleration, rate);
    for (int j = 0; j < OWN_ACTUATORS; j++) {
        wanted[j] = wish.wanted[j] - rate[j] + wish.bend[j];
        for (int k = 0; k < SCENE_COORDINATES; k++)
            wanted[j] -= row[j][k] * curvature[k];
    }
    for (int i = 0; i < OWN_ACTUATORS; i++) {
        decoupling_rates(set, &e->trig, row, e->push[i], rate);
        for (int j = 0; j < OWN_ACTUATORS; j++)
            G[j][i] = rate[j];
    }
    mask degraded = decoupling_inverse(G, inverse);
    for (int i = 0; i < SCENE_ACTUATORS; i++) {
        torque[i] = lanes_of(0);
        for (int j = 0; j < OWN_ACTUATORS && i < OWN_ACTUATORS; j++)
            torque[i] += inverse[i][j] * wanted[j];
    }
    mask stands = MASK_NONE;
    e->several = lanes_of(0);
    for (int c = 0; c < OWN_CONTACTS; c++)
        stands |= where & contact->closed[c] & LANES_NOT(constant);
    mask held = stands & degraded;
    const struct decoupling of = {set, touching, contact, row, e};
    if (touching && mask_any(held))
        held = decoupling_hold(&of, held, wanted, torque);
    if (touching && mask_any(stands & LANES_NOT(held)))
        degraded |= decoupling_react(&of, where & LANES_NOT(constant | held), inverse, torque);
    degraded &= LANES_NOT(held);
    for (int i = 0; i < SCENE_ACTUATORS; i++)
        e->command[i] = torque[i] = choose(constant, weighted[i], torque[i]);
    law_integral_rate(&set->law, wish.error, at->integral, torque, e->integral_rate);
    e->degraded = lanes_where(where & degraded & LANES_NOT(constant));
}

/* Applies e->command, limited, in the lanes of `where`: torques, accelerations, contact terms. */
static inline void decoupling_apply(const struct setting *set, mask where, contact_set touching,
                                    struct dynamics *e)
{
    lanes torque[ACTUATORS], reach[CONTACTS][ACTUATORS][2];
    memcpy(torque, e->command, sizeof torque);
    law_clip(&set->law, torque);
    for (int i = 0; i < OWN_ACTUATORS; i++) {
        torque[i] = choose(where, torque[i], lanes_of(0));
        e->torque[i] += torque[i];
        for (int k = 0; k < SCENE_COORDINATES; k++)
            e->acceleration[k] += e->push[i][k] * torque[i];
    }
    decoupling_reach(set, e, touching, reach);
    for (int c = 0; c < OWN_CONTACTS; c++)
        for (int a = 0; a < 2; a++)
            for (int i = 0; i < OWN_ACTUATORS; i++)
                e->free[c][a] += reach[c][i][a] * torque[i];
}

#else /* no servos */

static inline void decouple(const struct setting *set, mask where, const struct state *at,
                            contact_set touching, const struct contact_state *contact,
                            struct dynamics *e)
{
    (void)set, (void)where, (void)at, (void)touching, (void)contact, (void)e;
}
static inline void decoupling_apply(const struct setting *set, mask where, contact_set touching,
                                    struct dynamics *e)
{
    (void)set, (void)where, (void)touching, (void)e;
}

#endif

/* What a law that is not linear commands in the lanes of `due`, in place of the linear law's
 * command; e->trig: at its place. contact: what the contacts do. Returns the lanes where servos
 * act, and *e says how. */
static inline mask law_command(const struct setting *set, mask due, const struct state *at,
                               const struct contact_state *contact, struct dynamics *e,
                               lanes *command)
{
    const struct law *const law = &set->law;
    const mask switches = mask_less(lanes_of(0), law->switches);
    const mask decouples = mask_less(lanes_of(0), law->decouples);
    lanes posture[POSTURES], rate[POSTURES], far[ACTUATORS], none[ACTUATORS];
    scene_posture(at->s, posture);
    scene_posture(at->w, rate);
    const mask inside = switches & law_near(law, posture, rate);
    linear_torque(&law->far, posture, rate, far);
    const mask servos = due & decouples & LANES_NOT(inside);
    const mask other = due & switches & LANES_NOT(inside | decouples);
    for (int i = 0; i < SCENE_ACTUATORS; i++) {
        command[i] = choose(other, far[i], command[i]);
        e->integral_rate[i] = none[i] = lanes_of(0);
    }
    e->degraded = e->several = lanes_of(0);
    if (!mask_any(servos))
        return servos;
    const contact_set all = CONTACT_ALL;
    if (mask_any(servos & mask_less_equal(law->constant, lanes_of(0))))
        dynamics_evaluate(set, at, none, all, true, e);
    decouple(set, servos, at, all, contact, e);
    for (int i = 0; i < OWN_ACTUATORS; i++)
        command[i] = choose(servos, e->command[i], command[i]);
    return servos;
}

#endif
