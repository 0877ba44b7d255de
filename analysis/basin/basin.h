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

enum basin_starts {
    BASIN_GRID,   /* start axes of numbers: volumes as basin_map.h has them */
    BASIN_SAMPLE, /* sampled starts: shares */
};

/* A row of the table. Of a sample, volumes come from the share and its interval (intervals.h):
 * `low` with every unknown case outside, `high` with all of them inside, `reach` half of that. */
struct basin_row {
    size_t point[SCENARIO_MAX_AXES]; /* of the axes that rows are made by; 0 elsewhere */
    uint64_t slices, cases, inside, failed, pending;
    uint64_t known;           /* grid: slices of which some case is known */
    double volume, low, high; /* mean of a slice (volume: of those known); NAN: nothing is known */
    double reach;             /* likely error of `volume` at the level asked for: over a sample of
                               * parameters with the scatter of its blocks; NAN: one block alone */
    uint64_t cells, crossed;  /* grid */
    struct basin_entropy entropy;
    struct basin_uncertainty uncertainty;
    bool has_distance; /* rows of one slice over offsets */
    struct basin_distance distance;
};

struct basin_choice {
    enum results_kind of;
    const char *const *by; /* paths that rows are made by; by_count 0: all parameters */
    size_t by_count;
    size_t side;  /* of the boxes of basin entropy */
    double level; /* of likely errors and intervals */
};

struct basin {
    const struct results *r;
    struct basin_choice choice;
    enum basin_starts starts;
    int start[SCENARIO_MAX_AXES], start_axes; /* axes of the file: of a grid those that vary, or
                                               * that of the sample */
    int by[SCENARIO_MAX_AXES], by_axes;
    double box;                 /* volume of the box of starts */
    char unit[256];             /* of volumes, "" without one */
    struct basin_sample sample; /* of starts; with BASIN_GRID unused */
    int averaged;               /* axis of a sample of parameters that is averaged over, or -1 */
    size_t rows;
    struct basin_row *row; /* [rows], row-major over by[] */
};

/* Takes over the file's sample. False: one line in *message. `*usage`: it is the request or the
 * file's kind that is at fault. Nothing is left allocated then. */
bool basin_make(struct basin *basin, const struct results *r, const struct basin_choice *choice,
                struct basin_sample *sample, bool *usage, stance_message *message);
void basin_free(struct basin *basin);
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
