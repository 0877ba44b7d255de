/* mechanism_algebra.h - what kernels compute of a mechanism at one state, in one lane, the
 * structure read at run time. To be included before all else of the engine.
 */
#ifndef STANCE_TESTS_MECHANISM_ALGEBRA_H
#define STANCE_TESTS_MECHANISM_ALGEBRA_H

#define METHOD_THETA 1.0
#define STANCE_LANES 1
#define STANCE_SCENE runtime
#define STANCE_ISA scalar
#include "engine/core/loop/kernel.h"
/* In this order. */
#include "engine/scenes/runtime_lanes.h"

struct algebra {
    scene_body body;
    scene_trig trig;
    scene_matrix matrix;
    double place[SCENE_COORDINATES], rate[SCENE_COORDINATES]; /* as kernels count them */
};

/* q, v [SCENE_COORDINATES]: the scene's coordinates, what is beyond them 0. */
static inline void algebra_at(const stance_scene *s, const double *robot, const double *q,
                              const double *v, struct algebra *at)
{
    stance_tree_numbers number;
    tree_now = s->tree;
    stance_tree_numbers_make(s->tree, s->mechanism, robot, &number);
    memset(at, 0, sizeof *at);
    scene_load_body(&at->body, 0, &number);
    scene_enter(&number, q, v, at->place, at->rate);
    scene_trigonometry(at->place, &at->trig);
    scene_inertia(&at->body, &at->trig, &at->matrix);
}

/* Accelerations without contacts, of the kernels' coordinates and of the scene's. */
static inline void algebra_accelerate(struct algebra *at, const double *torque, double *own,
                                      double *scene)
{
    double force[SCENE_COORDINATES], more[SCENE_COORDINATES];
    scene_residual(&at->body, &(scene_guess){.s = at->place, .trig = &at->trig, .w = at->rate},
                   torque, force);
    scene_solve(&at->matrix, false, force, own);
    scene_coordinate_rates(&at->body, &at->trig, own, scene);
    scene_coordinate_curvature(&at->body, &at->trig, at->rate, more);
    for (int i = 0; i < SCENE_COORDINATES; i++)
        scene[i] += more[i];
}

#endif
