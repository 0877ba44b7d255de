/* plot_case.c - one case against time: coordinates, contact forces, torques and gaps, as the
 * figures 11, 12, 16, 19 to 21 of the paper show them. Its stick figures are in plot_strip.c. */
#include "plot_case.h"

#include "analysis/statistics/statistics.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
    LEFT = 96,
    PLOT_WIDTH = 700,
    RIGHT = 170,
    BOTTOM = 56,
    HEADING = 24, /* above each panel */
    MOST_ROWS = 4000,
};

const char *const plot_contact_colours[STANCE_MAX_CONTACTS] = {PLOT_ACCENT, PLOT_SECOND};

/* ---- data --------------------------------------------------------------------------------- */

/* Writes time and `width` columns. More rows than pixels become two per group: the least and the
 * largest of every column, so that no peak is lost. */
static void put_track(struct gnuplot *g, const struct results_trajectory *t, const double *values,
                      size_t width, char name[32])
{
    size_t group = t->rows > MOST_ROWS ? (t->rows + MOST_ROWS / 2 - 1) / (MOST_ROWS / 2) : 1;
    FILE *data = gnuplot_data(g, name);
    for (size_t first = 0; first < t->rows; first += group) {
        size_t end = first + group < t->rows ? first + group : t->rows;
        for (int extreme = 0; extreme < (group > 1 ? 2 : 1); extreme++) {
            gnuplot_number(data, t->time[extreme ? end - 1 : first]);
            for (size_t c = 0; c < width; c++) {
                double value = values[first * width + c];
                for (size_t k = first + 1; k < end; k++) {
                    double other = values[k * width + c];
                    value = extreme ? fmax(value, other) : fmin(value, other);
                }
                putc(' ', data);
                gnuplot_number(data, value);
            }
            putc('\n', data);
        }
    }
    gnuplot_close_data(g, data);
}

/* What of some columns fits the frame. */
struct range {
    double low, high;
    size_t beyond;  /* rows left outside */
    double largest; /* of them, by magnitude */
};

static void include(struct range *range, double value)
{
    range->low = fmin(range->low, value);
    range->high = fmax(range->high, value);
}

/* Room around the values; never so little that noise of rounding fills the frame. */
static void widen(struct range *range)
{
    double least = 1e-6 * (1 + fabs(range->low) + fabs(range->high));
    double span = fmax(range->high - range->low, least), middle = 0.5 * (range->low + range->high);
    range->low = middle - 0.56 * span;
    range->high = middle + 0.56 * span;
}

/* Of columns first, first + every ... of `width`. With `robust`, single peaks (the impulses of
 * impacts) may stick out: the frame ends at half as much again as 98 % of the loaded rows need. */
static struct range range_of(const struct results_trajectory *t, const double *values, size_t width,
                             size_t first, size_t every, bool robust)
{
    struct range range = {INFINITY, -INFINITY, 0, 0};
    double *loaded = robust ? malloc(t->rows * width * sizeof *loaded) : NULL, limit = INFINITY;
    size_t n = 0;

    for (size_t k = 0; k < t->rows && loaded; k++) {
        for (size_t c = first; c < width; c += every) {
            double value = fabs(values[k * width + c]);
            if (isfinite(value) && value > 0)
                loaded[n++] = value;
        }
    }
    if (n > 0) {
        struct statistics_numbers numbers;
        statistics_summarise(loaded, n, &numbers);
        double usual = 1.5 * statistics_quantile(loaded, n, 0.98);
        limit = numbers.high > 1.5 * usual ? usual : INFINITY;
    }
    free(loaded);
    for (size_t k = 0; k < t->rows; k++) {
        bool beyond = false;
        for (size_t c = first; c < width; c += every) {
            double value = values[k * width + c];
            if (!isfinite(value))
                continue;
            if (fabs(value) <= limit) {
                include(&range, value);
            } else {
                beyond = true;
                include(&range, value > 0 ? limit : -limit);
                range.largest = fabs(value) > fabs(range.largest) ? value : range.largest;
            }
        }
        range.beyond += beyond;
    }
    if (!(range.low <= range.high))
        range.low = range.high = 0;
    return range;
}

/* ---- pages -------------------------------------------------------------------------------- */

struct page {
    struct gnuplot g;
    const struct plot_case *c;
    double top, height; /* of the next panel */
    int panels, drawn;
};

