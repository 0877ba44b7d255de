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
#include <errno.h>
#include <stdlib.h>

/* Why there is none. */
static bool without_library(const char *file, const stance_message *why, stance_message *message)
{
    return complain(message, "%.60s: MJCF is read by MuJoCo's own library: %.130s", file,
                    why->text);
}

#ifdef MUJOCO_HEADER

struct reading {
    const char *path;
    char *text; /* the file's, for lines */
    const struct mujoco *library;
    const mjModel *m;
    struct spatial_model *model;
};

/* ---- names and their lines ---------------------------------------------------------------------
 */

/* Does the element that the text `at` stands in have this tag? */
static bool in_element(const char *text, const char *at, const char *tag)
{
    while (at > text && *at != '<')
        at--;
    return strncmp(at + 1, tag, strlen(tag)) == 0;
}

/* Where an element of a name begins; "": any tag. 0: not in this file. */
static int line_of(const char *text, const char *tag, const char *name)
{
    char wanted[SPATIAL_NAME + 8];
    for (int quote = 0; text && name[0] && quote < 2; quote++) {
        snprintf(wanted, sizeof wanted, quote ? "name='%s'" : "name=\"%s\"", name);
        const char *at = text;
        while ((at = strstr(at, wanted)) != NULL && !in_element(text, at, tag))
            at++;
        if (!at)
            continue;
        int line = 1;
        for (const char *s = text; s < at; s++)
            line += *s == '\n';
        return line;
    }
    return 0;
}

static void take_name(const struct reading *r, int kind, int id, const char *tag,
                      char name[SPATIAL_NAME], int *line)
{
    const char *const given = r->library->mj_id2name(r->m, kind, id);
    snprintf(name, SPATIAL_NAME, "%s", given ? given : "");
    *line = line_of(r->text, tag, name);
}

/* ---- the tree ----------------------------------------------------------------------------------
 */

static bool read_body(const struct reading *r, int b)
{
    const mjModel *const m = r->m;
    struct spatial_body *const body = spatial_add_body(r->model);
    double axes[3][3];
    if (!body)
        return false;
    take_name(r, mjOBJ_BODY, b, "body", body->name, &body->line);
    body->parent = m->body_parentid[b] - 1;
    memcpy(body->at, &m->body_pos[3 * b], sizeof body->at);
    space_of_quaternion(&m->body_quat[4 * b], body->rotation);
    body->mass = m->body_mass[b];
    body->massless = !(body->mass > 0);
    memcpy(body->centre, &m->body_ipos[3 * b], sizeof body->centre);
    space_of_quaternion(&m->body_iquat[4 * b], axes);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            for (int k = 0; k < 3; k++)
                body->inertia[i][j] += axes[i][k] * m->body_inertia[3 * b + k] * axes[j][k];
    if (m->body_mocapid[b] >= 0)
        spatial_note(r->model, "body %s is moved by hand in MuJoCo (mocap): it stands still here",
                     body->name);
    return true;
}

/* The initial place of a joint: of the first keyframe, else that in which bodies are given. */
static void take_start(const mjModel *m, struct spatial_joint *joint, int j)
{
    const mjtNum *const q = (m->nkey > 0 ? m->key_qpos : m->qpos0) + m->jnt_qposadr[j];
    joint->start = q[0];
    if (joint->kind != SPATIAL_FREE)
        return;
    memcpy(joint->start_place, q, sizeof joint->start_place);
    const double length = sqrt(q[3] * q[3] + q[4] * q[4] + q[5] * q[5] + q[6] * q[6]);
    double unit[4] = {1};
    for (int i = 0; length > 0 && i < 4; i++)
        unit[i] = q[3 + i] / length;
    space_of_quaternion(unit, joint->start_rotation);
}

