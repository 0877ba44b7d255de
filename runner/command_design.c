/* command_design.c - `stance design`: what control theory says about a scenario before any case of
 * it runs: equilibrium, linearisation, controllability, gains, critical sample time.
 */
#include "command.h"
#include "resolve.h"

#include <errno.h>
#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MAX_SETS = 64, STATES = 2 * STANCE_MAX_POSTURE, INPUTS = STANCE_MAX_ACTUATORS };

#define LONGEST_SAMPLE_TIME 10.0 /* s: up to where the critical one is searched */

/* All that is printed. Matrices are row-major with `states` and `inputs` as their sizes. */
struct report {
    const struct scenario *scenario;
    int states, inputs;
    double model[STANCE_MAX_ROBOT];
    stance_equilibrium equilibrium;
    double weight; /* N: the normal force */
    double A[STATES * STATES], B[STATES * INPUTS];
    double open_re[STATES], open_im[STATES];
    double singular[STATES];
    int rank;
    bool closed; /* there is a law: the rest is valid */
    double K[INPUTS * STATES];
    double closed_re[STATES], closed_im[STATES];
    int sweeps;       /* of pole placement; 0: gains were given */
    double condition; /* of the eigenvectors; NAN: gains were given */
    double critical;  /* s; 0: unstable however fast; INFINITY: none found */
};

static bool refuse(stance_message *message, const char *what, stance_error error)
{
    snprintf(message->text, sizeof message->text, "%s: %s", what, stance_error_text(error));
    return false;
}

/* ---- computing ------------------------------------------------------------------------------- */

/* Weight of the robot: twice the kinetic energy of a unit of vertical speed, times gravity. */
static double weight_of(const stance_scene *scene, const double *robot, const double *position)
{
    double velocity[STANCE_MAX_COORDINATES] = {0};
    const double rest = scene->energy(robot, position, velocity);
    for (int i = 0; i < scene->coordinates; i++) {
        if (strcmp(scene->coordinate[i].name, "z") == 0) {
            velocity[i] = 1;
        }
    }
    return 2 * (scene->energy(robot, position, velocity) - rest) * STANCE_GRAVITY;
}

static bool open_loop(struct report *r, stance_message *message)
{
    const stance_scene *scene = r->scenario->scene;
    const struct scenario_values *values = &r->scenario->base;

    if (!resolve_equilibrium(scene, values, r->model, &r->equilibrium, message)) {
        return false;
    }
    if (!scene->linearise) {
        snprintf(message->text, sizeof message->text, "the scene %s has no linearisation",
                 scene->name);
        return false;
    }
    r->weight = weight_of(scene, r->model, r->equilibrium.position);
    stance_error error = scene->linearise(r->model, &r->equilibrium, r->A, r->B);
    if (error != STANCE_OK) {
        return refuse(message, "linearisation", error);
    }
    error = stance_eigenvalues(r->states, r->A, r->open_re, r->open_im);
    if (error == STANCE_OK) {
        error = stance_kalman(r->states, r->inputs, r->A, r->B, r->singular, &r->rank);
    }
    return error == STANCE_OK || refuse(message, "eigenvalues and Kalman rank", error);
}

/* K, for `hold` too: the servo written as a gain matrix. */
static bool gains(struct report *r, stance_message *message)
{
    const struct scenario_values *values = &r->scenario->base;
    const size_t bytes = (size_t)(r->inputs * r->states) * sizeof *r->K;

    r->sweeps = 0;
    r->condition = NAN;
    if (values->law == LAW_HOLD) {
        memset(r->K, 0, bytes);
        const int postures = r->states / 2;
        for (int i = 0; i < r->inputs; i++) {
            const int joint = i * r->states + postures - r->inputs + i;
            r->K[joint] = values->kp;
            r->K[joint + postures] = values->kd;
        }
        return true;
    }
    struct resolved_gains how;
    const bool good = resolve_gains(r->scenario->scene, values, r->A, r->B, r->K, &how, message);
    r->sweeps = how.sweeps;
    r->condition = how.condition;
    return good;
}