/* Value i of the first path of an axis, for people. */
static void swept_value(const struct scenario_axis *axis, size_t i, char *text, size_t size)
{
    char number[32];
    double value = scenario_axis_value(axis, i, 0), gap = INFINITY;
    if (axis->words || isinf(value)) {
        scenario_axis_text(axis, i, 0, text, size);
        return;
    }
    if (i > 0)
        gap = fmin(gap, fabs(value - scenario_axis_value(axis, i - 1, 0)));
    if (i + 1 < axis->count)
        gap = fmin(gap, fabs(scenario_axis_value(axis, i + 1, 0) - value));
    results_number_text(value, isinf(gap) ? 0 : gap, number, sizeof number);
    bool unit = strcmp(axis->unit, "1") != 0;
    snprintf(text, size, "%s%s%s", number, unit && axis->unit[0] ? " " : "",
             unit ? axis->unit : "");
}

/* "ground.friction = 0.3, ..." of a case of a sweep, from its scenario. */
static void swept_text(const struct scenario *s, uint64_t index, char *text, size_t size)
{
    size_t point[SCENARIO_MAX_AXES], used = 0;
    char value[64];
    for (int a = s->axes - 1; a >= 0; a--) {
        point[a] = (size_t)(index % s->axis[a].count);
        index /= s->axis[a].count;
    }
    text[0] = '\0';
    for (int a = 0; a < s->axes && used < size; a++) {
        const struct scenario_axis *axis = &s->axis[a];
        for (int k = 0; axis->sample && k < axis->paths && used < size; k++) {
            scenario_axis_text(axis, point[a], k, value, sizeof value);
            used += (size_t)snprintf(text + used, size - used, "%s%s = %s", a || k ? ", " : "",
                                     axis->path[k], value);
        }
        if (axis->sample)
            continue;
        swept_value(axis, point[a], value, sizeof value);
        used += (size_t)snprintf(text + used, size - used, "%s%s = %s", a ? ", " : "",
                                 s->axis[a].name, value);
    }
}

static void describe(const struct plot_case *c, char *text, size_t size)
{
    const struct results *r = c->plot->r;
    uint64_t row = r->single ? 0 : c->t->index;
    char where[600] = "";
    if (!r->single)
        results_case_text(r, c->t->index, where, sizeof where);
    else if (c->readable)
        swept_text(&c->scenario, c->t->index, where, sizeof where);
    if (where[0]) {
        snprintf(text, size, "case %llu, %s: %s", (unsigned long long)c->t->index, where,
                 results_kind_names[r->kind[row]]);
    } else {
        snprintf(text, size, "%s", results_kind_names[r->kind[row]]);
    }
    size_t used = strlen(text);
    if (used < size && isfinite(c->settle_time))
        used += (size_t)snprintf(text + used, size - used, ", settled from %.4g s", c->settle_time);
    if (used < size && isfinite(c->fall_time))
        snprintf(text + used, size - used, ", fallen at %.4g s", c->fall_time);
}

bool plot_case_begin(const struct plot_case *c, struct gnuplot *g, const char *what, int width,
                     int below, double *top, stance_message *message)
{
    const struct results *r = c->plot->r;
    const char *title = r->title[0] ? r->title : r->name;
    char subtitle[1024], about[800];

    describe(c, about, sizeof about);
    snprintf(subtitle, sizeof subtitle, "%s; %s", what, about);
    *top = gnuplot_title_height(width, title, subtitle);
    if (!gnuplot_begin(g, width, (int)*top + below, message))
        return false;
    gnuplot_title(g, title, subtitle);
    return true;
}

bool plot_case_end(const struct plot_case *c, struct gnuplot *g, const char *picture,
                   stance_message *message)
{
    char stem[512];
    snprintf(stem, sizeof stem, "%s-%s", c->plot->stem, picture);
    return gnuplot_end(g, c->plot->directory, stem, message);
}

static bool begin_page(struct page *page, const char *what, int panels, double height,
                       stance_message *message)
{
    page->panels = panels;
    page->drawn = 0;
    page->height = height;
    int below = panels * (int)(height + HEADING) + BOTTOM;
    if (!plot_case_begin(page->c, &page->g, what, LEFT + PLOT_WIDTH + RIGHT, below, &page->top,
                         message))
        return false;
    gnuplot_label(&page->g, LEFT + PLOT_WIDTH / 2.0, page->top + below - 14, "time (s)", "center",
                  12, false);
    return true;
}

