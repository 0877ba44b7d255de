/* failure.h - where methods fail, from one results file: a verdict on every cell of a map.
 *
 * The file comes from a scenario whose first axis varies method.name (and method.tolerance) and
 * whose other two axes are the map. The truth of a cell is event-driven's answer, and where
 * event-driven gave up that of the most exact row of capturing; where the map varies method.step,
 * both at the smallest step.
 */
#ifndef STANCE_BENCH_FAILURE_H
#define STANCE_BENCH_FAILURE_H

#include "analysis/draw/gnuplot.h"
#include "runner/store/results.h"

/* Worst first; a cell gets the first that applies. */
#define FAILURE_VERDICTS(X)                                                                        \
    X(GAVE_UP, gave_up, "gave up", "#000000")                                                      \
    X(RAN_AWAY, ran_away, "ran away", "#d55e00")                                                   \
    X(BROKE_LAW, broke_law, "broke a contact law", "#cc79a7")                                      \
    X(OUTCOME, wrong_outcome, "wrong outcome", "#e69f00")                                          \
    X(INACCURATE, inaccurate, "right outcome, inaccurate", "#f0e442")                              \
    X(UNJUDGED, unjudged, "kept the laws, no reference", "#c8c8c8")                                \
    X(RIGHT_OTHER, right_other, "right: fell, or still moves", "#9fd4f5")                          \
    X(RIGHT_STANDS, right_stands, "right: came to stand or rest", "#0072b2")

enum failure_verdict {
#define FAILURE_VERDICT_ENUM(NAME, name, text, colour) FAILURE_##NAME,
    FAILURE_VERDICTS(FAILURE_VERDICT_ENUM)
#undef FAILURE_VERDICT_ENUM
        FAILURE_VERDICT_COUNT,
};

/* Name in JSON, text in legends, "#rrggbb". */
struct failure_style {
    const char *name, *text, *colour;
};
extern const struct failure_style failure_styles[FAILURE_VERDICT_COUNT];

/* What verdicts rest on, and their bounds, 0: none: answers, m, m/s or of the friction coefficient,
 * and the energy gained as a share of that at the start, kinetic and potential above z = 0, but at
 * least 1 mJ. */
#define FAILURE_LARGEST(X)                                                                         \
    X(GAIN, energy_gain, 0)                                                                        \
    X(SHARE, energy_share, 1.0)                                                                    \
    X(PENETRATION, max_penetration, 1e-6)                                                          \
    X(SIGNORINI, signorini_residual, 1e-6)                                                         \
    X(COULOMB, coulomb_residual, 1e-6)                                                             \
    X(DISSIPATION, dissipation_residual, 1e-6)

enum {
#define FAILURE_MEASURE(NAME, name, bound) FAILURE_##NAME,
    FAILURE_LARGEST(FAILURE_MEASURE)
#undef FAILURE_MEASURE
        FAILURE_MEASURES
};
#define FAILURE_POSITION 1e-2 /* m, rad: largest error of a coordinate at the end */

/* One method (and tolerance): a map. */
struct failure_row {
    const stance_method *method;
    double tolerance; /* as used, NAN where the method does not control its error */
    uint64_t count[FAILURE_VERDICT_COUNT];
    uint64_t reason[STANCE_FAILURE_COUNT]; /* of the cases that failed */
    double largest[FAILURE_MEASURES];      /* of the cases that are done */
    /* On both sides of the theory's line: cases, of these gave up or ran away, came to stand. */
    uint64_t side[2], bad[2], stands[2];
};

/* What theory says of a map: a critical value of one axis for every point of the other. */
struct failure_line {
    int axis;      /* of the points: 1 or 2; 0: there is no line */
    double *value; /* [points] on the other axis; NAN, INFINITY: none */
    char text[120];
};

struct failure {
    size_t rows, cells; /* maps, cells of a map */
    size_t count[3];    /* points of the axes 0, 1, 2 */
    struct failure_row *row;
    uint8_t *verdict; /* [rows][cells] enum failure_verdict, row-major over axes 1 and 2 */
    double *share;    /* [rows][cells] energy gained, of that at the start; NAN: failed */
    int8_t *truth;    /* [cells] row that the truth comes from; -1: there is none */
    struct failure_line line;
};

/* Whether its results would be of this kind. false: *message says why not. */
bool failure_fits(const struct scenario *s, stance_message *message);

/* Reads the answers and judges them. False when the file is not of this kind. */
bool failure_make(struct failure *f, const struct results *r, stance_message *message);
void failure_free(struct failure *f);

/* "capturing 1e-08". Returns text. */
const char *failure_row_name(const struct failure_row *row, char text[40]);

/* The line of theory that goes with a scenario, *line zero where none is known:
 * - axes method.step and controller.kp of a robot that begins in free flight with its joints held
 *   by a servo that acts continuously: |R(h lambda)| = 1 of the classical Runge-Kutta formula;
 * - axis controller.sample_time of a state feedback: T*, where Ad(T) - Bd(T) K leaves the unit
 *   circle;
 * - axis ground.friction where a contact begins sliding: where no single contact force fits the
 *   accelerations (Painleve). */
bool failure_theory(struct failure_line *line, const struct scenario *s, stance_message *message);

/* STEM: a map for each row. STEM-energy: the energy gained. */
bool failure_plot(const struct failure *f, const struct plot *plot);

#endif
