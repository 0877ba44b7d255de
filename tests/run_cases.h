/* run_cases.h - runs cases of a scene that were made by hand: the biped's where they name none. */
#ifndef STANCE_TESTS_RUN_CASES_H
#define STANCE_TESTS_RUN_CASES_H

#include <stdlib.h>

#include "engine/stance.h"

static inline void run_cases(const stance_kernel *kernel, const stance_case *cases,
                             stance_result *results, size_t n)
{
    stance_case *const own = calloc(n, sizeof *own);
    for (size_t i = 0; own && i < n; i++) {
        own[i] = cases[i];
        stance_case_robot(own[i].scene ? own[i].scene : stance_scene_find("biped"), &own[i]);
    }
    if (own)
        kernel->run(own, results, n);
    free(own);
}

#endif
