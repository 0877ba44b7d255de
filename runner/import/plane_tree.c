/* plane_tree.c - from bodies in space to links of the plane. */
#include "plane_tree.h"
#include "space.h"

#include "runner/base/words.h"

#include <stdarg.h>
#include <stdlib.h>

#define PARALLEL 1e-6 /* sine of the angle by which directions may differ */

void plane_say(const struct plane_tree *t, int line, const char *format, ...)
{
    char *const text = t->message->text;
    const size_t size = sizeof t->message->text;
    va_list arguments;
    snprintf(text, size, line > 0 ? "%.100s:%d: " : "%.100s: ", t->model->file, line);
    const size_t length = strlen(text);
    va_start(arguments, format);
    vsnprintf(text + length, size - length, format, arguments);
    va_end(arguments);
}

void plane_turn(double angle, const double v[2], double out[2])
{
    const double c = cos(angle), s = sin(angle), x = v[0], z = v[1];
    out[0] = c * x - s * z;
    out[1] = s * x + c * z;
}

void plane_direction(const struct plane_tree *t, const double of[3], double out[2])
{
    out[0] = space_dot(of, t->robot->map.ahead);
    out[1] = space_dot(of, t->robot->map.up);
}

void plane_place(const struct plane_tree *t, const double at[3], double out[2])
{
    double from[3];
    for (int i = 0; i < 3; i++)
        from[i] = at[i] - t->robot->map.origin[i];
    plane_direction(t, from, out);
}

void plane_in_link(const struct plane_tree *t, int body, const double at[3], double out[2])
{
    const struct plane_link *const link = &t->link[t->link_of[body]];
    double world[3], flat[2];
    space_place(t->pose[body].at, t->pose[body].rotation, at, world);
    plane_place(t, world, flat);
    plane_turn(-link->turn, (const double[]){flat[0] - link->at[0], flat[1] - link->at[1]}, out);
}

/* ---- welds -------------------------------------------------------------------------------------
 */

const char *plane_joint_name(const struct plane_tree *t, int j)
{
    const struct spatial_joint *const joint = &t->model->joint[j];
    return joint->name[0] ? joint->name : t->model->body[joint->body].name;
}

static bool weld(struct plane_tree *t, const char *name)
{
    const int joints = t->model->joints;
    const char **const names = calloc((size_t)joints + 1, sizeof *names);
    int found = -1;
    if (!names)
        return no_memory(t->message);
    for (int j = 0; j < joints; j++) {
        names[j] = plane_joint_name(t, j);
        if (strcmp(names[j], name) == 0)
            found = j;
    }
    const char *const near = nearest_word(name, names, (size_t)joints);
    free(names);
    if (found < 0)
        return plane_refuse(t, 0, "--weld %.60s: there is no joint of this name%s%.60s%s", name,
                            near ? "; did you mean '" : "", near ? near : "", near ? "'?" : "");
    t->welded[found] = true;
    t->robot->map.held[found] = true;
    spatial_note(t->model, "joint %.60s is welded where it begins, at %.6g", name,
                 t->model->joint[found].start + 0.0);
    return true;
}

/* ---- poses -------------------------------------------------------------------------------------
 */

/* A welded joint stands where it begins. */
static void pose_welded(const struct spatial_joint *joint, const struct plane_line *line,
                        struct plane_pose *pose)
{
    const double by = joint->start - joint->reference;
    double turn[3][3], at[3];
    if (joint->kind == SPATIAL_SLIDE) {
        for (int i = 0; i < 3; i++)
            pose->at[i] += by * line->axis[i];
    } else if (joint->kind == SPATIAL_HINGE) {
        space_rotation(line->axis, by, turn);
        space_product(turn, pose->rotation, pose->rotation);
        space_turn(pose->rotation, joint->at, at);
        for (int i = 0; i < 3; i++)
            pose->at[i] = line->at[i] - at[i];
    } else if (joint->kind == SPATIAL_FREE) {
        memcpy(pose->at, joint->start_place, sizeof pose->at);
        memcpy(pose->rotation, joint->start_rotation, sizeof pose->rotation);
    }
}

