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

/* What descents have found, NULL: they found nothing, or were not made. */
static const struct basin_nearest *nearest_of(const struct basin_rays *rays, size_t row)
{
    const struct basin_nearest *nearest = rays->nearest ? &rays->nearest[row] : NULL;
    return nearest && nearest->end.starts > 0 && isfinite(nearest->end.high) ? nearest : NULL;
}

static double nearest_scale(const struct basin_nearest *nearest)
{
    return nearest ? 0.5 * (nearest->end.low + nearest->end.high) : NAN;
}

/* The share of directions below which a dip may have been missed: all starts but the shortest ray
 * are spread evenly. */
static double unseen(const struct basin_nearest *nearest)
{
    return nearest->end.starts > 1 ? basin_descend_unseen(nearest->end.starts - 1) : NAN;
}

/* ---- the table ---------------------------------------------------------------------------- */

static json_t *nearest_json(const struct basin_rays *rays, const struct basin_nearest *nearest)
{
    json_t *at = json_object(), *of = json_object();
    for (size_t k = 0; k < rays->sample.factors; k++) {
        const char *name = rays->sample.factor[k].of->name;
        table_put(at, name, as_number(nearest->at[k]));
        table_put(of, name, as_number(nearest->of[k]));
    }
    return TABLE_OBJECT(
        {"scale", as_number(nearest_scale(nearest))},
        {"bracket", as_tree(json_pack("[f,f]", nearest->end.low, nearest->end.high))},
        {"at", as_tree(at)}, {"of_ranges", as_tree(of)}, {"starts", as_whole(nearest->end.starts)},
        {"agree", as_whole(nearest->end.agree)}, {"unseen", as_number(unseen(nearest))},
        {"simulations", as_whole(nearest->end.asked)}, {"failed", as_whole(nearest->failed)});
}

static bool make_table(struct table *t, const struct basin_rays *rays)
{
    for (size_t row = 0; row < rays->rows; row++) {
        struct basin_reach reach;
        if (!basin_rays_reach(rays, row, &reach))
            return false;
        const struct basin_ray *first =
            reach.count[RAY_CROSSES] > 0 ? ray_of(rays, row, reach.first) : NULL;
        const struct basin_nearest *nearest = nearest_of(rays, row);
        json_t *const at = first ? json_object() : NULL;
        for (size_t k = 0; first && k < rays->sample.factors; k++) {
            const struct results_axis *of = rays->sample.factor[k].of;
            table_put(at, of->name, as_number(of->value[reach.first] * basin_ray_middle(first)));
        }
        add_parameters(t, rays, row);
        add_end(t, rays, reach.first, first);
        TABLE_FACTS(
            t, {{.name = "rays", .hidden = TABLE_NO_JSON}, as_whole(rays->sample.points)},
            {{"crossing", "rays end", .width = 9}, as_whole(reach.count[RAY_CROSSES])},
            {{"open", "go on", .width = 9}, as_whole(reach.count[RAY_OPEN])},
            {{"outside", "outside", .width = 9},
             as_whole(reach.count[RAY_OUTSIDE] + reach.count[RAY_UNKNOWN])},
            {{.name = "descended",
              .hidden = TABLE_NO_JSON,
              .heading = "nearest",
              .format = "%.5g",
              .width = 10},
             as_number(nearest_scale(nearest))},
            {{.name = "nearest", .hidden = TABLE_NO_CSV},
             as_tree(nearest ? nearest_json(rays, nearest) : NULL)},
            {{"smallest", "smallest", "%.5g", .width = 10}, as_number(reach.smallest)},
            {{"median", "median", "%.5g", .width = 10}, as_number(reach.median)},
            {{"largest", "largest", "%.5g", .width = 10}, as_number(reach.largest)},
            {{.name = "first_ray"}, first ? as_whole(reach.first) : as_nothing(NULL)},
            {{.name = "first_low", .hidden = TABLE_NO_JSON}, as_number(first ? first->low : NAN)},
            {{.name = "first_high", .hidden = TABLE_NO_JSON}, as_number(first ? first->high : NAN)},
            {{.name = "first_bracket", .hidden = TABLE_NO_CSV},
             as_tree(first ? json_pack("[f,f]", first->low, first->high) : NULL)},
            {{.name = "first_at", .hidden = TABLE_NO_CSV}, as_tree(at)});
        table_end_row(t);
    }
    return true;
}

/* ---- text --------------------------------------------------------------------------------- */

static void print_head(const struct basin_rays *rays)
{
    const struct results *r = rays->r;
    basin_print_title(r);
    printf("%zu rays from the equilibrium, along which starts stay %s\n", rays->sample.points,
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

static void print_nearest(const struct basin_rays *rays, const struct basin_nearest *nearest)
{
    printf("\n  nearest: %.5g +- %.2g, by descent from %zu ray%s (%" PRIu64 " simulations), at\n",
           nearest_scale(nearest), 0.5 * (nearest->end.high - nearest->end.low),
           nearest->end.starts, nearest->end.starts == 1 ? "" : "s", nearest->end.asked);
    for (size_t k = 0; k < rays->sample.factors; k++) {
        const struct results_axis *of = rays->sample.factor[k].of;
        printf("    %-24s %.5g %s, %.2g of half its range\n", of->name, nearest->at[k], of->unit,
               nearest->of[k]);
    }
    if (nearest->end.starts > 1) {
        printf(
            "  %zu of %zu descents end within 1 %% of it; a nearer end into which %.2g %% of all\n"
            "  directions lead would have been missed with a probability of 5 %%\n",
            nearest->end.agree, nearest->end.starts, 100 * unseen(nearest));
    }
    if (nearest->failed > 0)
        printf("  (%" PRIu64 " simulations failed and count as not lost)\n", nearest->failed);
}

static bool print_text(const struct basin_rays *rays, const struct table *t)
{
    print_head(rays);
    puts("\nScale at which rays end");
    const bool good = table_write_text(
        t, stdout,
        rays->nearest ? "at/ descended smallest median largest crossing open outside"
                      : "at/ smallest median largest crossing open outside",
        BASIN_SHOWN);
    puts("  (go on: to the largest scale, counted as longer than all others; outside: another\n"
         "  outcome at the smallest scale already, or no case known)");
    if (!rays->nearest)
        puts(
            "  (smallest: of these directions, so an upper bound; --descend 8 goes on from there)");
    if (!good || rays->rows > 1)
        return good;
    if (nearest_of(rays, 0))
        print_nearest(rays, nearest_of(rays, 0));
    return print_first(rays, 0);
}

/* ---- all forms ---------------------------------------------------------------------------- */

bool basin_rays_print(const struct basin_rays *rays, enum table_form form)
{
    struct table t = {0};
    bool good = make_table(&t, rays);
    if (good && form != TABLE_AS_TEXT)
        return basin_table_write(
            &t, form, "",
            TABLE_OBJECT({"outcome", as_text(results_kind_names[rays->of])},
                         {"starts", as_tree(basin_factor_names(&rays->sample))},
                         {"rays", as_whole(rays->sample.points)}));
    good = good && print_text(rays, &t);
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
