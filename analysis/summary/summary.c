/* summary.c - collects what `stance summary` prints. */
#include "summary.h"

#include "analysis/statistics/statistics.h"
#include "runner/store/results_rows.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

double summary_share(const struct summary *summary, const struct statistics_counts *counts)
{
    return counts->done ? (double)counts->kind[summary->judged] / (double)counts->done : NAN;
}

bool summary_has_outcomes(const struct summary *summary)
{
    return summary->counts.done == 0 || summary->counts.kind[RESULTS_DONE] < summary->counts.done;
}

#define SUMMARY_TOUCHES 1e-9 /* m, rad */

const char *summary_failure_name(int failure)
{
    return failure >= 0 && failure < STANCE_FAILURE_COUNT ? stance_failure_name[failure]
                                                          : "unknown";
}

const char *summary_failure_text(int failure)
{
    return failure > 0 && failure < STANCE_FAILURE_COUNT ? stance_failure_text[failure]
                                                         : "the file does not say why";
}

const char *summary_judged_word(const struct summary *summary)
{
    return summary->judged == RESULTS_RESTED ? "Rested" : "Stabilised";
}

size_t summary_final_state(const struct results *r, char name[][SCENARIO_NAME], double *state)
{
    const size_t n = results_words(r, "state", name, SCENARIO_MAX_STATES);
    const bool done = r->kind[0] != RESULTS_PENDING && r->kind[0] != RESULTS_FAILED;
    return done && results_numbers(r, "final_state", state, SCENARIO_MAX_STATES) == n ? n : 0;
}

/* ---- the answers -------------------------------------------------------------------------- */

static bool collect_numbers(struct summary *summary, const struct results *r,
                            stance_message *message)
{
    static const struct summary_numbers wanted[SUMMARY_NUMBER_COUNT] = {
#define SUMMARY_NUMBER(name, kind, unit) [SUMMARY_##name] = {#name, unit, kind, false, {0}},
        SUMMARY_NUMBERS(SUMMARY_NUMBER)
#undef SUMMARY_NUMBER
    };
    for (int k = 0; k < SUMMARY_NUMBER_COUNT; k++) {
        struct summary_numbers *numbers = &summary->numbers[k];
        double *values;
        *numbers = wanted[k];
        numbers->of = numbers->of == RESULTS_STABILISED ? summary->judged : numbers->of;
        if (!results_answer(r, numbers->name, &values, message))
            return false;
        if (!values)
            continue;
        for (uint64_t i = 0; k == SUMMARY_through_ground && i < r->cases; i++) {
            const bool through = values[i] > SUMMARY_THROUGH; /* false for NAN, too */
            summary->through += through;
            summary->through_judged += through && r->kind[i] == summary->judged;
        }
        for (uint64_t i = 0; numbers->of != RESULTS_KIND_COUNT && i < r->cases; i++)
            values[i] = r->kind[i] == numbers->of ? values[i] : NAN;
        numbers->stored = true;
        statistics_summarise(values, (size_t)r->cases, &numbers->numbers);
        free(values);
    }
    return true;
}

static bool collect_counts(struct summary *summary, const struct results *r,
                           stance_message *message)
{
    static const struct summary_count wanted[SUMMARY_COUNT_COUNT] = {
#define SUMMARY_COUNT(name, cases, text) {#name, cases, text, false, 0, 0},
        SUMMARY_COUNTS(SUMMARY_COUNT)
#undef SUMMARY_COUNT
    };
    for (int k = 0; k < SUMMARY_COUNT_COUNT; k++) {
        struct summary_count *count = &summary->count[k];
        double *values;
        *count = wanted[k];
        if (!results_answer(r, count->name, &values, message))
            return false;
        for (uint64_t i = 0; values && i < r->cases; i++) {
            if (values[i] > 0) { /* false for NAN, too */
                count->sum += values[i];
                count->cases++;
            }
        }
        count->stored = values != NULL;
        free(values);
    }
    return true;
}

static void collect_failures(struct summary *summary, const struct results *r)
{
    summary->first_failed = UINT64_MAX;
    for (uint64_t i = 0; i < r->cases; i++) {
        if (r->kind[i] == RESULTS_FAILED) {
            int failure = r->failure ? r->failure[i] : 0;
            summary->failures[failure < SUMMARY_FAILURES ? failure : 0]++;
            summary->first_failed = i < summary->first_failed ? i : summary->first_failed;
        }
    }
}

