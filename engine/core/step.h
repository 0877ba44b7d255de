/* step.h - one time step of every lane: implicit in the velocity, contact exact, any theta.
 *
 * With w the velocity sought, w0 and s0 the state before, theta = METHOD_THETA, the equation is
 *
 *   P(w, r) = A(u) (w - w0) - h F(u, v) - H^T r = 0,   v = (1 - theta) w0 + theta w,
 *   u = s0 + h theta v,   end position s1 = s0 + h v,
 *
 * the paper's (8) for theta = 1. Contact impulses r obey Signorini's and Coulomb's laws with the
 * velocity H(s1) w at the end (contact.h); they are fully implicit whatever theta is, or a ball
 * would rebound at e = 0. The paper's steps (i)-(vi) run as one Newton iteration: each iterate
 * linearises P and H w exactly (H^T r and H w too, so convergence is quadratic), takes the free
 * velocity (11), builds the Delassus operator (14), solves the contact laws and updates (13).
 *
 * Which contacts take part: those closed before the step, and each whose gap at some iterate's s1
 * is not positive. The paper tests the free motion's gap instead; testing the iterate lets a foot
 * that already stands hold the robot up while the other foot is judged.
 *
 * Impulse directions are taken at u; in a step with an impact at s1 for theta < 1 too, so that an
 * impact at e = 0 cannot add energy: with the same H in P and in the laws the impulses add
 * r.U - r.G r / 2 <= 0, G = H A^-1 H^T.
 *
 * Velocity laws leave a position error of O(h |v|) at a touchdown and O(h^2) later. It is removed
 * after the step by moving s1 along A^-1 H_N^T (with the step's matrix for A) until the gaps of
 * loaded contacts are zero, or after a rebound what is left of the step at the rebound's speed, and
 * none is negative. The energy that this adds is reported.
 */
#ifndef STANCE_CORE_STEP_H
#define STANCE_CORE_STEP_H

#include "direct.h"
#include "law.h"

#define STEP_MAX_ITERATIONS 25
#define STEP_TOLERANCE                                                                             \
    1e-7                  /* last Newton correction, m/s and rad/s; the error left is its square */
#define STEP_CLOSED 1e-12 /* m: a contact this close counts as closed */
#define STEP_PROJECTION 1e-13 /* m: gap error left by the projection */
#define STEP_FARTHEST 0.3     /* rad: a projection that turns the robot further is refused */
#define STEP_FROZEN_RESIDUAL                                                                       \
    1e-6 /* m/s: a step with frozen geometry that is further off is refused */
#define STEP_MOST_GAIN                                                                             \
    0.03 /* share of kinetic energies and work; a step that gains more is refused */
#define STEP_MOST_REBOUND 4 /* the same for a step with a rebound, of all kinetic energy */
#define STEP_APPROACH 1e-9  /* m/s: a closed contact that approaches faster is an impact */

/* What does not change during a case. */
struct setting {
    scene_body body;
    lanes friction, restitution;
    lanes may_touch[SCENE_CONTACTS]; /* 1 or 0 */
    struct law law;
};

/* Where a system is; consists of lanes (choose_all). */
struct motion {
    lanes s[SCENE_COORDINATES], w[SCENE_COORDINATES];
    lanes gap[SCENE_CONTACTS];
    lanes approach[SCENE_CONTACTS]; /* normal velocity */
    scene_trig trig;                /* at s */
    lanes t;                        /* s */
    lanes integral[ACTUATORS];      /* what the law has summed, see law.h */
    lanes energy, kinetic;          /* J, of this state; where steps of step.h are taken */
};

/* Contacts that are closed in any of the lanes m: is there anything to solve? */
static inline contact_set step_touching(const struct setting *set, const lanes *gap, mask m)
{
    contact_set touching = 0;
    for (int c = 0; c < SCENE_CONTACTS; c++)
        if (mask_any(m & mask_less(lanes_of(0), set->may_touch[c]) &
                     mask_less_equal(gap[c], lanes_of(STEP_CLOSED))))
            touching |= 1u << c;
    return touching;
}

