/* reading.h - what the tests of scenario files share: reading a text, with what it says. */
#ifndef STANCE_TESTS_READING_H
#define STANCE_TESTS_READING_H

#include "support.h"

#include "runner/scenario/scenario.h"

enum { ERRORS_SIZE = 1 << 16 };
static char errors[ERRORS_SIZE];

/* What goes when its block ends. */
#define SCENARIO FREED(scenario_free) struct scenario
#define PLAN FREED(plan_free) struct plan
#define DOE FREED(doe_end) struct doe

#define assert_near(found, wanted, tolerance) assert_true(fabs((found) - (wanted)) <= (tolerance))

/* The texts of a file that stand between lines "base NAME" and "end", in their order; 0: there. */
enum { BASE_SIZE = 2048 };
static inline int read_bases(const char *file, char (*text)[BASE_SIZE])
{
    FILE *const in = fopen(file, "r");
    char line[1024];
    bool inside = false;
    while (in && fgets(line, sizeof line, in))
        if (strncmp(line, "base ", 5) == 0)
            inside = true;
        else if (strcmp(line, "end\n") == 0)
            inside = false, text++;
        else if (inside)
            strcat(*text, line);
    return in ? fclose(in) : -1;
}

/* Reads `text` (or the file, when NULL) under the name `file` in place of what *s was, if it was
 * anything; what it says goes to `errors`. */
static inline bool read_as(struct scenario *s, const char *file, const char *text,
                           const char *const *sets, size_t set_count)
{
    FILE *out = fmemopen(errors, sizeof errors, "w");
    assert_non_null(out);
    scenario_free(s);
    memset(s, 0xa5, sizeof *s); /* whatever was there */
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
