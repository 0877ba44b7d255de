/* standing.c - where there are equilibria, for those who asked for one where there is none. */
#include "standing.h"
#include "resolve.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum {
    PLACES = 36, /* on either side of the value that was given */
    HALVES = 20, /* of the way between two of them, for an end of the range */
    MOST = 150,  /* equilibria that are sought, for the first place that has one */
};
#define NEAREST 0.02 /* rad, m */
#define RATIO 1.15   /* of neighbouring distances: the last is half a turn */
#define DIGITS 1e4   /* of an end that is printed, in a unit */

/* What one asks for in other words: values whose equilibrium has another coordinate k. */
struct question {
    const struct scenario *s;
    struct scenario_values values;
    double *posture; /* of the equilibrium among them that is not there */
    int asked;
};

/* Place i about what was given: 0 itself, then outwards to side -1 or 1. */
static double place(double given, int side, int i)
{
    return given + (i ? side * NEAREST * pow(RATIO, i - 1) : 0);
}

static bool stands(struct question *q, int k, double value)
{
    const double given = q->posture[k];
    q->posture[k] = value;
    q->asked++;
    const bool good = resolve_equilibrium(q->s->scene, &q->values, NULL, NULL, NULL);
    q->posture[k] = given;
    return good;
}

/* The end of a range between a value that has an equilibrium and one that has none, rounded so that
 * it has one. */
static double end_between(struct question *q, int k, double good, double bad)
{
    for (int i = 0; i < HALVES; i++) {
        const double middle = 0.5 * (good + bad);
        *(stands(q, k, middle) ? &good : &bad) = middle;
    }
    const double round = nearbyint(good * DIGITS) / DIGITS;
    return stands(q, k, round) ? round
                               : (good > bad ? ceil(good * DIGITS) : floor(good * DIGITS)) / DIGITS;
}

/* The nearest range of any one coordinate, which is returned; -1: none. */
static int find_range(struct question *q, double range[2])
{
    const int postures = q->s->scene->postures;
    for (int i = 1; i <= PLACES; i++)
        for (int k = 0; k < postures; k++)
            for (int side = -1; side <= 1 && q->asked < MOST; side += 2) {
                const double given = q->posture[k], near = place(given, side, i);
                int last = i;
                if (isnan(given) || !stands(q, k, near))
                    continue;
                while (last < PLACES && stands(q, k, place(given, side, last + 1)))
                    last++;
                const double ends[2] = {
                    end_between(q, k, near, place(given, side, i - 1)),
                    end_between(q, k, place(given, side, last),
                                place(given, side, last < PLACES ? last + 1 : last))};
                range[0] = fmin(ends[0], ends[1]);
                range[1] = fmax(ends[0], ends[1]);
                return range[0] < range[1] ? k : -1;
            }
    return -1;
}

void standing_ranges(const struct scenario *s, const struct scenario_values *values,
                     stance_message *message)
{
    struct question q = {.s = s, .values = *values};
    double range[2];
    const size_t used = strlen(message->text);
    if (!strstr(message->text, "no equilibrium: "))
        return;
    q.values.law = 0; /* the start's own, or else that of the controller */
    q.posture = q.values.equilibrium.posture;
    if (values->state_given || resolve_equilibrium(s->scene, &q.values, NULL, NULL, NULL)) {
        q.values.law = values->law;
        if (values->design_point.given)
            q.posture = q.values.design_point.posture;
    }
    const int k = find_range(&q, range);
    if (k < 0)
        return;
    const stance_quantity *const of = &s->scene->coordinate[s->scene->posture[k]];
    char text[sizeof message->text];
    const int length = snprintf(text, sizeof text, "; there is one with %s from %.9g to %.9g %s",
                                of->name, range[0], range[1], of->unit);
    if (used + (size_t)length < sizeof message->text)
        memcpy(message->text + used, text, (size_t)length + 1);
}