/* Heading and axis label of panel k; before gnuplot_decorate. */
static void head(struct page *page, int k, const char *heading, const char *label)
{
    double y = page->top + k * (page->height + HEADING);
    gnuplot_label(&page->g, LEFT, y + HEADING - 9, heading, "left", 11, false);
    gnuplot_label(&page->g, 22, y + HEADING + page->height / 2, label, "center", 12, true);
}

static void legend_at(struct page *page, int panel, int entry, const char *colour, const char *text)
{
    gnuplot_legend(&page->g, LEFT + PLOT_WIDTH + 14,
                   page->top + panel * (page->height + HEADING) + HEADING + 8 + entry * 22, colour,
                   text);
}

/* Axes of the next panel; a plot command follows. */
static void begin_panel(struct page *page, const struct range *range)
{
    const struct results_trajectory *t = page->c->t;
    double end = t->rows > 1 ? t->time[t->rows - 1] : t->time[0] + 1;
    bool last = page->drawn == page->panels - 1;
    gnuplot_panel(&page->g, LEFT, page->top + page->drawn * (page->height + HEADING) + HEADING,
                  PLOT_WIDTH, page->height);
    fprintf(
        page->g.script,
        "set xrange [%.10g:%.10g]\nset xtics %.10g\nset format x '%s'\n"
        "set yrange [%.10g:%.10g]\nset format y '%%.10g'\nset grid lt 1 lc rgb '#e6e6e6' lw 0.8\n",
        t->time[0], end, plot_round_step(t->time[0], end, 10), last ? "%.10g" : "", range->low,
        range->high);
    plot_value_tics(page->g.script, range->low, range->high, page->height);
    page->drawn++;
}

/* A level line of the panel; numbered so that it can be taken away. */
static void level(struct page *page, int number, double y, const char *style)
{
    fprintf(page->g.script,
            "set arrow %d from graph 0, first %.10g to graph 1, first %.10g nohead %s\n", number, y,
            y, style);
}

static void clear_levels(struct page *page)
{
    fputs("unset arrow\n", page->g.script);
}

/* ---- coordinates -------------------------------------------------------------------------- */

/* Unit and meaning of a coordinate, from the scene; "" where the scene is not known. */
static const stance_quantity *quantity(const struct plot_case *c, size_t i)
{
    static const stance_quantity unknown = {.unit = "", .text = ""};
    return c->readable ? &c->scenario.scene->coordinate[i] : &unknown;
}

/* What the controller aims at, where it does. */
static double target_of(const struct plot_case *c, size_t i)
{
    const stance_scene *scene = c->readable ? c->scenario.scene : NULL;
    for (int p = 0; scene && scenario_law(&c->values)->designed && p < scene->postures; p++)
        if ((size_t)scene->posture[p] == i)
            return c->equilibrium[i];
    return NAN;
}

/* Where a decoupling law wants coordinate i: at `start` first, moving at `rate` until `end`. */
struct setpoint {
    double start, rate, end;
};

static bool setpoint_of(const struct plot_case *c, size_t i, struct setpoint *setpoint)
{
    const struct scenario_values *v = &c->values;
    const char *const law = "decoupling";
    int index, pair[2];
    if (!c->readable || scenario_law(v) != stance_law_find(law))
        return false;
    memcpy(&index, scenario_law_value(v, law, "controlled"), sizeof index);
    if (!stance_pair(c->scenario.scene, index, &pair[0], &pair[1]) ||
        ((int)i != pair[0] && (int)i != pair[1]))
        return false;
    const double start = scenario_law_value(v, law, "setpoint")[i];
    setpoint->start = isnan(start) ? c->t->position[i] : start;
    setpoint->rate = scenario_law_value(v, law, "ramp")[i];
    setpoint->end = fmin(scenario_law_value(v, law, "ramp_time")[i], c->t->time[c->t->rows - 1]);
    return isfinite(setpoint->start);
}

