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

struct descent {
    const struct descend_set *of;
    struct descend_set set; /* the same, whose points are counted */
    double most;
    uint64_t random, asked;
    bool broken;
    double *z;    /* [PROBES n][n] of the points that are asked for together */
    uint8_t *end; /* [PROBES n] */
};

static double middle(const struct descend_ray *ray)
{
    return isfinite(ray->high) ? 0.5 * (ray->low + ray->high) : INFINITY;
}

static bool is_inside(const struct descend_set *set, uint8_t end)
{
    return set->inside >> end & 1;
}

/* ---- where rays end ----------------------------------------------------------------------- */

static double next_place(const struct descend_ray *ray, const struct descend_way *way, double *step)
{
    const double most = way->hastens ? INFINITY : ray->most;
    double place = 0.5 * (ray->low + ray->high);
    if (ray->low == 0 && !isfinite(ray->high))
        return fmin(most, way->first);
    if (!isfinite(ray->high))
        place = fmin(most, fmax(way->first, ray->low * (1 + *step)));
    else if (ray->low == 0 && way->hastens && *step < 0.7)
        place = ray->high * (1 - *step);
    *step *= way->hastens ? 2 : 1;
    return place;
}

static bool is_settled(const struct descend_ray *ray, const struct descend_way *way)
{
    return isfinite(ray->high)
               ? ray->high - ray->low <= way->width * ray->high || ray->high < way->least
               : ray->low >= ray->most;
}

bool descend_rays(const struct descend_set *set, const struct descend_way *way,
                  struct descend_ray *ray, size_t count)
{
    const size_t n = (size_t)set->n;
    double *const z = malloc((count * (n + 2) + 1) * sizeof *z), *const place = z + count * n,
                  *const step = place + count;
    size_t *const which = malloc((count + 1) * sizeof *which), open;
    uint8_t *const end = malloc(count + 1);
    bool good = z && which && end;
    for (size_t k = 0; good && k < count; k++) {
        ray[k].low = 0;
        ray[k].high = INFINITY;
        step[k] = way->step;
    }
    do {
        open = 0;
        for (size_t k = 0; good && k < count; k++) {
            if (is_settled(&ray[k], way))
                continue;
            place[open] = next_place(&ray[k], way, &step[k]);
            for (size_t i = 0; i < n; i++)
                z[open * n + i] = place[open] * ray[k].v[i];
            which[open++] = k;
        }
        good = good && (open == 0 || set->ask(set->context, open, z, end));
        for (size_t j = 0; good && j < open; j++) {
            struct descend_ray *const own = &ray[which[j]];
            *(is_inside(set, end[j]) ? &own->low : &own->high) = place[j];
            if (!is_inside(set, end[j]))
                own->beyond = end[j];
        }
    } while (good && open > 0);
    free(z);
    free(which);
    free(end);
    return good;
}

