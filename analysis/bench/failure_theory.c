/* failure_theory.c - where theory says that a step is too long, a controller too slow, or a slide
 * without accelerations.
 *
 * Stability of the classical Runge-Kutta formula, R(z) = 1 + z + z^2/2 + z^3/6 + z^4/24, on joints
 * held by a servo in free flight (Hairer and Wanner, Solving Ordinary Differential Equations II,
 * IV.2). With S the actuated joints' part of the inverse inertia matrix, q'' = -S (kp q + kd q').
 * Each eigenvalue s of S gives two of lambda^2 + kd s lambda + kp s = 0.
 *
 * Painleve: a contact with normal and tangential rows n, t of its Jacobian, that slides with sign s
 * under full friction, feels the normal acceleration D lambda_N + free, D = n A^-1 (n - mu s t)'.
 * Where D < 0 no single force fits.
 */
#include "failure.h"
#include "studies.h"

#include "engine/control/design.h"
#include "runner/base/message.h"

#include <complex.h>
#include <lapacke.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static bool varies(const struct scenario_axis *axis, const char *path)
{
    for (int k = 0; k < axis->paths; k++)
        if (strcmp(axis->path[k], path) == 0)
            return true;
    return false;
}

/* Axis 1 or 2 that varies a field; 0: neither. */
static int axis_of(const struct scenario *s, const char *path)
{
    return varies(&s->axis[1], path) ? 1 : varies(&s->axis[2], path) ? 2 : 0;
}

/* ---- the servo's joints in free flight ----------------------------------------------------- */

/* inverse[n][n] of the inertia matrix; false: there is none. */
static bool invert_inertia(const stance_scene *scene, const stance_case *c, double *inverse)
{
    const int n = scene->coordinates;
    scene->inertia(scene, c->robot, c->position, inverse);
    if (LAPACKE_dpotrf(LAPACK_ROW_MAJOR, 'L', n, inverse, n) != 0 ||
        LAPACKE_dpotri(LAPACK_ROW_MAJOR, 'L', n, inverse, n) != 0)
        return false;
    for (int i = 0; i < n; i++)
        for (int j = i + 1; j < n; j++)
            inverse[i * n + j] = inverse[j * n + i];
    return true;
}

/* Eigenvalues of S, smallest first. */
static bool servo_eigenvalues(const stance_scene *scene, const stance_case *c, double *eigenvalue)
{
    const int n = scene->coordinates, m = scene->actuators;
    double inverse[STANCE_MAX_COORDINATES * STANCE_MAX_COORDINATES];
    double S[STANCE_MAX_ACTUATORS * STANCE_MAX_ACTUATORS];
    if (m == 0 || !invert_inertia(scene, c, inverse))
        return false;
    for (int i = 0; i < m; i++)
        for (int j = 0; j < m; j++)
            S[i * m + j] = inverse[scene->actuated[i] * n + scene->actuated[j]];
    return LAPACKE_dsyev(LAPACK_ROW_MAJOR, 'N', 'L', m, S, m, eigenvalue) == 0;
}

/* Largest |R(h lambda)| over the n eigenvalues of S. */
static double runge_kutta_growth(int n, const double *eigenvalue, double kp, double kd, double h)
{
    double largest = 0;
    for (int k = 0; k < 2 * n; k++) {
        const double s = eigenvalue[k / 2], sign = k % 2 ? 1 : -1;
        const double complex root = csqrt(kd * s * kd * s - 4 * kp * s);
        const double complex z = 0.5 * h * (-kd * s + sign * root);
        largest = fmax(cabs(1 + z * (1 + z / 2 * (1 + z / 3 * (1 + z / 4)))), largest);
    }
    return largest;
}

/* Smallest step at which the growth passes 1: the limit lies near 2.8 / |lambda|, and below a
 * quarter of that every formula of this kind is stable. */
static double runge_kutta_limit(int n, const double *eigenvalue, double kp, double kd)
{
    const double s = eigenvalue[n - 1];
    const double fastest = kd * s > 2 * sqrt(kp * s)
                               ? 0.5 * (kd * s + sqrt(kd * s * kd * s - 4 * kp * s))
                               : sqrt(kp * s);
    double low = 0.7 / fastest, high = low;
    while (runge_kutta_growth(n, eigenvalue, kp, kd, high) <= 1 + 1e-12 && high * fastest < 10) {
        low = high;
        high *= 1.01;
    }
    for (int i = 0; i < 60; i++) {
        const double middle = 0.5 * (low + high);
        if (runge_kutta_growth(n, eigenvalue, kp, kd, middle) <= 1 + 1e-12)
            low = middle;
        else
            high = middle;
    }
    return low;
}

/* NAN: it does not fly. */
static double servo_limit(const struct scenario *s, const stance_case *c)
{
    const stance_scene *scene = s->scene;
    double eigenvalue[STANCE_MAX_ACTUATORS], gap[STANCE_MAX_CONTACTS];
    scene->gaps(scene, c->robot, c->position, gap);
    for (int i = 0; i < scene->contacts; i++)
        if ((c->contacts >> i & 1) && gap[i] <= 0)
            return NAN;
    if (!servo_eigenvalues(scene, c, eigenvalue))
        return NAN;
    int joint = 0; /* the place of the first actuated coordinate in the law's state */
    while (scene->posture[joint] != scene->actuated[0])
        joint++;
    return runge_kutta_limit(scene->actuators, eigenvalue, c->near.gain[0][joint],
                             c->near.gain[0][scene->postures + joint]);
}

