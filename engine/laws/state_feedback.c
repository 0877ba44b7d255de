/* state_feedback.c - torques about an equilibrium: its own, less gains times what is off it. Where
 * the gains come from is the design's affair (engine/control); what acts is the linear law. */
#include "engine/stance.h"

const stance_law stance_law_state_feedback = {
    .name = "state-feedback",
    .text = "torque = equilibrium torque - gains times the deviation of angles and rates from an "
            "equilibrium",
    .designed = true,
};
