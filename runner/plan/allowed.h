/* allowed.h - from which starts linear theory allows some controller to recover, with the torques
 * there are and contacts that stand: the null-controllable set about the equilibrium
 * (engine/control/null_controllable.c), at one point of the parameters. */
#ifndef STANCE_PLAN_ALLOWED_H
#define STANCE_PLAN_ALLOWED_H

#include "design.h"

struct allowed {
    stance_null_set *set; /* of the robot that there is; NULL: none, `why` */
    stance_message why;
    stance_equilibrium equilibrium;
    struct resolved_design design; /* of its controller, for the starts */
};

/* At the parameters of case `index`. False: no memory; nothing is to be freed then. */
bool allowed_make(struct allowed *allowed, const struct scenario *s, uint64_t index,
                  stance_message *message);
void allowed_free(struct allowed *allowed);

/* Whether case `index` begins in it, which must exist. */
bool allowed_case(const struct allowed *allowed, const struct scenario *s, uint64_t index);

/* The state x[DESIGN_STATES] of the set, from position and velocity[coordinates]. */
void allowed_state(const struct allowed *allowed, const double *position, const double *velocity,
                   double *x);

#endif
