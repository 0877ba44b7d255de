/* faces.h - the box of starts, and by which of its faces the set of an outcome is cut.
 *
 * How much of a box an outcome fills says as much of the box as of the outcome: where cases that
 * have it lie on a face of the box, the set goes on beyond it, and the share is the box's. A face
 * is an end of an axis of starts: initial.offset.*, initial.state.*, of initial.offset.scale the
 * upper end alone; of sampled starts the outer FACES_MARGIN of what a path's values span.
 * Directions (method sphere) have no box.
 */
#ifndef STANCE_STATISTICS_FACES_H
#define STANCE_STATISTICS_FACES_H

#include "statistics.h"

#include <jansson.h>

#define FACES_MARGIN 0.05
enum { FACES_STARTS = 32 }; /* most paths; of more the first ones have faces */

/* Faces of a box: bit 2 k of the lower end of start k, bit 2 k + 1 of its upper end. */
typedef uint64_t face_set;

struct faces {
    const struct results *r;
    int starts;
    struct faces_start {
        const struct results_axis *of;
        int axis; /* of the file; of sampled starts that of the sample */
        bool sampled;
        double end[2]; /* lower, upper */
    } start[FACES_STARTS];
};

/* The starts of a file, those of the grid in the order of its axes before the sampled ones, but for
 * axes that are named in without[count]. */
void faces_make(struct faces *faces, const struct results *r, const int *without, int count);
/* The faces on which a case lies, at point[axes of the file]. */
face_set faces_at(const struct faces *faces, const size_t *point);
/* The faces on which any case of the file has that outcome. */
face_set faces_cut(const struct faces *faces, enum results_kind kind);

/* "initial.offset.theta = -0.12 rad and 0.06 rad (both ends), ..."; of a sample
 * "initial.offset.theta (both ends), ...". */
void faces_text(const struct faces *faces, face_set set, char *text, size_t size);
/* The same with the last words of the paths alone: "theta-+, vtheta+". */
void faces_marks(const struct faces *faces, face_set set, char *text, size_t size);
/* [{path, end: "lower" or "upper", at}]; NULL: no memory. */
json_t *faces_json(const struct faces *faces, face_set set);

#endif
