/* search_plan.h - what a search will do: generations of its stages, cases that they take,
 * and how long that will be. */
#ifndef STANCE_OPTIMISE_SEARCH_PLAN_H
#define STANCE_OPTIMISE_SEARCH_PLAN_H

#include "search.h"

enum { SEARCH_COMPARED = 2 }; /* elsewhere: the first and the chosen one */

/* Candidates in a generation of a beginning; of the last one. */
int search_plan_lambda(const struct search *search, int restart);
int search_lambda(const struct search *search);
size_t search_plan_generations(const struct search *search, int restart, int stage);
/* Generations of the last stage without a better candidate after which there is no use in more. */
size_t search_plan_stale(const struct search *search, int restart);
/* What will be simulated at most once all generations are through: the best, to choose and to
 * report. */
double search_plan_cases_at_end(const struct search *search);
/* Cases of a stage's generations. */
double search_plan_cases_of_stage(const struct search *search, int restart, int stage);
/* Cases that are planned from a stage on, that one not counted. */
double search_plan_cases_behind(const struct search *search, int restart, int stage);

/* Cases in hand, which were planned. */
void outlook_begin(struct outlook *outlook, double cases);
/* They are done: so many were simulated; `apart` s were spent on something else. */
void outlook_end(struct outlook *outlook, double simulated, double apart);
/* s; negative: not known yet. */
double outlook_left(const struct outlook *outlook);

#endif