/* The entry of the dashed lines in the legend, where there are such. */
static void legend_targets(struct page *page, const char *text)
{
    double y = 1 - (page->top + HEADING + 8) / page->g.height, x = LEFT + PLOT_WIDTH + 14;
    fprintf(page->g.script,
            "set arrow from screen %.6f,%.6f to screen %.6f,%.6f nohead dt 2 lw 1.6"
            " lc rgb '%s'\n",
            x / page->g.width, y, (x + 32) / page->g.width, y, PLOT_SECOND);
    gnuplot_label(&page->g, x + 40, page->top + HEADING + 8, text, "left", 12, false);
}

/* One coordinate against time, with what the controller wants of it. */
static void put_coordinate(struct page *page, const char *name, size_t i)
{
    const struct results_trajectory *t = page->c->t;
    struct range range = range_of(t, t->position, t->coordinates, i, t->coordinates, false);
    double target = target_of(page->c, i);
    struct setpoint setpoint;
    bool led = setpoint_of(page->c, i, &setpoint);
    if (isfinite(target)) {
        include(&range, target);
        level(page, 1, target, "dt 2 lw 1.6 lc rgb '" PLOT_SECOND "'");
    }
    if (led) {
        include(&range, setpoint.start);
        include(&range, setpoint.start + setpoint.rate * setpoint.end);
    }
    widen(&range);
    begin_panel(page, &range);
    fprintf(page->g.script, "plot '%s' using 1:%zu with lines lw 1.8 lc rgb '%s' notitle", name,
            i + 2, PLOT_ACCENT);
    if (led) {
        fprintf(page->g.script,
                ", %.10g + %.10g*(x < %.10g ? x : %.10g) with lines dt 2 lw 1.6 lc rgb '%s'"
                " notitle",
                setpoint.start, setpoint.rate, setpoint.end, setpoint.end, PLOT_SECOND);
    }
    fputc('\n', page->g.script);
    clear_levels(page);
}

static bool draw_coordinates(const struct plot_case *c, stance_message *message)
{
    const struct results_trajectory *t = c->t;
    struct page page = {.c = c};
    struct setpoint setpoint;
    char name[32], text[300];
    bool targets = false, led = false;

    if (!begin_page(&page, "Coordinates", (int)t->coordinates, 100, message))
        return false;
    for (size_t i = 0; i < t->coordinates; i++) {
        const stance_quantity *q = quantity(c, i);
        snprintf(text, sizeof text, q->unit[0] ? "%s (%s)" : "%s", t->coordinate[i], q->unit);
        head(&page, (int)i, q->text, text);
        targets = targets || isfinite(target_of(c, i));
        led = led || setpoint_of(c, i, &setpoint);
    }
    if (targets || led)
        legend_targets(&page, targets ? "equilibrium" : "set-point");
    gnuplot_decorate(&page.g);
    clear_levels(&page);
    put_track(&page.g, t, t->position, t->coordinates, name);
    for (size_t i = 0; i < t->coordinates; i++)
        put_coordinate(&page, name, i);
    return plot_case_end(c, &page.g, "coordinates", message);
}

/* ---- forces ------------------------------------------------------------------------------- */

/* "Normal force (mean over 0.01 s); 1 of 801 instants beyond the frame, the largest 9000 N" */
static void heading_of(const struct results_trajectory *t, const char *what,
                       const struct range *range, const char *unit, char *text, size_t size)
{
    size_t used = (size_t)snprintf(text, size, "%s", what);
    if (range->beyond > 0 && used < size) {
        snprintf(text + used, size - used, "; %zu of %zu instants beyond the frame, up to %.4g %s",
                 range->beyond, t->rows, range->largest, unit);
    }
}

/* Lines of both contacts; tangential forces with the edges of their friction cones. */
static void put_forces(struct page *page, const char *name, int component)
{
    const struct results_trajectory *t = page->c->t;
    double friction = page->c->readable ? page->c->values.friction : NAN;
    const char *separator = "plot ";
    for (size_t k = 0; component == 1 && isfinite(friction) && k < t->contacts; k++) {
        for (int sign = -1; sign <= 1; sign += 2) {
            fprintf(page->g.script,
                    "%s'%s' using 1:(%.10g*$%zu) with lines dt 3 lw 1 lc rgb '%s'"
                    " notitle",
                    separator, name, sign * friction, 2 * k + 2,
                    plot_contact_colours[k % STANCE_MAX_CONTACTS]);
            separator = ", ";
        }
    }
    for (size_t k = 0; k < t->contacts; k++) {
        fprintf(page->g.script, "%s'%s' using 1:%zu with lines lw 1.6 lc rgb '%s' notitle",
                separator, name, 2 * k + (size_t)component + 2,
                plot_contact_colours[k % STANCE_MAX_CONTACTS]);
        separator = ", ";
    }
    fputc('\n', page->g.script);
}

