/* basin_volume.c - volume of an outcome in a map, its bound and its likely error; the reasoning is
 * in basin_map.h. */
#include "basin_map.h"

#include "analysis/statistics/statistics.h"

#include <math.h>
#include <stdlib.h>

/* ---- cells -------------------------------------------------------------------------------- */

/* A map as its cells, with a case at each corner. */
struct cells {
    const struct basin_map *map;
    enum results_kind of;
    uint64_t count;
    size_t along[SCENARIO_MAX_AXES];
    uint64_t case_stride[SCENARIO_MAX_AXES], cell_stride[SCENARIO_MAX_AXES];
    struct basin_flood patch; /* crossed cells that some patch has; in the queue: this one */
};

/* What the corners of a cell are. */
struct corners {
    int inside, unknown;
    uint32_t varies; /* axes along which some edge is crossed */
};

static void find_point(const struct cells *cells, uint64_t cell, size_t *point)
{
    for (int a = 0; a < cells->map->axes; a++)
        point[a] = cell / cells->cell_stride[a] % cells->along[a];
}

static uint8_t corner_kind(const struct cells *cells, const size_t *point, int corner)
{
    uint64_t index = 0;
    for (int a = 0; a < cells->map->axes; a++)
        index += (point[a] + (size_t)(corner >> a & 1)) * cells->case_stride[a];
    return cells->map->kind[index];
}

static struct corners look(const struct cells *cells, const size_t *point)
{
    const int corners = 1 << cells->map->axes;
    struct corners found = {0};
    for (int c = 0; c < corners; c++) {
        const uint8_t kind = corner_kind(cells, point, c);
        found.inside += kind == cells->of;
        found.unknown += !basin_is_known(kind);
        for (int a = 0; a < cells->map->axes; a++)
            if (!(c >> a & 1) &&
                (kind == cells->of) != (corner_kind(cells, point, c | 1 << a) == cells->of))
                found.varies |= 1u << a;
    }
    return found;
}

static double cell_volume(const struct cells *cells, const size_t *point)
{
    double volume = 1;
    for (int a = 0; a < cells->map->axes; a++)
        volume *= cells->map->place[a][point[a] + 1] - cells->map->place[a][point[a]];
    return volume;
}

/* ---- patches ------------------------------------------------------------------------------ */

/* Whether the neighbour of a cell of a patch along an axis, in direction `up`, is of the patch: it
 * shares a face with it, so it is if no edge along the axis is crossed there either. *step: by how
 * many corners more the face beyond is inside; `edge` where the map ends. */
enum { EDGE = 1 << 30 };
static bool goes_on(const struct cells *cells, uint64_t cell, int axis, bool up, int *step)
{
    size_t point[SCENARIO_MAX_AXES] = {0};
    find_point(cells, cell, point);
    *step = EDGE;
    if (up ? point[axis] + 1 == cells->along[axis] : point[axis] == 0)
        return false;
    point[axis] += up ? 1 : (size_t)-1;
    const struct corners next = look(cells, point);
    if (next.unknown == 0 && !(next.varies >> axis & 1))
        return true;
    *step = 0;
    for (int c = 0; next.unknown == 0 && c < 1 << cells->map->axes; c++) {
        const int far = (c >> axis & 1) == up ? 1 : -1;
        *step += corner_kind(cells, point, c) == cells->of ? far : 0;
    }
    return false;
}

/* Of a row of cells of a patch, from its lower end, as many as have errors that add up. */
static double row_weight(const struct cells *cells, uint64_t cell, int axis, int below)
{
    double length = 1;
    int above;
    while (goes_on(cells, cell, axis, true, &above)) {
        cell += cells->cell_stride[axis];
        length++;
    }
    const bool swept = below != EDGE && above != EDGE && below * above < 0;
    return !swept ? length : cells->map->axes == 2 ? 0 : 1;
}

/* Variance of the sum of the errors of the cells that hang together with a crossed one along the
 * axes along which their corners do not differ. */
static bool add_patch(struct cells *cells, uint64_t start, uint32_t varies, double *variance)
{
    const int axes = cells->map->axes;
    double weight[SCENARIO_MAX_AXES] = {0}, volume = 0, together = 1;
    size_t point[SCENARIO_MAX_AXES] = {0};
    int step;

    cells->patch.queued = 0;
    if (!basin_take(&cells->patch, start))
        return false;
    for (uint64_t k = 0; k < cells->patch.queued; k++) {
        const uint64_t cell = cells->patch.queue[k];
        find_point(cells, cell, point);
        volume += cell_volume(cells, point);
        for (int a = 0; a < axes; a++) {
            if (varies >> a & 1)
                continue;
            for (int up = 0; up < 2; up++) {
                const uint64_t next =
                    up ? cell + cells->cell_stride[a] : cell - cells->cell_stride[a];
                if (goes_on(cells, cell, a, up, &step)) {
                    if (!basin_take(&cells->patch, next))
                        return false;
                } else if (!up) {
                    weight[a] += row_weight(cells, cell, a, step);
                }
            }
        }
    }
    for (int a = 0; a < axes; a++)
        together *= varies >> a & 1 ? 1 : weight[a] / (double)cells->patch.queued;
    *variance += volume * together * volume * together / 12;
    return true;
}

