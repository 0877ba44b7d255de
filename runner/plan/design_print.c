/* design_print.c - the report of `stance design` for people. */
#include "allowed.h"
#include "design.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Rounding leaves signed dust where an exact zero belongs. */
static double dusted(double x, double scale)
{
    return fabs(x) <= 1e-12 * scale ? 0 : x;
}

static double largest(int count, const double *x)
{
    double most = 0;
    for (int i = 0; i < count; i++)
        most = fmax(most, fabs(x[i]));
    return most;
}

/* ---- units ----------------------------------------------------------------------------------- */

static bool slides(const stance_scene *scene, int coordinate)
{
    return strcmp(scene->coordinate[coordinate].unit, "m") == 0;
}

static const char *state_unit(const struct design_report *r, int i)
{
    const int p = r->equilibrium.freedoms;
    const bool slide = slides(r->scenario->scene, r->equilibrium.freedom[i % p]);
    return i < p ? (slide ? "m" : "rad") : slide ? "m/s" : "rad/s";
}

static const char *state_units(const struct design_report *r)
{
    int some = 0;
    for (int i = 0; i < r->equilibrium.freedoms; i++)
        some += slides(r->scenario->scene, r->equilibrium.freedom[i]);
    return some == 0                         ? "rad, rad/s"
           : some == r->equilibrium.freedoms ? "m, m/s"
                                             : "rad, m and their rates";
}

/* What actuators give, forces on what slides. */
static const char *input_units(const struct design_report *r)
{
    const stance_scene *const scene = r->scenario->scene;
    int some = 0;
    for (int i = 0; i < r->inputs; i++)
        some += slides(scene, scene->actuated[i]);
    return some == 0           ? "torques (N m)"
           : some == r->inputs ? "forces (N)"
                               : "torques (N m) and forces (N)";
}

/* ---- its parts ------------------------------------------------------------------------------- */

static void print_matrix(const struct design_report *r, const char *name, int rows, int columns,
                         const double *x, bool rows_are_inputs, bool columns_are_inputs)
{
    const stance_scene *scene = r->scenario->scene;
    const double scale = largest(rows * columns, x);
    char text[SCENARIO_NAME];

    printf("  %-8s", name);
    for (int j = 0; j < columns; j++) {
        printf(" %12s",
               columns_are_inputs ? scene->actuator_name[j] : design_state_name(r, j, text));
    }
    putchar('\n');
    for (int i = 0; i < rows; i++) {
        printf("  %-8s", rows_are_inputs ? scene->actuator_name[i] : design_state_name(r, i, text));
        for (int j = 0; j < columns; j++)
            printf(" %12.6g", dusted(x[i * columns + j], scale));
        putchar('\n');
    }
}

static void print_complex(const char *label, int n, const double *re, const double *im)
{
    const double scale = fmax(largest(n, re), largest(n, im));
    printf("  %-16s", label);
    for (int i = 0; i < n; i++) {
        const double real = dusted(re[i], scale), imaginary = dusted(im[i], scale);
        if (imaginary == 0)
            printf(" %.6g", real);
        else if (real == 0)
            printf(" %.6gi", imaginary);
        else
            printf(" %.6g%+.6gi", real, imaginary);
        if (i + 1 < n)
            putchar(',');
    }
    putchar('\n');
}

static void print_equilibrium(const struct design_report *r)
{
    const stance_scene *scene = r->scenario->scene;
    const stance_equilibrium *e = &r->equilibrium;
    const double scale = fmax(r->normal, largest(scene->actuators, e->torque)),
                 slope = r->model[STANCE_ROBOT_SLOPE], gravity = r->model[STANCE_ROBOT_GRAVITY];
    char supports[STANCE_MAX_CONTACTS * 40];

    design_supports(scene, e, supports, sizeof supports);
    printf("\nEquilibrium%s%s\n", e->supports ? ", standing on " : "", supports);
    for (int i = 0; i < scene->coordinates; i++) {
        const stance_quantity *c = &scene->coordinate[i];
        printf("  %-8s %12.6f %-4s %s\n", c->name, e->position[i] + 0.0, c->unit, c->text);
    }
    for (int i = 0; i < scene->actuators; i++) {
        const bool slide = slides(scene, scene->actuated[i]);
        printf("  %-8s %12.6f %-4s %s that holds it\n", scene->actuator_name[i],
               dusted(e->torque[i], scale), slide ? "N" : "N m", slide ? "force" : "torque");
    }
    if (e->supports)
        printf("  %-8s %12.6f N    normal force on %s, the robot's weight%s\n", "force", r->normal,
               supports, slope == 0 ? "" : " across the slope");
    /* What the design believes of the ground and the world, where that is not the usual. */
    if (slope != 0)
        printf("  %-8s %12.6f rad  of the ground, positive: +x is downhill\n", "slope", slope);
    if (gravity != STANCE_GRAVITY)
        printf("  %-8s %12.6f m/s^2, of the world\n", "gravity", gravity);
    if (r->remark.text[0])
        printf("  %s\n", r->remark.text);
}

