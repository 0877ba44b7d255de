/* iterate.h - Newton's iteration for one implicit step: see step.h for the equation. */
#ifndef STANCE_CORE_IMPLICIT_ITERATE_H
#define STANCE_CORE_IMPLICIT_ITERATE_H

#include "report.h"

#define STEP_MAX_ITERATIONS 25

/* A step that is asked for. */
struct step {
    const struct setting *set;
    const struct motion *from;
    const lanes *torque; /* held over it, unless ... */
    bool coupled;        /* ... the law acts inside it */
    lanes h;             /* s, its length */
    /* From this iteration on inertia and directions stay those of its iterate: with parallel legs
     * the contact solution can jump with the geometry, and Newton then cycles between two modes for
     * every h. Not before STEP_MAX_ITERATIONS: never. */
    int freeze_after;
    const int *corner; /* NULL, or as in law_inside: what converges has to agree with it */
};

/* What is known of the contacts of a step: nothing, that none comes to the ground, or moreover that
 * all that touch anywhere touch in every lane that matters. */
enum step_kind { STEP_ANY, STEP_ORDINARY, STEP_FULL };

/* The iterate of one step and what is frozen with it in each lane. */
struct iterate {
    lanes w[SCENE_COORDINATES];
    lanes s1[SCENE_COORDINATES];
    lanes r[CONTACTS][2], u[CONTACTS][2]; /* u: velocities that the laws are held to */
    lanes gap[CONTACTS];
    lanes response[CONTACTS][2][SCENE_COORDINATES]; /* to a unit impulse at a contact */
    lanes torque[ACTUATORS];
    scene_trig middle, end; /* trigonometry at u and at s1; one and the same for theta = 1 */
    mask active[CONTACTS];
    mask brought[CONTACTS]; /* not active, but come to the ground with the end's position mended */
    contact_set missed;     /* have come to the ground and take no part */
    mask impact;            /* lanes whose step has an impact */
    mask decides;           /* which of several contact solutions it is, whatever was before */
    struct contact_verdict verdict;
    lanes size;                                /* of the last correction */
    lanes shift;                               /* how far impulses moved with it, as a velocity */
    lanes approach[CONTACTS], energy, kinetic; /* at the end, see struct motion */
    lanes iterations;
    lanes before[SCENE_COORDINATES]; /* w before the last iteration of an ordinary step */
    const lanes *along; /* NULL, or what restitution adds to tangential velocities, m/s */
};

/* The tangential velocity of contact c that Coulomb's law is about: u[1] but for Moreau's impacts.
 */
HOT lanes iterate_slip(const struct iterate *it, int c, const lanes u[2])
{
    lanes slip = u[1];
    if (it->along)
        slip = slip + it->along[c];
    return slip;
}

/* What corrections are measured by: the largest velocity, at least 1. */
HOT lanes iterate_speed(const struct iterate *it)
{
    return lanes_largest(it->w, SCENE_COORDINATES, lanes_of(1));
}

/* The velocity that forces and positions see: (1 - theta) w0 + theta w. */
static inline lanes step_velocity(lanes w0, lanes w)
{
    if (METHOD_THETA == 1)
        return w;
    return (1 - METHOD_THETA) * w0 + METHOD_THETA * w;
}

/* Where forces are: the velocity v that they see, and the place u there. */
HOT void iterate_middle(const struct step *step, const struct iterate *it, lanes *u, lanes *v)
{
    EACH (i, 0, SCENE_COORDINATES) {
        v[i] = step_velocity(step->from->w[i], it->w[i]);
        u[i] = step->from->s[i] + (METHOD_THETA * step->h) * v[i];
    }
}

