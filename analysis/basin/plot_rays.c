/* plot_rays.c - how far from the equilibrium an outcome reaches: over two coordinates the closed
 * curve in their plane, over more of them the share of directions that have ended against the
 * scale; a curve for each value of a parameter. */
#include "basin_rays.h"

#include "analysis/draw/plot.h"
#include "analysis/statistics/statistics.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { LEFT = 96, SIZE = 520, HEIGHT = 440, LEGEND = 260, BOTTOM = 84, CURVES = 6 };

/* after Okabe and Ito (2008) */
static const char *const colours[CURVES] = {"#0072b2", "#d55e00", "#009e73",
                                            "#cc79a7", "#e69f00", "#56b4e9"};

struct page {
    struct gnuplot g;
    const struct plot *plot;
    const struct basin_rays *rays;
    double top;
    size_t curves; /* rows that are drawn, spread over all */
};

static bool no_memory(stance_message *message)
{
    snprintf(message->text, sizeof message->text, "stance plot: not enough memory");
    return false;
}

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

static void put_end(FILE *data, const struct basin_sample *sample, size_t p, double scale)
{
    gnuplot_number(data, scale * sample->factor[0].of->value[p]);
    putc(' ', data);
    gnuplot_number(data, scale * sample->factor[1].of->value[p]);
    putc('\n', data);
}

/* The curve, its points, those rays that were not followed to an end, and the shortest ray. */
static bool put_curve(struct page *page, size_t curve, const struct direction *order)
{
    const struct basin_sample *sample = &page->rays->sample;
    const struct basin_ray *ray = page->rays->ray + row_of(page, curve) * sample->points;
    struct basin_reach reach;
    char line[32], open[32], first[32];
    if (!basin_rays_reach(page->rays, row_of(page, curve), &reach))
        return false;
    FILE *data = gnuplot_data(&page->g, line);
    for (size_t i = 0; i <= sample->points; i++) {
        const size_t p = order[i % sample->points].ray;
        put_end(data, sample, p, ray_end(&ray[p]));
    }
    gnuplot_close_data(&page->g, data);
    data = gnuplot_data(&page->g, open);
    for (size_t p = 0; p < sample->points; p++)
        put_end(data, sample, p, ray[p].end == RAY_OPEN ? ray[p].low : NAN);
    gnuplot_close_data(&page->g, data);
    data = gnuplot_data(&page->g, first);
    fputs("0 0\n", data);
    put_end(data, sample, reach.first, reach.smallest);
    gnuplot_close_data(&page->g, data);
    fprintf(page->g.script,
            "%s '%s' using 1:2 with lines lw 1.6 lc rgb '%s' notitle,"
            " '%s' using 1:2 with points pt 7 ps 0.3 lc rgb '%s' notitle,"
            " '%s' using 1:2 with points pt 6 ps 0.7 lc rgb '%s' notitle",
            curve == 0 ? "plot" : ",", line, colours[curve], line, colours[curve], open,
            colours[curve]);
    if (reach.count[RAY_CROSSES] > 0) {
        fprintf(page->g.script, ", '%s' using 1:2 with lines lw 1.6 dt 2 lc rgb '%s' notitle",
                first, colours[curve]);
    }
    return true;
}

/* Symmetric about the equilibrium, around all ends. */
static void put_range(struct page *page, int k, char which)
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
    most = most > 0 ? 1.08 * most : 1;
    fprintf(page->g.script, "set %crange [%.10g:%.10g]\nset %ctics nomirror %.10g\n", which, -most,
            most, which, plot_round_step(-most, most, 8));
}

static bool put_plane(struct page *page, stance_message *message)
{
    struct direction *order = sort_directions(&page->rays->sample);
    if (!order)
        return no_memory(message);
    gnuplot_panel(&page->g, LEFT, page->top, SIZE, HEIGHT);
    put_range(page, 0, 'x');
    put_range(page, 1, 'y');
    fputs("set format x '%.10g'\nset format y '%.10g'\nset grid lt 1 lc rgb '#e6e6e6' lw 0.8\n",
          page->g.script);
    bool good = true;
    for (size_t c = 0; good && c < page->curves; c++)
        good = put_curve(page, c, order) || no_memory(message);
    free(order);
    fputs(", '-' using 1:2 with points pt 1 ps 1.6 lw 2 lc rgb 'black' notitle\n0 0\ne\n",
          page->g.script);
    return good;
}

/* ---- by scale ----------------------------------------------------------------------------- */

