/* plot_strip.c - a case as a strip of stick figures, from left to right and row by row, in even
 * intervals of time. Both directions have the same scale. */
#include "plot_case.h"

#include <math.h>

GNUPLOT_SCRIPT(plot_strip_gp, "analysis/plot/plot_strip.gp");

enum { MOST_FIGURES = 14 };

struct strip {
    const struct plot_case *c;
    int count, contacts;
    struct figure figure[MOST_FIGURES];
    struct figure other[MOST_FIGURES]; /* of the other case, without points from its end on */
    double spacing;                    /* m: between figures */
    struct plot_range height;          /* m: what is shown */
    double ground[PLOT_GROUND][2];     /* of a figure */
    bool follows;                      /* places move with the figures */
};

/* ---- figures ------------------------------------------------------------------------------ */

/* How far all figures reach to either side of their centres; heights count from the ground below
 * these. */
static double measure_figures(struct strip *strip)
{
    double half = 0;
    strip->height = (struct plot_range){0, 1e-9};
    for (int i = 0; i < 2 * strip->count; i++) {
        struct figure *const own = &strip->figure[i / 2];
        const struct figure *const figure = i % 2 ? &strip->other[i / 2] : own;
        own->base = plot_ground_base(strip->c, own->time, own->centre);
        for (int p = 0; p < figure->points; p++) {
            half = fmax(half, fabs(figure->point[p][0] - own->centre));
            plot_widen(&strip->height, figure->point[p][1] - own->base);
        }
    }
    return half;
}

/* The ground that a figure stands on. Returns how many points it has. */
static size_t find_ground(struct strip *strip, int i)
{
    const struct figure *const of = &strip->figure[i];
    return plot_ground(strip->c, of->time, of->centre - 0.5 * strip->spacing,
                       of->centre + 0.5 * strip->spacing, strip->ground);
}

/* Where and how large the figures are drawn. */
static void measure(struct strip *strip)
{
    struct plot_range centre = PLOT_NOTHING;
    measure_figures(strip);
    for (int i = 0; i < strip->count; i++)
        plot_widen(&centre, strip->figure[i].centre);
    /* Places stay put unless the figures travel further than they are tall. */
    strip->follows = centre.high - centre.low > strip->height.high - strip->height.low;
    for (int i = 0; i < strip->count && !strip->follows; i++)
        strip->figure[i].centre = 0.5 * (centre.low + centre.high);
    const double half = measure_figures(strip), tall = strip->height.high - strip->height.low;
    strip->spacing = 2.1 * fmax(half, 0.1 * tall);
    for (int i = 0; i < strip->count; i++)
        for (size_t k = find_ground(strip, i); k-- > 0;)
            strip->height.low =
                fmin(strip->height.low, strip->ground[k][1] - strip->figure[i].base);
    strip->height.low -= 0.05 * tall;
    strip->height.high += 0.06 * tall;
}

static void make_strip(struct strip *strip)
{
    const struct plot_case *const other = strip->c->other;
    const struct results_trajectory *t = strip->c->t;
    strip->count = t->rows < MOST_FIGURES ? (int)t->rows : MOST_FIGURES;
    for (int i = 0; i < strip->count; i++) {
        size_t row = strip->count > 1 ? (size_t)i * (t->rows - 1) / (size_t)(strip->count - 1) : 0;
        const double time = t->time[row];
        figure_make(&strip->figure[i], strip->c, row);
        /* The other case at the same instant, up to its end. */
        const struct results_trajectory *const o = other ? other->t : NULL;
        row = o ? figure_row(o, time) : 0;
        if (o && o->time[row] <= time + 1e-9 && (row + 1 < o->rows || o->time[row] > time - 0.05))
            figure_make(&strip->other[i], other, row);
    }
    measure(strip);
}

/* ---- drawing ------------------------------------------------------------------------------ */

/* In the script's plane the figures stand `spacing` apart. */
static void put_figures(struct gnuplot *g, struct strip *strip)
{
    gnuplot_block(g, "ground");
    for (int i = 0; i < strip->count; i++) {
        const size_t points = find_ground(strip, i);
        for (size_t k = 0; k < points; k++)
            GNUPLOT_ROW(g,
                        (i + 0.5) * strip->spacing + strip->ground[k][0] - strip->figure[i].centre,
                        strip->ground[k][1] - strip->figure[i].base);
        gnuplot_gap(g);
    }
    static const char *const blocks[] = {"segments", "points", "other"};
    for (int k = 0; k < 3; k++) {
        gnuplot_block(g, "%s", blocks[k]);
        for (int i = 0; i < strip->count; i++)
            figure_put(g, k < 2 ? &strip->figure[i] : &strip->other[i], strip->contacts,
                       k == 1 ? FIGURE_POINTS : FIGURE_SEGMENTS,
                       (i + 0.5) * strip->spacing - strip->figure[i].centre,
                       -strip->figure[i].base);
    }
}

bool plot_strip(const struct plot_case *c)
{
    struct gnuplot g;
    bool drawn;
    if (!plot_steps(c, &drawn) || drawn)
        return drawn;
    if (!plot_case_begin(c, &g, "strip", plot_strip_gp, "Stick figures"))
        return false;
    struct strip *const strip = gnuplot_room(&g, 1, sizeof *strip);
    if (strip) {
        strip->c = c;
        make_strip(strip);
        gnuplot_set(&g,
                    "count = %d; spacing = %#.17g; low = %#.17g; high = %#.17g; travels = %d; "
                    "cases = %d",
                    strip->count, strip->spacing, strip->height.low, strip->height.high,
                    strip->follows, c->other ? 2 : 1);
        strip->contacts = figure_names(&g, c->scenario.scene);
        gnuplot_arrays(&g, (size_t)strip->count, "time");
        for (int i = 0; i < strip->count; i++)
            gnuplot_number(&g, strip->figure[i].time, "time[%d]", i + 1);
        put_figures(&g, strip);
    }
    return gnuplot_end(&g);
}
