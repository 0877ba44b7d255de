/* command_summary.c - `stance summary FILE`: what came out, as text or JSON. */
#include "summary.h"

#include "runner/base/command.h"
#include "runner/base/sandbox.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

extern const struct command command_summary; /* below */

enum {
    TABLE_ROWS = 20,
    CHANGES_SHOWN = 10,
    WRAP = 100,
    INTERVAL = 21,
    EXTENT = 24,
    PAIR_COLUMNS = 6
};

static double percent(uint64_t k, uint64_t n)
{
    return n ? 100 * (double)k / (double)n : 0;
}

/* ---- text: what the study was ------------------------------------------------------------- */

static void print_head(const struct results *r)
{
    printf("%s\n%s: ", r->title[0] ? r->title : r->name, r->file);
    if (r->single)
        printf("case %llu", (unsigned long long)r->index);
    else
        printf("%llu case%s", (unsigned long long)r->cases, r->cases == 1 ? "" : "s");
    printf(", stance %s (%s), %s, %d rank%s\n", r->version, r->revision, r->date, r->ranks,
           r->ranks == 1 ? "" : "s");
}

static void print_axes(const struct results *r)
{
    char first[128], last[128];
    int width = 0;
    for (int a = 0; a < r->axes; a++) {
        int length = (int)strlen(r->axis[a].name);
        width = length > width ? length : width;
    }
    for (int k = 0; k < r->varied; k++) {
        int length = (int)strlen(r->vary[k].of.name) + 2;
        width = length > width ? length : width;
    }
    puts("\nVaried");
    for (int a = 0; a < r->axes; a++) {
        const struct results_axis *axis = &r->axis[a];
        if (a == r->sample) {
            printf("  %-*s  %zu points, %s\n", width, axis->name, axis->count, r->method);
            summary_print_varied(r, width > 2 ? width - 2 : width);
            continue;
        }
        results_value_text(axis, 0, false, first, sizeof first);
        results_value_text(axis, axis->count - 1, true, last, sizeof last);
        printf("  %-*s  %s ... %s, %zu value%s%s%s\n", width, axis->name, first, last, axis->count,
               axis->count == 1 ? "" : "s", axis->text[0] ? "; " : "", axis->text);
    }
}

/* One paragraph per group of fields: "robot: leg_length 0.535 m, ...", wrapped. */
static void print_fields(const struct summary *summary)
{
    char group[96] = "", word[300];
    int column = 0;
    if (summary->fields > 0)
        fputs("\nFixed", stdout);
    for (size_t i = 0; i < summary->fields; i++) {
        const struct summary_field *field = &summary->field[i];
        size_t length = strcspn(field->path, ".");
        const char *name = field->path[length] ? field->path + length + 1 : field->path;
        bool same = strncmp(group, field->path, length) == 0 && group[length] == '\0';
        snprintf(word, sizeof word, "%s %s%s%s", name, field->text, field->unit[0] ? " " : "",
                 field->unit);
        if (!same) {
            snprintf(group, sizeof group, "%.*s", (int)length, field->path);
            column = printf("\n  %-11s", group);
        } else if (column + 2 + (int)strlen(word) > WRAP) {
            printf(",\n  %-11s", "");
            column = 13;
        } else {
            column += printf(", ");
        }
        column += printf("%s", word);
    }
    if (summary->fields > 0)
        putchar('\n');
}

/* ---- text: outcomes ----------------------------------------------------------------------- */

static void print_share(const char *name, uint64_t k, uint64_t n, const struct interval *interval)
{
    printf("  %-11s%12llu  %7.3f %%", name, (unsigned long long)k, percent(k, n));
    if (!isnan(interval->low))
        printf("   (%.3f ... %.3f %%)", 100 * interval->low, 100 * interval->high);
    putchar('\n');
}

