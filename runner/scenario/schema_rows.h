/* schema_rows.h - the rows of the scenario format as they stand, before a scene writes them out. */
#ifndef STANCE_SCENARIO_SCHEMA_ROWS_H
#define STANCE_SCENARIO_SCHEMA_ROWS_H

#include "schema.h"

/* What the '*' of a path stands for, or what else of a row is the scene's. */
enum family {
    FAMILY_NONE,
    FAMILY_ROBOT,     /* parameters of the body */
    FAMILY_PLATES,    /* of the ground */
    FAMILY_STATE,     /* coordinates, then their rates with a "v" before the name */
    FAMILY_OFFSET,    /* the same, as differences */
    FAMILY_POSTURE,   /* angles that a posture law acts on */
    FAMILY_CONTACTS,  /* the words are names of contacts */
    FAMILY_FOOT,      /* the range is 1 ... contacts */
    FAMILY_BRANCH,    /* of a mechanism a number */
    FAMILY_POLES,     /* 2 postures items */
    FAMILY_ACTUATORS, /* one item for each */
    FAMILY_MATRIX,    /* actuators x 2 postures */
    FAMILY_STATES,    /* of such a list each item by the name of its state ... */
    FAMILY_INPUTS,    /* ... or actuator ... */
    FAMILY_GAINS,     /* ... or of both: a mapping for each actuator */
    FAMILY_SCENES,
    FAMILY_METHODS,
    FAMILY_KINDS,      /* the words are laws */
    FAMILY_FAR,        /* those that may act far from a target */
    FAMILY_PARAMETERS, /* stands for the rows of all laws */
    FAMILY_TOLERANCE,  /* the text names the methods that read it */
};

struct row {
    enum family family;
    struct scenario_field field;
};

extern const struct row schema_rows[];
extern const size_t schema_row_count;

#endif
