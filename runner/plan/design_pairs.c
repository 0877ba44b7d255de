/* design_pairs.c - which pairs of coordinates a decoupling law can control: the condition number of
 * the matrix that it inverts at the start of the run, and over all postures.
 */
#include "design.h"

#include "runner/base/message.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { SURVEY_RESOLUTION = 40 }; /* postures along each angle */

bool design_pairs_compute(struct design_pairs *d, const struct scenario *s, stance_message *message)
{
    struct resolved_design design;
    stance_case start;
    int first, second;

    memset(d, 0, sizeof *d);
    d->scenario = s;
    if (!resolve_design(s->scene, &s->base, &design, message) ||
        !resolve_case(s->scene, &s->base, &design, s->seed, 0, &start, message))
        return false;
    while (d->count < STANCE_MAX_PAIRS && stance_pair(s->scene, d->count, &first, &second))
        d->count++;
    d->singular = !resolve_pair(s->scene, &start, &d->complaint);
    stance_error error = STANCE_OK;
    for (int p = 0; error == STANCE_OK && p < d->count; p++)
        error = stance_pair_condition(s->scene, start.robot, start.position, p, &d->at_start[p]);
    if (error == STANCE_OK)
        error = stance_pair_survey(s->scene, start.robot, SURVEY_RESOLUTION, d->count, d->report);
    if (error != STANCE_OK)
        complain(message, "pairs of coordinates: %s", stance_error_text(error));
    return error == STANCE_OK;
}

static const char *pair_name(const struct design_pairs *d, int pair, char name[SCENARIO_NAME])
{
    int first = 0, second = 0;
    stance_pair(d->scenario->scene, pair, &first, &second);
    snprintf(name, SCENARIO_NAME, "%s-%s", d->scenario->scene->coordinate[first].name,
             d->scenario->scene->coordinate[second].name);
    return name;
}

static bool is_used(const struct design_pairs *d, int pair)
{
    int used;
    memcpy(&used, scenario_law_value(&d->scenario->base, "decoupling", "controlled"), sizeof used);
    return pair == used;
}

void design_pairs_print(const struct design_pairs *d)
{
    char name[SCENARIO_NAME];
    printf("Pairs of coordinates under the decoupling law (* the scenario's)\n"
           "  The law inverts the matrix G that takes torques to the accelerations of the pair.\n"
           "  Where its condition number (SI units) is above %.0e the inverse is damped and the\n"
           "  sample counts as degraded.\n\n"
           "                 condition number of G   postures where\n"
           "    pair         at start    at best     it is damped    singular\n",
           STANCE_ILL_CONDITIONED);
    for (int p = 0; p < d->count; p++) {
        char start[32];
        snprintf(start, sizeof start, isfinite(d->at_start[p]) ? "%.3g" : "singular",
                 d->at_start[p]);
        printf("  %c %-11s  %-10s  %-9.3g   %8.2g %%      %s\n", is_used(d, p) ? '*' : ' ',
               pair_name(d, p, name), start, d->report[p].best, 100 * d->report[p].ill_conditioned,
               d->report[p].singular ? "on a surface of postures" : "nowhere");
    }
}

json_t *design_pairs_json(const struct design_pairs *d)
{
    char name[SCENARIO_NAME];
    json_t *pairs = json_array();
    for (int p = 0; p < d->count; p++) {
        json_t *start = isfinite(d->at_start[p]) ? json_real(d->at_start[p]) : json_null();
        json_array_append_new(
            pairs, json_pack("{s:s, s:b, s:o, s:f, s:f, s:b}", "pair", pair_name(d, p, name),
                             "controlled", is_used(d, p), "condition_at_start", start,
                             "best_condition", d->report[p].best, "damped_share",
                             d->report[p].ill_conditioned, "singular", d->report[p].singular));
    }
    return json_pack("{s:s, s:s, s:s, s:o}", "scenario", d->scenario->name, "title",
                     d->scenario->title, "scene", d->scenario->scene->name, "pairs", pairs);
}
