/* plot_case.c - one case against time: coordinates, contact forces, torques and gaps, as the
 * figures 11, 12, 16, 19 to 21 of the paper show them. Its stick figures are in plot_strip.c. */
#include "plot_case.h"

#include "engine/tree.h"
#include "runner/base/message.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_ROWS = 4000 };

/* Contacts with the ground; those after them are stops of joints, which have no place on it. */
static size_t grounded(const struct plot_case *c)
{
    return c->scenario ? (size_t)plot_case_grounded(c->scenario->scene) : c->t->contacts;
}

/* ---- pages -------------------------------------------------------------------------------- */

/* [rows][width]; NULL: it has none. */
static const double *shown_of(const struct case_page *page, const struct results_trajectory *t,
                              size_t *width)
{
    const double *const values[] = {t->position, t->force, t->torque, t->gap};
    *width =
        (const size_t[]){t->coordinates, 2 * t->contacts, t->actuators, t->contacts}[page->shown];
    return values[page->shown];
}

/* Columns first, first + every ... before `end` of what a page shows. */
struct columns {
    size_t first, every, end;
    bool robust; /* single peaks (the impulses of impacts) may stick out of the frame */
};

/* What of some columns fits the frame. */
struct range {
    struct plot_range of;
    size_t rows;    /* seen */
    size_t beyond;  /* of them, left outside */
    double largest; /* of them, by magnitude */
};

/* The frame ends at half as much again as 98 % of the loaded rows need. */
static double limit_of(const double *values, size_t rows, size_t width, struct columns columns)
{
    double *const loaded = malloc(rows * width * sizeof *loaded), limit = INFINITY;
    size_t n = 0;
    for (size_t k = 0; k < rows * width && loaded; k += width)
        for (size_t c = columns.first; c < columns.end; c += columns.every)
            if (isfinite(values[k + c]) && values[k + c] != 0)
                loaded[n++] = fabs(values[k + c]);
    if (n > 0) {
        struct statistics_numbers numbers;
        statistics_summarise(loaded, n, &numbers);
        const double usual = 1.5 * statistics_quantile(loaded, n, 0.98);
        limit = numbers.high > 1.5 * usual ? usual : INFINITY;
    }
    free(loaded);
    return limit;
}

/* Of all cases. */
static struct range range_of(const struct case_page *page, struct columns columns)
{
    struct range range = {.of = PLOT_NOTHING};
    for (const struct plot_case *c = page->c; c; c = c->other) {
        size_t width;
        const double *const values = shown_of(page, c->t, &width);
        const double limit =
            columns.robust ? limit_of(values, c->t->rows, width, columns) : INFINITY;
        for (size_t row = 0; row < c->t->rows; row++) {
            bool beyond = false;
            const size_t k = row * width;
            const double time = c->t->time[row];
            if (time < page->time.low || time > page->time.high)
                continue;
            for (size_t i = k + columns.first; i < k + columns.end; i += columns.every) {
                if (!isfinite(values[i]))
                    continue;
                plot_widen(&range.of, fmax(-limit, fmin(limit, values[i])));
                beyond = beyond || fabs(values[i]) > limit;
                if (fabs(values[i]) > fmax(limit, fabs(range.largest)))
                    range.largest = values[i];
            }
            range.beyond += beyond;
            range.rows++;
        }
    }
    if (!(range.of.low <= range.of.high))
        range.of.low = range.of.high = 0;
    return range;
}

/* "ground.friction = 0.3, ..." of a case of a sweep, from its scenario. */
static void swept_text(const struct scenario *s, uint64_t index, char *text, size_t size)
{
    size_t point[SCENARIO_MAX_AXES] = {0};
    char word[64];
    for (int a = s->axes - 1; a >= 0; a--) {
        point[a] = (size_t)(index % s->axis[a].count);
        index /= s->axis[a].count;
    }
    for (int a = 0; a < s->axes; a++) {
        const struct scenario_axis *const axis = &s->axis[a];
        const size_t i = point[a];
        for (int k = 0; k < (axis->sample ? axis->paths : 1); k++) {
            if (axis->sample || axis->words) {
                scenario_axis_text(axis, i, k, word, sizeof word);
            } else { /* in as many digits as it takes beside its neighbours */
                const size_t first = i > 0 ? i - 1 : 0;
                double value[3];
                struct results_axis own = {.value = value};
                for (size_t j = first; j < axis->count && j <= i + 1; j++)
                    value[own.count++] = scenario_axis_value(axis, j, k);
                if (strcmp(axis->unit, "1") != 0)
                    snprintf(own.unit, sizeof own.unit, "%s", axis->unit);
                results_value_text(&own, i - first, true, word, sizeof word);
            }
            add_text(text, size, "%s%s = %s", a || k ? ", " : "",
                     axis->sample ? axis->path[k] : axis->name, word);
        }
    }
}

