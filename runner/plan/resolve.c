/* resolve.c - from the numbers of one case to what the engine runs.
 *
 * Which equilibrium is the target of a designed law: controller.equilibrium, or where that
 * is not given initial.equilibrium, solved for the robot that the design believes in
 * (controller.model) and the foot that the robot stands on (initial.support_foot, foot 1 if there
 * is none). Its posture is the target, its torques are the feedforward, and the gains come from the
 * linearisation there. The start is the equilibrium of the true robot: where model and robot
 * differ, so do the solved-for angle and the torques of the two.
 *
 * Which angles `hold` holds: controller.target, or where that is not given the joint angles that
 * the run starts from, offsets included.
 */
#include "resolve.h"
#include "ground_line.h"

#include "engine/tree.h"

#include "runner/base/message.h"
#include "runner/scenario/schema_rows.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define DEEPEST_START 1e-9 /* m: penetration of an initial state that counts as rounding */
#define MOST_STEPS 1e15
#define MOST_CONDITION 1e12 /* of selected coordinates: above it is singular */

/* ---- design ---------------------------------------------------------------------------------- */

struct resolved_part resolve_part(const stance_scene *scene, enum resolved_parts k)
{
#define AT(field) offsetof(struct resolved_design, field) / sizeof(double)
    const size_t n = (size_t)scene->coordinates, m = (size_t)scene->actuators,
                 states = 2 * (size_t)scene->postures, room = 2 * STANCE_MAX_POSTURE;
    const struct resolved_part part[] = {
        [RESOLVED_START] = {AT(start), 0, 1, n, 0},
        [RESOLVED_EQUILIBRIUM] = {AT(equilibrium), n, 1, n, 0},
        [RESOLVED_TORQUE] = {AT(torque), 2 * n, 1, m, 0},
        [RESOLVED_GAIN] = {AT(gain), 2 * n + m, m, states, room},
        [RESOLVED_PARTS] = {0, 2 * n + m + m * states, 0, 0, 0},
    };
#undef AT
    return part[k];
}

void resolve_move(const stance_scene *scene, bool pack, struct resolved_design *design,
                  double *number)
{
    double *const all = (double *)(void *)design;
    if (!pack)
        memset(design, 0, sizeof *design);
    for (enum resolved_parts k = 0; k < RESOLVED_PARTS; k++) {
        const struct resolved_part p = resolve_part(scene, k);
        for (size_t row = 0; row < p.rows; row++) {
            double *const own = &all[p.offset + row * p.stride],
                          *const packed = &number[p.place + row * p.length];
            memcpy(pack ? packed : own, pack ? own : packed, p.length * sizeof *own);
        }
    }
}

static bool solve_equilibrium(const stance_scene *scene, const double *robot,
                              const struct scenario_equilibrium *wanted, uint32_t supports,
                              stance_equilibrium *result, stance_message *message)
{
    stance_equilibrium_choice choice = {.supports = supports, .branch = wanted->branch};
    memcpy(choice.posture, wanted->posture, sizeof choice.posture);
    return scene->equilibrium(scene, robot, &choice, result, message) == STANCE_OK;
}

bool resolve_equilibrium(const stance_scene *scene, const struct scenario_values *values,
                         double *model, stance_equilibrium *equilibrium, stance_message *message)
{
    const bool law = scenario_law(values)->designed;
    const bool own = law && values->design_point.given;
    double unasked[STANCE_MAX_ROBOT];
    stance_equilibrium any = {0};
    stance_message ignored = {""};

    model = model ? model : unasked;
    equilibrium = equilibrium ? equilibrium : &any;
    message = message ? message : &ignored;
    message->text[0] = '\0';
    for (int i = 0; i < STANCE_MAX_ROBOT; i++)
        model[i] = law && !isnan(values->model[i]) ? values->model[i] : values->robot[i];
    if (!own && !values->equilibrium.given) {
        return complain(message, law ? "the controller needs an equilibrium to work at: give "
                                       "controller.equilibrium or initial.equilibrium"
                                     : "the scenario has no equilibrium: give initial.equilibrium");
    }
    return solve_equilibrium(scene, model, own ? &values->design_point : &values->equilibrium,
                             scenario_supports(scene, values), equilibrium, message);
}

