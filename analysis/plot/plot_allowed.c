/* plot_allowed.c - what linear theory allows in a map.
 *
 * The states of a map's starts are a plane, x = origin + u side[0] + v side[1] with u and v in 0
 * ... 1, and the set is convex: so is its section by the plane, whose outline is where rays from a
 * point inside leave it or the map. Where three points of the outline are on a line, so is all
 * between them; elsewhere further rays go between. */
#include "plot_layout.h"

#include "runner/base/message.h"
#include "runner/plan/allowed.h"

#include <math.h>
#include <string.h>

enum { RAYS = 32, DEEPEST = 9, HALVINGS = 20, MOST_POINTS = RAYS << DEEPEST };
#define STRAIGHT 1e-4 /* of the picture's sides */
#define PLANE 1e-9    /* of their states: how far starts may be off it */

/* ---- the plane ---------------------------------------------------------------------------- */

struct picture {
    const struct plot_layout *layout;
    struct plot_axis along[2];
    size_t end[2][2]; /* of each axis: places between which its values lie */
    const struct scenario *s;
    struct scenario_values values; /* of the start that is looked at */
    /* Of the panel that is made: its set, its plane, a point inside, in parts of the picture. */
    struct plot_allowed_panel *panel;
    struct allowed of;
    double origin[DESIGN_STATES], side[2][DESIGN_STATES], inside[2];
    int number, n;
};

/* Both axes are starts, on even scales. */
static bool check_axes(struct picture *p, stance_message *why)
{
    for (int k = 0; k < 2; k++) {
        const struct results_axis *const axis = p->along[k].axis;
        const struct scenario_axis *const of = &p->s->axis[k == 0 ? p->layout->x : p->layout->y];
        for (int i = 0; i < of->paths; i++) // NOLINT: maps have axes
            if (!scenario_is_start(of->path[i]))
                return complain(why, "%.90s is no coordinate of a start", of->path[i]);
        scenario_ends(axis->value, axis->count, 1, p->end[k]);
        if (axis->value[p->end[k][0]] == axis->value[p->end[k][1]])
            return complain(why, "%.90s has one value", axis->name);
        if (p->along[k].scale == PLOT_LIST)
            return complain(why, "the values of %.90s are not even", axis->name);
    }
    return true;
}

/* The ends of the picture along an axis, as values. */
static struct plot_range ends_of(const struct picture *p, int k)
{
    const struct plot_range range = p->along[k].range;
    return p->along[k].scale == PLOT_LOG
               ? (struct plot_range){pow(10, range.low), pow(10, range.high)}
               : range;
}

/* Where a value of an axis is between them, 0 ... 1. */
static double part_of(const struct picture *p, int k, size_t i)
{
    const struct plot_range ends = ends_of(p, k);
    return (p->along[k].axis->value[i] - ends.low) / (ends.high - ends.low);
}

/* And where that is drawn. */
static double place_of(const struct picture *p, int k, double part)
{
    const struct plot_range ends = ends_of(p, k);
    const double value = ends.low + part * (ends.high - ends.low);
    return p->along[k].scale == PLOT_LOG ? log10(value) : value;
}

static void state_at(const struct picture *p, const double part[2], double *x)
{
    for (int c = 0; c < p->n; c++)
        x[c] = p->origin[c] + part[0] * p->side[0][c] + part[1] * p->side[1][c];
}

static bool holds_at(const struct picture *p, const double part[2])
{
    double x[DESIGN_STATES];
    state_at(p, part, x);
    return stance_null_set_holds(p->of.set, x);
}

/* The state in which a case of the panel starts. */
static void start_of(struct picture *p, size_t i, size_t j, double *x)
{
    double position[STANCE_MAX_COORDINATES], velocity[STANCE_MAX_COORDINATES];
    scenario_case_values(p->s, plot_layout_index(p->layout, p->number, i, j), &p->values);
    resolve_start(p->s->scene, &p->values, &p->of.design, position, velocity);
    allowed_state(&p->of, position, velocity, x);
}

/* How far a start is off the plane, as a part of the largest coordinates. */
static double off_plane(struct picture *p, size_t i, size_t j)
{
    const double part[2] = {part_of(p, 0, i), part_of(p, 1, j)};
    double x[DESIGN_STATES], on[DESIGN_STATES], largest = 0, off = 0;
    start_of(p, i, j, x);
    state_at(p, part, on);
    for (int c = 0; c < p->n; c++) {
        largest = fmax(largest, fabs(x[c]));
        off = fmax(off, fabs(x[c] - on[c]));
    }
    return off > 0 ? off / largest : 0;
}

