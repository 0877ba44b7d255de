/* page_charts.c - what of a file is better read off curves than off a map. */
#include "page_data.h"

#include "analysis/basin/basin.h"
#include "analysis/bench/accuracy.h"
#include "analysis/optimise/search_study.h"
#include "analysis/sensitivity/sensitivity_study.h"
#include "analysis/statistics/intervals.h"
#include "analysis/statistics/statistics.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_TABLES = 6, MOST_DOTS = 4000 };
#define COST_SECONDS 0.03 /* that a row of error against cost is measured for */

static json_t *axis(const char *label, const char *unit, bool log, json_t *words)
{
    return TABLE_OBJECT({"label", as_text(label)}, {"unit", as_text(unit)}, {"log", as_truth(log)},
                        {"words", as_tree(words)});
}

/* A curve without points, the list's own. */
static json_t *add_curve(json_t *series, const char *name, bool lines)
{
    json_t *const curve = TABLE_OBJECT({"name", as_text(name)}, {"x", as_tree(json_array())},
                                       {"y", as_tree(json_array())}, {"low", as_tree(json_array())},
                                       {"high", as_tree(json_array())}, {"lines", as_truth(lines)});
    json_array_append_new(series, curve);
    return curve;
}

static const struct interval no_interval = {NAN, NAN};

static void add_point(json_t *curve, double x, double y, struct interval interval)
{
    table_append(json_object_get(curve, "x"), as_number(x));
    table_append(json_object_get(curve, "y"), as_number(y));
    table_append(json_object_get(curve, "low"), as_number(interval.low));
    table_append(json_object_get(curve, "high"), as_number(interval.high));
}

/* Takes over what is of JSON. */
static void add_chart(json_t *charts, const char *title, const char *text, json_t *x, json_t *y,
                      json_t *series)
{
    json_array_append_new(charts, TABLE_OBJECT({"title", as_text(title)}, {"text", as_text(text)},
                                               {"x", as_tree(x)}, {"y", as_tree(y)},
                                               {"series", as_tree(series)}));
}

/* ---- shares along an axis ----------------------------------------------------------------- */

/* The share of each outcome that occurs, at each value of an axis. */
static bool put_shares(json_t *charts, const struct results *r, int k, stance_message *message)
{
    const struct results_axis *const a = &r->axis[k];
    struct statistics_counts all, *const counts = calloc(a->count, sizeof *counts);
    char title[200];
    if (!counts)
        return statistics_no_memory(r, message);
    json_t *const series = json_array();
    statistics_count(r, -1, 0, &all);
    statistics_count_axis(r, k, counts);
    for (int kind = 0; kind < RESULTS_OUTCOMES; kind++) {
        if (all.kind[kind] == 0)
            continue;
        json_t *const curve = add_curve(series, results_kind_names[kind], true);
        for (size_t i = 0; i < a->count; i++)
            add_point(curve, a->value[i],
                      100 * (double)counts[i].kind[kind] / (double)counts[i].done, no_interval);
    }
    free(counts);
    snprintf(title, sizeof title, "Shares of outcomes along %.120s", a->name);
    add_chart(charts, title, a->text,
              axis(a->name, a->unit, false, table_list((const char *const *)a->word, a->count)),
              axis("share of the cases that are done", "%", false, NULL), series);
    return true;
}

/* ---- basins ------------------------------------------------------------------------------- */

/* How much of the box of starts a basin fills at each value of an axis, with likely errors. Files
 * that have no starts have no basin, which is no fault. */
static void put_basin(json_t *charts, const struct results *r, int k)
{
    const struct results_axis *const a = &r->axis[k];
    const char *const by[] = {a->name};
    const struct basin_choice choice = {
        .of = statistics_judged(r), .by = by, .by_count = 1, .side = 5, .level = 0.95};
    struct basin_sample sample;
    struct basin basin;
    stance_message ignored;
    bool usage;
    char title[200];
    if (!basin_sample_make(&sample, r, &ignored) ||
        !basin_make(&basin, r, &choice, &sample, &usage, &ignored))
        return;
    if (basin.by_axes == 1 && basin.start_axes > 0) {
        json_t *const series = json_array();
        json_t *const curve = add_curve(series, "basin, with its likely error (95 %)", true);
        for (size_t i = 0; i < basin.rows; i++) {
            const struct basin_row *const row = &basin.row[i];
            const double scale = 100 / basin.box;
            add_point(curve, a->value[row->point[k]], scale * row->volume,
                      (struct interval){fmax(0, scale * (row->volume - row->reach)),
                                        fmin(100, scale * (row->volume + row->reach))});
        }
        snprintf(title, sizeof title, "Basin of starts that end as %s along %.120s",
                 results_kind_names[choice.of], a->name);
        add_chart(charts, title,
                  "Volume of the starts from which cases end so, of the box of starts; stance "
                  "basin has more",
                  axis(a->name, a->unit, false, table_list((const char *const *)a->word, a->count)),
                  axis("share of the box of starts", "%", false, NULL), series);
    }
    basin_free(&basin);
}

