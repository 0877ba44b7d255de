/* urdf_read.c - a robot from a URDF: the document, then its tree of links from the root, each with
 * the joint above it, its inertia and what of it may touch.
 *
 * libxml2 reads, without network and without entities of the file's own. What liburdf demands and
 * public files do not have (a root without a body, masses, limits) is not demanded; what they mean
 * by it is said in notes. Where nothing says otherwise the root is free, as URDF has no word for
 * it: it is the world's where it is called `world`, or where neither it nor what is fixed to it has
 * a mass.
 */
#include "urdf.h"

#include <errno.h>
#include <fcntl.h>
#include <libxml/parser.h>
#include <math.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

/* The frame itself. */
static const double unturned[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};

static void name_it(char name[SPATIAL_NAME], const char *text)
{
    snprintf(name, SPATIAL_NAME, "%s", text);
}

/* ---- the document ---------------------------------------------------------------------------- */

static bool not_xml(const char *path, const xmlError *why, stance_message *message)
{
    if (!why)
        return complain(message, "%s: cannot be read as XML", path);
    if (why->domain == XML_FROM_IO)
        return complain(message, "%s: cannot be read: %s", path, strerror(errno));
    if (why->code == XML_ERR_DOCUMENT_EMPTY)
        return complain(message, "%s:%d: no XML stands here, so no robot", path, why->line);
    const char *const text = why->message ? why->message : "malformed\n";
    return complain(message, "%s:%d: not XML: %.*s", path, why->line, (int)strcspn(text, "\n"),
                    text);
}

static xmlDoc *parse(const char *path, stance_message *message)
{
    const int options =
        XML_PARSE_NONET | XML_PARSE_NOERROR | XML_PARSE_NOWARNING | XML_PARSE_BIG_LINES;
    const int file = open(path, O_RDONLY | O_CLOEXEC);
    xmlParserCtxt *const context = file >= 0 ? xmlNewParserCtxt() : NULL;
    xmlDoc *document = NULL;
    struct stat what;
    if (file < 0)
        complain(message, "%s: cannot be read: %s", path, strerror(errno));
    else if (fstat(file, &what) == 0 && S_ISDIR(what.st_mode))
        complain(message, "%s: cannot be read: %s", path, strerror(EISDIR));
    else if (!context)
        no_memory(message);
    else if (!(document = xmlCtxtReadFd(context, file, path, NULL, options)))
        not_xml(path, xmlCtxtGetLastError(context), message);
    xmlFreeParserCtxt(context);
    if (file >= 0)
        close(file);
    return document;
}

/* Whether an element is one that xacro replaces; `<robot xmlns:xacro=...>` remains after it. */
static bool of_xacro(const xmlNode *node)
{
    return (node->ns && node->ns->prefix && strcmp((const char *)node->ns->prefix, "xacro") == 0) ||
           strncmp((const char *)node->name, "xacro:", 6) == 0;
}

static bool right_root(const struct urdf *u)
{
    const char *const name = urdf_name(u->root);
    const char *const other = strcmp(name, "sdf") == 0 ? "this is SDF, which is not read"
                              : strcmp(name, "mujoco") == 0
                                  ? "this is MJCF: a file of that is called .xml"
                                  : "this is no robot's description";
    return strcmp(name, "robot") == 0 ||
           urdf_refuse(u, u->root, "<%.40s> begins it, not <robot>: %s", name, other);
}

static bool check_document(struct urdf *u, const xmlDoc *document)
{
    if (document->intSubset)
        return urdf_refuse(u, u->root,
                           "it declares a document type (<!DOCTYPE ...>) or entities, "
                           "which are not read: take that out");
    if (!right_root(u))
        return false;
    EACH_IN (child, u->root, NULL)
        if (of_xacro(child))
            return urdf_refuse(u, child,
                               "<%.40s> is for xacro: expand the file first (xacro FILE > "
                               "robot.urdf)",
                               (const char *)child->name);
    return true;
}

/* ---- the tree -------------------------------------------------------------------------------- */

static int count_of(const xmlNode *root, const char *name)
{
    int count = 0;
    EACH_IN (child, root, name)
        count++;
    return count;
}

