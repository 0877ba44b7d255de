/* ancestry.h - the scenarios that a results file was made from, where a run went on with another
 * one than it was begun with (runner/store/changed_scenario.h). */
#ifndef STANCE_STORE_ANCESTRY_H
#define STANCE_STORE_ANCESTRY_H

#include "results.h"

struct ancestry {
    size_t scenarios;                                   /* 1: as usual */
    char date[STORE_MOST_ANCESTORS + 1][SCENARIO_NAME]; /* of each: when it was first run */
    uint64_t done[STORE_MOST_ANCESTORS + 1]; /* cases done with it; where scenarios > 1 */
};

/* false: the file's numbers cannot be read. */
bool ancestry_read(const struct results *r, struct ancestry *ancestry, stance_message *message);

#endif
