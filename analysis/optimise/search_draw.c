/* search_draw.c - chooses the pictures of searches. */
#include "search_front.h"
#include "search_pictures.h"

#include "runner/plan/allowed.h"

const struct search_style search_styles[SEARCH_CURVES] = {
    {"hue[2]", "first candidate", 2, 5},
    {"hue[1]", "chosen", 1, 7},
    {"hue[3]", "allowed by linear theory", 4, 9}};

void search_curve_put(struct gnuplot *g, enum search_curve curve,
                      const struct search_curve_row *row, size_t rows, double size)
{
    const struct search_style *const style = &search_styles[curve];
    gnuplot_series(g,
                   "using 1:2 with lines lc rgb %s dt %d lw 2 notitle, '' using 1:2:3:4 with "
                   "yerrorbars lc rgb %s pt %d ps %g lw 1.4",
                   style->colour, style->dash, style->colour, style->point, size);
    for (size_t i = 0; i < rows; i++)
        GNUPLOT_ROW(g, row[i].x, row[i].share, 100 * row[i].interval.low,
                    100 * row[i].interval.high);
}

void search_curves_write(struct gnuplot *g, const char *const more[SEARCH_CURVES], bool glued)
{
    for (int k = 0; k < SEARCH_CURVES; k++)
        if (more[k])
            gnuplot_legend(g, search_styles[k].colour, search_styles[k].dash, 0,
                           search_styles[k].name, more[k]);
    if (glued && more[SEARCH_ALLOWED])
        gnuplot_note(g, "allowed: " ALLOWED_GLUED);
}

static bool (*const pictures[])(const struct search_study *, const struct plot *) = {
#define PICTURE(name, help) plot_search_##name,
    SEARCH_PICTURES(PICTURE)
#undef PICTURE
};

/* How the pictures of a search are titled and called. */
static void name_plot(struct plot *plot, const struct search_study *study)
{
    plot->title = study->f.title[0] ? study->f.title : study->name;
    plot->stem = study->name;
}

int search_draw(struct look *look, const char *const *file, size_t files)
{
    struct search_study study;
    struct search_front front;
    stance_message message = {""};
    bool good = false;
    char own[1024];
    struct plot plot = {.directory = look_directory(look, file[0], own, sizeof own),
                        .look = look,
                        .message = &message};
    if (!gnuplot_directory(plot.directory))
        return EXIT_IO;
    if (files == 1 && (good = search_study_open(&study, file[0], &message))) {
        name_plot(&plot, &study);
        for (size_t k = 0; good && k < sizeof pictures / sizeof *pictures; k++)
            good = pictures[k](&study, &plot);
        search_study_close(&study);
    } else if (files > 1 && (good = search_front_open(&front, file, files, &message))) {
        name_plot(&plot, &front.study[0]);
        good = plot_search_front(&front, &plot);
        search_front_close(&front);
    }
    if (!good)
        fprintf(stderr, "%s\n", message.text);
    return good ? EXIT_DONE : EXIT_IO;
}