int urdf_find_link(const struct urdf *u, const char *name)
{
    int i = u->links;
    while (--i >= 0 && strcmp(u->link[i].name, name) != 0)
        ;
    return i;
}

int urdf_find_joint(const struct urdf *u, const char *name)
{
    int i = u->joints;
    while (--i >= 0 && strcmp(u->joint[i].name, name) != 0)
        ;
    return i;
}

static bool list_links(struct urdf *u)
{
    EACH_IN (child, u->root, "link") {
        const char *name;
        if (!urdf_need(u, child, "name", &name))
            return false;
        const int other = urdf_find_link(u, name);
        if (other >= 0)
            return urdf_refuse(u, child,
                               "there are two links called %.60s, the other one at line %d", name,
                               urdf_line(u->link[other].node));
        u->link[u->links++] =
            (struct urdf_link){.node = child, .name = name, .above = -1, .body = -1};
    }
    return u->links > 0 || urdf_refuse(u, u->root, "the robot has no <link>");
}

/* The link that <parent link="..."/> or <child .../> of a joint names. The world needs no link. */
static bool end_of(struct urdf *u, const xmlNode *joint, const char *end, int *link)
{
    const xmlNode *const at = urdf_child(joint, end, NULL);
    const char *name;
    if (!at)
        return urdf_refuse(u, joint, "joint %.60s has no <%s link=\"...\"/>",
                           urdf_text(joint, "name"), end);
    if (!urdf_need(u, at, "link", &name))
        return false;
    *link = urdf_find_link(u, name);
    if (*link < 0 && strcmp(name, "world") == 0 && strcmp(end, "parent") == 0) {
        *link = u->links;
        u->link[u->links++] = (struct urdf_link){.name = "world", .above = -1, .body = -1};
    }
    return *link >= 0 || urdf_refuse(u, at, "joint %.60s: there is no link called %.60s",
                                     urdf_text(joint, "name"), name);
}

static bool list_joint(struct urdf *u, const xmlNode *node, struct urdf_joint *j)
{
    *j = (struct urdf_joint){.node = node, .joint = -1};
    if (!urdf_need(u, node, "name", &j->name) || !urdf_need(u, node, "type", &j->type) ||
        !end_of(u, node, "parent", &j->parent) || !end_of(u, node, "child", &j->child))
        return false;
    const int other = urdf_find_joint(u, j->name);
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
    return u->root_link >= 0 ||
           urdf_refuse(u, u->link[0].node,
                       "every link is the child of a joint: the joints go round "
                       "in a circle, and there is no root");
}

/* Room for every <link> and <joint>, and a world. */
static bool list_tree(struct urdf *u)
{
    u->link = calloc((size_t)count_of(u->root, "link") + 1, sizeof *u->link);
    u->joint = calloc((size_t)count_of(u->root, "joint") + 1, sizeof *u->joint);
    if (!u->link || !u->joint)
        return no_memory(u->message);
    if (!list_links(u))
        return false;
    EACH_IN (child, u->root, "joint")
        if (!list_joint(u, child, &u->joint[u->joints]))
            return false;
    return find_root(u);
}

/* ---- inertia --------------------------------------------------------------------------------- */

static bool mass_of(struct urdf *u, const xmlNode *inertial, double *mass)
{
    const xmlNode *const at = urdf_child(inertial, "mass", NULL);
    if (!at)
        return urdf_refuse(u, inertial, "<inertial> has no <mass value=\"...\"/>");
    return urdf_number(u, at, mass) &&
           (*mass >= 0 || urdf_refuse(u, at, "<mass value=\"%g\">: less than nothing", *mass));
}

