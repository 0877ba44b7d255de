/* plot_map.c - maps of a sweep over two axes or more: what became of every case, a cell each, and
 * when it settled. Further axes become panels. */
#include "plot_allowed.h"

#include "analysis/statistics/statistics.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MAX_PANELS = 30 }; /* more are drawn in part */

GNUPLOT_SCRIPT(plot_map_gp, "analysis/plot/plot_map.gp");

/* ---- a page ------------------------------------------------------------------------------- */

static void put_titles(struct gnuplot *g, const struct results *r, const struct plot_layout *layout)
{
    static const char *const naming[] = {"long", "short", "bare"};
    const bool table = plot_layout_is_table(layout);
    char text[1024];
    for (int n = PLOT_NAMES; n <= PLOT_VALUES_ALONE; n++) {
        gnuplot_set(g, "array title_%s[%d]", naming[n], layout->panels);
        for (int p = 0; p < layout->panels; p++) {
            plot_panel_title(g, r, layout, p, (enum plot_naming)n, text, sizeof text);
            gnuplot_text(g, text, "title_%s[%d]", naming[n], p + 1);
        }
    }
    gnuplot_set(g, "table = %zu", table ? layout->shown[1] : 0);
    for (int k = 0; table && k < 2; k++) {
        const struct results_axis *axis = &r->axis[layout->other[k]];
        const char *const line = k ? "column" : "row", *name = look_label(g->look, axis->name);
        if (name == axis->name)
            snprintf(text, sizeof text, axis->unit[0] ? "%s (%s)" : "%s",
                     plot_short_name(name, PLOT_NAMES), axis->unit);
        else
            snprintf(text, sizeof text, "%s", name);
        gnuplot_text(g, text, "%s_name", line);
        gnuplot_set(g, "array %s_long[%zu]\narray %s_bare[%zu]", line, layout->shown[k], line,
                    layout->shown[k]);
        for (size_t m = 0; m < layout->shown[k]; m++) {
            const size_t i = plot_layout_shown(layout, r, k, m);
            plot_value_title(g, axis, i, PLOT_NAMES, text, sizeof text);
            gnuplot_text(g, text, "%s_long[%zu]", line, m + 1);
            plot_value_title(g, axis, i, PLOT_NUMBERS, text, sizeof text);
            gnuplot_text(g, text, "%s_bare[%zu]", line, m + 1);
        }
    }
}

/* What stands of the cases drawn in each panel, of those that are done; of numbers nothing. */
static void put_shares(struct gnuplot *g, const struct results *r, const struct plot_layout *layout,
                       bool measured)
{
    const uint8_t judged = (uint8_t)statistics_judged(r);
    uint64_t *counts = calloc(2 * (size_t)layout->panels, sizeof *counts); /* judged, done */
    char text[32];
    for (uint64_t i = 0; counts && !measured && i < r->cases; i++) {
        const int panel = plot_layout_panel(layout, r, i);
        if (panel >= 0 && r->kind[i] < RESULTS_FAILED) {
            counts[2 * panel] += r->kind[i] == judged;
            counts[2 * panel + 1]++;
        }
    }
    gnuplot_set(g, "array share[%d]", layout->panels);
    for (int p = 0; p < layout->panels; p++) {
        const bool any = counts && counts[2 * p + 1] > 0;
        snprintf(text, sizeof text, "%.1f %%",
                 any ? 100 * (double)counts[2 * p] / (double)counts[2 * p + 1] : 0);
        gnuplot_text(g, any ? text : "", "share[%d]", p + 1);
    }
    free(counts);
    if (layout->panels > 1 && !measured) {
        snprintf(text, sizeof text, "%%: %s", results_kind_names[judged]);
        gnuplot_note(g, text);
    }
}

static void subtitle_of(const struct results *r, const struct plot_layout *layout, const char *what,
                        char *text, size_t size)
{
    size_t used = (size_t)snprintf(text, size, "%s", what);
    for (int k = 0; k < layout->others && used < size; k++) {
        const struct results_axis *axis = &r->axis[layout->other[k]];
        used += (size_t)snprintf(text + used, size - used, "%s%s%s%s%s",
                                 plot_layout_is_table(layout) ? (k ? ", columns " : "; rows ")
                                 : k                          ? ", "
                                                              : "; one panel per ",
                                 axis->name, axis->text[0] ? " (" : "", axis->text,
                                 axis->text[0] ? ")" : "");
    }
    const char *before = "; at ";
    for (int a = 0; a < r->axes && used < size; a++) {
        char value[96];
        if (r->axis[a].count > 1 || a == layout->x || a == layout->y)
            continue;
        results_value_text(&r->axis[a], 0, true, value, sizeof value);
        used +=
            (size_t)snprintf(text + used, size - used, "%s%s = %s", before, r->axis[a].name, value);
        before = ", ";
    }
}

/* Axes, panels and their cells: of an array over the cases, their kinds or numbers; none: the
 * legend of cells without a number. */
