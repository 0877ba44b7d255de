/* plot_failure.c - maps of where methods fail, one for each method, and of the energy they create.
 */
#include "failure.h"

#include "analysis/draw/plot.h"

#include <math.h>
#include <string.h>

static const double lowest_share = 1e-16, highest_share = 10;

/* What both pictures show: axes 1 and 2 of the file, the rows' names, and the line of theory. */
struct maps {
    struct gnuplot g;
    const struct failure *f;
    struct plot_axis across, up;
};

/* The line of theory, white under black. */
static void put_line(struct maps *maps)
{
    struct gnuplot *const g = &maps->g;
    const struct failure *f = maps->f;
    const struct plot_axis *along = f->line.axis == 1 ? &maps->across : &maps->up;
    const struct plot_axis *other = f->line.axis == 1 ? &maps->up : &maps->across;
    gnuplot_series(g, "using 1:2 with lines lc rgb 'white' lw 3.6 notitle, '' using 1:2 with lines "
                      "lc rgb 0x000000 lw 1.6");
    for (size_t i = 0; i < along->axis->count; i++) {
        const double here = plot_axis_place(along, i), value = f->line.value[i];
        const double there = other->scale == PLOT_LOG ? log10(value) : value;
        GNUPLOT_ROW(g, f->line.axis == 1 ? here : there, f->line.axis == 1 ? there : here);
    }
}

/* A map of each row: of codes, or without colours of numbers. */
static void put_maps(struct maps *maps, const void *values, const char *colours)
{
    struct gnuplot *const g = &maps->g;
    const struct failure *f = maps->f;
    struct plot_cells cells = {&maps->across, &maps->up, 0, {maps->up.axis->count, 1}};
    const struct plot_axis *const other = f->line.axis == 1 ? &maps->up : &maps->across;
    const bool theory = f->line.axis > 0 && other->scale != PLOT_LIST;
    char text[40];
    gnuplot_set(g, "columns = 3; chart_width = 300; scaled = 1; gridded = 0");
    plot_axis_write(&maps->across, g, 'x');
    plot_axis_write(&maps->up, g, 'y');
    for (size_t k = 0; k < f->rows; k++) {
        gnuplot_panel(g, 240, failure_row_name(&f->row[k], text));
        if (!colours) {
            snprintf(text, sizeof text, "%.2g", f->row[k].largest[FAILURE_SHARE]);
            gnuplot_text(g, text, "panel_right[panels]");
        }
        cells.first = k * f->cells;
        plot_cells_write(g, &cells, values, colours);
        if (theory)
            put_line(maps);
    }
    if (theory)
        gnuplot_legend(g, "0x000000", 1, 0, f->line.text, "");
}

/* ---- verdicts ----------------------------------------------------------------------------- */

/* "painleve 12 %\nevents 1 %": why cases of row k gave up, the two most frequent reasons. */
static void put_reasons(struct gnuplot *g, const struct failure *f, size_t k)
{
    uint64_t left[STANCE_FAILURE_COUNT];
    char text[2][64] = {"", ""};
    memcpy(left, f->row[k].reason, sizeof left);
    for (size_t line = 0; line < 2; line++) {
        int most = 0;
        for (int reason = 1; reason < STANCE_FAILURE_COUNT; reason++)
            most = left[reason] > left[most] ? reason : most;
        if (left[most] > 0)
            snprintf(text[line], sizeof text[line], "%s %.2g %%", stance_failure_name[most],
                     100 * (double)left[most] / (double)f->cells);
        left[most] = 0;
    }
    gnuplot_text(g, text[0], "cell_text[(legends - 1)*table_columns + %zu]", k + 1);
    gnuplot_text(g, text[1], "cell_more[(legends - 1)*table_columns + %zu]", k + 1);
}

