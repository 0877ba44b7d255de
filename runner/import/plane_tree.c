/* plane_tree.c - from bodies in space to links of the plane. */
#include "plane_tree.h"
#include "space.h"

#include "runner/base/words.h"

#include <stdlib.h>

#define PARALLEL 1e-6 /* sine of the angle by which directions may differ */

double complex plane_place(const struct plane_tree *t, const struct plane_pose *pose, int body,
                           const double at[3])
{
    const struct plane_pose *const of = body < 0 ? &t->base : &pose[body];
    double place[3];
    space_place(of->at, of->rotation, at, place);
    return place[0] + I * place[1];
}

double complex plane_in_link(const struct plane_tree *t, int body, const double at[3])
{
    const struct plane_link *const link = &t->link[t->link_of[body]];
    return (plane_place(t, t->pose, body, at) - link->at) * cexp(-I * link->turn);
}

const char *plane_joint_name(const struct plane_tree *t, int j)
{
    const struct spatial_joint *const joint = &t->model->joint[j];
    return joint->name[0] ? joint->name : t->model->body[joint->body].name;
}

static bool weld(struct plane_tree *t, const char *name)
{
    const int joints = t->model->joints;
    const char **const names = spatial_room((size_t)joints, sizeof *names);
    int found = -1;
    for (int j = 0; j < joints; j++)
        if (strcmp(names[j] = plane_joint_name(t, j), name) == 0)
            found = j;
    const char *const near = nearest_word(name, names, (size_t)joints);
    free(names);
    if (found < 0)
        return plane_refuse(t, 0, "--weld %.60s: there is no joint of this name%s%.60s%s", name,
                            near ? "; did you mean '" : "", near ? near : "", near ? "'?" : "");
    struct spatial_joint *const joint = &t->model->joint[found];
    if (joint->limited)
        joint->start = fmin(fmax(joint->start, joint->limits[0]), joint->limits[1]);
    t->held[found] = true;
    spatial_note(t->model, "joint %.60s is welded where it begins, at %.6g", name,
                 joint->start + 0.0);
    return true;
}

/* ---- poses ---------------------------------------------------------------------------------- */

/* A joint takes its body to where it begins. */
static void begin(const struct plane_tree *t, int j, struct plane_pose *pose)
{
    const struct spatial_joint *const joint = &t->model->joint[j];
    const double by = joint->start - joint->reference;
    double axis[3], line[3], turn[3][3], at[3];
    space_turn(pose->rotation, joint->axis, axis);
    space_place(pose->at, pose->rotation, joint->at, line);
    if (joint->kind == SPATIAL_SLIDE) {
        for (int i = 0; i < 3; i++)
            pose->at[i] += by * axis[i];
    } else if (joint->kind == SPATIAL_HINGE) {
        space_rotation(axis, by, turn);
        space_product(turn, pose->rotation, pose->rotation);
        space_turn(pose->rotation, joint->at, at);
        for (int i = 0; i < 3; i++)
            pose->at[i] = line[i] - at[i];
    } else if (joint->kind == SPATIAL_FREE) {
        space_place(t->base.at, t->base.rotation, joint->start_place, pose->at);
        space_product(t->base.rotation, joint->start_rotation, pose->rotation);
    }
}

/* Joints stand in the order of their bodies, and act one after the other. */
void plane_pose_all(struct plane_tree *t, struct plane_pose *pose)
{
    const struct spatial_model *const model = t->model;
    for (int b = 0, j = 0; b < model->bodies; b++) {
        const struct spatial_body *const body = &model->body[b];
        const struct plane_pose *const from = body->parent < 0 ? &t->base : &pose[body->parent];
        space_place(from->at, from->rotation, body->at, pose[b].at);
        space_product(from->rotation, body->rotation, pose[b].rotation);
        for (; j < model->joints && model->joint[j].body == b; j++) {
            if (pose == t->pose) {
                space_turn(pose[b].rotation, model->joint[j].axis, t->axis[j]);
                space_place(pose[b].at, pose[b].rotation, model->joint[j].at, t->line[j]);
            }
            if (pose == t->start || t->held[j])
                begin(t, j, &pose[b]);
        }
    }
}

