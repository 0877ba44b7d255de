/* plot_shares.c - how the shares of stabilised and rested cases and the extent of the stabilised
 * set depend on a parameter. */
#include "analysis/draw/plot.h"

#include "analysis/basin/basin.h"
#include "analysis/statistics/intervals.h"
#include "runner/base/message.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

GNUPLOT_SCRIPT(plot_shares_gp, "analysis/plot/plot_shares.gp");

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
                      const struct statistics_place *points, const struct share *share, int number,
                      bool apart)
{
    static const int types[SHARES] = {7, 5, 9, 11, 13, 15}; /* of points */
    double row[1 + PARTS];
    gnuplot_block(g, "share%d", number);
    for (size_t i = 0; i < along->axis->count; i++) {
        row[0] = points[i].value;
        share_at(share, points[i].index, row + 1);
        for (int k = 0; k < PARTS; k++)
            row[1 + k] *= 100;
        gnuplot_row(g, row, 1 + PARTS);
    }
    gnuplot_end_block(g);
    const int dash = apart && !along->axis->word ? number : 0, type = apart ? types[number - 1] : 0;
    gnuplot_legend_mark(g, share->colour, dash, type, share->label, "");
    gnuplot_set(
        g,
        "k = %d; share_colour[k] = legend_colour[legends]; share_dash[k] = %d; share_type[k] = %d",
        number, apart ? number : 1, apart ? type : 7);
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
        const bool good = shares[k].parts != NULL;
        *bounded = basin.averaged < 0; /* over a sample of parameters nothing is certain */
        for (size_t i = 0; good && i < values; i++) {
            /* rows are in the order of the axes */
            const struct basin_row *const row =
                &basin.row[second < 0      ? i
                           : axis < second ? i * r->axis[second].count + (size_t)k
                                           : (size_t)k * values + i];
            double *const part = shares[k].parts + PARTS * i;
            part[SHARE] = row->volume / basin.box;
            part[LOW] = fmax(0, (row->volume - row->reach) / basin.box);
            part[HIGH] = fmin(1, (row->volume + row->reach) / basin.box);
            part[LOWEST] = *bounded ? row->low / basin.box : NAN;
            part[HIGHEST] = *bounded ? row->high / basin.box : NAN;
        }
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

/* The extent of the stabilised set along an axis of offsets, for every value of the first axis. */
static void put_extent(struct gnuplot *g, const struct results *r, const struct plot_axis *along,
                       const struct statistics_place *points, int axis, int number)
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
        GNUPLOT_ROW(g, points[i].value, any ? extent.low : NAN, any ? extent.high : NAN);
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

/* `second`: the axis whose values have a curve each, or -1. */
static bool draw_page(const struct plot *plot, const struct plot_axis *along,
                      const struct statistics_place *points, const struct share *shares, int count,
                      int second, bool bounded, stance_message *message)
{
    const struct results *r = plot->r;
    struct gnuplot g;
    char what[900];
    int extents[MAX_EXTENTS], extent_count = choose_extents(r, extents);
    const bool words = along->axis->word != NULL;
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
    gnuplot_set(&g, "words = %d; volumes = %d; bounded = %d; most = %#.10g", words,
                shares[0].parts != NULL, bounded, find_most(shares, count, along->axis->count));
    gnuplot_set(&g, "shares = %d; extents = %d", count, extent_count);
    gnuplot_arrays(&g, count, "share_colour share_dash share_type");
    gnuplot_arrays(&g, MAX_EXTENTS, "extent extent_name extent_unit extent_low extent_high");
    for (int k = 0; k < count; k++)
        put_share(&g, along, points, &shares[k], k + 1, second >= 0);
    for (int k = 0; k < extent_count; k++)
        put_extent(&g, r, along, points, extents[k], k + 1);
    snprintf(what, sizeof what, "%s: likely error (95 %%)%s", words ? "bars" : "band",
             !bounded ? ""
             : words  ? ", thin: certain bounds"
                      : ", light: certain bounds");
    if (shares[0].parts)
        gnuplot_note(&g, what);
    if (extent_count > 0)
        gnuplot_note(&g, "below: how far it is stabilised along each axis through the equilibrium");
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
    struct statistics_place *points = plot_axis_points(&along, message);
    size_t counted = r->axis[first].count * (second < 0 ? 1 : r->axis[second].count);
    struct statistics_counts *counts = malloc(counted * sizeof *counts);
    bool good = points && (counts || no_memory(message)), bounded = false;
    if (good) {
        if (second < 0) {
            statistics_count_axis(r, first, counts);
            count = choose_kinds(counts, counted, shares);
        } else {
            statistics_count_pair(r, first, second, counts);
            struct share kinds[2]; /* of stabilised cases, or where there are none of rested ones */
            choose_kinds(counts, counted, kinds);
            for (size_t k = 0; k < r->axis[second].count; k++) {
                struct share *const share = &shares[count++];
                *share = (struct share){
                    .kind = kinds[0].kind, .counts = counts + k, .stride = r->axis[second].count};
                snprintf(share->colour, sizeof share->colour, "hue[%zu]", k + 1);
                results_value_text(&r->axis[second], k, true, share->label, sizeof share->label);
            }
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
