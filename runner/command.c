/* command.c - options of the commands, and the nearest known word to a misspelt one. */
#include "command.h"

#include <stdio.h>
#include <string.h>

enum { LONGEST_WORD = 63 };

static size_t minimum(size_t a, size_t b)
{
    return a < b ? a : b;
}

/* Damerau-Levenshtein distance in its restricted form (a pair is swapped at most once). Words
 * longer than LONGEST_WORD are compared by their beginning: no known word is that long. */
static size_t edit_distance(const char *a, const char *b)
{
    size_t rows[3][LONGEST_WORD + 1];
    size_t m = minimum(strlen(a), LONGEST_WORD), n = minimum(strlen(b), LONGEST_WORD);
    size_t *before = rows[0], *previous = rows[1], *current = rows[2];

    for (size_t j = 0; j <= n; j++) {
        previous[j] = j;
    }
    for (size_t i = 1; i <= m; i++) {
        current[0] = i;
        for (size_t j = 1; j <= n; j++) {
            size_t differs = a[i - 1] != b[j - 1];
            current[j] =
                minimum(minimum(previous[j], current[j - 1]) + 1, previous[j - 1] + differs);
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) {
                current[j] = minimum(current[j], before[j - 2] + 1);
            }
        }
        size_t *oldest = before;
        before = previous;
        previous = current;
        current = oldest;
    }
    return previous[n];
}

const char *nearest_word(const char *word, const char *const *known, size_t count)
{
    const char *nearest = NULL;
    size_t length = minimum(strlen(word), LONGEST_WORD);
    size_t admitted = length / 3 > 2 ? length / 3 : 2, best = admitted + 1;

    for (size_t i = 0; i < count; i++) {
        size_t distance = edit_distance(word, known[i]);
        /* As many edits as letters would be another word altogether. */
        if (distance < best && distance < length) {
            best = distance;
            nearest = known[i];
        }
    }
    return nearest;
}

static void print_help(const struct command *command)
{
    bool named = strncmp(command->synopsis, "stance ", 7) == 0;
    printf("usage: %s%s\n\n%s.\n", named ? "" : "stance ", command->synopsis, command->summary);
    if (command->help && command->help[0]) {
        printf("\n%s", command->help);
        if (command->help[strlen(command->help) - 1] != '\n') {
            putchar('\n');
        }
    }
}

static bool bad_use(const struct command *command, const char *text, const char *word)
{
    fprintf(stderr, "stance %s: %s '%s' (stance %s -h explains)\n", command->name, text, word,
            command->name);
    return false;
}

static bool unknown_option(const struct command *command, const char *word,
                           const struct option_spec *specs, size_t spec_count)
{
    const char *names[32];
    size_t n = 0;
    for (size_t i = 0; i < spec_count && n < sizeof names / sizeof names[0]; i++) {
        names[n++] = specs[i].name;
    }
    char stem[LONGEST_WORD + 1];
    snprintf(stem, sizeof stem, "%.*s", (int)minimum(strcspn(word, "="), LONGEST_WORD), word);
    const char *near = nearest_word(stem, names, n);
    if (!near) {
        return bad_use(command, "unknown option", stem);
    }
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
        if (strncmp(word, specs[i].name, length) != 0) {
            continue;
        }
        if (word[length] == '\0') {
            return &specs[i];
        }
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

    if (!spec) {
        return unknown_option(command, argv[*i], specs, spec_count);
    }
    if (spec->takes_value) {
        if (!value) {
            if (*i + 1 >= argc) {
                return bad_use(command, "a value must follow", spec->name);
            }
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

bool command_options(const struct command *command, int argc, char **argv,
                     const struct option_spec *specs, size_t spec_count, const char **operand,
                     size_t max_operands, size_t *operands, bool *help)
{
    bool only_operands = false;

    *operands = 0;
    *help = false;
    for (size_t i = 0; i < spec_count; i++) {
        *specs[i].count = 0;
    }
    for (int i = 1; i < argc; i++) {
        if (!only_operands && strcmp(argv[i], "--") == 0) {
            only_operands = true;
        } else if (!only_operands &&
                   (strcmp(argv[i], "-h") == 0 || strcmp(argv[i], "--help") == 0)) {
            print_help(command);
            *help = true;
            return true;
        } else if (!only_operands && argv[i][0] == '-' && argv[i][1] != '\0') {
            if (!take_option(command, argc, argv, &i, specs, spec_count)) {
                return false;
            }
        } else if (*operands >= max_operands) {
            return bad_use(command, "unexpected argument", argv[i]);
        } else {
            operand[(*operands)++] = argv[i];
        }
    }
    return true;
}
