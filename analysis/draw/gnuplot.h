/* gnuplot.h - a picture, drawn by gnuplot in the formats and sizes of a look.
 *
 * A picture is data: panels, axes, series of rows of numbers, a legend, notes. chart.gp lays it
 * out, one panel under the other or in a grid, with colours, sizes and tics of style.gp; both are
 * embedded in the program. In a scratch directory gnuplot loads style.gp, the data (variables, data
 * blocks) and chart.gp, so that no path of the user's enters a script; the finished files are
 * copied to where they belong. No text is
 * interpreted: see gnuplot_quote. STANCE_SCRIPTS=DIR in the environment keeps scripts and data in
 * DIR/STEM, where `gnuplot script` draws the picture anew.
 */
#ifndef STANCE_DRAW_GNUPLOT_H
#define STANCE_DRAW_GNUPLOT_H

#include "look.h"

#include "engine/stance.h"

/* What is drawn, how, and where the files go: DIRECTORY/STEM-<picture>.svg and .png, or as the look
 * has it. */
struct plot {
    const struct results *r; /* NULL: what is drawn is no results file */
    const char *title;       /* NULL: that of the results file */
    const char *directory, *stem;
    struct look *look;
    stance_message *message; /* takes one line of why something failed */
    bool allowed;            /* maps of starts show what linear theory allows any controller */
};

struct gnuplot {
    const struct plot *plot;
    struct gnuplot_room *room;
    FILE *data; /* variables and data blocks are appended here */
    char *text; /* so far, of `size` */
    size_t size;
    char axis[16];       /* the last one's name */
    char stem[520];      /* of the files */
    char scratch[256];   /* directory */
    char subtitle[2400]; /* the line under the title, so far */
    int panels, series;  /* so far */
    int files;           /* of cells so far */
    int rows;            /* of the data block that is open; -1: none is */
    int error;           /* errno of what failed first; 0: nothing has */
    bool missing;        /* there is something that could not be had; the message says why */
};

/* Makes the directory for pictures when it is missing. False, with the reason on standard error:
 * nothing can be written there. */
bool gnuplot_directory(const char *directory);

/* Begins a picture under the plot's title. False: no scratch directory. */
bool gnuplot_begin(struct gnuplot *g, const struct plot *plot, const char *name);
/* Where the look wants the picture, runs gnuplot, writes the look's file, or
 * DIRECTORY/STEM-NAME.svg, .png ..., and prints the paths. Ends the picture in any case. False: a
 * write failed, gnuplot is missing or complains, or something was missing; the files are as they
 * were. */
bool gnuplot_end(struct gnuplot *g);
/* Ends it without drawing it. */
void gnuplot_abandon(struct gnuplot *g);

/* ---- what the script is given; failures are kept for gnuplot_end ---------------------------- */

/* Memory, all zero, until the picture ends; NULL: there is none, and the picture fails. */
void *gnuplot_room(struct gnuplot *g, size_t count, size_t size);
/* The same of what others have made, which is freed then; NULL: they had none. */
void *gnuplot_keep(struct gnuplot *g, void *piece);
/* What the picture cannot do without; where it is not had, the message says why. Returns `had`. */
bool gnuplot_needs(struct gnuplot *g, bool had);

/* Adds to the line under the title. */
void gnuplot_say(struct gnuplot *g, const char *format, ...) __attribute__((format(printf, 2, 3)));
/* A line, as printf makes it; free texts only through gnuplot_text. */
void gnuplot_set(struct gnuplot *g, const char *format, ...) __attribute__((format(printf, 2, 3)));
/* Arrays of that size, of all the names. */
void gnuplot_arrays(struct gnuplot *g, size_t size, const char *names);
/* NAME = 'text' and NAME = value (NAN: NaN); the name as printf makes it. */
void gnuplot_text(struct gnuplot *g, const char *text, const char *name, ...)
    __attribute__((format(printf, 3, 4)));
void gnuplot_number(struct gnuplot *g, double value, const char *name, ...)
    __attribute__((format(printf, 3, 4)));