/* Joints stand in the order of their bodies, and act one after the other. */
static void pose_all(struct plane_tree *t)
{
    const struct spatial_model *const model = t->model;
    int j = 0;
    for (int b = 0; b < model->bodies; b++) {
        const struct spatial_body *const body = &model->body[b];
        struct plane_pose *const pose = &t->pose[b];
        memcpy(pose->at, body->at, sizeof pose->at);
        memcpy(pose->rotation, body->rotation, sizeof pose->rotation);
        if (body->parent >= 0) {
            const struct plane_pose *const from = &t->pose[body->parent];
            space_place(from->at, from->rotation, body->at, pose->at);
            space_product(from->rotation, body->rotation, pose->rotation);
        }
        for (; j < model->joints && model->joint[j].body == b; j++) {
            space_turn(pose->rotation, model->joint[j].axis, t->line[j].axis);
            space_place(pose->at, pose->rotation, model->joint[j].at, t->line[j].at);
            if (t->welded[j])
                pose_welded(&model->joint[j], &t->line[j], pose);
        }
    }
}

/* ---- the plane ---------------------------------------------------------------------------------
 */

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

/* The direction that most hinges have; of as many that which is across gravity, the first. */
static bool common_axis(const struct plane_tree *t, double normal[3])
{
    const struct spatial_model *const model = t->model;
    double best = 0;
    for (int j = 0; j < model->joints; j++) {
        const double *const axis = t->line[j].axis;
        double votes =
            fabs(space_dot(axis, model->gravity)) < PARALLEL * (1 + space_length(model->gravity))
                ? 0.5
                : 0;
        if (model->joint[j].kind != SPATIAL_HINGE || t->welded[j])
            continue;
        for (int k = 0; k < model->joints; k++)
            votes += model->joint[k].kind == SPATIAL_HINGE && !t->welded[k] &&
                     parallel(axis, t->line[k].axis);
        if (votes > best) {
            best = votes;
            memcpy(normal, axis, sizeof(double[3]));
        }
    }
    return best > 0;
}

/* Without hinges: y, unless a slide or gravity goes along it; then x, then z. */
static void free_axis(const struct plane_tree *t, double normal[3])
{
    static const int order[3] = {1, 0, 2};
    for (int k = 0; k < 3; k++) {
        const int axis = order[k];
        bool across = fabs(t->model->gravity[axis]) <= PARALLEL * space_length(t->model->gravity);
        for (int i = 0; i < 3; i++)
            normal[i] = i == axis;
        for (int j = 0; j < t->model->joints; j++)
            across = across && (t->model->joint[j].kind != SPATIAL_SLIDE || t->welded[j] ||
                                fabs(t->line[j].axis[axis]) < PARALLEL);
        if (across)
            return;
    }
}

static void choose_normal(const struct plane_tree *t, double normal[3])
{
    static const char *const planes[] = {"xz", "yz", "xy"};
    static const double normals[][3] = {{0, 1, 0}, {1, 0, 0}, {0, 0, 1}};
    for (int k = 0; t->wishes->plane && k < 3; k++)
        if (strcmp(t->wishes->plane, planes[k]) == 0) {
            memcpy(normal, normals[k], sizeof normals[k]);
            return;
        }
    if (!common_axis(t, normal))
        free_axis(t, normal);
    /* Exactly an axis of the file's, where it is one but for rounding. */
    for (int k = 0; k < 3; k++)
        if (parallel(normal, normals[k]))
            memcpy(normal, normals[k], sizeof normals[k]);
}

static bool in_plane(const struct plane_tree *t, int j, const double normal[3])
{
    const spatial_joint_kind kind = t->model->joint[j].kind;
    return t->welded[j] || kind == SPATIAL_FREE ||
           (kind == SPATIAL_HINGE && parallel(t->line[j].axis, normal)) ||
           (kind == SPATIAL_SLIDE && fabs(space_dot(t->line[j].axis, normal)) < PARALLEL);
}

