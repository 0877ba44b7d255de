/* mjcf_read.c - a file of MuJoCo's as MuJoCo's own compiler makes a model of it.
 *
 * Includes, classes, units, moments from geoms, global coordinates: all that is the library's
 * business. Bodies (but for the world), joints and actuators keep the compiler's order. It does not
 * tell lines; where a name stands in the file itself its line is looked for.
 */
#include "mujoco_library.h"
#include "space.h"
#include "spatial.h"

#include "runner/base/message.h"
#include "runner/base/sandbox.h"

#include <ctype.h>
#include <libxml/parser.h>
#include <stdlib.h>

#ifdef MUJOCO_HEADER

struct reading {
    const xmlDoc *text; /* the file's, for lines */
    const struct mujoco *library;
    const mjModel *m;
    struct spatial_model *model;
};

/* Where the first element of a name stands whose tag has `tag` in it; 0: not in this file. */
static int line_of(const xmlNode *node, const char *tag, const char *name)
{
    int line = 0;
    for (; node && line == 0; node = node->next) {
        xmlChar *const own = xmlGetNoNsProp(node, (const xmlChar *)"name");
        if (own && strcmp((const char *)own, name) == 0 && strstr((const char *)node->name, tag))
            line = (int)xmlGetLineNo(node);
        else if (node->type == XML_ELEMENT_NODE)
            line = line_of(node->children, tag, name);
        xmlFree(own);
    }
    return line;
}

static void take_name(const struct reading *r, int kind, int id, const char *tag,
                      char name[SPATIAL_NAME], int *line)
{
    spatial_name(name, r->library->mj_id2name(r->m, kind, id));
    *line = name[0] && r->text ? line_of(r->text->children, tag, name) : 0;
}

/* ---- the tree ------------------------------------------------------------------------------- */

static void read_body(const struct reading *r, int b)
{
    const mjModel *const m = r->m;
    struct spatial_body *const body = spatial_add(r->model, body, bodies);
    double axes[3][3];
    take_name(r, mjOBJ_BODY, b, "body", body->name, &body->line);
    mujoco_body(m, b, body, false);
    body->parent = m->body_parentid[b] - 1;
    space_of_quaternion(&m->body_quat[4 * b], body->rotation);
    space_of_quaternion(&m->body_iquat[4 * b], axes);
    space_turn_moments(axes,
                       (const double[3][3]){{m->body_inertia[3 * b]},
                                            {0, m->body_inertia[3 * b + 1]},
                                            {0, 0, m->body_inertia[3 * b + 2]}},
                       body->inertia);
    if (m->body_mocapid[b] >= 0)
        spatial_note(r->model, "body %s is moved by hand in MuJoCo (mocap): it stands still here",
                     body->name);
}

static void read_joint(const struct reading *r, int j)
{
    static const spatial_joint_kind kinds[] = {[mjJNT_FREE] = SPATIAL_FREE,
                                               [mjJNT_BALL] = SPATIAL_BALL,
                                               [mjJNT_SLIDE] = SPATIAL_SLIDE,
                                               [mjJNT_HINGE] = SPATIAL_HINGE};
    const mjModel *const m = r->m;
    const int off = m->opt.disableflags;
    /* It begins as the first keyframe has it, else as bodies are given. */
    const mjtNum *const q = (m->nkey > 0 ? m->key_qpos : m->qpos0) + m->jnt_qposadr[j];
    struct spatial_joint *const joint = spatial_add(r->model, joint, joints);
    take_name(r, mjOBJ_JOINT, j, "", joint->name, &joint->line);
    mujoco_joint(m, j, joint, false);
    joint->body = m->jnt_bodyid[j] - 1;
    joint->kind = kinds[m->jnt_type[j]];
    joint->soft = joint->limited = m->jnt_limited[j] && !(off & (mjDSBL_LIMIT | mjDSBL_CONSTRAINT));
    if (off & mjDSBL_PASSIVE)
        joint->damping = joint->stiffness = 0;
    joint->friction = off & mjDSBL_FRICTIONLOSS ? 0 : m->dof_frictionloss[m->jnt_dofadr[j]];
    joint->start = q[0];
    if (joint->kind == SPATIAL_FREE) {
        const double length = sqrt(q[3] * q[3] + q[4] * q[4] + q[5] * q[5] + q[6] * q[6]);
        double unit[4] = {1};
        for (int i = 0; length > 0 && i < 4; i++)
            unit[i] = q[3 + i] / length;
        memcpy(joint->start_place, q, sizeof joint->start_place);
        space_of_quaternion(unit, joint->start_rotation);
    }
}

