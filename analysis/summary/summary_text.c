/* summary_text.c - the summary for people. */
#include "summary.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>

enum { TABLE_ROWS = 20, CHANGES_SHOWN = 10, WRAP = 100, PAIR_COLUMNS = 6 };

/* ---- what the study was ------------------------------------------------------------- */

static void print_head(const struct results *r)
{
    printf("%s\n%s: ", r->title[0] ? r->title : r->name, r->file);
    if (r->single)
        printf("case %" PRIu64, r->index);
    else
        printf("%" PRIu64 " case%s", r->cases, r->cases == 1 ? "" : "s");
    if (r->shard.count > 0 && r->shard.count <= r->cases) {
        const struct shard shard = shard_of(&r->shard, r->cases);
        printf(", of which shard %" PRIu64 "/%" PRIu64 " has %" PRIu64, shard.number, shard.count,
               shard_rows(&shard));
    }
    printf(", stance %s (%s), %s, %d rank%s\n", r->version, r->revision, r->date, r->ranks,
           r->ranks == 1 ? "" : "s");
}

static void print_varied(const struct results *r, int width)
{
    char first[128], last[128];
    for (int k = 0; k < r->varied; k++) {
        const struct results_varied *v = &r->vary[k];
        size_t low = 0, high = 0;
        for (size_t i = 1; i < v->of.count; i++) {
            low = v->of.value[i] < v->of.value[low] ? i : low;
            high = v->of.value[i] > v->of.value[high] ? i : high;
        }
        results_varied_text(v, low, false, first, sizeof first);
        results_varied_text(v, high, true, last, sizeof last);
        printf("    %-*s  %s ... %s%s%s\n", width, v->of.name, first, last,
               v->of.text[0] ? "; " : "", v->of.text);
    }
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
            print_varied(r, width > 2 ? width - 2 : width);
            continue;
        }
        const char *const order = results_ends_text(axis, first, last, sizeof first);
        printf("  %-*s  %s ... %s, %zu value%s%s%s%s\n", width, axis->name, first, last,
               axis->count, axis->count == 1 ? "" : "s", order, axis->text[0] ? "; " : "",
               axis->text);
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

/* ---- outcomes ----------------------------------------------------------------------- */

/* Whether the share is the box's. */
static void print_cut(const struct summary *summary)
{
    char text[2048];
    faces_text(&summary->faces, summary->cut, text, sizeof text);
    if (summary->cut)
        printf("  %s set cut by the box at %s:\n  its share is the box's (stance basin has what "
               "does not depend on it)\n",
               results_kind_names[summary->judged], text);
    else if (summary->faces.starts > 0 && summary->counts.kind[summary->judged] > 0)
        printf("  %s set %s by the box: no start on its faces is in it\n",
               results_kind_names[summary->judged],
               summary->counts.done < summary->faces.r->cases ? "not known to be cut" : "not cut");
}

