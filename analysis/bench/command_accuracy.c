/* command_accuracy.c - `stance bench accuracy`: runs the accuracy studies and charts them. */
#include "accuracy.h"
#include "studies.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>

extern const struct command command_accuracy; /* below */

static const double measuring_budget = 0.3; /* s per method and step */

/* ---- facts ------------------------------------------------------------------------ */

void accuracy_errors(struct table *t, const struct accuracy_row *row, bool reference, bool labels)
{
    const bool compared = row->compared > 0 && !reference;
    const bool paths = compared && !labels, cells = compared && labels;
    const struct table_value none = as_nothing(reference ? "reference" : NULL);
    TABLE_FACTS(
        t,
        {{"position_error", "position", "%.2e", .before = "  ", .width = 9},
         paths ? as_number(row->position) : none},
        {{"velocity_error", "velocity", "%.2e", .width = 9},
         as_number(paths ? row->velocity : NAN)},
        {{"cells_unlike", "unlike", .width = 9}, cells ? as_whole(row->differ) : none},
        {{"of", "cells", .hidden = TABLE_NO_JSON, .before = " of ", .left = true},
         as_whole(row->compared)},
        {{"share", "share", "%.3f %%", .hidden = TABLE_NO_JSON, .width = 8, .percent = true},
         as_number(cells ? (double)row->differ / (double)row->compared : NAN)},
        {{"cells_unlike_inside", "inside", .width = 6},
         cells ? as_whole(row->inside) : as_nothing(NULL)});
}

static void add_row(struct table *t, const struct accuracy *a, size_t k)
{
    const struct accuracy_row *row = &a->row[k];
    char remark[96];
    snprintf(remark, sizeof remark, "gave up %" PRIu64 " of %" PRIu64 ": %s", row->failed,
             row->cases, stance_failure_name[row->failure]);
    TABLE_FACTS(
        t, {{"method", "method", .width = 13, .left = true}, as_text(row->method->name)},
        {{"step", "step/s", "%.1e", .width = 8}, as_number(row->step)},
        {{"tolerance", "toler.", "%.0e", .width = 6}, as_number(row->tolerance)},
        {{.name = "reference"}, as_truth(k == a->truth)}, {{.name = "cases"}, as_whole(row->cases)},
        {{.name = "failed"}, as_whole(row->failed)},
        {{"microseconds_per_second", "us per s", "%.3g", .width = 10}, as_number(row->cost.median)},
        {{.name = "microseconds_low"}, as_number(row->cost.lowest)},
        {{.name = "microseconds_high"}, as_number(row->cost.highest)},
        {{"evaluations_per_second", "evals/s", "%.0f", .width = 9}, as_number(row->evaluations)},
        {{.name = "events_per_second"}, as_number(row->events)});
    accuracy_errors(t, row, k == a->truth, a->labels);
    TABLE_FACTS(
        t, {{"signorini_residual", "Signor.", "%.0e", .width = 8}, as_number(row->signorini)},
        {{"coulomb_residual", "Coulomb", "%.0e", .width = 8}, as_number(row->coulomb)},
        {{"dissipation_residual", "dissip.", "%.0e", .width = 8}, as_number(row->dissipation)},
        {{"energy_gain", "energy/J", "%.1e", .width = 9}, as_number(row->energy_gain)},
        {{"remark", .hidden = TABLE_VIEW_ONLY, .before = "  ", .empty = ""},
         as_nothing(row->failed > 0 ? remark : NULL)});
    table_end_row(t);
}

static json_t *study_facts(const struct accuracy *a, const struct results *r)
{
    struct table t = {0};
    json_t *const orders = json_array();
    for (size_t k = 0; k < a->rows; k++)
        add_row(&t, a, k);
    for (size_t k = 0; k < a->orders; k++) {
        const struct accuracy_order *order = &a->order[k];
        TABLE_APPEND(orders, {"method", as_text(order->method->name)},
                     {"of", as_text(order->by_tolerance ? "tolerance" : "step")},
                     {"position", as_number(order->position)},
                     {"velocity", as_number(order->velocity)}, {"from", as_number(order->from)},
                     {"to", as_number(order->to)}, {"rows", as_whole(order->rows)},
                     {".known", as_truth(!isnan(order->position))});
    }
    json_t *const facts =
        TABLE_OBJECT({"name", as_text(r->name)}, {"title", as_text(r->title)},
                     {"file", as_text(r->file)}, {".labels", as_truth(a->labels)});
    table_give(facts, "rows", &t,
               a->labels ? "method step tolerance microseconds_per_second evaluations_per_second "
                           "cells_unlike of share cells_unlike_inside remark"
                         : "method step tolerance microseconds_per_second evaluations_per_second "
                           "position_error velocity_error signorini_residual coulomb_residual "
                           "dissipation_residual energy_gain remark",
               0);
    table_put(facts, "orders", as_tree(orders));
    return facts;
}

static const char text[] =
    "\n{title}\n{.rows}"
    "[.labels:  (cells unlike the reference, share of the grid; inside: of its domains)\n]"
    "[orders*:[.known:  {method}: order {position%.2f} (position), {velocity%.2f} (velocity) of "
    "the {of}, {from%.0e} ... {to%.0e}, {rows} rows\n]]";

/* ---- the command --------------------------------------------------------------------------- */

static bool study(const struct plot *plot, json_t **object)
{
    const struct results *const r = plot->r;
    struct accuracy a;
    if (!accuracy_make(&a, r, measuring_budget, plot->message))
        return false;
    json_t *const facts = study_facts(&a, r);
    bool good = true;
    if (object)
        *object = facts;
    else
        good =
            say_facts(facts, false, text, stdout) && fflush(stdout) == 0 && accuracy_plot(&a, plot);
    accuracy_free(&a);
    return good;
}

static int run(int argc, char **argv)
{
    static const struct study_kind kind = {"accuracy", accuracy_fits, study};
    for (int i = 1; i < argc; i++)
        if (strncmp(argv[i], "--peer", 6) == 0)
            return command_usage(&command_accuracy, "other simulators are asked by `make "
                                                    "bench-peers` in the source tree, not here");
    return studies_run(&command_accuracy, &kind, argc, argv);
}

const struct command command_accuracy = {
    "bench accuracy",
    "error against cost of every method, on scenes with known answers",
    run,
    studies_options,
    "Runs studies of methods and steps, by default those of scenarios/accuracy, like any other "
    "scenario, and compares each row with the first one of event-driven. The first axis of a "
    "study varies method.name with method.step (and method.tolerance); the other axes vary the "
    "start. With `record.cases: all` positions and velocities are compared, otherwise outcomes: "
    "cells of the grid are counted, which are no draws and have no interval. The cost is measured "
    "on one core, in processor time, the median of at least three repetitions.\n",
    "    name, title, file         strings\n"
    "    rows                      method, step, tolerance, reference, cases, failed, "
    "microseconds_per_second (_low, _high), evaluations_per_second, events_per_second, "
    "position_error, velocity_error, cells_unlike, cells_unlike_inside, the residuals of the "
    "contact laws, energy_gain\n"
    "    orders                    method, of (step or tolerance), position, velocity, from, to, "
    "rows\n",
};
