/* plot_truth.c - errors against what is known from outside, a line of the picture for each truth.
 */
#include "truth.h"

#include "analysis/draw/gnuplot.h"

#include "runner/base/message.h"

#include <math.h>

GNUPLOT_SCRIPT(plot_truth_gp, "analysis/bench/plot_truth.gp");

/* Smaller errors are drawn at the one, larger ones at the other. */
static const double least = 1e-16, most = 1e2;

bool truth_plot(const struct truth_list *list, const struct truth_reached *reached, size_t methods,
                struct look *look, const char *directory, stance_message *message)
{
    struct gnuplot g;
    if (!gnuplot_directory(directory))
        return complain(message, "no picture is drawn");
    if (!gnuplot_begin(&g, look, plot_truth_gp, "Held against what is known from outside",
                       "Error of each method; grey: within the error bar of what is known. A cross "
                       "at the right end: no number",
                       message))
        return false;
    gnuplot_set(&g, "rows = %zu; methods = %zu\narray name[%zu]", list->rows, methods, list->rows);
    for (size_t i = 0; i < list->rows; i++)
        gnuplot_text(&g, list->row[i].name, "name[%zu]", i + 1);
    gnuplot_block(&g, "bars");
    for (size_t i = 0; i < list->rows; i++)
        GNUPLOT_ROW(&g, list->row[i].bar > 0 ? list->row[i].bar : NAN, (double)(i + 1));
    gnuplot_end_block(&g);
    for (size_t m = 0; m < methods; m++) {
        static const int markers[] = {7, 5, 9, 11, 13, 15, 2};
        char colour[32];
        snprintf(colour, sizeof colour, "hue[%zu]", m + 1);
        gnuplot_legend_mark(&g, colour, 0, markers[m % 7], reached[m].method->name, "");
        gnuplot_block(&g, "errors%zu", m + 1);
        for (size_t i = 0; i < list->rows; i++) {
            const double error = fabs(reached[i * methods + m].value - list->row[i].value);
            GNUPLOT_ROW(&g, isnan(error) ? NAN : fmin(fmax(error, least), most), (double)(i + 1),
                        isnan(error));
        }
        gnuplot_end_block(&g);
    }
    return gnuplot_end(&g, directory, "truth", message);
}
