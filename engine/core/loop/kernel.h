/* kernel.h - names of a compiled kernel: a method for one structure and one instruction set.
 *
 * A method's file is compiled once per structure and instruction set with -DSTANCE_SCENE=biped
 * -DSTANCE_SCENE_LANES=\"engine/scenes/biped_lanes.h\" -DSTANCE_ISA=avx2 -DSTANCE_LANES=4; it
 * defines METHOD and METHOD_THETA, includes stream.h, and ends in STANCE_KERNEL, its one const
 * struct. With -DSTANCE_OBJECT instead of the names that struct is a stance_object.
 */
#ifndef STANCE_CORE_LOOP_KERNEL_H
#define STANCE_CORE_LOOP_KERNEL_H

#include "engine/stance.h"

#define STANCE_QUOTE_(x) #x
#define STANCE_QUOTE(x) STANCE_QUOTE_(x)
#define STANCE_JOIN4_(a, b, c, d) stance_##a##_##b##_##c##_##d
#define STANCE_JOIN4(a, b, c, d) STANCE_JOIN4_(a, b, c, d)
#define STANCE_JOIN2_(a, b) stance_##a##_##b
#define STANCE_JOIN2(a, b) STANCE_JOIN2_(a, b)

/* What the method is (a stance_method's fields): in each of its kernels, of which the linker keeps
 * one. */
#define STANCE_METHOD(name)                                                                        \
    extern const stance_method STANCE_JOIN2(method, name);                                         \
    __attribute__((weak)) const stance_method STANCE_JOIN2(method, name)

#ifdef STANCE_OBJECT
/* Compiled on demand, into an object of its own: nothing of the program can be named. */
#define STANCE_KERNEL(name)                                                                        \
    extern __attribute__((visibility("default"))) const stance_object stance_kernel_object;        \
    const stance_object stance_kernel_object = {sizeof(stance_case), sizeof(stance_result),        \
                                                STANCE_LANES, bundle_stream, bundle_run}
#else
#define STANCE_KERNEL(name)                                                                        \
    extern const stance_kernel STANCE_JOIN4(kernel, STANCE_SCENE, name, STANCE_ISA);               \
    const stance_kernel STANCE_JOIN4(kernel, STANCE_SCENE, name,                                   \
                                     STANCE_ISA) = {STANCE_QUOTE(STANCE_SCENE),                    \
                                                    &STANCE_JOIN2(method, name),                   \
                                                    STANCE_QUOTE(STANCE_ISA),                      \
                                                    STANCE_LANES,                                  \
                                                    bundle_stream,                                 \
                                                    bundle_run}
#endif

#endif