int resolve_state(const stance_scene *scene, const stance_equilibrium *equilibrium, int state)
{
    const int p = equilibrium->freedoms;
    int k = 0;
    while (scene->posture[k] != equilibrium->freedom[state % p])
        k++;
    return state < p ? k : scene->postures + k;
}

void resolve_free(const stance_scene *scene, const stance_equilibrium *equilibrium, bool *column)
{
    memset(column, false, 2 * (size_t)scene->postures * sizeof *column);
    for (int j = 0; j < 2 * equilibrium->freedoms; j++)
        column[resolve_state(scene, equilibrium, j)] = true;
}

/* The columns of given gains that the linear model has; the others must be 0. */
static bool take_gains(const stance_scene *scene, const struct scenario_values *values,
                       const stance_equilibrium *equilibrium, double *K, stance_message *message)
{
    const int n = 2 * equilibrium->freedoms, all = 2 * scene->postures, m = scene->actuators;
    bool taken[2 * STANCE_MAX_POSTURE];
    resolve_free(scene, equilibrium, taken);
    for (int j = 0; j < n; j++)
        for (int i = 0; i < m; i++)
            K[i * n + j] = values->gains[i * all + resolve_state(scene, equilibrium, j)];
    for (int k = 0; k < m * all; k++) {
        const char *const name = scene->coordinate[scene->posture[k % all % scene->postures]].name;
        if (!taken[k % all] && values->gains[k] != 0)
            return complain(message,
                            "controller.gains[%d][%d]: %s follows from the others while the "
                            "contacts hold: give 0",
                            k / all, k % all, name);
    }
    return true;
}

bool resolve_gains(const stance_scene *scene, const struct scenario_values *values,
                   const stance_equilibrium *equilibrium, const stance_plant *plant, double *K,
                   stance_robustness *how, stance_message *message)
{
    const int n = plant->states, m = plant->inputs;
    const bool sampled = values->design_time == DESIGN_SAMPLED;
    const double T = sampled ? values->sample_time : 0;
    const char *key = sampled ? "controller.design_time" : "controller.poles";
    double weights[2 * STANCE_MAX_POSTURE], re[SCENARIO_MAX_POLES], im[SCENARIO_MAX_POLES];
    const int poles = scenario_poles(values, re, im);
    char idle[260];

    if (how)
        *how = (stance_robustness){0, NAN};
    message->text[0] = '\0';
    stance_error error = STANCE_OK;
    if (values->design == DESIGN_GAINS) {
        if (!take_gains(scene, values, equilibrium, K, message))
            return false;
    } else if (sampled && !(T > 0)) {
        return complain(message,
                        "controller.design_time: a design for a sampled model needs a "
                        "sample time above 0, not %.6g s",
                        T);
    } else if (values->design == DESIGN_LQR) {
        key = sampled ? key : "controller.weights";
        for (int j = 0; j < n; j++)
            weights[j] = values->state_weights[resolve_state(scene, equilibrium, j)];
        error = stance_lqr(plant, T, weights, values->torque_weights, K, message);
    } else if (poles != n) {
        return complain(message,
                        "controller.poles: %d of them; where the contacts hold there are %d "
                        "states%.100s",
                        poles, n, scenario_idle(scene, equilibrium, idle, sizeof idle));
    } else {
        error = stance_place(values->design == DESIGN_PLACE_SCHUR ? STANCE_SCHUR : STANCE_ROBUST,
                             plant, T, &(stance_poles){re, im}, K, how, message);
    }
    for (int i = 0; error == STANCE_OK && i < m * n; i++)
        if (!isfinite(K[i]))
            return complain(message, "%d finite gains are needed", m * n);
    if (error != STANCE_OK) { /* say which key asked for it */
        const stance_message told = *message;
        if (error == STANCE_UNCONTROLLABLE)
            key = values->design_point.given ? "controller.equilibrium" : "initial.equilibrium";
        complain(message, "%s: %.200s", key, told.text);
    }
    return error == STANCE_OK;
}