/* Fills in the energies of a motion. */
static inline void motion_energy(const struct setting *set, struct motion *m)
{
    m->kinetic = scene_kinetic(&set->body, &m->trig, m->w);
    m->energy = m->kinetic + scene_potential(&set->body, m->s, &m->trig);
}

/* What a step did; consists of lanes (choose_all). */
struct step_report {
    lanes impulse[SCENE_CONTACTS][2]; /* N s */
    lanes slip[SCENE_CONTACTS];       /* m, where loaded */
    lanes torque[ACTUATORS];          /* N m, as applied at the end */
    lanes iterations, evaluations;
    lanes impact_energy, projection_energy; /* J */
    lanes work;                             /* J, of actuators and other outer forces */
    lanes signorini, coulomb, dissipation;  /* residuals of the contact laws, see stance_result */
    lanes friction;                         /* largest |rT| / rN */
    lanes least[SCENE_CONTACTS];            /* smallest normal force, N */
    lanes ambiguous, subdivided;            /* 0 or 1 */
    lanes events;
    lanes degraded; /* 1: the law acting inside the step was degraded, see decoupling.h */
    lanes failure;  /* stance_failure, or 0: the state tells */
};

/* The iterate of one step and what is frozen with it in each lane. */
struct iterate {
    lanes w[SCENE_COORDINATES];
    lanes s1[SCENE_COORDINATES];
    lanes r[SCENE_CONTACTS][2], u[SCENE_CONTACTS][2];
    lanes gap[SCENE_CONTACTS];
    lanes lift[SCENE_CONTACTS][SCENE_COORDINATES]; /* response to a unit normal impulse */
    lanes torque[ACTUATORS];
    scene_trig middle, end; /* trigonometry at u and at s1; one and the same for theta = 1 */
    mask active[SCENE_CONTACTS];
    mask ambiguous, unsolved;
    lanes size;  /* of the last correction */
    lanes shift; /* how far impulses moved with it, as a velocity */
    lanes approach[SCENE_CONTACTS], energy, kinetic; /* at the end, see struct motion */
    const int *corner;                               /* see law_inside */
};

/* What corrections are measured by: the largest velocity, at least 1. */
HOT lanes iterate_speed(const struct iterate *it)
{
    lanes speed = lanes_of(1);
    for (int i = 0; i < SCENE_COORDINATES; i++)
        speed = lanes_max(lanes_abs(it->w[i]), speed);
    return speed;
}

/* The velocity that forces and positions see: (1 - theta) w0 + theta w. */
static inline lanes step_velocity(lanes w0, lanes w)
{
    if (METHOD_THETA == 1)
        return w;
    return (1 - METHOD_THETA) * w0 + METHOD_THETA * w;
}

/* Position at the end and, unless the geometry is frozen, the trigonometry that goes with it. */
static inline void iterate_place(const struct setting *set, const struct motion *from, lanes h,
                                 bool frozen, struct iterate *it)
{
    lanes middle[SCENE_COORDINATES];
    for (int i = 0; i < SCENE_COORDINATES; i++) {
        const lanes v = step_velocity(from->w[i], it->w[i]);
        it->s1[i] = from->s[i] + h * v;
        middle[i] = from->s[i] + (METHOD_THETA * h) * v;
    }
    if (frozen)
        return;
    if (METHOD_THETA == 1) {
        scene_trigonometry(it->s1, &it->end);
    } else {
        scene_trigonometry(middle, &it->middle);
        scene_contact_trigonometry(it->s1, &it->end); /* the rest when the step is done */
    }
    for (int c = 0; c < SCENE_CONTACTS; c++)
        it->gap[c] = scene_gap(&set->body, it->s1, &it->end, c);
}

