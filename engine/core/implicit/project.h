/* project.h - what velocity laws leave to be mended at the end of a step: gaps of loaded contacts
 * that are not zero, and then contact velocities that were right at the position before.
 */
#ifndef STANCE_CORE_IMPLICIT_PROJECT_H
#define STANCE_CORE_IMPLICIT_PROJECT_H

#include "iterate.h"

#define STEP_PROJECTION 1e-13    /* m: gap error left by the projection */
#define STEP_FARTHEST 0.3        /* rad: a projection that turns the robot further is refused */
#define STEP_APPROACH 1e-9       /* m/s: a closed contact that approaches faster is an impact */
#define PROJECT_RANK_GUARD 1e-12 /* of what it was: a pivot this small is a rounding of zero */
#define PROJECT_VELOCITY                                                                           \
    1e-12                /* m/s: contact velocities that are off by more are mended once more */
#define PROJECT_ROUNDS 8 /* at most */

/* Multipliers of the directions `lift`, one for each contact, that change the gaps of held
 * contacts, which are in `touching`, by `error`, to first order; where the two are dependent the
 * first does the work, and as much as it takes to leave none below. The operator is of a step's
 * matrix: it need not be symmetric nor positive. A contact that is not held is a row of the
 * identity, so that the others' multipliers are to the bit what they are without it (zeros
 * included: + 0). */
HOT void project_multipliers(const struct setting *set, const scene_trig *trig,
                             contact_set touching, const lanes *const lift[SCENE_CONTACTS],
                             const mask *held, const lanes *error, lanes *multiplier)
{
    lanes G[2][2];
    for (int c = 0; c < SCENE_CONTACTS; c++)
        multiplier[c] = lanes_of(0);
    for (int c = 0; c < SCENE_CONTACTS; c++)
        for (int k = 0; k < SCENE_CONTACTS; k++) {
            lanes u[2];
            if (!(touching >> c & touching >> k & 1))
                continue;
            scene_contact_velocity(&set->body, trig, c, lift[k], u);
            G[c][k] = choose(held[c] & held[k], u[0], lanes_of(c == k));
        }
    if ((touching & (touching - 1)) == 0) {
        const int c = touching == 1 ? 0 : SECOND;
        multiplier[c] = lanes_fma(error[c], 1 / G[c][c], lanes_of(0));
        return;
    }
    const lanes first = 1 / G[0][0], across = G[SECOND][0] * first;
    const lanes pivot = lanes_fnma(across, G[0][SECOND], G[SECOND][SECOND]);
    const mask regular =
        mask_less(PROJECT_RANK_GUARD * lanes_abs(G[SECOND][SECOND]), lanes_abs(pivot));
    const lanes left = lanes_fnma(across, error[0], error[SECOND]);
    const lanes second = choose(regular, left * (1 / pivot), lanes_of(0));
    const lanes most = choose(regular, error[0], lanes_max(error[0], error[SECOND]));
    multiplier[0] = lanes_fma(lanes_fnma(G[0][SECOND], second, most), first, lanes_of(0));
    multiplier[SECOND] = second + 0.0;
}

/* Sine and cosine after turning by small angles d, to third order. */
HOT void trig_turn(scene_trig *trig, mask where, const lanes *d)
{
    for (int a = 0; a < SCENE_ANGLES; a++) {
        const lanes x = d[FIRST_ANGLE + a], s = trig->sine[a], c = trig->cosine[a];
        const lanes half = 0.5 * (x * x);
        trig->sine[a] = choose(where, s + (x * c - half * s), s);
        trig->cosine[a] = choose(where, c - (x * s + half * c), c);
    }
}

/* The displacement d along the normal directions that changes the gaps of held contacts by `error`,
 * to second order. */
