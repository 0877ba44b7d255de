/* long.h - how much is tested: a share in `make test`, everything in `make test-long`. */
#ifndef STANCE_TESTS_LONG_H
#define STANCE_TESTS_LONG_H

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/stat.h>

static inline bool long_tests(void)
{
    return getenv("STANCE_TEST_LONG") != NULL;
}

/* Makes kernels of a share be compiled in a third of the time, by optimising less: the bits are the
 * same. */
static inline void compile_sooner(const char *folder)
{
    char name[60];
    if (long_tests())
        return;
    snprintf(name, sizeof name, "%s/cc", folder);
    FILE *const f = fopen(name, "w");
    assert_non_null(f);
    fputs("#!/bin/bash\nexec gcc \"${@/#-O3/-O1}\"\n", f);
    assert_int_equal(fclose(f), 0);
    assert_int_equal(chmod(name, 0700), 0);
    setenv("CC", name, 1);
}

#endif
