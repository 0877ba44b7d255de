/* plot_critical.c - critical values along the axis that sweep.refine alone refines: over one other
 * axis a curve, with what is kept again beyond, and of a sample its interval; over two a map. */
#include "plot_layout.h"

#include "analysis/critical/critical.h"
#include "runner/base/message.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { CURVES = 6 };

struct page {
    struct gnuplot g;
    const struct critical *c;
    struct plot_axis across, up;
    struct statistics_place *points; /* of the axis across */
    int x;                           /* that axis */
    size_t curves, stride;           /* points of the others; rows between points of x */
};

/* ---- places ------------------------------------------------------------------------------- */

static double place(const struct page *page, double value)
{
    return page->up.scale == PLOT_LOG ? log10(value) : value;
}

/* Row k along the axis across of a curve. */
static const struct critical_row *row_of(const struct page *page, size_t curve, size_t k)
{
    const size_t count = page->across.axis->count, inner = page->stride;
    return &page->c->row[(curve / inner * count + page->points[k].index) * inner + curve % inner];
}

static double first_of(const struct page *page)
{
    return place(page, page->c->value[0]);
}

static double last_of(const struct page *page)
{
    return place(page, page->c->value[page->c->count - 1]);
}

/* Midway between the last value kept and the first one lost, which are neighbours; the last one
 * where it is beyond; else there is none. */
static double number_of(const struct page *page, const struct critical_row *row)
{
    const struct critical_value *const v = &row->value;
    const bool found = v->end == CRITICAL_LOST && v->unknown == 0;
    return v->end == CRITICAL_KEPT ? last_of(page)
           : found                 ? 0.5 * (place(page, v->kept) + place(page, v->lost))
                                   : NAN;
}

/* ---- a curve ------------------------------------------------------------------------------ */

static void put_islands(struct page *page, size_t curve, const char *colour)
{
    gnuplot_series(&page->g,
                   "using 1:2:3:4:5:6 with boxxyerror lc rgb %s fillstyle transparent solid 0.16 "
                   "noborder",
                   colour);
    for (size_t k = 0; k < page->across.axis->count; k++) {
        const struct critical_row *const row = row_of(page, curve, k);
        const double x = page->points[k].value;
        const double low = k > 0 ? 0.5 * (x + page->points[k - 1].value) : page->across.range.low;
        const double high = k + 1 < page->across.axis->count ? 0.5 * (x + page->points[k + 1].value)
                                                             : page->across.range.high;
        for (size_t i = 0; i < row->islands; i++) {
            const struct critical_island *const island = &page->c->island[row->island + i];
            const double from = place(page, island->from[1]), to = place(page, island->to[0]);
            GNUPLOT_ROW(&page->g, x, from, low, high, fmin(from, to), fmax(from, to));
        }
    }
}

static void put_band(struct page *page, size_t curve, const char *colour)
{
    const bool interval = page->c->sampled;
    gnuplot_series(&page->g,
                   "using 1:2:3 with filledcurves lc rgb %s fillstyle transparent solid %g", colour,
                   interval ? 0.3 : 0.35);
    for (size_t k = 0; k < page->across.axis->count; k++) {
        const struct critical_row *const row = row_of(page, curve, k);
        const double low = place(page, row->value.low), high = place(page, row->value.high);
        const double number = number_of(page, row), kept = place(page, row->value.kept);
        GNUPLOT_ROW(&page->g, page->points[k].value, !interval || isnan(low) ? first_of(page) : low,
                    !interval     ? (isnan(number) ? fmax(kept, first_of(page)) : number)
                    : isnan(high) ? last_of(page)
                                  : high);
    }
}

static void put_curve(struct page *page, size_t curve)
{
    struct gnuplot *const g = &page->g;
    const struct critical *const c = page->c;
    const bool several = page->curves > 1;
    char kind[32], text[200] = "";
    snprintf(kind, sizeof kind, "colour_%s", results_kind_names[c->of]);
    const char *const colour = several ? gnuplot_hue(curve) : kind;
    bool islands = false;
    for (size_t k = 0; k < page->across.axis->count; k++)
        islands = islands || row_of(page, curve, k)->islands > 0;
    if (islands)
        put_islands(page, curve, colour);
    if (c->sampled ? !c->blocks && c->choice.share < 1 : !several)
        put_band(page, curve, colour);
    gnuplot_series(g, "using 1:2 with linespoints lw 2 pt %d ps %g lc rgb %s", gnuplot_mark(curve),
                   several ? 0.8 : 0.5, several ? colour : "0x202020");
    for (size_t k = 0; k < page->across.axis->count; k++)
        GNUPLOT_ROW(g, page->points[k].value, number_of(page, row_of(page, curve, k)));
    for (int b = 0; b < c->by_axes; b++) {
        const struct results_axis *const axis = &c->r->axis[c->by[b]];
        char value[96];
        if (c->by[b] == page->x || axis->count < 2)
            continue;
        plot_value_title(g, axis, row_of(page, curve, 0)->point[c->by[b]], PLOT_LAST_WORDS, value,
                         sizeof value);
        add_text(text, sizeof text, "%s%s", text[0] ? ", " : "", value);
    }
    gnuplot_legend(g, several ? colour : "0x202020", 1, gnuplot_mark(curve),
                   several ? text : "critical value", "");
    if (!several && !c->sampled)
        gnuplot_legend(g, colour, 0, 0, results_kind_names[c->of], "");
    if (islands && !several)
        gnuplot_note(g, "light: %s again beyond it", results_kind_names[c->of]);
}

