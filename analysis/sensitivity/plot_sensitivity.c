/* plot_sensitivity.c - the picture of a sensitivity study: a panel for each table.
 *
 * Indices: a row for each factor, the most important first, with first and total index one above
 * the other. Morris: mean magnitude of the effects against their standard deviation, factors by
 * number.
 */
#include "sensitivity_study.h"

#include "analysis/draw/plot.h"

#include <math.h>

GNUPLOT_SCRIPT(plot_sensitivity_gp, "analysis/sensitivity/plot_sensitivity.gp");

enum { MOST_PANELS = 12 };

struct drawing {
    struct gnuplot g;
    const struct sensitivity_study *study;
    struct plot_range index; /* Morris: of mu* */
    double high_sigma;
    size_t panels;
    bool morris;
};

static const struct {
    enum sensitivity_measure measure;
    const char *colour, *text;
} series[] = {
    {SENSITIVITY_FIRST, "hue[1]", "first: the factor alone"},
    {SENSITIVITY_TOTAL, "hue[2]", "total: with interactions"},
};
enum { SERIES = sizeof series / sizeof series[0] };

/* ---- sizes -------------------------------------------------------------------------------- */

/* Widens a range to hold estimates and intervals. */
static void widen(struct plot_range *range, const struct sensitivity_value *v, size_t n)
{
    for (size_t j = 0; v && j < n; j++) {
        plot_widen(range, isfinite(v[j].low) ? v[j].low : v[j].estimate);
        plot_widen(range, isfinite(v[j].high) ? v[j].high : v[j].estimate);
    }
}

/* Of all panels, so that they can be compared. */
static void measure_ranges(struct drawing *d)
{
    const size_t k = d->study->factors;
    struct plot_range sigma = {0, 0};
    for (size_t t = 0; t < d->panels; t++) {
        const struct sensitivity *s = &d->study->table[t].s;
        for (int c = 0; c < SERIES; c++)
            widen(&d->index, s->measure[series[c].measure], k);
        if (d->morris)
            widen(&d->index, s->measure[SENSITIVITY_MU_STAR], k);
        widen(&sigma, s->measure[SENSITIVITY_SIGMA], k);
    }
    const double margin = 0.05 * (d->index.high - d->index.low);
    d->index.low -= d->morris ? 0 : margin;
    d->index.high = d->index.high > 0 ? d->index.high + margin : 1;
    d->high_sigma = sigma.high > 0 ? 1.05 * sigma.high : 1;
}

static void say(struct drawing *d)
{
    const struct sensitivity_study *const study = d->study;
    const struct doe *design = study->design;
    char response[200];
    const uint64_t failed = study->failed;
    sensitivity_response_text(study, response, sizeof response);
    gnuplot_say(&d->g, "What the %s depends on: %s with %g %% intervals, %llu %s.", response,
                d->morris ? "Morris's elementary effects over the ranges" : "Sobol' indices",
                100 * study->request.bootstrap.level, (unsigned long long)design->count,
                d->morris                        ? "trajectories"
                : design->method == DOE_SALTELLI ? "base points"
                                                 : "points");
    if (failed > 0)
        gnuplot_say(&d->g, " %llu failed cases %s.", (unsigned long long)failed,
                    study->request.fallen ? "count as fallen" : "are left out");
}

/* ---- panels ------------------------------------------------------------------------------- */

/* Titles of the panels, and the factors, the most important first. */
static void put_names(struct drawing *d)
{
    char text[200];
    gnuplot_set(&d->g, "array panel_title[%zu]", d->panels);
    for (size_t t = 0; t < d->panels; t++) {
        sensitivity_table_text(d->study, t, text, sizeof text);
        gnuplot_text(&d->g, text, "panel_title[%zu]", t + 1);
    }
    gnuplot_set(&d->g, "factors = %zu\narray factor[%zu]", d->study->factors, d->study->factors);
    for (size_t i = 0; i < d->study->factors; i++) {
        sensitivity_factor_text(d->study, d->study->order[i], text, 128);
        gnuplot_text(&d->g, look_label(d->g.plot->look, text), "factor[%zu]", i + 1);
    }
}

