/* random_mechanism.h - random trees of bodies for tests, and the dice that throws them. */
#ifndef STANCE_TESTS_RANDOM_MECHANISM_H
#define STANCE_TESTS_RANDOM_MECHANISM_H

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "cases.h"

#include "engine/mechanism.h"
#include "engine/tree.h"

static uint64_t dice = 1;
static inline double between(double low, double high)
{
    dice = dice * 6364136223846793005u + 1442695040888963407u;
    return low + (high - low) * (double)(dice >> 11) * 0x1p-53;
}
static inline int whole(int low, int high) /* both ends included */
{
    const int n = low + (int)floor(between(0, high - low + 1));
    return n > high ? high : n;
}
static inline bool sometimes(double share)
{
    return between(0, 1) < share;
}

static inline void random_vector(double *v, double size)
{
    for (int k = 0; k < 2; k++)
        v[k] = sometimes(0.3) ? 0 : between(-size, size);
}

static inline void add_body(stance_mechanism *m, stance_joint joint, int parent)
{
    const int b = m->bodies++;
    stance_body_numbers *const body = &m->value.body[b];
    snprintf(m->body[b].name, STANCE_NAME, "body%d", b);
    m->body[b].joint = joint;
    m->body[b].parent = parent;
    *body = (stance_body_numbers){.mass = between(0.1, 5),
                                  .inertia = between(0.01, 1),
                                  .limits = {-INFINITY, INFINITY},
                                  .turn = INFINITY,
                                  .axis = {between(0.2, 1), between(-1, 1)}};
    random_vector(body->centre, 0.5);
    random_vector(body->at, 0.7);
    if (sometimes(0.3))
        body->angle = between(-3, 3);
    if (joint == STANCE_FIXED || joint == STANCE_FREE)
        return;
    if (sometimes(0.3)) {
        body->stiffness = between(0, 50);
        body->damping = between(0, 5);
        body->rest = between(-1, 1);
    }
    if (sometimes(0.3))
        body->armature = between(0, 0.5);
    if (sometimes(0.3) && m->bodies < 6) {
        body->limits[0] = between(-2, -1);
        if (sometimes(0.5))
            body->limits[1] = between(1, 2);
    }
}

static inline int last_joint(const stance_mechanism *m)
{
    for (int b = m->bodies - 1; b > 0; b--)
        if (m->body[b].joint != STANCE_FIXED)
            return b;
    return 0;
}

/* `joints`, of which about a share slides, fixed bodies, up to most_elements contacts, motors,
 * springs, stops, pushed points (without a force yet). It may have more contacts than fit: see
 * stance_mechanism_scene. */
static inline void random_mechanism(stance_mechanism *m, int joints, double slides,
                                    int most_elements)
{
    memset(m, 0, sizeof *m);
    const stance_joint root = (stance_joint)whole(0, 2);
    add_body(m, root, -1);
    for (int moving = root == STANCE_SLIDE ? 0 : 1; moving < joints;) {
        const bool fixed = sometimes(0.2) && m->bodies < STANCE_MAX_BODIES - joints;
        const stance_joint joint = slides > 0 && sometimes(slides) ? STANCE_SLIDE : STANCE_HINGE;
        add_body(m, fixed ? STANCE_FIXED : joint, whole(0, m->bodies - 1));
        moving += !fixed;
    }
    const int elements = root == STANCE_SLIDE && joints == 0 ? 0 : whole(0, most_elements);
    for (int e = 0; e < elements; e++) {
        int b = sometimes(0.5) ? last_joint(m) : whole(0, m->bodies - 1);
        if (root == STANCE_SLIDE)
            b = last_joint(m);
        if (root == STANCE_SLIDE && b == 0)
            break;
        snprintf(m->element[e].name, STANCE_NAME, "contact%d", e);
        m->element[e].body = b;
        m->element[e].sole = sometimes(0.3);
        random_vector(m->value.element[e].at, 0.5);
        random_vector(m->value.element[e].to, 0.5);
        if (sometimes(0.4))
            m->value.element[e].radius = between(0.05, 0.4);
        m->elements++;
    }
    while (m->points < STANCE_MAX_PUSHES && sometimes(0.4)) {
        const int p = m->points++;
        m->point[p].body = whole(0, m->bodies - 1);
        random_vector(m->value.point[p].at, 0.5);
        m->point[p].pushed = STANCE_FORCE;
    }
    for (int b = 0; b < m->bodies && m->actuators < STANCE_MAX_ACTUATORS; b++)
        if (m->body[b].joint != STANCE_FIXED && m->body[b].joint != STANCE_FREE && sometimes(0.6)) {
            m->value.limit[m->actuators] = INFINITY;
            snprintf(m->actuator[m->actuators].name, STANCE_NAME, "motor%d", b);
            m->actuator[m->actuators++].body = b;
        }
}

