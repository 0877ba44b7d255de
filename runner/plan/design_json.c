/* design_json.c - the report of `stance design` for programs. */
#include "allowed.h"
#include "design.h"

#include <math.h>

static json_t *json_complex(int n, const double *re, const double *im)
{
    json_t *list = json_array();
    for (int i = 0; i < n; i++)
        json_array_append_new(list, json_pack("[f, f]", re[i], im[i]));
    return list;
}

static json_t *json_vector(int n, const double *x)
{
    json_t *list = json_array();
    for (int i = 0; i < n; i++)
        json_array_append_new(list, json_real(x[i]));
    return list;
}

static json_t *json_matrix(int rows, int columns, const double *x)
{
    json_t *matrix = json_array();
    for (int i = 0; i < rows; i++)
        json_array_append_new(matrix, json_vector(columns, x + i * columns));
    return matrix;
}

static json_t *json_equilibrium(const struct design_report *r)
{
    const stance_scene *scene = r->scenario->scene;
    json_t *position = json_object(), *torque = json_object();
    char supports[STANCE_MAX_CONTACTS * 40];
    for (int i = 0; i < scene->coordinates; i++) {
        json_object_set_new(position, scene->coordinate[i].name,
                            json_real(r->equilibrium.position[i]));
    }
    for (int i = 0; i < scene->actuators; i++)
        json_object_set_new(torque, scene->actuator_name[i], json_real(r->equilibrium.torque[i]));
    return json_pack("{s:s, s:o, s:o, s:f}", "support",
                     design_supports(scene, &r->equilibrium, supports, sizeof supports), "position",
                     position, "torque", torque, "normal_force", r->normal);
}

static json_t *json_bounded(double x)
{
    return isfinite(x) ? json_real(x) : json_null();
}

static json_t *json_states(const struct design_report *r, const double *x)
{
    json_t *map = json_object();
    char name[SCENARIO_NAME];
    for (int i = 0; i < r->states; i++)
        json_object_set_new(map, design_state_name(r, i, name), json_bounded(x[i]));
    return map;
}

static json_t *json_set(const struct design_report *r)
{
    const struct design_set *set = &r->set;
    char name[64];
    if (!set->exists)
        return json_null();
    return json_pack("{s:b, s:o, s:o, s:s, s:o, s:o}", "sampled", r->sampled > 0, "P",
                     json_matrix(r->states, r->states, set->P), "level", json_bounded(set->level),
                     "binding", design_bound_name(r, set->binding, name), "alone",
                     json_states(r, set->alone), "extent", json_states(r, set->extent));
}

static json_t *json_allowed(const struct design_report *r)
{
    const struct design_allowed *const allowed = &r->allowed;
    if (!allowed->exists)
        return json_null();
    return json_pack("{s:o, s:o, s:b, s:o, s:o}", "unstable_modes",
                     json_complex(allowed->modes, allowed->re, allowed->im), "unreached_modes",
                     json_complex(allowed->unreached, allowed->unreached_re, allowed->unreached_im),
                     "glued", (int)allowed_glued(&r->equilibrium), "low",
                     json_states(r, allowed->reach[0]), "high", json_states(r, allowed->reach[1]));
}

static json_t *json_sampled(const struct design_report *r)
{
    const bool margins = r->sampled && r->stable;
    if (!r->sampled)
        return json_null();
    return json_pack("{s:f, s:i, s:f, s:o, s:f, s:o, s:o, s:o}", "sample_time",
                     r->scenario->base.sample_time, "delay", r->delay, "lag", r->lag, "eigenvalues",
                     json_complex(r->sampled, r->sampled_re, r->sampled_im), "spectral_radius",
                     r->radius, "critical_delay",
                     margins && r->delay_margin < STANCE_MAX_DELAY
                         ? json_integer(r->delay_margin + 1)
                         : json_null(),
                     "critical_lag", margins ? json_bounded(r->lag_margin) : json_null(), "wander",
                     margins && r->noisy ? json_states(r, r->wander) : json_null());
}