/* What the case is and what became of it, added to the line under the title. */
static void describe(struct gnuplot *g, const struct plot_case *c)
{
    const struct results *r = c->plot->r;
    char where[600] = "";
    if (!r->single)
        results_case_text(r, c->t->index, where, sizeof where);
    else if (c->scenario)
        swept_text(c->scenario, c->t->index, where, sizeof where);
    if (where[0])
        gnuplot_say(g, "case %llu, %s: ", (unsigned long long)c->t->index, where);
    gnuplot_say(g, "%s", results_kind_names[r->kind[r->single ? 0 : c->t->index]]);
    if (isfinite(c->settle_time))
        gnuplot_say(g, ", settled from %.4g s", c->settle_time);
    if (isfinite(c->fall_time))
        gnuplot_say(g, ", fallen at %.4g s", c->fall_time);
}

bool plot_case_begin(const struct plot_case *c, struct gnuplot *g, const char *name,
                     const char *what)
{
    if (!gnuplot_begin(g, c->plot, name))
        return false;
    gnuplot_say(g, "%s; ", what);
    describe(g, c);
    if (c->other) {
        gnuplot_say(g, "; second ");
        describe(g, c->other);
    }
    return true;
}

bool plot_page_begin(struct case_page *page, const char *name, const char *what)
{
    struct gnuplot *const g = &page->g;
    if (!plot_case_begin(page->c, g, name, what))
        return false;
    page->time = PLOT_NOTHING;
    for (size_t k = 0; k < page->marks; k++)
        plot_widen(&page->time, page->mark[k]);
    if (page->marks > 0)
        page->time = plot_roomy(page->time, 0.08);
    for (const struct plot_case *c = page->c; c && page->marks == 0; c = c->other) {
        plot_widen(&page->time, c->t->time[0]);
        plot_widen(&page->time, c->t->time[c->t->rows - 1]);
    }
    if (!(page->time.high > page->time.low))
        page->time.high = page->time.low + 1;
    gnuplot_set(g, "chart_width = 700");
    gnuplot_axis(g, 'x', PLOT_LINEAR, page->time, "time", "s");
    if (page->c->other)
        gnuplot_note(g, "dashed: the second case");
    return true;
}

/* The next panel: its range is that of all its lines and ramps. */
static void put_panel(struct case_page *page, double height, const char *heading,
                      struct plot_range range, const char *name, const char *unit)
{
    /* Room around the values; never so little that noise of rounding fills the frame. */
    const double least = 1e-6 * (1 + fabs(range.low) + fabs(range.high));
    const double half = 0.56 * fmax(range.high - range.low, least);
    const double middle = 0.5 * (range.low + range.high);
    gnuplot_panel(&page->g, height, heading);
    gnuplot_axis(&page->g, 'y', PLOT_LINEAR, (struct plot_range){middle - half, middle + half},
                 name, unit);
    if (page->marks > 0)
        gnuplot_series(&page->g, "using 1:2 with lines dt 3 lw 1 lc rgb 0x606060");
    for (size_t k = 0; k < page->marks; k++) {
        /* A line with both ends outside, be it by a rounding, is not drawn. */
        gnuplot_segment(&page->g, page->mark[k], middle - 0.999 * half, page->mark[k],
                        middle + 0.999 * half);
    }
}

/* A column of what is shown in the last panel, `factor` times; of another case dashed. More rows
 * than pixels become two per group, the least and the largest, so that no peak is lost. */
