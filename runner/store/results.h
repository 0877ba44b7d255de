/* results.h - a results file, opened for reading: axes, answers, trajectories, attributes.
 *
 * The layout is described in runner/store/store.h. Files may be incomplete (their job still runs or
 * was killed), damaged, or not ours at all: every function that can fail returns false and writes
 * one line into *message. Nothing is ever written to the file.
 */
#ifndef STANCE_STORE_RESULTS_H
#define STANCE_STORE_RESULTS_H

#include "store.h"

#include "runner/scenario/scenario.h"

/* What became of a case: its outcome, or why it has none; in the order of legends. */
#define RESULTS_OTHER_KINDS(X)                                                                     \
    X(DONE, "done") /* the outcome was not stored */                                               \
    X(FAILED, "failed")                                                                            \
    X(PENDING, "pending")

enum results_kind {
#define RESULTS_OUTCOME(NAME, ...) RESULTS_##NAME,
    STANCE_OUTCOMES(RESULTS_OUTCOME)
#define RESULTS_KIND(name, text) RESULTS_##name,
        RESULTS_OTHER_KINDS(RESULTS_KIND) RESULTS_KIND_COUNT,
    RESULTS_OUTCOMES = RESULTS_DONE, /* the outcomes come first */
};

extern const char *const results_kind_names[RESULTS_KIND_COUNT];
/* The names of outcomes, and of all, for options: NULL from the last on. */
const char *results_outcome_word(size_t k);
const char *results_kind_word(size_t k);

enum { RESULTS_TEXT = 160, RESULTS_NAME = 256 };

/* One dimension of the cases. */
struct results_axis {
    char name[96];           /* path of the field, or "case" */
    char unit[24];           /* "" where it has none */
    char text[RESULTS_TEXT]; /* long name, "" where it has none */
    size_t count;
    double *value; /* [count]; for words 0, 1, 2 ... */
    char **word;   /* [count], or NULL: the axis lists numbers, finite ones; numbers among which a
                      limit is "none" are words, too */
    bool offset;   /* initial.offset.*: zero is the equilibrium */
};

/* A path that sweep.sample varies. */
struct results_varied {
    struct results_axis of; /* name, unit, text, value[points]; of words their places in `word` */
    int factor;             /* which moves it, 0 ... */
    char (*word)[SCENARIO_NAME]; /* [words], or NULL: numbers, which may be infinite */
    int words;
};

struct results {
    char file[1024];
    char name[RESULTS_NAME]; /* file name without directory and .h5 */
    char title[256], version[64], revision[96], date[40], hosts[256];
    int ranks;
    char *scenario;        /* text */
    struct scenario *read; /* what it says; NULL: this version cannot read it */
    bool single; /* one case, no axes; `index` is its flat index in the sweep, 0 without one */
    uint64_t index;
    int axes;
    struct results_axis axis[SCENARIO_MAX_AXES];
    int sample;        /* the axis of the points of sweep.sample, the last one; -1: there is none */
    char method[16];   /* of the design */
    bool other_points; /* made by a generator that this version does not have */
    size_t block;      /* points that hang together; 1 without a sample */
    int varied;
    struct results_varied *vary; /* [varied], in the order of the scenario */
    uint64_t cases;
    struct shard shard;         /* whose file it is; count 0: all cases' */
    struct store_damage damage; /* cases that do not verify, and therefore count as pending */
    uint8_t *kind;              /* [cases] enum results_kind, row-major over the axes */
    uint8_t *failure;           /* [cases] enum stance_failure, or NULL: not stored */
    int64_t id;                 /* of the open file, for results.c */
};

/* Opens and reads all but the answers; verifies the checksums that the file has over its axes, its
 * designs and its scenario, and over each case: cases that do not verify count as pending, and a
 * line on standard error says so. On failure nothing is left open. */
bool results_open(struct results *r, const char *file, stance_message *message);
/* The name of a file without its directory and .h5. */
void results_stem(const char *file, char name[RESULTS_NAME]);
void results_close(struct results *r);
/* That line; nothing when every case verifies. */
void results_warn(const struct results *r);

/* The numbers of a variable over the cases, NAN where a case is not done; *values[cases] is freed
 * by the caller. A variable that is not stored gives *values = NULL and true. */
bool results_answer(const struct results *r, const char *name, double **values,
                    stance_message *message);

/* The same of some rows at a time, for tables of files of any length. */
struct results_column {
    char name[96];
    int64_t id;   /* HDF5 identifier */
    size_t width; /* numbers per case: 1, or the length of a last dimension of its own */
    char *words;  /* flag_meanings, separated by blanks; NULL: none */
};

