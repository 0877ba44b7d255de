/* plot_animation.c - a case, or two at the same time, as stick figures that move, in real time. */
#include "plot_case.h"

#include "runner/base/message.h"

#include <math.h>
#include <stdlib.h>

GNUPLOT_SCRIPT(plot_animation_gp, "analysis/plot/plot_animation.gp");

static const double frame_time = 0.04; /* s, at the least */

struct animation {
    struct gnuplot g;
    struct figure *figure[2]; /* [frames] of each case; NULL: there is no other */
    int frames;
    double step;  /* s, from one to the next */
    bool follows; /* the robot travels too far for a view that stays */
};

/* What is seen along x or z, around the points of all frames, about a place that moves with the
 * first case if it follows. */
static struct plot_range see(const struct animation *a, int i)
{
    struct plot_range range = {i == 0 ? INFINITY : 0, i == 0 ? -INFINITY : 0};
    for (int c = 0; c < 2 && a->figure[c]; c++) {
        for (int f = 0; f < a->frames; f++) {
            const struct figure *const first = &a->figure[0][f], *const figure = &a->figure[c][f];
            const double about = !a->follows ? 0 : i == 0 ? first->centre : first->base;
            for (int p = 0; p < figure->points; p++)
                plot_widen(&range, figure->point[p][i] - about);
        }
    }
    return range;
}

/* Plates, each frame an index of $ground; `z` is widened to where they go down to. */
static void put_ground(struct animation *a, const struct plot_case *c, struct plot_range x,
                       struct plot_range *z)
{
    double(*const point)[2] = gnuplot_room(&a->g, PLOT_GROUND, sizeof *point);
    gnuplot_set(&a->g, "uneven = %d", c->floor != NULL);
    gnuplot_block(&a->g, "ground");
    if (!c->floor)
        GNUPLOT_ROW(&a->g, NAN, NAN);
    if (!c->floor || !point)
        return;
    for (int f = 0; f < a->frames; f++) {
        const double about = a->follows ? a->figure[0][f].centre : 0;
        const size_t points = plot_ground(c, f * a->step, about + x.low, about + x.high, point);
        for (size_t k = 0; k < points; k++) {
            GNUPLOT_ROW(&a->g, point[k][0], point[k][1]);
            z->low = fmin(z->low, point[k][1] - (a->follows ? a->figure[0][f].base : 0));
        }
        gnuplot_gap(&a->g);
        gnuplot_gap(&a->g);
    }
}

static void put_view(struct animation *a, const struct plot_case *c)
{
    struct plot_range x = see(a, 0), z = see(a, 1);
    if (x.high - x.low > 3 * (z.high - z.low)) {
        a->follows = true;
        x = see(a, 0);
        z = see(a, 1);
    }
    const double tall = z.high - z.low, margin = 0.08 * tall + 1e-9;
    const double half = fmax(0.6 * tall, 0.5 * (x.high - x.low)) + margin,
                 middle = 0.5 * (x.low + x.high);
    put_ground(a, c, (struct plot_range){middle - half, middle + half}, &z);
    gnuplot_set(&a->g, "low_x = %#.17g; high_x = %#.17g; low_z = %#.17g; high_z = %#.17g",
                middle - half, middle + half, z.low - margin, z.high + margin);
    gnuplot_arrays(&a->g, (size_t)a->frames, "centre base");
    for (int f = 0; f < a->frames; f++) {
        gnuplot_number(&a->g, a->follows ? a->figure[0][f].centre : 0, "centre[%d]", f + 1);
        gnuplot_number(&a->g, a->follows ? a->figure[0][f].base : 0, "base[%d]", f + 1);
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
    if (!plot_case_begin(c, &a.g, "animation", plot_animation_gp, "Stick figures"))
        return false;
    int cases = 0;
    for (const struct plot_case *k = c; k; k = k->other) {
        struct figure *const figure = gnuplot_room(&a.g, (size_t)a.frames, sizeof *figure);
        for (int f = 0; figure && f < a.frames; f++)
            figure_make(&figure[f], k, figure_row(k->t, f * step));
        a.figure[cases++] = figure;
    }
    const int contacts = figure_names(&a.g, c->scenario->scene);
    if (a.figure[0]) {
        put_view(&a, c);
        for (int k = 0; k < 4 && a.figure[k / 2]; k++) { /* each frame an index */
            gnuplot_block(&a.g, "%s%d", k % 2 == FIGURE_SEGMENTS ? "segments" : "points",
                          k / 2 + 1);
            for (int f = 0; f < a.frames; f++) {
                figure_put(&a.g, &a.figure[k / 2][f], contacts, (enum figure_part)(k % 2), 0, 0);
                gnuplot_gap(&a.g);
                gnuplot_gap(&a.g);
            }
        }
    }
    gnuplot_set(&a.g, "frames = %d; step = %.10g; fall = %#.17g; follows = %d; cases = %d",
                a.frames, step, figure_fall(c), a.follows, cases);
    return gnuplot_end(&a.g);
}
