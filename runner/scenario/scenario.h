/* scenario.h - a scenario file, read, checked and resolved.
 *
 * scenario text -> tree of nodes with line and column (libyaml) -> checked against one table of
 * keys (schema_rows.c: path, type, unit, default, range, documentation) -> struct scenario.
 * Nothing here runs a simulation.
 */
#ifndef STANCE_SCENARIO_SCENARIO_H
#define STANCE_SCENARIO_SCENARIO_H

#include "doe.h"
#include "law_file.h"

#include "engine/mechanism.h"

#include <stdio.h>

enum {
    SCENARIO_MAX_AXES = 24,
    SCENARIO_MAX_PATHS = 48, /* paths of one axis */
    SCENARIO_MAX_STAGES = 8, /* of a search, each with more starts */
    SCENARIO_MAX_RESTARTS = 12,
    SCENARIO_MAX_STATES = 2 * STANCE_MAX_COORDINATES,
    SCENARIO_MAX_GAINS = STANCE_MAX_ACTUATORS * 2 * STANCE_MAX_POSTURE,
    SCENARIO_MAX_POLES = 2 * STANCE_MAX_POSTURE,
    /* bytes of the name of a rate, a contact, a selection of coordinates */
    SCENARIO_NAME = STANCE_MAX_ACTUATORS * STANCE_NAME + 8,
    SCENARIO_FINAL_STATE = STANCE_ANSWER_COUNT, /* bit of `answers` for final_state */
};
_Static_assert(SCENARIO_FINAL_STATE < 63, "bits for all answers");

/* Most points of a map that is refined: each takes two to four bytes in the memory of every rank.
 */
#define SCENARIO_MOST_REFINED 0x1p28

enum scenario_design { DESIGN_PLACE, DESIGN_PLACE_SCHUR, DESIGN_LQR, DESIGN_GAINS };
enum scenario_design_time { DESIGN_CONTINUOUS, DESIGN_SAMPLED };
enum scenario_record { RECORD_NONE, RECORD_ALL, RECORD_LIST };

/* Which member of the family of equilibria, as the user gave it: NAN where not given. */
struct scenario_equilibrium {
    bool given;
    double posture[STANCE_MAX_POSTURE];
    int branch; /* of several, from 0 */
};

/* What a case (stance_case) has by the same name and takes as it is; words by their place in the
 * schema, contacts as bits. */
/* clang-format off */
#define SCENARIO_WHOLES(X) \
    X(impacts) X(most_energy) X(lands_ahead) X(contacts) X(delay) X(settle) X(footfalls) X(walk_steps) \
    X(walk_enough)
#define SCENARIO_NUMBERS(X) \
    X(friction) X(restitution) X(torque_limit) X(lag) X(angle_noise) X(rate_noise) X(noise) \
    X(settle_angle) X(settle_rate) X(settle_hold) X(walk_length) X(walk_time) X(walk_angle) \
    X(walk_rate)
/* clang-format on */

/* Everything that one case needs, as numbers: a sweep changes fields of this struct only, found
 * by their offset. Enumerations and indices are ints, all else double. */
struct scenario_values {
    const stance_program *program; /* of a law of the user's own; NULL: not compiled yet, it then
                                    * commands nothing. First: no field has the offset 0 */
    double robot[STANCE_MAX_ROBOT];
#define SCENARIO_WHOLE(name) int name;
    SCENARIO_WHOLES(SCENARIO_WHOLE)
#define SCENARIO_NUMBER(name) double name;
    SCENARIO_NUMBERS(SCENARIO_NUMBER)

    struct scenario_equilibrium equilibrium; /* initial.equilibrium */
    int support_foot;                        /* 1-based contact; 0: none */
    int support; /* where feet have no numbers: contacts, a bit each; 0: none */
    double offset[SCENARIO_MAX_STATES]; /* positions, then velocities, in the scene's order */
    double offset_scale;                /* of all of them */
    int state_given;                    /* initial.state instead of an equilibrium */
    double state[SCENARIO_MAX_STATES];