static void put_line(struct case_page *page, size_t column, double factor, size_t hue, bool dotted)
{
    int number = 0;
    for (const struct plot_case *c = page->c; c; c = c->other) {
        const struct results_trajectory *const t = c->t;
        const size_t half = MOST_ROWS / 2,
                     group = t->rows > MOST_ROWS ? (t->rows + half - 1) / half : 1;
        size_t width;
        const double *const values = shown_of(page, t, &width) + column;
        gnuplot_series(&page->g, "using 1:2 with lines dt %d lw %g lc rgb %s",
                       dotted ? 3 : ++number, dotted ? 1 : 1.7, gnuplot_hue(hue));
        for (size_t first = 0; first < t->rows; first += group) {
            const size_t end = first + group < t->rows ? first + group : t->rows;
            struct plot_range range = PLOT_NOTHING;
            for (size_t k = first; k < end; k++)
                plot_widen(&range, factor * values[k * width]);
            const bool any = range.low <= range.high;
            GNUPLOT_ROW(&page->g, t->time[first], any ? range.low : NAN);
            if (group > 1)
                GNUPLOT_ROW(&page->g, t->time[end - 1], any ? range.high : NAN);
        }
    }
}

/* What something aims at, or a limit: start + rate * time until `end`. */
struct ramp {
    double start, rate, end;
};

static void put_ramp(struct case_page *page, const struct ramp *ramp, const char *colour,
                     bool dashed)
{
    const double time[] = {page->time.low, fmax(page->time.low, fmin(ramp->end, page->time.high)),
                           page->time.high};
    gnuplot_series(&page->g, "using 1:2 with lines dt %d lw 1.5 lc rgb %s",
                   !dashed          ? 1
                   : page->c->other ? 4
                                    : 2,
                   colour);
    for (int k = 0; k < 3; k++)
        GNUPLOT_ROW(&page->g, time[k], ramp->start + ramp->rate * fmin(time[k], ramp->end));
}

/* A line and an entry of the legend for each contact or actuator. */
static void put_names(struct case_page *page, const char (*names)[SCENARIO_NAME], size_t count,
                      int dash)
{
    for (size_t k = 0; k < count; k++)
        gnuplot_legend(&page->g, gnuplot_hue(k), dash, 0, names[k], "");
}

/* ---- coordinates -------------------------------------------------------------------------- */

/* What the controller aims at, where it does. */
static double target_of(const struct plot_case *c, size_t i)
{
    const stance_scene *scene = c->scenario ? c->scenario->scene : NULL;
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
    if (!c->scenario || scenario_law(v) != stance_law_find(law))
        return false;
    memcpy(&index, scenario_law_value(v, law, "controlled"), sizeof index);
    if (!stance_selection(c->scenario->scene, index, coordinate))
        return false;
    for (int k = 0; k < c->scenario->scene->actuators; k++)
        led = led || coordinate[k] == (int)i;
    if (!led)
        return false;
    const double start = scenario_law_value(v, law, "setpoint")[i];
    setpoint->start = isnan(start) ? c->t->position[i] : start;
    setpoint->rate = scenario_law_value(v, law, "ramp")[i];
    setpoint->end = fmin(scenario_law_value(v, law, "ramp_time")[i], c->t->time[c->t->rows - 1]);
    return isfinite(setpoint->start);
}

static void put_coordinates(struct case_page *page, double height)
{
    static const stance_quantity unknown = {.unit = "", .text = ""};
    const struct plot_case *const c = page->c;
    bool targets = false, led = false;
    page->shown = SHOWN_POSITIONS;
    for (size_t i = 0; i < c->t->coordinates; i++) {
        const stance_quantity *q = c->scenario ? &c->scenario->scene->coordinate[i] : &unknown;
        struct range range = range_of(page, (struct columns){i, 1, i + 1, false});
        const double target = target_of(c, i);
        struct ramp setpoint;
        const bool leads = setpoint_of(c, i, &setpoint);
        plot_widen(&range.of, target);
        if (leads) {
            plot_widen(&range.of, setpoint.start);
            plot_widen(&range.of, setpoint.start + setpoint.rate * setpoint.end);
        }
        put_panel(page, height, q->text, range.of, c->t->coordinate[i], q->unit);
        if (isfinite(target))
            put_ramp(page, &(struct ramp){target, 0, INFINITY}, "hue[2]", true);
        if (leads)
            put_ramp(page, &setpoint, "hue[2]", true);
        put_line(page, i, 1, 0, false);
        targets = targets || isfinite(target);
        led = led || leads;
    }
    if (targets || led)
        gnuplot_note(&page->g, "%s: %s", c->other ? "dash-dotted" : "dashed",
                     targets ? "equilibrium" : "set-point");
}

/* ---- forces ------------------------------------------------------------------------------- */