HOT void project_move(const struct setting *set, const struct iterate *it, contact_set touching,
                      const mask *held, const lanes *error, lanes *d)
{
    lanes multiplier[SCENE_CONTACTS], rest[SCENE_CONTACTS], more[SCENE_CONTACTS];
    const lanes *lift[SCENE_CONTACTS];
    for (int c = 0; c < SCENE_CONTACTS; c++) {
        multiplier[c] = lanes_of(0);
        lift[c] = it->response[c][0];
    }
    for (int round = 0; round < 2; round++) {
        for (int c = 0; c < SCENE_CONTACTS; c++) {
            rest[c] = error[c];
            if (round > 0)
                rest[c] -= scene_gap_change(&set->body, &it->end, c, d);
            rest[c] = choose(held[c], rest[c], lanes_of(0));
        }
        project_multipliers(set, &it->end, touching, lift, held, rest, more);
        for (int c = 0; c < SCENE_CONTACTS; c++)
            multiplier[c] = multiplier[c] + more[c];
        for (int i = 0; i < SCENE_COORDINATES; i++) {
            d[i] = lanes_of(0);
            for (int c = 0; c < SCENE_CONTACTS; c++)
                if (touching >> c & 1)
                    d[i] = choose(held[c], lanes_fma(lift[c][i], multiplier[c], d[i]), d[i]);
        }
    }
}

/* Moves the end position until loaded contacts have their gap and no contact penetrates. Returns
 * the lanes where that needed no more than STEP_FARTHEST of turning: elsewhere the step is too
 * long for its velocity. */
HOT mask project_position(const struct setting *set, const struct motion *from, lanes h,
                          contact_set touching, bool impacts, mask run, struct iterate *it,
                          lanes *energy)
{
    lanes wanted[SCENE_CONTACTS], error[SCENE_CONTACTS];
    mask held[SCENE_CONTACTS];
    for (int c = 0; c < SCENE_CONTACTS; c++) {
        /* A rebound has used part of the step to arrive: it leaves e times what it overshot. */
        const lanes overshoot = -lanes_fma(h, from->approach[c], from->gap[c]);
        wanted[c] = set->restitution * lanes_max(overshoot, lanes_of(0));
        held[c] = run & it->active[c] & mask_less(lanes_of(0), it->r[c][0]);
    }
    lanes turned = lanes_of(0);
    mask todo = run;
    for (int round = 0; round < 12; round++) {
        todo = MASK_NONE;
        for (int c = 0; c < SCENE_CONTACTS; c++) {
            error[c] = lanes_of(0);
            if (!(touching >> c & 1))
                continue;
            mask near = run & it->active[c];
            if (impacts)
                near = run & mask_less(lanes_of(0), set->may_touch[c]) &
                       (it->active[0] | it->active[SECOND]);
            held[c] |= near & mask_less(it->gap[c], lanes_of(-STEP_PROJECTION));
            error[c] = choose(held[c],
                              choose(mask_less(lanes_of(0), it->r[c][0]), wanted[c], lanes_of(0)) -
                                  it->gap[c],
                              lanes_of(0));
            /* Of two dependent ones one may have to stay above. */
            if (round > 2)
                error[c] = lanes_max(error[c], lanes_of(0));
            todo |= mask_less(lanes_of(STEP_PROJECTION), lanes_abs(error[c]));
        }
        if (!mask_any(todo))
            break;
        lanes d[SCENE_COORDINATES], far = lanes_of(0);
        project_move(set, it, touching, held, error, d);
        for (int i = 0; i < SCENE_COORDINATES; i++) {
            d[i] = choose(todo, d[i], lanes_of(0));
            it->s1[i] = choose(todo, it->s1[i] + d[i], it->s1[i]);
            if (i >= FIRST_ANGLE)
                turned += lanes_abs(d[i]);
        }
        *energy += lanes_abs(scene_energy_change(&set->body, &it->end, it->w, d));
        for (int c = 0; c < SCENE_CONTACTS; c++) {
            it->gap[c] =
                choose(todo, it->gap[c] + scene_gap_change(&set->body, &it->end, c, d), it->gap[c]);
            far = lanes_max(scene_gap_change_error(&set->body, c, d), far);
        }
        trig_turn(&it->end, todo, d);
        const mask moved = todo & mask_less(lanes_of(0.1 * STEP_PROJECTION), far);
        if (mask_any(moved)) { /* too far for the expansion: the gaps anew */
            scene_trig trig = it->end;
            scene_trigonometry(it->s1, &trig);
            for (int c = 0; c < SCENE_CONTACTS; c++)
                it->gap[c] = choose(moved, scene_gap(&set->body, it->s1, &trig, c), it->gap[c]);
            for (int a = 0; a < SCENE_ANGLES; a++) {
                it->end.sine[a] = choose(moved, trig.sine[a], it->end.sine[a]);
                it->end.cosine[a] = choose(moved, trig.cosine[a], it->end.cosine[a]);
            }
        }
    }
    return run & LANES_NOT(todo) & mask_less(turned, lanes_of(STEP_FARTHEST));
}

