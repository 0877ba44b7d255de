/* plot_model.c - the robot of a scenario in its first posture: coordinates with their names, zeros
 * and signs, actuators, contacts, which way is positive.
 *
 * Nothing here knows a scene. What a coordinate does is seen from what it moves: points p of the
 * stick figure with velocities v at its unit rate, about p + (-v_z, v_x) if they turn, along v if
 * they slide. Its own link is the one that the fewest other coordinates move.
 */
#include "plot_case.h"

#include "runner/plan/asked.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_LABELS = 40, ARC_STEPS = 24, GROUND_PIECES = 256 };

/* Whose colour something has in the script. */
enum ink { INK_COORDINATE, INK_ACTUATOR, INK_CONTACT };

/* How one coordinate moves the figure. */
struct moved {
    bool turns, all;  /* an angle; moves every point */
    double centre[2]; /* m, of the turn */
    double along[2];  /* of a slide, of length 1 */
    double point[2];  /* m, where its link ends */
    double direction; /* rad, from the centre to that point, counter-clockwise from +x */
    double shown;     /* rad, of the arc from where the angle is 0; 0: it only shows the sign */
    double radius, torque; /* m, of the arcs of its angle and of its actuator */
};

/* Of what is at `of`, m. */
struct label {
    const char *text;
    double of[2];
    enum ink ink;
    bool placed;
};

struct model {
    const stance_scene *scene;
    const stance_case *c;
    int points;
    double point[STANCE_MAX_POINTS][2];
    double velocity[STANCE_MAX_COORDINATES][STANCE_MAX_POINTS][2]; /* at unit rates */
    struct moved moved[STANCE_MAX_COORDINATES];
    struct plot_range range[2]; /* m: of what is drawn so far, x and z */
    double size;                /* of the figure */
    struct gnuplot *g;
    int labels; /* so far */
    struct label label[MOST_LABELS];
};

/* ---- what coordinates move ---------------------------------------------------------------- */

static bool is_still(const double v[2])
{
    return hypot(v[0], v[1]) < 1e-6;
}

/* Of the points that coordinate k moves the one that the fewest others do; among them the nearest
 * to the centre of its turn that is not there. -1: none. */
static int own_point(const struct model *m, int k)
{
    int own = -1, fewest = 0;
    double nearest = 0;
    for (int p = 0; p < m->points; p++) {
        int others = 0;
        const double away = m->moved[k].turns ? hypot(m->point[p][0] - m->moved[k].centre[0],
                                                      m->point[p][1] - m->moved[k].centre[1])
                                              : 0;
        if (is_still(m->velocity[k][p]) || (m->moved[k].turns && away < 1e-3 * m->size))
            continue;
        for (int other = 0; other < m->scene->coordinates; other++)
            others += !is_still(m->velocity[other][p]);
        if (own < 0 || others < fewest || (others == fewest && away < nearest + 1e-9 * m->size)) {
            own = p;
            fewest = others;
            nearest = away;
        }
    }
    return own;
}

static void find_motion(struct model *m, int k)
{
    struct moved *const moved = &m->moved[k];
    int fastest = 0, still = 0;
    for (int p = 0; p < m->points; p++) {
        const double *v = m->velocity[k][p], *most = m->velocity[k][fastest];
        still += is_still(v);
        if (hypot(v[0], v[1]) > hypot(most[0], most[1]))
            fastest = p;
    }
    const double *v = m->velocity[k][fastest], speed = fmax(hypot(v[0], v[1]), 1e-300);
    moved->turns = strcmp(m->scene->coordinate[k].unit, "rad") == 0;
    moved->all = still == 0;
    moved->centre[0] = m->point[fastest][0] - v[1];
    moved->centre[1] = m->point[fastest][1] + v[0];
    moved->along[0] = v[0] / speed;
    moved->along[1] = v[1] / speed;
    const int own = own_point(m, k);
    memcpy(moved->point, m->point[own < 0 ? 0 : own], sizeof moved->point);
    const double away[] = {moved->point[0] - moved->centre[0], moved->point[1] - moved->centre[1]},
                 angle = remainder(m->c->position[k], 2 * M_PI),
                 reach = fmin(m->size, 2.2 * hypot(away[0], away[1])); /* in proportion to it */
    int rank = 0; /* those that turn about the same place have each a radius of its own */
    for (int other = 0; other < k; other++)
        rank += m->moved[other].turns &&
                hypot(m->moved[other].centre[0] - moved->centre[0],
                      m->moved[other].centre[1] - moved->centre[1]) < 1e-3 * m->size;
    moved->direction = atan2(away[1], away[0]);
    moved->shown = fabs(angle) < 0.1 ? 0 : angle;
    moved->radius = reach * (0.15 + 0.08 * rank);
    moved->torque = reach * (0.33 + 0.05 * rank);
}

