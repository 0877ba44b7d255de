/* gnuplot.h - a picture, drawn by gnuplot in the formats and sizes of a look.
 *
 * What a picture looks like stands in a script NAME.gp beside the NAME.c that hands it the data,
 * and what pictures share in style.gp, legend.gp, page.gp and panels.gp here; all are embedded in
 * the program. In a scratch directory gnuplot loads style.gp, the data (variables, data blocks),
 * legend.gp and the script, so that no path of the user's enters a script; the finished files are
 * copied to where they belong. No text is interpreted: see gnuplot_quote. STANCE_SCRIPTS=DIR in the
 * environment keeps scripts and data in DIR/STEM, where `gnuplot script` draws the picture anew.
 */
#ifndef STANCE_DRAW_GNUPLOT_H
#define STANCE_DRAW_GNUPLOT_H

#include "look.h"

#include "engine/stance.h"

/* Embeds a file of the tree as the constant string `symbol`; the Makefile has objects made anew
 * when the .gp of their name changes. */
#define GNUPLOT_SCRIPT(symbol, path)                                                               \
    __asm__(".pushsection .rodata\n" #symbol ":\n.incbin \"" path "\"\n.byte 0\n.popsection\n");   \
    extern const char symbol[] __attribute__((visibility("hidden")))

struct gnuplot {
    struct look *look;
    char scratch[256]; /* directory */
    FILE *data;        /* variables and data blocks are appended here */
    FILE *sink;        /* takes what has no file */
    int files;         /* of cells so far */
    bool failed;       /* a write failed */
    int error;         /* errno of that */
};

/* Makes the directory for pictures when it is missing. False, with the reason on standard error:
 * nothing can be written there. */
bool gnuplot_directory(const char *directory);

/* Begins a picture that the script `picture` draws, with `title` and `subtitle`; look NULL: as it
 * comes, for pictures without options. False: no scratch directory; nothing is left behind. */
bool gnuplot_begin(struct gnuplot *g, struct look *look, const char *picture, const char *title,
                   const char *subtitle, stance_message *message);
/* Where the look wants the picture, runs gnuplot, writes the look's file, or DIRECTORY/STEM.svg,
 * .png ..., and prints the paths. Ends the picture in any case. False: a write failed, gnuplot is
 * missing or complains; the files are as they were. */
bool gnuplot_end(struct gnuplot *g, const char *directory, const char *stem,
                 stance_message *message);
/* Ends a picture without drawing it. */
void gnuplot_abandon(struct gnuplot *g);

/* ---- what the script is given; failures are kept for gnuplot_end ---------------------------- */

/* A line, as printf makes it; free texts only through gnuplot_text. */
void gnuplot_set(struct gnuplot *g, const char *format, ...) __attribute__((format(printf, 2, 3)));
/* Arrays of that size, of all the names. */
void gnuplot_arrays(struct gnuplot *g, int size, const char *names);
/* NAME = 'text' and NAME = value (NAN: NaN); the name as printf makes it. */
void gnuplot_text(struct gnuplot *g, const char *text, const char *name, ...)
    __attribute__((format(printf, 3, 4)));
void gnuplot_number(struct gnuplot *g, double value, const char *name, ...)
    __attribute__((format(printf, 3, 4)));
/* $NAME << EOD; rows of numbers follow, NAN for a gap, then gnuplot_end_block. */
void gnuplot_block(struct gnuplot *g, const char *name, ...) __attribute__((format(printf, 2, 3)));
void gnuplot_row(struct gnuplot *g, const double *values, size_t count);
#define GNUPLOT_ROW(g, ...)                                                                        \
    gnuplot_row((g), (const double[]){__VA_ARGS__},                                                \
                sizeof((const double[]){__VA_ARGS__}) / sizeof(double))
void gnuplot_end_block(struct gnuplot *g);
/* The next binary file: cells1, cells2 ... Never NULL. */
FILE *gnuplot_cells(struct gnuplot *g);
void gnuplot_close_cells(struct gnuplot *g, FILE *file);

/* An entry of the legend: a line of a type of dashes and a point of a type, 0: none, or where both
 * are none a box, of a colour (a variable of style.gp), beside a name and what is said of it, ""
 * for nothing; and a line under all of them. */
void gnuplot_legend_mark(struct gnuplot *g, const char *colour, int dash, int point,
                         const char *name, const char *more);
static inline void gnuplot_legend(struct gnuplot *g, const char *colour, const char *name,
                                  const char *more)
{
    gnuplot_legend_mark(g, colour, 0, 0, name, more);
}
/* The colour of a kind of case, as style.gp has it: "#rrggbb", or "" of one that it does not name.
 */
void gnuplot_kind_colour(const char *kind, char colour[8]);

/* Gives a colour of style.gp the value that the look has for a name, if it has. */
void gnuplot_colour(struct gnuplot *g, const char *colour, const char *name);
void gnuplot_note(struct gnuplot *g, const char *text);

/* Writes `text` as a string literal: nothing in it is expanded, substituted or formatted, control
 * characters become blanks, bytes that are not UTF-8 '?'. */
void gnuplot_quote(FILE *out, const char *text);

#endif
