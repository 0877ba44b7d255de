/* basin_sample.c - reads the points of a sample of starts. */
#include "basin_sample.h"

#include "analysis/statistics/statistics.h"
#include "runner/base/message.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The range of a path, where a factor moves it alone and evenly. */
static void find_range(const struct scenario *s, int path, struct basin_factor *factor)
{
    for (size_t j = 0; j < s->sample.design.factors; j++) {
        const struct scenario_factor *f = &s->sample.factor[j];
        if (f->first == path && f->paths == 1 && !f->listed && !f->log) {
            factor->from = f->value[0];
            factor->to = f->value[1];
        }
    }
}

static void take_factors(struct basin_sample *sample, const struct results *r,
                         const struct scenario *s)
{
    sample->box = 1;
    for (int k = 0; k < r->varied; k++) {
        struct basin_factor *factor = &sample->factor[sample->factors];
        if (!scenario_is_start(r->vary[k].of.name)) {
            sample->others = true;
            continue;
        }
        *factor = (struct basin_factor){&r->vary[k].of, NAN, NAN};
        find_range(s, k, factor);
        sample->box *= fabs(factor->to - factor->from);
        sample->factors++;
    }
    sample->axis = sample->factors > 0 ? r->sample : -1;
}

bool basin_sample_make(struct basin_sample *sample, const struct results *r,
                       stance_message *message)
{
    *sample = (struct basin_sample){.axis = -1, .box = NAN};
    if (r->sample < 0)
        return true;
    const struct scenario *const s = r->read;
    sample->factor = calloc((size_t)r->varied + 1, sizeof *sample->factor);
    sample->points = r->axis[r->sample].count;
    const bool good = s && sample->factor;
    if (good && s->sample.given) {
        sample->method = s->sample.design.method;
        sample->block = (size_t)doe_block(&s->sample.design);
        take_factors(sample, r, s);
    }
    if (good)
        return true;
    basin_sample_free(sample);
    return complain(message, "%.100s: its scenario cannot be read, or memory does not suffice",
                    r->file);
}

void basin_sample_free(struct basin_sample *sample)
{
    free(sample->factor);
    *sample = (struct basin_sample){.axis = -1};
}

bool basin_sample_counts(const struct basin_sample *sample, size_t point)
{
    return sample->method != DOE_SALTELLI || point % sample->block == 0 ||
           point % sample->block == sample->block - 1;
}
