/* plot_strip.c - a case as a strip of stick figures, from left to right and row by row, in even
 * intervals of time. Both directions have the same scale. */
#include "plot_case.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

GNUPLOT_SCRIPT(plot_strip_gp, "analysis/plot/plot_strip.gp");

enum { MOST_FIGURES = 14 };

struct figure {
    double time;
    int points;
    double point[STANCE_MAX_POINTS][2];
    double contact[STANCE_MAX_CONTACTS][2];
    double centre; /* m, what stands in the middle of its place */
    double base;   /* m, height of the ground below it */
};

struct strip {
    const struct plot_case *c;
    int count, contacts;
    struct figure figure[MOST_FIGURES];
    double fall;               /* of the ground along x: a slope's tangent */
    double spacing, low, high; /* m: between figures; heights shown */
    bool follows;              /* places move with the figures */
};

int plot_case_grounded(const stance_scene *scene)
{
    int count = 0;
    while (count < scene->contacts && !(scene->grip && scene->grip[count] < 0))
        count++;
    return count;
}

/* ---- figures ------------------------------------------------------------------------------ */

static void make_figure(const struct plot_case *c, size_t row, struct figure *figure)
{
    const stance_scene *scene = c->scenario.scene;
    const struct results_trajectory *t = c->t;
    const double *position = t->position + row * t->coordinates;
    const double rest[STANCE_MAX_COORDINATES] = {0};
    double speed[2];

    figure->time = t->time[row];
    figure->points = scene->figure(scene, c->values.robot, position, figure->point);
    for (int k = 0; k < plot_case_grounded(scene); k++)
        scene->contact_point(scene, c->values.robot, position, rest, k, figure->contact[k], speed);
    figure->centre = 0;
    for (int p = 0; p < figure->points; p++)
        figure->centre += figure->point[p][0] / figure->points;
}

/* Places stay put unless the figures travel further than they are tall. */
static void centre_figures(struct strip *strip)
{
    double low = INFINITY, high = -INFINITY;
    for (int i = 0; i < strip->count; i++) {
        low = fmin(low, strip->figure[i].centre);
        high = fmax(high, strip->figure[i].centre);
    }
    strip->follows = high - low > strip->high - strip->low;
    for (int i = 0; i < strip->count && !strip->follows; i++)
        strip->figure[i].centre = 0.5 * (low + high);
}

/* Heights count from the ground below a figure's centre. */
static void measure_heights(struct strip *strip)
{
    strip->low = 0;
    strip->high = 1e-9;
    for (int i = 0; i < strip->count; i++) {
        struct figure *const figure = &strip->figure[i];
        figure->base = -strip->fall * figure->centre;
        for (int p = 0; p < figure->points; p++) {
            strip->low = fmin(strip->low, figure->point[p][1] - figure->base);
            strip->high = fmax(strip->high, figure->point[p][1] - figure->base);
        }
    }
}

static void measure(struct strip *strip)
{
    double half = 0;
    measure_heights(strip);
    centre_figures(strip);
    measure_heights(strip);
    for (int i = 0; i < strip->count; i++)
        for (int p = 0; p < strip->figure[i].points; p++)
            half = fmax(half, fabs(strip->figure[i].point[p][0] - strip->figure[i].centre));
    double tall = strip->high - strip->low;
    strip->spacing = 2.1 * fmax(half, 0.1 * tall);
    strip->low = fmin(strip->low, -0.5 * fabs(strip->fall) * strip->spacing) - 0.05 * tall;
    strip->high += 0.06 * tall;
}

static void make_strip(struct strip *strip)
{
    const struct results_trajectory *t = strip->c->t;
    strip->count = t->rows < MOST_FIGURES ? (int)t->rows : MOST_FIGURES;
    for (int i = 0; i < strip->count; i++) {
        size_t row = strip->count > 1 ? (size_t)i * (t->rows - 1) / (size_t)(strip->count - 1) : 0;
        make_figure(strip->c, row, &strip->figure[i]);
    }
    measure(strip);
}

/* ---- drawing ------------------------------------------------------------------------------ */

/* Contact that a point of the figure is, or -1. */
static int contact_at(const struct strip *strip, const struct figure *figure, int point)
{
    for (int k = 0; k < strip->contacts; k++)
        if (hypot(figure->point[point][0] - figure->contact[k][0],
                  figure->point[point][1] - figure->contact[k][1]) < 1e-9)
            return k;
    return -1;
}