/* ---- the sampled controller ----------------------------------------------------------------- */

static double critical_sample_time(const struct scenario *s, const struct scenario_values *values,
                                   const stance_case *c)
{
    enum { N = 2 * STANCE_MAX_POSTURE };
    const stance_scene *scene = s->scene;
    double model[STANCE_MAX_ROBOT], A[N * N], B[N * STANCE_MAX_ACTUATORS];
    double K[STANCE_MAX_ACTUATORS * N], T;
    stance_equilibrium equilibrium;
    stance_message message;
    const int n = 2 * scene->postures;
    if (!resolve_equilibrium(scene, values, model, &equilibrium, &message) ||
        scene->linearise(scene, values->robot, &equilibrium, A, B) != STANCE_OK)
        return NAN;
    for (int i = 0; i < scene->actuators; i++)
        for (int j = 0; j < n; j++)
            K[i * n + j] = c->near.gain[i][j];
    const stance_plant plant = {n, scene->actuators, A, B};
    const stance_sampling loop = {.K = K, .delay = (int)c->delay};
    return stance_critical_sample_time(&plant, &loop, 10, &T) == STANCE_OK ? T : NAN;
}

/* ---- Painleve ------------------------------------------------------------------------------- */

/* Friction from which some contact's slide has D < 0; INFINITY where there is none. */
static double jamming_friction(const struct scenario *s, const stance_case *c)
{
    const stance_scene *scene = s->scene;
    const int n = scene->coordinates;
    double inverse[STANCE_MAX_COORDINATES * STANCE_MAX_COORDINATES];
    double gap[STANCE_MAX_CONTACTS], point[2], speed[2], lowest = INFINITY;
    if (!invert_inertia(scene, c, inverse))
        return INFINITY;
    scene->gaps(scene, c->robot, c->position, gap);
    for (int k = 0; k < scene->contacts; k++) {
        scene->contact_point(scene, c->robot, c->position, c->velocity, k, point, speed);
        if (gap[k] > 1e-12 || speed[0] == 0)
            continue;
        const double sign = speed[0] > 0 ? 1 : -1;
        double row[2][STANCE_MAX_COORDINATES], normal = 0, tangential = 0;
        for (int i = 0; i < n; i++) {
            double unit[STANCE_MAX_COORDINATES] = {0};
            unit[i] = 1;
            scene->contact_point(scene, c->robot, c->position, unit, k, point, speed);
            row[0][i] = speed[1], row[1][i] = speed[0];
        }
        for (int i = 0; i < n; i++)
            for (int j = 0; j < n; j++) {
                normal += row[0][i] * inverse[i * n + j] * row[0][j];
                tangential += row[0][i] * inverse[i * n + j] * row[1][j];
            }
        if (sign * tangential > 0)
            lowest = fmin(normal / (sign * tangential), lowest);
    }
    return lowest;
}

/* ---- which of them -------------------------------------------------------------------------- */

enum theory { NO_THEORY, SERVO, SAMPLED, PAINLEVE };

static enum theory which_theory(const struct scenario *s, int *axis)
{
    const struct scenario_values *base = &s->base;
    if (strcmp(scenario_law(base)->name, "hold") == 0 && base->sample_time == 0 &&
        axis_of(s, "method.step") > 0 && axis_of(s, "controller.kp") > 0) {
        *axis = axis_of(s, "controller.kp");
        return SERVO;
    }
    if (scenario_law(base)->designed && axis_of(s, "controller.sample_time") > 0) {
        *axis = 3 - axis_of(s, "controller.sample_time");
        return SAMPLED;
    }
    if (axis_of(s, "ground.friction") > 0) {
        *axis = 3 - axis_of(s, "ground.friction");
        return PAINLEVE;
    }
    return NO_THEORY;
}

static bool make_line(struct failure_line *line, const struct scenario *s, enum theory theory,
                      const struct plan *plan)
{
    static const char *const texts[] = {
        [SERVO] = "limit of stability of Runge-Kutta 4 in flight",
        [SAMPLED] = "T*, where the sampled loop leaves the unit circle",
        [PAINLEVE] = "Painleve: above it no single contact force fits"};
    const size_t n = s->axis[line->axis].count;
    line->value = malloc(n * sizeof *line->value);
    snprintf(line->text, sizeof line->text, "%s", texts[theory]);
    for (size_t i = 0; line->value && i < n; i++) {
        /* Of row 0, at point i of this axis of the map, first point of the other. */
        const uint64_t index = line->axis == 1 ? i * s->axis[2].count : i;
        struct scenario_values values;
        stance_case c;
        int method;
        scenario_case_values(s, index, &values);
        line->value[i] = !plan_resolve(plan, index, &c, &method) ? NAN
                         : theory == SERVO                       ? servo_limit(s, &c)
                         : theory == SAMPLED ? critical_sample_time(s, &values, &c)
                                             : jamming_friction(s, &c);
    }
    bool any = false;
    for (size_t i = 0; line->value && i < n; i++)
        any |= isfinite(line->value[i]);
    line->axis = any ? line->axis : 0;
    return line->value != NULL;
}

bool failure_theory(struct failure_line *line, const struct scenario *s, stance_message *message)
{
    struct plan plan;
    int axis = 0;
    const enum theory theory = which_theory(s, &axis);
    *line = (struct failure_line){.axis = axis};
    if (theory == NO_THEORY)
        return true;
    if (!study_plan(&plan, s, message))
        return false;
    const bool good = make_line(line, s, theory, &plan) || no_memory(message);
    plan_free(&plan);
    return good;
}
