/* plot_rays.c - how far from the equilibrium an outcome reaches: over two coordinates the closed
 * curve in their plane, over more of them the share of directions that have ended against the
 * scale; a curve for each value of a parameter. */
#include "basin_rays.h"

#include "analysis/draw/plot.h"
#include "analysis/statistics/statistics.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

GNUPLOT_SCRIPT(plot_rays_gp, "analysis/basin/plot_rays.gp");

enum { CURVES = 6 };

struct page {
    struct gnuplot g;
    const struct plot *plot;
    const struct basin_rays *rays;
    size_t curves;                        /* rows that are drawn, spread over all */
    struct basin_nearest nearest[CURVES]; /* of each; without starts: not sought */
};

static size_t row_of(const struct page *page, size_t curve)
{
    const size_t rows = page->rays->rows;
    return page->curves == rows ? curve : curve * (rows - 1) / (page->curves - 1);
}

static void label_of(const struct page *page, size_t row, char *text, size_t size)
{
    const struct basin_rays *rays = page->rays;
    size_t used = 0;
    snprintf(text, size, "%s", results_kind_names[rays->of]);
    for (int k = 0; k < rays->by_axes && used < size; k++) {
        char value[128];
        results_value_text(&rays->r->axis[rays->by[k]], basin_rays_point(rays, row, k), true, value,
                           sizeof value);
        used += (size_t)snprintf(text + used, size - used, "%s%.100s", k ? ", " : "", value);
    }
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

struct direction {
    double angle;
    size_t ray;
};

static int by_angle(const void *a, const void *b)
{
    const double x = ((const struct direction *)a)->angle, y = ((const struct direction *)b)->angle;
    return (x > y) - (x < y);
}

/* The rays of the sample by their direction; freed by the caller, NULL: no memory. */
static struct direction *sort_directions(const struct basin_sample *sample)
{
    struct direction *list = malloc(sample->points * sizeof *list);
    double half[2];
    for (int k = 0; k < 2; k++) { /* angles in units of the ranges */
        half[k] = isfinite(sample->factor[k].from)
                      ? 0.5 * fabs(sample->factor[k].to - sample->factor[k].from)
                      : 1;
    }
    for (size_t p = 0; list && p < sample->points; p++) {
        list[p].angle = atan2(sample->factor[1].of->value[p] / half[1],
                              sample->factor[0].of->value[p] / half[0]);
        list[p].ray = p;
    }
    if (list)
        qsort(list, sample->points, sizeof *list, by_angle);
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
static bool put_curve(struct page *page, size_t curve, const struct direction *order)
{
    const struct basin_sample *sample = &page->rays->sample;
    const struct basin_ray *ray = page->rays->ray + row_of(page, curve) * sample->points;
    struct basin_reach reach;
    if (!basin_rays_reach(page->rays, row_of(page, curve), &reach))
        return false;
    gnuplot_block(&page->g, "curve%zu", curve + 1);
    for (size_t i = 0; i <= sample->points; i++) {
        const size_t p = order[i % sample->points].ray;
        put_end(page, p, ray_end(&ray[p]));
    }
    gnuplot_end_block(&page->g);
    gnuplot_block(&page->g, "open%zu", curve + 1);
    for (size_t p = 0; p < sample->points; p++)
        put_end(page, p, ray[p].end == RAY_OPEN ? ray[p].low : NAN);
    gnuplot_end_block(&page->g);
    gnuplot_block(&page->g, "first%zu", curve + 1);
    GNUPLOT_ROW(&page->g, 0, 0);
    put_end(page, reach.first, reach.count[RAY_CROSSES] > 0 ? reach.smallest : 0);
    gnuplot_end_block(&page->g);
    const struct basin_nearest *nearest = &page->nearest[curve];
    gnuplot_block(&page->g, "nearest%zu", curve + 1);
    GNUPLOT_ROW(&page->g, is_found(nearest) ? nearest->at[0] : NAN,
                is_found(nearest) ? nearest->at[1] : NAN);
    gnuplot_end_block(&page->g);
    return true;
}

/* Symmetric about the equilibrium, around all ends. */
static void put_range(struct page *page, int k, const char *which)
{
    const struct basin_sample *sample = &page->rays->sample;
    double most = 0;
    for (size_t c = 0; c < page->curves; c++) {
        const struct basin_ray *ray = page->rays->ray + row_of(page, c) * sample->points;
        for (size_t p = 0; p < sample->points; p++) {
            const double end = ray_end(&ray[p]) * fabs(sample->factor[k].of->value[p]);
            most = end > most ? end : most; /* false for NAN */
        }
    }
    plot_label_write(sample->factor[k].of, &page->g, which);
    gnuplot_number(&page->g, most > 0 ? 1.08 * most : 1, "%s_most", which);
}

static bool put_plane(struct page *page, stance_message *message)
{
    struct direction *order = sort_directions(&page->rays->sample);
    if (!order)
        return statistics_no_memory(page->rays->r, message);
    put_range(page, 0, "x");
    put_range(page, 1, "y");
    bool good = true;
    for (size_t c = 0; good && c < page->curves; c++)
        good = put_curve(page, c, order) || statistics_no_memory(page->rays->r, message);
    free(order);
    return good;
}

/* ---- by scale ----------------------------------------------------------------------------- */

static bool put_distribution(struct page *page, stance_message *message)
{
    const struct basin_rays *rays = page->rays;
    const size_t points = rays->sample.points;
    double *end = malloc(points * sizeof *end);
    if (!end)
        return statistics_no_memory(rays->r, message);
    plot_label_write(&rays->r->axis[rays->scale], &page->g, "x");
    for (size_t c = 0; c < page->curves; c++) {
        const struct basin_ray *ray = rays->ray + row_of(page, c) * points;
        size_t n = 0;
        for (size_t p = 0; p < points; p++)
            if (ray[p].end == RAY_CROSSES || ray[p].end == RAY_OUTSIDE)
                end[n++] = ray[p].end == RAY_CROSSES ? basin_ray_middle(&ray[p]) : 0;
        statistics_sort(end, n);
        gnuplot_block(&page->g, "curve%zu", c + 1);
        GNUPLOT_ROW(&page->g, 0, 0);
        for (size_t i = 0; i < n; i++)
            GNUPLOT_ROW(&page->g, end[i], 100 * (double)(i + 1) / (double)points);
        gnuplot_end_block(&page->g);
        gnuplot_block(&page->g, "nearest%zu", c + 1);
        GNUPLOT_ROW(&page->g, is_found(&page->nearest[c]) ? page->nearest[c].end.high : NAN, 0);
        gnuplot_end_block(&page->g);
    }
    free(end);
    return true;
}

/* ---- the page ----------------------------------------------------------------------------- */

static void put_legend(struct page *page, bool plane)
{
    static const char *const notes[] = {"cross: the equilibrium", "dashed: the ray that ends first",
                                        "circles: followed no further"};
    static const int types[CURVES] = {7, 5, 9, 11, 15, 13}; /* of points */
    const struct basin_rays *rays = page->rays;
    char text[400] = "", colour[32];
    size_t used = 0;
    for (int k = 0; k < rays->by_axes && used < sizeof text; k++) {
        used += (size_t)snprintf(text + used, sizeof text - used, "%s%s", k ? ", " : "",
                                 rays->r->axis[rays->by[k]].name);
    }
    gnuplot_text(&page->g, text, "legend_head");
    for (size_t c = 0; c < page->curves; c++) {
        label_of(page, row_of(page, c), text, sizeof text);
        snprintf(colour, sizeof colour, "hue[%zu]", c + 1);
        gnuplot_legend_mark(&page->g, colour, page->curves > 1, page->curves > 1 ? types[c] : 0,
                            text, "");
    }
    for (size_t k = 0; plane && k < sizeof notes / sizeof notes[0]; k++)
        gnuplot_note(&page->g, notes[k]);
    if (is_found(&page->nearest[0]))
        gnuplot_note(&page->g, "diamond: the nearest end");
}

static bool draw(const struct plot *plot, const struct basin_rays *rays, stance_message *message)
{
    struct page page = {.plot = plot, .rays = rays};
    const bool plane = rays->sample.factors == 2;
    char what[1200];

    page.curves = rays->rows < CURVES ? rays->rows : CURVES;
    seek_nearest(&page);
    const bool nearest = page.curves == 1 && is_found(&page.nearest[0]);
    size_t used =
        (size_t)snprintf(what, sizeof what, "Where %zu rays from the equilibrium cease to be %s%s",
                         rays->sample.points, results_kind_names[rays->of],
                         nearest ? "; nearest end in units of half the ranges:" : "");
    for (size_t k = 0; nearest && k < rays->sample.factors && used < sizeof what; k++)
        used += (size_t)snprintf(what + used, sizeof what - used, "%s %s %.2g", k ? "," : "",
                                 rays->sample.factor[k].of->name, page.nearest[0].of[k]);
    if (!plot_begin(plot, &page.g, plot_rays_gp, what, message))
        return false;
    put_legend(&page, plane);
    gnuplot_set(&page.g, "plane = %d; curves = %zu", plane, page.curves);
    if (!(plane ? put_plane : put_distribution)(&page, message)) {
        gnuplot_abandon(&page.g);
        return false;
    }
    return plot_end(plot, &page.g, "rays", message);
}

bool plot_rays(const struct plot *plot, stance_message *message)
{
    struct basin_sample sample;
    struct basin_rays rays;
    if (plot->r->sample < 0)
        return true;
    if (!basin_sample_make(&sample, plot->r, message))
        return false;
    if (!basin_is_rays(plot->r, &sample)) {
        basin_sample_free(&sample);
        return true;
    }
    if (!basin_rays_make(&rays, plot->r, statistics_judged(plot->r), &sample, message))
        return false;
    const bool good = draw(plot, &rays, message);
    basin_rays_free(&rays);
    return good;
}