static bool make_plane(struct picture *p, stance_message *why)
{
    double first[DESIGN_STATES], x[DESIGN_STATES];
    p->n = 2 * p->of.equilibrium.freedoms;
    start_of(p, p->end[0][0], p->end[1][0], first);
    memcpy(p->origin, first, sizeof first);
    for (int k = 0; k < 2; k++) {
        const double begin = part_of(p, k, p->end[k][0]), end = part_of(p, k, p->end[k][1]);
        start_of(p, p->end[0][k == 0], p->end[1][k == 1], x);
        for (int c = 0; c < p->n; c++) {
            p->side[k][c] = (x[c] - first[c]) / (end - begin);
            p->origin[c] -= begin * p->side[k][c];
        }
    }
    double off = off_plane(p, p->end[0][1], p->end[1][1]);
    for (size_t i = 0; i < p->along[0].axis->count; i++)
        off = fmax(off, off_plane(p, i, p->end[1][0]));
    for (size_t j = 0; j < p->along[1].axis->count; j++)
        off = fmax(off, off_plane(p, p->end[0][0], j));
    return off <= PLANE || complain(why, "the starts of the map are no plane");
}

/* ---- its outline -------------------------------------------------------------------------- */

/* Where a ray leaves the set or the picture. */
static struct plot_allowed_point shoot(const struct picture *p, double angle)
{
    const double way[2] = {cos(angle), sin(angle)};
    double reach[2] = {0, INFINITY};
    struct plot_allowed_point end = {.angle = angle, .edge = true};
    for (int k = 0; k < 2; k++)
        if (way[k] != 0)
            reach[1] = fmin(reach[1], ((way[k] > 0 ? 1 : 0) - p->inside[k]) / way[k]);
    for (int round = 0; round < HALVINGS; round++) {
        const double r = round == 0 ? reach[1] : 0.5 * (reach[0] + reach[1]);
        for (int k = 0; k < 2; k++)
            end.place[k] = p->inside[k] + r * way[k];
        const bool holds = holds_at(p, end.place);
        if (round == 0 && holds)
            return end;
        end.edge = false;
        reach[holds ? 0 : 1] = r;
    }
    return end;
}

/* Keeps a point, and what is between it and another one. */
static void keep(struct picture *p, struct plot_allowed_point a, struct plot_allowed_point b,
                 int depth)
{
    const struct plot_allowed_point middle = shoot(p, 0.5 * (a.angle + b.angle));
    const double across[2] = {b.place[0] - a.place[0], b.place[1] - a.place[1]};
    const double off =
        across[0] * (middle.place[1] - a.place[1]) - across[1] * (middle.place[0] - a.place[0]);
    const bool straight = a.edge == b.edge && middle.edge == a.edge &&
                          fabs(off) <= STRAIGHT * hypot(across[0], across[1]);
    if (depth == 0 || straight) {
        p->panel->point[p->panel->points++] = a;
        return;
    }
    keep(p, a, middle, depth - 1);
    keep(p, middle, b, depth - 1);
}

/* ---- panels ------------------------------------------------------------------------------- */

/* The share of the panel's starts that are in the set; their mean is then inside. */
static double find_inside(struct picture *p)
{
    const size_t count[2] = {p->along[0].axis->count, p->along[1].axis->count};
    double inside = 0, sum[2] = {0};
    for (size_t i = 0; i < count[0]; i++)
        for (size_t j = 0; j < count[1]; j++) {
            const double part[2] = {part_of(p, 0, i), part_of(p, 1, j)};
            const bool holds = holds_at(p, part);
            inside += holds;
            for (int k = 0; k < 2; k++)
                sum[k] += holds ? part[k] : 0;
        }
    for (int k = 0; k < 2; k++)
        p->inside[k] = sum[k] / inside;
    return inside / (double)count[0] / (double)count[1];
}

/* `why`: nothing is to be seen. */
static void trace(struct picture *p, stance_message *why)
{
    struct plot_allowed_panel *const panel = p->panel;
    struct plot_allowed_point last = {.edge = true};
    size_t edges = 0;
    for (int k = 0; k <= RAYS; k++) {
        const struct plot_allowed_point next = shoot(p, 2 * acos(-1) * k / RAYS);
        if (k > 0)
            keep(p, last, next, DEEPEST);
        last = next;
    }
    for (size_t i = 0; i < panel->points; i++) {
        struct plot_allowed_point *const point = &panel->point[i];
        for (int k = 0; k < 2; k++)
            point->place[k] = place_of(p, k, point->place[k]);
        edges += point->edge;
    }
    if (edges == panel->points)
        complain(why, "all of these starts are allowed");
}

