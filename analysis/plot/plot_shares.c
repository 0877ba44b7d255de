/* plot_shares.c - how the shares of stabilised and rested cases and the extent of the stabilised
 * set depend on a parameter. */
#include "plot_points.h"

#include "analysis/basin/basin.h"
#include "analysis/statistics/intervals.h"
#include "analysis/statistics/statistics.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

GNUPLOT_SCRIPT(plot_shares_gp, "analysis/plot/plot_shares.gp");

static bool no_memory(stance_message *message)
{
    snprintf(message->text, sizeof message->text, "stance plot: not enough memory");
    return false;
}

static int by_place(const void *a, const void *b)
{
    double x = ((const struct plot_point *)a)->place, y = ((const struct plot_point *)b)->place;
    return (x > y) - (x < y);
}

struct plot_point *plot_points_make(const struct plot_axis *along, stance_message *message)
{
    size_t n = along->axis->count;
    struct plot_point *points = malloc(n * sizeof *points);
    for (size_t i = 0; points && i < n; i++)
        points[i] = (struct plot_point){plot_axis_place(along, i), i};
    if (points)
        qsort(points, n, sizeof *points, by_place);
    else
        no_memory(message);
    return points;
}

/* ---- shares against a parameter ----------------------------------------------------------- */

enum { MAX_EXTENTS = 2 };

/* One curve of shares: of a kind, over the counts of the axis's values, `stride` apart. */
struct share {
    int kind;
    const struct statistics_counts *counts;
    size_t stride;
    char colour[32]; /* an expression of gnuplot's */
    char label[96];
    double *parts; /* [values][PARTS]; NULL: shares of a grid's cases, which have no ends */
};
/* A share, the ends of its likely error (95 %), and its bounds where there are any. */
enum { SHARE, LOW, HIGH, LOWEST, HIGHEST, PARTS };
enum { SHARES = 6 };

static void share_at(const struct share *share, size_t i, double part[PARTS])
{
    const struct statistics_counts *c = &share->counts[i * share->stride];
    for (int k = 0; k < PARTS; k++)
        part[k] = NAN;
    if (share->parts)
        memcpy(part, share->parts + PARTS * i, PARTS * sizeof *part);
    else if (c->done > 0)
        part[SHARE] = part[LOW] = part[HIGH] = (double)c->kind[share->kind] / (double)c->done;
}

/* Share with its interval, in per cent. */
static void put_share(struct gnuplot *g, const struct plot_axis *along,
                      const struct plot_point *points, const struct share *share, int number,
                      bool apart)
{
    static const int types[SHARES] = {7, 5, 9, 11, 13, 15}; /* of points */
    double row[1 + PARTS];
    gnuplot_block(g, "share%d", number);
    for (size_t i = 0; i < along->axis->count; i++) {
        row[0] = points[i].place;
        share_at(share, points[i].index, row + 1);
        for (int k = 0; k < PARTS; k++)
            row[1 + k] *= 100;
        gnuplot_row(g, row, 1 + PARTS);
    }
    gnuplot_end_block(g);
    const int dash = apart && !along->axis->word ? number : 0, type = apart ? types[number - 1] : 0;
    gnuplot_legend_mark(g, share->colour, dash, type, share->label, "");
    gnuplot_set(
        g, "share_colour[%d] = legend_colour[legends]; share_dash[%d] = %d; share_type[%d] = %d",
        number, number, apart ? number : 1, number, apart ? type : 7);
}

/* The end of the axis in per cent: the highest end of a share of more than no case at all, of which
 * there is but the tiny end of an interval. */
static double find_most(const struct share *shares, int count, size_t values)
{
    double most = 0, part[PARTS];
    for (int k = 0; k < count; k++) {
        double highest = 0;
        bool any = false;
        for (size_t i = 0; i < values; i++) {
            share_at(&shares[k], i, part);
            any = any || part[SHARE] > 0;
            highest = fmax(highest, fmax(part[HIGH], part[HIGHEST])); /* NAN is not looked at */
        }
        most = any ? fmax(most, 100 * highest) : most;
    }
    return most > 0 ? fmin(100, 1.08 * most) : 100;
}

/* Shares of a sample that has no basins, with their intervals. */
static bool measure_sample(const struct results *r, int axis, struct share *share)
{
    const size_t values = r->axis[axis].count;
    struct interval *interval = malloc(values * sizeof *interval);
    share->parts = malloc(PARTS * values * sizeof *share->parts);
    const bool good =
        interval && share->parts &&
        intervals_find(r, (enum results_kind)share->kind, axis, NULL, values, interval);
    for (size_t i = 0; good && i < values; i++) {
        const struct statistics_counts *c = &share->counts[i * share->stride];
        double *part = share->parts + PARTS * i;
        part[SHARE] = c->done > 0 ? (double)c->kind[share->kind] / (double)c->done : NAN;
        part[LOW] = interval[i].low;
        part[HIGH] = interval[i].high;
        part[LOWEST] = part[HIGHEST] = NAN;
    }
    free(interval);
    return good;
}