/* The operator that takes impulses at contacts to their velocities at one place, in the rows that
 * are held, factored: contact 0 first. Rows that are not held are those of the identity. */
struct grip {
    mask rows[2][2];        /* normal, tangential of each contact */
    lanes inverse[2][2][2]; /* of contact 0 alone, and of what it leaves of contact 1 */
    lanes push[2][2],
        through[2][2]; /* of two: impulse of 0 by that of 1; velocity of 1 by that of 0 */
};

/* Inverse of one contact's operator with the sign turned; of a singular one zero. `own`: see
 * contact_impulse. */
HOT void grip_invert(const lanes own[2][2], const lanes G[2][2], lanes inverse[2][2])
{
    const lanes determinant = lanes_fnma(G[0][1], G[1][0], G[0][0] * G[1][1]);
    const mask regular =
        mask_less(PROJECT_RANK_GUARD * lanes_abs(own[0][0] * own[1][1]), lanes_abs(determinant));
    const lanes reciprocal = 1 / choose(regular, determinant, lanes_of(INFINITY));
    inverse[0][0] = -(G[1][1] * reciprocal), inverse[0][1] = G[0][1] * reciprocal;
    inverse[1][0] = G[1][0] * reciprocal, inverse[1][1] = -(G[0][0] * reciprocal);
}

HOT lanes grip_times(const lanes row[2], lanes x0, lanes x1, lanes sum)
{
    return lanes_fma(row[0], x0, lanes_fma(row[1], x1, sum));
}

/* Fills in the factors from the rows, for contacts in `touching`. */
HOT void grip_factor(const struct setting *set, const scene_trig *trig, contact_set touching,
                     const lanes (*response)[2][SCENE_COORDINATES], struct grip *g)
{
    lanes G[2][2][2][2]; /* of SCENE_CONTACTS contacts */
    for (int c = 0; c < 2; c++)
        for (int k = 0; k < 2; k++)
            for (int a = 0; a < 2; a++)
                for (int b = 0; b < 2; b++)
                    G[c][k][a][b] = lanes_of(c == k && a == b);
    for (int c = 0; c < SCENE_CONTACTS; c++)
        for (int k = 0; k < SCENE_CONTACTS; k++)
            for (int b = 0; b < 2 && touching >> c & touching >> k & 1; b++) {
                lanes moved[2];
                scene_contact_velocity(&set->body, trig, c, response[k][b], moved);
                for (int a = 0; a < 2; a++)
                    G[c][k][a][b] = choose(g->rows[c][a] & g->rows[k][b], moved[a], G[c][k][a][b]);
            }
    if ((touching & (touching - 1)) == 0) {
        const int c = touching == 1 ? 0 : SECOND;
        grip_invert((const lanes(*)[2])G[c][c], (const lanes(*)[2])G[c][c], g->inverse[c]);
        return;
    }
    grip_invert((const lanes(*)[2])G[0][0], (const lanes(*)[2])G[0][0], g->inverse[0]);
    lanes left[2][2];
    for (int a = 0; a < 2; a++)
        for (int b = 0; b < 2; b++) {
            g->push[a][b] = grip_times(g->inverse[0][a], G[0][1][0][b], G[0][1][1][b], lanes_of(0));
            g->through[a][b] = G[1][0][a][b];
        }
    for (int a = 0; a < 2; a++)
        for (int b = 0; b < 2; b++)
            left[a][b] = grip_times(g->through[a], g->push[0][b], g->push[1][b], G[1][1][a][b]);
    grip_invert((const lanes(*)[2])G[1][1], (const lanes(*)[2])left, g->inverse[1]);
}

