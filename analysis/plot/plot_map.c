/* plot_map.c - maps of a sweep over two axes or more: what became of every case, a cell each, and
 * when it settled. Further axes become panels. */
#include "analysis/draw/plot.h"
#include "analysis/statistics/statistics.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MAX_PANELS = 16, LEFT = 118, BOTTOM = 84, LEGEND = 190, GAP = 28, PANEL_TITLE = 22 };

/* How the titles of panels name their axes. */
enum naming {
    NAMES,      /* "proportional.x = 25" */
    LAST_WORDS, /* "x = 25" */
    VALUES_ALONE,
};

/* Which axes are drawn, and which of the points of the others. */
struct layout {
    int x, y; /* axes of the map */
    struct plot_axis across, up;
    int others, other[SCENARIO_MAX_AXES]; /* axes of the panels */
    size_t shown[SCENARIO_MAX_AXES];      /* how many of their points */
    int panels, columns, rows;
    double width, height;   /* of a panel, px */
    int left, canvas_width; /* px; left of the panels: labels of the axis */
    enum naming naming;
};

/* ---- what is drawn ------------------------------------------------------------------------ */

/* The last two axes of numbers make the map; where there are fewer, axes of words join them. Words
 * beside numbers stand at the left, where each has a line. */
static void choose_axes(const struct results *r, struct layout *layout)
{
    int chosen[2] = {0, 0}, count = 0;
    for (int words = 0; words < 2 && count < 2; words++) {
        for (int a = r->axes - 1; a >= 0 && count < 2; a--)
            if ((r->axis[a].word != NULL) == (words == 1))
                chosen[count++] = a;
    }
    layout->x = chosen[0] < chosen[1] ? chosen[0] : chosen[1];
    layout->y = chosen[0] < chosen[1] ? chosen[1] : chosen[0];
    if (r->axis[layout->x].word && !r->axis[layout->y].word) {
        int words = layout->x;
        layout->x = layout->y;
        layout->y = words;
    }
    plot_axis_make(&layout->across, &r->axis[layout->x]);
    plot_axis_make(&layout->up, &r->axis[layout->y]);
}

static void choose_panels(const struct results *r, struct layout *layout)
{
    layout->panels = 1;
    layout->others = 0;
    double product = 1;
    for (int a = 0; a < r->axes; a++) {
        if (a != layout->x && a != layout->y) {
            layout->shown[layout->others] = r->axis[a].count;
            product *= (double)r->axis[a].count;
            layout->other[layout->others++] = a;
        }
    }
    /* Too many: the longest axis shows fewer of its points, until all fit. */
    while (product > MAX_PANELS) {
        int longest = 0;
        for (int k = 1; k < layout->others; k++)
            longest = layout->shown[k] > layout->shown[longest] ? k : longest;
        size_t *shown = &layout->shown[longest];
        product /= (double)*shown;
        *shown = *shown > 2 * MAX_PANELS ? 2 * MAX_PANELS : *shown - 1;
        product *= (double)*shown;
    }
    for (int k = 0; k < layout->others; k++)
        layout->panels *= (int)layout->shown[k];
}

/* Index of the m-th shown point of an axis of the panels, both ends included. */
static size_t shown_point(const struct results *r, const struct layout *layout, int k, size_t m)
{
    size_t count = r->axis[layout->other[k]].count, shown = layout->shown[k];
    return shown < 2 ? (count - 1) / 2 : m * (count - 1) / (shown - 1);
}

/* Coordinates of a panel, 0 along the axes of the map. */
static void panel_point(const struct results *r, const struct layout *layout, int panel,
                        size_t *point)
{
    memset(point, 0, SCENARIO_MAX_AXES * sizeof *point);
    size_t rest = (size_t)panel;
    for (int k = layout->others - 1; k >= 0; k--) {
        point[layout->other[k]] = shown_point(r, layout, k, rest % layout->shown[k]);
        rest /= layout->shown[k];
    }
}

static void say_what_is_shown(const struct results *r, const struct layout *layout)
{
    char text[128];
    for (int k = 0; k < layout->others; k++) {
        const struct results_axis *axis = &r->axis[layout->other[k]];
        if (layout->shown[k] == axis->count)
            continue;
        fprintf(stderr, "the maps show %zu of %zu values of %s:", layout->shown[k], axis->count,
                axis->name);
        for (size_t m = 0; m < layout->shown[k]; m++) {
            results_value_text(axis, shown_point(r, layout, k, m), false, text, sizeof text);
            fprintf(stderr, " %s", text);
        }
        fputc('\n', stderr);
    }
}

