/* plot_accuracy.c - error against cost, one line for each method; failures marked. */
#include "accuracy.h"

#include "analysis/draw/gnuplot.h"

#include <math.h>
#include <string.h>

GNUPLOT_SCRIPT(plot_accuracy_gp, "analysis/bench/plot_accuracy.gp");

/* What a panel shows of a row; NAN: nothing. */
enum shown { POSITION, VELOCITY, LABELS };
enum { LINES = 8 }; /* under a method's name, at most */

static double shown_value(const struct accuracy_row *row, enum shown shown)
{
    if (row->compared == 0)
        return NAN;
    const double value = shown == POSITION   ? row->position
                         : shown == VELOCITY ? row->velocity
                                             : (double)row->differ / (double)row->compared;
    return value > 0 ? value : NAN; /* a logarithm has no place for zero */
}

struct range {
    double low, high;
};

static void widen(struct range *range, double value)
{
    if (value > 0 && isfinite(value)) {
        range->low = fmin(range->low, value);
        range->high = fmax(range->high, value);
    }
}

/* Tells the script; of nothing any range will do. */
static void put_range(struct gnuplot *g, const struct range *range, const char *name, int panel)
{
    const bool any = range->low <= range->high;
    gnuplot_number(g, any ? range->low : 0.2, "%s_low[%d]", name, panel);
    gnuplot_number(g, any ? range->high : 6, "%s_high[%d]", name, panel);
}

/* What has a colour and an entry in the legend: a method, or a peer by its defaults or by all of
 * its settings. */
struct series {
    const stance_method *method; /* NULL: a peer's */
    size_t peer;
    bool usual;
};

static bool belongs(const struct accuracy *a, size_t k, const struct series *series)
{
    const struct accuracy_row *const row = &a->row[k];
    if (k == a->truth || row->method != series->method)
        return false;
    return row->method || (row->peer == series->peer && row->usual == series->usual);
}

/* Rows of a series in a panel: cost, value, whether that is more than none, cases given up, what
 * the line goes through: nothing where peers have better settings. No cell unlike is fewer than
 * one: so it is drawn at the share of one. */
static void put_rows(struct gnuplot *g, const struct accuracy *a, const struct series *series,
                     enum shown shown, struct range *cost, struct range *error)
{
    for (size_t k = 0; k < a->all; k++) {
        const struct accuracy_row *row = &a->row[k];
        if (!belongs(a, k, series))
            continue;
        const double value = shown_value(row, shown);
        const bool none = shown == LABELS && isnan(value) && row->compared > 0;
        const double drawn = none ? 1 / (double)row->compared : value;
        widen(cost, row->cost.median);
        widen(error, drawn);
        GNUPLOT_ROW(g, row->cost.median, drawn, !none, (double)row->failed);
    }
}

/* What a series' line goes through: its rows, of a peer's many settings their front by cost. */
static void put_line(struct gnuplot *g, const struct accuracy *a, const struct series *series,
                     enum shown shown)
{
    const bool by_cost = !series->method && !series->usual;
    double last = 0;
    for (size_t taken = 0; taken < a->all; taken++) {
        const struct accuracy_row *next = by_cost ? NULL : &a->row[taken];
        if (!by_cost && !belongs(a, taken, series))
            continue;
        for (size_t k = 0; by_cost && k < a->all; k++) {
            const struct accuracy_row *const row = &a->row[k];
            if (belongs(a, k, series) && row->front && row->cost.median > last &&
                (!next || row->cost.median < next->cost.median))
                next = row;
        }
        if (!next)
            break;
        last = next->cost.median;
        const double value = shown_value(next, shown);
        const bool none = shown == LABELS && isnan(value) && next->compared > 0;
        GNUPLOT_ROW(g, last, none ? 1 / (double)next->compared : value);
    }
    GNUPLOT_ROW(g, NAN, NAN);
}

static bool occurs(const struct accuracy *a, const struct series *series)
{
    bool any = false;
    for (size_t k = 0; k < a->all; k++)
        any |= belongs(a, k, series);
    return any || (!series->method && !series->usual); /* a peer that cannot is said, too */
}

