/* plot_speed.c - the speed benchmarks on one page: a scene's step beside other programs', every
 * method in every scene, and the wall time of a whole map.
 */
#include "speed.h"

#include "analysis/draw/plot.h"
#include "runner/base/message.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { MOST_SERIES = 16, MOST_GROUPS = 32 };

/* Bars side by side: series within groups. */
struct chart {
    size_t series, groups;
    const char *name[MOST_SERIES], *colour[MOST_SERIES];
    const char *group[MOST_GROUPS];  /* line under the bars ... */
    const char *within[MOST_GROUPS]; /* ... and under that, or "" */
    const struct speed_row *row[MOST_SERIES][MOST_GROUPS];
};

static void add_series(struct chart *c, const char *name, const char *colour)
{
    if (c->series < MOST_SERIES) {
        c->name[c->series] = name;
        c->colour[c->series++] = colour;
    }
}

/* A row in a series: where it stands, median, lowest, highest, by their logarithms. */
static void put_row(struct gnuplot *g, double place, const struct speed_row *row)
{
    GNUPLOT_ROW(g, place, log10(row->median), log10(row->lowest), log10(row->highest));
}

static void widen(struct plot_range *range, const struct speed_row *row)
{
    plot_widen(range, log10(row->lowest));
    plot_widen(range, log10(row->highest));
}

/* A part of the page: a panel, and over its entries of the legend a word. */
static void begin_panel(struct gnuplot *g, const char *heading, const char *word)
{
    gnuplot_panel(g, 330, heading);
    gnuplot_legend(g, "0xffffff", 0, -1, word, "");
}

/* A panel of bars, which end in `more`. Series without rows keep their place but are not drawn. */
static void put_chart(struct gnuplot *g, const struct chart *c, const char *heading,
                      const char *word, const char *more)
{
    const double wide = 0.86 / (double)c->series;
    struct plot_range range = PLOT_NOTHING;
    for (size_t i = 0; i < c->series * c->groups; i++)
        if (c->row[i / c->groups][i % c->groups])
            widen(&range, c->row[i / c->groups][i % c->groups]);
    if (!(range.low <= range.high))
        return;
    begin_panel(g, heading, word);
    const char *const axis =
        gnuplot_axis(g, 'x', PLOT_LIST, (struct plot_range){-0.5, (double)c->groups - 0.5}, "", "");
    gnuplot_set(g, "panel_wordy[panels] = %d; %s_words = %zu; array %s_word[%zu]; array %s_at[%zu]",
                c->within[0][0] != '\0', axis, c->groups, axis, c->groups, axis, c->groups);
    for (size_t i = 0; i < c->groups; i++) {
        gnuplot_tic(g, c->group[i], "group");
        gnuplot_tic(g, c->within[i], "within");
        gnuplot_set(g, "%s_at[%zu] = %zu; %s_word[%zu] = group.\"\\n\".within", axis, i + 1, i,
                    axis, i + 1);
    }
    range = (struct plot_range){range.low - 0.3, range.high + 0.35};
    gnuplot_axis(g, 'y', PLOT_LOG, range, "nanoseconds per case-step of one core", "");
    for (size_t s = 0; s < c->series; s++) {
        bool any = false;
        for (size_t i = 0; i < c->groups; i++)
            any |= c->row[s][i] != NULL;
        if (!any)
            continue;
        gnuplot_legend(g, c->colour[s], 0, 0, c->name[s], "");
        gnuplot_series(
            g,
            "using 1:2:($1-%g):($1+%g):(%g):2 with boxxyerror fs solid 0.9 border lc "
            "rgb %s lc rgb %s lw 0.5 notitle, '' using 1:3:(0):($4-$3) with vectors nohead lc rgb "
            "0x303030 lw 1.2%s",
            0.45 * wide, 0.45 * wide, range.low, c->colour[s], c->colour[s], more);
        for (size_t i = 0; i < c->groups; i++)
            if (c->row[s][i])
                put_row(g, (double)i + wide * ((double)s + 0.5 - 0.5 * (double)c->series),
                        c->row[s][i]);
    }
}

