/* plane.c - the mechanism of a tree of links: frames at the joints, numbers in them, the initial
 * state, motors. */
#include "plane_tree.h"
#include "space.h"

#include <stdlib.h>

/* In [-pi, pi]. */
static double wrapped(double angle)
{
    return plane_tidy(remainder(angle, 2 * acos(-1)));
}

static bool is_three(const struct plane_tree *t)
{
    return t->robot->map.root_joints == 3;
}

static void take_frame(struct plane_tree *t, int k)
{
    static const struct plane_link world = {.turn = 0};
    const struct plane_link *const link = &t->link[k], *const from = link->parent < 0
                                                                         ? &world
                                                                         : &t->link[link->parent];
    stance_body_numbers *const number = &t->robot->mechanism.value.body[k];
    const double reference = link->sign * t->model->joint[link->joint].reference;
    const double complex back = cexp(-I * from->turn);
    const bool free = link->kind == STANCE_FREE, slide = link->kind == STANCE_SLIDE;
    if (!free || is_three(t))
        number->angle = wrapped(link->turn - from->turn - (slide ? 0 : reference));
    if (slide)
        plane_put(link->axis * back, number->axis);
    if (!free)
        plane_put((link->at - from->at - (slide ? link->axis * reference : 0)) * back, number->at);
}

static void take_joint(struct plane_tree *t, int k)
{
    const struct plane_link *const link = &t->link[k];
    const struct spatial_joint *const joint = &t->model->joint[link->joint];
    stance_body_numbers *const number = &t->robot->mechanism.value.body[k];
    const bool swap = link->sign < 0;
    if (link->kind == STANCE_FREE) {
        if (joint->damping != 0 || joint->armature != 0 || joint->stiffness != 0)
            spatial_note(t->model,
                         "damping, armature or stiffness of the free joint %.60s is left out",
                         joint->name);
        return;
    }
    if (joint->friction != 0)
        spatial_note(t->model, "dry friction in joint %.60s, %.6g, is left out", joint->name,
                     joint->friction);
    if (joint->soft)
        spatial_note(t->model, "limits of joints are soft in the file and hard stops here");
    number->stiffness = joint->stiffness;
    number->rest = joint->stiffness != 0 ? plane_tidy(link->sign * joint->spring_reference) : 0;
    number->damping = joint->damping;
    number->armature = joint->armature;
    for (int i = 0; joint->limited && i < 2; i++)
        number->limits[i] = swap ? -joint->limits[1 - i] : joint->limits[i];
}

/* About the plane's normal through the centre of mass. */
static double moment_of(struct plane_tree *t, int b)
{
    const struct spatial_body *const body = &t->model->body[b];
    const double *const normal = t->pose[b].rotation[2];
    double by[3];
    space_turn(body->inertia, normal, by);
    const double moment = space_dot(normal, by);
    for (int i = 0; i < 3; i++)
        by[i] -= moment * normal[i];
    if (space_length(by) > 1e-3 * moment && space_length(by) > 1e-12)
        spatial_note_of(t->model,
                        "products of inertia with the plane's normal are left out, as they have no "
                        "effect in the plane",
                        body->name);
    return moment;
}

/* Bodies that are fixed to each other are one. */
static void take_mass(struct plane_tree *t, int k)
{
    stance_body_numbers *const number = &t->robot->mechanism.value.body[k];
    double complex centre = 0;
    number->mass = t->link[k].mass;
    for (int inertia = 0; inertia < 2; inertia++)
        for (int b = 0; b < t->model->bodies; b++) {
            const double mass = t->model->body[b].mass;
            if (t->link_of[b] != k || !(mass > 0))
                continue;
            const double complex place = plane_in_link(t, b, t->model->body[b].centre);
            if (!inertia)
                centre += mass / number->mass * place;
            else
                number->inertia += moment_of(t, b) + mass * pow(cabs(place - centre), 2);
        }
    number->inertia = plane_tidy(number->inertia);
    plane_put(centre, number->centre);
}

