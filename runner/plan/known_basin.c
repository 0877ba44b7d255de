/* known_basin.c - the captured set of a design: its candidates of shape, and the estimate.
 *
 * Shapes that are tried: the Lyapunov function that `stance design` prints, which weighs a
 * departure as stop.settle does, and the widest sets within the friction cone, contact and the
 * torques that are left beside those of the equilibrium, times a factor. Torques beyond their limit
 * are cut, which a linear picture knows nothing of; but the loop comes back from far more than the
 * states in which nothing is cut, and what decides is simulation. Which factor gives the largest
 * set depends on the limit: for scenarios/basin_one_foot.yaml (10 N m, of which 7.5 hold the robot)
 * it is 6 or 8 and the set e^9 times as large as that of the printed function; at 20 N m and more
 * the printed function is the best.
 */
#include "known_basin.h"
#include "instruction_set.h"

#include "runner/base/message.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { STATES = 2 * STANCE_MAX_POSTURE, INPUTS = STANCE_MAX_ACTUATORS };

static const double torque_factor[] = {0.5, 1, 2, 4, 6, 8, 16};
enum { FACTORS = sizeof torque_factor / sizeof torque_factor[0] };
_Static_assert((int)FACTORS < (int)STANCE_MAX_SHAPES, "candidates fit");

stance_error known_basin_bounds(const stance_scene *scene, const struct scenario_values *values,
                                const double *model, const stance_equilibrium *equilibrium,
                                const double *K, double *a, double *d)
{
    const int n = 2 * scene->postures, m = scene->actuators;
    double force[2], by_state[2 * STATES], by_torque[2 * INPUTS], limit[STANCE_MAX_ACTUATORS];

    if (!equilibrium->supports || (equilibrium->supports & (equilibrium->supports - 1)))
        return STANCE_BAD_ARGUMENT; /* bounds for one support's force */
    const stance_error error =
        scene->contact_force(scene, model, equilibrium, force, by_state, by_torque);
    for (int j = 0; error == STANCE_OK && j < n; j++) {
        double loop[2];
        for (int c = 0; c < 2; c++) {
            loop[c] = by_state[c * n + j];
            for (int i = 0; i < m; i++)
                loop[c] -= by_torque[c * m + i] * K[i * n + j];
        }
        for (int i = 0; i < m; i++) {
            a[2 * i * n + j] = -K[i * n + j];
            a[(2 * i + 1) * n + j] = K[i * n + j];
        }
        a[2 * m * n + j] = loop[1] - values->friction * loop[0];
        a[(2 * m + 1) * n + j] = -loop[1] - values->friction * loop[0];
        a[(2 * m + 2) * n + j] = -loop[0];
    }
    stance_torque_limits(scene, values->robot, values->torque_limit, values->torque_limits, limit);
    for (int i = 0; i < m; i++) {
        d[2 * i] = limit[i] - equilibrium->torque[i];
        d[2 * i + 1] = limit[i] + equilibrium->torque[i];
    }
    d[2 * m] = values->friction * force[0] - force[1];
    d[2 * m + 1] = values->friction * force[0] + force[1];
    d[2 * m + 2] = force[0];
    return error;
}

/* ---- candidates ------------------------------------------------------------------------------ */

/* The printed Lyapunov function at its level of first order. */
static stance_error settling_shape(const struct scenario_values *values, int n, const double *loop,
                                   int count, const double *a, const double *d, double *P)
{
    double weight[STATES], level = 0, alone[STATES], extent[STATES];
    int binding;
    for (int i = 0; i < n; i++) {
        const double tolerance = i < n / 2 ? values->settle_angle : values->settle_rate;
        weight[i] = 1 / (tolerance * tolerance);
    }
    stance_error error = stance_lyapunov(n, loop, values->sample_time > 0, weight, P, NULL);
    if (error == STANCE_OK)
        error = stance_sublevel(n, P, count, a, d, &level, &binding, alone, extent);
    if (error == STANCE_OK && !(level > 0 && isfinite(level)))
        error = STANCE_BAD_ARGUMENT;
    for (int i = 0; error == STANCE_OK && i < n * n; i++)
        P[i] /= level;
    return error;
}

static stance_error add_shapes(const stance_scene *scene, const struct scenario_values *values,
                               const double *loop, const double *a, const double *d,
                               stance_known_basin_search *search)
{
    const int n = 2 * scene->postures, torques = 2 * scene->actuators, count = torques + 3;
    stance_error error = settling_shape(values, n, loop, count, a, d, search->P[0]);

    search->shapes = 1;
    for (int k = 0; error == STANCE_OK && k < FACTORS; k++) {
        double scaled[KNOWN_BASIN_BOUNDS];
        for (int i = 0; i < count; i++)
            scaled[i] = d[i] * (i < torques ? torque_factor[k] : 1);
        error = stance_invariant_ellipsoid(n, loop, values->sample_time > 0, count, a, scaled,
                                           search->P[search->shapes++], NULL);
    }
    return error;
}

