/* plot_line.c - every case of a sweep over one axis: its outcome, and answers against the axis. */
#include "plot_points.h"

#include "analysis/statistics/statistics.h"

#include <math.h>
#include <stdlib.h>

GNUPLOT_SCRIPT(plot_line_gp, "analysis/plot/plot_line.gp");

/* One answer of every case. */
struct line_panel {
    const char *name, *unit;
    double *values; /* NULL: nothing to draw */
    double low, high;
};
enum { LINE_PANELS = 3 };

/* Runs of neighbours of the same kind, from where to where: seams between boxes would show. */
static void put_runs(struct gnuplot *g, const struct results *r, const struct plot_axis *along,
                     const struct plot_point *points)
{
    const size_t n = along->axis->count;
    double low = along->low;
    gnuplot_block(g, "runs");
    for (size_t i = 0; i < n; i++) {
        const uint8_t kind = r->kind[points[i].index];
        if (i + 1 < n && r->kind[points[i + 1].index] == kind)
            continue;
        const double high = i + 1 < n ? 0.5 * (points[i].place + points[i + 1].place) : along->high;
        GNUPLOT_ROW(g, low, high, kind);
        low = high;
    }
    gnuplot_end_block(g);
}

static void put_panel(struct gnuplot *g, const struct results *r, const struct plot_axis *along,
                      const struct plot_point *points, const struct line_panel *panel, int number)
{
    gnuplot_text(g, panel->name, "answer[%d]", number);
    gnuplot_text(g, panel->unit, "answer_unit[%d]", number);
    gnuplot_set(g, "lowest[%d] = %#.17g; highest[%d] = %#.17g", number, panel->low, number,
                panel->high);
    gnuplot_block(g, "line%d", number);
    for (size_t i = 0; i < along->axis->count; i++) {
        const size_t index = points[i].index;
        GNUPLOT_ROW(g, points[i].place, panel->values[index], r->kind[index]);
    }
    gnuplot_end_block(g);
}

/* Reads an answer and its range. */
static bool read_panel(const struct results *r, struct line_panel *panel, stance_message *message)
{
    if (!results_answer(r, panel->name, &panel->values, message))
        return false;
    panel->low = INFINITY;
    panel->high = -INFINITY;
    for (uint64_t i = 0; panel->values && i < r->cases; i++) {
        if (isfinite(panel->values[i])) {
            panel->low = fmin(panel->low, panel->values[i]);
            panel->high = fmax(panel->high, panel->values[i]);
        }
    }
    if (!(panel->low <= panel->high)) {
        free(panel->values);
        panel->values = NULL;
    }
    return true;
}

/* The page STEM-`picture` of LINE_PANELS panels, those without values left out; frees the values.
 */
static bool draw_page(const struct plot *plot, struct line_panel *panels, const char *what,
                      const char *picture, stance_message *message)
{
    struct plot_axis along;
    struct gnuplot g;
    int panel = 0;
    plot_axis_make_curve(&along, &plot->r->axis[0]);
    struct plot_point *points = plot_points_make(&along, message);
    const bool good = points && plot_begin(plot, &g, plot_line_gp, what, message);
    if (good) {
        plot_axis_write(&along, &g, "x");
        plot_kinds_write(plot->r, &g, true);
        put_runs(&g, plot->r, &along, points);
        gnuplot_set(&g,
                    "array answer[%d]\narray answer_unit[%d]\narray lowest[%d]\narray highest[%d]",
                    LINE_PANELS, LINE_PANELS, LINE_PANELS, LINE_PANELS);
        for (int k = 0; k < LINE_PANELS; k++)
            if (panels[k].values)
                put_panel(&g, plot->r, &along, points, &panels[k], ++panel);
        gnuplot_set(&g, "panels = %d", panel);
    }
    free(points);
    for (int k = 0; k < LINE_PANELS; k++)
        free(panels[k].values);
    return good && plot_end(plot, &g, picture, message);
}

bool plot_line(const struct plot *plot, stance_message *message)
{
    struct line_panel panels[LINE_PANELS] = {{.name = "settle_time", .unit = "s"},
                                             {.name = "end_time", .unit = "s"},
                                             {.name = "friction_used", .unit = ""}};
    char what[96];
    if (plot->r->sample >= 0 || plot->r->axes != 1)
        return true;
    plot_became_text(plot->r, what, sizeof what);
    for (int k = 0; k < LINE_PANELS; k++) {
        if (!read_panel(plot->r, &panels[k], message)) {
            while (k-- > 0)
                free(panels[k].values);
            return false;
        }
    }
    return draw_page(plot, panels, what, "curve", message);
}

bool plot_answer_curve(const struct plot *plot, const struct plot_answer *answer,
                       stance_message *message)
{
    struct line_panel panels[LINE_PANELS] = {{.name = answer->name, .unit = answer->unit}};
    char what[256];
    plot_answer_title(answer, what, sizeof what);
    return plot_answer_numbers(plot, answer, &panels[0].values, &panels[0].low, &panels[0].high,
                               message) &&
           draw_page(plot, panels, what, answer->name, message);
}
