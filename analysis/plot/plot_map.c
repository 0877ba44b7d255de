/* plot_map.c - maps of a sweep over two axes or more: what became of every case, a cell each, and
 * the numbers that cases have. Further axes become panels; two of them a table of panels. */
#include "plot_layout.h"

#include "runner/base/message.h"

#include <math.h>
#include <stdlib.h>

enum { MAX_PANELS = 30 }; /* more are drawn in part */

/* The heading of the next panel, in forms for less and less room; of a table over its columns, and
 * beside its rows. */
static void put_heading(struct gnuplot *g, const struct plot_layout *layout, int p)
{
    static const char *const form[] = {"heading", "short", "bare"};
    char text[1024];
    if (!plot_layout_is_table(layout)) {
        for (int n = PLOT_NAMES; n <= PLOT_VALUES_ALONE; n++) {
            plot_panel_title(g, layout, p, (enum plot_naming)n, text, sizeof text);
            gnuplot_text(g, text, "panel_%s[panels]", form[n]);
        }
        return;
    }
    const size_t columns = layout->shown[1], at[] = {(size_t)p / columns, (size_t)p % columns};
    for (int k = 0; k < 2; k++) {
        const struct results_axis *const axis = &layout->r->axis[layout->other[k]];
        const size_t i = plot_layout_shown(layout, k, at[k]);
        if (k == 1 ? at[0] > 0 : at[1] + 1 < columns)
            continue;
        plot_value_title(g, axis, i, PLOT_NAMES, text, sizeof text);
        gnuplot_text(g, text, "panel_%s[panels]", k ? "heading" : "aside");
        plot_value_title(g, axis, i, PLOT_NUMBERS, text, sizeof text);
        gnuplot_text(g, text, "panel_%s[panels]", k ? "bare" : "aside_bare");
    }
}

/* How large panels are, how many stand side by side: the page is a little wider than high, and full
 * where it can be. The names of a table's axes. */
static void put_page(struct gnuplot *g, const struct plot_layout *layout)
{
    static const int sizes[][3] = {
        {1, 560, 500}, {4, 336, 300}, {16, 235, 210}, {MAX_PANELS, 170, 150}};
    const int panels = layout->panels;
    const bool table = plot_layout_is_table(layout);
    int columns = panels == 3 ? 3 : (int)ceil(sqrt(1.2 * panels)), size = 0;
    if (columns > 2 && panels % columns && panels % (columns - 1) == 0)
        columns--;
    while (sizes[size][0] < panels)
        size++;
    gnuplot_set(g, "columns = %d; chart_width = %d; chart_height = %d; scaled = 1; gridded = 0",
                table ? (int)layout->shown[1] : columns, sizes[size][1], sizes[size][2]);
    for (int k = 0; table && k < 2; k++) {
        const struct results_axis *const axis = &layout->r->axis[layout->other[k]];
        const char *const name = look_label(g->plot->look, axis->name);
        char text[200];
        snprintf(text, sizeof text, name == axis->name && axis->unit[0] ? "%s (%s)" : "%s",
                 name == axis->name ? plot_short_name(name, PLOT_NAMES) : name, axis->unit);
        gnuplot_text(g, text, k ? "column_name" : "row_name");
    }
}

/* The other axes, to the line under the title. */
static void say_others(struct gnuplot *g, const struct plot_layout *layout)
{
    static const char *const before[][2] = {{"; one panel per ", ", "}, {"; rows ", ", columns "}};
    const struct results *const r = g->plot->r;
    const char *at = "; at ";
    for (int k = 0; k < layout->others; k++) {
        const struct results_axis *const axis = &r->axis[layout->other[k]];
        gnuplot_say(g, axis->text[0] ? "%s%s (%s)" : "%s%s",
                    before[plot_layout_is_table(layout)][k > 0], axis->name, axis->text);
    }
    for (int a = 0; a < r->axes; a++) {
        char value[96];
        if (r->axis[a].count > 1 || a == layout->x || a == layout->y)
            continue;
        results_value_text(&r->axis[a], 0, true, value, sizeof value);
        gnuplot_say(g, "%s%s = %s", at, r->axis[a].name, value);
        at = ", ";
    }
}

