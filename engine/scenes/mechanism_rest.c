/* mechanism_rest.c - equilibria of a mechanism on contacts that stick.
 *
 * Unknown: u = (the coordinates that are not given, torques, forces lambda of the supports);
 * conditions, all in units of the mechanism's weight and size:
 *
 *   c(u) = ( Q(q) + B torque + H' lambda,  gaps of the supports ) = 0.
 *
 * Newton with least-norm steps (rows.h), none turning anything further than half a radian, halved
 * until the conditions are less hurt; the derivative is exact. Where null(J), J = dc/du, leaves
 * freedoms, sum (torque / limit)^2 is made least among them by Newton in their space: with Z its
 * basis, g the gradient and mu the multipliers, J' mu = -g in the sense of least squares,
 *
 *   Z' [ d2 sum + d(J' mu)/du ] Z step = -Z' g,
 *
 * the second term by differences of J. Forces that strain the supports only take no part; of them
 * the least are taken. Newton begins with all angles in line and from angles spread evenly; what it
 * finds are the branches.
 */
#include "engine/matrix.h"
#include "engine/refuse.h"
#include "engine/rows.h"
#include "engine/scenes/mechanism_pose.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum {
    N = STANCE_MAX_COORDINATES,
    UNKNOWNS = N + STANCE_MAX_ACTUATORS + STANCE_MAX_STICKING,
    CONDITIONS = N + STANCE_MAX_CONTACTS,
    STEPS = 60,
    HALVINGS = 30,
};
_Static_assert(UNKNOWNS + CONDITIONS + 1 <= STANCE_ROWS_STRIDE, "the equations fit");

static const double solved = 1e-10;  /* of weight and size */
static const double turn_most = 0.5; /* rad, in a step */
static const double one_branch = 1e-6;
static const double at_limit = 1e-9; /* rad or m beyond a limit that rounding may cause */

struct search {
    const stance_scene *scene;
    const stance_mechanism *m;
    const double *robot;
    const stance_equilibrium_choice *choice;
    double weight, size;     /* N, m */
    double given[N];         /* NAN: unknown */
    bool turns[N], wraps[N]; /* coordinates that are angles; that are the same after a turn */
    int coordinates, free, rows, supports; /* of u: `free` coordinates, torques, `rows` forces */
    int coordinate[N];                     /* the free ones */
    double weigh[STANCE_MAX_ACTUATORS];    /* of a squared torque, in units of weight size */
};

/* A trial: c and J = dc/du. */
struct trial {
    stance_pose pose;
    stance_sticking sticking;
    int unknowns, conditions;
    double c[CONDITIONS], J[CONDITIONS][UNKNOWNS];
};

/* Basis of null(J): rows of Z. */
struct freedoms {
    int count;
    double Z[UNKNOWNS][STANCE_ROWS_STRIDE];
};

/* ---- the conditions -------------------------------------------------------------------------- */

/* One of u in its own unit, m or rad, N m or N, N. */
static double unit(const struct search *s, int k)
{
    if (k < s->free)
        return s->turns[s->coordinate[k]] ? 1 : s->size;
    k -= s->free;
    if (k < s->m->actuators)
        return s->scene->actuated[k] >= 0 && s->turns[s->scene->actuated[k]] ? s->weight * s->size
                                                                             : s->weight;
    return s->weight;
}

static void posture_of(const struct search *s, const double *u, double *q)
{
    memcpy(q, s->given, sizeof s->given);
    for (int k = 0; k < s->free; k++)
        q[s->coordinate[k]] = u[k] * unit(s, k);
}

static void forces_of(const struct search *s, const double *u, double *torque, double *lambda)
{
    const int m = s->m->actuators;
    for (int k = 0; k < m; k++)
        torque[k] = u[s->free + k] * unit(s, s->free + k);
    for (int k = 0; k < s->rows; k++)
        lambda[k] = u[s->free + m + k] * s->weight;
}