/* Moments in the axes of <origin>. */
static bool moments_of(struct urdf *u, const xmlNode *at, double moment[3][3])
{
    static const struct {
        const char *key;
        int i, k;
    } list[] = {{"ixx", 0, 0}, {"iyy", 1, 1}, {"izz", 2, 2},
                {"ixy", 0, 1}, {"ixz", 0, 2}, {"iyz", 1, 2}};
    for (size_t n = 0; n < sizeof list / sizeof *list; n++) {
        double value = 0;
        const char *text;
        const bool own = list[n].i == list[n].k;
        if ((own && !urdf_need(u, at, list[n].key, &text)) ||
            !urdf_numbers(u, at, list[n].key, 1, &value))
            return false;
        if (own && value < 0)
            return urdf_refuse(u, at, "<inertia %s=\"%g\">: less than nothing", list[n].key, value);
        moment[list[n].i][list[n].k] = moment[list[n].k][list[n].i] = value;
    }
    return true;
}

/* R I R'. */
static void turn_moments(double r[3][3], double moment[3][3], double out[3][3])
{
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) {
            out[i][k] = 0;
            for (int m = 0; m < 3; m++)
                for (int n = 0; n < 3; n++)
                    out[i][k] += r[i][m] * moment[m][n] * r[k][n];
        }
}

static bool inertia_of(struct urdf *u, const xmlNode *link, struct spatial_body *body)
{
    const xmlNode *const inertial = urdf_child(link, "inertial", NULL);
    const xmlNode *const at = inertial ? urdf_child(inertial, "inertia", NULL) : NULL;
    double rotation[3][3], moment[3][3] = {{0}};
    body->massless = true;
    if (!inertial)
        return true;
    if (!urdf_origin(u, inertial, body->centre, rotation) || !mass_of(u, inertial, &body->mass) ||
        (at && !moments_of(u, at, moment)))
        return false;
    body->massless = body->mass == 0;
    turn_moments(rotation, moment, body->inertia);
    if (!at && !body->massless)
        spatial_note(u->model, "link %s has no <inertia>: it is a point mass", body->name);
    return true;
}

/* ---- what may touch -------------------------------------------------------------------------- */

static bool sizes_of(struct urdf *u, const xmlNode *shape, struct spatial_geom *geom)
{
    const bool box = geom->shape == SPATIAL_BOX;
    const char *text;
    if (!urdf_need(u, shape, box ? "size" : "radius", &text) ||
        !urdf_numbers(u, shape, box ? "size" : "radius", box ? 3 : 1, geom->size))
        return false;
    if (geom->shape == SPATIAL_CYLINDER || geom->shape == SPATIAL_CAPSULE) {
        if (!urdf_need(u, shape, "length", &text) ||
            !urdf_numbers(u, shape, "length", 1, &geom->size[1]))
            return false;
        geom->size[1] /= 2;
    }
    for (int i = 0; i < 3; i++) {
        if (geom->size[i] < 0)
            return urdf_refuse(u, shape, "<%s>: a size is less than nothing", urdf_name(shape));
        if (box)
            geom->size[i] /= 2;
    }
    return true;
}

static bool shape_of(struct urdf *u, const xmlNode *collision, struct spatial_geom *geom)
{
    static const char *const words[] = {"sphere", "capsule", "cylinder", "box"};
    static const spatial_shape shapes[] = {SPATIAL_SPHERE, SPATIAL_CAPSULE, SPATIAL_CYLINDER,
                                           SPATIAL_BOX};
    const xmlNode *const geometry = urdf_child(collision, "geometry", NULL);
    const xmlNode *const shape = geometry ? urdf_child(geometry, NULL, NULL) : NULL;
    if (!shape)
        return urdf_refuse(u, collision, "<collision> has no <geometry> with a shape");
    for (size_t i = 0; i < sizeof words / sizeof *words; i++)
        if (strcmp(urdf_name(shape), words[i]) == 0) {
            geom->shape = shapes[i];
            geom->of = words[i];
            return sizes_of(u, shape, geom);
        }
    geom->shape = SPATIAL_OTHER;
    geom->of = strcmp(urdf_name(shape), "mesh") == 0 ? "mesh" : "shape that is not known";
    return true;
}