static void print_outcomes(const struct summary *summary, const struct results *r)
{
    const struct statistics_counts *counts = &summary->counts;
    printf("\nOutcomes of the %llu case%s done%s\n", (unsigned long long)counts->done,
           counts->done == 1 ? "" : "s", r->sample < 0 ? "" : ", with 95 % intervals");
    for (int k = 0; k < RESULTS_KIND_COUNT && summary_has_outcomes(summary); k++)
        if (k != RESULTS_PENDING && k != RESULTS_FAILED &&
            (counts->kind[k] > 0 || k != RESULTS_DONE))
            print_share(results_kind_names[k], counts->kind[k], counts->done, &summary->of_kind[k]);
    if (!summary_has_outcomes(summary)) {
        puts("  not stored in this file");
    } else if (r->sample >= 0 && r->cases > r->axis[r->sample].count) {
        puts("  (intervals, here and below: of the sample alone, whose points count however many "
             "cases\n"
             "  each has)");
    } else if (r->sample < 0 && counts->done > 1) {
        printf("  (of the grid; one case is %.2g %%)\n", 100 / (double)counts->done);
    }
    if (summary->inferred > 0) {
        printf("  of these %14llu  %7.3f %%   not simulated: inferred from neighbours that agree\n",
               (unsigned long long)summary->inferred, percent(summary->inferred, counts->done));
    }
    if (counts->kind[RESULTS_PENDING] > 0) {
        printf("  %-11s%12llu  not computed yet\n", "pending",
               (unsigned long long)counts->kind[RESULTS_PENDING]);
    }
    for (int f = 0; f < SUMMARY_FAILURES; f++) {
        if (summary->failures[f] > 0) {
            printf("  %-11s%12llu  %s: %s\n", "failed", (unsigned long long)summary->failures[f],
                   summary_failure_name(f), summary_failure_text(f));
        }
    }
}

/* ---- text: extents ------------------------------------------------------------------------ */

static const char *end_note(bool open, bool unknown)
{
    return open ? " (end of the axis)" : unknown ? " (next case pending or failed)" : "";
}

/* What became of the case from which an extent would be measured. */
static const char *start_text(enum results_kind kind)
{
    return kind == RESULTS_PENDING  ? "is not computed yet"
           : kind == RESULTS_FAILED ? "failed"
                                    : "is not stabilised";
}

static void print_extents(const struct summary *summary, const struct results *r)
{
    bool first = true;
    char at[128];
    for (int a = 0; a < r->axes; a++) {
        const struct statistics_extent *extent = &summary->extent[a];
        const struct results_axis *axis = &r->axis[a];
        if (!summary->has_extent[a])
            continue;
        if (first) {
            puts("\nExtent of the stabilised set through the equilibrium");
            first = false;
        }
        printf("  %s", axis->name);
        if (extent->any) {
            printf("  %.6g%s ... %.6g%s %s", extent->low,
                   end_note(extent->low_open, extent->low_unknown), extent->high,
                   end_note(extent->high_open, extent->high_unknown), axis->unit);
        } else {
            results_value_text(axis, extent->point[a], true, at, sizeof at);
            printf("  %s: the case nearest to the equilibrium (%s) %s",
                   extent->low_unknown ? "unknown" : "none", at, start_text(extent->kind));
        }
        bool also = false;
        for (int b = 0; b < r->axes; b++) {
            if (b != a && r->axis[b].offset) {
                results_value_text(&r->axis[b], extent->point[b], true, at, sizeof at);
                printf("%s%s = %s", also ? ", " : ", at ", r->axis[b].name, at);
                also = true;
            }
        }
        putchar('\n');
    }
}

/* ---- text: parameters --------------------------------------------------------------------- */

static const char *end_mark(bool open, bool unknown)
{
    return open ? "*" : unknown ? "?" : "";
}

/* "-0.09 ... 0.02*", with the marks that print_parameter explains; "-" for none, "?" for unknown.
 */
static void extent_text(const struct results *r, int offset, int axis, size_t i, char *buffer,
                        size_t size)
{
    size_t point[SCENARIO_MAX_AXES] = {0};
    struct statistics_extent extent;
    point[axis] = i;
    if (!statistics_extent(r, offset, point, &extent) || !extent.any) {
        snprintf(buffer, size, extent.low_unknown ? "?" : "-");
        return;
    }
    snprintf(buffer, size, "%.4g%s ... %.4g%s", extent.low,
             end_mark(extent.low_open, extent.low_unknown), extent.high,
             end_mark(extent.high_open, extent.high_unknown));
}