/* ---- the initial state ---------------------------------------------------------------------- */

/* A joint begins within its limits. */
static double begin(struct plane_tree *t, int k)
{
    const double *const limits = t->robot->mechanism.value.body[k].limits;
    struct spatial_joint *const joint = &t->model->joint[t->link[k].joint];
    const double value = t->link[k].sign * joint->start,
                 inside = fmin(fmax(value, limits[0]), limits[1]);
    if (fabs(inside - value) > 1e-12)
        spatial_note(t->model, "%.60s begins at its limit, %.6g, not at %.6g",
                     t->model->body[t->link[k].body].name, inside, value + 0.0);
    joint->start = t->link[k].sign * inside;
    return plane_tidy(inside);
}

/* x, z, and the angle: of the hinge, or how the body is turned. */
static void begin_free(struct plane_tree *t, double *start)
{
    const struct plane_link *const root = &t->link[0];
    const double(*const R)[3] = t->start[root->body].rotation;
    double across = 0;
    for (int i = 0; i < 3; i++)
        across = fmax(across, fabs(R[2][i] - t->pose[root->body].rotation[2][i]));
    if (across > 1e-6)
        spatial_note(t->model,
                     "the initial posture turns %.60s out of the plane: that part of it "
                     "is left out",
                     t->model->body[root->body].name);
    plane_put(plane_place(t, t->start, root->body, t->robot->map.root_at), start);
    start[2] = plane_tidy(is_three(t) ? root->sign * t->model->joint[root->joint].start
                                      : wrapped(space_turned(R)));
}

static void take_start(struct plane_tree *t)
{
    const bool free = t->robot->map.free_root;
    double *const start = t->robot->start;
    for (int k = free; k < t->links; k++)
        start[k + 2 * free] = begin(t, k);
    plane_pose_all(t, t->start);
    if (free)
        begin_free(t, start);
}

/* ---- what is what --------------------------------------------------------------------------- */

static void take_map(struct plane_tree *t)
{
    struct plane_map *const map = &t->robot->map;
    const struct plane_link *const root = &t->link[0];
    const struct plane_pose *const pose = &t->pose[root->body];
    map->coordinates = t->links + 2 * map->free_root;
    for (int i = 0; i < map->coordinates; i++) {
        const struct plane_link *const link = &t->link[map->free_root ? (i < 3 ? 0 : i - 2) : i];
        map->coordinate[i].joint = link->kind == STANCE_FREE ? -1 : link->joint;
        map->coordinate[i].sign = link->sign;
    }
    map->root_body = root->body;
    map->root_angle = -t->robot->mechanism.value.body[0].angle;
    for (int i = 0; i < 3; i++)
        map->root_at[i] = pose->rotation[0][i] * (creal(root->at) - pose->at[0]) +
                          pose->rotation[1][i] * (cimag(root->at) - pose->at[1]);
}

/* ---- motors and servos ----------------------------------------------------------------------- */

static const char *name_of(const struct spatial_actuator *actuator)
{
    return actuator->name[0] ? actuator->name : actuator->target;
}

/* Refuses what drives no link's joint, and tells what is left out. */
static bool check(struct plane_tree *t, const struct spatial_actuator *actuator)
{
    const int j = actuator->joint;
    const char *why = NULL;
    if (j < 0)
        why = "drives no joint that moves: take it out of the file";
    else if (actuator->drive == SPATIAL_GENERAL)
        why = "is neither a motor nor a position or velocity servo: write it as one of these";
    else if (t->held[j])
        spatial_note(t->model, "actuator %.60s is left out: its joint is welded, or moves no mass",
                     name_of(actuator));
    else if (t->model->joint[j].kind == SPATIAL_FREE)
        why = "drives a free joint: take it out of the file";
    return !why || plane_refuse(t, actuator->line, "actuator '%.40s' %s", name_of(actuator), why);
}

