/* basin_print.h - basins and rays as text, JSON and CSV. Each returns false when memory or the
 * output fails. */
#ifndef STANCE_BASIN_BASIN_PRINT_H
#define STANCE_BASIN_BASIN_PRINT_H

#include "basin.h"
#include "basin_rays.h"

#include "analysis/table/table.h"

enum { BASIN_SHOWN = 40 }; /* rows that people see */

bool basin_print(const struct basin *basin, enum table_form form);
bool basin_rays_print(const struct basin_rays *rays, enum table_form form);
/* The points of the boundary, every ray, as CSV. */
bool basin_print_boundary(const struct basin *basin);
bool basin_rays_print_boundary(const struct basin_rays *rays);

/* What both say of their starts: a line without its end; a line, `otherwise` without a range. */
void basin_print_axis(const struct results_axis *axis);
void basin_print_factor(const struct basin_factor *factor, const char *otherwise);
/* A list of their names. NULL: no memory. */
json_t *basin_factor_names(const struct basin_sample *sample);

#endif
