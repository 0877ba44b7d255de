/* project.h - what velocity laws leave to be mended at the end of a step: gaps of loaded contacts
 * that are not zero, and then contact velocities that were right at the position before.
 */
#ifndef STANCE_CORE_IMPLICIT_PROJECT_H
#define STANCE_CORE_IMPLICIT_PROJECT_H

#include "iterate.h"

#define TRIG_TURNED 0.0625    /* rad: the series' rounding error is then below 1e-17 */
#define TRIG_TURNS 32         /* steps between sines that are computed anew */
#define STEP_PROJECTION 1e-13 /* m: gap error left by the projection */
#define STEP_FARTHEST 0.3     /* rad: a projection that turns the robot further is refused */
#define STEP_APPROACH 1e-9    /* m/s: a closed contact that approaches faster is an impact */
#define PROJECT_VELOCITY                                                                           \
    1e-12                /* m/s: contact velocities that are off by more are mended once more */
#define PROJECT_ROUNDS 8 /* at most */

/* Contacts that depend on others, in the lanes of `idle`, where these leave them below: those are
 * lifted, too. */
COLD void project_lift(contact_set touching, const mask *idle, const lanes (*G)[CONTACTS],
                       const lanes *error, lanes *multiplier)
{
    EACH_IN (c, touching) {
        lanes left = error[c];
        EACH_IN (k, touching)
            left = lanes_fnma(G[c][k], multiplier[k], left);
        multiplier[c] = choose(idle[c] & mask_less(lanes_of(0), left),
                               lanes_fma(left, 1 / G[c][c], multiplier[c]), multiplier[c]);
    }
}

/* The operator of the directions `lift`, one for each contact, that take multipliers to gaps of
 * contacts that are held, in lanes, eliminated. It is of a step's matrix: it need not be symmetric
 * nor positive. A contact that is not held is a row of the identity, so that the others'
 * multipliers are to the bit what they are without it (zeros included: + 0). */
struct lifts {
    const lanes *lift[CONTACTS];
    lanes G[CONTACTS][CONTACTS], U[CONTACTS][CONTACTS], reciprocal[CONTACTS];
    mask idle[CONTACTS], any; /* which depend on those before */
};

HOT void project_factor(const struct setting *set, const scene_trig *trig, contact_set touching,
                        const mask *held, struct lifts *f)
{
    lanes(*const U)[CONTACTS] = f->U;
    EACH_IN (c, touching) {
        scene_rows rows;
        scene_contact_rows(&set->body, trig, c, NULL, lanes_of(0), &rows);
        EACH_IN (k, touching) {
            lanes u[2];
            scene_rows_velocity(&set->body, c, &rows, f->lift[k], u);
            f->G[c][k] = U[c][k] = choose(held[c] & held[k], u[0], lanes_of(c == k));
        }
    }
    f->any = MASK_NONE;
    EACH_IN (p, touching) {
        f->idle[p] = MASK_NONE;
        f->reciprocal[p] = 1 / U[p][p];
        if (touching & ((1u << p) - 1)) { /* not the first */
            f->idle[p] = LANES_NOT(
                mask_less(CONTACT_RANK_GUARD * lanes_abs(f->G[p][p]), lanes_abs(U[p][p])));
            f->reciprocal[p] = 1 / choose(f->idle[p], lanes_of(INFINITY), U[p][p]);
        }
        f->any |= f->idle[p];
        EACH_IN_FROM (i, p + 1, touching) {
            U[i][p] = U[i][p] * f->reciprocal[p];
            EACH_IN_FROM (k, p + 1, touching)
                U[i][k] = lanes_fnma(U[i][p], U[p][k], U[i][k]);
        }
    }
}

/* Multipliers that change the gaps of held contacts by `error`, to first order; of those that are
 * dependent the first do the work, and as much as it takes to leave none below. */
