/* sensitivity_study.c - from a results file to sensitivity indices. */
#include "sensitivity_study.h"

#include "analysis/statistics/statistics.h"
#include "analysis/summary/summary.h"
#include "runner/base/words.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- texts -------------------------------------------------------------------------------- */

const char *sensitivity_factor_path(const struct sensitivity_study *study, size_t factor, int k)
{
    const struct scenario_factor *f = &study->r->read->sample.factor[factor];
    const struct scenario_axis *axis = &study->r->read->axis[study->r->sample];
    return k < f->paths ? axis->path[f->first + k] : NULL;
}

void sensitivity_factor_text(const struct sensitivity_study *study, size_t factor, char *text,
                             size_t size)
{
    enum { NAMED = 3 }; /* most paths that are named */
    const int paths = study->r->read->sample.factor[factor].paths;
    const char *before = sensitivity_factor_path(study, factor, 0);
    snprintf(text, size, "%s", before ? before : "");
    for (int k = 1; k < paths; k++) {
        if (paths > NAMED && k + 1 == NAMED) {
            add_text(text, size, " and %d more", paths - k);
            return;
        }
        /* without what it has in common with the one named before it, up to a dot */
        const char *const path = sensitivity_factor_path(study, factor, k);
        const char *const dot = strrchr(before, '.');
        const size_t folder = dot ? (size_t)(dot - before) + 1 : 0;
        add_text(text, size, ", %s", path + (strncmp(before, path, folder) == 0 ? folder : 0));
        before = path;
    }
}

void sensitivity_response_text(const struct sensitivity_study *study, char *text, size_t size)
{
    const struct sensitivity_request *request = &study->request;
    if (!request->answer)
        snprintf(text, size, "share of %s cases", results_kind_names[request->of]);
    else
        snprintf(text, size, "mean %s", request->answer);
    if (request->answer && request->of != RESULTS_KIND_COUNT)
        add_text(text, size, " of the %s cases", results_kind_names[request->of]);
}

void sensitivity_table_text(const struct sensitivity_study *study, size_t table, char *text,
                            size_t size)
{
    table_at_text(study->r, study->kept, study->table[table].point, text, size);
}

/* ---- what is asked ------------------------------------------------------------------------ */

/* Which grid axes are kept apart. */
static int choose_axes(struct sensitivity_study *study, stance_message *message)
{
    const struct results *const r = study->r;
    const struct option_texts *const by = &study->request.by;
    const int grid = r->sample;
    const char *names[SCENARIO_MAX_AXES];
    for (int a = 0; a < grid; a++) {
        names[a] = r->axis[a].name;
        study->kept[a] = by->count == 0 && strncmp(names[a], "initial.", 8) != 0;
    }
    for (size_t b = 0; b < by->count; b++) {
        const char *const name = by->text[b];
        int a = 0;
        if (strcmp(name, "none") == 0 && by->count == 1)
            continue;
        while (a < grid && strcmp(names[a], name) != 0)
            a++;
        if (a == grid) {
            const char *const near = nearest_word(name, names, (size_t)grid);
            return refuse(
                message, "stance sensitivity: --by %.50s: not a grid axis of %.50s%s%.50s%s", name,
                r->file, near ? "; did you mean '" : "", near ? near : "", near ? "'?" : "");
        }
        study->kept[a] = true;
    }
    return EXIT_DONE;
}

bool sensitivity_study_fits(const struct results *r)
{
    return r->sample >= 0 && r->read && r->read->sample.given &&
           r->read->sample.design.method != DOE_SPHERE && !r->other_points;
}

