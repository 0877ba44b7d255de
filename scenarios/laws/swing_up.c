/* swing_up.c - the acrobot from anywhere to the neighbourhood of its upright position.
 *
 * Spong (The swing up control problem for the acrobot, IEEE Control Systems 15 (1995) 49): of
 *
 *     m11 q1'' + m12 q2'' + n1 = 0,   m12 q1'' + m22 q2'' + n2 = t,
 *
 * q1 the arms and q2 the legs against them, 0 upright, the torque t at the waist gives the legs any
 * acceleration a, t = (m22 - m12 m12 / m11) a + n2 - m12 / m11 n1, here towards a goal,
 *
 *     a = stiffness (goal - q2) - damping q2'.
 *
 * His goal is the arctangent of q1', which a sampled law answers to at once: it pumps by bending
 * the legs where the swing goes. Here it is the momentum about the bar, p = m11 q1' + m12 q2',
 * which gravity alone changes, and there is less to it the nearer the energy E is to that of
 * standing up:
 *
 *     goal = bend tanh(gain (E_up - E) p),
 *
 * so that the robot gets there slowly, with straight legs, to be caught. Upright is at 0, and not
 * at a turn from there: beyond hanging, E_up is taken for `shy` less than it is.
 */
#define PARAMETERS(X)                                                                              \
    X(bend, 1.2, "rad", 0, 3, "how far the legs go ahead of the swing")                            \
    X(gain, 0.04, "1/(J N m s)", 0, 100, "how soon they go as far as that")                        \
    X(stiffness, 80, "1/s^2", 0, 1e5, "of the legs towards their goal")                            \
    X(damping, 20, "1/s", 0, 1e4, "of the legs")                                                   \
    X(shy, 0.5, "J", 0, 1e3, "less than upright where the swing leads a turn away from it")        \
    X(arms_mass, 1, "kg", 0, 1e3, "what the law believes of the robot: the first link")            \
    X(arms_length, 1, "m", 0, 1e2, "hands to waist")                                               \
    X(arms_centre, 0.5, "m", 0, 1e2, "hands to centre of mass")                                    \
    X(arms_inertia, 0.08333, "kg m^2", 0, 1e3, "about that")                                       \
    X(legs_mass, 1, "kg", 0, 1e3, "the second link")                                               \
    X(legs_centre, 0.5, "m", 0, 1e2, "waist to centre of mass")                                    \
    X(legs_inertia, 0.08333, "kg m^2", 0, 1e3, "about that")                                       \
    X(gravity, 9.81, "m/s^2", 0, 1e3, "of the world that it believes in")
#include "stance_law.h"

void law(const struct sample *now, const struct parameters *is, struct memory *mine,
         struct torques *out)
{
    const double q1 = now->q.arms, q2 = now->q.legs, v1 = now->v.arms, v2 = now->v.legs;
    /* M and n: c couples the links, w1 and w2 are weights times arms */
    const double b = is->legs_mass * is->legs_centre * is->legs_centre + is->legs_inertia;
    const double c = is->legs_mass * is->arms_length * is->legs_centre;
    const double m22 = b, m12 = b + c * cos(q2);
    const double m11 = is->arms_mass * is->arms_centre * is->arms_centre + is->arms_inertia +
                       is->legs_mass * is->arms_length * is->arms_length + b + 2 * c * cos(q2);
    const double w2 = is->gravity * is->legs_mass * is->legs_centre;
    const double w1 =
        is->gravity * (is->arms_mass * is->arms_centre + is->legs_mass * is->arms_length);
    const double n2 = c * sin(q2) * v1 * v1 - w2 * sin(q1 + q2);
    const double n1 = -c * sin(q2) * (2 * v1 + v2) * v2 - w1 * sin(q1) - w2 * sin(q1 + q2);
    /* the swing: it hangs at pi, or at -pi; in the first half second, a push from rest */
    const double momentum = m11 * v1 + m12 * v2 + (now->time < 0.5 ? 1 : 0);
    const double lacks = w1 * (1 - cos(q1)) + w2 * (1 - cos(q1 + q2)) -
                         (m11 * v1 * v1 + 2 * m12 * v1 * v2 + m22 * v2 * v2) / 2 -
                         (fabs(q1) > 3.141592653589793 ? is->shy : 0);
    const double goal = is->bend * tanh(is->gain * lacks * momentum);
    const double a = is->stiffness * (goal - q2) - is->damping * v2;
    (void)mine;
    out->waist = (m22 - m12 * m12 / m11) * a + n2 - m12 / m11 * n1;
}