/* The first joint that is not of the plane, and how many more are not: " (so with a, b)". */
static bool refuse_joint(const struct plane_tree *t, int j, const double normal[3])
{
    const struct spatial_joint *const joint = &t->model->joint[j];
    const char *const name = plane_joint_name(t, j);
    char axis[64], of[64], others[90] = "";
    for (int k = j + 1; k < t->model->joints; k++)
        if (!in_plane(t, k, normal))
            add_text(others, sizeof others - 2, "%s%.20s", others[0] ? ", " : " (so with ",
                     plane_joint_name(t, k));
    if (others[0])
        add_text(others, sizeof others, ")");
    if (joint->kind == SPATIAL_BALL)
        return plane_refuse(t, joint->line,
                            "joint '%.40s' is a ball, which turns out of the plane: --weld %.40s "
                            "holds it%s",
                            name, name, others);
    const bool hinge = joint->kind == SPATIAL_HINGE;
    return plane_refuse(t, joint->line,
                        "joint '%.25s' %s %s, not %s the normal %s: --weld %.25s "
                        "holds it%s, --plane chooses another plane",
                        name, hinge ? "turns about" : "slides along",
                        axis_text(t->line[j].axis, axis), hinge ? "along" : "across",
                        axis_text(normal, of), name, others);
}

static bool check_joint(const struct plane_tree *t, int j, const double normal[3])
{
    const struct spatial_joint *const joint = &t->model->joint[j];
    if (!t->welded[j] && (joint->kind == SPATIAL_HINGE || joint->kind == SPATIAL_SLIDE) &&
        !(fabs(space_length(t->line[j].axis) - 1) < PARALLEL))
        return plane_refuse(t, joint->line, "joint '%.60s' has no axis", plane_joint_name(t, j));
    return in_plane(t, j, normal) || refuse_joint(t, j, normal);
}

/* Up is against gravity; without any, along the file's z, else its y. */
static bool choose_axes(struct plane_tree *t, const double normal[3])
{
    struct plane_map *const map = &t->robot->map;
    const double *const gravity = t->model->gravity;
    const double across = space_dot(gravity, normal), size = space_length(gravity);
    const bool wanted = t->wishes->plane != NULL;
    double flat[3];
    char text[64];
    if (fabs(across) > PARALLEL * size && !wanted)
        return plane_refuse(t, 0,
                            "gravity %s is not in the plane of the joints, whose normal is %s: "
                            "--plane xz, yz or xy takes one, and of gravity what is in it",
                            axis_text(gravity, text), axis_text(normal, (char[64]){0}));
    for (int i = 0; i < 3; i++)
        flat[i] = gravity[i] - across * normal[i];
    t->robot->gravity = space_length(flat);
    if (fabs(across) > PARALLEL * size)
        spatial_note(t->model, "gravity across the plane, %.6g m/s^2, is left out", fabs(across));
    if (t->robot->gravity <= PARALLEL * size) {
        t->robot->gravity = 0;
        const int up = fabs(normal[2]) < 0.9 ? 2 : 1;
        for (int i = 0; i < 3; i++)
            flat[i] = (i == up ? -1 : 0) + normal[up] * normal[i];
    }
    space_unit(flat, map->up);
    for (int i = 0; i < 3; i++)
        map->up[i] = 0 - map->up[i];
    space_cross(map->up, normal, map->ahead);
    /* Ahead is where the largest part of it is positive. */
    int largest = 0;
    for (int i = 1; i < 3; i++)
        largest = fabs(map->ahead[i]) > fabs(map->ahead[largest]) + 1e-9 ? i : largest;
    const double sign = map->ahead[largest] < 0 ? -1 : 1;
    for (int i = 0; i < 3; i++)
        map->ahead[i] = 0.0 + sign * map->ahead[i]; /* no negative zeros */
    space_cross(map->ahead, map->up, map->normal);
    if (map->ahead[0] != 1 || map->up[2] != 1)
        spatial_note(t->model, "x is the file's %s, z its %s", axis_text(map->ahead, text),
                     axis_text(map->up, (char[64]){0}));
    return true;
}

static bool choose_plane(struct plane_tree *t)
{
    double normal[3] = {0};
    choose_normal(t, normal);
    for (int j = 0; j < t->model->joints; j++)
        if (!check_joint(t, j, normal))
            return false;
    return choose_axes(t, normal);
}

/* ---- links -------------------------------------------------------------------------------------
 */

/* How a body's frame is turned in the plane: by its x axis, where that is in the plane, else its
 * z. */