/* ---- the plane ------------------------------------------------------------------------------ */

static bool parallel(const double a[3], const double b[3])
{
    double across[3];
    space_cross(a, b, across);
    return space_length(across) < PARALLEL;
}

static const char *axis_text(const double v[3], char text[64])
{
    snprintf(text, 64, "(%.4g %.4g %.4g)", v[0] + 0.0, v[1] + 0.0, v[2] + 0.0);
    return text;
}

static bool is_moving(const struct plane_tree *t, int j, spatial_joint_kind kind)
{
    return t->model->joint[j].kind == kind && !t->held[j];
}

/* How good a normal is: for hinges along it, else gravity across it, else slides. */
static double votes(const struct plane_tree *t, const double axis[3])
{
    const double *const gravity = t->model->gravity;
    const bool falls = fabs(space_dot(axis, gravity)) < PARALLEL * (1 + space_length(gravity));
    bool slides = true;
    double hinges = 0;
    for (int j = 0; j < t->model->joints; j++) {
        hinges += is_moving(t, j, SPATIAL_HINGE) && parallel(axis, t->axis[j]);
        slides = slides &&
                 (!is_moving(t, j, SPATIAL_SLIDE) || fabs(space_dot(t->axis[j], axis)) < PARALLEL);
    }
    return hinges + (falls ? 0.5 : 0) + (slides ? 0.25 : 0);
}

/* The first of the best directions: that of a hinge, or without any y, x, z. */
static void choose_normal(const struct plane_tree *t, double normal[3])
{
    static const struct {
        const char *name;
        double normal[3];
    } planes[] = {{"xz", {0, 1, 0}}, {"yz", {1, 0, 0}}, {"xy", {0, 0, 1}}};
    const int joints = t->model->joints;
    const char *const wish = t->wishes->plane;
    double best = -1;
    for (int j = 0; j < joints + 3; j++) {
        const double *const axis = j < joints ? t->axis[j] : planes[j - joints].normal;
        const bool may = j < joints ? !wish && is_moving(t, j, SPATIAL_HINGE)
                                    : !wish || strcmp(wish, planes[j - joints].name) == 0;
        if (may && votes(t, axis) > best) {
            best = votes(t, axis);
            memcpy(normal, axis, 3 * sizeof *axis);
        }
    }
    for (int k = 0; k < 3;
         k++) /* exactly an axis of the file's, where it is one but for rounding */
        if (parallel(normal, planes[k].normal))
            memcpy(normal, planes[k].normal, sizeof planes[k].normal);
}

static bool in_plane(const struct plane_tree *t, int j, const double normal[3])
{
    const spatial_joint_kind kind = t->model->joint[j].kind;
    const bool has_axis = space_length(t->axis[j]) > 0.5;
    return t->held[j] || kind == SPATIAL_FREE ||
           (has_axis && kind == SPATIAL_HINGE && parallel(t->axis[j], normal)) ||
           (has_axis && kind == SPATIAL_SLIDE && fabs(space_dot(t->axis[j], normal)) < PARALLEL);
}

/* The first joint that is not of the plane, and those that are not, either: " (so with a, b)". */
static bool refuse_joint(const struct plane_tree *t, int j, const double normal[3])
{
    const struct spatial_joint *const joint = &t->model->joint[j];
    const bool hinge = joint->kind == SPATIAL_HINGE;
    const char *const name = plane_joint_name(t, j);
    struct spatial_note others = {.text = " (so with ", .length = sizeof " (so with " - 1};
    const size_t none = others.length;
    char axis[64], of[64];
    for (int k = j + 1; k < t->model->joints; k++)
        if (!in_plane(t, k, normal))
            spatial_list(&others, plane_joint_name(t, k));
    add_text(others.text, sizeof others.text, ")");
    const char *const so = others.length > none ? others.text : "";
    if (joint->kind == SPATIAL_BALL)
        return plane_refuse(
            t, joint->line,
            "joint '%s' is a ball, which turns out of the plane: --weld %s holds it%s", name, name,
            so);
    return plane_refuse(t, joint->line,
                        "joint '%s' %s %s, not %s the normal %s: --weld %s holds it%s, --plane "
                        "chooses another plane",
                        name, hinge ? "turns about" : "slides along", axis_text(t->axis[j], axis),
                        hinge ? "along" : "across", axis_text(normal, of), name, so);
}