/* The scenario of the file, whose design must be the one that the file's axes say. */
static int read_design(struct sensitivity_study *study, stance_message *message)
{
    const struct results *r = study->r;
    const struct scenario *const s = r->read;
    const bool sampled = r->sample >= 0,
               damaged = sampled && (!s || !s->sample.given || s->axes != r->axes ||
                                     doe_points(&s->sample.design) != r->axis[r->sample].count);
    const char *const wrong =
        !sampled          ? "has no sampled factors: its scenario needs sweep.sample "
                            "(stance describe sweep.sample)"
        : !s              ? "its scenario cannot be read by this version"
        : damaged         ? "damaged: its samples are not those of its scenario"
        : r->other_points ? "has points of another version, whose generator was another: its "
                            "indices cannot be told; compute it anew"
        : s->sample.design.method == DOE_SPHERE
            ? "samples directions (method sphere), which have no factors of their own"
            : NULL;
    if (wrong) {
        complain(message, "%.110s: %s", r->file, wrong);
        return damaged ? EXIT_IO : EXIT_USAGE;
    }
    study->design = &s->sample.design;
    study->points = r->axis[r->sample].count;
    study->block = (size_t)doe_block(study->design);
    study->blocks = study->points / study->block;
    study->factors = study->design->factors;
    return EXIT_DONE;
}

/* ---- points ------------------------------------------------------------------------------- */

/* u[points][factors], of factors of few values the number of the part of the unit interval that
 * means the same value. Freed by the caller; NULL: no memory. */
static double *make_points(const struct sensitivity_study *study)
{
    const struct scenario_axis *axis = &study->r->read->axis[study->r->sample];
    struct doe design = *study->design;
    const size_t k = study->factors, points = study->points;
    double *u = malloc(points * k * sizeof *u);
    const bool good = doe_begin(&design) && u;

    for (size_t i = 0; good && i < points; i++)
        doe_unit(&design, i, u + i * k);
    for (size_t j = 0; good && design.method != DOE_MORRIS && j < k; j++) {
        const struct scenario_factor *f = &study->r->read->sample.factor[j];
        double parts = f->listed ? (double)f->points : 0;
        bool whole = true; /* it takes whole numbers only */
        for (int p = 0; p < f->paths; p++)
            whole = whole && axis->whole[f->first + p];
        for (int p = 0; !f->listed && whole && p < f->paths; p++)
            parts = fmax(parts, fabs(f->value[f->paths + p] - f->value[p]) + 1);
        for (size_t i = 0; parts > 0 && i < points; i++)
            u[i * k + j] = floor(parts * u[i * k + j]);
    }
    doe_end(&design);
    if (!good) {
        free(u);
        u = NULL;
    }
    return u;
}

/* ---- responses ---------------------------------------------------------------------------- */

/* The table of the cases at a grid point. */
static size_t table_at_point(const struct sensitivity_study *study, const size_t *point)
{
    size_t t = 0;
    for (int a = 0; a < study->r->sample; a++)
        t = study->kept[a] ? t * study->r->axis[a].count + point[a] : t;
    return t;
}

/* The tables, and what became of their cases. */
static bool count_cases(struct sensitivity_study *study)
{
    const struct results *const r = study->r;
    study->tables = 1;
    for (int a = 0; a < r->axes; a++)
        study->tables *= study->kept[a] ? r->axis[a].count : 1;
    study->table = calloc(study->tables, sizeof *study->table);
    study->waits = calloc(study->tables * study->blocks, sizeof *study->waits);
    for (uint64_t i = 0; study->table && study->waits && i < r->cases; i += study->points) {
        size_t point[SCENARIO_MAX_AXES];
        results_point(r, i, point);
        const size_t t = table_at_point(study, point);
        struct sensitivity_table *const table = &study->table[t];
        for (int a = 0; a < r->axes; a++)
            table->point[a] = study->kept[a] ? point[a] : 0;
        table->cases += study->points;
        for (size_t p = 0; p < study->points; p++) {
            const bool pending = r->kind[i + p] == RESULTS_PENDING;
            bool *const waits = &study->waits[t * study->blocks + p / study->block];
            table->failed += r->kind[i + p] == RESULTS_FAILED;
            table->pending += pending;
            table->waiting += pending && !*waits;
            *waits |= pending;
        }
    }
    for (size_t t = 0; study->table && t < study->tables; t++)
        study->failed += study->table[t].failed;
    return study->table && study->waits;
}

/* The answers, NAN where a refined map has not simulated a case; NULL without one. Returns an exit
 * code. */
