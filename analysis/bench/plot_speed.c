/* plot_speed.c - the speed benchmarks on one canvas: the biped's step beside other programs', every
 * method in every scene, and the wall time of a whole map.
 */
#include "speed.h"

#include "analysis/draw/gnuplot.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum {
    WIDTH = 1240,
    LEFT = 100,
    UPPER = 330,
    LOWER = 290,
    RIVALS = 690,
    MAP_LEFT = 900,
    MAP = 310
};
enum { LEGEND_ROW = 20, TICS = 64, MOST_SERIES = 16, MOST_GROUPS = 32 };

/* After Okabe and Ito (2008). */
static const char *const colours[] = {"#0072b2", "#56b4e9", "#009e73", "#d55e00",
                                      "#cc79a7", "#e69f00", "#000000"};

/* Bars side by side: series within groups. */
struct chart {
    size_t series, groups;
    const char *name[MOST_SERIES], *colour[MOST_SERIES];
    const char *group[MOST_GROUPS];  /* line under the bars ... */
    const char *within[MOST_GROUPS]; /* ... and under that, or NULL */
    const struct speed_row *row[MOST_SERIES][MOST_GROUPS];
    bool numbers; /* written above the bars */
};

static void add_series(struct chart *c, const char *name, const char *colour)
{
    if (c->series < MOST_SERIES) {
        c->name[c->series] = name;
        c->colour[c->series++] = colour;
    }
}

/* A number with two or three digits. */
static void short_number(char text[16], double value)
{
    if (value < 9.95)
        snprintf(text, 16, "%.1f", value);
    else if (value < 9995)
        snprintf(text, 16, "%.0f", value);
    else
        snprintf(text, 16, "%.0fk", value / 1000);
}

/* Data of one series: place, median, lowest, highest, the median in words. */
static void put_series(struct gnuplot *g, const struct chart *c, size_t s, double width,
                       char name[32])
{
    FILE *data = gnuplot_data(g, name);
    for (size_t i = 0; i < c->groups; i++) {
        const struct speed_row *row = c->row[s][i];
        if (row) {
            char text[16];
            short_number(text, row->median);
            fprintf(data, "%.4f %.6g %.6g %.6g %s\n",
                    (double)i + width * ((double)s - 0.5 * (double)(c->series - 1)), row->median,
                    row->lowest, row->highest, text);
        }
    }
    gnuplot_close_data(g, data);
}

static bool has_series(const struct chart *c, size_t s)
{
    bool any = false;
    for (size_t i = 0; i < c->groups; i++)
        any |= c->row[s][i] != NULL;
    return any;
}

static void put_chart(struct gnuplot *g, const struct chart *c, double left, double top,
                      double wide, double high)
{
    char name[MOST_SERIES][32];
    const double width = 0.86 / (double)c->series;
    double low = INFINITY, most = 0;
    bool any = false;

    for (size_t s = 0; s < c->series; s++) {
        put_series(g, c, s, width, name[s]);
        for (size_t i = 0; i < c->groups; i++) {
            if (c->row[s][i]) {
                low = fmin(low, c->row[s][i]->lowest);
                most = fmax(most, c->row[s][i]->highest);
            }
        }
    }
    gnuplot_panel(g, left, top, wide, high);
    fprintf(g->script,
            "set logscale y; set format y '%%g'; set grid y lc '#e4e4e4' lw 0.6\n"
            "set xrange [-0.5:%g]; set yrange [%g:%g]\n"
            "set ylabel 'nanoseconds per case-step of one core' font ',10'\nset tics font ',10'\n"
            "set xtics scale 0 (",
            (double)c->groups - 0.5, low < most ? 0.5 * low : 1, low < most ? 2.2 * most : 10);
    for (size_t i = 0; i < c->groups; i++) {
        fputs(i ? ", " : "", g->script);
        gnuplot_text(g->script, c->group[i], 0);
        if (c->within[i]) {
            fputs(".\"\\n\".", g->script);
            gnuplot_text(g->script, c->within[i], 0);
        }
        fprintf(g->script, " %zu", i);
    }
    fputs(")\nplot ", g->script);
    for (size_t s = 0; s < c->series; s++) {
        if (!has_series(c, s))
            continue;
        fprintf(g->script,
                "%s'%s' using 1:2:(%g) with boxes fs solid 0.9 border lc rgb '%s' lc rgb '%s' lw "
                "0.5 notitle, '%s' using 1:3:(0):($4-$3) with vectors nohead lc rgb '#303030' "
                "lw 1.2 notitle",
                any ? ", " : "", name[s], 0.9 * width, c->colour[s], c->colour[s], name[s]);
        if (c->numbers) {
            fprintf(g->script,
                    ", '%s' using 1:($4*1.06):5 with labels font ',8' center offset 0,0.5 notitle",
                    name[s]);
        }
        any = true;
    }
    fputs(any ? "\n" : "NaN notitle\n", g->script);
    fputs("unset logscale; unset grid; unset ylabel; set xtics autofreq\n", g->script);
}