static void try_at(const struct search *s, const double *u, struct trial *t)
{
    const int n = s->coordinates, m = s->m->actuators;
    double q[N], torque[STANCE_MAX_ACTUATORS], lambda[STANCE_MAX_STICKING], Q[N], dQ[N][N];
    posture_of(s, u, q);
    forces_of(s, u, torque, lambda);
    stance_pose_at(s->m, s->robot, q, &t->pose);
    stance_pose_sticking(s->scene, &t->pose, s->choice->supports, &t->sticking);
    stance_pose_forces(&t->pose, torque, &t->sticking, lambda, Q, dQ);
    t->unknowns = s->free + m + s->rows;
    t->conditions = n;
    memset(t->J, 0, sizeof t->J);
    for (int i = 0; i < n; i++) {
        const double scale = s->turns[i] ? s->weight * s->size : s->weight;
        t->c[i] = Q[i] / scale;
        for (int k = 0; k < s->free; k++)
            t->J[i][k] = dQ[i][s->coordinate[k]] * (unit(s, k) / scale);
        for (int k = 0; k < m; k++)
            t->J[i][s->free + k] = i == s->scene->actuated[k];
        for (int k = 0; k < s->rows; k++)
            t->J[i][s->free + m + k] =
                t->sticking.touch[k].row[t->sticking.direction[k]][i] * (s->weight / scale);
    }
    for (int k = 0; k < s->rows; k++) {
        if (t->sticking.direction[k] == 1)
            continue;
        const stance_touch *const touch = &t->sticking.touch[k];
        const double scale = touch->stop ? 1 : s->size;
        t->c[t->conditions] = touch->gap / scale;
        for (int j = 0; j < s->free; j++)
            t->J[t->conditions][j] = touch->row[0][s->coordinate[j]] * (unit(s, j) / scale);
        t->conditions++;
    }
}

static double hurt(const struct trial *t)
{
    return sqrt(matrix_dot(t->conditions, t->c, t->c));
}

/* The rows of (J, -c), turned; returns the rank of J. */
static int turn(const struct trial *t, double a[][STANCE_ROWS_STRIDE])
{
    for (int k = 0; k < t->conditions; k++) {
        memcpy(a[k], t->J[k], sizeof t->J[k]);
        a[k][t->unknowns] = -t->c[k];
    }
    return stance_rows_turn(t->conditions, t->unknowns, t->unknowns + 1, a);
}

/* What part of a step turns nothing further than it may. */
static double part_of(const struct search *s, const double *step)
{
    double most = 0;
    for (int k = 0; k < s->free; k++)
        most = fmax(most, fabs(step[k]));
    return most > turn_most ? turn_most / most : 1;
}

/* Newton from u; *t is at its end. False: it does not come to a solution. */
static bool satisfy(const struct search *s, double *u, struct trial *t)
{
    double a[CONDITIONS][STANCE_ROWS_STRIDE], step[UNKNOWNS], next[UNKNOWNS] = {0};
    struct trial further;
    try_at(s, u, t);
    double left = hurt(t);
    for (int i = 0; i < STEPS && left > 0; i++) {
        turn(t, a);
        stance_rows_solve(t->conditions, t->unknowns, a, step);
        double part = part_of(s, step), now = left;
        const int halvings = left > solved ? HALVINGS : 1; /* the last digits as they come */
        for (int half = 0; half < halvings && !(now < left); half++, part /= 2) {
            for (int k = 0; k < t->unknowns; k++)
                next[k] = u[k] + part * step[k];
            try_at(s, next, &further);
            now = hurt(&further);
        }
        if (!(now < left))
            break;
        memcpy(u, next, sizeof next);
        *t = further;
        left = now;
    }
    return left <= solved;
}

/* ---- the least torques ----------------------------------------------------------------------- */

static double effort(const struct search *s, const double *u)
{
    double sum = 0;
    for (int k = 0; k < s->m->actuators; k++)
        sum += 0.5 * s->weigh[k] * (u[s->free + k] * u[s->free + k]);
    return sum;
}

