/* command_gait.c - `stance gait`: the cycle that a walking robot comes to, and whether it holds. */
#include "gait.h"

#include "runner/plan/asked.h"
#include "runner/plan/instruction_set.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

extern const struct command command_gait; /* below */

struct request {
    struct asked asked;
    uint64_t steps, settle, count;
    const char *path, *along;
    struct option_texts sensitivity;
    enum table_form form;
    bool settled, clock;
    struct look look;
};

static int fail(const struct scenario *s, const char *text)
{
    fprintf(stderr, "stance gait: %s: %s\n", s->file, text);
    return EXIT_USAGE;
}

static const char text[] =
    "[title:{title}\n]A gait of {steps} step{steps#s}, by {method}[.shorter:; it repeats after "
    "{repeats} already]\n\n"
    "  period       {period%.9g} s\n"
    "  step length  {step_length%.9g} m\n"
    "  speed        {speed%.6g} m/s\n\n"
    "Just after a footfall, standing on {foot}[sampled: (samples begin there)]\n"
    "[state*:  {key%-12s} {value%16.12f}\n]"
    "\nMultipliers of [steps=1:a step|{steps} steps]: the gait is [stable:stable|NOT stable]\n"
    "  modulus      multiplier                  error\n"
    "[multipliers*:  {modulus%.9f}  {.number%-26s}  {error%.1e}\n]"
    "\nOn the way\n"
    "[cost_of_transport:  cost of transport  {cost_of_transport%.4g}\n]"
    "[peak_torque:  largest torque     {peak_torque%.4g} N m\n]"
    "  friction used      {friction_used%.4g} of {friction%.4g}[.slips:; slips by "
    "{slip_distance%.3g} m]\n"
    "  the impact's       {impact_friction%.4g}\n"
    "  least normal force {least_normal_force%.4g} N\n"
    "  the foot behind leaves at {lift_speed%.3g} m/s\n"
    "  the other one comes {clearance%.3g} m high, ahead[.under:; before that {under_ground%.3g} m "
    "under the ground]\n"
    "[.clock:\nIts phase by the clock, off by up to {.clock_off%.1e}\n  {.clock}\n]"
    "[.sensitivity:\nStandard deviations where a number is drawn anew in each return, evenly\n"
    "{.sensitivity}]"
    "\nIt returns to within {residual%.1e}, after {iterations} iteration{iterations#s} of "
    "Newton.\n";

/* "PATH=FROM..TO" of an option; false: it is none, as has been told. */
static bool read_along(const char *option, const char *value, struct along *along)
{
    double ends[2];
    const bool good = option_range(value, along->path, ends);
    if (good)
        along->from = ends[0], along->to = ends[1];
    else
        fprintf(stderr, "stance gait: %s takes PATH=FROM..TO, two different numbers, not '%s'\n",
                option, value);
    return good;
}

/* What is told of a number that is drawn anew in each return. */
#define SPREAD(X)                                                                                  \
    X("path", "", as_text(along.path), "", .width = 28, .left = true, .before = "  ")              \
    X("from", "", as_number(along.from), "from", "%.6g", .width = 10)                              \
    X("to", "", as_number(along.to), "to", "%.6g", .width = 10)                                    \
    X("period", "", as_number(is.time), "period (s)", "%.3e", .width = 11)                         \
    X("step_length", "", as_number(is.length / map->steps), "step (m)", "%.3e", .width = 11)       \
    X("speed", "", as_number(is.speed), "speed (m/s)", "%.3e", .width = 12)                        \
    X("error", "", as_number(is.error), "+- part", "%.1e", .width = 8)

/* A row for each; false: it has been told why not. */
static bool spread(const struct scenario *s, const struct return_map *map, const struct gait *gait,
                   const struct option_texts *asked, struct table *t)
{
    for (size_t k = 0; k < asked->count; k++) {
        struct along along;
        struct gait_sensitivity is;
        stance_message message = {""};
        if (!read_along("--sensitivity", asked->text[k], &along))
            return false;
        if (!gait_sensitivity_find(s, map, gait, &along, &is, &message)) {
            if (message.text[0])
                fail(s, message.text);
            return false;
        }
        TABLE_FACTS(t, SPREAD(TABLE_FACT));
        table_end_row(t);
    }
    return true;
}

