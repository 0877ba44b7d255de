/* long.h - how much is tested: a share in `make test`, everything in `make test-long`. */
#ifndef STANCE_TESTS_LONG_H
#define STANCE_TESTS_LONG_H

#include <stdbool.h>
#include <stdlib.h>

static inline bool long_tests(void)
{
    return getenv("STANCE_TEST_LONG") != NULL;
}

#endif
