/* design_selections.c - which coordinates a decoupling law can control: the condition number of the
 * matrix that it inverts at the start of the run, and over all postures.
 */
#include "design.h"

#include "runner/base/message.h"

#include <math.h>
#include <string.h>

enum { SURVEY = 640000 }; /* matrices that are looked at: for the biped 40 postures an angle */

/* Condition numbers at the start, INFINITY where it is singular there, and over all postures, of
 * the first `count` selections. */
static bool look(const struct scenario *s, const stance_case *start, int count, double *at_start,
                 stance_selection_report *report, stance_message *message)
{
    stance_error error = STANCE_OK;
    for (int p = 0; error == STANCE_OK && p < count; p++)
        error =
            stance_selection_condition(s->scene, start->robot, start->position, p, &at_start[p]);
    if (error == STANCE_OK)
        error = stance_selection_survey(s->scene, start->robot, SURVEY, count, report);
    return error == STANCE_OK ||
           complain(message, "controller.controlled: %s", stance_error_text(error));
}

json_t *design_selections(const struct scenario *s, stance_message *singular,
                          stance_message *message)
{
    double at_start[STANCE_MAX_SELECTIONS] = {0};
    stance_selection_report report[STANCE_MAX_SELECTIONS] = {0};
    struct resolved_design design;
    stance_case start;
    int coordinate[STANCE_MAX_ACTUATORS], count = 0, used, widest = (int)strlen("coordinates");
    char name[SCENARIO_NAME];
    if (!resolve_design(s->scene, &s->base, &design, message) ||
        !resolve_case(s, &s->base, &design, 0, &start, message))
        return NULL;
    while (count < STANCE_MAX_SELECTIONS && stance_selection(s->scene, count, coordinate))
        count++;
    resolve_selection(s->scene, &start, singular);
    if (!look(s, &start, count, at_start, report, message))
        return NULL;
    memcpy(&used, scenario_law_value(&s->base, "decoupling", "controlled"), sizeof used);
    json_t *const selections = json_array();
    for (int p = 0; p < count; p++) {
        scenario_selection_name(s->scene, p, name);
        widest = (int)strlen(name) > widest ? (int)strlen(name) : widest;
        json_array_append_new(selections,
                              json_pack("{s:s, s:b, s:o?, s:o, s:f, s:f, s:b}", "coordinates", name,
                                        "controlled", p == used, "condition_at_start",
                                        json_real(at_start[p]), ".start",
                                        isfinite(at_start[p]) ? json_sprintf("%.3g", at_start[p])
                                                              : json_string("singular"),
                                        "best_condition", report[p].best, "damped_share",
                                        report[p].ill_conditioned, "singular", report[p].singular));
    }
    return json_pack("{s:o?, s:s, s:s, s:o, s:s, s:i, s:f}", "scenario", json_string(s->name),
                     "title", s->title, "scene", s->scene->name, "selections", selections,
                     ".coordinates", "coordinates", ".width", widest, ".ill",
                     STANCE_ILL_CONDITIONED);
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