static bool closed_loop(struct report *r, stance_message *message)
{
    const int n = r->states, m = r->inputs;
    double loop[STATES * STATES];

    r->closed = r->scenario->base.law != LAW_NONE;
    if (!r->closed) {
        return true;
    }
    if (!gains(r, message)) {
        return false;
    }
    for (int i = 0; i < n; i++) {
        for (int j = 0; j < n; j++) {
            loop[i * n + j] = r->A[i * n + j];
            for (int k = 0; k < m; k++) {
                loop[i * n + j] -= r->B[i * m + k] * r->K[k * n + j];
            }
        }
    }
    stance_error error = stance_eigenvalues(n, loop, r->closed_re, r->closed_im);
    if (error == STANCE_OK) {
        error = stance_critical_sample_time(n, m, r->A, r->B, r->K, 0, LONGEST_SAMPLE_TIME,
                                            &r->critical);
    }
    return error == STANCE_OK || refuse(message, "closed loop", error);
}

/* ---- printing for people --------------------------------------------------------------------- */

static const char *state_name(const stance_scene *scene, int i, char name[32])
{
    const int p = scene->postures;
    const char *coordinate = scene->coordinate[scene->posture[i % p]].name;
    snprintf(name, 32, "%s%s", i < p ? "" : "v", coordinate);
    return name;
}

/* Rounding leaves signed dust where an exact zero belongs. */
static double dusted(double x, double scale)
{
    return fabs(x) <= 1e-12 * scale ? 0 : x;
}

static double largest(int count, const double *x)
{
    double most = 0;
    for (int i = 0; i < count; i++) {
        most = fmax(most, fabs(x[i]));
    }
    return most;
}

static void print_matrix(const struct report *r, const char *name, int rows, int columns,
                         const double *x, bool rows_are_inputs, bool columns_are_inputs)
{
    const stance_scene *scene = r->scenario->scene;
    const double scale = largest(rows * columns, x);
    char text[32];

    printf("  %-8s", name);
    for (int j = 0; j < columns; j++) {
        printf(" %12s", columns_are_inputs ? scene->actuator_name[j] : state_name(scene, j, text));
    }
    putchar('\n');
    for (int i = 0; i < rows; i++) {
        printf("  %-8s", rows_are_inputs ? scene->actuator_name[i] : state_name(scene, i, text));
        for (int j = 0; j < columns; j++) {
            printf(" %12.6g", dusted(x[i * columns + j], scale));
        }
        putchar('\n');
    }
}

static void print_complex(const char *label, int n, const double *re, const double *im)
{
    const double scale = fmax(largest(n, re), largest(n, im));
    printf("  %-16s", label);
    for (int i = 0; i < n; i++) {
        const double real = dusted(re[i], scale), imaginary = dusted(im[i], scale);
        if (imaginary == 0) {
            printf(" %.6g", real);
        } else if (real == 0) {
            printf(" %.6gi", imaginary);
        } else {
            printf(" %.6g%+.6gi", real, imaginary);
        }
        if (i + 1 < n) {
            putchar(',');
        }
    }
    putchar('\n');
}

static void print_equilibrium(const struct report *r)
{
    const stance_scene *scene = r->scenario->scene;
    const stance_equilibrium *e = &r->equilibrium;

    printf("\nEquilibrium, standing on %s\n", scene->contact_name[e->support]);
    for (int i = 0; i < scene->coordinates; i++) {
        const stance_quantity *c = &scene->coordinate[i];
        printf("  %-8s %12.6f %-4s %s\n", c->name, e->position[i] + 0.0, c->unit, c->text);
    }
    for (int i = 0; i < scene->actuators; i++) {
        printf("  %-8s %12.6f N m  torque that holds it\n", scene->actuator_name[i],
               dusted(e->torque[i], r->weight));
    }
    printf("  %-8s %12.6f N    normal force on %s, the robot's weight\n", "force", r->weight,
           scene->contact_name[e->support]);
}

