/* search_numbers.h - which of the numbers that a search is asked to vary can differ: of the gains
 * those of the linear model. Coordinates that follow from the others while the contacts hold (of a
 * flat foot its angle) have gains of 0, see resolve_free. */
#ifndef STANCE_PLAN_SEARCH_NUMBERS_H
#define STANCE_PLAN_SEARCH_NUMBERS_H

#include "runner/scenario/scenario.h"

/* How many they are. */
int search_numbers(const struct scenario *s);
/* Leaves the others out of s->search.axis. */
void search_numbers_keep(struct scenario *s);

#endif
