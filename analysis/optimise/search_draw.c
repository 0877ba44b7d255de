/* search_draw.c - chooses the pictures of searches, and draws a front: what searches have reached
 * against a number that their scenarios differ in. */
#include "search_front.h"
#include "search_pictures.h"

#include "analysis/draw/plot.h"
#include "runner/plan/allowed.h"

#include <math.h>

const struct search_style search_styles[SEARCH_CURVES] = {
    {"hue[2]", "first candidate", 2, 5},
    {"hue[1]", "chosen", 1, 7},
    {"hue[3]", "allowed by linear theory", 4, 9}};

void search_curve_put(struct gnuplot *g, enum search_curve curve,
                      const struct search_curve_row *row, size_t rows, double size)
{
    const struct search_style *const style = &search_styles[curve];
    gnuplot_series(g,
                   "using 1:2 with lines lc rgb %s dt %d lw 2 notitle, '' using 1:2:3:4 with "
                   "yerrorbars lc rgb %s pt %d ps %g lw 1.4",
                   style->colour, style->dash, style->colour, style->point, size);
    for (size_t i = 0; i < rows; i++)
        GNUPLOT_ROW(g, row[i].x, row[i].share, 100 * row[i].interval.low,
                    100 * row[i].interval.high);
}

void search_curves_write(struct gnuplot *g, const char *const more[SEARCH_CURVES], bool glued)
{
    for (int k = 0; k < SEARCH_CURVES; k++)
        if (more[k])
            gnuplot_legend(g, search_styles[k].colour, search_styles[k].dash, 0,
                           search_styles[k].name, more[k]);
    if (glued && more[SEARCH_ALLOWED])
        gnuplot_note(g, "allowed: " ALLOWED_GLUED);
}

bool plot_search_front(const struct search_front *front, const struct plot *plot)
{
    struct gnuplot g;
    struct plot_axis along;
    struct search_curve_row *row[SEARCH_CURVES];
    double most = 0;
    bool limited = true, glued = false, had = true;
    if (!gnuplot_begin(&g, plot, "front"))
        return false;
    for (int c = 0; c < SEARCH_CURVES; c++)
        had = (row[c] = gnuplot_room(&g, front->count, sizeof *row[c])) && had;
    if (!had)
        return gnuplot_end(&g);
    gnuplot_say(&g, "%zu searches, each with its fresh starts; bars: 95 %% intervals%s%s",
                front->count, front->also[0] ? "; also different: " : "", front->also);
    plot_axis_make_curve(&along, &front->against);
    plot_axis_write(&along, &g, 'x');
    for (size_t i = 0; i < front->count; i++) {
        const struct search_study *const study = &front->study[i];
        const size_t k[] = {0, (size_t)study->f.chosen};
        const double x = plot_axis_place(&along, i);
        for (int c = SEARCH_FIRST; c <= SEARCH_CHOSEN; c++) {
            const struct interval interval = search_interval(study, k[c], SEARCH_OVERALL);
            row[c][i] = (struct search_curve_row){
                x, 100 * search_share(study, k[c], SEARCH_OVERALL), interval};
            most = fmax(most, 100 * interval.high);
        }
        const double limit = search_limit(study, k[1], NULL);
        row[SEARCH_ALLOWED][i] =
            (struct search_curve_row){x, 100 * limit, {.low = limit, .high = limit}};
        glued = glued || study->glued;
        limited = limited && isfinite(limit);
        most = isfinite(limit) ? fmax(most, 100 * limit) : most;
    }
    gnuplot_set(&g, "chart_width = 480; scaled = 1");
    gnuplot_panel(&g, 336, "");
    gnuplot_axis(&g, 'y', PLOT_LINEAR, (struct plot_range){0, fmin(104, 1.04 * most + 1)},
                 "recovered starts (%)", "");
    for (int c = limited ? SEARCH_ALLOWED : SEARCH_CHOSEN; c >= 0; c--)
        search_curve_put(&g, (enum search_curve)c, row[c], front->count, 0.7);
    search_curves_write(&g, (const char *const[SEARCH_CURVES]){"", "", limited ? "" : NULL}, glued);
    return gnuplot_end(&g);
}

/* How the pictures of a search are titled and called. */
static void name_plot(struct plot *plot, const struct search_study *study)
{
    plot->title = study->f.title[0] ? study->f.title : study->name;
    plot->stem = study->name;
}

int search_draw(struct look *look, const char *const *file, size_t files)
{
    struct search_study study;
    struct search_front front;
    stance_message message = {""};
    bool good = false;
    char own[1024];
    struct plot plot = {.directory = look_directory(look, file[0], own, sizeof own),
                        .look = look,
                        .message = &message};
    if (!gnuplot_directory(plot.directory))
        return EXIT_IO;
    if (files == 1 && (good = search_study_open(&study, file[0], &message))) {
        name_plot(&plot, &study);
        good = plot_search_convergence(&study, &plot) && plot_search_starts(&study, &plot);
        search_study_close(&study);
    } else if (files > 1 && (good = search_front_open(&front, file, files, &message))) {
        name_plot(&plot, &front.study[0]);
        good = plot_search_front(&front, &plot);
        search_front_close(&front);
    }
    if (!good)
        fprintf(stderr, "%s\n", message.text);
    return good ? EXIT_DONE : EXIT_IO;
}
