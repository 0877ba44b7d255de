/* plot_curve.c - curves against one axis: what every case of a line did, or how the shares of
 * stabilised and rested cases and the extent of the stabilised set depend on a parameter. */
#include "analysis/basin/basin.h"
#include "analysis/draw/plot.h"
#include "analysis/statistics/intervals.h"
#include "analysis/statistics/statistics.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { LEFT = 96, PLOT_WIDTH = 620, LEGEND = 200, BOTTOM = 84, GAP = 14, STRIP = 30 };

/* A point of a curve. */
struct sample {
    double place;
    size_t index; /* along the axis */
};

static int by_place(const void *a, const void *b)
{
    double x = ((const struct sample *)a)->place, y = ((const struct sample *)b)->place;
    return (x > y) - (x < y);
}

/* The points of an axis from left to right; freed by the caller, NULL: no memory. */
static struct sample *make_samples(const struct plot_axis *along)
{
    size_t n = along->axis->count;
    struct sample *samples = malloc(n * sizeof *samples);
    for (size_t i = 0; samples && i < n; i++)
        samples[i] = (struct sample){plot_axis_place(along, i), i};
    if (samples)
        qsort(samples, n, sizeof *samples, by_place);
    return samples;
}

static bool no_memory(stance_message *message)
{
    snprintf(message->text, sizeof message->text, "stance plot: not enough memory");
    return false;
}

/* ---- pages -------------------------------------------------------------------------------- */

struct page {
    struct gnuplot g;
    const struct plot *plot;
    const struct plot_axis *along;
    double top; /* of the next panel */
};

/* heights: of all panels together with the gaps between them. */
static bool begin_page(struct page *page, const char *subtitle, double heights,
                       stance_message *message)
{
    const struct results *r = page->plot->r;
    const char *title = r->title[0] ? r->title : r->name;
    int width = LEFT + PLOT_WIDTH + LEGEND;
    page->top = gnuplot_title_height(width, title, subtitle);
    double bottom = page->top + heights;
    if (!gnuplot_begin(&page->g, width, (int)bottom + BOTTOM, message))
        return false;
    gnuplot_title(&page->g, title, subtitle);
    plot_axis_label(page->along->axis, &page->g, LEFT + PLOT_WIDTH / 2.0, bottom + 46,
                    PLOT_WIDTH + 80, false);
    return true;
}

/* Axes of a panel; low ... high is the range of its values, tics along the bottom when `last`. */
static void begin_panel(struct page *page, double height, double low, double high, bool last)
{
    gnuplot_panel(&page->g, LEFT, page->top, PLOT_WIDTH, height);
    plot_axis_tics(page->along, page->g.script, 'x', 10, last);
    fprintf(page->g.script, "set yrange [%.10g:%.10g]\nset format y '%%.10g'\n", low, high);
    plot_value_tics(page->g.script, low, high, height);
    fputs("set grid lt 1 lc rgb '#e6e6e6' lw 0.8\n", page->g.script);
    page->top += height + GAP;
}

/* Widens a range so that points do not sit on the frame, and where it is none. */
static void widen(double *low, double *high)
{
    double margin = *high > *low ? 0.06 * (*high - *low) : 0.1 * fabs(*low) + 0.05;
    *low -= margin;
    *high += margin;
}

/* ---- every case of a line ----------------------------------------------------------------- */

/* Runs of neighbours of the same kind as one box each: seams between boxes would show. */
static void put_strip(struct page *page, const struct sample *samples)
{
    const struct results *r = page->plot->r;
    const struct plot_axis *along = page->along;
    size_t n = along->axis->count;
    double low = along->low;
    char name[32];

    FILE *data = gnuplot_data(&page->g, name);
    for (size_t i = 0; i < n; i++) {
        uint8_t kind = r->kind[samples[i].index];
        if (i + 1 < n && r->kind[samples[i + 1].index] == kind)
            continue;
        double high = i + 1 < n ? 0.5 * (samples[i].place + samples[i + 1].place) : along->high;
        fprintf(data, "%.17g 0.5 %.17g %.17g 0 1 %ld\n", 0.5 * (low + high), low, high,
                strtol(plot_colours[kind] + 1, NULL, 16));
        low = high;
    }
    gnuplot_close_data(&page->g, data);
    begin_panel(page, STRIP, 0, 1, false);
    fprintf(page->g.script,
            "unset ytics; unset grid\n"
            "plot '%s' using 1:2:3:4:5:6:7 with boxxyerror fillstyle solid noborder"
            " lc rgb variable notitle\n",
            name);
}

