/* basin_starts.h - other starts of a case of a scenario, simulated: not from a results file. */
#ifndef STANCE_BASIN_BASIN_STARTS_H
#define STANCE_BASIN_BASIN_STARTS_H

#include "runner/plan/resolve.h"
#include "runner/store/results.h"

enum { STARTS_MOST = 18 }; /* coordinates of a start that vary: angles and rates */

/* What becomes of a start: an outcome, or one of these. */
enum { STARTS_FAILED = STANCE_OUTCOME_COUNT, STARTS_IMPOSSIBLE };
/* That outcome. */
uint8_t starts_outcome(enum results_kind kind);

/* A number of the start, and how it moves with what is asked for: centre + along * x[axis]. */
struct starts_field {
    char path[96];
    size_t offset; /* in struct scenario_values */
    int axis;
    double centre, along;
};

struct starts {
    const struct scenario *s;
    struct starts_field field[STARTS_MOST];
    int fields, axes;
    uint64_t index; /* of the case that all are like, for its random numbers */
    struct scenario_values values;
    struct resolved_design design;
    const stance_kernel *kernel;
    uint64_t simulated, failed;
    stance_message why; /* the last STARTS_IMPOSSIBLE is none */
    /* Told about every millisecond while starts are simulated, with how many more are done since
     * starts_begin; NULL: not. */
    void (*tell)(void *context, uint64_t more);
    void *context;
};

/* The case `index` of the sweep, with offsets not scaled and without fields. False: it has no
 * design, or its method no kernel on this machine; `message` says so. */
bool starts_begin(struct starts *starts, const struct scenario *s, uint64_t index,
                  stance_message *message);
/* Simulates the starts x[count][axes] of a struct starts. end[count]: what became of each. False:
 * no memory. */
bool starts_run(void *starts, size_t count, const double *x, uint8_t *end);
/* Whether there is that start, x[axes]. */
bool starts_possible(struct starts *starts, const double *x);

#endif