static bool print_outcomes(const struct summary *summary, const struct results *r)
{
    const struct statistics_counts *counts = &summary->counts;
    struct table t = {0};
    bool good = true;
    printf("\nOutcomes of the %" PRIu64 " case%s done%s\n", counts->done,
           counts->done == 1 ? "" : "s", r->sample < 0 ? "" : ", with 95 % intervals");
    if (summary_has_outcomes(summary)) {
        summary_outcomes(&t, summary);
        good = table_print(&t, TABLE_AS_TEXT, "outcome count share low high", 0);
    }
    if (!summary_has_outcomes(summary)) {
        puts("  not stored in this file");
    } else if (r->sample >= 0 && r->cases > r->axis[r->sample].count) {
        puts("  (intervals, here and below: of the sample alone, whose points count however many "
             "cases\n"
             "  each has)");
    } else if (r->sample < 0 && counts->done > 1) {
        printf("  (of the grid; one case is %.2g %%)\n", 100 / (double)counts->done);
    }
    if (summary_has_outcomes(summary))
        print_cut(summary);
    /* Where there is no boundary to be seen. */
    const bool starts = summary->faces.starts > 0 && counts->done > 1;
    if (starts && counts->kind[RESULTS_STABILISED] == counts->done)
        puts("  the ranges end within the domain: stance ranges SCENARIO finds how far it goes");
    else if (starts && counts->kind[RESULTS_FELL] == counts->done)
        puts("  the ranges do not meet a domain: stance ranges SCENARIO finds where one is");
    for (int k = 1; k < STANCE_MAX_WORDS; k++) {
        if (summary->fallen_by[k] > 0)
            printf("  fell by %16" PRIu64 "  %7.3f %%   %s\n", summary->fallen_by[k],
                   100 * (double)summary->fallen_by[k] / (double)counts->done, summary->cause[k]);
    }
    if (summary->inferred > 0) {
        printf("  of these %14" PRIu64
               "  %7.3f %%   not simulated: inferred from neighbours that agree\n",
               summary->inferred, 100 * (double)summary->inferred / (double)counts->done);
    }
    if (counts->kind[RESULTS_PENDING] > 0)
        printf("  %-11s%12" PRIu64 "  not computed yet%s\n", "pending",
               counts->kind[RESULTS_PENDING], r->shard.count > 1 ? ", or of other shards" : "");
    for (int f = 0; f < SUMMARY_FAILURES; f++) {
        if (summary->failures[f] > 0) {
            printf("  %-11s%12" PRIu64 "  %s: %s\n", "failed", summary->failures[f],
                   summary_failure_name(f), summary_failure_text(f));
        }
    }
    if (counts->kind[RESULTS_FAILED] > 0 && !r->single)
        printf("  the first is case %" PRIu64 ": `stance run SCENARIO --only %" PRIu64
               " --trace`, and `stance summary` of that says\n  when it failed and what touched\n",
               summary->first_failed, summary->first_failed);
    return good;
}

/* ---- extents ------------------------------------------------------------------------ */

static const char *end_note(bool open, bool unknown)
{
    return open ? " (end of the axis)" : unknown ? " (next case pending or failed)" : "";
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
                   extent->low_unknown ? "unknown" : "none", at,
                   extent->kind == RESULTS_PENDING  ? "is not computed yet"
                   : extent->kind == RESULTS_FAILED ? "failed"
                                                    : "is not stabilised");
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

/* ---- parameters --------------------------------------------------------------------- */

static bool print_parameter(const struct summary *summary, const struct results *r, int axis)
{
    const struct results_axis *along = &r->axis[axis];
    const struct statistics_counts *counts = summary->by_value[axis];
    char from[128], to[128];
    struct table t = {0};
    bool extents = false, even = along->count > 1; /* the share is the same at every value */

    for (size_t i = 0; i < along->count; i++) /* not where there is none */
        even = even && summary_share(summary, &counts[i]) == summary_share(summary, &counts[0]);
    for (int a = 0; summary->parameters == 1 && r->sample < 0 && a < r->axes; a++)
        extents = extents || (r->axis[a].offset && r->axis[a].count > 1);
    if (!extents && even) {
        printf("\n%s against %s: %.3f %% at each of its %zu values\n", summary_judged_word(summary),
               along->name, 100 * summary_share(summary, &counts[0]), along->count);
        return true;
    }
    printf("\n%s against %s%s%s%s%s%s\n", summary_judged_word(summary), along->name,
           along->unit[0] ? " (" : "", along->unit, along->unit[0] ? ")" : "",
           along->text[0] ? ": " : "", along->text);
    summary_values(&t, summary, r, axis, TABLE_AS_TEXT);
    const bool good =
        table_print(&t, TABLE_AS_TEXT, "value done share low high extent/", TABLE_ROWS);
    if (extents) {
        puts("  (the last columns: extent of the stabilised set through the equilibrium; * where "
             "it reaches\n  the end of the axis, ? where the next case is pending or failed)");
    }
    const size_t i = summary->steepest[axis];
    if (along->count > 1 && fabs(summary_share(summary, &counts[i + 1]) -
                                 summary_share(summary, &counts[i])) > 0) { /* false for NAN */
        results_value_text(along, i, true, from, sizeof from);
        results_value_text(along, i + 1, true, to, sizeof to);
        printf("  changes most between %s (%.3f %%) and %s (%.3f %%)\n", from,
               100 * summary_share(summary, &counts[i]), to,
               100 * summary_share(summary, &counts[i + 1]));
    }
    return good;
}

