/* basin_exponent.c - the uncertainty exponent of a map and what it says, see basin_map.h. */
#include "basin_map.h"

#include <gsl/gsl_cdf.h>
#include <math.h>

const char *const basin_refusal_words[BASIN_REFUSALS] = {"",     "small", "none",
                                                         "wide", "bent",  "few"};

const char *basin_refusal_text(enum basin_refusal refusal)
{
    static const char *const text[BASIN_REFUSALS] = {
        "",
        "fewer than 96 cases along an axis of starts",
        "no boundary away from the edge of the box",
        "half of the starts are uncertain at distances that the domains are not wide enough for",
        "the share of uncertain starts is no power of the distance: log over log is not straight",
        "all of the boundary lies in one part of the box: nothing to tell its error from",
    };
    return text[refusal];
}

/* Points of log f over log e, and their least squares. */
struct line {
    int n;
    double y[BASIN_SCALES];
    double slope, scatter; /* and its standard error from the scatter about the line */
};

static void fit(struct line *line)
{
    const double middle = (line->n - 1) / 2.0;
    double mean = 0, product = 0, square = 0, misfit = 0;
    for (int k = 0; k < line->n; k++) {
        mean += line->y[k] / line->n;
        product += (k - middle) * line->y[k];
        square += (k - middle) * (k - middle);
    }
    line->slope = product / square;
    for (int k = 0; k < line->n; k++)
        misfit += pow(line->y[k] - mean - line->slope * (k - middle), 2);
    line->scatter = sqrt(misfit / (line->n - 2) / square);
}

/* Points first ... n - 1 or, with a tile, those without it; false where one has no logarithm. */
static bool take_points(const struct basin_uncertainty *u, int n, int without, struct line *line)
{
    line->n = n;
    for (int k = 0; k < n; k++) {
        const uint64_t uncertain = u->uncertain[k] - (without < 0 ? 0 : u->tile[k][without]);
        if (uncertain == 0)
            return false;
        line->y[k] = log((double)uncertain / (double)u->counted[k]) / log(2);
    }
    fit(line);
    return true;
}

/* Whether the last slope of neighbours leaves the others: a fractal's wave about their mean. */
static bool is_bent(const struct line *line)
{
    const int others = line->n - 2;
    const double mean = (line->y[others] - line->y[0]) / others;
    double square = 0;
    for (int k = 0; k < others; k++)
        square += pow(line->y[k + 1] - line->y[k] - mean, 2);
    const double last = line->y[line->n - 1] - line->y[line->n - 2];
    return fabs(last - mean) > BASIN_BEND + 2 * sqrt(square / (others - 1));
}

/* Slope of the shorter half of the distances less that of the longer half. */
static double drift_of(const struct line *line)
{
    const int half = line->n / 2, last = line->n - 1;
    return (line->y[half] - line->y[0] - line->y[last] + line->y[last - half]) / half;
}

/* Standard error by the jackknife over tiles, of what there is without each; NAN: one of them has
 * all of the boundary. */
static double jackknife_error(const double without[BASIN_TILES])
{
    double mean = 0, squares = 0;
    for (int tile = 0; tile < BASIN_TILES; tile++) {
        const double step = without[tile] - mean;
        mean += step / (tile + 1); /* Welford's recurrence */
        squares += step * step * tile / (tile + 1);
    }
    return sqrt(squares * (BASIN_TILES - 1) / BASIN_TILES);
}

static double tiles_error(const struct basin_uncertainty *u, int n)
{
    double slope[BASIN_TILES];
    for (int tile = 0; tile < BASIN_TILES; tile++) {
        struct line without;
        slope[tile] = take_points(u, n, tile, &without) ? without.slope : NAN;
    }
    return jackknife_error(slope);
}

struct basin_exponent basin_exponent(const struct basin_uncertainty *u)
{
    struct basin_exponent exponent = {NAN, NAN, 0, BASIN_SMALL};
    for (int n = u->scales; n >= BASIN_LEAST_SCALES; n--) {
        struct line line;
        if (!take_points(u, n, -1, &line)) {
            exponent.refusal = BASIN_NONE;
        } else if (2 * u->uncertain[n - 1] >= u->counted[n - 1]) {
            exponent.refusal = BASIN_WIDE;
        } else if (is_bent(&line) || fabs(drift_of(&line)) > BASIN_DRIFT) {
            exponent.refusal = BASIN_BENT;
        } else {
            const double slope = line.slope, tiles = tiles_error(u, n);
            if (isnan(tiles)) {
                exponent.refusal = BASIN_FEW;
                continue;
            }
            const double own =
                hypot(hypot(line.scatter, 2 * drift_of(&line)), BASIN_WAVE * fmax(0, 1 - slope));
            return (struct basin_exponent){slope, hypot(tiles, own), n, BASIN_FITTED};
        }
    }
    return exponent;
}

/* ---- fractal or not ----------------------------------------------------------------------- */

bool basin_is_fractal(const struct basin_entropy *entropy,
                      const struct basin_uncertainty *uncertainty)
{
    const struct basin_exponent exponent = basin_exponent(uncertainty);
    const double student = gsl_cdf_tdist_Pinv(0.975, BASIN_TILES - 1);
    double without[BASIN_TILES];
    for (int tile = 0; tile < BASIN_TILES; tile++)
        without[tile] = (entropy->sum - entropy->tile_sum[tile]) /
                        (double)(entropy->mixed - entropy->tile_mixed[tile]);
    const double error = jackknife_error(without);
    return basin_boundary_entropy(entropy) - student * error > log(2) &&
           exponent.alpha + student * exponent.error < 1; /* false for NAN */
}
