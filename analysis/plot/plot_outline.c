/* plot_outline.c - the domains of an outcome over the same two axes in one frame: an outline for
 * each file, and in it for each value of the other axes. */
#include "boundary.h"
#include "plot_layout.h"
#include "runner/base/message.h"

#include <math.h>
#include <string.h>

/* Each has a pair of dashes and marks of its own. */
enum { MOST_OUTLINES = 14, DASHES = 5 };
static const int marks[] = {0, 7, 4}; /* types of gnuplot's points: none, discs, squares */
_Static_assert(MOST_OUTLINES <= DASHES * sizeof marks / sizeof marks[0], "outlines look alike");

struct page {
    struct gnuplot g;
    const struct plot *plots;                 /* [files] */
    struct plot_layout layout[MOST_OUTLINES]; /* [files] */
    struct plot_range range[2];               /* that hold all maps */
    enum plot_scale scale[2];                 /* that all files can have */
    const char *swept; /* the one axis that outlines differ in, beside files; NULL: none, several */
    int files, outlines;
    enum results_kind of;
};

static const struct results_axis *axis_of(const struct page *page, int f, int k)
{
    const struct plot_layout *const layout = &page->layout[f];
    return &layout->r->axis[k == 0 ? layout->x : layout->y];
}

/* ---- axes --------------------------------------------------------------------------------- */

/* Whether a file has a map, over the axes of the first one. */
static bool check_file(struct page *page, int f)
{
    stance_message *const message = page->plots[0].message;
    const struct results *const r = page->plots[f].r;
    if (r->single || r->axes < 2 || r->sample >= 0)
        return complain(message, "%.150s: has no outline: it is no sweep over a grid of two axes",
                        r->file);
    plot_layout_make(&page->layout[f], r, MOST_OUTLINES / page->files);
    for (int k = 0; k < 2; k++) {
        const struct results_axis *const own = axis_of(page, f, k), *const of = axis_of(page, 0, k);
        bool same = strcmp(own->name, of->name) == 0 && !own->word == !of->word &&
                    (!own->word || own->count == of->count);
        for (size_t i = 0; same && own->word && i < own->count; i++)
            same = strcmp(own->word[i], of->word[i]) == 0;
        if (!same)
            return complain(message, "%.70s: its map is over %.30s, that of %.70s over %.30s",
                            r->file, own->name, page->plots[0].r->file, of->name);
    }
    return true;
}

/* An axis of a file's map on the page's scale. */
static struct plot_axis on_page(const struct page *page, int f, int k)
{
    struct plot_axis along;
    plot_axis_make_curve(&along, axis_of(page, f, k));
    along.scale = page->scale[k];
    along.range = page->range[k];
    return along;
}

/* The scale and the range that hold all maps. */
static void choose_scale(struct page *page, int k)
{
    struct plot_range range = PLOT_NOTHING;
    page->scale[k] = PLOT_LOG;
    for (int f = 0; f < page->files; f++) {
        struct plot_axis along;
        plot_axis_make_curve(&along, axis_of(page, f, k));
        page->scale[k] = along.scale == PLOT_LOG ? page->scale[k] : along.scale;
    }
    for (int f = 0; f < page->files; f++) {
        const struct plot_axis along = on_page(page, f, k);
        for (size_t i = 0; i < along.axis->count; i++)
            plot_widen(&range, plot_axis_place(&along, i));
    }
    page->range[k] = plot_roomy(range, 0);
}

/* ---- outlines ----------------------------------------------------------------------------- */

/* A panel of a file, whose cases are counted from left to right and from below. */
struct panel {
    const struct plot_layout *layout;
    int number;
    struct statistics_place *points[2];
    size_t count[2];
};

/* A place between the values of an axis, from left to right. */
static double between(const struct panel *panel, int k, double at)
{
    const struct statistics_place *const points = panel->points[k];
    const size_t i = at < 0 ? 0 : (size_t)at, next = i + 1 < panel->count[k] ? i + 1 : i;
    return points[i].value + (at - (double)i) * (points[next].value - points[i].value);
}

static void put_lines(struct page *page, const struct boundary *b, const struct panel *panel)
{
    const size_t hue = (size_t)page->outlines - 1, mark = hue / DASHES;
    gnuplot_series(&page->g, "using 1:2 with linespoints lw 2.2 dt %d lc rgb %s pt %d pn 12 ps 1.1",
                   (int)(hue % DASHES) + 1, gnuplot_hue(hue), marks[mark] ? marks[mark] : -1);
    for (size_t l = 0; l < b->lines; l++) {
        const struct boundary_line *const line = &b->line[l];
        for (size_t k = 0; k < line->count + line->closed; k++) {
            const double *const at = b->point[line->first + k % line->count];
            GNUPLOT_ROW(&page->g, between(panel, 0, at[0]), between(panel, 1, at[1]));
        }
        gnuplot_gap(&page->g);
    }
}

/* Which cases of a panel are inside; NULL: no memory. */
static uint8_t *find_inside(struct page *page, const struct panel *panel)
{
    const struct results *const r = panel->layout->r;
    uint8_t *const inside = gnuplot_room(&page->g, panel->count[0] * panel->count[1], 1);
    for (size_t j = 0; inside && j < panel->count[1]; j++) {
        for (size_t i = 0; i < panel->count[0]; i++) {
            const uint64_t index = plot_layout_index(
                panel->layout, panel->number, panel->points[0][i].index, panel->points[1][j].index);
            inside[j * panel->count[0] + i] = r->kind[index] == page->of;
        }
    }
    return inside;
}

