/* schema.h - the scenario format as one table: it gives parser, defaults, checks, documentation and
 * JSON Schema.
 *
 * Rows with a '*' in their path stand for the names that a scene brings; schema_build writes them
 * out, and leaves out what the scene has no use for (a controller where nothing acts). "[]" in a
 * path stands for any index of a list.
 */
#ifndef STANCE_SCENARIO_SCHEMA_H
#define STANCE_SCENARIO_SCHEMA_H

#include "scenario.h"

#include "engine/mechanism.h"

enum field_type {
    FIELD_MAP,
    FIELD_TEXT,
    FIELD_NUMBER, /* `words`: words that may stand for it, see field.h */
    FIELD_INTEGER,
    FIELD_WORD,    /* one of `words`; its number is its place there */
    FIELD_WORDS,   /* a list of different words of `words` */
    FIELD_POLES,   /* a list of numbers or complex numbers, pairs complete */
    FIELD_NUMBERS, /* a list of numbers */
    FIELD_MATRIX,  /* a list of lists of numbers */
    FIELD_MAP_OR_WORD,
    FIELD_CASES,   /* a word or a list of case indices */
    FIELD_AXES,    /* a list of mappings */
    FIELD_FACTORS, /* the same, of sweep.sample */
    FIELD_VARIED,  /* a word, or a list of words and mappings: of optimise */
    FIELD_ENDS,    /* a number, or a list of as many as there are paths */
    FIELD_DATA,    /* a list of numbers, or the name of a file */
    FIELD_PATH,    /* path of a field that may be swept */
    FIELD_PATHS,
    FIELD_VALUES, /* what an axis lists */
};

/* When a key may be given, or its field swept. */
enum field_use {
    USE_ALWAYS,
    USE_CONTROL, /* controller.kind is not none */
    USE_LAW,     /* controller.kind or controller.far is `law` */
    USE_FEEDBACK,
    USE_PROGRAM, /* controller.kind or controller.far is a law of the user's own */
    USE_FAR,     /* controller.far is not none */
    USE_PLACE,
    USE_LQR,
    USE_MODEL, /* a design from the model: all but gains */
    USE_GAINS,
    USE_EQUILIBRIUM, /* the scenario starts from initial.equilibrium */
    USE_STATE,       /* ... from initial.state */
    USE_WALKS,       /* stop.walks.steps is above 0 */
    USE_SETTLE,      /* stop.settle is not off */
    USE_SALTELLI,    /* by sweep.sample.method ... */
    USE_MORRIS,
    USE_SHARES,   /* optimise.maximise is not nearest */
    USE_UNSOUGHT, /* there is no optimise */
};

/* What a use asks for: "with controller.design lqr", NULL: nothing, or (USE_LAW) a law; the key
 * that decides it; a use that this one is part of. */
struct schema_use {
    const char *needs, *key;
    enum field_use within;
};
extern const struct schema_use schema_uses[];

/* One row, written out for a scene. */
struct scenario_field {
    char path[96];
    enum field_type type;
    enum field_use use;
    int law;                   /* of USE_LAW: index into stance_laws() */
    bool required;             /* must stand in the file where `use` allows it, unless swept */
    bool design;               /* what the design depends on, see resolve.h */
    bool sweep;                /* may vary along an axis */
    bool whole;                /* FIELD_NUMBER: only whole numbers, kept as a double all the same */
    bool quiet;                /* a summary tells it only where it is not as it is by default */
    const char *samples;       /* why it needs controller.sample_time > 0, other than by default */
    bool by_scene;             /* cannot be checked without a known scene */
    size_t offset;             /* in struct scenario_values; NO_OFFSET: bound by hand */
    char unit[24];             /* "1": without unit; "": not a quantity */
    double fallback;           /* default of a number; of a word its place; NAN: none */
    const char *fallback_text; /* where the default is not a plain number; may be NULL */
    double low, high;
    bool low_open, high_open; /* `low`, `high` itself is out of range */
    size_t items; /* lists of fixed length (poles, rows of the matrix): how many; else 0 */
    size_t columns;
    bool fewer; /* ... may be given */
    const char *const *words;
    size_t word_count;
    char text[160];   /* what it is, in a line; long_name of an axis */
    const char *more; /* what else there is to know; may be NULL */
};