/* The shares of two parameters at once: a column for each value of the one with fewer. */
static bool print_pairs(const struct summary *summary, const struct results *r)
{
    const int across = r->axis[summary->pair[0]].count < r->axis[summary->pair[1]].count ? 0 : 1;
    const struct results_axis *down = &r->axis[summary->pair[1 - across]],
                              *columns = &r->axis[summary->pair[across]];
    struct table t = {0};
    char text[128];

    if (columns->count > PAIR_COLUMNS || columns->count < 2 || down->count < 2)
        return true;
    printf("\n%s (%%) against %s and, across, %s\n", summary_judged_word(summary), down->name,
           columns->name);
    for (size_t i = 0; i < down->count; i++) {
        TABLE_FACTS(&t, {{"value", "", .width = 14, .group = "seen"}, as_place(down, i)});
        for (size_t j = 0; j < columns->count; j++) {
            const size_t place = across ? i * columns->count + j : j * down->count + i;
            results_value_text(columns, j, false, text, sizeof text);
            TABLE_FACTS(&t, {{"share", text, "%.3f", .width = 11, .percent = true, .group = "seen"},
                             as_number(summary_share(summary, &summary->pair_counts[place]))});
        }
        table_end_row(&t);
    }
    return table_print(&t, TABLE_AS_TEXT, "seen/", TABLE_ROWS);
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

/* ---- numbers ------------------------------------------------------------------------ */

/* The largest of all cases, in a line. */
static void print_residuals(const struct summary *summary)
{
    static const char *const names[] = {"Signorini", "Coulomb", "dissipation", "energy gained",
                                        "drifted"};
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
    const struct summary_count *count = summary->count;
    const double steps = count[SUMMARY_steps].sum, iterations = count[SUMMARY_iterations].sum,
                 evaluations = count[SUMMARY_evaluations].sum;
    puts("\nCost");
    if (count[SUMMARY_steps].stored) {
        printf("  %.6g time steps", steps);
        if (iterations > 0 && steps > 0)
            printf(", %.4g Newton iterations per step", iterations / steps);
        if (count[SUMMARY_evaluations].stored && steps > 0 && evaluations != iterations)
            printf(", %.4g evaluations per step", evaluations / steps);
        putchar('\n');
    }
    for (int k = 0; k < SUMMARY_COUNT_COUNT; k++) {
        const bool told = k < SUMMARY_subdivided_steps ? count[k].sum > 0 : count[k].stored;
        if (count[k].text && told) {
            printf("  %s: %.6g, in %" PRIu64 " of the cases\n", count[k].text, count[k].sum,
                   count[k].cases);
        }
    }
    if (summary->timed) {
        printf("  %.4g s of computing on %zu rank%s (%.4g s together): %.4g cases/s\n",
               summary->longest, summary->ranks, summary->ranks == 1 ? "" : "s", summary->total,
               summary->timed_cases / summary->longest);
    } else {
        puts("  no times are recorded");
    }
}

/* ---- a single case ------------------------------------------------------------------ */

static void print_case(const struct summary *summary, const struct results *r)
{
    static const char *const times[][2] = {
        {"end_time", "ended at"}, {"settle_time", "settled at"}, {"fall_time", "fell at"}};
    char name[SCENARIO_MAX_STATES][SCENARIO_NAME];
    double state[SCENARIO_MAX_STATES], time;
    int kind = r->kind[0];

    printf("\nOutcome: %s\n",
           kind == RESULTS_PENDING ? "not computed yet" : results_kind_names[kind]);
    if (kind == RESULTS_FAILED) {
        int failure = r->failure ? r->failure[0] : 0;
        printf("  %s: %s\n", summary_failure_name(failure), summary_failure_text(failure));
        if (results_numbers(r, "end_time", &time, 1) == 1 && !isnan(time))
            printf("  in the step from %.6g s\n", time);
        const char *between = "  touching     ";
        for (int c = 0; c < STANCE_MAX_CONTACTS; c++)
            if (summary->touching >> c & 1) {
                printf("%s%s", between, summary->contact[c]);
                between = ", ";
            }
        if (summary->touching)
            putchar('\n');
    }
    if (kind == RESULTS_PENDING || kind == RESULTS_FAILED)
        return;
    for (size_t k = 0; k < sizeof times / sizeof times[0]; k++)
        if (results_numbers(r, times[k][0], &time, 1) == 1 && !isnan(time))
            printf("  %-12s %.6g s\n", times[k][1], time);
    for (int k = 1; k < STANCE_MAX_WORDS; k++)
        if (summary->fallen_by[k] > 0)
            printf("  %-12s %s\n", "fell by", summary->cause[k]);
    const size_t n = summary_final_state(r, name, state);
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

/* ---- samples ------------------------------------------------------------------------ */

static void print_rays(const struct summary *summary, const struct results *r)
{
    const struct summary_rays *rays = summary->rays;
    const struct results_axis *axis = &r->axis[summary->ray_axis];
    const struct statistics_numbers *n = &rays->numbers;
    char text[128];

    printf("\nWhere the stabilised set through the equilibrium ends along %s\n", axis->name);
    if (n->n > 0) {
        printf("  smallest %.6g, median %.6g, largest %.6g %s%sof %zu points", n->low, n->median,
               n->high, axis->unit, axis->unit[0] ? " " : "", n->n);
        if (rays->open > 0) {
            printf(", of which %zu reach%s the end of the axis", rays->open,
                   rays->open == 1 ? "es" : "");
        }
        printf("\n  the smallest at point %zu:", rays->nearest);
        for (int k = 0; k < r->varied; k++) {
            double value = summary_nearest(rays, r, k);
            struct results_varied one = r->vary[k];
            one.of.value = &value;
            results_varied_text(&one, 0, true, text, sizeof text);
            printf("%s %s = %s", k ? "," : "", one.of.name, text);
        }
        putchar('\n');
    }
    if (rays->none > 0) {
        printf(
            "  none at %zu points, where the case nearest to the equilibrium is not stabilised\n",
            rays->none);
    }
    if (rays->unknown > 0)
        printf("  unknown at %zu points, where cases are pending or failed\n", rays->unknown);
}

static bool print_sample(const struct summary *summary, const struct results *r)
{
    struct table t = {0};
    if (summary->rays)
        print_rays(summary, r);
    if (!summary->bins)
        return true;
    printf("\n%s against what the sample varies, in parts of equally many points\n",
           summary_judged_word(summary));
    for (int k = 0; k < r->varied; k++)
        summary_parts(&t, summary, r, k);
    const bool good = table_print(&t, TABLE_AS_TEXT, "path values done share low high", 0);
    if (r->axes > 1)
        puts("  (intervals: cases of a point are not independent; what scatters are points)");
    return good;
}

/* ---- all of it ---------------------------------------------------------------------------- */

/* What came out, case by case of a sweep; false: no memory. */
static bool print_sweep(const struct summary *summary, const struct results *r)
{
    const bool outcomes = summary_has_outcomes(summary);
    bool good = print_outcomes(summary, r);
    if (outcomes)
        print_extents(summary, r);
    for (int a = 0; a < r->axes && outcomes; a++)
        if (summary->by_value[a])
            good = print_parameter(summary, r, a) && good;
    if (summary->pair_counts && outcomes)
        good = print_pairs(summary, r) && good;
    if (outcomes)
        good = print_sample(summary, r) && good;
    if (r->axes == 1 && r->sample < 0)
        print_changes(r);
    struct table t = {0};
    summary_answers(&t, summary, TABLE_AS_TEXT);
    if (table_rows(&t) > 0)
        putchar('\n');
    return table_print(&t, TABLE_AS_TEXT, "label smallest median q90 q99 largest count of", 0) &&
           good;
}

bool summary_print_text(const struct summary *summary, const struct results *r)
{
    bool good = true;
    const struct ancestry *const ancestry = &summary->ancestry;
    print_head(r);
    if (ancestry->scenarios > 1)
        printf("\nMade from %zu scenarios; what is said below of their keys is of the last one\n",
               ancestry->scenarios);
    for (size_t k = 0; ancestry->scenarios > 1 && k < ancestry->scenarios; k++)
        printf("  since %-22s%12" PRIu64 " cases done\n", ancestry->date[k], ancestry->done[k]);
    if (!r->single)
        print_axes(r);
    print_fields(summary);
    if (r->single)
        print_case(summary, r);
    else
        good = print_sweep(summary, r);
    if (summary->through > 0) /* which no picture of outcomes shows */
        printf("\nThrough the ground, with a contact that ground.contacts leaves out: %" PRIu64
               " case%s, of which %" PRIu64 " %s\n",
               summary->through, summary->through == 1 ? "" : "s", summary->through_judged,
               results_kind_names[summary->judged]);
    print_residuals(summary);
    print_cost(summary);
    return good && !ferror(stdout);
}
