/* basin_json.c - a basin for programs; the keys are listed in `stance basin -h`. */
#include "basin_print.h"

#include "analysis/table/json.h"

#include <math.h>

static json_t *paths(const struct results *r, const int *list, int count)
{
    json_t *names = json_array();
    for (int k = 0; k < count; k++)
        json_array_append_new(names, json_string(r->axis[list[k]].name));
    return names;
}

static json_t *averaged(const struct basin *b)
{
    const char *path[256];
    const size_t count = basin_averaged(b, path, sizeof path / sizeof path[0]);
    json_t *names = json_array();
    for (size_t k = 0; k < count; k++)
        json_array_append_new(names, json_string(path[k]));
    return names;
}

static json_t *factors(const struct basin_sample *sample)
{
    json_t *names = json_array();
    for (size_t k = 0; k < sample->factors; k++)
        json_array_append_new(names, json_string(sample->factor[k].of->name));
    return names;
}

static json_t *place(const struct basin *b, const struct basin_row *row)
{
    json_t *at = json_object();
    for (int k = 0; k < b->by_axes; k++) {
        const struct results_axis *axis = &b->r->axis[b->by[k]];
        const size_t i = row->point[b->by[k]];
        json_object_set_new(at, axis->name, results_json_value(axis, i));
    }
    return at;
}

static void put_uncertainty(json_t *entry, const struct basin *b, const struct basin_row *row)
{
    const struct basin_uncertainty *uncertainty = &row->uncertainty;
    const struct basin_exponent exponent = basin_exponent(uncertainty);
    json_t *distances = json_array(), *shares = json_array();
    for (int k = 0; k < uncertainty->scales; k++) {
        json_array_append_new(distances, json_integer(1 << k));
        json_array_append_new(shares, results_json_number((double)uncertainty->uncertain[k] /
                                                          (double)uncertainty->counted[k]));
    }
    json_object_set_new(entry, "alpha", results_json_number(exponent.alpha));
    json_object_set_new(entry, "alpha_error", results_json_number(exponent.error));
    json_object_set_new(entry, "alpha_distances", json_integer(exponent.scales));
    json_object_set_new(entry, "alpha_missing",
                        exponent.refusal == BASIN_FITTED
                            ? json_null()
                            : json_string(basin_refusal_words[exponent.refusal]));
    json_object_set_new(entry, "fractal",
                        json_boolean(basin_is_fractal(&row->entropy, uncertainty)));
    json_object_set_new(entry, "dimension", results_json_number(basin_dimension(b, row)));
    json_object_set_new(entry, "distances", distances);
    json_object_set_new(entry, "uncertain", shares);
}

static void put_distance(json_t *entry, const struct basin *b, const struct basin_row *row)
{
    const struct basin_distance *distance = &row->distance;
    const bool any = row->has_distance && distance->inside;
    json_t *extent = any ? json_object() : json_null();
    json_t *at = any && isfinite(distance->nearest) ? json_object() : json_null();
    for (int d = 0; any && d < b->start_axes; d++) {
        const char *name = b->r->axis[b->start[d]].name;
        json_object_set_new(extent, name,
                            json_pack("[o,o]", results_json_number(distance->low[d]),
                                      results_json_number(distance->high[d])));
        if (json_is_object(at))
            json_object_set_new(at, name, results_json_number(distance->at[d]));
    }
    json_object_set_new(entry, "nearest", results_json_number(any ? distance->nearest : NAN));
    json_object_set_new(entry, "nearest_at", at);
    json_object_set_new(entry, "extent", extent);
}

static json_t *row_entry(const struct basin *b, const struct basin_row *row)
{
    json_t *entry = json_object();
    json_object_set_new(entry, "at", place(b, row));
    json_object_set_new(entry, "cases", results_json_whole(row->cases));
    json_object_set_new(entry, "inside", results_json_whole(row->inside));
    json_object_set_new(entry, "failed", results_json_whole(row->failed));
    json_object_set_new(entry, "pending", results_json_whole(row->pending));
    json_object_set_new(entry, "share", results_json_number(row->volume / b->box));
    json_object_set_new(entry, "volume", results_json_number(row->volume));
    json_object_set_new(entry, "reach", results_json_number(row->reach));
    json_object_set_new(entry, "low", results_json_number(row->low));
    json_object_set_new(entry, "high", results_json_number(row->high));
    json_object_set_new(entry, "cells", results_json_whole(row->cells));
    json_object_set_new(entry, "crossed", results_json_whole(row->crossed));
    json_object_set_new(entry, "entropy", results_json_number(basin_entropy(&row->entropy)));
    json_object_set_new(entry, "boundary_entropy",
                        results_json_number(basin_boundary_entropy(&row->entropy)));
    json_object_set_new(entry, "boxes", results_json_whole(row->entropy.boxes));
    json_object_set_new(entry, "mixed_boxes", results_json_whole(row->entropy.mixed));
    put_uncertainty(entry, b, row);
    put_distance(entry, b, row);
    return entry;
}

bool basin_print_json(const struct basin *b)
{
    json_t *rows = json_array(), *root = json_object();
    for (size_t k = 0; k < b->rows; k++)
        json_array_append_new(rows, row_entry(b, &b->row[k]));
    json_object_set_new(root, "outcome", json_string(results_kind_names[b->choice.of]));
    json_object_set_new(root, "level", results_json_number(b->choice.level));
    json_object_set_new(root, "box_side", results_json_whole(b->choice.side));
    json_object_set_new(
        root, "design",
        json_string(b->starts == BASIN_GRID ? "grid" : doe_words[b->sample.method]));
    json_object_set_new(root, "starts",
                        b->starts == BASIN_GRID ? paths(b->r, b->start, b->start_axes)
                                                : factors(&b->sample));
    json_object_set_new(root, "parameters", paths(b->r, b->by, b->by_axes));
    json_object_set_new(root, "averaged", averaged(b));
    json_object_set_new(root, "box", results_json_number(b->box));
    json_object_set_new(root, "unit", json_string(b->unit));
    json_object_set_new(root, "rows", rows);
    const bool good =
        root && json_dumpf(root, stdout, JSON_INDENT(2) | JSON_REAL_PRECISION(17)) == 0;
    json_decref(root);
    putchar('\n');
    return good;
}
