/* design_selections.c - which coordinates a decoupling law can control: the condition number of the
 * matrix that it inverts at the start of the run, and over all postures.
 */
#include "design.h"

#include "runner/base/message.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { SURVEY = 640000 }; /* matrices that are looked at: for the biped 40 postures an angle */

bool design_selections_compute(struct design_selections *d, const struct scenario *s,
                               stance_message *message)
{
    struct resolved_design design;
    stance_case start;
    int coordinate[STANCE_MAX_ACTUATORS];

    memset(d, 0, sizeof *d);
    d->scenario = s;
    if (!resolve_design(s->scene, &s->base, &design, message) ||
        !resolve_case(s->scene, &s->base, &design, s->seed, 0, &start, message))
        return false;
    while (d->count < STANCE_MAX_SELECTIONS && stance_selection(s->scene, d->count, coordinate))
        d->count++;
    d->singular = !resolve_selection(s->scene, &start, &d->complaint);
    stance_error error = STANCE_OK;
    for (int p = 0; error == STANCE_OK && p < d->count; p++)
        error =
            stance_selection_condition(s->scene, start.robot, start.position, p, &d->at_start[p]);
    if (error == STANCE_OK)
        error = stance_selection_survey(s->scene, start.robot, SURVEY, d->count, d->report);
    if (error != STANCE_OK)
        complain(message, "controller.controlled: %s", stance_error_text(error));
    return error == STANCE_OK;
}

static bool is_used(const struct design_selections *d, int selection)
{
    int used;
    memcpy(&used, scenario_law_value(&d->scenario->base, "decoupling", "controlled"), sizeof used);
    return selection == used;
}

json_t *design_selections_facts(const struct design_selections *d)
{
    const struct scenario *const s = d->scenario;
    char name[SCENARIO_NAME];
    json_t *const selections = json_array();
    int widest = (int)strlen("coordinates");
    for (int p = 0; p < d->count; p++) {
        const double start = d->at_start[p];
        scenario_selection_name(s->scene, p, name);
        widest = (int)strlen(name) > widest ? (int)strlen(name) : widest;
        json_array_append_new(
            selections,
            json_pack("{s:s, s:b, s:o?, s:o, s:f, s:f, s:b}", "coordinates", name, "controlled",
                      is_used(d, p), "condition_at_start", json_real(start), ".start",
                      isfinite(start) ? json_sprintf("%.3g", start) : json_string("singular"),
                      "best_condition", d->report[p].best, "damped_share",
                      d->report[p].ill_conditioned, "singular", d->report[p].singular));
    }
    return json_pack("{s:s, s:s, s:s, s:o, s:s, s:i, s:f}", "scenario", s->name, "title", s->title,
                     "scene", s->scene->name, "selections", selections, ".coordinates",
                     "coordinates", ".width", widest, ".ill", STANCE_ILL_CONDITIONED);
}

const char design_selections_text[] =
    "{title}\n\nCoordinates under the decoupling law (* the scenario's)\n"
    "  The law inverts the matrix G that takes torques to their accelerations. Where its\n"
    "  condition number (SI units) is above {.ill%.0e} the inverse is damped and the sample "
    "counts\n"
    "  as degraded.\n\n"
    "    {.%-*s}  condition number of G   postures where\n"
    "    {.coordinates%-*s}  at start    at best     it is damped    singular\n"
    "[selections*:  [controlled:*| ] {coordinates%-*s}  {.start%-10s}  {best_condition%-9.3g}   "
    "{damped_share*%8.2g} %      [singular:on a surface of postures|nowhere]\n]";