static void make_model(struct model *m)
{
    m->points = m->scene->figure(m->scene, m->c->robot, m->c->position, m->point);
    m->size = 1e-6;
    for (int i = 0; i < 2; i++) {
        m->range[i] = PLOT_NOTHING;
        for (int p = 0; p < m->points; p++)
            plot_widen(&m->range[i], m->point[p][i]);
        m->size = fmax(m->size, m->range[i].high - m->range[i].low);
    }
    for (int k = 0; k < m->scene->coordinates; k++) {
        static const double step = 1e-6;
        double position[STANCE_MAX_COORDINATES], ahead[STANCE_MAX_POINTS][2];
        memcpy(position, m->c->position, sizeof position);
        position[k] += step;
        m->scene->figure(m->scene, m->c->robot, position, ahead);
        for (int p = 0; p < m->points; p++)
            for (int i = 0; i < 2; i++)
                m->velocity[k][p][i] = (ahead[p][i] - m->point[p][i]) / step;
    }
    for (int k = 0; k < m->scene->coordinates; k++)
        find_motion(m, k);
}

/* ---- drawing ------------------------------------------------------------------------------ */

/* The next label, at the left of the robot or at its right, of what is at `of`. */
static void label(struct model *m, enum ink ink, const double of[2], const char *text)
{
    if (m->labels < MOST_LABELS)
        m->label[m->labels++] =
            (struct label){look_label(m->g->plot->look, text), {of[0], of[1]}, ink, false};
}

/* At a radius about the centre of a turn, at an angle. */
static void place_at(const struct moved *moved, double radius, double angle, double place[2])
{
    place[0] = moved->centre[0] + radius * cos(angle);
    place[1] = moved->centre[1] + radius * sin(angle);
}

/* A row: where an arrow begins, how far it goes, its ink, whether it has a head. */
static void arrow(struct model *m, const double from[2], double dx, double dz, enum ink ink,
                  bool head)
{
    for (int end = 0; end < 2; end++) {
        plot_widen(&m->range[0], from[0] + end * dx);
        plot_widen(&m->range[1], from[1] + end * dz);
    }
    GNUPLOT_ROW(m->g, from[0], from[1], dx, dz, ink, head);
}

/* From one angle to another; its last piece has a head. */
static void arc(struct model *m, const struct moved *moved, enum ink ink, double radius,
                double from, double to)
{
    double a[2], b[2];
    for (int i = 0; i < ARC_STEPS; i++) {
        place_at(moved, radius, from + (to - from) * i / ARC_STEPS, a);
        place_at(moved, radius, from + (to - from) * (i + 1) / ARC_STEPS, b);
        arrow(m, a, b[0] - a[0], b[1] - a[1], ink, i + 1 == ARC_STEPS);
    }
}

/* Of a base that moves along x and z: one label has both. */
static bool is_place(const struct model *m, int k)
{
    const struct moved *const moved = m->moved;
    return k < 2 && m->scene->coordinates > 1 && moved[0].all && moved[1].all && !moved[0].turns &&
           !moved[1].turns;
}