static double frame_turn(const struct plane_tree *t, int body)
{
    double axis[3], flat[2], angle;
    space_column(t->pose[body].rotation, 0, axis);
    plane_direction(t, axis, flat);
    if (hypot(flat[0], flat[1]) > 0.7) {
        angle = atan2(flat[1], flat[0]);
    } else {
        space_column(t->pose[body].rotation, 2, axis);
        plane_direction(t, axis, flat);
        angle = atan2(-flat[0], flat[1]);
    }
    return fabs(angle) < 1e-14 ? 0 : angle;
}

static void add_link(struct plane_tree *t, int j, bool last)
{
    const struct spatial_joint *const joint = &t->model->joint[j];
    struct plane_link *const link = &t->link[t->links];
    const int parent = t->link_of[joint->body];
    *link = (struct plane_link){
        .parent = parent, .joint = j, .body = joint->body, .between = !last, .sign = 1};
    link->kind = joint->kind == SPATIAL_FREE    ? STANCE_FREE
                 : joint->kind == SPATIAL_SLIDE ? STANCE_SLIDE
                                                : STANCE_HINGE;
    plane_place(t, joint->kind == SPATIAL_HINGE ? t->line[j].at : t->pose[joint->body].at,
                link->at);
    plane_direction(t, t->line[j].axis, link->axis);
    if (joint->kind == SPATIAL_HINGE)
        link->sign = space_dot(t->line[j].axis, t->robot->map.normal) > 0 ? 1 : -1;
    link->turn = last ? frame_turn(t, joint->body) : parent < 0 ? 0 : t->link[parent].turn;
    if (parent >= 0)
        t->link[parent].children++;
    t->link_of[joint->body] = t->links++;
}

static void add_links(struct plane_tree *t)
{
    const struct spatial_model *const model = t->model;
    int j = 0;
    for (int b = 0; b < model->bodies; b++) {
        t->link_of[b] = model->body[b].parent < 0 ? -1 : t->link_of[model->body[b].parent];
        int last = -1;
        for (int k = j; k < model->joints && model->joint[k].body == b; k++)
            last = t->welded[k] ? last : k;
        for (; j < model->joints && model->joint[j].body == b; j++)
            if (!t->welded[j])
                add_link(t, j, j == last);
        if (t->link_of[b] >= 0)
            t->link[t->link_of[b]].mass += model->body[b].mass;
    }
    for (int g = 0; g < model->geoms; g++)
        if (model->geom[g].body >= 0 && t->link_of[model->geom[g].body] >= 0 &&
            model->geom[g].meets_floor)
            t->link[t->link_of[model->geom[g].body]].touches = true;
}

/* Links `from` and after it move up to `to`; those in between are no more. */
static void drop_links(struct plane_tree *t, int to, int from, int instead)
{
    const int by = from - to;
    for (int b = 0; b < t->model->bodies; b++)
        if (t->link_of[b] >= to)
            t->link_of[b] = t->link_of[b] < from ? instead : t->link_of[b] - by;
    for (int k = from; k < t->links; k++) {
        t->link[k - by] = t->link[k];
        if (t->link[k - by].parent >= to)
            t->link[k - by].parent -= by;
    }
    t->links -= by;
}

/* A link without mass at the end of a chain moves nothing: it stays at its reference. */
static void drop_massless_ends(struct plane_tree *t)
{
    for (int k = t->links - 1; k > 0; k--) {
        const struct plane_link link = t->link[k];
        if (link.children > 0 || link.mass > 0)
            continue;
        spatial_note(t->model,
                     "link %.50s has no mass, and nothing hangs on it: its joint is "
                     "left out",
                     t->model->body[link.body].name);
        t->robot->map.held[link.joint] = true;
        if (link.parent >= 0) {
            t->link[link.parent].children--;
            t->link[link.parent].touches |= link.touches;
        }
        drop_links(t, k, k + 1, link.parent);
    }
}

/* ---- the root ----------------------------------------------------------------------------------
 */

static bool is_driven(const struct spatial_model *model, int j)
{
    for (int a = 0; a < model->actuators; a++)
        if (model->actuator[a].joint == j)
            return true;
    return false;
}

/* Does a joint nothing but lead? */
static bool is_bare(const struct spatial_model *model, int j)
{
    const struct spatial_joint *const joint = &model->joint[j];
    return joint->damping == 0 && joint->stiffness == 0 && joint->armature == 0 &&
           !joint->limited && !is_driven(model, j);
}