static bool design_state_feedback(const stance_scene *scene, const struct scenario_values *values,
                                  struct resolved_design *design, stance_message *message)
{
    const int m = scene->actuators;
    double model[STANCE_MAX_ROBOT], K[SCENARIO_MAX_GAINS] = {0};
    double A[4 * STANCE_MAX_POSTURE * STANCE_MAX_POSTURE];
    double B[2 * STANCE_MAX_POSTURE * STANCE_MAX_ACTUATORS];
    stance_equilibrium equilibrium;

    if (!resolve_equilibrium(scene, values, model, &equilibrium, message))
        return false;
    const stance_error error = scene->linearise(scene, model, &equilibrium, A, B);
    if (error != STANCE_OK)
        return complain(message, "linearisation: %s", stance_error_text(error));
    if (!resolve_gains(scene, values, &equilibrium,
                       &(stance_plant){2 * equilibrium.freedoms, m, A, B}, K, NULL, message))
        return false;
    const int n = 2 * equilibrium.freedoms;
    for (int i = 0; i < m * n; i++)
        design->gain[i / n][resolve_state(scene, &equilibrium, i % n)] = K[i];
    memcpy(design->equilibrium, equilibrium.position,
           (size_t)scene->coordinates * sizeof *design->equilibrium);
    memcpy(design->torque, equilibrium.torque, (size_t)m * sizeof *design->torque);
    return true;
}

static void clear_design(struct resolved_design *design)
{
    *design = (struct resolved_design){0};
    for (int i = 0; i < STANCE_MAX_COORDINATES; i++)
        design->start[i] = design->equilibrium[i] = NAN;
}

bool resolve_keep_design_inputs(const stance_scene *scene, struct scenario_values *values,
                                bool sampled)
{
    struct schema *own;
    const struct schema *const schema = schema_of(scene, NULL, &own);
    const double sample_time = values->sample_time;
    for (size_t k = 0; schema && k < schema->count; k++) {
        const struct scenario_field *field = &schema->field[k];
        if (field->offset != NO_OFFSET && !field->design)
            memset((char *)values + field->offset, 0,
                   schema_items(field) *
                       (field->type == FIELD_NUMBER ? sizeof(double) : sizeof(int)));
    }
    free(own);
    values->settle = 0;
    memset(values->parameter, 0, sizeof values->parameter);
    values->program = NULL;
    values->sample_time = sampled ? sample_time : 0;
    return schema != NULL;
}

bool resolve_design(const stance_scene *scene, const struct scenario_values *values,
                    struct resolved_design *design, stance_message *message)
{
    message->text[0] = '\0';
    clear_design(design);
    if (!values->state_given) {
        stance_equilibrium start;
        if (!values->equilibrium.given) {
            return complain(message,
                            "an initial state is needed: initial.equilibrium or initial.state");
        }
        if (!solve_equilibrium(scene, values->robot, &values->equilibrium,
                               scenario_supports(scene, values), &start, message))
            return false;
        memcpy(design->start, start.position, (size_t)scene->coordinates * sizeof *design->start);
        if (scenario_law(values)->program) { /* what it is told of where the run begins */
            memcpy(design->equilibrium, design->start, sizeof design->equilibrium);
            memcpy(design->torque, start.torque, sizeof design->torque);
        }
    }
    if (scenario_law(values)->designed && !design_state_feedback(scene, values, design, message)) {
        clear_design(design);
        return false;
    }
    return true;
}

/* ---- initial state --------------------------------------------------------------------------- */

static bool is_posture(const stance_scene *scene, int coordinate)
{
    for (int k = 0; k < scene->postures; k++)
        if (scene->posture[k] == coordinate)
            return true;
    return false;
}

/* Offsets of the angles tilt the robot about the foot it stands on; those of the translation move
 * it away from there. */
static void place_robot(const stance_scene *scene, const struct scenario_values *values,
                        const double *start, double *position, double *velocity)
{
    const int n = scene->coordinates;
    const double scale = values->offset_scale;
    for (int i = 0; i < n; i++) {
        const bool angle = is_posture(scene, i);
        position[i] = start[i] + (angle ? scale * values->offset[i] : 0);
        velocity[i] = angle ? scale * values->offset[n + i] : 0;
    }
    scene->stand(scene, values->robot, scenario_supports(scene, values), position, velocity);
    for (int i = 0; i < n; i++) {
        if (!is_posture(scene, i)) {
            position[i] += scale * values->offset[i];
            velocity[i] += scale * values->offset[n + i];
        }
    }
}

