/* basin_rays_print.c - where rays end, for people, as CSV and as JSON. */
#include "basin_rays.h"

#include "analysis/table/csv.h"
#include "analysis/table/json.h"

#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

enum { TABLE_ROWS = 40, LABEL = 16 };

static const struct basin_ray *ray_of(const struct basin_rays *rays, size_t row, size_t point)
{
    return &rays->ray[row * rays->sample.points + point];
}

static const char *unit_of(const struct basin_factor *factor)
{
    return factor->of->unit;
}

/* ---- text --------------------------------------------------------------------------------- */

static void print_head(const struct basin_rays *rays)
{
    const struct results *r = rays->r;
    const struct results_axis *scale = &r->axis[rays->scale];
    char first[64], last[64];

    printf("%s\n%s: %llu cases\n\n%zu rays from the equilibrium, along which starts stay %s\n",
           r->title[0] ? r->title : r->name, r->file, (unsigned long long)r->cases,
           rays->sample.points, results_kind_names[rays->of]);
    for (size_t k = 0; k < rays->sample.factors; k++) {
        const struct basin_factor *factor = &rays->sample.factor[k];
        printf("  %-24s", factor->of->name);
        if (isfinite(factor->from))
            printf(" %.6g ... %.6g %s", factor->from, factor->to, unit_of(factor));
        putchar('\n');
    }
    results_value_text(scale, 0, false, first, sizeof first);
    results_value_text(scale, scale->count - 1, false, last, sizeof last);
    printf("  %-24s %s ... %s, %zu places: 1 is the ellipsoid within these ranges\n", scale->name,
           first, last, scale->count);
}

static void print_labels(const struct basin_rays *rays, size_t row, bool head)
{
    char text[128];
    fputs(" ", stdout);
    for (int k = 0; k < rays->by_axes; k++) {
        const struct results_axis *axis = &rays->r->axis[rays->by[k]];
        results_value_text(axis, basin_rays_point(rays, row, k), false, text, sizeof text);
        printf(" %*s", LABEL, head ? axis->name : text);
    }
}

static void print_number(double value)
{
    char text[32] = "-";
    if (isfinite(value))
        snprintf(text, sizeof text, "%.5g", value);
    printf(" %10s", text);
}

static void print_reach(const struct basin_rays *rays, size_t row, const struct basin_reach *reach)
{
    print_labels(rays, row, false);
    print_number(reach->smallest);
    print_number(reach->median);
    print_number(reach->largest);
    printf(" %9zu %9zu %9zu\n", reach->count[RAY_CROSSES], reach->count[RAY_OPEN],
           reach->count[RAY_OUTSIDE] + reach->count[RAY_UNKNOWN]);
}

static void print_first(const struct basin_rays *rays, size_t row, const struct basin_reach *reach)
{
    const struct basin_ray *ray = ray_of(rays, row, reach->first);
    if (reach->count[RAY_CROSSES] == 0)
        return;
    printf("  ray %zu ends first, between the scales %.6g and %.6g (%s there), at\n", reach->first,
           ray->low, ray->high, results_kind_names[ray->to]);
    for (size_t k = 0; k < rays->sample.factors; k++) {
        const struct basin_factor *factor = &rays->sample.factor[k];
        const double along = factor->of->value[reach->first];
        printf("    %-24s %.5g +- %.2g %s\n", factor->of->name, along * basin_ray_middle(ray),
               fabs(along) * 0.5 * (ray->high - ray->low), unit_of(factor));
    }
}

bool basin_rays_print_text(const struct basin_rays *rays)
{
    const size_t shown = rays->rows < TABLE_ROWS ? rays->rows : TABLE_ROWS;
    struct basin_reach reach;

    print_head(rays);
    puts("\nScale at which rays end");
    print_labels(rays, 0, true);
    printf(" %10s %10s %10s %9s %9s %9s\n", "smallest", "median", "largest", "rays end", "go on",
           "outside");
    for (size_t i = 0; i < shown; i++) {
        const size_t row = shown == rays->rows ? i : i * (rays->rows - 1) / (shown - 1);
        if (!basin_rays_reach(rays, row, &reach))
            return false;
        print_reach(rays, row, &reach);
    }
    if (shown < rays->rows)
        printf("  (%zu of %zu rows; --csv and --json have them all)\n", shown, rays->rows);
    puts("  (go on: to the largest scale, counted as longer than all others; outside: another\n"
         "  outcome at the smallest scale already, or no case known)");
    if (rays->rows == 1) {
        putchar('\n');
        print_first(rays, 0, &reach);
    }
    return true;
}

/* ---- CSV ---------------------------------------------------------------------------------- */

static void put_parameters(struct csv *csv, const struct basin_rays *rays, size_t row)
{
    for (int k = 0; k < rays->by_axes; k++) {
        const struct results_axis *axis = &rays->r->axis[rays->by[k]];
        const size_t i = basin_rays_point(rays, row, k);
        if (axis->word)
            csv_text(csv, axis->word[i]);
        else
            csv_number(csv, axis->value[i]);
    }
}

static void put_names(struct csv *csv, const struct basin_rays *rays)
{
    for (int k = 0; k < rays->by_axes; k++)
        csv_text(csv, rays->r->axis[rays->by[k]].name);
}

