/* basin_domain.c - the part of an outcome that the equilibrium lies in, and how far it is to its
 * boundary; see basin_map.h. */
#include "basin_map.h"

#include "analysis/statistics/statistics.h"
#include "runner/scenario/doe.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- the part that hangs together --------------------------------------------------------- */

/* Cases that are taken into the part, of which those in the queue are to be looked at. */
struct flood {
    const struct basin_map *map;
    uint64_t stride[SCENARIO_MAX_AXES];
    uint8_t *kind; /* what the map has; the outcome is left to the part alone */
    struct basin_flood of;
};

static bool spread(struct flood *flood, enum results_kind of, struct basin_part *part)
{
    const struct basin_map *map = flood->map;
    while (flood->of.queued > 0) {
        const uint64_t index = flood->of.queue[--flood->of.queued];
        for (int side = 0; side < 2 * map->axes; side++) {
            const int a = side / 2;
            const size_t at = index / flood->stride[a] % map->count[a];
            if (at == (side % 2 ? map->count[a] - 1 : 0)) {
                part->faces |= (uint64_t)1 << side;
                continue;
            }
            const uint64_t next = side % 2 ? index + flood->stride[a] : index - flood->stride[a];
            part->unknown = part->unknown || !basin_is_known(map->kind[next]);
            if (map->kind[next] == of && !basin_take(&flood->of, next))
                return false;
        }
    }
    return true;
}

/* The volume of what has been seen: the outcome elsewhere becomes another one. */
static bool measure(struct flood *flood, enum results_kind of, struct basin_volume *volume)
{
    const struct basin_map *map = flood->map;
    const uint8_t other = of == RESULTS_FELL ? RESULTS_UNDECIDED : RESULTS_FELL;
    struct basin_map own = *map;
    for (uint64_t i = 0; i < map->cases; i++) {
        const bool seen = basin_has_taken(&flood->of, i);
        flood->kind[i] = map->kind[i] == of && !seen ? other : map->kind[i];
    }
    own.kind = flood->kind;
    return basin_map_volume(&own, of, volume);
}

bool basin_map_part(const struct basin_map *map, enum results_kind of, const size_t *origin,
                    struct basin_part *part)
{
    struct flood flood = {
        .map = map, .kind = malloc(map->cases), .of = {.seen = calloc(map->cases / 8 + 1, 1)}};
    *part = (struct basin_part){.inside = false};
    basin_strides(map, flood.stride);
    const uint64_t first = basin_index(map, flood.stride, origin);
    part->inside = map->kind[first] == of;
    part->unknown = !basin_is_known(map->kind[first]);
    const bool good = flood.kind && flood.of.seen &&
                      (!part->inside || basin_take(&flood.of, first)) && spread(&flood, of, part) &&
                      measure(&flood, of, &part->volume);
    free(flood.kind);
    basin_flood_free(&flood.of);
    return good;
}

/* ---- the nearest point of the boundary ---------------------------------------------------- */

static void find_nearest(const struct basin_map *map, enum results_kind of, const double *weight,
                         struct basin_distance *distance)
{
    struct basin_crossing crossing = {.axis = -1};
    while (basin_next_crossing(map, &crossing)) {
        double at[SCENARIO_MAX_AXES], sum = 0;
        if ((crossing.from == of) == (crossing.to == of))
            continue; /* between two others */
        for (int a = 0; a < map->axes; a++) {
            at[a] = a == crossing.axis ? crossing.middle : map->place[a][crossing.point[a]];
            sum += pow(at[a] / weight[a], 2);
        }
        if (!(sqrt(sum) >= distance->nearest)) { /* true for the first, against NAN */
            distance->nearest = sqrt(sum);
            memcpy(distance->at, at, sizeof at);
        }
    }
}

/* Distance of the nearest face or unknown case. */
static double find_clear(const struct basin_map *map, const double *weight)
{
    double least = INFINITY;
    size_t point[SCENARIO_MAX_AXES] = {0};
    uint64_t index = 0;
    for (int a = 0; a < map->axes; a++) {
        const double *place = map->place[a];
        least = fmin(least, fmin(-place[0], place[map->count[a] - 1]) / weight[a]);
    }
    do {
        double sum = 0;
        for (int a = 0; !basin_is_known(map->kind[index]) && a < map->axes; a++)
            sum += pow(map->place[a][point[a]] / weight[a], 2);
        least = basin_is_known(map->kind[index]) ? least : fmin(least, sqrt(sum));
        index++;
    } while (basin_next_point(map->axes, map->count, point));
    return least;
}

