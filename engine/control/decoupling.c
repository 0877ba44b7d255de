/* decoupling.c - where two torques can drive a pair of coordinates, and where they cannot.
 *
 * With A the inertia matrix and B the columns of the actuated joints, G = S A^-1 B takes torques to
 * the accelerations of the pair: the inverse of the paper's A_rs, see core/mode/decoupling.h. G
 * depends on the posture alone; where its determinant changes sign it is singular on the surface
 * between.
 */
#include "control.h"

#include <lapacke.h>
#include <string.h>

/* Accelerations of all coordinates by a unit of each torque: X[coordinates][2]. */
static bool respond(const stance_scene *scene, const double *robot, const double *position,
                    double X[STANCE_MAX_COORDINATES][2])
{
    const int n = scene->coordinates;
    double A[STANCE_MAX_COORDINATES * STANCE_MAX_COORDINATES];
    scene->inertia(scene, robot, position, A);
    memset(X, 0, sizeof(double[STANCE_MAX_COORDINATES][2]));
    for (int i = 0; i < 2; i++)
        X[scene->posture[scene->postures - 2 + i]][i] = 1;
    return LAPACKE_dposv(LAPACK_ROW_MAJOR, 'L', n, 2, A, n, &X[0][0], 2) == 0;
}

/* Of G; INFINITY where it is singular. */
static double condition_of(const double *first, const double *second, double *determinant)
{
    const double sum =
        first[0] * first[0] + first[1] * first[1] + second[0] * second[0] + second[1] * second[1];
    *determinant = first[0] * second[1] - first[1] * second[0];
    const double twice = 2 * fabs(*determinant);
    const double root = sqrt(fmax(0, (sum - twice) * (sum + twice)));
    return twice > 0 ? (sum + root) / twice : INFINITY;
}

stance_error stance_pair_condition(const stance_scene *scene, const double *robot,
                                   const double *position, int pair, double *condition)
{
    double X[STANCE_MAX_COORDINATES][2], determinant;
    int first, second;
    if (!scene->inertia || !stance_pair(scene, pair, &first, &second))
        return STANCE_BAD_ARGUMENT;
    if (!respond(scene, robot, position, X))
        return STANCE_NUMERICAL;
    *condition = condition_of(X[first], X[second], &determinant);
    return STANCE_OK;
}

/* The posture with running number k of resolution^postures in -pi ... pi. Each angle has its own
 * offset, or a good part of them would have parallel legs. */
static void place(const stance_scene *scene, int resolution, long k, double *position)
{
    for (int i = 0; i < scene->postures; i++) {
        const double at = ((double)(k % resolution) + 0.2 + 0.23 * i) / resolution;
        position[scene->posture[i]] = M_PI * (2 * at - 1);
        k /= resolution;
    }
}

stance_error stance_pair_survey(const stance_scene *scene, const double *robot, int resolution,
                                int pairs, stance_pair_report *report)
{
    double X[STANCE_MAX_COORDINATES][2], position[STANCE_MAX_COORDINATES] = {0};
    long postures = 1, above[STANCE_MAX_PAIRS] = {0}, positive[STANCE_MAX_PAIRS] = {0};
    if (!scene->inertia || resolution < 1 || pairs > STANCE_MAX_PAIRS)
        return STANCE_BAD_ARGUMENT;
    for (int i = 0; i < scene->postures; i++)
        postures *= resolution;
    for (int p = 0; p < pairs; p++)
        report[p].best = INFINITY;
    for (long k = 0; k < postures; k++) {
        place(scene, resolution, k, position);
        if (!respond(scene, robot, position, X))
            return STANCE_NUMERICAL;
        for (int p = 0; p < pairs; p++) {
            int first, second;
            double determinant;
            if (!stance_pair(scene, p, &first, &second))
                return STANCE_BAD_ARGUMENT;
            const double condition = condition_of(X[first], X[second], &determinant);
            report[p].best = fmin(condition, report[p].best);
            above[p] += !(condition <= STANCE_ILL_CONDITIONED);
            positive[p] += determinant > 0;
        }
    }
    for (int p = 0; p < pairs; p++) {
        report[p].ill_conditioned = (double)above[p] / (double)postures;
        report[p].singular = positive[p] > 0 && positive[p] < postures;
    }
    return STANCE_OK;
}
