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

enum {
    MOST_PANELS = 12,
    COLUMNS = 3,
    ROW = 30,     /* px for a factor */
    PLANE = 340,  /* of Morris: width and height */
    SINGLE = 460, /* width of the only panel of indices */
    PANEL = 260,  /* ... of one of several */
    GAP = 30,
    PLANE_GAP = 64, /* room for the tics of the next one */
    TITLE = 30,     /* above each panel */
    FOOT = 62,      /* tics and label below the last row of panels */
    TICS = 30,      /* below the others */
    LEGEND = 224,
    LETTER = 8, /* px, at the size of labels */
};

struct drawing {
    const struct sensitivity_study *study;
    struct gnuplot g;
    bool morris;
    size_t panels, columns, rows;
    int width, height, gap; /* of a panel; to the next one */
    int left, top;          /* where the first one stands */
    double low, high;       /* range of indices; Morris: of mu* */
    double high_sigma;
};

static const struct {
    enum sensitivity_measure measure;
    const char *colour, *text;
    double place; /* rows below the middle of the factor's row */
    int marker;
} series[] = {
    {SENSITIVITY_FIRST, PLOT_ACCENT, "first: the factor alone", -0.16, 7},
    {SENSITIVITY_TOTAL, PLOT_SECOND, "total: with interactions", 0.16, 5},
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

static int longest_name(const struct sensitivity_study *study)
{
    char name[128];
    size_t longest = 0;
    for (size_t j = 0; j < study->factors; j++) {
        sensitivity_factor_text(study, j, name, sizeof name);
        longest = strlen(name) > longest ? strlen(name) : longest;
    }
    return (int)longest * LETTER;
}

static void lay_out(struct drawing *d)
{
    const struct sensitivity_study *study = d->study;
    d->morris = study->design->method == DOE_MORRIS;
    d->panels = study->response.tables < MOST_PANELS ? study->response.tables : MOST_PANELS;
    d->columns = d->panels < COLUMNS ? d->panels : COLUMNS;
    d->columns = d->morris && d->columns > 2 ? 2 : d->columns;
    d->rows = (d->panels + d->columns - 1) / d->columns;
    d->width = d->morris ? PLANE : d->panels == 1 ? SINGLE : PANEL;
    d->height = d->morris ? PLANE : ROW * (int)study->factors + 10;
    d->gap = d->morris ? PLANE_GAP : GAP;
    d->left = d->morris ? 84 : longest_name(study) + 34;
    measure_ranges(d);
}

static double panel_left(const struct drawing *d, size_t t)
{
    return d->left + (double)(t % d->columns) * (d->width + d->gap);
}

static double panel_top(const struct drawing *d, size_t t)
{
    const size_t row = t / d->columns;
    return d->top + TITLE + (double)row * (d->height + TITLE + TICS);
}

/* ---- texts -------------------------------------------------------------------------------- */

static void put_titles(struct drawing *d)
{
    char text[200];
    for (size_t t = 0; t < d->panels; t++) {
        sensitivity_table_text(d->study, t, text, sizeof text);
        if ((int)strlen(text) * LETTER > d->width + d->gap) { /* letters of a cut text stay whole */
            text[(d->width + d->gap) / LETTER] = '\0';
            results_clean(text);
        }
        gnuplot_label(&d->g, panel_left(d, t), panel_top(d, t) - 14, text, "left", 11, false);
    }
}

/* Names of the factors left of each row of panels. */
static void put_names(struct drawing *d)
{
    char name[128];
    for (size_t row = 0; row < d->rows; row++) {
        const double top = panel_top(d, row * d->columns);
        for (size_t i = 0; i < d->study->factors; i++) {
            sensitivity_factor_text(d->study, d->study->order[i], name, sizeof name);
            gnuplot_label(&d->g, d->left - 10, top + 5 + ROW * ((double)i + 0.5), name, "right", 11,
                          false);
        }
    }
}

/* Numbers of the factors of Morris's plane, beside the panels. */
static void put_numbers(struct drawing *d, double x)
{
    char name[128], text[160];
    for (size_t i = 0; i < d->study->factors; i++) {
        sensitivity_factor_text(d->study, d->study->order[i], name, sizeof name);
        snprintf(text, sizeof text, "%zu  %s", i + 1, name);
        gnuplot_label(&d->g, x, panel_top(d, 0) + 10 + 17 * (double)i, text, "left", 11, false);
    }
}

static void put_legend(struct drawing *d, double x)
{
    double y = panel_top(d, 0) + 10;
    for (int k = 0; k < SERIES; k++) {
        if (d->study->table[0].s.measure[series[k].measure]) {
            gnuplot_legend(&d->g, x, y, series[k].colour, series[k].text);
            y += 22;
        }
    }
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

static void put_value(FILE *data, const struct sensitivity_value *v)
{
    const bool whole = isfinite(v->low);
    gnuplot_number(data, v->estimate);
    putc(' ', data);
    gnuplot_number(data, whole ? v->low : v->estimate);
    putc(' ', data);
    gnuplot_number(data, whole ? v->high : v->estimate);
}

static void put_indices(struct drawing *d, size_t t)
{
    const struct sensitivity *s = &d->study->table[t].s;
    const size_t k = d->study->factors;
    const char *separator = "";
    FILE *script = d->g.script;
    char name[SERIES][32];

    for (int c = 0; c < SERIES; c++) {
        const struct sensitivity_value *v = s->measure[series[c].measure];
        FILE *data = v ? gnuplot_data(&d->g, name[c]) : NULL;
        for (size_t i = 0; v && i < k; i++) {
            put_value(data, &v[d->study->order[i]]);
            fprintf(data, " %g\n",
                    (double)i + (s->measure[SENSITIVITY_TOTAL] ? series[c].place : 0));
        }
        if (data)
            gnuplot_close_data(&d->g, data);
    }
    fprintf(script,
            "set xrange [%.10g:%.10g]; set yrange [%.10g:%.10g]; unset ytics; set ytics 1 format ''"
            " scale 0\nset xtics auto; set xtics %.10g font ',10'; set format x '%%g'\n"
            "set grid lt 1 lc rgb '#e6e6e6' lw 0.8\n"
            "set arrow 1 from 0, graph 0 to 0, graph 1 nohead lc rgb '" PLOT_GREY "' lw 1 back\n",
            d->low, d->high, (double)k - 0.5 + 5.0 / ROW, -0.5 - 5.0 / ROW,
            plot_round_step(d->low, d->high, d->panels == 1 ? 8 : 5));
    if (t + d->columns >= d->panels)
        fputs("set xlabel 'share of the variance' font ',10'\n", script);
    else
        fputs("unset xlabel\n", script);
    fputs("plot ", script);
    for (int c = 0; c < SERIES; c++) {
        if (s->measure[series[c].measure]) {
            fprintf(script,
                    "%s'%s' using 1:4:2:3 with xerrorbars lc rgb '%s' lw 1.6 pt %d ps 0.9 notitle",
                    separator, name[c], series[c].colour, series[c].marker);
            separator = ", ";
        }
    }
    fputs("\nunset arrow 1\n", script);
}

/* A place beside a point, right or left of it, above or below, where its number does not cover
 * that of a factor before it; false: there is none. Places are in px from the panel's lower left
 * corner; taken[n][2]: the numbers so far. */
static bool find_place(const double *point, double (*taken)[2], size_t n, double *place)
{
    static const double tries[][2] = {{11, 9}, {11, -9}, {-11, 9}, {-11, -9}, {0, 14}, {0, -14}};
    static const double wide = 17, high = 13; /* two digits */
    for (size_t c = 0; c < sizeof tries / sizeof tries[0]; c++) {
        bool free = true;
        place[0] = point[0] + tries[c][0];
        place[1] = point[1] + tries[c][1];
        for (size_t i = 0; free && i < n; i++)
            free = fabs(taken[i][0] - place[0]) >= wide || fabs(taken[i][1] - place[1]) >= high;
        if (free)
            return true;
    }
    return false;
}

/* Whether the factors a and b, by their places in the order, stand at the very same point. */
static bool are_together(const struct drawing *d, const struct sensitivity *s, size_t a, size_t b)
{
    const size_t one = d->study->order[a], other = d->study->order[b];
    return s->measure[SENSITIVITY_MU_STAR][one].estimate ==
               s->measure[SENSITIVITY_MU_STAR][other].estimate &&
           s->measure[SENSITIVITY_SIGMA][one].estimate ==
               s->measure[SENSITIVITY_SIGMA][other].estimate;
}

/* "3,4,6": number i and those at the same point; false where a number before it has said that. */
static bool number_text(const struct drawing *d, const struct sensitivity *s, size_t i, char *text,
                        size_t size)
{
    size_t used = (size_t)snprintf(text, size, "%zu", i + 1);
    for (size_t b = 0; b < i; b++)
        if (are_together(d, s, b, i))
            return false;
    for (size_t b = i + 1; b < d->study->factors && used < size; b++)
        if (are_together(d, s, i, b))
            used += (size_t)snprintf(text + used, size - used, ",%zu", b + 1);
    return true;
}

/* Numbers of the factors beside their points, the most important first; in a crowd the last go
 * without. Those at the very same place share one. */
static void put_places(struct drawing *d, const struct sensitivity *s, char name[32])
{
    double taken[DOE_MAX_FACTORS][2];
    const double across = d->width / d->high, up = d->height / d->high_sigma;
    size_t n = 0;
    FILE *data = gnuplot_data(&d->g, name);
    for (size_t i = 0; i < d->study->factors; i++) {
        const size_t j = d->study->order[i];
        const double point[2] = {across * s->measure[SENSITIVITY_MU_STAR][j].estimate,
                                 up * s->measure[SENSITIVITY_SIGMA][j].estimate};
        char text[64];
        if (isfinite(point[0]) && isfinite(point[1]) && number_text(d, s, i, text, sizeof text) &&
            find_place(point, taken, n, taken[n])) {
            fprintf(data, "%.10g %.10g %s\n", (taken[n][0] - 4) / across, taken[n][1] / up, text);
            n++;
        }
    }
    if (n == 0)
        fputs("NaN NaN 0\n", data);
    gnuplot_close_data(&d->g, data);
}

static void put_plane(struct drawing *d, size_t t)
{
    const struct sensitivity *s = &d->study->table[t].s;
    FILE *script = d->g.script;
    char name[32], numbers[32];

    put_places(d, s, numbers);
    FILE *data = gnuplot_data(&d->g, name);
    for (size_t j = 0; j < d->study->factors; j++) {
        put_value(data, &s->measure[SENSITIVITY_MU_STAR][j]);
        putc(' ', data);
        put_value(data, &s->measure[SENSITIVITY_SIGMA][j]);
        putc('\n', data);
    }
    gnuplot_close_data(&d->g, data);
    fprintf(script,
            "set xrange [0:%.10g]; set yrange [0:%.10g]; set xtics auto; set ytics auto\n"
            "set xtics %.10g font ',10'; set ytics %.10g font ',10'; set format '%%g'\n"
            "set grid lt 1 lc rgb '#e6e6e6' lw 0.8\n",
            d->high, d->high_sigma, plot_round_step(0, d->high, 6),
            plot_round_step(0, d->high_sigma, 6));
    fputs(t + d->columns >= d->panels
              ? "set xlabel 'mu*, mean magnitude of the effects' font ',10'\n"
              : "unset xlabel\n",
          script);
    fputs(t % d->columns == 0 ? "set ylabel 'sigma, standard deviation of the effects' font ',10'\n"
                              : "unset ylabel\n",
          script);
    fprintf(script,
            "plot x with lines lc rgb '" PLOT_GREY "' dt 2 notitle,"
            " '%s' using 1:4:2:3:5:6 with xyerrorbars lc rgb '#9ecae1' lw 1 pt 0 notitle,"
            " '' using 1:4 with points pt 7 ps 0.8 lc rgb '" PLOT_ACCENT "' notitle,"
            " '%s' using 1:2:3 with labels font ',10' left notitle\n",
            name, numbers);
}

/* ---- the picture -------------------------------------------------------------------------- */

static bool has_any(const struct sensitivity_study *study)
{
    for (size_t t = 0; t < study->response.tables; t++)
        if (study->table[t].s.blocks > 1 && study->table[t].s.deviation > 0)
            return true;
    return false;
}

bool sensitivity_picture(const struct sensitivity_study *study, const char *directory,
                         const char *stem, stance_message *message)
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
    lay_out(&d);
    subtitle_of(study, subtitle, sizeof subtitle);
    const int right = d.left + (int)d.columns * (d.width + d.gap);
    const int width = right + (d.morris ? longest_name(study) + 40 : LEGEND);
    d.top = gnuplot_title_height(width, title, subtitle);
    int bottom = (int)panel_top(&d, d.panels - 1) + d.height + FOOT;
    const int list = (int)panel_top(&d, 0) + 20 + 17 * (int)study->factors;
    bottom = d.morris && list > bottom ? list : bottom;
    if (study->response.tables > d.panels) {
        fprintf(stderr, "the first %zu of %zu tables are drawn; --by chooses fewer\n", d.panels,
                study->response.tables);
    }
    if (!gnuplot_begin(&d.g, width, bottom, message))
        return false;
    gnuplot_title(&d.g, title, subtitle);
    put_titles(&d);
    if (d.morris) {
        put_numbers(&d, right);
    } else {
        put_names(&d);
        put_legend(&d, right);
    }
    gnuplot_decorate(&d.g);
    for (size_t t = 0; t < d.panels; t++) {
        gnuplot_panel(&d.g, panel_left(&d, t), panel_top(&d, t), d.width, d.height);
        if (d.morris)
            put_plane(&d, t);
        else
            put_indices(&d, t);
    }
    return gnuplot_end(&d.g, directory, stem, message);
}
