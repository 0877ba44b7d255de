/* gait.c - fixed points of the return map by Newton's method, and their multipliers.
 *
 * Columns of the derivative are differences: central ones for Newton, whose steps need no more;
 * for multipliers the formula of fourth order, (8 (P(h) - P(-h)) - (P(2h) - P(-2h))) / 12 h, at two
 * steps, since the map may be strongly curved: what they differ by is the error that is told. */
#include "gait.h"

#include "runner/base/message.h"

#include <lapacke.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define NEWTON_DONE 1e-12
#define NEWTON_GOOD 1e-6 /* a residual that admits a fixed point */
enum { NEWTON_MOST = 20 };

/* Points apart from one by so many h (rad, rad/s), and their weights in the derivative times h. */
struct difference {
    double h;
    int count;
    double apart[4], weight[4];
};
static const struct difference central = {1e-4, 2, {1, -1}, {0.5, -0.5}};
#define FOURTH                                                                                     \
    4, {1, -1, 2, -2},                                                                             \
    {                                                                                              \
        8.0 / 12, -8.0 / 12, -1.0 / 12, 1.0 / 12                                                   \
    }
static const struct difference fourth[2] = {{1e-3, FOURTH}, {3e-4, FOURTH}};

struct work {
    struct return_point from[1 + 4 * RETURN_MAP_MOST], to[1 + 4 * RETURN_MAP_MOST];
    double J[RETURN_MAP_MOST * RETURN_MAP_MOST]; /* columns */
    double by[RETURN_MAP_MOST][2];               /* of time and length */
};

/* The return of z to w->to[0], and the derivatives there by those of the points beside it. */
static bool derive(const struct return_map *map, const struct return_point *z,
                   const struct difference *d, struct work *w, stance_message *message)
{
    const int n = map->n, count = d->count;
    for (int k = 0; k < 1 + count * n; k++)
        w->from[k] = *z;
    for (int j = 0; j < n; j++)
        for (int k = 0; k < count; k++)
            w->from[1 + count * j + k].z[j] += d->apart[k] * d->h;
    if (!return_map_take(map, 1 + (size_t)count * (size_t)n, w->from, w->to, message))
        return false;
    memset(w->J, 0, sizeof w->J);
    memset(w->by, 0, sizeof w->by);
    for (int j = 0; j < n; j++)
        for (int k = 0; k < count; k++) {
            const struct return_point *const p = &w->to[1 + count * j + k];
            const double weight = d->weight[k] / d->h;
            for (int i = 0; i < n; i++)
                w->J[j * n + i] += weight * p->z[i];
            w->by[j][0] += weight * p->time;
            w->by[j][1] += weight * p->length;
        }
    return true;
}

static double residual(const struct return_map *map, const double *z, const double *to)
{
    double largest = 0;
    for (int i = 0; i < map->n; i++)
        largest = fmax(largest, fabs(to[i] - z[i]));
    return largest;
}

static bool newton(const struct return_map *map, struct gait *gait, struct work *w,
                   stance_message *message)
{
    const lapack_int n = map->n;
    struct return_point at = gait->from;
    gait->residual = INFINITY;
    for (gait->iterations = 0; gait->iterations < NEWTON_MOST; gait->iterations++) {
        lapack_int pivot[RETURN_MAP_MOST];
        double move[RETURN_MAP_MOST];
        if (!derive(map, &at, &central, w, message)) {
            const stance_message why = *message;
            if (gait->residual > NEWTON_GOOD && gait->iterations > 0)
                complain(message,
                         "no gait is near: the nearest returns to within %.3g, and further on "
                         "%.140s",
                         gait->residual, why.text);
            return gait->residual <= NEWTON_GOOD;
        }
        const double now = residual(map, at.z, w->to[0].z);
        const bool better = now < gait->residual, stuck = !(now < 0.5 * gait->residual);
        if (better) {
            gait->from = at;
            gait->residual = now;
            gait->at = w->to[0];
        }
        if (now <= NEWTON_DONE || (stuck && gait->residual <= NEWTON_GOOD))
            return true;
        for (lapack_int i = 0; i < n; i++) {
            w->J[i * n + i] -= 1;
            move[i] = at.z[i] - w->to[0].z[i];
        }
        if (LAPACKE_dgesv(LAPACK_COL_MAJOR, n, 1, w->J, n, pivot, move, n) != 0)
            break;
        for (lapack_int i = 0; i < n; i++)
            at.z[i] += move[i];
    }
    if (gait->residual <= NEWTON_GOOD)
        return true;
    int worst = 0;
    char name[STANCE_NAME + 2];
    for (int i = 0; i < n; i++)
        if (fabs(gait->at.z[i] - gait->from.z[i]) > fabs(gait->at.z[worst] - gait->from.z[worst]))
            worst = i;
    return complain(message,
                    "no gait within %d iterations; the nearest returns with %s off by %.3g",
                    gait->iterations, return_map_name(map, worst, name), gait->residual);
}

/* Eigenvalues of w->J, the largest first. */
static bool multipliers(const struct return_map *map, struct work *w, double *re, double *im)
{
    const lapack_int n = map->n;
    if (LAPACKE_dgeev(LAPACK_COL_MAJOR, 'N', 'N', n, w->J, n, re, im, NULL, 1, NULL, 1) != 0)
        return false;
    for (lapack_int i = 1; i < n; i++)
        for (lapack_int k = i; k > 0 && hypot(re[k], im[k]) > hypot(re[k - 1], im[k - 1]); k--) {
            const double a = re[k], b = im[k];
            re[k] = re[k - 1], im[k] = im[k - 1];
            re[k - 1] = a, im[k - 1] = b;
        }
    return true;
}

static bool judge(const struct return_map *map, struct gait *gait, struct work *w,
                  stance_message *message)
{
    double re[2][RETURN_MAP_MOST], im[2][RETURN_MAP_MOST];
    for (int k = 0; k < 2; k++) {
        if (!derive(map, &gait->from, &fourth[k], w, message))
            return false;
        memcpy(gait->J, w->J, sizeof gait->J);
        memcpy(gait->by, w->by, sizeof gait->by);
        if (!multipliers(map, w, re[k], im[k]))
            return complain(message, "its multipliers do not converge");
    }
    gait->stable = true;
    for (int i = 0; i < map->n; i++) {
        gait->re[i] = re[1][i], gait->im[i] = im[1][i];
        gait->error[i] = INFINITY;
        for (int k = 0; k < map->n; k++)
            gait->error[i] = fmin(gait->error[i], hypot(re[1][i] - re[0][k], im[1][i] - im[0][k]));
        gait->stable = gait->stable && hypot(re[1][i], im[1][i]) + gait->error[i] < 1;
    }
    return true;
}

int gait_repeats(const struct return_map *map, const struct gait *gait)
{
    struct return_map part = *map;
    struct return_point to;
    stance_message ignored;
    for (part.steps = 1; part.steps < map->steps; part.steps++)
        if (map->steps % part.steps == 0 && return_map_change(&part, &map->base, &ignored) &&
            return_map_take(&part, 1, &gait->from, &to, &ignored) &&
            residual(map, gait->from.z, to.z) <= NEWTON_GOOD)
            break;
    return part.steps;
}

bool gait_find(const struct return_map *map, const struct return_point *from, struct gait *gait,
               stance_message *message)
{
    struct work *const w = calloc(1, sizeof *w);
    if (!w)
        return complain(message, "out of memory");
    *gait = (struct gait){.from = *from};
    const bool found = newton(map, gait, w, message) && judge(map, gait, w, message);
    free(w);
    return found;
}