/* ---- every other place -------------------------------------------------------------------- */

/* What place i of an axis stands for among every stride-th one: the trapezoidal rule, constant out
 * to the ends of the axis. */
static double weight_of(const struct basin_map *map, int axis, size_t stride, size_t i)
{
    const double *place = map->place[axis];
    const size_t last = map->count[axis] - 1;
    return (i >= stride ? (place[i] - place[i - stride]) / 2 : place[i] - place[0]) +
           (i + stride <= last ? (place[i + stride] - place[i]) / 2 : place[last] - place[i]);
}

/* Mean square distance from their mean of the volumes that the map's stride^axes sublattices give,
 * of which none has a place of another: volume[number]. */
static double find_scatter(const struct cells *cells, size_t stride, size_t number, double *volume)
{
    const struct basin_map *map = cells->map;
    double mean = 0, scatter = 0;
    for (size_t k = 0; k < number; k++)
        volume[k] = 0;
    for (uint64_t i = 0; i < map->cases; i++) {
        size_t which = 0;
        double weight = 1;
        for (int a = 0; map->kind[i] == cells->of && a < map->axes; a++) {
            const size_t at = i / cells->case_stride[a] % map->count[a];
            which = which * stride + at % stride;
            weight *= weight_of(map, a, stride, at);
        }
        volume[which] += map->kind[i] == cells->of ? weight : 0;
    }
    for (size_t k = 0; k < number; k++)
        mean += volume[k] / (double)number;
    for (size_t k = 0; k < number; k++)
        scatter += (volume[k] - mean) * (volume[k] - mean) / (double)number;
    return scatter;
}

/* Variance of the volume if the boundary keeps step with the lattice, as sublattices see it. */
static bool find_rhythm(const struct cells *cells, double *variance)
{
    enum { LONGEST = 3, MOST = 4096 };
    double *volume = calloc(MOST, sizeof *volume);
    *variance = 0;
    for (size_t stride = 2; volume && stride <= LONGEST; stride++) {
        const double number = pow((double)stride, cells->map->axes);
        if (cells->map->axes > 1 && number <= MOST) {
            const double scatter = find_scatter(cells, stride, (size_t)number, volume);
            *variance = fmax(*variance, scatter / (double)(stride * stride - 1));
        }
    }
    free(volume);
    return volume != NULL;
}

/* ---- the volume --------------------------------------------------------------------------- */

/* The cells without their tables; false: no memory. */
static bool begin(struct cells *cells, const struct basin_map *map, enum results_kind of)
{
    *cells = (struct cells){.map = map, .of = of, .count = 1};
    basin_strides(map, cells->case_stride);
    for (int a = map->axes - 1; a >= 0; a--) {
        cells->along[a] = map->count[a] - 1;
        cells->cell_stride[a] = cells->count;
        cells->count *= cells->along[a];
    }
    cells->patch.seen = calloc(cells->count / 8 + 1, 1);
    return cells->patch.seen != NULL;
}

bool basin_map_volume(const struct basin_map *map, enum results_kind of,
                      struct basin_volume *volume)
{
    const int corners = 1 << map->axes;
    struct cells cells;
    size_t point[SCENARIO_MAX_AXES] = {0};
    double inside = 0, known = 0;

    *volume = (struct basin_volume){.box = 1};
    for (int a = 0; a < map->axes; a++)
        volume->box *= map->place[a][map->count[a] - 1] - map->place[a][0];
    bool good = begin(&cells, map, of);
    for (uint64_t i = 0; good && i < cells.count; i++) {
        find_point(&cells, i, point);
        const struct corners at = look(&cells, point);
        const double cell = cell_volume(&cells, point);
        inside += cell * at.inside / corners;
        known += cell * (corners - at.unknown) / corners;
        volume->cells++;
        volume->low += at.inside == corners ? cell : 0;
        volume->high += at.inside + at.unknown > 0 ? cell : 0;
        if (at.inside == corners || at.inside + at.unknown == 0)
            continue;
        volume->crossed++;
        if (at.unknown > 0)
            volume->variance += cell * cell / 12;
        else if (!basin_has_taken(&cells.patch, i))
            good = add_patch(&cells, i, at.varies, &volume->variance);
    }
    double rhythm = 0;
    good = good && find_rhythm(&cells, &rhythm);
    volume->variance = fmax(volume->variance, rhythm);
    volume->estimate = known > 0 ? volume->box * inside / known : NAN;
    basin_flood_free(&cells.patch);
    return good;
}

double basin_map_deviations(double level)
{
    return fmax(statistics_deviations(level), sqrt(3) * level);
}

double basin_volume_reach(const struct basin_volume *volume, double deviations)
{
    return fmin(deviations * sqrt(volume->variance),
                fmax(volume->estimate - volume->low, volume->high - volume->estimate));
}
