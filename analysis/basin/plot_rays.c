/* plot_rays.c - how far from the equilibrium an outcome reaches: over two coordinates the closed
 * curve in their plane, over more of them the share of directions that have ended against the
 * scale; a curve for each value of a parameter. */
#include "basin_rays.h"

#include "analysis/draw/plot.h"
#include "analysis/statistics/statistics.h"
#include "runner/base/message.h"

#include <math.h>

enum { CURVES = 6 };

struct page {
    struct gnuplot g;
    const struct basin_rays *rays;
    size_t curves;                        /* rows that are drawn, spread over all */
    struct basin_nearest nearest[CURVES]; /* of each; without starts: not sought */
};

static size_t row_of(const struct page *page, size_t curve)
{
    const size_t rows = page->rays->rows;
    return page->curves == rows || page->curves < 2 ? curve
                                                    : curve * (rows - 1) / (page->curves - 1);
}

static const struct basin_ray *rays_of(const struct page *page, size_t curve)
{
    return page->rays->ray + row_of(page, curve) * page->rays->sample.points;
}

/* Descends from the shortest ray of each curve, if cases of the file take so little time that
 * nobody waits. What cannot be simulated is drawn without. */
static void seek_nearest(struct page *page)
{
    static const double quick = 0.002; /* s a case */
    double longest, total, cases;
    size_t ranks;
    stance_message ignored = {""};
    if (!results_timing(page->rays->r, &longest, &total, &cases, &ranks) ||
        !(total < quick * cases))
        return;
    for (size_t c = 0; c < page->curves; c++)
        if (!basin_rays_nearest(page->rays, row_of(page, c), 1, &page->nearest[c], &ignored))
            page->nearest[c].end.starts = 0;
}

static bool is_found(const struct basin_nearest *nearest)
{
    return nearest->end.starts > 0 && isfinite(nearest->end.high);
}

/* ---- in the plane ------------------------------------------------------------------------- */

/* The rays of the sample by their direction; NULL: no memory. */
static struct statistics_place *sort_directions(struct page *page)
{
    const struct basin_sample *const sample = &page->rays->sample;
    struct statistics_place *const list = gnuplot_room(&page->g, sample->points, sizeof *list);
    double half[2];
    for (int k = 0; k < 2; k++) { /* angles in units of the ranges */
        half[k] = isfinite(sample->factor[k].from)
                      ? 0.5 * fabs(sample->factor[k].to - sample->factor[k].from)
                      : 1;
    }
    for (size_t p = 0; list && p < sample->points; p++)
        list[p] = (struct statistics_place){atan2(sample->factor[1].of->value[p] / half[1],
                                                  sample->factor[0].of->value[p] / half[0]),
                                            p};
    if (list)
        statistics_order(list, sample->points);
    return list;
}

/* Where a ray is lost, as two offsets; an open one is drawn to where it was followed. */
static double ray_end(const struct basin_ray *ray)
{
    return ray->end == RAY_CROSSES ? basin_ray_middle(ray) : ray->end == RAY_OPEN ? ray->low : NAN;
}

static void put_end(struct page *page, size_t p, double scale)
{
    const struct basin_sample *sample = &page->rays->sample;
    GNUPLOT_ROW(&page->g, scale * sample->factor[0].of->value[p],
                scale * sample->factor[1].of->value[p]);
}

/* A diamond at the nearest end, on whatever is there. */
static void put_nearest(struct page *page, size_t curve, double x, double y)
{
    gnuplot_series(&page->g,
                   "using 1:2 with points pt 13 ps 1.8 lc rgb 0x000000 notitle, '' using 1:2 with "
                   "points pt 13 ps 1.2 lc rgb %s",
                   gnuplot_hue(curve));
    GNUPLOT_ROW(&page->g, x, y);
}