/* Ends of a basin's share; over a sample of parameters nothing is certain. */
static void find_ends(const struct basin *basin, const struct basin_row *row, double part[PARTS])
{
    const bool certain = basin->averaged < 0;
    part[SHARE] = row->volume / basin->box;
    part[LOW] = fmax(0, (row->volume - row->reach) / basin->box);
    part[HIGH] = fmin(1, (row->volume + row->reach) / basin->box);
    part[LOWEST] = certain ? row->low / basin->box : NAN;
    part[HIGHEST] = certain ? row->high / basin->box : NAN;
}

/* Which row has point i of `axis` and point k of `second`, rows being in the order of the axes. */
static size_t row_at(const struct results *r, int axis, int second, size_t i, size_t k)
{
    return second < 0      ? i
           : axis < second ? i * r->axis[second].count + k
                           : k * r->axis[axis].count + i;
}

/* The volumes of basins, where there are starts, and intervals of samples. Share k is of its own
 * kind or, with a second axis, of its point k. Of a grid of other things the shares are left as
 * they are. */
static bool measure_volumes(const struct results *r, int axis, int second, struct share *shares,
                            int count, bool *bounded, stance_message *message)
{
    const char *by[] = {r->axis[axis].name, second < 0 ? NULL : r->axis[second].name};
    for (int k = 0; k < count; k++) {
        const struct basin_choice choice = {.of = (enum results_kind)shares[k].kind,
                                            .by = by,
                                            .by_count = second < 0 ? 1 : 2,
                                            .side = 5,
                                            .level = 0.95};
        struct basin_sample sample;
        struct basin basin;
        bool usage = false;
        if (!basin_sample_make(&sample, r, message))
            return false;
        if (!basin_make(&basin, r, &choice, &sample, &usage, message)) {
            if (!usage || r->sample < 0 || second >= 0)
                return usage;
            if (!measure_sample(r, axis, &shares[k]))
                return no_memory(message);
            continue;
        }
        const size_t values = r->axis[axis].count;
        shares[k].parts = malloc(PARTS * values * sizeof *shares[k].parts);
        for (size_t i = 0; shares[k].parts && i < values; i++) {
            find_ends(&basin, &basin.row[row_at(r, axis, second, i, (size_t)k)],
                      shares[k].parts + PARTS * i);
        }
        const bool good = shares[k].parts != NULL;
        *bounded = basin.averaged < 0;
        basin_free(&basin);
        if (!good)
            return no_memory(message);
    }
    return true;
}

/* Kinds whose shares are drawn: of stabilised and rested those that there are, or the first. */
static int choose_kinds(const struct statistics_counts *counts, size_t n, struct share *shares)
{
    static const int wanted[2] = {RESULTS_STABILISED, RESULTS_RESTED};
    int found = 0;
    for (int k = 0; k < 2; k++) {
        bool any = false;
        for (size_t i = 0; i < n && !any; i++)
            any = counts[i].kind[wanted[k]] > 0;
        if (any || (k == 1 && found == 0)) {
            int kind = any ? wanted[k] : wanted[0];
            struct share *share = &shares[found++];
            *share = (struct share){.kind = kind, .counts = counts, .stride = 1};
            snprintf(share->colour, sizeof share->colour, "colour_%s", results_kind_names[kind]);
            snprintf(share->label, sizeof share->label, "%s", results_kind_names[kind]);
        }
    }
    return found;
}

/* The axis that the page runs along, and the second parameter, where there is one alone and it has
 * few values, else -1: the one with more values is run along. */
static void choose_parameters(const struct results *r, int *along, int *second)
{
    int parameters = 1;
    *along = 0;
    *second = -1;
    for (int a = 1; a < r->axes; a++) {
        if (!r->axis[a].offset && a != r->sample) {
            *second = a;
            parameters++;
        }
    }
    if (parameters == 2 && r->axis[*second].count > r->axis[0].count) {
        *along = *second;
        *second = 0;
    }
    if (parameters != 2 || r->axis[*second].count < 2 || r->axis[*second].count > SHARES) {
        *along = 0;
        *second = -1;
    }
}

/* A curve for each value of the second parameter: of stabilised cases, or where there are none of
 * rested ones. */
static int choose_values(const struct results *r, int along, int second,
                         const struct statistics_counts *counts, struct share *shares)
{
    size_t n = r->axis[second].count;
    struct share kinds[2];
    choose_kinds(counts, r->axis[along].count * n, kinds);
    for (size_t k = 0; k < n; k++) {
        shares[k] = (struct share){.kind = kinds[0].kind, .counts = counts + k, .stride = n};
        snprintf(shares[k].colour, sizeof shares[k].colour, "hue[%zu]", k + 1);
        results_value_text(&r->axis[second], k, true, shares[k].label, sizeof shares[k].label);
    }
    return (int)n;
}

