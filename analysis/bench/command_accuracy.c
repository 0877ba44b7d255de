/* command_accuracy.c - `stance bench accuracy`: runs the accuracy studies and charts them. */
#include "accuracy.h"
#include "studies.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>

extern const struct command command_accuracy; /* below */

static const double measuring_budget = 0.3; /* s per method and step */

/* What peers are asked, as the options say. */
static struct accuracy_asking asking;

/* ---- text and JSON ------------------------------------------------------------------------ */

/* What a row's errors are: of the reference itself, or of what was not compared, there are none. */
static void add_errors(struct table *t, const struct accuracy *a, size_t k)
{
    const struct accuracy_row *row = &a->row[k];
    const bool compared = row->compared > 0 && k != a->truth;
    const bool paths = compared && !a->labels, cells = compared && a->labels;
    const struct table_value none = as_nothing(k == a->truth ? "reference" : NULL);
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

static const char *maker(const struct accuracy *a, const struct accuracy_row *row)
{
    return row->method ? row->method->name : a->peer[row->peer].name;
}

static void add_row(struct table *t, const struct accuracy *a, size_t k)
{
    const struct accuracy_row *row = &a->row[k];
    char remark[96];
    snprintf(remark, sizeof remark, "gave up %" PRIu64 " of %" PRIu64 "%s%s", row->failed,
             row->cases, row->method ? ": " : "",
             row->method ? stance_failure_name[row->failure] : "");
    TABLE_FACTS(
        t, {{"method", "method", .width = 13, .left = true}, as_text(maker(a, row))},
        {{"setting", "setting", .width = 20, .left = true, .empty = ""},
         as_text(row->method ? NULL : row->setting)},
        {{"step", "step/s", "%.1e", .width = 8}, as_number(row->step)},
        {{"tolerance", "toler.", "%.0e", .width = 6}, as_number(row->tolerance)},
        {{.name = "reference"}, as_truth(k == a->truth)}, {{.name = "cases"}, as_whole(row->cases)},
        {{.name = "failed"}, as_whole(row->failed)},
        {{"microseconds_per_second", "us per s", "%.3g", .width = 10}, as_number(row->cost.median)},
        {{.name = "microseconds_low"}, as_number(row->cost.low)},
        {{.name = "microseconds_high"}, as_number(row->cost.high)},
        {{"evaluations_per_second", "evals/s", "%.0f", .width = 9}, as_number(row->evaluations)},
        {{.name = "events_per_second"}, as_number(row->events)});
    add_errors(t, a, k);
    TABLE_FACTS(
        t, {{"signorini_residual", "Signor.", "%.0e", .width = 8}, as_number(row->signorini)},
        {{"coulomb_residual", "Coulomb", "%.0e", .width = 8}, as_number(row->coulomb)},
        {{"dissipation_residual", "dissip.", "%.0e", .width = 8}, as_number(row->dissipation)},
        {{"energy_gain", "energy/J", "%.1e", .width = 9}, as_number(row->energy_gain)},
        {{"remark", .hidden = TABLE_VIEW_ONLY, .before = "  ", .empty = ""},
         as_nothing(row->failed > 0 ? remark : NULL)});
    table_end_row(t);
}

/* ---- peers in a sentence ------------------------------------------------------------------- */

/* How one row of a peer stands beside every method. */
static void print_against(const struct accuracy *a, const struct accuracy_row *best,
                          const char *which)
{
    const char *const unit = a->labels ? " of the cells" : " m or rad";
    printf("  %s, %s (%s, %g s): ", maker(a, best), which, best->setting, best->step);
    if (a->labels && best->differ == 0) /* no number tells how much fewer than one */
        printf("none of %" PRIu64 " cells unlike, taken as one,", best->compared);
    else if (a->labels)
        printf("%" PRIu64 " of %" PRIu64 " cells unlike", best->differ, best->compared);
    else
        printf("error %.2g%s", accuracy_error(a, best), unit);
    printf(" at %.3g us per s.\n    As exact:", best->cost.median);
    const char *comma = "";
    for (size_t m = 0; stance_methods()[m]; m++) {
        const struct accuracy_against x = accuracy_compare(a, best, stance_methods()[m]);
        if (!isnan(x.cheaper)) {
            const bool dearer = x.cheaper < 1;
            printf("%s %s is %s%.3g times %s", comma, stance_methods()[m]->name,
                   x.at_least ? dearer ? "at most " : "at least " : "",
                   dearer ? 1 / x.cheaper : x.cheaper, dearer ? "dearer" : "cheaper");
            comma = ",";
        }
    }
    printf("%s.\n    At that cost:", *comma ? "" : " none");
    comma = "";
    for (size_t m = 0; stance_methods()[m]; m++) {
        const struct accuracy_against x = accuracy_compare(a, best, stance_methods()[m]);
        if (!isnan(x.error)) {
            printf("%s %s has %s%.2g%s", comma, stance_methods()[m]->name,
                   x.at_most ? "at most " : "", x.error, *comma ? "" : unit);
            comma = ",";
        }
    }
    puts(*comma ? "." : " none.");
}

static void print_peer(const struct accuracy *a, size_t p)
{
    const struct accuracy_peer *const peer = &a->peer[p];
    if (peer->cannot[0] != '\0') {
        printf("  %s cannot: %s\n", peer->name, peer->cannot);
        return;
    }
    printf("  %s: %zu settings, of which those nothing else of it beats and its defaults are "
           "listed; accelerations within %.0e of ours\n",
           peer->name, peer->settings, peer->off);
    const struct accuracy_row *const best = accuracy_best(a, p, false), *const usual =
                                                                            accuracy_best(a, p,
                                                                                          true);
    if (best)
        print_against(a, best, "at its best");
    if (usual && usual != best)
        print_against(a, usual, "by default");
}

static bool print_text(const struct accuracy *a, const struct results *r, const struct table *t)
{
    printf("\n%s\n", r->title);
    const bool good = table_write_text(
        t, stdout,
        a->labels      ? a->peers > 0 ? "method setting step tolerance microseconds_per_second "
                                        "cells_unlike of share cells_unlike_inside remark"
                                      : "method step tolerance microseconds_per_second "
                                        "evaluations_per_second cells_unlike of share "
                                        "cells_unlike_inside remark"
        : a->peers > 0 ? "method setting step tolerance microseconds_per_second position_error "
                         "velocity_error remark"
                       : "method step tolerance microseconds_per_second evaluations_per_second "
                         "position_error velocity_error signorini_residual coulomb_residual "
                         "dissipation_residual energy_gain remark",
        0);
    if (a->labels)
        puts("  (cells unlike the reference, share of the grid; inside: of its domains)");
    for (size_t k = 0; k < a->orders; k++) {
        const struct accuracy_order *order = &a->order[k];
        if (!isnan(order->position)) {
            printf(
                "  %s: order %.2f (position), %.2f (velocity) of the %s, %.0e ... %.0e, %zu rows\n",
                order->method->name, order->position, order->velocity,
                order->by_tolerance ? "tolerance" : "step", order->from, order->to, order->rows);
        }
    }
    for (size_t p = 0; p < a->peers; p++)
        print_peer(a, p);
    return good;
}

static json_t *against_json(const struct accuracy *a, const struct accuracy_row *best)
{
    json_t *list = json_array();
    for (size_t m = 0; best && stance_methods()[m]; m++) {
        const struct accuracy_against x = accuracy_compare(a, best, stance_methods()[m]);
        if (!isnan(x.cheaper) || !isnan(x.error))
            json_array_append_new(list, TABLE_OBJECT({"method", as_text(stance_methods()[m]->name)},
                                                     {"times_cheaper", as_number(x.cheaper)},
                                                     {"at_least", as_truth(x.at_least)},
                                                     {"error", as_number(x.error)},
                                                     {"at_most", as_truth(x.at_most)}));
    }
    return list;
}

static json_t *peers_json(const struct accuracy *a)
{
    json_t *list = json_array();
    for (size_t p = 0; p < a->peers; p++) {
        const struct accuracy_peer *const peer = &a->peer[p];
        const bool can = peer->cannot[0] == '\0';
        json_t *against[2];
        for (int usual = 0; usual < 2; usual++) {
            const struct accuracy_row *const best = accuracy_best(a, p, usual);
            against[usual] =
                best ? TABLE_OBJECT({"setting", as_text(best->setting)},
                                    {"step", as_number(best->step)},
                                    {"microseconds_per_second", as_number(best->cost.median)},
                                    {"error", as_number(accuracy_error(a, best))},
                                    {"methods", as_tree(against_json(a, best))})
                     : NULL;
        }
        json_array_append_new(
            list, TABLE_OBJECT({"name", as_text(peer->name)},
                               {"cannot", as_text(can ? NULL : peer->cannot)},
                               {"settings", as_whole(peer->settings)},
                               {"acceleration_difference", as_number(can ? peer->off : NAN)},
                               {"best", as_tree(against[0])}, {"defaults", as_tree(against[1])}));
    }
    return list;
}

static json_t *study_json(const struct accuracy *a, const struct results *r, const struct table *t)
{
    json_t *orders = json_array();
    for (size_t k = 0; k < a->orders; k++) {
        const struct accuracy_order *order = &a->order[k];
        json_array_append_new(
            orders,
            TABLE_OBJECT({"method", as_text(order->method->name)},
                         {"of", as_text(order->by_tolerance ? "tolerance" : "step")},
                         {"position", as_number(order->position)},
                         {"velocity", as_number(order->velocity)}, {"from", as_number(order->from)},
                         {"to", as_number(order->to)}, {"rows", as_whole(order->rows)}));
    }
    return TABLE_OBJECT({"name", as_text(r->name)}, {"title", as_text(r->title)},
                        {"file", as_text(r->file)}, {"rows", as_tree(table_json(t, false))},
                        {"orders", as_tree(orders)}, {"peers", as_tree(peers_json(a))});
}

/* ---- the command --------------------------------------------------------------------------- */

static bool study(const struct results *r, struct look *look, const char *directory,
                  const char *stem, json_t **object, stance_message *message)
{
    struct accuracy a;
    if (!accuracy_make(&a, r, measuring_budget, message))
        return false;
    if (asking.programs > 0 && !accuracy_ask(&a, r, &asking, message)) {
        accuracy_free(&a);
        return false;
    }
    struct table t = {0};
    bool good = true;
    for (size_t k = 0; k < a.all; k++)
        if (object || a.row[k].method || a.row[k].front || a.row[k].usual)
            add_row(&t, &a, k);
    if (object)
        *object = study_json(&a, r, &t);
    else
        good = print_text(&a, r, &t) && fflush(stdout) == 0 &&
               accuracy_plot(&a, r, look, directory, stem, message);
    table_free(&t);
    accuracy_free(&a);
    return good;
}

static const char *starts_text, *effort_text;
static size_t starts_given, effort_given;

/* A number above 0 of an option; without it the fallback. NAN: it is none. */
static double option_number(const char *text, size_t given, double fallback)
{
    char *end = "";
    const double x = given > 0 ? strtod(text, &end) : fallback;
    return (given == 0 || end != text) && *end == '\0' && x > 0 && x < 1e9 ? x : NAN;
}

static const char *wrong_options(void)
{
    const double starts = option_number(starts_text, starts_given, 1024);
    asking.effort = option_number(effort_text, effort_given, 60);
    if (!(starts >= 1) || isnan(asking.effort))
        return "--peer-starts and --peer-effort take a number above 0";
    asking.starts = (size_t)starts;
    asking.budget = measuring_budget;
    asking.patience = 10 * asking.effort;
    return NULL;
}

static int run(int argc, char **argv)
{
    static const struct study_kind kind = {"accuracy", accuracy_fits, study};
    const struct option_spec spec[] = {
        {"--peer", true, asking.program, ACCURACY_PEERS, &asking.programs},
        {"--peer-starts", true, &starts_text, 1, &starts_given},
        {"--peer-effort", true, &effort_text, 1, &effort_given},
    };
    const struct studies_options own = {spec, sizeof spec / sizeof *spec, wrong_options};
    return studies_run(&command_accuracy, &kind, &own, argc, argv);
}

const struct command command_accuracy = {
    "bench accuracy",
    "bench accuracy [SCENARIO]... [-o DIR] [--reuse] [--json]\n"
    "           [--peer PROGRAM]... [--peer-starts N] [--peer-effort S] [--format F,...]\n"
    "           [--for column|page] ...",
    "error against cost of every method, on scenes with known answers",
    run,
    "Runs studies of methods and steps, by default those of scenarios/accuracy, like any other\n"
    "scenario, and compares each row with the first one of event-driven. The first axis of a "
    "study\n"
    "varies method.name with method.step (and method.tolerance); the other axes vary the start. "
    "With\n"
    "`record.cases: all` positions and velocities are compared, otherwise outcomes: cells of the\n"
    "grid are counted, which are no draws and have no interval. The cost is measured on one core,\n"
    "in processor time, the median of at least three repetitions.\n"
    "\n"
    "With --peer another simulator computes the same cases and takes part in tables and charts: "
    "its\n"
    "accelerations must be ours, its errors are found by the same code, and a sentence says what "
    "each\n"
    "method costs for the same error and what error it has for the same cost. `make bench-peers`\n"
    "builds and asks those that are installed; analysis/bench/peer.h has the words.\n"
    "\n"
    "  -o DIR     where the results files and pictures go, default results/accuracy\n"
    "  --reuse    take results files of the same scenario that are there\n"
    "  --peer P   a program that drives another simulator (build/tests/peer_mujoco); repeatable\n"
    "  --peer-starts N   of a map peers compute no more cells than these, evenly spread; default "
    "1024\n"
    "  --peer-effort S   settings of peers that would take longer are left out, and a peer that "
    "says\n"
    "             nothing for ten times as long is given up; default 60 s\n" LOOK_HELP_DRAWN
    "  --json     the same as JSON, without pictures: a list `studies` of\n"
    "    name, title, file         strings\n"
    "    rows                      method, setting (of a peer), step, tolerance, reference, "
    "cases, failed,\n"
    "                              microseconds_per_second (_low, _high), evaluations_per_second,\n"
    "                              events_per_second, position_error, velocity_error, "
    "cells_unlike,\n"
    "                              cells_unlike_inside, the residuals of the contact laws, "
    "energy_gain\n"
    "    orders                    method, of (step or tolerance), position, velocity, from, to, "
    "rows\n"
    "    peers                     name, cannot (why), settings, acceleration_difference, best "
    "and\n"
    "                              defaults: setting, step, microseconds_per_second, error, "
    "methods:\n"
    "                              method, times_cheaper (at_least), error (at_most)\n",
};