static void print_open_loop(const struct report *r)
{
    const int n = r->states;
    printf("\nLinearised about it with %s pinned: X' = A X + B u, X the departure from the\n"
           "equilibrium (rad, rad/s), u that of the torques (N m)\n",
           r->scenario->scene->contact_name[r->equilibrium.support]);
    print_matrix(r, "A", n, n, r->A, false, false);
    putchar('\n');
    print_matrix(r, "B", n, r->inputs, r->B, false, true);
    putchar('\n');
    print_complex("eigenvalues", n, r->open_re, r->open_im);
    printf("  %-16s", "Kalman matrix");
    printf(" rank %d of %d: %s\n", r->rank, n,
           r->rank == n ? "controllable, any poles can be placed"
                        : "not controllable, some motion escapes the torques");
    printf("  %-16s", "singular values");
    for (int i = 0; i < n; i++) {
        printf(" %.4g%s", r->singular[i], i + 1 < n ? "," : "\n");
    }
}

static void print_critical(const struct report *r)
{
    const double interval = r->scenario->base.sample_time;
    if (r->critical == 0) {
        puts("  critical sample time: none, the loop is unstable even in continuous time");
        return;
    }
    if (isinf(r->critical)) {
        printf("  critical sample time: above %g s\n", LONGEST_SAMPLE_TIME);
        return;
    }
    printf("  critical sample time %.6g s: held longer, the torques no longer balance\n",
           r->critical);
    if (interval > 0) {
        printf("  controller.sample_time %.6g s is %s\n", interval,
               interval < r->critical ? "below it" : "NOT below it");
    } else {
        puts("  controller.sample_time 0: the controller acts continuously");
    }
}

static void print_closed_loop(const struct report *r)
{
    const struct scenario_values *values = &r->scenario->base;
    if (!r->closed) {
        puts("\nController: none");
        return;
    }
    if (values->law == LAW_HOLD) {
        puts(
            "\nController: hold, as a gain matrix: torques = -K X, X counted from the held angles");
    } else {
        printf("\nController: state feedback, %s; torques = those of the equilibrium - K X\n",
               values->design == DESIGN_PLACE ? "robust pole placement" : "given gains");
    }
    print_matrix(r, "K", r->inputs, r->states, r->K, true, false);
    putchar('\n');
    if (r->sweeps > 0) {
        print_complex("wanted poles", r->states, values->pole_re, values->pole_im);
    }
    print_complex("closed loop", r->states, r->closed_re, r->closed_im);
    if (r->sweeps > 0) {
        printf("  %-16s %.6g, condition number of the eigenvectors, after %d sweeps\n",
               "conditioning", r->condition, r->sweeps);
    }
    print_critical(r);
}

static void print_report(const struct report *r)
{
    const struct scenario *s = r->scenario;
    const stance_scene *scene = s->scene;

    printf("%s (%s)\n", s->title[0] ? s->title : s->name, s->file);
    if (s->axes > 0) {
        puts("This is the scenario without its sweep: the base values, not those along the axes.");
    }
    printf("\nRobot that the design believes in\n");
    for (int i = 0; i < scene->robot_count; i++) {
        printf("  %-14s %10.6g %s\n", scene->robot[i].name, r->model[i], scene->robot[i].unit);
    }
    print_equilibrium(r);
    print_open_loop(r);
    print_closed_loop(r);
}

/* ---- printing for programs ------------------------------------------------------------------- */

static json_t *json_matrix(int rows, int columns, const double *x)
{
    json_t *matrix = json_array();
    for (int i = 0; i < rows; i++) {
        json_t *row = json_array();
        for (int j = 0; j < columns; j++) {
            json_array_append_new(row, json_real(x[i * columns + j]));
        }
        json_array_append_new(matrix, row);
    }
    return matrix;
}

static json_t *json_complex(int n, const double *re, const double *im)
{
    json_t *list = json_array();
    for (int i = 0; i < n; i++) {
        json_array_append_new(list, json_pack("[f, f]", re[i], im[i]));
    }
    return list;
}

