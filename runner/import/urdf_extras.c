/* urdf_extras.c - what a URDF says beside its tree: what drives joints, and the elements that
 * Gazebo, Drake, Bullet and others add.
 *
 * Every one of them that changes how the robot moves is taken up or refused; the rest is named in a
 * note. Elements of a prefix that nobody declared (`drake:`) are known by the name behind it.
 */
#include "urdf.h"

#include <math.h>
#include <stdlib.h>

/* ---- what drives joints ---------------------------------------------------------------------- */

static bool add_motor(struct urdf *u, const xmlNode *at, const char *name, int joint, double gear)
{
    const struct urdf_joint *const j = &u->joint[joint];
    const double effort = j->joint >= 0 ? fabs(u->model->joint[j->joint].effort) : 0;
    struct spatial_actuator *const motor = spatial_add_actuator(u->model);
    if (!motor)
        return no_memory(u->message);
    snprintf(motor->name, sizeof motor->name, "%s", name);
    snprintf(motor->target, sizeof motor->target, "%s", j->name);
    motor->line = urdf_line(at);
    motor->joint = j->joint;
    motor->drive = SPATIAL_MOTOR;
    motor->gear = gear;
    motor->limited = effort > 0;
    motor->most = effort > 0 ? effort : INFINITY;
    motor->least = -motor->most;
    return true;
}

/* The first descendant of a name, as authors put it into the transmission, its joint or actuator.
 */
static const xmlNode *within(const xmlNode *node, const char *name)
{
    EACH_IN (child, node, NULL) {
        const xmlNode *const found =
            strcmp(urdf_name(child), name) == 0 ? child : within(child, name);
        if (found)
            return found;
    }
    return NULL;
}

/* As <joint name="hip"/> or <joint>hip</joint>; -1: refused. */
static int driven_joint(struct urdf *u, const xmlNode *transmission)
{
    const xmlNode *const at = urdf_child(transmission, "joint", NULL);
    const char *name = at ? urdf_text(at, "name") : NULL;
    char text[SPATIAL_NAME] = "";
    if (at && !name && urdf_value(at, text))
        name = text;
    if (!name)
        return urdf_complain(u, transmission, "a transmission without <joint name=\"...\"/>"), -1;
    if (urdf_child(transmission, "joint", at))
        return urdf_complain(
                   u, transmission,
                   "a transmission of several joints (the first is %.60s) couples them: it "
                   "is not read",
                   name),
               -1;
    const int joint = urdf_find_joint(u, name);
    if (joint < 0)
        urdf_complain(u, at, "a transmission of joint %.60s, which the robot does not have", name);
    return joint;
}

/* A number within a transmission; NAN where it is not given. */
static bool number_within(struct urdf *u, const xmlNode *node, const char *name, double *value)
{
    const xmlNode *const at = within(node, name);
    *value = NAN;
    return !at || urdf_number(u, at, value);
}

/* What the rotor's inertia is at the joint: n^2 J, by Drake's gear ratio or else the reduction. */
static bool transmission(struct urdf *u, const xmlNode *node)
{
    const xmlNode *const actuator = urdf_child(node, "actuator", NULL);
    const char *const name = actuator ? urdf_text(actuator, "name") : NULL;
    const int joint = driven_joint(u, node);
    double reduction, ratio, rotor;
    if (joint < 0 || !number_within(u, node, "mechanicalReduction", &reduction) ||
        !number_within(u, node, "gear_ratio", &ratio) ||
        !number_within(u, node, "rotor_inertia", &rotor))
        return false;
    ratio = isfinite(ratio) ? ratio : isfinite(reduction) ? reduction : 1;
    reduction = isfinite(reduction) ? reduction : ratio;
    if (reduction == 0 || ratio == 0)
        return urdf_refuse(u, node, "the transmission of joint %.60s has a reduction of 0",
                           u->joint[joint].name);
    const double armature = isfinite(rotor) ? ratio * ratio * rotor : 0;
    if (armature < 0 || !isfinite(armature))
        return urdf_refuse(u, node, "the rotor of joint %.60s has an inertia of %g at the joint",
                           u->joint[joint].name, armature);
    if (u->joint[joint].joint >= 0)
        u->model->joint[u->joint[joint].joint].armature += armature;
    return add_motor(u, node, name && *name ? name : u->joint[joint].name, joint, reduction);
}