/* What is told of a gait, of facts_of. */
#define GAIT(X)                                                                                    \
    X("title", "", as_text(s->title[0] ? s->title : NULL))                                         \
    X("steps", "", as_whole((uint64_t)map->steps))                                                 \
    X("repeats", "", as_whole((uint64_t)repeats))                                                  \
    X("method", "", as_text(map->kernel->method->name))                                            \
    X("period", "", as_number(gait->at.time))                                                      \
    X("step_length", "", as_number(gait->at.length / map->steps))                                  \
    X("speed", "", as_number(gait->at.length / gait->at.time))                                     \
    X("foot", "", as_text(scene->contact_name[map->foot[0]]))                                      \
    X("sampled", "", as_truth(map->base.sample_every > 0 && scene->actuators > 0))                 \
    X("state", "{name: value}", as_tree(state))                                                    \
    X("multipliers", "[{re, im, modulus, error}] of conjugate ones that with im > 0",              \
      as_tree(list))                                                                               \
    X("stable", "", as_truth(gait->stable))                                                        \
    X("peak_torque", "", scene->actuators > 0 ? as_number(r->peak_torque) : as_nothing(NULL))      \
    X("friction_used", "", as_number(r->friction_used))                                            \
    X("friction", "", as_number(map->base.friction))                                               \
    X("slip_distance", "", as_number(r->slip_distance))                                            \
    X("cost_of_transport", "", as_number(margins->cost))                                           \
    X("impact_friction", "", as_number(margins->impact_friction))                                  \
    X("least_normal_force", "", as_number(margins->least_normal_force))                            \
    X("lift_speed", "", as_number(margins->lift))                                                  \
    X("clearance", "", as_number(margins->clearance))                                              \
    X("clock", "", as_tree(clock))                                                                 \
    X("under_ground", "", as_number(margins->under))                                               \
    X("residual", "", as_number(gait->residual))                                                   \
    X("iterations", "", as_whole((uint64_t)gait->iterations))

static const struct say_key spread_keys[] = {SPREAD(TABLE_KEY){0}};
static const struct say_key gait_keys[] = {
    GAIT(TABLE_KEY){"sensitivity", "", spread_keys},
    {"rows", "with --along there are title, path, stopped and these alone", along_keys},
    {0},
};

static json_t *facts_of(const struct scenario *s, const struct return_map *map,
                        const struct gait *gait, const struct gait_margins *margins, bool told)
{
    const stance_scene *const scene = map->scene;
    const stance_result *const r = &gait->at.result;
    const int repeats = gait_repeats(map, gait);
    double position[STANCE_MAX_COORDINATES], velocity[STANCE_MAX_COORDINATES];
    json_t *const state = json_object(), *const list = json_array(),
                  *const clock = isnan(margins->clock_off) ? NULL : json_array();
    char name[STANCE_NAME + 2], number[64];
    return_map_state(map, &gait->from, position, velocity);
    for (int rate = 0; rate < 2; rate++)
        for (int j = 0; j < scene->postures; j++) {
            const int k = scene->posture[j];
            snprintf(name, sizeof name, "%s%s", rate ? "v" : "", scene->coordinate[k].name);
            table_put(state, name, as_number(rate ? velocity[k] : position[k]));
        }
    for (int i = 0; i < map->n; i++) {
        if (gait->im[i] < 0)
            continue;
        snprintf(number, sizeof number, gait->im[i] > 0 ? "%.9f +- %.9fi" : "%.9f", gait->re[i],
                 gait->im[i]);
        TABLE_APPEND(list, {"re", as_number(gait->re[i])}, {"im", as_number(gait->im[i])},
                     {"modulus", as_number(hypot(gait->re[i], gait->im[i]))},
                     {"error", as_number(gait->error[i])}, {".number", as_text(number)});
    }
    for (int i = 0; clock && i < STANCE_MAX_COEFFICIENTS; i++)
        table_append(clock, as_number(margins->clock[i]));
    json_t *const facts = TABLE_OBJECT(
        GAIT(TABLE_MEMBER){".shorter", as_truth(repeats < map->steps)},
        {".slips", as_truth(r->slip_distance > 1e-6)}, {".under", as_truth(margins->under > 0)},
        {".clock_off", as_number(margins->clock_off)});
    for (int i = 0; told && clock && i < STANCE_MAX_COEFFICIENTS; i++)
        say_add(facts, ".clock", "%s%.9g%s", i > 0 ? ", " : "controller.phase.clock=[",
                margins->clock[i], i + 1 == STANCE_MAX_COEFFICIENTS ? "]" : "");
    return facts;
}