/* Row k of `rows` out of `count`, both ends included. */
static size_t spread(size_t k, size_t rows, size_t count)
{
    return rows >= count ? k : rows < 2 ? 0 : k * (count - 1) / (rows - 1);
}

static void print_parameter_head(const struct summary *summary, const struct results *r, int axis,
                                 const int *offsets, int shown)
{
    const struct results_axis *along = &r->axis[axis];
    printf("\n%s against %s%s%s%s%s%s\n",
           summary->judged == RESULTS_RESTED ? "Rested" : "Stabilised", along->name,
           along->unit[0] ? " (" : "", along->unit, along->unit[0] ? ")" : "",
           along->text[0] ? ": " : "", along->text);
    printf("  %14s %10s %10s   %-*s", "value", "done", "share",
           shown && r->sample >= 0 ? INTERVAL : 0, r->sample < 0 ? "" : "95 % interval");
    for (int k = 0; k < shown; k++)
        printf("  %-*s", k + 1 < shown ? EXTENT : 0, r->axis[offsets[k]].name);
    putchar('\n');
}

static void print_parameter_row(const struct summary *summary, const struct results *r, int axis,
                                size_t i, const int *offsets, int shown)
{
    const struct statistics_counts *counts = &summary->by_value[axis][i];
    char text[128];
    const struct interval *interval = &summary->interval[axis][i];
    const int width = shown && r->sample >= 0 ? INTERVAL : 0;
    results_value_text(&r->axis[axis], i, false, text, sizeof text);
    printf("  %14s %10llu", text, (unsigned long long)counts->done);
    if (counts->done == 0) {
        printf(" %10s   %-*s", "-", width, "none done");
    } else {
        text[0] = '\0';
        if (!isnan(interval->low)) {
            snprintf(text, sizeof text, "%.3f ... %.3f %%", 100 * interval->low,
                     100 * interval->high);
        }
        printf(" %8.3f %%   %-*s", 100 * summary_share(summary, counts), width, text);
    }
    for (int k = 0; k < shown; k++) {
        extent_text(r, offsets[k], axis, i, text, sizeof text);
        printf("  %-*s", k + 1 < shown ? EXTENT : 0, text);
    }
    putchar('\n');
}

/* The share is the same at every value. */
static bool is_even(const struct summary *summary, const struct results *r, int axis)
{
    const struct statistics_counts *counts = summary->by_value[axis];
    for (size_t i = 0; i < r->axis[axis].count; i++) {
        /* false for NAN, too */
        if (!(summary_share(summary, &counts[i]) == summary_share(summary, &counts[0])))
            return false;
    }
    return true;
}

static void print_parameter(const struct summary *summary, const struct results *r, int axis)
{
    const struct results_axis *along = &r->axis[axis];
    const struct statistics_counts *counts = summary->by_value[axis];
    size_t rows = along->count < TABLE_ROWS ? along->count : TABLE_ROWS;
    int offsets[2], shown = 0;
    char from[128], to[128];

    for (int a = 0; summary->parameters == 1 && r->sample < 0 && a < r->axes && shown < 2; a++)
        if (r->axis[a].offset && r->axis[a].count > 1)
            offsets[shown++] = a;
    if (shown == 0 && along->count > 1 && is_even(summary, r, axis)) {
        printf("\n%s against %s: %.3f %% at each of its %zu values\n",
               summary->judged == RESULTS_RESTED ? "Rested" : "Stabilised", along->name,
               100 * summary_share(summary, &counts[0]), along->count);
        return;
    }
    print_parameter_head(summary, r, axis, offsets, shown);
    for (size_t k = 0; k < rows; k++)
        print_parameter_row(summary, r, axis, spread(k, rows, along->count), offsets, shown);
    if (rows < along->count)
        printf("  (%zu of %zu values; --json has them all)\n", rows, along->count);
    if (shown > 0) {
        puts("  (the last columns: extent of the stabilised set through the equilibrium; * where "
             "it reaches\n  the end of the axis, ? where the next case is pending or failed)");
    }
    size_t i = summary->steepest[axis];
    if (along->count > 1 && fabs(summary_share(summary, &counts[i + 1]) -
                                 summary_share(summary, &counts[i])) > 0) { /* false for NAN */
        results_value_text(along, i, true, from, sizeof from);
        results_value_text(along, i + 1, true, to, sizeof to);
        printf("  changes most between %s (%.3f %%) and %s (%.3f %%)\n", from,
               100 * summary_share(summary, &counts[i]), to,
               100 * summary_share(summary, &counts[i + 1]));
    }
}

