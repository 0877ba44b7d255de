/* basin_rays_descend.c - simulates what descents from rays ask for: cases of the file's scenario
 * with other offsets than the file has. */
#include "basin_rays.h"
#include "basin_starts.h"

#include "analysis/statistics/statistics.h"
#include "runner/base/message.h"
#include "runner/base/progress.h"
#include "runner/base/units.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

struct simulator {
    struct starts starts;
    double half[DESCEND_DIMENSIONS]; /* of the range of each factor */
    size_t row, rows;                /* of the table */
    struct progress progress;
};

static void tell(void *context, uint64_t more)
{
    struct simulator *own = context;
    if (progress_due(&own->progress, clock_seconds()))
        progress_say(&own->progress, "row %zu of %zu: %" PRIu64 " simulations", own->row + 1,
                     own->rows, more);
}

/* Where the paths of the rays stand in the values; false: one is not moved by a factor of its own,
 * over a range. */
static bool find_paths(struct simulator *own, const struct basin_rays *rays)
{
    const struct scenario_axis *axis = &rays->r->read->axis[rays->sample.axis];
    for (int j = 0; j < own->starts.axes; j++) {
        const struct basin_factor *factor = &rays->sample.factor[j];
        struct starts_field *const field = &own->starts.field[own->starts.fields++];
        own->half[j] = 0.5 * fabs(factor->to - factor->from);
        *field = (struct starts_field){.axis = j, .along = own->half[j]};
        for (int k = 0; k < axis->paths; k++)
            if (strcmp(axis->path[k], factor->of->name) == 0)
                field->offset = axis->offset[k];
        if (!(own->half[j] > 0) || field->offset == 0)
            return false;
    }
    return true;
}

static bool begin(struct simulator *own, const struct basin_rays *rays, size_t row,
                  stance_message *message)
{
    const struct results *r = rays->r;
    *own = (struct simulator){.starts = {.tell = tell, .context = own},
                              .row = row,
                              .rows = rays->rows,
                              .progress = progress_begin(false)};
    if (rays->sample.factors > DESCEND_DIMENSIONS || !r->read)
        return complain(message, "%.150s: its scenario cannot be simulated by this version",
                        r->file);
    size_t point[SCENARIO_MAX_AXES];
    const uint64_t index = statistics_row(r, rays->by, rays->by_axes, row, point);
    const bool good = starts_begin(&own->starts, r->read, index, message);
    own->starts.axes = (int)rays->sample.factors;
    return good && (find_paths(own, rays) ||
                    complain(message,
                             "%.150s: descents need a factor with a range of its own for every "
                             "offset",
                             r->file));
}

/* Unit vectors along the shortest ray and others that end, and their ends. */
static size_t choose_starts(const struct basin_rays *rays, size_t row, const struct simulator *own,
                            size_t starts, double *start, double *r)
{
    const struct basin_ray *ray = rays->ray + row * rays->sample.points;
    struct basin_reach reach;
    const size_t n = rays->sample.factors;
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
            for (size_t k = 0; k < n; k++) {
                const double u = rays->sample.factor[k].of->value[p] / own->half[k];
                start[chosen * n + k] = u;
                square += u * u;
            }
            for (size_t k = 0; k < n; k++)
                start[chosen * n + k] /= sqrt(square);
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
    /* Starts whose simulation fails count as inside: a shorter distance is not made up. */
    const uint64_t inside = UINT64_C(1) << starts_outcome(rays->of) | UINT64_C(1) << STARTS_FAILED;
    const struct descend_set set = {own->starts.axes, inside, starts_run, &own->starts};
    const bool good = chosen == 0 ||
                      basin_descend(&set, 4 * most, start, r, chosen, &nearest->end) ||
                      statistics_no_memory(rays->r, message);
    nearest->failed = own->starts.failed;
    for (int k = 0; k < own->starts.axes; k++) {
        nearest->of[k] = nearest->end.u[k] * 0.5 * (nearest->end.low + nearest->end.high);
        nearest->at[k] = nearest->of[k] * own->half[k];
    }
    progress_end(&own->progress);
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
