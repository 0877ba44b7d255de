/* lanes_fma.h - the fused operations of engine/core/lanes/lanes.h as each instruction set has them:
 * lanes_fma.c is compiled once for each of the Makefile's ISAS. */
#ifndef STANCE_TESTS_LANES_FMA_H
#define STANCE_TESTS_LANES_FMA_H

#include <stddef.h>

/* results[i][0 ... 2] = a b + c, a b - c, c - a b of operands[i] = a, b, c; n a multiple of 8. */
typedef void fused_function(const double (*operands)[3], double (*results)[3], size_t n);

#define ISA(isa) extern fused_function fused_##isa;
STANCE_ISA_LIST
#undef ISA

#endif
