/* failure.c - judges every cell of the maps of a failure study. */
#include "failure.h"
#include "studies.h"

#include "runner/base/message.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const struct failure_style failure_styles[FAILURE_VERDICT_COUNT] = {
#define FAILURE_VERDICT_STYLE(NAME, name, text, colour) {#name, text, colour},
    FAILURE_VERDICTS(FAILURE_VERDICT_STYLE)
#undef FAILURE_VERDICT_STYLE
};

/* Energies below this count as this much, J. */
static const double least_energy = 1e-3;

/* What verdicts rest on, each [cases], of which the share is the failure's own; and final states
 * [cases][2 n]. */
enum { END_TIME = FAILURE_MEASURES, ANSWERS };
struct answers {
    double *of[ANSWERS], *final;
    size_t coordinates;
};
#define NAME(NAME, name, bound) #name,
#define BOUND(NAME, name, bound) bound,
static const char *const names[ANSWERS] = {FAILURE_LARGEST(NAME) "end_time"};
static const double bounds[FAILURE_MEASURES] = {FAILURE_LARGEST(BOUND)};

/* ---- reading ------------------------------------------------------------------------------ */

static bool answers_read(struct answers *x, const struct results *r, const stance_scene *scene,
                         stance_message *message)
{
    for (int i = 0; i < ANSWERS; i++) {
        if (i == FAILURE_SHARE)
            continue;
        if (!results_answer(r, names[i], &x->of[i], message))
            return false;
        if (!x->of[i])
            return complain(message, "%s was not recorded", names[i]);
    }
    x->coordinates = (size_t)scene->coordinates;
    const size_t size = (size_t)r->cases * 2 * x->coordinates;
    x->final = malloc(size * sizeof *x->final);
    if (!x->final)
        return no_memory(message);
    return results_numbers(r, "final_state", x->final, size) == size ||
           complain(message, "final_state was not recorded");
}

bool failure_fits(const struct scenario *s, stance_message *message)
{
    return (s->axes == 3 && !s->sample.given && strcmp(s->axis[0].path[0], "method.name") == 0) ||
           complain(message, "three axes are needed: method.name, then the two of the map");
}

static bool make_rows(struct failure *f, const struct scenario *s, const struct results *r,
                      stance_message *message)
{
    if (!failure_fits(s, message))
        return false;
    if (r->single)
        return complain(message, "the file holds a single case");
    for (int a = 0; a < 3; a++)
        f->count[a] = s->axis[a].count;
    f->rows = f->count[0];
    f->cells = f->count[1] * f->count[2];
    f->row = calloc(f->rows, sizeof *f->row);
    f->verdict = calloc(r->cases, sizeof *f->verdict);
    f->share = calloc(r->cases, sizeof *f->share);
    f->truth = calloc(f->cells, sizeof *f->truth);
    if (!f->row || !f->verdict || !f->share || !f->truth || f->rows > INT8_MAX)
        return no_memory(message);
    for (size_t k = 0; k < f->rows; k++) {
        struct scenario_values values;
        scenario_case_values(s, k * f->cells, &values);
        f->row[k].method = stance_methods()[values.method];
        f->row[k].tolerance = study_tolerance(f->row[k].method, &values);
    }
    return true;
}

/* Energy at the start of every case; it needs the plan because states follow from designs. */
static bool start_energies(const struct scenario *s, uint64_t cases, double *energy,
                           stance_message *message)
{
    struct plan plan;
    if (!study_plan(&plan, s, message))
        return false;
    for (uint64_t i = 0; i < cases; i++) {
        stance_case c;
        int method;
        energy[i] = plan_resolve(&plan, i, &c, &method)
                        ? fabs(s->scene->energy(s->scene, c.robot, c.position, c.velocity))
                        : NAN;
        energy[i] = fmax(energy[i], least_energy);
    }
    plan_free(&plan);
    return true;
}

/* ---- the truth ---------------------------------------------------------------------------- */

/* The cell that holds the truth about a cell: itself, or the one at the smallest step. */
static size_t true_cell(const struct failure *f, const struct results *r, size_t cell)
{
    size_t point[2] = {cell / f->count[2], cell % f->count[2]};
    for (int a = 0; a < 2; a++) {
        const struct results_axis *axis = &r->axis[a + 1];
        if (strcmp(axis->name, "method.step") == 0) {
            point[a] = 0;
            for (size_t i = 1; i < axis->count; i++)
                point[a] = axis->value[i] < axis->value[point[a]] ? i : point[a];
        }
    }
    return point[0] * f->count[2] + point[1];
}

static bool is_done(const struct results *r, uint64_t index)
{
    return r->kind[index] != RESULTS_FAILED && r->kind[index] != RESULTS_PENDING;
}

/* Row of the truth about a cell: event-driven's, else capturing's of the smallest tolerance. */
static void find_truth(struct failure *f, const struct results *r)
{
    for (size_t cell = 0; cell < f->cells; cell++) {
        const size_t at = true_cell(f, r, cell);
        int found = -1;
        for (size_t k = 0; k < f->rows; k++) {
            const char *name = f->row[k].method->name;
            const bool event = strcmp(name, "event-driven") == 0;
            if ((!event && strcmp(name, "capturing") != 0) || !is_done(r, k * f->cells + at))
                continue;
            const bool first = found < 0;
            const bool other = !first && strcmp(f->row[found].method->name, "event-driven") != 0;
            if (first || (event && other) ||
                (event != other && f->row[k].tolerance < f->row[found].tolerance))
                found = (int)k;
        }
        f->truth[cell] = (int8_t)found;
    }
}

