/* allowed.c - see allowed.h. */
#include "allowed.h"

#include "runner/base/message.h"

#include <math.h>
#include <stdlib.h>

bool allowed_make(struct allowed *allowed, const struct scenario *s, uint64_t index,
                  stance_message *message)
{
    struct scenario *const at = malloc(sizeof *at);
    struct design_report *const report = malloc(sizeof *report);
    const bool good = at && report;
    *allowed = (struct allowed){0};
    if (good) {
        *at = *s;
        scenario_case_values(s, index, &at->base);
        if (resolve_design(s->scene, &at->base, &allowed->design, &allowed->why)) {
            for (int i = 0; i < STANCE_MAX_ROBOT; i++)
                at->base.model[i] = NAN; /* whatever robot its controller believes in */
            if (design_plant(report, at, &allowed->why)) {
                allowed->equilibrium = report->equilibrium;
                allowed->set = design_null_set(report, &allowed->why);
            }
        }
    }
    free(report);
    free(at);
    return good || no_memory(message);
}

bool allowed_glued_in(const struct scenario *s)
{
    stance_equilibrium equilibrium;
    return resolve_equilibrium(s->scene, &s->base, NULL, &equilibrium, NULL) &&
           allowed_glued(&equilibrium);
}

void allowed_free(struct allowed *allowed)
{
    stance_null_set_free(allowed->set);
    allowed->set = NULL;
}

void allowed_state(const struct allowed *allowed, const double *position, const double *velocity,
                   double *x)
{
    const stance_equilibrium *const e = &allowed->equilibrium;
    for (int i = 0; i < e->freedoms; i++) {
        x[i] = position[e->freedom[i]] - e->position[e->freedom[i]];
        x[e->freedoms + i] = velocity[e->freedom[i]];
    }
}

bool allowed_case(const struct allowed *allowed, const struct scenario *s, uint64_t index)
{
    struct scenario_values values;
    stance_case c;
    stance_message ignored;
    double x[DESIGN_STATES];
    scenario_case_values(s, index, &values);
    if (!resolve_case(s, &values, &allowed->design, index, &c, &ignored))
        return false;
    allowed_state(allowed, c.position, c.velocity, x);
    return stance_null_set_holds(allowed->set, x);
}
