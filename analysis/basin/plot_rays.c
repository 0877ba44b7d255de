/* plot_rays.c - how far from the equilibrium an outcome reaches: over two coordinates the closed
 * curve in their plane, over more of them the share of directions that have ended against the
 * scale; a curve for each value of a parameter. */
#include "basin_rays.h"

#include "analysis/draw/plot.h"
#include "analysis/statistics/statistics.h"
#include "runner/base/message.h"

#include <math.h>

GNUPLOT_SCRIPT(plot_rays_gp, "analysis/basin/plot_rays.gp");

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
    return page->curves == rows ? curve : curve * (rows - 1) / (page->curves - 1);
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

/* The curve, those rays that were not followed to an end, and the shortest ray. */
static void put_curve(struct page *page, size_t curve, const struct statistics_place *order)
{
    struct gnuplot *const g = &page->g;
    const size_t points = page->rays->sample.points;
    const struct basin_ray *const ray = rays_of(page, curve);
    const struct basin_nearest *const nearest = &page->nearest[curve];
    struct basin_reach reach;
    if (!gnuplot_needs(g, basin_rays_reach(page->rays, row_of(page, curve), &reach) ||
                              statistics_no_memory(page->rays->r, g->plot->message)))
        return;
    gnuplot_block(g, "curve%zu", curve + 1);
    for (size_t i = 0; i <= points; i++)
        put_end(page, order[i % points].index, ray_end(&ray[order[i % points].index]));
    gnuplot_block(g, "open%zu", curve + 1);
    for (size_t p = 0; p < points; p++)
        put_end(page, p, ray[p].end == RAY_OPEN ? ray[p].low : NAN);
    gnuplot_block(g, "first%zu", curve + 1);
    GNUPLOT_ROW(g, 0, 0);
    put_end(page, reach.first, reach.count[RAY_CROSSES] > 0 ? reach.smallest : 0);
    gnuplot_block(g, "nearest%zu", curve + 1);
    if (is_found(nearest))
        GNUPLOT_ROW(g, nearest->at[0], nearest->at[1]);
}

/* Symmetric about the equilibrium, around all ends. */
static void put_range(struct page *page, int k, const char *which)
{
    const struct basin_sample *sample = &page->rays->sample;
    double most = 0;
    for (size_t c = 0; c < page->curves; c++) {
        for (size_t p = 0; p < sample->points; p++) {
            const double end = ray_end(&rays_of(page, c)[p]) * fabs(sample->factor[k].of->value[p]);
            most = end > most ? end : most; /* false for NAN */
        }
    }
    plot_label_write(sample->factor[k].of, &page->g, which);
    gnuplot_number(&page->g, most > 0 ? 1.08 * most : 1, "%s_most", which);
}

static void put_plane(struct page *page)
{
    const struct statistics_place *const order = sort_directions(page);
    put_range(page, 0, "x");
    put_range(page, 1, "y");
    for (size_t c = 0; order && c < page->curves; c++)
        put_curve(page, c, order);
}

/* ---- by scale ----------------------------------------------------------------------------- */

static void put_distribution(struct page *page)
{
    const struct basin_rays *rays = page->rays;
    struct gnuplot *const g = &page->g;
    const size_t points = rays->sample.points;
    double *const end = gnuplot_room(g, points, sizeof *end);
    plot_label_write(&rays->r->axis[rays->scale], g, "x");
    for (size_t c = 0; end && c < page->curves; c++) {
        const struct basin_ray *const ray = rays_of(page, c);
        size_t n = 0;
        for (size_t p = 0; p < points; p++)
            if (ray[p].end == RAY_CROSSES || ray[p].end == RAY_OUTSIDE)
                end[n++] = ray[p].end == RAY_CROSSES ? basin_ray_middle(&ray[p]) : 0;
        statistics_sort(end, n);
        gnuplot_block(g, "curve%zu", c + 1);
        GNUPLOT_ROW(g, 0, 0);
        for (size_t i = 0; i < n; i++)
            GNUPLOT_ROW(g, end[i], 100 * (double)(i + 1) / (double)points);
        gnuplot_block(g, "nearest%zu", c + 1);
        if (is_found(&page->nearest[c]))
            GNUPLOT_ROW(g, page->nearest[c].end.high, 0);
    }
}

/* ---- the page ----------------------------------------------------------------------------- */

static void put_legend(struct page *page, bool plane)
{
    static const int types[CURVES] = {7, 5, 9, 11, 15, 13}; /* of points */
    const struct basin_rays *const rays = page->rays;
    const bool several = page->curves > 1;
    char text[400] = "", value[128];
    for (int k = 0; k < rays->by_axes; k++)
        add_text(text, sizeof text, "%s%s", k ? ", " : "", rays->r->axis[rays->by[k]].name);
    gnuplot_text(&page->g, text, "legend_head");
    for (size_t c = 0; c < page->curves; c++) {
        snprintf(text, sizeof text, "%s", rays->by_axes ? "" : results_kind_names[rays->of]);
        for (int k = 0; k < rays->by_axes; k++) {
            results_value_text(&rays->r->axis[rays->by[k]],
                               basin_rays_point(rays, row_of(page, c), k), true, value,
                               sizeof value);
            add_text(text, sizeof text, "%s%.100s", k ? ", " : "", value);
        }
        gnuplot_legend(&page->g, gnuplot_hue(c), several, several ? types[c] : 0, text, "");
    }
    if (plane) {
        gnuplot_note(&page->g, "cross: the equilibrium");
        gnuplot_note(&page->g, "dashed: the ray that ends first");
        gnuplot_note(&page->g, "circles: followed no further");
    }
    if (is_found(&page->nearest[0]))
        gnuplot_note(&page->g, "diamond: the nearest end");
}

static bool draw(const struct plot *plot, const struct basin_rays *rays)
{
    struct page page = {.rays = rays};
    const bool plane = rays->sample.factors == 2;

    if (!gnuplot_begin(&page.g, plot, "rays", plot_rays_gp))
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
    put_legend(&page, plane);
    gnuplot_set(&page.g, "plane = %d; curves = %zu", plane, page.curves);
    (plane ? put_plane : put_distribution)(&page);
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
