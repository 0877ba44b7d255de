/* plot_map.c - maps of a sweep over two axes or more: what became of every case, a cell each, and
 * when it settled. Further axes become panels. */
#include "plot_allowed.h"

#include "runner/base/message.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MAX_PANELS = 30 }; /* more are drawn in part */

GNUPLOT_SCRIPT(plot_map_gp, "analysis/plot/plot_map.gp");

/* ---- a page ------------------------------------------------------------------------------- */

static void put_titles(struct gnuplot *g, const struct plot_layout *layout)
{
    static const char *const naming[] = {"long", "short", "bare"};
    const bool table = plot_layout_is_table(layout);
    char text[1024];
    for (int n = PLOT_NAMES; n <= PLOT_VALUES_ALONE; n++) {
        gnuplot_set(g, "array title_%s[%d]", naming[n], layout->panels);
        for (int p = 0; p < layout->panels; p++) {
            plot_panel_title(g, layout, p, (enum plot_naming)n, text, sizeof text);
            gnuplot_text(g, text, "title_%s[%d]", naming[n], p + 1);
        }
    }
    gnuplot_set(g, "table = %zu", table ? layout->shown[1] : 0);
    for (int k = 0; table && k < 2; k++) {
        const struct results_axis *axis = &layout->r->axis[layout->other[k]];
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
            const size_t i = plot_layout_shown(layout, k, m);
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
        const int panel = plot_layout_panel(layout, i);
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
    const bool table = plot_layout_is_table(layout);
    snprintf(text, size, "%s", what);
    for (int k = 0; k < layout->others; k++) {
        const struct results_axis *axis = &r->axis[layout->other[k]];
        add_text(text, size, "%s%s%s%s%s",
                 table ? (k ? ", columns " : "; rows ")
                 : k   ? ", "
                       : "; one panel per ",
                 axis->name, axis->text[0] ? " (" : "", axis->text, axis->text[0] ? ")" : "");
    }
    const char *before = "; at ";
    for (int a = 0; a < r->axes; a++) {
        char value[96];
        if (r->axis[a].count > 1 || a == layout->x || a == layout->y)
            continue;
        results_value_text(&r->axis[a], 0, true, value, sizeof value);
        add_text(text, size, "%s%s = %s", before, r->axis[a].name, value);
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
    char text[1024];
    double x, y;

    subtitle_of(r, layout, what, text, sizeof text);
    if (!plot_begin(plot, g, plot_map_gp, text, message))
        return false;
    plot_axis_write(&layout->across, g, "x");
    plot_axis_write(&layout->up, g, "y");
    gnuplot_set(g, "panels = %d; measured = %d; bars = %d", layout->panels, measured, measured);
    put_titles(g, layout);
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
    plot_layout_note(layout, g);
    for (int p = 0; p < layout->panels; p++) {
        cells.first = plot_layout_index(layout, p, 0, 0);
        cells.stride[0] = plot_layout_index(layout, p, 1, 0) - cells.first;
        cells.stride[1] = plot_layout_index(layout, p, 0, 1) - cells.first;
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

/* ---- an answer ---------------------------------------------------------------------------- */

/* A picture of the numbers of one answer. */
struct measure {
    const char *name, *unit, *what; /* what: the page's subtitle */
    const char *none;               /* the legend of cells without a number */
    double *values, low, high;
};

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

/* When each case settled; said where none did. */
static bool draw_times(const struct plot *plot, const struct plot_layout *layout,
                       const struct plot_allowed *allowed, bool inferred, stance_message *message)
{
    const struct results *const r = plot->r;
    struct measure m = {.name = "settle_time",
                        .unit = "s",
                        .what = "Time from which each case stayed settled",
                        .none = inferred ? "none or inferred" : "did not settle"};
    bool good = results_answer(r, m.name, &m.values, message);
    for (uint64_t i = 0; good && m.values && i < r->cases; i++)
        if (r->kind[i] != RESULTS_STABILISED && r->kind[i] != RESULTS_RESTED)
            m.values[i] = NAN;
    if (good && m.values && plot_range(m.values, r->cases, &m.low, &m.high))
        good = draw_measure(plot, layout, allowed, &m, message);
    else if (good)
        fputs("no picture of settle_time: no case has one\n", stderr);
    free(m.values);
    return good;
}

bool plot_maps(const struct plot *plot, stance_message *message)
{
    const struct results *const r = plot->r;
    struct plot_layout layout;
    struct plot_allowed allowed;
    struct gnuplot g;
    char what[700];
    uint64_t inferred;
    if (r->sample >= 0 || r->axes < 2)
        return true;
    plot_layout_make(&layout, r, MAX_PANELS);
    if (!statistics_inferred(r, &inferred, NULL, message))
        return false;
    plot_became_text(r, what, sizeof what);
    if (inferred > 0)
        add_text(what, sizeof what, "; %llu of them inferred from neighbours that agree",
                 (unsigned long long)inferred);
    plot_cut_text(r, statistics_judged(r), true, what, sizeof what);
    const bool good =
        find_allowed(&allowed, plot, &layout, message) &&
        begin_page(&g, plot, &layout, &allowed, what, r->kind, sizeof *r->kind, "", message) &&
        plot_end(plot, &g, "map", message) &&
        draw_times(plot, &layout, &allowed, inferred > 0, message);
    plot_allowed_free(&allowed);
    return good;
}

bool plot_answer_map(const struct plot *plot, const struct plot_answer *answer,
                     stance_message *message)
{
    struct plot_layout layout;
    struct plot_allowed allowed;
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
    const bool good = find_allowed(&allowed, plot, &layout, message) &&
                      draw_measure(plot, &layout, &allowed, &m, message);
    plot_allowed_free(&allowed);
    free(m.values);
    return good;
}
