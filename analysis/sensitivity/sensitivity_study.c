/* sensitivity_study.c - from a results file to sensitivity indices. */
#include "sensitivity_study.h"

#include "analysis/statistics/statistics.h"
#include "analysis/summary/summary.h"
#include "runner/base/command.h"
#include "runner/base/message.h"
#include "runner/base/words.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- texts -------------------------------------------------------------------------------- */

const char *sensitivity_factor_path(const struct sensitivity_study *study, size_t factor, int k)
{
    const struct scenario_factor *f = &study->scenario->sample.factor[factor];
    const struct scenario_axis *axis = &study->scenario->axis[study->scenario->axes - 1];
    return k < f->paths ? axis->path[f->first + k] : NULL;
}

void sensitivity_factor_text(const struct sensitivity_study *study, size_t factor, char *text,
                             size_t size)
{
    enum { NAMED = 3 }; /* most paths that are named */
    const int paths = study->scenario->sample.factor[factor].paths;
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
    table_at_text(study->r, study->response.kept, study->response.table[table].point, text, size);
}

/* ---- what is asked ------------------------------------------------------------------------ */

static int refuse(stance_message *message, const struct results *r, const char *text)
{
    complain(message, "%.110s: %s", r->file, text);
    return EXIT_USAGE;
}