/* Contacts on the ground, stops reached, where a file's one case failed. */
static void collect_touching(struct summary *summary, const struct results *r,
                             const struct scenario *s)
{
    const stance_scene *const scene = s->scene;
    struct scenario_values values = s->base;
    double state[SCENARIO_MAX_STATES], gap[STANCE_MAX_CONTACTS];
    if (!r->single || r->kind[0] != RESULTS_FAILED || (s->axes > 0 && r->index >= s->cases) ||
        results_numbers(r, "final_state", state, SCENARIO_MAX_STATES) !=
            2 * (size_t)scene->coordinates)
        return;
    if (s->axes > 0)
        scenario_case_values(s, r->index, &values);
    scene->gaps(scene, values.robot, state, gap);
    for (int c = 0; c < scene->contacts; c++) {
        const bool stop = scene->grip[c] < 0;
        if (gap[c] <= SUMMARY_TOUCHES && (stop || values.contacts >> c & 1))
            summary->touching |= 1u << c;
        snprintf(summary->contact[c], STANCE_NAME, "%s", scene->contact_name[c]);
    }
}

static bool collect_causes(struct summary *summary, const struct results *r,
                           stance_message *message)
{
    struct results_column column;
    double *values = NULL;
    if (!results_column_open(r, stance_answers[STANCE_ANSWER_fall_cause].name, &column, message))
        return false;
    char *rest = column.words;
    for (int k = 0; rest && k < STANCE_MAX_WORDS; k++)
        snprintf(summary->cause[k], sizeof summary->cause[k], "%s", strsep(&rest, " "));
    const bool good = column.id < 0 || results_answer(r, column.name, &values, message);
    for (uint64_t i = 0; values && i < r->cases; i++)
        if (r->kind[i] == RESULTS_FELL && values[i] >= 0 && values[i] < STANCE_MAX_WORDS)
            summary->fallen_by[(int)values[i]]++;
    free(values);
    results_column_close(&column);
    return good;
}

enum { BINS = 4 };

/* By the values of what a sample varies. */
static bool collect_bins(struct summary *summary, const struct results *r, stance_message *message)
{
    summary->bins = r->sample < 0 ? NULL : calloc((size_t)r->varied, sizeof *summary->bins);
    bool good = summary->bins || r->sample < 0 || statistics_no_memory(r, message);
    for (int k = 0; good && summary->bins && k < r->varied; k++)
        good = doe_bins_make(&summary->bins[k], r, k, BINS, message);
    return good;
}

/* Along the rays that an axis of offsets makes of the points of a sample. */
static bool collect_rays(struct summary *summary, const struct results *r, stance_message *message)
{
    int axis = -1;
    for (int a = 0; a < r->axes; a++) {
        if (a != r->sample && (axis >= 0 || !r->axis[a].offset))
            return true;
        axis = a != r->sample ? a : axis;
    }
    if (r->sample < 0 || axis < 0)
        return true;
    const size_t points = r->axis[r->sample].count;
    double *end = malloc(points * sizeof *end), smallest = INFINITY;
    summary->ray_axis = axis;
    summary->rays = calloc(1, sizeof *summary->rays);
    if (!end || !summary->rays) {
        free(end);
        return statistics_no_memory(r, message);
    }
    for (size_t i = 0; i < points; i++) {
        size_t point[SCENARIO_MAX_AXES] = {0};
        struct statistics_extent extent;
        point[r->sample] = i;
        end[i] = NAN;
        const bool found = statistics_extent(r, axis, point, &extent);
        if (found && !extent.any && !extent.low_unknown) {
            summary->rays->none++;
        } else if (!found || !extent.any || extent.high_unknown) {
            summary->rays->unknown++;
        } else {
            end[i] = extent.high;
            summary->rays->open += extent.high_open;
            summary->rays->nearest = extent.high < smallest ? i : summary->rays->nearest;
            smallest = fmin(smallest, extent.high);
        }
    }
    statistics_summarise(end, points, &summary->rays->numbers);
    const bool scaled = strcmp(r->axis[axis].name, "initial.offset.scale") == 0;
    summary->rays->scale = scaled ? smallest : 1;
    free(end);
    return true;
}

double summary_nearest(const struct summary_rays *rays, const struct results *r, int k)
{
    const struct results_varied *v = &r->vary[k];
    const bool offset = strncmp(v->of.name, "initial.offset.", strlen("initial.offset.")) == 0;
    return v->of.value[rays->nearest] * (offset ? rays->scale : 1);
}