const char *known_basin_shape_text(int shape, char text[96])
{
    if (shape == 0) {
        snprintf(text, 96, "P as printed above, which pays for a departure as stop.settle does");
    } else {
        snprintf(text, 96, "widest set of first order with %g times the torques that are left",
                 torque_factor[shape - 1]);
    }
    return text;
}

/* No set, until there is one. */
static void forget(struct resolved_design *design)
{
    for (int i = 0; i < STATES; i++)
        for (int j = 0; j < STATES; j++)
            design->captured[i][j] = NAN;
    design->capture_time = design->capture_boundary = NAN;
    design->capture_batches = design->capture_share = NAN;
}

/* ---- the search ------------------------------------------------------------------------------ */

/* A case of these values that stands at the target. */
static bool standing_case(const stance_scene *scene, const struct scenario_values *values,
                          const struct resolved_design *design, uint64_t seed, stance_case *base,
                          stance_message *message)
{
    struct scenario_values standing = *values;
    standing.state_given = 1;
    standing.capture = 0;
    memset(standing.state, 0, sizeof standing.state);
    memcpy(standing.state, design->equilibrium,
           (size_t)scene->coordinates * sizeof *standing.state);
    if (!resolve_case(scene, &standing, design, seed, 0, base, message))
        return false;
    base->steps = base->steps / 2;
    return true;
}

bool known_basin_prepare(const stance_scene *scene, const struct scenario_values *values,
                         const struct resolved_design *design, uint64_t seed,
                         stance_known_basin_search *search, stance_message *message)
{
    double model[STANCE_MAX_ROBOT], A[STATES * STATES], B[STATES * INPUTS];
    double K[STATES * INPUTS] = {0}, loop[STATES * STATES];
    double a[KNOWN_BASIN_BOUNDS * STATES], d[KNOWN_BASIN_BOUNDS];
    const int n = 2 * scene->postures;
    stance_equilibrium equilibrium;

    *search = (stance_known_basin_search){
        .scene = scene, .boundary = KNOWN_BASIN_BOUNDARY, .interior = KNOWN_BASIN_INTERIOR};
    search->kernel = instruction_set_kernel(scene, stance_methods()[values->method]);
    if (!search->kernel || !scene->contact_force || !scene->linearise)
        return complain(message, "no captured set: not for this scene");
    if (!resolve_equilibrium(scene, values, model, &equilibrium, message) ||
        !standing_case(scene, values, design, seed, &search->base, message))
        return false;
    if (!equilibrium.supports)
        return complain(message, "no captured set: only for a robot that stands on a contact");
    if (equilibrium.freedoms < scene->postures)
        return complain(message, "no captured set: the contacts hold some of the coordinates");
    for (int i = 0; i < scene->actuators * n; i++)
        K[i] = design->gain[i / n][i % n];
    stance_error error = scene->linearise(scene, model, &equilibrium, A, B);
    if (error == STANCE_OK)
        error = resolve_loop(n, scene->actuators, A, B, K, values->sample_time, loop);
    if (error == STANCE_OK)
        error = known_basin_bounds(scene, values, model, &equilibrium, K, a, d);
    if (error == STANCE_OK)
        error = add_shapes(scene, values, loop, a, d, search);
    if (error != STANCE_OK) {
        complain(message,
                 "no captured set: the loop is not stable, or the equilibrium is beyond the torque "
                 "limit or the friction cone");
    }
    return error == STANCE_OK;
}

bool known_basin_estimate(const stance_scene *scene, const struct scenario_values *values,
                          struct resolved_design *design, uint64_t seed,
                          bool (*stop)(void *context), void *context, stance_known_basin *set,
                          stance_message *message)
{
    stance_known_basin_search search;
    stance_known_basin own = {.exists = false};
    const int n = 2 * scene->postures;

    set = set ? set : &own;
    *set = (stance_known_basin){.exists = false};
    forget(design);
    if (!known_basin_prepare(scene, values, design, seed, &search, message))
        return true;
    search.leave = stop;
    search.context = context;
    const stance_error error = stance_known_basin_estimate(&search, set);
    if (error == STANCE_STOPPED) {
        message->text[0] = '\0';
        return false;
    }
    if (error != STANCE_OK) {
        complain(message, "captured set: %s", stance_error_text(error));
        return error != STANCE_NO_MEMORY;
    }
    if (!set->exists) {
        complain(message,
                 "no captured set: however near, some start does not settle within half of "
                 "stop.time");
        return true;
    }
    for (int i = 0; i < n * n; i++)
        design->captured[i / n][i % n] = set->form[i];
    design->capture_time = set->time + values->settle_hold;
    design->capture_boundary = (double)set->boundary;
    design->capture_batches = (double)set->batches;
    design->capture_share = set->share;
    return true;
}
