/* plot_outline.c - the domains of an outcome over the same two axes in one frame: an outline for
 * each file, and in it for each value of the other axes. */
#include "boundary.h"
#include "plot_allowed.h"
#include "runner/base/message.h"

#include <math.h>
#include <string.h>

GNUPLOT_SCRIPT(plot_outline_gp, "analysis/plot/plot_outline.gp");

/* Each has a pair of dashes and marks of its own. */
enum { MOST_OUTLINES = 14, DASHES = 5 };
static const int marks[] = {0, 7, 4}; /* types of gnuplot's points: none, discs, squares */
_Static_assert(MOST_OUTLINES <= DASHES * sizeof marks / sizeof marks[0], "outlines look alike");

struct page {
    struct gnuplot g;
    const struct plot *plots; /* [files] */
    int files, outlines;
    enum results_kind of;
    enum plot_scale scale[2]; /* that all files can have */
    double low[2], high[2];
    bool cross;
    const char *swept; /* the one axis that outlines differ in, beside files; NULL: none, several */
};

static const struct results_axis *axis_of(const struct results *r, const struct plot_layout *layout,
                                          int k)
{
    return &r->axis[k == 0 ? layout->x : layout->y];
}

/* ---- axes --------------------------------------------------------------------------------- */

/* Whether a file has a map, over the axes of the first one. */
static bool check_file(const struct page *page, int f, const struct plot_layout *first)
{
    stance_message *const message = page->plots[0].message;
    const struct results *const r = page->plots[f].r, *const r0 = page->plots[0].r;
    struct plot_layout layout;
    if (r->single || r->axes < 2 || r->sample >= 0)
        return complain(message, "%.150s: has no outline: it is no sweep over a grid of two axes",
                        r->file);
    plot_layout_make(&layout, r, MOST_OUTLINES);
    for (int k = 0; k < 2; k++) {
        const struct results_axis *const own = axis_of(r, &layout, k), *const of =
                                                                           axis_of(r0, first, k);
        bool same = strcmp(own->name, of->name) == 0 && !own->word == !of->word &&
                    (!own->word || own->count == of->count);
        for (size_t i = 0; same && own->word && i < own->count; i++)
            same = strcmp(own->word[i], of->word[i]) == 0;
        if (!same)
            return complain(message, "%.70s: its map is over %.30s, that of %.70s over %.30s",
                            r->file, own->name, r0->file, of->name);
    }
    return true;
}

/* An axis of a file's map on the page's scale. */
static struct plot_axis on_page(const struct page *page, const struct results_axis *axis, int k)
{
    struct plot_axis along;
    plot_axis_make_curve(&along, axis);
    along.scale = page->scale[k];
    along.low = page->low[k];
    along.high = page->high[k];
    return along;
}

/* The scales and ranges that hold all maps. */
static void choose_scales(struct page *page)
{
    const struct results_axis *axis[MOST_OUTLINES][2];
    for (int f = 0; f < page->files; f++) {
        struct plot_layout layout;
        plot_layout_make(&layout, page->plots[f].r, MOST_OUTLINES);
        for (int k = 0; k < 2; k++)
            axis[f][k] = axis_of(page->plots[f].r, &layout, k);
    }
    for (int k = 0; k < 2; k++) {
        page->scale[k] = PLOT_LOG;
        for (int f = 0; f < page->files; f++) {
            struct plot_axis along;
            plot_axis_make_curve(&along, axis[f][k]);
            page->scale[k] = along.scale == PLOT_LOG ? page->scale[k] : along.scale;
        }
        page->low[k] = INFINITY;
        page->high[k] = -INFINITY;
        for (int f = 0; f < page->files; f++) {
            const struct plot_axis along = on_page(page, axis[f][k], k);
            for (size_t i = 0; i < axis[f][k]->count; i++) {
                page->low[k] = fmin(page->low[k], plot_axis_place(&along, i));
                page->high[k] = fmax(page->high[k], plot_axis_place(&along, i));
            }
        }
        if (!(page->low[k] < page->high[k])) {
            page->low[k] -= 0.5;
            page->high[k] += 0.5;
        }
    }
}

