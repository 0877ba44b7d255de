/* plot_failure.c - maps of where methods fail, one for each method, and of the energy they create.
 */
#include "failure.h"

#include "analysis/draw/plot.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
    LEFT = 122,
    RIGHT = 24,
    PANEL_TITLE = 24,
    GAP = 46,
    AXIS = 76,
    LINE = 22,
    MOST_COLUMNS = 3,
    NAMES = 264, /* of the table under the maps */
    COLUMN = 152,
    COLOUR_BAR = 40,
};

static const double lowest_share = 1e-16, highest_share = 10;

struct layout {
    struct plot_axis across, up; /* axes 1 and 2 of the file */
    int panels, columns, rows;
    double width, height; /* of a panel, px */
    int canvas_width;
};

/* Steps that divide a time evenly are a ladder but for rounding: such an axis counts as even when
 * no value is further than a third of a cell from where it is drawn. */
static void make_axis(struct plot_axis *along, const struct results_axis *axis)
{
    plot_axis_make(along, axis);
    if (along->scale != PLOT_LIST || axis->word || axis->count < 3 || !(axis->value[0] > 0) ||
        !(axis->value[axis->count - 1] > 0))
        return;
    const size_t n = axis->count;
    const double first = log10(axis->value[0]), last = log10(axis->value[n - 1]);
    const double step = (last - first) / (double)(n - 1);
    for (size_t i = 0; i < n; i++)
        if (!(axis->value[i] > 0) ||
            !(fabs(log10(axis->value[i]) - first - (double)i * step) < fabs(step) / 3))
            return;
    along->scale = PLOT_LOG;
    along->falling = last < first;
    along->first = fmin(first, last);
    along->step = fabs(step);
    along->low = along->first - 0.5 * along->step;
    along->high = along->first + ((double)n - 0.5) * along->step;
}

static void arrange(struct layout *layout, const struct failure *f, const struct results *r)
{
    make_axis(&layout->across, &r->axis[1]);
    make_axis(&layout->up, &r->axis[2]);
    layout->panels = (int)f->rows;
    layout->columns = layout->panels < MOST_COLUMNS ? layout->panels : MOST_COLUMNS;
    layout->rows = (layout->panels + layout->columns - 1) / layout->columns;
    layout->width = 300;
    layout->height = 240;
    const int maps = LEFT + (int)(layout->columns * (layout->width + GAP)) - GAP + RIGHT;
    const int table = LEFT + NAMES + layout->panels * COLUMN + RIGHT;
    layout->canvas_width = maps > table ? maps : table;
}

static double panels_height(const struct layout *layout)
{
    return layout->rows * (layout->height + PANEL_TITLE + 14) + AXIS;
}

static void row_name(const struct failure_row *row, char *text, size_t size)
{
    if (isnan(row->tolerance))
        snprintf(text, size, "%s", row->method->name);
    else
        snprintf(text, size, "%s %.0e", row->method->name, row->tolerance);
}

static void panel_place(const struct layout *layout, int panel, double top, double *x, double *y)
{
    const int row = panel / layout->columns, column = panel % layout->columns;
    *x = LEFT + column * (layout->width + GAP);
    *y = top + row * (layout->height + PANEL_TITLE + 14) + PANEL_TITLE;
}

/* Is nothing below a panel? */
static bool is_lowest(const struct layout *layout, int panel)
{
    return panel + layout->columns >= layout->panels;
}

/* Titles of the panels and labels of the axes, which stand left of and below all panels. */
static void put_labels(struct gnuplot *g, const struct failure *f, const struct layout *layout,
                       double top)
{
    char text[64];
    double x, y;
    for (int p = 0; p < layout->panels; p++) {
        row_name(&f->row[p], text, sizeof text);
        panel_place(layout, p, top, &x, &y);
        gnuplot_label(g, x + layout->width / 2, y - 11, text, "center", 12, false);
    }
    const double height = panels_height(layout) - AXIS;
    const double width = layout->columns * (layout->width + GAP) - GAP;
    plot_axis_label(layout->across.axis, g, LEFT + width / 2, top + height + 40, width, false);
    plot_axis_label(layout->up.axis, g, 18, top + height / 2, height, true);
}

