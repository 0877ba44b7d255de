/* changed_scenario.h - a results file that goes on with another scenario than it was begun with.
 *
 * `run --resume --force-scenario`: what is done stays, what is pending is computed as the new
 * scenario says. The file never changes its structure: a new one is made beside it, with the same
 * axes, designs and answers, the old scenarios in group `history` and one more variable over the
 * cases, `scenario_number`; the rows that verify are copied; then it takes the old one's name. A
 * kill at any moment leaves one or the other. What would not fit together is refused: other axes,
 * answers, records or designs, and any other case of a map that is refined,
 * which infers cases from each other.
 */
#ifndef STANCE_STORE_CHANGED_SCENARIO_H
#define STANCE_STORE_CHANGED_SCENARIO_H

#include "adopt.h"

/* Prints the lines that are in one of two texts only, the first ones of many, as "  - old" and
 * "  + new" (`to` NULL: nothing), and returns how many there are. */
size_t changed_scenario_differences(FILE *to, const char *before, const char *after);

/* Whether a scenario, whose axes are still its own and not the file's, has the axes and the sample
 * of the file's, which is read: false with the reason in *message. */
bool changed_scenario_check_sweep(struct adopted *old, const struct scenario *scenario,
                                  stance_message *message);
/* On rank 0, with the lock, after that: puts the successor in the place of the old file; the
 * scenario is the plan's. Takes the plan's designs from the file, and sets plan->ancestors. False
 * with the reason in *message, which is empty where `plan->stop` said to stop; then the file is as
 * it was. *refused: this scenario cannot follow that one. */
bool changed_scenario_make(struct adopted *old, struct plan *plan, int ranks, const char *hosts,
                           struct store_copied *copied, bool *refused, stance_message *message);
/* On rank 0, with the lock: removes a successor that an attempt which was killed has left. */
void changed_scenario_clear(const char *file);

#endif
