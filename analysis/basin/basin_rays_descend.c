/* basin_rays_descend.c - simulates what descents from rays ask for: cases of the file's scenario
 * with other offsets than the file has. */
#include "basin_rays.h"

#include "analysis/statistics/statistics.h"
#include "runner/base/message.h"
#include "runner/plan/instruction_set.h"
#include "runner/plan/resolve.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

struct simulator {
    struct scenario s;
    struct scenario_values values;
    struct resolved_design design;
    const stance_kernel *kernel;
    stance_outcome of;
    uint64_t index; /* of the case that it is like, for its random numbers */
    int n;
    size_t offset[DESCEND_DIMENSIONS]; /* of each factor in the values */
    double half[DESCEND_DIMENSIONS];   /* of its range */
    uint64_t failed;
};

static bool simulate(void *context, size_t count, const double *z, bool *inside)
{
    struct simulator *own = context;
    stance_case *cases = calloc(count, sizeof *cases);
    stance_result *results = calloc(count, sizeof *results);
    stance_message message;
    bool good = cases && results;
    for (size_t i = 0; good && i < count; i++) {
        for (int k = 0; k < own->n; k++) {
            const double value = z[i * (size_t)own->n + (size_t)k] * own->half[k];
            memcpy((char *)&own->values + own->offset[k], &value, sizeof value);
        }
        good = resolve_case(own->s.scene, &own->values, &own->design, own->s.seed, own->index,
                            &cases[i], &message);
        scenario_case_keys(&own->s, own->index, &cases[i].grid_index, &cases[i].sample_index);
    }
    if (good)
        own->kernel->run(cases, results, count);
    for (size_t i = 0; good && i < count; i++) {
        const bool failed = results[i].status != STANCE_DONE;
        own->failed += failed;
        inside[i] = failed || results[i].outcome == own->of;
    }
    free(cases);
    free(results);
    return good;
}

/* Where the paths of the rays stand in the values, and the scale at 1. */
static bool find_paths(struct simulator *own, const struct basin_rays *rays)
{
    static const double one = 1;
    const struct scenario_axis *axis = &own->s.axis[rays->sample.axis];
    for (int j = 0; j < own->n; j++) {
        const struct basin_factor *factor = &rays->sample.factor[j];
        own->half[j] = 0.5 * fabs(factor->to - factor->from);
        for (int k = 0; k < axis->paths; k++)
            if (strcmp(axis->path[k], factor->of->name) == 0)
                own->offset[j] = axis->offset[k];
        if (!(own->half[j] > 0) || own->offset[j] == 0)
            return false; /* not by a factor of its own, over a range */
    }
    memcpy((char *)&own->values + own->s.axis[rays->scale].offset[0], &one, sizeof one);
    return true;
}

static bool begin(struct simulator *own, const struct basin_rays *rays, size_t row,
                  stance_message *message)
{
    static const stance_outcome outcome[RESULTS_OUTCOMES] = {
#define DESCEND_OUTCOME(NAME, name, number, text) [RESULTS_##NAME] = STANCE_##NAME,
        STANCE_OUTCOMES(DESCEND_OUTCOME)
#undef DESCEND_OUTCOME
    };
    const struct results *r = rays->r;
    *own = (struct simulator){.of = outcome[rays->of], .n = (int)rays->sample.factors};
    if (own->n > DESCEND_DIMENSIONS || !results_scenario(r, &own->s))
        return complain(message, "%.150s: its scenario cannot be simulated by this version",
                        r->file);
    for (int a = 0; a < r->axes; a++) {
        size_t at = 0;
        for (int k = 0; k < rays->by_axes; k++)
            at = rays->by[k] == a ? basin_rays_point(rays, row, k) : at;
        own->index = own->index * r->axis[a].count + at;
    }
    scenario_case_values(&own->s, own->index, &own->values);
    const char *isa = instruction_set();
    own->kernel =
        isa ? instruction_set_kernel(own->s.scene, stance_methods()[own->values.method]) : NULL;
    if (!own->kernel || !find_paths(own, rays)) {
        scenario_free(&own->s);
        return complain(message,
                        "%.150s: descents need a factor with a range of its own for every offset",
                        r->file);
    }
    if (!resolve_design(own->s.scene, &own->values, &own->design, message)) {
        scenario_free(&own->s);
        return false;
    }
    return true;
}

/* Unit vectors along the shortest ray and others that end, and their ends. */
static size_t choose_starts(const struct basin_rays *rays, size_t row, const struct simulator *own,
                            size_t starts, double *start, double *r)
{
    const struct basin_ray *ray = rays->ray + row * rays->sample.points;
    struct basin_reach reach;
    size_t ends = 0, chosen = 0;
    if (!basin_rays_reach(rays, row, &reach) || reach.count[RAY_CROSSES] == 0)
        return 0;
    for (size_t p = 0; p < rays->sample.points; p++) {
        const size_t others = reach.count[RAY_CROSSES];
        const bool ends_here = ray[p].end == RAY_CROSSES;
        const bool wanted =
            ends_here && ends * (starts - 1) / others < (ends + 1) * (starts - 1) / others;
        ends += ends_here;
        for (int twice = 0; twice < 2; twice++) {
            if ((twice ? !wanted : p != reach.first) || chosen == starts)
                continue;
            double square = 0;
            for (int k = 0; k < own->n; k++) {
                const double u = rays->sample.factor[k].of->value[p] / own->half[k];
                start[chosen * (size_t)own->n + (size_t)k] = u;
                square += u * u;
            }
            for (int k = 0; k < own->n; k++)
                start[chosen * (size_t)own->n + (size_t)k] /= sqrt(square);
            r[chosen++] = basin_ray_middle(&ray[p]) * sqrt(square);
        }
    }
    return chosen;
}

bool basin_rays_nearest(const struct basin_rays *rays, size_t row, size_t starts,
                        struct basin_nearest *nearest, stance_message *message)
{
    double start[DESCEND_STARTS * DESCEND_DIMENSIONS], r[DESCEND_STARTS], most = 0;
    struct simulator *own = calloc(1, sizeof *own);
    const struct results_axis *scale = &rays->r->axis[rays->scale];
    *nearest = (struct basin_nearest){.end.starts = 0};
    if (!own)
        return statistics_no_memory(rays->r, message);
    if (!begin(own, rays, row, message)) {
        free(own);
        return false;
    }
    for (size_t i = 0; i < scale->count; i++)
        most = fmax(most, scale->value[i]);
    const size_t chosen = choose_starts(rays, row, own, starts, start, r);
    const struct descend_set set = {own->n, 4 * most, simulate, own};
    const bool good = chosen == 0 || basin_descend(&set, start, r, chosen, &nearest->end) ||
                      statistics_no_memory(rays->r, message);
    nearest->failed = own->failed;
    for (int k = 0; k < own->n; k++) {
        nearest->of[k] = nearest->end.u[k] * 0.5 * (nearest->end.low + nearest->end.high);
        nearest->at[k] = nearest->of[k] * own->half[k];
    }
    scenario_free(&own->s);
    free(own);
    return good;
}

bool basin_rays_descend(struct basin_rays *rays, size_t starts, stance_message *message)
{
    rays->starts = starts;
    rays->nearest = calloc(rays->rows, sizeof *rays->nearest);
    bool good = true;
    if (!rays->nearest)
        return statistics_no_memory(rays->r, message);
    for (size_t row = 0; good && row < rays->rows; row++)
        good = basin_rays_nearest(rays, row, starts, &rays->nearest[row], message);
    return good;
}
