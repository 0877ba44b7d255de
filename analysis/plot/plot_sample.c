/* plot_sample.c - a sample: where its points are and what became of them, and how the share of good
 * ends depends on each path that it varies.
 *
 * The scatter is over the first paths of the first two factors. Where the grid has but an axis over
 * initial.offset.scale, or none, every case is a point of its own, its offsets multiplied by that
 * scale: rays are seen as rays. Otherwise a point stands for all cases of a point of the sample,
 * and its colour for the share of them that ended well.
 */
#include "analysis/draw/plot.h"
#include "analysis/statistics/doe_bins.h"

#include <math.h>
#include <string.h>

enum {
    BINS = 8,
    TICS = 5, /* most values that have one each */
    MOST_PANELS = 18,
    MOST_DRAWN = 50000, /* points of the scatter: more make files that no viewer opens */
};

/* What is drawn of the axis of a path, as values stand there. */
struct span {
    bool logarithmic;
    bool none[2]; /* some values are -infinity, infinity: limits that there are not */
    struct plot_range shown;
    double absent[2]; /* the places of these */
};

struct page {
    struct gnuplot g;
    const struct results *r;
    struct span *span; /* [varied] */
    double most;       /* the end of the axis of shares in per cent */
    enum results_kind judged;
    int x, y;    /* paths of the scatter, y -1: there is but one factor */
    int scale;   /* the axis over initial.offset.scale, or -1 */
    bool shares; /* points stand for several cases */
};

/* ---- what is drawn ------------------------------------------------------------------------ */

static bool is_offset(const struct results_varied *v)
{
    return strncmp(v->of.name, "initial.offset.", strlen("initial.offset.")) == 0;
}

static void choose_scatter(struct page *page)
{
    const struct results *r = page->r;
    page->y = page->scale = -1;
    for (int k = 0; k < r->varied && page->y < 0; k++)
        page->y = r->vary[k].factor == 1 ? k : -1;
    for (int a = 0; a < r->axes; a++) {
        if (a == r->sample || r->axis[a].count == 1)
            continue;
        if (strcmp(r->axis[a].name, "initial.offset.scale") == 0)
            page->scale = a;
        else
            page->shares = true;
    }
}

/* ---- places ------------------------------------------------------------------------------- */

/* Finds the span of a path: its values stand by their logarithms where these lie more evenly over a
 * wide range; offsets are multiplied by the scale. */
static void find_span(const struct page *page, int k)
{
    const struct results *r = page->r;
    const struct results_varied *v = &r->vary[k];
    struct span *const span = &page->span[k];
    struct plot_range of;
    double sum = 0, sum_log = 0, n = 0;

    for (size_t i = 0; i < v->of.count; i++) {
        const double value = v->of.value[i];
        if (isinf(value)) {
            span->none[value > 0] = true;
            continue;
        }
        sum += value;
        sum_log += value > 0 ? log(value) : 0;
        n++;
    }
    const bool any = plot_range_of(&of, v->of.value, v->of.count);
    double low = any ? of.low : 0, high = any ? of.high : 0;
    span->logarithmic = !v->word && low > 0 && high > 3 * low &&
                        fabs((sum_log / n - log(low)) / log(high / low) - 0.5) <
                            fabs((sum / n - low) / (high - low) - 0.5);
    if (page->scale >= 0 && is_offset(v)) {
        const struct results_axis *axis = &r->axis[page->scale];
        const double first = axis->value[0], last = axis->value[axis->count - 1];
        low = fmin(first * low, last * low);
        high = fmax(first * high, last * high);
    }
    low = span->logarithmic ? log10(low) : low;
    high = span->logarithmic ? log10(high) : high;
    const double width = high > low ? high - low : 1;
    span->absent[0] = low - 0.3 * width;
    span->absent[1] = high + 0.3 * width;
    const double ends[] = {span->none[0] ? span->absent[0] : low,
                           span->none[1] ? span->absent[1] : high};
    span->shown = plot_roomy((struct plot_range){ends[0], ends[1]}, 0.03);
}