/* Verdicts against methods: shares of the cells; the reasons in two lines. */
static void put_table(struct gnuplot *g, const struct failure *f)
{
    char text[64];
    gnuplot_set(g, "table_top = 44; table_columns = %zu; array table_head[%zu]", f->rows, f->rows);
    gnuplot_arrays(g, (FAILURE_VERDICT_COUNT + 2) * f->rows, "cell_text cell_more");
    gnuplot_set(g, "do for [k=1:|cell_text|] { cell_text[k] = ''; cell_more[k] = '' }");
    gnuplot_arrays(g, FAILURE_VERDICT_COUNT, "verdict_colour");
    for (size_t k = 0; k < f->rows; k++)
        gnuplot_text(g, failure_row_name(&f->row[k], text), "table_head[%zu]", k + 1);
    for (enum failure_verdict v = 0; v < FAILURE_VERDICT_COUNT; v++) {
        snprintf(text, sizeof text, "0x%s", failure_styles[v].colour + 1);
        gnuplot_set(g, "verdict_colour[%d] = %s", v + 1, text);
        uint64_t cells = 0;
        for (size_t k = 0; k < f->rows; k++)
            cells += f->row[k].count[v];
        if (cells == 0)
            continue;
        gnuplot_legend(g, text, 0, 0, failure_styles[v].text, "");
        for (size_t k = 0; k < f->rows; k++) {
            const double share = 100 * (double)f->row[k].count[v] / (double)f->cells;
            snprintf(text, sizeof text,
                     share == 0  ? "-"
                     : share < 1 ? "%.2g %%"
                                 : "%.1f %%",
                     share);
            gnuplot_text(g, text, "cell_text[(legends - 1)*table_columns + %zu]", k + 1);
        }
    }
    gnuplot_legend(g, "0xffffff", 0, -1, "reasons of failures", "");
    for (size_t k = 0; k < f->rows; k++)
        put_reasons(g, f, k);
    gnuplot_about(g, "%s", "");
}

static bool draw_verdicts(struct maps *maps, const struct plot *plot)
{
    const struct failure *f = maps->f;
    const bool step = strcmp(maps->across.axis->name, "method.step") == 0 ||
                      strcmp(maps->up.axis->name, "method.step") == 0;
    if (!gnuplot_begin(&maps->g, plot, ""))
        return false;
    gnuplot_say(&maps->g,
                "%zu cases per map, each with the worst verdict that applies. Reference: "
                "event-driven%s; where that gave up, capturing. Inaccurate: a coordinate is off by "
                "more than %g m or rad at the end.",
                f->cells, step ? " at the smallest step" : "", FAILURE_POSITION);
    put_table(&maps->g, f);
    put_maps(maps, f->verdict, "verdict_colour");
    return gnuplot_end(&maps->g);
}

/* ---- energy -------------------------------------------------------------------------------- */

static bool draw_energy(struct maps *maps, const struct plot *plot)
{
    const struct failure *f = maps->f;
    struct gnuplot *const g = &maps->g;
    if (!gnuplot_begin(g, plot, "energy"))
        return false;
    gnuplot_say(g, "Energy that the method created: the largest rise above the energy at the start "
                   "and the work done since, as a share of the energy at the start. Less than "
                   "1e-16 is drawn as 1e-16.");
    double *const power = gnuplot_room(g, f->rows * f->cells, sizeof *power);
    for (size_t i = 0; power && i < f->rows * f->cells; i++)
        power[i] =
            isnan(f->share[i]) ? NAN : log10(fmin(fmax(f->share[i], lowest_share), highest_share));
    gnuplot_legend(g, "0xffffff", 0, 0, "failed", "");
    gnuplot_note(g, "over each map: the largest share");
    gnuplot_set(g, "bars = 1; bar_low = %#.10g; bar_high = %#.10g; bar_format = '1e%%g'",
                log10(lowest_share), log10(highest_share));
    if (power)
        put_maps(maps, power, NULL);
    return gnuplot_end(g);
}

bool failure_plot(const struct failure *f, const struct plot *plot)
{
    struct maps maps = {.f = f};
    /* Steps that divide a time evenly are a ladder but for rounding. */
    plot_axis_make_ladder(&maps.across, &plot->r->axis[1], 1.0 / 3);
    plot_axis_make_ladder(&maps.up, &plot->r->axis[2], 1.0 / 3);
    return draw_verdicts(&maps, plot) && draw_energy(&maps, plot);
}