/* The extent of the stabilised set along an axis of offsets, for every value of the first axis. */
static void put_extent(struct gnuplot *g, const struct results *r, const struct plot_axis *along,
                       const struct plot_point *points, int axis, int number)
{
    const struct results_axis *of = &r->axis[axis];
    size_t point[SCENARIO_MAX_AXES] = {0};
    struct statistics_extent extent;
    struct plot_axis range;
    const char *dot = strrchr(of->name, '.');

    gnuplot_text(g, of->name, "extent[%d]", number);
    gnuplot_text(g, dot ? dot + 1 : of->name, "extent_name[%d]", number);
    gnuplot_text(g, of->unit, "extent_unit[%d]", number);
    plot_axis_make_curve(&range, of);
    gnuplot_set(g, "extent_low[%d] = %#.17g; extent_high[%d] = %#.17g", number, range.low, number,
                range.high);
    gnuplot_block(g, "extent%d", number);
    for (size_t i = 0; i < along->axis->count; i++) {
        point[0] = points[i].index;
        bool any = statistics_extent(r, axis, point, &extent) && extent.any;
        GNUPLOT_ROW(g, points[i].place, any ? extent.low : NAN, any ? extent.high : NAN);
    }
    gnuplot_end_block(g);
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

static void put_notes(struct gnuplot *g, bool words, bool ends, bool bounded, int extents)
{
    char text[120];
    snprintf(text, sizeof text, "%s: likely error (95 %%)%s", words ? "bars" : "band",
             !bounded ? ""
             : words  ? ", thin: certain bounds"
                      : ", light: certain bounds");
    if (ends)
        gnuplot_note(g, text);
    if (extents > 0)
        gnuplot_note(g, "below: how far it is stabilised along each axis through the equilibrium");
}

/* `second`: the axis whose values have a curve each, or -1. */
static bool draw_page(const struct plot *plot, const struct plot_axis *along,
                      const struct plot_point *points, const struct share *shares, int count,
                      int second, bool bounded, stance_message *message)
{
    const struct results *r = plot->r;
    struct gnuplot g;
    char what[900];
    int extents[MAX_EXTENTS], extent_count = choose_extents(r, extents);
    const size_t values = along->axis->count * (second < 0 ? 1 : r->axis[second].count);
    const uint64_t each = r->cases / (values ? values : 1);

    snprintf(what, sizeof what, "%s cases against %s%s%s, %llu case%s per %s",
             second < 0 && count > 1            ? "Stabilised and rested"
             : shares[0].kind == RESULTS_RESTED ? "Rested"
                                                : "Stabilised",
             along->axis->name, second < 0 ? "" : " and ", second < 0 ? "" : r->axis[second].name,
             (unsigned long long)each, each == 1 ? "" : "s",
             second < 0 ? "value" : "pair of values");
    plot_failed_text(r, what, sizeof what);
    plot_cut_text(r, statistics_judged(r), true, what, sizeof what);
    if (!plot_begin(plot, &g, plot_shares_gp, what, message))
        return false;
    plot_axis_write(along, &g, "x");
    if (second >= 0)
        gnuplot_text(&g, r->axis[second].name, "legend_head");
    gnuplot_set(&g, "words = %d; volumes = %d; bounded = %d; most = %#.10g",
                along->axis->word != NULL, shares[0].parts != NULL, bounded,
                find_most(shares, count, along->axis->count));
    gnuplot_set(&g,
                "shares = %d\narray share_colour[%d]\narray share_dash[%d]\narray share_type[%d]",
                count, count, count, count);
    for (int k = 0; k < count; k++)
        put_share(&g, along, points, &shares[k], k + 1, second >= 0);
    gnuplot_set(&g, "extents = %d\narray extent[%d]\narray extent_name[%d]\narray extent_unit[%d]",
                extent_count, MAX_EXTENTS, MAX_EXTENTS, MAX_EXTENTS);
    gnuplot_set(&g, "array extent_low[%d]\narray extent_high[%d]", MAX_EXTENTS, MAX_EXTENTS);
    for (int k = 0; k < extent_count; k++)
        put_extent(&g, r, along, points, extents[k], k + 1);
    put_notes(&g, along->axis->word != NULL, shares[0].parts != NULL, bounded, extent_count);
    return plot_end(plot, &g, "curve", message);
}

bool plot_shares(const struct plot *plot, stance_message *message)
{
    const struct results *r = plot->r;
    struct plot_axis along;
    struct share shares[SHARES];
    int first, second, count = 0;
    if (r->axes < 2 || r->axis[0].offset)
        return true;
    choose_parameters(r, &first, &second);
    plot_axis_make_curve(&along, &r->axis[first]);
    struct plot_point *points = plot_points_make(&along, message);
    size_t counted = r->axis[first].count * (second < 0 ? 1 : r->axis[second].count);
    struct statistics_counts *counts = malloc(counted * sizeof *counts);
    bool good = points && (counts || no_memory(message)), bounded = false;
    if (good) {
        if (second < 0) {
            statistics_count_axis(r, first, counts);
            count = choose_kinds(counts, counted, shares);
        } else {
            statistics_count_pair(r, first, second, counts);
            count = choose_values(r, first, second, counts, shares);
        }
        good = measure_volumes(r, first, second, shares, count, &bounded, message) &&
               draw_page(plot, &along, points, shares, count, second, bounded, message);
    }
    for (int k = 0; k < count; k++)
        free(shares[k].parts);
    free(points);
    free(counts);
    return good;
}