/* Where a value of a path stands; what is infinite, an absent limit, beside all others. */
static double place_of(const struct page *page, int k, double value)
{
    const struct span *span = &page->span[k];
    return isinf(value) ? span->absent[value > 0] : span->logarithmic ? log10(value) : value;
}

/* Path k as the axis x or y of the last panel: words, and numbers that are few or among which some
 * are none, are a list. */
static void put_axis(struct page *page, int k, char which)
{
    const struct results_varied *v = &page->r->vary[k];
    struct gnuplot *g = &page->g;
    struct doe_bins bins;
    const struct span *span = &page->span[k];
    struct plot_range range = span->shown;

    if (!gnuplot_needs(g, doe_bins_make(&bins, page->r, k, TICS, g->plot->message)))
        return;
    const bool listed =
        span->none[0] || span->none[1] || (bins.listed && !(page->scale >= 0 && is_offset(v)));
    if (v->word)
        range = (struct plot_range){ceil(range.low) - 0.5, floor(range.high) + 0.5};
    const char *const axis = gnuplot_axis(g, which,
                                          listed              ? PLOT_LIST
                                          : span->logarithmic ? PLOT_LOG
                                                              : PLOT_LINEAR,
                                          range, "", "");
    plot_label_write(&v->of, g, axis);
    if (!listed)
        return;
    for (size_t b = 0; b < bins.count + 2; b++) {
        const bool beside = b >= bins.count, up = b > bins.count;
        if (beside && (!span->none[up] || isinf(bins.bin[up ? bins.count - 1 : 0].centre)))
            continue;
        const double centre = !beside ? bins.bin[b].centre : up ? INFINITY : -INFINITY;
        char text[40];
        results_number_text(centre, 0, text, sizeof text);
        gnuplot_word(g, place_of(page, k, centre), v->word ? v->word[(int)centre] : text);
    }
    gnuplot_set(g, "panel_wordy[panels] = %d", v->word != NULL);
}

/* ---- the scatter -------------------------------------------------------------------------- */

/* Place of a point of the sample along path k; without one a number that fills the height evenly.
 */
static double place_at(const struct page *page, int k, size_t point, double scale)
{
    const struct results *r = page->r;
    if (k < 0)
        return fmod(0.5 + 0.6180339887498949 * (double)point, 1);
    return is_offset(&r->vary[k]) ? scale * r->vary[k].of.value[point]
                                  : place_of(page, k, r->vary[k].of.value[point]);
}

static uint64_t divisor_of(uint64_t a, uint64_t b)
{
    return b == 0 ? a : divisor_of(b, a % b);
}

/* Every case, or every n-th where there are too many. */
static void put_cases(struct page *page)
{
    const struct results *r = page->r;
    uint64_t every = (r->cases + MOST_DRAWN - 1) / MOST_DRAWN;

    while (every > 1 && divisor_of(every, r->axis[r->sample].count) > 1)
        every++; /* else some points of the sample would be left out altogether */
    for (uint64_t i = 0; i < r->cases; i += every) {
        size_t point[SCENARIO_MAX_AXES];
        results_point(r, i, point);
        const double scale = page->scale < 0 ? 1 : r->axis[page->scale].value[point[page->scale]];
        GNUPLOT_ROW(&page->g, place_at(page, page->x, point[r->sample], scale),
                    place_at(page, page->y, point[r->sample], scale), r->kind[i]);
    }
}

static void put_shares(struct page *page)
{
    const struct results *r = page->r;
    const size_t n = r->axis[r->sample].count, every = (n + MOST_DRAWN - 1) / MOST_DRAWN;
    struct statistics_counts *const counts = gnuplot_room(&page->g, n, sizeof *counts);
    if (counts)
        statistics_count_axis(r, r->sample, counts);
    for (size_t i = 0; counts && i < n; i += every)
        GNUPLOT_ROW(&page->g, place_at(page, page->x, i, 1), place_at(page, page->y, i, 1),
                    counts[i].done
                        ? 100 * (double)counts[i].kind[page->judged] / (double)counts[i].done
                        : NAN);
}

