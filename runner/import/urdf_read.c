/* urdf_read.c - a robot from a URDF: the document, then its tree of links from the root, each with
 * the joint above it, its inertia and what of it may touch.
 *
 * libxml2 reads, without network and without entities of the file's own. What liburdf demands and
 * public files do not have (a root without a body, masses, limits) is not demanded; what they mean
 * by it is said in notes. Where nothing says otherwise the root is free, as URDF has no word for
 * it: it is the world's where it is called `world`, or where neither it nor what is fixed to it has
 * a mass.
 *
 * Of what Gazebo, Drake and others add friction, springs, gravity that is turned off, gears and
 * rotors are taken up; what couples links is refused; the rest is named in notes. Elements of a
 * prefix that nobody declared (`drake:`) are known by the name behind it.
 */
#include "space.h"
#include "urdf.h"

#include <libxml/parser.h>
#include <stdlib.h>
#include <strings.h>

/* A <link>; `node` NULL: the world that joints name and no link does. */
struct urdf_link {
    const xmlNode *node;
    const char *name;
    double mass;
    int above; /* the joint whose child it is, -1: none */
    int body;  /* of the model; -1: the world's, or not taken up yet */
    bool taken;
    const xmlNode *weightless; /* what turns its gravity off */
};

/* A <joint>. */
struct urdf_joint {
    const xmlNode *node;
    const char *name, *type;
    int parent, child; /* links */
    int joint;         /* of the model, the hinge of a planar one; -1: it is fixed */
};

/* The frame itself. */
static const double unturned[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};

/* ---- the document --------------------------------------------------------------------------- */

/* Public files have lines before their <?xml ...?>, or a version of XML that there is none of: all
 * that is kept of it is the encoding. */
static void take_declaration(char *text, char encoding[64])
{
    char *const at = text + strspn(text, " \t\r\n"), *const end = strstr(at, "?>");
    if (strncmp(at, "<?xml ", 6) != 0 || !end)
        return;
    *end = '\0';
    const char *const key = strstr(at, "encoding");
    if (key)
        sscanf(key, "encoding%*[ =\t\r\n\"']%63[a-zA-Z0-9._-]", encoding);
    for (char *c = at; c < end + 2; c++)
        *c = *c == '\n' ? '\n' : ' ';
}

static xmlDoc *parse(const char *path, spatial_message *message)
{
    char encoding[64] = "", *text = NULL;
    size_t room = 0;
    FILE *const in = fopen(path, "rb");
    const ssize_t size = in ? getdelim(&text, &room, '\0', in) : -1; /* all of a text */
    if (in)
        fclose(in);
    if (size > 0)
        take_declaration(text, encoding);
    xmlDoc *const document = xmlReadMemory(
        text, size > 0 ? (int)size : 0, path, encoding[0] ? encoding : NULL,
        XML_PARSE_NONET | XML_PARSE_NOERROR | XML_PARSE_NOWARNING | XML_PARSE_BIG_LINES);
    free(text);
    const xmlError *const why = document ? NULL : xmlGetLastError();
    if (why)
        complain(message, "%s:%d: not XML: %.*s", path, why->line,
                 why->message ? (int)strcspn(why->message, "\n") : 0, why->message);
    else if (!document)
        complain(message, "%s: cannot be read as XML", path);
    return document;
}

/* Elements that xacro replaces; `<robot xmlns:xacro=...>` remains after it. */
static bool check_document(const struct urdf *u, const xmlDoc *document)
{
    if (document->intSubset)
        return urdf_refuse(u, u->root,
                           "it declares a document type (<!DOCTYPE ...>) or entities, "
                           "which are not read: take that out");
    EACH_IN (child, u->root, NULL)
        if ((child->ns && child->ns->prefix &&
             strcmp((const char *)child->ns->prefix, "xacro") == 0) ||
            strncmp((const char *)child->name, "xacro:", 6) == 0)
            return urdf_refuse(u, child,
                               "<%.40s> is for xacro: expand the file first (xacro FILE > "
                               "robot.urdf)",
                               (const char *)child->name);
    return true;
}

/* ---- the tree ------------------------------------------------------------------------------- */

