/* elsewhere.h - what an optimum costs where it was not sought: with contacts that the scenario
 * leaves out, on less friction, later, with other masses. */
#ifndef STANCE_OPTIMISE_ELSEWHERE_H
#define STANCE_OPTIMISE_ELSEWHERE_H

#include "trials.h"

enum elsewhere {
    ELSEWHERE_CONTACTS,
    ELSEWHERE_FRICTION,
    ELSEWHERE_LATER,
    ELSEWHERE_SLOWER,
    ELSEWHERE_HEAVIER,
    ELSEWHERE_LIGHTER,
    ELSEWHERE_MOST
};

const char *elsewhere_name(enum elsewhere where);
/* Whether there is such a place beside the scenario: it says nothing of that itself. */
bool elsewhere_exists(const struct scenario *s, enum elsewhere where);
/* Fresh starts that are tried there. */
uint64_t elsewhere_starts(const struct scenario *s);
/* Collective: share[candidates] of these that recover, value[candidates][paths]; `with` has the
 * kernels. */
enum trials_end elsewhere_run(const struct scenario *s, const struct trials *with,
                              enum elsewhere where, size_t candidates, double *value, double *share,
                              stance_message *message);

#endif