/* Impulses x that change the velocities by -u in the rows that are held; zero, + 0, elsewhere. */
HOT void grip_solve(const struct grip *g, contact_set touching, const lanes u[2][2], lanes x[2][2])
{
    const lanes none = lanes_of(0);
    if ((touching & (touching - 1)) == 0) {
        const int c = touching == 1 ? 0 : SECOND;
        for (int a = 0; a < 2; a++)
            x[c][a] = grip_times(g->inverse[c][a], u[c][0], u[c][1], none);
        return;
    }
    lanes alone[2], u1[2];
    for (int a = 0; a < 2; a++)
        alone[a] = grip_times(g->inverse[0][a], u[0][0], u[0][1], none);
    for (int a = 0; a < 2; a++)
        u1[a] = grip_times(g->through[a], alone[0], alone[1], u[1][a]);
    for (int a = 0; a < 2; a++)
        x[1][a] = grip_times(g->inverse[1][a], u1[0], u1[1], none);
    for (int a = 0; a < 2; a++)
        x[0][a] = grip_times(g->push[a], x[1][0], x[1][1], alone[a]) + 0.0;
}

/* What is wrong with the velocities u of contacts in `touching`, in the rows that are held;
 * rebound: NULL, or minus the normal velocities that restitution asks for. Returns the lanes where
 * it matters. */
HOT mask project_wrong(const lanes *rebound, contact_set touching, const struct grip *g,
                       const lanes (*u)[2], lanes wrong[2][2])
{
    const lanes none = lanes_of(0);
    mask off = MASK_NONE;
    for (int c = 0; c < SCENE_CONTACTS; c++) {
        if (!(touching >> c & 1))
            continue;
        lanes normal = u[c][0];
        if (rebound)
            normal = normal + rebound[c];
        wrong[c][0] = choose(g->rows[c][0], normal, none);
        wrong[c][1] = choose(g->rows[c][1], u[c][1], none);
        for (int a = 0; a < 2; a++)
            off |= mask_less(lanes_of(PROJECT_VELOCITY), lanes_abs(wrong[c][a]));
    }
    return off;
}

/* Takes that away by moving the velocity w along the responses, in the lanes of `where`; u follows.
 * Returns what that adds to the energy. */
HOT lanes project_move_velocity(const struct setting *set, const scene_trig *trig,
                                contact_set touching, const struct grip *g, mask where,
                                const lanes (*response)[2][SCENE_COORDINATES],
                                const lanes wrong[2][2], lanes *w, lanes (*u)[2])
{
    lanes x[2][2], energy = lanes_of(0);
    grip_solve(g, touching, wrong, x);
    for (int c = 0; c < SCENE_CONTACTS; c++)
        for (int a = 0; a < 2 && touching >> c & 1; a++)
            for (int i = 0; i < SCENE_COORDINATES; i++)
                w[i] = choose(g->rows[c][a] & where, lanes_fma(response[c][a][i], x[c][a], w[i]),
                              w[i]);
    for (int c = 0; c < SCENE_CONTACTS; c++) {
        if (!(touching >> c & 1))
            continue;
        const lanes before[2] = {u[c][0], u[c][1]};
        scene_contact_velocity(&set->body, trig, c, w, u[c]);
        for (int a = 0; a < 2; a++)
            energy = lanes_fma(x[c][a], lanes_fnma(lanes_of(0.5), wrong[c][a], before[a]), energy);
    }
    return lanes_abs(energy);
}

