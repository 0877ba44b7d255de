/* schema_mechanism.h - the rows of the scenario format that describe a mechanism: one table of what
 * may stand in a body, a contact, a point, an actuator, a piece of the ground, written out for each
 * that there is. */
#ifndef STANCE_SCENARIO_SCHEMA_MECHANISM_H
#define STANCE_SCENARIO_SCHEMA_MECHANISM_H

#include "schema.h"

#include "engine/mechanism.h"

/* What `scene` is then. */
#define MECHANISM_WORD "mechanism"

/* Those of the robot come first. */
enum part {
    PART_BODY,
    PART_CONTACT,
    PART_POINT,
    PART_ACTUATOR,
    PART_PLATE,
    PARTS,
    ROBOT_PARTS = PART_PLATE
};

/* What a mechanism is made of, and what it stands on: a mapping of names below robot, or ground. */
struct part_kind {
    const char *in, *key, *one; /* "robot", "bodies", "body" */
    int most;
    /* Where it stands in stance_mechanism, the first of a list whose members begin with their name,
     * and its numbers in stance_mechanism_numbers. */
    size_t count, name, body, size, numbers, numbers_size;
    const char *text;
};
extern const struct part_kind part_kinds[PARTS];

/* What may stand in one of them. */
struct part_key {
    enum part part;
    /* Its row, whose path is the key alone; of a list of two numbers that of the list. `offset`: of
     * its first number in what describes the part (stance_body_numbers, ...), or NO_OFFSET. */
    struct scenario_field field;
    unsigned joints;          /* of a body: bit per stance_joint that has it */
    const char *slide_unit;   /* of a body that slides; NULL: `unit` */
    bool names_body, of_sole; /* the value is the name of a body; a sole has it */
    bool of_point;            /* a contact that is no sole has it */
    unsigned pushes;          /* of a point: bit per stance_push that has it; 0: any */
    unsigned grounds;         /* of a plate: bit per stance_ground_kind that has it */
};
extern const struct part_key part_keys[];
extern const size_t part_key_count;

/* One of them, which there is. */
const struct part_key *part_key(enum part part, const char *name);

int part_count(const stance_mechanism *m, enum part part);
const char *part_name(const stance_mechanism *m, enum part part, int i);
/* The body that it belongs to; of a body its parent, or -1, as of a plate. */
int part_body(const stance_mechanism *m, enum part part, int i);
/* Makes part i be called so and belong to a body, unless it is a plate. */
void part_put(stance_mechanism *m, enum part part, int i, const char *name, int body);

/* How many numbers a key takes: 0, 1, 2. */
int part_numbers(const struct part_key *key);
/* Where the first number of a key of part i stands in m->value, as an array of doubles; -1: what
 * part i is has no such number. */
int part_place(const stance_mechanism *m, const struct part_key *key, int i);
/* Which number of the scene's robot[] that place is; -1: none. */
int part_robot(const stance_mechanism *m, int place);

/* The unit of a number of part i: newtons and metres where the joint slides. */
const char *part_unit(const stance_mechanism *m, const struct part_key *key, int i);

/* The rows of schema->scene->mechanism, made from `row`: robot.* or controller.model.*, which has
 * those of numbers alone. False: no room. */
bool schema_add_mechanism(struct schema *schema, const struct scenario_field *row);

/* The row of ground.plates, and those of its pieces. Where there are none, documentation has one
 * whose name stands for any. False: no room. */
#define PLATE_PATTERN "PLATE"
bool schema_add_plates(struct schema *schema, const struct scenario_field *row);

#endif