static bool read_joint(const struct reading *r, int j)
{
    static const spatial_joint_kind kinds[] = {[mjJNT_FREE] = SPATIAL_FREE,
                                               [mjJNT_BALL] = SPATIAL_BALL,
                                               [mjJNT_SLIDE] = SPATIAL_SLIDE,
                                               [mjJNT_HINGE] = SPATIAL_HINGE};
    const mjModel *const m = r->m;
    const int q = m->jnt_qposadr[j], dof = m->jnt_dofadr[j];
    const bool passive = !(m->opt.disableflags & mjDSBL_PASSIVE);
    struct spatial_joint *const joint = spatial_add_joint(r->model);
    if (!joint)
        return false;
    take_name(r, mjOBJ_JOINT, j, "", joint->name, &joint->line);
    joint->body = m->jnt_bodyid[j] - 1;
    joint->kind = kinds[m->jnt_type[j]];
    memcpy(joint->axis, &m->jnt_axis[3 * j], sizeof joint->axis);
    memcpy(joint->at, &m->jnt_pos[3 * j], sizeof joint->at);
    joint->limited =
        m->jnt_limited[j] && !(m->opt.disableflags & (mjDSBL_LIMIT | mjDSBL_CONSTRAINT));
    memcpy(joint->limits, &m->jnt_range[2 * j], sizeof joint->limits);
    joint->soft = joint->limited;
    joint->damping = passive ? m->dof_damping[dof] : 0;
    joint->stiffness = passive ? m->jnt_stiffness[j] : 0;
    joint->armature = m->dof_armature[dof];
    joint->friction = m->opt.disableflags & mjDSBL_FRICTIONLOSS ? 0 : m->dof_frictionloss[dof];
    take_start(m, joint, j);
    if (joint->kind != SPATIAL_HINGE && joint->kind != SPATIAL_SLIDE)
        return true;
    joint->reference = m->qpos0[q];
    joint->spring_reference = m->qpos_spring[q];
    return true;
}

/* ---- what may touch ----------------------------------------------------------------------------
 */

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

static bool is_excluded(const mjModel *m, int a, int b)
{
    const int low = a < b ? a : b, high = a < b ? b : a;
    for (int e = 0; e < m->nexclude; e++)
        if (m->exclude_signature[e] == ((low + 1) << 16) + high + 1)
            return true;
    return false;
}

static bool no_contacts(const mjModel *m)
{
    return (m->opt.disableflags & (mjDSBL_CONTACT | mjDSBL_CONSTRAINT)) != 0;
}