HOT void project_multipliers(contact_set touching, const struct lifts *f, const lanes *error,
                             lanes *multiplier)
{
    EACH_IN (p, touching) {
        multiplier[p] = error[p];
        for (int k = 0; k < p; k++)
            if (touching >> k & 1)
                multiplier[p] = lanes_fnma(f->U[p][k], multiplier[k], multiplier[p]);
    }
    for (int p = OWN_CONTACTS - 1; p >= 0; p--) {
        if (!(touching >> p & 1))
            continue;
        EACH_IN_FROM (k, p + 1, touching)
            multiplier[p] = lanes_fnma(f->U[p][k], multiplier[k], multiplier[p]);
        multiplier[p] = lanes_fma(multiplier[p], f->reciprocal[p], lanes_of(0));
    }
    if (mask_any(f->any))
        project_lift(touching, f->idle, f->G, error, multiplier);
}

/* Sine and cosine after turning by small angles d, to third order. */
HOT void trig_turn(scene_trig *trig, mask where, const lanes *d)
{
    EACH (a, 0, SCENE_ANGLES) {
        const lanes x = d[FIRST_ANGLE + a], s = trig->sine[a], c = trig->cosine[a];
        if (SCENE_SLIDES(a)) {
            trig->sine[a] = choose(where, s + x, s);
            continue;
        }
        const lanes half = 0.5 * (x * x);
        trig->sine[a] = choose(where, s + (x * c - half * s), s);
        trig->cosine[a] = choose(where, c - (x * s + half * c), c);
    }
}

/* Sines and cosines after turning by d[], at most TRIG_TURNED. */
HOT void trig_turned(const scene_trig *from, const lanes *d, scene_trig *to)
{
    EACH (a, 0, SCENE_ANGLES) {
        if (SCENE_SLIDES(a)) {
            to->sine[a] = from->sine[a] + d[a], to->cosine[a] = from->cosine[a];
            continue;
        }
        const lanes x = d[a], t = x * x, s = from->sine[a], c = from->cosine[a];
        lanes sine = lanes_fma(t, lanes_of(-1. / 5040), lanes_of(1. / 120));
        sine = lanes_fma(t, sine, lanes_of(-1. / 6));
        sine = lanes_fma(x * t, sine, x);
        lanes less = lanes_fma(t, lanes_of(1. / 40320), lanes_of(-1. / 720)); /* cosine - 1 */
        less = lanes_fma(t, less, lanes_of(1. / 24));
        less = t * lanes_fma(t, less, lanes_of(-0.5));
        to->sine[a] = s + lanes_fma(c, sine, s * less);
        to->cosine[a] = c + lanes_fnma(s, sine, c * less);
    }
}

/* The displacement d along the normal directions that changes the gaps of held contacts by `error`,
 * to second order. */
HOT void project_move(const struct setting *set, const struct iterate *it, contact_set touching,
                      const mask *held, const lanes *error, lanes *d)
{
    lanes multiplier[CONTACTS], rest[CONTACTS], more[CONTACTS];
    struct lifts f;
    EACH_IN (c, touching) {
        multiplier[c] = lanes_of(0);
        f.lift[c] = it->response[c][0];
    }
    project_factor(set, &it->end, touching, held, &f);
    for (int round = 0; round < 2; round++) {
        EACH_IN (c, touching) {
            rest[c] = error[c];
            if (round > 0)
                rest[c] -= scene_gap_change(&set->body, &it->end, c, d);
            rest[c] = choose(held[c], rest[c], lanes_of(0));
        }
        project_multipliers(touching, &f, rest, more);
        EACH_IN (c, touching)
            multiplier[c] = multiplier[c] + more[c];
        EACH (i, 0, SCENE_COORDINATES) {
            d[i] = lanes_of(0);
            EACH_IN (c, touching)
                d[i] = choose(held[c], lanes_fma(f.lift[c][i], multiplier[c], d[i]), d[i]);
        }
    }
}

/* Contacts not in `near` that are not above the ground in a lane of m. */
static inline contact_set project_missed(const struct setting *set, contact_set near, mask m,
                                         const struct iterate *it)
{
    contact_set missed = 0;
    EACH_IN (c, CONTACT_ALL & ~near)
        if (mask_any(m & motion_closed(set, it->gap, c)))
            missed |= contact_with(c);
    return missed;
}

