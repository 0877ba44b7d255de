/* table.h - one writer of tables: text for people, comma-separated values and JSON for programs.
 *
 * A table is columns and rows of values, a row after the other. Programs get each column by its
 * name. People get those that a view lists, in its order, each under its heading, as wide as its
 * longest cell and at least as wide as the column says.
 */
#ifndef STANCE_TABLE_TABLE_H
#define STANCE_TABLE_TABLE_H

#include "runner/base/command.h"
#include "runner/base/say.h"
#include "runner/store/results.h"

#include <jansson.h>
#include <math.h>
#include <stdio.h>

/* What a command is asked for, with --json, --csv or neither. */
enum table_form { TABLE_AS_TEXT, TABLE_AS_CSV, TABLE_AS_JSON };
/* Their rows, which say in `text` what there is. */
#define TABLE_CSV(type, member) "--csv", OPTION_TO(type, member), .low = TABLE_AS_CSV
#define TABLE_JSON(type, member)                                                                   \
    "--json", OPTION_TO(type, member), .low = TABLE_AS_JSON, .without = "--csv"

enum table_kind {
    TABLE_NOTHING, /* text: the column's word for it; CSV: empty; JSON: null */
    TABLE_TEXT,
    TABLE_NUMBER, /* NAN and infinities: nothing, but in CSV "inf" or "-inf" */
    TABLE_WHOLE,
    TABLE_PLACE, /* a point of an axis: its word or its number */
    TABLE_TREE,  /* of JSON, where alone its column is */
};

/* Texts and axes are borrowed until the row is added, a tree is taken over. */
struct table_value {
    enum table_kind kind;
    const char *text; /* of TABLE_NOTHING: for people, NULL: as the column says */
    double number;
    uint64_t whole; /* number of the point of a TABLE_PLACE */
    const struct results_axis *axis;
    json_t *tree;
};

static inline struct table_value as_nothing(const char *text)
{
    return (struct table_value){.kind = TABLE_NOTHING, .text = text};
}
/* NULL: nothing. */
static inline struct table_value as_text(const char *text)
{
    return (struct table_value){.kind = text ? TABLE_TEXT : TABLE_NOTHING, .text = text};
}
static inline struct table_value as_number(double number)
{
    return (struct table_value){.kind = TABLE_NUMBER, .number = number};
}
static inline struct table_value as_whole(uint64_t whole)
{
    return (struct table_value){.kind = TABLE_WHOLE, .whole = whole};
}
static inline struct table_value as_place(const struct results_axis *axis, size_t i)
{
    return (struct table_value){.kind = TABLE_PLACE, .whole = i, .axis = axis};
}
/* A value of what is varied; an absent limit, which is infinite, is "none". */
static inline struct table_value as_varied(const struct results_varied *v, double value)
{
    return v->word        ? as_text(v->word[(int)value])
           : isinf(value) ? as_text("none")
                          : as_number(value);
}
/* NULL: null. */
static inline struct table_value as_tree(json_t *tree)
{
    return (struct table_value){.kind = TABLE_TREE, .tree = tree};
}
static inline struct table_value as_truth(bool truth)
{
    return as_tree(json_boolean(truth));
}

/* ---- tables ------------------------------------------------------------------------------- */

/* Forms in which programs do not get a column. */
enum { TABLE_NO_CSV = 1, TABLE_NO_JSON = 2, TABLE_VIEW_ONLY = TABLE_NO_CSV | TABLE_NO_JSON };

struct table_column {
    const char *name;    /* for programs; begins with '.': for people, see say.h */
    const char *heading; /* for people; NULL: none, not even blanks in its place */
    const char *format;  /* of numbers, as printf has it; NULL: "%.6g", or all digits */
    int width;           /* letters at least */
    bool left;           /* aligned to the left */
    int hidden;          /* enum above */
    bool percent;        /* people see numbers a hundredfold; the format says % */
    bool joined;         /* people see it at the end of the cell before */
    const char *before;  /* text before the cell; NULL: a blank, two at the beginning of a line */
    const char *empty;   /* of nothing; NULL: "-" */
    const char *group, *key; /* JSON: it stands in an object `group`; NULL: in the row; under the
                              * name `key`; NULL: `name` */
};

struct table {
    size_t columns, cells, rooms, letters, letter_rooms;
    struct table_column *column; /* [columns], names and headings its own */
    struct table_value *cell;    /* [cells]; of texts `whole` says where in `letter` they are */
    char *letter;
    bool failed; /* no memory */
    bool closed; /* its columns are known */
    bool begun;  /* its head has been written */
    bool named;  /* see table_give */
};

/* A fact of a row: what column it stands in, and its value. */
struct table_fact {
    struct table_column column;
    struct table_value value;
};

/* {0} is a table without columns. Without memory nothing is added, and all writers return false.
 * Columns are either added before the first row, whose values then follow in one call or several;
 * or rows are made of facts, of which those of the first row make the columns, and those of the
 * others are as many in the same order. */