/* Position at the end and, unless the geometry is frozen, the trigonometry that goes with it. */
static inline void iterate_place(const struct step *step, bool frozen, struct iterate *it)
{
    const struct setting *const set = step->set;
    const struct motion *const from = step->from;
    const lanes h = step->h;
    lanes middle[SCENE_COORDINATES];
    EACH (i, 0, SCENE_COORDINATES) {
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
    EACH_CONTACT (c, 0)
        it->gap[c] = scene_gap(&set->body, it->s1, &it->end, c);
}

/* One Newton iteration. */
struct iteration {
    bool all;             /* of all lanes, or ... */
    mask running;         /* ... of these: nothing becomes of the others */
    bool impacts;         /* some lanes may have an impact */
    bool frozen;          /* the geometry: then the derivatives by it are left out, too */
    contact_set touching; /* contacts that take part, and ... */
    contact_set near;     /* ... those, more, whose responses are kept */
};

/* The equation about an iterate: its matrix, where impulses act and by how much that place moves
 * with the velocity. */
struct linearised {
    scene_matrix J;
    const scene_trig *direction;
    lanes lever;
};

/* Contact impulses of an iterate: adds what they do to the correction dw of the velocity. */
HOT void iterate_contacts(const struct step *step, const struct iteration *of,
                          const struct linearised *linear, lanes *dw, struct iterate *it)
{
    const struct setting *const set = step->set;
    const contact_set touching = of->touching;
    lanes response[CONTACTS][2][SCENE_COORDINATES], rebound[CONTACTS][2];
    EACH_CONTACT (c, 0) {
        rebound[c][0] = rebound[c][1] = lanes_of(0);
        EACH (i, 0, SCENE_COORDINATES)
            response[c][0][i] = response[c][1][i] = lanes_of(0);
    }
    lanes D[CONTACTS][CONTACTS][2][2], uf[CONTACTS][2]; /* of those in `touching` */
    EACH_IN (c, of->near)
        scene_contact_response(&set->body, &linear->J, step->coupled, linear->direction, c,
                               response[c]);
    EACH_IN (c, of->near)
        EACH (i, 0, SCENE_COORDINATES)
            for (int a = 0; a < contact_unknowns(c); a++)
                it->response[c][a][i] =
                    choose_unless(of->all, of->running, response[c][a][i], it->response[c][a][i]);
    EACH_IN (c, touching) {
        lanes now[2], moved[2];
        scene_contact_velocity(&set->body, &it->end, c, it->w, now);
        scene_rows rows;
        scene_contact_rows(&set->body, &it->end, c, it->w, linear->lever, &rows);
        scene_rows_velocity(&set->body, c, &rows, dw, moved);
        rebound[c][0] = set->restitution[c] * lanes_min(step->from->approach[c], lanes_of(0));
        uf[c][0] = now[0] + moved[0] + rebound[c][0];
        uf[c][1] = now[1] + moved[1];
        if (it->along)
            rebound[c][1] = it->along[c], uf[c][1] += it->along[c];
        EACH_IN (k, touching)
            EACH (b, 0, 2) {
                if (b >= contact_unknowns(k))
                    continue;
                scene_rows_velocity(&set->body, c, &rows, response[k][b], moved);
                D[c][k][0][b] = moved[0];
                D[c][k][1][b] = moved[1];
            }
    }
    lanes r[CONTACTS][2];
    struct contact_verdict now;
    struct contact_problem problem =
        contact_pose(D, uf, touching, it->active, set->friction, set->prefer);
    problem.shift = rebound;
    problem.last = it->r, problem.known = LANES_NOT(it->decides);
    solve_contacts(&problem, of->running, r, &now);
    it->verdict.ambiguous |= of->running & now.ambiguous; /* a decision is taken once in a step */
    it->verdict.unranked |= of->running & now.unranked;
    it->verdict.unsolved =
        (it->verdict.unsolved & LANES_NOT(of->running)) | (of->running & now.unsolved);
    EACH_IN (c, touching) {
        const int n = contact_unknowns(c);
        const mask part = contact_part(c, it->active);
        EACH (i, 0, SCENE_COORDINATES) {
            /* Where nothing touches even the sign of a zero stays as it is. */
            lanes pushed = dw[i];
            if (n == 2)
                pushed = lanes_fma(response[c][1][i], r[c][1], pushed);
            pushed = lanes_fma(response[c][0][i], r[c][0], pushed);
            dw[i] = choose(part, pushed, dw[i]);
        }
        for (int a = 0; a < n; a++) {
            const lanes moves =
                choose(part, lanes_abs(r[c][a] - it->r[c][a]) * D[c][c][a][a], lanes_of(0));
            it->shift = it->shift + moves;
            it->r[c][a] = choose_unless(of->all, of->running, r[c][a], it->r[c][a]);
        }
    }
}

/* One Newton iteration. With the geometry frozen the operator is constant. */
HOT void iterate_newton(const struct step *step, const struct iteration *of, struct iterate *it)
{
    const struct setting *const set = step->set;
    const struct motion *const from = step->from;
    const lanes h = step->h;
    const double moves = of->frozen ? 0 : METHOD_THETA;
    const lanes lever = h * (METHOD_THETA * moves), end_lever = h * moves;
    const scene_trig *const trig = METHOD_THETA == 1 ? &it->end : &it->middle;
    lanes u[SCENE_COORDINATES], v[SCENE_COORDINATES], change[SCENE_COORDINATES];
    iterate_middle(step, it, u, v);
    EACH (i, 0, SCENE_COORDINATES)
        change[i] = it->w[i] - from->w[i];
    struct linearised linear;
    scene_trig mixed;
    linear.direction = trig, linear.lever = end_lever;
    lanes direction_lever = METHOD_THETA == 1 ? end_lever : lever;
    if (METHOD_THETA != 1 && of->impacts) {
        scene_choose_trig(it->impact, &it->end, &it->middle, &mixed);
        linear.direction = &mixed;
        direction_lever = choose(it->impact, end_lever, lever);
    }

    lanes torque[ACTUATORS], torque_rate[ACTUATORS][POSTURES];
    EACH (i, 0, SCENE_ACTUATORS)
        torque[i] = it->torque[i];
    const struct state place = {.s = u, .w = v};
    if (step->coupled)
        law_inside(&set->law, &place, h * (METHOD_THETA * METHOD_THETA), METHOD_THETA, step->corner,
                   torque, torque_rate);

    lanes residual[SCENE_COORDINATES], dw[SCENE_COORDINATES];
    const scene_guess at = {h, from->t + METHOD_THETA * h, u, trig, v, change};
    const scene_slopes by = {moves, lever, direction_lever, linear.direction, it->r, torque_rate};
    scene_residual(&set->body, &at, torque, residual);
    scene_factor(&set->body, &at, &by, step->coupled, &linear.J);
    EACH (i, 0, SCENE_COORDINATES)
        residual[i] = -residual[i];
    scene_solve(&linear.J, step->coupled, residual, dw);

    it->shift = lanes_of(0);
    if (of->touching)
        iterate_contacts(step, of, &linear, dw, it);
    it->size = lanes_of(0);
    EACH (i, 0, SCENE_COORDINATES) {
        it->w[i] = choose_unless(of->all, of->running, it->w[i] + dw[i], it->w[i]);
        it->size += lanes_abs(dw[i]); /* a sum keeps NAN */
    }
    EACH (i, 0, SCENE_ACTUATORS)
        it->torque[i] = choose_unless(of->all, of->running, torque[i], it->torque[i]);
}

#endif
