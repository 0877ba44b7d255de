/* carried.h - the scenes that the program carries, as descriptions. */
#ifndef STANCE_SCENES_CARRIED_H
#define STANCE_SCENES_CARRIED_H

#include "engine/mechanism.h"

enum { STANCE_MAX_CARRIED = 8 };

/* The one at a place, from 0, with its default numbers. False: there is none. */
bool stance_carried_mechanism(int place, stance_mechanism *m);

#endif
