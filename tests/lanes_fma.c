/* lanes_fma.c - see lanes_fma.h. */
#include "lanes_fma.h"

#include "engine/core/lanes/lanes.h"

#define FUSED_(isa) fused_##isa
#define FUSED(isa) FUSED_(isa)

void FUSED(STANCE_ISA)(const double (*operands)[3], double (*results)[3], size_t n)
{
    for (size_t i = 0; i < n; i += LANES) {
        lanes x[3], y[3];
        for (int lane = 0; lane < LANES; lane++)
            for (int k = 0; k < 3; k++)
                lane_set(&x[k], lane, operands[i + (size_t)lane][k]);
        y[0] = lanes_fma(x[0], x[1], x[2]);
        y[1] = lanes_fms(x[0], x[1], x[2]);
        y[2] = lanes_fnma(x[0], x[1], x[2]);
        for (int lane = 0; lane < LANES; lane++)
            for (int k = 0; k < 3; k++)
                results[i + (size_t)lane][k] = lane_get(&y[k], lane);
    }
}