static bool is_driven(const struct urdf *u, int joint)
{
    for (int a = 0; a < u->model->actuators; a++)
        if (u->model->actuator[a].joint == joint)
            return true;
    return false;
}

/* Joints that say how much can drive them and have nothing that does. */
static bool drive_by_effort(struct urdf *u, bool transmissions)
{
    int motors = 0;
    for (int i = 0; i < u->joints; i++) {
        const struct urdf_joint *const j = &u->joint[i];
        if (j->joint < 0 || u->model->joint[j->joint].effort <= 0)
            continue;
        if (transmissions && !is_driven(u, j->joint))
            spatial_note(u->model, "joint %s has an effort and no <transmission>: no motor",
                         j->name);
        else if (!transmissions && !add_motor(u, j->node, j->name, i, 1))
            return false;
        motors++;
    }
    if (motors > 0 && !transmissions)
        spatial_note(u->model,
                     "no <transmission>: each joint with an effort has a motor, %d of them",
                     motors);
    return true;
}

bool urdf_drives(struct urdf *u)
{
    EACH_IN (child, u->root, "transmission")
        if (!transmission(u, child))
            return false;
    return drive_by_effort(u, urdf_child(u->root, "transmission", NULL) != NULL);
}

/* ---- Gazebo ---------------------------------------------------------------------------------- */

static bool is_true(const xmlNode *node)
{
    char text[SPATIAL_NAME];
    urdf_value(node, text);
    return strcmp(text, "1") == 0 || strcmp(text, "true") == 0 || strcmp(text, "True") == 0;
}

static bool friction_of(struct urdf *u, const xmlNode *at, int link)
{
    double value = 0;
    if (!urdf_number(u, at, &value))
        return false;
    for (int g = 0; g < u->model->geoms; g++)
        if (u->model->geom[g].body == u->link[link].body)
            u->model->geom[g].friction = value;
    return true;
}

static void selves_meet(struct urdf *u, int link)
{
    for (int g = 0; g < u->model->geoms; g++)
        if (u->model->geom[g].body == u->link[link].body)
            u->model->geom[g].meets_robot = true;
}

/* Gravity that acts on some of the robot only cannot be had; see weightless(). */
static bool without_gravity(struct urdf *u, const xmlNode *at, int link)
{
    const int body = u->link[link].body;
    struct spatial_alien *alien;
    if (body < 0 || u->model->body[body].massless)
        return true;
    if (!(alien = spatial_add_alien(u->model)))
        return no_memory(u->message);
    alien->what = "link without gravity";
    snprintf(alien->name, sizeof alien->name, "%s", u->link[link].name);
    alien->line = urdf_line(at);
    return true;
}

static bool of_link(struct urdf *u, const xmlNode *at, int link, bool *known)
{
    const char *const name = urdf_name(at);
    const bool off = strcmp(name, "turnGravityOff") == 0 && is_true(at);
    *known = true;
    if (strcmp(name, "mu1") == 0 || strcmp(name, "mu") == 0)
        return friction_of(u, at, link);
    if (off || (strcmp(name, "gravity") == 0 && !is_true(at)))
        return without_gravity(u, at, link);
    if (strcmp(name, "selfCollide") == 0 && is_true(at))
        selves_meet(u, link);
    *known = strcmp(name, "gravity") == 0 || strcmp(name, "turnGravityOff") == 0 ||
             strcmp(name, "selfCollide") == 0 || strcmp(name, "material") == 0 ||
             strcmp(name, "mu2") == 0;
    return true;
}