/* Two slides and a hinge of links without mass but for the last: they are one, and free. */
static void merge_root(struct plane_tree *t)
{
    const struct plane_link *const link = t->link;
    struct plane_map *const map = &t->robot->map;
    int slides = 0, hinge = -1, way[3] = {0};
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
    if (t->links < 3 || slides != 2 || link[hinge].kind != STANCE_HINGE)
        return;
    const double *const a = link[way[0]].axis, *const b = link[way[1]].axis;
    if (fabs(a[0] * b[1] - a[1] * b[0]) < PARALLEL)
        return;
    if (!bare) {
        spatial_note(t->model, "the root's slides and hinge have springs, dampers, limits or "
                               "motors: they stay joints of their own");
        return;
    }
    struct plane_link root = link[2];
    root.kind = STANCE_FREE;
    root.parent = -1;
    root.joint = link[hinge].joint;
    root.sign = link[hinge].sign;
    memcpy(root.at, link[hinge].at, sizeof root.at);
    for (int k = 0; k < 3; k++)
        map->root_joint[map->root_joints++] = link[k].joint;
    drop_links(t, 0, 2, 0);
    t->link[0] = root;
}

static bool check_roots(const struct plane_tree *t)
{
    int first = -1;
    for (int k = 0; k < t->links; k++) {
        const struct plane_link *const link = &t->link[k];
        const struct spatial_body *const body = &t->model->body[link->body];
        if (link->parent >= 0 && link->kind == STANCE_FREE)
            return plane_refuse(t, body->line,
                                "body '%.60s' is free, but hangs from another: only "
                                "a root is free",
                                body->name);
        if (link->parent >= 0)
            continue;
        if (first >= 0)
            return plane_refuse(t, body->line,
                                "bodies '%.50s' and '%.50s' both begin a tree: a robot is one "
                                "tree, take the other out of the file",
                                t->model->body[t->link[first].body].name, body->name);
        first = k;
    }
    return first >= 0 || plane_refuse(t, 0, "nothing moves: all bodies are fixed to the world");
}

static bool find_root(struct plane_tree *t)
{
    struct plane_map *const map = &t->robot->map;
    if (!check_roots(t))
        return false;
    drop_massless_ends(t);
    if (t->link[0].kind == STANCE_FREE)
        map->root_joint[map->root_joints++] = t->link[0].joint;
    else
        merge_root(t);
    map->free_root = t->link[0].kind == STANCE_FREE;
    return true;
}

/* ---- the floor ---------------------------------------------------------------------------------
 */

static bool is_fixed(const struct plane_tree *t, int body)
{
    for (; body >= 0; body = t->model->body[body].parent)
        for (int j = 0; j < t->model->joints; j++)
            if (t->model->joint[j].body == body && !t->welded[j])
                return false;
    return true;
}