/* What the words of an axis take to the left of it beyond what numbers take, px. */
static int word_room(const struct results_axis *axis)
{
    enum { LETTER = 9, LETTERS = 6 };
    size_t longest = LETTERS;
    for (size_t i = 0; axis->word && i < axis->count; i++) {
        size_t length = strlen(axis->word[i]);
        longest = length > longest ? length : longest;
    }
    return LETTER * (int)(longest < 24 ? longest - LETTERS : 24 - LETTERS);
}

static void arrange(struct layout *layout)
{
    /* Two axes make a table; else the page is a little wider than it is high, and full where it
     * can be. */
    int columns = layout->panels == 3 ? 3 : (int)ceil(sqrt(1.2 * layout->panels));
    if (columns > 2 && layout->panels % columns != 0 && layout->panels % (columns - 1) == 0)
        columns--;
    layout->columns =
        layout->others == 2 && layout->shown[1] <= 6 ? (int)layout->shown[1] : columns;
    if (layout->columns > layout->panels)
        layout->columns = layout->panels;
    layout->rows = (layout->panels + layout->columns - 1) / layout->columns;
    layout->left = LEFT + word_room(layout->up.axis);
    double scale = layout->panels == 1 ? 1 : layout->panels <= 4 ? 0.6 : 0.42;
    layout->width = 560 * scale;
    layout->height = 500 * scale;
    layout->canvas_width = layout->left + (int)(layout->columns * (layout->width + GAP)) + LEGEND;
}

static void panel_place(const struct layout *layout, int panel, double top, double *x, double *y)
{
    *x = layout->left + panel % layout->columns * (layout->width + GAP);
    const int row = panel / layout->columns;
    *y = top + row * (layout->height + PANEL_TITLE + 12) + (layout->panels > 1 ? PANEL_TITLE : 0);
}

/* ---- data --------------------------------------------------------------------------------- */

static uint64_t flat_index(const struct results *r, const size_t *point)
{
    uint64_t index = 0;
    for (int a = 0; a < r->axes; a++)
        index = index * r->axis[a].count + point[a];
    return index;
}

/* What one cell writes into a file. */
typedef void (*cell_function)(FILE *out, const struct results *r, const double *values,
                              uint64_t index);

static void put_outcome(FILE *out, const struct results *r, const double *values, uint64_t index)
{
    unsigned colour = (unsigned)strtoul(plot_colours[r->kind[index]] + 1, NULL, 16);
    (void)values;
    putc((int)(colour >> 16 & 0xff), out);
    putc((int)(colour >> 8 & 0xff), out);
    putc((int)(colour & 0xff), out);
}

static void put_value(FILE *out, const struct results *r, const double *values, uint64_t index)
{
    (void)r;
    fwrite(&values[index], sizeof values[index], 1, out);
}

/* Writes the cells of a panel row by row from below, and the words that make gnuplot read them.
 * gnuplot takes no image of one column or row: such a one is written twice, half as wide. */
static void put_image(struct gnuplot *g, const struct plot *plot, const struct layout *layout,
                      int panel, const double *values, cell_function put, const char *reading)
{
    const struct plot_axis *across = &layout->across, *up = &layout->up;
    size_t nx = across->axis->count, ny = up->axis->count, point[SCENARIO_MAX_AXES];
    size_t twice_x = nx == 1 ? 2 : 1, twice_y = ny == 1 ? 2 : 1;
    char name[32];

    panel_point(plot->r, layout, panel, point);
    FILE *data = gnuplot_data(g, name);
    for (size_t j = 0; j < ny * twice_y; j++) {
        point[layout->y] = plot_axis_index(up, j / twice_y);
        for (size_t i = 0; i < nx * twice_x; i++) {
            point[layout->x] = plot_axis_index(across, i / twice_x);
            put(data, plot->r, values, flat_index(plot->r, point));
        }
    }
    gnuplot_close_data(g, data);
    double dx = across->step / (double)twice_x, dy = up->step / (double)twice_y;
    fprintf(g->script,
            "'%s' binary array=(%zu,%zu) dx=%.17g dy=%.17g origin=(%.17g,%.17g) %s notitle", name,
            nx * twice_x, ny * twice_y, dx, dy, across->low + 0.5 * dx, up->low + 0.5 * dy,
            reading);
}

