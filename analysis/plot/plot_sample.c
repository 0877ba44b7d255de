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
#include <stdlib.h>
#include <string.h>

enum {
    LEFT = 96,
    SCATTER_WIDTH = 520,
    SCATTER_HEIGHT = 380,
    LEGEND = 220,
    PANEL_WIDTH = 200,
    PANEL_HEIGHT = 150,
    COLUMNS = 3,
    ACROSS = 270, /* px from a panel to the next */
    DOWN = 232,
    LABELS = 60, /* px under a panel */
    BINS = 8,
    TICS = 5, /* most values that have one each */
    MOST_PANELS = 18,
    MOST_DRAWN = 50000, /* points of the scatter: more make files that no viewer opens */
};

struct page {
    struct gnuplot g;
    const struct plot *plot;
    enum results_kind judged;
    int x, y;    /* paths of the scatter, y -1: there is but one factor */
    int scale;   /* the axis over initial.offset.scale, or -1 */
    bool shares; /* points stand for several cases */
    double top;
};

static bool no_memory(stance_message *message)
{
    snprintf(message->text, sizeof message->text, "stance plot: not enough memory");
    return false;
}

/* ---- what is drawn ------------------------------------------------------------------------ */

/* Stabilised cases are looked at, or where there are none rested ones. */
static enum results_kind choose_judged(const struct results *r)
{
    struct statistics_counts all;
    statistics_count(r, -1, 0, &all);
    return all.kind[RESULTS_STABILISED] == 0 && all.kind[RESULTS_RESTED] > 0 ? RESULTS_RESTED
                                                                             : RESULTS_STABILISED;
}

static bool is_offset(const struct results_varied *v)
{
    return strncmp(v->of.name, "initial.offset.", strlen("initial.offset.")) == 0;
}

