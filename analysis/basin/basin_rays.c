/* basin_rays.c - follows each ray from the smallest scale to where the outcome is lost, and says
 * where that is, to people and to programs. */
#include "basin_print.h"

#include "analysis/statistics/statistics.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int find_scale(const struct results *r)
{
    for (int a = 0; a < r->axes; a++)
        if (strcmp(r->axis[a].name, "initial.offset.scale") == 0 && r->axis[a].count > 1)
            return a;
    return -1;
}

bool basin_is_rays(const struct results *r, const struct basin_sample *sample)
{
    return sample->axis >= 0 && sample->method == DOE_SPHERE && !sample->others &&
           find_scale(r) >= 0;
}

/* One ray: its cases are kind[place * stride]. */
static struct basin_ray follow(const struct statistics_place *scale, size_t count,
                               const uint8_t *kind, uint64_t stride, enum results_kind of)
{
    struct basin_ray ray = {RAY_UNKNOWN, NAN, NAN, of};
    for (size_t i = 0; i < count; i++) {
        const uint8_t here = kind[scale[i].index * stride];
        if (here == RESULTS_PENDING || here == RESULTS_FAILED)
            continue; /* the bracket grows over it */
        if (here != of) {
            ray.end = ray.end == RAY_UNKNOWN ? RAY_OUTSIDE : RAY_CROSSES;
            ray.high = scale[i].value;
            ray.to = (enum results_kind)here;
            return ray;
        }
        ray.end = RAY_OPEN;
        ray.low = scale[i].value;
    }
    return ray;
}

static void follow_all(struct basin_rays *rays, const struct statistics_place *scale)
{
    const struct results *r = rays->r;
    const uint64_t step = statistics_stride(r, rays->scale),
                   next = statistics_stride(r, rays->sample.axis);
    for (size_t row = 0; row < rays->rows; row++) {
        size_t point[SCENARIO_MAX_AXES];
        const uint64_t first = statistics_row(r, rays->by, rays->by_axes, row, point);
        for (size_t p = 0; p < rays->sample.points; p++)
            rays->ray[row * rays->sample.points + p] = follow(
                scale, r->axis[rays->scale].count, r->kind + first + p * next, step, rays->of);
    }
}

bool basin_rays_make(struct basin_rays *rays, const struct results *r, enum results_kind of,
                     struct basin_sample *sample, stance_message *message)
{
    *rays =
        (struct basin_rays){.r = r, .of = of, .sample = *sample, .scale = find_scale(r), .rows = 1};
    *sample = (struct basin_sample){.axis = -1};
    for (int a = 0; a < r->axes; a++) {
        if (a != rays->scale && a != rays->sample.axis) {
            rays->by[rays->by_axes++] = a;
            rays->rows *= r->axis[a].count;
        }
    }
    const struct results_axis *const along = &r->axis[rays->scale];
    struct statistics_place *const scale = statistics_ordered(along->value, along->count);
    rays->ray = malloc(rays->rows * rays->sample.points * sizeof *rays->ray);
    const bool good = scale && rays->ray;
    if (good)
        follow_all(rays, scale);
    else
        basin_rays_free(rays);
    free(scale);
    return good || statistics_no_memory(r, message);
}

void basin_rays_free(struct basin_rays *rays)
{
    basin_sample_free(&rays->sample);
    free(rays->ray);
    free(rays->nearest);
    rays->ray = NULL;
    rays->nearest = NULL;
}

bool basin_rays_reach(const struct basin_rays *rays, size_t row, struct basin_reach *reach)
{
    const struct basin_ray *ray = rays->ray + row * rays->sample.points;
    double *middle = malloc(rays->sample.points * sizeof *middle);
    size_t n = 0;

    *reach = (struct basin_reach){.smallest = NAN, .median = NAN, .largest = NAN};
    if (!middle)
        return false;
    for (size_t p = 0; p < rays->sample.points; p++) {
        reach->count[ray[p].end]++;
        if (ray[p].end != RAY_CROSSES && ray[p].end != RAY_OPEN)
            continue;
        middle[n] = ray[p].end == RAY_OPEN ? INFINITY : basin_ray_middle(&ray[p]);
        if (isfinite(middle[n]) && !(middle[n] >= reach->smallest)) { /* true against NAN */
            reach->smallest = middle[n];
            reach->first = p;
        }
        n++;
    }
    statistics_sort(middle, n);
    if (n > 0) {
        const double median = 0.5 * (middle[(n - 1) / 2] + middle[n / 2]);
        reach->median = isfinite(median) ? median : NAN;
        reach->largest = isfinite(middle[n - 1]) ? middle[n - 1] : NAN;
    }
    free(middle);
    return true;
}