/* ---- the charts --------------------------------------------------------------------------- */

static const char *const step_time = "time per step";

/* The scene that others were measured on; where none was, the first one. */
static const stance_scene *rivals_scene(const struct speed_table *table)
{
    for (size_t k = 0; k < table->rows; k++)
        if (strcmp(table->row[k].field[BENCH_SUBJECT], "stance") != 0 &&
            stance_scene_find(table->row[k].field[BENCH_SCENE]))
            return stance_scene_find(table->row[k].field[BENCH_SCENE]);
    return stance_scenes()[0];
}

/* Its implicit step in every instruction set beside what others need. */
static void make_rivals(const struct speed_table *table, struct chart *c)
{
    static const struct {
        const char *name, *subject, *isa, *colour;
    } series[] = {{"MuJoCo, default", "mujoco default", "", "rivals[1]"},
                  {"MuJoCo, trimmed", "mujoco trimmed", "", "rivals[2]"},
                  {"1 lane", "stance", "scalar", "rivals[3]"},
                  {"by hand", "scalar by hand", "scalar", "hue[5]"},
                  {"SSE2", "stance", "sse2", "hue[6]"},
                  {"NEON", "stance", "neon", "hue[6]"},
                  {"AVX2", "stance", "avx2", "hue[1]"},
                  {"AVX-512", "stance", "avx512", "rivals[4]"}};
    const stance_scene *const scene = rivals_scene(table);

    *c = (struct chart){0};
    for (size_t s = 0; s < sizeof series / sizeof series[0]; s++) {
        const bool own = strcmp(series[s].isa, "") != 0;
        if (!speed_find(table, series[s].subject, scene->name, NULL, own ? "implicit" : NULL,
                        own ? series[s].isa : NULL, step_time))
            continue; /* takes no room */
        add_series(c, series[s].name, series[s].colour);
        for (size_t i = 0; i < MOST_GROUPS && scene->workload[i].name; i++) {
            c->row[c->series - 1][i] =
                speed_find(table, series[s].subject, scene->name, scene->workload[i].name,
                           own ? "implicit" : NULL, series[s].isa, step_time);
        }
    }
    for (; c->groups < MOST_GROUPS && scene->workload[c->groups].name; c->groups++) {
        c->group[c->groups] = scene->workload[c->groups].name;
        c->within[c->groups] = "";
    }
}

/* Every method in every scene, in as many lanes as there are. */
static void make_methods(const struct speed_table *table, struct chart *c)
{
    *c = (struct chart){0};
    for (size_t m = 0; stance_methods()[m]; m++)
        add_series(c, stance_methods()[m]->name, gnuplot_hue(m));
    for (size_t k = 0; k < table->rows; k++) {
        const struct speed_row *row = &table->row[k];
        if (strcmp(row->field[BENCH_SUBJECT], "stance") != 0 ||
            strcmp(row->field[BENCH_QUANTITY], step_time) != 0)
            continue;
        size_t i = 0, s = 0;
        while (i < c->groups && (strcmp(c->group[i], row->field[BENCH_SCENE]) != 0 ||
                                 strcmp(c->within[i], row->field[BENCH_REGIME]) != 0))
            i++;
        while (s < c->series && strcmp(c->name[s], row->field[BENCH_METHOD]) != 0)
            s++;
        if (i == c->groups && i < MOST_GROUPS) {
            c->group[i] = row->field[BENCH_SCENE];
            c->within[i] = row->field[BENCH_REGIME];
            c->groups++;
        }
        if (i < c->groups && s < c->series && (!c->row[s][i] || c->row[s][i]->lanes <= row->lanes))
            c->row[s][i] = row;
    }
}

/* ---- the map ------------------------------------------------------------------------------ */

static bool is(const struct speed_row *row, const char *quantity, const char *regime)
{
    return strcmp(row->field[BENCH_QUANTITY], quantity) == 0 &&
           (!regime || strcmp(row->field[BENCH_REGIME], regime) == 0);
}

