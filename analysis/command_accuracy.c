/* command_accuracy.c - `stance bench accuracy`: runs the accuracy studies and charts them. */
#include "accuracy.h"
#include "statistics.h"

#include "../runner/command.h"

#include <dirent.h>
#include <errno.h>
#include <inttypes.h>
#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { MAX_STUDIES = 64 };

static const double measuring_budget = 0.3; /* s per method and step */

/* ---- text and JSON ------------------------------------------------------------------------ */

static void print_row(const struct accuracy *a, size_t k)
{
    const struct accuracy_row *row = &a->row[k];
    char tolerance[16] = "-", failed[64] = "";
    if (!isnan(row->tolerance)) {
        snprintf(tolerance, sizeof tolerance, "%.0e", row->tolerance);
    }
    if (row->failed > 0) {
        static const char *const reasons[] = {
#define REASON(NAME, name, text) #name,
            STANCE_FAILURES(REASON)
#undef REASON
        };
        snprintf(failed, sizeof failed, "  gave up %" PRIu64 " of %" PRIu64 ": %s", row->failed,
                 row->cases, reasons[row->failure]);
    }
    printf("  %-13s %8.1e %6s %10.3g %9.0f", row->method->name, row->step, tolerance,
           row->cost.median, row->evaluations);
    if (k == a->truth) {
        printf("   reference%s\n", failed);
    } else if (a->labels) {
        double low, high;
        statistics_wilson(row->differ, row->compared, &low, &high);
        printf(" %7" PRIu64 " of %" PRIu64 " (%.3f ... %.3f %%), %" PRIu64 " inside%s\n",
               row->differ, row->compared, 100 * low, 100 * high, row->inside, failed);
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
        printf("  cells unlike the reference (95 %% interval), inside its domains\n");
    } else {
        printf("  %9s %9s %8s %8s %8s %9s\n", "position", "velocity", "Signor.", "Coulomb",
               "dissip.", "energy/J");
    }
    for (size_t k = 0; k < a->rows; k++) {
        print_row(a, k);
    }
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

static json_t *number(double x)
{
    return isfinite(x) ? json_real(x) : json_null();
}

static json_t *row_json(const struct accuracy *a, size_t k)
{
    const struct accuracy_row *row = &a->row[k];
    const bool compared = row->compared > 0 && k != a->truth;
    return json_pack(
        "{s:s, s:o, s:o, s:b, s:I, s:I, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, "
        "s:o, "
        "s:o}",
        "method", row->method->name, "step", number(row->step), "tolerance", number(row->tolerance),
        "reference", k == a->truth, "cases", (json_int_t)row->cases, "failed",
        (json_int_t)row->failed, "microseconds_per_second", number(row->cost.median),
        "microseconds_low", number(row->cost.low), "microseconds_high", number(row->cost.high),
        "evaluations_per_second", number(row->evaluations), "events_per_second",
        number(row->events), "position_error",
        compared && !a->labels ? number(row->position) : json_null(), "velocity_error",
        compared && !a->labels ? number(row->velocity) : json_null(), "cells_unlike",
        compared && a->labels ? json_integer((json_int_t)row->differ) : json_null(),
        "cells_unlike_inside",
        compared && a->labels ? json_integer((json_int_t)row->inside) : json_null(),
        "signorini_residual", number(row->signorini), "coulomb_residual", number(row->coulomb),
        "dissipation_residual", number(row->dissipation), "energy_gain", number(row->energy_gain));
}

static json_t *study_json(const struct accuracy *a, const struct results *r)
{
    json_t *rows = json_array(), *orders = json_array();
    for (size_t k = 0; k < a->rows; k++) {
        json_array_append_new(rows, row_json(a, k));
    }
    for (size_t k = 0; k < a->orders; k++) {
        const struct accuracy_order *order = &a->order[k];
        json_array_append_new(
            orders, json_pack("{s:s, s:s, s:o, s:o, s:o, s:o, s:I}", "method", order->method->name,
                              "of", order->by_tolerance ? "tolerance" : "step", "position",
                              number(order->position), "velocity", number(order->velocity), "from",
                              number(order->from), "to", number(order->to), "rows",
                              (json_int_t)order->rows));
    }
    return json_pack("{s:s, s:s, s:s, s:o, s:o}", "name", r->name, "title", r->title, "file",
                     r->file, "rows", rows, "orders", orders);
}

/* ---- studies ------------------------------------------------------------------------------ */

static bool ends_in_yaml(const char *name)
{
    const size_t n = strlen(name);
    return n > 5 && strcmp(name + n - 5, ".yaml") == 0;
}

static int by_name(const void *a, const void *b)
{
    return strcmp(*(char *const *)a, *(char *const *)b);
}

/* Paths of the scenarios of a directory, sorted; freed by the caller. */
static size_t list_studies(const char *directory, char *path[MAX_STUDIES])
{
    size_t count = 0;
    DIR *open = opendir(directory);
    struct dirent *entry;
    while (open && (entry = readdir(open)) && count < MAX_STUDIES) {
        if (ends_in_yaml(entry->d_name)) {
            const size_t size = strlen(directory) + strlen(entry->d_name) + 2;
            if ((path[count] = malloc(size))) {
                snprintf(path[count++], size, "%s/%s", directory, entry->d_name);
            }
        }
    }
    if (open) {
        closedir(open);
    }
    qsort(path, count, sizeof *path, by_name);
    return count;
}

/* Where the studies that ship are: below the working directory, or beside the program. */
static size_t find_studies(const char *kind, char *path[MAX_STUDIES])
{
    static const char *const bases[] = {"", "../", "../share/stance/"};
    char program[900] = "", directory[1024];
    const ssize_t n = readlink("/proc/self/exe", program, sizeof program - 1);
    char *slash = n > 0 ? strrchr(program, '/') : NULL;
    if (slash) {
        slash[1] = '\0';
    }
    for (size_t i = 0; i < sizeof bases / sizeof *bases; i++) {
        snprintf(directory, sizeof directory, "%s%sscenarios/%s", i > 0 && slash ? program : "",
                 bases[i], kind);
        const size_t count = list_studies(directory, path);
        if (count > 0) {
            return count;
        }
    }
    return 0;
}

/* `stance run` of one study; its exit code. */
static int run_study(const char *scenario, const char *file)
{
    char *argv[] = {"run", (char *)scenario, "--force", "--quiet", "-o", (char *)file, NULL};
    return command_run.run(6, argv);
}

struct options {
    const char *directory;
    bool json, reuse;
};

static int study(const char *scenario, const struct options *options, json_t *all)
{
    const char *slash = strrchr(scenario, '/'), *base = slash ? slash + 1 : scenario;
    char file[1024], stem[256];
    struct results r;
    struct accuracy a;
    stance_message message = {""};

    snprintf(stem, sizeof stem, "%.*s", (int)(strlen(base) - 5), base);
    snprintf(file, sizeof file, "%s/%s.h5", options->directory, stem);
    if (!options->reuse || access(file, R_OK) != 0) {
        const int code = run_study(scenario, file);
        if (code != EXIT_DONE && code != EXIT_CASES_FAILED) {
            return code;
        }
    }
    if (!results_open(&r, file, &message)) {
        fprintf(stderr, "%s\n", message.text);
        return EXIT_IO;
    }
    bool good = accuracy_make(&a, &r, measuring_budget, &message);
    if (good) {
        if (options->json) {
            json_array_append_new(all, study_json(&a, &r));
        } else {
            print_text(&a, &r);
        }
        fflush(stdout);
        good = options->json || accuracy_plot(&a, &r, options->directory, stem, &message);
        accuracy_free(&a);
    }
    if (!good) {
        fprintf(stderr, "stance bench accuracy: %.300s: %s\n", scenario, message.text);
    }
    results_close(&r);
    return good ? EXIT_DONE : EXIT_IO;
}

static int run_all(char *const *path, size_t count, const struct options *options)
{
    json_t *all = json_array();
    int code = EXIT_DONE;
    for (size_t i = 0; i < count && code == EXIT_DONE; i++) {
        code = study(path[i], options, all);
    }
    if (options->json && code == EXIT_DONE) {
        json_t *root = json_pack("{s:O}", "studies", all);
        if (json_dumpf(root, stdout, JSON_INDENT(2)) != 0) {
            code = EXIT_IO;
        }
        putchar('\n');
        json_decref(root);
    }
    json_decref(all);
    return code;
}

static int run(int argc, char **argv)
{
    const char *directory = NULL, *given[MAX_STUDIES];
    char *found[MAX_STUDIES];
    size_t directories = 0, json = 0, reuse = 0, operands, count;
    bool help;
    const struct option_spec specs[] = {{"-o", true, &directory, 1, &directories},
                                        {"--json", false, NULL, 0, &json},
                                        {"--reuse", false, NULL, 0, &reuse}};
    if (!command_options(&command_accuracy, argc, argv, specs, 3, given, MAX_STUDIES, &operands,
                         &help)) {
        return EXIT_USAGE;
    }
    if (help) {
        return EXIT_DONE;
    }
    const struct options options = {directories ? directory : "results/accuracy", json > 0,
                                    reuse > 0};
    if (!directories && mkdir("results", 0777) != 0 && errno != EEXIST) {
        fprintf(stderr, "results: %s\n", strerror(errno));
        return EXIT_IO;
    }
    if (mkdir(options.directory, 0777) != 0 && errno != EEXIST) {
        fprintf(stderr, "%s: %s\n", options.directory, strerror(errno));
        return EXIT_IO;
    }
    if (operands > 0) {
        return run_all((char *const *)given, operands, &options);
    }
    count = find_studies("accuracy", found);
    if (count == 0) {
        fputs("stance bench accuracy: no scenarios/accuracy here nor beside the program; name the "
              "scenarios\n",
              stderr);
        return EXIT_IO;
    }
    const int code = run_all(found, count, &options);
    for (size_t i = 0; i < count; i++) {
        free(found[i]);
    }
    return code;
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
    "`record.cases: all` positions and velocities are compared, otherwise outcomes. The cost is\n"
    "measured on one core, the median of at least three repetitions.\n"
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
