/* basin_print.h - basins and rays as text, JSON and CSV. Each returns false when memory or the
 * output fails. */
#ifndef STANCE_BASIN_BASIN_PRINT_H
#define STANCE_BASIN_BASIN_PRINT_H

#include "basin.h"
#include "basin_rays.h"

#include "analysis/table/report.h"

enum { BASIN_SHOWN = 40 }; /* rows that people see */

/* Of JSON. */
extern const struct say_key basin_keys[], basin_threshold_keys[], basin_loss_keys[],
    basin_allowed_keys[], basin_answer_keys[], basin_rays_keys[];
bool basin_print(const struct basin *basin, enum table_form form);
/* Returns an exit code. */
int basin_rays_print(const struct basin_rays *rays, enum table_form form);
/* The points of the boundary, every ray, as CSV. */
bool basin_print_boundary(const struct basin *basin);
bool basin_rays_print_boundary(const struct basin_rays *rays);

/* The numbers of an answer that the file stores, freed by the caller; NULL: it stores none of that
 * name, or words. False: it cannot be read. */
bool basin_numbers(const struct results *r, const char *answer, double **value,
                   stance_message *message);
/* Of the cases that ended so, those without such a number: those that were inferred, and others. */
struct basin_lack {
    uint64_t inferred, others;
};
bool basin_lacks(const struct results *r, enum results_kind of, const double *value,
                 struct basin_lack *lack, stance_message *message);

/* What --within asks for: ANSWER=BOUND, each of the outcome `of`, of which `command` speaks. */
struct basin_within {
    const char *command;
    const struct option_texts *asked;
    enum results_kind of;
};
/* A file in which cases with the outcome but with another number become undecided: they are not
 * what was asked for. How that is said goes to said[size]. Returns an exit code; own->kind is freed
 * by the caller in any case. */
int basin_within_make(struct results *own, const struct results *r,
                      const struct basin_within *within, char *said, size_t size,
                      stance_message *message);

/* Answers to single questions. Each returns an exit code; *message says why there is none. */
int basin_print_threshold(const struct basin *basin, const char *path, double threshold,
                          enum table_form form, stance_message *message);
int basin_print_loss(const struct results *r, const char *path, enum results_kind of,
                     enum table_form form, stance_message *message);
int basin_print_answer(const struct basin *basin, const char *answer, enum table_form form,
                       stance_message *message);
int basin_print_allowed(const struct basin *basin, enum table_form form, stance_message *message);
/* "stabilised with settle_time <= 2": what starts are asked for, until the next call. */
const char *basin_asked(const struct basin *basin);

/* Adds to facts of any of these what the file is, with which the texts of most begin. */
#define BASIN_TITLE "{.name}\n{.file}: {.cases} cases\n\n"
json_t *basin_titled(const struct results *r, json_t *facts);
/* Says these facts with the rows of a table, of which a view is shown (table_say); frees both.
 * Returns an exit code. */
int basin_say(const struct results *r, enum table_form form, json_t *facts, struct table *t,
              const char *view, const char *text);
/* Adds to a text among them a line without its end; a line, `otherwise` without a range. */
void basin_add_axis(json_t *facts, const char *key, const struct results_axis *axis);
void basin_add_factors(json_t *facts, const char *key, const struct basin_sample *sample,
                       const char *otherwise);
/* A list of their names. NULL: no memory. */
json_t *basin_factor_names(const struct basin_sample *sample);

#endif