/* ---- what may touch ------------------------------------------------------------------------- */

static bool is_static(const mjModel *m, int g)
{
    return m->body_weldid[m->geom_bodyid[g]] == 0;
}

/* The pair that names both; -1: none does. */
static int find_pair(const mjModel *m, int g, int h)
{
    for (int p = 0; p < m->npair; p++)
        if ((m->pair_geom1[p] == g && m->pair_geom2[p] == h) ||
            (m->pair_geom1[p] == h && m->pair_geom2[p] == g))
            return p;
    return -1;
}

/* Two geoms of bodies that are not one, nor parent and child (but for the world's children). */
static bool may_touch(const mjModel *m, int g, int h)
{
    const int a = m->geom_bodyid[g], b = m->geom_bodyid[h];
    const int weld_a = m->body_weldid[a], weld_b = m->body_weldid[b];
    if (find_pair(m, g, h) >= 0)
        return true;
    if (m->opt.collision == mjCOL_PAIR || weld_a == weld_b)
        return false;
    for (int e = 0; e < m->nexclude; e++)
        if (m->exclude_signature[e] == (((a < b ? a : b) + 1) << 16) + (a < b ? b : a) + 1)
            return false;
    if (weld_a != 0 && weld_b != 0 && !(m->opt.disableflags & mjDSBL_FILTERPARENT) &&
        (m->body_weldid[m->body_parentid[weld_a]] == weld_b ||
         m->body_weldid[m->body_parentid[weld_b]] == weld_a))
        return false;
    return (m->geom_contype[g] & m->geom_conaffinity[h]) ||
           (m->geom_contype[h] & m->geom_conaffinity[g]);
}

/* The static plane that a geom may touch; -1: none. */
static int floor_of(const mjModel *m, int g)
{
    for (int h = 0; h < m->ngeom; h++)
        if (is_static(m, h) && m->geom_type[h] == mjGEOM_PLANE && may_touch(m, g, h))
            return h;
    return -1;
}

/* Of a geom against the floor, as MuJoCo mixes it. */
static double friction_against(const mjModel *m, int g, int h)
{
    const int pair = h < 0 ? -1 : find_pair(m, g, h);
    if (pair >= 0)
        return m->pair_dim[pair] > 1 ? m->pair_friction[5 * pair] : 0;
    const int priority = h < 0 ? 1 : m->geom_priority[g] - m->geom_priority[h];
    const bool ours = priority >= 0, theirs = priority <= 0;
    const double friction =
        fmax(ours ? m->geom_friction[3 * g] : 0, theirs ? m->geom_friction[3 * h] : 0);
    return (ours && m->geom_condim[g] > 1) || (theirs && m->geom_condim[h] > 1) ? friction : 0;
}

