/* mjcf.c - the model, from the root outwards. Numbers have 17 digits: they are read as they were.
 */
#include "mjcf.h"

#include <math.h>

/* MuJoCo's mjMINVAL: mass and inertia of what moves must be as large. Beside what a point mass has
 * about its joint this is rounding. */
#define LEAST 1e-15

struct model {
    FILE *out;
    const stance_scene *scene;
    const stance_mechanism *m;
    const stance_case *c;
    stance_mechanism_numbers number;
    int coordinate;                    /* of the next joint, in the scene's order */
    int order[STANCE_MAX_COORDINATES]; /* coordinates as MuJoCo orders them: depth first */
    int joints, depth;
};

/* Where the next element of a body is written: indented as deep as it is. */
static FILE *line(const struct model *o)
{
    fprintf(o->out, "%*s", 2 * o->depth, "");
    return o->out;
}

static void text(FILE *out, const char *of)
{
    for (; *of; of++)
        if (*of == '&' || *of == '<' || *of == '\'')
            fputs(*of == '&' ? "&amp;" : *of == '<' ? "&lt;" : "&apos;", out);
        else
            fputc(*of, out);
}

static void in_plane(FILE *out, const char *key, const double at[2])
{
    if (at[0] != 0 || at[1] != 0)
        fprintf(out, " %s='%.17g 0 %.17g'", key, at[0], at[1]);
}

static void numbers(FILE *out, const char *key, const double *value, int count)
{
    fprintf(out, " %s='", key);
    for (int i = 0; i < count; i++)
        fprintf(out, "%s%.17g", i ? " " : "", value[i]);
    fputc('\'', out);
}

/* R(angle) v. */
static void turn(double angle, const double v[2], double out[2])
{
    double sine, cosine;
    stance_sincos(angle, &sine, &cosine);
    out[0] = cosine * v[0] - sine * v[1];
    out[1] = sine * v[0] + cosine * v[1];
}

static void joint(struct model *o, const char *type, const double axis[2], const double anchor[2])
{
    const stance_quantity *const q = &o->scene->coordinate[o->coordinate];
    o->order[o->joints++] = o->coordinate++;
    fprintf(line(o), "<joint name='%s' type='%s'", q->name, type);
    if (axis)
        in_plane(o->out, "axis", axis);
    else
        fputs(" axis='0 -1 0'", o->out);
    in_plane(o->out, "pos", anchor);
}

/* Of a joint with one stop the other end of the range lies where no coordinate comes. */
static void springs(struct model *o, int b)
{
    const stance_body_numbers *const n = &o->number.body[b];
    const stance_quantity *const q = &o->scene->coordinate[o->coordinate - 1];
    if (n->armature != 0)
        numbers(o->out, "armature", &n->armature, 1);
    if (n->stiffness != 0) {
        numbers(o->out, "stiffness", &n->stiffness, 1);
        numbers(o->out, "springref", &n->rest, 1);
    }
    if (n->damping != 0)
        numbers(o->out, "damping", &n->damping, 1);
    if (isfinite(n->limits[0]) || isfinite(n->limits[1])) {
        fputs(" limited='true'", o->out);
        numbers(o->out, "range",
                (double[]){fmax(n->limits[0], q->low), fmin(n->limits[1], q->high)}, 2);
    }
}

static void joints(struct model *o, int b)
{
    static const double none[2];
    double x[2], z[2], axis[2]; /* in the body's own frame */
    const stance_joint kind = o->m->body[b].joint;
    const double back = -o->number.body[b].angle;
    turn(back, (const double[]){1, 0}, x);
    turn(back, (const double[]){0, 1}, z);
    turn(back, o->number.body[b].axis, axis);
    if (kind == STANCE_FIXED)
        return;
    if (kind == STANCE_FREE) {
        joint(o, "slide", x, none);
        fputs("/>\n", o->out);
        joint(o, "slide", z, none);
        fputs("/>\n", o->out);
    }
    joint(o, kind == STANCE_SLIDE ? "slide" : "hinge", kind == STANCE_SLIDE ? axis : NULL,
          kind == STANCE_FREE ? o->number.reference : none);
    if (kind != STANCE_FREE)
        springs(o, b);
    fputs("/>\n", o->out);
}

static void sphere(struct model *o, int contact, int e, const double at[2])
{
    const stance_element_numbers *const n = &o->number.element[e];
    fprintf(line(o), "<geom name='%s' size='%.17g'", o->scene->contact_name[contact],
            n->radius + MJCF_SKIN);
    if (o->m->element[e].rough) /* else the larger of its own and the ground's */
        fprintf(o->out, " priority='1' friction='%.17g 0 0'", n->friction_factor * o->c->friction);
    in_plane(o->out, "pos", at);
    fprintf(o->out, "%s/>\n", o->c->contacts >> contact & 1 ? "" : " contype='0'");
}

/* Contacts and points of a body. Both ends of a sole hold its friction here. */
static void places(struct model *o, int b)
{
    stance_contact_place place;
    for (int c = 0; stance_mechanism_contact(o->m, c, &place) && place.element >= 0; c++) {
        const stance_element_numbers *const n = &o->number.element[place.element];
        if (place.body == b)
            sphere(o, c, place.element, place.end ? n->to : n->at);
    }
    for (int p = 0; p < o->m->points; p++) {
        if (o->m->point[p].body != b)
            continue;
        fprintf(line(o), "<site name='%s'", o->m->point[p].name);
        in_plane(o->out, "pos", o->number.point[p].at);
        fputs("/>\n", o->out);
    }
}

