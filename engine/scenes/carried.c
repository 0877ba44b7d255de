/* carried.c - the scenes that the program carries: descriptions whose numbers follow from a few
 * parameters.
 *
 * biped: five point masses on massless links, hinged at the hip, of S. Caux and R. Zapata, Modeling
 * and control of biped robot dynamics, Robotica 17 (1999): "the paper". (x, z) is the trunk's mass.
 *
 * ball, block: do not turn; they slide along two axes. The ball's are level and upright. Dropped
 * from rest with gap H it lands after sqrt(2 H / g); with restitution e its k-th rebound reaches
 * e^(2k) H, so that for e < 1 infinitely many are over at sqrt(2 H / g) (1 + e) / (1 - e). The
 * block's axes are those of the plane, x downhill, z its underside's height: without a pull it
 * stays for tan |slope| <= mu and else slides with g (sin - mu cos).
 *
 * rod: rigid, both ends may touch; its centre is (x, z).
 */
#include "engine/mechanism.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#define FAR 1e6   /* m */
#define TURNS 1e3 /* rad */

/* ---- the biped ------------------------------------------------------------------------------- */

enum { LEG_LENGTH, TRUNK_LENGTH, FOOT_MASS, TRUNK_MASS, HIP_MASS, BIPED_PARAMETERS };
enum { TRUNK, HIP, LEG1, LEG2 }; /* bodies; points and contacts are in this order, too */

static const stance_quantity biped_parameters[BIPED_PARAMETERS] = {
    [LEG_LENGTH] = {"leg_length", "m", "length of each leg, from the hip to the foot", 0.535, 1e-3,
                    1e3},
    [TRUNK_LENGTH] = {"trunk_length", "m", "length of the trunk, from the hip to its mass", 0.535,
                      1e-3, 1e3},
    [FOOT_MASS] = {"foot_mass", "kg", "mass of each foot", 1.8, 1e-3, 1e4},
    [TRUNK_MASS] = {"trunk_mass", "kg", "mass of the trunk, at its upper end", 1.8, 1e-3, 1e4},
    [HIP_MASS] = {"hip_mass", "kg", "mass of the hip", 5.4, 1e-3, 1e4},
};

static const stance_quantity biped_coordinates[] = {
    {"x", "m", "horizontal position of the trunk's mass, forward", 0, -FAR, FAR},
    {"z", "m", "height of the trunk's mass above the ground", 0, -FAR, FAR},
    {"theta", "rad", "pitch of the trunk, counter-clockwise", 0, -TURNS, TURNS},
    {"q1", "rad", "angle of leg 1 against the trunk, counter-clockwise, 0 in line with it", 0,
     -TURNS, TURNS},
    {"q2", "rad", "angle of leg 2 against the trunk, counter-clockwise, 0 in line with it", 0,
     -TURNS, TURNS},
};

static void biped_set(const double *robot, stance_mechanism_numbers *n)
{
    const double leg = robot[LEG_LENGTH], trunk = robot[TRUNK_LENGTH];
    n->body[TRUNK].mass = robot[TRUNK_MASS];
    n->body[TRUNK].centre[1] = n->reference[1] = trunk;
    n->body[HIP].mass = robot[HIP_MASS];
    for (int i = 0; i < 2; i++) {
        n->body[LEG1 + i].mass = robot[FOOT_MASS];
        n->body[LEG1 + i].centre[1] = n->element[i].at[1] = -leg;
    }
    n->point[0].lowest = robot[STANCE_ROBOT_FALL_HEIGHT] * leg;
    n->point[1].at[1] = trunk;
    n->point[1].lowest = 0;
}

/* The paper's balance controller at its equilibrium, torques within 10 N m. */
static const stance_equilibrium_choice balanced = {1, {-0.41, NAN, 0.82}, 0};
enum { THETA = 2, Q1, Q2 };

static void flight(const double even[2], stance_case *c)
{
    c->torque_limit = 10;
    c->position[1] += 1000;
    for (int k = THETA; k <= Q2; k++)
        c->velocity[k] = 4 * even[k % 2] - 2;
}

static void one_foot(const double even[2], stance_case *c)
{
    c->torque_limit = 10;
    c->contacts = 1;
    c->position[THETA] += -0.09 + 0.1 * even[0];
    c->scene->stand(c->scene, c->robot, 1, c->position, c->velocity);
}

/* The legs held apart; the other foot up to a centimetre high. */
static void two_feet(const double even[2], stance_case *c)
{
    const double leg = 0.5;
    c->torque_limit = 100;
    for (int k = 0; k < 2; k++) {
        c->near.gain[k][1 + k] = 200, c->near.gain[k][4 + k] = 10;
        c->near.target[1 + k] = c->position[Q1 + k] = k ? -leg : leg;
    }
    c->position[THETA] = -0.02 * even[0];
    c->scene->stand(c->scene, c->robot, 1, c->position, c->velocity);
}