/* Axes, and panels with their cells: of an array over the cases, their kinds or numbers. */
static void put(struct gnuplot *g, const void *values, bool numbers)
{
    const enum results_kind judged = statistics_judged(g->plot->r);
    struct plot_layout layout;
    struct plot_allowed allowed;
    char text[32];
    double x = 0, y = 0;
    plot_layout_make(&layout, g->plot->r, MAX_PANELS);
    const struct plot_axis *const across = &layout.across, *const up = &layout.up;
    if (!plot_allowed_make(&allowed, g, &layout, (const struct plot_axis[]){*across, *up}))
        return;
    say_others(g, &layout);
    put_page(g, &layout);
    plot_axis_write(across, g, 'x');
    plot_axis_write(up, g, 'y');
    const bool cross = plot_zero_place(across, &x) && plot_zero_place(up, &y);
    if (cross)
        gnuplot_legend(g, "0x000000", 0, 1, "equilibrium", "");
    if (allowed.panels > 0)
        plot_allowed_legend(allowed.panel, allowed.panels, PLOT_ALLOWED_ONE, g);
    if (layout.panels > 1 && !numbers)
        gnuplot_note(g, "%%: %s", results_kind_names[judged]);
    plot_layout_note(&layout, g);
    for (int p = 0; p < layout.panels; p++) {
        const size_t first = plot_layout_index(&layout, p, 0, 0);
        const struct plot_cells cells = {across,
                                         up,
                                         first,
                                         {plot_layout_index(&layout, p, 1, 0) - first,
                                          plot_layout_index(&layout, p, 0, 1) - first}};
        const double share = plot_layout_share(&layout, p, judged);
        gnuplot_panel(g, 0, "");
        gnuplot_set(g, "panel_own[panels] = chart_height");
        put_heading(g, &layout, p);
        snprintf(text, sizeof text, "%.1f %%", share);
        if (layout.panels > 1 && !numbers && !isnan(share)) /* of what is done */
            gnuplot_text(g, text, "panel_right[panels]");
        plot_cells_write(g, &cells, values, numbers ? NULL : "kind_colour");
        if (p < allowed.panels)
            plot_allowed_write(&allowed.panel[p], g,
                               "lw 4.4 dt 1 lc rgb 'white' notitle, '' using 1:2 with lines lw 2 "
                               "dt 11 lc rgb colour_allowed");
        if (cross)
            gnuplot_cross(g, x, y);
    }
}

bool plot_maps(const struct plot *plot)
{
    const struct results *const r = plot->r;
    struct gnuplot g;
    uint64_t inferred = 0;
    if (r->sample >= 0 || r->axes < 2)
        return true;
    if (!gnuplot_begin(&g, plot, "map"))
        return false;
    gnuplot_needs(&g, statistics_inferred(r, &inferred, NULL, plot->message));
    plot_say_became(&g);
    if (inferred > 0)
        gnuplot_say(&g, "; %llu of them inferred from neighbours that agree",
                    (unsigned long long)inferred);
    plot_say_cut(&g, statistics_judged(r), true);
    plot_kinds_write(&g, true);
    put(&g, r->kind, false);
    if (!gnuplot_end(&g))
        return false;

    /* When each case settled. */
    double *values = NULL;
    bool good = results_answer(r, "settle_time", &values, plot->message);
    for (uint64_t i = 0; values && i < r->cases; i++)
        if (r->kind[i] != RESULTS_STABILISED && r->kind[i] != RESULTS_RESTED &&
            r->kind[i] != RESULTS_WALKS)
            values[i] = NAN;
    struct plot_range range;
    if (good && values && plot_range_of(&range, values, r->cases))
        good = plot_number_map(
            plot,
            &(struct plot_number){"settle_time", "Time from which each case stayed settled", "s",
                                  "did not settle", RESULTS_KIND_COUNT, NULL},
            values);
    else if (good)
        fputs("no picture of settle_time: no case has one\n", stderr);
    free(values);
    return good;
}

bool plot_answer_map(const struct plot *plot, const struct plot_answer *answer)
{
    struct plot_range range;
    char none[64], said[600];
    double *const values = plot_answer_numbers(plot, answer, &range);
    if (!values)
        return false;
    snprintf(none, sizeof none, answer->of == RESULTS_KIND_COUNT ? "no number" : "not %s",
             results_kind_names[answer->of % RESULTS_KIND_COUNT]);
    plot_answer_text(answer, said, sizeof said);
    const bool good = plot_number_map(
        plot, &(struct plot_number){answer->name, said, answer->unit, none, answer->of, NULL},
        values);
    free(values);
    return good;
}

bool plot_number_map(const struct plot *plot, const struct plot_number *number,
                     const double *values)
{
    struct gnuplot g;
    struct plot_range range;
    uint64_t inferred = 0;
    char text[200];
    if (!plot_range_of(&range, values, plot->r->cases))
        return true; /* there is nothing to be drawn */
    if (!gnuplot_begin(&g, plot, number->picture))
        return false;
    gnuplot_needs(&g, statistics_inferred(plot->r, &inferred, NULL, plot->message));
    const char *const name = number->name ? number->name : number->picture, *const label =
                                                                                look_label(
                                                                                    plot->look,
                                                                                    name);
    gnuplot_say(&g, "%s", number->said);
    plot_say_cut(&g, number->of, false);
    gnuplot_legend(&g, "no_number", 0, 0, inferred > 0 ? "none or inferred" : number->none, "");
    snprintf(text, sizeof text, label == name && number->unit[0] ? "%s (%s)" : "%s", label,
             number->unit);
    gnuplot_text(&g, text, "bar_text");
    gnuplot_set(&g, "bars = 1; bar_low = %#.17g; bar_high = %#.17g; ground = no_number", range.low,
                range.high);
    put(&g, values, true);
    return gnuplot_end(&g);
}