/* Of one series after the other; the width that DejaVu Sans needs. */
static void put_legends(struct gnuplot *g, const struct chart *c, double x, double y)
{
    for (size_t s = 0; s < c->series; s++) {
        if (has_series(c, s)) {
            gnuplot_legend(g, x, y, c->colour[s], c->name[s]);
            x += 38 + 8.7 * (double)strlen(c->name[s]);
        }
    }
}

/* ---- the charts --------------------------------------------------------------------------- */

static const char *const step_time = "time per step";

/* The biped's implicit step in every instruction set beside what others need. */
static void make_rivals(const struct speed_table *table, struct chart *c)
{
    static const struct {
        const char *name, *subject, *isa, *colour;
    } series[] = {{"MuJoCo, default", "mujoco default", "", "#000000"},
                  {"MuJoCo, trimmed", "mujoco trimmed", "", "#8a8a8a"},
                  {"1 lane", "stance", "scalar", "#b2dcf5"},
                  {"by hand", "scalar by hand", "scalar", "#e69f00"},
                  {"SSE2", "stance", "sse2", "#56b4e9"},
                  {"NEON", "stance", "neon", "#56b4e9"},
                  {"AVX2", "stance", "avx2", "#0072b2"},
                  {"AVX-512", "stance", "avx512", "#003f63"}};
    static const char *const regimes[] = {"flight", "one foot", "two feet"};

    *c = (struct chart){.numbers = true};
    for (size_t s = 0; s < sizeof series / sizeof series[0]; s++) {
        const bool own = strcmp(series[s].isa, "") != 0;
        if (!speed_find(table, series[s].subject, "biped", NULL, own ? "implicit" : NULL,
                        own ? series[s].isa : NULL, step_time))
            continue; /* takes no room */
        add_series(c, series[s].name, series[s].colour);
        for (size_t i = 0; i < sizeof regimes / sizeof regimes[0]; i++) {
            c->row[c->series - 1][i] =
                speed_find(table, series[s].subject, "biped", regimes[i], own ? "implicit" : NULL,
                           series[s].isa, step_time);
        }
    }
    for (size_t i = 0; i < sizeof regimes / sizeof regimes[0]; i++)
        c->group[c->groups++] = regimes[i];
}

/* Every method in every scene, in as many lanes as there are. */
static void make_methods(const struct speed_table *table, struct chart *c)
{
    *c = (struct chart){0};
    for (size_t m = 0; stance_methods()[m]; m++)
        add_series(c, stance_methods()[m]->name, colours[m % (sizeof colours / sizeof colours[0])]);
    for (size_t k = 0; k < table->rows; k++) {
        const struct speed_row *row = &table->row[k];
        if (strcmp(row->subject, "stance") != 0 || strcmp(row->quantity, step_time) != 0)
            continue;
        size_t i = 0, s = 0;
        while (i < c->groups &&
               (strcmp(c->group[i], row->scene) != 0 || strcmp(c->within[i], row->regime) != 0))
            i++;
        while (s < c->series && strcmp(c->name[s], row->method) != 0)
            s++;
        if (i == c->groups && i < MOST_GROUPS) {
            c->group[i] = row->scene;
            c->within[i] = row->regime;
            c->groups++;
        }
        if (i < c->groups && s < c->series && (!c->row[s][i] || c->row[s][i]->lanes <= row->lanes))
            c->row[s][i] = row;
    }
}

/* ---- the map ------------------------------------------------------------------------------ */

/* Wall time over cases: one line in full, one refined. */
static const char *const map_names[] = {"basin full", "basin refined"};
static const char *const map_texts[] = {"every case", "refined"};
static const char *const map_colours[] = {"#0072b2", "#d55e00"};

static bool is_map(const struct speed_row *row, size_t m, int ranks)
{
    return strcmp(row->quantity, "wall time") == 0 && strcmp(row->regime, map_names[m]) == 0 &&
           row->ranks == ranks;
}

static int map_ranks(const struct speed_table *table)
{
    int ranks = 0;
    for (size_t k = 0; k < table->rows; k++) {
        const struct speed_row *row = &table->row[k];
        if (strcmp(row->quantity, "wall time") == 0 && row->ranks > ranks)
            ranks = row->ranks;
    }
    return ranks;
}