/* mu with J' mu = -gradient in the sense of least squares. */
static void multipliers(const struct search *s, const double *u, const struct trial *t, double *mu)
{
    double a[UNKNOWNS][STANCE_ROWS_STRIDE];
    for (int k = 0; k < t->unknowns; k++) {
        const int actuator = k - s->free;
        for (int i = 0; i < t->conditions; i++)
            a[k][i] = t->J[i][k];
        a[k][t->conditions] =
            actuator >= 0 && actuator < s->m->actuators ? -s->weigh[actuator] * u[k] : 0;
    }
    stance_rows_turn(t->unknowns, t->conditions, t->conditions + 1, a);
    stance_rows_solve(t->unknowns, t->conditions, a, mu);
}

/* out = Z J(u + length way)' mu. */
static void pulled(const struct search *s, const double *u, const double *way, double length,
                   const double *mu, const struct freedoms *free, double *out)
{
    struct trial t;
    double at[UNKNOWNS] = {0}, force[UNKNOWNS] = {0};
    const int n = s->free + s->m->actuators + s->rows;
    for (int k = 0; k < n; k++)
        at[k] = u[k] + length * way[k];
    try_at(s, at, &t);
    for (int k = 0; k < n; k++)
        for (int i = 0; i < t.conditions; i++)
            force[k] += t.J[i][k] * mu[i];
    for (int j = 0; j < free->count; j++)
        out[j] = matrix_dot(n, free->Z[j], force);
}

/* A step of Newton's for the least effort in the space of Z. */
static void ease(const struct search *s, const double *u, const struct trial *t,
                 const struct freedoms *free, double *step)
{
    static const double difference = 1e-5;
    const int first = s->free, m = s->m->actuators, f = free->count;
    const double(*const Z)[STANCE_ROWS_STRIDE] = free->Z;
    double mu[CONDITIONS], a[UNKNOWNS][STANCE_ROWS_STRIDE], plus[UNKNOWNS], minus[UNKNOWNS];
    multipliers(s, u, t, mu);
    for (int j = 0; j < f; j++) {
        pulled(s, u, Z[j], difference, mu, free, plus);
        pulled(s, u, Z[j], -difference, mu, free, minus);
        for (int i = 0; i < f; i++)
            a[i][j] = (plus[i] - minus[i]) / (2 * difference);
    }
    for (int i = 0; i < f; i++) {
        a[i][f] = 0;
        for (int k = 0; k < m; k++) {
            a[i][f] -= Z[i][first + k] * (s->weigh[k] * u[first + k]);
            for (int j = 0; j < f; j++)
                a[i][j] += Z[i][first + k] * (s->weigh[k] * Z[j][first + k]);
        }
    }
    double down[UNKNOWNS];
    for (int i = 0; i < f; i++)
        down[i] = a[i][f];
    stance_rows_turn(f, f, f + 1, a);
    memset(step, 0, (size_t)t->unknowns * sizeof *step);
    for (int row = 0; row < f; row++) {
        /* A symmetric matrix's rows, turned, are its eigenvectors: where one is curved downwards
         * Newton goes up, towards a maximum, and its opposite is taken. */
        const double square = matrix_dot(f, a[row], a[row]), part = matrix_dot(f, a[row], down);
        if (square == 0)
            continue;
        const double along = a[row][f] / square * (a[row][f] * part < 0 ? -1 : 1);
        for (int i = 0; i < f; i++)
            for (int k = 0; k < t->unknowns; k++)
                step[k] += Z[i][k] * (along * a[row][i]);
    }
}

/* From a solution to the one of least effort that can be reached. */
static void least_effort(const struct search *s, double *u, struct trial *t)
{
    double a[CONDITIONS][STANCE_ROWS_STRIDE], step[UNKNOWNS], next[UNKNOWNS] = {0};
    struct freedoms free;
    struct trial further;
    for (int i = 0; i < STEPS; i++) {
        turn(t, a);
        free.count = stance_rows_null(t->conditions, t->unknowns, a, free.Z);
        const double now = effort(s, u);
        if (free.count == 0 || now == 0)
            return;
        ease(s, u, t, &free, step);
        double part = part_of(s, step), length = 0;
        for (int k = 0; k < t->unknowns; k++)
            length = fmax(length, fabs(step[k]));
        bool better = false;
        for (int half = 0; half < HALVINGS && !better; half++, part /= 2) {
            for (int k = 0; k < t->unknowns; k++)
                next[k] = u[k] + part * step[k];
            better = satisfy(s, next, &further) &&
                     effort(s, next) <= now * (length < 1e-4 ? 1 + 1e-13 : 1 - 1e-13);
        }
        if (!better)
            return;
        memcpy(u, next, sizeof next);
        *t = further;
        if (length < 1e-12)
            return;
    }
}