static void begin_panel(struct gnuplot *g, const struct layout *layout, int panel, double top)
{
    double x, y;
    panel_place(layout, panel, top, &x, &y);
    gnuplot_panel(g, x, y, layout->width, layout->height);
    plot_axis_tics(&layout->across, g->script, 'x', (int)(layout->width / 60),
                   is_lowest(layout, panel));
    plot_axis_tics(&layout->up, g->script, 'y', (int)(layout->height / 34),
                   panel % layout->columns == 0);
}

/* Name of a file with the cells of a map, row by row from below: colours or (share) numbers. */
static void put_cells(struct gnuplot *g, const struct failure *f, const struct layout *layout,
                      int panel, bool share, char name[32])
{
    FILE *data = gnuplot_data(g, name);
    const size_t nx = layout->across.axis->count, ny = layout->up.axis->count;
    for (size_t j = 0; j < ny; j++) {
        for (size_t i = 0; i < nx; i++) {
            const size_t cell =
                plot_axis_index(&layout->across, i) * ny + plot_axis_index(&layout->up, j);
            const size_t index = (size_t)panel * f->cells + cell;
            if (share) {
                const double value =
                    log10(fmin(fmax(f->share[index], lowest_share), highest_share));
                const double shown = isnan(f->share[index]) ? NAN : value;
                fwrite(&shown, sizeof shown, 1, data);
                continue;
            }
            const unsigned colour =
                (unsigned)strtoul(failure_styles[f->verdict[index]].colour + 1, NULL, 16);
            putc((int)(colour >> 16 & 0xff), data);
            putc((int)(colour >> 8 & 0xff), data);
            putc((int)(colour & 0xff), data);
        }
    }
    gnuplot_close_data(g, data);
    fprintf(g->script, "'%s' binary array=(%zu,%zu) dx=%.17g dy=%.17g origin=(%.17g,%.17g)", name,
            nx, ny, layout->across.step, layout->up.step,
            layout->across.low + 0.5 * layout->across.step, layout->up.low + 0.5 * layout->up.step);
}

/* Place of a value that need not be one of the axis; NAN: it has none. */
static double place_of(const struct plot_axis *along, double value)
{
    return along->scale == PLOT_LOG ? log10(value) : along->scale == PLOT_LINEAR ? value : NAN;
}

/* The line of theory: white under black. */
static bool has_line(const struct failure *f, const struct layout *layout)
{
    const struct plot_axis *other = f->line.axis == 1 ? &layout->up : &layout->across;
    return f->line.axis > 0 && other->scale != PLOT_LIST;
}

static void put_line(struct gnuplot *g, const struct failure *f, const struct layout *layout)
{
    char name[32];
    if (!has_line(f, layout))
        return;
    FILE *data = gnuplot_data(g, name);
    const struct plot_axis *along = f->line.axis == 1 ? &layout->across : &layout->up;
    const struct plot_axis *other = f->line.axis == 1 ? &layout->up : &layout->across;
    for (size_t i = 0; i < along->axis->count; i++) {
        const double here = plot_axis_place(along, i), there = place_of(other, f->line.value[i]);
        if (!isfinite(there)) {
            fputs("\n", data); /* a gap */
            continue;
        }
        gnuplot_number(data, f->line.axis == 1 ? here : there);
        putc(' ', data);
        gnuplot_number(data, f->line.axis == 1 ? there : here);
        putc('\n', data);
    }
    gnuplot_close_data(g, data);
    fprintf(g->script,
            ", '%s' using 1:2 with lines lc rgb '#ffffff' lw 3.6 notitle"
            ", '%s' using 1:2 with lines lc rgb '#000000' lw 1.6 notitle",
            name, name);
}

/* A sample of the line with its name, at a place of the canvas. */
static void put_line_legend(struct gnuplot *g, const struct failure *f, double x, double y)
{
    fprintf(g->script,
            "set arrow from screen %.6f,%.6f to screen %.6f,%.6f nohead lw 1.6 lc rgb '#000000' "
            "front\n",
            x / g->width, 1 - y / g->height, (x + 15) / g->width, 1 - y / g->height);
    gnuplot_label(g, x + 22, y, f->line.text, "left", 12, false);
}