/* Those that touch nothing are only drawn. Without a floor those that would touch one do. */
static void read_geom(const struct reading *r, int g, bool floor)
{
    static const struct {
        spatial_shape shape;
        const char *of;
    } shapes[] = {
        [mjGEOM_PLANE] = {SPATIAL_PLANE, "plane"},
        [mjGEOM_HFIELD] = {SPATIAL_OTHER, "height field"},
        [mjGEOM_SPHERE] = {SPATIAL_SPHERE, "sphere"},
        [mjGEOM_CAPSULE] = {SPATIAL_CAPSULE, "capsule"},
        [mjGEOM_ELLIPSOID] = {SPATIAL_OTHER, "ellipsoid"},
        [mjGEOM_CYLINDER] = {SPATIAL_CYLINDER, "cylinder"},
        [mjGEOM_BOX] = {SPATIAL_BOX, "box"},
        [mjGEOM_MESH] = {SPATIAL_OTHER, "mesh"},
    };
    const mjModel *const m = r->m;
    const bool world = is_static(m, g), solid = m->geom_contype[g] || m->geom_conaffinity[g];
    const int under = world || !floor ? -1 : floor_of(m, g);
    const bool meets = world || !floor ? solid : under >= 0;
    bool other = false;
    for (int h = 0; !world && h < m->ngeom; h++)
        other = other || (!is_static(m, h) && may_touch(m, g, h));
    if (!meets && !other)
        return;
    struct spatial_geom *const geom = spatial_add(r->model, geom, geoms);
    take_name(r, mjOBJ_GEOM, g, "geom", geom->name, &geom->line);
    geom->body = m->geom_bodyid[g] - 1;
    geom->shape = shapes[m->geom_type[g]].shape;
    geom->of = shapes[m->geom_type[g]].of;
    memcpy(geom->at, &m->geom_pos[3 * g], sizeof geom->at);
    memcpy(geom->size, &m->geom_size[3 * g], sizeof geom->size);
    space_of_quaternion(&m->geom_quat[4 * g], geom->rotation);
    geom->meets_floor = meets;
    geom->meets_robot = other;
    geom->friction = world && floor ? NAN : friction_against(m, g, under);
}

static void read_geoms(const struct reading *r)
{
    const mjModel *const m = r->m;
    bool floor = false;
    for (int h = 0; h < m->ngeom; h++)
        floor = floor || (is_static(m, h) && m->geom_type[h] == mjGEOM_PLANE &&
                          (m->geom_contype[h] || m->geom_conaffinity[h]));
    for (int g = 0; g < m->ngeom && !(m->opt.disableflags & (mjDSBL_CONTACT | mjDSBL_CONSTRAINT));
         g++)
        read_geom(r, g, floor);
}

/* ---- what drives ---------------------------------------------------------------------------- */

/* Which of MuJoCo's short names has these numbers. */
static spatial_drive drive_of(const mjModel *m, int a)
{
    const double gain = m->actuator_gainprm[mjNGAIN * a], *const bias =
                                                              &m->actuator_biasprm[mjNBIAS * a];
    const int type = m->actuator_biastype[a], target = m->actuator_trntype[a];
    if ((target != mjTRN_JOINT && target != mjTRN_JOINTINPARENT) ||
        m->actuator_dyntype[a] != mjDYN_NONE || m->actuator_gaintype[a] != mjGAIN_FIXED)
        return SPATIAL_GENERAL;
    if (type == mjBIAS_NONE || (bias[0] == 0 && bias[1] == 0 && bias[2] == 0))
        return SPATIAL_MOTOR;
    if (type != mjBIAS_AFFINE || bias[0] != 0 || !(gain > 0))
        return SPATIAL_GENERAL;
    return bias[1] == -gain                   ? SPATIAL_POSITION
           : bias[1] == 0 && bias[2] == -gain ? SPATIAL_VELOCITY
                                              : SPATIAL_GENERAL;
}