static void choose_scatter(struct page *page)
{
    const struct results *r = page->plot->r;
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

/* Range of a path, of offsets times the scale; infinite values are beyond it. */
static void find_range(const struct page *page, int k, double *low, double *high)
{
    const struct results *r = page->plot->r;
    const struct results_varied *v = &r->vary[k];
    double factor[2] = {1, 1};

    if (page->scale >= 0 && is_offset(v)) {
        const struct results_axis *axis = &r->axis[page->scale];
        factor[0] = fmin(axis->value[0], axis->value[axis->count - 1]);
        factor[1] = fmax(axis->value[0], axis->value[axis->count - 1]);
    }
    *low = INFINITY;
    *high = -INFINITY;
    for (size_t i = 0; i < v->of.count; i++) {
        for (int f = 0; f < 2 && isfinite(v->of.value[i]); f++) {
            *low = fmin(*low, factor[f] * v->of.value[i]);
            *high = fmax(*high, factor[f] * v->of.value[i]);
        }
    }
    if (!(*low <= *high))
        *low = *high = 0;
    const double margin = *high > *low ? 0.03 * (*high - *low) : 0.5;
    *low -= margin;
    *high += margin;
}

/* Words, and numbers that are few, have a tic each. */
static bool put_range(struct page *page, int k, char which, int tics, stance_message *message)
{
    const struct results_varied *v = &page->plot->r->vary[k];
    FILE *script = page->g.script;
    struct doe_bins bins;
    double low, high;

    if (!doe_bins_make(&bins, page->plot->r, k, TICS, message))
        return false;
    find_range(page, k, &low, &high);
    if (v->word) {
        low = ceil(low) - 0.5;
        high = floor(high) + 0.5;
    }
    fprintf(script, "set %crange [%.10g:%.10g]\n", which, low, high);
    if (!bins.listed || (page->scale >= 0 && is_offset(v))) {
        fprintf(script, "set %ctics %.10g\nset format %c '%%.10g'\n", which,
                plot_round_step(low, high, tics), which);
        return true;
    }
    fprintf(script, "set %ctics (", which);
    for (size_t b = 0, first = 1; b < bins.count; b++) {
        if (isfinite(bins.bin[b].centre)) {
            char text[40];
            results_number_text(bins.bin[b].centre, 0, text, sizeof text);
            fputs(first ? "" : ", ", script);
            gnuplot_text(script, v->word ? v->word[(int)bins.bin[b].centre] : text, 0);
            fprintf(script, " %.10g", bins.bin[b].centre);
            first = 0;
        }
    }
    fputs(")\n", script);
    return true;
}

/* ---- the scatter -------------------------------------------------------------------------- */

/* Place of a point of the sample along path k; without one a number that fills the height evenly.
 */
static double place_at(const struct page *page, int k, size_t point, double scale)
{
    const struct results *r = page->plot->r;
    if (k < 0)
        return fmod(0.5 + 0.6180339887498949 * (double)point, 1);
    return r->vary[k].of.value[point] * (is_offset(&r->vary[k]) ? scale : 1);
}

static bool have_divisor(uint64_t a, uint64_t b)
{
    while (b > 0) {
        const uint64_t rest = a % b;
        a = b;
        b = rest;
    }
    return a > 1;
}

/* Every case, or every n-th where there are too many. */
static void put_cases(struct page *page, const char *name, FILE *data)
{
    const struct results *r = page->plot->r;
    uint64_t every = (r->cases + MOST_DRAWN - 1) / MOST_DRAWN;

    while (every > 1 && have_divisor(every, r->axis[r->sample].count))
        every++; /* else some points of the sample would be left out altogether */
    for (uint64_t i = 0; i < r->cases; i += every) {
        size_t point[SCENARIO_MAX_AXES];
        results_point(r, i, point);
        const double scale = page->scale < 0 ? 1 : r->axis[page->scale].value[point[page->scale]];
        gnuplot_number(data, place_at(page, page->x, point[r->sample], scale));
        putc(' ', data);
        gnuplot_number(data, place_at(page, page->y, point[r->sample], scale));
        fprintf(data, " %ld\n", strtol(plot_colours[r->kind[i]] + 1, NULL, 16));
    }
    fprintf(page->g.script,
            "plot '%s' using 1:2:3 with points pt 7 ps %g lc rgb variable notitle\n", name,
            r->cases > 4000  ? 0.25
            : r->cases > 400 ? 0.45
                             : 0.8);
}

static bool put_shares(struct page *page, const char *name, FILE *data, stance_message *message)
{
    const struct results *r = page->plot->r;
    const size_t n = r->axis[r->sample].count, every = (n + MOST_DRAWN - 1) / MOST_DRAWN;
    struct statistics_counts *counts = malloc(n * sizeof *counts);
    if (!counts)
        return no_memory(message);
    statistics_count_axis(r, r->sample, counts);
    for (size_t i = 0; i < n; i += every) {
        gnuplot_number(data, place_at(page, page->x, i, 1));
        putc(' ', data);
        gnuplot_number(data, place_at(page, page->y, i, 1));
        putc(' ', data);
        gnuplot_number(data, counts[i].done ? 100 * (double)counts[i].kind[page->judged] /
                                                  (double)counts[i].done
                                            : NAN);
        putc('\n', data);
    }
    free(counts);
    const double x = LEFT + SCATTER_WIDTH + 20, y = page->top + 40;
    /* After cividis (Nunez, Anderton, Renslow 2018): even steps for every reader. */
    fprintf(page->g.script,
            "set palette defined (0 '#00224e', 0.25 '#434e6c', 0.5 '#7d7c78', 0.75 '#bcae6c',"
            " 1 '#fee838')\nset cbrange [0:100]\nset cbtics 20 nomirror out scale 0\n"
            "set cblabel '%s (%%)' offset 0.5,0\n"
            "set colorbox user origin screen %.6f, screen %.6f size screen %.6f, screen %.6f\n"
            "plot '%s' using 1:2:3 with points pt 7 ps %g lc palette notitle\nunset colorbox\n",
            results_kind_names[page->judged], x / page->g.width, 1 - (y + 180) / page->g.height,
            18.0 / page->g.width, 180.0 / page->g.height, name,
            n > 4000  ? 0.25
            : n > 400 ? 0.5
                      : 0.9);
    return true;
}

static bool put_scatter(struct page *page, stance_message *message)
{
    char name[32];
    gnuplot_panel(&page->g, LEFT, page->top, SCATTER_WIDTH, SCATTER_HEIGHT);
    bool good = put_range(page, page->x, 'x', 7, message) &&
                (page->y < 0 || put_range(page, page->y, 'y', 7, message));
    if (page->y < 0)
        fputs("set yrange [0:1]\nunset ytics\n", page->g.script);
    fputs("unset grid\n", page->g.script);
    FILE *data = gnuplot_data(&page->g, name);
    if (good && page->shares)
        good = put_shares(page, name, data, message);
    else if (good)
        put_cases(page, name, data);
    gnuplot_close_data(&page->g, data);
    return good;
}

/* ---- shares ------------------------------------------------------------------------------- */

static void panel_place(const struct page *page, int k, double *x, double *y)
{
    const int row = k / COLUMNS, column = k % COLUMNS;
    *x = LEFT - 20 + column * ACROSS;
    *y = page->top + SCATTER_HEIGHT + LABELS + 40 + row * DOWN;
}

/* Share of the kind judged by in each bin, with its interval, against the bin's median. */
static bool put_panel(struct page *page, int k, double most, stance_message *message)
{
    struct doe_bins bins;
    char name[32];
    double x, y;

    if (!doe_bins_make(&bins, page->plot->r, k, BINS, message))
        return false;
    panel_place(page, k, &x, &y);
    FILE *data = gnuplot_data(&page->g, name);
    for (size_t b = 0; b < bins.count; b++) {
        const struct statistics_counts *c = &bins.bin[b].counts;
        const struct interval *interval = &bins.bin[b].of_kind[page->judged];
        if (c->done == 0 || !isfinite(bins.bin[b].centre))
            continue;
        fprintf(data, "%.17g %.17g %.17g %.17g\n", bins.bin[b].centre,
                100 * (double)c->kind[page->judged] / (double)c->done, 100 * interval->low,
                100 * interval->high);
    }
    fputs("nan nan nan nan\n", data); /* a panel without bins is empty, not an error */
    gnuplot_close_data(&page->g, data);
    gnuplot_panel(&page->g, x, y, PANEL_WIDTH, PANEL_HEIGHT);
    if (!put_range(page, k, 'x', 4, message))
        return false;
    fprintf(page->g.script, "set xtics font '%s'\n", /* words are long, panels are not */
            page->plot->r->vary[k].word ? ",8" : "");
    fprintf(page->g.script,
            "set yrange [0:%.10g]\nset format y '%%.10g'\n"
            "set grid lt 1 lc rgb '#e6e6e6' lw 0.8\n",
            most);
    plot_value_tics(page->g.script, 0, most, PANEL_HEIGHT);
    fprintf(page->g.script,
            "plot '%s' using 1:2:3:4 with yerrorbars lc rgb '%s' pt 7 ps 0.6 lw 1.4 notitle\n",
            name, plot_colours[page->judged]);
    return true;
}

/* The end of the axis of shares, in per cent: the highest interval of all panels. */
static bool find_most(struct page *page, int panels, double *most, stance_message *message)
{
    *most = 1;
    for (int k = 0; k < panels; k++) {
        struct doe_bins bins;
        if (!doe_bins_make(&bins, page->plot->r, k, BINS, message))
            return false;
        for (size_t b = 0; b < bins.count; b++) {
            const struct statistics_counts *c = &bins.bin[b].counts;
            *most = c->done > 0 ? fmax(*most, 104 * bins.bin[b].of_kind[page->judged].high) : *most;
        }
    }
    *most = fmin(*most, 100);
    return true;
}

/* ---- the page ----------------------------------------------------------------------------- */

static void label_page(struct page *page, int panels)
{
    const struct results *r = page->plot->r;
    struct gnuplot *g = &page->g;
    char text[160];
    double x, y;

    plot_axis_label(&r->vary[page->x].of, g, LEFT + SCATTER_WIDTH / 2.0,
                    page->top + SCATTER_HEIGHT + 46, SCATTER_WIDTH + 60, false);
    if (page->y >= 0) {
        plot_axis_label(&r->vary[page->y].of, g, 22, page->top + SCATTER_HEIGHT / 2.0,
                        SCATTER_HEIGHT, true);
    }
    if (!page->shares)
        plot_kind_legend(page->plot, g, LEFT + SCATTER_WIDTH + 20, page->top + 10);
    snprintf(text, sizeof text, "%s (%%), bars: 95 %% interval", results_kind_names[page->judged]);
    panel_place(page, 0, &x, &y);
    gnuplot_label(g, x - 60, y - 18, text, "left", 11, false);
    for (int k = 0; k < panels; k++) {
        panel_place(page, k, &x, &y);
        snprintf(text, sizeof text, r->vary[k].of.unit[0] ? "%s (%s)" : "%s", r->vary[k].of.name,
                 r->vary[k].of.unit);
        gnuplot_label(g, x + PANEL_WIDTH / 2.0, y + PANEL_HEIGHT + 42, text, "center", 10, false);
    }
}

bool plot_sample(const struct plot *plot, stance_message *message)
{
    const struct results *r = plot->r;
    struct page page = {.plot = plot, .judged = choose_judged(r)};
    const char *title = r->title[0] ? r->title : r->name;
    const int panels = r->varied < MOST_PANELS ? r->varied : MOST_PANELS;
    const int width = LEFT + SCATTER_WIDTH + LEGEND, rows = (panels + COLUMNS - 1) / COLUMNS;
    char what[256], stem[512];
    double most;

    choose_scatter(&page);
    snprintf(what, sizeof what, "%llu cases at %zu points of a design, %s",
             (unsigned long long)r->cases, r->axis[r->sample].count, r->method);
    plot_failed_text(r, what, sizeof what);
    page.top = gnuplot_title_height(width, title, what);
    if (!find_most(&page, panels, &most, message) ||
        !gnuplot_begin(&page.g, width, (int)page.top + SCATTER_HEIGHT + LABELS + 40 + rows * DOWN,
                       message))
        return false;
    gnuplot_title(&page.g, title, what);
    label_page(&page, panels);
    gnuplot_decorate(&page.g);
    bool good = put_scatter(&page, message);
    for (int k = 0; good && k < panels; k++)
        good = put_panel(&page, k, most, message);
    if (!good) {
        gnuplot_abandon(&page.g);
        return false;
    }
    if (panels < r->varied)
        fprintf(stderr, "%s: the picture shows %d of the %d paths\n", r->file, panels, r->varied);
    snprintf(stem, sizeof stem, "%s-sample", plot->stem);
    return gnuplot_end(&page.g, plot->directory, stem, message);
}
