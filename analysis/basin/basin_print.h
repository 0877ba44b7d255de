/* basin_print.h - a basin as text, JSON and CSV. Each returns false when memory or the output
 * fails. */
#ifndef STANCE_BASIN_BASIN_PRINT_H
#define STANCE_BASIN_BASIN_PRINT_H

#include "basin.h"

#include "analysis/statistics/statistics.h"

bool basin_print_text(const struct basin *basin);
bool basin_print_json(const struct basin *basin);
bool basin_print_csv(const struct basin *basin);
/* The points of the boundary as CSV. */
bool basin_print_boundary(const struct basin *basin);

/* Of the boundary of a row: number of starts minus alpha; NAN without it. */
double basin_dimension(const struct basin *basin, const struct basin_row *row);

#endif