static bool draw_forces(const struct plot_case *c, stance_message *message)
{
    const struct results_trajectory *t = c->t;
    struct page page = {.c = c};
    struct range range[2];
    char name[32], text[300], what[80];
    static const char *const components[] = {"Normal force, out of the ground",
                                             "Tangential force, along +x"};

    if (!begin_page(&page, "Forces of the ground on the contacts", 2, 220, message))
        return false;
    for (int k = 0; k < 2; k++) {
        range[k] = range_of(t, t->force, 2 * t->contacts, (size_t)k, 2, true);
        snprintf(what, sizeof what, "%s", components[k]);
        if (t->rows > 1) {
            snprintf(what, sizeof what, "%s (means over %.4g s)", components[k],
                     t->time[1] - t->time[0]);
        }
        heading_of(t, what, &range[k], "N", text, sizeof text);
        head(&page, k, text, k ? "tangential force (N)" : "normal force (N)");
        widen(&range[k]);
    }
    for (size_t k = 0; k < t->contacts; k++)
        legend_at(&page, 0, (int)k, plot_contact_colours[k % STANCE_MAX_CONTACTS], t->contact[k]);
    if (c->readable) {
        gnuplot_label(&page.g, LEFT + PLOT_WIDTH + 14, page.top + page.height + 2 * HEADING + 8,
                      "dotted: limit of", "left", 11, false);
        snprintf(text, sizeof text, "friction %.4g", c->values.friction);
        gnuplot_label(&page.g, LEFT + PLOT_WIDTH + 14, page.top + page.height + 2 * HEADING + 24,
                      text, "left", 11, false);
    }
    gnuplot_decorate(&page.g);
    put_track(&page.g, t, t->force, 2 * t->contacts, name);
    for (int k = 0; k < 2; k++) {
        begin_panel(&page, &range[k]);
        put_forces(&page, name, k);
    }
    return plot_case_end(c, &page.g, "forces", message);
}

/* ---- torques and gaps --------------------------------------------------------------------- */

static bool draw_torques(const struct plot_case *c, stance_message *message)
{
    const struct results_trajectory *t = c->t;
    const char *const colours[STANCE_MAX_ACTUATORS] = {PLOT_ACCENT, PLOT_SECOND};
    struct page page = {.c = c};
    struct range range = range_of(t, t->torque, t->actuators, 0, 1, true);
    double limit = c->readable ? c->values.torque_limit : INFINITY;
    char name[32], text[300];
    bool limited = isfinite(limit) && limit < 4 * fmax(fabs(range.low), fabs(range.high));

    if (!begin_page(&page, "Torques of the actuators", 1, 260, message))
        return false;
    heading_of(t, "Torque applied in the step that ends at each instant", &range, "N m", text,
               sizeof text);
    head(&page, 0, text, "torque (N m)");
    for (size_t k = 0; k < t->actuators; k++)
        legend_at(&page, 0, (int)k, colours[k % STANCE_MAX_ACTUATORS], t->actuator[k]);
    if (isfinite(limit)) {
        snprintf(text, sizeof text, "%slimit %.4g N m", limited ? "dashed: " : "", limit);
        gnuplot_label(&page.g, LEFT + PLOT_WIDTH + 14,
                      page.top + HEADING + 8 + 22 * (double)t->actuators, text, "left", 11, false);
    }
    gnuplot_decorate(&page.g);
    if (limited) {
        include(&range, limit);
        include(&range, -limit);
        level(&page, 1, limit, "dt 2 lw 1.4 lc rgb '#606060'");
        level(&page, 2, -limit, "dt 2 lw 1.4 lc rgb '#606060'");
    }
    widen(&range);
    put_track(&page.g, t, t->torque, t->actuators, name);
    begin_panel(&page, &range);
    for (size_t k = 0; k < t->actuators; k++) {
        fprintf(page.g.script, "%s'%s' using 1:%zu with lines lw 1.5 lc rgb '%s' notitle",
                k ? ", " : "plot ", name, k + 2, colours[k % STANCE_MAX_ACTUATORS]);
    }
    fputc('\n', page.g.script);
    clear_levels(&page);
    return plot_case_end(c, &page.g, "torques", message);
}

