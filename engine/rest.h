/* rest.h - is there an equilibrium close by that holds?
 *
 * Slow is not at rest: a robot that topples over may take its time. `rested` and `stabilised` ask
 * for an equilibrium: with w = 0, contacts that stand (gap closed, forces inside the cones, what
 * the law commands within its limits) and no acceleration,
 *
 *   A w' = F(s, 0, t) + B torque(s, 0, I) + H^T lambda = 0,
 *
 * no further from the state than settle.angle, found by Newton's iteration along the ways that the
 * standing contacts leave (the null space Z of their H, s = s* + Z x on the ground); and that it
 * holds. About it, with central differences,
 *
 *   x'' = K x + B u,    u = C (x, x', I),    I' = E (x, x', I),
 *
 * I the integrals of a law that has them. Where a torque is at its limit its row of C is zero: that
 * is what the limit makes of it. A law that samples every T seconds and holds gives the map
 *
 *   (x, x')+ = Phi (x, x') + Gamma u,   I+ = I + T I',   [Phi Gamma; 0 1] = exp([0 1 0; K 0 B; 0 0
 * 0] T)
 *
 * with the u of some samples before where there is a delay, and with the torques as states where
 * actuators lag; one that acts all the time the exponential of the closed loop. It holds where
 * nothing has fallen and no reference of a servo still moves, when a disturbance has not grown by
 * more than GROWTH after HOLDS times settle.hold, WHOLE at least, by squaring the map again and
 * again: what swings without damping, as a free leg does, holds, too; what grows, however slowly,
 * does not. Forces that change with time are looked at eight times a period, at their crests among
 * these. Noise is left out.
 *
 * `rested` says that the motion has come there. Contacts that carry stand, to REST_CREEP, and the
 * map takes the present deviation (x, x', I) to nothing, or round and round, without leaving
 * settle.angle and settle.rate on the way, the forces inside the cones, no other contact closing,
 * nothing falling, the law as linear as it was taken for (BENT: no limit, no other law, no rate
 * limit that counts): looked at eight times an octave of time. What slid to rest has its force on
 * the edge of the cone, up to rounding: cones are wider by REST_EDGE.
 *
 * No design knows these equilibria before: a block comes to rest where it has slid to, a robot
 * where it has fallen over. So it is asked while a case runs, as seldom as a case comes to rest,
 * and once for all kernels; what the robot does near a state a kernel tells (core/loop/rest.h).
 */
#ifndef STANCE_REST_H
#define STANCE_REST_H

#include "stance.h"

typedef struct stance_rest stance_rest;
struct stance_rest {
    int coordinates, actuators;
    double angle, speed, hold; /* of stop.settle */
    bool samples;              /* the law, every T; else it acts all the time, looked at every T */
    double T;
    bool lags; /* the actuators, with `lag` and `rate`, see core/loop/actuator.h */
    double lag, rate;
    int delay;  /* samples */
    bool comes; /* asked, too: does the motion come there? */
    double s[STANCE_MAX_COORDINATES], w[STANCE_MAX_COORDINATES], integral[STANCE_MAX_ACTUATORS];
    /* Torques now, if they lag, and commands under way, the next one first. */
    double under_way[(1 + STANCE_MAX_DELAY) * STANCE_MAX_ACTUATORS];

    /* What the robot does, on the contacts that it was last found to stand on.
     *
     * Torques that the law commands, limited, and the rates of its integrals. */
    void (*law)(const stance_rest *r, const double *s, const double *w, const double *integral,
                double *torque, double *rate);
    /* Accelerations a[coordinates] from rest. */
    void (*accelerate)(const stance_rest *r, const double *s, const double *torque, double *a);
    /* What the contacts hold, row s' = 0, and how fast that may be where they stand, m/s; returns
     * the number of rows, at most 2 STANCE_MAX_CONTACTS. */
    int (*rows)(const stance_rest *r, const double *s, double row[][STANCE_MAX_COORDINATES],
                double *creeps);
    /* Puts s on to the ground. */
    void (*project)(const stance_rest *r, const double *torque, double *s);
    /* Finds what it stands on at s, with torques; false: contacts slide, no forces hold them, or it
     * has fallen. `always`: at all times, where forces change. */
    bool (*stands)(stance_rest *r, const double *s, const double *torque, bool always);
    /* Does it go on standing on the same at s, with these torques, nothing else touching? */
    bool (*stays)(const stance_rest *r, const double *s, const double *torque);
};

bool stance_rest_holds(stance_rest *r);

#endif