/* What either way has; of a range to one side the whole. */
static double limit_of(struct plane_tree *t, const struct spatial_actuator *actuator)
{
    const double down = -actuator->least, up = actuator->most;
    const double limit = fmin(down, up) > 0 ? fmin(down, up) : fmax(fabs(down), fabs(up));
    if (!actuator->limited)
        return INFINITY;
    if (fabs(down - up) > 1e-12 * (fabs(down) + fabs(up)) && isfinite(limit))
        spatial_note(t->model, "actuator %.60s gives %.6g to %.6g in the file, -%.6g to %.6g here",
                     name_of(actuator), 0 - down, up + 0.0, limit, limit);
    return limit;
}

/* Of joints from a link on, or of those that are driven. */
static bool too_many(const struct plane_tree *t, int from, bool driven, const char *what)
{
    struct spatial_note list = {.length = 0};
    int count = 0;
    for (int k = from; k < t->links; k++) {
        bool counts = !driven;
        for (int a = 0; a < t->model->actuators; a++)
            counts = counts || t->model->actuator[a].joint == t->link[k].joint;
        if (counts)
            spatial_list(&list, plane_joint_name(t, t->link[k].joint));
        count += counts;
    }
    return plane_refuse(t, 0, "%d joints %s: --weld some of %s", count, what, list.text);
}

/* The actuator of a link's joint, if it has one: a motor, or a servo of places, of rates, or one of
 * each. `gain` is of that joint. */
static bool take(struct plane_tree *t, int k, double gain[2])
{
    stance_mechanism *const m = &t->robot->mechanism;
    const struct spatial_actuator *first = NULL, *second = NULL;
    const int n = m->actuators;
    for (int a = 0; a < t->model->actuators; a++) {
        const struct spatial_actuator *const actuator = &t->model->actuator[a];
        if (actuator->joint != t->link[k].joint)
            continue;
        if (first && (second || first->drive == SPATIAL_MOTOR || actuator->drive == SPATIAL_MOTOR ||
                      first->drive == actuator->drive))
            return plane_refuse(t, actuator->line,
                                "actuators '%.50s' and '%.50s' drive one joint: leave one of them",
                                name_of(first), name_of(actuator));
        *(first ? &second : &first) = actuator;
    }
    if (!first)
        return true;
    if (n == STANCE_MAX_ACTUATORS)
        return too_many(t, 0, true, "are driven; at most 8");
    m->actuator[n].body = k;
    m->value.limit[n] = limit_of(t, first) + (second ? limit_of(t, second) : 0);
    gain[0] = first->kp + (second ? second->kp : 0);
    gain[1] = first->kd + (second ? second->kd : 0);
    plane_name_actuator(t, n, t->model->joint[t->link[k].joint].name, first->name);
    t->robot->map.actuator[n].actuator = (int)(first - t->model->actuator);
    t->robot->map.actuator[n].sign = t->link[k].sign;
    t->robot->map.actuators = ++m->actuators;
    return true;
}

static bool same(double a, double b)
{
    return fabs(a - b) <= 1e-9 * (fabs(a) + fabs(b));
}

/* The law `hold` has one stiffness and one damping for all. */
static void take_servos(struct plane_tree *t, const double (*gain)[2])
{
    struct plane_robot *const robot = t->robot;
    int servos = 0;
    robot->hold = robot->mechanism.actuators > 0;
    for (int a = 0; a < robot->mechanism.actuators; a++) {
        const bool servo =
            t->model->actuator[robot->map.actuator[a].actuator].drive != SPATIAL_MOTOR;
        servos += servo;
        robot->hold =
            robot->hold && servo && same(gain[a][0], gain[0][0]) && same(gain[a][1], gain[0][1]);
    }
    robot->kp = gain[0][0];
    robot->kd = gain[0][1];
    if (robot->hold)
        spatial_note(t->model, "the servos hold the initial posture (controller.target)");
    for (int a = 0; servos > 0 && !robot->hold && a < robot->mechanism.actuators; a++)
        if (gain[a][0] != 0 || gain[a][1] != 0)
            spatial_note(t->model,
                         "servo %s, kp %.6g, kd %.6g, is a motor here: `hold` has one gain for all",
                         robot->mechanism.actuator[a].name, gain[a][0] + 0.0, gain[a][1] + 0.0);
}