static json_t *json_vector(int n, const double *x)
{
    json_t *list = json_array();
    for (int i = 0; i < n; i++) {
        json_array_append_new(list, json_real(x[i]));
    }
    return list;
}

static json_t *json_equilibrium(const struct report *r)
{
    const stance_scene *scene = r->scenario->scene;
    json_t *position = json_object(), *torque = json_object();
    for (int i = 0; i < scene->coordinates; i++) {
        json_object_set_new(position, scene->coordinate[i].name,
                            json_real(r->equilibrium.position[i]));
    }
    for (int i = 0; i < scene->actuators; i++) {
        json_object_set_new(torque, scene->actuator_name[i], json_real(r->equilibrium.torque[i]));
    }
    return json_pack("{s:s, s:o, s:o, s:f}", "support", scene->contact_name[r->equilibrium.support],
                     "position", position, "torque", torque, "normal_force", r->weight);
}

static json_t *json_controller(const struct report *r)
{
    static const char *const laws[] = {"none", "hold", "state-feedback"};
    static const char *const designs[] = {"place", "gains"};
    const struct scenario_values *values = &r->scenario->base;
    const int n = r->states;

    if (!r->closed) {
        return json_pack("{s:s}", "kind", laws[LAW_NONE]);
    }
    const bool placed = r->sweeps > 0;
    json_t *none = json_null();
    json_t *controller =
        json_pack("{s:s, s:o, s:o, s:b, s:o}", "kind", laws[values->law], "gain",
                  json_matrix(r->inputs, n, r->K), "closed_loop_eigenvalues",
                  json_complex(n, r->closed_re, r->closed_im), "stable", r->critical > 0,
                  "critical_sample_time", isfinite(r->critical) ? json_real(r->critical) : none);
    if (values->law == LAW_STATE_FEEDBACK) {
        json_object_set_new(controller, "design", json_string(designs[values->design]));
    }
    if (placed) {
        json_object_set_new(controller, "poles", json_complex(n, values->pole_re, values->pole_im));
        json_object_set_new(controller, "condition", json_real(r->condition));
        json_object_set_new(controller, "sweeps", json_integer(r->sweeps));
    }
    return controller;
}

static json_t *json_report(const struct report *r)
{
    const stance_scene *scene = r->scenario->scene;
    const int n = r->states;
    json_t *robot = json_object(), *states = json_array(), *inputs = json_array();
    char name[32];

    for (int i = 0; i < scene->robot_count; i++) {
        json_object_set_new(robot, scene->robot[i].name, json_real(r->model[i]));
    }
    for (int i = 0; i < n; i++) {
        json_array_append_new(states, json_string(state_name(scene, i, name)));
    }
    for (int i = 0; i < r->inputs; i++) {
        json_array_append_new(inputs, json_string(scene->actuator_name[i]));
    }
    return json_pack(
        "{s:s, s:s, s:s, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:{s:i, s:i, s:o}, s:o}", "scenario",
        r->scenario->file, "title", r->scenario->title, "scene", scene->name, "robot", robot,
        "equilibrium", json_equilibrium(r), "states", states, "inputs", inputs, "A",
        json_matrix(n, n, r->A), "B", json_matrix(n, r->inputs, r->B), "open_loop_eigenvalues",
        json_complex(n, r->open_re, r->open_im), "kalman", "rank", r->rank, "states", n,
        "singular_values", json_vector(n, r->singular), "controller", json_controller(r));
}

static int print_json(const struct report *r)
{
    json_t *report = json_report(r);
    if (!report || json_dumpf(report, stdout, JSON_INDENT(2) | JSON_REAL_PRECISION(17)) != 0) {
        fputs("stance design: the report could not be written\n", stderr);
        json_decref(report);
        return EXIT_IO;
    }
    putchar('\n');
    json_decref(report);
    return EXIT_DONE;
}

