/* plane.c - the mechanism of a tree of links: frames at the joints, numbers in them, the initial
 * state. */
#include "plane_tree.h"
#include "space.h"

#include <stdlib.h>

#define PI 3.14159265358979323846

/* ---- frames and joints -------------------------------------------------------------------------
 */

/* In (-pi, pi], without the rounding of what is 0. */
static double wrapped(double angle)
{
    angle -= 2 * PI * round(angle / (2 * PI));
    return fabs(angle) < 1e-14 ? 0 : angle;
}

/* The file's coordinate of a link's joint by ours: a hinge's sign. */
static double reference_of(const struct plane_tree *t, const struct plane_link *link)
{
    return link->sign * t->model->joint[link->joint].reference;
}

static void take_frame(struct plane_tree *t, int k)
{
    static const struct plane_link world = {.turn = 0};
    const struct plane_link *const link = &t->link[k], *const from = link->parent < 0
                                                                         ? &world
                                                                         : &t->link[link->parent];
    stance_body_numbers *const number = &t->robot->mechanism.value.body[k];
    const double reference = reference_of(t, link);
    double at[2] = {link->at[0] - from->at[0], link->at[1] - from->at[1]};
    number->angle = wrapped(link->turn - from->turn);
    if (link->kind == STANCE_FREE) {
        const bool three = t->robot->map.root_joints == 3;
        number->angle = three ? wrapped(link->turn - reference) : 0;
        return;
    }
    if (link->kind == STANCE_HINGE) {
        number->angle = wrapped(link->turn - from->turn - reference);
    } else {
        plane_turn(-from->turn, link->axis, number->axis);
        at[0] -= link->axis[0] * reference;
        at[1] -= link->axis[1] * reference;
    }
    plane_turn(-from->turn, at, number->at);
}

static void note_joint(struct plane_tree *t, const struct spatial_joint *joint)
{
    if (joint->friction != 0)
        spatial_note(t->model, "dry friction in joint %.60s, %.6g, is left out", joint->name,
                     joint->friction);
    if (joint->soft)
        spatial_note(t->model, "limits of joints are soft in the file and hard stops here");
}

static void take_joint(struct plane_tree *t, int k)
{
    const struct plane_link *const link = &t->link[k];
    const struct spatial_joint *const joint = &t->model->joint[link->joint];
    stance_body_numbers *const number = &t->robot->mechanism.value.body[k];
    note_joint(t, joint);
    number->stiffness = joint->stiffness;
    number->rest = joint->stiffness != 0 ? link->sign * joint->spring_reference : 0;
    number->damping = joint->damping;
    number->armature = joint->armature;
    if (!joint->limited)
        return;
    const bool swap = link->sign < 0;
    number->limits[0] = swap ? -joint->limits[1] : joint->limits[0];
    number->limits[1] = swap ? -joint->limits[0] : joint->limits[1];
}

/* Of a free root what its joint has beside: a free body has no such thing. */
static void note_free(struct plane_tree *t)
{
    const struct spatial_joint *const joint = &t->model->joint[t->link[0].joint];
    if (joint->damping != 0 || joint->armature != 0 || joint->stiffness != 0)
        spatial_note(t->model, "damping, armature or stiffness of the free joint %.60s is left out",
                     joint->name);
}

/* ---- mass --------------------------------------------------------------------------------------
 */

/* About the plane's normal through the centre of mass. */
static double moment_of(struct plane_tree *t, int b)
{
    const struct spatial_body *const body = &t->model->body[b];
    const double *const normal = t->robot->map.normal;
    double inner[3], by[3];
    for (int j = 0; j < 3; j++) { /* R' n */
        double column[3];
        space_column(t->pose[b].rotation, j, column);
        inner[j] = space_dot(column, normal);
    }
    space_turn(body->inertia, inner, by);
    const double moment = space_dot(inner, by);
    for (int i = 0; i < 3; i++)
        by[i] -= moment * inner[i];
    if (space_length(by) > 1e-3 * moment && space_length(by) > 1e-12)
        spatial_note(t->model,
                     "products of inertia of %.60s with the plane's normal are left out: "
                     "they have no effect in the plane",
                     body->name);
    return moment;
}