static void put_map(struct gnuplot *g, const struct speed_table *table, double top)
{
    const int ranks = map_ranks(table);
    double fewest = INFINITY, most = 0, shortest = INFINITY, longest = 0;
    char name[2][32];
    bool any = false;

    gnuplot_panel(g, MAP_LEFT, top, MAP, UPPER);
    fputs("set logscale xy; set xtics (", g->script);
    for (size_t k = 0; k < table->rows; k++) {
        const struct speed_row *row = &table->row[k];
        if (!is_map(row, 0, ranks) && !is_map(row, 1, ranks))
            continue;
        fprintf(g->script, "%s'%.0f²' %d", most > 0 ? ", " : "", sqrt(row->cases), row->cases);
        fewest = fmin(fewest, row->cases);
        most = fmax(most, row->cases);
        shortest = fmin(shortest, row->lowest);
        longest = fmax(longest, row->highest);
    }
    fprintf(g->script,
            ")\nset xrange [%g:%g]; set yrange [%g:%g]; set format y '%%g'\n"
            "set grid lc '#e4e4e4' lw 0.6; set tics font ',10'\n"
            "set xlabel 'cases of the stability map' font ',10'\n"
            "set ylabel 'wall time of the program on %d rank%s, s' font ',10'\nplot ",
            0.5 * fewest, 2 * most, 0.4 * shortest, 2.5 * longest, ranks, ranks == 1 ? "" : "s");
    for (size_t m = 0; m < 2; m++) {
        FILE *data = gnuplot_data(g, name[m]);
        bool some = false;
        for (size_t k = 0; k < table->rows; k++) {
            const struct speed_row *row = &table->row[k];
            if (is_map(row, m, ranks)) {
                char text[16];
                short_number(text, row->median);
                fprintf(data, "%d %.6g %.6g %.6g %s\n", row->cases, row->median, row->lowest,
                        row->highest, text);
                some = true;
            }
        }
        gnuplot_close_data(g, data);
        if (some) {
            fprintf(g->script,
                    "%s'%s' using 1:2 with lines lc rgb '%s' lw 1.6 notitle, '' using 1:2:3:4 with "
                    "yerrorbars lc rgb '%s' pt 7 ps 0.8 lw 1 notitle, '' using 1:2:5 with labels "
                    "font ',9' right offset -0.8,0.7 notitle",
                    any ? ", " : "", name[m], map_colours[m], map_colours[m]);
            any = true;
        }
    }
    fputs(any ? "\n" : "NaN notitle\n", g->script);
    fputs("unset logscale; unset grid; unset xlabel; unset ylabel\n", g->script);
}

static void put_map_legend(struct gnuplot *g, const struct speed_table *table, double y)
{
    double x = MAP_LEFT;
    for (size_t m = 0; m < 2; m++) {
        if (speed_find(table, NULL, NULL, map_names[m], NULL, NULL, "wall time")) {
            gnuplot_legend(g, x, y, map_colours[m], map_texts[m]);
            x += 120;
        }
    }
    for (size_t k = 0; k < table->rows; k++) {
        const struct speed_row *row = &table->row[k];
        if (strcmp(row->quantity, "parallel efficiency") == 0 && row->ranks > 1) {
            char text[96];
            snprintf(text, sizeof text, "parallel efficiency of %d ranks: %.0f %% (%.0f ... %.0f)",
                     row->ranks, 100 * row->median, 100 * row->lowest, 100 * row->highest);
            gnuplot_label(g, MAP_LEFT + MAP - 8, y + LEGEND_ROW + UPPER - 20, text, "right", 9,
                          false);
        }
    }
}

bool speed_plot(const struct speed_table *table, const char *directory, const char *stem,
                stance_message *message)
{
    struct chart rivals, methods;
    struct gnuplot g;
    char subtitle[400];
    const struct speed_row *row = &table->row[0];

    snprintf(
        subtitle, sizeof subtitle,
        "Steps of 1 ms. Medians; bars from the lowest to the highest. %s, %s, revision %s, %s.",
        row->processor, row->compiler, row->revision, row->date);
    const char *const title = "Speed of the stepping kernels";
    const int top = gnuplot_title_height(WIDTH, title, subtitle) + 2 * LEGEND_ROW + 8;
    const int second = top + UPPER + TICS + 2 * LEGEND_ROW + 8;
    make_rivals(table, &rivals);
    make_methods(table, &methods);
    if (!gnuplot_begin(&g, WIDTH, second + LOWER + TICS, message))
        return false;
    gnuplot_title(&g, title, subtitle);
    gnuplot_label(&g, LEFT, top - 2 * LEGEND_ROW - 2,
                  "Biped, implicit: one lane and more, beside the step written by hand and MuJoCo",
                  "left", 12, false);
    put_legends(&g, &rivals, LEFT, top - LEGEND_ROW + 4);
    if (map_ranks(table) > 0) {
        gnuplot_label(&g, MAP_LEFT, top - 2 * LEGEND_ROW - 2, "The shipped map, basin_one_foot",
                      "left", 12, false);
        put_map_legend(&g, table, top - LEGEND_ROW + 4);
    }
    gnuplot_label(&g, LEFT, second - 2 * LEGEND_ROW - 2,
                  "Every method in every scene, in the widest instruction set", "left", 12, false);
    put_legends(&g, &methods, LEFT, second - LEGEND_ROW + 4);
    gnuplot_decorate(&g);
    if (rivals.series > 0)
        put_chart(&g, &rivals, LEFT, top, RIVALS, UPPER);
    if (map_ranks(table) > 0)
        put_map(&g, table, top);
    if (methods.groups > 0)
        put_chart(&g, &methods, LEFT, second, WIDTH - LEFT - 30, LOWER);
    return gnuplot_end(&g, directory, stem, message);
}
