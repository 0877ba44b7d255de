/* plot_starts.c - where a search has won: along each coordinate of the fresh starts, in parts of
 * equally many, the share that the first candidate and the chosen one recover, and from which
 * linear theory allows any controller to. All others of a part's coordinates are spread over their
 * ranges: these are shares, not a section through the domain. */
#include "search_pictures.h"

#include "analysis/statistics/statistics.h"

#include "runner/scenario/schema.h"

#include <math.h>

enum { PARTS = 12, LEAST = 20, MOST_PANELS = 18 }; /* starts in a part at least */

struct page {
    struct gnuplot g;
    const struct search_study *study;
    double *allowed;                /* of each start; NULL: linear theory sets no bound */
    struct statistics_place *order; /* of the starts along a coordinate */
    size_t circumstance;
    double most; /* per cent */
};

/* The share of the circumstances that count in which candidate k recovers from a start. */
static double recovered(const struct page *page, size_t k, size_t start)
{
    size_t from, to, count = 0;
    search_circumstances(page->study, page->circumstance, &from, &to);
    for (size_t c = from; c < to; c++)
        count += search_recovers(page->study, k, c, start);
    return (double)count / (double)(to - from);
}

/* The middle of the starts from ... to in their order, and of each curve its share. */
static void make_part(struct page *page, size_t from, size_t to,
                      struct search_curve_row row[SEARCH_CURVES])
{
    struct interval_draws draws[SEARCH_CURVES] = {{0}};
    double middle = 0;
    for (size_t i = from; i < to; i++) {
        const size_t start = page->order[i].index;
        middle += page->order[i].value / (double)(to - from);
        interval_add(&draws[SEARCH_FIRST], recovered(page, 0, start), 1);
        interval_add(&draws[SEARCH_CHOSEN], recovered(page, (size_t)page->study->f.chosen, start),
                     1);
        if (page->allowed)
            interval_add(&draws[SEARCH_ALLOWED], page->allowed[start], 1);
    }
    for (int k = 0; k < SEARCH_CURVES; k++) {
        const struct interval interval = interval_of(&draws[k], 0.95);
        row[k] = (struct search_curve_row){middle, 100 * draws[k].k / draws[k].m, interval};
        page->most = fmax(page->most, isnan(interval.high) ? 0 : 100 * interval.high);
    }
}

static void put_panel(struct page *page, size_t column)
{
    const struct search_file *const f = &page->study->f;
    const size_t n = f->length[SEARCH_START], parts = n / PARTS >= LEAST ? PARTS
                                                      : n / LEAST > 2    ? n / LEAST
                                                                         : 2;
    const char *const path = f->varied[column], *const label = look_label(page->g.plot->look, path);
    struct search_curve_row row[SEARCH_CURVES][PARTS], of[SEARCH_CURVES];
    struct results_axis axis = {.unit = ""};
    size_t rows = 0;
    for (size_t i = 0; i < n; i++) {
        const double at = f->start_value[i * f->length[SEARCH_VARIED] + column];
        page->order[i] = (struct statistics_place){isnan(at) ? INFINITY : at, i}; /* damaged */
    }
    statistics_order(page->order, n);
    for (size_t p = 0; p < parts; p++) {
        if (p * n / parts == (p + 1) * n / parts)
            continue;
        make_part(page, p * n / parts, (p + 1) * n / parts, of);
        for (int k = 0; k < SEARCH_CURVES; k++)
            row[k][rows] = of[k];
        rows++;
    }
    snprintf(axis.name, sizeof axis.name, "%s", path);
    search_describe(page->study, &axis);
    gnuplot_panel(&page->g, 168, "");
    gnuplot_axis(
        &page->g, 'x', PLOT_LINEAR,
        plot_roomy((struct plot_range){page->order[0].value, page->order[n - 1].value}, 0.04),
        label == path ? schema_last_name(path) : label, axis.unit);
    for (int k = page->allowed ? SEARCH_ALLOWED : SEARCH_CHOSEN; k >= 0; k--)
        search_curve_put(&page->g, (enum search_curve)k, row[k], rows, 0.4);
}

static void put_legend(struct page *page)
{
    const struct search_file *const f = &page->study->f;
    const size_t n = f->length[SEARCH_START];
    char text[SEARCH_CURVES][32];
    double allowed = 0;
    for (size_t i = 0; page->allowed && i < n; i++)
        allowed += page->allowed[i] / (double)n;
    const double share[SEARCH_CURVES] = {
        search_share(page->study, 0, page->circumstance),
        search_share(page->study, (size_t)f->chosen, page->circumstance), allowed};
    for (int k = 0; k < SEARCH_CURVES; k++)
        snprintf(text[k], sizeof text[k], "%.1f %%", 100 * share[k]);
    search_curves_write(
        &page->g,
        (const char *const[SEARCH_CURVES]){text[SEARCH_FIRST], text[SEARCH_CHOSEN],
                                           page->allowed ? text[SEARCH_ALLOWED] : NULL},
        page->study->glued);
}

bool plot_search_starts(const struct search_study *study, const struct plot *plot)
{
    const struct search_file *const f = &study->f;
    const size_t starts = f->length[SEARCH_START], varied = f->length[SEARCH_VARIED],
                 panels = varied < MOST_PANELS ? varied : MOST_PANELS;
    struct page page = {.study = study};
    struct gnuplot *const g = &page.g;
    if (!study->done || varied == 0)
        return true;
    if (!gnuplot_begin(g, plot, "starts"))
        return false;
    page.circumstance = search_worst(study, (size_t)f->chosen);
    page.allowed = gnuplot_room(g, starts, sizeof *page.allowed);
    page.order = gnuplot_room(g, starts, sizeof *page.order);
    if (!page.allowed || !page.order)
        return gnuplot_end(g);
    if (!search_allowed(study, page.allowed))
        page.allowed = NULL;
    gnuplot_say(g, "%zu fresh starts", starts);
    if (f->length[SEARCH_CIRCUMSTANCE] > 1 && page.circumstance == SEARCH_OVERALL)
        gnuplot_say(g, ", mean of %zu circumstances", f->length[SEARCH_CIRCUMSTANCE]);
    else if (f->length[SEARCH_CIRCUMSTANCE] > 1)
        gnuplot_say(g, ", in the worst circumstance of the chosen one: %.200s",
                    f->circumstance[page.circumstance]);
    gnuplot_set(g, "columns = 3; chart_width = 210; scaled = 1");
    gnuplot_axis(g, 'y', PLOT_LINEAR, (struct plot_range){0, 100}, "share of the starts (%)", "");
    for (size_t k = 0; k < panels; k++)
        put_panel(&page, k);
    gnuplot_number(g, fmin(104, 1.04 * page.most + 1), "y_high");
    put_legend(&page);
    gnuplot_note(g, "bars: 95 %% intervals");
    if (panels < varied)
        gnuplot_note(g, "%zu of the %zu coordinates are drawn", panels, varied);
    return gnuplot_end(g);
}