/* The curve, those rays that were not followed to an end, the shortest ray and the nearest end. */
static void put_curve(struct page *page, size_t curve, const struct statistics_place *order)
{
    struct gnuplot *const g = &page->g;
    const bool several = page->curves > 1;
    const char *const hue = gnuplot_hue(curve);
    const size_t points = page->rays->sample.points;
    const struct basin_ray *const ray = rays_of(page, curve);
    struct basin_reach reach;
    if (!gnuplot_needs(g, basin_rays_reach(page->rays, row_of(page, curve), &reach) ||
                              statistics_no_memory(page->rays->r, g->plot->message)))
        return;
    gnuplot_series(g,
                   "using 1:2 with lines lw 1.6 lc rgb %s notitle, '' using 1:2 every %d with "
                   "points pt %d ps %g lc rgb %s",
                   hue, several ? 8 : 1, gnuplot_mark(curve), several ? 0.9 : 0.3, hue);
    for (size_t i = 0; i <= points; i++)
        put_end(page, order[i % points].index, ray_end(&ray[order[i % points].index]));
    gnuplot_series(g, "using 1:2 with points pt 6 ps 0.7 lc rgb %s", hue);
    for (size_t p = 0; p < points; p++)
        put_end(page, p, ray[p].end == RAY_OPEN ? ray[p].low : NAN);
    gnuplot_series(g, "using 1:2 with lines lw 1.6 dt 2 lc rgb %s", hue);
    GNUPLOT_ROW(g, 0, 0);
    put_end(page, reach.first, reach.count[RAY_CROSSES] > 0 ? reach.smallest : 0);
    if (is_found(&page->nearest[curve]))
        put_nearest(page, curve, page->nearest[curve].at[0], page->nearest[curve].at[1]);
}

static void put_plane(struct page *page)
{
    const struct basin_sample *const sample = &page->rays->sample;
    const struct statistics_place *const order = sort_directions(page);
    for (int k = 0; k < 2; k++) { /* symmetric about the equilibrium, around all ends */
        double most = 0;
        for (size_t c = 0; c < page->curves; c++)
            for (size_t p = 0; p < sample->points; p++)
                most =
                    fmax(most, ray_end(&rays_of(page, c)[p]) *
                                   fabs(sample->factor[k].of->value[p])); /* NAN is passed over */
        most = most > 0 ? 1.08 * most : 1;
        const char *const axis = gnuplot_axis(&page->g, k ? 'y' : 'x', PLOT_LINEAR,
                                              (struct plot_range){-most, most}, "", "");
        plot_label_write(sample->factor[k].of, &page->g, axis);
    }
    gnuplot_panel(&page->g, 440, "");
    for (size_t c = 0; order && c < page->curves; c++)
        put_curve(page, c, order);
    gnuplot_cross(&page->g, 0, 0);
    gnuplot_note(&page->g, "cross: the equilibrium");
    gnuplot_note(&page->g, "dashed: the ray that ends first");
    gnuplot_note(&page->g, "circles: followed no further");
}

/* ---- by scale ----------------------------------------------------------------------------- */

static void put_distribution(struct page *page)
{
    const struct basin_rays *rays = page->rays;
    struct gnuplot *const g = &page->g;
    const size_t points = rays->sample.points;
    double *const end = gnuplot_room(g, points, sizeof *end), most = 0;
    for (size_t c = 0; c < page->curves; c++)
        for (size_t p = 0; p < points; p++)
            if (rays_of(page, c)[p].end == RAY_CROSSES)
                most = fmax(most, basin_ray_middle(&rays_of(page, c)[p]));
    const char *const axis = gnuplot_axis(
        g, 'x', PLOT_LINEAR, (struct plot_range){0, most > 0 ? 1.05 * most : 1}, "", "");
    plot_label_write(&rays->r->axis[rays->scale], g, axis);
    gnuplot_panel(g, 440, "");
    gnuplot_axis(g, 'y', PLOT_LINEAR, (struct plot_range){0, 100}, "directions that have ended (%)",
                 "");
    for (size_t c = 0; end && c < page->curves; c++) {
        const struct basin_ray *const ray = rays_of(page, c);
        size_t n = 0;
        for (size_t p = 0; p < points; p++)
            if (ray[p].end == RAY_CROSSES || ray[p].end == RAY_OUTSIDE)
                end[n++] = ray[p].end == RAY_CROSSES ? basin_ray_middle(&ray[p]) : 0;
        statistics_sort(end, n);
        gnuplot_series(g,
                       "using 1:2 with steps lw 1.8 lc rgb %s notitle, '' using 1:2 every 40::%zu "
                       "with points pt %d ps 0.9 lc rgb %s",
                       gnuplot_hue(c), 12 * (c + 1), page->curves > 1 ? gnuplot_mark(c) : -1,
                       gnuplot_hue(c));
        GNUPLOT_ROW(g, 0, 0);
        for (size_t i = 0; i < n; i++)
            GNUPLOT_ROW(g, end[i], 100 * (double)(i + 1) / (double)points);
        if (is_found(&page->nearest[c]))
            put_nearest(page, c, page->nearest[c].end.high, 0);
    }
}

