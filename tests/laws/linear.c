/* linear.c - what the program's own linear laws command, operation by operation, for tests: data
 * are feedforward, targets, gains (a row for each actuator), the normal of a plane and the push
 * beyond it. */
#include "stance_law.h"

void law(const struct sample *now, const struct parameters *is, struct memory *mine,
         struct torques *out)
{
    enum { P = POSTURES, FIRST = COORDINATES - POSTURES };
    enum {
        TARGET = ACTUATORS,
        GAIN = TARGET + P,
        NORMAL = GAIN + 2 * ACTUATORS * P,
        PUSH = NORMAL + 2 * P
    };
    double off[P], beyond = -1;
    for (int j = 0; j < P; j++) {
        off[j] = now->q.all[FIRST + j] - data[TARGET + j];
        beyond =
            fma(data[NORMAL + j], off[j], fma(data[NORMAL + P + j], now->v.all[FIRST + j], beyond));
    }
    for (int i = 0; i < ACTUATORS; i++) {
        double torque = data[i];
        for (int j = 0; j < P; j++)
            torque = fma(-data[GAIN + 2 * P * i + j], off[j],
                         fma(-data[GAIN + 2 * P * i + P + j], now->v.all[FIRST + j], torque));
        out->all[i] = fma(-data[PUSH + i], fmax(beyond, 0), torque);
    }
}
