/* description.h - a mechanism while it is read, shared by mechanism.c and description.c. */
#ifndef STANCE_SCENARIO_DESCRIPTION_H
#define STANCE_SCENARIO_DESCRIPTION_H

#include "reader.h"
#include "schema_mechanism.h"

enum { DESCRIPTION_PATH = 192 };

/* One of robot.bodies, .contacts, ..., ground.plates as it stands in the file. */
struct entry {
    const struct tree_key *key;
    const struct tree_node *map;
    stance_joint joint;
    stance_ground_kind ground; /* of a plate */
    int parent, like;          /* of a body: places in the file, or -1 */
    int body;                  /* that any other belongs to */
    bool read;                 /* its numbers are */
};

struct description {
    struct reader *r;
    stance_mechanism *m;
    struct entry entry[PARTS][STANCE_MAX_BODIES];
    struct tree_key carried[PARTS][STANCE_MAX_BODIES]; /* keys of what the file does not write */
    int count[PARTS];
    const char *body_name[STANCE_MAX_BODIES];
    int place[STANCE_MAX_BODIES], back[STANCE_MAX_BODIES]; /* of the file's bodies in m; and back */
    bool given[sizeof(stance_mechanism_numbers) / sizeof(double)]; /* of m->value, as numbers */
};

/* Where the robot stands in the file; of one that it only has ground for, the file. */
static inline struct mark description_mark(struct description *d)
{
    const struct tree_node *const root = d->r->tree.root, *const robot = tree_find(root, "robot");
    return robot ? robot->mark : root->mark;
}

/* "robot.bodies.trunk.mass". Returns path. */
const char *description_path(char path[DESCRIPTION_PATH], enum part part, const struct entry *entry,
                             const char *key);
/* Reports a problem of a key ("": of all) of a part, where that key stands, or else the part: its
 * path and what is wrong. Returns false. */
#define description_refuse(...) (description_report(__VA_ARGS__), as_false())
void description_report(struct description *d, enum part part, const struct entry *entry,
                        const char *key, const char *format, ...)
    __attribute__((format(printf, 5, 6)));

/* Reads the numbers of all parts, whose names and links are in m, and chooses those of robot[].
 * False: a problem. */
bool description_numbers(struct description *d);

#endif