/* "place, friction = 0.2", or the file's name before it. */
static void put_legend(struct page *page, const struct panel *panel)
{
    const size_t k = (size_t)page->outlines - 1;
    char values[300], name[400], more[32];
    plot_panel_title(&page->g, panel->layout, panel->number,
                     page->swept ? PLOT_VALUES_ALONE : PLOT_NAMES, values, sizeof values);
    if (page->files == 1)
        snprintf(name, sizeof name, "%s", values[0] ? values : results_kind_names[page->of]);
    else
        snprintf(name, sizeof name, "%s%s%s",
                 look_label(page->g.plot->look, panel->layout->r->name), values[0] ? ", " : "",
                 values);
    snprintf(more, sizeof more, "%.1f %%",
             fmax(0, plot_layout_share(panel->layout, panel->number, page->of)));
    gnuplot_legend(&page->g, gnuplot_hue(k), (int)k % DASHES + 1, marks[k / DASHES], name, more);
}

static void put_outline(struct page *page, int f, int number)
{
    struct gnuplot *const g = &page->g;
    struct panel panel = {.layout = &page->layout[f], .number = number};
    struct boundary b = {0};
    for (int k = 0; k < 2; k++) {
        const struct plot_axis along = on_page(page, f, k);
        panel.count[k] = along.axis->count;
        panel.points[k] = plot_axis_points(&along, g);
    }
    const uint8_t *const inside =
        panel.points[0] && panel.points[1] ? find_inside(page, &panel) : NULL;
    if (!inside || !gnuplot_needs(g, boundary_trace(&b, inside, panel.count[0], panel.count[1],
                                                    g->plot->message)))
        return;
    page->outlines++;
    put_lines(page, &b, &panel);
    put_legend(page, &panel);
    boundary_free(&b);
}

/* ---- what linear theory allows -------------------------------------------------------------- */

/* A line in the colour of each outline, or one for all where that is the same. */
static void put_allowed(struct page *page)
{
    struct plot_allowed_panel panel[MOST_OUTLINES] = {0};
    int count = 0;
    bool same = true;
    for (int f = 0; f < page->files; f++) {
        struct plot_allowed allowed;
        const struct plot_axis along[] = {on_page(page, f, 0), on_page(page, f, 1)};
        if (!plot_allowed_make(&allowed, &page->g, &page->layout[f], along))
            return;
        for (int k = 0; k < page->layout[f].panels; k++)
            panel[count++] =
                allowed.panels > 0 ? allowed.panel[k] : (struct plot_allowed_panel){.share = NAN};
    }
    for (int k = 1; k < count; k++)
        same = same && plot_allowed_same(&panel[0], &panel[k]);
    for (int k = 0; k < (same ? 1 : count); k++) {
        char style[60] = "lw 2 dt 11 lc rgb colour_allowed";
        if (!same)
            snprintf(style, sizeof style, "lw 0.8 dt %d lc rgb %s", k % DASHES + 1,
                     gnuplot_hue((size_t)k));
        if (panel[k].points > 0)
            plot_allowed_write(&panel[k], &page->g, style);
    }
    plot_allowed_legend(panel, count, same ? PLOT_ALLOWED_ONE : PLOT_ALLOWED_EACH, &page->g);
}

/* ---- the page ----------------------------------------------------------------------------- */

static const char *find_swept(const struct page *page)
{
    const char *swept = NULL;
    for (int f = 0; f < page->files; f++) {
        const struct plot_layout *const layout = &page->layout[f];
        const char *const own = layout->others > 0 ? layout->r->axis[layout->other[0]].name : NULL;
        if (layout->others > 1 || (swept && own && strcmp(swept, own) != 0))
            return NULL;
        swept = own ? own : swept;
    }
    return swept;
}

static void put(struct page *page)
{
    struct gnuplot *const g = &page->g;
    bool cross = true;
    double zero;
    gnuplot_say(g, "Outlines of where the outcome is: %s; beside them its share of cases",
                results_kind_names[page->of]);
    for (int k = 0; k < 2; k++) {
        choose_scale(page, k);
        const struct plot_axis along = on_page(page, 0, k);
        plot_axis_write(&along, g, k == 0 ? 'x' : 'y');
        cross = cross && plot_zero_place(&along, &zero);
    }
    page->swept = find_swept(page); /* what the values in the legend are of */
    const char *const swept = page->swept ? look_label(g->plot->look, page->swept) : "";
    char head[200];
    snprintf(head, sizeof head, "%s%s", swept[0] && page->files > 1 ? "file, " : "", swept);
    gnuplot_text(g, head, "legend_head");
    gnuplot_set(g, "chart_width = 560; scaled = 1");
    gnuplot_panel(g, 500, "");
    for (int f = 0; f < page->files; f++) {
        for (int p = 0; p < page->layout[f].panels; p++)
            put_outline(page, f, p);
        plot_layout_note(&page->layout[f], g);
    }
    put_allowed(page);
    if (cross) {
        gnuplot_legend(g, "0x000000", 0, 1, "equilibrium", "");
        gnuplot_cross(g, 0, 0);
    }
}

bool plot_outline(const struct plot *plots, int files, enum results_kind of)
{
    struct page page = {.plots = plots, .files = files};
    struct plot plot = plots[0];
    char title[40];
    bool same = true;
    for (int f = 0; f < files; f++) {
        if (!check_file(&page, f))
            return false;
        same = same && strcmp(plots[f].r->title, plots[0].r->title) == 0;
    }
    page.of = of == RESULTS_KIND_COUNT ? statistics_judged(plots[0].r) : of;
    snprintf(title, sizeof title, "Domains of %d files", files);
    plot.title = same ? NULL : title;
    if (!gnuplot_begin(&page.g, &plot, "outline"))
        return false;
    put(&page);
    return gnuplot_end(&page.g);
}