static void print_open_loop(const struct design_report *r)
{
    const int n = r->states;
    char supports[STANCE_MAX_CONTACTS * 40];
    printf("\nLinearised about it%s%s%s: X' = A X + B u, X the departure from the\n"
           "equilibrium (%s), u that of the %s\n",
           r->equilibrium.supports ? " with " : "",
           design_supports(r->scenario->scene, &r->equilibrium, supports, sizeof supports),
           r->equilibrium.supports ? " pinned" : "", state_units(r), input_units(r));
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
    for (int i = 0; i < n; i++)
        printf(" %.4g%s", r->singular[i], i + 1 < n ? "," : "\n");
}

static void print_allowed(const struct design_report *r)
{
    const struct design_allowed *const allowed = &r->allowed;
    char state[SCENARIO_NAME];
    puts("\nWhat linear theory allows any controller with these torques, while the contacts stand");
    if (!allowed->exists) {
        printf("  not known: %s\n", allowed->absent.text);
        return;
    }
    if (allowed_glued(&r->equilibrium))
        puts("  (" ALLOWED_GLUED ")");
    if (allowed->modes == 0 && allowed->unreached == 0) {
        puts("  everything: no mode is unstable");
        return;
    }
    if (allowed->modes > 0)
        print_complex("unstable modes", allowed->modes, allowed->re, allowed->im);
    if (allowed->unreached > 0) {
        print_complex("no torque moves", allowed->unreached, allowed->unreached_re,
                      allowed->unreached_im);
        puts(
            "                   these modes do not decay: a state with a part in one has no reach");
    }
    printf("  %-18s %14s %14s\n", "reach", "down to", "up to");
    for (int i = 0; i < r->states; i++)
        if (isinf(allowed->reach[1][i]))
            printf("  %-18s %14s %14s\n", design_state_name(r, i, state), "no end", "no end");
        else
            printf("  %-18s %14.6g %14.6g %s\n", design_state_name(r, i, state),
                   allowed->reach[0][i], allowed->reach[1][i], state_unit(r, i));
}

static void print_critical(const char *what, double T)
{
    if (isinf(T))
        printf("  %-18s above %g s\n", what, DESIGN_LONGEST);
    else
        printf("  %-18s %.6g s\n", what, T);
}

/* ", acting 2 samples late", or nothing. Returns buffer. */
const char *design_late(int delay, const char *verb, char buffer[64])
{
    if (delay == 0)
        buffer[0] = '\0';
    else if (delay == 1)
        snprintf(buffer, 64, ", %sa sample late", verb);
    else
        snprintf(buffer, 64, ", %s%d samples late", verb, delay);
    return buffer;
}

/* How much worse actuators may be, and what noise does. */
static void print_margins(const struct design_report *r)
{
    char state[SCENARIO_NAME];
    const bool above = r->delay_margin >= STANCE_MAX_DELAY;
    printf("  %-18s %s%d samples at this sample time\n", "critical delay", above ? "above " : "",
           above ? STANCE_MAX_DELAY : r->delay_margin + 1);
    print_critical("critical lag", r->lag_margin);
    if (!r->noisy)
        return;
    puts("  noise makes states wander by (rms, to first order, without limits)");
    for (int i = 0; i < r->states; i++)
        printf("    %-16s %.4g %s\n", design_state_name(r, i, state), r->wander[i],
               state_unit(r, i));
}

/* The loop as it is sampled, and how slowly it may be. */
static void print_sampled(const struct design_report *r)
{
    const struct scenario_values *const values = &r->scenario->base;
    char text[64], late[72];
    if (r->sampled) {
        printf("\nSampled every %g s, torques held in between%s\n", values->sample_time,
               design_late(r->delay, "acting ", text));
        if (r->lag > 0)
            printf("  %-18s %g s\n", "lag of actuators", r->lag);
        if (isfinite(values->torque_rate))
            puts("  the limit of the torques' rate has no part in linear theory");
        print_complex("eigenvalues z", r->sampled, r->sampled_re, r->sampled_im);
        printf("  %-16s %s: %s\n", "spectral radius", design_radius(r, 6, late),
               r->stable ? "stable" : "NOT stable");
    } else {
        puts("\nThe controller acts continuously (controller.sample_time 0).");
    }
    if (r->critical[0] == 0) {
        puts("  critical sample time: none, the loop is unstable in continuous time");
        return;
    }
    puts("  critical sample time of these gains: held longer, the torques no longer balance");
    print_critical("T*", r->critical[0]);
    snprintf(late, sizeof late, "...%s", design_late(r->delay > 1 ? r->delay : 1, "", text));
    print_critical(late, r->critical[1]);
    if (r->sampled && r->stable)
        print_margins(r);
}

