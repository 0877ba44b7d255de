/* command.c - options of the commands. */
#include "command.h"
#include "problem.h"
#include "say.h"
#include "units.h"
#include "words.h"

#include <errno.h>
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/time.h>
#include <unistd.h>

enum { LONGEST_OPTION = 63, MOST_ROWS = 64, MOST_WORDS = 128, MARGIN = 92, TEXT_COLUMN = 21 };

/* A command's options, those of rows within rows, too. */
struct table {
    const struct command *command;
    size_t rows, operands; /* row of the operands; `rows`: there are none */
    struct {
        const struct option *option;
        size_t at, given;
    } row[MOST_ROWS];
};

int command_usage(const struct command *command, const char *text)
{
    fprintf(stderr, "stance %s: %s (stance %s -h explains)\n", command->name, text, command->name);
    return EXIT_USAGE;
}

/* With a hint such as "; write ..."; NULL or "": that -h explains. */
static bool bad_use(const struct command *command, const char *text, const char *word,
                    const char *hint)
{
    fprintf(stderr, "stance %s: %s '%s'", command->name, text, word);
    if (hint && hint[0])
        fprintf(stderr, "%s\n", hint);
    else
        fprintf(stderr, " (stance %s -h explains)\n", command->name);
    return false;
}

/* ---- the table ------------------------------------------------------------------------------ */

static bool is_option(const struct option *o)
{
    return o->name && o->name[0] == '-';
}

static bool is_flag(const struct option *o)
{
    return !o->read && (o->kind == OPTION_FLAG || (o->kind == OPTION_WORD && !o->word));
}

/* Takes the next name off a list between blanks; false: there is none. */
static bool next_name(const char **list, char name[LONGEST_OPTION + 1])
{
    const char *const from = *list ? *list + strspn(*list, " ") : "";
    const size_t length = strcspn(from, " ");
    snprintf(name, LONGEST_OPTION + 1, "%.*s", (int)length, from);
    *list = from + length;
    return length > 0;
}

static bool has_name(const char *list, const char *wanted)
{
    char name[LONGEST_OPTION + 1];
    while (next_name(&list, name))
        if (strcmp(name, wanted) == 0)
            return true;
    return false;
}

/* The row of that name, or `rows`. */
static size_t find_row(const struct table *t, const char *name)
{
    size_t i = 0;
    while (i < t->rows && (!t->row[i].option->name || strcmp(t->row[i].option->name, name) != 0))
        i++;
    return i;
}

static void add_rows(struct table *t, const struct option *o, size_t base)
{
    for (; o && (o->name || o->text || o->rows || o->part) && t->rows < MOST_ROWS; o++) {
        if (o->rows)
            add_rows(t, o->rows, base + o->at);
        if (o->rows || o->part)
            continue;
        t->row[t->rows].option = o;
        t->row[t->rows++].at = base + o->at;
    }
}

/* Whether row i cannot stand beside the one before it: "[--force | --resume]". */
static bool joins(const struct table *t, size_t i)
{
    if (i == 0 || i >= t->rows)
        return false;
    const struct option *const o = t->row[i].option, *const before = t->row[i - 1].option;
    return is_option(o) && is_option(before) && has_name(o->without, before->name);
}

static void make_table(struct table *t, const struct command *command)
{
    *t = (struct table){.command = command};
    add_rows(t, command->options, 0);
    while (t->operands < t->rows &&
           (!t->row[t->operands].option->name || is_option(t->row[t->operands].option)))
        t->operands++;
}

/* How often an option must and may be given, how many operands there may be. */
static size_t least_of(const struct option *o)
{
    return !is_option(o) || o->kind == OPTION_FLAG ? (size_t)o->low : 0;
}

static size_t most_of(const struct option *o)
{
    const double most = is_option(o) ? (double)o->most : o->high;
    return most > 0 ? (size_t)most : o->kind == OPTION_TEXTS ? SIZE_MAX : 1;
}

