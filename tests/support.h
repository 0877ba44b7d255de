/* support.h - what several tests share beside cases.h: controllers, trajectories, JSON references.
 */
#ifndef STANCE_TESTS_SUPPORT_H
#define STANCE_TESTS_SUPPORT_H

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cases.h"

#include "engine/control/design.h"

/* Arguments of control design, as they come. */
#define PLANT(...)                                                                                 \
    &(stance_plant)                                                                                \
    {                                                                                              \
        __VA_ARGS__                                                                                \
    }
#define POLES(...)                                                                                 \
    &(stance_poles)                                                                                \
    {                                                                                              \
        __VA_ARGS__                                                                                \
    }
#define SAMPLING(...)                                                                              \
    &(stance_sampling)                                                                             \
    {                                                                                              \
        __VA_ARGS__                                                                                \
    }

static inline const stance_kernel *kernel_of(const char *method, const char *isa)
{
    const stance_kernel *k =
        stance_kernel_find(stance_scene_find("biped"), stance_method_find(method), isa);
    return k;
}

/* Section 3.2's balance: foot 1 as only contact, robust gains, torques limited to 10 N m and held
 * for 1 ms; tilted about the foot by `theta`, turning at `vtheta`. */
static inline stance_case balance_case(double theta, double vtheta)
{
    static const double re[6] = {-3, -3.3, -3.6, -3.9, -4.2, -4.6}, im[6] = {0};
    const stance_equilibrium_choice choice = {1, {-0.41, NAN, 0.82}, 0};
    const stance_scene *scene = stance_scene_find("biped");
    stance_equilibrium equilibrium;
    stance_message message;
    double A[36], B[12], K[12];
    stance_case c = plain_case();
    if (scene->equilibrium(scene, c.robot, &choice, &equilibrium, &message) != STANCE_OK ||
        scene->linearise(scene, c.robot, &equilibrium, A, B) != STANCE_OK ||
        stance_place(STANCE_ROBUST, PLANT(6, 2, A, B), 0, POLES(re, im), K, NULL, &message) !=
            STANCE_OK)
        fail_msg("no balance controller");
    put_gain(&c, K);
    memcpy(c.position, equilibrium.position, sizeof c.position);
    memcpy(c.near.feedforward, equilibrium.torque, sizeof c.near.feedforward);
    memcpy(c.near.target, equilibrium.position + 2, sizeof(double[3]));
    c.position[2] += theta;
    c.velocity[2] = vtheta;
    scene->stand(scene, c.robot, 1, c.position, c.velocity);
    c.contacts = 1;
    c.torque_limit = 10;
    c.sample_every = 1;
    c.steps = 8000;
    c.supports = 1;
    c.has_target = c.settle = true;
    return c;
}

/* The equilibrium on foot 1 that a case's controller is for. */
static inline stance_equilibrium equilibrium_at(const stance_case *c)
{
    const stance_equilibrium_choice choice = {1, {c->near.target[0], NAN, c->near.target[2]}, 0};
    stance_equilibrium equilibrium;
    stance_message message;
    if (biped()->equilibrium(biped(), c->robot, &choice, &equilibrium, &message) != STANCE_OK)
        fail_msg("%s", message.text);
    return equilibrium;
}

/* Buffers for a trajectory of `rows` rows; freed by trajectory_free. */
static inline stance_trajectory trajectory_new(int64_t rows, double interval)
{
    const size_t n = (size_t)rows;
    stance_trajectory t = {interval,
                           rows,
                           calloc(n * 5, sizeof(double)),
                           calloc(n * 5, sizeof(double)),
                           calloc(n * 2, sizeof(double)),
                           calloc(n * 4, sizeof(double)),
                           calloc(n * 2, sizeof(double))};
    assert_non_null(t.position);
    assert_non_null(t.velocity);
    assert_non_null(t.torque);
    assert_non_null(t.force);
    assert_non_null(t.gap);
    return t;
}
static inline void trajectory_free(stance_trajectory *t)
{
    free(t->position);
    free(t->velocity);
    free(t->torque);
    free(t->force);
    free(t->gap);
}

static inline json_t *reference_load(const char *path)
{
    json_error_t error;
    json_t *root = json_load_file(path, 0, &error);
    if (!root)
        fail_msg("%s:%d: %s", path, error.line, error.text);
    return root;
}

#endif
