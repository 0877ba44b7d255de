/* hold.c - a servo in each joint that has an actuator: torque = -kp (angle - target) - kd rate. */
#include "engine/stance.h"

#include <math.h>

enum { KP, KD, TARGET, PARAMETERS };

static const stance_parameter parameters[PARAMETERS] = {
    [KP] = {{"kp", "N m/rad", "stiffness of the servo", NAN, 0, 1e9},
            .required = true,
            .told = true},
    [KD] = {{"kd", "N m s/rad", "damping of the servo", NAN, 0, 1e9},
            .required = true,
            .told = true},
    [TARGET] = {{"target", "", "angle to hold: %s", NAN, 0, 0},
                .per = STANCE_PER_ACTUATOR,
                .fallback_text = "as the run begins; with far the equilibrium",
                .all = "the joint angles that the servo holds"},
};

static stance_error set(const stance_scene *scene, const double *value, const double *begin,
                        stance_linear_law *linear, stance_case *c, stance_message *message)
{
    (void)c, (void)message;
    const double *const target = &value[TARGET * STANCE_LAW_ROOM];
    for (int k = 0; k < scene->postures; k++) {
        linear->target[k] = begin[scene->posture[k]];
        for (int i = 0; i < scene->actuators; i++) {
            if (scene->actuated[i] != scene->posture[k])
                continue;
            linear->gain[i][k] = value[KP * STANCE_LAW_ROOM];
            linear->gain[i][scene->postures + k] = value[KD * STANCE_LAW_ROOM];
            if (!isnan(target[i]))
                linear->target[k] = target[i];
        }
    }
    return STANCE_OK;
}

const stance_law stance_law_hold = {
    .name = "hold",
    .text = "a servo in each joint",
    .acts_far = true,
    .parameters = PARAMETERS,
    .parameter = parameters,
    .set = set,
};
