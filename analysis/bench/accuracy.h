/* accuracy.h - error against cost of methods and steps, from one results file.
 *
 * The file comes from a scenario whose first axis varies method.name together with method.step
 * (and method.tolerance); its other axes vary the start. The row that is taken for the truth is
 * the first one of `event-driven`. With trajectories recorded the errors are those of positions
 * and velocities; without them, those of the outcomes.
 */
#ifndef STANCE_BENCH_ACCURACY_H
#define STANCE_BENCH_ACCURACY_H

#include "analysis/draw/gnuplot.h"
#include "analysis/table/table.h"
#include "measure.h"

#include "runner/store/results.h"

/* One method, step and tolerance. */
struct accuracy_row {
    const stance_method *method;
    double step, tolerance;   /* s; as used, NAN where the method does not control its error */
    uint64_t cases, failed;   /* failed: of these cases, numerically */
    int failure;              /* enum stance_failure of the first of them */
    uint64_t compared;        /* cases compared with the truth */
    double position;          /* m, rad: largest difference at any recorded instant */
    double velocity;          /* m/s, rad/s: mean over time of the largest difference (L1) */
    uint64_t differ;          /* outcomes unlike the truth's ... */
    uint64_t inside;          /* ... in cells whose neighbours all have the truth's own outcome */
    struct bench_spread cost; /* microseconds of one core per simulated second */
    double time;              /* s, simulated in all cases together */
    double signorini, coulomb, dissipation, energy_gain; /* largest of the cases */
    double events, evaluations;                          /* per simulated second */
};

/* Order of convergence of a method: slope of log error over log step (or tolerance). */
struct accuracy_order {
    const stance_method *method;
    bool by_tolerance;
    size_t rows;               /* of the ladder that it was fitted on; below 2 there is no slope */
    double from, to;           /* ends of the ladder: s, or tolerance */
    double position, velocity; /* slopes; NAN: none */
};

enum { ACCURACY_METHODS = 16 };

struct accuracy {
    bool labels; /* outcomes are compared, not trajectories */
    size_t rows, truth;
    struct accuracy_row *row;
    size_t orders;
    struct accuracy_order order[ACCURACY_METHODS];
};

/* Whether its results would be of this kind. false: *message says why not. */
bool accuracy_fits(const struct scenario *s, stance_message *message);

/* Reads the answers and measures what every row costs, for about `budget` seconds each. False when
 * the file is not of this kind, or its truth failed altogether. */
bool accuracy_make(struct accuracy *a, const struct results *r, double budget,
                   stance_message *message);
void accuracy_free(struct accuracy *a);

/* For other cases than the file's: compares one with the truth's, into *row; and how many cases a
 * row has. */
void accuracy_trajectory(const struct results_trajectory *truth,
                         const struct results_trajectory *other, struct accuracy_row *row);
void accuracy_label(const struct accuracy *a, const struct results *r, size_t cell, uint8_t kind,
                    struct accuracy_row *row);
size_t accuracy_cases(const struct accuracy *a, const struct results *r);

/* The columns of a row's errors: of the reference itself, or of what was not compared, there are
 * none. */
void accuracy_errors(struct table *t, const struct accuracy_row *row, bool reference, bool labels);

/* STEM: error against cost, a line for each method. */
bool accuracy_plot(const struct accuracy *a, const struct plot *plot);
/* Its parts, for the lines of others than methods. Begins it; ranges, widened to all rows that are
 * drawn; the panels, with what they show. */
enum accuracy_shown { ACCURACY_POSITION, ACCURACY_VELOCITY, ACCURACY_LABELS, ACCURACY_SHOWN };
struct accuracy_ranges {
    struct plot_range cost, value[ACCURACY_SHOWN];
};
bool accuracy_picture(const struct accuracy *a, struct gnuplot *g, const struct plot *plot);
struct accuracy_ranges accuracy_ranges(void);
void accuracy_widen(struct accuracy_ranges *ranges, const struct accuracy_row *row);
void accuracy_panel(struct gnuplot *g, const struct accuracy_ranges *ranges,
                    enum accuracy_shown shown);
/* A point of a series in these styles: open where no cell is unlike, a cross where cases were given
 * up. */
void accuracy_point(struct gnuplot *g, const struct accuracy_row *row, enum accuracy_shown shown);
void accuracy_points(struct gnuplot *g, const char *hue, int mark, double size);

#endif