    int law;                        /* index into stance_laws() */
    int design;                     /* enum scenario_design */
    int design_time;                /* enum scenario_design_time: the model of the design */
    double model[STANCE_MAX_ROBOT]; /* the robot that the design believes in; NAN: as robot */
    struct scenario_equilibrium design_point; /* controller.equilibrium; not given: initial's */
    /* In the order of a list, or in their states' places; NAN or 0: none. */
    double pole_re[SCENARIO_MAX_POLES], pole_im[SCENARIO_MAX_POLES];
    double gains[SCENARIO_MAX_GAINS]; /* [actuators][2 postures] */
    double state_weights[SCENARIO_MAX_POLES], torque_weights[STANCE_MAX_ACTUATORS]; /* lqr */
    /* Of each law (stance_law_first) its parameters as stance_law.set takes them; NAN: as it is at
     * the beginning. What is a selection is an int in the first bytes of its place. */
    double law_value[STANCE_LAW_PARAMETERS * STANCE_LAW_ROOM];
    double parameter[STANCE_PROGRAM_NUMBERS]; /* of a law of the user's own, see law_file.h */
    int far;                      /* what acts far from the target, see scenario_far; 0: none */
    double near_angle, near_rate; /* semi-axes of the ellipsoid that is near */
    double sample_time;           /* 0: continuous */
    double torque_limits[STANCE_MAX_ACTUATORS], torque_rate; /* INFINITY: none */

    int method;             /* index into stance_methods() */
    double step, tolerance; /* tolerance: NAN: the method's own */

    double stop_time, settle_place;
};

struct scenario_field; /* a row of the schema, see schema.h */

/* What there is to know of a path that sweep.sample varies. */
struct scenario_meaning {
    char unit[24], text[160]; /* as of an axis */
    char *words;              /* of an enumeration, separated by blanks; NULL: it is none */
};

/* One axis of the grid: `count` points; along it `paths` fields change together. The last axis may
 * be that of sweep.sample: its points are those of the design. */
struct scenario_axis {
    char name[96];  /* the path as written (the first one), used as dimension name; or "sample" */
    char unit[24];  /* of the first path, "1" where it has none */
    char text[160]; /* its documentation, as long_name */
    int paths;
    char path[SCENARIO_MAX_PATHS][96];
    size_t offset[SCENARIO_MAX_PATHS];    /* of the field in struct scenario_values */
    bool integer[SCENARIO_MAX_PATHS];     /* the field is an int (an enumeration: words below) */
    bool enumeration[SCENARIO_MAX_PATHS]; /* ... of words */
    bool whole[SCENARIO_MAX_PATHS];       /* its values are whole numbers, or words */
    bool words;                           /* some path is an enumeration: the axis lists strings */
    bool design;                          /* some path changes what the design depends on */
    size_t count;
    /* value[point * paths + k] for lists and logarithmic ranges; for linear ranges NULL: computed
     * from `from` and `to`. Words are stored as the enumeration's numbers; on an axis of words
     * word[point * paths + k] is the text of every value, numbers as they were written. */
    double *value;
    char **word;
    double from, to;
    bool log;
    bool refined;                     /* sweep.refine leaves points of it out */
    bool sample;                      /* the points of sweep.sample; `words` is false */
    struct scenario_meaning *meaning; /* sample: [paths] */
    int line, column;
};

/* One entry of sweep.sample.vary: where the unit interval goes. */
struct scenario_factor {
    int first, paths; /* of the axis: what it moves together */
    bool listed;      /* `values`, each equally likely */
    bool log;
    size_t points; /* listed: how many; else 2: from and to */
    double *value; /* [points * paths] */
};

/* sweep.sample: a design in the unit cube, and what its factors are; the axis of its points is the
 * last one. Without it `given` is false. */
struct scenario_sample {
    bool given;
    struct doe design;              /* without its tables: doe_begin makes them */
    struct scenario_factor *factor; /* [design.factors] */
};

/* sweep.refine: which cases are simulated depends on what others became, see refine.h. */
struct scenario_refine {
    bool given;
    size_t start, margin;
    double probes;
};

