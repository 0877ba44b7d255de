/* outlook.h - how long a search will go on: the cases that are planned, times what one took of
 * late.
 *
 * Better candidates are refused less often and stay up for longer, so that what the search took on
 * the whole says too little. Stages that are over before their time drop out of the plan.
 */
#ifndef STANCE_OPTIMISE_OUTLOOK_H
#define STANCE_OPTIMISE_OUTLOOK_H

struct outlook {
    double ahead;          /* cases that are planned behind those in hand */
    double now, begun;     /* cases in hand, and when they were taken */
    double seconds, cases; /* of late: what so many simulated ones took */
};

/* Cases in hand, which were planned. */
void outlook_begin(struct outlook *outlook, double cases);
/* They are done: so many were simulated; `apart` s were spent on something else. */
void outlook_end(struct outlook *outlook, double simulated, double apart);
/* s; negative: not known yet. */
double outlook_left(const struct outlook *outlook);

#endif