/* The scene of one that has no more contacts than fit. */
static inline stance_scene *random_scene(int tree, double slides)
{
    static stance_mechanism m;
    stance_scene *scene = NULL;
    dice = 1000003u * (uint64_t)tree + 11;
    do {
        const bool large = sometimes(0.2); /* as far as the limits go */
        random_mechanism(&m, whole(1, large ? STANCE_MAX_ANGLES : 7), slides,
                         large ? STANCE_MAX_ELEMENTS : 6);
        for (int p = 0; p < m.points; p++) {
            stance_point_numbers *const n = &m.value.point[p];
            m.point[p].pushed = sometimes(0.5) ? STANCE_FORCE : STANCE_IMPULSE;
            for (int axis = 0; axis < 2; axis++)
                n->force[axis] =
                    m.point[p].pushed == STANCE_FORCE ? between(-100, 100) : between(-3, 3);
            n->from = between(0, 0.2);
            n->to = n->from + between(0, 0.1);
            m.point[p].swings = m.point[p].pushed == STANCE_FORCE && sometimes(0.3);
            if (m.point[p].swings) {
                n->frequency = between(0.5, 20);
                n->to = sometimes(0.5) ? INFINITY : n->to;
            }
        }
        for (int e = 0; e < m.elements; e++) /* a sole has a length */
            m.element[e].sole &= fabs(m.value.element[e].at[0] - m.value.element[e].to[0]) +
                                     fabs(m.value.element[e].at[1] - m.value.element[e].to[1]) >
                                 0.05;
        for (int e = 0; e < m.elements && tree % 4 == 3; e++) {
            m.element[e].rough = e % 3 != 1;
            m.value.element[e].friction_factor = 0.4 + 0.3 * e;
        }
    } while (stance_mechanism_scene(&m, &scene, NULL) != STANCE_OK);
    return scene;
}

/* Where no stop is passed; a free root just above the ground or on it. What then is below the
 * ground all the same, the root being held, is no contact. The same on every machine: no number is
 * the C library's. */
static inline void random_scene_case(const stance_scene *scene, stance_case *c)
{
    double gap[STANCE_MAX_CONTACTS], least = INFINITY;
    bool beyond = true;
    memset(c, 0, sizeof *c);
    stance_robot_fallback(scene, c->robot);
    c->scene = scene;
    const double slope = sometimes(0.5) ? 0 : between(-0.3, 0.3);
    double sine, cosine;
    stance_sincos(slope, &sine, &cosine);
    c->robot[STANCE_ROBOT_SLOPE] = slope;
    while (beyond) {
        for (int i = 0; i < scene->coordinates; i++) {
            c->position[i] = between(-2, 2);
            c->velocity[i] = between(-4, 4);
        }
        scene->gaps(scene, c->robot, c->position, gap);
        beyond = false;
        for (int k = 0; k < scene->contacts; k++)
            beyond |= scene->grip[k] < 0 && gap[k] < 0;
    }
    for (int k = 0; k < scene->contacts; k++)
        if (scene->grip[k] >= 0)
            least = fmin(least, gap[k]);
    if (scene->mechanism->body[0].joint == STANCE_FREE && isfinite(least)) {
        c->position[1] += ((sometimes(0.5) ? 1e-13 : between(0, 0.2)) - least) / cosine;
        scene->gaps(scene, c->robot, c->position, gap);
    }
    c->contacts = (1u << scene->contacts) - 1;
    for (int k = 0; k < scene->contacts; k++)
        for (int end = 0; end < scene->contacts; end++)
            if (gap[k] < 0 && scene->grip[end] == scene->grip[k] && scene->grip[k] >= 0)
                c->contacts &= ~(1u << end);
    c->scene = scene;
    c->tree = scene->tree;
    stance_tree_numbers_make(scene->tree, scene->mechanism, c->robot, &c->body);
    c->friction = between(0, 2);
    c->sample_every = sometimes(0.8);
    /* Held torques may feed a light body without end. */
    c->torque_limit = c->sample_every ? 20 : INFINITY;
    for (int i = 0; i < scene->actuators; i++)
        for (int p = 0; p < scene->postures; p++)
            if (scene->posture[p] == scene->actuated[i]) {
                c->near.gain[i][p] = between(0, 50);
                c->near.gain[i][scene->postures + p] = between(0, 5);
                c->near.target[p] = c->position[scene->actuated[i]];
            }
    c->step = between(1e-4, 2e-4);
    c->step = fmin(ldexp(c->step, whole(0, 7)), 2e-2);
    c->steps = (int64_t)fmin(250, 0.25 / c->step);
}

#endif
