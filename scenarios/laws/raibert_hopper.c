/* raibert_hopper.c - a robot that hops on one leg, at an asked speed.
 *
 * Raibert (Legged Robots That Balance, MIT Press 1986, chapter 2): three parts that know nothing of
 * each other, and a state machine that follows the foot.
 *
 * 1. In flight the leg swings to where the foot is to land, ahead of the hip by
 *
 *        x = v T / 2 + placement (v - speed),
 *
 *    v the hip's speed and T how long the last stance took: landing at v T / 2 the body passes over
 *    its foot as fast as it came (the neutral point), landing further ahead it is braked.
 * 2. In stance the hip keeps the body upright: torque = attitude body + attitude_rate body'.
 * 3. From the shortest leg on it pushes off: by `thrust`, and more the lower the last hop was.
 *
 * Angles grow counter-clockwise: a leg at the angle b against the vertical has its foot ahead by
 * its length times sin(b).
 */
#define PARAMETERS(X)                                                                              \
    X(speed, 0, "m/s", -10, 10, "to hop at")                                                       \
    X(height, 1, "m", 0, 10, "of the hip, to hop to")                                              \
    X(placement, 0.05, "s", -10, 10, "how much further ahead the foot lands for too much speed")   \
    X(swing, 70, "N m", 0, 1e5, "of the leg to its angle in flight")                               \
    X(swing_rate, 10, "N m s", 0, 1e5, "brakes it")                                                \
    X(attitude, 300, "N m/rad", 0, 1e5, "of the body to upright in stance")                        \
    X(attitude_rate, 30, "N m s/rad", 0, 1e5, "brakes it")                                         \
    X(grip, 1000, "N", 0, 1e6,                                                                     \
      "most of both for each metre that the leg is shortened: it slips less")                      \
    X(thrust, 48, "N", 0, 1e5, "of the leg from its shortest on")                                  \
    X(lift, 400, "N/m", 0, 1e5, "more of it where the last hop was too low")                       \
    X(stance, 0.2, "s", 0, 10, "what the first stance is taken to last")                           \
    X(travel, 0.3, "m", 0, 10, "how long the sliding part is at most")                             \
    X(socket, 0.4, "m", 0, 10, "from the hip to where the foot begins to slide")
#define MEMORY(X) X(phase) X(landed) X(lasted) X(apex)
#include "stance_law.h"

enum { FLIGHT, LOADING, THRUST }; /* phase */

static double clip(double x, double most)
{
    return fmin(fmax(x, -most), most);
}

void law(const struct sample *now, const struct parameters *is, struct memory *mine,
         struct torques *out)
{
    const double b = now->q.body + now->q.leg, length = is->socket + now->q.shoe;
    if (now->time == 0)
        mine->lasted = is->stance, mine->apex = now->q.z;
    if (mine->phase == FLIGHT && now->stands.foot)
        mine->phase = LOADING, mine->landed = now->time;
    else if (mine->phase == LOADING && now->v.shoe > 0)
        mine->phase = THRUST;
    else if (mine->phase == THRUST && !now->stands.foot)
        mine->phase = FLIGHT, mine->lasted = now->time - mine->landed, mine->apex = 0;
    mine->apex = fmax(mine->apex, now->q.z);
    if (mine->phase == FLIGHT) {
        const double x = now->v.x * mine->lasted / 2 + is->placement * (now->v.x - is->speed);
        out->hip = -is->swing * (sin(b) - clip(x / length, 0.5)) -
                   is->swing_rate * (now->v.body + now->v.leg);
        return;
    }
    out->hip = clip(is->attitude * now->q.body + is->attitude_rate * now->v.body,
                    is->grip * fmax(0, is->travel - now->q.shoe));
    if (mine->phase == THRUST)
        out->push = fmax(0, is->thrust + is->lift * (is->height - mine->apex));
}