static int find_link(const struct urdf *u, const char *name)
{
    int i = u->links;
    while (--i >= 0 && strcmp(u->link[i].name, name) != 0)
        ;
    return i;
}

static int find_joint(const struct urdf *u, const char *name)
{
    int i = u->joints;
    while (--i >= 0 && strcmp(u->joint[i].name, name) != 0)
        ;
    return i;
}

static bool list_link(struct urdf *u, const xmlNode *node)
{
    const xmlNode *const inertial = urdf_child(node, "inertial", NULL), *const mass = urdf_child(
                                                                            inertial, "mass", NULL);
    struct urdf_link link = {.node = node, .above = -1, .body = -1};
    if (!urdf_need(u, node, "name", &link.name))
        return false;
    const int other = find_link(u, link.name);
    if (other >= 0)
        return urdf_refuse(u, node, "there are two links called %.60s, the other one at line %d",
                           link.name, urdf_line(u->link[other].node));
    if (inertial && !mass)
        return urdf_refuse(u, inertial, "<inertial> has no <mass value=\"...\"/>");
    if (mass && !urdf_numbers(u, mass, "value", 1, &link.mass, URDF_NEEDED | URDF_POSITIVE))
        return false;
    u->link[u->links++] = link;
    return true;
}

/* The link that <parent link="..."/> or <child .../> of a joint names. The world needs no link. */
static bool end_of(struct urdf *u, const struct urdf_joint *j, const char *end, int *link)
{
    const xmlNode *const at = urdf_child(j->node, end, NULL);
    const char *name;
    if (!at)
        return urdf_refuse(u, j->node, "joint %.60s has no <%s link=\"...\"/>", j->name, end);
    if (!urdf_need(u, at, "link", &name))
        return false;
    *link = find_link(u, name);
    if (*link < 0 && strcmp(name, "world") == 0 && strcmp(end, "parent") == 0) {
        *link = u->links;
        u->link[u->links++] = (struct urdf_link){.name = "world", .above = -1, .body = -1};
    }
    return *link >= 0 ||
           urdf_refuse(u, at, "joint %.60s: there is no link called %.60s", j->name, name);
}

static bool list_joint(struct urdf *u, const xmlNode *node)
{
    struct urdf_joint *const j = &u->joint[u->joints];
    *j = (struct urdf_joint){.node = node, .joint = -1};
    if (!urdf_need(u, node, "name", &j->name) || !urdf_need(u, node, "type", &j->type) ||
        !end_of(u, j, "parent", &j->parent) || !end_of(u, j, "child", &j->child))
        return false;
    const int other = find_joint(u, j->name);
    if (other >= 0)
        return urdf_refuse(u, node, "there are two joints called %.60s, the other one at line %d",
                           j->name, urdf_line(u->joint[other].node));
    struct urdf_link *const child = &u->link[j->child];
    if (child->above >= 0)
        return urdf_refuse(u, node,
                           "link %.50s is the child of joint %.50s, too: loops are not read",
                           child->name, u->joint[child->above].name);
    child->above = u->joints++;
    return true;
}

static bool find_root(struct urdf *u)
{
    u->root_link = -1;
    for (int i = 0; i < u->links; i++) {
        if (u->link[i].above >= 0)
            continue;
        if (u->root_link >= 0)
            return urdf_refuse(u, u->link[i].node ? u->link[i].node : u->link[u->root_link].node,
                               "two trees: neither %.60s nor %.60s is the child of a joint",
                               u->link[u->root_link].name, u->link[i].name);
        u->root_link = i;
    }
    if (u->links == 0)
        return urdf_refuse(u, u->root, "the robot has no <link>");
    return u->root_link >= 0 ||
           urdf_refuse(u, u->link[0].node,
                       "every link is the child of a joint: the joints go round "
                       "in a circle, and there is no root");
}

/* Room for every <link> and <joint>, and a world. */
static bool list_tree(struct urdf *u)
{
    const size_t elements = xmlChildElementCount((xmlNode *)(uintptr_t)u->root);
    u->link = spatial_room(elements + 1, sizeof *u->link);
    u->joint = spatial_room(elements, sizeof *u->joint);
    EACH_IN (child, u->root, "link")
        if (!list_link(u, child))
            return false;
    EACH_IN (child, u->root, "joint")
        if (!list_joint(u, child))
            return false;
    return find_root(u);
}