/* The shares of two parameters at once: a column for each value of the one with fewer. */
static void print_pairs(const struct summary *summary, const struct results *r)
{
    int across = r->axis[summary->pair[0]].count < r->axis[summary->pair[1]].count ? 0 : 1;
    const struct results_axis *down = &r->axis[summary->pair[1 - across]],
                              *columns = &r->axis[summary->pair[across]];
    size_t rows = down->count < TABLE_ROWS ? down->count : TABLE_ROWS;
    char text[128];

    if (columns->count > PAIR_COLUMNS || columns->count < 2 || down->count < 2)
        return;
    printf("\n%s (%%) against %s and, across, %s\n  %14s",
           summary->judged == RESULTS_RESTED ? "Rested" : "Stabilised", down->name, columns->name,
           "");
    for (size_t j = 0; j < columns->count; j++) {
        results_value_text(columns, j, false, text, sizeof text);
        printf(" %11s", text);
    }
    putchar('\n');
    for (size_t k = 0; k < rows; k++) {
        size_t i = spread(k, rows, down->count);
        results_value_text(down, i, false, text, sizeof text);
        printf("  %14s", text);
        for (size_t j = 0; j < columns->count; j++) {
            size_t place = across ? i * columns->count + j : j * down->count + i;
            double share = summary_share(summary, &summary->pair_counts[place]);
            snprintf(text, sizeof text, isnan(share) ? "-" : "%.3f", 100 * share);
            printf(" %11s", text);
        }
        putchar('\n');
    }
}

/* Where the outcome changes along the only axis. */
static void print_changes(const struct results *r)
{
    char from[128], to[128];
    size_t changes = 0;
    for (size_t i = 0; i + 1 < r->cases; i++) {
        if (r->kind[i] == r->kind[i + 1])
            continue;
        if (changes == 0)
            puts("\nThe outcome changes");
        if (changes++ < CHANGES_SHOWN) {
            results_value_text(&r->axis[0], i, true, from, sizeof from);
            results_value_text(&r->axis[0], i + 1, true, to, sizeof to);
            printf("  between %s (%s) and %s (%s)\n", from, results_kind_names[r->kind[i]], to,
                   results_kind_names[r->kind[i + 1]]);
        }
    }
    if (changes > CHANGES_SHOWN)
        printf("  and at %zu more places\n", changes - CHANGES_SHOWN);
}

/* ---- text: numbers ------------------------------------------------------------------------ */

static void print_numbers(const struct summary *summary)
{
    char name[64];
    bool first = true;
    for (int k = 0; k < SUMMARY_FIRST_RESIDUAL; k++) {
        const struct summary_numbers *row = &summary->numbers[k];
        if (!row->stored || row->numbers.n == 0 ||
            (k == SUMMARY_peak_torque && row->numbers.high == 0)) /* nothing is actuated */
            continue;
        if (first) {
            printf("\n%-26s %10s %10s %10s %10s %10s  %s\n", "Numbers", "smallest", "median",
                   "90 %", "99 %", "largest", "cases");
            first = false;
        }
        snprintf(name, sizeof name, "%s%s%s%s", row->name, row->unit[0] ? " (" : "", row->unit,
                 row->unit[0] ? ")" : "");
        printf("  %-24s %10.4g %10.4g %10.4g %10.4g %10.4g  %zu %s\n", name, row->numbers.low,
               row->numbers.median, row->numbers.q90, row->numbers.q99, row->numbers.high,
               row->numbers.n,
               row->of == RESULTS_KIND_COUNT ? "done" : results_kind_names[row->of]);
    }
}

