/* plot_axis.c - scales of axes, and what scripts are told of axes and outcomes. */
#include "plot.h"

#include "analysis/statistics/faces.h"
#include "runner/base/message.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- scales ------------------------------------------------------------------------------- */

/* value[i] or its logarithm, from the lowest. */
static double raw(const struct results_axis *axis, bool logarithm, size_t i)
{
    return logarithm ? log10(axis->value[i]) : axis->value[i];
}

static bool is_positive(const struct results_axis *axis)
{
    for (size_t i = 0; i < axis->count; i++)
        if (axis->value[i] <= 0)
            return false;
    return true;
}

/* Whether no value is further than a part of a cell from where it would be drawn. */
static bool is_even(const struct results_axis *axis, bool logarithm, double part)
{
    double first = raw(axis, logarithm, 0);
    double step = (raw(axis, logarithm, axis->count - 1) - first) / (double)(axis->count - 1);
    for (size_t i = 0; i < axis->count; i++)
        if (!(fabs(raw(axis, logarithm, i) - first - (double)i * step) <= part * fabs(step)))
            return false;
    return step != 0;
}

static void make_even(struct plot_axis *along, bool logarithm)
{
    const struct results_axis *axis = along->axis;
    double first = raw(axis, logarithm, 0), last = raw(axis, logarithm, axis->count - 1);
    along->scale = logarithm ? PLOT_LOG : PLOT_LINEAR;
    along->falling = last < first;
    along->first = along->falling ? last : first;
    along->step = fabs(last - first) / (double)(axis->count - 1);
}

void plot_axis_make_ladder(struct plot_axis *along, const struct results_axis *axis, double part)
{
    *along = (struct plot_axis){.axis = axis, .scale = PLOT_LIST, .step = 1};
    if (!axis->word && axis->count > 1) {
        if (is_even(axis, false, 1e-5))
            make_even(along, false);
        else if (axis->count > 2 && is_positive(axis) && is_even(axis, true, part))
            make_even(along, true);
    }
    along->range.low = along->first - 0.5 * along->step;
    along->range.high = along->first + ((double)axis->count - 0.5) * along->step;
}

void plot_axis_make(struct plot_axis *along, const struct results_axis *axis)
{
    plot_axis_make_ladder(along, axis, 1e-5);
}

/* Unevenness of the spacing: standard deviation of the steps over their mean. */
static double unevenness(const struct results_axis *axis, bool logarithm)
{
    double sum = 0, squares = 0, n = (double)(axis->count - 1);
    for (size_t i = 1; i < axis->count; i++) {
        double step = fabs(raw(axis, logarithm, i) - raw(axis, logarithm, i - 1));
        sum += step;
        squares += step * step;
    }
    return sum > 0 ? sqrt(fmax(0, squares / n - sum * sum / (n * n))) / (sum / n) : 0;
}

void plot_axis_make_curve(struct plot_axis *along, const struct results_axis *axis)
{
    plot_axis_make(along, axis);
    if (along->scale == PLOT_LIST && !axis->word && axis->count > 1) {
        const bool logarithm =
            is_positive(axis) && unevenness(axis, true) < 0.5 * unevenness(axis, false);
        struct plot_range range = PLOT_NOTHING;
        for (size_t i = 0; i < axis->count; i++)
            plot_widen(&range, raw(axis, logarithm, i));
        along->range = plot_roomy(range, 0.03);
        along->scale = logarithm ? PLOT_LOG : PLOT_LINEAR;
    }
    /* A time is not negative, nor has an axis of times room for that. */
    struct plot_range values;
    plot_range_of(&values, axis->value, axis->count);
    if (along->scale == PLOT_LINEAR && along->range.low < 0 && values.low >= 0)
        along->range.low = 0;
}

double plot_axis_place(const struct plot_axis *along, size_t i)
{
    return along->scale == PLOT_LIST ? (double)i : raw(along->axis, along->scale == PLOT_LOG, i);
}

struct statistics_place *plot_axis_points(const struct plot_axis *along, struct gnuplot *g)
{
    const size_t n = along->axis->count;
    struct statistics_place *const points = gnuplot_room(g, n, sizeof *points);
    for (size_t i = 0; points && i < n; i++)
        points[i] = (struct statistics_place){plot_axis_place(along, i), i};
    if (points)
        statistics_order(points, n);
    return points;
}

size_t plot_axis_index(const struct plot_axis *along, size_t k)
{
    return along->falling ? along->axis->count - 1 - k : k;
}

/* ---- what scripts are told ---------------------------------------------------------------- */

void plot_label_write(const struct results_axis *axis, struct gnuplot *g, const char *which)
{
    static const char with[] = "; with ";
    char text[sizeof axis->text], path[sizeof axis->name + sizeof axis->unit + sizeof text + 16];
    const char *label = look_label(g->plot->look, axis->name), *dot = strrchr(axis->name, '.');
    const bool own = label != axis->name;
    snprintf(text, sizeof text, "%s", axis->text);
    snprintf(path, sizeof path, axis->unit[0] ? "%s (%s)" : "%s", axis->name, axis->unit);
    char *const others = strstr(text, with);
    if (others) { /* are said where there is room for the path alone, too */
        const char *first = others + strlen(with);
        char *const second = strstr(first, ", ");
        const size_t prefix = dot ? (size_t)(dot + 1 - axis->name) : 0;
        *others = '\0';
        if (second)
            *second = '\0';
        /* "vpole" of initial.offset.vpole beside initial.offset.pole */
        first += strncmp(first, axis->name, prefix) == 0 ? prefix : 0;
        add_text(path, sizeof path, ", with %s%s", first, second ? " and others" : "");
    }
    gnuplot_text(g, own ? "" : text, "%s_text", which);
    gnuplot_text(g, own ? label : path, "%s_path", which);
}

