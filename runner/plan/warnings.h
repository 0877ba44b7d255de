/* warnings.h - designs that cannot work, said before a run is wasted on them. */
#ifndef STANCE_PLAN_WARNINGS_H
#define STANCE_PLAN_WARNINGS_H

#include "plan.h"

/* One line to `out` for each thing that is wrong with some case of the plan, whose designs are
 * computed: a loop that is unstable as it is sampled, a torque that the equilibrium needs and the
 * actuators do not give, friction that is less than standing takes, angles that look like degrees.
 * Of many cases some are looked at, evenly spread. `who`: whose lines these are. */
void warnings_print(const struct plan *plan, const char *who, FILE *out);

#endif
