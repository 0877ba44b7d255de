/* refinement_run.h - a map by refinement: rounds of cases, each chosen by the labels of those
 * before. */
#ifndef STANCE_RUN_REFINEMENT_RUN_H
#define STANCE_RUN_REFINEMENT_RUN_H

#include "work.h"

/* Collective. For a plan whose scenario asks for refinement (refine.h), all of it: computes round
 * after round, then writes what the other cases are inferred to be. Every rank keeps the labels of
 * the whole map. A resumed run goes through the same rounds and keeps the rows that the file holds
 * whole. Leaves early as work_run does; false when any rank failed. */
bool refinement_run(struct work *work, stance_message *message);

#endif