/* Bodies that are fixed to each other are one. */
static void take_mass(struct plane_tree *t, int k)
{
    stance_body_numbers *const number = &t->robot->mechanism.value.body[k];
    double centre[2];
    for (int b = 0; b < t->model->bodies; b++)
        if (t->link_of[b] == k)
            number->mass += t->model->body[b].mass;
    if (!(number->mass > 0))
        return;
    for (int b = 0; b < t->model->bodies; b++) {
        const double share = t->model->body[b].mass / number->mass;
        if (t->link_of[b] != k || !(share > 0))
            continue;
        plane_in_link(t, b, t->model->body[b].centre, centre);
        number->centre[0] += share * centre[0];
        number->centre[1] += share * centre[1];
    }
    for (int b = 0; b < t->model->bodies; b++) {
        if (t->link_of[b] != k || !(t->model->body[b].mass > 0))
            continue;
        plane_in_link(t, b, t->model->body[b].centre, centre);
        const double x = centre[0] - number->centre[0], z = centre[1] - number->centre[1];
        number->inertia += moment_of(t, b) + t->model->body[b].mass * (x * x + z * z);
    }
}

/* What rounding has left of a zero. */
static void round_zeros(stance_body_numbers *number)
{
    double *const list[] = {&number->at[0],     &number->at[1],   &number->axis[0],
                            &number->axis[1],   &number->angle,   &number->centre[0],
                            &number->centre[1], &number->inertia, &number->rest};
    for (size_t i = 0; i < sizeof list / sizeof *list; i++)
        if (fabs(*list[i]) < 1e-14)
            *list[i] = 0;
}

/* ---- too many ----------------------------------------------------------------------------------
 */

static bool too_many(const struct plane_tree *t)
{
    char list[140] = "";
    int moving = 0;
    for (int k = 0; k < t->links; k++) {
        if (k == 0 && t->link[k].kind != STANCE_HINGE)
            continue;
        add_text(list, sizeof list, "%s%.20s", moving++ ? ", " : "",
                 plane_joint_name(t, t->link[k].joint));
    }
    return plane_refuse(t, 0, "%d joints move; at most 10 besides the root: --weld some of %s",
                        moving, list);
}

static bool check_size(const struct plane_tree *t)
{
    const int moving = t->links - (t->link[0].kind == STANCE_SLIDE);
    return moving <= STANCE_MAX_ANGLES || too_many(t);
}

/* ---- the initial state -------------------------------------------------------------------------
 */

/* Where a free joint's body begins: x, z, angle of the link's frame. */
static void start_free(struct plane_tree *t, double *start)
{
    const struct spatial_joint *const joint = &t->model->joint[t->link[0].joint];
    const int b = t->link[0].body;
    struct plane_pose *const pose = &t->pose[b];
    const struct plane_pose before = *pose;
    double turned = 0, across = 0;
    memcpy(pose->at, joint->start_place, sizeof pose->at);
    memcpy(pose->rotation, joint->start_rotation, sizeof pose->rotation);
    /* Turned out of the plane, the normal would not be where it was. */
    for (int i = 0; i < 3; i++) {
        double column[3], column0[3];
        space_column(pose->rotation, i, column);
        space_column(before.rotation, i, column0);
        across = fmax(across, fabs(space_dot(column, t->robot->map.normal) -
                                   space_dot(column0, t->robot->map.normal)));
    }
    for (int i = 0; i < 3; i++) { /* a direction that is in the plane in both */
        double column[3], column0[3], a[2], b0[2];
        space_column(pose->rotation, i, column);
        space_column(before.rotation, i, column0);
        plane_direction(t, column, a);
        plane_direction(t, column0, b0);
        if (hypot(b0[0], b0[1]) > 0.5) {
            turned = atan2(b0[0] * a[1] - b0[1] * a[0], b0[0] * a[0] + b0[1] * a[1]);
            break;
        }
    }
    if (across > 1e-6)
        spatial_note(t->model,
                     "the initial posture turns %.60s out of the plane: that part of it "
                     "is left out",
                     t->model->body[b].name);
    plane_place(t, pose->at, start);
    start[2] = wrapped(t->link[0].turn + turned);
    *pose = before;
}

