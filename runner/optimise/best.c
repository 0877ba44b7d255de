/* best.c - see best.h. */
#include "best.h"

#include "runner/base/message.h"
#include "runner/plan/design.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* "controller.gains=[[...], ...]", over the posture's angles and rates. */
static char *gains_text(const struct design_report *r)
{
    const struct scenario *const s = r->scenario;
    const int columns = 2 * s->scene->postures;
    double gain[SCENARIO_MAX_GAINS] = {0};
    char *text = NULL;
    size_t size = 0;
    FILE *const to = open_memstream(&text, &size);
    for (int i = 0; i < r->inputs; i++)
        for (int j = 0; j < r->states; j++)
            gain[i * columns + resolve_state(s->scene, &r->equilibrium, j)] =
                r->K[i * r->states + j];
    if (!to)
        return NULL;
    fputs("controller.gains=", to);
    for (int k = 0; k < r->inputs * columns; k++)
        fprintf(to, "%s%.17g", k % columns ? ", " : k ? "], [" : "[[", gain[k]);
    fputs("]]", to);
    if (fclose(to) != 0) {
        free(text);
        return NULL;
    }
    return text;
}

char *best_first(const struct scenario *s, stance_message *message)
{
    static const char *const drop[] = {"controller.poles", "controller.weights",
                                       "controller.design_time"};
    char *text = NULL;
    if (!s->search.designed_gains) {
        text = strdup(s->text);
    } else {
        struct design_report *const report = malloc(sizeof *report);
        if (report && !design_loop(report, s, NULL, message)) {
            free(report);
            return NULL;
        }
        char *const gains = report ? gains_text(report) : NULL;
        const char *const set[] = {"controller.design=gains", gains};
        text = gains ? scenario_rewrite(s->text, drop, sizeof drop / sizeof *drop, set, 2) : NULL;
        free(gains);
        free(report);
    }
    if (!text)
        no_memory(message);
    return text;
}

char *best_text(const struct search_file *f)
{
    enum { ROOM = 160 };
    static const char *const drop[] = {"optimise"};
    const size_t n = f->length[SEARCH_PARAMETER];
    char *const set = calloc(n, ROOM);
    const char **const list = calloc(n, sizeof *list);
    char *text = NULL;
    for (size_t i = 0; set && list && i < n; i++) {
        snprintf(&set[i * ROOM], ROOM, "%.110s=%.17g", f->parameter[i],
                 f->confirmed_value[(size_t)f->chosen * n + i]);
        list[i] = &set[i * ROOM];
    }
    if (set && list)
        text = scenario_rewrite(f->first_scenario, drop, 1, list, n);
    free(set);
    free(list);
    return text;
}

bool best_write(const struct search_file *f, const char *file, stance_message *message)
{
    char part[1200];
    char *const text = best_text(f);
    if (!text)
        return no_memory(message);
    snprintf(part, sizeof part, "%.1100s.part", file);
    FILE *const out = fopen(part, "w");
    bool good = out != NULL;
    if (good) {
        fprintf(out,
                "# The best of %zu candidates of stance optimise: its objective, of fresh starts,\n"
                "# is %.6g; that of the first candidate %.6g.\n%s",
                f->length[SEARCH_CANDIDATE], f->confirmed_objective[f->chosen],
                f->confirmed_objective[0], text);
        good = !ferror(out);
        good = fclose(out) == 0 && good;
    }
    good = good && rename(part, file) == 0;
    if (!good) {
        complain(message, "%.150s: cannot write: %s", file, strerror(errno));
        unlink(part);
    }
    free(text);
    return good;
}
