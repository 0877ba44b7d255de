/* reading.h - what the tests of scenario files share: reading a text, with what it says. */
#ifndef STANCE_TESTS_READING_H
#define STANCE_TESTS_READING_H

#include "support.h"

#include "runner/scenario/scenario.h"

enum { ERRORS_SIZE = 1 << 16 };
static char errors[ERRORS_SIZE];

#define assert_near(found, wanted, tolerance) assert_true(fabs((found) - (wanted)) <= (tolerance))

/* Reads `text` (or the file, when NULL) under the name `file`; what it says goes to `errors`. */
static inline bool read_as(struct scenario *s, const char *file, const char *text,
                           const char *const *sets, size_t set_count)
{
    FILE *out = fmemopen(errors, sizeof errors, "w");
    assert_non_null(out);
    bool good = scenario_read(s, file, text, sets, set_count, out);
    fputc('\0', out);
    fclose(out);
    return good;
}

static inline void read_good(struct scenario *s, const char *text, const char *const *sets,
                             size_t set_count)
{
    if (!read_as(s, "good.yaml", text, sets, set_count))
        fail_msg("refused: %s", errors);
    assert_string_equal(errors, "");
}

#endif
