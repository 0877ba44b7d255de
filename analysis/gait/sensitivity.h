/* sensitivity.h - what a number that differs from step to step does to a gait. */
#ifndef STANCE_GAIT_SENSITIVITY_H
#define STANCE_GAIT_SENSITIVITY_H

#include "along.h"

/* Standard deviations where a number of the scenario is drawn anew in each return, evenly between
 * two values: of the return's time and length, and of length by time. */
struct gait_sensitivity {
    double time, length, speed; /* s, m, m/s */
    double error; /* relative: largest difference between two widths, and the residual's part */
};

/* Of the number along->path between along->from and along->to, of a gait that holds, of a scenario
 * without a sweep. False, with a message, or said (empty): the scenario does not
 * admit a value, or nothing changes beyond the residual. */
bool gait_sensitivity_find(const struct scenario *s, const struct return_map *map,
                           const struct gait *gait, const struct along *along,
                           struct gait_sensitivity *sensitivity, stance_message *message);

#endif