/* To either side as far as it may be seen; pieces by footfall are not there yet. */
static void put_ground(struct model *m)
{
    static struct plot_case even; /* large; nothing else of it is known */
    even.values.robot[STANCE_ROBOT_SLOPE] = m->c->robot[STANCE_ROBOT_SLOPE];
    even.floor = m->scene->mechanism->plates > 0 ? (stance_case *)m->c : NULL;
    if (even.floor)
        ground_pieces_find(m->c, NULL, &even.pieces);
    gnuplot_series(m->g,
                   "using 1:(at_least($2, y1_low)):(y1_low) with filledcurves fc rgb 0xf0f0f0 "
                   "notitle, '' using 1:2 with lines lw 2 lc rgb 0xa0a0a0");
    /* In pieces: of one that leaves the picture below not only its end is drawn. */
    const double left = m->range[0].low - 4 * m->size;
    const double piece = (m->range[0].high + 4 * m->size - left) / GROUND_PIECES;
    for (int k = 0; k < GROUND_PIECES; k++)
        plot_ground(m->g, &even, 0, (struct plot_range){left + k * piece, left + (k + 1) * piece},
                    0, 0);
}

static void put_lines(struct model *m)
{
    gnuplot_series(m->g, "using 1:2 with lines lw 3.4 lc rgb 0x303030 notitle, '' using 1:2 with "
                         "points pt 7 ps 0.7 lc rgb 0x303030");
    for (int p = 0; p < m->points; p++)
        GNUPLOT_ROW(m->g, m->point[p][0], m->point[p][1]);
    gnuplot_series(m->g, "using 1:2 with lines dt 2 lw 1.2 lc rgb 0x606060");
    for (int k = 0; k < m->scene->coordinates; k++) {
        const struct moved *const moved = &m->moved[k];
        double end[2];
        place_at(moved, 1.25 * moved->radius, moved->direction - moved->shown, end);
        if (moved->turns)
            gnuplot_segment(m->g, moved->centre[0], moved->centre[1], end[0], end[1]);
    }
}

/* An arc from where the angle is 0, or one that only shows the sign. */
static void put_coordinate(struct model *m, int k)
{
    const struct moved *const moved = &m->moved[k];
    double of[2];
    if (moved->turns) {
        const double angle = moved->shown;
        arc(m, moved, INK_COORDINATE, moved->radius, moved->direction - angle,
            moved->direction + (angle == 0 ? 0.6 : 0));
        place_at(moved, moved->radius, moved->direction + (angle == 0 ? 0.3 : -0.5 * angle), of);
    } else if (is_place(m, k)) {
        if (k == 1)
            label(m, INK_COORDINATE, m->c->position, "(x, z)");
        return;
    } else { /* from where it is 0; near that the arrow shows the sign */
        const double q = m->c->position[k], side = 0.05 * m->size;
        const bool sign = moved->all || fabs(q) < 0.02 * m->size;
        const double far = sign ? 0.18 * m->size : q;
        for (int i = 0; i < 2; i++)
            of[i] = moved->point[i] - (sign ? 0 : q * moved->along[i]) +
                    side * (i ? moved->along[0] : -moved->along[1]);
        arrow(m, of, far * moved->along[0], far * moved->along[1], INK_COORDINATE, true);
        for (int i = 0; i < 2; i++)
            of[i] += 0.5 * far * moved->along[i];
    }
    label(m, INK_COORDINATE, of, m->scene->coordinate[k].name);
}

static void put_actuator(struct model *m, int a)
{
    const struct moved *const moved = &m->moved[m->scene->actuated[a]];
    const double dx = m->size * moved->along[0], dz = m->size * moved->along[1];
    double of[2] = {moved->point[0] + 0.11 * dx, moved->point[1] + 0.11 * dz};
    if (moved->turns) {
        arc(m, moved, INK_ACTUATOR, moved->torque, moved->direction + 0.12, moved->direction + 0.7);
        place_at(moved, moved->torque, moved->direction + 0.5, of);
    } else {
        arrow(m, moved->point, 0.18 * dx, 0.18 * dz, INK_ACTUATOR, true);
    }
    label(m, INK_ACTUATOR, of, m->scene->actuator_name[a]);
}