/* Moves the end position until loaded contacts have their gap and no contact penetrates, of those
 * in `touching`; `impacts`: others may have come to the ground, it->missed. Returns the lanes where
 * that needed no more than STEP_FARTHEST of turning: elsewhere the step is too long for its
 * velocity. */
HOT mask project_position(const struct step *step, contact_set touching, bool impacts, mask run,
                          struct iterate *it, lanes *energy)
{
    const struct setting *const set = step->set;
    lanes wanted[CONTACTS], error[CONTACTS];
    mask held[CONTACTS], somewhere = MASK_NONE;
    EACH_IN (c, touching) {
        somewhere |= it->active[c];
        /* A rebound has used part of the step to arrive: it leaves e times what it overshot. */
        const lanes overshoot = -lanes_fma(step->h, step->from->approach[c], step->from->gap[c]);
        wanted[c] = set->restitution[c] * lanes_max(overshoot, lanes_of(0));
        held[c] = run & it->active[c] & mask_less(lanes_of(0), it->r[c][0]);
    }
    lanes turned = lanes_of(0);
    mask todo = run;
    for (int round = 0; round < 12; round++) {
        todo = MASK_NONE;
        if (impacts)
            it->missed |= project_missed(set, touching, run, it);
        EACH_IN (c, touching) {
            mask near = run & it->active[c];
            if (impacts)
                near = run & mask_less(lanes_of(0), set->may_touch[c]) & somewhere;
            held[c] |= near & mask_less(it->gap[c], lanes_of(-STEP_PROJECTION));
            error[c] = choose(held[c],
                              choose(mask_less(lanes_of(0), it->r[c][0]), wanted[c], lanes_of(0)) -
                                  it->gap[c],
                              lanes_of(0));
            /* Two dependent contacts cannot both reach zero: one may stay above. */
            if (round > 2)
                error[c] = lanes_max(error[c], lanes_of(0));
            todo |= mask_less(lanes_of(STEP_PROJECTION), lanes_abs(error[c]));
        }
        if (!mask_any(todo))
            break;
        lanes d[SCENE_COORDINATES], far = lanes_of(0);
        project_move(set, it, touching, held, error, d);
        EACH (i, 0, SCENE_COORDINATES) {
            d[i] = choose(todo, d[i], lanes_of(0));
            it->s1[i] = choose(todo, it->s1[i] + d[i], it->s1[i]);
            if (i >= FIRST_ANGLE && !SCENE_SLIDES(i - FIRST_ANGLE))
                turned += lanes_abs(d[i]);
        }
        *energy += lanes_abs(scene_energy_change(&set->body, it->s1, &it->end, it->w, d));
        EACH_CONTACT (c, 0) {
            it->gap[c] =
                choose(todo, it->gap[c] + scene_gap_change(&set->body, &it->end, c, d), it->gap[c]);
            far = lanes_max(scene_gap_change_error(&set->body, &it->end, c, d), far);
        }
        /* To rounding: the energy hangs on it, and stops, whose gaps are linear, mend millirads. */
        trig_turned(&it->end, d + FIRST_ANGLE, &it->end);
        const mask moved = todo & (mask_less(lanes_of(0.1 * STEP_PROJECTION), far) |
                                   mask_less(lanes_of(TRIG_TURNED), turned));
        if (mask_any(moved)) { /* too far for the expansions: anew */
            scene_trig trig = it->end;
            scene_trigonometry(it->s1, &trig);
            EACH_CONTACT (c, 0)
                it->gap[c] = choose(moved, scene_gap(&set->body, it->s1, &trig, c), it->gap[c]);
            EACH (a, 0, SCENE_ANGLES) {
                it->end.sine[a] = choose(moved, trig.sine[a], it->end.sine[a]);
                it->end.cosine[a] = choose(moved, trig.cosine[a], it->end.cosine[a]);
            }
        }
    }
    return run & LANES_NOT(todo) & mask_less(turned, lanes_of(STEP_FARTHEST));
}

/* Contacts in `touching` at one place. Pointers alone: beside numbers, in memory, they would keep
 * there what they point to. */