/* Contact impulses of an iterate: adds what they do to the correction dw of the velocity. */
HOT void iterate_contacts(const struct setting *set, const struct motion *from, bool all,
                          mask running, bool coupled, contact_set touching, const scene_matrix *J,
                          const scene_trig *direction, lanes lever, lanes *dw, struct iterate *it)
{
    lanes response[SCENE_CONTACTS][2][SCENE_COORDINATES];
    for (int c = 0; c < SCENE_CONTACTS; c++)
        for (int i = 0; i < SCENE_COORDINATES; i++)
            response[c][0][i] = response[c][1][i] = lanes_of(0);
    lanes D[2][2][2][2], uf[2][2]; /* of SCENE_CONTACTS contacts; zero of those that are open */
    for (int c = 0; c < 2; c++)
        for (int a = 0; a < 2; a++) {
            uf[c][a] = lanes_of(0);
            for (int b = 0; b < 2; b++)
                D[c][0][a][b] = D[c][1][a][b] = lanes_of(0);
        }
    for (int c = 0; c < SCENE_CONTACTS; c++)
        if (touching >> c & 1)
            scene_contact_response(&set->body, J, coupled, direction, c, response[c]);
    for (int c = 0; c < SCENE_CONTACTS; c++) {
        lanes now[2], moved[2];
        if (!(touching >> c & 1))
            continue;
        scene_contact_velocity(&set->body, &it->end, c, it->w, now);
        scene_contact_velocity_change(&set->body, &it->end, c, it->w, lever, dw, moved);
        uf[c][0] = lanes_fma(set->restitution, lanes_min(from->approach[c], lanes_of(0)),
                             now[0] + moved[0]);
        uf[c][1] = now[1] + moved[1];
        for (int k = 0; k < SCENE_CONTACTS; k++)
            for (int b = 0; b < 2 && touching >> k & 1; b++) {
                scene_contact_velocity_change(&set->body, &it->end, c, it->w, lever, response[k][b],
                                              moved);
                D[c][k][0][b] = moved[0];
                D[c][k][1][b] = moved[1];
            }
    }
    lanes r[2][2];
    mask ambiguous, unsolved;
    solve_contacts(set->friction, (const lanes(*)[2][2][2])D, (const lanes(*)[2])uf, NULL, false,
                   touching, it->active, r, &ambiguous, &unsolved);
    if (!all) {
        ambiguous = (it->ambiguous & LANES_NOT(running)) | (ambiguous & running);
        unsolved = (it->unsolved & LANES_NOT(running)) | (unsolved & running);
    }
    it->ambiguous = ambiguous;
    it->unsolved = unsolved;
    for (int c = 0; c < SCENE_CONTACTS; c++) {
        if (!(touching >> c & 1))
            continue;
        for (int i = 0; i < SCENE_COORDINATES; i++) {
            /* Where nothing touches even the sign of a zero stays as it is. */
            const lanes pushed =
                lanes_fma(response[c][0][i], r[c][0], lanes_fma(response[c][1][i], r[c][1], dw[i]));
            dw[i] = choose(it->active[c], pushed, dw[i]);
            it->lift[c][i] = choose_unless(all, running, response[c][0][i], it->lift[c][i]);
        }
        for (int a = 0; a < 2; a++) {
            it->shift = lanes_fma(lanes_abs(r[c][a] - it->r[c][a]), D[c][c][a][a], it->shift);
            it->r[c][a] = choose_unless(all, running, r[c][a], it->r[c][a]);
        }
    }
}

/* One Newton iteration in the lanes that still run. With the
 * geometry frozen the derivatives by it are left out too, so that the operator is constant. */
