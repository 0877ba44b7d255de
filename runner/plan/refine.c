/* refine.c - cells, whether they are mixed, and what they ask for. */
#include "refine.h"

#include "runner/base/numbers.h"

#include <Random123/philox.h>

#include <stdlib.h>
#include <string.h>

enum { MAX_LEVELS = 64 };

/* A byte for each point: its label, 0 while that is unknown, and what is to be done. A cell's byte
 * has the label of all of its points that have one, or SEVERAL. */
enum {
    LABEL = 0x3f,
    SEVERAL = 0x3f, /* labels, or a point that failed */
    WANTED = 0x40,  /* a point that is to be simulated */
    MIXED = 0x40,   /* a cell */
    INFERRED = 0x80,
    NEAR = 0x80, /* a cell after a mixed one, while they are looked for */
};
_Static_assert((int)REFINE_FAILED < (int)SEVERAL, "outcomes have room beside the other bits");

/* The label of cells or points together. */
static inline uint8_t both(uint8_t a, uint8_t b)
{
    return a == 0 ? b : b == 0 || a == b ? a : SEVERAL;
}

/* Cells of one level; along axes that are not refined a cell is a point. */
struct level {
    size_t cells[SCENARIO_MAX_AXES];
    size_t stride[SCENARIO_MAX_AXES];
    uint64_t total;
    uint8_t *cell; /* [total]; MIXED stands for refined in the end */
};

struct refine {
    struct refine_map map;
    uint64_t points;
    uint8_t *point, *scratch; /* [points] */
    int levels;
    struct level level[MAX_LEVELS];
};

/* ---- the map ------------------------------------------------------------------------------ */

struct refine_map refine_map_of(const struct scenario *scenario)
{
    const struct scenario_refine *asked = &scenario->refine;
    struct refine_map map = {.axes = scenario->axes,
                             .start = asked->start,
                             .margin = asked->margin,
                             .probes = asked->probes,
                             .seed = scenario->seed};
    for (int a = 0; a < scenario->axes; a++) {
        map.count[a] = scenario->axis[a].count;
        map.refined[a] = scenario->axis[a].refined;
        map.samples = scenario->axis[a].sample ? map.count[a] : 0;
    }
    return map;
}

static size_t quotient_up(size_t a, size_t b)
{
    return a / b + (a % b > 0);
}

static size_t coarsest_stride(const struct refine_map *map, int a)
{
    size_t stride = 1;
    while (map->refined[a] && map->count[a] > stride * map->start)
        stride *= 2;
    return stride;
}

uint64_t refine_coarse(const struct refine_map *map)
{
    uint64_t points = 1;
    for (int a = 0; a < map->axes; a++)
        points *= quotient_up(map->count[a] - 1, coarsest_stride(map, a)) + 1;
    return points;
}

/* ---- boxes of points ---------------------------------------------------------------------- */

/* Points low, low + step, ... along each axis, and high. */
struct box {
    size_t low[SCENARIO_MAX_AXES], high[SCENARIO_MAX_AXES], step[SCENARIO_MAX_AXES];
};

/* Adds bits to those points of a box whose label is not known. */
static void mark(struct refine *refine, const struct box *box, uint8_t bits)
{
    const struct refine_map *map = &refine->map;
    const int last = map->axes - 1;
    size_t at[SCENARIO_MAX_AXES];

    memcpy(at, box->low, sizeof at);
    for (int a = 0; a >= 0;) { /* line by line, until no axis is left to go on along */
        uint64_t line = 0;
        for (a = 0; a < last; a++)
            line = (line + at[a]) * map->count[a + 1];
        for (size_t i = box->low[last];; i = smaller(i + box->step[last], box->high[last])) {
            uint8_t *point = &refine->point[line + i];
            *point = (uint8_t)(*point | (*point & LABEL ? 0 : bits));
            if (i == box->high[last])
                break;
        }
        for (a = last - 1; a >= 0 && at[a] == box->high[a]; a--)
            at[a] = box->low[a];
        if (a >= 0)
            at[a] = smaller(at[a] + box->step[a], box->high[a]);
    }
}

/* Place of a cell along each axis. */
static void cell_place(const struct refine *refine, const struct level *level, uint64_t cell,
                       size_t *place)
{
    for (int a = refine->map.axes - 1; a >= 0; a--) {
        place[a] = (size_t)(cell % level->cells[a]);
        cell /= level->cells[a];
    }
}

