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

GNUPLOT_SCRIPT(plot_convergence_gp, "analysis/optimise/plot_convergence.gp");

enum {
    MOST_NAMED = 14,
    MOST_DRAWN = 40000,
    MOST_STAGES = SCENARIO_MAX_STAGES * (SCENARIO_MAX_RESTARTS + 1)
};

struct page {
    struct gnuplot g;
    const struct search_study *study;
    double scale; /* 100: objectives are per cent */
};

/* ---- what the candidates were worth ------------------------------------------------------- */

/* Dots, and in a block of its own the best so far as steps, stages apart. */
static void put_candidates(struct page *page)
{
    const struct search_file *const f = &page->study->f;
    const size_t n = f->length[SEARCH_CANDIDATE], every = (n + MOST_DRAWN - 1) / MOST_DRAWN;
    gnuplot_block(&page->g, "candidates");
    for (size_t i = 0; i < n; i += every)
        GNUPLOT_ROW(&page->g, (double)i + 1, page->scale * f->objective[i]);
    gnuplot_block(&page->g, "best");
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
    gnuplot_set(&page->g, "stages = %zu", stages);
    gnuplot_arrays(&page->g, stages, "stage_from stage_to stage_text");
    for (size_t i = 0; i < stages; i++) {
        char text[40];
        snprintf(text, sizeof text, "%lld starts", (long long)f->starts[last[i]]);
        gnuplot_set(&page->g, "stage_from[%zu] = %lld; stage_to[%zu] = %lld", i + 1,
                    i > 0 ? (long long)f->candidates[last[i - 1]] : 0LL, i + 1,
                    (long long)f->candidates[last[i]]);
        gnuplot_text(&page->g, text, "stage_text[%zu]", i + 1);
    }
}

/* Where the axis of objectives begins and ends. Prices have no lower bound: candidates that are far
 * worse than the first are left out there. */
static void put_range(struct page *page, double first, double chosen, double limit)
{
    const struct search_file *const f = &page->study->f;
    double low = fmin(first, chosen), high = fmax(fmax(first, chosen), limit);
    low = isnan(low) ? page->scale * f->objective[0] : low;
    high = isnan(high) ? low : high;
    double least = low;
    for (size_t i = 0; i < f->length[SEARCH_CANDIDATE]; i++) {
        high = fmax(high, page->scale * f->objective[i]);
        least = fmin(least, page->scale * f->objective[i]);
    }
    low = page->study->plain ? 0 : fmax(least, low - (high - low));
    const double room = high > low ? 0.06 * (high - low) : 1;
    gnuplot_number(&page->g, page->study->plain ? 0 : low - room, "low");
    gnuplot_number(&page->g, high + room, "high");
}

