/* plot_strip.c - a case as a strip of stick figures, from left to right and row by row, in even
 * intervals of time. Both directions have the same scale. */
#include "plot_case.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

GNUPLOT_SCRIPT(plot_strip_gp, "analysis/plot/plot_strip.gp");

enum { MOST_FIGURES = 14 };

struct strip {
    const struct plot_case *c;
    int count, contacts;
    struct figure figure[MOST_FIGURES];
    struct figure other[MOST_FIGURES]; /* of the other case, without points from its end on */
    double fall;                       /* of the ground along x: a slope's tangent */
    double spacing, low, high;         /* m: between figures; heights shown */
    bool follows;                      /* places move with the figures */
};

/* ---- figures ------------------------------------------------------------------------------ */

/* Places stay put unless the figures travel further than they are tall. */
static void centre_figures(struct strip *strip)
{
    double low = INFINITY, high = -INFINITY;
    for (int i = 0; i < strip->count; i++) {
        low = fmin(low, strip->figure[i].centre);
        high = fmax(high, strip->figure[i].centre);
    }
    strip->follows = high - low > strip->high - strip->low;
    for (int i = 0; i < strip->count && !strip->follows; i++)
        strip->figure[i].centre = 0.5 * (low + high);
}

/* Heights count from the ground below a figure's centre. */
static void measure_heights(struct strip *strip)
{
    strip->low = 0;
    strip->high = 1e-9;
    for (int i = 0; i < strip->count; i++) {
        struct figure *const figure = &strip->figure[i];
        figure->base = -strip->fall * figure->centre;
        for (int p = 0; p < figure->points; p++) {
            strip->low = fmin(strip->low, figure->point[p][1] - figure->base);
            strip->high = fmax(strip->high, figure->point[p][1] - figure->base);
        }
        for (int p = 0; p < strip->other[i].points; p++) {
            strip->low = fmin(strip->low, strip->other[i].point[p][1] - figure->base);
            strip->high = fmax(strip->high, strip->other[i].point[p][1] - figure->base);
        }
    }
}

static void measure(struct strip *strip)
{
    double half = 0;
    measure_heights(strip);
    centre_figures(strip);
    measure_heights(strip);
    for (int i = 0; i < strip->count; i++) {
        const double centre = strip->figure[i].centre;
        for (int p = 0; p < strip->figure[i].points; p++)
            half = fmax(half, fabs(strip->figure[i].point[p][0] - centre));
        for (int p = 0; p < strip->other[i].points; p++)
            half = fmax(half, fabs(strip->other[i].point[p][0] - centre));
    }
    double tall = strip->high - strip->low;
    strip->spacing = 2.1 * fmax(half, 0.1 * tall);
    strip->low = fmin(strip->low, -0.5 * fabs(strip->fall) * strip->spacing) - 0.05 * tall;
    strip->high += 0.06 * tall;
}

/* The other case at the same instant. */
static void make_other(struct strip *strip, int i)
{
    const struct plot_case *const c = strip->c->other;
    const double time = strip->figure[i].time;
    strip->other[i].points = 0;
    for (size_t row = 0; c && row < c->t->rows && c->t->time[row] <= time + 1e-9; row++)
        if (row + 1 == c->t->rows ? c->t->time[row] > time - 0.05 : c->t->time[row + 1] > time)
            figure_make(&strip->other[i], c, row);
}

static void make_strip(struct strip *strip)
{
    const struct results_trajectory *t = strip->c->t;
    strip->count = t->rows < MOST_FIGURES ? (int)t->rows : MOST_FIGURES;
    for (int i = 0; i < strip->count; i++) {
        size_t row = strip->count > 1 ? (size_t)i * (t->rows - 1) / (size_t)(strip->count - 1) : 0;
        figure_make(&strip->figure[i], strip->c, row);
        make_other(strip, i);
    }
    measure(strip);
}

/* ---- drawing ------------------------------------------------------------------------------ */

/* In the script's plane the figures stand `spacing` apart. */
static void put_figures(struct gnuplot *g, const struct strip *strip)
{
    gnuplot_block(g, "ground");
    for (int i = 0; i < strip->count; i++) {
        for (int end = 0; end < 2; end++)
            GNUPLOT_ROW(g, (i + end) * strip->spacing, (0.5 - end) * strip->fall * strip->spacing);
        gnuplot_set(g, "%s", "");
    }
    gnuplot_end_block(g);
    for (int part = FIGURE_SEGMENTS; part <= FIGURE_POINTS; part++) {
        gnuplot_block(g, part == FIGURE_SEGMENTS ? "segments" : "points");
        for (int i = 0; i < strip->count; i++) {
            const struct figure *figure = &strip->figure[i];
            figure_put(g, figure, strip->contacts, (enum figure_part)part,
                       (i + 0.5) * strip->spacing - figure->centre, -figure->base);
        }
        gnuplot_end_block(g);
    }
    gnuplot_block(g, "other");
    for (int i = 0; i < strip->count; i++)
        if (strip->other[i].points > 0)
            figure_put(g, &strip->other[i], strip->contacts, FIGURE_SEGMENTS,
                       (i + 0.5) * strip->spacing - strip->figure[i].centre,
                       -strip->figure[i].base);
    GNUPLOT_ROW(g, NAN, NAN, NAN);
    gnuplot_end_block(g);
}

bool plot_strip(const struct plot_case *c, stance_message *message)
{
    const stance_scene *scene = c->scenario.scene;
    struct gnuplot g;
    struct strip *strip = calloc(1, sizeof *strip);
    if (!strip) {
        snprintf(message->text, sizeof message->text, "stance plot: not enough memory");
        return false;
    }
    strip->c = c;
    strip->contacts = plot_case_grounded(scene);
    strip->fall = figure_fall(c);
    make_strip(strip);
    const bool good = plot_case_begin(c, &g, plot_strip_gp, "Stick figures", message);
    if (good) {
        gnuplot_set(&g,
                    "count = %d; spacing = %#.17g; low = %#.17g; high = %#.17g; travels = %d; "
                    "cases = %d",
                    strip->count, strip->spacing, strip->low, strip->high, strip->follows,
                    c->other ? 2 : 1);
        gnuplot_set(&g, "contacts = %d\narray contact_name[%d]\narray time[%d]", strip->contacts,
                    STANCE_MAX_CONTACTS, strip->count);
        for (int k = 0; k < strip->contacts; k++)
            gnuplot_text(&g, scene->contact_name[k], "contact_name[%d]", k + 1);
        for (int i = 0; i < strip->count; i++)
            gnuplot_number(&g, strip->figure[i].time, "time[%d]", i + 1);
        put_figures(&g, strip);
    }
    free(strip);
    return good && plot_end(c->plot, &g, "strip", message);
}