/* Wall time over cases, by the most ranks: one line in full, one refined. */
static void put_map(struct gnuplot *g, const struct speed_table *table)
{
    static const char *const line[][2] = {{"basin full", "every case"},
                                          {"basin refined", "refined"}};
    int ranks = 0;
    struct plot_range cases = PLOT_NOTHING, time = PLOT_NOTHING;
    char text[96];

    for (size_t k = 0; k < table->rows; k++)
        if (is(&table->row[k], "wall time", NULL) && table->row[k].ranks > ranks)
            ranks = table->row[k].ranks;
    for (size_t k = 0; k < table->rows; k++) {
        const struct speed_row *row = &table->row[k];
        if (is(row, "wall time", NULL) && row->ranks == ranks) {
            plot_widen(&cases, log10(row->cases));
            widen(&time, row);
        } else if (is(row, "parallel efficiency", NULL) && row->ranks > 1) {
            gnuplot_note(g, "parallel efficiency of %d ranks: %.0f %% (%.0f ... %.0f)", row->ranks,
                         100 * row->median, 100 * row->lowest, 100 * row->highest);
        }
    }
    if (!(cases.low <= cases.high))
        return;
    snprintf(text, sizeof text, "wall time on %d rank%s", ranks, &"s"[ranks == 1]);
    begin_panel(g, "The shipped map, basin_one_foot", "map");
    gnuplot_axis(g, 'x', PLOT_LOG, plot_roomy(cases, 0.1), "cases of the stability map", "");
    gnuplot_axis(g, 'y', PLOT_LOG, plot_roomy(time, 0.1), text, "s");
    for (size_t m = 0; m < 2; m++) {
        const char *const hue = gnuplot_hue(m);
        bool any = false;
        for (size_t k = 0; k < table->rows; k++) {
            const struct speed_row *row = &table->row[k];
            if (!is(row, "wall time", line[m][0]) || row->ranks != ranks)
                continue;
            if (!any) {
                gnuplot_legend(g, hue, 1, gnuplot_mark(0), line[m][1], "");
                gnuplot_series(g,
                               "using 1:2 with lines lc rgb %s lw 1.6 notitle, '' using 1:2:3:4 "
                               "with yerrorbars lc rgb %s pt 7 ps 0.8 lw 1 notitle, '' using "
                               "1:2:(digits(10**$2)) with labels font ',9' right offset -0.8,0.7",
                               hue, hue);
            }
            put_row(g, log10(row->cases), row);
            any = true;
        }
    }
}

bool speed_plot(const struct speed_table *table, const struct plot *plot)
{
    struct chart rivals, methods;
    struct gnuplot g;
    const struct speed_row *row = &table->row[0];
    char heading[120];

    if (!gnuplot_begin(&g, plot, "", NULL))
        return false;
    gnuplot_say(
        &g, "Steps of 1 ms. Medians; bars from the lowest to the highest. %s, %s, revision %s, %s.",
        row->field[BENCH_PROCESSOR], row->field[BENCH_COMPILER], row->field[BENCH_REVISION],
        row->field[BENCH_DATE]);
    gnuplot_set(&g, "chart_width = 900\narray rivals[4] = [shade(0x000000), shade(0x8a8a8a), "
                    "shade(0xb2dcf5), shade(0x003f63)]");
    gnuplot_set(&g, "digits(v) = v < 9.95 ? sprintf('%%.1f', v) : v < 9995 ? sprintf('%%.0f', v) : "
                    "sprintf('%%.0fk', v/1000)");
    make_rivals(table, &rivals);
    make_methods(table, &methods);
    snprintf(heading, sizeof heading,
             "%s, implicit: one lane and more, beside the step written by hand and MuJoCo",
             rivals_scene(table)->name);
    put_chart(&g, &rivals, heading, "step",
              " notitle, '' using 1:4:(digits(10**$2)) with labels font ',8' offset 0,0.5");
    put_chart(&g, &methods, "Every method in every scene, in the widest instruction set", "methods",
              "");
    put_map(&g, table);
    gnuplot_needs(&g, g.panels > 0 || complain(plot->message, "it has nothing that is drawn"));
    return gnuplot_end(&g);
}