/* A line that ends where it begins is an outline: its corners are no joints, its sides belong to
 * the body. */
static bool is_outline(const struct figure *figure)
{
    const double *first = figure->point[0], *last = figure->point[figure->points - 1];
    return figure->points > 1 && hypot(first[0] - last[0], first[1] - last[1]) < 1e-9;
}

/* Contact whose colour a segment has, or -1: the body's, as between two contacts. */
static int contact_of_segment(const struct strip *strip, const struct figure *figure, int p)
{
    int first = contact_at(strip, figure, p), second = contact_at(strip, figure, p + 1);
    return is_outline(figure) || (first >= 0 && second >= 0) ? -1 : first >= 0 ? first : second;
}

/* A point of figure i in the script's plane, in which the figures stand `spacing` apart, and the
 * contact whose colour it has, the number of contacts: the body's. */
static void put_point(struct gnuplot *g, const struct strip *strip, int i, const double point[2],
                      int contact)
{
    const struct figure *figure = &strip->figure[i];
    GNUPLOT_ROW(g, (i + 0.5) * strip->spacing + point[0] - figure->centre, point[1] - figure->base,
                contact < 0 ? strip->contacts : contact);
}

/* Each segment is a line of its own; joints and contacts are points, corners of outlines are not.
 */
static void put_figures(struct gnuplot *g, const struct strip *strip)
{
    gnuplot_block(g, "ground");
    for (int i = 0; i < strip->count; i++) {
        for (int end = 0; end < 2; end++)
            GNUPLOT_ROW(g, (i + end) * strip->spacing, (0.5 - end) * strip->fall * strip->spacing);
        gnuplot_set(g, "%s", "");
    }
    gnuplot_end_block(g);
    gnuplot_block(g, "segments");
    for (int i = 0; i < strip->count; i++) {
        const struct figure *figure = &strip->figure[i];
        for (int p = 0; p + 1 < figure->points; p++) {
            const int contact = contact_of_segment(strip, figure, p);
            put_point(g, strip, i, figure->point[p], contact);
            put_point(g, strip, i, figure->point[p + 1], contact);
            gnuplot_set(g, "%s", "");
        }
    }
    gnuplot_end_block(g);
    gnuplot_block(g, "points");
    for (int i = 0; i < strip->count; i++) {
        const struct figure *figure = &strip->figure[i];
        for (int p = 0; p < figure->points && !is_outline(figure); p++)
            if (contact_at(strip, figure, p) < 0)
                put_point(g, strip, i, figure->point[p], -1);
        for (int k = 0; k < strip->contacts; k++)
            put_point(g, strip, i, figure->contact[k], k);
    }
    gnuplot_end_block(g);
}

bool plot_strip(const struct plot_case *c, stance_message *message)
{
    const stance_scene *scene = c->scenario.scene;
    struct gnuplot g;
    struct strip *strip = calloc(1, sizeof *strip);
    if (!strip) {
        snprintf(message->text, sizeof message->text, "stance plot: not enough memory");
        return false;
    }
    strip->c = c;
    strip->contacts = plot_case_grounded(scene);
    strip->fall = scene->mechanism ? tan(c->values.robot[STANCE_ROBOT_SLOPE]) : 0;
    make_strip(strip);
    const bool good = plot_case_begin(c, &g, plot_strip_gp, "Stick figures", message);
    if (good) {
        gnuplot_set(&g, "count = %d; spacing = %#.17g; low = %#.17g; high = %#.17g; travels = %d",
                    strip->count, strip->spacing, strip->low, strip->high, strip->follows);
        gnuplot_set(&g, "contacts = %d\narray contact_name[%d]\narray time[%d]", strip->contacts,
                    STANCE_MAX_CONTACTS, strip->count);
        for (int k = 0; k < strip->contacts; k++)
            gnuplot_text(&g, scene->contact_name[k], "contact_name[%d]", k + 1);
        for (int i = 0; i < strip->count; i++)
            gnuplot_number(&g, strip->figure[i].time, "time[%d]", i + 1);
        put_figures(&g, strip);
    }
    free(strip);
    return good && plot_end(c->plot, &g, "strip", message);
}