/* Two slides and a hinge: the slides add up along their axes, turned where the hinge stands before
 * them. */
static void start_three(struct plane_tree *t, double *start)
{
    const struct plane_map *const map = &t->robot->map;
    double turned = 0;
    memcpy(start, t->link[0].at, sizeof t->link[0].at);
    for (int k = 0; k < 3; k++) {
        const struct spatial_joint *const joint = &t->model->joint[map->root_joint[k]];
        double by[2];
        if (joint->kind == SPATIAL_HINGE) {
            turned = t->link[0].sign * (joint->start - joint->reference);
            start[2] = t->link[0].sign * joint->start;
            continue;
        }
        plane_direction(t, t->line[map->root_joint[k]].axis, by);
        plane_turn(turned, by, by);
        start[0] += by[0] * (joint->start - joint->reference);
        start[1] += by[1] * (joint->start - joint->reference);
    }
}

static double within(struct plane_tree *t, int k, double value)
{
    const double *const limits = t->robot->mechanism.value.body[k].limits;
    const double inside = fmin(fmax(value, limits[0]), limits[1]);
    if (fabs(inside - value) > 1e-12)
        spatial_note(t->model, "%.60s begins at its limit, %.6g, not at %.6g",
                     t->model->body[t->link[k].body].name, inside, value + 0.0);
    return inside;
}

static void take_start(struct plane_tree *t)
{
    double *start = t->robot->start;
    for (int k = 0; k < t->links; k++) {
        const struct plane_link *const link = &t->link[k];
        if (link->kind == STANCE_FREE) {
            if (t->robot->map.root_joints == 3)
                start_three(t, start);
            else
                start_free(t, start);
            start += 3;
            continue;
        }
        *start++ = within(t, k, link->sign * t->model->joint[link->joint].start);
    }
    for (int i = 0; i < t->robot->map.coordinates; i++)
        if (fabs(t->robot->start[i]) < 1e-14)
            t->robot->start[i] = 0;
}

/* Out of the ground, straight up. */
static bool raise_start(struct plane_tree *t)
{
    struct plane_robot *const robot = t->robot;
    stance_scene *scene = NULL;
    double parameters[STANCE_MAX_ROBOT], gap[STANCE_MAX_CONTACTS], lowest = 0;
    if (robot->mechanism.elements == 0)
        return true;
    stance_message why;
    if (stance_mechanism_scene(&robot->mechanism, &scene, &why) != STANCE_OK)
        return plane_refuse(t, 0, "%s", why.text);
    stance_robot_fallback(scene, parameters);
    parameters[STANCE_ROBOT_SLOPE] = robot->slope;
    scene->gaps(scene, parameters, robot->start, gap);
    for (int c = 0; c < scene->contacts; c++)
        if (scene->grip[c] >= 0)
            lowest = fmin(lowest, gap[c]);
    stance_scene_free(scene);
    if (lowest > -1e-12)
        return true;
    if (!robot->map.free_root) {
        spatial_note(t->model, "it begins %.6g m inside the ground", -lowest);
        return true;
    }
    robot->start[1] -= lowest / cos(robot->slope);
    spatial_note(t->model, "it began %.6g m inside the ground: raised by as much", -lowest);
    return true;
}

/* ---- what is what ------------------------------------------------------------------------------
 */

