/* implicit.c - the paper's non-regular algorithm: Moreau's implicit step with theta = 1.
 *
 * Forces, inertia and contact directions at the end of the step (the paper's equations 6-15), the
 * fully converged Newton iteration and the exact contact solution of core/implicit/step.h. First
 * order, unconditionally stable under stiff servo gains. In flight it conserves neither energy nor
 * momentum: inertia is that of the end while the change of velocity is that of the whole step,
 * which errs in proportion to the step, to either side.
 */
#define METHOD_THETA 1.0

#include "engine/core/loop/kernel.h"
/* In this order. */
#include STANCE_SCENE_LANES
// clang-format off
#include "engine/core/implicit/fixed.h"
#include "engine/core/loop/stream.h"
// clang-format on

STANCE_METHOD(implicit) = {
    .name = "implicit",
    .text = "Moreau's implicit step, theta = 1, exact contact: the paper's method",
    .order_smooth = 1,
};

STANCE_KERNEL(implicit);
