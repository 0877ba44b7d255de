/* bimodal_feedback.c - state feedback with other gains on the far side of a plane.
 *
 *   torque = clip(feedforward - gain x - push max(0, normal x - 1)),    x = (posture - target,
 * rates).
 *
 * On the side of the plane normal x = 1 that holds the target this is state feedback; beyond it the
 * gains are gain + push normal', and nothing jumps: a continuous bimodal piecewise linear system
 * (Camlibel, Heemels and Schumacher, IEEE Trans. Autom. Control 53 (2008) 762). What it is for: a
 * robot whose equilibrium takes torque has more of it left one way than the other, so that the
 * torques of a fall forward are cut where those of a fall backward are not, and no single gain
 * matrix suits both. */
#include "engine/refuse.h"

#include <math.h>

enum { NORMAL, NORMAL_RATE, PUSH, PARAMETERS };
#define LARGE 1e9

static const stance_parameter parameters[PARAMETERS] = {
    [NORMAL] = {{"normal", "1/rad", "component of the plane's normal: %s", 0, -LARGE, LARGE},
                .per = STANCE_PER_POSTURE,
                .told = true,
                .all = "normal of the plane normal x = 1 beyond which torques bend, in the angles"},
    [NORMAL_RATE] = {{"normal_rate", "s/rad", "component of the plane's normal, rate: %s", 0,
                      -LARGE, LARGE},
                     .per = STANCE_PER_POSTURE,
                     .told = true,
                     .all = "normal of the plane, in the rates"},
    [PUSH] = {{"push", "N m", "torque taken off for each unit of normal x beyond 1: %s", 0, -LARGE,
               LARGE},
              .per = STANCE_PER_ACTUATOR,
              .told = true,
              .all = "how far the torques bend beyond the plane",
              .more = "Beyond the plane the gains are those given or designed and push times "
                      "normal: stance design prints them, with the poles that they make."},
};

static stance_error set(const stance_scene *scene, const double *value, const double *begin,
                        stance_linear_law *linear, stance_case *c, stance_message *message)
{
    double sum = 0;
    (void)begin, (void)linear;
    for (int k = 0; k < scene->postures; k++) {
        c->bend.normal[k] = value[NORMAL * STANCE_LAW_ROOM + k];
        c->bend.normal[scene->postures + k] = value[NORMAL_RATE * STANCE_LAW_ROOM + k];
        sum += c->bend.normal[k] + c->bend.normal[scene->postures + k];
    }
    for (int i = 0; i < scene->actuators; i++)
        sum += c->bend.push[i] = value[PUSH * STANCE_LAW_ROOM + i];
    c->bends = true;
    return isfinite(sum) ? STANCE_OK
                         : stance_refuse(message, STANCE_BAD_ARGUMENT,
                                         "a normal or a push of the bimodal law is not finite");
}

const stance_law stance_law_bimodal_feedback = {
    .name = "bimodal-feedback",
    .text = "state-feedback with other gains beyond a plane: less push times what normal x is "
            "above 1",
    .designed = true,
    .samples = true,
    .parameters = PARAMETERS,
    .parameter = parameters,
    .set = set,
};