struct held {
    const struct setting *set;
    const scene_trig *trig;
    contact_set touching;
    const lanes (*response)[2][SCENE_COORDINATES]; /* to a unit impulse at a contact */
    const lanes (*rebound)[2]; /* NULL, or minus the velocities that restitution asks for */
};
/* What holds them: the operator that takes impulses to velocities, in the rows that are held. */
struct grip {
    mask rows[CONTACTS][2]; /* normal, tangential of each contact */
    struct contact_factors factors;
};

/* Fills in the factors from the rows. */
HOT void grip_factor(const struct held *of, struct grip *g)
{
    lanes D[CONTACTS][CONTACTS][2][2], M[CONTACTS][CONTACTS][2][2];
    motion_operator(&of->set->body, of->trig, of->touching, of->response, D);
    contact_matrix(of->touching, D, g->rows, NULL, M);
    contact_factor(of->touching, CONTACT_CAREFUL, M, &g->factors);
}

/* What is wrong with the velocities u of the contacts, in the rows that are held. Returns the lanes
 * where it matters. */
HOT mask project_wrong(const struct held *of, const struct grip *g, const lanes (*u)[2],
                       lanes (*wrong)[2])
{
    const lanes none = lanes_of(0);
    mask off = MASK_NONE;
    EACH_IN (c, of->touching) {
        wrong[c][0] = wrong[c][1] = none;
        lanes normal = u[c][0], along = u[c][1];
        if (of->rebound)
            normal = normal + of->rebound[c][0], along = along + of->rebound[c][1];
        wrong[c][0] = choose(g->rows[c][0], normal, none);
        if (contact_unknowns(c) == 2)
            wrong[c][1] = choose(g->rows[c][1], along, none);
        EACH (a, 0, 2)
            if (a < contact_unknowns(c))
                off |= mask_less(lanes_of(PROJECT_VELOCITY), lanes_abs(wrong[c][a]));
    }
    return off;
}

/* Takes that away by moving the velocity w along the responses, in the lanes of `where`; u follows.
 * Returns what that adds to the energy. */
HOT lanes project_move_velocity(const struct held *of, const struct grip *g, mask where,
                                const lanes (*wrong)[2], lanes *w, lanes (*u)[2])
{
    lanes x[CONTACTS][2], energy = lanes_of(0);
    contact_back(of->touching, &g->factors, wrong, x);
    EACH_IN (c, of->touching)
        EACH (a, 0, 2)
            if (a < contact_unknowns(c))
                EACH (i, 0, SCENE_COORDINATES)
                    w[i] = choose(g->rows[c][a] & where,
                                  lanes_fma(of->response[c][a][i], x[c][a], w[i]), w[i]);
    EACH_IN (c, of->touching) {
        const lanes before[2] = {u[c][0], u[c][1]};
        scene_contact_velocity(&of->set->body, of->trig, c, w, u[c]);
        EACH (a, 0, 2)
            if (a < contact_unknowns(c))
                energy =
                    lanes_fma(x[c][a], lanes_fnma(lanes_of(0.5), wrong[c][a], before[a]), energy);
    }
    return lanes_abs(energy);
}

/* Once more, and again, in the lanes of `off`. */
COLD lanes project_again(const struct held *of, const struct grip *g, mask off, lanes *w,
                         lanes (*u)[2])
{
    lanes energy = lanes_of(0), wrong[CONTACTS][2];
    for (int round = 1; round < PROJECT_ROUNDS && mask_any(off); round++) {
        project_wrong(of, g, u, wrong);
        const lanes added = project_move_velocity(of, g, off, wrong, w, u);
        energy += choose(off, added, lanes_of(0));
        off &= project_wrong(of, g, u, wrong);
    }
    return energy;
}

/* Moves the velocity w along the responses until the contacts' velocities u (out) are what the laws
 * ask for, in the rows that are held. *energy: the sum of what that adds. */
