/* plot_allowed.c - see plot_allowed.h.
 *
 * The states of a map's starts are a plane, x = origin + u side[0] + v side[1] with u and v in 0
 * ... 1, and the set is convex: so is its section by the plane, whose outline is where rays from a
 * point inside leave it or the map. Where three points of the outline are on a line, so is all
 * between them; elsewhere further rays go between. */
#include "plot_allowed.h"

#include "runner/base/message.h"
#include "runner/plan/allowed.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { RAYS = 32, DEEPEST = 9, HALVINGS = 20 };
#define STRAIGHT 1e-4 /* of the picture's sides */
#define PLANE 1e-9    /* of their states: how far starts may be off it */

struct section {
    struct allowed of;
    int n;
    double origin[DESIGN_STATES], side[2][DESIGN_STATES];
};

/* ---- the plane ---------------------------------------------------------------------------- */

/* What the panels of a picture have in common. */
struct picture {
    const struct plot_layout *layout;
    const struct results_axis *axis[2];
    struct plot_frame frame;
    size_t end[2][2]; /* of each axis: places of its least and its largest value */
    struct scenario s;
    struct scenario_values values; /* of the start that is looked at */
};

/* Both axes are starts, on even scales. */
static bool check_axes(struct picture *p, stance_message *why)
{
    for (int k = 0; k < 2; k++) {
        const struct results_axis *const axis = p->axis[k];
        const struct scenario_axis *const of = &p->s.axis[k == 0 ? p->layout->x : p->layout->y];
        for (int i = 0; i < of->paths; i++)
            if (!scenario_is_start(of->path[i]))
                return complain(why, "%.90s is no coordinate of a start", of->path[i]);
        p->end[k][0] = p->end[k][1] = 0;
        for (size_t i = 1; i < axis->count; i++)
            for (int end = 0; end < 2; end++)
                if ((axis->value[i] < axis->value[p->end[k][end]]) == (end == 0))
                    p->end[k][end] = i;
        if (p->end[k][0] == p->end[k][1])
            return complain(why, "%.90s has one value", axis->name);
        if (p->frame.scale[k] == PLOT_LIST)
            return complain(why, "the values of %.90s are not even", axis->name);
    }
    return true;
}

/* Where a value of an axis is between the picture's edges, 0 ... 1. */
static double part_of(const struct picture *p, int k, double value)
{
    const bool log = p->frame.scale[k] == PLOT_LOG;
    const double low = log ? pow(10, p->frame.low[k]) : p->frame.low[k],
                 high = log ? pow(10, p->frame.high[k]) : p->frame.high[k];
    return (value - low) / (high - low);
}

static double place_of(const struct picture *p, int k, double part)
{
    const double low = p->frame.low[k], high = p->frame.high[k];
    if (p->frame.scale[k] == PLOT_LOG)
        return log10(pow(10, low) + part * (pow(10, high) - pow(10, low)));
    return low + part * (high - low);
}

static void state_at(const struct section *s, const double part[2], double *x)
{
    for (int c = 0; c < s->n; c++)
        x[c] = s->origin[c] + part[0] * s->side[0][c] + part[1] * s->side[1][c];
}

/* The state in which a case of a panel starts. */
static void start_of(const struct section *s, struct picture *p, int panel, size_t i, size_t j,
                     double *x)
{
    double position[STANCE_MAX_COORDINATES], velocity[STANCE_MAX_COORDINATES];
    scenario_case_values(&p->s, plot_layout_index(p->layout, panel, i, j), &p->values);
    resolve_start(p->s.scene, &p->values, &s->of.design, position, velocity);
    allowed_state(&s->of, position, velocity, x);
}

/* How far a start is off the plane, as a part of the largest coordinates. */
static double off_plane(const struct section *s, struct picture *p, int panel, size_t i, size_t j)
{
    const double part[2] = {part_of(p, 0, p->axis[0]->value[i]),
                            part_of(p, 1, p->axis[1]->value[j])};
    double x[DESIGN_STATES], on[DESIGN_STATES], largest = 0, off = 0;
    start_of(s, p, panel, i, j, x);
    state_at(s, part, on);
    for (int c = 0; c < s->n; c++) {
        largest = fmax(largest, fabs(x[c]));
        off = fmax(off, fabs(x[c] - on[c]));
    }
    return off > 0 ? off / largest : 0;
}

