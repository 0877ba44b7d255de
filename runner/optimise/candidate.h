/* candidate.h - what a search varies, each number in a unit of its own, and what a candidate is as
 * a scenario. */
#ifndef STANCE_OPTIMISE_CANDIDATE_H
#define STANCE_OPTIMISE_CANDIDATE_H

#include "runner/store/search_file.h"

#include "runner/scenario/scenario.h"

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

/* The text of the scenario with the gains of its design written out, where the search varies them;
 * freed by the caller. NULL: *message says why, such as that no design exists. */
char *best_first(const struct scenario *s, stance_message *message);

/* The scenario with the chosen candidate's numbers and without its section optimise, an ordinary
 * one; freed by the caller. NULL: no memory, or a damaged text. */
char *best_text(const struct search_file *f);
/* Writes it. */
bool best_write(const struct search_file *f, const char *file, stance_message *message);

#endif