static bool take_drives(struct plane_tree *t)
{
    double gain[STANCE_MAX_ACTUATORS + 1][2] = {{0}};
    for (int a = 0; a < t->model->actuators; a++)
        if (!check(t, &t->model->actuator[a]))
            return false;
    for (int k = t->robot->map.free_root; k < t->links; k++)
        if (!take(t, k, gain[t->robot->mechanism.actuators]))
            return false;
    take_servos(t, gain);
    return true;
}

/* ---- all of it ------------------------------------------------------------------------------ */

/* A joint that follows another one is as good as any where it is held. */
static bool take_aliens(struct plane_tree *t)
{
    char text[2 * SPATIAL_NAME];
    for (int a = 0; a < t->model->aliens; a++) {
        const struct spatial_alien *const alien = &t->model->alien[a];
        const bool mimic = strcmp(alien->what, SPATIAL_MIMIC) == 0;
        bool held = false;
        for (size_t w = 0; mimic && w < t->wishes->welds; w++)
            held = held || strcmp(alien->name, t->wishes->weld[w]) == 0;
        snprintf(text, sizeof text, "%s%s%s", alien->what, alien->name[0] ? " " : "", alien->name);
        if (!held && !alien->harmless)
            return plane_refuse(t, alien->line,
                                "%s has no counterpart here: take it out of the file%s", text,
                                mimic ? ", or --weld it" : "");
        if (!held)
            spatial_note_of(t->model, "left out", text);
    }
    return true;
}

static bool check_size(const struct plane_tree *t)
{
    return t->links - (t->link[0].kind == STANCE_SLIDE) <= STANCE_MAX_ANGLES ||
           too_many(t, t->link[0].kind != STANCE_HINGE, false, "move; at most 10 besides the root");
}

/* A reader may take nan for a number. */
static bool check_finite(const struct plane_tree *t, int k)
{
    const stance_body_numbers *const n = &t->robot->mechanism.value.body[k];
    const struct spatial_body *const body = &t->model->body[t->link[k].body];
    const double sum = n->mass + n->inertia + n->centre[0] + n->centre[1] + n->at[0] + n->at[1] +
                       n->axis[0] + n->axis[1] + n->angle + n->stiffness + n->damping + n->rest +
                       n->armature;
    return (isfinite(sum) && !isnan(n->limits[0]) && !isnan(n->limits[1])) ||
           plane_refuse(t, body->line,
                        "body '%.60s', its joint or its shape has a number that is none "
                        "(nan), or beyond all bounds",
                        body->name);
}

static bool take_links(struct plane_tree *t)
{
    stance_mechanism *const m = &t->robot->mechanism;
    stance_mechanism_defaults(&m->value);
    m->bodies = t->links;
    for (int k = 0; k < t->links; k++) {
        m->body[k].joint = t->link[k].kind;
        m->body[k].parent = t->link[k].parent;
        take_frame(t, k);
        take_joint(t, k);
        take_mass(t, k);
        if (!check_finite(t, k))
            return false;
    }
    return true;
}

bool plane_make(struct spatial_model *model, const struct plane_wishes *wishes,
                struct plane_robot *robot, spatial_message *message)
{
    struct plane_tree t = {.model = model, .wishes = wishes, .robot = robot, .message = message};
    *robot = (struct plane_robot){.step = model->step > 0 ? fmin(model->step, 0.1) : 1e-3};
    bool good = take_aliens(&t) && plane_tree_make(&t) && check_size(&t) && take_links(&t);
    if (good) {
        take_map(&t);
        plane_name_bodies(&t);
        take_start(&t);
        good = plane_contacts(&t) && take_drives(&t);
    }
    plane_tree_free(&t);
    return good;
}

void plane_free(struct plane_robot *robot)
{
    free(robot->map.held);
    robot->map.held = NULL;
}
