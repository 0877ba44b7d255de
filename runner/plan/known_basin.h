/* known_basin.h - the captured set of a design (stop.capture estimated): what is asked of the
 * engine and what is kept of its answer. */
#ifndef STANCE_PLAN_KNOWN_BASIN_H
#define STANCE_PLAN_KNOWN_BASIN_H

#include "resolve.h"

#include "engine/control/design.h"

enum {
    KNOWN_BASIN_BOUNDARY = 10000, /* simulations from the boundary that must all be good */
    KNOWN_BASIN_INTERIOR = 1000,  /* and from inside */
    KNOWN_BASIN_USUAL =
        26000, /* simulations in all, the search included: what it takes as a rule */
    KNOWN_BASIN_BOUNDS = 2 * STANCE_MAX_ACTUATORS + 3,
};

/* Cases are captured in a set this much smaller than the confirmed one: share of the level. */
#define KNOWN_BASIN_SAFETY 0.8

/* Half spaces a X <= d in which the linear picture meets no bound, X the departure from the
 * equilibrium: a[KNOWN_BASIN_BOUNDS][2 postures], each torque up and down, the friction cone
 * forward and backward, lift-off. K[actuators][2 postures]; 2 actuators + 3 bounds are written. */
stance_error known_basin_bounds(const stance_scene *scene, const struct scenario_values *values,
                                const double *model, const stance_equilibrium *equilibrium,
                                const double *K, double *a, double *d);

/* The search for the set of a design and one row of values, whose initial state does not matter.
 * The simulations last half of stop.time, so that there is time left for whoever is captured in the
 * first half. false: `message` says why there can be no set. */
bool known_basin_prepare(const stance_scene *scene, const struct scenario_values *values,
                         const struct resolved_design *design, uint64_t seed,
                         stance_known_basin_search *search, stance_message *message);

/* Text of candidate `shape` of a prepared search. */
const char *known_basin_shape_text(int shape, char text[96]);

/* Estimates the set and keeps it in the design, which is left without where there is none. false:
 * no memory, or `stop`, asked about every millisecond, said true; the message is empty then. *set
 * and `stop` may be NULL. */
bool known_basin_estimate(const stance_scene *scene, const struct scenario_values *values,
                          struct resolved_design *design, uint64_t seed,
                          bool (*stop)(void *context), void *context, stance_known_basin *set,
                          stance_message *message);

#endif
