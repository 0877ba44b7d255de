/* warnings.h - designs that cannot work, said before a run is wasted on them. */
#ifndef STANCE_PLAN_WARNINGS_H
#define STANCE_PLAN_WARNINGS_H

#include "plan.h"

/* One line on standard error for each thing that is wrong with some case of the plan, whose designs
 * are computed: a loop that is unstable as it is sampled, a torque that the equilibrium needs and
 * the actuators do not give, friction that is less than standing takes, noise that keeps states out
 * of the window of settling or is more than torque limits leave, angles that look like degrees, an
 * axis of starts whose points leave out the equilibrium by more than 1/200 of the range. Of many
 * cases some are looked at, evenly spread. `who`: whose lines these are. True: some cannot work. */
bool warnings_print(const struct plan *plan, const char *who);

/* Simulates the middle of the sweep and its corners, edges and faces, at most WARNINGS_TRIED cases
 * for a moment, and says what warnings_of_ends has to say of them; nothing where that takes longer.
 * Of a lone case: that it has fallen where it begins. */
enum { WARNINGS_TRIED = 81 };
void warnings_try(const struct plan *plan, const char *who);

/* One line where the ranges show no boundary: of `cases` that have ended, all are stabilised or
 * all fell, though a law was to hold them. outcome[STANCE_OUTCOME_COUNT]; `tried`: not all cases of
 * the sweep. */
void warnings_of_ends(const struct scenario *s, const uint64_t *outcome, uint64_t cases, bool tried,
                      const char *who);

#endif