static bool geoms_of(struct urdf *u, const struct urdf_link *link)
{
    EACH_IN (child, link->node, "collision") {
        struct spatial_geom *const geom = spatial_add_geom(u->model);
        const char *const name = urdf_text(child, "name");
        if (!geom)
            return no_memory(u->message);
        name_it(geom->name, name && *name ? name : link->name);
        geom->line = urdf_line(child);
        geom->body = link->body;
        geom->friction = NAN;
        geom->meets_floor = true;
        if (!urdf_origin(u, child, geom->at, geom->rotation) || !shape_of(u, child, geom))
            return false;
    }
    return true;
}

/* ---- joints ---------------------------------------------------------------------------------- */

static struct spatial_joint *add_joint(struct urdf *u, const struct urdf_joint *of, int body,
                                       spatial_joint_kind kind)
{
    struct spatial_joint *const joint = spatial_add_joint(u->model);
    if (!joint) {
        no_memory(u->message);
        return NULL;
    }
    joint->kind = kind;
    joint->body = body;
    memcpy(joint->start_rotation, unturned, sizeof unturned);
    if (of) {
        name_it(joint->name, of->name);
        joint->line = urdf_line(of->node);
    }
    return joint;
}

static bool axis_of(struct urdf *u, const struct urdf_joint *j, double axis[3])
{
    const xmlNode *const at = urdf_child(j->node, "axis", NULL);
    axis[0] = 1;
    if (at && !urdf_numbers(u, at, "xyz", 3, axis))
        return false;
    const double length = hypot(hypot(axis[0], axis[1]), axis[2]);
    for (int i = 0; i < 3; i++)
        axis[i] /= length;
    return isfinite(axis[0] + axis[1] + axis[2]) ||
           urdf_refuse(u, at, "joint %.60s: its axis has no direction", j->name);
}

/* Exporters write lower = upper = 0 where a designer gave nothing, and others leave them out. */
static bool limits_of(struct urdf *u, const struct urdf_joint *j, struct spatial_joint *joint)
{
    const xmlNode *const at = urdf_child(j->node, "limit", NULL);
    if (!at) {
        if (!joint->continuous)
            spatial_note(u->model, "joint %s has no <limit>: it has no stops here", j->name);
        return true;
    }
    if (!urdf_numbers(u, at, "lower", 1, &joint->limits[0]) ||
        !urdf_numbers(u, at, "upper", 1, &joint->limits[1]) ||
        !urdf_numbers(u, at, "effort", 1, &joint->effort))
        return false;
    const bool given = urdf_text(at, "lower") || urdf_text(at, "upper");
    const bool any = joint->limits[0] != 0 || joint->limits[1] != 0;
    if (joint->limits[0] > joint->limits[1])
        return urdf_refuse(u, at, "joint %.60s: its lower limit %g is above its upper one, %g",
                           j->name, joint->limits[0], joint->limits[1]);
    joint->limited = any;
    if (joint->continuous && any)
        spatial_note(u->model, "joint %s is continuous, and its limits are kept", j->name);
    else if (given && !any && !joint->continuous)
        spatial_note(
            u->model,
            "joint %s: lower = upper = 0 is what exporters write without limits: it has no "
            "stops here (if it is not to move: --weld %s)",
            j->name, j->name);
    else if (!any && !joint->continuous)
        spatial_note(u->model, "joint %s has neither lower nor upper limit: it has no stops here",
                     j->name);
    return true;
}

/* URDF begins where all coordinates are 0, or at the stop that is nearest to that. */
static void begin(struct urdf *u, struct spatial_joint *joint)
{
    if (joint->limited)
        joint->start = fmin(fmax(0, joint->limits[0]), joint->limits[1]);
    if (joint->start != 0)
        spatial_note(u->model, "joint %s begins at its stop, %g: 0 is beyond it", joint->name,
                     joint->start);
}

static bool one_way(struct urdf *u, struct urdf_joint *j, int body, spatial_joint_kind kind)
{
    struct spatial_joint *const joint = add_joint(u, j, body, kind);
    const xmlNode *const dynamics = urdf_child(j->node, "dynamics", NULL);
    if (!joint)
        return false;
    j->joint = (int)(joint - u->model->joint);
    joint->continuous = strcmp(j->type, "continuous") == 0;
    if (!axis_of(u, j, joint->axis) || !limits_of(u, j, joint) ||
        (dynamics && (!urdf_numbers(u, dynamics, "damping", 1, &joint->damping) ||
                      !urdf_numbers(u, dynamics, "friction", 1, &joint->friction))))
        return false;
    if (joint->damping < 0 || joint->friction < 0)
        return urdf_refuse(u, dynamics, "joint %.60s: its damping or friction is less than nothing",
                           j->name);
    begin(u, joint);
    return true;
}