/* Once more, and again, in the lanes of `off`. */
COLD lanes project_again(const struct setting *set, const lanes *rebound, const scene_trig *trig,
                         contact_set touching, const struct grip *g, mask off,
                         const lanes (*response)[2][SCENE_COORDINATES], lanes *w, lanes (*u)[2])
{
    lanes energy = lanes_of(0),
          wrong[2][2] = {{lanes_of(0), lanes_of(0)}, {lanes_of(0), lanes_of(0)}};
    for (int round = 1; round < PROJECT_ROUNDS && mask_any(off); round++) {
        project_wrong(rebound, touching, g, (const lanes(*)[2])u, wrong);
        const lanes added = project_move_velocity(set, trig, touching, g, off, response,
                                                  (const lanes(*)[2])wrong, w, u);
        energy += choose(off, added, lanes_of(0));
        off &= project_wrong(rebound, touching, g, (const lanes(*)[2])u, wrong);
    }
    return energy;
}

/* Moves the velocity at the end along the responses until the contacts' velocities u (out, of those
 * in `touching`) are what the laws ask for, in the rows that are held. *energy: the sum of what
 * that adds. */
HOT void project_along(const struct setting *set, const lanes *rebound, contact_set touching,
                       const struct grip *g, const lanes (*response)[2][SCENE_COORDINATES],
                       struct iterate *it, lanes (*u)[2], lanes *energy)
{
    lanes wrong[2][2] = {{lanes_of(0), lanes_of(0)}, {lanes_of(0), lanes_of(0)}};
    for (int c = 0; c < SCENE_CONTACTS; c++)
        if (touching >> c & 1)
            scene_contact_velocity(&set->body, &it->end, c, it->w, u[c]);
    project_wrong(rebound, touching, g, (const lanes(*)[2])u, wrong);
    *energy += project_move_velocity(set, &it->end, touching, g, LANES_ALL, response,
                                     (const lanes(*)[2])wrong, it->w, u);
    const mask off = project_wrong(rebound, touching, g, (const lanes(*)[2])u, wrong);
    if (!mask_any(off))
        return;
    /* With copies: what is passed on by address stays in memory. */
    lanes w[SCENE_COORDINATES], v[SCENE_CONTACTS][2], same[SCENE_CONTACTS][2][SCENE_COORDINATES];
    const struct grip factors = *g;
    const scene_trig trig = it->end;
    memcpy(w, it->w, sizeof w);
    memcpy(v, u, sizeof v);
    memcpy(same, response, sizeof same);
    *energy += project_again(set, rebound, &trig, touching, &factors, off,
                             (const lanes(*)[2][SCENE_COORDINATES])same, w, v);
    memcpy(it->w, w, sizeof w);
    memcpy(u, v, sizeof v);
}

/* Responses to impulses at the contacts by the inertia at the end in the lanes of `impact`,
 * elsewhere those of the iterate. */
static inline void project_inertia(const struct setting *set, mask impact, const struct iterate *it,
                                   lanes response[SCENE_CONTACTS][2][SCENE_COORDINATES])
{
    scene_matrix A;
    scene_inertia(&set->body, &it->end, &A);
    for (int c = 0; c < SCENE_CONTACTS; c++) {
        scene_contact_response(&set->body, &A, false, &it->end, c, response[c]);
        for (int a = 0; a < 2; a++)
            for (int i = 0; i < SCENE_COORDINATES; i++)
                response[c][a][i] = choose(impact, response[c][a][i], it->response[c][a][i]);
    }
}

/* The rows of a step that has arrived, in the lanes of `run`: contacts that carry have the normal
 * velocity that the laws ask for, those that stick no other. */
HOT void project_rows(const struct setting *set, mask run, const struct iterate *it, struct grip *g)
{
    for (int c = 0; c < SCENE_CONTACTS; c++) {
        g->rows[c][0] = run & it->active[c] & mask_less(lanes_of(0), it->r[c][0]);
        g->rows[c][1] = g->rows[c][0] & direct_stands(set->friction, it->r[c]);
    }
}

/* Lanes where a contact that does not carry lies on the ground and approaches it, and where one
 * that slides has come to slide the way its friction points. */
