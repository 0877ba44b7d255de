/* basin_descend.c - see basin_descend.h. */
#include "basin_descend.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define WIDEST 0.2   /* angle of the rays that give the normal at first, rad */
#define FINEST 0.005 /* ... in the end */
#define SHARP 1e-4   /* relative width of the bracket of the end */
#define LESS 1e-3    /* what is not shorter by this is not sought */

enum { ROUNDS = 60, HALVES = 4, RAYS = 2 * DESCEND_DIMENSIONS, PROBES = 32, RESTARTS = 8 };

/* The set ends along u between low, inside, and high, which is not. */
struct ray {
    double u[DESCEND_DIMENSIONS], low, high;
};

struct descent {
    const struct descend_set *set;
    uint64_t random, asked;
    bool broken;
    double *z;    /* [most][n] of the points that are asked for together */
    bool *inside; /* [most] */
};

static double middle(const struct ray *ray)
{
    return isfinite(ray->high) ? 0.5 * (ray->low + ray->high) : INFINITY;
}

static bool ask(struct descent *d, size_t count)
{
    d->asked += count;
    d->broken = d->broken || !d->set->ask(d->set->context, count, d->z, d->inside);
    return !d->broken;
}

/* ---- where rays end ----------------------------------------------------------------------- */

/* The next distance to ask for: first the guess, from there with growing steps to a bracket, which
 * is halved. */
static double next_place(const struct ray *ray, double guess, double *step)
{
    double place = 0.5 * (ray->low + ray->high);
    if (ray->low == 0 && !isfinite(ray->high))
        return guess;
    if (!isfinite(ray->high))
        place = ray->low * (1 + *step);
    else if (ray->low == 0 && *step < 0.7)
        place = ray->high * (1 - *step);
    *step *= 2;
    return place;
}

static bool is_settled(const struct descent *d, const struct ray *ray, double width)
{
    return isfinite(ray->high) ? ray->high - ray->low <= width * ray->high || ray->high < 1e-12
                               : ray->low >= d->set->most;
}

/* Finds the ends of rays near a distance to a relative width, all of them in step. An end beyond
 * set->most is infinite. */
static bool end_rays(struct descent *d, struct ray *ray, size_t count, double guess, double width)
{
    const int n = d->set->n;
    double step[RAYS], place[RAYS];
    size_t which[RAYS], open;
    guess = guess > 0 && guess < d->set->most ? guess : 0.5 * d->set->most;
    for (size_t k = 0; k < count; k++) {
        ray[k].low = 0;
        ray[k].high = INFINITY;
        step[k] = 2 * width;
    }
    do {
        open = 0;
        for (size_t k = 0; k < count; k++) {
            if (is_settled(d, &ray[k], width))
                continue;
            place[k] = next_place(&ray[k], guess, &step[k]);
            for (int i = 0; i < n; i++)
                d->z[open * (size_t)n + (size_t)i] = place[k] * ray[k].u[i];
            which[open++] = k;
        }
        if (open > 0 && !ask(d, open))
            return false;
        for (size_t j = 0; j < open; j++) {
            const size_t k = which[j];
            *(d->inside[j] ? &ray[k].low : &ray[k].high) = place[k];
        }
    } while (open > 0);
    return true;
}

/* ---- directions --------------------------------------------------------------------------- */

static double uniform(struct descent *d)
{
    d->random ^= d->random << 13; /* xorshift64 (Marsaglia 2003) */
    d->random ^= d->random >> 7;
    d->random ^= d->random << 17;
    return (double)(d->random >> 11) * 0x1p-53;
}

static double normal(struct descent *d)
{
    const double u = 1 - uniform(d), v = uniform(d); /* Box and Muller */
    return sqrt(-2 * log(u)) * cos(2 * M_PI * v);
}

static double dot(int n, const double *a, const double *b)
{
    double sum = 0;
    for (int i = 0; i < n; i++)
        sum += a[i] * b[i];
    return sum;
}

static bool normalise(int n, double *u)
{
    const double length = sqrt(dot(n, u, u));
    for (int i = 0; i < n; i++)
        u[i] /= length;
    return isfinite(length) && length > 0;
}

/* t[n - 1][n], orthonormal, at right angles to u: Householder's reflection that takes an axis to
 * +-u takes the others there. */
static void find_tangents(int n, const double *u, double t[][DESCEND_DIMENSIONS])
{
    int first = 0;
    for (int i = 1; i < n; i++)
        first = fabs(u[i]) > fabs(u[first]) ? i : first;
    double v[DESCEND_DIMENSIONS];
    memcpy(v, u, sizeof v);
    v[first] += u[first] >= 0 ? 1 : -1;
    const double square = dot(n, v, v);
    for (int j = 0, k = 0; j < n; j++) {
        if (j == first)
            continue;
        for (int i = 0; i < n; i++)
            t[k][i] = (i == j) - 2 * v[i] * v[j] / square;
        k++;
    }
}

/* u turned by an angle towards t. */
static void turn(int n, const double *u, const double *t, double angle, double *turned)
{
    for (int i = 0; i < n; i++)
        turned[i] = cos(angle) * u[i] + sin(angle) * t[i];
}

/* ---- downhill ----------------------------------------------------------------------------- */

/* How the distance changes by an angle, relative to it; with one end only from that side. */
static double slope(const struct ray *ahead, const struct ray *behind, double r, double angle)
{
    const double a = middle(ahead), b = middle(behind);
    return isfinite(a) && isfinite(b) ? (a - b) / (2 * angle * r)
           : isfinite(a)              ? (a - r) / (angle * r)
           : isfinite(b)              ? (r - b) / (angle * r)
                                      : 0;
}

