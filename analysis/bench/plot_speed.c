/* plot_speed.c - the speed benchmarks: the biped's step beside other programs', every method in
 * every scene, and the wall time of a whole map.
 */
#include "speed.h"

#include "analysis/draw/plot.h"
#include "runner/base/message.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { MOST_SERIES = 16, MOST_GROUPS = 32 };

/* Bars of one colour; NULL: whatever there is, the widest instruction set. */
struct series {
    const char *name, *subject, *method, *isa;
    unsigned colour;
};

/* Our implicit step in every instruction set, and what others need. */
static const struct series rivals[] = {
    {"MuJoCo, default", "mujoco default", NULL, NULL, 0x000000},
    {"MuJoCo, trimmed", "mujoco trimmed", NULL, NULL, 0x8a8a8a},
    {"1 lane", "stance", "implicit", "scalar", 0xb2dcf5},
    {"by hand", "scalar by hand", "implicit", "scalar", 0xe69f00},
    {"SSE2", "stance", "implicit", "sse2", 0x56b4e9},
    {"NEON", "stance", "implicit", "neon", 0x56b4e9},
    {"AVX2", "stance", "implicit", "avx2", 0x0072b2},
    {"AVX-512", "stance", "implicit", "avx512", 0x003f63}};

/* The scene that others were measured on; where none was, the first one. */
static const stance_scene *rivals_scene(const struct speed_table *table)
{
    for (size_t k = 0; k < table->rows; k++)
        if (strcmp(table->row[k].field[BENCH_SUBJECT], "stance") != 0 &&
            stance_scene_find(table->row[k].field[BENCH_SCENE]))
            return stance_scene_find(table->row[k].field[BENCH_SCENE]);
    return stance_scenes()[0];
}

/* A panel of bars, series side by side within the workloads of a scene, NULL: of all. What has no
 * row takes no room. */
static void put_bars(struct gnuplot *g, const struct speed_table *table,
                     const struct series *series, size_t count, const stance_scene *only,
                     const char *heading)
{
    const struct speed_row *row[MOST_GROUPS][MOST_SERIES];
    char group[MOST_GROUPS][100];
    size_t groups = 0, place[MOST_SERIES] = {0}, drawn = 0;
    struct plot_range time = PLOT_NOTHING;
    for (const stance_scene *const *s = stance_scenes(); *s; s++) {
        for (const stance_workload *w = (*s)->workload; w && w->name && groups < MOST_GROUPS; w++) {
            bool any = false;
            for (size_t k = 0; k < count && (!only || *s == only); k++) {
                const struct speed_row *const found =
                    speed_find(table, series[k].subject, (*s)->name, w->name, series[k].method,
                               series[k].isa, "time per step");
                row[groups][k] = found;
                if (!found)
                    continue;
                any = true;
                place[k] = 1;
                plot_widen(&time, found->lowest);
                plot_widen(&time, found->highest);
            }
            snprintf(group[groups], sizeof group[0], "%s%s%s", only ? "" : (*s)->name,
                     only ? "" : " ", w->name);
            groups += any;
        }
    }
    if (groups == 0)
        return;
    for (size_t k = 0; k < count; k++)
        place[k] = place[k] ? ++drawn : 0;
    time = (struct plot_range){log10(0.5 * time.low), log10(2.2 * time.high)};
    gnuplot_panel(g, 300, heading);
    const char *const axis =
        gnuplot_axis(g, 'x', PLOT_LIST, (struct plot_range){-0.5, (double)groups - 0.5}, "", "");
    gnuplot_set(g, "panel_wordy[panels] = %d", !only);
    for (size_t i = 0; i < groups; i++) {
        gnuplot_word(g, (double)i, group[i]);
        gnuplot_set(g, "%1$s_word[%1$s_words] = wrap(%1$s_word[%1$s_words], 12)", axis);
    }
    gnuplot_axis(g, 'y', PLOT_LOG, time, "nanoseconds per case-step of one core", "");
    gnuplot_legend(g, "0", 0, -1, only ? "the step" : "methods", "");
    for (size_t k = 0; k < count; k++) {
        const double wide = 0.86 / (double)drawn;
        char colour[32];
        if (!place[k])
            continue;
        snprintf(colour, sizeof colour, "bar%d_%zu", only != NULL, k);
        gnuplot_set(g, "%s = shade(0x%06x)", colour, series[k].colour);
        gnuplot_legend(g, colour, 0, 0, series[k].name, "");
        gnuplot_series(
            g,
            "using 1:2:($1-%g):($1+%g):(%g):2 with boxxyerror fs solid 0.9 noborder lc "
            "rgb %s notitle, '' using 1:3:(0):($4-$3) with vectors nohead lc rgb 0x303030%s",
            0.45 * wide, 0.45 * wide, time.low, colour,
            !only ? ""
                  : " notitle, '' using 1:($4+0.025):(digits($5)) with labels font "
                    "',8' center offset 0,0.5");
        for (size_t i = 0; i < groups; i++)
            if (row[i][k])
                GNUPLOT_ROW(g, (double)i + wide * ((double)place[k] - 0.5 * ((double)drawn + 1)),
                            log10(row[i][k]->median), log10(row[i][k]->lowest),
                            log10(row[i][k]->highest), row[i][k]->median);
    }
}

/* ---- the map ------------------------------------------------------------------------------ */

static bool is_time(const struct speed_row *row, const char *map, int ranks)
{
    return strcmp(row->field[BENCH_QUANTITY], "wall time") == 0 && row->ranks == ranks &&
           (!map || strcmp(row->field[BENCH_REGIME], map) == 0);
}

