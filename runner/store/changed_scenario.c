/* changed_scenario.c - see adopt.h. */
#include "adopt.h"

#include "runner/base/message.h"

static bool refuse(stance_message *message, const char *file, const char *what)
{
    return complain(message, "%.90s: --force-scenario cannot change %s: begin a new file (-o)",
                    file, what);
}

static bool same_axis(const struct scenario_axis *a, const struct scenario_axis *b)
{
    bool equal = a->paths == b->paths && a->count == b->count && a->words == b->words;
    for (int k = 0; equal && k < a->paths; k++) {
        equal = strcmp(a->path[k], b->path[k]) == 0 && (a->value != NULL) == (b->value != NULL) &&
                (a->value || (a->from == b->from && a->to == b->to));
        for (size_t i = 0; equal && a->value && i < a->count; i++) {
            const double x = scenario_axis_value(a, i, k), y = scenario_axis_value(b, i, k);
            equal = x == y;
        }
    }
    return equal;
}

/* Bit for bit, of structs whose memory was zero before they were filled in. */
static bool same_bits(const void *a, const void *b, size_t size)
{
    return memcmp(a, b, size) == 0;
}

/* A design changes for some words of a sweep only: its inputs are compared, not some designs. */
static bool same_designs(const struct scenario *a, const struct scenario *b)
{
    struct scenario_values x, y;
    int k;
    const bool sampled =
        a->base.design_time == DESIGN_SAMPLED ||
        scenario_axis_of(a, offsetof(struct scenario_values, design_time), &k) != NULL;
    memcpy(&x, &a->base, sizeof x);
    memcpy(&y, &b->base, sizeof y);
    return resolve_keep_design_inputs(a->scene, &x, sampled) &&
           resolve_keep_design_inputs(b->scene, &y, sampled) && same_bits(&x, &y, sizeof x);
}

bool changed_scenario_may_follow(const struct adopted *old, const struct plan *after,
                                 stance_message *message)
{
    const char *const file = old->file;
    const struct plan *const before = &old->plan;
    const struct scenario *a = before->scenario, *b = after->scenario;
    const struct scenario_refine *x = &a->refine, *y = &b->refine;
    const bool equal = same_bits(&a->base, &b->base, sizeof a->base) && a->seed == b->seed &&
                       x->given == y->given && x->start == y->start && x->margin == y->margin &&
                       x->probes == y->probes;
    bool recorded = before->record_rows == after->record_rows &&
                    before->record_interval == after->record_interval &&
                    before->record_cases == after->record_cases;
    for (uint64_t k = 0; recorded && after->record_rows > 0 && k < after->record_cases; k++)
        recorded = plan_recorded_case(before, k) == plan_recorded_case(after, k);
    return (a->answers == b->answers || refuse(message, file, "which answers are stored")) &&
           (recorded || refuse(message, file, "which trajectories are recorded, and when")) &&
           (equal || !(x->given || y->given) ||
            refuse(message, file, "the cases of a refined map, which follow from each other")) &&
           (equal || same_designs(a, b) ||
            refuse(message, file, "what its controller designs depend on"));
}

bool changed_scenario_check_sweep(struct adopted *old, const struct scenario *scenario,
                                  stance_message *message)
{
    const char *const file = old->file;
    if (old->origin.ancestors >= STORE_MOST_ANCESTORS)
        return refuse(message, file, "a file of so many scenarios");
    if (!adopt_scenario(old, message))
        return refuse(message, file, "a scenario that this version cannot read");
    const struct doe *x = &old->scenario->sample.design, *y = &scenario->sample.design;
    const bool given = scenario->sample.given;
    /* The seed is among what its points are made from. */
    if (old->scenario->sample.given != given ||
        (given &&
         (x->method != y->method || x->count != y->count || x->factors != y->factors ||
          x->levels != y->levels || x->second_order != y->second_order || x->seed != y->seed)))
        return refuse(message, file, "sweep.sample or the seed of its points");
    bool equal =
        scenario_same_scene(old->scenario, scenario) && old->scenario->axes == scenario->axes;
    for (int k = 0; equal && k < scenario->axes; k++)
        equal = same_axis(&old->scenario->axis[k], &scenario->axis[k]);
    return equal || refuse(message, file, "the scene or the sweep");
}