void resolve_start(const stance_scene *scene, const struct scenario_values *values,
                   const struct resolved_design *design, double *position, double *velocity)
{
    const size_t n = (size_t)scene->coordinates;
    if (!values->state_given) {
        place_robot(scene, values, design->start, position, velocity);
        return;
    }
    memcpy(position, values->state, n * sizeof *position);
    memcpy(velocity, values->state + n, n * sizeof *velocity);
    if (values->support > 0 || values->support_foot > 0)
        scene->stand(scene, values->robot, scenario_supports(scene, values), position, velocity);
}

/* May a foot be in the ground, as one that lands ahead only and is no further than another? */
static bool passes_through(const stance_scene *scene, const stance_case *out, int c,
                           const double *gap)
{
    double ignored;
    const double place = ground_along(out, out->position, out->velocity, c, &ignored);
    bool behind = false;
    for (int k = 0; k < scene->contacts && out->lands_ahead; k++) {
        const bool other = scene->grip[k] >= 0 && scene->grip[k] != scene->grip[c];
        if (other && (out->contacts >> k & 1) && fabs(gap[k]) <= DEEPEST_START)
            behind |= place <= ground_along(out, out->position, out->velocity, k, &ignored);
    }
    return behind;
}

/* Contact c, a stop of a joint, lies behind the start: says by which key, and how far it may be. */
static bool beyond_stop(const stance_scene *scene, const struct scenario_values *values,
                        const stance_case *out, int c, stance_message *message)
{
    const stance_mechanism *const m = scene->mechanism;
    stance_mechanism_numbers number;
    int before = 0, end = 0; /* stops before it; ends of joints, with a stop or without */
    while (before < c && scene->grip[c - before - 1] < 0)
        before++;
    while (!stance_mechanism_stops(m, end / 2, end % 2) || before-- > 0)
        end++;
    const int i = stance_mechanism_coordinate(m, end / 2);
    stance_mechanism_expand(m, out->robot, &number);
    const char *const unit = scene->coordinate[i].unit, *const name = scene->coordinate[i].name;
    return complain(message, "initial.%s.%s: %s would start at %.6g %s, %s limit of %.6g %s",
                    values->state_given ? "state" : "offset", name, name, out->position[i], unit,
                    end % 2 ? "above its upper" : "below its lower",
                    number.body[end / 2].limits[end % 2], unit);
}

static bool check_start(const stance_scene *scene, const struct scenario_values *values,
                        const stance_case *out, stance_message *message)
{
    double gap[STANCE_MAX_CONTACTS];
    for (int i = 0; i < scene->coordinates; i++) {
        const char *name = scene->coordinate[i].name;
        if (!isfinite(out->position[i]))
            return complain(message, "the initial %s is not a finite number", name);
        if (!isfinite(out->velocity[i]))
            return complain(message, "the initial v%s is not a finite number", name);
    }
    ground_gaps(out, out->position, gap);
    for (int c = 0; c < scene->contacts; c++) {
        if (!isfinite(gap[c])) {
            return complain(message,
                            "the initial position of %s is not defined: an angle is beyond "
                            "1e4 rad",
                            scene->contact_name[c]);
        }
        const bool stop = scene->grip[c] < 0;
        if (stop && gap[c] < -DEEPEST_START)
            return beyond_stop(scene, values, out, c, message);
        if ((out->contacts >> c & 1) && gap[c] < -DEEPEST_START &&
            !passes_through(scene, out, c, gap)) {
            return complain(message, "%s would start %.6g m inside the ground",
                            scene->contact_name[c], -gap[c]);
        }
    }
    return true;
}

/* ---- law and time ---------------------------------------------------------------------------- */

bool resolve_law(const stance_scene *scene, const struct scenario_values *values,
                 const stance_law *law, const double *begin, stance_linear_law *linear,
                 stance_case *out, stance_message *message)
{
    const double *const value = &values->law_value[stance_law_first(law) * STANCE_LAW_ROOM];
    return !law->set || law->set(scene, value, begin, linear, out, message) == STANCE_OK;
}

/* What acts from where the run begins or, outside the ellipsoid about the target of a designed law,
 * from that target. */
