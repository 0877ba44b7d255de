/* gait.c - fixed points of the return map by Newton's method, and their multipliers.
 *
 * Columns of the derivative are differences: central ones for Newton, whose steps need no more;
 * for multipliers the formula of fourth order, (8 (P(h) - P(-h)) - (P(2h) - P(-2h))) / 12 h, at two
 * steps, since the map may be strongly curved: what they differ by is the error that is told. */
#include "return_map.h"

#include <lapacke.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define NEWTON_STEP 1e-4 /* rad, rad/s */
#define NEWTON_DONE 1e-12
#define NEWTON_GOOD 1e-6 /* a residual that admits a fixed point */
enum { NEWTON_MOST = 20 };
static const double steps[2] = {1e-3, 3e-4};

struct work {
    double z[1 + 4 * RETURN_MAP_MOST][RETURN_MAP_MOST];
    struct return_point point[1 + 4 * RETURN_MAP_MOST];
    double J[RETURN_MAP_MOST * RETURN_MAP_MOST]; /* columns */
    double by[RETURN_MAP_MOST][2];               /* of time and length */
};

/* The point z and, beside it in each coordinate, `apart` times h. */
static size_t place(const struct return_map *map, const double *z, double h, const int *apart,
                    size_t count, struct work *w)
{
    const size_t n = (size_t)map->n;
    for (size_t k = 0; k < 1 + count * n; k++)
        memcpy(w->z[k], z, sizeof w->z[k]);
    for (size_t j = 0; j < n; j++)
        for (size_t k = 0; k < count; k++)
            w->z[1 + count * j + k][j] += apart[k] * h;
    return 1 + count * n;
}

/* J by points apart, with weights over h. */
static void derive(const struct return_map *map, double h, const double *weight, size_t count,
                   struct work *w)
{
    const size_t n = (size_t)map->n;
    memset(w->J, 0, sizeof w->J);
    memset(w->by, 0, sizeof w->by);
    for (size_t j = 0; j < n; j++)
        for (size_t k = 0; k < count; k++) {
            const struct return_point *const p = &w->point[1 + count * j + k];
            for (size_t i = 0; i < n; i++)
                w->J[j * n + i] += weight[k] / h * p->z[i];
            w->by[j][0] += weight[k] / h * p->time;
            w->by[j][1] += weight[k] / h * p->length;
        }
}

static double residual(const struct return_map *map, const double *z, const double *to)
{
    double largest = 0;
    for (int i = 0; i < map->n; i++)
        largest = fmax(largest, fabs(to[i] - z[i]));
    return largest;
}

/* Says of a point on Newton's way that it is not of the start. */
static bool strayed(const struct gait *gait, stance_message *message)
{
    char why[sizeof message->text];
    snprintf(why, sizeof why, "%s", message->text);
    snprintf(message->text, sizeof message->text,
             "no gait is near: the nearest returns to within %.3g, and further on %.140s",
             gait->residual, why);
    return false;
}

static bool newton(const struct return_map *map, struct gait *gait, struct work *w,
                   stance_message *message)
{
    static const int apart[] = {1, -1};
    static const double weight[] = {0.5, -0.5};
    const lapack_int n = map->n;
    double z[RETURN_MAP_MOST];
    memcpy(z, gait->z, sizeof z);
    gait->residual = INFINITY;
    for (gait->iterations = 0; gait->iterations < NEWTON_MOST; gait->iterations++) {
        lapack_int pivot[RETURN_MAP_MOST];
        double move[RETURN_MAP_MOST];
        const size_t count = place(map, z, NEWTON_STEP, apart, 2, w);
        if (!return_map_take(map, count, (const double(*)[RETURN_MAP_MOST])w->z, w->point, message))
            return gait->residual <= NEWTON_GOOD ||
                   (gait->iterations > 0 && strayed(gait, message));
        const double now = residual(map, z, w->point[0].z);
        const bool better = now < gait->residual, stuck = !(now < 0.5 * gait->residual);
        if (better) {
            memcpy(gait->z, z, sizeof z);
            gait->residual = now;
            gait->at = w->point[0];
        }
        if (now <= NEWTON_DONE || (stuck && gait->residual <= NEWTON_GOOD))
            return true;
        derive(map, NEWTON_STEP, weight, 2, w);
        for (lapack_int i = 0; i < n; i++) {
            w->J[i * n + i] -= 1;
            move[i] = z[i] - w->point[0].z[i];
        }
        if (LAPACKE_dgesv(LAPACK_COL_MAJOR, n, 1, w->J, n, pivot, move, n) != 0)
            break;
        for (lapack_int i = 0; i < n; i++)
            z[i] += move[i];
    }
    if (gait->residual <= NEWTON_GOOD)
        return true;
    int worst = 0;
    char name[STANCE_NAME + 2];
    for (int i = 0; i < n; i++)
        if (fabs(gait->at.z[i] - gait->z[i]) > fabs(gait->at.z[worst] - gait->z[worst]))
            worst = i;
    snprintf(message->text, sizeof message->text,
             "no gait within %d iterations; the nearest returns with %s off by %.3g",
             gait->iterations, return_map_name(map, worst, name), gait->residual);
    return false;
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
    static const int apart[] = {1, -1, 2, -2};
    static const double weight[] = {8.0 / 12, -8.0 / 12, -1.0 / 12, 1.0 / 12};
    double re[2][RETURN_MAP_MOST], im[2][RETURN_MAP_MOST];
    for (int k = 0; k < 2; k++) {
        const size_t count = place(map, gait->z, steps[k], apart, 4, w);
        if (!return_map_take(map, count, (const double(*)[RETURN_MAP_MOST])w->z, w->point, message))
            return false;
        derive(map, steps[k], weight, 4, w);
        memcpy(gait->J, w->J, sizeof gait->J);
        memcpy(gait->by, w->by, sizeof gait->by);
        if (!multipliers(map, w, re[k], im[k])) {
            snprintf(message->text, sizeof message->text, "its multipliers do not converge");
            return false;
        }
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
    struct return_point point;
    stance_message ignored;
    for (part.steps = 1; part.steps < map->steps; part.steps++)
        if (map->steps % part.steps == 0 && return_map_change(&part, &map->base, &ignored) &&
            return_map_take(&part, 1, (const double(*)[RETURN_MAP_MOST])gait->z, &point,
                            &ignored) &&
            residual(map, gait->z, point.z) <= NEWTON_GOOD)
            return part.steps;
    return map->steps;
}

bool gait_find(const struct return_map *map, const double *z, struct gait *gait,
               stance_message *message)
{
    struct work *const w = calloc(1, sizeof *w);
    if (!w) {
        snprintf(message->text, sizeof message->text, "out of memory");
        return false;
    }
    memset(gait, 0, sizeof *gait);
    memcpy(gait->z, z, sizeof gait->z);
    const bool found = newton(map, gait, w, message) && judge(map, gait, w, message);
    free(w);
    return found;
}
