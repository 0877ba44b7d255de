/* basin_within.c - cases that have an outcome only where their numbers keep to bounds. */
#include "basin_print.h"

#include "analysis/statistics/statistics.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* "2", "2..", "1..2": the largest, the least, both; false: none of these. */
static bool read_bounds(const char *text, double bound[2])
{
    const char *const dots = strstr(text, "..");
    char least[64], *end = least;
    bound[0] = -INFINITY, bound[1] = INFINITY;
    snprintf(least, sizeof least, "%.*s", dots ? (int)(dots - text) : 0, text);
    if (least[0])
        bound[0] = strtod(least, &end);
    bool good = *end == '\0' && !isnan(bound[0]);
    text = dots ? dots + 2 : text;
    if (*text) {
        char *stop;
        bound[1] = strtod(text, &stop);
        good = good && stop > text && *stop == '\0' && !isnan(bound[1]);
    }
    return good && (isfinite(bound[0]) || isfinite(bound[1])) && bound[0] <= bound[1];
}

/* One of them, whose bounds are put into the text. Returns an exit code. */
static int keep_within(struct results *r, const struct basin_within *within, const char *asked,
                       char *said, size_t size, stance_message *message)
{
    const char *const equals = strchr(asked, '=');
    char name[96];
    double *value = NULL, bound[2];
    snprintf(name, sizeof name, "%.*s", equals ? (int)(equals - asked) : 0, asked);
    if (!equals || !read_bounds(equals + 1, bound) || !basin_numbers(r, name, &value, message) ||
        !value)
        return refuse(message,
                      "stance %s: --within takes ANSWER=MOST or ANSWER=LEAST.. of a number that "
                      "the file stores, as settle_time=2, not '%.60s'",
                      within->command, asked);
    struct basin_lack lack;
    const bool good = basin_lacks(r, within->of, value, &lack, message);
    if (good && lack.inferred > 0)
        complain(message,
                 "stance %s: --within %.60s: %" PRIu64 " cases were inferred and have no such "
                 "number: it takes a map without sweep.refine",
                 within->command, name, lack.inferred);
    if (!good || lack.inferred > 0) {
        free(value);
        return good ? EXIT_USAGE : EXIT_IO;
    }
    if (lack.others > 0)
        fprintf(stderr, "stance %s: warning: %" PRIu64 " cases have no %s, and count as outside\n",
                within->command, lack.others, name);
    for (uint64_t i = 0; i < r->cases; i++)
        if (r->kind[i] == within->of && !(bound[0] <= value[i] && value[i] <= bound[1]))
            r->kind[i] = within->of == RESULTS_UNDECIDED ? RESULTS_FELL : RESULTS_UNDECIDED;
    free(value);
    add_text(said, size, "%s", said[0] ? ", " : "");
    if (!isfinite(bound[1]))
        add_text(said, size, "%s >= %g", name, bound[0]);
    else if (!isfinite(bound[0]))
        add_text(said, size, "%s <= %g", name, bound[1]);
    else
        add_text(said, size, "%g <= %s <= %g", bound[0], name, bound[1]);
    return EXIT_DONE;
}

int basin_within_make(struct results *own, const struct results *r,
                      const struct basin_within *within, char *said, size_t size,
                      stance_message *message)
{
    int code = EXIT_DONE;
    said[0] = '\0';
    *own = *r;
    own->kind = NULL;
    if (memchr(r->kind, RESULTS_DONE, r->cases))
        return refuse(message, "%.150s: holds no outcomes (record.answers left them out)", r->file);
    own->kind = malloc(r->cases + 1);
    if (!own->kind) {
        statistics_no_memory(r, message);
        return EXIT_IO;
    }
    memcpy(own->kind, r->kind, r->cases);
    for (size_t k = 0; code == EXIT_DONE && k < within->asked->count; k++)
        code = keep_within(own, within, within->asked->text[k], said, size, message);
    return code;
}