static bool draw_gaps(const struct plot_case *c, stance_message *message)
{
    const struct results_trajectory *t = c->t;
    struct page page = {.c = c};
    struct range range = range_of(t, t->gap, t->contacts, 0, 1, false);
    char name[32];

    if (!begin_page(&page, "Heights of the contact points above the ground", 1, 260, message))
        return false;
    head(&page, 0, "", "gap (m)");
    for (size_t k = 0; k < t->contacts; k++)
        legend_at(&page, 0, (int)k, plot_contact_colours[k % STANCE_MAX_CONTACTS], t->contact[k]);
    gnuplot_decorate(&page.g);
    include(&range, 0);
    widen(&range);
    level(&page, 1, 0, "lw 1.4 lc rgb '#606060'");
    put_track(&page.g, t, t->gap, t->contacts, name);
    begin_panel(&page, &range);
    for (size_t k = 0; k < t->contacts; k++) {
        fprintf(page.g.script, "%s'%s' using 1:%zu with lines lw 1.6 lc rgb '%s' notitle",
                k ? ", " : "plot ", name, k + 2, plot_contact_colours[k % STANCE_MAX_CONTACTS]);
    }
    fputc('\n', page.g.script);
    clear_levels(&page);
    return plot_case_end(c, &page.g, "gaps", message);
}

/* ---- all of them -------------------------------------------------------------------------- */

static double answer_of(const struct results *r, const char *name, uint64_t row)
{
    double *values, value = NAN;
    stance_message ignored = {""};
    if (results_answer(r, name, &values, &ignored) && values)
        value = values[row];
    free(values);
    return value;
}

/* What the file knows of the case beyond its trajectory. */
static void learn(struct plot_case *c)
{
    const struct results *r = c->plot->r;
    const struct results_trajectory *t = c->t;
    uint64_t row = r->single ? 0 : t->index;

    c->settle_time = answer_of(r, "settle_time", row);
    c->fall_time = answer_of(r, "fall_time", row);
    for (int i = 0; i < STANCE_MAX_COORDINATES; i++)
        c->equilibrium[i] = NAN;
    c->readable = results_scenario(r, &c->scenario);
    if (!c->readable)
        return;
    const stance_scene *scene = c->scenario.scene;
    if ((size_t)scene->coordinates != t->coordinates || t->index >= c->scenario.cases ||
        (size_t)scene->contacts != t->contacts) {
        scenario_free(&c->scenario);
        c->readable = false;
        return;
    }
    scenario_case_values(&c->scenario, t->index, &c->values);
    if (results_numbers(r, "design/equilibrium_position", c->equilibrium, t->coordinates) !=
        t->coordinates) {
        /* one per design, and which is not asked */
        for (size_t i = 0; i < t->coordinates; i++)
            c->equilibrium[i] = NAN;
    }
}

bool plot_case(const struct plot *plot, size_t place, uint64_t index, stance_message *message)
{
    struct results_trajectory t;
    struct plot_case *c = calloc(1, sizeof *c);
    if (!c) {
        snprintf(message->text, sizeof message->text, "stance plot: not enough memory");
        return false;
    }
    if (!results_trajectory(plot->r, place, index, &t, message)) {
        free(c);
        return false;
    }
    c->plot = plot;
    c->t = &t;
    learn(c);
    bool good = t.rows > 0;
    if (!good) {
        snprintf(message->text, sizeof message->text,
                 "%.100s: the trajectory of case %llu is empty", plot->r->file,
                 (unsigned long long)index);
    }
    good = good && draw_coordinates(c, message) && (!t.force || draw_forces(c, message)) &&
           (!t.torque || draw_torques(c, message)) && (!t.gap || draw_gaps(c, message));
    if (good && c->readable) {
        good = plot_strip(c, message);
    } else if (good) {
        fprintf(stderr, "%s: no stick figures: this version cannot read the file's scenario\n",
                plot->r->file);
    }
    if (c->readable)
        scenario_free(&c->scenario);
    results_trajectory_free(&t);
    free(c);
    return good;
}