/* The scenario's text, begun on the gait. */
static int write_scenario(const struct scenario *s, const char *path, const struct return_map *map,
                          const struct gait *gait)
{
    static const char *const drop[] = {"initial", "sweep", "optimise"};
    char *const set = return_map_initial(map, &gait->from, 0);
    char *const result = set ? scenario_rewrite(s->text, drop, sizeof drop / sizeof *drop,
                                                (const char *const[]){set}, 1)
                             : NULL;
    FILE *const out = result ? fopen(path, "w") : NULL;
    const bool written = out && fputs(result, out) >= 0;
    const bool closed = out && fclose(out) == 0;
    if (!written || !closed)
        fprintf(stderr, "stance gait: cannot write %s: %s\n", path,
                strerror(result ? errno : ENOMEM));
    else
        printf("%s\n%s", path,
               s->base.walk_steps > 0
                   ? ""
                   : "  (give it stop.walks.steps, and its runs are judged: they walk)\n");
    free(set);
    free(result);
    return written && closed ? EXIT_DONE : EXIT_IO;
}

static int say(const struct scenario *s, const struct request *request,
               const struct return_map *map, const struct gait *gait)
{
    struct table t = {0};
    struct gait_margins margins;
    stance_message message;
    int code = EXIT_USAGE;
    if (!gait_margins_find(map, gait, &margins, &message))
        fail(s, message.text);
    else if (spread(s, map, gait, &request->sensitivity, &t)) {
        json_t *const facts = facts_of(s, map, gait, &margins, request->clock);
        if (request->sensitivity.count > 0)
            table_show(facts, "sensitivity", &t, "path from to period step_length speed error", 0);
        code = say_facts(facts, request->form == TABLE_AS_JSON, text, stdout) ? EXIT_DONE : EXIT_IO;
    }
    table_free(&t);
    return code;
}

static int find(const struct scenario *s, const stance_case *c, void *asked)
{
    const struct request *const request = asked;
    const stance_kernel *const kernel =
        instruction_set_kernel(s->scene, stance_methods()[s->base.method]);
    struct return_map *const map = malloc(sizeof *map);
    struct gait *const gait = malloc(sizeof *gait);
    struct return_point from = {.time = 0};
    stance_message message = {""};
    int code = EXIT_USAGE;
    if (!map || !gait || !kernel)
        fail(s, strerror(ENOMEM));
    else if (!return_map_begin(map, c, kernel, (int)request->steps, (int)request->settle, &from,
                               &message) ||
             !gait_find(map, &from, gait, &message))
        fail(s, message.text);
    else if (request->path)
        code = write_scenario(s, request->path, map, gait);
    else
        code = say(s, request, map, gait);
    free(map);
    free(gait);
    return code;
}

static int follow(const struct scenario *s, struct request *request)
{
    struct along along = {.count = (size_t)request->count,
                          .steps = (int)request->steps,
                          .settle = (int)request->settle,
                          .settled = request->settled || request->path,
                          .look = request->path ? &request->look : NULL};
    if (!read_along("--along", request->along, &along))
        return EXIT_USAGE;
    if (request->path && (!look_place(request->path, &request->look) || !request->look.file ||
                          request->look.format[LOOK_GIF]))
        return command_usage(
            &command_gait, "-o with --along draws a picture, a file that ends in svg, png or pdf");
    return along_say(s, &along, request->form);
}

/* What is swept has the values that it has without the sweep. */
static int gait(const struct scenario *s, void *asked)
{
    struct request *const request = asked;
    if (look_given(&request->look) && !(request->along && request->path))
        return command_usage(&command_gait, "pictures are drawn by -o FILE with --along");
    if (!asked_law(s))
        return EXIT_USAGE;
    if (request->along)
        return follow(s, request);
    char *const plain = along_plain(s);
    struct scenario *const one = plain ? asked_again(s->file, plain, NULL, 0) : NULL;
    const int code = one ? asked_first(&command_gait, one, find, asked) : EXIT_USAGE;
    scenario_drop(one);
    free(plain);
    return code;
}

