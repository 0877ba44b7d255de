/* margins.h - what a gait costs, and how far it is from what would end it. */
#ifndef STANCE_GAIT_MARGINS_H
#define STANCE_GAIT_MARGINS_H

#include "return_map.h"

struct gait_margins {
    double cost; /* the answer cost_of_transport; NAN: nothing is actuated, or it has more than 4
                    steps */
    double impact_friction; /* the answer */
    double lift; /* m/s, at which the foot that stood leaves the ground after the footfall; 0: it
                  * stays there */
    /* m, of the other foot in the first step, at the ends of time steps: its height where it is
     * ahead, at most; its depth before that, at most, 0: it is above the ground. */
    double clearance, under;
    /* Of outputs that follow the robot: their phase in the first step as a polynomial of the time,
     * and how far it is off, at most; else NAN. */
    double clock[STANCE_MAX_COEFFICIENTS], clock_off;
    double least_normal_force; /* N, of the foot that stands, the least mean over a time step */
};

/* Lets the gait walk once more. False, with a message: out of memory, or it falls. */
bool gait_margins_find(const struct return_map *map, const struct gait *gait,
                       struct gait_margins *margins, stance_message *message);

#endif