/* Gravity that is off an axis of the file by rounding, or to make a posture fall, is along it. */
static void straighten(struct plane_tree *t)
{
    double *const gravity = t->model->gravity;
    const double size = space_length(gravity);
    for (int k = 0; k < 3; k++) {
        const double off = hypot(gravity[(k + 1) % 3], gravity[(k + 2) % 3]) / size;
        if (!(off > 0 && off < 1e-5))
            continue;
        spatial_note(t->model, "gravity is off the file's %c by %.2g rad: taken as along it",
                     "xyz"[k], off);
        for (int i = 0; i < 3; i++)
            gravity[i] = i == k ? copysign(size, gravity[k]) : 0;
    }
}

/* Up is against gravity; without any, along the file's z, else its y. */
static bool choose_axes(struct plane_tree *t, const double normal[3])
{
    struct plane_map *const map = &t->robot->map;
    const double *const gravity = t->model->gravity;
    const double across = space_dot(gravity, normal), size = space_length(gravity);
    const bool lies = fabs(across) > PARALLEL * size;
    const int vertical = fabs(normal[2]) < 0.9 ? 2 : 1;
    int largest = 0;
    char text[2][64];
    if (lies && !t->wishes->plane)
        return plane_refuse(t, 0,
                            "gravity %s is not in the plane of the joints, whose normal is %s: "
                            "--plane xz, yz or xy takes one, and of gravity what is in it",
                            axis_text(gravity, text[0]), axis_text(normal, text[1]));
    if (lies)
        spatial_note(t->model, "gravity across the plane, %.6g m/s^2, is left out", fabs(across));
    for (int i = 0; i < 3; i++)
        map->up[i] = across * normal[i] - gravity[i];
    t->robot->gravity = space_length(map->up);
    if (t->robot->gravity <= PARALLEL * size) {
        t->robot->gravity = 0;
        for (int i = 0; i < 3; i++)
            map->up[i] = (i == vertical) - normal[vertical] * normal[i];
    }
    space_unit(map->up, map->up);
    space_cross(map->up, normal, map->ahead);
    /* Ahead is where the largest part of it is positive. */
    for (int i = 1; i < 3; i++)
        largest = fabs(map->ahead[i]) > fabs(map->ahead[largest]) + 1e-9 ? i : largest;
    const double sign = map->ahead[largest] < 0 ? -1 : 1;
    for (int i = 0; i < 3; i++)
        map->ahead[i] = 0.0 + sign * map->ahead[i]; /* no negative zeros */
    space_cross(map->ahead, map->up, map->normal);
    if (map->ahead[0] != 1 || map->up[2] != 1)
        spatial_note(t->model, "x is the file's %s, z its %s", axis_text(map->ahead, text[0]),
                     axis_text(map->up, text[1]));
    return true;
}

/* From here on poses are in the plane's axes. */
static bool choose_plane(struct plane_tree *t)
{
    const struct plane_map *const map = &t->robot->map;
    double normal[3] = {0};
    straighten(t);
    choose_normal(t, normal);
    for (int j = 0; j < t->model->joints; j++)
        if (!in_plane(t, j, normal))
            return refuse_joint(t, j, normal);
    if (!choose_axes(t, normal))
        return false;
    for (int i = 0; i < 3; i++) {
        t->base.rotation[0][i] = map->ahead[i];
        t->base.rotation[1][i] = map->up[i];
        t->base.rotation[2][i] = map->normal[i];
    }
    plane_pose_all(t, t->pose);
    return true;
}

/* ---- links ---------------------------------------------------------------------------------- */