/* The points of a cell; `step`: strides of the lattice, NULL for all points. */
static struct box cell_box(const struct refine *refine, const struct level *level,
                           const size_t *place, const size_t *step)
{
    const struct refine_map *map = &refine->map;
    struct box box = {{0}, {0}, {0}};
    for (int a = 0; a < map->axes; a++) {
        const size_t stride = level->stride[a];
        box.low[a] = place[a] * stride;
        box.high[a] = map->refined[a] ? smaller(box.low[a] + stride, map->count[a] - 1) : place[a];
        box.step[a] = step ? step[a] : 1;
    }
    return box;
}

/* ---- making ------------------------------------------------------------------------------- */

/* Strides and cells of every level. False: not enough memory. */
static bool make_levels(struct refine *refine)
{
    const struct refine_map *map = &refine->map;
    size_t coarsest[SCENARIO_MAX_AXES] = {0}, most = 1;
    for (int a = 0; a < map->axes; a++) {
        coarsest[a] = coarsest_stride(map, a);
        most = coarsest[a] > most ? coarsest[a] : most;
    }
    for (; most >> refine->levels > 1; refine->levels++) {
        struct level *level = &refine->level[refine->levels];
        level->total = 1;
        for (int a = 0; a < map->axes; a++) {
            const size_t stride = coarsest[a] >> refine->levels;
            level->stride[a] = stride > 1 ? stride : 1;
            level->cells[a] =
                map->refined[a] ? quotient_up(map->count[a] - 1, level->stride[a]) : map->count[a];
            level->total *= level->cells[a];
        }
        level->cell = malloc(level->total);
        if (!level->cell)
            return false;
    }
    return true;
}

struct refine *refine_make(const struct refine_map *map)
{
    struct refine *refine = calloc(1, sizeof *refine);
    struct box whole = {{0}, {0}, {0}};

    if (!refine)
        return NULL;
    refine->map = *map;
    refine->points = 1;
    for (int a = 0; a < map->axes; a++) {
        refine->points *= map->count[a];
        whole.low[a] = 0;
        whole.high[a] = map->count[a] - 1;
        whole.step[a] = coarsest_stride(map, a);
    }
    refine->point = calloc(refine->points, 1);
    refine->scratch = malloc(refine->points);
    if (!refine->point || !refine->scratch || !make_levels(refine)) {
        refine_free(refine);
        return NULL;
    }
    mark(refine, &whole, WANTED);
    const philox4x64_key_t key = {{map->seed, 0x726566696e65}};
    const uint64_t samples = map->samples ? map->samples : 1;
    for (uint64_t row = 0; map->probes > 0 && row < refine->points; row++) {
        const philox4x64_ctr_t counter = {{row / samples, row % samples, 0, 0}};
        const philox4x64_ctr_t random = philox4x64(counter, key);
        if ((double)(random.v[0] >> 11) * 0x1p-53 < map->probes)
            refine_want(refine, row);
    }
    return refine;
}

void refine_free(struct refine *refine)
{
    for (int l = 0; refine && l < MAX_LEVELS; l++)
        free(refine->level[l].cell);
    if (refine) {
        free(refine->point);
        free(refine->scratch);
    }
    free(refine);
}

void refine_want(struct refine *refine, uint64_t row)
{
    refine->point[row] |= WANTED;
}

/* ---- cells -------------------------------------------------------------------------------- */

/* An array as [outer][length][inner] about one of its axes. */
struct shape {
    size_t outer, length, inner;
};

static struct shape shape_about(const size_t *lengths, int axes, int a)
{
    struct shape shape = {1, lengths[a], 1};
    for (int k = 0; k < a; k++)
        shape.outer *= lengths[k];
    for (int k = a + 1; k < axes; k++)
        shape.inner *= lengths[k];
    return shape;
}

/* Puts the labels together of `ratio` neighbours along an axis, and of `more` beyond them, in
 * place: what is written is never read again. The axis gets `result` members. */
static void unite(uint8_t *array, struct shape shape, size_t ratio, size_t more, size_t result)
{
    for (size_t o = 0; o < shape.outer; o++) {
        for (size_t k = 0; k < result; k++) {
            const size_t first = k * ratio, end = smaller(first + ratio + more, shape.length);
            uint8_t *to = array + (o * result + k) * shape.inner;
            const uint8_t *from = array + (o * shape.length + first) * shape.inner;
            for (size_t i = 0; i < shape.inner; i++) {
                uint8_t label = from[i];
                for (size_t j = 1; j < end - first; j++)
                    label = both(label, from[j * shape.inner + i]);
                to[i] = label;
            }
        }
    }
}

