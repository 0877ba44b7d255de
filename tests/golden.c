/* golden.c - prints "scene method isa hash" for every kernel with lanes that this machine runs:
 * a program of the engine alone, to be compared between machines (tests/whole_machines.sh).
 * Usage: golden [CASES] */
#include "cases.h"

#include <stdio.h>

int main(int argc, char **argv)
{
    const long n = argc > 1 ? strtol(argv[1], NULL, 10) : 400;
    if (n < 1)
        return 2;
    for (const stance_scene *const *scene = stance_scenes(); *scene; scene++)
        for (const stance_method *const *method = stance_methods(); *method; method++)
            for (int rank = 0; stance_isa(rank); rank++) {
                const stance_kernel *const k =
                    stance_kernel_find(*scene, *method, stance_isa(rank));
                if (strcmp(k->isa, stance_isa(rank)) != 0)
                    continue; /* a method that has one kernel only */
                const uint64_t h = golden_hash(k, (size_t)n, false, (size_t)n);
                printf("%s %s %s %016llx\n", (*scene)->name, (*method)->name, k->isa,
                       (unsigned long long)h);
            }
    return 0;
}
