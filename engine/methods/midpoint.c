/* midpoint.c - Moreau's step with theta = 1/2 for the smooth forces.
 *
 * The implicit midpoint rule between impacts: forces and inertia at the middle of the step, second
 * order while the contact mode lasts. Contact impulses stay fully implicit: the contact laws hold
 * for the velocity at the end, or a ball would rebound at e = 0.
 */
#define METHOD_THETA 0.5

#include "engine/core/loop/kernel.h"
/* In this order. */
#include STANCE_SCENE_LANES
// clang-format off
#include "engine/core/implicit/fixed.h"
#include "engine/core/loop/stream.h"
// clang-format on

STANCE_METHOD(midpoint) = {
    .name = "midpoint",
    .text = "implicit midpoint for smooth forces, implicit contact impulses",
    .order_smooth = 2,
};

STANCE_KERNEL(midpoint);
