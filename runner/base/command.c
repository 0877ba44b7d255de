/* command.c - options of the commands. */
#include "command.h"
#include "problem.h"
#include "units.h"
#include "words.h"

#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/time.h>
#include <unistd.h>

enum { LONGEST_OPTION = 63 };

static void print_help(const struct command *command)
{
    bool named = strncmp(command->synopsis, "stance ", 7) == 0;
    printf("usage: %s%s\n\n%s.\n", named ? "" : "stance ", command->synopsis, command->summary);
    if (command->help && command->help[0]) {
        printf("\n%s", command->help);
        if (command->help[strlen(command->help) - 1] != '\n')
            putchar('\n');
    }
}

static bool bad_use(const struct command *command, const char *text, const char *word)
{
    fprintf(stderr, "stance %s: %s '%s' (stance %s -h explains)\n", command->name, text, word,
            command->name);
    return false;
}

/* Operands that are one too many where PATH=VALUE of a --set or --near was written in another way.
 */
static bool unexpected(const struct command *command, int argc, char **argv, int i,
                       const struct option_spec *specs, size_t spec_count)
{
    bool sets = false;
    for (size_t k = 0; k < spec_count; k++)
        sets = sets || strcmp(specs[k].name, "--set") == 0;
    const char *path = i > 0 ? argv[i - 1] : "";
    const bool joined = strncmp(path, "--set=", 6) == 0;
    path += joined ? 6 : 0;
    const bool near = i > 1 && strcmp(argv[i - 2], "--near") == 0;
    if ((near || strncmp(path, "--near=", 7) == 0) && strchr(argv[i], '=')) {
        fprintf(stderr, "stance %s: unexpected argument '%s'; write --near %s,%s\n", command->name,
                argv[i], near ? path : path + 7, argv[i]);
        return false;
    }
    if (sets && path[0] != '-' && (joined || (i > 1 && strcmp(argv[i - 2], "--set") == 0)) &&
        !strchr(path, '=')) {
        const char *value = strcmp(argv[i], "=") == 0 && i + 1 < argc ? argv[i + 1] : argv[i];
        fprintf(stderr, "stance %s: unexpected argument '%s'; write --set %s=%s\n", command->name,
                argv[i], path, value + (value[0] == '='));
        return false;
    }
    if (sets && strchr(argv[i], '=')) {
        fprintf(stderr, "stance %s: unexpected argument '%s'; write --set %s\n", command->name,
                argv[i], argv[i]);
        return false;
    }
    return bad_use(command, "unexpected argument", argv[i]);
}

static bool unknown_option(const struct command *command, const char *word,
                           const struct option_spec *specs, size_t spec_count)
{
    const char *names[32];
    size_t n = 0;
    for (size_t i = 0; i < spec_count && n < sizeof names / sizeof names[0]; i++)
        names[n++] = specs[i].name;
    char stem[LONGEST_OPTION + 1];
    snprintf(stem, sizeof stem, "%.*s", LONGEST_OPTION, word);
    stem[strcspn(stem, "=")] = '\0';
    static const char *const other[][2] = {{"--output", "-o"}, {"--out", "-o"}, {"-s", "--set"}};
    const char *near = strlen(stem) > 2 ? nearest_word(stem, names, n) : NULL;
    for (size_t k = 0; k < sizeof other / sizeof other[0]; k++)
        for (size_t i = 0; i < n; i++)
            near = strcmp(stem, other[k][0]) == 0 && strcmp(names[i], other[k][1]) == 0 ? names[i]
                                                                                        : near;
    if (strcmp(stem, "-n") == 0 || strcmp(stem, "-np") == 0) {
        fprintf(stderr,
                "stance %s: unknown option '%s'; for several ranks write mpirun -n N stance %s\n",
                command->name, stem, command->name);
        return false;
    }
    if (!near)
        return bad_use(command, "unknown option", stem);
    fprintf(stderr, "stance %s: unknown option '%s'; did you mean '%s'?\n", command->name, stem,
            near);
    return false;
}

/* The spec that `word` names, as "--name" or "--name=VALUE" (*value is set then). */
static const struct option_spec *find_option(const char *word, const struct option_spec *specs,
                                             size_t spec_count, const char **value)
{
    for (size_t i = 0; i < spec_count; i++) {
        size_t length = strlen(specs[i].name);
        if (strncmp(word, specs[i].name, length) != 0)
            continue;
        if (word[length] == '\0')
            return &specs[i];
        if (word[length] == '=' && length > 2) {
            *value = word + length + 1;
            return &specs[i];
        }
    }
    return NULL;
}

