/* plot_layout.c - axes of maps, and panels. */
#include "plot_layout.h"

#include "runner/base/message.h"

#include <math.h>
#include <string.h>

enum { MAX_COLUMNS = 6 }; /* of a table */

/* ---- what is drawn ------------------------------------------------------------------------ */

/* The last two axes of numbers make the map; where there are fewer, axes of words join them, then
 * those of one value. Words beside numbers stand at the left, where each has a line. */
static void choose_axes(struct plot_layout *layout)
{
    const struct results *const r = layout->r;
    int chosen[2] = {0, 0}, count = 0;
    for (int rank = 0; rank < 4 && count < 2; rank++) {
        for (int a = r->axes - 1; a >= 0 && count < 2; a--)
            if ((r->axis[a].word != NULL) + 2 * (r->axis[a].count == 1) == rank)
                chosen[count++] = a;
    }
    layout->x = chosen[0] < chosen[1] ? chosen[0] : chosen[1];
    layout->y = chosen[0] < chosen[1] ? chosen[1] : chosen[0];
    if (r->axis[layout->x].word && !r->axis[layout->y].word) {
        int words = layout->x;
        layout->x = layout->y;
        layout->y = words;
    }
    plot_axis_make(&layout->across, &r->axis[layout->x]);
    plot_axis_make(&layout->up, &r->axis[layout->y]);
}

static void choose_panels(struct plot_layout *layout, int most)
{
    const struct results *const r = layout->r;
    layout->panels = 1;
    double product = 1;
    for (int a = 0; a < r->axes; a++) {
        if (a != layout->x && a != layout->y && r->axis[a].count > 1) {
            layout->shown[layout->others] = r->axis[a].count;
            product *= (double)r->axis[a].count;
            layout->other[layout->others++] = a;
        }
    }
    /* Too many: the longest axis shows fewer of its points, until all fit. */
    while (product > most) {
        int longest = 0;
        for (int k = 1; k < layout->others; k++)
            longest = layout->shown[k] > layout->shown[longest] ? k : longest;
        size_t *shown = &layout->shown[longest];
        product /= (double)*shown;
        *shown = *shown > 2 * (size_t)most ? 2 * (size_t)most : *shown - 1;
        product *= (double)*shown;
    }
    for (int k = 0; k < layout->others; k++)
        layout->panels *= (int)layout->shown[k];
}

void plot_layout_make(struct plot_layout *layout, const struct results *r, int most)
{
    *layout = (struct plot_layout){.r = r};
    choose_axes(layout);
    choose_panels(layout, most);
}

/* Both ends included. */
size_t plot_layout_shown(const struct plot_layout *layout, int k, size_t m)
{
    size_t count = layout->r->axis[layout->other[k]].count, shown = layout->shown[k];
    return shown < 2 ? (count - 1) / 2 : m * (count - 1) / (shown - 1);
}

/* Coordinates of a panel, 0 along the axes of the map. */
static void point_of(const struct plot_layout *layout, int panel, size_t *point)
{
    memset(point, 0, SCENARIO_MAX_AXES * sizeof *point);
    size_t rest = (size_t)panel;
    for (int k = layout->others - 1; k >= 0; k--) {
        point[layout->other[k]] = plot_layout_shown(layout, k, rest % layout->shown[k]);
        rest /= layout->shown[k];
    }
}

uint64_t plot_layout_index(const struct plot_layout *layout, int panel, size_t i, size_t j)
{
    size_t point[SCENARIO_MAX_AXES];
    uint64_t index = 0;
    point_of(layout, panel, point);
    point[layout->x] = i;
    point[layout->y] = j;
    for (int a = 0; a < layout->r->axes; a++)
        index = index * layout->r->axis[a].count + point[a];
    return index;
}

double plot_layout_share(const struct plot_layout *layout, int panel, enum results_kind of)
{
    size_t sum = 0, done = 0;
    for (size_t i = 0; i < layout->across.axis->count; i++) {
        for (size_t j = 0; j < layout->up.axis->count; j++) {
            const uint8_t kind = layout->r->kind[plot_layout_index(layout, panel, i, j)];
            sum += kind == of;
            done += kind < RESULTS_FAILED;
        }
    }
    return done > 0 ? 100 * (double)sum / (double)done : NAN;
}

void plot_layout_note(const struct plot_layout *layout, struct gnuplot *g)
{
    for (int k = 0; k < layout->others; k++) {
        const struct results_axis *axis = &layout->r->axis[layout->other[k]];
        if (layout->shown[k] == axis->count)
            continue;
        gnuplot_note(g, "%zu of the %zu values of %s are drawn", layout->shown[k], axis->count,
                     axis->name);
    }
}

bool plot_layout_is_table(const struct plot_layout *layout)
{
    return layout->others == 2 && layout->shown[0] > 1 && layout->shown[1] > 1 &&
           layout->shown[1] <= MAX_COLUMNS;
}

bool plot_zero_place(const struct plot_axis *along, double *place)
{
    if (!along->axis->offset || along->scale == PLOT_LOG)
        return false;
    if (along->scale == PLOT_LINEAR) {
        *place = 0;
        return along->range.low < 0 && along->range.high > 0;
    }
    size_t nearest = statistics_nearest_zero(along->axis);
    *place = (double)nearest;
    return !along->axis->word && along->axis->value[nearest] == 0;
}

const char *plot_short_name(const char *path, enum plot_naming naming)
{
    const char *dot = naming == PLOT_NAMES ? strchr(path, '.') : strrchr(path, '.');
    return dot ? dot + 1 : path;
}

void plot_value_title(struct gnuplot *g, const struct results_axis *axis, size_t i,
                      enum plot_naming naming, char *text, size_t size)
{
    char value[96];
    const char *name = look_label(g->plot->look, axis->name);
    results_value_text(axis, i, true, value, sizeof value);
    if (name == axis->name)
        name = plot_short_name(axis->name, naming);
    const char *const label = look_label(g->plot->look, value);
    if (naming == PLOT_NUMBERS && label == value)
        results_value_text(axis, i, false, text, size);
    else if (naming >= PLOT_VALUES_ALONE)
        snprintf(text, size, "%s", label);
    else
        snprintf(text, size, "%s = %s", name, label);
}

/* "friction = 0.25, noise = 0.1": the page's subtitle has the whole paths in the same order. */
void plot_panel_title(struct gnuplot *g, const struct plot_layout *layout, int panel,
                      enum plot_naming naming, char *text, size_t size)
{
    size_t point[SCENARIO_MAX_AXES];
    char one[300];
    point_of(layout, panel, point);
    text[0] = '\0';
    for (int k = 0; k < layout->others; k++) {
        const int a = layout->other[k];
        plot_value_title(g, &layout->r->axis[a], point[a], naming, one, sizeof one);
        add_text(text, size, "%s%s", k ? ", " : "", one);
    }
}