/* Two geoms of bodies that are not one, nor parent and child (but for the world's children). */
static bool may_touch(const mjModel *m, int g, int h)
{
    const int a = m->geom_bodyid[g], b = m->geom_bodyid[h];
    const int weld_a = m->body_weldid[a], weld_b = m->body_weldid[b];
    if (find_pair(m, g, h) >= 0)
        return true;
    if (m->opt.collision == mjCOL_PAIR || weld_a == weld_b || is_excluded(m, a, b))
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

static bool has_floor(const mjModel *m)
{
    for (int h = 0; h < m->ngeom; h++)
        if (is_static(m, h) && m->geom_type[h] == mjGEOM_PLANE &&
            (m->geom_contype[h] || m->geom_conaffinity[h]))
            return true;
    return false;
}

/* Of a geom against the floor, as MuJoCo mixes it. */
static double friction_against(const mjModel *m, int g, int h)
{
    const int pair = h < 0 ? -1 : find_pair(m, g, h);
    if (pair >= 0)
        return m->pair_dim[pair] > 1 ? m->pair_friction[5 * pair] : 0;
    const int first = h < 0 || m->geom_priority[g] >= m->geom_priority[h] ? g : h;
    const bool both = h >= 0 && m->geom_priority[g] == m->geom_priority[h];
    double friction = m->geom_friction[3 * first];
    int dimensions = m->geom_condim[first];
    if (both) {
        friction = fmax(friction, m->geom_friction[3 * h]);
        dimensions = dimensions > m->geom_condim[h] ? dimensions : m->geom_condim[h];
    }
    return dimensions > 1 ? friction : 0;
}

static void take_shape(const mjModel *m, struct spatial_geom *geom, int g)
{
    static const struct {
        int type;
        spatial_shape shape;
        const char *of;
    } shapes[] = {
        {mjGEOM_PLANE, SPATIAL_PLANE, "plane"},
        {mjGEOM_SPHERE, SPATIAL_SPHERE, "sphere"},
        {mjGEOM_CAPSULE, SPATIAL_CAPSULE, "capsule"},
        {mjGEOM_BOX, SPATIAL_BOX, "box"},
        {mjGEOM_CYLINDER, SPATIAL_CYLINDER, "cylinder"},
        {mjGEOM_HFIELD, SPATIAL_OTHER, "height field"},
        {mjGEOM_ELLIPSOID, SPATIAL_OTHER, "ellipsoid"},
        {mjGEOM_MESH, SPATIAL_OTHER, "mesh"},
    };
    geom->shape = SPATIAL_OTHER;
    geom->of = "shape";
    for (size_t i = 0; i < sizeof shapes / sizeof *shapes; i++)
        if (shapes[i].type == m->geom_type[g]) {
            geom->shape = shapes[i].shape;
            geom->of = shapes[i].of;
        }
    memcpy(geom->at, &m->geom_pos[3 * g], sizeof geom->at);
    space_of_quaternion(&m->geom_quat[4 * g], geom->rotation);
    memcpy(geom->size, &m->geom_size[3 * g], sizeof geom->size);
}

static bool meets_another(const mjModel *m, int g)
{
    for (int h = 0; h < m->ngeom; h++)
        if (!is_static(m, h) && may_touch(m, g, h))
            return true;
    return false;
}

/* Those that touch nothing are only drawn. Without a floor those that would touch one do. */
static bool read_geom(const struct reading *r, int g, bool floor)
{
    const mjModel *const m = r->m;
    const bool world = is_static(m, g), solid = m->geom_contype[g] || m->geom_conaffinity[g];
    const int under = world || !floor ? -1 : floor_of(m, g);
    const bool meets = world ? solid : floor ? under >= 0 : solid;
    const bool other = !world && meets_another(m, g);
    if (!meets && !other)
        return true;
    struct spatial_geom *const geom = spatial_add_geom(r->model);
    if (!geom)
        return false;
    take_name(r, mjOBJ_GEOM, g, "geom", geom->name, &geom->line);
    geom->body = m->geom_bodyid[g] - 1;
    take_shape(m, geom, g);
    geom->meets_floor = meets;
    geom->meets_robot = other;
    geom->friction = world && floor ? NAN : friction_against(m, g, under);
    return true;
}

/* ---- what drives -------------------------------------------------------------------------------
 */

static void of_either_sign(double gear, double least, double most, struct spatial_actuator *to)
{
    to->least = fmin(gear * least, gear * most);
    to->most = fmax(gear * least, gear * most);
}

/* force = gain control + bias, then its range, then the gear. */
static void take_motor(const mjModel *m, struct spatial_actuator *actuator, int a)
{
    const double gain = m->actuator_gainprm[mjNGAIN * a];
    const bool clamped = m->actuator_ctrllimited[a] && !(m->opt.disableflags & mjDSBL_CLAMPCTRL);
    const double *const control = &m->actuator_ctrlrange[2 * a];
    double least = -INFINITY, most = INFINITY;
    if (actuator->drive == SPATIAL_MOTOR && clamped) {
        least = fmin(gain * control[0], gain * control[1]);
        most = fmax(gain * control[0], gain * control[1]);
    }
    if (m->actuator_forcelimited[a]) {
        least = fmax(least, m->actuator_forcerange[2 * a]);
        most = fmin(most, m->actuator_forcerange[2 * a + 1]);
    }
    actuator->limited = isfinite(least) || isfinite(most);
    actuator->least = -INFINITY;
    actuator->most = INFINITY;
    if (actuator->limited)
        of_either_sign(actuator->gear, least, most, actuator);
}

/* Which of MuJoCo's short names has these numbers. */
static void take_drive(const mjModel *m, struct spatial_actuator *actuator, int a)
{
    const double *const gain = &m->actuator_gainprm[mjNGAIN * a],
                        *const bias = &m->actuator_biasprm[mjNBIAS * a];
    const double squared = actuator->gear * actuator->gear;
    actuator->drive = SPATIAL_GENERAL;
    if (actuator->joint < 0 || m->actuator_dyntype[a] != mjDYN_NONE ||
        m->actuator_gaintype[a] != mjGAIN_FIXED)
        return;
    const bool none =
        m->actuator_biastype[a] == mjBIAS_NONE || (bias[0] == 0 && bias[1] == 0 && bias[2] == 0);
    if (none) {
        actuator->drive = SPATIAL_MOTOR;
    } else if (m->actuator_biastype[a] == mjBIAS_AFFINE && bias[0] == 0 && gain[0] > 0 &&
               (bias[1] == -gain[0] || (bias[1] == 0 && bias[2] == -gain[0]))) {
        actuator->drive = bias[1] == 0 ? SPATIAL_VELOCITY : SPATIAL_POSITION;
        actuator->kp = 0 - bias[1] * squared;
        actuator->kd = 0 - bias[2] * squared;
    }
}

static bool read_actuator(const struct reading *r, int a)
{
    static const int kinds[] = {
        [mjTRN_JOINT] = mjOBJ_JOINT,      [mjTRN_JOINTINPARENT] = mjOBJ_JOINT,
        [mjTRN_SLIDERCRANK] = mjOBJ_SITE, [mjTRN_TENDON] = mjOBJ_TENDON,
        [mjTRN_SITE] = mjOBJ_SITE,        [mjTRN_BODY] = mjOBJ_BODY};
    const mjModel *const m = r->m;
    const int type = m->actuator_trntype[a];
    struct spatial_actuator *const actuator = spatial_add_actuator(r->model);
    if (!actuator)
        return false;
    take_name(r, mjOBJ_ACTUATOR, a, "", actuator->name, &actuator->line);
    actuator->joint =
        type == mjTRN_JOINT || type == mjTRN_JOINTINPARENT ? m->actuator_trnid[2 * a] : -1;
    if (type >= 0 && type <= mjTRN_BODY) {
        const char *const target = r->library->mj_id2name(m, kinds[type], m->actuator_trnid[2 * a]);
        snprintf(actuator->target, sizeof actuator->target, "%s", target ? target : "");
    }
    actuator->gear = m->actuator_gear[6 * a];
    take_drive(m, actuator, a);
    take_motor(m, actuator, a);
    return true;
}

/* ---- what has no counterpart -------------------------------------------------------------------
 */

static bool add_alien(const struct reading *r, const char *what, int kind, int id, bool harmless)
{
    struct spatial_alien *const alien = spatial_add_alien(r->model);
    if (!alien)
        return false;
    alien->what = what;
    alien->harmless = harmless;
    take_name(r, kind, id, "", alien->name, &alien->line);
    return true;
}

static bool read_aliens(const struct reading *r)
{
    static const char *const ties[] = {[mjEQ_CONNECT] = "loop (equality connect)",
                                       [mjEQ_WELD] = "loop (equality weld)",
                                       [mjEQ_JOINT] = "coupling of joints (equality joint)",
                                       [mjEQ_TENDON] = "coupling of tendons (equality tendon)",
                                       [mjEQ_DISTANCE] = "distance (equality distance)"};
    const mjModel *const m = r->m;
    bool good = true;
    for (int e = 0; good && e < m->neq; e++)
        good = add_alien(r, ties[m->eq_type[e]], mjOBJ_EQUALITY, e,
                         !m->eq_active[e] || (m->opt.disableflags & mjDSBL_EQUALITY) != 0);
    for (int t = 0; good && t < m->ntendon; t++)
        good = add_alien(r, "tendon", mjOBJ_TENDON, t,
                         m->tendon_stiffness[t] == 0 && m->tendon_damping[t] == 0 &&
                             !m->tendon_limited[t] && m->tendon_frictionloss[t] == 0);
    for (int s = 0; good && s < m->nskin; s++)
        good = add_alien(r, "skin", mjOBJ_SKIN, s, true);
    if (no_contacts(m))
        spatial_note(r->model, "contacts are disabled in the file: nothing touches the ground");
    if (m->opt.density != 0 || m->opt.viscosity != 0)
        spatial_note(r->model,
                     "the medium (density, viscosity) is left out: it has no counterpart");
    return good;
}

/* ---- the file ----------------------------------------------------------------------------------
 */

static bool read_model(const struct reading *r)
{
    const mjModel *const m = r->m;
    struct spatial_model *const model = r->model;
    const bool floor = has_floor(m);
    bool good = true;
    if (strcmp(m->names, "MuJoCo Model") != 0) /* which has no name */
        snprintf(model->title, sizeof model->title, "%s", m->names);
    if (!(m->opt.disableflags & mjDSBL_GRAVITY))
        memcpy(model->gravity, m->opt.gravity, sizeof model->gravity);
    model->step = m->opt.timestep;
    model->has_keyframe = m->nkey > 0;
    for (int b = 1; good && b < m->nbody; b++)
        good = read_body(r, b);
    for (int j = 0; good && j < m->njnt; j++)
        good = read_joint(r, j);
    for (int g = 0; good && g < m->ngeom && !no_contacts(m); g++)
        good = read_geom(r, g, floor);
    for (int a = 0; good && a < m->nu; a++)
        good = read_actuator(r, a);
    return good && read_aliens(r);
}

/* Its text with an end; NULL: `message`. */
static char *text_of(const char *path, stance_message *message)
{
    FILE *const in = fopen(path, "rb");
    char *text = NULL;
    size_t size = 0;
    errno = 0;
    const bool read = in && getdelim(&text, &size, -1, in) > 0;
    const int error = errno;
    if (in)
        fclose(in);
    if (read)
        return text;
    free(text);
    complain(message, "%.150s: %s", path, error ? strerror(error) : "the file is empty");
    return NULL;
}

/* MuJoCo's own, of several lines and with the line of the element where it knows one. */
static bool refuse_as_mujoco(const char *file, const char *error, stance_message *message)
{
    int number = 0;
    for (const char *at = error; number == 0 && (at = strcasestr(at, "line")) != NULL; at++)
        number = atoi(at + strcspn(at, "0123456789"));
    complain(message,
             number > 0 ? "%.80s:%d: MuJoCo cannot read it: " : "%.80s: MuJoCo cannot read it: ",
             file, number);
    size_t n = strlen(message->text);
    for (const char *s = error; *s && n + 1 < sizeof message->text; s++)
        if (!isspace((unsigned char)*s) && !iscntrl((unsigned char)*s))
            message->text[n++] = *s;
        else if (s > error && s[1] && message->text[n - 1] != ' ')
            message->text[n++] = ' ';
    message->text[n] = 0;
    return false;
}

bool mjcf_read(const char *path, struct spatial_model *model, stance_message *message)
{
    struct mujoco library;
    struct reading r = {.path = path, .library = &library, .model = model};
    char error[1000] = "no memory";
    const char *const slash = strrchr(path, '/');
    model->format = "MJCF";
    snprintf(model->file, sizeof model->file, "%s", slash ? slash + 1 : path);
    r.text = text_of(path, message);
    if (!r.text)
        return false;
    stance_message why;
    bool good = mujoco_open(&library, &why) || without_library(model->file, &why, message);
    if (good) {
        sandbox_limit(true);
        mjModel *const m = mujoco_load(&library, path, error, sizeof error);
        sandbox_limit(false);
        r.m = m;
        good = m ? read_model(&r) || no_memory(message)
                 : refuse_as_mujoco(model->file, error, message);
        if (m)
            library.mj_deleteModel(m);
        mujoco_close(&library);
    }
    free(r.text);
    return good;
}

#else

bool mjcf_read(const char *path, struct spatial_model *model, stance_message *message)
{
    struct mujoco none;
    stance_message why;
    model->format = "MJCF";
    return mujoco_open(&none, &why) || without_library(path, &why, message);
}

#endif