/* The largest of all cases, in a line. */
static void print_residuals(const struct summary *summary)
{
    static const char *const names[] = {"Signorini", "Coulomb", "dissipation", "energy gained"};
    const char *separator = "\nLargest residuals: ";
    for (int k = SUMMARY_FIRST_RESIDUAL; k < SUMMARY_NUMBER_COUNT; k++) {
        const struct summary_numbers *row = &summary->numbers[k];
        if (row->stored && row->numbers.n > 0) {
            printf("%s%s %.3g%s%s", separator, names[k - SUMMARY_FIRST_RESIDUAL], row->numbers.high,
                   row->unit[0] ? " " : "", row->unit);
            separator = ", ";
        }
    }
    if (separator[0] == ',')
        putchar('\n');
}

static void print_cost(const struct summary *summary)
{
    const struct summary_count *steps = &summary->steps, *iterations = &summary->iterations,
                               *evaluations = &summary->evaluations;
    puts("\nCost");
    if (steps->stored) {
        printf("  %.6g time steps", steps->sum);
        if (iterations->sum > 0 && steps->sum > 0)
            printf(", %.4g Newton iterations per step", iterations->sum / steps->sum);
        if (evaluations->stored && steps->sum > 0 && evaluations->sum != iterations->sum)
            printf(", %.4g evaluations per step", evaluations->sum / steps->sum);
        putchar('\n');
    }
    if (summary->events.sum > 0) {
        printf("  events, changes of contact mode: %.6g, in %llu of the cases\n",
               summary->events.sum, (unsigned long long)summary->events.cases);
    }
    const double captured =
        summary->evidence.sum - (double)summary->evidence.cases - (double)summary->inferred;
    if (captured > 0)
        printf("  ended early in the captured set (evidence: inferred): %.6g cases\n", captured);
    if (summary->degraded.sum > 0) {
        printf("  samples at which decoupling could not do what it promises: %.6g, in %llu of the "
               "cases\n",
               summary->degraded.sum, (unsigned long long)summary->degraded.cases);
    }
    if (summary->subdivided.stored) {
        printf("  steps that had to be subdivided: %.6g, in %llu of the cases\n",
               summary->subdivided.sum, (unsigned long long)summary->subdivided.cases);
    }
    if (summary->ambiguous.stored) {
        printf("  steps with several contact solutions: %.6g, in %llu of the cases\n",
               summary->ambiguous.sum, (unsigned long long)summary->ambiguous.cases);
    }
    if (summary->timed) {
        printf("  %.4g s of computing on %zu rank%s (%.4g s together): %.4g cases/s\n",
               summary->longest, summary->ranks, summary->ranks == 1 ? "" : "s", summary->total,
               summary->timed_cases / summary->longest);
    } else {
        puts("  no times are recorded");
    }
}

/* ---- text: a single case ------------------------------------------------------------------ */

static const struct {
    const char *name, *text;
} case_times[] = {
    {"end_time", "ended at"}, {"settle_time", "settled at"}, {"fall_time", "fell at"}};
enum { CASE_TIMES = sizeof case_times / sizeof case_times[0] };

static size_t final_state(const struct results *r, char name[][32], double *state)
{
    size_t n = results_words(r, "state", name, SCENARIO_MAX_STATES);
    return n > 0 && results_numbers(r, "final_state", state, SCENARIO_MAX_STATES) == n ? n : 0;
}