bool basin_rays_print_csv(const struct basin_rays *rays)
{
    static const char *const head[] = {"rays",      "crossing",  "open",    "outside",
                                       "smallest",  "median",    "largest", "first_ray",
                                       "first_low", "first_high"};
    struct csv csv = {.file = stdout};
    put_names(&csv, rays);
    for (size_t k = 0; k < rays->sample.factors; k++)
        csv_text(&csv, rays->sample.factor[k].of->name);
    csv_row(&csv, head, sizeof head / sizeof head[0]);
    for (size_t row = 0; row < rays->rows; row++) {
        struct basin_reach reach;
        if (!basin_rays_reach(rays, row, &reach))
            return false;
        const bool any = reach.count[RAY_CROSSES] > 0;
        const struct basin_ray *first = ray_of(rays, row, reach.first);
        put_parameters(&csv, rays, row);
        for (size_t k = 0; k < rays->sample.factors; k++) {
            csv_number(&csv,
                       any ? rays->sample.factor[k].of->value[reach.first] * basin_ray_middle(first)
                           : NAN);
        }
        const double numbers[] = {(double)rays->sample.points,
                                  (double)reach.count[RAY_CROSSES],
                                  (double)reach.count[RAY_OPEN],
                                  (double)(reach.count[RAY_OUTSIDE] + reach.count[RAY_UNKNOWN]),
                                  reach.smallest,
                                  reach.median,
                                  reach.largest,
                                  any ? (double)reach.first : NAN,
                                  any ? first->low : NAN,
                                  any ? first->high : NAN};
        for (size_t k = 0; k < sizeof numbers / sizeof numbers[0]; k++)
            csv_number(&csv, numbers[k]);
        csv_end_row(&csv);
    }
    return !ferror(stdout);
}

bool basin_rays_print_boundary(const struct basin_rays *rays)
{
    static const char *const head[] = {"low", "high", "end", "to"};
    static const char *const ends[] = {"crosses", "open", "outside", "unknown"};
    struct csv csv = {.file = stdout};
    put_names(&csv, rays);
    csv_text(&csv, "ray");
    for (size_t k = 0; k < rays->sample.factors; k++)
        csv_text(&csv, rays->sample.factor[k].of->name);
    csv_row(&csv, head, sizeof head / sizeof head[0]);
    for (size_t row = 0; row < rays->rows; row++) {
        for (size_t p = 0; p < rays->sample.points; p++) {
            const struct basin_ray *ray = ray_of(rays, row, p);
            put_parameters(&csv, rays, row);
            csv_number(&csv, (double)p);
            for (size_t k = 0; k < rays->sample.factors; k++)
                csv_number(&csv, rays->sample.factor[k].of->value[p] * basin_ray_middle(ray));
            csv_number(&csv, ray->low);
            csv_number(&csv, ray->high);
            csv_text(&csv, ends[ray->end]);
            csv_text(&csv, ray->end == RAY_CROSSES ? results_kind_names[ray->to] : "");
            csv_end_row(&csv);
        }
    }
    return !ferror(stdout);
}

/* ---- JSON --------------------------------------------------------------------------------- */

static json_t *row_entry(const struct basin_rays *rays, size_t row, const struct basin_reach *reach)
{
    const struct basin_ray *first = ray_of(rays, row, reach->first);
    const bool any = reach->count[RAY_CROSSES] > 0;
    const size_t outside = reach->count[RAY_OUTSIDE] + reach->count[RAY_UNKNOWN];
    json_t *entry = json_object(), *at = json_object();
    json_t *place = any ? json_object() : json_null();
    for (int k = 0; k < rays->by_axes; k++) {
        const struct results_axis *axis = &rays->r->axis[rays->by[k]];
        const size_t i = basin_rays_point(rays, row, k);
        json_object_set_new(at, axis->name, results_json_value(axis, i));
    }
    for (size_t k = 0; any && k < rays->sample.factors; k++) {
        const struct basin_factor *factor = &rays->sample.factor[k];
        json_object_set_new(
            place, factor->of->name,
            results_json_number(factor->of->value[reach->first] * basin_ray_middle(first)));
    }
    json_object_set_new(entry, "at", at);
    json_object_set_new(entry, "crossing", json_integer((json_int_t)reach->count[RAY_CROSSES]));
    json_object_set_new(entry, "open", json_integer((json_int_t)reach->count[RAY_OPEN]));
    json_object_set_new(entry, "outside", json_integer((json_int_t)outside));
    json_object_set_new(entry, "smallest", results_json_number(reach->smallest));
    json_object_set_new(entry, "median", results_json_number(reach->median));
    json_object_set_new(entry, "largest", results_json_number(reach->largest));
    json_object_set_new(entry, "first_ray",
                        any ? json_integer((json_int_t)reach->first) : json_null());
    json_object_set_new(entry, "first_bracket",
                        any ? json_pack("[f,f]", first->low, first->high) : json_null());
    json_object_set_new(entry, "first_at", place);
    return entry;
}

bool basin_rays_print_json(const struct basin_rays *rays)
{
    json_t *rows = json_array(), *factors = json_array(), *root = json_object();
    struct basin_reach reach;
    bool good = true;
    for (size_t k = 0; k < rays->sample.factors; k++)
        json_array_append_new(factors, json_string(rays->sample.factor[k].of->name));
    for (size_t row = 0; good && row < rays->rows; row++) {
        good = basin_rays_reach(rays, row, &reach);
        json_array_append_new(rows, good ? row_entry(rays, row, &reach) : json_null());
    }
    json_object_set_new(root, "outcome", json_string(results_kind_names[rays->of]));
    json_object_set_new(root, "starts", factors);
    json_object_set_new(root, "rays", json_integer((json_int_t)rays->sample.points));
    json_object_set_new(root, "rows", rows);
    good = good && json_dumpf(root, stdout, JSON_INDENT(2) | JSON_REAL_PRECISION(17)) == 0;
    json_decref(root);
    putchar('\n');
    return good;
}