static size_t words_of(const struct option *o, const char *words[MOST_WORDS])
{
    size_t count = 0;
    while (o->word && count < MOST_WORDS && (words[count] = o->word(count)))
        count++;
    return count;
}

/* What the help calls a value, or the words that it may be; NULL: there is none. */
static const char *value_name(const struct option *o, bool listed, char *text, size_t size)
{
    const char *words[MOST_WORDS];
    const size_t count = words_of(o, words);
    return count == 0 || (o->value && !listed) ? o->value
                                               : words_join(text, size, "|", words, count);
}

/* ---- help ----------------------------------------------------------------------------------- */

static size_t fill(const char *text, size_t length, size_t column, size_t indent)
{
    return words_fill(stdout, text, length, column, indent, MARGIN);
}

/* Where a line that begins with a blank goes on when it is filled: under the text behind its name.
 */
static size_t hang(const char *line)
{
    const size_t own = strspn(line, " ");
    const char *const gap = strstr(line + own, "  ");
    const bool within = gap && gap < line + strcspn(line, "\n");
    return within ? (size_t)(gap - line) + strspn(gap, " ") : own;
}

static void print_text(const char *text, size_t indent)
{
    for (size_t length; *text; text += length + (text[length] == '\n')) {
        length = strcspn(text, "\n");
        const size_t head = *text == ' ' ? hang(text) : 0, under = head > 0 ? head : indent;
        if (*text == ' ' && length <= MARGIN)
            fwrite(text, 1, length, stdout);
        else
            fill(text + head, length - head, (size_t)printf("%.*s", (int)head - (head > 0), text),
                 under);
        putchar('\n');
    }
}

static void print_synopsis(const struct table *t)
{
    char item[500], words[200];
    size_t column = (size_t)printf("usage: stance %s", t->command->name);
    if (t->operands < t->rows) {
        const struct option *const o = t->row[t->operands].option;
        column += (size_t)printf(least_of(o) > 0 ? " %s" : " [%s]", o->name);
    }
    for (size_t i = 0; i < t->rows; i++) {
        const struct option *const o = t->row[i].option;
        const char *const value = value_name(o, false, words, sizeof words);
        const char *const open = least_of(o) > 0 ? ""
                                 : joins(t, i)   ? "| "
                                                 : "[",
                          *const close = least_of(o) > 0 || joins(t, i + 1) ? "" : "]";
        if (!is_option(o))
            continue;
        /* What is between brackets stands in one line. */
        snprintf(item, sizeof item, "%s%s%s%s%s%s", open, o->name, value ? " " : "",
                 value ? value : "", close, most_of(o) > 1 ? "..." : "");
        if (column + 1 + strlen(item) > MARGIN)
            column = 0, putchar('\n');
        column += (size_t)printf("%*s%s", column > 0 ? 1 : 11, "", item);
    }
    putchar('\n');
}

/* What the table knows beside the text: range, and what goes with what. */
static void print_conditions(const struct table *t, size_t i, size_t column)
{
    const struct option *const o = t->row[i].option;
    char text[300];
    text[0] = '\0';
    if (o->high > 0 && !o->takes)
        words_add(text, sizeof text, "(%.10g to %.10g) ", o->low, o->high);
    if (o->needs)
        words_add(text, sizeof text, "(with %s) ", o->needs);
    if (o->without && !joins(t, i) && !joins(t, i + 1))
        words_add(text, sizeof text, "(not with %s)", o->without);
    fill(text, strlen(text), column, TEXT_COLUMN);
}

static void print_option(const struct table *t, size_t i)
{
    const struct option *const o = t->row[i].option;
    char words[200];
    const char *const value = value_name(o, false, words, sizeof words);
    const size_t length = strcspn(o->text, "\n");
    size_t column = (size_t)printf("  %s%s%s", o->name, value ? " " : "", value ? value : "");
    column +=
        (size_t)printf("%*s", column + 2 < TEXT_COLUMN ? (int)(TEXT_COLUMN - 1 - column) : 1, "");
    column = fill(o->text, length, column, TEXT_COLUMN);
    print_conditions(t, i, column);
    putchar('\n');
    if (o->text[length])
        print_text(o->text + length + 1, TEXT_COLUMN);
}

