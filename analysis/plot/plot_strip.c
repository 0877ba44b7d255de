/* plot_strip.c - a case as a strip of stick figures, from left to right and row by row, in even
 * intervals of time. Both directions have the same scale. */
#include "plot_case.h"

#include <math.h>

enum { MOST_FIGURES = 14 };

struct strip {
    const struct plot_case *c;
    int count, contacts;
    struct figure figure[MOST_FIGURES];
    struct figure other[MOST_FIGURES]; /* of the other case, without points from its end on */
    double spacing;                    /* m: between figures */
    struct plot_range height;          /* m: what is shown */
    bool follows;                      /* places move with the figures */
};

/* ---- figures ------------------------------------------------------------------------------ */

/* How far all figures reach to either side of their centres; heights count from the ground below
 * these. */
static double measure_figures(struct strip *strip)
{
    struct plot_range range[2] = {{0, 0}, {0, 1e-9}};
    for (int i = 0; i < strip->count; i++) {
        struct figure *const own = &strip->figure[i];
        own->base = plot_ground_base(strip->c, own->time, own->centre);
        figure_widen(range, own, own->centre, own->base);
        figure_widen(range, &strip->other[i], own->centre, own->base);
    }
    strip->height = range[1];
    return fmax(-range[0].low, range[0].high);
}

/* The ground that a figure stands on; its lowest height. */
static double put_ground(struct gnuplot *g, const struct strip *strip, int i)
{
    const struct figure *const of = &strip->figure[i];
    const double half = 0.5 * strip->spacing;
    return plot_ground(g, strip->c, of->time,
                       (struct plot_range){of->centre - half, of->centre + half},
                       (i + 0.5) * strip->spacing - of->centre, -of->base);
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
        plot_widen(&strip->height, put_ground(NULL, strip, i) - strip->figure[i].base);
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

/* A row of figures from `first` on, `columns` of them, `spacing` apart in its plane: their ground,
 * the other case, segments and points, what belongs to a contact over the rest; under them their
 * times. */
static void put_row(struct gnuplot *g, struct strip *strip, int first, int columns, double foot)
{
    static const char *const styles[] = {
        "1:2 with lines lw 2.6 lc rgb 0xb8b8b8",
        "1:2:(" FIGURE_COLOUR ") with lines lw 2.6 lc rgb variable",
        "1:2:(" FIGURE_COLOUR ") with points pt 7 ps 0.8 lc rgb variable"};
    const int end = first + columns < strip->count ? first + columns : strip->count;
    gnuplot_series(g, "using 1:2 with lines lw 2 lc rgb 0xa0a0a0");
    for (int i = first; i < end; i++)
        put_ground(g, strip, i);
    for (int k = strip->c->other ? 0 : 1; k < 3; k++) {
        gnuplot_series(g, "using %s", styles[k]);
        for (int i = first; i < end; i++)
            figure_put(g, k > 0 ? &strip->figure[i] : &strip->other[i], strip->contacts,
                       k == 2 ? FIGURE_POINTS : FIGURE_SEGMENTS,
                       (i + 0.5) * strip->spacing - strip->figure[i].centre,
                       -strip->figure[i].base);
    }
    gnuplot_series(g, "using 1:2:(sprintf('%%.3g s', $3)) with labels font ',12'");
    for (int i = first; i < end; i++)
        GNUPLOT_ROW(g, (i + 0.5) * strip->spacing, foot, strip->figure[i].time);
}

/* The scale: a bar at the upper left, of a round length. */
static void put_bar(struct gnuplot *g, const struct strip *strip, double height)
{
    const double third = strip->spacing / 3, power = pow(10, floor(log10(third))),
                 bar = power * (third >= 5 * power   ? 5
                                : third >= 2 * power ? 2
                                                     : 1),
                 left = 0.05 * strip->spacing;
    gnuplot_series(g, "using 1:2:3:4 with vectors heads size screen 0.004,90 lw 1.4 lc rgb "
                      "0x404040 notitle, '' using ($1+$3):2:(sprintf('%%g m', $3)) with labels "
                      "left offset 1,0 font ',12'");
    GNUPLOT_ROW(g, left, height, bar, 0);
    if (strip->follows)
        gnuplot_note(g, "each figure is centred: it travels");
}

bool plot_strip(const struct plot_case *c)
{
    struct gnuplot g;
    bool drawn;
    if (!plot_steps(c, &drawn) || drawn)
        return drawn;
    if (!plot_case_begin(c, &g, "strip", "Stick figures"))
        return false;
    struct strip *const strip = gnuplot_room(&g, 1, sizeof *strip);
    if (!strip)
        return gnuplot_end(&g);
    const struct look *const look = c->plot->look; /* a page is narrow below 47.5 letters */
    const int most = look->width > 0 && look->width < 760 / 16. * 25.4 / 72 * look->points ? 5 : 7;
    strip->c = c;
    make_strip(strip);
    strip->contacts = figure_colours(&g, c->scenario->scene);
    figure_legend(&g, c);
    /* Figures fill the page, but a lonely one is not to fill a wall; under each is its time. */
    const int columns = strip->count < most ? strip->count : most;
    const double width = columns * strip->spacing, high = strip->height.high,
                 tall = high - strip->height.low, scale = fmin(1072 / width, 320 / tall),
                 low = strip->height.low - 30 / scale;
    gnuplot_set(&g, "plain = equal = legend_low = scaled = 1; chart_width = %.10g", scale * width);
    for (int first = 0; first < strip->count; first += columns) {
        const struct plot_range x = {first * strip->spacing, (first + columns) * strip->spacing};
        const bool barred = first == 0;
        gnuplot_panel(&g, scale * (high - low) + (barred ? 24 : 0), "");
        gnuplot_axis(&g, 'x', PLOT_LINEAR, x, "", "");
        gnuplot_axis(&g, 'y', PLOT_LINEAR,
                     (struct plot_range){low, high + (barred ? 24 / scale : 0)}, "", "");
        put_row(&g, strip, first, columns, low + 10 / scale);
        if (barred)
            put_bar(&g, strip, high + 12 / scale);
    }
    return gnuplot_end(&g);
}
