/* basin.c - cuts a results file into maps over the starts and sums up what these say. */
#include "basin_print.h"

#include "analysis/statistics/intervals.h"
#include "analysis/statistics/statistics.h"
#include "runner/base/message.h"
#include "runner/scenario/mend.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- sampled starts ----------------------------------------------------------------------- */

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

/* Whether a point counts towards shares: of Saltelli's blocks only the first and the last points,
 * which are evenly distributed over the box; the others repeat their coordinates. */
static bool counts(const struct basin_sample *sample, size_t point)
{
    return sample->method != DOE_SALTELLI || point % sample->block == 0 ||
           point % sample->block == sample->block - 1;
}

/* ---- which axis is what ------------------------------------------------------------------- */

static bool is_start(const struct results_axis *axis)
{
    return !axis->word && scenario_is_start(axis->name);
}

const char *basin_meant(const struct results *r, const char *word, char text[128])
{
    enum { MOST = SCENARIO_MAX_AXES + 256 };
    const char *known[MOST], *found;
    size_t n = 0;
    for (int a = 0; a < r->axes; a++)
        known[n++] = r->axis[a].name;
    for (int k = 0; k < r->varied && n < MOST; k++)
        known[n++] = r->vary[k].of.name;
    found = mend_path(word, known, n);
    text[0] = '\0';
    if (found && strcmp(found, word) != 0)
        snprintf(text, 128, "; did you mean '%s'?", found);
    return text;
}

static bool contains(const int *list, int count, int axis)
{
    for (int k = 0; k < count; k++)
        if (list[k] == axis)
            return true;
    return false;
}

/* The axes that --by names. */
static bool choose_by(const struct basin *b, bool wanted[SCENARIO_MAX_AXES],
                      stance_message *message)
{
    const struct results *r = b->r;
    for (size_t k = 0; k < b->choice.by_count; k++) {
        int a = 0;
        char meant[128];
        while (a < r->axes && strcmp(r->axis[a].name, b->choice.by[k]) != 0)
            a++;
        if (a == r->axes || a == r->sample)
            return complain(
                message,
                "stance basin: --by takes an axis of the grid, and '%.40s' is none of %.60s%s",
                b->choice.by[k], r->file, basin_meant(r, b->choice.by[k], meant));
        wanted[a] = true;
    }
    return true;
}

static void add_unit(struct basin *b, const char *unit)
{
    const size_t used = strlen(b->unit);
    if (unit[0] && strcmp(unit, "1") != 0)
        snprintf(b->unit + used, sizeof b->unit - used, "%s%s", used ? " * " : "", unit);
}

/* Starts that are sampled: the points must be evenly distributed over their box. */
static bool choose_sample(struct basin *b, stance_message *message)
{
    const struct basin_sample *sample = &b->sample;
    const char *wrong = b->start_axes > 0 ? "starts are on axes of the grid and sampled at once"
                        : sample->method == DOE_MORRIS
                            ? "Morris's trajectories do not cover the box of starts evenly"
                        : sample->method == DOE_SPHERE
                            ? "method sphere has no volume without a grid axis initial.offset.scale"
                            : NULL;
    if (wrong)
        return complain(message, "%.100s: %s", b->r->file, wrong);
    b->sampled = true;
    b->averaged = -1;
    b->start[b->start_axes++] = sample->axis;
    b->box = isfinite(sample->box) ? sample->box : 1;
    for (size_t k = 0; k < sample->factors && isfinite(sample->box); k++)
        add_unit(b, sample->factor[k].of->unit);
    return true;
}

size_t basin_starts(const struct basin *basin)
{
    return basin->sampled ? basin->sample.factors : (size_t)basin->start_axes;
}

const struct results_axis *basin_start(const struct basin *basin, size_t k)
{
    return basin->sampled ? basin->sample.factor[k].of : &basin->r->axis[basin->start[k]];
}