/* An estimate and its interval, which is a point where there is none, of each factor: rows of what
 * there is of `count` measures. */
static void put_rows(struct drawing *d, const struct sensitivity_value *const *measure, int count)
{
    for (size_t i = 0; i < d->study->factors; i++) {
        double number[6];
        for (int k = 0; k < count; k++) {
            const struct sensitivity_value *v = &measure[k][d->study->order[i]];
            const bool whole = isfinite(v->low);
            number[3 * k] = v->estimate;
            number[3 * k + 1] = whole ? v->low : v->estimate;
            number[3 * k + 2] = whole ? v->high : v->estimate;
        }
        gnuplot_row(&d->g, number, 3 * (size_t)count);
    }
}

static void put_indices(struct drawing *d, size_t t)
{
    for (int c = 0; c < SERIES; c++) {
        const struct sensitivity_value *v = d->study->table[t].s.measure[series[c].measure];
        if (v) {
            gnuplot_block(&d->g, "series%d_%zu", c + 1, t + 1);
            put_rows(d, &v, 1);
        }
    }
}

static void put_plane(struct drawing *d, size_t t)
{
    const struct sensitivity *s = &d->study->table[t].s;
    const struct sensitivity_value *const of[] = {s->measure[SENSITIVITY_MU_STAR],
                                                  s->measure[SENSITIVITY_SIGMA]};
    gnuplot_block(&d->g, "effects%zu", t + 1);
    put_rows(d, of, 2);
    for (size_t i = 0; i < d->study->factors; i++) {
        const size_t j = d->study->order[i], place = t * d->study->factors + i + 1;
        gnuplot_number(&d->g, of[0][j].estimate, "mu_star[%zu]", place);
        gnuplot_number(&d->g, of[1][j].estimate, "sigma[%zu]", place);
    }
}

/* ---- the picture -------------------------------------------------------------------------- */

bool sensitivity_picture(const struct sensitivity_study *study, const struct plot *plot)
{
    const char *const answer = study->request.answer;
    const size_t tables = study->tables;
    struct drawing d = {.study = study,
                        .morris = study->design->method == DOE_MORRIS,
                        .panels = tables < MOST_PANELS ? tables : MOST_PANELS};
    char name[100];
    bool any = false;
    for (size_t t = 0; t < tables; t++)
        any = any || (study->table[t].s.blocks > 1 && study->table[t].s.deviation > 0);
    if (!any) {
        fprintf(stderr, "%s: too few points, or none that differ: no picture of sensitivity\n",
                plot->r->file);
        return true;
    }
    snprintf(name, sizeof name, "%.80s%ssensitivity", answer ? answer : "", answer ? "-" : "");
    if (!gnuplot_begin(&d.g, plot, name, plot_sensitivity_gp))
        return false;
    measure_ranges(&d);
    say(&d);
    gnuplot_set(&d.g, "morris = %d; panels = %zu; low = %#.17g; high = %#.17g; high_sigma = %#.17g",
                d.morris, d.panels, d.index.low, d.index.high, d.high_sigma);
    if (tables > d.panels)
        gnuplot_note(&d.g, "the first %zu of %zu tables are drawn", d.panels, tables);
    put_names(&d);
    for (int k = 0; k < SERIES && !d.morris; k++)
        if (study->table[0].s.measure[series[k].measure])
            gnuplot_legend(&d.g, series[k].colour, 0, 0, series[k].text, "");
    gnuplot_arrays(&d.g, d.panels * study->factors, "mu_star sigma");
    for (size_t t = 0; t < d.panels; t++)
        (d.morris ? put_plane : put_indices)(&d, t);
    return gnuplot_end(&d.g);
}
