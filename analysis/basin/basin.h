/* basin.h - the basin of an outcome in a results file, as a function of what else is varied.
 *
 * Axes initial.offset.* and initial.state.* are starts; so is the dimension `sample` where every
 * some factor is one. Every other axis is a parameter. A slice is a map over the starts at one
 * point of the parameters; a row is the slices that agree in the parameters that rows are made by,
 * averaged.
 */
#ifndef STANCE_BASIN_BASIN_H
#define STANCE_BASIN_BASIN_H

#include "basin_map.h"

#include "analysis/statistics/faces.h"

/* ---- starts that were sampled (sweep.sample) rather than laid out on a grid ----------------- */

/* One varied number of the starts. */
struct basin_factor {
    const struct results_axis *of; /* name, unit, value[points] */
    double from, to;               /* of its range; NAN where it has none of its own */
};

struct basin_sample {
    int axis; /* of the file; -1: it has no sample of starts */
    enum doe_method method;
    size_t points, block;
    size_t factors;              /* of the starts: initial.offset.*, initial.state.* */
    struct basin_factor *factor; /* [factors] */
    double box;                  /* volume of the ranges; NAN where there is none */
    bool others;                 /* the sample varies more than starts */
};

/* What the file's sample says of starts; points into *r. False: its scenario cannot be read, or
 * there is no memory. */
bool basin_sample_make(struct basin_sample *sample, const struct results *r,
                       stance_message *message);
void basin_sample_free(struct basin_sample *sample);

/* ---- the study ------------------------------------------------------------------------------ */

/* A row of the table. Of a sample, volumes come from the share and its interval (intervals.h):
 * `low` with every unknown case outside, `high` with all of them inside, `reach` the longer side.
 */
struct basin_row {
    size_t point[SCENARIO_MAX_AXES]; /* of the axes that rows are made by; 0 elsewhere */
    uint64_t slices, cases, inside, failed, pending;
    uint64_t known;           /* grid: slices of which some case is known */
    double volume, low, high; /* mean of a slice (volume: of those known); NAN: nothing is known */
    double reach;             /* likely error of `volume` at the level asked for: over a sample of
                               * parameters with the scatter of its blocks; NAN: one block alone */
    double resolution; /* grid: so many standard deviations of what the grid of starts accounts
                        * for, which errors of sums are made of: not kept within the bounds */
    uint64_t cells, crossed;    /* grid */
    face_set cut;               /* faces of the box on which cases have the outcome */
    struct {                    /* grid: what hangs together with the equilibrium, as above */
        uint64_t inside, known; /* slices in whose part the equilibrium lies; where that is known */
        double volume, low, high, reach;
        face_set faces; /* that it reaches in some slice */
        bool unknown;   /* in some slice a neighbour of it is not known */
    } part;
    struct basin_entropy entropy;
    struct basin_uncertainty uncertainty;
    /* Rows of one slice, where the box has the equilibrium in it. Of sampled starts alone `nearest`
     * is known, of the points of the sample, and an upper bound. */
    bool has_distance;
    struct basin_distance distance;
};

enum { BASIN_WEIGHTS = SCENARIO_MAX_AXES };
struct basin_weight {
    char path[96];
    double size; /* > 0, in the path's unit */
};

struct basin_choice {
    enum results_kind of;
    const char *const *by; /* paths that rows are made by; by_count 0: all parameters */
    size_t by_count;
    size_t rank; /* of a sample of parameters the points of so many largest volumes are rows, the
                  * largest first; 0: their mean */
    const char *within; /* "settle_time <= 2": what else the starts are asked for, which the
                         * file's kinds have in them; NULL: nothing */
    size_t side;        /* of the boxes of basin entropy */
    double level;       /* of likely errors and intervals */
    struct basin_weight weight[BASIN_WEIGHTS]; /* of distances; of other starts 1 of its unit */
    size_t weights;
};

