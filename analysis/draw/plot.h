/* plot.h - the pictures of `stance plot` and what they share: the scales of axes. */
#ifndef STANCE_DRAW_PLOT_H
#define STANCE_DRAW_PLOT_H

#include "gnuplot.h"

#include "analysis/statistics/statistics.h"
#include "runner/base/command.h"
#include "runner/store/results.h"

/* ---- axes --------------------------------------------------------------------------------- */

/* Cells along an axis from low to high: cell k stands at first + k * step. */
struct plot_axis {
    const struct results_axis *axis;
    enum plot_scale scale;
    bool falling; /* the values fall: cell k is value count - 1 - k */
    double first, step;
    struct plot_range range; /* to the outer edges of the first and the last cell */
};

void plot_axis_make(struct plot_axis *along, const struct results_axis *axis);
/* Logarithms count as even when none is further than a part of a cell from where it is drawn. */
void plot_axis_make_ladder(struct plot_axis *along, const struct results_axis *axis, double part);
/* For curves: numbers without an even spacing stand where they belong, not in a list. */
void plot_axis_make_curve(struct plot_axis *along, const struct results_axis *axis);
/* Where value i stands. */
double plot_axis_place(const struct plot_axis *along, size_t i);
/* All values from left to right, in the picture's memory; NULL: there is none. */
struct statistics_place *plot_axis_points(const struct plot_axis *along, struct gnuplot *g);
/* Value that cell k shows. */
size_t plot_axis_index(const struct plot_axis *along, size_t k);
/* Tells the script of the axis x or y, see gnuplot_axis, with the words of a list. Returns its
 * name. */
const char *plot_axis_write(const struct plot_axis *along, struct gnuplot *g, char which);
/* What an axis is called, x_text and x_path, with its unit, alone. */
void plot_label_write(const struct results_axis *axis, struct gnuplot *g, const char *which);

/* A map over two axes: cell (i, j) shows value first + i stride[0] + j stride[1] of an array. */
struct plot_cells {
    const struct plot_axis *across, *up;
    size_t first, stride[2];
};
/* The next series of a panel: numbers, doubles, drawn by the palette, or codes 0 ... 255, by that
 * array of colours of the script. gnuplot takes no image of one column or row: such a one is
 * written twice, to be drawn half as wide. */
void plot_cells_write(struct gnuplot *g, const struct plot_cells *cells, const void *values,
                      const char *colours);

/* ---- outcomes ----------------------------------------------------------------------------- */

/* Each adds to the line under the title: "What became of each of 65536 cases"; how many cases have
 * failed, where some have; by which faces of the box of starts the set of an outcome is cut, where
 * there are starts, and what that means for its share, where that is `shown`; RESULTS_KIND_COUNT:
 * of none. */
void plot_say_became(struct gnuplot *g);
void plot_say_failed(struct gnuplot *g);
void plot_say_cut(struct gnuplot *g, enum results_kind of, bool shown);
/* kind_colour[1 + enum results_kind], in the colours of the look; with `legend` an entry for each
 * kind that occurs, with its share of all cases. */
void plot_kinds_write(struct gnuplot *g, bool legend);

/* ---- answers ------------------------------------------------------------------------------ */

/* A number that every case has, to be drawn of the cases of one kind. */
struct plot_answer {
    const char *name, *unit, *text; /* as runner/store/store.h has them; unit "": none */
    enum results_kind of;           /* RESULTS_KIND_COUNT: all that are done */
};

/* The names of those that are numbers, NULL from the last on; the table's entry of a name. */
const char *plot_answer_word(size_t k);
bool plot_answer_find(const char *name, struct plot_answer *answer);
/* The numbers of all cases, NAN for other ones, to be freed, and their range; NULL with a message,
 * also when there are none. */
double *plot_answer_numbers(const struct plot *plot, const struct plot_answer *answer,
                            struct plot_range *range);
/* "friction_used: largest ratio |rT|/rN of a contact, of the stabilised cases" */
void plot_answer_text(const struct plot_answer *answer, char *text, size_t size);

/* ---- pictures ----------------------------------------------------------------------------- */

/* Each prints the paths that it writes. What cannot be drawn for good reason is said on standard
 * error; false is for failures, with one line in the plot's message. */

/* X(name, help): what `stance plot` draws of sweeps. plot_NAME draws nothing of a file that does
 * not call for it. */
#define PLOT_PICTURES(X)                                                                           \
    X(sample,                                                                                      \
      "  sweep.sample        NAME-sample: its points over the first two factors, coloured by\n"    \
      "                      outcome, and the share of good ends against each path varied\n")      \
    X(rays,                                                                                        \
      "  ... of rays         NAME-rays: where rays from the equilibrium lose the outcome, over\n"  \
      "                      two factors as a curve around it, over more the share of\n"           \
      "                      directions by scale\n")                                               \
    X(critical,                                                                                    \
      "  one refined axis    NAME-critical: up to where along it the outcome is kept, over one\n"  \
      "                      other axis as a curve, with what is kept again beyond, over two as\n" \
      "                      a map (stance critical -h)\n")                                        \
    X(maps,                                                                                        \
      "  two axes or more    NAME-map: the outcome of every case over the last two axes of\n"      \
      "                      numbers, one panel per point of the others; NAME-settle_time: when\n" \
      "                      it settled; not of samples\n")                                        \
    X(line, "  one axis            NAME-curve: outcome, times and friction used along it\n")       \
    X(shares,                                                                                      \
      "  a first axis that   NAME-curve: the shares of stabilised and rested cases against it,\n"  \
      "  is not an offset    with bands of their likely error (95 %); of starts on a grid the\n"   \
      "                      basin's volume, in a lighter band between what is inside for\n"       \
      "                      certain and what is not outside (stance basin -h)\n")
#define PLOT_PICTURE(name, help) bool plot_##name(const struct plot *plot);
PLOT_PICTURES(PLOT_PICTURE)
#undef PLOT_PICTURE

/* STEM-NAME of an answer: a map of sweeps over two axes or more, a curve of those over one. */
bool plot_answer_map(const struct plot *plot, const struct plot_answer *answer);
bool plot_answer_curve(const struct plot *plot, const struct plot_answer *answer);
/* STEM-outline of the first of several files: where each has an outcome, RESULTS_KIND_COUNT: the
 * one that is looked at. */
bool plot_outline(const struct plot *plots, int files, enum results_kind of);

#endif