/* Distances are in units of weights. */
static bool choose_weights(struct basin *b, stance_message *message)
{
    bool known = true;
    for (int k = 0; k < SCENARIO_MAX_AXES; k++)
        b->weight[k] = 1;
    for (size_t k = 0; known && k < b->choice.weights; k++) {
        const struct basin_weight *weight = &b->choice.weight[k];
        known = false;
        for (size_t d = 0; b->around && d < basin_starts(b); d++) {
            if (strcmp(basin_start(b, d)->name, weight->path) == 0) {
                b->weight[d] = weight->size;
                known = true;
            }
        }
        char meant[128];
        if (!known)
            complain(message,
                     "stance basin: --weight takes a start about the equilibrium, and '%.40s' is "
                     "none of %.60s%s",
                     weight->path, b->r->file, basin_meant(b->r, weight->path, meant));
    }
    return known;
}

/* The equilibrium is where all offsets are zero. */
static bool is_around(const struct basin *b)
{
    const size_t count = basin_starts(b);
    for (size_t d = 0; d < count; d++) {
        const struct results_axis *axis = basin_start(b, d);
        double low = INFINITY, high = -INFINITY;
        for (size_t i = 0; i < axis->count; i++) {
            low = fmin(low, axis->value[i]);
            high = fmax(high, axis->value[i]);
        }
        if (strncmp(axis->name, "initial.offset.", 15) != 0 || low > 0 || high < 0)
            return false;
    }
    return count <= SCENARIO_MAX_AXES;
}

static bool choose_axes(struct basin *b, stance_message *message)
{
    const struct results *r = b->r;
    bool wanted[SCENARIO_MAX_AXES] = {false};
    if (!choose_by(b, wanted, message))
        return false;
    b->box = 1;
    for (int a = 0; a < r->axes; a++) {
        const struct results_axis *axis = &r->axis[a];
        const bool all = b->choice.by_count + b->choice.rank == 0 && !r->single,
                   start = is_start(axis);
        if (!wanted[a] && start && axis->count > 1) {
            b->start[b->start_axes++] = a;
            add_unit(b, axis->unit);
        } else if (!wanted[a] && a == r->sample && b->choice.rank == 0) {
            b->averaged = a;
        } else if (wanted[a] || a == r->sample || (all && !start)) {
            b->by[b->by_axes++] = a;
        }
    }
    if (b->choice.rank > 0 && (r->sample < 0 || b->sample.axis >= 0))
        return complain(message,
                        "stance basin: --rank needs a sample of parameters, and %.150s has none",
                        r->file);
    if (b->sample.axis >= 0 && !choose_sample(b, message))
        return false;
    if (b->start_axes == 0)
        return complain(
            message,
            "%.100s: no starts are varied (initial.offset.*, initial.state.*), so there is no "
            "basin to measure",
            r->file);
    b->around = is_around(b);
    return true;
}

/* ---- slices ------------------------------------------------------------------------------- */

/* What all slices share. */
struct lattice {
    struct statistics_place *order[SCENARIO_MAX_AXES]; /* of the start axes, by rising value */
    double *place[SCENARIO_MAX_AXES];
    uint64_t stride[SCENARIO_MAX_AXES]; /* of the file's axes */
    size_t slices[SCENARIO_MAX_AXES];   /* points of these, 1 of the start axes */
    size_t origin[SCENARIO_MAX_AXES];   /* the place nearest to zero */
    struct basin_map map;
    uint8_t *kind; /* [map.cases] */
};

static void free_lattice(struct lattice *lattice)
{
    for (int d = 0; d < SCENARIO_MAX_AXES; d++) {
        free(lattice->order[d]);
        free(lattice->place[d]);
    }
    free(lattice->kind);
}

