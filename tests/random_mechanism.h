/* random_mechanism.h - random trees of bodies for tests, and the dice that throws them. */
#ifndef STANCE_TESTS_RANDOM_MECHANISM_H
#define STANCE_TESTS_RANDOM_MECHANISM_H

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "engine/mechanism.h"

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
        if (!m->element[e].sole && sometimes(0.4))
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

#endif
