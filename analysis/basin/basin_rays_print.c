/* basin_rays_print.c - where rays end, for people and for programs. */
#include "basin_print.h"

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
    json_t *at = json_object(), *of = json_object(), *told = json_array();
    for (size_t k = 0; k < rays->sample.factors; k++) {
        const struct results_axis *const axis = rays->sample.factor[k].of;
        table_put(at, axis->name, as_number(nearest->at[k]));
        table_put(of, axis->name, as_number(nearest->of[k]));
        TABLE_APPEND(told, {"name", as_text(axis->name)}, {"is", as_number(nearest->at[k])},
                     {"unit", as_text(axis->unit)}, {"of", as_number(nearest->of[k])});
    }
    return TABLE_OBJECT(
        {"scale", as_number(nearest_scale(nearest))},
        {"bracket", as_tree(json_pack("[f,f]", nearest->end.low, nearest->end.high))},
        {"at", as_tree(at)}, {"of_ranges", as_tree(of)}, {"starts", as_whole(nearest->end.starts)},
        {"agree", as_whole(nearest->end.agree)}, {"unseen", as_number(unseen(nearest))},
        {"simulations", as_whole(nearest->end.asked)}, {"failed", as_whole(nearest->failed)},
        {".off", as_number(0.5 * (nearest->end.high - nearest->end.low))}, {".at", as_tree(told)});
}

/* The ray that ends first, for people, and where it ends: {path: offset}. */
static json_t *first_facts(const struct basin_rays *rays, size_t point, const struct basin_ray *ray,
                           json_t *by_name)
{
    json_t *const at = json_array();
    for (size_t k = 0; k < rays->sample.factors; k++) {
        const struct results_axis *of = rays->sample.factor[k].of;
        const double along = of->value[point], is = along * basin_ray_middle(ray);
        table_put(by_name, of->name, as_number(is));
        TABLE_APPEND(at, {"name", as_text(of->name)}, {"is", as_number(is)},
                     {"off", as_number(fabs(along) * 0.5 * (ray->high - ray->low))},
                     {"unit", as_text(of->unit)});
    }
    return TABLE_OBJECT({"ray", as_whole(point)}, {"low", as_number(ray->low)},
                        {"high", as_number(ray->high)},
                        {"to", as_text(results_kind_names[ray->to])}, {"at", as_tree(at)});
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
        json_t *const at = first ? json_object() : NULL, *const told =
                                                             first ? first_facts(rays, reach.first,
                                                                                 first, at)
                                                                   : NULL;
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
            {{.name = "first_at", .hidden = TABLE_NO_CSV}, as_tree(at)},
            {{.name = ".first"}, as_tree(told)});
        table_end_row(t);
    }
    return true;
}

/* ---- all forms ---------------------------------------------------------------------------- */

static const char text[] = BASIN_TITLE
    "{rays} rays from the equilibrium, along which starts stay {outcome}\n{.over}"
    ": 1 is the ellipsoid within these ranges\n"
    "\nScale at which rays end\n{.rows}"
    "  (go on: to the largest scale, counted as longer than all others; outside: another\n"
    "  outcome at the smallest scale already, or no case known)\n"
    "[!.descends:  (smallest: of these directions, so an upper bound; --descend 8 goes on from "
    "there)\n]"
    "[.alone:[rows/0/nearest:\n  nearest: {scale%.5g} +- {.off%.2g}, by descent from {starts} "
    "ray{starts#s} ({simulations} simulations), at\n"
    "[.at*:    {name%-24s} {is%.5g} {unit}, {of%.2g} of half its range\n]"
    "[starts>1:  {agree} of {starts} descents end within 1 % of it; a nearer end into which "
    "{unseen*%.2g} % of all\n  directions lead would have been missed with a probability of 5 %\n]"
    "[failed:  ({failed} simulations failed and count as not lost)\n]]"
    "\n[rows/0/.first:  ray {ray} ends first, between the scales {low%.6g} and {high%.6g} ({to} "
    "there), at\n[at*:    {name%-24s} {is%.5g} +- {off%.2g} {unit}\n]]]";

bool basin_rays_print(const struct basin_rays *rays, enum table_form form)
{
    struct table t = {0};
    if (!make_table(&t, rays)) {
        table_free(&t);
        return false;
    }
    json_t *const facts =
        TABLE_OBJECT({"outcome", as_text(results_kind_names[rays->of])},
                     {"starts", as_tree(basin_factor_names(&rays->sample))},
                     {"rays", as_whole(rays->sample.points)},
                     {".descends", as_truth(rays->nearest)}, {".alone", as_truth(rays->rows == 1)});
    basin_add_factors(facts, ".over", &rays->sample, "");
    basin_add_axis(facts, ".over", &rays->r->axis[rays->scale]);
    return table_say(form,
                     table_show(basin_titled(rays->r, facts), "rows", &t,
                                rays->nearest
                                    ? "at/ descended smallest median largest crossing open outside"
                                    : "at/ smallest median largest crossing open outside",
                                BASIN_SHOWN),
                     text, &t);
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