/* Takes from the supports' forces what only strains them: null(H'). */
static void relax(const struct search *s, const struct trial *t, double *u)
{
    double a[N][STANCE_ROWS_STRIDE], x[STANCE_MAX_STICKING];
    double *const lambda = &u[s->free + s->m->actuators];
    for (int i = 0; i < s->coordinates; i++) {
        a[i][s->rows] = 0;
        for (int k = 0; k < s->rows; k++) {
            a[i][k] = t->sticking.touch[k].row[t->sticking.direction[k]][i];
            a[i][s->rows] += a[i][k] * lambda[k];
        }
    }
    stance_rows_turn(s->coordinates, s->rows, s->rows + 1, a);
    stance_rows_solve(s->coordinates, s->rows, a, x);
    memcpy(lambda, x, (size_t)s->rows * sizeof *x);
}

/* ---- one equilibrium ------------------------------------------------------------------------- */

/* How many coordinates are left when the forces' own freedoms are taken away. */
static int undetermined(const struct search *s, const struct trial *t)
{
    double a[CONDITIONS][STANCE_ROWS_STRIDE], b[N][STANCE_ROWS_STRIDE];
    const int forces = t->unknowns - s->free;
    for (int i = 0; i < s->coordinates; i++)
        memcpy(b[i], &t->J[i][s->free], (size_t)forces * sizeof(double));
    return s->free - turn(t, a) + stance_rows_turn(s->coordinates, forces, forces, b);
}

/* Of the centre of mass, in units of size. */
static double height(const struct search *s, const stance_pose *pose)
{
    double moment = 0, mass = 0, centre[2];
    for (int b = 0; b < s->m->bodies; b++) {
        stance_pose_point(pose, b, pose->number.body[b].centre, centre);
        moment += pose->number.body[b].mass * centre[1];
        mass += pose->number.body[b].mass;
    }
    return moment / (mass * s->size);
}

/* How near all bodies are to where they are when all angles are 0. */
static double straightness(const struct search *s, const stance_pose *pose)
{
    double sum = 0, sine, cosine;
    for (int b = 0; b < s->m->bodies; b++) {
        stance_sincos(pose->angle[b] - pose->straight[b], &sine, &cosine);
        sum += pose->turns[b] ? cosine : 0;
    }
    return sum;
}

/* What the solution u says, at the origin where the root is free. */
static void write_down(const struct search *s, const double *u, const struct trial *t,
                       stance_equilibrium *e)
{
    double velocity[N] = {0}, lambda[STANCE_MAX_STICKING], normal[STANCE_MAX_CONTACTS] = {0};
    stance_pose pose;
    *e = (stance_equilibrium){.supports = s->choice->supports};
    posture_of(s, u, e->position);
    forces_of(s, u, e->torque, lambda);
    for (int i = 0; i < s->coordinates; i++) {
        while (s->wraps[i] && isnan(s->given[i]) && e->position[i] > M_PI)
            e->position[i] -= 2 * M_PI;
        while (s->wraps[i] && isnan(s->given[i]) && e->position[i] <= -M_PI)
            e->position[i] += 2 * M_PI;
    }
    s->scene->stand(s->scene, s->robot, e->supports, e->position, velocity);
    for (int k = 0; k < s->rows; k++) {
        const int c = t->sticking.contact[k], grip = s->scene->grip[c];
        e->force[c][t->sticking.direction[k]] = lambda[k];
        if (t->sticking.direction[k] == 0 && grip >= 0)
            normal[grip] += lambda[k];
    }
    for (int k = 0; k < s->rows; k++) {
        if (t->sticking.direction[k] == 1) {
            const int grip = s->scene->grip[t->sticking.contact[k]];
            e->friction =
                fmax(e->friction, fabs(lambda[k]) / (normal[grip] * t->sticking.touch[k].rough));
        }
    }
    e->undetermined = undetermined(s, t);
    stance_pose_at(s->m, s->robot, e->position, &pose);
    stance_pose_freedoms(s->scene, &pose, e);
}