/* ---- bodies --------------------------------------------------------------------------------- */

/* Moments in the axes of <origin>. */
static bool inertia_of(struct urdf *u, const struct urdf_link *link, struct spatial_body *body)
{
    static const char *const keys[3][3] = {
        {"ixx", "ixy", "ixz"}, {"", "iyy", "iyz"}, {"", "", "izz"}};
    const xmlNode *const inertial = urdf_child(link->node, "inertial", NULL), *const at =
                                                                                  urdf_child(
                                                                                      inertial,
                                                                                      "inertia",
                                                                                      NULL);
    double rotation[3][3], moment[3][3] = {{0}};
    body->mass = link->mass;
    for (int i = 0; at && i < 3; i++)
        for (int k = i; k < 3; k++) {
            if (!urdf_numbers(u, at, keys[i][k], 1, &moment[i][k],
                              i == k ? URDF_NEEDED | URDF_POSITIVE : 0))
                return false;
            moment[k][i] = moment[i][k];
        }
    if (!urdf_origin(u, inertial, body->centre, rotation))
        return false;
    space_turn_moments(rotation, moment, body->inertia);
    if (!at && body->mass > 0)
        spatial_note_of(u->model, "point masses, as they have no <inertia>", body->name);
    return true;
}

/* Sizes, of which half count but for a radius. */
static bool shape_of(struct urdf *u, const xmlNode *collision, struct spatial_geom *geom)
{
    static const struct {
        const char *name, *key[2];
        int count;
        spatial_shape shape;
    } shapes[] = {{"sphere", {"radius"}, 1, SPATIAL_SPHERE},
                  {"capsule", {"radius", "length"}, 1, SPATIAL_CAPSULE},
                  {"cylinder", {"radius", "length"}, 1, SPATIAL_CYLINDER},
                  {"box", {"size"}, 3, SPATIAL_BOX}};
    const xmlNode *const shape = urdf_child(urdf_child(collision, "geometry", NULL), NULL, NULL);
    if (!shape)
        return urdf_refuse(u, collision, "<collision> has no <geometry> with a shape");
    geom->shape = SPATIAL_OTHER;
    geom->of = urdf_is(shape, "mesh") ? "mesh" : "shape that is not known";
    for (size_t i = 0; i < sizeof shapes / sizeof *shapes; i++) {
        if (!urdf_is(shape, shapes[i].name))
            continue;
        geom->shape = shapes[i].shape;
        geom->of = shapes[i].name;
        for (int k = 0; k < 2 && shapes[i].key[k]; k++)
            if (!urdf_numbers(u, shape, shapes[i].key[k], shapes[i].count, geom->size + k,
                              URDF_NEEDED | URDF_POSITIVE))
                return false;
        for (int k = geom->shape != SPATIAL_BOX; k < 3; k++)
            geom->size[k] /= 2;
    }
    return true;
}

static bool geoms_of(struct urdf *u, const struct urdf_link *link)
{
    EACH_IN (child, link->node, "collision") {
        struct spatial_geom *const geom = spatial_add(u->model, geom, geoms);
        const char *const name = urdf_text(child, "name");
        spatial_name(geom->name, name && *name ? name : link->name);
        geom->line = urdf_line(child);
        geom->body = link->body;
        geom->friction = NAN;
        geom->meets_floor = true;
        if (!urdf_origin(u, child, geom->at, geom->rotation) || !shape_of(u, child, geom))
            return false;
    }
    return true;
}

/* ---- joints --------------------------------------------------------------------------------- */

static struct spatial_joint *add_joint(struct urdf *u, const char *name, const xmlNode *node,
                                       int body, spatial_joint_kind kind)
{
    struct spatial_joint *const joint = spatial_add(u->model, joint, joints);
    const struct spatial_body *const b = &u->model->body[body];
    joint->kind = kind;
    joint->body = body;
    joint->line = urdf_line(node);
    spatial_name(joint->name, name);
    memcpy(joint->start_place, b->at, sizeof b->at);
    memcpy(joint->start_rotation, b->rotation, sizeof b->rotation);
    return joint;
}