static struct plot_range shown(const struct page *page)
{
    const struct critical *const c = page->c;
    struct plot_range range = PLOT_NOTHING;
    if (page->curves == 1 && !c->sampled)
        plot_widen(&range, first_of(page));
    for (size_t k = 0; k < c->rows; k++) {
        const struct critical_row *const row = &c->row[k];
        plot_widen(&range, number_of(page, row));
        plot_widen(&range, place(page, row->value.low));
        plot_widen(&range, place(page, row->value.high));
        for (size_t i = 0; i < row->islands; i++)
            plot_widen(&range, place(page, c->island[row->island + i].to[0]));
    }
    return plot_roomy(range, 0.04);
}

static void said(const struct critical *c, char *text, size_t size)
{
    char from[96];
    results_value_text(&c->r->axis[c->along], c->order[0], true, from, sizeof from);
    snprintf(text, size, "Up to which %s, from %s on, ", c->r->axis[c->along].name, from);
    if (c->sampled)
        add_text(text, size, "at least %g %% of %u points end as %s", 100 * c->choice.share,
                 c->points, results_kind_names[c->of]);
    else
        add_text(text, size, "cases end as %s", results_kind_names[c->of]);
}

static bool draw_curves(const struct plot *plot, const struct critical *c, int x)
{
    struct page page = {.c = c, .x = x, .stride = 1};
    char text[400];
    const struct results_axis *const along = &c->r->axis[c->along];
    if (!gnuplot_begin(&page.g, plot, "critical"))
        return false;
    plot_axis_make_curve(&page.across, &c->r->axis[x]);
    plot_axis_make_curve(&page.up, along);
    page.points = plot_axis_points(&page.across, &page.g);
    page.curves = c->rows / c->r->axis[x].count;
    for (int b = 0; b < c->by_axes; b++)
        page.stride *= c->by[b] > x ? c->r->axis[c->by[b]].count : 1;
    if (page.points) {
        said(c, text, sizeof text);
        gnuplot_say(&page.g, "%s", text);
        plot_axis_write(&page.across, &page.g, 'x');
        gnuplot_panel(&page.g, 360, "");
        gnuplot_axis(&page.g, 'y', page.up.scale == PLOT_LOG ? PLOT_LOG : PLOT_LINEAR, shown(&page),
                     look_label(plot->look, along->name), along->unit);
        for (size_t k = 0; k < page.curves; k++)
            put_curve(&page, k);
        if (c->sampled && !c->blocks && c->choice.share < 1)
            gnuplot_note(&page.g, "band: interval (%g %%)", 100 * c->choice.level);
    }
    return gnuplot_end(&page.g);
}

/* ---- a map -------------------------------------------------------------------------------- */

/* As if the file had the other axes alone, and a case for each row. */
static bool draw_map(const struct plot *plot, const struct critical *c)
{
    const struct results_axis *const along = &c->r->axis[c->along];
    struct plot rows = *plot;
    struct results *const own = malloc(sizeof *own);
    double *const values = malloc(c->rows * sizeof *values);
    uint8_t *const kind = malloc(c->rows);
    char text[400];
    bool good = (own && kind && values) || no_memory(plot->message);
    if (good) {
        *own = *c->r;
        own->single = true; /* nothing more is looked for in the file */
        own->sample = -1;
        own->axes = c->by_axes;
        own->cases = c->rows;
        own->kind = kind;
        for (int b = 0; b < c->by_axes; b++)
            own->axis[b] = c->r->axis[c->by[b]];
        for (size_t k = 0; k < c->rows; k++) {
            kind[k] = (uint8_t)c->of;
            values[k] = c->row[k].value.kept;
        }
        rows.r = own;
        said(c, text, sizeof text);
        good = plot_number_map(&rows,
                               &(struct plot_number){"critical", text, along->unit, "lost at once",
                                                     RESULTS_KIND_COUNT, along->name},
                               values);
    }
    free(own);
    free(values);
    free(kind);
    return good;
}

/* ---- which -------------------------------------------------------------------------------- */

/* The axis with most values, words last, along which at most CURVES others are drawn; -1: none. */
static int choose_across(const struct critical *c)
{
    int best = -1, axes = 0;
    for (int b = 0; b < c->by_axes; b++) {
        const struct results_axis *const axis = &c->r->axis[c->by[b]];
        const struct results_axis *const other = best < 0 ? NULL : &c->r->axis[best];
        axes += axis->count > 1;
        if (axis->count > 1 && (!other || (!axis->word && other->word) ||
                                (!axis->word == !other->word && axis->count > other->count)))
            best = c->by[b];
    }
    return best >= 0 && (axes == 1 || c->rows / c->r->axis[best].count <= CURVES) ? best : -1;
}

bool plot_critical(const struct plot *plot)
{
    const struct critical_choice choice = {.share = 0.9, .level = 0.95};
    const struct results *const r = plot->r;
    struct critical critical;
    bool usage, good = true;
    if (!critical_is_refined(r))
        return true;
    if (!critical_make(&critical, r, NULL, statistics_judged(r), &choice, &usage, plot->message))
        return usage;
    const int across = choose_across(&critical);
    if (across >= 0)
        good = draw_curves(plot, &critical, across);
    else if (critical.by_axes > 1)
        good = draw_map(plot, &critical);
    critical_free(&critical);
    return good;
}
