/* plot_convergence.c - a search as it went: over the candidates in their order what each was worth,
 * the mean of the distribution that they are drawn from, and how wide it is.
 *
 * Of the mean its change from the first candidate is drawn, in the coordinates that the search
 * moves, each number in its unit: of a gain what takes the whole torque from the edge of the
 * starts, of what moves by ratios its logarithm. The width along a coordinate is its standard
 * deviation, the step times the root of the covariance.
 */
#include "search_pictures.h"

#include "analysis/statistics/statistics.h"

#include "runner/scenario/schema.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
    MOST_NAMED = 14,
    MOST_DRAWN = 40000,
    MOST_STAGES = SCENARIO_MAX_STAGES * (SCENARIO_MAX_RESTARTS + 1)
};

struct page {
    struct gnuplot g;
    const struct search_study *study;
    double scale;             /* 100: objectives are per cent */
    double at[SEARCH_CURVES]; /* what fresh starts said; NAN: nothing */
};

/* ---- what the candidates were worth ------------------------------------------------------- */

/* Dots, and over all that is known of them the best so far as steps, stages apart. */
static void put_candidates(struct page *page)
{
    const struct search_file *const f = &page->study->f;
    const size_t n = f->length[SEARCH_CANDIDATE], every = (n + MOST_DRAWN - 1) / MOST_DRAWN;
    gnuplot_series(&page->g, "using 1:2 with points pt 7 ps %g lc rgb grey", 0.8 * gnuplot_dot(n));
    for (size_t i = 0; i < n; i += every)
        GNUPLOT_ROW(&page->g, (double)i + 1, page->scale * f->objective[i]);
    for (int k = SEARCH_CURVES; k-- > 0;) {
        gnuplot_series(&page->g, "using 1:2 with lines lc rgb %s dt %d lw 2.2",
                       search_styles[k].colour, search_styles[k].dash);
        gnuplot_segment(&page->g, 0, page->at[k], (double)n, page->at[k]);
    }
    gnuplot_series(&page->g, "using 1:2 with lines lc rgb 0x000000 lw 2");
    for (size_t g = 0; g < f->length[SEARCH_GENERATION]; g++) {
        const double best = page->scale * f->objective[f->best[g]];
        if (g > 0 && (f->stage[g] != f->stage[g - 1] || f->restart[g] != f->restart[g - 1]))
            gnuplot_gap(&page->g);
        GNUPLOT_ROW(&page->g, (double)search_first(f, g), best);
        GNUPLOT_ROW(&page->g, (double)f->candidates[g], best);
    }
}

static void put_stages(struct page *page)
{
    const struct search_file *const f = &page->study->f;
    size_t last[MOST_STAGES];
    const size_t stages = search_stages(page->study, last, MOST_STAGES);
    gnuplot_set(&page->g, "stretches = %zu", stages);
    gnuplot_arrays(&page->g, stages, "stretch_from stretch_to stretch_text");
    for (size_t i = 0; i < stages; i++) {
        char text[40];
        snprintf(text, sizeof text, "%lld starts", (long long)f->starts[last[i]]);
        gnuplot_set(&page->g, "stretch_from[%zu] = %lld; stretch_to[%zu] = %lld", i + 1,
                    i > 0 ? (long long)f->candidates[last[i - 1]] : 0LL, i + 1,
                    (long long)f->candidates[last[i]]);
        gnuplot_text(&page->g, text, "stretch_text[%zu]", i + 1);
    }
}

/* The axis of objectives. Prices have no lower bound: candidates that are far worse than the first
 * are left out there. */
