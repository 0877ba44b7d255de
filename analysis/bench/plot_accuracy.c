/* plot_accuracy.c - error against cost, one line for each method; failures marked. */
#include "accuracy.h"

#include "analysis/draw/gnuplot.h"

#include <math.h>

/* What a panel shows of a row. */
enum shown { POSITION, VELOCITY, LABELS };

static bool belongs(const struct accuracy *a, size_t k, const stance_method *method)
{
    return k != a->truth && a->row[k].method == method;
}

/* What is drawn of a row, a logarithm, NAN: nothing. No cell unlike is fewer than one: so it is
 * drawn at the share of one, *none. */
static double place_of(const struct accuracy_row *row, enum shown shown, bool *none)
{
    double value = shown == POSITION   ? row->position
                   : shown == VELOCITY ? row->velocity
                                       : (double)row->differ / (double)row->compared;
    if (row->compared == 0 || !(value > 0)) /* a logarithm has no place for zero */
        value = NAN;
    *none = shown == LABELS && isnan(value) && row->compared > 0;
    return log10(*none ? 1 / (double)row->compared : value);
}

/* A method's line over the cost, and its points: open where there is none, a cross where cases were
 * given up. */
static void put_method(struct gnuplot *g, const struct accuracy *a, const stance_method *method,
                       size_t style, enum shown shown)
{
    const char *const hue = gnuplot_hue(style);
    gnuplot_series(g,
                   "using 1:2 with lines lc rgb %s lw 1.6 notitle, '' using 1:($3 > 0 ? NaN : $2) "
                   "with points lc rgb %s pt %d ps 1 notitle, '' using 1:($3 > 0 ? $2 : NaN) with "
                   "points lc rgb %s pt %d ps 0.9 notitle, '' using 1:($4 > 0 ? $2 : NaN) with "
                   "points lc rgb '#b00000' pt 2 ps 1.6 lw 1.6",
                   hue, hue, gnuplot_mark(style) - 1, hue, gnuplot_mark(style));
    for (size_t k = 0; k < a->rows; k++) {
        bool none;
        const double place = place_of(&a->row[k], shown, &none);
        if (belongs(a, k, method))
            GNUPLOT_ROW(g, log10(a->row[k].cost.median), place, !none, (double)a->row[k].failed);
    }
}

/* Of all rows but the truth, or where there is none any. */
static struct plot_range range_of(const struct accuracy *a, bool cost, enum shown shown)
{
    struct plot_range range = PLOT_NOTHING;
    bool none;
    for (size_t k = 0; k < a->rows; k++)
        if (k != a->truth)
            plot_widen(&range,
                       cost ? log10(a->row[k].cost.median) : place_of(&a->row[k], shown, &none));
    return range.low <= range.high ? (struct plot_range){range.low - 0.22, range.high + 0.23}
                                   : (struct plot_range){-0.9, 1};
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

bool accuracy_plot(const struct accuracy *a, const struct plot *plot)
{
    static const char *const names[] = {[POSITION] = "largest error of a coordinate (m, rad)",
                                        [VELOCITY] =
                                            "mean over time of the velocity error (m/s, rad/s)",
                                        [LABELS] = "share of cells unlike the reference"};
    const int panels = a->labels ? 1 : 2;
    const struct accuracy_row *truth = &a->row[a->truth];
    struct gnuplot g;
    const stance_method *method[ACCURACY_METHODS + 1];
    size_t style[ACCURACY_METHODS + 1];
    const size_t methods = list_methods(a, method, style);

    if (!gnuplot_begin(&g, plot, ""))
        return false;
    gnuplot_say(&g,
                "Error against cost. Reference: %s, tolerance %g. %llu cases per point; a cross "
                "marks points where cases were given up%s",
                truth->method->name, truth->tolerance, (unsigned long long)truth->cases,
                a->labels ? "; open symbols: none unlike, drawn where one cell is."
                          : ". Errors of exactly zero are not drawn.");
    gnuplot_set(&g, "columns = %d; chart_width = 400", panels);
    gnuplot_axis(&g, 'x', PLOT_LOG, range_of(a, true, LABELS),
                 "cost: microseconds of one core per simulated second", "");
    for (int p = 0; p < panels; p++) {
        const enum shown shown = a->labels ? LABELS : p == 0 ? POSITION : VELOCITY;
        gnuplot_panel(&g, 380, "");
        gnuplot_axis(&g, 'y', PLOT_LOG, range_of(a, false, shown), names[shown], "");
        for (size_t m = 0; m < methods; m++)
            put_method(&g, a, method[m], style[m], shown);
    }
    for (size_t m = 0; m < methods; m++)
        put_legend(&g, a, method[m], style[m]);
    return gnuplot_end(&g);
}