/* How a number that a search varies is moved: evenly, or by equal ratios. */
enum scenario_scale { SCALE_EVEN, SCALE_RATIO, SCALE_NEGATIVE_RATIO };
enum scenario_aim { AIM_SHARE, AIM_NEAREST, AIM_ANSWER };

/* optimise: what a search for a better controller varies, and what counts as better; the first
 * candidate is the scenario as it is. See runner/optimise. */
struct scenario_search {
    bool given;
    bool designed_gains;       /* gains are varied that the scenario's design is to give first */
    struct scenario_axis axis; /* what is varied: its paths, without points */
    struct scenario_varied {
        enum scenario_scale scale;
        double low, high; /* INFINITY: none */
        double unit;      /* of the number or, with ratios, of its logarithm; NAN: a gain's own */
        bool bounded;     /* by `from` and `to` */
    } varied[SCENARIO_MAX_PATHS];
    enum scenario_aim aim;
    int answer;                                    /* AIM_ANSWER: which */
    double price[STANCE_ANSWER_COUNT], gain_price; /* of a unit of an answer, of the gains' norm */
    bool normal;                                   /* starts near the middle count more */
    bool worst;                                    /* over circumstances; false: the mean */
    double critical;                               /* s; NAN: twice the sample time */
    uint64_t candidates, grow[SCENARIO_MAX_STAGES], confirm;
    int stages, restarts;
    double step; /* of the first generation, in units */
};

struct scenario_place {
    char path[96];
    int line, column;
};

struct scenario {
    char file[1024];
    char name[256]; /* file name without directory and .yaml */
    char title[256];
    const stance_scene *scene;
    stance_scene *own_scene; /* that the file describes; NULL: `scene` is one of stance_scenes() */
    struct scenario_values base;
    uint64_t seed;

    int axes;
    struct scenario_axis axis[SCENARIO_MAX_AXES];
    uint64_t cases; /* product of the counts; 1 without a sweep */
    struct scenario_sample sample;
    struct scenario_refine refine;
    struct scenario_search search;

    double record_every; /* s; 0: not given, and no trajectories */
    enum scenario_record record_cases;
    uint64_t *record_list; /* sorted, unique, all < cases */
    size_t record_count;
    uint64_t answers; /* bit per row of STANCE_ANSWERS, then SCENARIO_FINAL_STATE; all ones by
                       * default */

    struct law_file law; /* of the user's own; without a source there is none */
    stance_program *program;
    void (*program_free)(stance_program *program);

    char *text; /* resolved scenario: after --set, as YAML; what the file stores and hashes */
    /* Where fields stand, for errors found later (design, initial state). */
    struct scenario_place *place; /* of every key that is given */
    size_t places;
};

/* One error or many on `errors` (NULL: nowhere) as "FILE:LINE:COLUMN: message"; false then, and *s
 * is empty.
 * `sets`: PATH=VALUE strings of --set. Reads a file, or (text not NULL) that text under the name
 * `file`. */
bool scenario_read(struct scenario *s, const char *file, const char *text, const char *const *sets,
                   size_t set_count, FILE *errors);
void scenario_free(struct scenario *s);
/* One of its own, released by scenario_drop, which takes NULL, too. NULL: it cannot be read. */
struct scenario *scenario_new(const char *file, const char *text, const char *const *sets,
                              size_t set_count, FILE *errors);
void scenario_drop(struct scenario *s);

/* A scenario's text with `set` (PATH=VALUE) and without the keys `drop`, paths of mappings' keys;
 * what is not there need not be dropped. Freed by the caller. NULL: no memory, or no such path. */
char *scenario_rewrite(const char *text, const char *const *drop, size_t drops,
                       const char *const *set, size_t sets);

/* Of a scenario with a search: whether its objective is the plain share of starts; cases that it
 * simulates at most. */
bool scenario_search_plain(const struct scenario *s);
double scenario_search_cases(const struct scenario *s);
/* Share of the candidates up to the end of a stage: of three stages 50, 35 and 15 %, of others
 * equal parts. */
double scenario_search_until(const struct scenario *s, int stage);

/* Where the key stands that a message begins with ("controller.poles: ..."), or the nearest mapping
 * around it. False: it does not begin with a key that is given; line and column stay. */
