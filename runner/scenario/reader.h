/* reader.h - the state of reading a scenario, shared by scenario.c, scenario_check.c, sweep.c and
 * doe_scenario.c. */
#ifndef STANCE_SCENARIO_READER_H
#define STANCE_SCENARIO_READER_H

#include "field.h"

/* What is known of a field of the schema. */
struct seen {
    const struct tree_node *node; /* its value in the tree, NULL: not given */
    struct mark key;              /* of its key there */
    bool bad;                     /* given, but not good; already reported */
    bool excused;                 /* not given, but some unknown key is nearly its name */
    bool swept;
    struct mark sweep; /* of the path in the axis */
};

/* A field that an axis varies. */
struct swept_field {
    const struct scenario_field *field;
    size_t index[2];
    struct mark mark;
};

/* A list of a mechanism that has another length than it should: reported when it is known which
 * states are idle. */
struct misfit {
    char path[96];
    const struct tree_node *node;
    size_t items;
    const char *what;
};

struct reader {
    struct scenario *s;
    struct tree tree;
    struct problems problems;
    struct problems hidden; /* letters that cannot be seen: where there are problems, their cause */
    const struct schema *schema;
    struct schema *own_schema; /* of a mechanism of the file */
    struct seen seen[SCHEMA_MAX_FIELDS];
    struct seen nothing; /* of paths that the scene lacks */
    struct swept_field swept[SCENARIO_MAX_AXES][SCENARIO_MAX_PATHS];
    struct swept_field sought[SCENARIO_MAX_PATHS]; /* of optimise */
    bool axes_bad;                                 /* the number of cases is not known */
    struct misfit misfit[2 + STANCE_MAX_ACTUATORS];
    size_t misfits;
};

/* What is known of the field at a path of the schema ("[]" for indices); never NULL, for a path
 * that the scene lacks something that is not given. */
struct seen *reader_seen(struct reader *r, const char *path);

/* The number or word of a field; its default where it is not given, or (*good false) a problem. */
double reader_number(struct reader *r, const char *path, bool *good);

/* Where a key stands, in the sweep first, or else the nearest mapping around it. */
struct mark reader_mark(struct reader *r, const char *path);
/* Reports a problem there: the key and what is wrong with it. */
#define reader_refuse(...) (reader_report(__VA_ARGS__), as_false())
void reader_report(struct reader *r, const char *path, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

static inline bool reader_given(const struct seen *seen)
{
    return seen->node || seen->swept;
}

/* Reports keys of a mapping that the schema does not have below `path`; `name` is the path as it
 * stands in the file, with indices. */
void reader_check_keys(struct reader *r, const struct tree_node *map, const char *path,
                       const char *name);

/* Place of pole i of a list or a mapping in the base values, and its path. */
size_t reader_pole(const struct reader *r, const struct tree_node *poles, size_t i, char path[96]);

/* Reports something else where the mapping of `field` is wanted. */
void reader_no_mapping(struct reader *r, const struct scenario_field *field,
                       const struct tree_node *node);

/* named.c: weights and gains by name become lists, in the tree; then those --set are done that wait
 * for that (named_waits). False: a problem. */
bool named_read(struct reader *r, const char *const *sets, size_t set_count);
bool named_waits(const char *set);
/* Says what list does not fit, and which states are idle. */
void named_misfit(struct reader *r, const struct misfit *misfit);

/* What mechanism_read has read: where keys stand is noted by the reader, no more. */
bool reader_described(const struct reader *r, const char *path);

/* scenario_file.c: the whole file as a string, to be freed by the caller; NULL: a problem. */
char *scenario_text(const char *file, struct problems *problems, size_t *length);

/* A whole text file of `most` bytes at most that the value of a key names, beside the scenario
 * unless it is absolute; of the tree's memory; NULL: a problem. */
const char *reader_file(struct reader *r, const char *key, const struct tree_node *node,
                        size_t most);

/* scenario_check.c: what the keys mean for each other; completes the base values. */
void scenario_cross_check(struct reader *r);

#define MOST_CASES 0x1p53 /* exact as a double, and within what HDF5 can address */

/* The axis being read, or one of the factors that are one: its place in the scenario and in the
 * file. */
enum { AXIS_NAME = 48 };
struct axis_reader {
    struct reader *r;
    struct scenario_axis *axis;
    struct swept_field *swept;    /* [axis->paths] */
    const struct tree_node *node; /* the mapping */
    int number;                   /* of the axis */
    const char *path;             /* of its row: sweep.grid[], sweep.sample.vary[], ... */
    char name[AXIS_NAME];         /* sweep.grid[0], sweep.sample.vary[0], optimise.vary[0] */
    int first;                    /* path of the mapping, ... */
    bool rows;                    /* ... which may have several: then a point is a list */
};

/* sweep.c: the mapping itself, its keys those of the schema below `path`, and its path or paths,
 * behind those that the axis has; `values` stands without a range. False: a problem. */
bool axis_begin(struct axis_reader *a, const char *wanted);
/* sweep.c: the number, or word, of one of these keys; its default where it is not given, or, false,
 * a problem. */
bool axis_read_key(struct axis_reader *a, const char *key, double *value);
/* sweep.c: one more path of the axis, from a node. False: a problem. */
bool axis_read_path(struct axis_reader *a, const struct tree_node *node);
/* No two points of an axis may be the same: those of a list, of a range (distinct.c). */
bool axis_check_values(struct axis_reader *a, const struct tree_node *values);
bool axis_check_points(struct axis_reader *a);
/* sweep.c: the points of a list, *value[*count][paths], to be freed; the ends of a range, each
 * [paths], of which `to` is as `from` where it is not given; `wanted`: what else there is to give.
 * False: a problem. */
bool axis_read_list(struct axis_reader *a, const struct tree_node *values, double **value,
                    size_t *count);
bool axis_read_ends(struct axis_reader *a, const char *wanted, double *from, double *to);
/* sweep.c: unit and text of path k. */
void axis_describe(const struct axis_reader *a, int k, char unit[24], char text[160]);
/* A problem of the mapping as a whole. Returns false. */
static inline bool axis_complain(struct axis_reader *a, const char *what)
{
    return problem_add(&a->r->problems, a->node->mark, "%s: %s", a->name, what);
}
/* "sweep.grid[2]" or "sweep.sample". */
const char *axis_key(const struct scenario *s, int axis, char name[AXIS_NAME]);

/* doe_scenario.c: the last axis from sweep.sample, after the others. */
void doe_read(struct reader *r);
void doe_free(struct scenario_sample *sample);

/* search_scenario.c: the section optimise, after all axes; and what it means for the rest, once the
 * base values are whole. */
void search_read(struct reader *r);
void search_check(struct reader *r);

/* sweep.c: the axes from the value of sweep.grid, into r->s. */
void sweep_read(struct reader *r, const struct tree_node *grid);
/* The keys of sweep.refine, and what they mean for the axes and for what is recorded; after both.
 */
void sweep_read_refine(struct reader *r);
void sweep_free(struct scenario_axis *axis);

#endif