struct basin {
    const struct results *r;
    struct basin_choice choice;
    bool sampled; /* the starts, of which there are shares; else they are a grid, whose volumes are
                   * as basin_map.h has them */
    int start[SCENARIO_MAX_AXES], start_axes; /* axes of the file: of a grid those that vary, or
                                               * that of the sample */
    int by[SCENARIO_MAX_AXES], by_axes;
    bool around;                      /* the equilibrium is in the box, and known to be at zero */
    double weight[SCENARIO_MAX_AXES]; /* of the starts, see basin_starts */
    struct faces faces;               /* of the box */
    double box;                       /* volume of the box of starts */
    char unit[256];                   /* of volumes, "" without one */
    struct basin_sample sample;       /* of starts, if `sampled` */
    int averaged; /* axis of a sample of parameters that is averaged over, or -1 */
    size_t rows;
    struct basin_row *row; /* [rows], row-major over by[] */
    size_t draws;          /* of a sample: its blocks, of starts its points; else 0 */
    double *drawn;         /* [rows][draws]: the volume of each alone; NAN: none is known */
};

/* "; did you mean 'initial.offset.pole'?" where a word is the end of one path of the file's axes
 * and sample; else "". */
const char *basin_meant(const struct results *r, const char *word, char text[128]);

/* Takes over the file's sample. False: one line in *message. `*usage`: it is the request or the
 * file's kind that is at fault. Nothing is left allocated then. */
bool basin_make(struct basin *basin, const struct results *r, const struct basin_choice *choice,
                struct basin_sample *sample, bool *usage, stance_message *message);
void basin_free(struct basin *basin);
/* How many coordinates starts have, and which: axes of the grid, or what is sampled. */
size_t basin_starts(const struct basin *basin);
const struct results_axis *basin_start(const struct basin *basin, size_t k);
/* The row that a point of the axes belongs to. */
size_t basin_row_of(const struct basin *basin, const size_t *point);
/* The paths of parameters that rows are averaged over, in paths[most]; how many there are. */
size_t basin_averaged(const struct basin *basin, const char **paths, size_t most);

/* ---- where along a parameter a basin has lost some share of what it was ----------------------
 *
 * Along the parameter, from its first value to its last, the volume V is taken as linear between
 * neighbouring values, and the threshold is crossed where D = V - T V_first changes its sign first.
 * The interval holds all values at which D is not known to differ from zero (Fieller's way: E. C.
 * Fieller, J. R. Stat. Soc. B 16, 1954). D is linear in the volumes of at most three rows, whose
 * errors count as independent on a grid of starts; of a sample, all of whose points are in every
 * row, its error is that of the mean of D over the points, by Student's distribution. Between two
 * values nothing is known of how V runs: the interval is one of the crossing of the straight line,
 * `before` and `after` are the values between which it is.
 */
struct basin_threshold {
    double first, last; /* volumes */
    bool crossed;
    size_t before, after; /* points of the axis; after = before where it is not crossed */
    double at;            /* of the parameter; NAN: not crossed */
    double low, high;     /* in the order in which the parameter runs; NAN: beyond its last value */
};

/* Of the row `row`, whose point of by[along] is the first one, and of those that follow it along
 * this axis, whose values rise or fall. threshold > 0, not 1; below 1 the volume falls below it,
 * above 1 it rises above it. */
struct basin_threshold basin_threshold(const struct basin *basin, size_t row, int along,
                                       double threshold);

/* How starts are lost along an axis of parameters: those that have the outcome at the one end of
 * the axis where more have it. */
struct basin_loss {
    bool down;        /* from the axis's last point to its first */
    uint64_t starts;  /* that have it there */
    uint64_t *lost;   /* [count], in the order of the walk: first seen without it there */
    size_t at;        /* place in the walk where the first ones are lost; count: none are */
    uint64_t first;   /* flat index of one of them, as it is there */
    uint64_t unknown; /* starts that come to a failed or pending case before */
};
/* From the last point of the axis (down) or its first; lost[] is freed by the caller. False: no
 * memory. */
bool basin_lose(const struct results *r, int axis, bool down, enum results_kind of,
                struct basin_loss *loss);
/* Whether more cases have the outcome at the last point of the axis than at its first. */
bool basin_more_at_last(const struct results *r, int axis, enum results_kind of);

#endif