/* The arrows of all things. */
static void put_things(struct model *m)
{
    gnuplot_series(m->g,
                   "using 1:($6 == 0 ? $2 : NaN):3:4:(ink[$5+1]) with vectors nohead lw 2 lc rgb "
                   "variable notitle, '' using 1:($6 == 1 ? $2 : NaN):3:4:(ink[$5+1]) with vectors "
                   "head filled size screen 0.011,22 fixed lw 2 lc rgb variable");
    for (int k = 0; k < m->scene->coordinates; k++)
        put_coordinate(m, k);
    for (int a = 0; a < m->scene->actuators; a++)
        put_actuator(m, a);
    for (int k = 0; k < plot_case_grounded(m->scene); k++) {
        static const double rest[STANCE_MAX_COORDINATES];
        const double slope = m->c->robot[STANCE_ROBOT_SLOPE], length = 0.13 * m->size;
        double p[2], speed[2];
        m->scene->contact_point(m->scene, m->c->robot, m->c->position, rest, k, p, speed);
        arrow(m, p, length * sin(slope), length * cos(slope), INK_CONTACT, true);
        arrow(m, p, length * cos(slope), -length * sin(slope), INK_CONTACT, true);
        label(m, INK_CONTACT, p, m->scene->contact_name[k]);
    }
}

/* Labels of coordinates stand in a column at the left, the others in one at the right, from below
 * in the order of what they name and a line apart, also where the page is narrow. */
static void put_labels(struct model *m)
{
    struct plot_range *const x = &m->range[0], *const z = &m->range[1];
    *x = plot_roomy(*x, 0.12);
    *z = plot_roomy(*z, 0.12);
    const double wide = fmax(x->high - x->low, 0.6 * (z->high - z->low)), line = 0.07 * wide,
                 middle = 0.5 * (x->low + x->high);
    gnuplot_series(m->g, "using 1:2:($5-$1):($6-$2):(ink[$4+1]) with vectors nohead lw 0.7 lc rgb "
                         "variable notitle, '' using 1:2:(label_text[$3]):(ink[$4+1]) with labels "
                         "center font ',13' tc rgb variable boxed");
    for (int right = 0; right < 2; right++) {
        const struct label *lowest;
        double height = -INFINITY;
        do {
            int next = -1;
            for (int k = 0; k < m->labels; k++)
                if ((m->label[k].ink != INK_COORDINATE) == right && !m->label[k].placed &&
                    (next < 0 || m->label[k].of[1] < m->label[next].of[1]))
                    next = k;
            lowest = next < 0 ? NULL : &m->label[next];
            if (lowest) {
                m->label[next].placed = true;
                height = fmax(lowest->of[1], height + line);
                plot_widen(z, height + line);
                GNUPLOT_ROW(m->g, middle + (right ? 0.6 : -0.6) * wide, height, next + 1,
                            lowest->ink, lowest->of[0], lowest->of[1]);
            }
        } while (lowest);
    }
    *x = (struct plot_range){middle - 0.72 * wide, middle + 0.72 * wide};
    gnuplot_arrays(m->g, MOST_LABELS, "label_text");
    for (int k = 0; k < m->labels; k++)
        gnuplot_text(m->g, m->label[k].text, "label_text[%d]", k + 1);
}

