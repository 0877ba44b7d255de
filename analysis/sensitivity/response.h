/* response.h - one number for each point of a sampled study: what its sensitivity is asked of.
 *
 * A results file has grid axes and, last, the axis `sample`. At each value of the grid axes that
 * are kept apart (a table) the response of a sample point is a mean over the cases on the other
 * grid axes: the share of cases with an outcome, or the mean of an answer over the cases with it.
 *
 * Failed cases are left out of these means, or counted as fallen. A point without a case that can
 * be used is missing: NAN. So is one with a case that is still pending, since what its mean will be
 * is not known yet.
 */
#ifndef STANCE_SENSITIVITY_RESPONSE_H
#define STANCE_SENSITIVITY_RESPONSE_H

#include "runner/store/results.h"

struct response_choice {
    const char *answer;   /* a variable of numbers over the cases; NULL: a share */
    enum results_kind of; /* an outcome; with an answer RESULTS_KIND_COUNT: all cases done */
    bool fallen;          /* without an answer: failed cases count as fallen */
};

struct response_table {
    size_t point[SCENARIO_MAX_AXES]; /* along the axes kept apart */
    double *y;                       /* [points] */
    bool *waiting;                   /* [points] of which cases are pending */
    uint64_t cases, failed, pending;
    size_t missing; /* points without a usable case, the waiting ones aside */
};

struct response {
    size_t points;                /* of the sample */
    bool kept[SCENARIO_MAX_AXES]; /* by axis of the file; never the sample */
    size_t tables;
    struct response_table *table; /* row-major over the axes kept apart */
};

/* Of a file with samples (r->sample); kept[axes] says which grid axes are kept apart. Returns an
 * exit code: EXIT_USAGE when the file does not store what is asked for. Other than EXIT_DONE there
 * is a line in *message, and nothing is left. */
int response_make(struct response *response, const struct results *r,
                  const struct response_choice *choice, const bool *kept, stance_message *message);
void response_free(struct response *response);

#endif
