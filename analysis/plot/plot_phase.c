/* plot_phase.c - each angle of a walk against its rate, where a gait is a closed curve. */
#include "plot_case.h"

#include "runner/base/message.h"

#include <math.h>
#include <string.h>

enum { MOST_ROWS = 4000 };

/* Row `i` of the exchange as a sum of coordinates, "leg1 + leg2"; *same: it is a coordinate alone,
 * which is returned; -1: it is not, or with another sign. */
static int counterpart(const stance_scene *scene, int i, char *name, size_t size)
{
    const double *const row = scene->exchange.coordinate[i];
    int terms = 0, last = -1;
    for (int k = 0; k < scene->coordinates; k++) {
        if (row[k] == 0)
            continue;
        add_text(name, size, "%s", row[k] < 0 ? terms ? " - " : "-" : terms ? " + " : "");
        if (fabs(row[k]) != 1)
            add_text(name, size, "%.4g ", fabs(row[k]));
        add_text(name, size, "%s", scene->coordinate[k].name);
        terms++;
        last = k;
    }
    return terms == 1 && row[last] == 1 ? last : -1;
}

/* Coordinate i of a state, an angle or a rate, or (`other`) as the first leg reads the other one's.
 */
static double read(const struct plot_case *c, const double *x, int i, bool other)
{
    double sum = 0;
    for (size_t k = 0; k < c->t->coordinates && other; k++)
        sum += c->scenario->scene->exchange.coordinate[i][k] * x[k];
    return other ? sum : x[i];
}

/* A curve of the last panel. */
struct curve {
    struct gnuplot *g;
    const struct plot_case *c;
    int coordinate;
    bool other;
    struct plot_range *range; /* [2] */
};

/* Angle and rate of a row. */
static void phase_of(const struct curve *curve, size_t row, double at[2])
{
    const struct results_trajectory *const t = curve->c->t;
    const double *const x[] = {t->position + row * t->coordinates,
                               t->velocity + row * t->coordinates};
    for (int k = 0; k < 2; k++)
        at[k] = read(curve->c, x[k], curve->coordinate, curve->other);
}

/* Where a row `from`, and the one before or behind it, lead at an instant. */
static void extend(const struct curve *curve, size_t from, bool back, double instant, double at[2])
{
    const struct results_trajectory *const t = curve->c->t;
    const size_t next = back ? from + 1 : from - 1;
    const bool bends =
        back ? next < t->rows && walk_hit(t, next) < 0 : from > 0 && walk_hit(t, from) < 0;
    const double d = instant - t->time[from];
    double beside[2];
    phase_of(curve, from, at);
    if (bends)
        phase_of(curve, next, beside);
    const double slope = bends ? (at[1] - beside[1]) / (t->time[from] - t->time[next]) : 0;
    at[0] += d * (at[1] + 0.5 * d * slope);
    at[1] += d * slope;
}

static void put(const struct curve *curve, const double at[2])
{
    for (int k = 0; k < 2; k++)
        plot_widen(&curve->range[k], at[k]);
    gnuplot_row(curve->g, at, 2);
}

/* The state just after the footfall with which a file's only case ended. */
static bool final_state(const struct plot_case *c, double state[2 * STANCE_MAX_COORDINATES])
{
    const size_t count = 2 * c->t->coordinates;
    return c->plot->r->single && c->values.footfalls > 0 &&
           results_numbers(c->plot->r, "final_state", state, count) == count;
}

/* What lies between impacts as a line; (`jumps`) from where it led before one to where it goes on
 * behind it. */