#define NO_OFFSET 0 /* where struct scenario_values has no field */

enum { SCHEMA_MAX_FIELDS = 2048, SCHEMA_MAX_WORDS = 40 };

struct schema {
    const stance_scene *scene; /* NULL: unknown; fields by scene are left out then */
    /* A mechanism without a number is that of the documentation: its names stand for any. */
    bool pattern;
    bool documents; /* with rows for what a scenario may add, by names that stand for any */
    const char *scenes[SCHEMA_MAX_WORDS], *methods[SCHEMA_MAX_WORDS];
    const char *laws[STANCE_MAX_LAWS], *far_laws[STANCE_MAX_LAWS];
    size_t scene_count, method_count, law_count, far_law_count;
    char kinds[600]; /* what there is to know of controller.kind */
    char selection[STANCE_MAX_SELECTIONS][SCENARIO_NAME]; /* "x-theta" */
    const char *selections[STANCE_MAX_SELECTIONS];
    const char *bodies[STANCE_MAX_BODIES], *elements[STANCE_MAX_ELEMENTS]; /* of a mechanism */
    char tolerance[400]; /* what there is to know of method.tolerance */
    size_t count;
    struct scenario_field field[SCHEMA_MAX_FIELDS]; /* [count]; what lies behind is not set */
};

/* Writes the table out for a scene and a law of the user's own (NULL: none), to be read by or, with
 * rows for any piece of the ground, to be documented. False: it has more rows than fit (a scene
 * that is too large). */
bool schema_build(struct schema *schema, const stance_scene *scene, const struct law_file *law,
                  bool documents);
/* Whether its row of a piece of the ground stands for any. */
bool schema_any_plate(const struct schema *schema);

/* The table of a scene and a law. Those of stance_scenes() and of no known scene (NULL), without a
 * law, are written once and kept; another goes to *own, else NULL, to be freed by the caller. NULL:
 * it has more rows than fit, or out of memory. */
const struct schema *schema_of(const stance_scene *scene, const struct law_file *law,
                               struct schema **own);

/* The row of a path, "[]" for indices; NULL: none. */
const struct scenario_field *schema_find(const struct schema *schema, const char *path);

/* The row of a path with indices, "controller.gains[0][3]": the indices go to index[2] (0 where
 * there is none). NULL: no such row, or malformed. */
const struct scenario_field *schema_find_concrete(const struct schema *schema, const char *path,
                                                  size_t index[2]);

/* The row of the mapping or list that a field stands in; NULL: of the whole file. */
const struct scenario_field *schema_parent(const struct schema *schema,
                                           const struct scenario_field *field);

/* A scene whose format has a path (general, or with indices); NULL: none has. */
const stance_scene *schema_scene_with(const char *path);

/* Whether values, of the scenario or of a case, allow a use; those behind USE_SETTLE all do. */
bool schema_allows(enum field_use use, int law, const struct scenario_values *values);
/* Whether its number, or word, asks for a controller.sample_time > 0. */
bool schema_samples(const struct scenario_field *field, const struct scenario_values *values);

/* How many numbers a field with an offset is; one of them, words by their place. Its path, with
 * indices for "[]". */
size_t schema_items(const struct scenario_field *field);
double schema_number(const struct scenario_field *field, const struct scenario_values *values,
                     size_t item);
const char *schema_item_path(const struct scenario_field *field, size_t item, char path[128]);

/* Last names of the paths right below `path` ("" is the top); returns how many, at most `room`. */
size_t schema_children(const struct schema *schema, const char *path, const char **names,
                       size_t room);

/* Where the path's last name begins. */
const char *schema_last_name(const char *path);

/* "0 ... 10", "more than 0, at most 0.1" and the like. */
const char *schema_range_text(const struct scenario_field *field, char *buffer, size_t size);

#endif