static int by_number(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static bool put_distribution(struct page *page, stance_message *message)
{
    const struct basin_rays *rays = page->rays;
    const size_t points = rays->sample.points;
    double *end = malloc(points * sizeof *end);
    if (!end)
        return no_memory(message);
    gnuplot_panel(&page->g, LEFT, page->top, SIZE, HEIGHT);
    fputs("set xrange [0:*]\nset yrange [0:100]\nset xtics nomirror autofreq\nset ytics nomirror "
          "20\nset format x '%.10g'\nset format y '%.10g'\nset grid lt 1 lc rgb '#e6e6e6' lw 0.8\n",
          page->g.script);
    for (size_t c = 0; c < page->curves; c++) {
        const struct basin_ray *ray = rays->ray + row_of(page, c) * points;
        char name[32];
        size_t n = 0;
        for (size_t p = 0; p < points; p++)
            if (ray[p].end == RAY_CROSSES || ray[p].end == RAY_OUTSIDE)
                end[n++] = ray[p].end == RAY_CROSSES ? basin_ray_middle(&ray[p]) : 0;
        qsort(end, n, sizeof *end, by_number);
        FILE *data = gnuplot_data(&page->g, name);
        fputs("0 0\n", data);
        for (size_t i = 0; i < n; i++)
            fprintf(data, "%.10g %.10g\n", end[i], 100 * (double)(i + 1) / (double)points);
        gnuplot_close_data(&page->g, data);
        fprintf(page->g.script, "%s '%s' using 1:2 with steps lw 1.8 lc rgb '%s' notitle",
                c == 0 ? "plot" : ",", name, colours[c]);
    }
    fputs("\n", page->g.script);
    free(end);
    return true;
}

/* ---- the page ----------------------------------------------------------------------------- */

static void put_labels(struct page *page, bool plane)
{
    const struct basin_sample *sample = &page->rays->sample;
    const double x = LEFT + SIZE + 20;
    double y = page->top + 10;
    char text[200];
    if (plane) {
        plot_axis_label(sample->factor[0].of, &page->g, LEFT + SIZE / 2.0, page->top + HEIGHT + 46,
                        SIZE + 80, false);
        plot_axis_label(sample->factor[1].of, &page->g, 16, page->top + HEIGHT / 2.0, HEIGHT, true);
    } else {
        plot_axis_label(&page->rays->r->axis[page->rays->scale], &page->g, LEFT + SIZE / 2.0,
                        page->top + HEIGHT + 46, SIZE + 80, false);
        gnuplot_label(&page->g, 24, page->top + HEIGHT / 2.0, "directions that have ended (%)",
                      "center", 12, true);
    }
    for (int k = 0; k < page->rays->by_axes; k++, y += 20) {
        gnuplot_label(&page->g, x, y, page->rays->r->axis[page->rays->by[k]].name, "left", 11,
                      false);
    }
    for (size_t c = 0; c < page->curves; c++, y += 24) {
        label_of(page, row_of(page, c), text, sizeof text);
        gnuplot_legend(&page->g, x, y, colours[c], text);
    }
    if (plane) {
        gnuplot_label(&page->g, x, y + 8, "cross: the equilibrium", "left", 11, false);
        gnuplot_label(&page->g, x, y + 26, "dashed: the ray that ends first", "left", 11, false);
        gnuplot_label(&page->g, x, y + 44, "circles: followed no further", "left", 11, false);
    }
}

static bool draw(const struct plot *plot, const struct basin_rays *rays, stance_message *message)
{
    struct page page = {.plot = plot, .rays = rays};
    const struct results *r = plot->r;
    const char *title = r->title[0] ? r->title : r->name;
    const bool plane = rays->sample.factors == 2;
    const int width = LEFT + SIZE + LEGEND;
    char what[160], stem[512];

    page.curves = rays->rows < CURVES ? rays->rows : CURVES;
    snprintf(what, sizeof what, "Where %zu rays from the equilibrium cease to be %s",
             rays->sample.points, results_kind_names[rays->of]);
    page.top = gnuplot_title_height(width, title, what);
    if (!gnuplot_begin(&page.g, width, (int)page.top + HEIGHT + BOTTOM, message))
        return false;
    gnuplot_title(&page.g, title, what);
    put_labels(&page, plane);
    gnuplot_decorate(&page.g);
    if (!(plane ? put_plane : put_distribution)(&page, message)) {
        gnuplot_abandon(&page.g);
        return false;
    }
    snprintf(stem, sizeof stem, "%s-rays", plot->stem);
    return gnuplot_end(&page.g, plot->directory, stem, message);
}

bool plot_rays(const struct plot *plot, stance_message *message)
{
    struct basin_sample sample;
    struct basin_rays rays;
    if (!basin_sample_make(&sample, plot->r, message))
        return false;
    if (!basin_is_rays(plot->r, &sample)) {
        basin_sample_free(&sample);
        return true;
    }
    struct statistics_counts counts;
    statistics_count(plot->r, -1, 0, &counts);
    const bool rested = counts.kind[RESULTS_STABILISED] == 0 && counts.kind[RESULTS_RESTED] > 0;
    if (!basin_rays_make(&rays, plot->r, rested ? RESULTS_RESTED : RESULTS_STABILISED, &sample,
                         message))
        return false;
    const bool good = draw(plot, &rays, message);
    basin_rays_free(&rays);
    return good;
}
