/* design_facts.c - the report of `stance design`, as facts and as the text that is made of them. */
#include "allowed.h"
#include "design.h"

#include "runner/base/say.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static void put(json_t *facts, const char *key, json_t *value)
{
    json_object_set_new(facts, key, value);
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

/* The first word where all coordinates turn, the second where all slide, else the third. */
static const char *units(const stance_scene *scene, const int *coordinate, int count,
                         const char *const word[3])
{
    int some = 0;
    for (int i = 0; i < count; i++)
        some += slides(scene, coordinate[i]);
    return word[some == 0 ? 0 : some == count ? 1 : 2];
}

/* ---- vectors, matrices and complex numbers ----------------------------------------------------
 */

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

static json_t *vector(int n, const double *x)
{
    json_t *const list = json_array();
    for (int i = 0; i < n; i++)
        json_array_append_new(list, json_real(x[i]));
    return list;
}

/* Whether a matrix has the inputs along a side, or the states. */
struct sides {
    bool inputs_down, inputs_across;
};

/* With a dot before its key, for people: the names of columns behind that of the matrix, and its
 * rows under it. */
static void put_matrix(const struct design_report *r, json_t *facts, const char *key,
                       struct sides sides, const double *x)
{
    const char *const *const input = r->scenario->scene->actuator_name;
    const int rows = sides.inputs_down ? r->inputs : r->states,
              columns = sides.inputs_across ? r->inputs : r->states;
    const double scale = largest(rows * columns, x);
    char name[SCENARIO_NAME];
    json_t *const matrix = json_array();
    for (int j = 0; j < columns; j++)
        say_add(facts, key, " %12s",
                sides.inputs_across ? input[j] : design_state_name(r, j, name));
    for (int i = 0; i < rows; i++) {
        say_add(facts, key, "\n  %-8s",
                sides.inputs_down ? input[i] : design_state_name(r, i, name));
        for (int j = 0; j < columns; j++)
            say_add(facts, key, " %12.6g", dusted(x[i * columns + j], scale));
        json_array_append_new(matrix, vector(columns, x + i * columns));
    }
    put(facts, key + 1, matrix);
}

void design_put_complex(json_t *facts, const char *key, int n, const double *re, const double *im)
{
    const double scale = fmax(largest(n, re), largest(n, im));
    json_t *const list = json_array();
    for (int i = 0; i < n; i++) {
        const double real = dusted(re[i], scale), imaginary = dusted(im[i], scale);
        say_add(facts, key, "%s", i > 0 ? "," : "");
        if (real != 0 || imaginary == 0)
            say_add(facts, key, " %.6g", real);
        if (imaginary != 0)
            say_add(facts, key, real == 0 ? " %.6gi" : "%+.6gi", imaginary);
        json_array_append_new(list, json_pack("[f, f]", re[i], im[i]));
    }
    put(facts, key + 1, list);
}

/* Adds a name with its number, null where it is infinite, to an object; with a dot before its key,
 * for people, to a list of {name, is} and what `more` has of it. */
static void put_named(json_t *facts, const char *key, const char *name, double is, json_t *more)
{
    if (!json_object_get(facts, key)) {
        put(facts, key, json_array());
        put(facts, key + 1, json_object());
    }
    const bool finite = isfinite(is);
    json_t *const shown =
        json_pack("{s:s, s:o}", "name", name, "is", finite ? json_real(is) : json_string("inf"));
    json_object_update_new(shown, more);
    json_array_append_new(json_object_get(facts, key), shown);
    put(json_object_get(facts, key + 1), name, finite ? json_real(is) : json_null());
}

/* A number of each state with its unit; people see another one beside it, too. */
static void put_states(const struct design_report *r, json_t *facts, const char *key,
                       const double *x, const double *also)
{
    char name[SCENARIO_NAME];
    for (int i = 0; i < r->states; i++) {
        const double y = also ? also[i] : NAN;
        put_named(facts, key, design_state_name(r, i, name), x[i],
                  json_pack("{s:o?, s:b, s:s}", "y", isinf(y) ? json_string("inf") : json_real(y),
                            "endless", isinf(y), "unit", state_unit(r, i)));
    }
}

/* ---- its parts ------------------------------------------------------------------------------- */

static json_t *equilibrium_facts(const struct design_report *r)
{
    const stance_scene *const scene = r->scenario->scene;
    const stance_equilibrium *const e = &r->equilibrium;
    const double scale = fmax(r->normal, largest(scene->actuators, e->torque));
    char supports[STANCE_MAX_CONTACTS * 40];
    json_t *const facts =
        json_pack("{s:s}", "support", design_supports(scene, e, supports, sizeof supports));
    for (int i = 0; i < scene->coordinates; i++) {
        const stance_quantity *const c = &scene->coordinate[i];
        put_named(facts, ".position", c->name, e->position[i],
                  json_pack("{s:f, s:s, s:s}", "is", e->position[i] + 0.0, "unit", c->unit, "text",
                            c->text));
    }
    for (int i = 0; i < scene->actuators; i++)
        put_named(facts, ".torque", scene->actuator_name[i], e->torque[i],
                  json_pack("{s:f, s:b}", "is", dusted(e->torque[i], scale), "slide",
                            slides(scene, scene->actuated[i])));
    json_object_update_new(facts, json_pack("{s:f, s:b, s:s}", "normal_force", r->normal, ".stands",
                                            e->supports != 0, ".remark", r->remark.text));
    return facts;
}

static json_t *allowed_facts(const struct design_report *r)
{
    const struct design_allowed *const allowed = &r->allowed;
    if (!allowed->exists)
        return json_null();
    json_t *const facts = json_object();
    design_put_complex(facts, ".unstable_modes", allowed->modes, allowed->re, allowed->im);
    design_put_complex(facts, ".unreached_modes", allowed->unreached, allowed->unreached_re,
                       allowed->unreached_im);
    json_object_update_new(facts, json_pack("{s:b, s:b}", "glued", allowed_glued(&r->equilibrium),
                                            ".some", allowed->modes + allowed->unreached > 0));
    put_states(r, facts, ".low", allowed->reach[0], allowed->reach[1]);
    put_states(r, facts, ".high", allowed->reach[1], NULL);
    return facts;
}

static json_t *set_facts(const struct design_report *r)
{
    const struct design_set *const set = &r->set;
    char name[64];
    if (!set->exists)
        return json_null();
    json_t *const facts =
        json_pack("{s:b, s:f, s:f}", "sampled", r->sampled > 0, ".angle",
                  r->scenario->base.settle_angle, ".rate", r->scenario->base.settle_rate);
    put_matrix(r, facts, ".P", (struct sides){false, false}, set->P);
    put(facts, "level", isfinite(set->of.level) ? json_real(set->of.level) : json_null());
    put(facts, ".level", isfinite(set->of.level) ? json_real(set->of.level) : json_string("inf"));
    put(facts, "binding", json_string(design_bound_name(r, set->of.binding, name)));
    put_states(r, facts, ".alone", set->of.alone, set->of.extent);
    put_states(r, facts, ".extent", set->of.extent, NULL);
    return facts;
}

/* Of a sample time or a lag: "2 s", "above 10 s". */
static json_t *critical_text(double T)
{
    return isinf(T) ? json_sprintf("above %g s", DESIGN_LONGEST) : json_sprintf("%.6g s", T);
}

static json_t *sampled_facts(const struct design_report *r)
{
    const bool margins = r->sampled && r->stable, above = r->delay_margin >= STANCE_MAX_DELAY;
    char late[64], radius[32];
    if (!r->sampled)
        return json_null();
    json_t *const facts = json_pack("{s:f, s:i, s:f, s:s, s:b}", "sample_time",
                                    r->scenario->base.sample_time, "delay", r->delay, "lag", r->lag,
                                    ".acting", design_late(r->delay, "acting ", late), ".rated",
                                    isfinite(r->scenario->base.torque_rate));
    design_put_complex(facts, ".eigenvalues", r->sampled, r->sampled_re, r->sampled_im);
    json_object_update_new(
        facts, json_pack("{s:f, s:s, s:o, s:o?, s:n}", "spectral_radius", r->radius, ".radius",
                         design_radius(r, 6, radius), "critical_delay",
                         margins && !above ? json_integer(r->delay_margin + 1) : json_null(),
                         "critical_lag", margins ? json_real(r->lag_margin) : NULL, "wander"));
    if (margins)
        json_object_update_new(facts, json_pack("{s:o, s:o}", ".delay",
                                                above ? json_sprintf("above %d", STANCE_MAX_DELAY)
                                                      : json_sprintf("%d", r->delay_margin + 1),
                                                ".lag", critical_text(r->lag_margin)));
    if (margins && r->noisy)
        put_states(r, facts, ".wander", r->wander, NULL);
    return facts;
}

static json_t *beyond_facts(const struct design_report *r)
{
    double K[DESIGN_INPUTS * DESIGN_STATES];
    json_t *const pushes = json_object(), *const facts = json_object();
    for (int i = 0; i < r->inputs; i++)
        put(pushes, r->scenario->scene->actuator_name[i], json_real(r->push[i]));
    design_beyond(r, K);
    put_states(r, facts, ".normal", r->plane, NULL);
    json_object_update_new(facts,
                           json_pack("{s:o, s:o, s:o}", "normal", vector(r->states, r->plane),
                                     "push", vector(r->inputs, r->push), ".push", pushes));
    put_matrix(r, facts, ".gain", (struct sides){true, false}, K);
    design_put_complex(facts, ".closed_loop_eigenvalues", r->states, r->beyond_re, r->beyond_im);
    return facts;
}

/* What there is to say of a state-feedback law and its design. */
static void put_design(const struct design_report *r, json_t *facts)
{
    static const char *const designs[][2] = {
        [DESIGN_PLACE] = {"place", "robust pole placement"},
        [DESIGN_PLACE_SCHUR] = {"place-schur", "pole placement by the Schur method"},
        [DESIGN_LQR] = {"lqr", "linear quadratic regulator"},
        [DESIGN_GAINS] = {"gains", "given gains"}};
    static const char *const times[] = {"continuous", "sampled"};
    const struct scenario_values *const values = &r->scenario->base;
    const int design = values->design;
    double weights[DESIGN_STATES], re[SCENARIO_MAX_POLES], im[SCENARIO_MAX_POLES];
    put(facts, "design", json_string(designs[design][0]));
    put(facts, ".design", json_string(designs[design][1]));
    if (design != DESIGN_GAINS)
        put(facts, "design_time", json_string(times[values->design_time]));
    if (design == DESIGN_PLACE || design == DESIGN_PLACE_SCHUR) {
        const int poles = scenario_poles(values, re, im);
        design_put_complex(facts, ".poles", poles, re, im);
        put(facts, ".all_poles", json_boolean(poles == r->states));
    }
    for (int i = 0; i < r->states; i++)
        weights[i] = design_weight(r, i);
    if (design == DESIGN_LQR)
        put(facts, "weights",
            json_pack("{s:o, s:o}", "states", vector(r->states, weights), "torques",
                      vector(r->inputs, values->torque_weights)));
    if (r->how.sweeps > 0)
        json_object_update_new(
            facts, json_pack("{s:f, s:i}", "condition", r->how.condition, "sweeps", r->how.sweeps));
    if (r->bends)
        put(facts, "beyond", beyond_facts(r));
    put(facts, "lyapunov", set_facts(r));
    put(facts, ".absent", json_string(r->set.exists ? "" : r->set.absent));
}

static json_t *controller_facts(const struct design_report *r)
{
    const stance_law *const law = scenario_law(&r->scenario->base);
    char late[64];
    if (!r->closed)
        return json_pack("{s:s, s:b}", "kind", law->name, ".own", law->program);
    json_t *const facts = json_pack("{s:s}", "kind", law->name);
    put_matrix(r, facts, ".gain", (struct sides){true, false}, r->K);
    design_put_complex(facts, ".closed_loop_eigenvalues", r->states, r->closed_re, r->closed_im);
    json_object_update_new(
        facts, json_pack("{s:b, s:o, s:o?, s:o?}", "stable", r->stable, "sampled_loop",
                         sampled_facts(r), "critical_sample_time", json_real(r->critical[0]),
                         "critical_sample_time_delayed", json_real(r->critical[1])));
    if (r->critical[0] != 0)
        json_object_update_new(
            facts,
            json_pack("{s:o, s:o, s:o}", ".critical", critical_text(r->critical[0]),
                      ".critical_late", critical_text(r->critical[1]), ".late",
                      json_sprintf("...%s", design_late(r->delay > 1 ? r->delay : 1, "", late))));
    if (law->designed)
        put_design(r, facts);
    return facts;
}

/* ---- all of it ------------------------------------------------------------------------------- */

json_t *design_facts(const struct design_report *r)
{
    static const char *const state_words[] = {"rad, rad/s", "m, m/s", "rad, m and their rates"};
    static const char *const input_words[] = {"torques (N m)", "forces (N)",
                                              "torques (N m) and forces (N)"};
    const struct scenario *const s = r->scenario;
    const double slope = r->model[STANCE_ROBOT_SLOPE], gravity = r->model[STANCE_ROBOT_GRAVITY];
    json_t *const states = json_array(), *const inputs = json_array();
    char name[SCENARIO_NAME];
    /* the name of a file need not be UTF-8: JSON has null then */
    json_t *const facts = json_pack(
        "{s:o?, s:o, s:s, s:s, s:o, s:b, s:s, s:s, s:s}", "scenario", json_string(s->file), ".file",
        json_string_nocheck(s->file), "title", s->title, "scene", s->scene->name, ".name",
        json_string_nocheck(s->title[0] ? s->title : s->name), ".swept", s->axes > 0, ".units",
        units(s->scene, r->equilibrium.freedom, r->equilibrium.freedoms, state_words), ".inputs",
        units(s->scene, s->scene->actuated, r->inputs, input_words), ".absent",
        r->allowed.absent.text);
    int width = 14;
    for (int i = 0; i < s->scene->robot_count; i++) {
        const stance_quantity *const of = &s->scene->robot[i];
        width = (int)fmax(width, (double)strlen(of->name));
        put_named(facts, ".robot", of->name, r->model[i],
                  json_pack("{s:s}", "unit", strcmp(of->unit, "1") == 0 ? "" : of->unit));
    }
    put(facts, ".width", json_integer(width));
    for (int i = 0; i < r->states; i++)
        json_array_append_new(states, json_string(design_state_name(r, i, name)));
    for (int i = 0; i < r->inputs; i++)
        json_array_append_new(inputs, json_string(s->scene->actuator_name[i]));
    json_object_update_new(
        facts, json_pack("{s:{s:f, s:f, s:b}, s:o, s:o, s:o}", "ground", "slope", slope, "gravity",
                         gravity, ".unusual", gravity != STANCE_GRAVITY, "equilibrium",
                         equilibrium_facts(r), "states", states, "inputs", inputs));
    put_matrix(r, facts, ".A", (struct sides){false, false}, r->A);
    put_matrix(r, facts, ".B", (struct sides){false, true}, r->B);
    design_put_complex(facts, ".open_loop_eigenvalues", r->states, r->open_re, r->open_im);
    json_object_update_new(facts, json_pack("{s:{s:i, s:i, s:o, s:b}, s:o, s:o}", "kalman", "rank",
                                            r->rank, "states", r->states, "singular_values",
                                            vector(r->states, r->singular), ".full",
                                            r->rank == r->states, "allowed", allowed_facts(r),
                                            "controller", controller_facts(r)));
    return facts;
}

const char design_text[] =
    "{.name} ({.file})\n"
    "[.swept:This is the scenario without its sweep: the base values, not those along the axes.\n]"
    "\nRobot that the design believes in\n"
    "[.robot*:  {name%-*s} {is%10.6g}[unit: {unit}]\n]"
    "[equilibrium:\nEquilibrium[.stands:, standing on ]{support}\n"
    "[.position*:  {name%-8s} {is%12.6f} {unit%-4s} {text}\n]"
    "[.torque*:  {name%-8s} {is%12.6f} [slide:N    force|N m  torque] that holds it\n]"
    "[.stands:  force    {normal_force%12.6f} N    normal force on {support}, the robot's weight"
    "[ground/slope: across the slope]\n]"
    /* what the design believes of the ground and the world, where that is not the usual */
    "[ground/slope:  slope    {ground/slope%12.6f} rad  of the ground, positive: +x is downhill\n]"
    "[ground/.unusual:  gravity  {ground/gravity%12.6f} m/s^2, of the world\n]"
    "[.remark:  {.remark}\n]"
    "\nLinearised about it[.stands: with ]{support}[.stands: pinned]]: X' = A X + B u, X the "
    "departure from the\nequilibrium ({.units}), u that of the {.inputs}\n"
    "  A       {.A}\n\n  B       {.B}\n\n  eigenvalues     {.open_loop_eigenvalues}\n"
    "[kalman:  Kalman matrix    rank {rank} of {states}: [.full:controllable, any poles can be "
    "placed|not controllable, some motion escapes the torques]\n"
    "  singular values  [singular_values*, :{value%.4g}]\n]"
    "\nWhat linear theory allows any controller with these torques, while the contacts stand\n"
    "[allowed:[glued:  (" ALLOWED_GLUED ")\n]"
    "[unstable_modes:  unstable modes  {.unstable_modes}\n]"
    "[unreached_modes:  no torque moves {.unreached_modes}\n"
    "                   these modes do not decay: a state with a part in one has no reach\n]"
    "[.some:  reach                     down to          up to\n"
    "[.low*:  {name%-18s} [endless:        no end         no end|{is%14.6g} {y%14.6g} {unit}]\n]"
    "|  everything: no mode is unstable\n]"
    "|  not known: {.absent}\n]"
    "\nController: [controller:"
    "[!gain:[.own:a law in C that linear theory cannot know: it remembers, or is not trusted "
    "yet|none]\n|"
    "[design:[beyond:bimodal|state] feedback, {.design}[design_time=sampled: for the sampled "
    "model];"
    "\ntorques = those of the equilibrium - K X\n"
    "|{kind}, as a gain matrix: torques = -K X, X counted from the [kind=program:target, by "
    "differences|held angles]\n]"
    "  K       {.gain}\n\n"
    "[.all_poles:  wanted poles    {.poles}\n]"
    "[weights:  weights          [states*, :{value%.6g}]; torques [torques*, :{value%.6g}]\n]"
    "  closed loop     {.closed_loop_eigenvalues}\n"
    "[sweeps:  conditioning     {condition%.6g}, condition number of the eigenvectors, after "
    "{sweeps} sweeps\n]"
    "[beyond:\nBeyond the plane normal X = 1 torques are less by push (normal X - 1): gains there\n"
    "  K + push normal{.gain}\n\n"
    "[.normal*:  {name%-16s} {is%14.6g} 1/({unit})\n]"
    "[.push*:  push, {key%-10s} {value%14.6g} N m\n]"
    "  its closed loop {.closed_loop_eigenvalues}\n]"
    "[sampled_loop:\nSampled every {sample_time%g} s, torques held in between{.acting}\n"
    "[lag:  lag of actuators   {lag%g} s\n]"
    "[.rated:  the limit of the torques' rate has no part in linear theory\n]"
    "  eigenvalues z   {.eigenvalues}\n"
    "  spectral radius  {.radius}: [stable:stable|NOT stable]\n"
    "|\nThe controller acts continuously (controller.sample_time 0).\n]"
    "[.critical:  critical sample time of these gains: held longer, the torques no longer balance\n"
    "  T*                 {.critical}\n  {.late%-18s} {.critical_late}\n"
    "[sampled_loop/.delay:  critical delay     {sampled_loop/.delay} samples at this sample time\n"
    "  critical lag       {sampled_loop/.lag}\n]"
    "[sampled_loop/.wander:  noise makes states wander by (rms, to first order, without limits)\n"
    "[sampled_loop/.wander*:    {name%-16s} {is%.4g} {unit}\n]]"
    "|  critical sample time: none, the loop is unstable in continuous time\n]"
    "[design:\nLargest set V = X' P X <= c in which the linear picture meets no bound\n"
    "[lyapunov:  V falls by sum (X/tolerance)^2 [sampled:a sample|a second], tolerances "
    "{.angle%g} rad and {.rate%g} rad/s\n"
    "  P       {.P}\n\n"
    "  c                  {.level%.6g}\n"
    "  what binds         {binding}\n"
    "  reach                    others 0    others free\n"
    "[.alone*:  {name%-18s} {is%14.6g} {y%14.6g} {unit}\n]"
    "|  none: {.absent}\n]]]]";
