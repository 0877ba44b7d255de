/* compare.h - what differs between two results files, bit for bit.
 *
 * Everything counts but group `timing` and the attributes that say where a file comes from, and the
 * rows of pending cases, which hold whatever the disk held. A NAN equals a NAN.
 */
#ifndef STANCE_ANALYSIS_COMPARE_H
#define STANCE_ANALYSIS_COMPARE_H

#include "results.h"

enum { COMPARE_SHOWN = 3, COMPARE_TEXT = 72 };

/* One place where a variable differs. */
struct compare_place {
    uint64_t index;   /* flat index of the case, or of the element where it is no case's */
    size_t component; /* within the case; 0 where there is one only */
    char value[2][COMPARE_TEXT];
};

struct compare_difference {
    char name[192];  /* "end_time", "trajectory/force", "attribute seed" */
    char reason[64]; /* "values", "only in the first file", "shapes", "types" */
    bool cases;      /* the counts are of cases; else of elements */
    bool several;    /* a case has several components */
    uint64_t differing, of;
    int shown;
    struct compare_place place[COMPARE_SHOWN]; /* the first few */
};

struct comparison {
    size_t count, room;
    struct compare_difference *difference;
};

/* False when a file cannot be read or memory fails; the comparison is released then. */
bool compare_results(struct comparison *comparison, const struct results *first,
                     const struct results *second, stance_message *message);
void compare_free(struct comparison *comparison);

#endif