static void print_paragraphs(const char *text)
{
    if (text && text[0] != ' ')
        putchar('\n');
    if (text)
        print_text(text, 0);
}

static void print_keys(const struct say_key *keys)
{
    char *text = NULL;
    size_t size;
    FILE *const to = keys ? open_memstream(&text, &size) : NULL;
    if (!to)
        return;
    say_keys(keys, to);
    fclose(to);
    print_text(text, 0);
    free(text);
}

static void print_help(const struct table *t)
{
    bool above = false; /* an option: they stand together */
    print_synopsis(t);
    printf("\n%s.\n", t->command->summary);
    print_paragraphs(t->command->help);
    for (size_t i = 0; i < t->rows; i++) {
        const bool option = is_option(t->row[i].option);
        if (i == t->operands)
            continue;
        if (!option)
            print_paragraphs(t->row[i].option->text);
        else if (!above)
            putchar('\n');
        if (option)
            print_option(t, i);
        above = option || t->row[i].option->text[0] == ' ';
    }
    print_paragraphs(t->command->after);
    for (size_t i = 0; i < t->rows; i++)
        print_keys(t->row[i].option->keys);
}

void command_print_rows(const struct command *command)
{
    struct table t;
    char words[2000];
    make_table(&t, command);
    printf("%s\t-\t%s\t%s\n", command->name,
           t.operands < t.rows ? t.row[t.operands].option->name : "-", command->summary);
    for (size_t i = 0; i < t.rows; i++) {
        const struct option *const o = t.row[i].option;
        const char *const value = value_name(o, true, words, sizeof words);
        if (is_option(o))
            printf("%s\t%s\t%s\t%.*s\n", command->name, o->name, value ? value : "-",
                   (int)strcspn(o->text, "\n"), o->text);
    }
    for (const struct option *o = command->options; o && o->part; o++)
        command_print_rows(o->part);
}

/* ---- what is wrong -------------------------------------------------------------------------- */

/* Operands that are one too many where PATH=VALUE of a --set or --near was written in another way.
 */
static bool unexpected(const struct table *t, int argc, char **argv, int i)
{
    const bool sets = find_row(t, "--set") < t->rows;
    const char *const before = i > 1 ? argv[i - 2] : "", *path = argv[i - 1], *value = argv[i];
    const bool near = strncmp(path, "--near=", 7) == 0, set = strncmp(path, "--set=", 6) == 0;
    char hint[400] = "";
    path += near ? 7 : set ? 6 : 0;
    if ((near || strcmp(before, "--near") == 0) && strchr(value, '='))
        snprintf(hint, sizeof hint, "; write --near %s,%s", path, value);
    else if (sets && path[0] != '-' && (set || strcmp(before, "--set") == 0) && !strchr(path, '='))
        snprintf(hint, sizeof hint, "; write --set %s=%s", path,
                 strcmp(value, "=") == 0 && i + 1 < argc ? argv[i + 1] : value + (value[0] == '='));
    else if (sets && strchr(value, '='))
        snprintf(hint, sizeof hint, "; write --set %s", value);
    return bad_use(t->command, "unexpected argument", value, hint);
}

