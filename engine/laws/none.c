/* none.c - no controller. */
#include "engine/stance.h"

const stance_law stance_law_none = {.name = "none", .acts_far = true};
