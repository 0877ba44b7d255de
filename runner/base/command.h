/* command.h - what a command is: exit codes, options, help. */
#ifndef STANCE_BASE_COMMAND_H
#define STANCE_BASE_COMMAND_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

enum exit_code {
    EXIT_DONE = 0,
    EXIT_CASES_FAILED = 1, /* some cases failed numerically; of `compare`, `import`: they differ */
    EXIT_USAGE = 2,        /* bad use or bad scenario */
    EXIT_IO = 3,
    EXIT_INTERRUPTED = 4, /* resumable */
};

#define STANCE_VERSION "0.1.0"

/* Texts in the order in which they were given, with room for one more; they live as long as the
 * process. */
struct option_texts {
    const char **text;
    size_t count;
};

/* What an option's member is tells what its value is. */
enum option_kind {
    OPTION_READ,
    OPTION_FLAG,
    OPTION_TEXT,
    OPTION_TEXTS,
    OPTION_WHOLE,
    OPTION_NUMBER,
    OPTION_WORD
};
/* Of a row whose value goes to a member of a struct; members of other types need `read`. */
#define OPTION_TO(type, member)                                                                    \
    .at = offsetof(type, member),                                                                  \
    .kind = _Generic(((type *)0)->member, bool: OPTION_FLAG, const char *: OPTION_TEXT,             \
                     struct option_texts: OPTION_TEXTS, uint64_t: OPTION_WHOLE,                     \
                     double: OPTION_NUMBER, int: OPTION_WORD, unsigned: OPTION_WORD,                \
                     default: OPTION_READ)

struct say_key;

/* A row of a command's table, of which all is made that is known of an option: parsing, what is
 * said of mistakes, -h, completion and manual pages.
 *
 * Values are "--name VALUE" or "--name=VALUE", and are read in the order of the table, not of the
 * command line. What was not given stays as it was. */
struct option {
    const char *name;  /* "--set", "-o"; the operands: as in the synopsis; NULL: only text */
    const char *value; /* what the help calls it; NULL: a flag, or its words */
    size_t at;         /* in what the command asks for, see OPTION_TO */
    enum option_kind kind;
    double low, high; /* of a number; of operands: how many, high 0: one, or any number; low 1 of
                       * a flag: it must be given */
    const char *(*word)(size_t k); /* its words, up to NULL: of a word the index is kept, without
                                    * words, of a flag, `low` */
    bool listed;                   /* several with commas between them, each a value */
    size_t most; /* how often it may be given; 0: once, texts any number of times */
    bool (*read)(const char *text, void *member);
    const char *takes;          /* "a duration such as 90s": instead of what its kind says */
    const char *without;        /* "--force --resume": it stands with none of these */
    const char *needs;          /* ... and with at least one of these */
    const struct option *rows;  /* others stand here, whose members count from `at` */
    const struct command *part; /* first of all: "bench plot" of "bench", which "plot" leads to */
    const struct say_key *keys; /* of --json: what it gives (say.h), which -h ends with */
    const char *text; /* what -h says, see struct command; of operands: what must be given */
};

#define OPTION_NONE UINT64_MAX /* which no whole number is that was given */
#define OPTION_DURATION "a duration such as 90s, 55m or 1h30m"
bool option_seconds(const char *text, void *seconds);
/* Splits "PATH=FROM..TO", where FROM and TO are different finite numbers; false: it is none. */
bool option_range(const char *text, char path[96], double ends[2]);
/* Ends the command when its time is up, with one line on standard error and EXIT_INTERRUPTED; what
 * it started in a sandbox ends with it. */
bool option_alarm(const char *text, void *ignored);
/* Rows of many commands: {OPTION_SET(struct request, sets)}. */
#define OPTION_TIME_LIMIT                                                                          \
    "--time-limit", "TIME", .read = option_alarm, .takes = OPTION_DURATION,                        \
                            .text = "end after 90s, 55m, 1h30m ... of wall time, with exit code 4"
#define OPTION_JSON(type, member)                                                                  \
    "--json", OPTION_TO(type, member), .text = "the same as JSON, with the keys"
#define OPTION_SET(type, member)                                                                   \
    "--set", "PATH=VALUE", OPTION_TO(type, member),                                                \
        .text = "replace a value of the scenario; may be repeated"

/* One command: argv[0] is its name. Returns an exit code. In its texts a line that begins with a
 * blank stands as it is, others are filled. */
struct command {
    const char *name, *summary;
    int (*run)(int argc, char **argv);
    const struct option *options; /* ends with a row of nothing */
    const char *help, *after;     /* printed by -h before the options, and after them */
};

/* Reads argv into what the command asks for. Returns COMMAND_GOES_ON, or the code to leave with:
 * help was printed, or bad use told in one line on standard error. */
enum { COMMAND_GOES_ON = -1 };
int command_begin(const struct command *command, int argc, char **argv, void *request);

/* Prints "stance NAME: TEXT (stance NAME -h explains)" to standard error. Returns EXIT_USAGE. */
int command_usage(const struct command *command, const char *text);

/* Prints the command and its options as lines of fields between tabs, for completion and manual
 * pages: NAME, "-", OPERANDS ("-": none) and SUMMARY, or NAME, OPTION, VALUE ("-": a flag) and TEXT
 * to the end of its first line. Then its parts. */
void command_print_rows(const struct command *command);

/* One of known[count]: its index, or `count` with a line on standard error that names them, or the
 * nearest one where there are many. */
size_t command_word(const struct command *command, const char *option, const char *word,
                    const char *const *known, size_t count);

/* A file that takes its name when it is whole. Each false: errno says why; end with `good` false
 * takes back what was written, and is false. */
struct whole_file {
    const char *name;
    char part[1200];
    FILE *out;
};
bool whole_file_begin(struct whole_file *whole, const char *name);
bool whole_file_end(struct whole_file *whole, bool good);
/* Whether two names are of one file that there is. */
bool same_file(const char *a, const char *b);

#endif