/* "; 1 of 801 instants beyond the frame, up to 9000 N" */
static void add_beyond(const struct range *range, const char *unit, char *text, size_t size)
{
    if (range->beyond > 0)
        add_text(text, size, "; %zu of %zu instants beyond the frame, up to %.4g %s", range->beyond,
                 range->rows, range->largest, unit);
}

void plot_page_forces(struct case_page *page, double height)
{
    static const char *const names[][2] = {{"Normal force, out of the ground", "normal"},
                                           {"Tangential force, along +x", "tangential"}};
    const struct plot_case *const c = page->c;
    const struct results_trajectory *t = c->t;
    const size_t count = grounded(c);
    stance_tree_numbers number = {0};
    char text[300];
    bool rough = false;

    page->shown = SHOWN_FORCES;
    if (c->scenario)
        stance_tree_numbers_make(c->scenario->scene->tree, c->scenario->scene->mechanism,
                                 c->values.robot, &number);
    for (size_t k = 0; k < 2; k++) {
        const struct range range = range_of(page, (struct columns){k, 2, 2 * count, true});
        snprintf(text, sizeof text, "%s", names[k][0]);
        if (t->rows > 1)
            add_text(text, sizeof text, " (means over %.4g s)", t->time[1] - t->time[0]);
        add_beyond(&range, "N", text, sizeof text);
        put_panel(page, height, text, range.of, names[k][1], "N");
        for (size_t i = 0; i < count; i++) {
            for (int sign = -1; k == 1 && c->scenario && sign <= 1; sign += 2)
                put_line(page, 2 * i, sign * c->values.friction * number.rough[i], i, true);
            put_line(page, 2 * i + k, 1, i, false);
            rough |= c->scenario && number.rough[i] != 1;
        }
    }
    put_names(page, t->contact, count, 0);
    if (c->scenario) {
        gnuplot_note(&page->g, "tangential, dotted:");
        gnuplot_note(&page->g, "limit of friction %.4g%s", c->values.friction,
                     rough ? " times each friction_factor" : "");
    }
}

/* ---- torques and gaps --------------------------------------------------------------------- */

/* Of what actuator k gives: a force on what slides, a torque on what turns. */
static const char *unit_of(const stance_scene *scene, size_t k)
{
    return strcmp(scene->coordinate[scene->actuated[k]].unit, "m") == 0 ? "N" : "N m";
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
    if (!c->scenario)
        return 0;
    stance_torque_limits(c->scenario->scene, c->values.robot, c->values.torque_limit,
                         c->values.torque_limits, limit);
    for (size_t i = 0; i < actuators; i++) {
        size_t k = 0;
        alike += limit[i] == limit[0];
        while (k < count && level[k].limit != limit[i])
            k++;
        if (!isfinite(limit[i]))
            continue;
        if (k == count)
            level[count++] = (struct torque_level){limit[i], unit_of(c->scenario->scene, i), ""};
        add_text(level[k].of, sizeof level[k].of, "%s %.40s", level[k].of[0] ? "," : " of",
                 c->t->actuator[i]);
    }
    if (alike == actuators && count == 1)
        level[0].of[0] = '\0';
    return count;
}

void plot_page_torques(struct case_page *page, double height)
{
    const struct plot_case *const c = page->c;
    const struct results_trajectory *t = c->t;
    page->shown = SHOWN_TORQUES;
    struct range range = range_of(page, (struct columns){0, 1, t->actuators, true});
    const double extent = 4 * fmax(fabs(range.of.low), fabs(range.of.high));
    bool kind[2] = {false, false}; /* there are torques, forces */
    for (size_t k = 0; k < t->actuators; k++)
        kind[c->scenario && unit_of(c->scenario->scene, k)[1] == '\0'] = true;
    const char *const unit = !kind[1]  ? "N m"
                             : kind[0] ? "N m, N"
                                       : "N",
                      *const name = !kind[1]  ? "torque"
                                    : kind[0] ? "torque, force"
                                              : "force";
    struct torque_level level[STANCE_MAX_ACTUATORS];
    char text[300] = "Applied in the step that ends at each instant";

    add_beyond(&range, unit, text, sizeof text);
    const size_t limits = torque_levels(c, t->actuators, level);
    for (size_t k = 0; k < limits && level[k].limit < extent; k++) {
        plot_widen(&range.of, -level[k].limit);
        plot_widen(&range.of, level[k].limit);
    }
    put_panel(page, height, text, range.of, name, unit);
    for (size_t k = 0; k < limits; k++)
        for (int sign = -1; level[k].limit < extent && sign <= 1; sign += 2)
            put_ramp(page, &(struct ramp){sign * level[k].limit, 0, INFINITY}, "0x606060", true);
    for (size_t k = 0; k < t->actuators; k++)
        put_line(page, k, 1, k, false);
    put_names(page, t->actuator, t->actuators, page->marks > 0);
    for (size_t k = 0; k < limits; k++)
        gnuplot_note(&page->g, "%slimit %.4g %s%s", level[k].limit < extent ? "dashed: " : "",
                     level[k].limit, level[k].unit, level[k].of);
}

