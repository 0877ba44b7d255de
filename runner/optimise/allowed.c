/* allowed.c - starts of a candidate against the null-controllable set of its robot. */
#include "allowed.h"

#include "runner/plan/design.h"

#include <math.h>
#include <stdlib.h>

struct room {
    struct scenario one; /* with the values of one case */
    struct design_report report;
    struct resolved_design design;
    struct scenario_values values;
    stance_case c;
};

static bool holds(const struct trials *t, struct room *room, const stance_null_set *set,
                  uint64_t index)
{
    const stance_equilibrium *const e = &room->report.equilibrium;
    double x[2 * STANCE_MAX_POSTURE];
    stance_message ignored;
    scenario_case_values(t->at, index, &room->values);
    if (!resolve_case(t->at->scene, &room->values, &room->design, t->at->seed, index, &room->c,
                      &ignored))
        return false;
    for (int i = 0; i < e->freedoms; i++) {
        x[i] = room->c.position[e->freedom[i]] - e->position[e->freedom[i]];
        x[e->freedoms + i] = room->c.velocity[e->freedom[i]];
    }
    return stance_null_set_holds(set, x);
}

static double share_in(const struct trials *t, struct room *room, size_t circumstance,
                       uint64_t starts)
{
    stance_message ignored;
    uint64_t inside = 0;
    scenario_case_values(t->at, circumstance * starts, &room->one.base);
    if (!resolve_design(t->at->scene, &room->one.base, &room->design, &ignored) ||
        !design_loop(&room->report, &room->one, &ignored))
        return NAN;
    stance_null_set *const set = design_null_set(&room->report, &ignored);
    for (uint64_t i = 0; set && i < starts; i++)
        inside += holds(t, room, set, circumstance * starts + i);
    const double share = set ? (double)inside / (double)starts : NAN;
    stance_null_set_free(set);
    return share;
}

void allowed_shares(struct trials *t, double *value, uint64_t starts, double *share)
{
    struct scenario_axis *const candidate = &t->at->axis[0];
    struct scenario_axis *const sample = &t->at->axis[t->at->axes - 1];
    struct room *const room = malloc(sizeof *room);
    candidate->value = value;
    candidate->count = 1;
    sample->value = t->start[TRIALS_FRESH];
    sample->count = starts;
    if (room)
        room->one = *t->scenario;
    for (size_t c = 0; c < t->circumstances; c++)
        share[c] =
            room && scenario_law(&t->scenario->base)->designed ? share_in(t, room, c, starts) : NAN;
    free(room);
    candidate->value = NULL;
    sample->value = NULL;
}
