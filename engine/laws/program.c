/* program.c - a law of the user's own, compiled from C: what it commands is its own affair, see
 * stance_program and runner/objects/law.h. */
#include "engine/stance.h"

static stance_error set(const stance_scene *scene, const double *value, const double *begin,
                        stance_linear_law *linear, stance_case *c, stance_message *message)
{
    (void)scene, (void)value, (void)begin, (void)linear, (void)c, (void)message;
    return STANCE_OK;
}

const stance_law stance_law_program = {
    .name = "program",
    .text = "a law of one's own, a function in C",
    .acts_far = true,
    .samples = true,
    .program = true,
    .set = set,
};