/* Two slides at right angles to each other and to the normal, then the hinge about it. */
static bool planar(struct urdf *u, struct urdf_joint *j, int body)
{
    double n[3] = {0}, a[3] = {0}, b[3], length = 0;
    int least = 0;
    if (!axis_of(u, j, n))
        return false;
    for (int i = 1; i < 3; i++)
        least = fabs(n[i]) < fabs(n[least]) ? i : least;
    for (int i = 0; i < 3; i++)
        a[i] = (i == least) - n[least] * n[i];
    length = hypot(hypot(a[0], a[1]), a[2]);
    for (int i = 0; i < 3; i++)
        a[i] /= length;
    for (int i = 0; i < 3; i++)
        b[i] = n[(i + 1) % 3] * a[(i + 2) % 3] - n[(i + 2) % 3] * a[(i + 1) % 3];
    const double *const axes[] = {a, b, n};
    static const char *const suffix[] = {"_a", "_b", ""};
    for (int i = 0; i < 3; i++) {
        struct spatial_joint *const joint =
            add_joint(u, j, body, i < 2 ? SPATIAL_SLIDE : SPATIAL_HINGE);
        if (!joint)
            return false;
        add_text(joint->name, sizeof joint->name, "%s", suffix[i]);
        memcpy(joint->axis, axes[i], sizeof joint->axis);
    }
    j->joint = u->model->joints - 1;
    return true;
}

static bool floating(struct urdf *u, const struct urdf_joint *j, int body)
{
    const struct spatial_body *const b = &u->model->body[body];
    if (b->parent >= 0)
        return urdf_refuse(
            u, j->node,
            "joint %.60s is floating, but its parent %.60s is not the world: two robots", j->name,
            u->link[j->parent].name);
    struct spatial_joint *const joint = add_joint(u, j, body, SPATIAL_FREE);
    if (!joint)
        return false;
    memcpy(joint->start_place, b->at, sizeof b->at);
    memcpy(joint->start_rotation, b->rotation, sizeof b->rotation);
    return true;
}

static bool mimic(struct urdf *u, const struct urdf_joint *j)
{
    const xmlNode *const at = urdf_child(j->node, "mimic", NULL);
    struct spatial_alien *const alien = at ? spatial_add_alien(u->model) : NULL;
    if (at && !alien)
        return no_memory(u->message);
    if (alien) {
        alien->what = SPATIAL_MIMIC;
        name_it(alien->name, j->name);
        alien->line = urdf_line(at);
    }
    return true;
}

static bool joint_of(struct urdf *u, struct urdf_joint *j, int body)
{
    if (strcmp(j->type, "fixed") == 0)
        return true;
    if (strcmp(j->type, "revolute") == 0 || strcmp(j->type, "continuous") == 0)
        return one_way(u, j, body, SPATIAL_HINGE) && mimic(u, j);
    if (strcmp(j->type, "prismatic") == 0)
        return one_way(u, j, body, SPATIAL_SLIDE) && mimic(u, j);
    if (strcmp(j->type, "planar") == 0)
        return planar(u, j, body);
    if (strcmp(j->type, "floating") == 0)
        return floating(u, j, body);
    return urdf_refuse(u, j->node,
                       "joint %.60s: type \"%.30s\" is none of fixed, revolute, continuous, "
                       "prismatic, planar, floating",
                       j->name, j->type);
}

/* ---- links ----------------------------------------------------------------------------------- */

