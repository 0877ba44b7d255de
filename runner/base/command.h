/* command.h - what a command is: exit codes, options, help. */
#ifndef STANCE_BASE_COMMAND_H
#define STANCE_BASE_COMMAND_H

#include <stdbool.h>
#include <stddef.h>

enum exit_code {
    EXIT_DONE = 0,
    EXIT_CASES_FAILED = 1, /* some cases failed numerically; for `compare`: the files differ */
    EXIT_USAGE = 2,        /* bad use or bad scenario */
    EXIT_IO = 3,
    EXIT_INTERRUPTED = 4, /* resumable */
};

#define STANCE_VERSION "0.1.0"

/* One command: argv[0] is its name. Returns an exit code. */
struct command {
    const char *name, *synopsis, *summary;
    int (*run)(int argc, char **argv);
    const char *help; /* printed by -h after synopsis and summary */
};

/* Options: long ones only, and -o, -h. `takes_value` options accept "--name VALUE" and
 * "--name=VALUE". A repeatable option collects into `values`. */
struct option_spec {
    const char *name; /* "--set", "-o" */
    bool takes_value;
    const char **values; /* takes_value: filled in order, at most `max` */
    size_t max;
    size_t *count; /* how often it was given */
};

/* A command whose help has "--time-limit" and whose specs have not is ended when that time is up,
 * with one line on standard error and EXIT_INTERRUPTED; what it started in a sandbox ends with it.
 */

/* Splits argv into options and operands (operand[max_operands], *operands). On bad use prints one
 * line to standard error and returns false. -h/--help prints the command's help and sets *help. */
bool command_options(const struct command *command, int argc, char **argv,
                     const struct option_spec *specs, size_t spec_count, const char **operand,
                     size_t max_operands, size_t *operands, bool *help);
/* The same for a command that needs from `least` to `most` operands, `needed` ("a results file").
 * Returns COMMAND_GOES_ON, or the code to leave with: help was printed, or bad use told. */
enum { COMMAND_GOES_ON = -1 };
int command_begin(const struct command *command, int argc, char **argv,
                  const struct option_spec *specs, size_t spec_count, const char *needed,
                  const char **operand, size_t least, size_t most, size_t *operands);

/* Prints "stance NAME: TEXT (stance NAME -h explains)" to standard error. Returns EXIT_USAGE. */
int command_usage(const struct command *command, const char *text);

/* One of known[count]: its index, or `count` with a line on standard error that names them, or the
 * nearest one where there are many. */
size_t command_word(const struct command *command, const char *option, const char *word,
                    const char *const *known, size_t count);

#endif