static void take_map(struct plane_tree *t)
{
    struct plane_map *const map = &t->robot->map;
    map->coordinates = 0;
    for (int k = 0; k < t->links; k++) {
        const struct plane_link *const link = &t->link[k];
        for (int i = 0; i < (link->kind == STANCE_FREE ? 3 : 1); i++) {
            map->coordinate[map->coordinates].joint = link->kind == STANCE_FREE ? -1 : link->joint;
            map->coordinate[map->coordinates].sign = link->sign;
            map->coordinate[map->coordinates++].offset = 0;
        }
    }
    if (!map->free_root)
        return;
    const struct plane_link *const root = &t->link[0];
    const struct plane_pose *const pose = &t->pose[root->body];
    double at[3];
    map->root_body = root->body;
    memcpy(map->root_rotation, pose->rotation, sizeof map->root_rotation);
    for (int i = 0; i < 3; i++) {
        const double off = space_dot(pose->at, map->normal) - space_dot(map->origin, map->normal);
        at[i] = map->origin[i] + root->at[0] * map->ahead[i] + root->at[1] * map->up[i] +
                off * map->normal[i] - pose->at[i];
    }
    for (int i = 0; i < 3; i++) {
        double column[3];
        space_column(pose->rotation, i, column);
        map->root_at[i] = space_dot(column, at);
    }
    map->root_angle = map->root_joints == 3 ? reference_of(t, root) : root->turn;
}

/* ---- all of it ---------------------------------------------------------------------------------
 */

/* A joint that follows another one is as good as any where it is held. */
static bool is_held(const struct plane_tree *t, const struct spatial_alien *alien)
{
    for (size_t w = 0; w < t->wishes->welds; w++)
        if (strcmp(alien->what, SPATIAL_MIMIC) == 0 && strcmp(alien->name, t->wishes->weld[w]) == 0)
            return true;
    return false;
}

static bool take_aliens(struct plane_tree *t)
{
    for (int a = 0; a < t->model->aliens; a++) {
        const struct spatial_alien *const alien = &t->model->alien[a];
        const char *const of = alien->name[0] ? " " : "";
        if (is_held(t, alien))
            continue;
        if (!alien->harmless)
            return plane_refuse(t, alien->line,
                                "%s%s%.60s has no counterpart here: take it out of the file%s",
                                alien->what, of, alien->name,
                                strcmp(alien->what, SPATIAL_MIMIC) == 0 ? ", or --weld it" : "");
        spatial_note(t->model, "%s%s%.60s is left out", alien->what, of, alien->name);
    }
    return true;
}

static void take_links(struct plane_tree *t)
{
    stance_mechanism *const m = &t->robot->mechanism;
    stance_mechanism_defaults(&m->value);
    m->bodies = t->links;
    for (int k = 0; k < t->links; k++) {
        m->body[k].joint = t->link[k].kind;
        m->body[k].parent = t->link[k].parent;
        take_frame(t, k);
        if (t->link[k].kind == STANCE_FREE)
            note_free(t);
        else
            take_joint(t, k);
        take_mass(t, k);
        round_zeros(&m->value.body[k]);
    }
}

/* A reader may take nan for a number. */
static bool check_finite(const struct plane_tree *t)
{
    for (int k = 0; k < t->links; k++) {
        const stance_body_numbers *const n = &t->robot->mechanism.value.body[k];
        const struct spatial_body *const body = &t->model->body[t->link[k].body];
        const double sum = n->mass + n->inertia + n->centre[0] + n->centre[1] + n->at[0] +
                           n->at[1] + n->axis[0] + n->axis[1] + n->angle + n->stiffness +
                           n->damping + n->rest + n->armature;
        if (!isfinite(sum) || isnan(n->limits[0]) || isnan(n->limits[1]))
            return plane_refuse(t, body->line,
                                "body '%.60s', its joint or its shape has a number that is none "
                                "(nan), or beyond all bounds",
                                body->name);
    }
    return true;
}

bool plane_make(struct spatial_model *model, const struct plane_wishes *wishes,
                struct plane_robot *robot, stance_message *message)
{
    struct plane_tree t = {.model = model, .wishes = wishes, .robot = robot, .message = message};
    *robot = (struct plane_robot){.step = model->step > 0 ? fmin(model->step, 0.1) : 1e-3};
    bool good = take_aliens(&t) && plane_tree_make(&t) && check_size(&t);
    if (good) {
        take_links(&t);
        take_map(&t);
        plane_name_bodies(&t);
        take_start(&t);
        good = check_finite(&t) && plane_contacts(&t) && plane_drives(&t) && raise_start(&t);
    }
    plane_tree_free(&t);
    return good;
}

void plane_free(struct plane_robot *robot)
{
    free(robot->map.held);
    robot->map.held = NULL;
}