/* The places of a start axis, sorted. */
static bool sort_axis(struct lattice *lattice, int d, const struct results_axis *axis)
{
    const struct statistics_place *order = lattice->order[d] =
        statistics_ordered(axis->value, axis->count);
    double *place = lattice->place[d] = malloc(axis->count * sizeof *place);
    if (!order || !place)
        return false;
    const size_t zero = statistics_nearest_zero(axis);
    for (size_t i = 0; i < axis->count; i++) {
        place[i] = order[i].value;
        lattice->origin[d] = order[i].index == zero ? i : lattice->origin[d];
    }
    lattice->map.count[d] = axis->count;
    lattice->map.place[d] = place;
    lattice->map.cases *= axis->count;
    return true;
}

static bool make_lattice(struct lattice *lattice, const struct basin *b)
{
    const struct results *r = b->r;
    *lattice = (struct lattice){.map = {.axes = b->start_axes, .cases = 1}};
    for (int a = 0; a < r->axes; a++) {
        lattice->stride[a] = statistics_stride(r, a);
        lattice->slices[a] = contains(b->start, b->start_axes, a) ? 1 : r->axis[a].count;
    }
    bool good = true;
    for (int d = 0; good && d < b->start_axes; d++)
        good = sort_axis(lattice, d, &r->axis[b->start[d]]);
    lattice->kind = good ? malloc(lattice->map.cases) : NULL;
    lattice->map.kind = lattice->kind;
    if (!lattice->kind)
        free_lattice(lattice);
    return lattice->kind != NULL;
}

/* The kinds of the cases of one slice, into lattice->kind; of starts it has point 0. */
static void take_slice(struct lattice *lattice, const struct basin *b, const size_t *point)
{
    size_t at[SCENARIO_MAX_AXES] = {0};
    uint64_t base = 0;
    for (int a = 0; a < b->r->axes; a++)
        base += point[a] * lattice->stride[a];
    for (uint64_t i = 0; i < lattice->map.cases; i++) {
        uint64_t index = base;
        for (int d = 0; d < b->start_axes; d++)
            index += lattice->order[d][at[d]].index * lattice->stride[b->start[d]];
        lattice->kind[i] = b->r->kind[index];
        basin_next_point(b->start_axes, lattice->map.count, at);
    }
}

size_t basin_row_of(const struct basin *b, const size_t *point)
{
    size_t row = 0;
    for (int k = 0; k < b->by_axes; k++)
        row = row * b->r->axis[b->by[k]].count + point[b->by[k]];
    return row;
}

/* ---- rows --------------------------------------------------------------------------------- */

/* Of an interval about an estimate, which need not lie in its middle. */
static double longer_side(double estimate, struct interval interval)
{
    return fmax(interval.high - estimate, estimate - interval.low);
}

/* What is drawn in a sample, for each row. Of parameters: the blocks, whose points share
 * coordinates (saltelli, morris) and whose slices add up; of starts: a point, and what became of
 * its cases. */
struct draw {
    double volume;
    uint64_t slices;
    uint32_t cases, inside, unknown;
};

static struct draw *draws_of(const struct basin *b, const struct basin_row *row, struct draw *all)
{
    return all + (size_t)(row - b->row) * b->draws;
}

static bool add_part(const struct basin *b, const struct lattice *lattice, struct basin_row *row)
{
    struct basin_part part;
    if (!basin_map_part(&lattice->map, b->choice.of, lattice->origin, &part))
        return false;
    for (int d = 0; d < b->start_axes; d++) /* the map's faces as those of the box */
        for (int k = 0; k < b->faces.starts; k++)
            if (b->faces.start[k].axis == b->start[d])
                row->part.faces |= (part.faces >> 2 * d & 3) << 2 * k;
    row->part.unknown = row->part.unknown || part.unknown;
    row->part.low += part.volume.low;
    row->part.high += part.volume.high;
    const double deviations = basin_map_deviations(b->choice.level);
    if (part.inside || !part.unknown) {
        row->part.known++;
        row->part.inside += part.inside;
        row->part.volume += part.inside ? part.volume.estimate : 0;
        row->part.reach += part.inside ? basin_volume_reach(&part.volume, deviations) : 0;
    }
    return true;
}

