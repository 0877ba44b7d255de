/* search_draw.c - chooses the pictures of searches, and draws a front: what searches have reached
 * against a number that their scenarios differ in. */
#include "search_front.h"
#include "search_pictures.h"

#include "analysis/draw/plot.h"
#include "runner/plan/allowed.h"

#include <math.h>

GNUPLOT_SCRIPT(plot_front_gp, "analysis/optimise/plot_front.gp");

void search_curves_write(struct gnuplot *g, const char *const more[SEARCH_CURVES], bool glued)
{
    static const struct {
        const char *colour, *name;
        int dash;
    } curve[SEARCH_CURVES] = {{"hue[2]", "first candidate", 2},
                              {"hue[1]", "chosen", 1},
                              {"hue[3]", "allowed by linear theory", 4}};
    for (int k = 0; k < SEARCH_CURVES; k++)
        if (more[k])
            gnuplot_legend(g, curve[k].colour, curve[k].dash, 0, curve[k].name, more[k]);
    if (glued && more[SEARCH_ALLOWED])
        gnuplot_note(g, "allowed: " ALLOWED_GLUED);
}

bool plot_search_front(const struct search_front *front, const struct plot *plot)
{
    struct gnuplot g;
    struct plot_axis along;
    double most = 0;
    bool limited = true, glued = false;
    if (!gnuplot_begin(&g, plot, "front", plot_front_gp))
        return false;
    gnuplot_say(&g, "%zu searches, each with its fresh starts; bars: 95 %% intervals%s%s",
                front->count, front->also[0] ? "; also different: " : "", front->also);
    plot_axis_make_curve(&along, &front->against);
    plot_axis_write(&along, &g, 'x');
    gnuplot_block(&g, "front");
    for (size_t i = 0; i < front->count; i++) {
        const struct search_study *const study = &front->study[i];
        const size_t k[] = {0, (size_t)study->f.chosen};
        double row[8] = {plot_axis_place(&along, i)};
        for (int c = 0; c < 2; c++) {
            const struct interval interval = search_interval(study, k[c], SEARCH_OVERALL);
            row[1 + 3 * c] = 100 * search_share(study, k[c], SEARCH_OVERALL);
            row[2 + 3 * c] = 100 * interval.low;
            row[3 + 3 * c] = 100 * interval.high;
            most = fmax(most, 100 * interval.high);
        }
        glued = glued || study->glued;
        row[7] = 100 * search_limit(study, k[1], NULL);
        limited = limited && isfinite(row[7]);
        most = isfinite(row[7]) ? fmax(most, row[7]) : most;
        gnuplot_row(&g, row, 8);
    }
    search_curves_write(&g, (const char *const[SEARCH_CURVES]){"", "", limited ? "" : NULL}, glued);
    gnuplot_set(&g, "limited = %d; most = %#.10g", limited, fmin(104, 1.04 * most + 1));
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