static bool set_laws(const stance_scene *scene, const struct scenario_values *values,
                     const struct resolved_design *design, stance_case *out,
                     stance_message *message)
{
    const stance_law *const law = scenario_law(values), *const far = scenario_far(values);
    if (law->program || far->program) {
        out->program = values->program;
        memcpy(out->parameter, values->parameter, sizeof out->parameter);
    }
    if (!law->designed && !(law->program && !values->state_given))
        return resolve_law(scene, values, law, out->position, &out->near, out, message);
    memcpy(out->near.feedforward, design->torque, sizeof out->near.feedforward);
    memcpy(out->near.gain, design->gain, sizeof out->near.gain);
    for (int k = 0; k < scene->postures; k++)
        out->near.target[k] = design->equilibrium[scene->posture[k]];
    out->has_target = true;
    out->supports = scenario_supports(scene, values);
    if (!resolve_law(scene, values, law, design->equilibrium, &out->near, out, message))
        return false;
    if (!far->set)
        return true;
    out->switches = true;
    for (int k = 0; k < scene->postures; k++) {
        out->switch_axis[k] = values->near_angle;
        out->switch_axis[scene->postures + k] = values->near_rate;
    }
    return resolve_law(scene, values, far, design->equilibrium, &out->far, out, message);
}

/* Numbers within their ranges, by the rows of the format; what counts samples is sampled. Whoever
 * changes a case's numbers by himself relies on it. */
static bool check_numbers(const struct scenario_values *values, stance_message *message)
{
    char range[96];
    for (size_t i = 0; i < schema_row_count; i++) {
        const struct scenario_field *const field = &schema_rows[i].field;
        const bool number = field->offset != NO_OFFSET &&
                            (field->type == FIELD_NUMBER || field->type == FIELD_INTEGER);
        const double value = number ? schema_number(field, values, 0) : field->fallback;
        const bool none =
                       (isinf(value) && field->words) || (isnan(value) && isnan(field->fallback)),
                   inside = value >= field->low && value <= field->high &&
                            !(field->low_open && value == field->low),
                   unsampled = values->sample_time == 0 && schema_samples(field, values);
        if ((!unsampled && (!number || none || inside)) || field->by_scene ||
            strpbrk(field->path, "*[") || !schema_allows(field->use, field->law, values))
            continue;
        return unsampled ? complain(message, "%s needs controller.sample_time > 0: %s", field->path,
                                    field->samples)
                         : complain(message, "%s: %.9g is out of range (%s)", field->path, value,
                                    schema_range_text(field, range, sizeof range));
    }
    return true;
}

static bool check_law(const stance_scene *scene, const stance_case *out, stance_message *message)
{
    bool finite = true;
    for (int i = 0; i < scene->actuators; i++) {
        finite = finite && isfinite(out->near.feedforward[i]);
        for (int j = 0; j < 2 * scene->postures; j++)
            finite = finite && isfinite(out->near.gain[i][j]);
    }
    for (int k = 0; k < scene->postures; k++)
        finite = finite && isfinite(out->near.target[k]);
    return finite || complain(message, "a gain or a target of the controller is not finite");
}

/* Each sample interval is cut into equal steps no longer than method.step; the 1e-9 lets an
 * interval that is a multiple of the step but for rounding keep it. */
static bool resolve_time(const struct scenario_values *values, stance_case *out,
                         stance_message *message)
{
    const double interval = values->sample_time;
    const stance_method *method = stance_methods()[values->method];
    out->step = values->step;
    out->tolerance = isnan(values->tolerance) ? method->tolerance : values->tolerance;
    if (interval > 0) {
        const double pieces = fmax(1, ceil(interval / values->step - 1e-9));
        if (pieces > MOST_STEPS)
            return complain(message, "controller.sample_time has more than %g steps", MOST_STEPS);
        out->sample_every = (int64_t)pieces;
        out->step = interval / pieces;
    }
    if (values->stop_time > 0 && values->stop_time < out->step)
        out->step = values->stop_time; /* then there is one step, and no second sample */
    const double steps = fmax(1, nearbyint(values->stop_time / out->step));
    if (!(steps <= MOST_STEPS))
        return complain(message, "stop.time has more than %g steps", MOST_STEPS);
    out->steps = (int64_t)steps;
    return true;
}