static int run(int argc, char **argv)
{
    struct request request = {.steps = 1, .settle = 40, .count = 11};
    look_begin(&request.look);
    return asked_run(&command_gait, argc, argv, gait, &request);
}

static const struct option options[] = {
    {.rows = asked_simulates},
    {"--steps", "COUNT", OPTION_TO(struct request, steps), .low = 1, .high = 16,
     .text = "steps after which the gait repeats, 1 by default; 2 of one that limps"},
    {"--settle", "COUNT", OPTION_TO(struct request, settle), .low = 1, .high = 10000,
     .text =
         "footfalls from the scenario's start until the search begins, 40 by default; few, where "
         "the start is near a gait that does not hold"},
    {"-o", "FILE", OPTION_TO(struct request, path), .without = "--csv --json",
     .text = "instead of the report the scenario, begun on the gait and without its sweep; with "
             "--along a picture, a file that ends in svg, png or pdf: multipliers, speed and the "
             "times of steps against the number, with what --settled has"},
    {"--along", "PATH=FROM..TO", OPTION_TO(struct request, along),
     .text = "the gait followed along a number of the scenario, and where it flips (a multiplier "
             "passes -1: steps begin to alternate) or folds (1: it ends)"},
    {"--sensitivity", "PATH=FROM..TO", OPTION_TO(struct request, sensitivity),
     .without = "-o --along",
     .text = "by how much period, length and speed vary where this number of the scenario is drawn "
             "anew in each return, evenly between the two; may be repeated"},
    {"--clock", OPTION_TO(struct request, clock), .without = "-o --along",
     .text = "the phase on the gait as a polynomial of the time since the footfall, as --set takes "
             "it in place of controller.phase.of: outputs that follow it wait for nobody"},
    {"--count", "COUNT", OPTION_TO(struct request, count), .low = 2, .high = 10000,
     .needs = "--along", .text = "values along it, 11 by default"},
    {"--settled", OPTION_TO(struct request, settled), .needs = "--along",
     .text = "after how many steps it repeats what it comes to, slightly off each gait, in the "
             "times of 16 steps after 200 footfalls; 0: in none; nothing where it falls"},
    {TABLE_CSV(struct request, form), .needs = "--along", .text = "as comma-separated values"},
    {TABLE_JSON(struct request, form), .keys = gait_keys, .text = "as JSON. Keys"},
    {.at = offsetof(struct request, look), .rows = look_drawn},
    {0},
};

const struct command command_gait = {
    "gait",
    "the cycle that a walking robot comes to: period, speed, multipliers",
    run,
    options,
    "Lets a scenario, without its sweep, walk, and looks from there for the gait that returns to "
    "itself exactly, with its multipliers: by how much a small departure has changed a step later. "
    "It holds where all are less than 1 in size.",
    "The section is the state just after a footfall, legs read as if the first one had landed. "
    "Samples of a controller begin there (the clock of a run goes on instead: the gait then locks "
    "to it, or wanders). Newton's derivative is of central differences of 1e-4; multipliers are of "
    "fourth order at 1e-3 and 3e-4, and their error is by how much these differ. method.tolerance "
    "1e-10 makes the largest good to about six digits, method event-driven to eight. Of torques at "
    "their limits the map has kinks, and errors are larger.\n"
    "Cost of transport is sum of |work| of each actuator, over weight and way. Heights of the foot "
    "that swings and normal forces are seen at the ends of time steps.\n"
    "--sensitivity tells the gait sensitivity norm of Hobbelen and Wisse (2007): standard "
    "deviations from step to step to first order in the number's, about a middle that has to be "
    "the scenario's value; the foot behind begins each return on the plane of that return, or "
    "where it stood, after a step of the ground (ground.plates={step: {footfall: 1, from: 0.1, "
    "height: 0}}, of whose height steps are independent). The error (+- part) is relative, by how "
    "much the whole range and half of it differ, with the residual's part; what changes no more "
    "than that is refused.\n"
    "Exit codes: 0 found, 2 bad use or scenario, or no such gait, 3 FILE cannot be written.",
};