HOT void project_along(const struct held *of, const struct grip *g, lanes *w, lanes (*u)[2],
                       lanes *energy)
{
    lanes wrong[CONTACTS][2];
    EACH_IN (c, of->touching)
        scene_contact_velocity(&of->set->body, of->trig, c, w, u[c]);
    project_wrong(of, g, u, wrong);
    *energy += project_move_velocity(of, g, LANES_ALL, wrong, w, u);
    const mask off = project_wrong(of, g, u, wrong);
    if (!mask_any(off))
        return;
#ifdef CONTACT_LISTS
    *energy += project_again(of, g, off, w, u);
#else /* with copies: what is passed by address has to stay in memory */
    lanes moved[SCENE_COORDINATES], v[CONTACTS][2], response[CONTACTS][2][SCENE_COORDINATES];
    lanes rebound[CONTACTS][2];
    const scene_trig trig = *of->trig;
    const struct grip same = *g;
    const struct held copy = {of->set, &trig, of->touching, response, of->rebound ? rebound : NULL};
    memcpy(moved, w, sizeof moved);
    memcpy(v, u, sizeof v);
    memcpy(response, of->response, sizeof response);
    if (of->rebound)
        memcpy(rebound, of->rebound, sizeof rebound);
    *energy += project_again(&copy, &same, off, moved, v);
    memcpy(w, moved, sizeof moved);
    memcpy(u, v, sizeof v);
#endif
}

/* Responses to impulses at contacts in `touching` by the inertia at the end in the lanes of
 * `impact`, elsewhere those of the iterate. */
static inline void project_inertia(const struct setting *set, mask impact, const struct iterate *it,
                                   contact_set touching,
                                   lanes response[CONTACTS][2][SCENE_COORDINATES])
{
    scene_matrix A;
    scene_inertia(&set->body, &it->end, &A);
    EACH_IN (c, touching) {
        scene_contact_response(&set->body, &A, false, &it->end, c, response[c]);
        for (int a = 0; a < 2; a++)
            for (int i = 0; i < SCENE_COORDINATES; i++)
                response[c][a][i] = choose(impact, response[c][a][i], it->response[c][a][i]);
    }
}

/* The rows of a step that has arrived, in the lanes of `run`: contacts that carry have the normal
 * velocity that the laws ask for, those that stick no other. */
HOT void project_rows(const struct setting *set, contact_set touching, mask run,
                      const struct iterate *it, struct grip *g)
{
    EACH_IN (c, touching) {
        g->rows[c][0] = run & it->active[c] & mask_less(lanes_of(0), it->r[c][0]);
        const lanes load = contact_load(c, it->r);
        g->rows[c][1] = MASK_NONE;
        if (contact_unknowns(c) == 2)
            g->rows[c][1] = run & contact_part(c, it->active) &
                            contact_stands(set->friction, load, it->r[c][1]);
    }
}

/* Takes contacts out that move on: the impulses of a very short step are so small that rounding
 * puts a sliding one into the cone. One that sticks has r_T - u_T / D_TT inside, with room. */
static inline void project_slides(const struct setting *set, const struct iterate *it,
                                  contact_set touching, struct grip *g)
{
    EACH_IN (c, touching) {
        if (contact_unknowns(c) == 1)
            continue;
        lanes u[2], moved[2];
        scene_contact_velocity(&set->body, &it->end, c, it->w, u);
        scene_contact_velocity(&set->body, &it->end, c, it->response[c][1], moved);
        const lanes load = contact_load(c, it->r);
        u[1] = iterate_slip(it, c, u);
        g->rows[c][1] &= mask_less(lanes_fma(lanes_abs(it->r[c][1]), moved[1], lanes_abs(u[1])),
                                   set->friction * load * moved[1]);
    }
}

/* Three tests, by lanes: a contact that does not carry lies on the ground and approaches it; an end
 * of a grip carries; a sliding contact has come to slide the way its friction points, by more
 * than rounding. */
HOT mask project_falls(const struct setting *set, mask run, const struct grip *g, int c,
                       const struct iterate *it, const lanes u[2])
{
    return run & LANES_NOT(g->rows[c][0]) & motion_closed(set, it->gap, c) &
           mask_less(u[0], lanes_of(-STEP_APPROACH));
}
HOT mask project_turns(const struct grip *g, int c, const struct iterate *it, const lanes u[2])
{
    mask loaded = g->rows[c][0];
    if (contact_second(c) >= 0)
        loaded |= g->rows[contact_second(c)][0];
    return loaded & LANES_NOT(g->rows[c][1]) &
           mask_less(PROJECT_VELOCITY * lanes_abs(it->r[c][1]),
                     it->r[c][1] * iterate_slip(it, c, u));
}