/* One answer of every case, its point coloured by what became of the case. */
struct line_panel {
    const char *name, *unit;
    double *values;
    double low, high;
};
enum { LINE_PANELS = 3, LINE_HEIGHT = 150 };

static void put_line(struct page *page, const struct sample *samples, struct line_panel *panel,
                     bool last)
{
    const struct results *r = page->plot->r;
    size_t n = page->along->axis->count;
    double size = n > 400 ? 0.25 : n > 100 ? 0.45 : 0.8;
    char name[32];

    FILE *data = gnuplot_data(&page->g, name);
    for (size_t i = 0; i < n; i++) {
        size_t index = samples[i].index;
        fprintf(data, "%.17g ", samples[i].place);
        gnuplot_number(data, panel->values[index]);
        fprintf(data, " %ld\n", strtol(plot_colours[r->kind[index]] + 1, NULL, 16));
    }
    gnuplot_close_data(&page->g, data);
    widen(&panel->low, &panel->high);
    begin_panel(page, LINE_HEIGHT, panel->low, panel->high, last);
    fprintf(page->g.script,
            "plot '%s' using 1:2 with lines lc rgb '#b0b0b0' lw 1 notitle,"
            " '' using 1:2:3 with points pt 7 ps %g lc rgb variable notitle\n",
            name, size);
}

/* Reads an answer and its range; values stay NULL where there is nothing to draw. */
static bool read_panel(const struct results *r, struct line_panel *panel, stance_message *message)
{
    if (!results_answer(r, panel->name, &panel->values, message))
        return false;
    panel->low = INFINITY;
    panel->high = -INFINITY;
    for (uint64_t i = 0; panel->values && i < r->cases; i++) {
        if (isfinite(panel->values[i])) {
            panel->low = fmin(panel->low, panel->values[i]);
            panel->high = fmax(panel->high, panel->values[i]);
        }
    }
    if (!(panel->low <= panel->high)) {
        free(panel->values);
        panel->values = NULL;
    }
    return true;
}

/* The page STEM-`picture` of LINE_PANELS panels, those without values left out. */
static bool draw_line_page(const struct plot *plot, const struct plot_axis *along,
                           const struct sample *samples, struct line_panel *panels,
                           const char *what, const char *picture, stance_message *message)
{
    struct page page = {.plot = plot, .along = along};
    char stem[512], label[64];
    int left = 0;
    for (int k = 0; k < LINE_PANELS; k++)
        left += panels[k].values != NULL;
    if (!begin_page(&page, what, STRIP + left * (LINE_HEIGHT + GAP), message))
        return false;
    gnuplot_label(&page.g, LEFT - 10, page.top + STRIP / 2.0, "outcome", "right", 12, false);
    plot_kind_legend(plot, &page.g, LEFT + PLOT_WIDTH + 20, page.top + 10);
    double y = page.top + STRIP + GAP;
    for (int k = 0; k < LINE_PANELS; k++) {
        if (panels[k].values) {
            snprintf(label, sizeof label, "%s%s%s%s", panels[k].name, panels[k].unit[0] ? " (" : "",
                     panels[k].unit, panels[k].unit[0] ? ")" : "");
            gnuplot_label(&page.g, 24, y + LINE_HEIGHT / 2.0, label, "center", 12, true);
            y += LINE_HEIGHT + GAP;
        }
    }
    gnuplot_decorate(&page.g);
    put_strip(&page, samples);
    for (int k = 0; k < LINE_PANELS; k++)
        if (panels[k].values)
            put_line(&page, samples, &panels[k], --left == 0);
    snprintf(stem, sizeof stem, "%s-%s", plot->stem, picture);
    return gnuplot_end(&page.g, plot->directory, stem, message);
}

static bool draw_line(const struct plot *plot, stance_message *message)
{
    struct line_panel panels[LINE_PANELS] = {{.name = "settle_time", .unit = "s"},
                                             {.name = "end_time", .unit = "s"},
                                             {.name = "friction_used", .unit = ""}};
    struct plot_axis along;
    char what[96];
    plot_axis_make_curve(&along, &plot->r->axis[0]);
    struct sample *samples = make_samples(&along);
    bool good = samples || no_memory(message);
    for (int k = 0; k < LINE_PANELS && good; k++)
        good = read_panel(plot->r, &panels[k], message);
    snprintf(what, sizeof what, "What became of each of %llu cases",
             (unsigned long long)plot->r->cases);
    good = good && draw_line_page(plot, &along, samples, panels, what, "curve", message);
    for (int k = 0; k < LINE_PANELS; k++)
        free(panels[k].values);
    free(samples);
    return good;
}

