/* plot_animation.c - a case, or two at the same time, as stick figures that move, in real time. */
#include "plot_case.h"

#include "runner/base/message.h"

#include <math.h>
#include <stdlib.h>

GNUPLOT_SCRIPT(plot_animation_gp, "analysis/plot/plot_animation.gp");

static const double frame_time = 0.04; /* s, at the least */

/* What is seen. */
struct view {
    double low[2], high[2]; /* m: x about the centre where it follows, z above the ground there */
    bool follows;           /* the robot travels too far for a view that stays */
};

/* Row of a trajectory at a time: the last one from its end on. */
static size_t row_at(const struct results_trajectory *t, double time)
{
    size_t row = 0;
    while (row + 1 < t->rows && t->time[row + 1] <= time + 1e-9)
        row++;
    return row;
}

static double end_of(const struct plot_case *c)
{
    double end = 0;
    for (; c; c = c->other)
        end = fmax(end, c->t->time[c->t->rows - 1]);
    return end;
}

/* Around the points of all frames, about a place that moves with the first case if it `follows`. */
static struct view measure(const struct plot_case *c, int frames, double step, bool follows)
{
    struct view view = {{INFINITY, 0}, {-INFINITY, 0}, follows};
    for (const struct plot_case *k = c; k; k = k->other) {
        for (int f = 0; f < frames; f++) {
            struct figure first, figure;
            figure_make(&first, c, row_at(c->t, f * step));
            figure_make(&figure, k, row_at(k->t, f * step));
            const double about[2] = {follows ? first.centre : 0, follows ? first.base : 0};
            for (int p = 0; p < figure.points; p++)
                for (int i = 0; i < 2; i++) {
                    view.low[i] = fmin(view.low[i], figure.point[p][i] - about[i]);
                    view.high[i] = fmax(view.high[i], figure.point[p][i] - about[i]);
                }
        }
    }
    const double wide = view.high[0] - view.low[0], tall = view.high[1] - view.low[1];
    if (!follows && wide > 3 * tall)
        return measure(c, frames, step, true);
    const double margin = 0.08 * tall + 1e-9, middle = 0.5 * (view.low[0] + view.high[0]);
    const double half = fmax(0.6 * tall, 0.5 * wide) + margin;
    return (struct view){
        {middle - half, view.low[1] - margin}, {middle + half, view.high[1] + margin}, follows};
}

/* The frames of one case, each an index of $segments<number> and $points<number>. */
static void put_frames(struct gnuplot *g, const struct plot_case *c, int number, int frames,
                       double step)
{
    for (int part = FIGURE_SEGMENTS; part <= FIGURE_POINTS; part++) {
        gnuplot_block(g, "%s%d", part == FIGURE_SEGMENTS ? "segments" : "points", number);
        for (int f = 0; f < frames; f++) {
            struct figure figure;
            figure_make(&figure, c, row_at(c->t, f * step));
            figure_put(g, &figure, plot_case_grounded(c->scenario.scene), (enum figure_part)part, 0,
                       0);
            gnuplot_gap(g);
            gnuplot_gap(g);
        }
    }
}

bool plot_animation(const struct plot_case *c)
{
    struct gnuplot g;
    int number = 0;
    if (!c->readable || (c->other && !c->other->readable))
        return complain(c->plot->message,
                        "%.150s: no stick figures: this version cannot read its scenario",
                        c->plot->r->file);
    const double step = fmax(frame_time, ceil(100 * end_of(c) / LOOK_MOST_FRAMES) / 100);
    const int frames = (int)(end_of(c) / step + 1e-9) + 1;
    const struct view view = measure(c, frames, step, false);
    c->plot->look->animated = step;
    if (!plot_case_begin(c, &g, "animation", plot_animation_gp, "Stick figures"))
        return false;
    gnuplot_set(&g, "frames = %d; step = %.10g; fall = %#.17g; follows = %d; cases = %d", frames,
                step, figure_fall(c), view.follows, c->other ? 2 : 1);
    gnuplot_set(&g, "low_x = %#.17g; high_x = %#.17g; low_z = %#.17g; high_z = %#.17g", view.low[0],
                view.high[0], view.low[1], view.high[1]);
    figure_names(&g, c->scenario.scene);
    gnuplot_arrays(&g, (size_t)frames, "centre base");
    for (int f = 0; f < frames; f++) {
        struct figure figure;
        figure_make(&figure, c, row_at(c->t, f * step));
        gnuplot_number(&g, view.follows ? figure.centre : 0, "centre[%d]", f + 1);
        gnuplot_number(&g, view.follows ? figure.base : 0, "base[%d]", f + 1);
    }
    for (const struct plot_case *k = c; k; k = k->other)
        put_frames(&g, k, ++number, frames, step);
    return gnuplot_end(&g);
}
