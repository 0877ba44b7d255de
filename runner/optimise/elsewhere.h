/* elsewhere.h - what an optimum costs where it was not sought: with contacts that the scenario
 * leaves out, on less friction, later, with other masses. */
#ifndef STANCE_OPTIMISE_ELSEWHERE_H
#define STANCE_OPTIMISE_ELSEWHERE_H

#include "trials.h"

enum { ELSEWHERE_MOST = 6 };

/* The name of such a place beside the scenario; NULL: it says nothing of that itself. */
const char *elsewhere_name(const struct scenario *s, int where);
/* Fresh starts that are tried there. */
uint64_t elsewhere_starts(const struct scenario *s);
/* Collective: share[candidates] of these that recover, value[candidates][paths]; `with` has the
 * kernels. */
enum trials_end elsewhere_run(const struct trials *with, int where, size_t candidates,
                              double *value, double *share, stance_message *message);

#endif
