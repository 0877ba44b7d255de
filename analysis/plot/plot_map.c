/* plot_map.c - maps of a sweep over two axes or more: what became of every case, a cell each, and
 * when it settled. Further axes become panels. */
#include "plot_allowed.h"

#include <math.h>
#include <stdlib.h>

enum { MAX_PANELS = 30 }; /* more are drawn in part */

GNUPLOT_SCRIPT(plot_map_gp, "analysis/plot/plot_map.gp");

/* What all pictures of a file are over. */
struct map {
    struct gnuplot g;
    struct plot_layout layout;
    struct plot_allowed allowed; /* what linear theory allows in the panels */
    uint64_t inferred;           /* cases */
};

/* ---- a page ------------------------------------------------------------------------------- */

static void put_titles(struct gnuplot *g, const struct plot_layout *layout)
{
    static const char *const naming[] = {"long", "short", "bare"};
    const bool table = plot_layout_is_table(layout);
    const size_t panels = (size_t)layout->panels;
    char text[1024];
    gnuplot_arrays(g, panels, "title_long title_short title_bare share");
    for (int n = PLOT_NAMES; n <= PLOT_VALUES_ALONE; n++) {
        for (size_t p = 0; p < panels; p++) {
            plot_panel_title(g, layout, (int)p, (enum plot_naming)n, text, sizeof text);
            gnuplot_text(g, text, "title_%s[%zu]", naming[n], p + 1);
        }
    }
    gnuplot_set(g, "table = %zu", table ? layout->shown[1] : 0);
    for (int k = 0; table && k < 2; k++) {
        const struct results_axis *axis = &layout->r->axis[layout->other[k]];
        const char *const line = k ? "column" : "row",
                          *name = look_label(g->plot->look, axis->name);
        if (name == axis->name)
            snprintf(text, sizeof text, axis->unit[0] ? "%s (%s)" : "%s",
                     plot_short_name(name, PLOT_NAMES), axis->unit);
        else
            snprintf(text, sizeof text, "%s", name);
        gnuplot_text(g, text, "%s_name", line);
        gnuplot_arrays(g, layout->shown[k], k ? "column_long column_bare" : "row_long row_bare");
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
static void put_shares(struct gnuplot *g, const struct plot_layout *layout, bool measured)
{
    const enum results_kind judged = statistics_judged(g->plot->r);
    char text[32];
    for (int p = 0; p < layout->panels; p++) {
        const double share = measured ? NAN : plot_layout_share(layout, p, judged);
        snprintf(text, sizeof text, "%.1f %%", share);
        gnuplot_text(g, isnan(share) ? "" : text, "share[%d]", p + 1);
    }
    if (layout->panels > 1 && !measured)
        gnuplot_note(g, "%%: %s", results_kind_names[judged]);
}

/* The other axes, to the line under the title. */
static void say_others(struct gnuplot *g, const struct plot_layout *layout)
{
    const struct results *const r = g->plot->r;
    const bool table = plot_layout_is_table(layout);
    for (int k = 0; k < layout->others; k++) {
        const struct results_axis *axis = &r->axis[layout->other[k]];
        gnuplot_say(g, "%s%s%s%s%s",
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
        gnuplot_say(g, "%s%s = %s", before, r->axis[a].name, value);
        before = ", ";
    }
}

static bool begin(struct map *map, const struct plot *plot, const char *name)
{
    const struct results *const r = plot->r;
    if (!gnuplot_begin(&map->g, plot, name, plot_map_gp))
        return false;
    plot_layout_make(&map->layout, r, MAX_PANELS);
    gnuplot_needs(&map->g, statistics_inferred(r, &map->inferred, NULL, plot->message));
    return true;
}

/* Axes, panels and their cells: of an array over the cases, their kinds or numbers; none: the
 * legend of cells without a number. */
static void put(struct map *map, const void *values, size_t size, const char *none)
{
    struct gnuplot *const g = &map->g;
    const struct plot_layout *const layout = &map->layout;
    const struct plot_axis *const across = &layout->across, *const up = &layout->up;
    struct plot_cells cells = {across, up, 0, {0, 0}};
    const bool measured = values != g->plot->r->kind;
    double x, y;

    if (!plot_allowed_make(&map->allowed, g, layout, (const struct plot_axis[]){*across, *up}))
        return;
    say_others(g, layout);
    plot_axis_write(across, g, 'x');
    plot_axis_write(up, g, 'y');
    gnuplot_set(g, "panels = %d; measured = %d; bars = %d", layout->panels, measured, measured);
    put_titles(g, layout);
    if (measured)
        gnuplot_legend(g, "no_number", 0, 0, none, "");
    else
        plot_kinds_write(g, true);
    const bool cross = plot_zero_place(across, &x) && plot_zero_place(up, &y);
    gnuplot_set(g, "cross = %d", cross);
    if (cross) {
        gnuplot_set(g, "cross_x = %#.17g; cross_y = %#.17g", x, y);
        gnuplot_legend(g, "0x000000", 0, 1, "equilibrium", "");
    }
    if (map->allowed.panels > 0)
        plot_allowed_legend(map->allowed.panel, map->allowed.panels, PLOT_ALLOWED_ONE, g);
    put_shares(g, layout, measured);
    plot_layout_note(layout, g);
    for (int p = 0; p < layout->panels; p++) {
        cells.first = plot_layout_index(layout, p, 0, 0);
        cells.stride[0] = plot_layout_index(layout, p, 1, 0) - cells.first;
        cells.stride[1] = plot_layout_index(layout, p, 0, 1) - cells.first;
        plot_cells_write(g, &cells, values, size);
        if (p < map->allowed.panels)
            plot_allowed_write(&map->allowed.panel[p], g, p + 1);
    }
}

/* ---- an answer ---------------------------------------------------------------------------- */

static bool end_measure(struct map *map, const char *name, const char *unit, const double *values,
                        struct plot_range range, const char *none)
{
    put(map, values, sizeof *values, none);
    gnuplot_set(&map->g, "lowest = %#.17g; highest = %#.17g", range.low, range.high);
    const char *label = look_label(map->g.plot->look, name);
    gnuplot_text(&map->g, label, "measure");
    gnuplot_text(&map->g, label == name ? unit : "", "measure_unit");
    return gnuplot_end(&map->g);
}

/* When each case settled; said where none did. */
static bool draw_times(const struct plot *plot)
{
    static const char name[] = "settle_time";
    const struct results *const r = plot->r;
    struct map map;
    struct plot_range range;
    double *values = NULL;
    if (!begin(&map, plot, name))
        return false;
    const bool good = gnuplot_needs(&map.g, results_answer(r, name, &values, plot->message)) &&
                      values && gnuplot_keep(&map.g, values);
    for (uint64_t i = 0; good && i < r->cases; i++)
        if (r->kind[i] != RESULTS_STABILISED && r->kind[i] != RESULTS_RESTED &&
            r->kind[i] != RESULTS_WALKS)
            values[i] = NAN;
    if (map.g.missing)
        return gnuplot_end(&map.g);
    if (!good || !plot_range_of(&range, values, r->cases)) {
        fputs("no picture of settle_time: no case has one\n", stderr);
        gnuplot_abandon(&map.g);
        return true;
    }
    gnuplot_say(&map.g, "Time from which each case stayed settled");
    return end_measure(&map, name, "s", values, range,
                       map.inferred > 0 ? "none or inferred" : "did not settle");
}

bool plot_maps(const struct plot *plot)
{
    const struct results *const r = plot->r;
    struct map map;
    if (r->sample >= 0 || r->axes < 2)
        return true;
    if (!begin(&map, plot, "map"))
        return false;
    plot_say_became(&map.g);
    if (map.inferred > 0)
        gnuplot_say(&map.g, "; %llu of them inferred from neighbours that agree",
                    (unsigned long long)map.inferred);
    plot_say_cut(&map.g, statistics_judged(r), true);
    put(&map, r->kind, sizeof *r->kind, "");
    return gnuplot_end(&map.g) && draw_times(plot);
}

bool plot_answer_map(const struct plot *plot, const struct plot_answer *answer)
{
    struct map map;
    struct plot_range range;
    char none[64];
    if (!begin(&map, plot, answer->name))
        return false;
    const double *const values = plot_answer_numbers(&map.g, answer, &range);
    if (!values)
        return gnuplot_end(&map.g);
    plot_say_answer(&map.g, answer);
    plot_say_cut(&map.g, answer->of, false);
    snprintf(none, sizeof none,
             map.inferred > 0                   ? "none or inferred"
             : answer->of == RESULTS_KIND_COUNT ? "no number"
                                                : "not %s",
             answer->of == RESULTS_KIND_COUNT ? "" : results_kind_names[answer->of]);
    return end_measure(&map, answer->name, answer->unit, values, range, none);
}

bool plot_number_map(const struct plot *plot, const struct plot_number *number,
                     const double *values)
{
    struct map map;
    struct plot_range range;
    if (!plot_range_of(&range, values, plot->r->cases))
        return true; /* there is nothing to be drawn */
    if (!begin(&map, plot, number->picture))
        return false;
    gnuplot_say(&map.g, "%s", number->said);
    return end_measure(&map, number->name, number->unit, values, range, number->none);
}
