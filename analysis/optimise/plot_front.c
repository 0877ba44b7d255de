/* plot_front.c - a front: what searches have reached against a number that their scenarios differ
 * in. */
#include "search_front.h"
#include "search_pictures.h"

#include "analysis/draw/plot.h"

#include <math.h>

GNUPLOT_SCRIPT(plot_front_gp, "analysis/optimise/plot_front.gp");

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
        const char *where;
        double row[8] = {plot_axis_place(&along, i)};
        for (int c = 0; c < 2; c++) {
            const struct interval interval = search_interval(study, k[c], SEARCH_OVERALL);
            row[1 + 3 * c] = 100 * search_share(study, k[c], SEARCH_OVERALL);
            row[2 + 3 * c] = 100 * interval.low;
            row[3 + 3 * c] = 100 * interval.high;
            most = fmax(most, 100 * interval.high);
        }
        glued = glued || study->glued;
        row[7] = 100 * search_limit(study, k[1], &where);
        limited = limited && isfinite(row[7]);
        most = isfinite(row[7]) ? fmax(most, row[7]) : most;
        gnuplot_row(&g, row, 8);
    }
    search_curves_write(&g, (const char *const[SEARCH_CURVES]){"", "", limited ? "" : NULL}, glued);
    gnuplot_set(&g, "limited = %d; most = %#.10g", limited, fmin(104, 1.04 * most + 1));
    return gnuplot_end(&g);
}
