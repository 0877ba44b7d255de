/* accelerations.h - the kernels' accelerations: changes of velocity over ever shorter steps,
 * extrapolated to none. */
#ifndef STANCE_TESTS_ACCELERATIONS_H
#define STANCE_TESTS_ACCELERATIONS_H

#include <math.h>

#include "engine/stance.h"

/* Of a case whose torques are held. */
static inline void accelerations(const stance_scene *scene, const stance_case *start, double *a)
{
    enum { LEVELS = 6 };
    const stance_kernel *const kernel =
        stance_kernel_find(scene, stance_method_find("lagrange"), "scalar");
    double table[LEVELS][STANCE_MAX_COORDINATES];
    for (int l = 0; l < LEVELS; l++) {
        stance_case c = *start;
        stance_result end;
        c.step = ldexp(4e-3, -l);
        c.steps = c.sample_every = 1;
        c.settle = false;
        kernel->run(&c, &end, 1);
        for (int i = 0; i < scene->coordinates; i++)
            table[l][i] = (end.velocity[i] - c.velocity[i]) / c.step;
    }
    for (int order = 1; order < LEVELS; order++)
        for (int l = LEVELS - 1; l >= order; l--)
            for (int i = 0; i < scene->coordinates; i++)
                table[l][i] += (table[l][i] - table[l - 1][i]) / (ldexp(1, order) - 1);
    for (int i = 0; i < scene->coordinates; i++)
        a[i] = table[LEVELS - 1][i];
}

#endif