/* ---- verdicts ----------------------------------------------------------------------------- */

static bool occurs(const struct failure *f, enum failure_verdict verdict)
{
    for (size_t k = 0; k < f->rows; k++)
        if (f->row[k].count[verdict] > 0)
            return true;
    return false;
}

static int table_rows(const struct failure *f)
{
    int rows = 2; /* the heads, and the reasons */
    for (enum failure_verdict v = 0; v < FAILURE_VERDICT_COUNT; v++)
        rows += occurs(f, v);
    return rows + (f->line.axis > 0);
}

/* "painleve 12 %, events 1 %": why cases gave up, the two most frequent reasons. */
static void reasons_text(const struct failure_row *row, uint64_t cells, char text[2][32])
{
    uint64_t last = UINT64_MAX;
    int previous = -1;
    text[0][0] = text[1][0] = '\0';
    for (int line = 0; line < 2; line++) {
        int best = -1;
        for (int k = 0; k < STANCE_FAILURE_COUNT; k++) {
            const bool below = row->reason[k] < last || (row->reason[k] == last && k > previous);
            if (below && row->reason[k] > 0 && (best < 0 || row->reason[k] > row->reason[best]))
                best = k;
        }
        if (best < 0)
            return;
        snprintf(text[line], sizeof text[line], "%s %.2g %%", stance_failure_name[best],
                 100 * (double)row->reason[best] / (double)cells);
        last = row->reason[best];
        previous = best;
    }
}

/* Verdicts against methods: shares of the cells. */
static void put_table(struct gnuplot *g, const struct failure *f, double y)
{
    char text[64];
    for (size_t k = 0; k < f->rows; k++) {
        row_name(&f->row[k], text, sizeof text);
        gnuplot_label(g, LEFT + NAMES + (double)k * COLUMN, y, text, "left", 11, false);
    }
    y += LINE;
    for (enum failure_verdict v = 0; v < FAILURE_VERDICT_COUNT; v++) {
        if (!occurs(f, v))
            continue;
        gnuplot_legend(g, LEFT, y, failure_styles[v].colour, failure_styles[v].text);
        for (size_t k = 0; k < f->rows; k++) {
            const double share = 100 * (double)f->row[k].count[v] / (double)f->cells;
            snprintf(text, sizeof text,
                     share == 0  ? "-"
                     : share < 1 ? "%.2g %%"
                                 : "%.1f %%",
                     share);
            gnuplot_label(g, LEFT + NAMES + (double)k * COLUMN, y, text, "left", 11, false);
        }
        y += LINE;
    }
    gnuplot_label(g, LEFT + 22, y, "reasons of failures", "left", 11, false);
    for (size_t k = 0; k < f->rows; k++) {
        char reasons[2][32];
        reasons_text(&f->row[k], f->cells, reasons);
        for (int line = 0; line < 2; line++) {
            gnuplot_label(g, LEFT + NAMES + (double)k * COLUMN, y + 15 * line, reasons[line],
                          "left", 10, false);
        }
    }
    if (f->line.axis > 0)
        put_line_legend(g, f, LEFT, y + LINE + 14);
}

static bool draw_verdicts(const struct failure *f, const struct results *r,
                          const struct layout *layout, const char *directory, const char *stem,
                          stance_message *message)
{
    struct gnuplot g;
    char subtitle[400], name[32];
    const bool step =
        strcmp(r->axis[1].name, "method.step") == 0 || strcmp(r->axis[2].name, "method.step") == 0;
    snprintf(subtitle, sizeof subtitle,
             "%zu cases per map, each with the worst verdict that applies. Reference: "
             "event-driven%s; where that gave up, capturing. Inaccurate: a coordinate is off by "
             "more than %g m or rad at the end.",
             f->cells, step ? " at the smallest step" : "", FAILURE_POSITION);
    const int top = gnuplot_title_height(layout->canvas_width, r->title, subtitle);
    const double table = top + panels_height(layout) + 6;
    if (!gnuplot_begin(&g, layout->canvas_width, (int)table + (table_rows(f) + 1) * LINE + 14,
                       message))
        return false;
    gnuplot_title(&g, r->title, subtitle);
    put_labels(&g, f, layout, top);
    put_table(&g, f, table);
    gnuplot_decorate(&g);
    for (int p = 0; p < layout->panels; p++) {
        begin_panel(&g, layout, p, top);
        fputs("plot ", g.script);
        put_cells(&g, f, layout, p, false, name);
        fputs(" format='%uchar%uchar%uchar' using 1:2:3 with rgbimage notitle", g.script);
        put_line(&g, f, layout);
        fputc('\n', g.script);
    }
    return gnuplot_end(&g, directory, stem, message);
}

