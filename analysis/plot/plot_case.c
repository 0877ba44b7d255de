/* plot_case.c - one case against time: coordinates, contact forces, torques and gaps, as the
 * figures 11, 12, 16, 19 to 21 of the paper show them. Its stick figures are in plot_strip.c. */
#include "plot_case.h"

#include "runner/base/message.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

GNUPLOT_SCRIPT(plot_case_gp, "analysis/plot/plot_case.gp");

enum { MOST_ROWS = 4000, MOST_LINES = 4 * STANCE_MAX_COORDINATES, HUES = 7 /* style.gp */ };

/* Contacts with the ground; those after them are stops of joints, which have no place on it. */
static size_t grounded(const struct plot_case *c)
{
    return c->readable ? (size_t)plot_case_grounded(c->scenario.scene) : c->t->contacts;
}

/* ---- data --------------------------------------------------------------------------------- */

/* Writes time and `width` columns. More rows than pixels become two per group: the least and the
 * largest of every column, so that no peak is lost. */
static void put_track(struct gnuplot *g, int number, const struct results_trajectory *t,
                      const double *values, size_t width)
{
    size_t group = t->rows > MOST_ROWS ? (t->rows + MOST_ROWS / 2 - 1) / (MOST_ROWS / 2) : 1;
    double row[1 + 2 * STANCE_MAX_CONTACTS + STANCE_MAX_COORDINATES + STANCE_MAX_ACTUATORS];

    gnuplot_block(g, "track%d", number);
    for (size_t first = 0; first < t->rows; first += group) {
        size_t end = first + group < t->rows ? first + group : t->rows;
        for (int extreme = 0; extreme < (group > 1 ? 2 : 1); extreme++) {
            row[0] = t->time[extreme ? end - 1 : first];
            for (size_t c = 0; c < width; c++) {
                double value = values[first * width + c];
                for (size_t k = first + 1; k < end; k++) {
                    double other = values[k * width + c];
                    value = extreme ? fmax(value, other) : fmin(value, other);
                }
                row[1 + c] = value;
            }
            gnuplot_row(g, row, 1 + width);
        }
    }
    gnuplot_end_block(g);
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

/* Of columns first, first + every ... before `end`, of `width`. With `robust`, single peaks (the
 * impulses of impacts) may stick out: the frame ends at half as much again as 98 % of the loaded
 * rows need. */
static struct range range_of(const struct results_trajectory *t, const double *values, size_t width,
                             size_t first, size_t every, size_t end, bool robust)
{
    struct range range = {INFINITY, -INFINITY, 0, 0};
    double *loaded = robust ? malloc(t->rows * width * sizeof *loaded) : NULL, limit = INFINITY;
    size_t n = 0;

    for (size_t k = 0; k < t->rows && loaded; k++)
        for (size_t c = first; c < end; c += every)
            if (isfinite(values[k * width + c]) && values[k * width + c] != 0)
                loaded[n++] = fabs(values[k * width + c]);
    if (n > 0) {
        struct statistics_numbers numbers;
        statistics_summarise(loaded, n, &numbers);
        double usual = 1.5 * statistics_quantile(loaded, n, 0.98);
        limit = numbers.high > 1.5 * usual ? usual : INFINITY;
    }
    free(loaded);
    for (size_t k = 0; k < t->rows; k++) {
        bool beyond = false;
        for (size_t c = first; c < end; c += every) {
            const double value = values[k * width + c];
            if (!isfinite(value))
                continue;
            include(&range, fmax(-limit, fmin(limit, value)));
            if (fabs(value) > limit) {
                beyond = true;
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

/* What a page shows of trajectories. */
enum shown { POSITIONS, FORCES, TORQUES, GAPS };

struct page {
    struct gnuplot g;
    const struct plot_case *c;
    enum shown of;
    int panels, lines, ramps; /* so far */
};

/* [rows][width]; NULL: it has none. */
static const double *shown_of(const struct page *page, const struct results_trajectory *t,
                              size_t *width)
{
    const double *const values[] = {t->position, t->force, t->torque, t->gap};
    *width = (const size_t[]){t->coordinates, 2 * t->contacts, t->actuators, t->contacts}[page->of];
    return values[page->of];
}

/* Of all cases: see range_of. */
static struct range range_of_all(const struct page *page, size_t first, size_t every, size_t end,
                                 bool robust)
{
    struct range all = {INFINITY, -INFINITY, 0, 0};
    for (const struct plot_case *c = page->c; c; c = c->other) {
        size_t width;
        const double *values = shown_of(page, c->t, &width);
        const struct range own = range_of(c->t, values, width, first, every, end, robust);
        include(&all, own.low);
        include(&all, own.high);
        all.beyond += own.beyond;
        all.largest = fabs(own.largest) > fabs(all.largest) ? own.largest : all.largest;
    }
    return all;
}

/* Value i of the first path of an axis, for people. */
static void swept_value(const struct scenario_axis *axis, size_t i, char *text, size_t size)
{
    const double value = scenario_axis_value(axis, i, 0);
    double gap = INFINITY;
    if (axis->words || isinf(value)) {
        scenario_axis_text(axis, i, 0, text, size);
        return;
    }
    if (i > 0)
        gap = fmin(gap, fabs(value - scenario_axis_value(axis, i - 1, 0)));
    if (i + 1 < axis->count)
        gap = fmin(gap, fabs(scenario_axis_value(axis, i + 1, 0) - value));
    results_number_text(value, isinf(gap) ? 0 : gap, text, size);
    if (axis->unit[0] && strcmp(axis->unit, "1") != 0)
        add_text(text, size, " %s", axis->unit);
}

/* "ground.friction = 0.3, ..." of a case of a sweep, from its scenario. */
static void swept_text(const struct scenario *s, uint64_t index, char *text, size_t size)
{
    size_t point[SCENARIO_MAX_AXES];
    char value[64];
    for (int a = s->axes - 1; a >= 0; a--) {
        point[a] = (size_t)(index % s->axis[a].count);
        index /= s->axis[a].count;
    }
    for (int a = 0; a < s->axes; a++) {
        const struct scenario_axis *axis = &s->axis[a];
        for (int k = 0; k < (axis->sample ? axis->paths : 1); k++) {
            if (axis->sample)
                scenario_axis_text(axis, point[a], k, value, sizeof value);
            else
                swept_value(axis, point[a], value, sizeof value);
            add_text(text, size, "%s%s = %s", a || k ? ", " : "",
                     axis->sample ? axis->path[k] : axis->name, value);
        }
    }
}

/* What the case is and what became of it, added to a subtitle. */
static void describe(const struct plot_case *c, char *text, size_t size)
{
    const struct results *r = c->plot->r;
    char where[600] = "";
    if (!r->single)
        results_case_text(r, c->t->index, where, sizeof where);
    else if (c->readable)
        swept_text(&c->scenario, c->t->index, where, sizeof where);
    if (where[0])
        add_text(text, size, "case %llu, %s: ", (unsigned long long)c->t->index, where);
    add_text(text, size, "%s", results_kind_names[r->kind[r->single ? 0 : c->t->index]]);
    if (isfinite(c->settle_time))
        add_text(text, size, ", settled from %.4g s", c->settle_time);
    if (isfinite(c->fall_time))
        add_text(text, size, ", fallen at %.4g s", c->fall_time);
}

bool plot_case_begin(const struct plot_case *c, struct gnuplot *g, const char *script,
                     const char *what, stance_message *message)
{
    char subtitle[2048];
    snprintf(subtitle, sizeof subtitle, "%s; ", what);
    describe(c, subtitle, sizeof subtitle);
    if (c->other) {
        add_text(subtitle, sizeof subtitle, "; second ");
        describe(c->other, subtitle, sizeof subtitle);
    }
    return plot_begin(c->plot, g, script, subtitle, message);
}

/* A page of panels, all of columns of what it shows against time. */
static bool begin_page(struct page *page, const char *what, int panels, int height,
                       stance_message *message)
{
    double from = INFINITY, to = -INFINITY;
    struct gnuplot *g = &page->g;
    if (!plot_case_begin(page->c, g, plot_case_gp, what, message))
        return false;
    gnuplot_set(g, "panels = %d; height = %d", panels, height);
    gnuplot_arrays(g, MOST_LINES,
                   "heading label low high track_panel track_column track_factor track_width "
                   "track_dash track_colour track_case ramp_panel ramp_start ramp_rate ramp_end "
                   "ramp_colour ramp_dash");
    int number = 0;
    for (const struct plot_case *c = page->c; c; c = c->other) {
        size_t width;
        const double *values = shown_of(page, c->t, &width);
        put_track(g, ++number, c->t, values, width);
        from = fmin(from, c->t->time[0]);
        to = fmax(to, c->t->time[c->t->rows - 1]);
    }
    gnuplot_set(g, "from = %#.17g; to = %#.17g", from, to > from ? to : from + 1);
    return true;
}

/* The next panel: its range is that of all its lines and ramps. */
static void put_panel(struct page *page, const char *heading, const char *label,
                      const struct range *range)
{
    const int p = ++page->panels;
    /* Room around the values; never so little that noise of rounding fills the frame. */
    const double least = 1e-6 * (1 + fabs(range->low) + fabs(range->high));
    const double span = fmax(range->high - range->low, least);
    const double middle = 0.5 * (range->low + range->high);
    gnuplot_text(&page->g, heading, "heading[%d]", p);
    gnuplot_text(&page->g, label, "label[%d]", p);
    gnuplot_set(&page->g, "low[%d] = %#.17g; high[%d] = %#.17g", p, middle - 0.56 * span, p,
                middle + 0.56 * span);
}

/* A column of the track in the last panel, `factor` times; of another case dashed. */
static void put_line(struct page *page, size_t column, double factor, size_t hue, bool dotted)
{
    int number = 0;
    for (const struct plot_case *c = page->c; c; c = c->other) {
        number++;
        gnuplot_set(&page->g,
                    "k = %d; track_panel[k] = %d; track_column[k] = %zu; track_factor[k] = %#.17g; "
                    "track_colour[k] = hue[%zu]; track_dash[k] = %d; track_width[k] = %g; "
                    "track_case[k] = %d",
                    ++page->lines, page->panels, column + 2, factor, hue % HUES + 1,
                    dotted ? 3 : number, dotted ? 1 : 1.7, number);
    }
}

/* What something aims at, or a limit: start + rate * time until `end`. */
struct ramp {
    double start, rate, end;
};

static void put_ramp(struct page *page, const struct ramp *ramp, const char *colour, bool dashed)
{
    gnuplot_set(&page->g,
                "k = %d; ramp_panel[k] = %d; ramp_start[k] = %#.17g; ramp_rate[k] = %#.17g; "
                "ramp_end[k] = %#.17g; ramp_colour[k] = %s; ramp_dash[k] = %d",
                ++page->ramps, page->panels, ramp->start, ramp->rate, ramp->end, colour,
                !dashed          ? 1
                : page->c->other ? 4
                                 : 2);
}

static void put_level(struct page *page, double level, const char *colour, bool dashed)
{
    put_ramp(page, &(struct ramp){level, 0, 0}, colour, dashed);
}

static bool end_page(struct page *page, const char *picture, stance_message *message)
{
    if (page->c->other)
        gnuplot_note(&page->g, "dashed: the second case");
    gnuplot_set(&page->g, "tracks = %d; ramps = %d", page->lines, page->ramps);
    return plot_end(page->c->plot, &page->g, picture, message);
}

/* An entry of the legend for each contact or actuator. */
static void put_names(struct page *page, const char (*names)[SCENARIO_NAME], size_t count)
{
    char colour[32];
    for (size_t k = 0; k < count; k++) {
        snprintf(colour, sizeof colour, "hue[%zu]", k % HUES + 1);
        gnuplot_legend(&page->g, colour, names[k], "");
    }
}

/* ---- coordinates -------------------------------------------------------------------------- */

/* What the controller aims at, where it does. */
static double target_of(const struct plot_case *c, size_t i)
{
    const stance_scene *scene = c->readable ? c->scenario.scene : NULL;
    for (int p = 0; scene && scenario_law(&c->values)->designed && p < scene->postures; p++)
        if ((size_t)scene->posture[p] == i)
            return c->equilibrium[i];
    return NAN;
}

/* Where a decoupling law wants coordinate i. */
static bool setpoint_of(const struct plot_case *c, size_t i, struct ramp *setpoint)
{
    const struct scenario_values *v = &c->values;
    const char *const law = "decoupling";
    int index, coordinate[STANCE_MAX_ACTUATORS];
    bool led = false;
    if (!c->readable || scenario_law(v) != stance_law_find(law))
        return false;
    memcpy(&index, scenario_law_value(v, law, "controlled"), sizeof index);
    if (!stance_selection(c->scenario.scene, index, coordinate))
        return false;
    for (int k = 0; k < c->scenario.scene->actuators; k++)
        led = led || coordinate[k] == (int)i;
    if (!led)
        return false;
    const double start = scenario_law_value(v, law, "setpoint")[i];
    setpoint->start = isnan(start) ? c->t->position[i] : start;
    setpoint->rate = scenario_law_value(v, law, "ramp")[i];
    setpoint->end = fmin(scenario_law_value(v, law, "ramp_time")[i], c->t->time[c->t->rows - 1]);
    return isfinite(setpoint->start);
}

static bool draw_coordinates(const struct plot_case *c, stance_message *message)
{
    static const stance_quantity unknown = {.unit = "", .text = ""};
    const struct results_trajectory *t = c->t;
    struct page page = {.c = c, .of = POSITIONS};
    bool targets = false, led = false;

    if (!begin_page(&page, "Coordinates", (int)t->coordinates, 100, message))
        return false;
    for (size_t i = 0; i < t->coordinates; i++) {
        const stance_quantity *q = c->readable ? &c->scenario.scene->coordinate[i] : &unknown;
        struct range range = range_of_all(&page, i, t->coordinates, t->coordinates, false);
        const double target = target_of(c, i);
        struct ramp setpoint;
        char text[300];
        const bool leads = setpoint_of(c, i, &setpoint);
        if (isfinite(target))
            include(&range, target);
        if (leads) {
            include(&range, setpoint.start);
            include(&range, setpoint.start + setpoint.rate * setpoint.end);
        }
        snprintf(text, sizeof text, q->unit[0] ? "%s (%s)" : "%s", t->coordinate[i], q->unit);
        put_panel(&page, q->text, text, &range);
        put_line(&page, i, 1, 0, false);
        if (isfinite(target))
            put_level(&page, target, "hue[2]", true);
        if (leads)
            put_ramp(&page, &setpoint, "hue[2]", true);
        targets = targets || isfinite(target);
        led = led || leads;
    }
    if (targets || led)
        gnuplot_note(&page.g, !c->other ? (targets ? "dashed: equilibrium" : "dashed: set-point")
                              : targets ? "dash-dotted: equilibrium"
                                        : "dash-dotted: set-point");
    return end_page(&page, "coordinates", message);
}

/* ---- forces ------------------------------------------------------------------------------- */

/* "Normal force (mean over 0.01 s); 1 of 801 instants beyond the frame, the largest 9000 N" */
static void heading_of(const struct results_trajectory *t, const char *what,
                       const struct range *range, const char *unit, char *text, size_t size)
{
    snprintf(text, size, "%s", what);
    if (range->beyond > 0)
        add_text(text, size, "; %zu of %zu instants beyond the frame, up to %.4g %s", range->beyond,
                 t->rows, range->largest, unit);
}

/* Normal and tangential forces, the latter with the edges of the friction cones. */
static bool draw_forces(const struct plot_case *c, stance_message *message)
{
    static const char *const components[] = {"Normal force, out of the ground",
                                             "Tangential force, along +x"};
    const struct results_trajectory *t = c->t;
    const size_t count = grounded(c);
    struct page page = {.c = c, .of = FORCES};
    char text[300], what[80];

    if (!begin_page(&page, "Forces of the ground on the contacts", 2, 220, message))
        return false;
    for (int k = 0; k < 2; k++) {
        struct range range = range_of_all(&page, (size_t)k, 2, 2 * count, true);
        snprintf(what, sizeof what, "%s", components[k]);
        if (t->rows > 1)
            add_text(what, sizeof what, " (means over %.4g s)", t->time[1] - t->time[0]);
        heading_of(t, what, &range, "N", text, sizeof text);
        put_panel(&page, text, k ? "tangential force (N)" : "normal force (N)", &range);
        for (size_t i = 0; i < count; i++) {
            for (int sign = -1; k == 1 && c->readable && sign <= 1; sign += 2)
                put_line(&page, 2 * i, sign * c->values.friction, i, true);
            put_line(&page, 2 * i + (size_t)k, 1, i, false);
        }
    }
    put_names(&page, t->contact, count);
    if (c->readable) {
        snprintf(text, sizeof text, "limit of friction %.4g", c->values.friction);
        gnuplot_note(&page.g, "tangential, dotted:");
        gnuplot_note(&page.g, text);
    }
    return end_page(&page, "forces", message);
}

/* ---- torques and gaps --------------------------------------------------------------------- */

/* Of what actuator k gives: a force on what slides, a torque on what turns. */
static const char *unit_of(const stance_scene *scene, size_t k)
{
    return strcmp(scene->coordinate[scene->actuated[k]].unit, "m") == 0 ? "N" : "N m";
}

/* What the actuators give. */
static const char *torque_label(const struct plot_case *c, const char **unit)
{
    const stance_scene *const scene = c->readable ? c->scenario.scene : NULL;
    int slides = 0;
    for (int k = 0; scene && k < scene->actuators; k++)
        slides += strcmp(unit_of(scene, (size_t)k), "N") == 0;
    const bool all = slides > 0 && slides == scene->actuators;
    *unit = all ? "N" : slides > 0 ? "N m, N" : "N m";
    return all ? "force (N)" : slides > 0 ? "torque (N m), force (N)" : "torque (N m)";
}

/* A limit that actuators have, with the names of those that do where others have another. */
struct torque_level {
    double limit;
    const char *unit;
    char of[200];
};

/* Each once; returns how many. */
static size_t torque_levels(const struct plot_case *c, size_t actuators, struct torque_level *level)
{
    double limit[STANCE_MAX_ACTUATORS];
    size_t count = 0, alike = 0;
    if (!c->readable)
        return 0;
    stance_torque_limits(c->scenario.scene, c->values.robot, c->values.torque_limit,
                         c->values.torque_limits, limit);
    for (size_t i = 0; i < actuators; i++) {
        size_t k = 0;
        alike += limit[i] == limit[0];
        while (k < count && level[k].limit != limit[i])
            k++;
        if (!isfinite(limit[i]))
            continue;
        if (k == count)
            level[count++] = (struct torque_level){limit[i], unit_of(c->scenario.scene, i), ""};
        add_text(level[k].of, sizeof level[k].of, "%s %.40s", level[k].of[0] ? "," : " of",
                 c->t->actuator[i]);
    }
    if (alike == actuators && count == 1)
        level[0].of[0] = '\0';
    return count;
}

static bool draw_torques(const struct plot_case *c, stance_message *message)
{
    const struct results_trajectory *t = c->t;
    struct page page = {.c = c, .of = TORQUES};
    struct range range = range_of_all(&page, 0, 1, t->actuators, true);
    const double extent = 4 * fmax(fabs(range.low), fabs(range.high));
    const char *unit, *const label = torque_label(c, &unit);
    struct torque_level level[STANCE_MAX_ACTUATORS];
    char text[300];

    if (!begin_page(&page, "What the actuators give", 1, 260, message))
        return false;
    heading_of(t, "Applied in the step that ends at each instant", &range, unit, text, sizeof text);
    const size_t limits = torque_levels(c, t->actuators, level);
    for (size_t k = 0; k < limits; k++)
        for (int sign = -1; level[k].limit < extent && sign <= 1; sign += 2)
            include(&range, sign * level[k].limit);
    put_panel(&page, text, label, &range);
    for (size_t k = 0; k < t->actuators; k++)
        put_line(&page, k, 1, k, false);
    for (size_t k = 0; k < limits; k++)
        for (int sign = -1; level[k].limit < extent && sign <= 1; sign += 2)
            put_level(&page, sign * level[k].limit, "0x606060", true);
    put_names(&page, t->actuator, t->actuators);
    for (size_t k = 0; k < limits; k++) {
        snprintf(text, sizeof text, "%slimit %.4g %s%s", level[k].limit < extent ? "dashed: " : "",
                 level[k].limit, level[k].unit, level[k].of);
        gnuplot_note(&page.g, text);
    }
    return end_page(&page, "torques", message);
}

static bool draw_gaps(const struct plot_case *c, stance_message *message)
{
    const struct results_trajectory *t = c->t;
    const size_t count = grounded(c);
    struct page page = {.c = c, .of = GAPS};
    struct range range = range_of_all(&page, 0, 1, count, false);

    if (!begin_page(&page, "Heights of the contact points above the ground", 1, 260, message))
        return false;
    include(&range, 0);
    put_panel(&page, "", "gap (m)", &range);
    for (size_t k = 0; k < count; k++)
        put_line(&page, k, 1, k, false);
    put_level(&page, 0, "0x606060", false);
    put_names(&page, t->contact, count);
    return end_page(&page, "gaps", message);
}

/* ---- all of them -------------------------------------------------------------------------- */

/* What the file knows of the case beyond its trajectory. */
static void learn(struct plot_case *c)
{
    const struct results *r = c->plot->r;
    const struct results_trajectory *t = c->t;
    double *const time[] = {&c->settle_time, &c->fall_time}, *values;
    stance_message ignored = {""};

    for (int k = 0; k < 2; k++) {
        const bool has =
            results_answer(r, k ? "fall_time" : "settle_time", &values, &ignored) && values;
        *time[k] = has ? values[r->single ? 0 : t->index] : NAN;
        free(values);
    }
    c->readable = results_scenario(r, &c->scenario);
    const stance_scene *scene = c->scenario.scene;
    if (c->readable && ((size_t)scene->coordinates != t->coordinates ||
                        t->index >= c->scenario.cases || (size_t)scene->contacts != t->contacts)) {
        scenario_free(&c->scenario);
        c->readable = false;
    }
    if (c->readable)
        scenario_case_values(&c->scenario, t->index, &c->values);
    /* there may be one per design, and which is not asked */
    if (!c->readable || results_numbers(r, "design/equilibrium_position", c->equilibrium,
                                        t->coordinates) != t->coordinates)
        for (int i = 0; i < STANCE_MAX_COORDINATES; i++)
            c->equilibrium[i] = NAN;
}

bool plot_case_load(struct plot_case *c, const struct plot *plot, size_t place, uint64_t index,
                    stance_message *message)
{
    *c = (struct plot_case){.plot = plot};
    if (!results_trajectory(plot->r, place, index, &c->trajectory, message))
        return false;
    c->t = &c->trajectory;
    learn(c);
    if (c->t->rows > 0)
        return true;
    plot_case_free(c);
    return complain(message, "%.100s: the trajectory of case %llu is empty", plot->r->file,
                    (unsigned long long)index);
}

void plot_case_free(struct plot_case *c)
{
    if (c->readable)
        scenario_free(&c->scenario);
    results_trajectory_free(&c->trajectory);
}

bool plot_case(const struct plot_case *c, stance_message *message)
{
    const struct plot_case *const other = c->other ? c->other : c;
    const struct results_trajectory *t = c->t, *o = other->t;
    if (t->coordinates != o->coordinates || t->contacts != o->contacts ||
        t->actuators != o->actuators || !t->force != !o->force || !t->torque != !o->torque ||
        !t->gap != !o->gap || grounded(c) != grounded(other) ||
        memcmp(t->coordinate, o->coordinate, t->coordinates * sizeof *t->coordinate) != 0)
        return complain(message, "%.100s: the two cases are of different robots", c->plot->r->file);
    const bool lands = grounded(c) > 0;
    const bool good =
        draw_coordinates(c, message) && (!t->force || !lands || draw_forces(c, message)) &&
        (!t->torque || draw_torques(c, message)) && (!t->gap || !lands || draw_gaps(c, message));
    if (good && !c->readable)
        fprintf(stderr, "%s: no stick figures: this version cannot read the file's scenario\n",
                c->plot->r->file);
    return good && (!c->readable || plot_strip(c, message));
}