HOT mask project_falls(const struct setting *set, mask run, const struct grip *g, int c,
                       const struct iterate *it, const lanes u[2])
{
    return run & LANES_NOT(g->rows[c][0]) & mask_less(lanes_of(0), set->may_touch[c]) &
           mask_less_equal(it->gap[c], lanes_of(STEP_CLOSED)) &
           mask_less(u[0], lanes_of(-STEP_APPROACH));
}
HOT mask project_turns(const struct grip *g, int c, const struct iterate *it, const lanes u[2])
{
    return g->rows[c][0] & LANES_NOT(g->rows[c][1]) & mask_less(lanes_of(0), it->r[c][1] * u[1]);
}

/* Position, then velocity at the end of a step in which contacts may have come, in the lanes of
 * `run`. Returns those where the position could be mended. */
static inline mask project_far(const struct setting *set, const struct motion *from, lanes h,
                               contact_set touching, mask impact, mask run, struct iterate *it,
                               lanes (*u)[2], lanes *energy)
{
    struct grip g;
    lanes response[SCENE_CONTACTS][2][SCENE_COORDINATES], rebound[SCENE_CONTACTS];
    memset(&g, 0, sizeof g);
    for (int c = 0; c < SCENE_CONTACTS; c++)
        rebound[c] = set->restitution * lanes_min(from->approach[c], lanes_of(0));
    const mask near = project_position(set, from, h, touching, true, run, it, energy);
    project_rows(set, run, it, &g);
    project_inertia(set, impact, it, response);
    mask where = run; /* a lane in which nothing is left to do has done with it */
    for (int round = 0; round < 2 + SCENE_CONTACTS; round++) {
        mask falls[SCENE_CONTACTS], turns[SCENE_CONTACTS], any = MASK_NONE;
        grip_factor(set, &it->end, touching, (const lanes(*)[2][SCENE_COORDINATES])response, &g);
        project_along(set, rebound, touching, &g, (const lanes(*)[2][SCENE_COORDINATES])response,
                      it, u, energy);
        for (int c = 0; c < SCENE_CONTACTS; c++) {
            falls[c] = project_falls(set, where, &g, c, it, u[c]);
            turns[c] = where & project_turns(&g, c, it, u[c]);
            any |= falls[c] | turns[c];
        }
        if (!mask_any(any))
            break;
        for (int c = 0; c < SCENE_CONTACTS; c++) { /* stopped, where there is one */
            g.rows[c][0] = any & (g.rows[c][0] | falls[c]);
            g.rows[c][1] = any & (g.rows[c][1] | turns[c]);
        }
        where = any;
    }
    return near;
}

/* The same for an ordinary step; `full`: with every contact in `touching` active in every lane that
 * matters. Returns the lanes where it still is one. */
HOT mask project_near(const struct setting *set, const struct motion *from, lanes h,
                      contact_set touching, bool full, mask run, struct iterate *it, lanes (*u)[2],
                      lanes *energy)
{
    struct grip g;
    mask good = run, slides = MASK_NONE;
    project_rows(set, run, it, &g);
    for (int c = 0; c < SCENE_CONTACTS; c++)
        if (touching >> c & 1)
            slides |= run & LANES_NOT(g.rows[c][1]);
    const bool stands = full && !mask_any(slides);
    /* The factors do not wait for the position: where they are a little off a second round helps.
     */
    if (stands) {
        for (int c = 0; c < SCENE_CONTACTS; c++)
            g.rows[c][0] = g.rows[c][1] = LANES_ALL;
        grip_factor(set, &it->end, touching, it->response, &g);
        good &= project_position(set, from, h, touching, false, run, it, energy);
        project_along(set, NULL, touching, &g, it->response, it, u, energy);
        return good;
    }
    grip_factor(set, &it->end, touching, it->response, &g);
    good &= project_position(set, from, h, touching, false, run, it, energy);
    project_along(set, NULL, touching, &g, it->response, it, u, energy);
    /* Of contacts that are active: others may be in `touching` for a neighbour's sake. */
    for (int c = 0; c < SCENE_CONTACTS; c++)
        if (touching >> c & 1)
            good &= LANES_NOT(project_falls(set, run & it->active[c], &g, c, it, u[c]) |
                              project_turns(&g, c, it, u[c]));
    return good;
}

#endif
