/* plot_line.c - every case of a sweep over one axis: its outcome, and answers against the axis. */
#include "analysis/draw/plot.h"

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
                     const struct statistics_place *points)
{
    const size_t n = along->axis->count;
    double low = along->low;
    gnuplot_block(g, "runs");
    for (size_t i = 0; i < n; i++) {
        const uint8_t kind = r->kind[points[i].index];
        if (i + 1 < n && r->kind[points[i + 1].index] == kind)
            continue;
        const double high = i + 1 < n ? 0.5 * (points[i].value + points[i + 1].value) : along->high;
        GNUPLOT_ROW(g, low, high, kind);
        low = high;
    }
    gnuplot_end_block(g);
}

/* The page STEM-`picture` of LINE_PANELS panels, those without values left out; frees the values,
 * which is all that it does where `what` is NULL. */
static bool draw_page(const struct plot *plot, struct line_panel *panels, const char *what,
                      const char *picture, stance_message *message)
{
    struct plot_axis along;
    struct gnuplot g;
    int panel = 0;
    plot_axis_make_curve(&along, &plot->r->axis[0]);
    struct statistics_place *points = plot_axis_points(&along, message);
    const bool good = points && what && plot_begin(plot, &g, plot_line_gp, what, message);
    if (good) {
        plot_axis_write(&along, &g, "x");
        plot_kinds_write(plot->r, &g, true);
        put_runs(&g, plot->r, &along, points);
        gnuplot_arrays(&g, LINE_PANELS, "answer answer_unit lowest highest");
        for (const struct line_panel *p = panels; p < panels + LINE_PANELS; p++) {
            if (!p->values)
                continue;
            gnuplot_text(&g, p->name, "answer[%d]", ++panel);
            gnuplot_text(&g, p->unit, "answer_unit[%d]", panel);
            gnuplot_set(&g, "lowest[%d] = %#.17g; highest[%d] = %#.17g", panel, p->low, panel,
                        p->high);
            gnuplot_block(&g, "line%d", panel);
            for (size_t i = 0; i < along.axis->count; i++)
                GNUPLOT_ROW(&g, points[i].value, p->values[points[i].index],
                            plot->r->kind[points[i].index]);
            gnuplot_end_block(&g);
        }
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
    const struct results *r = plot->r;
    char what[96];
    bool good = true;
    if (r->sample >= 0 || r->axes != 1)
        return true;
    plot_became_text(r, what, sizeof what);
    for (int k = 0; good && k < LINE_PANELS; k++) {
        struct line_panel *const panel = &panels[k];
        good = results_answer(r, panel->name, &panel->values, message);
        if (good && panel->values &&
            !plot_range(panel->values, r->cases, &panel->low, &panel->high)) {
            free(panel->values);
            panel->values = NULL;
        }
    }
    return draw_page(plot, panels, good ? what : NULL, "curve", message);
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
