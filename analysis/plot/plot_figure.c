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

/* Of a disc that a contact is; 0: it is none. */
static double radius_of(const stance_mechanism *m, const stance_mechanism_numbers *number,
                        int contact)
{
    stance_contact_place at;
    stance_mechanism_contact(m, contact, &at);
    return m->element[at.element].sole ? 0 : number->element[at.element].radius;
}

/* Which contact's each point is: its own; of a robot with two legs also its disc's rim and centre,
 * so that a leg has the colour of its foot. Of other outlines none is. */
static void find_feet(struct figure *figure, const struct plot_case *c)
{
    const stance_scene *const scene = c->scenario->scene;
    stance_mechanism_numbers number;
    double sine, cosine;
    stance_mechanism_expand(scene->mechanism, c->values.robot, &number);
    stance_sincos(c->values.robot[STANCE_ROBOT_SLOPE], &sine, &cosine);
    for (int p = 0; p < figure->points; p++)
        figure->foot[p] = -1, figure->upper[p] = false;
    for (int k = plot_case_grounded(scene); k-- > 0;) {
        const double r = radius_of(scene->mechanism, &number, k);
        double below[2] = {0, 0}; /* where the rim begins, from the centre */
        for (int p = 0; p < figure->points && (scene->exchange.any || !figure->outline); p++) {
            const double x = figure->point[p][0] - figure->contact[k][0] - r * sine,
                         z = figure->point[p][1] - figure->contact[k][1] - r * cosine;
            const bool rim = fabs(hypot(x, z) - r) < 1e-9;
            if (!rim && hypot(x, z) > 1e-9)
                continue;
            figure->foot[p] = k;
            if (rim && below[0] == 0 && below[1] == 0)
                below[0] = x, below[1] = z;
            figure->upper[p] = rim && r > 0 && x * below[0] + z * below[1] < 0.4 * r * r;
        }
    }
}

/* Of legs that are alike, what turns with the joints of one of them is of its first foot. */
static void find_legs(struct figure *figure, const struct plot_case *c, const double *position)
{
    const stance_scene *const scene = c->scenario->scene;
    const stance_exchange *const e = &scene->exchange;
    for (int leg = 0; leg < 2 && e->any; leg++) {
        double bent[STANCE_MAX_COORDINATES] = {0}, point[STANCE_MAX_POINTS][2];
        for (int i = 0; i < scene->coordinates; i++) {
            bent[i] = position[i];
            for (int k = 0; k < scene->coordinates; k++)
                if (e->coordinate[i][k] == 1 && (leg ? k < i : k > i))
                    bent[i] += 1e-3;
        }
        scene->figure(scene, c->values.robot, bent, point);
        for (int p = 0; p < figure->points; p++)
            if (figure->foot[p] < 0 &&
                hypot(point[p][0] - figure->point[p][0], point[p][1] - figure->point[p][1]) > 1e-9)
                figure->foot[p] = __builtin_ctz(e->leg[leg]);
    }
}

void figure_make(struct figure *figure, const struct plot_case *c, size_t row)
{
    const stance_scene *scene = c->scenario->scene;
    const struct results_trajectory *t = c->t;
    const double *position = t->position + row * t->coordinates;
    const double rest[STANCE_MAX_COORDINATES] = {0};
    const stance_mechanism *const m = scene->mechanism;
    stance_mechanism_numbers number;
    double speed[2];

    figure->time = t->time[row];
    figure->outline = m->carried && m->carried->outline;
    stance_mechanism_expand(m, c->values.robot, &number);
    for (int e = 0; e < m->elements; e++)
        figure->outline = figure->outline || number.element[e].radius > 0;
    figure->points = scene->figure(scene, c->values.robot, position, figure->point);
    for (int k = 0; k < plot_case_grounded(scene); k++)
        scene->contact_point(scene, c->values.robot, position, rest, k, figure->contact[k], speed);
    find_feet(figure, c);
    find_legs(figure, c, position);
    figure->centre = 0;
    for (int p = 0; p < figure->points; p++)
        figure->centre += figure->point[p][0] / figure->points;
    figure->base = plot_ground_base(c, figure->time, figure->centre);
}

int figure_colours(struct gnuplot *g, const stance_scene *scene)
{
    const int contacts = plot_case_grounded(scene);
    gnuplot_set(g, "figure_colour(k) = k < %d ? hue[int(k)%%|hue|+1] : 0x303030", contacts);
    return contacts;
}

void figure_legend(struct gnuplot *g, const struct plot_case *c)
{
    const stance_scene *const scene = c->scenario->scene;
    for (int k = 0; k < plot_case_grounded(scene); k++)
        gnuplot_legend(g, gnuplot_hue((size_t)k), 0, 0, scene->contact_name[k], "");
    gnuplot_legend(g, "0x303030", 0, 0, "body", "");
    if (c->other)
        gnuplot_legend(g, "0xb8b8b8", 0, 0, "the second case", "");
}

/* Whether a point of the figure is a contact. */
static bool is_contact(const struct figure *figure, int contacts, int point)
{
    for (int k = 0; k < contacts; k++)
        if (hypot(figure->point[point][0] - figure->contact[k][0],
                  figure->point[point][1] - figure->contact[k][1]) < 1e-9)
            return true;
    return false;
}

void figure_widen(struct plot_range range[2], const struct figure *figure, double x, double z)
{
    for (int p = 0; p < figure->points; p++) {
        plot_widen(&range[0], figure->point[p][0] - x);
        plot_widen(&range[1], figure->point[p][1] - z);
    }
}

void figure_put(struct gnuplot *g, const struct figure *figure, int contacts, enum figure_part part,
                double dx, double dz)
{
    for (int p = 0; part == FIGURE_SEGMENTS && p + 1 < figure->points; p++) {
        /* In the colour of its leg; the body's also between two contacts. */
        const int first = figure->foot[p], second = figure->foot[p + 1];
        const bool alike = first == second && !(is_contact(figure, contacts, p) &&
                                                is_contact(figure, contacts, p + 1));
        const bool body = !alike && (first >= 0) == (second >= 0);
        const int contact = body ? contacts : first >= 0 ? first : second >= 0 ? second : contacts;
        if (figure->open && (figure->upper[p] || figure->upper[p + 1]))
            continue;
        for (int end = 0; end < 2; end++)
            GNUPLOT_ROW(g, figure->point[p + end][0] + dx, figure->point[p + end][1] + dz, contact,
                        figure->time);
        gnuplot_gap(g);
    }
    for (int p = 0; part == FIGURE_POINTS && p < figure->points && !figure->outline; p++)
        if (!is_contact(figure, contacts, p))
            GNUPLOT_ROW(g, figure->point[p][0] + dx, figure->point[p][1] + dz,
                        figure->foot[p] < 0 ? contacts : figure->foot[p], figure->time);
    for (int k = 0; part == FIGURE_POINTS && k < contacts; k++)
        GNUPLOT_ROW(g, figure->contact[k][0] + dx, figure->contact[k][1] + dz, k, figure->time);
}
