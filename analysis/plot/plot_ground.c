/* plot_ground.c - the ground that a case is drawn on: a line, or plates. */
#include "plot_case.h"

#include <math.h>
#include <stdlib.h>

void plot_ground_learn(struct plot_case *c)
{
    const struct results_trajectory *const t = c->t;
    if (!c->scenario || c->scenario->scene->mechanism->plates == 0 ||
        !(c->floor = calloc(1, sizeof *c->floor)))
        return;
    ground_case(c->scenario, &c->values, t->index, c->floor);
    struct plot_range range[2] = {PLOT_NOTHING, PLOT_NOTHING};
    static struct figure figure; /* large */
    figure.points =
        c->scenario->scene->figure(c->scenario->scene, c->values.robot, t->position, figure.point);
    figure_widen(range, &figure, 0, 0);
    c->reach = 0.5 * fmax(0, fmax(range[0].high - range[0].low, range[1].high - range[1].low));
    const struct ground_motion motion = {t->rows,     t->time,  t->position,
                                         t->velocity, t->force, t->gap};
    ground_pieces_find(c->floor, &motion, &c->pieces);
}

double plot_ground(struct gnuplot *g, const struct plot_case *c, double time, struct plot_range x,
                   double dx, double dz)
{
    static double point[PLOT_GROUND][2]; /* large */
    const double fall = figure_fall(c), along = hypot(1, fall);
    double lowest = INFINITY;
    size_t points = 2;
    for (int end = 0; end < 2; end++) {
        point[end][0] = end ? x.high : x.low;
        point[end][1] = -fall * point[end][0];
    }
    if (c->floor)
        points = ground_line(c->floor, &c->pieces, time, x.low * along, x.high * along, point,
                             PLOT_GROUND);
    for (size_t k = 0; k < points; k++) {
        lowest = fmin(lowest, point[k][1]);
        if (g)
            GNUPLOT_ROW(g, point[k][0] + dx, point[k][1] + dz, 0, time);
    }
    if (g)
        gnuplot_gap(g);
    return lowest;
}

double plot_ground_base(const struct plot_case *c, double time, double x)
{
    const double fall = figure_fall(c), along = hypot(1, fall), half = c->reach;
    const double height =
        c->floor ? ground_mean(c->floor, &c->pieces, time, (x - half) * along, (x + half) * along)
                 : 0;
    return height * along - fall * x;
}
