/* plot_line.c - every case of a sweep over one axis: its outcome, and answers against the axis. */
#include "analysis/draw/plot.h"

#include <math.h>
#include <stdlib.h>

struct line {
    struct gnuplot g;
    struct plot_axis along;
    struct statistics_place *points;
    size_t count; /* of them */
};

/* A strip of runs of neighbours of the same kind, from where to where: seams between boxes would
 * show. */
static void put_runs(struct line *line)
{
    const uint8_t *const kind = line->g.plot->r->kind;
    const struct statistics_place *const p = line->points;
    double low = line->along.range.low;
    gnuplot_panel(&line->g, 30, "");
    gnuplot_set(&line->g, "chart_beside = 'outcome'");
    gnuplot_series(&line->g,
                   "using (0.5*($1+$2)):(0.5):1:2:(0):(1):(kind_colour[$3+1]) with boxxyerror "
                   "fillstyle solid noborder lc rgb variable");
    for (size_t i = 0; i < line->count; i++) {
        const bool last = i + 1 == line->count;
        if (!last && kind[p[i + 1].index] == kind[p[i].index])
            continue;
        const double high = last ? line->along.range.high : 0.5 * (p[i].value + p[i + 1].value);
        GNUPLOT_ROW(&line->g, low, high, kind[p[i].index]);
        low = high;
    }
}

/* The page STEM-`name`, its axis and the outcomes. */
static bool begin(struct line *line, const struct plot *plot, const char *name)
{
    if (!gnuplot_begin(&line->g, plot, name))
        return false;
    plot_axis_make_curve(&line->along, &plot->r->axis[0]);
    line->points = plot_axis_points(&line->along, &line->g);
    line->count = line->points ? line->along.axis->count : 0;
    plot_axis_write(&line->along, &line->g, 'x');
    plot_kinds_write(&line->g, true);
    put_runs(line);
    return true;
}

/* A panel of an answer of every case; points are not to sit on its frame. */
static void put_answer(struct line *line, const char *name, const char *unit, const double *values,
                       struct plot_range range)
{
    const size_t n = line->count;
    const double room =
        range.high > range.low ? 0.06 * (range.high - range.low) : 0.1 * fabs(range.low) + 0.05;
    gnuplot_panel(&line->g, 150, "");
    gnuplot_axis(&line->g, 'y', PLOT_LINEAR,
                 (struct plot_range){range.low - room, range.high + room}, name, unit);
    gnuplot_series(&line->g,
                   "using 1:2 with lines lc rgb '#b0b0b0' lw 1 notitle, '' using "
                   "1:2:(kind_colour[$3+1]) with points pt 7 ps %g lc rgb variable",
                   gnuplot_dot(n));
    for (size_t i = 0; i < n; i++)
        GNUPLOT_ROW(&line->g, line->points[i].value, values[line->points[i].index],
                    line->g.plot->r->kind[line->points[i].index]);
}

bool plot_line(const struct plot *plot)
{
    static const char *const names[][2] = {
        {"settle_time", "s"}, {"end_time", "s"}, {"friction_used", ""}};
    const struct results *r = plot->r;
    struct line line;
    if (r->sample >= 0 || r->axes != 1)
        return true;
    if (!begin(&line, plot, "curve"))
        return false;
    plot_say_became(&line.g);
    for (size_t k = 0; k < sizeof names / sizeof *names; k++) {
        double *values = NULL;
        struct plot_range range;
        if (gnuplot_needs(&line.g, results_answer(r, names[k][0], &values, plot->message)) &&
            values && gnuplot_keep(&line.g, values) && plot_range_of(&range, values, r->cases))
            put_answer(&line, names[k][0], names[k][1], values, range);
    }
    return gnuplot_end(&line.g);
}

bool plot_answer_curve(const struct plot *plot, const struct plot_answer *answer)
{
    struct line line;
    struct plot_range range;
    char text[600];
    double *const values = plot_answer_numbers(plot, answer, &range);
    if (!values || !begin(&line, plot, answer->name)) {
        free(values);
        return false;
    }
    plot_answer_text(answer, text, sizeof text);
    gnuplot_say(&line.g, "%s", text);
    put_answer(&line, answer->name, answer->unit, values, range);
    free(values);
    return gnuplot_end(&line.g);
}