static struct plot_range shown(const struct page *page)
{
    const struct search_file *const f = &page->study->f;
    struct plot_range range = PLOT_NOTHING, all;
    for (int k = 0; k < SEARCH_CURVES; k++)
        if (k != SEARCH_ALLOWED)
            plot_widen(&range, page->at[k]);
    if (range.low > range.high)
        plot_widen(&range, page->scale * f->objective[0]);
    const double low = range.low;
    plot_widen(&range, fmax(low, page->at[SEARCH_ALLOWED]));
    plot_range_of(&all, f->objective, f->length[SEARCH_CANDIDATE]);
    range.high = fmax(range.high, page->scale * all.high);
    range.low = fmax(fmin(low, page->scale * all.low), low - (range.high - low));
    if (page->study->plain)
        range.low = 0;
    const double room = range.high > range.low ? 0.06 * (range.high - range.low) : 1;
    return (struct plot_range){page->study->plain ? 0 : range.low - room, range.high + room};
}

/* What fresh starts said, and its legend. */
static void find_lines(struct page *page)
{
    static const char *const format[] = {"%.4g", "%.1f %%"};
    const struct search_study *const study = page->study;
    const struct search_file *const f = &study->f;
    const char *more[SEARCH_CURVES] = {NULL};
    char text[SEARCH_CURVES][40];
    page->at[SEARCH_FIRST] = page->at[SEARCH_CHOSEN] = page->at[SEARCH_ALLOWED] = NAN;
    if (study->done) {
        page->at[SEARCH_FIRST] = page->scale * f->confirmed_objective[0];
        page->at[SEARCH_CHOSEN] = page->scale * f->confirmed_objective[f->chosen];
    }
    if (study->done && study->plain)
        page->at[SEARCH_ALLOWED] = page->scale * search_limit(study, (size_t)f->chosen, NULL);
    for (int k = 0; k < SEARCH_CURVES; k++) {
        snprintf(text[k], sizeof text[k], format[study->plain], page->at[k]);
        more[k] = isnan(page->at[k]) ? NULL : text[k];
    }
    search_curves_write(&page->g, more, study->glued);
}

/* ---- the distribution --------------------------------------------------------------------- */

/* "hip1 vq2" of a gain, else the last part of the path. */
static void name_number(const struct search_study *study, size_t k, char *text, size_t size)
{
    const char *const path = study->f.parameter[k];
    const stance_scene *const scene = study->first ? study->first->scene : NULL;
    int row, column;
    if (scene && sscanf(path, "controller.gains[%d][%d]", &row, &column) == 2 && row >= 0 &&
        row < scene->actuators && column >= 0 && column < 2 * scene->postures)
        snprintf(text, size, "%s %s%s", scene->actuator_name[row],
                 column < scene->postures ? "" : "v",
                 scene->coordinate[scene->posture[column % scene->postures]].name);
    else
        snprintf(text, size, "%s", schema_last_name(path));
}

static double change(const struct search_file *f, size_t generation, size_t k)
{
    return f->mean[generation * f->length[SEARCH_PARAMETER] + k] - f->coordinate[k];
}

/* A number of each generation as a line of the last panel; k: of the distribution, or the step. */
enum number { MEAN, WIDTH, STEP };
static double number_of(const struct search_file *f, size_t g, size_t k, enum number number)
{
    const size_t n = f->length[SEARCH_PARAMETER];
    return number == MEAN   ? change(f, g, k)
           : number == STEP ? log10(f->step[g])
                            : log10(f->step[g] * sqrt(f->covariance[(g * n + k) * n + k]));
}

static void put_line(struct page *page, size_t k, enum number number, const char *style)
{
    const struct search_file *const f = &page->study->f;
    gnuplot_series(&page->g, "using 1:2 with lines %s", style);
    for (size_t g = 0; g < f->length[SEARCH_GENERATION]; g++)
        GNUPLOT_ROW(&page->g, (double)f->candidates[g], number_of(f, g, k, number));
}

/* The panel of the mean, its lines with a hue and dashes each while they can be told apart, then
 * with their names in the order in which they end, the lowest first; that of the width. */