void table_columns(struct table *t, const struct table_column *column, size_t count);
void table_values(struct table *t, const struct table_value *value, size_t count);
void table_facts(struct table *t, const struct table_fact *fact, size_t count);
void table_end_row(struct table *t); /* of facts */
#define TABLE_LIST(type, ...)                                                                      \
    (const struct type[]){__VA_ARGS__},                                                            \
        sizeof((const struct type[]){__VA_ARGS__}) / sizeof(struct type)
#define TABLE_COLUMNS(t, ...) table_columns(t, TABLE_LIST(table_column, __VA_ARGS__))
#define TABLE_VALUES(t, ...) table_values(t, TABLE_LIST(table_value, __VA_ARGS__))
#define TABLE_FACTS(t, ...) table_facts(t, TABLE_LIST(table_fact, __VA_ARGS__))
/* What is said of something may be listed once, a row a fact, from which come its values and its
 * keys in -h (struct say_key); the values stand where they are at hand:
 *
 *   #define ROW(X)                                                                             \
 *       X("cases", "", as_whole(row->cases), "cases", .width = 10)                             \
 *       X("lost", "of these, null: unknown", as_number(row->lost), "lost", "%.3f %%")
 *
 *   TABLE_FACTS(&t, ROW(TABLE_FACT)), or TABLE_OBJECT(ROW(TABLE_MEMBER)) of what is no table
 *   static const struct say_key keys[] = {ROW(TABLE_KEY){0}};
 *
 * X(name, text, value, what the column is behind its name). Text NULL: JSON has no such key. */
#define TABLE_FACT(key, text, value, ...) {{.name = key, __VA_ARGS__}, value},
#define TABLE_MEMBER(key, text, value, ...) {key, value},
#define TABLE_KEY(key, text, ...) {key, text, NULL},
#define TABLE_KEY_AT {"at", "{path: value}", NULL}, /* of table_axes */
/* The values of some axes at one point[] of all axes; programs find them in JSON's object `at`. */
void table_axes(struct table *t, const struct results *r, const int *axis, int count,
                const size_t *point);
size_t table_rows(const struct table *t);
/* Drops the rows; what is written next goes on, without a head. */
void table_clear(struct table *t);
void table_free(struct table *t);

/* Each returns false when memory or the output fails. `view` names the columns that people see,
 * in their order, blanks between them; "GROUP/" stands for all of a group. Of more than `most` rows
 * that many are written, from the first to the last, and it is said so; 0: all are. */
bool table_write_text(const struct table *t, FILE *out, const char *view, size_t most);
bool table_write_csv(const struct table *t, FILE *out);
/* A list of objects, or one object of them by the text of the first column; NULL: no memory. */
json_t *table_json(const struct table *t, bool by_name);

/* ---- JSON --------------------------------------------------------------------------------- */

struct table_member {
    const char *key;
    struct table_value value;
};
/* An object; text that is no UTF-8 has '?' in its place. NULL: no memory. */
json_t *table_object(const struct table_member *member, size_t count);
#define TABLE_OBJECT(...) table_object(TABLE_LIST(table_member, __VA_ARGS__))
/* Adds members to an object; an object to a list. */
#define TABLE_PUT(object, ...) json_object_update_new(object, TABLE_OBJECT(__VA_ARGS__))
#define TABLE_APPEND(list, ...) json_array_append_new(list, TABLE_OBJECT(__VA_ARGS__))
/* New reference. */
json_t *table_value_json(struct table_value value);
/* A list of texts; of NULL none, which is NULL. */
json_t *table_list(const char *const *text, size_t count);
static inline json_t *table_texts(const char *first, const char *second)
{
    return table_list((const char *[]){first, second}, 2);
}
/* [low, high] */
json_t *table_pair(double low, double high);
/* {path: value} of the axes at one point[]; which[axes] of them, NULL: all. */
json_t *table_at(const struct results *r, const bool *which, const size_t *point);
/* Adds to an object, of a place with what it is for people, and its unit, as `.key`; to a list. */
void table_put(json_t *object, const char *key, struct table_value value);
static inline void table_append(json_t *list, struct table_value value)
{
    json_array_append_new(list, table_value_json(value));
}
/* The same for people, but for those not in `which`: "a = 0.1 rad, b = 3". */
void table_at_text(const struct results *r, const bool *which, const size_t *point, char *text,
                   size_t size);
/* Adds to facts (say.h) the rows as a list, or if the table is `named` as an object by the first
 * column, under the key; and what a view shows of them, NULL: nothing, as `.key`. Of a key that
 * begins with '.' the latter alone. Returns the facts; without memory releases them: NULL. */
json_t *table_show(json_t *facts, const char *key, const struct table *t, const char *view,
                   size_t most);
/* The same of a table that it frees; false: no memory. */
bool table_give(json_t *facts, const char *key, struct table *t, const char *view, size_t most);
/* Facts as JSON or text, or a table as CSV, to standard output; releases both. */
bool table_say(enum table_form form, json_t *facts, const char *text, struct table *csv);
/* Writes it, with the end of a line, and releases it. */
bool table_write_json(json_t *root, FILE *out);

#endif
