/* basin_sample.h - starts that were sampled (sweep.sample) rather than laid out on a grid. */
#ifndef STANCE_BASIN_BASIN_SAMPLE_H
#define STANCE_BASIN_BASIN_SAMPLE_H

#include "runner/store/results.h"

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

/* Whether a point counts towards shares: of Saltelli's blocks only the first and the last points,
 * which are evenly distributed over the box; the others repeat their coordinates. */
bool basin_sample_counts(const struct basin_sample *sample, size_t point);

#endif