/* ---- a page ------------------------------------------------------------------------------- */

/* Place of zero on an axis of offsets; false when it is not on the map. */
static bool zero_place(const struct plot_axis *along, double *place)
{
    if (!along->axis->offset || along->scale == PLOT_LOG)
        return false;
    if (along->scale == PLOT_LINEAR) {
        *place = 0;
        return along->low < 0 && along->high > 0;
    }
    size_t nearest = statistics_nearest_zero(along->axis);
    *place = (double)nearest;
    return !along->axis->word && along->axis->value[nearest] == 0;
}

static void put_cross(struct gnuplot *g, const struct layout *layout)
{
    double x, y;
    if (zero_place(&layout->across, &x) && zero_place(&layout->up, &y)) {
        fprintf(g->script,
                "set label 1 '' at %.17g,%.17g point pt 1 ps 1.6 lw 4.5 lc rgb '#ffffff' front\n"
                "set label 2 '' at %.17g,%.17g point pt 1 ps 1.4 lw 2 lc rgb '#000000' front\n",
                x, y, x, y);
    }
}

/* A path as the titles of panels have it. */
static const char *short_name(const char *path, enum naming naming)
{
    const char *dot = naming == NAMES ? strchr(path, '.') : strrchr(path, '.');
    return dot ? dot + 1 : path;
}

/* "friction = 0.25, noise = 0.1": the page's subtitle has the whole paths in the same order.
 * Returns its length. */
static size_t panel_title(const struct results *r, const struct layout *layout, int panel,
                          char *text, size_t size)
{
    size_t point[SCENARIO_MAX_AXES], used = 0;
    char value[96];
    bool names = layout->naming != VALUES_ALONE;
    panel_point(r, layout, panel, point);
    text[0] = '\0';
    for (int k = 0; k < layout->others && used < size; k++) {
        const struct results_axis *axis = &r->axis[layout->other[k]];
        results_value_text(axis, point[layout->other[k]], true, value, sizeof value);
        used += (size_t)snprintf(text + used, size - used, "%s%s%s%s", k ? ", " : "",
                                 names ? short_name(axis->name, layout->naming) : "",
                                 names ? " = " : "", value);
    }
    return used;
}

/* The longest names for which the titles of all panels have room. */
static void choose_naming(const struct results *r, struct layout *layout)
{
    enum { LETTER = 7 }; /* px, on average */
    char text[1024];
    for (layout->naming = NAMES; layout->naming < VALUES_ALONE; layout->naming++) {
        bool fits = true;
        for (int p = 0; p < layout->panels && fits; p++) {
            fits = LETTER * (double)panel_title(r, layout, p, text, sizeof text) <
                   layout->width + GAP / 2.0;
        }
        if (fits)
            return;
    }
}

static void begin_panel(struct gnuplot *g, const struct layout *layout, int panel, double top)
{
    double x, y;
    bool lowest = panel + layout->columns >= layout->panels;
    panel_place(layout, panel, top, &x, &y);
    gnuplot_panel(g, x, y, layout->width, layout->height);
    plot_axis_tics(&layout->across, g->script, 'x', (int)(layout->width / 65), lowest);
    plot_axis_tics(&layout->up, g->script, 'y', (int)(layout->height / 40),
                   panel % layout->columns == 0);
    put_cross(g, layout);
    fputs("plot ", g->script);
}

static void subtitle_of(const struct results *r, const struct layout *layout, const char *what,
                        char *text, size_t size)
{
    size_t used = (size_t)snprintf(text, size, "%s", what);
    for (int k = 0; k < layout->others && used < size; k++) {
        const struct results_axis *axis = &r->axis[layout->other[k]];
        used += (size_t)snprintf(text + used, size - used, "%s%s%s%s%s",
                                 k ? ", " : "; one panel per ", axis->name,
                                 axis->text[0] ? " (" : "", axis->text, axis->text[0] ? ")" : "");
    }
}