/* A panel of wall time over cases, a line in full and one refined, on most ranks. False: there is
 * none. */
static bool put_map(struct gnuplot *g, const struct speed_table *table)
{
    static const char *const maps[][2] = {{"basin full", "every case"},
                                          {"basin refined", "refined"}};
    struct plot_range cases = PLOT_NOTHING, time = PLOT_NOTHING;
    int ranks = 0;
    char text[80];
    for (size_t k = 0; k < table->rows; k++)
        if (is_time(&table->row[k], NULL, table->row[k].ranks) && table->row[k].ranks > ranks)
            ranks = table->row[k].ranks;
    for (size_t k = 0; k < table->rows; k++)
        if (ranks > 0 && is_time(&table->row[k], NULL, ranks)) {
            plot_widen(&cases, log10(table->row[k].cases));
            plot_widen(&time, log10(0.4 * table->row[k].lowest));
            plot_widen(&time, log10(2.5 * table->row[k].highest));
        }
    if (!(cases.low <= cases.high))
        return false;
    gnuplot_panel(g, 300, "The shipped map, basin_one_foot");
    snprintf(text, sizeof text, "wall time of the program on %d rank%s (s)", ranks,
             ranks == 1 ? "" : "s");
    gnuplot_axis(g, 'y', PLOT_LOG, time, text, "");
    gnuplot_axis(g, 'x', PLOT_LIST, (struct plot_range){cases.low - 0.3, cases.high + 0.3},
                 "cases of the stability map", "");
    for (size_t k = 0; k < table->rows; k++) {
        const struct speed_row *const row = &table->row[k];
        bool named = !is_time(row, NULL, ranks);
        for (size_t before = 0; before < k && !named; before++)
            named =
                is_time(&table->row[before], NULL, ranks) && table->row[before].cases == row->cases;
        if (!named) {
            snprintf(text, sizeof text, "%.0f²", sqrt(row->cases));
            gnuplot_word(g, log10(row->cases), text);
        }
        if (strcmp(row->field[BENCH_QUANTITY], "parallel efficiency") == 0 && row->ranks > 1)
            gnuplot_note(g, "parallel efficiency of %d ranks: %.0f %% (%.0f ... %.0f)", row->ranks,
                         100 * row->median, 100 * row->lowest, 100 * row->highest);
    }
    gnuplot_legend(g, "0", 0, -1, "the map", "");
    for (size_t m = 0; m < 2; m++) {
        gnuplot_series(g,
                       "using 1:2 with lines lc rgb %1$s lw 1.6 notitle, '' using 1:2:3:4 with "
                       "yerrorbars lc rgb %1$s pt 7 ps 0.8 lw 1 notitle, '' using 1:2:(digits($5)) "
                       "with labels font ',9' right offset -0.8,0.7",
                       gnuplot_hue(m));
        bool any = false;
        for (size_t k = 0; k < table->rows; k++) {
            const struct speed_row *const row = &table->row[k];
            if (!is_time(row, maps[m][0], ranks))
                continue;
            GNUPLOT_ROW(g, log10(row->cases), log10(row->median), log10(row->lowest),
                        log10(row->highest), row->median);
            any = true;
        }
        if (any)
            gnuplot_legend(g, gnuplot_hue(m), 1, 7, maps[m][1], "");
    }
    return true;
}

bool speed_plot(const struct speed_table *table, const struct plot *plot)
{
    static const unsigned colours[] = {0x0072b2, 0x56b4e9, 0x009e73, 0xd55e00,
                                       0xcc79a7, 0xe69f00, 0x000000}; /* Okabe and Ito (2008) */
    const stance_scene *const scene = rivals_scene(table);
    struct series methods[MOST_SERIES];
    size_t count = 0;
    struct gnuplot g;
    const struct speed_row *row = &table->row[0];
    char heading[160];

    if (!gnuplot_begin(&g, plot, ""))
        return false;
    gnuplot_say(
        &g, "Steps of 1 ms. Medians; bars from the lowest to the highest. %s, %s, revision %s, %s.",
        row->field[BENCH_PROCESSOR], row->field[BENCH_COMPILER], row->field[BENCH_REVISION],
        row->field[BENCH_DATE]);
    /* Two or three digits. */
    gnuplot_set(&g, "digits(v) = v < 0.95 ? sprintf('%%.2g', v) : v < 9.95 ? sprintf('%%.1f', v) : "
                    "v < 9995 ? sprintf('%%.0f', v) : "
                    "sprintf('%%.0fk', v/1000)");
    snprintf(heading, sizeof heading,
             "%s, implicit: one lane and more, beside the step written by hand and MuJoCo",
             scene->name);
    put_bars(&g, table, rivals, sizeof rivals / sizeof *rivals, scene, heading);
    for (const stance_method *const *m = stance_methods(); *m && count < MOST_SERIES; m++, count++)
        methods[count] = (struct series){(*m)->name, "stance", (*m)->name, NULL,
                                         colours[count % (sizeof colours / sizeof *colours)]};
    put_bars(&g, table, methods, count, NULL,
             "Every method in every scene, in the widest instruction set");
    if (put_map(&g, table))
        gnuplot_set(&g, "leads = panels - 1; lead_width = 900; chart_width = 420");
    else
        gnuplot_set(&g, "chart_width = 900");
    if (g.panels == 0) {
        gnuplot_abandon(&g);
        return complain(plot->message,
                        "the table has no times of scenes and methods of this program");
    }
    return gnuplot_end(&g);
}
