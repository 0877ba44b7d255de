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

GNUPLOT_SCRIPT(plot_model_gp, "analysis/plot/plot_model.gp");

enum { MOST_LABELS = 40, ARC_STEPS = 24 };

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

/* At a place, of what is at `of`, all in m. */
struct label {
    const char *text;
    double x, z, of[2];
    enum ink ink;
};

struct model {
    const stance_scene *scene;
    const stance_case *c;
    int points;
    double point[STANCE_MAX_POINTS][2];
    double velocity[STANCE_MAX_COORDINATES][STANCE_MAX_POINTS][2]; /* at unit rates */
    struct moved moved[STANCE_MAX_COORDINATES];
    struct plot_range range[2]; /* m: of the figure, x and z */
    double size;
    struct gnuplot *g;
    int labels, words; /* so far */
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

static void label(struct model *m, enum ink ink, double x, double z, const double of[2],
                  const char *text)
{
    if (m->labels < MOST_LABELS)
        m->label[m->labels++] = (struct label){text, x, z, {of[0], of[1]}, ink};
}

/* At a radius about the centre of a turn, at an angle. */
static void place_at(const struct moved *moved, double radius, double angle, double place[2])
{
    place[0] = moved->centre[0] + radius * cos(angle);
    place[1] = moved->centre[1] + radius * sin(angle);
}

/* From one angle to another; its last piece has a head. Rows: where a piece begins, how far it
 * goes, its ink, whether it has a head. */
static void arc(struct model *m, const struct moved *moved, enum ink ink, double radius,
                double from, double to)
{
    double a[2], b[2];
    for (int i = 0; i < ARC_STEPS; i++) {
        place_at(moved, radius, from + (to - from) * i / ARC_STEPS, a);
        place_at(moved, radius, from + (to - from) * (i + 1) / ARC_STEPS, b);
        GNUPLOT_ROW(m->g, a[0], a[1], b[0] - a[0], b[1] - a[1], ink, i + 1 == ARC_STEPS);
    }
}

/* A rail's coordinate is far from where it is 0, perhaps: an arrow shows its sign. */
static bool is_place(const struct model *m, int k)
{
    const struct moved *const moved = m->moved;
    return k < 2 && m->scene->coordinates > 1 && moved[0].all && moved[1].all && !moved[0].turns &&
           !moved[1].turns;
}

/* Uneven ground, to either side as far as it may be seen; pieces by footfall are not there yet. */
static void put_ground(struct model *m)
{
    double(*const point)[2] = gnuplot_room(m->g, PLOT_GROUND, sizeof *point);
    struct ground_pieces pieces;
    gnuplot_set(m->g, "uneven = %d", m->scene->mechanism->plates > 0);
    gnuplot_block(m->g, "ground");
    GNUPLOT_ROW(m->g, NAN, NAN);
    if (m->scene->mechanism->plates == 0 || !point)
        return;
    ground_pieces_find(m->c, NULL, &pieces);
    const size_t points = ground_line(m->c, &pieces, 0, m->range[0].low - 4 * m->size,
                                      m->range[0].high + 4 * m->size, point, PLOT_GROUND);
    for (size_t k = 0; k < points; k++)
        GNUPLOT_ROW(m->g, point[k][0], point[k][1]);
}

static void put_lines(struct model *m)
{
    gnuplot_block(m->g, "segments");
    for (int p = 0; p < m->points; p++)
        GNUPLOT_ROW(m->g, m->point[p][0], m->point[p][1]);
    gnuplot_block(m->g, "zeros");
    GNUPLOT_ROW(m->g, NAN, NAN);
    for (int k = 0; k < m->scene->coordinates; k++) {
        const struct moved *const moved = &m->moved[k];
        const double zero = moved->direction - moved->shown, length = 1.25 * moved->radius;
        if (!moved->turns)
            continue;
        gnuplot_gap(m->g);
        gnuplot_segment(m->g, moved->centre[0], moved->centre[1],
                        moved->centre[0] + length * cos(zero),
                        moved->centre[1] + length * sin(zero));
    }
}

/* Beside the arc, beyond where the angle is 0; an arc that only shows the sign: at its end. */
static void put_coordinate(struct model *m, int k)
{
    const struct moved *const moved = &m->moved[k];
    const char *const name = m->scene->coordinate[k].name;
    double at[2], of[2];
    if (moved->turns) {
        const double angle = moved->shown, radius = moved->radius, gap = 0.06 * m->size / radius,
                     end = moved->direction + (angle == 0 ? 0.6 : 0);
        arc(m, moved, INK_COORDINATE, radius, moved->direction - angle, end);
        place_at(moved, radius, angle == 0 ? end + gap : end - angle - copysign(gap, angle), at);
        place_at(moved, radius, moved->direction + (angle == 0 ? 0.3 : -0.5 * angle), of);
        label(m, INK_COORDINATE, at[0], at[1], of, name);
    } else if (!is_place(m, k)) { /* from where it is 0; near that the arrow shows the sign */
        const double q = m->c->position[k], side = 0.05 * m->size;
        const bool sign = moved->all || fabs(q) < 0.02 * m->size;
        const double far = sign ? 0.18 * m->size : q;
        for (int i = 0; i < 2; i++)
            of[i] = moved->point[i] - (sign ? 0 : q * moved->along[i]) +
                    side * (i ? moved->along[0] : -moved->along[1]);
        GNUPLOT_ROW(m->g, of[0], of[1], far * moved->along[0], far * moved->along[1],
                    INK_COORDINATE, 1);
        for (int i = 0; i < 2; i++)
            of[i] += 0.5 * far * moved->along[i];
        label(m, INK_COORDINATE, of[0] - side * moved->along[1], of[1] + side * moved->along[0], of,
              name);
    }
}

static void put_actuator(struct model *m, int a)
{
    const int k = m->scene->actuated[a];
    const struct moved *const moved = &m->moved[k];
    const double x = moved->point[0], z = moved->point[1], dx = m->size * moved->along[0],
                 dz = m->size * moved->along[1];
    double at[2] = {x + 0.22 * dx, z + 0.22 * dz}, of[2] = {x + 0.11 * dx, z + 0.11 * dz};
    if (moved->turns) {
        arc(m, moved, INK_ACTUATOR, moved->torque, moved->direction + 0.12, moved->direction + 0.7);
        place_at(moved, moved->torque + 0.05 * m->size, moved->direction + 0.6, at);
        place_at(moved, moved->torque, moved->direction + 0.5, of);
    } else {
        GNUPLOT_ROW(m->g, x, z, 0.18 * dx, 0.18 * dz, INK_ACTUATOR, 1);
    }
    label(m, INK_ACTUATOR, at[0], at[1], of, m->scene->actuator_name[a]);
}

/* The arrows of all things and, after them, their labels. */
static void put_things(struct model *m)
{
    gnuplot_block(m->g, "arrows");
    for (int k = 0; k < m->scene->coordinates; k++)
        put_coordinate(m, k);
    for (int a = 0; a < m->scene->actuators; a++)
        put_actuator(m, a);
    for (int k = 0; k < plot_case_grounded(m->scene); k++) {
        static const double rest[STANCE_MAX_COORDINATES];
        const double slope = m->c->robot[STANCE_ROBOT_SLOPE], length = 0.13 * m->size;
        double p[2], speed[2];
        m->scene->contact_point(m->scene, m->c->robot, m->c->position, rest, k, p, speed);
        GNUPLOT_ROW(m->g, p[0], p[1], length * sin(slope), length * cos(slope), INK_CONTACT, 1);
        GNUPLOT_ROW(m->g, p[0], p[1], length * cos(slope), -length * sin(slope), INK_CONTACT, 1);
        label(m, INK_CONTACT, p[0], p[1] - 0.06 * m->size, p, m->scene->contact_name[k]);
    }
    gnuplot_arrays(m->g, MOST_LABELS, "label_text label_x label_y label_ink of_x of_y");
    gnuplot_set(m->g, "labels = %d", m->labels);
    for (int k = 0; k < m->labels; k++) {
        const struct label *const l = &m->label[k];
        gnuplot_text(m->g, look_label(m->g->plot->look, l->text), "label_text[%d]", k + 1);
        gnuplot_set(m->g,
                    "k = %d; label_x[k] = %#.9g; label_y[k] = %#.9g; label_ink[k] = %d; "
                    "of_x[k] = %#.9g; of_y[k] = %#.9g",
                    k + 1, l->x, l->z, l->ink, l->of[0], l->of[1]);
    }
}

/* The next line of what stands beside the figure. */
static void word(struct model *m, enum ink ink, const char *text)
{
    m->words++;
    gnuplot_text(m->g, text, "word_text[%d]", m->words);
    gnuplot_set(m->g, "word_ink[%d] = %d", m->words, ink);
}

/* Each coordinate's value and meaning. */
static void put_words(struct model *m)
{
    static const double dust = 1e-12; /* m, rad: what equilibria leave of a 0 */
    char text[240];
    gnuplot_arrays(m->g, STANCE_MAX_COORDINATES + STANCE_MAX_ACTUATORS + 2, "word_text word_ink");
    for (int k = 0; k < m->scene->coordinates; k++) {
        const stance_quantity *const q = &m->scene->coordinate[k];
        const double at = fabs(m->c->position[k]) < dust ? 0 : m->c->position[k];
        snprintf(text, sizeof text, "%.40s = %.4g %.20s: %.120s", q->name, at, q->unit, q->text);
        word(m, INK_COORDINATE, text);
    }
    for (int a = 0; a < m->scene->actuators; a++) {
        const int k = m->scene->actuated[a];
        const char *const name = m->scene->coordinate[k].name;
        const double x = m->moved[k].along[0], z = m->moved[k].along[1]; /* of a slide */
        if (m->moved[k].turns)
            snprintf(text, sizeof text, "%.40s: positive raises %.40s", m->scene->actuator_name[a],
                     name);
        else
            snprintf(text, sizeof text, "%.40s: positive pushes %.40s along its axis, %s",
                     m->scene->actuator_name[a], name,
                     fabs(x) > fabs(z) ? (x > 0 ? "to the right" : "to the left")
                     : z > 0           ? "up"
                                       : "down");
        word(m, INK_ACTUATOR, text);
    }
    if (plot_case_grounded(m->scene) > 0)
        word(m, INK_CONTACT, "contacts: positive forces of the ground, normal and tangential");
    gnuplot_set(m->g, "words_shown = %d", m->words);
}

static int draw_model(const struct scenario *s, const stance_case *c, void *asked)
{
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
    bool good = gnuplot_begin(&g, &plot, "model", plot_model_gp);
    struct model *const m = good ? gnuplot_room(&g, 1, sizeof *m) : NULL;
    if (m) {
        m->scene = s->scene;
        m->c = c;
        m->g = &g;
        make_model(m);
        gnuplot_say(&g, "The model in its first posture, scene %.60s", s->scene->name);
        gnuplot_set(&g,
                    "low_x = %#.9g; high_x = %#.9g; low_y = %#.9g; high_y = %#.9g; size = %#.9g",
                    m->range[0].low, m->range[0].high, m->range[1].low, m->range[1].high, m->size);
        gnuplot_set(&g, "has_place = %d; place_x = %#.9g; place_y = %#.9g; fall = %#.9g",
                    is_place(m, 0), c->position[0], c->position[1],
                    tan(c->robot[STANCE_ROBOT_SLOPE]));
        put_ground(m);
        put_lines(m);
        put_things(m);
        put_words(m);
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
