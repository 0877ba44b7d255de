/* results_sample.c - what the axis `sample` of a results file stands for: the values of the points
 * of sweep.sample; and the file's scenario, which has them. */
#include "results_private.h"

#include "runner/base/message.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A path and its values; of an enumeration the words are CF's flag_meanings. */
static bool read_varied(struct results *r, const char *path, int factor, stance_message *message)
{
    struct results_varied *v = &r->vary[r->varied];
    const size_t n = r->axis[r->sample].count;
    const struct results_variable from = results_variable(r, path);
    if (from.id < 0)
        return results_failed(r, path, message);
    r->varied++;
    v->factor = factor;
    v->of.count = n;
    results_describe(from.id, path, &v->of);
    char *words = hdf_text(from.id, "flag_meanings"), *rest = words;
    v->of.value = malloc(n * sizeof *v->of.value);
    v->word = words ? calloc(UINT8_MAX, sizeof *v->word) : NULL;
    bool good = v->of.value && (v->word || !words);
    if (!good)
        results_no_memory(r, message);
    if (words)
        results_clean(words);
    for (v->words = 0; good && rest && v->words < UINT8_MAX; v->words++)
        snprintf(v->word[v->words], sizeof *v->word, "%s", strsep(&rest, " "));
    good = good && ((from.rank == 1 && from.length[0] == n && from.number) ||
                    results_damaged(r, "a variable is not as its axes say", message));
    good =
        good && (hdf_read(from.id, KIND_double, v->of.value) || results_failed(r, path, message));
    for (size_t i = 0; good && i < n; i++) { /* an absent limit is infinite */
        const double value = v->of.value[i];
        if (isnan(value) || (v->word && !(value >= 0 && value < v->words)))
            good = results_damaged(r, "a sampled value is none", message);
    }
    free(words);
    hdf_close(from.id);
    return good;
}

bool results_read_sample(struct results *r, stance_message *message)
{
    enum { MOST = 256 };
    int factor = 0;
    const int last = r->axes - 1;

    r->block = 1;
    if (last < 0 || strcmp(r->axis[last].name, "sample") != 0)
        return true;
    const hid_t dataset = results_variable(r, "sample").id;
    if (dataset < 0)
        return results_failed(r, "sample", message);
    char *paths = hdf_text(dataset, "paths"), *rest = paths;
    results_copy_attribute(dataset, "method", r->method, sizeof r->method);
    r->block = (size_t)hdf_whole(dataset, "block", 1);
    char generator[64];
    results_copy_attribute(dataset, "generator", generator, sizeof generator);
    for (int m = 0; m < DOE_METHODS; m++) {
        r->other_points =
            r->other_points || (strcmp(r->method, doe_words[m]) == 0 &&
                                strcmp(generator, doe_generator((enum doe_method)m)) != 0);
    }
    hdf_close(dataset);
    r->vary = calloc(MOST, sizeof *r->vary);
    if (!r->vary) {
        free(paths);
        return results_no_memory(r, message);
    }
    bool good = paths || results_damaged(r, "it does not say what its sample varies", message);
    r->sample = good ? last : -1;
    while (good && rest) { /* "a;b,c": two factors, the second of two paths */
        const size_t end = strcspn(rest, ",;");
        const bool ends = rest[end] != ',';
        char *path = strsep(&rest, ",;");
        good = r->varied < MOST ? read_varied(r, path, factor, message)
                                : results_damaged(r, "its sample varies too much", message);
        factor += ends;
    }
    free(paths);
    return good;
}

/* ---- the scenario ------------------------------------------------------------------------- */

/* The value of a path in the only case of a file; false: it is not there, or none. */
static bool read_single(const struct results *r, const struct scenario_axis *axis, int k,
                        double *value)
{
    int words = 1;
    const bool good = results_numbers(r, axis->path[k], value, 1) == 1;
    for (const char *c = axis->meaning[k].words; c && *c; c++)
        words += *c == ' ';
    return good && !isnan(*value) && (!axis->meaning[k].words || (*value >= 0 && *value < words));
}

/* Gives a scenario of the file the file's points: another version's need not be this one's. */
static void take_points(const struct results *r, struct scenario *s)
{
    struct scenario_axis *axis = s->axes > 0 ? &s->axis[s->axes - 1] : NULL;
    if (!axis || !axis->sample || axis->count == 0)
        return;
    for (int k = 0; k < axis->paths; k++) {
        double value;
        if (r->single && read_single(r, axis, k, &value))
            axis->value[r->index % axis->count * (size_t)axis->paths + (size_t)k] = value;
        const bool fits =
            r->sample >= 0 && r->varied == axis->paths && r->axis[r->sample].count == axis->count;
        for (size_t i = 0; fits && i < axis->count; i++)
            axis->value[i * (size_t)axis->paths + (size_t)k] = r->vary[k].of.value[i];
    }
}

bool results_scenario(const struct results *r, struct scenario *s)
{
    const bool good = scenario_read(s, r->file, r->scenario, NULL, 0, NULL);
    if (good)
        take_points(r, s);
    return good;
}

const struct scenario *results_swept(const struct results *r, stance_message *message)
{
    const struct scenario *const s = r->read;
    bool same = s && s->axes == r->axes;
    for (int a = 0; same && a < r->axes; a++)
        same = s->axis[a].count == r->axis[a].count;
    if (!same)
        complain(message, "%.150s: the scenario in it %s", r->file,
                 s ? "has other axes than its cases" : "cannot be read");
    return same ? s : NULL;
}

void results_free_sample(struct results *r)
{
    for (int k = 0; k < r->varied; k++) {
        free(r->vary[k].of.value);
        free(r->vary[k].word);
    }
    free(r->vary);
    r->vary = NULL;
    r->varied = 0;
}