static bool axis_of(struct urdf *u, const struct urdf_joint *j, double axis[3])
{
    const xmlNode *const at = urdf_child(j->node, "axis", NULL);
    axis[0] = 1;
    if (!urdf_numbers(u, at, "xyz", 3, axis, 0))
        return false;
    space_unit(axis, axis);
    return isfinite(axis[0] + axis[1] + axis[2]) ||
           urdf_refuse(u, at, "joint %.60s: its axis has no direction", j->name);
}

/* Exporters write lower = upper = 0 where a designer gave nothing, others lower > upper, and others
 * leave them out. */
static bool limits_of(struct urdf *u, const struct urdf_joint *j, struct spatial_joint *joint)
{
    const xmlNode *const at = urdf_child(j->node, "limit", NULL);
    const bool given = urdf_text(at, "lower") || urdf_text(at, "upper"),
               continuous = strcmp(j->type, "continuous") == 0;
    double *const limits = joint->limits;
    if (!urdf_numbers(u, at, "lower", 1, &limits[0], 0) ||
        !urdf_numbers(u, at, "upper", 1, &limits[1], 0) ||
        !urdf_numbers(u, at, "effort", 1, &joint->effort, 0))
        return false;
    const bool crossed = limits[0] > limits[1];
    joint->limited = !crossed && (limits[0] != 0 || limits[1] != 0);
    if (continuous && joint->limited)
        spatial_note(u->model, "joint %s is continuous, and its limits are kept", j->name);
    if (!continuous && !joint->limited)
        spatial_note(u->model,
                     "joint %s: %s: it has no stops here (if it is not to move: --weld %s)",
                     j->name,
                     crossed ? "lower > upper is what Bullet's files write without limits"
                     : given ? "lower = upper = 0 is what exporters write without limits"
                             : "no limits are given",
                     j->name);
    return true;
}

static bool one_way(struct urdf *u, struct urdf_joint *j, int body, spatial_joint_kind kind)
{
    struct spatial_joint *const joint = add_joint(u, j->name, j->node, body, kind);
    const xmlNode *const dynamics = urdf_child(j->node, "dynamics", NULL), *const mimic =
                                                                               urdf_child(j->node,
                                                                                          "mimic",
                                                                                          NULL);
    j->joint = u->model->joints - 1;
    if (mimic)
        spatial_add_alien(u->model, SPATIAL_MIMIC, j->name, urdf_line(mimic), false);
    return axis_of(u, j, joint->axis) && limits_of(u, j, joint) &&
           urdf_numbers(u, dynamics, "damping", 1, &joint->damping, URDF_POSITIVE) &&
           urdf_numbers(u, dynamics, "friction", 1, &joint->friction, URDF_POSITIVE);
}

/* Two slides at right angles to each other and to the normal, then the hinge about it. */
static bool planar(struct urdf *u, struct urdf_joint *j, int body, spatial_joint_kind kind)
{
    static const char *const suffix[] = {"_a", "_b", ""};
    double axis[3][3] = {{0}}, *const a = axis[0], *const n = axis[2];
    int least = 0;
    if (!axis_of(u, j, n))
        return false;
    for (int i = 1; i < 3; i++)
        least = fabs(n[i]) < fabs(n[least]) ? i : least;
    for (int i = 0; i < 3; i++)
        a[i] = (i == least) - n[least] * n[i];
    space_unit(a, a);
    space_cross(n, a, axis[1]);
    for (int i = 0; i < 3; i++) {
        struct spatial_joint *const joint =
            add_joint(u, j->name, j->node, body, i < 2 ? SPATIAL_SLIDE : kind);
        add_text(joint->name, sizeof joint->name, "%s", suffix[i]);
        memcpy(joint->axis, axis[i], sizeof joint->axis);
    }
    j->joint = u->model->joints - 1;
    return true;
}

static bool floating(struct urdf *u, struct urdf_joint *j, int body, spatial_joint_kind kind)
{
    if (u->model->body[body].parent >= 0)
        return urdf_refuse(
            u, j->node,
            "joint %.60s is floating, but its parent %.60s is not the world: two robots", j->name,
            u->link[j->parent].name);
    add_joint(u, j->name, j->node, body, kind);
    return true;
}

