/* plot_sensitivity.c - the picture of a sensitivity study: a panel for each table.
 *
 * Indices: a row for each factor, the most important first, with first and total index one above
 * the other. Morris: mean magnitude of the effects against their standard deviation, factors by
 * number.
 */
#include "sensitivity_study.h"

#include "analysis/draw/plot.h"

#include <math.h>
#include <string.h>

GNUPLOT_SCRIPT(plot_sensitivity_gp, "analysis/sensitivity/plot_sensitivity.gp");

enum { MOST_PANELS = 12 };

struct drawing {
    const struct sensitivity_study *study;
    struct gnuplot g;
    bool morris;
    size_t panels;
    double low, high; /* range of indices; Morris: of mu* */
    double high_sigma;
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
static void widen(double *low, double *high, const struct sensitivity_value *v, size_t n)
{
    for (size_t j = 0; v && j < n; j++) {
        const double least = isfinite(v[j].low) ? v[j].low : v[j].estimate;
        const double most = isfinite(v[j].high) ? v[j].high : v[j].estimate;
        *low = fmin(*low, least);
        *high = fmax(*high, most);
    }
}

/* Of all panels, so that they can be compared. */
static void measure_ranges(struct drawing *d)
{
    const size_t k = d->study->factors;
    double zero = 0;
    for (size_t t = 0; t < d->panels; t++) {
        const struct sensitivity *s = &d->study->table[t].s;
        for (int c = 0; c < SERIES; c++)
            widen(&d->low, &d->high, s->measure[series[c].measure], k);
        widen(&zero, &d->high, s->measure[SENSITIVITY_MU_STAR], k);
        widen(&zero, &d->high_sigma, s->measure[SENSITIVITY_SIGMA], k);
    }
    const double margin = 0.05 * (d->high - d->low);
    d->low -= d->morris ? 0 : margin;
    d->high = d->high > 0 ? d->high + margin : 1;
    d->high_sigma = d->high_sigma > 0 ? 1.05 * d->high_sigma : 1;
}

static void subtitle_of(const struct sensitivity_study *study, char *text, size_t size)
{
    char response[200];
    const struct doe *design = study->design;
    uint64_t failed = 0;
    for (size_t t = 0; t < study->response.tables; t++)
        failed += study->response.table[t].failed;
    sensitivity_response_text(study, response, sizeof response);
    const size_t used = (size_t)snprintf(
        text, size, "What the %s depends on: %s with %g %% intervals, %llu %s.", response,
        design->method == DOE_MORRIS ? "Morris's elementary effects over the ranges"
                                     : "Sobol' indices",
        100 * study->request.bootstrap.level, (unsigned long long)design->count,
        design->method == DOE_MORRIS     ? "trajectories"
        : design->method == DOE_SALTELLI ? "base points"
                                         : "points");
    if (failed > 0 && used < size) {
        snprintf(text + used, size - used, " %llu failed cases %s.", (unsigned long long)failed,
                 study->request.fallen ? "count as fallen" : "are left out");
    }
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
        gnuplot_text(&d->g, look_label(d->g.look, text), "factor[%zu]", i + 1);
    }
}

/* An estimate and its interval, which is a point where there is none. */
static void interval_of(const struct sensitivity_value *v, double number[3])
{
    const bool whole = isfinite(v->low);
    number[0] = v->estimate;
    number[1] = whole ? v->low : v->estimate;
    number[2] = whole ? v->high : v->estimate;
}

static void put_indices(struct drawing *d, size_t t)
{
    for (int c = 0; c < SERIES; c++) {
        const struct sensitivity_value *v = d->study->table[t].s.measure[series[c].measure];
        double number[3];
        if (!v)
            continue;
        gnuplot_block(&d->g, "series%d_%zu", c + 1, t + 1);
        for (size_t i = 0; i < d->study->factors; i++) {
            interval_of(&v[d->study->order[i]], number);
            gnuplot_row(&d->g, number, 3);
        }
        gnuplot_end_block(&d->g);
    }
}

static void put_plane(struct drawing *d, size_t t)
{
    const struct sensitivity *s = &d->study->table[t].s;
    double number[6];
    gnuplot_block(&d->g, "effects%zu", t + 1);
    for (size_t i = 0; i < d->study->factors; i++) {
        interval_of(&s->measure[SENSITIVITY_MU_STAR][d->study->order[i]], number);
        interval_of(&s->measure[SENSITIVITY_SIGMA][d->study->order[i]], number + 3);
        gnuplot_row(&d->g, number, 6);
    }
    gnuplot_end_block(&d->g);
    for (size_t i = 0; i < d->study->factors; i++) {
        const size_t j = d->study->order[i], place = t * d->study->factors + i + 1;
        gnuplot_number(&d->g, s->measure[SENSITIVITY_MU_STAR][j].estimate, "mu_star[%zu]", place);
        gnuplot_number(&d->g, s->measure[SENSITIVITY_SIGMA][j].estimate, "sigma[%zu]", place);
    }
}

/* ---- the picture -------------------------------------------------------------------------- */

static bool has_any(const struct sensitivity_study *study)
{
    for (size_t t = 0; t < study->response.tables; t++)
        if (study->table[t].s.blocks > 1 && study->table[t].s.deviation > 0)
            return true;
    return false;
}

bool sensitivity_picture(const struct sensitivity_study *study, struct look *look,
                         const char *directory, const char *stem, stance_message *message)
{
    const struct results *r = study->r;
    const char *title = r->title[0] ? r->title : r->name;
    struct drawing d = {.study = study};
    char subtitle[400];

    if (!has_any(study)) {
        fprintf(stderr, "%s: too few points, or none that differ: no picture of sensitivity\n",
                r->file);
        return true;
    }
    d.morris = study->design->method == DOE_MORRIS;
    d.panels = study->response.tables < MOST_PANELS ? study->response.tables : MOST_PANELS;
    measure_ranges(&d);
    subtitle_of(study, subtitle, sizeof subtitle);
    if (!gnuplot_begin(&d.g, look, plot_sensitivity_gp, title, subtitle, message))
        return false;
    gnuplot_set(&d.g, "morris = %d; panels = %zu; low = %#.17g; high = %#.17g; high_sigma = %#.17g",
                d.morris, d.panels, d.low, d.high, d.high_sigma);
    if (study->response.tables > d.panels) {
        snprintf(subtitle, sizeof subtitle, "the first %zu of %zu tables are drawn", d.panels,
                 study->response.tables);
        gnuplot_note(&d.g, subtitle);
    }
    put_names(&d);
    for (int k = 0; k < SERIES && !d.morris; k++)
        if (study->table[0].s.measure[series[k].measure])
            gnuplot_legend(&d.g, series[k].colour, series[k].text, "");
    gnuplot_set(&d.g, "array mu_star[%zu]\narray sigma[%zu]", d.panels * study->factors,
                d.panels * study->factors);
    for (size_t t = 0; t < d.panels; t++)
        (d.morris ? put_plane : put_indices)(&d, t);
    return gnuplot_end(&d.g, directory, stem, message);
}
