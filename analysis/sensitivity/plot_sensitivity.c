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

enum { MOST_PANELS = 12, SIDE = 340 /* px, of a panel of effects */ };

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

/* The ends of its interval; where there is none, the estimate. */
static double low_of(const struct sensitivity_value *v)
{
    return isfinite(v->low) ? v->low : v->estimate;
}

static double high_of(const struct sensitivity_value *v)
{
    return isfinite(v->low) ? v->high : v->estimate;
}

/* Widens a range to hold these. */
static void widen(struct plot_range *range, const struct sensitivity_value *v, size_t n)
{
    for (size_t j = 0; v && j < n; j++) {
        plot_widen(range, low_of(&v[j]));
        plot_widen(range, high_of(&v[j]));
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

/* A row of the axis y for each factor, two series above and below its middle. */
static void put_indices(struct drawing *d, size_t t)
{
    const struct sensitivity *const s = &d->study->table[t].s;
    const bool both = s->measure[series[0].measure] && s->measure[series[1].measure];
    gnuplot_series(&d->g, "using 1:2 with lines lw 1 lc rgb grey");
    gnuplot_segment(&d->g, 0, -0.66, 0, (double)d->study->factors - 0.34);
    for (int c = 0; c < SERIES; c++) {
        const struct sensitivity_value *const v = s->measure[series[c].measure];
        if (!v)
            continue;
        gnuplot_series(&d->g, "using 1:2:3:4 with xerrorbars lc rgb %s lw 1.6 pt %d ps 0.9",
                       series[c].colour, c ? 5 : 7);
        for (size_t i = 0; i < d->study->factors; i++) {
            const struct sensitivity_value *const of = &v[d->study->order[i]];
            const double row = (double)(d->study->factors - 1 - i);
            GNUPLOT_ROW(&d->g, of->estimate, row + (both ? c ? -0.16 : 0.16 : 0), low_of(of),
                        high_of(of));
        }
    }
}

/* Where the number of a factor stands beside its point: the first of six places that is free of
 * others, in px of a panel; those at the very same point share one, and in a crowd the last go
 * without. */
static void put_numbers(struct drawing *d, const struct sensitivity_value *mu_star,
                        const struct sensitivity_value *sigma)
{
    static const double beside[][2] = {{11, 9}, {11, -9}, {-11, 9}, {-11, -9}, {0, 14}, {0, -14}};
    const size_t n = d->study->factors, *const order = d->study->order;
    double(*const at)[2] = gnuplot_room(&d->g, n, sizeof *at);
    size_t placed = 0;
    char text[200];
    for (size_t i = 0; at && i < n; i++) {
        const double x = mu_star[order[i]].estimate, y = sigma[order[i]].estimate;
        bool first = isfinite(x) && isfinite(y);
        text[0] = '\0';
        for (size_t j = 0; j < n; j++)
            if (mu_star[order[j]].estimate == x && sigma[order[j]].estimate == y) {
                first = first && j >= i;
                snprintf(text + strlen(text), sizeof text - strlen(text), "%s%zu",
                         text[0] ? "," : "", j + 1);
            }
        for (size_t k = 0; first && k < sizeof beside / sizeof *beside; k++) {
            double *const place = at[placed];
            bool is_free = true;
            place[0] = SIDE * x / d->index.high + beside[k][0];
            place[1] = SIDE * y / d->high_sigma + beside[k][1];
            for (size_t j = 0; j < placed; j++)
                is_free =
                    is_free && (fabs(at[j][0] - place[0]) >= 17 || fabs(at[j][1] - place[1]) >= 13);
            if (!is_free)
                continue;
            gnuplot_series(&d->g, "using 1:2:('%s') with labels font ',10'", text);
            GNUPLOT_ROW(&d->g, place[0] * d->index.high / SIDE, place[1] * d->high_sigma / SIDE);
            placed++;
            break;
        }
    }
}

static void put_effects(struct drawing *d, size_t t)
{
    const struct sensitivity *const s = &d->study->table[t].s;
    const struct sensitivity_value *const mu_star = s->measure[SENSITIVITY_MU_STAR],
                                          *const sigma = s->measure[SENSITIVITY_SIGMA];
    gnuplot_series(&d->g, "using 1:2 with lines lc rgb grey dt 2");
    gnuplot_segment(&d->g, 0, 0, d->index.high, d->index.high);
    gnuplot_series(&d->g, "using 1:2:3:4:5:6 with xyerrorbars lc rgb '#9ecae1' lw 1 pt 0 notitle, "
                          "'' using 1:2 with points pt 7 ps 0.8 lc rgb hue[1]");
    for (size_t i = 0; i < d->study->factors; i++) {
        const struct sensitivity_value *const x = &mu_star[d->study->order[i]],
                                              *const y = &sigma[d->study->order[i]];
        GNUPLOT_ROW(&d->g, x->estimate, y->estimate, low_of(x), high_of(x), low_of(y), high_of(y));
    }
    put_numbers(d, mu_star, sigma);
}

/* The axes of all panels; factors are names beside them, or numbers in the legend. */
static void put_axes(struct drawing *d)
{
    struct gnuplot *const g = &d->g;
    const size_t n = d->study->factors;
    char text[128];
    gnuplot_axis(g, 'x', PLOT_LINEAR,
                 (struct plot_range){d->morris ? 0 : d->index.low, d->index.high},
                 d->morris ? "mu*, mean magnitude of the effects" : "share of the variance", "");
    if (d->morris)
        gnuplot_axis(g, 'y', PLOT_LINEAR, (struct plot_range){0, d->high_sigma},
                     "sigma, standard deviation of the effects", "");
    else
        gnuplot_axis(g, 'y', PLOT_LIST, (struct plot_range){-0.67, (double)n - 0.33}, "", "");
    for (size_t i = 0; i < n; i++) {
        sensitivity_factor_text(d->study, d->study->order[i], text, sizeof text);
        const char *const name = look_label(g->plot->look, text);
        if (d->morris)
            gnuplot_note(g, "%zu  %s", i + 1, name);
        else
            gnuplot_word(g, (double)(n - 1 - i), name);
    }
    for (int k = 0; k < SERIES && !d->morris; k++)
        if (d->study->table[0].s.measure[series[k].measure])
            gnuplot_legend(g, series[k].colour, 0, 0, series[k].text, "");
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
    if (!gnuplot_begin(&d.g, plot, name))
        return false;
    measure_ranges(&d);
    say(&d);
    if (tables > d.panels)
        gnuplot_note(&d.g, "the first %zu of %zu tables are drawn", d.panels, tables);
    put_axes(&d);
    gnuplot_set(&d.g, "columns = %d; chart_width = %d; scaled = %d", d.morris ? 2 : 3,
                d.morris        ? SIDE
                : d.panels == 1 ? 460
                                : 260,
                d.morris);
    for (size_t t = 0; t < d.panels; t++) {
        char title[200];
        sensitivity_table_text(study, t, title, sizeof title);
        gnuplot_panel(&d.g, d.morris ? SIDE : 30 * (double)study->factors + 10, title);
        (d.morris ? put_effects : put_indices)(&d, t);
    }
    return gnuplot_end(&d.g);
}