static void print_set(const struct design_report *r)
{
    const struct design_set *set = &r->set;
    const struct scenario_values *values = &r->scenario->base;
    char name[64], state[SCENARIO_NAME];

    puts("\nLargest set V = X' P X <= c in which the linear picture meets no bound");
    if (!set->exists) {
        printf("  none: %s\n", set->absent);
        return;
    }
    printf("  V falls by sum (X/tolerance)^2 %s, tolerances %g rad and %g rad/s\n",
           r->sampled ? "a sample" : "a second", values->settle_angle, values->settle_rate);
    print_matrix(r, "P", r->states, r->states, set->P, false, false);
    printf("\n  %-18s %.6g\n", "c", set->level);
    printf("  %-18s %s\n", "what binds", design_bound_name(r, set->binding, name));
    printf("  %-18s %14s %14s\n", "reach", "others 0", "others free");
    for (int i = 0; i < r->states; i++) {
        printf("  %-18s %14.6g %14.6g %s\n", design_state_name(r, i, state), set->alone[i],
               set->extent[i], state_unit(r, i));
    }
}

/* A bimodal law beyond its plane. */
static void print_beyond(const struct design_report *r)
{
    double K[DESIGN_INPUTS * DESIGN_STATES];
    char state[SCENARIO_NAME];
    design_beyond(r, K);
    puts("\nBeyond the plane normal X = 1 torques are less by push (normal X - 1): gains there");
    print_matrix(r, "K + push normal", r->inputs, r->states, K, true, false);
    putchar('\n');
    for (int j = 0; j < r->states; j++)
        printf("  %-16s %14.6g 1/(%s)\n", design_state_name(r, j, state), r->plane[j],
               state_unit(r, j));
    for (int i = 0; i < r->inputs; i++)
        printf("  push, %-10s %14.6g N m\n", r->scenario->scene->actuator_name[i], r->push[i]);
    print_complex("its closed loop", r->states, r->beyond_re, r->beyond_im);
}

static void print_closed_loop(const struct design_report *r)
{
    static const char *const design[] = {
        [DESIGN_PLACE] = "robust pole placement",
        [DESIGN_PLACE_SCHUR] = "pole placement by the Schur method",
        [DESIGN_LQR] = "linear quadratic regulator",
        [DESIGN_GAINS] = "given gains",
    };
    const struct scenario_values *values = &r->scenario->base;
    if (!r->closed) {
        puts("\nController: none");
        return;
    }
    const stance_law *const law = scenario_law(values);
    const bool places =
        law->designed && (values->design == DESIGN_PLACE || values->design == DESIGN_PLACE_SCHUR);
    if (!law->designed) {
        printf(
            "\nController: %s, as a gain matrix: torques = -K X, X counted from the held angles\n",
            law->name);
    } else {
        printf("\nController: %s, %s%s;\ntorques = those of the equilibrium - K X\n",
               r->bends ? "bimodal feedback" : "state feedback", design[values->design],
               values->design != DESIGN_GAINS && values->design_time == DESIGN_SAMPLED
                   ? " for the sampled model"
                   : "");
    }
    print_matrix(r, "K", r->inputs, r->states, r->K, true, false);
    putchar('\n');
    double re[SCENARIO_MAX_POLES], im[SCENARIO_MAX_POLES];
    if (places && scenario_poles(values, re, im) == r->states)
        print_complex("wanted poles", r->states, re, im);
    else if (law->designed && values->design == DESIGN_LQR) {
        printf("  %-16s", "weights");
        for (int i = 0; i < r->states; i++)
            printf(" %.6g%s", design_weight(r, i), i + 1 < r->states ? "," : "; torques");
        for (int i = 0; i < r->inputs; i++)
            printf(" %.6g%s", values->torque_weights[i], i + 1 < r->inputs ? "," : "\n");
    }
    print_complex("closed loop", r->states, r->closed_re, r->closed_im);
    if (r->how.sweeps > 0) {
        printf("  %-16s %.6g, condition number of the eigenvectors, after %d sweeps\n",
               "conditioning", r->how.condition, r->how.sweeps);
    }
    if (r->bends)
        print_beyond(r);
    print_sampled(r);
    if (law->designed)
        print_set(r);
}

void design_print(const struct design_report *r)
{
    const struct scenario *s = r->scenario;
    const stance_scene *scene = s->scene;

    printf("%s (%s)\n", s->title[0] ? s->title : s->name, s->file);
    if (s->axes > 0)
        puts("This is the scenario without its sweep: the base values, not those along the axes.");
    printf("\nRobot that the design believes in\n");
    int width = 14;
    for (int i = 0; i < scene->robot_count; i++)
        width = (int)fmax(width, (double)strlen(scene->robot[i].name));
    for (int i = 0; i < scene->robot_count; i++) {
        const char *const unit = scene->robot[i].unit;
        const bool has = strcmp(unit, "1") != 0;
        printf("  %-*s %10.6g%s%s\n", width, scene->robot[i].name, r->model[i], has ? " " : "",
               has ? unit : "");
    }
    print_equilibrium(r);
    print_open_loop(r);
    print_allowed(r);
    print_closed_loop(r);
}