/* ---- verdicts ----------------------------------------------------------------------------- */

static bool stands(const struct results *r, uint64_t index)
{
    return r->kind[index] == RESULTS_STABILISED || r->kind[index] == RESULTS_RESTED;
}

/* Largest difference of a coordinate at the end; 0 where the runs did not end together: falls end
 * a run early, and differ after it in no way that matters. */
static double position_error(const struct answers *x, uint64_t mine, uint64_t true_one)
{
    double largest = 0;
    if (fabs(x->of[END_TIME][mine] - x->of[END_TIME][true_one]) > 1e-9)
        return 0;
    for (size_t i = 0; i < x->coordinates; i++) {
        const double difference =
            x->final[2 * x->coordinates * mine + i] - x->final[2 * x->coordinates * true_one + i];
        largest = fmax(fabs(difference), largest);
    }
    return largest;
}

static enum failure_verdict judge(const struct failure *f, const struct results *r,
                                  const struct answers *x, size_t row, size_t cell)
{
    const uint64_t i = row * f->cells + cell;
    if (!is_done(r, i)) {
        const int reason = r->failure ? r->failure[i] : STANCE_FAILURE_NONE;
        return reason == STANCE_FAILURE_NOT_FINITE || reason == STANCE_FAILURE_ANGLE
                   ? FAILURE_RAN_AWAY
                   : FAILURE_GAVE_UP;
    }
    for (int a = 0; a < FAILURE_MEASURES; a++)
        if (bounds[a] > 0 && !(x->of[a][i] <= bounds[a]))
            return a == FAILURE_SHARE ? FAILURE_RAN_AWAY : FAILURE_BROKE_LAW;
    if (f->truth[cell] < 0)
        return FAILURE_UNJUDGED;
    const uint64_t truth = (uint64_t)f->truth[cell] * f->cells + true_cell(f, r, cell);
    if (r->kind[i] != r->kind[truth])
        return FAILURE_OUTCOME;
    if (!(position_error(x, i, truth) <= FAILURE_POSITION))
        return FAILURE_INACCURATE;
    return stands(r, i) ? FAILURE_RIGHT_STANDS : FAILURE_RIGHT_OTHER;
}

static void judge_row(struct failure *f, const struct results *r, const struct answers *x, size_t k)
{
    struct failure_row *row = &f->row[k];
    for (size_t cell = 0; cell < f->cells; cell++) {
        const uint64_t i = k * f->cells + cell;
        const enum failure_verdict verdict = judge(f, r, x, k, cell);
        f->verdict[i] = (uint8_t)verdict;
        row->count[verdict]++;
        if (f->line.axis > 0) {
            const size_t point[3] = {0, cell / f->count[2], cell % f->count[2]};
            const int along = f->line.axis, across = 3 - along; /* side 1: beyond the line */
            const int side = r->axis[across].value[point[across]] > f->line.value[point[along]];
            row->side[side]++;
            row->bad[side] += verdict == FAILURE_GAVE_UP || verdict == FAILURE_RAN_AWAY;
            row->stands[side] += stands(r, i);
        }
        if (!is_done(r, i)) {
            const uint8_t reason = r->failure ? r->failure[i] : 0;
            row->reason[reason < STANCE_FAILURE_COUNT ? reason : 0]++;
            continue;
        }
        for (int a = 0; a < FAILURE_MEASURES; a++)
            row->largest[a] = fmax(x->of[a][i], row->largest[a]);
    }
}

static bool judge_all(struct failure *f, const struct scenario *s, const struct results *r,
                      stance_message *message)
{
    struct answers x = {.coordinates = 0};
    const bool good =
        answers_read(&x, r, s->scene, message) && start_energies(s, r->cases, f->share, message);
    if (good) {
        for (uint64_t i = 0; i < r->cases; i++)
            f->share[i] = is_done(r, i) ? x.of[FAILURE_GAIN][i] / f->share[i] : NAN;
        x.of[FAILURE_SHARE] = f->share;
        find_truth(f, r);
        for (size_t k = 0; k < f->rows; k++)
            judge_row(f, r, &x, k);
    }
    x.of[FAILURE_SHARE] = NULL;
    for (int i = 0; i < ANSWERS; i++)
        free(x.of[i]);
    free(x.final);
    return good;
}

bool failure_make(struct failure *f, const struct results *r, stance_message *message)
{
    const struct scenario *const s = r->read;
    *f = (struct failure){.rows = 0};
    if (!s)
        return complain(message, "this version cannot read the file's scenario");
    const bool good = make_rows(f, s, r, message) && failure_theory(&f->line, s, message) &&
                      judge_all(f, s, r, message);
    if (!good)
        failure_free(f);
    return good;
}

const char *failure_row_name(const struct failure_row *row, char text[40])
{
    if (isnan(row->tolerance))
        snprintf(text, 40, "%s", row->method->name);
    else
        snprintf(text, 40, "%s %.0e", row->method->name, row->tolerance);
    return text;
}

void failure_free(struct failure *f)
{
    free(f->row);
    free(f->verdict);
    free(f->share);
    free(f->truth);
    free(f->line.value);
    *f = (struct failure){.rows = 0};
}
