/* plot_figure.c - a robot as a stick figure. */
#include "plot_case.h"

#include "engine/mechanism.h"

#include <math.h>

int plot_case_grounded(const stance_scene *scene)
{
    int count = 0;
    while (count < scene->contacts && scene->grip[count] >= 0)
        count++;
    return count;
}

size_t figure_row(const struct results_trajectory *t, double time)
{
    size_t row = 0;
    while (row + 1 < t->rows && t->time[row + 1] <= time + 1e-9)
        row++;
    return row;
}

double figure_fall(const struct plot_case *c)
{
    return tan(c->values.robot[STANCE_ROBOT_SLOPE]);
}

static bool is_outline(const struct plot_case *c)
{
    const stance_mechanism *const m = c->scenario.scene->mechanism;
    stance_mechanism_numbers number;
    bool round = m->carried && m->carried->outline;
    stance_mechanism_expand(m, c->values.robot, &number);
    for (int e = 0; e < m->elements; e++)
        round = round || number.element[e].radius > 0;
    return round;
}

void figure_make(struct figure *figure, const struct plot_case *c, size_t row)
{
    const stance_scene *scene = c->scenario.scene;
    const struct results_trajectory *t = c->t;
    const double *position = t->position + row * t->coordinates;
    const double rest[STANCE_MAX_COORDINATES] = {0};
    double speed[2];

    figure->time = t->time[row];
    figure->outline = is_outline(c);
    figure->points = scene->figure(scene, c->values.robot, position, figure->point);
    for (int k = 0; k < plot_case_grounded(scene); k++)
        scene->contact_point(scene, c->values.robot, position, rest, k, figure->contact[k], speed);
    figure->centre = 0;
    for (int p = 0; p < figure->points; p++)
        figure->centre += figure->point[p][0] / figure->points;
    figure->base = -figure_fall(c) * figure->centre;
}

int figure_names(struct gnuplot *g, const stance_scene *scene)
{
    const int contacts = plot_case_grounded(scene);
    gnuplot_set(g, "contacts = %d\narray contact_name[%d]", contacts, STANCE_MAX_CONTACTS);
    for (int k = 0; k < contacts; k++)
        gnuplot_text(g, scene->contact_name[k], "contact_name[%d]", k + 1);
    return contacts;
}

/* Contact that a point of the figure is, or -1. */
static int contact_at(const struct figure *figure, int contacts, int point)
{
    for (int k = 0; k < contacts; k++)
        if (hypot(figure->point[point][0] - figure->contact[k][0],
                  figure->point[point][1] - figure->contact[k][1]) < 1e-9)
            return k;
    return -1;
}

void figure_put(struct gnuplot *g, const struct figure *figure, int contacts, enum figure_part part,
                double dx, double dz)
{
    for (int p = 0; part == FIGURE_SEGMENTS && p + 1 < figure->points; p++) {
        /* In the colour of its contact; the body's also between two contacts. */
        const int first = contact_at(figure, contacts, p),
                  second = contact_at(figure, contacts, p + 1);
        const bool body = figure->outline || (first >= 0) == (second >= 0);
        const int contact = body ? contacts : first >= 0 ? first : second;
        for (int end = 0; end < 2; end++)
            GNUPLOT_ROW(g, figure->point[p + end][0] + dx, figure->point[p + end][1] + dz, contact);
        gnuplot_gap(g);
    }
    for (int p = 0; part == FIGURE_POINTS && p < figure->points && !figure->outline; p++)
        if (contact_at(figure, contacts, p) < 0)
            GNUPLOT_ROW(g, figure->point[p][0] + dx, figure->point[p][1] + dz, contacts);
    for (int k = 0; part == FIGURE_POINTS && k < contacts; k++)
        GNUPLOT_ROW(g, figure->contact[k][0] + dx, figure->contact[k][1] + dz, k);
}