/* What there is to say of a state-feedback law and its design. */
static void put_design(const struct design_report *r, json_t *controller)
{
    static const char *const designs[] = {"place", "place-schur", "lqr", "gains"};
    static const char *const times[] = {"continuous", "sampled"};
    const struct scenario_values *values = &r->scenario->base;
    const int design = values->design;
    double weights[DESIGN_STATES];

    for (int i = 0; i < r->states; i++)
        weights[i] = design_weight(r, i);
    json_object_set_new(controller, "design", json_string(designs[design]));
    if (design != DESIGN_GAINS)
        json_object_set_new(controller, "design_time", json_string(times[values->design_time]));
    double re[SCENARIO_MAX_POLES], im[SCENARIO_MAX_POLES];
    if (design == DESIGN_PLACE || design == DESIGN_PLACE_SCHUR) {
        json_object_set_new(controller, "poles",
                            json_complex(scenario_poles(values, re, im), re, im));
    }
    if (design == DESIGN_LQR) {
        json_object_set_new(controller, "weights",
                            json_pack("{s:o, s:o}", "states", json_vector(r->states, weights),
                                      "torques", json_vector(r->inputs, values->torque_weights)));
    }
    if (r->how.sweeps > 0) {
        json_object_set_new(controller, "condition", json_real(r->how.condition));
        json_object_set_new(controller, "sweeps", json_integer(r->how.sweeps));
    }
    if (r->bends) {
        double beyond[DESIGN_INPUTS * DESIGN_STATES];
        design_beyond(r, beyond);
        json_object_set_new(
            controller, "beyond",
            json_pack("{s:o, s:o, s:o, s:o}", "normal", json_vector(r->states, r->plane), "push",
                      json_vector(r->inputs, r->push), "gain",
                      json_matrix(r->inputs, r->states, beyond), "closed_loop_eigenvalues",
                      json_complex(r->states, r->beyond_re, r->beyond_im)));
    }
    json_object_set_new(controller, "lyapunov", json_set(r));
}

static json_t *json_controller(const struct design_report *r)
{
    const struct scenario_values *values = &r->scenario->base;
    const int n = r->states;

    if (!r->closed)
        return json_pack("{s:s}", "kind", stance_laws()[0]->name);
    json_t *controller =
        json_pack("{s:s, s:o, s:o, s:b, s:o, s:o, s:o}", "kind", scenario_law(values)->name, "gain",
                  json_matrix(r->inputs, n, r->K), "closed_loop_eigenvalues",
                  json_complex(n, r->closed_re, r->closed_im), "stable", r->stable, "sampled_loop",
                  json_sampled(r), "critical_sample_time", json_bounded(r->critical[0]),
                  "critical_sample_time_delayed", json_bounded(r->critical[1]));
    if (controller && scenario_law(values)->designed)
        put_design(r, controller);
    return controller;
}

json_t *design_json(const struct design_report *r)
{
    const stance_scene *scene = r->scenario->scene;
    const int n = r->states;
    json_t *robot = json_object(), *states = json_array(), *inputs = json_array();
    char name[SCENARIO_NAME];

    for (int i = 0; i < scene->robot_count; i++)
        json_object_set_new(robot, scene->robot[i].name, json_real(r->model[i]));
    for (int i = 0; i < n; i++)
        json_array_append_new(states, json_string(design_state_name(r, i, name)));
    for (int i = 0; i < r->inputs; i++)
        json_array_append_new(inputs, json_string(scene->actuator_name[i]));
    return json_pack(
        "{s:s, s:s, s:s, s:o, s:{s:f, s:f}, s:o, s:o, s:o, s:o, s:o, s:o, s:{s:i, s:i, s:o}, s:o, "
        "s:o}",
        "scenario", r->scenario->file, "title", r->scenario->title, "scene", scene->name, "robot",
        robot, "ground", "slope", r->model[STANCE_ROBOT_SLOPE], "gravity",
        r->model[STANCE_ROBOT_GRAVITY], "equilibrium", json_equilibrium(r), "states", states,
        "inputs", inputs, "A", json_matrix(n, n, r->A), "B", json_matrix(n, r->inputs, r->B),
        "open_loop_eigenvalues", json_complex(n, r->open_re, r->open_im), "kalman", "rank", r->rank,
        "states", n, "singular_values", json_vector(n, r->singular), "allowed", json_allowed(r),
        "controller", json_controller(r));
}
