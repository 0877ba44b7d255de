/* sensitivity_study.h - the sensitivity of a results file: its design, responses and indices.
 *
 * Chooses by the method of sweep.sample: saltelli gives Sobol' indices, morris elementary effects,
 * random, lhs and sobol first-order indices of given data; see sensitivity.h. Blocks with a pending
 * case wait. A missing response, see response.h, takes out its whole block (saltelli), the effects
 * that need it (morris) or just the point.
 */
#ifndef STANCE_SENSITIVITY_SENSITIVITY_STUDY_H
#define STANCE_SENSITIVITY_SENSITIVITY_STUDY_H

#include "response.h"
#include "sensitivity.h"

#include "analysis/table/table.h"

struct sensitivity_request {
    const char *answer;   /* NULL: the share of cases with the outcome */
    const char *unit;     /* of the answer, "": none */
    enum results_kind of; /* RESULTS_KIND_COUNT: what the study judges by; answer: all cases done */
    bool fallen;          /* failed cases count as fallen */
    const char *const *by; /* grid axes kept apart; by_count 0: all but initial.*; "none": none */
    size_t by_count;
    struct sensitivity_bootstrap bootstrap;
};

/* One point of the grid axes kept apart. */
struct sensitivity_table {
    const struct response_table *response;
    size_t blocks, waiting; /* of the design; with a pending case */
    size_t lost;            /* morris: effects, else blocks, that failed cases took out */
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
    const struct scenario *scenario;
    const struct doe *design; /* of the scenario */
    size_t block, factors;
    struct response response;
    struct sensitivity_table *table; /* [response.tables] */
    size_t *order; /* [factors]: what matters most, on the mean of tables, first */
};

/* Returns an exit code; other than EXIT_DONE with a line in *message, and nothing is left. */
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

/* Prints the results; false: no memory, or the output failed. */
bool sensitivity_print(const struct sensitivity_study *study, enum table_form form);
/* NAME[-ANSWER]-sensitivity of the plot's file. */
struct plot;
bool sensitivity_picture(const struct sensitivity_study *study, const struct plot *plot);

#endif
