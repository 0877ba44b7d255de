/* fuzz_scenario.c - any bytes at all as a scenario: read, and if accepted planned and checked.
 *
 * Lines of the input that begin with "#set " are comments to YAML; what follows goes to the reader
 * as --set strings. An input with zero bytes is read from a file, others as text. Of what is
 * accepted two things must hold besides the absence of crashes: the resolved text is itself
 * accepted and resolves to itself (a results file stores it, and a resume compares it), and a plan
 * is made or refused with one line.
 *
 * For libFuzzer there is a mutator that knows lines, indentation and flow, and takes its words from
 * the table of keys: random bytes hardly ever get past YAML. tests/test_fuzz.c runs the same
 * function over the inputs kept in tests/fuzz/scenario.
 */
#include "fuzz_scenario.h"

#include "runner/plan/plan.h"
#include "runner/scenario/schema.h"
#include "runner/scenario/tree.h"
#include "runner/store/store.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

enum { MOST_SETS = 8, MOST_DESIGNS = 4, MOST_CASES = 16 };

/* ---- one input ---------------------------------------------------------------------------- */

/* The strings after "#set " at beginnings of lines; each is freed by the caller. */
static size_t find_sets(const char *text, char *set[MOST_SETS])
{
    size_t n = 0;
    for (const char *line = text; line && *line && n < MOST_SETS;) {
        const char *end = strchr(line, '\n');
        if (strncmp(line, "#set ", 5) == 0) {
            set[n] = strndup(line + 5, end ? (size_t)(end - line - 5) : strlen(line + 5));
            n += set[n] != NULL;
        }
        line = end ? end + 1 : NULL;
    }
    return n;
}

static bool read_input(struct scenario *s, const char *text, size_t size, char *const *set,
                       size_t sets, FILE *errors)
{
    char name[64];
    if (strlen(text) == size)
        return scenario_read(s, "input.yaml", text, (const char *const *)set, sets, errors);
    int file = memfd_create("input", MFD_CLOEXEC);
    if (file < 0 || write(file, text, size) != (ssize_t)size)
        abort();
    snprintf(name, sizeof name, "/proc/self/fd/%d", file);
    bool good = scenario_read(s, name, NULL, (const char *const *)set, sets, errors);
    close(file);
    return good;
}

/* What the file of results stores must mean the same to whoever reads it there. */
static void check_resolved(const struct scenario *s, FILE *errors)
{
    static struct scenario again;
    if (!scenario_read(&again, "resolved.yaml", s->text, NULL, 0, errors) ||
        strcmp(again.text, s->text) != 0 || again.cases != s->cases || again.axes != s->axes) {
        fprintf(stderr, "the resolved text is another scenario:\n%s\n", s->text);
        abort();
    }
    scenario_free(&again);
}

static void look_at_axes(const struct scenario *s)
{
    char text[64];
    struct scenario_values values;
    for (int a = 0; a < s->axes; a++) {
        for (int k = 0; k < s->axis[a].paths; k++) {
            scenario_axis_text(&s->axis[a], 0, k, text, sizeof text);
            scenario_axis_text(&s->axis[a], s->axis[a].count - 1, k, text, sizeof text);
        }
    }
    scenario_case_values(s, 0, &values);
    scenario_case_values(s, s->cases - 1, &values);
}

/* What `stance check` does, but for the trial runs. */
static void check_plan(const struct scenario *s)
{
    const struct parallel alone = parallel_alone();
    struct plan plan;
    struct plan_error error = {0};
    uint64_t place;
    bool good = plan_make(&plan, s, false, 0, false, &error);

    if (good && plan.designs <= MOST_DESIGNS) {
        good = plan_compute_designs(&plan, &alone, &error);
        if (good && s->cases <= MOST_CASES)
            good = plan_check_cases(&plan, &error);
    }
    if (good && plan.rows > 0) {
        plan_recorded(&plan, plan.rows - 1, &place);
        store_size(&plan, 1);
    }
    if (!good && (error.message.text[0] == '\0' || strchr(error.message.text, '\n'))) {
        fprintf(stderr, "refused without a line of reason\n");
        abort();
    }
    plan_free(&plan);
    if (plan_make(&plan, s, true, s->cases - 1, true, &error))
        plan_free(&plan);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static FILE *nowhere;
    static struct scenario scenario,
        *const s = &scenario; /* the sanitizer's heap is slow with large pieces */
    char *set[MOST_SETS], *text = malloc(size + 1);

    nowhere = nowhere ? nowhere : fopen("/dev/null", "w");
    if (!text || !nowhere)
        abort();
    memcpy(text, data, size);
    text[size] = '\0';
    size_t sets = find_sets(text, set);
    if (read_input(s, text, size, set, sets, nowhere)) {
        check_resolved(s, nowhere);
        look_at_axes(s);
        check_plan(s);
        scenario_free(s);
    }
    for (size_t i = 0; i < sets; i++)
        free(set[i]);
    free(text);
    return 0;
}