HOT void iterate_newton(const struct setting *set, const struct motion *from, lanes h, bool all,
                        mask running, bool impacts, mask impact, bool coupled, bool frozen,
                        contact_set touching, struct iterate *it)
{
    const double moves = frozen ? 0 : METHOD_THETA;
    const lanes lever = h * (METHOD_THETA * moves), end_lever = h * moves;
    const scene_trig *const trig = METHOD_THETA == 1 ? &it->end : &it->middle;
    lanes v[SCENE_COORDINATES], change[SCENE_COORDINATES], residual[SCENE_COORDINATES];
    for (int i = 0; i < SCENE_COORDINATES; i++) {
        v[i] = step_velocity(from->w[i], it->w[i]);
        change[i] = it->w[i] - from->w[i];
    }
    scene_trig direction = *trig;
    lanes direction_lever = METHOD_THETA == 1 ? end_lever : lever;
    if (METHOD_THETA != 1 && impacts) {
        scene_choose_trig(impact, &it->end, &it->middle, &direction);
        direction_lever = choose(impact, end_lever, lever);
    }

    lanes torque[ACTUATORS], torque_rate[ACTUATORS][POSTURES];
    for (int i = 0; i < SCENE_ACTUATORS; i++)
        torque[i] = it->torque[i];
    if (coupled) {
        lanes u[SCENE_COORDINATES];
        for (int i = 0; i < SCENE_COORDINATES; i++)
            u[i] = from->s[i] + (METHOD_THETA * h) * v[i];
        law_inside(&set->law, u, v, h * (METHOD_THETA * METHOD_THETA), METHOD_THETA, it->torque,
                   it->corner, torque, torque_rate);
    }

    scene_matrix J;
    lanes dw[SCENE_COORDINATES];
    scene_residual(&set->body, h, from->t + METHOD_THETA * h, trig, v, change, torque, residual);
    scene_factor(&set->body, h, moves, lever, direction_lever, trig, &direction, v, change,
                 (const lanes(*)[2])it->r, coupled, (const lanes(*)[POSTURES])torque_rate, &J);
    for (int i = 0; i < SCENE_COORDINATES; i++)
        residual[i] = -residual[i];
    scene_solve(&J, coupled, residual, dw);

    it->shift = lanes_of(0);
    if (touching)
        iterate_contacts(set, from, all, running, coupled, touching, &J, &direction, end_lever, dw,
                         it);
    it->size = lanes_of(0);
    for (int i = 0; i < SCENE_COORDINATES; i++) {
        it->w[i] = choose_unless(all, running, it->w[i] + dw[i], it->w[i]);
        it->size += lanes_abs(dw[i]); /* a sum keeps NAN */
    }
    for (int i = 0; i < SCENE_ACTUATORS; i++)
        it->torque[i] = choose_unless(all, running, torque[i], it->torque[i]);
}

/* Multipliers of the normal directions `lift` that change the gaps of held contacts, which are in
 * `touching`, by `error`, to first order; where the two are dependent the first does the work, and
 * as much as it takes to leave none below. */
HOT void project_multipliers(const struct setting *set, const scene_trig *trig,
                             contact_set touching,
                             const lanes lift[SCENE_CONTACTS][SCENE_COORDINATES], const mask *held,
                             const lanes *error, lanes *multiplier)
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
        multiplier[c] = error[c] * (1 / G[c][c]); /* the bits that a pair would give */
        return;
    }
    const lanes product = G[0][0] * G[1][1];
    const lanes determinant = lanes_fnma(G[0][1], G[1][0], product);
    const mask regular = mask_less(1e-12 * product, determinant);
    const lanes reciprocal = 1 / choose(regular, determinant, G[0][0]);
    multiplier[0] = choose(regular, lanes_fms(G[1][1], error[0], G[0][1] * error[SECOND]),
                           lanes_max(error[0], error[SECOND])) *
                    reciprocal;
    multiplier[SECOND] =
        choose(regular, lanes_fms(G[0][0], error[SECOND], G[1][0] * error[0]), lanes_of(0)) *
        reciprocal;
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
    for (int c = 0; c < SCENE_CONTACTS; c++)
        multiplier[c] = lanes_of(0);
    for (int round = 0; round < 2; round++) {
        for (int c = 0; c < SCENE_CONTACTS; c++) {
            rest[c] = error[c];
            if (round > 0)
                rest[c] -= scene_gap_change(&set->body, &it->end, c, d);
            rest[c] = choose(held[c], rest[c], lanes_of(0));
        }
        project_multipliers(set, &it->end, touching, it->lift, held, rest, more);
        for (int c = 0; c < SCENE_CONTACTS; c++)
            multiplier[c] = multiplier[c] + more[c];
        for (int i = 0; i < SCENE_COORDINATES; i++) {
            d[i] = lanes_of(0);
            for (int c = 0; c < SCENE_CONTACTS; c++)
                if (touching >> c & 1)
                    d[i] = choose(held[c], lanes_fma(it->lift[c][i], multiplier[c], d[i]), d[i]);
        }
    }
}

