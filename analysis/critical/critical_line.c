/* critical_line.c - the number and its interval from one line of values. */
#include "critical.h"

#include <gsl/gsl_cdf.h>
#include <gsl/gsl_randist.h>
#include <math.h>

const char *const critical_end_words[CRITICAL_ENDS] = {"lost", "kept", "outside", "unknown"};

/* So many of the points are to be lost for the outcome to be. */
static uint32_t needed(const struct critical_line *line, const struct critical_choice *choice)
{
    return (uint32_t)floor((1 - choice->share) * line->points + 1e-9) + 1;
}

/* The first place by which so many are lost, or may be; count: there is none. */
static size_t first_lost(const struct critical_line *line, uint32_t points, bool surely)
{
    size_t i = 0;
    while (i < line->count && (surely ? line->gone : line->maybe)[i] < points)
        i++;
    return i;
}

/* The last value before a place. */
static double value_before(const struct critical_line *line, size_t place)
{
    return place > 0 ? line->value[place - 1] : NAN;
}

static double value_at(const struct critical_line *line, size_t place)
{
    return place < line->count ? line->value[place] : NAN;
}

/* ---- the interval ------------------------------------------------------------------------- */

/* Where the quantile q of a population lies below (above: or above) with a probability of `tail`,
 * as a place among n order statistics: 2.3 is three tenths of the way from the second to the third.
 * With B of the n below the quantile, binomial, it is between number B and the next; given that, it
 * splits the gap as two exponential variables of the rates B / q and (n - B) / (1 - q) would. NAN:
 * beyond the first or the last. */
static double rank_of(unsigned n, double q, double tail, bool above)
{
    unsigned r = 0;
    /* The last number that is below often enough, or the last one not above often enough. */
    while (r < n &&
           (above ? gsl_cdf_binomial_Q(r, q, n) > tail : gsl_cdf_binomial_P(r, q, n) <= tail))
        r++;
    if (above ? r == n : r == 0)
        return NAN;
    const double at = gsl_ran_binomial_pdf(r, q, n);
    /* Given B = r, the end is to be on its side of the quantile with this probability. */
    const double part = above ? 1 - (tail - gsl_cdf_binomial_Q(r, q, n)) / at
                              : (gsl_cdf_binomial_P(r, q, n) - tail) / at;
    const double rates = r * (1 - q) / ((n - r) * q), odds = part / (1 - part);
    return r + 1 / (1 + rates * (above ? 1 / odds : odds));
}

/* The value at a place among order statistics: a lower end has all values before it kept. */
static double at_rank(const struct critical_line *line, double rank, bool above)
{
    const uint32_t r = (uint32_t)rank;
    const double part = rank - r;
    double value[2];
    for (uint32_t k = 0; k < 2; k++) {
        const size_t place = first_lost(line, r + k, above);
        value[k] = above ? value_at(line, place) : value_before(line, place);
    }
    return part > 0 ? (1 - part) * value[0] + part * value[1] : value[0];
}

static void find_interval(const struct critical_line *line, const struct critical_choice *choice,
                          struct critical_value *found)
{
    const double tail = 0.5 * (1 - choice->level);
    double low, high;
    if (!(choice->share < 1)) {
        found->least_share = pow(1 - choice->level, 1.0 / line->points);
        return;
    }
    low = rank_of(line->points, 1 - choice->share, tail, false);
    high = rank_of(line->points, 1 - choice->share, tail, true);
    found->low = isnan(low) ? NAN : at_rank(line, low, false);
    found->high = isnan(high) ? NAN : at_rank(line, high, true);
}

/* ---- the number --------------------------------------------------------------------------- */

struct critical_value critical_find(const struct critical_line *line,
                                    const struct critical_choice *choice)
{
    const uint32_t points = needed(line, choice);
    const size_t before = first_lost(line, points, false), after = first_lost(line, points, true);
    struct critical_value found = {.kept = value_before(line, before),
                                   .lost = value_at(line, after),
                                   .after = after,
                                   .unknown = after - before,
                                   .low = NAN,
                                   .high = NAN,
                                   .least_share = NAN};
    found.end = before == line->count  ? CRITICAL_KEPT
                : after == line->count ? CRITICAL_UNKNOWN
                : after == 0           ? CRITICAL_OUTSIDE
                                       : CRITICAL_LOST;
    if (line->points > 1) {
        find_interval(line, choice, &found);
    } else {
        found.low = found.kept;
        found.high = found.lost;
    }
    return found;
}

bool critical_next_island(const struct critical_line *line, const struct critical_choice *choice,
                          size_t *at, struct critical_island *island)
{
    const uint32_t points = needed(line, choice);
    size_t i = *at, end;
    while (i < line->count && line->out[i] >= points)
        i++;
    for (end = i; end < line->count && line->out[end] < points;)
        end++;
    *at = end;
    if (i == line->count)
        return false;
    *island = (struct critical_island){{value_before(line, i), line->value[i]},
                                       {line->value[end - 1], value_at(line, end)}};
    return true;
}