static bool joint_of(struct urdf *u, struct urdf_joint *j, int body)
{
    static const struct {
        const char *type;
        spatial_joint_kind kind;
        bool (*read)(struct urdf *u, struct urdf_joint *j, int body, spatial_joint_kind kind);
    } types[] = {{"revolute", SPATIAL_HINGE, one_way},
                 {"continuous", SPATIAL_HINGE, one_way},
                 {"prismatic", SPATIAL_SLIDE, one_way},
                 {"floating", SPATIAL_FREE, floating},
                 {"planar", SPATIAL_HINGE, planar}};
    for (size_t i = 0; i < sizeof types / sizeof *types; i++)
        if (strcmp(j->type, types[i].type) == 0)
            return types[i].read(u, j, body, types[i].kind);
    return strcmp(j->type, "fixed") == 0 ||
           urdf_refuse(u, j->node,
                       "joint %.60s: type \"%.30s\" is none of fixed, revolute, continuous, "
                       "prismatic, planar, floating",
                       j->name, j->type);
}

/* ---- links ---------------------------------------------------------------------------------- */

/* The root, or what is rigid with it and so gives it its mass. */
static bool is_world(const struct urdf *u)
{
    const char *const name = u->link[u->root_link].name;
    if (strcmp(name, "world") == 0)
        return true;
    for (int i = 0; i < u->links; i++) {
        int link = i;
        for (int steps = 0; steps < u->links && u->link[link].above >= 0 &&
                            strcmp(u->joint[u->link[link].above].type, "fixed") == 0;
             steps++)
            link = u->joint[u->link[link].above].parent;
        if (u->link[i].mass > 0 && link == u->root_link)
            return false;
    }
    spatial_note(u->model, "root %s, and what is fixed to it, has no mass: it is the world", name);
    return true;
}

/* A link as a body, under the joint above it. */
static bool take_link(struct urdf *u, struct urdf_link *link)
{
    struct urdf_joint *const above = link->above >= 0 ? &u->joint[link->above] : NULL;
    link->taken = true;
    if (!above && is_world(u)) /* of which no more is of interest than what may touch */
        return geoms_of(u, link);
    struct spatial_body *const body = spatial_add(u->model, body, bodies);
    link->body = u->model->bodies - 1;
    spatial_name(body->name, link->name);
    body->line = urdf_line(link->node);
    body->parent = above ? u->link[above->parent].body : -1;
    memcpy(body->rotation, unturned, sizeof unturned);
    if ((above && !urdf_origin(u, above->node, body->at, body->rotation)) ||
        !inertia_of(u, link, body))
        return false;
    if (!above) {
        add_joint(u, link->name, link->node, link->body, SPATIAL_FREE);
        spatial_note(u->model, "root %s is free: nothing fixes it (--weld %s does)", link->name,
                     link->name);
    }
    return (!above || joint_of(u, above, link->body)) && geoms_of(u, link);
}

/* From the root, a leg after the other: links that wait lie on a stack, the next one on top. */
static bool take_tree(struct urdf *u)
{
    int *const stack = spatial_room((size_t)u->links, sizeof *stack), waiting = 1;
    bool good = true;
    stack[0] = u->root_link;
    while (good && waiting > 0) {
        const int at = stack[--waiting];
        good = take_link(u, &u->link[at]);
        for (int j = u->joints - 1; j >= 0; j--)
            if (u->joint[j].parent == at)
                stack[waiting++] = u->joint[j].child;
    }
    free(stack);
    for (int i = 0; good && i < u->links; i++)
        if (!u->link[i].taken)
            return urdf_refuse(u, u->link[i].node,
                               "link %.60s hangs on itself, by joint %.60s: loops are not read",
                               u->link[i].name, u->joint[u->link[i].above].name);
    return good;
}

/* ---- what drives joints --------------------------------------------------------------------- */

