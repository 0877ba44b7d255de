/* mechanism_figure.c - the stick figure of a mechanism: one line through the tree that passes every
 * link there and back. */
#include "engine/scenes/mechanism_pose.h"

#include <math.h>
#include <string.h>

enum { SIDES = 12 }; /* of the polygon that is drawn for a disc */

/* Each body at most twice, as a tip and on the way back; so its centre; a sole, a named point. */
_Static_assert(1 + 4 * STANCE_MAX_BODIES + STANCE_MAX_ELEMENTS * (SIDES + 6) +
                       2 * STANCE_MAX_NAMED + 5 <=
                   STANCE_MAX_POINTS,
               "the figure fits");

struct pen {
    const stance_pose *pose;
    double (*points)[2];
    int count;
};

static void line_to(struct pen *pen, const double point[2])
{
    const double *const last = pen->points[pen->count > 0 ? pen->count - 1 : 0];
    if (pen->count == 0 || last[0] != point[0] || last[1] != point[1])
        memcpy(pen->points[pen->count++], point, sizeof(double[2]));
}

static void line_to_local(struct pen *pen, int body, double x, double z)
{
    double point[2];
    stance_pose_point(pen->pose, body, (const double[]){x, z}, point);
    line_to(pen, point);
}

static bool away(const double local[2])
{
    return local[0] != 0 || local[1] != 0;
}

/* Half a circle about an end of a capsule, on the side of `away`, of length 1. */
static void draw_cap(struct pen *pen, int body, const double at[2], const double away[2], double r)
{
    for (int i = 0; i <= SIDES / 2; i++) {
        double sine, cosine;
        stance_sincos(2 * M_PI / SIDES * i, &sine, &cosine);
        line_to_local(pen, body, at[0] + r * (sine * away[0] + cosine * away[1]),
                      at[1] + r * (sine * away[1] - cosine * away[0]));
    }
}

/* A disc with a spoke, from below round to below, so that its turning is seen; a capsule round,
 * from its first end to there. */
static void draw_element(struct pen *pen, int e)
{
    const stance_element_numbers *const n = &pen->pose->number.element[e];
    const int body = pen->pose->m->element[e].body;
    line_to_local(pen, body, n->at[0], n->at[1]);
    if (pen->pose->m->element[e].sole && n->radius > 0) {
        const double along[2] = {n->to[0] - n->at[0], n->to[1] - n->at[1]};
        const double length = hypot(along[0], along[1]);
        const double away[2] = {along[0] / length, along[1] / length},
                     back[2] = {-away[0], -away[1]};
        const double below[2] = {n->radius * away[1], -n->radius * away[0]};
        line_to_local(pen, body, n->at[0] + below[0], n->at[1] + below[1]);
        draw_cap(pen, body, n->to, away, n->radius);
        draw_cap(pen, body, n->at, back, n->radius);
        line_to_local(pen, body, n->at[0], n->at[1]);
    } else if (pen->pose->m->element[e].sole) {
        line_to_local(pen, body, n->to[0], n->to[1]);
    } else if (n->radius > 0) {
        for (int i = 0; i <= SIDES; i++) {
            double sine, cosine;
            stance_sincos(2 * M_PI / SIDES * (i % SIDES), &sine, &cosine);
            line_to_local(pen, body, n->at[0] + n->radius * sine, n->at[1] - n->radius * cosine);
        }
        line_to_local(pen, body, n->at[0], n->at[1]);
    }
    line_to(pen, pen->pose->origin[body]);
}

/* What slides on a rail has no size; it is drawn with a tenth of what the mechanism reaches. */
static void draw_slide(struct pen *pen)
{
    static const double corner[][2] = {{-1, 0.5}, {-1, -0.5}, {1, -0.5}, {1, 0.5}, {-1, 0.5}};
    const stance_mechanism_numbers *const n = &pen->pose->number;
    const double *const axis = pen->pose->axis[0];
    double size = 0;
    for (int b = 0; b < pen->pose->m->bodies; b++)
        for (int k = 0; k < 2; k++)
            size += 0.1 * (fabs(n->body[b].centre[k]) + (b > 0 ? fabs(n->body[b].at[k]) : 0));
    for (int i = 0; i < 5; i++) {
        const double u = size * corner[i][0], v = size * corner[i][1];
        line_to_local(pen, 0, u * axis[0] - v * axis[1], u * axis[1] + v * axis[0]);
    }
    line_to(pen, pen->pose->origin[0]);
}

/* In the directions of the ground. */
static void draw_outline(struct pen *pen, int body)
{
    const stance_carried *const carried = pen->pose->m->carried;
    const double *const along = pen->pose->tangent, *const up = pen->pose->normal;
    for (int i = 0; i < carried->corners; i++) {
        const double u = carried->outline[i][0], v = carried->outline[i][1];
        line_to_local(pen, body, u * along[0] + v * up[0], u * along[1] + v * up[1]);
    }
}

/* A body that ends nowhere else is drawn to its centre of mass. */
static void draw_body(struct pen *pen, int body)
{
    const stance_mechanism *const m = pen->pose->m;
    const stance_mechanism_numbers *const n = &pen->pose->number;
    bool ends = false;
    if (body == 0 && m->body[body].joint == STANCE_SLIDE && n->body[body].mass == 0) {
        for (int b = 1; b < m->bodies; b++) /* of an axis that carries another one */
            if (m->body[b].parent == body)
                draw_body(pen, b);
        return;
    }
    line_to(pen, pen->pose->origin[body]);
    if (body == 0 && m->body[body].joint == STANCE_SLIDE)
        draw_slide(pen);
    if (m->carried && m->carried->outline && body == m->bodies - 1)
        draw_outline(pen, body);
    for (int e = 0; e < m->elements; e++) {
        if (m->element[e].body == body) {
            draw_element(pen, e);
            ends = true;
        }
    }
    for (int p = 0; p < m->points; p++) {
        if (m->point[p].body == body) {
            line_to_local(pen, body, n->point[p].at[0], n->point[p].at[1]);
            line_to(pen, pen->pose->origin[body]);
            ends = ends || away(n->point[p].at);
        }
    }
    for (int b = body + 1; b < m->bodies; b++) {
        if (m->body[b].parent == body) {
            draw_body(pen, b);
            line_to(pen, pen->pose->origin[body]);
            ends = ends || away(n->body[b].at);
        }
    }
    if (!ends && n->body[body].mass > 0 && away(n->body[body].centre)) {
        line_to_local(pen, body, n->body[body].centre[0], n->body[body].centre[1]);
        line_to(pen, pen->pose->origin[body]);
    }
}

int stance_mechanism_figure(const stance_scene *scene, const double *robot, const double *position,
                            double points[][2])
{
    stance_pose pose;
    struct pen pen = {&pose, points, 0};
    stance_pose_at(scene->mechanism, robot, position, &pose);
    draw_body(&pen, 0);
    return pen.count;
}
