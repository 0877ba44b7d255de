/* linear_limit.c - starts of a candidate against the null-controllable set of its robot. */
#include "linear_limit.h"

#include "runner/plan/allowed.h"

#include <math.h>

static double share_in(const struct trials *t, size_t circumstance, uint64_t starts)
{
    struct allowed allowed;
    stance_message ignored;
    uint64_t inside = 0;
    if (!allowed_make(&allowed, t->at, circumstance * starts, &ignored))
        return NAN;
    for (uint64_t i = 0; allowed.set && i < starts; i++)
        inside += allowed_case(&allowed, t->at, circumstance * starts + i);
    const double share = allowed.set ? (double)inside / (double)starts : NAN;
    allowed_free(&allowed);
    return share;
}

double linear_limit_overall(bool worst, size_t circumstances, const double *share, size_t *least)
{
    double sum = 0;
    *least = circumstances;
    for (size_t c = 0; c < circumstances; c++) {
        sum += share[c];
        if (!isnan(share[c]) && (*least == circumstances || share[c] < share[*least]))
            *least = c;
    }
    if (worst && circumstances > 1)
        return *least < circumstances ? share[*least] : NAN;
    *least = circumstances;
    return sum / (double)circumstances;
}

void linear_limit_shares(struct trials *t, double *value, uint64_t starts, double *share)
{
    struct scenario_axis *const candidate = &t->at->axis[0];
    struct scenario_axis *const sample = &t->at->axis[t->at->axes - 1];
    candidate->value = value;
    candidate->count = 1;
    sample->value = t->start[TRIALS_FRESH];
    sample->count = starts;
    for (size_t c = 0; c < t->circumstances; c++)
        share[c] = scenario_law(&t->scenario->base)->designed ? share_in(t, c, starts) : NAN;
    candidate->value = NULL;
    sample->value = NULL;
}
