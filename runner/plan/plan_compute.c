/* plan_compute.c - designs, checks and estimates. */
#include "plan.h"
#include "standing.h"

#include "runner/base/command.h"
#include "runner/base/message.h"
#include "runner/base/numbers.h"
#include "runner/base/units.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum {
    CHECKED_CASES = 4096,
    CORNER_AXES = 11, /* 2048 corners */
};

/* ---- designs ------------------------------------------------------------------------------ */

/* At the key that the message begins with, or else at another. */
static void place_error(const struct scenario *s, const char *otherwise, const char *message,
                        struct plan_error *error)
{
    error->line = error->column = 1;
    for (int a = 0; a < s->axes; a++)
        for (int k = 0; k < s->axis[a].paths; k++) {
            const size_t length = strlen(s->axis[a].path[k]);
            if (strncmp(message, s->axis[a].path[k], length) == 0 && message[length] == ':') {
                error->line = s->axis[a].line;
                error->column = s->axis[a].column;
                return;
            }
        }
    if (!scenario_place(s, message, &error->line, &error->column))
        scenario_place(s, otherwise, &error->line, &error->column);
}

/* Whose fault it is that a design does not exist: the initial equilibrium's, or the law's. */
static void blame_design(const struct plan *plan, size_t design, struct plan_error *error)
{
    const struct scenario *s = plan->scenario;
    struct scenario_values values;
    struct resolved_design result;
    stance_message ignored;

    scenario_case_values(s, plan_design_case(plan, design), &values);
    resolve_design(s->scene, &values, &result, &error->message);
    values.law = 0;
    bool law = resolve_design(s->scene, &values, &result, &ignored);
    place_error(s, law ? "controller:" : "initial:", error->message.text, error);
    values.law = s->base.law;
    standing_ranges(s, &values, &error->message);
}

/* Corner c of the grid: bit a says which end of axis a. */
static uint64_t corner_case(const struct scenario *s, uint64_t c)
{
    uint64_t index = 0;
    for (int a = 0; a < s->axes; a++)
        index = index * s->axis[a].count + ((c >> a & 1) ? s->axis[a].count - 1 : 0);
    return index;
}

static uint64_t corners(const struct scenario *s)
{
    return (uint64_t)1 << smaller((size_t)s->axes, CORNER_AXES);
}

/* Case i of n spread evenly over all. */
static uint64_t spread_case(const struct plan *plan, uint64_t i, uint64_t n)
{
    uint64_t last = plan->scenario->cases - 1;
    return n < 2 ? 0 : last / (n - 1) * i + last % (n - 1) * i / (n - 1);
}

/* Case i of PLAN_COST_CASES, in an order that is spread evenly wherever it is cut: 27 and 64 have
 * no divisor. */
uint64_t plan_cost_case(const struct plan *plan, uint64_t i)
{
    return spread_case(plan, i * 27 % PLAN_COST_CASES, PLAN_COST_CASES);
}

/* A step that meets each of n numbers once, modulo n, and spreads them evenly wherever it is cut:
 * near the golden section, without a common divisor. */
static size_t even_stride(size_t n)
{
    for (size_t stride = (size_t)(0.6180339887498949 * (double)n) | 1;; stride++) {
        size_t a = stride, b = n;
        while (b > 0) {
            const size_t rest = a % b;
            a = b;
            b = rest;
        }
        if (a == 1)
            return stride;
    }
}

static void ask_to_stop(void *context)
{
    const struct plan *plan = context;
    plan->stop(plan->stop_context); /* which tells the other ranks */
}

bool plan_compute_designs(struct plan *plan, const struct parallel *parallel,
                          struct plan_error *error)
{
    const struct scenario *s = plan->scenario;
    const size_t ranks = (size_t)parallel->size, rank = (size_t)parallel->rank;
    const size_t share = plan->designs / ranks, extra = plan->designs % ranks;
    const size_t first = rank * share + smaller(rank, extra), count = share + (rank < extra);
    const size_t stride = even_stride(count);
    const uint64_t ends = corners(s);
    uint64_t found[3] = {0}; /* designs that exist; that are pending; ranks that were stopped */
    size_t computed = 0;
    const double start = clock_seconds();

