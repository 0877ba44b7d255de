/* search_plan.c - see search_plan.h. */
#include "search_plan.h"
#include "cma.h"
#include "elsewhere.h"

#include "runner/base/units.h"

#include <math.h>

int search_plan_lambda(const struct search *search, int restart)
{
    return cma_default_lambda(search->space.n) << restart;
}

int search_lambda(const struct search *search)
{
    return search_plan_lambda(search, search->scenario->search.restarts);
}

size_t search_plan_generations(const struct search *search, int restart, int stage)
{
    const struct scenario *const s = search->scenario;
    const double all = (double)s->search.candidates / search_plan_lambda(search, restart);
    const double before = stage > 0 ? round(scenario_search_until(s, stage - 1) * all) : 0;
    return (size_t)fmax(1, round(scenario_search_until(s, stage) * all) - before);
}

size_t search_plan_stale(const struct search *search, int restart)
{
    return 10 + (size_t)(30 * search->space.n / search_plan_lambda(search, restart));
}

double search_plan_cases_at_end(const struct search *search)
{
    const struct scenario *const s = search->scenario;
    double elsewhere = 0;
    for (int e = 0; e < ELSEWHERE_MOST; e++)
        elsewhere += elsewhere_exists(s, (enum elsewhere)e) ? 1 : 0;
    const double confirmed = 1 + 2.0 * s->search.stages * (s->search.restarts + 1);
    const double starts =
        (double)trials_count(s, TRIALS_CHOICE) + (double)trials_count(s, TRIALS_FRESH);
    return confirmed * (double)search->trials.circumstances * starts +
           elsewhere * SEARCH_COMPARED * (double)elsewhere_starts(s);
}

double search_plan_cases_of_stage(const struct search *search, int restart, int stage)
{
    return (double)search_plan_generations(search, restart, stage) *
           search_plan_lambda(search, restart) * (double)search->trials.circumstances *
           (double)search->scenario->search.grow[stage];
}

double search_plan_cases_behind(const struct search *search, int restart, int stage)
{
    double cases = search_plan_cases_at_end(search);
    for (int r = restart; r <= search->scenario->search.restarts; r++)
        for (int k = r == restart ? stage + 1 : 0; k < search->scenario->search.stages; k++)
            cases += search_plan_cases_of_stage(search, r, k);
    return cases;
}

static const double remembered = 0.6; /* of what was known, each time more is */

void outlook_begin(struct outlook *outlook, double cases)
{
    outlook->ahead = fmax(0, outlook->ahead - cases);
    outlook->now = cases;
    outlook->begun = clock_seconds();
}

void outlook_end(struct outlook *outlook, double simulated, double apart)
{
    const double taken = clock_seconds() - outlook->begun - apart;
    outlook->seconds = remembered * outlook->seconds + taken;
    outlook->cases = remembered * outlook->cases + simulated;
    outlook->now = 0;
}

double outlook_left(const struct outlook *outlook)
{
    if (!(outlook->cases > 0))
        return -1;
    const double each = outlook->seconds / outlook->cases;
    const double spent = outlook->now > 0 ? clock_seconds() - outlook->begun : 0;
    return outlook->ahead * each + fmax(0, outlook->now * each - spent);
}
