/* plot_accuracy.c - error against cost, one line for each method; failures marked. */
#include "accuracy.h"

#include "analysis/draw/gnuplot.h"

#include <math.h>

GNUPLOT_SCRIPT(plot_accuracy_gp, "analysis/bench/plot_accuracy.gp");

/* What a panel shows of a row. */
enum shown { POSITION, VELOCITY, LABELS };

/* What there is no place for on a logarithmic axis is passed over. */
static void widen(struct plot_range *range, double value)
{
    if (value > 0)
        plot_widen(range, value);
}

/* Tells the script; of nothing any range will do. */
static void put_range(struct gnuplot *g, const struct plot_range *range, const char *name,
                      int panel)
{
    const bool any = range->low <= range->high;
    gnuplot_number(g, any ? range->low : 0.2, "%s_low[%d]", name, panel);
    gnuplot_number(g, any ? range->high : 6, "%s_high[%d]", name, panel);
}

static bool belongs(const struct accuracy *a, size_t k, const stance_method *method)
{
    return k != a->truth && a->row[k].method == method;
}

/* Rows of a method in a panel: cost, value, whether that is more than none, cases given up. No
 * cell unlike is fewer than one: so it is drawn at the share of one. */
static void put_rows(struct gnuplot *g, const struct accuracy *a, const stance_method *method,
                     enum shown shown, struct plot_range *cost, struct plot_range *error)
{
    for (size_t k = 0; k < a->rows; k++) {
        const struct accuracy_row *row = &a->row[k];
        if (!belongs(a, k, method))
            continue;
        double value = shown == POSITION   ? row->position
                       : shown == VELOCITY ? row->velocity
                                           : (double)row->differ / (double)row->compared;
        if (row->compared == 0 || !(value > 0)) /* a logarithm has no place for zero */
            value = NAN;
        const bool none = shown == LABELS && isnan(value) && row->compared > 0;
        const double drawn = none ? 1 / (double)row->compared : value;
        widen(cost, row->cost.median);
        widen(error, drawn);
        GNUPLOT_ROW(g, row->cost.median, drawn, !none, (double)row->failed);
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
    gnuplot_legend(g, gnuplot_hue(style - 1), 0, 0, method->name, "");
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
        style[n] = m % 5 + 1;
        n += any;
    }
    return n;
}

bool accuracy_plot(const struct accuracy *a, const struct plot *plot)
{
    const int panels = a->labels ? 1 : 2;
    const struct accuracy_row *truth = &a->row[a->truth];
    struct gnuplot g;
    const stance_method *method[ACCURACY_METHODS + 1];
    size_t style[ACCURACY_METHODS + 1];
    const size_t methods = list_methods(a, method, style);
    struct plot_range cost = PLOT_NOTHING, error[2] = {PLOT_NOTHING, PLOT_NOTHING};

    if (!gnuplot_begin(&g, plot, "", plot_accuracy_gp))
        return false;
    gnuplot_say(&g,
                "Error against cost. Reference: %s, tolerance %g. %llu cases per point; a cross "
                "marks points where cases were given up%s",
                truth->method->name, truth->tolerance, (unsigned long long)truth->cases,
                a->labels ? "; open symbols: none unlike, drawn where one cell is."
                          : ". Errors of exactly zero are not drawn.");
    gnuplot_set(&g, "panels = %d; labels = %d", panels, a->labels);
    gnuplot_arrays(&g, methods, "method_style");
    gnuplot_arrays(&g, 2, "cost_low cost_high error_low error_high");
    for (size_t m = 1; m <= methods; m++) {
        put_legend(&g, a, method[m - 1], style[m - 1]);
        gnuplot_set(&g, "method_style[%zu] = %zu", m, style[m - 1]);
        for (int p = 0; p < panels; p++) {
            const enum shown shown = a->labels ? LABELS : p == 0 ? POSITION : VELOCITY;
            gnuplot_block(&g, "errors%zu_%d", m, p + 1);
            put_rows(&g, a, method[m - 1], shown, &cost, &error[p]);
        }
    }
    put_range(&g, &cost, "cost", 1);
    for (int p = 0; p < panels; p++)
        put_range(&g, &error[p], "error", p + 1);
    return gnuplot_end(&g);
}
