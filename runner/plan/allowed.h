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

/* What stands beside the numbers of a bound for an equilibrium on several contacts, a sole's two
 * ends or two feet: they can tip, and a bound for contacts that hold whatever they must does not
 * see it. */
#define ALLOWED_GLUED                                                                              \
    "contacts as if glued: the bound does not know where their centre of pressure may be"
static inline bool allowed_glued(const stance_equilibrium *equilibrium)
{
    return (equilibrium->supports & (equilibrium->supports - 1)) != 0;
}
/* The same of a scenario's base values. */
bool allowed_glued_in(const struct scenario *s);

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
