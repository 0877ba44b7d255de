/* gnuplot.h - a picture, drawn by gnuplot as SVG and PNG.
 *
 * A picture is a canvas of width x height pixels (of the SVG; the PNG is finer) with title, legend
 * and panels at places given in pixels from its upper left corner. The script and its data live in
 * a scratch directory in which gnuplot runs, so that no path of the user's enters a script; the
 * finished files are then copied to where they belong. No text is interpreted: see gnuplot_text.
 */
#ifndef STANCE_DRAW_GNUPLOT_H
#define STANCE_DRAW_GNUPLOT_H

#include "engine/stance.h"

#include <stdio.h>

struct gnuplot {
    char scratch[256]; /* directory */
    FILE *script;      /* commands are appended here */
    FILE *sink;        /* takes data whose file cannot be made */
    int width, height; /* px */
    int files;         /* data files so far */
    bool failed;       /* a write failed */
    int error;         /* errno of that */
};

/* Makes the directory for pictures when it is missing. False, with the reason on standard error:
 * nothing can be written there. */
bool gnuplot_directory(const char *directory);

/* Begins a picture. False: no scratch directory; nothing is left behind. */
bool gnuplot_begin(struct gnuplot *g, int width, int height, stance_message *message);
/* Runs gnuplot, writes DIRECTORY/STEM.svg and .png and prints both paths. Ends the picture in any
 * case. False: a write failed, gnuplot is missing or complains; the files are as they were. */
bool gnuplot_end(struct gnuplot *g, const char *directory, const char *stem,
                 stance_message *message);
/* Ends a picture without drawing it. */
void gnuplot_abandon(struct gnuplot *g);

/* Opens a new data file, to be closed with gnuplot_close_data; its name in the script goes to
 * `name`. Never NULL: when it cannot be made, writes go nowhere and gnuplot_end reports it. */
FILE *gnuplot_data(struct gnuplot *g, char name[32]);
void gnuplot_close_data(struct gnuplot *g, FILE *file);
/* A number, for data files and scripts; NAN is a gap. */
void gnuplot_number(FILE *out, double value);

/* Writes `text` as a string literal: nothing in it is expanded, substituted or formatted, bytes
 * that are not UTF-8 become '?', and it is broken into lines at blanks where it is longer than
 * `columns` (0: never). Returns the number of lines; `out` NULL: only that. */
int gnuplot_text(FILE *out, const char *text, int columns);

/* ---- parts of the canvas, all in pixels --------------------------------------------------- */

/* Title and a smaller line under it, both wrapped to the width of the canvas. */
void gnuplot_title(struct gnuplot *g, const char *title, const char *subtitle);
/* The height that they take on a canvas of that width. */
int gnuplot_title_height(int width, const char *title, const char *subtitle);
/* A line of text; align is "left", "center" or "right"; turned: bottom to top. */
void gnuplot_label(struct gnuplot *g, double x, double y, const char *text, const char *align,
                   int size, bool turned);
/* A filled rectangle with a text right of it, as legends have. */
void gnuplot_legend(struct gnuplot *g, double x, double y, const char *colour, const char *text);
/* Draws title, labels and legends given so far, under everything that follows. */
void gnuplot_decorate(struct gnuplot *g);
/* Where the axes of the next plot stand. */
void gnuplot_panel(struct gnuplot *g, double left, double top, double width, double height);

#endif
