/* basin_sample.c - reads the points of a sample of starts. */
#include "basin_sample.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static bool is_start(const char *path)
{
    return (strncmp(path, "initial.offset.", 15) == 0 ||
            strncmp(path, "initial.state.", 14) == 0) &&
           strcmp(path, "initial.offset.scale") != 0;
}

/* The range of path k of the sample's axis, where a factor moves it alone and evenly. */
static void find_range(const struct scenario *s, int k, struct basin_factor *factor)
{
    factor->from = factor->to = NAN;
    for (size_t j = 0; j < s->sample.design.factors; j++) {
        const struct scenario_factor *f = &s->sample.factor[j];
        if (f->first == k && f->paths == 1 && !f->listed && !f->log) {
            factor->from = f->value[0];
            factor->to = f->value[1];
        }
    }
}

static bool read_factors(struct basin_sample *sample, const struct results *r,
                         const struct scenario *s, const struct scenario_axis *axis)
{
    sample->factor = calloc((size_t)axis->paths, sizeof *sample->factor);
    if (!sample->factor) {
        return false;
    }
    sample->box = 1;
    for (int k = 0; k < axis->paths; k++) {
        struct basin_factor *factor = &sample->factor[sample->factors];
        if (!is_start(axis->path[k])) {
            sample->others = true;
            continue;
        }
        snprintf(factor->name, sizeof factor->name, "%s", axis->path[k]);
        snprintf(factor->unit, sizeof factor->unit, "%s", axis->meaning[k].unit);
        find_range(s, k, factor);
        factor->value = malloc(sample->points * sizeof *factor->value);
        sample->factors++;
        if (!factor->value) {
            return false;
        }
        if (results_numbers(r, factor->name, factor->value, sample->points) != sample->points) {
            return false;
        }
        sample->box *= fabs(factor->to - factor->from);
    }
    return true;
}

bool basin_sample_make(struct basin_sample *sample, const struct results *r,
                       stance_message *message)
{
    struct scenario *s = calloc(1, sizeof *s);
    const int last = r->axes - 1;
    bool good = s != NULL;

    *sample = (struct basin_sample){.axis = -1, .box = NAN};
    if (good && !r->single && strcmp(r->axis[last].name, "sample") == 0 && results_scenario(r, s)) {
        const struct scenario_axis *axis = &s->axis[s->axes - 1];
        if (s->sample.given && s->axes == r->axes && axis->count == r->axis[last].count) {
            sample->method = s->sample.design.method;
            sample->block = (size_t)sampling_block(&s->sample.design);
            sample->points = axis->count;
            good = read_factors(sample, r, s, axis);
            sample->axis = sample->factors > 0 ? last : -1;
        }
        scenario_free(s);
    }
    free(s);
    if (!good) {
        basin_sample_free(sample);
        snprintf(message->text, sizeof message->text,
                 "%.100s: its sample cannot be read, or memory does not suffice", r->file);
    }
    return good;
}

void basin_sample_free(struct basin_sample *sample)
{
    for (size_t k = 0; k < sample->factors; k++) {
        free(sample->factor[k].value);
    }
    free(sample->factor);
    *sample = (struct basin_sample){.axis = -1};
}

bool basin_sample_counts(const struct basin_sample *sample, size_t point)
{
    return sample->method != SAMPLING_SALTELLI || point % sample->block == 0 ||
           point % sample->block == sample->block - 1;
}
