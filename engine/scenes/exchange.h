/* exchange.h - the two legs of a mechanism: which of its parts are alike in structure. */
#ifndef STANCE_SCENES_EXCHANGE_H
#define STANCE_SCENES_EXCHANGE_H

#include "engine/mechanism.h"

/* Two bodies of one parent whose subtrees have the same joints, contacts and actuators in the same
 * order are a pair; of what carries contacts there must be one pair, of other kinds (arms) may be
 * more. Or the root is a leg and the other one hangs from it. Numbers do not count: a leg may be
 * heavier. */
void stance_exchange_make(const stance_mechanism *m, const stance_scene *scene,
                          stance_exchange *exchange);

#endif