/* draws[rows][draws] */
static bool add_slice(struct basin *b, const struct lattice *lattice, const size_t *point,
                      struct basin_row *row, struct draw *draws)
{
    struct basin_volume volume;
    const double deviations = basin_map_deviations(b->choice.level);
    for (uint64_t i = 0; i < lattice->map.cases; i++) {
        row->inside += lattice->kind[i] == b->choice.of;
        row->failed += lattice->kind[i] == RESULTS_FAILED;
        row->pending += lattice->kind[i] == RESULTS_PENDING;
    }
    row->cases += lattice->map.cases;
    if (!basin_map_volume(&lattice->map, b->choice.of, &volume))
        return false;
    b->box = volume.box;
    row->low += volume.low;
    row->high += volume.high;
    if (isfinite(volume.estimate)) {
        row->known++;
        row->volume += volume.estimate;
        row->reach += basin_volume_reach(&volume, deviations);
        row->resolution += deviations * sqrt(volume.variance);
        if (b->averaged >= 0) {
            struct draw *block = draws_of(b, row, draws) + point[b->averaged] / b->sample.block;
            block->volume += volume.estimate;
            block->slices++;
        }
    }
    row->cells += volume.cells;
    row->crossed += volume.crossed;
    basin_map_entropy(&lattice->map, b->choice.side, &row->entropy);
    row->uncertainty.scales = basin_map_scales(&lattice->map);
    basin_map_uncertainty(&lattice->map, &row->uncertainty);
    row->has_distance = row->slices == 1 && b->around;
    return !b->around ||
           (add_part(b, lattice, row) &&
            (!row->has_distance || basin_map_distance(&lattice->map, b->choice.of, lattice->origin,
                                                      b->weight, &row->distance)));
}

/* How far the mean over blocks may be off, as far as they scatter: the longer side of its interval,
 * which where few blocks differ from the others has two that do. NAN: fewer than two blocks. */
static double scatter(const struct basin *b, const struct draw *blocks)
{
    struct interval_draws draws = {0};
    for (size_t k = 0; k < b->draws; k++)
        interval_add(&draws, blocks[k].volume / b->box, (double)blocks[k].slices);
    const double mean = draws.k / draws.m;
    const struct interval found = interval_of(&draws, b->choice.level);
    return draws.blocks > 1 ? b->box * longer_side(mean, found) : NAN;
}

/* From sums over slices to means. The boundaries of slices next to each other lie alike, and so may
 * their errors: the mean's is the mean of theirs. Over a sample of parameters slices scatter, too.
 */
static void finish_row(const struct basin *b, struct basin_row *row, struct draw *draws)
{
    const double n = (double)row->slices, known = row->known > 0 ? (double)row->known : NAN;
    row->low /= n;
    row->high /= n;
    row->volume /= known;
    row->reach /= known;
    row->resolution /= known;
    row->part.low /= n;
    row->part.high /= n;
    row->part.volume /= (double)row->part.known;
    row->part.reach /= (double)row->part.known;
    if (b->averaged >= 0)
        row->reach = hypot(row->reach, scatter(b, draws_of(b, row, draws)));
}

/* Counts cases alone: a sample is no map. */
static void add_sampled(struct basin *b, const struct lattice *lattice, struct basin_row *row,
                        struct draw *draws)
{
    struct draw *own = draws_of(b, row, draws);
    for (size_t i = 0; i < lattice->map.cases; i++) {
        if (counts(&b->sample, i)) {
            const uint8_t kind = lattice->kind[i];
            row->cases++;
            own[i].cases++;
            row->inside += kind == b->choice.of;
            own[i].inside += kind == b->choice.of;
            row->failed += kind == RESULTS_FAILED;
            row->pending += kind == RESULTS_PENDING;
            own[i].unknown += kind == RESULTS_FAILED || kind == RESULTS_PENDING;
        }
    }
}