static void add_link(struct plane_tree *t, int j, bool last)
{
    const spatial_joint_kind kind = t->model->joint[j].kind;
    const int body = t->model->joint[j].body, parent = t->link_of[body];
    const double *const at = kind == SPATIAL_HINGE ? t->line[j] : t->pose[body].at;
    t->link[t->links] = (struct plane_link){
        .parent = parent,
        .joint = j,
        .body = body,
        .between = !last,
        .kind = kind == SPATIAL_FREE    ? STANCE_FREE
                : kind == SPATIAL_SLIDE ? STANCE_SLIDE
                                        : STANCE_HINGE,
        .at = at[0] + I * at[1],
        .axis = t->axis[j][0] + I * t->axis[j][1],
        .sign = kind == SPATIAL_HINGE && !(t->axis[j][2] > 0) ? -1 : 1,
        .turn = last         ? space_turned(t->pose[body].rotation)
                : parent < 0 ? 0
                             : t->link[parent].turn,
    };
    if (parent >= 0)
        t->link[parent].children++;
    t->link_of[body] = t->links++;
}

/* What has no mass at the end of a chain moves nothing: it stays at its reference. */
static void hold_massless_ends(struct plane_tree *t)
{
    struct spatial_model *const model = t->model;
    bool *const heavy =
        spatial_room((size_t)model->bodies, sizeof *heavy); /* all that hangs on it */
    int moving = 0;
    for (int b = model->bodies - 1; b >= 0; b--) {
        heavy[b] = heavy[b] || model->body[b].mass > 0;
        if (heavy[b] && model->body[b].parent >= 0)
            heavy[model->body[b].parent] = true;
    }
    for (int j = 0; j < model->joints; j++) {
        struct spatial_joint *const joint = &model->joint[j];
        if (t->held[j] || heavy[joint->body] || moving == 0) {
            moving += !t->held[j];
            continue;
        }
        spatial_note(model,
                     "link %.50s has no mass, and nothing hangs on it: its joint is left out",
                     model->body[joint->body].name);
        t->held[j] = true;
        joint->start = joint->reference;
    }
    free(heavy);
}

static void add_links(struct plane_tree *t)
{
    const struct spatial_model *const model = t->model;
    for (int b = 0, j = 0; b < model->bodies; b++) {
        int last = -1;
        t->link_of[b] = model->body[b].parent < 0 ? -1 : t->link_of[model->body[b].parent];
        for (int k = j; k < model->joints && model->joint[k].body == b; k++)
            last = t->held[k] ? last : k;
        for (; j < model->joints && model->joint[j].body == b; j++)
            if (!t->held[j])
                add_link(t, j, j == last);
        if (t->link_of[b] >= 0)
            t->link[t->link_of[b]].mass += model->body[b].mass;
    }
    for (int g = 0; g < model->geoms; g++)
        if (model->geom[g].body >= 0 && t->link_of[model->geom[g].body] >= 0)
            t->link[t->link_of[model->geom[g].body]].touches |= model->geom[g].meets_floor;
}

/* ---- the root ------------------------------------------------------------------------------- */

/* Does a joint nothing but lead? */
static bool is_bare(const struct spatial_model *model, int j)
{
    const struct spatial_joint *const joint = &model->joint[j];
    bool bare =
        joint->damping == 0 && joint->stiffness == 0 && joint->armature == 0 && !joint->limited;
    for (int a = 0; a < model->actuators; a++)
        bare = bare && model->actuator[a].joint != j;
    return bare;
}

/* Two slides and a hinge of links without mass but for the last: they are one, and free. */
static void merge_root(struct plane_tree *t)
{
    struct plane_link *const link = t->link;
    struct plane_link root = link[2];
    struct plane_map *const map = &t->robot->map;
    int slides = 0, hinge = 0, way[3] = {0};
    bool bare = true;
    for (int k = 0; k < 3 && k < t->links; k++) {
        if (link[k].parent != k - 1 ||
            (k < 2 && (link[k].children != 1 || link[k].mass > 0 || link[k].touches)))
            return;
        bare = bare && is_bare(t->model, link[k].joint);
        if (link[k].kind == STANCE_SLIDE)
            way[slides++] = k;
        else
            hinge = k;
    }
    if (t->links < 3 || slides != 2 || link[hinge].kind != STANCE_HINGE ||
        fabs(cimag(conj(link[way[0]].axis) * link[way[1]].axis)) < PARALLEL)
        return;
    if (!bare) {
        spatial_note(t->model, "the root's slides and hinge have springs, dampers, limits or "
                               "motors: they stay joints of their own");
        return;
    }
    root.kind = STANCE_FREE;
    root.parent = -1;
    root.joint = link[hinge].joint;
    root.sign = link[hinge].sign;
    root.at = link[hinge].at;
    for (int k = 0; k < 3; k++)
        map->root_joint[map->root_joints++] = link[k].joint;
    for (int b = 0; b < t->model->bodies; b++)
        t->link_of[b] = t->link_of[b] < 0 ? -1 : t->link_of[b] < 2 ? 0 : t->link_of[b] - 2;
    t->links -= 2;
    memmove(link, link + 2, (size_t)t->links * sizeof *link);
    link[0] = root;
    for (int k = 1; k < t->links; k++)
        link[k].parent -= 2;
}

