/* ground_line.h - the ground of a case as it is drawn: what is laid before a footfall as well. */
#ifndef STANCE_PLAN_GROUND_LINE_H
#define STANCE_PLAN_GROUND_LINE_H

#include "runner/scenario/scenario.h"

#include <stddef.h>

/* Into *c the ground of a case of a scenario, with values as scenario_case_values has them, and the
 * robot: no more than what the functions below ask for. */
void ground_case(const struct scenario *s, const struct scenario_values *values, uint64_t index,
                 stance_case *c);
/* Where a contact is, m along the ground; *rises: m/s, off it. */
double ground_along(const stance_case *c, const double *position, const double *velocity,
                    int contact, double *rises);
/* Gaps of the contacts in a position, as a scene's `gaps` has them, over the ground that there is
 * before any footfall. */
void ground_gaps(const stance_case *c, const double *position, double gap[STANCE_MAX_CONTACTS]);

/* Where the pieces of the ground begin, m along it, and since when they are there, s: -INFINITY
 * always, INFINITY never. */
struct ground_pieces {
    double from[STANCE_MAX_PLATES], laid[STANCE_MAX_PLATES];
};

/* A trajectory, whose row k was at time[k]; arrays as in stance_trajectory, without force or gap
 * NULL. */
struct ground_motion {
    size_t rows;
    const double *time, *position, *velocity, *force, *gap;
};
/* Of a case with that trajectory; without one, NULL, pieces by footfall are never there. */
void ground_pieces_find(const stance_case *c, const struct ground_motion *motion,
                        struct ground_pieces *pieces);

/* The ground at a time, from `low` to `high` m along it, in the frame of the figure: points x, z of
 * one line, at most `room` >= 2. Where there are more plates its end is a straight line. Returns
 * how many. */
size_t ground_line(const stance_case *c, const struct ground_pieces *pieces, double time,
                   double low, double high, double (*point)[2], size_t room);

/* Its mean height, m, normal to the plane, there and then. */
double ground_mean(const stance_case *c, const struct ground_pieces *pieces, double time,
                   double low, double high);

#endif