static void body(struct model *o, int b)
{
    const stance_body_numbers *const n = &o->number.body[b];
    const bool free = o->m->body[b].joint == STANCE_FREE;
    double back[2];
    const double inertia = fmax(n->inertia, LEAST);
    turn(n->angle, o->number.reference, back);
    back[0] = 0 - back[0], back[1] = 0 - back[1];
    o->coordinate = free ? 0 : stance_mechanism_coordinate(o->m, b);
    fprintf(line(o), "<body name='%s'", o->m->body[b].name);
    in_plane(o->out, "pos", free ? back : n->at); /* all coordinates 0 */
    if (n->angle != 0)
        numbers(o->out, "euler", (double[]){0, -n->angle, 0}, 3);
    fputs(">\n", o->out);
    o->depth++;
    joints(o, b);
    fputs("<inertial", line(o));
    numbers(o->out, "pos", (double[]){n->centre[0], 0, n->centre[1]}, 3);
    fprintf(o->out, " mass='%.17g'", fmax(n->mass, LEAST));
    numbers(o->out, "diaginertia", (double[]){inertia, inertia, inertia}, 3);
    fputs("/>\n", o->out);
    places(o, b);
    for (int child = b + 1; child < o->m->bodies; child++)
        if (o->m->body[child].parent == b)
            body(o, child);
    o->depth--;
    fputs("</body>\n", line(o));
}

static void actuators(struct model *o)
{
    for (int a = 0; a < o->m->actuators; a++) {
        const double limit =
            fmin(o->number.limit[a],
                 fmin(o->c->torque_limit,
                      o->c->torque_limits[a] > 0 ? o->c->torque_limits[a] : INFINITY));
        fprintf(line(o), "<motor name='%s' joint='%s' gear='1'", o->scene->actuator_name[a],
                o->scene->coordinate[o->scene->actuated[a]].name);
        if (isfinite(limit)) {
            fputs(" ctrllimited='true'", o->out);
            numbers(o->out, "ctrlrange", (double[]){-limit, limit}, 2);
        }
        fputs("/>\n", o->out);
    }
}

static void keyframe(struct model *o)
{
    double q[STANCE_MAX_COORDINATES] = {0}, v[STANCE_MAX_COORDINATES] = {0};
    for (int i = 0; i < o->joints; i++) {
        q[i] = o->c->position[o->order[i]];
        v[i] = o->c->velocity[o->order[i]];
    }
    fputs("  <key name='initial'", o->out);
    numbers(o->out, "qpos", q, o->joints);
    numbers(o->out, "qvel", v, o->joints);
    if (o->m->actuators > 0)
        numbers(o->out, "ctrl", o->c->near.feedforward, o->m->actuators);
    fputs("/>\n", o->out);
}

static const char head[] =
    "<!-- SI units; the plane is x, z, with x forward and z up. Bodies and joints are those of "
    "the scenario:\n     a body's frame begins at the joint to its parent, and qpos and qvel are "
    "its coordinates and their\n     rates, by name. Hinges turn x towards z (about -y). A body "
    "that is fixed has no joint; the\n     inertia that counts is about y. Points, discs and both "
    "ends of a sole are spheres, larger by a\n     skin of %g m than they are, and the plane lies "
    "as much lower. A slope tilts the plane, not\n     gravity. Named points are sites.\n     Not "
    "here: control laws (ctrl of the keyframe are the torques at rest), pushes, restitution, "
    "what\n     counts as a fall. Contacts and stops are soft in MuJoCo, in stance they are exact. "
    "-->\n";

void mjcf_write(FILE *out, const stance_scene *scene, const stance_case *c, const char *title)
{
    const double slope = c->robot[STANCE_ROBOT_SLOPE], up[2] = {sin(slope), cos(slope)};
    const double ground[2] = {0 - MJCF_SKIN * up[0], 0 - MJCF_SKIN * up[1]};
    struct model o = {.out = out, .scene = scene, .m = scene->mechanism, .c = c, .depth = 1};
    stance_mechanism_expand(o.m, c->robot, &o.number);
    fputs("<mujoco model='", out);
    text(out, title);
    fputs("'>\n", out);
    fprintf(out, head, MJCF_SKIN);
    if (o.m->plates > 0)
        fputs("<!-- Without ground.plates: the ground is their plane. -->\n", out);
    fputs("<compiler angle='radian' inertiafromgeom='false'/>\n", out);
    fprintf(
        out,
        "<option timestep='%.17g' gravity='0 0 %.17g' integrator='implicit' cone='elliptic'/>\n",
        c->step, -c->robot[STANCE_ROBOT_GRAVITY]);
    fprintf(out,
            "<default><geom type='sphere' contype='1' conaffinity='0' condim='%d' "
            "friction='%.17g 0 0'/></default>\n",
            c->friction > 0 ? 3 : 1, c->friction);
    fputs("<worldbody>\n  <geom type='plane' size='0 0 1' contype='0' conaffinity='1'", out);
    in_plane(out, "pos", ground);
    in_plane(out, "zaxis", up);
    fputs("/>\n", out);
    body(&o, 0);
    fputs("</worldbody>\n<actuator>\n", out);
    actuators(&o);
    fputs("</actuator>\n<keyframe>\n", out);
    keyframe(&o);
    fputs("</keyframe>\n</mujoco>\n", out);
}