static int read_answers(const struct sensitivity_study *study, double **answers,
                        stance_message *message)
{
    const struct results *const r = study->r;
    const char *const name = study->request.answer;
    uint64_t inferred;
    bool *which = NULL;
    *answers = NULL;
    if (study->request.of != RESULTS_KIND_COUNT && memchr(r->kind, RESULTS_DONE, r->cases))
        return refuse(message, "%.200s: does not store outcomes", r->file);
    if (!name)
        return EXIT_DONE;
    int code = report_code(statistics_inferred(r, &inferred, &which, message) &&
                           results_answer(r, name, answers, message));
    if (code == EXIT_DONE && !*answers)
        code = refuse(message, "%.150s: does not store %.60s", r->file, name);
    for (uint64_t i = 0; code == EXIT_DONE && which && i < r->cases; i++)
        (*answers)[i] = which[i] ? NAN : (*answers)[i];
    free(which);
    return code;
}

/* What a case adds to the mean of its point; NAN: nothing. */
static double value_of(const struct sensitivity_request *request, bool fallen,
                       enum results_kind kind, double answer)
{
    if (fallen && kind == RESULTS_FAILED)
        kind = RESULTS_FELL;
    if (kind == RESULTS_FAILED || kind == RESULTS_PENDING)
        return NAN;
    if (!request->answer)
        return kind == request->of;
    return request->of == RESULTS_KIND_COUNT || kind == request->of ? answer : NAN;
}

/* y[tables][points], with failed cases left out or `fallen`; NAN where a point is missing or its
 * block waits. Freed by the caller; NULL: no memory. */
static double *take_means(const struct sensitivity_study *study, const double *answers, bool fallen)
{
    const struct results *const r = study->r;
    const size_t points = study->points, all = study->tables * points;
    double *y = calloc(all, sizeof *y);
    uint32_t *const numbers = calloc(all, sizeof *numbers);
    for (uint64_t i = 0; y && numbers && i < r->cases; i += points) {
        size_t point[SCENARIO_MAX_AXES];
        results_point(r, i, point);
        const size_t first = table_at_point(study, point) * points;
        for (size_t p = 0; p < points; p++) {
            const double value =
                value_of(&study->request, fallen, (enum results_kind)r->kind[i + p],
                         answers ? answers[i + p] : NAN);
            if (isfinite(value)) /* a mean as it comes, which does not overflow or cancel */
                y[first + p] += (value - y[first + p]) / ++numbers[first + p];
        }
    }
    for (size_t k = 0; y && numbers && k < all; k++) /* blocks and tables have whole points */
        if (numbers[k] == 0 || study->waits[k / study->block])
            y[k] = NAN;
    if (!numbers) {
        free(y);
        y = NULL;
    }
    free(numbers);
    return y;
}

/* ---- tables ------------------------------------------------------------------------------- */

static bool analyse(const struct sensitivity_study *study, const double *y, const double *u,
                    const struct sensitivity_bootstrap *bootstrap, struct sensitivity *s)
{
    const struct doe *d = study->design;
    const size_t blocks = study->blocks, k = study->factors;
    switch (d->method) {
    case DOE_SALTELLI:
        return sensitivity_sobol(s, y, blocks, k, d->second_order, bootstrap->level);
    case DOE_MORRIS:
        return sensitivity_morris(s, y, u, blocks, k, bootstrap->level);
    default:
        return sensitivity_given(s, y, u, blocks, k, d->method == DOE_SOBOL, bootstrap);
    }
}

/* Where the other way to count failed cases takes an estimate out of its interval, farthest in
 * widths of it. */
static void compare(struct sensitivity_table *table, const struct sensitivity *other)
{
    double farthest = 0;
    for (int m = 0; m < SENSITIVITY_MEASURE_COUNT; m++) {
        for (size_t j = 0; table->s.measure[m] && j < table->s.factors; j++) {
            const struct sensitivity_value *v = &table->s.measure[m][j];
            const double to = other->measure[m][j].estimate;
            double out = fmax(v->low - to, to - v->high) / (v->high - v->low);
            if (isnan(v->estimate) && isfinite(to)) /* no variance but for failed cases */
                out = INFINITY;
            if (out > farthest) {
                farthest = out;
                table->moved = true;
                table->moved_measure = (enum sensitivity_measure)m;
                table->moved_factor = j;
                table->moved_to = to;
            }
        }
    }
}

