/* failure_theory.c - where theory says that a step is too long, a controller too slow, or a slide
 * without accelerations.
 *
 * Stability of the classical Runge-Kutta formula, R(z) = 1 + z + z^2/2 + z^3/6 + z^4/24, on legs
 * held by a servo in free flight (Hairer and Wanner, Solving Ordinary Differential Equations II,
 * IV.2). With the hip's place eliminated the angles a = (theta, phi1, phi2) of the links have the
 * inertia J_ij = m_i l_i (delta_ij l_i - m_j l_j cos(a_i - a_j) / M), the trunk counted from above,
 * M the whole mass; the joint angles q = B^T a, phi_i = theta + q_i, feel the torques of the servo
 * alone, q'' = -S (kp q + kd q'), S = B^T J^-1 B. Each eigenvalue s of S gives two of
 * lambda^2 + kd s lambda + kp s = 0.
 */
#include "failure.h"

#include "runner/plan/plan.h"

#include <complex.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static bool fail(stance_message *message, const char *text)
{
    snprintf(message->text, sizeof message->text, "%s", text);
    return false;
}

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

/* Flat index of the case in the middle of row 0 at point i of an axis of the map, first point of
 * the other. */
static uint64_t case_at(const struct scenario *s, int axis, size_t i)
{
    return axis == 1 ? i * s->axis[2].count : i;
}

/* ---- the servo's legs in free flight ------------------------------------------------------- */

/* Eigenvalues of S, both real and positive. */
static void servo_eigenvalues(const double *robot, const double *position, double eigenvalue[2])
{
    enum { LEG_LENGTH, TRUNK_LENGTH, FOOT_MASS, TRUNK_MASS, HIP_MASS };
    const double m[3] = {robot[TRUNK_MASS], robot[FOOT_MASS], robot[FOOT_MASS]};
    const double l[3] = {robot[TRUNK_LENGTH], robot[LEG_LENGTH], robot[LEG_LENGTH]};
    const double total = robot[HIP_MASS] + m[0] + m[1] + m[2];
    /* Legs point down at 0, the trunk up. */
    const double angle[3] = {position[2] + acos(-1), position[2] + position[3],
                             position[2] + position[4]};
    double J[3][3], inverse[3][3], S[2][2];
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            J[i][j] = -m[i] * l[i] * m[j] * l[j] * cos(angle[i] - angle[j]) / total +
                      (i == j ? m[i] * l[i] * l[i] : 0);
        }
    }
    double determinant = 0;
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            const int a = (j + 1) % 3, b = (j + 2) % 3, c = (i + 1) % 3, d = (i + 2) % 3;
            inverse[i][j] = J[a][c] * J[b][d] - J[a][d] * J[b][c];
        }
        determinant +=
            i == 0 ? J[0][0] * inverse[0][0] + J[0][1] * inverse[1][0] + J[0][2] * inverse[2][0]
                   : 0;
    }
    for (int i = 0; i < 2; i++) {
        for (int j = 0; j < 2; j++) {
            S[i][j] =
                (inverse[i + 1][j + 1] - inverse[0][j + 1] - inverse[i + 1][0] + inverse[0][0]) /
                determinant;
        }
    }
    const double mean = 0.5 * (S[0][0] + S[1][1]);
    const double root = sqrt(fmax(0, mean * mean - (S[0][0] * S[1][1] - S[0][1] * S[1][0])));
    eigenvalue[0] = mean - root;
    eigenvalue[1] = mean + root;
}

/* Largest |R(h lambda)| over the eigenvalues of the servo's legs. */
static double runge_kutta_growth(const double eigenvalue[2], double kp, double kd, double h)
{
    double largest = 0;
    for (int k = 0; k < 4; k++) {
        const double s = eigenvalue[k / 2], sign = k % 2 ? 1 : -1;
        const double complex root = csqrt(kd * s * kd * s - 4 * kp * s);
        const double complex z = 0.5 * h * (-kd * s + sign * root);
        largest = fmax(cabs(1 + z * (1 + z / 2 * (1 + z / 3 * (1 + z / 4)))), largest);
    }
    return largest;
}

/* Smallest step at which the growth passes 1: the limit lies near 2.8 / |lambda|, and below a
 * quarter of that every formula of this kind is stable. */
static double runge_kutta_limit(const double eigenvalue[2], double kp, double kd)
{
    const double s = eigenvalue[1];
    const double fastest = kd * s > 2 * sqrt(kp * s)
                               ? 0.5 * (kd * s + sqrt(kd * s * kd * s - 4 * kp * s))
                               : sqrt(kp * s);
    double low = 0.7 / fastest, high = low;
    while (runge_kutta_growth(eigenvalue, kp, kd, high) <= 1 + 1e-12 && high * fastest < 10) {
        low = high;
        high *= 1.01;
    }
    for (int i = 0; i < 60; i++) {
        const double middle = 0.5 * (low + high);
        if (runge_kutta_growth(eigenvalue, kp, kd, middle) <= 1 + 1e-12)
            low = middle;
        else
            high = middle;
    }
    return low;
}

