/* schedule_picture.c - efficiency against ranks, and shares of the ranks' time lost to what. */
#include "schedule_picture.h"

#include "analysis/draw/gnuplot.h"

#include <math.h>

enum { LEFT = 80, PANEL_WIDTH = 400, PANEL_HEIGHT = 320, GAP = 110, LEGEND = 170, BOTTOM = 70 };

static const struct {
    const char *text, *colour;
    int marker;
} losses[] = {{"the counter", "#0072b2", 7}, {"writes", "#d55e00", 5}, {"the end", "#009e73", 9}};
enum { LOSSES = sizeof losses / sizeof losses[0] };

/* Columns: ranks, efficiency and the losses in percent; zero has no place on a logarithm. */
static void put_data(struct gnuplot *g, const struct schedule_study *study, char name[32])
{
    FILE *data = gnuplot_data(g, name);
    for (size_t k = 0; k < study->count; k++) {
        const struct simulation *s = &study->result[k];
        const double all = s->time * study->ranks[k];
        const double shares[LOSSES] = {s->drawing / all, s->writing / all, s->waiting / all};
        fprintf(data, "%d ", study->ranks[k]);
        gnuplot_number(data, 100 * simulation_efficiency(s, study->ranks[k]));
        for (size_t i = 0; i < LOSSES; i++) {
            putc(' ', data);
            gnuplot_number(data, shares[i] > 0 ? 100 * shares[i] : NAN);
        }
        putc('\n', data);
    }
    gnuplot_close_data(g, data);
}

static void put_ranks(struct gnuplot *g, const struct schedule_study *study)
{
    int low = study->ranks[0], high = study->ranks[0];
    for (size_t k = 1; k < study->count; k++) {
        low = study->ranks[k] < low ? study->ranks[k] : low;
        high = study->ranks[k] > high ? study->ranks[k] : high;
    }
    fprintf(g->script,
            "set logscale x 2; set xrange [%g:%g]\n"
            "set ytics font ',10'\n"
            "set xlabel 'ranks' font ',10'; set grid lc '#e4e4e4' lw 0.6\nset xtics font ',10' (",
            low / 1.5, high * 1.5);
    for (size_t k = 0; k < study->count; k++)
        fprintf(g->script, "%s'%d' %d", k ? ", " : "", study->ranks[k], study->ranks[k]);
    fputs(")\n", g->script);
}

bool schedule_picture(const struct schedule_study *study, const char *directory, const char *stem,
                      stance_message *message)
{
    const int width = LEFT + 2 * PANEL_WIDTH + GAP + LEGEND;
    const char *title = "A schedule, simulated";
    struct gnuplot g;
    char subtitle[400], name[32];
    double least = 100;

    snprintf(subtitle, sizeof subtitle,
             "%.3g cases of %.3g us on the mean, %zu bytes kept of each. A draw takes %.3g us at "
             "the counter, one after the other; all ranks together write %.3g times and %.3g GB a "
             "second. Start-up is not part of it.",
             (double)study->cases, 1e6 * study->case_time, study->row_size,
             1e6 * study->machine.service, study->machine.write_rate,
             1e-9 * study->machine.bandwidth);
    const int top = gnuplot_title_height(width, title, subtitle);
    if (!gnuplot_begin(&g, width, top + PANEL_HEIGHT + BOTTOM, message))
        return false;
    gnuplot_title(&g, title, subtitle);
    for (size_t i = 0; i < LOSSES; i++) {
        gnuplot_legend(&g, width - LEGEND + 24, top + 10 + 20 * (double)i, losses[i].colour,
                       losses[i].text);
    }
    gnuplot_decorate(&g);
    put_data(&g, study, name);
    for (size_t k = 0; k < study->count; k++)
        least = fmin(least, 100 * simulation_efficiency(&study->result[k], study->ranks[k]));
    gnuplot_panel(&g, LEFT, top, PANEL_WIDTH, PANEL_HEIGHT);
    put_ranks(&g, study);
    fprintf(g.script,
            "set yrange [%g:100.5]; set ylabel 'efficiency, %%' font ',10'\n"
            "plot 90 with lines lc rgb '#8a8a8a' dt 2 notitle, '%s' using 1:2 with linespoints lc "
            "rgb '#0072b2' lw 1.6 pt 7 ps 0.9 notitle\n",
            fmin(80, 10 * floor(least / 10)), name);
    gnuplot_panel(&g, LEFT + PANEL_WIDTH + GAP, top, PANEL_WIDTH, PANEL_HEIGHT);
    put_ranks(&g, study);
    fputs("set logscale y; set autoscale y; set format y '%g'\n"
          "set ylabel 'share of the time lost to it, %' font ',10'\nplot ",
          g.script);
    for (size_t i = 0; i < LOSSES; i++) {
        fprintf(g.script,
                "%s'%s' using 1:%zu with linespoints lc rgb '%s' lw 1.6 pt %d ps 0.9 notitle",
                i ? ", " : "", name, i + 3, losses[i].colour, losses[i].marker);
    }
    fputs("\n", g.script);
    return gnuplot_end(&g, directory, stem, message);
}