/* Of the first tree's root, and of the body that begins another one: joints of all others. */
static bool refuse_trees(const struct plane_tree *t, int first, const struct spatial_body *body)
{
    struct spatial_note joints = {.length = 0};
    for (int k = 0; k < t->links; k++) {
        int root = k;
        while (t->link[root].parent >= 0)
            root = t->link[root].parent;
        if (root != first)
            spatial_list(&joints, plane_joint_name(t, t->link[k].joint));
    }
    return plane_refuse(t, body->line,
                        "bodies '%s' and '%s' both begin a tree: a robot is one tree. Take the "
                        "other out of the file, or hold its joints with --weld: %s",
                        t->model->body[t->link[first].body].name, body->name, joints.text);
}

static bool check_roots(const struct plane_tree *t)
{
    int first = -1;
    for (int k = 0; k < t->links; k++) {
        const struct plane_link *const link = &t->link[k];
        const struct spatial_body *const body = &t->model->body[link->body];
        if (link->parent >= 0 && link->kind == STANCE_FREE)
            return plane_refuse(t, body->line,
                                "body '%.60s' is free, but hangs from another: only a root is free",
                                body->name);
        if (link->parent < 0 && first >= 0)
            return refuse_trees(t, first, body);
        first = link->parent < 0 ? k : first;
    }
    return first >= 0 || plane_refuse(t, 0, "nothing moves: all bodies are fixed to the world");
}

/* ---- the floor ------------------------------------------------------------------------------ */

static bool is_fixed(const struct plane_tree *t, int body)
{
    for (; body >= 0; body = t->model->body[body].parent)
        for (int j = 0; j < t->model->joints; j++)
            if (t->model->joint[j].body == body && !t->held[j])
                return false;
    return true;
}

/* Axes of a geom, in the plane's. */
static void axes_of(const struct plane_tree *t, const struct spatial_geom *geom, double R[3][3])
{
    space_product(geom->body < 0 ? t->base.rotation : t->pose[geom->body].rotation, geom->rotation,
                  R);
}

/* Is a box as ground is: wider in the plane than it is high, and wider than a step? */
static bool is_wide(const struct plane_tree *t, const struct spatial_geom *box)
{
    double R[3][3], extent[2] = {0};
    axes_of(t, box, R);
    for (int k = 0; k < 3; k++)
        for (int i = 0; i < 2; i++)
            extent[i] += 2 * box->size[k] * fabs(R[i][k]);
    return extent[0] >= 1 && extent[0] > extent[1];
}

/* A plane of the world, else a box that may be ground. */
static int find_floor(const struct plane_tree *t)
{
    static const spatial_shape shapes[] = {SPATIAL_PLANE, SPATIAL_BOX};
    for (int k = 0; k < 2; k++)
        for (int g = 0; g < t->model->geoms; g++) {
            const struct spatial_geom *const geom = &t->model->geom[g];
            if (geom->meets_floor && geom->shape == shapes[k] && is_fixed(t, geom->body) &&
                (k == 0 || is_wide(t, geom)))
                return g;
        }
    return -1;
}

/* The upper face of the floor: a place on it, and its normal. */
static double complex floor_face(const struct plane_tree *t, const struct spatial_geom *geom,
                                 double normal[3])
{
    double R[3][3], at[3];
    int face = 2;
    memcpy(at, geom->at, sizeof at);
    axes_of(t, geom, R);
    for (int k = 0; geom->shape == SPATIAL_BOX && k < 2; k++)
        face = fabs(R[1][k]) > fabs(R[1][face]) ? k : face;
    const double side = geom->shape != SPATIAL_BOX ? 0 : R[1][face] < 0 ? -1 : 1;
    for (int i = 0; i < 3; i++) {
        at[i] += side * geom->size[face] * geom->rotation[i][face];
        normal[i] = side < 0 ? -R[i][face] : R[i][face];
    }
    return plane_place(t, t->pose, geom->body, at);
}