const char *plot_axis_write(const struct plot_axis *along, struct gnuplot *g, char which)
{
    const char *const axis = gnuplot_axis(g, which, along->scale, along->range, "", "");
    plot_label_write(along->axis, g, axis);
    /* Where words are many, as many of them as pictures have room for. */
    const size_t count = along->scale == PLOT_LIST ? along->axis->count : 0;
    for (size_t i = 0; i < count; i += count / 64 + 1) {
        char text[64];
        results_value_text(along->axis, i, false, text, sizeof text);
        gnuplot_word(g, (double)i, text);
    }
    return axis;
}

void plot_say_became(struct gnuplot *g)
{
    const uint64_t cases = g->plot->r->cases;
    gnuplot_say(g, cases == 1 ? "What became of %llu case" : "What became of each of %llu cases",
                (unsigned long long)cases);
}

void plot_say_failed(struct gnuplot *g)
{
    struct statistics_counts counts;
    statistics_count(g->plot->r, -1, 0, &counts);
    if (counts.kind[RESULTS_FAILED] > 0)
        gnuplot_say(g, ", %llu failed in all", (unsigned long long)counts.kind[RESULTS_FAILED]);
}

void plot_say_cut(struct gnuplot *g, enum results_kind of, bool shown)
{
    struct faces faces;
    char at[400];
    if (of == RESULTS_KIND_COUNT)
        return;
    faces_make(&faces, g->plot->r, NULL, 0);
    const face_set cut = faces_cut(&faces, of);
    faces_text(&faces, cut, at, sizeof at);
    if (cut)
        gnuplot_say(g, "; what is %s is cut by the box at %s%s", results_kind_names[of], at,
                    shown ? ": its share is the box's" : "");
}

void plot_kinds_write(struct gnuplot *g, bool legend)
{
    const struct results *const r = g->plot->r;
    struct statistics_counts counts;
    char text[64], colour[64];
    statistics_count(r, -1, 0, &counts);
    gnuplot_arrays(g, RESULTS_KIND_COUNT, "kind_colour");
    for (int k = 0; k < RESULTS_KIND_COUNT; k++) {
        const double share = 100 * (double)counts.kind[k] / (double)r->cases;
        snprintf(colour, sizeof colour, "colour_%s", results_kind_names[k]);
        snprintf(text, sizeof text, share < 0.05 ? "%.2g %%" : "%.1f %%", share);
        gnuplot_colour(g, colour, results_kind_names[k]);
        gnuplot_set(g, "kind_colour[%d] = %s", k + 1, colour);
        if (legend && counts.kind[k] > 0)
            gnuplot_legend(g, colour, 0, 0, results_kind_names[k], text);
    }
}

void plot_cells_write(struct gnuplot *g, const struct plot_cells *cells, const void *values,
                      const char *colours)
{
    const size_t size = colours ? 1 : sizeof(double);
    const struct plot_axis *const across = cells->across, *const up = cells->up;
    const size_t nx = across->axis->count, ny = up->axis->count;
    const size_t twice_x = nx == 1 ? 2 : 1, twice_y = ny == 1 ? 2 : 1;
    const size_t bytes = nx * twice_x * ny * twice_y * size;
    char *const copy = gnuplot_room(g, bytes, 1), *at = copy;
    for (size_t j = 0; copy && j < ny * twice_y; j++) {
        for (size_t i = 0; i < nx * twice_x; i++, at += size) {
            const size_t index = cells->first +
                                 plot_axis_index(across, i / twice_x) * cells->stride[0] +
                                 plot_axis_index(up, j / twice_y) * cells->stride[1];
            memcpy(at, (const char *)values + index * size, size);
        }
    }
    if (!copy)
        return;
    const double dx = across->step / (double)twice_x, dy = up->step / (double)twice_y;
    gnuplot_cells(g, copy, bytes);
    gnuplot_set(g,
                "panel_plot[panels] = panel_plot[panels].\", 'cells%d' binary array=(%zu,%zu) "
                "dx=%.17g dy=%.17g origin=(%.17g,%.17g) \"",
                g->files, nx * twice_x, ny * twice_y, dx, dy, across->range.low + 0.5 * dx,
                up->range.low + 0.5 * dy);
    gnuplot_set(g,
                colours ? "panel_plot[panels] = panel_plot[panels].\"format='%%uchar' using "
                          "(%1$s[$1+1]>>16):(%1$s[$1+1]>>8&255):(%1$s[$1+1]&255) with rgbimage "
                          "notitle\""
                        : "panel_plot[panels] = panel_plot[panels].\"format='%%float64' using 1 "
                          "with image notitle\"",
                colours);
}