/* ---- the page ----------------------------------------------------------------------------- */

static void put_legend(struct page *page)
{
    const struct basin_rays *const rays = page->rays;
    const bool several = page->curves > 1;
    char text[400] = "", value[128];
    for (int k = 0; k < rays->by_axes; k++)
        add_text(text, sizeof text, "%s%s", k ? ", " : "", rays->r->axis[rays->by[k]].name);
    gnuplot_text(&page->g, text, "legend_head");
    for (size_t c = 0; c < page->curves; c++) {
        size_t point[SCENARIO_MAX_AXES];
        statistics_row(rays->r, rays->by, rays->by_axes, row_of(page, c), point);
        snprintf(text, sizeof text, "%s", rays->by_axes ? "" : results_kind_names[rays->of]);
        for (int k = 0; k < rays->by_axes; k++) {
            results_value_text(&rays->r->axis[rays->by[k]], point[rays->by[k]], true, value,
                               sizeof value);
            add_text(text, sizeof text, "%s%.100s", k ? ", " : "", value);
        }
        gnuplot_legend(&page->g, gnuplot_hue(c), several, several ? gnuplot_mark(c) : 0, text, "");
    }
    if (is_found(&page->nearest[0]))
        gnuplot_note(&page->g, "diamond: the nearest end");
}

static bool draw(const struct plot *plot, const struct basin_rays *rays)
{
    struct page page = {.rays = rays};
    if (!gnuplot_begin(&page.g, plot, "rays"))
        return false;
    page.curves = rays->rows < CURVES ? rays->rows : CURVES;
    seek_nearest(&page);
    const bool nearest = page.curves == 1 && is_found(&page.nearest[0]);
    gnuplot_say(&page.g, "Where %zu rays from the equilibrium cease to be %s%s",
                rays->sample.points, results_kind_names[rays->of],
                nearest ? "; nearest end in units of half the ranges:" : "");
    for (size_t k = 0; nearest && k < rays->sample.factors; k++)
        gnuplot_say(&page.g, "%s %s %.2g", k ? "," : "", rays->sample.factor[k].of->name,
                    page.nearest[0].of[k]);
    gnuplot_set(&page.g, "chart_width = 520; scaled = 1");
    (rays->sample.factors == 2 ? put_plane : put_distribution)(&page);
    put_legend(&page);
    return gnuplot_end(&page.g);
}

bool plot_rays(const struct plot *plot)
{
    struct basin_sample sample;
    struct basin_rays rays;
    if (plot->r->sample < 0)
        return true;
    if (!basin_sample_make(&sample, plot->r, plot->message))
        return false;
    if (!basin_is_rays(plot->r, &sample)) {
        basin_sample_free(&sample);
        return true;
    }
    if (!basin_rays_make(&rays, plot->r, statistics_judged(plot->r), &sample, plot->message))
        return false;
    const bool good = draw(plot, &rays);
    basin_rays_free(&rays);
    return good;
}
