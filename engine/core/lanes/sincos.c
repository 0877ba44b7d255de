/* sincos.c - the kernels' sine and cosine for one angle. */
#undef STANCE_LANES
#define STANCE_LANES 1
#include "engine/stance.h"

#include "sincos.h"

void stance_sincos(double angle, double *sine, double *cosine)
{
    lanes_sincos(angle, sine, cosine);
}
