/* basin_rays.h - how far from the equilibrium an outcome reaches, along rays.
 *
 * A file of rays has the grid axis initial.offset.scale and a sample of method sphere over offsets:
 * each point of the sample is a direction, and along it the offsets grow with the scale. A ray ends
 * where, coming from the smallest scale, the outcome is lost for the first time: between the last
 * case that has it and the first known one that has not. Islands beyond do not count.
 */
#ifndef STANCE_BASIN_BASIN_RAYS_H
#define STANCE_BASIN_BASIN_RAYS_H

#include "basin.h"
#include "basin_descend.h"

enum basin_ray_end {
    RAY_CROSSES, /* between low and high */
    RAY_OPEN,    /* reaches the largest scale; high is NAN */
    RAY_OUTSIDE, /* has another outcome at the smallest known scale; low is NAN */
    RAY_UNKNOWN, /* no case of it is known */
};

struct basin_ray {
    enum basin_ray_end end;
    double low, high;     /* scales */
    enum results_kind to; /* RAY_CROSSES: what becomes of the first case beyond */
};

/* The nearest end of the outcome that descents from some rays have found, see basin_descend.h. */
struct basin_nearest {
    struct descend_end end;        /* scales, where 1 is the ellipsoid within the ranges */
    double at[DESCEND_DIMENSIONS]; /* offsets of its middle */
    double of[DESCEND_DIMENSIONS]; /* the same in units of half the ranges */
    uint64_t failed;               /* simulations that did, and count as not lost */
};

struct basin_rays {
    const struct results *r;
    enum results_kind of;
    struct basin_sample sample; /* its factors are the coordinates of the directions */
    int scale;                  /* axis */
    int by[SCENARIO_MAX_AXES], by_axes;
    size_t rows;                   /* points of the other axes, row-major over by[] */
    struct basin_ray *ray;         /* [rows][sample.points] */
    size_t starts;                 /* of descents in each row, the shortest ray and others spread
                                    * evenly over those that end */
    struct basin_nearest *nearest; /* [rows], starts 0 where no ray ends; NULL: not sought */
};

/* Whether a file, with this sample of starts, is one of rays. */
bool basin_is_rays(const struct results *r, const struct basin_sample *sample);
/* Takes over the sample, also on failure (no memory). */
bool basin_rays_make(struct basin_rays *rays, const struct results *r, enum results_kind of,
                     struct basin_sample *sample, stance_message *message);
void basin_rays_free(struct basin_rays *rays);

/* Simulates cases of the file's scenario to seek the nearest end in every row, with 1 ...
 * DESCEND_STARTS starts. False: the scenario is of another version, does not let its starts be
 * changed one by one, or there is no memory. */
bool basin_rays_descend(struct basin_rays *rays, size_t starts, stance_message *message);
/* The same in one row. */
bool basin_rays_nearest(const struct basin_rays *rays, size_t row, size_t starts,
                        struct basin_nearest *nearest, stance_message *message);

/* Where the rays of a row end; distances are the middles of the brackets. */
struct basin_reach {
    size_t count[RAY_UNKNOWN + 1];    /* by enum basin_ray_end */
    size_t first;                     /* the ray that ends first; meaningless without any */
    double smallest, median, largest; /* scales; an open ray is longer than all; NAN: no ray, or
                                       * where an open ray would be the answer */
};
/* False: no memory. */
bool basin_rays_reach(const struct basin_rays *rays, size_t row, struct basin_reach *reach);

/* Middle and half width of a bracket. */
static inline double basin_ray_middle(const struct basin_ray *ray)
{
    return 0.5 * (ray->low + ray->high);
}
#endif