static bool flies(const stance_scene *scene, const stance_case *c)
{
    double gap[STANCE_MAX_CONTACTS];
    scene->gaps(c->robot, c->position, gap);
    for (int i = 0; i < scene->contacts; i++)
        if ((c->contacts >> i & 1) && gap[i] <= 0)
            return false;
    return true;
}

static double servo_limit(const struct scenario *s, const stance_case *c)
{
    double eigenvalue[2];
    if (!flies(s->scene, c))
        return NAN;
    servo_eigenvalues(c->robot, c->position, eigenvalue);
    return runge_kutta_limit(eigenvalue, c->near.gain[0][1], c->near.gain[0][4]);
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
        scene->linearise(values->robot, &equilibrium, A, B) != STANCE_OK)
        return NAN;
    for (int i = 0; i < scene->actuators; i++)
        for (int j = 0; j < n; j++)
            K[i * n + j] = c->near.gain[i][j];
    return stance_critical_sample_time(n, scene->actuators, A, B, K, (int)c->delay, 10, &T) ==
                   STANCE_OK
               ? T
               : NAN;
}

/* ---- Painleve ------------------------------------------------------------------------------- */

/* Friction from which the slide of an end has no accelerations, see engine/scenes/rod.c:
 * 1 + p (cos^2 + mu s sin cos) = 0 with p = m L^2 / (4 I); INFINITY where there is none. */
static double jamming_friction(const struct scenario *s, const stance_case *c)
{
    enum { LENGTH, MASS, INERTIA_RATIO, THETA = 2 };
    double gap[STANCE_MAX_CONTACTS], point[2], speed[2], lowest = INFINITY;
    const double p = 1 / (4 * c->robot[INERTIA_RATIO]);
    s->scene->gaps(c->robot, c->position, gap);
    for (int end = 0; end < s->scene->contacts; end++) {
        s->scene->contact_point(c->robot, c->position, c->velocity, end, point, speed);
        if (gap[end] > 1e-12 || speed[0] == 0)
            continue;
        const double sine = sin(c->position[THETA]), cosine = cos(c->position[THETA]);
        const double edge = (speed[0] > 0 ? 1 : -1) * sine * cosine;
        if (edge < 0)
            lowest = fmin((1 + p * cosine * cosine) / (-p * edge), lowest);
    }
    return lowest;
}

/* ---- which of them -------------------------------------------------------------------------- */

enum theory { NO_THEORY, SERVO, SAMPLED, PAINLEVE };

static enum theory which_theory(const struct scenario *s, int *axis)
{
    const struct scenario_values *base = &s->base;
    if (strcmp(s->scene->name, "biped") == 0 && strcmp(scenario_law(base)->name, "hold") == 0 &&
        base->sample_time == 0 && axis_of(s, "method.step") > 0 &&
        axis_of(s, "controller.kp") > 0) {
        *axis = axis_of(s, "controller.kp");
        return SERVO;
    }
    if (scenario_law(base)->designed && axis_of(s, "controller.sample_time") > 0) {
        *axis = 3 - axis_of(s, "controller.sample_time");
        return SAMPLED;
    }
    if (strcmp(s->scene->name, "rod") == 0 && axis_of(s, "ground.friction") > 0) {
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
        const uint64_t index = case_at(s, line->axis, i);
        struct scenario_values values;
        stance_case c;
        int method;
        scenario_case_values(s, index, &values);
        line->value[i] = !plan_resolve(plan, index, &c, &method) ? NAN
                         : theory == SERVO                       ? servo_limit(s, &c)
                         : theory == SAMPLED ? critical_sample_time(s, &values, &c)
                                             : jamming_friction(s, &c);
    }
    return line->value != NULL;
}

bool failure_theory(struct failure_line *line, const struct scenario *s, stance_message *message)
{
    struct parallel alone = parallel_alone();
    struct plan plan;
    struct plan_error error = {0};
    int axis = 0;
    const enum theory theory = which_theory(s, &axis);
    *line = (struct failure_line){.axis = axis};
    if (theory == NO_THEORY)
        return true;
    if (!plan_make(&plan, s, false, 0, false, &error))
        return fail(message, error.message.text);
    bool good = plan_compute_designs(&plan, &alone, &error);
    if (!good)
        fail(message, error.message.text);
    else
        good = make_line(line, s, theory, &plan) || fail(message, "not enough memory");
    plan_free(&plan);
    return good;
}