/* Each coordinate's value and meaning. */
static void put_words(struct model *m)
{
    static const double dust = 1e-12; /* m, rad: what equilibria leave of a 0 */
    struct gnuplot *const g = m->g;
    char text[100];
    for (int k = 0; k < m->scene->coordinates; k++) {
        const stance_quantity *const q = &m->scene->coordinate[k];
        const double at = fabs(m->c->position[k]) < dust ? 0 : m->c->position[k];
        snprintf(text, sizeof text, "%.40s = %.4g %.20s", q->name, at, q->unit);
        gnuplot_legend(g, "ink[1]", 0, 0, text, "");
        gnuplot_about(g, "%.120s", q->text);
    }
    for (int a = 0; a < m->scene->actuators; a++) {
        const int k = m->scene->actuated[a];
        const char *const name = m->scene->coordinate[k].name;
        const double x = m->moved[k].along[0], z = m->moved[k].along[1]; /* of a slide */
        gnuplot_legend(g, "ink[2]", 0, 0, m->scene->actuator_name[a], "");
        if (m->moved[k].turns)
            gnuplot_about(g, "positive raises %.40s", name);
        else
            gnuplot_about(g, "positive pushes %.40s along its axis, %s", name,
                          fabs(x) > fabs(z) ? (x > 0 ? "to the right" : "to the left")
                          : z > 0           ? "up"
                                            : "down");
    }
    if (plot_case_grounded(m->scene) > 0) {
        gnuplot_legend(g, "ink[3]", 0, 0, "contacts", "");
        gnuplot_about(g, "positive forces of the ground, normal and tangential");
    }
    gnuplot_note(g, "x points forward (right), z up; angles and torques: counter-clockwise");
    gnuplot_note(g, "dashed: where an angle is 0");
}

static int draw_model(const struct scenario *s, const stance_case *c, void *asked)
{
    enum { WIDE = 632 }; /* px */
    struct look *const look = asked;
    stance_message message;
    const struct plot plot = {.title = s->title[0] ? s->title : s->name,
                              .directory = look->directory ? look->directory : ".",
                              .stem = s->name,
                              .look = look,
                              .message = &message};
    struct gnuplot g;
    if (!look->file && !gnuplot_directory(plot.directory))
        return EXIT_IO;
    bool good = gnuplot_begin(&g, &plot, "model");
    struct model *const m = good ? gnuplot_room(&g, 1, sizeof *m) : NULL;
    if (m) {
        m->scene = s->scene;
        m->c = c;
        m->g = &g;
        make_model(m);
        gnuplot_say(&g, "The model in its first posture, scene %.60s", s->scene->name);
        gnuplot_set(
            &g,
            "array ink[3] = [shade(0x0072b2), shade(0xd55e00), shade(0x009e73)]; plain = "
            "equal = scaled = 1; set style textbox opaque noborder margins 0.3,0.1; set clip two; "
            "chart_width = %d",
            WIDE);
        gnuplot_panel(&g, 0, "");
        put_ground(m);
        put_lines(m);
        put_things(m);
        put_labels(m);
        if (is_place(m, 0)) {
            gnuplot_series(&g, "using 1:2 with points pt 6 ps 2 lw 2 lc rgb ink[1]");
            GNUPLOT_ROW(&g, c->position[0], c->position[1]);
        }
        put_words(m);
        const double tall = m->range[1].high - m->range[1].low;
        gnuplot_set(&g, "panel_own[1] = %.10g", WIDE * tall / (m->range[0].high - m->range[0].low));
        gnuplot_axis(&g, 'x', PLOT_LINEAR, m->range[0], "", "");
        gnuplot_axis(&g, 'y', PLOT_LINEAR, m->range[1], "", "");
    }
    good = good && gnuplot_end(&g);
    if (!good)
        fprintf(stderr, "%s\n", message.text);
    return good ? EXIT_DONE : EXIT_IO;
}

int plot_model(const struct command *command, const char *file, const struct option_texts *sets,
               struct look *look)
{
    struct scenario *const s = calloc(1, sizeof *s);
    int code = EXIT_USAGE;
    if (s && scenario_read(s, file, NULL, sets->text, sets->count, stderr)) {
        code = asked_first(command, s, draw_model, look);
        scenario_free(s);
    }
    free(s);
    return code;
}