bool scenario_place(const struct scenario *s, const char *text, int *line, int *column);

/* Value k of point `i` of an axis (k < paths); for words the enumeration's number. */
double scenario_axis_value(const struct scenario_axis *axis, size_t i, int k);
/* Between which two places the values of an axis lie: its first and its last where it is sorted,
 * rising or falling (or `value` is NULL: a range, words); else, false, its least and its largest.
 */
bool scenario_ends(const double *value, size_t count, size_t stride, size_t ends[2]);
/* The axis that varies the field at an offset, which is its path *k; NULL: none does. */
const struct scenario_axis *scenario_axis_of(const struct scenario *s, size_t offset, int *k);
/* Whether a word, or whole number, takes a value in some case: of those that list them, an axis; of
 * a range, which has no words, its base. */
bool scenario_takes(const struct scenario *s, size_t offset, int word);
/* Least and largest value that a number takes, base or swept. */
void scenario_extent(const struct scenario *s, size_t offset, double *least, double *largest);
/* Gives the last axis the first `count` points of the design that sweep.sample describes, made with
 * another seed. False: no memory. */
bool scenario_resample(struct scenario *s, uint64_t count, uint64_t seed);
/* Text of that value, for messages and pictures; of an infinite one "none". */
void scenario_axis_text(const struct scenario_axis *axis, size_t i, int k, char *buffer,
                        size_t size);

/* Where a case stands on the grid axes alone, flat, and which point of sweep.sample it has (0
 * without one). By these random numbers are keyed: they do not depend on sweep.sample.count. */
void scenario_case_keys(const struct scenario *s, uint64_t index, uint64_t *grid, uint64_t *sample);

/* Puts a number, or (`integer`) a word or whole number, at the offset of its field. */
void scenario_put(struct scenario_values *values, size_t offset, bool integer, double value);
/* Fields of case `index` (flat, row-major in the order of the axes): base, then the axes. */
void scenario_case_values(const struct scenario *s, uint64_t index, struct scenario_values *values);

/* Whether a path is a coordinate of the start: initial.offset.* but its scale, initial.state.*. */
bool scenario_is_start(const char *path);

/* Whether two scenarios have the same scene, but for the numbers of a mechanism. */
bool scenario_same_scene(const struct scenario *a, const struct scenario *b);

/* Have its feet numbers, as initial.support_foot has them, and branches of its equilibria words? */
bool scenario_numbers_feet(const stance_scene *scene);

/* The contacts that the robot stands on, a bit each; 0: none has to carry it. */
uint32_t scenario_supports(const stance_scene *scene, const struct scenario_values *values);

/* The poles that are given; returns how many. */
int scenario_poles(const struct scenario_values *values, double re[SCENARIO_MAX_POLES],
                   double im[SCENARIO_MAX_POLES]);
/* Name of an angle of the posture or, behind them all, of its rate: as a list has them. */
const char *scenario_state_name(const stance_scene *scene, int i, char name[SCENARIO_NAME]);

/* "; idle there, with their rates: foot1": coordinates that are no states while the contacts of an
 * equilibrium hold; empty: all are. Returns `text`. */
const char *scenario_idle(const stance_scene *scene, const stance_equilibrium *e, char *text,
                          size_t size);

/* The law that acts, and the one far from its target: `none` where there is no other. */
const stance_law *scenario_law(const struct scenario_values *values);
const stance_law *scenario_far(const struct scenario_values *values);
/* The numbers of a law's parameter, by coordinates or actuators. Both must exist. */
/* Name of a selection of coordinates (stance_selection): "x-theta". False: there is none. */
bool scenario_selection_name(const stance_scene *scene, int selection, char name[SCENARIO_NAME]);
const double *scenario_law_value(const struct scenario_values *values, const char *law,
                                 const char *parameter);

/* Documentation of the format from the table: all of it, one path, or JSON Schema; of any scenario,
 * or (not NULL) with the names of the robot and the law of that one.
 * false: no such path, or no memory (a message on `errors`); errors of `out` are the caller's. */
bool scenario_describe(const char *path, bool json_schema, const struct scenario *of, FILE *out,
                       FILE *errors);

#endif