static const stance_workload biped_workloads[] = {{"flight", &balanced, flight},
                                                  {"one foot", &balanced, one_foot},
                                                  {"two feet", NULL, two_feet},
                                                  {0}};

/* ---- what does not turn ---------------------------------------------------------------------- */

enum { RAIL, SLIDER };

enum { BALL_MASS, RADIUS, BALL_PARAMETERS };

static const stance_quantity ball_parameters[BALL_PARAMETERS] = {
    [BALL_MASS] = {"mass", "kg", "mass of the ball", 1, 1e-6, 1e6},
    [RADIUS] = {"radius", "m", "radius of the ball; 0: a point", 0.1, 0, 1e3},
};

static const stance_quantity ball_coordinates[] = {
    {"x", "m", "horizontal position of the centre", 0, -FAR, FAR},
    {"z", "m", "height of the centre above the ground", 1, -FAR, FAR},
};

static void ball_set(const double *robot, stance_mechanism_numbers *n)
{
    n->body[RAIL].axis[0] = 1;
    n->body[SLIDER].axis[0] = 0;
    n->body[SLIDER].axis[1] = 1;
    n->body[SLIDER].mass = robot[BALL_MASS];
    n->element[0].radius = robot[RADIUS];
}

enum { BLOCK_MASS, PULL, PULL_FREQUENCY, BLOCK_PARAMETERS };

static const stance_quantity block_parameters[BLOCK_PARAMETERS] = {
    [BLOCK_MASS] = {"mass", "kg", "mass of the block", 1, 1e-6, 1e6},
    [PULL] = {"pull", "N",
              "amplitude of the force along the plane, pull sin(2 pi pull_frequency t)", 0, -1e9,
              1e9},
    [PULL_FREQUENCY] = {"pull_frequency", "Hz", "frequency of the pull", 1, 0, 1e6},
};

static const stance_quantity block_coordinates[] = {
    {"x", "m", "position along the plane, downhill", 0, -FAR, FAR},
    {"z", "m", "height of the underside above the plane, normal to it", 0, -FAR, FAR},
};

static void block_set(const double *robot, stance_mechanism_numbers *n)
{
    double sine, cosine;
    stance_sincos(robot[STANCE_ROBOT_SLOPE], &sine, &cosine);
    n->body[RAIL].axis[0] = cosine;
    n->body[RAIL].axis[1] = -sine;
    n->body[SLIDER].axis[0] = sine;
    n->body[SLIDER].axis[1] = cosine;
    n->body[SLIDER].mass = robot[BLOCK_MASS];
    n->point[0].force[0] = robot[PULL];
    n->point[0].frequency = robot[PULL_FREQUENCY];
    n->point[0].to = robot[PULL] != 0 ? INFINITY : 0;
}

/* The block has no size; it is drawn with this one, m. */
static const double block_outline[][2] = {{0, 0},      {0.1, 0},  {0.1, 0.1},
                                          {-0.1, 0.1}, {-0.1, 0}, {0, 0}};

/* ---- the rod --------------------------------------------------------------------------------- */

enum { LENGTH, ROD_MASS, INERTIA_RATIO, ROD_PARAMETERS };

static const stance_quantity rod_parameters[ROD_PARAMETERS] = {
    [LENGTH] = {"length", "m", "length of the rod", 1, 1e-3, 1e3},
    [ROD_MASS] = {"mass", "kg", "mass of the rod", 1, 1e-6, 1e6},
    [INERTIA_RATIO] = {"inertia_ratio", "1",
                       "moment of inertia about the centre, in masses times squared lengths; 1/12: "
                       "uniform, 1/4: all mass at the ends",
                       1. / 12, 1e-3, 0.25},
};

static const stance_quantity rod_coordinates[] = {
    {"x", "m", "horizontal position of the centre", 0, -FAR, FAR},
    {"z", "m", "height of the centre above the ground", 1, -FAR, FAR},
    {"theta", "rad", "angle against the horizontal, counter-clockwise", 0, -TURNS, TURNS},
};

static void rod_set(const double *robot, stance_mechanism_numbers *n)
{
    const double length = robot[LENGTH];
    n->body[0].mass = robot[ROD_MASS];
    n->body[0].inertia = robot[INERTIA_RATIO] * robot[ROD_MASS] * (length * length);
    for (int end = 0; end < 2; end++)
        n->element[end].at[0] = (end ? 0.5 : -0.5) * length;
}

/* ---- all of them ----------------------------------------------------------------------------- */