bool plot_answer_curve(const struct plot *plot, const struct plot_answer *answer,
                       stance_message *message)
{
    struct line_panel panels[LINE_PANELS] = {{.name = answer->name, .unit = answer->unit}};
    struct plot_axis along;
    char what[256];
    plot_axis_make_curve(&along, &plot->r->axis[0]);
    struct sample *samples = make_samples(&along);
    plot_answer_title(answer, what, sizeof what);
    bool good = (samples || no_memory(message)) &&
                plot_answer_numbers(plot, answer, &panels[0].values, &panels[0].low,
                                    &panels[0].high, message) &&
                draw_line_page(plot, &along, samples, panels, what, answer->name, message);
    free(panels[0].values);
    free(samples);
    return good;
}

/* ---- shares against a parameter ----------------------------------------------------------- */

enum { SHARE_HEIGHT = 300, EXTENT_HEIGHT = 150, MAX_EXTENTS = 2 };

/* One curve of shares: of a kind, over the counts of the axis's values, `stride` apart. */
struct share {
    int kind;
    const struct statistics_counts *counts;
    size_t stride;
    const char *colour;
    char label[96];
    /* Shares with both ends, [values][3]; NULL: shares of a grid's cases, which have none. */
    double *parts;
};
enum { SHARES = 6 };

static void share_at(const struct share *share, size_t i, double part[3])
{
    const struct statistics_counts *c = &share->counts[i * share->stride];
    part[0] = part[1] = part[2] = NAN;
    if (share->parts)
        memcpy(part, share->parts + 3 * i, 3 * sizeof *part);
    else if (c->done > 0)
        part[0] = part[1] = part[2] = (double)c->kind[share->kind] / (double)c->done;
}

/* Share with its interval, in per cent. Words have bars, numbers a band. */
static double put_share_data(struct page *page, const struct sample *samples,
                             const struct share *share, char name[32])
{
    double highest = 0, part[3];
    bool any = false;
    FILE *data = gnuplot_data(&page->g, name);
    for (size_t i = 0; i < page->along->axis->count; i++) {
        share_at(share, samples[i].index, part);
        fprintf(data, "%.17g", samples[i].place);
        for (int k = 0; k < 3; k++) {
            putc(' ', data);
            gnuplot_number(data, 100 * part[k]);
        }
        putc('\n', data);
        any = any || part[0] > 0;
        highest = part[2] > highest / 100 ? 100 * part[2] : highest; /* false for NAN */
    }
    gnuplot_close_data(&page->g, data);
    return any ? highest : 0; /* of no case at all: not the tiny end of its interval */
}

/* Shares of a sample that has no basins, with their intervals. */
static bool measure_sample(const struct results *r, int axis, struct share *share)
{
    const size_t values = r->axis[axis].count;
    struct interval *interval = malloc(values * sizeof *interval);
    share->parts = malloc(3 * values * sizeof *share->parts);
    const bool good =
        interval && share->parts &&
        intervals_find(r, (enum results_kind)share->kind, axis, NULL, values, interval);
    for (size_t i = 0; good && i < values; i++) {
        const struct statistics_counts *c = &share->counts[i * share->stride];
        share->parts[3 * i] = c->done > 0 ? (double)c->kind[share->kind] / (double)c->done : NAN;
        share->parts[3 * i + 1] = interval[i].low;
        share->parts[3 * i + 2] = interval[i].high;
    }
    free(interval);
    return good;
}

/* Ends of a basin's share: certain bounds, or over a sample of parameters the likely error. */
static void find_ends(const struct basin *basin, const struct basin_row *row, double part[3])
{
    part[0] = row->volume / basin->box;
    part[1] = row->low / basin->box;
    part[2] = row->high / basin->box;
    if (basin->averaged >= 0) {
        part[1] = fmax(0, (row->volume - row->reach) / basin->box);
        part[2] = fmin(1, (row->volume + row->reach) / basin->box);
    }
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
                            int count, bool *sampled, stance_message *message)
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
        shares[k].parts = malloc(3 * values * sizeof *shares[k].parts);
        for (size_t i = 0; shares[k].parts && i < values; i++) {
            find_ends(&basin, &basin.row[row_at(r, axis, second, i, (size_t)k)],
                      shares[k].parts + 3 * i);
        }
        const bool good = shares[k].parts != NULL;
        *sampled = basin.averaged >= 0;
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
            shares[found] = (struct share){kind, counts, 1, plot_colours[kind], "", NULL};
            snprintf(shares[found].label, sizeof shares[found].label, "%s",
                     results_kind_names[kind]);
            found++;
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
    /* after Okabe and Ito (2008) */
    static const char *const colours[SHARES] = {"#0072b2", "#d55e00", "#009e73",
                                                "#cc79a7", "#e69f00", "#56b4e9"};
    size_t n = r->axis[second].count;
    struct share kinds[2];
    choose_kinds(counts, r->axis[along].count * n, kinds);
    for (size_t k = 0; k < n; k++) {
        shares[k] = (struct share){kinds[0].kind, counts + k, n, colours[k], "", NULL};
        results_value_text(&r->axis[second], k, true, shares[k].label, sizeof shares[k].label);
    }
    return (int)n;
}