/* The nearest point of a sample that is lost in the only slice. */
static void find_nearest(const struct basin *b, struct basin_row *row, const struct draw *own)
{
    row->has_distance = b->around && row->slices == 1;
    row->distance = (struct basin_distance){
        .inside = true, .nearest = NAN, .clear = 0, .median = NAN, .median_least = NAN};
    for (size_t i = 0; row->has_distance && i < b->sample.points; i++) {
        double sum = 0;
        for (size_t k = 0; k < b->sample.factors; k++)
            sum += pow(b->sample.factor[k].of->value[i] / b->weight[k], 2);
        if (own[i].cases == own[i].inside + own[i].unknown || sqrt(sum) >= row->distance.nearest)
            continue;
        row->distance.nearest = sqrt(sum);
        for (size_t k = 0; k < b->sample.factors; k++)
            row->distance.at[k] = b->sample.factor[k].of->value[i];
    }
}

/* A point that counts in several slices, averaged over, is one draw. */
static void finish_sampled(const struct basin *b, struct basin_row *row, struct draw *draws)
{
    const struct draw *own = draws_of(b, row, draws);
    const uint64_t known = row->cases - row->failed - row->pending;
    struct interval_draws least = {0}, most = {0};
    for (size_t i = 0; i < b->sample.points; i++) {
        interval_add(&least, own[i].inside, own[i].cases);
        interval_add(&most, own[i].inside + own[i].unknown, own[i].cases);
    }
    row->volume = known > 0 ? b->box * (double)row->inside / (double)known : NAN;
    const struct interval ends = {b->box * interval_of(&least, b->choice.level).low,
                                  b->box * interval_of(&most, b->choice.level).high};
    row->low = ends.low;
    row->high = ends.high;
    row->reach = longer_side(row->volume, ends);
    find_nearest(b, row, own);
}

static bool make_rows(struct basin *b, stance_message *message)
{
    const bool sampled = b->sampled;
    struct lattice lattice;
    size_t point[SCENARIO_MAX_AXES] = {0};

    b->rows = 1;
    for (int k = 0; k < b->by_axes; k++)
        b->rows *= b->r->axis[b->by[k]].count;
    b->draws = sampled            ? b->sample.points
               : b->averaged >= 0 ? b->sample.points / b->sample.block
                                  : 0;
    b->row = calloc(b->rows, sizeof *b->row);
    b->drawn = malloc((b->rows * b->draws + 1) * sizeof *b->drawn);
    struct draw *draws = calloc(b->rows * b->draws + 1, sizeof *draws);
    bool good = b->row && b->drawn && draws && make_lattice(&lattice, b);
    if (!good) {
        free(draws);
        return statistics_no_memory(b->r, message);
    }
    for (size_t k = 0; k < b->rows; k++)
        statistics_row(b->r, b->by, b->by_axes, k, b->row[k].point);
    do {
        struct basin_row *const row = &b->row[basin_row_of(b, point)];
        row->slices++;
        take_slice(&lattice, b, point);
        if (sampled)
            add_sampled(b, &lattice, row, draws);
        else
            good = add_slice(b, &lattice, point, row, draws);
    } while (good && basin_next_point(b->r->axes, lattice.slices, point));
    for (size_t k = 0; k < b->rows; k++)
        (sampled ? finish_sampled : finish_row)(b, &b->row[k], draws);
    for (size_t k = 0; k < b->rows * b->draws; k++) {
        const struct draw *const d = &draws[k];
        b->drawn[k] =
            sampled ? b->box * d->inside / (d->cases - d->unknown) : d->volume / (double)d->slices;
    }
    /* Every case with the outcome tells on which faces it lies. */
    for (uint64_t i = 0; b->faces.starts > 0 && i < b->r->cases; i++) {
        if (b->r->kind[i] == b->choice.of) {
            results_point(b->r, i, point);
            b->row[basin_row_of(b, point)].cut |= faces_at(&b->faces, point);
        }
    }
    free_lattice(&lattice);
    free(draws);
    return good || statistics_no_memory(b->r, message);
}

