/* law_file.h - a law of the user's own as its file says it: the source, and what it asks for.
 *
 * A scenario names a C file (controller.file) or holds its text (controller.source), and numbers
 * for it (controller.data), a list or a file of them. What was read from files becomes part of the
 * tree, so that the resolved text is whole: results files hold it, and replay needs no other file.
 * Nothing here compiles or runs it: what PARAMETERS declares is read from the text.
 */
#ifndef STANCE_SCENARIO_LAW_FILE_H
#define STANCE_SCENARIO_LAW_FILE_H

#include "engine/stance.h"

#include <stdbool.h>
#include <stddef.h>

struct reader;
struct schema;

/* A row of PARAMETERS(X): X(name, default, "unit", low, high, "text"), X(name[count], ...). */
struct law_parameter {
    char name[32], unit[24], text[160];
    double fallback, low, high;
    size_t count; /* of a list; 0: one number */
    size_t place; /* of its first number among all */
};

struct law_file {
    char name[256];     /* as the scenario has it */
    const char *source; /* NULL: there is none; its own, as the others are */
    bool held;          /* the scenario holds it, whatever a file of that name does */
    double *data;
    size_t data_count;
    struct law_parameter *parameter;
    size_t parameters, numbers; /* rows, and numbers of all of them */
};

/* Puts the texts of the files into the tree and reads what they declare, of a scenario whose
 * controller.kind or .far is `program`. Problems are the reader's; what is wrong in a law stands
 * behind its own file and line. */
void law_file_read(struct reader *r);
/* With the table of keys: no parameter has the name of another key. */
void law_file_check(struct reader *r);
void law_file_free(struct law_file *law);

/* The rows of the parameters, as schema_build adds rows; false: no room. */
bool law_file_rows(struct schema *schema, const struct law_file *law);

#endif
