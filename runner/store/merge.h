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

/* In what the parts differ. */
enum merge_kind { MERGE_EQUAL, MERGE_AXIS, MERGE_VALUE };

/* What is not as in one run of the whole. */
enum merge_note { MERGE_KEYED, MERGE_REFINED, MERGE_DESIGNS, MERGE_NOTES };
extern const char *const merge_notes[MERGE_NOTES];

struct merge_part {
    struct adopted of;
    uint64_t taken; /* rows */
    char *value;    /* that becomes a point of an axis; NULL: that of the first part */
};

struct merge {
    size_t parts;
    struct merge_part *part; /* [parts] */
    enum merge_kind kind;
    int axis;                  /* of the merged scenario; 0 when equal */
    char path[128];            /* of the axis or the value, "" when equal */
    size_t points;             /* of the merged axis; 1 when equal */
    struct scenario *scenario; /* merged */
    bool noted[MERGE_NOTES];
    bool usage; /* of what failed: what the parts are is at fault, not reading or writing */
    stance_message message; /* why it failed */
    struct adopted_rows rows;
};

/* Reads what the parts are and finds how they fit. Release in any case. */
bool merge_plan(struct merge *merge, const char *const *files, size_t count);
/* Makes the merged file (adopt_make). */
bool merge_write(struct merge *merge, const char *file);
void merge_free(struct merge *merge);

#endif
