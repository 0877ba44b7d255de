/* plot_points.h - the points of curves along an axis: the values of the axis from left to right. */
#ifndef STANCE_PLOT_PLOT_POINTS_H
#define STANCE_PLOT_PLOT_POINTS_H

#include "analysis/draw/plot.h"

struct plot_point {
    double place;
    size_t index; /* along the axis */
};

/* As many as the axis has values; freed by the caller, NULL with a message: no memory. */
struct plot_point *plot_points_make(const struct plot_axis *along, stance_message *message);

#endif
