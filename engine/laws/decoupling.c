/* decoupling.c - as many coordinates as there are actuators follow set-points, each as a PID on it
 * asks (the paper's section 3.3 has two); how torques and reactions are found for that stands in
 * core/mode/decoupling.h. */
#include "engine/refuse.h"

#include <math.h>
#include <string.h>

enum { CONTROLLED, KP, KD, KI, LIMIT, SETPOINT, RAMP, RAMP_TIME, PARAMETERS };
#define LARGE 1e9

static const stance_parameter parameters[PARAMETERS] = {
    [CONTROLLED] =
        {{"controlled", "", "the coordinates that the law controls, one for each actuator", NAN, 0,
          0},
         .per = STANCE_PER_SELECTION,
         .required = true,
         .told = true,
         .more = "The others move as they must. Where the law would need a ground that pulls, "
                 "or is near a singular posture, it degrades: see the answer "
                 "degraded_samples."},
    [KP] = {{"proportional", "1/s^2", "proportional gain on %s", 100, 0, LARGE},
            .per = STANCE_PER_COORDINATE,
            .told = true,
            .all = "proportional gains: acceleration per error of a coordinate"},
    [KD] = {{"derivative", "1/s", "derivative gain on %s", 20, 0, LARGE},
            .per = STANCE_PER_COORDINATE,
            .told = true,
            .all = "derivative gains: acceleration per rate of the error"},
    [KI] = {{"integral", "1/s^3", "integral gain on %s", 0, 0, LARGE},
            .per = STANCE_PER_COORDINATE,
            .all = "integral gains: acceleration per integral of the error"},
    [LIMIT] = {{"integral_limit", "%s s", "largest integral of the error of %s", INFINITY, 0,
                LARGE},
               .per = STANCE_PER_COORDINATE,
               .unlimited = true,
               .all = "bounds of the integrals (anti-windup; they also rest while a torque is at "
                      "its limit)"},
    [SETPOINT] = {{"setpoint", "%s", "set-point of %s", NAN, -LARGE, LARGE},
                  .per = STANCE_PER_COORDINATE,
                  .told = true,
                  .fallback_text = "as the run begins; with far the equilibrium",
                  .all = "set-points of the coordinates"},
    [RAMP] = {{"ramp", "%s/s", "rate at which the set-point moves: %s", 0, -LARGE, LARGE},
              .per = STANCE_PER_COORDINATE,
              .all = "rates at which the set-points move"},
    [RAMP_TIME] = {{"ramp_time", "s", "time after which the set-point stays: %s", INFINITY, 0,
                    LARGE},
                   .per = STANCE_PER_COORDINATE,
                   .unlimited = true,
                   .all = "how long the set-points move"},
};

static stance_error set(const stance_scene *scene, const double *value, const double *begin,
                        stance_linear_law *linear, stance_case *c, stance_message *message)
{
    int selection, controlled[STANCE_MAX_ACTUATORS];
    (void)linear;
    memcpy(&selection, &value[CONTROLLED * STANCE_LAW_ROOM], sizeof selection);
    if (!stance_selection(scene, selection, controlled))
        return stance_refuse(message, STANCE_BAD_ARGUMENT,
                             "controller.controlled is no selection of coordinates");
    c->decouples = true;
    for (int i = 0; i < scene->actuators; i++) {
        const double *const of = &value[controlled[i]];
        stance_servo *const servo = &c->servo[i];
        const double setpoint = of[SETPOINT * STANCE_LAW_ROOM];
        *servo = (stance_servo){
            .coordinate = controlled[i],
            .setpoint = isnan(setpoint) ? begin[controlled[i]] : setpoint,
            .ramp = of[RAMP * STANCE_LAW_ROOM],
            .duration = of[RAMP_TIME * STANCE_LAW_ROOM],
            .kp = of[KP * STANCE_LAW_ROOM],
            .ki = of[KI * STANCE_LAW_ROOM],
            .kd = of[KD * STANCE_LAW_ROOM],
            .integral_limit = of[LIMIT * STANCE_LAW_ROOM],
        };
        if (!isfinite(servo->setpoint + servo->ramp + servo->kp + servo->ki + servo->kd) ||
            !(servo->duration >= 0 && servo->integral_limit >= 0))
            return stance_refuse(message, STANCE_BAD_ARGUMENT,
                                 "a gain or set-point of the decoupling law is not finite");
    }
    return STANCE_OK;
}

const stance_law stance_law_decoupling = {
    .name = "decoupling",
    .text = "torques and reactions solved together so that coordinates follow set-points",
    .acts_far = true,
    .servos = true,
    .parameters = PARAMETERS,
    .parameter = parameters,
    .set = set,
};
