/* basin_rays_print.c - where rays end, for people and for programs. */
#include "basin_print.h"

#include <inttypes.h>
#include <math.h>

static const struct basin_ray *ray_of(const struct basin_rays *rays, size_t row, size_t point)
{
    return &rays->ray[row * rays->sample.points + point];
}

static void add_parameters(struct table *t, const struct basin_rays *rays, size_t row)
{
    size_t point[SCENARIO_MAX_AXES] = {0};
    for (int k = 0; k < rays->by_axes; k++)
        point[rays->by[k]] = basin_rays_point(rays, row, k);
    table_axes(t, rays->r, rays->by, rays->by_axes, point);
}

/* Where a ray ends; NULL: nothing. */
static void add_end(struct table *t, const struct basin_rays *rays, size_t point,
                    const struct basin_ray *ray)
{
    for (size_t k = 0; k < rays->sample.factors; k++) {
        const struct results_axis *of = rays->sample.factor[k].of;
        TABLE_FACTS(t, {{.name = of->name, .hidden = TABLE_NO_JSON},
                        as_number(ray ? of->value[point] * basin_ray_middle(ray) : NAN)});
    }
}

/* ---- the table ---------------------------------------------------------------------------- */

static json_t *at_json(const struct basin_rays *rays, size_t point, const struct basin_ray *ray)
{
    json_t *at = json_object();
    for (size_t k = 0; k < rays->sample.factors; k++) {
        const struct results_axis *of = rays->sample.factor[k].of;
        json_object_set_new(at, of->name, json_real(of->value[point] * basin_ray_middle(ray)));
    }
    return at;
}

static bool make_table(struct table *t, const struct basin_rays *rays)
{
    for (size_t row = 0; row < rays->rows; row++) {
        struct basin_reach reach;
        if (!basin_rays_reach(rays, row, &reach))
            return false;
        const struct basin_ray *first =
            reach.count[RAY_CROSSES] > 0 ? ray_of(rays, row, reach.first) : NULL;
        add_parameters(t, rays, row);
        add_end(t, rays, reach.first, first);
        TABLE_FACTS(
            t, {{.name = "rays", .hidden = TABLE_NO_JSON}, as_whole(rays->sample.points)},
            {{"crossing", "rays end", .width = 9}, as_whole(reach.count[RAY_CROSSES])},
            {{"open", "go on", .width = 9}, as_whole(reach.count[RAY_OPEN])},
            {{"outside", "outside", .width = 9},
             as_whole(reach.count[RAY_OUTSIDE] + reach.count[RAY_UNKNOWN])},
            {{"smallest", "smallest", "%.5g", .width = 10}, as_number(reach.smallest)},
            {{"median", "median", "%.5g", .width = 10}, as_number(reach.median)},
            {{"largest", "largest", "%.5g", .width = 10}, as_number(reach.largest)},
            {{.name = "first_ray"}, first ? as_whole(reach.first) : as_nothing(NULL)},
            {{.name = "first_low", .hidden = TABLE_NO_JSON}, as_number(first ? first->low : NAN)},
            {{.name = "first_high", .hidden = TABLE_NO_JSON}, as_number(first ? first->high : NAN)},
            {{.name = "first_bracket", .hidden = TABLE_NO_CSV},
             as_tree(first ? json_pack("[f,f]", first->low, first->high) : NULL)},
            {{.name = "first_at", .hidden = TABLE_NO_CSV},
             as_tree(first ? at_json(rays, reach.first, first) : NULL)});
        table_end_row(t);
    }
    return true;
}

/* ---- text --------------------------------------------------------------------------------- */

static void print_head(const struct basin_rays *rays)
{
    const struct results *r = rays->r;
    printf("%s\n%s: %" PRIu64
           " cases\n\n%zu rays from the equilibrium, along which starts stay %s\n",
           r->title[0] ? r->title : r->name, r->file, r->cases, rays->sample.points,
           results_kind_names[rays->of]);
    for (size_t k = 0; k < rays->sample.factors; k++)
        basin_print_factor(&rays->sample.factor[k], "");
    basin_print_axis(&r->axis[rays->scale]);
    puts(": 1 is the ellipsoid within these ranges");
}

static bool print_first(const struct basin_rays *rays, size_t row)
{
    struct basin_reach reach;
    if (!basin_rays_reach(rays, row, &reach))
        return false;
    putchar('\n');
    if (reach.count[RAY_CROSSES] == 0)
        return true;
    const struct basin_ray *ray = ray_of(rays, row, reach.first);
    printf("  ray %zu ends first, between the scales %.6g and %.6g (%s there), at\n", reach.first,
           ray->low, ray->high, results_kind_names[ray->to]);
    for (size_t k = 0; k < rays->sample.factors; k++) {
        const struct results_axis *of = rays->sample.factor[k].of;
        const double along = of->value[reach.first];
        printf("    %-24s %.5g +- %.2g %s\n", of->name, along * basin_ray_middle(ray),
               fabs(along) * 0.5 * (ray->high - ray->low), of->unit);
    }
    return true;
}

static bool print_text(const struct basin_rays *rays, const struct table *t)
{
    print_head(rays);
    puts("\nScale at which rays end");
    const bool good = table_write_text(
        t, stdout, "at/ smallest median largest crossing open outside", BASIN_SHOWN);
    puts("  (go on: to the largest scale, counted as longer than all others; outside: another\n"
         "  outcome at the smallest scale already, or no case known)");
    return good && (rays->rows > 1 || print_first(rays, 0));
}

/* ---- all forms ---------------------------------------------------------------------------- */

static bool print_json(const struct basin_rays *rays, const struct table *t)
{
    return table_write_json(TABLE_OBJECT({"outcome", as_text(results_kind_names[rays->of])},
                                         {"starts", as_tree(basin_factor_names(&rays->sample))},
                                         {"rays", as_whole(rays->sample.points)},
                                         {"rows", as_tree(table_json(t, false))}),
                            stdout);
}

bool basin_rays_print(const struct basin_rays *rays, enum table_form form)
{
    struct table t = {0};
    bool good = make_table(&t, rays);
    if (good)
        good = form == TABLE_AS_JSON  ? print_json(rays, &t)
               : form == TABLE_AS_CSV ? table_write_csv(&t, stdout)
                                      : print_text(rays, &t);
    table_free(&t);
    return good;
}

bool basin_rays_print_boundary(const struct basin_rays *rays)
{
    static const char *const ends[] = {"crosses", "open", "outside", "unknown"};
    struct table t = {0};
    bool good = true;
    for (size_t row = 0; good && row < rays->rows; row++) {
        for (size_t p = 0; p < rays->sample.points; p++) {
            const struct basin_ray *ray = ray_of(rays, row, p);
            add_parameters(&t, rays, row);
            TABLE_FACTS(&t, {{.name = "ray"}, as_whole(p)});
            add_end(&t, rays, p, ray);
            TABLE_FACTS(&t, {{.name = "low"}, as_number(ray->low)},
                        {{.name = "high"}, as_number(ray->high)},
                        {{.name = "end"}, as_text(ends[ray->end])},
                        {{.name = "to"},
                         as_text(ray->end == RAY_CROSSES ? results_kind_names[ray->to] : NULL)});
            table_end_row(&t);
        }
        good = table_write_csv(&t, stdout);
        table_clear(&t);
    }
    table_free(&t);
    return good;
}