static void add_motor(struct urdf *u, const xmlNode *at, const char *name, int joint, double gear)
{
    const struct urdf_joint *const j = &u->joint[joint];
    if (j->joint < 0) {
        spatial_note_of(u->model, "motors left out, as their joints are fixed or floating",
                        j->name);
        return;
    }
    struct spatial_actuator *const motor = spatial_add(u->model, actuator, actuators);
    const double effort = fabs(u->model->joint[j->joint].effort);
    spatial_name(motor->name, name && *name ? name : j->name);
    spatial_name(motor->target, j->name);
    motor->line = urdf_line(at);
    motor->joint = j->joint;
    motor->drive = SPATIAL_MOTOR;
    motor->gear = gear;
    motor->limited = effort > 0;
    motor->most = effort > 0 ? effort : INFINITY;
    motor->least = -motor->most;
}

/* A number of the first descendant of a name, as authors put it into the transmission, its joint or
 * actuator; stays where there is none. */
static bool number_within(const struct urdf *u, const xmlNode *node, const char *name,
                          double *value)
{
    EACH_IN (child, node, NULL)
        if (urdf_is(child, name) ? !urdf_number(u, child, value)
                                 : !number_within(u, child, name, value))
            return false;
    return true;
}

/* Of a joint as <joint name="hip"/> or <joint>hip</joint>. What the rotor's inertia is there: n^2
 * J, by Drake's gear ratio or else the reduction. */
static bool transmission(struct urdf *u, const xmlNode *node)
{
    const xmlNode *const at = urdf_child(node, "joint", NULL);
    double reduction = NAN, ratio = NAN, rotor = 0;
    char name[SPATIAL_NAME];
    if (!urdf_value(at, "name", name))
        return urdf_refuse(u, node, "a transmission without <joint name=\"...\"/>");
    if (urdf_child(node, "joint", at))
        return urdf_refuse(u, node,
                           "a transmission of several joints (the first is %.60s) couples them: it "
                           "is not read",
                           name);
    const int joint = find_joint(u, name);
    if (joint < 0)
        return urdf_refuse(u, at, "a transmission of joint %.60s, which the robot does not have",
                           name);
    if (!number_within(u, node, "mechanicalReduction", &reduction) ||
        !number_within(u, node, "gear_ratio", &ratio) ||
        !number_within(u, node, "rotor_inertia", &rotor))
        return false;
    ratio = isfinite(ratio) ? ratio : isfinite(reduction) ? reduction : 1;
    reduction = isfinite(reduction) ? reduction : ratio;
    const double armature = ratio * ratio * rotor;
    if (reduction == 0 || ratio == 0)
        return urdf_refuse(u, node, "the transmission of joint %.60s has a reduction of 0", name);
    if (armature < 0 || !isfinite(armature))
        return urdf_refuse(u, node, "the rotor of joint %.60s has an inertia of %g at the joint",
                           name, armature);
    if (u->joint[joint].joint >= 0)
        u->model->joint[u->joint[joint].joint].armature += armature;
    add_motor(u, node, urdf_text(urdf_child(node, "actuator", NULL), "name"), joint, reduction);
    return true;
}

/* Then joints that say how much can drive them and have nothing that does. */
static bool drives(struct urdf *u)
{
    const bool transmissions = urdf_child(u->root, "transmission", NULL) != NULL;
    int motors = 0;
    EACH_IN (child, u->root, "transmission")
        if (!transmission(u, child))
            return false;
    for (int i = 0; i < u->joints; i++) {
        const struct urdf_joint *const j = &u->joint[i];
        bool driven = j->joint < 0 || u->model->joint[j->joint].effort <= 0;
        for (int a = 0; transmissions && a < u->model->actuators; a++)
            driven = driven || u->model->actuator[a].joint == j->joint;
        if (driven)
            continue;
        if (transmissions)
            spatial_note(u->model, "joint %s has an effort and no <transmission>: no motor",
                         j->name);
        else
            add_motor(u, j->node, j->name, i, 1);
        motors++;
    }
    if (motors > 0 && !transmissions)
        spatial_note(u->model,
                     "no <transmission>: each joint with an effort has a motor, %d of them",
                     motors);
    return true;
}

/* ---- Gazebo and others ---------------------------------------------------------------------- */

/* Notes are kept once each. */
static void leave_out(struct urdf *u, const xmlNode *node)
{
    spatial_note_of(u->model, "left out, as it does not move the robot by itself", urdf_name(node));
}