/* Moves the end position until loaded contacts have their gap and no contact penetrates. Returns
 * the lanes where that needed no more than STEP_FARTHEST of turning: elsewhere the step is too
 * long for its velocity. */
HOT mask iterate_project(const struct setting *set, const struct motion *from, lanes h,
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
    *energy = lanes_of(0);
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

/* Kinetic energy that the contact impulses added: r.U - x^T A x / 2, x = A^-1 H^T r. */
static inline lanes impact_energy(const struct setting *set, const struct iterate *it)
{
    const scene_trig *const trig = METHOD_THETA == 1 ? &it->end : &it->middle;
    scene_matrix A;
    scene_inertia(&set->body, trig, &A);
    lanes x[SCENE_COORDINATES], work = lanes_of(0);
    for (int i = 0; i < SCENE_COORDINATES; i++)
        x[i] = lanes_of(0);
    for (int c = 0; c < SCENE_CONTACTS; c++) {
        lanes response[2][SCENE_COORDINATES], u[2];
        scene_contact_response(&set->body, &A, false, &it->end, c, response);
        scene_contact_velocity(&set->body, &it->end, c, it->w, u);
        for (int i = 0; i < SCENE_COORDINATES; i++)
            x[i] += response[0][i] * it->r[c][0] + response[1][i] * it->r[c][1];
        work += u[0] * it->r[c][0] + u[1] * it->r[c][1];
    }
    return work - scene_kinetic(&set->body, trig, x);
}

/* Lanes where the energy gained is what discretisation may gain. The equation of a long step has
 * further roots, at which the robot has turned around several times and is much too fast: such a
 * step is as good as not converged. */
HOT mask step_balances(const struct motion *from, const struct iterate *it, lanes work)
{
    /* At rest there is rounding: a share of the potential energy, of whatever size. */
    const lanes moving = from->kinetic + it->kinetic + lanes_abs(work);
    const lanes rounding = lanes_abs(from->energy) + lanes_abs(it->energy);
    const lanes admitted = lanes_fma(lanes_of(STEP_MOST_GAIN), moving,
                                     lanes_fma(lanes_of(1e-9), rounding, lanes_of(1e-12)));
    return mask_less_equal(it->energy - from->energy - work, admitted);
}
/* The same for a step with a rebound: the place of the impact inside the step decides on its
 * energy, and Newton's restitution may add some; what multiplies the motion is another root still.
 */
HOT mask step_rebounds(const struct motion *from, const struct iterate *it, lanes work)
{
    const lanes fallen = (it->energy - it->kinetic) - (from->energy - from->kinetic);
    const lanes source = from->kinetic + lanes_abs(work) + lanes_abs(fallen);
    const lanes rounding = lanes_abs(from->energy) + lanes_abs(it->energy);
    return mask_less_equal(it->kinetic,
                           lanes_fma(lanes_of(STEP_MOST_REBOUND), source,
                                     lanes_fma(lanes_of(1e-9), rounding, lanes_of(1e-12))));
}

/* Residuals of the contact laws at a contact with force (or impulse) r and velocity u, the normal
 * one relative to what restitution asks for. */
HOT void report_residuals(struct step_report *report, mask part, lanes friction, const lanes r[2],
                          const lanes u[2])
{
    const lanes none = lanes_of(0), bound = friction * r[0], along = lanes_abs(u[1]);
    const mask loaded = part & mask_less(none, r[0]);
    const lanes normal = choose(loaded, lanes_abs(u[0]), lanes_max(-u[0], none));
    report->signorini = lanes_max(choose(part, normal, none), report->signorini);
    const lanes beyond = lanes_abs(r[1]) / choose(loaded, r[0], lanes_of(1)) - friction;
    report->coulomb = choose(loaded, lanes_max(beyond, report->coulomb), report->coulomb);
    const mask opposed =
        mask_less_equal((1 - 1e-9) * bound, lanes_abs(r[1])) & mask_less_equal(r[1] * u[1], none);
    report->dissipation = choose(loaded & LANES_NOT(opposed), lanes_max(along, report->dissipation),
                                 report->dissipation);
}

/* What one contact says in a step that has arrived: velocity u, impulse r, where it is in `part`.
 * What hardly carries has no direction, see CONTACT_TOLERANCE. */
HOT void report_contact(const struct setting *set, const struct motion *from, lanes h, mask part,
                        lanes load, int c, const lanes u[2], const lanes r[2],
                        struct step_report *report)
{
    const lanes none = lanes_of(0);
    const mask loaded = part & mask_less(none, r[0]);
    const mask carries = mask_less(1e-6 * load, r[0]);
    const lanes relative[2] = {
        lanes_fma(set->restitution, lanes_min(from->approach[c], none), u[0]), u[1]};
    const lanes carried[2] = {choose(carries, r[0], none), choose(carries, r[1], none)};
    report_residuals(report, part, set->friction, carried, relative);
    report->slip[c] = choose(loaded, h * lanes_abs(u[1]), none);
    for (int a = 0; a < 2; a++)
        report->impulse[c][a] = choose(loaded, r[a], none);
    const lanes ratio = lanes_abs(r[1]) / choose(loaded, r[0], lanes_of(1));
    report->friction = choose(loaded, lanes_max(ratio, report->friction), report->friction);
    report->least[c] = choose(loaded, r[0] / h, none);
}

/* A report of nothing, to add others to. */
static inline void report_clear(struct step_report *report)
{
    memset(report, 0, sizeof *report);
    for (int c = 0; c < SCENE_CONTACTS; c++)
        report->least[c] = lanes_of(INFINITY);
}
/* The same in one lane. */
static inline void report_clear_lane(struct step_report *report, int lane)
{
    lanes *const all = (lanes *)report;
    for (size_t i = 0; i < sizeof *report / sizeof(lanes); i++)
        lane_set(&all[i], lane, 0);
    for (int c = 0; c < SCENE_CONTACTS; c++)
        lane_set(&report->least[c], lane, INFINITY);
}
/* Forces of the contacts in `part`, N. */
static inline void report_forces(struct step_report *report, const mask *part,
                                 const lanes force[SCENE_CONTACTS][2])
{
    const lanes none = lanes_of(0);
    for (int c = 0; c < SCENE_CONTACTS; c++) {
        const mask loaded = part[c] & mask_less(none, force[c][0]);
        const lanes ratio = lanes_abs(force[c][1]) / choose(loaded, force[c][0], lanes_of(1));
        report->friction = choose(loaded, lanes_max(ratio, report->friction), report->friction);
        report->least[c] = lanes_min(choose(loaded, force[c][0], none), report->least[c]);
    }
}

/* What an iterate that has arrived leaves: position errors removed, the balance of energy, the
 * report. `touching`: contacts that are active anywhere; `impacts`: not all were closed before, and
 * those in `impact` are; `frozen`: the geometry was. Returns the lanes of `converged` whose step
 * is admitted. */
HOT mask step_finish(const struct setting *set, const struct motion *from, lanes h,
                     contact_set touching, bool impacts, mask impact, mask converged, bool frozen,
                     struct iterate *it, struct step_report *report)
{
    const lanes none = lanes_of(0);
    mask somewhere = MASK_NONE;
    lanes moved[SCENE_COORDINATES], load = none;
    for (int i = 0; i < SCENE_COORDINATES; i++)
        moved[i] = it->s1[i] - from->s[i];
    report->work = scene_work(&set->body, h, from->t + METHOD_THETA * h, it->torque, moved);
    report->signorini = report->coulomb = report->dissipation = none;
    report->friction = report->impact_energy = report->projection_energy = none;
    report->subdivided = report->events = report->degraded = report->failure = none;
    for (int i = 0; i < SCENE_ACTUATORS; i++)
        report->torque[i] = it->torque[i];
    for (int c = 0; c < SCENE_CONTACTS; c++)
        if (touching >> c & 1)
            load += lanes_max(it->r[c][0], none);
    for (int c = 0; c < SCENE_CONTACTS; c++) {
        lanes u[2];
        scene_contact_velocity(&set->body, &it->end, c, it->w, u);
        it->approach[c] = u[0];
        report->slip[c] = report->impulse[c][0] = report->impulse[c][1] = none;
        report->least[c] = none;
        if (!(touching >> c & 1))
            continue;
        const mask part = it->active[c] & converged;
        somewhere |= part;
        report_contact(set, from, h, part, load, c, (const lanes *)u, it->r[c], report);
    }
    if (impacts && mask_any(somewhere & impact))
        report->impact_energy = choose(somewhere & impact, impact_energy(set, it), none);
    if (frozen) /* what the frozen geometry made of the contact laws */
        converged &= mask_less_equal(lanes_max(report->signorini, report->dissipation),
                                     lanes_of(STEP_FROZEN_RESIDUAL));
    if (touching && mask_any(somewhere)) {
        const mask near = iterate_project(set, from, h, touching, impacts, somewhere, it,
                                          &report->projection_energy);
        converged &= near | LANES_NOT(somewhere);
    }
    it->kinetic = scene_kinetic(&set->body, &it->end, it->w);
    it->energy = it->kinetic + scene_potential(&set->body, it->s1, &it->end);
    const mask rebounds = somewhere & mask_less(none, set->restitution);
    converged &= (rebounds & step_rebounds(from, it, report->work)) |
                 (LANES_NOT(rebounds) & step_balances(from, it, report->work));
    report->ambiguous = choose(it->ambiguous & converged, lanes_of(1), none);
    return converged;
}

/* Hands the iterate's end over, in the lanes of `done`, or in all. */
HOT void step_commit(lanes t, const struct iterate *it, bool all, mask done, struct motion *to)
{
    for (int i = 0; i < SCENE_COORDINATES; i++) {
        to->s[i] = choose_unless(all, done, it->s1[i], to->s[i]);
        to->w[i] = choose_unless(all, done, it->w[i], to->w[i]);
    }
    for (int c = 0; c < SCENE_CONTACTS; c++) {
        to->gap[c] = choose_unless(all, done, it->gap[c], to->gap[c]);
        to->approach[c] = choose_unless(all, done, it->approach[c], to->approach[c]);
    }
    for (int a = 0; a < SCENE_ANGLES; a++) {
        to->trig.sine[a] = choose_unless(all, done, it->end.sine[a], to->trig.sine[a]);
        to->trig.cosine[a] = choose_unless(all, done, it->end.cosine[a], to->trig.cosine[a]);
    }
    to->t = choose_unless(all, done, t, to->t);
    to->energy = choose_unless(all, done, it->energy, to->energy);
    to->kinetic = choose_unless(all, done, it->kinetic, to->kinetic);
}

/* Takes one step of length h from `from` in the lanes of `run`; *to and *report are written there
 * only where it converged. `torque` is held over the step unless `coupled`: then the law acts
 * inside it. From iteration `freeze_after` on inertia and directions stay those of that iterate:
 * with parallel legs the contact solution can jump with the geometry, and Newton then cycles
 * between two modes for every h. `corner`: as in law_inside; converged is then only what agrees
 * with it. Returns the lanes that converged. */
COLD mask take_step_at(const int *corner, const struct setting *set, const struct motion *from,
                       const lanes *torque, lanes h, mask run, bool coupled, int freeze_after,
                       struct motion *to, struct step_report *report)
{
    struct iterate it;
    it.corner = corner;
    mask impact = MASK_NONE, running = run;
    mask closed[SCENE_CONTACTS];
    for (int i = 0; i < SCENE_COORDINATES; i++)
        it.w[i] = from->w[i];
    for (int i = 0; i < SCENE_ACTUATORS; i++)
        it.torque[i] = torque[i];
    for (int c = 0; c < SCENE_CONTACTS; c++) {
        closed[c] = mask_less(lanes_of(0), set->may_touch[c]) &
                    mask_less_equal(from->gap[c], lanes_of(STEP_CLOSED));
        it.active[c] = closed[c];
        impact |= closed[c] & mask_less(from->approach[c], lanes_of(-STEP_APPROACH));
        it.r[c][0] = it.r[c][1] = lanes_of(0);
        for (int i = 0; i < SCENE_COORDINATES; i++)
            it.lift[c][i] = lanes_of(0);
    }
    it.ambiguous = it.unsolved = MASK_NONE;
    iterate_place(set, from, h, false, &it);
    lanes iterations = lanes_of(0);
    for (int k = 0; k < STEP_MAX_ITERATIONS && mask_any(running); k++) {
        /* All or none: position errors may have to be removed at a contact that is not active. */
        const mask somewhere = (it.active[0] | it.active[SECOND]) & running;
        const contact_set touching = mask_any(somewhere) ? (1u << SCENE_CONTACTS) - 1 : 0;
        iterate_newton(set, from, h, false, running, true, impact, coupled, k > freeze_after,
                       touching, &it);
        iterations += choose(running, lanes_of(1), lanes_of(0));
        iterate_place(set, from, h, k >= freeze_after, &it);
        mask news = MASK_NONE;
        for (int c = 0; c < SCENE_CONTACTS; c++) {
            const mask hit = running & LANES_NOT(it.active[c]) &
                             mask_less(lanes_of(0), set->may_touch[c]) &
                             mask_less_equal(it.gap[c], lanes_of(0));
            it.active[c] |= hit;
            news |= hit;
        }
        impact |= news;
        const mask done = mask_less_equal(it.size, STEP_TOLERANCE * iterate_speed(&it)) &
                          LANES_NOT(news) & LANES_NOT(it.unsolved);
        running &= LANES_NOT(done);
    }
    mask converged = run & LANES_NOT(running);
    if (corner) {
        lanes u[SCENE_COORDINATES], v[SCENE_COORDINATES];
        for (int i = 0; i < SCENE_COORDINATES; i++) {
            v[i] = step_velocity(from->w[i], it.w[i]);
            u[i] = from->s[i] + (METHOD_THETA * h) * v[i];
        }
        converged &= law_agrees(&set->law, u, v, corner);
    }
    if (freeze_after < STEP_MAX_ITERATIONS)
        iterate_place(set, from, h, false, &it);
    if (METHOD_THETA != 1)
        scene_trigonometry(it.s1, &it.end);
    converged = step_finish(set, from, h, (1u << SCENE_CONTACTS) - 1, true, impact, converged,
                            freeze_after < STEP_MAX_ITERATIONS, &it, report);
    report->iterations = report->evaluations = iterations;
    step_commit(from->t + h, &it, false, converged, to);
    return converged;
}

/* Adds a part of a step to the whole. */
static inline mask take_step(const struct setting *set, const struct motion *from,
                             const lanes *torque, lanes h, mask run, bool coupled, int freeze_after,
                             struct motion *to, struct step_report *report)
{
    return take_step_at(NULL, set, from, torque, h, run, coupled, freeze_after, to, report);
}

static inline void report_add(struct step_report *sum, const struct step_report *part)
{
    for (int c = 0; c < SCENE_CONTACTS; c++) {
        sum->slip[c] += part->slip[c];
        for (int a = 0; a < 2; a++)
            sum->impulse[c][a] += part->impulse[c][a];
    }
    for (int i = 0; i < SCENE_ACTUATORS; i++)
        sum->torque[i] = part->torque[i];
    sum->iterations += part->iterations;
    sum->evaluations += part->evaluations;
    sum->events += part->events;
    sum->work += part->work;
    sum->impact_energy = lanes_max(part->impact_energy, sum->impact_energy);
    sum->projection_energy += part->projection_energy;
    sum->signorini = lanes_max(part->signorini, sum->signorini);
    sum->coulomb = lanes_max(part->coulomb, sum->coulomb);
    sum->dissipation = lanes_max(part->dissipation, sum->dissipation);
    sum->friction = lanes_max(part->friction, sum->friction);
    for (int c = 0; c < SCENE_CONTACTS; c++)
        sum->least[c] = lanes_min(part->least[c], sum->least[c]);
    sum->ambiguous = lanes_max(part->ambiguous, sum->ambiguous);
    sum->subdivided = lanes_max(part->subdivided, sum->subdivided);
    sum->degraded = lanes_max(part->degraded, sum->degraded);
    sum->failure = part->failure;
}

#endif
