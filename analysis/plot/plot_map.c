/* plot_map.c - maps of a sweep over two axes or more: what became of every case, a cell each, and
 * when it settled. Further axes become panels. */
#include "analysis/draw/plot.h"
#include "analysis/statistics/statistics.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MAX_PANELS = 16 };

GNUPLOT_SCRIPT(plot_map_gp, "analysis/plot/plot_map.gp");

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
    int panels;
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

/* A path as the titles of panels have it. */
static const char *short_name(const char *path, enum naming naming)
{
    const char *dot = naming == NAMES ? strchr(path, '.') : strrchr(path, '.');
    return dot ? dot + 1 : path;
}

/* "friction = 0.25, noise = 0.1": the page's subtitle has the whole paths in the same order. */
static void panel_title(const struct results *r, const struct layout *layout, int panel,
                        enum naming naming, char *text, size_t size)
{
    size_t point[SCENARIO_MAX_AXES], used = 0;
    char value[96];
    bool names = naming != VALUES_ALONE;
    panel_point(r, layout, panel, point);
    text[0] = '\0';
    for (int k = 0; k < layout->others && used < size; k++) {
        const struct results_axis *axis = &r->axis[layout->other[k]];
        results_value_text(axis, point[layout->other[k]], true, value, sizeof value);
        used += (size_t)snprintf(text + used, size - used, "%s%s%s%s", k ? ", " : "",
                                 names ? short_name(axis->name, naming) : "", names ? " = " : "",
                                 value);
    }
}

static void put_titles(struct gnuplot *g, const struct results *r, const struct layout *layout)
{
    static const char *const naming[] = {"long", "short", "bare"};
    char text[1024];
    for (int n = NAMES; n <= VALUES_ALONE; n++) {
        gnuplot_set(g, "array title_%s[%d]", naming[n], layout->panels);
        for (int p = 0; p < layout->panels; p++) {
            panel_title(r, layout, p, (enum naming)n, text, sizeof text);
            gnuplot_text(g, text, "title_%s[%d]", naming[n], p + 1);
        }
    }
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

/* Axes, panels and their cells: of an array over the cases. */
static bool begin_page(struct gnuplot *g, const struct plot *plot, const struct layout *layout,
                       const char *what, const void *values, size_t size, stance_message *message)
{
    const struct results *r = plot->r;
    struct plot_cells cells = {&layout->across, &layout->up, 0, {0, 0}};
    size_t stride[SCENARIO_MAX_AXES] = {0}, point[SCENARIO_MAX_AXES], step = 1;
    char text[1024];
    double x, y;

    subtitle_of(r, layout, what, text, sizeof text);
    if (!plot_begin(plot, g, plot_map_gp, text, message))
        return false;
    plot_axis_write(&layout->across, g, "x");
    plot_axis_write(&layout->up, g, "y");
    gnuplot_set(g, "panels = %d; table = %d", layout->panels,
                layout->others == 2 ? (int)layout->shown[1] : 0);
    put_titles(g, r, layout);
    const bool cross = zero_place(&layout->across, &x) && zero_place(&layout->up, &y);
    gnuplot_set(g, "cross = %d", cross);
    if (cross)
        gnuplot_set(g, "cross_x = %#.17g; cross_y = %#.17g", x, y);
    for (int a = r->axes - 1; a >= 0; a--) {
        stride[a] = step;
        step *= r->axis[a].count;
    }
    cells.stride[0] = stride[layout->x];
    cells.stride[1] = stride[layout->y];
    for (int p = 0; p < layout->panels; p++) {
        panel_point(r, layout, p, point);
        cells.first = 0;
        for (int a = 0; a < r->axes; a++)
            cells.first += point[a] * stride[a];
        plot_cells_write(g, &cells, values, size);
    }
    return true;
}

static bool draw_outcomes(const struct plot *plot, const struct layout *layout,
                          stance_message *message)
{
    struct gnuplot g;
    char what[160];
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
    if (!begin_page(&g, plot, layout, what, plot->r->kind, sizeof *plot->r->kind, message))
        return false;
    gnuplot_set(&g, "measured = 0");
    plot_kinds_write(plot->r, &g, true);
    return plot_end(plot, &g, "map", message);
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

static bool draw_measure(const struct plot *plot, const struct layout *layout,
                         const struct measure *m, stance_message *message)
{
    struct gnuplot g;
    if (!begin_page(&g, plot, layout, m->what, m->values, sizeof *m->values, message))
        return false;
    gnuplot_set(&g, "measured = 1; lowest = %#.17g; highest = %#.17g", m->low, m->high);
    gnuplot_text(&g, m->name, "measure");
    gnuplot_text(&g, m->unit, "measure_unit");
    gnuplot_legend(&g, "no_number", m->none);
    return plot_end(plot, &g, m->name, message);
}

static void make_layout(const struct plot *plot, struct layout *layout)
{
    choose_axes(plot->r, layout);
    choose_panels(plot->r, layout);
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
    if (plot->r->sample >= 0 || plot->r->axes < 2)
        return true;
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
