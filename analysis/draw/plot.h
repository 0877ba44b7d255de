/* plot.h - the pictures of `stance plot` and what they share: colours and the scales of axes. */
#ifndef STANCE_DRAW_PLOT_H
#define STANCE_DRAW_PLOT_H

#include "gnuplot.h"

#include "runner/store/results.h"

/* What is drawn and where the files go: DIRECTORY/STEM-<picture>.svg and .png. */
struct plot {
    const struct results *r;
    const char *directory, *stem;
};

/* Colour of a kind of case, "#rrggbb"; after Okabe and Ito (2008), so that readers who do not tell
 * red from green tell these apart: blue hues stand for standing, orange for falling. */
extern const char *const plot_colours[RESULTS_KIND_COUNT];
#define PLOT_ACCENT "#0072b2"
#define PLOT_SECOND "#d55e00"
#define PLOT_GREY "#8a8a8a"

/* ---- axes --------------------------------------------------------------------------------- */

enum plot_scale {
    PLOT_LINEAR, /* places are the values */
    PLOT_LOG,    /* places are their decimal logarithms */
    PLOT_LIST,   /* places are 0, 1, 2 ...: words, and numbers without an even spacing */
};

/* Cells along an axis from low to high: cell k stands at first + k * step. */
struct plot_axis {
    const struct results_axis *axis;
    enum plot_scale scale;
    bool falling; /* the values fall: cell k is value count - 1 - k */
    double first, step;
    double low, high; /* outer edges of the first and the last cell */
};

void plot_axis_make(struct plot_axis *along, const struct results_axis *axis);
/* For curves: numbers without an even spacing stand where they belong, not in a list. */
void plot_axis_make_curve(struct plot_axis *along, const struct results_axis *axis);
/* Where value i stands. */
double plot_axis_place(const struct plot_axis *along, size_t i);
/* Value that cell k shows. */
size_t plot_axis_index(const struct plot_axis *along, size_t k);
/* Range and labelled tics, at most `tics` of them; `which` is 'x' or 'y'; labels false: bare. */
void plot_axis_tics(const struct plot_axis *along, FILE *script, char which, int tics, bool labels);
/* Long name, and under it path and unit, cut to `length` pixels, centred at (x, y). */
void plot_axis_label(const struct results_axis *axis, struct gnuplot *g, double x, double y,
                     double length, bool turned);
/* A round number such that at most `tics` multiples lie between low and high. */
double plot_round_step(double low, double high, int tics);
/* "set ytics ..." of round numbers for a panel of that height, in pixels. */
void plot_value_tics(FILE *script, double low, double high, double height);

/* ---- legends ------------------------------------------------------------------------------ */

/* Adds to a subtitle how many cases have failed, where some have. */
void plot_failed_text(const struct results *r, char *text, size_t size);
/* One entry per kind of case that occurs, with its share of all cases; returns the height. */
double plot_kind_legend(const struct plot *plot, struct gnuplot *g, double x, double y);

/* ---- answers ------------------------------------------------------------------------------ */

/* A number that every case has, to be drawn of the cases of one kind. */
struct plot_answer {
    const char *name, *unit, *text; /* as runner/store/store.h has them; unit "": none */
    enum results_kind of;           /* RESULTS_KIND_COUNT: all that are done */
};

/* The table's entry of a name; false when it is none, or no number. */
bool plot_answer_find(const char *name, struct plot_answer *answer);
/* "a, b, c": the names that plot_answer_find knows. */
void plot_answer_list(char *text, size_t size);
/* The numbers, NAN for other cases, and their range; values[cases] are freed by the caller. False,
 * with a message, also when there are none. */
bool plot_answer_numbers(const struct plot *plot, const struct plot_answer *answer, double **values,
                         double *low, double *high, stance_message *message);
/* "friction_used: largest ratio |rT|/rN of a contact, of the stabilised cases" */
void plot_answer_title(const struct plot_answer *answer, char *text, size_t size);

/* ---- pictures ----------------------------------------------------------------------------- */

/* Each prints the paths that it writes. What cannot be drawn for good reason is said on standard
 * error; false is for failures, with one line in *message. */

/* STEM-map and STEM-settle_time, of sweeps over two or more axes. */
bool plot_maps(const struct plot *plot, stance_message *message);
/* STEM-curve of sweeps over one axis, and of those whose first axis is not an offset: the share of
 * stabilised cases against it. */
bool plot_curve(const struct plot *plot, stance_message *message);
/* STEM-sample of a file with a sample: its points and what became of them, and shares against each
 * path that it varies. */
bool plot_sample(const struct plot *plot, stance_message *message);
/* STEM-rays of files of rays (basin_rays.h); of others nothing. */
bool plot_rays(const struct plot *plot, stance_message *message);
/* STEM-NAME of an answer: a map of sweeps over two axes or more, a curve of those over one. */
bool plot_answer_map(const struct plot *plot, const struct plot_answer *answer,
                     stance_message *message);
bool plot_answer_curve(const struct plot *plot, const struct plot_answer *answer,
                       stance_message *message);
/* STEM-coordinates, -forces, -torques, -gaps and -strip of the case at a place among the recorded
 * ones. */
bool plot_case(const struct plot *plot, size_t place, uint64_t index, stance_message *message);

#endif
