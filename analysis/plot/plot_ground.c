/* plot_ground.c - the ground that a case is drawn on: a line, or plates. */
#include "plot_case.h"

#include <math.h>
#include <stdlib.h>

/* Of the stick figure at first, upwards or across. */
static double size_of(const struct plot_case *c)
{
    struct plot_range x = PLOT_NOTHING, z = PLOT_NOTHING;
    double point[STANCE_MAX_POINTS][2];
    const int points =
        c->scenario->scene->figure(c->scenario->scene, c->values.robot, c->t->position, point);
    for (int p = 0; p < points; p++) {
        plot_widen(&x, point[p][0]);
        plot_widen(&z, point[p][1]);
    }
    return points > 0 ? fmax(x.high - x.low, z.high - z.low) : 0;
}

void plot_ground_learn(struct plot_case *c)
{
    const struct results_trajectory *const t = c->t;
    if (!c->scenario || c->scenario->scene->mechanism->plates == 0 ||
        !(c->floor = calloc(1, sizeof *c->floor)))
        return;
    ground_case(c->scenario, &c->values, t->index, c->floor);
    c->reach = 0.5 * size_of(c);
    const struct ground_motion motion = {t->rows,     t->time,  t->position,
                                         t->velocity, t->force, t->gap};
    ground_pieces_find(c->floor, &motion, &c->pieces);
}

size_t plot_ground(const struct plot_case *c, double time, double low, double high,
                   double (*point)[2])
{
    const double fall = figure_fall(c), along = hypot(1, fall);
    if (c->floor)
        return ground_line(c->floor, &c->pieces, time, low * along, high * along, point,
                           PLOT_GROUND);
    for (int end = 0; end < 2; end++) {
        point[end][0] = end ? high : low;
        point[end][1] = -fall * point[end][0];
    }
    return 2;
}

double plot_ground_base(const struct plot_case *c, double time, double x)
{
    const double fall = figure_fall(c), along = hypot(1, fall), half = c->reach;
    const double height =
        c->floor ? ground_mean(c->floor, &c->pieces, time, (x - half) * along, (x + half) * along)
                 : 0;
    return height * along - fall * x;
}
