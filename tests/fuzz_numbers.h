/* fuzz_numbers.h - what a results file says, as hashes, for what is damaged and written in fuzzing.
 */
#ifndef STANCE_TESTS_FUZZ_NUMBERS_H
#define STANCE_TESTS_FUZZ_NUMBERS_H

#include "runner/store/results.h"

/* A case that is pending says nothing. */
struct fuzz_numbers {
    uint32_t axes, scenario, designs;
    uint64_t cases;
    uint32_t *row; /* [cases] */
    uint8_t *kind; /* [cases] */
    uint32_t *trajectory;
    size_t trajectories;
};

/* false: something cannot be read; the numbers are to be freed all the same. */
bool fuzz_hash_file(const char *file, struct fuzz_numbers *numbers, stance_message *message);
void fuzz_numbers_free(struct fuzz_numbers *numbers);

/* What differs, but for cases that count as pending; "": nothing. *pending: how many do more than
 * in the good file. */
const char *fuzz_difference(const struct fuzz_numbers *a, const struct fuzz_numbers *b,
                            uint64_t *pending);

#endif
