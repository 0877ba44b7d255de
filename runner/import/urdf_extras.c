/* urdf_extras.c - what a URDF says beside its tree: what drives joints, and the elements that
 * Gazebo, Drake, Bullet and others add.
 *
 * Of these friction, springs, gravity that is turned off, gears and rotors are taken up; what
 * couples links is refused; the rest is named in a note. Elements of a prefix that nobody declared
 * (`drake:`) are known by the name behind it.
 */
#include "urdf.h"

#include <math.h>
#include <strings.h>

/* ---- what drives joints --------------------------------------------------------------------- */

static void add_motor(struct urdf *u, const xmlNode *at, const char *name, int joint, double gear)
{
    const struct urdf_joint *const j = &u->joint[joint];
    const double effort = j->joint >= 0 ? fabs(u->model->joint[j->joint].effort) : 0;
    struct spatial_actuator *const motor = spatial_add(u->model, actuator, actuators);
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
    const int joint = urdf_find_joint(u, name);
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
bool urdf_drives(struct urdf *u)
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

/* Names of what is left out, each once. */
struct left {
    char names[160];
};

static void leave_out(struct left *left, const xmlNode *node)
{
    char word[64];
    snprintf(word, sizeof word, " %.60s,", urdf_name(node));
    if (!strstr(left->names, word) && strlen(left->names) + strlen(word) < sizeof left->names)
        add_text(left->names, sizeof left->names, "%s", word);
}

static bool of_link(struct urdf *u, const xmlNode *at, struct urdf_link *link, struct left *left)
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
        leave_out(left, at);
    }
    return true;
}

static bool gazebo(struct urdf *u, const xmlNode *node, struct left *left)
{
    const char *const of = urdf_text(node, "reference");
    const int link = of ? urdf_find_link(u, of) : -1, joint = of ? urdf_find_joint(u, of) : -1;
    const int own = joint >= 0 ? u->joint[joint].joint : -1;
    EACH_IN (child, node, NULL) {
        const bool spring = own >= 0 && urdf_is(child, "springStiffness"),
                   rest = own >= 0 && urdf_is(child, "springReference");
        if (spring || rest) {
            struct spatial_joint *const j = &u->model->joint[own];
            if (!urdf_number(u, child, spring ? &j->stiffness : &j->spring_reference))
                return false;
        } else if (link >= 0) {
            if (!of_link(u, child, &u->link[link], left))
                return false;
        } else {
            leave_out(left, child);
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

bool urdf_extras(struct urdf *u)
{
    static const char *const known[] = {"link", "joint", "transmission", "material"};
    static const char *const couples[] = {"loop_joint", "ball_constraint", "linear_bushing_rpy",
                                          "force_element"};
    struct left left = {""};
    EACH_IN (child, u->root, NULL) {
        bool passed = urdf_is(child, "gazebo");
        if (passed && !gazebo(u, child, &left))
            return false;
        for (int i = 0; i < 4; i++) {
            passed = passed || urdf_is(child, known[i]);
            if (urdf_is(child, couples[i])) {
                const char *const name = urdf_text(child, "name");
                spatial_add_alien(u->model, couples[i], name ? name : "", urdf_line(child), false);
            }
        }
        if (!passed)
            leave_out(&left, child);
    }
    weigh(u);
    if (left.names[0]) {
        left.names[strlen(left.names) - 1] = '\0';
        spatial_note(u->model, "left out, as it does not move the robot by itself:%s", left.names);
    }
    return true;
}