/* False with one line in *message; a variable that is not stored gives id < 0 and true. */
bool results_column_open(const struct results *r, const char *name, struct results_column *column,
                         stance_message *message);
void results_column_close(struct results_column *column);

/* Reads rows from `first` on, values[rows * width], whatever the status of the cases. */
bool results_column_read(const struct results *r, const struct results_column *column,
                         uint64_t first, size_t rows, double *values, stance_message *message);

/* The scenarios that the file was made from, where a run went on with another one than it was begun
 * with (runner/store/adopt.h). */
struct ancestry {
    size_t scenarios;                                   /* 1: as usual */
    char date[STORE_MOST_ANCESTORS + 1][SCENARIO_NAME]; /* of each: when it was first run */
    uint64_t done[STORE_MOST_ANCESTORS + 1]; /* cases done with it; where scenarios > 1 */
};

/* false: the file's numbers cannot be read. */
bool ancestry_read(const struct results *r, struct ancestry *ancestry, stance_message *message);

/* A variable of at most `room` numbers, whatever its shape: `final_state` of a file of one case,
 * `timing/wall_time`, a design that no axis changes. Returns how many were read, 0 when it does not
 * exist, is larger or cannot be read. */
size_t results_numbers(const struct results *r, const char *path, double *values, size_t room);

/* Words of a dimension such as `state` or `trajectory/coordinate`; word[room]. Returns how many. */
size_t results_words(const struct results *r, const char *path, char word[][SCENARIO_NAME],
                     size_t room);

/* Group `timing`: seconds of computing of the rank that computed longest and of all ranks together,
 * cases computed, number of ranks. false when there is none. */
bool results_timing(const struct results *r, double *longest, double *total, double *cases,
                    size_t *ranks);

/* Coordinates of a case: point[axes]. */
void results_point(const struct results *r, uint64_t index, size_t *point);
/* A number for people: six significant digits, more only where `gap`, the distance from the nearest
 * number that it must not be taken for (0: there is none), asks for them; "none" where infinite. */
void results_number_text(double value, double gap, char *buffer, size_t size);
/* Text of a value of an axis, with its unit when `unit`; no other of the axis has the same. */
void results_value_text(const struct results_axis *axis, size_t i, bool unit, char *buffer,
                        size_t size);
/* Of the two between which the values of an axis lie, the second with its unit. Returns what to say
 * of their order: ", not sorted", or nothing. */
const char *results_ends_text(const struct results_axis *axis, char *first, char *last,
                              size_t size);
/* The same of a point of a sample. */
void results_varied_text(const struct results_varied *v, size_t i, bool unit, char *buffer,
                         size_t size);
/* "initial.offset.theta = -0.04 rad, sample = 3 (ground.friction = 0.4), ..." of a case; "" in a
 * file of one case. */
void results_case_text(const struct results *r, uint64_t index, char *buffer, size_t size);

/* Bytes of the UTF-8 letter at `text`, 0 when there is none: what a damaged file holds is not
 * printed as it is. A file's titles, units, words and names of axes have been cleaned: bytes that
 * are no letters are '?', control characters blanks. */
int results_letter(const char *text);
void results_clean(char *text);

/* The scenario once more, to be changed and freed; false when this version cannot read it. */
bool results_scenario(const struct results *r, struct scenario *s);
/* r->read, whose axes must be the file's: its cases are the file's. NULL: *message says why not. */
const struct scenario *results_swept(const struct results *r, stance_message *message);

/* ---- trajectories ------------------------------------------------------------------------- */

struct results_trajectory {
    uint64_t index; /* flat index of the case */
    size_t rows;    /* up to the end of the case */
    size_t coordinates, actuators, contacts;
    char coordinate[STANCE_MAX_COORDINATES][SCENARIO_NAME],
        actuator[STANCE_MAX_ACTUATORS][SCENARIO_NAME], contact[STANCE_MAX_CONTACTS][SCENARIO_NAME];
    double *time;                /* [rows] */
    double *position, *velocity; /* [rows][coordinates] */
    double *torque;              /* [rows][actuators], or NULL */
    double *force;               /* [rows][contacts][2]: normal, tangential */
    double *gap;                 /* [rows][contacts] */
};

/* Number of recorded cases; place k holds case (*list)[k], freed by the caller. */
bool results_recorded(const struct results *r, uint64_t **list, size_t *count,
                      stance_message *message);
bool results_trajectory(const struct results *r, size_t place, uint64_t index,
                        struct results_trajectory *t, stance_message *message);
void results_trajectory_free(struct results_trajectory *t);

#endif