/* ---- sensitivity -------------------------------------------------------------------------- */

static void put_table(json_t *charts, const struct sensitivity_study *study, size_t t)
{
    static const char *const names[SENSITIVITY_MEASURE_COUNT] = {
        [SENSITIVITY_FIRST] = "first: the factor alone",
        [SENSITIVITY_TOTAL] = "total: with interactions",
        [SENSITIVITY_MU_STAR] = "mean magnitude of the effects",
        [SENSITIVITY_SIGMA] = "their standard deviation"};
    const struct sensitivity *const s = &study->table[t].s;
    const bool morris = s->measure[SENSITIVITY_MU_STAR] != NULL;
    char factor[160], response[200], where[200], title[460];
    json_t *const series = json_array(), *const factors = json_array();
    sensitivity_response_text(study, response, sizeof response);
    sensitivity_table_text(study, t, where, sizeof where);
    snprintf(title, sizeof title, "What the %s depends on%s%s", response, where[0] ? ": " : "",
             where);
    for (size_t i = 0; i < study->factors; i++) {
        sensitivity_factor_text(study, study->order[i], factor, sizeof factor);
        table_append(factors, as_text(factor));
    }
    for (int m = 0; m < SENSITIVITY_MEASURE_COUNT; m++) {
        json_t *const curve = names[m] && s->measure[m] ? add_curve(series, names[m], false) : NULL;
        for (size_t i = 0; curve && i < study->factors; i++) {
            const struct sensitivity_value *const v = &s->measure[m][study->order[i]];
            add_point(curve, (double)i, v->estimate, (struct interval){v->low, v->high});
        }
    }
    add_chart(charts, title,
              morris ? "Morris's elementary effects over the ranges, with 95 % intervals"
                     : "Sobol' indices with 95 % intervals, what matters most first",
              axis("factor", "", false, factors),
              axis(morris ? "effect" : "index", "", false, NULL), series);
}

static bool put_sensitivity(json_t *charts, const struct results *r, stance_message *message)
{
    const struct sensitivity_request request = {
        .unit = "", .of = RESULTS_KIND_COUNT, .bootstrap = SENSITIVITY_BOOTSTRAP};
    struct sensitivity_study study;
    const int code = sensitivity_study_make(&study, r, &request, message);
    if (code != EXIT_DONE) /* too short, say: then there is no chart */
        return code == EXIT_USAGE;
    for (size_t t = 0; t < study.tables && t < MOST_TABLES; t++)
        put_table(charts, &study, t);
    sensitivity_study_free(&study);
    return true;
}

/* ---- error against cost ------------------------------------------------------------------- */

static double error_of(const struct accuracy *a, const struct accuracy_row *row)
{
    const double error = a->labels ? (double)row->differ / (double)row->compared : row->position;
    return row->compared == 0 ? NAN : a->labels ? fmax(error, 1 / (double)row->compared) : error;
}

/* Files that are no study of accuracy have none of it, which is no fault: false then. */
static bool put_accuracy(json_t *charts, const struct results *r)
{
    struct accuracy a;
    stance_message ignored;
    if (r->axes == 0 || strcmp(r->axis[0].name, "method.name") != 0 ||
        !accuracy_make(&a, r, COST_SECONDS, &ignored))
        return false;
    json_t *const series = json_array();
    for (const stance_method *const *m = stance_methods(); *m; m++) {
        json_t *curve = NULL;
        for (size_t k = 0; k < a.rows; k++) {
            if (a.row[k].method != *m || k == a.truth || !(error_of(&a, &a.row[k]) > 0))
                continue;
            curve = curve ? curve : add_curve(series, (*m)->name, true);
            add_point(curve, a.row[k].cost.median, error_of(&a, &a.row[k]), no_interval);
        }
    }
    add_chart(charts, "Error against cost",
              a.labels ? "Share of the cases whose outcome is not that of the reference; none at "
                         "all is drawn as one. Cost was measured when the page was made"
                       : "Largest difference of a coordinate from the reference. Cost was measured "
                         "when the page was made",
              axis("processor time per simulated second of a case", "us", true, NULL),
              axis(a.labels ? "share of outcomes unlike the reference" : "error of coordinates",
                   a.labels ? "" : "m, rad", true, NULL),
              series);
    accuracy_free(&a);
    return true;
}

