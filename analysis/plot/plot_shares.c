/* plot_shares.c - how the shares of stabilised and rested cases and the extent of the stabilised
 * set depend on a parameter. */
#include "analysis/draw/plot.h"

#include "analysis/basin/basin.h"
#include "analysis/statistics/intervals.h"
#include "runner/base/message.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MAX_EXTENTS = 2, SHARES = 6 };

/* A share, the ends of its likely error (95 %), and its bounds where there are any. */
enum { SHARE, LOW, HIGH, LOWEST, HIGHEST, PARTS };

/* One curve of shares of a kind. */
struct share {
    double (*part)[PARTS]; /* [values] */
    enum results_kind kind;
};

struct page {
    struct gnuplot g;
    const struct results *r;
    struct plot_axis along;
    struct statistics_place *points; /* [values] */
    struct statistics_counts *counts;
    struct share share[SHARES];
    size_t values;
    int first, second; /* axes: that the page runs along, whose values have a curve each, or -1 */
    int count;         /* of shares */
    bool measured;     /* shares of a grid's cases, which have no ends, are not */
    bool bounded;
};

/* ---- shares against a parameter ----------------------------------------------------------- */

/* Kinds whose shares are drawn, two at most: of those that stand or walk what there is, or the
 * first. */
static int choose_kinds(const struct statistics_counts *counts, size_t n, enum results_kind *kinds)
{
    static const enum results_kind wanted[] = {RESULTS_STABILISED, RESULTS_WALKS, RESULTS_RESTED};
    int found = 0;
    for (int k = 0; k < 3 && found < 2; k++) {
        bool any = false;
        for (size_t i = 0; i < n && !any; i++)
            any = counts[i].kind[wanted[k]] > 0;
        if (any || (k == 2 && found == 0))
            kinds[found++] = wanted[any ? k : 0];
    }
    return found;
}

/* The axis that the page runs along, and the second parameter, where there is one alone and it has
 * few values, else -1: the one with more values is run along. */
static void choose_parameters(struct page *page)
{
    const struct results *const r = page->r;
    int parameters = 1, second = -1;
    for (int a = 1; a < r->axes; a++) {
        if (!r->axis[a].offset && a != r->sample) {
            second = a;
            parameters++;
        }
    }
    const bool swap = parameters == 2 && r->axis[second].count > r->axis[0].count;
    page->first = swap ? second : 0;
    page->second = swap ? 0 : second;
    if (parameters != 2 || r->axis[page->second].count < 2 ||
        r->axis[page->second].count > SHARES) {
        page->first = 0;
        page->second = -1;
    }
}

/* A curve: of each value the share of the cases that are done; of a sample its interval, where
 * there are starts the volume of the basin. Of a grid of other things the shares are left as they
 * are. Share k is of a kind or, with a second axis, of its point k. */
static bool make_share(struct page *page, size_t k, enum results_kind kind)
{
    const struct results *const r = page->r;
    const int second = page->second;
    const size_t values = page->values, stride = second < 0 ? 1 : r->axis[second].count;
    stance_message *const message = page->g.plot->message;
    const char *by[] = {r->axis[page->first].name, second < 0 ? NULL : r->axis[second].name};
    const struct basin_choice choice = {
        .of = kind, .by = by, .by_count = second < 0 ? 1 : 2, .side = 5, .level = 0.95};
    struct interval *const interval = gnuplot_room(&page->g, values, sizeof *interval);
    struct share *const share = &page->share[k];
    struct basin_sample sample;
    struct basin basin;
    bool usage = false;
    *share = (struct share){gnuplot_room(&page->g, values, sizeof *share->part), kind};
    if (!interval || !share->part)
        return no_memory(message);
    for (size_t i = 0; i < values; i++) {
        const struct statistics_counts *const c = &page->counts[second < 0 ? i : i * stride + k];
        double *const part = share->part[i];
        part[SHARE] = part[LOW] = part[HIGH] =
            c->done > 0 ? (double)c->kind[kind] / (double)c->done : NAN;
        part[LOWEST] = part[HIGHEST] = NAN;
    }
    if (!basin_sample_make(&sample, r, message))
        return false;
    if (!basin_make(&basin, r, &choice, &sample, &usage, message)) {
        if (!usage || r->sample < 0 || second >= 0)
            return usage;
        if (!intervals_find(r, kind, page->first, NULL, values, interval))
            return no_memory(message);
        for (size_t i = 0; i < values; i++) {
            share->part[i][LOW] = interval[i].low;
            share->part[i][HIGH] = interval[i].high;
        }
        return page->measured = true;
    }
    page->bounded = basin.averaged < 0; /* over a sample of parameters nothing is certain */
    for (size_t i = 0; i < values; i++) {
        const struct basin_row *const row = /* in the order of the axes */
            &basin.row[second < 0 || page->first < second ? i * stride + (second < 0 ? 0 : k)
                                                          : k * values + i];
        double *const part = share->part[i];
        part[SHARE] = row->volume / basin.box;
        part[LOW] = fmax(0, (row->volume - row->reach) / basin.box);
        part[HIGH] = fmin(1, (row->volume + row->reach) / basin.box);
        part[LOWEST] = page->bounded ? row->low / basin.box : NAN;
        part[HIGHEST] = page->bounded ? row->high / basin.box : NAN;
    }
    basin_free(&basin);
    return page->measured = true;
}