static void put_scatter(struct page *page)
{
    const struct results *r = page->r;
    const char *const judged = results_kind_names[page->judged];
    const uint64_t points = page->shares ? r->axis[r->sample].count : r->cases;
    plot_kinds_write(&page->g, !page->shares);
    gnuplot_panel(&page->g, 380, "");
    put_axis(page, page->x, 'x');
    if (page->y >= 0)
        put_axis(page, page->y, 'y');
    else
        gnuplot_set(&page->g, "panel_y[panels] = ''");
    if (page->shares)
        gnuplot_set(&page->g, "bars = 1; bar_high = 100; bar_text = '%s (%%)'", judged);
    gnuplot_series(&page->g, "using 1:2:%s with points pt 7 ps %g lc %s",
                   page->shares ? "3" : "(kind_colour[$3+1])", gnuplot_dot(points),
                   page->shares ? "palette" : "rgb variable");
    (page->shares ? put_shares : put_cases)(page);
}

/* ---- shares ------------------------------------------------------------------------------- */

/* Share of the kind judged by in each bin, with its interval, against the bin's median. */
static void put_panel(struct page *page, int k)
{
    struct gnuplot *const g = &page->g;
    struct doe_bins bins;

    gnuplot_panel(g, 150, "");
    put_axis(page, k, 'x');
    if (!gnuplot_needs(g, doe_bins_make(&bins, page->r, k, BINS, g->plot->message)))
        return;
    gnuplot_series(g, "using 1:2:3:4 with yerrorbars lc rgb colour_%s pt 7 ps 0.6 lw 1.4",
                   results_kind_names[page->judged]);
    for (size_t b = 0; b < bins.count; b++) {
        const struct statistics_counts *c = &bins.bin[b].counts;
        const struct interval *interval = &bins.bin[b].of_kind[page->judged];
        if (c->done == 0)
            continue;
        GNUPLOT_ROW(g, place_of(page, k, bins.bin[b].centre),
                    100 * (double)c->kind[page->judged] / (double)c->done, 100 * interval->low,
                    100 * interval->high);
        page->most = fmax(page->most, 104 * interval->high);
    }
}

/* ---- the page ----------------------------------------------------------------------------- */

bool plot_sample(const struct plot *plot)
{
    const struct results *r = plot->r;
    struct page page = {.r = r, .most = 1};
    struct gnuplot *const g = &page.g;
    char share[64];
    if (r->sample < 0)
        return true;
    const int panels = r->varied < MOST_PANELS ? r->varied : MOST_PANELS;
    const size_t points = r->axis[r->sample].count;
    if (!gnuplot_begin(g, plot, "sample"))
        return false;
    page.judged = statistics_judged(r);
    page.span = gnuplot_room(g, (size_t)r->varied, sizeof *page.span);
    if (!page.span)
        return gnuplot_end(g);
    choose_scatter(&page);
    for (int k = 0; k < r->varied; k++)
        find_span(&page, k);
    gnuplot_say(g, "%llu case%s at %zu point%s of a design, %s", (unsigned long long)r->cases,
                r->cases == 1 ? "" : "s", points, points == 1 ? "" : "s", r->method);
    plot_say_failed(g);
    plot_say_cut(g, page.judged, true);
    if (panels < r->varied)
        gnuplot_note(g, "%d of the %d paths are drawn", panels, r->varied);
    snprintf(share, sizeof share, "%s (%%)", results_kind_names[page.judged]);
    gnuplot_axis(g, 'y', PLOT_LINEAR, (struct plot_range){0, 100}, share, "");
    gnuplot_set(g, "leads = 1; columns = 3; chart_width = 200; scaled = 1");
    gnuplot_note(g, "bars: 95 %% interval");
    put_scatter(&page);
    for (int k = 0; k < panels; k++)
        put_panel(&page, k);
    gnuplot_number(g, fmin(page.most, 100), "y_high");
    return gnuplot_end(g);
}