/* What stands still beside the floor. */
static void note_others(struct plane_tree *t, int floor)
{
    char text[PLANE_TEXT];
    for (int g = 0; g < t->model->geoms; g++) {
        const struct spatial_geom *const geom = &t->model->geom[g];
        if (g != floor && geom->meets_floor && is_fixed(t, geom->body))
            spatial_note_of(t->model, "left out, as the ground is one half plane",
                            plane_geom_text(t, geom, text));
    }
}

/* The ground goes through the origin of the scene's world: the file's, along `up`. */
static bool take_floor(struct plane_tree *t)
{
    struct plane_map *const map = &t->robot->map;
    const int floor = find_floor(t);
    double normal[3];
    t->floor_friction = NAN;
    note_others(t, floor);
    if (floor < 0)
        return true;
    const struct spatial_geom *const geom = &t->model->geom[floor];
    const double complex at = floor_face(t, geom, normal);
    if (fabs(normal[2]) > 1 - PARALLEL) { /* as one who lies on it sees it */
        spatial_note(t->model, "the floor is left out: the robot moves along it");
        t->along_floor = true;
        return true;
    }
    if (fabs(normal[2]) > PARALLEL)
        return plane_refuse(t, geom->line, "floor '%.60s' is tilted across the plane", geom->name);
    if (normal[1] < 0.02)
        return plane_refuse(
            t, geom->line,
            "floor '%.60s' stands upright, or is overhead: gravity does not press the robot on it",
            geom->name);
    const double height = cimag(at) + creal(at) * normal[0] / normal[1];
    for (int i = 0; i < 3; i++)
        map->origin[i] = height * map->up[i];
    t->base.at[1] = -height;
    plane_pose_all(t, t->pose);
    t->robot->slope = plane_tidy(atan2(normal[0], normal[1]));
    if (t->robot->slope != 0)
        spatial_note(t->model, "the floor slopes by %.6g rad against gravity", t->robot->slope);
    if (fabs(height) > 1e-14)
        spatial_note(t->model, "z is 0 on the floor, %.6g m in the file", height);
    if (geom->shape == SPATIAL_BOX)
        spatial_note(t->model, "box %.60s is the ground, without ends", geom->name);
    t->has_floor = true;
    t->floor_friction = geom->friction;
    return true;
}

bool plane_tree_make(struct plane_tree *t)
{
    const size_t bodies = (size_t)t->model->bodies, joints = (size_t)t->model->joints;
    t->pose = spatial_room(bodies, sizeof *t->pose);
    t->start = spatial_room(bodies, sizeof *t->start);
    t->axis = spatial_room(joints, sizeof *t->axis);
    t->line = spatial_room(joints, sizeof *t->line);
    t->link_of = spatial_room(bodies, sizeof *t->link_of);
    t->link = spatial_room(joints + 2, sizeof *t->link);
    t->robot->map.held = t->held = spatial_room(joints, sizeof *t->held);
    for (size_t w = 0; w < t->wishes->welds; w++)
        if (!weld(t, t->wishes->weld[w]))
            return false;
    for (int i = 0; i < 3; i++)
        t->base.rotation[i][i] = 1;
    plane_pose_all(t, t->pose);
    if (!choose_plane(t) || !take_floor(t))
        return false;
    hold_massless_ends(t);
    add_links(t);
    if (!check_roots(t))
        return false;
    if (t->link[0].kind == STANCE_FREE)
        t->robot->map.root_joint[t->robot->map.root_joints++] = t->link[0].joint;
    else
        merge_root(t);
    t->robot->map.free_root = t->link[0].kind == STANCE_FREE;
    return true;
}

void plane_tree_free(struct plane_tree *t)
{
    free(t->pose);
    free(t->start);
    free(t->axis);
    free(t->line);
    free(t->link_of);
    free(t->link);
}