static bool begin_page(struct gnuplot *g, const struct plot *plot, const struct plot_layout *layout,
                       const struct plot_allowed *allowed, const char *what, const void *values,
                       size_t size, const char *none, stance_message *message)
{
    const struct results *r = plot->r;
    struct plot_cells cells = {&layout->across, &layout->up, 0, {0, 0}};
    const bool measured = values != r->kind;
    size_t stride[SCENARIO_MAX_AXES] = {0}, point[SCENARIO_MAX_AXES], step = 1;
    char text[1024];
    double x, y;

    subtitle_of(r, layout, what, text, sizeof text);
    if (!plot_begin(plot, g, plot_map_gp, text, message))
        return false;
    plot_axis_write(&layout->across, g, "x");
    plot_axis_write(&layout->up, g, "y");
    gnuplot_set(g, "panels = %d; measured = %d; bars = %d", layout->panels, measured, measured);
    put_titles(g, r, layout);
    if (measured)
        gnuplot_legend(g, "no_number", none, "");
    else
        plot_kinds_write(r, g, true);
    const bool cross = plot_zero_place(&layout->across, &x) && plot_zero_place(&layout->up, &y);
    gnuplot_set(g, "cross = %d", cross);
    if (cross) {
        gnuplot_set(g, "cross_x = %#.17g; cross_y = %#.17g", x, y);
        gnuplot_legend_mark(g, "0x000000", 0, 1, "equilibrium", "");
    }
    if (allowed->panels > 0)
        plot_allowed_legend(allowed->panel, allowed->panels, PLOT_ALLOWED_ONE, g);
    put_shares(g, r, layout, measured);
    plot_layout_note(layout, g, r);
    for (int a = r->axes - 1; a >= 0; a--) {
        stride[a] = step;
        step *= r->axis[a].count;
    }
    cells.stride[0] = stride[layout->x];
    cells.stride[1] = stride[layout->y];
    for (int p = 0; p < layout->panels; p++) {
        plot_layout_point(layout, r, p, point);
        cells.first = 0;
        for (int a = 0; a < r->axes; a++)
            cells.first += point[a] * stride[a];
        plot_cells_write(g, &cells, values, size);
        if (p < allowed->panels)
            plot_allowed_write(&allowed->panel[p], g, p + 1);
    }
    return true;
}

/* What linear theory allows in a map's panels. */
static bool find_allowed(struct plot_allowed *allowed, const struct plot *plot,
                         const struct plot_layout *layout, stance_message *message)
{
    const struct plot_axis *const x = &layout->across, *const y = &layout->up;
    const struct plot_frame frame = {{x->scale, y->scale}, {x->low, y->low}, {x->high, y->high}};
    return plot_allowed_make(allowed, plot, layout, &frame, message);
}

static bool draw_outcomes(const struct plot *plot, const struct plot_layout *layout,
                          const struct plot_allowed *allowed, stance_message *message)
{
    struct gnuplot g;
    char what[700];
    uint64_t inferred;
    if (!statistics_inferred(plot->r, &inferred, NULL, message))
        return false;
    plot_became_text(plot->r, what, sizeof what);
    const size_t used = strlen(what);
    if (inferred > 0) {
        snprintf(what + used, sizeof what - used,
                 "; %llu of them inferred from neighbours that agree",
                 (unsigned long long)inferred);
    }
    plot_cut_text(plot->r, statistics_judged(plot->r), true, what, sizeof what);
    if (!begin_page(&g, plot, layout, allowed, what, plot->r->kind, sizeof *plot->r->kind, "",
                    message))
        return false;
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

static bool draw_measure(const struct plot *plot, const struct plot_layout *layout,
                         const struct plot_allowed *allowed, const struct measure *m,
                         stance_message *message)
{
    struct gnuplot g;
    if (!begin_page(&g, plot, layout, allowed, m->what, m->values, sizeof *m->values, m->none,
                    message))
        return false;
    gnuplot_set(&g, "lowest = %#.17g; highest = %#.17g", m->low, m->high);
    const char *label = look_label(plot->look, m->name);
    gnuplot_text(&g, label, "measure");
    gnuplot_text(&g, label == m->name ? m->unit : "", "measure_unit");
    return plot_end(plot, &g, m->name, message);
}

bool plot_maps(const struct plot *plot, stance_message *message)
{
    struct plot_layout layout;
    struct measure m = {.name = "settle_time",
                        .unit = "s",
                        .what = "Time from which each case stayed settled",
                        .none = "did not settle"};
    uint64_t inferred;
    if (plot->r->sample >= 0 || plot->r->axes < 2)
        return true;
    plot_layout_make(&layout, plot->r, MAX_PANELS);
    if (!statistics_inferred(plot->r, &inferred, NULL, message))
        return false;
    m.none = inferred > 0 ? "none or inferred" : m.none;
    struct plot_allowed allowed;
    bool good = find_allowed(&allowed, plot, &layout, message) &&
                draw_outcomes(plot, &layout, &allowed, message) &&
                results_answer(plot->r, "settle_time", &m.values, message);
    if (good && m.values && settle_range(plot->r, &m))
        good = draw_measure(plot, &layout, &allowed, &m, message);
    else if (good)
        fputs("no picture of settle_time: no case has one\n", stderr);
    free(m.values);
    plot_allowed_free(&allowed);
    return good;
}

bool plot_answer_map(const struct plot *plot, const struct plot_answer *answer,
                     stance_message *message)
{
    struct plot_layout layout;
    char what[700], none[64];
    uint64_t inferred;
    struct measure m = {.name = answer->name, .unit = answer->unit, .what = what, .none = none};

    if (!statistics_inferred(plot->r, &inferred, NULL, message) ||
        !plot_answer_numbers(plot, answer, &m.values, &m.low, &m.high, message))
        return false;
    plot_answer_title(answer, what, sizeof what);
    plot_cut_text(plot->r, answer->of, false, what, sizeof what);
    snprintf(none, sizeof none,
             inferred > 0                       ? "none or inferred"
             : answer->of == RESULTS_KIND_COUNT ? "no number"
                                                : "not %s",
             answer->of == RESULTS_KIND_COUNT ? "" : results_kind_names[answer->of]);
    plot_layout_make(&layout, plot->r, MAX_PANELS);
    struct plot_allowed allowed;
    bool good = find_allowed(&allowed, plot, &layout, message) &&
                draw_measure(plot, &layout, &allowed, &m, message);
    plot_allowed_free(&allowed);
    free(m.values);
    return good;
}