/* Whether a link with a mass is rigid with the root, and so gives it one. */
static bool weighs_on_root(const struct urdf *u, int link)
{
    const xmlNode *const inertial =
        u->link[link].node ? urdf_child(u->link[link].node, "inertial", NULL) : NULL;
    const xmlNode *const mass = inertial ? urdf_child(inertial, "mass", NULL) : NULL;
    char text[SPATIAL_NAME];
    int above;
    if (!mass || !urdf_value(mass, text) || strtod(text, NULL) == 0)
        return false;
    for (int steps = 0; (above = u->link[link].above) >= 0 && steps < u->links; steps++) {
        if (strcmp(u->joint[above].type, "fixed") != 0)
            return false;
        link = u->joint[above].parent;
    }
    return link == u->root_link;
}

static bool is_world(const struct urdf *u)
{
    const char *const name = u->link[u->root_link].name;
    if (strcmp(name, "world") == 0)
        return true;
    for (int i = 0; i < u->links; i++)
        if (weighs_on_root(u, i))
            return false;
    spatial_note(u->model, "root %s, and what is fixed to it, has no mass: it is the world", name);
    return true;
}

/* A link as a body, under the joint above it. */
static bool take_link(struct urdf *u, struct urdf_link *link)
{
    struct urdf_joint *const above = link->above >= 0 ? &u->joint[link->above] : NULL;
    struct spatial_body *const body = spatial_add_body(u->model);
    if (!body)
        return no_memory(u->message);
    link->body = u->model->bodies - 1;
    name_it(body->name, link->name);
    body->line = urdf_line(link->node);
    body->parent = above ? u->link[above->parent].body : -1;
    memcpy(body->rotation, unturned, sizeof unturned);
    if ((above && !urdf_origin(u, above->node, body->at, body->rotation)) ||
        !inertia_of(u, link->node, body))
        return false;
    return (!above || joint_of(u, above, link->body)) && geoms_of(u, link);
}

/* The first link: the world, of which no more is of interest than what may touch, or one that
 * moves freely. */
static bool take_root(struct urdf *u)
{
    struct urdf_link *const root = &u->link[u->root_link];
    root->taken = true;
    if (is_world(u))
        return !root->node || geoms_of(u, root);
    if (!take_link(u, root))
        return false;
    struct spatial_joint *const joint = add_joint(u, NULL, root->body, SPATIAL_FREE);
    if (!joint)
        return false;
    name_it(joint->name, root->name);
    joint->line = urdf_line(root->node);
    spatial_note(u->model, "root %s is free: nothing fixes it (--weld %s does)", root->name,
                 root->name);
    return true;
}

/* From the root, a leg after the other: links that wait lie on a stack, the next one on top. */
static bool take_tree(struct urdf *u)
{
    int *const stack = calloc((size_t)u->links, sizeof *stack), waiting = 0;
    bool good = stack ? take_root(u) : no_memory(u->message);
    for (int at = u->root_link; good && at >= 0; at = waiting > 0 ? stack[--waiting] : -1) {
        struct urdf_link *const link = &u->link[at];
        good = link->taken || take_link(u, link);
        link->taken = true;
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

static bool read_robot(struct urdf *u, const xmlDoc *document)
{
    const char *const slash = strrchr(u->path, '/'), *name;
    if (!check_document(u, document))
        return false;
    name = urdf_text(u->root, "name");
    u->model->format = "URDF";
    name_it(u->model->file, slash ? slash + 1 : u->path);
    name_it(u->model->title, name && *name ? name : u->model->file);
    u->model->gravity[2] = -STANCE_GRAVITY;
    if (!list_tree(u) || !take_tree(u) || !urdf_drives(u) || !urdf_extras(u))
        return false;
    if (u->turned > 0)
        spatial_note(u->model,
                     "rpy such as 1.57 are right angles as far as their digits tell, and taken as "
                     "these: %d",
                     u->turned);
    return true;
}

bool urdf_read(const char *path, struct spatial_model *model, stance_message *message)
{
    struct urdf u = {.model = model, .message = message, .path = path};
    xmlDoc *const document = parse(path, message);
    *model = (struct spatial_model){0};
    if (!document)
        return false;
    u.root = xmlDocGetRootElement(document);
    const bool good = read_robot(&u, document);
    free(u.link);
    free(u.joint);
    xmlFreeDoc(document);
    return good;
}
