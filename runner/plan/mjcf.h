/* mjcf.h - a mechanism as a model of MuJoCo (MJCF), to compare with and to go on in.
 *
 * The same coordinates: a body's frame, its joint and that joint's coordinate are MuJoCo's, by the
 * same names and in the same order, the plane being x, z and a hinge turning x towards z, about -y;
 * so qpos and qvel are position and velocity. What has no counterpart there (control laws, pushes,
 * restitution, plates of the ground, what counts as a fall, contacts that are exact) is left out,
 * and said in the file.
 */
#ifndef STANCE_PLAN_MJCF_H
#define STANCE_PLAN_MJCF_H

#include "engine/mechanism.h"

#include <stdio.h>

/* Room, m, between a contact point and the surface that touches in its place: MuJoCo's spheres have
 * a radius. Discs are larger by it, and the ground lies as much lower. */
#define MJCF_SKIN 1e-4

/* The model of a described scene with the numbers, ground, step, torques (as held at first) and
 * initial state of a case; `title` may be any text. Errors of `out` are the caller's to see. */
void mjcf_write(FILE *out, const stance_scene *scene, const stance_case *c, const char *title);

#endif