/* Can it be: within limits, pushed by the ground and not pulled, by torques that there are. */
static stance_error check(const struct search *s, const stance_equilibrium *e,
                          stance_message *message)
{
    stance_pose pose;
    stance_pose_at(s->m, s->robot, e->position, &pose);
    for (int c = 0; c < s->scene->contacts; c++) {
        if ((e->supports >> c & 1) && !(e->force[c][0] > 0)) {
            return stance_refuse(message, STANCE_NO_EQUILIBRIUM,
                                 "no equilibrium: %s would have to pull, with %.6g N",
                                 s->scene->contact_name[c], -e->force[c][0]);
        }
    }
    for (int b = 0; b < s->m->bodies; b++) {
        const double *const limits = pose.number.body[b].limits;
        if (!stance_mechanism_stops(s->m, b, 0) && !stance_mechanism_stops(s->m, b, 1))
            continue;
        const double q = e->position[pose.own[b]];
        if (!(q >= limits[0] - at_limit && q <= limits[1] + at_limit)) {
            return stance_refuse(
                message, STANCE_NO_EQUILIBRIUM,
                "no equilibrium: %s would be at %.6g %s, beyond its limits %.6g ... %.6g",
                s->m->body[b].name, q, pose.turns[b] ? "rad" : "m", limits[0], limits[1]);
        }
    }
    for (int k = 0; k < s->m->actuators; k++) {
        if (!(fabs(e->torque[k]) <= pose.number.limit[k] * (1 + 1e-12))) {
            return stance_refuse(message, STANCE_NO_EQUILIBRIUM,
                                 "no equilibrium: it takes %.6g %s from %s, whose limit is %.6g",
                                 e->torque[k], pose.turns[s->m->actuator[k].body] ? "N m" : "N",
                                 s->m->actuator[k].name, pose.number.limit[k]);
        }
    }
    return STANCE_OK;
}

/* ---- all equilibria -------------------------------------------------------------------------- */

static stance_error begin(const stance_scene *scene, const double *robot,
                          const stance_equilibrium_choice *choice, struct search *s,
                          stance_message *message)
{
    static const double straight[N];
    const stance_mechanism *const m = scene->mechanism;
    struct trial t;
    *s = (struct search){.scene = scene, .m = m, .robot = robot, .choice = choice};
    if (scene->contacts < 32 && choice->supports >> scene->contacts) {
        return stance_refuse(message, STANCE_BAD_ARGUMENT,
                             "an equilibrium stands on some of %d contacts", scene->contacts);
    }
    stance_pose_at(m, robot, straight, &t.pose);
    stance_pose_sticking(scene, &t.pose, choice->supports, &t.sticking);
    if (m->body[0].joint == STANCE_FREE && choice->supports == 0 && t.pose.gravity != 0) {
        return stance_refuse(message, STANCE_NO_EQUILIBRIUM,
                             "no equilibrium: nothing carries the weight where no contact does");
    }
    s->rows = t.sticking.rows;
    s->coordinates = scene->coordinates;
    double mass = 0;
    for (int b = 0; b < m->bodies; b++) {
        const stance_body_numbers *const n = &t.pose.number.body[b];
        mass += n->mass;
        s->size +=
            fabs(n->centre[0]) + fabs(n->centre[1]) + (b > 0 ? fabs(n->at[0]) + fabs(n->at[1]) : 0);
        if (t.pose.own[b] >= 0) {
            s->turns[t.pose.own[b]] = t.pose.turns[b];
            s->wraps[t.pose.own[b]] =
                t.pose.turns[b] && (m->body[b].joint == STANCE_FREE || n->stiffness == 0);
        }
    }
    s->size = s->size > 0 ? s->size : 1;
    s->weight = mass * (t.pose.gravity > 0 ? t.pose.gravity : 1);
    for (int i = 0; i < N; i++)
        s->given[i] = NAN;
    if (m->body[0].joint == STANCE_FREE)
        s->given[0] = 0; /* along the ground anything goes; it is put at the origin in the end */
    for (int k = 0; k < scene->postures; k++) {
        const double value = choice->posture[k];
        if (!isnan(value) && !(fabs(value) <= 1e3)) {
            return stance_refuse(message, STANCE_BAD_ARGUMENT,
                                 "an equilibrium's %s must lie within +-1000",
                                 scene->coordinate[scene->posture[k]].name);
        }
        s->given[scene->posture[k]] = value;
    }
    for (int i = 0; i < s->coordinates; i++)
        if (isnan(s->given[i]))
            s->coordinate[s->free++] = i;
    double largest = 0; /* an unlimited one weighs as the strongest of the others */
    for (int k = 0; k < m->actuators; k++)
        if (isfinite(t.pose.number.limit[k]))
            largest = fmax(largest, t.pose.number.limit[k] / unit(s, s->free + k));
    for (int k = 0; k < m->actuators; k++) {
        const double limit = t.pose.number.limit[k] / unit(s, s->free + k);
        const double scale = largest > 0 ? largest : 1;
        s->weigh[k] = isfinite(limit) ? (scale / limit) * (scale / limit) : 1;
    }
    return STANCE_OK;
}

