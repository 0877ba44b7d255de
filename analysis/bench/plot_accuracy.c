/* plot_accuracy.c - error against cost, one line for each method; failures marked. */
#include "accuracy.h"

#include "analysis/draw/gnuplot.h"

#include <math.h>
#include <string.h>

enum { LEFT = 92, PANEL_WIDTH = 400, PANEL_HEIGHT = 380, GAP = 92, LEGEND = 300, BOTTOM = 78 };

/* After Okabe and Ito (2008); the markers differ too. In the order of stance_methods(). */
static const char *const colours[] = {"#0072b2", "#56b4e9", "#009e73", "#d55e00",
                                      "#cc79a7", "#e69f00", "#000000"};
static const int markers[] = {7, 5, 9, 11, 13, 15, 2}; /* filled; one less is the open one */
enum { STYLES = sizeof markers / sizeof markers[0] };

static size_t style_of(const stance_method *method)
{
    size_t m = 0;
    while (stance_methods()[m] && stance_methods()[m] != method)
        m++;
    return m % STYLES;
}

/* What a panel shows of a row; NAN: nothing. */
enum shown { POSITION, VELOCITY, LABELS };

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

static void put_range(FILE *script, char axis, const struct range *range)
{
    const bool any = range->low <= range->high;
    fprintf(script, "set %crange [%.6e:%.6e]\n", axis, any ? 0.6 * range->low : 0.1,
            any ? 1.7 * range->high : 10);
}

/* Lines and points of one method; failed rows apart. No cell unlike is fewer than one: so it is
 * drawn, open, at the share of one. */
static void put_method(struct gnuplot *g, const struct accuracy *a, const stance_method *method,
                       enum shown shown, struct range *y, char name[2][32])
{
    for (int failed = 0; failed < 2; failed++) {
        FILE *data = gnuplot_data(g, name[failed]);
        for (size_t k = 0; k < a->rows; k++) {
            const struct accuracy_row *row = &a->row[k];
            if (row->method != method || k == a->truth || (failed && row->failed == 0))
                continue;
            const double value = shown_value(row, shown);
            const bool none = shown == LABELS && isnan(value) && row->compared > 0;
            const double drawn = none ? 1 / (double)row->compared : value;
            widen(y, drawn);
            gnuplot_number(data, row->cost.median);
            putc(' ', data);
            gnuplot_number(data, drawn);
            fprintf(data, " %d\n", !none);
        }
        gnuplot_close_data(g, data);
    }
}

static bool occurs(const struct accuracy *a, const stance_method *method)
{
    for (size_t k = 0; k < a->rows; k++)
        if (a->row[k].method == method && k != a->truth)
            return true;
    return false;
}

static void put_panel(struct gnuplot *g, const struct accuracy *a, enum shown shown, double left,
                      double top)
{
    static const char *const texts[] = {[POSITION] = "largest error of a coordinate (m, rad)",
                                        [VELOCITY] =
                                            "mean over time of the velocity error (m/s, rad/s)",
                                        [LABELS] = "share of cells unlike the reference"};
    struct range x = {INFINITY, 0}, y = {INFINITY, 0};
    char name[STYLES][2][32];
    size_t drawn = 0;

    for (size_t k = 0; k < a->rows; k++)
        if (k != a->truth)
            widen(&x, a->row[k].cost.median);
    for (size_t m = 0; stance_methods()[m] && m < STYLES; m++)
        put_method(g, a, stance_methods()[m], shown, &y, name[m]);
    gnuplot_panel(g, left, top, PANEL_WIDTH, PANEL_HEIGHT);
    fputs("set logscale xy; set format x '%g'; set format y '%.0e'\n"
          "set grid lc '#e4e4e4' lw 0.6\n"
          "set xlabel 'cost: microseconds of one core per simulated second' font ',10'\n"
          "set tics font ',10'\n",
          g->script);
    put_range(g->script, 'x', &x);
    put_range(g->script, 'y', &y);
    fputs("set ylabel ", g->script);
    gnuplot_text(g->script, texts[shown], 0);
    fputs(" font ',10'\nplot ", g->script);
    for (size_t m = 0; stance_methods()[m] && m < STYLES; m++) {
        if (!occurs(a, stance_methods()[m]))
            continue;
        const char *const data = name[m][0], *const colour = colours[m];
        fprintf(g->script, "%s'%s' using 1:2 with lines lc rgb '%s' lw 1.6 notitle",
                drawn++ ? ", " : "", data, colour);
        if (shown == LABELS) {
            fprintf(g->script,
                    ", '%s' using 1:($3 > 0 ? NaN : $2) with points lc rgb '%s' pt %d ps 1 notitle",
                    data, colour, markers[m] - 1);
        }
        fprintf(g->script,
                ", '%s' using 1:($3 > 0 ? $2 : NaN) with points lc rgb '%s' pt %d ps 0.9 notitle",
                data, colour, markers[m]);
        fprintf(g->script,
                ", '%s' using 1:2 with points lc rgb '#b00000' pt 2 ps 1.6 lw 1.6 notitle",
                name[m][1]);
    }
    fputs(drawn ? "\n" : "NaN notitle\n", g->script);
    fputs("unset logscale; unset grid; unset xlabel; unset ylabel\n", g->script);
}