#define PARAMETERS(scene)                                                                          \
    .parameters = sizeof scene##_parameters / sizeof *scene##_parameters,                          \
    .parameter = scene##_parameters, .coordinate = scene##_coordinates, .set = scene##_set

/* A scene, and its structure: lists that end where there is no name. */
static const struct scene {
    stance_carried carried;
    struct {
        const char *name;
        stance_joint joint;
        int parent;
    } body[5];
    struct {
        const char *name;
        int body;
    } contact[3], actuator[3];
    struct {
        const char *name;
        int body;
        bool falls, swings;
    } point[3];
} scenes[] = {
    {{.name = "biped",
      .text = "planar biped: trunk, hip and two legs with point feet, torques at the hip",
      .numbered = true,
      .workload = biped_workloads,
      PARAMETERS(biped)},
     .body = {{"trunk", STANCE_FREE, -1},
              {"hip", STANCE_FIXED, TRUNK},
              {"leg1", STANCE_HINGE, TRUNK},
              {"leg2", STANCE_HINGE, TRUNK}},
     .contact = {{"foot1", LEG1}, {"foot2", LEG2}},
     .actuator = {{"hip1", LEG1}, {"hip2", LEG2}},
     .point = {{"hip", TRUNK, .falls = true}, {"trunk", TRUNK, .falls = true}}},
    {{.name = "ball", .text = "ball that does not spin", PARAMETERS(ball)},
     .body = {{"rail", STANCE_SLIDE, -1}, {"ball", STANCE_SLIDE, RAIL}},
     .contact = {{"bottom", SLIDER}}},
    {{.name = "block",
      .text = "block that does not turn, on an inclined plane, pulled along it",
      .along_slope = true,
      .outline = block_outline,
      .corners = sizeof block_outline / sizeof *block_outline,
      PARAMETERS(block)},
     .body = {{"rail", STANCE_SLIDE, -1}, {"block", STANCE_SLIDE, RAIL}},
     .contact = {{"base", SLIDER}},
     .point = {{"pull", SLIDER, .swings = true}}},
    {{.name = "rod", .text = "rigid rod, both ends of which may touch the ground", PARAMETERS(rod)},
     .body = {{"rod", STANCE_FREE, -1}},
     .contact = {{"end1", 0}, {"end2", 0}}},
};

static void make_structure(const struct scene *of, stance_mechanism *m)
{
    for (int k = 0; of->body[k].name; k = ++m->bodies) {
        snprintf(m->body[k].name, STANCE_NAME, "%s", of->body[k].name);
        m->body[k].joint = of->body[k].joint;
        m->body[k].parent = of->body[k].parent;
    }
    for (int k = 0; of->contact[k].name; k = ++m->elements) {
        snprintf(m->element[k].name, STANCE_NAME, "%s", of->contact[k].name);
        m->element[k].body = of->contact[k].body;
    }
    for (int k = 0; of->actuator[k].name; k = ++m->actuators) {
        snprintf(m->actuator[k].name, STANCE_NAME, "%s", of->actuator[k].name);
        m->actuator[k].body = of->actuator[k].body;
    }
    for (int k = 0; of->point[k].name; k = ++m->points) {
        snprintf(m->point[k].name, STANCE_NAME, "%s", of->point[k].name);
        m->point[k].body = of->point[k].body;
        m->point[k].falls = of->point[k].falls;
        m->point[k].swings = of->point[k].swings;
        m->point[k].pushed = of->point[k].swings ? STANCE_FORCE : STANCE_NO_PUSH;
    }
}

/* The one at a place, with its default numbers. */
static stance_mechanism mechanism_at(int place)
{
    const stance_carried *const carried = &scenes[place].carried;
    stance_mechanism m = {.carried = carried, .numbers = carried->parameters};
    double robot[STANCE_MAX_ROBOT] = {
        [STANCE_ROBOT_GRAVITY] = STANCE_GRAVITY, [STANCE_ROBOT_FALL_HEIGHT] = STANCE_FALL_HEIGHT};
    stance_mechanism_defaults(&m.value);
    for (int i = 0; i < carried->parameters; i++) {
        robot[i] = carried->parameter[i].fallback;
        m.number[i] = -1;
    }
    make_structure(&scenes[place], &m);
    carried->set(robot, &m.value);
    return m;
}

enum { SCENES = sizeof scenes / sizeof *scenes };
static const stance_scene *made[SCENES + 1];

/* Before the program begins, and once. */
__attribute__((constructor)) static void make_scenes(void)
{
    for (int i = 0; i < SCENES; i++) {
        const stance_mechanism m = mechanism_at(i);
        stance_scene *scene;
        if (stance_mechanism_scene(&m, &scene, NULL) != STANCE_OK)
            abort();
        made[i] = scene;
    }
}

const stance_scene *const *stance_scenes(void)
{
    return made;
}
