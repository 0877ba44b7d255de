/* page_designs.c - controllers of a page: those of its file.
 *
 * A page has no numerical libraries to place poles with. A design of the view that has the inputs
 * of one of the file's is that one. Where only the start has moved, because the robot or the
 * ground has while the model that the controller believes in has not, the controller is the file's
 * and the start is solved for. Laws that are not designed, and gains that are given, need neither.
 * Inputs are told apart by a 64-bit hash (FNV-1a; Fowler, Noll, Vo 1991).
 */
#include "page.h"

#include "runner/base/message.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* What is remembered of a design of the file: hashes of all of its inputs, and of those that its
 * controller depends on. */
struct inputs {
    uint64_t all, controller;
};
static struct inputs *known;

void page_designs_forget(void)
{
    free(known);
    known = NULL;
}

static uint64_t hash_of(const struct scenario_values *values)
{
    const uint8_t *const byte = (const uint8_t *)values;
    uint64_t hash = UINT64_C(14695981039346656037);
    for (size_t i = 0; i < sizeof *values; i++)
        hash = (hash ^ byte[i]) * UINT64_C(1099511628211);
    return hash;
}

static bool inputs_of(const struct scenario *s, const struct plan *plan, size_t d,
                      struct inputs *inputs)
{
    struct scenario_values values;
    scenario_case_values(s, plan_design_case(plan, d), &values);
    if (!resolve_keep_design_inputs(s->scene, &values, values.design_time == DESIGN_SAMPLED))
        return no_memory(&page.message);
    inputs->all = hash_of(&values);
    for (int i = 0; i < STANCE_MAX_ROBOT; i++) {
        values.model[i] = isnan(values.model[i]) ? values.robot[i] : values.model[i];
        values.robot[i] = 0;
    }
    if (!values.design_point.given)
        values.design_point = values.equilibrium;
    memset(&values.equilibrium, 0, sizeof values.equilibrium);
    memset(values.state, 0, sizeof values.state);
    values.state_given = 0;
    inputs->controller = hash_of(&values);
    return true;
}

static bool know(void)
{
    const struct plan *const plan = &page.file_plan;
    struct inputs *const all = known ? NULL : malloc(plan->designs * sizeof *known);
    if (known)
        return true;
    if (!all)
        return no_memory(&page.message);
    for (size_t d = 0; d < plan->designs; d++)
        if (!inputs_of(&page.file, plan, d, &all[d])) {
            free(all);
            return false;
        }
    known = all;
    return true;
}

/* The file's design with the same hash at an offset in struct inputs; first the one at the same
 * place, where it most often is. */
static bool find(const struct inputs *wanted, size_t place, bool all, size_t *found)
{
    const size_t designs = page.file_plan.designs;
    for (size_t i = 0; i < designs; i++) {
        const size_t d = (place + i) % designs;
        if (all ? known[d].all == wanted->all : known[d].controller == wanted->controller) {
            *found = d;
            return true;
        }
    }
    return false;
}

static void take(size_t d, const struct resolved_design *design, stance_status status)
{
    if (design)
        plan_design_put(&page.view_plan, d, design);
    page.view_plan.design_status[d] = (uint8_t)status;
}

/* Computes what needs no library: a start, or a controller whose gains are given. */
static bool compute(size_t d, const struct scenario_values *values, const size_t *controller)
{
    struct resolved_design design;
    struct scenario_values own = *values;
    stance_message why;
    own.law = controller ? 0 : own.law;
    const bool good = resolve_design(page.view.scene, &own, &design, &why);
    if (good && controller) {
        const struct resolved_design file = plan_design_at(&page.file_plan, *controller);
        memcpy(design.equilibrium, file.equilibrium, sizeof design.equilibrium);
        memcpy(design.torque, file.torque, sizeof design.torque);
        memcpy(design.gain, file.gain, sizeof design.gain);
    }
    take(d, &design, good ? STANCE_DONE : STANCE_FAILED);
    return good;
}

bool page_design(size_t d)
{
    const struct plan *const plan = &page.view_plan;
    struct scenario_values values;
    struct inputs wanted;
    size_t place = d;
    page.message.text[0] = '\0';
    if (plan->design_status[d] != STANCE_PENDING)
        return plan->design_status[d] == STANCE_DONE;
    if (!page.changed) {
        const struct resolved_design design = plan_design_at(&page.file_plan, d);
        take(d, &design, (stance_status)page.file_plan.design_status[d]);
        return page.file_plan.design_status[d] == STANCE_DONE ||
               (page.file_plan.design_status[d] == STANCE_PENDING &&
                complain(&page.message, "the file does not hold this controller yet"));
    }
    if (!know() || !inputs_of(&page.view, plan, d, &wanted))
        return false;
    scenario_case_values(&page.view, plan_design_case(plan, d), &values);
    if (find(&wanted, place, true, &place)) {
        const struct resolved_design design = plan_design_at(&page.file_plan, place);
        take(d, &design, (stance_status)page.file_plan.design_status[place]);
        return page.file_plan.design_status[place] == STANCE_DONE;
    }
    if (!scenario_law(&values)->designed || values.design == DESIGN_GAINS)
        return compute(d, &values, NULL);
    if (find(&wanted, place, false, &place))
        return page.file_plan.design_status[place] == STANCE_DONE && compute(d, &values, &place);
    return complain(&page.message,
                    "the file holds no controller designed for this, and a page designs none: keep "
                    "what controller.model believes in, or give gains (controller.design gains)");
}