/* force = gain control + bias, then its range, then the gear. */
static void take_range(const mjModel *m, struct spatial_actuator *actuator, int a)
{
    const double gain = m->actuator_gainprm[mjNGAIN * a], gear = m->actuator_gear[6 * a];
    const double *const control = &m->actuator_ctrlrange[2 * a], *const force =
                                                                     &m->actuator_forcerange[2 * a];
    double least = -INFINITY, most = INFINITY;
    if (actuator->drive == SPATIAL_MOTOR && m->actuator_ctrllimited[a] &&
        !(m->opt.disableflags & mjDSBL_CLAMPCTRL)) {
        least = fmin(gain * control[0], gain * control[1]);
        most = fmax(gain * control[0], gain * control[1]);
    }
    if (m->actuator_forcelimited[a]) {
        least = fmax(least, force[0]);
        most = fmin(most, force[1]);
    }
    actuator->limited = isfinite(least) || isfinite(most);
    actuator->least = actuator->limited ? fmin(gear * least, gear * most) : -INFINITY;
    actuator->most = actuator->limited ? fmax(gear * least, gear * most) : INFINITY;
}

static void read_actuator(const struct reading *r, int a)
{
    const mjModel *const m = r->m;
    const int type = m->actuator_trntype[a], of = m->actuator_trnid[2 * a];
    const bool joint = type == mjTRN_JOINT || type == mjTRN_JOINTINPARENT;
    const double gear = m->actuator_gear[6 * a], *const bias = &m->actuator_biasprm[mjNBIAS * a];
    struct spatial_actuator *const actuator = spatial_add(r->model, actuator, actuators);
    take_name(r, mjOBJ_ACTUATOR, a, "", actuator->name, &actuator->line);
    actuator->joint = joint ? of : -1;
    spatial_name(actuator->target, r->library->mj_id2name(m,
                                                          joint                  ? mjOBJ_JOINT
                                                          : type == mjTRN_TENDON ? mjOBJ_TENDON
                                                          : type == mjTRN_BODY   ? mjOBJ_BODY
                                                                                 : mjOBJ_SITE,
                                                          of));
    actuator->drive = drive_of(m, a);
    actuator->gear = gear * m->actuator_gainprm[mjNGAIN * a];
    if (actuator->drive == SPATIAL_POSITION || actuator->drive == SPATIAL_VELOCITY) {
        actuator->kp = 0 - bias[1] * gear * gear;
        actuator->kd = 0 - bias[2] * gear * gear;
    }
    take_range(m, actuator, a);
}

/* ---- what has no counterpart ---------------------------------------------------------------- */

static void add_alien(const struct reading *r, const char *what, int kind, int id, bool harmless)
{
    char name[SPATIAL_NAME];
    int line;
    take_name(r, kind, id, "", name, &line);
    spatial_add_alien(r->model, what, name, line, harmless);
}

static void read_aliens(const struct reading *r)
{
    static const char *const ties[] = {[mjEQ_CONNECT] = "loop (equality connect)",
                                       [mjEQ_WELD] = "loop (equality weld)",
                                       [mjEQ_JOINT] = "coupling of joints (equality joint)",
                                       [mjEQ_TENDON] = "coupling of tendons (equality tendon)",
                                       [mjEQ_DISTANCE] = "distance (equality distance)"};
    const mjModel *const m = r->m;
    for (int e = 0; e < m->neq; e++)
        add_alien(r, ties[m->eq_type[e]], mjOBJ_EQUALITY, e,
                  !m->eq_active[e] || (m->opt.disableflags & mjDSBL_EQUALITY) != 0);
    for (int t = 0; t < m->ntendon; t++)
        add_alien(r, "tendon", mjOBJ_TENDON, t,
                  m->tendon_stiffness[t] == 0 && m->tendon_damping[t] == 0 &&
                      !m->tendon_limited[t] && m->tendon_frictionloss[t] == 0);
    for (int s = 0; s < m->nskin; s++)
        add_alien(r, "skin", mjOBJ_SKIN, s, true);
    if (m->opt.density != 0 || m->opt.viscosity != 0)
        spatial_note(r->model,
                     "the medium (density, viscosity) is left out: it has no counterpart");
}

