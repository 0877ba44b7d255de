/* merge.h - the files of an array job into one.
 *
 * The parts' scenarios are equal (each computed some of the cases), or differ along one axis of the
 * grid (each has some of its points), or in one number or word, which becomes the first axis. What
 * comes out is a results file like any other, with the scenario that describes it: rows are
 * verified by their checksums and copied as they are.
 *
 * Random numbers are keyed by the indices that cases had in their own file: where a study has
 * torque noise or probes, one run of the merged scenario would have other ones.
 */
#ifndef STANCE_STORE_MERGE_H
#define STANCE_STORE_MERGE_H

#include "adopt.h"

enum merge_kind { MERGE_EQUAL, MERGE_AXIS, MERGE_VALUE };

struct merge_part {
    struct adopted of;
    size_t points;    /* along the axis; 1 where it has none */
    size_t *position; /* [points] in the merged axis; NULL: the only one */
    uint64_t taken;   /* rows */
};

struct merge {
    size_t parts;
    struct merge_part *part; /* [parts] */
    enum merge_kind kind;
    int axis;                  /* of the merged scenario; 0 when equal */
    char path[128];            /* of the axis or the value, "" when equal */
    size_t points;             /* of the merged axis; 1 when equal */
    struct scenario *scenario; /* merged */
    uint64_t inner;            /* cases in one point of it, of those axes that come after it */
    bool keyed;                /* has random numbers that are not those of one run */
    bool refined;              /* along the merged axis, each part for itself */
    bool designs_differ; /* or computed axes, in last bits: the first part's are in the file */
    bool usage; /* of what failed: what the parts are is at fault, not reading or writing */
    stance_message message; /* why it failed */
    struct store_copied copied;
};

/* Reads what the parts are and finds how they fit. Release in any case. */
bool merge_plan(struct merge *merge, const char *const *files, size_t count);
/* Writes the merged file, which must not exist. False: nothing is left of it. */
bool merge_write(struct merge *merge, const char *file);
void merge_free(struct merge *merge);

/* The row of the merged file in which a row of a part stands. */
static inline uint64_t merge_row(const struct merge *merge, const struct merge_part *part,
                                 uint64_t row)
{
    const uint64_t outer = row / merge->inner / part->points;
    const size_t point = (size_t)(row / merge->inner % part->points);
    const size_t place = part->position ? part->position[point] : 0;
    return (outer * merge->points + place) * merge->inner + row % merge->inner;
}

#endif
