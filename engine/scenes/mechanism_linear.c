/* mechanism_linear.c - a mechanism about an equilibrium with its supports sticking, to first order.
 *
 * H the rows that stick, y = sel q coordinates that describe every motion with H q' = 0, and Z with
 * H Z = 0, sel Z = 1: q' = Z y'. With Q(q, q', torque) all forces but those of the supports,
 *
 *   Z'A Z y'' = Z' [ dQ/dq + d(H' lambda)/dq ] Z y + Z' dQ/dq' Z y' + Z' B dtorque,
 *
 * the second term because Z'(q + dq) Q = -dZ' H' lambda = Z' dH' lambda; terms with velocities
 * squared are of second order. The supports carry what is left:
 *
 *   H' dlambda = A Z y'' - [ dQ/dq + d(H' lambda)/dq ] Z y - dQ/dq' Z y' - B dtorque.
 */
#include "engine/matrix.h"
#include "engine/rows.h"
#include "engine/scenes/mechanism_pose.h"

enum { N = STANCE_MAX_COORDINATES, P = STANCE_MAX_POSTURE, M = STANCE_MAX_ACTUATORS };

/* Z[coordinates][p] for the coordinates y[p]; false: they do not describe every motion, or do not
 * fit the supports. */
static bool motions(const stance_pose *pose, const stance_sticking *sticking, int p, const int *y,
                    double Z[][P])
{
    const int n = pose->coordinates, rows = sticking->rows + p;
    double a[STANCE_MAX_STICKING + P][STANCE_ROWS_STRIDE];
    memset(a, 0, sizeof a);
    for (int k = 0; k < sticking->rows; k++)
        memcpy(a[k], sticking->touch[k].row[sticking->direction[k]], (size_t)n * sizeof(double));
    for (int j = 0; j < p; j++)
        a[sticking->rows + j][y[j]] = a[sticking->rows + j][n + j] = 1;
    if (stance_rows_turn(rows, n, n + p, a) < n)
        return false;
    for (int j = 0; j < p; j++) {
        double x[N];
        for (int k = 0; k < rows; k++) /* column j of the right-hand side to the first place */
            a[k][n] = a[k][n + j];
        stance_rows_solve(rows, n, a, x);
        for (int i = 0; i < n; i++)
            Z[i][j] = x[i];
    }
    return true;
}

/* How badly the postures' motions follow from y: the condition number of Z's rows of them. */
static double condition(const stance_scene *scene, int p, const double Z[][P])
{
    double a[P][STANCE_ROWS_STRIDE] = {{0}}, longest = 0, shortest = INFINITY;
    for (int j = 0; j < p; j++)
        for (int k = 0; k < scene->postures; k++)
            a[j][k] = Z[scene->posture[k]][j];
    stance_rows_turn(p, scene->postures, scene->postures, a);
    for (int j = 0; j < p; j++) {
        const double square = matrix_dot(scene->postures, a[j], a[j]);
        longest = fmax(longest, sqrt(square));
        shortest = fmin(shortest, sqrt(square));
    }
    return p == 0 ? 1 : longest / shortest;
}

void stance_pose_freedoms(const stance_scene *scene, const stance_pose *pose, stance_equilibrium *e)
{
    const int n = pose->coordinates, postures = scene->postures;
    double a[STANCE_MAX_STICKING][STANCE_ROWS_STRIDE], Z[N][P];
    stance_sticking sticking;
    stance_pose_sticking(scene, pose, e->supports, &sticking);
    for (int k = 0; k < sticking.rows; k++)
        memcpy(a[k], sticking.touch[k].row[sticking.direction[k]], (size_t)n * sizeof(double));
    const int p = n - stance_rows_turn(sticking.rows, n, n, a);
    e->freedoms = p;
    e->condition = INFINITY;
    /* All choices of p postures; the first of the best. */
    for (unsigned set = 0; set < 1u << postures; set++) {
        int y[P], count = 0;
        for (int k = 0; k < postures; k++)
            if (set >> k & 1)
                y[count++] = scene->posture[k];
        if (count != p || !motions(pose, &sticking, p, y, Z))
            continue;
        const double here = condition(scene, p, Z);
        if (here < 0.999999 * e->condition) {
            e->condition = here;
            memcpy(e->freedom, y, sizeof y);
        }
    }
}

/* A mechanism about an equilibrium: what the equations above call Z, A Z, (dQ/dq + ...) Z, dQ/dq'
 * Z, B, and the inertia Z'A Z, symmetric and positive definite. */
struct linear {
    stance_pose pose;
    stance_sticking sticking;
    int n, p, m;
    double Z[N][P], AZ[N][P], stiff[N][P], damped[N][P], B[N][M], inertia[P][P];
};

