/* sensitivity.c - the gait sensitivity norm of Hobbelen and Wisse (IEEE Trans. Robotics 23 (2007)
 * 1213): the H2 norm from a disturbance of each step to how the gait answers.
 *
 * A return begins at the section's coordinates z and with the foot behind at a height f over the
 * ground of the one in front, which is not 0 where a step of the ground lies between them. With the
 * derivatives of the map by them and by the disturbance e, to first order
 *     z' = A z + F f + B e,  f' = G e,  g = C z + H f + D e
 * (a foot behind has been the one that stands, so that f' is what e did, no more). Of an e in one
 * return g is D e there, (C B + H G) e in the next one, and C A^k (A B + F G) e from the one after
 * that on, k = 0, 1, ...; of such e that are independent of each other
 *     var g = var e (D^2 + (C B + H G)^2 + sum over k >= 0 of (C A^k (A B + F G))^2)
 * The first two returns are simulated, one after the other, the second with e = 0 from where the
 * first one ended: central differences over the whole range of the number and over half of it,
 * extrapolated; how far these are apart is the error that is told, with what the gait's residual
 * makes of the narrower one, below which nothing is told. On even ground f is 0, and this
 * is the sum of C A^k B.
 */
#include "gait.h"

#include "runner/base/message.h"
#include "runner/plan/asked.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

extern const struct command command_gait;

enum { MEASURES = 3, STEPS_MOST = 100000 }; /* time, length, speed */
/* After two returns: the section's coordinates, then time and length of both returns. */
enum { ANSWERS_MOST = RETURN_MAP_MOST + 4 };
#define MIDDLE 0.05 /* of what the range changes: so far off may the middle's return be */
#define EXACT 1e-6  /* as gait.c admits */
#define SAME 1e-10  /* no return is known better: footfalls are found to about that */

struct change {
    struct return_map map;
    const struct gait *gait;
    struct return_point first, next;
    stance_message *message;
};

static int take(const struct scenario *s, const stance_case *c, void *context)
{
    struct change *const change = context;
    (void)s;
    return return_map_change(&change->map, c, change->message) &&
                   return_map_take(&change->map, 1, &change->gait->from, &change->first,
                                   change->message)
               ? EXIT_DONE
               : EXIT_USAGE;
}

/* What comes of a gait whose next return has a value of the number, and the one after it none. */
static bool at(const struct scenario *s, const char *path, double value,
               const struct return_map *map, struct change *change, double *answer)
{
    change->map = *map;
    struct scenario *const changed =
        along_at(s->file, s->text, path, value, map, &change->gait->from);
    const bool good = changed && asked_first(&command_gait, changed, take, change) == EXIT_DONE &&
                      return_map_take(map, 1, &change->first, &change->next, change->message);
    scenario_drop(changed);
    if (!good) {
        along_blame(path, value, change->message);
        return false;
    }
    const struct return_point *const point[] = {&change->first, &change->next};
    memcpy(answer, change->next.z, (size_t)map->n * sizeof *answer);
    for (int k = 0; k < 2; k++) {
        answer[map->n + 2 * k] = point[k]->time;
        answer[map->n + 2 * k + 1] = point[k]->length;
    }
    return true;
}

/* Of measures g by time T and length L: T, L, L / T. */
static void measures(const struct gait *gait, double time, double length, double g[MEASURES])
{
    g[0] = time;
    g[1] = length;
    g[2] = (length - gait->at.length / gait->at.time * time) / gait->at.time;
}

/* Variances of the measures, by e of variance 1 and what the answers are by it. */
static void add_up(const struct return_map *map, const struct gait *gait, const double *by,
                   double variance[MEASURES])
{
    const int n = map->n;
    double z[RETURN_MAP_MOST], next[RETURN_MAP_MOST] = {0}, least = 0;
    memcpy(z, by, (size_t)n * sizeof *z);
    for (int m = 0; m < MEASURES; m++)
        variance[m] = 0;
    for (int k = 0; k < 2; k++) {
        double g[MEASURES];
        measures(gait, by[n + 2 * k], by[n + 2 * k + 1], g);
        for (int m = 0; m < MEASURES; m++)
            variance[m] += g[m] * g[m];
    }
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
    double by[2][ANSWERS_MOST], answer[2][ANSWERS_MOST], variance[MEASURES];
    double largest = 0, off = 0, aside = 0;
    const int answers = map->n + 4;
    if (!gait->stable)
        return complain(message,
                        "what each step adds grows without bound in a gait that does not hold");
    struct change *const change = calloc(1, sizeof *change);
    bool good = change != NULL;
    if (change)
        *change = (struct change){.gait = gait, .message = message};
    for (int k = 0; good && k < 2; k++) {
        const double width = k == 0 ? range : 0.5 * range;
        for (int side = 0; good && side < 2; side++)
            good = at(s, along->path, middle + (side - 0.5) * width, map, change, answer[side]);
        for (int i = 0; good && i < answers; i++)
            by[k][i] = (answer[1][i] - answer[0][i]) / width;
    }
    good = good && at(s, along->path, middle, map, change, answer[0]);
    free(change);
    if (!good)
        return false;
    for (int i = 0; i < answers; i++) {
        const double is = i < map->n              ? gait->from.z[i]
                          : (i - map->n) % 2 == 0 ? gait->at.time
                                                  : gait->at.length;
        aside = fmax(aside, fabs(answer[0][i] - is));
        largest = fmax(largest, fabs(by[1][i]));
        off = fmax(off, fabs(by[1][i] - by[0][i]));
        by[1][i] += (by[1][i] - by[0][i]) / 3;
    }
    if (aside > fmax(MIDDLE * largest * fabs(range), EXACT))
        return complain(message,
                        "the gait is not one of the middle, %.60s=%.6g: give a range about the "
                        "scenario's value",
                        along->path, middle);
    const double floor = fmax(gait->residual, SAME) / fabs(0.5 * range);
    if (largest <= floor)
        return complain(message,
                        "%.60s from %.6g to %.6g changes nothing in the gait's returns beyond "
                        "%.1e: give what they meet (a plate of footfall: 1) or a wider range",
                        along->path, along->from, along->to, 0.5 * floor * fabs(range));
    add_up(map, gait, by[1], variance);
    const double deviation = fabs(range) / sqrt(12); /* of what is even */
    *sensitivity = (struct gait_sensitivity){.time = deviation * sqrt(variance[0]),
                                             .length = deviation * sqrt(variance[1]),
                                             .speed = deviation * sqrt(variance[2]),
                                             .error = (off + floor) / largest};
    return true;
}
