/* plot_animation.c - a case, or two at the same time, as stick figures that move, in real time. */
#include "plot_case.h"

#include "runner/base/message.h"

#include <math.h>
#include <stdlib.h>

static const double frame_time = 0.04; /* s, at the least */

struct animation {
    struct gnuplot g;
    struct figure *figure[2]; /* [frames] of each case; NULL: there is no other */
    int frames;
    double step;  /* s, from one to the next */
    bool follows; /* the robot travels too far for a view that stays */
};

/* Where the view is at a frame, if it follows the first case. */
static double place(const struct animation *a, int f, int i)
{
    return !a->follows ? 0 : i == 0 ? a->figure[0][f].centre : a->figure[0][f].base;
}

/* What is seen along x and z, around the points of all frames. */
static void see(const struct animation *a, struct plot_range range[2])
{
    range[0] = PLOT_NOTHING;
    range[1] = (struct plot_range){0, 0};
    for (int c = 0; c < 2 && a->figure[c]; c++)
        for (int f = 0; f < a->frames; f++)
            figure_widen(range, &a->figure[c][f], place(a, f, 0), place(a, f, 1));
}

/* The ground between places that move with the view, each frame an index; `z` is widened to where
 * it goes down to. */
static void put_ground(struct animation *a, const struct plot_case *c, struct plot_range x,
                       struct plot_range *z)
{
    gnuplot_series(&a->g, "index f-1 using 1:2 with lines lw 2 lc rgb 0xa0a0a0");
    for (int f = 0; f < a->frames; f++) {
        const double about = place(a, f, 0);
        const double low = plot_ground(&a->g, c, f * a->step,
                                       (struct plot_range){about + x.low, about + x.high}, 0, 0);
        if (c->floor)
            z->low = fmin(z->low, low - place(a, f, 1));
        gnuplot_gap(&a->g);
    }
}

/* What is seen, as large as the page has room, in the proportions of the ranges. */
static void put_view(struct animation *a, const struct plot_case *c)
{
    enum { WIDE = 632, HIGH = 480 };
    struct gnuplot *const g = &a->g;
    struct plot_range range[2];
    see(a, range);
    a->follows = range[0].high - range[0].low > 3 * (range[1].high - range[1].low);
    see(a, range);
    struct plot_range x = range[0], z = range[1];
    const double tall = z.high - z.low, margin = 0.08 * tall + 1e-9,
                 middle = 0.5 * (x.low + x.high),
                 half = fmax(fmax(0.6 * tall, 0.5 * (x.high - x.low)) + margin,
                             0.5 * (tall + 2 * margin) * WIDE / HIGH);
    gnuplot_set(g, "equal = legend_low = scaled = 1; gridded = 0; travels = %d; chart_width = %d",
                a->follows, WIDE);
    x = (struct plot_range){middle - half, middle + half};
    gnuplot_axis(g, 'x', PLOT_LINEAR, x, "x", "m");
    gnuplot_panel(g, 0, "");
    gnuplot_text(g, " ", "panel_right[panels]"); /* room for the time */
    put_ground(a, c, x, &z);
    z = (struct plot_range){z.low - margin, z.high + margin};
    gnuplot_set(g, "panel_own[1] = %.10g", WIDE * (z.high - z.low) / (2 * half));
    gnuplot_axis(g, 'y', PLOT_LINEAR, z, "z", "m");
    gnuplot_arrays(g, (size_t)a->frames, "centre base");
    for (int f = 0; f < a->frames; f++) {
        gnuplot_number(g, place(a, f, 0), "centre[%d]", f + 1);
        gnuplot_number(g, place(a, f, 1), "base[%d]", f + 1);
    }
    gnuplot_set(g,
                "frames = %d; frame_step = %.10g; delay = int(100*frame_step + 0.5); "
                "low_x = x_low; high_x = x_high; low_y = y1_low; high_y = y1_high",
                a->frames, a->step);
}

/* The frames of the cases, the second one grey, each an index. */
static void put_frames(struct animation *a, int contacts)
{
    static const char *const styles[] = {
        "using 1:2 with lines lw 3 lc rgb 0xb8b8b8",
        "using 1:2:(" FIGURE_COLOUR ") with lines lw 3 lc rgb variable",
        "using 1:2:(" FIGURE_COLOUR ") with points pt 7 ps 0.9 lc rgb variable"};
    for (int k = a->figure[1] ? 0 : 1; k < 3; k++) {
        gnuplot_series(&a->g, "index f-1 %s", styles[k]);
        for (int f = 0; f < a->frames; f++) {
            figure_put(&a->g, &a->figure[k == 0][f], contacts,
                       k == 2 ? FIGURE_POINTS : FIGURE_SEGMENTS, 0, 0);
            gnuplot_gap(&a->g);
            gnuplot_gap(&a->g);
        }
    }
}

bool plot_animation(const struct plot_case *c)
{
    struct animation a = {.follows = false};
    if (!c->scenario || (c->other && !c->other->scenario))
        return complain(c->plot->message,
                        "%.150s: no stick figures: this version cannot read its scenario",
                        c->plot->r->file);
    double end = 0;
    for (const struct plot_case *k = c; k; k = k->other)
        end = fmax(end, k->t->time[k->t->rows - 1]);
    const double step = fmax(frame_time, ceil(100 * end / LOOK_MOST_FRAMES) / 100);
    a.step = step;
    a.frames = (int)(end / step + 1e-9) + 1;
    c->plot->look->animated = step;
    if (!plot_case_begin(c, &a.g, "animation", "Stick figures"))
        return false;
    int cases = 0;
    for (const struct plot_case *k = c; k; k = k->other) {
        struct figure *const figure = gnuplot_room(&a.g, (size_t)a.frames, sizeof *figure);
        for (int f = 0; figure && f < a.frames; f++)
            figure_make(&figure[f], k, figure_row(k->t, f * step));
        a.figure[cases++] = figure;
    }
    const int contacts = figure_colours(&a.g, c->scenario->scene);
    figure_legend(&a.g, c);
    if (a.figure[0]) {
        put_view(&a, c);
        put_frames(&a, contacts);
    }
    return gnuplot_end(&a.g);
}