/* From the best ray to a shorter one, by the normal of the surface; the angle it has turned, 0:
 * there is none. */
static double step_down(struct descent *d, struct ray *best, double angle)
{
    const int n = d->set->n;
    double t[DESCEND_DIMENSIONS][DESCEND_DIMENSIONS], aim[DESCEND_DIMENSIONS];
    struct ray ray[RAYS] = {{{0}, 0, 0}};
    const double r = middle(best);

    find_tangents(n, best->u, t);
    for (int j = 0; j + 1 < n; j++) {
        turn(n, best->u, t[j], angle, ray[2 * j].u);
        turn(n, best->u, t[j], -angle, ray[2 * j + 1].u);
    }
    if (!end_rays(d, ray, 2 * (size_t)(n - 1), r, fmax(0.1 * angle * angle, SHARP)))
        return 0;
    memcpy(aim, best->u, sizeof aim);
    struct ray shortest = *best;
    for (int j = 0; j + 1 < n; j++) {
        const double g = slope(&ray[2 * j], &ray[2 * j + 1], r, angle);
        for (int i = 0; i < n; i++)
            aim[i] -= g * t[j][i];
        for (int side = 0; side < 2; side++)
            shortest =
                middle(&ray[2 * j + side]) < middle(&shortest) ? ray[2 * j + side] : shortest;
    }
    for (int half = 0; half < HALVES && normalise(n, aim); half++) {
        struct ray next;
        memcpy(next.u, aim, sizeof next.u);
        if (!end_rays(d, &next, 1, r, SHARP))
            return 0;
        if (middle(&next) < fmin(middle(&shortest), r * (1 - 1e-9))) {
            const double turned = acos(fmin(1, dot(n, best->u, next.u)));
            *best = next;
            return turned;
        }
        for (int i = 0; i < n; i++)
            aim[i] = aim[i] + best->u[i];
    }
    if (middle(&shortest) >= r * (1 - LESS) ||
        !end_rays(d, &shortest, 1, middle(&shortest), SHARP) || middle(&shortest) >= r)
        return 0;
    *best = shortest;
    return angle;
}

/* Whether some point that is shorter by LESS is outside; *best is the first such ray then. */
static bool probe(struct descent *d, struct ray *best)
{
    const int n = d->set->n;
    const size_t probes = PROBES * (size_t)n;
    const double r = best->low * (1 - LESS);
    for (size_t k = 0; k < probes; k++) {
        double t[DESCEND_DIMENSIONS], *z = d->z + k * (size_t)n;
        for (int i = 0; i < n; i++)
            t[i] = normal(d);
        const double along = dot(n, t, best->u);
        for (int i = 0; i < n; i++)
            t[i] -= along * best->u[i];
        normalise(n, t);
        turn(n, best->u, t, exp(log(FINEST) + uniform(d) * log(1 / FINEST)), z);
        for (int i = 0; i < n; i++)
            z[i] *= r;
    }
    if (!ask(d, probes))
        return false;
    for (size_t k = 0; k < probes; k++) {
        if (!d->inside[k]) {
            struct ray next = {.low = 0};
            for (int i = 0; i < n; i++)
                next.u[i] = d->z[k * (size_t)n + (size_t)i] / r;
            if (!end_rays(d, &next, 1, r * (1 - LESS), SHARP) || middle(&next) >= r)
                return false;
            *best = next;
            return true;
        }
    }
    return false;
}

static void descend(struct descent *d, struct ray *best)
{
    for (int restart = 0; d->set->n > 1 && restart < RESTARTS; restart++) {
        double angle = WIDEST;
        for (int round = 0; round < ROUNDS && angle >= FINEST && !d->broken; round++) {
            const double turned = step_down(d, best, angle);
            angle = turned > 0 ? fmin(angle, fmax(turned, 0.3 * angle)) : angle / 3;
        }
        if (d->broken || !probe(d, best))
            return;
    }
}

bool basin_descend(const struct descend_set *set, const double *start, const double *r,
                   size_t starts, struct descend_end *end)
{
    const size_t n = (size_t)set->n, most = PROBES * n > RAYS ? PROBES * n : RAYS;
    struct descent d = {.set = set,
                        .random = 0x9e3779b97f4a7c15u,
                        .z = malloc(most * n * sizeof *d.z),
                        .inside = malloc(most * sizeof *d.inside)};
    double found[DESCEND_STARTS] = {0};
    struct ray best = {.high = INFINITY};
    bool good = d.z && d.inside;

    for (size_t k = 0; good && k < starts; k++) {
        struct ray own = {.low = 0};
        memcpy(own.u, start + k * n, n * sizeof *start);
        good = end_rays(&d, &own, 1, r[k], SHARP);
        if (good && isfinite(own.high))
            descend(&d, &own);
        good = good && !d.broken;
        found[k] = middle(&own);
        best = middle(&own) < middle(&best) ? own : best;
    }
    *end = (struct descend_end){
        .low = best.low, .high = best.high, .starts = starts, .asked = d.asked};
    memcpy(end->u, best.u, sizeof end->u);
    for (size_t k = 0; good && k < starts; k++)
        end->agree += found[k] <= 1.01 * middle(&best);
    free(d.z);
    free(d.inside);
    return good;
}

double basin_descend_unseen(size_t starts)
{
    return 1 - pow(0.05, 1 / (double)starts);
}