/* Angles to begin with: all in line, then spread evenly (the golden ratio's relatives in several
 * dimensions). */
static void seed(const struct search *s, int i, double *u)
{
    double root = 2, step = 1; /* of root^(free + 1) = root + 1 */
    memset(u, 0, sizeof(double[UNKNOWNS]));
    for (int k = 0; k < 40; k++) { /* Newton from above */
        double power = 1;
        for (int j = 0; j < s->free; j++)
            power *= root;
        root -= (power * root - root - 1) / ((s->free + 1) * power - 1);
    }
    for (int k = 0; k < s->free; k++) {
        step /= root;
        const double part = i * step - floor(i * step);
        if (s->turns[s->coordinate[k]])
            u[k] = 2 * M_PI * (part < 0.5 ? part : part - 1);
    }
}

static bool same_posture(const struct search *s, const double *a, const double *b)
{
    for (int i = 0; i < s->coordinates; i++) {
        double apart = fabs(a[i] - b[i]);
        if (s->wraps[i])
            apart = fmin(apart, fabs(2 * M_PI - apart));
        if (apart > one_branch * (s->turns[i] ? 1 : s->size))
            return false;
    }
    return true;
}

struct branch {
    stance_equilibrium e;
    double effort, place;
    bool possible;
};

/* Those that can be first; where torques chose, the least; the straightest, of them the highest. */
static bool before(const struct branch *a, const struct branch *b)
{
    if (a->possible != b->possible)
        return a->possible;
    if ((a->e.undetermined > 0 || b->e.undetermined > 0) &&
        fabs(a->effort - b->effort) > 1e-9 * (1e-3 + a->effort + b->effort))
        return a->effort < b->effort;
    return a->place > b->place;
}

/* What is left in the best trial, in words. */
static stance_error none(const struct search *s, const struct trial *t, bool contradict,
                         stance_message *message)
{
    int worst = 0;
    char what[160];
    for (int i = 0; i < s->coordinates; i++)
        if (s->turns[i] && fabs(s->given[i]) > 2 * M_PI) /* false of NAN */
            return stance_refuse(message, STANCE_NO_EQUILIBRIUM,
                                 "no equilibrium at %s = %.6g rad, more than a turn: angles are in "
                                 "radians (are these degrees?)",
                                 s->scene->coordinate[i].name, s->given[i]);
    for (int i = 1; i < t->conditions; i++)
        if (fabs(t->c[i]) > fabs(t->c[worst]))
            worst = i;
    if (worst >= s->coordinates) {
        int c = 0;
        for (int k = 0, row = s->coordinates; k < s->rows; k++)
            if (t->sticking.direction[k] == 0 && row++ == worst)
                c = t->sticking.contact[k];
        snprintf(what, sizeof what, "%s cannot touch", s->scene->contact_name[c]);
    } else if (s->scene->mechanism->body[0].joint == STANCE_FREE && worst < 2) {
        snprintf(what, sizeof what, "the weight cannot be carried");
    } else {
        const bool turns = s->turns[worst];
        snprintf(what, sizeof what, "%s cannot be balanced: %.3g %s are left on it",
                 s->scene->coordinate[worst].name, t->c[worst] * s->weight * (turns ? s->size : 1),
                 turns ? "N m" : "N");
    }
    return stance_refuse(message, STANCE_NO_EQUILIBRIUM,
                         contradict ? "the conditions on the equilibrium contradict each other: %s"
                                    : "there is no such posture: %s",
                         what);
}