static bool unknown_option(const struct table *t, const char *word)
{
    static const char *const other[][2] = {{"--output", "-o"}, {"--out", "-o"}, {"-s", "--set"}};
    const char *names[MOST_ROWS];
    char stem[LONGEST_OPTION + 1], hint[200] = "";
    size_t n = 0;
    for (size_t i = 0; i < t->rows; i++)
        if (is_option(t->row[i].option))
            names[n++] = t->row[i].option->name;
    snprintf(stem, sizeof stem, "%.*s", (int)strcspn(word, "="), word);
    const char *near = strlen(stem) > 2 ? nearest_word(stem, names, n) : NULL;
    for (size_t k = 0; k < sizeof other / sizeof other[0]; k++)
        if (strcmp(stem, other[k][0]) == 0 && find_row(t, other[k][1]) < t->rows)
            near = other[k][1];
    if (strcmp(stem, "-n") == 0 || strcmp(stem, "-np") == 0)
        snprintf(hint, sizeof hint, "; for several ranks write mpirun -n N stance %s",
                 t->command->name);
    else if (near)
        snprintf(hint, sizeof hint, "; did you mean '%s'?", near);
    return bad_use(t->command, "unknown option", stem, hint);
}

size_t command_word(const struct command *command, const char *option, const char *word,
                    const char *const *known, size_t count)
{
    enum { MANY = 8 };
    const size_t k = word_place(word, known, count);
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

/* ---- values --------------------------------------------------------------------------------- */

bool option_range(const char *text, char path[96], double ends[2])
{
    const char *const equals = strchr(text, '=');
    const char *const dots = equals ? strstr(equals, "..") : NULL;
    char first[64], *end;
    if (!dots || equals == text || equals - text >= 96 || dots - equals > 60)
        return false;
    snprintf(path, 96, "%.*s", (int)(equals - text), text);
    snprintf(first, sizeof first, "%.*s", (int)(dots - equals) - 1, equals + 1);
    ends[0] = strtod(first, &end);
    bool good = first[0] && !*end;
    ends[1] = strtod(dots + 2, &end);
    good = good && dots[2] && !*end;
    return good && isfinite(ends[0]) && isfinite(ends[1]) && ends[0] != ends[1];
}

bool option_seconds(const char *text, void *seconds)
{
    return (*(double *)seconds = seconds_of_text(text)) >= 0;
}

static char late[120];
static const struct command *begun;

static void end_late(int number)
{
    (void)number;
    if (write(STDERR_FILENO, late, strlen(late)) < 0) {
        /* Nobody hears it. */
    }
    _exit(EXIT_INTERRUPTED);
}

bool option_alarm(const char *text, void *ignored)
{
    (void)ignored;
    const double seconds = seconds_of_text(text);
    const struct sigaction action = {.sa_handler = end_late};
    if (!(seconds >= 0) || seconds > 1e9)
        return false;
    snprintf(late, sizeof late, "%sstance %s: stopped after %.30s, its time limit\n",
             isatty(STDERR_FILENO) == 1 ? "\r\033[K" : "", begun->name, text);
    const long whole = (long)seconds;
    const long rest = (long)((seconds - (double)whole) * 1e6);
    const struct itimerval timer = {.it_value = {whole, whole + rest > 0 ? rest : 1}};
    sigaction(SIGALRM, &action, NULL);
    setitimer(ITIMER_REAL, &timer, NULL);
    return true;
}

/* A number of an option, whole or not, within its range; *whole is the first, *number both. */
static bool read_number(const struct option *o, const char *text, uint64_t *whole, double *number)
{
    char *end;
    const bool is_whole = o->kind == OPTION_WHOLE;
    *whole = is_whole ? strtoull(text, &end, 10) : 0;
    *number = is_whole ? (double)*whole : strtod(text, &end);
    return end != text && !*end && errno == 0 && *number >= o->low &&
           (!is_whole || (text[0] >= '0' && text[0] <= '9' && *whole < OPTION_NONE)) &&
           (*number <= o->high || (is_whole && o->high <= 0));
}

/* Of an option, or an operand, into its member; false with a line on standard error. */
static bool read_value(const struct command *command, const struct option *o, const char *text,
                       void *member)
{
    const char *words[MOST_WORDS];
    const size_t known = words_of(o, words),
                 word = known ? command_word(command, o->name, text, words, known) : 0;
    struct option_texts *const texts = member;
    const int chosen = known > 0 ? (int)word : (int)o->low;
    uint64_t whole;
    double number;
    bool good = true;
    if (known > 0 && word == known)
        return false;
    errno = 0; /* of what reads it */
    if (o->read)
        good = o->read(text, member);
    else if (o->kind == OPTION_FLAG)
        *(bool *)member = true;
    else if (o->kind == OPTION_TEXT)
        *(const char **)member = text;
    else if (o->kind == OPTION_TEXTS)
        texts->text[texts->count++] = text;
    else if (o->kind == OPTION_WORD)
        memcpy(member, &chosen, sizeof chosen);
    else if ((good = read_number(o, text, &whole, &number)))
        memcpy(member, o->kind == OPTION_WHOLE ? (void *)&whole : (void *)&number, sizeof number);
    if (good)
        return true;
    fprintf(stderr, "stance %s: %s takes ", command->name, o->name);
    if (o->takes)
        fputs(o->takes, stderr);
    else
        fprintf(stderr, "a %snumber from %.10g to %.10g", o->kind == OPTION_WHOLE ? "whole " : "",
                o->low, o->high);
    fprintf(stderr, ", not '%.80s'\n", text);
    return false;
}

/* ---- all of them ---------------------------------------------------------------------------- */

/* A row that was given, and with what. */
struct given {
    size_t row;
    const char *text;
};

/* The option that argv[*i] is, as "--name" or "--name=VALUE", else the next argument is its value;
 * *i moves on to the last one used. */
static bool take_option(struct table *t, int argc, char **argv, int *i, struct given *given)
{
    const char *word = argv[*i], *const equals = strchr(word, '=');
    char name[LONGEST_OPTION + 1];
    const bool joined = equals && equals > word + 2 && equals - word <= LONGEST_OPTION;
    snprintf(name, sizeof name, "%.*s", joined ? (int)(equals - word) : LONGEST_OPTION, word);
    given->row = find_row(t, name);
    given->text = joined ? equals + 1 : NULL;
    if (given->row == t->rows)
        return unknown_option(t, word);
    const struct option *const o = t->row[given->row].option;
    if (is_flag(o))
        return !joined || bad_use(t->command, "takes no value:", name, NULL);
    if (!joined && *i + 1 >= argc)
        return bad_use(t->command, "a value must follow", name, NULL);
    if (!joined)
        given->text = argv[++*i];
    return t->row[given->row].given < most_of(o) ||
           bad_use(t->command, most_of(o) == 1 ? "given twice:" : "given too often:", name, NULL);
}

/* Splits argv; `asked`: for help. */
static bool split(struct table *t, int argc, char **argv, struct given *given, size_t *count,
                  bool *asked)
{
    bool only_operands = false;
    for (int i = 1; i < argc && !*asked; i++) {
        struct given *const next = &given[*count];
        if (!only_operands && strcmp(argv[i], "--") == 0) {
            only_operands = true;
            continue;
        }
        *asked = !only_operands && (strcmp(argv[i], "-h") == 0 || strcmp(argv[i], "--help") == 0);
        if (*asked)
            break;
        if (!only_operands && argv[i][0] == '-' && argv[i][1]) {
            if (!take_option(t, argc, argv, &i, next))
                return false;
        } else {
            *next = (struct given){t->operands, argv[i]};
            if (t->operands == t->rows ||
                t->row[t->operands].given >= most_of(t->row[t->operands].option))
                return unexpected(t, argc, argv, i);
        }
        t->row[next->row].given++;
        ++*count;
    }
    return true;
}

/* The first of a list that was given beside row i; `rows`: none. */
static size_t beside(const struct table *t, size_t i, const char *list)
{
    char name[LONGEST_OPTION + 1];
    while (next_name(&list, name)) {
        const size_t other = find_row(t, name);
        if (other != i && other < t->rows && t->row[other].given > 0)
            return other;
    }
    return t->rows;
}

/* What stands with what. */
static bool agree(const struct table *t)
{
    char text[400] = "";
    for (size_t i = 0; i < t->rows && !text[0]; i++) {
        const struct option *const o = t->row[i].option;
        const size_t wrong = t->row[i].given > 0 ? beside(t, i, o->without) : t->rows;
        if (wrong < t->rows)
            snprintf(text, sizeof text, "%s and %s exclude each other", o->name,
                     t->row[wrong].option->name);
        else if (t->row[i].given > 0 && o->needs && beside(t, i, o->needs) == t->rows)
            snprintf(text, sizeof text, "%s needs %s", o->name, o->needs);
        else if (least_of(o) > t->row[i].given)
            snprintf(text, sizeof text, "%s must be given", is_option(o) ? o->name : o->text);
    }
    return !text[0] || command_usage(t->command, text) == EXIT_DONE;
}

/* Memory that stays. */
static void *keep(size_t size)
{
    static struct kept {
        struct kept *before;
        const char *memory[];
    } * last;
    struct kept *const kept = malloc(sizeof *kept + size);
    if (!kept)
        abort();
    kept->before = last;
    last = kept;
    return kept->memory;
}

/* The values of row i, of `count` that were given. */
static bool read_row(const struct table *t, size_t i, const struct given *given, size_t count,
                     void *member)
{
    const struct option *const o = t->row[i].option;
    size_t values = 1;
    for (size_t k = 0; k < count; k++)
        for (const char *c = given[k].row == i ? given[k].text : NULL; c; c = strchr(c + 1, ','))
            values++;
    if (o->kind == OPTION_TEXTS)
        *(struct option_texts *)member = (struct option_texts){keep(values * sizeof(char *)), 0};
    for (size_t k = 0; k < count; k++) {
        if (given[k].row != i)
            continue;
        const size_t size = o->listed ? strlen(given[k].text) + 1 : 0;
        char *rest = o->listed ? memcpy(keep(size), given[k].text, size) : NULL;
        do
            if (!read_value(t->command, o, rest ? strsep(&rest, ",") : given[k].text, member))
                return false;
        while (rest);
    }
    return true;
}

int command_begin(const struct command *command, int argc, char **argv, void *request)
{
    struct table t;
    size_t count = 0;
    bool asked = false;
    for (const struct option *o = command->options; argc > 1 && o && o->part; o++)
        if (strcmp(strrchr(o->part->name, ' ') + 1, argv[1]) == 0)
            return o->part->run(argc - 1, argv + 1);
    make_table(&t, command);
    begun = command;
    struct given *const given = calloc((size_t)argc + 1, sizeof *given);
    bool good = given && split(&t, argc, argv, given, &count, &asked);
    if (good && asked)
        print_help(&t);
    good = good && (asked || agree(&t));
    for (size_t i = 0; good && !asked && i < t.rows; i++)
        good = read_row(&t, i, given, count, (char *)request + t.row[i].at);
    free(given);
    return !good ? EXIT_USAGE : asked ? EXIT_DONE : COMMAND_GOES_ON;
}

/* ---- files -------------------------------------------------------------------------------- */

bool whole_file_begin(struct whole_file *whole, const char *name)
{
    whole->name = name;
    snprintf(whole->part, sizeof whole->part, "%.1190s.part", name);
    whole->out = fopen(whole->part, "wb");
    return whole->out != NULL;
}

bool whole_file_end(struct whole_file *whole, bool good)
{
    good = !ferror(whole->out) && good;
    good = fclose(whole->out) == 0 && good && rename(whole->part, whole->name) == 0;
    const int why = errno;
    if (!good)
        unlink(whole->part);
    errno = why;
    return good;
}

bool same_file(const char *a, const char *b)
{
    struct stat first, second;
    return stat(a, &first) == 0 && stat(b, &second) == 0 && first.st_dev == second.st_dev &&
           first.st_ino == second.st_ino;
}