static void put_curve(const struct curve *curve, bool jumps)
{
    const struct results_trajectory *const t = curve->c->t;
    const size_t every = 1 + t->rows / MOST_ROWS;
    double at[2], state[2 * STANCE_MAX_COORDINATES];
    for (size_t row = 0; row < t->rows; row++) {
        const int contact = walk_hit(t, row);
        for (int back = 0; back < 2 && contact >= 0; back++) {
            if (back && !jumps)
                gnuplot_gap(curve->g);
            extend(curve, row - !back, back, walk_landed(t, row, (size_t)contact), at);
            put(curve, at);
        }
        if (contact >= 0 && jumps)
            gnuplot_gap(curve->g);
        phase_of(curve, row, at);
        if (!jumps && (row % every == 0 || row + 1 == t->rows))
            put(curve, at);
    }
    if (!final_state(curve->c, state))
        return;
    extend(curve, t->rows - 1, false, walk_end(curve->c), at);
    put(curve, at);
    for (int k = 0; k < 2; k++)
        at[k] = read(curve->c, state + (size_t)k * t->coordinates, curve->coordinate, curve->other);
    if (jumps)
        put(curve, at);
}

static void put_curves(const struct curve *curve, const char *colour, int dash)
{
    double at[2];
    for (int jumps = 0; jumps < 2; jumps++) {
        gnuplot_series(curve->g, "using 1:2 with lines dt %d lw %g lc rgb %s", jumps ? 3 : dash,
                       jumps ? 1.4 : 1.7, colour);
        put_curve(curve, jumps);
    }
    gnuplot_series(curve->g, "using 1:2 with points pt 7 ps 0.9 lc rgb %s", colour);
    phase_of(curve, 0, at);
    put(curve, at);
}

static void put_phase(struct gnuplot *g, const struct plot_case *c, int i, char legend[3][200])
{
    const stance_scene *const scene = c->scenario->scene;
    const stance_quantity *const q = &scene->coordinate[i];
    char name[200] = "", unit[60];
    struct plot_range range[2] = {PLOT_NOTHING, PLOT_NOTHING};
    const int twin = counterpart(scene, i, name, sizeof name);
    const bool own = twin == i || strncmp(name, "-", 1) == 0;
    const int legs = own ? 1 : 2;
    if (twin >= 0 && twin < i)
        return; /* it has been drawn with the other one */
    gnuplot_panel(g, 300, "");
    for (int leg = 0; leg < legs && c->other; leg++)
        put_curves(&(struct curve){g, c->other, i, leg > 0, range}, "0xb8b8b8", leg ? 2 : 1);
    for (int leg = 0; leg < legs; leg++)
        put_curves(&(struct curve){g, c, i, leg > 0, range},
                   own ? "hue[3]" : gnuplot_hue((size_t)leg), leg ? 2 : 1);
    for (int leg = 0; leg < legs; leg++) {
        char *const of = legend[own ? 2 : leg];
        add_text(of, 200, "%s%s", of[0] ? ", " : "", leg ? name : q->name);
    }
    char both[260];
    snprintf(both, sizeof both, legs == 2 ? "%s, %s" : "%s", q->name, name);
    gnuplot_axis(g, 'x', PLOT_LINEAR, plot_roomy(range[0], 0.06), both, q->unit);
    snprintf(unit, sizeof unit, "%s/s", q->unit);
    gnuplot_axis(g, 'y', PLOT_LINEAR, plot_roomy(range[1], 0.06), "rate", unit);
}

bool plot_phase(const struct plot_case *c)
{
    static double time[WALK_FOOTFALLS];
    struct gnuplot g;
    char legend[3][200] = {"", "", ""};
    if (walk_footfalls(c, time) < 2)
        return true;
    if (!plot_case_begin(c, &g, "phase", "Angles against their rates"))
        return false;
    for (int j = 0; j < c->scenario->scene->postures; j++)
        put_phase(&g, c, c->scenario->scene->posture[j], legend);
    for (int k = 0; k < 3; k++)
        if (legend[k][0])
            gnuplot_legend(&g, gnuplot_hue((size_t)k), k == 1 ? 2 : 1, 0, legend[k], "");
    const int panels = g.panels, columns = panels == 4 ? 2 : panels < 4 ? panels : 3;
    gnuplot_set(&g, "columns = %d; chart_width = 330; scaled = 1", columns);
    gnuplot_note(&g, "dot: the start; dotted: jump at an impact%s",
                 c->other ? "; grey: the second case" : "");
    return gnuplot_end(&g);
}