/* The curves: of each kind, or of the second axis's values of stabilised cases, or where there are
 * none of rested ones. */
static bool make_shares(struct page *page)
{
    const bool pair = page->second >= 0;
    const size_t stride = pair ? page->r->axis[page->second].count : 1;
    enum results_kind kinds[2] = {0};
    const int found = choose_kinds(page->counts, page->values * stride, kinds);
    bool good = true;
    page->count = pair ? (int)stride : found;
    for (int k = 0; good && k < page->count; k++)
        good = make_share(page, (size_t)k, kinds[pair ? 0 : k]);
    return good;
}

/* The end of the axis in per cent: the highest end of a share of more than no case at all, of which
 * there is but the tiny end of an interval. */
static double find_most(const struct page *page)
{
    double most = 0;
    for (int k = 0; k < page->count; k++) {
        double highest = 0;
        bool any = false;
        for (size_t i = 0; i < page->values; i++) {
            const double *const part = page->share[k].part[i];
            any = any || part[SHARE] > 0;
            highest = fmax(highest, fmax(part[HIGH], part[HIGHEST])); /* NAN is not looked at */
        }
        most = any ? fmax(most, 100 * highest) : most;
    }
    return most > 0 ? fmin(100, 1.08 * most) : 100;
}

/* The shares in per cent, with their intervals: of words bars, else bands under lines. */
static void put_shares(struct page *page)
{
    static const char *const band = "using 1:%s with filledcurves lc rgb %s fillstyle transparent "
                                    "solid %g",
                             *const bar =
                                 "using 1:2:%s with yerrorbars lc rgb %s pt %d ps 1.1 lw %g";
    const bool words = page->along.axis->word, apart = page->second >= 0;
    struct gnuplot *const g = &page->g;
    char kind[32], label[96];
    for (int pass = page->bounded ? 0 : 1; pass < (words ? 2 : 3); pass++) {
        const char *const ends = pass == 0 ? "5:6" : "3:4";
        for (int k = 0; k < page->count; k++) {
            const struct share *const share = &page->share[k];
            snprintf(kind, sizeof kind, "colour_%s", results_kind_names[share->kind]);
            const char *const colour = apart ? gnuplot_hue((size_t)k) : kind;
            const int type = gnuplot_mark(apart ? (size_t)k : 0);
            if (pass == 2)
                gnuplot_series(g, "using 1:2 with linespoints lc rgb %s lw 2 dt %d pt %d ps 0.8",
                               colour, apart ? k + 1 : 1, type);
            else if (words)
                gnuplot_series(g, bar, ends, colour, pass ? type : 0, pass ? 2.4 : 0.8);
            else
                gnuplot_series(g, band, ends, colour, pass ? 0.35 : 0.12);
            for (size_t i = 0; i < page->values; i++) {
                double row[1 + PARTS] = {page->points[i].value};
                for (int p = 0; p < PARTS; p++)
                    row[1 + p] = 100 * share->part[page->points[i].index][p];
                gnuplot_row(g, row, 1 + PARTS);
            }
            if (pass != 1)
                continue;
            if (apart)
                results_value_text(&page->r->axis[page->second], (size_t)k, true, label,
                                   sizeof label);
            gnuplot_legend(g, colour, apart && !words ? k + 1 : 0, apart ? type : 0,
                           apart ? label : results_kind_names[share->kind], "");
        }
    }
}

/* ---- extents ------------------------------------------------------------------------------ */

