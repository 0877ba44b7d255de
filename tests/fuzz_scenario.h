/* fuzz_scenario.h - the function that libFuzzer calls, also called by tests/test_fuzz.c. */
#ifndef STANCE_TESTS_FUZZ_SCENARIO_H
#define STANCE_TESTS_FUZZ_SCENARIO_H

#include <stddef.h>
#include <stdint.h>

/* Reads one scenario of `size` bytes; aborts where something is wrong. Returns 0. */
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

#endif