static bool of_joint(struct urdf *u, const xmlNode *at, int joint, bool *known)
{
    const int own = u->joint[joint].joint;
    const char *const name = urdf_name(at);
    *known = own >= 0;
    if (own >= 0 && strcmp(name, "springStiffness") == 0)
        return urdf_number(u, at, &u->model->joint[own].stiffness);
    if (own >= 0 && strcmp(name, "springReference") == 0)
        return urdf_number(u, at, &u->model->joint[own].spring_reference);
    *known = own < 0;
    return true;
}

/* Names of what is left out, each once. */
struct left {
    char names[160];
};

static void leave_out(struct left *left, const xmlNode *node)
{
    const char *const name = urdf_name(node);
    char word[64];
    snprintf(word, sizeof word, " %.60s,", name);
    if (!strstr(left->names, word) && strlen(left->names) + strlen(word) < sizeof left->names)
        add_text(left->names, sizeof left->names, "%s", word);
}

static bool gazebo(struct urdf *u, const xmlNode *node, struct left *left)
{
    const char *const of = urdf_text(node, "reference");
    const int link = of ? urdf_find_link(u, of) : -1, joint = of ? urdf_find_joint(u, of) : -1;
    EACH_IN (child, node, NULL) {
        bool known = false;
        if ((link >= 0 && !of_link(u, child, link, &known)) ||
            (!known && joint >= 0 && !of_joint(u, child, joint, &known)))
            return false;
        if (!known)
            leave_out(left, child);
    }
    return true;
}

/* All without gravity: there is none. */
static void weightless(struct urdf *u)
{
    int heavy = 0, off = 0;
    for (int i = 0; i < u->model->bodies; i++)
        heavy += !u->model->body[i].massless;
    for (int i = 0; i < u->model->aliens; i++)
        off += strcmp(u->model->alien[i].what, "link without gravity") == 0;
    if (off == 0 || off < heavy)
        return;
    for (int i = 0; i < u->model->aliens; i++)
        if (strcmp(u->model->alien[i].what, "link without gravity") == 0)
            u->model->alien[i].harmless = true;
    u->model->gravity[2] = 0;
    spatial_note(u->model, "no link has gravity: there is none");
}

/* ---- what others add ------------------------------------------------------------------------- */

/* What couples parts of the robot that the tree does not. */
static bool couples(struct urdf *u, const xmlNode *at)
{
    static const char *const names[] = {"loop_joint", "ball_constraint", "linear_bushing_rpy",
                                        "force_element"};
    const char *what = NULL;
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        if (strcmp(urdf_name(at), names[i]) == 0)
            what = names[i];
    if (!what)
        return true;
    struct spatial_alien *const alien = spatial_add_alien(u->model);
    const char *const name = urdf_text(at, "name");
    if (!alien)
        return no_memory(u->message);
    alien->what = what;
    snprintf(alien->name, sizeof alien->name, "%s", name ? name : what);
    alien->line = urdf_line(at);
    return true;
}

bool urdf_extras(struct urdf *u)
{
    struct left left = {""};
    EACH_IN (child, u->root, NULL) {
        const char *const name = urdf_name(child);
        if (strcmp(name, "gazebo") == 0) {
            if (!gazebo(u, child, &left))
                return false;
        } else if (strcmp(name, "link") != 0 && strcmp(name, "joint") != 0 &&
                   strcmp(name, "transmission") != 0 && strcmp(name, "material") != 0) {
            if (!couples(u, child))
                return false;
            leave_out(&left, child);
        }
    }
    weightless(u);
    if (left.names[0]) {
        left.names[strlen(left.names) - 1] = '\0';
        spatial_note(u->model, "left out, as it does not move the robot by itself:%s", left.names);
    }
    return true;
}