/* ---- energy -------------------------------------------------------------------------------- */

static void put_palette(struct gnuplot *g, double y)
{
    /* After cividis (Nunez, Anderton, Renslow 2018): even steps for every reader. */
    fprintf(g->script,
            "set palette defined (0 '#00224e', 0.25 '#434e6c', 0.5 '#7d7c78', 0.75 '#bcae6c',"
            " 1 '#fee838')\n"
            "set cbrange [%g:%g]\nset colorbox horizontal user origin screen %.6f, screen %.6f "
            "size screen %.6f, screen %.6f\n"
            "set cbtics (",
            log10(lowest_share), log10(highest_share), (double)LEFT / g->width,
            1 - (y + 14) / g->height, 420.0 / g->width, 14.0 / g->height);
    for (int power = -16; power <= 0; power += 4)
        fprintf(g->script, "%s'%g' %d", power > -16 ? ", " : "", pow(10, power), power);
    fputs(") nomirror out scale 0.5\n", g->script);
}

static bool draw_energy(const struct failure *f, const struct results *r,
                        const struct layout *layout, const char *directory, const char *stem,
                        stance_message *message)
{
    struct gnuplot g;
    char name[32], path[300], text[64];
    static const char subtitle[] =
        "Energy that the method created: the largest rise above the energy at the start and the "
        "work done since, as a share of the energy at the start. Less than 1e-16 is drawn as "
        "1e-16.";
    const int top = gnuplot_title_height(layout->canvas_width, r->title, subtitle);
    const double bar = top + panels_height(layout) + 6;
    if (!gnuplot_begin(&g, layout->canvas_width, (int)bar + COLOUR_BAR + 3 * LINE + 10, message))
        return false;
    gnuplot_title(&g, r->title, subtitle);
    put_labels(&g, f, layout, top);
    gnuplot_legend(&g, LEFT + 450, bar + 8, "#ffffff", "failed");
    if (has_line(f, layout))
        put_line_legend(&g, f, LEFT + 540, bar + 8);
    gnuplot_label(&g, LEFT, bar + COLOUR_BAR + LINE, "largest share of a map:", "left", 11, false);
    for (size_t k = 0; k < f->rows; k++) {
        row_name(&f->row[k], text, sizeof text);
        gnuplot_label(&g, LEFT + NAMES + (double)k * COLUMN, bar + COLOUR_BAR + LINE, text, "left",
                      11, false);
        snprintf(text, sizeof text, "%.2g", f->row[k].energy_share);
        gnuplot_label(&g, LEFT + NAMES + (double)k * COLUMN, bar + COLOUR_BAR + 2 * LINE, text,
                      "left", 11, false);
    }
    gnuplot_decorate(&g);
    put_palette(&g, bar);
    for (int p = 0; p < layout->panels; p++) {
        begin_panel(&g, layout, p, top);
        fputs("plot ", g.script);
        put_cells(&g, f, layout, p, true, name);
        fputs(" format='%float64' with image notitle", g.script);
        put_line(&g, f, layout);
        fputs("\nunset colorbox\n", g.script); /* one for all */
    }
    snprintf(path, sizeof path, "%s-energy", stem);
    return gnuplot_end(&g, directory, path, message);
}

bool failure_plot(const struct failure *f, const struct results *r, const char *directory,
                  const char *stem, stance_message *message)
{
    struct layout layout;
    arrange(&layout, f, r);
    return draw_verdicts(f, r, &layout, directory, stem, message) &&
           draw_energy(f, r, &layout, directory, stem, message);
}