static void print_case(const struct summary *summary, const struct results *r)
{
    char name[SCENARIO_MAX_STATES][32];
    double state[SCENARIO_MAX_STATES], time;
    int kind = r->kind[0];

    printf("\nOutcome: %s\n",
           kind == RESULTS_PENDING ? "not computed yet" : results_kind_names[kind]);
    if (kind == RESULTS_FAILED) {
        int failure = r->failure ? r->failure[0] : 0;
        printf("  %s: %s\n", summary_failure_name(failure), summary_failure_text(failure));
    }
    if (kind == RESULTS_PENDING || kind == RESULTS_FAILED)
        return;
    for (int k = 0; k < CASE_TIMES; k++)
        if (results_numbers(r, case_times[k].name, &time, 1) == 1 && !isnan(time))
            printf("  %-12s %.6g s\n", case_times[k].text, time);
    size_t n = final_state(r, name, state);
    for (size_t i = 0; i < n; i++) {
        printf("%s%s %.6g",
               i == 0       ? "  final state  "
               : i == n / 2 ? ",\n               "
                            : ", ",
               name[i], state[i]);
    }
    if (n > 0)
        putchar('\n');
    puts("\nNumbers");
    for (int k = 0; k < SUMMARY_FIRST_RESIDUAL; k++) {
        const struct summary_numbers *row = &summary->numbers[k];
        if (k != SUMMARY_settle_time && k != SUMMARY_fall_time &&
            results_numbers(r, row->name, &time, 1) == 1 && !isnan(time))
            printf("  %-18s %.6g%s%s\n", row->name, time, row->unit[0] ? " " : "", row->unit);
    }
}

/* Of a run that went on with another scenario. */
static void print_ancestry(const struct ancestry *ancestry)
{
    if (ancestry->scenarios == 1)
        return;
    printf("\nMade from %zu scenarios; what is said below of their keys is of the last one\n",
           ancestry->scenarios);
    for (size_t k = 0; k < ancestry->scenarios; k++) {
        printf("  since %-22s%12llu cases done\n", ancestry->date[k],
               (unsigned long long)ancestry->done[k]);
    }
}

static void print_text(const struct summary *summary, const struct results *r)
{
    print_head(r);
    print_ancestry(&summary->ancestry);
    if (!r->single)
        print_axes(r);
    print_fields(summary);
    if (r->single) {
        print_case(summary, r);
        print_residuals(summary);
        print_cost(summary);
        return;
    }
    print_outcomes(summary, r);
    bool outcomes = summary_has_outcomes(summary);
    if (outcomes)
        print_extents(summary, r);
    for (int a = 0; a < r->axes && outcomes; a++)
        if (summary->by_value[a])
            print_parameter(summary, r, a);
    if (summary->pair_counts && outcomes)
        print_pairs(summary, r);
    if (outcomes)
        summary_print_sample(summary, r);
    if (r->axes == 1 && r->sample < 0)
        print_changes(r);
    print_numbers(summary);
    print_residuals(summary);
    print_cost(summary);
}

/* ---- the command -------------------------------------------------------------------------- */

struct request {
    const char *file;
    bool json, csv;
};

static int summarise(void *context)
{
    const struct request *request = context;
    struct results r;
    stance_message message = {""};
    int code = EXIT_IO;
    struct summary *summary = calloc(1, sizeof *summary);

    if (!summary) {
        fputs("stance summary: not enough memory\n", stderr);
        return EXIT_IO;
    }
    if (!results_open(&r, request->file, &message)) {
        fprintf(stderr, "%s\n", message.text);
        free(summary);
        return EXIT_IO;
    }
    if (!summary_make(summary, &r, &message)) {
        fprintf(stderr, "%s\n", message.text);
    } else if (request->json && !summary_print_json(summary, &r)) {
        fputs("stance summary: the summary could not be written\n", stderr);
    } else {
        if (request->csv)
            summary_print_csv(summary, &r);
        else if (!request->json)
            print_text(summary, &r);
        code = EXIT_DONE;
    }
    summary_free(summary);
    results_close(&r);
    free(summary);
    return code;
}

static int run(int argc, char **argv)
{
    const char *file = NULL;
    size_t json = 0, csv = 0, operands = 0;
    bool help = false;
    const struct option_spec specs[] = {{"--json", false, NULL, 0, &json},
                                        {"--csv", false, NULL, 0, &csv}};

    if (!command_options(&command_summary, argc, argv, specs, 2, &file, 1, &operands, &help))
        return EXIT_USAGE;
    if (help)
        return EXIT_DONE;
    if (operands == 0) {
        fputs("stance summary: a results file is needed (stance summary -h explains)\n", stderr);
        return EXIT_USAGE;
    }
    if (json && csv) {
        fputs("stance summary: --json or --csv, not both\n", stderr);
        return EXIT_USAGE;
    }
    struct request request = {file, json > 0, csv > 0};
    return sandbox(summarise, &request, file);
}