static bool collect_axes(struct summary *summary, const struct results *r, stance_message *message)
{
    const size_t origin[SCENARIO_MAX_AXES] = {0};
    for (int a = 0; !r->single && a < r->axes; a++) {
        if (!r->axis[a].offset && a != r->sample) {
            summary->pair[summary->parameters < 2 ? summary->parameters : 1] = a;
            summary->parameters++;
        }
    }
    if (summary->parameters == 2) {
        const int a = summary->pair[0], b = summary->pair[1];
        summary->pair_counts =
            malloc(r->axis[a].count * r->axis[b].count * sizeof *summary->pair_counts);
        if (!summary->pair_counts)
            return statistics_no_memory(r, message);
        statistics_count_pair(r, a, b, summary->pair_counts);
    }
    for (int a = 0; !r->single && a < r->axes; a++) {
        const struct results_axis *axis = &r->axis[a];
        if (a == r->sample)
            continue;
        if (axis->offset) {
            summary->has_extent[a] = summary->parameters == 0 && r->sample < 0 &&
                                     statistics_extent(r, a, origin, &summary->extent[a]);
            continue;
        }
        struct statistics_counts *counts = malloc(axis->count * sizeof *counts);
        summary->interval[a] = malloc(axis->count * sizeof *summary->interval[a]);
        if (!counts || !summary->interval[a] ||
            !intervals_find(r, summary->judged, a, NULL, axis->count, summary->interval[a])) {
            free(counts);
            return statistics_no_memory(r, message);
        }
        summary->by_value[a] = counts;
        statistics_count_axis(r, a, counts);
        double largest = 0;
        for (size_t i = 0; i + 1 < axis->count; i++) {
            double change =
                fabs(summary_share(summary, &counts[i + 1]) - summary_share(summary, &counts[i]));
            if (change > largest) {
                largest = change;
                summary->steepest[a] = i;
            }
        }
    }
    return true;
}

static bool collect_intervals(struct summary *summary, const struct results *r,
                              stance_message *message)
{
    bool good = true;
    for (int kind = 0; good && kind < RESULTS_KIND_COUNT; kind++) {
        summary->of_kind[kind] = (struct interval){NAN, NAN};
        if (kind != RESULTS_PENDING && kind != RESULTS_FAILED && r->sample >= 0)
            good = intervals_find(r, (enum results_kind)kind, -1, NULL, 1, &summary->of_kind[kind]);
    }
    return good || statistics_no_memory(r, message);
}

/* ---- all of it ---------------------------------------------------------------------------- */

enum results_kind summary_judged(const struct scenario *s)
{
    return scenario_law(&s->base)->designed ? RESULTS_STABILISED : RESULTS_RESTED;
}

bool summary_make(struct summary *summary, const struct results *r, stance_message *message)
{
    struct scenario s;
    /* A scenario of another version cannot be read: the summary goes without. */
    const bool readable = results_scenario(r, &s);
    *summary = (struct summary){.judged = readable ? summary_judged(&s) : RESULTS_STABILISED};
    statistics_count(r, -1, 0, &summary->counts);
    faces_make(&summary->faces, r, NULL, 0);
    summary->cut = faces_cut(&summary->faces, summary->judged);
    collect_failures(summary, r);
    bool good = collect_intervals(summary, r, message) && collect_numbers(summary, r, message) &&
                collect_counts(summary, r, message) && collect_causes(summary, r, message) &&
                statistics_inferred(r, &summary->inferred, NULL, message) &&
                collect_axes(summary, r, message) && collect_bins(summary, r, message) &&
                collect_rays(summary, r, message) && ancestry_read(r, &summary->ancestry, message);
    if (good) {
        summary->timed = results_timing(r, &summary->longest, &summary->total,
                                        &summary->timed_cases, &summary->ranks);
        if (readable) {
            summary_collect_fields(summary, r, &s);
            collect_touching(summary, r, &s);
        }
    } else {
        summary_free(summary);
    }
    if (readable)
        scenario_free(&s);
    return good;
}

void summary_free(struct summary *summary)
{
    for (int a = 0; a < SCENARIO_MAX_AXES; a++) {
        free(summary->by_value[a]);
        free(summary->interval[a]);
    }
    free(summary->pair_counts);
    free(summary->bins);
    free(summary->rays);
    *summary = (struct summary){0};
}