/* ---- the table ---------------------------------------------------------------------------- */

static const struct basin_ray *ray_of(const struct basin_rays *rays, size_t row, size_t point)
{
    return &rays->ray[row * rays->sample.points + point];
}

/* Where a ray ends; NULL: nothing. */
static void add_end(struct table *t, const struct basin_rays *rays, size_t p,
                    const struct basin_ray *ray)
{
    for (size_t k = 0; k < rays->sample.factors; k++) {
        const struct results_axis *of = rays->sample.factor[k].of;
        TABLE_FACTS(t, {{.name = of->name, .hidden = TABLE_NO_JSON},
                        as_number(ray ? of->value[p] * basin_ray_middle(ray) : NAN)});
    }
}

static void add_parameters(struct table *t, const struct basin_rays *rays, size_t row)
{
    size_t point[SCENARIO_MAX_AXES];
    statistics_row(rays->r, rays->by, rays->by_axes, row, point);
    table_axes(t, rays->r, rays->by, rays->by_axes, point);
}

/* The nearest end that descents have found. All their starts but the shortest ray are spread
 * evenly: what they have not seen is a dip that leads into fewer directions. */
#define NEAREST(X)                                                                                 \
    X("scale", "", as_number(scale))                                                               \
    X("bracket", "[low, high]", as_tree(table_pair(end->low, end->high)))                          \
    X("at", "{path: value}", as_tree(at))                                                          \
    X("of_ranges", "{path: in units of half the range}", as_tree(of))                              \
    X("starts", "", as_whole(end->starts))                                                         \
    X("agree", "", as_whole(end->agree))                                                           \
    X("unseen", "share of directions",                                                             \
      as_number(end->starts > 1 ? basin_descend_unseen(end->starts - 1) : NAN))                    \
    X("simulations", "", as_whole(end->asked))                                                     \
    X("failed", "", as_whole(nearest->failed))

static json_t *nearest_json(const struct basin_rays *rays, const struct basin_nearest *nearest)
{
    const struct descend_end *const end = &nearest->end;
    const double scale = 0.5 * (end->low + end->high);
    json_t *at = json_object(), *of = json_object();
    for (size_t k = 0; k < rays->sample.factors; k++) {
        const char *const name = rays->sample.factor[k].of->name;
        table_put(at, name, as_number(nearest->at[k]));
        table_put(of, name, as_number(nearest->of[k]));
    }
    return TABLE_OBJECT(NEAREST(TABLE_MEMBER){".off", as_number(0.5 * (end->high - end->low))});
}

/* Of a row; `first` is the ray that ends first, NULL: none does, `nearest` NULL: it is not known.
 */
#define ROW(X)                                                                                     \
    X("rays", NULL, as_whole(rays->sample.points), .hidden = TABLE_NO_JSON)                        \
    X("crossing", "", as_whole(reach.count[RAY_CROSSES]), "rays end", .width = 9)                  \
    X("open", "", as_whole(reach.count[RAY_OPEN]), "go on", .width = 9)                            \
    X("outside", "", as_whole(reach.count[RAY_OUTSIDE] + reach.count[RAY_UNKNOWN]), "outside",     \
      .width = 9)                                                                                  \
    X("descended", NULL, as_number(nearest ? 0.5 * (nearest->end.low + nearest->end.high) : NAN),  \
      "nearest", "%.5g", 10, .hidden = TABLE_NO_JSON)                                              \
    X("nearest", NULL, as_tree(nearest ? nearest_json(rays, nearest) : NULL))                      \
    X("smallest", "", as_number(reach.smallest), "smallest", "%.5g", 10)                           \
    X("median", "", as_number(reach.median), "median", "%.5g", 10)                                 \
    X("largest", "", as_number(reach.largest), "largest", "%.5g", 10)                              \
    X("first_ray", "", first ? as_whole(reach.first) : as_nothing(NULL))                           \
    X("first_low", NULL, as_number(first ? first->low : NAN), .hidden = TABLE_NO_JSON)             \
    X("first_high", NULL, as_number(first ? first->high : NAN), .hidden = TABLE_NO_JSON)           \
    X("first_bracket", "[low, high]", as_tree(first ? table_pair(first->low, first->high) : NULL)) \
    X("first_at", "{path: value}", as_tree(at))