const struct command command_summary = {
    "summary",
    "summary FILE [--json | --csv]",
    "what came out: outcomes, extent of the stabilised set, extremes, cost",
    run,
    "Works on files that are not finished, too. Shares are of the cases that are done. Those of a\n"
    "grid have no intervals: its cases are no draws, and how much of the space between them has "
    "an\n"
    "outcome `stance basin` says. With sweep.sample shares have 95 % intervals of the sample: "
    "what\n"
    "scatters are its points (of saltelli and morris blocks), not the cases that each has on grid\n"
    "axes. An extent is the unbroken stretch of stabilised cases through the equilibrium along one "
    "axis of offsets, on the line where the other offsets are nearest to\n"
    "zero; it ends midway between the last stabilised case and the next one.\n"
    "\n"
    "  --csv    the counts of all cases, then a row for every value of every parameter: "
    "parameter,\n"
    "           value, done, failed, pending, stabilised, rested, fell, undecided, and the share\n"
    "           of stabilised cases (without a controller that has a target: rested ones) with\n"
    "           its interval low ... high (of a grid empty); `stance table` has the cases "
    "themselves\n"
    "  --json   the same as JSON; what does not apply is left out or null. Keys\n"
    "    file, title, version, revision, date, ranks\n"
    "    scenarios    [{date, done}] of a file that went on with another scenario, the first one\n"
    "                 first: since when, cases done with it\n"
    "    axes         [{path, unit, long_name, count, first, last}]\n"
    "    fixed        {path: value} of the fields that do not vary\n"
    "    cases        total, done, failed, pending; inferred: done, but not simulated (refined "
    "map);\n"
    "                 damaged: pending, because their checksums do not fit\n"
    "    failures     {reason: count}\n"
    "    outcomes     {name: {count, share, low, high}} of the cases done\n"
    "    extents      [{path, unit, outcome, stabilised, low, high, low_at_end, high_at_end,\n"
    "                 low_unknown, high_unknown, at: {path: value}}]; outcome of the case nearest\n"
    "                 to the equilibrium; where that is pending or failed stabilised is null\n"
    "    parameters   [{path, unit, share_of, values: [{value, done, failed, pending,\n"
    "                 stabilised, rested, share, low, high, extents: {path: [low, high]}}],\n"
    "                 steepest: {from, to}}]; share_of: stabilised, or without a controller\n"
    "                 that has a target rested; an extent is [] for none, null for unknown\n"
    "    pairs        of two parameters, no more: {paths: [2], share: [[...]]}, a row for each\n"
    "                 value of the first, a column for each of the second; null where none done\n"
    "    changes      [{from, to, before, after}] along the axis of a sweep with one axis\n"
    "    sample       null, or of sweep.sample {method, points, share_of, varied, rays}: varied\n"
    "                 [{path, unit, factor, parts: [{from, to, done, share, low, high}]}], parts\n"
    "                 of equally many points or one for each value; rays, beside one axis of\n"
    "                 offsets, null or {path, points, smallest, median, largest, nearest, at,\n"
    "                 reach_end, none, unknown}: where the stabilised set ends along it; `at`\n"
    "                 the values at the point of the smallest, offsets times the scale\n"
    "    numbers      {answer: {of, unit, count, smallest, median, q90, q99, largest}}\n"
    "    cost         steps, iterations, iterations_per_step, evaluations, events, events_cases,\n"
    "                 subdivided_steps, subdivided_cases, degraded_samples, degraded_cases,\n"
    "                 ambiguous_steps, ambiguous_cases,\n"
    "                 wall_time (s, of the slowest rank), total_time (s, all ranks),\n"
    "                 cases_per_second\n"
    "    case         of a file of one case: index, outcome, failure, end_time, settle_time,\n"
    "                 fall_time, final_state {name: value}\n",
};