/* ---- directions --------------------------------------------------------------------------- */

/* Follows x = t step[] from zero through the map, each case standing for all that is nearer to it
 * than to its neighbours, along a ray one of them after the other (J. Amanatides, A. Woo, A fast
 * voxel traversal algorithm, Eurographics 1987). Returns the t at which the outcome is lost;
 * *leaves: it is not, up to the end of the box or an unknown case. */
static double follow(const struct basin_map *map, enum results_kind of, const size_t *origin,
                     const double *step, bool *leaves)
{
    uint64_t stride[SCENARIO_MAX_AXES];
    size_t point[SCENARIO_MAX_AXES];
    basin_strides(map, stride);
    memcpy(point, origin, sizeof point[0] * (size_t)map->axes);
    for (;;) {
        double first = INFINITY;
        int along = 0;
        for (int a = 0; a < map->axes; a++) {
            const double *place = map->place[a] + point[a];
            const bool last = point[a] == (step[a] > 0 ? map->count[a] - 1 : 0);
            const double wall = last          ? place[0]
                                : step[a] > 0 ? 0.5 * (place[0] + place[1])
                                              : 0.5 * (place[0] + place[-1]);
            const double t = step[a] != 0 ? fmax(0, wall / step[a]) : INFINITY;
            if (t < first) {
                first = t;
                along = a;
            }
        }
        *leaves = point[along] == (step[along] > 0 ? map->count[along] - 1 : 0);
        if (*leaves)
            return first;
        point[along] += step[along] > 0 ? 1 : (size_t)-1;
        const uint8_t kind = map->kind[basin_index(map, stride, point)];
        *leaves = !basin_is_known(kind);
        if (kind != of)
            return first;
    }
}

static double median_of(double *value, size_t n)
{
    statistics_sort(value, n);
    const double median = 0.5 * (value[(n - 1) / 2] + value[n / 2]);
    return isfinite(median) ? median : NAN;
}

static bool follow_all(const struct basin_map *map, enum results_kind of, const size_t *origin,
                       const double *weight, struct basin_distance *distance)
{
    const size_t n = map->axes == 1 ? 2 : BASIN_DIRECTIONS;
    struct doe sphere = {.method = DOE_SPHERE, .count = n, .factors = (size_t)map->axes, .seed = 1};
    double *end = malloc(2 * n * sizeof *end), *least = end + n;
    bool good = end && (map->axes == 1 || doe_begin(&sphere));
    for (size_t k = 0; good && k < n; k++) {
        double step[SCENARIO_MAX_AXES] = {k > 0}; /* along one axis: down, and up */
        bool leaves;
        if (map->axes > 1)
            doe_unit(&sphere, k, step);
        for (int a = 0; a < map->axes; a++)
            step[a] = (2 * step[a] - 1) * weight[a];
        least[k] = follow(map, of, origin, step, &leaves);
        end[k] = leaves ? INFINITY : least[k];
        distance->leave += leaves;
    }
    if (good) {
        distance->directions = n;
        distance->median = median_of(end, n);
        distance->median_least = median_of(least, n);
    }
    if (map->axes > 1)
        doe_end(&sphere);
    free(end);
    return good;
}

/* ---- all of it ---------------------------------------------------------------------------- */

/* Along each axis. */
static void find_extent(const struct basin_map *map, enum results_kind of, const size_t *origin,
                        struct basin_distance *distance)
{
    for (int side = 0; side < 2 * map->axes; side++) {
        const int a = side / 2, up = side % 2;
        double step[SCENARIO_MAX_AXES] = {0}, end = NAN;
        bool leaves = true;
        step[a] = up ? 1 : -1;
        if (distance->inside)
            end = follow(map, of, origin, step, &leaves);
        *(up ? &distance->high[a] : &distance->low[a]) = leaves ? NAN : up ? end : 0 - end;
    }
}

bool basin_map_distance(const struct basin_map *map, enum results_kind of, const size_t *origin,
                        const double *weight, struct basin_distance *distance)
{
    uint64_t stride[SCENARIO_MAX_AXES];
    basin_strides(map, stride);
    *distance = (struct basin_distance){.inside = map->kind[basin_index(map, stride, origin)] == of,
                                        .nearest = NAN,
                                        .clear = NAN,
                                        .median = NAN,
                                        .median_least = NAN};
    find_extent(map, of, origin, distance);
    if (!distance->inside)
        return true;
    find_nearest(map, of, weight, distance);
    distance->clear = find_clear(map, weight);
    return follow_all(map, of, origin, weight, distance);
}