/* Orders, failures and residuals in words under the name of series m. */
static void put_legend(struct gnuplot *g, const struct accuracy *a, const struct series *series,
                       size_t m)
{
    char text[PEER_NAME + PEER_REASON];
    const struct accuracy_peer *const peer = series->method ? NULL : &a->peer[series->peer];
    double residual = 0;
    uint64_t failed = 0, cases = 0;
    size_t settings = 0;
    int line = 0;
#define PUT_LINE gnuplot_text(g, text, "about[%zu]", (m - 1) * LINES + (size_t)++line)
    for (size_t k = 0; k < a->all; k++) {
        const struct accuracy_row *row = &a->row[k];
        if (belongs(a, k, series)) {
            failed += row->failed, cases += row->cases;
            settings++;
            residual = fmax(residual, fmax(row->signorini, fmax(row->coulomb, row->dissipation)));
        }
    }
    snprintf(text, sizeof text, "%s%s", peer ? peer->name : series->method->name,
             series->usual ? ", defaults" : "");
    gnuplot_text(g, text, "method_name[%zu]", m);
    for (size_t k = 0; k < a->orders && line + 2 < LINES; k++) {
        const struct accuracy_order *order = &a->order[k];
        if (order->method == series->method && !isnan(order->position)) {
            snprintf(text, sizeof text, "order %.2f of %s %.0e ... %.0e", order->position,
                     order->by_tolerance ? "tolerance" : "step", order->from, order->to);
            PUT_LINE;
        }
    }
    if (peer && peer->cannot[0] != '\0') {
        snprintf(text, sizeof text, "cannot: %.40s", peer->cannot);
        PUT_LINE;
    } else if (peer) {
        snprintf(text, sizeof text, "%zu settings%s", settings,
                 series->usual ? "" : "; the line joins the best");
        PUT_LINE;
    } else {
        if (residual > 0)
            snprintf(text, sizeof text, "contact laws broken by at most %.0e", residual);
        else
            snprintf(text, sizeof text, "contact laws never broken");
        PUT_LINE;
    }
    if (failed > 0) {
        snprintf(text, sizeof text, "gave up in %llu of %llu cases", (unsigned long long)failed,
                 (unsigned long long)cases);
        PUT_LINE;
    }
#undef PUT_LINE
    gnuplot_set(g, "about_lines[%zu] = %d", m, line);
}

static size_t list_series(const struct accuracy *a, struct series *series)
{
    size_t n = 0;
    for (size_t m = 0; stance_methods()[m] && n < ACCURACY_METHODS; m++) {
        series[n] = (struct series){.method = stance_methods()[m]};
        n += occurs(a, &series[n]);
    }
    for (size_t p = 0; p < a->peers; p++) {
        for (int usual = 0; usual < 2; usual++) {
            series[n] = (struct series){.peer = p, .usual = usual};
            n += occurs(a, &series[n]);
        }
    }
    return n;
}

/* Colours of methods stay with them; those of peers come after. */
static size_t style_of(const struct series *series)
{
    size_t m = 0;
    while (series->method && stance_methods()[m] != series->method)
        m++;
    return series->method ? m % 5 + 1 : 6 + series->peer % 2;
}

bool accuracy_plot(const struct accuracy *a, const struct results *r, struct look *look,
                   const char *directory, const char *stem, stance_message *message)
{
    const int panels = a->labels ? 1 : 2;
    const struct accuracy_row *truth = &a->row[a->truth];
    struct gnuplot g;
    char subtitle[400];
    struct series series[ACCURACY_METHODS + 2 * ACCURACY_PEERS];
    const size_t methods = list_series(a, series);
    struct range cost = {INFINITY, 0}, error[2] = {{INFINITY, 0}, {INFINITY, 0}};

    snprintf(subtitle, sizeof subtitle,
             "Error against cost. Reference: %s, tolerance %g. %llu cases per point; a cross marks "
             "points where cases were given up%s",
             truth->method->name, truth->tolerance, (unsigned long long)truth->cases,
             a->labels ? "; open symbols: none unlike, drawn where one cell is."
                       : ". Errors of exactly zero are not drawn.");
    if (!gnuplot_begin(&g, look, plot_accuracy_gp, r->title, subtitle, message))
        return false;
    gnuplot_set(&g, "panels = %d; labels = %d; lines_each = %d", panels, a->labels, LINES);
    gnuplot_set(&g,
                "array method_name[%zu]\narray method_style[%zu]\narray peer[%zu]\n"
                "array about_lines[%zu]\narray about[%zu]\n"
                "array cost_low[1]\narray cost_high[1]\narray error_low[2]\narray error_high[2]",
                methods, methods, methods, methods, methods * LINES);
    for (size_t m = 1; m <= methods; m++) {
        const struct series *const one = &series[m - 1];
        put_legend(&g, a, one, m);
        gnuplot_set(&g, "method_style[%zu] = %zu", m, style_of(one));
        gnuplot_set(&g, "peer[%zu] = %d", m, one->method ? 0 : one->usual ? 2 : 1);
        for (int p = 0; p < panels; p++) {
            const enum shown shown = a->labels ? LABELS : p == 0 ? POSITION : VELOCITY;
            gnuplot_block(&g, "errors%zu_%d", m, p + 1);
            put_rows(&g, a, one, shown, &cost, &error[p]);
            GNUPLOT_ROW(&g, NAN, NAN, 1, 0);
            gnuplot_end_block(&g);
            gnuplot_block(&g, "line%zu_%d", m, p + 1);
            put_line(&g, a, one, shown);
            gnuplot_end_block(&g);
        }
    }
    gnuplot_set(&g, "methods = %zu", methods);
    put_range(&g, &cost, "cost", 1);
    for (int p = 0; p < panels; p++)
        put_range(&g, &error[p], "error", p + 1);
    return gnuplot_end(&g, directory, stem, message);
}