/* Do the conditions ask for more than the unknowns can give, anywhere? */
static bool too_many(const struct search *s)
{
    double a[CONDITIONS][STANCE_ROWS_STRIDE], u[UNKNOWNS];
    struct trial t;
    seed(s, 7, u);
    for (int k = s->free; k < UNKNOWNS; k++)
        u[k] = 0.1 * (k + 1);
    try_at(s, u, &t);
    return turn(&t, a) < t.conditions;
}

stance_error stance_mechanism_equilibria(const stance_scene *scene, const double *robot,
                                         const stance_equilibrium_choice *choice,
                                         stance_equilibrium *list, int *count,
                                         stance_message *message)
{
    struct branch branch[STANCE_MAX_BRANCHES];
    struct search s;
    struct trial t, best = {.conditions = 0};
    double u[UNKNOWNS] = {0}, least = INFINITY;
    int angles = 0, found = 0;
    *count = 0;
    if (message)
        message->text[0] = '\0';
    const stance_error error = begin(scene, robot, choice, &s, message);
    if (error != STANCE_OK)
        return error;
    for (int k = 0; k < s.free; k++)
        angles += s.turns[s.coordinate[k]];
    const int seeds = angles < 3 ? 2 << 2 * angles : 64;
    for (int i = 0; i < seeds && found < STANCE_MAX_BRANCHES; i++) {
        struct branch *const here = &branch[found];
        seed(&s, i, u);
        if (!satisfy(&s, u, &t)) {
            if (hurt(&t) < least) {
                least = hurt(&t);
                best = t;
            }
            continue;
        }
        least_effort(&s, u, &t);
        relax(&s, &t, u);
        write_down(&s, u, &t, &here->e);
        bool known = false;
        for (int k = 0; k < found && !known; k++)
            known = same_posture(&s, here->e.position, branch[k].e.position);
        if (known)
            continue;
        here->effort = effort(&s, u);
        here->place = straightness(&s, &t.pose) + 1e-6 * height(&s, &t.pose);
        here->possible = check(&s, &here->e, NULL) == STANCE_OK;
        for (int k = found++; k > 0 && before(&branch[k], &branch[k - 1]); k--) {
            const struct branch swap = branch[k];
            branch[k] = branch[k - 1];
            branch[k - 1] = swap;
        }
    }
    if (found == 0)
        return none(&s, &best, too_many(&s), message);
    while (*count < found && branch[*count].possible) {
        list[*count] = branch[*count].e;
        ++*count;
    }
    return *count == 0 ? check(&s, &branch[0].e, message) : STANCE_OK;
}

stance_error stance_mechanism_equilibrium(const stance_scene *scene, const double *robot,
                                          const stance_equilibrium_choice *choice,
                                          stance_equilibrium *result, stance_message *message)
{
    stance_equilibrium list[STANCE_MAX_BRANCHES];
    int count;
    const stance_error error =
        stance_mechanism_equilibria(scene, robot, choice, list, &count, message);
    if (error != STANCE_OK)
        return error;
    if (choice->branch < 0 || choice->branch >= count) {
        return stance_refuse(message, STANCE_NO_EQUILIBRIUM,
                             "there is no branch %d of the equilibrium: %d found, counted from 0",
                             choice->branch, count);
    }
    *result = list[choice->branch];
    if (result->undetermined > 0 && message) {
        snprintf(message->text, sizeof message->text,
                 "the equilibrium is free by %d coordinate%s: the least torques are taken",
                 result->undetermined, result->undetermined > 1 ? "s" : "");
    }
    return STANCE_OK;
}
