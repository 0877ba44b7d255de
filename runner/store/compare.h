/* compare.h - what differs between two results files, bit for bit or by more than a tolerance.
 *
 * Everything counts but group `timing` and the attributes that say where a file comes from, and the
 * rows of pending cases, which hold whatever the disk held. A NAN equals a NAN.
 *
 * With tolerances, variables alone are compared: no attributes, and no checksums of rows. Numbers
 * a, b are equal when |a - b| <= absolute + relative max(|a|, |b|); words, flags such as outcome
 * and status, and the numbers of cases have no tolerance.
 */
#ifndef STANCE_STORE_COMPARE_H
#define STANCE_STORE_COMPARE_H

#include "results.h"

enum { COMPARE_SHOWN = 3, COMPARE_TEXT = 72, COMPARE_TOLERANCES = 64 };

struct compare_tolerance {
    const char *name; /* of a variable; NULL: of all without one of their own */
    double relative, absolute;
};
struct compare_tolerances {
    size_t count;
    struct compare_tolerance tolerance[COMPARE_TOLERANCES];
};

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
    /* With tolerances; then `differing` may be 0: all differences are within them. */
    double largest; /* |a - b|, INFINITY where one of them is no number */
    struct compare_place largest_place;
};

struct comparison {
    const struct compare_tolerances *tolerances; /* NULL: bit for bit */
    size_t beyond;                               /* entries that are not within tolerances */
    size_t count;
    struct compare_difference *difference; /* [count] */
};

/* `tolerances` may be NULL. False when a file cannot be read or memory fails; the comparison is
 * released then. */
bool compare_results(struct comparison *comparison, const struct results *first,
                     const struct results *second, const struct compare_tolerances *tolerances,
                     stance_message *message);
/* Whether a file has a variable of that name. */
bool compare_has(const struct results *r, const char *name);
void compare_free(struct comparison *comparison);

#endif