static void put_gaps(struct case_page *page, double height)
{
    const size_t count = grounded(page->c);
    page->shown = SHOWN_GAPS;
    struct range range = range_of(page, (struct columns){0, 1, count, false});
    plot_widen(&range.of, 0);
    put_panel(page, height, "", range.of, "gap", "m");
    put_ramp(page, &(struct ramp){0, 0, INFINITY}, "0x606060", false);
    for (size_t k = 0; k < count; k++)
        put_line(page, k, 1, k, false);
    put_names(page, page->c->t->contact, count, 0);
}

/* A page of one quantity. */
static bool draw_page(const struct plot_case *c, const char *name, const char *what,
                      void (*put)(struct case_page *page, double height), double height)
{
    struct case_page page = {.c = c};
    if (!plot_page_begin(&page, name, what))
        return false;
    put(&page, height);
    return gnuplot_end(&page.g);
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
    const struct scenario *const read = r->read;
    if (read && (size_t)read->scene->coordinates == t->coordinates && t->index < read->cases &&
        (size_t)read->scene->contacts == t->contacts) {
        c->scenario = read;
        scenario_case_values(read, t->index, &c->values);
    }
    /* there may be one per design, and which is not asked */
    if (!c->scenario || results_numbers(r, "design/equilibrium_position", c->equilibrium,
                                        t->coordinates) != t->coordinates)
        for (int i = 0; i < STANCE_MAX_COORDINATES; i++)
            c->equilibrium[i] = NAN;
    plot_ground_learn(c);
}

bool plot_case_load(struct plot_case *c, const struct plot *plot, size_t place, uint64_t index)
{
    *c = (struct plot_case){.plot = plot};
    if (!results_trajectory(plot->r, place, index, &c->trajectory, plot->message))
        return false;
    c->t = &c->trajectory;
    learn(c);
    if (c->t->rows > 0)
        return true;
    plot_case_free(c);
    return complain(plot->message, "%.100s: the trajectory of case %llu is empty", plot->r->file,
                    (unsigned long long)index);
}

void plot_case_free(struct plot_case *c)
{
    free(c->floor);
    results_trajectory_free(&c->trajectory);
}

bool plot_case(const struct plot_case *c)
{
    const struct plot_case *const other = c->other ? c->other : c;
    const struct results_trajectory *t = c->t, *o = other->t;
    if (t->coordinates != o->coordinates || t->contacts != o->contacts ||
        t->actuators != o->actuators || !t->force != !o->force || !t->torque != !o->torque ||
        !t->gap != !o->gap || grounded(c) != grounded(other) ||
        memcmp(t->coordinate, o->coordinate, t->coordinates * sizeof *t->coordinate) != 0)
        return complain(c->plot->message, "%.100s: the two cases are of different robots",
                        c->plot->r->file);
    const bool lands = grounded(c) > 0;
    const bool good =
        draw_page(c, "coordinates", "Coordinates", put_coordinates, 100) &&
        (!t->force || !lands ||
         draw_page(c, "forces", "Forces of the ground on the contacts", plot_page_forces, 220)) &&
        (!t->torque ||
         draw_page(c, "torques", "What the actuators give", plot_page_torques, 260)) &&
        (!t->gap || !lands ||
         draw_page(c, "gaps", "Heights of the contact points above the ground", put_gaps, 260));
    if (good && !c->scenario)
        fprintf(stderr, "%s: no stick figures: this version cannot read the file's scenario\n",
                c->plot->r->file);
    return good && (!c->scenario || (plot_strip(c) && plot_phase(c)));
}
