/* basin_map.c - entropy, uncertainty and boundary of a map of outcomes. */
#include "basin_map.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

bool basin_next_point(int axes, const size_t *count, size_t *point)
{
    for (int a = axes - 1; a >= 0; a--) {
        if (++point[a] < count[a])
            return true;
        point[a] = 0;
    }
    return false;
}

bool basin_take(struct basin_flood *flood, uint64_t number)
{
    if (basin_has_taken(flood, number))
        return true;
    if (flood->queued == flood->room) {
        const uint64_t room = flood->room ? 2 * flood->room : 256;
        uint64_t *const queue = realloc(flood->queue, room * sizeof *queue);
        if (!queue)
            return false;
        flood->queue = queue;
        flood->room = room;
    }
    flood->seen[number / 8] |= (uint8_t)(1 << number % 8);
    flood->queue[flood->queued++] = number;
    return true;
}

void basin_flood_free(struct basin_flood *flood)
{
    free(flood->seen);
    free(flood->queue);
}

void basin_strides(const struct basin_map *map, uint64_t stride[SCENARIO_MAX_AXES])
{
    uint64_t product = 1;
    for (int a = map->axes - 1; a >= 0; a--) {
        stride[a] = product;
        product *= map->count[a];
    }
}

uint64_t basin_index(const struct basin_map *map, const uint64_t *stride, const size_t *point)
{
    uint64_t index = 0;
    for (int a = 0; a < map->axes; a++)
        index += point[a] * stride[a];
    return index;
}

/* The tile of a point: the map is cut into BASIN_TILES along its first axes. */
static int tile_of(int axes, const size_t *point, const size_t *count)
{
    enum { SIDE = 4 };
    _Static_assert(SIDE * SIDE == BASIN_TILES, "a square of tiles");
    if (axes < 1)
        return 0;
    return axes == 1 ? (int)(point[0] * BASIN_TILES / count[0])
                     : (int)(point[0] * SIDE / count[0] * SIDE + point[1] * SIDE / count[1]);
}

/* ---- entropy ------------------------------------------------------------------------------ */

void basin_map_entropy(const struct basin_map *map, size_t side, struct basin_entropy *entropy)
{
    uint64_t stride[SCENARIO_MAX_AXES];
    size_t boxes[SCENARIO_MAX_AXES] = {0}, box[SCENARIO_MAX_AXES] = {0}, sides[SCENARIO_MAX_AXES];

    basin_strides(map, stride);
    for (int a = 0; a < map->axes; a++) {
        boxes[a] = map->count[a] / side;
        sides[a] = side;
        if (boxes[a] == 0)
            return;
    }
    do {
        uint64_t counts[RESULTS_KIND_COUNT] = {0}, total = 0;
        const uint64_t first = side * basin_index(map, stride, box);
        size_t within[SCENARIO_MAX_AXES] = {0};
        do {
            counts[map->kind[first + basin_index(map, stride, within)]]++;
        } while (basin_next_point(map->axes, sides, within));
        double sum = 0;
        int colours = 0;
        for (int k = 0; k < RESULTS_KIND_COUNT; k++)
            total += basin_is_known((uint8_t)k) ? counts[k] : 0;
        for (int k = 0; k < RESULTS_KIND_COUNT; k++) {
            if (basin_is_known((uint8_t)k) && counts[k] > 0) {
                double p = (double)counts[k] / (double)total;
                sum -= p * log(p);
                colours++;
            }
        }
        const int tile = tile_of(map->axes, box, boxes);
        entropy->boxes += total > 0;
        entropy->mixed += colours > 1;
        entropy->sum += colours > 1 ? sum : 0;
        entropy->tile_mixed[tile] += colours > 1;
        entropy->tile_sum[tile] += colours > 1 ? sum : 0;
    } while (basin_next_point(map->axes, boxes, box));
}

double basin_entropy(const struct basin_entropy *entropy)
{
    return entropy->boxes > 0 ? entropy->sum / (double)entropy->boxes : NAN;
}

double basin_boundary_entropy(const struct basin_entropy *entropy)
{
    return entropy->mixed > 0 ? entropy->sum / (double)entropy->mixed : NAN;
}

/* ---- uncertainty -------------------------------------------------------------------------- */

int basin_map_scales(const struct basin_map *map)
{
    enum { PART = 12 }; /* of the shortest axis: the longest distance */
    size_t shortest = map->count[0];
    int scales = 0;
    for (int a = 1; a < map->axes; a++)
        shortest = map->count[a] < shortest ? map->count[a] : shortest;
    while (scales < BASIN_SCALES && ((size_t)PART << scales) <= shortest)
        scales++;
    return scales;
}

/* Looks at the neighbours of a case at a distance; false when all that are known agree with it. */
static bool is_uncertain(const struct basin_map *map, const uint64_t *stride, uint64_t index,
                         size_t distance)
{
    for (int a = 0; a < map->axes; a++) {
        const uint64_t step = distance * stride[a];
        const uint8_t below = map->kind[index - step], above = map->kind[index + step];
        if ((basin_is_known(below) && below != map->kind[index]) ||
            (basin_is_known(above) && above != map->kind[index]))
            return true;
    }
    return false;
}

void basin_map_uncertainty(const struct basin_map *map, struct basin_uncertainty *uncertainty)
{
    uint64_t stride[SCENARIO_MAX_AXES];
    size_t inner[SCENARIO_MAX_AXES] = {0}, point[SCENARIO_MAX_AXES] = {0},
           margin[SCENARIO_MAX_AXES];
    if (uncertainty->scales == 0)
        return;
    basin_strides(map, stride);
    for (int a = 0; a < map->axes; a++) {
        margin[a] = (size_t)1 << (uncertainty->scales - 1);
        inner[a] = map->count[a] - 2 * margin[a];
    }
    const uint64_t first = basin_index(map, stride, margin);
    do {
        const uint64_t index = first + basin_index(map, stride, point);
        if (!basin_is_known(map->kind[index]))
            continue;
        const int tile = tile_of(map->axes, point, inner);
        for (int k = 0; k < uncertainty->scales; k++) {
            const bool uncertain = is_uncertain(map, stride, index, (size_t)1 << k);
            uncertainty->counted[k]++;
            uncertainty->uncertain[k] += uncertain;
            uncertainty->tile[k][tile] += uncertain;
        }
    } while (basin_next_point(map->axes, inner, point));
}

/* ---- the boundary ------------------------------------------------------------------------- */

bool basin_next_crossing(const struct basin_map *map, struct basin_crossing *crossing)
{
    uint64_t stride[SCENARIO_MAX_AXES];
    basin_strides(map, stride);
    for (;;) {
        if (++crossing->axis == map->axes) {
            crossing->axis = 0;
            crossing->index++;
            if (!basin_next_point(map->axes, map->count, crossing->point))
                return false;
        }
        const int a = crossing->axis;
        const size_t i = crossing->point[a];
        const uint8_t kind = map->kind[crossing->index];
        if (i + 1 == map->count[a] || !basin_is_known(kind))
            continue;
        const uint8_t next = map->kind[crossing->index + stride[a]];
        if (next == kind || !basin_is_known(next))
            continue;
        crossing->from = (enum results_kind)kind;
        crossing->to = (enum results_kind)next;
        crossing->middle = 0.5 * (map->place[a][i] + map->place[a][i + 1]);
        crossing->half_width = 0.5 * (map->place[a][i + 1] - map->place[a][i]);
        return true;
    }
}