static bool make_panel(struct picture *p, stance_message *why, stance_message *message)
{
    struct plot_allowed_panel *const panel = p->panel;
    panel->share = NAN;
    if (!allowed_make(&p->of, p->s, plot_layout_index(p->layout, p->number, 0, 0), message))
        return false;
    const stance_null_set *const set = p->of.set;
    const bool unreached = set && stance_null_set_unreached(set, NULL, NULL) > 0;
    panel->glued = set && allowed_glued(&p->of.equilibrium);
    if (!set) {
        *why = p->of.why;
    } else if (stance_null_set_modes(set, NULL, NULL) == 0 && !unreached) {
        complain(why, "no mode is unstable, so all starts are allowed");
    } else if (make_plane(p, why)) {
        panel->share = find_inside(p);
        if (panel->share > 0)
            trace(p, why);
        else
            complain(why, "none of these starts is allowed%s",
                     unreached ? ": no torque moves some of each" : "");
    }
    allowed_free(&p->of);
    return true;
}

bool plot_allowed_make(struct plot_allowed *allowed, struct gnuplot *g,
                       const struct plot_layout *layout, const struct plot_axis along[2])
{
    const struct results *const r = layout->r;
    *allowed = (struct plot_allowed){0};
    if (!g->plot->allowed)
        return true;
    struct picture *const p = gnuplot_room(g, 1, sizeof *p);
    allowed->panel = gnuplot_room(g, (size_t)layout->panels, sizeof *allowed->panel);
    if (!p || !allowed->panel)
        return false;
    p->s = results_swept(r, g->plot->message);
    if (!gnuplot_needs(g, p->s != NULL))
        return false;
    p->layout = layout;
    memcpy(p->along, along, sizeof p->along);
    stance_message first = {""};
    int without = 0;
    bool good = true;
    if (check_axes(p, &first))
        allowed->panels = layout->panels;
    for (int k = 0; good && k < allowed->panels; k++) {
        stance_message why = {""};
        p->panel = &allowed->panel[k];
        p->panel->point = gnuplot_room(g, MOST_POINTS, sizeof *p->panel->point);
        p->number = k;
        good = p->panel->point && gnuplot_needs(g, make_panel(p, &why, g->plot->message));
        if (why.text[0] && without++ == 0)
            first = why;
    }
    if (good && first.text[0]) {
        fprintf(stderr, "stance: warning: %s: no outline of what linear theory allows", r->file);
        if (allowed->panels > 1)
            fprintf(stderr, " in %d of %d panels", without, allowed->panels);
        fprintf(stderr, ": %s\n", first.text);
    }
    return good;
}

bool plot_allowed_same(const struct plot_allowed_panel *a, const struct plot_allowed_panel *b)
{
    bool same = a->points == b->points;
    for (size_t i = 0; same && i < a->points; i++)
        for (int k = 0; k < 2; k++)
            same = same && a->point[i].place[k] == b->point[i].place[k];
    return same;
}

/* ---- drawing ------------------------------------------------------------------------------ */

void plot_allowed_write(const struct plot_allowed_panel *panel, struct gnuplot *g,
                        const char *style)
{
    const size_t n = panel->points;
    size_t first = 0;
    bool open = false;
    while (first < n && !panel->point[first].edge)
        first++;
    gnuplot_series(g, "using 1:2 with lines %s", style);
    for (size_t i = 0; i < n + (first == n && n > 0); i++) { /* from an edge on, or closed */
        const struct plot_allowed_point *const point = &panel->point[(first + i) % n];
        if (!point->edge)
            GNUPLOT_ROW(g, point->place[0], point->place[1]);
        else if (open)
            gnuplot_gap(g);
        open = !point->edge;
    }
}

void plot_allowed_legend(const struct plot_allowed_panel *panel, int count, int dash,
                         struct gnuplot *g)
{
    char share[32] = "";
    bool same = isfinite(panel[0].share), any = same, glued = panel[0].glued;
    for (int k = 1; k < count; k++) {
        glued = glued || panel[k].glued;
        same = same && panel[k].share == panel[0].share;
        any = any || isfinite(panel[k].share);
    }
    if (!any)
        return;
    if (same)
        snprintf(share, sizeof share, "%.1f %%", 100 * panel[0].share);
    gnuplot_legend(g, "colour_allowed", dash, 0, "linear theory allows", share);
    gnuplot_note(g, "linear theory allows: some controller recovers, while the contacts stand");
    if (glued)
        gnuplot_note(g, ALLOWED_GLUED);
}
