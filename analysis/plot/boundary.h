/* boundary.h - the lines on a map between the cases that have an outcome and those that have not.
 *
 * Lines run between neighbours that differ, so that every case is on its own side; where on the way
 * from one neighbour to the other is free, and chosen such that the lines bend least: the sum of
 * squared differences of successive unit tangents is the smallest that a number of sweeps finds.
 */
#ifndef STANCE_PLOT_BOUNDARY_H
#define STANCE_PLOT_BOUNDARY_H

#include "engine/stance.h"

#include <stddef.h>
#include <stdint.h>

struct boundary_line {
    size_t first, count; /* among the points */
    bool closed;         /* else it ends at the map's edges */
};

struct boundary {
    double (*point)[2]; /* in units of the grid: (i, j) is the case in column i and row j */
    size_t points;
    struct boundary_line *line;
    size_t lines;
};

/* inside[ny][nx], 0 or 1; at least one column and row. False with a message: no memory. */
bool boundary_trace(struct boundary *b, const uint8_t *inside, size_t nx, size_t ny,
                    stance_message *message);
void boundary_free(struct boundary *b);

#endif