#define HEAD(X)                                                                                    \
    X("outcome", "", as_text(results_kind_names[rays->of]))                                        \
    X("starts", "[paths]", as_tree(basin_factor_names(&rays->sample)))                             \
    X("rays", "number", as_whole(rays->sample.points))
static const struct say_key nearest_keys[] = {NEAREST(TABLE_KEY){0}};
static const struct say_key row_keys[] = {
    TABLE_KEY_AT ROW(TABLE_KEY){"nearest", "of --descend", nearest_keys}, {0}};
const struct say_key basin_rays_keys[] = {HEAD(TABLE_KEY){"rows", "", row_keys}, {0}};

/* Adds a row; `facts` get what people see of the only one, coordinate by coordinate. */
static bool add_row(struct table *t, const struct basin_rays *rays, size_t row, json_t *facts)
{
    struct basin_reach reach;
    if (!basin_rays_reach(rays, row, &reach))
        return false;
    const struct basin_ray *const first =
        reach.count[RAY_CROSSES] > 0 ? ray_of(rays, row, reach.first) : NULL;
    const struct basin_nearest *nearest = rays->nearest ? &rays->nearest[row] : NULL;
    if (nearest && (nearest->end.starts == 0 || !isfinite(nearest->end.high)))
        nearest = NULL;
    json_t *const at = first ? json_object() : NULL, *const along = json_array();
    for (size_t k = 0; first && k < rays->sample.factors; k++) {
        const struct results_axis *const of = rays->sample.factor[k].of;
        const double u = of->value[reach.first], is = u * basin_ray_middle(first);
        table_put(at, of->name, as_number(is));
        TABLE_APPEND(along, {"name", as_text(of->name)}, {"unit", as_text(of->unit)},
                     {"is", as_number(is)},
                     {"off", as_number(fabs(u) * 0.5 * (first->high - first->low))},
                     {"at", as_number(nearest ? nearest->at[k] : NAN)},
                     {"of", as_number(nearest ? nearest->of[k] : NAN)});
    }
    add_parameters(t, rays, row);
    add_end(t, rays, reach.first, first);
    TABLE_FACTS(t, ROW(TABLE_FACT));
    table_end_row(t);
    TABLE_PUT(facts, {".along", as_tree(along)},
              {".to", as_text(first ? results_kind_names[first->to] : NULL)});
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
    "[.alone:[rows/0:[nearest:\n  nearest: {scale%.5g} +- {.off%.2g}, by descent from {starts} "
    "ray{starts#s} ({simulations} simulations), at\n"
    "[.along*:    {name%-24s} {at%.5g} {unit}, {of%.2g} of half its range\n]"
    "[starts>1:  {agree} of {starts} descents end within 1 % of it; a nearer end into which "
    "{unseen*%.2g} % of all\n  directions lead would have been missed with a probability of 5 %\n]"
    "[failed:  ({failed} simulations failed and count as not lost)\n]]"
    "\n[.to:  ray {first_ray} ends first, between the scales {first_bracket/0%.6g} and "
    "{first_bracket/1%.6g} ({.to} there), at\n"
    "[.along*:    {name%-24s} {is%.5g} +- {off%.2g} {unit}\n]]]]";

int basin_rays_print(const struct basin_rays *rays, enum table_form form)
{
    struct table t = {0};
    json_t *const facts = TABLE_OBJECT(HEAD(TABLE_MEMBER){".descends", as_truth(rays->nearest)},
                                       {".alone", as_truth(rays->rows == 1)});
    bool good = true;
    basin_add_factors(facts, ".over", &rays->sample, "");
    basin_add_axis(facts, ".over", &rays->r->axis[rays->scale]);
    for (size_t row = 0; good && row < rays->rows; row++)
        good = add_row(&t, rays, row, facts);
    const int code =
        basin_say(rays->r, form, facts, &t,
                  rays->nearest ? "at/ descended smallest median largest crossing open outside"
                                : "at/ smallest median largest crossing open outside",
                  text);
    return good ? code : EXIT_IO;
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