/* Begins a page: title, axis labels, panel titles; *top is where the panels begin. */
static bool begin_page(struct gnuplot *g, const struct plot *plot, const struct layout *layout,
                       const char *what, double *top, stance_message *message)
{
    const struct results *r = plot->r;
    const char *title = r->title[0] ? r->title : r->name;
    char text[1024];
    double x, y;

    subtitle_of(r, layout, what, text, sizeof text);
    *top = gnuplot_title_height(layout->canvas_width, title, text);
    double inner_width = layout->columns * (layout->width + GAP) - GAP;
    panel_place(layout, layout->panels - 1, *top, &x, &y);
    double bottom = y + layout->height;
    if (!gnuplot_begin(g, layout->canvas_width, (int)bottom + BOTTOM, message))
        return false;
    gnuplot_title(g, title, text);
    plot_axis_label(layout->across.axis, g, layout->left + inner_width / 2, bottom + 46,
                    inner_width + 80, false);
    /* Long names may go on beside the labels under the map, but not into the title. */
    plot_axis_label(layout->up.axis, g, 22, 0.5 * (*top + bottom) + 14, bottom - *top + 28, true);
    for (int p = 0; p < layout->panels && layout->panels > 1; p++) {
        panel_title(r, layout, p, text, sizeof text);
        panel_place(layout, p, *top, &x, &y);
        gnuplot_label(g, x + layout->width / 2, y - 11, text, "center", 10, false);
    }
    return true;
}

static double legend_left(const struct layout *layout)
{
    return layout->left + layout->columns * (layout->width + GAP) + 8;
}

static double legend_top(const struct layout *layout, double top)
{
    return top + (layout->panels > 1 ? PANEL_TITLE : 0) + 10;
}

/* The entry of the cross in a legend. */
static void legend_cross(struct gnuplot *g, const struct layout *layout, double y)
{
    double place, x = legend_left(layout);
    if (zero_place(&layout->across, &place) && zero_place(&layout->up, &place)) {
        fprintf(g->script,
                "set label '' at screen %.6f,%.6f point pt 1 ps 1.4 lw 2 lc rgb '#000000'\n",
                (x + 7) / g->width, 1 - y / g->height);
        gnuplot_label(g, x + 22, y, "equilibrium", "left", 12, false);
    }
}

static bool draw_outcomes(const struct plot *plot, const struct layout *layout,
                          stance_message *message)
{
    struct gnuplot g;
    double top;
    char what[160], stem[512];
    uint64_t inferred;
    if (!statistics_inferred(plot->r, &inferred, NULL, message))
        return false;
    int used = snprintf(what, sizeof what, "What became of each of %llu cases",
                        (unsigned long long)plot->r->cases);
    if (inferred > 0) {
        snprintf(what + used, sizeof what - (size_t)used,
                 "; %llu of them inferred from neighbours that agree",
                 (unsigned long long)inferred);
    }
    if (!begin_page(&g, plot, layout, what, &top, message))
        return false;
    double y = legend_top(layout, top);
    y += plot_kind_legend(plot, &g, legend_left(layout), y);
    legend_cross(&g, layout, y);
    gnuplot_decorate(&g);
    for (int p = 0; p < layout->panels; p++) {
        begin_panel(&g, layout, p, top);
        put_image(&g, plot, layout, p, NULL, put_outcome,
                  "format='%uchar%uchar%uchar' using 1:2:3 with rgbimage");
        fputc('\n', g.script);
    }
    snprintf(stem, sizeof stem, "%s-map", plot->stem);
    return gnuplot_end(&g, plot->directory, stem, message);
}

/* ---- an answer ---------------------------------------------------------------------------- */

/* A picture of the numbers of one answer. */
struct measure {
    const char *name, *unit, *what; /* what: the page's subtitle */
    const char *none;               /* the legend of cells without a number */
    double *values, low, high;
};

/* Leaves the times of cases that settled; their range. False: there are none. */
static bool settle_range(const struct results *r, struct measure *m)
{
    m->low = INFINITY;
    m->high = -INFINITY;
    for (uint64_t i = 0; i < r->cases; i++) {
        bool settled = r->kind[i] == RESULTS_STABILISED || r->kind[i] == RESULTS_RESTED;
        if (!settled || !isfinite(m->values[i])) {
            m->values[i] = NAN;
            continue;
        }
        m->low = fmin(m->low, m->values[i]);
        m->high = fmax(m->high, m->values[i]);
    }
    return m->low <= m->high;
}