/* Takes one option, whose value may be the next argument; *i moves on to the last one used. */
static bool take_option(const struct command *command, int argc, char **argv, int *i,
                        const struct option_spec *specs, size_t spec_count)
{
    const char *value = NULL;
    const struct option_spec *spec = find_option(argv[*i], specs, spec_count, &value);

    if (!spec)
        return unknown_option(command, argv[*i], specs, spec_count);
    if (spec->takes_value) {
        if (!value) {
            if (*i + 1 >= argc)
                return bad_use(command, "a value must follow", spec->name);
            value = argv[++*i];
        }
        if (*spec->count >= spec->max) {
            return bad_use(command,
                           spec->max == 1 ? "given twice:" : "given too often:", spec->name);
        }
        spec->values[*spec->count] = value;
    } else if (value) {
        return bad_use(command, "takes no value:", spec->name);
    }
    ++*spec->count;
    return true;
}

/* ---- time limits ---------------------------------------------------------------------------- */

static char late[120];

static void end_late(int number)
{
    (void)number;
    if (write(STDERR_FILENO, late, strlen(late)) < 0) {
        /* Nobody hears it. */
    }
    _exit(EXIT_INTERRUPTED);
}

static bool limit_time(const struct command *command, const char *limit)
{
    const double seconds = seconds_of_text(limit);
    const struct sigaction action = {.sa_handler = end_late};
    if (!(seconds >= 0) || seconds > 1e9)
        return bad_use(command, "--time-limit takes a duration such as 90s, 55m or 1h30m, not",
                       limit);
    snprintf(late, sizeof late, "%sstance %s: stopped after %.30s, its time limit\n",
             isatty(STDERR_FILENO) == 1 ? "\r\033[K" : "", command->name, limit);
    const long whole = (long)seconds;
    const long rest = (long)((seconds - (double)whole) * 1e6);
    const struct itimerval timer = {.it_value = {whole, whole + rest > 0 ? rest : 1}};
    sigaction(SIGALRM, &action, NULL);
    setitimer(ITIMER_REAL, &timer, NULL);
    return true;
}

/* ---- all of them ---------------------------------------------------------------------------- */

bool command_options(const struct command *command, int argc, char **argv,
                     const struct option_spec *own, size_t spec_count, const char **operand,
                     size_t max_operands, size_t *operands, bool *help)
{
    enum { MOST = 40 };
    static const char option[] = "--time-limit";
    bool only_operands = false, limited = strstr(command->help, option) && spec_count < MOST;
    struct option_spec specs[MOST];
    const char *limit = NULL;
    size_t limits = 0;

    for (size_t i = 0; i < spec_count && i < MOST; i++) {
        specs[i] = own[i];
        limited = limited && strcmp(own[i].name, option) != 0;
    }
    if (limited)
        specs[spec_count++] = (struct option_spec){option, true, &limit, 1, &limits};
    *operands = 0;
    *help = false;
    for (size_t i = 0; i < spec_count; i++)
        *specs[i].count = 0;
    for (int i = 1; i < argc; i++) {
        if (!only_operands && strcmp(argv[i], "--") == 0) {
            only_operands = true;
        } else if (!only_operands &&
                   (strcmp(argv[i], "-h") == 0 || strcmp(argv[i], "--help") == 0)) {
            print_help(command);
            *help = true;
            return true;
        } else if (!only_operands && argv[i][0] == '-' && argv[i][1] != '\0') {
            if (!take_option(command, argc, argv, &i, specs, spec_count))
                return false;
        } else if (*operands >= max_operands) {
            return unexpected(command, argc, argv, i, specs, spec_count);
        } else {
            operand[(*operands)++] = argv[i];
        }
    }
    return !limit || limit_time(command, limit);
}

int command_usage(const struct command *command, const char *text)
{
    fprintf(stderr, "stance %s: %s (stance %s -h explains)\n", command->name, text, command->name);
    return EXIT_USAGE;
}

int command_begin(const struct command *command, int argc, char **argv,
                  const struct option_spec *specs, size_t spec_count, const char *needed,
                  const char **operand, size_t least, size_t most, size_t *operands)
{
    bool help;
    char text[120];
    if (!command_options(command, argc, argv, specs, spec_count, operand, most, operands, &help))
        return EXIT_USAGE;
    snprintf(text, sizeof text, "%s must be given", needed);
    return help ? EXIT_DONE : *operands < least ? command_usage(command, text) : COMMAND_GOES_ON;
}

size_t command_word(const struct command *command, const char *option, const char *word,
                    const char *const *known, size_t count)
{
    enum { MANY = 8 };
    size_t k = 0;
    while (k < count && strcmp(word, known[k]) != 0)
        k++;
    if (k < count)
        return k;
    const char *near = count > MANY ? nearest_word(word, known, count) : NULL;
    char list[600];
    if (near) {
        fprintf(stderr, "stance %s: %s: there is no '%.60s'; did you mean '%s'?\n", command->name,
                option, word, near);
    } else {
        fprintf(stderr, "stance %s: %s takes one of %s, not '%.60s'\n", command->name, option,
                word_list(list, sizeof list, known, count), word);
    }
    return count;
}