/* Near a guess, to a relative width. */
static bool end_rays(struct descent *d, struct descend_ray *ray, size_t count, double guess,
                     double width)
{
    const double first = guess > 0 && guess < d->most ? guess : 0.5 * d->most;
    for (size_t k = 0; k < count; k++)
        ray[k].most = d->most;
    d->broken = d->broken ||
                !descend_rays(&d->set, &(struct descend_way){first, 2 * width, true, width, 1e-12},
                              ray, count);
    return !d->broken;
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
static double slope(const struct descend_ray *ahead, const struct descend_ray *behind, double r,
                    double angle)
{
    const double a = middle(ahead), b = middle(behind);
    return isfinite(a) && isfinite(b) ? (a - b) / (2 * angle * r)
           : isfinite(a)              ? (a - r) / (angle * r)
           : isfinite(b)              ? (r - b) / (angle * r)
                                      : 0;
}

/* From the best ray to a shorter one, by the normal of the surface; the angle it has turned, 0:
 * there is none. */
static double step_down(struct descent *d, struct descend_ray *best, double angle)
{
    const int n = d->set.n;
    double t[DESCEND_DIMENSIONS][DESCEND_DIMENSIONS], aim[DESCEND_DIMENSIONS];
    struct descend_ray ray[RAYS] = {{.low = 0}};
    const double r = middle(best);

    find_tangents(n, best->v, t);
    for (int j = 0; j + 1 < n; j++) {
        turn(n, best->v, t[j], angle, ray[2 * j].v);
        turn(n, best->v, t[j], -angle, ray[2 * j + 1].v);
    }
    if (!end_rays(d, ray, 2 * (size_t)(n - 1), r, fmax(0.1 * angle * angle, SHARP)))
        return 0;
    memcpy(aim, best->v, sizeof aim);
    struct descend_ray shortest = *best;
    for (int j = 0; j + 1 < n; j++) {
        const double g = slope(&ray[2 * j], &ray[2 * j + 1], r, angle);
        for (int i = 0; i < n; i++)
            aim[i] -= g * t[j][i];
        for (int side = 0; side < 2; side++)
            shortest =
                middle(&ray[2 * j + side]) < middle(&shortest) ? ray[2 * j + side] : shortest;
    }
    for (int half = 0; half < HALVES && normalise(n, aim); half++) {
        struct descend_ray next;
        memcpy(next.v, aim, sizeof next.v);
        if (!end_rays(d, &next, 1, r, SHARP))
            return 0;
        if (middle(&next) < fmin(middle(&shortest), r * (1 - 1e-9))) {
            const double turned = acos(fmin(1, dot(n, best->v, next.v)));
            *best = next;
            return turned;
        }
        for (int i = 0; i < n; i++)
            aim[i] = aim[i] + best->v[i];
    }
    if (middle(&shortest) >= r * (1 - LESS) ||
        !end_rays(d, &shortest, 1, middle(&shortest), SHARP) || middle(&shortest) >= r)
        return 0;
    *best = shortest;
    return angle;
}

/* Whether some point that is shorter by LESS is outside; *best is the first such ray then. */
static bool probe(struct descent *d, struct descend_ray *best)
{
    const int n = d->set.n;
    const size_t probes = PROBES * (size_t)n;
    const double r = best->low * (1 - LESS);
    for (size_t k = 0; k < probes; k++) {
        double t[DESCEND_DIMENSIONS], *z = d->z + k * (size_t)n;
        for (int i = 0; i < n; i++)
            t[i] = normal(d);
        const double along = dot(n, t, best->v);
        for (int i = 0; i < n; i++)
            t[i] -= along * best->v[i];
        normalise(n, t);
        turn(n, best->v, t, exp(log(FINEST) + uniform(d) * log(1 / FINEST)), z);
        for (int i = 0; i < n; i++)
            z[i] *= r;
    }
    d->broken = !d->set.ask(d->set.context, probes, d->z, d->end);
    if (d->broken)
        return false;
    for (size_t k = 0; k < probes; k++) {
        if (!is_inside(d->of, d->end[k])) {
            struct descend_ray next = {.low = 0};
            for (int i = 0; i < n; i++)
                next.v[i] = d->z[k * (size_t)n + (size_t)i] / r;
            if (!end_rays(d, &next, 1, r * (1 - LESS), SHARP) || middle(&next) >= r)
                return false;
            *best = next;
            return true;
        }
    }
    return false;
}

static void descend(struct descent *d, struct descend_ray *best)
{
    for (int restart = 0; d->set.n > 1 && restart < RESTARTS; restart++) {
        double angle = WIDEST;
        for (int round = 0; round < ROUNDS && angle >= FINEST && !d->broken; round++) {
            const double turned = step_down(d, best, angle);
            angle = turned > 0 ? fmin(angle, fmax(turned, 0.3 * angle)) : angle / 3;
        }
        if (d->broken || !probe(d, best))
            return;
    }
}

static bool count_and_ask(void *context, size_t count, const double *z, uint8_t *end)
{
    struct descent *const d = context;
    d->asked += count;
    return d->of->ask(d->of->context, count, z, end);
}

bool basin_descend(const struct descend_set *set, double most, const double *start, const double *r,
                   size_t starts, struct descend_end *end)
{
    const size_t n = (size_t)set->n;
    struct descent d = {.of = set,
                        .set = {set->n, set->inside, count_and_ask, &d},
                        .most = most,
                        .random = 0x9e3779b97f4a7c15u,
                        .z = malloc(PROBES * n * n * sizeof *d.z),
                        .end = malloc(PROBES * n)};
    double found[DESCEND_STARTS] = {0};
    struct descend_ray best = {.high = INFINITY};
    bool good = d.z && d.end;

    for (size_t k = 0; good && k < starts; k++) {
        struct descend_ray own = {.low = 0};
        memcpy(own.v, start + k * n, n * sizeof *start);
        good = end_rays(&d, &own, 1, r[k], SHARP);
        if (good && isfinite(own.high))
            descend(&d, &own);
        good = good && !d.broken;
        found[k] = middle(&own);
        best = middle(&own) < middle(&best) ? own : best;
    }
    *end = (struct descend_end){
        .low = best.low, .high = best.high, .starts = starts, .asked = d.asked};
    memcpy(end->u, best.v, sizeof end->u);
    for (size_t k = 0; good && k < starts; k++)
        end->agree += found[k] <= 1.01 * middle(&best);
    free(d.z);
    free(d.end);
    return good;
}

double basin_descend_unseen(size_t starts)
{
    return 1 - pow(0.05, 1 / (double)starts);
}
