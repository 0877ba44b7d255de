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
#include "basin_sample.h"

#include "analysis/statistics/faces.h"

enum basin_starts {
    BASIN_GRID,   /* start axes of numbers: volumes as basin_map.h has them */
    BASIN_SAMPLE, /* sampled starts: shares */
};

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
    enum basin_starts starts;
    int start[SCENARIO_MAX_AXES], start_axes; /* axes of the file: of a grid those that vary, or
                                               * that of the sample */
    int by[SCENARIO_MAX_AXES], by_axes;
    bool around;                      /* the equilibrium is in the box, and known to be at zero */
    double weight[SCENARIO_MAX_AXES]; /* of the starts, see basin_starts */
    struct faces faces;               /* of the box */
    double box;                       /* volume of the box of starts */
    char unit[256];                   /* of volumes, "" without one */
    struct basin_sample sample;       /* of starts; with BASIN_GRID unused */
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

/* Calls visit for every pair of neighbouring starts whose outcomes differ, in every slice; `first`
 * is the slice's point of all axes of the file, 0 along those of the starts. Stops, and returns
 * false, when visit does or memory fails. Grids only. */
struct basin_slice {
    const struct basin *basin;
    size_t point[SCENARIO_MAX_AXES];
    struct basin_map map;
};
bool basin_boundary(const struct basin *basin,
                    bool (*visit)(void *context, const struct basin_slice *slice,
                                  const struct basin_crossing *crossing),
                    void *context);

#endif
