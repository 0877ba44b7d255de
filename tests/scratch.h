/* scratch.h - a folder of its own for a test program, which is gone when its tests are done; where
 * kernels are compiled it keeps them. */
#ifndef STANCE_TESTS_SCRATCH_H
#define STANCE_TESTS_SCRATCH_H

#include "long.h"
#include "tests.h"

#include <sys/stat.h>
#include <unistd.h>

static char scratch[] = "/tmp/stance-test-XXXXXX";

static inline int scratch_make(void **state __attribute__((unused)))
{
    return mkdtemp(scratch) ? 0 : -1;
}

static inline int scratch_remove(void **state __attribute__((unused)))
{
    char command[60];
    snprintf(command, sizeof command, "rm -rf %s", scratch);
    return system(command);
}

/* Kernels of a share are compiled in a third of the time, by optimising less: the bits are the
 * same. */
static inline int cache_make(void **state)
{
    char name[60];
    if (scratch_make(state) != 0)
        return -1;
    setenv("STANCE_CACHE", scratch, 1);
    if (long_tests())
        return 0;
    snprintf(name, sizeof name, "%s/cc", scratch);
    FILE *const f = fopen(name, "w");
    if (!f || fputs("#!/bin/bash\nexec gcc \"${@/#-O3/-O1}\"\n", f) < 0 || fclose(f) != 0)
        return -1;
    setenv("CC", name, 1);
    return chmod(name, 0700);
}

#endif