    /* Time may run out: those come first that plan_cost needs, then those of the corners. */
    for (uint64_t i = 0; i < PLAN_COST_CASES + ends + count; i++) {
        const size_t d = i < PLAN_COST_CASES ? plan_design(plan, plan_cost_case(plan, i))
                         : i < PLAN_COST_CASES + ends
                             ? plan_design(plan, corner_case(s, i - PLAN_COST_CASES))
                             : first + (i - PLAN_COST_CASES - ends) * stride % count;
        struct scenario_values values;
        stance_message ignored;
        if (d < first || d >= first + count || plan->design_status[d] != STANCE_PENDING)
            continue;
        if (plan->stop && plan->stop(plan->stop_context)) {
            found[2] = 1;
            break;
        }
        if (plan->patience > 0 && computed > 0 && clock_seconds() - start > plan->patience)
            break;
        scenario_case_values(s, plan_design_case(plan, d), &values);
        struct resolved_design design = plan_design_at(plan, d);
        bool exists = resolve_design(s->scene, &values, &design, &ignored);
        plan_design_put(plan, d, &design);
        plan->design_status[d] = exists ? STANCE_DONE : STANCE_FAILED;
        computed++;
    }
    if (computed > 0)
        plan->design_seconds = (clock_seconds() - start) * (double)plan->designs / (double)computed;
    for (size_t d = first; d < first + count; d++) {
        found[0] += plan->design_status[d] == STANCE_DONE;
        found[1] += plan->design_status[d] == STANCE_PENDING;
    }
    if (plan->stop) /* a rank that waits for others goes on asking: the signal may be its own */
        parallel_meet(parallel, ask_to_stop, plan);
    parallel_gather_block(parallel, plan->design, plan->design_size * sizeof *plan->design, first,
                          count);
    parallel_gather_block(parallel, plan->design_status, 1, first, count);
    parallel_sum(parallel, found, 3);
    plan->pending = found[1];
    const bool good = found[0] > 0 || found[1] > 0;
    if (!good && found[2] == 0)
        blame_design(plan, 0, error);
    return good && found[2] == 0;
}

/* ---- checking ----------------------------------------------------------------------------- */

static bool check_case(const struct plan *plan, uint64_t index, struct plan_error *error)
{
    const struct scenario *s = plan->scenario;
    struct scenario_values values;
    stance_case resolved;
    stance_message message = {""};
    size_t design = plan_design(plan, index);

    if (plan->design_status[design] != STANCE_DONE)
        return true;
    scenario_case_values(s, index, &values);
    const struct resolved_design own = plan_design_at(plan, design);
    if (resolve_case(s, &values, &own, index, &resolved, &message) &&
        (s->cases > 1 || resolve_selection(s->scene, &resolved, &message)))
        return true;
    place_error(s, "initial:", message.text, error);
    if (s->cases == 1)
        error->message = message;
    else
        complain(&error->message, "case %llu: %.200s", (unsigned long long)index, message.text);
    return false;
}

bool plan_check_cases(const struct plan *plan, struct plan_error *error)
{
    const struct scenario *s = plan->scenario;
    if (plan->single)
        return check_case(plan, plan->single_case, error);
    uint64_t n = s->cases < CHECKED_CASES ? s->cases : CHECKED_CASES;
    for (uint64_t i = 0; i < n; i++)
        if (!check_case(plan, spread_case(plan, i, n), error))
            return false;
    for (uint64_t c = 0; n < s->cases && c < corners(s); c++)
        if (!check_case(plan, corner_case(s, c), error))
            return false;
    /* Of few designs that are known the cases above may miss most. */
    for (size_t d = 0; plan->pending > 0 && d < plan->designs; d++)
        if (plan->design_status[d] == STANCE_DONE &&
            !check_case(plan, plan_design_case(plan, d), error))
            return false;
    return true;
}