/* A row of numbers of the last series, NAN for a gap. */
void gnuplot_row(struct gnuplot *g, const double *values, size_t count);
#define GNUPLOT_ROW(g, ...)                                                                        \
    gnuplot_row((g), (const double[]){__VA_ARGS__},                                                \
                sizeof((const double[]){__VA_ARGS__}) / sizeof(double))
/* What follows in the block is apart from what was before. */
void gnuplot_gap(struct gnuplot *g);
/* A straight line, apart from what follows. */
void gnuplot_segment(struct gnuplot *g, double x, double y, double x_end, double y_end);
/* The next binary file: cells1, cells2 ... */
void gnuplot_cells(struct gnuplot *g, const void *cells, size_t size);

/* ---- charts ------------------------------------------------------------------------------- */

enum plot_scale {
    PLOT_LINEAR, /* places are the values */
    PLOT_LOG,    /* places are their decimal logarithms */
    PLOT_LIST,   /* places are 0, 1, 2 ...: words, and numbers without an even spacing */
};

/* A range that grows; ... from nothing. */
struct plot_range {
    double low, high;
};
#define PLOT_NOTHING ((struct plot_range){INFINITY, -INFINITY})
/* Widens it to a value; what is not finite is passed over. */
void plot_widen(struct plot_range *range, double value);
/* The range of values[n], those that are finite; false: there are none. */
bool plot_range_of(struct plot_range *range, const double *values, size_t n);
/* With that part of its width as room at both ends; of one value half of 1. */
struct plot_range plot_roomy(struct plot_range range, double part);

/* Tells the script of the axis x or y of all panels or, once there are panels, of the last one: its
 * name beside a unit ("": none), its scale, the places at its ends. Returns what its variables
 * begin with, x or y3, until the next one. */
const char *gnuplot_axis(struct gnuplot *g, char which, enum plot_scale scale,
                         struct plot_range range, const char *name, const char *unit);
/* A further word of the last axis, a list, and where it stands. */
enum { GNUPLOT_MOST_WORDS = 1200 };
void gnuplot_word(struct gnuplot *g, double place, const char *text);
/* The next panel of a chart, of this height in px as long as the page has no other, under a heading
 * ("": none): how panels stand is said in variables of style.gp, columns, chart_width ... */
void gnuplot_panel(struct gnuplot *g, double height, const char *heading);
/* What is drawn in it next, as gnuplot's `plot` has it: "using 1:2 with lines"; its rows follow, up
 * to the next of anything else. One without rows is given one of NANs: to gnuplot none at all would
 * be an error. */
void gnuplot_series(struct gnuplot *g, const char *style, ...)
    __attribute__((format(printf, 2, 3)));

/* An entry of the legend: a line of a type of dashes and a point of a type, 0: none, or where both
 * are none a box, of a colour (a variable of style.gp), beside a name and what is said of it, ""
 * for nothing; and a line under all of them. */
void gnuplot_legend(struct gnuplot *g, const char *colour, int dash, int point, const char *name,
                    const char *more);
/* A further line under the last entry. */
void gnuplot_about(struct gnuplot *g, const char *format, ...)
    __attribute__((format(printf, 2, 3)));
void gnuplot_note(struct gnuplot *g, const char *format, ...) __attribute__((format(printf, 2, 3)));
/* The colour of curve k = 0, 1 ... beside others. */
const char *gnuplot_hue(size_t k);
/* The type of its points, filled; one less is the open one. */
int gnuplot_mark(size_t k);
/* The size of points of which there are n. */
double gnuplot_dot(size_t n);
/* A cross over all that was drawn: where the equilibrium is. */
void gnuplot_cross(struct gnuplot *g, double x, double y);
/* The colour of a kind of case, as style.gp has it: "#rrggbb", or "" of one that it does not name.
 */
void gnuplot_kind_colour(const char *kind, char colour[8]);
/* Gives a colour of style.gp the value that the look has for a name, if it has. */
void gnuplot_colour(struct gnuplot *g, const char *colour, const char *name);

/* Writes `text` as a string literal: nothing in it is expanded, substituted or formatted, control
 * characters become blanks, bytes that are not UTF-8 '?'. */
void gnuplot_quote(FILE *out, const char *text);

#endif