bool resolve_selection(const stance_scene *scene, const stance_case *start, stance_message *message)
{
    double condition;
    int selection = 0, coordinate[STANCE_MAX_ACTUATORS];
    char name[SCENARIO_NAME];
    if (!start->decouples || start->follows)
        return true;
    for (bool same = false; !same && stance_selection(scene, selection, coordinate); selection++) {
        same = true;
        for (int i = 0; i < scene->actuators; i++)
            same = same && coordinate[i] == start->servo[i].coordinate;
    }
    selection--;
    if (stance_selection_condition(scene, start->robot, start->position, selection, &condition) ==
            STANCE_OK &&
        condition < MOST_CONDITION)
        return true;
    scenario_selection_name(scene, selection, name);
    return complain(message,
                    "controller.controlled: %.100s is singular in the initial posture: no torques "
                    "give the accelerations that the law asks for",
                    name);
}

bool resolve_case(const struct scenario *s, const struct scenario_values *values,
                  const struct resolved_design *design, uint64_t index, stance_case *out,
                  stance_message *message)
{
    const stance_scene *const scene = s->scene;
    message->text[0] = '\0';
    *out = (stance_case){
        .torque_rate = isinf(values->torque_rate) ? 0 : values->torque_rate,
        .settle_place = isinf(values->settle_place) ? 0 : values->settle_place,
        .seed = s->seed,
    };
    scenario_case_keys(s, index, &out->grid_index, &out->sample_index); /* rough ground's, too */
    /* friction and all else that a case has by the scenario's name: scenario.h */
#define TAKE(name) out->name = values->name;
    SCENARIO_WHOLES(TAKE)
    SCENARIO_NUMBERS(TAKE)
    memcpy(out->robot, values->robot, sizeof out->robot);
    for (int i = 0; i < scene->actuators; i++)
        out->torque_limits[i] = isinf(values->torque_limits[i]) ? 0 : values->torque_limits[i];
    stance_case_robot(scene, out);
    if (!check_numbers(values, message))
        return false;
    resolve_start(scene, values, design, out->position, out->velocity);
    return check_start(scene, values, out, message) &&
           set_laws(scene, values, design, out, message) && resolve_time(values, out, message) &&
           check_law(scene, out, message);
}

/* ---- what a search varies ------------------------------------------------------------------- */

/* Of the columns of gains those that may be other than 0: all where there is no equilibrium. */
static int find_free(const struct scenario *s, bool *column)
{
    const int columns = 2 * s->scene->postures;
    stance_equilibrium equilibrium;
    int count = 0;
    if (resolve_equilibrium(s->scene, &s->base, NULL, &equilibrium, NULL))
        resolve_free(s->scene, &equilibrium, column);
    else
        memset(column, true, (size_t)columns * sizeof *column);
    for (int k = 0; k < columns; k++)
        count += column[k];
    return count;
}

/* Whether number k may differ. */
static bool is_free(const struct scenario *s, int k, const bool *column)
{
    const size_t gains = offsetof(struct scenario_values, gains), at = s->search.axis.offset[k];
    return at < gains || at >= gains + sizeof s->base.gains ||
           column[(at - gains) / sizeof(double) % (2 * (size_t)s->scene->postures)];
}

int search_numbers(const struct scenario *s)
{
    bool column[2 * STANCE_MAX_POSTURE];
    const int columns = find_free(s, column);
    int count = s->search.designed_gains ? s->scene->actuators * columns : 0;
    for (int k = 0; k < s->search.axis.paths; k++)
        count += is_free(s, k, column);
    return count;
}

void search_numbers_keep(struct scenario *s)
{
    struct scenario_axis *const axis = &s->search.axis;
    bool column[2 * STANCE_MAX_POSTURE];
    int kept = 0;
    find_free(s, column);
    for (int k = 0; k < axis->paths; k++) {
        if (!is_free(s, k, column))
            continue;
        memmove(axis->path[kept], axis->path[k], sizeof axis->path[k]);
        axis->offset[kept] = axis->offset[k];
        axis->integer[kept] = axis->integer[k];
        axis->enumeration[kept] = axis->enumeration[k];
        s->search.varied[kept++] = s->search.varied[k];
    }
    axis->paths = kept;
}