/* What failed cases took out. */
static size_t count_lost(const struct sensitivity_study *study, size_t t, const double *y)
{
    const size_t block = study->block;
    size_t lost = 0;
    for (size_t b = 0; b < study->blocks; b++, y += block) {
        bool misses = isnan(y[0]);
        size_t effects = 0;
        for (size_t i = 1; i < block; i++) {
            misses = misses || isnan(y[i]);
            effects += isnan(y[i]) || isnan(y[i - 1]);
        }
        if (!study->waits[t * study->blocks + b])
            lost += study->design->method == DOE_MORRIS ? effects : misses;
    }
    return lost;
}

/* The indices of all tables; where cases failed also what they would be counted the other way, of
 * which only the estimates are wanted. */
static bool make_tables(struct sensitivity_study *study, const double *answers)
{
    const struct sensitivity_request *const request = &study->request;
    const struct sensitivity_bootstrap least = {2, request->bootstrap.level, 0};
    const bool blind = study->design->method == DOE_SALTELLI; /* where its points are, is known */
    const bool both = study->failed > 0 && !request->answer;
    double *const u = blind ? NULL : make_points(study);
    double *const y = take_means(study, answers, request->fallen);
    double *const other = both ? take_means(study, answers, !request->fallen) : NULL;
    bool good = (u || blind) && y && (other || !both);
    for (size_t t = 0; good && t < study->tables; t++) {
        struct sensitivity_table *const table = &study->table[t];
        struct sensitivity s;
        table->lost = count_lost(study, t, y + t * study->points);
        good = analyse(study, y + t * study->points, u, &request->bootstrap, &table->s);
        if (!good || !both || table->failed == 0)
            continue;
        good = analyse(study, other + t * study->points, u, &least, &s);
        if (good) {
            compare(table, &s);
            sensitivity_free(&s);
        }
    }
    free(u);
    free(y);
    free(other);
    return good;
}

/* By the mean over the tables of what a table is ordered by. */
static bool make_order(struct sensitivity_study *study)
{
    const size_t k = study->factors, tables = study->tables;
    struct statistics_place *const place = calloc(k, sizeof *place);
    study->order = calloc(k, sizeof *study->order);
    const bool good = place && study->order;
    for (size_t i = 0; good && i < k; i++) {
        size_t found = 0;
        for (size_t t = 0; t < tables; t++) { /* a table that has none says nothing */
            const double own = sensitivity_weight(&study->table[t].s, i);
            found += isfinite(own);
            place[i].value -= isfinite(own) ? own : 0;
        }
        place[i] = (struct statistics_place){found > 0 ? place[i].value : INFINITY, i};
    }
    if (good)
        statistics_order(place, k);
    for (size_t i = 0; good && i < k; i++)
        study->order[i] = place[i].index;
    free(place);
    return good;
}

/* ---- all of it ---------------------------------------------------------------------------- */

int sensitivity_study_make(struct sensitivity_study *study, const struct results *r,
                           const struct sensitivity_request *request, stance_message *message)
{
    double *answers = NULL;
    *study = (struct sensitivity_study){.r = r, .request = *request};
    int code = read_design(study, message);
    if (code == EXIT_DONE)
        code = choose_axes(study, message);
    if (code == EXIT_DONE && request->of == RESULTS_KIND_COUNT && !request->answer)
        study->request.of = summary_judged(r);
    if (code == EXIT_DONE)
        code = read_answers(study, &answers, message);
    if (code == EXIT_DONE &&
        !(count_cases(study) && make_tables(study, answers) && make_order(study)))
        code = report_code(statistics_no_memory(r, message));
    free(answers);
    if (code != EXIT_DONE)
        sensitivity_study_free(study);
    return code;
}

void sensitivity_study_free(struct sensitivity_study *study)
{
    for (size_t t = 0; study->table && t < study->tables; t++)
        sensitivity_free(&study->table[t].s);
    free(study->table);
    free(study->waits);
    free(study->order);
    *study = (struct sensitivity_study){0};
}