static int by_volume(const void *left, const void *right)
{
    const struct basin_row *a = left, *b = right;
    if (isnan(a->volume) || isnan(b->volume))
        return isnan(a->volume) - isnan(b->volume);
    return (a->volume < b->volume) - (a->volume > b->volume);
}

bool basin_make(struct basin *basin, const struct results *r, const struct basin_choice *choice,
                struct basin_sample *sample, bool *usage, stance_message *message)
{
    *basin = (struct basin){.r = r, .choice = *choice, .sample = *sample, .averaged = -1};
    *sample = (struct basin_sample){.axis = -1};
    *usage = true;
    bool good = choose_axes(basin, message) && choose_weights(basin, message);
    if (good) {
        *usage = false;
        faces_make(&basin->faces, r, basin->by, basin->by_axes);
        good = make_rows(basin, message);
    }
    if (good && choice->rank > 0) {
        qsort(basin->row, basin->rows, sizeof *basin->row, by_volume);
        basin->rows = choice->rank < basin->rows ? choice->rank : basin->rows;
    }
    if (!good)
        basin_free(basin);
    return good;
}

size_t basin_averaged(const struct basin *basin, const char **paths, size_t most)
{
    const struct results *r = basin->r;
    size_t count = 0;
    for (int a = 0; a < r->axes; a++) {
        if (contains(basin->start, basin->start_axes, a) || r->axis[a].count < 2 ||
            contains(basin->by, basin->by_axes, a))
            continue;
        for (int k = 0; k < (a == basin->averaged ? r->varied : 1); k++)
            if (count < most)
                paths[count++] = a == basin->averaged ? r->vary[k].of.name : r->axis[a].name;
    }
    return count;
}

void basin_free(struct basin *basin)
{
    free(basin->row);
    free(basin->drawn);
    basin_sample_free(&basin->sample);
    *basin = (struct basin){0};
}

/* ---- the boundary ------------------------------------------------------------------------- */

static void put_crossing(struct table *t, const struct basin *b, const struct basin_map *map,
                         const size_t *point, const struct basin_crossing *crossing)
{
    for (int a = 0, d = 0; a < b->r->axes; a++) {
        const bool start = d < b->start_axes && b->start[d] == a;
        if (!start)
            TABLE_VALUES(t, as_place(&b->r->axis[a], point[a]));
        else
            TABLE_VALUES(t, as_number(d == crossing->axis ? crossing->middle
                                                          : map->place[d][crossing->point[d]]));
        d += start;
    }
    TABLE_VALUES(t, as_text(b->r->axis[b->start[crossing->axis]].name),
                 as_number(crossing->half_width), as_text(results_kind_names[crossing->from]),
                 as_text(results_kind_names[crossing->to]));
}

bool basin_print_boundary(const struct basin *b)
{
    struct table t = {0};
    struct lattice lattice;
    size_t point[SCENARIO_MAX_AXES] = {0};
    if (!make_lattice(&lattice, b))
        return false;
    for (int a = 0; a < b->r->axes; a++)
        TABLE_COLUMNS(&t, {.name = b->r->axis[a].name});
    TABLE_COLUMNS(&t, {.name = "along"}, {.name = "half_width"}, {.name = "from"}, {.name = "to"});
    bool good = table_write_csv(&t, stdout); /* the head */
    table_clear(&t);
    do {
        struct basin_crossing crossing = {.axis = -1};
        take_slice(&lattice, b, point);
        while (good && basin_next_crossing(&lattice.map, &crossing)) {
            put_crossing(&t, b, &lattice.map, point, &crossing);
            good = table_write_csv(&t, stdout);
            table_clear(&t);
        }
    } while (good && basin_next_point(b->r->axes, lattice.slices, point));
    free_lattice(&lattice);
    table_free(&t);
    return good;
}
