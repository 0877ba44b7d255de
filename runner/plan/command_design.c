/* command_design.c - `stance design`: what control theory says about a scenario before any case of
 * it runs.
 */
#include "asked.h"
#include "design.h"
#include "standing.h"

#include "runner/base/message.h"
#include "runner/base/say.h"

#include <stdio.h>

extern const struct command command_design; /* below */

struct request {
    struct asked asked;
    bool json;
};

static int print(json_t *facts, bool json, const char *text)
{
    if (say_facts(facts, json, text, stdout))
        return EXIT_DONE;
    fputs("stance design: the report could not be written\n", stderr);
    return EXIT_IO;
}

/* ---- the command ----------------------------------------------------------------------------- */

/* One line at the part of the scenario that is to blame: the initial equilibrium where that alone
 * already fails, else the controller. */
static int report_at(const struct scenario *s, const char *text)
{
    struct scenario_values values = s->base;

    values.law = 0;
    const bool controller = scenario_law(&s->base)->designed &&
                            ((s->base.design_point.given && values.state_given) ||
                             resolve_equilibrium(s->scene, &values, NULL, NULL, NULL));
    int line = 1, column = 1;
    if (!scenario_place(s, text, &line, &column))
        scenario_place(s, controller ? "controller:" : "initial:", &line, &column);
    fprintf(stderr, "%s:%d:%d: %s\n", s->file, line, column, text);
    return EXIT_USAGE;
}

/* A decoupling law has no linear design: what there is to know is where it is singular. */
static int design_decoupling(const struct scenario *s, bool json)
{
    stance_message singular = {""}, message = {""};
    json_t *const facts = design_selections(s, &singular, &message);
    if (!facts)
        return report_at(s, message.text);
    const int code = print(facts, json, design_selections_text);
    fflush(stdout);
    return code == EXIT_DONE && singular.text[0] ? report_at(s, singular.text) : code;
}

static int design(const struct scenario *s, void *request)
{
    const bool json = ((const struct request *)request)->json;
    struct design_report report;
    stance_message message = {""};

    if (s->scene->actuators == 0) {
        fprintf(stderr, "%s: the scene %s has no controller to design: nothing in it is actuated\n",
                s->file, s->scene->name);
        return EXIT_USAGE;
    }
    if (scenario_law(&s->base) == stance_law_find("decoupling"))
        return design_decoupling(s, json);
    if (!design_compute(&report, s, &message)) {
        standing_ranges(s, &s->base, &message);
        return report_at(s, message.text);
    }
    return print(design_facts(&report), json, design_text);
}

static int run(int argc, char **argv)
{
    struct request request = {.json = false};
    return asked_run(&command_design, argc, argv, design, &request);
}

static const struct option options[] = {
    {.rows = asked_options},
    {OPTION_TIME_LIMIT},
    {OPTION_JSON(struct request, json)},
    {0},
};

const struct command command_design = {
    "design",
    "equilibrium, linearisation, Kalman rank, gains, poles, critical sample time, safe set",
    run,
    options,
    "Prints what linear control theory says about the scenario's base values; a sweep is not "
    "looked at.\n",
    "    scenario, title, scene   strings\n"
    "    robot                    the body that the design believes in: {parameter: value}\n"
    "    ground                   {slope (rad), gravity (m/s^2)} that it believes in\n"
    "    equilibrium              support, position {coordinate: value}, torque {actuator: N m, "
    "N}, normal_force (N)\n"
    "    states, inputs           names, in the order of the matrices' rows and columns\n"
    "    A, B                     rows of the linearisation X' = A X + B u\n"
    "    open_loop_eigenvalues    [[real, imaginary], ...] (1/s)\n"
    "    kalman                   rank, states, singular_values (descending)\n"
    "    allowed                  what linear theory allows any controller with these torques, "
    "while the contacts stand: unstable_modes [[re, im], ...], unreached_modes (no torque moves "
    "them and they do not decay: a state with a part in one has reach 0), glued (several contacts "
    "carry, and the bound does not know where their centre of pressure may be), low, high {state "
    "alone: reach}, null: no end; null where a torque has no limit or does not hold the "
    "equilibrium\n"
    "    controller               kind: none, hold, state-feedback or bimodal-feedback; unless "
    "none\n"
    "      gain                   rows of K (actuators by states)\n"
    "      closed_loop_eigenvalues    of the continuous loop\n"
    "      sampled_loop           sample_time, delay, lag, eigenvalues (z), spectral_radius; of a "
    "stable one critical_delay (samples, null: above 16) and critical_lag (s, null: above 10) at "
    "this sample time, wander {state: rms under the scenario's noise}; null where the controller "
    "acts continuously\n"
    "      stable                 as the controller acts: sampled_loop, or continuously\n"
    "      critical_sample_time   s, without a delay; 0 when the continuous loop is not stable; "
    "null when above 10 s\n"
    "      critical_sample_time_delayed   s, torques acting one sample late, or as many as\n"
    "                             the scenario says\n"
    "      design, design_time    as in the scenario, of gains that are designed\n"
    "      poles, weights         what was asked for, as [[real, imaginary], ...] and {states, "
    "torques}\n"
    "      condition, sweeps      for place: conditioning of the eigenvectors, sweeps\n"
    "      beyond                 of bimodal-feedback: normal and push of its plane, and the gain "
    "and closed_loop_eigenvalues beyond it\n"
    "      lyapunov               null without one (a loop that is late, or not stable): P of V = "
    "X' P X, which falls by sum (X/tolerance)^2 a second (sampled: a sample), tolerances those of "
    "stop.settle; level: the largest c for which, to first order, V <= c keeps within torque "
    "limits, friction cone, contact and plane; binding: which of them stops it; alone, extent "
    "{state: reach, rad and rad/s}: with the other states 0, and free\n"
    "\n"
    "With controller.kind decoupling it prints instead for each selection of coordinates where "
    "the law is singular; as JSON: scenario, title, scene and\n"
    "    selections               [{coordinates, controlled (is it the scenario's?), "
    "condition_at_start (null: singular), best_condition, damped_share (of all postures), "
    "singular}, ...]\n",
};