/* Is a box as ground is: wider in the plane than it is high, and wider than a step? */
static bool is_wide(const struct plane_tree *t, const struct spatial_geom *box)
{
    double rotation[3][3], extent[2] = {0};
    memcpy(rotation, box->rotation, sizeof rotation);
    if (box->body >= 0)
        space_product(t->pose[box->body].rotation, box->rotation, rotation);
    for (int k = 0; k < 3; k++) {
        double axis[3], flat[2];
        space_column(rotation, k, axis);
        plane_direction(t, axis, flat);
        extent[0] += 2 * box->size[k] * fabs(flat[0]);
        extent[1] += 2 * box->size[k] * fabs(flat[1]);
    }
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
static void floor_face(const struct plane_tree *t, const struct spatial_geom *geom, double at[3],
                       double normal[3])
{
    static const struct plane_pose world = {.rotation = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
    const struct plane_pose *const pose = geom->body < 0 ? &world : &t->pose[geom->body];
    double rotation[3][3], least = -2;
    int face = 2;
    space_place(pose->at, pose->rotation, geom->at, at);
    space_product(pose->rotation, geom->rotation, rotation);
    space_column(rotation, face, normal);
    if (geom->shape != SPATIAL_BOX)
        return;
    for (int k = 0; k < 6; k++) {
        double out[3];
        space_column(rotation, k / 2, out);
        for (int i = 0; i < 3; i++)
            out[i] *= k % 2 ? -1 : 1;
        if (space_dot(out, t->robot->map.up) > least) {
            least = space_dot(out, t->robot->map.up);
            face = k / 2;
            memcpy(normal, out, sizeof out);
        }
    }
    for (int i = 0; i < 3; i++)
        at[i] += geom->size[face] * normal[i];
}

static void note_others(struct plane_tree *t, int floor)
{
    for (int g = 0; g < t->model->geoms; g++) {
        const struct spatial_geom *const geom = &t->model->geom[g];
        const char *const of =
            geom->name[0] || geom->body < 0 ? geom->name : t->model->body[geom->body].name;
        if (g != floor && geom->meets_floor && is_fixed(t, geom->body))
            spatial_note(t->model,
                         "%s%s%.60s stands still and is left out: the ground is one half "
                         "plane",
                         geom->of, of[0] ? " " : "", of);
    }
}

/* The ground goes through the origin of the scene's world: the file's, along `up`. */
static bool take_floor(struct plane_tree *t)
{
    struct plane_map *const map = &t->robot->map;
    const int floor = find_floor(t);
    double at[3], normal[3];
    t->floor_friction = NAN;
    t->has_floor = floor >= 0;
    note_others(t, floor);
    if (floor < 0)
        return true;
    const struct spatial_geom *const geom = &t->model->geom[floor];
    floor_face(t, geom, at, normal);
    const double across = fabs(space_dot(normal, map->normal));
    if (across > 1 - PARALLEL) { /* as one who lies on it sees it */
        spatial_note(t->model, "the floor is left out: the robot moves along it");
        t->along_floor = true;
        t->has_floor = false;
        return true;
    }
    if (across > PARALLEL)
        return plane_refuse(t, geom->line, "floor '%.60s' is tilted across the plane", geom->name);
    if (space_dot(normal, map->up) < 0.02)
        return plane_refuse(t, geom->line,
                            "floor '%.60s' stands upright, or is overhead: gravity "
                            "does not press the robot on it",
                            geom->name);
    const double height = space_dot(at, normal) / space_dot(map->up, normal);
    for (int i = 0; i < 3; i++)
        map->origin[i] = height * map->up[i];
    t->robot->slope = atan2(space_dot(normal, map->ahead), space_dot(normal, map->up));
    if (fabs(t->robot->slope) < 1e-14)
        t->robot->slope = 0;
    else
        spatial_note(t->model, "the floor slopes by %.6g rad against gravity", t->robot->slope);
    if (fabs(height) > 1e-14)
        spatial_note(t->model, "z is 0 on the floor, %.6g m in the file", height);
    t->floor_friction = geom->friction;
    if (geom->shape == SPATIAL_BOX)
        spatial_note(t->model, "box %.60s is the ground, without ends", geom->name);
    return true;
}

/* ---- all of it ---------------------------------------------------------------------------------
 */

static bool make_room(struct plane_tree *t)
{
    const size_t bodies = (size_t)t->model->bodies + 1, joints = (size_t)t->model->joints + 1;
    t->pose = calloc(bodies, sizeof *t->pose);
    t->line = calloc(joints, sizeof *t->line);
    t->link_of = calloc(bodies, sizeof *t->link_of);
    t->welded = calloc(joints, sizeof *t->welded);
    t->link = calloc(joints, sizeof *t->link);
    t->robot->map.held = calloc(joints, sizeof *t->robot->map.held);
    return (t->pose && t->line && t->link_of && t->welded && t->link && t->robot->map.held) ||
           no_memory(t->message);
}

bool plane_tree_make(struct plane_tree *t)
{
    if (!make_room(t))
        return false;
    for (size_t w = 0; w < t->wishes->welds; w++)
        if (!weld(t, t->wishes->weld[w]))
            return false;
    pose_all(t);
    if (!choose_plane(t) || !take_floor(t))
        return false;
    add_links(t);
    return find_root(t);
}

void plane_tree_free(struct plane_tree *t)
{
    free(t->pose);
    free(t->line);
    free(t->link_of);
    free(t->welded);
    free(t->link);
}