static void put_axes(struct page *page, const struct plot_layout *layout)
{
    const struct results *const r = page->plots[0].r;
    page->cross = true;
    for (int k = 0; k < 2; k++) {
        const struct plot_axis along = on_page(page, axis_of(r, layout, k), k);
        plot_axis_write(&along, &page->g, k == 0 ? 'x' : 'y');
        page->cross = page->cross && along.axis->offset && along.scale == PLOT_LINEAR &&
                      along.low < 0 && along.high > 0;
    }
    gnuplot_set(&page->g, "cross = %d", page->cross);
}

/* ---- outlines ----------------------------------------------------------------------------- */

/* A panel of a file, whose cases are counted from left to right and from below. */
struct panel {
    const struct results *r;
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
    gnuplot_block(&page->g, "outline%d", page->outlines);
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
static uint8_t *find_inside(struct page *page, const struct panel *panel, double *share)
{
    const struct results *const r = panel->r;
    uint8_t *const inside = gnuplot_room(&page->g, panel->count[0] * panel->count[1], 1);
    size_t sum = 0, done = 0;
    for (size_t j = 0; inside && j < panel->count[1]; j++) {
        for (size_t i = 0; i < panel->count[0]; i++) {
            const uint64_t index = plot_layout_index(
                panel->layout, panel->number, panel->points[0][i].index, panel->points[1][j].index);
            inside[j * panel->count[0] + i] = r->kind[index] == page->of;
            sum += r->kind[index] == page->of;
            done += r->kind[index] < RESULTS_FAILED;
        }
    }
    *share = done > 0 ? 100 * (double)sum / (double)done : 0;
    return inside;
}

/* "place, friction = 0.2", or the file's name before it. */
static void put_legend(struct page *page, const struct panel *panel, double share)
{
    const size_t k = (size_t)page->outlines - 1;
    char values[300], name[400], more[32];
    plot_panel_title(&page->g, panel->layout, panel->number,
                     page->swept ? PLOT_VALUES_ALONE : PLOT_NAMES, values, sizeof values);
    if (page->files == 1)
        snprintf(name, sizeof name, "%s", values[0] ? values : results_kind_names[page->of]);
    else
        snprintf(name, sizeof name, "%s%s%s", look_label(page->g.plot->look, panel->r->name),
                 values[0] ? ", " : "", values);
    snprintf(more, sizeof more, "%.1f %%", share);
    gnuplot_legend(&page->g, gnuplot_hue(k), (int)k % DASHES + 1, marks[k / DASHES], name, more);
}

static void put_outline(struct page *page, struct panel panel)
{
    struct gnuplot *const g = &page->g;
    struct boundary b = {0};
    double share;
    for (int k = 0; k < 2; k++) {
        const struct plot_axis along = on_page(page, axis_of(panel.r, panel.layout, k), k);
        panel.count[k] = along.axis->count;
        panel.points[k] = plot_axis_points(&along, g);
    }
    const uint8_t *const inside =
        panel.points[0] && panel.points[1] ? find_inside(page, &panel, &share) : NULL;
    if (!inside || !gnuplot_needs(g, boundary_trace(&b, inside, panel.count[0], panel.count[1],
                                                    g->plot->message)))
        return;
    page->outlines++;
    put_lines(page, &b, &panel);
    put_legend(page, &panel, share);
    boundary_free(&b);
}

/* ---- what linear theory allows -------------------------------------------------------------- */

/* A line in the colour of each outline, or one for all where that is the same. */
static void put_allowed(struct page *page, int most)
{
    const struct plot_frame frame = {{page->scale[0], page->scale[1]},
                                     {page->low[0], page->low[1]},
                                     {page->high[0], page->high[1]}};
    struct plot_allowed_panel panel[MOST_OUTLINES];
    int count = 0;
    bool same = true;
    for (int f = 0; f < page->files; f++) {
        struct plot_layout layout;
        struct plot_allowed allowed;
        plot_layout_make(&layout, page->plots[f].r, most);
        if (!plot_allowed_make(&allowed, &page->g, &layout, &frame))
            return;
        for (int k = 0; k < layout.panels; k++)
            panel[count++] =
                allowed.panels > 0 ? allowed.panel[k] : (struct plot_allowed_panel){.share = NAN};
    }
    for (int k = 1; k < count; k++)
        same = same && plot_allowed_same(&panel[0], &panel[k]);
    for (int k = 0; k < (same ? 1 : count); k++)
        plot_allowed_write(&panel[k], &page->g, k + 1);
    plot_allowed_legend(panel, count, same ? PLOT_ALLOWED_ONE : PLOT_ALLOWED_EACH, &page->g);
    gnuplot_set(&page->g, "alloweds = allowed ? %d : 0", same ? 1 : count);
}

/* ---- the page ----------------------------------------------------------------------------- */

static const char *find_swept(const struct page *page)
{
    const char *swept = NULL;
    for (int f = 0; f < page->files; f++) {
        const struct results *const r = page->plots[f].r;
        struct plot_layout layout;
        plot_layout_make(&layout, r, MOST_OUTLINES);
        const char *const own = layout.others > 0 ? r->axis[layout.other[0]].name : NULL;
        if (layout.others > 1 || (swept && own && strcmp(swept, own) != 0))
            return NULL;
        swept = own ? own : swept;
    }
    return swept;
}

static void put(struct page *page, const struct plot_layout *first)
{
    struct gnuplot *const g = &page->g;
    const int most = MOST_OUTLINES / page->files; /* files are fewer: command_plot.c */
    char head[200];
    gnuplot_say(g, "Outlines of where the outcome is: %s; beside them its share of cases",
                results_kind_names[page->of]);
    put_axes(page, first);
    page->swept = find_swept(page); /* what the values in the legend are of */
    snprintf(head, sizeof head, "%s%s", page->swept && page->files > 1 ? "file, " : "",
             page->swept ? look_label(g->plot->look, page->swept) : "");
    gnuplot_text(g, head, "legend_head");
    for (int f = 0; f < page->files; f++) {
        struct plot_layout layout;
        plot_layout_make(&layout, page->plots[f].r, most);
        for (int p = 0; p < layout.panels; p++)
            put_outline(page, (struct panel){page->plots[f].r, &layout, p, {NULL}, {0}});
        plot_layout_note(&layout, g);
    }
    put_allowed(page, most);
    gnuplot_set(g, "outlines = %d", page->outlines);
    if (page->cross)
        gnuplot_legend(g, "0x000000", 0, 1, "equilibrium", "");
}

bool plot_outline(const struct plot *plots, int files, enum results_kind of)
{
    struct page page = {.plots = plots, .files = files};
    struct plot_layout layout = {0};
    struct plot plot = plots[0];
    char title[40];
    bool same = true;
    if (!plots[0].r->single && plots[0].r->axes >= 2)
        plot_layout_make(&layout, plots[0].r, MOST_OUTLINES);
    for (int f = 0; f < files; f++) {
        if (!check_file(&page, f, &layout))
            return false;
        same = same && strcmp(plots[f].r->title, plots[0].r->title) == 0;
    }
    page.of = of == RESULTS_KIND_COUNT ? statistics_judged(plots[0].r) : of;
    choose_scales(&page);
    snprintf(title, sizeof title, "Domains of %d files", files);
    plot.title = same ? NULL : title;
    if (!gnuplot_begin(&page.g, &plot, "outline", plot_outline_gp))
        return false;
    put(&page, &layout);
    return gnuplot_end(&page.g);
}