/* The panel of the stabilised set along an axis of offsets, for every value of the first axis. */
static void put_extent(struct page *page, int axis)
{
    struct gnuplot *const g = &page->g;
    const struct results_axis *of = &page->r->axis[axis];
    const bool words = page->along.axis->word;
    size_t point[SCENARIO_MAX_AXES] = {0};
    struct statistics_extent extent;
    struct plot_axis range;
    const char *dot = strrchr(of->name, '.');

    plot_axis_make_curve(&range, of);
    gnuplot_panel(g, 150, "");
    gnuplot_axis(g, 'y', PLOT_LINEAR, range.range, dot ? dot + 1 : of->name, of->unit);
    gnuplot_series(g, "using 1:2 with lines dt 2 lc rgb 0x909090");
    gnuplot_segment(g, page->along.range.low, 0, page->along.range.high, 0);
    gnuplot_series(g, words ? "using 1:2:($1-0.05):($1+0.05):2:3 with boxxyerror lc rgb hue[1] "
                              "fillstyle solid noborder"
                            : "using 1:2:3 with filledcurves lc rgb hue[1] fillstyle transparent "
                              "solid 0.22 notitle, for [k=2:3] '' using 1:k with linespoints lc "
                              "rgb hue[1] lw 1.6 pt 7 ps 0.5");
    for (size_t i = 0; i < page->values; i++) {
        point[0] = page->points[i].index;
        const bool any = statistics_extent(page->r, axis, point, &extent) && extent.any;
        GNUPLOT_ROW(g, page->points[i].value, any ? extent.low : NAN, any ? extent.high : NAN);
    }
}

/* Axes of offsets whose extents are drawn: none when a further parameter is varied, or no case was
 * stabilised. */
static int choose_extents(const struct results *r, int *axes)
{
    struct statistics_counts all;
    int count = 0;
    statistics_count(r, -1, 0, &all);
    if (all.kind[RESULTS_STABILISED] == 0)
        return 0;
    for (int a = 1; a < r->axes; a++) {
        if (!r->axis[a].offset)
            return 0;
        if (count < MAX_EXTENTS && r->axis[a].count > 1)
            axes[count++] = a;
    }
    return count;
}

/* ---- the page ----------------------------------------------------------------------------- */

static void say(struct page *page)
{
    const struct results *const r = page->r;
    const bool pair = page->second >= 0;
    const size_t values = page->values * (pair ? r->axis[page->second].count : 1);
    const uint64_t each = r->cases / (values ? values : 1);
    gnuplot_say(&page->g, "%s cases against %s%s%s, %llu case%s per %s",
                !pair && page->count > 1                ? "Stabilised and rested"
                : page->share[0].kind == RESULTS_RESTED ? "Rested"
                                                        : "Stabilised",
                page->along.axis->name, pair ? " and " : "", pair ? r->axis[page->second].name : "",
                (unsigned long long)each, each == 1 ? "" : "s", pair ? "pair of values" : "value");
    plot_say_failed(&page->g);
    plot_say_cut(&page->g, statistics_judged(r), true);
}

static void put(struct page *page)
{
    struct gnuplot *const g = &page->g;
    int extents[MAX_EXTENTS];
    const int extent_count = choose_extents(page->r, extents);
    const bool words = page->along.axis->word != NULL;
    say(page);
    plot_axis_write(&page->along, g, 'x');
    if (page->second >= 0)
        gnuplot_text(g, page->r->axis[page->second].name, "legend_head");
    gnuplot_panel(g, 300, "");
    gnuplot_axis(g, 'y', PLOT_LINEAR, (struct plot_range){0, find_most(page)},
                 page->measured ? "share of the box of starts (%)" : "share of the cases done (%)",
                 "");
    put_shares(page);
    for (int k = 0; k < extent_count; k++)
        put_extent(page, extents[k]);
    if (page->measured)
        gnuplot_note(g, "%s: likely error (95 %%)%s", words ? "bars" : "band",
                     !page->bounded ? ""
                     : words        ? ", thin: certain bounds"
                                    : ", light: certain bounds");
    if (extent_count > 0)
        gnuplot_note(g, "below: how far it is stabilised along each axis through the equilibrium");
}

bool plot_shares(const struct plot *plot)
{
    const struct results *const r = plot->r;
    struct page page = {.r = r};
    if (r->axes < 2 || r->axis[0].offset)
        return true;
    if (!gnuplot_begin(&page.g, plot, "curve"))
        return false;
    choose_parameters(&page);
    plot_axis_make_curve(&page.along, &r->axis[page.first]);
    page.values = page.along.axis->count;
    page.points = plot_axis_points(&page.along, &page.g);
    page.counts =
        gnuplot_room(&page.g, page.values * (page.second < 0 ? 1 : r->axis[page.second].count),
                     sizeof *page.counts);
    if (page.points && page.counts) {
        statistics_count_pair(r, page.first, page.second, page.counts);
        if (gnuplot_needs(&page.g, make_shares(&page)))
            put(&page);
    }
    return gnuplot_end(&page.g);
}