static bool make_plane(struct section *s, struct picture *p, int panel, stance_message *why)
{
    const size_t *const low = (size_t[]){p->end[0][0], p->end[1][0]}, *const high =
                                                                          (size_t[]){p->end[0][1],
                                                                                     p->end[1][1]};
    double first[DESIGN_STATES], x[DESIGN_STATES];
    s->n = 2 * s->of.equilibrium.freedoms;
    start_of(s, p, panel, low[0], low[1], first);
    memcpy(s->origin, first, sizeof first);
    for (int k = 0; k < 2; k++) {
        const double begin = part_of(p, k, p->axis[k]->value[low[k]]),
                     end = part_of(p, k, p->axis[k]->value[high[k]]);
        start_of(s, p, panel, k == 0 ? high[0] : low[0], k == 1 ? high[1] : low[1], x);
        for (int c = 0; c < s->n; c++) {
            s->side[k][c] = (x[c] - first[c]) / (end - begin);
            s->origin[c] -= begin * s->side[k][c];
        }
    }
    double off = off_plane(s, p, panel, high[0], high[1]);
    for (size_t i = 0; i < p->axis[0]->count; i++)
        off = fmax(off, off_plane(s, p, panel, i, low[1]));
    for (size_t j = 0; j < p->axis[1]->count; j++)
        off = fmax(off, off_plane(s, p, panel, low[0], j));
    return off <= PLANE || complain(why, "the starts of the map are no plane");
}

/* ---- its outline -------------------------------------------------------------------------- */

struct end { /* of a ray */
    double angle, at[2];
    bool edge;
};

struct outline {
    const struct section *s;
    double inside[2];
    struct plot_allowed_panel *panel; /* takes the points, their places in parts of the picture */
    size_t room;
    bool failed; /* no memory */
};

/* Where a ray leaves the set or the picture. */
static struct end shoot(const struct outline *o, double angle)
{
    const double way[2] = {cos(angle), sin(angle)};
    double reach[2] = {0, INFINITY}, x[DESIGN_STATES];
    struct end end = {.angle = angle, .edge = true};
    for (int k = 0; k < 2; k++)
        if (way[k] != 0)
            reach[1] = fmin(reach[1], ((way[k] > 0 ? 1 : 0) - o->inside[k]) / way[k]);
    for (int round = 0; round < HALVINGS; round++) {
        const double r = round == 0 ? reach[1] : 0.5 * (reach[0] + reach[1]);
        for (int k = 0; k < 2; k++)
            end.at[k] = o->inside[k] + r * way[k];
        state_at(o->s, end.at, x);
        const bool holds = stance_null_set_holds(o->s->of.set, x);
        if (round == 0 && holds)
            return end;
        end.edge = false;
        reach[holds ? 0 : 1] = r;
    }
    return end;
}

static void keep(struct outline *o, struct end end)
{
    struct plot_allowed_panel *const panel = o->panel;
    if (panel->points == o->room) {
        const size_t room = 2 * o->room + RAYS;
        struct plot_allowed_point *const grown = realloc(panel->point, room * sizeof *grown);
        o->failed |= !grown;
        if (!grown)
            return;
        panel->point = grown;
        o->room = room;
    }
    panel->point[panel->points++] = (struct plot_allowed_point){{end.at[0], end.at[1]}, end.edge};
}

/* Keeps what is between two ends. */
static void refine(struct outline *o, struct end a, struct end b, int depth)
{
    const struct end middle = shoot(o, 0.5 * (a.angle + b.angle));
    const double across[2] = {b.at[0] - a.at[0], b.at[1] - a.at[1]};
    const double off = across[0] * (middle.at[1] - a.at[1]) - across[1] * (middle.at[0] - a.at[0]);
    const bool straight = a.edge == b.edge && middle.edge == a.edge &&
                          fabs(off) <= STRAIGHT * hypot(across[0], across[1]);
    if (depth == 0 || straight || o->failed)
        return;
    refine(o, a, middle, depth - 1);
    keep(o, middle);
    refine(o, middle, b, depth - 1);
}

/* ---- panels ------------------------------------------------------------------------------- */

/* The share of the panel's starts that are in the set, and their mean, which then is. */
static double find_inside(const struct section *s, const struct picture *p, double mean[2])
{
    const size_t count[2] = {p->axis[0]->count, p->axis[1]->count};
    double inside = 0, sum[2] = {0}, x[DESIGN_STATES];
    for (size_t i = 0; i < count[0]; i++)
        for (size_t j = 0; j < count[1]; j++) {
            const double part[2] = {part_of(p, 0, p->axis[0]->value[i]),
                                    part_of(p, 1, p->axis[1]->value[j])};
            state_at(s, part, x);
            const bool holds = stance_null_set_holds(s->of.set, x);
            inside += holds;
            for (int k = 0; k < 2; k++)
                sum[k] += holds ? part[k] : 0;
        }
    for (int k = 0; k < 2; k++)
        mean[k] = sum[k] / inside;
    return inside / (double)count[0] / (double)count[1];
}