/* Or the scale of starts. */
static bool is_start(const struct results_axis *a)
{
    return strncmp(a->name, "initial.offset.", 15) == 0 ||
           strncmp(a->name, "initial.state.", 14) == 0;
}

json_t *page_charts(const struct results *r, stance_message *message)
{
    json_t *const charts = json_array();
    bool good = true;
    if (r->single)
        return charts;
    const bool methods = put_accuracy(charts, r); /* along its first axis */
    if (sensitivity_study_fits(r))
        good = put_sensitivity(charts, r, message);
    for (int a = methods; good && a < r->axes; a++)
        if (a != r->sample && r->axis[a].count > 1 && !is_start(&r->axis[a])) {
            put_basin(charts, r, a);
            good = put_shares(charts, r, a, message);
        }
    if (good)
        return charts;
    json_decref(charts);
    return NULL;
}

/* ---- searches ----------------------------------------------------------------------------- */

static void put_candidates(json_t *charts, const struct search_study *study, double scale)
{
    const struct search_file *const f = &study->f;
    const size_t n = f->length[SEARCH_CANDIDATE], every = (n + MOST_DOTS - 1) / MOST_DOTS;
    char aim[300];
    json_t *const series = json_array();
    json_t *const dots = add_curve(series, "candidates", false),
                  *const best = add_curve(series, "best so far, of its stage's starts", true);
    for (size_t i = 0; i < n; i += every ? every : 1)
        add_point(dots, (double)i + 1, scale * f->objective[i], no_interval);
    for (size_t g = 0; g < f->length[SEARCH_GENERATION]; g++)
        add_point(best, (double)f->candidates[g], scale * f->objective[f->best[g]], no_interval);
    search_aim(study, aim, sizeof aim);
    add_chart(
        charts, "The search as it went", aim, axis("candidate", "", false, NULL),
        axis(study->plain ? "recovered starts" : "objective", study->plain ? "%" : "", false, NULL),
        series);
}

static void put_confirmed(json_t *charts, const struct search_study *study, double scale)
{
    const struct search_file *const f = &study->f;
    json_t *const series = json_array(), *const names = json_array();
    json_t *const fresh = add_curve(series, "fresh starts, 95 % intervals", false),
                  *const training =
                      study->plain ? add_curve(series, "the search's own starts", false) : NULL;
    for (size_t k = 0; k < f->length[SEARCH_CONFIRMED]; k++) {
        char name[80];
        const struct search_share share = search_share(study, k, SEARCH_OVERALL);
        search_name(study, k, name, sizeof name);
        table_append(names, as_text(name));
        add_point(fresh, (double)k, 100 * share.share,
                  (struct interval){100 * share.interval.low, 100 * share.interval.high});
        if (training)
            add_point(training, (double)k, scale * f->confirmed_training[k], no_interval);
    }
    add_chart(charts, "What is left of it from fresh starts",
              search_chosen_apart(study)
                  ? "Shares of starts by which nothing was chosen"
                  : "Shares of the starts by which one was chosen, whose share is too high",
              axis("candidate", "", false, names), axis("recovered starts", "%", false, NULL),
              series);
}

json_t *page_search_charts(const char *file, char title[256], stance_message *message)
{
    struct search_study study;
    if (!search_study_open(&study, file, message))
        return NULL;
    json_t *const charts = json_array();
    snprintf(title, 256, "%s", study.f.title ? study.f.title : study.name);
    if (study.f.length[SEARCH_CANDIDATE] > 0)
        put_candidates(charts, &study, study.plain ? 100 : 1);
    if (study.done)
        put_confirmed(charts, &study, study.plain ? 100 : 1);
    search_study_close(&study);
    return charts;
}