static void put_distribution(struct page *page)
{
    static const char thin[] = "lc rgb grey lw 0.8";
    struct gnuplot *const g = &page->g;
    const struct search_file *const f = &page->study->f;
    const size_t n = f->length[SEARCH_PARAMETER], generations = f->length[SEARCH_GENERATION];
    struct statistics_place *const end = gnuplot_room(g, n, sizeof *end);
    struct plot_range range[] = {PLOT_NOTHING, PLOT_NOTHING};
    char style[80];
    for (size_t i = 0; i < generations * n; i++) {
        plot_widen(&range[MEAN], number_of(f, i / n, i % n, MEAN));
        plot_widen(&range[WIDTH], number_of(f, i / n, i % n, WIDTH));
        plot_widen(&range[WIDTH], number_of(f, i / n, 0, STEP));
    }
    gnuplot_panel(g, 224, "");
    gnuplot_axis(g, 'y', PLOT_LINEAR, plot_roomy(range[MEAN], 0.05), "change of the mean", "");
    for (size_t k = 0; k < n; k++) {
        snprintf(style, sizeof style, "lc rgb %s dt %zu lw 1.8", gnuplot_hue(k), k / 7 % 5 + 1);
        put_line(page, k, MEAN, n <= MOST_NAMED ? style : thin);
    }
    for (size_t k = 0; end && k < n; k++)
        end[k] = (struct statistics_place){change(f, generations - 1, k), k};
    if (end && n <= MOST_NAMED) {
        size_t longest = 0;
        statistics_order(end, n);
        gnuplot_arrays(g, n, "end_at end_text end_colour");
        for (size_t k = 0; k < n; k++) {
            char text[100];
            name_number(page->study, end[k].index, text, sizeof text);
            const char *const label = look_label(g->plot->look, text);
            longest = strlen(label) > longest ? strlen(label) : longest;
            gnuplot_set(g, "end_colour[%zu] = %s", k + 1, gnuplot_hue(end[k].index));
            gnuplot_number(g, end[k].value, "end_at[%zu]", k + 1);
            gnuplot_text(g, label, "end_text[%zu]", k + 1);
        }
        gnuplot_set(g, "ends = %zu; end_panel = panels; longest_end = %zu", n, longest);
    }
    gnuplot_panel(g, 112, "");
    gnuplot_axis(g, 'y', PLOT_LOG,
                 range[WIDTH].low <= range[WIDTH].high
                     ? (struct plot_range){range[WIDTH].low - 0.05, range[WIDTH].high + 0.05}
                     : (struct plot_range){-1, 0},
                 "st. dev.", "");
    for (size_t k = 0; k < n; k++)
        put_line(page, k, WIDTH, thin);
    put_line(page, 0, STEP, "lc rgb 0x000000 lw 2");
}

/* ---- the page ----------------------------------------------------------------------------- */

bool plot_search_convergence(const struct search_study *study, const struct plot *plot)
{
    const struct search_file *const f = &study->f;
    struct page page = {.study = study, .scale = study->plain ? 100 : 1};
    struct gnuplot *const g = &page.g;
    if (!gnuplot_begin(g, plot, "convergence"))
        return false;
    gnuplot_say(g, "%zu candidates in %zu ", f->length[SEARCH_CANDIDATE],
                f->length[SEARCH_GENERATION]);
    if (study->done)
        gnuplot_say(g, "generations; lines: of %zu fresh starts", f->length[SEARCH_START]);
    else
        gnuplot_say(g, "of at most %lld generations, not finished", (long long)f->most_generations);
    gnuplot_set(g, "chart_width = 560");
    gnuplot_axis(g, 'x', PLOT_LINEAR, (struct plot_range){0, (double)f->length[SEARCH_CANDIDATE]},
                 "candidate", "");
    gnuplot_legend(g, "grey", 0, 7, "candidate", "");
    gnuplot_legend(g, "0x000000", 1, 0, "best so far of its stage", "");
    find_lines(&page);
    put_stages(&page);
    gnuplot_panel(g, 280, "");
    gnuplot_axis(g, 'y', PLOT_LINEAR, shown(&page),
                 study->plain ? "recovered starts (%)" : "objective", "");
    put_candidates(&page);
    put_distribution(&page);
    return gnuplot_end(g);
}
