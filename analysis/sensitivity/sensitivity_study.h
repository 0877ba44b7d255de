/* sensitivity_study.h - the sensitivity of a results file: its design, responses and indices.
 *
 * A results file has grid axes and, last, the axis `sample`. At each value of the grid axes that
 * are kept apart (a table) the response of a sample point is a mean over the cases on the other
 * grid axes: the share of cases with an outcome, or the mean of an answer over the cases with it.
 * Failed cases are left out of these means, or counted as fallen. A point without a case that can
 * be used is missing: it takes out its whole block (saltelli), the effects that need it (morris) or
 * just itself. A block with a case that is still pending waits: what its means will be is not known
 * yet.
 *
 * Chooses by the method of sweep.sample: saltelli gives Sobol' indices, morris elementary effects,
 * random, lhs and sobol first-order indices of given data; see sensitivity.h.
 */
#ifndef STANCE_SENSITIVITY_SENSITIVITY_STUDY_H
#define STANCE_SENSITIVITY_SENSITIVITY_STUDY_H

#include "sensitivity.h"

#include "analysis/table/report.h"

struct sensitivity_request {
    const char *answer;   /* NULL: the share of cases with the outcome */
    const char *unit;     /* of the answer, "": none */
    enum results_kind of; /* RESULTS_KIND_COUNT: what the study judges by; answer: all cases done */
    bool fallen;          /* failed cases count as fallen */
    struct option_texts by; /* grid axes kept apart; none: all but initial.*; "none": none */
    struct sensitivity_bootstrap bootstrap;
};

/* One point of the grid axes kept apart. */
struct sensitivity_table {
    size_t point[SCENARIO_MAX_AXES]; /* along these axes */
    uint64_t cases, failed, pending;
    size_t waiting, lost; /* blocks with a pending case; morris: effects, else blocks, that failed
                           * cases took out */
    struct sensitivity s;
    /* The other way to count failed cases moves an estimate out of its interval. */
    bool moved;
    enum sensitivity_measure moved_measure; /* where, most of all: of factor moved_factor, to */
    size_t moved_factor;
    double moved_to;
};

struct sensitivity_study {
    const struct results *r;
    struct sensitivity_request request; /* `of` resolved */
    const struct doe *design;           /* of the scenario */
    size_t points, block, blocks, factors;
    bool kept[SCENARIO_MAX_AXES]; /* by axis of the file; never the sample */
    size_t tables;
    struct sensitivity_table *table; /* [tables], row-major over the axes kept apart */
    uint64_t failed;                 /* cases of all of them */
    bool *waits;                     /* [tables][blocks] */
    size_t *order; /* [factors]: what matters most, on the mean of tables, first */
};

/* Returns an exit code: EXIT_USAGE when the file does not store what is asked for; other than
 * EXIT_DONE with a line in *message, and nothing is left. */
int sensitivity_study_make(struct sensitivity_study *study, const struct results *r,
                           const struct sensitivity_request *request, stance_message *message);
void sensitivity_study_free(struct sensitivity_study *study);

/* Whether a file is one of these: sampled, by another method than sphere. */
bool sensitivity_study_fits(const struct results *r);

/* "ground.friction", "robot.trunk_mass and 1 more" */
void sensitivity_factor_text(const struct sensitivity_study *study, size_t factor, char *text,
                             size_t size);
/* Path k of a factor, NULL from the last on. */
const char *sensitivity_factor_path(const struct sensitivity_study *study, size_t factor, int k);
/* "share of stabilised cases", "mean friction_used of the stabilised cases" */
void sensitivity_response_text(const struct sensitivity_study *study, char *text, size_t size);
/* "ground.friction = 0.2, ..." of a table; "" of the only one. */
void sensitivity_table_text(const struct sensitivity_study *study, size_t table, char *text,
                            size_t size);

extern const struct say_key sensitivity_keys[]; /* of its JSON */
/* Prints the results; false: no memory, or the output failed. */
bool sensitivity_print(const struct sensitivity_study *study, enum table_form form);
/* NAME[-ANSWER]-sensitivity of the plot's file. */
struct plot;
bool sensitivity_picture(const struct sensitivity_study *study, const struct plot *plot);

#endif
