/* kernels.c - the tables of methods and kernels, and the choice among instruction sets. */
#include "tree.h"

#include <stdlib.h>
#include <string.h>

/* What there is, from the Makefile: METHOD(implicit) ..., ISA(sse2) ISA(scalar) ... from slow to
 * fast, and KERNEL(biped, implicit, sse2) ... in that order of instruction sets; the kernels of
 * methods that take one case at a time, which run on every processor, in a list of their own. Here
 * is what a tool that reads this file alone sees. */
#ifndef STANCE_METHOD_LIST
#define STANCE_METHOD_LIST METHOD(implicit)
#define STANCE_ISA_LIST ISA(scalar)
#define STANCE_KERNEL_LIST KERNEL(biped, implicit, scalar)
#define STANCE_SCALAR_KERNEL_LIST
#endif

#define METHOD(method) extern const stance_method stance_method_##method;
STANCE_METHOD_LIST
#undef METHOD
#define KERNEL(scene, method, isa)                                                                 \
    extern const stance_kernel stance_kernel_##scene##_##method##_##isa;
STANCE_KERNEL_LIST STANCE_SCALAR_KERNEL_LIST
#undef KERNEL

#define METHOD(method) &stance_method_##method,
    static const stance_method *const methods[] = {STANCE_METHOD_LIST NULL};
#undef METHOD
#define ISA(isa) #isa,
static const char *const isas[] = {STANCE_ISA_LIST};
#undef ISA
#define KERNEL(scene, method, isa) &stance_kernel_##scene##_##method##_##isa,
static const stance_kernel *const kernels[] = {STANCE_KERNEL_LIST};
static const stance_kernel *const scalar_kernels[] = {STANCE_SCALAR_KERNEL_LIST NULL};
#undef KERNEL

/* Numbers of them. */
enum {
    ISAS = sizeof isas / sizeof isas[0],          // NOLINT(bugprone-sizeof-expression)
    KERNELS = sizeof kernels / sizeof kernels[0], // NOLINT(bugprone-sizeof-expression)
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

bool stance_kernel_fits(const stance_kernel *kernel, const stance_scene *scene)
{
    if (strcmp(kernel->structure, "runtime") == 0)
        return true;
    const stance_scene *const own = stance_scene_find(kernel->structure);
    return own == scene || memcmp(own->tree, scene->tree, sizeof *scene->tree) == 0;
}

bool stance_kernel_ahead(const stance_kernel *kernel)
{
    return strcmp(kernel->structure, "runtime") != 0;
}

const stance_kernel *stance_kernel_find(const stance_scene *scene, const stance_method *method,
                                        const char *isa)
{
    bool runs = !isa;
    for (int i = 0; i < ISAS; i++)
        runs = runs || (strcmp(isa, isas[i]) == 0 && isa_runs(isa));
    enum { OF_STRUCTURE, OF_ANY, OF_ANY_ISA, KINDS };
    for (int kind = 0; kind < KINDS && runs; kind++)
        for (int i = KERNELS - 1; i >= 0; i--) {
            const stance_kernel *const k = kernels[i];
            if (k->method == method && stance_kernel_ahead(k) == (kind == OF_STRUCTURE) &&
                isa_runs(k->isa) && (!isa || kind == OF_ANY_ISA || strcmp(isa, k->isa) == 0) &&
                stance_kernel_fits(k, scene))
                return k;
        }
    for (int i = 0; scalar_kernels[i]; i++) /* those that are compiled for a structure first */
        if (scalar_kernels[i]->method == method && stance_kernel_fits(scalar_kernels[i], scene))
            return scalar_kernels[i];
    return NULL;
}

const char *stance_isa(int rank)
{
    for (int i = ISAS - 1; i >= 0; i--)
        if (isa_runs(isas[i]) && rank-- == 0)
            return isas[i];
    return NULL;
}
