/* command_accuracy.c - `stance bench accuracy`: runs the accuracy studies and charts them. */
#include "accuracy.h"
#include "studies.h"

#include "analysis/table/json.h"

#include <inttypes.h>
#include <jansson.h>
#include <math.h>
#include <stdio.h>

extern const struct command command_accuracy; /* below */

static const double measuring_budget = 0.3; /* s per method and step */

/* ---- text and JSON ------------------------------------------------------------------------ */

static void print_row(const struct accuracy *a, size_t k)
{
    const struct accuracy_row *row = &a->row[k];
    char tolerance[16] = "-", failed[64] = "";
    if (!isnan(row->tolerance))
        snprintf(tolerance, sizeof tolerance, "%.0e", row->tolerance);
    if (row->failed > 0) {
        snprintf(failed, sizeof failed, "  gave up %" PRIu64 " of %" PRIu64 ": %s", row->failed,
                 row->cases, stance_failure_name[row->failure]);
    }
    printf("  %-13s %8.1e %6s %10.3g %9.0f", row->method->name, row->step, tolerance,
           row->cost.median, row->evaluations);
    if (k == a->truth) {
        printf("   reference%s\n", failed);
    } else if (a->labels) {
        const double share = row->compared > 0 ? (double)row->differ / (double)row->compared : NAN;
        printf(" %7" PRIu64 " of %" PRIu64 " (%.3f %%), %" PRIu64 " inside%s\n", row->differ,
               row->compared, 100 * share, row->inside, failed);
    } else {
        printf("  %9.2e %9.2e %8.0e %8.0e %8.0e %9.1e%s\n", row->position, row->velocity,
               row->signorini, row->coulomb, row->dissipation, row->energy_gain, failed);
    }
}

static void print_text(const struct accuracy *a, const struct results *r)
{
    printf("\n%s\n", r->title);
    printf("  %-13s %8s %6s %10s %9s", "method", "step/s", "toler.", "us per s", "evals/s");
    if (a->labels) {
        printf("  cells unlike the reference (share of the grid), inside its domains\n");
    } else {
        printf("  %9s %9s %8s %8s %8s %9s\n", "position", "velocity", "Signor.", "Coulomb",
               "dissip.", "energy/J");
    }
    for (size_t k = 0; k < a->rows; k++)
        print_row(a, k);
    for (size_t k = 0; k < a->orders; k++) {
        const struct accuracy_order *order = &a->order[k];
        if (!isnan(order->position)) {
            printf(
                "  %s: order %.2f (position), %.2f (velocity) of the %s, %.0e ... %.0e, %zu rows\n",
                order->method->name, order->position, order->velocity,
                order->by_tolerance ? "tolerance" : "step", order->from, order->to, order->rows);
        }
    }
}

static json_t *row_json(const struct accuracy *a, size_t k)
{
    const struct accuracy_row *row = &a->row[k];
    const bool compared = row->compared > 0 && k != a->truth;
    return json_pack(
        "{s:s, s:o, s:o, s:b, s:I, s:I, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, "
        "s:o, "
        "s:o}",
        "method", row->method->name, "step", results_json_number(row->step), "tolerance",
        results_json_number(row->tolerance), "reference", k == a->truth, "cases",
        (json_int_t)row->cases, "failed", (json_int_t)row->failed, "microseconds_per_second",
        results_json_number(row->cost.median), "microseconds_low",
        results_json_number(row->cost.low), "microseconds_high",
        results_json_number(row->cost.high), "evaluations_per_second",
        results_json_number(row->evaluations), "events_per_second",
        results_json_number(row->events), "position_error",
        compared && !a->labels ? results_json_number(row->position) : json_null(), "velocity_error",
        compared && !a->labels ? results_json_number(row->velocity) : json_null(), "cells_unlike",
        compared && a->labels ? json_integer((json_int_t)row->differ) : json_null(),
        "cells_unlike_inside",
        compared && a->labels ? json_integer((json_int_t)row->inside) : json_null(),
        "signorini_residual", results_json_number(row->signorini), "coulomb_residual",
        results_json_number(row->coulomb), "dissipation_residual",
        results_json_number(row->dissipation), "energy_gain",
        results_json_number(row->energy_gain));
}

static json_t *study_json(const struct accuracy *a, const struct results *r)
{
    json_t *rows = json_array(), *orders = json_array();
    for (size_t k = 0; k < a->rows; k++)
        json_array_append_new(rows, row_json(a, k));
    for (size_t k = 0; k < a->orders; k++) {
        const struct accuracy_order *order = &a->order[k];
        json_array_append_new(
            orders, json_pack("{s:s, s:s, s:o, s:o, s:o, s:o, s:I}", "method", order->method->name,
                              "of", order->by_tolerance ? "tolerance" : "step", "position",
                              results_json_number(order->position), "velocity",
                              results_json_number(order->velocity), "from",
                              results_json_number(order->from), "to",
                              results_json_number(order->to), "rows", (json_int_t)order->rows));
    }
    return json_pack("{s:s, s:s, s:s, s:o, s:o}", "name", r->name, "title", r->title, "file",
                     r->file, "rows", rows, "orders", orders);
}

/* ---- the command --------------------------------------------------------------------------- */

static bool study(const struct results *r, const char *directory, const char *stem, json_t **object,
                  stance_message *message)
{
    struct accuracy a;
    if (!accuracy_make(&a, r, measuring_budget, message))
        return false;
    bool good = true;
    if (object) {
        *object = study_json(&a, r);
    } else {
        print_text(&a, r);
        fflush(stdout);
        good = accuracy_plot(&a, r, directory, stem, message);
    }
    accuracy_free(&a);
    return good;
}

static int run(int argc, char **argv)
{
    return studies_run(&command_accuracy, "accuracy", study, argc, argv);
}

const struct command command_accuracy = {
    "bench accuracy",
    "bench accuracy [SCENARIO]... [-o DIR] [--reuse] [--json]",
    "error against cost of every method, on scenes with known answers",
    run,
    "Runs studies of methods and steps, by default those of scenarios/accuracy, like any other\n"
    "scenario, and compares each row with the first one of event-driven. The first axis of a "
    "study\n"
    "varies method.name with method.step (and method.tolerance); the other axes vary the start. "
    "With\n"
    "`record.cases: all` positions and velocities are compared, otherwise outcomes: cells of the\n"
    "grid are counted, which are no draws and have no interval. The cost is measured on one core,\n"
    "the median of at least three repetitions.\n"
    "\n"
    "  -o DIR     where the results files and pictures go, default results/accuracy\n"
    "  --reuse    take results files that are there as they are\n"
    "  --json     the same as JSON, without pictures: a list `studies` of\n"
    "    name, title, file         strings\n"
    "    rows                      method, step, tolerance, reference, cases, failed,\n"
    "                              microseconds_per_second (_low, _high), evaluations_per_second,\n"
    "                              events_per_second, position_error, velocity_error, "
    "cells_unlike,\n"
    "                              cells_unlike_inside, the residuals of the contact laws, "
    "energy_gain\n"
    "    orders                    method, of (step or tolerance), position, velocity, from, to, "
    "rows\n",
};
