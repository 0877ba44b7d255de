/* report.h - commands that read one results file and say what they found in it, to people or to
 * programs: what these share.
 */
#ifndef STANCE_TABLE_REPORT_H
#define STANCE_TABLE_REPORT_H

#include "table.h"

#include "runner/base/command.h"

enum { REPORT_FILES = 12 };

struct report {
    const struct command *command;
    /* Does the work on the open file; returns an exit code. A line in *message is printed to
     * standard error; EXIT_IO without one: no memory, or the output failed. */
    int (*work)(struct report *report, const struct results *r, stance_message *message);
    /* The same on the file of a search, which is no results file, or on several; NULL: it has
     * nothing to say of one. */
    int (*search)(struct report *report, stance_message *message);
    void *request; /* the command's own */
    bool one_form; /* there is neither --json nor --csv */
    const char *file;
    const char *files[REPORT_FILES]; /* `file`, and of searches others */
    size_t count;
    enum table_form form;
};

/* Reads the command line: specs[count], at most 14, --json, --csv and the file. False: the command
 * has ended with *code. */
bool report_options(struct report *report, int argc, char **argv, const struct option_spec *specs,
                    size_t count, int *code);
/* Opens the file in a sandbox and works on it; returns the exit code. */
int report_run(struct report *report);

/* Values of options; NULL: it was not given, and the value stays. False: what is wrong has been
 * said. A number lies between low and high. */
bool report_number(const struct report *report, const char *option, const char *text, double low,
                   double high, bool whole, double *value);
bool report_outcome(const struct report *report, const char *text, enum results_kind *of);

#endif
