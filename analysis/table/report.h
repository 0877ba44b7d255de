/* report.h - commands that read one results file and say what they found in it, to people or to
 * programs: what these share.
 */
#ifndef STANCE_TABLE_REPORT_H
#define STANCE_TABLE_REPORT_H

#include "table.h"

#include "runner/base/command.h"
#include "runner/base/message.h"

enum { REPORT_FILES = 12 };

struct report {
    const struct command *command;
    /* Does the work on the open file; returns an exit code. A line in *message is printed to
     * standard error; EXIT_IO without one: no memory, or the output failed. */
    int (*work)(struct report *report, const struct results *r, stance_message *message);
    /* The same on the file of a search, which is no results file, or on several; NULL: it has
     * nothing to say of one. */
    int (*search)(struct report *report, stance_message *message);
    struct option_texts files; /* several of searches */
    const char *file;          /* the first */
    enum table_form form;
};
/* Rows of a command whose `struct request` begins with its report. */
#define REPORT_FILE                                                                                \
    "FILE", OPTION_TO(struct request, report.files), .low = 1, .high = 1, .text = "a results file"
#define REPORT_CSV TABLE_CSV(struct request, report.form)
#define REPORT_JSON TABLE_JSON(struct request, report.form)

/* Says in a message what is wrong with a request; returns EXIT_USAGE. */
#define refuse(message, ...) (complain(message, __VA_ARGS__), EXIT_USAGE)
static inline int report_code(bool good)
{
    return good ? EXIT_DONE : EXIT_IO;
}

/* Opens the file in a sandbox and works on it; returns the exit code. */
int report_run(struct report *report);

#endif
