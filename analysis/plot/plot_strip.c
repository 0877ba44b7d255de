/* plot_strip.c - a case as a strip of stick figures, from left to right and row by row, in even
 * intervals of time. Both directions have the same scale. */
#include "plot_case.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
    MOST_FIGURES = 14,
    PER_ROW = 7,
    WIDTH = 1120,
    SIDE = 24,   /* px left and right */
    LEGEND = 36, /* px above the figures */
    TIMES = 30,  /* px under each row */
};

static const char body_colour[] = "#303030";

struct figure {
    double time;
    int points;
    double point[STANCE_MAX_POINTS][2];
    double contact[STANCE_MAX_CONTACTS][2];
    double centre; /* m, what stands in the middle of its place */
};

struct strip {
    const struct plot_case *c;
    int count, rows;
    struct figure figure[MOST_FIGURES];
    double spacing, low, high; /* m: between figures; heights shown */
    double scale;              /* px per m */
    double row_height;         /* px, figures alone */
    bool follows;              /* places move with the figures */
};

/* ---- figures ------------------------------------------------------------------------------ */

static void make_figure(const struct plot_case *c, size_t row, struct figure *figure)
{
    const stance_scene *scene = c->scenario.scene;
    const struct results_trajectory *t = c->t;
    const double *position = t->position + row * t->coordinates;
    const double rest[STANCE_MAX_COORDINATES] = {0};
    double speed[2];

    figure->time = t->time[row];
    figure->points = scene->figure(c->values.robot, position, figure->point);
    for (int k = 0; k < scene->contacts; k++)
        scene->contact_point(c->values.robot, position, rest, k, figure->contact[k], speed);
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

static void measure(struct strip *strip)
{
    double half = 0;
    strip->low = 0;
    strip->high = 1e-9;
    for (int i = 0; i < strip->count; i++) {
        for (int p = 0; p < strip->figure[i].points; p++) {
            strip->low = fmin(strip->low, strip->figure[i].point[p][1]);
            strip->high = fmax(strip->high, strip->figure[i].point[p][1]);
        }
    }
    centre_figures(strip);
    for (int i = 0; i < strip->count; i++)
        for (int p = 0; p < strip->figure[i].points; p++)
            half = fmax(half, fabs(strip->figure[i].point[p][0] - strip->figure[i].centre));
    double tall = strip->high - strip->low;
    strip->spacing = 2.1 * fmax(half, 0.1 * tall);
    strip->low -= 0.05 * tall;
    strip->high += 0.06 * tall;
    int across = strip->count < PER_ROW ? strip->count : PER_ROW;
    strip->rows = (strip->count + PER_ROW - 1) / PER_ROW;
    /* A lonely figure is not to fill a wall. */
    strip->scale =
        fmin((WIDTH - 2 * SIDE) / (across * strip->spacing), 320 / (strip->high - strip->low));
    strip->row_height = strip->scale * (strip->high - strip->low);
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
    for (int k = 0; k < strip->c->scenario.scene->contacts; k++)
        if (hypot(figure->point[point][0] - figure->contact[k][0],
                  figure->point[point][1] - figure->contact[k][1]) < 1e-9)
            return k;
    return -1;
}

/* Place of a point of figure i within its row, in m from the row's left end. */
static double across(const struct strip *strip, int i, double x)
{
    return (i % PER_ROW + 0.5) * strip->spacing + x - strip->figure[i].centre;
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

/* Segments of one row in the colour of contact `group` (last: the body); each a line of its own. */
static void put_segments(struct gnuplot *g, const struct strip *strip, int row, int group,
                         char name[32])
{
    int contacts = strip->c->scenario.scene->contacts;
    FILE *data = gnuplot_data(g, name);
    for (int i = row * PER_ROW; i < strip->count && i < (row + 1) * PER_ROW; i++) {
        const struct figure *figure = &strip->figure[i];
        for (int p = 0; p + 1 < figure->points; p++) {
            int contact = contact_of_segment(strip, figure, p);
            if ((contact < 0 ? contacts : contact) == group) {
                for (int end = p; end <= p + 1; end++) {
                    fprintf(data, "%.10g %.10g\n", across(strip, i, figure->point[end][0]),
                            figure->point[end][1]);
                }
                fputc('\n', data);
            }
        }
    }
    fputs("NaN NaN\n", data); /* never an empty file */
    gnuplot_close_data(g, data);
}

/* Contact points of one row (the body: the other points, but for an outline's corners). */
static void put_points(struct gnuplot *g, const struct strip *strip, int row, int group,
                       char name[32])
{
    int contacts = strip->c->scenario.scene->contacts;
    FILE *data = gnuplot_data(g, name);
    for (int i = row * PER_ROW; i < strip->count && i < (row + 1) * PER_ROW; i++) {
        const struct figure *figure = &strip->figure[i];
        for (int p = 0; p < figure->points; p++) {
            int contact = contact_at(strip, figure, p);
            if (contact == group || (contact < 0 && group == contacts && !is_outline(figure))) {
                fprintf(data, "%.10g %.10g\n", across(strip, i, figure->point[p][0]),
                        figure->point[p][1]);
            }
        }
    }
    fputs("NaN NaN\n", data);
    gnuplot_close_data(g, data);
}

static void draw_row(struct gnuplot *g, const struct strip *strip, int row, double top)
{
    int contacts = strip->c->scenario.scene->contacts;
    int figures = strip->count - row * PER_ROW < PER_ROW ? strip->count - row * PER_ROW : PER_ROW;
    double width = figures * strip->spacing;
    const char *separator = "plot ";

    gnuplot_panel(g, SIDE, top, strip->scale * width, strip->row_height);
    fprintf(g->script,
            "unset border; unset xtics; unset ytics; unset grid\n"
            "set xrange [0:%.10g]\nset yrange [%.10g:%.10g]\n"
            "set arrow 1 from first 0, first 0 to first %.10g, first 0 nohead lw 2"
            " lc rgb '#a0a0a0' back\n",
            width, strip->low, strip->high, width);
    for (int k = contacts; k >= 0; k--) {
        const char *colour = k < contacts ? plot_contact_colours[k] : body_colour;
        char lines[32], points[32];
        put_segments(g, strip, row, k, lines);
        put_points(g, strip, row, k, points);
        fprintf(g->script,
                "%s'%s' using 1:2 with lines lw 2.6 lc rgb '%s' notitle,"
                " '%s' using 1:2 with points pt 7 ps %g lc rgb '%s' notitle",
                separator, lines, colour, points, k < contacts ? 0.75 : 0.9, colour);
        separator = ", ";
    }
    fputs("\nunset arrow 1\n", g->script);
}

static void label_strip(struct gnuplot *g, const struct strip *strip, double top)
{
    const stance_scene *scene = strip->c->scenario.scene;
    double x = SIDE, y = top + 10, bar = plot_round_step(0, strip->spacing, 3);
    char text[80];

    for (int k = 0; k <= scene->contacts; k++) {
        const char *name = k < scene->contacts ? scene->contact_name[k] : "body";
        gnuplot_legend(g, x, y, k < scene->contacts ? plot_contact_colours[k] : body_colour, name);
        x += 50 + 8 * (double)strlen(name);
    }
    double length = bar * strip->scale;
    fprintf(g->script,
            "set arrow from screen %.6f,%.6f to screen %.6f,%.6f heads size screen 0.004,90 lw 1.4"
            " lc rgb '#404040'\n",
            x / g->width, 1 - y / g->height, (x + length) / g->width, 1 - y / g->height);
    snprintf(text, sizeof text, "%g m%s", bar,
             strip->follows ? "; each figure is centred: it travels" : "");
    gnuplot_label(g, x + length + 8, y, text, "left", 12, false);
    for (int i = 0; i < strip->count; i++) {
        double left = SIDE + strip->scale * strip->spacing * (i % PER_ROW + 0.5);
        const int row = i / PER_ROW;
        double under = top + LEGEND + (row + 1) * (strip->row_height + TIMES) - TIMES + 10;
        snprintf(text, sizeof text, "%.3g s", strip->figure[i].time);
        gnuplot_label(g, left, under, text, "center", 12, false);
    }
}

bool plot_strip(const struct plot_case *c, stance_message *message)
{
    struct gnuplot g;
    struct strip *strip = calloc(1, sizeof *strip);
    double top;
    if (!strip) {
        snprintf(message->text, sizeof message->text, "stance plot: not enough memory");
        return false;
    }
    strip->c = c;
    make_strip(strip);
    int below = LEGEND + strip->rows * (int)(strip->row_height + TIMES) + 8;
    if (!plot_case_begin(c, &g, "Stick figures", WIDTH, below, &top, message)) {
        free(strip);
        return false;
    }
    label_strip(&g, strip, top);
    gnuplot_decorate(&g);
    fputs("unset arrow\n", g.script);
    for (int row = 0; row < strip->rows; row++)
        draw_row(&g, strip, row, top + LEGEND + row * (strip->row_height + TIMES));
    free(strip);
    return plot_case_end(c, &g, "strip", message);
}