/* `why`: nothing is to be seen. */
static bool make_panel(struct plot_allowed_panel *panel, struct picture *p, int number,
                       stance_message *why, stance_message *message)
{
    struct section s;
    struct outline o = {.s = &s, .panel = panel};
    panel->share = NAN;
    bool good = allowed_make(&s.of, &p->s, plot_layout_index(p->layout, number, 0, 0), message);
    if (!good)
        return false;
    const bool unreached = s.of.set && stance_null_set_unreached(s.of.set, NULL, NULL) > 0;
    panel->glued = s.of.set && allowed_glued(&s.of.equilibrium);
    if (!s.of.set) {
        *why = s.of.why;
    } else if (stance_null_set_modes(s.of.set, NULL, NULL) == 0 && !unreached) {
        complain(why, "no mode is unstable, so all starts are allowed");
    } else if (make_plane(&s, p, number, why)) {
        panel->share = find_inside(&s, p, o.inside);
        if (panel->share == 0)
            complain(why, "none of these starts is allowed%s",
                     unreached ? ": no torque moves some of each" : "");
        struct end last = {0};
        for (int k = 0; panel->share > 0 && k <= RAYS; k++) {
            const struct end next = shoot(&o, 2 * acos(-1) * k / RAYS);
            if (k > 0) {
                keep(&o, last);
                refine(&o, last, next, DEEPEST);
            }
            last = next;
        }
        good = !o.failed || no_memory(message);
        size_t edges = 0;
        for (size_t i = 0; i < panel->points; i++) {
            struct plot_allowed_point *const point = &panel->point[i];
            for (int k = 0; k < 2; k++)
                point->place[k] = place_of(p, k, point->place[k]);
            edges += point->edge;
        }
        if (panel->points > 0 && edges == panel->points)
            complain(why, "all of these starts are allowed");
    }
    allowed_free(&s.of);
    return good;
}

bool plot_allowed_make(struct plot_allowed *allowed, struct gnuplot *g,
                       const struct plot_layout *layout, const struct plot_frame *frame)
{
    const struct results *const r = layout->r;
    *allowed = (struct plot_allowed){0};
    if (!g->plot->allowed)
        return true;
    struct picture *const p = gnuplot_room(g, 1, sizeof *p);
    allowed->panel = gnuplot_room(g, (size_t)layout->panels, sizeof *allowed->panel);
    if (!p || !allowed->panel || !gnuplot_needs(g, results_swept(r, &p->s, g->plot->message)))
        return false;
    p->layout = layout, p->frame = *frame;
    p->axis[0] = &r->axis[layout->x], p->axis[1] = &r->axis[layout->y];
    stance_message first = {""};
    int without = 0;
    bool good = true;
    if (check_axes(p, &first))
        allowed->panels = layout->panels;
    for (int k = 0; good && k < allowed->panels; k++) {
        stance_message why = {""};
        good = gnuplot_needs(g, make_panel(&allowed->panel[k], p, k, &why, g->plot->message));
        if (allowed->panel[k].point)
            gnuplot_keep(g, allowed->panel[k].point);
        if (why.text[0] && without++ == 0)
            first = why;
    }
    if (good && first.text[0]) {
        fprintf(stderr, "stance: warning: %s: no outline of what linear theory allows", r->file);
        if (allowed->panels > 1)
            fprintf(stderr, " in %d of %d panels", without, allowed->panels);
        fprintf(stderr, ": %s\n", first.text);
    }
    scenario_free(&p->s);
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

void plot_allowed_write(const struct plot_allowed_panel *panel, struct gnuplot *g, int number)
{
    const size_t n = panel->points;
    size_t first = 0;
    bool open = false;
    while (first < n && !panel->point[first].edge)
        first++;
    gnuplot_block(g, "allowed%d", number);
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
    gnuplot_set(g, "allowed = %d", any);
    if (!any)
        return;
    if (same)
        snprintf(share, sizeof share, "%.1f %%", 100 * panel[0].share);
    gnuplot_legend(g, "colour_allowed", dash, 0, "linear theory allows", share);
    gnuplot_note(g, "linear theory allows: some controller recovers, while the contacts stand");
    if (glued)
        gnuplot_note(g, ALLOWED_GLUED);
}