static void put_shares(struct page *page, const struct sample *samples, const struct share *shares,
                       int count, bool last)
{
    char name[SHARES][32];
    double highest = 0;
    for (int k = 0; k < count; k++)
        highest = fmax(highest, put_share_data(page, samples, &shares[k], name[k]));
    begin_panel(page, SHARE_HEIGHT, 0, highest > 0 ? fmin(100, 1.08 * highest) : 100, last);
    bool words = page->along->axis->word != NULL;
    fputs("plot ", page->g.script);
    for (int k = 0; k < count; k++) {
        const char *colour = shares[k].colour;
        const char *shape =
            words ? "'%s' using 1:2:3:4 with yerrorbars lc rgb '%s' pt 7 ps 1.1 lw 1.6"
                    " notitle"
                  : "'%s' using 1:3:4 with filledcurves lc rgb '%s' fillstyle"
                    " transparent solid 0.22 notitle";
        fputs(k ? ", " : "", page->g.script);
        fprintf(page->g.script, shape, name[k], colour);
        if (!words) {
            fprintf(page->g.script,
                    ", '%s' using 1:2 with linespoints lc rgb '%s' lw 2 pt 7 ps 0.7 notitle",
                    name[k], colour);
        }
    }
    fputc('\n', page->g.script);
}

