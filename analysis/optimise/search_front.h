/* search_front.h - several searches that differ in a number of their scenarios: a front of the
 * domain against it.
 */
#ifndef STANCE_ANALYSIS_SEARCH_FRONT_H
#define STANCE_ANALYSIS_SEARCH_FRONT_H

#include "search_study.h"

#include "analysis/table/table.h"

struct search_front {
    size_t count;
    struct search_study *study;  /* [count], by what differs, rising */
    double *at;                  /* [count] what differs */
    struct results_axis against; /* its path, unit and text; value is `at` */
    char also[400];              /* other paths that differ, "a, b"; "" */
};

/* Reads the files and finds what differs: of the numbers that all scenarios have the one with most
 * values, of several the first in the scenario; the seed and what a search may cost are none.
 * False: one line in *message, also where nothing differs or a search is not finished. */
bool search_front_open(struct search_front *front, const char *const *file, size_t count,
                       stance_message *message);
void search_front_close(struct search_front *front);

/* A row for each search. */
bool search_front_print(const struct search_front *front, enum table_form form);

#endif
