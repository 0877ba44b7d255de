/* plot_speed.c - the speed benchmarks on one canvas: the biped's step beside other programs', every
 * method in every scene, and the wall time of a whole map.
 */
#include "speed.h"

#include "analysis/draw/plot.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

GNUPLOT_SCRIPT(plot_speed_gp, "analysis/bench/plot_speed.gp");

enum { MOST_SERIES = 16, MOST_GROUPS = 32 };

/* Bars side by side: series within groups. */
struct chart {
    size_t series, groups;
    const char *name[MOST_SERIES];
    unsigned colour[MOST_SERIES];
    const char *group[MOST_GROUPS];  /* line under the bars ... */
    const char *within[MOST_GROUPS]; /* ... and under that, or NULL */
    const struct speed_row *row[MOST_SERIES][MOST_GROUPS];
};

static void add_series(struct chart *c, const char *name, unsigned colour)
{
    if (c->series < MOST_SERIES) {
        c->name[c->series] = name;
        c->colour[c->series++] = colour;
    }
}

/* Tells the script of a chart `which`: names, colours, groups, and $which<series>: group, median,
 * lowest, highest. Series without rows keep their place but are not drawn. */
static void put_chart(struct gnuplot *g, const struct chart *c, const char *which)
{
    double low = INFINITY, most = 0;
    gnuplot_set(g, "%s_series = %zu\n%s_groups = %zu", which, c->series, which, c->groups);
    gnuplot_set(g, "array %s_name[%d]; array %s_colour[%d]; array %s_drawn[%d]", which, MOST_SERIES,
                which, MOST_SERIES, which, MOST_SERIES);
    gnuplot_set(g, "array %s_group[%d]; array %s_within[%d]", which, MOST_GROUPS, which,
                MOST_GROUPS);
    for (size_t i = 0; i < c->groups; i++) {
        gnuplot_tic(g, c->group[i], "%s_group[%zu]", which, i + 1);
        gnuplot_tic(g, c->within[i] ? c->within[i] : "", "%s_within[%zu]", which, i + 1);
    }
    for (size_t s = 0; s < c->series; s++) {
        bool any = false;
        for (size_t i = 0; i < c->groups; i++)
            any |= c->row[s][i] != NULL;
        gnuplot_text(g, c->name[s], "%s_name[%zu]", which, s + 1);
        gnuplot_set(g, "%s_colour[%zu] = 0x%06x; %s_drawn[%zu] = %d", which, s + 1, c->colour[s],
                    which, s + 1, any);
        gnuplot_block(g, "%s%zu", which, s + 1);
        for (size_t i = 0; i < c->groups; i++) {
            const struct speed_row *row = c->row[s][i];
            if (row) {
                low = fmin(low, row->lowest);
                most = fmax(most, row->highest);
                GNUPLOT_ROW(g, (double)i, row->median, row->lowest, row->highest);
            }
        }
    }
    gnuplot_set(g, "%s_low = %#.10g; %s_high = %#.10g", which, low < most ? low : 2, which,
                low < most ? most : 5);
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
        const char *name, *subject, *isa;
        unsigned colour;
    } series[] = {{"MuJoCo, default", "mujoco default", "", 0x000000},
                  {"MuJoCo, trimmed", "mujoco trimmed", "", 0x8a8a8a},
                  {"1 lane", "stance", "scalar", 0xb2dcf5},
                  {"by hand", "scalar by hand", "scalar", 0xe69f00},
                  {"SSE2", "stance", "sse2", 0x56b4e9},
                  {"NEON", "stance", "neon", 0x56b4e9},
                  {"AVX2", "stance", "avx2", 0x0072b2},
                  {"AVX-512", "stance", "avx512", 0x003f63}};
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
    for (; c->groups < MOST_GROUPS && scene->workload[c->groups].name; c->groups++)
        c->group[c->groups] = scene->workload[c->groups].name;
}

/* After Okabe and Ito (2008). */
static const unsigned colours[] = {0x0072b2, 0x56b4e9, 0x009e73, 0xd55e00,
                                   0xcc79a7, 0xe69f00, 0x000000};

/* Every method in every scene, in as many lanes as there are. */
static void make_methods(const struct speed_table *table, struct chart *c)
{
    *c = (struct chart){0};
    for (size_t m = 0; stance_methods()[m]; m++)
        add_series(c, stance_methods()[m]->name, colours[m % (sizeof colours / sizeof colours[0])]);
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

/* Wall time over cases: one line in full, one refined. */
static const char *const map_names[] = {"basin full", "basin refined"};

/* $map<line>: cases, median, lowest, highest. */
static void put_map(struct gnuplot *g, const struct speed_table *table)
{
    int ranks = 0; /* the most */
    struct plot_range cases = PLOT_NOTHING, time = PLOT_NOTHING;
    char text[96] = "";

    for (size_t k = 0; k < table->rows; k++) {
        const struct speed_row *row = &table->row[k];
        if (strcmp(row->field[BENCH_QUANTITY], "wall time") == 0 && row->ranks > ranks)
            ranks = row->ranks;
        if (strcmp(row->field[BENCH_QUANTITY], "parallel efficiency") == 0 && row->ranks > 1)
            snprintf(text, sizeof text, "parallel efficiency of %d ranks: %.0f %% (%.0f ... %.0f)",
                     row->ranks, 100 * row->median, 100 * row->lowest, 100 * row->highest);
    }
    gnuplot_text(g, text, "efficiency");
    gnuplot_set(g, "map_ranks = %d; array map_drawn[2]", ranks);
    for (size_t m = 0; m < 2; m++) {
        bool any = false;
        gnuplot_block(g, "map%zu", m + 1);
        for (size_t k = 0; k < table->rows; k++) {
            const struct speed_row *row = &table->row[k];
            if (strcmp(row->field[BENCH_QUANTITY], "wall time") != 0 ||
                strcmp(row->field[BENCH_REGIME], map_names[m]) != 0 || row->ranks != ranks)
                continue;
            GNUPLOT_ROW(g, row->cases, row->median, row->lowest, row->highest);
            plot_widen(&cases, row->cases);
            plot_widen(&time, row->lowest);
            plot_widen(&time, row->highest);
            any = true;
        }
        gnuplot_set(g, "map_drawn[%zu] = %d", m + 1, any);
    }
    if (!(cases.low <= cases.high))
        cases = time = (struct plot_range){1, 1};
    gnuplot_set(g, "fewest = %#.10g; most = %#.10g; shortest = %#.10g; longest = %#.10g", cases.low,
                cases.high, time.low, time.high);
}

bool speed_plot(const struct speed_table *table, const struct plot *plot)
{
    struct chart rivals, methods;
    struct gnuplot g;
    const struct speed_row *row = &table->row[0];

    if (!gnuplot_begin(&g, plot, "", plot_speed_gp))
        return false;
    gnuplot_say(
        &g, "Steps of 1 ms. Medians; bars from the lowest to the highest. %s, %s, revision %s, %s.",
        row->field[BENCH_PROCESSOR], row->field[BENCH_COMPILER], row->field[BENCH_REVISION],
        row->field[BENCH_DATE]);
    make_rivals(table, &rivals);
    make_methods(table, &methods);
    gnuplot_text(&g, rivals_scene(table)->name, "rivals_scene");
    put_chart(&g, &rivals, "rivals");
    put_chart(&g, &methods, "methods");
    put_map(&g, table);
    return gnuplot_end(&g);
}