/* The lines of what fresh starts said, with their numbers in the legend. */
static void put_lines(struct page *page)
{
    static const char *const format[] = {"%.4g", "%.1f %%"};
    const struct search_study *const study = page->study;
    const struct search_file *const f = &study->f;
    const bool done = study->done;
    const char *where;
    const double at[SEARCH_CURVES] = {
        page->scale * (done ? f->confirmed_objective[0] : NAN),
        page->scale * (done ? f->confirmed_objective[f->chosen] : NAN),
        page->scale *
            (done && study->plain ? search_limit(study, (size_t)f->chosen, &where) : NAN)};
    char text[SEARCH_CURVES][40];
    const char *more[SEARCH_CURVES] = {NULL};
    gnuplot_set(&page->g, "array curve_at[%d]", SEARCH_CURVES);
    for (int k = 0; k < SEARCH_CURVES; k++) {
        snprintf(text[k], sizeof text[k], format[study->plain], at[k]);
        more[k] = isnan(at[k]) ? NULL : text[k];
        gnuplot_number(&page->g, at[k], "curve_at[%d]", k + 1);
    }
    search_curves_write(&page->g, more, study->glued);
    put_range(page, at[SEARCH_FIRST], at[SEARCH_CHOSEN], at[SEARCH_ALLOWED]);
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

/* Rows of a block: candidates so far, then one number each. */
static void put_distribution(struct page *page, const char *block, bool width)
{
    const struct search_file *const f = &page->study->f;
    const size_t n = f->length[SEARCH_PARAMETER];
    double row[2 + SCENARIO_MAX_PATHS];
    gnuplot_block(&page->g, "%s", block);
    for (size_t g = 0; g < f->length[SEARCH_GENERATION]; g++) {
        size_t columns = 0;
        row[columns++] = (double)f->candidates[g];
        if (width)
            row[columns++] = f->step[g];
        for (size_t k = 0; k < n; k++)
            row[columns++] =
                width ? f->step[g] * sqrt(f->covariance[(g * n + k) * n + k]) : change(f, g, k);
        gnuplot_row(&page->g, row, columns);
    }
}

/* Numbers in the order in which they end, the lowest first: number[k], its name, its end. */
static void put_ends(struct page *page)
{
    const struct search_file *const f = &page->study->f;
    const size_t n = f->length[SEARCH_PARAMETER];
    struct statistics_place *const end = gnuplot_room(&page->g, n, sizeof *end);
    for (size_t k = 0; end && k < n; k++)
        end[k] = (struct statistics_place){change(f, f->length[SEARCH_GENERATION] - 1, k), k};
    if (end)
        statistics_order(end, n);
    gnuplot_set(&page->g, "numbers = %zu; named = %d", n, n <= MOST_NAMED);
    gnuplot_arrays(&page->g, n, "end_number end_at end_text");
    for (size_t k = 0; end && k < n; k++) {
        char text[100];
        name_number(page->study, end[k].index, text, sizeof text);
        gnuplot_set(&page->g, "end_number[%zu] = %zu", k + 1, end[k].index + 1);
        gnuplot_number(&page->g, end[k].value, "end_at[%zu]", k + 1);
        gnuplot_text(&page->g, look_label(page->g.plot->look, text), "end_text[%zu]", k + 1);
    }
}

static void put_means(struct page *page)
{
    const struct search_file *const f = &page->study->f;
    const size_t n = f->length[SEARCH_PARAMETER], generations = f->length[SEARCH_GENERATION];
    struct plot_range mean = PLOT_NOTHING, width = PLOT_NOTHING;
    for (size_t i = 0; i < generations * n; i++) {
        plot_widen(&mean, change(f, i / n, i % n));
        plot_widen(&width, log10(f->step[i / n] * sqrt(f->covariance[i * n + i % n])));
    }
    for (size_t g = 0; g < generations; g++)
        plot_widen(&width, log10(f->step[g]));
    const bool known = mean.low <= mean.high && width.low <= width.high;
    const struct plot_range shown = plot_roomy(known ? mean : PLOT_NOTHING, 0.05);
    gnuplot_number(&page->g, shown.low, "mean_low");
    gnuplot_number(&page->g, shown.high, "mean_high");
    gnuplot_number(&page->g, known ? width.low - 0.05 : -1, "width_low");
    gnuplot_number(&page->g, known ? width.high + 0.05 : 0, "width_high");
    put_ends(page);
    put_distribution(page, "mean", false);
    put_distribution(page, "width", true);
}

/* ---- the page ----------------------------------------------------------------------------- */

bool plot_search_convergence(const struct search_study *study, const struct plot *plot)
{
    const struct search_file *const f = &study->f;
    struct page page = {.study = study, .scale = study->plain ? 100 : 1};
    struct gnuplot *const g = &page.g;
    if (!gnuplot_begin(g, plot, "convergence", plot_convergence_gp))
        return false;
    gnuplot_say(g, "%zu candidates in %zu ", f->length[SEARCH_CANDIDATE],
                f->length[SEARCH_GENERATION]);
    if (study->done)
        gnuplot_say(g, "generations; lines: of %zu fresh starts", f->length[SEARCH_START]);
    else
        gnuplot_say(g, "of at most %lld generations, not finished", (long long)f->most_generations);
    gnuplot_set(g, "candidates = %zu", f->length[SEARCH_CANDIDATE]);
    gnuplot_text(g, study->plain ? "recovered starts (%)" : "objective", "worth");
    gnuplot_legend(g, "grey", 0, 7, "candidate", "");
    gnuplot_legend(g, "0x000000", 1, 0, "best so far of its stage", "");
    put_lines(&page);
    put_stages(&page);
    put_candidates(&page);
    put_means(&page);
    return gnuplot_end(g);
}
