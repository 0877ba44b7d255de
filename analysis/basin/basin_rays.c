/* basin_rays.c - follows each ray from the smallest scale to where the outcome is lost. */
#include "basin_rays.h"
#include "basin_map.h"

#include "analysis/statistics/statistics.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int find_scale(const struct results *r)
{
    for (int a = 0; a < r->axes; a++)
        if (strcmp(r->axis[a].name, "initial.offset.scale") == 0 && r->axis[a].count > 1)
            return a;
    return -1;
}

bool basin_is_rays(const struct results *r, const struct basin_sample *sample)
{
    return sample->axis >= 0 && sample->method == DOE_SPHERE && !sample->others &&
           find_scale(r) >= 0;
}

/* One ray: its cases are kind[place * stride]. */
static struct basin_ray follow(const struct results_axis *scale, const size_t *order,
                               const uint8_t *kind, uint64_t stride, enum results_kind of)
{
    struct basin_ray ray = {RAY_UNKNOWN, NAN, NAN, of};
    for (size_t i = 0; i < scale->count; i++) {
        const uint8_t here = kind[order[i] * stride];
        if (here == RESULTS_PENDING || here == RESULTS_FAILED)
            continue; /* the bracket grows over it */
        if (here != of) {
            ray.end = ray.end == RAY_UNKNOWN ? RAY_OUTSIDE : RAY_CROSSES;
            ray.high = scale->value[order[i]];
            ray.to = (enum results_kind)here;
            return ray;
        }
        ray.end = RAY_OPEN;
        ray.low = scale->value[order[i]];
    }
    return ray;
}

size_t basin_rays_point(const struct basin_rays *rays, size_t row, int k)
{
    for (int j = rays->by_axes - 1; j > k; j--)
        row /= rays->r->axis[rays->by[j]].count;
    return row % rays->r->axis[rays->by[k]].count;
}

static void follow_all(struct basin_rays *rays, const size_t *order)
{
    const struct results *r = rays->r;
    const struct results_axis *const scale = &r->axis[rays->scale];
    const uint64_t step = statistics_stride(r, rays->scale),
                   next = statistics_stride(r, rays->sample.axis);
    for (size_t row = 0; row < rays->rows; row++) {
        uint64_t first = 0;
        for (int k = 0; k < rays->by_axes; k++)
            first += basin_rays_point(rays, row, k) * statistics_stride(r, rays->by[k]);
        for (size_t p = 0; p < rays->sample.points; p++)
            rays->ray[row * rays->sample.points + p] =
                follow(scale, order, r->kind + first + p * next, step, rays->of);
    }
}

bool basin_rays_make(struct basin_rays *rays, const struct results *r, enum results_kind of,
                     struct basin_sample *sample, stance_message *message)
{
    *rays =
        (struct basin_rays){.r = r, .of = of, .sample = *sample, .scale = find_scale(r), .rows = 1};
    *sample = (struct basin_sample){.axis = -1};
    for (int a = 0; a < r->axes; a++) {
        if (a != rays->scale && a != rays->sample.axis) {
            rays->by[rays->by_axes++] = a;
            rays->rows *= r->axis[a].count;
        }
    }
    size_t *const order = basin_order(&r->axis[rays->scale]);
    rays->ray = malloc(rays->rows * rays->sample.points * sizeof *rays->ray);
    if (!order || !rays->ray) {
        free(order);
        basin_rays_free(rays);
        return statistics_no_memory(r, message);
    }
    follow_all(rays, order);
    free(order);
    return true;
}

void basin_rays_free(struct basin_rays *rays)
{
    basin_sample_free(&rays->sample);
    free(rays->ray);
    free(rays->nearest);
    rays->ray = NULL;
    rays->nearest = NULL;
}

bool basin_rays_reach(const struct basin_rays *rays, size_t row, struct basin_reach *reach)
{
    const struct basin_ray *ray = rays->ray + row * rays->sample.points;
    double *middle = malloc(rays->sample.points * sizeof *middle);
    size_t n = 0;

    *reach = (struct basin_reach){.smallest = NAN, .median = NAN, .largest = NAN};
    if (!middle)
        return false;
    for (size_t p = 0; p < rays->sample.points; p++) {
        reach->count[ray[p].end]++;
        if (ray[p].end != RAY_CROSSES && ray[p].end != RAY_OPEN)
            continue;
        middle[n] = ray[p].end == RAY_OPEN ? INFINITY : basin_ray_middle(&ray[p]);
        if (isfinite(middle[n]) && !(middle[n] >= reach->smallest)) { /* true against NAN */
            reach->smallest = middle[n];
            reach->first = p;
        }
        n++;
    }
    statistics_sort(middle, n);
    if (n > 0) {
        const double median = 0.5 * (middle[(n - 1) / 2] + middle[n / 2]);
        reach->median = isfinite(median) ? median : NAN;
        reach->largest = isfinite(middle[n - 1]) ? middle[n - 1] : NAN;
    }
    free(middle);
    return true;
}
