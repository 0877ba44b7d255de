/* sensitivity.c - the gait sensitivity norm of Hobbelen and Wisse (IEEE Trans. Robotics 23 (2007)
 * 1213): the H2 norm from a disturbance of each step to how the gait answers.
 *
 * With the return map's derivative A, and the returns' changes B and D by the disturbance e, C by
 * the section's coordinates z,
 *     z' = A z + B e,  g = C z + D e:    var g = var e (D^2 + sum over k >= 0 of (C A^k B)^2)
 * for e that are independent of each other. B and D are central differences over the whole range of
 * the number and over half of it, extrapolated; how far these are apart is the error that is told.
 */
#include "sensitivity.h"

#include "runner/plan/asked.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

extern const struct command command_gait;

enum { MEASURES = 3, STEPS_MOST = 100000 }; /* time, length, speed */
#define MIDDLE 0.05 /* of what the range changes: so far off may the middle's return be */
#define EXACT 1e-6  /* as gait.c admits */

struct change {
    struct return_map map;
    const double *z;
    struct return_point point;
    stance_message *message;
};

static int take(const struct scenario *s, const stance_case *c, void *context)
{
    struct change *const change = context;
    (void)s;
    return return_map_change(&change->map, c, change->message) &&
                   return_map_take(&change->map, 1, (const double(*)[RETURN_MAP_MOST])change->z,
                                   &change->point, change->message)
               ? EXIT_DONE
               : EXIT_USAGE;
}

/* Where the gait returns to when the number has a value. */
static bool at(const struct scenario *s, const char *path, double value, struct change *change)
{
    struct scenario *const changed =
        along_at(s->file, s->text, path, value, &change->map, change->z);
    const bool good = changed && asked_first(&command_gait, changed, take, change) == EXIT_DONE;
    scenario_drop(changed);
    if (!good)
        along_blame(path, value, change->message);
    return good;
}

/* Of measures g by time T and length L: T, L, L / T. */
static void measures(const struct gait *gait, double time, double length, double g[MEASURES])
{
    g[0] = time;
    g[1] = length;
    g[2] = (length - gait->at.length / gait->at.time * time) / gait->at.time;
}

/* Variances of the measures, by e of variance 1. */
static void add_up(const struct return_map *map, const struct gait *gait, const double *B,
                   const double *D, double variance[MEASURES])
{
    const int n = map->n;
    double z[RETURN_MAP_MOST], next[RETURN_MAP_MOST] = {0}, least = 0;
    memcpy(z, B, sizeof z);
    for (int m = 0; m < MEASURES; m++)
        variance[m] = D[m] * D[m];
    for (int k = 0; k < STEPS_MOST; k++) {
        double time = 0, length = 0, g[MEASURES], size = 0;
        for (int j = 0; j < n; j++) {
            time += gait->by[j][0] * z[j];
            length += gait->by[j][1] * z[j];
        }
        measures(gait, time, length, g);
        for (int m = 0; m < MEASURES; m++)
            variance[m] += g[m] * g[m];
        for (int i = 0; i < n; i++) {
            next[i] = 0;
            for (int j = 0; j < n; j++)
                next[i] += gait->J[j * n + i] * z[j];
            size = fmax(size, fabs(next[i]));
        }
        memcpy(z, next, sizeof z);
        if (k == 0)
            least = 1e-12 * size;
        if (size <= least)
            return;
    }
}

bool gait_sensitivity_find(const struct scenario *s, const struct return_map *map,
                           const struct gait *gait, const struct along *along,
                           struct gait_sensitivity *sensitivity, stance_message *message)
{
    const double middle = 0.5 * (along->from + along->to), range = along->to - along->from;
    double by[2][RETURN_MAP_MOST + 2], B[RETURN_MAP_MOST], D[MEASURES], variance[MEASURES];
    double largest = 0, off = 0, aside = 0;
    struct change *const change = malloc(2 * sizeof *change);
    bool good = change != NULL;
    if (!gait->stable) {
        snprintf(message->text, sizeof message->text,
                 "what each step adds grows without bound in a gait that does not hold");
        good = false;
    }
    for (int k = 0; good && k < 2; k++) {
        const double width = k == 0 ? range : 0.5 * range;
        for (int side = 0; good && side < 2; side++) {
            change[side] = (struct change){.map = *map, .z = gait->z, .message = message};
            good = at(s, along->path, middle + (side - 0.5) * width, &change[side]);
        }
        const struct return_point *const p = &change[0].point, *const q = &change[1].point;
        for (int i = 0; good && i < map->n; i++)
            by[k][i] = (q->z[i] - p->z[i]) / width;
        by[k][map->n] = good ? (q->time - p->time) / width : 0;
        by[k][map->n + 1] = good ? (q->length - p->length) / width : 0;
    }
    good = good && at(s, along->path, middle, &change[0]);
    for (int i = 0; good && i < map->n + 2; i++) {
        const struct return_point *const p = &change[0].point;
        const double here = i < map->n    ? p->z[i] - gait->z[i]
                            : i == map->n ? p->time - gait->at.time
                                          : p->length - gait->at.length;
        aside = fmax(aside, fabs(here));
        largest = fmax(largest, fabs(by[1][i]));
        off = fmax(off, fabs(by[1][i] - by[0][i]));
        by[1][i] += (by[1][i] - by[0][i]) / 3;
    }
    free(change);
    if (good && aside > fmax(MIDDLE * largest * fabs(range), EXACT)) {
        snprintf(message->text, sizeof message->text,
                 "the gait is not one of the middle, %.60s=%.6g: give a range about the scenario's "
                 "value",
                 along->path, middle);
        good = false;
    }
    if (!good)
        return false;
    memcpy(B, by[1], sizeof B);
    measures(gait, by[1][map->n], by[1][map->n + 1], D);
    add_up(map, gait, B, D, variance);
    const double deviation = fabs(range) / sqrt(12); /* of what is even */
    *sensitivity = (struct gait_sensitivity){.time = deviation * sqrt(variance[0]),
                                             .length = deviation * sqrt(variance[1]),
                                             .speed = deviation * sqrt(variance[2]),
                                             .error = largest > 0 ? off / largest : 0};
    return true;
}