static bool of_link(struct urdf *u, const xmlNode *at, struct urdf_link *link)
{
    char text[SPATIAL_NAME];
    urdf_value(at, "value", text);
    const bool on = strcmp(text, "1") == 0 || strcasecmp(text, "true") == 0;
    double friction = 0;
    if (urdf_is(at, "mu1") || urdf_is(at, "mu")) {
        if (!urdf_number(u, at, &friction))
            return false;
        for (int g = 0; g < u->model->geoms; g++)
            if (u->model->geom[g].body == link->body)
                u->model->geom[g].friction = friction;
    } else if (urdf_is(at, "turnGravityOff") || urdf_is(at, "gravity")) {
        link->weightless = urdf_is(at, "gravity") != on ? at : NULL;
    } else if (!urdf_is(at, "mu2") && !urdf_is(at, "material")) {
        leave_out(u, at);
    }
    return true;
}

static bool gazebo(struct urdf *u, const xmlNode *node)
{
    const char *const of = urdf_text(node, "reference");
    const int link = of ? find_link(u, of) : -1, joint = of ? find_joint(u, of) : -1;
    const int own = joint >= 0 ? u->joint[joint].joint : -1;
    EACH_IN (child, node, NULL) {
        const bool spring = own >= 0 && urdf_is(child, "springStiffness"),
                   rest = own >= 0 && urdf_is(child, "springReference");
        if (spring || rest) {
            struct spatial_joint *const j = &u->model->joint[own];
            if (!urdf_number(u, child, spring ? &j->stiffness : &j->spring_reference))
                return false;
        } else if (link >= 0) {
            if (!of_link(u, child, &u->link[link]))
                return false;
        } else {
            leave_out(u, child);
        }
    }
    return true;
}

/* Gravity that acts on some of the robot only cannot be had; that on none of it is none. */
static void weigh(struct urdf *u)
{
    int heavy = 0, off = 0;
    for (int i = 0; i < u->links; i++) {
        if (u->link[i].body < 0 || u->link[i].mass == 0)
            u->link[i].weightless = NULL;
        else
            heavy++;
        off += u->link[i].weightless != NULL;
    }
    for (int i = 0; off < heavy && i < u->links; i++)
        if (u->link[i].weightless)
            spatial_add_alien(u->model, "link without gravity", u->link[i].name,
                              urdf_line(u->link[i].weightless), false);
    if (off == 0 || off < heavy)
        return;
    u->model->gravity[2] = 0;
    spatial_note(u->model, "no link has gravity: there is none");
}

static bool extras(struct urdf *u)
{
    static const char *const known[] = {"link", "joint", "transmission", "material"};
    static const char *const couples[] = {"loop_joint", "ball_constraint", "linear_bushing_rpy",
                                          "force_element"};
    EACH_IN (child, u->root, NULL) {
        bool passed = urdf_is(child, "gazebo");
        if (passed && !gazebo(u, child))
            return false;
        for (int i = 0; i < 4; i++) {
            passed = passed || urdf_is(child, known[i]);
            if (urdf_is(child, couples[i])) {
                const char *const name = urdf_text(child, "name");
                spatial_add_alien(u->model, couples[i], name ? name : "", urdf_line(child), false);
            }
        }
        if (!passed)
            leave_out(u, child);
    }
    weigh(u);
    return true;
}

static bool read_robot(struct urdf *u, const xmlDoc *document)
{
    spatial_name(u->model->title, urdf_text(u->root, "name"));
    u->model->gravity[2] = -STANCE_GRAVITY;
    if (!check_document(u, document) || !list_tree(u) || !take_tree(u) || !drives(u) || !extras(u))
        return false;
    if (u->turned > 0)
        spatial_note(u->model,
                     "rpy such as 1.57 are right angles as far as their digits tell, and taken as "
                     "these: %d",
                     u->turned);
    return true;
}

bool urdf_read(const char *path, struct spatial_model *model, spatial_message *message)
{
    struct urdf u = {.model = model, .message = message};
    xmlDoc *const document = parse(path, message);
    spatial_begin(model, path, "URDF");
    if (!document)
        return false;
    u.root = xmlDocGetRootElement(document);
    const bool good = read_robot(&u, document);
    free(u.link);
    free(u.joint);
    xmlFreeDoc(document);
    return good;
}
