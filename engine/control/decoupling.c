/* decoupling.c - where torques can drive a selection of coordinates, and where they cannot.
 *
 * With A the inertia matrix and B the columns of the actuated joints, G = S A^-1 B takes torques to
 * the accelerations of the selection: the inverse of the paper's A_rs, see core/mode/decoupling.h.
 * G depends on the posture alone; where its determinant changes sign it is singular on the surface
 * between.
 */
#include "control.h"

#include <lapacke.h>
#include <string.h>

enum { N = STANCE_MAX_COORDINATES, M = STANCE_MAX_ACTUATORS };

/* Accelerations of all coordinates by a unit of each torque: X[coordinates][actuators]. */
static bool respond(const stance_scene *scene, const double *robot, const double *position,
                    double *X)
{
    const int n = scene->coordinates, m = scene->actuators;
    double A[N * N];
    scene->inertia(scene, robot, position, A);
    memset(X, 0, sizeof(double[N * M]));
    for (int i = 0; i < m; i++)
        X[scene->actuated[i] * m + i] = 1;
    return LAPACKE_dposv(LAPACK_ROW_MAJOR, 'L', n, m, A, n, X, m) == 0;
}

/* Of G, the rows of X that are selected; INFINITY where it is singular. *positive: is its
 * determinant? False: no convergence. */
static bool condition_of(int m, const double *X, const int *selected, double *condition,
                         bool *positive)
{
    double G[M * M] = {0}, LU[M * M], value[M], spare[M];
    lapack_int pivot[M];
    for (int i = 0; i < m; i++)
        memcpy(&G[i * m], &X[selected[i] * m], (size_t)m * sizeof *G);
    memcpy(LU, G, sizeof LU);
    const bool regular = LAPACKE_dgetrf(LAPACK_ROW_MAJOR, m, m, LU, m, pivot) == 0;
    *positive = regular;
    for (int i = 0; i < m; i++)
        *positive ^= regular && ((LU[i * m + i] < 0) ^ (pivot[i] != i + 1));
    if (LAPACKE_dgesvd(LAPACK_ROW_MAJOR, 'N', 'N', m, m, G, m, value, NULL, 1, NULL, 1, spare) != 0)
        return false;
    *condition = regular && value[m - 1] > 0 ? value[0] / value[m - 1] : INFINITY;
    return true;
}

stance_error stance_selection_condition(const stance_scene *scene, const double *robot,
                                        const double *position, int selection, double *condition)
{
    double X[N * M];
    int selected[M];
    bool positive;
    if (!scene->inertia || !stance_selection(scene, selection, selected))
        return STANCE_BAD_ARGUMENT;
    if (!respond(scene, robot, position, X) ||
        !condition_of(scene->actuators, X, selected, condition, &positive))
        return STANCE_NUMERICAL;
    return STANCE_OK;
}

stance_error stance_selection_survey(const stance_scene *scene, const double *robot,
                                     long evaluations, int selections,
                                     stance_selection_report *report)
{
    double X[N * M], position[N] = {0};
    long above[STANCE_MAX_SELECTIONS] = {0}, positive[STANCE_MAX_SELECTIONS] = {0};
    if (!scene->inertia || selections < 1 || selections > STANCE_MAX_SELECTIONS)
        return STANCE_BAD_ARGUMENT;
    const double most = fmax(1, (double)evaluations / selections);
    const int resolution = (int)fmax(1, floor(pow(most, 1.0 / scene->postures) * (1 + 1e-12)));
    const long postures = lround(pow(resolution, scene->postures));
    for (int p = 0; p < selections; p++)
        report[p].best = INFINITY;
    for (long k = 0; k < postures; k++) {
        /* The posture with this number in -pi ... pi. Each angle has its own offset, or a good part
         * of them would have parallel legs. */
        long left = k;
        for (int i = 0; i < scene->postures; i++, left /= resolution) {
            const double at = ((double)(left % resolution) + 0.2 + 0.23 * i) / resolution;
            position[scene->posture[i]] = M_PI * (2 * at - 1);
        }
        if (!respond(scene, robot, position, X))
            return STANCE_NUMERICAL;
        for (int p = 0; p < selections; p++) {
            int selected[M];
            double condition;
            bool turns;
            if (!stance_selection(scene, p, selected))
                return STANCE_BAD_ARGUMENT;
            if (!condition_of(scene->actuators, X, selected, &condition, &turns))
                return STANCE_NUMERICAL;
            report[p].best = fmin(condition, report[p].best);
            above[p] += !(condition <= STANCE_ILL_CONDITIONED);
            positive[p] += turns;
        }
    }
    for (int p = 0; p < selections; p++) {
        report[p].ill_conditioned = (double)above[p] / (double)postures;
        report[p].singular = positive[p] > 0 && positive[p] < postures;
    }
    return STANCE_OK;
}
