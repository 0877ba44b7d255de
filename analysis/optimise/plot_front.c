/* plot_front.c - a front: what searches have reached against a number that their scenarios differ
 * in. */
#include "search_front.h"
#include "search_pictures.h"

#include "analysis/draw/plot.h"

#include <math.h>

bool plot_search_front(const struct search_front *front, const struct plot *plot)
{
    struct gnuplot g;
    struct plot_axis along;
    struct search_curve_row *row[SEARCH_CURVES];
    double most = 0;
    bool limited = true, glued = false, had = true;
    if (!gnuplot_begin(&g, plot, "front", NULL))
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
        const char *where;
        for (int c = SEARCH_FIRST; c <= SEARCH_CHOSEN; c++) {
            const struct interval interval = search_interval(study, k[c], SEARCH_OVERALL);
            row[c][i] = (struct search_curve_row){
                x, 100 * search_share(study, k[c], SEARCH_OVERALL), interval};
            most = fmax(most, 100 * interval.high);
        }
        const double limit = search_limit(study, k[1], &where);
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
