/* kernels.c - the tables of methods and kernels, and the choice among instruction sets. */
#include "stance.h"

#include <stdlib.h>
#include <string.h>

/* What there is: a method or a scene is a word here and in the Makefile. STANCE_ISA_LIST comes
 * from there: X(sse2) X(scalar) ... from slow to fast. */
#define STANCE_METHODS(X) X(implicit) X(midpoint) X(capturing) X(lagrange) X(event_driven)
#define STANCE_VECTOR_METHODS(K, scene, isa)                                                       \
    K(scene, implicit, isa) K(scene, midpoint, isa) K(scene, capturing, isa) K(scene, lagrange, isa)
/* One case at a time, whatever the processor. */
#define STANCE_SCALAR_METHODS(K, scene, isa) K(scene, event_driven, isa)
#define STANCE_SCENES(EACH, K, isa)                                                                \
    EACH(K, ball, isa) EACH(K, block, isa) EACH(K, rod, isa) EACH(K, biped, isa)

#ifndef STANCE_ISA_LIST
#define STANCE_ISA_LIST X(scalar)
#endif

#define DECLARE_METHOD(m) extern const stance_method stance_method_##m;
STANCE_METHODS(DECLARE_METHOD)

#define ENTRY_METHOD(m) &stance_method_##m,
static const stance_method *const methods[] = {STANCE_METHODS(ENTRY_METHOD) NULL};

#define DECLARE_KERNEL(scene, m, isa)                                                              \
    extern const stance_kernel stance_kernel_##scene##_##m##_##isa;
#define X(isa) STANCE_SCENES(STANCE_VECTOR_METHODS, DECLARE_KERNEL, isa)
STANCE_ISA_LIST
#undef X
STANCE_SCENES(STANCE_SCALAR_METHODS, DECLARE_KERNEL, scalar)

/* Slow to fast. */
static const stance_kernel *const kernels[] = {
#define ENTRY_KERNEL(scene, m, isa) &stance_kernel_##scene##_##m##_##isa,
#define X(isa) STANCE_SCENES(STANCE_VECTOR_METHODS, ENTRY_KERNEL, isa)
    STANCE_ISA_LIST
#undef X
};
static const stance_kernel *const scalar_kernels[] = {
    STANCE_SCENES(STANCE_SCALAR_METHODS, ENTRY_KERNEL, scalar)};

/* Numbers of them. */
enum {
    KERNELS = sizeof kernels / sizeof kernels[0], // NOLINT(bugprone-sizeof-expression)
    SCALAR_KERNELS =
        sizeof scalar_kernels / sizeof scalar_kernels[0] // NOLINT(bugprone-sizeof-expression)
};

const stance_method *const *stance_methods(void)
{
    return methods;
}

const stance_method *stance_method_find(const char *name)
{
    for (size_t i = 0; methods[i]; i++)
        if (strcmp(methods[i]->name, name) == 0)
            return methods[i];
    return NULL;
}

/* Does this processor (and its operating system) run the instruction set? `scalar` is compiled for
 * processors with fused multiply-adds, where its architecture has others too. */
static bool isa_runs(const char *isa)
{
#if defined(__x86_64__)
    if (strcmp(isa, "sse2") == 0)
        return true;
    if (!__builtin_cpu_supports("fma"))
        return false;
    if (strcmp(isa, "avx2") == 0)
        return __builtin_cpu_supports("avx2");
    if (strcmp(isa, "avx512") == 0)
        return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
               __builtin_cpu_supports("avx512vl");
#endif
    (void)isa;
    return true;
}

const stance_kernel *stance_kernel_find(const stance_scene *scene, const stance_method *method,
                                        const char *isa)
{
    for (int i = KERNELS - 1; i >= 0; i--) {
        const stance_kernel *const k = kernels[i];
        if (k->scene != scene || k->method != method || !isa_runs(k->isa))
            continue;
        if (!isa || strcmp(isa, k->isa) == 0)
            return k;
    }
    for (int i = 0; i < SCALAR_KERNELS; i++)
        if (scalar_kernels[i]->scene == scene && scalar_kernels[i]->method == method)
            return scalar_kernels[i];
    return NULL;
}

const char *stance_isa(int rank)
{
    const char *previous = "";
    for (int i = KERNELS - 1; i >= 0; i--) {
        if (strcmp(kernels[i]->isa, previous) == 0 || !isa_runs(kernels[i]->isa))
            continue;
        previous = kernels[i]->isa;
        if (rank-- == 0)
            return previous;
    }
    return NULL;
}
