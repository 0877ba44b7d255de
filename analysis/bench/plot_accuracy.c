/* plot_accuracy.c - error against cost, one line for each method; failures marked. */
#include "accuracy.h"

#include "analysis/draw/gnuplot.h"

#include <math.h>

static bool belongs(const struct accuracy *a, size_t k, const stance_method *method)
{
    return k != a->truth && a->row[k].method == method;
}

/* What is drawn of a row, a logarithm, NAN: nothing. No cell unlike is fewer than one: so it is
 * drawn at the share of one, *none. */
static double place_of(const struct accuracy_row *row, enum accuracy_shown shown, bool *none)
{
    double value = shown == ACCURACY_POSITION   ? row->position
                   : shown == ACCURACY_VELOCITY ? row->velocity
                                                : (double)row->differ / (double)row->compared;
    if (row->compared == 0 || !(value > 0)) /* a logarithm has no place for zero */
        value = NAN;
    *none = shown == ACCURACY_LABELS && isnan(value) && row->compared > 0;
    return log10(*none ? 1 / (double)row->compared : value);
}

void accuracy_point(struct gnuplot *g, const struct accuracy_row *row, enum accuracy_shown shown)
{
    bool none;
    const double place = place_of(row, shown, &none);
    GNUPLOT_ROW(g, log10(row->cost.median), place, !none, (double)row->failed);
}

void accuracy_points(struct gnuplot *g, const char *hue, int mark, double size)
{
    gnuplot_series(g,
                   "using 1:($3 > 0 ? NaN : $2) with points lc rgb %s pt %d ps %g notitle, '' "
                   "using 1:($3 > 0 ? $2 : NaN) with points lc rgb %s pt %d ps %g notitle, '' "
                   "using 1:($4 > 0 ? $2 : NaN) with points lc rgb '#b00000' pt 2 ps 1.6 lw 1.6",
                   hue, mark - 1, size + 0.1, hue, mark, size);
}

struct accuracy_ranges accuracy_ranges(void)
{
    return (struct accuracy_ranges){PLOT_NOTHING, {PLOT_NOTHING, PLOT_NOTHING, PLOT_NOTHING}};
}

void accuracy_widen(struct accuracy_ranges *ranges, const struct accuracy_row *row)
{
    bool none;
    plot_widen(&ranges->cost, log10(row->cost.median));
    for (enum accuracy_shown shown = 0; shown < ACCURACY_SHOWN; shown++)
        plot_widen(&ranges->value[shown], place_of(row, shown, &none));
}

/* Of nothing any will do. */
static struct plot_range with_room(struct plot_range range)
{
    return range.low <= range.high ? (struct plot_range){range.low - 0.22, range.high + 0.23}
                                   : (struct plot_range){-0.9, 1};
}

void accuracy_panel(struct gnuplot *g, const struct accuracy_ranges *ranges,
                    enum accuracy_shown shown)
{
    static const char *const names[] = {
        [ACCURACY_POSITION] = "largest error of a coordinate (m, rad)",
        [ACCURACY_VELOCITY] = "mean over time of the velocity error (m/s, rad/s)",
        [ACCURACY_LABELS] = "share of cells unlike the reference"};
    if (g->panels == 0)
        gnuplot_axis(g, 'x', PLOT_LOG, with_room(ranges->cost),
                     "cost: microseconds of one core per simulated second", "");
    gnuplot_panel(g, 380, "");
    gnuplot_axis(g, 'y', PLOT_LOG, with_room(ranges->value[shown]), names[shown], "");
}

/* A method's line over the cost, and its points. */
static void put_method(struct gnuplot *g, const struct accuracy *a, const stance_method *method,
                       size_t style, enum accuracy_shown shown)
{
    for (int points = 0; points < 2; points++) {
        if (points)
            accuracy_points(g, gnuplot_hue(style), gnuplot_mark(style), 0.9);
        else
            gnuplot_series(g, "using 1:2 with lines lc rgb %s lw 1.6", gnuplot_hue(style));
        for (size_t k = 0; k < a->rows; k++)
            if (belongs(a, k, method))
                accuracy_point(g, &a->row[k], shown);
    }
}

/* Orders, failures and residuals in words under the name of a method. */
static void put_legend(struct gnuplot *g, const struct accuracy *a, const stance_method *method,
                       size_t style)
{
    double residual = 0;
    uint64_t failed = 0, cases = 0;
    for (size_t k = 0; k < a->rows; k++) {
        const struct accuracy_row *row = &a->row[k];
        if (belongs(a, k, method)) {
            failed += row->failed, cases += row->cases;
            residual = fmax(residual, fmax(row->signorini, fmax(row->coulomb, row->dissipation)));
        }
    }
    gnuplot_legend(g, gnuplot_hue(style), 0, 0, method->name, "");
    for (size_t k = 0; k < a->orders; k++) {
        const struct accuracy_order *order = &a->order[k];
        if (order->method == method && !isnan(order->position))
            gnuplot_about(g, "order %.2f of %s %.0e ... %.0e", order->position,
                          order->by_tolerance ? "tolerance" : "step", order->from, order->to);
    }
    if (residual > 0)
        gnuplot_about(g, "contact laws broken by at most %.0e", residual);
    else
        gnuplot_about(g, "contact laws never broken");
    if (failed > 0)
        gnuplot_about(g, "gave up in %llu of %llu cases", (unsigned long long)failed,
                      (unsigned long long)cases);
}

/* Those of which there are rows beside the truth; style[]: colours stay with a method. */
static size_t list_methods(const struct accuracy *a, const stance_method **method, size_t *style)
{
    size_t n = 0;
    for (size_t m = 0; stance_methods()[m] && n < ACCURACY_METHODS; m++) {
        bool any = false;
        for (size_t k = 0; k < a->rows; k++)
            any |= belongs(a, k, stance_methods()[m]);
        method[n] = stance_methods()[m];
        style[n] = m % 5;
        n += any;
    }
    return n;
}

bool accuracy_picture(const struct accuracy *a, struct gnuplot *g, const struct plot *plot)
{
    const struct accuracy_row *truth = &a->row[a->truth];
    if (!gnuplot_begin(g, plot, ""))
        return false;
    gnuplot_say(g,
                "Error against cost. Reference: %s, tolerance %g. %llu cases per point; a cross "
                "marks points where cases were given up%s",
                truth->method->name, truth->tolerance, (unsigned long long)truth->cases,
                a->labels ? "; open symbols: none unlike, drawn where one cell is."
                          : ". Errors of exactly zero are not drawn.");
    gnuplot_set(g, "columns = 2; chart_width = 400");
    return true;
}

bool accuracy_plot(const struct accuracy *a, const struct plot *plot)
{
    struct accuracy_ranges ranges = accuracy_ranges();
    struct gnuplot g;
    const stance_method *method[ACCURACY_METHODS + 1];
    size_t style[ACCURACY_METHODS + 1];
    const size_t methods = list_methods(a, method, style);

    if (!accuracy_picture(a, &g, plot))
        return false;
    for (size_t k = 0; k < a->rows; k++)
        if (k != a->truth)
            accuracy_widen(&ranges, &a->row[k]);
    for (int p = 0; p < (a->labels ? 1 : 2); p++) {
        const enum accuracy_shown shown = a->labels ? ACCURACY_LABELS : (enum accuracy_shown)p;
        accuracy_panel(&g, &ranges, shown);
        for (size_t m = 0; m < methods; m++)
            put_method(&g, a, method[m], style[m], shown);
    }
    for (size_t m = 0; m < methods; m++)
        put_legend(&g, a, method[m], style[m]);
    return gnuplot_end(&g);
}