/* Palette and colour bar; for the first panel. */
static void put_palette(struct gnuplot *g, const struct layout *layout, double top,
                        const struct measure *m)
{
    double x = legend_left(layout), y = legend_top(layout, top), low = m->low, high = m->high;
    if (!(high > low)) { /* a range of nothing cannot be drawn */
        high = low + 0.5;
        low = low - 0.5;
    }
    /* After cividis (Nunez, Anderton, Renslow 2018): even steps for every reader. */
    fprintf(g->script,
            "set palette defined (0 '#00224e', 0.25 '#434e6c', 0.5 '#7d7c78', 0.75 '#bcae6c',"
            " 1 '#fee838')\n"
            "set cbrange [%.10g:%.10g]\nset cbtics %.10g nomirror out scale 0\n"
            "set cblabel '%s%s%s%s' offset 0.5,0\n"
            "set colorbox user origin screen %.6f, screen %.6f size screen %.6f, screen %.6f\n",
            low, high, plot_round_step(low, high, 6), m->name, m->unit[0] ? " (" : "", m->unit,
            m->unit[0] ? ")" : "", x / g->width, 1 - (y + 70 + 180) / g->height, 18.0 / g->width,
            180.0 / g->height);
}

static bool draw_measure(const struct plot *plot, const struct layout *layout,
                         const struct measure *m, stance_message *message)
{
    struct gnuplot g;
    double top;
    char stem[512];
    if (!begin_page(&g, plot, layout, m->what, &top, message))
        return false;
    gnuplot_legend(&g, legend_left(layout), legend_top(layout, top), "#d9d9d9", m->none);
    legend_cross(&g, layout, legend_top(layout, top) + 24);
    gnuplot_decorate(&g);
    put_palette(&g, layout, top, m);
    for (int p = 0; p < layout->panels; p++) {
        fputs("set object 1 rectangle from graph 0,0 to graph 1,1 behind fillcolor rgb '#d9d9d9' "
              "fillstyle solid noborder\n",
              g.script);
        begin_panel(&g, layout, p, top);
        put_image(&g, plot, layout, p, m->values, put_value, "format='%float64' with image");
        fputs("\nunset colorbox\n", g.script); /* one for all */
    }
    snprintf(stem, sizeof stem, "%s-%s", plot->stem, m->name);
    return gnuplot_end(&g, plot->directory, stem, message);
}

static void make_layout(const struct plot *plot, struct layout *layout)
{
    choose_axes(plot->r, layout);
    choose_panels(plot->r, layout);
    arrange(layout);
    choose_naming(plot->r, layout);
    say_what_is_shown(plot->r, layout);
}

bool plot_maps(const struct plot *plot, stance_message *message)
{
    struct layout layout;
    struct measure m = {.name = "settle_time",
                        .unit = "s",
                        .what = "Time from which each case stayed settled",
                        .none = "did not settle"};
    uint64_t inferred;
    make_layout(plot, &layout);
    if (!statistics_inferred(plot->r, &inferred, NULL, message))
        return false;
    m.none = inferred > 0 ? "none or inferred" : m.none;
    if (!draw_outcomes(plot, &layout, message) ||
        !results_answer(plot->r, "settle_time", &m.values, message))
        return false;
    bool good = true;
    if (m.values && settle_range(plot->r, &m))
        good = draw_measure(plot, &layout, &m, message);
    else
        fputs("no picture of settle_time: no case has one\n", stderr);
    free(m.values);
    return good;
}

bool plot_answer_map(const struct plot *plot, const struct plot_answer *answer,
                     stance_message *message)
{
    struct layout layout;
    char what[256], none[64];
    uint64_t inferred;
    struct measure m = {.name = answer->name, .unit = answer->unit, .what = what, .none = none};

    if (!statistics_inferred(plot->r, &inferred, NULL, message) ||
        !plot_answer_numbers(plot, answer, &m.values, &m.low, &m.high, message))
        return false;
    plot_answer_title(answer, what, sizeof what);
    snprintf(none, sizeof none,
             inferred > 0                       ? "none or inferred"
             : answer->of == RESULTS_KIND_COUNT ? "no number"
                                                : "not %s",
             answer->of == RESULTS_KIND_COUNT ? "" : results_kind_names[answer->of]);
    make_layout(plot, &layout);
    bool good = draw_measure(plot, &layout, &m, message);
    free(m.values);
    return good;
}