static bool linear_about(const stance_scene *scene, const double *robot,
                         const stance_equilibrium *e, struct linear *l)
{
    const stance_mechanism *const m = scene->mechanism;
    double A[N * N], Q[N], dQ[N][N], force[STANCE_MAX_STICKING];
    memset(l, 0, sizeof *l);
    stance_pose_at(m, robot, e->position, &l->pose);
    stance_pose_sticking(scene, &l->pose, e->supports, &l->sticking);
    l->n = l->pose.coordinates, l->p = e->freedoms, l->m = m->actuators;
    if (l->p < 0 || l->p > P || !motions(&l->pose, &l->sticking, l->p, e->freedom, l->Z))
        return false;
    for (int k = 0; k < l->sticking.rows; k++)
        force[k] = e->force[l->sticking.contact[k]][l->sticking.direction[k]];
    stance_pose_forces(&l->pose, e->torque, &l->sticking, force, Q, dQ);
    stance_pose_inertia(&l->pose, A);
    for (int i = 0; i < l->n; i++) {
        for (int j = 0; j < l->p; j++) {
            for (int k = 0; k < l->n; k++) {
                l->AZ[i][j] += A[i * l->n + k] * l->Z[k][j];
                l->stiff[i][j] += dQ[i][k] * l->Z[k][j];
            }
        }
    }
    for (int b = 0; b < m->bodies; b++) {
        const int i = l->pose.own[b];
        for (int j = 0; i >= 0 && m->body[b].joint != STANCE_FREE && j < l->p; j++)
            l->damped[i][j] = -l->pose.number.body[b].damping * l->Z[i][j];
    }
    for (int a = 0; a < l->m; a++)
        l->B[l->pose.own[m->actuator[a].body]][a] = 1;
    for (int i = 0; i < l->p; i++)
        for (int j = 0; j < l->p; j++)
            for (int k = 0; k < l->n; k++)
                l->inertia[i][j] += l->Z[k][i] * l->AZ[k][j];
    return true;
}

/* y'' under forces Q[n] on the coordinates. */
static void accelerate(const struct linear *l, const double *Q, double *y)
{
    double a[P][P + 1] = {{0}};
    for (int i = 0; i < l->p; i++) {
        memcpy(a[i], l->inertia[i], (size_t)l->p * sizeof(double));
        for (int k = 0; k < l->n; k++)
            a[i][l->p] += l->Z[k][i] * Q[k];
    }
    /* Positive definite: Gauss without pivots. */
    for (int k = 0; k < l->p; k++) {
        for (int i = k + 1; i < l->p; i++) {
            const double factor = a[i][k] / a[k][k];
            for (int j = k; j <= l->p; j++)
                a[i][j] -= factor * a[k][j];
        }
    }
    for (int i = l->p - 1; i >= 0; i--) {
        y[i] = a[i][l->p];
        for (int j = i + 1; j < l->p; j++)
            y[i] -= a[i][j] * y[j];
        y[i] /= a[i][i];
    }
}

/* Column j of (x, torque): the forces that a unit of it adds. */
static void forces_of(const struct linear *l, int j, double *Q)
{
    for (int i = 0; i < l->n; i++) {
        Q[i] = j < l->p       ? l->stiff[i][j]
               : j < 2 * l->p ? l->damped[i][j - l->p]
                              : l->B[i][j - 2 * l->p];
    }
}

stance_error stance_mechanism_linearise(const stance_scene *scene, const double *robot,
                                        const stance_equilibrium *equilibrium, double *A, double *B)
{
    struct linear l;
    if (!linear_about(scene, robot, equilibrium, &l))
        return STANCE_BAD_ARGUMENT;
    const int p = l.p, states = 2 * p;
    memset(A, 0, (size_t)(states * states) * sizeof *A);
    memset(B, 0, (size_t)(states * l.m) * sizeof *B);
    for (int j = 0; j < states + l.m; j++) {
        double Q[N], y[P];
        forces_of(&l, j, Q);
        accelerate(&l, Q, y);
        for (int i = 0; i < p; i++)
            if (j < states)
                A[(p + i) * states + j] = y[i];
            else
                B[(p + i) * l.m + j - states] = y[i];
    }
    for (int j = 0; j < p; j++)
        A[j * states + p + j] = 1;
    return STANCE_OK;
}

/* The supports' forces that add H' lambda = Q[n]. */
static void carried(const struct linear *l, const double *Q, double *lambda)
{
    double a[N][STANCE_ROWS_STRIDE];
    const int rows = l->sticking.rows;
    for (int i = 0; i < l->n; i++) {
        for (int k = 0; k < rows; k++)
            a[i][k] = l->sticking.touch[k].row[l->sticking.direction[k]][i];
        a[i][rows] = Q[i];
    }
    stance_rows_turn(l->n, rows, rows + 1, a);
    stance_rows_solve(l->n, rows, a, lambda);
}

stance_error stance_mechanism_contact_force(const stance_scene *scene, const double *robot,
                                            const stance_equilibrium *equilibrium, double *force,
                                            double *by_state, double *by_torque)
{
    struct linear l;
    int place[STANCE_MAX_CONTACTS], supports = 0;
    if (!linear_about(scene, robot, equilibrium, &l))
        return STANCE_BAD_ARGUMENT;
    for (int c = 0; c < scene->contacts; c++) {
        if (equilibrium->supports >> c & 1) {
            memcpy(&force[2 * supports], equilibrium->force[c], sizeof equilibrium->force[c]);
            place[c] = supports++;
        }
    }
    const int states = 2 * l.p;
    memset(by_state, 0, (size_t)(2 * supports * states) * sizeof *by_state);
    memset(by_torque, 0, (size_t)(2 * supports * l.m) * sizeof *by_torque);
    for (int j = 0; j < states + l.m; j++) {
        double Q[N], y[P], lambda[STANCE_MAX_STICKING];
        forces_of(&l, j, Q);
        accelerate(&l, Q, y);
        for (int i = 0; i < l.n; i++) {
            Q[i] = -Q[i];
            for (int k = 0; k < l.p; k++)
                Q[i] += l.AZ[i][k] * y[k];
        }
        carried(&l, Q, lambda);
        for (int k = 0; k < l.sticking.rows; k++) {
            const int row = 2 * place[l.sticking.contact[k]] + l.sticking.direction[k];
            if (j < states)
                by_state[row * states + j] = lambda[k];
            else
                by_torque[row * l.m + j - states] = lambda[k];
        }
    }
    return STANCE_OK;
}
