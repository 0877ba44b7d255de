/* mechanism.h - the mechanism that a scenario describes: the trees below robot.bodies, .contacts,
 * .points and .actuators as a stance_mechanism, and the scene that it makes. */
#ifndef STANCE_SCENARIO_MECHANISM_H
#define STANCE_SCENARIO_MECHANISM_H

#include "engine/mechanism.h"

struct reader;

/* The scene that the tree describes, bodies sorted parents first, or `carried` with the points that
 * it gets there; numbers as they stand there, those that axes vary marked as such. Freed by
 * stance_scene_free. NULL: problems, each of them reported. */
stance_scene *mechanism_read(struct reader *r, const stance_scene *carried);

/* What must hold of its numbers together, as they stand and at the ends of axes: something with
 * mass or inertia resists every coordinate, stops are in order. For scenarios with a mechanism,
 * after the axes. */
void mechanism_check(struct reader *r);

/* Whether two of them are the same but for their numbers. */
bool mechanism_same(const stance_mechanism *a, const stance_mechanism *b);

/* The contacts of the scene that are some elements of its mechanism, a bit each: both ends of a
 * sole. */
uint32_t mechanism_contacts(const stance_scene *scene, uint32_t elements);

/* A scene whose names are BODY, CONTACT, POINT, ACTUATOR, for documentation. NULL: no memory. */
stance_scene *mechanism_pattern(void);

#endif
