/* space.h - the numbers that a search varies, each in a unit of its own. */
#ifndef STANCE_OPTIMISE_SPACE_H
#define STANCE_OPTIMISE_SPACE_H

#include "runner/scenario/scenario.h"

#include <stdbool.h>

/* Number k is y unit, exp(y unit) or -exp(y unit), y its coordinate. */
struct space {
    int n;
    const struct scenario_search *search;
    double unit[SCENARIO_MAX_PATHS];
    double first[SCENARIO_MAX_PATHS];                         /* coordinates of the scenario */
    double low[SCENARIO_MAX_PATHS], high[SCENARIO_MAX_PATHS]; /* of coordinates */
    bool gain[SCENARIO_MAX_PATHS];
};

/* Of a scenario whose gains, if they are varied, are given. */
void space_make(struct space *space, const struct scenario *s);
/* The value of number k at a coordinate. */
double space_value(const struct space *space, int k, double y);
/* The gains' root mean square, in their units; 0 where none is varied. */
double space_gain(const struct space *space, const double *y);

#endif