/* ---- the command ----------------------------------------------------------------------------- */

/* One line at the part of the scenario that is to blame: the initial equilibrium where that alone
 * already fails, else the controller. */
static int complain(const struct scenario *s, const char *text)
{
    struct scenario_values values = s->base;
    double model[STANCE_MAX_ROBOT];
    stance_equilibrium ignored;
    stance_message message;

    values.law = LAW_NONE;
    const bool controller = s->base.law == LAW_STATE_FEEDBACK &&
                            ((s->base.design_point.given && values.state_given) ||
                             resolve_equilibrium(s->scene, &values, model, &ignored, &message));
    fprintf(stderr, "%s:%d:%d: %s\n", s->file, controller ? s->controller_line : s->initial_line,
            controller ? s->controller_column : s->initial_column, text);
    return EXIT_USAGE;
}

static int design(const struct scenario *s, bool json)
{
    struct report report = {
        .scenario = s, .states = 2 * s->scene->postures, .inputs = s->scene->actuators};
    stance_message message = {""};

    if (s->scene->actuators == 0) {
        fprintf(stderr, "%s: the scene %s has no controller to design: nothing in it is actuated\n",
                s->file, s->scene->name);
        return EXIT_USAGE;
    }
    if (!open_loop(&report, &message) || !closed_loop(&report, &message)) {
        return complain(s, message.text);
    }
    if (json) {
        return print_json(&report);
    }
    print_report(&report);
    return EXIT_DONE;
}

static int run(int argc, char **argv)
{
    const char *sets[MAX_SETS], *file = NULL;
    size_t set_count = 0, json = 0, operands = 0;
    bool help = false;
    const struct option_spec specs[] = {
        {"--set", true, sets, MAX_SETS, &set_count},
        {"--json", false, NULL, 0, &json},
    };

    if (!command_options(&command_design, argc, argv, specs, sizeof specs / sizeof specs[0], &file,
                         1, &operands, &help)) {
        return EXIT_USAGE;
    }
    if (help) {
        return EXIT_DONE;
    }
    if (operands == 0) {
        fputs("stance design: a scenario is needed (stance design -h explains)\n", stderr);
        return EXIT_USAGE;
    }
    struct scenario *s = malloc(sizeof *s);
    if (!s) {
        fprintf(stderr, "stance design: %s\n", strerror(ENOMEM));
        return EXIT_IO;
    }
    int code = EXIT_USAGE;
    if (scenario_read(s, file, NULL, sets, set_count, stderr)) {
        code = design(s, json > 0);
        scenario_free(s);
    }
    free(s);
    return code;
}

const struct command command_design = {
    "design",
    "design SCENARIO [--set PATH=VALUE]... [--json]",
    "equilibrium, linearisation, eigenvalues, Kalman rank, gains, critical sample time",
    run,
    "Prints what linear control theory says about the scenario's base values; a sweep is not\n"
    "looked at. `--set` replaces a value, as everywhere.\n"
    "\n"
    "  --json   the same as JSON, with the keys\n"
    "    scenario, title, scene   strings\n"
    "    robot                    the body that the design believes in: {parameter: value}\n"
    "    equilibrium              support, position {coordinate: value},\n"
    "                             torque {actuator: N m}, normal_force (N)\n"
    "    states, inputs           names, in the order of the matrices' rows and columns\n"
    "    A, B                     rows of the linearisation X' = A X + B u\n"
    "    open_loop_eigenvalues    [[real, imaginary], ...] (1/s)\n"
    "    kalman                   rank, states, singular_values (descending)\n"
    "    controller               kind: none, hold or state-feedback; unless none\n"
    "      gain                   rows of K (actuators by states)\n"
    "      closed_loop_eigenvalues, stable\n"
    "      critical_sample_time   s; 0 when not stable; null when above 10 s\n"
    "      design                 place or gains, for state-feedback\n"
    "      poles, condition, sweeps   for place: wanted poles, conditioning of the\n"
    "                             eigenvectors, sweeps that it took\n",
};