/* Which grid axes are kept apart. */
static int choose_axes(const struct results *r, const struct sensitivity_request *request,
                       bool *kept, stance_message *message)
{
    const int grid = r->sample;
    for (int a = 0; a < grid; a++)
        kept[a] = request->by_count == 0 && strncmp(r->axis[a].name, "initial.", 8) != 0;
    for (size_t b = 0; b < request->by_count; b++) {
        const char *names[SCENARIO_MAX_AXES];
        int a = 0;
        if (strcmp(request->by[b], "none") == 0 && request->by_count == 1)
            continue;
        while (a < grid && strcmp(r->axis[a].name, request->by[b]) != 0) {
            names[a] = r->axis[a].name;
            a++;
        }
        if (a == grid) {
            const char *near = nearest_word(request->by[b], names, (size_t)grid);
            complain(message, "stance sensitivity: --by %.50s: not a grid axis of %.50s%s%.50s%s",
                     request->by[b], r->file, near ? "; did you mean '" : "", near ? near : "",
                     near ? "'?" : "");
            return EXIT_USAGE;
        }
        kept[a] = true;
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
    if (r->sample < 0) {
        return refuse(message, r,
                      "has no sampled factors: its scenario needs sweep.sample "
                      "(stance describe sweep.sample)");
    }
    const struct scenario *const s = r->read;
    if (!s) {
        complain(message, "%.150s: its scenario cannot be read by this version", r->file);
        return EXIT_IO;
    }
    study->scenario = s;
    study->design = &s->sample.design;
    if (!s->sample.given || s->axes != r->axes ||
        doe_points(study->design) != r->axis[r->sample].count) {
        complain(message, "%.150s: damaged: its samples are not those of its scenario", r->file);
        return EXIT_IO;
    }
    if (r->other_points) {
        return refuse(message, r,
                      "has points of another version, whose generator was another: its indices "
                      "cannot be told; compute it anew");
    }
    if (study->design->method == DOE_SPHERE) {
        return refuse(message, r,
                      "samples directions (method sphere), which have no factors of their own");
    }
    study->block = (size_t)doe_block(study->design);
    study->factors = study->design->factors;
    return EXIT_DONE;
}

/* ---- points ------------------------------------------------------------------------------- */

/* u[points][factors], of factors of few values the number of the part of the unit interval that
 * means the same value. Freed by the caller; NULL: no memory. */
static double *make_points(const struct sensitivity_study *study)
{
    const struct scenario_axis *axis = &study->scenario->axis[study->scenario->axes - 1];
    struct doe design = *study->design;
    const size_t k = study->factors, points = study->response.points;
    double *u = malloc(points * k * sizeof *u);
    const bool good = doe_begin(&design) && u;

    for (size_t i = 0; good && i < points; i++)
        doe_unit(&design, i, u + i * k);
    for (size_t j = 0; good && design.method != DOE_MORRIS && j < k; j++) {
        const struct scenario_factor *f = &study->scenario->sample.factor[j];
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

/* ---- tables ------------------------------------------------------------------------------- */

static bool analyse(const struct sensitivity_study *study, const double *y, const double *u,
                    const struct sensitivity_bootstrap *bootstrap, struct sensitivity *s)
{
    const struct doe *d = study->design;
    const size_t blocks = study->response.points / study->block, k = study->factors;
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

/* Blocks with a pending case wait as a whole. */
static void drop_waiting(const struct sensitivity_study *study, struct response_table *response)
{
    for (size_t i = 0; i < study->response.points; i += study->block) {
        bool waits = false;
        for (size_t j = i; j < i + study->block; j++)
            waits = waits || response->waiting[j];
        for (size_t j = i; waits && j < i + study->block; j++)
            response->y[j] = NAN;
    }
}

static void count_blocks(const struct sensitivity_study *study, struct sensitivity_table *table)
{
    const size_t block = study->block;
    const struct response_table *response = table->response;
    const bool morris = study->design->method == DOE_MORRIS;
    table->blocks = study->response.points / block;
    for (size_t b = 0; b < table->blocks; b++) {
        bool waits = false, misses = false;
        size_t effects = 0;
        for (size_t i = b * block; i < (b + 1) * block; i++) {
            waits = waits || response->waiting[i];
            misses = misses || isnan(response->y[i]);
            effects += i > b * block && (isnan(response->y[i]) || isnan(response->y[i - 1]));
        }
        table->waiting += waits;
        table->lost += waits ? 0 : morris ? effects : misses;
    }
}

static int lacks_memory(const struct results *r, stance_message *message)
{
    statistics_no_memory(r, message);
    return EXIT_IO;
}

/* The same with failed cases counted the other way; only the estimates are wanted. */
static int make_others(struct sensitivity_study *study, const double *u, stance_message *message)
{
    const struct response_choice choice = {NULL, study->request.of, !study->request.fallen};
    const struct sensitivity_bootstrap least = {2, study->request.bootstrap.level, 0};
    struct response other;
    int code = response_make(&other, study->r, &choice, study->response.kept, message);
    if (code != EXIT_DONE)
        return code;
    for (size_t t = 0; code == EXIT_DONE && t < other.tables; t++) {
        struct sensitivity s;
        if (study->table[t].response->failed == 0)
            continue;
        drop_waiting(study, &other.table[t]);
        if (analyse(study, other.table[t].y, u, &least, &s)) {
            compare(&study->table[t], &s);
            sensitivity_free(&s);
        } else {
            code = lacks_memory(study->r, message);
        }
    }
    response_free(&other);
    return code;
}

static int make_tables(struct sensitivity_study *study, stance_message *message)
{
    const size_t tables = study->response.tables;
    uint64_t failed = 0;
    const bool blind = study->design->method == DOE_SALTELLI; /* where its points are, is known */
    double *u = blind ? NULL : make_points(study);
    study->table = calloc(tables, sizeof *study->table);
    int code = (u || blind) && study->table ? EXIT_DONE : lacks_memory(study->r, message);

    for (size_t t = 0; code == EXIT_DONE && t < tables; t++) {
        struct sensitivity_table *table = &study->table[t];
        table->response = &study->response.table[t];
        failed += table->response->failed;
        drop_waiting(study, &study->response.table[t]);
        count_blocks(study, table);
        if (!analyse(study, table->response->y, u, &study->request.bootstrap, &table->s))
            code = lacks_memory(study->r, message);
    }
    if (code == EXIT_DONE && failed > 0 && !study->request.answer)
        code = make_others(study, u, message);
    free(u);
    return code;
}

/* By the mean over the tables of what a table is ordered by. */
static bool make_order(struct sensitivity_study *study)
{
    const size_t k = study->factors, tables = study->response.tables;
    double *weight = calloc(k, sizeof *weight);
    study->order = calloc(k, sizeof *study->order);
    const bool good = weight && study->order;
    for (size_t i = 0; good && i < k; i++) {
        size_t found = 0;
        for (size_t t = 0; t < tables; t++) { /* a table that has none says nothing */
            const double own = sensitivity_weight(&study->table[t].s, i);
            found += isfinite(own);
            weight[i] += isfinite(own) ? own : 0;
        }
        weight[i] = found > 0 ? weight[i] : -INFINITY;
        size_t at = i;
        while (at > 0 && weight[i] > weight[study->order[at - 1]]) {
            study->order[at] = study->order[at - 1];
            at--;
        }
        study->order[at] = i;
    }
    free(weight);
    return good;
}

/* ---- all of it ---------------------------------------------------------------------------- */

int sensitivity_study_make(struct sensitivity_study *study, const struct results *r,
                           const struct sensitivity_request *request, stance_message *message)
{
    bool kept[SCENARIO_MAX_AXES] = {false};
    *study = (struct sensitivity_study){.r = r, .request = *request};
    int code = read_design(study, message);
    if (code == EXIT_DONE)
        code = choose_axes(r, request, kept, message);
    if (code == EXIT_DONE) {
        if (request->of == RESULTS_KIND_COUNT && !request->answer)
            study->request.of = summary_judged(study->scenario);
        const struct response_choice choice = {request->answer, study->request.of, request->fallen};
        code = response_make(&study->response, r, &choice, kept, message);
    }
    if (code == EXIT_DONE)
        code = make_tables(study, message);
    if (code == EXIT_DONE && !make_order(study))
        code = lacks_memory(r, message);
    if (code != EXIT_DONE)
        sensitivity_study_free(study);
    return code;
}

void sensitivity_study_free(struct sensitivity_study *study)
{
    for (size_t t = 0; study->table && t < study->response.tables; t++)
        sensitivity_free(&study->table[t].s);
    free(study->table);
    free(study->order);
    response_free(&study->response);
    *study = (struct sensitivity_study){0};
}