/* Position, then velocity at the end of a step in which contacts may have come, in the lanes of
 * `run`; `lands`: those with an impact. Returns those where the position could be mended. */
static inline mask project_far(const struct step *step, contact_set touching, mask lands, mask run,
                               struct iterate *it, lanes (*u)[2], lanes *energy)
{
    const struct setting *const set = step->set;
    lanes response[CONTACTS][2][SCENE_COORDINATES], rebound[CONTACTS][2];
    const struct held of = {set, &it->end, touching, response, rebound};
    struct grip g;
    memset(g.rows, 0, sizeof g.rows);
    for (int c = 0; c < OWN_CONTACTS; c++) {
        it->brought[c] = MASK_NONE;
        rebound[c][0] = set->restitution[c] * lanes_min(step->from->approach[c], lanes_of(0));
        rebound[c][1] = it->along ? it->along[c] : lanes_of(0);
    }
    project_rows(set, touching, run, it, &g);
    project_slides(set, it, touching, &g);
    const mask near = project_position(step, touching, true, run, it, energy);
    project_inertia(set, lands, it, touching, response);
    mask where = run; /* a lane in which nothing is left to do has done with it */
    for (int round = 0; round < 2 + OWN_CONTACTS; round++) {
        mask falls[CONTACTS], turns[CONTACTS], any = MASK_NONE;
        grip_factor(&of, &g);
        project_along(&of, &g, it->w, u, energy);
        EACH_IN (c, touching) {
            falls[c] = project_falls(set, where, &g, c, it, u[c]);
            it->brought[c] |= falls[c] & LANES_NOT(it->active[c]);
            turns[c] = MASK_NONE;
            if (contact_unknowns(c) == 2)
                turns[c] = where & project_turns(&g, c, it, u[c]);
            any |= falls[c] | turns[c];
        }
        if (!mask_any(any))
            break;
        EACH_IN (c, touching) { /* stopped, where there is one */
            g.rows[c][0] = any & (g.rows[c][0] | falls[c]);
            g.rows[c][1] = any & (g.rows[c][1] | turns[c]);
        }
        where = any;
    }
    return near;
}

/* The same for an ordinary step; `full`: with every contact in `touching` active in every lane that
 * matters. Returns the lanes where it still is one. */
HOT mask project_near(const struct step *step, contact_set touching, bool full, mask run,
                      struct iterate *it, lanes (*u)[2], lanes *energy)
{
    const struct held of = {step->set, &it->end, touching, it->response, NULL};
    struct grip g;
    mask good = run, slides = MASK_NONE;
    project_rows(step->set, touching, run, it, &g);
    EACH_IN (c, touching)
        slides |= run & LANES_NOT(g.rows[c][0] & g.rows[c][contact_unknowns(c) - 1]);
    const bool stands = full && !mask_any(slides);
    /* The factors do not wait for the position: where they are a little off a second round helps.
     */
    if (stands) { /* with rows that are known to the compiler */
        EACH_IN (c, touching)
            g.rows[c][0] = g.rows[c][1] = LANES_ALL;
        grip_factor(&of, &g);
        good &= project_position(step, touching, false, run, it, energy);
        project_along(&of, &g, it->w, u, energy);
        return good;
    }
    grip_factor(&of, &g);
    good &= project_position(step, touching, false, run, it, energy);
    project_along(&of, &g, it->w, u, energy);
    /* Of contacts that are active: others may be in `touching` for a neighbour's sake. */
    EACH_IN (c, touching) {
        good &= LANES_NOT(project_falls(step->set, run & it->active[c], &g, c, it, u[c]));
        if (contact_unknowns(c) == 2)
            good &= LANES_NOT(project_turns(&g, c, it, u[c]));
    }
    return good;
}

#endif
