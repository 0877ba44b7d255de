/* linear_limit.h - the denominator of a search: from which fresh starts linear theory allows any
 * controller to recover (engine/control/null_controllable.c). */
#ifndef STANCE_OPTIMISE_LINEAR_LIMIT_H
#define STANCE_OPTIMISE_LINEAR_LIMIT_H

#include "trials.h"

/* Share of the first `starts` fresh starts of the candidate value[paths] in each circumstance,
 * share[circumstances]; NAN: linear theory sets no bound there. */
void linear_limit_shares(struct trials *trials, double *value, uint64_t starts, double *share);

/* What these allow a search as it counts: no more than in the circumstance *least, that with the
 * smallest share, if it is of the worst of several; else their mean, *least is `circumstances`.
 * NAN: they set no bound. */
double linear_limit_overall(bool worst, size_t circumstances, const double *share, size_t *least);

#endif