/* Marks what is within `margin` of something marked, along one axis: forwards, then backwards. */
static void widen(uint8_t *cell, struct shape shape, size_t margin)
{
    for (size_t line = 0; line < shape.outer * shape.inner; line++) {
        uint8_t *at = cell + line / shape.inner * shape.length * shape.inner + line % shape.inner;
        size_t left = 0; /* cells that are still near */
        for (size_t k = 0; k < 2 * shape.length; k++) {
            const bool back = k >= shape.length;
            uint8_t *one = at + (back ? 2 * shape.length - 1 - k : k) * shape.inner;
            left = *one & MIXED ? margin + 1 : k == shape.length ? 0 : left;
            *one |= left > 0 ? NEAR : 0;
            if (back)
                *one = (uint8_t)((*one & LABEL) | (*one & NEAR ? MIXED : 0));
            left -= left > 0;
        }
    }
}

/* Which cells are refined, and the label of each, from what is known. */
static void look_at_cells(struct refine *refine)
{
    const struct refine_map *map = &refine->map;
    size_t lengths[SCENARIO_MAX_AXES];

    for (uint64_t i = 0; i < refine->points; i++) {
        const uint8_t label = refine->point[i] & INFERRED ? 0 : refine->point[i] & LABEL;
        refine->scratch[i] = label == REFINE_FAILED ? SEVERAL : label;
    }
    memcpy(lengths, map->count, sizeof lengths);
    for (int l = refine->levels - 1; l >= 0; l--) {
        struct level *level = &refine->level[l];
        const bool points = l == refine->levels - 1;
        for (int a = 0; a < map->axes; a++) {
            const size_t ratio = level->stride[a] / (points ? 1 : refine->level[l + 1].stride[a]);
            if (map->refined[a]) {
                unite(refine->scratch, shape_about(lengths, map->axes, a), ratio, points,
                      level->cells[a]);
                lengths[a] = level->cells[a];
            }
        }
        for (uint64_t c = 0; c < level->total; c++) {
            const uint8_t label = refine->scratch[c];
            level->cell[c] = (uint8_t)(label | (label == SEVERAL ? MIXED : 0));
        }
        for (int a = 0; map->margin > 0 && a < map->axes; a++)
            if (map->refined[a])
                widen(level->cell, shape_about(level->cells, map->axes, a), map->margin);
    }
}

/* ---- rounds ------------------------------------------------------------------------------- */

static size_t list_wanted(const struct refine *refine, uint64_t *rows, size_t room)
{
    size_t n = 0;
    for (uint64_t i = 0; n < room && i < refine->points; i++)
        if (refine->point[i] == WANTED)
            rows[n++] = i;
    return n;
}

size_t refine_next(struct refine *refine, uint64_t *rows, size_t room)
{
    size_t place[SCENARIO_MAX_AXES], n = list_wanted(refine, rows, room);

    if (n > 0)
        return n;
    look_at_cells(refine);
    for (int l = 0; l < refine->levels; l++) {
        const struct level *level = &refine->level[l];
        const bool last = l + 1 == refine->levels;
        for (uint64_t c = 0; c < level->total; c++) {
            if (level->cell[c] & MIXED) {
                cell_place(refine, level, c, place);
                const struct box box =
                    cell_box(refine, level, place, last ? NULL : refine->level[l + 1].stride);
                mark(refine, &box, WANTED);
            }
        }
    }
    return list_wanted(refine, rows, room);
}

void refine_set(struct refine *refine, uint64_t row, int label)
{
    refine->point[row] = (uint8_t)label;
}

/* ---- the rest ----------------------------------------------------------------------------- */

/* Whether the cell of the level before that holds a cell is refined. */
static bool parent_refined(const struct refine *refine, int l, const size_t *place)
{
    if (l == 0)
        return true;
    const struct level *level = &refine->level[l], *parent = &refine->level[l - 1];
    uint64_t c = 0;
    for (int a = 0; a < refine->map.axes; a++)
        c = c * parent->cells[a] + place[a] / (parent->stride[a] / level->stride[a]);
    return (parent->cell[c] & MIXED) != 0;
}

void refine_infer(struct refine *refine)
{
    size_t place[SCENARIO_MAX_AXES];

    look_at_cells(refine);
    for (int l = 0; l < refine->levels; l++) {
        const struct level *level = &refine->level[l];
        for (uint64_t c = 0; c < level->total; c++) {
            if (level->cell[c] & MIXED)
                continue;
            cell_place(refine, level, c, place);
            if (parent_refined(refine, l, place)) {
                const struct box box = cell_box(refine, level, place, NULL);
                mark(refine, &box, (uint8_t)(level->cell[c] | INFERRED));
            }
        }
    }
}

int refine_label(const struct refine *refine, uint64_t row)
{
    return refine->point[row] & LABEL;
}

bool refine_inferred(const struct refine *refine, uint64_t row)
{
    return (refine->point[row] & INFERRED) != 0;
}
