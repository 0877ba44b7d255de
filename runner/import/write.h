/* write.h - the robot of the plane as a scenario that explains itself. */
#ifndef RUNNER_IMPORT_WRITE_H
#define RUNNER_IMPORT_WRITE_H

#include "plane.h"

#include <stdio.h>

/* Where what was read came from, and all notes, stand in comments at its head. Numbers read back as
 * they were, but for the rounding (of 1e-15) that hides a short one. */
void import_write(FILE *out, const struct spatial_model *model, const struct plane_robot *robot);

#endif