/* Orders, failures and residuals of a method, in words under its name. */
static double put_legend(struct gnuplot *g, const struct accuracy *a, const stance_method *method,
                         double x, double y)
{
    char text[160];
    const size_t style = style_of(method);
    double residual = 0;
    uint64_t failed = 0, cases = 0;
    for (size_t k = 0; k < a->rows; k++) {
        const struct accuracy_row *row = &a->row[k];
        if (row->method == method && k != a->truth) {
            failed += row->failed, cases += row->cases;
            residual = fmax(residual, fmax(row->signorini, fmax(row->coulomb, row->dissipation)));
        }
    }
    gnuplot_legend(g, x, y, colours[style], method->name);
    y += 17;
    for (size_t k = 0; k < a->orders; k++) {
        const struct accuracy_order *order = &a->order[k];
        if (order->method == method && !isnan(order->position)) {
            snprintf(text, sizeof text, "order %.2f of %s %.0e ... %.0e", order->position,
                     order->by_tolerance ? "tolerance" : "step", order->from, order->to);
            gnuplot_label(g, x + 22, y, text, "left", 9, false);
            y += 14;
        }
    }
    if (residual > 0)
        snprintf(text, sizeof text, "contact laws broken by at most %.0e", residual);
    else
        snprintf(text, sizeof text, "contact laws never broken");
    gnuplot_label(g, x + 22, y, text, "left", 9, false);
    y += 14;
    if (failed > 0) {
        snprintf(text, sizeof text, "gave up in %llu of %llu cases", (unsigned long long)failed,
                 (unsigned long long)cases);
        gnuplot_label(g, x + 22, y, text, "left", 9, false);
        y += 14;
    }
    return y + 8;
}

bool accuracy_plot(const struct accuracy *a, const struct results *r, const char *directory,
                   const char *stem, stance_message *message)
{
    const int panels = a->labels ? 1 : 2;
    const int width = LEFT + panels * PANEL_WIDTH + (panels - 1) * GAP + LEGEND;
    const struct accuracy_row *truth = &a->row[a->truth];
    struct gnuplot g;
    char subtitle[400];

    snprintf(subtitle, sizeof subtitle,
             "Error against cost. Reference: %s, tolerance %g. %llu cases per point; a cross marks "
             "points where cases were given up%s. Errors of exactly zero are not drawn.",
             truth->method->name, truth->tolerance, (unsigned long long)truth->cases,
             a->labels ? "; open symbols: none unlike, drawn where one cell is" : "");
    if (a->labels)
        *strstr(subtitle, " Errors of exactly") = '\0';
    const int top = gnuplot_title_height(width, r->title, subtitle);
    if (!gnuplot_begin(&g, width, top + PANEL_HEIGHT + BOTTOM, message))
        return false;
    gnuplot_title(&g, r->title, subtitle);
    double y = top + 10;
    for (size_t m = 0; stance_methods()[m]; m++)
        if (occurs(a, stance_methods()[m]))
            y = put_legend(&g, a, stance_methods()[m], width - LEGEND + 24, y);
    gnuplot_decorate(&g);
    put_panel(&g, a, a->labels ? LABELS : POSITION, LEFT, top);
    if (!a->labels)
        put_panel(&g, a, VELOCITY, LEFT + PANEL_WIDTH + GAP, top);
    return gnuplot_end(&g, directory, stem, message);
}
