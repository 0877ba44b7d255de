/* standing.h - where there are equilibria, for those who asked for one where there is none. */
#ifndef STANCE_PLAN_STANDING_H
#define STANCE_PLAN_STANDING_H

#include "runner/scenario/scenario.h"

/* Adds to a message that says why a mechanism has no equilibrium for which values of one angle that
 * was given, nearest to its own, there is one, the others as they are. Of other messages, and where
 * none is found, nothing. */
void standing_ranges(const struct scenario *s, const struct scenario_values *values,
                     stance_message *message);

#endif