/* The extent of the stabilised set along an axis of offsets, for every value of the first axis. */
static void put_extent(struct page *page, const struct sample *samples, int axis, bool last)
{
    const struct results *r = page->plot->r;
    size_t point[SCENARIO_MAX_AXES] = {0};
    struct statistics_extent extent;
    struct plot_axis range;
    char name[32];

    FILE *data = gnuplot_data(&page->g, name);
    for (size_t i = 0; i < page->along->axis->count; i++) {
        point[0] = samples[i].index;
        bool any = statistics_extent(r, axis, point, &extent) && extent.any;
        fprintf(data, "%.17g ", samples[i].place);
        gnuplot_number(data, any ? extent.low : NAN);
        putc(' ', data);
        gnuplot_number(data, any ? extent.high : NAN);
        putc('\n', data);
    }
    gnuplot_close_data(&page->g, data);
    plot_axis_make_curve(&range, &r->axis[axis]);
    begin_panel(page, EXTENT_HEIGHT, range.low, range.high, last);
    fprintf(page->g.script, "set arrow 1 from graph 0, first 0 to graph 1, first 0 nohead"
                            " dt 2 lc rgb '#909090'\n");
    if (page->along->axis->word) {
        fprintf(page->g.script,
                "plot '%s' using 1:2:($1-0.05):($1+0.05):2:3 with boxxyerror lc rgb '%s'"
                " fillstyle solid noborder notitle\n",
                name, PLOT_ACCENT);
    } else {
        fprintf(page->g.script,
                "plot '%s' using 1:2:3 with filledcurves lc rgb '%s' fillstyle transparent solid"
                " 0.22 notitle, '' using 1:2 with linespoints lc rgb '%s' lw 1.6 pt 7 ps 0.5"
                " notitle, '' using 1:3 with linespoints lc rgb '%s' lw 1.6 pt 7 ps 0.5 notitle\n",
                name, PLOT_ACCENT, PLOT_ACCENT, PLOT_ACCENT);
    }
    fputs("unset arrow 1\n", page->g.script);
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

static void label_share_page(struct page *page, const int *extents, int extent_count,
                             const struct share *shares, int count, const char *of, bool bounds)
{
    const struct results *r = page->plot->r;
    double x = LEFT + PLOT_WIDTH + 20, y = page->top + 10;
    char text[160];

    gnuplot_label(&page->g, 24, page->top + SHARE_HEIGHT / 2.0,
                  shares[0].parts ? "share of the box of starts (%)"
                                  : "share of the cases done (%)",
                  "center", 12, true);
    if (of) {
        gnuplot_label(&page->g, x, y, of, "left", 11, false);
        y += 22;
    }
    for (int k = 0; k < count; k++) {
        gnuplot_legend(&page->g, x, y, shares[k].colour, shares[k].label);
        y += 24;
    }
    const bool word = page->along->axis->word != NULL;
    gnuplot_label(&page->g, x, y + 2,
                  bounds ? (word ? "bars: its bounds" : "band: its bounds")
                  : word ? "bars: 95 % interval"
                         : "band: 95 % interval",
                  "left", 11, false);
    y = page->top + SHARE_HEIGHT + GAP;
    for (int k = 0; k < extent_count; k++) {
        const struct results_axis *axis = &r->axis[extents[k]];
        const char *dot = strrchr(axis->name, '.');
        snprintf(text, sizeof text, axis->unit[0] ? "%s (%s)" : "%s", dot ? dot + 1 : axis->name,
                 axis->unit);
        gnuplot_label(&page->g, 24, y + EXTENT_HEIGHT / 2.0, text, "center", 12, true);
        gnuplot_label(&page->g, x, y + 12, "stabilised along", "left", 11, false);
        gnuplot_label(&page->g, x, y + 28, axis->name, "left", 11, false);
        gnuplot_label(&page->g, x, y + 44, "at the equilibrium", "left", 11, false);
        y += EXTENT_HEIGHT + GAP;
    }
}

/* `second`: the axis whose values have a curve each, or -1. */
static bool draw_share_page(const struct plot *plot, const struct plot_axis *along,
                            const struct sample *samples, const struct share *shares, int count,
                            int second, bool bounds, stance_message *message)
{
    struct page page = {.plot = plot, .along = along};
    const struct results *r = plot->r;
    char stem[512], what[256];
    int extents[MAX_EXTENTS], extent_count = choose_extents(r, extents);
    size_t values = along->axis->count * (second < 0 ? 1 : r->axis[second].count);

    snprintf(what, sizeof what, "%s cases against %s%s%s, %llu cases per %s",
             second < 0 && count > 1            ? "Stabilised and rested"
             : shares[0].kind == RESULTS_RESTED ? "Rested"
                                                : "Stabilised",
             along->axis->name, second < 0 ? "" : " and ", second < 0 ? "" : r->axis[second].name,
             (unsigned long long)(r->cases / (values ? values : 1)),
             second < 0 ? "value" : "pair of values");
    plot_failed_text(r, what, sizeof what);
    if (!begin_page(&page, what, SHARE_HEIGHT + extent_count * (EXTENT_HEIGHT + GAP), message))
        return false;
    label_share_page(&page, extents, extent_count, shares, count,
                     second < 0 ? NULL : r->axis[second].name, bounds);
    gnuplot_decorate(&page.g);
    put_shares(&page, samples, shares, count, extent_count == 0);
    for (int k = 0; k < extent_count; k++)
        put_extent(&page, samples, extents[k], k == extent_count - 1);
    snprintf(stem, sizeof stem, "%s-curve", plot->stem);
    return gnuplot_end(&page.g, plot->directory, stem, message);
}

static bool draw_shares(const struct plot *plot, stance_message *message)
{
    const struct results *r = plot->r;
    struct plot_axis along;
    struct share shares[SHARES];
    int first, second, count = 0;
    choose_parameters(r, &first, &second);
    plot_axis_make_curve(&along, &r->axis[first]);
    struct sample *samples = make_samples(&along);
    size_t counted = r->axis[first].count * (second < 0 ? 1 : r->axis[second].count);
    struct statistics_counts *counts = malloc(counted * sizeof *counts);
    bool good = (samples && counts) || no_memory(message), sampled = false;
    if (good) {
        if (second < 0) {
            statistics_count_axis(r, first, counts);
            count = choose_kinds(counts, counted, shares);
        } else {
            statistics_count_pair(r, first, second, counts);
            count = choose_values(r, first, second, counts, shares);
        }
        good = measure_volumes(r, first, second, shares, count, &sampled, message) &&
               draw_share_page(plot, &along, samples, shares, count, second,
                               shares[0].parts && !sampled, message);
    }
    for (int k = 0; k < count; k++)
        free(shares[k].parts);
    free(samples);
    free(counts);
    return good;
}

bool plot_curve(const struct plot *plot, stance_message *message)
{
    return plot->r->axes == 1 ? draw_line(plot, message) : draw_shares(plot, message);
}