/* What the file turns off as a whole. */
static void read_flags(const struct reading *r)
{
    static const struct {
        int flag;
        const char *what;
    } flags[] = {{mjDSBL_CONSTRAINT, "constraints"},
                 {mjDSBL_CONTACT, "contacts"},
                 {mjDSBL_LIMIT, "limits of joints"},
                 {mjDSBL_PASSIVE, "springs and dampers"},
                 {mjDSBL_GRAVITY, "gravity"}};
    for (size_t i = 0; i < sizeof flags / sizeof *flags; i++)
        if (r->m->opt.disableflags & flags[i].flag)
            spatial_note_of(r->model, "disabled in the file, and left out", flags[i].what);
    if (r->m->opt.disableflags & mjDSBL_ACTUATION)
        spatial_note(r->model, "actuation is disabled in the file: here its motors drive");
}

/* ---- the file ------------------------------------------------------------------------------- */

static void read_model(const struct reading *r)
{
    const mjModel *const m = r->m;
    struct spatial_model *const model = r->model;
    if (strcmp(m->names, "MuJoCo Model") != 0) /* which has no name */
        spatial_name(model->title, m->names);
    if (!(m->opt.disableflags & mjDSBL_GRAVITY))
        memcpy(model->gravity, m->opt.gravity, sizeof model->gravity);
    model->step = m->opt.timestep;
    for (int b = 1; b < m->nbody; b++)
        read_body(r, b);
    for (int j = 0; j < m->njnt; j++)
        read_joint(r, j);
    for (int a = 0; a < m->nu; a++)
        read_actuator(r, a);
    read_geoms(r);
    read_aliens(r);
    read_flags(r);
}

/* MuJoCo's own, of several lines and with the line of the element where it knows one. */
static bool refuse_as_mujoco(const struct spatial_model *model, const char *error,
                             spatial_message *message)
{
    int number = 0;
    for (const char *at = error; number == 0 && (at = strcasestr(at, "line")) != NULL; at++)
        number = atoi(at + strcspn(at, "0123456789"));
    spatial_say(model, message, number, "MuJoCo cannot read it: ");
    size_t n = strlen(message->text);
    for (const char *s = error; *s && n + 1 < sizeof message->text; s++)
        if (!isspace((unsigned char)*s) && !iscntrl((unsigned char)*s))
            message->text[n++] = *s;
        else if (s > error && s[1] && message->text[n - 1] != ' ')
            message->text[n++] = ' ';
    message->text[n] = 0;
    char *const nowhere = strstr(message->text, ", line 0");
    if (nowhere &&
        !isdigit((unsigned char)nowhere[8])) /* it counts lines of the file itself only */
        snprintf(nowhere, 40, ", in a file that it includes");
    if (strstr(error, "unrecognized"))
        add_text(message->text, sizeof message->text,
                 ": this is MuJoCo 2.2; take out what is newer");
    return false;
}

static bool load(const struct mujoco *library, const char *path, struct spatial_model *model,
                 spatial_message *message)
{
    char error[1000] = "no memory";
    sandbox_limit(true);
    mjModel *const m = mujoco_load(library, path, error, sizeof error);
    sandbox_limit(false);
    if (!m)
        return refuse_as_mujoco(model, error, message);
    xmlDoc *const text = xmlReadFile(path, NULL,
                                     XML_PARSE_NONET | XML_PARSE_NOERROR | XML_PARSE_NOWARNING |
                                         XML_PARSE_RECOVER | XML_PARSE_BIG_LINES);
    read_model(&(struct reading){.text = text, .library = library, .m = m, .model = model});
    xmlFreeDoc(text);
    library->mj_deleteModel(m);
    return true;
}

#endif

bool mjcf_read(const char *path, struct spatial_model *model, spatial_message *message)
{
    struct mujoco library;
    spatial_message why;
    bool good = false;
    spatial_begin(model, path, "MJCF");
    if (!mujoco_open(&library, &why))
        return spatial_refuse(model, message, 0, "MJCF is read by MuJoCo's own library: %.130s",
                              why.text);
#ifdef MUJOCO_HEADER
    good = load(&library, path, model, message);
    mujoco_close(&library);
#endif
    return good;
}
